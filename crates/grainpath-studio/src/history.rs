//! The history of runs: a line of JSON for each plan and each strength test, in `history.jsonl` of the working folder.
//!
//! Runs themselves are kept for one start of the studio; what is told of them here outlives it. Lines are added at the end
//! and never changed, so that two studios in one folder do not lose each other's.

use std::fs::OpenOptions;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Map, Value, json};

use crate::engine::Finished;
use crate::roots::Roots;
use crate::runs::Kind;

/// Name of the file.
const FILE: &str = "history.jsonl";
/// Most runs that are told, the newest ones. Source: chosen; a page lists no more.
const MOST_TOLD: usize = 200;
/// Bytes at the end of the file that are read. Source: chosen; 200 lines have a fifth of it.
const MOST_BYTES: u64 = 1 << 20;

/// What is kept of a report: what two runs are compared by.
fn row(kind: Kind, name: &str, input: Option<&Path>, finished: &Finished, at_s: u64) -> Value {
    let report = &finished.report;
    let mut row = Map::new();
    row.insert("at_s".to_owned(), json!(at_s));
    row.insert("kind".to_owned(), json!(kind));
    row.insert("name".to_owned(), json!(name));
    row.insert("input".to_owned(), json!(input.map(|p| p.display().to_string())));
    for key in ["mass_g", "time_s", "layers", "filament_mm", "strength"] {
        row.insert(key.to_owned(), report[key].clone());
    }
    if let Some(strength) = row.get_mut("strength").and_then(Value::as_object_mut) {
        // The curve is the largest part and nothing that is compared.
        strength.remove("curve");
    }
    Value::Object(row)
}

/// Adds a run that is done. A run is worth more than its line: where that cannot be written, nothing is said.
pub(crate) fn add(roots: &Roots, kind: Kind, name: &str, input: Option<&Path>, finished: &Finished) {
    let at_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let line = format!("{}\n", row(kind, name, input, finished, at_s));
    let Ok(path) = roots.writable(&roots.work().join(FILE)) else { return };
    let file = OpenOptions::new().create(true).append(true).open(path);
    // One call for the whole line, so that lines of two studios do not mix.
    let _ = file.and_then(|mut f| f.write_all(line.as_bytes()));
}

/// The newest runs, the last one first. Lines that are no JSON are passed over.
pub(crate) fn told(roots: &Roots) -> Vec<Value> {
    let read = || -> std::io::Result<Vec<u8>> {
        let mut file = std::fs::File::open(roots.work().join(FILE))?;
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(MOST_BYTES)))?;
        let mut bytes = Vec::new();
        file.take(MOST_BYTES).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    // There is no history before the first run.
    let bytes = read().unwrap_or_default();
    let lines = bytes.rsplit(|b| *b == b'\n').filter_map(|line| serde_json::from_slice(line).ok());
    lines.filter(Value::is_object).take(MOST_TOLD).collect()
}
