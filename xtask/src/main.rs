//! The workshop: what checks, measures and maintains grainpath.
//!
//! `cargo xtask test` is the whole of CI; `cargo xtask bench` holds our speed and quality against the peers'.

mod arrows;
mod bench;
mod bench_continuous;
mod bench_ct;
mod bench_fea;
mod bench_paths;
mod bench_strength;
mod count;
mod fuzz;
mod hashes;
mod invariants;
mod licences;
mod photo;
mod setup;
mod source;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str = "usage: cargo xtask <command>
  test             everything CI checks: format, lints, docs, licences, arrows, tests, examples, fuzzers
  test --quick     the same without examples, fuzzers and what needs installing
  invariants       dependencies of crates and the invariants of ARCHITECTURE.md
  count [--tighten | --list NAME | --in FOLDER]  counts of the sources beside the limits of xtask/counts.toml
  hashes [--write] [--binary PATH]  G-code of small jobs beside the committed hashes
  bench slicing [PART...]  time and memory beside PrusaSlicer and CuraEngine
                   (benchy bunny armadillo plate_holes skull; the skull takes the peers many minutes)
  bench ct [SCAN...]  scans to G-code beside marching cubes, STL and PrusaSlicer (hub engine),
                   and a stack of 2048 x 2048 x 2000 voxels (large)
  bench fea [300000|1000000]  meshing and solving a bracket beside gmsh and CalculiX
  bench support [PART...]  grams and time of supports beside our baselines and the peers
                   (ball tray bone featuretype armadillo100 skull)
  bench quality    gap, spill, overlap and travel beside the same
  bench photo      a photograph of 12 megapixels to curves, beside OpenCV
  bench continuous one path a layer: angle, gap, and time up to a million cells
  bench paths      fill along the stress held against CalculiX's principal stresses
  bench strength [PART...]  the virtual strength test: of a bar and of a bracket (time), the papers' comparisons
                   beside theirs (s1 s2), other slicers' programs (slicers); `all` adds what takes long
  fuzz [SECONDS]   builds every fuzz target and runs it that long (default 20)
  setup            installs what tests and benches need (Python packages, Chromium, the peers)";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let outcome = match words.as_slice() {
        ["test"] => test(true),
        ["test", "--quick"] => test(false),
        ["invariants"] => arrows::check().and_then(|()| invariants::check()),
        ["count", words @ ..] => count::run(words),
        ["hashes", words @ ..] => hashes::run(words),
        ["bench", "slicing", parts @ ..] => bench::slicing(parts),
        ["bench", "continuous"] => bench_continuous::run(),
        ["bench", "paths"] => bench_paths::run(),
        ["bench", "strength", parts @ ..] => bench_strength::run(parts),
        ["bench", "ct", scans @ ..] => bench_ct::run(scans),
        ["bench", "fea", cases @ ..] => bench_fea::run(cases),
        ["bench", "support", parts @ ..] => bench::support(parts),
        ["bench", "quality"] => bench::quality(),
        ["bench", "photo"] => photo::bench(),
        ["fuzz"] => fuzz::run(20),
        ["fuzz", seconds] => seconds.parse().map_err(|_| USAGE.to_owned()).and_then(fuzz::run),
        ["setup"] => setup::tests().and_then(|()| setup::peers()),
        _ => Err(USAGE.to_owned()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

/// What went wrong, in a line.
type Outcome = Result<(), String>;

fn test(whole: bool) -> Outcome {
    step("format");
    cargo(&["fmt", "--all", "--check"])?;
    step("arrows between crates");
    arrows::check()?;
    step("invariants");
    invariants::check()?;
    step("counts");
    count::run(&[])?;
    step("licences");
    licences::check()?;
    if whole {
        step("setting up what tests need");
        setup::tests()?;
    }
    step("lints");
    cargo(&["clippy", "--workspace", "--all-targets", "--profile", "ci", "--", "-D", "warnings"])?;
    step("documentation");
    run(Command::new("cargo")
        .args(["doc", "--workspace", "--no-deps", "--quiet"])
        .env("RUSTDOCFLAGS", "-D warnings"))?;
    step("G-code hashes");
    hashes::run(&[])?;
    step("tests");
    // The same cases of property tests on every run; `cargo test` alone draws others.
    run(Command::new("cargo")
        .args(["test", "--workspace", "--profile", "ci"])
        .env("PROPTEST_RNG_SEED", "20"))?;
    if whole {
        step("fuzz targets");
        fuzz::run(8)?;
    }
    println!("\nxtask: all checks passed");
    Ok(())
}

fn step(name: &str) {
    println!("\n== {name}");
}

/// The repository's top folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository").to_owned()
}

/// The folder that cargo builds in.
fn target() -> PathBuf {
    std::env::var("CARGO_TARGET_DIR").map_or_else(|_| root().join("target"), PathBuf::from)
}

/// A program of the release profile.
fn built(name: &str) -> PathBuf {
    target().join("release").join(name)
}

fn cargo(args: &[&str]) -> Outcome {
    run(Command::new("cargo").args(args))
}

/// Runs a command in the repository's top folder and fails when it does.
fn run(command: &mut Command) -> Outcome {
    command.current_dir(root());
    let status = command.status().map_err(|e| format!("cannot start {command:?}: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("{command:?} ended with {status}")) }
}

/// What a command prints, or why it failed.
fn output(command: &mut Command) -> Result<String, String> {
    let out = command.output().map_err(|e| format!("cannot start {command:?}: {e}"))?;
    if out.status.success() {
        Ok(String::from_utf8_lossy(&out.stdout).into_owned())
    } else {
        Err(format!("{command:?} ended with {}: {}", out.status, String::from_utf8_lossy(&out.stderr)))
    }
}
