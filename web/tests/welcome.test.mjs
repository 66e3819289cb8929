// What an empty page offers: examples, and files of every kind that a plan can begin with.

import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { PNG } from "pngjs";
import { boxStl, colours, command, far, folder, hands, launch, picture, settle, shaped, shown, studio, until, view, visit } from "./bench.mjs";

/** Corners of the board in the photograph below, pixels of the picture from its upper left corner. */
const BOARD = [[40, 30], [290, 50], [270, 180], [60, 160]];
/** A board on a dark table, as a camera sees it askew, with stripes along the row of its upper corners, as PNG. */
function photograph(width, height) {
  const png = new PNG({ width, height });
  const isIn = (x, y) => BOARD.every(([ax, ay], k) => { const [bx, by] = BOARD[(k + 1) % 4]; return (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0; });
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
    const grey = isIn(x + 0.5, y + 0.5) ? 170 + 50 * Math.sin(0.9 * (y - 0.08 * x)) : 20;
    png.data.set([grey, grey, grey, 255], 4 * (y * width + x));
  }
  return PNG.sync.write(png);
}

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** A grey picture of stripes at 30 degrees from the horizontal, as PNG. */
function stripes(width, height) {
  const png = new PNG({ width, height });
  const [c, s] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
  // Rows of a picture run downwards.
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) png.data.set([...Array(3).fill(128 + 90 * Math.sin((-s * x - c * y) * 0.9)), 255], 4 * (y * width + x));
  return PNG.sync.write(png);
}

/** A ball in voxels of 0.5 mm, n along each side, as NRRD; 40 give a radius of 8 mm. */
function ballNrrd(n = 40) {
  const voxels = Buffer.alloc(n * n * n);
  const middle = (n - 1) / 2;
  for (let z = 0; z < n; z++) for (let y = 0; y < n; y++) for (let x = 0; x < n; x++) voxels[(z * n + y) * n + x] = Math.hypot(x - middle, y - middle, z - middle) < 0.4 * n ? 200 : 20;
  return Buffer.concat([Buffer.from(`NRRD0004\ntype: uint8\ndimension: 3\nsizes: ${n} ${n} ${n}\nspacings: 0.5 0.5 0.5\nencoding: raw\n\n`), voxels]);
}

/** Voxels along each side of a scan whose preview takes some seconds. */
const LARGE = 820;

let files, server, browser;
before(async () => {
  files = folder({ "board.png": stripes(240, 120), "askew.png": photograph(320, 200), "ball.nrrd": ballNrrd(), "large.nrrd": ballNrrd(LARGE), "letter.txt": Buffer.from("Dear Sir or Madam") });
  mkdirSync(files.at("slices"));
  for (let k = 0; k < 3; k++) writeFileSync(files.at(`slices/${k}.png`), stripes(20, 20));
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

const job = (page) => page.$eval("#panel-job textarea", (area) => area.value);
async function opened(name) {
  const visited = await visit(browser, server.address);
  await visited.page.waitForSelector("#welcome h2");
  await visited.page.click("#open");
  await visited.page.click(`#chooser .files button:has-text("${name}")`);
  return visited;
}

test("every example of the command line is offered, and its job is the command line's", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.waitForSelector("[data-example]");
  const names = await page.$$eval("[data-example]", (all) => all.map((b) => b.dataset.example));
  assert.deepEqual([...names].sort(), ["continuous", "ct", "field", "plate", "stress-lines", "tree-support", "woodgrain"]);
  await page.focus('[data-example="plate"]');
  await page.keyboard.press("Enter");
  await shaped(page);
  command(files.dir, "new", "plate", "theirs");
  assert.equal(await job(page), readFileSync(files.at("theirs/job.toml"), "utf8"));
  assert.ok(existsSync(files.at("grainpath-studio/plate/plate.stl")));
  assert.deepEqual(wrong, []);
  await close();
});

test("the example of a photograph is planned from the page", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.click('[data-example="woodgrain"]');
  await page.waitForSelector("#board");
  await page.click("#panel-job >> text=Plan the paths");
  await shown(page);
  const href = await page.getAttribute('#panel-paths a:has-text("gcode")', "href");
  const sent = await page.evaluate(async (address) => (await (await fetch(address)).text()), href);
  command(files.dir, "new", "woodgrain", "wood");
  command(files.dir, "run", "wood/job.toml", "--out", "wood/out");
  const [ours] = readFileSync(files.at("wood/job.toml"), "utf8").match(/gcode = "([^"]+)"/)?.slice(1) ?? ["job.gcode"];
  assert.equal(sent, readFileSync(files.at(`wood/out/${ours}`), "utf8"));
  assert.deepEqual(wrong, []);
  await close();
});

