// Fixtures and loads on the faces of the part, and the stress under them.
//
// The text of the job is the only state: the list is read from it, and a field changes one value of it. What is undone is
// the text.

import { Matrix4, Vector3 } from "three";
import * as api from "./api";
import { gradient, ramp, type Rgb } from "./colours";
import { alike, el, fixed, numberField, redraw, showValue, threeDigits, warning } from "./dom";
import { Inside } from "./inside";
import { quoted, type JobPanel } from "./job";
import { CHOSEN, HELD, LOADED, QUANTITIES, StressView, mises, principal, type Arrow, type Quantity, type Side } from "./part";
import { plainNumber, type ShapePanel } from "./shape";
import { blocks, change, get, insert, remove, set, value, type Block, type Table, type Value } from "./toml";
import type { Gesture, Viewer } from "./viewer";

interface Parts { run: (wanted: Record<string, unknown>) => Promise<api.JobState | null>; say: (message: string, isError?: boolean) => void; viewer: () => Viewer | null; job: JobPanel; shape: ShapePanel; /** Takes a picture that the server draws, with its words. */ pictured: (address: string, words: string) => void; test: () => void }

type LoadKind = "force_n" | "pressure_mpa" | "moment_nmm" | "torque_nmm" | "bearing_n" | "acceleration_mm_s2";
/** Key in the job, words, and whether it has three components. */
const KINDS: [LoadKind, string, boolean][] = [
  ["force_n", "force, N", true], ["pressure_mpa", "pressure, MPa", false], ["moment_nmm", "moment, N mm", true], ["torque_nmm", "torque about the axis of the face, N mm", false], ["bearing_n", "bearing load of a pin, N", true], ["acceleration_mm_s2", "acceleration, mm/s²", true],
];
const FIXES: [string, string][] = [["xyz", "in all directions"], ["normal", "across the surface (it may slide)"], ["x", "along x"], ["y", "along y"], ["z", "along z"], ["xy", "along x and y"], ["xz", "along x and z"], ["yz", "along y and z"]];
/** Standard gravity, mm/s2. Source: the General Conference on Weights and Measures of 1901. */
const GRAVITY = -9806.65;

/** Where fixtures, loads and their cases stand, each a table of a list. */
const LISTS = ["guide.fixture", "guide.load", "guide.case", "guide.case.load"];

/** A fixture or a load of the text. Its block is there where the page can change it. */
interface Item { name: string; isFixture: boolean; /** Whether all of its values are read. */ isRead: boolean; block: Block | null; case: string | null; keys: Table; face: number; side: Side | null; place: string }

/** The name that the server gives the case of all loads without one. */
const UNNAMED = "loads";

/** What is told of what the page only shows. */
const CHANGED_THERE = "written in the text of the job, and changed there.";

const tableOf = (v: Value | undefined): Table | null => (v && typeof v === "object" && !Array.isArray(v) ? v : null);
const numbers = (v: Value | undefined): number[] | null => (Array.isArray(v) && v.length === 3 && v.every((n) => typeof n === "number") ? (v as number[]) : null);

export class LoadsPanel {
  private items: Item[] = [];
  /** Named load cases, in the order of the text; without a block where they are written in another form than `[[guide.case]]`. */
  private cases: { name: string; weight: number; block: Block | null }[] = [];
  private stress: { view: StressView; id: number; cases: string[]; report: api.StressReport; text: string; warnings: api.Warning[]; inside: Inside } | null = null;
  private shown: { what: Quantity; case: number; scale: [number, number] | null; magnified: number; isOn: boolean } = { what: "mises", case: 0, scale: null, magnified: 0, isOn: true };
  private readonly list = el("div", { id: "items" });
  private readonly picked = el("div", { id: "picked" });
  private readonly answer = el("div", { id: "stress" });
  private isActive = false;
  /** The load case that was chosen last. */
  private wanted = 0;
  /** The fields that are drawn, without their values. */
  private drawn = "";

  constructor(private readonly panel: HTMLElement, private readonly parts: Parts) { this.partChanged(); }

  setActive(isActive: boolean): void { this.isActive = isActive; if (!isActive) this.setGesture("turn"); this.legend(); }

  private get text(): string { return this.parts.job.text() ?? ""; }
  private put(text: string): void { this.parts.job.put(text); }

  /** Another part is there, or none. */
  partChanged(): void {
    const { report } = this.parts.shape;
    this.stress = null;
    this.answer.replaceChildren();
    if (!report) {
      this.panel.replaceChildren(el("p", { class: "note" }, "Open a mesh, a drawing or a job file to say where its part is held and loaded."));
      this.legend();
      return;
    }
    const isOpen = (document.getElementById("all-faces") as HTMLDetailsElement | null)?.open ?? false;
    const faces = report.faces.map((_, face) => {
      const button = el("button", { type: "button", class: "face", id: `face-${face}`, "data-face": face, "aria-pressed": "false", onclick: (event) => this.parts.shape.choose(face, (event as MouseEvent).shiftKey || (event as MouseEvent).ctrlKey) }, this.parts.shape.words(face));
      for (const [event, lit] of [["focus", face], ["pointerenter", face], ["blur", -1], ["pointerleave", -1]] as const) button.addEventListener(event, () => this.parts.viewer()?.setHovered(lit));
      return el("li", {}, button);
    });
    // A scan has no faces, and its stress is solved with its plan.
    const isPreview = report.preview !== undefined;
    redraw(this.panel, ...(isPreview ? [el("p", { class: "note" }, "A scan has no faces: places are boxes and planes, written in the text of the job.")] : [
      el("h2", {}, "Chosen faces"), this.tools(), this.picked,
      el("details", { id: "all-faces", open: isOpen }, el("summary", {}, `All faces (${report.faces_in_all})`), el("ul", { class: "plain faces" }, ...faces), ...(report.faces_in_all > report.faces.length ? [el("p", { class: "note" }, `${report.faces_in_all - report.faces.length} smaller ones are not listed.`)] : [])),
    ]),
      el("h2", {}, "Fixtures and loads"), this.list,
      ...(isPreview ? [] : [
        el("h2", {}, "Stress"),
        el("div", { class: "row" }, el("button", { type: "button", class: "main", id: "solve", onclick: () => void this.solve() }, "Solve the stress")),
        this.answer,
      ]),
      el("h2", {}, "Next"),
      this.followBox(),
      el("div", { class: "row" }, el("button", { type: "button", id: "plan-here", onclick: () => void this.parts.job.plan() }, "Plan the paths"), el("button", { type: "button", id: "test-here", onclick: () => this.parts.test() }, "Where does it break?")),
    );
    this.drawn = "";
    this.textChanged();
    this.chosenChanged();
    // What a drag does stays; the line of a split would lie on the part before.
    const drag = this.parts.viewer()?.dragging ?? "turn";
    this.setGesture(drag === "split" ? "turn" : drag);
  }

