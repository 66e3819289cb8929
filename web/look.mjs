// Looks at a page as a reader sees it: writes a picture of it, and with --axe lists what readers with impairments would
// stumble over. Usage: node look.mjs PAGE.html PICTURE.png [WIDTH [HEIGHT]] [--axe] [--part SELECTOR]

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const words = process.argv.slice(2);
const axe = words.includes("--axe");
const part = words.includes("--part") ? words[words.indexOf("--part") + 1] : null;
const plain = words.filter((w, i) => !w.startsWith("--") && words[i - 1] !== "--part");
const [page_file, picture, width = "1200", height = "900"] = plain;
if (!picture) throw new Error("usage: node look.mjs PAGE.html PICTURE.png [WIDTH [HEIGHT]] [--axe] [--part SELECTOR]");
const browser = await chromium.launch({ executablePath: process.env.BROWSER ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
try {
  const page = await browser.newPage({ viewport: { width: Number(width), height: Number(height) } });
  const wrong = [];
  page.on("pageerror", (e) => wrong.push(String(e)));
  page.on("console", (m) => { if (m.type() === "error") wrong.push(m.text()); });
  page.on("request", (r) => { if (!/^(file|data|blob):/.test(r.url())) wrong.push(`asks the network for ${r.url()}`); });
  await page.goto(pathToFileURL(resolve(page_file)).href);
  await page.waitForTimeout(400);
  await (part ? page.locator(part) : page).screenshot({ path: picture, ...(part ? {} : { fullPage: height === "0" }) });
  if (axe) {
    await page.addScriptTag({ content: readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8") });
    const { violations } = await page.evaluate(() => window.axe.run());
    for (const v of violations) {
      const line = `${v.impact}: ${v.id}: ${v.help} (${v.nodes.length}): ${v.nodes[0].html.slice(0, 140)}`;
      if (["serious", "critical"].includes(v.impact)) wrong.push(line); else console.log(line);
    }
  }
  for (const line of wrong) console.error(`${page_file}: ${line}`);
  process.exitCode = wrong.length > 0 ? 1 : 0;
} finally {
  await browser.close();
}
