// The part on the screen: its surface with faces, defects, arrows of fixtures and loads, and the stress on it.
//
// Triangles are drawn with the normal of the screen's derivatives, so that sharp edges stay sharp without split vertices.
// Each triangle carries the number of its face; a texture holds the colour of each face, so that choosing one uploads four
// bytes and not the mesh.

import { BufferAttribute, BufferGeometry, CylinderGeometry, ConeGeometry, DataTexture, DoubleSide, GLSL3, GreaterDepth, Group, InstancedBufferGeometry, InstancedInterleavedBuffer, InterleavedBufferAttribute, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, NearestFilter, Points, Quaternion, RGBAFormat, ShaderMaterial, Vector2, Vector3, Vector4, type Ray } from "three";
import { ramp, table, type Rgb } from "./colours";
import { degenerate, type Degenerate } from "./degenerate";
import { Search, type Hit } from "./search";

/** Colours of faces: plain, chosen, held, loaded. Told apart by brightness too. */
export const FACE: Rgb = [178, 188, 196];
export const CHOSEN: Rgb = [245, 196, 66];
export const HELD: Rgb = [70, 130, 190];
export const LOADED: Rgb = [226, 120, 58];
/** Facets that are always or never held by supports. */
export const ENFORCED: Rgb = [60, 150, 80];
export const BLOCKED: Rgb = [190, 60, 120];
/** An edge is smooth where the normals of its triangles are within 20 degrees. Source: chosen; a quarter round of five sides has 18, and bevels are 30 and more. */
const SMOOTH_COS = Math.cos((20 * Math.PI) / 180);
/** Numbers of a branch of a support. */
const BRANCH = 10;
/** Parts of faces that are drawn in a colour of their own. Source: chosen; a job with more shows the first ones. */
const CUTS = 16;
/** Faces in a row of the texture. */
const ROW = 1024;

const [ENFORCED_TEXT, BLOCKED_TEXT] = [ENFORCED, BLOCKED].map((colour) => `${colour.join(".0, ")}.0`);
/** Faces are lit from the eye, a little from above; `out` the world's place for the normal. */
const VERTEX = `
in float face; in float paint; out vec3 at; out vec3 rest; flat out int number; flat out int painted;
void main() { number = int(face + 0.5); painted = int(paint + 0.5); rest = position; vec4 eye = modelViewMatrix * vec4(position, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`;
const LIGHT = `vec3 n = normalize(cross(dFdx(at), dFdy(at))); if (dot(n, at) > 0.0) n = -n; float lit = max(dot(n, normalize(vec3(0.25, 0.45, 0.86))), 0.0);`;
const FRAGMENT = `
in vec3 at; in vec3 rest; flat in int number; flat in int painted; out vec4 result; uniform sampler2D faces; uniform int hovered;
uniform int cuts; uniform int cutFace[${CUTS}]; uniform vec4 cutPlane[${CUTS}]; uniform vec3 cutColour[${CUTS}];
void main() {
  ${LIGHT}
  vec3 colour = texelFetch(faces, ivec2(number % ${ROW}, number / ${ROW}), 0).rgb;
  for (int k = 0; k < cuts; k++) if (number == cutFace[k] && dot(cutPlane[k].xyz, rest) >= cutPlane[k].w) colour = cutColour[k] / 255.0;
  if (painted == 1) colour = vec3(${ENFORCED_TEXT}) / 255.0;
  if (painted == 2) colour = vec3(${BLOCKED_TEXT}) / 255.0;
  if (number == hovered) colour = mix(colour, vec3(1.0, 0.97, 0.62), 0.55);
  result = vec4(colour * (0.5 + 0.55 * lit), 1.0);
}`;
const STRESS_VERTEX = `
in float value; in vec3 moved; uniform float magnify; out vec3 at; out vec3 rest; out float v;
void main() { v = value; rest = position; vec4 eye = modelViewMatrix * vec4(position + magnify * moved, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`;
const STRESS_FRAGMENT = `
in vec3 at; in vec3 rest; in float v; out vec4 result; uniform sampler2D colours; uniform vec2 scale; uniform vec4 clip; uniform float opacity;
void main() {
  if (dot(clip.xyz, rest) > clip.w) discard;
  ${LIGHT}
  float t = clamp((v - scale.x) / max(scale.y - scale.x, 1e-12), 0.0, 1.0);
  result = vec4(texture(colours, vec2(t * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb * (0.82 + 0.18 * lit), opacity);
}`;
/** Colours of principal lines. */
export const TENSION: Rgb = [200, 30, 40];
export const COMPRESSION: Rgb = [30, 70, 205];
/** Edges that are faulty in the file, and those that mending leaves. */
export const FAULT: Rgb = [214, 120, 0];
export const LEFT: Rgb = [208, 31, 60];
/** Width of a principal line, of a fault of the file and of one that is left, pixels. */
const LINE_PX = 2.5;
const FAULT_PX = 3;
const LEFT_PX = 4;
/** Each segment is a strip of the screen between its two ends. */
const LINES_VERTEX = `
in vec4 a; in vec4 b; uniform vec2 pixels; uniform float wide; out vec3 rest; out float v;
void main() {
  vec4 here = position.x < 0.5 ? a : b; rest = here.xyz; v = here.w;
  vec4 p = projectionMatrix * modelViewMatrix * vec4(a.xyz, 1.0); vec4 q = projectionMatrix * modelViewMatrix * vec4(b.xyz, 1.0);
  vec2 along = (q.xy / q.w - p.xy / p.w) * pixels; along /= max(length(along), 1e-6);
  vec4 end = position.x < 0.5 ? p : q;
  gl_Position = end + vec4(vec2(-along.y, along.x) * position.y * wide / pixels * end.w, 0.0, 0.0);
}`;
const LINES_FRAGMENT = `
in vec3 rest; in float v; out vec4 result; uniform vec4 clip;
void main() { if (dot(clip.xyz, rest) > clip.w) discard; result = vec4(v > 0.0 ? vec3(${TENSION.join(".0, ")}.0) / 255.0 : vec3(${COMPRESSION.join(".0, ")}.0) / 255.0, 1.0); }`;
/** Degenerate points: wedges and trisectors, and their width in pixels. */
export const WEDGE: Rgb = [20, 20, 20];
export const TRISECTOR: Rgb = [255, 255, 255];
const POINT_PX = 11;
/** How much of the surface is left over the lines in it. */
const GHOST = 0.16;