  /** Ways of choosing several faces at once. */
  private tools(): HTMLElement {
    const drag = (gesture: "box" | "brush", label: string, title: string) => el("button", { type: "button", id: gesture, "aria-pressed": "false", title, onclick: () => this.setGesture(this.parts.viewer()?.dragging === gesture ? "turn" : gesture) }, label);
    const grow = (id: string, isSmooth: boolean, label: string, title: string) => el("button", { type: "button", id, disabled: true, title, onclick: () => this.parts.shape.grow(isSmooth) }, label);
    return el("div", { class: "row", id: "tools" },
      drag("box", "Box", "Drag a box around faces (or hold R and drag)"), drag("brush", "Brush", "Drag over faces (or hold B and drag)"),
      el("button", { type: "button", id: "split", "aria-pressed": "false", disabled: true, title: "Cut the chosen face along a line: click two points of it", onclick: () => this.beginSplit() }, "Split"),
      grow("grow", true, "Grow", "Add the neighbours over smooth edges (G)"), grow("grow-all", false, "All neighbours", "Add all neighbours (Shift+G)"));
  }

  /** Sets what a drag over the part does. */
  setGesture(gesture: Gesture): void {
    this.parts.viewer()?.setGesture(gesture);
    if (gesture !== "split") this.splitFrom = null;
    for (const id of ["box", "brush", "split"]) document.getElementById(id)?.setAttribute("aria-pressed", String(gesture === id));
  }

  // ---- parts of faces ----------------------------------------------------------------------------------------------

  /** The first point of the line along which the chosen face is split. */
  private splitFrom: Vector3 | null = null;

  private beginSplit(): void {
    if (this.parts.viewer()?.dragging === "split") { this.setGesture("turn"); return; }
    this.setGesture("split");
    this.parts.say("Click two points of the chosen face: it is cut along the line through them.");
  }

  /** A click while a face is split. The cut stands upright on the face; what lies to the left of the line, seen from outside, is chosen. */
  split(at: { clientX: number; clientY: number }): void {
    const { shape } = this.parts;
    const hit = this.parts.viewer() && shape.view?.pointAt(this.parts.viewer()!.rayAt(at.clientX, at.clientY));
    if (!hit || hit.face !== shape.chosen[0]) { this.parts.say("That point lies on another face; click the chosen one.", true); return; }
    if (!this.splitFrom) { this.splitFrom = hit.point; this.parts.say("Now the second point."); return; }
    const normal = hit.normal.clone().cross(hit.point.clone().sub(this.splitFrom));
    if (normal.length() < 1e-6) { this.parts.say("Both clicks hit the same point; click the second one further along the cut.", true); return; }
    shape.side = { point: this.splitFrom, normal: normal.normalize() };
    this.setGesture("turn");
    document.getElementById("progress")!.hidden = true;
    this.chosenChanged();
  }

  /** The side of a plane as the text has it, on the part as it stands. */
  private sideOf(of: Value | undefined): Side | null {
    const side = tableOf(of);
    const [point, normal] = [numbers(side?.point_mm), numbers(side?.normal)];
    return point && normal ? { point: this.pointToPart(new Vector3().fromArray(point)), normal: this.toPart(new Vector3().fromArray(normal)).normalize() } : null;
  }

  /** A place on a face for the text; `back` gives points and directions in the coordinates of the text. */
  private onFace(name: string, side: Side | null, isOfPart = this.isOfPart): string {
    if (!side) return `{ face = ${quoted(name)} }`;
    const [point, normal] = [side.point.clone(), side.normal.clone()];
    if (isOfPart) {
      const { report } = this.parts.shape;
      const back = this.parts.shape.standing.transpose();
      point.sub(new Vector3().fromArray(report!.shift_mm)).applyMatrix4(back).divideScalar(report!.scale);
      normal.applyMatrix4(back);
    }
    return `{ face = ${quoted(name)}, side = { point_mm = ${vectorText(point.toArray())}, normal = ${vectorText(normal.toArray())} } }`;
  }

  private followBox(): HTMLElement {
    const box = el("input", { type: "checkbox", id: "follow", onchange: () => {
      let text = set(this.text, "guide", "kind", box.checked ? quoted("stress") : null);
      text = set(text, "fill", "pattern", box.checked ? quoted("stripes") : null);
      this.put(text);
    } });
    return el("label", { for: "follow", class: "check" }, box, " lay the fill along the stress (stripes)");
  }

  /** The text of the job changed. */
  textChanged(): void {
    if (!this.parts.shape.report) return;
    this.items = this.read();
    // Fields stay while only their values change, so that the one that is entered next is still there.
    const rows = JSON.stringify([this.items.map((i) => [i.name, i.place, i.block !== null, Object.keys(i.keys)]), this.cases.map((c) => c.name)]);
    if (rows === this.drawn) this.fill();
    else redraw(this.list, ...this.rows());
    this.drawn = rows;
    const follow = document.getElementById("follow") as HTMLInputElement | null;
    if (follow) follow.checked = value(get(this.text, "guide", "kind") ?? "") === "stress";
    if (this.stress) {
      const old = document.getElementById("stale");
      if (old) old.hidden = this.stress.text === this.parts.job.stressOf(this.text);
    }
    this.draw();
  }

