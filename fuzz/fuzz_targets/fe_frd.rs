//! CalculiX FRD, ASCII and binary.
#![no_main]

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive(bytes, "a.frd");
    let nodes = b"    1C\n    2C                             2                                     1\n -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 1.00000E+00 0.00000E+00 0.00000E+00\n -3\n";
    survive(&[&nodes[..], bytes].concat(), "a.frd");
});
