// Values of a job's text are found and changed, and the rest of the text stays.

import assert from "node:assert/strict";
import { build } from "esbuild";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

/** The modules as one, as in the page. */
const bundle = async (...files) => {
  const contents = files.map((file) => `export * from "./${file}";`).join("\n");
  const made = await build({ stdin: { contents, resolveDir: fileURLToPath(new URL("../src", import.meta.url)), loader: "ts" }, bundle: true, write: false, format: "esm", platform: "neutral" });
  return import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].text).toString("base64")}`);
};
const { absolute, blocks, change, entries, get, insert, remove, set, value } = await bundle("toml.ts", "paths_of_job.ts");
const { commaWord, plain, rowsOf, state, typed } = await bundle("settings.ts");
const { decimal } = await bundle("dom.ts");

const TEXT = `# a bracket
[shape]
mesh = "a # b.stl"   # the part
rotate_deg = [
  0, # about x
  90, 0,
]

[guide]
kind = "stress"
[[guide.load]]
on = { box_mm = [[0, 0, 0], [1, 1, 1]] }
force_n = [1, 0, 0]

[fill]
density = 0.3
"angles_deg" = [0, 90]
`;

test("values are found between comments, lists and strings", () => {
  assert.equal(get(TEXT, "shape", "mesh"), '"a # b.stl"');
  assert.equal(get(TEXT, "fill", "density"), "0.3");
  assert.equal(get(TEXT, "fill", "angles_deg"), "[0, 90]");
  assert.match(get(TEXT, "shape", "rotate_deg"), /^\[\n {2}0, # about x\n {2}90, 0,\n\]$/);
  assert.equal(get(TEXT, "guide", "force_n"), null);
  assert.equal(get(TEXT, "guide.load", "force_n"), null, "rows of a list are left to the text");
  assert.equal(entries(TEXT).length, 8, "with the key in braces");
});

test("a changed value leaves every other character", () => {
  const changed = set(TEXT, "fill", "density", "0.5");
  assert.equal(changed, TEXT.replace("density = 0.3", "density = 0.5"));
  assert.equal(set(TEXT, "shape", "mesh", '"c.stl"'), TEXT.replace('"a # b.stl"', '"c.stl"'));
  assert.equal(set(set(TEXT, "fill", "density", "0.5"), "fill", "density", "0.3"), TEXT);
});

test("a new value goes into its table, a new table to the end", () => {
  assert.equal(set(TEXT, "guide", "follow", '"tension"'), TEXT.replace('kind = "stress"\n', 'kind = "stress"\nfollow = "tension"\n'));
  assert.ok(set(TEXT, "process", "walls", "3").endsWith("\n[process]\nwalls = 3\n"));
  assert.equal(set("", "process", "walls", "3"), "[process]\nwalls = 3\n");
  assert.equal(set("[process]", "process", "walls", "3"), "[process]\nwalls = 3\n");
});

test("a line is taken away whole", () => {
  assert.equal(set(TEXT, "fill", "density", null), TEXT.replace("density = 0.3\n", ""));
  assert.equal(set(TEXT, "fill", "pattern", null), TEXT);
});

test("dotted tables and keys", () => {
  const text = "shape.ct.path = \"scan\"\n[shape.photo]\nfiles = [\"a.jpg\"]\n";
  assert.equal(get(text, "shape.ct", "path"), '"scan"');
  assert.equal(get(text, "shape.photo", "files"), '["a.jpg"]');
});

test("keys in quotes, in braces and with points are those of their tables", () => {
  const braces = 'shape = { mesh = "bar.stl" }\nmaterial = { "profile" = "petg" } # mine\nfill = { density = 0.4 }\nprocess = {}\n';
  assert.equal(get(braces, "shape", "mesh"), '"bar.stl"');
  assert.equal(get(braces, "material", "profile"), '"petg"');
  assert.equal(set(braces, "material", "profile", '"pla"'), braces.replace("petg", "pla"));
  assert.equal(set(braces, "fill", "pattern", '"grid"'), braces.replace("0.4", '0.4, pattern = "grid"'));
  assert.equal(set(braces, "process", "walls", "3"), braces.replace("{}", "{ walls = 3 }"));
  assert.equal(set(braces, "shape.photo", "thickness_mm", "3"), braces.replace('stl"', 'stl", photo.thickness_mm = 3'));
  const two = "fill = { density = 0.4, pattern = 'grid' }\n";
  assert.equal(set(two, "fill", "density", null), "fill = { pattern = 'grid' }\n");
  assert.equal(set(two, "fill", "pattern", null), "fill = { density = 0.4 }\n");
  // A deeper table in braces.
  const deep = 'shape = { ct = { path = "scan" }, scale = 2 }\n';
  assert.equal(get(deep, "shape.ct", "path"), '"scan"');
  assert.equal(set(deep, "shape.ct", "slice_mm", "0.5"), deep.replace('"scan"', '"scan", slice_mm = 0.5'));
  // Dotted keys have no header, and a table of one cannot have another.
  const dotted = 'fill.pattern = "grid"\n[shape]\nct.path = "scan" # mine\nscale = 2\n';
  assert.equal(get(dotted, "fill", "pattern"), '"grid"');
  assert.equal(set(dotted, "fill", "density", "0.3"), dotted.replace('"grid"\n', '"grid"\nfill.density = 0.3\n'));
  assert.equal(set(dotted, "shape.ct", "slice_mm", "0.5"), dotted.replace("# mine\n", "# mine\nct.slice_mm = 0.5\n"));
  // Quoted names and a mark of the encoding.
  const quoted = '\ufeff["shape"] # the part\n"mesh" = "a.stl"\n[ "fill" . \'x\' ]\ny = 1\n["a.b"]\nc = 1\n';
  assert.equal(get(quoted, "shape", "mesh"), '"a.stl"');
  assert.equal(set(quoted, "shape", "scale", "2"), quoted.replace('"a.stl"\n', '"a.stl"\nscale = 2\n'));
  assert.equal(get(quoted, "fill.x", "y"), "1");
  assert.equal(get(quoted, "a.b", "c"), null, "a point in quotes parts no names");
  // What is no table takes no key.
  assert.equal(set('material = "petg"\n', "material", "profile", '"pla"'), 'material = "petg"\n');
  assert.equal(set("[[fill]]\ndensity = 1\n", "process", "walls", "3"), "[[fill]]\ndensity = 1\n\n[process]\nwalls = 3\n");
});

test("lines within texts and lines that are being typed are no headers and no keys", () => {
  const text = "[printer]\nstart_gcode = \'\'\'\nG28\n[fill]\nwalls = 9\n\'\'\'\nend_gcode = \"\"\"a \\\"\"\"\n[shape]\n\"\"\"\"\n[process]\nwalls = 3\n";
  assert.deepEqual(entries(text).map((e) => `${e.table}.${e.key}`), ["printer.start_gcode", "printer.end_gcode", "process.walls"]);
  assert.equal(set(text, "fill", "pattern", '"stripes"'), `${text}\n[fill]\npattern = "stripes"\n`);
  assert.equal(value(get(text, "printer", "end_gcode")), 'a """\n[shape]\n"');
  assert.deepEqual(entries("[fill\ndensity = 1\n[shape]\nmesh =\nunit\nscale = 2\n").map((e) => `${e.table}.${e.key}`), ['"[".density', "shape.mesh", "shape.scale"]);
});

test("comments within a list stay where its values change", () => {
  assert.equal(set(TEXT, "shape", "rotate_deg", "[0, 90, 37.5]"), TEXT.replace("  90, 0,", "  90, 37.5,"));
  assert.equal(get(set(TEXT, "shape", "rotate_deg", "[0, 90]"), "shape", "rotate_deg"), "[0, 90]");
});

test("a list does not take a comma for what may be one of decimals", () => {
  const angles = { type: "array", items: { type: "number" } };
  assert.deepEqual(["[22,5]", "[0, 22,5]", "[22, 5]", "[22.5]", "[0 ,90]"].map((t) => typed(angles, t)), [null, null, "[22, 5]", "[22.5]", "[0, 90]"]);
  assert.equal(commaWord(angles, "[22,5]"), "22,5 may be 22.5 or two numbers, 22, 5: write a point or a space");
  assert.equal(typed({ type: "array", items: { type: "integer" } }, "[22,5]"), "[22, 5]");
});

test("what is typed becomes TOML or is refused", () => {
  const number = { type: "number", minimum: 0, maximum: 1 };
  assert.deepEqual(["0.5", ".5", "1.", "2", "a", ""].map((t) => typed(number, t)), ["0.5", "0.5", "1.0", null, null, null]);
  assert.deepEqual(["3", "3.5"].map((t) => typed({ type: "integer" }, t)), ["3", null]);
  assert.deepEqual(["grid", "gird"].map((t) => typed({ type: "string", enum: ["grid"] }, t)), ['"grid"', null]);
  assert.equal(typed({ type: "array", items: { type: "number" } }, "[0, 90]"), "[0, 90]");
  assert.equal(typed({ type: "string" }, 'a "b"'), '"a \\"b\\""');
  const table = '{ min = 0.1, max = 1, by = "stress" }';
  assert.deepEqual([table, "{ min"].map((t) => typed({ type: ["number", "object"] }, t)), [table, null]);
  assert.equal(typed({ type: ["number", "string"] }, "none"), '"none"');
});

test("values are shown as they are meant", () => {
  assert.deepEqual(['"a"', "'C:\\\\a'", '"""\nG28\nG1"""', "0.5", '"\\e"'].map(plain), ["a", "C:\\\\a", "G28\nG1", "0.5", '"\\e"']);
});

test("values are read as they are written", () => {
  assert.deepEqual(value('{ face = "f:9c1e" }'), { face: "f:9c1e" });
  assert.deepEqual(value("[[0, -1.5, 2e3], # a corner\n [1_000, +2, .5]]"), [[0, -1.5, 2000], [1000, 2, 0.5]]);
  assert.deepEqual(value("{ plane = { point_mm = [0, 0, 1], normal = [0, 0, 1] } }"), { plane: { point_mm: [0, 0, 1], normal: [0, 0, 1] } });
  assert.equal(value("'a\\b'"), "a\\b");
  assert.equal(value('"a\\"b"'), 'a"b');
  assert.equal(value("true"), true);
  assert.deepEqual(value('{ "face" = "f:1", side.point_mm = [0], side.\'normal\' = [1] }'), { face: "f:1", side: { point_mm: [0], normal: [1] } });
  assert.equal(value('"tab\tand \\u00e9 \\U0001F600"'), "tab\tand é 😀");
  assert.deepEqual(value("[0x1f, -inf, 1_0.5]"), [31, -Infinity, 10.5]);
  for (const wrong of ["", "[1, 2", "{ a 1 }", "1 2", '"open', "nonsense", "[1 2]", "{ a = 1, a = 2 }", "{ a = 1, a.b = 2 }", '"\\q"', "1979-05-27", "[".repeat(1e5)]) assert.equal(value(wrong), undefined, wrong);
});

const LOADS = `[shape]
mesh = "a.stl"

