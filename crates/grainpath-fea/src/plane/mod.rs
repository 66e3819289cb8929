//! Plates loaded in their plane: quadratic triangles, one direct solve, stress recovered at the nodes.

mod element;
mod recover;
mod stress;

use std::collections::BTreeMap;

use grainpath_core::math::cross;
use grainpath_core::triangulation::Triangulation;
use grainpath_core::{DVec2, Region};
use rayon::prelude::*;

use crate::sparse::{Cholesky, SparseError, Symmetric};
pub use stress::PlaneStress;

/// Stress from strain xx, yy, xy (doubled), MPa.
pub type PlaneStiffness = [[f64; 3]; 3];

/// Quadratic triangles: three corners, then the nodes in the middle of sides 01, 12 and 20.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneMesh {
    /// Nodes, mm.
    pub nodes: Vec<DVec2>,
    /// Node indices, `(n_elements, 6)`, counter-clockwise.
    pub elements: Vec<[u32; 6]>,
    /// Sides with one element: both ends and the middle, the material on the left.
    pub border: Vec<[u32; 3]>,
}

impl PlaneMesh {
    /// The mesh of these triangles, sides straight.
    pub fn quadratic(triangles: &Triangulation) -> Self {
        let mut nodes = triangles.points.clone();
        let mut sides: Vec<(u32, u32, u32, u32)> = Vec::with_capacity(3 * triangles.triangles.len());
        for (t, corners) in triangles.triangles.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                sides.push((a.min(b), a.max(b), t as u32, k as u32));
            }
        }
        sides.sort_unstable();
        let mut elements: Vec<[u32; 6]> =
            triangles.triangles.iter().map(|&[a, b, c]| [a, b, c, 0, 0, 0]).collect();
        let mut border = Vec::new();
        for shared in sides.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            let (a, b, ..) = shared[0];
            let middle = nodes.len() as u32;
            nodes.push(0.5 * (nodes[a as usize] + nodes[b as usize]));
            shared.iter().for_each(|s| elements[s.2 as usize][3 + s.3 as usize] = middle);
            if let [(_, _, t, k)] = shared {
                let e = elements[*t as usize];
                border.push([e[*k as usize], e[(*k as usize + 1) % 3], middle]);
            }
        }
        border.sort_unstable();
        Self { nodes, elements, border }
    }

    /// Which connected piece each node belongs to, and how many there are.
    pub fn pieces(&self) -> (Vec<u32>, usize) {
        let mut parent: Vec<u32> = (0..self.nodes.len() as u32).collect();
        fn root(parent: &mut [u32], mut i: u32) -> u32 {
            while parent[i as usize] != i {
                parent[i as usize] = parent[parent[i as usize] as usize];
                i = parent[i as usize];
            }
            i
        }
        for e in &self.elements {
            for k in 1..6 {
                let (a, b) = (root(&mut parent, e[0]), root(&mut parent, e[k]));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        let mut number = BTreeMap::new();
        let piece: Vec<u32> = (0..self.nodes.len() as u32)
            .map(|i| {
                let next = number.len() as u32;
                *number.entry(root(&mut parent, i)).or_insert(next)
            })
            .collect();
        (piece, number.len())
    }

    /// Length of the border's sides, mm.
    pub fn border_length_mm(&self, sides: &[[u32; 3]]) -> f64 {
        sides.iter().map(|&[a, b, _]| self.nodes[a as usize].distance(self.nodes[b as usize])).sum()
    }
}

/// A node held in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// Which node.
    pub node: u32,
    /// Unit vector along which it is held.
    pub along: DVec2,
    /// Where it is held, mm from where it was.
    pub displacement_mm: f64,
}

/// Why a plate cannot be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// A piece of the part moves freely.
    #[error("the piece around ({x:.2}, {y:.2}) mm is free to {how}; hold it with another fixture")]
    Free {
        /// Where a node of the piece is.
        x: f64,
        /// Where a node of the piece is.
        y: f64,
        /// "move along x" and the like.
        how: &'static str,
    },
    /// The equations could not be solved.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// An element is turned inside out.
    #[error("element {0} of the mesh is turned inside out")]
    Inverted(usize),
}

/// A plate, held and loaded.
pub struct PlaneProblem<'a> {
    /// Its mesh.
    pub mesh: &'a PlaneMesh,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Stiffness at a point.
    pub stiffness: &'a (dyn Fn(DVec2) -> PlaneStiffness + Sync),
    /// Where it is held.
    pub holds: &'a [Hold],
    /// The most the solver may take.
    pub max_bytes: u64,
}

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
/// Elements whose stiffness is held at once.
const CHUNK: usize = 4096;

/// A factored plate: any number of load cases may follow.
pub struct PlaneSystem<'a> {
    problem: &'a PlaneProblem<'a>,
    /// First axis of each held node's own frame; the second is a quarter turn on.
    frames: BTreeMap<u32, DVec2>,
    /// Number of each degree of freedom among the free ones.
    number: Vec<[usize; 2]>,
    matrix: Symmetric,
    factor: Cholesky,
    /// What prescribed displacements put on the right side.
    prescribed_n: Vec<f64>,
    /// Prescribed displacement of each node in its frame.
    prescribed_mm: BTreeMap<u32, DVec2>,
}

