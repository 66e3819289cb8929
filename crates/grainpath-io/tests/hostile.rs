//! Damaged and malicious meshes: readers must not panic or run out of memory, and must name the fault.

use grainpath_core::{DVec3, TriMesh};
use grainpath_io::{MeshError, parse_mesh, write_stl};
use proptest::prelude::*;

fn cube() -> TriMesh {
    let vertices =
        (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices, triangles }
}

fn stl(mesh: &TriMesh) -> Vec<u8> {
    let mut out = Vec::new();
    write_stl(mesh, &mut out).expect("memory takes all");
    out
}

fn error(bytes: &[u8], name: &str) -> String {
    parse_mesh(bytes, Some(name)).expect_err(name).to_string()
}

#[test]
fn stl_that_is_written_is_read() {
    let bytes = stl(&cube());
    let read = parse_mesh(&bytes, None).expect("our own file");
    assert_eq!(read.bodies[0].mesh.vertices.len(), 8);
    assert!((read.bodies[0].mesh.signed_volume() - 1.0).abs() < 1e-12);
    let mut solid = bytes.clone();
    solid[..5].copy_from_slice(b"solid");
    assert!(parse_mesh(&solid, None).is_ok(), "a binary header may begin with solid");
}

#[test]
fn binary_stl_from_a_file_is_that_from_memory() {
    let sound = stl(&cube());
    let mut padded = sound.clone();
    padded.extend([0; 10]);
    let mut broken = sound.clone();
    broken[84 + 12..84 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    for bytes in [&sound, &padded, &broken] {
        let read = grainpath_io::read_binary_stl(&bytes[..], bytes.len() as u64).expect("memory is read");
        assert_eq!(read, Some(parse_mesh(bytes, Some("a.stl"))), "{} bytes", bytes.len());
    }
    // Other formats, and a file that is too short for its header, are read as a whole.
    for other in [&b"solid a\nendsolid a\n"[..], b"v 0 0 0\n", &sound[..200], b"ply\n", b""] {
        let read = grainpath_io::read_binary_stl(other, other.len() as u64).expect("memory is read");
        assert_eq!(read, None, "{} bytes", other.len());
    }
    // The file lost its end after its size was asked.
    assert!(grainpath_io::read_binary_stl(&sound[..300], sound.len() as u64).is_err());
}

#[test]
fn damage_is_named() {
    let bytes = stl(&cube());
    assert_eq!(parse_mesh(&[], None), Err(MeshError::Empty));
    let cut = error(&bytes[..bytes.len() - 70], "a.stl");
    assert!(cut.contains("12 facets") && cut.contains("holds 10"), "{cut}");
    for bad in [f32::NAN, f32::INFINITY, 1e38] {
        let mut broken = bytes.clone();
        broken[84 + 12..84 + 16].copy_from_slice(&bad.to_le_bytes());
        assert!(error(&broken, "a.stl").starts_with("facet 0: coordinate"), "{bad}");
    }
    assert!(error(b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "a.obj").starts_with("line 3: vertex 3 does not exist"));
    assert!(error(b"v 0 0 x\n", "a.obj").starts_with("line 1: found \"x\""));
    assert!(error(b"OFF\n4000000000 1 0\n", "a.off").contains("more than"));
    assert!(error(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "a.off").contains("vertex 7"));
    let ply = b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n";
    assert!(error(ply, "a.ply").contains("more than"));
    let ply = b"ply\nformat ascii 1.0\nelement face 100000000\nend_header\n";
    assert!(error(ply, "a.ply").contains("no properties"));
    assert!(error(b"PK\x03\x04 not really", "a.3mf").contains("3MF archive"));
    assert!(error(b"hello", "a.txt").contains("not a mesh"));
    assert!(error(b"solid a\nendsolid a\n", "a.stl").contains("no triangles"));
}

#[test]
fn polygons_are_cut_and_numbers_may_be_negative() {
    let obj = b"v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\nf -5/1/1 -4//2 \\\n -3 -2 -1\n";
    let read = parse_mesh(obj, Some("a.obj")).expect("a concave face");
    let mesh = &read.bodies[0].mesh;
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
            0.5 * (b - a).cross(c - a).z
        })
        .sum();
    assert!(mesh.triangles.len() == 3 && (area - 2.5).abs() < 1e-12, "{area}");
    let ply = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty uchar red\nproperty double x\nproperty short y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let mut bytes = ply.to_vec();
    for (x, y) in [(0.0f64, 0i16), (1.5, -2), (3.0, 7)] {
        bytes.push(9);
        bytes.extend(x.to_be_bytes());
        bytes.extend(y.to_be_bytes());
        bytes.extend(0.5f32.to_be_bytes());
    }
    bytes.push(3);
    for i in 0i32..3 {
        bytes.extend(i.to_be_bytes());
    }
    let read = parse_mesh(&bytes, None).expect("a binary PLY");
    assert_eq!(read.bodies[0].mesh.vertices[1], DVec3::new(1.5, -2.0, 0.5));
}