  /** Puts the values of the text into the fields. */
  private fill(): void {
    this.items.forEach((item, k) => {
      const into = (id: string, v: Value | undefined) => {
        const input = document.getElementById(id) as HTMLInputElement | HTMLSelectElement | null;
        if (!input || v === undefined || input === document.activeElement) return;
        showValue(input, v as number | string);
      };
      into(`fix-${k}`, item.keys.fix);
      for (const [key, , isVector] of KINDS) {
        const v = item.keys[key];
        if (isVector) numbers(v)?.forEach((n, axis) => into(`value-${k}-${"xyz"[axis]}`, n));
        else into(`value-${k}`, v);
      }
      numbers(item.keys.displacement_mm)?.forEach((n, axis) => into(`moved-${k}-${"xyz"[axis]}`, n));
    });
    this.cases.forEach((_, k) => {
      const input = document.getElementById(`weight-${k}`) as HTMLInputElement | null;
      if (input && input !== document.activeElement) showValue(input, this.weight(k));
    });
  }

  /** Fixtures and loads of the text. */
  private read(): Item[] {
    const text = this.text;
    const faces = new Map(this.parts.shape.report!.faces.map((row, k) => [row.name, k]));
    const found: Item[] = [];
    let inCase = "";
    this.cases = [];
    const counts = new Map<string, number>();
    const tables = (list: Value | undefined) => (Array.isArray(list) ? list.map((one) => tableOf(one) ?? {}) : []);
    const add = (isFixture: boolean, block: Block | null, keys: Table, ofCase: string | null, isRead = true) => {
      const counted = `${isFixture} ${ofCase}`;
      const n = (counts.get(counted) ?? 0) + 1;
      counts.set(counted, n);
      const on = tableOf(keys.on);
      const named = typeof on?.face === "string" ? faces.get(on.face.toLowerCase()) ?? -1 : -1;
      const side = named >= 0 ? this.sideOf(on!.side) : null;
      const isWhole = on?.side === undefined || side !== null;
      const face = isRead && isWhole ? named : -1;
      const place = !isRead ? "it cannot be read here" : face >= 0 ? `${this.parts.shape.words(face)}${side ? ` · the part beyond ${planeWords(on!.side)}` : ""}` : keys.on !== undefined ? JSON.stringify(keys.on).replaceAll('"', "") : "the whole part";
      found.push({ name: `${isFixture ? "fixture" : "load"} ${n}${ofCase === null ? "" : ` of case ${ofCase}`}`, isFixture, isRead, block, case: ofCase, keys, face, side, place });
    };
    const addCase = (keys: Table, block: Block | null) => {
      inCase = String(keys.name ?? "");
      this.cases.push({ name: inCase, weight: typeof keys.weight === "number" ? keys.weight : 1, block });
      for (const one of tables(keys.load)) add(false, null, one, inCase);
    };
    for (const block of blocks(text, ...LISTS)) {
      if (block.table === "guide.case") addCase(block.values, block);
      else add(block.table === "guide.fixture", block.isPlain ? block : null, block.values, block.table === "guide.case.load" ? inCase : null, block.isRead);
    }
    // Lists of tables in braces.
    const listed = (key: string) => tables(value(get(text, "guide", key) ?? ""));
    for (const one of listed("fixture")) add(true, null, one, null);
    for (const one of listed("load")) add(false, null, one, null);
    for (const one of listed("case")) addCase(one, null);
    return found;
  }

  private rows(): Node[] {
    if (this.items.length === 0) return [el("p", { class: "note" }, "None yet. Choose a face on the part, then press Hold here or Load here.")];
    return [...this.items.map((item, k) => this.row(item, k)), ...this.caseRows()];
  }

  /** The weight of a case as the text has it; 1 where it has none. */
  private weight(k: number): number {
    return this.cases[k]?.weight ?? 1;
  }

  private caseRows(): Node[] {
    if (this.cases.length === 0) return [];
    return [el("h3", {}, "Load cases"), ...this.cases.map(({ name, block }, k) => {
      if (!block) return el("p", { class: "note" }, `${name}: weight ${this.weight(k)}, ${CHANGED_THERE}`);
      const input = numberField({ id: `weight-${k}`, value: this.weight(k) }, { isPositive: true }, (v) => this.put(change(this.text, this.cases[k]!.block!, "weight", String(v))));
      return el("div", { class: "row" }, el("label", {}, `${name}: weight`, input));
    }), el("p", { class: "note" }, "Loads of one case act together. Cases act one after the other, each with the same fixtures; loads without a case form one more.")];
  }

  /** Whether one more table of a list of the guide fits the text; says where it has to be written otherwise. */
  private takes(list: "fixture" | "load" | "case"): boolean {
    const isOpen = get(this.text, "guide", list) === null && get(this.text, "", "guide") === null;
    if (!isOpen) this.parts.say(`guide.${list} is not written as [[guide.${list}]] in the text of the job: add it there.`, true);
    return isOpen;
  }

  /** Puts a load into another case: one of the text, a new one, or none. */
  private moveTo(item: Item, to: string | null): void {
    if (!item.block) return;
    if (!this.takes(to === null ? "load" : "case")) { this.drawn = ""; this.textChanged(); return; }
    const body = this.text.slice(item.block.from, item.block.to).replace(/^[^\n]*\n/, "");
    let text = this.without(item);
    if (to === null) {
      const all = blocks(text, "guide.fixture", "guide.load");
      text = insert(text, all.length > 0 ? all[all.length - 1]!.to : text.length, `[[guide.load]]\n${body}`);
    } else {
      const all = blocks(text, "guide.case", "guide.case.load");
      const isHere = (b: Block) => b.table === "guide.case" && b.values.name === to;
      let k = all.findIndex(isHere);
      const isNew = k < 0;
      // Behind the last load of the case; a new case comes behind the last case.
      if (isNew) k = all.length - 1;
      else while (all[k + 1]?.table === "guide.case.load") k++;
      const head = isNew ? `[[guide.case]]\nname = ${quoted(to)}\nweight = 1\n\n` : "";
      const last = [...blocks(text, "guide.fixture", "guide.load")].pop();
      text = insert(text, k >= 0 ? all[k]!.to : last?.to ?? text.length, `${head}[[guide.case.load]]\n${body}`);
    }
    this.put(text);
  }

