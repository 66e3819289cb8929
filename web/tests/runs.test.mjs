// The history of runs: kept in the folder, and two of them side by side with the numbers of the command line.

import assert from "node:assert/strict";
import { appendFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { bar, boxStl, choose, command, folder, held, launch, settle, shapeRun, shapedAnew, shown, squares, studio, until, visit } from "./bench.mjs";

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
  // The list is asked from the server, so the sentence comes a moment after the panel.
  await page.waitForFunction(() => document.querySelector("#history").textContent !== "");
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
  // A plan between them has no strength, and is not what the second is compared with.
  appendFileSync(files.at("grainpath-studio/history.jsonl"), `${JSON.stringify({ at_s: 1, kind: "plan", name: "plan", input: null, mass_g: 1, time_s: 1, layers: 1, strength: null })}\n`);
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
  // A run is opened from its row, with what came of it.
  await page.click('#all-runs tr:has-text("bar.gcode") button');
  await page.waitForSelector("#answer .note:has-text('What follows is of strength,')");
  assert.match(await page.textContent("#title"), /bar\.gcode$/);
  assert.equal(`${parseFloat(await page.textContent("#peak"))}`, found["Breaks at"][0].split(" ")[0]);
  await page.keyboard.press("h");
  await page.waitForSelector("#all-runs");
  for (const name of ["thin", "bar"]) await page.click(`#all-runs tr:has-text("${name}.gcode") input`);
  await page.waitForSelector("#compared table");
  // One mark taken away: no table.
  await page.click("#all-runs input >> nth=0");
  assert.equal(await page.$("#compared table"), null);
  await page.evaluate(axe);
  const serious = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html}`)));
  assert.deepEqual(serious, []);
  assert.deepEqual(wrong, []);
  await close();
});

test("a plan is compared with another one at equal mass by planning it anew", async (t) => {
  const job = (density) => `[shape]\nmesh = "plate.stl"\n\n[process]\nwalls = 1\ntop_layers = 0\nbottom_layers = 0\n\n[fill]\npattern = "rectilinear"\nangles_deg = [0]\ndensity = ${density}\n\n[[guide.fixture]]\non = { box_mm = [[0, 0, 0], [4, 16, 1]] }\nfix = "xyz"\n\n[[guide.load]]\non = { box_mm = [[36, 0, 0], [40, 16, 1]] }\nforce_n = [100, 0, 0]\n`;
  const dir = folder({ "plate.stl": boxStl([40, 16, 1]), "thin.toml": job(0.3), "dense.toml": job(0.6) });
  const own = await studio(dir.dir);
  t.after(async () => { await own.end(); dir.remove(); });
  const { page, wrong, close } = await visit(browser, own.address);
  for (const name of ["dense.toml", "thin.toml"]) {
    const last = await shapeRun(page);
    if (name === "dense.toml") await choose(page, name);
    else { await page.click("#open"); await page.click(`#chooser .files button:has-text("${name}")`); }
    await shapedAnew(page, last);
    await page.click("#tab-strength");
    await page.click("#test-job");
    await page.waitForSelector("#peak", { timeout: 240_000 });
  }
  await page.click("#compare");
  await page.waitForSelector("#compared table");
  const before = await table(page);
  const heavier = 100 / parseFloat(before.Mass[2]);
  assert.ok(heavier > 1.2, `${before.Mass}`);
  const grams = before.Mass[0];
  assert.match(await page.textContent("#equal-second"), new RegExp(`Plan the second anew at ${grams.replace(".", "\\.")} and test it`));
  await page.click("#equal-second");
  await page.waitForFunction(() => document.querySelector("#history").open && document.querySelectorAll("#all-runs tr").length === 4, null, { timeout: 240_000 });
  await shot(page, "equal");
  const after = await table(page);
  assert.ok(Math.abs(parseFloat(after.Mass[2]) - 100) < 1.5, `${after.Mass}`);
  assert.equal(after["Breaks at"][0], before["Breaks at"][0]);
  // Beads along the pull: at equal mass they carry alike, and what was planned anew carries more than before.
  const load = (row) => parseFloat(row[1]);
  assert.ok(load(after["Breaks at"]) > 1.15 * load(before["Breaks at"]), `${before["Breaks at"]} ${after["Breaks at"]}`);
  assert.ok(Math.abs(parseFloat(after["Breaks at"][2]) - 100) < 8, `${after["Breaks at"]}`);
  assert.equal(await page.$("#equal-second"), null, "they are equal now");
  const said = await page.evaluate(async () => (await fetch(`v1/text?path=${encodeURIComponent((await (await fetch("v1/state")).json()).work + "/thin-equal/job.toml")}`)).json());
  assert.match(said.text, /mass_g = \d/);
  assert.deepEqual(wrong, []);
  await close();
});

