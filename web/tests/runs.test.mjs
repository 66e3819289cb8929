// The history of runs: kept in the folder, and two of them side by side with the numbers of the command line.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { bar, choose, command, folder, launch, settle, shown, squares, studio, visit } from "./bench.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const SHOTS = process.env.SHOTS;
const shot = async (page, name) => { if (SHOTS) { await settle(page); await page.screenshot({ path: `${SHOTS}/${name}.png` }); } };

let files, server, browser;
before(async () => {
  files = folder({ "bar.gcode": bar(), "thin.gcode": bar(4), "squares.gcode": squares() });
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

/** Pulls a program until it breaks. */
async function broken(page, name) {
  await choose(page, name);
  await shown(page);
  await page.click("#tab-strength");
  await page.click("#break");
  await page.waitForSelector("#peak", { timeout: 240_000 });
}
/** The cells of the rows of the table, by the name of the row. */
const table = (page) => page.$$eval("#compared tr", (rows) => Object.fromEntries(rows.slice(1).map((r) => [r.children[0].textContent, [...r.children].slice(1).map((c) => c.textContent)])));

test("an empty history says what will be in it", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await page.click("#runs");
  assert.match(await page.textContent("#history"), /None yet: plans and strength tests are listed here/);
  assert.equal(await page.$("#all-runs"), null);
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#history"), false);
  assert.deepEqual(wrong, []);
  await close();
});

test("two programs stand side by side, at equal mass too, as the command line compares them", async () => {
  const one = await visit(browser, server.address);
  await broken(one.page, "bar.gcode");
  await one.close();
  const { page, wrong, close } = await visit(browser, server.address);
  await broken(page, "thin.gcode");
  await page.click("#compare");
  await page.waitForSelector("#compared table");
  await shot(page, "compared");
  assert.deepEqual(await page.$$eval("#compared th[scope=col]", (all) => all.slice(0, 2).map((c) => c.textContent.split(",")[0])), ["bar.gcode", "thin.gcode"]);
  const found = await table(page);
  // Four layers of five: four fifths of the mass and of the load; at equal mass as strong.
  assert.equal(found.Mass[2], "80.0 %");
  const per = (text) => Number(text.split(" ")[0]);
  assert.ok(Math.abs(per(found["Breaks at"][2]) - 80) < 3, found["Breaks at"][2]);
  const equal = Object.entries(found).find(([name]) => name.startsWith("Breaks at, for"))[1];
  assert.ok(Math.abs(per(equal[2]) - 100) < 4, `${equal}`);
  assert.equal(equal[0], found["Breaks at"][0].split(" (")[0]);
  assert.match(await page.textContent("#decided"), /^The first carries more\.$/);
  const theirs = JSON.parse(command(files.dir, "compare", "bar.gcode", "thin.gcode", "--job", "grainpath-studio/strength/job.toml", "--json")).rows[1];
  assert.equal(found["Breaks at"][2], `${(100 * theirs.ratio).toFixed(1)} % (${(100 * theirs.ratio_low).toFixed(1)} to ${(100 * theirs.ratio_high).toFixed(1)})`);
  // One mark taken away: no table.
  await page.click("#all-runs input >> nth=0");
  assert.equal(await page.$("#compared table"), null);
  await page.evaluate(axe);
  const serious = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html}`)));
  assert.deepEqual(serious, []);
  assert.deepEqual(wrong, []);
  await close();
});

test("the history outlives the studio, by keyboard", async () => {
  const again = await studio(files.dir);
  const { page, wrong, close } = await visit(browser, again.address);
  await choose(page, "squares.gcode");
  await shown(page);
  await page.keyboard.press("h");
  await page.waitForSelector("#all-runs");
  const rows = await page.$$eval("#all-runs tr", (all) => all.slice(1).map((r) => [...r.children].slice(2).map((c) => c.textContent)));
  assert.equal(rows.length, 2, "a program that is only looked at is no run");
  assert.deepEqual(rows.map((r) => r.slice(0, 2)), [["strength test", "thin.gcode"], ["strength test", "bar.gcode"]]);
  assert.ok(rows.every((r) => /^\d+\.\d\d g$/.test(r[2]) && /^\d+ N$/.test(r[4])), `${rows}`);
  for (const k of [0, 1]) { await page.focus(`#all-runs input >> nth=${k}`); await page.keyboard.press("Space"); }
  assert.equal((await table(page)).Mass[2], "80.0 %");
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#history"), false);
  assert.deepEqual(wrong, []);
  await close();
  await again.end();
});
