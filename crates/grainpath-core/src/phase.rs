//! Finds a phase that makes one turn per bead across the field.
//!
//! Every node of the mesh has a unit complex number whose argument is the phase. Along an edge the phase
//! should grow by the edge's extent across the field, in beads. A field with curl cannot be followed
//! everywhere: the phase then has singular points, around which a turn is missing and at which a bead ends.
//!
//! Method: stripe patterns (`Knoppel2015`). The sign of the axis is free at every node, so the number is
//! conjugated along an edge whose ends have opposite signs. The paper minimises the energy by an eigenvalue
//! problem. Here an implicit step of diffusion alternates with scaling every number to unit length
//! (Merriman, Bence and Osher's scheme for Ginzburg-Landau energies (`Viertel2019`)). The scaling keeps
//! all places equal. The eigenvector of the paper fades where the field is hard to follow, so that rounding
//! would decide on the beads there.
//!
//! ```text
//!    axis ->  ================   level 2   phase 4 pi
//!             ----------------             phase 3 pi
//!             ================   level 1   phase 2 pi      a bead runs on every level
//!             ----------------             phase   pi
//!             ================   level 0   phase 0
//! ```
//!
//! Before the phase is solved, [`drift`] varies the spacing slowly along the field, so that fewer beads
//! have to end.
//!
//! The spacing is found on squares twice as large, and the wide steps of the phase can be taken on such ([`Diffusion::n_coarse`]), in a
//! quarter of the time; the phase of every second node is then carried to those between.
//!
//! Units: nodes in mm, frequency in turns per mm, phase in radians. Cost: each round of diffusion takes
//! at most 60 conjugate gradient iterations in `f32`; each is linear in the nodes. Degenerate cases: a region
//! in several pieces is swept piece by piece; a node whose neighbours cancel each other keeps its last
//! phase. The same input gives the same bits, because no step depends on threads.
//!
//! The figure shows a field that fans out. Where one more bead fits in, a turn is missing and a level begins.
//!
#![doc = include_str!("figures/phase.svg")]

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::ops::Range;

use crate::DVec2;
use crate::math::{atan2, cross, sin_cos};

use crate::conjugate_gradients::{CgSettings, conjugate_gradients};
use crate::field_mesh::{Coarser, FieldMesh, GridMatrix};
use crate::lanes::{Complex, ComplexMut, Turns, multiply_f32, take_carried_back, take_carried_on};
use crate::tuned::Tuned;

/// Input for the phase, with one entry for each node.
pub struct PhaseInput {
    /// Unit vectors along the field; the sign does not matter.
    pub axes: Vec<DVec2>,
    /// Turns of the phase per mm across the field.
    pub frequency: Vec<f64>,
    /// Weight of the field, above 0. Singular points of the phase arise first where the weight is small.
    pub strength: Vec<f64>,
    /// Phase wanted at the node, radians, with the sign of the node's normal, and its weight. A weight of 0
    /// means that no phase is wanted.
    pub wanted: Vec<(f64, f64)>,
}

/// How the complex number at an edge's first end is carried to its second end.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// Growth of the phase from the first end to the second, radians, for the sign of the axis at the first end.
    pub grown_rad: f64,
    /// Whether the axis at the second end has the opposite sign.
    pub mirrored: bool,
}

/// The spacing may differ from the nominal one by this factor before beads end or begin. It lies well
/// inside the widths that a nozzle can lay, 0.6 to 1.6 of the nominal one. Measured: row
/// `core.phase.MAX_DRIFT` of `cargo xtask bench constants`.
static MAX_DRIFT: Tuned<f64> = Tuned::new("core.phase.MAX_DRIFT", 1.22);
/// Length over which the spacing returns to the nominal one, mm.
/// Measured: row `core.phase.DRIFT_MM` of `cargo xtask bench constants`.
static DRIFT_MM: Tuned<f64> = Tuned::new("core.phase.DRIFT_MM", 12.0);

