// The viewer of notebooks: the studio's view of a program as an anywidget. Its data are traits of `grainpath.viewer`.

import type { Index } from "./api";
import { Beads } from "./beads";
import { CLASS_COLOURS, COLOUR_BY, type ColourBy } from "./colours";
import { el } from "./dom";
import styles from "./notebook.css";
import { beadWords, legend, look, scaleOf, swatch, wordsOfLayer } from "./sight";
import { Viewer } from "./viewer";

/** What the notebook sends. Layers and colours go both ways. */
interface Traits { _index: Index; _records: DataView; _angles: DataView; color: string; layers: [number, number]; height_px: number }
/** The part of an anywidget's model that is used here. */
interface Model {
  get<K extends keyof Traits>(name: K): Traits[K];
  set<K extends keyof Traits>(name: K, value: Traits[K]): void;
  save_changes(): void;
  on(event: string, then: () => void): void;
  off(event: string, then: () => void): void;
}

/** Ways of colouring whose names in Python are other ones. */
const NAMES: Partial<Record<ColourBy, string>> = { load: "direction" };
const nameOf = (by: ColourBy) => NAMES[by] ?? by;
const VIEWS = ["Top", "Front", "Side", "Oblique"];
const TRAVEL = CLASS_COLOURS.length - 1;

const bytes = (data: DataView) => data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength) as ArrayBuffer;