export interface Surface { points: Float32Array; corners: Uint32Array; face: Uint32Array; faulty: Float32Array; borders: Uint32Array; faults: Float32Array }

/** Lays arrays over the bytes of a surface. */
export function surfaceOf(bytes: ArrayBuffer): Surface {
  const [n, m, f, b, g] = new Uint32Array(bytes, 0, 5) as unknown as [number, number, number, number, number];
  let at = 20;
  const take = <T>(make: new (buffer: ArrayBuffer, at: number, n: number) => T, count: number): T => { const made = new make(bytes, at, count); at += 4 * count; return made; };
  return { points: take(Float32Array, 3 * n), corners: take(Uint32Array, 3 * m), face: take(Uint32Array, m), faulty: take(Float32Array, 6 * f), borders: take(Uint32Array, 2 * b), faults: take(Float32Array, 6 * g) };
}

/** The side of a plane to which its normal points: the part of a face there. */
export interface Side { point: Vector3; normal: Vector3 }

/** What lies of a triangle on the side of a plane, as triangles. */
function clipped(corners: Vector3[], { point, normal }: Side): Vector3[][] {
  const above = corners.map((p) => p.clone().sub(point).dot(normal));
  const kept: Vector3[] = [];
  corners.forEach((p, k) => {
    const next = (k + 1) % 3;
    if (above[k]! >= 0) kept.push(p);
    if (above[k]! * above[next]! < 0) kept.push(p.clone().lerp(corners[next]!, above[k]! / (above[k]! - above[next]!)));
  });
  return kept.slice(2).map((p, k) => [kept[0]!, kept[k + 1]!, p]);
}

/** What a face of the mesh is made of: its area, the middle of it, its mean normal, and points spread over it. */
export interface Patch { area: number; middle: Vector3; normal: Vector3; spread: Vector3[]; normals: Vector3[] }

export interface Arrow { at: Vector3; along: Vector3; length: number; colour: Rgb; heads: 1 | 2; isCone?: boolean }

export type Quantity = "mises" | "first" | "third" | "moved";
export const QUANTITIES: [Quantity, string, string][] = [["mises", "von Mises stress", "MPa"], ["first", "greatest principal stress", "MPa"], ["third", "smallest principal stress", "MPa"], ["moved", "displacement", "mm"]];

/** Principal values of a stress xx, yy, zz, xy, yz, zx, greatest first, in closed form by the angle of the deviator. */
export function principal(s: ArrayLike<number>, k = 0): [number, number, number] {
  const [xx, yy, zz, xy, yz, zx] = [s[k]!, s[k + 1]!, s[k + 2]!, s[k + 3]!, s[k + 4]!, s[k + 5]!];
  const mean = (xx + yy + zz) / 3;
  const [a, b, c] = [xx - mean, yy - mean, zz - mean];
  const p = Math.sqrt((a * a + b * b + c * c + 2 * (xy * xy + yz * yz + zx * zx)) / 6);
  if (p < 1e-30) return [mean, mean, mean];
  const half = (a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx)) / (2 * p * p * p);
  const angle = Math.acos(Math.min(Math.max(half, -1), 1)) / 3;
  const first = mean + 2 * p * Math.cos(angle);
  const third = mean + 2 * p * Math.cos(angle + (2 * Math.PI) / 3);
  return [first, 3 * mean - first - third, third];
}

export function mises(s: ArrayLike<number>, k = 0): number {
  const [xx, yy, zz, xy, yz, zx] = [s[k]!, s[k + 1]!, s[k + 2]!, s[k + 3]!, s[k + 4]!, s[k + 5]!];
  return Math.sqrt(Math.max(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy * xy + yz * yz + zx * zx), 0));
}

function quantity(what: Quantity, nine: Float32Array, k: number): number {
  switch (what) {
    case "mises": return mises(nine, k);
    case "first": return principal(nine, k)[0];
    case "third": return principal(nine, k)[2];
    case "moved": return Math.hypot(nine[k + 6]!, nine[k + 7]!, nine[k + 8]!);
  }
}

/** Share of the points whose stress the scale covers: the stress at a re-entrant corner has no bound, and its peak would leave one colour for all other places. Source: the scale of `stress.png`. */
const COVERED = 0.995;

/** The stress of a job on its surface. */
export class StressView {
  readonly group = new Group();
  private readonly mesh: Mesh;
  private section: { mesh: Mesh; nine: Float32Array; corners: Uint32Array; search: Search } | null = null;
  private lines: Mesh<InstancedBufferGeometry, ShaderMaterial> | null = null;
  private degeneratePoints: Points<BufferGeometry, ShaderMaterial> | null = null;
  private what: Quantity = "mises";
  private readonly material: ShaderMaterial;
  readonly search: Search;
  nine: Float32Array = new Float32Array(0);
  private readonly points: Float32Array;
  readonly corners: Uint32Array;