[[guide.fixture]]
on = { face = "f:1" }  # the wall
fix = "xyz"

[[guide.load]]
on = { box_mm = [
  [0, 0, 0], # a corner
  [1, 1, 1]] }
force_n = [1, 0, 0]
# about the fill
[fill]
density = 0.3
`;

test("tables of a list are found with their lines", () => {
  const [fixture, load, ...none] = blocks(LOADS, "guide.fixture", "guide.load");
  assert.deepEqual(none, []);
  assert.equal(LOADS.slice(fixture.from, fixture.to), '[[guide.fixture]]\non = { face = "f:1" }  # the wall\nfix = "xyz"\n');
  assert.ok(LOADS.slice(load.from, load.to).endsWith("force_n = [1, 0, 0]\n"));
  assert.deepEqual([...load.keys.keys()], ["on", "force_n"]);
  assert.ok(fixture.isPlain && load.isPlain);
  // A table below one of the list is no key of it.
  const [deep] = blocks("[[guide.load]]\nforce_n = [1, 0, 0]\n[guide.load.on]\nface = 'f:1'\n", "guide.load");
  assert.equal(deep.isPlain, false);
  assert.deepEqual([...deep.keys.keys()], ["force_n"]);
});

test("tables of a list are read with dotted keys and tables below them", () => {
  const text = `[[guide.load]]\non.face = "f:1" # wall\non.side.point_mm = [0, 0, 1]\n"force_n" = [1, 0, 0]\n\n[[guide.load]]\nforce_n = [1, 0, 0]\n[guide.load.on]\n"face" = "f:2"\n[[guide.case]]\nname = "two"\nload = [{ on = { face = "f:3" } }]\n[[guide.case.load]]\non = 1979-05-27\n[fill]\ndensity = 1\n`;
  const [dotted, below, own, odd] = blocks(text, "guide.load", "guide.case", "guide.case.load");
  assert.deepEqual(dotted.values, { on: { face: "f:1", side: { point_mm: [0, 0, 1] } }, force_n: [1, 0, 0] });
  assert.deepEqual([below.values, below.isRead, below.isPlain], [{ force_n: [1, 0, 0], on: { face: "f:2" } }, true, false]);
  assert.ok(text.slice(below.from, below.to).endsWith('"face" = "f:2"\n'), "its lines are those of the tables below it too");
  assert.deepEqual(own.values, { name: "two", load: [{ on: { face: "f:3" } }] });
  assert.deepEqual([odd.values, odd.isRead, odd.isPlain], [{}, false, false]);
  assert.equal(get(text, "guide.load.on", "face"), null, "rows of a list are left to the text");
  assert.equal(change(text, dotted, "force_n", "[2, 0, 0]"), text.replace("[1, 0, 0]", "[2, 0, 0]"));
  assert.equal(change(text, dotted, "on", '{ face = "f:9" }'), text.replace('on.face = "f:1" # wall\non.side.point_mm = [0, 0, 1]\n', 'on = { face = "f:9" } # wall\n'));
  assert.ok(change(text, below, "torque_nmm", "1").includes("force_n = [1, 0, 0]\ntorque_nmm = 1\n[guide.load.on]"));
  assert.equal(remove(text, below), text.replace(text.slice(below.from - 1, below.to), ""));
});

