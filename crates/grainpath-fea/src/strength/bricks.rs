//! From beads to the box-shaped cells of a solid: how full each cell is, in which directions its beads run, and which
//! share of it rests on the layer below.
//!
//! A cell is one bead wide or a multiple of it, and as high as a whole number of layers, or as a whole fraction of one.
//! Each bead is spread as a ribbon, as for a laminate ([`super::laminate`]), and the material that falls into each cell
//! is added up. Of the directions in a cell, the two with most material are kept. The share that rests on the layer below
//! is found on cells of half the width; it scales the stiffness between layers.
//!
//! Lengths are in mm, angles in radians. Cost: linear in the cells that ribbons cover; at most [`MAX_BRICKS`] cells.

use std::collections::BTreeSet;

use grainpath_core::DVec3;
use grainpath_core::math::atan2;
use rayon::prelude::*;

use super::cell_grid::CellGrid;
use super::laminate::{BeadSheet, CellError, FANS, LayerCells, Repeated, grid_over, layer};

/// Beads of one direction in a brick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrickPly {
    /// Share of the brick's material.
    pub share: f64,
    /// Mean direction, radians from x, without sign.
    pub angle_rad: f64,
}

/// A part as box-shaped cells, x fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Bricks {
    /// Cells along x, y and z.
    pub n: [usize; 3],
    /// Lowest corner of the grid, mm.
    pub origin: DVec3,
    /// Edges of a cell, mm.
    pub cell_mm: DVec3,
    /// How full each cell is, 0 to 1.
    pub filled: Vec<f32>,
    /// Share of the layers' area in each cell that rests on the layer below, 0 to 1; 1 on the plate.
    pub bond: Vec<f32>,
    /// `plies[starts[cell]..starts[cell + 1]]` are those of a cell: none, one or two.
    pub starts: Vec<u32>,
    /// Plies, cell by cell; in each cell the one with more material comes first.
    pub plies: Vec<BrickPly>,
    /// Material in the cells, mm3.
    pub volume_mm3: f64,
    /// Material of the beads, mm3.
    pub laid_mm3: f64,
}

/// The largest number of cells of a part, empty ones included. Source: derived. Filling, bond and the place of
/// plies take 12 bytes a cell, 290 MB.
pub const MAX_BRICKS: usize = 24_000_000;
/// Number of bead directions in half a turn for which the library of a solid test holds a stiffness. Failure indices use the exact
/// direction. Source: derived. A direction is rounded by 2.8 degrees at most, which changes a modulus by less than a
/// twentieth of the difference between the moduli along and across the beads: 0.2 % for PLA.
pub(super) const DIRECTIONS: f64 = 32.0;
/// Number of steps to which the library rounds the share of a second ply, and the bond. Source: derived. A share is
/// rounded by a sixteenth at most; that shifts a modulus by a sixteenth of the difference between along and across.
pub(super) const SHARE_STEPS: f64 = 8.0;
/// A second direction with less than this share of a brick is added to the first. Source: derived. Shares are rounded to
/// eighths (`SHARE_STEPS`), and a smaller one would count as an eighth.
const LEAST_SHARE: f64 = 0.12;

impl Bricks {
    /// Makes cells of this width from beads. A cell is as high as the whole number of layers, or the whole fraction of a
    /// layer, that comes nearest to the width. The first layer begins at `floor_mm`.
    ///
    /// # Errors
    /// [`CellError`] when there is no bead or there are too many cells.
    pub fn from_layers(sheets: &[BeadSheet], cell_mm: f64, floor_mm: f64) -> Result<Self, CellError> {
        Self::moved(sheets, cell_mm, 0.0, floor_mm)
    }

