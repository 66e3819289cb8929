//! Paths along the grain of real photographs, against an independent structure tensor in numpy.

use std::path::Path;
use std::process::Command;

use grainpath::grain::Photo;
use grainpath::job::parse_job;
use grainpath_core::math::{atan2, cos, sin};
use grainpath_core::{DVec2, Diagnostics, Role};
use grainpath_io::image::decode;

/// Width of the board, mm.
const WIDTH_MM: f64 = 40.0;

fn photo(name: &str) -> Option<Photo> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/wood").join(name);
    let Ok(bytes) = std::fs::read(path) else {
        println!("skipped: no ../shared/data");
        return None;
    };
    Some(Photo::of(name.to_owned(), &decode(&bytes).expect(name)))
}

/// Angle from +X (rows downwards) and coherence at every pixel, rows from the top.
fn independent(photo: &Photo) -> Option<Vec<f32>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let source = folder.join(format!("{}.in", photo.name));
    let target = folder.join(format!("{}.out", photo.name));
    let raw: Vec<u8> = photo.grey.data.iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(&source, raw).expect("a file for the test");
    let px_mm = WIDTH_MM / photo.grey.width as f64;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/structure_tensor.py");
    let done = Command::new("python3")
        .arg(script)
        .args([&source, &target])
        .args([photo.grey.width.to_string(), photo.grey.height.to_string()])
        .args([(0.15 / px_mm).max(1.0).to_string(), (0.6 / px_mm).max(2.0).to_string()])
        .output();
    if !done.as_ref().is_ok_and(|o| o.status.success()) {
        println!("skipped: no python3 with numpy and scipy");
        return None;
    }
    let bytes = std::fs::read(&target).expect("what the script wrote");
    Some(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
}

#[test]
fn paths_agree_with_an_independent_structure_tensor() {
    let mut wrong = Vec::new();
    for name in [
        "deck_boards_knots_512.jpg",
        "knotty_pine_planks_512.png",
        "oak_laminate_cathedral_512.jpg",
        "plain_sawn_red_512.png",
        "walnut_straight_1024.jpg",
        "tree_rings_endgrain_256.png",
        "two_live_knots_512x128.png",
    ] {
        let Some(photo) = photo(name) else { return };
        let Some(truth) = independent(&photo) else { return };
        let (w, h) = (photo.grey.width, photo.grey.height);
        let job = format!(
            "[shape.photo]\nfiles = [\"{name}\"]\nsize_mm = [{WIDTH_MM}, {}]\nthickness_mm = 0.2\n\
             [guide]\nkind = \"grain\"\n[fill]\ndensity = 1.0\n[process]\nwalls = 1\n",
            WIDTH_MM * h as f64 / w as f64
        );
        let settings = parse_job(&job, "job.toml", &[], &|_| Err(String::new())).expect("a good job");
        let photos = std::slice::from_ref(&photo);
        let planned = grainpath::plan_photo(&settings, photos, &Diagnostics::default()).expect(name);
        let (mut sum, mut length) = (0.0, 0.0);
        let paths = planned.plan.layers[0].paths.iter().map(|p| &p.path);
        for path in paths.filter(|p| matches!(p.role, Role::SolidFill | Role::TopSkin)) {
            for (a, b, _) in (0..path.n_segments()).map(|k| path.segment(k)) {
                let n = (a.distance(b) / 0.1).ceil().max(1.0);
                for k in 0..n as usize {
                    let p: DVec2 = a.lerp(b, (k as f64 + 0.5) / n) * (w as f64 / WIDTH_MM);
                    let (x, y) = ((p.x as usize).min(w - 1), h - 1 - (p.y as usize).min(h - 1));
                    let i = y * w + x;
                    if truth[w * h + i] > 0.3 {
                        // The picture's rows run downwards, so its angle is the other way round.
                        let off = 2.0 * (atan2(b.y - a.y, b.x - a.x) + f64::from(truth[i]));
                        sum += 0.5 * atan2(sin(off), cos(off)).abs().to_degrees() * a.distance(b) / n;
                        length += a.distance(b) / n;
                    }
                }
            }
        }
        let row = format!("{name}: {:.2} degrees over {length:.0} mm", sum / length);
        println!("{row}");
        if sum / length > 8.0 || length < 400.0 {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
