//! The equations of a plate: assembled and factored once, solved for any number of load cases.
//!
//! Method: the stiffness of the elements is assembled into a sparse symmetric matrix, factored by Cholesky's
//! method with approximate minimum degree ordering (`amestoy1996`). Degrees of freedom of held nodes are
//! eliminated; a prescribed displacement moves to the right-hand side. A node held along a slanted direction
//! gets its own coordinate frame, so that each hold fixes exactly one unknown. Each solution is corrected
//! once by the solution for its residual. Reactions are the stiffness of the elements at held nodes times the
//! displacements, less the loads.
//!
//! Forces are in N, displacements in mm, both one vector a node. Element matrices are computed in parallel
//! and added in order, so the result is the same for any number of threads. Cost for n nodes: n log n numbers
//! and n^1.5 operations for the factor, then two triangular solves for a solution and two for its correction.
//!
//! Degenerate cases: a piece that can move freely, an element turned inside out, and a factor above the
//! memory limit are errors. Of the holds at a node the first counts, and the first in another direction;
//! further ones are ignored. A load of zero gives the prescribed displacements.

use std::collections::BTreeMap;

use grainpath_core::DVec2;
use rayon::prelude::*;

use super::plane_problem::{PlaneError, PlaneProblem, check_held};
use super::plane_stress::PlaneStress;
use super::quadratic_triangle as element;
use crate::sparse::{Cholesky, Symmetric};

/// Displacements of a solved plate.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneSolution {
    /// Displacement of every node, mm.
    pub displacement_mm: Vec<DVec2>,
    /// Unknowns solved for.
    pub dofs: usize,
    /// Length of the residual over that of the loads.
    pub residual: f64,
}

const NONE: usize = usize::MAX;
/// Elements whose stiffness matrices are in memory at once. Source: derived: 4096 matrices of 144
/// numbers take 4.7 MB. The result does not depend on it.
const CHUNK: usize = 4096;

/// Directions and displacements that differ by less, as a share, count as equal. Source: derived: rounding of
/// a direction computed from coordinates is below 1e-12 of it, and nobody types displacements to a millionth.
const SAME: f64 = 1e-6;

/// A factored plate, ready for any number of load cases.
pub struct PlaneSystem<'a> {
    problem: &'a PlaneProblem<'a>,
    /// First axis of each held node's own frame; the second is a quarter turn ahead.
    frames: BTreeMap<u32, DVec2>,
    /// Number of each degree of freedom among the free ones; `NONE` for held ones.
    number: Vec<[usize; 2]>,
    matrix: Symmetric,
    factor: Cholesky,
    /// Part of the right-hand side that comes from prescribed displacements.
    prescribed_n: Vec<f64>,
    /// Prescribed displacement of each node in its frame.
    prescribed_mm: BTreeMap<u32, DVec2>,
}

impl<'a> PlaneSystem<'a> {
    /// Checks that the plate is held, assembles and factors.
    ///
    /// # Errors
    /// [`PlaneError`] when a piece is free to move, two supports contradict each other, an element is inverted
    /// or the factor is too large.
    pub fn new(problem: &'a PlaneProblem<'a>) -> Result<Self, PlaneError> {
        check_held(problem)?;
        let mesh = problem.mesh;
        let (mut frames, mut prescribed_mm) = (BTreeMap::new(), BTreeMap::new());
        let mut held = vec![[false; 2]; mesh.nodes.len()];
        for hold in problem.holds {
            let i = hold.node as usize;
            // The first support of a node defines its frame. A second support in another direction
            // then fixes the second axis as well.
            let e = *frames.entry(hold.node).or_insert(hold.along);
            let given = prescribed_mm.entry(hold.node).or_insert(DVec2::ZERO);
            let quarter = DVec2::new(-e.y, e.x);
            let (c, s) = (hold.along.dot(e), hold.along.dot(quarter));
            if !held[i][0] {
                held[i][0] = true;
                given.x = hold.displacement_mm;
            } else if s.abs() > SAME && !held[i][1] {
                held[i][1] = true;
                // The second support prescribes a combination of both axes, of which the first is
                // known already.
                given.y = (hold.displacement_mm - c * given.x) / s;
            } else {
                // The displacement in this direction is known already, so the same one has to be asked for.
                let known_mm = c * given.x + s * given.y;
                let largest_mm = given.abs().max_element().max(hold.displacement_mm.abs());
                if (hold.displacement_mm - known_mm).abs() > SAME * largest_mm {
                    let at = mesh.nodes[i];
                    return Err(PlaneError::Contradiction { x: at.x, y: at.y });
                }
            }
        }
        let mut n = 0;
        let number: Vec<[usize; 2]> = held
            .iter()
            .map(|h| {
                h.map(|held| {
                    n += usize::from(!held);
                    if held { NONE } else { n - 1 }
                })
            })
            .collect();
        let (matrix, prescribed_n) = assemble(problem, &number, n, &frames, &prescribed_mm)?;
        let factor = Cholesky::new(&matrix, None, problem.max_mib)?;
        Ok(Self { problem, frames, number, matrix, factor, prescribed_n, prescribed_mm })
    }

