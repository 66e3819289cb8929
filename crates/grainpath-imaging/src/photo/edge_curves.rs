//! Joins edge points to curves.
//!
//! # Method
//! One method follows edges from pixel to pixel in both directions, as straight as possible. The other
//! joins each point to the nearest unused one, as in the publication. Chains are smoothed, and cut
//! where they jump or turn back. Ends that face each other over a gap are then joined, nearest pairs
//! first. The curves are resampled evenly, and curves that are too short are dropped.
//!
//! # Units, cost and limits
//! Edge points are in pixels, curves in mm of the rectified picture. The cost is linear in the edge
//! points; when ends are joined, only those within the gap along x are compared. Equal costs are
//! ordered by index, so the result is the same on each run. A ring is left open at its seam.

use grainpath_core::DVec2;
use grainpath_core::DisjointSets;
use grainpath_core::math::cos;
use grainpath_core::polyline::{length_mm, resampled};

use crate::canny::Edges;
use crate::metric::MetricImage;
use crate::structure_tensor::AxisGrid;

/// Method that joins edge points to curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Join {
    /// Along the edges, from neighbour to neighbour in the direction of the edge.
    Trace,
    /// From each point to the nearest unused one at any distance, as in the publication.
    Nearest,
}

/// Rules for joining and keeping curves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveSettings {
    /// Method that joins edge points.
    pub join: Join,
    /// Curves are cut where they turn by more than this in a step, radians.
    pub max_turn_rad: f64,
    /// Ends that face each other over gaps up to this are joined, mm; 0 joins none.
    pub bridge_mm: f64,
    /// Shorter curves are dropped, mm.
    pub min_length_mm: f64,
}

/// Curves along the edges of a rectified picture, in its millimetres, longest first.
pub fn edge_curves(edges: &Edges, image: &MetricImage, settings: &CurveSettings) -> Vec<Vec<DVec2>> {
    let chains = match settings.join {
        Join::Trace => trace(edges),
        Join::Nearest => join_nearest(&edges.crests().into_iter().map(DVec2::from).collect::<Vec<_>>()),
    };
    let mut curves: Vec<Vec<DVec2>> = Vec::new();
    for chain in chains {
        for piece in cut_strays(&smoothed(&chain), settings.max_turn_rad) {
            curves.push(piece.into_iter().map(|p| image.place(p.x, p.y)).collect());
        }
    }
    // A curve of a few pixels has no reliable direction in which it could be extended. The limit is a
    // quarter of the final length, because short pieces may still be joined to longer curves below.
    curves.retain(|c| length_mm(c, false) > (0.25 * settings.min_length_mm).max(3.0 * image.px_mm));
    let mut curves: Vec<Vec<DVec2>> =
        bridged(curves, settings.bridge_mm).iter().map(|c| softened(c, image.px_mm)).collect();
    curves.retain(|c| length_mm(c, false) >= settings.min_length_mm);
    longest_first(&mut curves);
    curves
}

/// Resamples a curve at 1.5 pixels or 0.15 mm, whichever is more, and smooths away waves of a few points.
fn softened(curve: &[DVec2], px_mm: f64) -> Vec<DVec2> {
    let even = resampled(curve, false, (1.5 * px_mm).max(0.15));
    (0..3).fold(even, |line, _| smoothed(&line))
}

/// Cuts curves at points where the grain is clear and its axis differs from that of the curve by more
/// than `off_rad`. Pieces shorter than `min_length_mm` are dropped; the longest come first.
pub fn along_grain(
    curves: Vec<Vec<DVec2>>,
    axes: &AxisGrid,
    off_rad: f64,
    min_length_mm: f64,
) -> Vec<Vec<DVec2>> {
    let mut out = Vec::new();
    let near = cos(2.0 * off_rad);
    for curve in curves {
        let n = curve.len();
        let strays = |k: usize| {
            // Three points on both sides give the direction; a single step follows the pixels, not the grain.
            let d = curve[(k + 3).min(n - 1)] - curve[k.saturating_sub(3)];
            let s = axes.sample(curve[k]);
            // Both axes are compared as doubled angles, so that opposite directions count as equal.
            // The cosine is enough for the comparison.
            let [x, y] = s.double;
            let along = x * (d.x * d.x - d.y * d.y) + y * 2.0 * d.x * d.y;
            s.coherence > CLEAR && along < near * (x * x + y * y).sqrt() * d.length_squared()
        };
        let mut piece = Vec::new();
        for k in 0..n {
            if strays(k) {
                out.push(std::mem::take(&mut piece));
            } else {
                piece.push(curve[k]);
            }
        }
        out.push(piece);
    }
    out.retain(|c| length_mm(c, false) >= min_length_mm);
    longest_first(&mut out);
    out
}

