// Reading and changing single values of a job's text, so that comments and the order of lines stay.
//
// The server reads jobs; this reads as much as the page shows and changes. One scan finds all headers and keys, bare, quoted
// and dotted ones, those of tables in braces too, and where each value begins and ends. A line that is none of TOML, as one
// that is being typed, is passed over. Values are read where they are asked for; dates are not.

/** A key with its value: the table it is in, and its place in the text. `isList` where it is of a table of a list, `[[name]]`, or below one. */
export interface Entry {
  table: string; isList: boolean; key: string;
  /** All names from the root on. */
  path: string[];
  /** Where the key begins, where the value does, and where that ends. */
  start: number; from: number; to: number;
  /** The place of the brace of the table around it; -1 for a line of its own. */
  brace: number;
  /** Number of the header above it; -1 where there is none. */
  header: number;
}

/** The header of a table: `[name]`, or `[[name]]` for one of a list. */
interface Header { table: string; path: string[]; isList: boolean; from: number; to: number }

export type Value = string | number | boolean | Value[] | Table;
export interface Table { [key: string]: Value }

/** A text that is none of TOML, or a value that is not read. */
class Wrong extends Error {}

/** Names from the root on as one; a name that would be taken for several stays quoted. */
const joined = (path: string[]) => path.map((p) => (/^[A-Za-z0-9_-]+$/.test(p) ? p : JSON.stringify(p))).join(".");

/** Behind the string that begins at `at`. One that is not closed ends with its line, or with the text where it may have several. */
function endOfString(text: string, at: number): number {
  const c = text[at]!;
  const triple = c.repeat(3);
  const isLong = text.startsWith(triple, at);
  for (let i = at + (isLong ? 3 : 1); i < text.length; i++) {
    if (text[i] === "\n" && !isLong) return i;
    if (c === '"' && text[i] === "\\" && (isLong || text[i + 1] !== "\n")) i++;
    else if (!isLong && text[i] === c) return i + 1;
    else if (isLong && text.startsWith(triple, i)) {
      // Up to two quotes before the closing three belong to the text.
      let end = i + 3;
      while (end < i + 5 && text[end] === c) end++;
      return end;
    }
  }
  return text.length;
}

/** The end of the value that begins at `at`: behind it comes a comment, or the end of the line. */
function endOfValue(text: string, at: number): number {
  let depth = 0;
  for (let i = at; i < text.length; ) {
    const c = text[i]!;
    if (c === '"' || c === "'") { i = endOfString(text, i); continue; }
    if (c === "[" || c === "{") depth++;
    else if (c === "]" || c === "}") depth--;
    else if (c === "#") {
      if (depth === 0) return trimmed(text, at, i);
      const line = text.indexOf("\n", i);
      i = line < 0 ? text.length : line;
      continue;
    } else if (c === "\n" && depth <= 0) return trimmed(text, at, i);
    i++;
  }
  return trimmed(text, at, text.length);
}

function trimmed(text: string, from: number, to: number): number {
  while (to > from && /\s/.test(text[to - 1]!)) to--;
  return to;
}

