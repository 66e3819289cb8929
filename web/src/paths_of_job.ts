// The files that a job names, in full: what runs is saved in another folder than the job.

import { type Value, entries, renew, value } from "./toml";

/** Whether a path begins at the root of a disk. */
const isWhole = (path: string) => /^([/\\]|[A-Za-z]:)/.test(path);

/** Keys whose value is a file, or a list of files. Source: `claim_inputs` and `shape_of` in `crates/grainpath-cli/src/inputs.rs`. */
const FILES = [
  "shape.mesh", "shape.outline", "shape.ct", "shape.ct.path", "shape.ct.truth", "shape.photo.files", "guide.import", "guide.deck", "guide.volume",
  "guide.volume.path", "guide.field", "guide.field.path", "guide.image.files", "fill.density.file", "region.on.mesh",
];
/** Keys whose value is the name of a profile, or a file that ends in `.toml`. */
const PROFILES = ["printer.profile", "material.profile", "process.profile", "fibre.material"];

/** What runs is saved elsewhere, so files that a job names beside itself, in `folder`, are named in full. */
export function absolute(text: string, folder: string): string {
  const whole = (name: Value) => (typeof name === "string" && name && !isWhole(name) ? `${folder}/${name}` : name);
  // From the last one on, so that the places of those before stay.
  for (const entry of [...entries(text)].reverse()) {
    const key = entry.path.join(".");
    const name = value(text.slice(entry.from, entry.to));
    const isProfile = PROFILES.includes(key) && typeof name === "string" && name.endsWith(".toml");
    if (name === undefined || !(isProfile || FILES.includes(key))) continue;
    const named = Array.isArray(name) ? name.map(whole) : whole(name);
    if (JSON.stringify(named) !== JSON.stringify(name)) text = renew(text, entry, JSON.stringify(named));
  }
  return text;
}
