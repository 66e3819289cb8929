//! The strains of cells from which the first failure is told: those of a linear field that is fitted to the cells around each
//! cell.
//!
//! Method: moving least squares (`lancaster1981` in docs/references.bib). A field that is linear in x, y and z is fitted to the
//! strains of the cells within `REACH_MM`; each counts by how much material it holds and by `(1 - r2)^2` for a distance of `r`
//! over the reach. Its value in the middle of the cell is the strain of the cell. In a plate, which has one cell along z, each
//! material has a field of its own, since fibre and the matrix beside it strain differently. In a solid, failure in the layers
//! and between them has each a field of its own: for the second, a cell counts by its contact with the layer below. Cells beyond
//! a gap do not count: only those are taken that steps from cell to cell lead to, each nearer to the last.
//!
//! Why: a cell that holds little material, in the corner between walls or on a slanting border, deforms more than any bead can,
//! and in a notch the stress of the nearest cell grows without end as cells get smaller. Material fails where the stress over a
//! length of its own reaches its strength (`whitney1974`, `taylor2008`). A mean over that length would take the bending out of
//! thin walls; a linear field keeps it.
//!
//! Measured: on eight plates of the gallery with six sizes of cells from 0.2 to 0.6 mm the factor at first failure differs by 2
//! to 21 % from the least to the greatest; the strain of single cells gave 16 to 186 %, and factors 0.3 to 0.9 times as high. On
//! nine sparse solids with cells of 0.45, 0.6 and 0.9 mm it differs by 4 to 49 %; single cells gave 1 to 344 % (tables in
//! docs/validation.md). Dense beams and posts are told the same by both within 1 %.
//!
//! Lengths are in mm, strains in the order of the caller. Cost: 30 operations, and eight for each component of the strain, for
//! each cell within reach of another, 25 to 61 of them in a plate, about 30 in a solid. Limits: a cell without neighbours keeps
//! its own strain. Across a wall that is one cell thick no bending is seen ([`super::wall_bending`] tells it). A neck one cell
//! long and one cell wide between two bodies is told with the cells of both: at 2.2 times the load at which it fails by itself, at
//! 1.2 times where it is three cells wide, and alike from three by two cells on. Materials that fail
//! over a shorter length, as continuous fibre in shear, keep the strains of single cells
//! (`StrengthCard::fails_over_a_length`).
//!
//! The figure of the plate in [`super::plate_strength`] shows where such a plate begins to fail.

use rayon::prelude::*;

use grainpath_core::DVec3;
use grainpath_core::dense::solve_spd;

use super::bricks::Bricks;
use super::card::StrengthCard;

/// Distance at which cells no longer count, mm. Source: the distance over which a crack's stress has to reach the strength is
/// `E G / (pi strength^2)` (`taylor2008`), 0.8 mm across the beads and 1.2 mm along them with the PLA card; cells at half of this
/// reach count by 0.56. Measured: on the plates and cells above factors differ by 2 to 21 % with this reach and by 2 to 19 % with
/// 1.35 mm, so the shorter one is enough.
const REACH_MM: f64 = 0.9;
/// The least reach in cells. Measured: with 2, on cells of 0.45 mm, the field is fitted to nine cells and tells a hook 1.98 for 3.0;
/// with 3, cells of 0.45 mm tell what cells of 0.225 mm tell within 12 %.
const LEAST_REACH_CELLS: f64 = 3.0;
/// The same in the cells of a solid, of which 26 and more lie around each within this reach. Measured: on cells of 0.45 mm 3
/// instead of 2 tells eight sparse solids 0 to 6 % more and closely spaced graded stripes 4.5 instead of 3.5 times the load, and
/// takes twice as long.
const LEAST_REACH_BRICKS: f64 = 2.0;
/// The largest reach in cells, which bounds the cost for tiny cells. Source: chosen; cells are at least 0.1 mm wide in practice.
const MOST_REACH_CELLS: f64 = 9.0;
/// Weight that holds each slope of the field near zero, as a share of that of all cells. Source: derived; where all cells
/// lie in one line the slope across it would be free, and elsewhere this moves a slope by 0.1 % at most.
const RIDGE: f64 = 1e-5;

