// Where a part breaks: two places, a load, and the answer.

import * as api from "./api";
import { chart } from "./chart";
import { gradient, ramp, type CrackBy } from "./colours";
import { byId, el, fixed, numberField, player, warning } from "./dom";
import { quoted } from "./job";
import { CELL, slabOf, type Box, type Side, type Slab, type Viewer } from "./viewer";

interface Parts {
  run: (wanted: Record<string, unknown>) => Promise<api.JobState | null>; say: (message: string, isError?: boolean) => void;
  viewer: () => Viewer | null;
  /** Low and high corner of what the program on screen prints, also where nothing can be drawn; null where it prints nothing. */
  printed: () => Box | null; job: () => Record<string, unknown> | null; showPaths: () => void; show: (id: number) => Promise<void>;
  /** Gives beads and legend the colours of the paths again. */
  recolour: () => void;
  /** Shows the last two runs side by side. */
  compare: () => void;
}

const SIDES: [Side, string][] = [["x-", "left end (low x)"], ["x+", "right end (high x)"], ["y-", "front (low y)"], ["y+", "back (high y)"], ["z-", "bottom"], ["z+", "top"]];
const DIRECTIONS: [string, string][] = [["away", "pull away"], ["towards", "push towards"], ["down", "down (−z)"], ["up", "up (+z)"], ["x", "+x"], ["-x", "−x"], ["y", "+y"], ["-y", "−y"]];
const CRACK_BY: [CrackBy | "none", string][] = [["lost", "what broke, by the stiffness lost"], ["order", "what broke, by the order of breaking"], ["beads", "the beads, by the order of breaking"], ["none", "nothing of it"]];
const HELD = 0x2a74b2;
const LOADED = 0xd65d20;

/** The interval of the peak load, and what it is over: runs without corners of the card know nothing of the material's scatter. */
function over(report: api.StrengthReport): string {
  if (report.low_n === report.high_n) return `with the nominal strengths of the material alone, from ${api.TIERS[report.card_tier] ?? report.card_tier}`;
  const card = Object.keys(report.corners).length > 1 ? `over the strengths of the material, from ${api.TIERS[report.card_tier] ?? report.card_tier}, and the grid` : `over the grid alone, with the nominal strengths of the material, from ${api.TIERS[report.card_tier] ?? report.card_tier}`;
  return `between ${fixed(report.low_n, 0)} and ${fixed(report.high_n, 0)} N ${card}`;
}

export class StrengthPanel {
  private program: string | null = null;
  private hold: Side = "x-";
  private load: Side = "x+";
  private depth = 0;
  private direction = "away";
  private force = 100;
  private material = "pla";
  private profiles: api.Profile[] = [];
  private mode: "hold" | "load" | null = null;
  private isActive = false;
  /** Draws the crack of the last test as it is chosen. */
  private crack: (() => void) | null = null;
  /** Ends once the fields for the program are there. */
  private built = Promise.resolve();
  /** Counts the answers that were asked for: the last one alone is shown, and none of a file that is not open any more. */
  private asked = 0;

  constructor(private readonly panel: HTMLElement, private readonly parts: Parts) { this.close(); }

  close(): void {
    this.program = this.crack = null;
    this.asked++;
    this.setMode(null);
    this.empty("Open a G-code file to find where and at which load it breaks.");
  }

  private empty(words: string): void { this.panel.replaceChildren(el("p", { class: "note" }, words)); }

  setActive(isActive: boolean): void { this.isActive = isActive; this.draw(); }

  /** A job states its own places and loads. */
  forJob(): void {
    this.program = this.crack = null;
    const test = el("button", { type: "button", class: "main", id: "test-job", onclick: () => void this.testJob() }, "Test the job's part");
    this.panel.replaceChildren(el("p", { class: "note" }, "The part is planned, and its G-code is loaded in steps until it breaks. Where it is held and loaded is said in the tab Loads."), test, el("div", { id: "answer" }));
  }

  /** Plans the part of the job that is open and loads it until it breaks. */
  async testJob(): Promise<void> {
    const wanted = this.parts.job();
    if (wanted) await this.test({ kind: "strength", ...wanted, ...("name" in wanted ? { name: `${String(wanted.name)}-strength` } : {}) });
  }

