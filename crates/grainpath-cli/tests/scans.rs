//! CT scans: true sizes of the hub phantom, real scans, exports, bad input.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::data::data;
use support::{folder, grainpath, json};

fn job(dir: &Path, name: &str, ct: &str) {
    let text = format!(
        "[shape.ct]\n{ct}\n[process]\nskirt_loops = 0\n[printer]\nbed_mm = [400, 400, 400]\n\
         [output]\ngcode = \"{name}.gcode\"\n"
    );
    fs::write(dir.join(format!("{name}.toml")), text).expect("a job");
}

fn run(dir: &Path, name: &str, more: &[&str]) -> Value {
    let file = format!("{name}.toml");
    let out = grainpath(dir, &[&["run", &file, "--json"], more].concat());
    assert!(out.status.success(), "{name}: {}", String::from_utf8_lossy(&out.stderr));
    json(&out)
}

#[test]
fn the_hub_is_printed_in_its_true_sizes() {
    let dir = folder("hub");
    assert!(grainpath(&dir, &["new", "ct", "hub", "--pixels", "256"]).status.success());
    let iso = json(&grainpath(&dir, &["run", "hub/job.toml", "--json"]));
    let found = &iso["dimensions"];
    let mean = found["mean_error_percent"].as_f64().expect("a mean");
    assert!(mean < 0.25, "{found}");
    assert!(found["each"].as_array().is_some_and(|e| e.iter().all(|d| d["printed_mm"].is_f64())), "{found}");
    assert_eq!((iso["layers"].as_u64(), iso["scan"]["interpolation"].as_str()), (Some(160), Some("grey")));
    // A picture of the part, and pictures of the scan.
    assert!(dir.join("hub/out/preview/part.png").is_file());
    let seen = json(&grainpath(&dir, &["inspect", "hub/hub.tif", "--sheet", "sheet.png", "--json"]));
    assert_eq!(seen["voxels"], serde_json::json!([256, 256, 100]));
    let iso50 = seen["iso50"].as_f64().expect("a threshold");
    assert!((iso50 - 23000.0).abs() < 200.0, "{seen}");
    assert!(dir.join("sheet.png").is_file());
    let again =
        json(&grainpath(&dir, &["inspect", "hub/out/hub.gcode", "--truth", "hub/truth.toml", "--json"]));
    let again = again["dimensions"]["mean_error_percent"].as_f64().expect("a mean");
    assert!((again - mean).abs() < 0.02, "{again} {mean}");
    // The published method: Canny's edges and feature points.
    let paper = ["--set", "shape.ct.contours=canny", "--set", "output.report=", "--set", "output.preview="];
    let paper =
        json(&grainpath(&dir, &[&["run", "hub/job.toml", "--json", "--out", "paper"], &paper[..]].concat()));
    assert!(
        paper["dimensions"]["mean_error_percent"].as_f64().is_some_and(|e| e < 1.5),
        "{}",
        paper["dimensions"]
    );
}

#[test]
fn exports_are_written_and_the_surface_is_closed() {
    let dir = folder("scan exports");
    assert!(grainpath(&dir, &["new", "ct", "hub", "--pixels", "64"]).status.success());
    let sets = [
        "output.surface=hub.stl",
        "output.surface_cell_mm=0.8",
        "output.layers_cli=hub.cli",
        "output.layers_svg=hub.svg",
    ];
    let mut args = vec!["run", "hub/job.toml", "--json", "--out", "."];
    sets.iter().for_each(|s| args.extend(["--set", s]));
    let report = json(&grainpath(&dir, &args));
    assert_eq!(report["ok"], true, "{report}");
    let seen = json(&grainpath(&dir, &["inspect", "hub.stl", "--json"]));
    assert_eq!(
        (seen["closed"].as_bool(), seen["nonmanifold_edges"].as_u64()),
        (Some(true), Some(0)),
        "{seen}"
    );
    let cli = fs::read_to_string(dir.join("hub.cli")).expect("CLI");
    assert!(cli.starts_with("$$HEADERSTART") && cli.contains("$$LAYERS/160\n"));
    assert!(fs::read_to_string(dir.join("hub.svg")).expect("SVG").matches("<g ").count() == 160);
}

