// Supports on the part: which facets are to be held or left free, by faces or with a brush, and the branches that grow.
//
// The text of the job keeps facets by their numbers (`support.enforce_facets`, `support.block_facets`), so that the command
// line holds the same ones.

import * as api from "./api";
import { css, gradient, ramp, type Rgb } from "./colours";
import { el, fixed, warning } from "./dom";
import { quoted, type JobPanel } from "./job";
import { BLOCKED, ENFORCED, type PartView } from "./part";
import { entries, get, set, value } from "./toml";
import type { Viewer } from "./viewer";

interface Parts { run: (wanted: Record<string, unknown>) => Promise<api.JobState | null>; say: (message: string, isError?: boolean) => void; viewer: () => Viewer | null; job: JobPanel; view: () => PartView | null; chosen: () => number[] }

/** What the brush does. */
type Paint = "enforce" | "block" | "erase";
const STYLES: [string, string][] = [["none", "none"], ["tree", "trees"], ["columns", "columns"], ["box", "boxes"]];
const KEYS = { enforce: "enforce_facets", block: "block_facets" } as const;

export class Supports {
  readonly element = el("div", { id: "supports" });
  private paint: Paint | null = null;
  private isActive = true;
  /** Whether the brush is down: what it has painted is not in the text yet. */
  private isStroke = false;
  /** Facets as the text has them, or as the stroke of the brush leaves them. */
  private facets: { enforce: Set<number>; block: Set<number> } = { enforce: new Set(), block: new Set() };
  private readonly told = el("div", { role: "status" });
  private readonly counts = el("p", { class: "note", id: "support-facets" });
  private grown: { of: PartView; text: string } | null = null;

  constructor(private readonly parts: Parts) {}

  private get text(): string { return this.parts.job.text() ?? ""; }

  /** Another part is there. */
  build(): void {
    this.grown = null;
    this.told.replaceChildren();
    const style = el("select", { id: "support-style", onchange: () => this.parts.job.put(set(this.text, "support", "style", style.value === "none" ? null : quoted(style.value))) }, ...STYLES.map(([key, words]) => el("option", { value: key }, words)));
    const swatch = (colour: Rgb) => { const box = el("span", { class: "swatch" }); box.style.background = css(colour); return box; };
    const brush = (paint: Paint, label: string, colour: Rgb | null, title: string) => el("button", { type: "button", id: `paint-${paint}`, "aria-pressed": "false", title, onclick: () => this.setPaint(this.paint === paint ? null : paint) }, ...(colour ? [swatch(colour)] : []), label);
    const faces = (paint: Paint, label: string) => el("button", { type: "button", id: `faces-${paint}`, onclick: () => this.faces(paint) }, label);
    this.element.replaceChildren(
      el("div", { class: "row" }, el("label", {}, "below overhangs", style), el("button", { type: "button", id: "grow-supports", onclick: () => void this.grow() }, "Show the supports")),
      el("div", { class: "row", id: "paints" }, brush("enforce", "Paint: support", ENFORCED, "Drag over facets that are always held, whatever their angle"), brush("block", "Paint: none", BLOCKED, "Drag over facets that are never held"), brush("erase", "Erase", null, "Drag over facets whose angle decides again")),
      el("div", { class: "row" }, faces("enforce", "Support the chosen faces"), faces("block", "Never below them"), faces("erase", "As the angle says")),
      this.counts, this.told);
    this.textChanged();
    this.chosenChanged();
    // The brush stays in hand where the part is made anew: the first facets that are painted bring supports, which lift it.
    if (this.paint) this.setPaint(this.paint);
  }

  /** The text of the job changed. */
  textChanged(): void {
    const view = this.parts.view();
    if (!view) return;
    const style = document.getElementById("support-style") as HTMLSelectElement | null;
    if (style) style.value = String(value(get(this.text, "support", "style") ?? '"none"') ?? "none");
    const read = (key: string) => { const list = value(get(this.text, "support", key) ?? ""); return new Set(Array.isArray(list) ? list.filter((n): n is number => typeof n === "number") : []); };
    if (!this.isStroke) this.facets = { enforce: read(KEYS.enforce), block: read(KEYS.block) };
    if (this.grown && (this.grown.of !== view || this.grown.text !== this.supportsOf())) this.hide();
    this.show();
  }

  chosenChanged(): void {
    for (const paint of ["enforce", "block", "erase"]) { const button = document.getElementById(`faces-${paint}`) as HTMLButtonElement | null; if (button) button.disabled = this.parts.chosen().length === 0; }
  }

  /** What the supports depend on, beside the part. */
  private supportsOf(): string {
    const text = this.text;
    return entries(text).filter((e) => ["support", "process", "material"].includes(e.table)).map((e) => `${e.table}.${e.key}=${text.slice(e.from, e.to)}`).join("\n");
  }

