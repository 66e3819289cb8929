//! The result of planning a job.

use grainpath_core::diagnostics::Stage;
use grainpath_core::{Density, LayerStack, Plan, TriMesh};
use grainpath_gcode::WriteConfig;
use grainpath_imaging::scan::CtReport;

use crate::guide::Guide;
use crate::guide::given_field::FieldGuide;
use crate::guide::grain::GrainGuide;
use crate::measure::laid_density::LaidDensity;
use crate::measure::strength::{StrengthError, TestSetup};
use crate::support::Support;

/// A planned job.
pub struct Planned {
    /// The paths of all layers.
    pub plan: Plan,
    /// The layers of the part from which the plan was made.
    pub stack: LayerStack,
    /// Settings for writing the plan as G-code.
    pub config: WriteConfig,
    /// Seconds of each stage, in the order of the run.
    pub stages_s: Vec<(Stage, f64)>,
    /// The supports, for jobs with supports.
    pub support: Option<Support>,
    /// The part's surface, kept for pictures of the supports.
    pub supported_mesh: Option<TriMesh>,
    /// Density of sparse infill: as set in the job, or computed for a required mass.
    pub density: Density,
    /// Comparison of the density of the beads with the required density, for jobs with graded density.
    pub laid: Option<LaidDensity>,
    /// The grain that infill follows, for jobs with such a guide.
    pub grain: Option<GrainGuide>,
    /// The user's own directions, for jobs that have them.
    pub field: Option<FieldGuide>,
    /// Directions and the stress from which they were computed, for jobs with loads.
    pub guide: Option<Guide>,
    /// The inputs of a strength test that come from the part, for jobs that ask for a test.
    pub test: Option<TestSetup>,
    /// Fixtures and loads for the reserve of a part whose stress was solved but whose beads do not share the load evenly: with
    /// sparse infill, or without walls. `None` for other parts.
    pub uneven: Option<Result<TestSetup, StrengthError>>,
    /// Report of the scan, if the shape is a scan.
    pub scan: Option<CtReport>,
}
