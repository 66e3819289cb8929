// The viewer of notebooks in a page with nothing else, with a model as anywidget gives it: colours at places that follow
// from the program, each beside a control that must differ. tests/data/records.json has what Python sends; the tests of the
// package `grainpath` hold the same file.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { camera, far, folder, launch, picture, settle, studio, until, view, visit } from "./bench.mjs";

const DATA = new URL("data/", import.meta.url);
const SENT = JSON.parse(readFileSync(new URL("records.json", DATA), "utf8"));
const VIEWER = readFileSync(new URL("../../crates/grainpath-py/python/grainpath/viewer.js", import.meta.url));
const [WALL, FILL, PLAIN, DARK, BRIGHT] = [[214, 93, 32], [86, 178, 171], [184, 191, 196], [68, 1, 84], [253, 231, 37]];
const NEAR = 30;
const squares = SENT["squares.gcode"];
const BOX = squares.index.part_mm;
/** Middles of beads of the highest layer (4: lines along y) and of layer 3 (along x), and a place between both. */
const [wallAt, fillAt, belowAt, emptyAt] = [[50, 60, 0.8], [52, 46, 0.8], [46, 52, 0.6], [54, 46, 0.8]];

let browser, context, page;
const wrong = [];
before(async () => { browser = await launch(); });
after(async () => { await browser?.close(); });

/** A page with the viewer; angles are halves of degrees. */
async function open({ traits = {}, angles = [], background = "#ffffff", ...options } = {}) {
  await context?.close();
  context = await browser.newContext({ viewport: { width: 900, height: 560 }, colorScheme: "light", ...options });
  page = await context.newPage();
  page.setDefaultTimeout(30_000);
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") wrong.push(message.text()); });
  await page.route("**/*", (route) => {
    const { pathname } = new URL(route.request().url());
    if (pathname === "/viewer.js") return route.fulfill({ body: VIEWER, contentType: "text/javascript" });
    if (pathname === "/") return route.fulfill({ body: `<!doctype html><title>notebook</title><body style="background:${background};margin:20px"><p tabindex="0">before</p><div id="cell"></div><div style="height:2000px">after</div>`, contentType: "text/html" });
    wrong.push(`asked for ${pathname}`);
    return route.abort();
  });
  await page.goto("http://notebook.test/");
  await page.evaluate(async ({ traits, records, angles }) => {
    const data = (bytes) => new DataView(Uint8Array.from(bytes).buffer);
    const state = { ...traits, _records: data(Uint8Array.from(atob(records), (c) => c.charCodeAt(0))), _angles: data(angles) };
    const heard = {};
    const model = {
      saved: 0, state,
      get: (name) => state[name],
      set: (name, value) => { if (state[name] !== value) { state[name] = value; heard[`change:${name}`]?.forEach((f) => f()); } },
      save_changes: () => { model.saved++; },
      on: (event, then) => (heard[event] ??= new Set()).add(then),
      off: (event, then) => heard[event]?.delete(then),
      count: () => Object.values(heard).reduce((n, all) => n + all.size, 0),
    };
    const cell = document.getElementById("cell");
    const { default: widget } = await import("/viewer.js");
    Object.assign(window, { model, cell, end: widget.render({ model, el: cell }) });
  }, { traits: { _index: squares.index, color: "role", layers: [0, 3], height_px: 480, ...traits }, records: squares.records, angles });
  await settle(page);
}

/** The page of the test before, with everything as it was at first. */
async function reset() {
  await set("layers", [0, 3]);
  await set("color", "role");
  await look("Top");
}
const set = async (name, value) => { await page.evaluate(([n, v]) => window.model.set(n, v), [name, value]); await settle(page); };
const get = (name) => page.evaluate((n) => window.model.state[n], name);
/** Colours at points of the program, seen from a side. */
async function seen(points, direction = "Top", turned_deg = 0) {
  const place = camera(BOX, direction.toLowerCase(), await page.locator("canvas").boundingBox(), turned_deg);
  const shot = await picture(page);
  return points.map((p) => shot.at(...place(p)));
}
const look = async (direction) => { await page.getByRole("button", { name: direction }).click(); await settle(page); };
const near = (found, wanted, what) => assert.ok(far(found, wanted) < NEAR, `${what}: ${found} is not ${wanted}`);
const unlike = (found, other, what) => assert.ok(far(found, other) > NEAR, `${what}: ${found} is ${other}`);
const numbers = (rows) => rows.map((row) => Object.values(row)).flat();

