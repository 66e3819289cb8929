// The view: beads as ribbons or small roofs, the plate, places of fixtures and loads, and what broke.
//
// Beads are instances of one shape, whose ends are two neighbouring records of one buffer. Layers lie in few large chunks of
// ribbons, two triangles each, that turn to the eye; where a window of few layers is shown, its records are copied into a
// chunk of their own, of roofs with four triangles, so that the work depends on what is seen. A picture is drawn only when
// something changed.

import {
  BufferAttribute, BufferGeometry, Color, Data3DTexture, DataTexture, DoubleSide, FloatType, GLSL3, Group, InstancedBufferAttribute, InstancedBufferGeometry, InstancedInterleavedBuffer,
  InterleavedBufferAttribute, type Texture, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, NearestFilter, BoxGeometry, ConeGeometry, CylinderGeometry, PerspectiveCamera,
  Quaternion, Raycaster, type Ray, RedFormat, RGBAFormat, Scene, ShaderMaterial, Vector2, Vector3, WebGLRenderer, EdgesGeometry, RGFormat,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Beads, RESERVE_OF_1, RESERVE_STEPS, TRAVEL, WORDS, type Bead } from "./beads";
import type { PartView } from "./part";
import { CLASS_COLOURS, COLOUR_BY, MARK_COLOURS, PLAIN, SEAM, circle, ramp, table, type ColourBy, type CrackBy } from "./colours";

/** Records up to which a window gets a chunk of its own. */
const WINDOW_RECORDS = 60_000;
/** Chunks of a program at most, so that a picture takes few calls. */
const CHUNKS = 12;
/** Records whose beads are looked through for the one under the pointer. */
const HOVER_RECORDS = 3_000_000;

