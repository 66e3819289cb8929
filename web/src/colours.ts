// Colours of beads. The same tables fill the textures of the graphics card and the legend.

export type ColourBy = "role" | "speed" | "width" | "angle" | "flow" | "height" | "time" | "seam" | "load" | "reserve";
/** How what broke is shown: elements by the share of stiffness lost or by the order of breaking, or beads by that order. */
export type CrackBy = "lost" | "order" | "beads";
export const COLOUR_BY: [ColourBy, string][] = [
  ["role", "Role"], ["speed", "Speed, mm/s"], ["width", "Width, mm"], ["angle", "Angle in the plane"], ["flow", "Flow, mm³/s"], ["height", "Height, mm"],
  ["time", "Layer time, s"], ["seam", "Seams"], ["load", "Angle off the load"], ["reserve", "Reserve, times the load"],
];

export type Rgb = [number, number, number];

/** Beads without a value of their own: those that are no seam, on which the guide asks for no direction, or that do not fail. */
export const PLAIN: Rgb = [184, 191, 196];
/** Where a closed wall begins. */
export const SEAM: Rgb = [208, 31, 60];

/** Colours of the classes, in the order of the server's roles; then travels. Walls are warm, fill is blue and green, what is no part of the part is grey. */
export const CLASS_COLOURS: Rgb[] = [
  [214, 93, 32], // outer wall
  [240, 163, 74], // inner wall
  [197, 60, 103], // thin wall
  [156, 79, 160], // gap fill
  [42, 116, 178], // solid fill
  [27, 79, 138], // top skin
  [86, 178, 171], // sparse fill
  [30, 30, 30], // fibre
  [110, 150, 50], // bridge
  [150, 150, 150], // skirt
  [125, 125, 125], // brim
  [185, 185, 150], // support
  [160, 160, 110], // interface of the support
  [16, 44, 84], // seed line
  [120, 130, 140], // travel
];

/** Colours of the marks of retractions, and of the places where filament is pushed again. */
export const MARK_COLOURS: Rgb[] = [[206, 0, 160], [0, 146, 70]];

/** The published colour map viridis, at nine places. */
const VIRIDIS: Rgb[] = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [110, 206, 88], [253, 231, 37],
];

/** A colour of the ramp, 0 to 1. */
export function ramp(t: number): Rgb {
  const at = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const [a, b] = [VIRIDIS[k]!, VIRIDIS[k + 1]!];
  return [0, 1, 2].map((c) => Math.round(a[c]! + (b[c]! - a[c]!) * (at - k))) as Rgb;
}

/** A colour of the circle of directions, 0 to 1: the ends are the same direction. */
export function circle(t: number): Rgb {
  const channel = (shift: number) => Math.round(140 + 105 * Math.cos(2 * Math.PI * (t - shift)));
  return [channel(0), channel(1 / 3), channel(2 / 3)];
}

export const css = (c: Rgb) => `rgb(${c[0]} ${c[1]} ${c[2]})`;

/** 256 colours for a texture. */
export function table(colour: (t: number) => Rgb): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; k++) bytes.set([...colour(k / 255), 255], 4 * k);
  return bytes;
}

/** A background for the legend. */
export function gradient(colour: (t: number) => Rgb): string {
  const stops = Array.from({ length: 17 }, (_, k) => css(colour(k / 16)));
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
