//! Errors of a run, and who has to act on them.

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::slices::SliceError;
use grainpath_gcode::GcodeError;
use grainpath_imaging::scan::ScanError;
use grainpath_io::directions::DirectionError;
use grainpath_io::volume::VolumeError;
use grainpath_io::{ImageError, MeshError, OutlineError};
use grainpath_job::JobError;

use crate::error_kind::ErrorKind;
use crate::fibre::FibreError;
use crate::guide::GuideError;
use crate::guide::given_field::FieldError;
use crate::guide::graded_density::DensityError;
use crate::guide::grain::GrainError;
use crate::measure::dimensions::DimensionError;
use crate::measure::strength::StrengthError;
use crate::region::RegionError;
use crate::shape::ShapeError;

/// The error that ended a run early.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum Error {
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    #[error("{path}: {source}")]
    Mesh { path: String, source: MeshError },
    #[error("{path}: {source}")]
    Outline { path: String, source: OutlineError },
    #[error(transparent)]
    Volume(#[from] VolumeError),
    #[error(transparent)]
    Slices(#[from] SliceError),
    #[error("{path}: {source}")]
    Shape { path: String, source: ShapeError },
    #[error("{path}: {source}")]
    Scan { path: String, source: ScanError },
    #[error("{path}: {source}")]
    Image { path: String, source: ImageError },
    #[error("{path}: {source}")]
    Grain { path: String, source: GrainError },
    #[error("guide: {0}")]
    Guide(#[from] GuideError),
    #[error("{path}: {source}")]
    Directions { path: String, source: DirectionError },
    #[error("{path}: {source}")]
    Field { path: String, source: FieldError },
    #[error(transparent)]
    Fibre(#[from] FibreError),
    #[error(transparent)]
    Region(#[from] RegionError),
    #[error("strength: {0}")]
    Strength(#[from] StrengthError),
    #[error(transparent)]
    Gcode(#[from] GcodeError),
    #[error("{source}; the part measures {:.2} x {:.2} x {:.2} mm: turn it (shape.rotate_deg), move it (shape.position_mm), make it smaller (shape.scale, or its unit) or state the printer's printer.bed_mm", size_mm[0], size_mm[1], size_mm[2])]
    OutsideBed { size_mm: [f64; 3], source: GcodeError },
    #[error(
        "fill.mass_g = {asked_g}: with this pattern the part weighs {low_g:.2} g without fill and {high_g:.2} g when dense"
    )]
    Mass { asked_g: f64, low_g: f64, high_g: f64 },
    #[error(
        "fill.mass_g = {asked_g}: with this pattern the part weighs {low_g:.2} g at density {least} everywhere and {high_g:.2} g at \
         {most}; change fill.density.min or max"
    )]
    GradedMass { asked_g: f64, least: f64, low_g: f64, most: f64, high_g: f64 },
    #[error("{path}: {source}")]
    Densities { path: String, source: DirectionError },
    #[error(transparent)]
    Density(#[from] DensityError),
    #[error("the filled paths have {n} layers, and the part has {n_layers}")]
    FilledElsewhere { n: usize, n_layers: usize },
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl Error {
    /// The page of the documentation that helps with the error, if there is one. This is the only list of these pages.
    pub fn page(&self) -> Option<&'static str> {
        Some(match self {
            Self::Job(_) => "docs/settings.md",
            Self::Mesh { .. } | Self::Outline { .. } | Self::Shape { .. } => "docs/formats.md",
            Self::Volume(_) | Self::Slices(_) | Self::Scan { .. } | Self::Dimension(_) => "docs/ct.md",
            Self::Image { .. } | Self::Grain { .. } => "docs/woodgrain.md",
            Self::Guide(e) if e.is_usage() => "docs/how-to/loads.md",
            Self::Guide(_) => "docs/stress.md",
            Self::Directions { .. } | Self::Field { .. } => "docs/directions.md",
            Self::Densities { .. } | Self::Density(_) | Self::GradedMass { .. } | Self::Mass { .. } => {
                "docs/how-to/density.md"
            }
            Self::Fibre(_) => "docs/how-to/fibre.md",
            Self::Strength(_) => "docs/strength.md",
            Self::Gcode(GcodeError::UnknownPlaceholder { .. }) => "docs/gcode.md",
            // The message is enough; no page says more.
            Self::Region(_)
            | Self::Gcode(_)
            | Self::OutsideBed { .. }
            | Self::FilledElsewhere { .. }
            | Self::Interrupted(_) => return None,
        })
    }

    /// The file that the error is about, if it is about one. A shape that the caller passed in memory has the name that
    /// the caller gave it.
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::Job(e) => e.location().map(|place| place.file.as_str()),
            Self::Mesh { path, .. }
            | Self::Outline { path, .. }
            | Self::Shape { path, .. }
            | Self::Image { path, .. }
            | Self::Grain { path, .. }
            | Self::Directions { path, .. }
            | Self::Field { path, .. }
            | Self::Densities { path, .. } => Some(path),
            // A scan may be a folder, and a header may name another file: the reader knows which one is at fault.
            Self::Scan { source: ScanError::Slices(e), path } => Some(file_of(e).unwrap_or(path)),
            Self::Scan { path, .. } => Some(path),
            Self::Volume(e) => Some(&e.file),
            Self::Slices(e) => file_of(e),
            Self::Dimension(_)
            | Self::Guide(_)
            | Self::Fibre(_)
            | Self::Region(_)
            | Self::Strength(_)
            | Self::Gcode(_)
            | Self::OutsideBed { .. }
            | Self::Mass { .. }
            | Self::GradedMass { .. }
            | Self::Density(_)
            | Self::FilledElsewhere { .. }
            | Self::Interrupted(_) => None,
        }
    }

    /// Who has to act on the error.
    pub fn kind(&self) -> ErrorKind {
        match self {
            // An interruption has the same kind in every stage.
            Self::Shape { source: ShapeError::Interrupted(_), .. }
            | Self::Scan { source: ScanError::Interrupted(_), .. }
            | Self::Guide(GuideError::Interrupted(_))
            | Self::Interrupted(_) => ErrorKind::Interrupted,
            Self::Strength(e) => e.kind(),
            Self::Guide(e) if e.is_usage() => ErrorKind::Job,
            // Wrong corners of a photograph are an error of the job, which states them.
            Self::Grain { source: GrainError::Corners(_), .. }
            | Self::Job(_)
            | Self::Dimension(_)
            | Self::Fibre(_)
            | Self::Region(_)
            | Self::Density(DensityError::NoStress | DensityError::NoFile)
            | Self::Gcode(GcodeError::UnknownPlaceholder { .. } | GcodeError::Io(_)) => ErrorKind::Job,
            Self::Mesh { .. }
            | Self::Outline { .. }
            | Self::Volume(_)
            | Self::Slices(_)
            | Self::Scan { .. }
            | Self::Image { .. }
            | Self::Grain { .. }
            | Self::Directions { .. }
            | Self::Field { .. }
            | Self::Densities { .. }
            | Self::Density(DensityError::Elsewhere { .. } | DensityError::Nowhere { .. })
            | Self::FilledElsewhere { .. }
            | Self::Shape { .. } => ErrorKind::Input,
            Self::Gcode(_)
            | Self::OutsideBed { .. }
            | Self::Mass { .. }
            | Self::GradedMass { .. }
            | Self::Guide(_) => ErrorKind::Physics,
        }
    }
}

/// The file of a slice that could not be read.
fn file_of(error: &SliceError) -> Option<&str> {
    error.downcast_ref::<VolumeError>().map(|e| e.file.as_str())
}
