//! The tree that joins cells: it decides at which edges cells are joined, and where strips are cut.
//!
//! Method: Kruskal's minimum spanning tree (`Kruskal1956`) over the cells. The weight of an edge is
//! the angle to the field that its joint adds to the path, times the length and the field's weight at
//! that place. Two rules of the published method (`ContinuousPath`) hold: follow the field where
//! possible, and avoid an edge that is the shortest edge of both its cells unless nothing else joins
//! them.
//!
//! [`TreeKind::Undirected`] takes the weight of an edge from a hash. It is the baseline for comparison: the
//! directed tree is 20 to 92 % better on ten sections (`cargo xtask bench continuous`). Edges of equal
//! weight are ordered by their number, so the tree does not depend on threads. Cost: sorting the edges, n
//! log n.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use grainpath_core::DVec2;
use grainpath_core::DisjointSets;
use grainpath_core::hash;
use grainpath_core::math::{atan2, cross};
use grainpath_core::tuned::Tuned;

use super::cells::{Cells, Edge, MARK, TAKEN_HALF, Taken, beside};
use super::rings::{Facing, Rings, Side};
use crate::fill::Shift;

/// How the edges between cells are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TreeKind {
    /// By the angle between the field and the beads of the joint.
    Directed,
    /// By a hash: an arbitrary tree on the same cells, as a baseline for comparison.
    Undirected,
}

/// The axis of the field at a point, and its weight there.
pub(super) type Axis<'a> = &'a dyn Fn(DVec2) -> (DVec2, f64);

/// Angle between an axis (without sign) and a path segment, radians, times the segment's length.
fn turned(axis: DVec2, way: DVec2) -> f64 {
    atan2(cross(axis, way).abs(), axis.dot(way).abs()) * way.length()
}

/// The cost of an exchange: the angle to the field times the length that it adds to the path, radians times
/// mm, weighted.
fn cost(f: &Facing, axis: Axis<'_>) -> f64 {
    let [a0, a1, b0, b1] = f.corners;
    let (u, weight) = axis(0.25 * (a0 + a1 + b0 + b1));
    weight * (turned(u, b1 - a0) + turned(u, a1 - b0) - turned(u, a1 - a0) - turned(u, b1 - b0))
}

/// Estimates [`cost`] from the middles of the two beads at an edge, without searching for the
/// stretches.
fn guess(e: &Edge, spacing_mm: f64, axis: Axis<'_>) -> f64 {
    // This is called for every edge of the region, most of which the tree never uses, so it has to be fast.
    let way = e.ends[1] - e.ends[0];
    let (u, weight) = axis(0.5 * (e.ends[0] + e.ends[1]));
    // The arctangent to within 0.004 radians: atan t = pi/4 t + 0.273 t (1 - t), with t the smaller
    // component over the larger one.
    let (across, along) = (cross(u, way).abs(), u.dot(way).abs());
    let t = across.min(along) / across.max(along).max(f64::MIN_POSITIVE);
    let small = t * (FRAC_PI_4 + 0.273 * (1.0 - t));
    let angle = if across > along { FRAC_PI_2 - small } else { small };
    // Two connections across are added, and two stretches along, each one spacing long, are removed.
    2.0 * weight * (angle * way.length() - (FRAC_PI_2 - angle) * spacing_mm)
}

/// Packs two numbers into one, with the smaller number in the high bits.
fn pair([a, b]: [u32; 2]) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// An edge and its weight as one number for sorting. Edges marked `last` come after all others; then the
/// weight decides, then the edge's number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Ranked(u64);

impl Ranked {
    fn new(last: bool, weight: f64, edge: usize) -> Self {
        let bits = (weight as f32).to_bits();
        // The bits of a float sort like an integer if all bits of negative numbers are flipped, and the
        // sign bit of positive ones is set.
        let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
        Self(u64::from(last) << 63 | u64::from(ordered) << 31 | edge as u64)
    }

    fn edge(self) -> usize {
        (self.0 & ((1 << 31) - 1)) as usize
    }
}

