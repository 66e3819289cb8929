// The shape of a job: how large it is, what is wrong with it, its unit, how it stands, and which of its faces are chosen.

import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import * as api from "./api";
import { css, type Rgb } from "./colours";
import { el, fixed, numberField, numberOf, complain, redraw, warning } from "./dom";
import { quoted, type JobPanel } from "./job";
import { FAULT, LEFT, PartView, surfaceOf, type Side } from "./part";
import { Poses } from "./poses";
import { Supports } from "./supports";
import { entries, get, set, value } from "./toml";
import type { Viewer } from "./viewer";

interface Parts {
  run: (wanted: Record<string, unknown>, outdated?: AbortSignal) => Promise<api.JobState | null>; say: (message: string, isError?: boolean) => void; viewer: () => Viewer | null; job: JobPanel; openLoads: () => void;
  /** The text of the job with loads that turn with the part, or the reason why they cannot. */
  turning: () => { text: string } | { refused: string };
}

/** How long the text has to rest before its shape is made anew, ms. */
const REST_MS = 250;
const UNITS = ["mm", "cm", "m", "inch", "micron", "foot"];

/** Settings outside [shape] that move the part or what is told of it. */
const OTHERS: [string, string][] = [["guide", "frame"], ["support", "style"], ["support", "lift_mm"]];

export class ShapePanel {
  report: api.ShapeReport | null = null;
  view: PartView | null = null;
  /** Numbers of the faces that are chosen, in the order of choosing. */
  chosen: number[] = [];
  /** The part of the chosen face that is meant, where it was split. */
  side: Side | null = null;
  /** Called when another part is there, of this run, or none. */
  onPart: (run: number | null) => void = () => {};
  /** Called when other faces are chosen. */
  onChosen: () => void = () => {};
  private key = "";
  private warnings: api.Warning[] = [];
  private timer = 0;
  /** The run of the shape that is shown. */
  private id = 0;
  /** Ends the run of the shape that was asked for last, once another one is wanted. */
  private asked = new AbortController();
  private readonly poses: Poses;
  readonly supports: Supports;

  constructor(private readonly panel: HTMLElement, private readonly parts: Parts) {
    this.poses = new Poses({ run: parts.run, say: parts.say, wanted: () => parts.job.wanted(), stand: (rotate_deg) => this.stand(rotate_deg) });
    this.supports = new Supports({ ...parts, view: () => this.view, chosen: () => this.chosen });
    this.close();
  }

  close(): void {
    [this.report, this.view, this.chosen, this.side, this.key] = [null, null, [], null, ""];
    clearTimeout(this.timer);
    this.asked.abort();
    this.supports.setPaint(null);
    this.parts.viewer()?.setPart(null);
    this.panel.replaceChildren(el("p", { class: "note" }, "Open a mesh (STL, OBJ, PLY, OFF, 3MF), a drawing (SVG, DXF), a scan or a job file to see its shape here, choose faces, and say where it is held and loaded."));
    this.onPart(null);
  }

  /** Whether the job has a shape that can be shown before it is planned. */
  static has(text: string): boolean { return ["mesh", "outline", "ct"].some((key) => get(text, "shape", key) !== null) || get(text, "shape.ct", "path") !== null; }

  /** The text changed: the shape is made anew where it depends on what changed. */
  textChanged(text: string): void {
    if (!ShapePanel.has(text)) return;
    clearTimeout(this.timer);
    if (this.report) this.supports.textChanged();
    if (this.keyOf(text) !== this.key) this.timer = setTimeout(() => void this.load(), REST_MS) as unknown as number;
  }

  private keyOf(text: string): string {
    const own = entries(text).filter((e) => e.table === "shape" || e.table.startsWith("shape.") || OTHERS.some(([t, k]) => t === e.table && k === e.key));
    return own.map((e) => `${e.table}.${e.key}=${text.slice(e.from, e.to)}`).join("\n");
  }

  /** Asks the server for the shape of the job as it stands. */
  async load(): Promise<void> {
    const wanted = this.parts.job.wanted();
    const text = this.parts.job.text();
    if (!wanted || text === null) return;
    this.asked.abort();
    const { signal } = (this.asked = new AbortController());
    clearTimeout(this.timer);
    this.key = this.keyOf(text);
    const end = await this.parts.run({ kind: "shape", ...wanted }, signal);
    if (!end || signal.aborted) return;
    try {
      const [result, bytes] = await Promise.all([api.result(end.id), api.bytes(`v1/jobs/${end.id}/surface`)]);
      if (!signal.aborted) this.take(end.id, result, bytes);
    } catch (error) {
      if (!signal.aborted) this.parts.say((error as Error).message, true);
    }
  }

