// What an empty page offers: examples, and files of every kind that a plan can begin with.

import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { PNG } from "pngjs";
import { command, folder, launch, settle, shaped, shown, studio, visit } from "./bench.mjs";

/** A grey picture of stripes at 30 degrees from the horizontal, as PNG. */
function stripes(width, height) {
  const png = new PNG({ width, height });
  const [c, s] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
  // Rows of a picture run downwards.
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) png.data.set([...Array(3).fill(128 + 90 * Math.sin((-s * x - c * y) * 0.9)), 255], 4 * (y * width + x));
  return PNG.sync.write(png);
}

/** A ball of radius 8 mm in voxels of 0.5 mm, as NRRD. */
function ballNrrd() {
  const n = 40;
  const voxels = Buffer.alloc(n * n * n);
  for (let z = 0; z < n; z++) for (let y = 0; y < n; y++) for (let x = 0; x < n; x++) voxels[(z * n + y) * n + x] = Math.hypot(x - 19.5, y - 19.5, z - 19.5) < 16 ? 200 : 20;
  return Buffer.concat([Buffer.from(`NRRD0004\ntype: uint8\ndimension: 3\nsizes: ${n} ${n} ${n}\nspacings: 0.5 0.5 0.5\nencoding: raw\n\n`), voxels]);
}

let files, server, browser;
before(async () => {
  files = folder({ "board.png": stripes(240, 120), "ball.nrrd": ballNrrd(), "letter.txt": Buffer.from("Dear Sir or Madam") });
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

test("a scan is planned from its file", async () => {
  const { page, close } = await opened("ball.nrrd");
  await page.waitForSelector("#panel-job textarea");
  assert.match(await job(page), /^# Taken for a scan/);
  await page.click("#panel-job >> text=Plan the paths");
  await shown(page);
  const size = await page.evaluate(() => window.studio.viewer.beads.index.part_mm);
  for (const k of [0, 1, 2]) assert.ok(Math.abs(size[1][k] - size[0][k] - 16) < 1.2, JSON.stringify(size));
  await close();
});

test("a folder of slices is opened as a scan", async () => {
  const { page, close } = await opened("slices/");
  await page.click("#open-folder");
  await page.waitForSelector("#panel-job textarea");
  assert.match(await job(page), /ct = ".*slices"/);
  await close();
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
