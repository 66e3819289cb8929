//! Gmsh MSH 2.2 and 4.1, ASCII and binary.
#![no_main]

use grainpath_fuzz::survive_fe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.msh");
    for version in ["2.2", "4.1"] {
        let text = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        survive_fe(&[text.as_bytes(), bytes].concat(), "a.msh");
        let head = format!("$MeshFormat\n{version} 1 8\n");
        survive_fe(&[head.as_bytes(), b"\x01\0\0\0\n$EndMeshFormat\n", bytes].concat(), "a.msh");
    }
});
