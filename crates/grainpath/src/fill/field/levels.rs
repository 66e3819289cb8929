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

use grainpath_core::field_mesh::{FieldMesh, Triangle};
use grainpath_core::phase::Turn;

const NONE: u32 = u32::MAX;

/// A level line.
pub(super) struct Level {
    pub points: Vec<DVec2>,
    pub closed: bool,
}

/// Traces all level lines. They never cross, because the points on a triangle's sides are joined around its
/// corners. At a singular point of the phase one point is left over, and its line ends.
pub(super) fn trace(mesh: &FieldMesh, turns: &[Turn], phase: &[f64]) -> Vec<Level> {
    let found = EdgePoints::new(mesh, turns, phase, TAU, 0.0);
    let mut joints = Joints::new(found.points.len());
    for t in &mesh.triangles {
        let mut count = found.counts(t);
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
                let [a, b] = sides.map(|side| found.corner_point(mesh, t, side, corner, p));
                joints.join(a, b);
            }
        }
    }
    let line = |(line, closed): (Vec<u32>, bool)| Level {
        points: line.into_iter().map(|k| found.points[k as usize]).collect(),
        closed,
    };
    joints.lines().into_iter().map(line).collect()
}

/// The points at which the phase reaches a level, edge after edge.
pub(crate) struct EdgePoints {
    /// The points of edge `e` are those from `starts[e]` to before `starts[e + 1]`, in order from its first end.
    pub(crate) starts: Vec<u32>,
    /// All points, mm.
    pub points: Vec<DVec2>,
}

impl EdgePoints {
    /// Finds the points at which the phase is `k + share` steps of `step_rad`, for any whole `k`.
    pub(crate) fn new(mesh: &FieldMesh, turns: &[Turn], phase: &[f64], step_rad: f64, share: f64) -> Self {
        let mut starts = Vec::with_capacity(mesh.edges.len() + 1);
        let mut points = Vec::new();
        starts.push(0);
        for (edge, turn) in mesh.edges.iter().zip(turns) {
            let [a, b] = edge.ends.map(|k| k as usize);
            let first = off_lines_rad(phase, a);
            let second = off_lines_rad(phase, b) * if turn.mirrored { -1.0 } else { 1.0 };
            let off = second - first - turn.grown_rad;
            // Phases are known only up to whole turns. Of all possible growths along the edge, the one
            // nearest to the growth that the field asks for is taken.
            let grown = turn.grown_rad + off - TAU * (off / TAU).round();
            let (low, high) = (first.min(first + grown), first.max(first + grown));
            let (p, q) = (mesh.nodes[a], mesh.nodes[b]);
            let from = points.len();
            let mut k = (low / step_rad - share).floor() + 1.0;
            // The bound of 64 ends the loop if a phase is not finite. An edge is about one bead long and
            // normally crosses one or two levels.
            while (k + share) * step_rad <= high && points.len() - from < 64 {
                let t = ((k + share) * step_rad - first) / grown;
                points.push(p + t.clamp(0.0, 1.0) * (q - p));
                k += 1.0;
            }
            if grown < 0.0 {
                points[from..].reverse();
            }
            starts.push(points.len() as u32);
        }
        Self { starts, points }
    }

    /// Number of points on each side of a triangle.
    pub(crate) fn counts(&self, triangle: &Triangle) -> [u32; 3] {
        triangle.edges.map(|e| self.starts[e as usize + 1] - self.starts[e as usize])
    }

    /// The `p`-th point of a triangle's side, counted from a corner at one of its ends. Points are stored in
    /// order from the first end of the edge.
    pub(crate) fn corner_point(
        &self,
        mesh: &FieldMesh,
        triangle: &Triangle,
        side: usize,
        corner: usize,
        p: u32,
    ) -> u32 {
        let e = triangle.edges[side] as usize;
        let from_first = mesh.edges[e].ends[0] == triangle.corners[corner];
        if from_first { self.starts[e] + p } else { self.starts[e + 1] - 1 - p }
    }
}

/// The phase at a node with a tiny offset that varies from node to node, so that no node lies on a line.
pub(crate) fn off_lines_rad(phase: &[f64], node: usize) -> f64 {
    phase[node] + 1e-6 * (1.0 + (node % 97) as f64 / 97.0)
}

/// For each point the one or two points that it is joined to.
pub(crate) struct Joints(Vec<[u32; 2]>);

impl Joints {
    /// No joints between `n` points.
    pub(crate) fn new(n: usize) -> Self {
        Self(vec![[NONE; 2]; n])
    }

    /// Joins two points, of which neither has two joints yet.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        for (from, to) in [(a, b), (b, a)] {
            let slot = &mut self.0[from as usize];
            slot[usize::from(slot[0] != NONE)] = to;
        }
    }

    /// The points of each line in order, and whether it is closed. Points without a joint are left out.
    pub(crate) fn lines(&self) -> Vec<(Vec<u32>, bool)> {
        let mut used = vec![false; self.0.len()];
        let mut out = Vec::new();
        let mut follow = |first: usize, closed: bool| {
            let mut line = Vec::new();
            let (mut from, mut at) = (NONE, first as u32);
            while at != NONE && !used[at as usize] {
                used[at as usize] = true;
                line.push(at);
                let [a, b] = self.0[at as usize];
                // A joint has no direction. The walk takes the slot that does not lead back; at the start of
                // a line only one slot is used.
                (from, at) = (at, if a == from && from != NONE { b } else { a });
            }
            if line.len() > 1 {
                out.push((line, closed));
            }
        };
        // Open lines are followed from their ends first; all lines that remain are closed.
        (0..self.0.len()).filter(|&i| self.0[i][1] == NONE).for_each(|i| follow(i, false));
        (0..self.0.len()).for_each(|i| follow(i, true));
        out
    }
}
