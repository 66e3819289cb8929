//! How much of the material of a layer is joined across its beads: it has material on both sides, in its own layer or in one
//! beside it that rests on it.
//!
//! Method (own): beside each cell with material, the fill of the layer's cells is read at places on both sides of the beads
//! there, linear between the middles of cells. The emptiest place tells how much is joined. Directions are rounded to
//! [`AXES`] ones, since where the places of one direction lie between cells is the same for all cells. Lengths are in mm,
//! fills from 0 to 1. Cost: linear in the cells with material, eight places a cell and layer at most, about 15 ns a cell.

use std::cell::OnceCell;
use std::f64::consts::{PI, TAU};

use grainpath_core::DVec2;
use grainpath_core::math::{direction, tan};

use super::cell_grid::CellGrid;

/// Places on each side of a bead, in bead widths from it, of which the emptiest tells whether the bead is joined. Source:
/// derived. The middle of a cell may lie half a width off the bead's line; from there the first place still lies in a gap
/// of half a width, and the last reaches past the bead. The places furthest away come first, as they lie in gaps most often.
const BESIDE_WIDTHS: [f64; 4] = [1.0, 0.75, 0.5, 0.25];
/// A place beside a bead joins nothing when it is filled to less than this share, and all when filled to twice as much.
/// Source: derived. Cells as wide as a bead are half filled where its edge runs through their middle.
const GAP_FILL: f32 = 0.25;
/// Directions of a half turn to which beads are rounded when the places beside them are looked up. Source: derived. A direction
/// is off by 0.7 degrees at most, which moves a place one bead width away by a hundredth of that width.
const AXES: usize = 128;

/// Finds which of [`AXES`] directions a bead has, by its tangent: an arc tangent would take most of the time of a share.
struct AxisOf {
    /// Tangents of twice the directions halfway between neighbours, up to a quarter of a right angle.
    halfway: [f32; AXES / 8],
}

impl AxisOf {
    fn new() -> Self {
        let rad = |k: usize| (k as f64 + 0.5) * TAU / AXES as f64;
        Self { halfway: std::array::from_fn(|k| tan(rad(k)) as f32) }
    }

    /// The number of the direction nearest to half the angle of (`cos`, `sin`), whose length may be any.
    fn of(&self, [cos, sin]: [f32; 2]) -> usize {
        let (c, s) = (cos.abs(), sin.abs());
        let (less, more) = if s > c { (c, s) } else { (s, c) };
        let passed = self.halfway.iter().filter(|tangent| less > **tangent * more).count();
        // Mirrored from the octant to the quadrant, to the half turn and to the whole one.
        let quadrant = if s > c { AXES / 4 - passed } else { passed };
        let half = if cos < 0.0 { AXES / 2 - quadrant } else { quadrant };
        if sin < 0.0 { (AXES - half) % AXES } else { half }
    }
}

/// The material of a layer in one fan of a cell: thickness, and thickness times cosine and sine of twice the angle.
pub(super) struct Share {
    pub slot: u32,
    pub sum: [f32; 3],
}

/// What one layer has laid.
pub(super) struct LaidShares {
    pub height_mm: f64,
    /// Mean width of its beads, mm.
    pub width_mm: f64,
    pub shares: Vec<Share>,
}

/// A place between the middles of four cells: the lowest of them, from the cell that the place lies beside, and the share
/// of each, along x first.
#[derive(Clone, Copy)]
pub(super) struct Between {
    first: [isize; 2],
    shares: [f32; 4],
}

impl Between {
    /// The place that lies this far from the middle of a cell, in cells.
    fn new(off: DVec2) -> Self {
        let (low, part) = (off.floor(), (off - off.floor()).as_vec2());
        let (x, y) = ([1.0 - part.x, part.x], [1.0 - part.y, part.y]);
        // The lower row first, as a row of cells lies in memory.
        let shares = [x[0] * y[0], x[1] * y[0], x[0] * y[1], x[1] * y[1]];
        Self { first: low.to_array().map(|v| v as isize), shares }
    }

