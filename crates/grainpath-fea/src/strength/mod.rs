//! The virtual strength test: from beads to the load at which a part fails.
//!
//! The beads of a program become cells of a grid. A part of one section under loads in its plane is a plate: its layers
//! are homogenised through the thickness, with the directions of beads kept apart ([`laminate`]), and its cells are
//! square elements under plane stress ([`squares`], [`plate_system`]). Any other part is a solid of box-shaped cells
//! ([`bricks`]), whose layers can part as well.
//!
//! Both are loaded until they fail ([`plate_strength`], [`brick_strength`]): plies fail at the strengths of their
//! material ([`card`]), lose stiffness on a straight softening line that spends its fracture energy ([`damage`]), and the
//! load is stepped until the part carries no more. Where a stress is known already, [`first_failure`] tells what fails first
//! without solving for the cells, and [`reserve_map`] how far each bead is from failing.

pub mod brick_strength;
pub mod bricks;
pub mod cell_grid;
pub mod card;
pub mod damage;
pub mod squares;
pub mod first_failure;
pub mod grid_turn;
mod fronts;
mod joined_beads;
pub mod laminate;
mod load_stepping;
pub mod plate_strength;
pub mod plate_system;
pub mod ply_mix;
pub mod reserve_map;
mod strain_fit;
mod wall_bending;

use grainpath_core::DVec3;
use grainpath_core::diagnostics::Interrupted;
use grainpath_core::tuned::Tuned;

use crate::material::Unstable;
use crate::solid::SolidError;
use crate::sparse::SparseError;
use card::FailureMode;
pub use load_stepping::CurvePoint;
pub use wall_bending::{CELLS_ACROSS, UnresolvedBending};

/// Why a test has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TestError {
    /// The solver of plates failed.
    #[error(transparent)]
    Sparse(SparseError),
    /// The solver of solids failed.
    #[error(transparent)]
    Solid(SolidError),
    /// The elastic constants of a card are not those of a stable material.
    #[error(transparent)]
    Material(#[from] Unstable),
    /// A stop was asked for.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The load strains nothing that can fail.
    #[error("the load strains nothing that can break")]
    Unloaded,
}

impl From<SparseError> for TestError {
    fn from(error: SparseError) -> Self {
        match error {
            SparseError::Interrupted(e) => Self::Interrupted(e),
            error => Self::Sparse(error),
        }
    }
}

impl From<SolidError> for TestError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Interrupted(e) => Self::Interrupted(e),
            error => Self::Solid(error),
        }
    }
}

/// The result of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The largest load that the part carries, N.
    pub peak_load_n: f64,
    /// The load at which the first ply fails, N, at most the peak. Plates tell it from fitted strains (`strain_fit`), so the
    /// load at which the first single cell is damaged is lower.
    pub first_failure_n: f64,
    /// Load over the displacement of the load, before anything fails, N/mm.
    pub stiffness_n_per_mm: f64,
    /// Load over displacement at each new maximum of the load, and beyond the peak.
    pub curve: Vec<CurvePoint>,
    /// Load and displacement of every state that was solved, in order: the curve and what lies below it.
    pub states: Vec<CurvePoint>,
    /// Share of the energy that each mode spent, in the order of [`FailureMode::ALL`].
    pub mode_shares: [f64; 5],
    /// The place where most energy was spent, mm; plates lie at z = 0.
    pub weakest: DVec3,
    /// Share of the stiffness that each element has lost, 0 to 1.
    pub damage: Vec<f32>,
    /// The first of `states` in which each element is broken, see [`BROKEN_SHARE`]; `None` for those that never are.
    pub broke_at: Vec<Option<u32>>,
    /// The largest failure index of each element when the first ply failed, 0 to 1.
    pub failure_index: Vec<f32>,
    /// Number of unknowns.
    pub dofs: usize,
    /// Number of solutions.
    pub solutions: usize,
    /// Number of factorizations, or of preconditioners that were made.
    pub factorizations: usize,
    /// Whether the load was followed past its peak. Where it was not, the peak is a lower bound.
    pub past_peak: bool,
}

/// Share of its stiffness that an element must have lost to count as broken. Source: chosen; the softening law of
/// `docs/strength.md` has spent a tenth of its energy there, and elements beside a crack keep less damage.
pub const BROKEN_SHARE: f32 = 0.3;

impl Outcome {
    /// The mode that spent most energy.
    pub fn mode(&self) -> FailureMode {
        let share = |k: &usize| self.mode_shares[*k];
        let by_share = |a: &usize, b: &usize| share(a).total_cmp(&share(b)).then(b.cmp(a));
        FailureMode::ALL[(0..5).max_by(by_share).unwrap_or(0)]
    }
}

/// A neighbour of a failing element counts as beside the crack if the cosine between the direction to it and the
/// crack's normal is at least this; otherwise it lies ahead of the crack. Measured: row `fea.strength.CRACK_NORMAL_COS`
/// of `cargo xtask bench constants`.
static CRACK_NORMAL_COS: Tuned<f64> = Tuned::new("fea.strength.CRACK_NORMAL_COS", 0.6);
