//! Measures how well beads fill the part: gap, spill and overlap, by scan lines across the layer.
//!
//! # Method
//! Each bead is a capsule: a straight piece with round ends. A scan line crosses each capsule in one
//! interval, and the section of the part in one or more intervals. Covered and uncovered lengths on the
//! line are exact, and the sum over evenly spaced lines approximates the area. Lines are oblique, so
//! that no infill runs along them.
//!
//! The overlap is the volume of the beads divided by the layer's height, minus the covered area. The sides
//! of a bead are round: a bead of width `w` covers `w` in plan, but its volume fills only `w - h (1 - pi/4)`
//! of the layer's height `h`. In dense fill neighbours cover each other by this difference and the overlap
//! of an exact fill is 0. A bead without neighbours has no such excess, so for sparse fill the difference is
//! below zero. The overlap is then stated as 0, because on the whole nothing is laid twice.
//!
//! # Units, cost and limits
//! Lengths in mm; results are shares of the part's area. The cost is that of sorting the crossings, about
//! 150 000 in a layer. Lines lie 0.01 to 0.3 mm apart; a hole smaller than this may lie between two
//! lines. The area of the section itself is known exactly and corrects the sums. A bead without length
//! covers nothing; layers without the part are not measured.

use grainpath_core::math::{direction, rotated};
use grainpath_core::{DVec2, Region};
use rayon::prelude::*;

use crate::layer_groups::{Bead, BeadLayer};
use crate::simulate::Program;

/// Measures of a print, as shares of the part's area in the measured layers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Quality {
    /// Share of the part that no bead covers.
    pub gap: f64,
    /// Volume of the beads divided by the layer's height, minus the area that they cover; at least 0.
    pub overlap: f64,
    /// Area of beads outside the part.
    pub spill: f64,
    /// Largest gap of a single layer.
    pub worst_layer_gap: f64,
    /// Bead widths below which 1, 50 and 99 % of the printed length lie, mm.
    pub bead_width_mm: [f64; 3],
    /// Largest number of paths in a layer.
    pub paths_per_layer_max: usize,
    /// Number of measured layers.
    pub layers: usize,
}

/// Direction of the scan lines, rad (31.7 degrees). Source: derived. No common raster angle is near it: a line along
/// the beads would see either a whole gap or none of it.
const ASLANT_RAD: f64 = 0.5533;
/// Approximate number of crossings that are computed in a layer. The error of the area falls with the
/// line spacing; more crossings cost time in proportion.
const CROSSINGS: f64 = 150_000.0;

/// Measures a program against the sections of its part. `section` returns the part's section at a height
/// above the plate, in the machine's coordinates. A `sample` above 0 is the number of evenly spaced
/// layers to measure.
pub fn quality(program: &Program, section: impl Fn(f64) -> Option<Region> + Sync, sample: usize) -> Quality {
    let n = program.layers.len();
    let with_part: Vec<&BeadLayer> =
        program.layers.iter().filter(|l| l.beads.iter().any(|b| b.role.is_part())).collect();
    let picks: Vec<&BeadLayer> = if sample == 0 || sample >= with_part.len() {
        with_part.clone()
    } else {
        let last = (with_part.len() - 1) as f64;
        (1..=sample).map(|i| with_part[(last * i as f64 / (sample + 1) as f64) as usize]).collect()
    };
    let measured: Vec<Areas> = picks
        .into_par_iter()
        // The section halfway up the layer, where the slicer cuts it.
        .filter_map(|layer| Some(measure(layer, &section(layer.z_mm - 0.5 * layer.height_mm)?)))
        .collect();
    let mut q = Quality { layers: measured.len(), bead_width_mm: widths(&with_part), ..Quality::default() };
    q.paths_per_layer_max = program.layers.iter().map(|l| l.paths).max().unwrap_or(0);
    let part: f64 = measured.iter().map(|a| a.part).sum();
    if n == 0 || part <= 0.0 {
        return q;
    }
    for a in &measured {
        q.gap += (a.part - a.inside) / part;
        q.spill += (a.union - a.inside) / part;
        q.overlap += (a.beads - a.union) / part;
        // A section of at most 1 mm2 is left out of the worst gap, because a single bead's width dominates its share.
        if a.part > 1.0 {
            q.worst_layer_gap = q.worst_layer_gap.max(1.0 - a.inside / a.part);
        }
    }
    // Sparse fill has a negative overlap (see the module's text); rounding can make gap and spill slightly negative.
    [q.gap, q.overlap, q.spill] =
        [q.gap, q.overlap, q.spill].map(|share| if share > 0.0 { share } else { 0.0 });
    q
}

/// Areas of one layer, mm2.
#[derive(Default)]
struct Areas {
    part: f64,
    beads: f64,
    union: f64,
    inside: f64,
}

