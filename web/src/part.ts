// The part on the screen: its surface with faces, defects, arrows of fixtures and loads, and the stress on it.
//
// Triangles are drawn with the normal of the screen's derivatives, so that sharp edges stay sharp without split vertices.
// Each triangle carries the number of its face; a texture holds the colour of each face, so that choosing one uploads four
// bytes and not the mesh.

import { BufferAttribute, BufferGeometry, CylinderGeometry, ConeGeometry, DataTexture, DoubleSide, GLSL3, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, NearestFilter, Quaternion, RGBAFormat, ShaderMaterial, Vector2, Vector3, type Ray } from "three";
import { ramp, table, type Rgb } from "./colours";
import { Search } from "./search";

/** Colours of faces: plain, chosen, held, loaded. Told apart by brightness too. */
export const FACE: Rgb = [178, 188, 196];
export const CHOSEN: Rgb = [245, 196, 66];
export const HELD: Rgb = [70, 130, 190];
export const LOADED: Rgb = [226, 120, 58];
/** Faces in a row of the texture. */
const ROW = 1024;

/** Faces are lit from the eye, a little from above; `out` the world's place for the normal. */
const VERTEX = `
in float face; out vec3 at; flat out int number;
void main() { number = int(face + 0.5); vec4 eye = modelViewMatrix * vec4(position, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`;
const LIGHT = `vec3 n = normalize(cross(dFdx(at), dFdy(at))); if (dot(n, at) > 0.0) n = -n; float lit = max(dot(n, normalize(vec3(0.25, 0.45, 0.86))), 0.0);`;
const FRAGMENT = `
in vec3 at; flat in int number; out vec4 result; uniform sampler2D faces; uniform int hovered;
void main() {
  ${LIGHT}
  vec3 colour = texelFetch(faces, ivec2(number % ${ROW}, number / ${ROW}), 0).rgb;
  if (number == hovered) colour = mix(colour, vec3(1.0, 0.97, 0.62), 0.55);
  result = vec4(colour * (0.5 + 0.55 * lit), 1.0);
}`;
const STRESS_VERTEX = `
in float value; in vec3 moved; uniform float magnify; out vec3 at; out float v;
void main() { v = value; vec4 eye = modelViewMatrix * vec4(position + magnify * moved, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`;
const STRESS_FRAGMENT = `
in vec3 at; in float v; out vec4 result; uniform sampler2D colours; uniform vec2 scale;
void main() {
  ${LIGHT}
  float t = clamp((v - scale.x) / max(scale.y - scale.x, 1e-12), 0.0, 1.0);
  result = vec4(texture(colours, vec2(t * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb * (0.82 + 0.18 * lit), 1.0);
}`;

export interface Surface { points: Float32Array; corners: Uint32Array; face: Uint32Array; faulty: Float32Array; borders: Uint32Array }

/** Lays arrays over the bytes of a surface. */
export function surfaceOf(bytes: ArrayBuffer): Surface {
  const [n, m, f, b] = new Uint32Array(bytes, 0, 4) as unknown as [number, number, number, number];
  let at = 16;
  const take = <T>(make: new (buffer: ArrayBuffer, at: number, n: number) => T, count: number): T => { const made = new make(bytes, at, count); at += 4 * count; return made; };
  return { points: take(Float32Array, 3 * n), corners: take(Uint32Array, 3 * m), face: take(Uint32Array, m), faulty: take(Float32Array, 6 * f), borders: take(Uint32Array, 2 * b) };
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
  readonly mesh: Mesh;
  private readonly material: ShaderMaterial;
  private readonly search: Search;
  private nine: Float32Array = new Float32Array(0);
  private readonly points: Float32Array;
  private readonly corners: Uint32Array;

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
    this.material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: STRESS_VERTEX, fragmentShader: STRESS_FRAGMENT, side: DoubleSide, uniforms: { colours: { value: colours }, scale: { value: new Vector2(0, 1) }, magnify: { value: 0 } } });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.search = new Search(this.points, this.corners, then);
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
    const value = this.mesh.geometry.getAttribute("value") as BufferAttribute;
    const all = value.array as Float32Array;
    for (let k = 0; k < all.length; k++) all[k] = quantity(what, this.nine, 9 * k);
    value.needsUpdate = true;
    const sorted = all.slice().sort();
    const at = (share: number) => sorted[Math.min(Math.floor(share * sorted.length), sorted.length - 1)] ?? 0;
    const isSigned = what === "first" || what === "third";
    const proposed: [number, number] = what === "moved" ? [0, at(1)] : [isSigned ? Math.min(at(1 - COVERED), 0) : 0, at(COVERED)];
    if (what === "third") proposed[1] = Math.max(at(COVERED), 0);
    return { low: sorted[0] ?? 0, high: at(1), proposed };
  }

  setScale(low: number, high: number): void { (this.material.uniforms.scale!.value as Vector2).set(low, high); }
  setMagnified(by: number): void { this.material.uniforms.magnify!.value = by; }

  /** Largest displacement, mm. */
  get largestMove(): number {
    let most = 0;
    for (let k = 0; k < this.nine.length; k += 9) most = Math.max(most, Math.hypot(this.nine[k + 6]!, this.nine[k + 7]!, this.nine[k + 8]!));
    return most;
  }

  /** The values at the point of the surface that a ray meets: nine, and where. The part at rest is asked. */
  probe(ray: Ray): { at: Vector3; nine: number[] } | null {
    const hit = this.search.first(ray);
    if (!hit) return null;
    const shares = this.search.shares(hit.triangle, hit.point);
    const nine = Array.from({ length: 9 }, (_, c) => shares.reduce((sum, share, k) => sum + share * this.nine[9 * this.corners[3 * hit.triangle + k]! + c]!, 0));
    return { at: hit.point, nine };
  }

  dispose(): void { (this.material.uniforms.colours!.value as DataTexture).dispose(); this.material.dispose(); this.mesh.geometry.dispose(); }
}

