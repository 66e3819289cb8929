//! Every format states the same field; bytes of any kind give directions or a clear error.

use std::f64::consts::PI;
use std::io::Write;

use grainpath_core::math::{atan2, direction, sin_cos};
use grainpath_core::{DMat3, DVec2, DVec3, WarningId};
use grainpath_io::directions::{DirectionOptions, DirectionSamples, GridAxes, parse_directions};
use grainpath_io::fe::{Element, ElementKind, Encoding, PointData, VtuMesh, write_vtu};
use proptest::prelude::*;

/// Cells of the grids below, 1 mm wide, from (0, 0).
const N: [usize; 2] = [24, 16];

/// A smooth field of circles around a point beside the grid: it turns through all axes, and its
/// angle jumps from pi to 0.
fn angle(p: DVec2) -> f64 {
    (atan2(p.y - 7.0, p.x + 2.0) + PI / 2.0).rem_euclid(PI)
}

fn centre(column: usize, row: usize) -> DVec2 {
    DVec2::new(column as f64 + 0.5, row as f64 + 0.5)
}

/// All centres with their angles, row by row from below.
fn cells() -> Vec<(DVec2, f64)> {
    let all = (0..N[1]).flat_map(|r| (0..N[0]).map(move |c| centre(c, r)));
    all.map(|p| (p, angle(p))).collect()
}

fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((header.len() as u16).to_le_bytes());
    out.extend(header.bytes());
    out.extend(data);
    out
}

fn f8(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).expect("memory");
        zip.write_all(bytes).expect("memory");
    }
    zip.finish().expect("memory").into_inner()
}

fn png(samples: impl Fn(usize, usize) -> u16) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, N[0] as u32, N[1] as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let rows = (0..N[1]).rev();
    let data: Vec<u8> = rows
        .flat_map(|r| (0..N[0]).map(move |c| (c, r)))
        .flat_map(|(c, r)| samples(c, r).to_be_bytes())
        .collect();
    encoder.write_header().expect("memory").write_image_data(&data).expect("memory");
    out
}

fn read(name: &str, bytes: &[u8], options: &DirectionOptions) -> DirectionSamples {
    let mut samples = parse_directions(&[(name, bytes)], options).unwrap_or_else(|e| panic!("{name}: {e}"));
    if samples.unplaced_grid().is_some() {
        assert_eq!(samples.unplaced_grid(), Some(N), "{name}");
        samples.place_grid(DVec2::ZERO, DVec2::ONE);
    }
    samples
}

fn error(name: &str, bytes: &[u8]) -> String {
    parse_directions(&[(name, bytes)], &DirectionOptions::default()).expect_err(name).to_string()
}

/// How far samples are off the field between the centres of cells, radians, at most.
fn max_error(samples: &DirectionSamples) -> f64 {
    let mut worst = 0.0f64;
    for i in 0..200 {
        let p = DVec2::new(0.6 + (0.1123 * f64::from(i)) % 22.7, 0.6 + (0.0771 * f64::from(i)) % 14.7);
        let (found, strength) = samples.sample(p.extend(3.3)).in_plane(&DMat3::IDENTITY);
        assert!(strength > 0.9, "{p}: strength {strength}");
        worst = worst.max(((found - angle(p) + PI / 2.0).rem_euclid(PI) - PI / 2.0).abs());
    }
    worst
}

fn mesh() -> Vec<u8> {
    let nodes: Vec<DVec3> = cells().iter().map(|(p, _)| p.extend(0.0)).collect();
    let quad = |c: usize, r: usize| {
        let at = |c: usize, r: usize| (r * N[0] + c) as u32;
        Element::new(ElementKind::Quad4, &[at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)])
    };
    let elements: Vec<Element> =
        (0..N[1] - 1).flat_map(|r| (0..N[0] - 1).filter_map(move |c| quad(c, r))).collect();
    let values = cells().iter().flat_map(|(_, a)| direction(*a).extend(0.0).to_array()).collect();
    let data = [PointData { name: "Directions".into(), components: 3, component_names: Vec::new(), values }];
    let mut out = Vec::new();
    write_vtu(VtuMesh { nodes: &nodes, elements: &elements }, &data, Encoding::Zlib, &mut out)
        .expect("memory");
    out
}

