//! Descriptions of all settings, generated from their rows: the JSON Schema and the reference page.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use super::regions::JobRegion;
use super::settings::Settings;
use super::value::{Check, Param, SettingValue};

/// JSON Schema (draft 2020-12) of a job file.
///
/// ```
/// let schema = grainpath_job::json_schema();
/// let loops = &schema["properties"]["process"]["properties"]["skirt_loops"];
/// assert_eq!(loops["type"], "integer");
/// assert_eq!(loops["default"], 1);
/// ```
pub fn json_schema() -> Value {
    let mut sections = Map::new();
    for section in Settings::SECTIONS {
        let mut keys = Map::new();
        // `profile` is read before all other keys; as it is not a row, it is added here.
        if ["printer", "material", "process"].contains(&section) {
            let about =
                "Name of a shipped profile, or a path ending in .toml; its keys are the section's defaults.";
            keys.insert("profile".into(), json!({ "type": "string", "description": about }));
        }
        for p in Settings::params().iter().filter(|p| p.section == section) {
            keys.insert(p.key.into(), schema_of(p));
        }
        // Unknown keys are errors in the parser, so editors should mark them too.
        let table = json!({ "type": "object", "additionalProperties": false, "properties": keys });
        match section.split_once('.') {
            None => drop(sections.insert(section.into(), table)),
            // A nested table. For a scan or a file of directions, its path alone may replace the table.
            Some((outer, inner @ ("ct" | "field"))) => {
                sections[outer]["properties"][inner] = json!({ "oneOf": [table, { "type": "string" }] });
            }
            Some((outer, inner)) => sections[outer]["properties"][inner] = table,
        }
    }
    let about = "Places with settings of their own; where two overlap, the settings of the later one apply.";
    let regions = json!({ "type": "array", "items": JobRegion::schema(), "description": about });
    sections.insert("region".into(), regions);
    let format = json!({
        "type": "integer",
        "minimum": 1,
        "maximum": crate::FORMAT,
        "description": "Version of the job file format; a file without it is read as version 1.",
    });
    sections.insert("format".into(), format);
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "grainpath job",
        "type": "object",
        "additionalProperties": false,
        "properties": sections,
    })
}

/// The schema of one setting: type, range, words with their meaning, default and help text.
fn schema_of(p: &Param) -> Value {
    let unit = if p.unit.is_empty() { String::new() } else { format!(" Unit: {}.", p.unit) };
    let mut row = p.schema.clone();
    row["description"] = json!(format!("{}{unit}", p.help));
    if let Check::Range(low, high) = p.check {
        limit_numbers(&mut row, low, high);
    }
    if !p.words.is_empty() {
        // Validators use `enum`; editors use `oneOf` to show the meaning of a word.
        row["enum"] = p.words.iter().map(|w| json!(w.name)).collect();
        row["oneOf"] = p.words.iter().map(|w| json!({ "const": w.name, "description": w.help })).collect();
    }
    // The row states the default as TOML text; parsing it gives a value of the right type.
    let default = format!("v = {}", p.default).parse::<toml::Table>().ok().and_then(|mut t| t.remove("v"));
    if let Some(value) = default.and_then(|v| serde_json::to_value(v).ok()) {
        row["default"] = value;
    }
    // Validators pass over keys that begin with `x-`; the studio's form shows what a change costs.
    row["x-first-stage"] = json!(p.first_stage().name());
    row
}

/// Applies a range to every number of a schema: to the value itself, or to the entries of its lists.
fn limit_numbers(schema: &mut Value, low: f64, high: f64) {
    let kinds: Vec<&str> = match &schema["type"] {
        Value::String(kind) => vec![kind],
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => Vec::new(),
    };
    if kinds.iter().any(|k| ["number", "integer"].contains(k)) {
        schema["minimum"] = json!(low);
        schema["maximum"] = json!(high);
    }
    if let Some(items) = schema.get_mut("items") {
        limit_numbers(items, low, high);
    }
}

/// The reference page, `docs/settings.md`.
///
/// ```
/// let page = grainpath_job::markdown();
/// assert!(page.contains("## [process]"));
/// ```
pub fn markdown() -> String {
    let mut out = String::from(concat!(
        "# Settings\n\n",
        "Written by `grainpath schema --markdown`; a test keeps it up to date. ",
        "A job file has these sections. Every key may be left out. ",
        "A numeric setting without a default can be unset with the word `\"none\"`.\n\n",
        "It begins with `format = 1`, the version of the format; a file without this line is read as version 1.\n",
    ));
    for section in Settings::SECTIONS {
        let _ = write!(
            out,
            "\n## [{section}]\n\n| key | default | unit | allowed | what it does |\n|---|---|---|---|---|\n"
        );
        for p in Settings::params().iter().filter(|p| p.section == section) {
            let allowed = match p.check {
                Check::Any => p.words.iter().map(|w| w.name).collect::<Vec<_>>().join(", "),
                Check::Range(low, high) => format!("{low} to {high}"),
            };
            // A line break or a vertical bar in a default would break the table.
            let default = p.default.replace('\n', "\\n").replace('|', "\\|");
            let default = if default.is_empty() { String::new() } else { format!("`{default}`") };
            let mut help = p.help.to_owned();
            for word in p.words.iter().filter(|w| !w.help.is_empty()) {
                let _ = write!(help, "<br>`{}`: {}", word.name, word.help);
            }
            let _ = writeln!(out, "| `{}` | {default} | {} | {allowed} | {help} |", p.key, p.unit);
        }
    }
    out.push_str(REGIONS);
    out
}

/// The tables `[[region]]` on the reference page.
const REGIONS: &str = concat!(
    "\n## [[region]]\n\n",
    "A place with settings of its own. A job may have any number of them; where two overlap, the settings of the later one apply. ",
    "Settings that a region leaves out are those of the rest of the part.\n\n",
    "| key | what it does |\n|---|---|\n",
    "| `on` | Where it lies, exactly one of: `{ box_mm = [[x, y, z], [x, y, z]] }`, two corners, with the part on the bed; ",
    "`{ layers = [[1, 10]] }`, first and last layer counted from 1; `{ mesh = \"rib.stl\" }`, the inside of a mesh in the ",
    "coordinates of the part's file; `{ face = \"f:9c1e\", depth_mm = 3 }`, the material within a depth below a face that ",
    "`grainpath inspect --faces` names. |\n",
    "| `fill` | `{ pattern, density, angles_deg, lines }`, as in [fill]. With `fill.mass_g`, a region without a density of its own gets the density that is found for the mass. |\n",
    "| `process` | `{ walls, top_layers, bottom_layers }`, as in [process]. |\n",
    "| `guide` | `false`: infill does not follow the guide there. |\n",
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_page_is_what_the_rows_say() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/settings.md");
        let page = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            page == markdown(),
            "docs/settings.md is stale: grainpath schema --markdown > docs/settings.md"
        );
    }

    #[test]
    fn every_row_has_its_default_in_range() {
        for p in Settings::params() {
            assert!(p.help.ends_with('.'), "{}.{}", p.section, p.key);
            if let (Check::Range(low, high), Ok(value)) = (p.check, p.default.parse::<f64>()) {
                assert!((low..=high).contains(&value), "{}.{}", p.section, p.key);
            }
        }
        assert_eq!(json_schema()["properties"]["process"]["properties"]["walls"]["default"], 2);
    }
}