test("a photograph asks for the size of its board, which goes into the job", async () => {
  const { page, close } = await opened("board.png");
  await page.waitForSelector("#board");
  assert.match(await page.textContent("#board"), /No picture says how large/);
  await page.fill("#board-0", "60");
  await page.fill("#board-1", "30");
  await page.fill("#board-2", "2");
  await page.press("#board-2", "Tab");
  assert.match(await job(page), /size_mm = \[60, 30\]/);
  assert.match(await job(page), /thickness_mm = 2/);
  assert.equal(await page.isVisible("#board p"), false);
  await page.click("#panel-job >> text=Plan the paths");
  await shown(page);
  const size = await page.evaluate(() => window.studio.viewer.beads.index.part_mm);
  // The beads end half a width inside the board.
  assert.ok(Math.abs(size[1][0] - size[0][0] - 60) < 1 && Math.abs(size[1][1] - size[0][1] - 30) < 1, JSON.stringify(size));
  await close();
});

test("the corners of a photographed board are dragged to it, and the command line reads them from the job", async () => {
  const { page, wrong, close } = await opened("askew.png");
  await page.waitForSelector("#photo .corner");
  const hand = await hands(page);
  // The picture fills its frame as far as its shape allows.
  const frame = await page.locator("#photo").boundingBox();
  const scale = Math.min(frame.width / 320, frame.height / 200);
  const onScreen = ([x, y]) => [frame.x + 0.5 * frame.width + scale * (x - 160), frame.y + 0.5 * frame.height + scale * (y - 100)];
  const colours = async (...all) => { await settle(page); const shot = await picture(page); return all.map((p) => shot.at(...onScreen(p))); };
  const yellow = (c) => c[0] - c[2] > 60;
  // A point of each side of the board, on the dark table or at its edge.
  const sides = BOARD.map((p, k) => p.map((v, i) => 0.5 * (v + BOARD[(k + 1) % 4][i])));
  const before = await colours(...sides, [10, 190]);
  assert.ok(!before.slice(0, 4).some(yellow), `no outline yet: ${before}`);
  assert.ok(far(before[4], [20, 20, 20]) < 30, `the table is seen: ${before[4]}`);
  for (const [k, from] of [[0, 0], [320, 0], [320, 200], [0, 200]].entries()) {
    await page.mouse.move(...onScreen(from));
    await page.mouse.down();
    await page.mouse.move(...onScreen(BOARD[k].map((v, i) => 0.5 * (v + from[i]))));
    await page.mouse.move(...onScreen(BOARD[k]));
    await page.mouse.up();
  }
  const corners = async () => JSON.parse((await job(page)).match(/corners_px = (\[.*\])/)?.[1] ?? "null");
  const found = await corners();
  for (const k of [0, 1, 2, 3]) assert.ok(far(found[k], BOARD[k]) < 1, `${found}`);
  assert.ok((await colours(...sides)).every(yellow), "the outline lies along the board");
  if (process.env.SHOTS) await page.screenshot({ path: `${process.env.SHOTS}/studio-corners.png` });
  await page.evaluate(axe);
  const serious = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html}`)));
  assert.deepEqual(serious, []);
  // By keyboard: a pixel to the right, ten down, and back by undoing both.
  await page.focus('[data-corner="0"]');
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowDown");
  assert.deepEqual((await corners())[0].map((v, i) => Math.round(10 * (v - found[0][i])) / 10), [1, 10]);
  assert.match(await page.getAttribute('[data-corner="0"]', "aria-label"), /^Upper left corner of the board: 4\d(\.\d)?, [34]\d(\.\d)? px$/);
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  assert.deepEqual(await corners(), found);
  // The whole picture, and back.
  await hand.press("#whole-photo");
  assert.equal(await corners(), null);
  assert.ok(!(await colours(...sides)).some(yellow));
  await page.focus('[data-corner="0"]');
  await page.keyboard.press("Control+z");
  assert.deepEqual(await corners(), found);
  for (const [k, value] of ["60", "30", "2"].entries()) await hand.write(`#board-${k}`, value);
  await hand.press("#panel-job >> text=Plan the paths");
  await page.waitForSelector("html[data-shown]", { timeout: 120_000 });
  // The paths are seen, not the picture.
  await page.waitForSelector("#photo", { state: "hidden", timeout: 10_000 });
  command(files.dir, "run", "grainpath-studio/askew/job.toml", "--out", "again-askew");
  const [name] = readdirSync(files.at("again-askew")).filter((n) => n.endsWith(".gcode"));
  const href = await page.getAttribute('#panel-paths a:has-text("gcode")', "href");
  const sent = await (await page.context().request.get(new URL(href, page.url()).href)).text();
  const theirs = readFileSync(files.at(`again-askew/${name}`), "utf8");
  assert.equal(sent, theirs);
  // The corners reach the plan: the whole picture gives another one.
  const saved = readFileSync(files.at("grainpath-studio/askew/job.toml"), "utf8");
  writeFileSync(files.at("whole.toml"), saved.replace(/^corners_px = .*\n/m, ""));
  command(files.dir, "run", "whole.toml", "--out", "again-whole");
  assert.notEqual(readFileSync(files.at(`again-whole/${name}`), "utf8"), theirs);
  // The job is refused by its check while the board has no size.
  assert.deepEqual(wrong, []);
  await close();
});

