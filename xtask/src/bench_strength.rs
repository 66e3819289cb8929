//! Time and memory of the virtual strength test, of a plate and of a solid; the programs of other slicers in it.

use std::fs;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench::{Bench, PROGRAMS, timed};

/// A test: what it is, its job, settings beside it, and the most it may take in seconds and MiB.
type Case<'a> = (&'a str, &'a str, &'a [&'a str], f64, f64);

const CASES: [Case<'static>; 3] = [
    (
        "bar 150 x 20 x 4 mm as a plate, cells of 0.2 mm, nominal card",
        "iso527-1b",
        &["strength.cell_mm=0.2", "strength.corners=false", "strength.check=false"],
        20.0,
        1536.0,
    ),
    (
        "bracket of 60 mm as a solid, cells of a bead, nominal card",
        "bracket",
        &["strength.corners=false", "strength.check=false"],
        180.0,
        4096.0,
    ),
    ("the same with the corners of the card and the check of the cells", "bracket", &[], f64::NAN, 4096.0),
];

/// Tests a tensile bar and a bracket of the examples, planning included.
pub fn run() -> Result<(), String> {
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let root = crate::root();
    let folder = root.join("target/bench/strength");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let grainpath = root.join("target/release/grainpath");
    let quietly = |args: &[&str]| {
        crate::run(Command::new(&grainpath).args(args).current_dir(&folder).stdout(Stdio::null()))
    };
    quietly(&["new", "--force", "stress-lines", "."])?;
    quietly(&["specimen", "iso527-1b"])?;
    println!("\nBest of 2 runs.\n\n| test | s | MiB | aim |\n|---|---|---|---|");
    for (what, job, sets, most_s, most_mib) in CASES {
        let job = folder.join(format!("{job}.toml"));
        let mut words = vec![grainpath.display().to_string(), "strength".into(), job.display().to_string()];
        for set in sets {
            words.extend(["--set".into(), (*set).into()]);
        }
        let one = || timed(&words, &folder);
        let (a, b) = (one()?, one()?);
        let (wall_s, mib) = (a.wall_s.min(b.wall_s), a.peak_mib.max(b.peak_mib));
        let aim =
            if most_s.is_finite() { format!("{most_s:.0} s, {most_mib:.0} MiB") } else { "none".into() };
        println!("| {what} | {wall_s:.1} | {mib:.0} | {aim} |");
    }
    foreign()
}

/// An open-hole plate sliced by each program at 100 % rectilinear, drawn until it breaks.
fn foreign() -> Result<(), String> {
    let bench = match Bench::prepare() {
        Err(skipped) if skipped.starts_with("skipped") => {
            println!("{skipped}");
            return Ok(());
        }
        other => other?,
    };
    let ours = crate::built("grainpath");
    crate::run(Command::new(&ours).args(["specimen", "d5766", "-o"]).arg(bench.mesh("d5766")))?;
    println!("\nASTM D5766 open-hole plate, 100 % rectilinear, nominal card, cells of 0.45 mm.\n");
    println!("| sliced by | mass g | peak N | stiffness N/mm | fails mostly |\n|---|---|---|---|---|");
    for program in PROGRAMS {
        let Some((_, gcode)) = bench.cost(program, "d5766", 1.0)? else { continue };
        let mut command = Command::new(&ours);
        command.arg("strength").arg(&gcode).arg("--job").arg(bench.mesh("d5766").with_extension("toml"));
        for set in ["corners=false", "check=false", "cell_mm=0.45"] {
            command.args(["--set", &format!("strength.{set}")]);
        }
        let found: Value =
            serde_json::from_str(&crate::output(command.arg("--json"))?).map_err(|e| e.to_string())?;
        let found = &found["strength"];
        println!(
            "| {program} | {} | {} | {} | {} |",
            found["mass_g"],
            found["peak_load_n"],
            found["stiffness_n_per_mm"],
            found["mode"].as_str().unwrap_or_default()
        );
    }
    Ok(())
}
