//! Goldens: what each preset of `grainpath new` prints, in `tests/snapshots`. Counts, lengths and grams come from the
//! report; each layer has a hash of its commands without comments, so that a difference names the layers.
//!
//! A golden that differs is a change of the G-code or of what is measured on it. `CONTRIBUTING.md` says when a golden
//! may change. All presets together take less than a minute on two cores: layers are thicker, meshes coarser and the
//! scan smaller than in the presets as written, and pictures and pages are left out.

mod support;

use std::fmt::Write as _;
use std::fs;

use grainpath_parts::presets::PRESETS;
use serde_json::Value;
use support::{folder, grainpath, json};

/// The job file of a preset, the arguments of `grainpath new`, and the settings that make the job small.
fn small(preset: &str) -> (&'static str, &'static [&'static str], &'static [&'static str]) {
    match preset {
        "plate" => ("job.toml", &[], &[]),
        "stress-lines" => ("tension.toml", &[], &["process.layer_height_mm=0.4"]),
        "field" => ("job.toml", &[], &["process.layer_height_mm=0.4"]),
        "ct" => ("job.toml", &["--pixels", "128"], &["process.layer_height_mm=0.4"]),
        "woodgrain" => ("job.toml", &[], &["process.layer_height_mm=0.4"]),
        "tree-support" => ("ball.toml", &[], &["process.layer_height_mm=0.4"]),
        "continuous" => ("plate.toml", &[], &[]),
        other => panic!("the preset {other} needs a golden"),
    }
}

/// Numbers and names of a report that do not depend on the machine.
const KEYS: [&str; 14] = [
    "layers",
    "z_max_mm",
    "toolpaths",
    "printed_mm",
    "travel_mm",
    "extruded_mm3",
    "filament_mm",
    "mass_g",
    "time_s",
    "density",
    "quality",
    "support",
    "fibre",
    "stress",
];

/// A value as lines `key = number`, with the keys of nested objects before it. Lists are left out but for their
/// length: they hold a row for each layer or turn, which the hashes stand for.
fn write_value(out: &mut String, key: &str, value: &Value) {
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| write_value(out, &format!("{key}.{k}"), v)),
        Value::Array(list) if list.iter().all(Value::is_number) => {
            let _ = writeln!(out, "{key} = {value}");
        }
        Value::Array(list) => {
            let _ = writeln!(out, "{key}: {} entries", list.len());
        }
        plain => {
            let _ = writeln!(out, "{key} = {plain}");
        }
    }
}

/// FNV-1a, 64 bits. Source: Fowler, Noll and Vo, draft-eastlake-fnv; it only has to tell layers apart.
fn hash(lines: &[&str]) -> u64 {
    let bytes = lines.iter().flat_map(|l| l.bytes().chain([b'\n']));
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

/// Number of commands and hash of each layer; the first entry is what stands before the first layer.
fn layers(gcode: &str) -> Vec<(usize, u64)> {
    let mut layers = vec![Vec::new()];
    for line in gcode.lines() {
        if line == ";LAYER_CHANGE" {
            layers.push(Vec::new());
        }
        let command = line.split(';').next().unwrap_or_default().trim_end();
        if let (false, Some(last)) = (command.is_empty(), layers.last_mut()) {
            last.push(command);
        }
    }
    layers.iter().map(|commands| (commands.len(), hash(commands))).collect()
}

/// The golden of a preset.
fn summary(preset: &str) -> String {
    let (job, new, sets) = small(preset);
    let dir = folder(&format!("golden {preset}"));
    let made = grainpath(&dir, &[&["new", preset, "preset"], new].concat());
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let job = format!("preset/{job}");
    let mut args = vec!["run", &job, "--out", ".", "--json"];
    for set in
        ["output.gcode=out.gcode", "output.report=", "output.preview=", "output.support=", "output.lines="]
            .iter()
            .chain(sets)
    {
        args.extend(["--set", set]);
    }
    let report = json(&grainpath(&dir, &args));
    assert_eq!(report["ok"], true, "{preset}: {report}");
    let mut out = format!("grainpath new {preset} {}: {job} {}\n", new.join(" "), sets.join(" "));
    KEYS.iter().filter(|k| !report[**k].is_null()).for_each(|k| write_value(&mut out, k, &report[*k]));
    for warning in report["warnings"].as_array().expect("a list") {
        let _ = writeln!(out, "warning {}", warning["id"].as_str().expect("an id"));
    }
    let gcode = fs::read_to_string(dir.join("out.gcode")).expect("G-code");
    let layers = layers(&gcode);
    assert_eq!(Some(layers.len() as u64 - 1), report["layers"].as_u64(), "{preset}: layers in the program");
    for (i, (commands, hash)) in layers.iter().enumerate() {
        let _ = writeln!(out, "layer {i}: {commands} commands, {hash:016x}");
    }
    out
}

#[test]
fn every_preset_prints_what_its_golden_says() {
    for preset in PRESETS {
        insta::assert_snapshot!(preset, summary(preset));
    }
}
