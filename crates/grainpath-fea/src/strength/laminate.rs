//! From beads to a laminate: how much material each cell of a grid holds, and in which directions its beads run.
//!
//! Each bead is a ribbon whose width is the bead's volume divided by its length and the layer's height. The area of a
//! cell that a ribbon covers, times the height, is the material that it adds to the cell. Directions are sorted into
//! eight fans of 22.5 degrees; within a fan the mean axis is found from the double angle, whose sum does not depend on
//! the sign of an axis. The plies of all layers are added up, one for each fan and material.
//!
//! Adding up layers joins beads that never touch: lines that move from layer to layer fill the cells between them, as
//! seen from above, with nothing across in any layer. So each ply tells how much of it is joined ([`Ply::joined`]): the
//! share with material on both sides in its own layer or in one beside it, where the cells there are filled at all. Across
//! its beads a ply carries by that share. Lines that stand still have empty cells beside them and need no such share.
//! Measured by `cargo xtask bench gains stiffness`: the bent bar of graded `grid` is 6 % stiffer than the solid of cells
//! of a bead, and 15 % without the share.
//!
//! Real beads overlap at turns and at walls. A cell that would hold more than the layer's height gives the rest to its
//! neighbours, as melt does that is pressed aside. Lengths are in mm, angles in radians. Cost: linear in the cells that
//! ribbons cover, once for all layers with the same beads (`Repeated`).

use std::collections::{BTreeMap, HashMap};

use grainpath_core::DVec2;
use grainpath_core::hash::splitmix64;
use grainpath_core::math::{atan2, cross, direction};
use grainpath_core::segment;
use grainpath_core::tuned::Tuned;
use rayon::prelude::*;

use super::cell_grid::{AROUND, CellGrid};
use super::joined_beads::{LaidShares, Share, joined_mm, sides};

/// A straight piece of bead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeadPiece {
    /// Its first end, mm.
    pub a: DVec2,
    /// Its second end, mm.
    pub b: DVec2,
    /// Its volume, mm3.
    pub volume_mm3: f64,
    /// Its material: the number of its card.
    pub material: u8,
}

/// The beads of one layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BeadSheet {
    /// Thickness, mm.
    pub height_mm: f64,
    /// Its beads.
    pub beads: Vec<BeadPiece>,
}

/// The layers of a part, those with the same beads once.
///
/// Most layers of a plate are copies of a few, whatever the order and the direction in which their paths are laid. Volumes
/// of copies differ by the rounding of the program, so each piece has the mean of its copies.
pub(super) struct Repeated {
    /// The layers that differ, in the order of their first copy.
    pub layers: Vec<DistinctLayer>,
    /// For each layer of the part the index of the one that it is a copy of.
    pub of_layer: Vec<usize>,
}

/// A layer that other layers are copies of.
pub(super) struct DistinctLayer {
    height_mm: f64,
    /// Its paths, sorted by their ends. Open ones begin at the end with the lower coordinates, closed ones at their lowest
    /// corner: each layer may begin a loop somewhere else.
    paths: Vec<Vec<BeadPiece>>,
    /// The number of layers that have these beads.
    copies: f64,
}

/// Heights of layers that round to the same multiple of this are equal, mm. Source: derived. A height is the difference of two
/// heights above the plate, which rounding moves by 1e-13; programs are written to 1e-3.
const SAME_HEIGHT_MM: f64 = 1e-6;

/// A piece no longer than this counts for nothing, and paths go on across it, mm. Source: derived. Programs are written to
/// 1e-3 mm, and what is extruded along such a piece is rounded to nothing in one copy of a layer and to something in another.
const ROUNDED_MM: f64 = 2e-3;

impl Repeated {
    pub(super) fn new(sheets: &[BeadSheet]) -> Self {
        // Sorting each layer by itself is most of the work, and it makes copies in another order equal.
        let sorted: Vec<DistinctLayer> = sheets.par_iter().map(DistinctLayer::new).collect();
        let mut layers: Vec<DistinctLayer> = Vec::new();
        let mut seen: HashMap<u64, Vec<usize>> = HashMap::new();
        let of_layer = sorted.into_iter().map(|layer| {
            // Equal hashes are no proof, so the places are compared too.
            let alike = seen.entry(layer.hash()).or_default();
            if let Some(&at) = alike.iter().find(|k| layers[**k].places().eq(layer.places())) {
                let sums = layers[at].paths.iter_mut().flatten().zip(layer.paths.iter().flatten());
                sums.for_each(|(sum, copy)| sum.volume_mm3 += copy.volume_mm3);
                layers[at].copies += 1.0;
                at
            } else {
                alike.push(layers.len());
                layers.push(layer);
                layers.len() - 1
            }
        });
        let of_layer = of_layer.collect();
        // Sums become means.
        for DistinctLayer { paths, copies, .. } in &mut layers {
            paths.iter_mut().flatten().for_each(|b| b.volume_mm3 /= *copies);
        }
        Self { layers, of_layer }
    }
}

impl DistinctLayer {
    /// The paths of a layer. A piece that begins where the one before it ended continues the same path; pieces without
    /// length or volume are left out.
    fn new(sheet: &BeadSheet) -> Self {
        let is_usable = |b: &&BeadPiece| {
            let is_long = b.a.distance(b.b) > ROUNDED_MM;
            b.a.is_finite() && b.b.is_finite() && is_long && b.volume_mm3 > 0.0 && sheet.height_mm > 0.0
        };
        let mut beads: Vec<BeadPiece> = sheet.beads.iter().filter(is_usable).copied().collect();
        // What is left out leaves no gap: the path goes on from where it was.
        for k in 1..beads.len() {
            let end = beads[k - 1].b;
            if beads[k].a.distance(end) <= ROUNDED_MM {
                beads[k].a = end;
            }
        }
        beads.retain(|b| b.a != b.b);
        let paths = beads.chunk_by(|p, q| p.b == q.a && p.material == q.material);
        let mut paths: Vec<Vec<BeadPiece>> = paths.map(<[_]>::to_vec).collect();
        let order = |p: DVec2, q: DVec2| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y));
        for path in &mut paths {
            let n = path.len();
            let is_closed = n > 2 && path[0].a == path[n - 1].b;
            if is_closed {
                let lowest = (0..n).min_by(|p, q| order(path[*p].a, path[*q].a)).unwrap_or_default();
                path.rotate_left(lowest);
            }
            let [begin, end] =
                if is_closed { [path[0].b, path[n - 1].a] } else { [path[0].a, path[n - 1].b] };
            if order(begin, end).is_gt() {
                path.reverse();
                path.iter_mut().for_each(|piece| std::mem::swap(&mut piece.a, &mut piece.b));
            }
        }
        paths.sort_by(|p, q| {
            let [(p0, p1), (q0, q1)] = [p, q].map(|path| (path[0], path[path.len() - 1]));
            order(p0.a, q0.a)
                .then(order(p0.b, q0.b))
                .then(order(p1.b, q1.b))
                .then((p0.material, p.len()).cmp(&(q0.material, q.len())))
        });
        Self { height_mm: sheet.height_mm, paths, copies: 1.0 }
    }

    /// What copies have in common: the height, and the material, length and places of each path.
    fn places(&self) -> impl Iterator<Item = [u64; 2]> {
        fn bits(p: DVec2) -> [u64; 2] {
            p.to_array().map(f64::to_bits)
        }
        fn of_path(path: &[BeadPiece]) -> impl Iterator<Item = [u64; 2]> {
            let begin = [[path.len() as u64, u64::from(path[0].material)], bits(path[0].a)];
            begin.into_iter().chain(path.iter().map(|b| bits(b.b)))
        }
        let height = (self.height_mm / SAME_HEIGHT_MM).round() as u64;
        std::iter::once([height, 0]).chain(self.paths.iter().flat_map(|path| of_path(path)))
    }

    fn hash(&self) -> u64 {
        self.places().flatten().fold(0, |hash, word| splitmix64(hash ^ word))
    }
}