  constructor(bytes: ArrayBuffer, then: () => void) {
    const [n, m] = new Uint32Array(bytes, 0, 2) as unknown as [number, number];
    this.points = new Float32Array(bytes, 8, 3 * n);
    this.corners = new Uint32Array(bytes, 8 + 12 * n, 3 * m);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(this.points, 3));
    geometry.setAttribute("value", new BufferAttribute(new Float32Array(n), 1));
    geometry.setAttribute("moved", new BufferAttribute(new Float32Array(3 * n), 3));
    geometry.setIndex(new BufferAttribute(this.corners, 1));
    const colours = new DataTexture(table(ramp), 256, 1, RGBAFormat);
    colours.minFilter = colours.magFilter = NearestFilter;
    colours.needsUpdate = true;
    this.material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: STRESS_VERTEX, fragmentShader: STRESS_FRAGMENT, side: DoubleSide, uniforms: { colours: { value: colours }, scale: { value: new Vector2(0, 1) }, magnify: { value: 0 }, clip: { value: new Vector4(0, 0, 0, 1) }, opacity: { value: 1 } } });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.group.add(this.mesh);
    this.search = new Search(this.points, this.corners, then);
  }

  /** Shows a section at a place on an axis and takes away the half before it; null shows the whole part. */
  setSection(bytes: ArrayBuffer | null, axis: number, at: number, isLowKept: boolean): void {
    if (this.section) { this.group.remove(this.section.mesh); this.section.mesh.geometry.dispose(); (this.section.mesh.material as ShaderMaterial).dispose(); this.section = null; }
    const clip = this.material.uniforms.clip!.value as Vector4;
    clip.set(0, 0, 0, 1);
    if (!bytes) return;
    clip.setComponent(axis, isLowKept ? 1 : -1).setW(isLowKept ? at : -at);
    const [n, m] = new Uint32Array(bytes, 0, 2) as unknown as [number, number];
    const points = new Float32Array(bytes, 8, 3 * n);
    const corners = new Uint32Array(bytes, 8 + 12 * n, 3 * m);
    const nine = new Float32Array(bytes, 8 + 12 * n + 12 * m, 9 * n);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(points, 3));
    geometry.setAttribute("value", new BufferAttribute(new Float32Array(n), 1));
    geometry.setAttribute("moved", new BufferAttribute(Float32Array.from({ length: 3 * n }, (_, k) => nine[9 * Math.floor(k / 3) + 6 + (k % 3)]!), 3));
    geometry.setIndex(new BufferAttribute(corners, 1));
    const whole = { clip: { value: new Vector4(0, 0, 0, 1) }, opacity: { value: 1 } };
    const mesh = new Mesh(geometry, new ShaderMaterial({ glslVersion: GLSL3, vertexShader: STRESS_VERTEX, fragmentShader: STRESS_FRAGMENT, side: DoubleSide, uniforms: { ...this.material.uniforms, ...whole } }));
    mesh.frustumCulled = false;
    this.group.add(mesh);
    this.section = { mesh, nine, corners, search: new Search(points, corners, () => {}) };
    this.values(mesh, nine);
  }

  get hasLines(): boolean { return this.lines !== null; }

  /** Shows principal lines, and the surface as a veil over them; null shows the surface alone. */
  setLines(bytes: ArrayBuffer | null): void {
    if (this.lines) { this.group.remove(this.lines); this.lines.geometry.dispose(); this.lines.material.dispose(); this.lines = null; }
    const count = bytes ? new Uint32Array(bytes, 0, 1)[0]! : 0;
    this.material.uniforms.opacity!.value = count > 0 ? GHOST : 1;
    this.material.transparent = count > 0;
    this.material.depthWrite = count === 0;
    if (!bytes || count === 0) return;
    const lengths = new Uint32Array(bytes, 4, count);
    const points = new Float32Array(bytes, 4 + 4 * count);
    const ends: number[] = [];
    let from = 0;
    for (const length of lengths) {
      for (let k = from; k + 1 < from + length; k++) ends.push(...points.subarray(4 * k, 4 * k + 8));
      from += length;
    }
    this.lines = strips(new Float32Array(ends), LINE_PX, LINES_FRAGMENT, { clip: this.material.uniforms.clip! });
    this.group.add(this.lines);
  }

  /** Shows the degenerate points of the case that is shown, whose stress reaches `end`; null takes them away. */
  setDegenerate(end: number | null): Degenerate[] {
    if (this.degeneratePoints) { this.group.remove(this.degeneratePoints); this.degeneratePoints.geometry.dispose(); this.degeneratePoints.material.dispose(); this.degeneratePoints = null; }
    if (end === null) return [];
    const found = degenerate(this.points, this.corners, this.nine, end);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(found.flatMap((d) => d.at)), 3));
    geometry.setAttribute("wedge", new BufferAttribute(Float32Array.from(found, (d) => Number(d.isWedge)), 1));
    const colour = (c: Rgb) => `vec3(${c.join(".0, ")}.0) / 255.0`;
    const material = new ShaderMaterial({
      glslVersion: GLSL3, uniforms: { clip: this.material.uniforms.clip!, size: { value: POINT_PX } },
      // A little nearer to the eye than the surface on which they lie.
      vertexShader: `in float wedge; uniform float size; out float kind; out vec3 rest; void main() { kind = wedge; rest = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_Position.z -= 1e-4 * gl_Position.w; gl_PointSize = size; }`,
      fragmentShader: `in float kind; in vec3 rest; uniform vec4 clip; out vec4 result; void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5 || dot(clip.xyz, rest) > clip.w) discard; vec3 inner = kind > 0.5 ? ${colour(WEDGE)} : ${colour(TRISECTOR)}; result = vec4(r > 0.36 ? 1.0 - inner : inner, 1.0); }`,
    });
    this.degeneratePoints = new Points(geometry, material);
    this.degeneratePoints.frustumCulled = false;
    this.degeneratePoints.renderOrder = 3;
    this.group.add(this.degeneratePoints);
    return found;
  }

  /** Gives the points of a mesh the values of the quantity that is shown. */
  private values(mesh: Mesh, nine: Float32Array): Float32Array {
    const value = mesh.geometry.getAttribute("value") as BufferAttribute;
    const all = value.array as Float32Array;
    for (let k = 0; k < all.length; k++) all[k] = quantity(this.what, nine, 9 * k);
    value.needsUpdate = true;
    return all;
  }

  /** Takes the values of a case, nine a point. */
  take(nine: Float32Array): void {
    this.nine = nine;
    const moved = this.mesh.geometry.getAttribute("moved") as BufferAttribute;
    for (let k = 0; k < nine.length / 9; k++) moved.setXYZ(k, nine[9 * k + 6]!, nine[9 * k + 7]!, nine[9 * k + 8]!);
    moved.needsUpdate = true;
  }

  /** Colours by a quantity; gives the range of its values, and the one proposed for the scale. */
  colour(what: Quantity): { low: number; high: number; proposed: [number, number] } {
    this.what = what;
    const all = this.values(this.mesh, this.nine);
    if (this.section) this.values(this.section.mesh, this.section.nine);
    const sorted = all.slice().sort();
    const at = (share: number) => sorted[Math.min(Math.floor(share * sorted.length), sorted.length - 1)] ?? 0;
    const isSigned = what === "first" || what === "third";
    const proposed: [number, number] = what === "moved" ? [0, at(1)] : [isSigned ? Math.min(at(1 - COVERED), 0) : 0, at(COVERED)];
    if (what === "third") proposed[1] = Math.max(at(COVERED), 0);
    return { low: sorted[0] ?? 0, high: at(1), proposed };
  }

  /** The von Mises stress that the scale ends at. */
  get misesEnd(): number {
    const all = Float32Array.from({ length: this.nine.length / 9 }, (_, k) => mises(this.nine, 9 * k)).sort();
    return all[Math.min(Math.floor(COVERED * all.length), all.length - 1)] ?? 0;
  }

  setScale(low: number, high: number): void { (this.material.uniforms.scale!.value as Vector2).set(low, high); }
  setMagnified(by: number): void { this.material.uniforms.magnify!.value = by; }

  /** Largest displacement, mm. */
  get largestMove(): number {
    let most = 0;
    for (let k = 0; k < this.nine.length; k += 9) most = Math.max(most, Math.hypot(this.nine[k + 6]!, this.nine[k + 7]!, this.nine[k + 8]!));
    return most;
  }

  /** The values at the point of the surface or of the section that a ray meets: nine, and where. The part at rest is asked. */
  probe(ray: Ray): { at: Vector3; nine: number[] } | null {
    const clip = this.material.uniforms.clip!.value as Vector4;
    const normal = new Vector3(clip.x, clip.y, clip.z);
    const before = normal.dot(ray.origin) - clip.w;
    let hit: Hit | null = null;
    let from: { search: Search; nine: Float32Array; corners: Uint32Array } = this;
    if (this.section && before > 0) {
      // The ray begins in the half that is taken away: at the section it comes in.
      const t = -before / normal.dot(ray.direction);
      if (!(t > 0)) return null;
      hit = this.section.search.first(ray);
      if (hit) from = this.section;
      else ray = ray.clone().recast(t);
    }
    hit ??= this.search.first(ray);
    if (!hit || normal.dot(hit.point) > clip.w + 1e-3) return null;
    const { search, nine, corners } = from;
    const shares = search.shares(hit.triangle, hit.point);
    const triangle = hit.triangle;
    return { at: hit.point, nine: Array.from({ length: 9 }, (_, c) => shares.reduce((sum, share, k) => sum + share * nine[9 * corners[3 * triangle + k]! + c]!, 0)) };
  }

  dispose(): void { this.setSection(null, 0, 0, true); this.setLines(null); this.setDegenerate(null); (this.material.uniforms.colours!.value as DataTexture).dispose(); this.material.dispose(); this.mesh.geometry.dispose(); }
}

