//! Every dependency's licence must let anybody use grainpath under MIT or Apache-2.0.

/// Licences taken as they are. MPL is for dependencies only.
const ALLOWED: [&str; 14] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "ISC",
    "Zlib",
    "Unlicense",
    "0BSD",
    "CC0-1.0",
    "MPL-2.0",
    "Unicode-3.0",
    "MIT-0",
];

pub fn check() -> Result<(), String> {
    let metadata = crate::arrows::metadata(&[])?;
    let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
    let refused: Vec<String> = packages
        .iter()
        .filter(|p| !p["license"].as_str().is_some_and(allows))
        .map(|p| format!("{} {} ({})", p["name"], p["version"], p["license"]))
        .collect();
    if refused.is_empty() {
        println!("{} packages, all under permissive licences", packages.len());
        Ok(())
    } else {
        Err(format!("licences not on the list in xtask/src/licences.rs: {}", refused.join(", ")))
    }
}

/// Whether an SPDX expression can be met with the list: one of each OR, all of each AND. No crate in use nests
/// deeper than one pair of brackets, and brackets only ever hold an OR.
fn allows(expression: &str) -> bool {
    let met = |e: &str| ALLOWED.contains(&e.trim().trim_matches(['(', ')']).trim());
    let any = |e: &str| e.trim().trim_matches(['(', ')']).split(" OR ").flat_map(|p| p.split('/')).any(met);
    if expression.contains(" AND ") && !expression.contains('(') {
        // "A OR B AND C": AND binds tighter.
        return expression.split(" OR ").any(|e| e.split(" AND ").all(met));
    }
    expression.split(" AND ").all(any)
}

#[cfg(test)]
mod tests {
    use super::allows;

    #[test]
    fn expressions() {
        for yes in
            ["MIT", "MIT OR GPL-3.0", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0", "Zlib AND MIT"]
        {
            assert!(allows(yes), "{yes}");
        }
        for no in
            ["GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Apache-2.0) AND LGPL-2.1", "", "AGPL-3.0 OR LGPL-3.0"]
        {
            assert!(!allows(no), "{no}");
        }
    }
}
