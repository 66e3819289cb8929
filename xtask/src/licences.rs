//! Dependencies may have the licences and come from the registries that `deny.toml` lists.
//!
//! `cargo deny check` reads the same file and checks more (duplicates, advisories); the GitHub workflow
//! runs it. Here the crate `spdx` reads the expressions, so this check needs no tool that has to be built
//! first. Measured: `cargo install cargo-deny --locked` takes 350 s of processor time, a ninth of what a clean
//! run of all tests may take on two cores; cargo-deny 0.20.2 then agrees with this check (`bans ok, licenses
//! ok, sources ok`).

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

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
    if !refused.is_empty() {
        return Err(format!("not allowed by deny.toml: {}", refused.join(", ")));
    }
    println!("{} packages, all with licences and sources of deny.toml", packages.len());
    for wanted in &NOTICES {
        let there = fs::read_to_string(crate::root().join(wanted.file)).unwrap_or_default();
        if there != notices(wanted, &metadata)? {
            return Err(format!(
                "{} is not what the libraries say; `cargo xtask licences` writes it",
                wanted.file
            ));
        }
    }
    Ok(())
}

/// The licences of what a crate of ours is built with.
struct Notices {
    package: &'static str,
    file: &'static str,
    /// Files whose texts follow.
    more: &'static [&'static str],
}

/// What `grainpath licences` prints, and what a wheel holds: there our own texts and those of the viewer's packages are in it.
const NOTICES: [Notices; 2] = [
    Notices { package: "grainpath-cli", file: "crates/grainpath-cli/licences.txt", more: &[] },
    Notices {
        package: "grainpath-py",
        file: "crates/grainpath-py/licences.txt",
        more: &["LICENSE-MIT", "LICENSE-APACHE", "crates/grainpath-studio/dist/licences.txt"],
    },
];

/// Writes the notices of the libraries again.
pub fn write() -> Result<(), String> {
    let metadata = crate::arrows::metadata(&[])?;
    for wanted in &NOTICES {
        let (file, text) = (wanted.file, notices(wanted, &metadata)?);
        fs::write(crate::root().join(file), &text).map_err(|e| format!("{file}: {e}"))?;
        println!("{file}: {} bytes", text.len());
    }
    Ok(())
}

/// Names, licences and licence texts of all libraries that a crate of ours is built with, on any system.
fn notices(wanted: &Notices, metadata: &Value) -> Result<String, String> {
    let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
    let used = used_by(wanted.package, metadata)?;
    let mut table = String::new();
    // Equal texts are printed once, whatever names stand in their copyright lines.
    let mut texts: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in packages.iter().filter(|p| used.contains(p["id"].as_str().unwrap_or_default())) {
        let text = |key: &str| package[key].as_str().unwrap_or_default();
        if text("source").is_empty() {
            continue;
        }
        let name = format!("{} {}", text("name"), text("version"));
        table += &format!("{name:<36} {}\n", text("license"));
        let folder = Path::new(text("manifest_path")).parent().map(Path::to_owned).unwrap_or_default();
        let mut contents = Vec::new();
        for file in licence_files(&folder)? {
            let content = fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
            contents.push(String::from_utf8_lossy(&content).replace('\r', ""));
        }
        if contents.is_empty() {
            contents.push(standard_text(package)?);
        }
        for content in contents {
            let is_notice = |line: &&str| line.trim_start().to_lowercase().starts_with("copyright (c)");
            let owners: Vec<&str> = content.lines().filter(is_notice).map(str::trim).collect();
            let body: Vec<&str> = content.lines().filter(|l| !is_notice(l)).map(str::trim_end).collect();
            let body = body.join("\n").trim().to_owned();
            let owner =
                if owners.is_empty() { name.clone() } else { format!("{name}: {}", owners.join("; ")) };
            texts.entry(body).or_default().insert(owner);
        }
    }
    let mut out = format!(
        "grainpath is licensed under MIT or Apache-2.0, as you like. It is built with these libraries:\n\n{table}"
    );
    for (body, owners) in texts {
        out += &format!("\n{}\n", "=".repeat(80));
        owners.iter().for_each(|owner| out += &format!("{owner}\n"));
        out += &format!("\n{body}\n");
    }
    for file in wanted.more {
        let text = fs::read_to_string(crate::root().join(file)).map_err(|e| format!("{file}: {e}"))?;
        out += &format!("\n{}\n{text}", "=".repeat(80));
    }
    Ok(out)
}

