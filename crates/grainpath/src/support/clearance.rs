//! For every place around the part: the distance from the part, and whether a branch can reach the plate from there.
//!
//! Layers are combined into slabs about 0.4 mm thick. In every slab a grid holds the horizontal distance of each cell from
//! the part (exact on the grid: lower envelope of parabolas). From the plate upwards, a cell leads to the plate if one
//! of the nine cells below it does and the branch angle allows the step between them. Steps on the grid are longer than
//! a branch leans within one slab, so each cell keeps how far its way still has to go sideways: its *debt*.
//!
//! All distances are computed from the sections, not the facets. The sections are mended, so damaged meshes get the same
//! answers as sound ones. Lengths are in mm. Distances are good to about half a cell. Cost: linear in the cells, of which
//! there are 120 million at most, with two bytes each.

use grainpath_core::math::tan;
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec2, DVec3, LayerStack};
use rayon::prelude::*;

use grainpath_core::mask::{Mask, MaskGrid};

/// A step of stored distances, mm. Source: derived. Distances between centres of cells of 0.4 mm are off by up to 0.28 mm
/// (half a diagonal), so a fifth of that adds little. The largest distance is 255 steps, 12.75 mm, more than branches keep.
const STEP_MM: f64 = 0.05;
/// Largest number of cells of all slabs together; a larger part gets larger cells. Source: derived. A byte for the distance
/// and one for the ways down make 240 MB.
const MAX_CELLS: f64 = 1.2e8;
/// The finest cell, mm. Measured: row `support.clearance.CELL_MM` of `cargo xtask bench constants`.
static CELL_MM: Tuned<f64> = Tuned::new("support.clearance.CELL_MM", 0.4);
/// Slabs are about this thick, mm. Measured: row `support.clearance.SLAB_MM` of `cargo xtask bench constants`.
static SLAB_MM: Tuned<f64> = Tuned::new("support.clearance.SLAB_MM", 0.4);

/// Branches lean by this share of what their angle allows. Source: derived. A branch 100 mm high then ends 0.08 mm from
/// where the angle would take it, and rounding never makes one lean too far.
pub(super) const LEAN_SHARE: f64 = 0.999;
/// Bit of a cell from which a branch can reach the plate within its angle.
const TO_PLATE: u8 = 1;
/// Bit of a cell that has nothing but the plate straight below it.
const STRAIGHT_DOWN: u8 = 2;
/// Position of the debt in the byte of a cell: the upper six bits hold half the debt.
const DEBT_SHIFT: u8 = 2;
/// The largest debt of a way, that is how far it may stray from the centres of its cells, in the units of [`CELL`]. It is
/// at most 126, since half of it is stored in six bits. Measured: row `support.clearance.MAX_DEBT` of `cargo xtask bench
/// constants`.
static MAX_DEBT: Tuned<u16> = Tuned::new("support.clearance.MAX_DEBT", 40);
/// Width of a cell in the units of debts. Source: derived. The diagonal is then 90.5 units, and the 91 used differs from it
/// by half a percent. Half a debt of just under two cells fits into the six bits that are left of a byte.
const CELL: u16 = 64;
/// Value in place of the debt for a cell that cannot be passed.
const BLOCKED: u8 = u8::MAX;

/// Distances from the part and ways to the plate, on a grid over plan and height.
pub struct Clearance {
    grid: MaskGrid,
    nx: usize,
    ny: usize,
    /// Upper end of each slab above the plate, mm.
    tops_mm: Vec<f64>,
    distance: Vec<u8>,
    ways: Vec<u8>,
    /// Distance that a branch at the branch angle goes sideways within one slab, cells.
    slope: f64,
    tan_angle: f64,
    keep_mm: f64,
}

