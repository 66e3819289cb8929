//! Files that tests need and the repository does not hold, and programs that tests call.
//!
//! A test that needs them is ignored by name: `#[ignore = "needs GRAINPATH_DATA"]`, `"needs python"`, or both joined
//! by "and". `cargo xtask test` runs those whose needs are met and counts the others as not run. Run by hand, such a
//! test fails and names what is missing; it never passes without having looked at anything.
#![allow(dead_code)]

use std::path::PathBuf;
use std::process::Command;

/// A file or folder below the folder that the variable `GRAINPATH_DATA` names.
///
/// # Panics
/// Where the variable is not set, or nothing is there.
pub(crate) fn data(path: &str) -> PathBuf {
    below("GRAINPATH_DATA", path)
}

/// A file below the folder that `GRAINPATH_CHECK` names: scripts that measure G-code without our code.
///
/// # Panics
/// Where the variable is not set, or nothing is there.
pub(crate) fn check(path: &str) -> PathBuf {
    below("GRAINPATH_CHECK", path)
}

/// The content of a file of [`data`].
///
/// # Panics
/// Where it cannot be read.
pub(crate) fn read_data(path: &str) -> Vec<u8> {
    let path = data(path);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// What a Python script with these arguments prints. The interpreter is `GRAINPATH_PYTHON`, or else `python3`.
///
/// # Panics
/// Where the script fails, with what it says.
pub(crate) fn python(configure: impl FnOnce(&mut Command)) -> Vec<u8> {
    let interpreter = std::env::var("GRAINPATH_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut command = Command::new(interpreter);
    configure(&mut command);
    let out = command.output().unwrap_or_else(|e| panic!("cannot start {command:?}: {e}"));
    assert!(out.status.success(), "{command:?}: {}", String::from_utf8_lossy(&out.stderr));
    out.stdout
}

fn below(variable: &str, path: &str) -> PathBuf {
    let folder = std::env::var(variable).unwrap_or_else(|_| panic!("{variable} is not set"));
    let whole = PathBuf::from(folder).join(path);
    assert!(whole.exists(), "{} is missing", whole.display());
    whole
}