    /// [`Bricks::from_layers`] on a grid that is moved by a share of a cell, 0 to 1, along x and y.
    ///
    /// # Errors
    /// As [`Bricks::from_layers`].
    pub fn moved(sheets: &[BeadSheet], cell_mm: f64, moved: f64, floor_mm: f64) -> Result<Self, CellError> {
        let Repeated { layers, of_layer } = Repeated::new(sheets);
        let (grid, laid_mm3) = grid_over(&layers, cell_mm, moved)?;
        let tall: f64 = sheets.iter().map(|s| s.height_mm).sum();
        let mut heights: Vec<f64> = sheets.iter().map(|s| s.height_mm).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let usual = heights[heights.len() / 2];
        // Either a whole number of layers makes a brick, or a whole number of bricks makes a layer.
        let per = if cell_mm < usual { 1.0 / (usual / cell_mm).round() } else { (cell_mm / usual).round() };
        let nz = (tall / (per * usual)).round().max(1.0) as usize;
        let n = [grid.nx, grid.ny, nz];
        let all = grid.nx as f64 * grid.ny as f64 * nz as f64;
        if all > MAX_BRICKS as f64 {
            let (nx, ny) = (grid.nx as f64, grid.ny as f64 * nz as f64);
            return Err(CellError::TooMany { nx, ny, cell_mm, most: MAX_BRICKS });
        }
        let high = tall / nz as f64;
        // The bond is found on cells of half the width, because a cell may rest on the layer below in part.
        let fine = CellGrid { cell_mm: 0.5 * cell_mm, nx: 2 * grid.nx, ny: 2 * grid.ny, ..grid };
        let mut bricks = Self {
            n,
            origin: grid.low.extend(floor_mm),
            cell_mm: DVec3::new(cell_mm, cell_mm, high),
            filled: Vec::with_capacity(all as usize),
            bond: Vec::with_capacity(all as usize),
            starts: vec![0],
            plies: Vec::new(),
            volume_mm3: 0.0,
            laid_mm3,
        };
        let mut slab = Slab::new(&grid);
        let mut below = vec![0f32; fine.nx * fine.ny];
        let (mut z, mut at) = (0.0, 0);
        // Layers are processed in parallel, a few at a time to bound the memory.
        for (some, indices) in sheets.chunks(32).zip(of_layer.chunks(32)) {
            // Copies within these few layers are made into cells once.
            let distinct: Vec<usize> = BTreeSet::from_iter(indices).into_iter().copied().collect();
            let laid = |cells: &mut LayerCells, k: &usize| layer(&fine, FANS, &layers[*k], cells);
            let laid: Vec<_> = distinct.par_iter().map_init(LayerCells::default, laid).collect();
            for (sheet, index) in some.iter().zip(indices) {
                let shares = &laid[distinct.partition_point(|k| k < index)];
                let (from, to) = (z, z + sheet.height_mm);
                z = to;
                let mut own = vec![0f32; below.len()];
                for share in shares {
                    own[share.slot as usize / FANS] += share.sum[0] / sheet.height_mm as f32;
                }
                let ground = from < 1e-6;
                while at < nz {
                    let (low, top) = (at as f64 * high, (at + 1) as f64 * high);
                    let part = (to.min(top) - from.max(low)).max(0.0);
                    if part > 1e-9 {
                        // The contact of a layer with the one below counts in the brick in which the layer begins.
                        let foot = (from >= low - 1e-9 && !ground).then_some(&below);
                        slab.add(shares, part / sheet.height_mm, &own, foot, &fine);
                    }
                    if to < top - 1e-9 {
                        break;
                    }
                    bricks.push(&mut slab);
                    at += 1;
                }
                below = own;
            }
        }
        while at < nz {
            bricks.push(&mut slab);
            at += 1;
        }
        Ok(bricks)
    }

    fn push(&mut self, slab: &mut Slab) {
        let area = self.cell_mm.x * self.cell_mm.y;
        for (fans, bond) in slab.fans.chunks_exact(FANS).zip(&slab.bond) {
            let thickness: f64 = fans.iter().map(|f| f64::from(f[0])).sum();
            self.volume_mm3 += thickness * area;
            self.filled.push((thickness / self.cell_mm.z).min(1.0) as f32);
            self.bond.push(if bond[1] > 0.0 { (bond[0] / bond[1]).min(1.0) } else { 1.0 });
            self.plies.extend(plies(fans).into_iter().flatten());
            self.starts.push(self.plies.len() as u32);
        }
        slab.clear();
    }

