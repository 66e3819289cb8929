// Two whole stories, by mouse and keyboard alone, held against the command line.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { bar, boxStl, choose, colours, command, far, folder, launch, places, prismStl, settle, shaped, shown, studio, visit } from "./bench.mjs";

let files, server, browser;
before(async () => {
  files = folder({ "bar.gcode": bar(), "bracket.stl": boxStl([30, 12, 3]), "angle.stl": prismStl([[0, 0, 40, 8], [0, 0, 8, 30]], [0, 4]) });
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

const SHOTS = process.env.SHOTS;
const shot = async (page, name) => { if (SHOTS) { await settle(page); await page.screenshot({ path: `${SHOTS}/${name}.png` }); } };

test("a program of another slicer, from its file to where it breaks", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await choose(page, "bar.gcode");
  await shown(page);
  await page.click("text=Where does it break?");
  // The ends of the longest side are proposed; the held one is chosen again by a click on the part.
  await page.click("#views [data-view=side]");
  await settle(page);
  await page.click("#load-pick");
  const [[x, y]] = await places(page, [[80, 24, 0.5]]);
  await page.mouse.click(x, y);
  assert.equal(await page.inputValue("#load-side"), "x+");
  assert.equal(await page.inputValue("#hold-side"), "x-");
  await page.click("#views [data-view=oblique]");
  await settle(page);
  await shot(page, "places");
  await page.click("#break");
  await page.waitForSelector("#peak", { timeout: 240_000 });
  const peak = Number((await page.textContent("#peak")).replace(" N", ""));
  await page.click("summary:has-text('The job file that is run')");
  const job = await page.textContent("#strength-job");
  const saved = readFileSync(files.at("grainpath-studio/strength/job.toml"), "utf8");
  assert.equal(saved, job);
  const theirs = JSON.parse(command(files.dir, "strength", "bar.gcode", "--job", "grainpath-studio/strength/job.toml", "--json"));
  assert.equal(peak, Math.round(theirs.strength.peak_load_n));
  // 8 mm2 of beads along the load, 50 to 57 MPa along a bead.
  assert.ok(peak > 0.85 * 50 * 8 && peak < 1.05 * 57 * 8, `${peak} N`);
  assert.ok((await page.textContent("#weakest")).includes(theirs.strength.weakest.words));
  assert.match(await page.textContent("#panel-strength"), /tier T0/);
  // What broke is drawn in the part, and can be taken away.
  const damage = await page.evaluate(async () => { const list = (await (await fetch("v1/jobs")).json()).jobs; const id = list[list.length - 1].id; return [...new Float32Array(await (await fetch(`v1/jobs/${id}/damage`)).arrayBuffer())]; });
  assert.ok(damage.length >= 4, "something broke");
  let worst = 0;
  for (let k = 0; k < damage.length; k += 4) if (damage[k + 3] > damage[worst + 3]) worst = k;
  const at = [[damage[worst], damage[worst + 1], 1.0]];
  await page.click("#views [data-view=top]");
  await settle(page);
  const [broken] = await colours(page, at);
  await shot(page, "broken");
  await page.click("#show-crack");
  const [whole] = await colours(page, at);
  assert.ok(broken[0] > broken[1] + 40 && far(broken, whole) > 40, `${broken} ${whole}`);
  assert.deepEqual(wrong, []);
  await close();
});

test("holding and loading one place is refused with what to do", async () => {
  const { page, close } = await visit(browser, server.address);
  await choose(page, "bar.gcode");
  await shown(page);
  await page.click("#tab-strength");
  await page.selectOption("#load-side", "x-");
  await page.click("#break");
  assert.match(await page.textContent("#progress"), /choose another side/);
  await close();
});

test("a mesh, from its file to paths whose G-code is that of the command line", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await choose(page, "bracket.stl");
  await page.click("#tab-job");
  await page.waitForSelector("#panel-job textarea");
  await page.selectOption("#panel-job select >> nth=0", "prusa-mk3s");
  assert.match(await page.inputValue("#panel-job textarea"), /\[printer\]\nprofile = "prusa-mk3s"/);
  await page.click("#panel-job >> text=Plan the paths");
  await shown(page);
  await shot(page, "planned");
  const href = await page.getAttribute('#panel-paths a:has-text("gcode")', "href");
  const sent = await page.evaluate(async (address) => [...new Uint8Array(await (await fetch(address)).arrayBuffer())], href);
  command(files.dir, "run", "grainpath-studio/bracket/job.toml", "--out", "again");
  const hash = (bytes) => createHash("sha256").update(bytes).digest("hex");
  assert.equal(hash(Buffer.from(sent)), hash(readFileSync(files.at("again/bracket.gcode"))));
  assert.deepEqual(wrong, []);
  await close();
});