  /** A program of any slicer: the two places are chosen here. */
  forProgram(path: string): Promise<void> { return (this.built = this.begin(path)); }

  private async begin(path: string): Promise<void> {
    this.program = path;
    this.crack = null;
    const part = this.parts.printed();
    if (!part) { this.empty("Nothing is printed in this program, so nothing can be tested."); return; }
    // The longest side is the one that parts are pulled along.
    const spans = [0, 1, 2].map((k) => part[1][k]! - part[0][k]!);
    const axis = (["x", "y", "z"] as const)[spans.indexOf(Math.max(...spans))]!;
    [this.hold, this.load] = [`${axis}-`, `${axis}+`];
    this.depth = Number(fixed(Math.max(0.1 * Math.max(...spans), 1), 1));
    try {
      this.profiles = (await api.profiles()).profiles;
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
    if (this.program !== path) return;
    this.build();
    this.draw();
  }

  private build(): void {
    const side = (name: "hold" | "load") => {
      const select = el("select", { id: `${name}-side`, onchange: () => { this[name] = select.value as Side; this.draw(); } }, ...SIDES.map(([k, words]) => el("option", { value: k, selected: k === this[name] }, words)));
      const pick = el("button", { type: "button", id: `${name}-pick`, "aria-pressed": "false", onclick: () => this.setMode(this.mode === name ? null : name) }, "Pick in the view");
      pick.hidden = !this.parts.viewer();
      return el("div", { class: "row" }, el("label", {}, name === "hold" ? "Held at" : "Loaded at", select), pick);
    };
    const number = (id: string, label: string, value: number, then: (v: number) => void) => el("label", {}, label, numberField({ id, value }, { isPositive: true, isLive: true }, (v) => { then(v); this.draw(); }));
    const direction = el("select", { onchange: () => { this.direction = direction.value; this.draw(); } }, ...DIRECTIONS.map(([k, words]) => el("option", { value: k, selected: k === this.direction }, words)));
    const cards = this.profiles.filter((p) => p.kind === "material");
    const tier = el("p", { class: "note" });
    const tell = () => {
      const toml = cards.find((p) => p.name === this.material)?.toml ?? "";
      const found = toml.match(/strength_tier\s*=\s*"([^"]*)"/)?.[1];
      tier.textContent = found ? `Its strengths rest on ${api.TIERS[found] ?? `tier ${found}`}` : "This material has no strengths.";
    };
    const material = el("select", { onchange: () => { this.material = material.value; tell(); this.draw(); } }, ...cards.map((p) => el("option", { value: p.name, selected: p.name === this.material, title: p.about }, p.name)));
    tell();
    this.panel.replaceChildren(
      el("h2", {}, "Material"), el("div", { class: "row" }, el("label", {}, "card", material)), tier,
      el("h2", {}, "Places"), side("hold"), side("load"),
      el("div", { class: "row" }, number("depth", "Depth of both, mm", this.depth, (v) => (this.depth = v))),
      el("h2", {}, "Load"), el("div", { class: "row" }, el("label", {}, "direction", direction), number("force", "force, N", this.force, (v) => (this.force = v))),
      el("p", { class: "note" }, "The force is scaled up until the part breaks; its size matters for nothing but the reserve."),
      el("div", { class: "row" }, el("button", { type: "button", class: "main", id: "break", onclick: () => { if (this.program) void this.test({ kind: "strength", text: this.job(), name: "strength", program: this.program }); } }, "Break it")),
      el("details", {}, el("summary", {}, "The job file that is run"), el("pre", { id: "strength-job" })),
      el("div", { id: "answer" }),
    );
  }

  private setMode(mode: "hold" | "load" | null): void {
    this.mode = mode;
    for (const name of ["hold", "load"]) document.getElementById(`${name}-pick`)?.setAttribute("aria-pressed", String(mode === name));
    const viewer = this.parts.viewer();
    if (viewer) viewer.picking = mode !== null;
    if (mode) this.parts.say(`Click the side of the part where it is ${mode === "hold" ? "held" : "loaded"}.`);
  }

