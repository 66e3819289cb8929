// How the part stands, its defects and its supports: colours at places that follow from the model, each with a control
// that must differ.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { boxStl, chooseFace, choose, colours, command, far, folder, held, hold, launch, load, places, settle, shaped, shapedAnew, shapeRun, stl, studio, vector, view, visit } from "./bench.mjs";

const HELD = [70, 130, 190];
const LOADED = [226, 120, 58];
const PLAIN = [178, 188, 196];
const FAULT = [214, 120, 0];
const LEFT = [208, 31, 60];
const ENFORCED = [60, 150, 80];
const SHOTS = process.env.SHOTS;
const shot = async (page, name) => { if (SHOTS) { await settle(page); await page.screenshot({ path: `${SHOTS}/${name}.png` }); } };

/** The triangles of a box, without those of the sides named. */
function box([x, y, z], [X, Y, Z], without = []) {
  const c = (k) => [k & 1 ? X : x, k & 2 ? Y : y, k & 4 ? Z : z];
  const sides = { bottom: [0, 2, 3, 1], top: [4, 5, 7, 6], front: [0, 1, 5, 4], back: [2, 6, 7, 3], left: [0, 4, 6, 2], right: [1, 3, 7, 5] };
  return Object.entries(sides).filter(([name]) => !without.includes(name)).flatMap(([, f]) => [[f[0], f[1], f[2]], [f[0], f[2], f[3]]].map((t) => t.map(c)));
}
/** A box open at its top, and one whose right side lies a little off, so that mending closes it. */
function faulty() {
  const off = box([30, 0, 0], [50, 20, 10], ["left", "front", "back", "top", "bottom"]).map((t) => t.map(([x, y, z]) => [x + 1.6e-5, y, z]));
  return stl([...box([0, 0, 0], [20, 20, 10], ["top"]), ...box([30, 0, 0], [50, 20, 10], ["right"]), ...off]);
}
let files, server, browser;
before(async () => {
  files = folder({ "bar.stl": boxStl([8, 8, 30]), "faulty.stl": faulty(), "tee.stl": stl([...box([16, 0, 0], [24, 12, 20.2]), ...box([0, 0, 20], [40, 12, 24])]) });
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

async function opened(name, options) {
  const visited = await visit(browser, server.address, options);
  await choose(visited.page, name);
  await shaped(visited.page);
  return visited;
}
function hue(a, b) {
  const dot = a.reduce((sum, v, k) => sum + v * b[k], 0);
  return Math.sqrt(Math.max(1 - (dot / (Math.hypot(...a) * Math.hypot(...b))) ** 2, 0));
}
const is = (found, wanted, what) => assert.ok(hue(found, wanted) < 0.1, `${what}: ${found} is not ${wanted}`);
const isNot = (found, other, what) => assert.ok(hue(found, other) > 0.14, `${what}: ${found} is ${other}`);
const text = (page) => page.$eval("#panel-job textarea", (area) => area.value);
const rows = (page) => page.$$eval("#poses tr", (all) => all.slice(1).map((r) => [...r.children].map((c) => c.textContent)));
async function compare(page) {
  const before = await page.evaluate(() => document.documentElement.dataset.poses);
  await page.click("#compare-poses");
  await page.waitForFunction((b) => { const { poses } = document.documentElement.dataset; return (poses && poses !== b) || document.querySelector("#progress .error"); }, before, { timeout: 120_000 });
}

/** A point of the file where the part stands, turned about x, then y, then z and put on the plate. */
function stood(p, [rx, ry, rz], corners) {
  const turn = ([x, y, z]) => {
    const [a, b, c] = [rx, ry, rz].map((d) => (d * Math.PI) / 180);
    [y, z] = [y * Math.cos(a) - z * Math.sin(a), y * Math.sin(a) + z * Math.cos(a)];
    [x, z] = [x * Math.cos(b) + z * Math.sin(b), -x * Math.sin(b) + z * Math.cos(b)];
    return [x * Math.cos(c) - y * Math.sin(c), x * Math.sin(c) + y * Math.cos(c), z];
  };
  const low = Math.min(...corners.map((q) => turn(q)[2]));
  const [x, y, z] = turn(p);
  return [x, y, z - low];
}

test("build directions are compared by height, support and what the loads do to the layers, and taken with the loads", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  // Without loads, height and support decide.
  await page.click("#tab-shape");
  await compare(page);
  let found = await rows(page);
  assert.deepEqual([found.length, found[0][1], found[5][1]], [6, "8.0 mm", "30.0 mm"]);
  assert.deepEqual(found.filter((r) => r[0] === "stands").map((r) => r[1]), ["30.0 mm"]);
  assert.equal(found[0].length, 4, "no column of loads");
  await hold(page, [4, 4, 0]);
  await load(page, [4, 4, 30]);
  await vector(page, "value-1", [0, 0, 400]);
  await page.click("#follow");
  await page.click("#tab-shape");
  assert.deepEqual(await rows(page), [], "a list made before the loads is taken away");
  await compare(page);
  found = await rows(page);
  await page.evaluate(() => document.querySelector("#poses").scrollIntoView({ block: "center" }));
  await shot(page, "poses");
  writeFileSync(files.at("bar.toml"), await text(page));
  const theirs = JSON.parse(command(files.dir, "orient", "bar.toml", "--json")).poses;
  assert.deepEqual(found.map((r) => r.slice(1)), theirs.map((p) => [`${p.height_mm.toFixed(1)} mm`, `${p.support_g.toFixed(2)} g`, `${Math.round(p.time_s / 60)} min`, `${p.reserve.across_layers_mpa.toFixed(2)} MPa`, `${p.reserve.first_failure[1].toFixed(2)} ×`]));
  // 400 N over 64 mm2 pull on the layers where the bar stands.
  assert.ok(Math.abs(parseFloat(found[5][4]) / 6.25 - 1) < 0.25 && parseFloat(found[0][4]) < 2, `${found}`);
  const before = await shapeRun(page);
  await page.click("[data-pose='0']");
  await shapedAnew(page, before);
  assert.match(await page.textContent("#size"), /× 8\.00 mm$/);
  assert.deepEqual([(await rows(page))[0][0], (await rows(page)).length], ["stands", 6], "the list stays");
  const now = await text(page);
  assert.match(now, /frame = "part"/);
  assert.match(now, /force_n = \[0, 0, 400\]/);
  // The faces went with the part: one end is blue, the other one orange, the side is neither.
  const turn = theirs[0].rotate_deg;
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [k & 1 ? 8 : 0, k & 2 ? 8 : 0, k & 4 ? 30 : 0]);
  const [held, loaded, side] = [[4, 4, 0], [4, 4, 30], [4, 4, 15]].map((p) => stood(p, turn, corners));
  // From that side of the part on which the end is.
  const seen = async (end) => {
    await page.evaluate(([at, from]) => { const v = window.studio.viewer; v.controls.target.set(...at); v.camera.position.set(...from); v.camera.updateProjectionMatrix(); v.controls.update(); v.draw(); }, [end, end.map((v, k) => v + 4 * (v - side[k]) + (k === 2 ? 25 : 3))]);
    await settle(page);
    return (await colours(page, [end.map((v, k) => v + (k === 2 ? 2.2 : 0))]))[0];
  };
  is(await seen(held), HELD, "the held end");
  isNot(await seen(loaded), HELD, "the loaded end");
  is(await seen(loaded), LOADED, "the loaded end");
  const taken = await shapeRun(page);
  await page.keyboard.press("Control+z");
  await shapedAnew(page, taken);
  assert.match(await page.textContent("#size"), /× 30\.00 mm$/);
  assert.doesNotMatch(await text(page), /frame/);
  assert.deepEqual(wrong, []);
  await close();
});

