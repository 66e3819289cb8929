//! Photographs to printed grain, as a user would do it.

mod support;

use std::fs;
use std::path::Path;

use support::{folder, grainpath, json};

/// The example in a folder for the test, thin and therefore quick.
const THIN: [&str; 4] = ["--set", "shape.photo.thickness_mm=0.8", "--set", "fill.mass_g=1.57"];

#[test]
fn the_example_is_what_new_writes_and_its_variants_weigh_the_same() {
    let folder = folder("woodgrain");
    assert!(grainpath(&folder, &["new", "woodgrain", "."]).status.success());
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/woodgrain");
    for name in ["job.toml", "grid.toml", "triangles.toml", "rectilinear.toml", "board.png"] {
        let (made, shipped) = (fs::read(folder.join(name)), fs::read(example.join(name)));
        assert!(made.is_ok_and(|m| shipped.is_ok_and(|s| s == m)), "examples/woodgrain/{name} is stale");
    }
    let mut masses = Vec::new();
    for job in ["job.toml", "grid.toml", "triangles.toml", "rectilinear.toml"] {
        let args = [&["run", job, "--json"][..], &THIN[..]].concat();
        let report = json(&grainpath(&folder, &args));
        masses.push(report["mass_g"].as_f64().expect("a mass"));
        if job == "job.toml" {
            let photo = &report["grain"][0];
            assert!(photo["coherence"].as_f64().is_some_and(|c| c > 0.8), "{photo}");
            let corner = photo["corners_px"][2].as_array().expect("a corner");
            let at = |k: usize| corner[k].as_f64().unwrap_or(f64::NAN);
            assert!((at(0) - 868.0).abs() < 1.0 && (at(1) - 258.0).abs() < 1.0, "{photo}");
        }
    }
    let (low, high) = masses.iter().fold((f64::MAX, 0.0f64), |(l, h), m| (l.min(*m), h.max(*m)));
    assert!(high / low < 1.01, "{masses:?}");
    let preview = folder.join("out/preview");
    for step in ["1_photograph", "2_rectified", "3_denoised", "4_edges", "5_field", "6_curves"] {
        assert!(preview.join(format!("grain_{step}.png")).is_file(), "{step}");
    }
}

#[test]
fn the_grain_of_a_photograph_is_drawn_before_a_plan() {
    let folder = folder("woodgrain_inspect");
    assert!(grainpath(&folder, &["new", "woodgrain", "."]).status.success());
    let seen = json(&grainpath(&folder, &["inspect", "board.png", "--image", "grain.png", "--json"]));
    assert!(seen["image"].as_str().is_some_and(|told| told.starts_with("grain.png: ")), "{seen}");
    let picture = fs::read(folder.join("grain.png")).expect("a picture");
    assert_eq!(&picture[1..4], b"PNG");
    // Other files have no such picture, and the photograph is not replaced by it.
    for (file, image) in [("job.toml", "job.png"), ("board.png", "board.png")] {
        let out = grainpath(&folder, &["inspect", file, "--image", image]);
        assert_eq!(out.status.code(), Some(2), "{}", String::from_utf8_lossy(&out.stderr));
    }
}

/// What a run reads as directions is shown as such, and a picture says how `guide.field` would read it.
#[test]
fn inspect_tells_how_directions_are_read() {
    let dir = folder("directions_inspect");
    let matrix = "0.1,0.2,0.3\n0.4,0.5,0.6\n".repeat(2);
    fs::create_dir_all(dir.join("slicer")).expect("a folder");
    fs::write(dir.join("slicer/thetaField.csv"), &matrix).expect("a file");
    fs::write(dir.join("matrix.csv"), &matrix).expect("a file");
    for name in ["slicer", "matrix.csv"] {
        let seen = json(&grainpath(&dir, &["inspect", name, "--json"]));
        assert_eq!(seen["kind"], "directions", "{seen}");
        assert_eq!(seen["layout"], "a grid of 4 x 3 cells (x, y)");
        assert!(seen["axis_order"].as_str().is_some_and(|told| told.starts_with("a[x][y]")), "{seen}");
        assert!(seen["frame"].as_str().is_some_and(|told| told.contains("part")), "{seen}");
    }
    // Points without a header.
    fs::write(dir.join("points.csv"), "1.5,2.5,0.3\n".repeat(20)).expect("a file");
    let out = grainpath(&dir, &["inspect", "points.csv"]);
    let stderr = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("without a header") && stderr.matches("points.csv").count() == 1, "{stderr}");
    // A BMP of 2 x 1 pixels, grey and coloured.
    for (name, blue, says) in
        [("grey.bmp", 90, "2 x 1 cells (x, y); grey 0 to maximum"), ("red.bmp", 0, "not read: ")]
    {
        let mut bmp = b"BM".to_vec();
        bmp.extend([62u32, 0, 54, 40, 2, 1].into_iter().flat_map(u32::to_le_bytes));
        bmp.extend([1u16, 24].into_iter().flat_map(u16::to_le_bytes));
        bmp.extend([0u32, 8, 2835, 2835, 0, 0].into_iter().flat_map(u32::to_le_bytes));
        bmp.extend([blue, 90, 90, 90, 90, 90, 0, 0]);
        fs::write(dir.join(name), bmp).expect("a file");
        let seen = json(&grainpath(&dir, &["inspect", name, "--json"]));
        assert_eq!(seen["kind"], "image", "{seen}");
        assert!(seen["guide_field"].as_str().is_some_and(|told| told.contains(says)), "{seen}");
    }
}

