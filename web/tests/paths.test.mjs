// Toolpaths on the screen: colours at places that follow from the program, each beside a control that must differ.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { boxStl, choose, colours, far, folder, launch, places, settle, shaped, shown, squares, studio, view, visit } from "./bench.mjs";

const WALL = [214, 93, 32];
const FILL = [86, 178, 171];
const PLAIN = [184, 191, 196];
const SEAM = [208, 31, 60];
const NEAR = 30;
/** Middles of beads of the highest layer (6: lines along y), and a place between them. */
const wallAt = [50, 60, 1.2];
const fillAt = [52, 47, 1.2];
const emptyAt = [54, 47, 1.2];

let files, server, browser, visited, page;
before(async () => {
  // On the way from the first line of fill to the second one filament is pulled back and pushed again, in every other layer.
  const pulled = squares().replaceAll("G1 X48.000 Y41.000 F6000", "G1 E-0.8 F2400\nG1 X48.000 Y41.000 F6000\nG1 E0.8 F2400");
  files = folder({ "squares.gcode": pulled });
  server = await studio(files.dir, "squares.gcode");
  browser = await launch();
  visited = await visit(browser, server.address);
  page = visited.page;
  await shown(page);
  await page.click("#tab-paths");
  await view(page, "top");
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

const slide = async (id, value) => { await page.$eval(`#${id}`, (input, v) => { input.focus(); input.value = String(v); input.dispatchEvent(new Event("input", { bubbles: true })); }, value); await settle(page); };
const reset = async () => { await slide("high", 5); await slide("low", 0); await page.selectOption("#colour-by", "role"); };
const near = (found, wanted, what) => assert.ok(far(found, wanted) < NEAR, `${what}: ${found} is not ${wanted}`);
const unlike = (found, other, what) => assert.ok(far(found, other) > NEAR, `${what}: ${found} is ${other}`);

test("WebGL is there and is named", async () => {
  const name = await page.evaluate(() => window.studio.rendererName);
  console.log(`renderer: ${name}`);
  assert.match(name, /llvmpipe|SwiftShader|Mesa|NVIDIA|AMD|Intel|Apple/);
  assert.equal(await page.evaluate(() => window.studio.viewer.renderer.getContext().isContextLost()), false);
});

test("walls and fill have the colours of their roles", async () => {
  await reset();
  const [wall, fill, empty] = await colours(page, [wallAt, fillAt, emptyAt]);
  near(wall, WALL, "wall");
  near(fill, FILL, "fill");
  unlike(empty, FILL, "between lines of fill");
});

test("a role that is switched off is not drawn", async () => {
  await reset();
  await page.click("#class-0");
  const [wall, fill] = await colours(page, [wallAt, fillAt]);
  unlike(wall, WALL, "wall");
  near(fill, FILL, "fill");
  await page.click("#class-0");
  near((await colours(page, [wallAt]))[0], WALL, "wall again");
});

test("the legend names the roles with their colours", async () => {
  await reset();
  assert.deepEqual(await page.$$eval("#legend div", (rows) => rows.map((r) => r.textContent)), ["External perimeter", "Internal infill"]);
  const background = await page.$eval("#legend .swatch", (s) => getComputedStyle(s).backgroundColor);
  assert.equal(background, `rgb(${WALL.join(", ")})`);
});

test("colour by speed is dark for slow walls and bright for fast fill", async () => {
  await reset();
  await page.selectOption("#colour-by", "speed");
  const [wall, fill] = await colours(page, [wallAt, fillAt]);
  near(wall, [68, 1, 84], "20 mm/s, the least");
  near(fill, [253, 231, 37], "80 mm/s, the most");
  assert.deepEqual(await page.$$eval("#legend .ends span", (s) => s.map((x) => x.textContent)), ["20.0", "80.0"]);
});

test("colour by width is bright for wide walls and dark for narrow fill", async () => {
  await reset();
  await page.selectOption("#colour-by", "width");
  const [wall, fill] = await colours(page, [wallAt, fillAt]);
  near(wall, [253, 231, 37], "0.8 mm");
  near(fill, [68, 1, 84], "0.6 mm");
});

test("colour by angle tells directions apart and not the way along them", async () => {
  await reset();
  await page.selectOption("#colour-by", "angle");
  const [along, back, up] = await colours(page, [[50, 40, 1.2], [50, 60, 1.2], fillAt]);
  near(along, back, "the walls at both sides run along x");
  unlike(up, along, "fill along y");
});

test("colour by flow and by height change the picture", async () => {
  await reset();
  await page.selectOption("#colour-by", "flow");
  const [wall, fill] = await colours(page, [wallAt, fillAt]);
  unlike(wall, fill, "flow");
  await page.selectOption("#colour-by", "height");
  near((await colours(page, [wallAt]))[0], [253, 231, 37], "the top");
});

test("the scale of the flow ends at a flow that the program has", async () => {
  await reset();
  await page.selectOption("#colour-by", "flow");
  // Fill: 0.6 mm wide, 0.2 mm high, 80 mm/s; walls are wider and four times slower.
  const most = 0.2 * (0.6 - 0.2 * (1 - Math.PI / 4)) * 80;
  const ends = await page.$$eval("#legend .ends span", (s) => s.map((x) => Number(x.textContent)));
  assert.ok(ends[0] === 0 && Math.abs(ends[1] - most) < 0.1, `${ends} and ${most}`);
  near((await colours(page, [fillAt]))[0], [253, 231, 37], "the fastest fill");
});

test("seams are drawn where closed walls begin, and nowhere else", async () => {
  await reset();
  // Each wall begins at (40, 40) and runs along x.
  const [seam, along, fill] = [[40.8, 40, 1.2], [50, 40, 1.2], fillAt];
  unlike((await colours(page, [seam]))[0], SEAM, "by role");
  await page.selectOption("#colour-by", "seam");
  const found = await colours(page, [seam, along, fill]);
  near(found[0], SEAM, "the seam");
  near(found[1], PLAIN, "the rest of the wall");
  near(found[2], PLAIN, "fill");
  assert.deepEqual(await page.$$eval("#legend div", (rows) => rows.map((r) => r.textContent)), ["where a closed wall begins (6)", "other beads"]);
  const [[x, y]] = await places(page, [seam]);
  await page.mouse.move(x, y);
  await page.waitForFunction(() => document.getElementById("bead").textContent.includes("seam"));
  await page.mouse.move(5, 5);
});

test("layers are coloured by the time that they take", async () => {
  const own = folder({ "slow.gcode": squares(3).replace(";LAYER_CHANGE\nG1 Z0.60", "G4 S60\n;LAYER_CHANGE\nG1 Z0.60") });
  const other = await studio(own.dir, "slow.gcode");
  const visited = await visit(browser, other.address);
  await shown(visited.page);
  await visited.page.click("#tab-paths");
  await view(visited.page, "top");
  await visited.page.selectOption("#colour-by", "time");
  // The pause is in the second layer: its wall is bright where the third one is not shown, and that of the third is dark.
  const third = (await colours(visited.page, [[50, 60, 0.6]]))[0];
  await visited.page.$eval("#high", (input) => { input.focus(); input.value = "1"; input.dispatchEvent(new Event("input", { bubbles: true })); });
  const second = (await colours(visited.page, [[50, 60, 0.4]]))[0];
  near(second, [253, 231, 37], "with the pause");
  unlike(third, second, "without");
  const ends = await visited.page.$$eval("#legend .ends span", (s) => s.map((x) => Number(x.textContent)));
  assert.ok(ends[1] - ends[0] > 55 && ends[0] > 3, `${ends}`);
  assert.match(await visited.page.textContent("#legend"), /Layer time, s/);
  assert.deepEqual(visited.wrong, []);
  await visited.close();
  await other.end();
  own.remove();
});

test("a program without a guide has no angle off a load", async () => {
  assert.deepEqual(await page.$$eval("#colour-by option", (all) => all.map((o) => o.value)), ["role", "speed", "width", "angle", "flow", "height", "time", "seam"]);
});

test("a plan that follows its guide is coloured by the angle off the load", async () => {
  const job = (angle) => `[shape]\nmesh = "bar.stl"\n[process]\nwalls = 1\n[fill]\npattern = "rectilinear"\ndensity = 1.0\nangles_deg = [${angle}]\n[guide]\nkind = "stress"\n` +
    '[[guide.fixture]]\non = { box_mm = [[0, 0, 0], [0, 8, 2]] }\nfix = "xyz"\n[[guide.load]]\non = { box_mm = [[40, 0, 0], [40, 8, 2]] }\nforce_n = [100, 0, 0]\n';
  const own = folder({ "bar.stl": boxStl([40, 8, 2]), "along.toml": job(0), "across.toml": job(90) });
  const other = await studio(own.dir);
  const found = {};
  for (const name of ["along", "across"]) {
    const visited = await visit(browser, other.address);
    await choose(visited.page, `${name}.toml`);
    await shaped(visited.page);
    await visited.page.click("#tab-job");
    await visited.page.click("#panel-job button.main");
    await visited.page.waitForFunction(() => document.documentElement.dataset.angles, null, { timeout: 240_000 });
    await view(visited.page, "top");
    await visited.page.selectOption("#colour-by", "load");
    const [low, high] = await visited.page.evaluate(() => window.studio.viewer.beads.index.part_mm);
    // The middle of a bar that is pulled along x, where a bead of the solid fill lies.
    found[name] = (await colours(visited.page, [[0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), high[2]]]))[0];
    assert.deepEqual(await visited.page.$$eval("#legend .ends span", (s) => s.map((x) => x.textContent)), ["0°", "90°"]);
    assert.deepEqual(visited.wrong, []);
    await visited.close();
  }
  // Between two beads it is darker, so hues are compared: dark violet is 0 degrees, yellow is 90.
  const [along, across] = [found.along, found.across];
  assert.ok(along[2] > along[1] && along[1] < 60, `along the pull: ${along}`);
  assert.ok(across[0] > 120 && across[1] > 120 && across[2] < 90, `across the pull: ${across}`);
  await other.end();
  own.remove();
});

test("a plan with loads is coloured by the factor at which its beads fail", async () => {
  // A beam that is bent in its plane, with beads across it: they fail in proportion to their distance from the load.
  const job = `[shape]\nmesh = "bar.stl"\n[process]\nwalls = 1\n[fill]\npattern = "rectilinear"\ndensity = 1.0\nangles_deg = [90]\n[guide]\nkind = "stress"\n` +
    '[[guide.fixture]]\non = { box_mm = [[0, 0, 0], [0, 8, 2]] }\nfix = "xyz"\n[[guide.load]]\non = { box_mm = [[40, 0, 0], [40, 8, 2]] }\nforce_n = [0, 10, 0]\n';
  const own = folder({ "bar.stl": boxStl([40, 8, 2]), "bent.toml": job });
  const other = await studio(own.dir);
  const visited = await visit(browser, other.address);
  await choose(visited.page, "bent.toml");
  await shaped(visited.page);
  await visited.page.click("#tab-job");
  await visited.page.click("#panel-job button.main");
  await visited.page.waitForFunction(() => document.documentElement.dataset.reserve, null, { timeout: 240_000 });
  await view(visited.page, "top");
  // The beads of the top layer that lie 10 and 30 mm from the fixture: their middles, and their reserves as they were sent.
  const found = await visited.page.evaluate(async () => {
    const { beads } = window.studio.viewer;
    const id = document.documentElement.dataset.reserve;
    const last = beads.index.layers.length - 1;
    const bytes = new Uint8Array(await (await fetch(`v1/jobs/${id}/layers/${last}-${last}/reserve`)).arrayBuffer());
    const near = (x) => {
      const all = Array.from(bytes.keys()).slice(1).map((k) => ({ k, ...beads.bead(beads.first[last] + k) }));
      const across = all.filter((b) => b.kind < beads.travel && Math.abs(b.b[1] - b.a[1]) > 5 && Math.abs(b.b[0] - b.a[0]) < 0.1);
      const best = across.sort((p, q) => Math.abs(p.a[0] - x) - Math.abs(q.a[0] - x))[0];
      return { at: [best.a[0], 0.5 * (best.a[1] + best.b[1]), beads.index.part_mm[1][2]], factor: 2 ** ((bytes[best.k] - 80) / 20) };
    };
    const x = beads.index.part_mm[0][0];
    const told = (await (await fetch(`v1/jobs/${id}/result`)).json()).report.reserve.first_failure[1];
    return { told, root: near(x + 10), tip: near(x + 30) };
  });
  const { told, root, tip } = found;
  assert.ok(told < root.factor && Math.abs(tip.factor / root.factor / 3 - 1) < 0.2, JSON.stringify(found));
  const viridis = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [110, 206, 88], [253, 231, 37]];
  const wanted = ({ factor }) => {
    const at = 8 * Math.min(Math.max(1 - Math.log10(factor / told), 0), 1);
    const k = Math.min(Math.floor(at), 7);
    return viridis[k].map((v, c) => v + (viridis[k + 1][c] - v) * (at - k));
  };
  const role = await colours(visited.page, [root.at, tip.at]);
  await visited.page.selectOption("#colour-by", "reserve");
  const shown = await colours(visited.page, [root.at, tip.at]);
  near(shown[0], wanted(root), "near the fixture");
  near(shown[1], wanted(tip), "near the load");
  unlike(shown[0], wanted(tip), "near the fixture");
  unlike(role[0], wanted(root), "by role");
  unlike(role[1], wanted(tip), "by role");
  const ends = await visited.page.$$eval("#legend .ends span", (s) => s.map((x) => x.textContent));
  assert.equal(ends.length, 3);
  for (const [k, factor] of [10, Math.sqrt(10), 1].entries()) assert.ok(ends[k].endsWith(" ×") && Math.abs(Number.parseFloat(ends[k]) / (factor * told) - 1) < 0.06, `${ends} and ${told}`);
  const [[x, y]] = await places(visited.page, [root.at]);
  await visited.page.mouse.move(x, y);
  await visited.page.waitForFunction(() => document.getElementById("bead").textContent.includes("fails at"));
  const words = await visited.page.textContent("#bead");
  assert.ok(Math.abs(Number.parseFloat(words.split("fails at ")[1]) / root.factor - 1) < 0.06, `${words} and ${root.factor}`);
  assert.deepEqual(visited.wrong, []);
  await visited.close();
  await other.end();
  own.remove();
});

