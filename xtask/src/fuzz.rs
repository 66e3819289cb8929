//! Builds the fuzz targets and runs them. The coverage passes of the stable compiler are enough; no nightly compiler is
//! needed. Executions are added up in `docs/fuzzing.md`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Options of the compiler that libFuzzer needs.
const FLAGS: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
                     -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
                     -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1 -Cdebug-assertions=on";

/// What is known of a target: executions so far, and edges of its parsers that the last run reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Known {
    executions: u64,
    edges: u64,
}

/// The page with the running totals.
const PAGE: &str = "docs/fuzzing.md";

const TEXT: &str = "# Fuzzing

Every reader of bytes has a target in `fuzz/fuzz_targets/`. `cargo xtask fuzz SECONDS --record` runs each that long and adds its executions here; `cargo xtask nightly` does so with 120 s. Edges are branches of the
compiled target that the last run reached with its corpus, as libFuzzer counts them. A crash, a hang of more than 10 s or more than 1 GiB of memory stops the run.

| target | executions so far | edges reached |
|---|---|---|
";

/// The rows of the page.
fn known(page: &str) -> BTreeMap<String, Known> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let count = |text: &str| text.replace(' ', "").parse().ok();
        let &[_, name, executions, edges, _] = cells.as_slice() else { return None };
        Some((
            name.trim_matches('`').to_owned(),
            Known { executions: count(executions)?, edges: count(edges)? },
        ))
    };
    page.lines().filter_map(row).collect()
}

/// A number with a blank before every three digits.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let first = digits.len() % 3;
    let groups = digits.as_bytes()[first..].chunks(3).map(|g| String::from_utf8_lossy(g).into_owned());
    let head = (first > 0).then(|| digits[..first].to_owned());
    head.into_iter().chain(groups).collect::<Vec<_>>().join(" ")
}

fn page(known: &BTreeMap<String, Known>) -> String {
    let mut text = TEXT.to_owned();
    for (name, row) in known {
        writeln!(text, "| `{name}` | {} | {} |", grouped(row.executions), grouped(row.edges)).expect("text");
    }
    let all: u64 = known.values().map(|row| row.executions).sum();
    writeln!(text, "| all | {} | |", grouped(all)).expect("text");
    text
}

/// What libFuzzer says at the end of a run.
fn outcome(log: &str) -> Option<Known> {
    let number = |text: &str| -> Option<u64> { text.split_whitespace().next()?.parse().ok() };
    let executions = log.rsplit("stat::number_of_executed_units:").next().and_then(number)?;
    let edges = log.rsplit("cov: ").next().and_then(number)?;
    Some(Known { executions, edges })
}

/// Arguments `[SECONDS] [--record]`.
///
/// # Errors
/// As [`run`].
pub fn command(words: &[&str], usage: &str) -> Result<(), String> {
    let record = words.contains(&"--record");
    match words.iter().filter(|w| **w != "--record").collect::<Vec<_>>().as_slice() {
        [] => run(20, record),
        [seconds] => run(seconds.parse().map_err(|_| usage.to_owned())?, record),
        _ => Err(usage.to_owned()),
    }
}

/// Compiles all targets as a check alone, which takes seconds; building and running them belongs to the nightly run.
pub fn check() -> Result<(), String> {
    // In the folder and the profile of the other lints, whose checked libraries serve again.
    let mut command = Command::new("cargo");
    command.args(["clippy", "--manifest-path", "fuzz/Cargo.toml", "--bins", "--locked", "--profile", "ci"]);
    crate::run(command.arg("--target-dir").arg(crate::target()).args(["--", "-D", "warnings"]))
}

