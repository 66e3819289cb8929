// What is said of the paths in view, and the keys that turn it: in the studio and in the viewer of notebooks.

import type { Index } from "./api";
import type { Bead } from "./beads";
import { CLASS_COLOURS, COLOUR_BY, PLAIN, SEAM, circle, css, gradient, ramp, type ColourBy, type Rgb } from "./colours";
import { el, fixed } from "./dom";
import type { Viewer } from "./viewer";

/** The ends of the scale of a way of colouring; `least` is the factor on the loads at first failure. */
export function scaleOf(index: Index, by: ColourBy, least = 1): [number, number] {
  const speeds = index.speeds_mm_s;
  switch (by) {
    case "speed": return speeds.length > 0 ? [Math.min(...speeds), Math.max(...speeds)] : [0, 1];
    case "width": return index.widths_mm;
    case "flow": return [0, index.flow_mm3_s];
    case "height": return [0, index.layers[index.layers.length - 1]!.z_mm];
    case "time": { const times = index.layers.map((l) => l.time_s ?? 0); return [Math.min(...times), Math.max(...times)]; }
    case "load": return [0, 90];
    // Of nearness to failing, so that the least reserve is bright: in doublings, from ten times the least on.
    case "reserve": return [-Math.log2(10 * least), -Math.log2(least)];
    case "role": case "angle": case "seam": return [0, 180];
  }
}

export function swatch(colour: Rgb): HTMLElement {
  const box = el("span", { class: "swatch" });
  box.style.background = css(colour);
  return box;
}

/** A factor on the loads. The bytes of the beads end at 416. */
export const times = (factor: number) => (factor > 400 ? "over 400 ×" : `${fixed(factor, factor < 1 ? 2 : factor < 10 ? 1 : 0)} ×`);

/** What the colours mean. */
export function legend(index: Index, by: ColourBy, least = 1): HTMLElement[] {
  if (by === "role") return index.shares.flatMap((share, k) => (share.beads > 0 ? [el("div", {}, swatch(CLASS_COLOURS[k]!), index.classes[k]!)] : []));
  if (by === "seam") {
    const n = index.layers.reduce((sum, layer) => sum + layer.seams, 0);
    return [el("div", {}, swatch(SEAM), `where a closed wall begins (${n})`), el("div", {}, swatch(PLAIN), "other beads")];
  }
  const bar = el("div", { class: "ramp" });
  bar.style.background = gradient(by === "angle" ? circle : ramp);
  const isAngle = by === "angle" || by === "load";
  const words = (value: number) => fixed(value, by === "width" ? 2 : isAngle ? 0 : 1) + (isAngle ? "°" : "");
  const ends = by === "reserve" ? [10, Math.sqrt(10), 1].map((k) => times(k * least)) : scaleOf(index, by).map(words);
  const plain = by === "load" ? "no direction asked for" : by === "reserve" ? "no part, or near fixtures and loads" : null;
  const name = COLOUR_BY.find(([k]) => k === by)![1];
  return [el("div", {}, name), bar, el("div", { class: "ends" }, ...ends.map((end) => el("span", {}, end))), ...(plain ? [el("div", {}, swatch(PLAIN), plain)] : [])];
}

/** The numbers of a bead. */
export function beadWords(index: Index, bead: Bead): string {
  return [
    index.classes[bead.kind]!, `layer ${bead.layer + 1}`, `${fixed(bead.width_mm, 2)} mm wide`, `${fixed(index.layers[bead.layer]!.height_mm, 2)} mm high`,
    ...(bead.isSeam ? ["seam"] : []), ...(bead.off_deg === null ? [] : [`${fixed(bead.off_deg, 1)}° off the load`]), ...(bead.reserve === null ? [] : [`fails at ${times(bead.reserve)} the load`]),
    `${fixed(bead.speed_mm_s, 1)} mm/s`, `${fixed(bead.flow_mm3_s, 1)} mm³/s`, `${fixed(bead.length_mm, 2)} mm long`, `${fixed(bead.angle_deg, 0)}°`, `at (${fixed(bead.b[0], 1)}, ${fixed(bead.b[1], 1)})`,
  ].join(" · ");
}

/** Number and height of a layer. */
export function wordsOfLayer(index: Index | undefined, k: number): string {
  const layer = index?.layers[k];
  return layer ? `${k + 1}\n${fixed(layer.z_mm, 2)} mm` : "";
}

/** Keys that turn the view, with shift move it, those that bring it nearer, and those of its directions. */
const KEYS: Record<string, (v: Viewer, isShifted: boolean) => void> = {
  a: (v, shift) => (shift ? v.pan(-0.1, 0) : v.turn(-15, 0)),
  d: (v, shift) => (shift ? v.pan(0.1, 0) : v.turn(15, 0)),
  w: (v, shift) => (shift ? v.pan(0, 0.1) : v.turn(0, 15)),
  s: (v, shift) => (shift ? v.pan(0, -0.1) : v.turn(0, -15)),
  "+": (v) => v.zoom(0.8),
  "=": (v) => v.zoom(0.8),
  "-": (v) => v.zoom(1.25),
  "1": (v) => v.view("top"),
  "2": (v) => v.view("front"),
  "3": (v) => v.view("side"),
  "4": (v) => v.view("oblique"),
};

/** Turns the view by a key; false where the key does something else. */
export function look(viewer: Viewer, event: KeyboardEvent): boolean {
  const step = KEYS[event.key.toLowerCase()];
  step?.(viewer, event.shiftKey);
  return step !== undefined;
}
