// Choosing several faces at once: by a box, by a brush, and by growing; the colours of faces say what is chosen.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { boxStl, choose, colours, command, faceAt, folder, hold, launch, places, settle, shaped, stl, studio, view, visit } from "./bench.mjs";

const CHOSEN = [245, 196, 66];
const PLAIN = [178, 188, 196];
const LOADED = [226, 120, 58];
const SHOTS = process.env.SHOTS;
const shot = async (page, name) => { if (SHOTS) { await settle(page); await page.screenshot({ path: `${SHOTS}/${name}.png` }); } };

/** A plate of 40 x 12 x 20 mm whose upper right edge is a quarter round of 8 mm. */
function rounded() {
  const outline = [[0, 0], [40, 0], [40, 12], ...Array.from({ length: 15 }, (_, k) => { const u = ((k + 1) * Math.PI) / 32; return [32 + 8 * Math.cos(u), 12 + 8 * Math.sin(u)]; }), [32, 20], [0, 20]];
  const at = (k, y) => { const [x, z] = outline[k % outline.length]; return [x, y, z]; };
  const all = [];
  for (let k = 0; k < outline.length; k++) {
    all.push([at(k, 0), at(k + 1, 0), at(k + 1, 12)], [at(k, 0), at(k + 1, 12), at(k, 12)]);
    if (k > 0 && k + 1 < outline.length) all.push([at(0, 0), at(k + 1, 0), at(k, 0)], [at(0, 12), at(k, 12), at(k + 1, 12)]);
  }
  return stl(all.map(([a, b, c]) => [a, c, b]));
}

let files, server, browser;
before(async () => {
  files = folder({ "bar.stl": boxStl([60, 8, 4]), "round.stl": rounded() });
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

async function opened(name) {
  const visited = await visit(browser, server.address);
  await choose(visited.page, name);
  await shaped(visited.page);
  await visited.page.click("#tab-loads");
  return visited;
}
function hue(a, b) {
  const dot = a.reduce((sum, v, k) => sum + v * b[k], 0);
  return Math.sqrt(Math.max(1 - (dot / (Math.hypot(...a) * Math.hypot(...b))) ** 2, 0));
}
const is = (found, wanted, what) => assert.ok(hue(found, wanted) < 0.09, `${what}: ${found} is not ${wanted}`);
/** What the command line finds in the job of the page. */
async function saved(page) {
  const text = await page.$eval("#panel-job textarea", (t) => t.value);
  writeFileSync(files.at("split.toml"), text);
  return command(files.dir, "run", "split.toml", "--check", "--json", "--set", 'guide.analysis="solid"', "--set", "guide.element_mm=1.5");
}
const chosen = (page) => page.evaluate(() => window.studio.chosen.length);
async function drag(page, from, to, key) {
  await page.mouse.move(...from);
  if (key) await page.keyboard.down(key);
  await page.mouse.down();
  await page.mouse.move(0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), { steps: 3 });
  await page.mouse.move(...to, { steps: 3 });
  if (key) await shot(page, `drag-${key}`);
  await page.mouse.up();
  if (key) await page.keyboard.up(key);
  await page.mouse.move(5, 5);
  await settle(page);
}

test("a box chooses the faces that lie wholly in it", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await view(page, "oblique");
  const around = await places(page, [[60, 0, 0], [60, 8, 0], [60, 0, 4], [60, 8, 4]]);
  const [xs, ys] = [0, 1].map((k) => around.map((p) => p[k]));
  const box = [[Math.min(...xs) - 8, Math.min(...ys) - 8], [Math.max(...xs) + 8, Math.max(...ys) + 8]];
  await page.focus("#view");
  const before = await page.evaluate(() => window.studio.viewer.camera.position.toArray());
  // A box over half of the end holds no face.
  await drag(page, box[0], [0.5 * (box[0][0] + box[1][0]), box[1][1]], "r");
  assert.equal(await chosen(page), 0);
  await drag(page, ...box, "r");
  assert.deepEqual(await page.evaluate(() => window.studio.chosen), [await faceAt(page, [60, 4, 2])]);
  assert.deepEqual(await page.evaluate(() => window.studio.viewer.camera.position.toArray()), before, "the view is not turned");
  await view(page, "side");
  is((await colours(page, [[60, 4, 2]]))[0], CHOSEN, "the end");
  await view(page, "top");
  is((await colours(page, [[30, 4, 4]]))[0], PLAIN, "the top");
  // By its button, around all of the part.
  await page.click("#box");
  assert.equal(await page.getAttribute("#box", "aria-pressed"), "true");
  const corners = await places(page, [[-3, 12, 4], [63, -4, 4]]);
  await drag(page, corners[0], corners[1]);
  assert.equal(await chosen(page), 6);
  await page.keyboard.press("Escape");
  assert.equal(await page.getAttribute("#box", "aria-pressed"), "false");
  await page.keyboard.press("Escape");
  assert.equal(await chosen(page), 0);
  // Without it a drag turns the part and chooses nothing.
  await drag(page, corners[0], corners[1]);
  assert.equal(await chosen(page), 0);
  assert.deepEqual(wrong, []);
  await close();
});

