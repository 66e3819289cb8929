//! One section of a mesh: from crossed triangles to a region.
//!
//! Every triangle that crosses the plane gives one segment, from the side that goes down through
//! the plane to the one that goes up, so that the inside lies on its left. Segments are named by
//! the mesh edges at their ends; following equal names gives closed contours without comparing
//! coordinates. A vertex on the plane counts as above it, so a plane never meets a vertex, an edge
//! or a face exactly.
//!
//! Damaged meshes leave open chains. They are joined end to start, nearest first. A chain is closed
//! on itself only when no other start is nearer than its own. Every gap that is closed is counted
//! ([`Mended`]) and reported in a warning.
//!
//! The point where an edge crosses the plane is computed from its lower vertex to its higher one,
//! so both its triangles get the same bits. Contours of all shells are united by winding number:
//! overlapping bodies do not cancel and cavities stay. Cost: linear in the crossed triangles, but
//! for joining open chains, which is quadratic in their number.

use grainpath_core::Bounds2;
use grainpath_core::poly::{FillRule, simplify_contour};
use grainpath_core::{Contour, DVec2, Diagnostics, Region, TriMesh, WarningId};

use super::SliceSettings;

/// The triangles that each plane crosses.
pub struct Buckets {
    starts: Vec<usize>,
    triangles: Vec<u32>,
}

impl Buckets {
    /// Sorts triangles by the planes they cross: 4 bytes for each crossing.
    pub fn new(mesh: &TriMesh, planes: &[f64]) -> Self {
        // A plane is crossed when a vertex lies below it and another on or above it.
        let range = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize].z);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            (planes.partition_point(|&p| p <= low), planes.partition_point(|&p| p <= high))
        };
        // Two passes over the triangles, counting and then filling, need no growing list for each
        // plane.
        let mut counts = vec![0usize; planes.len() + 1];
        for t in &mesh.triangles {
            let (first, end) = range(t);
            for count in &mut counts[first..end] {
                *count += 1;
            }
        }
        let mut total = 0;
        for count in &mut counts {
            total += std::mem::replace(count, total);
        }
        let starts = counts.clone();
        let mut triangles = vec![0; total];
        for (i, t) in mesh.triangles.iter().enumerate() {
            let (first, end) = range(t);
            for next in &mut counts[first..end] {
                triangles[*next] = i as u32;
                *next += 1;
            }
        }
        Self { starts, triangles }
    }

    /// The triangles that plane `i` crosses, in the mesh's order.
    pub fn triangles(&self, i: usize) -> &[u32] {
        &self.triangles[self.starts[i]..self.starts[i + 1]]
    }
}

/// Gaps that were closed in sections.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mended {
    gaps: usize,
    layers: usize,
    widest_mm: f64,
}

impl Mended {
    /// Adds another section's.
    pub fn add(&mut self, other: &Self) {
        self.gaps += other.gaps;
        self.layers += usize::from(other.gaps > 0);
        self.widest_mm = self.widest_mm.max(other.widest_mm);
    }

    /// Warns if any gap was closed.
    pub fn warn(&self, diagnostics: &Diagnostics) {
        if self.gaps > 0 {
            diagnostics.warn(
                WarningId::MeshOpen,
                format!(
                    "sections: closed {} gaps up to {:.2} mm in {} layers",
                    self.gaps, self.widest_mm, self.layers
                ),
            );
        }
    }
}

/// The mesh edge on which a triangle's side crosses the plane; both its triangles use the same key.
type EdgeKey = u64;

/// A piece of contour inside one triangle. It runs from the side that goes down through the plane
/// to the side that goes up, so that the inside lies on the left.
struct Segment {
    from: EdgeKey,
    to: EdgeKey,
    start: DVec2,
    end: DVec2,
}

/// The region a plane cuts from a mesh, given the triangles it crosses.
pub fn section(mesh: &TriMesh, triangles: &[u32], z: f64, settings: &SliceSettings) -> (Region, Mended) {
    let segments: Vec<Segment> =
        triangles.iter().filter_map(|&t| segment(mesh, mesh.triangles[t as usize], z)).collect();
    let (mut closed, open) = chain(&segments);
    let mended = join(open, settings.gap_closing_mm, &mut closed);
    let contours: Vec<Contour> =
        closed.iter().map(|c| simplified(c, settings.simplify_mm)).filter(|c| c.len() > 2).collect();
    if contours.is_empty() {
        return (Region::default(), mended);
    }
    let mut region = Region::from_contours(&contours, FillRule::NonZero);
    // Areas below a thousandth of a square millimetre cannot hold a bead and are mostly slivers
    // between bodies that touch.
    region.polygons.retain(|p| p.area_mm2() > 1e-3);
    (region, mended)
}

/// Largest tolerance of simplification as a share of a contour's extent. Simplifying cuts a round
/// outline always on the same side, so small holes and screws would lose their size.
const MAX_SIMPLIFY_SHARE: f64 = 1e-3;

fn simplified(contour: &[DVec2], tolerance_mm: f64) -> Contour {
    let extent_mm = Bounds2::of(contour.iter().copied()).map_or(0.0, |b| (b.max - b.min).max_element());
    simplify_contour(contour, tolerance_mm.min(MAX_SIMPLIFY_SHARE * extent_mm))
}