test("a lower layer shows its own lines", async () => {
  await reset();
  await slide("high", 4);
  const z = 1.0;
  const [across, along] = await colours(page, [[47, 52, z], [52, 46, z]]);
  near(across, FILL, "line along x of layer 5");
  near(along, FILL, "line along y of layer 4 below it");
  await slide("low", 4);
  const [own, below] = await colours(page, [[47, 52, z], [52, 46, z]]);
  near(own, FILL, "line along x of layer 5 alone");
  unlike(below, FILL, "layer 4 is not shown");
});

test("the moves of the highest layer end where the slider says", async () => {
  await reset();
  await slide("low", 5);
  const n = Number(await page.getAttribute("#to", "max"));
  await slide("to", 4);
  const [wall, fill] = await colours(page, [wallAt, fillAt]);
  near(wall, WALL, "the wall is printed first");
  unlike(fill, FILL, "the fill is not printed yet");
  await slide("to", n);
  near((await colours(page, [fillAt]))[0], FILL, "now it is");
});

test("the moves of the highest layer begin where the slider says", async () => {
  await reset();
  await slide("low", 5);
  await slide("from", 6);
  const [wall, fill] = await colours(page, [[50, 40, 1.2], fillAt]);
  unlike(wall, WALL, "before the first move");
  near(fill, FILL, "after it");
});