  /** The text without a fixture or a load, nor a case that would be left without loads. */
  private without(item: Item): string {
    const rest = remove(this.text, item.block!);
    if (item.case === null || this.items.some((other) => other !== item && other.case === item.case)) return rest;
    const own = blocks(rest, "guide.case").find((b) => b.values.name === item.case);
    return own ? remove(rest, own) : rest;
  }

  /** The name of the next new case. */
  private newCase(): string {
    for (let n = this.cases.length + 1; ; n++) if (!this.cases.some((c) => c.name === `case ${n}`)) return `case ${n}`;
  }

  private row(item: Item, k: number): Node {
    // The text may have moved since, so the block is looked up when it is changed.
    const block = () => this.items[k]?.block ?? null;
    const put = (key: string, words: string | null) => { const own = block(); if (own) this.put(change(this.text, own, key, words)); };
    const off = el("button", { type: "button", id: `remove-${k}`, "aria-label": `Remove ${item.name}`, onclick: () => { const own = this.items[k]; if (own?.block) this.put(this.without(own)); } }, "Remove");
    const box = el("fieldset", { class: item.isFixture ? "held" : "loaded" }, el("legend", {}, item.name));
    for (const [event, lit] of [["pointerenter", item.face], ["focusin", item.face], ["pointerleave", -1], ["focusout", -1]] as const) box.addEventListener(event, () => this.parts.viewer()?.setHovered(lit));
    box.append(el("p", { class: "note" }, item.place));
    if (!item.block) { box.append(el("p", { class: "note" }, `It is ${CHANGED_THERE}`)); return box; }
    if (item.isFixture) {
      const fix = String(item.keys.fix ?? "");
      const select = el("select", { id: `fix-${k}`, onchange: () => put("fix", quoted(select.value)) }, ...FIXES.map(([key, words]) => el("option", { value: key, selected: key === fix }, words)));
      if (!FIXES.some(([key]) => key === fix)) select.append(el("option", { value: fix, selected: true }, fix));
      const moved = numbers(item.keys.displacement_mm);
      box.append(el("div", { class: "row" }, el("label", {}, "held", select), off),
        el("details", moved ? { open: true } : {}, el("summary", {}, "moved by a given way"), this.vector(`moved-${k}`, "mm", () => numbers(this.items[k]?.keys.displacement_mm) ?? [0, 0, 0], (v) => put("displacement_mm", v.every((n) => n === 0) ? null : `[${v.join(", ")}]`))));
      return box;
    }
    const kind = KINDS.find(([key]) => key in item.keys);
    if (!kind) { box.append(el("p", { class: "note" }, `Its kind is ${CHANGED_THERE}`), off); return box; }
    const isOnFace = "on" in item.keys;
    const select = el("select", { id: `kind-${k}`, onchange: () => {
      const [to, { text }] = [select.value as LoadKind, this];
      const entry = block()?.keys.get(kind[0]);
      if (!entry) return;
      // The key alone changes its name, so that the comment of its line stays, and the vector between two loads in N.
      const line = text.lastIndexOf("\n", entry.from) + 1;
      const isSame = [kind[0], to].every((key) => key === "force_n" || key === "bearing_n");
      this.put(text.slice(0, line) + text.slice(line, entry.from).replace(kind[0], to) + (isSame ? text.slice(entry.from, entry.to) : this.proposed(to, item)) + text.slice(entry.to));
    } }, ...KINDS.filter(([key]) => (key === "acceleration_mm_s2") !== isOnFace).map(([key, words]) => el("option", { value: key, selected: key === kind[0] }, words)));
    box.append(el("div", { class: "row" }, el("label", {}, "kind", select), off));
    const now = item.keys[kind[0]];
    if (kind[2]) box.append(this.vector(`value-${k}`, "", () => numbers(this.items[k]?.keys[kind[0]]) ?? [0, 0, 0], (v) => put(kind[0], `[${v.join(", ")}]`)));
    else {
      const input = numberField({ id: `value-${k}`, value: typeof now === "number" ? now : 0, "aria-label": kind[1] }, {}, (v) => put(kind[0], String(v)));
      box.append(el("div", { class: "row" }, el("label", {}, kind[1], input)));
    }
    const [none, other] = ["", "\n"];
    const into: HTMLSelectElement = el("select", { id: `case-${k}`, onchange: () => this.moveTo(this.items[k]!, into.value === none ? null : into.value === other ? this.newCase() : into.value) },
      el("option", { value: none, selected: item.case === null }, "none"), ...this.cases.filter(({ name, block }) => (block && block.values.load === undefined) || name === item.case).map(({ name }) => el("option", { value: name, selected: item.case === name }, name)), el("option", { value: other }, "a new case"));
    box.append(el("div", { class: "row" }, el("label", {}, "load case", into)));
    return box;
  }

  private vector(id: string, unit: string, now: () => number[], then: (v: number[]) => void): HTMLElement {
    const inputs = ["x", "y", "z"].map((axis, k) => {
      // The other two are those of the text, which may have changed since.
      return numberField({ id: `${id}-${axis}`, value: now()[k]! }, {}, (v) => { const all = [...now()]; all[k] = v; then(all); });
    });
    return el("div", { class: "row three" }, ...inputs.map((input, k) => el("label", {}, `${"xyz"[k]}${unit ? `, ${unit}` : ""}`, input)));
  }

  /** What a new load of a kind begins with: 100 N against the face. */
  private proposed(kind: LoadKind, item: { face: number }): string {
    const patch = item.face >= 0 ? this.parts.shape.view?.patch(item.face) : undefined;
    const normal = patch && patch.normal.length() > 0.5 ? patch.normal : new Vector3(0, 0, 1);
    const against = this.toJob(normal.clone().multiplyScalar(-100)).toArray();
    switch (kind) {
      case "force_n": case "bearing_n": return vectorText(against);
      case "pressure_mpa": return "1";
      case "moment_nmm": return "[0, 0, 1000]";
      case "torque_nmm": return "1000";
      case "acceleration_mm_s2": return vectorText(this.toJob(new Vector3(0, 0, GRAVITY)).toArray());
    }
  }

