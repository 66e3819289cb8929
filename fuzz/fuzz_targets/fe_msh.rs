//! Gmsh MSH 2.2 and 4.1, ASCII and binary.
#![no_main]

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive(bytes, "a.msh");
    for version in ["2.2", "4.1"] {
        let text = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        survive(&[text.as_bytes(), bytes].concat(), "a.msh");
        let head = format!("$MeshFormat\n{version} 1 8\n");
        survive(&[head.as_bytes(), b"\x01\0\0\0\n$EndMeshFormat\n", bytes].concat(), "a.msh");
    }
});
