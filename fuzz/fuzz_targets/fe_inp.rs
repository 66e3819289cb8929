//! Abaqus and CalculiX decks.
#![no_main]

use grainpath_fuzz::survive_fe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    survive_fe(bytes, "a.inp");
    let mesh = b"*NODE, NSET=N\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=E\n1,1,2,3,4\n*STEP\n";
    survive_fe(&[&mesh[..], bytes].concat(), "a.inp");
});