/// Joins all cells into a tree of least weight, under two rules of the published method: follow the field
/// where possible, and avoid an edge that is the shortest edge of both its cells. The second rule
/// does not apply to cuts across a strip, because cells are long and the field passes through their short
/// edges. It also gives way where nothing else joins two cells.
pub(super) fn join(
    rings: &Rings,
    cells: &Cells,
    kind: TreeKind,
    spacing_mm: f64,
    shift: Shift,
    axis: Axis<'_>,
    taken: &mut Taken,
) -> Vec<Facing> {
    let mut short = shortest_of_both(cells, spacing_mm);
    // Joints of other turns are made last too.
    for (short, e) in short.iter_mut().zip(&cells.edges).filter(|(_, e)| e.cut.is_none()) {
        *short |= !shift.may_join(0.5 * (e.ends[0] + e.ends[1]));
    }
    let weight = |(i, e): (usize, &Edge)| match (kind, e.cut) {
        (TreeKind::Undirected, _) => hash::unit_interval(i as u64),
        (TreeKind::Directed, Some(k)) => -cost(&cells.cuts[k as usize], axis),
        (TreeKind::Directed, None) => guess(e, spacing_mm, axis),
    };
    let rank = |(i, e): (usize, &Edge)| Ranked::new(short[i], weight((i, e)), i);
    let mut order: Vec<Ranked> = cells.edges.iter().enumerate().map(rank).collect();
    order.sort_unstable();
    let mut sets = DisjointSets::new(cells.n);
    let mut exchanges = Vec::new();
    for &ranked in &order {
        let e = &cells.edges[ranked.edge()];
        let [a, b] = e.cells;
        match e.cut {
            Some(k) => {
                // If the tree passes a cut, the strip stays whole there and nothing is exchanged. If it
                // does not pass, the stretches at the cut are exchanged and the strip ends in two caps.
                if !sets.union(a as usize, b as usize) {
                    exchanges.push(cells.cuts[k as usize]);
                }
            }
            None => {
                // A second joint between the same two sets would split the ring in two again.
                if sets.together(a as usize, b as usize) {
                    continue;
                }
                let Some(f) = beside(rings, e).filter(|f| taken.fits(f, TAKEN_HALF.value() * spacing_mm))
                else {
                    continue;
                };
                taken.take_both(&f, TAKEN_HALF.value() * spacing_mm);
                sets.union(a as usize, b as usize);
                exchanges.push(f);
            }
        }
    }
    exchanges
}

/// For each edge between two strips, whether it is the shortest of both its cells.
fn shortest_of_both(cells: &Cells, spacing_mm: f64) -> Vec<bool> {
    let mut by_pair: Vec<(u64, u32)> =
        cells.edges.iter().enumerate().map(|(i, e)| (pair(e.cells), i as u32)).collect();
    by_pair.sort_unstable();
    // An edge between two strips was found at each place along it, and from both sides. So its length is
    // half the number of places times their distance.
    let length = |group: &[(u64, u32)]| {
        let across = group.iter().any(|&(_, i)| cells.edges[i as usize].cut.is_some());
        if across { 2.0 * spacing_mm } else { 0.5 * cells.place_mm * group.len() as f64 }
    };
    let mut least = vec![f64::INFINITY; cells.n];
    for group in by_pair.chunk_by(|a, b| a.0 == b.0) {
        for c in cells.edges[group[0].1 as usize].cells {
            least[c as usize] = least[c as usize].min(length(group));
        }
    }
    let mut out = vec![false; cells.edges.len()];
    for group in by_pair.chunk_by(|a, b| a.0 == b.0) {
        let l = length(group);
        let of_both = cells.edges[group[0].1 as usize].cells.iter().all(|&c| l <= least[c as usize]);
        for &(_, i) in group {
            out[i as usize] = of_both && cells.edges[i as usize].cut.is_none();
        }
    }
    out
}

