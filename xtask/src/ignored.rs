//! Tests that are ignored by name, and why: tests that need files or programs, and tests that take long.
//!
//! The reason in `#[ignore = "..."]` is read: "needs" and words of [`crate::setup::NEEDS`], or "slow". Any other
//! reason, or none, is an error.

use crate::setup::{Found, NEEDS};
use crate::source::TestFile;

/// An ignored test: its full name in its binary, and its reason.
pub struct Ignored {
    pub name: String,
    pub reason: String,
}

/// Every ignored test of our crates.
pub fn find(files: &[TestFile]) -> Result<Vec<Ignored>, String> {
    let mut found = Vec::new();
    for file in files {
        collect(&file.items, &module_of(&file.path), &file.path, &mut found)?;
    }
    Ok(found)
}

/// The tests that can run here, and the tests that cannot, with what they lack. Slow tests are in neither
/// list.
pub fn split<'a>(tests: &'a [Ignored], setup: &Found) -> (Vec<&'a Ignored>, Vec<(&'a Ignored, String)>) {
    let (mut run, mut lacking) = (Vec::new(), Vec::new());
    for test in tests.iter().filter(|t| t.reason.starts_with("needs")) {
        let missing = setup.missing_of(&test.reason);
        if missing.is_empty() {
            run.push(test);
        } else {
            lacking.push((test, missing.join(", ")));
        }
    }
    (run, lacking)
}

/// Modules before the name of a test: none in `tests/`, the path below `src/` otherwise.
fn module_of(path: &str) -> Vec<String> {
    let Some((_, below)) = path.split_once("/src/") else { return Vec::new() };
    let below = below.trim_end_matches(".rs").trim_end_matches("/mod");
    below.split('/').filter(|name| *name != "lib" && *name != "main").map(str::to_owned).collect()
}

fn collect(
    items: &[syn::Item],
    module: &[String],
    path: &str,
    found: &mut Vec<Ignored>,
) -> Result<(), String> {
    for item in items {
        match item {
            syn::Item::Mod(inner) => {
                if let Some((_, items)) = &inner.content {
                    let mut module = module.to_vec();
                    module.push(inner.ident.to_string());
                    collect(items, &module, path, found)?;
                }
            }
            syn::Item::Fn(test) => {
                let Some(attr) = test.attrs.iter().find(|a| a.path().is_ident("ignore")) else { continue };
                let reason = match &attr.meta {
                    syn::Meta::NameValue(syn::MetaNameValue {
                        value: syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }),
                        ..
                    }) => text.value(),
                    _ => String::new(),
                };
                let known = reason.starts_with("slow")
                    || (reason.starts_with("needs ") && NEEDS.iter().any(|need| reason.contains(need)));
                // A reason in free words could not be checked against this machine, and the test might
                // never run anywhere.
                if !known {
                    return Err(format!(
                        "{path}: {} is ignored for {reason:?}; reasons are \"slow: ...\" and \"needs ...\" with some \
                         of {}",
                        test.sig.ident,
                        NEEDS.join(", ")
                    ));
                }
                // The full name, since `--exact` compares whole names.
                let name =
                    module.iter().cloned().chain([test.sig.ident.to_string()]).collect::<Vec<_>>().join("::");
                found.push(Ignored { name, reason });
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> TestFile {
        TestFile { path: path.to_owned(), items: syn::parse_file(text).expect("the test is Rust").items }
    }

    #[test]
    fn ignored_tests_are_named_as_their_binary_names_them() {
        let files = [
            file("crates/a/tests/real.rs", "#[test] #[ignore = \"needs python\"] fn one() {}"),
            file(
                "crates/a/src/image/mod.rs",
                "mod tests { #[test] #[ignore = \"needs GRAINPATH_DATA and python\"] fn two() {} }",
            ),
            file("crates/a/src/lib.rs", "mod tests { #[test] #[ignore = \"slow: minutes\"] fn three() {} }"),
        ];
        let found = find(&files).expect("known reasons");
        let names: Vec<&str> = found.iter().map(|t| t.name.as_str()).collect();
        assert_eq!(names, ["one", "image::tests::two", "tests::three"]);
        let setup = Found { missing: vec![("GRAINPATH_DATA", String::new())] };
        let (run, lacking) = split(&found, &setup);
        assert_eq!(run.len(), 1);
        assert_eq!(
            lacking.iter().map(|(t, l)| (t.name.as_str(), l.as_str())).collect::<Vec<_>>(),
            [("image::tests::two", "GRAINPATH_DATA")]
        );
    }

    #[test]
    fn reasons_that_nobody_can_act_on_are_refused() {
        assert!(find(&[file("crates/a/tests/b.rs", "#[test] #[ignore] fn one() {}")]).is_err());
        assert!(find(&[file("crates/a/tests/b.rs", "#[test] #[ignore = \"broken\"] fn one() {}")]).is_err());
    }
}
