// The page: what is open, the steps beside the view, and the keys.

import * as api from "./api";
import { Beads, TRAVEL, type Bead, type Value } from "./beads";
import { chooser } from "./chooser";
import { COLOUR_BY, CLASS_COLOURS, MARK_COLOURS, type ColourBy } from "./colours";
import { byId, duration, el, fixed, player, redraw, warning } from "./dom";
import { drafts, forget } from "./drafts";
import { history } from "./history";
import { howFar } from "./queue";
import { beadWords, legend, look, scaleOf, swatch, wordsOfLayer } from "./sight";
import { Plain } from "./plain";
import { JobPanel } from "./job";
import { absolute } from "./paths_of_job";
import { LoadsPanel } from "./loads";
import { ShapePanel, plainNumber } from "./shape";
import { StrengthPanel } from "./strength";
import { set } from "./toml";
import { Tour } from "./tour";
import { Viewer } from "./viewer";

/** Records that are asked for at a time: 512 kB on the wire. */
const BATCH_RECORDS = 65_536;

const canvas = byId<HTMLCanvasElement>("view");
const welcome = byId("welcome");
let viewer: Viewer | null = null;
/** Low and high corner of what the program on screen prints. */
let printed: [number[], number[]] | null = null;
let loading: AbortController | null = null;
let current = 0;
/** The run whose program is in the view. */
let onScreen = 0;
let colourBy: ColourBy = "role";
const plain = new Plain(() => viewer !== null);
/** The program of the pictures that the server draws. */
let pictured: { id: number; index: api.Index } | null = null;

/** What is open: a program, a job or a mesh, and the program that is on screen. */
export interface Open { path: string; kind: api.FileKind; name: string }
let opened: Open | null = null;
/** Is aborted once another file is opened: answers to what was asked for the one before are not shown any more. */
let opening = new AbortController();
let roots: string[] = [];
/** The folder that runs are written to. */
let work = "";

const high = byId<HTMLInputElement>("high");
const low = byId<HTMLInputElement>("low");
const from = byId<HTMLInputElement>("from");
const to = byId<HTMLInputElement>("to");

const job = new JobPanel(byId("panel-job"), { run, say, renamed: (path) => entitle(path, "job") });
const strength = new StrengthPanel(byId("panel-strength"), { run, say, viewer: () => viewer, printed: () => printed, job: () => job.wanted(), showPaths: () => tab("paths"), show: (id) => show(id), recolour: () => setColour(colourBy), compare: () => void runs(2) });
const shape: ShapePanel = new ShapePanel(byId("panel-shape"), { run, say, viewer: () => viewer, job, openLoads: () => tab("loads"), turning: () => loads.turning() });
const loads: LoadsPanel = new LoadsPanel(byId("panel-loads"), { run, say, viewer: () => viewer, job, shape, pictured: (address, words) => plain.take("part", address, words), test: () => { tab("strength"); void strength.testJob(); } });
job.onText = (text) => { if (text !== null) { shape.textChanged(text); loads.textChanged(); loads.chosenChanged(); shape.showPoses(loads.inFile()); } };
shape.onPart = (run) => { if (run !== null) plain.take("part", `v1/jobs/${run}/picture`, "The part from in front and from behind; faces have their numbers in the list."); loads.partChanged(); shape.showPoses(loads.inFile()); overlays(); };
shape.onChosen = () => { shape.chosenChanged(); loads.chosenChanged(); };

// ---- messages --------------------------------------------------------------------------------------------------

function say(message: string, isError = false): void {
  const box = byId("progress");
  box.replaceChildren(el("span", isError ? { class: "error", role: "alert" } : {}, message), el("button", { type: "button", onclick: unsay }, "Close"));
  box.hidden = false;
}

/** How far the runs are that go on, the one that was begun last at the end. */
const going: HTMLElement[][] = [];

/** Takes the message away; a run that goes on is seen again, with its button. */
function unsay(): void {
  const [box, last] = [byId("progress"), going.at(-1)];
  if (last) box.replaceChildren(...last);
  box.hidden = !last;
}

/** Begins a run, shows how far it is, and gives its state at the end; null where it failed or was cancelled, which is said
 * unless it is `outdated`, and where another file is open by then. */
async function run(wanted: Record<string, unknown>, outdated?: AbortSignal): Promise<api.JobState | null> {
  // A field that shows what the text does not hold would be taken for what is run.
  const field = wanted.kind === "view" || wanted.kind === "shape" ? null : document.querySelector<HTMLInputElement>("[aria-invalid]");
  if (field) { say(`Nothing was run: ${field.labels?.[0]?.firstChild?.textContent || field.id} is ${field.value || "empty"} and ${field.dataset.wrong}`, true); return null; }
  const { signal } = opening;
  try {
    // What runs is what is shown: a part that has changed on the disk is shown first.
    if (wanted.kind !== "view" && wanted.kind !== "shape" && wanted.program === undefined && (await shape.readAnew())) return null;
    const end = await watch(await api.begin(wanted), outdated, signal);
    if (!end || !signal.aborted) return end;
    if (isKept(end)) say(`${end.title} is done. Another file is open by now; Runs, above, opens it.`);
  } catch (error) {
    say((error as Error).message, true);
  }
  return null;
}