/** Whether what lies behind an element is dark; as the browser prefers where nothing there has a colour. */
function isOnDark(element: Element): boolean {
  for (let at: Element | null = element; at; at = at.parentElement) {
    const [r = 0, g = 0, b = 0, alpha = 1] = (getComputedStyle(at).backgroundColor.match(/[\d.]+/g) ?? []).map(Number);
    // The luma of ITU-R BT.601.
    if (alpha > 0.5) return 0.299 * r + 0.587 * g + 0.114 * b < 128;
  }
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

function render({ model, el: host }: { model: Model; el: HTMLElement }): () => void {
  const index = model.get("_index");
  const last = index.layers.length - 1;
  const hasAngles = model.get("_angles").byteLength > 0;
  const range = (words: string) => el("input", { type: "range", min: 0, max: last, "aria-label": words });
  const [high, low] = [range("Highest layer shown"), range("Lowest layer shown")];
  const [highest, lowest, readout, rows] = [el("output"), el("output"), el("div", { id: "bead", role: "status", hidden: true }), el("div", { id: "legend" })];
  const colourings = COLOUR_BY.filter(([by]) => by !== "time" && by !== "reserve" && (by !== "load" || hasAngles));
  const colour = el("select", { "aria-label": "Colour by" }, ...colourings.map(([by, words]) => el("option", { value: nameOf(by) }, words)));
  const canvas = el("canvas", { tabindex: 0, "aria-label": "Toolpaths in three dimensions. Drag to turn; click, then scroll to zoom. Keys: A D W S turn, plus and minus zoom, 1 to 4 choose the side, arrow keys up and down layers." });
  const stage = el("div", { id: "stage" }, canvas,
    el("div", { id: "left" },
      el("div", { id: "views", role: "group", "aria-label": "Direction of view" }, ...VIEWS.map((name) => el("button", { type: "button", onclick: () => viewer.view(name.toLowerCase()) }, name)), colour),
      rows),
    readout, el("div", { id: "layers" }, highest, el("div", { class: "double" }, high, low), lowest));
  const root = host.shadowRoot ?? host.attachShadow({ mode: "open" });
  root.replaceChildren(el("style", {}, styles), stage);
  // JupyterLab would take letters for commands on cells.
  host.setAttribute("data-lm-suppress-shortcuts", "true");
  stage.style.height = `${model.get("height_px")}px`;

  let viewer: Viewer;
  try {
    viewer = new Viewer(canvas);
  } catch {
    stage.replaceChildren(el("p", { role: "alert" }, "This browser shows no WebGL 2, so there is no view in three dimensions."));
    return () => {};
  }
  const beads = new Beads(index);
  viewer.show(beads);
  beads.take(0, last, bytes(model.get("_records")));
  if (hasAngles) beads.takeValues("angles", 0, last, bytes(model.get("_angles")));

  const colourBy = () => colourings.find(([by]) => nameOf(by) === model.get("color"))![0];
  const recolour = () => {
    const by = colourBy();
    colour.value = nameOf(by);
    viewer.setColour(by, scaleOf(index, by));
    if (by !== "role") { rows.replaceChildren(...legend(index, by)); return; }
    rows.replaceChildren(...index.classes.flatMap((name, k) => {
      if (k !== TRAVEL && !index.shares[k]!.beads) return [];
      const box = el("input", { type: "checkbox", checked: viewer.isShown(k), onchange: () => viewer.setShown(k, box.checked) });
      return [el("label", {}, box, swatch(CLASS_COLOURS[k]!), name)];
    }));
  };
  const show = () => {
    const [from, to] = model.get("layers");
    [low.value, high.value] = [String(from), String(to)];
    for (const [told, input, k] of [[highest, high, to], [lowest, low, from]] as const) {
      told.textContent = wordsOfLayer(index, k);
      input.setAttribute("aria-valuetext", told.textContent.replace("\n", " at "));
    }
    viewer.setRange({ low: from, high: to, from: 0, to: Math.max(index.layers[to]!.records - 1, 0) });
  };
  /** Neither end passes the other. */
  const move = (input: HTMLInputElement, to: number) => {
    const at = Math.min(Math.max(to, 0), last);
    const [a, b] = model.get("layers");
    model.set("layers", input === low ? [at, Math.max(at, b)] : [Math.min(at, a), at]);
    show();
  };
  const choose = (by: ColourBy) => { model.set("color", nameOf(by)); recolour(); model.save_changes(); };
  for (const input of [high, low]) {
    input.addEventListener("input", () => move(input, Number(input.value)));
    // Python hears of the end of a drag, and not of each step.
    input.addEventListener("change", () => model.save_changes());
  }
  colour.addEventListener("change", () => choose(colourings[colour.selectedIndex]![0]));

  stage.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || ["INPUT", "SELECT"].includes((event.target as Element).tagName)) return;
    const step = event.shiftKey ? 10 : 1;
    const moves: Record<string, [HTMLInputElement, number]> = { ArrowUp: [high, step], ArrowDown: [high, -step], PageUp: [low, step], PageDown: [low, -step] };
    const moved = moves[event.key];
    if (moved) { move(moved[0], Number(moved[0].value) + moved[1]); model.save_changes(); }
    else if (event.key === "l") { const [a, b] = model.get("layers"); move(low, a === b ? 0 : b); model.save_changes(); }
    else if (event.key === "c") choose(colourings[(colour.selectedIndex + 1) % colourings.length]![0]);
    else if (event.key === "t") { viewer.setShown(TRAVEL, !viewer.isShown(TRAVEL)); recolour(); }
    else if (!look(viewer, event)) return;
    event.preventDefault();
    event.stopPropagation();
  });
  // A page that is scrolled past the view goes on scrolling: the view is zoomed once it was clicked.
  viewer.controls.enableZoom = false;
  stage.addEventListener("focusin", () => (viewer.controls.enableZoom = true));
  stage.addEventListener("focusout", () => (viewer.controls.enableZoom = false));
  viewer.onHover = (bead) => { readout.hidden = bead === null; readout.textContent = bead ? beadWords(index, bead) : ""; };

  const retone = () => { stage.dataset.theme = isOnDark(host) ? "dark" : "light"; };
  const watched = new MutationObserver(retone);
  for (const page of [document.documentElement, document.body]) watched.observe(page, { attributes: true });
  // The element is put into the page after this function, and has a background then.
  const sized = new ResizeObserver(retone);
  sized.observe(stage);
  const preferred = matchMedia("(prefers-color-scheme: dark)");
  preferred.addEventListener("change", retone);
  const resize = () => { stage.style.height = `${model.get("height_px")}px`; };
  const heard = { "change:color": recolour, "change:layers": show, "change:height_px": resize };
  for (const [event, then] of Object.entries(heard)) model.on(event, then);
  recolour();
  show();
  return () => {
    for (const [event, then] of Object.entries(heard)) model.off(event, then);
    watched.disconnect();
    sized.disconnect();
    preferred.removeEventListener("change", retone);
    viewer.clear();
    viewer.controls.dispose();
    // A page has some 16 contexts; one that is no longer shown is given back.
    viewer.renderer.dispose();
    viewer.renderer.forceContextLoss();
  };
}

export default { render };
