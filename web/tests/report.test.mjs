// The report page of a run: its slider, its fold, and what it asks of the network.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { boxStl, command, folder, launch } from "./bench.mjs";

const job = `[shape]
mesh = "bar.stl"
[fill]
pattern = "stripes"
density = 1.0
[guide]
kind = "stress"
[[guide.fixture]]
on = { plane = { point_mm = [0, 0, 0], normal = [1, 0, 0] } }
fix = "xyz"
[[guide.load]]
on = { plane = { point_mm = [40, 0, 0], normal = [1, 0, 0] } }
force_n = [100, 0, 0]
[output]
gcode = "bar.gcode"
report = "report.html"
`;

let files, browser, page;
const wrong = [];
before(async () => {
  files = folder({ "bar.stl": boxStl([40, 12, 2]), "job.toml": job });
  command(files.dir, "run", "job.toml");
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  page.on("pageerror", (e) => wrong.push(String(e)));
  page.on("request", (r) => { if (!/^(file|data|blob):/.test(r.url())) wrong.push(r.url()); });
  await page.goto(pathToFileURL(files.at("report.html")).href);
  await page.waitForSelector("[data-is=tools]:not([hidden])");
});
after(async () => { await browser?.close(); files?.remove(); });

/** Numbers of pixels of the canvas that are no background. */
const drawn = () => page.evaluate(async () => {
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const canvas = document.querySelector("#layers canvas");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let n = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i] + data[i + 1] + data[i + 2] > 140) n++;
  return n / (data.length / 4);
});
const text = (name) => page.textContent(`[data-is=${name}]`);

test("the slider shows every layer, and part of a layer", async () => {
  // 2 mm in layers of 0.2 mm.
  assert.equal(await page.getAttribute("[data-is=layer]", "max"), "9");
  for (const k of ["0", "9"]) {
    await page.fill("[data-is=layer]", k);
    await drawn();
    assert.match(await text("layer-told"), new RegExp(`^layer ${Number(k) + 1} of 10, ${(0.2 * (Number(k) + 1)).toFixed(2)} mm$`));
  }
  const whole = await drawn();
  await page.fill("[data-is=beads]", "300");
  const third = await drawn();
  assert.match(await text("beads-told"), /^the first \d+ of \d+ beads$/);
  await page.fill("[data-is=beads]", "0");
  const none = await drawn();
  assert.ok(whole > 0.3 && third < 0.8 * whole && third > 0.02 && none < 0.01, `${whole} ${third} ${none}`);
});

test("the slider is moved by the keyboard, and the view by the buttons", async () => {
  await page.fill("[data-is=layer]", "4");
  await page.focus("[data-is=layer]");
  await page.keyboard.press("ArrowRight");
  await drawn();
  assert.match(await text("layer-told"), /^layer 6 of 10/);
  const whole = await drawn();
  await page.click("[data-is=out]");
  await page.click("[data-is=out]");
  const far = await drawn();
  assert.ok(far < 0.6 * whole, `${far} ${whole}`);
  await page.click("[data-is=whole]");
  assert.ok(Math.abs(await drawn() - whole) < 0.01);
});

test("a button leads to the peak of the stress", async () => {
  await page.fill("[data-is=layer]", "9");
  const peak = JSON.parse(command(files.dir, "run", "job.toml", "--json")).stress.peak_at_mm;
  await page.click('[data-mark="0"]');
  await drawn();
  assert.match(await text("layer-told"), new RegExp(`^layer ${Math.max(1, Math.ceil(peak[2] / 0.2 - 1e-6))} of 10`));
});

test("changed settings come first and the rest is folded", async () => {
  const changed = await page.textContent("#changed");
  assert.match(changed, /fill\.pattern.*stripes/);
  assert.ok(!changed.includes("process.layer_height_mm"));
  assert.equal(await page.isVisible("#usual table"), false);
  await page.click("#usual summary");
  assert.match(await page.textContent("#usual table"), /process\.layer_height_mm/);
});

test("nothing is asked of the network, and axe finds nothing serious, light and dark", async () => {
  const source = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await page.addScriptTag({ content: source });
    const { violations } = await page.evaluate(() => window.axe.run());
    assert.deepEqual(violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html}`), []);
  }
  assert.deepEqual(wrong, []);
});