/** Whether the studio keeps what comes of a run, so that it is looked for later: plans and tests. */
const isKept = ({ kind }: Pick<api.JobState, "kind">): boolean => kind === "plan" || kind === "strength";

/** Keeps in this tab which plan or test the page follows, so that the page finds it when it is loaded anew, also where the run has
 * ended by then. */
function keepFollowed(run: api.JobState): void {
  if (!isKept(run)) return;
  try { sessionStorage.setItem("followed", JSON.stringify({ id: run.id, kind: run.kind, title: run.title })); } catch { /* The page still finds runs that go on. */ }
}

/** Forgets a run whose end the page has seen; another one that was begun since stays. */
function forgetFollowed(run: api.JobState): void {
  if (followed()?.id === run.id) sessionStorage.removeItem("followed");
}

/** The plan or test that the page followed last and whose end it has not seen. */
function followed(): Pick<api.JobState, "id" | "kind" | "title"> | null {
  try { return JSON.parse(sessionStorage.getItem("followed") ?? "null") as Pick<api.JobState, "id" | "kind" | "title"> | null; } catch { return null; }
}

/** Shows how far a run is that was begun, here or before the page was loaded, and gives its state at the end as `run` does.
 * Its first layers come on screen unless `signal` says that another file is open by then. */
async function watch(begun: api.JobState, outdated: AbortSignal | undefined, signal: AbortSignal): Promise<api.JobState | null> {
  try {
    const cancel = () => void api.cancel(begun.id).catch((e: Error) => say(e.message, true));
    if (outdated?.aborted) { cancel(); return null; }
    outdated?.addEventListener("abort", cancel);
    const words = el("span");
    const bar = el("progress", { "aria-label": "Progress" });
    const stop = el("button", { type: "button", onclick: cancel }, "Cancel");
    const told = [words, bar, stop];
    going.push(told);
    unsay();
    keepFollowed(begun);
    const shown = Date.now();
    const since = setInterval(() => tell(), 200);
    let last = begun;
    let asked = 0;
    let early: Promise<void> = Promise.resolve();
    const tell = () => {
      const seconds = fixed((Date.now() - shown) / 1000, 1);
      words.textContent = `${howFar(last)} · ${seconds} s`;
      if (last.total > 0) { bar.max = last.total; bar.value = last.done; } else bar.removeAttribute("value");
    };
    tell();
    const end = await api.follow(begun.id, (now) => {
      last = now;
      tell();
      // The first layers come on screen while the others are planned, and all while they are measured and drawn.
      if (now.kind === "plan" && now.phase === "running" && now.ready > asked && !signal.aborted && active !== "strength" && (asked === 0 || current === now.id)) {
        asked = now.ready;
        // What does not come is asked for once more when the run is done; layers of a run that is cancelled are no fault.
        early = show(now.id, false).catch(() => { onScreen = 0; });
      }
    }).finally(() => { clearInterval(since); outdated?.removeEventListener("abort", cancel); going.splice(going.indexOf(told), 1); });
    forgetFollowed(begun);
    // A message that came while the run went on stays until the user closes it.
    if (words.isConnected) unsay();
    if (outdated?.aborted) return null;
    if (end.phase === "failed") say(end.error ?? "the run failed", true);
    if (end.phase === "cancelled") say("Cancelled. Nothing was changed.");
    // The first layers are on screen before what follows asks for the rest: numbers and angles are added to them.
    if (end.phase === "done") await early;
    return end.phase === "done" ? end : null;
  } catch (error) {
    say((error as Error).message, true);
    return null;
  }
}

// ---- opening ---------------------------------------------------------------------------------------------------

/** Whether the user knows that there is no view in three dimensions. */
let isTold = false;
function ensureViewer(): Viewer | null {
  if (viewer) return viewer;
  try {
    viewer = new Viewer(canvas);
  } catch {
    if (!isTold) say("This browser shows no WebGL 2, so the studio draws still pictures. Numbers and files are all here.");
    isTold = true;
    return null;
  }
  viewer.onHover = tellBead;
  viewer.onPick = (side) => strength.pick(side);
  viewer.onFace = (face, at) => tellFace(face, at);
  viewer.onPaint = (triangles) => shape.supports.stroke(triangles);
  viewer.onSplit = (at) => loads.split(at);
  viewer.onPaintEnd = () => shape.supports.strokeEnd();
  viewer.onPickFaces = (faces) => shape.add(faces);
  viewer.onPickFace = (face, isAdded) => shape.choose(face, isAdded);
  return viewer;
}

