//! How well beads fill the part: gap, spill, overlap, by lines drawn across the layer.
//!
//! Every bead is a capsule: a straight piece with round ends. A line across the layer meets each capsule in one
//! interval and the section in some; covered and uncovered lengths follow exactly, and the sum over evenly spaced
//! lines is the area. Lines run aslant, so that no fill lies along them.

use grainpath_core::math::{direction, rotated};
use grainpath_core::{DVec2, Region};
use rayon::prelude::*;

use crate::simulate::{Bead, BeadLayer, Program};

/// What a print measures up to; shares of the part's area in the layers looked at.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Quality {
    /// Part that no bead covers.
    pub gap: f64,
    /// Sum of bead areas over their union.
    pub overlap: f64,
    /// Beads outside the part.
    pub spill: f64,
    /// The largest gap of a layer.
    pub worst_layer_gap: f64,
    /// Bead widths that 1, 50 and 99 % of the printed length stay under, mm.
    pub bead_width_mm: [f64; 3],
    /// Most paths in a layer.
    pub paths_per_layer_max: usize,
    /// Layers looked at.
    pub layers: usize,
}

/// Direction of the lines; no common raster angle is near.
const ASLANT_RAD: f64 = 0.5533;
/// Crossings looked at in one layer, about.
const CROSSINGS: f64 = 150_000.0;

/// Measures a program against the sections of its part. `section` gives the part's section at a height above the
/// plate, in the machine's coordinates; layers are picked as the outside check picks them.
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
        if a.part > 1.0 {
            q.worst_layer_gap = q.worst_layer_gap.max(1.0 - a.inside / a.part);
        }
    }
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
    let tall: f64 = beads.iter().map(|(a, b, r)| (a.y - b.y).abs() + 2.0 * r).sum();
    let step = (tall / CROSSINGS).clamp(0.01, 0.3);
    let mut areas = Areas {
        part: section.area_mm2(),
        beads: layer.beads.iter().filter(|b| b.role.is_part()).map(|b| f64::from(b.volume_mm3)).sum::<f64>()
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
            // Half-open, so that every line leaves what it enters.
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
    // What the lines leave of the part's area is their own error; it must not look like a gap or a spill.
    if part > 0.0 {
        let exact = areas.part / part;
        areas.inside *= exact;
        areas.union *= exact;
    }
    areas
}

/// Where the line at height `y` enters and leaves a capsule.
fn capsule(a: DVec2, b: DVec2, r: f64, y: f64) -> Option<(f64, f64)> {
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

/// Length of the union of sorted intervals, and of what of it lies between pairs of borders.
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

/// Widths by printed length: 1, 50 and 99 %.
fn widths(layers: &[&BeadLayer]) -> [f64; 3] {
    let of = |l: &&BeadLayer| -> Vec<(f64, f64)> {
        let long = |b: &&Bead| b.role.is_part() && b.start().distance(b.end()) > 0.05;
        l.beads.iter().filter(long).map(|b| (b.width_mm(l.height_mm), b.start().distance(b.end()))).collect()
    };
    let mut all: Vec<(f64, f64)> = layers.iter().flat_map(of).collect();
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
