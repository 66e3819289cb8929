//! Damaged and malicious finite-element files: readers must not panic or run out of memory, and must name
//! the fault.

use std::path::Path;

use grainpath_io::fe::{FeError, FeOptions, StressField, parse_fe};
use proptest::prelude::*;

fn error(bytes: &[u8], name: &str) -> String {
    let read = parse_fe(bytes, Some(name)).and_then(|f| f.result(&FeOptions::default()));
    read.expect_err(name).to_string()
}

fn fixtures() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fe");
    let mut all: Vec<_> = std::fs::read_dir(folder)
        .expect("the files of make.py")
        .map(|f| f.expect("a file").path())
        .filter(|p| p.extension().is_some_and(|e| e != "py"))
        .map(|p| {
            (p.file_name().expect("a name").to_string_lossy().into_owned(), std::fs::read(p).expect("a file"))
        })
        .collect();
    all.push(("deck.inp".into(), DECK.as_bytes().to_vec()));
    all.push(("table.csv".into(), b"x,y,sxx,syy,sxy\n0,0,1,2,3\n1,0,1,2,3\n0,1,1,2,3\n".to_vec()));
    all.push(("box.mesh".into(), b"MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\nTetrahedra\n1\n1 2 3 4 1\nEnd\n".to_vec()));
    all.sort();
    all
}

const DECK: &str = "*HEADING\na test\n*NODE, NSET=N\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n*ELEMENT, TYPE=C3D4, ELSET=E\n1,1,2,3,4\n2,2,3,4,5\n*NSET, NSET=G, GENERATE\n1,5,2\n*MATERIAL, NAME=M\n*ELASTIC\n2100.,.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*SURFACE, NAME=F\nE, S1\n*STEP\n*STATIC\n*BOUNDARY\nG,1,3\n*CLOAD\n5,1,10.\n*DLOAD\n2,P2,1.\n*DSLOAD\nF,P,2.\n*END STEP\n";

#[test]
fn damage_is_named() {
    assert_eq!(parse_fe(&[], None), Err(FeError::Empty));
    assert_eq!(parse_fe(b"hello", Some("a.txt")), Err(FeError::Unknown));
    assert_eq!(parse_fe(b"ISO-10303-21;\nHEADER;", None), Err(FeError::Geometry));
    let head = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"";
    for (text, say) in [
        ("<VTKFile type=\"PolyData\"><PolyData/></VTKFile>".to_owned(), "UnstructuredGrid"),
        (format!("{head} compressor=\"vtkOtherDataCompressor\"></VTKFile>"), "vtkOtherDataCompressor"),
        (format!("{head}></VTKFile>"), "no <Piece>"),
        (format!("{head}><Piece NumberOfPoints=\"-1\" NumberOfCells=\"0\"></Piece>"), "should be a count"),
        (format!("{head}><Piece NumberOfPoints=\"2\" NumberOfCells=\"0\"></Piece>"), "has no Points"),
        (
            format!(
                "{head}><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2</DataArray></Points></Piece>"
            ),
            "2 numbers where 3",
        ),
        (
            format!(
                "{head}><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2 x</DataArray></Points></Piece>"
            ),
            "found \"x\"",
        ),
        (
            format!(
                "{head}><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"99\"/></Points></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_abc</AppendedData>"
            ),
            "behind the end",
        ),
    ] {
        let told = error(text.as_bytes(), "a.vtu");
        assert!(told.contains(say), "{told} should say {say}");
    }
    for (text, say) in [
        ("$MeshFormat\n4 0 8\n$EndMeshFormat\n", "versions 2.2 and 4.1"),
        ("$NOD\n1\n", "versions 2.2 and 4.1"),
        ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n1 1 0 0\n", "node 1: is there twice"),
        (
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n7 2 0 1 1 9\n",
            "element 7: node 9 does not exist",
        ),
        (
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n7 99 0 1 1 9\n",
            "element type 99",
        ),
        ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 inf\n", "not a finite number"),
    ] {
        let told = error(text.as_bytes(), "a.msh");
        assert!(told.contains(say), "{told} should say {say}");
    }
    for (from, to, say) in [
        ("*ELEMENT, TYPE=C3D4", "*INCLUDE, INPUT=x\n*ELEMENT, TYPE=C3D4", "line 9: *INCLUDE"),
        ("1,1,2,3,4", "1,1,2,3,77", "element 1: node 77 does not exist"),
        ("2,2,3,4,5", "1,2,3,4,5", "line 11: element 1 is there twice"),
        ("G,1,3", "H,1,3", "no node set \"H\""),
        ("2,P2,1.", "2,P7,1.", "where a face of a tet4 should be"),
        ("3,0,1,0", "3,zero,1,0", "line 6: found \"zero\""),
        ("*STEP\n", "", "before any *STEP"),
    ] {
        let told = error(DECK.replace(from, to).as_bytes(), "a.inp");
        assert!(told.contains(say), "{told} should say {say}");
    }
    assert!(error(DECK.as_bytes(), "a.inp").contains("no stress in the file: it has no arrays"));
    for (text, say) in [
        ("x,y,sxx\n1,2\n", "line 2: 2 columns where the header has 3"),
        ("x,y,sxx,syy,sxy\n1,a,3,4,5\n", "line 2: found \"a\""),
        ("a,b,c\n1,2,3\n", "columns x and y"),
        ("x,y,sxx\n1,2,3\n", "no stress in the file; its arrays (components) are sxx (1)"),
        ("x,y,sxx,syy,sxy\n", "no nodes"),
        ("x,y,sxx,syy,sxy\n1,2,nan,4,5\n3,4,5,nan,6\n", "no point has finite values"),
    ] {
        let told = error(text.as_bytes(), "a.csv");
        assert!(told.contains(say), "{told} should say {say}");
    }
    let frd = b"    1C\n    2C                             1                                     1\n -1         1 0.00000E+00 0.00000E+00 x.00000E+00\n -3\n";
    assert!(error(frd, "a.frd").contains("line 3: found \"x.00000E+00\""));
    assert!(error(&frd[..100], "a.frd").starts_with("line 3:"));
}

