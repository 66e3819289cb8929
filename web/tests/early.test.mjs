// A plan comes on screen with its first layer, while the others are still planned.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { boxStl, choose, colours, far, folder, launch, settle, shaped, studio, visit } from "./bench.mjs";

const WALL = [214, 93, 32];
// Planning takes a second or more, so that it still goes on when a busy browser asks for the first time.
const LAYERS = 900;
// Stress on elements of this size, with few beads to draw.
const loaded = (element_mm) => `[shape]
mesh = "block.stl"
[process]
layer_height_mm = 0.4
[fill]
pattern = "stripes"
density = 0.5
[guide]
kind = "stress"
element_mm = ${element_mm}
[[guide.fixture]]
on = { box_mm = [[-1, -1, -1], [0.1, 51, 21]] }
fix = "xyz"
[[guide.load]]
on = { box_mm = [[49.9, -1, -1], [51, 51, 21]] }
force_n = [0, 0, -100]
`;
// Three seconds on two idle cores.
const SHORT = loaded(2.4);
const CASES = Array.from({ length: 12 }, (_, k) => `[[guide.case]]
name = "${k}"
[[guide.case.load]]
on = { box_mm = [[49.9, -1, -1], [51, 51, 21]] }
force_n = [0, ${k}, -100]
`);
// Minutes, which a busy browser cannot miss and which end when they are cancelled.
const LONG = loaded(1.2) + CASES.join("");
let files, server, browser;
before(async () => {
  const job = "[shape]\nmesh = \"high.stl\"\n[process]\nlayer_height_mm = 0.1\nfirst_layer_height_mm = 0.1\nskirt_loops = 0\n[fill]\npattern = \"gyroid\"\n";
  files = folder({ "high.stl": boxStl([50, 50, LAYERS / 10]), "high.toml": job, "block.stl": boxStl([50, 50, 20]), "long.toml": LONG, "short.toml": SHORT });
  server = await studio(files.dir);
  browser = await launch();
});
/** Begins the plan of a job. */
async function planOf(page, name) {
  await choose(page, name);
  await shaped(page);
  await page.click("#tab-job");
  await page.click("#panel-job >> text=Plan the paths");
}
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

test("the first layer of a plan is on screen while the others are planned", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await planOf(page, "high.toml");
  // What the page tells at the moment when it has its first layers.
  const early = await page.waitForFunction(() => {
    const b = window.studio.viewer?.beads;
    if (!b?.taken) return false;
    return { isEarly: b.index.more, progress: document.querySelector("#progress").textContent, shown: document.documentElement.dataset.shown ?? "", layers: document.querySelector("#panel-paths").textContent };
  }, null, { timeout: 120_000 });
  const { isEarly, progress, shown, layers } = await early.jsonValue();
  assert.ok(isEarly && shown === "", `${shown}`);
  assert.match(progress, /^Walls and fill \d+ of \d+/);
  assert.match(layers, /Layers\d+ so far/);
  // What is switched off while it is planned stays so.
  await page.click("#class-4");
  // Only the first layer is shown, since a layer that comes between the question for a place and the picture would move
  // the place: it is nearer to the eye.
  await page.waitForFunction(() => document.querySelector("#high").max !== "0");
  const upTo = (layer) => page.$eval("#high", (input, k) => { input.value = k ?? input.max; input.dispatchEvent(new Event("input", { bubbles: true })); }, layer);
  await upTo("0");
  await page.click("#views [data-view=top]");
  // Turned by hand, there and back: a view of the whole part would move with each layer that comes.
  for (const key of ["d", "a"]) await page.keyboard.press(key);
  await settle(page);
  const [x, y, z] = await page.evaluate(() => { const { part_mm: [low, high] } = window.studio.viewer.beads.index; return [low[0], (low[1] + high[1]) / 2, low[2] + 0.1]; });
  // The outer wall on the left, whose middle is brightest and may lie between two pixels, and a place left of it.
  const [beside, ...wall] = await colours(page, [[x - 3, y, z], ...[0.16, 0.22, 0.28].map((d) => [x + d, y, z])]);
  assert.ok(wall.some((colour) => far(colour, WALL) < 30), `wall: ${wall}`);
  assert.ok(far(beside, WALL) > 30, `beside: ${beside}`);
  // The whole follows, with all of its layers.
  await upTo(null);
  await page.focus("#colour-by");
  await page.waitForSelector('#panel-paths a:has-text("gcode")', { timeout: 240_000 });
  await page.waitForFunction(() => document.documentElement.dataset.shown);
  assert.equal(await page.isChecked("#class-4"), false);
  assert.equal(await page.evaluate(() => document.activeElement.id), "colour-by");
  await page.click("#views [data-view=top]");
  await settle(page);
  assert.deepEqual(await page.evaluate(() => { const b = window.studio.viewer.beads; return [b.index.more, b.index.layers.length, b.taken]; }), [false, LAYERS, LAYERS]);
  assert.equal(await page.inputValue("#high"), String(LAYERS - 1));
  assert.ok(far((await colours(page, [[x + 0.22, y, LAYERS / 10]]))[0], WALL) < 30);
  assert.deepEqual(wrong, []);
  await close();
});

test("a page that is loaded anew during a run shows how far it is, and cancels it", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await planOf(page, "long.toml");
  const tells = () => page.waitForFunction(() => /^(Shape|Stress) .* s/.test(document.querySelector("#progress").textContent));
  await tells();
  await page.reload();
  await tells();
  await page.click("#progress >> text=Cancel");
  await page.waitForSelector("#progress >> text=Cancelled. Nothing was changed.");
  assert.deepEqual(wrong, []);
  await close();
});

test("a page that is loaded anew during a run shows what comes of it", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await planOf(page, "short.toml");
  await page.waitForFunction(() => sessionStorage.getItem("followed"));
  await page.reload();
  // Its file is opened at the end, and its part is shown before its paths are.
  await page.waitForFunction(() => document.documentElement.dataset.shape, null, { timeout: 240_000 });
  await page.waitForSelector("#tab-paths[aria-selected=true]");
  assert.match(await page.textContent("#title"), /short\.toml$/);
  await page.waitForFunction(() => window.studio.viewer.beads?.index.layers.length === 50);
  assert.match(await page.textContent("#panel-paths"), /Layers50/);
  assert.deepEqual(wrong, []);
  await close();
});

test("a run that has ended when its page is back is shown, once", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await choose(page, "high.toml");
  await shaped(page);
  await page.click("#tab-job");
  // The page hears nothing of its run before it is loaded anew.
  let isBack = false;
  await page.route("**/events", (route) => isBack ? route.continue() : undefined);
  await page.click("#panel-job >> text=Plan the paths");
  // A busy browser may take the answer to its question later than the plan takes.
  await page.waitForFunction(() => sessionStorage.getItem("followed"));
  const last = async () => (await (await page.request.get(new URL("v1/jobs", server.address).href)).json()).jobs.at(-1);
  for (let run = await last(); run.kind !== "plan" || run.phase !== "done"; run = await last()) await page.waitForTimeout(100);
  isBack = true;
  await page.reload();
  await page.waitForFunction(() => document.querySelector("#title").textContent.endsWith("high.toml"));
  await page.waitForFunction((n) => window.studio.viewer.beads?.index.layers.length === n, LAYERS);
  // Loaded once more, the page begins as ever.
  await page.reload();
  await page.waitForSelector("[data-example]");
  await page.waitForTimeout(1000);
  assert.equal(await page.isVisible("#progress"), false);
  assert.deepEqual(wrong, []);
  await close();
});