    /// The plies of a cell.
    pub(crate) fn plies_in(&self, cell: usize) -> &[BrickPly] {
        &self.plies[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The middle of a cell, mm.
    pub fn centre(&self, cell: usize) -> DVec3 {
        let [nx, ny, _] = self.n;
        let at = DVec3::new((cell % nx) as f64, (cell / nx % ny) as f64, (cell / nx / ny) as f64);
        self.origin + self.cell_mm * (at + 0.5)
    }

    /// The 26 cells around a cell and the vectors to them, mm.
    pub(super) fn around(&self, cell: usize) -> impl Iterator<Item = (DVec3, usize)> {
        let n = self.n;
        let at = [cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]];
        (0..27usize).filter(|k| *k != 13).filter_map(move |k| {
            let step = [k % 3, k / 3 % 3, k / 9];
            let to: [usize; 3] = std::array::from_fn(|i| (at[i] + step[i]).wrapping_sub(1));
            let off = DVec3::from_array(step.map(|s| s as f64 - 1.0)) * self.cell_mm;
            (0..3).all(|i| to[i] < n[i]).then(|| (off, (to[2] * n[1] + to[1]) * n[0] + to[0]))
        })
    }

    /// Difference between the volume of the cells and that of the beads, as a share of the latter.
    pub fn volume_error(&self) -> f64 {
        (self.volume_mm3 / self.laid_mm3 - 1.0).abs()
    }
}

/// All bricks at one height, while they are filled.
struct Slab {
    nx: usize,
    fans: Vec<[f32; 3]>,
    /// The area that rests on the layer below, and the area of all material that could rest on it.
    bond: Vec<[f32; 2]>,
}

impl Slab {
    fn new(grid: &CellGrid) -> Self {
        let n = grid.nx * grid.ny;
        Self { nx: grid.nx, fans: vec![[0.0; 3]; n * FANS], bond: vec![[0.0; 2]; n] }
    }

    fn clear(&mut self) {
        self.fans.fill([0.0; 3]);
        self.bond.fill([0.0; 2]);
    }

    /// Adds a part of a layer, and its contact with the layer `below` if that is given.
    fn add(
        &mut self,
        shares: &[super::joined_beads::Share],
        part: f64,
        own: &[f32],
        below: Option<&Vec<f32>>,
        fine: &CellGrid,
    ) {
        let (part, nx) = (part as f32, self.nx);
        let coarse_cell = |i: usize| coarse(i, fine.nx, nx);
        for share in shares {
            let (cell, fan) = (coarse_cell(share.slot as usize / FANS), share.slot as usize % FANS);
            let sum = &mut self.fans[cell * FANS + fan];
            // The finer cells have a quarter of the area.
            (0..3).for_each(|k| sum[k] += 0.25 * part * share.sum[k]);
        }
        let Some(below) = below else { return };
        for (i, own) in own.iter().enumerate().filter(|(_, own)| **own > 0.0) {
            let bond = &mut self.bond[coarse_cell(i)];
            bond[0] += own.min(below[i]);
            bond[1] += own;
        }
    }
}

/// The cell to which a cell of half the width belongs.
fn coarse(i: usize, fine_nx: usize, nx: usize) -> usize {
    i / fine_nx / 2 * nx + i % fine_nx / 2
}

/// The two directions of a brick with most material; the other material is shared out between them.
fn plies(fans: &[[f32; 3]]) -> [Option<BrickPly>; 2] {
    let total: f64 = fans.iter().map(|f| f64::from(f[0])).sum();
    if total <= 0.0 {
        return [None; 2];
    }
    // Where beads turn, one direction spreads over neighbouring fans. They are counted with the fullest fan.
    let n = fans.len();
    let wide = |k: usize| fans[k][0];
    let first = (0..n).fold(0, |best, k| if wide(k) > wide(best) { k } else { best });
    let near = |k: usize| (k + n - first) % n;
    let of_first = |k: usize| matches!(near(k), 0 | 1) || near(k) == n - 1;
    let angle = |each: &dyn Fn(usize) -> bool| {
        let (mut c, mut s, mut t) = (0.0, 0.0, 0.0);
        for k in (0..n).filter(|k| each(*k)) {
            t += f64::from(fans[k][0]);
            c += f64::from(fans[k][1]);
            s += f64::from(fans[k][2]);
        }
        (t, 0.5 * atan2(s, c))
    };
    let (t1, a1) = angle(&of_first);
    let second = (0..n).filter(|k| !of_first(*k));
    let second = second.fold(None, |best: Option<usize>, k| match best {
        Some(b) if wide(k) <= wide(b) => best,
        _ => (wide(k) > 0.0).then_some(k),
    });
    let (t2, a2) = second.map_or((0.0, 0.0), |k| angle(&|j| j == k));
    let share = t2 / (t1 + t2);
    if share < LEAST_SHARE {
        return [Some(BrickPly { share: 1.0, angle_rad: a1 }), None];
    }
    let two = [BrickPly { share: 1.0 - share, angle_rad: a1 }, BrickPly { share, angle_rad: a2 }].map(Some);
    if share > 0.5 { [two[1], two[0]] } else { two }
}