test("the ends of a slider do not pass each other", async () => {
  await reset();
  await slide("low", 3);
  await slide("high", 1);
  assert.equal(await page.inputValue("#low"), "1");
  await slide("low", 4);
  assert.equal(await page.inputValue("#high"), "4");
});

test("travels are drawn when asked for", async () => {
  await reset();
  await slide("low", 5);
  // The travel from the end of one line of fill to the start of the next: (44, 59) to (48, 41).
  const at = [[46, 50, 1.2]];
  const [without] = await colours(page, at);
  await page.click("#class-14");
  const [where] = await places(page, at);
  const hit = await page.evaluate(async ([x, y]) => x > 0 && y > 0, where);
  assert.ok(hit);
  const shades = await colours(page, [[46, 50, 1.2], [45.95, 50, 1.2], [46.05, 50, 1.2]]);
  assert.ok(shades.some((c) => far(c, without) > 12), `${shades} beside ${without}`);
  await page.click("#class-14");
});

test("places where filament is pulled back and pushed again are marked when asked for", async () => {
  const [RETRACTION, PUSH] = [[206, 0, 160], [0, 146, 70]];
  await reset();
  await slide("low", 5);
  // The end of the first line and the start of the second one; marks stand on the layer.
  const at = [[44, 59, 1.8], [48, 41, 1.8]];
  const look = () => colours(page, at);
  for (const found of await look()) { unlike(found, RETRACTION, "before"); unlike(found, PUSH, "before"); }
  assert.match(await page.textContent("tr:has(#class-16)"), /^Retraction3$/);
  await page.click("#class-16");
  const [pulled, other] = await look();
  near(pulled, RETRACTION, "the end of a line");
  unlike(other, RETRACTION, "the start of the next one");
  await page.click("#class-17");
  near((await look())[1], PUSH, "the start of the next line");
  unlike((await colours(page, [[52, 41, 1.8]]))[0], PUSH, "the start of a line without a retraction before it");
  // Before the retraction nothing is drawn of it.
  await slide("to", 5);
  unlike((await look())[0], RETRACTION, "before its move");
  await page.click("#class-16");
  await page.click("#class-17");
  await reset();
  for (const found of await look()) { unlike(found, RETRACTION, "after"); unlike(found, PUSH, "after"); }
});