/// Stiffness with which neighbouring nodes get the same spacing whatever the direction, so that it is smooth across the
/// lines too. That along the lines is about 1. Measured: row `core.phase.ACROSS` of `cargo xtask bench
/// constants`.
static ACROSS: Tuned<f64> = Tuned::new("core.phase.ACROSS", 0.02);
/// A triangle has a divergence where the sum of the three axes at its corners is at least this long. Measured: row
/// `core.phase.LEAST_SUM` of `cargo xtask bench constants`.
static LEAST_SUM: Tuned<f64> = Tuned::new("core.phase.LEAST_SUM", 2.4);
/// Most steps of the solver in a round of diffusion. Measured: row `core.phase.STEPS` of `cargo xtask bench
/// constants`.
static STEPS: Tuned<usize> = Tuned::new("core.phase.STEPS", 60);
/// Most steps of the solver for the spacing. Source: derived. The spacing spreads over [`DRIFT_MM`], about 30 squares
/// of 0.4 mm, and a step of conjugate gradients reaches one square further; ten times as many are enough.
const DRIFT_STEPS: usize = 300;

/// Factor on the frequency at every node, within `MAX_DRIFT`, chosen so that as few beads as possible have
/// to end. It is solved to a residual of `tolerance` times the right side, on squares twice as large: it changes over
/// `DRIFT_MM`, many times their size.
pub fn drift(mesh: &FieldMesh, axes: &[DVec2], tolerance: f64) -> Vec<f64> {
    let Some(Coarser { mesh: coarse, kept }) = mesh.coarser() else {
        return free_drift(mesh, axes, tolerance).into_iter().map(bounded).collect();
    };
    let axes: Vec<DVec2> = kept.iter().map(|&k| axes[k as usize]).collect();
    let free = free_drift(coarse, &axes, tolerance);
    let between = |&p: &DVec2| {
        let (nodes, shares) = coarse.around(p);
        bounded(nodes.iter().zip(shares).map(|(k, share)| share * free[*k as usize]).sum())
    };
    mesh.nodes.iter().map(between).collect()
}

/// The factor on the frequency for what [`free_drift`] gives.
fn bounded(free: f64) -> f64 {
    let limit = MAX_DRIFT.value() - 1.0;
    1.0 + free / (1.0 + (free / limit).powi(2)).sqrt()
}

/// [`drift`] less one at every node, without its bound.
fn free_drift(mesh: &FieldMesh, axes: &[DVec2], tolerance: f64) -> Vec<f64> {
    let n = mesh.nodes.len();
    let cell2 = mesh.cell_mm * mesh.cell_mm;
    let mut matrix = GridMatrix::zero(mesh, true);
    matrix.own.fill(cell2 / (DRIFT_MM.value() * DRIFT_MM.value()));
    // A little smoothing across the lines too.
    matrix.add_springs(ACROSS.value());
    let mut rhs = vec![0.0; n];
    // Along a line, the logarithm of the frequency falls by the divergence of the axis. Each triangle gives
    // one equation.
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
        // Near a singular point the axes differ too much to give a divergence.
        if length < LEAST_SUM.value() {
            continue;
        }
        let mean = mean / length;
        let divergence: f64 = (0..3).map(|k| gradients[k].dot(t_axes[k])).sum();
        let along = gradients.map(|g| g.dot(mean));
        for k in 0..3 {
            let (corner, edge) = (t.corners[k] as usize, t.edges[k] as usize);
            matrix.own[corner] += 0.5 * cell2 * along[k] * along[k];
            matrix.beside[edge] += 0.5 * cell2 * along[(k + 1) % 3] * along[(k + 2) % 3];
            rhs[corner] -= 0.5 * cell2 * divergence * along[k];
        }
    }
    matrix.solve(vec![0.0; n], &rhs, tolerance, DRIFT_STEPS)
}

/// The change of phase along each edge.
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

/// How numbers are carried along the sides of grid squares, with one entry for each side.
struct Carried {
    /// Cosine of the phase grown along the side, seen from its second end, times the weight; `sin` likewise.
    cos: Vec<f32>,
    sin: Vec<f32>,
    /// Weight of the side.
    weight: Vec<f32>,
    /// -1 if the number is conjugated at the second end, otherwise 1.
    way: Vec<f32>,
}