fn zipped(model: &str) -> Vec<u8> {
    use std::io::Write;
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    let rels = r#"<Relationships><Relationship Target="/3D/m.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
    for (name, text) in [("_rels/.rels", rels), ("3D/m.model", model)] {
        zip.start_file(name, options).expect("memory takes all");
        zip.write_all(text.as_bytes()).expect("memory takes all");
    }
    zip.finish().expect("memory takes all").into_inner()
}

const TETRAHEDRON: &str = r#"<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh></object>"#;

#[test]
fn components_units_and_transforms_of_3mf() {
    let model = format!(
        r#"<model unit="inch"><resources>{TETRAHEDRON}<object id="2"><components><component objectid="1"/><component objectid="1" transform="-1 0 0 0 1 0 0 0 1 5 0 0"/></components></object></resources><build><item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 10"/><item objectid="1"/></build></model>"#
    );
    let read = parse_mesh(&zipped(&model), None).expect("a good 3MF");
    assert_eq!(read.bodies.len(), 2);
    assert_eq!(read.unit, Some(grainpath_core::units::LengthUnit::Inch));
    let volume = read.bodies[0].mesh.signed_volume();
    assert!((volume - 2.0 * 8.0 / 6.0).abs() < 1e-12, "mirrored copies keep their outside: {volume}");
}