fn segment(mesh: &TriMesh, triangle: [u32; 3], z: f64) -> Option<Segment> {
    let above = triangle.map(|i| mesh.vertices[i as usize].z >= z);
    let (mut from, mut to) = (None, None);
    for k in 0..3 {
        let next = (k + 1) % 3;
        if above[k] != above[next] {
            let crossing = crossing(mesh, triangle[k], triangle[next], z);
            if above[k] { from = Some(crossing) } else { to = Some(crossing) }
        }
    }
    let ((from, start), (to, end)) = (from?, to?);
    Some(Segment { from, to, start, end })
}

/// The edge between two vertices and the point where it crosses the plane, computed from the lower
/// index to the higher so that the bits do not depend on the triangle.
fn crossing(mesh: &TriMesh, a: u32, b: u32, z: f64) -> (EdgeKey, DVec2) {
    let (low, high) = (a.min(b), a.max(b));
    let (p, q) = (mesh.vertices[low as usize], mesh.vertices[high as usize]);
    let t = (z - p.z) / (q.z - p.z);
    (u64::from(low) << 32 | u64::from(high), p.truncate().lerp(q.truncate(), t))
}

/// Follows segments from edge to edge. Returned are closed contours, and open chains where a
/// neighbour is missing.
fn chain(segments: &[Segment]) -> (Vec<Contour>, Vec<Contour>) {
    let starts = Starts::new(segments);
    let ends = |s: &Segment| starts.find(s.to, |_| true).is_some();
    let mut used = vec![false; segments.len()];
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    // Open chains are followed from their first segment. A closed walk could otherwise enter them
    // in the middle and split them.
    let mut follow = |seed: usize, used: &mut Vec<bool>| {
        let mut line = vec![segments[seed].start];
        let mut at = seed;
        loop {
            used[at] = true;
            let s = &segments[at];
            if s.to == segments[seed].from {
                closed.push(line);
                return;
            }
            line.push(s.end);
            match starts.find(s.to, |i| !used[i]) {
                Some(next) => at = next,
                None => {
                    open.push(line);
                    return;
                }
            }
        }
    };
    if !segments.iter().all(ends) {
        let mut incoming: Vec<EdgeKey> = segments.iter().map(|s| s.to).collect();
        incoming.sort_unstable();
        for i in 0..segments.len() {
            if !used[i] && incoming.binary_search(&segments[i].from).is_err() {
                follow(i, &mut used);
            }
        }
    }
    for i in 0..segments.len() {
        if !used[i] {
            follow(i, &mut used);
        }
    }
    (closed, open)
}

/// Segments by the edge they start at: a hash table with open addressing, in which several segments
/// may share a key.
struct Starts<'a> {
    segments: &'a [Segment],
    slots: Vec<u32>,
}

impl<'a> Starts<'a> {
    fn new(segments: &'a [Segment]) -> Self {
        let mut table = Self { segments, slots: vec![u32::MAX; (2 * segments.len()).next_power_of_two()] };
        for (i, s) in segments.iter().enumerate() {
            let mut slot = table.slot(s.from);
            while table.slots[slot] != u32::MAX {
                slot = (slot + 1) & (table.slots.len() - 1);
            }
            table.slots[slot] = i as u32;
        }
        table
    }

    fn slot(&self, key: EdgeKey) -> usize {
        // The odd constant of Fibonacci hashing spreads keys that differ in a few low bits.
        let h = key.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (h >> 32) as usize & (self.slots.len() - 1)
    }

    fn find(&self, key: EdgeKey, allowed: impl Fn(usize) -> bool) -> Option<usize> {
        let mut slot = self.slot(key);
        loop {
            match self.slots[slot] {
                u32::MAX => return None,
                i if self.segments[i as usize].from == key && allowed(i as usize) => return Some(i as usize),
                _ => slot = (slot + 1) & (self.slots.len() - 1),
            }
        }
    }
}

/// Joins open chains end to start, nearest first, until all are closed. A chain is closed on itself
/// only when no other start is nearer than its own.
fn join(mut open: Vec<Contour>, gap_closing_mm: f64, closed: &mut Vec<Contour>) -> Mended {
    let mut mended = Mended::default();
    open.retain(|c| c.len() > 1);
    // In heavily damaged sections, chains shorter than the gaps that are closed anyway are dropped,
    // and the number of the others is bounded: the search for pairs is quadratic.
    if open.len() > 200 {
        open.retain(|c| c[0].distance(c[c.len() - 1]) > gap_closing_mm);
        open.truncate(2000);
    }
    while !open.is_empty() {
        let mut best = (f64::INFINITY, 0, 0);
        for (i, a) in open.iter().enumerate() {
            let end = a[a.len() - 1];
            for (j, b) in open.iter().enumerate() {
                let d = end.distance_squared(b[0]);
                if d < best.0 {
                    best = (d, i, j);
                }
            }
        }
        let (d2, i, j) = best;
        mended.gaps += 1;
        mended.widest_mm = mended.widest_mm.max(d2.sqrt());
        if i == j {
            closed.push(open.swap_remove(i));
        } else {
            let tail = std::mem::take(&mut open[j]);
            open[i].extend(tail);
            open.swap_remove(j);
        }
    }
    mended
}