test("a key of one table of a list is changed, added and taken away", () => {
  const [fixture, load] = blocks(LOADS, "guide.fixture", "guide.load");
  assert.equal(change(LOADS, fixture, "fix", '"x"'), LOADS.replace('fix = "xyz"', 'fix = "x"'));
  assert.equal(change(LOADS, load, "force_n", null), LOADS.replace("force_n = [1, 0, 0]\n", ""));
  assert.equal(change(LOADS, load, "pressure_mpa", "1"), LOADS.replace("force_n = [1, 0, 0]\n", "force_n = [1, 0, 0]\npressure_mpa = 1\n"));
  assert.equal(change(LOADS, load, "pressure_mpa", null), LOADS);
});

test("numbers have a point or a comma, and nothing else is one", () => {
  assert.deepEqual(["-2,5", "−3", ".5", "5.", "007", "1e-3", "2,5e3"].map(decimal), ["-2.5", "-3", "0.5", "5.0", "7", "1e-3", "2.5e3"]);
  assert.deepEqual(["", "-", "1,2,3", "1,234.5", "1 000", "0x10", "1e999", "2 mm"].map(decimal), Array(8).fill(null));
  assert.equal(typed({ type: "number", minimum: 0, maximum: 1 }, "0,4"), "0.4");
  assert.deepEqual(["none", "nnone"].map((t) => typed({ type: ["number", "string"], pattern: "^none$" }, t)), ['"none"', null]);
});