/// A piece of the ribbon that a path lays.
struct Ribbon {
    /// Its corners, mm, counter-clockwise: right of its beginning, right of its end, left of its end, left of its
    /// beginning.
    corners: [DVec2; 4],
    /// Unit vector along it.
    along: DVec2,
    volume_mm3: f64,
    /// Its area, mm2.
    area_mm2: f64,
    material: u8,
}

/// The largest width of a bead, mm. A piece with more volume for its length is a blob, laid while the nozzle hardly moved;
/// it is treated as higher instead of wider. Source: derived. A nozzle of 2 mm lays beads of up to 4 mm, which leaves a
/// margin of 2.5.
pub const MAX_BEAD_WIDTH_MM: f64 = 10.0;
/// A piece of a path that is too short for the turns at its ends is merged with a neighbour only if the point between them
/// lies at most this far, in bead widths, from the line that joins their ends. Measured: row
/// `fea.strength.laminate.WIGGLE` of `cargo xtask bench constants`.
static WIGGLE: Tuned<f64> = Tuned::new("fea.strength.laminate.WIGGLE", 0.1);
/// Tangent of half the sharpest turn whose outer corner is filled; the tip of that corner is one bead width from the path.
/// Source: derived. The tip lies half a width over the cosine of half the turn away, which is one width when half the turn
/// is 60 degrees.
const MAX_HALF_TURN_TANGENT: f64 = 1.732;

/// The ribbons of a layer.
fn ribbons(layer: &DistinctLayer) -> impl Iterator<Item = Ribbon> {
    layer.paths.iter().flat_map(|path| ribbon(&without_wiggles(path, layer.height_mm), layer.height_mm))
}

fn width(b: &BeadPiece, height_mm: f64) -> f64 {
    (b.volume_mm3 / (b.a.distance(b.b) * height_mm)).min(MAX_BEAD_WIDTH_MM)
}

/// A path without wiggles that are finer than the bead. A piece too short for the turns at its ends is merged with that
/// neighbour whose direction differs less.
fn without_wiggles(path: &[BeadPiece], height_mm: f64) -> Vec<BeadPiece> {
    let mut out: Vec<BeadPiece> = Vec::with_capacity(path.len());
    for piece in path {
        out.push(*piece);
        while let [.., before, short, after] = &out[..] {
            let [u, d, v] = [before, short, after].map(|p| (p.b - p.a).normalize());
            let (at_a, at_b) = (turn(u, d), turn(d, v));
            let wide = width(short, height_mm);
            if 0.5 * wide * (at_a + at_b).abs() <= short.a.distance(short.b) {
                break;
            }
            let back = at_a.abs() < at_b.abs();
            let (p, q) = if back { (before, short) } else { (short, after) };
            let whole = BeadPiece { b: q.b, volume_mm3: p.volume_mm3 + q.volume_mm3, ..*p };
            let length = p.a.distance(p.b) + q.a.distance(q.b);
            if segment::distance_squared_mm2(q.a, p.a, q.b) > (WIGGLE.value() * wide).powi(2)
                || whole.a.distance(whole.b) < 0.5 * length
            {
                break;
            }
            let at = out.len() - if back { 3 } else { 2 };
            out.splice(at..at + 2, [whole]);
        }
    }
    out
}

/// Tangent of half the turn from one direction to another, positive to the left.
fn turn(from: DVec2, to: DVec2) -> f64 {
    (cross(from, to) / (1.0 + from.dot(to)).max(1e-9)).clamp(-MAX_HALF_TURN_TANGENT, MAX_HALF_TURN_TANGENT)
}

/// The ribbons of one path. Where the path turns, both ribbons end at the bisector of the angle. A ribbon loses as much
/// area on the inner side of the turn as it gains on the outer side, so its area stays the same.
fn ribbon(path: &[BeadPiece], height_mm: f64) -> Vec<Ribbon> {
    let along: Vec<DVec2> = path.iter().map(|p| (p.b - p.a).normalize()).collect();
    let n = path.len();
    let closed = n > 2 && path[0].a.distance(path[n - 1].b) < WIGGLE.value() * width(&path[0], height_mm);
    let piece = |k: usize| {
        let (p, d) = (&path[k], along[k]);
        let (length, half) = (p.a.distance(p.b), 0.5 * width(p, height_mm));
        let mut at_a = if k > 0 || closed { turn(along[(k + n - 1) % n], d) } else { 0.0 };
        let mut at_b = if k + 1 < n || closed { turn(d, along[(k + 1) % n]) } else { 0.0 };
        // Without this limit, the inner side of a short piece between two sharp turns would have a negative length.
        let most = half * (at_a + at_b).abs();
        if most > length {
            at_a *= length / most;
            at_b *= length / most;
        }
        let side = d.perp() * half;
        let (a, b) = (d * (half * at_a), d * (half * at_b));
        let corners = [p.a - side - a, p.b - side + b, p.b + side - b, p.a + side + a];
        let area_mm2 = 2.0 * half * length;
        Ribbon { corners, along: d, volume_mm3: p.volume_mm3, area_mm2, material: p.material }
    };
    (0..n).map(piece).collect()
}