impl Carried {
    fn new(mesh: &FieldMesh, turns: &[Turn], strength: &[f64]) -> Self {
        let n = mesh.edges.iter().take_while(|e| !e.diagonal).count();
        let [cos, sin, weight, way] = std::array::from_fn(|_| Vec::with_capacity(n));
        let mut all = Self { cos, sin, weight, way };
        for (turn, edge) in turns[..n].iter().zip(&mesh.edges) {
            // Seen from the second end, a mirrored phase grows downwards.
            let (sin, cos) = sin_cos(if turn.mirrored { -turn.grown_rad } else { turn.grown_rad });
            let [a, b] = edge.ends.map(|k| strength[k as usize]);
            let weight = 0.5 * (a + b);
            all.cos.push((weight * cos) as f32);
            all.sin.push((weight * sin) as f32);
            all.weight.push(weight as f32);
            all.way.push(if turn.mirrored { -1.0 } else { 1.0 });
        }
        all
    }

    /// The number at an edge's first end, carried to its second end; `backwards` carries the other way.
    fn seen(&self, edge: usize, backwards: bool, [x, y]: [f32; 2]) -> [f32; 2] {
        let (c, s, w) = (self.cos[edge], self.sin[edge], self.way[edge]);
        if backwards { [c * x + s * y, w * (c * y - s * x)] } else { [c * x - s * w * y, s * x + c * w * y] }
    }

    /// Subtracts from `y`, at each node, `width` times the numbers carried from the neighbours in `x`. Both
    /// hold the real parts of all nodes, then the imaginary parts.
    fn take_neighbours(&self, mesh: &FieldMesh, width: f32, x: &[f32], y: &mut [f32]) {
        let n = mesh.nodes.len();
        let ((x_re, x_im), (y_re, y_im)) = (x.split_at(n), y.split_at_mut(n));
        for run in mesh.runs() {
            let turns = || Turns {
                cos: &self.cos[run.edges.clone()],
                sin: &self.sin[run.edges.clone()],
                way: &self.way[run.edges.clone()],
            };
            let (from, to) = (run.from.clone(), run.to.clone());
            let x = |at: &Range<usize>| Complex { re: &x_re[at.clone()], im: &x_im[at.clone()] };
            let y = ComplexMut { re: &mut y_re[from.clone()], im: &mut y_im[from.clone()] };
            take_carried_back(y, width, turns(), x(&to));
            let y = ComplexMut { re: &mut y_re[to.clone()], im: &mut y_im[to] };
            take_carried_on(y, width, turns(), x(&from));
        }
    }
}

/// How a phase is diffused.
#[derive(Debug, Clone, Copy)]
pub struct Diffusion<const N: usize> {
    /// Width of each step in grid squares, the widest first, and its number of rounds.
    pub steps: [(f64, usize); N],
    /// So many of the first steps, `N` at most, are taken on a mesh of squares twice as large.
    pub n_coarse: usize,
    /// Each round is solved to this residual, as a share of the right side.
    pub tolerance: f64,
}

/// The phase at every node, radians. `turns` are those of [`turns`].
pub fn solve<const N: usize>(
    mesh: &FieldMesh,
    input: &PhaseInput,
    turns: &[Turn],
    diffusion: &Diffusion<N>,
) -> Vec<f64> {
    let (wide, narrow) = diffusion.steps.split_at(diffusion.n_coarse);
    let start = if wide.is_empty() { None } else { coarse_start(mesh, input, wide, diffusion.tolerance) };
    // Where there is no coarser mesh all steps are taken on this one.
    let (known, steps) = match &start {
        Some(known) => (&known[..], narrow),
        None => (&[][..], &diffusion.steps[..]),
    };
    let z = diffused(mesh, input, turns, known, steps, diffusion.tolerance);
    let n = mesh.nodes.len();
    (0..n).map(|k| atan2(z[n + k].into(), z[k].into())).collect()
}

/// Nodes of the mesh, and their numbers after these steps on a mesh of squares twice as large. `None` if there is no such mesh.
fn coarse_start(
    mesh: &FieldMesh,
    input: &PhaseInput,
    steps: &[(f64, usize)],
    tolerance: f64,
) -> Option<Vec<(u32, [f32; 2])>> {
    let Coarser { mesh: coarse, kept } = mesh.coarser()?;
    // A node stands for four of the finer mesh, and so does its wanted phase; those that lie side by side want one phase.
    let input = PhaseInput {
        axes: kept.iter().map(|&k| input.axes[k as usize]).collect(),
        frequency: kept.iter().map(|&k| input.frequency[k as usize]).collect(),
        strength: kept.iter().map(|&k| input.strength[k as usize]).collect(),
        wanted: kept
            .iter()
            .map(|&k| input.wanted[k as usize])
            .map(|(rad, weight)| (rad, 4.0 * weight))
            .collect(),
    };
    // The width is an area, counted in squares.
    let steps: Vec<(f64, usize)> = steps.iter().map(|&(width, times)| (0.25 * width, times)).collect();
    let z = diffused(coarse, &input, &turns(coarse, &input), &[], &steps, tolerance);
    Some(kept.iter().enumerate().map(|(k, &node)| (node, [z[k], z[coarse.nodes.len() + k]])).collect())
}