export class PartView {
  readonly group = new Group();
  readonly low = new Vector3(Infinity, Infinity, Infinity);
  readonly high = new Vector3(-Infinity, -Infinity, -Infinity);
  readonly faces: number;
  readonly search: Search;
  private readonly mesh: Mesh;
  private readonly borders: LineSegments;
  /** Faults of the file, and above them those that mending leaves. */
  private readonly faults: Mesh<InstancedBufferGeometry, ShaderMaterial>[];
  private readonly marks = new Group();
  private readonly material: ShaderMaterial;
  private readonly colours: DataTexture;
  private readonly patches = new Map<number, Patch>();
  private readonly trianglesOf: Uint32Array[] = [];
  /** Faces on both sides of each border, and whether the edge is smooth. */
  private pairs: [number, number, boolean][] | null = null;
  private stressed: StressView | null = null;
  /** Of each corner of the triangles: 1 where it is always supported, 2 where never. */
  private readonly paintOf: BufferAttribute;
  private readonly branches = new Group();
  private branchRows: Float32Array = new Float32Array(0);

  constructor(readonly surface: Surface, then: () => void) {
    const { points, corners, face, faulty, borders, faults } = surface;
    const n = corners.length / 3;
    const flat = new Float32Array(9 * n);
    const numbers = new Float32Array(3 * n);
    let most = -1;
    for (let t = 0; t < n; t++) {
      const f = face[t]! === 0xffffffff ? -1 : face[t]!;
      most = Math.max(most, f);
      for (let k = 0; k < 3; k++) {
        const from = 3 * corners[3 * t + k]!;
        for (let c = 0; c < 3; c++) flat[9 * t + 3 * k + c] = points[from + c]!;
      }
    }
    this.faces = most + 1;
    // Triangles of no face are drawn in the colour behind the last one.
    for (let t = 0; t < n; t++) numbers.fill(face[t]! === 0xffffffff ? this.faces : face[t]!, 3 * t, 3 * t + 3);
    for (let k = 0; k < points.length; k += 3) {
      this.low.min(new Vector3(points[k], points[k + 1], points[k + 2]));
      this.high.max(new Vector3(points[k], points[k + 1], points[k + 2]));
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(flat, 3));
    geometry.setAttribute("face", new BufferAttribute(numbers, 1));
    this.paintOf = new BufferAttribute(new Uint8Array(3 * n), 1);
    geometry.setAttribute("paint", this.paintOf);
    const rows = Math.ceil((this.faces + 1) / ROW);
    this.colours = new DataTexture(new Uint8Array(4 * ROW * rows), ROW, rows, RGBAFormat);
    this.colours.minFilter = this.colours.magFilter = NearestFilter;
    this.material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, uniforms: {
      faces: { value: this.colours }, hovered: { value: -1 },
      cuts: { value: 0 }, cutFace: { value: new Array(CUTS).fill(-1) }, cutPlane: { value: Array.from({ length: CUTS }, () => new Vector4()) }, cutColour: { value: Array.from({ length: CUTS }, () => new Vector3()) },
    } });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.borders = lines(Float32Array.from({ length: 3 * borders.length }, (_, k) => points[3 * borders[Math.floor(k / 3)]! + (k % 3)]!), 0x3c464d, 0.75);
    this.faults = [marked(faults, FAULT_PX, FAULT, 1), marked(faulty, LEFT_PX, LEFT, 2)];
    this.group.add(this.mesh, this.borders, ...this.faults, this.marks, this.branches);
    this.paint(new Map());
    this.search = new Search(points, corners, then);
  }

  /** Colours faces; those not named are plain. */
  paint(colours: Map<number, Rgb>): void {
    const bytes = this.colours.image.data as Uint8Array;
    for (let f = 0; f <= this.faces; f++) bytes.set([...(colours.get(f) ?? FACE), 255], 4 * f);
    this.colours.needsUpdate = true;
  }

  /** Colours parts of faces. */
  paintParts(parts: { face: number; side: Side; colour: Rgb }[]): void {
    const u = this.material.uniforms;
    u.cuts!.value = Math.min(parts.length, CUTS);
    parts.slice(0, CUTS).forEach(({ face, side, colour }, k) => {
      (u.cutFace!.value as number[])[k] = face;
      (u.cutPlane!.value as Vector4[])[k]!.set(side.normal.x, side.normal.y, side.normal.z, side.normal.dot(side.point));
      (u.cutColour!.value as Vector3[])[k]!.fromArray(colour);
    });
  }

  /** The point at which a ray meets the part, the face there, and its outward normal; null beside the part. */
  pointAt(ray: Ray): { face: number; point: Vector3; normal: Vector3 } | null {
    const hit = this.search.first(ray);
    if (!hit) return null;
    const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromArray(this.surface.points, 3 * this.surface.corners[3 * hit.triangle + k]!)) as [Vector3, Vector3, Vector3];
    return { face: this.surface.face[hit.triangle]!, point: hit.point.clone(), normal: b.sub(a).cross(c.sub(a)).normalize() };
  }

  set hovered(face: number) { this.material.uniforms.hovered!.value = face; }
  get hovered(): number { return this.material.uniforms.hovered!.value as number; }

  /** The face that a ray meets first; -1 for none, or for a triangle without one. */
  faceAt(ray: Ray): number {
    const hit = this.search.first(ray);
    const face = hit ? this.surface.face[hit.triangle]! : 0xffffffff;
    return face === 0xffffffff ? -1 : face;
  }

  /** The faces that lie wholly in a box of the picture: x, y, x, y from -1 to 1. */
  facesIn(picture: Matrix4, [left, bottom, right, top]: [number, number, number, number]): number[] {
    const { points, corners, face } = this.surface;
    const m = picture.elements;
    const isIn = new Uint8Array(points.length / 3);
    for (let k = 0; k < isIn.length; k++) {
      const [x, y, z] = [points[3 * k]!, points[3 * k + 1]!, points[3 * k + 2]!];
      const row = (r: number) => m[r]! * x + m[r + 4]! * y + m[r + 8]! * z + m[r + 12]!;
      const w = row(3);
      isIn[k] = w > 0 && row(0) >= left * w && row(0) <= right * w && row(1) >= bottom * w && row(1) <= top * w ? 1 : 0;
    }
    const isWhole = new Uint8Array(this.faces).fill(1);
    face.forEach((f, t) => { if (f !== 0xffffffff && !(isIn[corners[3 * t]!]! & isIn[corners[3 * t + 1]!]! & isIn[corners[3 * t + 2]!]!)) isWhole[f] = 0; });
    return [...isWhole.keys()].filter((f) => isWhole[f] === 1);
  }

  /** The faces beside these: all, or those over smooth edges alone. */
  beside(chosen: number[], isSmooth: boolean): number[] {
    const { points, corners, face, borders } = this.surface;
    if (!this.pairs) {
      this.pairs = [];
      const n = points.length / 3;
      const key = (a: number, b: number) => Math.min(a, b) * n + Math.max(a, b);
      const uses = new Map<number, number[]>();
      for (let k = 0; k < borders.length; k += 2) uses.set(key(borders[k]!, borders[k + 1]!), []);
      for (let t = 0; t < face.length; t++) for (let k = 0; k < 3; k++) uses.get(key(corners[3 * t + k]!, corners[3 * t + ((k + 1) % 3)]!))?.push(t);
      const normal = (t: number) => {
        const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromArray(points, 3 * corners[3 * t + k]!)) as [Vector3, Vector3, Vector3];
        return b.sub(a).cross(c.sub(a)).normalize();
      };
      for (const [t, u] of uses.values()) if (t !== undefined && u !== undefined) this.pairs.push([face[t]!, face[u]!, normal(t).dot(normal(u)) > SMOOTH_COS]);
    }
    const own = new Set(chosen);
    const found = new Set<number>();
    for (const [a, b, smooth] of this.pairs) {
      if (isSmooth && !smooth) continue;
      if (own.has(a)) found.add(b);
      if (own.has(b)) found.add(a);
    }
    return [...found].filter((f) => f !== 0xffffffff && !own.has(f));
  }

  /** Colours facets that are always or never supported. */
  setPainted(enforce: Set<number>, block: Set<number>): void {
    const all = this.paintOf.array as Uint8Array;
    all.fill(0);
    for (const [facets, number] of [[enforce, 1], [block, 2]] as const) for (const t of facets) all.fill(number, 3 * t, 3 * t + 3);
    this.paintOf.needsUpdate = true;
  }

  /** Draws supports: ten numbers a branch, as the server sends them; null takes them away. The greatest load, N. */
  setBranches(rows: Float32Array | null): number {
    for (const mesh of this.branches.children as Mesh[]) { mesh.geometry.dispose(); (mesh.material as ShaderMaterial).dispose(); }
    this.branches.clear();
    this.branchRows = rows ?? new Float32Array(0);
    let most = 0;
    for (let k = 0; k < this.branchRows.length; k += BRANCH) most = Math.max(most, this.branchRows[k + 8]!);
    if (this.branchRows.length === 0) return most;
    const geometry = new InstancedBufferGeometry();
    const post = new CylinderGeometry(1, 1, 1, 9, 1, true);
    geometry.index = post.index;
    geometry.setAttribute("position", post.getAttribute("position"));
    const buffer = new InstancedInterleavedBuffer(this.branchRows.slice(), BRANCH);
    geometry.setAttribute("high", new InterleavedBufferAttribute(buffer, 4, 0));
    geometry.setAttribute("low", new InterleavedBufferAttribute(buffer, 4, 4));
    geometry.setAttribute("load", new InterleavedBufferAttribute(buffer, 1, 8));
    geometry.instanceCount = this.branchRows.length / BRANCH;
    const material = new ShaderMaterial({
      glslVersion: GLSL3, side: DoubleSide,
      vertexShader: `in vec4 high; in vec4 low; in float load; uniform float most; out vec3 at; out vec3 tone;
vec3 ramp(float t) { vec3 all[9] = vec3[9](${Array.from({ length: 9 }, (_, k) => `vec3(${ramp(k / 8).map((c) => (c / 255).toFixed(4)).join(", ")})`).join(", ")}); float s = clamp(t, 0.0, 1.0) * 8.0; int k = min(int(s), 7); return mix(all[k], all[k + 1], s - float(k)); }
void main() {
  vec3 along = high.xyz - low.xyz; along = length(along) > 1e-6 ? normalize(along) : vec3(0.0, 0.0, 1.0);
  vec3 u = normalize(cross(along, abs(along.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0))); vec3 v = cross(along, u);
  vec4 end = position.y > 0.0 ? high : low;
  vec4 eye = modelViewMatrix * vec4(end.xyz + end.w * (u * position.x + v * position.z), 1.0);
  tone = ramp(load / max(most, 1e-9)); at = eye.xyz; gl_Position = projectionMatrix * eye;
}`,
      fragmentShader: `in vec3 at; in vec3 tone; out vec4 result; void main() { ${LIGHT} result = vec4(tone * (0.72 + 0.33 * lit), 1.0); }`,
      uniforms: { most: { value: most } },
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.branches.add(mesh);
    return most;
  }

  showBranches(isShown: boolean): void { this.branches.visible = isShown; }

  /** The branch that a ray meets before the part: the one whose axis it passes nearest to, within its radius. */
  branchAt(ray: Ray): { load_n: number; isContact: boolean; at: Vector3 } | null {
    const rows = this.branchRows;
    const part = this.search.first(ray)?.distance ?? Infinity;
    let best: { load_n: number; isContact: boolean; at: Vector3; far: number } | null = null;
    const [a, b, onRay, onAxis] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];
    for (let k = 0; k < rows.length; k += BRANCH) {
      a.fromArray(rows, k);
      b.fromArray(rows, k + 4);
      const off = ray.distanceSqToSegment(a, b, onRay, onAxis);
      const length = a.distanceTo(b);
      const t = length > 0 ? onAxis.distanceTo(a) / length : 0;
      const radius = rows[k + 3]! * (1 - t) + rows[k + 7]! * t;
      const far = onRay.distanceTo(ray.origin);
      if (off > radius * radius || far > part + radius || (best && best.far <= far)) continue;
      best = { load_n: rows[k + 8]!, isContact: rows[k + 9]! > 0.5, at: onAxis.clone(), far };
    }
    return best;
  }

  triangles(face: number): Uint32Array {
    if (this.trianglesOf.length === 0) {
      const counts = new Uint32Array(this.faces);
      for (const f of this.surface.face) if (f !== 0xffffffff) counts[f]!++;
      for (let f = 0; f < this.faces; f++) this.trianglesOf.push(new Uint32Array(counts[f]!));
      counts.fill(0);
      this.surface.face.forEach((f, t) => { if (f !== 0xffffffff) this.trianglesOf[f]![counts[f]!++] = t; });
    }
    return this.trianglesOf[face] ?? new Uint32Array(0);
  }

  /** Places of defects: the middle of each group of faulty edges that hang together, those that mending leaves first. */
  defects(): Vector3[] {
    const [left, all] = [groups(this.surface.faulty), groups(this.surface.faults)];
    // What is left is a fault of the file too.
    const near = 1e-5 * this.high.distanceTo(this.low);
    return [...left, ...all.filter((p) => left.every((q) => q.distanceTo(p) > near))];
  }

  /** The measures of a face or of a part of it, and points spread evenly over its area. */
  patch(face: number, side: Side | null = null): Patch {
    const known = side ? undefined : this.patches.get(face);
    if (known) return known;
    const { points, corners } = this.surface;
    const whole = (t: number, k: number) => new Vector3().fromArray(points, 3 * corners[3 * t + k]!);
    const pieces = side ? Array.from(this.triangles(face), (t) => clipped([0, 1, 2].map((k) => whole(t, k)), side)).flat() : null;
    const corner = pieces ? (t: number, k: number) => pieces[t]![k]!.clone() : whole;
    const all = pieces ? Uint32Array.from(pieces.keys()) : this.triangles(face);
    const [middle, normal] = [new Vector3(), new Vector3()];
    const sums = new Float64Array(all.length);
    let area = 0;
    const crossed = (t: number) => { const a = corner(t, 0); return new Vector3().crossVectors(corner(t, 1).sub(a), corner(t, 2).sub(a)).multiplyScalar(0.5); };
    all.forEach((t, i) => {
      const cross = crossed(t);
      const own = cross.length();
      area += own;
      sums[i] = area;
      normal.add(cross);
      middle.addScaledVector(corner(t, 0).add(corner(t, 1)).add(corner(t, 2)), own / 3);
    });
    if (area > 0) middle.divideScalar(area);
    const [spread, normals]: [Vector3[], Vector3[]] = [[], []];
    const wanted = 9;
    for (let k = 0, i = 0; k < wanted && area > 0; k++) {
      const until = (area * (k + 0.5)) / wanted;
      while (i + 1 < all.length && sums[i]! < until) i++;
      const t = all[i]!;
      // The two steps of the golden ratio's sequence in the plane fill a triangle evenly.
      let [u, v] = [(0.5 + 0.7548776662 * k) % 1, (0.5 + 0.569840291 * k) % 1];
      if (u + v > 1) [u, v] = [1 - u, 1 - v];
      const a = corner(t, 0);
      spread.push(a.clone().addScaledVector(corner(t, 1).sub(a), u).addScaledVector(corner(t, 2).sub(a), v));
      normals.push(crossed(t).normalize());
    }
    // A closed face, such as the wall of a hole, has no mean normal.
    const made = { area, middle, normal: normal.length() > 1e-3 * area ? normal.normalize() : new Vector3(), spread, normals };
    if (!side) this.patches.set(face, made);
    return made;
  }

  /** Draws arrows, all of them in one call. */
  setArrows(arrows: Arrow[]): void {
    for (const mesh of this.marks.children as Mesh[]) { mesh.geometry.dispose(); (mesh.material as MeshBasicMaterial).dispose(); }
    this.marks.clear();
    if (arrows.length === 0) return;
    const [points, colours]: [number[], number[]] = [[], []];
    for (const arrow of arrows) {
      const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), arrow.along.clone().normalize());
      const place = new Matrix4().compose(arrow.at, turn, new Vector3(arrow.length, arrow.length, arrow.length));
      const shapes = arrow.isCone ? [CONE] : arrow.heads === 2 ? [SHAFT, TIP, SECOND] : [SHAFT, TIP];
      for (const shape of shapes) for (let k = 0; k < shape.length; k += 3) {
        const p = new Vector3(shape[k], shape[k + 1], shape[k + 2]).applyMatrix4(place);
        points.push(p.x, p.y, p.z);
        colours.push(...arrow.colour.map((c) => c / 255));
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
    geometry.setAttribute("colour", new BufferAttribute(new Float32Array(colours), 3));
    const material = (opacity: number) => new ShaderMaterial({
      glslVersion: GLSL3, side: DoubleSide, uniforms: { opacity: { value: opacity } },
      vertexShader: `in vec3 colour; out vec3 at; out vec3 tone; void main() { tone = colour; vec4 eye = modelViewMatrix * vec4(position, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`,
      fragmentShader: `uniform float opacity; in vec3 at; in vec3 tone; out vec4 result; void main() { ${LIGHT} result = vec4(tone * (0.72 + 0.33 * lit), opacity); }`,
    });
    // What the part hides, such as the load of a hole, shines through it; it is drawn once all that hides it is there.
    const hidden = Object.assign(material(HIDDEN_ARROW), { transparent: true, depthWrite: false, depthFunc: GreaterDepth });
    for (const [order, look] of [[0, material(1)], [1, hidden]] as const) {
      const mesh = new Mesh(geometry, look);
      mesh.frustumCulled = false;
      mesh.renderOrder = order;
      this.marks.add(mesh);
    }
  }

  /** Shows the stress instead of the faces; null shows the faces again. */
  setStress(stress: StressView | null): void {
    if (this.stressed && this.stressed !== stress) { this.group.remove(this.stressed.group); this.stressed.dispose(); }
    this.stressed = stress;
    if (stress) this.group.add(stress.group);
    this.showStress(stress !== null);
  }

  /** Switches between faces and stress. */
  showStress(isShown: boolean): void {
    if (this.stressed) this.stressed.group.visible = isShown;
    this.mesh.visible = this.borders.visible = !isShown || !this.stressed;
  }

  get stress(): StressView | null { return this.stressed; }
  get isStressShown(): boolean { return this.stressed !== null && this.stressed.group.visible; }

  dispose(): void {
    this.setStress(null);
    this.setArrows([]);
    this.setBranches(null);
    this.colours.dispose();
    for (const child of [this.mesh, this.borders, ...this.faults]) { child.geometry.dispose(); (child.material as LineBasicMaterial).dispose(); }
  }
}

