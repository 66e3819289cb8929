// Making elements.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | ((event: Event) => void) | undefined>;

/** An element with attributes (`on...` are listeners) and children. Text is never read as markup. */
export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  set(made, attributes);
  for (const child of children) if (child) made.append(child);
  return made;
}

/** The same for SVG. */
export function svg(tag: string, attributes: Attributes = {}, ...children: Child[]): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  set(made, attributes);
  for (const child of children) if (child) made.append(child);
  return made;
}

function set(made: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === "function") made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value === true ? "" : String(value));
  }
}

/** The element of the page with this id. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}

/**
 * Makes a button play a slider from where it is to its end, all of it in so many seconds; pressed again, it stops. At the end
 * it begins at `from()`.
 */
export function player(button: HTMLElement, slider: HTMLInputElement, seconds: number, label: string, from: () => string, each: () => void): () => void {
  let frame = 0;
  const show = (isPlaying: boolean) => { button.textContent = isPlaying ? "⏸" : "▶"; button.setAttribute("aria-label", isPlaying ? "Pause" : label); };
  const stop = () => { cancelAnimationFrame(frame); frame = 0; show(false); };
  show(false);
  return () => {
    if (frame) { stop(); return; }
    if (slider.value === slider.max) slider.value = from();
    show(true);
    const n = Number(slider.max);
    let at = Number(slider.value);
    let before = performance.now();
    const step = (now: number) => {
      at += ((now - before) / (1000 * seconds)) * n;
      before = now;
      slider.value = String(Math.min(Math.round(at), n));
      each();
      if (at >= n || !slider.isConnected) stop(); else frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
  };
}

/** A number with so many digits after the point. */
export function fixed(value: number, digits: number): string {
  return value.toFixed(digits);
}

/** A time in words. */
export function duration(seconds: number): string {
  if (seconds < 90) return `${fixed(seconds, 1)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** A size in words. */
export function size(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  if (bytes < 1e6) return `${fixed(bytes / 1e3, 1)} kB`;
  return bytes < 1e9 ? `${fixed(bytes / 1e6, 1)} MB` : `${fixed(bytes / 1e9, 2)} GB`;
}
