//! Runs the program as a user would.
#![allow(dead_code)]

#[path = "../../../../tests/data.rs"]
pub(crate) mod data;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, PoisonError};

use serde_json::Value;

/// A folder for one test, empty at the start.
pub(crate) fn folder(name: &str) -> PathBuf {
    static TAKEN: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let is_new = TAKEN.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned());
    assert!(is_new, "two tests share the folder {name}, and one empties it below the other");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

/// Runs `grainpath` in a folder.
pub(crate) fn grainpath(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainpath"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

/// The JSON object on standard output, which must hold nothing else.
pub(crate) fn json(output: &Output) -> Value {
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(text.lines().count(), 1, "one object and nothing else: {text}");
    serde_json::from_str(&text).expect("JSON")
}

/// A box with a corner at the origin, as ASCII STL.
pub(crate) fn box_stl(size: [f64; 3]) -> String {
    let v = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { size[k] } else { 0.0 });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut out = String::from("solid box\n");
    for [a, b, c, d] in quads {
        for t in [[a, b, c], [a, c, d]] {
            out += "facet normal 0 0 0\nouter loop\n";
            for p in t.map(v) {
                out += &format!("vertex {} {} {}\n", p[0], p[1], p[2]);
            }
            out += "endloop\nendfacet\n";
        }
    }
    out + "endsolid box\n"
}
