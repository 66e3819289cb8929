//! Pages for those who work on grainpath: the files that they name exist, and the files that a release
//! needs are present.

use std::fs;
use std::process::Command;

/// Pages whose file names are checked.
const PAGES: [&str; 6] = [
    "CONTRIBUTING.md",
    "docs/contributing/format.md",
    "docs/contributing/fill.md",
    "docs/contributing/guide.md",
    "docs/contributing/failure-criterion.md",
    "docs/contributing/release.md",
];

/// Where complete runs of `cargo xtask nightly` are noted.
const NIGHTLY: &str = "docs/nightly.md";

/// Checks the pages, the crates' READMEs and the changelog.
pub fn check() -> Result<(), String> {
    let mut wrong = Vec::new();
    let mut n_files = 0;
    for page in PAGES {
        for file in files_in(&read(page)?) {
            n_files += 1;
            if !crate::root().join(&file).exists() {
                wrong.push(format!("{page} names {file}, which is not there"));
            }
        }
    }
    let manifest: toml::Table = read("Cargo.toml")?.parse().map_err(|e| format!("Cargo.toml: {e}"))?;
    // The section of the version in the manifest must exist, or a release would have no notes.
    let version = manifest["workspace"]["package"]["version"].as_str().unwrap_or_default().to_owned();
    let changelog = read("CHANGELOG.md")?;
    for heading in ["## Unreleased".to_owned(), format!("## {version} ")] {
        if !changelog.lines().any(|l| l == heading || l.starts_with(&heading)) {
            wrong.push(format!("CHANGELOG.md has no section \"{heading}\""));
        }
    }
    let crates = crate::root().join("crates");
    for entry in fs::read_dir(&crates).map_err(|e| e.to_string())?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let names_it = read(&format!("crates/{name}/Cargo.toml"))?.contains("readme = \"README.md\"");
        if !names_it || !entry.path().join("README.md").exists() {
            wrong.push(format!("crates/{name} has no README.md, or its Cargo.toml does not name it"));
        }
    }
    if wrong.is_empty() {
        println!("{n_files} files named by {} pages are there", PAGES.len());
        return Ok(());
    }
    Err(wrong.join("\n       "))
}

/// Notes the date, the commit, the number of checks that passed, the minutes and the checks that failed of a complete
/// nightly run.
pub fn note_nightly(commit: &str, passed: usize, failed: &[&str], minutes: u64) -> Result<(), String> {
    let date = crate::output(Command::new("date").args(["-u", "+%F"]))?;
    let all = passed + failed.len();
    let failed = if failed.is_empty() { "none".to_owned() } else { failed.join("; ") };
    let row = format!("| {} | {commit} | {passed} of {all} | {minutes} | {failed} |\n", date.trim());
    let page = read(NIGHTLY)?;
    fs::write(crate::root().join(NIGHTLY), page + &row).map_err(|e| format!("{NIGHTLY}: {e}"))
}

fn read(path: &str) -> Result<String, String> {
    fs::read_to_string(crate::root().join(path)).map_err(|e| format!("{path}: {e}"))
}

/// Paths between back-quotes: words with a slash or one of our extensions, and without blanks, `<` or
/// `*`.
fn files_in(page: &str) -> Vec<String> {
    let is_file = |word: &&str| {
        let is_path = word.contains('/') || [".md", ".toml", ".rs"].iter().any(|end| word.ends_with(end));
        // Words with these characters are patterns, addresses or code; a leading slash is a path of the
        // system.
        is_path && !word.contains([' ', '<', '*', ':', '{', '"']) && !word.starts_with('/')
    };
    let quoted = page.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    quoted.filter(is_file).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_found_between_back_quotes() {
        let page =
            "See `docs/a.md` and `Cargo.toml`, run `cargo xtask test`, write `crates/<name>/x.rs`, `f64`.";
        assert_eq!(files_in(page), ["docs/a.md", "Cargo.toml"]);
    }
}
