//! The strains of a plate's cells from which its first failure is told: those of a linear field that is fitted to the cells
//! around each cell.
//!
//! Method: moving least squares (`lancaster1981` in docs/references.bib). A field that is linear in x and y is fitted to the
//! strains of the cells within `REACH_MM`; each counts by how much material it holds and by `(1 - r2)^2` for a distance of `r`
//! over the reach. Its value in the middle of the cell is the strain of the cell. Each material has a field of its own, since
//! fibre and the matrix beside it strain differently. Cells beyond a gap do not count: only those are taken that steps from cell
//! to cell lead to, each nearer to the last.
//!
//! Why: a cell that holds little material, in the corner between walls or on a slanting border, deforms more than any bead can,
//! and in a notch the stress of the nearest cell grows without end as cells get smaller. Material fails where the stress over a
//! length of its own reaches its strength (`whitney1974`, `taylor2008`). A mean over that length would take the bending out of
//! thin walls; a linear field keeps it.
//!
//! Measured: on eight plates of the gallery with six sizes of cells from 0.2 to 0.6 mm the factor at first failure differs by 2 to
//! 21 % from the least to the greatest (table in docs/validation.md); the strain of single cells gave 16 to 186 %, and
//! factors 0.3 to 0.9 times as high.
//!
//! Lengths are in mm, strains in the order xx, yy and the doubled xy. Cost: about 20 operations for each cell within reach of
//! another, 25 to 61 of them. Limits: a cell without neighbours keeps its own strain. Across a wall that is one cell thick no
//! bending is seen ([`super::wall_bending`] tells it). Materials that fail over a shorter length, as continuous fibre in shear,
//! keep the strains of single cells (`StrengthCard::fails_over_a_length`).
//!
//! The figure of the plate in [`super::plate_strength`] shows where such a plate begins to fail.

use rayon::prelude::*;

use grainpath_core::dense::solve_spd;

use super::cell_grid::CellGrid;

/// Distance at which cells no longer count, mm. Source: the distance over which a crack's stress has to reach the strength is
/// `E G / (pi strength^2)` (`taylor2008`), 0.8 mm across the beads and 1.2 mm along them with the PLA card; cells at half of this
/// reach count by 0.56. Measured: on the plates and cells above factors differ by 2 to 21 % with this reach and by 2 to 19 % with
/// 1.35 mm, so the shorter one is enough.
const REACH_MM: f64 = 0.9;
/// The least reach in cells. Measured: with 2, on cells of 0.45 mm, the field is fitted to nine cells and tells a hook 1.98 for 3.0;
/// with 3, cells of 0.45 mm tell what cells of 0.225 mm tell within 12 %.
const LEAST_REACH_CELLS: f64 = 3.0;
/// The largest reach in cells, which bounds the cost for tiny cells. Source: chosen; cells are at least 0.1 mm wide in practice.
const MOST_REACH_CELLS: f64 = 9.0;
/// Weight that holds each slope of the field near zero, as a share of that of all cells. Source: derived; where all cells
/// lie in one line the slope across it would be free, and elsewhere this moves a slope by 0.1 % at most.
const RIDGE: f64 = 1e-5;

/// The upper half of a symmetric matrix of three rows.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

/// A cell near another one.
struct Near {
    /// Steps to it along x and y.
    step: [isize; 2],
    /// What a cell there counts, times 1 and times the distance along x and y over the reach.
    moments: [f64; 3],
    /// What it counts, times the products of two of these, in the order of `PAIRS`.
    products: [f64; 6],
    /// The cells, by their number in the list, that lie beside it and are nearer.
    inward: [Option<usize>; 2],
}

/// The cells near a cell in a grid of this size, the nearest first; the first is the cell itself.
fn cells_near(cell_mm: f64) -> Vec<Near> {
    let reach = (REACH_MM / cell_mm).clamp(LEAST_REACH_CELLS, MOST_REACH_CELLS);
    let most = reach.ceil() as isize;
    let square = |[x, y]: [isize; 2]| x * x + y * y;
    let mut steps: Vec<[isize; 2]> =
        (-most..=most).flat_map(|y| (-most..=most).map(move |x| [x, y])).collect();
    steps.retain(|s| (square(*s) as f64) < reach * reach);
    steps.sort_by_key(|s| (square(*s), *s));
    let number = |s: [isize; 2]| steps.iter().position(|other| *other == s);
    let near = |s: &[isize; 2]| {
        let [x, y] = *s;
        let left = 1.0 - square(*s) as f64 / (reach * reach);
        let basis = [1.0, x as f64 / reach, y as f64 / reach];
        Near {
            step: *s,
            moments: basis.map(|b| left * left * b),
            products: PAIRS.map(|[p, q]| left * left * basis[p] * basis[q]),
            inward: [
                (x != 0).then(|| number([x - x.signum(), y])).flatten(),
                (y != 0).then(|| number([x, y - y.signum()])).flatten(),
            ],
        }
    };
    steps.iter().map(near).collect()
}