test("runs of two materials are told apart, far masses are named, and a plan without strength is not marked", async (t) => {
  const strength = (peak, card, mass) => ({ peak_load_n: peak, low_n: 0.8 * peak, high_n: 1.2 * peak, stiffness_n_per_mm: 10, first_n: peak, peak_displacement_mm: 1, job_load_n: 1, mode: "m", modes: {}, weakest: { words: "w" }, mass_g: mass, load_per_gram_n_g: peak / mass, card, card_source: "s", card_tier: "T0", corners: { nominal: peak, low: 0.8 * peak, high: 1.2 * peak }, grid_share: 0.01 });
  const row = (at_s, name, kind, mass_g, of) => ({ at_s, kind, name, input: `/nowhere/${name}.toml`, mass_g, time_s: 60, layers: 5, strength: of });
  // The weaker one first: one card decides at 80 %, two cards do not.
  const rows = [row(1, "one", "strength", 0.28, strength(100, "PLA 1", 0.28)), row(2, "two", "strength", 0.28, strength(80, "PLA 1", 0.28)), row(3, "three", "strength", 3.4, strength(80, "PETG 2", 3.4)), row(4, "four", "plan", 3.4, null)];
  const dir = folder();
  mkdirSync(dir.at("grainpath-studio"));
  writeFileSync(dir.at("grainpath-studio/history.jsonl"), rows.map((r) => `${JSON.stringify(r)}\n`).join(""));
  const own = await studio(dir.dir);
  t.after(async () => { await own.end(); dir.remove(); });
  const { page, wrong, close } = await visit(browser, own.address);
  await page.waitForSelector("#welcome h2");
  await page.keyboard.press("h");
  const mark = async (...names) => {
    for (const box of await page.$$("#all-runs input:checked")) await box.click();
    for (const name of names) await page.click(`#all-runs tr:has-text("${name}.toml") input`);
  };
  await page.waitForSelector("#all-runs");
  await mark("one", "two");
  assert.equal(await page.textContent("#decided"), "The first carries more.");
  assert.doesNotMatch(await page.textContent("#compared"), /materials differ/);
  await mark("one", "three");
  assert.match(await page.textContent("#decided"), /not decided/);
  assert.match(await page.textContent("#compared"), /The materials differ \(PLA 1 and PETG 2\)/);
  const found = await table(page);
  // 64 to 96 N over 80 to 120 N.
  assert.equal(found["Breaks at"][2], "80.0 % (53.3 to 120.0)");
  assert.deepEqual([found.Card[0], found.Card[1]], ["PLA 1, from data sheets and literature (tier T0)", "PETG 2, from data sheets and literature (tier T0)"]);
  assert.ok("Breaks at, for 0.28 g of each, the second taken 0.08 times as heavy" in found, Object.keys(found).join());
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
  assert.deepEqual(rows.splice(1, 1)[0].slice(0, 2), ["plan", "plan"]);
  assert.equal(rows.length, 2, "a program that is only looked at is no run");
  assert.deepEqual(rows.map((r) => r.slice(0, 2)), [["strength test", "thin.gcode"], ["strength test", "bar.gcode"]]);
  assert.ok(rows.every((r) => /^\d+\.\d\d g$/.test(r[2]) && /^\d+ N$/.test(r[4])), `${rows}`);
  for (const k of [0, 2]) { await page.focus(`#all-runs input >> nth=${k}`); await page.keyboard.press("Space"); }
  assert.equal((await table(page)).Mass[2], "80.0 %");
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#history"), false);
  assert.deepEqual(wrong, []);
  await close();
  await again.end();
});