    /// What cells hold at this place beside the cell `i`, `j`, nothing outside the grid.
    #[inline]
    pub(super) fn read(&self, grid: &CellGrid, held: &[f32], [i, j]: [usize; 2]) -> f32 {
        let (i, j) = (i.wrapping_add_signed(self.first[0]), j.wrapping_add_signed(self.first[1]));
        let [a, b, c, d] = self.shares;
        // Nearly every place lies between four cells.
        if i < grid.nx - 1 && j < grid.ny - 1 {
            let at = j * grid.nx + i;
            let (low, high) = (&held[at..at + 2], &held[at + grid.nx..at + grid.nx + 2]);
            return a * low[0] + b * low[1] + (c * high[0] + d * high[1]);
        }
        // At the edge of the grid some of the four cells are missing.
        let value = |di: usize, dj: usize| {
            let (i, j) = (i.wrapping_add(di), j.wrapping_add(dj));
            if i < grid.nx && j < grid.ny { held[j * grid.nx + i] } else { 0.0 }
        };
        a * value(0, 0) + b * value(1, 0) + (c * value(0, 1) + d * value(1, 1))
    }
}

/// The two places at this distance on either side of a bead along `axis` through the middle of a cell.
pub(super) fn sides(grid: &CellGrid, axis: DVec2, off_mm: f64) -> impl Iterator<Item = Between> {
    let across = axis.perp() * (off_mm / grid.cell_mm);
    [-across, across].into_iter().map(Between::new)
}

/// For each cell whether all cells up to `reach` rows and columns away are filled at least to `least`; those closer to the edge
/// of the grid are not.
fn filled_around(grid: &CellGrid, filled: &[f32], reach: usize, least: f32) -> Vec<bool> {
    let (nx, ny) = (grid.nx, grid.ny);
    // Along the rows first, then across them.
    let mut along = vec![false; nx * ny];
    for (row, along) in filled.chunks_exact(nx).zip(along.chunks_exact_mut(nx)) {
        for i in reach..nx.saturating_sub(reach) {
            along[i] = row[i - reach..=i + reach].iter().all(|filled| *filled >= least);
        }
    }
    let mut all = vec![false; nx * ny];
    for j in reach..ny.saturating_sub(reach) {
        let of_row = &mut all[j * nx..(j + 1) * nx];
        of_row.copy_from_slice(&along[j * nx..(j + 1) * nx]);
        for near in (j - reach..=j + reach).filter(|near| *near != j) {
            of_row.iter_mut().zip(&along[near * nx..]).for_each(|(all, along)| *all &= along);
        }
    }
    all
}