/// A grid that covers all beads and one empty cell around them, and the volume of the beads, mm3. The grid is moved by a
/// share of a cell, 0 to 1, towards lower x and y.
pub(super) fn grid_over(
    layers: &[DistinctLayer],
    cell_mm: f64,
    moved: f64,
) -> Result<(CellGrid, f64), CellError> {
    // Ribbons end where paths end. With a margin the cells there would be half empty.
    let of_layer = |layer: &DistinctLayer| {
        let begin = (DVec2::INFINITY, DVec2::NEG_INFINITY, 0.0);
        ribbons(layer).fold(begin, |(low, high, laid_mm3), ribbon| {
            let reach = |f: fn(DVec2, DVec2) -> DVec2, from| ribbon.corners.into_iter().fold(from, f);
            (reach(DVec2::min, low), reach(DVec2::max, high), laid_mm3 + layer.copies * ribbon.volume_mm3)
        })
    };
    let of_layers: Vec<(DVec2, DVec2, f64)> = layers.par_iter().map(of_layer).collect();
    let (low, high, laid_mm3) = of_layers
        .into_iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY, 0.0), |(low, high, laid_mm3), own| {
            (low.min(own.0), high.max(own.1), laid_mm3 + own.2)
        });
    if !(low.is_finite() && high.is_finite()) {
        return Err(CellError::NoBeads);
    }
    // The grid is centred, so that a symmetric part gets symmetric cells. 1e-6 of a cell keeps rounding from adding
    // a row.
    let size = (high - low) / cell_mm - 1e-6;
    let more = if moved > 0.0 { 3.0 } else { 2.0 };
    let (nx, ny) = (size.x.ceil() + more, size.y.ceil() + more);
    if nx * ny > MAX_CELLS as f64 {
        return Err(CellError::TooMany { nx, ny, cell_mm, most: MAX_CELLS });
    }
    // The third extra cell has already moved the grid by half a cell.
    let off = if moved > 0.0 { 0.5 - moved } else { 0.0 };
    let low = 0.5 * (low + high) - cell_mm * (0.5 * DVec2::new(nx, ny) - off);
    Ok((CellGrid { low, cell_mm, nx: nx as usize, ny: ny as usize }, laid_mm3))
}

/// Number of fans into which the directions of a half turn are sorted, for each material; the first fan lies around x.
/// Source: derived. Within a fan of 22.5 degrees directions are averaged; one at its edge is off by 11 degrees at most,
/// which changes a modulus by 4 % of the difference between along and across at 0 degrees.
pub(super) const FANS: usize = 8;

/// A ply: the beads of all layers that have one direction in one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ply {
    /// Material over the area of the cell, mm.
    pub thickness_mm: f64,
    /// Mean direction of its beads, radians from x, without sign.
    pub angle_rad: f64,
    /// How well the directions of its beads agree: 1 where they are equal, 0 where no direction prevails.
    pub coherence: f64,
    /// Its material: the number of its card.
    pub material: u8,
    /// Share of it that carries across its beads, from `LEAST_JOINED` to 1. The rest has no material beside it in its own
    /// layer or the two next to that, but has some in layers further off.
    pub joined: f64,
}

/// The least [`Ply::joined`]. Source: derived. Lines that lean by 0.7 mm a mm of height (`LEAN` of graded fills) form a wall
/// at 35 degrees from upright, whose stiffness along the plate is that of the wall times the sine to the power of four,
/// 0.11.
pub(crate) const LEAST_JOINED: f64 = 0.1;

/// Beads of one direction that are thinner than this in a cell, in layers, are no ply of their own: their material goes to the
/// thickest ply there. Source: derived, as [`LEAST_TAKING`]: whether a cell holds so little is decided by the rounding of
/// G-code. Without it the first failure of a bar was that of a ply of 3e-29 mm, which had come from the end of a bead two cells
/// away as cells gave to each other what they had too much: 1.71 times the load, for 1.87 in the same bar turned by 37
/// degrees, where that ply was rounded to nothing.
const LEAST_PLY: f64 = 0.02;

/// All layers of a part added up over the thickness, as plies in each cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Laminate {
    /// The cells.
    pub grid: CellGrid,
    /// The plies of a cell are `plies[starts[cell]..starts[cell + 1]]`.
    pub starts: Vec<u32>,
    /// Plies, cell by cell.
    pub plies: Vec<Ply>,
    /// Thickness of all layers, mm.
    pub height_mm: f64,
    /// Material in the cells, mm3, with what does not fit into full ones.
    pub volume_mm3: f64,
    /// Material of the beads, mm3.
    pub laid_mm3: f64,
}

/// Why beads cannot become cells.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CellError {
    /// No bead of the part is in the program.
    #[error("no bead of the part is in the program")]
    NoBeads,
    /// The cells are too small for the memory.
    #[error("{nx} x {ny} cells of {cell_mm} mm are more than {most}; take larger cells")]
    TooMany {
        /// Cells along x.
        nx: f64,
        /// Cells along y.
        ny: f64,
        /// Side of a cell, mm.
        cell_mm: f64,
        /// The largest number of cells.
        most: usize,
    },
}

/// The largest number of cells of a grid. Source: derived. Eight fans of three numbers of 4 bytes take 96 bytes
/// a cell and layer in work: 144 MB.
pub const MAX_CELLS: usize = 1_500_000;

impl Laminate {
    /// The laminate of these beads on cells of this size. What a cell cannot hold flows to its neighbours.
    ///
    /// # Errors
    /// [`CellError`] when there is no bead or there are too many cells.
    pub fn from_layers(sheets: &[BeadSheet], cell_mm: f64) -> Result<Self, CellError> {
        Self::moved(sheets, cell_mm, 0.0)
    }