test("a part that is turned while its build directions are compared stands as it was turned", async () => {
  let isCompared = false;
  const late = held(() => isCompared);
  const { page, wrong, close } = await opened("bar.stl", { routes: { "**/result": late.answer } });
  const run = await shapeRun(page);
  isCompared = true;
  await page.click("#compare-poses");
  await late.asked;
  isCompared = false;
  await page.click("#turn-x");
  await shapedAnew(page, run);
  await late.free(page, "**/result");
  await page.waitForFunction(() => document.documentElement.dataset.poses);
  assert.deepEqual((await rows(page)).filter((r) => r[0] === "stands").map((r) => r[1]), ["8.0 mm"]);
  assert.deepEqual(wrong, []);
  await close();
});

test("loads that are told by boxes keep the part from being turned, with the reason", async () => {
  writeFileSync(files.at("boxed.toml"), '[shape]\nmesh = "bar.stl"\n\n[[guide.fixture]]\non = { box_mm = [[0, 0, 0], [8, 8, 4]] }\nfix = "xyz"\n\n[[guide.load]]\non = { box_mm = [[0, 0, 26], [8, 8, 30]] }\nforce_n = [0, 0, 100]\n');
  const { page, wrong, close } = await opened("boxed.toml");
  await page.click("#tab-shape");
  await compare(page);
  const before = await text(page);
  await page.click("[data-pose]:not([disabled])");
  assert.match(await page.textContent("#progress .error"), /fixture 1 is told in the frame of the plate .* guide\.frame = "part"/);
  assert.equal(await text(page), before);
  assert.deepEqual(wrong, []);
  await close();
});

