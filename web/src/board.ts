// A photograph of a board over the view, with its four corners to drag.

import { el, fixed, svg } from "./dom";

export type Point = [number, number];
const NAMES = ["Upper left", "Upper right", "Lower right", "Lower left"];
/** Radius of the ring about a corner, pixels of the screen. Source: chosen; wide enough for a finger. */
const RING_PX = 11;
const STEPS: Record<string, Point> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class BoardPicture {
  readonly element = el("div", { id: "photo", hidden: true });
  private size: Point | null = null;
  private address = "";
  /** The corners of the job; null where it states none, so that the whole picture is the board. */
  private stated: Point[] | null = null;
  /** The corners as they are drawn: those stated, or those of the picture. */
  private corners: Point[] = [];
  private readonly image = el("img", { alt: "The photograph of the board" });
  private readonly outline = svg("polygon", {});
  private readonly rings: SVGElement[];
  private readonly drawing: SVGSVGElement;

  /** `moved` is told when a corner was let go of. */
  constructor(private readonly moved: (corners: Point[]) => void, private readonly failed: (message: string) => void) {
    this.rings = NAMES.map((_, k) => this.ring(k));
    this.drawing = svg("svg", {}, this.outline, ...this.rings) as SVGSVGElement;
    this.element.append(this.image, this.drawing);
    this.image.addEventListener("load", () => { this.size = [this.image.naturalWidth, this.image.naturalHeight]; this.draw(); });
    this.image.addEventListener("error", () => this.failed("The photograph cannot be shown here; it is read from its file all the same."));
    new ResizeObserver(() => this.draw()).observe(this.element);
  }

  /** Shows the picture of an address with these corners. */
  show(address: string, corners: Point[] | null): void {
    this.stated = corners;
    if (address !== this.address) { this.size = null; this.address = address; this.image.src = address; }
    this.draw();
  }

  private draw(): void {
    this.drawing.toggleAttribute("hidden", this.size === null);
    if (!this.size) return;
    const [w, h] = this.size;
    this.corners = this.stated ?? [[0, 0], [w, 0], [w, h], [0, h]];
    this.drawing.setAttribute("viewBox", `0 0 ${w} ${h}`);
    this.outline.setAttribute("points", this.corners.map((p) => p.join(",")).join(" "));
    const scale = this.drawing.getScreenCTM()?.a ?? 1;
    this.rings.forEach((ring, k) => {
      const [x, y] = this.corners[k]!;
      ring.setAttribute("cx", String(x));
      ring.setAttribute("cy", String(y));
      ring.setAttribute("r", String(RING_PX / Math.max(scale, 1e-6)));
      ring.setAttribute("aria-label", `${NAMES[k]} corner of the board: ${fixed(x, 1)}, ${fixed(y, 1)} px`);
    });
  }

  /** Moves a corner; it stays in the picture. */
  private put(k: number, [x, y]: Point): void {
    if (!this.size) return;
    const within = (v: number, most: number) => Number(fixed(Math.min(Math.max(v, 0), most), 1));
    this.stated = this.corners.map((p, i) => (i === k ? [within(x, this.size![0]), within(y, this.size![1])] : p));
    this.draw();
  }

  private ring(k: number): SVGElement {
    const ring = svg("circle", { class: "corner", tabindex: 0, role: "button", "data-corner": k });
    let from: { at: Point; corner: Point } | null = null;
    // A place of the screen in pixels of the picture.
    const inPicture = (event: PointerEvent): Point => {
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.drawing.getScreenCTM()!.inverse());
      return [p.x, p.y];
    };
    ring.addEventListener("pointerdown", (event) => {
      from = { at: inPicture(event), corner: this.corners[k]! };
      ring.setPointerCapture(event.pointerId);
      ring.focus();
      event.preventDefault();
    });
    ring.addEventListener("pointermove", (event) => {
      if (!from) return;
      const at = inPicture(event);
      this.put(k, [from.corner[0] + at[0] - from.at[0], from.corner[1] + at[1] - from.at[1]]);
    });
    const end = () => { if (from && this.stated) this.moved(this.stated); from = null; };
    ring.addEventListener("pointerup", end);
    ring.addEventListener("pointercancel", end);
    ring.addEventListener("keydown", (event) => {
      const step = STEPS[event.key];
      if (!step) return;
      const pace = event.shiftKey ? 10 : 1;
      this.put(k, [this.corners[k]![0] + pace * step[0], this.corners[k]![1] + pace * step[1]]);
      if (this.stated) this.moved(this.stated);
      // The arrows move no layers meanwhile.
      event.preventDefault();
      event.stopPropagation();
    });
    return ring;
  }
}
