// The part on the screen: faces, fixtures, loads and stress, at places and with values that follow from the model. Each
// kind has a control beside it that must differ.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { boxStl, choose, faceAt, held, hold, load, vector, solve, colours, command, threeDigits, far, folder, launch, places, prismStl, settle, shaped, shapedAnew, shapeRun, shown, stl, studio, until, view, visit } from "./bench.mjs";

/** Colours by hue: the light of a face scales them. */
const HELD = [70, 130, 190];
const LOADED = [226, 120, 58];
const CHOSEN = [245, 196, 66];
const PLAIN = [178, 188, 196];

/** A box turned in its file by 37 degrees about x, then about z. */
function turnedBox([x, y, z]) {
  const bytes = boxStl([x, y, z]);
  const [c, s] = [Math.cos((37 * Math.PI) / 180), Math.sin((37 * Math.PI) / 180)];
  for (let t = 0; t < 12; t++) for (let k = 0; k < 3; k++) {
    const at = 84 + 50 * t + 12 + 12 * k;
    const [a, b, d] = [0, 4, 8].map((o) => bytes.readFloatLE(at + o));
    const [p, q] = [b * c - d * s, b * s + d * c];
    [a * c - p * s, a * s + p * c, q].forEach((v, o) => bytes.writeFloatLE(v, at + 4 * o));
  }
  return bytes;
}

/** A ball of many triangles. */
function ball(radius, rows) {
  const at = (i, j) => { const [u, v] = [(Math.PI * i) / rows, (Math.PI * j) / rows]; return [radius * Math.sin(u) * Math.cos(v), radius * Math.sin(u) * Math.sin(v), radius * Math.cos(u)]; };
  const all = [];
  for (let i = 0; i < rows; i++) for (let j = 0; j < 2 * rows; j++) {
    if (i > 0) all.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
    if (i + 1 < rows) all.push([at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]);
  }
  return stl(all);
}

