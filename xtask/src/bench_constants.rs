//! The effect of each constant that was chosen by measurement.
//!
//! Each `Tuned` number of the sources has a row here: five values or more, among them its own, and the
//! pieces that it acts on. The bench builds the program with the feature `sweep`, plans the pieces with
//! each value and prints means over the pieces. A test compares the rows with the sources, so that each
//! tuned number has one.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

/// A piece to plan: the preset that makes its folder, the job in it, and settings that differ from the job's.
type Piece = (&'static str, &'static str, &'static [&'static str]);

/// A constant: its name, the values to try, and the pieces that it acts on.
struct Row {
    name: &'static str,
    values: &'static [f64],
    pieces: &'static [Piece],
}

const NO_FIBRE: &str = "fibre.enabled=false";
const NOZZLE: &str = "printer.profile=generic-0.4";

/// One path a layer along the stress: a bar in tension, a bar in bending, a plate with a hole, and a
/// hook.
const CONTINUOUS: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=continuous"]),
    ("stress-lines", "bending", &["fill.pattern=continuous"]),
    ("continuous", "plate", &[NO_FIBRE, NOZZLE]),
    ("continuous", "hook", &[NO_FIBRE, NOZZLE]),
    ("continuous", "plate", &[NO_FIBRE, NOZZLE, "fill.widths=constant"]),
];

/// Dense beads along the stress in the same parts.
const STRIPES: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=stripes"]),
    ("stress-lines", "bending", &["fill.pattern=stripes"]),
    ("continuous", "plate-stripes", &[NO_FIBRE, NOZZLE]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE]),
];

const SEED_LINES: &[Piece] = &[
    ("stress-lines", "tension-seed-lines", &[]),
    ("stress-lines", "bending", &["fill.pattern=seed-lines"]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE, "fill.pattern=seed-lines"]),
];

const STREAMLINES: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=streamlines", "fill.density=0.4"]),
    ("stress-lines", "bending", &["fill.pattern=streamlines", "fill.density=0.4"]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE, "fill.pattern=streamlines", "fill.density=0.4"]),
];

const fn row(name: &'static str, values: &'static [f64], pieces: &'static [Piece]) -> Row {
    Row { name, values, pieces }
}