test("every setting has a row, and one of a table that is another value's is written there", () => {
  const number = { type: "number" };
  const schema = { properties: { density: { type: ["number", "object"], properties: { min: number } }, ct: { oneOf: [{ type: "object", properties: { path: { type: "string" }, slice_mm: number } }, { type: "string" }] }, photo: { type: "object", properties: { mm: number } } } };
  const rows = rowsOf("shape", schema);
  assert.deepEqual(rows.map((r) => [r.table, r.key, r.other]), [["shape", "density", null], ["shape.density", "min", "value"], ["shape.ct", "path", "path"], ["shape.ct", "slice_mm", "path"], ["shape.photo", "mm", null]]);
  const [, , path, slice] = rows;
  const text = '[shape]\nct = "scan"  # mine\nscale = 2\n';
  assert.equal(state(text, path, '"other"'), text.replace("scan", "other"));
  const table = state(text, slice, "0.5");
  assert.equal(table, '[shape]\nscale = 2\n\n[shape.ct]\npath = "scan"\nslice_mm = 0.5\n');
  assert.equal(state(table, slice, null), table.replace("slice_mm = 0.5\n", ""));
  assert.equal(state("[shape]\n", slice, "1"), "[shape]\n\n[shape.ct]\nslice_mm = 1\n");
  assert.equal(state("[shape]\nct = { path = 'a' }\n", slice, "1"), "[shape]\nct = { path = 'a', slice_mm = 1 }\n");
});