/// The first failure of a solid is not told from elements that hold less than this share of what the fullest element beside them
/// holds, nor that between layers from elements with less contact than this share. Measured: a bar of graded stripes whose peak is
/// 5.3 times the load was told to begin to fail at 0.9, 2.2 and 3.8 times the load on cells of 0.45, 0.6 and 0.9 mm, in cells that
/// are filled to 7 % and touch the layer below with 0.6 % of their area. With this share it is told 4.5, 5.3 and 5.7.
const LEAST_BESIDE: f64 = 0.5;

/// The upper half of a symmetric matrix of four rows. Source: derived.
const PAIRS: [[usize; 2]; 10] =
    [[0, 0], [0, 1], [0, 2], [0, 3], [1, 1], [1, 2], [1, 3], [2, 2], [2, 3], [3, 3]];

/// The cells of a part, x fastest, and which of them are its elements.
pub(super) struct ElementCells<'a> {
    /// ElementCells along x, y and z; a plate has one along z.
    pub n: [usize; 3],
    /// Edges of a cell, mm.
    pub cell_mm: DVec3,
    /// The element of each cell.
    pub element_of: &'a [Option<u32>],
    /// The cell of each element.
    pub cells: &'a [u32],
}

/// A cell near another one.
struct Near {
    /// Steps to it along x, y and z.
    step: [isize; 3],
    /// What a cell there counts, times 1 and times the distance along x, y and z over the reach.
    moments: [f64; 4],
    /// What it counts, times the products of two of these, in the order of `PAIRS`.
    products: [f64; 10],
    /// The cells, by their number in the list, that lie beside it and are nearer.
    inward: [Option<usize>; 3],
}

/// The cells near a cell, the nearest first; the first is the cell itself.
fn cells_near(n: [usize; 3], cell_mm: DVec3) -> Vec<Near> {
    let least_cells = if n[2] == 1 { LEAST_REACH_CELLS } else { LEAST_REACH_BRICKS };
    let reach_mm = REACH_MM.clamp(least_cells * cell_mm.x, MOST_REACH_CELLS * cell_mm.x);
    let most: [isize; 3] = std::array::from_fn(|k| match n[k] {
        1 => 0,
        _ => (reach_mm / cell_mm[k]).ceil() as isize,
    });
    let off = |step: [isize; 3]| DVec3::from_array(step.map(|s| s as f64)) * cell_mm / reach_mm;
    let along = |k: usize| -most[k]..=most[k];
    let mut steps: Vec<[isize; 3]> = along(2)
        .flat_map(|z| along(1).flat_map(move |y| along(0).map(move |x| [x, y, z])))
        .filter(|step| off(*step).length_squared() < 1.0)
        .collect();
    let square = |s: &[isize; 3]| off(*s).length_squared();
    steps.sort_by(|a, b| square(a).total_cmp(&square(b)).then(a.cmp(b)));
    let number = |s: [isize; 3]| steps.iter().position(|other| *other == s);
    let near = |s: &[isize; 3]| {
        let left = 1.0 - square(s);
        let DVec3 { x, y, z } = off(*s);
        let basis = [1.0, x, y, z];
        Near {
            step: *s,
            moments: basis.map(|b| left * left * b),
            products: PAIRS.map(|[p, q]| left * left * basis[p] * basis[q]),
            inward: std::array::from_fn(|k| {
                let mut nearer = *s;
                nearer[k] -= nearer[k].signum();
                (nearer != *s).then(|| number(nearer)).flatten()
            }),
        }
    };
    steps.iter().map(near).collect()
}