let files, server, browser;
before(async () => {
  files = folder({
    "bar.stl": boxStl([60, 8, 4]), "inch.stl": boxStl([2, 1, 0.25]), "turned.stl": turnedBox([30, 12, 6]), "notes.stl": Buffer.from("Dear Sir or Madam"), "notes.xyz": "1 2 3",
    // Without the two triangles of its top.
    "open.stl": prismStl([[0, 0, 20, 10]], [0, 5], (n) => n !== 2 && n !== 3), "angle.stl": prismStl([[0, 0, 40, 8], [0, 0, 8, 30]], [0, 4]), "ball.stl": ball(20, 160),
  });
  mkdirSync(files.at("jobs"));
  writeFileSync(files.at("jobs/plate.stl"), boxStl([20, 10, 2]));
  writeFileSync(files.at("jobs/plate.toml"), '# mine\n[shape]\nmesh = "plate.stl"  # beside the job\n\n[guide]\nload = [{ on = { box_mm = [[20, 0, 0], [20, 10, 2]] }, force_n = [40, 0, 0] }]\n\n[[guide.fixture]]\non = { box_mm = [[0, 0, 0], [0, 10, 2]] }\nfix = "xyz"\n');
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

/** How far a colour is from another of any brightness: the sine of the angle between them. */
function hue(a, b) {
  const dot = a.reduce((sum, v, k) => sum + v * b[k], 0);
  return Math.sqrt(Math.max(1 - (dot / (Math.hypot(...a) * Math.hypot(...b))) ** 2, 0));
}
const is = (found, wanted, what) => assert.ok(hue(found, wanted) < 0.07 && Math.hypot(...found) > 0.45 * Math.hypot(...wanted), `${what}: ${found} is not ${wanted}`);
const isNot = (found, other, what) => assert.ok(hue(found, other) > 0.12, `${what}: ${found} is ${other}`);
const click = async (page, p, options) => { const [[x, y]] = await places(page, [p]); await page.mouse.click(x, y, options); await page.mouse.move(5, 5); await settle(page); };
const text = (page) => page.$eval("#panel-job textarea", (area) => area.value);

test("a part is drawn with its size, its faces and no defect", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await view(page, "top");
  const [inside, beside] = await colours(page, [[30, 4, 4], [30, 9.5, 4]]);
  is(inside, PLAIN, "the top");
  assert.ok(far(inside, beside) > 25, `beside the part: ${inside} ${beside}`);
  assert.equal(await page.textContent("#size"), "60.00 × 8.00 × 4.00 mm");
  assert.equal(await page.textContent("#faces-in-all"), "6");
  assert.match(await page.textContent("#defects"), /None/);
  assert.deepEqual(wrong, []);
  await close();
});

test("the pointer names a face and lights it, on a round one of a hundred thousand triangles too", async () => {
  for (const [name, at, words, elsewhere] of [["bar.stl", [30, 4, 4], /^f:[0-9a-f]+ · plane, 480\.0 mm²/, [50, 4, 4]], ["ball.stl", [2, 1, 40], /^f:[0-9a-f]+ · sphere, radius 20\.00 mm/, [-9, 3, 37]]]) {
    const { page, close } = await opened(name);
    await view(page, "top");
    const [before] = await colours(page, [elsewhere]);
    const [[x, y]] = await places(page, [at]);
    for (let k = 0; k < 10; k++) { await page.mouse.move(x + k, y); await settle(page); }
    assert.match(await page.textContent("#bead"), words);
    const [lit] = await colours(page, [elsewhere]);
    assert.ok(far(before, lit) > 25, `${before} ${lit}: another place of the same face`);
    await page.mouse.move(300, 700);
    await page.mouse.move(5, 5);
    await settle(page);
    const [after] = await colours(page, [elsewhere]);
    assert.ok(far(before, after) < 8, `${before} ${after}: not lit any more`);
    await close();
  }
});

test("a click chooses a face, with shift another one, beside the part none", async () => {
  const { page, close } = await opened("angle.stl");
  await page.click("#tab-loads");
  await view(page, "oblique");
  const top = [30, 4, 4];
  const front = [20, 0, 2];
  await click(page, top);
  let [a, b] = await colours(page, [top, front]);
  is(a, CHOSEN, "the top");
  isNot(b, CHOSEN, "the front");
  await page.keyboard.down("Shift");
  await click(page, front);
  await page.keyboard.up("Shift");
  [a, b] = await colours(page, [top, front]);
  is(a, CHOSEN, "the top still");
  is(b, CHOSEN, "the front too");
  assert.equal((await page.$$("#picked li")).length, 2);
  const box = await page.locator("#view").boundingBox();
  await page.mouse.click(box.x + 30, box.y + box.height - 30);
  await settle(page);
  [a] = await colours(page, [top]);
  isNot(a, CHOSEN, "none");
  await close();
});

test("faces are chosen from the list by keyboard", async () => {
  const { page, close } = await opened("bar.stl");
  await page.click("#tab-loads");
  await view(page, "top");
  await page.focus("#all-faces summary");
  await page.keyboard.press("Enter");
  const face = await faceAt(page, [30, 4, 4]);
  await page.focus(`button.face[data-face="${face}"]`);
  await page.keyboard.press("Enter");
  assert.equal(await page.getAttribute(`button.face[data-face="${face}"]`, "aria-pressed"), "true");
  await page.focus("#undo, #gravity");
  const [top] = await colours(page, [[30, 4, 4]]);
  is(top, CHOSEN, "the top");
  await page.focus("#view");
  await page.keyboard.press("Escape");
  assert.equal(await page.getAttribute(`button.face[data-face="${face}"]`, "aria-pressed"), "false");
  await close();
});

test("what is held is blue with cones, what is loaded orange with an arrow, and both are in the job", async () => {
  const { page, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [30, 4, 4]);
  assert.match(await text(page), /\[\[guide\.fixture\]\]\non = \{ face = "f:[0-9a-f]+" \}\nfix = "xyz"\n\n\[\[guide\.load\]\]\non = \{ face = "f:[0-9a-f]+" \}\nforce_n = \[0, 0, -100\]\n/);
  await view(page, "front");
  // The arrow against the top ends at its middle; a fifth of the diagonal of the part is 12.1 mm.
  const shaft = [30, 4, 8];
  const [arrow, beside] = await colours(page, [shaft, [36, 4, 8]]);
  is(arrow, LOADED, "the shaft above the top");
  isNot(beside, LOADED, "beside the arrow");
  await view(page, "top");
  const [top] = await colours(page, [[50, 4, 4]]);
  is(top, LOADED, "the top");
  await page.evaluate(() => { const v = window.studio.viewer; v.camera.position.set(-80, -20, 30); v.controls.update(); v.draw(); });
  await settle(page);
  const held = await colours(page, [[0, 1, 0.8], [0, 7, 3.2]]);
  assert.ok(held.some((c) => hue(c, HELD) < 0.07), `${held} is held`);
  await page.click("#remove-1");
  await settle(page);
  assert.doesNotMatch(await text(page), /guide\.load/);
  await view(page, "front");
  const [gone] = await colours(page, [shaft]);
  isNot(gone, LOADED, "the arrow is gone");
  await close();
});

test("a pull begins at its face, and the arrow turns with the numbers", async () => {
  const { page, close } = await opened("bar.stl");
  await load(page, [60, 4, 2]);
  await view(page, "front");
  // 100 N against the end: the arrow lies outside and points inwards; its head is at the face.
  let [outside] = await colours(page, [[66, 4, 2]]);
  is(outside, LOADED, "pushing");
  await vector(page, "value-0", [0, 0, 500]);
  const [along, up] = await colours(page, [[69, 4, 2], [60, 4, 9]]);
  isNot(along, LOADED, "not along x any more");
  is(up, LOADED, "upwards");
  assert.match(await text(page), /force_n = \[0, 0, 500\]/);
  await close();
});

test("changes that were not saved are there again in another browser, from another port", async () => {
  const text = (page) => page.inputValue("#panel-job textarea");
  /** A tab of a browser of its own. */
  const tab = async (address, options = { keepsDrafts: true }) => {
    const visited = await visit(browser, address, options);
    await visited.page.waitForSelector("#welcome h2");
    return visited;
  };
  const first = await tab(server.address, {});
  await choose(first.page, "bar.stl");
  await shaped(first.page);
  const before = await text(first.page);
  await first.page.click("#tab-job");
  await first.page.fill("#panel-job textarea", `${before}# mine\n`);
  // The last letters are typed while the request of those before is under way.
  await first.page.focus("#panel-job textarea");
  await first.page.keyboard.press("Control+End");
  await first.page.keyboard.type("# and more");
  const kept = async () => (await (await first.page.context().request.get(new URL("v1/drafts", server.address).href)).json()).drafts.map((d) => d.text);
  let found;
  const comes = (...wanted) => until(async () => (found = JSON.stringify(await kept())) === JSON.stringify(wanted), `drafts ${JSON.stringify(wanted)}`).catch((e) => { throw new Error(`${e.message}, found ${found}`); });
  // The page is left; its browser goes once the request that was begun then has come through.
  await first.page.goto("about:blank");
  await comes(`${before}# mine\n# and more`);
  const other = await studio(files.dir);
  assert.notEqual(new URL(other.address).port, new URL(server.address).port);
  // The first page asks for them too, and then the job: nothing can be typed over them before they come.
  let asked = 0;
  const late = held((request) => request.method() === "GET" && ++asked > 1);
  const second = await tab(other.address, { keepsDrafts: true, routes: { "**/v1/drafts": late.answer } });
  await second.page.click("[data-draft]");
  await late.asked;
  await settle(second.page);
  assert.equal(await second.page.$("#panel-job textarea"), null);
  await late.free(second.page, "**/v1/drafts");
  await shaped(second.page);
  assert.equal(await text(second.page), `${before}# mine\n# and more`);
  await second.page.waitForFunction(() => /not saved, are here again/.test(document.getElementById("progress").textContent));
  // Another tab changes the same job: the last change stays, whole.
  const third = await tab(other.address);
  await third.page.click("[data-draft]");
  await shaped(third.page);
  await third.page.click("#tab-job");
  await third.page.fill("#panel-job textarea", `${before}# theirs\n`);
  await comes(`${before}# theirs\n`);
  await second.page.keyboard.press("Control+z");
  assert.equal(await text(second.page), before);
  // What was undone is no change any more.
  await comes();
  await first.close();
  for (const { wrong, close } of [second, third]) { assert.deepEqual(wrong, []); await close(); }
  const fourth = await tab(other.address);
  assert.equal(await fourth.page.locator("[data-draft]").count(), 0);
  await fourth.close();
  await other.end();
});

test("an error of a file is seen after changes of another one came back", async () => {
  const { page, close } = await opened("angle.stl");
  await page.click("#tab-job");
  const kept = page.waitForResponse((r) => r.request().method() === "PUT" && r.url().endsWith("/v1/drafts"));
  await page.fill("#panel-job textarea", `${await text(page)}# mine\n`);
  await kept;
  await page.reload();
  await page.click("[data-draft]");
  await page.waitForSelector("#progress:has-text('are here again')");
  for (const [name, words] of [["notes.xyz", /the studio opens job files/], ["notes.stl", /notes\.stl: /]]) {
    await page.setInputFiles("#welcome input[type=file]", files.at(name));
    await page.waitForSelector("#progress .error");
    await settle(page);
    assert.match(await page.textContent("#progress .error"), words);
  }
  await close();
});

test("a plan that ends once another file is open takes its place among the runs, and not the view", async () => {
  let isPlanned = false;
  const late = held(() => isPlanned);
  const { page, wrong, close } = await opened("bar.stl", { routes: { "**/events": late.answer } });
  await page.click("#tab-job");
  const run = await shapeRun(page);
  isPlanned = true;
  await page.click("#panel-job >> text=Plan the paths");
  await late.asked;
  isPlanned = false;
  await page.click("#open");
  await page.click('#chooser .files button:has-text("angle.stl")');
  await shapedAnew(page, run);
  late.go();
  await page.waitForSelector("#progress:has-text('bar is done. Another file is open by now')");
  assert.match(await page.textContent("#title"), /angle\.stl$/);
  assert.equal(await page.getAttribute("#tab-shape", "aria-selected"), "true");
  assert.equal(await page.evaluate(() => window.studio.viewer.beads), null);
  await page.click("#runs");
  await page.click('#all-runs [data-open="bar"]');
  await shown(page);
  assert.match(await page.textContent("#title"), /bar\/job\.toml$/);
  assert.deepEqual(wrong, []);
  await close();
});

test("changes are undone and done again, typed ones too", async () => {
  const { page, close } = await opened("bar.stl");
  const first = await text(page);
  await hold(page, [0, 4, 2]);
  const second = await text(page);
  await load(page, [60, 4, 2]);
  await vector(page, "value-1", [10, 0, 0]);
  const third = await text(page);
  assert.match(third, /force_n = \[10, 0, 0\]/);
  await page.focus("#view");
  // The force was changed in one component; the load was added before.
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  assert.equal(await text(page), second);
  await page.keyboard.press("Control+z");
  assert.equal(await text(page), first);
  assert.equal((await page.$$("#items fieldset")).length, 0);
  for (let k = 0; k < 3; k++) await page.keyboard.press("Control+Shift+z");
  assert.equal(await text(page), third);
  assert.equal((await page.$$("#items fieldset")).length, 2);
  await close();
});

test("kinds of loads are written as the job spells them, and drawn", async () => {
  const { page, close } = await opened("bar.stl");
  await load(page, [30, 4, 4]);
  await page.selectOption("#kind-0", "pressure_mpa");
  await page.fill("#value-0", "0.5");
  await page.press("#value-0", "Tab");
  assert.match(await text(page), /pressure_mpa = 0\.5\n/);
  assert.doesNotMatch(await text(page), /force_n/);
  for (const [kind, pattern] of [["moment_nmm", /moment_nmm = \[0, 0, 1000\]/], ["torque_nmm", /torque_nmm = 1000/], ["bearing_n", /bearing_n = \[0, 0, -100\]/]]) {
    await page.selectOption("#kind-0", kind);
    assert.match(await text(page), pattern);
    assert.equal((await text(page)).match(/^(force_n|pressure_mpa|moment_nmm|torque_nmm|bearing_n) = /gm).length, 1, kind);
  }
  await page.click("#gravity");
  assert.match(await text(page), /\[\[guide\.load\]\]\nacceleration_mm_s2 = \[0, 0, -9806\.65\]/);
  await page.selectOption("#kind-0", "torque_nmm");
  await view(page, "front");
  const [axis] = await colours(page, [[30, 4, 8]]);
  is(axis, LOADED, "a torque along the normal of the face");
  await close();
});

test("another kind of a load keeps the comment of its line, and a force its vector as a bearing load", async () => {
  const { page, close } = await opened("bar.stl");
  await load(page, [30, 4, 4]);
  await page.click("#tab-job");
  const mine = (await text(page)).replace(/force_n = .*/, "force_n = [1.5, -2, 30]  # from the rope");
  await page.fill("#panel-job textarea", mine);
  await page.click("#tab-loads");
  await page.selectOption("#kind-0", "bearing_n");
  assert.equal(await text(page), mine.replace("force_n", "bearing_n"));
  await page.selectOption("#kind-0", "force_n");
  assert.equal(await text(page), mine);
  await page.selectOption("#kind-0", "pressure_mpa");
  assert.match(await text(page), /^pressure_mpa = 1 {2}# from the rope$/m);
  await close();
});

test("a number is entered with a comma too, and nothing runs with a field that shows none", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  const type = async (id, words) => { await page.click(`#${id}`, { clickCount: 3 }); await page.keyboard.press("Control+a"); await page.keyboard.press("Delete"); await page.keyboard.type(words); await page.keyboard.press("Tab"); };
  await type("value-1-x", "-2,5");
  assert.match(await text(page), /force_n = \[-2\.5, 0, 0\]/);
  assert.equal(await page.inputValue("#value-1-x"), "-2.5");
  const posted = [];
  page.on("request", (r) => { if (r.method() === "POST" && r.url().endsWith("/v1/jobs")) posted.push(r.postDataJSON().kind); });
  await type("value-1-y", "");
  await type("value-1-z", "1,5");
  // The third component is entered all the same, and the second stays wrong to be seen.
  assert.match(await text(page), /force_n = \[-2\.5, 0, 1\.5\]/);
  assert.equal(await page.textContent("#value-1-y + .wrong"), "should be a number, as 2.5");
  for (const id of ["solve", "plan-here", "test-here"]) {
    await page.click("#tab-loads");
    await page.click(`#${id}`);
    assert.equal(await page.textContent("#progress .error"), "Nothing was run: y is empty and should be a number, as 2.5", id);
    await page.click("#progress button");
  }
  assert.deepEqual(posted, []);
  // What is undone brings the number of the text back.
  await page.click("#tab-loads");
  await type("value-1-y", "7");
  assert.equal(await page.$(".wrong"), null);
  assert.match(await text(page), /force_n = \[-2\.5, 7, 1\.5\]/);
  await page.selectOption("#case-1", { label: "a new case" });
  await type("weight-0", "-3");
  assert.match(await page.textContent("#weight-0 + .wrong"), /above 0/);
  await type("weight-0", "0,5");
  assert.match(await text(page), /weight = 0\.5\n/);
  await page.click("#tab-shape");
  await type("scale", "-2");
  assert.match(await page.textContent("#scale + .wrong"), /above 0/);
  assert.doesNotMatch(await text(page), /scale/);
  await type("place-x", "10,5");
  assert.match(await page.textContent("#place-y + .wrong"), /or neither/);
  const run = await shapeRun(page);
  await type("scale", "1,5");
  assert.match(await text(page), /scale = 1\.5\n/);
  // What is typed while the part is made anew stays, and so does the focus.
  await page.click("#place-x");
  await page.keyboard.press("Control+a");
  await page.keyboard.type("7");
  await shapedAnew(page, run);
  assert.deepEqual(await page.evaluate(() => [document.activeElement.id, document.activeElement.value]), ["place-x", "7"]);
  assert.doesNotMatch(await text(page), /position_mm/);
  await page.keyboard.press("Tab");
  assert.match(await page.textContent("#place-y + .wrong"), /or neither/);
  await type("place-x", "");
  assert.equal(await page.textContent("#size"), "90.00 × 12.00 × 6.00 mm");
  assert.equal(await page.$("[aria-invalid]"), null, "the fields are those of the text again");
  assert.deepEqual(wrong, []);
  await close();
});

test("fixtures hold single directions", async () => {
  const { page, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await page.selectOption("#fix-0", "normal");
  assert.match(await text(page), /fix = "normal"/);
  await page.selectOption("#fix-0", "xz");
  assert.match(await text(page), /fix = "xz"/);
  await page.click("#items summary");
  await vector(page, "moved-0", [0.1, 0, 0]);
  assert.match(await text(page), /displacement_mm = \[0\.1, 0, 0\]/);
  await close();
});

test("a force on several faces is shared by their areas", async () => {
  const { page, close } = await opened("angle.stl");
  await page.click("#tab-loads");
  await page.$eval("#all-faces", (d) => (d.open = true));
  const [small, large] = [await faceAt(page, [40, 4, 2]), await faceAt(page, [20, 0, 2])];
  await page.click(`button.face[data-face="${small}"]`);
  await page.click(`button.face[data-face="${large}"]`, { modifiers: ["Shift"] });
  await page.click("#load-here");
  const forces = [...(await text(page)).matchAll(/force_n = \[(.*?), .*?\]/g)].map((m) => Number(m[1]));
  // 32 and 160 mm2, along the normal of the first.
  assert.equal(forces.length, 2);
  assert.ok(Math.abs(forces[0] + 100 / 6) < 1e-3 && Math.abs(forces[1] + 500 / 6) < 1e-3, `${forces}`);
  await close();
});

test("a quarter turn turns the part, its size and the settings of the job", async () => {
  const { page, close } = await opened("bar.stl");
  const run = await shapeRun(page);
  await page.click("#turn-y");
  await shapedAnew(page, run);
  assert.equal(await page.textContent("#size"), "4.00 × 8.00 × 60.00 mm");
  assert.match(await text(page), /rotate_deg = \[0, 90, 0\]/);
  await view(page, "front");
  const [middle] = await colours(page, [[2, 0, 30]]);
  is(middle, PLAIN, "upright");
  await close();
});

test("two presses in a row are two turns, and loads turn with the part once", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  const first = await shapeRun(page);
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", (await text(page)).replace(/^mesh = .*$/m, "$&\nrotate_deg = [90, 0, 0]"));
  await shapedAnew(page, first);
  const [low, high] = await page.evaluate(() => [-1, 1].map((side) => window.studio.report.faces.find((row) => row.normal && row.normal[0] * side > 0.9).centre_mm));
  await hold(page, low);
  await load(page, high);
  await vector(page, "value-1", [0, 0, -20]);
  const run = await shapeRun(page);
  await page.evaluate(() => { for (let k = 0; k < 2; k++) document.getElementById("turn-x").click(); });
  const now = await text(page);
  assert.match(now, /rotate_deg = \[-90, 0, 0\]/);
  // From the frame of the plate, where the part was turned by 90 degrees, to that of the file.
  assert.match(now, /force_n = \[0, -20, 0\]/);
  // A load that is added before the part stands anew has the coordinates of the file, too: 100 N against the face.
  const side = await page.evaluate(() => window.studio.report.faces.find((row) => row.normal && row.normal[2] > 0.9).centre_mm);
  await load(page, side);
  assert.match(await text(page), /force_n = \[0, -100, 0\]/);
  await shapedAnew(page, run);
  assert.deepEqual(wrong, []);
  await close();
});

test("a part that is turned or laid down bends as it did", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await vector(page, "value-1", [0, 0, -20]);
  // The peak lies in the corner of the held end, where it depends on the mesh; the displacement does not.
  const moved = async () => { await page.click("#tab-loads"); await solve(page); return parseFloat(await page.textContent("#peak-moved")); };
  const first = await moved();
  const turned = async (press) => {
    const run = await shapeRun(page);
    await press();
    await shapedAnew(page, run);
    const now = await moved();
    // Loads that stay behind bend the bar about its other axis, which is four times as stiff.
    assert.ok(Math.abs(now / first - 1) < 0.05, `${first} ${now} mm`);
  };
  await page.click("#tab-shape");
  await turned(() => page.click("#turn-x"));
  assert.match(await text(page), /frame = "part"/);
  assert.match(await text(page), /rotate_deg = \[90, 0, 0\]/);
  assert.match(await text(page), /force_n = \[0, 0, -20\]/);
  // By hand: the end of the bar at its point of the screen, then laid on it.
  await view(page, "oblique");
  await click(page, [30, 0, 4]);
  await page.click("#tab-shape");
  await turned(() => page.click("#lay"));
  assert.deepEqual(wrong, []);
  await close();
});

