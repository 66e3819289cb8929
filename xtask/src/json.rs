//! The page of the JSON reports beside what the program prints.
//!
//! [`check`] runs small jobs of every kind, gathers the paths of all keys they print, and holds them against the keys
//! of `docs/json.md`, both ways. Lists are walked through (`[]`); names that a job chooses are `*`. Keys that no small
//! job brings about are in [`NOT_HERE`].

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Objects whose keys are names, not fields.
const NAMED: [&str; 5] = ["stages_s", "outputs", "strength.modes", "strength.corners", "rows[].corners"];

/// Listed keys that none of the jobs below prints: places of warnings that they do not have, grids of directions,
/// overhangs out of reach, cones, pictures in programs of others, reasons for which nothing is told.
const NOT_HERE: [&str; 9] = [
    "faces[].half_angle_deg",
    "field.axis_order",
    "reserve.untold",
    "support.unreached[][]",
    "thumbnails[]",
    "warnings[].place.file",
    "warnings[].place.line",
    "warnings[].place.layer",
    "warnings[].place.z_mm",
];

/// A bar with two load cases, solved and broken as a solid.
const BAR: &str = r#"
[shape]
outline = "bar.svg"
thickness_mm = 2

[guide]
kind = "stress"
analysis = "solid"

[[guide.fixture]]
on = { box_mm = [[-1, -1, -1], [4, 11, 3]] }
fix = "xyz"

[[guide.case]]
name = "pull"
[[guide.case.load]]
on = { box_mm = [[36, -1, -1], [41, 11, 3]] }
force_n = [100, 0, 0]

[[guide.case]]
name = "side"
[[guide.case.load]]
on = { box_mm = [[36, -1, -1], [41, 11, 3]] }
force_n = [0, 20, 0]

[fill]
pattern = "stripes"
density = 1.0

[strength]
enabled = true
fidelity = "voxels"
cell_mm = 1.0

[output]
gcode = "bar.gcode"
"#;

/// A block filled along the texture of a scan.
const TEXTURE: &str = r#"
[shape]
outline = "bar.svg"
thickness_mm = 2

[guide]
kind = "grain"

[guide.volume]
path = "ct/hub.tif"
pixel_mm = 1.6
slice_mm = 1.6

[fill]
density = 0.3

[output]
gcode = "texture.gcode"
"#;

/// Runs the jobs and compares.
pub fn check() -> Result<(), String> {
    let program = crate::ci_program();
    let folder = crate::target().join("json");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).map_err(|e| e.to_string());
    write(
        "bar.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="10mm" viewBox="0 0 40 10"><path d="M0 0H40V10H0Z"/></svg>"#,
    )?;
    write("bar.toml", BAR)?;
    write("plane.toml", &BAR.replace("\"voxels\"", "\"plane\""))?;
    let graded = "density = { min = 0.2, max = 0.9, by = \"stress\" }";
    write("graded.toml", &BAR.replace("density = 1.0", graded).replace("enabled = true", "enabled = false"))?;
    write("texture.toml", TEXTURE)?;
    let told = |line: &str| crate::output(Command::new(&program).args(line.split(' ')).current_dir(&folder));
    for line in [
        "new ct --pixels 64",
        "new woodgrain",
        "new field",
        "new tree-support trees",
        "new continuous fibre",
        "new plate",
    ] {
        told(line)?;
    }
    let mut printed = BTreeSet::new();
    for line in [
        "run bar.toml --json",
        "run graded.toml --json",
        "run plate/job.toml --json",
        "run fibre/plate.toml --json",
        "run ct/job.toml --json",
        "run woodgrain/job.toml --json",
        "run field/job.toml --json",
        "run trees/ball.toml --json",
        "run trees/tray.toml --json --set support.from_plate_only=true",
        "run texture.toml --json",
        "compare plane.toml plane.toml --json",
        "inspect plate/plate.stl --json",
        "inspect plate/plate.stl --faces --json",
        "inspect bar.gcode --json",
    ] {
        let value: Value = serde_json::from_str(&told(line)?).map_err(|e| format!("{line}: {e}"))?;
        gather(&value, "", &mut printed);
    }
    let page = fs::read_to_string(crate::root().join("docs/json.md")).map_err(|e| e.to_string())?;
    let listed = listed(&page);
    let mut wrong: Vec<String> =
        printed.difference(&listed).map(|key| format!("{key} is printed and not in docs/json.md")).collect();
    let lacking = listed.difference(&printed).filter(|key| !NOT_HERE.contains(&key.as_str()));
    wrong.extend(lacking.map(|key| format!("{key} is in docs/json.md and was not printed")));
    if !wrong.is_empty() {
        return Err(wrong.join("\n       "));
    }
    println!("docs/json.md lists the {} keys that {} prints", printed.len(), shown(&program));
    Ok(())
}

fn shown(program: &Path) -> String {
    program.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Paths of the values of an object that hold no other. Empty lists have none.
fn gather(value: &Value, path: &str, out: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            let is_named = NAMED.contains(&path);
            for (key, field) in fields {
                let key = if is_named { "*" } else { key };
                let below = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
                gather(field, &below, out);
            }
        }
        Value::Array(entries) => {
            let below = format!("{path}[]");
            entries.iter().for_each(|entry| gather(entry, &below, out));
        }
        _ => {
            out.insert(path.to_owned());
        }
    }
}

/// Keys in the first column of the page's tables.
fn listed(page: &str) -> BTreeSet<String> {
    let rows = page.lines().filter_map(|l| l.strip_prefix("| `"));
    let first = rows.filter_map(|row| row.split(" | ").next());
    first.flat_map(|cell| cell.trim_end_matches('`').split("`, `").map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_lists_and_names_are_gathered() {
        let value = serde_json::json!({ "ok": true, "curve": [[0, 1]], "none": [], "outputs": { "gcode": "a" },
            "rows": [{ "name": "a", "corners": { "low": 1 } }] });
        let mut found = BTreeSet::new();
        gather(&value, "", &mut found);
        let found: Vec<String> = found.into_iter().collect();
        assert_eq!(found, ["curve[][]", "ok", "outputs.*", "rows[].corners.*", "rows[].name"]);
    }

    #[test]
    fn keys_of_the_page_stand_in_first_columns() {
        let page = "| key | unit |\n|---|---|\n| `a`, `b[].c` | mm | of `d` |\nText with `e`.\n| `f` | | |\n";
        assert_eq!(listed(page).into_iter().collect::<Vec<_>>(), ["a", "b[].c", "f"]);
    }
}
