//! `cargo xtask python`: builds the wheel of the Python package, installs it into the virtual environment, and runs
//! its tests and the examples of its documentation.
//!
//! The wheel is built in the profile and the folder of all other tests, so that only the module itself is compiled
//! anew. With `--release` it is built as it is published: from the source distribution, unpacked elsewhere, whose
//! crates are then all compiled again; on Linux against the C library of manylinux2014 (glibc 2.17, of 2012), by zig's
//! linker. Such a wheel is held against its goals: its size, the stable interface of Python (abi3audit), the platform
//! that its name promises (auditwheel), and the time that importing it takes; and its notebooks are run.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{measured, output, run, setup};

/// Largest wheel, bytes. Source: chosen; a requirement of the project.
const MAX_WHEEL_BYTES: u64 = 8_000_000;
/// Longest time to import the package after numpy, ms of processor time. Source: chosen; a requirement of the project.
const MAX_IMPORT_MS: f64 = 60.0;
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
    // Its lines are shown as they come: the bench takes up to an hour. Those that it keeps stand in a file.
    let kept = crate::target().join("bench_python.txt");
    let _ = fs::remove_file(&kept);
    let ran = run(setup::python().arg("-P").arg(script).args(words).env("GRAINPATH_MEASURED", &kept));
    // A bench that ended before its first figure has left no file, and says itself why.
    match fs::read_to_string(&kept) {
        Ok(text) => {
            measured::keep_lines(&text)?;
        }
        Err(e) if ran.is_ok() => return Err(format!("{}: {e}", kept.display())),
        Err(_) => {}
    }
    ran
}

/// The same with what is installed.
pub fn check(release: bool) -> Result<(), String> {
    let wheel = install(release)?;
    let import_ms = import_ms()?;
    println!("import: {import_ms:.1} ms more than numpy's, processor time");
    if release {
        if import_ms > MAX_IMPORT_MS {
            return Err(format!("importing takes {import_ms:.1} ms; at most {MAX_IMPORT_MS} are allowed"));
        }
        audit(&wheel)?;
    }
    let tests = crate::root().join("crates/grainpath-py/tests");
    let mut command = setup::python();
    // `-P` keeps the folder of the sources out of the path: the installed package is tested.
    command
        .args(["-P", "-m", "pytest", "--quiet", "-p", "no:cacheprovider", "--pyargs", "grainpath"])
        .arg(tests);
    run(&mut command)?;
    if release {
        setup::python_notebooks()?;
        let script = crate::root().join("xtask/py/run_notebooks.py");
        run(setup::python().arg("-P").arg(script).arg(crate::target().join("notebooks")))?;
    }
    Ok(())
}

/// Holds a wheel against the stable interface of Python, and its name against the libraries that it needs.
fn audit(wheel: &Path) -> Result<(), String> {
    setup::python_audit()?;
    run(setup::python().args(["-m", "abi3audit", "--strict"]).arg(wheel))?;
    // Other systems have no such promise in the name of a wheel.
    if cfg!(target_os = "linux") {
        let name = wheel.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let platform = name.rsplit('-').next().unwrap_or_default();
        let told = output(setup::python().args(["-m", "auditwheel", "show"]).arg(wheel))?;
        let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
        println!("{told}");
        // The first platform that is told is the oldest one that has all the libraries.
        let oldest = told.split('"').find(|word| word.starts_with("manylinux") || word.starts_with("linux"));
        if !platform.starts_with("manylinux") || !oldest.is_some_and(|p| platform.split('.').any(|q| q == p))
        {
            return Err(format!("{platform} in the name of the wheel, and auditwheel finds {oldest:?}"));
        }
    }
    Ok(())
}

/// Builds the wheel and installs it into the virtual environment.
fn install(release: bool) -> Result<PathBuf, String> {
    let wheels = crate::target().join("wheels");
    // Wheels of older versions would be found too.
    let _ = fs::remove_dir_all(&wheels);
    if release {
        from_sdist(&wheels)?
    } else {
        build(Path::new(MANIFEST), &wheels, "ci", &["--locked"])?
    }
    let wheel = only(&wheels, "whl")?;
    let bytes = fs::metadata(&wheel).map_err(|e| format!("{}: {e}", wheel.display()))?.len();
    println!("{}: {:.2} MB", wheel.file_name().unwrap_or_default().to_string_lossy(), bytes as f64 / 1e6);
    if release && bytes > MAX_WHEEL_BYTES {
        return Err(format!("the wheel has {bytes} bytes; at most {MAX_WHEEL_BYTES} are allowed"));
    }
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"];
    run(setup::python().args(install).arg("--force-reinstall").arg(&wheel))?;
    Ok(wheel)
}

