//! Dependencies may have the licences and come from the registries that `deny.toml` lists.
//!
//! `cargo deny check` reads the same file and checks more (duplicates, advisories); the GitHub workflow
//! runs it. Here the crate `spdx` reads the expressions, so this check needs no tool that has to be built
//! first. The time to build cargo-deny in a clean checkout has not been measured.

use std::fs;

use serde_json::Value;
use spdx::{Expression, ParseMode};

/// Checks every dependency of every crate of ours.
pub fn check() -> Result<(), String> {
    let text = fs::read_to_string(crate::root().join("deny.toml")).map_err(|e| format!("deny.toml: {e}"))?;
    let page: toml::Table = text.parse().map_err(|e| format!("deny.toml: {e}"))?;
    let list = |section: &str, key: &str| -> Vec<String> {
        let values = page.get(section).and_then(|s| s.get(key)).and_then(toml::Value::as_array);
        values.into_iter().flatten().filter_map(|v| v.as_str().map(str::to_owned)).collect()
    };
    let (allowed, registries) = (list("licenses", "allow"), list("sources", "allow-registry"));
    let metadata = crate::arrows::metadata(&[])?;
    let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
    let text = |package: &Value, key: &str| package[key].as_str().map(str::to_owned);
    let mut refused = Vec::new();
    for package in &packages {
        let name = format!("{} {}", package["name"], package["version"]);
        let licence = text(package, "license").unwrap_or_default();
        if !allows(&licence, &allowed) {
            refused.push(format!("{name} has the licence {licence:?}"));
        }
        // Crates of the workspace have no source.
        if let Some(source) = text(package, "source")
            && !registries.iter().any(|r| source.strip_prefix("registry+") == Some(r))
        {
            refused.push(format!("{name} comes from {source}"));
        }
    }
    if refused.is_empty() {
        println!("{} packages, all with licences and sources of deny.toml", packages.len());
        return Ok(());
    }
    Err(format!("not allowed by deny.toml: {}", refused.join(", ")))
}

/// Whether an SPDX expression can be met with the licences allowed.
fn allows(expression: &str, allowed: &[String]) -> bool {
    // Old manifests join licences by a slash, which the strict grammar of SPDX refuses.
    Expression::parse_mode(expression, ParseMode::LAX)
        .is_ok_and(|e| e.evaluate(|licence| allowed.iter().any(|a| *a == licence.to_string())))
}

#[cfg(test)]
mod tests {
    use super::allows;

    #[test]
    fn expressions_are_met_by_one_of_each_or_and_all_of_each_and() {
        let allowed =
            ["MIT", "Apache-2.0", "Zlib", "Unicode-3.0", "Apache-2.0 WITH LLVM-exception"].map(str::to_owned);
        for yes in [
            "MIT",
            "MIT OR GPL-3.0-only",
            "MIT/Apache-2.0",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Zlib AND MIT",
            "Apache-2.0 WITH LLVM-exception OR GPL-2.0-only",
        ] {
            assert!(allows(yes, &allowed), "{yes}");
        }
        for no in [
            "GPL-3.0-only",
            "MIT AND GPL-3.0-only",
            "(MIT OR Apache-2.0) AND LGPL-2.1-only",
            "",
            "AGPL-3.0-only OR LGPL-3.0-only",
        ] {
            assert!(!allows(no, &allowed), "{no}");
        }
    }
}