fn longest_first(curves: &mut Vec<Vec<DVec2>>) {
    let mut lengths: Vec<(f64, Vec<DVec2>)> = curves.drain(..).map(|c| (length_mm(&c, false), c)).collect();
    lengths.sort_by(|a, b| b.0.total_cmp(&a.0));
    curves.extend(lengths.into_iter().map(|(_, c)| c));
}

/// The grain's axis counts as clear from this coherence on. A higher value lets curves cross the grain
/// in weak places; a lower one cuts them because of noise.
const CLEAR: f64 = 0.3;

/// Follows every edge from pixel to pixel in both directions, as straight as possible.
fn trace(edges: &Edges) -> Vec<Vec<DVec2>> {
    let mut done = vec![false; edges.mask.len()];
    let mut out = Vec::new();
    for start in 0..edges.mask.len() {
        if !edges.mask[start] || done[start] {
            continue;
        }
        done[start] = true;
        let (p, along) = edges.crest(start);
        let (p, along) = (DVec2::from(p), DVec2::from(along));
        let mut line = walk(edges, start, -along, &mut done);
        line.reverse();
        line.push(p);
        line.extend(walk(edges, start, along, &mut done));
        // Shorter lines are noise and could not be smoothed.
        if line.len() > 3 {
            out.push(line);
        }
    }
    out
}

/// Cosine of the sharpest turn that a walk takes (66 degrees). Source: derived. Two steps of a pixel may turn by 45
/// degrees without a corner.
const STRAIGHT: f64 = 0.4;

fn walk(edges: &Edges, start: usize, heading: DVec2, done: &mut [bool]) -> Vec<DVec2> {
    let centre = |k: usize| DVec2::new((k % edges.width) as f64, (k / edges.width) as f64);
    let (mut at, mut heading) = (start, heading);
    let mut out = Vec::new();
    loop {
        let step = |n: usize| (centre(n) - centre(at)).normalize_or_zero().dot(heading);
        let free = edges.next_to(at).filter(|&n| !done[n]);
        let next = free.fold(None, |best: Option<(f64, usize)>, n| {
            let s = step(n);
            if best.is_none_or(|(b, _)| s > b) { Some((s, n)) } else { best }
        });
        let Some((straight, next)) = next else { return out };
        if straight < STRAIGHT {
            return out;
        }
        done[next] = true;
        // If an edge is two pixels thick, the pixels beside this step belong to the same edge. Without
        // this mark they would begin a second curve.
        let beside: Vec<usize> = edges
            .next_to(at)
            .filter(|&n| !done[n] && centre(n).distance_squared(centre(next)) < 1.5 && step(n) > STRAIGHT)
            .collect();
        beside.into_iter().for_each(|n| done[n] = true);
        let (p, along) = edges.crest(next);
        out.push(DVec2::from(p));
        let along = DVec2::from(along);
        let along = if along.dot(heading) < 0.0 { -along } else { along };
        // The mean of the edge's direction and the previous heading, so that noise in one pixel cannot
        // turn the walk.
        heading = (0.5 * along + 0.5 * heading).normalize_or_zero();
        at = next;
    }
}

