// Whole stories, held against the command line; two of them by mouse and keyboard at points of the screen alone.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, statSync } from "node:fs";
import { after, before, test } from "node:test";
import { bar, boxStl, choose, colours, command, far, folder, hands, launch, picture, places, prismStl, settle, shaped, shown, studio, threeDigits, visit } from "./bench.mjs";

let files, server, browser;
before(async () => {
  const sliced = readFileSync(new URL("data/bar-prusaslicer.gcode", import.meta.url));
  files = folder({ "bar.gcode": bar(), "bar-prusaslicer.gcode": sliced, "bracket.stl": boxStl([30, 12, 3]), "angle.stl": prismStl([[0, 0, 40, 8], [0, 0, 8, 30]], [0, 4]) });
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

/** What a program in absolute coordinates prints: the box of the middles of its beads, from the bottom of the first layer. */
function printedBox(text, height) {
  const [low, high] = [[Infinity, Infinity, 0], [-Infinity, -Infinity, 0]];
  const at = { X: 0, Y: 0, Z: 0, E: 0 };
  for (const line of text.split("\n")) {
    const words = Object.fromEntries([...line.split(";")[0].matchAll(/([GXYZE])(-?[\d.]+)/g)].map(([, letter, value]) => [letter, Number(value)]));
    if (words.G === 92) at.E = words.E ?? at.E;
    if (words.G !== 1) continue;
    const before = { ...at };
    Object.assign(at, words);
    if (at.E <= before.E || (at.X === before.X && at.Y === before.Y)) continue;
    for (const p of [before, at]) { low[0] = Math.min(low[0], p.X); low[1] = Math.min(low[1], p.Y); high[0] = Math.max(high[0], p.X); high[1] = Math.max(high[1], p.Y); }
    [low[2], high[2]] = [Math.min(low[2], at.Z - height), Math.max(high[2], at.Z)];
  }
  return [low, high];
}
const hash = (bytes) => createHash("sha256").update(bytes).digest("hex");
/** What the server answers, asked beside the page. */
const answer = async (page, address) => (await page.context().request.get(new URL(address, page.url()).href)).body();
/** The file that a link gives, saved as a browser saves it. */
async function saved(page, hand, link) {
  const [download] = await Promise.all([page.waitForEvent("download"), hand.press(link)]);
  return readFileSync(await download.path());
}

test("a program of PrusaSlicer, from its drop to where it breaks, by hand at points of the screen", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  const hand = await hands(page);
  await hand.drop(files.at("bar-prusaslicer.gcode"));
  await page.waitForSelector("html[data-shown]");
  // It opens on the question that it came for.
  assert.equal(await page.getAttribute("#tab-strength", "aria-selected"), "true");
  const kept = files.at("grainpath-studio/uploads/bar-prusaslicer.gcode");
  assert.equal(hash(readFileSync(kept)), hash(readFileSync(files.at("bar-prusaslicer.gcode"))));
  // The places that are proposed are changed for each other: held at its right end, pulled at its left.
  const box = printedBox(readFileSync(kept, "utf8"), 0.2);
  const [[x, y], [X, Y, top]] = box;
  const sides = async () => [await page.inputValue("#hold-side"), await page.inputValue("#load-side")];
  assert.deepEqual(await sides(), ["x-", "x+"]);
  const right = await hand.look(box, "side");
  await hand.press("#hold-pick");
  await hand.at(...right([X, 0.5 * (y + Y), 0.5 * top]));
  assert.deepEqual(await sides(), ["x+", "x+"]);
  const left = await hand.look(box, "side", 12);
  await hand.press("#load-pick");
  await hand.at(...left([x, 0.5 * (y + Y), 0.5 * top]));
  assert.deepEqual(await sides(), ["x+", "x-"]);
  await hand.look(box, "oblique");
  await shot(page, "studio-program-places");
  await hand.press("#break");
  await page.waitForSelector("#peak", { timeout: 240_000 });
  const peak = Number((await page.textContent("#peak")).replace(" N", ""));
  // The command line, from the program that was dropped and the job that the page shows.
  await hand.press("summary:has-text('The job file that is run')");
  // Each run has a folder of its own; this run's is the latest.
  const written = (folder) => statSync(files.at(`grainpath-studio/${folder}/job.toml`)).mtimeMs;
  const runs = readdirSync(files.at("grainpath-studio")).filter((name) => name.startsWith("strength"));
  const path = `grainpath-studio/${runs.sort((a, b) => written(b) - written(a))[0]}/job.toml`;
  const job = readFileSync(files.at(path), "utf8");
  assert.equal(job, await page.textContent("#strength-job"));
  assert.match(job, /force_n = \[-100, 0, 0\]/);
  await hand.press("summary:has-text('The job file that is run')");
  await shot(page, "studio-program-breaks");
  const theirs = JSON.parse(command(files.dir, "strength", kept, "--job", path, "--json")).strength;
  assert.equal(peak, Math.round(theirs.peak_load_n));
  assert.ok((await page.textContent("#weakest")).includes(theirs.weakest.words));
  // What broke first is red at its place in the last state, and not in the first one.
  const jobs = JSON.parse(await answer(page, "v1/jobs")).jobs;
  const bytes = await answer(page, `v1/jobs/${jobs[jobs.length - 1].id}/damage`);
  const cells = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  const broken = Array.from({ length: cells.length / 5 }, (_, k) => ({ at: [cells[5 * k], cells[5 * k + 1], top], lost: cells[5 * k + 3], state: cells[5 * k + 4] }));
  const first = broken.reduce((a, b) => (b.state < a.state || (b.state === a.state && b.lost > a.lost) ? b : a));
  const above = await hand.look(box, "top");
  const red = async () => { await settle(page); const c = (await picture(page)).at(...above(first.at)); return c[0] - c[1]; };
  const end = await red();
  await hand.press("#crack-step");
  await hand.keys("Home");
  assert.match(await page.textContent("#crack-words"), /^step 1 of \d+: \d+ N at 0\.\d+ mm, 0 of \d+ elements broken$/);
  const begin = await red();
  assert.ok(end > 40 && begin < 40, `${end} ${begin}`);
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
  assert.equal(hash(Buffer.from(sent)), hash(readFileSync(files.at("again/bracket.gcode"))));
  assert.deepEqual(wrong, []);
  await close();
});

test("a bracket, from its drop over its loads and stress to its G-code and to where it breaks, by hand at points of the screen", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  const hand = await hands(page);
  await hand.drop(files.at("angle.stl"));
  await page.waitForSelector("html[data-search]");
  assert.equal(await page.textContent("#size"), "40.00 × 30.00 × 4.00 mm");
  await hand.press("text=Say where it is held and loaded");
  // The end of the upright leg is held; it is seen from behind, half a turn from the front.
  const part = [[0, 0, 0], [40, 30, 4]];
  const held = (await hand.look(part, "front", 12))([4, 30, 2]);
  const blue = async ([x, y]) => { const c = (await picture(page)).at(x, y); return c[2] - c[0]; };
  const before = await blue(held.map((v) => v + 6));
  await hand.at(...held);
  await hand.press("#hold-here");
  await hand.keys("Escape");
  const after = await blue(held.map((v) => v + 6));
  assert.ok(after > before + 30, `the face that is held is blue: ${before} ${after}`);
  // The end of the lying leg is loaded, and seen from the side.
  await hand.at(...(await hand.look(part, "side"))([40, 4, 2]));
  await hand.press("#load-here");
  for (const [axis, value] of [["x", "0"], ["y", "-60"], ["z", "0"]]) await hand.write(`#value-1-${axis}`, value);
  await hand.look(part, "oblique");
  await shot(page, "studio-loads");
  await hand.press("#solve");
  await page.waitForSelector("#peak-stress", { timeout: 240_000 });
  await shot(page, "studio-stress");
  const peak = await page.textContent("#peak-stress");
  await hand.press("#follow");
  await hand.press("#plan-here");
  await page.waitForSelector("html[data-shown]", { timeout: 240_000 });
  const link = page.locator('#panel-paths a:has-text("gcode")');
  await link.waitFor();
  await shot(page, "studio-planned");
  const sent = await saved(page, hand, link);
  // The command line, from the job that the studio saved: the same load, the same stress, the same bytes.
  const job = "grainpath-studio/angle/job.toml";
  const theirs = JSON.parse(command(files.dir, "run", job, "--check", "--json"));
  assert.ok(peak.startsWith(`${threeDigits(theirs.stress.max_von_mises_mpa)} MPa`), `${peak} ${theirs.stress.max_von_mises_mpa}`);
  assert.deepEqual(theirs.stress.loads[0].force_n.map((v) => Math.round(v * 1e6) / 1e6 + 0), [0, -60, 0]);
  command(files.dir, "run", job, "--out", "again-angle");
  assert.equal(hash(sent), hash(readFileSync(files.at("again-angle/angle.gcode"))));
  // The printed part is loaded until it breaks.
  await hand.press("#tab-loads");
  await hand.press("#test-here");
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