const ROWS: &[Row] = &[
    row("fill.continuous.MIN_RING_BEADS", &[2.0, 4.0, 6.0, 9.0, 14.0], CONTINUOUS),
    row("fill.continuous.MIN_WEIGHT", &[0.002, 0.01, 0.02, 0.05, 0.2], CONTINUOUS),
    row("fill.continuous.FIELD_SAMPLES", &[8.0, 16.0, 32.0, 64.0, 128.0], CONTINUOUS),
    row("fill.continuous.cells.ACROSS_MIN", &[0.3, 0.45, 0.55, 0.7, 0.85], CONTINUOUS),
    row("fill.continuous.cells.ACROSS_MAX", &[1.15, 1.3, 1.5, 1.8, 2.2], CONTINUOUS),
    row("fill.continuous.cells.BESIDE_MIN", &[0.2, 0.35, 0.5, 0.65, 0.8], CONTINUOUS),
    row("fill.continuous.cells.BESIDE_MAX", &[1.2, 1.4, 1.7, 2.0, 2.5], CONTINUOUS),
    row("fill.continuous.cells.PLACE_MIN", &[0.25, 0.5, 1.0, 2.0, 4.0], CONTINUOUS),
    row("fill.continuous.cells.PLACE_MAX", &[1.0, 2.0, 4.0, 8.0, 16.0], CONTINUOUS),
    row("fill.continuous.cells.MANY_PLACES", &[500.0, 2000.0, 20_000.0, 60_000.0, 200_000.0], CONTINUOUS),
    row("fill.continuous.finish.ROUNDS", &[0.0, 1.0, 2.0, 3.0, 5.0], CONTINUOUS),
    row("fill.continuous.finish.CORNER", &[0.3, 0.5, 0.64, 0.8, 0.9], CONTINUOUS),
    row("fill.continuous.finish.NEAR", &[0.8, 1.0, 1.2, 1.6, 2.0], CONTINUOUS),
    row("fill.continuous.finish.FAR", &[1.6, 2.0, 2.6, 3.5, 5.0], CONTINUOUS),
    row("fill.continuous.finish.GAP", &[1.05, 1.15, 1.3, 1.5, 1.8], CONTINUOUS),
    row("fill.continuous.finish.GAP_WIDTH", &[0.75, 1.0, 1.5, 2.0, 3.0], CONTINUOUS),
    row("fill.continuous.finish.AT_CORNERS", &[1.0, 2.5, 5.0, 7.5, 10.0], CONTINUOUS),
    row("fill.continuous.finish.UNEVEN", &[0.02, 0.04, 0.08, 0.15, 0.3], CONTINUOUS),
    row("fill.continuous.finish.ON_EDGE_MM", &[0.0005, 0.001, 0.002, 0.005, 0.01], CONTINUOUS),
    row("fill.continuous.finish.SMALL_LOOP", &[1.0, 2.5, 5.0, 10.0, 20.0], CONTINUOUS),
    row("fill.continuous.finish.SPIKE_MM", &[0.001, 0.002, 0.005, 0.01, 0.05], CONTINUOUS),
    row("fill.continuous.finish.CLOSEST", &[0.003, 0.007, 0.015, 0.03, 0.1], CONTINUOUS),
    row("fill.continuous.rings.CLOSE", &[1.02, 1.05, 1.1, 1.2, 1.4], CONTINUOUS),
    row("fill.continuous.rings.SEEN_BEADS", &[1.0, 1.5, 2.0, 3.0, 4.0], CONTINUOUS),
    row("fill.continuous.rings.AGAINST", &[0.3, 0.5, 0.7, 0.85, 0.95], CONTINUOUS),
    row("fill.continuous.rings.FURTHEST", &[2.5, 3.5, 5.0, 8.0, 12.0], CONTINUOUS),
    row("fill.continuous.strips.MESH_MIN", &[0.5, 0.75, 1.0, 1.5, 2.0], CONTINUOUS),
    row("fill.continuous.strips.MESH_MAX", &[1.5, 3.0, 6.0, 9.0, 12.0], CONTINUOUS),
    row("fill.continuous.strips.MANY_NODES", &[2000.0, 6000.0, 20_000.0, 60_000.0, 200_000.0], CONTINUOUS),
    row("fill.continuous.strips.THIN_BEADS", &[0.75, 1.0, 1.5, 2.0, 3.0], CONTINUOUS),
    row("fill.continuous.strips.PARTED_BEADS", &[0.1, 0.15, 0.25, 0.4, 0.5], CONTINUOUS),
    row("fill.continuous.strips.STEP_BEADS", &[0.4, 0.7, 1.0, 1.5, 2.0], CONTINUOUS),
    row("fill.continuous.strips.LONGEST_STEPS", &[1.0, 2.0, 3.0, 5.0, 8.0], CONTINUOUS),
    row("fill.continuous.strips.STRAIGHT_BEADS", &[0.001, 0.002, 0.005, 0.01, 0.03], CONTINUOUS),
    row("fill.continuous.strips.LEAST_WEIGHT", &[0.01, 0.03, 0.1, 0.3, 1.0], CONTINUOUS),
    row("fill.continuous.strips.DIFFUSION_ROUNDS", &[1.0, 2.0, 3.0, 5.0, 8.0], CONTINUOUS),
    row("fill.continuous.strips.DIFFUSION_SCALE", &[0.25, 0.5, 1.0, 2.0, 4.0], CONTINUOUS),
    row("fill.continuous.tree.TRIED", &[0.0, 4.0, 12.0, 24.0, 48.0], CONTINUOUS),
    row("fill.continuous.tree.WORTH", &[0.0, 0.02, 0.05, 0.2, 1.0], CONTINUOUS),
    row("fill.continuous.verify.SLACK_MM", &[0.002, 0.005, 0.01, 0.02, 0.05], CONTINUOUS),
    row("fill.field.phase.DIFFUSION_ROUNDS", &[1.0, 3.0, 6.0, 10.0, 16.0], STRIPES),
    row("fill.field.phase.DIFFUSION_SCALE", &[0.25, 0.5, 1.0, 2.0, 4.0], STRIPES),
    row("fill.field.phase.MAX_DRIFT", &[1.05, 1.12, 1.22, 1.35, 1.5], STRIPES),
    row("fill.field.phase.DRIFT_MM", &[3.0, 6.0, 12.0, 24.0, 48.0], STRIPES),
    row("fill.field.stripes.SHORTEST", &[1.0, 1.5, 2.0, 3.0, 5.0], STRIPES),
    row("fill.field.stripes.LONGEST_JOINT", &[1.2, 1.6, 2.0, 2.5, 3.0], STRIPES),
    row("fill.field.stripes.CENTRINGS", &[0.0, 1.0, 3.0, 5.0, 8.0], STRIPES),
    row("fill.field.stripes.THINNINGS", &[0.0, 1.0, 2.0, 3.0, 5.0], STRIPES),
    row("fill.field.seed_lines.SEED_SPACING", &[3.0, 5.0, 8.0, 12.0, 20.0], SEED_LINES),
    row("fill.field.seed_lines.SHORTEST", &[1.0, 1.5, 2.0, 3.0, 5.0], SEED_LINES),
    row("fill.field.seed_lines.MAX_OFFSETS", &[10.0, 50.0, 500.0, 2000.0, 5000.0], SEED_LINES),
    row("fill.field.streamlines.END_SHARE", &[0.3, 0.45, 0.55, 0.7, 0.85], STREAMLINES),
    row("fill.field.streamlines.SHORTEST_SHARE", &[0.5, 1.0, 1.5, 2.5, 4.0], STREAMLINES),
];

