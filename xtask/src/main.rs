//! The workshop: programs that check, measure and maintain grainpath.
//!
//! `cargo xtask test` is the whole of CI; `cargo xtask bench` holds our speed and quality against the peers'.

mod arrows;
mod bench;
mod bench_constants;
mod bench_continuous;
mod bench_ct;
mod bench_density;
mod bench_fea;
mod bench_gains;
mod bench_jobs;
mod bench_klipper;
mod bench_paths;
mod bench_stops;
mod bench_strength;
mod bench_turned;
mod bench_verification;
mod book;
mod campaign;
mod count;
mod deb;
mod figures;
mod fuzz;
mod gallery;
mod glossary;
mod hashes;
mod ignored;
mod invariants;
mod json;
mod licences;
mod measured;
mod nightly;
mod page;
mod pages;
mod photo;
mod python;
mod release;
mod sbom;
mod setup;
mod source;
mod test_programs;
mod texts;
mod wasm;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

const USAGE: &str = "usage: cargo xtask <command>
  test             everything CI checks: format, invariants, counts, licences, lints, docs, G-code hashes, tests, the page.
                   Says first what is missing and how to install it; what needs no rights goes below target/.
                   --install        installs system packages too
                   --allow-missing  what cannot run here is no failure
                   --tests          builds and runs the tests alone, as many programs at once as there are cores
                   --quick          leaves out fuzz targets and tests that need files or programs
  nightly          all of test, slow tests, two minutes of each fuzz target, the campaign, benches that verify;
                   goes on after a failure, and where it stopped when it is started again on the same commit
  invariants       dependencies of crates, the invariants of ARCHITECTURE.md, and the terms of docs/glossary.md
  count [--tighten | --list NAME | --in FOLDER]  counts of the sources beside the limits of xtask/counts.toml
  texts [SEED [COUNT]]  comments, messages and texts of settings drawn at random (40), to be read as by a stranger
  hashes [--write] [--binary PATH]  G-code of small jobs beside the committed hashes
  bench NAME ... --record  writes the numbers of its tables into docs/measured.toml, from where pages quote them
  bench slicing [PART...]  time and memory beside PrusaSlicer and CuraEngine
                   (benchy bunny armadillo plate_holes skull; the skull takes the peers many minutes)
  bench ct [SCAN...]  scans to G-code beside marching cubes, STL and PrusaSlicer (hub engine),
                   and a stack of 2048 x 2048 x 2000 voxels (large)
  bench fea [300000|1000000]  meshing and solving a bracket beside gmsh and CalculiX
  bench support [PART...]  grams and time of supports beside our baselines and the peers
                   (ball tray bone featuretype armadillo100 skull)
  bench quality [PART...]  gap, spill, overlap and travel beside the same
  bench photo      a photograph of 12 megapixels to curves, beside OpenCV
  bench continuous one path a layer: angle, gap, and time up to a million cells
  bench constants [--write] [NAME...]  quality over five values or more of each constant that was chosen by measurement
  bench python [JOBS [GB]]  what the Python package costs: import, call, a scan handed over, a sweep of 100 jobs and a scan of 17 GB on 2 workers
  bench paths      fill along the stress held against CalculiX's principal stresses
  bench jobs [PART...]  small jobs of the pages: continuous fibre and its strength (fibre fibre-strength), layers in turn
                   for two load cases (cases), smoothing of the field (smoothing), given directions (fields)
  bench verification  numbers that tests of solvers and scans print, and the meshes of a bracket
  bench strength [PART...]  the virtual strength test: of a bar and of a bracket (time), the papers' comparisons
                   beside theirs (s1 s2), other slicers' programs (slicers); `all` adds what takes long
  bench density [PART...]  mass at equal peak load of the virtual test: even fills beside density and direction by the
                   stress (bracket hook lever two-holes hinge)
  bench gains [PART...]  lines of several beads, staggered and extra walls at equal mass (lines), poses of a bracket in
                   the virtual test (poses), graded plates beside solids (stiffness)
  bench stops [SIGNALS [SEED]]  from SIGINT and SIGTERM to the exit, at random moments (20) of each stage
  bench klipper    the time told of ten programs beside Klipper's own planner (GRAINPATH_KLIPPER: a checkout)
  bench turned [COPIES [SEED]]  one set of beads, turned and moved (50 times), in the virtual test
  bench studio [PATH]  the studio in Chromium: file to first layer, name under the pointer, cancel, bytes, frames
  page [--write]   bundles the studio's page and compares it with the committed one, or renews that
  page test [PATH] tests of the page in Chromium, of the program at PATH (default target/ci/grainpath)
  python [--release]  builds the wheel of the Python package and runs its tests (--release: as published, from the sdist)
  fuzz [SECONDS] [--record]  builds every fuzz target and runs it that long (default 20);
                   --record adds the executions to docs/fuzzing.md
  campaign [MINUTES]  mutated files, kills and a full disk, against the program (default 10 minutes)
  book             the pages of docs/ as a site below target/book, no link dead; `book install` builds mdBook,
                   `book run [PAGE...]` runs the command blocks of the pages and the table of README.md
                   (--allow-missing: blocks that need the Python package may be left out),
                   `book pictures` renews their pictures,
                   `book axe` asks axe about every page of the built site,
                   `book json` holds the page of the JSON reports against what jobs print
  deb [PROGRAM] [--root]  a Debian package of target/dist/grainpath, held against lintian; --root tries it in a bare root
  figures [--write]  the numbers that pages quote beside docs/measured.toml and the table of README.md beside
                   docs/figures.toml, or writes them
  gallery [PART...]  plans the parts of docs/gallery with target/ci/grainpath and draws their sheets;
                   `gallery check` plans all and holds pictures, jobs and page against what is committed
  licences         writes what `grainpath licences` prints, after dependencies changed
  wasm [--binary PATH]  the planner as a page of one file, below target/wasm; its G-code in Node beside the program's
  release twice|static  builds the program in two folders and compares the bytes; builds it for musl, one file that needs nothing
  sbom [FILE]      everything inside the program as CycloneDX JSON
  setup            installs what tests and benches need (Python packages, the peers)";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let mut words: Vec<&str> = args.iter().map(String::as_str).collect();
    // A bench that records prints the same tables; what they hold is written when it has ended well.
    let records = words.first() == Some(&"bench") && words.contains(&"--record");
    words.retain(|word| !records || *word != "--record");
    let outcome = match words.as_slice() {
        ["test", "--tests"] => test_programs::run(&[]),
        ["test", words @ ..] => TestOptions::parse(words).and_then(|options| test(&options)),
        ["nightly"] => nightly::run(),
        ["invariants"] => arrows::check().and_then(|()| invariants::check()).and_then(|()| glossary::check()),
        ["count", words @ ..] => count::run(words),
        ["texts", words @ ..] => texts::run(words),
        ["hashes", words @ ..] => hashes::run(words),
        ["bench", "slicing", parts @ ..] => bench::slicing(parts),
        ["bench", "constants", words @ ..] => bench_constants::run(words),
        ["bench", "continuous"] => bench_continuous::run(),
        ["bench", "jobs", parts @ ..] => bench_jobs::run(parts),
        ["bench", "paths"] => bench_paths::run(),
        ["bench", "stops", words @ ..] => bench_stops::run(words),
        ["bench", "klipper"] => bench_klipper::run(),
        ["bench", "turned", words @ ..] => bench_turned::run(words),
        ["bench", "verification"] => bench_verification::run(),
        ["bench", "strength", parts @ ..] => bench_strength::run(parts),
        ["bench", "density", parts @ ..] => bench_density::run(parts),
        ["bench", "gains", parts @ ..] => bench_gains::run(parts),
        ["bench", "ct", scans @ ..] => bench_ct::run(scans),
        ["bench", "fea", cases @ ..] => bench_fea::run(cases),
        ["bench", "support", parts @ ..] => bench::support(parts),
        ["bench", "quality", parts @ ..] => bench::quality(parts),
        ["bench", "python", words @ ..] => python::bench(words),
        ["bench", "photo"] => photo::bench(),
        ["bench", "studio"] => page::bench(&ci_program()),
        ["bench", "studio", path] => {
            std::path::absolute(path).map_err(|e| format!("{path}: {e}")).and_then(|path| page::bench(&path))
        }
        ["campaign", words @ ..] => campaign::run(words),
        ["book", words @ ..] => book::run(words),
        ["deb", words @ ..] => deb::run(words),
        ["figures", words @ ..] => figures::run(words),
        ["gallery", words @ ..] => gallery::run(words),
        ["licences"] => licences::write(),
        ["release", words @ ..] => release::run(words),
        ["sbom", words @ ..] => sbom::run(words),
        ["wasm", words @ ..] => wasm::run(words),
        ["page", "test"] => page::test_in_browser(&ci_program()),
        ["page", "test", path] => std::path::absolute(path)
            .map_err(|e| format!("{path}: {e}"))
            .and_then(|path| page::test_in_browser(&path)),
        ["page", words @ ..] => page::run(words),
        ["python", words @ ..] => python::command(words),
        ["fuzz", words @ ..] => fuzz::command(words, USAGE),
        ["setup"] => setup::tests(true).and_then(|_| setup::peers()),
        _ => Err(USAGE.to_owned()),
    };
    let outcome = outcome.and_then(|()| if records { measured::save() } else { Ok(()) });
    let outcome = outcome.and_then(|()| measured::check_goals());
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The result of a check; the error is one line.
type Outcome = Result<(), String>;

