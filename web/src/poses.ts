// The ways in which the part can stand on the plate, side by side: height, supports, and what the loads do to its layers.

import * as api from "./api";
import { duration, el, fixed, redraw, warning } from "./dom";

interface Parts { run: (wanted: Record<string, unknown>) => Promise<api.JobState | null>; wanted: () => Record<string, unknown> | null; stand: (rotate_deg: number[]) => void; say: (message: string, isError?: boolean) => void }

export class Poses {
  readonly element = el("div", { id: "poses" });
  private all: api.Pose[] | null = null;
  private warnings: api.Warning[] = [];
  /** What the list was made from. */
  private of = "";
  /** How the part is turned now. */
  private turned: number[] = [0, 0, 0];

  constructor(private readonly parts: Parts) {}

  /** The part is turned as `rotate_deg` says; a list that was made from something else is taken away. */
  show(rotate_deg: number[], of: string): void {
    if (of !== this.of) [this.all, this.of] = [null, of];
    this.turned = rotate_deg;
    const compare = el("button", { type: "button", id: "compare-poses", onclick: () => void this.compare() }, "Compare build directions");
    if (!this.all) { redraw(this.element, el("div", { class: "row" }, compare)); return; }
    const isLoaded = this.all.some((pose) => pose.reserve);
    const row = (pose: api.Pose, k: number) => {
      const stands = pose.rotate_deg.every((v, axis) => Math.abs(v - (rotate_deg[axis] ?? 0)) < 1e-3);
      const words = `turned by ${pose.rotate_deg.map((v) => fixed(v, 1)).join(", ")} degrees`;
      const n = (value: string) => el("td", { class: "n" }, value);
      const [low, nominal, high] = pose.reserve?.first_failure ?? [];
      return el("tr", stands ? { "aria-current": "true" } : {},
        el("td", {}, el("button", { type: "button", id: `pose-${k}`, "data-pose": k, disabled: stands, title: words, "aria-label": `${stands ? "Stands so" : "Take"}: ${words}`, onclick: () => this.parts.stand(pose.rotate_deg) }, stands ? "stands" : "take")),
        n(`${fixed(pose.height_mm, 1)} mm`), n(`${fixed(pose.support_g, 2)} g`), n(duration(pose.time_s)),
        ...(isLoaded ? [n(pose.reserve ? `${fixed(pose.reserve.across_layers_mpa, 2)} MPa` : "–"), el("td", { class: "n", title: low === undefined ? "" : `${fixed(low, 2)} to ${fixed(high!, 2)}, ${pose.reserve!.mode}` }, nominal === undefined ? "–" : `${fixed(nominal, 2)} ×`)] : []));
    };
    const heads = ["", "Height", "Support", "Time", ...(isLoaded ? ["Across", "Fails at"] : [])];
    redraw(this.element,
      el("div", { class: "wide" }, el("table", {}, el("tr", {}, ...heads.map((words) => el("th", { scope: "col" }, words || el("span", { class: "sr" }, "Choose")))), ...this.all.map(row))),
      el("p", { class: "note" }, isLoaded ? "The best first: by the factor on the loads at which the first bead or bond fails, then by support, height and time. Across is the tension from layer to layer. Loads turn with the part." : "The best first: by support, height and time. With fixtures and loads, what they do to the layers counts before that."),
      ...this.warnings.map(warning),
      el("div", { class: "row" }, compare));
  }

  private async compare(): Promise<void> {
    const wanted = this.parts.wanted();
    const { of } = this;
    const end = wanted && (await this.parts.run({ kind: "orient", ...wanted }));
    if (!end || of !== this.of) return;
    try {
      const result = await api.result(end.id);
      if (of !== this.of) return;
      this.all = result.report.poses as api.Pose[];
      this.warnings = result.warnings;
      this.show(this.turned, of);
      document.documentElement.dataset.poses = String(end.id);
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
  }
}