/// A scan as an image of OME-Zarr 0.5 whose chunks are plain bytes, 5 x 8 x 22 voxels each.
#[cfg(feature = "zarr")]
fn write_ome_zarr(folder: &Path, [columns, rows, slices]: [usize; 3], voxels: &[u8]) {
    let write = |name: String, bytes: &[u8]| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    };
    let axis = |name: &str| serde_json::json!({ "name": name, "type": "space", "unit": "micrometer" });
    let group = serde_json::json!({ "zarr_format": 3, "node_type": "group", "attributes": { "ome": { "version": "0.5",
        "multiscales": [{ "axes": [axis("z"), axis("y"), axis("x")], "datasets": [{ "path": "0",
            "coordinateTransformations": [{ "type": "scale", "scale": [250.0, 300.0, 300.0] }] }] }] } } });
    let array = serde_json::json!({ "zarr_format": 3, "node_type": "array", "shape": [slices, rows, columns],
        "data_type": "uint8", "fill_value": 0,
        "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": [5, 8, 22] } },
        "chunk_key_encoding": { "name": "default" }, "codecs": [{ "name": "bytes" }] });
    write("zarr.json".to_owned(), group.to_string().as_bytes());
    write("0/zarr.json".to_owned(), array.to_string().as_bytes());
    for z in 0..slices.div_ceil(5) {
        for y in 0..rows.div_ceil(8) {
            for x in 0..columns.div_ceil(22) {
                let mut chunk = Vec::new();
                for k in 5 * z..5 * z + 5 {
                    for j in 8 * y..8 * y + 8 {
                        for i in 22 * x..22 * x + 22 {
                            let inside = i < columns && j < rows && k < slices;
                            chunk.push(if inside { voxels[(k * rows + j) * columns + i] } else { 255 });
                        }
                    }
                }
                write(format!("0/c/{z}/{y}/{x}"), &chunk);
            }
        }
    }
}

