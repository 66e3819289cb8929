// Reading and changing single values of a job's text, so that comments and the order of lines stay.
//
// This is no reader of TOML: the server reads jobs. It finds where the value of a key begins and ends, with strings,
// comments, arrays and tables over several lines told apart.

/** A key with its value: the table it is in, and the place of the value in the text. */
export interface Entry { table: string; isList: boolean; key: string; from: number; to: number }

/** The header of a table: `[name]`, or `[[name]]` for one of a list. */
interface Header { table: string; isList: boolean; from: number; to: number }

/** The end of the value that begins at `at`: behind it comes a comment, the end of the line, or what closes around it. */
function endOfValue(text: string, at: number): number {
  let depth = 0;
  for (let i = at; i < text.length; ) {
    const c = text[i]!;
    if (c === '"' || c === "'") {
      const triple = c.repeat(3);
      if (text.startsWith(triple, i)) {
        const end = text.indexOf(triple, i + 3);
        i = end < 0 ? text.length : end + 3;
        continue;
      }
      i++;
      while (i < text.length && text[i] !== c && text[i] !== "\n") i += c === '"' && text[i] === "\\" ? 2 : 1;
      i++;
      continue;
    }
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

const unquoted = (key: string) => key.split(".").map((part) => part.trim().replace(/^(["'])(.*)\1$/, "$2")).join(".");

/** All keys of the text, in order. */
export function entries(text: string): Entry[] { return scan(text).found; }

/** The text that was scanned last: the form asks for every setting of one text. */
let last: { text: string; found: Entry[]; headers: Header[] } = { text: "", found: [], headers: [] };

function scan(text: string): typeof last {
  if (text === last.text) return last;
  const found: Entry[] = [];
  const headers: Header[] = [];
  let table = "";
  let isList = false;
  for (let at = 0; at < text.length; ) {
    const end = text.indexOf("\n", at) < 0 ? text.length : text.indexOf("\n", at);
    const line = text.slice(at, end);
    const header = line.match(/^\s*(\[\[?)\s*([^\]]+?)\s*\]\]?\s*(#.*)?$/);
    const pair = line.match(/^(\s*([A-Za-z0-9_.\-"' ]+?)\s*=\s*)\S/);
    if (header) {
      table = unquoted(header[2]!);
      isList = header[1] === "[[";
      headers.push({ table, isList, from: at, to: Math.min(end + 1, text.length) });
    } else if (pair) {
      const from = at + pair[1]!.length;
      const to = endOfValue(text, from);
      const whole = unquoted(pair[2]!).split(".");
      const key = whole.pop()!;
      found.push({ table: [table, ...whole].filter((p) => p).join("."), isList, key, from, to });
      const rest = text.indexOf("\n", to);
      at = rest < 0 ? text.length : rest + 1;
      continue;
    }
    at = end + 1;
  }
  return (last = { text, found, headers });
}

/** A table of a list, `[[name]]`: its lines in the text and its keys. `isPlain` where it has no tables of its own below it. */
export interface Block { table: string; from: number; to: number; keys: Map<string, Entry>; isPlain: boolean }

/** The tables of these lists, in the order of the text. */
export function blocks(text: string, ...tables: string[]): Block[] {
  const { found, headers } = scan(text);
  const made: Block[] = [];
  headers.forEach((header, k) => {
    if (!header.isList || !tables.includes(header.table)) return;
    const next = headers[k + 1];
    const own = found.filter((e) => e.from >= header.to && e.from < (next?.from ?? text.length));
    const last = own[own.length - 1];
    const end = last ? text.indexOf("\n", last.to) : header.to - 1;
    const isPlain = own.every((e) => e.table === header.table) && !next?.table.startsWith(`${header.table}.`);
    made.push({ table: header.table, from: header.from, to: end < 0 ? text.length : end + 1, keys: new Map(own.filter((e) => e.table === header.table).map((e) => [e.key, e])), isPlain });
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

/** The text with another value of a key of a block; null takes the line away. */
export function change(text: string, block: Block, key: string, value: string | null): string {
  const found = block.keys.get(key);
  if (found && value !== null) return text.slice(0, found.from) + value + text.slice(found.to);
  if (found) {
    const from = text.lastIndexOf("\n", found.from) + 1;
    const rest = text.indexOf("\n", found.to);
    return text.slice(0, from) + (rest < 0 ? "" : text.slice(rest + 1));
  }
  return value === null ? text : `${text.slice(0, block.to)}${text.slice(0, block.to).endsWith("\n") ? "" : "\n"}${key} = ${value}\n${text.slice(block.to)}`;
}

export type Value = string | number | boolean | Value[] | { [key: string]: Value };

/** A value as it is written, read: texts, numbers, truth values, arrays, tables in braces. Undefined for what is none of them. */
export function value(text: string): Value | undefined {
  let at = 0;
  const skip = () => { for (;;) { while (/\s/.test(text[at] ?? "")) at++; if (text[at] !== "#") return; const end = text.indexOf("\n", at); at = end < 0 ? text.length : end; } };
  class Wrong extends Error {}
  const expect = (c: string) => { skip(); if (text[at] !== c) throw new Wrong(); at++; };
  const one = (): Value => {
    skip();
    const c = text[at];
    if (c === '"' || c === "'") {
      const end = endOfValue(text, at);
      const found = c === '"' ? /^"(?:[^"\\\n]|\\.)*"/.exec(text.slice(at, end)) : /^'[^'\n]*'/.exec(text.slice(at, end));
      if (!found) throw new Wrong();
      at += found[0].length;
      return c === '"' ? (JSON.parse(found[0]) as string) : found[0].slice(1, -1);
    }
    if (c === "[") {
      at++;
      const all: Value[] = [];
      for (skip(); text[at] !== "]"; skip()) { all.push(one()); skip(); if (text[at] === ",") at++; else if (text[at] !== "]") throw new Wrong(); }
      at++;
      return all;
    }
    if (c === "{") {
      at++;
      const all: { [key: string]: Value } = {};
      for (skip(); text[at] !== "}"; skip()) {
        const key = /^[A-Za-z0-9_-]+/.exec(text.slice(at))?.[0];
        if (!key) throw new Wrong();
        at += key.length;
        expect("=");
        all[key] = one();
        skip();
        if (text[at] === ",") at++; else if (text[at] !== "}") throw new Wrong();
      }
      at++;
      return all;
    }
    const word = /^[A-Za-z0-9_+.-]+/.exec(text.slice(at))?.[0];
    if (!word) throw new Wrong();
    at += word.length;
    if (word === "true" || word === "false") return word === "true";
    const number = Number(word.replaceAll("_", ""));
    if (Number.isNaN(number)) throw new Wrong();
    return number;
  };
  try { const read = one(); skip(); return at === text.length ? read : undefined; } catch { return undefined; }
}

/** The value of a key as it is written, or null where the text does not state it. */
export function get(text: string, table: string, key: string): string | null {
  const found = entries(text).find((e) => !e.isList && e.table === table && e.key === key);
  return found ? text.slice(found.from, found.to) : null;
}

/** The text with another value of a key; null takes the line away. */
export function set(text: string, table: string, key: string, value: string | null): string {
  const all = entries(text);
  const found = all.find((e) => !e.isList && e.table === table && e.key === key);
  if (found) {
    if (value !== null) return text.slice(0, found.from) + value + text.slice(found.to);
    const from = text.lastIndexOf("\n", found.from) + 1;
    const rest = text.indexOf("\n", found.to);
    return text.slice(0, from) + (rest < 0 ? "" : text.slice(rest + 1));
  }
  if (value === null) return text;
  const line = `${key} = ${value}\n`;
  // Behind the last key of the table, or behind its header.
  const header = new RegExp(`^[ \\t]*\\[\\s*${table.replaceAll(".", "\\s*\\.\\s*")}\\s*\\][^\\n]*(\\n|$)`, "m").exec(text);
  if (!header) return `${text}${text === "" || text.endsWith("\n") ? "" : "\n"}${text === "" ? "" : "\n"}[${table}]\n${line}`;
  let at = header.index + header[0].length;
  for (const e of all) {
    if (e.from < at || e.isList || e.table !== table) continue;
    const end = text.indexOf("\n", e.to);
    // Keys of the same table behind another header are of a dotted key and not of this place.
    if (/^\s*\[/m.test(text.slice(header.index + header[0].length, e.from).replace(/^[^\n]*=[^\n]*$/gm, ""))) break;
    at = end < 0 ? text.length : end + 1;
  }
  const before = text.slice(0, at);
  return `${before}${before.endsWith("\n") ? "" : "\n"}${line}${text.slice(at)}`;
}
