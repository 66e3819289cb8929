//! Paths along the grain of real photographs and scans, compared with independent structure tensors in
//! numpy.

#[path = "../../../tests/data.rs"]
mod data;

use std::path::Path;

use grainpath_core::math::{atan2, cos, sin};
use grainpath_core::{DVec2, DVec3, Diagnostics, Role, TriMesh};
use grainpath_imaging::photo::Photo;
use grainpath_imaging::photo::warp::Shrinking;
use grainpath_io::image::decode;
use grainpath_io::volume::{Files, open_volume};
use grainpath_job::parse_job;

/// Width of the board, mm.
const WIDTH_MM: f64 = 40.0;

fn photo(name: &str) -> Photo {
    let bytes = data::read_data(&format!("wood/{name}"));
    Photo::from_image(name.to_owned(), decode(&bytes).expect(name))
}

/// Angle from +x (rows downwards) and coherence at each pixel, rows from the top.
fn independent(photo: &Photo) -> Vec<f32> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let source = folder.join(format!("{}.in", photo.name));
    let target = folder.join(format!("{}.out", photo.name));
    let raw: Vec<u8> = photo.whole().data.iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(&source, raw).expect("a file for the test");
    let px_mm = WIDTH_MM / photo.size()[0] as f64;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/structure_tensor.py");
    data::python(|python| {
        python
            .arg(script)
            .args([&source, &target])
            .args(photo.size().map(|n| n.to_string()))
            .args([(0.15 / px_mm).max(1.0).to_string(), (0.6 / px_mm).max(2.0).to_string()]);
    });
    let bytes = std::fs::read(&target).expect("what the script wrote");
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Mean angle in degrees between the dense fill of the first layer and the axis (radians) at each place,
/// and the length in mm of the fill that has an axis.
fn mean_off(planned: &grainpath::Planned, axis_rad: impl Fn(DVec2) -> Option<f64>) -> (f64, f64) {
    let (mut sum, mut length) = (0.0, 0.0);
    let paths = planned.plan.layers[0].paths.iter().map(|p| &p.path);
    for path in paths.filter(|p| matches!(p.role, Role::SolidFill | Role::TopSkin)) {
        for (a, b, _) in (0..path.n_segments()).map(|k| path.segment(k)) {
            let n = (a.distance(b) / 0.1).ceil().max(1.0);
            for k in 0..n as usize {
                let Some(axis) = axis_rad(a.lerp(b, (k as f64 + 0.5) / n)) else { continue };
                // The doubled angle makes opposite directions equal.
                let off = 2.0 * (atan2(b.y - a.y, b.x - a.x) - axis);
                sum += 0.5 * atan2(sin(off), cos(off)).abs().to_degrees() * a.distance(b) / n;
                length += a.distance(b) / n;
            }
        }
    }
    (sum / length, length)
}

#[test]
#[ignore = "needs GRAINPATH_DATA and python"]
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
        let photo = photo(name);
        let truth = independent(&photo);
        let [w, h] = photo.size();
        let job = format!(
            "[shape.photo]\nfiles = [\"{name}\"]\nsize_mm = [{WIDTH_MM}, {}]\nthickness_mm = 0.2\n\
             [guide]\nkind = \"grain\"\n[fill]\ndensity = 1.0\n[process]\nwalls = 1\n",
            WIDTH_MM * h as f64 / w as f64
        );
        let settings = parse_job(&job, "job.toml", &[], &|_| Err(String::new())).expect("a good job");
        let photos = std::slice::from_ref(&photo);
        let planned = grainpath::plan_photo(&settings, photos, None, &Diagnostics::default()).expect(name);
        let (mean, length) = mean_off(&planned, |p| {
            let p = p * (w as f64 / WIDTH_MM);
            let (x, y) = ((p.x as usize).min(w - 1), h - 1 - (p.y as usize).min(h - 1));
            let i = y * w + x;
            // Rows of the picture run downwards, so its angle has the opposite sign.
            // Below a coherence of 0.3 the independent tensor has no reliable direction.
            (truth[w * h + i] > 0.3).then(|| -f64::from(truth[i]))
        });
        let row = format!("{name}: {:.2} degrees over {length:.0} mm", mean);
        println!("{row}");
        if mean > 8.0 || length < 400.0 {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "needs GRAINPATH_DATA and python"]