  /** Reads the part anew where its file has changed on the disk since, and says so; gives whether it had. */
  async readAnew(): Promise<boolean> {
    const { id, report } = this;
    if (!report) return false;
    try {
      const { path, changed } = await api.partFile(id);
      if (!changed || this.report !== report) return false;
      await this.load();
      // The part as it was stays where its file is gone or cannot be read; the error says so.
      if (this.report !== report) this.parts.say(`${path} has changed on the disk since it was read. It was read again: this is the part as it is now, and a stress that was shown is gone.`, true);
      return true;
    } catch {
      // A run that is no longer kept says nothing of its file.
      return false;
    }
  }

  /** Takes the shape of a run in place of the one before. */
  private take(id: number, result: api.Result, bytes: ArrayBuffer): void {
    this.id = id;
    const isSame = this.report !== null;
    this.report = result.report as unknown as api.ShapeReport;
    this.warnings = result.warnings;
    this.chosen = this.chosen.filter((f) => f < this.report!.faces_in_all);
    this.side = null;
    const view = new PartView(surfaceOf(bytes), () => { document.documentElement.dataset.search = String(id); });
    this.view = view;
    const viewer = this.parts.viewer();
    if (viewer) viewer.setPart(view, isSame);
    this.build();
    this.onPart(id);
    document.documentElement.dataset.shape = String(id);
  }

  /** A face was clicked, or its button pressed; -1 is beside the part. */
  choose(face: number, isAdded: boolean): void {
    this.side = null;
    if (face < 0) { if (!isAdded) this.chosen = []; }
    else if (!isAdded) this.chosen = this.chosen.length === 1 && this.chosen[0] === face ? [] : [face];
    else this.chosen = this.chosen.includes(face) ? this.chosen.filter((f) => f !== face) : [...this.chosen, face];
    this.onChosen();
  }

  /** Chooses further faces. */
  add(faces: number[]): void {
    const more = faces.filter((f) => !this.chosen.includes(f));
    if (more.length === 0) return;
    this.side = null;
    this.chosen = [...this.chosen, ...more];
    this.onChosen();
  }

  /** Chooses the neighbours of the chosen faces too. */
  grow(isSmooth: boolean): void { if (this.view) this.add(this.view.beside(this.chosen, isSmooth)); }

  /** A face in words. */
  words(face: number): string {
    const row = this.report?.faces[face];
    if (!row) return "a face without a name: too many smaller ones";
    const round = row.radius_mm ? `, ${row.hollow ? "hole of radius" : "radius"} ${fixed(row.radius_mm, 2)} mm` : "";
    return `${row.name} · ${row.kind}${round}, ${fixed(row.area_mm2, 1)} mm²${row.doubtful ? " · another face is alike: choose it by a box in the text" : ""}`;
  }

  private put(key: string, value: string | null): void { this.parts.job.state("shape", key, value); }