  /** Whether loads have the coordinates of the file. The text says it, which is ahead of the screen while the part is turned. */
  private get isOfPart(): boolean { return value(get(this.text, "guide", "frame") ?? "") === "part" && !this.parts.shape.report!.preview; }
  /** What turns a direction of the part on screen into the coordinates of the job's loads. */
  private get intoJob(): Matrix4 {
    const { standing, turned, report } = this.parts.shape;
    if (report!.preview) return new Matrix4();
    return this.isOfPart ? standing.transpose() : turned.multiply(standing.transpose());
  }
  private toJob(v: Vector3): Vector3 { return v.applyMatrix4(this.intoJob); }
  private toPart(v: Vector3): Vector3 { return v.applyMatrix4(this.intoJob.transpose()); }

  /** Fixtures and loads by the coordinates of the file, which stay when the part is turned together with them. */
  inFile(): string {
    if (!this.parts.shape.report) return "";
    const back = this.isOfPart ? new Matrix4() : this.parts.shape.turned.transpose();
    const turned = (v: Value) => { const three = numbers(v); return three ? new Vector3().fromArray(three).applyMatrix4(back).toArray().map(plainNumber) : v; };
    return JSON.stringify([this.items.map((i) => [i.name, i.place, Object.entries(i.keys).map(([key, v]) => [key, turned(v)])]), this.cases.map((_, k) => this.weight(k))]);
  }

  /** The text of the job with its loads in the frame of the part, so that they turn with it; or why that cannot be. */
  turning(): { text: string } | { refused: string } {
    if (this.items.length === 0 || this.isOfPart) return { text: this.text };
    const back = this.parts.shape.turned.transpose();
    const vectors = [...KINDS.filter(([, , isVector]) => isVector).map(([key]) => key as string), "displacement_mm"];
    let text = this.text;
    for (const [k, item] of this.items.entries()) {
      const isPlaced = !("on" in item.keys) || item.face >= 0;
      const isTurned = !item.isFixture || ["xyz", "normal"].includes(String(item.keys.fix)) || back.equals(new Matrix4());
      if (!item.block) return { refused: `${item.name} is ${CHANGED_THERE} Turn the part there too, by shape.rotate_deg.` };
      if (!isPlaced || !isTurned) return { refused: `${item.name} is told in the frame of the plate (${item.place}) and does not turn with the part: choose its place as a face, or set guide.frame = "part" and give its numbers in the coordinates of the file.` };
      for (const key of vectors) {
        const v = numbers(item.keys[key]);
        // Changes before it have moved the block, which keeps its place among the blocks.
        const own = v && this.blockAt(text, k);
        if (own) text = change(text, own, key, vectorText(new Vector3().fromArray(v).applyMatrix4(back).toArray()));
      }
      const own = item.side && this.blockAt(text, k);
      if (own) text = change(text, own, "on", this.onFace(this.parts.shape.report!.faces[item.face]!.name, item.side, true));
    }
    return { text: set(text, "guide", "frame", quoted("part")) };
  }

  /** The block of the k-th fixture or load in a text. */
  private blockAt(text: string, k: number): Block | undefined { return blocks(text, ...LISTS).filter((b) => b.table !== "guide.case")[k]; }

  // ---- adding -----------------------------------------------------------------------------------------------------

  /** Other faces are chosen. */
  chosenChanged(): void {
    const { chosen, report } = this.parts.shape;
    for (const button of this.panel.querySelectorAll<HTMLElement>("button.face")) button.setAttribute("aria-pressed", String(chosen.includes(Number(button.dataset.face))));
    const known = chosen.filter((f) => report?.faces[f]);
    const nothing = known.length === 0;
    const split = document.getElementById("split") as HTMLButtonElement | null;
    if (split) split.disabled = !(chosen.length === 1 && known.length === 1);
    if (split?.disabled && this.parts.viewer()?.dragging === "split") this.setGesture("turn");
    for (const id of ["grow", "grow-all"]) { const button = document.getElementById(id) as HTMLButtonElement | null; if (button) button.disabled = chosen.length === 0; }
    const [hold, load] = [el("button", { type: "button", id: "hold-here", disabled: nothing, onclick: () => this.add("fixture") }, "Hold here"), el("button", { type: "button", id: "load-here", disabled: nothing, onclick: () => this.add("load") }, "Load here")];
    const undo = el("button", { type: "button", id: "undo", disabled: !this.parts.job.canUndo, "aria-label": "Undo", title: "Undo (Ctrl+Z)", onclick: () => this.parts.job.undo() }, "↶");
    const redo = el("button", { type: "button", id: "redo", disabled: !this.parts.job.canRedo, "aria-label": "Redo", title: "Redo (Ctrl+Shift+Z)", onclick: () => this.parts.job.redo() }, "↷");
    const gravity = el("button", { type: "button", id: "gravity", onclick: () => this.add("gravity") }, "Gravity");
    const { side, view } = this.parts.shape;
    const part = side && view && chosen.length === 1 ? view.patch(chosen[0]!, side).area : null;
    const turnSide = el("button", { type: "button", id: "other-side", onclick: () => { side?.normal.negate(); this.chosenChanged(); } }, "The other part");
    const wholeFace = el("button", { type: "button", id: "whole-face", onclick: () => { this.parts.shape.side = null; this.chosenChanged(); } }, "The whole face");
    redraw(this.picked,
      chosen.length === 0 ? el("p", { class: "note" }, "Click a face on the part; with shift further ones. Or take them from the list.") : el("ul", { class: "plain" }, ...chosen.map((f) => el("li", {}, this.parts.shape.words(f)))),
      ...(part === null ? [] : [el("div", { class: "row", id: "part-of-face" }, el("span", {}, `A part of it: ${fixed(part, 1)} mm²`), turnSide, wholeFace)]),
      el("div", { class: "row" }, hold, load, gravity, undo, redo),
    );
    this.draw();
  }