fn paths_along_a_scans_texture_agree_with_an_independent_tensor() {
    const VOXEL_MM: f64 = 0.25;
    let mut wrong = Vec::new();
    // Trabeculae in this block are neither clearly fibres nor clearly plates. Our tensor mixes both
    // readings, the independent one takes the clearer.
    for (name, most_deg) in [("bone_128x128x128_u8.tif", 15.0), ("weave_150x150x150_u8.tif", 8.0)] {
        let path = data::data(&format!("ct/{name}"));
        let shown = path.display().to_string();
        let open = || {
            let files = Files::single(shown.clone(), |name| Ok(Box::new(std::fs::File::open(name)?)));
            open_volume(files, None).expect(name)
        };
        let mut source = open();
        let [nx, ny, nz] = source.info().size;
        let (mut slice, mut raw) = (Vec::new(), Vec::new());
        while source.next_slice(&mut slice).expect(name) {
            raw.extend(slice.iter().flat_map(|v| v.to_le_bytes()));
        }
        let middle = nz / 2;
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let (from, to) = (folder.join(format!("{name}.in")), folder.join(format!("{name}.out")));
        std::fs::write(&from, raw).expect("a file for the test");
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/structure_tensor_3d.py");
        let numbers = [nx, ny, nz].map(|n| n.to_string());
        data::python(|python| {
            python
                .arg(script)
                .args([&from, &to])
                .args(numbers)
                .args([(0.6 / VOXEL_MM).to_string(), middle.to_string()]);
        });
        let bytes = std::fs::read(&to).expect("what the script wrote");
        let truth: Vec<f32> =
            bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        // One layer at the height of the middle slice, filled along the scan; as wide as the scan, less a
        // margin.
        let (w, h) = (nx as f64 * VOXEL_MM, ny as f64 * VOXEL_MM);
        let job = format!(
            "[shape]\nmesh = \"a.stl\"\n[guide]\nkind = \"grain\"\nsmoothing_mm = 0.3\n[guide.volume]\npath = \"a\"\n\
             pixel_mm = {VOXEL_MM}\nslice_mm = {VOXEL_MM}\norigin_mm = [0, 0, {}]\n[fill]\ndensity = 1.0\n[process]\nwalls = 1\n",
            0.1 - (middle as f64 + 0.5) * VOXEL_MM
        );
        let settings = parse_job(&job, "job.toml", &[], &|_| Err(String::new())).expect("a good job");
        let block = block(DVec3::new(1.0, 1.0, 0.0), DVec3::new(w - 1.0, h - 1.0, 0.2));
        let body = grainpath_io::MeshBody { mesh: block, ..Default::default() };
        let mesh = grainpath_io::MeshFile {
            bodies: vec![body],
            unit: None,
            modifiers: Vec::new(),
            warnings: Vec::new(),
        };
        let inputs = grainpath::Inputs {
            directions: None,
            densities: None,
            mesh,
            path: "a.stl".into(),
            stress: None,
            deck: None,
            photos: Vec::new(),
            texture: Some(open()),
            regions: Default::default(),
            known: None,
        };
        let planned = grainpath::plan_job(&settings, inputs, &Diagnostics::default()).expect(name);
        let (mean, length) = mean_off(&planned, |p| {
            let p = p / VOXEL_MM;
            let i = (p.y as usize).min(ny - 1) * nx + (p.x as usize).min(nx - 1);
            (truth[nx * ny + i] > 0.3).then(|| f64::from(truth[i]))
        });
        let row = format!("{name}: {:.2} degrees over {length:.0} mm", mean);
        println!("{row}");
        if mean > most_deg || length < 400.0 {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn block(low: DVec3, high: DVec3) -> TriMesh {
    let corner = |k: usize| {
        let pick = |bit: usize, a: f64, b: f64| if k >> bit & 1 == 1 { b } else { a };
        DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh {
        vertices: (0..8).map(corner).collect(),
        triangles: sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
    }
}