/** Names the file that is open from now on. */
function entitle(path: string, kind: api.FileKind): Open {
  opened = { path, kind, name: path.split(/[/\\]/).pop() ?? path };
  const root = roots.find((r) => path.startsWith(`${r}/`) || path.startsWith(`${r}\\`));
  byId("title").textContent = root ? path.slice(root.length + 1) : path;
  byId("title").title = path;
  document.title = `${opened.name} – grainpath studio`;
  return opened;
}

/** Opens a file, and tells whether it is still the one that is open. */
async function open(path: string, kind: api.FileKind): Promise<boolean> {
  opening.abort();
  const { signal } = (opening = new AbortController());
  // What is under way for the file before is not shown in this one.
  loading?.abort();
  [current, onScreen] = [0, 0];
  const named = entitle(path, kind);
  welcome.hidden = true;
  plain.clear();
  pictured = null;
  const box = byId("progress");
  unsay();
  viewer?.clear();
  byId("panel-paths").replaceChildren(noPaths());
  job.close();
  shape.close();
  strength.close();
  if (kind === "program") {
    tab("paths");
    const end = await run({ kind: "view", file: path }, signal);
    if (end) await show(end.id).catch((e: Error) => say(e.message, true));
  } else {
    ensureViewer();
    await job.open(named);
    if (signal.aborted) return false;
    strength.forJob();
    const text = job.text();
    const hasShape = text !== null && ShapePanel.has(text);
    tab(hasShape ? "shape" : "job");
    if (hasShape) await shape.load();
    if (signal.aborted) return false;
    // An error of the file counts for more than what came back with it.
    if (job.notice && (box.hidden || !box.querySelector(".error"))) say(job.notice);
  }
  return !signal.aborted;
}

function kindOf(name: string): api.FileKind {
  const ending = name.split(".").pop()?.toLowerCase() ?? "";
  if (ending === "toml") return "job";
  if (["stl", "obj", "ply", "off", "3mf", "step", "stp", "iges", "igs"].includes(ending)) return "mesh";
  if (["svg", "dxf"].includes(ending)) return "outline";
  if (["png", "jpg", "jpeg", "bmp"].includes(ending)) return "photo";
  if (["nrrd", "nhdr", "mhd", "mha", "nii", "tif", "tiff", "dcm"].includes(ending) || /\.nii\.gz$/i.test(name)) return "scan";
  return ["gcode", "gco", "g", "nc", "ngc", "tap", "bgcode"].includes(ending) ? "program" : "other";
}

/** Files that were dropped so far. */
let drops = 0;
async function drop(data: DataTransfer | null): Promise<void> {
  const item = data?.items[0];
  const file = data?.files[0];
  if (item?.webkitGetAsEntry?.()?.isDirectory) {
    say("Folders are not sent through the browser. Press Open… and choose the folder on the server's side; --root DIR adds one.", true);
    return;
  }
  if (!file) return;
  const own = ++drops;
  const { signal } = opening;
  const box = byId("progress");
  const words = el("span");
  box.replaceChildren(words);
  box.hidden = false;
  try {
    const { path } = await api.upload(file, (share) => (words.textContent = `Sending ${file.name}: ${Math.round(100 * share)} %`));
    if (words.isConnected) unsay();
    // A large file may come after one that was chosen later.
    if (own === drops && !signal.aborted) await open(path, kindOf(path));
  } catch (error) {
    say((error as Error).message, true);
  }
}

// ---- the program on screen -------------------------------------------------------------------------------------

/** Shows the program of a run: the index at once, layers as they come, and what was measured once the run is done. Throws
 * what went wrong, unless something else is shown by then. */
async function show(id: number, isDone = true): Promise<void> {
  const view = ensureViewer();
  welcome.hidden = true;
  loading?.abort();
  const own = (loading = new AbortController());
  try { await fetchProgram(id, isDone, view, own.signal); } catch (error) { if (!own.signal.aborted) throw error; }
}