    /// [`Laminate::from_layers`] on a grid that is moved by a share of a cell, 0 to 1.
    ///
    /// # Errors
    /// As [`Laminate::from_layers`].
    pub fn moved(sheets: &[BeadSheet], cell_mm: f64, moved: f64) -> Result<Self, CellError> {
        let Repeated { layers, of_layer } = Repeated::new(sheets);
        let (grid, laid_mm3) = grid_over(&layers, cell_mm, moved)?;
        let all = layers.iter().flat_map(|l| l.paths.iter().flatten());
        let n_fans = FANS * (1 + usize::from(all.map(|b| b.material).max().unwrap_or(0)));
        let laid = |cells: &mut LayerCells, l: &DistinctLayer| LaidShares {
            height_mm: l.height_mm,
            width_mm: mean_width_mm(std::slice::from_ref(l)),
            shares: layer(&grid, n_fans, l, cells),
        };
        let laid: Vec<LaidShares> = layers.par_iter().map_init(LayerCells::default, laid).collect();
        // What is joined depends on the layers beside a layer, so it is found once for each three that follow each other.
        let mut threes: BTreeMap<(Option<usize>, usize, Option<usize>), f32> = BTreeMap::new();
        for (k, own) in of_layer.iter().enumerate() {
            let below = k.checked_sub(1).map(|k| of_layer[k]);
            *threes.entry((below, *own, of_layer.get(k + 1).copied())).or_default() += 1.0;
        }
        let joined: Vec<(usize, f32, Vec<f32>)> = threes
            .into_par_iter()
            .map(|((below, own, above), copies)| {
                (own, copies, joined_mm(&grid, n_fans, &laid, own, [below, above]))
            })
            .collect();
        let n = grid.nx * grid.ny;
        let mut starts = vec![0u32; n + 1];
        // Thickness, its products with cosine and sine, and the thickness that is joined.
        let mut fans = vec![[0f32; 4]; n * n_fans];
        let mut held = vec![0f32; n];
        for (own, copies, joined) in &joined {
            for (share, joined) in laid[*own].shares.iter().zip(joined) {
                let fan = &mut fans[share.slot as usize];
                (0..3).for_each(|k| fan[k] += copies * share.sum[k]);
                fan[3] += copies * joined;
                held[share.slot as usize / n_fans] += copies * share.sum[0];
            }
        }
        let width_mm = mean_width_mm(&layers);
        let mut plies = Vec::new();
        let mut volume = 0.0;
        let height_mm: f64 = sheets.iter().map(|s| s.height_mm).sum();
        let least_mm = LEAST_PLY * height_mm / sheets.len().max(1) as f64;
        for cell in 0..n {
            // Material that found no room in neighbours is not in the part: no cell carries more than its own volume.
            let fits = (height_mm / f64::from(held[cell])).min(1.0);
            for (k, fan) in fans[cell * n_fans..(cell + 1) * n_fans].iter().enumerate() {
                let [t, c, s, joined] = fan.map(f64::from);
                if t > 0.0 {
                    volume += t;
                    let angle_rad = 0.5 * atan2(s, c);
                    let coherence = ((c * c + s * s).sqrt() / t).min(1.0);
                    let material = (k / FANS) as u8;
                    let joined = joined / t;
                    // How much the cells beside the beads hold, over this one: nothing where no layer fills them.
                    let beside = || {
                        let sides = sides(&grid, direction(angle_rad), width_mm);
                        let least = sides
                            .map(|side| side.read(&grid, &held, grid.place(cell)))
                            .fold(held[cell], f32::min);
                        f64::from(least / held[cell])
                    };
                    let more = if joined < 1.0 { (1.0 - joined) * (1.0 - beside()) } else { 0.0 };
                    let joined = (joined + more).clamp(LEAST_JOINED, 1.0);
                    plies.push(Ply { thickness_mm: t * fits, angle_rad, coherence, material, joined });
                }
            }
            merge_thin(&mut plies, starts[cell] as usize, least_mm);
            starts[cell + 1] = plies.len() as u32;
        }
        let volume_mm3 = volume * grid.cell_mm * grid.cell_mm;
        Ok(Self { grid, starts, plies, height_mm, volume_mm3, laid_mm3 })
    }

