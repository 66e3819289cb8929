// What is inside a part under its loads: sections and principal lines, at places and with colours that follow from the
// loads; each beside a picture in which they are not.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { boxStl, choose, colours, far, folder, held, hold, launch, load, places, settle, shaped, solve, studio, vector, view, visit } from "./bench.mjs";

const SHOTS = process.env.SHOTS;
const shot = async (page, name) => { if (SHOTS) { await settle(page); await page.screenshot({ path: `${SHOTS}/${name}.png` }); } };

let files, server, browser;
before(async () => {
  files = folder({ "bar.stl": boxStl([60, 8, 4]) });
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

/** A bar held at its left end, with a force on its right one, solved. */
async function bar(force, options) {
  const visited = await visit(browser, server.address, options);
  const { page } = visited;
  await choose(page, "bar.stl");
  await shaped(page);
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await vector(page, "value-1", force);
  await solve(page);
  return visited;
}
const cut = async (page, wanted) => { await page.waitForFunction((w) => document.documentElement.dataset.section === w, wanted); await settle(page); };
const bright = (c) => c[0] + c[1] + c[2];

test("degenerate points are drawn where both principal stresses in the surface are equal", async () => {
  // A stress whose points are known, at the points that were solved: on the top a wedge at (20, 4) and nothing else.
  let isAsked = false;
  const known = async (route) => {
    isAsked = true;
    const bytes = await (await route.fetch({ url: route.request().url().replace(/\/0$/, "") })).body();
    const n = bytes.readUInt32LE(0);
    const nine = new Float32Array(9 * n);
    for (let k = 0; k < n; k++) {
      const [x, y] = [bytes.readFloatLE(8 + 12 * k), bytes.readFloatLE(12 + 12 * k)];
      nine.set([100 + (x - 20), 100 - (x - 20), 0, y - 4, 0, 0], 9 * k);
    }
    await route.fulfill({ body: Buffer.from(nine.buffer), contentType: "application/octet-stream" });
  };
  const { page, wrong, close } = await visit(browser, server.address, { routes: { "**/stress/0": known } });
  await choose(page, "bar.stl");
  await shaped(page);
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await vector(page, "value-1", [100, 0, 0]);
  await solve(page);
  assert.ok(isAsked, "the stress on screen is the test's");
  await view(page, "top");
  await page.mouse.move(5, 5);
  const at = [[20, 4, 4], [40, 4, 4]];
  const [before, besideBefore] = await colours(page, at);
  await page.click("#degenerate");
  const [point, beside] = await colours(page, at);
  await shot(page, "degenerate");
  assert.ok(bright(point) < 120 && bright(before) > bright(point) + 60, `a wedge is dark: ${point}, before ${before}`);
  assert.ok(far(beside, besideBefore) < 6, `${beside} ${besideBefore}`);
  // One above, one below.
  assert.equal(await page.textContent("#degenerate-count"), "(2)");
  await page.click("#degenerate");
  const [after] = await colours(page, at);
  assert.ok(far(after, before) < 6, `${after} ${before}`);
  assert.deepEqual(wrong, []);
  await close();
});

test("a section shows the stress inside, at any place, and takes the half before it away", async () => {
  const { page, wrong, close } = await bar([0, 0, -20]);
  // Bent about y: 4 mm high, so the stress is greatest above and below and none at half height.
  await page.fill("#scale-high", "20");
  await page.press("#scale-high", "Tab");
  await view(page, "top");
  await page.mouse.move(5, 5);
  const at = [[15, 4, 2]];
  const [whole] = await colours(page, at);
  await page.selectOption("#section", { label: "across z" });
  await cut(page, "z 2 true");
  const [middle] = await colours(page, at);
  await shot(page, "section-z");
  assert.ok(bright(whole) > bright(middle) + 120, `the top ${whole}, half height ${middle}`);
  // M = 20 N * 45 mm over I = 8 * 4^3 / 12 mm4, 1.5 mm above the middle.
  await page.fill("#section-at", "3.5");
  await page.press("#section-at", "Tab");
  await cut(page, "z 3.5 true");
  const [[x, y]] = await places(page, [[15, 4, 3.5]]);
  await page.waitForFunction(async ([px, py]) => { const hit = window.studio.part.stress.probe(window.studio.viewer.rayAt(px, py)); return hit && Math.abs(hit.at.z - 3.5) < 0.01; }, [x, y]);
  await page.mouse.move(x, y);
  await settle(page);
  await settle(page);
  const told = Number((await page.textContent("#bead")).match(/principal (-?[\d.]+)/)[1]);
  const wanted = (20 * 45 * 1.5) / ((8 * 4 ** 3) / 12);
  assert.ok(Math.abs(told - wanted) < 0.04 * wanted, `${told} MPa, ${wanted}`);
  // By keyboard: a hundredth of the part for each press.
  await page.focus("#section-slider");
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() => Math.abs(Number(document.getElementById("section-at").value) - 3.46) < 0.03);
  // Across the bar: what lies behind the plane is there, what lies before it is not; the other half is the reverse.
  await page.mouse.move(5, 5);
  await view(page, "front");
  await page.selectOption("#section", { label: "across x" });
  await cut(page, "x 30 true");
  const both = [[15, 0, 0.3], [50, 0, 0.3]];
  const [left, right] = await colours(page, both);
  await page.click("#section-other");
  await cut(page, "x 30 false");
  const [gone, there] = await colours(page, both);
  await shot(page, "section-x");
  assert.ok(far(left, gone) > 60 && far(right, there) > 60, `${left} ${gone}; ${right} ${there}`);
  await page.selectOption("#section", { label: "none" });
  await cut(page, "none");
  const [again, also] = await colours(page, both);
  assert.ok(far(again, left) < 12 && far(also, there) < 12, `${again} ${left}; ${also} ${there}`);
  assert.deepEqual(wrong, []);
  await close();
});

test("principal lines are red in tension and blue in compression, in the part", async () => {
  const late = held();
  const { page, wrong, close } = await bar([0, 20, 0], { routes: { "**/lines": late.answer } });
  await view(page, "top");
  await page.mouse.move(5, 5);
  const [before] = await colours(page, [[15, 1, 2]]);
  // Lines that come after they were switched off again are not drawn.
  await page.click("#lines");
  await late.asked;
  await page.click("#lines");
  await late.free(page, "**/lines");
  assert.equal(await page.evaluate(() => window.studio.part.stress.hasLines), false);
  await page.click("#lines");
  await page.waitForFunction(() => document.documentElement.dataset.lines === "true");
  const lines = await page.evaluate(async () => {
    const bytes = await (await fetch(`v1/jobs/${document.documentElement.dataset.stress}/stress/0/lines`)).arrayBuffer();
    const count = new Uint32Array(bytes, 0, 1)[0];
    const points = new Float32Array(bytes, 4 + 4 * count);
    const found = [];
    let from = 0;
    for (const length of new Uint32Array(bytes, 4, count)) { found.push(Array.from({ length }, (_, k) => [...points.subarray(4 * (from + k), 4 * (from + k) + 4)])); from += length; }
    return found;
  });
  // Seen from above the force points up: the lower border is pulled and the upper one pressed.
  const near = (isLow) => lines.flat().filter(([x, y]) => x > 12 && x < 25 && (isLow ? y < 2 : y > 6));
  assert.ok(near(true).length > 5 && near(false).length > 5);
  assert.ok(near(true).every((p) => p[3] > 0) && near(false).every((p) => p[3] < 0));
  // The uppermost point of each: nothing lies over it.
  const top = (all) => all.reduce((a, b) => (b[2] > a[2] ? b : a)).slice(0, 3);
  const [red, blue] = await colours(page, [top(near(true)), top(near(false))]);
  await shot(page, "lines-top");
  assert.ok(red[0] > red[2] + 50 && red[0] > red[1] + 50, `${red}`);
  assert.ok(blue[2] > blue[0] + 50 && blue[2] > blue[1] + 40, `${blue}`);
  await view(page, "oblique");
  await shot(page, "lines");
  await view(page, "top");
  await page.click("#lines");
  await page.waitForFunction(() => document.documentElement.dataset.lines === "false");
  const [after] = await colours(page, [[15, 1, 2]]);
  assert.ok(far(before, after) < 8, `${before} ${after}`);
  assert.ok(!(after[0] > after[2] + 50 && after[0] > after[1] + 50), `the surface is not red there: ${after}`);
  assert.deepEqual(wrong, []);
  await close();
});
