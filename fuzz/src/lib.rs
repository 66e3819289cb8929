//! What several targets do with what they read.

use grainpath_io::fe::{FeOptions, StressField, parse_fe};

/// Reads a finite-element file and asks for all that a job would.
pub fn survive_fe(bytes: &[u8], name: &str) {
    let Ok(file) = parse_fe(bytes, Some(name)) else { return };
    let _ = file.nodal_forces(0);
    let _ = file.deck_conditions(&FeOptions::default());
    let Ok(result) = file.result(&FeOptions::default()) else { return };
    let _ = StressField::new(result).sample(Default::default());
}