#[test]
fn a_size_that_does_not_fit_the_photograph_is_told() {
    let folder = folder("woodgrain_stretched");
    assert!(grainpath(&folder, &["new", "woodgrain", "."]).status.success());
    // 900 x 300 pixels.
    for (size, told) in [("[90,30]", false), ("[30,90]", true), ("[100,60]", true)] {
        let size = format!("shape.photo.size_mm={size}");
        let thin = "shape.photo.thickness_mm=0.8";
        let sets = ["slice", "board.png", "--set", &size, "--set", thin, "-o", "board.gcode", "--json"];
        let report = json(&grainpath(&folder, &sets));
        let warnings = report["warnings"].as_array().expect("warnings");
        assert_eq!(warnings.iter().any(|w| w["id"] == "photo-proportions"), told, "{size}: {report}");
    }
}

#[test]
fn edges_and_field_are_the_same_bytes_for_any_number_of_threads() {
    let folder = folder("woodgrain_threads");
    assert!(grainpath(&folder, &["new", "woodgrain", "."]).status.success());
    for mode in ["guide.mode=edges", "guide.mode=field"] {
        let mut programs = Vec::new();
        for threads in ["1", "2", "5"] {
            let args = [&["run", "job.toml", "--threads", threads, "--set", mode][..], &THIN[..]].concat();
            assert!(grainpath(&folder, &args).status.success());
            programs.push(fs::read(folder.join("out/woodgrain.gcode")).expect("a program"));
        }
        assert!(programs.windows(2).all(|w| w[0] == w[1]), "{mode}");
    }
}

#[test]
fn what_cannot_be_read_is_said_in_a_line() {
    let folder = folder("woodgrain_errors");
    assert!(grainpath(&folder, &["new", "woodgrain", "."]).status.success());
    let board = fs::read(folder.join("board.png")).expect("the board");
    fs::write(folder.join("cut.png"), &board[..board.len() / 2]).expect("a file");
    fs::write(folder.join("text.png"), "no image").expect("a file");
    let corners = "shape.photo.corners_px=";
    for (sets, code, expect) in [
        (vec!["shape.photo.files=[\"cut.png\"]".to_owned()], 3, "ends before its last row"),
        (vec!["shape.photo.files=[\"text.png\"]".to_owned()], 3, "not an image"),
        (vec!["shape.photo.files=[\"none.png\"]".to_owned()], 3, "none.png"),
        (vec![format!("{corners}[[0,0],[899,299],[899,0],[0,299]]")], 2, "cross"),
        (vec![format!("{corners}[[0,0],[2000,0],[899,299],[0,299]]")], 2, "corner 2"),
        (vec![format!("{corners}[[0,0]]")], 2, "4 corners"),
        (vec!["shape.photo.corners=markers".to_owned()], 3, "corner markers found"),
        (vec!["shape.photo.size_mm=[0, 30]".to_owned()], 2, "size_mm"),
        (vec!["shape.photo.heights_mm=[0, 1]".to_owned()], 2, "heights_mm"),
    ] {
        let mut args = vec!["run".to_owned(), "job.toml".into()];
        sets.into_iter().for_each(|s| args.extend(["--set".into(), s]));
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let output = grainpath(&folder, &args);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {text}");
        assert!(text.contains(expect) && text.lines().count() == 1, "{args:?}: {text}");
    }
}

#[test]
fn a_marker_sheet_and_an_image_to_inspect() {
    let folder = folder("woodgrain_markers");
    assert!(grainpath(&folder, &["markers", "100", "30"]).status.success());
    assert!(grainpath(&folder, &["markers", "100", "30", "-o", "sheet.pdf"]).status.success());
    let svg = fs::read_to_string(folder.join("markers.svg")).expect("a sheet");
    assert!(svg.contains("<svg") && fs::read(folder.join("sheet.pdf")).is_ok_and(|b| b.starts_with(b"%PDF")));
    assert_eq!(grainpath(&folder, &["markers", "3", "30"]).status.code(), Some(2));
    assert!(grainpath(&folder, &["new", "woodgrain", "."]).status.success());
    let image = json(&grainpath(&folder, &["inspect", "board.png", "--json"]));
    assert_eq!((image["kind"].as_str(), image["width"].as_u64()), (Some("image"), Some(900)));
}