export class PartView {
  readonly group = new Group();
  readonly low = new Vector3(Infinity, Infinity, Infinity);
  readonly high = new Vector3(-Infinity, -Infinity, -Infinity);
  readonly faces: number;
  readonly search: Search;
  private readonly mesh: Mesh;
  private readonly borders: LineSegments;
  private readonly faulty: LineSegments;
  private readonly marks = new Group();
  private readonly material: ShaderMaterial;
  private readonly colours: DataTexture;
  private readonly patches = new Map<number, Patch>();
  private readonly trianglesOf: Uint32Array[] = [];
  private stressed: StressView | null = null;

  constructor(readonly surface: Surface, then: () => void) {
    const { points, corners, face, faulty, borders } = surface;
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
    const rows = Math.ceil((this.faces + 1) / ROW);
    this.colours = new DataTexture(new Uint8Array(4 * ROW * rows), ROW, rows, RGBAFormat);
    this.colours.minFilter = this.colours.magFilter = NearestFilter;
    this.material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, uniforms: { faces: { value: this.colours }, hovered: { value: -1 } } });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.borders = lines(Float32Array.from({ length: 3 * borders.length }, (_, k) => points[3 * borders[Math.floor(k / 3)]! + (k % 3)]!), 0x3c464d, 0.75);
    this.faulty = lines(faulty.slice(), 0xd01f3c, 1);
    this.group.add(this.mesh, this.borders, this.faulty, this.marks);
    this.paint(new Map());
    this.search = new Search(points, corners, then);
  }

  /** Colours faces; those not named are plain. */
  paint(colours: Map<number, Rgb>): void {
    const bytes = this.colours.image.data as Uint8Array;
    for (let f = 0; f <= this.faces; f++) bytes.set([...(colours.get(f) ?? FACE), 255], 4 * f);
    this.colours.needsUpdate = true;
  }

  set hovered(face: number) { this.material.uniforms.hovered!.value = face; }
  get hovered(): number { return this.material.uniforms.hovered!.value as number; }

  /** The face that a ray meets first; -1 for none, or for a triangle without one. */
  faceAt(ray: Ray): number {
    const hit = this.search.first(ray);
    const face = hit ? this.surface.face[hit.triangle]! : 0xffffffff;
    return face === 0xffffffff ? -1 : face;
  }

  private triangles(face: number): Uint32Array {
    if (this.trianglesOf.length === 0) {
      const counts = new Uint32Array(this.faces);
      for (const f of this.surface.face) if (f !== 0xffffffff) counts[f]!++;
      for (let f = 0; f < this.faces; f++) this.trianglesOf.push(new Uint32Array(counts[f]!));
      counts.fill(0);
      this.surface.face.forEach((f, t) => { if (f !== 0xffffffff) this.trianglesOf[f]![counts[f]!++] = t; });
    }
    return this.trianglesOf[face] ?? new Uint32Array(0);
  }

  /** The measures of a face, and points spread evenly over its area. */
  patch(face: number): Patch {
    const known = this.patches.get(face);
    if (known) return known;
    const { points, corners } = this.surface;
    const corner = (t: number, k: number) => new Vector3().fromArray(points, 3 * corners[3 * t + k]!);
    const all = this.triangles(face);
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
    this.patches.set(face, made);
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
    const material = new ShaderMaterial({
      glslVersion: GLSL3, side: DoubleSide,
      vertexShader: `in vec3 colour; out vec3 at; out vec3 tone; void main() { tone = colour; vec4 eye = modelViewMatrix * vec4(position, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`,
      fragmentShader: `in vec3 at; in vec3 tone; out vec4 result; void main() { ${LIGHT} result = vec4(tone * (0.72 + 0.33 * lit), 1.0); }`,
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.marks.add(mesh);
  }

  /** Shows the stress instead of the faces; null shows the faces again. */
  setStress(stress: StressView | null): void {
    if (this.stressed && this.stressed !== stress) { this.group.remove(this.stressed.mesh); this.stressed.dispose(); }
    this.stressed = stress;
    if (stress) this.group.add(stress.mesh);
    this.showStress(stress !== null);
  }

  /** Switches between faces and stress. */
  showStress(isShown: boolean): void {
    if (this.stressed) this.stressed.mesh.visible = isShown;
    this.mesh.visible = this.borders.visible = !isShown || !this.stressed;
  }

  get stress(): StressView | null { return this.stressed; }
  get isStressShown(): boolean { return this.stressed !== null && this.stressed.mesh.visible; }

  dispose(): void {
    this.setStress(null);
    this.setArrows([]);
    this.colours.dispose();
    for (const child of [this.mesh, this.borders, this.faulty]) { child.geometry.dispose(); (child.material as LineBasicMaterial).dispose(); }
  }
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
const CONE = corners(new ConeGeometry(0.4, 1, 12, 1), -0.5);