  private add(what: "fixture" | "load" | "gravity"): void {
    const { chosen, report, view, side } = this.parts.shape;
    let text = this.text;
    if (!this.takes(what === "fixture" ? "fixture" : "load")) return;
    const end = () => {
      const all = blocks(text, "guide.fixture", "guide.load");
      return all.length > 0 ? all[all.length - 1]!.to : text.length;
    };
    if (what === "gravity") text = insert(text, end(), `[[guide.load]]\nacceleration_mm_s2 = ${this.proposed("acceleration_mm_s2", { face: -1 })}\n`);
    const named = chosen.filter((f) => report?.faces[f]);
    if (what !== "gravity" && named.some((f) => report!.faces[f]!.doubtful)) {
      this.parts.say("Another face is so alike that the name would not tell them apart. Select it by its place: on = { box_mm = [[x, y, z], [x, y, z]] } in the text of the job.", true);
      return;
    }
    const whole = named.reduce((sum, f) => sum + (view?.patch(f, side).area ?? 0), 0);
    for (const face of what === "gravity" ? [] : named) {
      const on = `on = ${this.onFace(report!.faces[face]!.name, side)}`;
      if (what === "fixture") { text = insert(text, end(), `[[guide.fixture]]\n${on}\nfix = "xyz"\n`); continue; }
      // Several faces share the force by their areas, along the normal of the first one.
      const patch = view!.patch(face, side);
      const first = view!.patch(named[0]!).normal;
      const normal = first.length() > 0.5 ? first : new Vector3(0, 0, 1);
      const force = this.toJob(normal.clone().multiplyScalar((-100 * patch.area) / Math.max(whole, 1e-12)));
      text = insert(text, end(), `[[guide.load]]\n${on}\nforce_n = ${vectorText(force.toArray())}\n`);
    }
    this.parts.shape.chosen = [];
    this.parts.shape.side = null;
    this.put(text);
    this.parts.shape.onChosen();
  }

  // ---- drawing ----------------------------------------------------------------------------------------------------

  /** A point of a place that is no face, mm, or null. */
  private pointOf(on: Value | undefined): Vector3 | null {
    if (!on || typeof on !== "object" || Array.isArray(on)) return null;
    const table = (key: string) => tableOf(on[key]);
    const box = Array.isArray(on.box_mm) ? on.box_mm.map((p) => numbers(p)) : null;
    let p = box?.[0] && box[1] ? box[0].map((v, k) => 0.5 * (v + box[1]![k]!)) : null;
    p ??= numbers(table("plane")?.point_mm) ?? numbers(table("cylinder")?.point_mm) ?? numbers(table("sphere")?.centre_mm) ?? numbers(table("turned_box")?.centre_mm);
    if (!p) return null;
    return this.pointToPart(new Vector3().fromArray(p));
  }

  /** A point of the text on the part as it stands. */
  private pointToPart(at: Vector3): Vector3 {
    const { report } = this.parts.shape;
    return this.isOfPart ? at.multiplyScalar(report!.scale).applyMatrix4(this.parts.shape.standing).add(new Vector3().fromArray(report!.shift_mm)) : at;
  }

  private draw(): void {
    const { view, chosen, side } = this.parts.shape;
    const viewer = this.parts.viewer();
    if (!view) return;
    const colours = new Map<number, Rgb>();
    const parts: { face: number; side: Side; colour: Rgb }[] = [];
    for (const { face, side, isFixture } of this.items) {
      const colour = isFixture ? HELD : LOADED;
      if (face >= 0 && side) parts.push({ face, side, colour });
      else if (face >= 0) colours.set(face, colour);
    }
    // What is chosen lies over what is held and loaded there.
    if (side && chosen.length === 1) parts.push({ face: chosen[0]!, side, colour: CHOSEN });
    else for (const face of chosen) colours.set(face, CHOSEN);
    view.paint(colours);
    view.paintParts(parts.filter((p) => side !== null || !chosen.includes(p.face)));
    const reach = 0.2 * view.high.distanceTo(view.low);
    const arrows: Arrow[] = [];
    for (const item of this.items) if (this.acts(item)) arrows.push(...this.arrows(item, reach));
    view.setArrows(arrows);
    viewer?.draw();
  }

  /** Whether an item acts in what is on screen: under the stress of a load case, its fixtures and its own loads do. */
  private acts(item: Item): boolean {
    const name = this.stress && this.shown.isOn && this.stress.cases.length > 1 ? this.stress.cases[this.shown.case] : undefined;
    return item.isFixture || name === undefined || (item.case ?? UNNAMED) === name;
  }

  /** The arrows of a fixture or a load. An arrow that pulls begins where it acts, one that pushes ends there. */
  private arrows(item: Item, reach: number): Arrow[] {
    const { view } = this.parts.shape;
    const patch = item.face >= 0 ? view!.patch(item.face, item.side) : null;
    // What is stated and cannot be shown is left out; a load without a place acts on all of the part.
    if (!item.isRead || (item.keys.on !== undefined && !patch && !this.pointOf(item.keys.on))) return [];
    const middle = patch ? patch.middle.clone() : this.pointOf(item.keys.on) ?? view!.low.clone().add(view!.high).multiplyScalar(0.5);
    if (item.isFixture) {
      const cone = (at: Vector3, along: Vector3): Arrow => ({ at, along, length: 0.16 * reach, colour: HELD, heads: 1, isCone: true });
      if (!patch) return [cone(middle, new Vector3(0, 0, 1))];
      // Cones stand on the surface and point into it.
      return patch.spread.map((p, k) => cone(p.clone(), patch.normals[k]!.clone().negate()));
    }
    const found: Arrow[] = [];
    const vector = (key: LoadKind) => { const v = numbers(item.keys[key]); return v && v.some((n) => n !== 0) ? this.toPart(new Vector3().fromArray(v)).normalize() : null; };
    const push = (at: Vector3, along: Vector3, length: number, normal: Vector3) => {
      const isPush = along.dot(normal) < -1e-6;
      found.push({ at: isPush ? at.clone().addScaledVector(along, -length) : at.clone(), along, length, colour: LOADED, heads: 1 });
    };
    const force = vector("force_n") ?? vector("bearing_n");
    if (force) push(middle, force, reach, patch?.normal ?? new Vector3());
    const gravity = vector("acceleration_mm_s2");
    if (gravity) push(view!.low.clone().add(view!.high).multiplyScalar(0.5).setZ(view!.high.z), gravity, reach, gravity.clone().negate());
    const pressure = item.keys.pressure_mpa;
    if (typeof pressure === "number" && pressure !== 0 && patch) patch.spread.forEach((p, k) => push(p, patch.normals[k]!.clone().multiplyScalar(-Math.sign(pressure)), 0.45 * reach, patch.normals[k]!));
    const moment = vector("moment_nmm");
    if (moment) found.push({ at: middle, along: moment, length: reach, colour: LOADED, heads: 2 });
    const torque = item.keys.torque_nmm;
    if (typeof torque === "number" && torque !== 0 && item.face >= 0) {
      const row = this.parts.shape.report!.faces[item.face]!;
      const axis = row.axis ?? row.normal;
      if (axis) found.push({ at: middle, along: new Vector3().fromArray(axis).multiplyScalar(Math.sign(torque)), length: reach, colour: LOADED, heads: 2 });
    }
    return found;
  }

