//! The tree that joins cells: which edges are passed, and which strips are cut.

use grainpath_core::DVec2;
use grainpath_core::math::atan2;
use grainpath_core::math::cross;

use super::cells::{Cells, Edge, Taken, beside};
use super::rings::{Facing, Rings, Side};

/// How edges are weighed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TreeKind {
    /// By how far beads are turned out of the field's direction where they pass.
    #[default]
    Directed,
    /// By nothing: a tree like any other on these cells.
    Undirected,
}

/// The axis of the field at a point, and how much it matters there.
pub type Axis<'a> = &'a dyn Fn(DVec2) -> (DVec2, f64);

/// Angle between an undirected axis and a way, radians, times the way's length.
fn turned(axis: DVec2, way: DVec2) -> f64 {
    atan2(cross(axis, way).abs(), axis.dot(way).abs()) * way.length()
}

/// What an exchange adds to the path's angle to the field, times length.
pub fn cost(f: &Facing, axis: Axis<'_>) -> f64 {
    let [a0, a1, b0, b1] = f.corners;
    let (u, weight) = axis(0.25 * (a0 + a1 + b0 + b1));
    weight * (turned(u, b1 - a0) + turned(u, a1 - b0) - turned(u, a1 - a0) - turned(u, b1 - b0))
}

/// The same, guessed from the middles of both beads at an edge.
fn guess(e: &Edge, spacing_mm: f64, axis: Axis<'_>) -> f64 {
    let way = e.ends[1] - e.ends[0];
    let (u, weight) = axis(0.5 * (e.ends[0] + e.ends[1]));
    let along = way.perp().normalize_or(DVec2::X) * spacing_mm;
    2.0 * weight * (turned(u, way) - turned(u, along))
}

/// Numbers in [0, 1) that look like chance and are always the same.
fn shuffled(i: usize) -> f64 {
    let mut x = (i as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

struct Sets(Vec<u32>);

impl Sets {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}

/// Joins all cells as a tree of least weight.
pub fn join(
    rings: &Rings,
    cells: &Cells,
    kind: TreeKind,
    spacing_mm: f64,
    axis: Axis<'_>,
    taken: &mut Taken,
) -> Vec<Facing> {
    let weight = |(i, e): (usize, &Edge)| match (kind, e.cut) {
        (TreeKind::Undirected, _) => shuffled(i),
        (TreeKind::Directed, Some(k)) => -cost(&cells.cuts[k as usize], axis),
        (TreeKind::Directed, None) => guess(e, spacing_mm, axis),
    };
    let weights: Vec<f64> = cells.edges.iter().enumerate().map(weight).collect();
    let mut order: Vec<u32> = (0..cells.edges.len() as u32).collect();
    order.sort_by(|&a, &b| weights[a as usize].total_cmp(&weights[b as usize]).then(a.cmp(&b)));
    let mut sets = Sets((0..cells.n as u32).collect());
    let mut exchanges = Vec::new();
    for i in order {
        let e = &cells.edges[i as usize];
        let [a, b] = e.cells;
        match e.cut {
            Some(k) => {
                if !sets.join(a, b) {
                    exchanges.push(cells.cuts[k as usize]);
                }
            }
            None => {
                if sets.root(a) == sets.root(b) {
                    continue;
                }
                let Some(f) = beside(rings, e).filter(|f| taken.fits(f, 0.6 * spacing_mm)) else { continue };
                taken.take_both(&f, 0.6 * spacing_mm);
                sets.join(a, b);
                exchanges.push(f);
            }
        }
    }
    exchanges
}

/// Where rings that are still apart may be joined, sought more closely and further; as many as it takes. What faces
/// the longest ring sees it: it need not look for itself.
pub fn join_rest(rings: &Rings, spacing_mm: f64) -> Vec<Facing> {
    let n = rings.lines.len();
    let longest = (0..n).fold(0, |m, r| if rings.length_mm(r) > rings.length_mm(m) { r } else { m });
    let mut sets = Sets((0..n as u32).collect());
    let mut taken = Taken::new(rings, 0.25 * spacing_mm);
    let mut exchanges = Vec::new();
    for range in [[0.5, 1.6], [0.35, 2.3], [0.2, 3.2]] {
        for ring in (0..n).filter(|&r| r != longest) {
            let length = rings.length_mm(ring);
            let steps = (length / (0.4 * spacing_mm)).ceil().max(1.0);
            for k in 0..steps as usize {
                let at_mm = length * (k as f64 + 0.5) / steps;
                for side in [Side::Right, Side::Left] {
                    let Some((other, _)) = rings.facing(ring, at_mm, side, range) else { continue };
                    if sets.root(ring as u32) == sets.root(other.ring as u32) {
                        continue;
                    }
                    let Some(f) = rings.stretches(ring, at_mm, side, range) else { continue };
                    if taken.fits(&f, 0.6 * spacing_mm) {
                        taken.take_both(&f, 0.6 * spacing_mm);
                        sets.join(f.one_ring as u32, f.other_ring as u32);
                        exchanges.push(f);
                    }
                }
            }
        }
    }
    exchanges
}