/// Options of `test`.
struct TestOptions {
    /// Leaves out fuzz targets and all that needs installing.
    quick: bool,
    /// System packages may be installed.
    install: bool,
    /// Checks that cannot run here are no failure.
    allow_missing: bool,
}

impl TestOptions {
    fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self { quick: false, install: false, allow_missing: false };
        for word in words {
            match *word {
                "--quick" => options.quick = true,
                "--install" => options.install = true,
                "--allow-missing" => options.allow_missing = true,
                _ => return Err(USAGE.to_owned()),
            }
        }
        Ok(options)
    }
}

/// Checks that passed, and those that could not run here.
#[derive(Default)]
struct Checks {
    /// Name and time of each, s.
    passed: Vec<(String, f64)>,
    not_run: Vec<String>,
}

impl Checks {
    /// Runs a check; the first failure ends the run.
    fn run(&mut self, name: &str, check: impl FnOnce() -> Outcome) -> Outcome {
        println!("\n== {name}");
        let start = Instant::now();
        check()?;
        self.passed.push((name.to_owned(), start.elapsed().as_secs_f64()));
        Ok(())
    }

    /// Runs two checks at once. The first gets a thread of its own; the second goes on where the first fails.
    fn run_both(
        &mut self,
        names: [&str; 2],
        first: impl FnOnce() -> Outcome + Send,
        second: impl FnOnce() -> Outcome,
    ) -> Outcome {
        self.run(&names.join(", and beside it "), || {
            let [first, second] = std::thread::scope(|scope| {
                let first = scope.spawn(first);
                let second = second();
                [first.join().expect("no check panics"), second]
            });
            first.and(second)
        })
    }