impl<'a> PlaneSystem<'a> {
    /// Checks that nothing moves freely, assembles and factors.
    ///
    /// # Errors
    /// [`PlaneError`] when a piece is free to move, an element is inverted or the factor is too large.
    pub fn new(problem: &'a PlaneProblem<'a>) -> Result<Self, PlaneError> {
        check_held(problem)?;
        let mesh = problem.mesh;
        let (mut frames, mut prescribed_mm) = (BTreeMap::new(), BTreeMap::new());
        let mut held = vec![[false; 2]; mesh.nodes.len()];
        for hold in problem.holds {
            let i = hold.node as usize;
            let e = *frames.entry(hold.node).or_insert(hold.along);
            let given = prescribed_mm.entry(hold.node).or_insert(DVec2::ZERO);
            let quarter = DVec2::new(-e.y, e.x);
            let (c, s) = (hold.along.dot(e), hold.along.dot(quarter));
            if !held[i][0] {
                held[i][0] = true;
                given.x = hold.displacement_mm;
            } else if s.abs() > 1e-6 && !held[i][1] {
                held[i][1] = true;
                given.y = (hold.displacement_mm - c * given.x) / s;
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
        let factor = Cholesky::new(&matrix, None, problem.max_bytes)?;
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
        // One step of refinement: the residual is then that of rounding.
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

/// Refuses pieces that can move as a whole.
fn check_held(problem: &PlaneProblem<'_>) -> Result<(), PlaneError> {
    let mesh = problem.mesh;
    let (piece, n_pieces) = mesh.pieces();
    let mut first = vec![NONE; n_pieces];
    (0..piece.len()).rev().for_each(|i| first[piece[i] as usize] = i);
    for p in 0..n_pieces {
        let centre = mesh.nodes[first[p]];
        let members = || (0..piece.len()).filter(|&i| piece[i] as usize == p);
        let size = members().map(|i| mesh.nodes[i].distance(centre)).fold(1e-12, f64::max);
        // What each hold says of the two shifts and the turn: the Gram matrix must have full rank.
        let mut gram = [[0.0; 3]; 3];
        for hold in problem.holds.iter().filter(|h| piece[h.node as usize] as usize == p) {
            let r = (mesh.nodes[hold.node as usize] - centre) / size;
            let row = [hold.along.x, hold.along.y, cross(r, hold.along)];
            for i in 0..3 {
                (0..3).for_each(|j| gram[i][j] += row[i] * row[j]);
            }
        }
        if let Some(how) = loose(&mut gram) {
            return Err(PlaneError::Free { x: centre.x, y: centre.y, how });
        }
    }
    Ok(())
}

/// The first motion that a Gram matrix of holds leaves free, by elimination in the order x, y, turn.
pub(crate) fn loose(gram: &mut [[f64; 3]; 3]) -> Option<&'static str> {
    let scale = (gram[0][0] + gram[1][1] + gram[2][2]).max(1e-30);
    for k in 0..3 {
        if gram[k][k] < 1e-9 * scale {
            return Some(["move along x", "move along y", "turn about z"][k]);
        }
        for i in k + 1..3 {
            let f = gram[i][k] / gram[k][k];
            (0..3).for_each(|j| gram[i][j] -= f * gram[k][j]);
        }
    }
    None
}

fn assemble(
    problem: &PlaneProblem<'_>,
    number: &[[usize; 2]],
    n: usize,
    frames: &BTreeMap<u32, DVec2>,
    prescribed_mm: &BTreeMap<u32, DVec2>,
) -> Result<(Symmetric, Vec<f64>), PlaneError> {
    let mesh = problem.mesh;
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

/// Forces at the nodes from a traction in MPa on sides of the border; `traction` is told the point and the outward
/// unit normal.
pub fn traction_n(
    mesh: &PlaneMesh,
    sides: &[[u32; 3]],
    thickness_mm: f64,
    traction: &dyn Fn(DVec2, DVec2) -> DVec2,
) -> Vec<DVec2> {
    let mut forces = vec![DVec2::ZERO; mesh.nodes.len()];
    for side in sides {
        let [a, b, m] = side.map(|i| mesh.nodes[i as usize]);
        for (xi, weight) in element::GAUSS_3 {
            let shape = [0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi];
            let slope = [xi - 0.5, xi + 0.5, -2.0 * xi];
            let p = shape[0] * a + shape[1] * b + shape[2] * m;
            let along = slope[0] * a + slope[1] * b + slope[2] * m;
            let normal = DVec2::new(along.y, -along.x) / along.length();
            let f = traction(p, normal) * (weight * along.length() * thickness_mm);
            side.iter().zip(shape).for_each(|(&i, s)| forces[i as usize] += s * f);
        }
    }
    forces
}

/// Forces at the nodes from a force per volume, N/mm3.
pub fn body_force_n(mesh: &PlaneMesh, thickness_mm: f64, force_n_mm3: DVec2) -> Vec<DVec2> {
    let mut forces = vec![DVec2::ZERO; mesh.nodes.len()];
    for e in &mesh.elements {
        let p = e.map(|i| mesh.nodes[i as usize]);
        for (at, weight) in element::POINTS {
            let (shape, jacobian) = element::shape(&p, at);
            let f = force_n_mm3 * (weight * jacobian * thickness_mm);
            e.iter().zip(shape).for_each(|(&i, s)| forces[i as usize] += s * f);
        }
    }
    forces
}

/// The mesh of a region with sides of at most `longest_mm`, finer around small holes.
///
/// # Errors
/// When the region cannot be cut into triangles.
pub fn mesh_region(
    region: &Region,
    longest_mm: f64,
    shortest_mm: f64,
) -> Result<PlaneMesh, grainpath_core::triangulation::TriangulationError> {
    let size = grainpath_core::triangulation::TriangleSize { longest_mm, sides_of_hole: 72, shortest_mm };
    Ok(PlaneMesh::quadratic(&Triangulation::of(region, &size, &[])?))
}

#[cfg(test)]
mod tests;
