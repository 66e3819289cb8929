//! Every format states the same field; bytes of any kind give directions or a clear error.

use std::f64::consts::{PI, TAU};
use std::io::Write;

use grainpath_core::math::{atan2, direction, sin_cos};
use grainpath_core::units::LengthUnit;
use grainpath_core::{DMat3, DVec2, DVec3, WarningId};
use grainpath_io::directions::{AngleUnit, DirectionOptions, DirectionSamples, GridAxes, parse_directions};
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

/// A mesh of the field, with further numbers at its nodes.
fn mesh(further: &[(&str, f64)]) -> Vec<u8> {
    let nodes: Vec<DVec3> = cells().iter().map(|(p, _)| p.extend(0.0)).collect();
    let quad = |c: usize, r: usize| {
        let at = |c: usize, r: usize| (r * N[0] + c) as u32;
        Element::new(ElementKind::Quad4, &[at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)])
    };
    let elements: Vec<Element> =
        (0..N[1] - 1).flat_map(|r| (0..N[0] - 1).filter_map(move |c| quad(c, r))).collect();
    let values = cells().iter().flat_map(|(_, a)| direction(*a).extend(0.0).to_array()).collect();
    let array = |name: &str, components, values| PointData {
        name: name.into(),
        components,
        component_names: Vec::new(),
        values,
    };
    let mut data = vec![array("Directions", 3, values)];
    data.extend(further.iter().map(|(name, v)| array(name, 1, vec![*v; nodes.len()])));
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
            "signs.csv",
            table("x [µm],y (μm),angle [°]", &|p, a| {
                format!("{},{},{}", p.x * 1e3, p.y * 1e3, a.to_degrees())
            }),
            &defaults,
        ),
        (
            "milliradians.csv",
            table("x,y,theta (mrad)", &|p, a| format!("{},{},{}", p.x, p.y, a * 1e3)),
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
        (
            "points and one name.npz",
            npz(&[
                ("points_mm.npy", npy("'<f8'", false, &format!("({n}, 2)"), &points())),
                ("direction.npy", npy("'<f8'", false, &format!("({n}, 2)"), &f8(vectors()))),
            ]),
            &defaults,
        ),
        ("grid.npz", npz(&[("theta_rad.npy", npy("'<f8'", false, "(16, 24)", &f8(by_rows())))]), &defaults),
        (
            "axes yx.npz",
            npz(&[
                ("x_mm.npy", npy("'<f8'", false, "(24,)", &f8((0..N[0]).map(|c| centre(c, 0).x)))),
                ("y_mm.npy", npy("'<f8'", false, "(16,)", &f8((0..N[1]).map(|r| centre(0, r).y)))),
                ("theta_rad.npy", npy("'<f8'", false, "(16, 24)", &f8(by_rows()))),
            ]),
            &defaults,
        ),
        (
            "axes xy.npz",
            npz(&[
                ("theta_turns.npy", npy("'<f8'", false, "(24, 16)", &f8(by_columns().map(|a| a / TAU)))),
                ("x_in.npy", npy("'<f8'", false, "(24,)", &f8((0..N[0]).map(|c| centre(c, 0).x / 25.4)))),
                ("y_in.npy", npy("'<f8'", false, "(16,)", &f8((0..N[1]).map(|r| centre(0, r).y / 25.4)))),
            ]),
            &defaults,
        ),
        (
            "meshgrid.npz",
            npz(&[
                ("X.npy", npy("'<f8'", false, "(16, 24)", &f8(cells().iter().map(|(p, _)| p.x)))),
                ("Y.npy", npy("'<f8'", false, "(16, 24)", &f8(cells().iter().map(|(p, _)| p.y)))),
                ("vx.npy", npy("'<f8'", false, "(16, 24)", &f8(by_rows().map(|a| direction(a).x)))),
                ("vy.npy", npy("'<f8'", false, "(16, 24)", &f8(by_rows().map(|a| direction(a).y)))),
            ]),
            &defaults,
        ),
        ("thetaField.csv", matrix.into_bytes(), &defaults),
        ("angles.png", png(|c, r| (angle(centre(c, r)) / PI * 65535.0).round() as u16), &defaults),
        ("field.vtu", mesh(&[]), &defaults),
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
    // Numbers may stand in quotes, words in columns that are not read, and several words for a missing number.
    let quoted = "x,y,angle_deg,label\n\"0\",\"0\",\" 10\",a\n1,0,NA,b\n0,1,,\n1,1,20,c\n";
    let quoted = read("a.csv", quoted.as_bytes(), &DirectionOptions::default());
    assert_eq!((quoted.summary().samples, quoted.summary().without_direction), (2, 2));
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
fn a_grid_keeps_its_positions_and_its_order_is_told() {
    let flat = |n: usize| npy("'<f8'", false, &format!("({n},)"), &f8((0..n).map(|i| 7.0 + 2.0 * i as f64)));
    let angles = |a: usize, b: usize| {
        let cell = |i: usize| if i % b < b / 2 { 0.3 } else { 1.2 };
        npy("'<f8'", false, &format!("({a}, {b})"), &f8((0..a * b).map(cell)))
    };
    let of = |nx, ny, [a, b]: [usize; 2]| {
        npz(&[("x.npy", flat(nx)), ("y.npy", flat(ny)), ("theta_rad.npy", angles(a, b))])
    };
    let xy = DirectionOptions { axes: Some(GridAxes::Xy), ..DirectionOptions::default() };
    // The angle changes along the second index: x by default, y where the job or the shape says so.
    for (bytes, options, along) in [
        (of(6, 6, [6, 6]), &DirectionOptions::default(), 0),
        (of(6, 6, [6, 6]), &xy, 1),
        (of(6, 8, [8, 6]), &DirectionOptions::default(), 0),
        (of(8, 6, [8, 6]), &DirectionOptions::default(), 1),
    ] {
        let read = read("a.npz", &bytes, options);
        assert_eq!(read.bounds().expect("positions").0, DVec3::new(7.0, 7.0, 0.0));
        let at = |p: DVec2| read.sample(p.extend(0.0)).in_plane(&DMat3::IDENTITY).0;
        let far = 7.0 + 2.0 * DVec2::AXES[along];
        assert!((at(far) - 0.3).abs() < 1e-9 && (at(far + 6.0 * DVec2::AXES[along]) - 1.2).abs() < 1e-9);
        let assumed = read.warnings().iter().filter(|w| w.id == WarningId::FieldAssumed).count();
        let is_square = bytes == of(6, 6, [6, 6]) && options.axes.is_none();
        assert_eq!(assumed, usize::from(is_square), "{:?}", read.summary());
        assert_eq!(read.summary().axis_order.contains("a[x][y]"), along == 1);
    }
    let wrong = |bytes: Vec<u8>, options: &DirectionOptions| {
        parse_directions(&[("a.npz", &bytes)], options).expect_err("does not fit").to_string()
    };
    assert!(wrong(of(6, 9, [8, 6]), &xy).contains("x has 6 and y has 9 places"));
    assert!(wrong(of(6, 8, [8, 6]), &xy).contains("in the order of guide.field.axes"));
    let without_y = npz(&[("x.npy", flat(6)), ("theta_rad.npy", angles(8, 6))]);
    assert!(wrong(without_y, &xy).contains("no columns x and y among x, theta_rad"));
    let nan = npz(&[
        ("points.npy", npy("'<f8'", false, "(3, 2)", &f8([0.0, 1.0, 2.0, f64::NAN, 4.0, 5.0]))),
        ("directions.npy", npy("'<f8'", false, "(3, 2)", &f8([1.0; 6]))),
    ]);
    assert!(wrong(nan, &xy).contains("sample 2: coordinate NaN"));
    let points = npy("'<f8'", false, "(6, 2)", &f8((0..12).map(f64::from)));
    let unknown = npz(&[("points.npy", points.clone()), ("lines.npy", points)]);
    assert!(wrong(unknown, &xy).contains("none of the arrays points, lines is known"));
}

#[test]
fn numbers_without_names_are_no_grid_unless_the_job_says_so() {
    let array = |rows: usize, columns: usize| {
        npy("'<f8'", false, &format!("({rows}, {columns})"), &f8((0..rows * columns).map(|i| i as f64)))
    };
    let lines =
        |rows: usize, columns: usize| (vec!["1.5"; columns].join(",") + "\n").repeat(rows).into_bytes();
    for (name, bytes) in [
        ("n3.npy", array(40, 3)),
        ("n4.npy", array(36, 4)),
        ("3n.npy", array(3, 40)),
        ("n3.npz", npz(&[("arr_0.npy", array(40, 3))])),
        ("a.csv", lines(36, 4)),
        ("a.csv", lines(25, 3)),
    ] {
        assert!(error(name, &bytes).contains("without a header or names"), "{name}");
        for options in [
            DirectionOptions { axes: Some(GridAxes::Yx), ..DirectionOptions::default() },
            DirectionOptions { cell_mm: Some(0.5), ..DirectionOptions::default() },
        ] {
            assert!(parse_directions(&[(name, &bytes)], &options).is_ok(), "{name}");
        }
    }
    for (name, bytes) in [("a.csv", lines(8, 4)), ("a.npy", array(40, 7)), ("b/thetaField.csv", lines(36, 4))]
    {
        assert!(parse_directions(&[(name, &bytes)], &DirectionOptions::default()).is_ok(), "{name}");
    }
}

#[test]
fn strength_and_spacing_are_read_in_their_own_unit_from_grids_and_meshes() {
    let grid = |name: &str, value: f64| {
        let numbers = |v: f64| npy("'<f8'", false, "(2, 3)", &f8([v; 6]));
        npz(&[("theta_rad.npy", numbers(0.3)), (name, numbers(value))])
    };
    let defaults = DirectionOptions::default();
    let inch = DirectionOptions { length_unit: Some(LengthUnit::Inch), ..defaults.clone() };
    let spacing = |bytes: &[u8], options: &DirectionOptions| {
        let mut read = parse_directions(&[("a.npz", bytes)], options).expect("directions");
        read.place_grid(DVec2::ZERO, DVec2::ONE);
        read.sample(DVec3::new(1.5, 1.0, 0.0)).spacing_mm.expect("a spacing")
    };
    for (name, value) in [("spacing", 2.0), ("spacing_mm", 2.0), ("distance_mm", 2.0), ("spacing_cm", 0.2)] {
        assert!((spacing(&grid(&format!("{name}.npy"), value), &defaults) - 2.0).abs() < 1e-6, "{name}");
    }
    for (name, value, options) in [
        ("spacing_in.npy", 2.0 / 25.4, &defaults),
        ("spacing_mm.npy", 2.0, &inch),
        ("spacing.npy", 2.0 / 25.4, &inch),
    ] {
        assert!((spacing(&grid(name, value), options) - 2.0).abs() < 1e-6, "{name}");
    }
    let one = npz(&[
        ("theta_rad.npy", npy("'<f8'", false, "(2, 3)", &f8([0.3; 6]))),
        ("spacing.npy", npy("'<f8'", false, "()", &f8([2.0]))),
    ]);
    assert!(error("a.npz", &one).contains("differ in shape: spacing has no index, not 2 x 3"));
    let read = read("a.vtu", &mesh(&[("spacing_cm", 0.3), ("strength", 0.5)]), &defaults);
    assert!(read.summary().has_spacing && read.summary().has_strength);
    let found = read.sample(DVec3::new(7.3, 8.1, 0.0));
    assert!((found.spacing_mm.expect("a spacing") - 3.0).abs() < 1e-6);
    assert!((found.in_plane(&DMat3::IDENTITY).1 - 0.5).abs() < 0.02);
    assert!(error("a.vtu", &mesh(&[("spacing", -1.0)])).contains("spacing of sample 1 is not above 0"));
}

#[test]
fn upright_directions_are_none() {
    let zs = "x,y,vx,vy,vz\n0,0,1e-4,2e-4,1\n9,0,0,0,1\n0,9,-3e-5,0,1\n9,9,0,0,-1\n";
    // The same directions in a plane of a part that is turned by a right angle about x.
    let turned = DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y);
    let plane = "x,y,angle_deg\n0,0,90\n9,0,90\n0,9,90.01\n9,9,89.99\n";
    let grid = npy("'<f8'", false, "(3, 3, 3)", &f8([1e-4, 0.0, 1.0].repeat(9)));
    for (bytes, turn) in [(zs.as_bytes(), DMat3::IDENTITY), (plane.as_bytes(), turned)] {
        let samples = read("a.csv", bytes, &DirectionOptions::default());
        for p in [DVec3::new(0.0, 0.0, 0.0), DVec3::new(3.3, 4.4, 0.0), DVec3::new(0.0, 9.0, 0.0)] {
            assert_eq!(samples.sample(p).in_plane(&turn), (0.0, 0.0));
        }
    }
    assert!(error("a.npy", &grid).contains("all 9 samples are without a direction"));
    // A direction that leans by two degrees from upright still has a part in the plane.
    let lean = "x,y,vx,vy,vz\n0,0,0,0.035,1\n9,0,0,0.035,1\n0,9,0,0.035,1\n";
    let samples = read("a.csv", lean.as_bytes(), &DirectionOptions::default());
    let (axis, strength) = samples.sample(DVec3::new(2.0, 2.0, 0.0)).in_plane(&DMat3::IDENTITY);
    assert!((axis - PI / 2.0).abs() < 1e-9 && (1e-3..2e-3).contains(&strength));
}

