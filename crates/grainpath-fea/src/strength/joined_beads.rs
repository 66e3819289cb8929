//! How much of the material of a layer is joined across its beads: it has material on both sides, in its own layer or in one
//! beside it that rests on it.
//!
//! Method (own): beside each cell with material, the fill of the layer's cells is read at places on both sides of the beads
//! there, linear between the middles of cells. The emptiest place tells how much is joined. Directions are rounded to
//! [`AXES`] ones, since where the places of one direction lie between cells is the same for all cells. Lengths are in mm,
//! fills from 0 to 1. Cost: linear in the cells with material, eight places a cell and layer at most, about 15 ns a cell.

use std::cell::OnceCell;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, direction};

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
    let is_dense = |[i, j]: [usize; 2]| {
        let is_inside = i >= reach && j >= reach && i + reach < grid.nx && j + reach < grid.ny;
        is_inside
            && (j - reach..=j + reach).all(|j| {
                let row = &own[j * grid.nx + i - reach..=j * grid.nx + i + reach];
                row.iter().all(|filled| *filled >= 2.0 * GAP_FILL)
            })
    };
    // The places beside beads of each direction of the layer.
    let places: [OnceCell<Vec<Between>>; AXES] = [const { OnceCell::new() }; AXES];
    let places_beside = |share: &Share| {
        let half_turns = 0.5 * atan2(f64::from(share.sum[2]), f64::from(share.sum[1])) / std::f64::consts::PI;
        // From -0.5 to 0.5; rounded without a call.
        let k = ((half_turns + 1.0) * AXES as f64 + 0.5) as usize % AXES;
        places[k].get_or_init(|| {
            let axis = direction(k as f64 / AXES as f64 * std::f64::consts::PI);
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
        let cell = grid.place(share.slot as usize / n_fans);
        if is_dense(cell) {
            return 1.0;
        }
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
