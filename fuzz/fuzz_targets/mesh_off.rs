//! OFF.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_io::parse_mesh(&[b"OFF\n", bytes].concat(), Some("a.off"));
});