#[cfg(feature = "zarr")]
#[test]
fn a_zarr_prints_as_the_same_voxels_in_a_file() {
    let dir = folder("zarr");
    let size = [26, 20, 24];
    // A leaning tube, so that no two slices are equal and no axis can be taken for another.
    let voxels: Vec<u8> = (0..size[2] * size[1] * size[0])
        .map(|at| {
            let (i, j, k) = (at % size[0], at / size[0] % size[1], at / size[0] / size[1]);
            let (x, y) = (i as f64 - 11.0 - 0.1 * k as f64, j as f64 - 9.0);
            let off = (x * x + y * y).sqrt() - 6.0;
            (120.0 - 60.0 * off.abs().min(2.0)) as u8
        })
        .collect();
    let head = format!(
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {} {} {}\nspacings: 0.3 0.3 0.25\nencoding: raw\n\n",
        size[0], size[1], size[2]
    );
    fs::write(dir.join("a.nrrd"), [head.as_bytes(), &voxels].concat()).expect("a file");
    write_ome_zarr(&dir.join("scan.ome.zarr"), size, &voxels);
    job(&dir, "nrrd", "path = \"a.nrrd\"");
    job(&dir, "zarr", "path = \"scan.ome.zarr\"");
    job(&dir, "level", "path = \"scan.ome.zarr/0\"");
    let read = |name: &str| fs::read(dir.join(format!("{name}.gcode"))).expect("G-code");
    for name in ["nrrd", "zarr", "level"] {
        let report = run(&dir, name, &["--threads", "1"]);
        assert!(report["layers"].as_u64().is_some_and(|n| n > 20), "{report}");
        assert!(read(name) == read("nrrd"), "{name}");
    }
    let seen = json(&grainpath(&dir, &["inspect", "scan.ome.zarr", "--json"]));
    assert_eq!(
        (seen["format"].as_str(), seen["sample"].as_str()),
        (Some("OME-Zarr 0.5"), Some("u8")),
        "{seen}"
    );
    assert_eq!(seen["voxels"], serde_json::json!(size));
    assert_eq!(seen["spacing_mm"], serde_json::json!([0.3, 0.3, 0.25]));
    assert_eq!(seen["stored"]["chunks"], "5 x 8 x 22");
    let told = grainpath(&dir, &["inspect", "scan.ome.zarr"]);
    assert!(String::from_utf8_lossy(&told.stdout).contains("levels 1 (0); level 0 is read"));
    // A chunk that is gone is told, and refused where warnings are; one that is cut short is an error.
    let chunk = dir.join("scan.ome.zarr/0/c/2/1/0");
    let bytes = fs::read(&chunk).expect("a chunk");
    fs::remove_file(&chunk).expect("removed");
    let report = run(&dir, "zarr", &[]);
    let ids: Vec<&str> =
        report["warnings"].as_array().into_iter().flatten().filter_map(|w| w["id"].as_str()).collect();
    assert!(ids.contains(&"scan-chunks-missing"), "{ids:?}");
    assert_eq!(grainpath(&dir, &["run", "zarr.toml", "--strict"]).status.code(), Some(4));
    fs::write(&chunk, &bytes[..bytes.len() - 1]).expect("a chunk");
    let out = grainpath(&dir, &["run", "zarr.toml"]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(3), "{text}");
    assert!(
        text.contains("0/c/2/1/0: damaged chunk [2, 1, 0]: 879 bytes of voxels; 880 are needed"),
        "{text}"
    );
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn real_scans_run_and_give_the_same_bytes_for_any_number_of_threads() {
    let data = data("ct");
    let dir = folder("real scans");
    for (name, file, ct, size) in [
        ("bolt", "bolt_70x123x66_u8.mhd", "pixel_mm = 0.4\nslice_mm = 0.4", [20.0, 40.0, 20.0]),
        ("nut", "nut_68x41x59_u8.mhd", "pixel_mm = 0.4\nslice_mm = 0.4", [22.0, 12.0, 18.0]),
        ("engine", "engine_256x256x128_u8.nii.gz", "pixel_mm = 0.3\nslice_mm = 0.3", [40.0, 60.0, 32.0]),
        ("bone", "bone_128x128x128_u8.tif", "pixel_mm = 0.3\nslice_mm = 0.3", [38.0, 38.0, 38.0]),
        ("shell", "shell_128x128x225_u8_png_stack", "pixel_mm = 0.2\nslice_mm = 0.2", [20.0, 20.0, 40.0]),
        (
            "cement",
            "cement_128x128x128_u8_tiff_stack",
            "pixel_mm = 0.15\nslice_mm = 0.15",
            [19.0, 19.0, 19.0],
        ),
        (
            "cranium",
            "cranium_256x256x108_i16.nrrd",
            "threshold = 250\ninterpolate = \"matched\"\nwindow = [60, 75]",
            [150.0, 150.0, 22.0],
        ),
        ("dicom", "phantom_philips_dicom.zip", "window = [10, 13]", [150.0, 150.0, 19.0]),
    ] {
        let path = data.join(file).display().to_string();
        job(&dir, name, &format!("path = {path:?}\n{ct}"));
        let report = run(&dir, name, &["--threads", "2"]);
        for k in 0..3 {
            let found = report["scan"]["size_mm"][k].as_f64().expect("a size");
            assert!((0.6..1.8).contains(&(found / size[k])), "{name}: {}", report["scan"]);
        }
        assert!(
            report["quality"]["spill"].as_f64().is_some_and(|s| s < 0.02),
            "{name}: {}",
            report["quality"]
        );
        if ["nut", "dicom"].contains(&name) {
            let two = fs::read(dir.join(format!("{name}.gcode"))).expect("G-code");
            run(&dir, name, &["--threads", "1"]);
            assert!(fs::read(dir.join(format!("{name}.gcode"))).expect("G-code") == two, "{name}");
        }
        // The published method gives the same part, whether of one metal or of two.
        if ["nut", "engine"].contains(&name) {
            let paper = run(&dir, name, &["--set", "shape.ct.contours=canny"]);
            let mass = |report: &Value| report["mass_g"].as_f64().expect("a mass");
            assert!(
                (mass(&paper) / mass(&report) - 1.0).abs() < 0.05,
                "{name}: {} {}",
                paper["mass_g"],
                mass(&report)
            );
        }
    }
}

#[test]
fn bad_scans_are_told_apart_by_name() {
    let dir = folder("bad scans");
    let fails = |name: &str, ct: &str, code: i32, says: &str| {
        job(&dir, name, ct);
        let out = grainpath(&dir, &["run", &format!("{name}.toml")]);
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(code), "{name}: {text}");
        assert!(text.contains(says) && text.lines().count() == 1, "{name}: {text:?} should say {says:?}");
        assert!(!dir.join(format!("{name}.gcode")).exists());
    };
    fs::write(dir.join("flat.raw"), vec![7u8; 1000]).expect("a file");
    fs::write(dir.join("step.raw"), (0..1000).map(|i| (i % 10 * 20) as u8).collect::<Vec<u8>>())
        .expect("a file");
    let raw = "size_px = [10, 10, 10]\npixel_mm = 1\nslice_mm = 1\n";
    fails("gone", "path = \"nowhere.nrrd\"", 3, "nowhere.nrrd");
    fails("spacing", "path = \"step.raw\"\nsize_px = [10, 10, 10]", 3, "set shape.ct.pixel_mm");
    fails(
        "short",
        "path = \"step.raw\"\nsize_px = [10, 10, 11]\npixel_mm = 1\nslice_mm = 1",
        3,
        "step.raw: 10 x 10 x 11",
    );
    fails("grey", &format!("path = \"flat.raw\"\n{raw}"), 3, "every voxel has the grey value 7");
    fails("nothing", &format!("path = \"step.raw\"\n{raw}threshold = 250"), 3, "leaves no material");
    fails("everything", &format!("path = \"step.raw\"\n{raw}threshold = -1"), 3, "every voxel material");
    fails(
        "word",
        &format!("path = \"step.raw\"\n{raw}threshold = \"otzu\""),
        2,
        "word.toml:6: shape.ct.threshold should be",
    );
    fails("window", &format!("path = \"step.raw\"\n{raw}window = [4, 10]"), 3, "first and last of 10 slices");
    fs::create_dir_all(dir.join("mixed")).expect("a folder");
    fails("empty", "path = \"mixed\"", 3, "mixed: no images");
    fs::write(dir.join("mixed/a1.png"), b"\x89PNG\r\n\x1a\nbroken").expect("a file");
    fails("broken", "path = \"mixed\"", 3, "a1.png");
    let huge = format!("path = \"step.raw\"\n{}", raw.replace("= 1\n", "= 1000\n"));
    fails("bed", &huge, 4, "the bed allows");
}