/// The fitted strain of every element that `is_asked`, zero for others. `amounts` tell how much material an element holds,
/// `strains` how it is strained.
pub(super) fn fitted_strains<const S: usize>(
    part: &ElementCells<'_>,
    amounts: &[f64],
    strains: &[[f64; S]],
    is_asked: &(dyn Fn(usize) -> bool + Sync),
) -> Vec<[f64; S]> {
    let n = part.n;
    let near = cells_near(n, part.cell_mm);
    let element_at = |place: [usize; 3], step: [isize; 3]| {
        let [x, y, z] = std::array::from_fn(|k| place[k].wrapping_add_signed(step[k]));
        (x < n[0] && y < n[1] && z < n[2]).then(|| part.element_of[(z * n[1] + y) * n[0] + x]).flatten()
    };
    let fitted = |reached: &mut Vec<bool>, (element, cell): (usize, &u32)| {
        if !is_asked(element) {
            return [0.0; S];
        }
        let cell = *cell as usize;
        let place = [cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]];
        reached.clear();
        let (mut sums, mut right) = ([0.0; 10], [[0.0; S]; 4]);
        for n in &near {
            let leads = n.step == [0; 3] || n.inward.into_iter().flatten().any(|k| reached[k]);
            let element = if leads { element_at(place, n.step) } else { None };
            reached.push(element.is_some());
            let Some(e) = element else { continue };
            let (amount, strain) = (amounts[e as usize], strains[e as usize]);
            sums.iter_mut().zip(n.products).for_each(|(sum, product)| *sum += amount * product);
            for (row, moment) in right.iter_mut().zip(n.moments) {
                row.iter_mut().zip(strain).for_each(|(sum, strain)| *sum += amount * moment * strain);
            }
        }
        let mut matrix = [[0.0; 4]; 4];
        for ([p, q], sum) in PAIRS.into_iter().zip(sums) {
            let ridge = if p == q && p > 0 { RIDGE * sums[0] } else { 0.0 };
            matrix[p][q] = sum + ridge;
            matrix[q][p] = matrix[p][q];
        }
        // Without any of the material around there is none in the cell either, and nothing asks for its strain.
        if sums[0] > 0.0 { solve_spd(matrix, right)[0] } else { [0.0; S] }
    };
    part.cells.par_iter().enumerate().map_init(Vec::new, fitted).collect()
}

