//! Cache of the stress of the last run, for programs that plan the same part repeatedly.
//!
//! Method. All inputs of the solver are compared with those of the last run: the part, its section where all layers share
//! one, the resolved fixtures and loads, the material and the model. If nothing differs, the results and warnings of the
//! last run are used again. The comparison covers all settings of the stress except a short list, so a new setting cannot
//! be forgotten. A new speed, pattern, density or layer height does not start the solver.
//!
//! Cost: the last part and its results are kept; comparing is linear in the triangles. Limits: only one part is
//! remembered. A solid keeps its stress when layer heights change; a plate keeps it as long as its section stays the
//! same.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use grainpath_core::{Diagnostics, Region, TriMesh, Warning};
use grainpath_fea::load_case::BoundaryConditions;

use super::plane::constant_section;
use super::{Follow, GuideError, GuidedPart, Solved, StressSettings};
use crate::shape::Standing;
use grainpath_job::choices::Analysis;

/// The stress of the last part that was solved.
#[derive(Default)]
pub struct KnownStress {
    last: Mutex<Option<Arc<Known>>>,
    solved: AtomicUsize,
}

/// The inputs and the results of the last solution.
struct Known {
    settings: StressSettings,
    mesh: TriMesh,
    standing: Standing,
    section: Option<Region>,
    conditions: BoundaryConditions,
    solved: Solved,
    warnings: Vec<Warning>,
}

/// Copies the settings and resets all that the solvers do not read, because those only say how layers follow the stress.
fn read_by_solvers(settings: &StressSettings) -> StressSettings {
    StressSettings {
        strength_mpa: None,
        follow: Follow::MaxAbs,
        smoothing_mm: 0.0,
        tangent: false,
        cell_mm: 0.0,
        mix: None,
        ..settings.clone()
    }
}

impl KnownStress {
    /// How many times the solver has run.
    pub fn n_solved(&self) -> usize {
        self.solved.load(Ordering::Relaxed)
    }

    fn last(&self) -> MutexGuard<'_, Option<Arc<Known>>> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The remembered stress if the inputs are the same; otherwise calls `solve` and remembers its result.
    pub(super) fn or_solve(
        &self,
        settings: &StressSettings,
        part: &GuidedPart<'_>,
        conditions: &BoundaryConditions,
        diagnostics: &Diagnostics,
        solve: impl FnOnce() -> Result<Solved, GuideError>,
    ) -> Result<Solved, GuideError> {
        let settings = read_by_solvers(settings);
        let section = match settings.analysis {
            // A solid is meshed from its surface, so its section is no input of the solver.
            Analysis::Solid => None,
            Analysis::Plane | Analysis::Auto => constant_section(part.stack).cloned(),
        };
        // The lock is not held during the solution, so that another run can read the cache meanwhile.
        let last = self.last().clone();
        let is_same = |known: &Known| {
            // The cheap comparisons come first and the mesh last.
            known.settings == settings
                && known.conditions == *conditions
                && known.section == section
                // A part with equal sides may be turned into itself, but its triangles turn with it.
                && known.standing == part.standing
                && known.mesh == *part.mesh
        };
        if let Some(known) = last.filter(|known| is_same(known)) {
            // Warnings belong to the results, so a run that reuses the results repeats the warnings.
            known.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
            return Ok(known.solved.clone());
        }
        // Only what the solver adds is kept, since other stages warn by themselves.
        let before = diagnostics.warnings();
        let solved = solve()?;
        self.solved.fetch_add(1, Ordering::Relaxed);
        let warnings = diagnostics.warnings().into_iter().filter(|w| !before.contains(w)).collect();
        let (mesh, conditions) = (part.mesh.clone(), conditions.clone());
        let standing = part.standing;
        let known = Known { settings, mesh, standing, section, conditions, solved: solved.clone(), warnings };
        *self.last() = Some(Arc::new(known));
        Ok(solved)
    }
}
