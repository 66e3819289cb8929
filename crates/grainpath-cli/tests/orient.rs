//! Which way up a part carries its loads.

mod support;

use std::fs;

use support::{box_stl, folder, grainpath, json};

const JOB: &str = "
[shape]
mesh = \"bar.stl\"

[guide]
kind = \"stress\"
frame = \"part\"

[[guide.fixture]]
on = { box_mm = [[0, 0, 0], [8, 8, 4]] }
fix = \"xyz\"

[[guide.load]]
on = { box_mm = [[0, 0, 26], [8, 8, 30]] }
force_n = [0, 0, 400]

[fill]
pattern = \"stripes\"
density = 1.0
";

#[test]
fn a_bar_is_laid_down_so_that_its_layers_do_not_part() {
    let dir = folder("orient bar");
    // Pulled along z, and standing on its end as it comes.
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    fs::write(dir.join("bar.toml"), JOB).expect("written");
    let out = grainpath(&dir, &["orient", "bar.toml", "--json", "--write"]);
    let report = json(&out);
    assert!(out.status.success(), "{report}");
    let poses = report["poses"].as_array().expect("poses");
    assert_eq!(poses.len(), 6);
    let nominal = |k: usize| poses[k]["reserve"]["first_failure"][1].as_f64().expect("a factor");
    let height = |k: usize| poses[k]["height_mm"].as_f64().expect("a height");
    // Lying the load runs along the beads, standing from layer to layer: strengths of 52 and 40 MPa of the card.
    assert!((0..4).all(|k| height(k) == 8.0) && (4..6).all(|k| height(k) == 30.0), "{report}");
    let ratio = nominal(0) / nominal(5);
    assert!(ratio > 1.1 && ratio < 1.6, "{ratio}: {report}");
    assert_eq!(poses[5]["reserve"]["mode"], "between layers");
    // Force over area, 400 N on 64 mm2: all of it goes from layer to layer where the bar stands, and none where it lies. The
    // grips press from the side a little.
    let across = |k: usize| poses[k]["reserve"]["across_layers_mpa"].as_f64().expect("a stress");
    assert!((across(5) / 6.25 - 1.0).abs() < 0.25 && across(0) < 0.3 * across(5), "{report}");
    // The job that was written is planned in that pose, loads turned with it.
    let run = json(&grainpath(&dir, &["run", "bar.toml", "--json"]));
    assert_eq!(run["z_max_mm"], 8.0, "{run}");
    let told = run["reserve"]["first_failure"][1].as_f64().expect("a factor");
    assert!((told / nominal(0) - 1.0).abs() < 0.3, "{told} {}", nominal(0));
}

/// In a part that lies as in its file, places of the plate are places of the file, and the frame can be named.
#[test]
fn loads_of_the_plate_turn_with_a_part_that_lies_as_in_its_file() {
    let dir = folder("orient plate");
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    fs::write(dir.join("bar.toml"), JOB.replace("frame = \"part\"\n", "")).expect("written");
    // A frame that is set for this run alone is not that of the job.
    let set = ["orient", "bar.toml", "--json", "--write", "--set", "guide.frame=\"part\""];
    let out = grainpath(&dir, &set);
    let report = json(&out);
    assert!(out.status.success() && report["outputs"]["job"] == "bar.toml", "{report}");
    let job = fs::read_to_string(dir.join("bar.toml")).expect("the job");
    assert!(job.contains("[guide]\nframe = \"part\"\n") && job.contains("rotate_deg = ["), "{job}");
    let again = json(&grainpath(&dir, &["orient", "bar.toml", "--json"]));
    let first = |report: &serde_json::Value| report["poses"][0]["reserve"]["first_failure"][1].as_f64();
    let ratio = first(&again).expect("a factor") / first(&report).expect("a factor");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}: the same loads on the turned part");
}

#[test]
fn poses_are_drawn_and_replace_no_input() {
    let dir = folder("orient drawn");
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    fs::write(dir.join("bar.toml"), JOB).expect("written");
    let report = json(&grainpath(&dir, &["orient", "bar.toml", "--json", "--image", "poses.png"]));
    assert_eq!(report["outputs"], serde_json::json!({ "image": "poses.png" }), "{report}");
    // Six poses are two rows of three.
    let png = fs::read(dir.join("poses.png")).expect("a picture");
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes"));
    assert_eq!(2 * number(16), 3 * number(20));
    let out = grainpath(&dir, &["orient", "bar.toml", "--image", "bar.stl"]);
    assert_eq!(out.status.code(), Some(2));
    assert_eq!(fs::read_to_string(dir.join("bar.stl")).expect("the part"), box_stl([8.0, 8.0, 30.0]));
}

