// The page itself: sizes, light and dark, opening files, errors, access by keyboard and screen readers.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { boxStl, command, folder, held, launch, picture, shaped, shown, squares, studio, vector, visit } from "./bench.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

let files, server, browser;
before(async () => {
  files = folder({ "squares.gcode": squares(), "bad.gcode": "Dear Sir or Madam,\n", "notes.txt": "nothing", "broken.toml": "[fill]\ndensity = = 1\n", "graded.toml": "[fill]\ndensity = 0.4\n", "packed.bgcode": "GCDE", "box.stl": boxStl([30, 12, 3]) });
  server = await studio(files.dir);
  browser = await launch();
});
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

/** Opens a file through the chooser, by keyboard alone. */
async function choose(page, name) {
  await page.keyboard.press("o");
  await page.waitForSelector("#chooser .files button");
  await page.focus(`#chooser .files button:has-text("${name}")`);
  await page.keyboard.press("Enter");
}

test("an empty page says what to do", async () => {
  const { page, wrong, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  assert.match(await page.textContent("#welcome"), /Drop G-code of any slicer here/);
  assert.match(await page.textContent("#welcome"), /Nothing leaves this computer/);
  assert.deepEqual(wrong, []);
  await close();
});

test("a file is chosen on the server's side by keyboard", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "squares.gcode");
  await shown(page);
  assert.match(await page.textContent("#title"), /squares\.gcode$/);
  await close();
});

test("files that cannot be opened are listed and not offered", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await page.click("#open");
  await page.waitForSelector("#chooser .files button");
  assert.equal(await page.isDisabled('#chooser .files button:has-text("notes.txt")'), true);
  assert.equal(await page.isDisabled('#chooser .files button:has-text("packed.bgcode")'), true);
  assert.match(await page.textContent('#chooser .files button:has-text("packed.bgcode")'), /binary G-code: have it written as text/);
  assert.equal(await page.isDisabled('#chooser .files button:has-text("squares.gcode")'), false);
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#chooser"), false);
  await close();
});

test("a program of another slicer opens on its strength, one of grainpath on its paths", async () => {
  mkdirSync(files.at("own"));
  command(files.dir, "slice", "box.stl", "-o", "own/box.gcode");
  for (const [name, tab] of [["squares.gcode", "strength"], ["box.gcode", "paths"]]) {
    const { page, wrong, close } = await visit(browser, server.address);
    await page.waitForSelector("#welcome h2");
    await page.keyboard.press("o");
    if (tab === "paths") await page.click('#chooser .files button:has-text("own/")');
    await page.click(`#chooser .files button:has-text("${name}")`);
    await shown(page);
    assert.equal(await page.getAttribute(`#tab-${tab}`, "aria-selected"), "true", name);
    // The fields of the strength test come with the materials.
    await page.waitForSelector("#break", { state: tab === "strength" ? "visible" : "attached" });
    assert.equal(await page.isVisible("#break"), tab === "strength", name);
    // The other one is a click away.
    await page.click(tab === "paths" ? "text=Where does it break?" : "#tab-paths");
    assert.equal(await page.isVisible("#break"), tab === "paths", name);
    assert.deepEqual(wrong, []);
    await close();
  }
});

test("the file that was opened last is the one that is shown, whichever answer comes last", async () => {
  // A job whose text comes late, then a program whose layers do, then the materials for the strength of a program.
  let isFirst;
  const [job, layers, materials] = [held(), held(), held(() => isFirst)];
  for (const [address, late, first, last] of [["**/v1/text?*", job, "graded.toml", "squares.gcode"], ["**/v1/jobs/*/layers", layers, "squares.gcode", "graded.toml"], ["**/v1/profiles", materials, "squares.gcode", "graded.toml"]]) {
    const { page, wrong, close } = await visit(browser, server.address, { routes: { [address]: late.answer } });
    await page.waitForSelector("#welcome h2");
    isFirst = true;
    await choose(page, first);
    await late.asked;
    isFirst = false;
    await choose(page, last);
    await page.waitForSelector(last === "squares.gcode" ? "#break" : "#panel-job textarea");
    await late.free(page, address);
    assert.ok((await page.textContent("#title")).endsWith(last), address);
    const isJob = last === "graded.toml";
    assert.deepEqual(await page.evaluate(() => [document.querySelector("#panel-job textarea") !== null, document.querySelector("#test-job") !== null, document.querySelector("#break") === null, !window.studio.viewer.beads]), [isJob, isJob, isJob, isJob], address);
    assert.equal(await page.getAttribute(isJob ? "#tab-job" : "#tab-strength", "aria-selected"), "true", address);
    assert.deepEqual(wrong, []);
    await close();
  }
});