test("a face of a part that is turned in its file is laid on the plate", async () => {
  const { page, close } = await opened("turned.stl");
  const before = (await page.textContent("#size")).match(/[\d.]+/g).map(Number);
  assert.ok(before.every((v) => v > 8), `${before}`);
  const largest = await page.evaluate(() => window.studio.report.faces.findIndex((f) => Math.abs(f.area_mm2 - 360) < 0.1));
  await page.click("#tab-loads");
  await page.$eval("#all-faces", (d) => (d.open = true));
  await page.click(`button.face[data-face="${largest}"]`);
  await page.click("#tab-shape");
  const run = await shapeRun(page);
  await page.click("#lay");
  await shapedAnew(page, run);
  const size = (await page.textContent("#size")).match(/[\d.]+/g).map(Number);
  assert.ok(Math.abs(size[2] - 6) < 0.011, `${size}: 6 mm high`);
  // It lies on that face: the name is still known, and its normal is down.
  const normal = await page.evaluate((f) => window.studio.report.faces[f].normal, largest);
  assert.ok(normal[2] < -0.9999, `${normal}`);
  await close();
});

test("loads in the frame of the part turn with it", async () => {
  const { page, close } = await opened("bar.stl");
  await page.click("#tab-job");
  const run = await shapeRun(page);
  await page.fill("#panel-job textarea", `${await text(page)}\n[guide]\nframe = "part"\n`);
  await shapedAnew(page, run);
  await load(page, [30, 4, 4]);
  const again = await shapeRun(page);
  await page.click("#tab-shape");
  await page.click("#turn-x");
  await shapedAnew(page, again);
  // The top now looks along -y; the force in the text stays and is drawn against it.
  assert.match(await text(page), /force_n = \[0, 0, -100\]/);
  await page.click("#tab-loads");
  await view(page, "side");
  const { low, high } = await page.evaluate(() => ({ low: window.studio.part.low.toArray(), high: window.studio.part.high.toArray() }));
  const [shaft] = await colours(page, [[60, low[1] - 4, 0.5 * (low[2] + high[2])]]);
  is(shaft, LOADED, "from the front");
  await close();
});

