//! The history of runs: a line of JSON for each plan and each strength test, in `history.jsonl` of the working folder.
//!
//! The studio keeps runs only until it ends; this file remains. Lines are added at the end and never changed, so that two
//! studios in one folder do not lose each other's lines.

use std::fs::OpenOptions;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Map, Value, json};

use grainpath_core::{Warning, WarningId};

use crate::engine::Finished;
use crate::refusal::{Refusal, plain};
use crate::roots::{HISTORY, Roots};
use crate::runs::Kind;

/// The greatest number of runs that are listed, the newest ones. Source: chosen; a page lists no more.
const MOST_TOLD: usize = 200;
/// Number of bytes that are read at the end of the file. Source: chosen; 200 lines take about a fifth of it.
const MOST_BYTES: u64 = 1 << 20;

/// The line of a run: the values of its report by which runs are compared.
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
        // The curve is left out: it is the largest part and is not compared.
        strength.remove("curve");
    }
    Value::Object(row)
}

/// Adds the line of a run that is done. A line that cannot be written is a warning of the run, whose result is good.
pub(crate) fn add(roots: &Roots, kind: Kind, name: &str, input: Option<&Path>, finished: &mut Finished) {
    let at_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let line = format!("{}\n", row(kind, name, input, finished, at_s));
    let written = roots.writable(&roots.work().join(HISTORY)).and_then(|path| {
        let file = OpenOptions::new().create(true).append(true).open(&path);
        // One call for the whole line, so that lines of two studios do not mix.
        file.and_then(|mut f| f.write_all(line.as_bytes()))
            .map_err(|e| Refusal::usage(format!("cannot write {}: {}", path.display(), plain(&e))))
    });
    if let Err(refusal) = written {
        let text = format!("this run is not in the list of earlier runs: {}", refusal.message);
        finished.warnings.push(Warning::new(WarningId::HistoryNotWritten, text));
    }
}

/// The newest runs, the last one first. Lines that are not JSON are skipped.
pub(crate) fn told(roots: &Roots) -> Vec<Value> {
    let read = || -> std::io::Result<Vec<u8>> {
        let mut file = std::fs::File::open(roots.work().join(HISTORY))?;
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(MOST_BYTES)))?;
        let mut bytes = Vec::new();
        file.take(MOST_BYTES).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    // The file does not exist before the first run.
    let bytes = read().unwrap_or_default();
    let lines = bytes.rsplit(|b| *b == b'\n').filter_map(|line| serde_json::from_slice(line).ok());
    lines.filter(Value::is_object).take(MOST_TOLD).collect()
}