/// The number of every node after these steps of diffusion from those that are known: all real parts, then all imaginary parts.
fn diffused(
    mesh: &FieldMesh,
    input: &PhaseInput,
    turns: &[Turn],
    known: &[(u32, [f32; 2])],
    steps: &[(f64, usize)],
    tolerance: f64,
) -> Vec<f32> {
    let n = mesh.nodes.len();
    let carried = Carried::new(mesh, turns, &input.strength);
    // The phase wanted at the border: real and imaginary part, times the weight.
    let mut wanted = vec![0.0f32; 2 * n];
    // For each node, the sum of the weights of its neighbours and of the wanted phase.
    let mut around = vec![0.0f32; n];
    for run in mesh.runs() {
        let weights = || carried.weight[run.edges.clone()].iter();
        around[run.from].iter_mut().zip(weights()).for_each(|(sum, weight)| *sum += weight);
        around[run.to].iter_mut().zip(weights()).for_each(|(sum, weight)| *sum += weight);
    }
    for (k, &(rad, weight)) in input.wanted.iter().enumerate().filter(|w| w.1.1 > 0.0) {
        let (s, c) = sin_cos(rad);
        (wanted[k], wanted[n + k]) = ((weight * c) as f32, (weight * s) as f32);
        around[k] += weight as f32;
    }
    let mut z = swept(mesh, &carried, &wanted, known);
    for &(width, times) in steps {
        let width = width as f32;
        let own: Vec<f32> = around.iter().map(|a| 1.0 + width * a).collect();
        let apply = |x: &[f32], y: &mut [f32]| {
            x.chunks_exact(n).zip(y.chunks_exact_mut(n)).for_each(|(x, y)| multiply_f32(y, &own, x));
            carried.take_neighbours(mesh, width, x, y);
        };
        for _ in 0..times {
            let rhs: Vec<f32> = z.iter().zip(&wanted).map(|(z, want)| z + width * want).collect();
            let mut x = z.clone();
            // A coarse tolerance is enough: the next round corrects the remaining error.
            let settings = CgSettings::relative(&rhs, tolerance, STEPS.value());
            conjugate_gradients(&apply, &rhs, &mut x, settings);
            for k in 0..n {
                let length = (x[k] * x[k] + x[n + k] * x[n + k]).sqrt();
                if length > 1e-6 {
                    (z[k], z[n + k]) = (x[k] / length, x[n + k] / length);
                }
            }
        }
    }
    z
}