test("the unit is asked where the size is in doubt", async () => {
  const { page, close } = await opened("inch.stl");
  assert.match(await page.textContent("#unit-asked"), /In mm the part would be 2\.00 mm long.*inch/);
  const run = await shapeRun(page);
  await page.click("#take-likely");
  await shapedAnew(page, run);
  assert.equal(await page.textContent("#size"), "50.80 × 25.40 × 6.35 mm");
  assert.equal(await page.$("#unit-asked"), null);
  assert.match(await text(page), /unit = "inch"/);
  const again = await shapeRun(page);
  await page.fill("#scale", "2");
  await page.press("#scale", "Tab");
  await shapedAnew(page, again);
  assert.equal(await page.textContent("#size"), "101.60 × 50.80 × 12.70 mm");
  await close();
});

test("open edges are counted, and red where they are", async () => {
  const { page, close } = await opened("open.stl");
  assert.match(await page.textContent("#defects"), /open edges4/);
  await view(page, "top");
  const points = [];
  for (let k = -4; k <= 4; k++) points.push([10, 0.03 * k, 5]);
  const rim = await colours(page, points);
  assert.ok(rim.some((c) => c[0] > c[1] + 40 && c[0] > c[2] + 30), `${rim}`);
  const [inside] = await colours(page, [[10, 5, 0]]);
  assert.ok(inside[0] < inside[2] + 20, `${inside}: through the hole to the bottom`);
  await close();
});

