//! Files made by the programs that own the formats (`fe/make.py`) are read with the values put in, in
//! each encoding.

use std::path::Path;

use grainpath_core::DVec3;
use grainpath_core::units::LengthUnit;
use grainpath_io::fe::{
    DeckLoad, Element, Encoding, FeOptions, On, Order, StressField, StressUnit, VtuMesh, parse_fe,
    stress_point_data, von_mises, write_vtu,
};

fn bytes(file: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fe").join(file);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The stress field in all files of `make.py`, except those of CalculiX.
fn stress(p: DVec3) -> [f64; 6] {
    std::array::from_fn(|k| {
        let k = k as f64 + 1.0;
        10.0 * k + k * p.x + 2.0 * p.y - 3.0 * p.z
    })
}

fn near(a: &[f64; 6], b: &[f64; 6], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

// Source: the unit shapes of `make.py`: two hexahedra, two wedges, two tetrahedra, a pyramid.
const VOLUMES: [f64; 7] = [1.0, 1.0, 0.5, 0.5, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0];

#[test]
fn every_encoding_gives_the_same_field() {
    let files = [
        "ascii.vtu",
        "base64.vtu",
        "base64_zlib.vtu",
        "raw_big.vtu",
        "raw_zlib_blocks.vtu",
        "raw_lzma_blocks.vtu",
        "base64_lzma.vtu",
        "base64_lz4.vtu",
        "appended_base64.vtu",
        "appended_base64_zlib_big.vtu",
        "v42_ascii.vtk",
        "v42_binary.vtk",
        "v51_binary.vtk",
        "v22_ascii.msh",
        "v22_binary.msh",
        "v41_ascii.msh",
        "v41_binary.msh",
    ];
    for name in files {
        let file = parse_fe(&bytes(name), None).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(file.nodes.len(), 68, "{name}");
        assert!(file.warnings.is_empty() && file.left_out.is_empty(), "{name}: {:?}", file.warnings);
        assert_eq!(file.elements.len(), 7, "{name}");
        // Gmsh sorts elements by kind; they stand 2 mm apart along x, so their place identifies them.
        let which = |e: &Element| (file.nodes[e.nodes()[0] as usize].x / 2.0).floor() as usize;
        for e in &file.elements {
            // Mid-side nodes in a wrong order would bend the element and change its volume.
            let (v, expect) = (e.size(&file.nodes), VOLUMES[which(e)]);
            assert!((v - expect).abs() < 1e-6, "{name}: {} has volume {v}", e.kind.name());
        }
        if name.ends_with(".msh") {
            let names: Vec<_> = file.groups.iter().map(|g| g.name.as_str()).collect();
            assert_eq!(
                names,
                ["part 1", "part 2", "part 3", "part 4", "part 5", "part 6", "part 7"],
                "{name}"
            );
        }
        let result = file.result(&FeOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        // Files with single precision have seven digits.
        for (p, s) in result.nodes.iter().zip(&result.stress) {
            assert!(near(s, &stress(*p), 2e-5), "{name}: at {p} {s:?} should be {:?}", stress(*p));
        }
        let of_cells = FeOptions { stress_array: Some("S_cell".into()), ..FeOptions::default() };
        let cells = file.result(&of_cells).unwrap_or_else(|e| panic!("{name}: {e}"));
        for e in &cells.elements {
            let middle: DVec3 = e.nodes().iter().map(|&i| cells.nodes[i as usize]).sum::<DVec3>();
            let middle = middle / e.nodes().len() as f64;
            for &i in e.nodes() {
                let s = cells.stress[i as usize];
                assert!(near(&s, &stress(middle), 2e-5), "{name}: cell at {middle} {s:?}");
            }
        }
        let field = StressField::new(result);
        for i in 0..7u32 {
            let p = DVec3::new(2.0 * f64::from(i) + 0.21, 0.33, 0.17);
            let at = field.locate(p).expect("there are elements");
            let found = which(&field.result().elements[at.element as usize]);
            assert!(found == i as usize && at.distance_mm == 0.0, "{name}: {p} is in {at:?}");
            assert!(near(&field.sample(p), &stress(p), 3e-5), "{name}: {p}");
        }
        if let Some(u) = field.displacement(DVec3::new(0.5, 0.5, 0.5)) {
            assert!((u - DVec3::new(0.05, 0.1, 0.15)).length() < 1e-6, "{name}: {u}");
        }
    }
}

#[test]
fn pieces_are_joined() {
    let file = parse_fe(&bytes("pieces.vtu"), None).expect("two pieces");
    assert_eq!((file.nodes.len(), file.elements.len()), (8 + 20 + 6 + 20 + 6 + 15, 6));
    let result = file.result(&FeOptions::default()).expect("a stress");
    assert!(result.nodes.iter().zip(&result.stress).all(|(p, s)| near(s, &stress(*p), 1e-9)));
    assert_eq!(result.elements[3].nodes()[0], 34, "nodes of the second piece follow those of the first");
}

#[test]
fn calculix_results_ascii_and_binary() {
    // `make.py` prescribes u = G x, so the strain is the symmetric part of G everywhere.
    let g = [[1e-3, 2e-4, -3e-4], [4e-4, -2e-3, 5e-4], [1e-4, 7e-4, 3e-3]];
    let (e, nu): (f64, f64) = (2100.0, 0.3);
    let (mu, lambda) = (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    let trace = g[0][0] + g[1][1] + g[2][2];
    let direct = |i: usize| lambda * trace + 2.0 * mu * g[i][i];
    let shear = |i: usize, j: usize| mu * (g[i][j] + g[j][i]);
    let expect = [direct(0), direct(1), direct(2), shear(0, 1), shear(1, 2), shear(2, 0)];
    for name in ["patch_ascii.frd", "patch_binary.frd"] {
        let file = parse_fe(&bytes(name), None).unwrap_or_else(|e| panic!("{name}: {e}"));
        let volumes: Vec<f64> = file.elements.iter().map(|e| e.size(&file.nodes)).collect();
        for (v, expect) in volumes.iter().zip(VOLUMES) {
            assert!((v - expect).abs() < 1e-6, "{name}: {volumes:?}");
        }
        assert_eq!(volumes.len(), 6, "{name}");
        let result = file.result(&FeOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        for (p, s) in result.nodes.iter().zip(&result.stress) {
            assert!(near(s, &expect, 4e-4), "{name}: at {p} {s:?} should be {expect:?}");
        }
        let u = result.displacement.expect("DISP");
        for (p, u) in result.nodes.iter().zip(u) {
            let exact = DVec3::from(g.map(|row| row[0] * p.x + row[1] * p.y + row[2] * p.z));
            assert!((u - exact).length() < 1e-6, "{name}: {u} {exact}");
        }
    }
}

#[test]
fn what_is_written_is_read_back() {
    let file = parse_fe(&bytes("base64.vtu"), None).expect("a good file");
    let result = file.result(&FeOptions::default()).expect("a stress");
    for encoding in [Encoding::Ascii, Encoding::Raw, Encoding::Zlib] {
        let mut out = Vec::new();
        let data = stress_point_data(&result.stress, result.displacement.as_deref());
        let mesh = VtuMesh { nodes: &result.nodes, elements: &result.elements };
        write_vtu(mesh, &data, encoding, &mut out).expect("memory takes all");
        let read = parse_fe(&out, None).unwrap_or_else(|e| panic!("{encoding:?}: {e}"));
        assert_eq!(read.elements, file.elements, "{encoding:?}");
        let again = read.result(&FeOptions::default()).expect("a stress");
        assert_eq!((&again.nodes, &again.stress), (&result.nodes, &result.stress), "{encoding:?}");
        assert_eq!(again.displacement, result.displacement, "{encoding:?}");
        let array = |name: &str| {
            let a = read.arrays.iter().find(|a| a.name == name);
            a.unwrap_or_else(|| panic!("{encoding:?}: no {name}")).clone()
        };
        let mises = array("von_Mises");
        assert!(mises.on == On::Nodes && (mises.values[3] - von_mises(&result.stress[3])).abs() < 1e-12);
        // Each vector is a principal direction with the length of the principal stress. Signs are lost,
        // so sums of the magnitudes bound the trace and the components from above.
        let vectors = ["principal_max", "principal_mid", "principal_min"].map(array);
        let s = result.stress[5];
        let (mut xx, mut trace) = (0.0, 0.0);
        for v in &vectors {
            let v = DVec3::from_slice(&v.values[15..18]);
            trace += v.length();
            xx += v.x * v.x / v.length();
        }
        let hydrostatic = s[0] + s[1] + s[2];
        assert!(trace >= hydrostatic.abs() - 1e-9 && xx >= s[0].abs() - 1e-9, "{trace} {xx} {s:?}");
    }
    let wrong = [grainpath_io::fe::PointData::scalars("a", [1.0])];
    let mesh = VtuMesh { nodes: &result.nodes, elements: &result.elements };
    assert!(write_vtu(mesh, &wrong, Encoding::Raw, &mut Vec::new()).is_err());
}

#[test]
fn units_are_stated_and_doubted() {
    let bar = "x,y,z,s_xx,s_yy,s_zz,s_xy,s_yz,s_zx\n0,0,0,1e8,0,0,0,0,0\n0.1,0,0,1e8,0,0,0,0,0\n0,0.02,0,1e8,0,0,0,0,0\n";
    let file = parse_fe(bar.as_bytes(), Some("a.csv")).expect("a table");
    let doubted = file.result(&FeOptions::default()).expect("taken as it is");
    assert!(
        doubted.warnings.iter().any(|w| w.remedy.contains("stress_unit = \"Pa\"")),
        "{:?}",
        doubted.warnings
    );
    assert!(doubted.warnings.iter().any(|w| w.remedy.contains("length_unit")), "{:?}", doubted.warnings);
    let stated = FeOptions {
        length_unit: Some(LengthUnit::Metre),
        stress_unit: Some(StressUnit::Pascal),
        ..FeOptions::default()
    };
    let result = file.result(&stated).expect("metres and pascals");
    assert_eq!(
        (result.nodes[1], result.stress[0]),
        (DVec3::new(100.0, 0.0, 0.0), [100.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    );
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
    let psi = FeOptions {
        stress_unit: StressUnit::from_name("psi"),
        length_unit: LengthUnit::from_name("inch"),
        ..stated
    };
    let result = file.result(&psi).expect("inches");
    assert!((result.nodes[1].x - 2.54).abs() < 1e-12 && (result.stress[0][0] - 689_475.7).abs() < 0.1);
}

#[test]
fn order_of_components_is_taken_and_doubted() {
    // Torsion of a bar along x: only xy and zx, free sides. In Abaqus's order zx comes before yz.
    let mut nodes = Vec::new();
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n");
    for i in 0..11 {
        for j in 0..5 {
            for k in 0..5 {
                nodes.push(DVec3::new(f64::from(i), 0.5 * f64::from(j) - 1.0, 0.5 * f64::from(k) - 1.0));
            }
        }
    }
    text += &format!("{}\n", nodes.len());
    for (i, p) in nodes.iter().enumerate() {
        text += &format!("{} {} {} {}\n", i + 1, p.x, p.y, p.z);
    }
    let at = |i: usize, j: usize, k: usize| (i * 5 + j) * 5 + k + 1;
    let mut elements = String::new();
    let mut n = 0;
    for i in 0..10 {
        for j in 0..4 {
            for k in 0..4 {
                n += 1;
                elements += &format!("{n} 5 0");
                for (a, b, c) in
                    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
                {
                    elements += &format!(" {}", at(i + a, j + b, k + c));
                }
                elements += "\n";
            }
        }
    }
    text += &format!(
        "$EndNodes\n$Elements\n{n}\n{elements}$EndElements\n$NodeData\n1\n\"S\"\n1\n0\n3\n0\n6\n{}\n",
        nodes.len()
    );
    for (i, p) in nodes.iter().enumerate() {
        // Prandtl's stress function (1 - y^2)(1 - z^2) leaves the sides free of stress.
        let (xy, zx) = (-2.0 * p.z * (1.0 - p.y * p.y), 2.0 * p.y * (1.0 - p.z * p.z));
        text += &format!("{} 0 0 0 {xy} {zx} 0\n", i + 1);
    }
    text += "$EndNodeData\n";
    let file = parse_fe(text.as_bytes(), None).expect("a torsion bar");
    let plain = file.result(&FeOptions::default()).expect("a stress");
    let told = plain.warnings.iter().any(|w| w.text.contains("may be abaqus"));
    assert!(told, "{:?}", plain.warnings);
    let abaqus = FeOptions { order: Order::from_name("Abaqus"), ..FeOptions::default() };
    let right = file.result(&abaqus).expect("a stress");
    assert!(right.warnings.is_empty(), "{:?}", right.warnings);
    let s = StressField::new(right).sample(DVec3::new(5.0, 0.5, 0.0));
    assert!((s[5] - 1.0).abs() < 1e-9 && s[4] == 0.0, "{s:?}");
}

#[test]
fn a_stored_von_mises_shows_a_wrong_array() {
    let file = "x;y;sxx;syy;sxy;von Mises\n0,0;0;10;0;0;10\n1,5;0;20;0;0;20\n0;1;30;0;0;30\n";
    let good = parse_fe(file.as_bytes(), Some("a.csv")).expect("a table with decimal commas");
    let result = good.result(&FeOptions::default()).expect("a plane stress");
    assert!(result.plane && result.warnings.is_empty(), "{:?}", result.warnings);
    assert_eq!(result.nodes[1].x, 1.5);
    // The columns of a table are told apart by their names, so an order that the job states has no effect.
    let ordered = FeOptions { order: Order::from_name("Voigt"), ..FeOptions::default() };
    let told = good.result(&ordered).expect("a plane stress").warnings;
    assert!(matches!(&told[..], [w] if w.text.contains("order voigt")), "{told:?}");
    let wrong = file.replace(";20;0;0;20", ";90;0;0;20");
    let result = parse_fe(wrong.as_bytes(), Some("a.csv")).expect("a table").result(&FeOptions::default());
    let warnings = result.expect("a plane stress").warnings;
    assert!(warnings.iter().any(|w| w.text.contains("von Mises")), "{warnings:?}");
}

#[test]
fn values_at_corners_of_elements_are_averaged_by_size() {
    // Two tetrahedra share a face; the second is twice as large. Each has its own constant stress.
    let mut text = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -2\n$EndNodes\n\
         $Elements\n2\n7 4 0 1 2 3 4\n9 4 0 1 3 2 5\n$EndElements\n\
         $ElementNodeData\n1\n\"stress\"\n1\n0.5\n3\n0\n6\n2\n",
    );
    for (element, value) in [(7, 3.0), (9, 6.0)] {
        text += &format!("{element} 4{}\n", format!(" {value} 0 0 0 0 0").repeat(4));
    }
    text += "$EndElementNodeData\n";
    let file = parse_fe(text.as_bytes(), None).expect("a good file");
    let result = file.result(&FeOptions::default()).expect("a stress");
    let xx: Vec<f64> = result.stress.iter().map(|s| s[0]).collect();
    for (found, expect) in xx.iter().zip([5.0, 5.0, 5.0, 3.0, 6.0]) {
        assert!((found - expect).abs() < 1e-12, "{xx:?}");
    }
}

#[test]
fn steps_may_be_chosen() {
    let text = |value: &str, step: usize| {
        format!(
            "    1PSTEP                         {step}           1           {step}          \n  100CL  101 1.000000000           3                     0    1           1\n -4  STRESS      6    1\n{}{} -3\n",
            ["SXX", "SYY", "SZZ", "SXY", "SYZ", "SZX"]
                .map(|c| format!(" -5  {c}         1    4    1    1\n"))
                .concat(),
            (1..4).map(|n| format!(" -1{n:10}{value}{}\n", " 0.00000E+00".repeat(5))).collect::<String>()
        )
    };
    let mesh = "    1C\n    2C                             3                                     1\n\
        \x20-1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 9.00000E+00 0.00000E+00 0.00000E+00\n\
        \x20-1         3 0.00000E+00 9.00000E+00 0.00000E+00\n -3\n    3C                             1                                     1\n\
        \x20-1         1    7    0    1\n -2         1         2         3\n -3\n";
    let bytes = format!("{mesh}{}{} 9999\n", text(" 1.00000E+00", 1), text(" 2.00000E+01", 2));
    let file = parse_fe(bytes.as_bytes(), Some("a.frd")).expect("two steps");
    let xx = |step: Option<usize>| {
        let options = FeOptions { step, ..FeOptions::default() };
        file.result(&options).map(|r| r.stress[1][0]).map_err(|e| e.to_string())
    };
    assert_eq!((xx(None), xx(Some(1)), xx(Some(2))), (Ok(20.0), Ok(1.0), Ok(20.0)));
    assert!(xx(Some(3)).is_err_and(|e| e.contains("there are steps 1 to 2")));
}

#[test]
fn points_without_a_mesh_are_interpolated() {
    let mut table =
        String::from("X [mm],Y [mm],Stress xx component,Stress yy component,Stress xy component\n");
    for i in 0..400 {
        let (x, y) = (f64::from(i % 20), f64::from(i / 20));
        table += &format!("{x},{y},{},{},{}\n", 10.0 + x, 20.0 - y, 5.0);
    }
    let file = parse_fe(table.as_bytes(), Some("a.csv")).expect("a table");
    let field = StressField::new(file.result(&FeOptions::default()).expect("a stress"));
    assert!(field.locate(DVec3::ZERO).is_none());
    let at = field.sample(DVec3::new(7.0, 11.0, 99.0));
    assert!(near(&at, &[17.0, 9.0, 0.0, 5.0, 0.0, 0.0], 1e-6), "on a point: {at:?}");
    let between = field.sample(DVec3::new(7.5, 11.5, 0.0));
    assert!(near(&between, &[17.5, 8.5, 0.0, 5.0, 0.0, 0.0], 0.2), "between points: {between:?}");
    let far = field.sample(DVec3::new(1e6, 0.0, 0.0));
    assert!((far[0] - 29.0).abs() < 1.5 && far.iter().all(|v| v.is_finite()), "far away: {far:?}");
}

#[test]
fn corners_alone_are_enough() {
    // Mid-side nodes without a value take the mean of their edge's ends.
    let (nodes, rest) = ("1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.5 0 0\n5 0.5 0.5 0\n6 0 0.5 0\n", "1 2 3 4 5 6");
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n{nodes}$EndNodes\n$Elements\n1\n1 9 0 {rest}\n$EndElements\n\
         $NodeData\n1\n\"S\"\n0\n3\n0\n6\n3\n1 1 0 0 0 0 0\n2 3 0 0 0 0 0\n3 5 0 0 0 0 0\n$EndNodeData\n"
    );
    let result =
        parse_fe(text.as_bytes(), None).expect("a triangle").result(&FeOptions::default()).expect("a stress");
    let xx: Vec<f64> = result.stress.iter().map(|s| s[0]).collect();
    assert_eq!(xx, [1.0, 3.0, 5.0, 2.0, 4.0, 3.0]);
}

/// A deck of one tetrahedron under what `rest` says.
fn deck(rest: &str) -> Result<grainpath_io::fe::DeckConditions, grainpath_io::fe::FeError> {
    let mesh = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=ALL\n1,1,2,3,4\n\
                *SURFACE,NAME=TOP\n1,S2\n";
    let text = format!("{mesh}{rest}");
    parse_fe(text.as_bytes(), Some("a.inp"))?.deck_conditions(&FeOptions::default())
}

#[test]
fn loads_of_a_deck_are_taken_at_the_size_of_their_amplitude() {
    let held = "*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n";
    // The force of each step along y or z. CalculiX gives the same factors at the end of the steps.
    let forces = |rest: &str| -> Vec<f64> {
        let found = deck(rest).unwrap_or_else(|e| panic!("{rest}: {e}"));
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        let of = |load: &DeckLoad| match load {
            DeckLoad::Traction { force_n, .. } => 2.0 * force_n.y,
            DeckLoad::Forces(all) => all.iter().map(|f| f.1.z).sum(),
            DeckLoad::Acceleration(a) => a.z,
            DeckLoad::Centrifugal { rad_s, .. } => rad_s * rad_s,
        };
        found.steps.iter().map(|s| s.loads.iter().map(of).sum()).collect()
    };
    let table = |rest: &str| format!("*AMPLITUDE, NAME=Ramp{rest}\n");
    let step = |time: &str, load: &str| format!("*STEP\n*STATIC\n{time}{held}{load}*END STEP\n");
    let half = table("\n0.,0.,1.,0.5,2.,1.,,");
    for (load, full) in [
        ("*CLOAD, AMPLITUDE=RAMP\n4,3,8\n", 8.0),
        ("*DLOAD, AMPLITUDE=RAMP\n1,P2,8\n", 8.0),
        ("*DSLOAD, AMPLITUDE=RAMP\nTOP,P,8\n", 8.0),
        ("*DLOAD, AMPLITUDE=RAMP\nALL,GRAV,8,0,0,1\n", 8.0),
        ("*DLOAD, AMPLITUDE=RAMP\nALL,CENTRIF,8,0,0,0,0,0,1\n", 8.0),
    ] {
        let found = forces(&format!("{half}{}", step("", load)));
        assert!((found[0] - 0.5 * full).abs() < 1e-9, "{load}: {found:?}");
    }
    let load = "*CLOAD, AMPLITUDE=RAMP\n4,3,8\n";
    for (table, time, wanted) in [
        (&half, "0.1,0.5\n", 2.0),
        (&half, "0.1,9.\n", 8.0),
        (&table("\n2.,0.7,5.,0.9"), "", 5.6),
        // Of two factors at one time the later one counts.
        (&table(", TIME=STEP TIME\n0.,0.,1.,0.3\n1.,0.9,2.,0.9"), "", 7.2),
    ] {
        let found = forces(&format!("{table}{}", step(time, load)));
        assert!((found[0] - wanted).abs() < 1e-9, "{table}{time}: {found:?} for {wanted}");
    }
    let delayed = step("", "*CLOAD, AMPLITUDE=RAMP, TIME DELAY=0.5\n4,3,8\n");
    assert!((forces(&format!("{half}{delayed}"))[0] - 2.0).abs() < 1e-9);
    // Kept in a second step of another length: step time stays where it was, total time goes on.
    let two = |load: &str| format!("{}*STEP\n*STATIC\n0.1,2.\n*END STEP\n", step("", load));
    let total = table(", TIME=TOTAL TIME\n0.,0.,1.,0.5,2.,1.,3.,4.");
    for (table, wanted) in [(&half, [4.0, 4.0]), (&total, [4.0, 32.0])] {
        let found = forces(&format!("{table}{}", two(load)));
        assert!(found.iter().zip(wanted).all(|(f, w)| (f - w).abs() < 1e-9), "{table}: {found:?}");
    }
    // Supports move by what their amplitude says.
    let moved = format!("{half}{}", step("", "*BOUNDARY, AMPLITUDE=RAMP\n4,3,3,-0.2\n"));
    let found = deck(&moved).expect("a deck");
    assert!(found.supports.iter().any(|s| (s.displacement_mm.z + 0.1).abs() < 1e-12), "{found:?}");
}

#[test]
fn amplitudes_and_initial_stresses_that_are_not_read_are_refused_by_name() {
    let held = "*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n";
    let load = "*CLOAD, AMPLITUDE=A\n4,3,8\n";
    let step = |head: &str| format!("*STEP{head}\n*STATIC\n{held}{load}*END STEP\n");
    for (rest, wanted) in [
        (step(""), "*CLOAD, AMPLITUDE=A: is given and is not read"),
        (format!("*AMPLITUDE, NAME=A, USER\n{}", step("")), "*CLOAD, AMPLITUDE=A"),
        (
            format!("*AMPLITUDE, NAME=A, DEFINITION=PERIODIC\n1,6.28,0,0\n0,1\n{}", step("")),
            "*CLOAD, AMPLITUDE=A",
        ),
        (format!("*AMPLITUDE, NAME=A, VALUE=ABSOLUTE\n0,0,1,5\n{}", step("")), "*CLOAD, AMPLITUDE=A"),
        (format!("*AMPLITUDE, NAME=A\n1,0,0,5\n{}", step("")), "*CLOAD, AMPLITUDE=A"),
        (format!("*AMPLITUDE, NAME=A\n0,0,1\n{}", step("")), "*CLOAD, AMPLITUDE=A"),
        (format!("*AMPLITUDE, NAME=A\n0,0,1,1\n{}", step(", PERTURBATION")), "*CLOAD, AMPLITUDE=A"),
        (
            format!("*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0,0,1,1\n{}", step(""))
                .replace("TIC\n", "TIC, TIME RESET\n"),
            "*CLOAD, AMPLITUDE=A",
        ),
        (
            format!(
                "*INITIAL CONDITIONS, TYPE=STRESS\nALL,5,5,5,0,0,0\n{}",
                step("").replace(", AMPLITUDE=A", "")
            ),
            "*INITIALCONDITIONS, TYPE=STRESS: changes the stress under the loads",
        ),
    ] {
        let told = deck(&rest).err().unwrap_or_else(|| panic!("{rest}")).to_string();
        assert!(told.contains(wanted) && !told.contains('\n'), "{told:?} for {rest}");
    }
    // An amplitude that no load uses, and initial values that no static step uses, change nothing.
    let rest = format!(
        "*AMPLITUDE, NAME=A, USER\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\n1,20\n{}",
        step("").replace(", AMPLITUDE=A", "")
    );
    assert_eq!(deck(&rest).expect("a deck").steps[0].loads.len(), 1);
}
