//! `cargo xtask python`: builds the wheel of the Python package, installs it into the virtual environment, and runs
//! its tests and the examples of its documentation.
//!
//! The wheel is built in the profile and the folder of all other tests, so that only the module itself is compiled
//! anew. With `--release` it is built as it is published: from the source distribution, unpacked elsewhere, whose
//! crates are then all compiled again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{output, run, setup};

/// Largest wheel, bytes. Source: issue 19 of the tracker, 8 MB.
const MAX_WHEEL_BYTES: u64 = 8_000_000;
/// The manifest of the crate.
const MANIFEST: &str = "crates/grainpath-py/Cargo.toml";

/// Builds, installs and tests; `words` may be `--release`.
pub fn command(words: &[&str]) -> Result<(), String> {
    let release = match words {
        [] => false,
        ["--release"] => true,
        _ => return Err("usage: cargo xtask python [--release]".to_owned()),
    };
    setup::python_package(true)?;
    check(release)
}

/// Builds the wheel as it is published, and measures what it costs.
pub fn bench(words: &[&str]) -> Result<(), String> {
    setup::python_package(true)?;
    install(true)?;
    let script = crate::root().join("xtask/py/bench_python.py");
    run(setup::python().arg("-P").arg(script).args(words))
}

/// The same with what is installed.
pub fn check(release: bool) -> Result<(), String> {
    install(release)?;
    println!("import: {:.1} ms more than numpy's", import_ms()?);
    let tests = crate::root().join("crates/grainpath-py/tests");
    let mut command = setup::python();
    // `-P` keeps the folder of the sources out of the path: the installed package is tested.
    command
        .args(["-P", "-m", "pytest", "--quiet", "-p", "no:cacheprovider", "--pyargs", "grainpath"])
        .arg(tests);
    run(&mut command)
}

/// Builds the wheel and installs it into the virtual environment.
fn install(release: bool) -> Result<(), String> {
    let wheels = crate::target().join("wheels");
    // Wheels of older versions would be found too.
    let _ = fs::remove_dir_all(&wheels);
    if release {
        from_sdist(&wheels)?
    } else {
        build(Path::new(MANIFEST), &wheels, "ci")?
    }
    let wheel = only(&wheels, "whl")?;
    let bytes = fs::metadata(&wheel).map_err(|e| format!("{}: {e}", wheel.display()))?.len();
    println!("{}: {:.2} MB", wheel.file_name().unwrap_or_default().to_string_lossy(), bytes as f64 / 1e6);
    if release && bytes > MAX_WHEEL_BYTES {
        return Err(format!("the wheel has {bytes} bytes; at most {MAX_WHEEL_BYTES} are allowed"));
    }
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"];
    run(setup::python().args(install).arg("--force-reinstall").arg(&wheel))
}

/// Builds the wheel of a manifest.
fn build(manifest: &Path, wheels: &Path, profile: &str) -> Result<(), String> {
    let mut command = setup::python();
    command.args(["-m", "maturin", "build", "--quiet", "--locked", "--profile", profile, "--manifest-path"]);
    run(command.arg(manifest).arg("--out").arg(wheels).args(["--interpreter", &setup::interpreter()]))
}

/// Makes the source distribution, unpacks it, and builds the wheel of it.
fn from_sdist(wheels: &Path) -> Result<(), String> {
    let mut command = setup::python();
    command.args(["-m", "maturin", "sdist", "--quiet", "--manifest-path", MANIFEST, "--out"]);
    run(command.arg(wheels))?;
    let sdist = only(wheels, "gz")?;
    run(Command::new("tar").arg("-xzf").arg(&sdist).arg("-C").arg(wheels))?;
    let folder = sdist.file_name().unwrap_or_default().to_string_lossy().replace(".tar.gz", "");
    build(&wheels.join(folder).join(MANIFEST), wheels, "release")
}

/// The only file with an ending.
fn only(folder: &Path, ending: &str) -> Result<PathBuf, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut found =
        entries.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == ending));
    match (found.next(), found.next()) {
        (Some(one), None) => Ok(one),
        _ => Err(format!("{}: one .{ending} is needed", folder.display())),
    }
}

/// Time to import the package after numpy, the least of five, ms.
fn import_ms() -> Result<f64, String> {
    let code =
        "import numpy, time; t = time.perf_counter(); import grainpath; print(time.perf_counter() - t)";
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let text = output(setup::python().args(["-P", "-c", code]))?;
        let seconds: f64 = text.trim().parse().map_err(|_| format!("a number, and not {text:?}"))?;
        least = least.min(1e3 * seconds);
    }
    Ok(least)
}
