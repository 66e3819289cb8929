// Asks axe, for every page of the built book, what readers with impairments would stumble over, in the light and in a dark
// theme, and sees that no page asks the network. Usage: node book.mjs FOLDER

import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const folder = resolve(process.argv[2]);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
// 404.html names its scripts from the root of a site, which a file does not have; planner.html has a test of its own.
const skipped = ["404.html", "planner.html"];
const pages = readdirSync(folder, { recursive: true }).filter((f) => f.endsWith(".html") && !skipped.includes(f)).sort();
if (pages.length < 20) throw new Error(`${folder} holds ${pages.length} pages: is it the book?`);
const browser = await chromium.launch({ executablePath: process.env.BROWSER ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
const found = new Map();
try {
  for (const theme of ["light", "navy"]) {
    const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
    await page.addInitScript((theme) => localStorage.setItem("mdbook-theme", theme), theme);
    page.on("request", (r) => { if (!/^(file|data|blob):/.test(r.url())) found.set(`network: ${r.url()}`, theme); });
    for (const name of pages) {
      await page.goto(pathToFileURL(join(folder, name)).href, { waitUntil: "load" });
      await page.evaluate(axe);
      const violations = await page.evaluate(() => window.axe.run().then((r) => r.violations));
      for (const v of violations.filter((v) => ["serious", "critical"].includes(v.impact))) {
        const node = v.nodes[0];
        found.set(`${v.id}: ${node.html.slice(0, 160)}`, `${name}, ${theme}: ${node.failureSummary}`);
      }
    }
    await page.close();
  }
} finally {
  await browser.close();
}
for (const [what, where] of found) console.log(`${what}\n    ${where}`);
console.log(`${pages.length} pages in two themes, ${found.size} kinds of serious findings`);
process.exitCode = found.size === 0 ? 0 : 1;
