//! `cargo xtask nightly`: everything that takes too long for every change.
//!
//! A check that fails does not keep the others from running, so that one night tells all that is broken. What has passed
//! is kept below `target/nightly/` for the commit it passed on: a run that was stopped goes on with the rest. When the last
//! check has ended, `docs/nightly.md` gets a line with the date, the commit, the minutes and what failed.

use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use crate::{Outcome, TestOptions, fuzz, ignored, output, pages, source};

/// How long each fuzz target runs, s.
const FUZZ_SECONDS: u64 = 120;

/// Pages that the run itself writes.
const WRITTEN: [&str; 2] = ["docs/fuzzing.md", "docs/nightly.md"];

/// A check: what it is called, and what runs it.
type Check = (&'static str, fn() -> Outcome);

/// In this order: what needs a quiet machine stands together.
const CHECKS: &[Check] = &[
    ("all of test", || crate::test(&TestOptions { quick: false, install: true, allow_missing: false })),
    ("Python package from its source distribution", || crate::python::command(&["--release"])),
    ("slow tests", slow_tests),
    ("fill along the stress", crate::bench_paths::run),
    ("finite elements beside gmsh and CalculiX", || crate::bench_fea::run(&["300000"])),
    ("strength beside the papers", || crate::bench_strength::run(&["s1", "s2"])),
    ("beads turned and moved", || crate::bench_turned::run(&[])),
    ("time beside Klipper's planner", klipper),
    ("from a signal to the exit", || crate::bench_stops::run(&[])),
    ("headers of scans beside SimpleITK", crate::bench_ct::headers),
    ("scans beside marching cubes", || crate::bench_ct::run(&["hub", "engine"])),
    ("quality beside the peers", || crate::bench::quality(&[])),
    ("command blocks of the pages", || crate::book::run(&["run"])),
    ("page of the JSON reports", crate::json::check),
    ("gallery: jobs and pinholes", || crate::gallery::run(&["check"])),
    ("planner as a page", || crate::wasm::run(&[])),
    ("book", || {
        crate::book::run(&["install"])?;
        crate::book::run(&[])?;
        crate::book::run(&["axe"])
    }),
    ("two builds of one commit", || crate::release::run(&["twice"])),
    ("static program", || crate::release::run(&["static"])),
    ("Debian package in a bare root", debian_package),
    ("mutated files, kills, full disk", || crate::campaign::run(&[])),
    ("fuzz targets", || fuzz::run(FUZZ_SECONDS, true)),
];

/// Tests that are ignored because they are slow.
fn slow_tests() -> Outcome {
    let ignored = ignored::find(&source::read(&crate::root())?.tests)?;
    let mut names =
        ignored.iter().filter(|t| t.reason.starts_with("slow")).map(|t| t.name.as_str()).peekable();
    // Without a name every ignored test would run, also those that need data.
    names.peek().ok_or("no test is ignored because it is slow")?;
    crate::test_programs::run(&["--ignored", "--exact"].into_iter().chain(names).collect::<Vec<_>>())
}

/// Told times beside Klipper's, where there is a checkout of it.
fn klipper() -> Outcome {
    if let Err(problem) = crate::setup::klipper() {
        println!("NOT RUN: {problem}");
        return Ok(());
    }
    crate::bench_klipper::run()
}

/// The package of the program that the check of two builds has left. Programs that the check needs are installed.
fn debian_package() -> Outcome {
    crate::setup::packaging()?;
    let program = crate::release::first_of_two();
    if !program.exists() {
        crate::release::run(&["twice"])?;
    }
    crate::deb::run(&[&program.to_string_lossy(), "--root"])
}

/// Runs what has not passed yet on this commit.
pub fn run() -> Outcome {
    let git = |words: &[&str]| output(Command::new("git").args(words).current_dir(crate::root()));
    let changed = git(&["status", "--porcelain", "--untracked-files=no"])?;
    let others = changed.lines().filter(|l| !WRITTEN.iter().any(|page| l.ends_with(page)));
    if let Some(line) = others.map(str::trim).next() {
        return Err(format!("a nightly run is noted with its commit, but files have changed since: {line}"));
    }
    let commit = git(&["rev-parse", "--short", "HEAD"])?.trim().to_owned();
    let folder = crate::target().join("nightly");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let kept = folder.join(&commit);
    let mut passed = read(&kept)?;
    let (mut failed, mut problems, mut lost_s) = (Vec::new(), Vec::new(), 0);
    for (name, check) in CHECKS {
        if passed.iter().any(|(done, _)| done == name) {
            println!("\n== {name}: has passed on {commit}");
            continue;
        }
        println!("\n== {name}");
        let start = Instant::now();
        let outcome = check();
        // Taken also after a failure, so that the next check does not answer for them.
        let goals = crate::measured::check_goals();
        let outcome = outcome.and(goals);
        let seconds = start.elapsed().as_secs();
        match outcome {
            Ok(()) => {
                println!("-- {name}: passed in {seconds} s");
                passed.push(((*name).to_owned(), seconds));
                let text: String = passed.iter().map(|(name, s)| format!("{name}\t{s}\n")).collect();
                fs::write(&kept, text).map_err(|e| format!("{}: {e}", kept.display()))?;
            }
            Err(problem) => {
                println!("-- {name}: failed after {seconds} s: {problem}");
                failed.push(*name);
                problems.push(format!("{name}: {problem}"));
                lost_s += seconds;
            }
        }
    }
    println!();
    let minutes = (passed.iter().map(|(_, s)| s).sum::<u64>() + lost_s).div_ceil(60);
    pages::note_nightly(&commit, passed.len(), &failed, minutes)?;
    if failed.is_empty() {
        println!("xtask: all {} checks of the nightly run passed on {commit} in {minutes} min", CHECKS.len());
        return Ok(());
    }
    Err(format!("{} of {} checks failed:\n       {}", failed.len(), CHECKS.len(), problems.join("\n       ")))
}

/// The checks that passed, with their seconds.
fn read(kept: &PathBuf) -> Result<Vec<(String, u64)>, String> {
    if !kept.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(kept).map_err(|e| format!("{}: {e}", kept.display()))?;
    let row = |line: &str| {
        let (name, seconds) = line.split_once('\t')?;
        Some((name.to_owned(), seconds.parse().ok()?))
    };
    Ok(text.lines().filter_map(row).collect())
}
