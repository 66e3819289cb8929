//! CSV and Medit meshes.
#![no_main]

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive(bytes, "a.csv");
    survive(&[b"x,y,z,sxx,syy,szz,sxy,syz,szx\n", bytes].concat(), "a.csv");
    survive(&[b"MeshVersionFormatted 1\n", bytes].concat(), "a.mesh");
});
