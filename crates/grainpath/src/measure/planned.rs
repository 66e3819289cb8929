//! A planned job.

use grainpath_core::diagnostics::Stage;
use grainpath_core::{Density, LayerStack, Plan, TriMesh};
use grainpath_gcode::WriteConfig;
use grainpath_imaging::scan::CtReport;

use crate::guide::Guide;
use crate::guide::field::FieldGuide;
use crate::guide::grain::GrainGuide;
use crate::measure::density::LaidDensity;
use crate::measure::strength::TestSetup;
use crate::support::Support;

/// A planned job.
pub struct Planned {
    /// The paths of all layers.
    pub plan: Plan,
    /// The sections that it was made from.
    pub stack: LayerStack,
    /// Settings for writing it as G-code.
    pub config: WriteConfig,
    /// Seconds of each stage, in the order of the run.
    pub stages_s: Vec<(Stage, f64)>,
    /// The supports, for jobs with supports.
    pub support: Option<Support>,
    /// The part's surface, kept for pictures of the supports.
    pub supported_mesh: Option<TriMesh>,
    /// Density of sparse infill: that of the job, or the one found for a required mass.
    pub density: Density,
    /// The density as laid against the density asked for, where it is graded.
    pub laid: Option<LaidDensity>,
    /// The grain that infill follows, for jobs with such a guide.
    pub grain: Option<GrainGuide>,
    /// The user's own directions, for jobs that have them.
    pub field: Option<FieldGuide>,
    /// Directions, and the stress that they come from, for jobs with loads.
    pub guide: Option<Guide>,
    /// The part's side of a strength test, for jobs that ask for one.
    pub test: Option<TestSetup>,
    /// Report of the scan, where the shape is one.
    pub scan: Option<CtReport>,
}
