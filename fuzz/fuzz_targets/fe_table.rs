//! CSV and Medit meshes.
#![no_main]

use grainpath_fuzz::survive_fe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.csv");
    survive_fe(&[b"x,y,z,sxx,syy,szz,sxy,syz,szx\n", bytes].concat(), "a.csv");
    survive_fe(&[b"MeshVersionFormatted 1\n", bytes].concat(), "a.mesh");
});