test("the bead under the pointer tells its numbers", async () => {
  await reset();
  const [[x, y], [ex, ey]] = await places(page, [[52, 47, 1.2], [54, 47, 1.2]]);
  await page.mouse.move(x, y);
  await page.waitForFunction(() => !document.getElementById("bead").hidden);
  const words = await page.textContent("#bead");
  for (const word of ["Internal infill", "layer 6", "0.60 mm wide", "0.20 mm high", "80.0 mm/s", "18.00 mm long", "90°"]) assert.ok(words.includes(word), `${word} in ${words}`);
  await slide("low", 5);
  await page.mouse.move(ex, ey);
  await page.waitForFunction(() => document.getElementById("bead").hidden);
});

test("the bead under the pointer is lit", async () => {
  await reset();
  const [[x, y]] = await places(page, [fillAt]);
  await page.mouse.move(x, y);
  await settle(page);
  near((await colours(page, [[52, 55, 1.2]]))[0], [255, 242, 89], "another place of the same bead");
  await page.mouse.move(5, 5);
  await settle(page);
  near((await colours(page, [[52, 55, 1.2]]))[0], FILL, "not lit any more");
});

test("keys move through layers, moves and views", async () => {
  await reset();
  await page.focus("#view");
  await page.keyboard.press("ArrowDown");
  assert.equal(await page.inputValue("#high"), "4");
  await page.keyboard.press("ArrowUp");
  assert.equal(await page.inputValue("#high"), "5");
  await page.keyboard.press("l");
  assert.equal(await page.inputValue("#low"), "5");
  await page.keyboard.press("l");
  assert.equal(await page.inputValue("#low"), "0");
  const before = await places(page, [[50, 60, 1.2]]);
  await page.keyboard.press("2");
  await settle(page);
  assert.notDeepEqual(await places(page, [[50, 60, 1.2]]), before);
  await page.keyboard.press("1");
  await page.keyboard.press("c");
  assert.equal(await page.inputValue("#colour-by"), "speed");
});