/// The initial phase: carried from node to node, outwards from the nodes whose numbers are known, and in each piece of the mesh without
/// one from a first node.
fn swept(mesh: &FieldMesh, carried: &Carried, wanted: &[f32], known: &[(u32, [f32; 2])]) -> Vec<f32> {
    let n = mesh.nodes.len();
    // For each node, the sides of grid squares that meet there.
    let mut starts = vec![0u32; n + 1];
    let sides = || mesh.edges.iter().take_while(|e| !e.diagonal).enumerate();
    sides().for_each(|(_, e)| e.ends.iter().for_each(|&k| starts[k as usize + 1] += 1));
    (0..n).for_each(|i| starts[i + 1] += starts[i]);
    let mut next = starts.clone();
    let mut sides_of = vec![0; starts[n] as usize];
    for (edge, e) in sides() {
        for k in e.ends {
            sides_of[next[k as usize] as usize] = edge;
            next[k as usize] += 1;
        }
    }
    let mut z = vec![0.0; 2 * n];
    let mut reached = vec![false; n];
    let mut queue = VecDeque::new();
    for &(node, [re, im]) in known {
        let node = node as usize;
        (z[node], z[n + node], reached[node]) = (re, im, true);
    }
    for &(node, _) in known {
        let node = node as usize;
        for &edge in &sides_of[starts[node] as usize..starts[node + 1] as usize] {
            let other = mesh.edges[edge].ends.iter().map(|&k| k as usize).sum::<usize>() - node;
            if !reached[other] {
                reached[other] = true;
                queue.push_back(other);
            }
        }
    }
    for first in (0..n).map(|k| (k + n / 2) % n) {
        if !reached[first] {
            reached[first] = true;
            queue.push_back(first);
        }
        while let Some(i) = queue.pop_front() {
            let mut sum = [wanted[i], wanted[n + i]];
            for &edge in &sides_of[starts[i] as usize..starts[i + 1] as usize] {
                let [a, b] = mesh.edges[edge].ends.map(|k| k as usize);
                let other = a + b - i;
                // Nodes not reached yet are zero and add nothing.
                let v = carried.seen(edge, i == a, [z[other], z[n + other]]);
                sum = [sum[0] + v[0], sum[1] + v[1]];
                if !reached[other] {
                    reached[other] = true;
                    queue.push_back(other);
                }
            }
            let length = (sum[0] * sum[0] + sum[1] * sum[1]).sqrt();
            [z[i], z[n + i]] = if length > 1e-6 { sum.map(|v| v / length) } else { [1.0, 0.0] };
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Region;
    use crate::math::direction;

    /// By how much the phase misses what it should grow by along the sides of squares: the mean of one less the cosine.
    fn missed(mesh: &FieldMesh, turns: &[Turn], phase: &[f64]) -> f64 {
        let sides = || mesh.edges.iter().zip(turns).filter(|(edge, _)| !edge.diagonal);
        let of = |(edge, turn): (&crate::field_mesh::Edge, &Turn)| {
            let [a, b] = edge.ends.map(|k| phase[k as usize]);
            let b = if turn.mirrored { -b } else { b };
            1.0 - sin_cos(b - a - turn.grown_rad).1
        };
        sides().map(of).sum::<f64>() / sides().count() as f64
    }

    #[test]
    fn wide_steps_on_larger_squares_give_as_good_a_phase() {
        let region = Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 30.0));
        let mesh = FieldMesh::over(&region, 0.44).expect("a mesh");
        type Angle = fn(DVec2) -> f64;
        let fields: [(&str, f64, Angle); 3] = [
            ("straight", 1e-9, |_| 0.3),
            ("fan", 0.05, |p| atan2(p.y + 20.0, p.x + 5.0)),
            ("half turn", 0.05, |p| 0.5 * atan2(p.y - 14.0, p.x - 21.0)),
        ];
        for (name, most, angle) in fields {
            let axes: Vec<DVec2> = mesh.nodes.iter().map(|&p| direction(angle(p))).collect();
            let n = axes.len();
            let input = PhaseInput {
                axes,
                frequency: vec![2.5; n],
                strength: vec![1.0; n],
                wanted: vec![(0.0, 0.0); n],
            };
            let turns = turns(&mesh, &input);
            let [fine, coarse] = [0, 2].map(|n_coarse| {
                let steps = [(30.0, 3), (12.5, 3), (4.0, 3)];
                let diffusion = Diffusion { steps, n_coarse, tolerance: 0.03 };
                missed(&mesh, &turns, &solve(&mesh, &input, &turns, &diffusion))
            });
            assert!(coarse < most && coarse < 1.15 * fine + 1e-9, "{name}: {coarse} and {fine}");
        }
    }

    #[test]
    fn the_spacing_on_larger_squares_is_that_of_the_mesh() {
        let region = Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 30.0));
        let mesh = FieldMesh::over(&region, 0.44).expect("a mesh");
        // Lines that part: their spacing grows along them, and falls to the nominal one over some millimetres.
        let axes: Vec<DVec2> = mesh.nodes.iter().map(|p| direction(atan2(p.y - 15.0, p.x + 30.0))).collect();
        let fine = free_drift(&mesh, &axes, 1e-4);
        let coarse = drift(&mesh, &axes, 1e-4);
        let off = |k: usize| (bounded(fine[k]) - coarse[k]).abs();
        // Beyond the region, nodes may have none of the larger squares around them.
        let inside = (0..coarse.len()).filter(|&k| region.contains(mesh.nodes[k]));
        let most = inside.map(off).fold(0.0, f64::max);
        let (least, greatest) = coarse.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!(greatest - least > 0.05, "the spacing varies: {least} to {greatest}");
        assert!(most < 0.01, "off by {most}");
    }
}
