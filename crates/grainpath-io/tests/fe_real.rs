//! Each real file of the shared data is read with the values of its table, or refused with the reason.

#[path = "../../../tests/data.rs"]
mod data;

use std::path::PathBuf;
use std::time::Instant;

use grainpath_core::DVec3;
use grainpath_core::units::LengthUnit;
use grainpath_io::fe::{
    Behaviour, Elastic, ElementKind, FeError, FeFile, FeOptions, FeResult, StressField, parse_fe, von_mises,
};

fn read(file: &str) -> FeFile {
    let bytes = data::read_data(&format!("fea/{file}"));
    parse_fe(&bytes, Some(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

fn result(file: &str, options: &FeOptions) -> FeResult {
    let result = read(file).result(options).unwrap_or_else(|e| panic!("{file}: {e}"));
    assert!(result.warnings.is_empty(), "{file}: {:?}", result.warnings);
    result
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn every_file_reads_or_says_why() {
    let folder = data::data("fea");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("the folder").map(|f| f.expect("a file").path()).collect();
    files.sort();
    assert!(files.len() > 30, "{} files", files.len());
    for path in files {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let read = parse_fe(&std::fs::read(&path).expect("a file"), None);
        match read {
            Ok(file) if name == "ccx_uprofile.inp" => {
                assert_eq!(file.left_out, [("beams and trusses".to_owned(), 5)]);
            }
            Ok(file) => assert!(!file.nodes.is_empty() && !file.elements.is_empty(), "{name}"),
            Err(e) => assert!(name == "bracket.step" && e == FeError::Geometry, "{name}: {e}"),
        }
    }
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn meshes_are_as_the_table_says() {
    use ElementKind::{Hex8, Hex20, Quad4, Quad8, Tet4, Tet10, Tri3, Tri6};
    type Row<'a> = (&'a str, usize, &'a [(ElementKind, usize)]);
    let table: [Row<'_>; 14] = [
        ("nafems_le1.inp", 433, &[(Quad8, 128)]),
        ("nafems_le1.frd", 433, &[(Quad8, 128)]),
        ("nafems_le1_v22.msh", 433, &[(Quad8, 128)]),
        ("nafems_le1_v41.msh", 433, &[(Quad8, 128)]),
        ("bracket.vtu", 19126, &[(Tet10, 11076)]),
        ("bracket.inp", 19126, &[(Tet10, 11076)]),
        ("plate_hole_freecad.inp", 13234, &[(Tet10, 6524)]),
        ("vtk_CylinderQuadratic.vtk", 2814, &[(Tet10, 1522)]),
        ("vtk_can.vtu", 6724, &[(Hex8, 4800)]),
        ("ccx_disk2.inp", 102, &[(Hex20, 8)]),
        ("skfem_beams.msh", 289, &[(Tri3, 8), (Tet4, 851)]),
        ("sfepy_abaqus_quad_tri.inp", 34, &[(Tri3, 8), (Quad4, 20)]),
        ("skfem_quadratic_tri.msh", 262, &[(Tri6, 119)]),
        ("sfepy_cross3d.mesh", 32, &[(Hex8, 7)]),
    ];
    for (name, n, kinds) in table {
        let file = read(name);
        assert_eq!((file.nodes.len(), file.kinds().as_slice()), (n, kinds), "{name}");
        let sizes: Vec<f64> = file.elements.iter().map(|e| e.size(&file.nodes)).collect();
        assert!(sizes.iter().all(|&v| v > 0.0), "{name}: an element without volume");
    }
    // One mesh in three formats has one area: that of the quarter ring between two ellipses.
    let area = std::f64::consts::PI / 4.0 * (3.25 * 2.75 - 2.0);
    for name in ["nafems_le1.inp", "nafems_le1_v22.msh", "nafems_le1_v41.msh"] {
        let file = read(name);
        let sum: f64 = file.elements.iter().map(|e| e.size(&file.nodes)).sum();
        assert!((sum / area - 1.0).abs() < 1e-4, "{name}: {sum} {area}");
    }
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn le1_has_its_stress_at_point_d() {
    let metres = FeOptions { length_unit: Some(LengthUnit::Metre), ..FeOptions::default() };
    let result = result("nafems_le1.frd", &metres);
    assert!(result.plane && result.displacement.is_some());
    let field = StressField::new(result);
    let s = field.sample(DVec3::new(2000.0, 0.0, 17.0));
    // The value is CalculiX's own on this mesh; the target of NAFEMS is 92.7 MPa.
    assert!((s[1] - 93.2).abs() < 0.05, "SYY at D is {}", s[1]);
    // Just outside the mesh the value is that of the nearest point in it.
    let outside = field.sample(DVec3::new(1990.0, 0.0, 0.0));
    assert!((outside[1] - s[1]).abs() < 0.5, "{} {}", outside[1], s[1]);
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn peaks_of_bracket_and_plate() {
    let bracket = result("bracket.vtu", &FeOptions::default());
    assert!((bracket.max_von_mises_mpa() - 43.6).abs() < 0.1, "{}", bracket.max_von_mises_mpa());
    let plate = result("plate_hole_linear.vtu", &FeOptions::default());
    let sxx = plate.stress.iter().map(|s| s[0]).fold(0.0, f64::max);
    assert!((sxx - 578.0).abs() < 0.5, "{sxx}");
    // The edge of the hole across the load; Howland's solution for this width is about the same.
    let at = StressField::new(plate).sample(DVec3::new(0.0, 50.0, 5.0));
    assert!((at[0] - 560.0).abs() < 25.0, "{at:?}");
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn freecad_result_and_beam() {
    let bar = result("freecad_box_static.frd", &FeOptions::default());
    assert!(bar.max_von_mises_mpa() > 2000.0, "{}", bar.max_von_mises_mpa());
    let beam = result("beamp_with_stress.frd", &FeOptions::default());
    // 9 N at the end of 8 mm, section 1 x 1 mm: the moment at half length gives 6 M / b h^2 = 216 MPa.
    let s = StressField::new(beam).sample(DVec3::new(0.5, 0.0, 4.0));
    assert!((s[2].abs() / 216.0 - 1.0).abs() < 0.02, "{s:?}");
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn decks_keep_material_supports_and_loads() {
    let file = read("nafems_le1.inp");
    let deck = file.deck.as_ref().expect("a deck");
    let (material, thickness) = deck.section_of(5).expect("a section");
    assert_eq!(material.elastic, Some(Elastic::Isotropic { e: 210_000.0, nu: 0.3 }));
    assert_eq!((thickness, deck.behaviours[0]), (Some(0.1), Behaviour::PlaneStress));
    assert_eq!((deck.fixed.len(), deck.steps.len(), deck.steps[0].face_loads.len()), (34, 1, 16));
    // The pressure is negative and pulls on the outer ellipse.
    for load in &deck.steps[0].face_loads {
        let e = &file.elements[load.element as usize];
        for &corner in e.kind.faces()[load.face as usize] {
            let p = file.nodes[e.nodes()[corner] as usize];
            assert!(
                ((p.x / 3.25).powi(2) + (p.y / 2.75).powi(2) - 1.0).abs() < 1e-6 && load.pressure == -10.0
            );
        }
    }
    let file = read("bracket.inp");
    let deck = file.deck.as_ref().expect("a deck");
    let force: f64 = deck.steps[0].point_loads.iter().map(|l| l.value).sum();
    assert!((force + 500.0).abs() < 0.01 && deck.steps[0].point_loads.iter().all(|l| l.axis == 2), "{force}");
    let file = read("ccx_disk2.inp");
    assert!(
        file.warnings.iter().any(|w| w.text.contains("*EQUATION") && !w.text.contains("CENTRIF")),
        "{:?}",
        file.warnings
    );
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn loads_of_decks_add_up() {
    // Pressure times area: 10 MPa on the outer quarter ellipse, 0.1 m thick, outwards; 130 MPa on 200 x
    // 10 mm.
    let le1 = read("nafems_le1.inp");
    let forces = le1.nodal_forces(0).expect("a step");
    let sum: DVec3 = forces.iter().copied().sum();
    assert!((sum - DVec3::new(2.75, 3.25, 0.0)).length() < 1e-6, "{sum}");
    let plate = read("plate_hole_freecad.inp");
    let sum: DVec3 = plate.nodal_forces(0).expect("a step").iter().copied().sum();
    assert!((sum - DVec3::new(130.0 * 2000.0, 0.0, 0.0)).length() < 1e-3, "{sum}");
    let bar = read("ccx_planestress.inp");
    let sum: DVec3 = bar.nodal_forces(0).expect("a step").iter().copied().sum();
    assert!(sum.length() > 0.5 && sum.z == 0.0, "{sum}");
    let told = bar.nodal_forces(3).expect_err("no such step").to_string();
    assert!(told.contains("step 4"), "{told}");
    let bolt = read("ccx_bolt.inp");
    let told = bolt.nodal_forces(0).expect_err("axisymmetric").to_string();
    assert!(told.contains("axisymmetric"), "{told}");
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn every_node_of_a_curved_mesh_is_in_it() {
    let (plate, deck) =
        (result("plate_hole_linear.vtu", &FeOptions::default()), read("plate_hole_freecad.inp"));
    let field = StressField::new(plate);
    // Nodes of the result are rounded to 6 digits, those of the deck are not.
    let outside: Vec<f64> = field
        .result()
        .nodes
        .iter()
        .chain(&deck.nodes)
        .filter_map(|p| field.locate(*p))
        .map(|l| l.distance_mm)
        .filter(|&d| d > 0.0)
        .collect();
    assert!(outside.iter().all(|&d| d < 1e-3), "{outside:?}");
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn sampling_is_fast_and_as_exact_as_the_nodes() {
    let result = result("bracket.vtu", &FeOptions::default());
    let start = Instant::now();
    let field = StressField::new(result);
    let built = start.elapsed();
    for (p, s) in field.result().nodes.iter().zip(&field.result().stress) {
        assert_eq!(field.locate(*p).map(|l| l.distance_mm), Some(0.0), "the node at {p} is in the mesh");
        let found = field.sample(*p);
        let off = found.iter().zip(s).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-4 * (1.0 + von_mises(s)), "at {p}: {found:?} {s:?}");
    }
    // Rows of points as layers sample them; some lie outside the part.
    let (lo, hi) = field
        .result()
        .nodes
        .iter()
        .fold((field.result().nodes[0], field.result().nodes[0]), |b, &p| (b.0.min(p), b.1.max(p)));
    let n = 300_000;
    let start = Instant::now();
    let mut inside = 0;
    let mut sum = 0.0;
    for i in 0..n {
        let t = DVec3::new(
            f64::from(i % 1000) / 1000.0,
            f64::from(i / 1000 % 100) / 100.0,
            f64::from(i / 100_000) / 3.0,
        );
        let p = lo + t * (hi - lo);
        let at = field.locate(p).expect("a mesh");
        inside += i32::from(at.distance_mm == 0.0);
        sum += field.stress_at(&at)[0];
    }
    let spent = start.elapsed().as_secs_f64();
    println!("built in {built:?}; {n} points, {inside} inside, {spent:.2} s ({sum:.1})");
    assert!(inside > n / 20 && sum.is_finite() && spent < 10.0, "{inside} {spent}");
}
