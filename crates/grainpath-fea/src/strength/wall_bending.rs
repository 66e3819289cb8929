//! Whether the cells of a test resolve the bending of thin walls.
//!
//! Failure indices are taken from the strain in the middle of a cell. In a wall one cell thick that strain is zero under
//! pure bending, and the wall would seem unbreakable; with two cells across, a wall carries a third too much; from four
//! cells on, the sum over the cells equals the moment of the section. Before a test, one linear solution is therefore
//! made. For each element with fewer than [`CELLS_ACROSS`] cells across the part, it gives the failure
//! index in the middle and on the faces of the wall. If the faces have the higher index in the elements that fail first,
//! bending governs and the cells are too large.
//!
//! Walls at an angle to the grid: a plane wall that is as long as `a`, `b` and `c` along the axes has the thickness `t` with
//! `1/t^2 = 1/a^2 + 1/b^2 + 1/c^2`, and its normal has the components `t/a`, `t/b` and `t/c`. A cell of such a wall does not
//! show by its own corners how the wall bends: a cell that lies at 45 degrees does not see it at all. The strain and its
//! slope therefore come from a straight fit over the cells around, which also evens out the steps of the face.
//!
//! The cost is one linear solution. A bar that is thin along two axes is taken for a wall between them, by up to the square
//! root of two too thin; that matters only where it bends about both.

use grainpath_core::tuned::Tuned;
use grainpath_core::{DMat3, DVec3};

use super::TestError;

/// Number of cells across a wall that resolves its bending. Source: derived. The moment of a section that yields is the sum
/// over n cells of stress times lever arm, which is exact for even n. With two cells, each cell's own bending stiffness adds
/// a third, because a cell does not fail at its faces.
pub const CELLS_ACROSS: f64 = 4.0;
/// Walls with fewer full cells across count as thin. Source: derived. Half a cell is the rounding to whole cells: a wall
/// meant to be [`CELLS_ACROSS`] thick that is a little underfilled has at least this, and one of three cells has less.
pub(super) const MIN_CELLS_ACROSS: f64 = CELLS_ACROSS - 0.5;
/// Cells on each side of a cell that are counted along an axis. A wall that goes on beyond them has no end along the axis.
/// Source: derived. A wall of [`MIN_CELLS_ACROSS`] cells with a longer run, from its middle, leans by less than 13 degrees
/// and is 3 % thinner than its run along the other axis.
const RUN_CELLS: usize = 8;
/// A wall whose normal has no second component above this stands along the grid. Source: derived. Such a wall leans by less
/// than 11 degrees, and the strain of its cells shows 93 % of its bending: the cosine of twice the angle.
const LEANING: f64 = 0.2;
/// Strains around a cell show their slope across a wall if the distances of the cells from the middle plane vary by this share
/// of a cell (root of the mean square). Source: derived. In a wall one cell thick at 45 degrees they vary by 0.36, in one
/// along the grid not at all.
const LEAST_SPREAD: f64 = 0.25;
/// What is added to the mean squares of these distances, as a share of the square of a cell, so that a direction in which there
/// are no cells has no slope. Source: derived. It takes 2 % from the slope at [`LEAST_SPREAD`].
const RIDGE: f64 = 1e-3;
/// A bar that is thin along two axes counts as a wall along the grid, and not as one between the axes, where the index on its
/// faces is higher by this factor. Source: derived. The factor is 2 for a square bar that bends about one axis, and 1, but for
/// the steps of the face, for a wall.
const BAR: f64 = 1.2;
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

/// Whether a cell lies for the most part outside the part: it is less than half as full as a cell beside it. Its middle has a
/// higher strain than the face of the wall, it carries little, and the wall cannot be measured through it, so it is not judged.
pub(super) fn is_outside(filled: f64, beside: impl Iterator<Item = f64>) -> bool {
    beside.fold(0.0, f64::max) > 2.0 * filled + 1e-6
}

/// Cells through a cell along an axis, in full cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellsAlong {
    /// Their number; infinite where the material goes on for more than [`RUN_CELLS`] on one side.
    pub(super) cells: f64,
    /// From the cell to the middle of the run.
    middle: f64,
}

impl CellsAlong {
    /// A run without ends.
    pub(super) const ENDLESS: Self = Self { cells: f64::INFINITY, middle: 0.0 };

    /// The run through a cell that is as full as `own`, from how full the cells above and below it are, the nearest first.
    pub(super) fn new(own: f64, above: impl Iterator<Item = f64>, below: impl Iterator<Item = f64>) -> Self {
        let (above, below) = (full_cells(above), full_cells(below));
        Self { cells: own + above + below, middle: 0.5 * (above - below) }
    }
}

