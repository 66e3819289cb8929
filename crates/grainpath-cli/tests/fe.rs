//! Finite-element files on the command line.

mod support;

use support::data::data;
use support::{box_stl, folder, grainpath, json};

const TABLE: &str = "x,y,sxx,syy,sxy\n0,0,1,2,3\n10,0,4,5,6\n0,10,7,8,9\n";

#[test]
fn inspect_tells_what_a_result_is() {
    let dir = folder("fe-inspect");
    std::fs::write(dir.join("a.csv"), TABLE).expect("a table");
    let seen = json(&grainpath(&dir, &["inspect", "a.csv", "--json"]));
    assert_eq!((seen["kind"].as_str(), seen["format"].as_str()), (Some("fe"), Some("CSV")));
    assert_eq!((seen["nodes"].as_u64(), seen["plane"].as_bool()), (Some(3), Some(true)));
    let text = grainpath(&dir, &["inspect", "a.csv"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("max von mises"));
    std::fs::write(dir.join("b.csv"), TABLE.replace("4,5", "4;5")).expect("a table");
    let refused = grainpath(&dir, &["inspect", "b.csv"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("b.csv: line 3: "));
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn inspect_reads_real_results() {
    let data = data("fea");
    let inspect = |file: &str| grainpath(&data, &["inspect", file, "--json"]);
    let plate = json(&inspect("plate_hole_linear.vtu"));
    assert_eq!((plate["nodes"].as_u64(), plate["elements"]["tet10"].as_u64()), (Some(13234), Some(6524)));
    assert!((plate["max_von_mises"].as_f64().expect("a stress") - 570.76).abs() < 0.01);
    let beams = json(&inspect("ccx_uprofile.inp"));
    assert_eq!(beams["left_out"]["beams and trusses"].as_u64(), Some(5));
}

/// A Gmsh file of one quad, 40 x 20 mm in metres, pulled at 30 degrees from x by 50 MPa, written in Pa.
fn pulled() -> String {
    let (xx, yy, xy) = (0.75 * 50e6, 0.25 * 50e6, 0.433_012_7 * 50e6);
    let mut text = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 0.04 0 0\n3 0.04 0.02 0\n4 0 0.02 0\n$EndNodes\n\
         $Elements\n1\n1 3 0 1 2 3 4\n$EndElements\n$NodeData\n1\n\"Stress\"\n1\n0\n3\n0\n6\n4\n",
    );
    for i in 1..5 {
        text += &format!("{i} {xx} {yy} 0 {xy} 0 0\n");
    }
    text + "$EndNodeData\n"
}

#[test]
fn a_result_of_another_program_guides_fill() {
    let dir = folder("fe-import");
    std::fs::write(dir.join("plate.stl"), box_stl([40.0, 20.0, 0.6])).expect("a mesh");
    std::fs::write(dir.join("r.msh"), pulled()).expect("a result");
    let job = "[shape]\nmesh = \"plate.stl\"\n[guide]\nkind = \"stress\"\nimport = \"r.msh\"\nimport_length_unit = \"m\"\n\
        import_stress_unit = \"Pa\"\ntangent = false\n[fill]\npattern = \"stripes\"\ndensity = 1.0\n[output]\ngcode = \"plate.gcode\"\n";
    std::fs::write(dir.join("job.toml"), job).expect("a job");
    let output = grainpath(&dir, &["run", "job.toml", "--json"]);
    let seen = json(&output);
    assert_eq!(seen["ok"].as_bool(), Some(true), "{seen}");
    assert!((seen["stress"]["max_von_mises_mpa"].as_f64().expect("a stress") - 50.0).abs() < 0.01, "{seen}");
    // The file holds no displacement, and nothing was solved.
    for unknown in ["dofs", "residual", "max_displacement_mm", "error_estimate"] {
        assert!(seen["stress"][unknown].is_null(), "{unknown}: {seen}");
    }
    let told = grainpath(&dir, &["run", "job.toml"]);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("peak stress: 50.0 MPa"), "{told}");
    assert!(["unknowns", "displacement", "mesh error"].iter().all(|w| !told.contains(w)), "{told}");
    let program = std::fs::read_to_string(dir.join("plate.gcode")).expect("G-code");
    // Length printed within 2 degrees of the pull, over the length of all fill.
    let (mut along, mut all, mut at, mut fill) = (0.0, 0.0, (0.0f64, 0.0f64), false);
    for line in program.lines() {
        if let Some(kind) = line.strip_prefix(";TYPE:") {
            fill = kind.to_ascii_lowercase().contains("infill");
        }
        let word = |c: char| {
            let found = line.split_whitespace().find_map(|w| w.strip_prefix(c));
            found.and_then(|w| w.parse::<f64>().ok())
        };
        if !(line.starts_with("G1") || line.starts_with("G0")) {
            continue;
        }
        let to = (word('X').unwrap_or(at.0), word('Y').unwrap_or(at.1));
        let (dx, dy) = (to.0 - at.0, to.1 - at.1);
        at = to;
        let length = (dx * dx + dy * dy).sqrt();
        if fill && length > 0.0 && word('E').is_some_and(|e| e > 0.0) {
            all += length;
            // Sine of the angle between bead and pull.
            let off = (dx * 0.5 - dy * 0.75f64.sqrt()).abs() / length;
            along += if off < 0.035 { length } else { 0.0 };
        }
    }
    // The other beads join ends of lines along the border.
    assert!(all > 1000.0 && along > 0.8 * all, "{along} of {all} mm follow the stress");
    let mean = seen["quality"]["alignment_mean_deg"].as_f64().expect("an angle");
    assert!(mean < 4.0, "the mean angle to the stress is {mean}");
    // The result turns and grows with its part: the same angles between fill and stress, the same peak.
    let turned = job.replace("[guide]", "rotate_deg = [0, 0, 50]\nscale = 1.5\n[guide]");
    std::fs::write(dir.join("job.toml"), &turned).expect("a job");
    let seen = json(&grainpath(&dir, &["run", "job.toml", "--json"]));
    assert!((seen["stress"]["max_von_mises_mpa"].as_f64().expect("a stress") - 50.0).abs() < 0.01, "{seen}");
    let mean = seen["quality"]["alignment_mean_deg"].as_f64().expect("an angle");
    assert!(mean < 4.0, "turned by 50 degrees the mean angle to the stress is {mean}");
    // The pull at 30 degrees is now one at 80: fill advances mostly along y.
    let (mut x, mut y, mut at, mut fill) = (0.0, 0.0, (0.0f64, 0.0f64), false);
    for line in std::fs::read_to_string(dir.join("plate.gcode")).expect("G-code").lines() {
        if let Some(kind) = line.strip_prefix(";TYPE:") {
            fill = kind.to_ascii_lowercase().contains("infill");
        }
        let word = |c: char| {
            line.split_whitespace().find_map(|w| w.strip_prefix(c)).and_then(|w| w.parse::<f64>().ok())
        };
        if line.starts_with("G1") || line.starts_with("G0") {
            let to = (word('X').unwrap_or(at.0), word('Y').unwrap_or(at.1));
            if fill && word('E').is_some_and(|e| e > 0.0) {
                (x, y) = (x + (to.0 - at.0).abs(), y + (to.1 - at.1).abs());
            }
            at = to;
        }
    }
    assert!(x > 0.0 && y > 2.5 * x, "fill advances by {x} and {y} mm");
    let upright = job.replace("[guide]", "rotate_deg = [90, 0, 0]\n[guide]");
    std::fs::write(dir.join("job.toml"), upright).expect("a job");
    let refused = grainpath(&dir, &["run", "job.toml"]);
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && told.contains("turns about z alone"), "{told}");
    // Read as mm and MPa, the result belongs to a part of another size.
    std::fs::write(dir.join("job.toml"), job.replace("import_length_unit = \"m\"\n", "")).expect("a job");
    let refused = grainpath(&dir, &["run", "job.toml"]);
    assert!(matches!(refused.status.code(), Some(3 | 4)), "{refused:?}");
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(told.contains("the part from (0.00, 0.00, 0.00) to (40.00, 20.00, 0.60) mm"), "{told}");
    // Tension alike in all directions of the plane leads the beads nowhere.
    std::fs::write(dir.join("job.toml"), job).expect("a job");
    let row = pulled().lines().find(|line| line.starts_with("1 375")).expect("a row").to_owned();
    let alike = pulled().replace(&row[1..], " 37500000 37500000 0 0 0 0");
    std::fs::write(dir.join("r.msh"), alike).expect("a result");
    let seen = json(&grainpath(&dir, &["run", "job.toml", "--json"]));
    let warned =
        seen["warnings"].as_array().is_some_and(|all| all.iter().any(|w| w["id"] == "fe-zero-stress"));
    assert!(warned, "{seen}");
    std::fs::write(dir.join("r.msh"), pulled().replace("\"Stress\"", "\"Strain\"")).expect("a result");
    let refused = grainpath(&dir, &["run", "job.toml"]);
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(3) && told.contains("no stress in the file; its arrays"), "{told}");
}