/// Joins each point to the nearest unused one, until none is left.
fn join_nearest(points: &[DVec2]) -> Vec<Vec<DVec2>> {
    // Side of a search cell, pixels. Source: chosen; it changes only the speed, never the
    // result.
    const CELL: f64 = 4.0;
    // Longest step, pixels. Longer ones join unrelated edges and are cut again below.
    const FAR: f64 = 12.0;
    let Some(bounds) = grainpath_core::Bounds2::around_points(points.iter().copied()) else {
        return Vec::new();
    };
    let count = |v: f64| (v / CELL) as usize + 1;
    let (nx, ny) = (count(bounds.size().x), count(bounds.size().y));
    let cell = |p: DVec2| (((p.x - bounds.min.x) / CELL) as usize, ((p.y - bounds.min.y) / CELL) as usize);
    let mut cells: Vec<Vec<u32>> = vec![Vec::new(); nx * ny];
    for (i, &p) in points.iter().enumerate() {
        let (x, y) = cell(p);
        cells[y * nx + x].push(i as u32);
    }
    let mut out = Vec::new();
    let mut left = vec![true; points.len()];
    for start in 0..points.len() {
        if !left[start] {
            continue;
        }
        let mut line = vec![points[start]];
        let mut at = start;
        left[start] = false;
        loop {
            let (x, y) = cell(points[at]);
            let reach = (FAR / CELL) as usize;
            let mut best = (FAR * FAR, usize::MAX);
            for r in 0..=reach {
                // Rings of cells, nearest first. The search ends once a point is nearer than the next
                // ring can be.
                if best.0.sqrt() < (r as f64 - 1.0) * CELL {
                    break;
                }
                for j in y.saturating_sub(r)..=(y + r).min(ny - 1) {
                    for i in x.saturating_sub(r)..=(x + r).min(nx - 1) {
                        if i.abs_diff(x).max(j.abs_diff(y)) != r {
                            continue;
                        }
                        // Used points are removed as they are met, so that dense areas do not become
                        // slow.
                        cells[j * nx + i].retain(|&k| left[k as usize]);
                        for &k in &cells[j * nx + i] {
                            let d = points[k as usize].distance_squared(points[at]);
                            if d < best.0 {
                                best = (d, k as usize);
                            }
                        }
                    }
                }
            }
            if best.1 == usize::MAX {
                break;
            }
            at = best.1;
            left[at] = false;
            line.push(points[at]);
        }
        out.push(line);
    }
    out
}

/// The mean of five points around each point, with the ends kept. This removes the steps between pixels.
fn smoothed(line: &[DVec2]) -> Vec<DVec2> {
    let n = line.len();
    (0..n)
        .map(|i| {
            let r = 2.min(i).min(n - 1 - i);
            let window = &line[i - r..=i + r];
            window.iter().copied().sum::<DVec2>() / window.len() as f64
        })
        .collect()
}

/// Longest step within an edge, pixels. Longer steps jump from one edge to another.
const JUMP_PX: f64 = 3.0;

/// Cuts a line where it jumps or turns back.
fn cut_strays(line: &[DVec2], max_turn_rad: f64) -> Vec<Vec<DVec2>> {
    let straight = cos(max_turn_rad);
    let mut out = Vec::new();
    let mut piece: Vec<DVec2> = Vec::new();
    for &p in line {
        let jumps = piece.last().is_some_and(|q| q.distance(p) > JUMP_PX);
        // The heading is taken over several points: single steps between pixels turn by 45 degrees at
        // every stair.
        let turns = piece.len() > 6 && {
            let n = piece.len();
            let before = (piece[n - 1] - piece[n - 6]).normalize_or_zero();
            let step = p - piece[n - 3];
            step.length() > 0.7 && before.dot(step.normalize_or_zero()) < straight
        };
        if jumps || turns {
            out.push(std::mem::take(&mut piece));
        }
        piece.push(p);
    }
    out.push(piece);
    out.retain(|p| p.len() > 3);
    out
}

/// An end of a curve and the direction in which it was going.
struct End {
    curve: usize,
    at_start: bool,
    p: DVec2,
    outwards: DVec2,
}