/// The fitted strain of every element. `element_of` gives the element of each cell, `cells` the cell of each element; `amounts`
/// tell how much material an element holds, `strains` how it is strained.
pub(super) fn fitted_strains(
    grid: &CellGrid,
    element_of: &[Option<u32>],
    cells: &[u32],
    amounts: &[f64],
    strains: &[[f64; 3]],
) -> Vec<[f64; 3]> {
    let near = cells_near(grid.cell_mm);
    let element_at = |[i, j]: [usize; 2], [x, y]: [isize; 2]| {
        let (i, j) = (i.checked_add_signed(x)?, j.checked_add_signed(y)?);
        if i < grid.nx && j < grid.ny { element_of[j * grid.nx + i] } else { None }
    };
    let fitted = |reached: &mut Vec<bool>, cell: &u32| {
        let place = grid.place(*cell as usize);
        reached.clear();
        let (mut sums, mut right) = ([0.0; 6], [[0.0; 3]; 3]);
        for n in &near {
            let leads = n.step == [0, 0] || n.inward.into_iter().flatten().any(|k| reached[k]);
            let element = if leads { element_at(place, n.step) } else { None };
            reached.push(element.is_some());
            let Some(e) = element else { continue };
            let (amount, strain) = (amounts[e as usize], strains[e as usize]);
            sums.iter_mut().zip(n.products).for_each(|(sum, product)| *sum += amount * product);
            for (row, moment) in right.iter_mut().zip(n.moments) {
                row.iter_mut().zip(strain).for_each(|(sum, strain)| *sum += amount * moment * strain);
            }
        }
        let mut matrix = [[0.0; 3]; 3];
        for ([p, q], sum) in PAIRS.into_iter().zip(sums) {
            let ridge = if p == q && p > 0 { RIDGE * sums[0] } else { 0.0 };
            matrix[p][q] = sum + ridge;
            matrix[q][p] = matrix[p][q];
        }
        // Without any of the material around there is none in the cell either, and nothing asks for its strain.
        if sums[0] > 0.0 { solve_spd(matrix, right)[0] } else { [0.0; 3] }
    };
    cells.par_iter().map_init(Vec::new, fitted).collect()
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec2;

    use super::*;

    /// The fitted strains of a grid whose cells are filled to `share`.
    fn fit(
        n: [usize; 2],
        cell_mm: f64,
        share: impl Fn(usize, usize) -> f64,
        strain: impl Fn(usize, usize) -> [f64; 3],
    ) -> Vec<Option<[f64; 3]>> {
        let grid = CellGrid { low: DVec2::ZERO, cell_mm, nx: n[0], ny: n[1] };
        let of = |c: usize| share(c % n[0], c / n[0]);
        let cells: Vec<u32> = (0..n[0] * n[1]).filter(|c| of(*c) > 0.0).map(|c| c as u32).collect();
        let mut element_of = vec![None; n[0] * n[1]];
        cells.iter().enumerate().for_each(|(e, c)| element_of[*c as usize] = Some(e as u32));
        let amounts: Vec<f64> = cells.iter().map(|c| of(*c as usize)).collect();
        let strains: Vec<[f64; 3]> =
            cells.iter().map(|c| strain(*c as usize % n[0], *c as usize / n[0])).collect();
        let fitted = fitted_strains(&grid, &element_of, &cells, &amounts, &strains);
        element_of.iter().map(|e| e.map(|e| fitted[e as usize])).collect()
    }

    #[test]
    fn a_linear_field_stays_up_to_the_border() {
        // A wall of four cells that bends, and one that is pulled and sheared besides.
        for (cell_mm, across) in [(0.1, 4), (0.225, 4), (0.45, 3), (0.9, 6)] {
            let strain = |i: usize, j: usize| {
                [1e-3 * (j as f64 - 1.5) + 2e-4, -3e-4 * (j as f64 - 1.5), 1e-4 * i as f64]
            };
            let found = fit([20, across], cell_mm, |_, _| 1.0, strain);
            for (c, found) in found.iter().enumerate() {
                let want = strain(c % 20, c / 20);
                let off = (0..3).map(|k| (found.expect("a cell")[k] - want[k]).abs()).fold(0.0, f64::max);
                assert!(off < 3e-6, "{cell_mm} {c}: {found:?} {want:?}");
            }
        }
    }

    #[test]
    fn a_cell_with_little_material_has_the_strain_of_those_beside_it() {
        let is_sliver = |i: usize, j: usize| (i, j) == (5, 0);
        let share = |i: usize, j: usize| if is_sliver(i, j) { 0.05 } else { 1.0 };
        let strain =
            |i: usize, j: usize| if is_sliver(i, j) { [0.02, -0.01, 0.03] } else { [1e-3, 0.0, 0.0] };
        let found = fit([11, 6], 0.225, share, strain);
        let sliver = found[5].expect("a cell");
        assert!((sliver[0] / 1e-3 - 1.0).abs() < 0.7, "{sliver:?}");
        // A full cell is a part of the piece, and what it has is seen.
        let full = fit([11, 6], 0.225, |_, _| 1.0, strain)[5].expect("a cell");
        assert!(full[0] > 4e-3, "{full:?}");
    }

    #[test]
    fn cells_beyond_a_gap_do_not_count() {
        // Two strips with an empty row between them.
        let share = |_, j: usize| if j == 3 { 0.0 } else { 1.0 };
        let strain = |_, j: usize| if j < 3 { [1e-3, 0.0, 0.0] } else { [-1e-3, 0.0, 0.0] };
        for (c, found) in fit([12, 7], 0.225, share, strain).iter().enumerate() {
            let Some(found) = found else { continue };
            let want = strain(c % 12, c / 12);
            assert!((found[0] - want[0]).abs() < 1e-12, "{c}: {found:?}");
        }
    }

    #[test]
    fn a_cell_by_itself_keeps_its_strain() {
        let strain = [1e-3, -2e-3, 5e-4];
        let found =
            fit([3, 3], 0.3, |i, j| f64::from(u8::from((i, j) == (1, 1))), |_, _| strain)[4].expect("a cell");
        assert!((0..3).all(|k| (found[k] - strain[k]).abs() < 1e-12), "{found:?}");
    }
}