  /** A side of the part was clicked. */
  pick(side: Side): void {
    if (!this.mode) return;
    this[this.mode] = side;
    const select = document.getElementById(`${this.mode}-side`) as HTMLSelectElement | null;
    if (select) select.value = side;
    document.getElementById("progress")!.hidden = true;
    this.setMode(null);
    this.draw();
  }

  private get vector(): [number, number, number] {
    const axis = "xyz".indexOf(this.load[0]!);
    const out = this.load[1] === "+" ? 1 : -1;
    const unit: Record<string, [number, number, number]> = { down: [0, 0, -1], up: [0, 0, 1], x: [1, 0, 0], "-x": [-1, 0, 0], y: [0, 1, 0], "-y": [0, -1, 0] };
    return unit[this.direction] ?? ([0, 1, 2].map((k) => (k === axis ? (this.direction === "away" ? out : -out) : 0)) as [number, number, number]);
  }

  /** The job that is run: what the command line gets with `grainpath strength FILE --job JOB`. */
  private job(): string {
    const printed = this.parts.printed();
    if (!printed) return "";
    // A little more than the box of the part, so that the widths of beads at its border are inside.
    // The test counts heights from the bottom of the part, which a raft lifts from the plate.
    const bottom = printed[0][2] ?? 0;
    const box = (side: Side) => {
      const [a, b] = slabOf(printed, side, this.depth);
      const text = (p: number[], by: number) => `[${p.map((v, k) => fixed(v + by - (k === 2 ? bottom : 0), 3)).join(", ")}]`;
      return `{ box_mm = [${text(a, -0.05)}, ${text(b, 0.05)}] }`;
    };
    const force = this.vector.map((v) => v * this.force);
    return `format = 1\n\n[material]\nprofile = ${quoted(this.material)}\n\n[strength]\nenabled = true\n\n[[guide.fixture]]\non = ${box(this.hold)}\nfix = "xyz"\n\n[[guide.load]]\non = ${box(this.load)}\nforce_n = [${force.join(", ")}]\n`;
  }

  private draw(): void {
    const shown = document.getElementById("strength-job");
    if (shown) shown.textContent = this.job();
    const viewer = this.parts.viewer();
    if (!viewer?.beads) return;
    const slabs: Slab[] = this.isActive && this.program ? [{ side: this.hold, depth_mm: this.depth, colour: HELD }, { side: this.load, depth_mm: this.depth, colour: LOADED, arrow: this.vector }] : [];
    viewer.setPlaces(slabs);
    if (this.isActive) this.crack?.();
    else { this.setMode(null); viewer.showCrack(null, 0); }
  }

  private async test(wanted: Record<string, unknown>): Promise<void> {
    if (this.program && this.hold === this.load) { this.parts.say("The part is held and loaded at the same place; choose another side for one of them.", true); return; }
    const end = await this.parts.run(wanted);
    if (end) await this.show(end.id);
  }

  /** Shows a test that was done earlier. */
  async reopen(id: number, name: string): Promise<void> {
    await this.built;
    await this.show(id);
    if (this.program) document.getElementById("answer")?.prepend(el("p", { class: "note" }, `What follows is of ${name}, with the places and the load of its own job file.`));
  }

  private async show(id: number): Promise<void> {
    const own = ++this.asked;
    try {
      const result = await api.result(id);
      const cells = result.damage ? new Float32Array(await api.bytes(`v1/jobs/${id}/damage`)) : null;
      if (own !== this.asked) return;
      if (!this.program) await this.parts.show(id);
      if (own === this.asked) this.tell(result, cells);
    } catch (error) {
      if (own === this.asked) this.parts.say((error as Error).message, true);
    }
  }