test("runs that are worked on and wait are listed, and each is cancelled by its own button", async (t) => {
  const job = (height) => `[shape]\nmesh = "block.stl"\n\n[process]\nlayer_height_mm = ${height}\n\n[fill]\npattern = "rectilinear"\ndensity = 1\n`;
  const dir = folder({ "block.stl": boxStl([150, 150, 120]), "long.toml": job(0.02), "other.toml": job(0.02), "plate.stl": boxStl([20, 20, 1]), "short.toml": job(0.2).replace("block", "plate") });
  const own = await studio(dir.dir);
  t.after(async () => { await own.end(); dir.remove(); });
  let isHeld = false;
  const late = held((request) => isHeld && request.method() === "GET");
  const { page, wrong, close } = await visit(browser, own.address, { routes: { "**/v1/jobs": late.answer } });
  await page.waitForSelector("#welcome h2");
  const ask = async (method, path, data) => (await page.context().request.fetch(new URL(path, page.url()).href, { method, data, headers: { origin: new URL(page.url()).origin } })).json();
  const begin = async (name) => (await ask("POST", "v1/jobs", { kind: "plan", file: dir.at(name) })).id;
  const phase = async (id) => (await ask("GET", `v1/jobs/${id}`)).phase;
  const [long, other, short] = [await begin("long.toml"), await begin("other.toml"), await begin("short.toml")];
  await page.keyboard.press("h");
  await page.waitForSelector("#queue");
  assert.equal(await page.$("#all-runs"), null, "none is done");
  const rows = () => page.$$eval("#queue tr[data-run]", (all) => all.map((r) => [...r.children].slice(0, 3).map((c) => c.textContent)));
  await page.waitForFunction((id) => /^(Shape|Walls and fill)( \d+ of \d+)?$/.test(document.querySelector(`#queue tr[data-run="${id}"]`)?.children[2].textContent ?? ""), long);
  await shot(page, "queue");
  const [first, ...waiting] = await rows();
  assert.deepEqual(first.slice(0, 2), ["plan", "long"]);
  assert.deepEqual(waiting, [["plan", "other", "Waits for 1 other"], ["plan", "short", "Waits for 2 others"]]);
  await page.evaluate(axe);
  const serious = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html}`)));
  assert.deepEqual(serious, []);
  // One that waits goes, by keyboard; the one that is worked on stays.
  await page.focus(`[data-cancel="${other}"]`);
  await page.keyboard.press("Enter");
  await page.waitForSelector(`#queue tr[data-run="${other}"]`, { state: "detached" });
  assert.deepEqual([await phase(other), await phase(long)], ["cancelled", "running"]);
  assert.equal(await page.evaluate(() => document.activeElement.dataset.cancel), String(short), "the next one has the focus");
  // The one that is worked on goes; the next one is done and comes into the list below, while the queue is empty.
  await page.click(`[data-cancel="${long}"]`);
  await page.waitForSelector("#all-runs tr:has-text('short')");
  // A run comes into the list before its phase ends, so the queue can outlive it by one question to the server.
  await page.waitForSelector("#queue", { state: "detached" });
  assert.deepEqual([await phase(long), await phase(short)], ["cancelled", "done"]);
  assert.equal((await page.$$("#all-runs tr")).length, 2, "what was cancelled is no run of the history");
  // A run that comes on top leaves the focus where it is.
  await page.focus("#all-runs input");
  await begin("short.toml");
  const listed = (n) => page.waitForFunction((k) => document.querySelectorAll("#all-runs tr").length === k, n);
  await listed(3);
  assert.equal(await page.evaluate(() => document.activeElement.closest("tr").rowIndex), 2);
  // A run that ends between the question for the list and that for the queue is listed all the same.
  await page.keyboard.press("Escape");
  isHeld = true;
  await page.click("#runs");
  await late.asked;
  isHeld = false;
  const last = await begin("short.toml");
  await until(async () => (await phase(last)) === "done", "the last run");
  await late.free(page, "**/v1/jobs");
  await listed(4);
  assert.deepEqual(wrong, []);
  await close();
});
