//! G-code: parsed and run in mind.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_gcode::simulate(bytes, 1.75, &grainpath_gcode::Limits::default());
});
