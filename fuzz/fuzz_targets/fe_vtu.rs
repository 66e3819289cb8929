//! VTU as it comes, with a header and appended data given, and with arrays behind a good compressed header.
#![no_main]

use std::io::Write;

use grainpath_fuzz::survive_fe;

/// A tetrahedron whose arrays lie in the appended data, all at the same place.
const ARRAYS: &str = "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>\
    <DataArray type=\"Float32\" Name=\"S\" NumberOfComponents=\"6\" format=\"appended\" offset=\"0\"/></PointData>\
    <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points>\
    <Cells><DataArray type=\"Int8\" Name=\"connectivity\" format=\"appended\" offset=\"0\"/>\
    <DataArray type=\"Int8\" Name=\"offsets\" format=\"appended\" offset=\"0\"/>\
    <DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"0\"/></Cells></Piece></UnstructuredGrid>\
    <AppendedData encoding=\"raw\">_";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.vtu");
    let head = "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"";
    survive_fe(&[head.as_bytes(), b">", bytes].concat(), "a.vtu");
    // The bytes as compressed data: each decompressor sees them behind a header that names one block of them.
    for compressor in ["vtkZLibDataCompressor", "vtkLZMADataCompressor", "vtkLZ4DataCompressor"] {
        let text = format!("{head} compressor=\"{compressor}\">{ARRAYS}");
        let full = bytes.first().map_or(0, |&b| u32::from(b));
        let header: Vec<u8> = [1, full, 0, bytes.len() as u32].iter().flat_map(|w| w.to_le_bytes()).collect();
        survive_fe(&[text.as_bytes(), &header, bytes].concat(), "a.vtu");
    }
    // The bytes as what a good zlib stream holds: mutations reach the arrays and not only the checksum.
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    if let Ok(packed) = packed {
        let text = format!("{head} compressor=\"vtkZLibDataCompressor\">{ARRAYS}");
        let words = [1, bytes.len() as u32, 0, packed.len() as u32];
        let header: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        survive_fe(&[text.as_bytes(), &header, &packed].concat(), "a.vtu");
    }
});
