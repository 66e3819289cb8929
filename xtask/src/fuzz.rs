//! Builds the fuzz targets and runs them briefly. The coverage passes of the stable compiler are enough;
//! no nightly compiler is needed.

use std::fs;
use std::process::Command;

/// Options of the compiler that libFuzzer needs.
const FLAGS: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
                     -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
                     -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1 -Cdebug-assertions=on";

/// Runs every target for `seconds`; a crash, a hang over 10 s or more than 1 GiB fails.
pub fn run(seconds: u64) -> Result<(), String> {
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
    for target in &targets {
        println!("-- fuzz {target}, {seconds} s");
        let corpus = dir.join("corpus").join(target);
        let artifacts = dir.join("artifacts").join(target);
        for folder in [&corpus, &artifacts] {
            fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        }
        let mut command = Command::new(dir.join("target").join(&triple).join("release").join(target));
        command.arg(&corpus).args([
            format!("-max_total_time={seconds}"),
            "-timeout=10".into(),
            "-rss_limit_mb=1024".into(),
            "-malloc_limit_mb=512".into(),
            "-seed=1".into(),
            "-verbosity=0".into(),
            "-print_final_stats=0".into(),
            format!("-artifact_prefix={}/", artifacts.display()),
        ]);
        crate::run(&mut command).map_err(|e| format!("fuzz target {target} failed: {e}"))?;
    }
    println!("{} fuzz targets ran clean", targets.len());
    Ok(())
}
