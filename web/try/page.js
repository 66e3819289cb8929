// The page around the planner: examples and files in, layers as pictures and G-code out. All it needs is inside the page.
"use strict";

const $ = (id) => document.getElementById(id);

/** Colours of beads by the word after `;TYPE:`; those of the pictures that grainpath draws. */
const COLOURS = {
  "External perimeter": "#f2782d", "Perimeter": "#fac846", "Thin wall": "#d63c3c", "Gap fill": "#f0f0f5",
  "Solid infill": "#9654cc", "Top solid infill": "#e4405c", "Internal infill": "#b24a3c", "Fibre infill": "#46c8be",
  "Bridge infill": "#5082e1", "Skirt": "#147864", "Brim": "#147864", "Support material": "#3cb44b",
  "Support material interface": "#1e8232",
};
const OTHER = "#c8c8c8";

/** Stages by their index in the planner's list. */
const STAGES = ["reading", "cutting layers", "solving the stress", "filling", "planning supports", "ordering paths", "writing", "testing"];

let worker = null;
let files = {};
let planned = null;
let layers = [];
let compiled = null;

const bytesOf = (base64) => Uint8Array.from(atob(base64.trim()), (c) => c.charCodeAt(0));

function tell(text, bad = false) {
  $("told").textContent = text;
  $("told").classList.toggle("bad", bad);
}

async function unpack() {
  const packed = new Blob([bytesOf($("module").textContent)]).stream().pipeThrough(new DecompressionStream("gzip"));
  compiled = await WebAssembly.compile(await new Response(packed).arrayBuffer());
  startWorker();
}

function startWorker() {
  const url = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));
  worker = new Worker(url);
  URL.revokeObjectURL(url);
  worker.onmessage = ({ data }) => answered(data);
  worker.onerror = (event) => failed(event.message || "the worker cannot start", true);
  worker.postMessage({ module: compiled });
}

function busy(is) {
  $("plan").disabled = is;
  $("stop").disabled = !is;
}

function answered(data) {
  if (data.ready) {
    if (!$("stop").disabled) return;
    busy(false);
    // After a crash its message stays.
    if (!$("told").classList.contains("bad")) tell("Ready.");
  } else if (data.stage !== undefined) {
    const share = data.total > 0 ? ` ${Math.min(100, Math.round((100 * data.done) / data.total))} %` : "";
    tell(`Planning: ${STAGES[data.stage]}${share}`);
  } else if (data.problem) {
    failed(data.problem, data.trap);
  } else {
    busy(false);
    planned = data.planned;
    layers = layersOf(new TextDecoder().decode(planned.gcode));
    tell(`Planned in ${data.seconds.toFixed(2)} s: ${(planned.gcode.length / 1e6).toFixed(2)} MB of G-code.`);
    $("summary").textContent = planned.summary;
    $("save").disabled = false;
    const slider = $("layer");
    slider.max = String(Math.max(layers.length, 1));
    slider.value = String(Math.max(1, Math.ceil(layers.length / 2)));
    slider.disabled = layers.length < 2;
    draw();
  }
}

function failed(problem, trap) {
  busy(false);
  tell(problem, true);
  if (trap && compiled) {
    worker.terminate();
    startWorker();
    $("plan").disabled = true;
  }
}

/** The beads of each layer of a program: pieces with type, width and points, mm. */
function layersOf(gcode) {
  const all = [];
  let [x, y, e, type, width, absolute, piece] = [0, 0, 0, "", 0.4, true, null];
  const layer = () => all[all.length - 1] ?? (all.push({ z: 0, pieces: [] }), all[0]);
  for (const line of gcode.split("\n")) {
    if (line.startsWith(";LAYER_CHANGE")) { all.push({ z: 0, pieces: [] }); piece = null; }
    else if (line.startsWith(";Z:")) layer().z = Number(line.slice(3));
    else if (line.startsWith(";TYPE:")) { type = line.slice(6).trim(); piece = null; }
    else if (line.startsWith(";WIDTH:")) { width = Number(line.slice(7)); piece = null; }
    else if (line.startsWith("M82")) absolute = true;
    else if (line.startsWith("M83")) absolute = false;
    else if (/^G(0|1|2|3|92) /.test(line)) {
      const words = {};
      for (const word of line.split(";", 1)[0].trim().split(/\s+/)) words[word[0]] = Number(word.slice(1));
      const from = [x, y];
      if (words.E !== undefined && words.G === 92) { e = words.E; continue; }
      if (words.G === 92) continue;
      x = words.X ?? x;
      y = words.Y ?? y;
      const fed = words.E === undefined ? 0 : absolute ? words.E - e : words.E;
      if (words.E !== undefined) e = absolute ? words.E : e + words.E;
      const moved = x !== from[0] || y !== from[1];
      if (!moved || fed <= 0) { if (moved) piece = null; continue; }
      if (!piece) layer().pieces.push(piece = { type, width, points: [from] });
      if (words.G >= 2) piece.points.push(...arc(from, [x, y], [words.I ?? 0, words.J ?? 0], words.G === 2));
      piece.points.push([x, y]);
    }
  }
  return all.filter((l) => l.pieces.length > 0);
}