  private show(): void {
    const { enforce, block } = this.facets;
    this.parts.view()?.setPainted(enforce, block);
    this.counts.textContent = enforce.size + block.size === 0 ? "No facet is painted: the angle of the surface decides where supports are needed." : `Painted: ${enforce.size} facets are held, ${block.size} are left free.`;
    this.parts.viewer()?.draw();
  }

  /** Whether its tab is open: branches would hide the faces of the others. */
  setActive(isActive: boolean): void {
    this.isActive = isActive;
    if (!isActive) this.setPaint(null);
    this.parts.view()?.showBranches(isActive);
  }

  setPaint(paint: Paint | null): void {
    if (this.isStroke && paint !== this.paint) this.strokeEnd();
    this.paint = paint;
    this.parts.viewer()?.setGesture(paint ? "paint" : "turn");
    for (const one of ["enforce", "block", "erase"]) document.getElementById(`paint-${one}`)?.setAttribute("aria-pressed", String(paint === one));
  }

  /** The brush went over these triangles. */
  stroke(triangles: number[]): void {
    if (!this.paint) return;
    this.isStroke = true;
    this.take(triangles, this.paint);
    this.show();
  }

  /** A stroke is over: it goes into the text, to be undone in one go. */
  strokeEnd(): void {
    this.isStroke = false;
    if (this.paint) this.put();
  }

  private faces(paint: Paint): void {
    const view = this.parts.view();
    if (!view) return;
    for (const face of this.parts.chosen()) this.take([...view.triangles(face)], paint);
    this.put();
  }

  private take(triangles: number[], paint: Paint): void {
    for (const t of triangles) {
      for (const one of ["enforce", "block"] as const) if (one === paint) this.facets[one].add(t); else this.facets[one].delete(t);
    }
  }

  private put(): void {
    let text = this.text;
    for (const one of ["enforce", "block"] as const) {
      const all = [...this.facets[one]].sort((a, b) => a - b);
      text = set(text, "support", KEYS[one], all.length > 0 ? `[${all.join(", ")}]` : null);
    }
    // Paint without supports would do nothing.
    if (this.facets.enforce.size > 0 && get(text, "support", "style") === null) text = set(text, "support", "style", quoted("tree"));
    this.parts.job.put(text);
    this.show();
  }

  private hide(): void {
    this.grown = null;
    this.parts.view()?.setBranches(null);
    this.told.replaceChildren(el("p", { class: "note" }, "The job has changed: show the supports again."));
  }

  private async grow(): Promise<void> {
    const [wanted, view, text] = [this.parts.job.wanted(), this.parts.view(), this.supportsOf()];
    const end = wanted && view && (await this.parts.run({ kind: "supports", ...wanted }));
    if (!end || this.parts.view() !== view) return;
    try {
      const [result, bytes] = await Promise.all([api.result(end.id), api.bytes(`v1/jobs/${end.id}/branches`)]);
      if (this.parts.view() !== view) return;
      const report = result.report.support as api.SupportReport;
      const branches = new Float32Array(bytes);
      const most = view.setBranches(branches);
      this.grown = { of: view, text };
      const fact = (name: string, words: string, id = "") => el("tr", {}, el("td", {}, name), el("td", { class: "n", ...(id ? { id } : {}) }, words));
      const bar = el("div", { class: "ramp" });
      bar.style.background = gradient(ramp);
      const lost = report.unreached.length;
      this.told.replaceChildren(
        report.contacts === 0 ? el("p", { class: "note" }, "Nothing needs support.") : el("div", { class: "legend" }, el("div", {}, "Load of a branch"), bar, el("div", { class: "ends" }, el("span", {}, "0 N"), el("span", {}, `${fixed(most, 2)} N`))),
        el("table", {}, fact("Mass", `${fixed(report.mass_g ?? report.solid_mass_g, 2)} g`, "support-mass"), fact("Contacts, trees", `${report.contacts}, ${report.trees}`, "support-contacts"), fact("Farthest from a contact", `${fixed(report.farthest_mm, 1)} mm`), ...(lost > 0 ? [fact("Overhangs that no branch reaches", String(lost))] : [])),
        ...result.warnings.map(warning));
      // The job may have changed while they were grown.
      if (text !== this.supportsOf()) this.hide();
      this.parts.viewer()?.draw();
      document.documentElement.dataset.supports = String(end.id);
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
  }

  /** What the branch under the pointer bears. */
  wordsAt(at: { clientX: number; clientY: number }): string | null {
    const viewer = this.parts.viewer();
    const found = this.isActive && this.grown && viewer && at.clientX >= 0 ? this.parts.view()?.branchAt(viewer.rayAt(at.clientX, at.clientY)) : null;
    if (!found) return null;
    const { load_n, isContact, at: p } = found;
    return `${isContact ? "contact" : "branch"} that bears ${fixed(load_n, 2)} N · at (${p.toArray().map((v) => fixed(v, 1)).join(", ")})`;
  }
}