/** The number of a way of colouring in the shaders. */
const number = (by: ColourBy) => COLOUR_BY.findIndex(([key]) => key === by);
/** That of the order of breaking, which is chosen elsewhere. */
const BY_BREAK = COLOUR_BY.length;
/** Classes of records. */
const CLASSES = TRAVEL + 4;
/** Half the width of the mark of a retraction, mm. Source: chosen; wider than a bead, so that it is seen beside its end. */
const MARK_MM = 0.6;
/** How much of a bead is drawn as its seam, in widths of the bead. Source: chosen; a dot beside the next bead's. */
const SEAM_WIDTHS = 2;
const vec3 = (c: readonly number[]) => `vec3(${c.map((v) => (v / 255).toFixed(4)).join(", ")})`;
/** `BY_SPEED` and its like, for the shaders. How beads are coloured is compiled in, so that no bead asks for it. */
const NUMBERS = `
${COLOUR_BY.map(([key]) => `#define BY_${key.toUpperCase()} ${number(key)}`).join("\n")}
#define BY_BREAK ${BY_BREAK}
`;

const VERTEX = `${NUMBERS}
in vec2 a; in vec2 b; in vec4 meta;
uniform vec2 origin; uniform float unit; uniform sampler2D heights; uniform float firstRecord; uniform vec2 range; uniform vec2 scale;
uniform vec3 classColours[${CLASSES}]; uniform float classShown[${CLASSES}]; uniform sampler2D speeds; uniform sampler2D colours; uniform sampler2D circleColours; uniform float hovered; uniform float ghost;
flat out vec3 colour; flat out vec4 lit; out float side;
#if BY == BY_BREAK
out vec3 at;
#elif BY == BY_SEAM
out float fromSeam;
#endif
void main() {
  colour = vec3(0.0); lit = vec4(0.0); side = position.y;
#if BY == BY_BREAK
  at = vec3(0.0);
#elif BY == BY_SEAM
  fromSeam = 1e6;
#endif
  float record = firstRecord + float(gl_InstanceID) + 1.0;
  float kind = mod(meta.y, 128.0); bool isSeam = mod(meta.y, 256.0) > 127.5; float speedAt = floor(meta.y / 256.0);
  int k = int(kind + 0.5);
  vec4 layer = texelFetch(heights, ivec2(int(meta.z) % 256, int(meta.z) / 256), 0);
  vec2 h = layer.rg;
  bool shown = record >= range.x && record <= range.y && k != ${TRAVEL + 1} && classShown[k] > 0.5;
  vec2 p = origin + unit * a; vec2 q = origin + unit * b; vec2 d = q - p; float len = length(d);
  if (shown && k > ${TRAVEL}) {
    // A mark that faces the eye: on its corner where filament is pulled back, upright where it is pushed again.
    vec2 e = vec2(2.0 * position.x - 1.0, position.y) * ${MARK_MM};
    if (k == ${TRAVEL + 2}) e = 0.7 * vec2(e.x - e.y, e.x + e.y);
    colour = mix(classColours[k], vec3(0.72, 0.75, 0.77), ghost);
    gl_Position = projectionMatrix * (viewMatrix * vec4(vec3(q, h.r + ${MARK_MM}), 1.0) + vec4(e, 0.0, 0.0));
    return;
  }
  if (!shown || len < 1e-6) { gl_Position = vec4(2.0, 2.0, 2.0, 0.0); return; }
  vec2 along = d / len; vec2 across = vec2(-along.y, along.x);
  bool travel = k == ${TRAVEL};
  float width = travel ? 0.12 : meta.x * 1e-3;
  float over = travel ? 0.0 : 0.3 * width;
  vec2 radii = vec2(0.5 * width, (travel ? 0.1 : 0.45) * h.g);
  // A roof: its ridge is upright, its feet are across. A ribbon turns to the eye, as wide as the bead is seen.
  vec3 middle = vec3(0.0, 0.0, 1.0); vec3 edge = vec3(across, 0.0);
  vec3 place = vec3(mix(p - over * along, q + over * along, position.x), h.r - radii.y);
  if (position.z < 0.0) {
    vec3 eye = cross(vec3(along, 0.0), cameraPosition - place);
    if (dot(eye, eye) > 1e-12) edge = normalize(eye);
    middle = cross(edge, vec3(along, 0.0));
    vec2 e = radii * vec2(dot(edge.xy, across), edge.z); vec2 m = radii * vec2(dot(middle.xy, across), middle.z);
    place += middle * length(m) + edge * length(e) * position.y;
  } else place += vec3(across * radii.x * position.y, (2.0 * position.z - 1.0) * radii.y);
  colour = classColours[k];
#if BY == BY_ANGLE
  if (!travel) { float turn = atan(along.y, along.x) / 3.14159265; colour = texture(circleColours, vec2(turn - floor(turn), 0.5)).rgb; }
#elif BY == BY_SEAM
  if (!travel) colour = ${vec3(PLAIN)};
#elif BY != BY_ROLE && BY != BY_BREAK
  float speed = texelFetch(speeds, ivec2(int(speedAt), 0), 0).r;
#if BY == BY_SPEED
  float value = speed;
#elif BY == BY_WIDTH
  float value = width;
#elif BY == BY_FLOW
  float value = max(h.g * (width - h.g * 0.2146), 0.0) * speed;
#elif BY == BY_HEIGHT
  float value = h.r;
#elif BY == BY_TIME
  float value = layer.b;
#elif BY == BY_LOAD
  float own = mod(meta.w, 256.0); float value = 0.5 * own;
#elif BY == BY_RESERVE
  float own = floor(meta.w / 256.0); float value = (${RESERVE_OF_1}.0 - own) / ${RESERVE_STEPS}.0;
#endif
#if BY == BY_LOAD || BY == BY_RESERVE
  if (own > 254.5) colour = travel ? colour : ${vec3(PLAIN)}; else
#endif
  if (!travel) colour = texture(colours, vec2(clamp((value - scale.x) / max(scale.y - scale.x, 1e-6), 0.002, 0.998), 0.5)).rgb;
#endif
  colour = mix(colour, vec3(0.72, 0.75, 0.77), ghost);
  if (abs(record - hovered) < 0.5) colour = vec3(1.0, 0.95, 0.35);
#if BY == BY_SEAM
  // Along the bead, in its widths.
  if (isSeam) fromSeam = position.x * (len + 2.0 * over) / width;
#elif BY == BY_BREAK
  at = vec3(place.xy, h.r - 0.5 * h.g);
#endif
  // Light from above and a little from the left: of the middle, and of the edge.
  vec3 left = vec3(-0.7, 0.5, 0.0);
  lit = travel ? vec4(0.0) : vec4(0.48 * middle.z + 0.10 * dot(middle, left), 0.48 * edge.z + 0.10 * dot(edge, left), 1.0, 0.0);
  gl_Position = projectionMatrix * (viewMatrix * vec4(place, 1.0));
}`;

const FRAGMENT = `${NUMBERS}
flat in vec3 colour; flat in vec4 lit; in float side; out vec4 result;
#if BY == BY_BREAK
in vec3 at; uniform sampler3D breaks; uniform mat4 breaksFrom; uniform float state; uniform sampler2D colours;
#elif BY == BY_SEAM
in float fromSeam;
#endif
void main() {
  vec3 tone = colour;
#if BY == BY_SEAM
  if (fromSeam < ${SEAM_WIDTHS.toFixed(1)}) tone = ${vec3(SEAM)};
#elif BY == BY_BREAK
  vec3 g = (breaksFrom * vec4(at, 1.0)).xyz;
  vec2 found = texture(breaks, g).rg;
  bool isIn = all(greaterThan(g, vec3(0.0))) && all(lessThan(g, vec3(1.0)));
  tone = isIn && found.x > 0.0 && found.x <= state + 1.0 ? texture(colours, vec2(clamp(found.y, 0.002, 0.998), 0.5)).rgb : vec3(0.72, 0.75, 0.77);
#endif
  // The ridge of a bead keeps its colour, its flanks are darker: the normal turns from the middle to the edge.
  vec2 n = normalize(vec2(1.0 - abs(side), side));
  float shade = lit.z > 0.5 ? 0.52 + max(dot(n, lit.xy), -0.1) : 1.0;
  result = vec4(tone * shade, 1.0);
}`;

export type Side = "x-" | "x+" | "y-" | "y+" | "z-" | "z+";
/** The low and the high corner of a box, mm. */
export type Box = [number[], number[]];
export interface Slab { side: Side; depth_mm: number; colour: number; arrow?: [number, number, number] }

/** The two corners of a slab of a box at one of its sides. */
export function slabOf([low, high]: Box, side: Side, depth_mm: number): Box {
  const [a, b] = [[...low], [...high]];
  const axis = "xyz".indexOf(side[0]!);
  if (side[1] === "-") b[axis] = Math.min(b[axis]!, a[axis]! + depth_mm);
  else a[axis] = Math.max(a[axis]!, b[axis]! - depth_mm);
  return [a, b];
}

/** Numbers of a broken element: x, y, z, the share lost, the state in which it broke. */
export const CELL = 5;
/** What broke in a test; `order` is the place of each element in the order of breaking, 0 to 1. */
export interface Crack { cells: Float32Array<ArrayBuffer>; order: Float32Array; size_mm: [number, number, number]; angle_rad: number }

export interface Shown { low: number; high: number; from: number; to: number }

/** What a drag over the part does. */
export type Gesture = "turn" | "box" | "brush" | "paint" | "split";
/** Places between which a stroke of the brush looks for faces, pixels. */
const BRUSH_STEP = 4;
/** Radius of the brush that paints facets, pixels. Source: chosen; a finger is wider and a pointer narrower. */
const PAINT_PX = 7;

function nameOf(gl: WebGLRenderingContext | WebGL2RenderingContext): string {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  return String(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
}

/** Whether the processor draws because there is no graphics card. Edges are then left rough: smooth ones take twice the time (a million beads under llvmpipe: 4.9 and 2.3 s). */
function isDrawnBySoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const isSoftware = gl !== null && /llvmpipe|swiftshader|softpipe|basic render/i.test(nameOf(gl));
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return isSoftware;
}

export class Viewer {
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(35, 1, 0.1, 10_000);
  readonly controls: OrbitControls;
  beads: Beads | null = null;
  onHover: (bead: Bead | null) => void = () => {};
  onPick: (side: Side) => void = () => {};
  picking = false;
  private readonly scene = new Scene();
  private readonly plate = new Group();
  private readonly chunks = new Group();
  private readonly places = new Group();
  private readonly broken = new Group();
  private readonly window = new Group();
  /** The part as it is placed; it is shown instead of the paths while `mode` says so. */
  part: PartView | null = null;
  onFace: (face: number, at: { clientX: number; clientY: number }) => void = () => {};
  onPickFace: (face: number, isAdded: boolean) => void = () => {};
  /** Faces that a box held, or that the brush touched. */
  onPickFaces: (faces: number[]) => void = () => {};
  /** Triangles that the paint brush went over, and the end of its stroke. */
  onPaint: (triangles: number[]) => void = () => {};
  onPaintEnd: () => void = () => {};
  /** A click at a place of the page while faces are split. */
  onSplit: (at: { clientX: number; clientY: number }) => void = () => {};
  private gesture: Gesture = "turn";
  private mode: "part" | "paths" = "paths";
  private material: ShaderMaterial;
  private shown: Shown = { low: 0, high: 0, from: 0, to: 0 };
  private isDirty = false;
  /** The direction from which the whole part is seen, while it is. */
  private fitted: string | null = null;
  private readonly classShown: number[] = new Array(CLASSES).fill(1) as number[];
  private pointer: { x: number; y: number } | null = null;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !isDrawnBySoftware(), alpha: true });
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    // A view that the user has turned is left alone.
    this.controls.addEventListener("start", () => (this.fitted = null));
    this.material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, defines: { BY: number("role") },
      uniforms: {
        origin: { value: new Vector2() }, unit: { value: 1 }, heights: { value: null }, firstRecord: { value: 0 }, range: { value: new Vector2(0, -1) },
        scale: { value: new Vector2(0, 1) }, speeds: { value: null }, hovered: { value: -1 }, ghost: { value: 0 },
        classColours: { value: Array.from({ length: CLASSES }, (_, k) => new Vector3(...(CLASS_COLOURS[k] ?? MARK_COLOURS[k - TRAVEL - 2] ?? PLAIN).map((c) => c / 255))) },
        classShown: { value: this.classShown },
        breaks: { value: null }, breaksFrom: { value: new Matrix4() }, state: { value: 0 }, colours: { value: palette(ramp) }, circleColours: { value: palette(circle) },
      },
    });
    for (const k of [TRAVEL, TRAVEL + 2, TRAVEL + 3]) this.setShown(k, false);
    this.scene.add(this.plate, this.chunks, this.window, this.places, this.broken);
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerleave", () => { this.pointer = null; this.hover(-1); this.setHovered(-1); this.onFace(-1, { clientX: -1, clientY: -1 }); });
    let down: [number, number] | null = null;
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener("pointerup", (event) => {
      // A drag turns the view; a click picks.
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) this.pick(event);
      down = null;
    });
    this.dragFaces();
  }

  /** The layers nearest to the eye are drawn first, so that what lies behind them is not coloured. */
  private nearestFirst(): void {
    const isAbove = this.camera.position.z > this.controls.target.z;
    this.chunks.children.forEach((mesh, k) => (mesh.renderOrder = isAbove ? -k : k - CHUNKS));
  }

  /** Name of the graphics card or of the program that stands for it. */
  get rendererName(): string { return nameOf(this.renderer.getContext()); }

  /** Draws with the next frame of the browser, once for all that changed until then. */
  draw(): void {
    if (this.isDirty) return;
    this.isDirty = true;
    requestAnimationFrame(() => { this.isDirty = false; this.nearestFirst(); this.renderer.render(this.scene, this.camera); });
  }

  private resize(): void {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (w === 0 || h === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    if (this.fitted && (this.beads || this.part)) this.view(this.fitted);
    this.draw();
  }

  /** Shows the part, or the paths; the other one stays as it is and is hidden. */
  setMode(mode: "part" | "paths"): void {
    if (this.mode === mode) return;
    this.mode = mode;
    this.modeChanged();
  }

  get isPartShown(): boolean { return this.mode === "part" && this.part !== null; }

  private modeChanged(): void {
    const isPart = this.isPartShown;
    for (const group of [this.chunks, this.window, this.places, this.broken]) group.visible = !isPart;
    if (this.part) this.part.group.visible = isPart;
    this.drawPlate();
    this.view(this.fitted ?? "oblique");
  }

  /** Takes a part in place of the one before; null for none. `isSame` keeps the direction of view and the distance. */
  setPart(part: PartView | null, isSame = false): void {
    if (this.part) { this.scene.remove(this.part.group); this.part.dispose(); }
    this.part = part;
    if (part) this.scene.add(part.group);
    if (!isSame) this.fitted ??= "oblique";
    this.modeChanged();
  }

  /** The ray behind a place of the page. */
  rayAt(clientX: number, clientY: number): Ray { return this.ray({ clientX, clientY }).ray; }

  /** Takes away the program that is shown and frees its memory. */
  clear(): void {
    for (const group of [this.chunks, this.window, this.places, this.broken]) empty(group);
    for (const name of ["heights", "speeds", "breaks"]) {
      (this.material.uniforms[name]!.value as Texture | null)?.dispose();
      this.material.uniforms[name]!.value = null;
    }
    this.beads = null;
    this.drawPlate();
    this.draw();
  }

  /** Shows a program whose records are still to come. `isGrown` leaves a view that was turned by hand as it is. */
  show(beads: Beads, isGrown = false): void {
    this.clear();
    this.beads = beads;
    const { index } = beads;
    const u = this.material.uniforms;
    (u.origin!.value as Vector2).set(...index.origin_mm);
    u.unit!.value = index.step_mm;
    const rows = Math.max(1, Math.ceil(index.layers.length / 256));
    const heights = new Float32Array(256 * rows * 4);
    index.layers.forEach((layer, k) => heights.set([layer.z_mm, layer.height_mm, layer.time_s ?? 0, 0], 4 * k));
    u.heights!.value = texture(heights, 256, rows, RGBAFormat);
    const speeds = new Float32Array(256);
    speeds.set(index.speeds_mm_s.slice(0, 256));
    u.speeds!.value = texture(speeds, 256, 1, RedFormat);
    const n = beads.first[index.layers.length]!;
    const least = Math.max(WINDOW_RECORDS, Math.ceil(n / CHUNKS));
    let from = 0;
    for (let layer = 0; layer < index.layers.length; layer++) {
      const isLast = layer === index.layers.length - 1;
      if (beads.first[layer + 1]! - beads.first[from]! >= least || isLast) {
        this.chunks.add(this.chunk(beads.words.subarray(WORDS * beads.first[from]!, WORDS * beads.first[layer + 1]!), beads.first[from]!, true));
        from = layer + 1;
      }
    }
    this.drawPlate();
    if (!isGrown) this.view("oblique");
    else if (this.fitted) this.view(this.fitted);
  }

  /** Beads as roofs, or as ribbons, which have half the triangles and take two thirds of the time (1.9 and 1.2 s). */
  private chunk(words: Uint16Array<ArrayBuffer>, first: number, isRibbon: boolean): Mesh {
    const geometry = new InstancedBufferGeometry();
    if (isRibbon) {
      // Both edges at both ends.
      geometry.setAttribute("position", new BufferAttribute(new Float32Array([0, 1, -1, 0, -1, -1, 1, 1, -1, 1, -1, -1]), 3));
      geometry.setIndex([0, 1, 3, 0, 3, 2]);
    } else {
      // Left foot, ridge, right foot at both ends.
      geometry.setAttribute("position", new BufferAttribute(new Float32Array([0, 1, 0, 0, 0, 1, 0, -1, 0, 1, 1, 0, 1, 0, 1, 1, -1, 0]), 3));
      geometry.setIndex([0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4]);
    }
    const buffer = new InstancedInterleavedBuffer(words, WORDS);
    geometry.setAttribute("a", new InterleavedBufferAttribute(buffer, 2, 0));
    geometry.setAttribute("b", new InterleavedBufferAttribute(buffer, 2, WORDS));
    geometry.setAttribute("meta", new InterleavedBufferAttribute(buffer, 4, WORDS + 2));
    geometry.instanceCount = Math.max(words.length / WORDS - 1, 0);
    const mesh = new Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    mesh.userData.first = first;
    mesh.userData.end = first + words.length / WORDS;
    mesh.onBeforeRender = () => {
      this.material.uniforms.firstRecord!.value = first;
      this.material.uniformsNeedUpdate = true;
    };
    return mesh;
  }

  /** Layers arrived: they go to the graphics card with the next picture. */
  refresh(fromLayer: number, toLayer: number): void {
    if (!this.beads) return;
    const [first, end] = [this.beads.first[fromLayer]!, this.beads.first[toLayer + 1]!];
    for (const mesh of this.chunks.children as Mesh[]) {
      if ((mesh.userData.first as number) < end && (mesh.userData.end as number) > first) {
        mesh.userData.hasCome = true;
        (mesh.geometry.getAttribute("a") as InterleavedBufferAttribute).data.needsUpdate = true;
      }
    }
    this.setRange(this.shown);
  }

  /** Shows layers `low` to `high`, and of the highest one the moves `from` to `to`. */
  setRange(shown: Shown): void {
    this.shown = shown;
    const beads = this.beads;
    if (!beads) return;
    const first = beads.first[shown.low]!;
    const top = beads.first[shown.high]!;
    const begin = shown.low === shown.high ? top + shown.from : first;
    const last = top + shown.to;
    (this.material.uniforms.range!.value as Vector2).set(begin, last);
    empty(this.window);
    const isWindow = last - first < WINDOW_RECORDS;
    // A copy: what lies before the window is not drawn, and what lies behind it neither.
    if (isWindow) this.window.add(this.chunk(beads.words.slice(WORDS * first, WORDS * (last + 1)), first, false));
    for (const mesh of this.chunks.children) {
      // A chunk of which nothing has come yet is not sent to the graphics card: of a program of five million beads that takes a second.
      const hasCome = mesh.userData.hasCome === true || (mesh.userData.first as number) < beads.first[beads.taken]!;
      mesh.visible = hasCome && !isWindow && (mesh.userData.first as number) <= last && (mesh.userData.end as number) > first;
    }
    this.draw();
  }

  setColour(by: ColourBy, scale: [number, number]): void {
    this.compile(number(by));
    (this.material.uniforms.scale!.value as Vector2).set(...scale);
    this.draw();
  }

  /** Takes the shaders of a way of colouring. */
  private compile(by: number): void {
    if (this.material.defines.BY === by) return;
    this.material.defines.BY = by;
    this.material.needsUpdate = true;
  }

  setShown(kind: number, isShown: boolean): void { this.classShown[kind] = isShown ? 1 : 0; this.draw(); }
  isShown(kind: number): boolean { return this.classShown[kind]! > 0; }

  private get box(): [Vector3, Vector3] {
    if (this.part && this.isPartShown) return [this.part.low.clone(), this.part.high.clone()];
    const part = this.beads?.index.part_mm ?? [[0, 0, 0], [100, 100, 10]];
    return [new Vector3(...(part[0] as [number, number, number])), new Vector3(...(part[1] as [number, number, number]))];
  }

  private drawPlate(): void {
    empty(this.plate);
    if (!this.beads && !this.part) return;
    const [low, high] = this.box;
    const span = Math.max(high.x - low.x, high.y - low.y, 10);
    const step = span > 400 ? 50 : span > 80 ? 10 : span > 20 ? 5 : 1;
    const margin = 2 * step;
    const from = (v: number) => Math.floor((v - margin) / step) * step;
    const to = (v: number) => Math.ceil((v + margin) / step) * step;
    const points: number[] = [];
    for (let x = from(low.x); x <= to(high.x); x += step) points.push(x, from(low.y), 0, x, to(high.y), 0);
    for (let y = from(low.y); y <= to(high.y); y += step) points.push(from(low.x), y, 0, to(high.x), y, 0);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
    const lines = new LineSegments(geometry, new LineBasicMaterial({ color: 0x8a969e, transparent: true, opacity: 0.45 }));
    // Just below the first layer, so that beads hide it.
    lines.position.z = Math.min(0, low.z) - 0.02;
    this.plate.add(lines);
  }

  /** Looks from a side, so that the part fills the view. */
  view(direction: string): void {
    const [low, high] = this.box;
    const middle = low.clone().add(high).multiplyScalar(0.5);
    const size = high.clone().sub(low);
    const from: Record<string, Vector3> = { top: new Vector3(0, -1e-4, 1), front: new Vector3(0, -1, 0), side: new Vector3(1, 0, 0), oblique: new Vector3(-0.55, -1.05, 0.95) };
    const along = (from[direction] ?? from.oblique!).clone().normalize();
    // The box as it is seen: its half widths across the view.
    const right = new Vector3().crossVectors(new Vector3(0, 0, 1), along);
    if (right.length() < 1e-3) right.set(1, 0, 0);
    right.normalize();
    const up = new Vector3().crossVectors(along, right);
    const half = (v: Vector3) => 0.5 * (Math.abs(v.x) * size.x + Math.abs(v.y) * size.y + Math.abs(v.z) * size.z);
    const tangent = Math.tan((this.camera.fov * Math.PI) / 360);
    const away = Math.max(half(up), half(right) / Math.max(this.camera.aspect, 0.1)) / tangent + half(along);
    const distance = 1.25 * Math.max(away, 2);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(along, distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.fitted = direction;
    this.draw();
  }

  /** Turns the view about its middle, by degrees to the right and upwards. */
  turn(right_deg: number, up_deg: number): void {
    const { target } = this.controls;
    const from = this.camera.position.clone().sub(target);
    // Angles of the view: about the vertical, and from it. At the vertical itself the view would have no upper side.
    const around = Math.atan2(from.y, from.x) + (right_deg * Math.PI) / 180;
    const polar = Math.acos(from.z / from.length()) - (up_deg * Math.PI) / 180;
    const down = Math.min(Math.max(polar, 1e-3), Math.PI - 1e-3);
    const unit = new Vector3(Math.sin(down) * Math.cos(around), Math.sin(down) * Math.sin(around), Math.cos(down));
    this.camera.position.copy(target).addScaledVector(unit, from.length());
    this.moved();
  }

  /** Brings the view nearer to its middle; a factor above 1 takes it away. */
  zoom(factor: number): void {
    const { target } = this.controls;
    this.camera.position.sub(target).multiplyScalar(factor).add(target);
    this.moved();
  }

  /** Moves the view by shares of its height, to the right and upwards. */
  pan(right: number, up: number): void {
    const { target } = this.controls;
    const height_mm = 2 * this.camera.position.distanceTo(target) * Math.tan((this.camera.fov * Math.PI) / 360);
    this.camera.updateMatrixWorld();
    const axis = (k: number) => new Vector3().setFromMatrixColumn(this.camera.matrixWorld, k);
    const by = axis(0).multiplyScalar(right * height_mm).addScaledVector(axis(1), up * height_mm);
    this.camera.position.add(by);
    target.add(by);
    this.moved();
  }

  private moved(): void {
    this.controls.update();
    this.fitted = null;
    this.draw();
  }

  /** Looks at a point from the side that it is on, near enough to see `around` mm about it. */
  lookAt(point: Vector3, around: number): void {
    const [low, high] = this.box;
    const middle = low.clone().add(high).multiplyScalar(0.5);
    const along = point.clone().sub(middle);
    // From above a little, and never along the vertical, about which the view turns.
    if (along.length() < 1e-6) along.set(-0.55, -1.05, 0.95);
    along.normalize().add(new Vector3(0, -0.05, 0.2)).normalize();
    const distance = (1.25 * around) / Math.tan((this.camera.fov * Math.PI) / 360);
    this.controls.target.copy(point);
    this.camera.position.copy(point).addScaledVector(along, distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20 + 20 * high.distanceTo(low);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.fitted = null;
    this.draw();
  }

  /** Where a point of the part is on the screen, in pixels of the page. */
  project(x: number, y: number, z: number): [number, number] {
    this.camera.updateMatrixWorld();
    const p = new Vector3(x, y, z).project(this.camera);
    const box = this.canvas.getBoundingClientRect();
    return [box.left + (0.5 + 0.5 * p.x) * box.width, box.top + (0.5 - 0.5 * p.y) * box.height];
  }

  private ray(event: { clientX: number; clientY: number }): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const caster = new Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(at, this.camera);
    return caster;
  }

  private move(event: PointerEvent): void {
    if (event.buttons !== 0) return;
    const isWaiting = this.pointer !== null;
    this.pointer = { x: event.clientX, y: event.clientY };
    if (isWaiting) return;
    requestAnimationFrame(() => {
      const at = this.pointer;
      this.pointer = null;
      if (!at) return;
      if (this.isPartShown) this.hoverPart(at.x, at.y);
      else this.hover(this.beadAt(at.x, at.y));
    });
  }

  /** The record of the bead at a place of the page, or -1. */
  beadAt(clientX: number, clientY: number): number {
    const beads = this.beads;
    if (!beads) return -1;
    const { origin, direction } = this.ray({ clientX, clientY }).ray;
    const { low, high } = this.shown;
    const [first, last] = [(this.material.uniforms.range!.value as Vector2).x, (this.material.uniforms.range!.value as Vector2).y];
    if (last - first > HOVER_RECORDS || Math.abs(direction.z) < 1e-6) return -1;
    // Layers in the order in which the ray meets them.
    const isFromAbove = direction.z < 0;
    for (let k = 0; k <= high - low; k++) {
      const layer = isFromAbove ? high - k : low + k;
      const t = (beads.index.layers[layer]!.z_mm - origin.z) / direction.z;
      if (t <= 0) continue;
      const found = beads.under(layer, origin.x + t * direction.x, origin.y + t * direction.y, first, last, (kind) => this.isShown(kind));
      if (found >= 0) return found;
    }
    return -1;
  }

  setGesture(gesture: Gesture): void {
    this.gesture = gesture;
    // A split takes clicks, and the view may be turned between them.
    this.controls.enabled = gesture === "turn" || gesture === "split";
    this.canvas.style.cursor = gesture === "turn" ? "" : "crosshair";
  }
  get dragging(): Gesture { return this.gesture; }

  /** Drags that choose faces: a box, whose faces lie wholly in it, or a brush, which takes all that it touches. */
  private dragFaces(): void {
    const rubber = document.createElement("div");
    rubber.id = "rubber";
    rubber.hidden = true;
    this.canvas.after(rubber);
    let [from, last]: [PointerEvent | null, PointerEvent | null] = [null, null];
    const box = (event: PointerEvent) => ({ left: Math.min(from!.clientX, event.clientX), top: Math.min(from!.clientY, event.clientY), right: Math.max(from!.clientX, event.clientX), bottom: Math.max(from!.clientY, event.clientY) });
    this.canvas.addEventListener("pointerdown", (event) => {
      if (this.gesture === "turn" || this.gesture === "split" || !this.isPartShown || event.button !== 0) return;
      from = last = event;
      this.canvas.setPointerCapture(event.pointerId);
      if (this.gesture === "paint") this.onPaint(this.trianglesAt(event.clientX, event.clientY));
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from || !last || !this.part) return;
      if (this.gesture === "box") {
        const { left, top, right, bottom } = box(event);
        const own = this.canvas.getBoundingClientRect();
        rubber.hidden = false;
        Object.assign(rubber.style, { left: `${left - own.left}px`, top: `${top - own.top}px`, width: `${right - left}px`, height: `${bottom - top}px` });
      } else {
        const n = Math.ceil(Math.hypot(event.clientX - last.clientX, event.clientY - last.clientY) / BRUSH_STEP);
        const touched = new Set<number>();
        const isPaint = this.gesture === "paint";
        for (let k = 0; k <= n; k++) {
          const [x, y] = [last.clientX + ((event.clientX - last.clientX) * k) / Math.max(n, 1), last.clientY + ((event.clientY - last.clientY) * k) / Math.max(n, 1)];
          for (const found of isPaint ? this.trianglesAt(x, y) : [this.part.faceAt(this.rayAt(x, y))]) touched.add(found);
        }
        touched.delete(-1);
        if (isPaint) this.onPaint([...touched]); else this.onPickFaces([...touched]);
      }
      last = event;
    });
    const end = (event: PointerEvent) => {
      if (from && this.part && !rubber.hidden && event.type === "pointerup") {
        const { left, top, right, bottom } = box(event);
        const own = this.canvas.getBoundingClientRect();
        const x = (v: number) => (2 * (v - own.left)) / own.width - 1;
        const y = (v: number) => 1 - (2 * (v - own.top)) / own.height;
        this.camera.updateMatrixWorld();
        this.onPickFaces(this.part.facesIn(new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse), [x(left), y(bottom), x(right), y(top)]));
      }
      if (from && this.gesture === "paint") this.onPaintEnd();
      rubber.hidden = true;
      from = last = null;
    };
    this.canvas.addEventListener("pointerup", end);
    this.canvas.addEventListener("pointercancel", end);
  }

  /** Triangles of the part within the brush at a place of the page. */
  private trianglesAt(x: number, y: number): number[] {
    const places = [[0, 0], ...Array.from({ length: 8 }, (_, k) => [PAINT_PX * Math.cos((k * Math.PI) / 4), PAINT_PX * Math.sin((k * Math.PI) / 4)])];
    const found = places.map(([dx, dy]) => this.part?.search.first(this.rayAt(x + dx!, y + dy!))?.triangle ?? -1);
    return [...new Set(found)].filter((t) => t >= 0);
  }

  private hoverPart(clientX: number, clientY: number): void {
    const begun = performance.now();
    const face = this.part?.faceAt(this.rayAt(clientX, clientY)) ?? -1;
    this.setHovered(face);
    this.onFace(face, { clientX, clientY });
    performance.measure("hover", { start: begun });
  }

  /** Lights a face; -1 for none. */
  setHovered(face: number): void {
    if (!this.part || this.part.hovered === face) return;
    this.part.hovered = face;
    this.draw();
  }

  private hover(record: number): void {
    if (this.material.uniforms.hovered!.value === record) return;
    this.material.uniforms.hovered!.value = record;
    this.onHover(record >= 0 && this.beads ? this.beads.bead(record) : null);
    this.draw();
  }

  private pick(event: PointerEvent): void {
    if (this.part && this.isPartShown) {
      if (this.gesture === "paint") return;
      if (this.gesture === "split") { this.onSplit(event); return; }
      this.onPickFace(this.part.faceAt(this.ray(event).ray), event.shiftKey || this.gesture !== "turn");
      return;
    }
    if (!this.picking || !this.beads) return;
    const { origin, direction } = this.ray(event).ray;
    const [low, high] = this.box;
    let best: [number, Side] | null = null;
    for (const axis of ["x", "y", "z"] as const) {
      if (Math.abs(direction[axis]) < 1e-9) continue;
      const isLow = direction[axis] > 0;
      const t = ((isLow ? low : high)[axis] - origin[axis]) / direction[axis];
      // The box is entered through the last of the planes that face the eye.
      if (!best || t > best[0]) best = [t, `${axis}${isLow ? "-" : "+"}` as Side];
    }
    if (!best) return;
    const hit = origin.clone().addScaledVector(direction, best[0]);
    const slack = 0.05 * high.distanceTo(low);
    const isInside = (["x", "y", "z"] as const).every((axis) => hit[axis] > low[axis] - slack && hit[axis] < high[axis] + slack);
    if (isInside) this.onPick(best[1]);
  }

  /** The two corners of a slab at a side of the part. */
  private slab(side: Side, depth_mm: number): Box {
    const [low, high] = this.box;
    return slabOf([low.toArray(), high.toArray()], side, depth_mm);
  }

  /** Draws where the part is held and loaded. */
  setPlaces(slabs: Slab[]): void {
    empty(this.places);
    const [low, high] = this.box;
    const reach = 0.22 * high.distanceTo(low);
    for (const { side, depth_mm, colour, arrow } of slabs) {
      const [a, b] = this.slab(side, depth_mm);
      const size = [0, 1, 2].map((k) => Math.max(b[k]! - a[k]!, 0.05) + 0.6) as [number, number, number];
      const shape = new BoxGeometry(...size);
      const middle = new Vector3(...([0, 1, 2].map((k) => 0.5 * (a[k]! + b[k]!)) as [number, number, number]));
      const face = new Mesh(shape, new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.34, depthWrite: false }));
      const edges = new LineSegments(new EdgesGeometry(shape), new LineBasicMaterial({ color: colour }));
      face.position.copy(middle);
      edges.position.copy(middle);
      this.places.add(face, edges);
      if (arrow) this.places.add(arrowMesh(middle, new Vector3(...arrow), reach, colour));
    }
    this.draw();
  }

  /** Takes what broke; null takes it away. It is drawn by `showCrack`. */
  setCrack(crack: Crack | null): void {
    empty(this.broken);
    const u = this.material.uniforms;
    (u.breaks!.value as Texture | null)?.dispose();
    u.breaks!.value = null;
    if (crack && crack.cells.length > 0) {
      const { cells, order, size_mm, angle_rad } = crack;
      const geometry = new InstancedBufferGeometry();
      // Elements of a plate are as high as the plate; they are drawn so.
      const box = new BoxGeometry(...size_mm);
      box.rotateZ(angle_rad);
      geometry.index = box.index;
      geometry.setAttribute("position", box.getAttribute("position"));
      geometry.setAttribute("normal", box.getAttribute("normal"));
      const buffer = new InstancedInterleavedBuffer(cells, CELL);
      geometry.setAttribute("cell", new InterleavedBufferAttribute(buffer, 4, 0));
      geometry.setAttribute("broke", new InterleavedBufferAttribute(buffer, 1, 4));
      geometry.setAttribute("order", new InstancedBufferAttribute(order, 1));
      geometry.instanceCount = cells.length / CELL;
      const material = new ShaderMaterial({
        glslVersion: GLSL3, transparent: true, depthTest: false, uniforms: { state: u.state!, colours: u.colours!, byOrder: { value: false } },
        vertexShader: `in vec4 cell; in float broke; in float order; uniform float state; out float lost; out float rank; out float shade;
