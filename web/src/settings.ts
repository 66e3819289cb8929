// The form of a job's settings, made from the schema that the command line prints.
//
// The text of the job is the only state: a field changes one value of it, and a changed text fills the fields anew.

import type { Profile } from "./api";
import { el } from "./dom";
import { get, set } from "./toml";

export interface Schema { type?: string | string[]; properties?: Record<string, Schema>; description?: string; default?: unknown; enum?: unknown[]; oneOf?: { const: unknown; description: string }[]; minimum?: number; maximum?: number; items?: Schema; minItems?: number; maxItems?: number; "x-first-stage"?: string }

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

/** What a user typed as TOML, or null where it fits no type of the row. */
export function typed(row: Schema, text: string): string | null {
  const types = [row.type ?? []].flat();
  const word = text.trim();
  if (row.enum) return row.enum.includes(word) ? JSON.stringify(word) : null;
  const isNumber = (t: string) => /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(t);
  if (types.includes("array") && /^\[/.test(word)) {
    const parts = word.replace(/^\[|\]$/g, "").split(",").map((p) => p.trim()).filter((p) => p);
    return parts.every(isNumber) ? `[${parts.join(", ")}]` : null;
  }
  if ((types.includes("number") || types.includes("integer")) && isNumber(word)) {
    const n = Number(word);
    if (types.includes("integer") && !types.includes("number") && !Number.isInteger(n)) return null;
    if ((row.minimum !== undefined && n < row.minimum) || (row.maximum !== undefined && n > row.maximum)) return null;
    // TOML wants a digit on both sides of the point.
    return word.replace(/^([+-]?)\./, "$10.").replace(/\.$/, ".0");
  }
  // The planner tells what is wrong in a table.
  if (types.includes("object") && /^\{.*\}$/.test(word)) return word;
  if (types.includes("boolean")) return ["true", "false"].includes(word) ? word : null;
  return types.includes("string") ? JSON.stringify(word) : null;
}

interface Row { table: string; key: string; schema: Schema }

function rowsOf(section: string, schema: Schema): Row[] {
  return Object.entries(schema.properties ?? {}).flatMap(([key, row]) =>
    row.properties ? rowsOf(`${section}.${key}`, row) : isSimple(row) ? [{ table: section, key, schema: row }] : []);
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
          n += row.hidden ? 0 : 1;
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
    const put = (value: string | null) => { this.change(set(this.text(), table, key, value)); this.refresh(); };
    const wrong = el("span", { class: "wrong", role: "alert" });
    let input: HTMLInputElement | HTMLSelectElement;
    if (schema.enum) {
      const about = new Map((schema.oneOf ?? []).map((o) => [o.const, o.description]));
      input = el("select", { id }, ...schema.enum.map((word) => el("option", { value: String(word), title: about.get(word) ?? "" }, String(word))));
    } else if ([schema.type].flat().includes("boolean")) {
      input = el("select", { id }, el("option", { value: "true" }, "true"), el("option", { value: "false" }, "false"));
    } else input = el("input", { id, type: "text", spellcheck: "false" });
    // Start and end programs have many lines, which a field of one line would lose.
    const isLong = (value: string) => value.includes("\n");
    input.addEventListener("change", () => {
      const value = typed(schema, input.value);
      const range = schema.minimum !== undefined ? ` from ${schema.minimum} to ${schema.maximum}` : "";
      wrong.textContent = value === null ? `should be ${[schema.type].flat().join(" or ")}${range}` : "";
      if (value !== null) put(value);
    });
    const reset = el("button", { type: "button", title: "Take the line out of the job", "aria-label": `Reset ${table}.${key}`, onclick: () => { wrong.textContent = ""; put(null); } }, "↺");
    const origin = el("span", { class: "note" });
    const made = el("div", { class: "setting" }, el("label", { for: id }, `${key}`), el("div", { class: "value" }, input, reset), el("p", { class: "note" }, schema.description ?? "", schema["x-first-stage"] === "stress" ? " A change solves the stress again. " : " ", origin), wrong);
    made.dataset.words = `${table}.${key} ${schema.description ?? ""}`.toLowerCase();
    this.update.push(() => {
      const stated = get(this.text(), table, key);
      const other = this.unstated(row);
      made.dataset.stated = stated === null ? "" : "yes";
      reset.hidden = stated === null;
      const value = plain(stated ?? other.value);
      input.disabled = isLong(value);
      if (document.activeElement !== input) input.value = isLong(value) ? "(several lines: change it in the text)" : value;
      origin.textContent = stated === null ? `(${other.from})` : `(${other.from}: ${plain(other.value) || "none"})`;
    });
    return made;
  }
}
