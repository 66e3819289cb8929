//! A phase that turns once per bead across the field.
//!
//! Every node carries a unit complex number. Along an edge it should turn by the edge's length across the field, in
//! beads. A field with curl cannot be followed everywhere; where it cannot, the phase has a point around which it
//! misses a turn, and there a bead ends. Such a phase is found by diffusing the numbers along the edges and scaling
//! them back to unit length, again and again: the diffusion evens out, the scaling keeps every place equal. The sign
//! of the axis is free at every node: across an edge whose ends disagree the number is mirrored.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, cross, sin_cos};

use crate::field_mesh::{FieldMesh, conjugate_gradients};

/// What the phase is made from, node by node.
pub struct PhaseInput {
    /// Unit vectors along the field; the sign does not matter.
    pub axes: Vec<DVec2>,
    /// Turns per mm across it.
    pub frequency: Vec<f64>,
    /// Phase wanted here, with the sign of the node's normal, and how strongly; weight 0 for none.
    pub wanted: Vec<(f64, f64)>,
}

/// How an edge turns the number of its first end into that of its second.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// Phase grown from the first end to the second, in the frame of the first.
    pub grown_rad: f64,
    /// Whether the second end looks the other way.
    pub mirrored: bool,
}

/// Steps of diffusion, widest first, in squares of the grid.
pub const STEPS: [(f64, usize); 3] = [(60.0, 6), (25.0, 6), (8.0, 6)];
/// The spacing may drift from the nominal one by this factor before beads end or begin.
const MAX_DRIFT: f64 = 1.22;
/// Spacing drifts back to the nominal one over about this length, mm.
const DRIFT_MM: f64 = 12.0;

/// How much closer or wider the beads should be at every node so that as few as possible have to end: the factor on
/// the frequency, within [`MAX_DRIFT`].
pub fn drift(mesh: &FieldMesh, axes: &[DVec2]) -> Vec<f64> {
    let n = mesh.nodes.len();
    // Along a line, the logarithm of the frequency falls by the divergence of the axis: three values a triangle.
    let mut rows: Vec<([u32; 3], [f64; 3], f64)> = Vec::with_capacity(mesh.triangles.len());
    for t in &mesh.triangles {
        let [a, b, c] = t.corners.map(|k| k as usize);
        let p = [mesh.nodes[a], mesh.nodes[b], mesh.nodes[c]];
        let double = cross(p[1] - p[0], p[2] - p[0]);
        let gradient = |k: usize| {
            let edge = p[(k + 2) % 3] - p[(k + 1) % 3];
            DVec2::new(-edge.y, edge.x) / double
        };
        let gradients = [gradient(0), gradient(1), gradient(2)];
        let first = axes[a];
        let same = |v: DVec2| if v.dot(first) < 0.0 { -v } else { v };
        let t_axes = [first, same(axes[b]), same(axes[c])];
        let mean = t_axes[0] + t_axes[1] + t_axes[2];
        let length = mean.length();
        // Near a singular point of the field there is no divergence to speak of.
        if length < 2.4 {
            continue;
        }
        let mean = mean / length;
        let divergence: f64 = (0..3).map(|k| gradients[k].dot(t_axes[k])).sum();
        rows.push((t.corners, gradients.map(|g| g.dot(mean)), -divergence));
    }
    let cell2 = mesh.cell_mm * mesh.cell_mm;
    let keep = cell2 / (DRIFT_MM * DRIFT_MM);
    let apply = |x: &[f64], y: &mut [f64]| {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = keep * x);
        for (corners, g, _) in &rows {
            let slope: f64 = (0..3).map(|k| g[k] * x[corners[k] as usize]).sum();
            (0..3).for_each(|k| y[corners[k] as usize] += 0.5 * cell2 * slope * g[k]);
        }
        // A little smoothing across the lines too.
        for e in mesh.edges.iter().filter(|e| !e.diagonal) {
            let [a, b] = e.ends.map(|k| k as usize);
            let d = 0.02 * (x[a] - x[b]);
            y[a] += d;
            y[b] -= d;
        }
    };
    let mut rhs = vec![0.0; n];
    for (corners, g, value) in &rows {
        (0..3).for_each(|k| rhs[corners[k] as usize] += 0.5 * cell2 * value * g[k]);
    }
    let x = conjugate_gradients(vec![0.0; n], &rhs, apply, 1e-3, 300);
    let limit = MAX_DRIFT - 1.0;
    x.into_iter().map(|v| 1.0 + v / (1.0 + (v / limit).powi(2)).sqrt()).collect()
}

/// What each edge does to a phase.
pub fn turns(mesh: &FieldMesh, input: &PhaseInput) -> Vec<Turn> {
    let normal = |i: usize| {
        let t = input.axes[i];
        input.frequency[i] * DVec2::new(-t.y, t.x)
    };
    let turn = |ends: [u32; 2]| {
        let [a, b] = ends.map(|k| k as usize);
        let mirrored = input.axes[a].dot(input.axes[b]) < 0.0;
        let other = if mirrored { -normal(b) } else { normal(b) };
        let grown_rad = 0.5 * TAU * (normal(a) + other).dot(mesh.nodes[b] - mesh.nodes[a]);
        Turn { grown_rad, mirrored }
    };
    mesh.edges.iter().map(|e| turn(e.ends)).collect()
}