/** The middle of each group of edges that share ends. */
function groups(ends: Float32Array): Vector3[] {
  const parent = new Map<string, string>();
  const root = (k: string): string => { let at = k; while (parent.get(at) !== at) { const up = parent.get(at)!; parent.set(at, parent.get(up)!); at = parent.get(at)!; } return at; };
  const key = (k: number) => `${ends[3 * k]} ${ends[3 * k + 1]} ${ends[3 * k + 2]}`;
  const n = ends.length / 6;
  for (let k = 0; k < n; k++) {
    const [a, b] = [key(2 * k), key(2 * k + 1)];
    for (const p of [a, b]) if (!parent.has(p)) parent.set(p, p);
    parent.set(root(a), root(b));
  }
  const sums = new Map<string, [Vector3, number]>();
  for (let k = 0; k < 2 * n; k++) {
    const of = root(key(k));
    const sum = sums.get(of) ?? [new Vector3(), 0];
    sum[0].add(new Vector3().fromArray(ends, 3 * k));
    sum[1]++;
    sums.set(of, sum);
  }
  return [...sums.values()].map(([sum, count]) => sum.divideScalar(count));
}

/** Segments as strips of the screen, so many pixels wide: x, y, z and a value of both ends of each. */
function strips(ends: Float32Array, wide: number, fragmentShader: string, uniforms: { [name: string]: { value: unknown } }): Mesh<InstancedBufferGeometry, ShaderMaterial> {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array([0, 1, 0, 0, -1, 0, 1, 1, 0, 1, -1, 0]), 3));
  geometry.setIndex([0, 1, 2, 2, 1, 3]);
  const buffer = new InstancedInterleavedBuffer(ends, 8);
  geometry.setAttribute("a", new InterleavedBufferAttribute(buffer, 4, 0));
  geometry.setAttribute("b", new InterleavedBufferAttribute(buffer, 4, 4));
  geometry.instanceCount = ends.length / 8;
  const pixels = new Vector2();
  const made = new Mesh(geometry, new ShaderMaterial({ glslVersion: GLSL3, vertexShader: LINES_VERTEX, fragmentShader, side: DoubleSide, uniforms: { ...uniforms, pixels: { value: pixels }, wide: { value: wide } } }));
  made.onBeforeRender = (renderer) => { renderer.getSize(pixels); };
  made.frustumCulled = false;
  return made;
}