/// Factor on the greatest distances at which beads are joined last: 1.6, then 2.3, then 3.2 beads. Measured: row
/// `fill.continuous.tree.REST_MAX` of `cargo xtask bench constants`.
static REST_MAX: Tuned<f64> = Tuned::new("fill.continuous.tree.REST_MAX", 1.0);
/// Factor on the distances between the places that are tried for the last joints: 4 beads, then 0.4 beads. Measured:
/// row `fill.continuous.tree.REST_STEP` of `cargo xtask bench constants`.
static REST_STEP: Tuned<f64> = Tuned::new("fill.continuous.tree.REST_STEP", 1.0);
/// Short joints reach this far, in beads. Measured: row `fill.continuous.tree.SHORT_FAR` of `cargo xtask bench
/// constants`.
static SHORT_FAR: Tuned<f64> = Tuned::new("fill.continuous.tree.SHORT_FAR", 2.5);

/// Finds joints for rings that are still apart. The search becomes closer and wider until all are joined or
/// all ranges are tried. It does not start from the longest ring, which all others can see.
pub(super) fn join_rest(rings: &Rings, spacing_mm: f64) -> Vec<Facing> {
    let n = rings.lines.len();
    let longest = rings.longest();
    let mut sets = DisjointSets::new(n);
    let mut taken = Taken::new(rings, MARK.value() * spacing_mm);
    let mut exchanges = Vec::new();
    let look =
        |found: Vec<Facing>, sets: &mut DisjointSets, taken: &mut Taken, exchanges: &mut Vec<Facing>| {
            for f in found {
                let [a, b] = [f.one_ring, f.other_ring].map(|r| sets.lowest(r));
                // The ends of two joints lie a mark apart at least, so that the connections do not touch.
                let around_mm = f.half_mm + MARK.value() * spacing_mm;
                let free = || taken.fits(&f, around_mm) && !exchanges.iter().any(|e| e.crosses(&f));
                if a != b && free() {
                    taken.take_both(&f, around_mm);
                    sets.union(a, b);
                    exchanges.push(f);
                }
            }
        };
    // Long steps come first, because any place will do where long rings run side by side. Then follow
    // closer steps and wider ranges, and at last short joints.
    for (most, step) in [(Some(1.6), 4.0), (Some(1.6), 0.4), (Some(2.3), 0.4), (Some(3.2), 0.4), (None, 0.4)]
    {
        let range = most.map(|most| [0.0, most * REST_MAX.value()]);
        let step = step * REST_STEP.value();
        for ring in (0..n).filter(|&r| r != longest) {
            let length = rings.length_mm(ring);
            let steps = (length / (step * spacing_mm)).ceil().max(1.0);
            for k in 0..steps as usize {
                // A ring joined to the longest one needs no search: rings still apart can see it.
                if sets.together(ring, longest) {
                    break;
                }
                let at_mm = length * (k as f64 + 0.5) / steps;
                let found = match range {
                    Some(range) => [Side::Right, Side::Left]
                        .into_iter()
                        .filter_map(|side| rings.stretches(ring, at_mm, side, range, None))
                        .collect(),
                    None => rings.short_joints(ring, at_mm, SHORT_FAR.value()),
                };
                look(found, &mut sets, &mut taken, &mut exchanges);
            }
        }
    }
    exchanges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_sort_by_weight_and_know_their_edge() {
        let weights = [-1e9, -2.5, -1e-3, 0.0, 1e-3, 0.75, 3.0, f64::MAX];
        let mut ranks: Vec<Ranked> = Vec::new();
        for last in [false, true] {
            ranks.extend(weights.iter().enumerate().map(|(i, w)| Ranked::new(last, *w, 1_000_000 * i)));
        }
        let sorted = {
            let mut all = ranks.clone();
            all.reverse();
            all.sort_unstable();
            all
        };
        assert!(sorted == ranks);
        for (k, rank) in ranks.iter().enumerate() {
            assert_eq!(rank.edge(), 1_000_000 * (k % weights.len()));
        }
        assert!(Ranked::new(false, 1.0, 3) < Ranked::new(false, 1.0, 4));
    }
}
