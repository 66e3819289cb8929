//! Which crate may use which: the table that `ARCHITECTURE.md` explains, held against what cargo sees.

use std::fs;
use std::process::Command;

use serde_json::Value;

const CORE: &str = "grainpath-core";
const IO: &str = "grainpath-io";
const GCODE: &str = "grainpath-gcode";
const FEA: &str = "grainpath-fea";
const JOB: &str = "grainpath-job";
const IMAGING: &str = "grainpath-imaging";

/// Each crate of ours and the crates of ours that it may name.
const ALLOWED: [(&str, &[&str]); 14] = [
    ("grainpath-core", &[]),
    ("grainpath-io", &["grainpath-core"]),
    ("grainpath-gcode", &["grainpath-core"]),
    ("grainpath-fea", &["grainpath-core"]),
    ("grainpath-job", &["grainpath-core"]),
    ("grainpath-imaging", &["grainpath-core"]),
    // `grainpath-parts` for tests alone: synthetic boards know the truth.
    ("grainpath", &[CORE, IO, GCODE, FEA, JOB, IMAGING, "grainpath-parts"]),
    ("grainpath-view", &[CORE, GCODE, FEA, IMAGING, "grainpath"]),
    ("grainpath-parts", &[CORE, IO, JOB, IMAGING, "grainpath"]),
    // The planner and `grainpath-io` for tests alone.
    ("grainpath-studio", &[CORE, IO, GCODE, JOB, "grainpath"]),
    (
        "grainpath-cli",
        &[
            CORE,
            IO,
            GCODE,
            FEA,
            JOB,
            IMAGING,
            "grainpath",
            "grainpath-view",
            "grainpath-parts",
            "grainpath-studio",
        ],
    ),
    (
        "grainpath-py",
        &[
            CORE,
            IO,
            GCODE,
            FEA,
            JOB,
            IMAGING,
            "grainpath",
            "grainpath-view",
            "grainpath-parts",
            "grainpath-cli",
        ],
    ),
    // `grainpath-parts` for tests alone.
    ("grainpath-wasm", &[CORE, IO, GCODE, JOB, IMAGING, "grainpath", "grainpath-view", "grainpath-parts"]),
    ("xtask", &[]),
];

/// Crates from outside that only one crate of ours may name, so that each can be replaced in one place.
const KEPT_TO: [(&str, &str); 6] = [
    ("i_overlay", "grainpath-core"),
    ("clipper2-rust", "grainpath-core"),
    ("spade", "grainpath-core"),
    ("amd", "grainpath-fea"),
    ("pyo3", "grainpath-py"),
    ("numpy", "grainpath-py"),
];

pub fn check() -> Result<(), String> {
    let packages = packages()?;
    let page = fs::read_to_string(crate::root().join("ARCHITECTURE.md"))
        .map_err(|e| format!("ARCHITECTURE.md: {e}"))?;
    for (name, dependencies) in &packages {
        let Some((_, allowed)) = ALLOWED.iter().find(|(n, _)| n == name) else {
            return Err(format!("crate {name} is not in the table of xtask/src/arrows.rs"));
        };
        // The page explains the table; a crate that it leaves out has no explanation.
        if !page.contains(&format!("`{name}`")) {
            return Err(format!("ARCHITECTURE.md does not name the crate `{name}`"));
        }
        for dependency in dependencies {
            if dependency.starts_with("grainpath") && !allowed.contains(&dependency.as_str()) {
                return Err(format!("{name} must not depend on {dependency}"));
            }
            if let Some((_, keeper)) = KEPT_TO.iter().find(|(d, k)| d == dependency && k != name) {
                return Err(format!("{dependency} is named in {keeper} only, not in {name}"));
            }
        }
    }
    // A row without a crate would go on allowing what nobody uses.
    if let Some((gone, _)) = ALLOWED.iter().find(|(n, _)| !packages.iter().any(|(p, _)| p == n)) {
        return Err(format!("crate {gone} is in the table of xtask/src/arrows.rs and is gone"));
    }
    println!("{} crates, arrows only down", packages.len());
    Ok(())
}

/// Our crates and the names of what they depend on.
fn packages() -> Result<Vec<(String, Vec<String>)>, String> {
    let metadata = metadata(&["--no-deps"])?;
    let name = |v: &Value| v["name"].as_str().unwrap_or_default().to_owned();
    let list = |v: &Value| v.as_array().cloned().unwrap_or_default();
    let of = |p: &Value| (name(p), list(&p["dependencies"]).iter().map(name).collect());
    Ok(list(&metadata["packages"]).iter().map(of).collect())
}

/// The answer of `cargo metadata`.
pub fn metadata(args: &[&str]) -> Result<Value, String> {
    let mut command = Command::new("cargo");
    // `--locked` fails instead of changing the lock file: a check must not change what it checks.
    command.args(["metadata", "--format-version", "1", "--locked"]).args(args).current_dir(crate::root());
    serde_json::from_str(&crate::output(&mut command)?).map_err(|e| format!("cargo metadata: {e}"))
}