#[test]
fn what_cannot_stand_or_turn_is_refused_in_a_line() {
    let dir = folder("orient refused");
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    // Twice as large as in the file: places of the plate are no places of the file.
    let scaled = JOB.replace("frame = \"part\"", "").replace("[guide]", "scale = 2\n[guide]");
    fs::write(dir.join("plate.toml"), &scaled).expect("written");
    let out = grainpath(&dir, &["orient", "plate.toml", "--write", "--json", "--image", "poses.png"]);
    assert_eq!(out.status.code(), Some(2));
    let told = json(&out);
    let told = told["error"].as_str().expect("a line");
    assert!(told.contains("guide.frame = \"part\" and shape.rotate_deg = ["), "{told}");
    assert!(dir.join("poses.png").is_file());
    assert_eq!(fs::read_to_string(dir.join("plate.toml")).expect("the job"), scaled);
    let out = grainpath(&dir, &["orient", "plate.toml", "--write"]);
    assert!(String::from_utf8_lossy(&out.stdout).contains("rank"), "the poses are told all the same");
    // Half a millimetre wide, it stands on none of its sides.
    let thin = JOB.replace("[8, 8,", "[1, 1,");
    fs::write(dir.join("bar.stl"), box_stl([1.0, 1.0, 30.0])).expect("written");
    fs::write(dir.join("thin.toml"), thin).expect("written");
    let out = grainpath(&dir, &["orient", "thin.toml", "--json"]);
    assert_eq!(out.status.code(), Some(4), "{}", String::from_utf8_lossy(&out.stdout));
    assert!(json(&out)["error"].as_str().expect("a line").contains("no flat to stand on"));
}

/// A stress result is in the frame of the part, and its job needs no loads.
#[test]
fn an_imported_stress_ranks_the_poses_and_turns_with_the_part() {
    let dir = folder("orient imported");
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    // 6 MPa along z everywhere.
    let mut table = String::from("x,y,z,sxx,syy,szz,sxy,syz,szx\n");
    for k in 0..16 * 9 {
        let [x, y, z] = [4 * (k % 3), 4 * (k / 3 % 3), 2 * (k / 9)];
        table += &format!("{x},{y},{z},0,0,6,0,0,0\n");
    }
    fs::write(dir.join("bar.csv"), &table).expect("written");
    let job = "[shape]\nmesh = \"bar.stl\"\n[guide]\nkind = \"stress\"\nimport = \"bar.csv\"\n\
               [fill]\npattern = \"stripes\"\ndensity = 1.0\n";
    fs::write(dir.join("bar.toml"), job).expect("written");
    let out = grainpath(&dir, &["orient", "bar.toml", "--json", "--image", "bar.csv"]);
    assert_eq!(out.status.code(), Some(2), "the result is an input");
    assert_eq!(fs::read_to_string(dir.join("bar.csv")).expect("the result"), table);
    let report = json(&grainpath(&dir, &["orient", "bar.toml", "--json", "--write"]));
    let poses = report["poses"].as_array().expect("poses");
    assert!(poses[0]["height_mm"] == 8.0 && poses[5]["height_mm"] == 30.0, "{report}");
    assert_eq!(poses[5]["reserve"]["across_layers_mpa"], 6.0, "{report}");
    assert!(fs::read_to_string(dir.join("bar.toml")).expect("the job").contains("rotate_deg = ["));
    let run = json(&grainpath(&dir, &["run", "bar.toml", "--json"]));
    assert_eq!(run["z_max_mm"], 8.0, "{run}");
}

/// Boxes and numbers of layers would hold for another place of the turned part.
#[test]
fn places_that_stay_on_the_plate_keep_a_part_from_being_turned_in_its_job() {
    let dir = folder("orient regions");
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    for (region, told) in [
        (
            "[[region]]\non = { box_mm = [[0, 0, 0], [8, 8, 4]] }\nprocess = { walls = 4 }\n",
            "region[1].on.box_mm",
        ),
        ("[[region]]\non = { layers = [[1, 9]] }\nprocess = { walls = 4 }\n", "region[1].on.layers"),
        ("[support]\nstyle = \"tree\"\nblock_mm = [[[0, 0, 0], [8, 8, 4]]]\n", "support.block_mm"),
    ] {
        let job = format!("{JOB}{region}");
        fs::write(dir.join("bar.toml"), &job).expect("written");
        let out = grainpath(&dir, &["orient", "bar.toml", "--json", "--write"]);
        assert_eq!(out.status.code(), Some(2), "{told}");
        let error = json(&out);
        let error = error["error"].as_str().expect("a line");
        assert!(error.contains(told) && error.contains("shape.rotate_deg = ["), "{error}");
        assert_eq!(fs::read_to_string(dir.join("bar.toml")).expect("the job"), job);
    }
}

/// A part that is not loaded is ranked by its supports and its height.
#[test]
fn without_loads_support_and_height_decide() {
    let dir = folder("orient unloaded");
    fs::write(dir.join("bar.stl"), box_stl([8.0, 8.0, 30.0])).expect("written");
    fs::write(dir.join("bar.toml"), "[shape]\nmesh = \"bar.stl\"\n").expect("written");
    let out = grainpath(&dir, &["orient", "bar.toml", "--json"]);
    let report = json(&out);
    assert!(out.status.success(), "{report}");
    let poses = report["poses"].as_array().expect("poses");
    assert_eq!((poses.len(), &poses[0]["height_mm"], &poses[5]["height_mm"]), (6, &8.0.into(), &30.0.into()));
    assert!(poses.iter().all(|p| p.get("reserve").is_none() && p["support_g"] == 0.0), "{report}");
}