async function fetchProgram(id: number, isDone: boolean, view: Viewer | null, signal: AbortSignal): Promise<void> {
  const before = current === id && onScreen === id ? viewer?.beads ?? null : null;
  current = id;
  const [index, result] = await Promise.all([api.index(id), isDone ? api.result(id) : null]);
  if (signal.aborted) return;
  printed = index.layers.length === 0 ? null : index.part_mm;
  const isProgram = before === null && opened?.kind === "program";
  if (isProgram) void strength.forProgram(opened!.path);
  if (!printed) { say("Nothing is printed in this program.", true); return; }
  const beads = new Beads(index);
  tellPaths(index, result, before === null);
  overlays();
  const last = index.layers.length - 1;
  const isWhole = before === null || high.value === high.max;
  for (const input of [high, low]) input.max = String(last);
  if (before === null) low.value = "0";
  if (isWhole) high.value = String(last);
  // A program of another slicer comes to be broken; one of grainpath, and a plan, to be looked at.
  const first = isProgram && !index.generator?.startsWith("grainpath") ? "strength" : "paths";
  if (!view) {
    pictured = { id, index };
    plain.take("program", `v1/jobs/${id}/picture`, `All ${index.layers.length} layers; the slider shows one.`);
    byId("layer-high").textContent = wordsOfLayer(index, last);
    tab(isProgram ? first : active === "strength" ? "strength" : "paths");
    return;
  }
  const kept = before ? beads.keep(before) : 0;
  view.show(beads, before !== null);
  onScreen = id;
  // Paths come into view with their first layer, not with their last.
  if (before === null) tab(active === "strength" ? "strength" : first);
  setColour(colourBy);
  // The moves that are chosen of a layer stay while further layers come.
  if (isWhole) rangeChanged(); else movesChanged();
  performance.mark("program");
  for (let layer = kept; layer <= last; ) {
    let end = layer;
    // The first answer is one layer, so that something is on screen at once.
    while (layer > 0 && end < last && end - layer < 4000 && beads.first[end + 2]! - beads.first[layer]! < BATCH_RECORDS) end++;
    const bytes = await api.bytes(`v1/jobs/${id}/layers/${layer}-${end}`, signal);
    if (signal.aborted) return;
    beads.take(layer, end, bytes);
    view.refresh(layer, end);
    if (layer === 0) performance.mark("first-layer");
    layer = end + 1;
  }
  if (index.more) return;
  performance.mark("all-layers");
  document.documentElement.dataset.shown = String(id);
  if (result) await loadValues(id, beads, signal, result);
}

/** Numbers and files of a run whose program is on screen already. */
async function tellResult(id: number): Promise<void> {
  const beads = viewer?.beads;
  const own = loading;
  // Only the first layers of a plan that ended soon after may be on screen.
  if (!beads || !own || beads.index.more) { await show(id); return; }
  try {
    const result = await api.result(id);
    if (own.signal.aborted) return;
    tellPaths(beads.index, result, false);
    await loadValues(id, beads, own.signal, result);
  } catch (error) {
    if (!own.signal.aborted) throw error;
  }
}

/** Asks for the angles of all layers to the load and for their reserves, where the result has them. */
async function loadValues(id: number, beads: Beads, signal: AbortSignal, result: api.Result): Promise<void> {
  const last = beads.index.layers.length - 1;
  for (const what of (["angles", "reserve"] as Value[]).filter((what) => result[what])) {
    for (let layer = 0; layer <= last; ) {
      let end = layer;
      while (end < last && end - layer < 4000 && beads.first[end + 2]! - beads.first[layer]! < BATCH_RECORDS) end++;
      const bytes = await api.bytes(`v1/jobs/${id}/layers/${layer}-${end}/${what}`, signal);
      if (signal.aborted || viewer?.beads !== beads) return;
      beads.takeValues(what, layer, end, bytes);
      viewer.refresh(layer, end);
      layer = end + 1;
    }
    document.documentElement.dataset[what] = String(id);
  }
}

const layerWords = (k: number) => wordsOfLayer(viewer?.beads?.index ?? pictured?.index, k);

/** The moves of the highest layer set the ends of the lower slider. */
function moveRange(): void {
  const beads = viewer?.beads;
  if (!beads) return;
  const n = beads.index.layers[Number(high.value)]!.records - 1;
  for (const input of [from, to]) input.max = String(n);
  [from.value, to.value] = ["0", String(n)];
  movesChanged();
}

function rangeChanged(): void {
  // Neither end passes the other.
  if (Number(low.value) > Number(high.value)) {
    if (document.activeElement === low) high.value = low.value; else low.value = high.value;
  }
  byId("layer-high").textContent = layerWords(Number(high.value));
  byId("layer-low").textContent = layerWords(Number(low.value));
  high.setAttribute("aria-valuetext", layerWords(Number(high.value)).replace("\n", " at "));
  low.setAttribute("aria-valuetext", layerWords(Number(low.value)).replace("\n", " at "));
  moveRange();
  if (pictured) plain.take("program", `v1/jobs/${pictured.id}/layers/${high.value}-${high.value}/picture`, `Layer ${Number(high.value) + 1} of ${pictured.index.layers.length}, from above.`);
}

function movesChanged(): void {
  if (Number(from.value) > Number(to.value)) {
    if (document.activeElement === from) to.value = from.value; else from.value = to.value;
  }
  byId("move").textContent = `${to.value} of ${to.max}`;
  viewer?.setRange({ low: Number(low.value), high: Number(high.value), from: Number(from.value), to: Number(to.value) });
}