test("the studio sends what Python sends", async () => {
  const files = folder(Object.fromEntries(Object.keys(SENT).map((name) => [name, readFileSync(new URL(name, DATA))])));
  const server = await studio(files.dir);
  const visited = await visit(browser, server.address);
  for (const [name, { index: wanted, records }] of Object.entries(SENT)) {
    const { index, bytes } = await visited.page.evaluate(async (file) => {
      const json = async (address, init) => (await fetch(address, init)).json();
      const begun = await json("v1/jobs", { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify({ kind: "view", file }) });
      for (let state = begun; state.phase !== "done"; state = await json(`v1/jobs/${begun.id}`)) {
        if (state.phase === "failed") throw new Error(state.error);
        await new Promise((then) => setTimeout(then, 20));
      }
      const index = await json(`v1/jobs/${begun.id}/layers`);
      const bytes = await (await fetch(`v1/jobs/${begun.id}/layers/0-${index.layers.length - 1}`)).arrayBuffer();
      return { index, bytes: [...new Uint8Array(bytes)] };
    }, files.at(name));
    // The studio also marks where filament is pulled back and pushed again.
    const n = wanted.classes.length;
    const all = Array.from({ length: bytes.length / 8 }, (_, k) => bytes.slice(8 * k, 8 * k + 8));
    const isMark = (record) => (record[6] & 127) >= n;
    let first = 0;
    for (const layer of index.layers) {
      const end = first + layer.records;
      layer.records -= all.slice(first, end).filter(isMark).length;
      first = end;
    }
    const kept = all.filter((record) => !isMark(record)).flat();
    assert.ok(Buffer.from(kept).equals(Buffer.from(records, "base64")), `${name}: the records differ`);
    const { time_s: _, pulls, layers, shares: ofAll, ...own } = { ...index, records: kept.length / 8, classes: index.classes.slice(0, n) };
    assert.equal(pulls[0] + pulls[1], all.length - kept.length / 8);
    const shares = ofAll.slice(0, n);
    const { layers: theirLayers, shares: theirShares, ...theirs } = wanted;
    assert.deepEqual(own, theirs);
    layers.forEach((layer) => delete layer.time_s);
    const [a, b] = [numbers([...layers, ...shares]), numbers([...theirLayers, ...theirShares])];
    assert.equal(a.length, b.length);
    a.forEach((v, k) => assert.ok(Math.abs(v - b[k]) <= 1e-6 * Math.max(1, Math.abs(v)), `${name}: ${v} and ${b[k]}`));
  }
  await visited.close();
  await server.end();
  files.remove();
});

test("beads have the colours of their roles, and a hidden layer is not drawn", async () => {
  await open();
  await look("Top");
  const [wall, fill, below, empty] = await seen([wallAt, fillAt, belowAt, emptyAt]);
  near(wall, WALL, "wall");
  near(fill, FILL, "fill of the highest layer");
  near(below, FILL, "fill of the layer below");
  unlike(empty, FILL, "between lines");
  // Controls: the highest layer alone, and all but it.
  await set("layers", [3, 3]);
  const alone = await seen([fillAt, belowAt]);
  near(alone[0], FILL, "fill of the highest layer alone");
  unlike(alone[1], FILL, "the layer below is hidden");
  await set("layers", [2, 2]);
  const lower = await seen([fillAt, belowAt]);
  unlike(lower[0], FILL, "the highest layer is hidden");
  near(lower[1], FILL, "fill of layer 3 alone");
});

test("a role and travels are switched in the legend", async () => {
  await reset();
  assert.deepEqual(await page.locator("#legend label").allTextContents(), ["External perimeter", "Internal infill", "Travel"]);
  await page.getByLabel("External perimeter").uncheck();
  await settle(page);
  const [wall, fill] = await seen([wallAt, fillAt]);
  unlike(wall, WALL, "wall");
  near(fill, FILL, "fill");
  await page.getByLabel("External perimeter").check();
  assert.equal(await page.getByLabel("Travel").isChecked(), false);
  await page.locator("canvas").focus();
  await page.keyboard.press("t");
  assert.equal(await page.getByLabel("Travel").isChecked(), true);
  await page.keyboard.press("t");
});