impl Clearance {
    /// Measures the part. Branches keep `keep_mm` from it with their centres, lean at most by `angle_rad` from the
    /// vertical and stand within `bed` (part coordinates); the grid reaches `margin_mm` beyond the part.
    pub fn new(stack: &LayerStack, bed: Bounds2, margin_mm: f64, keep_mm: f64, angle_rad: f64) -> Self {
        let layers = stack.layers();
        let part = layers.iter().filter_map(|l| l.region().bounds()).reduce(Bounds2::union);
        let part = part.unwrap_or(bed).grown(margin_mm);
        let bounds =
            Bounds2 { min: part.min.max(bed.min), max: part.max.min(bed.max).max(part.min.max(bed.min)) };
        let height = layers.last().map_or(0.0, grainpath_core::Layer::z_top_mm);
        let size = bounds.size();
        let mean = height / layers.len().max(1) as f64;
        let per_slab = (SLAB_MM.value() / mean.max(1e-9)).round().max(1.0) as usize;
        let n_slabs = layers.len().div_ceil(per_slab);
        let cell_mm = CELL_MM.value().max((size.x * size.y * n_slabs as f64 / MAX_CELLS).sqrt());
        let grid = MaskGrid::over(bounds, cell_mm);
        let [nx, ny] = grid.size();
        let slabs: Vec<&[grainpath_core::Layer]> = layers.chunks(per_slab).collect();
        let mut distance = vec![0u8; nx * ny * slabs.len()];
        distance.par_chunks_mut(nx * ny).zip(&slabs).for_each(|(out, slab)| {
            let mask = slab
                .iter()
                .filter(|l| !l.region().is_empty())
                .map(|l| Mask::touched(grid, l.region()))
                .reduce(|a, b| a.or(&b));
            match mask {
                Some(mask) => distances(&mask, nx, ny, grid.cell_mm(), out),
                None => out.fill(u8::MAX),
            }
        });
        let tops_mm: Vec<f64> = slabs.iter().filter_map(|s| s.last()).map(|l| l.z_top_mm()).collect();
        let slope = mean * per_slab as f64 * tan(angle_rad) / grid.cell_mm();
        let mut clearance = Self {
            grid,
            nx,
            ny,
            tops_mm,
            distance,
            ways: Vec::new(),
            slope,
            tan_angle: LEAN_SHARE * tan(angle_rad),
            keep_mm,
        };
        clearance.find_ways(bed);
        clearance
    }

    /// Goes from the plate upwards. A cell leads down if the cell below it, or a neighbour of that cell, does. Grid steps
    /// are longer than a branch leans in one slab, so each cell carries how far sideways its way still has to go: its debt.
    fn find_ways(&mut self, bed: Bounds2) {
        let (nx, ny) = (self.nx, self.ny);
        let n = nx * ny;
        let credit = ((self.slope * f64::from(CELL)) as u16).max(1);
        let keep = (self.keep_mm / STEP_MM).ceil() as u8;
        let free: Vec<bool> = (0..n).map(|i| bed_holds(bed, self.centre(i % nx, i / nx))).collect();
        let mut below: Vec<u8> = free.iter().map(|&f| if f { 0 } else { BLOCKED }).collect();
        let mut straight = free;
        let mut ways = vec![0u8; self.distance.len()];
        for (slab, out) in self.distance.chunks(n).zip(ways.chunks_mut(n)) {
            let mut here = vec![BLOCKED; n];
            let rows = here.par_chunks_mut(nx).zip(out.par_chunks_mut(nx)).zip(straight.par_chunks_mut(nx));
            rows.enumerate().for_each(|(y, ((debts, ways), straight))| {
                for x in 0..nx {
                    let i = y * nx + x;
                    if slab[i] < keep {
                        straight[x] = false;
                        continue;
                    }
                    let mut debt = u16::MAX;
                    for (ox, oy, cost) in NEIGHBOURS {
                        let (Some(px), Some(py)) = (x.checked_add_signed(ox), y.checked_add_signed(oy))
                        else {
                            continue;
                        };
                        if px < nx && py < ny && below[py * nx + px] != BLOCKED {
                            debt = debt.min(u16::from(below[py * nx + px]) + cost);
                        }
                    }
                    let debt = debt.saturating_sub(credit);
                    if debt <= MAX_DEBT.value() {
                        debts[x] = debt as u8;
                        ways[x] = TO_PLATE
                            | if straight[x] { STRAIGHT_DOWN } else { 0 }
                            | (debt as u8 / 2) << DEBT_SHIFT;
                    } else {
                        straight[x] = false;
                    }
                }
            });
            below = here;
        }
        self.ways = ways;
    }