/// The strains of every element of a solid from which the first failure in its layers and between them is told. Over a
/// length they are zero where nothing is asked, and in elements that hold little beside others: those are the edges of beads
/// whose middle lies there.
pub(super) fn judged_strains(
    bricks: &Bricks,
    card: &StrengthCard,
    part: &ElementCells<'_>,
    strains: &[[f64; 6]],
    is_asked: &(dyn Fn(usize) -> bool + Sync),
) -> Vec<[[f64; 6]; 2]> {
    let judged = |is_over_a_length: bool, amount: &(dyn Fn(usize) -> f64 + Sync)| {
        if !is_over_a_length {
            return strains.to_vec();
        }
        let amounts: Vec<f64> = part.cells.iter().map(|c| amount(*c as usize)).collect();
        let is_asked = |element: usize| {
            let beside = bricks.around(part.cells[element] as usize);
            let beside = beside.filter_map(|(_, c)| Some(amounts[part.element_of[c]? as usize]));
            is_asked(element) && amounts[element] >= LEAST_BESIDE * beside.fold(amounts[element], f64::max)
        };
        fitted_strains(part, &amounts, strains, &is_asked)
    };
    let filled = |c: usize| f64::from(bricks.filled[c]);
    let in_layers = judged(card.fails_over_a_length(), &filled);
    // Layers hold together where they touch, so contact is what counts between them.
    let touching = |c: usize| filled(c) * f64::from(bricks.bond[c]);
    let between = judged(card.layers_part_over_a_length(), &touching);
    in_layers.into_iter().zip(between).map(|(a, b)| [a, b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fitted strains of the cells of a solid, all of them full.
    fn fit_solid(
        n: [usize; 3],
        cell_mm: DVec3,
        strain: impl Fn([usize; 3]) -> [f64; 6],
    ) -> Vec<([usize; 3], [f64; 6])> {
        let count = n[0] * n[1] * n[2];
        let at = |c: usize| [c % n[0], c / n[0] % n[1], c / n[0] / n[1]];
        let cells: Vec<u32> = (0..count as u32).collect();
        let element_of: Vec<Option<u32>> = cells.iter().map(|c| Some(*c)).collect();
        let strains: Vec<[f64; 6]> = (0..count).map(|c| strain(at(c))).collect();
        let part = ElementCells { n, cell_mm, element_of: &element_of, cells: &cells };
        let fitted = fitted_strains(&part, &vec![1.0; count], &strains, &|_| true);
        fitted.into_iter().enumerate().map(|(c, found)| (at(c), found)).collect()
    }

    #[test]
    fn a_linear_field_of_a_solid_stays_up_to_its_faces() {
        // Bent about two axes and twisted, on cells that are lower than wide, and in a wall of two cells.
        for (n, cell_mm) in [
            ([9, 5, 6], DVec3::new(0.45, 0.45, 0.2)),
            ([8, 2, 5], DVec3::splat(0.9)),
            ([7, 6, 4], DVec3::splat(0.2)),
        ] {
            let strain = |[i, j, k]: [usize; 3]| {
                let [x, y, z] = [i, j, k].map(|v| v as f64 - 2.0);
                [1e-3 * z + 2e-4 * y, -3e-4 * z, 2e-4 * x, 1e-4 * z, 2e-4 * x, 4e-4]
            };
            for (at, found) in fit_solid(n, cell_mm, strain) {
                let want = strain(at);
                let off = (0..6).map(|k| (found[k] - want[k]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-5, "{cell_mm} {at:?}: {found:?} {want:?}");
            }
        }
    }

    #[test]
    fn a_single_cell_of_a_solid_counts_less_than_those_around_it() {
        let strain = |at: [usize; 3]| [if at == [4, 3, 0] { 0.02 } else { 1e-3 }; 6];
        let peak = |cell_mm: f64| {
            let fitted = fit_solid([9, 7, 7], DVec3::splat(cell_mm), strain);
            fitted.into_iter().map(|(_, found)| found[0]).fold(0.0, f64::max)
        };
        // On small cells one alone is a smaller piece of the part.
        assert!(peak(0.45) < 0.011 && peak(0.2) < 0.003, "{} {}", peak(0.45), peak(0.2));
    }

    /// The fitted strains of a grid whose cells are filled to `share`.
    fn fit(
        n: [usize; 2],
        cell_mm: f64,
        share: impl Fn(usize, usize) -> f64,
        strain: impl Fn(usize, usize) -> [f64; 3],
    ) -> Vec<Option<[f64; 3]>> {
        let of = |c: usize| share(c % n[0], c / n[0]);
        let cells: Vec<u32> = (0..n[0] * n[1]).filter(|c| of(*c) > 0.0).map(|c| c as u32).collect();
        let mut element_of = vec![None; n[0] * n[1]];
        cells.iter().enumerate().for_each(|(e, c)| element_of[*c as usize] = Some(e as u32));
        let amounts: Vec<f64> = cells.iter().map(|c| of(*c as usize)).collect();
        let strains: Vec<[f64; 3]> =
            cells.iter().map(|c| strain(*c as usize % n[0], *c as usize / n[0])).collect();
        let part = ElementCells {
            n: [n[0], n[1], 1],
            cell_mm: DVec3::splat(cell_mm),
            element_of: &element_of,
            cells: &cells,
        };
        let fitted = fitted_strains(&part, &amounts, &strains, &|_| true);
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