#[test]
fn floating_point_pictures_are_shares() {
    let tiff = |value: f32| {
        let mut out = std::io::Cursor::new(Vec::new());
        let mut encoder = tiff::encoder::TiffEncoder::new(&mut out).expect("memory");
        let pixels = [0.0, 1.0, 0.25, value, 0.5, 0.5];
        encoder.write_image::<tiff::encoder::colortype::Gray32Float>(3, 2, &pixels).expect("memory");
        out.into_inner()
    };
    for value in [1.5, 45.0, -0.1] {
        let told = error("a.tif", &tiff(value));
        assert!(told.contains(&format!("the grey {value:?} in row 2, column 1")), "{told}");
        assert!(told.contains("in degrees divided by 180"), "{told}");
    }
    let mut read = parse_directions(&[("a.tif", &tiff(0.75))], &DirectionOptions::default()).expect("shares");
    read.place_grid(DVec2::ZERO, DVec2::ONE);
    let (axis, _) = read.sample(DVec3::new(0.5, 0.5, 0.0)).in_plane(&DMat3::IDENTITY);
    assert!((axis - 0.75 * PI).abs() < 1e-6, "{axis}");
}

#[test]
fn units_are_known_or_refused() {
    let angle = |header: &str, row: &str| {
        let text = format!("{header}\n{row}\n");
        let read = parse_directions(&[("a.csv", text.as_bytes())], &DirectionOptions::default());
        read.map(|r| r.sample(DVec3::ZERO).in_plane(&DMat3::IDENTITY).0).map_err(|e| e.to_string())
    };
    for (header, value) in [
        ("x,y,angle [°]", "2"),
        ("x,y,angle (degrees)", "2"),
        ("x,y,angle_mrad", "34.906585039886591"),
        ("x,y,orientation [turns]", "0.0055555555555555"),
    ] {
        let found = angle(header, &format!("1,2,{value}")).expect("a known unit");
        assert!((found.to_degrees() - 2.0).abs() < 1e-6, "{header}: {found}");
    }
    let latin: &[u8] = b"x [\xb5m],y [\xb5m],angle [\xb0]\n1000,2000,2\n";
    let read = read("a.csv", latin, &DirectionOptions::default());
    assert!((read.bounds().expect("a point").0 - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-12);
    assert!(read.warnings().iter().all(|w| w.id == WarningId::FieldOneSample));
    for (header, row, says) in [
        (
            "x,y,angle [gon]",
            "1,2,3",
            "the unit \"gon\" of angle [gon] is not known; deg, rad, mrad and turns are",
        ),
        ("x [furlong],y,angle_deg", "1,2,3", "the unit \"furlong\" of x [furlong] is not known"),
        ("x,y,angle_deg,spacing [px]", "1,2,3,4", "the unit \"px\" of spacing [px] is not known"),
        ("x,y_in,angle_deg", "1,2,3", "x and y_in differ in unit"),
        ("x_mm,y_in,angle_deg", "1,2,3", "x_mm and y_in differ in unit"),
        ("x_cm,y,z_mm,angle_deg", "1,2,3,4", "x_cm and z_mm differ in unit"),
        (
            "x,y,angle_deg",
            "40,5,-50,1,20,3",
            "line 2: 6 columns where the header has 3; numbers with decimal commas",
        ),
    ] {
        let told = angle(header, row).expect_err(header);
        assert!(told.contains(says), "{told}");
    }
    // Lines that end with a separator, and a unit that the job states.
    assert!(angle("x,y_mm,angle_deg", "1,2,3,").is_ok());
    let job = DirectionOptions {
        length_unit: Some(LengthUnit::Millimetre),
        angle_unit: Some(AngleUnit::Degree),
        ..DirectionOptions::default()
    };
    assert!(parse_directions(&[("a.csv", b"x,y_in,angle [gon]\n1,2,3\n")], &job).is_ok());
}

#[test]
fn what_is_wrong_is_said() {
    let row = |text: &str| format!("x,y,angle_deg\n{text}\n").into_bytes();
    assert!(error("a.csv", b"").contains("empty"));
    assert!(error("a.csv", &row("0,0,nan")).contains("all 1 samples are without a direction"));
    assert_eq!(error("a.csv", &row("inf,0,1")), "sample 1: coordinate inf is not a finite number below 1e9");
    assert_eq!(
        error("a.csv", &row("1e300,0,1")),
        "sample 1: coordinate 1e300 is not a finite number below 1e9"
    );
    let foo = DirectionOptions { array: Some("foo".into()), ..DirectionOptions::default() };
    let grid = npz(&[("theta.npy", npy("'<f8'", false, "(2, 2)", &f8([1.0; 4])))]);
    for (name, bytes, all) in [("a.csv", row("0,0,1"), "x, y, angle_deg"), ("a.npz", grid, "theta")] {
        let told = parse_directions(&[(name, &bytes)], &foo).expect_err("no foo").to_string();
        assert_eq!(told, format!("no directions: there is no \"foo\" among {all}"));
    }
    assert_eq!(error("a.csv", &row("1,2")), "line 2: 2 columns where the header has 3");
    assert!(error("a.csv", b"x,y,colour\n1,2,3\n").contains("neither an angle"));
    let wrong_word = "line 3: found \"20 deg\" where a number should be";
    assert_eq!(error("a.csv", b"x,y,angle_deg\n0,0,10\n1,0,20 deg\n"), wrong_word);
    assert_eq!(error("a.csv", b"x,y,Fibre_x,Fibre_y\n0,0,1,0\n1,0,\"20 deg\",1\n"), wrong_word);
    assert_eq!(error("a.csv", b"1,2,3\n2,,3\n"), "line 2: found \"\" where a number should be");
    assert_eq!(
        error("a.csv", b"x,coord_x,y,angle_deg\n0,1,0,10\n1,2,0,20\n"),
        "the columns x and coord_x both hold x and differ; rename the one that is not meant"
    );
    assert!(
        error("a.csv", b"x,y,angle_deg,theta\n0,0,1,2\n").contains("several directions (angle_deg; theta)")
    );
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