test("a file that is no mesh is refused with the sentence of the command line", async () => {
  const visited = await visit(browser, server.address);
  await choose(visited.page, "notes.stl");
  await visited.page.waitForSelector("#progress .error");
  assert.match(await visited.page.textContent("#progress .error"), /notes\.stl: /);
  await visited.close();
});

test("a job of the user's own is shown, changed and solved, with its files beside it", async () => {
  const visited = await visit(browser, server.address);
  const { page } = visited;
  await page.waitForSelector("#welcome h2");
  await page.click("#open");
  await page.click('#chooser .files button:has-text("jobs/")');
  await page.click('#chooser .files button:has-text("plate.toml")');
  await shaped(page);
  await page.click("#tab-loads");
  const legends = await page.$$eval("#items legend", (all) => all.map((l) => l.textContent));
  assert.deepEqual(legends, ["fixture 1", "load 1"]);
  await page.selectOption("#fix-0", "x");
  await page.selectOption("#fix-0", "xyz");
  await page.selectOption("#fix-0", "xy");
  assert.match(await text(page), /^# mine\n[\s\S]*mesh = "plate\.stl"  # beside the job/);
  await page.selectOption("#fix-0", "xyz");
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", `${await text(page)}# more\n`);
  await page.click("#tab-loads");
  await solve(page);
  // 40 N over 20 mm2.
  assert.match(await page.textContent("#stress"), /load 140\.00, 0\.00, 0\.00 N/);
  await visited.close();
});

test("a bar that is pulled has the stress of force over area, in MPa on the scale and in colour", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await vector(page, "value-1", [320, 0, 0]);
  await view(page, "top");
  const middle = [[30, 4, 4], [36, 2, 4]];
  const [before] = await colours(page, middle);
  await solve(page);
  // 320 N over 32 mm2 are 10 MPa; half of a scale to 20 is the middle of the ramp.
  await page.fill("#scale-low", "0");
  await page.press("#scale-low", "Tab");
  await page.fill("#scale-high", "20");
  await page.press("#scale-high", "Tab");
  const stressed = await colours(page, middle);
  for (const c of stressed) assert.ok(far(c, [38 * 0.974, 130 * 0.974, 142 * 0.974]) < 12, `${c}`);
  assert.ok(far(before, stressed[0]) > 25, `${before}: without stress`);
  assert.deepEqual(await page.$$eval("#legend .ends span", (s) => s.map((x) => x.textContent)), ["0 MPa", "20 MPa"]);
  const [[x, y]] = await places(page, [middle[0]]);
  await page.mouse.move(x, y);
  await page.waitForFunction(() => !document.getElementById("bead").hidden);
  const found = Number((await page.textContent("#bead")).match(/von Mises ([\d.]+) MPa/)[1]);
  assert.ok(Math.abs(found - 10) < 0.05, `${found} MPa`);
  // The smallest principal stress is none: the dark end of a scale from 0.
  await page.selectOption("#quantity", "third");
  await page.fill("#scale-low", "0");
  await page.press("#scale-low", "Tab");
  await page.fill("#scale-high", "20");
  await page.press("#scale-high", "Tab");
  const [dark] = await colours(page, middle);
  assert.ok(far(dark, [66, 1, 82]) < 14, `${dark}`);
  await page.click("#stress-on");
  const [plain] = await colours(page, middle);
  is(plain, PLAIN, "the stress is switched off");
  assert.deepEqual(wrong, []);
  await close();
});

