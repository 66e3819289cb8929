//! The equations of a plate under plane stress: assembled, factored, and solved again as elements lose
//! stiffness.
//!
//! Method: elements are added to the fronts of a multifrontal factorization (`duff1983`), which is repeated
//! only where elements changed; `Fronts` describes it. Fixtures are stiff springs along their directions (the
//! penalty method), so that the pattern of the matrix does not depend on them. A spring is 1e5 times as stiff
//! as the stiffest node. A weak spring at every node, 1e-10 of that stiffness, keeps parts that hang on a
//! single corner from making the matrix singular.
//!
//! Stiffnesses are in N/mm, `(8, 8)` an element, forces in N and displacements in mm, two numbers a node.
//! Cost for n nodes: n^1.5 operations and n log n numbers for a whole factorization, less for a change; a
//! solution is one back substitution. The lower half of each element's stiffness is kept, 288 bytes.
//!
//! Degenerate cases: a matrix that is not positive definite within rounding is an error, and so is a factor
//! above the memory limit. A plate that can move freely hangs on the weak springs alone, so callers test its
//! supports beforehand (`free_motion`). Without a change the factor is used again.

use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::tuned::Tuned;
use rayon::prelude::*;

use super::fronts::{Fronts, Lower};
use super::squares::{GridHold, PlateElements};
use crate::sparse::SparseError;

/// Stiffness of the springs of fixtures over that of the stiffest node. Source: derived. A held node moves by a
/// hundred-thousandth of what a free one would, and ten of the sixteen digits of the factor remain.
const HOLD: f64 = 1e5;
/// Stiffness of a weak spring at every node, as a share of the stiffest node. It keeps parts that hang on a single
/// corner from making the matrix singular. Measured: row `fea.strength.plate_system.LEAST` of
/// `cargo xtask bench constants`.
static LEAST: Tuned<f64> = Tuned::new("fea.strength.plate_system.LEAST", 1e-10);

/// The stiffness of a plate and how to solve it.
pub struct PlateSystem {
    fronts: Fronts,
    stiffness: Vec<Lower>,
    dofs: usize,
    /// Number of factorizations so far, whole or in part.
    pub factored: usize,
    /// Number of solutions so far.
    pub solved: usize,
    stale: bool,
}

fn lower(k: &[[f64; 8]; 8]) -> Lower {
    let mut out = [0.0; 36];
    let mut at = 0;
    for (j, row) in k.iter().enumerate() {
        for value in &row[j..] {
            out[at] = *value;
            at += 1;
        }
    }
    out
}

impl PlateSystem {
    /// Assembles and factors the matrix. `forces` act on the unknowns, N. `cancel` stops this and every later
    /// factorization.
    ///
    /// # Errors
    /// [`SparseError`] when the factor would take more than `max_mib` MiB or the matrix is not positive definite.
    pub fn new(
        elements: &PlateElements,
        stiffness: &(dyn Fn(usize) -> [[f64; 8]; 8] + Sync),
        holds: &[GridHold],
        forces: &[f64],
        max_mib: f64,
        cancel: CancelFlag,
    ) -> Result<Self, SparseError> {
        let dofs = 2 * elements.places.len();
        let all = (0..elements.corners.len()).into_par_iter();
        let stiffness: Vec<Lower> = all.map(|e| lower(&stiffness(e))).collect();
        let stiffest = stiffness.iter().map(|k| k[0].max(k[8])).fold(0.0, f64::max);
        let mut added: Vec<(usize, usize, f64)> =
            (0..dofs).map(|i| (i, i, LEAST.value() * stiffest)).collect();
        for hold in holds {
            let i = 2 * hold.node as usize;
            let (x, y) = (hold.along.x, hold.along.y);
            for (r, c, share) in [(i, i, x * x), (i + 1, i, x * y), (i + 1, i + 1, y * y)] {
                if share != 0.0 {
                    added.push((r, c, HOLD * stiffest * share));
                }
            }
        }
        let mut fronts = Fronts::new(elements, &added, forces, max_mib)?;
        fronts.cancel = cancel;
        fronts.refactor(&stiffness)?;
        Ok(Self { fronts, stiffness, dofs, factored: 1, solved: 0, stale: false })
    }

    /// Number of unknowns.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Changes the stiffness of an element.
    pub fn change(&mut self, element: usize, stiffness: &[[f64; 8]; 8]) {
        self.stiffness[element] = lower(stiffness);
        self.fronts.change(element);
        self.stale = true;
    }

    /// Displacements of the unknowns, mm.
    ///
    /// # Errors
    /// [`SparseError`] when so much stiffness is lost that a part of the plate can move freely.
    pub fn solve(&mut self) -> Result<Vec<f64>, SparseError> {
        if self.stale {
            self.fronts.refactor(&self.stiffness)?;
            self.factored += 1;
            self.stale = false;
        }
        self.solved += 1;
        Ok(self.fronts.solve())
    }
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec2;