test("a program without a guide has no angle off it, and none has the time of a layer", async () => {
  const values = await page.locator("option").evaluateAll((all) => all.map((o) => o.value));
  assert.deepEqual(values, ["role", "speed", "width", "angle", "flow", "height", "seam"]);
});

test("colours show speed, width, direction and the angle off the guide", async () => {
  // Of each bead of fill, 0 degrees along y and 90 along x; walls ask for no direction.
  const bytes = Buffer.from(squares.records, "base64");
  const angles = Array.from({ length: squares.index.records }, (_, k) => {
    const [x, before] = [bytes.readUInt16LE(8 * k), k > 0 ? bytes.readUInt16LE(8 * k - 8) : 0];
    return bytes[8 * k + 6] === 6 ? (x === before ? 0 : 180) : 255;
  });
  await open({ angles });
  await look("Top");
  const expected = { speed: [DARK, BRIGHT, BRIGHT], width: [BRIGHT, DARK, DARK], direction: [PLAIN, DARK, BRIGHT] };
  for (const [color, wanted] of Object.entries(expected)) {
    await set("color", color);
    const found = await seen([wallAt, fillAt, belowAt]);
    wanted.forEach((w, k) => near(found[k], w, `${color}, place ${k}`));
  }
  assert.deepEqual(await page.locator("#legend .ends span").allTextContents(), ["0°", "90°"]);
  await page.getByLabel("Colour by").selectOption("angle");
  await settle(page);
  assert.equal(await get("color"), "angle");
  const [wall, fill, below] = await seen([wallAt, fillAt, belowAt]);
  near(wall, below, "both along x");
  unlike(fill, below, "along y and along x");
  await page.locator("canvas").focus();
  await page.keyboard.press("c");
  assert.equal(await get("color"), "flow");
});

test("both ends of the slider move, neither passes the other, and Python hears of it", async () => {
  await reset();
  const slide = async (name, to) => { await page.getByLabel(name).fill(String(to)); await settle(page); };
  await slide("Highest layer shown", 2);
  assert.deepEqual(await get("layers"), [0, 2]);
  await slide("Lowest layer shown", 2);
  unlike((await seen([fillAt]))[0], FILL, "layer 3 alone");
  await slide("Lowest layer shown", 3);
  near((await seen([fillAt]))[0], FILL, "layer 4 alone");
  assert.deepEqual(await get("layers"), [3, 3]);
  assert.equal(await page.getByLabel("Highest layer shown").inputValue(), "3");
  await slide("Highest layer shown", 1);
  assert.deepEqual(await get("layers"), [1, 1]);
  assert.equal(await page.getByLabel("Lowest layer shown").getAttribute("aria-valuetext"), "2 at 0.40 mm");
  assert.ok((await page.evaluate(() => window.model.saved)) >= 3);
  const canvas = page.locator("canvas");
  await canvas.focus();
  for (const [key, layers] of [["ArrowUp", [1, 2]], ["PageDown", [0, 2]], ["Shift+ArrowUp", [0, 3]], ["l", [3, 3]], ["l", [0, 3]], ["ArrowUp", [0, 3]]]) {
    await page.keyboard.press(key);
    assert.deepEqual(await get("layers"), layers, key);
  }
});

