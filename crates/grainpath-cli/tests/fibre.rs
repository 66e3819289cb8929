//! Continuous fibre: the program holds what the job asks for, in each flavour; an impossible job is
//! refused in one line.

mod support;

use std::fs;
use std::path::Path;

use grainpath_core::Role;
use grainpath_core::segments::Segments;
use grainpath_gcode::{Limits, simulate};
use serde_json::Value;
use support::{box_stl, folder, grainpath, json};

/// A plate of 80 x 30 x 1 mm with rings of fibre.
const JOB: &str = r#"
[shape]
mesh = "plate.stl"
[printer]
profile = "fibre-coextruded"
[process]
bead_width_mm = 0.8
walls = 1
skirt_loops = 0
[fill]
pattern = "concentric"
density = 1.0
[fibre]
enabled = true
[output]
gcode = "out.gcode"
"#;

fn plate(name: &str) -> std::path::PathBuf {
    let dir = folder(name);
    fs::write(dir.join("plate.stl"), box_stl([80.0, 30.0, 1.0])).expect("a file");
    fs::write(dir.join("job.toml"), JOB).expect("a file");
    dir
}

fn run(dir: &Path, sets: &[&str]) -> (Value, String) {
    let mut args = vec!["run", "job.toml", "--json"];
    sets.iter().for_each(|s| args.extend(["--set", s]));
    let out = grainpath(dir, &args);
    assert!(out.status.success(), "{sets:?}: {}", String::from_utf8_lossy(&out.stderr));
    (json(&out), fs::read_to_string(dir.join("out.gcode")).expect("G-code"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn every_flavour_feeds_anchors_and_cuts_and_is_read_back() {
    let dir = plate("fibre flavours");
    for sets in [
        &[][..],
        &["printer.flavour=klipper", "printer.fibre_cut_gcode=CUT"],
        &["printer.flavour=rrf", "printer.relative_e=false"],
        &["printer.profile=fibre-separate", "printer.nozzle_mm=0.8"],
        &["printer.profile=fibre-separate", "printer.relative_e=false", "printer.z_hop_mm=0.3"],
    ] {
        let (report, gcode) = run(&dir, sets);
        let fibre = &report["fibre"];
        let pieces = fibre["pieces"].as_u64().expect("a count");
        assert!(pieces > 0 && fibre["cuts"] == fibre["pieces"], "{sets:?}: {fibre}");
        assert_eq!(gcode.matches(";FIBRE_CUT").count() as u64, pieces);
        // Only the rings in the middle are too narrow for the radius; the middle of the plate is at y =
        // 15.
        for turn in sharp_turns(fibre) {
            assert!((turn[1] - 15.0).abs() < 2.5, "{sets:?}: {turn:?}");
        }
        assert_eq!(fibre["layers"].as_array().map(Vec::len), Some(5));
        let seen = json(&grainpath(&dir, &["inspect", "out.gcode", "--json"]));
        assert_eq!(seen["fibre"]["cuts"], fibre["cuts"], "{sets:?}");
        // Lengths and volumes agree to the rounding of coordinates and of E.
        let near =
            |a: &Value, b: &Value| assert!((number(a) / number(b) - 1.0).abs() < 2e-3, "{sets:?}: {a} {b}");
        near(&seen["fibre"]["length_mm"], &fibre["length_mm"]);
        near(&seen["extruded_mm3"], &report["extruded_mm3"]);
        near(&seen["printed_mm"], &report["printed_mm"]);
        let changes = gcode.lines().filter(|l| *l == "T1").count();
        assert_eq!(changes, if sets.iter().any(|s| s.contains("separate")) { 5 } else { 0 }, "{sets:?}");
        // The fibre between cutter and nozzle is laid after the cut, so the rest has that length.
        let cutter = if changes > 0 { 45.0 } else { 40.0 };
        for left in left_after_cuts(&gcode) {
            assert!((left - cutter).abs() < 0.05, "{sets:?}: {left} mm are laid after a cut");
        }
    }
}

/// Turns below the least radius: x, y and radius, mm.
fn sharp_turns(fibre: &Value) -> Vec<Vec<f64>> {
    let layers = fibre["layers"].as_array().expect("layers").iter();
    let turns = layers.flat_map(|l| l["sharp_turns"].as_array().expect("a list"));
    let turns: Vec<Vec<f64>> =
        turns.map(|t| t.as_array().expect("a place").iter().map(number).collect()).collect();
    assert_eq!(turns.len() as u64, fibre["sharp_turns"].as_u64().expect("a count"));
    turns
}

/// Length printed after each cut, up to the next move without printing.
fn left_after_cuts(gcode: &str) -> Vec<f64> {
    let mut at = [0.0f64; 2];
    let (mut counting, mut out) = (false, Vec::new());
    for line in gcode.lines() {
        if line == ";FIBRE_CUT" {
            counting = true;
            out.push(0.0);
        }
        if !line.starts_with("G1") {
            continue;
        }
        let word = |c: char| line.split(' ').find_map(|w| w.strip_prefix(c)?.parse::<f64>().ok());
        let to = [word('X').unwrap_or(at[0]), word('Y').unwrap_or(at[1])];
        let moved = grainpath_core::DVec2::from(to).distance(at.into());
        at = to;
        if moved > 0.0 && word('E').is_none() {
            counting = false;
        }
        if let (true, Some(last)) = (counting, out.last_mut()) {
            *last += moved;
        }
    }
    out
}

#[test]
fn layers_boxes_and_length_leave_the_rest_to_the_matrix() {
    let dir = plate("fibre choice");
    let (all, _) = run(&dir, &[]);
    let (some, _) = run(&dir, &["fibre.layers=[[2,4]]", "fibre.every=2"]);
    let layers: Vec<u64> = some["fibre"]["layers"]
        .as_array()
        .expect("layers")
        .iter()
        .filter_map(|l| l["layer"].as_u64())
        .collect();
    assert_eq!(layers, [2, 4]);
    let (half, _) = run(&dir, &["fibre.boxes_mm=[[[-1,-1,-1],[40,31,2]]]"]);
    let share = number(&half["fibre"]["length_mm"]) / number(&all["fibre"]["length_mm"]);
    // The box covers half of the plate; the ends of cut rings shorten the fibre a little.
    assert!((0.4..0.55).contains(&share), "{share}");
    for report in [&all, &some, &half] {
        let quality = &report["quality"];
        assert!(number(&quality["gap"]) < 0.05 && number(&quality["overlap"]) < 0.05, "{quality}");
    }
    let (long, _) = run(&dir, &["fibre.min_length_mm=150"]);
    assert!(number(&long["fibre"]["layers"][0]["shortest_mm"]) >= 149.0);
    assert!(long["warnings"].to_string().contains("are laid without fibre"), "{}", long["warnings"]);
}

#[test]
fn sharp_turns_are_rounded_reported_or_cut() {
    let dir = plate("fibre turns");
    let zigzag = ["fill.pattern=aligned", "fill.angles_deg=[0]"];
    let with = |turns: &str| run(&dir, &[&zigzag[..], &[&format!("fibre.turns={turns}")]].concat()).0;
    let report = with("report");
    assert!(number(&report["fibre"]["sharp_turns"]) > 100.0, "{}", report["fibre"]);
    assert!(report["warnings"].to_string().contains("are sharper than 2 mm"), "{}", report["warnings"]);
    let cut = with("cut");
    assert_eq!(cut["fibre"]["sharp_turns"], 0, "{}", cut["fibre"]);
    assert!(number(&cut["fibre"]["cuts"]) > 100.0);
    // Lines return several beads away: fewer cuts, as much fibre, and no turn below the radius either.
    let wide = with("wide");
    assert_eq!(wide["fibre"]["sharp_turns"], 0, "{}", wide["fibre"]);
    assert!(number(&wide["fibre"]["cuts"]) < 0.6 * number(&cut["fibre"]["cuts"]), "{}", wide["fibre"]);
    assert!(number(&wide["fibre"]["length_mm"]) > 0.95 * number(&cut["fibre"]["length_mm"]));
    assert!(number(&wide["quality"]["gap"]) < 0.05 && number(&wide["quality"]["overlap"]) < 0.03);
    let (rings, _) = run(&dir, &["fibre.turns=report"]);
    let (rounded, _) = run(&dir, &[]);
    let (before, after) = (sharp_turns(&rings["fibre"]), sharp_turns(&rounded["fibre"]));
    assert!(before.len() > 3 * after.len(), "{} of {} are left", after.len(), before.len());
    assert!(after.iter().all(|t| (t[1] - 15.0).abs() < 2.5), "{after:?}");
}

/// The plate of `grainpath new continuous`, with a hole and along its stress: as one path a layer, and with wide turns.
#[test]
fn wide_turns_keep_the_fibre_along_the_stress() {
    let dir = folder("fibre wide turns");
    assert!(grainpath(&dir, &["new", "continuous", "."]).status.success());
    let fibre = |job: &str| {
        let out = grainpath(&dir, &["run", job, "--json"]);
        assert!(out.status.success(), "{job}: {}", String::from_utf8_lossy(&out.stderr));
        json(&out)["fibre"].clone()
    };
    let (one, wide) = (fibre("plate.toml"), fibre("plate-wide.toml"));
    assert!(number(&one["sharp_turns"]) > 500.0, "{one}");
    assert_eq!(wide["sharp_turns"], 0, "{wide}");
    assert!(number(&wide["min_radius_mm"]) >= 0.98 * 2.0, "{wide}");
    let along = |fibre: &Value| number(&fibre["length_mm"]) * number(&fibre["within_15_deg"]);
    assert!(along(&wide) >= 0.95 * along(&one), "{} of {} mm", along(&wide), along(&one));
}

/// Wide turns in the corners of an angle, and rounded lines that end beside each other.
#[test]
fn fibre_does_not_cross_fibre() {
    let dir = folder("fibre crossings");
    assert!(grainpath(&dir, &["new", "continuous", "."]).status.success());
    let angle = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"100mm\" viewBox=\"0 0 100 100\">\
                 <path d=\"M0 0H40V60H100V100H0Z\"/></svg>";
    fs::write(dir.join("angle.svg"), angle).expect("a file");
    let wide = fs::read_to_string(dir.join("plate-wide.toml")).expect("a job");
    let (common, _) = wide.split_once("[[guide.fixture]]").expect("fixtures");
    let job = format!(
        "{}[[guide.fixture]]\non = {{ box_mm = [[0, 90, 0], [40, 100, 1]] }}\nfix = \"xyz\"\n\
         [[guide.load]]\non = {{ box_mm = [[90, 0, 0], [100, 40, 1]] }}\nforce_n = [0, -500, 0]\n",
        common.replace("mesh = \"plate.stl\"", "outline = \"angle.svg\"\nthickness_mm = 0.4")
    );
    fs::write(dir.join("angle.toml"), job.replace("out/plate-wide", "out/angle")).expect("a file");
    for (name, least_mm) in [("angle", 10_000.0), ("plate-stripes", 40_000.0)] {
        let out = grainpath(&dir, &["run", &format!("{name}.toml"), "--json"]);
        assert!(out.status.success(), "{name}: {}", String::from_utf8_lossy(&out.stderr));
        assert!(number(&json(&out)["fibre"]["length_mm"]) > least_mm, "{}", json(&out)["fibre"]);
        let gcode = fs::read(dir.join(format!("out/{name}.gcode"))).expect("G-code");
        let program = simulate(&gcode, 1.75, &Limits::default()).expect("a program");
        for layer in &program.layers {
            let beads: Vec<_> = layer.beads.iter().filter(|b| b.role == Role::Fibre).collect();
            let ends = beads.iter().map(|b| [b.start(), b.end()]).collect();
            let crossed = Segments::new(ends, 2.0).meetings().into_iter().find(|&[i, j]| {
                // A bead begins where the one before it ends.
                beads[i].end().distance(beads[j].start()) > 1e-3
            });
            assert_eq!(crossed.map(|pair| pair.map(|i| beads[i].start())), None, "{name}, z {}", layer.z_mm);
        }
    }
}

#[test]
fn what_cannot_be_is_one_line() {
    let dir = plate("fibre errors");
    for (set, says) in [
        ("printer.fibre_tool=none", "needs a printer with a fibre tool"),
        ("printer.fibre_cut_gcode=", "needs printer.fibre_cut_gcode"),
        ("printer.fibre_cut_gcode=CUT {fed_mm}", "did you mean {feed_mm}?"),
        ("fibre.min_radius_mm=50", "a turn of that radius is 100.0 mm wide and the part 80.0 mm"),
        ("fibre.layers=[[3,9]]", "the part has 5 layers"),
        ("fibre.layers=[[3,2]]", "should be [first, last] from 1, is [3, 2]"),
        ("fibre.boxes_mm=[[[90,0,0],[99,9,9]]]", "box 1 misses the part"),
        ("fibre.min_length_mm=5000", "no fibre was laid: the longest path is"),
        ("fibre.material=continuos-carbon", "did you mean \"continuous-carbon\"?"),
        ("fibre.start=calm", "needs [guide] kind = \"stress\""),
        ("fibre.turns=bend", "should be one of round, report, cut"),
        ("fibre.radius=3", "unknown key `radius` in [fibre]; did you mean"),
    ] {
        let out = grainpath(&dir, &["run", "job.toml", "--set", set]);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{set}: {said}");
        assert!(said.contains(says) && said.lines().count() == 1, "{set}: {said:?} should say {says:?}");
        assert!(!dir.join("out.gcode").exists(), "{set}: nothing may be left behind");
    }
}

#[test]
fn beads_too_wide_for_the_part_are_warned_of() {
    let dir = plate("fibre wide");
    for (set, warned) in [("fibre.bead_width_mm=10", true), ("fibre.bead_width_mm=0.8", false)] {
        let (report, _) = run(&dir, &[set]);
        let warnings = report["warnings"].to_string();
        assert_eq!(warnings.contains("of the part stays open"), warned, "{set}: {warnings}");
        assert_eq!(number(&report["quality"]["gap"]) > 0.08, warned, "{set}: {report}");
    }
}

#[test]
fn same_bytes_for_any_number_of_threads() {
    let dir = plate("fibre threads");
    let bytes = |threads: &str, set: &str| {
        let out = grainpath(&dir, &["run", "job.toml", "--threads", threads, "--set", set]);
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        fs::read(dir.join("out.gcode")).expect("G-code")
    };
    for set in ["fibre.every=2", "process.chain=true", "printer.profile=fibre-separate"] {
        let first = bytes("1", set);
        assert!(bytes("2", set) == first && bytes("8", set) == first, "{set}");
    }
}

#[test]
fn a_prismatic_part_prints_without_a_travel() {
    let dir = folder("fibre chain");
    assert!(grainpath(&dir, &["new", "continuous", "."]).status.success());
    for (pattern, mesh, walls) in
        [("continuous", "hook.stl", "0"), ("continuous", "hook.stl", "2"), ("continuous", "plate.stl", "1")]
    {
        let mesh = format!("shape.mesh={mesh}");
        let pattern = format!("fill.pattern={pattern}");
        let walls = format!("process.walls={walls}");
        let out = grainpath(
            &dir,
            &["run", "chained.toml", "--json", "--set", &mesh, "--set", &pattern, "--set", &walls],
        );
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let gcode = fs::read_to_string(dir.join("out/chained.gcode")).expect("G-code");
        // The first layer begins with a travel from the start position; the layers above it must not have
        // one.
        let after = gcode.splitn(3, ";LAYER_CHANGE").nth(2).expect("a second layer");
        let after = after.split(";TYPE:Custom").next().unwrap_or_default();
        let travels = after
            .lines()
            .filter(|l| l.starts_with("G1") && (l.contains(" X") || l.contains(" Y")) && !l.contains(" E"))
            .count();
        assert_eq!(travels, 0, "{mesh} with {walls}");
        // One retraction ends the program; any other would stand before a travel.
        assert!(after.matches(" E-").count() <= 1, "{mesh} with {walls}: nothing is drawn back");
    }
}
