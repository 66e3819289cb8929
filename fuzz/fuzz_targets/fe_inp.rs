//! Abaqus and CalculiX decks.
#![no_main]

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

fn survive(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let _ = file.nodal_forces(0);
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive(bytes, "a.inp");
    let mesh = b"*NODE, NSET=N\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=E\n1,1,2,3,4\n*STEP\n";
    survive(&[&mesh[..], bytes].concat(), "a.inp");
});