test("a table of a list is put in and taken out, and the rest stays", () => {
  const [fixture] = blocks(LOADS, "guide.fixture");
  const more = insert(LOADS, fixture.to, '[[guide.fixture]]\non = { face = "f:2" }\nfix = "x"\n');
  assert.equal(blocks(more, "guide.fixture").length, 2);
  assert.equal(remove(more, blocks(more, "guide.fixture")[1]), LOADS);
  assert.equal(insert("", 0, "[[guide.load]]\n"), "[[guide.load]]\n");
  assert.equal(insert("a = 1", 5, "[[guide.load]]\n"), "a = 1\n\n[[guide.load]]\n");
  assert.equal(blocks("[[guide.load]]", "guide.load")[0].to, 14);
});

test("all files that a job names beside itself are named in full", () => {
  const job = `shape = { mesh = "part.stl" } # the part
material.profile = "own.toml"
printer.profile = "generic-0.4"
[shape.ct]
truth = "true.stl"
[shape.photo]
files = [
  "low.png", # below
  "/whole/high.png",
]
[guide]
deck = "deck.inp"
field.path = 'C:\\\\whole.npy'
[fill]
density = { min = 0.1, max = 1, by = "file", file = "stress.vtu" }
[fibre]
material = "fibre.toml"
[[region]]
on = { mesh = "mod.stl" }
[output]
gcode = "out.gcode"
`;
  const whole = absolute(job, "/jobs");
  for (const name of ["part.stl", "own.toml", "true.stl", "low.png", "deck.inp", "stress.vtu", "fibre.toml", "mod.stl"]) {
    assert.ok(whole.includes(`"/jobs/${name}"`), name);
  }
  // Names of profiles, whole paths, outputs and all else stay.
  assert.equal(whole.replaceAll('"/jobs/', '"'), job);
  const keys = () => entries(whole).map((e) => e.path.join("."));
  const before = keys();
  assert.equal(absolute(whole, "/other"), whole);
  assert.deepEqual(keys(), before, "what else is read of the text comes in its order");
});