test("the folder that was chosen last is listed", async () => {
  for (const name of ["large", "small"]) mkdirSync(files.at(name));
  const late = held((request) => request.url().endsWith("large"));
  const { page, close } = await visit(browser, server.address, { routes: { "**/v1/files?*": late.answer } });
  await page.waitForSelector("#welcome h2");
  await page.keyboard.press("o");
  await page.click('#chooser .files button:has-text("large/")');
  await late.asked;
  await page.click('#chooser .files button:has-text("small/")');
  await page.waitForSelector("#chooser .note:has-text('small')");
  await late.free(page, /large$/);
  assert.match(await page.textContent("#chooser .note"), /small$/);
  await close();
});

test("a file sent with the browser is shown", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await page.setInputFiles("#welcome input[type=file]", files.at("squares.gcode"));
  await shown(page);
  assert.match(await page.textContent("#title"), /uploads\/squares\.gcode$/);
  await close();
});

test("an error is the sentence of the command line", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "bad.gcode");
  await page.waitForSelector("#progress .error");
  assert.match(await page.textContent("#progress .error"), /bad\.gcode: not G-code: no line of 1 has a command$/);
  await close();
});

test("a force or a depth that is no number is said, and nothing is broken with it", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "squares.gcode");
  await shown(page);
  await page.click("#tab-strength");
  const posted = [];
  page.on("request", (r) => { if (r.method() === "POST" && r.url().endsWith("/v1/jobs")) posted.push(r.postDataJSON()); });
  for (const [id, words, right] of [["force", "-50", "12,5"], ["depth", "0", "1,5"]]) {
    await page.fill(`#${id}`, words);
    await page.click("#break");
    assert.match(await page.textContent("#progress .error"), new RegExp(`${id}.* is ${words} and should be a number above 0`, "i"));
    await page.fill(`#${id}`, right);
    await page.press(`#${id}`, "Tab");
    assert.equal(await page.$(".wrong"), null);
    assert.equal(await page.inputValue(`#${id}`), right.replace(",", "."));
  }
  assert.deepEqual(posted, []);
  assert.match(await page.textContent("#strength-job"), /12\.5/);
  await close();
});

test("a warning names its place", async () => {
  const place = { file: "squares.gcode", line: 7, layer: 2, z_mm: 0.4, point_mm: [1, 2.5] };
  const routes = { "**/v1/jobs/*/result": async (route) => { const answer = await route.fetch(); await route.fulfill({ response: answer, json: { ...(await answer.json()), warnings: [{ id: "x", text: "odd", place, remedy: "none" }, { id: "y", text: "all over" }] } }); } };
  const { page, close } = await visit(browser, server.address, { routes });
  await page.waitForSelector("#welcome h2");
  await choose(page, "squares.gcode");
  await shown(page);
  assert.deepEqual(await page.$$eval("#panel-paths .warning", (all) => all.map((w) => w.textContent)), ["squares.gcode, line 7, layer 2 at z = 0.40 mm, (1.00, 2.50): odd – none", "all over"]);
  await close();
});

test("an error in the text of a job is said as it is typed, and as it is opened", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "broken.toml");
  await page.waitForSelector("#job-error:not([hidden])");
  assert.match(await page.textContent("#job-error"), /^job\.toml:2/);
  await page.fill("#panel-job textarea", "[process]\nwalls = 3\n");
  await page.waitForSelector("#job-error", { state: "hidden" });
  await page.focus("#panel-job textarea");
  await page.keyboard.press("Control+End");
  await page.keyboard.type("wals = 2");
  // What was typed until the first pause may be told before.
  await page.waitForFunction(() => /^job\.toml:3.*`wals`/.test(document.querySelector("#job-error:not([hidden])")?.textContent ?? ""));
  await close();
});