    fn centre(&self, x: usize, y: usize) -> DVec2 {
        self.grid.origin() + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * self.grid.cell_mm()
    }

    fn cell(&self, p: DVec2) -> Option<(usize, usize)> {
        let c = (p - self.grid.origin()) / self.grid.cell_mm();
        let inside = c.x >= 0.0 && c.y >= 0.0 && c.x < self.nx as f64 && c.y < self.ny as f64;
        inside.then_some((c.x as usize, c.y as usize))
    }

    /// The slab that holds height `z`; the topmost for anything higher.
    fn slab(&self, z_mm: f64) -> usize {
        self.tops_mm.partition_point(|&t| t < z_mm).min(self.tops_mm.len().saturating_sub(1))
    }

    fn index(&self, p: DVec3) -> Option<usize> {
        let (x, y) = self.cell(p.truncate())?;
        (!self.tops_mm.is_empty()).then(|| (self.slab(p.z) * self.ny + y) * self.nx + x)
    }

    /// Horizontal distance from the part in the slab of `p`, mm, good to about half a cell and capped at 12.75; zero
    /// outside the grid, where nothing may stand.
    pub fn distance_mm(&self, p: DVec3) -> f64 {
        self.index(p).map_or(0.0, |i| f64::from(self.distance[i]) * STEP_MM)
    }

    /// Whether a branch at `p` can get to the plate.
    pub(crate) fn leads_to_plate(&self, p: DVec3) -> bool {
        self.index(p).is_some_and(|i| self.ways[i] & TO_PLATE != 0)
    }

    /// Whether there is nothing but the plate straight below `p`.
    pub(crate) fn is_straight(&self, p: DVec3) -> bool {
        self.index(p).is_some_and(|i| self.ways[i] & STRAIGHT_DOWN != 0)
    }

    /// Whether the line keeps `keep_mm` from the part.
    pub fn is_clear(&self, a: DVec3, b: DVec3, keep_mm: f64) -> bool {
        self.along_mm(a, b).all(|mm| mm >= keep_mm)
    }

    /// The least distance of the line from the part, mm.
    pub fn least_mm(&self, a: DVec3, b: DVec3) -> f64 {
        self.along_mm(a, b).fold(f64::INFINITY, f64::min)
    }

