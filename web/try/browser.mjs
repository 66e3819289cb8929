// Tries the page in a browser, opened as a file: plans examples and compares what is downloaded, then a job with a mistake, a
// file of one's own, and *Stop*; asks axe for what readers with impairments would stumble over, and sees that nothing asks the
// network. Usage: node browser.mjs PAGE.html WANTED.json PICTURE.png, where WANTED is {title: SHA-256} of examples to plan.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [pagePath, wantedPath, picture] = process.argv.slice(2);
const wanted = JSON.parse(readFileSync(wantedPath, "utf8"));
const browser = await chromium.launch({ executablePath: process.env.BROWSER ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
try {
  // The page allows itself no script but its own; axe is one.
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, bypassCSP: false });
  const page = await context.newPage();
  const wrong = [];
  page.on("pageerror", (e) => wrong.push(`${e}`));
  page.on("console", (m) => { if (m.type() === "error") wrong.push(m.text()); });
  page.on("request", (r) => { if (!/^(file|data|blob):/.test(r.url())) wrong.push(`asks the network for ${r.url()}`); });
  await page.goto(pathToFileURL(resolve(pagePath)).href);
  const told = () => page.textContent("#told");
  const told_matches = (words) => page.waitForFunction((words) => new RegExp(words).test(document.querySelector("#told").textContent), words, { timeout: 600_000 });
  await told_matches("Ready");
  const plan = async (ends) => { await page.click("#plan"); await told_matches(ends); };

  for (const [title, sha256] of Object.entries(wanted)) {
    await page.selectOption("#example", { label: title });
    await plan("^Planned in");
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    const got = createHash("sha256").update(readFileSync(await download.path())).digest("hex");
    assert.equal(got, sha256, title);
    assert.match(await page.textContent("#summary"), /layers to/);
    assert.ok(await page.locator("#legend li").count() >= 1, "colours are named");
    console.log(`in the browser: ${title}: ${await told()} The same bytes.`);
  }
  await page.selectOption("#example", { index: 0 });
  await plan("^Planned in");
  await page.screenshot({ path: picture });

  // The middle layer shows more than its ground.
  const colours = await page.evaluate(() => {
    const canvas = document.querySelector("#picture");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4 * 97) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return seen.size;
  });
  assert.ok(colours > 20, `${colours} colours in the picture`);

  const job = await page.inputValue("#job");
  await page.fill("#job", job.replace("density = 1.0", "densty = 1.0"));
  await plan("densty");
  assert.match(await told(), /density/, "the nearest key is named");
  await page.fill("#job", job);

  // A file of one's own: a cube of 10 mm with thick layers.
  const triangles = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]];
  const corners = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [0, 0, 10], [10, 0, 10], [10, 10, 10], [0, 10, 10]];
  const off = ["OFF", "8 12 0", ...corners.map((c) => c.join(" ")), ...triangles.map((t) => `3 ${t.join(" ")}`), ""].join("\n");
  await page.setInputFiles("#files", { name: "cube.off", mimeType: "model/off", buffer: Buffer.from(off) });
  await plan("^Planned in");
  assert.match(await page.textContent("#summary"), /50 layers to 10 mm/);
  await page.setInputFiles("#files", { name: "bad.stl", mimeType: "model/stl", buffer: Buffer.from("Dear Sir or Madam") });
  await plan("bad.stl");

  // A run is stopped, and the next one works.
  await page.selectOption("#example", { index: 0 });
  await page.click("#plan");
  await page.click("#stop");
  await told_matches("Ready");
  await plan("^Planned in");
  assert.deepEqual(wrong, []);

  const bare = await browser.newContext({ bypassCSP: true });
  const looked = await bare.newPage();
  await looked.goto(pathToFileURL(resolve(pagePath)).href);
  await looked.evaluate(readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"));
  const found = await looked.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html}`)));
  assert.deepEqual(found, []);
  console.log("in the browser: no serious finding of axe, no request, errors told, files of one's own planned, a run stopped");
} finally {
  await browser.close();
}