    use super::super::cell_grid::CellGrid;
    use super::super::squares::square;
    use super::*;
    use crate::material::Orthotropic;

    fn bar(nx: usize, ny: usize, cell_mm: f64) -> PlateElements {
        let grid = CellGrid { low: DVec2::ZERO, cell_mm, nx, ny };
        PlateElements::from_cells(&grid, &vec![true; nx * ny])
    }

    #[test]
    fn a_square_has_three_free_motions_and_bends_truly() {
        let c = Orthotropic::isotropic(2000.0, 0.3).plane_stress(0.3).expect("stable");
        let k = square(&c);
        let motions: [[f64; 8]; 3] = [
            [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0],
        ];
        for m in motions {
            for row in &k {
                let f: f64 = row.iter().zip(m).map(|(k, m)| k * m).sum();
                assert!(f.abs() < 1e-9 * c[0][0], "{f}");
            }
        }
        // A cantilever of one element's depth: the beam's deflection by a moment, which plain squares miss by half.
        let (n, h, e, t) = (20, 1.0, 2000.0, 1.0);
        let elements = bar(n, 1, h);
        let held = |i: &u32| elements.places[*i as usize][0] == 0;
        let all = 0..elements.places.len() as u32;
        let holds: Vec<GridHold> = all
            .clone()
            .filter(held)
            .flat_map(|node| {
                let y = elements.places[node as usize][1] == 0;
                let x = GridHold { node, along: DVec2::X };
                std::iter::once(x).chain(y.then_some(GridHold { node, along: DVec2::Y }))
            })
            .collect();
        let c = Orthotropic::isotropic(e, 0.3).plane_stress(0.0).expect("stable");
        let mut f = vec![0.0; 2 * elements.places.len()];
        for i in all.filter(|i| elements.places[*i as usize][0] == n as u32) {
            f[2 * i as usize] = if elements.places[i as usize][1] == 0 { 1.0 } else { -1.0 };
        }
        let mut system =
            PlateSystem::new(&elements, &|_| square(&c), &holds, &f, 1024.0, CancelFlag::default())
                .expect("held");
        let x = system.solve().expect("solved");
        let tip = x[2 * elements.places.iter().position(|p| *p == [n as u32, 0]).expect("tip") + 1];
        let length = n as f64 * h;
        let want = h * length * length / (2.0 * e * t * h * h * h / 12.0);
        assert!((tip.abs() / want - 1.0).abs() < 1e-3, "{tip} {want}");
    }

    #[test]
    fn stiffness_lost_later_is_the_same_as_from_the_start() {
        let elements = bar(30, 12, 0.5);
        let c = Orthotropic::isotropic(2000.0, 0.3).plane_stress(0.0).expect("stable");
        let (whole, soft) = (square(&c), square(&c.map(|r| r.map(|v| 0.01 * v))));
        let all = 0..elements.places.len() as u32;
        let left = all.clone().filter(|i| elements.places[*i as usize][0] == 0);
        let holds: Vec<GridHold> =
            left.flat_map(|node| [DVec2::X, DVec2::Y].map(|along| GridHold { node, along })).collect();
        let mut f = vec![0.0; 2 * elements.places.len()];
        all.filter(|i| elements.places[*i as usize][0] == 30).for_each(|i| f[2 * i as usize] = 1.0);
        let row = |e: usize| elements.cells[e] / 30;
        let column = |e: usize| elements.cells[e] % 30;
        let crack = |e: usize| row(e) < 5 && column(e) == 14;
        let spot = |e: usize| row(e) > 9 && column(e) > 20;
        let n = elements.cells.len();
        let direct = |e: usize| if crack(e) || spot(e) { soft } else { whole };
        let want = PlateSystem::new(&elements, &direct, &holds, &f, 1024.0, CancelFlag::default())
            .expect("held")
            .solve()
            .expect("solved");
        let longest = want.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // With room for all that fronts hand on, and with just enough for the factor.
        let least = (10..)
            .map(|k| f64::from(1u32 << k) / 1_048_576.0)
            .find(|b| PlateSystem::new(&elements, &|_| whole, &holds, &f, *b, CancelFlag::default()).is_ok());
        for max_mib in [1024.0, least.expect("some size is enough")] {
            let mut system =
                PlateSystem::new(&elements, &|_| whole, &holds, &f, max_mib, CancelFlag::default())
                    .expect("held");
            let intact = system.solve().expect("solved");
            (0..n).filter(|e| crack(*e)).for_each(|e| system.change(e, &soft));
            assert_ne!(system.solve().expect("solved"), intact);
            (0..n).filter(|e| spot(*e)).for_each(|e| system.change(e, &soft));
            let x = system.solve().expect("solved");
            assert!(x.iter().zip(&want).all(|(a, b)| (a - b).abs() < 1e-9 * longest), "{max_mib}");
            (0..n).for_each(|e| system.change(e, &whole));
            let x = system.solve().expect("solved");
            assert!(x.iter().zip(&intact).all(|(a, b)| a == b), "{max_mib}: the same bytes");
        }
    }
}