    /// The distance from the part at points half a cell apart on a line.
    fn along_mm(&self, a: DVec3, b: DVec3) -> impl Iterator<Item = f64> + '_ {
        let n = ((a.distance(b) / (0.5 * self.grid.cell_mm())).ceil() as usize).clamp(1, 100_000);
        (0..=n).map(move |i| self.distance_mm(a.lerp(b, i as f64 / n as f64)))
    }

    /// The height of the first thing met straight below `p`: the top of a slab that the part is in, or the plate.
    pub fn floor_mm(&self, p: DVec3) -> f64 {
        let Some((x, y)) = self.cell(p.truncate()) else { return 0.0 };
        let n = self.nx * self.ny;
        let mut slab = self.slab(p.z);
        while slab > 0 {
            slab -= 1;
            if self.distance[slab * n + y * self.nx + x] == 0 {
                return self.tops_mm[slab];
            }
        }
        0.0
    }

    /// A way from `p` down to a place with nothing but the plate below, as the list of corners after `p`; empty where
    /// there is no way. Each leg stays within the branch angle and clear of the part.
    pub(crate) fn way_down(&self, p: DVec3) -> Vec<DVec3> {
        let n = self.nx * self.ny;
        let Some((mut x, mut y)) = self.cell(p.truncate()) else { return Vec::new() };
        let mut at = p.truncate();
        let mut way = vec![p];
        for slab in (0..self.slab(p.z)).rev() {
            let ways = &self.ways[slab * n..(slab + 1) * n];
            let z = 0.5 * (self.tops_mm[slab] + if slab > 0 { self.tops_mm[slab - 1] } else { 0.0 });
            let reach = self.tan_angle * (way[way.len() - 1].z - z);
            // Chooses the cell with the least debt after this step; of equal cells the present one, or else the nearest.
            let mut best = (f64::INFINITY, f64::INFINITY, x, y);
            for (ox, oy, _) in NEIGHBOURS {
                let (Some(px), Some(py)) = (x.checked_add_signed(ox), y.checked_add_signed(oy)) else {
                    continue;
                };
                if px >= self.nx || py >= self.ny || ways[py * self.nx + px] & TO_PLATE == 0 {
                    continue;
                }
                let debt = f64::from(ways[py * self.nx + px] >> DEBT_SHIFT) * 2.0 / f64::from(CELL);
                let away = self.centre(px, py).distance(at);
                let owed = debt + (away - reach).max(0.0) / self.grid.cell_mm();
                let motion = if (ox, oy) == (0, 0) { 0.0 } else { away };
                if (owed, motion) < (best.0, best.1) {
                    best = (owed, motion, px, py);
                }
            }
            if best.0 == f64::INFINITY {
                return Vec::new();
            }
            let target = self.centre(best.2, best.3);
            if (best.2, best.3) != (x, y) || best.0 > 0.0 {
                at += (target - at).clamp_length_max(reach);
            }
            if let Some((cx, cy)) = self.cell(at) {
                (x, y) = if ways[cy * self.nx + cx] & TO_PLATE != 0 { (cx, cy) } else { (best.2, best.3) };
            }
            way.push(at.extend(z));
            if ways[y * self.nx + x] & STRAIGHT_DOWN != 0 {
                break;
            }
        }
        self.pull_tight(&way)
    }

    /// Leaves out corners where the way stays clear of the part without them.
    fn pull_tight(&self, way: &[DVec3]) -> Vec<DVec3> {
        let mut out = Vec::new();
        let mut i = 0;
        while i + 1 < way.len() {
            let mut j = way.len() - 1;
            while j > i + 1 && !self.is_clear(way[i], way[j], self.keep_mm) {
                j = i + 1 + (j - i - 1) * 3 / 4;
            }
            out.push(way[j]);
            i = j;
        }
        out
    }
}

/// Steps to the same cell and to the eight around it, with the debt of each. Source: derived, see [`CELL`]: 91 is the
/// diagonal of a cell 64 wide.
const NEIGHBOURS: [(isize, isize, u16); 9] = [
    (0, 0, 0),
    (1, 0, CELL),
    (-1, 0, CELL),
    (0, 1, CELL),
    (0, -1, CELL),
    (1, 1, 91),
    (1, -1, 91),
    (-1, 1, 91),
    (-1, -1, 91),
];

fn bed_holds(bed: Bounds2, p: DVec2) -> bool {
    p.cmpge(bed.min).all() && p.cmple(bed.max).all()
}

