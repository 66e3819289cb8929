// Bundles the page into the folder given, or into crates/grainpath-studio/dist, and the viewer of notebooks into the Python
// package. `cargo xtask page` calls it. Where the page goes to another folder, to be compared, the viewer is compared here.
import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { dirname, join, resolve } from "node:path";

const here = dirname(fileURLToPath(import.meta.url));
const dist = join(here, "../crates/grainpath-studio/dist");
const out = resolve(process.argv[2] ?? dist);
await mkdir(out, { recursive: true });

const options = { absWorkingDir: here, bundle: true, minify: true, format: "esm", target: "es2022", legalComments: "none", charset: "utf8", metafile: true };
// What the page and its worker both use is one file: the browser loads it once.
const result = await build({ ...options, entryPoints: { app: "src/main.ts", worker: "src/worker.ts" }, splitting: true, chunkNames: "shared", outdir: out });
await build({ absWorkingDir: here, entryPoints: { app: "src/app.css" }, outdir: out, bundle: true, minify: true, charset: "utf8" });
for (const file of ["index.html", "icon.svg"]) await copyFile(join(here, "src", file), join(out, file));

/** The licence of every package in a bundle, which goes with it. */
async function licences(of, metafile) {
  const packages = new Set();
  for (const input of Object.keys(metafile.inputs)) {
    const found = input.match(/node_modules\/((?:@[^/]+\/)?[^/]+)\//);
    if (found) packages.add(found[1]);
  }
  let licences = `${of} holds code of these packages.\n`;
  for (const name of [...packages].sort()) {
    const folder = join(here, "node_modules", name);
    const { version, license } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
    if (!["MIT", "ISC", "BSD-2-Clause", "BSD-3-Clause", "Apache-2.0", "0BSD"].includes(license)) {
      throw new Error(`${name} ${version} has the licence ${license}`);
    }
    const text = await readFile(join(folder, "LICENSE"), "utf8");
    licences += `\n${"=".repeat(78)}\n${name} ${version} (${license})\n\n${text.trim()}\n`;
  }
  return licences;
}
await writeFile(join(out, "licences.txt"), await licences("The page of the grainpath studio", result.metafile));

// Styles are text of the viewer. Its bundle travels in the notebooks that keep it, and so do the licences in its head.
const styles = await build({ absWorkingDir: here, entryPoints: ["src/notebook.css"], bundle: true, minify: true, charset: "utf8", write: false });
const css = { name: "css", setup: (on) => on.onLoad({ filter: /\/notebook\.css$/ }, () => ({ contents: styles.outputFiles[0].text, loader: "text" })) };
const widget = await build({ ...options, entryPoints: ["src/notebook.ts"], plugins: [css], write: false });
const viewer = `/*\n${await licences("The viewer of grainpath", widget.metafile)}*/\n${widget.outputFiles[0].text}`;
const file = join(here, "../crates/grainpath-py/python/grainpath/viewer.js");
if (out === resolve(dist)) await writeFile(file, viewer);
else if (viewer !== (await readFile(file, "utf8"))) throw new Error(`${file} is not what web/ makes; \`cargo xtask page --write\` renews it`);