#[test]
fn a_missing_stress_names_what_is_there() {
    let (_, bytes) = fixtures().into_iter().find(|(n, _)| n == "ascii.vtu").expect("ascii.vtu");
    let file = parse_fe(&bytes, None).expect("a good file");
    let options = FeOptions { stress_array: Some("sigma".into()), ..FeOptions::default() };
    let told = file.result(&options).expect_err("no such array").to_string();
    assert!(told.contains("no array \"sigma\"") && told.contains("S (6), U (3)"), "{told}");
    let options = FeOptions { step: Some(4), ..FeOptions::default() };
    let told = file.result(&options).expect_err("no such step").to_string();
    assert!(told.contains("step 4: there are steps 1 to 1"), "{told}");
}

#[test]
fn results_of_ansys_are_refused_with_a_way_to_export_them() {
    let mut bytes: Vec<u8> =
        [100u32, 0x8000_0000, 12, u32::MAX].iter().flat_map(|w| w.to_le_bytes()).collect();
    bytes.resize(408, 0);
    assert!(error(&bytes, "a.rst").contains("an ANSYS result file") && error(&bytes, "a").contains("export"));
}

#[test]
fn damaged_blocks_of_every_compression_are_refused() {
    for name in ["raw_zlib_blocks.vtu", "raw_lzma_blocks.vtu", "base64_lz4.vtu"] {
        let (_, good) = fixtures().into_iter().find(|(n, _)| n == name).expect(name);
        assert!(parse_fe(&good, None).is_ok(), "{name}");
        let start = good.windows(6).position(|w| w == b"<Piece").expect("a piece");
        let mut n_refused = 0;
        // Seven bytes apart: each block of the file is hit, and the test stays short.
        for i in (start..good.len()).step_by(7) {
            let mut bytes = good.clone();
            bytes[i] ^= 0x15;
            n_refused += usize::from(parse_fe(&bytes, None).is_err());
        }
        assert!(n_refused > 20, "{name}: {n_refused}");
    }
}

#[test]
fn an_xz_header_cannot_ask_for_more_memory_than_the_limit() {
    // An xz stream whose block header demands a dictionary of 4 GiB.
    let mut block = vec![0x02, 0x00, 0x21, 0x01, 40, 0x00, 0x00, 0x00];
    block.extend(crc32(&block).to_le_bytes());
    let mut stream = vec![0xfd, b'7', b'z', b'X', b'Z', 0x00];
    stream.extend([0x00, 0x01]);
    stream.extend(crc32(&[0x00, 0x01]).to_le_bytes());
    stream.extend(&block);
    stream.extend([0u8; 64]);
    let mut data: Vec<u8> = [1u32, 12, 0, stream.len() as u32].iter().flat_map(|w| w.to_le_bytes()).collect();
    data.extend(&stream);
    let text = "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkLZMADataCompressor\"><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece><AppendedData encoding=\"raw\">_";
    let told = error(&[text.as_bytes(), &data].concat(), "a.vtu");
    assert!(told.contains("memory"), "{told}");
}

fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