/** Points between the ends of an arc, about 5 degrees apart. */
function arc(from, to, [i, j], clockwise) {
  const [cx, cy] = [from[0] + i, from[1] + j];
  const start = Math.atan2(-j, -i);
  let turn = Math.atan2(to[1] - cy, to[0] - cx) - start;
  if (clockwise && turn >= 0) turn -= 2 * Math.PI;
  if (!clockwise && turn <= 0) turn += 2 * Math.PI;
  const n = Math.ceil(Math.abs(turn) / 0.09);
  const radius = Math.hypot(i, j);
  return Array.from({ length: Math.max(0, n - 1) }, (_, k) => {
    const angle = start + (turn * (k + 1)) / n;
    return [cx + radius * Math.cos(angle), cy + radius * Math.sin(angle)];
  });
}

function draw() {
  const canvas = $("picture");
  const context = canvas.getContext("2d");
  context.fillStyle = "#20242a";
  context.fillRect(0, 0, canvas.width, canvas.height);
  if (layers.length === 0) return;
  // One frame for all layers, so that the picture stands still while the slider moves. A skirt may be cut off.
  const drawn = layers.flatMap((l) => l.pieces).filter((p) => p.type !== "Skirt" && p.type !== "Brim");
  let [left, low, right, high] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { points } of drawn) {
    for (const [x, y] of points) {
      left = Math.min(left, x); right = Math.max(right, x); low = Math.min(low, y); high = Math.max(high, y);
    }
  }
  const scale = 0.94 * Math.min(canvas.width / (right - left + 1), canvas.height / (high - low + 1));
  const place = ([x, y]) => [canvas.width / 2 + (x - (left + right) / 2) * scale, canvas.height / 2 - (y - (low + high) / 2) * scale];
  const k = Number($("layer").value);
  const { z, pieces } = layers[k - 1];
  context.lineCap = context.lineJoin = "round";
  for (const [share, lift] of [[1, 0], [0.78, 1]]) {
    // Each bead twice: its dark border, and its colour inside, so that neighbours can be told apart.
    for (const { type, width, points } of pieces) {
      context.strokeStyle = lift ? COLOURS[type] ?? OTHER : "#0009";
      context.lineWidth = Math.max(width * scale * share, 0.7);
      context.beginPath();
      points.forEach((p, n) => (n ? context.lineTo(...place(p)) : context.moveTo(...place(p))));
      context.stroke();
    }
  }
  const name = `Layer ${k} of ${layers.length}, ${z.toFixed(2)} mm`;
  $("layer-name").textContent = name;
  canvas.setAttribute("aria-label", `${name}: ${pieces.length} pieces of beads`);
  const types = [...new Set(pieces.map((p) => p.type))];
  $("legend").replaceChildren(...types.map((type) => {
    const [item, patch] = [document.createElement("li"), document.createElement("span")];
    patch.style.background = COLOURS[type] ?? OTHER;
    item.append(patch, type || "bead");
    return item;
  }));
}

function showFiles() {
  const names = Object.keys(files);
  $("there").textContent = names.length ? `Files that the job can name: ${names.join(", ")}` : "";
}

const examples = JSON.parse($("examples").textContent);

function choose() {
  const example = examples[Number($("example").value)];
  if (!example) return;
  files = Object.fromEntries(Object.entries(example.files).map(([name, base64]) => [name, bytesOf(base64)]));
  $("job").value = example.job;
  showFiles();
}

/** A first job for a file of the user's own. */
function jobFor(name) {
  const text = JSON.stringify(name);
  const profiles = '[printer]\nprofile = "generic-0.4"\n\n[material]\nprofile = "pla"\n\n[process]\nprofile = "standard"\n';
  if (/\.(svg|dxf)$/i.test(name)) return `[shape]\noutline = ${text}\nthickness_mm = 4    # a drawing has no height: say how thick the part is\n\n${profiles}`;
  if (/\.(png|jpe?g|bmp)$/i.test(name)) {
    return `[shape.photo]\nfiles = [${text}]\nsize_mm = [200, 100]    # width and height of the board: measure it\nthickness_mm = 6\n\n[guide]\nkind = "grain"\n\n[fill]\npattern = "stripes"\ndensity = 1\n\n[process]\ntop_layers = 0\nbottom_layers = 0\n`;
  }
  return `[shape]\nmesh = ${text}\n\n${profiles}`;
}

async function take(list) {
  for (const file of list) {
    if (/\.toml$/i.test(file.name) && !/profile/i.test(file.name)) $("job").value = await file.text();
    else {
      files[file.name] = new Uint8Array(await file.arrayBuffer());
      const isShape = /\.(stl|obj|ply|off|3mf|svg|dxf|png|jpe?g|bmp)$/i.test(file.name);
      if (isShape && !$("job").value.includes(file.name)) $("job").value = jobFor(file.name);
    }
  }
  showFiles();
}

examples.forEach(({ title }, k) => $("example").append(new Option(title, String(k))));
$("example").onchange = choose;
$("files").onchange = () => take($("files").files);
document.ondragover = (event) => event.preventDefault();
document.ondrop = (event) => { event.preventDefault(); take(event.dataTransfer.files); };
$("layer").oninput = draw;
$("plan").onclick = () => {
  busy(true);
  tell("Planning…");
  worker.postMessage({ job: $("job").value, files });
};
$("stop").onclick = () => {
  worker.terminate();
  tell("Stopped.");
  busy(false);
  $("plan").disabled = true;
  startWorker();
};
$("save").onclick = () => {
  const url = URL.createObjectURL(new Blob([planned.gcode], { type: "text/x.gcode" }));
  const name = /^\s*gcode\s*=\s*"(?:.*\/)?([^"\/]+)"/m.exec($("job").value)?.[1] ?? "part.gcode";
  Object.assign(document.createElement("a"), { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
};
choose();
draw();
unpack().catch((problem) => tell(`This browser cannot run the planner: ${problem.message}`, true));