test("a bar that is bent has the stress of moment over section, and moves where it is drawn", async () => {
  const { page, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await vector(page, "value-1", [0, 20, 0]);
  await solve(page);
  await view(page, "top");
  // M = 20 N * 30 mm, I = 4 * 8^3 / 12 mm4; 3 mm below the middle the bar is pulled.
  const wanted = (20 * 30 * 3) / ((4 * 8 ** 3) / 12);
  const [[x, y], [ex, ey]] = await places(page, [[30, 1, 4], [30, 7, 4]]);
  const principal = async (px, py) => {
    await page.mouse.move(px, py);
    await settle(page);
    await settle(page);
    return (await page.textContent("#bead")).match(/principal (-?[\d.]+), (-?[\d.]+), (-?[\d.]+) MPa/).slice(1).map(Number);
  };
  const pulled = await principal(x, y);
  assert.ok(Math.abs(pulled[0] - wanted) < 0.02 * wanted, `${pulled} MPa, ${wanted}`);
  const pressed = await principal(ex, ey);
  assert.ok(Math.abs(pressed[2] + wanted) < 0.02 * wanted, `${pressed} MPa, -${wanted}`);
  // Drawn larger, the end leaves its place upwards by a tenth of the part.
  await page.mouse.move(5, 5);
  await page.selectOption("#quantity", "moved");
  const at = [[58, 11, 4]];
  const [rest] = await colours(page, at);
  await page.$eval("#magnify", (input) => { input.value = "1"; input.dispatchEvent(new Event("input", { bubbles: true })); });
  const [moved] = await colours(page, at);
  assert.ok(far(rest, moved) > 40, `${rest} ${moved}`);
  // The yellow end of the ramp: the largest displacement is there.
  assert.ok(moved[0] > 180 && moved[1] > 190 && moved[2] < 110, `${moved}`);
  await close();
});

test("what the page solves is what the command line solves from the same job", async () => {
  const { page, close } = await opened("angle.stl");
  await hold(page, [4, 30, 2]);
  await load(page, [40, 4, 2]);
  await vector(page, "value-1", [0, -30, 0]);
  await solve(page);
  const shown = await page.textContent("#peak-stress");
  writeFileSync(files.at("angle.toml"), await text(page));
  const theirs = JSON.parse(command(files.dir, "run", "angle.toml", "--check", "--json")).stress;
  assert.ok(shown.startsWith(`${threeDigits(theirs.max_von_mises_mpa)} MPa at ${theirs.peak_at_mm.map((v) => v.toFixed(1)).join(", ")}`), `${shown} ${JSON.stringify(theirs.peak_at_mm)}`);
  assert.equal(await page.textContent("#peak-moved"), `${threeDigits(theirs.max_displacement_mm)} mm`);
  assert.deepEqual(theirs.loads[0].force_n.map((v) => Math.round(v * 1e6) / 1e6 + 0), [0, -30, 0]);
  assert.ok(readFileSync(files.at("angle.toml"), "utf8").includes('[[guide.fixture]]'));
  await close();
});

test("several load cases are shown one by one", async () => {
  const late = held();
  const { page, close } = await opened("bar.stl", { routes: { "**/stress/1": late.answer } });
  await hold(page, [0, 4, 2]);
  const end = await faceAt(page, [60, 4, 2]);
  const name = await page.evaluate((f) => window.studio.report.faces[f].name, end);
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", `${await text(page)}\n[[guide.case]]\nname = "pull"\n[[guide.case.load]]\non = { face = "${name}" }\nforce_n = [320, 0, 0]\n\n[[guide.case]]\nname = "none"\n[[guide.case.load]]\non = { face = "${name}" }\nforce_n = [32, 0, 0]\n`);
  await page.click("#tab-loads");
  assert.deepEqual(await page.$$eval("#items legend", (all) => all.map((l) => l.textContent)), ["fixture 1", "load 1 of case pull", "load 1 of case none"]);
  await vector(page, "value-2", [64, 0, 0]);
  await solve(page);
  await view(page, "top");
  const at = async () => {
    const [[x, y]] = await places(page, [[30, 4, 4]]);
    await page.mouse.move(x, y + 1);
    await page.mouse.move(x, y);
    await settle(page);
    await settle(page);
    return Number((await page.textContent("#bead")).match(/von Mises ([\d.]+) MPa/)[1]);
  };
  assert.ok(Math.abs((await at()) - 10) < 0.05);
  // The numbers beside it are those of the case. The same force is five times as large in the first one.
  const peak = async (id) => Number((await page.textContent(`#${id}`)).match(/^[\d.]+/)[0]);
  const [first, moved] = [await peak("peak-stress"), await peak("peak-moved")];
  assert.equal(await peak("peak-of-all"), first);
  const forces = () => page.$$eval("#stress-facts tr", (rows) => rows.map((r) => r.textContent).filter((t) => / N$/.test(t)));
  assert.match((await forces())[0], /^load 1 of case "pull"320\.00, 0\.00, 0\.00 N$/);
  // The case that was chosen last is shown, and not the one whose values come last.
  await page.selectOption("#case", "1");
  await late.asked;
  await page.selectOption("#case", "0");
  await late.free(page, "**/stress/1");
  assert.ok(Math.abs((await at()) - 10) < 0.05);
  await page.selectOption("#case", "1");
  await page.waitForFunction(() => Number(document.getElementById("scale-high").value) < 6);
  assert.ok(Math.abs((await at()) - 2) < 0.02);
  assert.ok(Math.abs((await peak("peak-stress")) / first - 0.2) < 0.003, `${await peak("peak-stress")} ${first}`);
  assert.ok(Math.abs((await peak("peak-moved")) / moved - 0.2) < 0.003, `${await peak("peak-moved")} ${moved}`);
  assert.equal(await peak("peak-of-all"), first);
  assert.match((await forces())[0], /^load 1 of case "none"64\.00, 0\.00, 0\.00 N$/);
  assert.equal((await forces()).length, 2, "its load and its reaction");
  await close();
});

/** The job of a bar that is held at one end; at the other it is pulled in one case and pushed aside in another. */
async function twoCases(page) {
  await hold(page, [0, 4, 2]);
  const name = await page.evaluate((f) => window.studio.report.faces[f].name, await faceAt(page, [60, 4, 2]));
  const one = (words, force) => `\n[[guide.case]]\nname = "${words}"\n[[guide.case.load]]\non = { face = "${name}" }\nforce_n = ${force}\n`;
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", `${await text(page)}${one("pull", "[320, 0, 0]")}${one("push", "[0, 20, 0]")}`);
  await page.click("#tab-loads");
}

test("under the stress of a case its own loads are drawn, without the stress those of all cases", async () => {
  const { page, close } = await opened("bar.stl");
  await twoCases(page);
  await view(page, "top");
  // On the shafts of both arrows, which begin at the middle of the end.
  const arrows = async () => (await colours(page, [[66, 4, 2], [60, 11, 2]])).map((c) => hue(c, LOADED) < 0.07);
  assert.deepEqual(await arrows(), [true, true]);
  await solve(page);
  await view(page, "top");
  assert.deepEqual(await arrows(), [true, false], "pull");
  await page.selectOption("#case", "1");
  await page.waitForFunction(() => document.getElementById("stress-facts").textContent.includes("of push"));
  await settle(page);
  assert.deepEqual(await arrows(), [false, true], "push");
  await page.uncheck("#stress-on");
  await settle(page);
  assert.deepEqual(await arrows(), [true, true]);
  await close();
});

test("a case whose values do not come leaves the one before it on screen and chosen", async () => {
  let isLost = false;
  const { page, close } = await opened("bar.stl", { routes: { "**/stress/1": (route) => (isLost ? route.fulfill({ status: 404, json: { ok: false, error: "no such job" } }) : route.fallback()) } });
  await twoCases(page);
  await solve(page);
  const told = await page.textContent("#stress-facts");
  isLost = true;
  await page.selectOption("#case", "1");
  await page.waitForSelector("#progress .error");
  assert.equal(await page.textContent("#progress .error"), "no such job");
  assert.equal(await page.inputValue("#case"), "0");
  assert.equal(await page.textContent("#stress-facts"), told);
  isLost = false;
  await page.selectOption("#case", "1");
  await page.waitForFunction(() => document.getElementById("stress-facts").textContent.includes("of push"));
  await close();
});

test("loads without a fixture are refused in words", async () => {
  const { page, close } = await opened("bar.stl");
  await load(page, [60, 4, 2]);
  await solve(page);
  assert.match(await page.textContent("#progress .error"), /needs a \[\[guide\.fixture\]\]/);
  await close();
});

test("a solved stress says when the loads have changed since", async () => {
  const late = held();
  const { page, close } = await opened("bar.stl", { routes: { "**/stress": late.answer } });
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  // They may change while it is solved.
  await page.click("#solve");
  await late.asked;
  await vector(page, "value-1", [-20, 0, 0]);
  await late.free(page, "**/stress");
  await page.waitForSelector("#stale");
  await solve(page);
  assert.equal(await page.isVisible("#stale"), false);
  await vector(page, "value-1", [-50, 0, 0]);
  assert.equal(await page.isVisible("#stale"), true);
  await solve(page);
  assert.equal(await page.isVisible("#stale"), false);
  // So do the elements, the part's material and its strength, and not what is printed; the text as it was has this stress.
  const solved = await text(page);
  for (const [words, isStale] of [["[process]\ntop_speed_mm_s = 40\n", false], ["[material]\ne_mpa = 900\n", true], ["[material]\nxt_mpa = [1.0, 2.0, 3.0]\n", true], ["[fill]\ndensity = 0.3\n", false]]) {
    const table = words.split("\n")[0];
    const changed = solved.includes(`${table}\n`) ? solved.replace(`${table}\n`, words) : `${words}\n${solved}`;
    await page.$eval("#panel-job textarea", (area, value) => { area.value = value; area.dispatchEvent(new Event("input", { bubbles: true })); }, changed);
    assert.equal(await page.isVisible("#stale"), isStale, words);
    await page.$eval("#panel-job textarea", (area, value) => { area.value = value; area.dispatchEvent(new Event("input", { bubbles: true })); }, solved);
    assert.equal(await page.isVisible("#stale"), false, `${words}: taken back`);
  }
  await page.click("#tab-shape");
  await page.selectOption("#printer-and-material select >> nth=1", "petg");
  await page.click("#tab-loads");
  assert.equal(await page.isVisible("#stale"), true, "another material");
  await close();
});

test("a part that has changed on the disk is read again before anything runs, and where its file is gone that is said", async () => {
  writeFileSync(files.at("again.stl"), boxStl([60, 8, 4]));
  const { page, close } = await opened("again.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await solve(page);
  // As a CAD program would export it again, ten millimetres longer.
  let run = await shapeRun(page);
  writeFileSync(files.at("again.stl"), boxStl([70, 8, 4]));
  await page.click("#solve");
  await shapedAnew(page, run);
  await page.waitForSelector("#progress .error:has-text('again.stl has changed on the disk since it was read')");
  assert.equal(await page.textContent("#size"), "70.00 × 8.00 × 4.00 mm");
  assert.equal(await page.isVisible("#peak-stress"), false, "the stress of the part before is gone");
  assert.equal((await page.$$("#items fieldset")).length, 2);
  await page.click("#solve");
  await page.waitForSelector("#peak-stress", { timeout: 240_000 });
  // The page looks when it is come back to.
  run = await shapeRun(page);
  writeFileSync(files.at("again.stl"), boxStl([50, 8, 4]));
  await page.evaluate(() => window.dispatchEvent(new Event("focus")));
  await shapedAnew(page, run);
  assert.equal(await page.textContent("#size"), "50.00 × 8.00 × 4.00 mm");
  rmSync(files.at("again.stl"));
  await page.click("#solve");
  await page.waitForSelector("#progress .error:has-text('again.stl: not found')");
  assert.equal(await page.textContent("#size"), "50.00 × 8.00 × 4.00 mm");
  await close();
});

test("a job whose lines end as on Windows keeps them, and what is typed in its text is undone", async () => {
  writeFileSync(files.at("jobs/windows.toml"), '# mine\r\n[shape]\r\nmesh = "plate.stl"\r\n\r\n[[guide.fixture]]\r\non = { box_mm = [[0, 0, 0], [0, 10, 2]] }\r\nfix = "xyz"\r\n\r\n[[guide.load]]\r\non = { box_mm = [[20, 0, 0], [20, 10, 2]] }\r\nforce_n = [40, 0, 0]  # pulled\r\n');
  const { page, wrong, close } = await visit(browser, server.address);
  await page.click("#open");
  await page.click('#chooser .files button:has-text("jobs/")');
  await page.click('#chooser .files button:has-text("windows.toml")');
  await shaped(page);
  await page.click("#tab-loads");
  await page.waitForSelector("#value-1-x");
  const before = await text(page);
  await vector(page, "value-1", [55, 0, 0]);
  const changed = await text(page);
  assert.match(changed, /force_n = \[55, 0, 0\]  # pulled/);
  // Typed at the end of the text, and undone by itself.
  await page.click("#tab-job");
  await page.focus("#panel-job textarea");
  await page.keyboard.press("Control+End");
  await page.keyboard.type("\n# typed");
  assert.equal(await text(page), `${changed}\n# typed`);
  await page.keyboard.press("Control+z");
  assert.equal(await text(page), changed);
  await page.keyboard.press("Control+z");
  assert.equal(await text(page), before);
  await page.keyboard.press("Control+Shift+z");
  await page.fill("#save-name", "windows-again");
  await page.click("#save-as");
  await page.waitForSelector("#progress:has-text('Saved as')");
  const saved = (await page.textContent("#progress")).match(/Saved as (\S+\.toml)/)[1];
  const lines = readFileSync(saved, "utf8").split("\n");
  assert.ok(lines.slice(0, -1).every((l) => l.endsWith("\r")), JSON.stringify(lines));
  assert.ok(lines.includes("force_n = [55, 0, 0]  # pulled\r"));
  assert.deepEqual(wrong, []);
  await close();
});

test("few draw calls, and opening twenty parts leaves nothing behind", async () => {
  const { page, close } = await opened("angle.stl");
  await hold(page, [4, 30, 2]);
  await load(page, [40, 4, 2]);
  await settle(page);
  const calls = await page.evaluate(() => window.studio.viewer.renderer.info.render.calls);
  assert.ok(calls > 0 && calls <= 20, `${calls} calls`);
  const memory = () => page.evaluate(() => { const m = window.studio.viewer.renderer.info.memory; return [m.geometries, m.textures]; });
  const turn = async () => { const run = await shapeRun(page); await page.evaluate(() => document.getElementById("turn-z").click()); await shapedAnew(page, run); };
  await turn();
  const before = await memory();
  for (let k = 0; k < 20; k++) await turn();
  assert.deepEqual(await memory(), before);
  await close();
});

test("loads are put into cases with weights, and the stress is solved for each", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  await hold(page, [0, 4, 2]);
  await load(page, [60, 4, 2]);
  await page.click("#gravity");
  await page.selectOption("#case-2", { label: "a new case" });
  assert.match(await text(page), /\[\[guide\.case\]\]\nname = "case 1"\nweight = 1\n\n\[\[guide\.case\.load\]\]\nacceleration_mm_s2/);
  await page.fill("#weight-0", "3");
  await page.press("#weight-0", "Tab");
  assert.match(await text(page), /name = "case 1"\nweight = 3\n/);
  await page.click("#solve");
  await page.waitForSelector("#peak-stress", { timeout: 240_000 });
  assert.deepEqual(await page.$$eval("#case option", (all) => all.map((o) => o.textContent)), ["loads", "case 1"]);
  // A second load of the case, then both leave it: the case goes with its last load.
  await page.selectOption("#case-1", { label: "case 1" });
  assert.doesNotMatch(await text(page), /\[\[guide\.load\]\]/);
  await page.selectOption("#case-1", { label: "none" });
  await page.selectOption("#case-2", { label: "none" });
  assert.doesNotMatch(await text(page), /guide\.case/);
  assert.equal((await text(page)).match(/\[\[guide\.load\]\]/g).length, 2);
  await page.keyboard.press("Control+z");
  assert.match(await text(page), /guide\.case/);
  assert.deepEqual(wrong, []);
  await close();
});

test("printer and material are chosen before all else, with what the material's card rests on", async () => {
  const { page, wrong, close } = await opened("bar.stl");
  assert.equal(await page.textContent("#panel-shape h2"), "Printer and material");
  const tier = () => page.textContent("#panel-shape .tier");
  assert.match(await tier(), /^Strengths of pla rest on .* \(tier T\d\)$/);
  await page.selectOption("#printer-and-material select >> nth=1", "petg");
  assert.match(await text(page), /\[material\]\nprofile = "petg"/);
  assert.match(await tier(), /^Strengths of petg rest on .* \(tier T\d\)$/);
  // Both panels show the same choice.
  assert.equal(await page.inputValue("#panel-job select >> nth=1"), "petg");
  assert.deepEqual(wrong, []);
  await close();
});

test("an arrow behind the part shines through it", async () => {
  const { page, close } = await opened("bar.stl");
  await load(page, [30, 8, 2]);
  await vector(page, "value-0", [0, 10, 0]);
  await view(page, "front");
  // Seen from its end: the arrow is behind the middle of the front face, and nothing is behind the place beside it.
  const warmth = ([r, , b]) => r - b;
  const [hidden, beside] = (await colours(page, [[30, 0, 2], [20, 0, 2]])).map(warmth);
  assert.ok(hidden - beside > 25, `${hidden} ${beside}`);
  await close();
});
