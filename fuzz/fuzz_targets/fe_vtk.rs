//! Legacy VTK, ASCII and binary.
#![no_main]

use grainpath_fuzz::survive_fe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.vtk");
    for style in ["ASCII", "BINARY"] {
        let head = format!("# vtk DataFile Version 3.0\na\n{style}\nDATASET UNSTRUCTURED_GRID\n");
        survive_fe(&[head.as_bytes(), bytes].concat(), "a.vtk");
    }
});