// A layer takes eight seconds, whatever its moves.
const play = player(byId("play"), to, 8, "Play the moves of the layer", () => from.value, movesChanged);

// ---- colours and numbers ---------------------------------------------------------------------------------------

function setColour(by: ColourBy): void {
  colourBy = by;
  const index = viewer?.beads?.index;
  if (!index || !viewer) return;
  viewer.setColour(by, scaleOf(index, by, least ?? 1));
  byId("legend").replaceChildren(...legend(index, by, least ?? 1));
}

function tellFace(face: number, at: { clientX: number; clientY: number }): void {
  const words = shape.supports.wordsAt(at) ?? loads.wordsAt(face, at);
  const box = byId("bead");
  box.hidden = words === null;
  box.textContent = words ?? "";
}

/** Boxes over the view that belong to what it shows. */
function overlays(): void {
  const isPart = viewer?.isPartShown ?? false;
  const hasPaths = !isPart && Boolean(viewer?.beads);
  const isOnPart = active === "shape" || active === "loads";
  plain.show(isOnPart ? "part" : "program");
  // Of pictures one layer is shown at a time.
  byId("layers").hidden = !hasPaths && (!pictured || isOnPart);
  for (const box of ["low", "layer-low"]) byId(box).hidden = pictured !== null;
  byId("moves").hidden = !hasPaths;
  byId("views").hidden = !isPart && !hasPaths;
  byId("bead").hidden = true;
  if (hasPaths) { byId("legend").hidden = false; setColour(colourBy); }
  else if (active !== "loads") byId("legend").hidden = true;
}

function tellBead(bead: Bead | null): void {
  const box = byId("bead");
  box.hidden = bead === null;
  const index = viewer?.beads?.index;
  if (!bead || !index) return;
  box.textContent = beadWords(index, bead);
}

/** Ways of colouring that the program on screen has: angles to the load and reserves come with the result of a plan. */
let hasAngles = false;
/** The factor on the loads at first failure; null where none is told. */
let least: number | null = null;
const colourings = () => COLOUR_BY.filter(([by]) => (by !== "load" || hasAngles) && (by !== "reserve" || least !== null));

/** Tells the numbers of the program on screen; of one that `isNew`, all beads are shown. */
function tellPaths(index: api.Index, result: api.Result | null, isNew: boolean): void {
  hasAngles = result?.angles ?? false;
  least = result?.reserve ? result.report.reserve?.first_failure?.[1] ?? null : null;
  if (!colourings().some(([by]) => by === colourBy)) colourBy = "role";
  const select = el("select", { id: "colour-by", onchange: () => setColour(select.value as ColourBy) }, ...colourings().map(([k, name]) => el("option", { value: k, selected: k === colourBy }, name)));
  // Travels and marks stay as they are from one program to the next.
  if (isNew) for (let k = 0; k < TRAVEL; k++) viewer?.setShown(k, true);
  const rows = index.shares.map((share, k) => {
    const marks = index.pulls[k - TRAVEL - 2] ?? 0;
    if (share.beads + marks === 0 && k !== TRAVEL) return null;
    const box = el("input", { type: "checkbox", id: `class-${k}`, checked: viewer?.isShown(k) ?? false, onchange: () => viewer?.setShown(k, box.checked) });
    const label = el("label", { for: `class-${k}` }, swatch(CLASS_COLOURS[k] ?? MARK_COLOURS[k - TRAVEL - 2]!), index.classes[k]!);
    return el("tr", {}, el("td", {}, box), el("td", {}, label), el("td", { class: "n" }, marks > 0 ? String(marks) : k < TRAVEL ? `${fixed(share.length_mm / 1000, 1)} m` : ""));
  });
  const [a, b] = index.part_mm;
  const size = [0, 1, 2].map((k) => fixed(b[k]! - a[k]!, 1)).join(" × ");
  const fact = (name: string, value: string) => el("tr", {}, el("td", {}, name), el("td", { class: "n" }, value));
  redraw(byId("panel-paths"),
    // Pictures of the server show every bead by its role.
    ...(viewer ? [el("h2", {}, "Colour"), el("div", { class: "row" }, el("label", {}, "by", select)), el("h2", {}, "Show"), el("table", {}, ...rows)] : []),
    el("h2", {}, "Program"),
    el("table", {}, fact("Written by", index.generator ?? "not stated"), fact("Part", `${size} mm`), fact("Layers", `${index.layers.length}${index.more ? " so far" : ""}`), fact("Beads", String(index.shares.reduce((n, s) => n + s.beads, 0))),
      fact("Time, estimated", duration(index.time_s)), fact("Filament", `${fixed(index.filament_mm / 1000, 2)} m`)),
    ...(result ? [...outputs(result), ...result.warnings.map(warning)] : [el("p", { class: "note" }, "Files and warnings follow once the paths are measured.")]),
    ...(opened?.kind === "program" ? [el("p", {}, el("button", { type: "button", class: "main", onclick: () => tab("strength") }, "Where does it break?"))] : []),
  );
}

