//! Level lines of a phase: where it completes a turn.
//!
//! On every edge of the mesh the phase grows linearly from one end to the other; whole turns on it
//! are points of lines. Inside a triangle the points on its three sides are joined around its
//! corners, so level lines never cross. Where the phase misses a turn around a triangle the numbers
//! of points do not match; the point left over is the end of a line.
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
//! Source: the tracing of `Knoppel2015`, section 5, for two-valued axes. Points are exact to
//! rounding; the phase is moved by up to 1e-6 radians per node so that no node lies on a line.
//! Cost: linear in the triangles and in the points.

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

/// Traces all level lines. They never cross: inside a triangle, the points on its sides are joined around its
/// corners; where the phase misses a turn one point stays alone and its line ends.
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
        // A count of lines around a corner is half a difference of the counts on the sides. It is
        // whole and not negative only if no side has more crossings than the other two together,
        // and if the sum is even. Where that fails the longest side gives up crossings: those are
        // the ends of lines.
        if count[most] > others {
            count[most] = others;
        } else if (count[most] + others) % 2 == 1 {
            count[most] -= 1;
        }
        for corner in 0..3 {
            let sides = [(corner + 1) % 3, (corner + 2) % 3];
            // Lines that pass around this corner cross both sides that meet there; every other line crosses one of
            // the two and the opposite side. So the lines around it are half of what the two sides have more.
            let around = (count[sides[0]] + count[sides[1]] - count[corner]) / 2;
            for p in 0..around {
                let [a, b] = sides.map(|side| {
                    let e = t.edges[side] as usize;
                    // Crossings are stored from the first end of an edge onwards; around a corner
                    // they are counted from the corner.
                    let from_first = mesh.edges[e].ends[0] == t.corners[corner];
                    starts[e] + if from_first { p } else { full[side] - 1 - p }
                });
                join(a, b);
            }
        }
    }
    chains(&joined, &points)
}

/// The points where edges meet whole turns: the range of each edge, and the points from its first
/// end onwards.
fn crossings(mesh: &FieldMesh, turns: &[Turn], phase: &[f64]) -> (Vec<u32>, Vec<DVec2>) {
    let mut starts = Vec::with_capacity(mesh.edges.len() + 1);
    let mut points = Vec::new();
    starts.push(0);
    for (edge, turn) in mesh.edges.iter().zip(turns) {
        let [a, b] = edge.ends.map(|k| k as usize);
        // A hair off, so that no node lies on a line.
        let hair = |i: usize| 1e-6 * (1.0 + (i % 97) as f64 / 97.0);
        let first = phase[a] + hair(a);
        let second = if turn.mirrored { -(phase[b] + hair(b)) } else { phase[b] + hair(b) };
        let off = second - first - turn.grown_rad;
        // The phases are known up to whole turns. Of all ways to grow from one end to the other,
        // the one nearest to the growth that the field asks for is meant.
        let grown = turn.grown_rad + off - TAU * (off / TAU).round();
        let (low, high) = (first.min(first + grown), first.max(first + grown));
        let mut levels: Vec<f64> = Vec::new();
        let mut k = (low / TAU).floor() + 1.0;
        // The bound of 64 holds for phases that are not finite as well: one edge is about one bead
        // long and crosses one or two levels.
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

/// Follows the joints from point to point.
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
            // A joint knows no direction. The walk takes the slot that does not lead back; at the
            // start of a line there is only one.
            let next = if a == from && from != NONE { b } else { a };
            (from, at) = (at, next);
        }
        if line.len() > 1 {
            out.push(Level { points: line, closed });
        }
    };
    // Open lines from their ends, then what is left is closed.
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
