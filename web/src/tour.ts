// A tour of the page on the first visit: five steps, each beside what it tells of.

import { byId, el } from "./dom";

/** What each step lights, and its words. */
const STEPS: [string, string][] = [
  ["open", "Open a file: G-code of any slicer, a mesh, a drawing, a photograph, a scan or a job. Dropping it on the page does as well."],
  ["tab-loads", "Loads: click the faces of a mesh where it is held and where it is loaded, and see the stress before anything is planned."],
  ["tab-job", "Job: printer, material and every setting, beside the text that the command line runs too. Plan the paths from here."],
  ["tab-paths", "Paths: every bead by layer and by move, coloured by role, speed, width and more. The pointer tells its numbers."],
  ["tab-strength", "Strength: at which load and where the part breaks, with a replay of the crack. Runs, above, sets two of them side by side. The key ? lists all keys."],
];

export class Tour {
  private at = -1;

  constructor(private readonly box: HTMLElement) {
    box.addEventListener("keydown", (event) => { if (event.key === "Escape") { this.go(-1); event.stopPropagation(); } });
  }

  /** Begins the tour where this browser has not seen it. */
  first(): void {
    try { if (!localStorage.getItem("toured")) this.go(0); } catch { /* Where nothing can be kept, it would come back each time. */ }
  }

  /** Goes to a step; beyond the last one or before the first one the tour is over. */
  go(step: number): void {
    byId(STEPS[Math.max(this.at, 0)]![0]).classList.remove("lit");
    const isMoving = this.at >= 0;
    this.at = step < STEPS.length ? step : -1;
    this.box.hidden = this.at < 0;
    if (this.at < 0) {
      try { localStorage.setItem("toured", "yes"); } catch { /* As above. */ }
      if (isMoving) byId("view").focus();
      return;
    }
    const [target, words] = STEPS[this.at]!;
    byId(target).classList.add("lit");
    const isLast = this.at === STEPS.length - 1;
    const next = el("button", { type: "button", class: "main", id: "tour-next", onclick: () => this.go(this.at + 1) }, isLast ? "Done" : "Next");
    this.box.replaceChildren(
      el("p", { id: "tour-words", "aria-live": "polite" }, el("b", {}, `${this.at + 1} of ${STEPS.length} · `), words),
      el("div", { class: "row" }, next, this.at > 0 && el("button", { type: "button", id: "tour-back", onclick: () => this.go(this.at - 1) }, "Back"), !isLast && el("button", { type: "button", id: "tour-skip", onclick: () => this.go(-1) }, "Skip the tour")),
    );
    if (isMoving) next.focus();
  }
}