/// Joins curves whose ends face each other, nearest pairs first.
fn bridged(curves: Vec<Vec<DVec2>>, gap_mm: f64) -> Vec<Vec<DVec2>> {
    if gap_mm <= 0.0 || curves.len() < 2 {
        return curves;
    }
    let mut ends = Vec::with_capacity(2 * curves.len());
    for (curve, c) in curves.iter().enumerate() {
        // The direction of an end comes from its last eight points.
        let back = 8.min(c.len() - 1);
        let (first, last) = (c[0], c[c.len() - 1]);
        ends.push(End { curve, at_start: true, p: first, outwards: (first - c[back]).normalize_or_zero() });
        let inner = c[c.len() - 1 - back];
        ends.push(End { curve, at_start: false, p: last, outwards: (last - inner).normalize_or_zero() });
    }
    let mut pairs = facing_pairs(&ends, gap_mm);
    // Equal costs are ordered by index, so that the result is the same on every run.
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut partner = vec![usize::MAX; ends.len()];
    let mut chains = DisjointSets::new(curves.len());
    for (_, a, b) in pairs {
        // A pair of ends of the same chain would close it to a ring, which the loops below could not follow.
        let free = partner[a] == usize::MAX && partner[b] == usize::MAX;
        if free && chains.union(ends[a].curve, ends[b].curve) {
            (partner[a], partner[b]) = (b, a);
        }
    }
    // End 2k is the start of curve k, end 2k + 1 its last point.
    let mut used = vec![false; curves.len()];
    let mut out = Vec::new();
    for first in 0..curves.len() {
        if used[first] {
            continue;
        }
        // The chain is followed to one of its ends first, then over its whole length.
        let mut end = 2 * first;
        while partner[end] != usize::MAX {
            end = partner[end] ^ 1;
        }
        let mut line: Vec<DVec2> = Vec::new();
        loop {
            let e = &ends[end];
            used[e.curve] = true;
            let points = curves[e.curve].iter().copied();
            if e.at_start {
                line.extend(points)
            } else {
                line.extend(points.rev())
            }
            match partner[end ^ 1] {
                usize::MAX => break,
                next => end = next,
            }
        }
        out.push(line);
    }
    out
}

/// Pairs of nearby ends that face each other. Their cost grows with the distance and with the bend between them.
fn facing_pairs(ends: &[End], gap_mm: f64) -> Vec<(f64, usize, usize)> {
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by(|&a, &b| ends[a].p.x.total_cmp(&ends[b].p.x).then(a.cmp(&b)));
    let mut pairs = Vec::new();
    for (i, &a) in order.iter().enumerate() {
        // Ends are sorted by x, so only those within the gap are compared.
        for &b in order[i + 1..].iter().take_while(|&&b| ends[b].p.x - ends[a].p.x <= gap_mm) {
            let (ea, eb) = (&ends[a], &ends[b]);
            let d = eb.p - ea.p;
            let gap = d.length();
            if ea.curve == eb.curve || gap > gap_mm {
                continue;
            }
            let opposite = -ea.outwards.dot(eb.outwards);
            let u = if gap > 1e-9 { d / gap } else { ea.outwards };
            let ahead = ea.outwards.dot(u).min(-eb.outwards.dot(u));
            // 0.85 is the cosine of 32 degrees: the ends must face each other and lie ahead of each
            // other.
            if opposite > 0.85 && ahead > 0.85 {
                pairs.push((gap * (2.0 - ahead), a.min(b), a.max(b)));
            }
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canny::{CannySettings, canny};
    use crate::metric::MetricImage;
    use crate::raster::Grey;

    const SETTINGS: CurveSettings =
        CurveSettings { join: Join::Trace, max_turn_rad: 1.0, bridge_mm: 1.0, min_length_mm: 3.0 };

    #[test]
    fn a_ring_and_a_line_stay_what_they_are() {
        let grey = Grey::from_fn(200, 120, |x, y| {
            let d = ((x as f64 - 60.0).powi(2) + (y as f64 - 60.0).powi(2)).sqrt();
            if d < 30.0 || x > 150 { 1.0 } else { 0.0 }
        })
        .blurred(1.2);
        let image = MetricImage { grey, min_mm: DVec2::ZERO, px_mm: 1.0 };
        let edges = canny(&image.grey, &CannySettings::default());
        let curves = edge_curves(&edges, &image, &CurveSettings { bridge_mm: 4.0, ..SETTINGS });
        assert_eq!(curves.len(), 2, "{:?}", curves.iter().map(|c| length_mm(c, false)).collect::<Vec<_>>());
        assert!((length_mm(&curves[0], false) - 60.0 * std::f64::consts::PI).abs() < 6.0);
    }
}