void main() { lost = cell.w; rank = order; shade = 0.8 + 0.2 * normal.z + 0.1 * normal.x; gl_Position = broke > state ? vec4(2.0, 2.0, 2.0, 0.0) : projectionMatrix * viewMatrix * vec4(cell.xyz + position, 1.0); }`,
        fragmentShader: `in float lost; in float rank; in float shade; out vec4 result; uniform sampler2D colours; uniform bool byOrder;
void main() { result = byOrder ? vec4(texture(colours, vec2(clamp(rank, 0.002, 0.998), 0.5)).rgb * shade, 0.85) : vec4(mix(vec3(0.98, 0.72, 0.18), vec3(0.80, 0.05, 0.06), lost) * shade, 0.35 + 0.5 * lost); }`,
      });
      const mesh = new Mesh(geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = 2;
      this.broken.add(mesh);
      // Beads ask by place: a texture over the elements, in the directions of their grid.
      const own = new Matrix4().makeRotationZ(-angle_rad);
      const [low, high] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
      const at = (k: number) => new Vector3().fromArray(cells, CELL * k).applyMatrix4(own);
      for (let k = 0; k < order.length; k++) { low.min(at(k)); high.max(at(k)); }
      const size = new Vector3(...size_mm);
      const n = high.sub(low).divide(size).round().addScalar(1);
      const data = new Float32Array(2 * n.x * n.y * n.z);
      for (let k = 0; k < order.length; k++) {
        const g = at(k).sub(low).divide(size).round();
        data.set([cells[CELL * k + 4]! + 1, order[k]!], 2 * (g.x + n.x * (g.y + n.y * g.z)));
      }
      const breaks = new Data3DTexture(data, n.x, n.y, n.z);
      breaks.format = RGFormat;
      breaks.type = FloatType;
      breaks.unpackAlignment = 1;
      breaks.minFilter = breaks.magFilter = NearestFilter;
      breaks.needsUpdate = true;
      u.breaks!.value = breaks;
      const whole = n.multiply(size);
      (u.breaksFrom!.value as Matrix4).makeScale(1 / whole.x, 1 / whole.y, 1 / whole.z).multiply(new Matrix4().makeTranslation(low.addScaledVector(size, -0.5).negate())).multiply(own);
    }
    this.showCrack(null, 0);
  }

  /** Draws what is broken in a state of the test; null hides it. */
  showCrack(by: CrackBy | null, state: number): void {
    const u = this.material.uniforms;
    u.state!.value = state;
    const mesh = this.broken.children[0] as Mesh<BufferGeometry, ShaderMaterial> | undefined;
    if (mesh) { mesh.visible = by === "lost" || by === "order"; mesh.material.uniforms.byOrder!.value = by === "order"; }
    u.ghost!.value = by === "lost" || by === "order" ? 0.82 : 0;
    if (by === "beads" && u.breaks!.value) this.compile(BY_BREAK);
    this.draw();
  }
}

function arrowMesh(at: Vector3, direction: Vector3, length: number, colour: number): Group {
  const arrow = new Group();
  const material = new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true });
  const shaft = new Mesh(new CylinderGeometry(length * 0.03, length * 0.03, length * 0.75), material);
  const tip = new Mesh(new ConeGeometry(length * 0.09, length * 0.25, 20), material);
  shaft.position.y = length * 0.375;
  tip.position.y = length * 0.875;
  arrow.add(shaft, tip);
  arrow.position.copy(at);
  arrow.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), direction.clone().normalize()));
  arrow.renderOrder = 3;
  arrow.children.forEach((c) => (c.renderOrder = 3));
  return arrow;
}

function empty(group: Group): void {
  group.traverse((child) => {
    const mesh = child as Mesh;
    mesh.geometry?.dispose();
    // The material of beads is shared and stays.
    if (mesh.material && !Array.isArray(mesh.material) && !("firstRecord" in ((mesh.material as ShaderMaterial).uniforms ?? {}))) mesh.material.dispose();
  });
  group.clear();
}

function texture(data: Float32Array<ArrayBuffer>, width: number, height: number, format: typeof RGBAFormat | typeof RedFormat): DataTexture {
  const made = new DataTexture(data, width, height, format, FloatType);
  made.minFilter = made.magFilter = NearestFilter;
  made.needsUpdate = true;
  return made;
}

function palette(colour: (t: number) => [number, number, number]): DataTexture {
  const made = new DataTexture(table(colour), 256, 1, RGBAFormat);
  made.minFilter = made.magFilter = NearestFilter;
  made.needsUpdate = true;
  return made;
}

export const toColour = (text: string) => new Color(text).getHex();