test("settings that are a number or a table are set as what they are", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "graded.toml");
  await page.click("#tab-job");
  const text = () => page.inputValue("#panel-job textarea");
  const search = async (words) => page.fill("#panel-job input[type=search]", words);
  await search("fill.density");
  assert.equal(await page.inputValue("#set-fill-density"), "0.4");
  assert.equal(await page.isVisible('[id="set-fill.density-min"]'), false, "there is no such table");
  await page.fill("#set-fill-density", "0,6");
  await page.press("#set-fill-density", "Tab");
  assert.equal(await text(), '[fill]\ndensity = 0.6\n');
  for (const [words, id, value, line] of [["walls", "set-process-walls", "3", "walls = 3"], ["angles", "set-fill-angles_deg", "[0, 60]", "angles_deg = [0, 60]"], ["angles", "set-fill-skin_angles_deg", "[15]", "skin_angles_deg = [15]"]]) {
    await search(words);
    await page.fill(`#${id}`, value);
    await page.press(`#${id}`, "Tab");
    assert.ok((await text()).includes(`${line}\n`), await text());
  }
  // A number that is none is said, and keeps the job from running.
  await search("walls");
  await page.fill("#set-process-walls", "three");
  await page.click("#panel-job button.main");
  assert.match(await page.textContent("#progress .error"), /walls is three and should be/);
  // A table that is stated has its rows, and the number gives way to it.
  await page.fill("#panel-job textarea", '[fill.density]\nmin = 0.1\nmax = 1\nby = "stress"\n');
  await search("fill.density");
  assert.equal(await page.isDisabled("#set-fill-density"), true);
  await page.fill('[id="set-fill.density-min"]', "0.3");
  await page.press('[id="set-fill.density-min"]', "Tab");
  assert.match(await text(), /\[fill\.density\]\nmin = 0\.3\n/);
  await close();
});

test("a job is saved under a new name, which never replaces a file", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "box.stl");
  await shaped(page);
  await page.click("#tab-job");
  const written = (name) => readFileSync(files.at(`grainpath-studio/${name}`), "utf8");
  const text = `${await page.inputValue("#panel-job textarea")}# first\n`;
  await page.fill("#panel-job textarea", text);
  await page.fill("#save-name", "beam");
  await page.click("#save-as");
  await page.waitForSelector("#progress:has-text('Saved as')");
  assert.equal(written("beam.toml"), text);
  assert.match(await page.textContent("#title"), /grainpath-studio\/beam\.toml$/);
  // What runs now is the file that was saved.
  const posted = [];
  page.on("request", (r) => { if (r.method() === "POST" && r.url().endsWith("/v1/jobs")) posted.push(r.postDataJSON()); });
  await page.click("#panel-job button.main");
  await shown(page);
  assert.deepEqual(posted.map((p) => [p.kind, p.file?.split("/").pop(), p.text]), [["plan", "beam.toml", undefined]]);
  // A name that is taken is an error, and its file stays.
  await page.click("#tab-job");
  await page.fill("#panel-job textarea", `${text}# second\n`);
  await page.fill("#save-name", "beam.toml");
  await page.press("#save-name", "Enter");
  await page.waitForSelector("#progress .error");
  assert.match(await page.textContent("#progress .error"), /beam\.toml is there already; choose another name$/);
  assert.equal(written("beam.toml"), text);
  await close();
});

for (const [width, height] of [[360, 740], [390, 844], [768, 1024], [1280, 720], [3840, 2160]]) {
  test(`nothing is cut off at ${width} x ${height}`, async () => {
    const { page, close } = await visit(browser, server.address, { viewport: { width, height } });
    await page.waitForSelector("#welcome h2");
    await choose(page, "squares.gcode");
    await shown(page);
    // The panel has its fields, and moves nothing any more.
    await page.waitForSelector("#break");
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling sideways");
    for (const id of ["open", "theme", "help", "tab-strength", "high", "low", "to", "play", "view"]) {
      const box = await page.locator(`#${id}`).boundingBox();
      assert.ok(box && box.x >= 0 && box.x + box.width <= width && box.width > 8 && box.height > 8, `${id}: ${JSON.stringify(box)}`);
    }
    // Nothing lies over the buttons of the head: a click at the middle and near each edge meets them.
    await page.evaluate(() => scrollTo(0, 0));
    for (const id of ["open", "runs", "theme", "help"]) {
      const met = await page.$eval(`#${id}`, (button) => { const { x, y, width, height } = button.getBoundingClientRect(); return [[0.5, 0.5], [0.5, 0.1], [0.5, 0.9]].map(([u, v]) => document.elementFromPoint(x + u * width, y + v * height)?.id ?? ""); });
      assert.deepEqual(met, [id, id, id]);
    }
    // Boxes over the view do not cover each other.
    const boxes = await Promise.all(["layers", "moves", "legend", "views"].map(async (id) => [id, await page.locator(`#${id}`).boundingBox()]));
    for (const [a, p] of boxes) for (const [b, q] of boxes) {
      if (a < b) assert.ok(p.x + p.width <= q.x || q.x + q.width <= p.x || p.y + p.height <= q.y || q.y + q.height <= p.y, `${a} covers ${b}`);
    }
    await close();
  });
}

