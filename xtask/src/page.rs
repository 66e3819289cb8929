//! The studio's page: bundles `web/` and compares it with what is committed in `crates/grainpath-studio/dist/`; and its
//! tests in a real browser.
//!
//! `web/build.mjs` bundles the viewer of notebooks too, into the Python package, and compares it itself.
//!
//! The bundle is committed, so that building grainpath needs no JavaScript tools. `npm ci` installs exactly what
//! `web/package-lock.json` names, without running scripts of packages; esbuild gives the same bytes for the same input.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::setup;

/// Whether npm is there.
pub fn has_npm() -> bool {
    Command::new("npm").arg("--version").output().is_ok_and(|o| o.status.success())
}

fn web() -> PathBuf {
    crate::root().join("web")
}

/// Installs the packages that `web/package-lock.json` names.
pub fn install() -> Result<(), String> {
    let mut command = Command::new("npm");
    command.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"]);
    // Playwright would download a browser of its own.
    command.env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1").current_dir(web());
    crate::output(&mut command).map(drop)
}

/// Bundles the page and compares it with the committed one, or writes it.
pub fn run(words: &[&str]) -> Result<(), String> {
    let write = match words {
        [] => false,
        ["--write"] => true,
        _ => return Err("usage: cargo xtask page [--write]".to_owned()),
    };
    if !has_npm() {
        return Err("npm is missing; Node.js 20 or later brings it".to_owned());
    }
    install()?;
    let dist = crate::root().join("crates/grainpath-studio/dist");
    let out = if write { dist.clone() } else { crate::target().join("page") };
    crate::output(Command::new("npm").args(["run", "--silent", "types"]).current_dir(web()))?;
    crate::output(Command::new("node").arg("build.mjs").arg(&out).current_dir(web()))?;
    let names = |folder: &Path| -> Result<Vec<String>, String> {
        let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut names: Vec<String> =
            entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        Ok(names)
    };
    let (made, committed) = (names(&out)?, names(&dist)?);
    if made != committed {
        return Err(format!("web/ makes {made:?} and crates/grainpath-studio/dist holds {committed:?}"));
    }
    for name in &made {
        let read = |folder: &Path| fs::read(folder.join(name)).map_err(|e| format!("{name}: {e}"));
        if read(&out)? != read(&dist)? {
            return Err(format!(
                "{name} in dist/ is not what web/ makes; `cargo xtask page --write` renews it"
            ));
        }
    }
    println!("{} files of the page are what web/ makes", made.len());
    Ok(())
}

/// Runs the tests of the page in a browser against a program that is built already.
pub fn test_in_browser(binary: &Path) -> Result<(), String> {
    node(binary, &["--test", "--test-concurrency=1", "tests/"], "tests of the page failed")
}

/// Measures the studio in a browser and prints the figures beside those asked for.
pub fn bench(binary: &Path) -> Result<(), String> {
    node(binary, &["bench/studio.mjs"], "the bench failed")
}

/// Asks axe about every page of a folder of HTML, as readers with impairments meet it.
pub fn ask_axe(folder: &Path) -> Result<(), String> {
    let browser = setup::browser(false)?;
    install()?;
    let mut command = Command::new("node");
    command.arg("book.mjs").arg(folder).current_dir(web()).env("BROWSER", browser);
    ended_well(&mut command, "axe found what readers stumble over")
}

/// Runs scripts of the page in Node, with a program and a browser.
fn node(binary: &Path, words: &[&str], failed: &str) -> Result<(), String> {
    let browser = setup::browser(false)?;
    install()?;
    let mut command = Command::new("node");
    command.args(words).current_dir(web());
    command.env("GRAINPATH", binary).env("BROWSER", browser);
    ended_well(&mut command, failed)
}

fn ended_well(command: &mut Command, failed: &str) -> Result<(), String> {
    let status = command.status().map_err(|e| format!("node: {e}"))?;
    if status.success() { Ok(()) } else { Err(failed.to_owned()) }
}