#[test]
fn every_format_states_the_same_field() {
    let defaults = DirectionOptions::default();
    let table = |header: &str, row: &dyn Fn(DVec2, f64) -> String| -> Vec<u8> {
        let rows: String = cells().iter().map(|(p, a)| row(*p, *a) + "\n").collect();
        format!("{header}\n{rows}").into_bytes()
    };
    let by_columns = || (0..N[0]).flat_map(|c| (0..N[1]).map(move |r| angle(centre(c, r))));
    let by_rows = || cells().into_iter().map(|(_, a)| a);
    let xy = DirectionOptions { axes: Some(GridAxes::Xy), ..defaults.clone() };
    let image = DirectionOptions { axes: Some(GridAxes::Image), ..defaults.clone() };
    let from_top = (0..N[1]).rev().flat_map(|r| (0..N[0]).map(move |c| angle(centre(c, r))));
    let matrix: String = (0..N[0])
        .map(|c| (0..N[1]).map(|r| angle(centre(c, r)).to_string()).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    let vectors = || by_rows().flat_map(|a| direction(a).to_array());
    let record: Vec<u8> = cells().iter().flat_map(|(p, a)| f8([p.x, p.y, *a])).collect();
    let big: Vec<u8> = by_rows().flat_map(|a| (a as f32).to_be_bytes()).collect();
    let points = || f8(cells().into_iter().flat_map(|(p, _)| p.to_array()));
    let n = cells().len();
    let cases: Vec<(&str, Vec<u8>, &DirectionOptions)> = vec![
        (
            "degrees.csv",
            table("x_mm,y_mm,angle_deg", &|p, a| format!("{},{},{}", p.x, p.y, a.to_degrees())),
            &defaults,
        ),
        (
            "inches.csv",
            table("X [in];Y [in];theta [rad]", &|p, a| format!("{};{};{a}", p.x / 25.4, p.y / 25.4)),
            &defaults,
        ),
        (
            "vectors.csv",
            table("x,y,dir_x,dir_y,dir_z,strength", &|p, a| {
                let d = -3.0 * direction(a);
                format!("{},{},{},{},0,1", p.x, p.y, d.x, d.y)
            }),
            &defaults,
        ),
        ("yx.npy", npy("'<f8'", false, "(16, 24)", &f8(by_rows())), &defaults),
        ("xy.npy", npy("'<f8'", false, "(24, 16)", &f8(by_columns())), &xy),
        ("fortran.npy", npy("'<f8'", true, "(16, 24)", &f8(by_columns())), &defaults),
        ("image.npy", npy("'<f8'", false, "(16, 24)", &f8(from_top)), &image),
        ("big.npy", npy("'>f4'", false, "(16, 24)", &big), &defaults),
        ("vectors.npy", npy("'<f8'", false, "(16, 24, 2)", &f8(vectors())), &defaults),
        (
            "record.npy",
            npy("[('x', '<f8'), ('y', '<f8'), ('angle_rad', '<f8')]", false, &format!("({n},)"), &record),
            &defaults,
        ),
        (
            "points.npz",
            npz(&[
                ("points.npy", npy("'<f8'", false, &format!("({n}, 2)"), &points())),
                ("directions.npy", npy("'<f8'", false, &format!("({n}, 2)"), &f8(vectors()))),
            ]),
            &defaults,
        ),
        ("grid.npz", npz(&[("theta_rad.npy", npy("'<f8'", false, "(16, 24)", &f8(by_rows())))]), &defaults),
        ("thetaField.csv", matrix.into_bytes(), &defaults),
        ("angles.png", png(|c, r| (angle(centre(c, r)) / PI * 65535.0).round() as u16), &defaults),
        ("field.vtu", mesh(), &defaults),
    ];
    for (name, bytes, options) in &cases {
        let samples = read(name, bytes, options);
        let error = max_error(&samples);
        println!("{name}: {:.4} degrees, {:?}", error.to_degrees(), samples.summary());
        // Linear interpolation of the double angle over 1 mm, on circles of 2.5 mm and more.
        assert!(error < 0.04, "{name}: {error}");
        assert_eq!(samples.summary().samples, n, "{name}");
        // Cut anywhere: an error, or what was read until then; no panic.
        for cut in [0, 1, 7, 9, 40, bytes.len() / 2, bytes.len() - 1] {
            if let Ok(read) = parse_directions(&[(name, &bytes[..cut])], options) {
                assert!(read.summary().samples <= n, "{name} cut at {cut}: {:?}", read.summary());
            }
        }
    }
}

#[test]
fn a_folder_of_vector_slicer_has_a_mask_and_perhaps_components() {
    let matrix = |value: &dyn Fn(DVec2) -> f64| -> Vec<u8> {
        let line = |c| (0..N[1]).map(|r| value(centre(c, r)).to_string()).collect::<Vec<_>>().join(",");
        (0..N[0]).map(line).collect::<Vec<_>>().join("\n").into_bytes()
    };
    let x = matrix(&|p| direction(angle(p)).x);
    let y = matrix(&|p| direction(angle(p)).y);
    let shape = matrix(&|p| if p.x < 4.0 { 0.0 } else { 1.0 });
    let files: [(&str, &[u8]); 3] = [("a/xField.csv", &x), ("a/yField.csv", &y), ("a/shape.csv", &shape)];
    let mut samples = parse_directions(&files, &DirectionOptions::default()).expect("a folder");
    samples.place_grid(DVec2::ZERO, DVec2::ONE);
    assert_eq!(samples.summary().without_direction, 4 * N[1]);
    let (found, strength) = samples.sample(DVec3::new(12.0, 8.0, 0.0)).in_plane(&DMat3::IDENTITY);
    assert!((found - angle(DVec2::new(12.0, 8.0))).abs() < 0.02 && strength > 0.9);
    // Masked cells take the directions around them and hardly count.
    let (found, strength) = samples.sample(DVec3::new(2.0, 8.0, 0.0)).in_plane(&DMat3::IDENTITY);
    assert!(strength < 1e-3, "{strength}");
    assert!(sin_cos(found - angle(DVec2::new(4.5, 8.0))).0.abs() < 0.3, "{found}");
    let only_one = parse_directions(&files[1..], &DirectionOptions::default()).expect_err("half a vector");
    assert!(only_one.to_string().contains("thetaField.csv"), "{only_one}");
}

#[test]
fn samples_without_a_direction_are_left_out_and_counted() {
    let table = "x,y,vx,vy,strength\n0,0,1,0,1\n1,0,0,0,1\n2,0,nan,1,1\n3,0,1,1,0\n0,9,1,0,4\n9,9,1,0,2\n";
    let samples = read("a.csv", table.as_bytes(), &DirectionOptions::default());
    assert_eq!((samples.summary().samples, samples.summary().without_direction), (3, 3));
    assert_eq!(samples.warnings()[0].id, WarningId::FieldLeftOut);
    // The largest strength is 1.
    let strength = |x: f64, y: f64| samples.sample(DVec3::new(x, y, 0.0)).in_plane(&DMat3::IDENTITY).1;
    assert!((strength(0.0, 9.0) - 1.0).abs() < 1e-9 && (strength(0.0, 0.0) - 0.25).abs() < 1e-9);
    let one = read("a.csv", b"x,y,angle_deg\n3,4,30\n", &DirectionOptions::default());
    assert_eq!(one.warnings()[0].id, WarningId::FieldOneSample);
    let (axis, _) = one.sample(DVec3::new(-80.0, 5.0, 9.0)).in_plane(&DMat3::IDENTITY);
    assert!((axis - PI / 6.0).abs() < 1e-12);
    // Points on one line have no triangles.
    let line = read("a.csv", b"x,y,angle_deg\n0,0,0\n1,0,10\n2,0,20\n", &DirectionOptions::default());
    let (axis, _) = line.sample(DVec3::new(1.0, 0.0, 0.0)).in_plane(&DMat3::IDENTITY);
    assert!((axis - 10f64.to_radians()).abs() < 1e-6, "{axis}");
}

#[test]
fn heights_are_interpolated_and_a_tilted_part_sees_the_projection() {
    let mut table = String::from("x,y,z,angle_deg,spacing_mm\n");
    for (z, angle, spacing) in [(0.0, 0.0, 1.0), (2.0, 60.0, 3.0)] {
        for i in 0..9 {
            table += &format!("{},{},{z},{angle},{spacing}\n", i % 3, i / 3);
        }
    }
    let samples = read("a.csv", table.as_bytes(), &DirectionOptions::default());
    assert!(!samples.is_plane() && samples.summary().has_spacing);
    let at = |z: f64| samples.sample(DVec3::new(1.2, 0.7, z));
    assert!((at(1.0).in_plane(&DMat3::IDENTITY).0 - PI / 6.0).abs() < 1e-9);
    assert!((at(1.0).spacing_mm.expect("a spacing") - 2.0).abs() < 1e-9);
    assert!((at(9.0).in_plane(&DMat3::IDENTITY).0 - PI / 3.0).abs() < 1e-9);
    // Turned about y by a right angle, x points down: nothing of it is left in the plane.
    let down = DMat3::from_cols(-DVec3::Z, DVec3::Y, DVec3::X);
    assert!(at(0.0).in_plane(&down).1 < 1e-9);
}

#[test]
fn what_is_wrong_is_said() {
    let row = |text: &str| format!("x,y,angle_deg\n{text}\n").into_bytes();
    assert!(error("a.csv", b"").contains("empty"));
    assert!(error("a.csv", &row("0,0,nan")).contains("all 1 samples are without a direction"));
    assert!(error("a.csv", &row("inf,0,1")).contains("sample 1: coordinate inf"));
    assert!(error("a.csv", &row("1,2")).contains("line 2: 2 columns where the header has 3"));
    assert!(error("a.csv", b"x,y,colour\n1,2,3\n").contains("neither an angle"));
    assert!(error("a.csv", b"a,b,angle\n1,2,3\n").contains("no columns x and y"));
    assert!(error("a.csv", b"x,y,angle_deg,vx,vy\n1,2,3,1,0\n").contains("guide.field.array"));
    assert!(error("a.csv", b"x,y,angle_deg,strength\n1,2,3,-1\n").contains("sample 1 is negative"));
    assert!(error("a.csv", b"x,y,angle_deg,spacing\n1,2,3,0\n").contains("spacing of sample 1"));
    assert!(error("a.csv", b"1,2\n3\n").contains("line 2: 1 numbers where the first line has 2"));
    assert!(error("a.csv", "1,2,3\n".repeat(40).as_bytes()).contains("without a header"));
    assert!(error("a.bin", &[7u8; 300]).contains("no file of directions"));
    let short = error("a.npy", &npy("'<f8'", false, "(3, 4)", &f8([1.0; 11])));
    assert!(short.contains("the shape (3, 4) needs 96 bytes; there are 88"), "{short}");
    assert!(error("a.npy", &npy("'<f8'", false, "(70000, 70000)", &[])).contains("at most"));
    assert!(error("a.npy", &npy("'<f8'", false, "(99999999999, 99999999999)", &[])).contains("at most"));
    assert!(error("a.npy", &npy("'|O'", false, "(1,)", &[])).contains("is not read"));
    assert!(error("a.npy", &npy("'<f8'", false, "(8,)", &f8([1.0; 8]))).contains("two indices"));
    assert!(error("a.npy", &npy("'<f8'", false, "(2, 0)", &[])).contains("2 x 0"));
    // A bomb: 1 GiB of zeros behind a header of four numbers is never inflated.
    let mut bomb = npy("'<f8'", false, "(2, 2)", &f8([f64::NAN; 4]));
    bomb.resize(64 << 20, 0);
    assert!(error("a.npz", &npz(&[("theta.npy", bomb)])).contains("all 4 samples"));
    let different = npz(&[
        ("vx.npy", npy("'<f8'", false, "(2, 2)", &f8([1.0; 4]))),
        ("vy.npy", npy("'<f8'", false, "(2, 3)", &f8([1.0; 6]))),
    ]);
    assert!(error("a.npz", &different).contains("differ in shape"));
}

proptest! {
    #[test]
    fn changed_bytes_never_panic(which in 0usize..4, changes in prop::collection::vec((0usize..4000, any::<u8>()), 1..12)) {
        let mut bytes = match which {
            0 => npy("'<f8'", false, "(4, 5)", &f8((0..20).map(f64::from))),
            1 => npz(&[("theta.npy", npy("'<f8'", false, "(4, 5)", &f8((0..20).map(f64::from))))]),
            2 => b"x_mm,y_mm,angle_deg,strength\n0,0,10,1\n1,0,20,0.5\n0,1,30,1\n1,1,40,1\n2,2,nan,1\n".to_vec(),
            _ => b"0.1,0.2,0.3\n0.4,nan,0.6\n0.7,0.8,0.9\n".to_vec(),
        };
        let n = bytes.len();
        changes.iter().for_each(|(at, b)| bytes[at % n] = *b);
        if let Ok(samples) = parse_directions(&[("a", &bytes)], &DirectionOptions::default()) {
            let (axis, strength) = samples.sample(DVec3::new(0.4, 0.3, 0.0)).in_plane(&DMat3::IDENTITY);
            prop_assert!((0.0..=PI).contains(&axis) && (0.0..=1.0).contains(&strength));
        }
    }
}
