//! Errors of scans.

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::slices::SliceError;

/// Why a scan cannot be made into layers.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum ScanError {
    #[error(transparent)]
    Slices(#[from] SliceError),
    #[error(
        "the part is {height_mm} mm high, less than half the first layer ({first_layer_mm} mm); check its unit"
    )]
    TooFlat { height_mm: f64, first_layer_mm: f64 },
    #[error("{n} layers of {height_mm} mm; at most {limit} are made")]
    TooManyLayers { n: usize, height_mm: f64, limit: usize },
    #[error("{problem}")]
    Unusable { problem: String },
    #[error("no layer of the part has any area")]
    NothingLeft,
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

pub(super) fn wrong(problem: String) -> ScanError {
    ScanError::Unusable { problem }
}
