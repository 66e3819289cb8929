//! VTU as it comes, and with a header and appended data given.
#![no_main]

use grainpath_fuzz::survive_fe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.vtu");
    let head = b"<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"";
    survive_fe(&[head, &b">"[..], bytes].concat(), "a.vtu");
    let packed = b" compressor=\"vtkZLibDataCompressor\"><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece><AppendedData encoding=\"raw\">_";
    survive_fe(&[head, &packed[..], bytes].concat(), "a.vtu");
});
