//! Whether the cells of a test resolve the bending of thin walls.
//!
//! Failure indices are taken from the strain in the middle of a cell. In a wall one cell thick that strain is zero under
//! pure bending, and the wall would seem unbreakable; with two cells across, a wall carries a third too much; from four
//! cells on, the sum over the cells equals the moment of the section. Before a test, one linear solution is therefore
//! made. For each element with fewer than [`CELLS_ACROSS`] cells across the part along some axis, it gives the failure
//! index in the middle and on the faces of the wall. If the faces have the higher index in the elements that fail first,
//! bending governs and the cells are too large.
//!
//! The cost is one linear solution. Walls at an angle to the grid count as thicker than they are, by up to the square
//! root of two in one plane.

use grainpath_core::tuned::Tuned;

use super::TestError;

/// Number of cells across a wall that resolves its bending. Source: derived. The moment of a section that yields is the sum
/// over n cells of stress times lever arm, which is exact for even n. With two cells, each cell's own bending stiffness adds
/// a third, because a cell does not fail at its faces.
pub const CELLS_ACROSS: f64 = 4.0;
/// Walls with fewer full cells across count as thin. Source: derived. Half a cell is the rounding to whole cells: a wall
/// meant to be [`CELLS_ACROSS`] thick that is a little underfilled has at least this, and one of three cells has less.
pub(super) const MIN_CELLS_ACROSS: f64 = CELLS_ACROSS - 0.5;
/// Share of the elements, the most loaded ones, over which indices are averaged, so that a single corner does not
/// decide the result. Measured: row `fea.strength.wall_bending.MOST_LOADED` of `cargo xtask bench constants`.
static MOST_LOADED: Tuned<f64> = Tuned::new("fea.strength.wall_bending.MOST_LOADED", 1e-3);

/// Bending that the cells of a test fail to resolve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UnresolvedBending {
    /// How much higher the failure index is on the faces of thin walls than in the middle of any cell, as a share: 0
    /// where bending does not govern. May be infinite.
    pub share: f64,
    /// The thickness of the walls that bend most, mm; 0 where none does.
    pub wall_mm: f64,
}

/// The failure index of an element at the unit load.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BendingSample {
    /// In the middle.
    pub middle: f64,
    /// The highest one on the faces of a thin wall; equal to `middle` if the wall is not thin.
    pub face: f64,
    /// Thickness of that wall, mm; 0 if the faces are no higher than the middle.
    pub wall_mm: f64,
}

/// Compares the elements most loaded in their middle with those most loaded on their faces.
pub(super) fn unresolved_bending(samples: &[BendingSample]) -> Result<UnresolvedBending, TestError> {
    let n = ((MOST_LOADED.value() * samples.len() as f64).ceil() as usize).clamp(1, samples.len().max(1));
    let highest = |value: fn(&BendingSample) -> f64| {
        let mut sorted: Vec<&BendingSample> = samples.iter().collect();
        sorted.sort_by(|a, b| value(b).total_cmp(&value(a)));
        sorted.truncate(n);
        sorted
    };
    let mean = |some: &[&BendingSample], value: fn(&BendingSample) -> f64| {
        some.iter().map(|s| value(s)).sum::<f64>() / some.len().max(1) as f64
    };
    let faces = highest(|s| s.face);
    let (face, middle) = (mean(&faces, |s| s.face), mean(&highest(|s| s.middle), |s| s.middle));
    if face <= 0.0 {
        return Err(TestError::Unloaded);
    }
    let mut walls: Vec<f64> = faces.iter().map(|s| s.wall_mm).filter(|w| *w > 0.0).collect();
    walls.sort_by(f64::total_cmp);
    let wall_mm = walls.get(walls.len() / 2).copied().unwrap_or(0.0);
    Ok(UnresolvedBending { share: face / middle - 1.0, wall_mm })
}
