//! VTU as it comes, and with a header and appended data given.
#![no_main]

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive(bytes, "a.vtu");
    let head = b"<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"";
    survive(&[head, &b">"[..], bytes].concat(), "a.vtu");
    let packed = b" compressor=\"vtkZLibDataCompressor\"><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece><AppendedData encoding=\"raw\">_";
    survive(&[head, &packed[..], bytes].concat(), "a.vtu");
});