  // ---- stress -----------------------------------------------------------------------------------------------------

  private async solve(): Promise<void> {
    const wanted = this.parts.job.wanted();
    const { view } = this.parts.shape;
    if (!wanted || !view) return;
    const text = this.parts.job.stressOf(this.text);
    const end = await this.parts.run({ kind: "stress", ...wanted });
    if (!end) return;
    try {
      const [result, bytes, nine] = await Promise.all([api.result(end.id), api.bytes(`v1/jobs/${end.id}/stress`), api.bytes(`v1/jobs/${end.id}/stress/0`)]);
      // Another part, or the answer to a later question, may have come meanwhile.
      if (this.parts.shape.view !== view || (this.stress && this.stress.id > end.id)) return;
      const shown = new StressView(bytes, () => { document.documentElement.dataset.stress = String(end.id); });
      shown.take(new Float32Array(nine));
      view.setStress(shown);
      this.stress = { view: shown, id: end.id, cases: result.cases ?? [], report: result.report.stress as api.StressReport, text, warnings: result.warnings, inside: new Inside(shown, end.id, view.low, view.high, this.parts) };
      this.wanted = 0;
      this.shown = { ...this.shown, case: 0, scale: null, magnified: 0, isOn: true };
      this.tell();
    } catch (error) {
      this.parts.say((error as Error).message, true);
    }
  }

  private async showCase(k: number): Promise<void> {
    const { stress } = this;
    if (!stress) return;
    this.wanted = k;
    try {
      const nine = await api.bytes(`v1/jobs/${stress.id}/stress/${k}`);
      if (this.stress !== stress || this.wanted !== k) return;
      stress.view.take(new Float32Array(nine));
      this.shown = { ...this.shown, case: k, scale: null };
      stress.inside.setCase(k);
      this.tellCase();
      this.draw();
      this.colour();
    } catch (error) {
      if (this.stress === stress && this.wanted === k) {
        // The case before it is still on screen.
        this.wanted = this.shown.case;
        const which = document.getElementById("case") as HTMLSelectElement | null;
        if (which) which.value = String(this.shown.case);
      }
      this.parts.say((error as Error).message, true);
    }
  }

  /** The greatest stress and displacement of the case that is shown. */
  private get peak(): api.CasePeak {
    const { report, cases } = this.stress!;
    const { max_von_mises_mpa, peak_at_mm, max_displacement_mm } = report;
    return report.peaks?.[this.shown.case] ?? { case: cases[0] ?? UNNAMED, max_von_mises_mpa, at_mm: peak_at_mm, max_displacement_mm };
  }

  private readonly facts = el("table", { id: "stress-facts" });

  /** Tells the numbers of the case that is shown, and how far its displacement is drawn. */
  private tellCase(): void {
    const { report, cases } = this.stress!;
    const { peak } = this;
    const fact = (name: string, words: string, id = "") => el("tr", {}, el("td", {}, name), el("td", { class: "n", ...(id ? { id } : {}) }, words));
    const several = cases.length > 1;
    const place = peak.at_mm?.map((v) => fixed(v, 1)).join(", ");
    const forces = (rows: api.Resultant[] | undefined) => (rows ?? []).filter((r) => !several || r.case === peak.case).map((r) => fact(r.name, `${alike(r.force_n, 2).join(", ")} N`));
    const isStrengthTold = report.reserve !== undefined && report.strength_mpa !== undefined && peak.max_von_mises_mpa > 0;
    this.facts.replaceChildren(
      fact(`Peak, von Mises${several ? `, of ${peak.case}` : ""}`, `${threeDigits(peak.max_von_mises_mpa)} MPa${place ? ` at ${place}` : ""}`, "peak-stress"),
      ...(several ? [fact("Peak of all cases", `${threeDigits(report.max_von_mises_mpa)} MPa`, "peak-of-all")] : []),
      ...(peak.max_displacement_mm === undefined ? [] : [fact("Largest displacement", `${threeDigits(peak.max_displacement_mm)} mm`, "peak-moved")]),
      ...(isStrengthTold ? [fact("Strength along the beads / peak", `${threeDigits(report.strength_mpa! / peak.max_von_mises_mpa)}`)] : []),
      ...(report.error_estimate === undefined ? [] : [fact(`Mesh error, estimated${several ? ", of the worst case" : ""}`, `${fixed(100 * report.error_estimate, 1)} % of the stress`)]),
      ...forces(report.loads), ...forces(report.reactions));
    document.getElementById("magnify")?.dispatchEvent(new Event("input"));
  }