/// Fails where the wheel asks a library of others for features with which the programs and tests do not have it: that
/// library, and all that stands on it, would be compiled once more for the wheel.
pub fn shares_libraries() -> Result<(), String> {
    let tree = |of: &[&str]| -> Result<BTreeSet<String>, String> {
        let mut command = Command::new("cargo");
        command
            .args(["tree", "--locked", "--prefix", "none", "--no-dedupe", "--format", "{p} [{f}]"])
            .args(of);
        let told = output(command.current_dir(crate::root()))?;
        Ok(told.lines().map(|line| line.replace(" (*)", "").replace(" (proc-macro)", "")).collect())
    };
    let wheel = tree(&["--package", "grainpath-py", "--edges", "normal,build"])?;
    let programs = tree(&["--workspace", "--edges", "all"])?;
    // Crates of ours name their folder; the program in the wheel is without the studio.
    let differ: Vec<&str> =
        wheel.difference(&programs).map(String::as_str).filter(|p| !p.contains('/')).collect();
    if differ.is_empty() {
        return Ok(());
    }
    Err(format!("the wheel has {} with other features than the programs: see {MANIFEST}", differ.join(", ")))
}

/// Builds the wheel of a manifest.
fn build(manifest: &Path, wheels: &Path, profile: &str, more: &[&str]) -> Result<(), String> {
    let mut command = setup::python();
    // Maturin asks the Python that this names for zig's linker.
    command.env("CARGO_ZIGBUILD_PYTHON_PATH", setup::interpreter());
    command.args(["-m", "maturin", "build", "--quiet", "--profile", profile]).args(more);
    run(command
        .arg("--manifest-path")
        .arg(manifest)
        .arg("--out")
        .arg(wheels)
        .args(["--interpreter", &setup::interpreter()]))
}

/// Makes the source distribution, unpacks it, and builds the wheel of it.
fn from_sdist(wheels: &Path) -> Result<(), String> {
    let mut command = setup::python();
    command.args(["-m", "maturin", "sdist", "--manifest-path", MANIFEST, "--out"]);
    run(command.arg(wheels))?;
    let sdist = only(wheels, "gz")?;
    run(Command::new("tar").arg("-xzf").arg(&sdist).arg("-C").arg(wheels))?;
    let folder = sdist.file_name().unwrap_or_default().to_string_lossy().replace(".tar.gz", "");
    let unpacked = wheels.join(folder);
    // The members of the workspace that the package does not need are left out of the source distribution. Cargo then
    // takes them out of the lock, which `--locked` would refuse; that nothing else changes is checked instead.
    // Measured: at the highest level the wheel has 7.78 MB, at maturin's own 8.03 MB; packing takes 2 s longer.
    let mut options = vec!["--compression-level", "9"];
    if cfg!(target_os = "linux") {
        setup::zig()?;
        options.extend(["--zig", "--compatibility", "manylinux2014"]);
    }
    build(&unpacked.join(MANIFEST), wheels, "wheel", &options)?;
    let read = |path: PathBuf| fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()));
    let (ours, theirs) = (read(crate::root().join("Cargo.lock"))?, read(unpacked.join("Cargo.lock"))?);
    match not_in(&theirs, &ours) {
        Some(package) => Err(format!("the source distribution was built with another {package}")),
        None => Ok(()),
    }
}

/// The first package of a lock that another lock has not, or has in another version.
fn not_in(lock: &str, other: &str) -> Option<String> {
    let packages = |lock: &str| -> Vec<String> {
        let head = |block: &str| block.lines().take(4).map(str::trim).collect::<Vec<_>>().join(" ");
        lock.split("[[package]]").skip(1).map(|block| head(block).trim().to_owned()).collect()
    };
    let known = packages(other);
    packages(lock).into_iter().find(|package| !known.contains(package))
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

/// Time to import the package after numpy, the least of five, ms. It is processor time: that of a clock is four to ten
/// times longer on a machine whose cores are all busy.
fn import_ms() -> Result<f64, String> {
    let code =
        "import numpy, time; t = time.process_time(); import grainpath; print(time.process_time() - t)";
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let text = output(setup::python().args(["-P", "-c", code]))?;
        let seconds: f64 = text.trim().parse().map_err(|_| format!("a number, and not {text:?}"))?;
        least = least.min(1e3 * seconds);
    }
    Ok(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_may_only_lack_packages() {
        let package = |name: &str, version: &str| {
            format!("[[package]]\nname = \"{name}\"\nversion = \"{version}\"\nsource = \"registry\"\n\n")
        };
        let (a, b) = (package("a", "1.0.0"), package("b", "2.0.0"));
        assert_eq!(not_in(&a, &format!("{a}{b}")), None);
        let changed = not_in(&format!("{a}{}", package("b", "2.0.1")), &format!("{a}{b}"));
        assert!(changed.is_some_and(|p| p.contains("\"b\"") && p.contains("2.0.1")));
    }
}
