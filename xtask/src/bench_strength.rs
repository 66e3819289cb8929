//! Time and memory of the virtual strength test, of a plate and of a solid.

use std::fs;
use std::process::{Command, Stdio};

use crate::bench::timed;

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
    Ok(())
}