#[test]
fn bombs_are_refused() {
    // A zlib block of zeros that inflates a thousandfold, referred to by many arrays.
    let mut data = Vec::new();
    let n = 32usize << 20;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut encoder, &vec![0u8; n]).expect("memory takes all");
    let packed = encoder.finish().expect("memory takes all");
    for word in [1u32, n as u32, 0, packed.len() as u32] {
        data.extend(word.to_le_bytes());
    }
    data.extend(&packed);
    let mut text = "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\"><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><PointData>".to_owned();
    for i in 0..100 {
        text += &format!("<DataArray type=\"Float32\" Name=\"a{i}\" format=\"appended\" offset=\"0\"/>");
    }
    text += "</PointData></Piece><AppendedData encoding=\"raw\">_";
    let told = error(&[text.as_bytes(), &data].concat(), "a.vtu");
    assert!(told.contains("bomb"), "{told}");
    // Many sections of results without values, for many nodes: each would take memory for all of them.
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n20000\n");
    for i in 0..20_000 {
        text += &format!("{i} {i} 0 0\n");
    }
    text += "$EndNodes\n";
    for i in 0..5000 {
        text += &format!("$NodeData\n1\n\"{i}\"\n0\n3\n0\n9\n0\n$EndNodeData\n");
    }
    assert!(error(text.as_bytes(), "a.msh").contains("bomb"));
    // Sets that contain themselves many times and would double with each line.
    let mut text = DECK.replace("*STEP\n", "");
    for _ in 0..200_000 {
        text += "*NSET, NSET=G\nN,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N,N\n";
    }
    let read = parse_fe(text.as_bytes(), Some("a.inp"));
    assert!(read.is_err(), "{:?}", read.map(|f| f.groups.len()));
    // Counts that promise more than the file holds.
    for (text, name) in [
        (
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 199999999 1 199999999\n2 1 0 199999999\n1\n",
            "a.msh",
        ),
        (
            "# vtk DataFile Version 3.0\na\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 199999999 double\n",
            "a.vtk",
        ),
        ("MeshVersionFormatted 1\nVertices\n199999999\n", "a.mesh"),
    ] {
        error(text.as_bytes(), name);
    }
}

#[test]
fn fixtures_are_good() {
    let all = fixtures();
    assert!(all.len() > 15, "{} fixtures", all.len());
    for (name, bytes) in all {
        parse_fe(&bytes, Some(&name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

/// Reads the bytes and, if they could be read, evaluates the result. Nodes are finite, elements and results belong to
/// nodes that exist, and stress can be sampled everywhere.
fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    assert!(file.nodes.iter().all(|p| p.is_finite()), "{:?}", file.nodes);
    let n = file.nodes.len();
    assert!(n <= bytes.len() && file.elements.len() <= bytes.len(), "{n} nodes of {} bytes", bytes.len());
    let exists = |i: &u32| (*i as usize) < n;
    assert!(file.elements.iter().flat_map(|e| e.nodes()).all(exists), "{:?}", file.elements);
    if let Ok(forces) = file.nodal_forces(0) {
        assert_eq!(forces.len(), n);
    }
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    assert_eq!((result.nodes.len(), result.stress.len()), (n, n));
    assert!(result.displacement.as_ref().is_none_or(|u| u.len() == n));
    let field = StressField::new(result);
    for p in [grainpath_core::DVec3::ZERO, grainpath_core::DVec3::new(1e9, -1e9, 0.5)] {
        let stress = field.sample(p);
        assert!(stress.iter().all(|s| s.is_finite()), "{stress:?} at {p}");
    }
}

proptest! {
    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..1500), kind in 0usize..7) {
        let names = ["a.vtu", "a.vtk", "a.msh", "a.frd", "a.inp", "a.mesh", "a.csv"];
        let starts: [&[u8]; 7] = [b"<VTKFile type=\"UnstructuredGrid\"><Piece NumberOfPoints=\"2\" NumberOfCells=\"1\"><Points>",
            b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n",
            b"$MeshFormat\n2.2 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n3\n",
            b"    1C\n    2C                             3                                     2\n",
            b"*NODE\n1,0,0,0\n*ELEMENT,TYPE=C3D4\n", b"MeshVersionFormatted 1\nVertices\n3\n", b"x,y,z,sxx,syy,szz,sxy,syz,szx\n"];
        let mut all = starts[kind].to_vec();
        all.extend(&bytes);
        survive(&all, names[kind]);
        survive(&bytes, names[kind]);
    }

    #[test]
    fn changed_files_are_survived(which in any::<prop::sample::Index>(), at in any::<prop::sample::Index>(),
        value in any::<u8>(), cut in any::<prop::sample::Index>(), more in any::<prop::sample::Index>(), other in any::<u8>()) {
        let all = fixtures();
        let (name, mut bytes) = all[which.index(all.len())].clone();
        let n = bytes.len();
        bytes[at.index(n)] = value;
        survive(&bytes, &name);
        bytes[more.index(n)] = other;
        survive(&bytes, &name);
        bytes.truncate(cut.index(n));
        survive(&bytes, &name);
    }

    #[test]
    fn digits_may_change(which in any::<prop::sample::Index>(), at in any::<prop::sample::Index>(), digit in b'0'..=b'9') {
        let all = fixtures();
        let (name, mut bytes) = all[which.index(all.len())].clone();
        let digits: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
        bytes[digits[at.index(digits.len())]] = digit;
        survive(&bytes, &name);
    }
}
