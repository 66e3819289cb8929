//! The settings described: JSON Schema and the reference page.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use super::settings::Settings;
use super::value::{Check, Param};

/// JSON Schema (draft 2020-12) of a job file.
pub fn json_schema() -> Value {
    let mut sections = Map::new();
    for section in Settings::SECTIONS {
        let mut keys = Map::new();
        if ["printer", "material", "process"].contains(&section) {
            let about =
                "Name of a shipped profile, or a path ending in .toml; its keys are the section's defaults.";
            keys.insert("profile".into(), json!({ "type": "string", "description": about }));
        }
        for p in Settings::params().iter().filter(|p| p.section == section) {
            keys.insert(p.key.into(), schema_of(p));
        }
        let table = json!({ "type": "object", "additionalProperties": false, "properties": keys });
        match section.split_once('.') {
            None => drop(sections.insert(section.into(), table)),
            // A table within a table; for a scan its path alone may stand for it.
            Some((outer, "ct")) => {
                sections[outer]["properties"]["ct"] = json!({ "oneOf": [table, { "type": "string" }] });
            }
            Some((outer, inner)) => sections[outer]["properties"][inner] = table,
        }
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "grainpath job",
        "type": "object",
        "additionalProperties": false,
        "properties": sections,
    })
}

fn kind(words: &str) -> Value {
    if words.contains('|') { json!(words.split('|').collect::<Vec<_>>()) } else { json!(words) }
}

fn schema_of(p: &Param) -> Value {
    let unit = if p.unit.is_empty() { String::new() } else { format!(" Unit: {}.", p.unit) };
    let mut row = json!({ "type": kind(p.kind), "description": format!("{}{unit}", p.help) });
    match p.check {
        Check::Range(low, high) if !p.kind.contains("array") => {
            row["minimum"] = json!(low);
            row["maximum"] = json!(high);
        }
        Check::Words(words) if p.kind == "string" => row["enum"] = json!(words),
        _ => {}
    }
    let default = format!("v = {}", p.default).parse::<toml::Table>().ok().and_then(|mut t| t.remove("v"));
    if let Some(value) = default.and_then(|v| serde_json::to_value(v).ok()) {
        row["default"] = value;
    }
    row
}

/// The reference page, `docs/settings.md`.
pub fn markdown() -> String {
    let mut out = String::from(
        "# Settings\n\nWritten by `grainpath schema --markdown`; a test keeps it true. A job file has these sections; every key may be left out.\n",
    );
    for section in Settings::SECTIONS {
        let _ = write!(
            out,
            "\n## [{section}]\n\n| key | default | unit | allowed | what it does |\n|---|---|---|---|---|\n"
        );
        for p in Settings::params().iter().filter(|p| p.section == section) {
            let allowed = match p.check {
                Check::Any => String::new(),
                Check::Range(low, high) => format!("{low} to {high}"),
                Check::Words(words) => words.join(", "),
            };
            let default = p.default.replace('\n', "\\n").replace('|', "\\|");
            let default = if default.is_empty() { String::new() } else { format!("`{default}`") };
            let _ = writeln!(out, "| `{}` | {default} | {} | {allowed} | {} |", p.key, p.unit, p.help);
        }
    }
    out
}

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
