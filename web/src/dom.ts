// Making elements.

import type { Warning } from "./api";

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

/** A number as people write it, with a point or a comma before its decimals, as TOML and JavaScript read it; null for other words. */
export function decimal(text: string): string | null {
  const plain = text.trim().replace("−", "-").replace(",", ".");
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(plain) || !Number.isFinite(Number(plain))) return null;
  // TOML wants a digit on both sides of the point, and no zeros before the first.
  return plain.replace(/^([+-]?)0+(?=\d)/, "$1").replace(/^([+-]?)\./, "$10.").replace(/\.(?=e|$)/i, ".0");
}

type Field = HTMLInputElement | HTMLSelectElement;

/** Says below a field what is wrong with it; nothing is run while a field is wrong. An empty sentence takes that back. */
export function complain(field: Field, words: string, above: HTMLElement = field): void {
  if (above.nextElementSibling?.className === "wrong") above.nextElementSibling.remove();
  field.dataset.wrong = words;
  if (!words) { field.removeAttribute("aria-invalid"); return; }
  field.setAttribute("aria-invalid", "true");
  above.after(el("span", { class: "wrong", role: "alert" }, words));
}

interface NumberRule {
  /** Whether numbers of zero and below are wrong. */
  isPositive?: boolean;
  /** Whether the field may be empty; `then` is told NaN. */
  isOptional?: boolean;
  /** Whether `then` is told while a number is typed, and not first when it is entered. */
  isLive?: boolean;
  /** Whether the number is for the eye alone: a wrong one gives way to the last one. */
  isView?: boolean;
}

/** A field for a number. A wrong one is said and told to nobody. */
export function numberField(attributes: Attributes, rule: NumberRule, then: (value: number) => void): HTMLInputElement {
  const enter = (isLive: boolean) => {
    const isEmpty = rule.isOptional && input.value.trim() === "";
    const read = isEmpty ? NaN : Number(decimal(input.value) ?? NaN);
    const isRight = isEmpty || (rule.isPositive ? read > 0 : Number.isFinite(read));
    if (!isRight && rule.isView) { if (!isLive) input.value = input.dataset.shown ?? ""; return; }
    // It is said while it is typed: a line that came or went as the field is left would move the button that is pressed then.
    complain(input, isRight ? "" : `should be a number${rule.isPositive ? " above 0" : ""}, as 2.5`);
    // What was understood is what stands there.
    if (isRight && !isLive) showValue(input, isEmpty ? "" : read);
    if (isRight && (rule.isLive || !isLive)) then(read);
  };
  const input = el("input", { type: "text", inputmode: "decimal", ...attributes, onchange: () => enter(false), oninput: () => enter(true) });
  input.dataset.shown = input.value;
  return input;
}

/** Puts a value into a field. What is wrong there stays to be seen until another value comes. */
export function showValue(field: Field, value: number | string, above: HTMLElement = field): void {
  if (field.dataset.wrong && field.dataset.shown === String(value)) return;
  field.value = field.dataset.shown = String(value);
  complain(field, "", above);
}

/** The number in a field of `numberField`; NaN where there is none. */
export const numberOf = (input: HTMLInputElement): number => Number(decimal(input.value) ?? NaN);

/** A warning of a run: where, what, and what helps. */
export function warning(w: Warning): HTMLElement {
  const { file, line, layer, z_mm, point_mm } = w.place ?? {};
  const z = z_mm === undefined ? "" : `z = ${fixed(z_mm, 2)} mm`;
  const place = [file, line && `line ${line}`, layer ? `layer ${layer}${z && ` at ${z}`}` : z, point_mm && `(${point_mm.map((v) => fixed(v, 2)).join(", ")})`].filter((p) => p).join(", ");
  return el("p", { class: "warning" }, `${place && `${place}: `}${w.text}${w.remedy ? ` – ${w.remedy}` : ""}`);
}

/** Draws what is in a box anew. The focus stays on the control of the same id, and so does what is typed there and not entered yet. */
export function redraw(box: HTMLElement, ...children: (Node | string)[]): void {
  const before = document.activeElement;
  const isTyped = before instanceof HTMLInputElement && box.contains(before) && before.value !== (before.dataset.shown ?? before.value);
  const [typed, from, to] = isTyped ? [before.value, before.selectionStart, before.selectionEnd] : [null, null, null];
  // A browser takes what is typed in a field for entered when the field goes.
  if (isTyped) before.value = before.dataset.shown!;
  box.replaceChildren(...children);
  const after = before?.id && document.activeElement !== before ? document.getElementById(before.id) : null;
  if (!after || !box.contains(after)) return;
  after.focus({ preventScroll: true });
  if (typed === null || !(after instanceof HTMLInputElement)) return;
  after.value = typed;
  after.setSelectionRange(from, to);
  // What a script has put there, no browser takes for entered.
  after.addEventListener("blur", () => { if (after.value !== after.dataset.shown) after.dispatchEvent(new Event("change")); }, { once: true });
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

/** Decimals with which a number has three digits that count; digits before the point are never cut. */
function decimals(value: number): number {
  const power = Number(value.toExponential(2).split("e")[1]);
  return value === 0 ? 0 : Math.min(Math.max(2 - power, 0), 9);
}

/** A number with three digits that count, as the command line tells stresses. */
export function threeDigits(value: number): string { return value.toFixed(decimals(value)); }

/** Numbers of one kind, with as many decimals as the greatest of them has with three digits, and at least some. */
export function alike(values: number[], least = 0): string[] {
  const most = Math.max(decimals(Math.max(...values.map(Math.abs))), least);
  // A number that is rounded to zero has no sign.
  return values.map((v) => (Number(v.toFixed(most)) + 0).toFixed(most));
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
