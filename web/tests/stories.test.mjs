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
  // What broke is drawn in the part, state by state, and can be taken away.
  const { cells, states } = await page.evaluate(async () => {
    const list = (await (await fetch("v1/jobs")).json()).jobs;
    const of = `v1/jobs/${list[list.length - 1].id}`;
    return { cells: [...new Float32Array(await (await fetch(`${of}/damage`)).arrayBuffer())], states: (await (await fetch(`${of}/result`)).json()).damage.states };
  });
  const broken = Array.from({ length: cells.length / 5 }, (_, k) => ({ at: [cells[5 * k], cells[5 * k + 1], 1.0], lost: cells[5 * k + 3], state: cells[5 * k + 4] }));
  assert.ok(broken.length > 3 && broken.every((c) => c.state > 0 && c.state < states.length), "elements break after the first state");
  assert.equal(Math.max(...states.map(([, f]) => Math.round(f))), peak);
  await page.click("#views [data-view=top]");
  // Places of the picture that nothing lies over.
  const first = broken.reduce((a, b) => (b.state < a.state ? b : a));
  const last = broken.reduce((a, b) => (b.state > a.state || (b.state === a.state && b.lost > a.lost) ? b : a));
  assert.ok(last.state > first.state, "the crack grows");
  const both = async (shows) => { const found = await colours(page, [first.at, last.at]); if (shows) await shot(page, shows); return found; };
  const step = async (k) => { await page.$eval("#crack-step", (input, v) => { input.focus(); input.value = String(v); input.dispatchEvent(new Event("input", { bubbles: true })); }, k); await settle(page); };
  const isRed = (c) => c[0] > c[1] + 40;
  const end = await both("broken");
  assert.ok(isRed(end[0]) && isRed(end[1]), `${end}`);
  await step(0);
  const begin = await both();
  assert.ok(!isRed(begin[0]) && !isRed(begin[1]), `nothing is broken in the first state: ${begin}`);
  assert.match(await page.textContent("#crack-words"), /^step 1 of \d+: \d+ N at 0\.\d+ mm, 0 of \d+ elements broken$/);
  await step(last.state - 1);
  const half = await both("half");
  assert.ok(isRed(half[0]) && !isRed(half[1]), `the first is broken and the last is not: ${half}`);
  // The mark moves along the curve.
  const mark = async () => Number(await page.getAttribute("#mark", "cx"));
  await step(0);
  const from = await mark();
  await page.focus("#crack-step");
  await page.keyboard.press("End");
  assert.ok(Math.abs((await mark()) - from) > 20, `${from} ${await mark()}`);
  // Colours of the order: the ramp's ends, on the elements and on the beads.
  await page.selectOption("#crack-by", "order");
  const [dark, bright] = await both("order");
  assert.ok(dark[2] > dark[1] + 20 && bright[0] > bright[2] + 60 && bright[1] > bright[2] + 60, `${dark} ${bright}`);
  await page.selectOption("#crack-by", "beads");
  const [early, late] = await both("order-of-beads");
  assert.ok(early[2] > early[1] + 20 && late[0] > late[2] + 60 && late[1] > late[2] + 60, `${early} ${late}`);
  const isWhole = (p) => broken.every((c) => Math.hypot(c.at[0] - p[0], c.at[1] - p[1]) > 2);
  const whole = [30, 35, 40, 45, 50, 55, 60, 65, 70].flatMap((x) => [22, 24, 26].map((y) => [x, y, 1.0])).find(isWhole);
  const [grey] = await colours(page, [whole]);
  assert.ok(Math.max(...grey) - Math.min(...grey) < 30, `a bead that is whole is grey: ${grey}`);
  await page.selectOption("#crack-by", "none");
  const [plain] = await both();
  assert.ok(far(plain, early) > 40 && far(plain, end[0]) > 40, `${plain}`);
  // Played, it ends where it ends.
  await page.selectOption("#crack-by", "lost");
  await page.focus("#crack-play");
  await page.keyboard.press("Enter");
  await page.waitForFunction((n) => Number(document.getElementById("crack-step").value) > 0 && Number(document.getElementById("crack-step").value) < n, states.length - 1);
  await page.waitForFunction((n) => document.getElementById("crack-step").value === String(n), states.length - 1);
  // Another tab and back: the crack is there again, and the paths have their own colours meanwhile.
  await page.click("#tab-paths");
  assert.ok(!isRed((await both())[0]) || far((await both())[0], end[0]) > 40);
  await page.click("#tab-strength");
  assert.ok(isRed((await both())[0]));
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
  // The page turns to the part once it is read.
  await shaped(page);
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
  // The page turns to the part once it is read.
  await shaped(page);
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", "[process]\nwals = 3\n");
  await page.click("#panel-job >> text=Plan the paths");
  await page.waitForSelector("#progress .error");
  assert.match(await page.textContent("#progress .error"), /job\.toml:2: unknown key `wals` in \[process\]; did you mean `walls`\?/);
  await close();
});
