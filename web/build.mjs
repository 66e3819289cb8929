// Bundles the page into the folder given, or into crates/grainpath-studio/dist. `cargo xtask page` calls it.
import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { dirname, join } from "node:path";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "../crates/grainpath-studio/dist");
await mkdir(out, { recursive: true });

const result = await build({
  absWorkingDir: here,
  entryPoints: { app: "src/main.ts", worker: "src/worker.ts" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
  charset: "utf8",
  metafile: true,
});
await build({ absWorkingDir: here, entryPoints: { app: "src/app.css" }, outdir: out, minify: true, charset: "utf8" });
for (const file of ["index.html", "icon.svg"]) await copyFile(join(here, "src", file), join(out, file));

// The licence of every package in the bundle goes with it.
const packages = new Set();
for (const input of Object.keys(result.metafile.inputs)) {
  const found = input.match(/node_modules\/((?:@[^/]+\/)?[^/]+)\//);
  if (found) packages.add(found[1]);
}
let licences = "The page of the grainpath studio holds code of these packages.\n";
for (const name of [...packages].sort()) {
  const folder = join(here, "node_modules", name);
  const { version, license } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
  if (!["MIT", "ISC", "BSD-2-Clause", "BSD-3-Clause", "Apache-2.0", "0BSD"].includes(license)) {
    throw new Error(`${name} ${version} has the licence ${license}`);
  }
  const text = await readFile(join(folder, "LICENSE"), "utf8");
  licences += `\n${"=".repeat(78)}\n${name} ${version} (${license})\n\n${text.trim()}\n`;
}
await writeFile(join(out, "licences.txt"), licences);
