//! The result of planning a job.

use grainpath_core::diagnostics::Stage;
use grainpath_core::{Density, LayerStack, Plan, PlannedPath, TriMesh, Warning, WarningId};
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
    /// Fixtures and loads for the reserve of a part whose stress was solved and whose reserve is solved on the cells of its beads:
    /// of plates, and of parts whose beads do not share the load evenly, with sparse infill, fibre, or without walls. `None` for
    /// other parts.
    pub on_cells: Option<Result<TestSetup, StrengthError>>,
    /// Report of the scan, if the shape is a scan.
    pub scan: Option<CtReport>,
}

impl Planned {
    /// Numbers of the layers of the part in which no bead of it was laid.
    pub fn empty_layers(&self) -> impl Iterator<Item = usize> {
        // Skirt, brim and supports are no part of the piece, and may be all that a layer prints.
        let of_part = |planned: &PlannedPath| planned.path.role.is_part();
        let layers = self.plan.layers.iter().zip(self.stack.layers()).enumerate();
        layers
            .filter(move |(_, (plan, part))| !part.region().is_empty() && !plan.paths.iter().any(of_part))
            .map(|(k, _)| k)
    }

    /// Volume of the part in its layers without a bead, mm3.
    pub fn empty_mm3(&self) -> f64 {
        let layers = self.stack.layers();
        self.empty_layers().map(|k| layers[k].region().area_mm2() * layers[k].height_mm()).sum()
    }

    /// A warning where layers of the part hold no bead of it.
    pub(crate) fn empty_warning(&self) -> Option<Warning> {
        let layers = self.stack.layers();
        let empty: Vec<usize> = self.empty_layers().collect();
        let (first, last) = (*empty.first()?, *empty.last()?);
        if empty.len() == layers.len() {
            let text =
                "no bead of the part was laid: it is narrower than a bead, or has neither walls nor infill";
            return Some(Warning::new(WarningId::FillMissing, text));
        }
        let mm3 = self.empty_mm3();
        (mm3 >= LEAST_EMPTY_MM3).then(|| {
            let text = format!(
                "{} layers up to layer {} hold no bead, though {mm3:.1} mm3 of the part lie in them: it is narrower than \
                 a bead there",
                empty.len(),
                last + 1
            );
            Warning::new(WarningId::FillMissing, text).in_layer(first, layers[first].z_top_mm())
        })
    }
}

/// Empty layers with less of the part in all are not told, mm3. Source: derived; a bead of 0.45 x 0.2 mm that is 11 mm long,
/// more than the tip of a cone holds above its last bead.
const LEAST_EMPTY_MM3: f64 = 1.0;
