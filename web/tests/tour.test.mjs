// The tour of the first visit.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { folder, launch, settle, studio, visit } from "./bench.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const SHOTS = process.env.SHOTS;

let files, server, browser;
before(async () => { files = folder(); server = await studio(files.dir); browser = await launch(); });
after(async () => { await browser?.close(); await server?.end(); files?.remove(); });

const lit = (page) => page.$$eval(".lit", (all) => all.map((e) => e.id));
const outline = (page, id) => page.$eval(`#${id}`, (e) => getComputedStyle(e).outlineStyle);

test("the first visit is shown around in five steps, by keyboard, and the second is not", async () => {
  const { page, wrong, close } = await visit(browser, server.address, { isFirst: true });
  await page.waitForSelector("#tour-next");
  assert.deepEqual(await lit(page), ["open"]);
  assert.equal(await outline(page, "open"), "solid");
  assert.equal(await outline(page, "tab-job"), "none", "what is not told of is not lit");
  assert.equal(await page.$("#tour-back"), null);
  if (SHOTS) { await settle(page); await page.screenshot({ path: `${SHOTS}/tour.png` }); }
  const seen = [];
  for (let k = 1; k <= 5; k++) {
    assert.match(await page.textContent("#tour-words"), new RegExp(`^${k} of 5 · `));
    seen.push(...(await lit(page)));
    await page.focus("#tour-next");
    await page.keyboard.press("Enter");
  }
  assert.deepEqual(seen, ["open", "tab-loads", "tab-job", "tab-paths", "tab-strength"]);
  assert.equal(await page.isVisible("#tour"), false);
  assert.deepEqual(await lit(page), []);
  await page.reload();
  await page.waitForSelector("#welcome h2");
  await settle(page);
  assert.equal(await page.isVisible("#tour"), false);
  // It can be asked for again; Escape ends it.
  await page.keyboard.press("?");
  await page.click("#show-tour");
  assert.equal(await page.isVisible("#tour"), true);
  await page.keyboard.press("Enter");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  assert.match(await page.textContent("#tour-words"), /^1 of 5/, "back");
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#tour"), false);
  assert.deepEqual(wrong, []);
  await close();
});

for (const [colorScheme, width] of [["light", 1280], ["dark", 1280], ["light", 360]]) {
  test(`the tour has no serious finding of axe and is whole, ${colorScheme}, ${width} px`, async () => {
    const { page, close } = await visit(browser, server.address, { isFirst: true, colorScheme, viewport: { width, height: 740 } });
    await page.waitForSelector("#tour-next");
    for (let k = 0; k < 5; k++) {
      await page.evaluate(axe);
      const found = await page.evaluate(() => window.axe.run().then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes[0].html} ${v.nodes[0].failureSummary}`)));
      assert.deepEqual(found, [], `step ${k + 1}`);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no scrolling sideways");
      await page.click("#tour-next");
    }
    await close();
  });
}

test("skipped, it does not come back", async () => {
  const { page, close } = await visit(browser, server.address, { isFirst: true });
  await page.click("#tour-skip");
  await page.reload();
  await page.waitForSelector("#welcome h2");
  await settle(page);
  assert.equal(await page.isVisible("#tour"), false);
  await close();
});