  private tell(): void {
    const { cases, warnings, view, text } = this.stress!;
    const on = el("input", { type: "checkbox", id: "stress-on", checked: true, onchange: () => { this.shown.isOn = on.checked; this.parts.shape.view?.showStress(on.checked); this.legend(); this.draw(); } });
    const what = el("select", { id: "quantity", onchange: () => { this.shown = { ...this.shown, what: what.value as Quantity, scale: null }; this.colour(); } }, ...QUANTITIES.map(([key, words, unit]) => el("option", { value: key, selected: key === this.shown.what }, `${words}, ${unit}`)));
    const which = el("select", { id: "case", onchange: () => void this.showCase(Number(which.value)) }, ...cases.map((name, k) => el("option", { value: k }, name)));
    const end = (id: string, k: 0 | 1, label: string) => {
      const field = numberField({ id }, { isView: true }, (v) => {
        const scale: [number, number] = [...(this.shown.scale ?? [0, 1])];
        scale[k] = v;
        this.shown.scale = scale;
        this.colour();
      });
      return el("label", {}, label, field);
    };
    const { low, high } = this.parts.shape.view!;
    // At the end of the slider the largest displacement of the case is a tenth of the part.
    const most = () => (view.largestMove > 0 ? (0.1 * high.distanceTo(low)) / view.largestMove : 0);
    const slider = el("input", { type: "range", id: "magnify", min: 0, max: 1, step: 0.01, value: 0, "aria-label": "Displacement drawn", oninput: () => {
      const times = slider.valueAsNumber * most();
      view.setMagnified(times);
      words.textContent = `${plainNumber(Math.round(times))} times`;
      this.parts.viewer()?.draw();
    } });
    const words = el("output", {}, "0 times");
    // From rest to the displacement and back in two seconds, again and again until it is pressed once more.
    const swing = el("button", { type: "button", id: "swing", "aria-pressed": "false", "aria-label": "Let the displacement swing", onclick: () => {
      const isOn = swing.getAttribute("aria-pressed") !== "true";
      swing.setAttribute("aria-pressed", String(isOn));
      swing.textContent = isOn ? "⏸" : "▶";
      const begun = performance.now();
      const frame = (now: number) => {
        if (swing.getAttribute("aria-pressed") !== "true" || !swing.isConnected) return;
        slider.value = String(0.5 - 0.5 * Math.cos(((now - begun) / 1000) * Math.PI));
        slider.dispatchEvent(new Event("input"));
        requestAnimationFrame(frame);
      };
      if (isOn) requestAnimationFrame(frame);
    } }, "▶");
    this.answer.replaceChildren(
      // They may have changed while it was solved.
      el("p", { class: "warning", id: "stale", hidden: text === this.parts.job.stressOf(this.text) }, "The part, its material, fixtures, loads or elements have changed since; solve again."),
      this.facts,
      el("div", { class: "row" }, el("label", {}, "Colour by", what), ...(cases.length > 1 ? [el("label", {}, "Case", which)] : [])),
      el("div", { class: "row" }, end("scale-low", 0, "Scale from"), end("scale-high", 1, "to")),
      el("div", { class: "row" }, swing, el("label", {}, "Displacement drawn", slider), words),
      el("label", { for: "stress-on", class: "check" }, on, " show the stress on the part"),
      ...this.stress!.inside.fields(),
      ...warnings.map(warning),
    );
    this.tellCase();
    this.draw();
    this.colour();
  }

  /** Colours the part by what is chosen. */
  private colour(): void {
    if (!this.stress) return;
    const { proposed } = this.stress.view.colour(this.shown.what);
    const scale = (this.shown.scale ??= proposed);
    this.stress.view.setScale(...scale);
    const { id, cases } = this.stress;
    this.parts.pictured(`v1/jobs/${id}/stress/${this.shown.case}/picture`, `Von Mises stress of ${cases[this.shown.case] ?? "the loads"} from in front and from behind: blue 0, red the largest, ${threeDigits(this.peak.max_von_mises_mpa)} MPa.`);
    for (const [id, k] of [["scale-low", 0], ["scale-high", 1]] as const) {
      const input = document.getElementById(id) as HTMLInputElement | null;
      if (input) showValue(input, Number(scale[k].toPrecision(4)));
    }
    this.legend();
    this.parts.viewer()?.draw();
  }

  /** The scale of the colours, where the stress is on screen. */
  legend(): void {
    if (!this.isActive) return;
    const legend = document.getElementById("legend")!;
    const isShown = this.stress !== null && this.shown.isOn && this.shown.scale !== null;
    // The server's pictures have colours of their own.
    legend.hidden = !isShown || !this.parts.viewer();
    if (legend.hidden) return;
    const [, name, unit] = QUANTITIES.find(([key]) => key === this.shown.what)!;
    const bar = el("div", { class: "ramp" });
    bar.style.background = gradient(ramp);
    const words = (v: number) => `${Number(v.toPrecision(3))} ${unit}`;
    legend.replaceChildren(el("div", {}, name), bar, el("div", { class: "ends" }, ...this.shown.scale!.map((v) => el("span", {}, words(v)))));
  }

  /** What is under the pointer: the stress where it is on screen, otherwise the face. */
  wordsAt(face: number, at: { clientX: number; clientY: number }): string | null {
    const { view } = this.parts.shape;
    const viewer = this.parts.viewer();
    if (view?.isStressShown && viewer && this.stress) {
      const found = at.clientX < 0 ? null : this.stress.view.probe(viewer.rayAt(at.clientX, at.clientY));
      if (!found) return null;
      const [s, p] = [found.nine, principal(found.nine)];
      return `von Mises ${threeDigits(mises(s))} MPa · principal ${alike(p).join(", ")} MPa · xx yy zz xy yz zx ${alike(s.slice(0, 6)).join(", ")} · moved ${threeDigits(Math.hypot(s[6]!, s[7]!, s[8]!))} mm · at (${found.at.toArray().map((v) => fixed(v, 1)).join(", ")})`;
    }
    return face >= 0 ? this.parts.shape.words(face) : null;
  }
}

/** A plane of the text in words. */
const planeWords = (side: Value | undefined) => JSON.stringify(side).replaceAll('"', "").replace("point_mm", "point").replaceAll(",", ", ");

const vectorText = (v: number[]) => `[${v.map(plainNumber).join(", ")}]`;
