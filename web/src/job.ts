// The job: its text, the profiles, and what runs of it gave.

import * as api from "./api";
import { BoardPicture, type Point } from "./board";
import { byId, el, numberField, numberOf, showValue } from "./dom";
import { drafts, forget, keep } from "./drafts";
import { absolute } from "./paths_of_job";
import type { Open } from "./main";
import { SettingsForm, plain, settingsOfPaths, type Schema } from "./settings";
import { entries, get, set, value } from "./toml";

interface Parts {
  run: (wanted: Record<string, unknown>) => Promise<api.JobState | null>; say: (message: string, isError?: boolean) => void;
  /** The job that is open has another file from now on. */
  renamed: (path: string) => void;
}

/** How long the text has to rest before it is checked, ms. Source: chosen; a pause between two words. */
const REST_MS = 400;

/** What is typed after such a pause is undone by itself, ms. Source: chosen; longer than between two words, shorter than a thought. */
const PAUSE_MS = 1000;

/** Settings that no solver reads, and whose values are told beside the stress: its peak is compared with the strength along the beads. */
const TOLD_WITH_STRESS = ["material.xt_mpa"];

/** A text as TOML writes it: a JSON string is a TOML string too. */
export const quoted = (text: string) => JSON.stringify(text);

/** A text with the ends of lines that fields of the browser have. */
const ended = (text: string) => text.replace(/\r\n?/g, "\n");

export class JobPanel {
  private editor: HTMLTextAreaElement | null = null;
  private opened: Open | null = null;
  /** The text of the file, as it is there and as the page has it: fields of several lines end each of them in a line feed alone. */
  private file = "";
  private saved = "";
  private folder = "";
  /** The photograph of the job with its corners; null for jobs of other shapes. */
  private picture: BoardPicture | null = null;
  private isActive = false;
  /** The choice of the printer and the material, with what the material's card rests on, for the panel of the shape. */
  readonly printerAndMaterial = el("div", { id: "printer-and-material" });
  /** Texts before and after the present one. */
  private before: string[] = [];
  private after: string[] = [];
  /** Where and when a letter was typed last; null after a change of another kind. */
  private typed: { caret: number; at_ms: number } | null = null;
  private changed: () => void = () => {};
  /** What to tell of changes that were found when the job was opened. */
  notice: string | null = null;
  /** Called with the text whenever it changes, and with null where no job is open. */
  onText: (text: string | null) => void = () => {};

  constructor(private readonly panel: HTMLElement, private readonly parts: Parts) { this.close(); }

  close(): void {
    this.dropPicture();
    this.editor = null;
    this.opened = null;
    this.notice = null;
    this.changed = () => {};
    [this.before, this.after] = [[], []];
    this.panel.replaceChildren(el("p", { class: "note" }, "A job says how a part is made: its shape, printer, material, loads and fill. Open a mesh or a job file to plan it."));
  }

  /** Settings that a stress does not depend on. */
  private ofPaths = new Set<string>();
  private profiles: api.Profile[] = [];

  /**
   * All that the stress of a text and what is told of it depend on: its settings without those of the paths, and the same of
   * its profiles.
   */
  stressOf(text: string): string {
    const isWanted = (path: string[]) => TOLD_WITH_STRESS.includes(path.join(".")) || !path.some((_, k) => this.ofPaths.has(path.slice(0, k + 1).join(".")));
    const rows: unknown[] = [];
    const add = (of: string, above: string[]) => {
      for (const e of entries(of)) {
        const path = [...above, ...e.path];
        const written = of.slice(e.from, e.to);
        if (path.length > 1 && path[path.length - 1] !== "profile" && isWanted(path)) rows.push([path.join("."), value(written) ?? written]);
      }
    };
    add(text, []);
    for (const kind of ["printer", "material", "process"]) {
      const name = plain(get(text, kind, "profile") ?? "");
      const known = this.profiles.find((p) => p.kind === kind && p.name === name);
      // A profile of the user's own is a file, and is known by its name.
      if (known) add(known.toml, [kind]); else rows.push([kind, name]);
    }
    return JSON.stringify(rows);
  }

  /** The text of the job, if one is open. */
  text(): string | null { return this.editor?.value ?? null; }

  /** What the server needs to run the job: the file as it is, or the text that was edited. */
  wanted(): Record<string, unknown> | null {
    if (!this.editor || !this.opened) return null;
    const isUnchanged = this.opened.kind === "job" && this.editor.value === this.saved;
    // A file that has changed on the disk since is refused: what runs is what is shown.
    if (isUnchanged) return { file: this.opened.path, shown: this.saved };
    return { text: this.textElsewhere(), name: this.opened.name.replace(/\.[^.]*$/, "") };
  }