const HEADER: &str = "| value | gap % | overlap % | angle deg | 95 % deg | paths | printing s | planning s |\n|---|---|---|---|---|---|---|---|\n";

/// Sweeps the constants whose names hold one of the words, or all; `--write` puts the tables into
/// `docs/constants.md`.
pub fn run(words: &[&str]) -> Result<(), String> {
    let write = words.contains(&"--write");
    let names: Vec<&str> = words.iter().copied().filter(|w| *w != "--write").collect();
    let rows: Vec<&Row> =
        ROWS.iter().filter(|r| names.is_empty() || names.iter().any(|n| r.name.contains(n))).collect();
    if rows.is_empty() {
        return Err(format!("no constant is named like {}", names.join(" or ")));
    }
    // A target folder of its own keeps the ordinary program as it is built.
    let target = crate::target().join("sweep");
    let mut build = Command::new("cargo");
    build
        .args(["build", "--release", "-p", "grainpath-cli", "--features", "sweep", "--target-dir"])
        .arg(&target);
    crate::run(&mut build)?;
    let grainpath = target.join("release/grainpath");
    let folder = crate::target().join("bench/constants");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for preset in ["stress-lines", "continuous"] {
        let made = folder.join(preset);
        crate::output(Command::new(&grainpath).args(["new", "--force", preset]).arg(&made))?;
    }
    let mut text = String::new();
    for row in rows {
        let table = sweep(&grainpath, &folder, row)?;
        println!("{table}");
        text += &table;
        text.push('\n');
    }
    if write {
        let commit = crate::output(Command::new("git").args(["rev-parse", "--short", "HEAD"]))?;
        let date = crate::output(Command::new("date").arg("+%Y-%m-%d"))?;
        let page = format!("{PAGE}\nMeasured {} on commit `{}`.\n\n{text}", date.trim(), commit.trim());
        let path = crate::root().join("docs/constants.md");
        fs::write(&path, page.trim_end().to_owned() + "\n")
            .map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

const PAGE: &str = "# Constants chosen by measurement

Some constants of the fills follow from no formula and stand in no paper. Each has a table here: the same pieces
planned with five or more values of it. Numbers are means over the pieces; paths and seconds are sums. The value in
the code is marked. `cargo xtask bench constants --write` makes this page, and `cargo xtask bench constants NAME` prints
the tables of the constants whose name holds that word.

A gap is the share of the area that should be filled and is open; overlap is the share that is filled twice. The angle
is between bead and stress, and 95 % of the length lies within the fifth column.
";

/// The table of one constant.
fn sweep(grainpath: &Path, folder: &Path, row: &Row) -> Result<String, String> {
    let mut text = format!("## {}\n\n{HEADER}", row.name);
    let own = value_in_sources(row.name)?;
    for &value in row.values {
        let (mut sums, mut seconds) = ([0.0; 6], 0.0);
        let mut failed = None;
        for piece in row.pieces {
            let start = Instant::now();
            match plan(grainpath, folder, piece, row.name, value) {
                Ok(numbers) => sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number),
                Err(problem) => failed = Some(problem),
            }
            seconds += start.elapsed().as_secs_f64();
        }
        let mark = if value == own { "**" } else { "" };
        // A value that fails is a result as well: the row says so, and the others go on.
        if let Some(problem) = failed {
            let line = problem.lines().last().unwrap_or_default();
            writeln!(text, "| {mark}{value}{mark} | fails: {line} | | | | | | |").expect("text");
            continue;
        }
        let pieces = row.pieces.len() as f64;
        let [gap, overlap, mean, most] = [0, 1, 2, 3].map(|i| sums[i] / pieces);
        writeln!(
            text,
            "| {mark}{value}{mark} | {:.2} | {:.2} | {mean:.2} | {most:.1} | {} | {:.0} | {seconds:.1} |",
            100.0 * gap,
            100.0 * overlap,
            sums[4],
            sums[5]
        )
        .expect("text");
    }
    Ok(text)
}

/// Gap, overlap, mean angle, angle that 95 % of the length lie within, paths and printing time of a piece.
fn plan(grainpath: &Path, folder: &Path, piece: &Piece, name: &str, value: f64) -> Result<[f64; 6], String> {
    let (preset, job, more) = *piece;
    let mut command = Command::new(grainpath);
    // Elements of 2 mm keep each plan short; all values see the same ones.
    command.args(["run", "--json", "--set", "process.skirt_loops=0", "--set", "guide.element_mm=2"]);
    for quiet in ["output.report=", "output.preview=", "output.lines=", "output.stress="] {
        command.args(["--set", quiet]);
    }
    for setting in more {
        command.args(["--set", setting]);
    }
    command.arg("--out").arg(folder.join("out")).env("GRAINPATH_SWEEP", format!("{name}={value}"));
    let path: PathBuf = folder.join(preset).join(job).with_extension("toml");
    let text = crate::output(command.arg(path))?;
    let report: Value = serde_json::from_str(&text).map_err(|e| format!("{job}: {e}"))?;
    let number =
        |value: &Value| value.as_f64().ok_or_else(|| format!("{job}: a number is missing in {text}"));
    let quality = &report["quality"];
    Ok([
        number(&quality["gap"])?,
        number(&quality["overlap"])?,
        number(&quality["alignment_mean_deg"])?,
        number(&quality["alignment_p95_deg"])?,
        number(&report["toolpaths"])?,
        number(&report["time_s"])?,
    ])
}

/// The value that a tuned number has in the sources.
fn value_in_sources(name: &str) -> Result<f64, String> {
    let found = tuned_in_sources()?.into_iter().find(|(known, _)| known == name);
    found.map(|(_, value)| value).ok_or_else(|| format!("{name} is no tuned number of the sources"))
}

/// Names and values of all tuned numbers, as `Tuned::new("name", value)` has them.
fn tuned_in_sources() -> Result<Vec<(String, f64)>, String> {
    let mut found = Vec::new();
    for source in crate::source::read(&crate::root())?.sources {
        // The module that defines the type shows an example.
        if source.path.ends_with("core/src/tuned.rs") {
            continue;
        }
        let text: String = source.text.join(" ");
        for rest in text.split("Tuned::new(").skip(1) {
            let inner = rest.split(')').next().unwrap_or_default();
            let (name, value) =
                inner.split_once(',').ok_or_else(|| format!("{}: Tuned::new({inner})", source.path))?;
            let value = value.trim().trim_end_matches(',').replace('_', "");
            let value = value.parse().map_err(|e| format!("{}: {value}: {e}", source.path))?;
            found.push((name.trim().trim_matches('"').to_owned(), value));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tuned_number_has_a_row_with_five_values_and_its_own() {
        let tuned = tuned_in_sources().expect("the sources can be read");
        assert!(!tuned.is_empty(), "no tuned number was found");
        for (name, value) in &tuned {
            let rows: Vec<&Row> = ROWS.iter().filter(|row| row.name == name).collect();
            assert_eq!(rows.len(), 1, "{name} needs one row in ROWS");
            assert!(rows[0].values.len() >= 5, "{name}: five values or more");
            assert!(rows[0].values.contains(value), "{name}: its own value {value} is missing in its row");
        }
        for row in ROWS {
            assert!(tuned.iter().any(|(name, _)| name == row.name), "{} is no tuned number", row.name);
        }
    }
}