test("defects of the file are drawn where they are, those that mending leaves in another colour", async () => {
  const { page, wrong, close } = await opened("faulty.stl");
  await page.click("#tab-shape");
  // Four edges around the missing top; four of the loose side, twice.
  assert.match(await page.textContent("#defects"), /open edges12/);
  assert.match(await page.textContent("#panel-shape"), /4 edges are left after mending/);
  await page.click("#next-defect");
  assert.match(await page.textContent("#defect"), /^1 of 3, at \(10\.0, 10\.0, 10\.0\)$/);
  // Seen obliquely from the front left and above: the rim at the left front, and the loose side's upper edge from the top.
  await view(page, "top");
  await shot(page, "defects");
  const [rim, mended, sound] = await colours(page, [[0, 10, 10], [50, 10, 10], [40, 20, 10]]);
  // Lines of 3 and 4 pixels at the border of the part: a third of what is looked at may be what lies beside them.
  const off = [rim, mended, sound].map((c) => [hue(c, LEFT), hue(c, FAULT)]);
  assert.ok(off[0][0] < 0.3 && off[0][1] > 0.3, `the rim of the missing top: ${rim}`);
  assert.ok(off[1][1] < 0.3 && off[1][0] > 0.3, `the edge that was mended: ${mended}`);
  assert.ok(off[2].every((v) => v > 0.4), `a sound edge: ${sound}`);
  assert.deepEqual(wrong, []);
  await close();
  const sane = await opened("bar.stl");
  await sane.page.click("#tab-shape");
  assert.match(await sane.page.textContent("#defects"), /None: the surface is closed/);
  assert.equal(await sane.page.$("#next-defect"), null);
  await sane.close();
});