    /// Prints where the time went and the last line, and gives the result.
    fn finish(self, allow_missing: bool) -> Outcome {
        println!();
        for (name, seconds) in &self.passed {
            println!("{seconds:7.0} s  {name}");
        }
        for what in &self.not_run {
            println!("NOT RUN: {what}");
        }
        println!("xtask: {} checks passed, {} not run", self.passed.len(), self.not_run.len());
        if self.not_run.is_empty() || allow_missing {
            return Ok(());
        }
        Err("some checks could not run here; --allow-missing accepts that".to_owned())
    }
}

fn test(options: &TestOptions) -> Outcome {
    let mut checks = Checks::default();
    let found = match options.quick {
        true => None,
        false => {
            println!("== what tests need");
            Some(setup::tests(options.install)?)
        }
    };
    // In the order of their cost: a wrong format is told in seconds, a failed test after minutes.
    checks.run("format", || cargo(&["fmt", "--all", "--check"]))?;
    checks.run("dependencies between crates", arrows::check)?;
    checks.run("invariants", invariants::check)?;
    checks.run("counts", || count::run(&[]))?;
    checks.run("glossary", glossary::check)?;
    checks.run("pages", pages::check)?;
    checks.run("figures of the README", || figures::run(&[]))?;
    checks.run("licences", licences::check)?;
    checks.run("libraries of the wheel", python::shares_libraries)?;
    checks.run("lints", || {
        cargo(&["clippy", "--workspace", "--all-targets", "--profile", "ci", "--", "-D", "warnings"])
    })?;
    checks.run("documentation", || {
        let mut command = Command::new("cargo");
        // In the profile of the tests, whose dependencies are built already.
        command
            .args(["doc", "--workspace", "--no-deps", "--quiet", "--profile", "ci"])
            .env("RUSTDOCFLAGS", "-D warnings");
        run(&mut command)
    })?;
    // Tests bring features of libraries with them. So the program that they drive serves the checks below too; a build of
    // the program alone would compile all crates once more.
    checks.run("build of programs and tests", || {
        cargo(&["test", "--workspace", "--profile", "ci", "--no-run", "--quiet"])
    })?;
    let program = ci_program();
    checks.run("G-code hashes", || hashes::run(&["--binary", &program.to_string_lossy()]))?;
    checks.run("tests", || test_programs::run(&[]))?;
    checks.run("examples of the documentation", test_programs::run_examples)?;
    if let Some(found) = &found {
        // Tests that need files run only where the files are; the others are listed by name, not skipped
        // in silence.
        let ignored = ignored::find(&source::read(&root())?.tests)?;
        let (here, lacking) = ignored::split(&ignored, found);
        if !here.is_empty() {
            let names: Vec<&str> = here.iter().map(|t| t.name.as_str()).collect();
            checks.run(&format!("{} tests that need files or programs", here.len()), || {
                test_programs::run(&[&["--ignored", "--exact"], names.as_slice()].concat())
            })?;
        }
        if page::has_npm() {
            checks.run("the studio's page", || page::run(&[]))?;
        } else {
            checks.not_run.push("the studio's page lacks npm".to_owned());
        }
        checks.not_run.extend(lacking.iter().map(|(test, what)| format!("{} lacks {what}", test.name)));
        let browser = match page::has_npm() {
            true => setup::browser(options.install).map(drop),
            false => Err("npm is missing".to_owned()),
        };
        let package = setup::python_package(options.install);
        let names = ["the studio in a browser", "Python package"];
        let in_browser = || page::test_in_browser(&program);
        let in_python = || python::check(false);
        // The browser keeps 0.7 of two cores busy (305 s of processor time in 430 s), and the tests of the package one.
        match [&browser, &package].map(Result::is_ok) {
            [true, true] => checks.run_both(names, in_browser, in_python)?,
            [true, false] => checks.run(names[0], in_browser)?,
            [false, true] => checks.run(names[1], in_python)?,
            [false, false] => {}
        }
        for (name, missing) in names.iter().zip([browser, package]) {
            checks.not_run.extend(missing.err().map(|problem| format!("{name}: {problem}")));
        }
        checks.run("fuzz targets, compiled", fuzz::check)?;
    }
    checks.finish(options.allow_missing || options.quick)
}

/// The repository's top folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository").to_owned()
}

/// The folder that cargo builds in.
fn target() -> PathBuf {
    std::env::var("CARGO_TARGET_DIR").map_or_else(|_| root().join("target"), PathBuf::from)
}

/// The number of cores.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The program of the profile `ci`, which tests drive.
fn ci_program() -> PathBuf {
    target().join("ci").join(format!("grainpath{}", std::env::consts::EXE_SUFFIX))
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