/** Edges of a part in one colour, over its surface: both ends of each. */
function marked(ends: Float32Array, wide: number, colour: Rgb, order: number): Mesh<InstancedBufferGeometry, ShaderMaterial> {
  const four = new Float32Array((4 * ends.length) / 3);
  for (let k = 0; 3 * k < ends.length; k++) four.set(ends.subarray(3 * k, 3 * k + 3), 4 * k);
  const made = strips(four, wide, `out vec4 result; void main() { result = vec4(${colour.join(".0, ")}.0, 255.0) / 255.0; }`, {});
  // Nearer to the eye than the surface, which is set back.
  [made.material.polygonOffset, made.material.polygonOffsetFactor, made.material.polygonOffsetUnits] = [true, -1 - order, -1 - order];
  made.renderOrder = order;
  made.visible = ends.length > 0;
  return made;
}

function lines(points: Float32Array, colour: number, opacity: number): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const made = new LineSegments(geometry, new LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity }));
  made.frustumCulled = false;
  return made;
}

/** Corners of the triangles of a shape that begins at 0 and ends at 1 along y. */
function corners(shape: BufferGeometry, shift: number): Float32Array {
  shape.translate(0, shift, 0);
  const all = shape.toNonIndexed().getAttribute("position").array as Float32Array;
  shape.dispose();
  return all;
}
const SHAFT = corners(new CylinderGeometry(0.028, 0.028, 0.76, 10, 1), 0.38);
const TIP = corners(new ConeGeometry(0.085, 0.26, 14, 1), 0.87);
const SECOND = corners(new ConeGeometry(0.085, 0.26, 14, 1), 0.66);
/** A cone whose tip is where it stands. */
/** Opacity of arrows and cones where the part hides them. Source: chosen by eye. */
const HIDDEN_ARROW = 0.3;
const CONE = corners(new ConeGeometry(0.4, 1, 12, 1), -0.5);