/// The volume of a bead, scaled from the bead's own height to the height of the layer, mm3.
fn in_layer(bead: &Bead, layer_mm: f64) -> f64 {
    let volume = f64::from(bead.volume_mm3);
    if bead.raise_mm == [0.0; 2] { volume } else { volume * layer_mm / bead.height_mm(layer_mm).max(1e-3) }
}

fn measure(layer: &BeadLayer, section: &Region) -> Areas {
    let back = direction(-ASLANT_RAD);
    let turn = |p: DVec2| rotated(p, back);
    let beads: Vec<(DVec2, DVec2, f64)> = layer
        .beads
        .iter()
        .filter(|b| b.role.is_part() && b.a != b.b)
        .map(|b| (turn(b.start()), turn(b.end()), 0.5 * b.width_mm(layer.height_mm)))
        .collect();
    let edges: Vec<(DVec2, DVec2)> = section
        .contours()
        .flat_map(|c| grainpath_core::poly::edges(c))
        .map(|(a, b)| (turn(a), turn(b)))
        .collect();
    // The number of crossings is the total height of the beads over the spacing of lines.
    let tall: f64 = beads.iter().map(|(a, b, r)| (a.y - b.y).abs() + 2.0 * r).sum();
    // At most 0.3 mm, so that lines meet thin gaps; at least 0.01 mm, because f32 positions are too coarse below that.
    let step = (tall / CROSSINGS).clamp(0.01, 0.3);
    let mut areas = Areas {
        part: section.area_mm2(),
        beads: layer
            .beads
            .iter()
            .filter(|b| b.role.is_part())
            .map(|b| in_layer(b, layer.height_mm))
            .sum::<f64>()
            / layer.height_mm,
        ..Areas::default()
    };
    let lows = beads.iter().map(|(a, b, r)| a.y.min(b.y) - r).chain(edges.iter().map(|(a, _)| a.y));
    let low = lows.fold(f64::INFINITY, f64::min);
    let highs = beads.iter().map(|(a, b, r)| a.y.max(b.y) + r).chain(edges.iter().map(|(a, _)| a.y));
    let rows = ((highs.fold(f64::NEG_INFINITY, f64::max) - low) / step).ceil().max(0.0) as usize;
    let row_range = |lo: f64, hi: f64| {
        let first = ((lo - low) / step - 0.5).ceil().max(0.0) as usize;
        first..(((hi - low) / step - 0.5).floor() + 1.0).clamp(0.0, rows as f64) as usize
    };
    // Intervals as f32 take half the memory; 1e-5 mm on a bed of 200 mm is far below the spacing.
    let mut covered: Vec<Vec<(f32, f32)>> = vec![Vec::new(); rows];
    for &(a, b, r) in &beads {
        for row in row_range(a.y.min(b.y) - r, a.y.max(b.y) + r) {
            let y = low + (row as f64 + 0.5) * step;
            if let Some((x0, x1)) = capsule(a, b, r, y) {
                covered[row].push((x0 as f32, x1 as f32));
            }
        }
    }
    let mut borders: Vec<Vec<f32>> = vec![Vec::new(); rows];
    for &(a, b) in &edges {
        let (lo, hi) = if a.y < b.y { (a, b) } else { (b, a) };
        for row in row_range(lo.y, hi.y) {
            let y = low + (row as f64 + 0.5) * step;
            // The interval is half-open, so that a line that enters a contour also leaves it.
            if lo.y <= y && y < hi.y {
                borders[row].push((lo.x + (y - lo.y) / (hi.y - lo.y) * (hi.x - lo.x)) as f32);
            }
        }
    }
    let mut part = 0.0;
    for (intervals, border) in covered.iter_mut().zip(&mut borders) {
        intervals.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        border.sort_unstable_by(f32::total_cmp);
        let (union, inside) = lengths(intervals, border);
        areas.union += union * step;
        areas.inside += inside * step;
        part += border.chunks_exact(2).map(|p| f64::from(p[1] - p[0])).sum::<f64>() * step;
    }
    // The area of the part as the scan lines see it has an error, which must not appear as a gap or spill.
    if part > 0.0 {
        let exact = areas.part / part;
        areas.inside *= exact;
        areas.union *= exact;
    }
    areas
}

/// The interval in which the line at height `y` crosses a capsule.
fn capsule(a: DVec2, b: DVec2, r: f64, y: f64) -> Option<(f64, f64)> {
    // A capsule is convex, so its lowest and highest crossing are the interval: two discs and two
    // straight sides.
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut take = |x: f64| {
        lo = lo.min(x);
        hi = hi.max(x);
    };
    for p in [a, b] {
        let d = y - p.y;
        if d.abs() < r {
            let w = (r * r - d * d).sqrt();
            take(p.x - w);
            take(p.x + w);
        }
    }
    let along = b - a;
    let length = along.length();
    let side = DVec2::new(-along.y, along.x) * (r / length);
    for (p, q) in [(a + side, b + side), (a - side, b - side)] {
        if (p.y > y) != (q.y > y) {
            take(p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x));
        }
    }
    (lo < hi).then_some((lo, hi))
}