#[test]
fn a_stress_report_tells_peak_reserve_displacement_mesh_error_and_what_holds_the_part() {
    let dir = folder("fe-report");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let job = "[shape]\nmesh = \"bar.stl\"\n[guide]\nkind = \"stress\"\n[fill]\npattern = \"stripes\"\ndensity = 1.0\n\
        [output]\ngcode = \"bar.gcode\"\nreport = \"bar.html\"\npreview = \"pictures\"\n\
        [[guide.fixture]]\non = { box_mm = [[0, 0, 0], [6, 8, 2]] }\nfix = \"xyz\"\n\
        [[guide.load]]\non = { box_mm = [[34, 0, 0], [40, 8, 2]] }\nforce_n = [FORCE, 0, 0]\n";
    let run = |force: &str| {
        std::fs::write(dir.join("job.toml"), job.replace("FORCE", force)).expect("a job");
        let seen = json(&grainpath(&dir, &["run", "job.toml", "--json"]));
        assert_eq!(seen["ok"].as_bool(), Some(true), "{seen}");
        let told = grainpath(&dir, &["run", "job.toml"]);
        (seen, String::from_utf8_lossy(&told.stdout).into_owned())
    };
    let (seen, told) = run("100");
    let stress = &seen["stress"];
    let number = |key: &str| stress[key].as_f64().unwrap_or_else(|| panic!("{key}: {stress}"));
    // 100 N over 16 mm2, more at the grips.
    let peak = number("max_von_mises_mpa");
    assert!(peak > 6.0 && peak < 30.0, "{stress}");
    assert!((number("reserve") * peak / number("strength_mpa") - 1.0).abs() < 1e-3, "{stress}");
    let page = std::fs::read_to_string(dir.join("bar.html")).expect("a report");
    for what in [
        "peak stress",
        "strength over peak",
        "largest displacement",
        "mesh error",
        "load",
        "reaction",
        "balance",
    ] {
        assert!(told.lines().any(|line| line.starts_with(&format!("{what}: "))), "{what}: {told}");
        assert!(page.contains(&format!("<tr><th>{what}</th><td>")), "{what}");
    }
    assert!(page.contains("blue 0 MPa to red") && page.contains("Deformed shape"));
    assert!(dir.join("pictures").join("deformed.png").is_file());
    // No ratio can be told where the peak is far above the strength.
    let (seen, told) = run("100000");
    assert!(
        seen["stress"]["reserve"].is_null() && told.contains("strength over peak: none stated"),
        "{told}"
    );
}