/// Runs every target for `seconds`, and adds its executions to the page where that is asked for; a crash, a hang over
/// 10 s or more than 1 GiB fails.
pub fn run(seconds: u64, record: bool) -> Result<(), String> {
    let dir = crate::root().join("fuzz");
    let triple = crate::output(Command::new("rustc").args(["--print", "host-tuple"]))?.trim().to_owned();
    crate::run(
        Command::new("cargo")
            .args(["build", "--release", "--manifest-path", "fuzz/Cargo.toml", "--target", &triple, "--bins"])
            .env("RUSTFLAGS", FLAGS),
    )?;
    let mut targets: Vec<String> = fs::read_dir(dir.join("fuzz_targets"))
        .map_err(|e| format!("fuzz/fuzz_targets: {e}"))?
        .filter_map(|f| Some(f.ok()?.path().file_stem()?.to_string_lossy().into_owned()))
        .collect();
    targets.sort();
    let path = crate::root().join(PAGE);
    let before = if record { known(&fs::read_to_string(&path).unwrap_or_default()) } else { BTreeMap::new() };
    // Runs that are recorded go on from another seed each time, or they would count the same inputs again; the others
    // repeat themselves.
    let seed = 1 + before.values().map(|row| row.executions).sum::<u64>() % 1_000_000_000;
    // Each run is one thread: as many targets at once as there are cores.
    let mut all = BTreeMap::new();
    for together in targets.chunks(crate::cores()) {
        println!("-- fuzz {}, {seconds} s", together.join(" and "));
        let outcomes: Vec<Result<Known, String>> = std::thread::scope(|scope| {
            let runs: Vec<_> = together
                .iter()
                .map(|target| scope.spawn(|| run_one(target, &triple, seconds, seed)))
                .collect();
            runs.into_iter().map(|run| run.join().unwrap_or_else(|_| Err("a thread ended".into()))).collect()
        });
        for (target, outcome) in together.iter().zip(outcomes) {
            let found = outcome?;
            println!("   {target}: {} executions, {} edges", grouped(found.executions), grouped(found.edges));
            all.insert(target.clone(), found);
        }
    }
    let sum: u64 = all.values().map(|row| row.executions).sum();
    println!("{} fuzz targets ran clean, {} executions", targets.len(), grouped(sum));
    if record {
        for (name, row) in &mut all {
            row.executions += before.get(name).map_or(0, |old| old.executions);
        }
        fs::write(&path, page(&all)).map_err(|e| format!("{PAGE}: {e}"))?;
    }
    Ok(())
}

/// Folders of valid files that a target starts from, beside its corpus: those whose format has much in front of what is to be
/// reached.
fn seeds(target: &str) -> Vec<PathBuf> {
    let folders: &[&str] = match target {
        "volume" => &["xtask/seeds", "crates/grainpath-io/tests/dicom"],
        _ => &[],
    };
    folders.iter().map(|folder| crate::root().join(folder)).collect()
}

/// Runs a target for `seconds`, with this seed of its random numbers.
fn run_one(target: &str, triple: &str, seconds: u64, seed: u64) -> Result<Known, String> {
    let dir = crate::root().join("fuzz");
    let corpus = dir.join("corpus").join(target);
    let artifacts = dir.join("artifacts").join(target);
    for folder in [&corpus, &artifacts] {
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let mut command = Command::new(dir.join("target").join(triple).join("release").join(target));
    command.arg(&corpus).args(seeds(target)).args([
        format!("-max_total_time={seconds}"),
        "-timeout=10".into(),
        "-rss_limit_mb=1024".into(),
        "-malloc_limit_mb=512".into(),
        format!("-seed={seed}"),
        "-verbosity=1".into(),
        "-print_final_stats=1".into(),
        format!("-artifact_prefix={}/", artifacts.display()),
    ]);
    let out = command.output().map_err(|e| format!("cannot start {target}: {e}"))?;
    let log = String::from_utf8_lossy(&out.stderr);
    if !out.status.success() {
        let last: Vec<&str> = log.lines().rev().take(40).collect();
        let last: Vec<&str> = last.into_iter().rev().collect();
        return Err(format!("fuzz target {target} failed:\n{}", last.join("\n")));
    }
    outcome(&log).ok_or_else(|| format!("fuzz target {target} told no number of executions"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_survive_the_page() {
        let row = |executions, edges| Known { executions, edges };
        let all = BTreeMap::from([("gcode".to_owned(), row(1_234_567, 890)), ("job".to_owned(), row(12, 3))]);
        let text = page(&all);
        assert!(
            text.contains("| `gcode` | 1 234 567 | 890 |") && text.contains("| all | 1 234 579 | |"),
            "{text}"
        );
        assert_eq!(known(&text), all);
    }

    #[test]
    fn the_end_of_a_run_is_read() {
        let log = "#2 INITED cov: 12 ft: 13\n#900 NEW    cov: 345 ft: 400 corp: 8\nDone 5000 runs\n\
                   stat::number_of_executed_units: 5000\nstat::average_exec_per_sec:     2500\n";
        assert_eq!(outcome(log), Some(Known { executions: 5000, edges: 345 }));
        assert_eq!(outcome("ended"), None);
    }
}