  private build(): void {
    const report = this.report!;
    const size = [0, 1, 2].map((k) => report.high_mm[k]! - report.low_mm[k]!);
    const warnings = this.warnings.map(warning);
    const fact = (name: string, value: string, id = "") => el("tr", {}, el("td", {}, name), el("td", { class: "n", ...(id ? { id } : {}) }, value));
    const sizes = [fact("Size", `${size.map((v) => fixed(v, 2)).join(" × ")} mm`, "size"), fact("Volume", `${fixed(report.volume_mm3 / 1000, 3)} cm³`)];
    if (report.preview) {
      const { resolution_mm, voxels, merged } = report.preview;
      const n = merged.reduce((all, by) => all * by, 1);
      redraw(this.panel,
        this.parts.job.printerAndMaterial,
        el("h2", {}, "Size"), el("table", {}, ...sizes, fact("Voxels", voxels.join(" × "))),
        el("p", { class: "note", id: "preview" }, `A preview at ${fixed(resolution_mm, 2)} mm: ${n === 1 ? "no voxels were merged" : `${merged.join(" × ")} voxels were merged into one`}. Paths are planned from every voxel, under Job.`),
        ...warnings,
      );
      return;
    }
    const defects: [number, string][] = [
      [report.open_edges, "open edges"], [report.nonmanifold_edges, "edges with more than two triangles"], [report.badly_wound_edges, "edges of triangles wound against each other"], [report.zero_area_facets, "triangles without area"],
    ];
    const found = defects.filter(([n]) => n > 0);
    const unit = el("select", { id: "unit", onchange: () => this.put("unit", quoted(unit.value)) }, ...UNITS.map((u) => el("option", { value: u, selected: u === report.unit }, u)));
    const scale = numberField({ id: "scale", value: report.scale }, { isPositive: true }, (v) => this.put("scale", String(v)));
    const isDoubtful = report.likely_unit !== null && report.likely_unit !== report.unit;
    const turn = (axis: 0 | 1 | 2) => el("button", { type: "button", id: `turn-${"xyz"[axis]}`, onclick: () => this.turn(new Quaternion().setFromAxisAngle(new Vector3().setComponent(axis, 1), Math.PI / 2)) }, `90° about ${"xyz"[axis]}`);
    const lay = el("button", { type: "button", id: "lay", onclick: () => this.lay() }, "Lay the chosen face on the plate");
    redraw(this.panel,
      // Supports, build directions and strength depend on them, so they come first.
      this.parts.job.printerAndMaterial,
      el("h2", {}, "Size"),
      el("table", {}, ...sizes, fact("Bodies, shells", `${report.bodies}, ${report.shells}`), fact("Triangles", String(report.triangles)), fact("Faces", String(report.faces_in_all), "faces-in-all")),
      ...(isDoubtful ? [el("p", { class: "warning", id: "unit-asked" }, `The file states no unit. In mm the part would be ${fixed(Math.max(...size), 2)} mm long, which is small: is it in ${report.likely_unit}? `, el("button", { type: "button", id: "take-likely", onclick: () => this.put("unit", quoted(report.likely_unit!)) }, `It is in ${report.likely_unit}`), " ", el("button", { type: "button", onclick: () => this.put("unit", quoted("mm")) }, "It is in mm"))] : []),
      el("div", { class: "row" }, el("label", {}, report.unit_is_stated ? "Unit" : "Unit (the file states none)", unit), el("label", {}, "Scale", scale)),
      el("h2", {}, "Defects"),
      found.length === 0 ? el("p", { class: "note", id: "defects" }, "None: the surface is closed.") : el("table", { id: "defects" }, ...found.map(([n, words]) => fact(words, String(n)))),
      ...this.defects(report),
      ...warnings,
      el("h2", {}, "Turn"), el("div", { class: "row" }, turn(0), turn(1), turn(2)), el("div", { class: "row" }, lay),
      el("p", { class: "note" }, "Choose a face by a click on the part, or in the list of the next tab."),
      el("h2", {}, "Build direction"), this.poses.element,
      el("h2", {}, "Supports"), this.supports.element,
      el("h2", {}, "Place on the plate"), this.place(),
      el("div", { class: "row" }, el("button", { type: "button", class: "main", onclick: () => this.parts.openLoads() }, "Say where it is held and loaded")),
    );
    this.supports.build();
    this.chosenChanged();
  }

  /** Where the defects are: colours on the part, and a button that leads from one to the next. */
  private defects(report: api.ShapeReport): Node[] {
    if (report.open_edges + report.nonmanifold_edges + report.badly_wound_edges === 0) return [];
    const swatch = (colour: Rgb) => { const box = el("span", { class: "swatch" }); box.style.background = css(colour); return box; };
    const places = this.view?.defects() ?? [];
    let next = 0;
    const words = el("output", { id: "defect" });
    const go = el("button", { type: "button", id: "next-defect", onclick: () => {
      const [place, viewer] = [places[next % places.length], this.parts.viewer()];
      if (!place || !viewer || !this.view) return;
      viewer.lookAt(place, 0.12 * this.view.high.distanceTo(this.view.low));
      words.textContent = `${(next % places.length) + 1} of ${places.length}, at (${place.toArray().map((v) => fixed(v, 1)).join(", ")})`;
      next++;
    } }, "Look at the next one");
    const left = report.edges_left === 0 ? "all of them were mended" : `${report.edges_left} edges are left after mending`;
    return [el("p", { class: "note" }, "On the part: ", swatch(FAULT), "in the file ", swatch(LEFT), `left after mending; ${left}.`), ...(places.length > 0 ? [el("div", { class: "row" }, go, words)] : [])];
  }

  /** The turn of the part as the text has it. */
  private get rotation(): number[] {
    const read = value(get(this.parts.job.text() ?? "", "shape", "rotate_deg") ?? "");
    return Array.isArray(read) && read.every((v) => typeof v === "number") ? (read as number[]) : [0, 0, 0];
  }

