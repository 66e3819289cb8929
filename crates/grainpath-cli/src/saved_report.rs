//! Saved JSON of this program, for errors about files that are opened as shapes.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use serde_json::Value;

/// Largest file that is looked into, bytes. Source: chosen; reports have some kilobytes.
const MOST_BYTES: u64 = 16 << 20;

/// What a JSON file is and what to open in its place; `None` for files with another ending or that cannot be read.
pub(crate) fn what_it_is(file: &Path) -> Option<String> {
    // Only the name is looked at first, since a part may have gigabytes.
    if !file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        return None;
    }
    let mut bytes = Vec::new();
    File::open(file).ok()?.take(MOST_BYTES).read_to_end(&mut bytes).ok()?;
    let known = serde_json::from_slice::<Value>(&bytes).ok().and_then(|json| of_this_program(&json));
    Some(known.unwrap_or_else(|| "a JSON file, which holds no shape".to_owned()))
}

/// In words: an error, a report of a plan or of a strength test, or the paths of a plan.
fn of_this_program(json: &Value) -> Option<String> {
    if let Some(error) = json["error"].as_str().filter(|_| json["ok"] == false) {
        return Some(format!(
            "the JSON of a run that failed ({error}); open the job or the shape of that run"
        ));
    }
    // What `output.plan` writes has no version; its two keys together are in no other file of the program.
    if json["layers"].is_array() && json["plate_from_part_mm"].is_array() {
        return Some("the paths of a plan as JSON; open the G-code or the job of that plan".to_owned());
    }
    // Every report states the version and the number of layers.
    if json["version"].as_str().is_none() || json["layers"].as_u64().is_none() {
        return None;
    }
    Some(match (json["outputs"]["gcode"].as_str(), json["strength"].is_object()) {
        (Some(gcode), _) => {
            format!("the JSON report of a plan; open its G-code, {gcode}, or its job (.toml)")
        }
        (None, true) => {
            "the JSON report of a strength test; open the G-code or the job (.toml) that was tested"
                .to_owned()
        }
        (None, false) => {
            "a JSON report of grainpath; open the G-code or the job (.toml) that it is about".to_owned()
        }
    })
}