    /// The plies of a cell.
    pub(crate) fn plies_in(&self, cell: usize) -> &[Ply] {
        &self.plies[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Material over the area of a cell, mm.
    pub fn thickness_mm(&self, cell: usize) -> f64 {
        self.plies_in(cell).iter().map(|p| p.thickness_mm).sum()
    }

    /// Difference between the volume of the cells and that of the beads, as a share of the latter.
    pub fn volume_error(&self) -> f64 {
        (self.volume_mm3 / self.laid_mm3 - 1.0).abs()
    }
}

/// Adds the plies from number `first` on that are thinner than `least_mm` to the thickest of them.
fn merge_thin(plies: &mut Vec<Ply>, first: usize, least_mm: f64) {
    let most_mm = plies[first..].iter().map(|p| p.thickness_mm).fold(0.0, f64::max);
    let least_mm = least_mm.min(most_mm);
    let thin_mm: f64 = plies.extract_if(first.., |p| p.thickness_mm < least_mm).map(|p| p.thickness_mm).sum();
    if let Some(thickest) = plies[first..].iter_mut().find(|p| p.thickness_mm >= most_mm) {
        thickest.thickness_mm += thin_mm;
    }
}

/// The cells of a layer while it is made, kept for the next one: each page of new memory costs more than it takes to clear it.
#[derive(Default)]
pub(super) struct LayerCells {
    /// What each cell holds, mm.
    held: Vec<f32>,
    /// What each cell holds of each material.
    fans: Vec<Fans>,
}

/// What a cell holds of a material, by fan: the thicknesses, and their products with cosine and sine of twice the angle.
type Fans = [[f32; FANS]; 3];

/// The material of a layer.
pub(super) fn layer(
    grid: &CellGrid,
    n_fans: usize,
    layer: &DistinctLayer,
    LayerCells { held, fans }: &mut LayerCells,
) -> Vec<Share> {
    let (n, n_materials) = (grid.nx * grid.ny, n_fans / FANS);
    held.clear();
    held.resize(n, 0.0);
    fans.clear();
    fans.resize(n * n_materials, [[0.0; FANS]; 3]);
    for bead in ribbons(layer) {
        let along = bead.along;
        let double = DVec2::new(along.x * along.x - along.y * along.y, 2.0 * along.x * along.y);
        let half_turns = 0.5 * atan2(double.y, double.x) / std::f64::consts::PI;
        let fan = (half_turns * FANS as f64).round().rem_euclid(FANS as f64) as usize % FANS;
        let corners = bead.corners.map(|p| (p - grid.low) / grid.cell_mm);
        // The width of a blob is limited, so its height follows from its volume.
        let fill = bead.volume_mm3 / bead.area_mm2;
        covered_cells(&corners, grid, &mut |cell, area| {
            let t = area * fill;
            held[cell] += t as f32;
            let [sum, cos, sin] = &mut fans[cell * n_materials + usize::from(bead.material)];
            sum[fan] += t as f32;
            cos[fan] += (t * double.x) as f32;
            sin[fan] += (t * double.y) as f32;
        });
    }
    spread(grid, layer.height_mm as f32, held, fans);
    let sums = fans.iter().flat_map(|f| (0..FANS).map(|k| f.map(|of_fans| of_fans[k])));
    let shares = sums.enumerate().filter(|(_, sum)| sum[0] > 0.0);
    shares.map(|(slot, sum)| Share { slot: slot as u32, sum }).collect()
}

/// The mean width of the beads of some layers, mm.
fn mean_width_mm(layers: &[DistinctLayer]) -> f64 {
    let beads = layers.iter().flat_map(|l| l.paths.iter().flatten().map(move |b| (l, b)));
    let (area, length) = beads.fold((0.0, 0.0), |(area, length), (l, b)| {
        let long = l.copies * b.a.distance(b.b);
        (area + long * width(b, l.height_mm), length + long)
    });
    if length > 0.0 { area / length } else { 0.0 }
}

/// Passes in which overfull cells give to their neighbours. Measured: row `fea.strength.laminate.PASSES` of `cargo xtask
/// bench constants`.
static PASSES: Tuned<usize> = Tuned::new("fea.strength.laminate.PASSES", 12);

/// A cell gives to its neighbours if it is fuller than this, where 1 is full. Measured: row
/// `fea.strength.laminate.OVERFULL` of `cargo xtask bench constants`.
static OVERFULL: Tuned<f32> = Tuned::new("fea.strength.laminate.OVERFULL", 1.0005);

/// A cell takes from overfull neighbours if it is fuller than this, where 1 is full. Source: derived. The edge of a bead on the
/// border of a cell reaches beyond it by the rounding of G-code, 0.001 mm, which is a hundredth of a cell of 0.1 mm. Without
/// this margin, rounding would decide whether the row of cells outside the part is filled.
const LEAST_TAKING: f32 = 0.02;

/// A cell that is fuller than it may be, and what it gives to its neighbours in a pass.
struct Giver {
    cell: usize,
    /// What it holds before the pass, mm.
    before: f32,
    gifts: Gifts,
}

/// What a cell gives to each of its neighbours.
enum Gifts {
    /// This share of the room that a neighbour has.
    OfRoom(f32),
    /// The same thickness, mm, where no neighbour has room: half of the excess is spread, and a later pass moves it on.
    Equal(f32),
}

/// Moves the excess of overfull cells to their neighbours, in proportion to the free space of each. All cells of a pass give
/// at once: were one to give after the other, the order of the cells would show, and a turned part would get others.
///
/// Cost: most of the time in which the cells of a dense solid are made. A layer full of beads has no room, so most gifts are
/// equal ones, and each cell gives to all neighbours in every pass. A gift therefore moves all fans of a material at once, in
/// vector instructions; a list of only those fans that hold something takes twice as long.
fn spread(grid: &CellGrid, full: f32, held: &mut [f32], fans: &mut [Fans]) {
    let n_materials = fans.len() / held.len();
    let nearly = 2.0 - OVERFULL.value();
    // Empty neighbours lie outside the part, and no material leaves the part. Cells that take only become fuller or give of
    // their excess, so each takes in all passes or in none.
    let takes = |held: f32| held > full * LEAST_TAKING;
    // The outermost cells hold nothing (`grid_over`), so every cell that gives has all its neighbours.
    let inner = |j: usize| (j * grid.nx + 1)..((j + 1) * grid.nx - 1);
    let offsets = AROUND.map(|(di, dj)| dj * grid.nx as isize + di);
    let around = |cell: usize| offsets.map(|off| cell.wrapping_add_signed(off));
    // How much each cell has room for, how much it is asked to take, and the share of each gift that it takes.
    let (mut room, mut asked, mut taken) = (vec![0f32; held.len()], vec![0f32; held.len()], Vec::new());
    let (mut givers, mut owned): (Vec<Giver>, Vec<Fans>) = (Vec::new(), Vec::new());
    for _ in 0..PASSES.value() {
        // A cell that was filled is full apart from rounding, and has no room.
        let has_room = |held: f32| takes(held) && held <= full * nearly;
        room.iter_mut()
            .zip(&*held)
            .for_each(|(room, &held)| *room = if has_room(held) { full - held } else { 0.0 });
        givers.clear();
        owned.clear();
        for cell in (1..grid.ny - 1).flat_map(inner).filter(|&c| held[c] > full * OVERFULL.value()) {
            let (before, near) = (held[cell], around(cell));
            let excess = before - full;
            let space: f32 = near.iter().map(|&other| room[other]).sum();
            let gifts = if space > 0.0 {
                let share = (excess / space).min(1.0);
                near.iter().for_each(|&other| asked[other] += share * room[other]);
                Gifts::OfRoom(share)
            } else {
                let n = near.iter().filter(|&&other| takes(held[other])).count();
                Gifts::Equal(0.5 * excess / n as f32)
            };
            givers.push(Giver { cell, before, gifts });
            owned.extend_from_slice(&fans[cell * n_materials..(cell + 1) * n_materials]);
        }
        if givers.is_empty() {
            return;
        }
        // A cell that is asked to take more than it has room for takes the same share of each gift.
        taken.clear();
        taken.extend(
            asked.iter().zip(&room).map(|(asked, room)| if asked > room { room / asked } else { 1.0 }),
        );
        asked.fill(0.0);
        for (Giver { cell, before, gifts }, owned) in givers.iter().zip(owned.chunks_exact(n_materials)) {
            let near = around(*cell);
            let gifts = near.map(|other| match gifts {
                Gifts::OfRoom(share) => share * room[other] * taken[other],
                Gifts::Equal(gift) if takes(held[other]) => *gift,
                Gifts::Equal(_) => 0.0,
            });
            let given: f32 = gifts.iter().sum();
            // Receivers get the directions of the giver's beads in the shares that it held before, and the giver loses at
            // once what all its gifts took.
            for (material, &own) in owned.iter().enumerate() {
                let mut add = |cell: usize, share: f32| {
                    let to = &mut fans[cell * n_materials + material];
                    for (to, own) in to.iter_mut().zip(own) {
                        for (to, own) in to.iter_mut().zip(own) {
                            *to += own * share;
                        }
                    }
                };
                for (other, gift) in near.into_iter().zip(gifts).filter(|(_, gift)| *gift > 0.0) {
                    add(other, gift / before);
                }
                add(*cell, -(given / before));
            }
            near.into_iter().zip(gifts).for_each(|(other, gift)| held[other] += gift);
            held[*cell] -= given;
        }
    }
}

/// Calls `each` with every cell that a convex quadrilateral covers, and with the covered area as a share of a cell. Its
/// corners run counter-clockwise, in cells from the lowest corner of the grid.
///
/// Each side counts with how far it runs upwards within the row of the cell, times how far it lies right of the cell's left
/// side there, from nothing to the width of the cell in the mean. Sides on the left run downwards.
fn covered_cells(corners: &[DVec2; 4], grid: &CellGrid, each: &mut dyn FnMut(usize, f64)) {
    let (low, high) = (corners.iter().fold(f64::INFINITY, |m, p| m.min(p.y)), {
        corners.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p.y))
    });
    let whole = |v: f64, n: usize| (v.max(0.0) as usize).min(n - 1);
    for j in whole(low, grid.ny)..=whole(high, grid.ny) {
        // The sides within the row: where each begins and ends along x, and how far it runs upwards.
        let (mut sides, mut n_sides) = ([(0.0, 0.0, 0.0); 4], 0);
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in 0..4 {
            let (p, q) = (corners[k], corners[(k + 1) % 4]);
            let [begin, end] = [p.y, q.y].map(|y| y.clamp(j as f64, j as f64 + 1.0));
            if begin == end {
                continue;
            }
            let slope = (q.x - p.x) / (q.y - p.y);
            let at = |y: f64| if y == q.y { q.x } else { p.x + (y - p.y) * slope };
            let (a, b) = (at(begin), at(end));
            sides[n_sides] = (a.min(b), a.max(b), end - begin);
            n_sides += 1;
            (from, to) = (from.min(a.min(b)), to.max(a.max(b)));
        }
        if from > to || to < 0.0 || from > grid.nx as f64 {
            continue;
        }
        for i in whole(from, grid.nx)..=whole(to, grid.nx) {
            let left = i as f64;
            let area: f64 =
                sides[..n_sides].iter().map(|(a, b, up)| up * mean_in_cell(a - left, b - left)).sum();
            if area > 0.0 {
                each(j * grid.nx + i, area);
            }
        }
    }
}

