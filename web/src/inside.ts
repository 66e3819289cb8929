// What is inside the part under its loads: a section with the stress on it, and principal stress lines. The server cuts
// the solid and traces the lines; both are asked for when they are wanted.

import type { Vector3 } from "three";
import * as api from "./api";
import { css } from "./colours";
import { el, numberField, showValue } from "./dom";
import { COMPRESSION, TENSION, TRISECTOR, WEDGE, type StressView } from "./part";
import type { Viewer } from "./viewer";

interface Parts { say: (message: string, isError?: boolean) => void; viewer: () => Viewer | null }

const AXES = ["x", "y", "z"] as const;

export class Inside {
  private axis = -1;
  private at = 0;
  private isLowKept = true;
  private ofCase = 0;
  private hasPoints = false;
  private readonly pointWords = el("output", { id: "degenerate-count" });
  private isBusy = false;
  private isStale = false;
  private hasLines = false;
  /** Counts the wishes for lines: tracing takes its time, and the last wish counts. */
  private asked = 0;

  constructor(private readonly view: StressView, private readonly job: number, private readonly low: Vector3, private readonly high: Vector3, private readonly parts: Parts) {}

  /** The fields that choose what is seen. */
  fields(): Node[] {
    const ends = () => [this.low.getComponent(this.axis), this.high.getComponent(this.axis)] as const;
    const slider = el("input", { type: "range", id: "section-slider", step: "any", "aria-label": "Place of the section", oninput: () => place(slider.valueAsNumber) });
    const number = numberField({ id: "section-at" }, { isView: true }, (v) => place(v));
    const other = el("input", { type: "checkbox", id: "section-other", onchange: () => { this.isLowKept = !this.isLowKept; this.section(); } });
    const rows = el("div", { hidden: true }, el("div", { class: "row" }, slider, el("label", {}, "at, mm", number)), el("label", { for: "section-other", class: "check" }, other, " the other half"));
    const place = (at: number) => {
      this.at = at;
      showValue(number, Number(at.toFixed(3)));
      slider.value = String(at);
      this.section();
    };
    const axis = el("select", { id: "section", onchange: () => {
      this.axis = Number(axis.value);
      rows.hidden = this.axis < 0;
      if (this.axis < 0) { this.section(); return; }
      const [low, high] = ends();
      [slider.min, slider.max] = [String(low), String(high)];
      // A step of the arrow keys is a hundredth of the part.
      slider.step = String((high - low) / 100);
      // The half that the eye is on is taken away.
      const viewer = this.parts.viewer();
      this.isLowKept = !viewer || viewer.camera.position.getComponent(this.axis) >= viewer.controls.target.getComponent(this.axis);
      other.checked = false;
      place(0.5 * (low + high));
    } }, el("option", { value: -1 }, "none"), ...AXES.map((name, k) => el("option", { value: k }, `across ${name}`)));
    const lines = el("input", { type: "checkbox", id: "lines", onchange: () => void this.lines(lines.checked) });
    const points = el("input", { type: "checkbox", id: "degenerate", onchange: () => { this.hasPoints = points.checked; this.points(); } });
    const swatch = (colour: [number, number, number]) => { const box = el("span", { class: "swatch" }); box.style.background = css(colour); return box; };
    return [
      el("div", { class: "row" }, el("label", {}, "Section", axis)), rows,
      el("label", { for: "lines", class: "check" }, lines, " principal stress lines"),
      el("p", { class: "note" }, swatch(TENSION), "tension ", swatch(COMPRESSION), "compression along the line"),
      el("label", { for: "degenerate", class: "check" }, points, " degenerate points of the surface ", this.pointWords),
      el("p", { class: "note" }, "where both principal stresses in the surface are equal: ", swatch(WEDGE), "wedge, which lines bend around, ", swatch(TRISECTOR), "trisector, where three sectors of lines meet"),
    ];
  }

  /** Another load case is shown. */
  setCase(k: number): void {
    this.ofCase = k;
    this.section();
    if (this.hasLines) void this.lines(true);
    this.points();
  }

  /** Draws the degenerate points of the case, where they are wanted. */
  private points(): void {
    const found = this.view.setDegenerate(this.hasPoints ? this.view.misesEnd : null);
    this.pointWords.textContent = this.hasPoints ? `(${found.length})` : "";
    this.parts.viewer()?.draw();
  }

  /** Asks for the section as it is chosen; while one is on its way, the last wish is remembered. */
  private section(): void {
    if (this.isBusy) { this.isStale = true; return; }
    void this.fetchSection();
  }

  private async fetchSection(): Promise<void> {
    this.isBusy = true;
    do {
      this.isStale = false;
      const { axis, at, isLowKept } = this;
      try {
        const bytes = axis < 0 ? null : await api.bytes(`v1/jobs/${this.job}/stress/${this.ofCase}/section?axis=${AXES[axis]}&at=${at}`);
        this.view.setSection(bytes, axis, at, isLowKept);
        document.documentElement.dataset.section = axis < 0 ? "none" : `${AXES[axis]} ${at} ${isLowKept}`;
      } catch (error) {
        this.parts.say((error as Error).message, true);
      }
      this.parts.viewer()?.draw();
    } while (this.isStale);
    this.isBusy = false;
  }

  private async lines(isWanted: boolean): Promise<void> {
    this.hasLines = isWanted;
    const own = ++this.asked;
    try {
      const bytes = isWanted ? await api.bytes(`v1/jobs/${this.job}/stress/${this.ofCase}/lines`) : null;
      if (own !== this.asked) return;
      this.view.setLines(bytes);
      if (isWanted && !this.view.hasLines) this.parts.say("No stress in this part is clear enough for a line.");
      document.documentElement.dataset.lines = String(isWanted);
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
    this.parts.viewer()?.draw();
  }
}