#[test]
fn painted_supports_of_3mf_go_where_their_facets_go() {
    let painted = TETRAHEDRON.replacen("<triangle ", r#"<triangle slic3rpe:custom_supports="4" "#, 1);
    let both = painted.replacen(r#"v1="1" "#, r#"v1="1" paint_supports="00083" "#, 1);
    let wrong = both.replacen(r#"v1="0" v2="1" v3="3""#, r#"v1="0" v2="1" v3="3" paint_supports="3""#, 1);
    let model = format!(
        r#"<model><resources>{wrong}</resources><build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 10"/></build></model>"#
    );
    let read = parse_mesh(&zipped(&model), None).expect("a good 3MF");
    let painted = &read.bodies[0].painted_supports;
    assert_eq!(
        painted.enforcers.vertices,
        [[0.0, 0.0, 10.0], [0.0, 1.0, 10.0], [1.0, 0.0, 10.0]].map(DVec3::from)
    );
    assert_eq!((painted.enforcers.triangles.len(), painted.blockers.triangles.len()), (1, 1));
    assert!(
        painted.blockers.vertices.contains(&DVec3::new(0.5, 0.5, 10.0)),
        "{:?}",
        painted.blockers.vertices
    );
    assert!(read.warnings.iter().any(|w| w.text.contains("painted supports")), "{:?}", read.warnings);
}

#[test]
fn formats_that_are_not_read_are_refused_by_name() {
    let iges = format!("{:72}S      1\n{:72}S      2\n", "part", "");
    for (bytes, expect) in [
        ("ISO-10303-21;\nHEADER;\n", "STEP file holds exact surfaces"),
        (iges.as_str(), "IGES file holds exact surfaces"),
        ("#VRML V2.0 utf8\n", "VRML is not read"),
        ("<?xml version=\"1.0\"?>\n<amf unit=\"inch\">", "AMF is not read"),
    ] {
        assert!(error(bytes.as_bytes(), "a").contains(expect), "{expect}");
    }
}

#[test]
fn bombs_are_refused() {
    let circle = r#"<model><resources><object id="1"><components><component objectid="1"/></components></object></resources><build><item objectid="1"/></build></model>"#;
    assert!(error(&zipped(circle), "a.3mf").contains("in a circle"));
    let mut laughs = format!("<model><resources>{TETRAHEDRON}");
    for i in 2..30 {
        let use_of = format!(r#"<component objectid="{}"/>"#, i - 1).repeat(10);
        laughs += &format!(r#"<object id="{i}"><components>{use_of}</components></object>"#);
    }
    laughs += r#"</resources><build><item objectid="29"/></build></model>"#;
    assert!(error(&zipped(&laughs), "a.3mf").contains("more than"));
    let spaces = format!("<model><resources>{}</resources><build/></model>", " ".repeat(64 << 20));
    assert!(error(&zipped(&spaces), "a.3mf").contains("zip bomb"));
    assert!(error(&zipped("<!DOCTYPE x><model/>"), "a.3mf").contains("document type"));
    assert!(error(&zipped("<model><resources>"), "a.3mf").contains("3D/m.model"));
}

/// Reads bytes. What can be read has a body, triangles, vertices that exist and finite coordinates, and no more
/// triangles than the file has bytes for.
fn survive(bytes: &[u8], name: Option<&str>) {
    let Ok(file) = parse_mesh(bytes, name) else { return };
    assert!(!file.bodies.is_empty());
    let mut meshes = Vec::new();
    for body in &file.bodies {
        assert!(!body.mesh.triangles.is_empty());
        meshes.extend([&body.mesh, &body.painted_supports.enforcers, &body.painted_supports.blockers]);
    }
    meshes.extend(file.modifiers.iter().map(|m| &m.mesh));
    for mesh in meshes {
        assert!(mesh.vertices.iter().all(|p| p.is_finite()), "{:?}", mesh.vertices);
        let n = mesh.vertices.len() as u32;
        assert!(mesh.triangles.iter().flatten().all(|&i| i < n), "{:?} of {n}", mesh.triangles);
        assert!(mesh.triangles.len() <= bytes.len());
    }
}

proptest! {
    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..2000), kind in 0usize..6) {
        let names = ["a.stl", "a.obj", "a.ply", "a.off", "a.3mf", "a"];
        let starts: [&[u8]; 6] = [b"solid x\nfacet normal 0 0 1\nouter loop\nvertex ", b"v 0 0 0\nf ", b"ply\nformat ascii 1.0\n",
            b"OFF\n", b"PK\x03\x04", b""];
        let mut all = starts[kind].to_vec();
        all.extend(&bytes);
        survive(&all, Some(names[kind]));
        survive(&bytes, Some(names[kind]));
    }

    #[test]
    fn changed_files_are_survived(at in 0usize..700, value in any::<u8>(), cut in 0usize..700) {
        let mut bytes = stl(&cube());
        let n = bytes.len();
        bytes[at % n] = value;
        survive(&bytes, Some("a.stl"));
        let mut archive = zipped(&format!("<model><resources>{TETRAHEDRON}</resources><build><item objectid=\"1\"/></build></model>"));
        let n = archive.len();
        archive[at % n] = value;
        survive(&archive, None);
        archive.truncate(cut % n);
        survive(&archive, None);
    }
}