  /** Takes the text of a file. */
  private take(file: string, folder: string): void { [this.file, this.saved, this.folder] = [file, ended(file), folder]; }

  /** A text of the page with the ends of lines that its file has; programs of the printer in it keep theirs. */
  private filed(text: string): string {
    if (text === this.saved) return this.file;
    return this.file.includes("\r\n") ? text.replaceAll("\n", "\r\n") : text;
  }

  /** The text as it reads in another folder. */
  private textElsewhere(): string {
    const text = this.filed(this.editor?.value ?? "");
    return this.opened?.kind === "job" ? absolute(text, this.folder) : text;
  }

  /** Saves the text under a new name below the working folder; that file is the open one from then on. */
  private async saveAs(name: string): Promise<void> {
    const { editor, opened } = this;
    if (!editor || !opened || !name.trim()) return;
    const text = this.textElsewhere();
    try {
      const { path } = await api.save(/\.toml$/i.test(name) ? name.trim() : `${name.trim()}.toml`, text);
      // Another job may be open by now, or more may have been typed.
      if (this.editor === editor) {
        const now = this.textElsewhere();
        this.opened = { path, kind: "job", name: path.split(/[/\\]/).pop() ?? path };
        this.take(text, path.replace(/[/\\][^/\\]*$/, ""));
        if (ended(now) === editor.value) this.changed(); else this.put(ended(now));
        this.parts.renamed(path);
      }
      await forget(opened.path);
      this.parts.say(`Saved as ${path}`);
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
  }

  /** Puts another text in place of the present one, which can be undone. */
  put(text: string): void {
    if (!this.editor || this.editor.value === text) return;
    this.record();
    this.typed = null;
    this.editor.value = text;
    this.changed();
  }

  /** Puts another value of a key into the text; null takes it out. */
  state(table: string, key: string, value: string | null): void {
    const text = set(this.text() ?? "", table, key, value);
    if (value !== null && get(text, table, key) === null) this.parts.say(`${table} is no table in the text of the job: change it there.`, true);
    else this.put(text);
  }

  private record(): void {
    this.before.push(this.shown);
    this.after = [];
  }

  get canUndo(): boolean { return this.before.length > 0; }
  get canRedo(): boolean { return this.after.length > 0; }
  undo(): void { this.step(this.before, this.after); }
  redo(): void { this.step(this.after, this.before); }
  /** Whether an element is the field of the text. */
  isText(element: Element): boolean { return element === this.editor; }

  private step(from: string[], to: string[]): void {
    const text = from.pop();
    if (text === undefined || !this.editor) return;
    const { editor } = this;
    const [now, least] = [editor.value, Math.min(editor.value.length, text.length)];
    to.push(now);
    this.typed = null;
    editor.value = text;
    // The cursor goes behind what has changed, as it does in the browser's own fields.
    let same = 0;
    while (same < least && now[now.length - 1 - same] === text[text.length - 1 - same]) same++;
    editor.setSelectionRange(text.length - same, text.length - same);
    this.changed();
  }

  /** The text that the page has seen last. */
  private shown = "";

  /** Nothing can be typed before changes that were not saved are here too. */
  async open(opened: Open): Promise<void> {
    this.close();
    this.opened = opened;
    try {
      const isJob = opened.kind === "job";
      const [{ text, folder }, all, { profiles }, schema] = await Promise.all([isJob ? api.text(opened.path) : api.jobFor(opened.path), drafts(), api.profiles(), api.schema()]);
      // Another file may have been opened meanwhile.
      if (this.opened !== opened) return;
      this.take(text, isJob ? folder : "");
      this.build(profiles, schema);
      this.takeDraft(all.find((d) => d.path === opened.path));
    } catch (error) {
      if (this.opened !== opened) return;
      this.close();
      this.parts.say((error as Error).message, true);
    }
  }

  /** Puts changes of this file that were not saved back, or offers them where the file is another one by now. */
  private takeDraft(draft: api.Draft | undefined): void {
    if (!draft || ended(draft.text) === this.saved) return;
    const when = new Date(1000 * draft.at_s).toLocaleString();
    if (ended(draft.from) === this.saved) {
      this.put(ended(draft.text));
      this.notice = `Your changes of ${when}, which were not saved, are here again. Ctrl+Z takes the text of the file.`;
    } else {
      this.after = [ended(draft.text)];
      this.notice = `The file was changed since your changes of ${when}, which were not saved. Ctrl+Shift+Z takes yours.`;
    }
  }

  private build(profiles: api.Profile[], schema: Schema): void {
    const editor = el("textarea", { spellcheck: "false", "aria-label": "Job file, TOML", oninput: () => {
      // All that is typed in one go at one place is undone in one go.
      const [caret, at_ms, more] = [editor.selectionStart, performance.now(), editor.value.length - this.shown.length];
      const isOneGo = this.typed !== null && at_ms - this.typed.at_ms < PAUSE_MS && [caret, caret - more].includes(this.typed.caret);
      if (!isOneGo) this.record();
      this.typed = { caret, at_ms };
      changed();
    } });
    editor.value = this.saved;
    this.editor = editor;
    [this.before, this.after, this.typed, this.shown] = [[], [], null, this.saved];
    [this.ofPaths, this.profiles] = [new Set(settingsOfPaths(schema)), profiles];
    const form = new SettingsForm(schema, profiles, () => editor.value, (text) => this.put(text));
    const wrong = el("p", { class: "error", id: "job-error", role: "alert", hidden: true });
    let rest: ReturnType<typeof setTimeout> | undefined;
    const check = async () => {
      const text = editor.value;
      const message = await api.check(this.textElsewhere());
      if (this.editor !== editor || editor.value !== text) return;
      [wrong.textContent, wrong.hidden] = [message, message === ""];
    };
    const selects: (() => void)[] = [];
    const changed = () => {
      // The text of the file itself may be there before a draft of it is put back.
      if (this.opened && (this.before.length > 0 || this.after.length > 0)) keep({ path: this.opened.path, kind: this.opened.kind, text: this.filed(editor.value), from: this.file }).catch((e: Error) => this.parts.say(e.message, true));
      this.shown = editor.value;
      form.refresh();
      selects.forEach((u) => u());
      clearTimeout(rest);
      rest = setTimeout(() => void check(), REST_MS);
      this.onText(editor.value);
    };
    this.changed = changed;
    const tier = () => {
      const words = el("p", { class: "note tier" });
      selects.push(() => { words.textContent = this.tier(profiles, editor.value); });
      return words;
    };
    const choice = (kind: string) => {
      const select = el("select", { onchange: () => this.state(kind, "profile", quoted(select.value)) },
        ...profiles.filter((p) => p.kind === kind).map((r) => el("option", { value: r.name, title: r.about }, r.name)));
      selects.push(() => {
        const name = plain(get(editor.value, kind, "profile") ?? "");
        // A profile of the user's own is a file.
        if (name && ![...select.options].some((o) => o.value === name)) select.append(el("option", { value: name }, name));
        if (name) select.value = name;
      });
      return el("label", {}, kind[0]!.toUpperCase() + kind.slice(1), select);
    };
    const plan = el("button", { type: "button", class: "main", onclick: () => void this.plan() }, "Plan the paths");
    const name = el("input", { id: "save-name", "aria-label": "Name of the job file", placeholder: "name.toml", onkeydown: (event) => { if ((event as KeyboardEvent).key === "Enter") void this.saveAs(name.value); } });
    const save = el("button", { type: "button", id: "save-as", onclick: () => void this.saveAs(name.value) }, "Save as");
    const board = this.board();
    if (board) selects.push(board.fill);
    this.showPicture();
    this.printerAndMaterial.replaceChildren(el("h2", {}, "Printer and material"), el("div", { class: "row" }, choice("printer"), choice("material")), tier());
    this.panel.replaceChildren(
      ...(board ? [board.box] : []),
      el("h2", {}, "Printer, material, process"), el("div", { class: "row" }, choice("printer"), choice("material"), choice("process")), tier(),
      el("h2", {}, "Settings"), form.element,
      el("h2", {}, "Job file"), editor, wrong,
      el("p", { class: "note" }, "What runs is this text, saved as a job file: the command line gives the same bytes from it."),
      el("div", { class: "row" }, el("label", {}, "name, below the folder of results", name), save),
      el("div", { class: "row" }, plan),
    );
    changed();
  }

  /** The photograph lies over the view while the job is looked at. */
  setActive(isActive: boolean): void { this.isActive = isActive; this.showPicture(); }
  private showPicture(): void { if (this.picture) this.picture.element.hidden = !this.isActive; }
  private dropPicture(): void { this.picture?.element.remove(); this.picture = null; }

  /** The size and the corners of the board in a photograph, which no picture states; null for jobs of other shapes. */
  private board(): { box: HTMLElement; fill: () => void } | null {
    this.dropPicture();
    if (get(this.saved, "shape.photo", "files") === null) return null;
    const photos = () => {
      const names = value(get(absolute(this.text() ?? "", this.folder), "shape.photo", "files") ?? "");
      return Array.isArray(names) ? names.map(String) : [];
    };
    const stated = (): Point[] => {
      const corners = value(get(this.text() ?? "", "shape.photo", "corners_px") ?? "");
      const isPoint = (p: unknown) => Array.isArray(p) && p.length === 2 && p.every((v) => typeof v === "number");
      return Array.isArray(corners) && corners.length % 4 === 0 && corners.every(isPoint) ? (corners as Point[]) : [];
    };
    // Four corners hold for all pictures, or each has its own.
    const first = () => (stated().length > 4 ? 4 * which.selectedIndex : 0);
    const put = (corners: Point[] | null) => {
      const all = stated();
      if (corners) all.splice(first(), 4, ...corners);
      this.put(set(this.text() ?? "", "shape.photo", "corners_px", corners ? `[${all.map(([x, y]) => `[${x}, ${y}]`).join(", ")}]` : null));
    };
    const picture = (this.picture = new BoardPicture(put, (message) => this.parts.say(message, true)));
    byId("view").after(picture.element);
    const which = el("select", { id: "which-photo", onchange: () => fill() }, ...photos().map((name) => el("option", {}, name.split(/[/\\]/).pop() ?? name)));
    const drag = el("p", { class: "note" });
    const whole = el("button", { type: "button", id: "whole-photo", onclick: () => put(null) }, "The whole picture is the board");
    const inputs = ["width, mm", "height, mm", "thick, mm"].map((words, k) =>
      numberField({ id: `board-${k}`, "aria-label": words, placeholder: words }, { isPositive: true }, () => enter()));
    const enter = () => {
      const [width, height, thickness] = inputs.map(numberOf) as [number, number, number];
      let text = this.text() ?? "";
      if (width > 0 && height > 0) text = set(text, "shape.photo", "size_mm", `[${width}, ${height}]`);
      if (thickness > 0) text = set(text, "shape.photo", "thickness_mm", String(thickness));
      this.put(text);
    };
    const note = el("p", { class: "note" }, "No picture says how large the board in it is: measure it. Without corners the whole picture is the board.");
    const fill = () => {
      const [size, thickness] = ["size_mm", "thickness_mm"].map((key) => value(get(this.text() ?? "", "shape.photo", key) ?? ""));
      const known = [...(Array.isArray(size) ? size : [undefined, undefined]), thickness];
      inputs.forEach((input, k) => { if (input !== document.activeElement && typeof known[k] === "number") showValue(input, known[k]); });
      note.hidden = known.every((v) => typeof v === "number");
      const corners = stated();
      whole.disabled = corners.length === 0;
      const found = plain(get(this.text() ?? "", "shape.photo", "corners") ?? "");
      const isFound = corners.length === 0 && found !== "" && found !== "image";
      drag.textContent = `${isFound ? `The board is found by its ${found}, unless a ring is dragged. ` : ""}Drag the four rings to the corners of the board; the arrow keys move the ring that has the focus by a pixel, with shift by ten.`;
      const photo = photos()[which.selectedIndex];
      if (photo !== undefined) picture.show(api.picture(photo), corners.length >= first() + 4 ? corners.slice(first(), first() + 4) : null);
    };
    const several = photos().length > 1 ? [el("div", { class: "row" }, el("label", {}, "picture", which))] : [];
    return { box: el("div", { id: "board" }, el("h2", {}, "Board"), el("div", { class: "row three" }, ...inputs.map((input) => el("label", {}, input.placeholder, input))), note, ...several, drag, el("div", { class: "row" }, whole)), fill };
  }

  /** What the material's card rests on. */
  private tier(profiles: api.Profile[], text: string): string {
    const name = plain(get(text, "material", "profile") ?? "pla");
    const toml = profiles.find((p) => p.kind === "material" && p.name === name)?.toml ?? "";
    const found = toml.match(/strength_tier\s*=\s*"([^"]*)"/)?.[1];
    return found ? `Strengths of ${name} rest on ${api.TIERS[found] ?? `tier ${found}`}` : `${name}: no strengths are known`;
  }

  async plan(): Promise<void> {
    const wanted = this.wanted();
    if (!wanted) return;
    const end = await this.parts.run({ kind: "plan", ...wanted });
    if (end) document.dispatchEvent(new CustomEvent("planned", { detail: end.id }));
  }
}