    /// Displacements under forces at the nodes, N.
    pub fn solve(&self, forces_n: &[DVec2]) -> PlaneSolution {
        let mut rhs = self.prescribed_n.clone();
        for (i, &f) in forces_n.iter().enumerate() {
            let f = self.to_frame(i as u32, f);
            for (k, value) in [f.x, f.y].into_iter().enumerate() {
                if self.number[i][k] != NONE {
                    rhs[self.number[i][k]] += value;
                }
            }
        }
        let mut x = rhs.clone();
        self.factor.solve(&mut x);
        let length = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        // One step of iterative refinement brings the residual down to rounding.
        let difference =
            |x: &[f64]| -> Vec<f64> { rhs.iter().zip(self.matrix.times(x)).map(|(b, ax)| b - ax).collect() };
        let mut correction = difference(&x);
        self.factor.solve(&mut correction);
        x.iter_mut().zip(correction).for_each(|(x, c)| *x += c);
        let residual = length(&difference(&x)) / length(&rhs).max(f64::MIN_POSITIVE);
        let displacement_mm = (0..self.number.len())
            .map(|i| {
                let given = self.prescribed_mm.get(&(i as u32)).copied().unwrap_or_default();
                let part = |k: usize, held: f64| {
                    if self.number[i][k] == NONE { held } else { x[self.number[i][k]] }
                };
                let u = DVec2::new(part(0, given.x), part(1, given.y));
                match self.frames.get(&(i as u32)) {
                    Some(e) => u.x * *e + u.y * DVec2::new(-e.y, e.x),
                    None => u,
                }
            })
            .collect();
        PlaneSolution { displacement_mm, dofs: x.len(), residual }
    }

    /// Forces with which the holds act on the nodes under `forces_n`, N, `(n_nodes)`; zero at free
    /// nodes.
    pub fn reactions_n(&self, solution: &PlaneSolution, forces_n: &[DVec2]) -> Vec<DVec2> {
        let mesh = self.problem.mesh;
        let is_held = |i: u32| self.number[i as usize].contains(&NONE);
        // Reactions are stiffness times displacements minus the loads. The rows of held nodes were
        // eliminated, so the stiffness of their elements is computed again.
        let mut reactions = vec![DVec2::ZERO; mesh.nodes.len()];
        for e in mesh.elements.iter().filter(|e| e.iter().any(|&i| is_held(i))) {
            let p = e.map(|i| mesh.nodes[i as usize]);
            let c = (self.problem.stiffness)((p[0] + p[1] + p[2]) / 3.0);
            // The same elements were assembled before without an error, so none of them is turned inside out.
            let Some(k) = element::stiffness(&p, &c, self.problem.thickness_mm) else { continue };
            let u = e.map(|i| solution.displacement_mm[i as usize]);
            for (a, &i) in e.iter().enumerate().filter(|(_, i)| is_held(**i)) {
                for (b, u) in u.iter().enumerate() {
                    reactions[i as usize].x += k[2 * a][2 * b] * u.x + k[2 * a][2 * b + 1] * u.y;
                    reactions[i as usize].y += k[2 * a + 1][2 * b] * u.x + k[2 * a + 1][2 * b + 1] * u.y;
                }
            }
        }
        for (i, force) in forces_n.iter().enumerate().filter(|(i, _)| is_held(*i as u32)) {
            reactions[i] -= *force;
        }
        reactions
    }