for (const scheme of ["light", "dark"]) {
  test(`no serious finding of axe, ${scheme}`, async () => {
    const { page, close } = await visit(browser, server.address, { colorScheme: scheme });
    await page.waitForSelector("#welcome h2");
    await choose(page, "squares.gcode");
    await shown(page);
    await page.waitForSelector("#break");
    for (const tab of ["paths", "job", "strength"]) {
      await page.click(`#tab-${tab}`);
      await page.evaluate(axe);
      const found = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html} ${v.nodes[0].failureSummary}`)));
      assert.deepEqual(found, [], tab);
    }
    await close();
  });
}

for (const scheme of ["light", "dark"]) {
  test(`no serious finding of axe on the part, ${scheme}`, async () => {
    const { page, close } = await visit(browser, server.address, { colorScheme: scheme });
    await page.waitForSelector("#welcome h2");
    await choose(page, "box.stl");
    await shaped(page);
    await page.click("#tab-loads");
    await page.click("#all-faces summary");
    await page.click('button.face[data-face="0"]');
    await page.click("#hold-here");
    await page.click('button.face[data-face="1"]');
    await page.click("#load-here");
    for (const tab of ["shape", "loads", "job", "strength"]) {
      await page.click(`#tab-${tab}`);
      await page.evaluate(axe);
      const found = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html} ${v.nodes[0].failureSummary}`)));
      assert.deepEqual(found, [], tab);
    }
    await close();
  });
}

// Run in a page before its own scripts: a browser without WebGL.
function withoutWebGl() {
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return String(kind).startsWith("webgl") ? null : get.call(this, kind, ...more); };
}

/** Pixels of each colour of the picture that the server drew, most of them first. */
const drawn = (page) => page.$eval("#plain img", async (image) => {
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: image.naturalWidth, height: image.naturalHeight });
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  const counts = new Map();
  for (let k = 0; k < data.length; k += 4) { const c = (data[k] << 16) | (data[k + 1] << 8) | data[k + 2]; counts.set(c, (counts.get(c) ?? 0) + 1); }
  return [...counts.values()].sort((a, b) => b - a).slice(0, 20);
});

test("without WebGL 2 the numbers, faces and loads of a part are there", async () => {
  const { page, close } = await visit(browser, server.address, {}, withoutWebGl);
  await page.waitForSelector("#welcome h2");
  await choose(page, "box.stl");
  await page.waitForSelector("#size");
  assert.equal(await page.textContent("#size"), "30.00 × 12.00 × 3.00 mm");
  // Six faces have six colours on a dark ground.
  const faces = await drawn(page);
  assert.equal(faces.filter((n) => n > 1000).length >= 7, true, `${faces}`);
  await page.click("#tab-loads");
  await page.click("#all-faces summary");
  await page.click('button.face[data-face="0"]');
  await page.click("#hold-here");
  await page.click('button.face[data-face="1"]');
  await page.click("#load-here");
  await vector(page, "value-1", [0, 0, -5]);
  await page.click("#solve");
  await page.waitForFunction(() => /Von Mises/.test(document.querySelector("#plain figcaption").textContent), null, { timeout: 120_000 });
  assert.match(await page.getAttribute("#plain img", "src"), /stress\/0\/picture$/);
  assert.notDeepEqual(await drawn(page), faces);
  await page.click("#tab-job");
  assert.match(await page.inputValue("#panel-job textarea"), /\[\[guide\.fixture\]\]\non = \{ face = "f:[0-9a-f]+" \}\nfix = "xyz"/);
  await close();
});

test("without WebGL 2 a program is broken between two of its sides", async () => {
  const { page, close } = await visit(browser, server.address, {}, withoutWebGl);
  await page.waitForSelector("#welcome h2");
  await choose(page, "squares.gcode");
  await page.waitForFunction(() => /All 6 layers/.test(document.querySelector("#plain figcaption").textContent));
  const whole = await drawn(page);
  await page.click("#tab-paths");
  await page.focus("#high");
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() => /Layer 5 of 6/.test(document.querySelector("#plain figcaption").textContent));
  assert.notDeepEqual(await drawn(page), whole);
  await page.click("#tab-strength");
  await page.waitForSelector("#break");
  assert.ok(await page.isHidden("#hold-pick"), "nothing can be picked in a view that is not there");
  await page.click("#panel-strength details summary");
  const job = await page.textContent("#strength-job");
  const boxes = [...job.matchAll(/box_mm = (\[\[.*?\]\])/g)].map((found) => JSON.parse(found[1]));
  assert.equal(boxes.length, 2, job);
  // Both boxes have the depth that the panel states, and a margin of 0.05 mm on either side.
  const depth = await page.$eval("#depth", (input) => Number(input.value));
  for (const [low, high] of boxes) assert.ok(Math.abs(high[0] - low[0] - depth - 0.1) < 2e-3, job);
  assert.ok(boxes[1][0][0] > boxes[0][1][0], job);
  await close();
});

test("dark is dark, light is light, and the choice is kept", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  const brightness = async () => { const shot = await picture(page); const c = shot.at(640, 700); return (c[0] + c[1] + c[2]) / 3; };
  const light = await brightness();
  await page.click("#theme");
  const dark = await brightness();
  assert.ok(light > 200 && dark < 60, `${light} ${dark}`);
  await page.reload();
  await page.waitForSelector("#welcome h2");
  assert.ok((await brightness()) < 60);
  await close();
});

test("keys turn, move and zoom the view", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await choose(page, "squares.gcode");
  await shown(page);
  const at = () => page.evaluate(() => { const v = window.studio.viewer; return { eye: v.camera.position.toArray(), middle: v.controls.target.toArray() }; });
  const press = async (...keys) => { for (const key of keys) await page.keyboard.press(key); return at(); };
  const far = ({ eye, middle }) => Math.hypot(...eye.map((v, k) => v - middle[k]));
  const first = await at();
  const turned = await press("d", "d");
  assert.ok(Math.abs(far(turned) - far(first)) < 1e-6 * far(first) && Math.abs(turned.eye[2] - first.eye[2]) < 1e-6 * far(first));
  const angle = (p) => Math.atan2(p.eye[1] - p.middle[1], p.eye[0] - p.middle[0]);
  assert.ok(Math.abs(Math.cos(angle(turned) - angle(first) - Math.PI / 6) - 1) < 1e-6, "two steps of 15 degrees");
  assert.ok((await press("a", "a")).eye.every((v, k) => Math.abs(v - first.eye[k]) < 1e-6 * far(first)), "and back");
  assert.ok((await press("w")).eye[2] > first.eye[2]);
  // However often the key is pressed, the view ends above the middle and not on its head.
  const top = await press(...Array(12).fill("w"));
  assert.ok(top.eye[2] - top.middle[2] > 0.999 * far(top));
  await press("s", "s");
  const near = await press("+");
  assert.ok(Math.abs(far(near) / far(top) - 0.8) < 1e-3);
  const moved = await press("Shift+D");
  assert.ok(Math.hypot(...moved.middle.map((v, k) => v - near.middle[k])) > 0.01 * far(near));
  await close();
});

test("help lists the keys and closes by escape", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  await page.keyboard.press("?");
  assert.match(await page.textContent("#keys"), /look from the top/);
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#keys"), false);
  await close();
});

test("another page cannot read the studio", async () => {
  const { page, close } = await visit(browser, server.address);
  await page.waitForSelector("#welcome h2");
  const origin = new URL(server.address).origin.replace("127.0.0.1", "localhost");
  // The cookie is for 127.0.0.1; from localhost the same server is another origin without it.
  const context = page.context();
  const other = await context.newPage();
  const answer = await other.goto(`${origin}/v1/state`);
  assert.equal(answer.status(), 401);
  await close();
});

test("Ctrl-C ends the studio within a second", async () => {
  const own = await studio(files.dir);
  const { page, close } = await visit(browser, own.address);
  await page.waitForSelector("#welcome h2");
  const { code, ms } = await own.end();
  assert.equal(code, 0);
  assert.ok(ms < 1000, `${ms} ms`);
  await close();
});
