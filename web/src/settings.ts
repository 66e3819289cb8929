// The form of a job's settings, made from the schema that the command line prints.
//
// The text of the job is the only state: a field changes one value of it, and a changed text fills the fields anew.

import type { Profile } from "./api";
import { complain, decimal, el, showValue } from "./dom";
import { entries, get, set } from "./toml";

export interface Schema { type?: string | string[]; properties?: Record<string, Schema>; description?: string; default?: unknown; enum?: unknown[]; oneOf?: (Schema & { const?: unknown })[]; pattern?: string; minimum?: number; maximum?: number; items?: Schema; minItems?: number; maxItems?: number; "x-first-stage"?: string }

/** Settings that a field can change: one value, or a short list of numbers. */
function isSimple(row: Schema): boolean {
  const types = [row.type ?? []].flat();
  if (row.enum || types.some((t) => ["number", "integer", "boolean"].includes(t))) return true;
  if (types.includes("array")) return row.items?.type === "number" || row.items?.type === "integer";
  return types.includes("string");
}

/** A value of the schema as TOML writes it. */
function written(value: unknown): string {
  return Array.isArray(value) ? `[${value.map(written).join(", ")}]` : JSON.stringify(value);
}

/** What is wrong in a list of numbers whose comma may stand before decimals or between two numbers, or "". */
export function commaWord(row: Schema, text: string): string {
  const [found, before, after] = row.items?.type === "number" && /^\s*\[/.test(text) ? text.match(/(\d+),(\d+)/) ?? [] : [];
  return found ? `${found} may be ${before}.${after} or two numbers, ${before}, ${after}: write a point or a space` : "";
}

/** What a user typed as TOML, or null where it fits no type of the row. */
export function typed(row: Schema, text: string): string | null {
  const types = [row.type ?? []].flat();
  const word = text.trim();
  if (row.enum) return row.enum.includes(word) ? JSON.stringify(word) : null;
  if (types.includes("array") && /^\[/.test(word)) {
    if (commaWord(row, word)) return null;
    const parts = word.replace(/^\[|\]$/g, "").split(",").filter((p) => p.trim()).map(decimal);
    return parts.every((p) => p !== null) ? `[${parts.join(", ")}]` : null;
  }
  const number = types.includes("number") || types.includes("integer") ? decimal(word) : null;
  if (number !== null) {
    const n = Number(number);
    if (types.includes("integer") && !types.includes("number") && !Number.isInteger(n)) return null;
    return (row.minimum !== undefined && n < row.minimum) || (row.maximum !== undefined && n > row.maximum) ? null : number;
  }
  // The planner tells what is wrong in a table.
  if (types.includes("object") && /^\{.*\}$/.test(word)) return word;
  if (types.includes("boolean")) return ["true", "false"].includes(word) ? word : null;
  return types.includes("string") && (!row.pattern || new RegExp(row.pattern).test(word)) ? JSON.stringify(word) : null;
}

/** A row of the form. `other` says what else may stand for its table: a value, which hides it, or a file alone, which is its path. */
interface Row { table: string; key: string; schema: Schema; other: "value" | "path" | null }

const tableOf = (schema: Schema) => schema.properties ?? schema.oneOf?.find((o) => o.properties)?.properties;

export function rowsOf(section: string, schema: Schema): Row[] {
  const other = isSimple(schema) ? "value" : schema.oneOf ? "path" : null;
  return Object.entries(tableOf(schema) ?? {}).flatMap(([key, row]) =>
    [...(isSimple(row) ? [{ table: section, key, schema: row, other } as Row] : []), ...rowsOf(`${section}.${key}`, row)]);
}

/** Names of the settings that the shape and the stress of a part do not depend on. */
export function settingsOfPaths(schema: Schema, above = ""): string[] {
  return Object.entries((above === "" ? schema.properties : tableOf(schema)) ?? {}).flatMap(([key, row]) => [...(row["x-first-stage"] === "paths" ? [above + key] : []), ...settingsOfPaths(row, `${above}${key}.`)]);
}

/** Whether a text states keys of a table. */
const isStated = (text: string, table: string) => entries(text).some((e) => e.table === table);

/** The table above that of a row, and the name that it has there. */
const split = (table: string): [string, string] => [table.replace(/\.?[^.]*$/, ""), table.replace(/^.*\./, "")];
/** What a text states in place of the table of a row. */
const inPlace = (text: string, row: Row) => get(text, ...split(row.table));

const isBraced = (written: string | null) => written?.startsWith("{") ?? false;

/** The value of a row as a text states it; a file that stands for a table is its path. */
const statedValue = (text: string, row: Row) => get(text, row.table, row.key) ?? (row.other === "path" && row.key === "path" && !isBraced(inPlace(text, row)) ? inPlace(text, row) : null);

/** The text with another value of a row; a file that stands for its table becomes the path in it. */
export function state(text: string, row: Row, value: string | null): string {
  const file = row.other === "path" ? inPlace(text, row) : null;
  if (file === null || isBraced(file)) return set(text, row.table, row.key, value);
  text = set(text, ...split(row.table), row.key === "path" ? value : null);
  return row.key === "path" ? text : set(set(text, row.table, "path", file), row.table, row.key, value);
}

/** A value as a field shows it. */
export function plain(toml: string): string {
  const long = toml.match(/^("""|''')\r?\n?([\s\S]*)\1$/);
  if (long) return long[2]!;
  if (/^'.*'$/.test(toml)) return toml.slice(1, -1);
  if (!/^".*"$/.test(toml)) return toml;
  // A few escapes of TOML are none of JSON; such a text is shown as it is written.
  try { return JSON.parse(toml) as string; } catch { return toml; }
}

export class SettingsForm {
  readonly element: HTMLElement;
  private readonly update: (() => void)[] = [];

  constructor(schema: Schema, private readonly profiles: Profile[], private readonly text: () => string, private readonly change: (text: string) => void) {
    const search = el("input", { type: "search", placeholder: "Search the settings", "aria-label": "Search the settings", oninput: () => {
      const words = search.value.toLowerCase().split(/\s+/).filter((w) => w);
      for (const group of groups) {
        let n = 0;
        for (const row of group.querySelectorAll<HTMLElement>(".setting")) {
          row.hidden = !words.every((w) => row.dataset.words!.includes(w));
          n += row.hidden || row.dataset.off ? 0 : 1;
        }
        group.hidden = n === 0;
        group.open = words.length > 0 && n > 0;
      }
    } });
    const groups = Object.entries(schema.properties ?? {}).filter(([, s]) => s.properties).map(([section, s]) => {
      const count = el("span", { class: "note" });
      const rows = rowsOf(section, s).map((row) => this.field(row));
      this.update.push(() => {
        const n = rows.filter((r) => r.dataset.stated).length;
        count.textContent = n > 0 ? ` ${n} stated` : "";
      });
      return el("details", { class: "settings" }, el("summary", {}, section, count), ...rows);
    });
    this.element = el("div", {}, search, ...groups);
    this.refresh();
  }

  /** Fills the fields from the text. */
  refresh(): void { this.update.forEach((u) => u()); }

  /** What counts where the job states nothing: the profile, then the default. */
  private unstated(row: Row): { value: string; from: string } {
    const name = get(this.text(), row.table, "profile");
    const profile = this.profiles.find((p) => p.kind === row.table && (name ? p.name === plain(name) : false));
    const own = profile ? get(profile.toml, "", row.key) : null;
    if (own !== null) return { value: own, from: `profile ${profile!.name}` };
    return { value: row.schema.default === undefined ? "" : written(row.schema.default), from: "default" };
  }

  private field(row: Row): HTMLElement {
    const { table, key, schema } = row;
    const id = `set-${table}-${key}`;
    const put = (value: string | null) => { this.change(state(this.text(), row, value)); this.refresh(); };
    let input: HTMLInputElement | HTMLSelectElement;
    if (schema.enum) {
      const about = new Map((schema.oneOf ?? []).map((o) => [o.const, o.description]));
      input = el("select", { id }, ...schema.enum.map((word) => el("option", { value: String(word), title: about.get(word) ?? "" }, String(word))));
    } else if ([schema.type].flat().includes("boolean")) {
      input = el("select", { id }, el("option", { value: "true" }, "true"), el("option", { value: "false" }, "false"));
    } else input = el("input", { id, type: "text", spellcheck: "false" });
    // Start and end programs have many lines, which a field of one line would lose.
    const isLong = (value: string) => value.includes("\n");
    const judged = () => {
      const value = typed(schema, input.value);
      const range = schema.minimum !== undefined ? ` from ${schema.minimum} to ${schema.maximum}` : "";
      complain(input, value === null ? commaWord(schema, input.value) || `should be ${[schema.type].flat().join(" or ")}${range}` : "", around);
      return value;
    };
    input.addEventListener("input", judged);
    input.addEventListener("change", () => {
      const value = judged();
      if (value !== null) put(value);
    });
    const reset = el("button", { type: "button", title: "Take the line out of the job", "aria-label": `Reset ${table}.${key}`, onclick: () => { complain(input, "", around); put(null); } }, "↺");
    const around = el("div", { class: "value" }, input, reset);
    const origin = el("span", { class: "note" });
    const made = el("div", { class: "setting" }, el("label", { for: id }, (table.includes(".") ? `${table.split(".").slice(1).join(".")}.` : "") + key), around, el("p", { class: "note" }, schema.description ?? "", schema["x-first-stage"] === "stress" ? " A change solves the stress again. " : " ", origin));
    made.dataset.words = `${table}.${key} ${schema.description ?? ""}`.toLowerCase();
    this.update.push(() => {
      const text = this.text();
      const stated = statedValue(text, row);
      const isTable = stated === null && tableOf(schema) !== undefined && isStated(text, `${table}.${key}`);
      // Another value in place of its table would be stated twice by a row of it.
      const instead = inPlace(text, row);
      made.dataset.off = (row.other === "value" ? !isStated(text, table) : instead !== null && row.other === null && !isBraced(instead)) ? "yes" : "";
      const other = this.unstated(row);
      made.dataset.stated = stated === null ? "" : "yes";
      reset.hidden = stated === null;
      const value = plain(stated ?? other.value);
      input.disabled = isLong(value) || isTable;
      if (document.activeElement !== input) showValue(input, isTable ? "(a table: its rows follow)" : isLong(value) ? "(several lines: change it in the text)" : value, around);
      origin.textContent = stated === null ? `(${other.from})` : `(${other.from}: ${plain(other.value) || "none"})`;
    });
    return made;
  }
}