function outputs(result: api.Result): Node[] {
  if (result.outputs.length === 0) return [];
  const link = (o: { kind: string; path: string }) => el("li", {}, el("a", { href: `v1/jobs/${current}/outputs/${o.kind}`, download: o.path.split("/").pop() ?? "" }, `${o.kind}: ${o.path.split("/").pop()}`));
  return [el("h2", {}, "Files"), el("ul", { class: "plain" }, ...result.outputs.map(link))];
}

// ---- tabs, keys, theme -----------------------------------------------------------------------------------------

const TABS = ["shape", "loads", "job", "paths", "strength"] as const;
let active: (typeof TABS)[number] = "paths";
function tab(name: (typeof TABS)[number]): void {
  active = name;
  // Shape and loads are on the part; the others show paths where there are some.
  if (name === "shape" || name === "loads" || !viewer?.beads) viewer?.setMode("part");
  else if (name !== "job") viewer?.setMode("paths");
  for (const t of TABS) {
    const button = byId(`tab-${t}`);
    button.setAttribute("aria-selected", String(t === name));
    button.tabIndex = t === name ? 0 : -1;
    byId(`panel-${t}`).hidden = t !== name;
  }
  overlays();
  shape.supports.setActive(name === "shape");
  strength.setActive(name === "strength");
  loads.setActive(name === "loads");
  job.setActive(name === "job");
}

for (const t of TABS) {
  byId(`tab-${t}`).addEventListener("click", () => tab(t));
  byId(`tab-${t}`).addEventListener("keydown", (event) => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (step === 0) return;
    const next = TABS[(TABS.indexOf(t) + step + TABS.length) % TABS.length]!;
    tab(next);
    byId(`tab-${next}`).focus();
  });
}

function shift(input: HTMLInputElement, by: number, then: () => void): void {
  input.value = String(Number(input.value) + by);
  then();
}

document.addEventListener("keydown", (event) => {
  const target = event.target as HTMLElement;
  const isField = ["INPUT", "TEXTAREA"].includes(target.tagName) && !(target instanceof HTMLInputElement && ["checkbox", "range"].includes(target.type));
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && (!isField || job.isText(target)) && job.text() !== null) {
    if (event.shiftKey) job.redo(); else job.undo();
    event.preventDefault();
    return;
  }
  if (event.ctrlKey || event.metaKey || event.altKey || ["INPUT", "TEXTAREA", "SELECT"].includes(target.tagName) || document.querySelector("dialog[open]")) return;
  const pace = event.shiftKey ? 10 : 1;
  const key = event.key.toLowerCase();
  const isChoosing = active === "loads" && Boolean(viewer?.isPartShown);
  if (viewer && look(viewer, event)) { /* The view has turned. */ }
  else if (event.key === "Escape" && viewer && viewer.dragging !== "turn") { loads.setGesture("turn"); shape.supports.setPaint(null); }
  else if (event.key === "Escape" && shape.chosen.length > 0) shape.choose(-1, false);
  else if (isChoosing && key in HELD_KEYS) { if (!event.repeat) loads.setGesture(HELD_KEYS[key]!); }
  else if (isChoosing && key === "g") shape.grow(!event.shiftKey);
  else if (viewer?.isPartShown && !["o", "?", "h"].includes(event.key)) return;
  else if (event.key === "ArrowUp") shift(high, pace, rangeChanged);
  else if (event.key === "ArrowDown") shift(high, -pace, rangeChanged);
  else if (event.key === "PageUp") shift(low, pace, rangeChanged);
  else if (event.key === "PageDown") shift(low, -pace, rangeChanged);
  else if (event.key === "ArrowRight" && target.getAttribute("role") !== "tab") shift(to, pace, movesChanged);
  else if (event.key === "ArrowLeft" && target.getAttribute("role") !== "tab") shift(to, -pace, movesChanged);
  else if (event.key === "l") { low.value = low.value === high.value ? "0" : high.value; rangeChanged(); }
  else if (event.key === "c") { const all = colourings(); const k = all.findIndex(([by]) => by === colourBy); setColour(all[(k + 1) % all.length]![0]); const select = document.getElementById("colour-by") as HTMLSelectElement | null; if (select) select.value = colourBy; }
  else if (event.key === "t") { const box = document.getElementById(`class-${TRAVEL}`); box?.click(); }
  else if (event.key === "o") void choose();
  else if (event.key === "?") help();
  else if (key === "h") void runs();
  else if (event.key === " " && target.tagName !== "BUTTON") play();
  else return;
  event.preventDefault();
});

