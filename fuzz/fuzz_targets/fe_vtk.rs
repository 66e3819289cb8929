//! Legacy VTK, ASCII and binary.
#![no_main]

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive(bytes, "a.vtk");
    for style in ["ASCII", "BINARY"] {
        let head = format!("# vtk DataFile Version 3.0\na\n{style}\nDATASET UNSTRUCTURED_GRID\n");
        survive(&[head.as_bytes(), bytes].concat(), "a.vtk");
    }
});
