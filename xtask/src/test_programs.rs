//! Runs all tests of the workspace.
//!
//! `cargo test` runs one test program after the other, so that the other cores wait for the last tests of each. Here as
//! many programs run at once as there are cores, each with one test at a time. Measured on two cores: 824 s with
//! `cargo test`, about 120 of them in one test that has become fast since, and 490 s so.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use serde_json::Value;

use crate::{Outcome, cargo, cores, output, root, setup};

/// Programs that take longest, begun first, so that at the end no core waits for one of them. Measured on two cores, s: 140,
/// 133, 102, 91, 86, 74, 65, 61, 58; no other takes more than 40. In the order of cargo the second of them began last.
const LONGEST: [&str; 9] = [
    "grainpath-cli density",
    "grainpath-fea wall_bending",
    "grainpath-cli strength",
    "grainpath-fea grainpath_fea",
    "grainpath-cli interrupts",
    "grainpath grainpath",
    "grainpath-cli reserve",
    "grainpath-imaging grainpath_imaging",
    "grainpath-fea strength",
];

/// A test program.
struct Program {
    /// Its package and its target, as `grainpath-cli strength`.
    name: String,
    path: PathBuf,
    /// The folder of its package, in which tests expect to run.
    folder: PathBuf,
}

/// Builds all test programs and runs them with these arguments. Programs that fail do not keep the others from running.
pub fn run(words: &[&str]) -> Outcome {
    let mut programs = programs()?;
    programs.sort_by_key(|p| LONGEST.iter().position(|name| *name == p.name).unwrap_or(LONGEST.len()));
    let (next, passed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || {
        let mut failed = Vec::new();
        while let Some(program) = programs.get(next.fetch_add(1, Ordering::Relaxed)) {
            match program.run(words) {
                Ok(n) => {
                    passed.fetch_add(n, Ordering::Relaxed);
                }
                Err(problem) => {
                    println!("{problem}");
                    failed.push(program.name.as_str());
                }
            }
        }
        failed
    };
    let failed: Vec<&str> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores()).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|w| w.join().expect("no worker panics")).collect()
    });
    if !failed.is_empty() {
        return Err(format!("tests failed in {}", failed.join(", ")));
    }
    match passed.into_inner() {
        0 => Err("no test ran".to_owned()),
        n => {
            println!("{n} tests passed");
            Ok(())
        }
    }
}

/// Runs the examples of the documentation.
pub fn run_examples() -> Outcome {
    cargo(&["test", "--workspace", "--profile", "ci", "--doc", "--quiet"])
}

/// All test programs, built where they are not yet.
fn programs() -> Result<Vec<Program>, String> {
    let mut command = Command::new("cargo");
    command.args(["test", "--workspace", "--profile", "ci", "--no-run", "--quiet", "--message-format=json"]);
    let lines = output(command.current_dir(root()))?;
    let messages = lines.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    Ok(messages.filter_map(|message| program(&message)).collect())
}

/// The test program of which a message of cargo tells.
fn program(message: &Value) -> Option<Program> {
    // Messages of other programs than tests name an executable too.
    if message["profile"]["test"] != true {
        return None;
    }
    let path = PathBuf::from(message["executable"].as_str()?);
    let folder = Path::new(message["manifest_path"].as_str()?).parent()?.to_owned();
    let package = folder.file_name()?.to_string_lossy().into_owned();
    Some(Program { name: format!("{package} {}", message["target"]["name"].as_str()?), path, folder })
}

impl Program {
    /// Runs its tests and gives the number of those that passed, or all that was printed when one fails.
    fn run(&self, words: &[&str]) -> Result<usize, String> {
        let mut command = Command::new(&self.path);
        command.args(words).current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        // A fixed seed makes property tests try the same cases on each run; `cargo test` alone draws new
        // ones. Snapshots are compared and not rewritten.
        command.env("PROPTEST_RNG_SEED", "20").env("INSTA_UPDATE", "no").env("RUST_TEST_THREADS", "1");
        let start = Instant::now();
        let out = setup::export(&mut command).output().map_err(|e| format!("{}: {e}", self.name))?;
        let told = String::from_utf8_lossy(&out.stdout);
        if !out.status.success() {
            let errors = String::from_utf8_lossy(&out.stderr);
            return Err(format!("-- {}: {}\n{told}\n{errors}", self.name, out.status));
        }
        let passed = passed(&told).ok_or_else(|| format!("{} told no result:\n{told}", self.name))?;
        if passed > 0 {
            println!("{:7.1} s  {}: {passed} passed", start.elapsed().as_secs_f64(), self.name);
        }
        Ok(passed)
    }
}

/// The number of tests that passed, from what a test program prints last.
fn passed(told: &str) -> Option<usize> {
    told.rsplit_once("test result: ok. ")?.1.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{passed, program};

    #[test]
    fn messages_of_cargo_name_test_programs_alone() {
        let message = |test: bool| {
            json!({ "reason": "compiler-artifact", "manifest_path": "/x/crates/grainpath-io/Cargo.toml",
                "target": { "name": "hostile" }, "profile": { "test": test }, "executable": "/x/target/hostile-1" })
        };
        let found = program(&message(true)).expect("a test program");
        assert_eq!(
            (found.name.as_str(), found.folder.ends_with("grainpath-io")),
            ("grainpath-io hostile", true)
        );
        assert!(program(&message(false)).is_none());
        assert!(program(&json!({ "reason": "build-finished", "success": true })).is_none());
    }

    #[test]
    fn the_number_that_passed_is_read() {
        let told = "running 2 tests\n..\ntest result: ok. 2 passed; 0 failed; 1 ignored; finished in 0.1s\n";
        assert_eq!(passed(told), Some(2));
        assert_eq!(passed("test result: FAILED. 1 passed; 1 failed"), None);
    }
}
