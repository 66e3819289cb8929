// The records of a program in the page: what the server sent, twelve bytes a segment.
//
// The server sends eight bytes a record (x, y, width, class and speed). Two more hold the layer, so that layers share a
// buffer; two hold the angle to the load, where the paths follow a guide, and the reserve, where one is told.

import type { Index } from "./api";
import { CLASS_COLOURS } from "./colours";

/** 16-bit numbers of a record in the page. */
export const WORDS = 6;
/** 16-bit numbers of a record on the wire. */
const WIRE_WORDS = 4;
/** The class of travels. Behind it come starts of layers, retractions, and places where filament is pushed again. */
export const TRAVEL = CLASS_COLOURS.length - 1;
/** Added to the class of the first bead of a closed wall. */
const SEAM = 128;
/** The angle or the reserve of a record that has none. */
export const NO_VALUE = 255;
/** The byte of a reserve of 1, and the steps while it doubles. Source: `records.rs` of the server. */
export const [RESERVE_OF_1, RESERVE_STEPS] = [80, 20];
/** Values that a bead may have besides its record: a byte each, in this order from the lowest. */
export type Value = "angles" | "reserve";

export interface Bead {
  record: number; layer: number; kind: number; a: [number, number]; b: [number, number]; width_mm: number; speed_mm_s: number; length_mm: number; angle_deg: number; flow_mm3_s: number;
  isSeam: boolean; off_deg: number | null; reserve: number | null;
}

export class Beads {
  /** The first record of each layer, and the number of all. */
  readonly first: Int32Array;
  readonly words: Uint16Array<ArrayBuffer>;
  /** Number of layers from the plate up that have come. */
  taken = 0;

  constructor(readonly index: Index) {
    this.first = new Int32Array(index.layers.length + 1);
    index.layers.forEach((layer, k) => (this.first[k + 1] = this.first[k]! + layer.records));
    this.words = new Uint16Array(WORDS * this.first[index.layers.length]!);
    // What has not come yet draws nothing.
    for (let at = 0; at < this.words.length; at += WORDS) { this.words[at + 3] = this.start; this.words[at + 5] = 0xffff; }
  }

  get travel(): number { return TRAVEL; }
  get start(): number { return TRAVEL + 1; }

  /** Takes layers `from` to `to`, both included, as the server sent them. */
  take(from: number, to: number, bytes: ArrayBuffer): void {
    const wire = new Uint16Array(bytes);
    const [first, end] = [this.first[from]!, this.first[to + 1]!];
    if (wire.length !== WIRE_WORDS * (end - first)) throw new Error(`layers ${from} to ${to} have another length than the index says`);
    for (let layer = from; layer <= to; layer++) {
      for (let record = this.first[layer]!; record < this.first[layer + 1]!; record++) {
        const [source, target] = [WIRE_WORDS * (record - first), WORDS * record];
        this.words[target] = wire[source]!;
        this.words[target + 1] = wire[source + 1]!;
        this.words[target + 2] = wire[source + 2]!;
        this.words[target + 3] = wire[source + 3]!;
        this.words[target + 4] = layer;
      }
    }
    if (from <= this.taken) this.taken = Math.max(this.taken, to + 1);
  }

  /** Takes the layers that came for the first part of the same program, and returns their number. */
  keep(before: Beads): number {
    const [a, b] = [before.index, this.index];
    if (a.step_mm !== b.step_mm || a.origin_mm.some((v, k) => v !== b.origin_mm[k]) || a.speeds_mm_s.some((v, k) => v !== b.speeds_mm_s[k])) return 0;
    let n = 0;
    while (n < before.taken && n < b.layers.length && before.first[n + 1] === this.first[n + 1]) n++;
    this.words.set(before.words.subarray(0, WORDS * this.first[n]!));
    return (this.taken = n);
  }

  /** Takes the angles to the load, or the reserves, of layers `from` to `to`: a byte a record. */
  takeValues(what: Value, from: number, to: number, bytes: ArrayBuffer): void {
    const values = new Uint8Array(bytes);
    const [first, end] = [this.first[from]!, this.first[to + 1]!];
    if (values.length !== end - first) throw new Error(`${what} of layers ${from} to ${to} have another length than the index says`);
    const [kept, shift] = what === "angles" ? [0xff00, 0] : [0xff, 8];
    for (let record = first; record < end; record++) {
      const at = WORDS * record + 5;
      this.words[at] = (this.words[at]! & kept) | (values[record - first]! << shift);
    }
  }

  point(record: number): [number, number] {
    const at = WORDS * record;
    const { origin_mm: o, step_mm: s } = this.index;
    return [o[0] + s * this.words[at]!, o[1] + s * this.words[at + 1]!];
  }

  /** What there is to say of a record: the bead from the point before it. */
  bead(record: number): Bead {
    const at = WORDS * record;
    const [a, b] = [this.point(record - 1), this.point(record)];
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const layer = this.words[at + 4]!;
    const width_mm = this.words[at + 2]! * 1e-3;
    const kind = this.words[at + 3]! & (SEAM - 1);
    const isSeam = (this.words[at + 3]! & SEAM) !== 0;
    const [halves, reserve] = [this.words[at + 5]! & 0xff, this.words[at + 5]! >> 8];
    const speed_mm_s = this.index.speeds_mm_s[this.words[at + 3]! >> 8] ?? 0;
    const h = this.index.layers[layer]!.height_mm;
    let angle_deg = (Math.atan2(dy, dx) * 180) / Math.PI;
    if (angle_deg < 0) angle_deg += 180;
    if (angle_deg >= 179.95) angle_deg = 0;
    // The section of a stadium.
    const area = h * (width_mm - h * (1 - Math.PI / 4));
    return { record, layer, kind, a, b, width_mm, speed_mm_s, length_mm: Math.hypot(dx, dy), angle_deg, flow_mm3_s: Math.max(area, 0) * speed_mm_s, isSeam, off_deg: halves === NO_VALUE ? null : halves / 2, reserve: reserve === NO_VALUE ? null : 2 ** ((reserve - RESERVE_OF_1) / RESERVE_STEPS) };
  }

  /** The bead of a layer under a point, among records `from` to `to`; the last one printed lies on top. */
  under(layer: number, x: number, y: number, from: number, to: number, shown: (kind: number) => boolean): number {
    const { origin_mm: o, step_mm: s } = this.index;
    const [px, py] = [(x - o[0]) / s, (y - o[1]) / s];
    const low = Math.max(this.first[layer]! + 1, from);
    for (let record = Math.min(this.first[layer + 1]! - 1, to); record >= low; record--) {
      const at = WORDS * record;
      const kind = this.words[at + 3]! & (SEAM - 1);
      if (kind >= this.travel || !shown(kind)) continue;
      const r = (this.words[at + 2]! * 5e-4) / s;
      const [ax, ay, bx, by] = [this.words[at - WORDS]!, this.words[at - WORDS + 1]!, this.words[at]!, this.words[at + 1]!];
      if (px < Math.min(ax, bx) - r || px > Math.max(ax, bx) + r || py < Math.min(ay, by) - r || py > Math.max(ay, by) + r) continue;
      const [dx, dy] = [bx - ax, by - ay];
      const t = Math.min(Math.max(((px - ax) * dx + (py - ay) * dy) / Math.max(dx * dx + dy * dy, 1e-9), 0), 1);
      if (Math.hypot(px - ax - t * dx, py - ay - t * dy) <= r) return record;
    }
    return -1;
  }
}
