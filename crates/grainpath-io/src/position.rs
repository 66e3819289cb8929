//! The check that every position read from a mesh or finite-element file passes.

use grainpath_core::DVec3;

/// A coordinate is not a finite number, or so large that the file must be damaged. `place` is a line, a facet or a node.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: coordinate {value:?} is not a finite number below 1e9")]
#[allow(missing_docs)]
pub struct BadCoordinate {
    pub place: String,
    pub value: f64,
}

/// Coordinates beyond this come from damage, whatever the unit. Source: derived. A part 1 km long has coordinates of 1e9 in
/// micrometres, the smallest unit that files use.
const MAX_COORDINATE: f64 = 1e9;

/// Returns `p` as a vector if all three coordinates are finite and in range.
pub(crate) fn checked(p: [f64; 3], place: impl Fn() -> String) -> Result<DVec3, BadCoordinate> {
    match p.into_iter().find(|c| c.is_nan() || c.abs() > MAX_COORDINATE) {
        Some(value) => Err(BadCoordinate { place: place(), value }),
        None => Ok(DVec3::from(p)),
    }
}
