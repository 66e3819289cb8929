//! CalculiX FRD, ASCII and binary.
#![no_main]

use grainpath_fuzz::survive_fe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.frd");
    let nodes = b"    1C\n    2C                             2                                     1\n -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 1.00000E+00 0.00000E+00 0.00000E+00\n -3\n";
    survive_fe(&[&nodes[..], bytes].concat(), "a.frd");
});