/// The thickness of each share of a layer that has material on both sides of its beads, in its own layer or in one beside
/// it that rests on them, mm. `beside` are the layers below and above.
pub(super) fn joined_mm(
    grid: &CellGrid,
    n_fans: usize,
    layers: &[LaidShares],
    at: usize,
    beside: [Option<usize>; 2],
) -> Vec<f32> {
    // How full each cell of a layer is, 0 to 1.
    let filled = |k: usize| {
        let mut filled = vec![0f32; grid.nx * grid.ny];
        let height_mm = layers[k].height_mm as f32;
        layers[k].shares.iter().for_each(|s| filled[s.slot as usize / n_fans] += s.sum[0] / height_mm);
        filled
    };
    let own = filled(at);
    let width_mm = layers[at].width_mm;
    // Where no place beside a bead can lie in a gap, none is looked at: nearly everywhere in dense layers.
    let reach = (width_mm / grid.cell_mm).ceil() as usize;
    let is_dense = filled_around(grid, &own, reach, 2.0 * GAP_FILL);
    // The places beside beads of each direction of the layer.
    let places: [OnceCell<Vec<Between>>; AXES] = [const { OnceCell::new() }; AXES];
    let axis_of = AxisOf::new();
    let places_beside = |share: &Share| {
        let k = axis_of.of([share.sum[1], share.sum[2]]);
        places[k].get_or_init(|| {
            let axis = direction(k as f64 / AXES as f64 * PI);
            BESIDE_WIDTHS.into_iter().flat_map(|w| sides(grid, axis, w * width_mm)).collect()
        })
    };
    // The least fill of the places beside a bead; values up to `enough` are all the same.
    let least = |filled: &[f32], cell: [usize; 2], places: &[Between], enough: f32| {
        let mut least = filled[cell[1] * grid.nx + cell[0]];
        for place in places {
            if least <= enough {
                break;
            }
            least = least.min(place.read(grid, filled, cell));
        }
        least
    };
    // Layers beside this one are looked at where it is not joined by itself, which dense layers are.
    let beside: Vec<(usize, OnceCell<Vec<f32>>)> =
        beside.into_iter().flatten().map(|k| (k, OnceCell::new())).collect();
    let most = |share: &Share| {
        let cell = share.slot as usize / n_fans;
        if is_dense[cell] {
            return 1.0;
        }
        let cell = grid.place(cell);
        let places = places_beside(share);
        // Below the fill of a gap no value counts.
        let mut most = least(&own, cell, places, GAP_FILL).max(GAP_FILL);
        for (k, of_layer) in &beside {
            if most >= 2.0 * GAP_FILL {
                break;
            }
            most = most.max(least(of_layer.get_or_init(|| filled(*k)), cell, places, most));
        }
        most
    };
    // Between the two limits the share grows evenly, so that a plan that is moved a little keeps its strength.
    let joined = |share: &Share| share.sum[0] * (most(share) / GAP_FILL - 1.0).clamp(0.0, 1.0);
    layers[at].shares.iter().map(joined).collect()
}

#[cfg(test)]
mod tests {
    use grainpath_core::hash::splitmix64;
    use grainpath_core::math::atan2;

    use super::*;

    #[test]
    fn a_bead_gets_the_nearest_of_all_axes() {
        let axis_of = AxisOf::new();
        let mut seen = [false; AXES];
        for k in 0..20_000 {
            // Angles that lie no closer to the middle between two axes than `f32` can tell.
            let turns = (f64::from(k) + 0.37) / 20_000.0;
            let double = 3.7 * direction(turns * TAU);
            let expect = (atan2(double.y, double.x) / TAU * AXES as f64).round() as isize;
            let found = axis_of.of([double.x as f32, double.y as f32]);
            assert_eq!(found as isize, expect.rem_euclid(AXES as isize), "{turns} turns");
            seen[found] = true;
        }
        assert!(seen.iter().all(|seen| *seen));
    }

    #[test]
    fn a_cell_is_dense_where_all_cells_around_it_are_filled() {
        for (nx, ny) in [(17, 12), (4, 30), (3, 2)] {
            let grid = CellGrid { low: DVec2::ZERO, cell_mm: 0.4, nx, ny };
            // Nine of ten cells are filled.
            let filled: Vec<f32> = (0..nx * ny)
                .map(|k| if splitmix64(k as u64).is_multiple_of(10) { 0.2 } else { 0.9 })
                .collect();
            for reach in 0..3 {
                let found = filled_around(&grid, &filled, reach, 0.5);
                let expect = |cell: usize| {
                    let [i, j] = grid.place(cell);
                    let is_inside = i >= reach && j >= reach && i + reach < nx && j + reach < ny;
                    is_inside
                        && (j - reach..=j + reach)
                            .all(|j| (i - reach..=i + reach).all(|i| filled[j * nx + i] >= 0.5))
                };
                assert!((0..nx * ny).all(|cell| found[cell] == expect(cell)), "{nx} x {ny}, reach {reach}");
            }
        }
    }
}