/// Exact distance of each cell's centre from the nearest set cell's centre (lower envelope of parabolas, rows after
/// columns), in steps.
fn distances(mask: &Mask, nx: usize, ny: usize, cell_mm: f64, out: &mut [u8]) {
    // Source: derived. More than the square of any number of cells, and exact as a float.
    const FAR: f32 = 1e9;
    let mut columns = vec![FAR; nx * ny];
    for y in 0..ny {
        for x in 0..nx {
            if mask.get(x, y) {
                columns[y * nx + x] = 0.0;
            } else if y > 0 && columns[(y - 1) * nx + x] < FAR {
                columns[y * nx + x] = columns[(y - 1) * nx + x] + 1.0;
            }
        }
    }
    for y in (0..ny.saturating_sub(1)).rev() {
        for x in 0..nx {
            let down = columns[(y + 1) * nx + x] + 1.0;
            if down < columns[y * nx + x] {
                columns[y * nx + x] = down;
            }
        }
    }
    let mut hull: Vec<(usize, f32)> = Vec::with_capacity(nx);
    let scale = (cell_mm / STEP_MM) as f32;
    for (row, out) in columns.chunks(nx).zip(out.chunks_mut(nx)) {
        hull.clear();
        let height = |x: usize| row[x] * row[x] + (x * x) as f32;
        for x in (0..nx).filter(|&x| row[x] < FAR) {
            loop {
                let Some(&(last, from)) = hull.last() else {
                    hull.push((x, f32::NEG_INFINITY));
                    break;
                };
                let meet = (height(x) - height(last)) / (2.0 * (x - last) as f32);
                if meet > from {
                    hull.push((x, meet));
                    break;
                }
                hull.pop();
            }
        }
        let mut k = 0;
        for (x, out) in out.iter_mut().enumerate() {
            while k + 1 < hull.len() && hull[k + 1].1 <= x as f32 {
                k += 1;
            }
            *out = match hull.get(k) {
                Some(&(at, _)) => {
                    let d = x.abs_diff(at) as f32;
                    ((d * d + row[at] * row[at]).sqrt() * scale).min(255.0) as u8
                }
                None => u8::MAX,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::{Layer, Region};

    fn stack(regions: Vec<Region>) -> LayerStack {
        let layer =
            |(i, r): (usize, Region)| Layer::new(0.2 * (i + 1) as f64, 0.2, r).expect("a sound layer");
        LayerStack::new(regions.into_iter().enumerate().map(layer).collect()).expect("heights rise")
    }

    fn bed() -> Bounds2 {
        Bounds2 { min: DVec2::splat(-100.0), max: DVec2::splat(100.0) }
    }

    #[test]
    fn distances_are_those_of_the_sections() {
        let square = Region::rectangle(DVec2::ZERO, DVec2::splat(10.0));
        let c = Clearance::new(&stack(vec![square; 20]), bed(), 15.0, 1.0, 0.7);
        for (p, want) in [((12.0, 5.0), 2.0), ((5.0, 5.0), 0.0), ((13.0, 14.0), 5.0), ((-6.0, 3.0), 6.0)] {
            let found = c.distance_mm(DVec2::from(p).extend(2.0));
            assert!((found - want).abs() < 0.45, "{p:?}: {found} instead of {want}");
        }
        assert!(c.is_straight(DVec3::new(12.0, 5.0, 3.0)) && !c.is_straight(DVec3::new(10.5, 5.0, 3.0)));
    }

    #[test]
    fn ways_lead_round_what_is_below_and_never_lean_too_far() {
        // A table 4 mm above the plate: from above its middle one cannot get down at 40 degrees, from its rim one can.
        let table = Region::rectangle(DVec2::splat(-10.0), DVec2::splat(10.0));
        let mut regions = vec![Region::default(); 20];
        regions.push(table);
        regions.extend(vec![Region::default(); 60]);
        regions.push(Region::rectangle(DVec2::splat(-12.0), DVec2::splat(12.0)));
        let angle = 40f64.to_radians();
        let c = Clearance::new(&stack(regions), bed(), 20.0, 1.0, angle);
        let high = 15.9;
        assert!(!c.leads_to_plate(DVec3::new(0.0, 0.0, 8.0)));
        let start = DVec3::new(3.0, 0.0, high);
        assert!(c.leads_to_plate(start), "11.7 mm of height allow 9.8 sideways");
        assert!(!c.leads_to_plate(DVec3::new(-0.4, 0.0, 9.0)));
        let way = c.way_down(start);
        let mut at = start;
        for &p in &way {
            let lean = (p - at).truncate().length() / (at.z - p.z);
            assert!(lean < tan(angle) * 1.02, "{lean}");
            assert!(c.is_clear(at, p, 0.4), "{at} to {p}");
            at = p;
        }
        assert!(c.is_straight(at) && at.truncate().abs().max_element() > 10.9, "{at}");
        assert!((c.floor_mm(DVec3::new(0.0, 0.0, 8.0)) - 4.4).abs() < 0.21);
    }
}