    /// Stress recovered from displacements.
    pub fn stress(&self, solution: &PlaneSolution) -> PlaneStress {
        PlaneStress::recovered(self.problem, &solution.displacement_mm)
    }

    fn to_frame(&self, node: u32, v: DVec2) -> DVec2 {
        match self.frames.get(&node) {
            Some(e) => DVec2::new(v.dot(*e), v.dot(DVec2::new(-e.y, e.x))),
            None => v,
        }
    }
}

fn assemble(
    problem: &PlaneProblem<'_>,
    number: &[[usize; 2]],
    n: usize,
    frames: &BTreeMap<u32, DVec2>,
    prescribed_mm: &BTreeMap<u32, DVec2>,
) -> Result<(Symmetric, Vec<f64>), PlaneError> {
    let mesh = problem.mesh;
    // A quadratic triangle has 21 pairs of nodes. Sorted and without repeats, the pairs are the
    // pattern of the matrix.
    let mut pairs: Vec<u64> = Vec::with_capacity(21 * mesh.elements.len());
    for e in &mesh.elements {
        for (a, &i) in e.iter().enumerate() {
            pairs.extend(e[..=a].iter().map(|&j| (u64::from(i.min(j)) << 32) | u64::from(i.max(j))));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let mut matrix = Symmetric { starts: vec![0], ..Symmetric::default() };
    for column in pairs.chunk_by(|a, b| a >> 32 == b >> 32) {
        let j = (column[0] >> 32) as usize;
        for c in (0..2).filter(|&c| number[j][c] != NONE) {
            for pair in column {
                let i = (pair & 0xffff_ffff) as usize;
                let rows = number[i].iter().filter(|&&r| r != NONE && r >= number[j][c]);
                matrix.rows.extend(rows);
            }
            matrix.starts.push(matrix.rows.len());
        }
    }
    matrix.values = vec![0.0; matrix.rows.len()];
    let mut rhs = vec![0.0; n];
    for (chunk_idx, chunk) in mesh.elements.chunks(CHUNK).enumerate() {
        let matrices: Vec<Option<[[f64; 12]; 12]>> = chunk
            .par_iter()
            .map(|e| {
                let corners = e.map(|i| mesh.nodes[i as usize]);
                let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
                element::stiffness(&corners, &(problem.stiffness)(centre), problem.thickness_mm)
            })
            .collect();
        // Matrices were computed in parallel; adding them in order keeps the sums the same for any
        // number of threads.
        for (k, (e, ke)) in chunk.iter().zip(matrices).enumerate() {
            let mut ke = ke.ok_or(PlaneError::Inverted(chunk_idx * CHUNK + k))?;
            for (a, node) in e.iter().enumerate() {
                if let Some(axis) = frames.get(node) {
                    element::turn(&mut ke, a, *axis);
                }
            }
            for a in 0..12 {
                let row = number[e[a / 2] as usize][a % 2];
                if row == NONE {
                    continue;
                }
                for b in 0..12 {
                    let column = number[e[b / 2] as usize][b % 2];
                    // A prescribed displacement moves to the right-hand side.
                    if column == NONE {
                        let given = prescribed_mm.get(&e[b / 2]).map_or(0.0, |u| u[b % 2]);
                        rhs[row] -= ke[a][b] * given;
                    } else if row >= column {
                        let range = matrix.starts[column]..matrix.starts[column + 1];
                        if let Ok(at) = matrix.rows[range.clone()].binary_search(&row) {
                            matrix.values[range.start + at] += ke[a][b];
                        }
                    }
                }
            }
        }
    }
    Ok((matrix, rhs))
}