test("a bracket, from its file over its loads and stress to its G-code and to where it breaks, by mouse and keyboard alone", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  // Dropped on the page: the file goes through the browser.
  await page.setInputFiles("#welcome input[type=file]", files.at("angle.stl"));
  await shaped(page);
  assert.equal(await page.textContent("#size"), "40.00 × 30.00 × 4.00 mm");
  await page.click("text=Say where it is held and loaded");
  // The end of the upright leg is held.
  const click = async (p) => { const [[x, y]] = await places(page, [p]); await page.mouse.click(x, y); };
  await page.keyboard.press("4");
  await page.evaluate(() => window.studio.viewer.view("oblique"));
  await settle(page);
  await page.focus("#view");
  await page.mouse.move(640, 300);
  // Behind the part from this side: its button in the list of faces does as well.
  const name = (face) => page.evaluate((f) => window.studio.report.faces.findIndex((row) => row.centre_mm.every((v, k) => Math.abs(v - f[k]) < 0.01)), face);
  await page.click("#all-faces summary");
  await page.focus(`button.face[data-face="${await name([4, 30, 2])}"]`);
  await page.keyboard.press("Enter");
  await page.click("#hold-here");
  // The end of the lying leg is seen from the side.
  await page.click("#views [data-view=side]");
  await settle(page);
  await click([40, 4, 2]);
  await page.click("#load-here");
  await page.fill("#value-1-x", "0");
  await page.fill("#value-1-y", "-60");
  await page.fill("#value-1-z", "0");
  await page.press("#value-1-z", "Tab");
  await page.click("#views [data-view=oblique]");
  await settle(page);
  await shot(page, "studio-loads");
  await page.click("#solve");
  await page.waitForSelector("#peak-stress", { timeout: 240_000 });
  await shot(page, "studio-stress");
  const peak = await page.textContent("#peak-stress");
  await page.click("#follow");
  await page.click("#plan-here");
  await shown(page);
  await shot(page, "studio-planned");
  const href = await page.getAttribute('#panel-paths a:has-text("gcode")', "href");
  const sent = Buffer.from(await page.evaluate(async (address) => [...new Uint8Array(await (await fetch(address)).arrayBuffer())], href));
  // The command line, from the job that the studio saved: the same stress, the same bytes.
  const job = "grainpath-studio/angle/job.toml";
  const theirs = JSON.parse(command(files.dir, "run", job, "--check", "--json"));
  assert.ok(peak.startsWith(`${theirs.stress.max_von_mises_mpa.toFixed(2)} MPa`), `${peak} ${theirs.stress.max_von_mises_mpa}`);
  assert.deepEqual(theirs.stress.loads[0].force_n.map((v) => Math.round(v * 1e6) / 1e6 + 0), [0, -60, 0]);
  command(files.dir, "run", job, "--out", "again-angle");
  const hash = (bytes) => createHash("sha256").update(bytes).digest("hex");
  assert.equal(hash(sent), hash(readFileSync(files.at("again-angle/angle.gcode"))));
  // The printed part is loaded until it breaks.
  await page.click("#tab-loads");
  await page.click("#test-here");
  await page.waitForSelector("#peak", { timeout: 240_000 });
  await shot(page, "studio-breaks");
  const breaks = Number((await page.textContent("#peak")).replace(" N", ""));
  const tested = JSON.parse(command(files.dir, "strength", job, "--json")).strength;
  assert.equal(breaks, Math.round(tested.peak_load_n));
  // The leg of 4 x 8 mm bends under 60 N: the reserve stands beside it.
  assert.ok((await page.textContent("#answer")).includes(`${(tested.peak_load_n / 60).toFixed(2)} ×`), await page.textContent("#answer"));
  assert.deepEqual(wrong, []);
  await close();
});

test("an error in the text of a job names its line", async () => {
  const { page, close } = await visit(browser, server.address);
  await choose(page, "bracket.stl");
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", "[process]\nwals = 3\n");
  await page.click("#panel-job >> text=Plan the paths");
  await page.waitForSelector("#progress .error");
  assert.match(await page.textContent("#progress .error"), /job\.toml:2: unknown key `wals` in \[process\]; did you mean `walls`\?/);
  await close();
});