test("the view turns by keys and by the mouse, and zooms only once it was clicked", async () => {
  await reset();
  const canvas = page.locator("canvas");
  const turnedBy = (degrees) => seen([wallAt, fillAt, emptyAt], "Top", degrees);
  await canvas.focus();
  await page.keyboard.press("1");
  for (let k = 0; k < 3; k++) await page.keyboard.press("d");
  await settle(page);
  const [wall, fill, empty] = await turnedBy(45);
  near(wall, WALL, "wall, turned by 45 degrees");
  near(fill, FILL, "fill, turned by 45 degrees");
  unlike(empty, FILL, "between lines, turned by 45 degrees");
  unlike((await turnedBy(0))[1], FILL, "the view that was not turned");
  const shot = async () => (await picture(page)).png.data;
  const same = (a, b) => a.equals(b);
  await page.locator("p").focus();
  const { x, y, width, height } = await canvas.boundingBox();
  await page.mouse.move(x + 0.5 * width, y + 0.5 * height);
  const before = await shot();
  await page.mouse.wheel(0, 60);
  // All the way: a page that still moves would move on from where it is put.
  await page.waitForFunction(() => scrollY === 60);
  await page.evaluate(() => scrollTo(0, 0));
  await settle(page);
  assert.ok(same(before, await shot()), "the page scrolls, and the view stays");
  await page.mouse.down();
  await page.mouse.up();
  await page.mouse.wheel(0, 60);
  let zoomed;
  await until(async () => !same(before, (zoomed = await shot())), "zoomed after a click");
  assert.equal(await page.evaluate(() => scrollY), 0);
  await page.mouse.down();
  await page.mouse.move(x + 0.6 * width, y + 0.4 * height, { steps: 4 });
  await page.mouse.up();
  await settle(page);
  assert.ok(!same(zoomed, await shot()), "turned by a drag");
});

test("keys of the view do not reach the notebook, others do", async () => {
  await page.evaluate(() => { window.keys = []; document.addEventListener("keydown", (event) => window.keys.push(event.key)); });
  await page.locator("canvas").focus();
  for (const key of ["a", "d", "x", "Escape"]) await page.keyboard.press(key);
  assert.deepEqual(await page.evaluate(() => window.keys), ["x", "Escape"]);
  assert.equal(await page.locator("#cell").getAttribute("data-lm-suppress-shortcuts"), "true");
});

test("a bead under the pointer tells its numbers", async () => {
  await reset();
  const place = camera(BOX, "top", await page.locator("canvas").boundingBox());
  await page.mouse.move(...place(fillAt));
  await page.locator("#bead:has-text('Internal infill')").waitFor();
  assert.match(await page.locator("#bead").textContent(), /layer 4 · 0\.60 mm wide · 0\.20 mm high · 0\.0° off the load · 80\.0 mm\/s/);
});

test("the view is dark in a dark notebook, and readers with impairments can use it", async () => {
  const [light, dark] = ["rgb(28, 36, 41)", "rgb(232, 236, 238)"];
  const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  await open({ background: "#111111" });
  await page.evaluate(axe);
  // The notebook changes its theme while the view is open.
  for (const [background, ink] of [["#111111", dark], ["#ffffff", light], ["rgb(32, 32, 32)", dark]]) {
    await page.evaluate((colour) => { document.body.style.background = colour; }, background);
    await settle(page);
    assert.equal(await page.locator("#stage").evaluate((stage) => getComputedStyle(stage).color), ink, background);
    if (background[0] !== "#") continue;
    const { violations } = await page.evaluate(() => window.axe.run("#cell"));
    assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes[0].html}`), []);
  }
  // Where the page has no colour of its own, it is what the browser prefers.
  await page.evaluate(() => { document.body.style.background = "transparent"; });
  for (const [colorScheme, ink] of [["light", light], ["dark", dark]]) {
    await page.emulateMedia({ colorScheme });
    await settle(page);
    assert.equal(await page.locator("#stage").evaluate((stage) => getComputedStyle(stage).color), ink, colorScheme);
  }
});

test("what is no longer shown is given back", async () => {
  assert.ok((await page.evaluate(() => window.model.count())) >= 3);
  const lost = await page.evaluate(async () => {
    const gl = window.cell.shadowRoot.querySelector("canvas").getContext("webgl2");
    const before = gl.isContextLost();
    const lost = new Promise((then) => gl.canvas.addEventListener("webglcontextlost", then));
    window.end();
    await lost;
    return [before, gl.isContextLost()];
  });
  assert.deepEqual(lost, [false, true]);
  assert.equal(await page.evaluate(() => window.model.count()), 0);
});

test("nothing went wrong, and nothing was asked of the network", () => assert.deepEqual(wrong, []));