/// The text of MIT for a package without a text of its own, in the name of the authors in its manifest.
fn standard_text(package: &Value) -> Result<String, String> {
    let name = &package["name"];
    let licence = package["license"].as_str().unwrap_or_default();
    if !allows(licence, &["MIT".to_owned()]) {
        return Err(format!("{name} has no text of its licence {licence:?}, and MIT is not one of it"));
    }
    let authors: Vec<&str> =
        package["authors"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    if authors.is_empty() {
        return Err(format!("{name} has neither a text of its licence nor authors"));
    }
    // Our own text of MIT is that of SPDX.
    let ours =
        fs::read_to_string(crate::root().join("LICENSE-MIT")).map_err(|e| format!("LICENSE-MIT: {e}"))?;
    let of_authors = |line: &str| match line.starts_with("Copyright (c)") {
        true => {
            format!("Copyright (c) {} (authors in its manifest; it ships no text of MIT)", authors.join(", "))
        }
        false => line.to_owned(),
    };
    Ok(ours.lines().map(of_authors).collect::<Vec<_>>().join("\n"))
}

/// The licence texts in a library's folder. Where the library may be used under MIT, that text is enough. Without a file of
/// their own, texts may stand in the list of authors.
fn licence_files(folder: &Path) -> Result<Vec<std::path::PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<_> = entries
        .flatten()
        .map(|e| e.path())
        .filter(|p| {
            let name = p.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
            let starts =
                ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"].iter().any(|s| name.starts_with(s));
            starts && p.is_file()
        })
        .collect();
    files.sort();
    let authors = folder.join("AUTHORS");
    if files.is_empty()
        && fs::read_to_string(&authors).is_ok_and(|t| t.contains("Permission is hereby granted"))
    {
        files.push(authors);
    }
    let mit = files.iter().find(|p| p.to_string_lossy().to_uppercase().ends_with("MIT")).cloned();
    Ok(mit.map_or(files, |file| vec![file]))
}

/// The packages that a package is built with, without those of its tests and build scripts.
pub fn used_by(name: &str, metadata: &Value) -> Result<BTreeSet<String>, String> {
    let nodes = metadata["resolve"]["nodes"].as_array().cloned().unwrap_or_default();
    let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
    let root = packages.iter().find(|p| p["name"] == name).ok_or_else(|| format!("no package {name}"))?;
    let mut open = vec![root["id"].as_str().unwrap_or_default().to_owned()];
    let mut used = BTreeSet::new();
    while let Some(id) = open.pop() {
        if !used.insert(id.clone()) {
            continue;
        }
        let node = nodes.iter().find(|n| n["id"] == id.as_str());
        for dependency in node.and_then(|n| n["deps"].as_array()).into_iter().flatten() {
            let normal = |kind: &Value| kind["kind"].is_null();
            if dependency["dep_kinds"].as_array().is_some_and(|kinds| kinds.iter().any(normal)) {
                open.push(dependency["pkg"].as_str().unwrap_or_default().to_owned());
            }
        }
    }
    Ok(used)
}

/// Whether an SPDX expression can be met with the licences allowed.
fn allows(expression: &str, allowed: &[String]) -> bool {
    // Old manifests join licences by a slash, which the strict grammar of SPDX refuses.
    Expression::parse_mode(expression, ParseMode::LAX)
        .is_ok_and(|e| e.evaluate(|licence| allowed.iter().any(|a| *a == licence.to_string())))
}

#[cfg(test)]
mod tests {
    use super::{allows, standard_text};

    #[test]
    fn a_package_without_a_text_gets_that_of_mit_in_the_name_of_its_authors() {
        let package = serde_json::json!({"name": "a", "license": "Zlib OR MIT", "authors": ["B", "C"]});
        let text = standard_text(&package).unwrap();
        assert!(text.contains("Copyright (c) B, C (") && !text.contains("grainpath"), "{text}");
        assert!(text.contains("Permission is hereby granted"));
        let other = serde_json::json!({"name": "a", "license": "Zlib", "authors": ["B"]});
        assert!(standard_text(&other).is_err_and(|e| e.contains("Zlib")));
    }

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
