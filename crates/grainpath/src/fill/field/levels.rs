//! Traces the level lines of a phase: the lines on which it completes a turn.
//!
//! On every edge of the mesh the phase grows linearly from one end to the other, and each whole turn gives
//! a point. Inside a triangle the points on its three sides are joined around its corners, so level lines
//! never cross. At a singular point of the phase the numbers of points on the three sides do not match; the
//! point that is left over is the end of a line.
//!
//! ```text
//!         c                 sides with 2, 2 and 2 points: two lines around a corner each,
//!        / \                none ends here
//!       o---o
//!      /     \              sides with 2, 1 and 0 points: one line passes,
//!     o-------o             one point is left over and its line ends
//!    a---------b
//! ```
//!
//! Source: the tracing of `Knoppel2015`, section 5, for fields of axes without sign. Points are exact to
//! rounding. The phase is shifted by up to 1e-6 radians at each node, so that no node lies on a line. Cost:
//! linear in the triangles and in the points.

use std::f64::consts::TAU;

use grainpath_core::DVec2;

use super::phase::Turn;
use grainpath_core::field_mesh::FieldMesh;

const NONE: u32 = u32::MAX;

/// A level line.
pub(super) struct Level {
    pub points: Vec<DVec2>,
    pub closed: bool,
}

/// Traces all level lines. They never cross, because the points on a triangle's sides are joined around its
/// corners. At a singular point of the phase one point is left over, and its line ends.
pub(super) fn trace(mesh: &FieldMesh, turns: &[Turn], phase: &[f64]) -> Vec<Level> {
    let (starts, points) = crossings(mesh, turns, phase);
    let mut joined = vec![[NONE; 2]; points.len()];
    let mut join = |a: u32, b: u32| {
        for (from, to) in [(a, b), (b, a)] {
            let slot = &mut joined[from as usize];
            slot[usize::from(slot[0] != NONE)] = to;
        }
    };
    for t in &mesh.triangles {
        let mut count = t.edges.map(|e| starts[e as usize + 1] - starts[e as usize]);
        let full = count;
        let most = (0..3).fold(0, |m, k| if count[k] > count[m] { k } else { m });
        let others = count[(most + 1) % 3] + count[(most + 2) % 3];
        // The number of lines around a corner is (a + b - c) / 2, where a and b count the points on the two
        // sides that meet there, and c those on the opposite side. It is whole and not negative only if no
        // side has more points than the other two together, and the total is even. Otherwise the longest
        // side gives up points, which become ends of lines.
        if count[most] > others {
            count[most] = others;
        } else if (count[most] + others) % 2 == 1 {
            count[most] -= 1;
        }
        for corner in 0..3 {
            let sides = [(corner + 1) % 3, (corner + 2) % 3];
            // A line around this corner crosses both sides that meet there. Every other line crosses one of
            // these two and the opposite side. So the two sides have two points more for each line around
            // the corner.
            let around = (count[sides[0]] + count[sides[1]] - count[corner]) / 2;
            for p in 0..around {
                let [a, b] = sides.map(|side| {
                    let e = t.edges[side] as usize;
                    // Points are stored in order from the first end of an edge, but are counted here from
                    // the corner.
                    let from_first = mesh.edges[e].ends[0] == t.corners[corner];
                    starts[e] + if from_first { p } else { full[side] - 1 - p }
                });
                join(a, b);
            }
        }
    }
    chains(&joined, &points)
}

/// The points at which the phase completes a turn on an edge, in order from the edge's first end, and the
/// range of points of each edge.
fn crossings(mesh: &FieldMesh, turns: &[Turn], phase: &[f64]) -> (Vec<u32>, Vec<DVec2>) {
    let mut starts = Vec::with_capacity(mesh.edges.len() + 1);
    let mut points = Vec::new();
    starts.push(0);
    for (edge, turn) in mesh.edges.iter().zip(turns) {
        let [a, b] = edge.ends.map(|k| k as usize);
        // A tiny offset, so that no node lies on a line.
        let hair = |i: usize| 1e-6 * (1.0 + (i % 97) as f64 / 97.0);
        let first = phase[a] + hair(a);
        let second = if turn.mirrored { -(phase[b] + hair(b)) } else { phase[b] + hair(b) };
        let off = second - first - turn.grown_rad;
        // Phases are known only up to whole turns. Of all possible growths along the edge, the one nearest
        // to the growth that the field asks for is taken.
        let grown = turn.grown_rad + off - TAU * (off / TAU).round();
        let (low, high) = (first.min(first + grown), first.max(first + grown));
        let mut levels: Vec<f64> = Vec::new();
        let mut k = (low / TAU).floor() + 1.0;
        // The bound of 64 ends the loop if a phase is not finite. An edge is about one bead long and
        // normally crosses one or two levels.
        while k * TAU <= high && levels.len() < 64 {
            levels.push((k * TAU - first) / grown);
            k += 1.0;
        }
        if grown < 0.0 {
            levels.reverse();
        }
        let (p, q) = (mesh.nodes[a], mesh.nodes[b]);
        points.extend(levels.into_iter().map(|t| p + t.clamp(0.0, 1.0) * (q - p)));
        starts.push(points.len() as u32);
    }
    (starts, points)
}

/// Connects points to lines by following the joints.
fn chains(joined: &[[u32; 2]], points: &[DVec2]) -> Vec<Level> {
    let mut used = vec![false; points.len()];
    let mut out = Vec::new();
    let mut follow = |first: usize, closed: bool| {
        let mut line = Vec::new();
        let (mut from, mut at) = (NONE, first as u32);
        while at != NONE && !used[at as usize] {
            used[at as usize] = true;
            line.push(points[at as usize]);
            let [a, b] = joined[at as usize];
            // A joint has no direction. The walk takes the slot that does not lead back; at the start of a
            // line only one slot is used.
            let next = if a == from && from != NONE { b } else { a };
            (from, at) = (at, next);
        }
        if line.len() > 1 {
            out.push(Level { points: line, closed });
        }
    };
    // Open lines are followed from their ends first; all lines that remain are closed.
    for (i, j) in joined.iter().enumerate() {
        if j[0] != NONE && j[1] == NONE {
            follow(i, false);
        }
    }
    for (i, j) in joined.iter().enumerate() {
        if j[1] != NONE {
            follow(i, true);
        }
    }
    out
}