  private tell(result: api.Result, cells: Float32Array<ArrayBuffer> | null): void {
    const report = result.report.strength;
    const answer = document.getElementById("answer");
    if (!report || !answer) return;
    const { made, mark } = chart(report, result.damage?.states ?? []);
    const replay = result.damage && cells ? this.replay(result.damage, cells, mark) : [];
    const fact = (name: string, value: string) => el("tr", {}, el("td", {}, name), el("td", { class: "n" }, value));
    const modes = Object.entries(report.modes).sort((a, b) => b[1] - a[1]).map(([name, share]) => fact(name, `${fixed(100 * share, 0)} %`));
    answer.replaceChildren(
      el("h2", {}, "It breaks at"),
      el("p", { class: "big", id: "peak" }, `${fixed(report.peak_load_n, 0)} N`),
      el("p", { class: "note" }, over(report)),
      el("p", { id: "weakest" }, `Weakest at ${report.weakest.words}.`),
      made, ...replay,
      el("table", {}, fact("First bead fails at", `${fixed(report.first_n, 0)} N`), fact("Stiffness", `${fixed(report.stiffness_n_per_mm, 0)} N/mm`), fact("Displacement at the peak", `${fixed(report.peak_displacement_mm, 3)} mm`),
        fact("Mass of the part", `${fixed(report.mass_g, 2)} g`), fact("Load over mass", `${fixed(report.load_per_gram_n_g, 0)} N/g`), fact("Over the load given", `${fixed(report.peak_load_n / report.job_load_n, 2)} ×`),
        fact("Model", `${report.fidelity}, cells of ${report.cell_mm} mm`)),
      el("h2", {}, "How it fails"), el("table", {}, ...modes),
      ...result.warnings.map(warning),
      el("div", { class: "row" }, el("button", { type: "button", id: "compare", onclick: () => this.parts.compare() }, "Compare with another run")),
      el("details", {}, el("summary", {}, "Where the strengths come from"), el("p", { class: "note" }, report.card_source)),
    );
    this.crack?.();
    answer.scrollIntoView({ block: "nearest" });
  }

  /** The replay of a test: a slider over its states, a button that plays them, and what is coloured. */
  private replay(damage: api.Damage, cells: Float32Array<ArrayBuffer>, mark: (u: number, f: number) => void): Node[] {
    const viewer = this.parts.viewer();
    const { states } = damage;
    const broke = Array.from({ length: cells.length / CELL }, (_, k) => cells[CELL * k + 4]!);
    // Elements that break in one state share their place in the order.
    const steps = [...new Set(broke)].sort((a, b) => a - b);
    const order = Float32Array.from(broke, (at) => (steps.length > 1 ? steps.indexOf(at) / (steps.length - 1) : 1));
    viewer?.setCrack({ cells, order, size_mm: damage.cell_mm as [number, number, number], angle_rad: damage.angle_rad });
    const last = Math.max(states.length - 1, 0);
    const select = el("select", { id: "crack-by", onchange: () => this.crack?.() }, ...CRACK_BY.map(([k, words]) => el("option", { value: k }, words)));
    const slider = el("input", { id: "crack-step", type: "range", min: 0, max: last, value: last, "aria-label": "Step of the load", oninput: () => this.crack?.() });
    const words = el("output", { id: "crack-words", class: "note" });
    const button = el("button", { type: "button", id: "crack-play" });
    button.addEventListener("click", player(button, slider, 6, "Play how it breaks", () => "0", () => this.crack?.()));
    this.crack = () => {
      const state = Number(slider.value);
      const [u, f] = states[state] ?? [0, 0];
      mark(u, f);
      words.textContent = `step ${state + 1} of ${last + 1}: ${fixed(f, 0)} N at ${fixed(u, 3)} mm, ${broke.filter((at) => at <= state).length} of ${broke.length} elements broken`;
      slider.setAttribute("aria-valuetext", words.textContent);
      if (!viewer || !this.isActive) return;
      const by = select.value as CrackBy | "none";
      this.parts.recolour();
      viewer.showCrack(by === "none" ? null : by, state);
      if (by === "order" || by === "beads") {
        const bar = el("div", { class: "ramp" });
        bar.style.background = gradient(ramp);
        byId("legend").replaceChildren(el("div", {}, "Order of breaking"), bar, el("div", { class: "ends" }, el("span", {}, "first"), el("span", {}, "last")));
      }
    };
    return [el("div", { class: "row" }, button, slider), words, el("div", { class: "row" }, el("label", {}, "Show", select))];
  }
}
