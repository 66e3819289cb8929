// The job: its text, the profiles, and what runs of it gave.

import * as api from "./api";
import { el } from "./dom";
import type { Open } from "./main";
import { SettingsForm, plain } from "./settings";
import { get, set } from "./toml";

interface Parts { run: (wanted: Record<string, unknown>) => Promise<api.JobState | null>; say: (message: string, isError?: boolean) => void }

/** A text as TOML writes it: a JSON string is a TOML string too. */
export const quoted = (text: string) => JSON.stringify(text);

export class JobPanel {
  private editor: HTMLTextAreaElement | null = null;
  private opened: Open | null = null;
  private saved = "";
  private folder = "";
  /** Texts before and after the present one. */
  private before: string[] = [];
  private after: string[] = [];
  private isTyping = false;
  private changed: () => void = () => {};
  /** Called with the text whenever it changes, and with null where no job is open. */
  onText: (text: string | null) => void = () => {};

  constructor(private readonly panel: HTMLElement, private readonly parts: Parts) { this.close(); }

  close(): void {
    this.editor = null;
    this.opened = null;
    this.changed = () => {};
    [this.before, this.after] = [[], []];
    this.panel.replaceChildren(el("p", { class: "note" }, "A job says how a part is made: its shape, printer, material, loads and fill. Open a mesh or a job file to plan it."));
  }

  /** The text of the job, if one is open. */
  text(): string | null { return this.editor?.value ?? null; }

  /** What the server needs to run the job: the file as it is, or the text that was edited. */
  wanted(): Record<string, unknown> | null {
    if (!this.editor || !this.opened) return null;
    const isUnchanged = this.opened.kind === "job" && this.editor.value === this.saved;
    if (isUnchanged) return { file: this.opened.path };
    return { text: this.absolute(this.editor.value), name: this.opened.name.replace(/\.[^.]*$/, "") };
  }

  /** What runs is saved elsewhere, so files that the opened job names beside itself are named in full. */
  private absolute(text: string): string {
    if (this.opened?.kind !== "job") return text;
    const files: [string, string][] = [["shape", "mesh"], ["shape", "outline"], ["guide", "import"]];
    const profiles: [string, string][] = [["printer", "profile"], ["material", "profile"], ["process", "profile"]];
    for (const [table, key] of [...files, ...profiles]) {
      const name = plain(get(text, table, key) ?? "");
      const isFile = key !== "profile" || name.endsWith(".toml");
      if (name && isFile && !/^([/\\]|[A-Za-z]:)/.test(name)) text = set(text, table, key, quoted(`${this.folder}/${name}`));
    }
    return text;
  }

  /** Puts another text in place of the present one, which can be undone. */
  put(text: string): void {
    if (!this.editor || this.editor.value === text) return;
    this.record();
    this.isTyping = false;
    this.editor.value = text;
    this.changed();
  }

  private record(): void {
    this.before.push(this.shown);
    this.after = [];
  }

  get canUndo(): boolean { return this.before.length > 0; }
  get canRedo(): boolean { return this.after.length > 0; }
  undo(): void { this.step(this.before, this.after); }
  redo(): void { this.step(this.after, this.before); }

  private step(from: string[], to: string[]): void {
    const text = from.pop();
    if (text === undefined || !this.editor) return;
    to.push(this.editor.value);
    this.isTyping = false;
    this.editor.value = text;
    this.changed();
  }

  /** The text that the page has seen last. */
  private shown = "";

  async open(opened: Open): Promise<void> {
    this.opened = opened;
    try {
      if (opened.kind === "job") {
        const { text, folder } = await api.text(opened.path);
        [this.saved, this.folder] = [text, folder];
      } else this.saved = await this.jobOf(opened);
      await this.build();
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
  }

  private async jobOf(opened: Open): Promise<string> {
    const isOutline = opened.kind === "outline";
    const shape = isOutline ? `outline = ${quoted(opened.path)}\nthickness_mm = 4    # a drawing has no height: say how thick the part is` : `mesh = ${quoted(opened.path)}`;
    return `[shape]\n${shape}\n\n[printer]\nprofile = "generic-0.4"\n\n[material]\nprofile = "pla"\n\n[process]\nprofile = "standard"\n\n[output]\ngcode = ${quoted(opened.name.replace(/\.[^.]*$/, "") + ".gcode")}\nreport = "report.html"\n`;
  }

  private async build(): Promise<void> {
    const [{ profiles }, schema] = await Promise.all([api.profiles(), api.schema()]);
    const editor = el("textarea", { spellcheck: "false", "aria-label": "Job file, TOML", oninput: () => {
      // All that is typed in one go is undone in one go.
      if (!this.isTyping) this.record();
      this.isTyping = true;
      changed();
    } });
    editor.value = this.saved;
    this.editor = editor;
    [this.before, this.after, this.isTyping, this.shown] = [[], [], false, this.saved];
    const form = new SettingsForm(schema, profiles, () => editor.value, (text) => this.put(text));
    const tier = el("p", { class: "note" });
    const selects: (() => void)[] = [];
    const changed = () => {
      this.shown = editor.value;
      form.refresh();
      tier.textContent = this.tier(profiles, editor.value);
      selects.forEach((u) => u());
      this.onText(editor.value);
    };
    this.changed = changed;
    const choice = (kind: string) => {
      const select = el("select", { onchange: () => this.put(set(editor.value, kind, "profile", quoted(select.value))) },
        ...profiles.filter((p) => p.kind === kind).map((r) => el("option", { value: r.name, title: r.about }, r.name)));
      selects.push(() => {
        const name = (get(editor.value, kind, "profile") ?? "").replace(/^"|"$/g, "");
        // A profile of the user's own is a file.
        if (name && ![...select.options].some((o) => o.value === name)) select.append(el("option", { value: name }, name));
        if (name) select.value = name;
      });
      return el("label", {}, kind[0]!.toUpperCase() + kind.slice(1), select);
    };
    const plan = el("button", { type: "button", class: "main", onclick: () => void this.plan() }, "Plan the paths");
    this.panel.replaceChildren(
      el("h2", {}, "Printer, material, process"), el("div", { class: "row" }, choice("printer"), choice("material"), choice("process")), tier,
      el("h2", {}, "Settings"), form.element,
      el("h2", {}, "Job file"), editor,
      el("p", { class: "note" }, "What runs is this text, saved as a job file: the command line gives the same bytes from it."),
      el("div", { class: "row" }, plan),
    );
    changed();
  }

  /** What the material's card rests on. */
  private tier(profiles: api.Profile[], text: string): string {
    const name = get(text, "material", "profile")?.replace(/^"|"$/g, "") ?? "pla";
    const toml = profiles.find((p) => p.kind === "material" && p.name === name)?.toml ?? "";
    const found = toml.match(/strength_tier\s*=\s*"([^"]*)"/)?.[1];
    return found ? `Strength card of ${name}: tier ${found}` : `${name}: no strength card`;
  }

  async plan(): Promise<void> {
    const wanted = this.wanted();
    if (!wanted) return;
    const end = await this.parts.run({ kind: "plan", ...wanted });
    if (end) document.dispatchEvent(new CustomEvent("planned", { detail: end.id }));
  }
}