test("a face is split along a line, and its part is loaded as the command line loads it", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await view(page, "top");
  const top = await faceAt(page, [30, 4, 4]);
  const [left, right, beside] = [[15, 4, 4], [45, 4, 4], [30, 0, 2]];
  assert.ok(await page.isDisabled("#split"), "nothing is chosen");
  const click = async (p) => { const [[x, y]] = await places(page, [p]); await page.mouse.click(x, y); await page.mouse.move(5, 5); await settle(page); };
  await click(left);
  for (const p of [left, right]) is((await colours(page, [p]))[0], CHOSEN, "the whole face");
  await page.click("#split");
  // Through (24, 1) and (24, 7): towards +y, so the part with the smaller x lies to the left.
  await click([24, 1, 4]);
  await click([24, 7, 4]);
  const [a, b] = await colours(page, [left, right]);
  is(a, CHOSEN, "to the left of the line");
  is(b, PLAIN, "to its right");
  await shot(page, "split");
  const area = async () => Number((await page.textContent("#part-of-face span")).match(/([\d.]+) mm²/)[1]);
  assert.ok(Math.abs((await area()) - 24 * 8) < 2, `${await area()}`);
  await page.click("#other-side");
  const [c, d] = await colours(page, [left, right]);
  is(c, PLAIN, "the other part");
  is(d, CHOSEN, "the other part");
  assert.ok(Math.abs((await area()) - 36 * 8) < 2, `${await area()}`);
  await page.click("#load-here");
  const text = await page.$eval("#panel-job textarea", (t) => t.value);
  assert.match(text, /on = \{ face = "f:[0-9a-f]+", side = \{ point_mm = \[[\d., -]+\], normal = \[(1|0\.99\d*), [\d., e-]+\] \} \}/);
  const [e, f] = await colours(page, [left, right]);
  is(e, PLAIN, "not loaded");
  is(f, LOADED, "loaded");
  // The view from above looks at the arrow's end, so it covers little.
  assert.match(await page.textContent("#items"), /the part beyond/);
  // Held at its end, and solved: the area and its middle are those of the part.
  await hold(page, [0, 4, 2]);
  const seen = JSON.parse(await saved(page));
  const [{ area_mm2, at_mm }] = seen.stress.loads;
  assert.ok(Math.abs(area_mm2 / (36 * 8) - 1) < 0.05 && Math.abs(at_mm[0] - 42) < 0.6, `${area_mm2} ${at_mm}`);
  // A face that is chosen anew is chosen as a whole.
  await click(right);
  assert.equal(await page.isVisible("#part-of-face"), false);
  assert.deepEqual(await page.evaluate(() => window.studio.chosen), [top]);
  // Points beside the face are refused.
  await page.click("#split");
  await view(page, "front");
  await click(beside);
  assert.match(await page.textContent("#progress .error"), /lies on another face/);
  assert.deepEqual(wrong, []);
  await close();
});

test("a brush chooses every face that it touches", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await view(page, "oblique");
  await page.focus("#view");
  const [top, front] = await places(page, [[30, 4, 4], [30, 0, 2]]);
  await drag(page, top, front, "b");
  assert.deepEqual((await page.evaluate(() => window.studio.chosen)).sort(), [await faceAt(page, [30, 4, 4]), await faceAt(page, [30, 0, 2])].sort());
  const [a, b] = await colours(page, [[15, 4, 4], [15, 0, 2]]);
  is(a, CHOSEN, "the top");
  is(b, CHOSEN, "the front");
  await page.keyboard.press("Escape");
  const [c, d] = await colours(page, [[15, 4, 4], [15, 0, 2]]);
  is(c, PLAIN, "the top");
  is(d, PLAIN, "the front");
  assert.deepEqual(wrong, []);
  await close();
});

test("growing takes neighbours over smooth edges, or all", async () => {
  const { page, wrong, close } = await opened("round.stl");
  const round = await page.evaluate(() => window.studio.report.faces.findIndex((row) => row.kind === "cylinder"));
  assert.ok(round >= 0, "the quarter round is a cylinder");
  await page.click("#all-faces summary");
  await page.focus(`button.face[data-face="${round}"]`);
  assert.equal(await page.isDisabled("#grow"), true);
  await page.keyboard.press("Enter");
  await page.keyboard.press("g");
  assert.equal(await chosen(page), 3, "the round, the top and the right side");
  await view(page, "oblique");
  await page.mouse.move(5, 5);
  const [top, front] = await colours(page, [[15, 6, 20], [15, 0, 8]]);
  is(top, CHOSEN, "the top");
  is(front, PLAIN, "the front is beyond a sharp edge");
  await page.keyboard.press("Shift+G");
  assert.equal(await chosen(page), 7, "all seven");
  await shot(page, "grown");
  is((await colours(page, [[15, 0, 8]]))[0], CHOSEN, "the front");
  assert.deepEqual(wrong, []);
  await close();
});