/** Keys that say what a drag does while they are held. */
const HELD_KEYS: Record<string, "box" | "brush"> = { r: "box", b: "brush" };
document.addEventListener("keyup", (event) => { if (HELD_KEYS[event.key.toLowerCase()] === viewer?.dragging) loads.setGesture("turn"); });

function help(): void {
  const keys: [string, string][] = [
    ["o", "open a file"], ["1 2 3 4", "look from the top, the front, the side, obliquely"], ["A D W S", "turn the view; with shift move it"], ["+ -", "nearer, and farther away"], ["↑ ↓", "highest layer; with shift ten at a time"], ["PageUp PageDown", "lowest layer"],
    ["← →", "moves of the highest layer"], ["space", "play the moves"], ["l", "one layer alone, and back"], ["c", "next way of colouring"], ["t", "travels"], ["Ctrl+Z Ctrl+Shift+Z", "undo and redo a change of the job"], ["R B", "hold and drag: choose the faces in a box, or all that are touched"], ["G", "neighbours over smooth edges too; with shift all neighbours"], ["Esc", "choose no face"], ["h", "runs, and two side by side"], ["?", "this page"],
  ];
  const dialog = byId<HTMLDialogElement>("keys");
  dialog.replaceChildren(
    el("h2", {}, "Keys"), el("table", {}, ...keys.map(([k, words]) => el("tr", {}, el("td", {}, ...k.split(" ").map((one) => el("kbd", {}, one))), el("td", {}, words)))),
    el("h2", {}, "Pointer"), el("p", {}, "Drag turns, scroll zooms, drag with the right button moves. Rest on a bead for its numbers, on a face for its name, on a stress for its values. Click a face to choose it, with shift further ones."),
    el("p", {}, el("button", { type: "button", id: "show-tour", onclick: () => { dialog.close(); tour.go(0); byId("tour-next").focus(); } }, "Show the tour")),
    el("p", {}, el("a", { href: "licences.txt", target: "_blank" }, "Licences of the page")),
    el("p", {}, el("button", { type: "button", onclick: () => dialog.close() }, "Close")),
  );
  dialog.showModal();
}

function setTheme(theme: string): void {
  document.documentElement.dataset.theme = theme;
  try { localStorage.setItem("theme", theme); } catch { /* Kept for this visit alone. */ }
}

async function choose(): Promise<void> {
  const chosen = await chooser(byId<HTMLDialogElement>("chooser"), opened?.path ?? null);
  if (chosen) await open(chosen.path, chosen.kind);
}

/** Plans a run anew at a mass, tests it, and shows it beside another one. */
async function again(row: api.RunRow, mass_g: number, beside: string): Promise<void> {
  try {
    const { text, folder } = await api.text(row.input ?? `${work}/${row.name}/job.toml`);
    const wanted = set(absolute(text, folder), "fill", "mass_g", plainNumber(mass_g));
    const end = await run({ kind: "strength", text: wanted, name: `${row.name.replace(/-equal(-\d+)?$/, "")}-equal` });
    if (end) await runs([beside, end.title]);
  } catch (error) {
    say((error as Error).message, true);
  }
}

/** Opens the file of a run of the history, and what came of the run while the server keeps it. */
async function reopen(row: api.RunRow): Promise<void> {
  try {
    const kept = (await api.jobs()).jobs.reverse().find((run) => run.title === row.name && run.kind === row.kind && run.phase === "done");
    const path = row.input ?? `${work}/${row.name}/job.toml`;
    if (!(await open(path, kindOf(path)))) return;
    if (!kept) say(`The paths of ${row.name} are kept until the studio ends; this is the file it was made of. Run it again to see them.`);
    else if (row.kind === "strength") { tab("strength"); await strength.reopen(kept.id, row.name); }
    else { active = "paths"; await show(kept.id); }
  } catch (error) {
    say((error as Error).message, true);
  }
}

/** Follows the plan or test that was begun before the page was loaded: the one that this tab followed, also where it has ended
 * since, or one that is worked on. What came of it is opened, unless another file is by then. */
async function attach(signal: AbortSignal): Promise<void> {
  try {
    const { jobs } = await api.jobs();
    const last = followed();
    const begun = jobs.find(({ id, kind, title }) => id === last?.id && kind === last.kind && title === last.title)
      ?? jobs.find((run) => isKept(run) && (run.phase === "waiting" || run.phase === "running"));
    const end = begun && (await watch(begun, undefined, signal));
    const row = end && (await api.history()).runs.find((run) => run.name === end.title && run.kind === end.kind);
    if (row && !signal.aborted) await reopen(row);
  } catch (error) {
    say((error as Error).message, true);
  }
}

/** Opens the history of runs; the newest ones, or those of these names, are side by side at once. */
async function runs(chosen: number | string[] = 0): Promise<void> {
  try { await history(byId<HTMLDialogElement>("history"), chosen, (...wanted) => void again(...wanted), (row) => void reopen(row)); } catch (error) { say((error as Error).message, true); }
}