  /** How the part on screen stands. */
  get standing(): Matrix4 {
    const [a, b, c] = this.report!.rotation as [number[], number[], number[]];
    return new Matrix4().set(a[0]!, a[1]!, a[2]!, 0, b[0]!, b[1]!, b[2]!, 0, c[0]!, c[1]!, c[2]!, 0, 0, 0, 0, 1);
  }

  /** How it will stand: the text is ahead of the screen until the shape has come. */
  get turned(): Matrix4 {
    const [x, y, z] = this.rotation.map((v) => (v * Math.PI) / 180) as [number, number, number];
    return new Matrix4().makeRotationFromEuler(new Euler(x, y, z, "ZYX"));
  }

  /** Shows the list of poses, which depends on everything but how the part stands now; `loads` are those in its file. */
  showPoses(loads: string): void {
    if (!this.report) return;
    const text = this.parts.job.text() ?? "";
    const moved = ["shape.rotate_deg", "shape.position_mm"];
    const isOwn = (e: { table: string; key: string }) => (e.table === "shape" && !moved.includes(`shape.${e.key}`)) || e.table.startsWith("support") || e.table === "process" || e.table === "material" || (e.table.startsWith("fill") && e.key !== "density");
    this.poses.show(this.rotation, entries(text).filter(isOwn).map((e) => `${e.table}.${e.key}=${text.slice(e.from, e.to)}`).join("\n") + loads);
  }

  /** Turns the part, and its loads with it. */
  private stand(rotate_deg: number[]): void {
    const turning = this.parts.turning();
    if ("refused" in turning) { this.parts.say(turning.refused, true); return; }
    this.parts.job.put(set(turning.text, "shape", "rotate_deg", `[${rotate_deg.map(plainNumber).join(", ")}]`));
  }

  /** Where the middle of the part stands on the plate. */
  private place(): HTMLElement {
    const read = value(get(this.parts.job.text() ?? "", "shape", "position_mm") ?? "");
    const known = Array.isArray(read) ? read : [];
    const inputs = ["x", "y"].map((axis, k) => numberField({ id: `place-${axis}`, placeholder: "middle", value: typeof known[k] === "number" ? (known[k] as number) : "" }, { isOptional: true }, () => enter()));
    const enter = () => {
      const all = inputs.map(numberOf);
      const isEmpty = inputs.every((input) => input.value === "");
      // One of the two alone is no place.
      inputs.forEach((input, k) => complain(input, Number.isFinite(all[k]) || isEmpty ? "" : "needs a number too, or neither"));
      if (isEmpty || all.every(Number.isFinite)) this.put("position_mm", isEmpty ? null : `[${all.join(", ")}]`);
    };
    return el("div", { class: "row" }, ...inputs.map((input, k) => el("label", {}, `middle on the plate, ${"xy"[k]}, mm`, input)));
  }

  chosenChanged(): void {
    const lay = document.getElementById("lay") as HTMLButtonElement | null;
    if (lay) lay.disabled = this.chosen.length !== 1;
    this.supports.chosenChanged();
  }

  private lay(): void {
    const face = this.chosen[0];
    const normal = face === undefined ? null : this.view?.patch(face).normal;
    if (normal && normal.length() > 0.5) this.turn(new Quaternion().setFromUnitVectors(normal, new Vector3(0, 0, -1)), this.standing);
  }

  /** Turns the part further from `now`: two presses in a row are two turns. */
  private turn(by: Quaternion, now = this.turned): void {
    const m = new Matrix4().makeRotationFromQuaternion(by).multiply(now).elements;
    this.stand(turns((row, column) => m[4 * column + row]!));
  }
}

/** The turns about x, then y, then z, in degrees, that make a matrix. */
export function turns(m: (row: number, column: number) => number): [number, number, number] {
  const deg = 180 / Math.PI;
  const y = Math.asin(Math.min(Math.max(-m(2, 0), -1), 1));
  // At a right angle about y the other two turn about one axis; all of it is given to x.
  if (Math.abs(m(2, 0)) > 1 - 1e-9) return [Math.atan2(-m(1, 2), m(1, 1)) * deg, y * deg, 0];
  return [Math.atan2(m(2, 1), m(2, 2)) * deg, y * deg, Math.atan2(m(1, 0), m(0, 0)) * deg];
}

/** A number with at most five digits after the point, without a zero that has a sign. */
export const plainNumber = (v: number) => String(Math.round(v * 1e5) / 1e5 + 0);