test("a scan is planned from its file", async () => {
  const { page, wrong, close } = await opened("ball.nrrd");
  await page.waitForSelector("#panel-job textarea", { state: "attached" });
  assert.match(await job(page), /^# Taken for a scan/);
  // Its surface is shown before it is planned: a ball of 16 mm that stands on the plate.
  await shaped(page);
  await view(page, "top");
  const { low_mm: low, high_mm: high, volume_mm3 } = await page.evaluate(() => window.studio.report);
  for (const k of [0, 1, 2]) assert.ok(Math.abs(high[k] - low[k] - 16) < 0.6, JSON.stringify([low, high]));
  assert.ok(Math.abs(volume_mm3 / (4 / 3 * Math.PI * 8 ** 3) - 1) < 0.05 && Math.abs(low[2]) < 1e-6, `${volume_mm3} ${low[2]}`);
  assert.match(await page.textContent("#preview"), /^A preview at \d\.\d\d mm: no voxels were merged\./);
  const middle = [0, 1].map((k) => 0.5 * (low[k] + high[k]));
  // The top of the ball, its flank, and a corner of its box, which is beside it.
  const [top, flank, beside] = await colours(page, [[...middle, high[2]], [middle[0] + 5, middle[1], high[2] - 2], [low[0] + 0.5, low[1] + 0.5, high[2]]]);
  const grey = (c) => Math.abs(c[0] - c[2]) < 25 && c[1] > 90;
  assert.ok(grey(top) && grey(flank) && far(beside, top) > 30, `${top} ${flank} ${beside}`);
  await page.click("#tab-loads");
  assert.match(await page.textContent("#panel-loads"), /A scan has no faces/);
  assert.equal(await page.$("#solve"), null);
  await page.click("#tab-job");
  await page.click("#panel-job >> text=Plan the paths");
  await shown(page);
  assert.deepEqual(wrong, []);
  const size = await page.evaluate(() => window.studio.viewer.beads.index.part_mm);
  for (const k of [0, 1, 2]) assert.ok(Math.abs(size[1][k] - size[0][k] - 16) < 1.2, JSON.stringify(size));
  await close();
});

test("a preview whose setting has changed is cancelled, and the last one is shown", async () => {
  const { page, wrong, close } = await opened("large.nrrd");
  const runs = async () => (await (await page.context().request.get(new URL("v1/jobs", page.url()).href)).json()).jobs.filter((run) => run.kind === "shape" && run.title === "large");
  /** Waits for the run of this number, of those of the scan, to be in one of these phases. */
  const phase = async (k, ...wanted) => {
    let run;
    await until(async () => wanted.includes((run = (await runs())[k])?.phase), `run ${k} ${wanted}`);
    return run;
  };
  const threshold = (grey) => page.$eval("#panel-job textarea", (area, value) => {
    area.value = area.value.replace(/^ct = (?:\{ path = )?("[^"]*").*$/m, `ct = { path = $1, threshold = ${value} }`);
    area.dispatchEvent(new Event("input"));
  }, grey);
  await page.waitForSelector("#panel-job textarea", { state: "attached" });
  await phase(0, "running");
  await threshold(60);
  const first = await phase(0, "cancelled", "done");
  assert.equal(first.phase, "cancelled", "the first preview went on, or LARGE is too small");
  await phase(1, "running", "waiting");
  await threshold(120);
  assert.equal((await phase(1, "cancelled", "done")).phase, "cancelled");
  const last = await phase(2, "done");
  await page.waitForFunction((id) => document.documentElement.dataset.shape === String(id), last.id);
  // What was cancelled by a change is no message: the user did not cancel anything.
  assert.doesNotMatch(await page.textContent("#progress"), /Cancelled/);
  assert.equal((await runs()).length, 3);
  assert.deepEqual(wrong, []);
  await close();
});

test("a folder of slices is opened as a scan", async () => {
  const { page, close } = await opened("slices/");
  await page.click("#open-folder");
  await page.waitForSelector("#panel-job textarea", { state: "attached" });
  assert.match(await job(page), /ct = ".*slices"/);
  await close();
});

test("a saved report is named for what it is, dropped or given by name", async () => {
  const saved = folder();
  // A report of the command line itself.
  writeFileSync(saved.at("box.stl"), boxStl([10, 8, 1]));
  writeFileSync(saved.at("report.json"), command(saved.dir, "slice", "box.stl", "--json"));
  const says = /report\.json: the JSON report of a plan; open its G-code, box\.gcode, or its job/;
  const dropped = await visit(browser, server.address);
  await dropped.page.waitForSelector("#welcome h2");
  await dropped.page.setInputFiles("#welcome input[type=file]", saved.at("report.json"));
  await dropped.page.waitForSelector("#progress .error");
  assert.match(await dropped.page.textContent("#progress .error"), says);
  await dropped.close();
  const own = await studio(saved.dir, "report.json");
  const given = await visit(browser, own.address);
  await given.page.waitForSelector("#progress .error");
  assert.match(await given.page.textContent("#progress .error"), says);
  await given.close();
  await own.end();
  saved.remove();
});

test("a file of another kind is refused with the kinds that are read", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await page.setInputFiles("#welcome input[type=file]", files.at("letter.txt"));
  await page.waitForSelector("#progress .error");
  assert.match(await page.textContent("#progress .error"), /letter\.txt: the studio opens job files.*photographs.*scans/);
  await settle(page);
  await close();
});