/** What an expression finds at a place. */
function match(expression: RegExp, text: string, at: number): string {
  expression.lastIndex = at;
  return expression.exec(text)?.[0] ?? "";
}
const spaces = (text: string, at: number) => at + match(/[ \t]*/y, text, at).length;
/** Behind spaces, ends of lines and comments. */
const blank = (text: string, at: number) => at + match(/(?:\s+|#[^\n]*)*/y, text, at).length;
/** Behind the line at `at`. */
const nextLine = (text: string, at: number) => { const end = text.indexOf("\n", at); return end < 0 ? text.length : end + 1; };

/** The text that a string means. */
function meant(written: string): string {
  const n = /^("""|''')/.test(written) ? 3 : 1;
  const quotes = written.slice(0, n);
  if (written.length < 2 * n || !written.endsWith(quotes)) throw new Wrong();
  let inner = written.slice(n, -n);
  if (n === 3) inner = inner.replace(/^\r?\n/, "");
  if (quotes[0] === "'") return inner;
  const long = n === 3 ? inner.replace(/\\[ \t]*\r?\n\s*|\\./g, (found) => (/\n/.test(found) ? "" : found)) : inner;
  return long.replace(/\\(?:u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|([^]))/g, (_, four?: string, eight?: string, one?: string) => {
    const plain = { b: "\b", t: "\t", n: "\n", f: "\f", r: "\r", e: "\x1b", '"': '"', "\\": "\\" }[one ?? ""];
    const code = parseInt(four ?? eight ?? "", 16);
    if (plain === undefined && !(code <= 0x10ffff)) throw new Wrong();
    return plain ?? String.fromCodePoint(code);
  });
}

/** The key at a place, which may have several names, and where it ends. */
function keyAt(text: string, at: number): [string[], number] {
  const path: string[] = [];
  for (;;) {
    at = spaces(text, at);
    const isQuoted = text[at] === '"' || text[at] === "'";
    const name = isQuoted ? text.slice(at, endOfString(text, at)) : match(/[A-Za-z0-9_-]+/y, text, at);
    if (!name || /^("""|''')/.test(name)) throw new Wrong();
    path.push(isQuoted ? meant(name) : name);
    const end = at + name.length;
    at = spaces(text, end);
    if (text[at] !== ".") return [path, end];
    at++;
  }
}

/** Behind the sign that has to stand at a place. */
function behind(text: string, at: number, sign: string): number {
  if (text[at] !== sign) throw new Wrong();
  return at + 1;
}

const isTable = (v: Value | undefined): v is Table => typeof v === "object" && !Array.isArray(v);

/** Puts a value into a table, below the names of its key. */
function enter(into: Table, path: string[], value: Value): void {
  path.forEach((name, k) => {
    const isLast = k === path.length - 1;
    const here = Object.hasOwn(into, name) ? into[name] : undefined;
    if (name === "__proto__" || (here !== undefined && (isLast || !isTable(here)))) throw new Wrong();
    const next = isLast ? value : here ?? {};
    into[name] = next;
    into = next as Table;
  });
}

/** The table in braces at a place, and where it ends; `each` is told of its keys. */
function tableAt(text: string, at: number, each: (path: string[], start: number, from: number, to: number) => void = () => {}): [Table, number] {
  const all: Table = {};
  for (at = blank(text, behind(text, at, "{")); text[at] !== "}"; at = blank(text, at)) {
    const [path, end] = keyAt(text, at);
    const from = blank(text, behind(text, blank(text, end), "="));
    const [value, to] = read(text, from);
    enter(all, path, value);
    each(path, at, from, to);
    at = blank(text, to);
    if (text[at] === ",") at++;
    else if (text[at] !== "}") throw new Wrong();
  }
  return [all, at + 1];
}

/** The array at a place, and where it ends; `places` gets those of its values. */
function arrayAt(text: string, at: number, places: [number, number][] = []): [Value[], number] {
  const all: Value[] = [];
  for (at = blank(text, behind(text, at, "[")); text[at] !== "]"; at = blank(text, at)) {
    const [value, to] = read(text, at);
    all.push(value);
    places.push([at, to]);
    at = blank(text, to);
    if (text[at] === ",") at++;
    else if (text[at] !== "]") throw new Wrong();
  }
  return [all, at + 1];
}

/** The value at a place, and where it ends. */
function read(text: string, at: number): [Value, number] {
  const c = text[at];
  if (c === "[") return arrayAt(text, at);
  if (c === "{") return tableAt(text, at);
  if (c === '"' || c === "'") { const end = endOfString(text, at); return [meant(text.slice(at, end)), end]; }
  const word = match(/[A-Za-z0-9_+.-]+/y, text, at);
  const end = at + word.length;
  if (word === "true" || word === "false") return [word === "true", end];
  const number = /^[+-]?inf$/.test(word) ? Infinity * (word[0] === "-" ? -1 : 1) : Number(word.replaceAll("_", ""));
  if (!word || /Infinity/.test(word) || Number.isNaN(number)) throw new Wrong();
  return [number, end];
}

/** A value as it is written, read: texts, numbers, truth values, arrays, tables in braces. Undefined for what is none of them. */
export function value(text: string): Value | undefined {
  try {
    const [found, end] = read(text, blank(text, 0));
    return blank(text, end) === text.length ? found : undefined;
  } catch { return undefined; }
}

/** All keys of the text, in order; those of a table in braces follow it. */
export function entries(text: string): Entry[] { return scan(text).found; }

/** The text that was scanned last: the form asks for every setting of one text. */
let last: { text: string; found: Entry[]; headers: Header[] } = { text: "", found: [], headers: [] };

function scan(text: string): typeof last {
  if (text === last.text) return last;
  const found: Entry[] = [];
  const headers: Header[] = [];
  const lists: string[] = [];
  let above: string[] = [];
  let isList = false;
  const add = (path: string[], start: number, from: number, to: number, brace: number) => {
    found.push({ table: joined(path.slice(0, -1)), isList, key: path[path.length - 1]!, path, start, from, to, brace, header: headers.length - 1 });
    if (text[from] !== "{") return;
    const own: [string[], number, number, number][] = [];
    try { tableAt(text, from, (...one) => own.push(one)); } catch { return; }
    for (const [names, ...places] of own) add([...path, ...names], ...places, from);
  };
  // A file may begin with a mark of its encoding, which counts as a blank.
  for (let at = blank(text, 0); at < text.length; at = blank(text, at)) {
    try {
      if (text[at] === "[") {
        const isOfList = text[at + 1] === "[";
        // What follows a header that is not read is of no table that is known.
        above = ["["];
        isList = isOfList;
        const [path, end] = keyAt(text, at + (isOfList ? 2 : 1));
        if (!text.startsWith(isOfList ? "]]" : "]", spaces(text, end))) throw new Wrong();
        const table = joined(path);
        if (isOfList) lists.push(table);
        isList = isOfList || lists.some((list) => table.startsWith(`${list}.`));
        above = path;
        const from = text.lastIndexOf("\n", at) + 1;
        headers.push({ table, path, isList: isOfList, from, to: (at = nextLine(text, at)) });
      } else {
        const [names, end] = keyAt(text, at);
        const from = spaces(text, behind(text, spaces(text, end), "="));
        const to = endOfValue(text, from);
        add([...above, ...names], at, from, to, -1);
        at = nextLine(text, to);
      }
    } catch (error) {
      if (!(error instanceof Wrong)) throw error;
      at = nextLine(text, at);
    }
  }
  return (last = { text, found, headers });
}

/**
 * A table of a list, `[[name]]`: its lines in the text, the place of a further key, its keys, and its values with those of
 * dotted keys and of tables below it. `isRead` where all of its values are read, `isPlain` where besides no header stands below it.
 */
export interface Block { table: string; from: number; to: number; end: number; keys: Map<string, Entry>; dotted: Entry[]; values: Table; isRead: boolean; isPlain: boolean }

/** The tables of these lists, in the order of the text. */
export function blocks(text: string, ...tables: string[]): Block[] {
  const { found, headers } = scan(text);
  const made: Block[] = [];
  headers.forEach((header, k) => {
    if (!header.isList || !tables.includes(header.table)) return;
    let past = k + 1;
    while (headers[past] && !headers[past]!.isList && headers[past]!.table.startsWith(`${header.table}.`)) past++;
    const all = found.filter((e) => e.brace < 0 && e.header >= k && e.header < past);
    const own = all.filter((e) => e.header === k);
    const values: Table = {};
    let isRead = true;
    for (const e of all) {
      const one = value(text.slice(e.from, e.to));
      try { if (one === undefined) throw new Wrong(); enter(values, e.path.slice(header.path.length), one); } catch { isRead = false; }
    }
    const endOf = (entry: Entry | undefined, from: Header) => (entry ? nextLine(text, entry.to) : from.to);
    const direct = (e: Entry) => e.path.length === header.path.length + 1;
    made.push({
      table: header.table, from: header.from, to: endOf(all.filter((e) => e.header === past - 1).pop(), headers[past - 1]!), end: endOf(own[own.length - 1], header),
      keys: new Map(own.filter(direct).map((e) => [e.key, e])), dotted: own.filter((e) => !direct(e)), values, isRead, isPlain: isRead && past === k + 1,
    });
  });
  return made;
}

/** The text with lines put at a place. */
export function insert(text: string, at: number, lines: string): string {
  const before = text.slice(0, at);
  const gap = before === "" || before.endsWith("\n\n") ? "" : before.endsWith("\n") ? "\n" : "\n\n";
  const after = text.slice(at);
  return `${before}${gap}${lines}${after === "" || after.startsWith("\n") ? "" : "\n"}${after}`;
}

/** The text without a block, nor the empty line before it. */
export function remove(text: string, block: Block): string {
  const from = text.slice(0, block.from).endsWith("\n\n") ? block.from - 1 : block.from;
  return text.slice(0, from) + text.slice(block.to);
}

/** The text with a line of a key put at the beginning of a line. */
function putLine(text: string, at: number, key: string, value: string): string {
  const before = text.slice(0, at);
  return `${before}${before === "" || before.endsWith("\n") ? "" : "\n"}${key} = ${value}\n${text.slice(at)}`;
}

/** Places of the values of an array that is all of a text, or null for another text. */
function placesOf(text: string): [number, number][] | null {
  const places: [number, number][] = [];
  try { return arrayAt(text, 0, places)[1] === text.length ? places : null; } catch { return null; }
}

/** The text with another value in the place of one. The values of an array over several lines change one by one, so that comments between them stay. */
export function renew(text: string, { from, to }: Entry, value: string): string {
  const old = text.slice(from, to);
  const [was, is] = old.includes("\n") ? [placesOf(old), placesOf(value)] : [null, null];
  if (!was || !is || was.length !== is.length) return text.slice(0, from) + value + text.slice(to);
  let made = text.slice(0, from);
  let at = 0;
  was.forEach(([begin, end], k) => { made += old.slice(at, begin) + value.slice(...is[k]!); at = end; });
  return made + old.slice(at) + text.slice(to);
}

/** The text without a key: its line, or its place in a table in braces. */
function without(text: string, entry: Entry): string {
  if (entry.brace < 0) return text.slice(0, text.lastIndexOf("\n", entry.start) + 1) + text.slice(nextLine(text, entry.to));
  const all = entries(text).filter((e) => e.brace === entry.brace);
  const k = all.findIndex((e) => e.start === entry.start);
  const [before, after] = [all[k - 1], all[k + 1]];
  if (after) return text.slice(0, entry.start) + text.slice(after.start);
  return text.slice(0, before?.to ?? entry.start) + text.slice(entry.to);
}

/** The text with another value of a key of a block; null takes the line away. */
export function change(text: string, block: Block, key: string, value: string | null): string {
  const found = block.keys.get(key);
  if (found) return value === null ? without(text, found) : renew(text, found, value);
  // One line in place of those of its dotted keys.
  const depth = block.table.split(".").length;
  const [first, ...others] = block.dotted.filter((e) => e.path[depth] === key);
  for (const e of others.reverse()) text = without(text, e);
  if (first) return value === null ? without(text, first) : `${text.slice(0, first.start)}${key} = ${value}${text.slice(first.to)}`;
  return value === null ? text : putLine(text, block.end, key, value);
}

/** The value of a key as it is written, or null where the text does not state it. */
export function get(text: string, table: string, key: string): string | null {
  const found = entries(text).find((e) => !e.isList && e.table === table && e.key === key);
  return found ? text.slice(found.from, found.to) : null;
}

/** The text with another value of a key; null takes the line away. A text whose table is stated as something else stays as it is. */
export function set(text: string, table: string, key: string, value: string | null): string {
  const { found, headers } = scan(text);
  const all = found.filter((e) => !e.isList);
  const own = all.find((e) => e.table === table && e.key === key);
  if (own) return value === null ? without(text, own) : renew(text, own, value);
  if (value === null) return text;
  /** The name of the key in a table around it. */
  const below = (name: string) => joined([...table.split("."), key].slice(name === "" ? 0 : name.split(".").length));
  const isWithin = (one: string, of: string) => of === "" || one === of || one.startsWith(`${of}.`);
  // A table in braces takes its keys there, and those of tables in it.
  const around = all.filter((e) => isWithin(table, joined(e.path))).pop();
  if (around) {
    if (text[around.from] !== "{") return text;
    const before = all.filter((e) => e.brace === around.from).pop();
    const words = `${below(joined(around.path))} = ${value}`;
    if (before) return `${text.slice(0, before.to)}, ${words}${text.slice(before.to)}`;
    return /^\{\s*\}$/.test(text.slice(around.from, around.to)) ? `${text.slice(0, around.from)}{ ${words} }${text.slice(around.to)}` : text;
  }
  // Behind the last key of the table, or behind its header.
  const k = headers.findIndex((h) => !h.isList && h.table === table);
  if (k >= 0) {
    const before = all.filter((e) => e.header === k && e.brace < 0).pop();
    return putLine(text, before ? nextLine(text, before.to) : headers[k]!.to, key, value);
  }
  // A table of dotted keys has no header: another one follows them.
  const dotted = all.filter((e) => e.brace < 0 && isWithin(e.table, table) && isWithin(table, headers[e.header]?.table ?? "")).pop();
  if (dotted) return putLine(text, nextLine(text, dotted.to), below(headers[dotted.header]?.table ?? ""), value);
  return `${text}${text === "" || text.endsWith("\n") ? "" : "\n"}${text === "" ? "" : "\n"}[${table}]\n${key} = ${value}\n`;
}
