//! Stress that an earlier run solved, for programs that plan one part again and again.
//!
//! Method. Everything that a solver reads is compared with what it read the last time: the part, its section where all
//! layers share one, the fixtures and loads as they were resolved, the material and the model. Where nothing differs, the
//! results of the last time are taken, with its warnings. Values are compared and not settings, so a setting that a solver
//! comes to read cannot be forgotten; a new speed, pattern, density or layer height solves nothing.
//!
//! Cost: the last part and its results are kept; comparing is linear in the triangles. Limits: one part is remembered; a
//! solid keeps its stress under new layer heights, a plate too, as long as its section stays the same.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use grainpath_core::{Diagnostics, Region, TriMesh, Warning};
use grainpath_fea::load_case::BoundaryConditions;

use super::plane::constant_section;
use super::{Follow, GuideError, GuidedPart, Solved, StressSettings};
use grainpath_job::choices::Analysis;

/// The stress of the last part that was solved.
#[derive(Default)]
pub struct KnownStress {
    last: Mutex<Option<Arc<Known>>>,
    solved: AtomicUsize,
}

/// What was solved, and what came out.
struct Known {
    settings: StressSettings,
    mesh: TriMesh,
    section: Option<Region>,
    conditions: BoundaryConditions,
    solved: Solved,
    warnings: Vec<Warning>,
}

/// The settings that the solvers read; the others say how layers follow the stress.
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
    /// How often a stress was solved.
    pub fn n_solved(&self) -> usize {
        self.solved.load(Ordering::Relaxed)
    }

    fn last(&self) -> MutexGuard<'_, Option<Arc<Known>>> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The stress of the last time, or what `solve` gives, which is remembered.
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
            // A solid is meshed from its surface, whose section no solver reads.
            Analysis::Solid => None,
            Analysis::Plane | Analysis::Auto => constant_section(part.stack).cloned(),
        };
        // The lock is not held while a stress is solved: another run may look meanwhile.
        let last = self.last().clone();
        let is_same = |known: &Known| {
            // What is cheap to compare comes first; the mesh last.
            known.settings == settings
                && known.conditions == *conditions
                && known.section == section
                && known.mesh == *part.mesh
        };
        if let Some(known) = last.filter(|known| is_same(known)) {
            // Warnings belong to the results: a run that takes them tells the same.
            known.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
            return Ok(known.solved.clone());
        }
        // Only what the solver adds is kept, since other stages warn by themselves.
        let before = diagnostics.warnings();
        let solved = solve()?;
        self.solved.fetch_add(1, Ordering::Relaxed);
        let warnings = diagnostics.warnings().into_iter().filter(|w| !before.contains(w)).collect();
        let (mesh, conditions) = (part.mesh.clone(), conditions.clone());
        let known = Known { settings, mesh, section, conditions, solved: solved.clone(), warnings };
        *self.last() = Some(Arc::new(known));
        Ok(solved)
    }
}