let saved: string | null = null;
try { saved = localStorage.getItem("theme"); } catch { /* Private windows may refuse. */ }
setTheme(saved ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
byId("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
addEventListener("focus", () => void shape.readAnew());
byId("open").addEventListener("click", () => void choose());
byId("help").addEventListener("click", help);
byId("runs").addEventListener("click", () => void runs());
byId("play").addEventListener("click", play);
for (const input of [high, low]) input.addEventListener("input", rangeChanged);
for (const input of [from, to]) input.addEventListener("input", movesChanged);
byId("views").addEventListener("click", (event) => {
  const direction = (event.target as HTMLElement).dataset.view;
  if (direction) viewer?.view(direction);
});
document.addEventListener("dragover", (event) => { event.preventDefault(); welcome.classList.add("over"); });
document.addEventListener("dragleave", () => welcome.classList.remove("over"));
document.addEventListener("drop", (event) => { event.preventDefault(); welcome.classList.remove("over"); void drop(event.dataTransfer); });

const noPaths = () => el("p", { class: "note" }, "Open a G-code file of any slicer to see its paths, or a mesh, a drawing, a photograph, a scan or a job to plan them.");
byId("panel-paths").append(noPaths());

/** Writes an example to a folder of its own and opens its job. */
async function begin(name: string): Promise<void> {
  const { signal } = opening;
  try {
    const { path } = await api.example(name);
    if (!signal.aborted) await open(path, "job");
  } catch (error) { say((error as Error).message, true); }
}

async function start(): Promise<void> {
  const { signal } = opening;
  try {
    const state = await api.state();
    [roots, work] = [state.roots, state.work];
    if (state.opened && !signal.aborted) { if (await open(state.opened.path, state.opened.kind)) void attach(opening.signal); return; }
    const picker = el("input", { type: "file", hidden: true, onchange: () => { if (picker.files?.[0]) { const data = new DataTransfer(); data.items.add(picker.files[0]); void drop(data); } } });
    welcome.replaceChildren(el("div", {},
      el("h2", {}, "Where does your print break?"),
      el("p", {}, "Drop G-code of any slicer here: see its paths, pick where it is held and where it is loaded, and see at which load and where it breaks. Or drop a mesh (STL, OBJ, PLY, OFF, 3MF) or a job file: click the faces that hold and carry it, see its stress, plan it and test it. A photograph of a board and a scan are planned too."),
      el("div", { class: "row middle" }, el("button", { type: "button", class: "main", onclick: () => void choose() }, "Choose a file of this computer"), el("button", { type: "button", onclick: () => picker.click() }, "Send one with the browser"), picker),
      ...(await unsaved()),
      el("h3", {}, "Or begin with an example"),
      el("ul", { class: "plain examples" }, ...(await api.examples()).examples.map(({ name, about }) => el("li", {}, el("button", { type: "button", "data-example": name, onclick: () => void begin(name) }, el("b", {}, name), ` ${about}`)))),
      el("p", { class: "note" }, `Nothing leaves this computer. Results are written to ${state.work}.`)));
    void attach(signal);
  } catch (error) {
    say((error as Error).message, true);
  }
}
/** Jobs with changes that were not saved, to go on with. */
async function unsaved(): Promise<HTMLElement[]> {
  let all: api.Draft[];
  try { all = await drafts(); } catch (error) { return [el("p", { class: "error" }, (error as Error).message)]; }
  if (all.length === 0) return [];
  const row = (draft: api.Draft) => {
    const item = el("li", {},
      el("button", { type: "button", "data-draft": draft.path, title: draft.path, onclick: () => void open(draft.path, draft.kind) }, el("b", {}, draft.path.split(/[/\\]/).pop() ?? draft.path), ` changed ${new Date(1000 * draft.at_s).toLocaleString()}`),
      el("button", { type: "button", title: "Throw these changes away", onclick: () => void forget(draft.path).then(() => item.remove(), (e: Error) => say(e.message, true)) }, "Discard"));
    return item;
  };
  return [el("h3", {}, "Or go on with changes that were not saved"), el("ul", { class: "plain examples" }, ...all.map(row))];
}

const tour = new Tour(byId("tour"));
void start().then(() => tour.first());

// Tests look at the view through this; the page itself does not use it.
Object.defineProperty(window, "studio", { get: () => ({ viewer, show, part: shape.view, report: shape.report, chosen: shape.chosen, rendererName: viewer?.rendererName }) });
document.addEventListener("planned", (event) => {
  const id = (event as CustomEvent<number>).detail;
  const isOnScreen = onScreen === id && current === id && viewer?.beads;
  if (!isOnScreen) active = "paths";
  (isOnScreen ? tellResult(id) : show(id)).catch((e: Error) => say(e.message, true));
});