/// The mean of all values from `a` up to `b`, each cut to the range from 0 to 1.
fn mean_in_cell(a: f64, b: f64) -> f64 {
    if b <= 0.0 {
        0.0
    } else if a >= 1.0 {
        1.0
    } else if a >= 0.0 && b <= 1.0 {
        0.5 * (a + b)
    } else {
        let (first, last) = (a.max(0.0), b.min(1.0));
        (0.5 * (last - first) * (first + last) + (b - 1.0).max(0.0)) / (b - a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bead(a: (f64, f64), b: (f64, f64), section: f64) -> BeadPiece {
        let (a, b) = (DVec2::from(a), DVec2::from(b));
        BeadPiece { a, b, volume_mm3: a.distance(b) * section, material: 0 }
    }

    #[test]
    fn cells_hold_what_was_laid_whichever_way() {
        let beads: Vec<BeadPiece> = (0..40)
            .map(|k| {
                let d = direction(f64::from(k) * 0.37);
                let p = DVec2::new(f64::from(k % 7) * 2.1, f64::from(k / 7) * 1.9);
                bead(p.into(), (p + d * (0.3 + 0.25 * f64::from(k))).into(), 0.08)
            })
            .collect();
        for cell in [0.1, 0.23, 0.5] {
            let sheet = BeadSheet { height_mm: 0.2, beads: beads.clone() };
            let laminate = Laminate::from_layers(&[sheet.clone(), sheet], cell).expect("beads");
            assert!(laminate.volume_error() < 1e-5, "{cell}: {}", laminate.volume_error());
        }
    }

    #[test]
    fn a_dense_raster_fills_its_cells_and_knows_its_direction() {
        for deg in [0.0, 30.0, 45.0, 90.0, 135.0f64] {
            let d = direction(deg.to_radians());
            let n = DVec2::new(-d.y, d.x);
            let line = |k: i32| {
                let p = n * (f64::from(k) * 0.4);
                bead((p - d * 10.0).into(), (p + d * 10.0).into(), 0.08)
            };
            let sheet = BeadSheet { height_mm: 0.2, beads: (-20..=20).map(line).collect() };
            let laminate = Laminate::from_layers(&[sheet], 0.3).expect("beads");
            let grid = laminate.grid;
            let inner = (0..grid.nx * grid.ny).filter(|&c| grid.centre(c).length() < 6.0);
            let mut seen = 0;
            for cell in inner {
                assert!((laminate.thickness_mm(cell) - 0.2).abs() < 1e-5, "{deg}");
                let [ply] = laminate.plies_in(cell) else { panic!("one direction") };
                let off = (ply.angle_rad - deg.to_radians()).rem_euclid(std::f64::consts::PI);
                assert!(off.min(std::f64::consts::PI - off) < 1e-5 && ply.coherence > 0.9999);
                seen += 1;
            }
            assert!(seen > 500);
        }
    }

    #[test]
    fn a_turned_or_mirrored_part_has_the_same_cells_where_they_overflow() {
        type Map = fn(DVec2) -> DVec2;
        // A zigzag whose turns overlap beside a wall, and two beads on top of each other: much has to flow.
        let mut places = Vec::new();
        for k in 0..12 {
            let x = 0.35 * f64::from(k);
            let ends = [DVec2::new(x, 0.1), DVec2::new(x + 0.1, 4.3)];
            places.extend(if k % 2 == 0 { ends } else { [ends[1], ends[0]] });
        }
        places.extend(
            [(4.5, 4.4), (-0.1, 4.4), (-0.1, 0.0), (4.2, 0.0), (4.2, 1.1), (2.0, 0.3)].map(DVec2::from),
        );
        let sheet =
            |map: &dyn Fn(DVec2) -> DVec2| path(&places.iter().map(|p| map(*p)).collect::<Vec<_>>(), 0.1);
        let on = |map: &dyn Fn(DVec2) -> DVec2| Laminate::from_layers(&[sheet(map)], 0.25).expect("beads");
        let straight = on(&|p| p);
        let grid = straight.grid;
        let overfull =
            |sheet: &BeadSheet| covered(sheet, &grid).iter().filter(|c| 0.1 / 0.2 * **c > 0.5).count();
        assert!(overfull(&sheet(&|p| p)) > 20);
        let turned: [(&str, Map); 4] = [
            ("by 180 degrees", |p| DVec2::new(-p.x, -p.y)),
            ("by 90 degrees", |p| DVec2::new(-p.y, p.x)),
            ("by 270 degrees", |p| DVec2::new(p.y, -p.x)),
            ("mirrored", |p| DVec2::new(-p.x, p.y)),
        ];
        for (what, map) in turned {
            let other = on(&map);
            for cell in 0..grid.nx * grid.ny {
                let at = ((map(grid.centre(cell)) - other.grid.low) / other.grid.cell_mm).floor();
                let there = at.y as usize * other.grid.nx + at.x as usize;
                let (here, there) = (straight.thickness_mm(cell), other.thickness_mm(there));
                assert!((here - there).abs() < 1e-5, "{what}: {here} and {there} at {}", grid.centre(cell));
            }
        }
    }

    #[test]
    fn what_flows_in_from_afar_is_no_ply_of_its_own() {
        // Beads that overlap by half lie beside others at 45 degrees, so that shares of shares flow from cell to cell.
        let along = (0..16).map(|k| bead((0.0, 0.2 * f64::from(k)), (6.0, 0.2 * f64::from(k)), 0.08));
        let aslant = (0..12).map(|k| {
            let x = 6.0 + 0.5 * f64::from(k);
            bead((x, 0.0), (x + 3.0, 3.0), 0.08)
        });
        let sheet = BeadSheet { height_mm: 0.2, beads: along.chain(aslant).collect() };
        let laminate = Laminate::from_layers(&[sheet.clone(), sheet], 0.25).expect("beads");
        assert!(laminate.volume_error() < 1e-5, "{}", laminate.volume_error());
        let mut of_two = 0;
        for cell in 0..laminate.grid.nx * laminate.grid.ny {
            let plies = laminate.plies_in(cell);
            of_two += usize::from(plies.len() > 1);
            let least_mm = plies.iter().map(|p| p.thickness_mm).fold(f64::INFINITY, f64::min);
            assert!(plies.len() < 2 || least_mm > 0.02 * 0.2, "{plies:?}");
        }
        assert!(of_two > 10, "{of_two}");
    }

    /// A path through these places, as one bead of this section.
    fn path(places: &[DVec2], section: f64) -> BeadSheet {
        let beads = places.windows(2).map(|p| bead(p[0].into(), p[1].into(), section)).collect();
        BeadSheet { height_mm: 0.2, beads }
    }

    /// How often each cell is covered, before anything flows.
    fn covered(sheet: &BeadSheet, grid: &CellGrid) -> Vec<f64> {
        let mut all = vec![0.0; grid.nx * grid.ny];
        for r in ribbons(&DistinctLayer::new(sheet)) {
            let corners = r.corners.map(|p| (p - grid.low) / grid.cell_mm);
            covered_cells(&corners, grid, &mut |cell, area| all[cell] += area);
        }
        all
    }

    #[test]
    fn cells_get_the_area_that_a_ribbon_covers() {
        use grainpath_core::{Polygon, Region};
        let grid = CellGrid { low: DVec2::ZERO, cell_mm: 1.0, nx: 12, ny: 12 };
        for k in 0..60u32 {
            // Trapezoids of all directions, sizes and shapes, along the cells too, and some down to a triangle.
            let along = direction(f64::from(k) * std::f64::consts::PI / 12.0);
            let half: f64 = [0.05, 0.4, 1.3][k as usize % 3];
            let length = [0.1, 1.0, 3.0, 5.5][k as usize % 4];
            let lean = [0.0, 0.3, -0.5, 1.0][k as usize / 15] * half.min(0.5 * length);
            let (side, end) = (along.perp() * half, along * lean);
            let a = DVec2::new(5.5, 5.5) + 0.1 * f64::from(k % 7) - 0.5 * length * along;
            let b = a + along * length;
            let corners = [a - side - end, b - side + end, b + side - end, a + side + end];
            let whole = Region::from(Polygon { outer: corners.to_vec(), holes: Vec::new() });
            let mut areas = vec![0.0; grid.nx * grid.ny];
            covered_cells(&corners, &grid, &mut |cell, area| areas[cell] += area);
            let sum: f64 = areas.iter().sum();
            assert!((sum - 2.0 * half * length).abs() < 1e-9, "{k}: {sum} of {}", 2.0 * half * length);
            for (cell, area) in areas.iter().enumerate() {
                let low = DVec2::new((cell % grid.nx) as f64, (cell / grid.nx) as f64);
                let want = whole.intersection(&Region::rectangle(low, low + 1.0)).area_mm2();
                assert!((area - want).abs() < 1e-3, "{k}: {area} for {want} at {low}");
            }
        }
    }

    #[test]
    fn a_path_that_turns_leaves_no_gap_and_lies_nowhere_twice() {
        // Lines 0.4 apart between two walls that lean, joined at their ends in one piece or in several.
        for (lean, n) in [(0.0, 1), (0.0, 4), (0.5, 1), (0.5, 3), (-0.5, 4)] {
            let place = |side: f64, y: f64| DVec2::new(side + lean * y, y);
            let mut places = Vec::new();
            for k in 0..20 {
                let y = 0.4 * f64::from(k);
                let (a, b) = if k % 2 == 0 { (-6.0, 6.0) } else { (6.0, -6.0) };
                places.extend([place(a, y), place(b, y)]);
                if k < 19 {
                    places.extend((1..n).map(|i| place(b, y + 0.4 * f64::from(i) / f64::from(n))));
                }
            }
            let grid = CellGrid { low: DVec2::new(-12.0, -1.0), cell_mm: 0.1, nx: 240, ny: 100 };
            let all = covered(&path(&places, 0.08), &grid);
            for (cell, covered) in all.iter().enumerate() {
                let p = grid.centre(cell);
                let off = (p.x - lean * p.y).abs();
                let inside = p.y > 0.05 && p.y < 7.55 && off < 5.9;
                let outside = p.y < -0.3 || p.y > 7.9 || off > 6.0 + 0.2 * (1.0 + lean * lean).sqrt() + 0.15;
                assert!(!inside || (covered - 1.0).abs() < 1e-9, "{lean} {n}: {covered} at {p}");
                assert!(!outside || *covered < 1e-9, "{lean} {n}: {covered} at {p}");
            }
        }
        // A ring is closed where it begins.
        let around = |k: i32| direction(f64::from(k % 60) * std::f64::consts::TAU / 60.0);
        let ring: Vec<DVec2> = (0..=60).map(|k| 2.0 * around(k)).collect();
        let grid = CellGrid { low: DVec2::new(-3.0, -3.0), cell_mm: 0.05, nx: 120, ny: 120 };
        for (cell, covered) in covered(&path(&ring, 0.08), &grid).iter().enumerate() {
            let off = (grid.centre(cell).length() - 2.0).abs();
            assert!(off > 0.15 || (covered - 1.0).abs() < 1e-9, "{covered} at {}", grid.centre(cell));
            assert!(off < 0.25 || *covered == 0.0);
        }
    }

    #[test]
    fn paths_of_any_shape_keep_their_volume() {
        // Reversals, spikes, wiggles finer than the bead, and pieces far shorter than it is wide.
        let mut places = vec![DVec2::ZERO];
        for k in 0..400 {
            let turn = direction(f64::from(k * k % 97) * 0.8);
            let last = places[places.len() - 1];
            places.push(last + turn * [3.0, 0.02, 0.3, 0.004, 1.0][k as usize % 5]);
            if k % 50 == 0 {
                places.push(last);
            }
        }
        let sheet = path(&places, 0.08);
        let laid: f64 = sheet.beads.iter().map(|b| b.volume_mm3).sum();
        let ribbons: f64 = ribbons(&DistinctLayer::new(&sheet)).map(|r| r.volume_mm3).sum();
        assert!((ribbons / laid - 1.0).abs() < 1e-12);
        for cell in [0.1, 0.4] {
            let laminate = Laminate::from_layers(std::slice::from_ref(&sheet), cell).expect("beads");
            assert!(laminate.volume_error() < 1e-4, "{cell}: {}", laminate.volume_error());
        }
    }

    /// Copies may be laid in another order and direction, their loops may begin elsewhere, a path may hold a piece as short as
    /// what coordinates are rounded to, and volumes and heights are rounded; a layer of another height is none.
    #[test]
    fn layers_with_the_same_beads_are_made_into_cells_once() {
        let zigzag = |k: i32| {
            let at = |i: i32| {
                DVec2::new(if i % 4 < 2 { 0.0 } else { 6.0 }, f64::from(8 * k) + 0.4 * f64::from(i / 2))
            };
            path(&(0..20).map(at).collect::<Vec<_>>(), 0.08).beads
        };
        let backwards = |beads: Vec<BeadPiece>| -> Vec<BeadPiece> {
            beads.into_iter().rev().map(|b| BeadPiece { a: b.b, b: b.a, ..b }).collect()
        };
        // A square loop that begins at one of its corners.
        let round = |begin: usize| {
            let corners = [(10.0, 0.0), (15.0, 1.0), (14.0, 6.0), (9.0, 5.0)].map(DVec2::from);
            path(&(0..=4).map(|k| corners[(begin + k) % 4]).collect::<Vec<_>>(), 0.08).beads
        };
        let first = BeadSheet { height_mm: 0.2, beads: [zigzag(0), zigzag(1), round(0)].concat() };
        let mut crumbed = zigzag(0);
        let (end, crumb) = (crumbed[7].b, DVec2::new(0.0, -1e-3));
        crumbed[8].a = end + crumb;
        crumbed.insert(8, BeadPiece { a: end, b: end + crumb, volume_mm3: 1e-14, ..crumbed[7] });
        let beads = [backwards(round(2)), backwards(zigzag(1)), crumbed].concat();
        let mut other = BeadSheet { height_mm: 0.2 + 1e-13, beads };
        other.beads.iter_mut().for_each(|b| b.volume_mm3 *= 1.0001);
        let thick = BeadSheet { height_mm: 0.3, ..first.clone() };
        let all = [thick, first.clone(), other.clone(), first, other];
        let repeated = Repeated::new(&all);
        assert_eq!(repeated.of_layer, [0, 1, 1, 1, 1]);
        assert_eq!(repeated.layers.iter().map(|l| l.copies).collect::<Vec<_>>(), [1.0, 4.0]);
        let laid: f64 = all.iter().flat_map(|s| &s.beads).map(|b| b.volume_mm3).sum();
        let laminate = Laminate::from_layers(&all, 0.4).expect("beads");
        assert!((laminate.laid_mm3 / laid - 1.0).abs() < 1e-12 && laminate.volume_error() < 1e-5);
        // Moved by less than the cells show, layers are no copies; what they hold together stays the same.
        let moved = |k: usize, sheet: &BeadSheet| {
            let by = DVec2::splat(1e-9 * k as f64);
            let piece = |b: &BeadPiece| BeadPiece { a: b.a + by, b: b.b + by, ..*b };
            BeadSheet { height_mm: sheet.height_mm, beads: sheet.beads.iter().map(piece).collect() }
        };
        let apart: Vec<BeadSheet> = all.iter().enumerate().map(|(k, s)| moved(k, s)).collect();
        assert_eq!(Repeated::new(&apart).layers.len(), all.len());
        let one_by_one = Laminate::from_layers(&apart, 0.4).expect("beads");
        assert_eq!(laminate.starts, one_by_one.starts);
        for (a, b) in laminate.plies.iter().zip(&one_by_one.plies) {
            let joined = a.thickness_mm * (a.joined - b.joined);
            let off = [a.thickness_mm - b.thickness_mm, a.angle_rad - b.angle_rad, joined];
            // A cell keeps what is within `OVERFULL` of its volume.
            assert!(off.iter().all(|off| off.abs() < 5e-4), "{a:?} and {b:?}");
        }
    }

    #[test]
    fn too_much_melt_flows_to_where_there_is_space() {
        // Two beads too near to each other, and a third a little too far off: as much missing as is too much.
        let beads = [0.0, 0.3, 0.8].map(|y| bead((0.0, y), (20.0, y), 0.08)).to_vec();
        let laminate = Laminate::from_layers(&[BeadSheet { height_mm: 0.2, beads }], 0.2).expect("beads");
        assert!(laminate.volume_error() < 1e-5);
        let worst = (0..laminate.grid.nx * laminate.grid.ny).map(|c| laminate.thickness_mm(c));
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 0.2 + 1e-9, "no cell holds more than its volume: {worst}");
    }

    /// A plate with half as much again as it has room for is as thick as one that is full.
    #[test]
    fn cells_hold_at_most_their_volume() {
        let thickness = |flow: f64| {
            let beads =
                (0..20).map(|k| bead((0.0, 0.4 * f64::from(k)), (8.0, 0.4 * f64::from(k)), 0.08 * flow));
            let sheet = BeadSheet { height_mm: 0.2, beads: beads.collect() };
            let laminate = Laminate::from_layers(&vec![sheet; 3], 0.4).expect("beads");
            let inner = (0..laminate.grid.nx * laminate.grid.ny).map(|c| laminate.thickness_mm(c));
            inner.fold(0.0, f64::max)
        };
        assert!(
            (thickness(1.0) - 0.6).abs() < 0.01 && (thickness(1.5) - 0.6).abs() < 1e-6,
            "{}",
            thickness(1.5)
        );
    }

    /// The least share that is joined of the plies along x in the middle of a plate whose lines of 0.4 mm lie 1.6 mm apart
    /// and move by `shift_mm` from layer to layer, alone or in turn with lines across.
    fn least_joined(shift_mm: f64, spacing_mm: f64, is_crossed: bool) -> f64 {
        let sheet = |k: usize| {
            let n = (8.0 / spacing_mm) as i32;
            let beads = (-n..=n).map(|i| {
                let at = f64::from(i) * spacing_mm + (k as f64 * shift_mm) % spacing_mm;
                let is_across = is_crossed && k % 2 == 1;
                let place = |along: f64| if is_across { (at, along) } else { (along, at) };
                bead(place(-8.0), place(8.0), 0.08)
            });
            BeadSheet { height_mm: 0.2, beads: beads.collect() }
        };
        let sheets: Vec<BeadSheet> = (0..16).map(sheet).collect();
        let laminate = Laminate::from_layers(&sheets, 0.2).expect("beads");
        let grid = laminate.grid;
        let inner = (0..grid.nx * grid.ny).filter(|c| grid.centre(*c).abs().max_element() < 4.0);
        let plies = inner.flat_map(|c| laminate.plies_in(c)).filter(|p| p.angle_rad.abs() < 0.1);
        plies.map(|p| p.joined).fold(1.0, f64::min)
    }

    #[test]
    fn lines_that_move_from_layer_to_layer_are_not_joined_by_adding_layers_up() {
        assert_eq!(least_joined(0.0, 0.4, false), 1.0, "dense");
        assert_eq!(least_joined(0.2, 0.4, false), 1.0, "dense, in bond");
        assert!(least_joined(0.0, 1.6, false) > 0.9, "standing still: cells between them are empty");
        assert!(
            least_joined(0.4, 1.6, false) < 0.2,
            "moving: layers fill all cells, and none joins two lines"
        );
        assert!(least_joined(0.0, 1.6, true) > 0.5, "crossing: each line rests on those across");
    }

    #[test]
    fn nothing_and_too_much_are_refused() {
        assert_eq!(Laminate::from_layers(&[], 0.2), Err(CellError::NoBeads));
        let far = BeadSheet { height_mm: 0.2, beads: vec![bead((0.0, 0.0), (1e7, 1e7), 0.1)] };
        assert!(matches!(Laminate::from_layers(&[far], 0.2), Err(CellError::TooMany { .. })));
    }
}
