// Plans jobs with the module in Node and prints a line of JSON for each: its name, the SHA-256 of its G-code or the error,
// and the seconds. Usage: node compare.mjs MODULE.wasm JOBS.json, where JOBS is [{name, job, sets}] with paths of job files.

import { createHash } from "node:crypto";
import { readFileSync, readdirSync } from "node:fs";
import { basename, dirname, join, relative } from "node:path";

import { start } from "./module.js";

const [modulePath, jobsPath] = process.argv.slice(2);
const compiled = await WebAssembly.compile(readFileSync(modulePath));

/** All files below the folder of a job that the job or its settings name, by their path from there. */
function filesOf(job, text) {
  const folder = dirname(job);
  const named = readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile() && text.includes(basename(entry.name)))
    .map((entry) => join(entry.parentPath ?? entry.path, entry.name));
  return Object.fromEntries(named.map((path) => [relative(folder, path), readFileSync(path)]));
}

for (const { name, job, sets } of JSON.parse(readFileSync(jobsPath, "utf8"))) {
  const from = performance.now();
  const row = { name };
  try {
    const text = readFileSync(job, "utf8");
    // A new module for each job: memory of the last one is given back, and a trap ends one job alone.
    const plan = await start(compiled, () => {});
    const { gcode } = plan(text, filesOf(job, [text, ...sets].join("\n")), sets);
    row.sha256 = createHash("sha256").update(gcode).digest("hex");
    row.bytes = gcode.length;
  } catch (problem) {
    row.problem = problem.message;
  }
  row.seconds = (performance.now() - from) / 1000;
  console.log(JSON.stringify(row));
}