/// A neighbour and how its number is seen from here.
#[derive(Clone, Copy)]
struct Seen {
    node: u32,
    mirrored: bool,
    cos: f64,
    sin: f64,
}

impl Seen {
    fn from(self, z: &[[f64; 2]]) -> [f64; 2] {
        let [x, y] = z[self.node as usize];
        let y = if self.mirrored { -y } else { y };
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }
}

/// The phase at every node, radians, after these steps of diffusion: width in squares of the grid, and how often.
pub fn solve(mesh: &FieldMesh, input: &PhaseInput, turns: &[Turn], steps: &[(f64, usize)]) -> Vec<f64> {
    let n = mesh.nodes.len();
    let mut starts = vec![0u32; n + 1];
    let axis_edges = || mesh.edges.iter().zip(turns).filter(|(e, _)| !e.diagonal);
    axis_edges().for_each(|(e, _)| e.ends.iter().for_each(|&k| starts[k as usize + 1] += 1));
    (0..n).for_each(|i| starts[i + 1] += starts[i]);
    let mut next = starts.clone();
    let mut seen = vec![Seen { node: 0, mirrored: false, cos: 1.0, sin: 0.0 }; starts[n] as usize];
    for (e, turn) in axis_edges() {
        let [a, b] = e.ends;
        let mut add = |at: u32, node: u32, angle: f64| {
            let (sin, cos) = sin_cos(angle);
            let slot = &mut next[at as usize];
            seen[*slot as usize] = Seen { node, mirrored: turn.mirrored, cos, sin };
            *slot += 1;
        };
        // In the frame of the second end a mirrored phase grows downwards.
        let to_b = if turn.mirrored { -turn.grown_rad } else { turn.grown_rad };
        add(b, a, to_b);
        add(a, b, -turn.grown_rad);
    }
    let around = |i: usize| &seen[starts[i] as usize..starts[i + 1] as usize];
    let wanted: Vec<([f64; 2], f64)> = input
        .wanted
        .iter()
        .map(|&(rad, weight)| {
            let (s, c) = sin_cos(rad);
            ([c, s], weight)
        })
        .collect();
    let mut z = swept(n, &around, &wanted);
    for &(width, times) in steps {
        let apply = |x: &[f64], y: &mut [f64]| {
            let x: &[[f64; 2]] = as_pairs(x);
            for i in 0..n {
                let mut sum = [0.0; 2];
                let all = around(i);
                for s in all {
                    let v = s.from(x);
                    sum = [sum[0] + v[0], sum[1] + v[1]];
                }
                let own = 1.0 + width * (all.len() as f64 + wanted[i].1);
                y[2 * i] = own * x[i][0] - width * sum[0];
                y[2 * i + 1] = own * x[i][1] - width * sum[1];
            }
        };
        for _ in 0..times {
            let mut rhs = Vec::with_capacity(2 * n);
            for (v, (want, weight)) in z.iter().zip(&wanted) {
                rhs.extend([0, 1].map(|k| v[k] + width * weight * want[k]));
            }
            let x = conjugate_gradients(z.iter().flatten().copied().collect(), &rhs, apply, 2e-3, 60);
            for (v, w) in z.iter_mut().zip(as_pairs(&x)) {
                let length = (w[0] * w[0] + w[1] * w[1]).sqrt();
                if length > 1e-9 {
                    *v = [w[0] / length, w[1] / length];
                }
            }
        }
    }
    z.into_iter().map(|[x, y]| atan2(y, x)).collect()
}

fn as_pairs(x: &[f64]) -> &[[f64; 2]] {
    x.as_chunks::<2>().0
}

/// A first phase: carried from node to node, outwards from one.
fn swept<'a>(n: usize, around: &impl Fn(usize) -> &'a [Seen], wanted: &[([f64; 2], f64)]) -> Vec<[f64; 2]> {
    let mut z = vec![[0.0; 2]; n];
    let mut reached = vec![false; n];
    let mut queue = VecDeque::new();
    for first in (0..n).map(|k| (k + n / 2) % n) {
        if reached[first] {
            continue;
        }
        reached[first] = true;
        queue.push_back(first);
        while let Some(i) = queue.pop_front() {
            let (want, weight) = wanted[i];
            let mut sum = [weight * want[0], weight * want[1]];
            for s in around(i) {
                // Nodes not reached yet are zero and add nothing.
                let v = s.from(&z);
                sum = [sum[0] + v[0], sum[1] + v[1]];
                if !reached[s.node as usize] {
                    reached[s.node as usize] = true;
                    queue.push_back(s.node as usize);
                }
            }
            let length = (sum[0] * sum[0] + sum[1] * sum[1]).sqrt();
            z[i] = if length > 1e-9 { [sum[0] / length, sum[1] / length] } else { [1.0, 0.0] };
        }
    }
    z
}