test("supports are shown with what their branches bear, and facets are painted for and against them", async () => {
  const late = held();
  const { page, wrong, close } = await opened("tee.stl", { routes: { "**/branches": late.answer } });
  await page.click("#tab-shape");
  // Supports of another material than the one that is chosen by then are not shown.
  const material = "#printer-and-material select >> nth=1";
  await page.click("#grow-supports");
  await late.asked;
  await page.selectOption(material, "petg");
  await late.free(page, "**/branches");
  await page.waitForSelector("#supports:has-text('The job has changed')");
  await page.selectOption(material, "pla");
  const grow = async () => {
    const before = await page.evaluate(() => document.documentElement.dataset.supports);
    await page.click("#grow-supports");
    await page.waitForFunction((b) => { const { supports } = document.documentElement.dataset; return (supports && supports !== b) || document.querySelector("#progress .error"); }, before, { timeout: 120_000 });
    await settle(page);
  };
  await grow();
  const theirs = JSON.parse(command(files.dir, "support", "tee.stl", "-o", "support.stl", "--json")).support;
  assert.ok(theirs.contacts > 4, JSON.stringify(theirs));
  assert.equal(await page.textContent("#support-contacts"), `${theirs.contacts}, ${theirs.trees}`);
  assert.equal(await page.textContent("#support-mass"), `${theirs.mass_g.toFixed(2)} g`);
  // The trunk that bears most is yellow, the end of the ramp; it stands below an arm, nearest to the front.
  const trunks = await page.evaluate(() => { const r = window.studio.part.branchRows; const all = []; for (let k = 0; k < r.length; k += 10) all.push([...r.slice(k, k + 10)]); return all; });
  const most = Math.max(...trunks.map((t) => t[8]));
  const trunk = trunks.filter((t) => t[8] === most).sort((a, b) => Math.hypot(b[2] - b[6]) - Math.hypot(a[2] - a[6]))[0];
  const middle = [0, 1, 2].map((k) => 0.5 * (trunk[k] + trunk[k + 4]));
  await view(page, "front");
  await shot(page, "supports");
  const at = [middle[0], middle[1] - 0.5 * (trunk[3] + trunk[7]), middle[2]];
  is((await colours(page, [at]))[0], [253, 231, 37], "the trunk that bears most");
  // The pointer tells what it bears.
  const [[x, y]] = await places(page, [at]);
  await page.mouse.move(x, y);
  await page.waitForFunction(() => /bears/.test(document.querySelector("#bead").textContent));
  assert.ok((await page.textContent("#bead")).includes(`bears ${most.toFixed(2)} N`), await page.textContent("#bead"));
  await page.mouse.move(5, 5);
  // Never below the arms: nothing grows, and the place is empty.
  await chooseFace(page, [20, 6, 20]);
  await page.click("#tab-shape");
  await page.click("#faces-block");
  assert.match(await text(page), /block_facets = \[\d+, \d+\]/);
  await grow();
  assert.match(await page.textContent("#supports"), /Nothing needs support/);
  await view(page, "front");
  isNot((await colours(page, [at]))[0], [253, 231, 37], "no trunk is left");
  // The brush paints facets, and a stroke is undone in one go.
  await view(page, "oblique");
  const [left, right] = await places(page, [[4, 6, 24], [36, 6, 24]]);
  await page.click("#paint-enforce");
  const stroke = async (from, to) => {
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 6 });
    await page.mouse.up();
    await page.mouse.move(5, 5);
  };
  const run = await shapeRun(page);
  await stroke(left, right);
  const first = (await text(page)).match(/enforce_facets = \[\d+, \d+\]/)?.[0];
  assert.ok(first, await text(page));
  // Supports lift the part, so it is made anew; the brush stays in hand.
  await shapedAnew(page, run);
  const lift = await page.evaluate(() => window.studio.part.low.z);
  await stroke(...(await places(page, [[20, 0, 4 + lift], [20, 0, 16 + lift]])));
  assert.match(await text(page), /enforce_facets = \[\d+, \d+, \d+, \d+\]/);
  let [top, front] = await colours(page, [[10, 6, 24 + lift], [10, 0, 22 + lift]]);
  await shot(page, "painted");
  is(top, ENFORCED, "the painted top");
  is(front, PLAIN, "the front, which was not painted");
  assert.equal(await page.evaluate(() => window.studio.chosen.length), 1, "painting chooses no face");
  await page.keyboard.press("Escape");
  await page.focus("#view");
  await page.keyboard.press("Control+z");
  assert.ok((await text(page)).includes(first), await text(page));
  const lifted = await shapeRun(page);
  await page.keyboard.press("Control+z");
  await shapedAnew(page, lifted);
  [top] = await colours(page, [[10, 6, 24]]);
  isNot(top, ENFORCED, "the top after undoing");
  assert.deepEqual(wrong, []);
  await close();
});