test("numbers of the program stand beside it", async () => {
  const text = await page.textContent("#panel-paths");
  for (const word of ["Squares 1", "Layers6", "Beads48"]) assert.ok(text.includes(word), `${word} in ${text}`);
});

test("at most twenty draw calls, and none while nothing changes", async () => {
  await view(page, "oblique");
  const calls = await page.evaluate(() => window.studio.viewer.renderer.info.render.calls);
  assert.ok(calls > 0 && calls <= 20, `${calls} calls`);
  const frames = () => page.evaluate(() => window.studio.viewer.renderer.info.render.frame);
  const before = await frames();
  await settle(page);
  await settle(page);
  assert.equal(await frames(), before);
  await view(page, "top");
});

test("no request leaves this computer and nothing goes wrong", async () => {
  const own = new URL(server.address).origin;
  assert.ok(visited.requests.length > 5);
  assert.deepEqual(visited.requests.filter((r) => !r.startsWith(own) && !r.startsWith("blob:")), []);
  assert.deepEqual(visited.wrong, []);
});

test("the token is not in the address after the start", async () => {
  assert.ok(!page.url().includes("token"));
});

test("showing a program twenty times leaves nothing behind", async () => {
  const show = () => page.evaluate(() => window.studio.show(1));
  // Objects are made when they are drawn, so they are counted after a frame.
  const objects = async () => {
    await show();
    await settle(page);
    return page.evaluate(() => { const m = window.studio.viewer.renderer.info.memory; return [m.geometries, m.textures]; });
  };
  await objects();
  const before = await objects();
  for (let k = 0; k < 20; k++) await show();
  assert.deepEqual(await objects(), before);
});