/// The sum of how full the cells beside a cell are, from one to the next; infinite if they go on for more than [`RUN_CELLS`].
fn full_cells(filled: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    for share in filled.take(RUN_CELLS + 1) {
        (sum, n) = (sum + share, n + 1);
    }
    if n > RUN_CELLS { f64::INFINITY } else { sum }
}

/// The wall that a cell lies in.
#[derive(Debug, Clone, Copy)]
pub(super) struct WallThrough {
    /// What lies along each axis through the cell.
    pub runs: [CellsAlong; 3],
    /// The edges of a cell, mm.
    pub cell_mm: DVec3,
}

impl WallThrough {
    /// Whether the wall has fewer cells across than resolve its bending.
    pub(super) fn is_thin(&self) -> bool {
        self.runs.iter().any(|run| run.cells < MIN_CELLS_ACROSS) || self.leaning().is_some()
    }

    /// The normal, with components that are not negative, and the thickness in mm of a thin wall that leans against the grid.
    fn leaning(&self) -> Option<(DVec3, f64)> {
        let inverse_mm = 1.0 / (DVec3::from_array(self.runs.map(|run| run.cells)) * self.cell_mm);
        let thickness_mm = 1.0 / inverse_mm.length();
        let normal = inverse_mm * thickness_mm;
        let leans = normal.to_array().into_iter().filter(|n| *n > LEANING).count() > 1;
        (leans && thickness_mm < MIN_CELLS_ACROSS * (normal * self.cell_mm).length())
            .then_some((normal, thickness_mm))
    }

    /// The sample of a cell in a thin wall that leans. `around` gives the cell itself and those around it: where each lies,
    /// from the cell, in mm; how full it is; and the strain in its middle. `None` for a wall along the grid, whose cells show
    /// themselves how it bends.
    pub(super) fn leaning_sample<const N: usize>(
        &self,
        around: impl FnOnce() -> Vec<(DVec3, f64, [f64; N])>,
        index: impl Fn([f64; N]) -> f64,
    ) -> Option<BendingSample> {
        let (normal, thickness_mm) = self.leaning()?;
        let around = around();
        let weight: f64 = around.iter().map(|a| a.1).sum();
        let off = around.iter().map(|a| a.0 * a.1).sum::<DVec3>() / weight;
        let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        let squares = around.iter().fold(DMat3::ZERO, |sum, a| sum + outer(a.0 - off) * (a.1 / weight));
        // Only the sides of the normal are known, not its signs.
        let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let leaning = signs.map(|[y, z]| (normal * DVec3::new(1.0, y, z), thickness_mm));
        let reach_mm = |normal: DVec3| (normal * self.cell_mm).length();
        let spread_mm = |n: DVec3| n.dot(squares * n).sqrt();
        if leaning.iter().any(|(n, _)| spread_mm(*n) < LEAST_SPREAD * reach_mm(*n)) {
            return None;
        }
        let ridge = DMat3::from_diagonal(RIDGE * self.cell_mm * self.cell_mm);
        let inverse = (squares + ridge).inverse();
        let mean: [f64; N] =
            std::array::from_fn(|k| around.iter().map(|a| a.2[k] * a.1).sum::<f64>() / weight);
        let slope: [DVec3; N] = std::array::from_fn(|k| {
            inverse * (around.iter().map(|a| (a.0 - off) * (a.2[k] * a.1)).sum::<DVec3>() / weight)
        });
        let at = |p: DVec3| index(std::array::from_fn(|k| mean[k] + slope[k].dot(p - off)));
        // The highest index at a distance from the middle of the wall, along its run with this axis.
        let highest = |axis: usize, normal: DVec3, distance_mm: f64| {
            let middle = DVec3::AXES[axis] * (self.runs[axis].middle * self.cell_mm[axis]);
            let side = normal * distance_mm.max(0.0);
            at(middle + side).max(at(middle - side))
        };
        // A wall along the grid with as many cells fails first in the middle of its outer cells.
        let judged = |(axis, normal, wall_mm): (usize, DVec3, f64)| BendingSample {
            middle: highest(axis, normal, 0.5 * (wall_mm - reach_mm(normal))),
            face: highest(axis, normal, 0.5 * wall_mm),
            wall_mm,
        };
        let steepest = (0..3).fold(0, |best, a| if normal[a] > normal[best] { a } else { best });
        let leaning = leaning.map(|(normal, wall_mm)| judged((steepest, normal, wall_mm)));
        let axes = (0..3).filter(|a| self.runs[*a].cells < MIN_CELLS_ACROSS);
        let bars = axes.map(|a| judged((a, DVec3::AXES[a], self.runs[a].cells * self.cell_mm[a])));
        let higher = |factor: f64| {
            move |a: BendingSample, b: BendingSample| if b.face > factor * a.face { b } else { a }
        };
        Some(bars.fold(leaning.into_iter().fold(leaning[0], higher(1.0)), higher(BAR)))
    }
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