/// Length of the union of sorted intervals, and the part of it that lies within pairs of borders.
fn lengths(intervals: &[(f32, f32)], borders: &[f32]) -> (f64, f64) {
    let (mut union, mut inside) = (0.0, 0.0);
    let mut pairs = borders.chunks_exact(2).peekable();
    let mut within = |lo: f32, hi: f32| {
        while let Some(pair) = pairs.peek() {
            if pair[0] >= hi {
                break;
            }
            inside += f64::from((hi.min(pair[1]) - lo.max(pair[0])).max(0.0));
            if pair[1] > hi {
                break;
            }
            pairs.next();
        }
    };
    let mut open: Option<(f32, f32)> = None;
    for &(lo, hi) in intervals {
        match &mut open {
            Some(o) if lo <= o.1 => o.1 = o.1.max(hi),
            _ => {
                if let Some((lo, hi)) = open.replace((lo, hi)) {
                    union += f64::from(hi - lo);
                    within(lo, hi);
                }
            }
        }
    }
    if let Some((lo, hi)) = open {
        union += f64::from(hi - lo);
        within(lo, hi);
    }
    (union, inside)
}

/// Widths at 1, 50 and 99 % of the printed length.
fn widths(layers: &[&BeadLayer]) -> [f64; 3] {
    let widths_and_lengths = |l: &&BeadLayer| -> Vec<(f64, f64)> {
        // Very short beads are the ends of paths; their width is mostly rounding error.
        let long = |b: &&Bead| b.role.is_part() && b.start().distance(b.end()) > 0.05;
        l.beads.iter().filter(long).map(|b| (b.width_mm(l.height_mm), b.start().distance(b.end()))).collect()
    };
    let mut all: Vec<(f64, f64)> = layers.iter().flat_map(widths_and_lengths).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = all.iter().map(|w| w.1).sum();
    [0.01, 0.5, 0.99].map(|share| {
        let mut sum = 0.0;
        let at = all.iter().find(|w| {
            sum += w.1;
            sum >= share * total
        });
        at.or(all.last()).map_or(0.0, |w| w.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::units::bead_spacing_mm;
    use grainpath_core::{Polygon, Role};

    /// Quality of straight beads 20 mm long and 0.45 mm wide, in a layer of 0.2 mm, at these distances from the lower
    /// edge of a part of 20 x 10 mm.
    fn measured(places_mm: impl Iterator<Item = f64>) -> Quality {
        let volume_mm3 = (20.0 * 0.2 * bead_spacing_mm(0.45, 0.2)) as f32;
        let beads = places_mm.map(|y| Bead {
            a: [0.0, y as f32],
            b: [20.0, y as f32],
            volume_mm3,
            speed_mm_s: 50.0,
            role: Role::SolidFill,
            starts: true,
            raise_mm: [0.0; 2],
        });
        let layer = BeadLayer { z_mm: 0.2, height_mm: 0.2, beads: beads.collect(), ..BeadLayer::default() };
        let program = Program { layers: vec![layer], ..Program::default() };
        let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)];
        let outer = corners.map(|(x, y)| DVec2::new(x, y)).to_vec();
        let part = Region { polygons: vec![Polygon { outer, holes: Vec::new() }] };
        quality(&program, |_| Some(part.clone()), 0)
    }

    #[test]
    fn beads_without_neighbours_lay_nothing_twice() {
        let q = measured((1..10).map(f64::from));
        assert_eq!(q.overlap.to_bits(), 0.0f64.to_bits(), "{q:?}");
        // Nine beads of 0.45 mm on 10 mm.
        assert!((q.gap - (1.0 - 0.405)).abs() < 0.002, "{q:?}");
    }

    #[test]
    fn beads_laid_twice_are_overlap() {
        let once = |i: u32| 0.5 + f64::from(i) * bead_spacing_mm(0.45, 0.2);
        let q = measured((0..22).map(once));
        assert!(q.overlap < 0.001, "{q:?}");
        let twice = measured((0..22).chain(0..11).map(once));
        // Half of the beads, 20 mm x spacing each, on 200 mm2. Round sides and ends at the border of the fill cover
        // 2 % that no bead fills.
        let expected = 11.0 * 20.0 * bead_spacing_mm(0.45, 0.2) / 200.0;
        assert!((twice.overlap - expected).abs() < 0.03, "{twice:?} should be {expected}");
    }
}
