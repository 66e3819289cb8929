//! A planned job.

use grainpath_core::diagnostics::Stage;
use grainpath_core::{Density, LayerStack, Plan, TriMesh};
use grainpath_gcode::WriteConfig;
use grainpath_imaging::scan::CtReport;

use crate::guide::Guide;
use crate::guide::grain::GrainGuide;
use crate::measure::strength::TestSetup;
use crate::support::Support;

/// A planned job.
pub struct Planned {
    /// What is printed.
    pub plan: Plan,
    /// The sections it was made from.
    pub stack: LayerStack,
    /// How it is written.
    pub config: WriteConfig,
    /// Seconds of each stage so far.
    pub stages_s: Vec<(Stage, f64)>,
    /// The supports, where asked for.
    pub support: Option<Support>,
    /// The part's surface, kept to be drawn with its supports where pictures are asked for.
    pub supported_mesh: Option<TriMesh>,
    /// The density of the inside: the one asked for, or the one found for a mass.
    pub density: Density,
    /// The grain it follows, where it does.
    pub grain: Option<GrainGuide>,
    /// Directions and the stress they come from, for jobs that have loads.
    pub guide: Option<Guide>,
    /// What a strength test needs to know of the part, for jobs that want one.
    pub test: Option<TestSetup>,
    /// What was found in a scan, where the shape is one.
    pub scan: Option<CtReport>,
}
