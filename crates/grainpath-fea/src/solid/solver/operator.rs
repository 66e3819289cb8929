//! The stiffness of a mesh of quadratic tetrahedra, applied to a displacement without being stored.
//!
//! Method: the force of an element is computed from its geometry whenever it is needed. In an element with
//! straight sides the strain is linear, so stresses at the four corners and the mass matrix of linear
//! functions give the forces exactly. An element with a curved side is integrated at four points
//! (`hammer1956`). Elements are taken in groups of 1024. A group gathers its nodes, works in the cache, and
//! writes its forces to places of its own. Each node then adds up the places of its groups in a fixed order,
//! so the result has the same bits for any number of threads.
//!
//! Displacements are in mm, forces in N, both as `n_nodes` vectors. Cost: linear in the elements. Memory:
//! 104 bytes an element, and 32 bytes for each node of each group. A stored matrix would take 76 bytes for
//! each pair of nodes that share an element.
//!
//! The diagonal blocks, 3 x 3 a node, are inverted for use in preconditioners. Degenerate cases: a supported
//! direction has the identity in its block, and so has a node without stiffness. A block that is singular
//! within rounding is made stiffer by a millionth of its trace first. Elements must have positive volume.

use grainpath_core::{DMat3, DVec3};
use rayon::prelude::*;

use super::system::System;
use crate::solid::model::constraints::Supports;
use crate::solid::model::error::SolidError;
use crate::solid::model::material_map::Model;
use crate::solid::model::quadratic_tet::{self as element, Law, STIFFNESS_RULE};
use crate::solid::model::tet_shape::EDGES;

/// Elements of a group; their nodes are numbered with 16 bits. Source: derived: 1024 elements of
/// ten nodes have at most 10 240 different ones.
const GROUP: usize = 1024;
/// Nodes that one task processes. Source: derived: 4096 vectors take 98 KB, which fits the
/// second-level cache of a core.
pub(crate) const CHUNK: usize = 4096;

pub(crate) struct Operator<'a> {
    model: &'a Model<'a>,
    laws: Vec<Law>,
    supports: &'a Supports,
    groups: Vec<Group>,
    /// Indices of the slots to which the groups write the forces on each node: `places[start[i]..start[i + 1]]`.
    start: Vec<u32>,
    places: Vec<u32>,
}

struct Group {
    nodes: Vec<u32>,
    tets: Vec<Tet>,
}

/// An element within its group.
struct Tet {
    nodes: [u16; 10],
    material: u32,
    /// Gradients of the last three barycentric coordinates, and the volume; 0 for a curved element.
    slopes: [DVec3; 3],
    volume: f64,
}

impl<'a> Operator<'a> {
    pub(crate) fn new(model: &'a Model<'a>, supports: &'a Supports) -> Result<Self, SolidError> {
        let laws = model.laws()?;
        let n_groups = model.mesh.tets.len().div_ceil(GROUP);
        let groups: Vec<Group> = (0..n_groups).into_par_iter().map(|g| group(model, g)).collect();
        let n = model.mesh.nodes.len();
        // A counting sort turns the groups' lists of nodes into each node's list of places.
        let mut start = vec![0u32; n + 1];
        for &i in groups.iter().flat_map(|g| &g.nodes) {
            start[i as usize + 1] += 1;
        }
        for i in 0..n {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut places = vec![0u32; start[n] as usize];
        for (place, &i) in (0u32..).zip(groups.iter().flat_map(|g| &g.nodes)) {
            places[next[i as usize] as usize] = place;
            next[i as usize] += 1;
        }
        Ok(Self { model, laws, supports, groups, start, places })
    }

    /// Bytes of the operator and its scratch.
    pub(crate) fn bytes(&self) -> usize {
        let tets = self.model.mesh.tets.len() * size_of::<Tet>();
        tets + self.places.len() * (8 + size_of::<DVec3>()) + 4 * self.start.len()
    }

    fn group_forces(&self, group: &Group, u: &[DVec3], out: &mut [DVec3]) {
        let local: Vec<DVec3> = group.nodes.iter().map(|&i| u[i as usize]).collect();
        out.fill(DVec3::ZERO);
        for tet in &group.tets {
            let v = tet.nodes.map(|i| local[i as usize]);
            let law = &self.laws[tet.material as usize];
            let f = if tet.volume > 0.0 {
                straight_forces(tet, law, &v)
            } else {
                // Only curved elements read positions; they lie at the surface and are few.
                let x = tet.nodes.map(|i| self.model.mesh.nodes[group.nodes[i as usize] as usize]);
                curved_forces(&x, law, &v)
            };
            for (&i, f) in tet.nodes.iter().zip(f) {
                out[i as usize] += f;
            }
        }
    }
}

impl System for Operator<'_> {
    fn n_nodes(&self) -> usize {
        self.model.mesh.nodes.len()
    }

    fn supports(&self) -> &Supports {
        self.supports
    }

    fn scratch(&self) -> Vec<DVec3> {
        vec![DVec3::ZERO; self.places.len()]
    }

    fn forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        let mut slices = Vec::with_capacity(self.groups.len());
        // Every group writes to a slice of its own, so that threads need no locks.
        let mut rest = &mut *scratch;
        for group in &self.groups {
            let (own, others) = rest.split_at_mut(group.nodes.len());
            slices.push(own);
            rest = others;
        }
        self.groups.par_iter().zip(slices).for_each(|(group, out)| self.group_forces(group, u, out));
        let scratch = &*scratch;
        f.par_chunks_mut(CHUNK).enumerate().for_each(|(c, chunk)| {
            for (i, f) in (c * CHUNK..).zip(chunk) {
                let range = self.start[i] as usize..self.start[i + 1] as usize;
                *f = self.places[range].iter().map(|&p| scratch[p as usize]).sum();
            }
        });
    }

    fn inverse_diagonal(&self) -> Vec<DMat3> {
        let mesh = self.model.mesh;
        let blocks_of_tet = |t: usize| element::diagonal(&mesh.places(t), &self.laws[self.model.material(t)]);
        let mut sum = vec![DMat3::ZERO; self.n_nodes()];
        // Elements are processed in blocks to bound the memory: the ten matrices of an element take 720 bytes.
        for (c, tets) in mesh.tets.chunks(16 * GROUP).enumerate() {
            let first = c * 16 * GROUP;
            let blocks: Vec<[DMat3; 10]> =
                (first..first + tets.len()).into_par_iter().map(blocks_of_tet).collect();
            for (tet, blocks) in tets.iter().zip(blocks) {
                for (&i, b) in tet.iter().zip(blocks) {
                    sum[i as usize] += b;
                }
            }
        }
        // Supported directions get the identity, without which the block could not be inverted.
        let held =
            |i: usize, k: DMat3| self.supports.free(i).map_or(k, |p| *p * k * *p + (DMat3::IDENTITY - *p));
        sum.into_par_iter().enumerate().map(|(i, k)| inverse(held(i, k))).collect()
    }
}

/// A block counts as singular if its determinant over the cube of its trace is below this. Source: derived: if a direction
/// oblique to the axes is projected out, rounding leaves 1e-16 of the block in it and a determinant of 1e-17; blocks with
/// stiffness in all directions have 1e-2 to 1e-9.
const SINGULAR: f64 = 1e-14;

/// The inverse of a block. A nearly singular block is made slightly stiffer first.
pub(crate) fn inverse(k: DMat3) -> DMat3 {
    let trace = k.x_axis.x + k.y_axis.y + k.z_axis.z;
    // The node has no stiffness; the identity leaves its residual unchanged.
    if trace <= 0.0 {
        return DMat3::IDENTITY;
    }
    let k = if k.determinant() > SINGULAR * trace.powi(3) {
        k
    } else {
        k + DMat3::from_diagonal(DVec3::splat(1e-6 * trace))
    };
    k.inverse()
}

fn group(model: &Model<'_>, g: usize) -> Group {
    let mesh = model.mesh;
    let range = g * GROUP..mesh.tets.len().min((g + 1) * GROUP);
    let mut nodes: Vec<u32> = mesh.tets[range.clone()].iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let local = |i: u32| nodes.binary_search(&i).expect("listed above") as u16;
    let tet = |t: usize| {
        let x = mesh.places(t);
        let longest = EDGES.iter().map(|&(i, j)| x[i].distance(x[j])).fold(0.0, f64::max);
        // If all middle nodes lie half way within rounding, the formula for straight sides below is exact.
        let straight = |(m, &(i, j)): (usize, &(usize, usize))| {
            x[4 + m].distance(0.5 * (x[i] + x[j])) < 1e-12 * (longest + x[i].length())
        };
        let j = DMat3::from_cols(x[1] - x[0], x[2] - x[0], x[3] - x[0]);
        let turn = j.inverse().transpose();
        let volume = if EDGES.iter().enumerate().all(straight) { j.determinant() / 6.0 } else { 0.0 };
        Tet {
            nodes: mesh.tets[t].map(local),
            material: model.material(t) as u32,
            slopes: [turn.x_axis, turn.y_axis, turn.z_axis],
            volume,
        }
    };
    let tets = range.map(tet).collect();
    Group { nodes, tets }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Forces of an element with straight sides. The gradient of the displacement is linear over it, so
/// its values at the corners and the mass matrix of linear functions give the forces exactly. At
/// corner i the gradient is the sum over l of w_il times the gradient of coordinate l, with w_il =
/// 4 u_(middle of i, l) - u_l and w_ii = 3 u_i.
fn straight_forces(tet: &Tet, law: &Law, u: &[DVec3; 10]) -> [DVec3; 10] {
    let [gb, gc, gd] = tet.slopes;
    // Node between corners i and l; the diagonal is not used. Source: definition, the order of the
    // middle nodes.
    const MIDDLE: [[usize; 4]; 4] = [[0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3]];
    let mut stress = [DMat3::ZERO; 4];
    let mut sum = DMat3::ZERO;
    for i in 0..4 {
        let w = |l: usize| if l == i { 3.0 * u[i] } else { 4.0 * u[MIDDLE[i][l]] - u[l] };
        let w0 = w(0);
        let grad = outer(w(1) - w0, gb) + outer(w(2) - w0, gc) + outer(w(3) - w0, gd);
        stress[i] = law.stress(&grad);
        sum += stress[i];
    }
    let mut f = [DVec3::ZERO; 10];
    // The mass matrix of linear functions on a tetrahedron is volume / 20 times (1 + identity).
    let scale = tet.volume / 20.0;
    for i in 0..4 {
        let t = (sum + stress[i]) * scale;
        let (b, c, d) = (t * gb, t * gc, t * gd);
        let q = [-(b + c + d), b, c, d];
        for l in 0..4 {
            if l == i {
                f[i] += 3.0 * q[i];
            } else {
                f[l] -= q[l];
                f[MIDDLE[i][l]] += 4.0 * q[l];
            }
        }
    }
    f
}

fn curved_forces(x: &[DVec3; 10], law: &Law, u: &[DVec3; 10]) -> [DVec3; 10] {
    let mut f = [DVec3::ZERO; 10];
    for (l, w) in &STIFFNESS_RULE {
        let (g, det) = element::gradients(x, l);
        let grad = u.iter().zip(&g).fold(DMat3::ZERO, |m, (u, g)| m + outer(*u, *g));
        // Force at a node: stress times the gradient of its shape function, summed over the rule.
        let stress = law.stress(&grad) * (w * det);
        for (f, g) in f.iter_mut().zip(&g) {
            *f += stress * *g;
        }
    }
    f
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_that_is_projected_out_aslant_has_a_bounded_inverse() {
        let k = DMat3::from_cols(
            DVec3::new(3.1, 0.4, -0.2),
            DVec3::new(0.4, 2.7, 0.5),
            DVec3::new(-0.2, 0.5, 3.9),
        );
        for i in 0..64 {
            let d = DVec3::new(0.8, f64::from(i) / 40.0 - 0.7, 0.3).normalize();
            let free = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            let found = inverse(free * k * free);
            assert!(found.to_cols_array().iter().all(|v| v.abs() < 1e7), "{found} for {d}");
            // Along the free directions it is the inverse all the same.
            let across = d.any_orthonormal_vector();
            let back = free * (found * (free * (k * across)));
            assert!((back - across).length() < 1e-4, "{back} for {across}");
        }
    }

    use crate::solid::TetMesh;
    use crate::solid::solver::block_matrix::{assemble, dot};

    fn random(n: usize, mut state: u64) -> Vec<DVec3> {
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
        };
        (0..n).map(|_| DVec3::new(next(), next(), next())).collect()
    }

    fn laws() -> [[[f64; 6]; 6]; 2] {
        let mut isotropic = [[0.0; 6]; 6];
        let mut general = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                isotropic[i][j] = match (i < 3 && j < 3, i == j) {
                    (true, same) => 1.2 + if same { 1.6 } else { 0.0 },
                    (false, same) => {
                        if same {
                            0.8
                        } else {
                            0.0
                        }
                    }
                };
                general[i][j] = 0.1 * ((i * j) as f64).sin_like() + if i == j { 3.0 } else { 0.0 };
            }
        }
        [isotropic, general]
    }

    trait SinLike {
        fn sin_like(self) -> f64;
    }

    impl SinLike for f64 {
        fn sin_like(self) -> f64 {
            grainpath_core::math::sin(self)
        }
    }

    #[test]
    fn agrees_with_the_assembled_matrix() {
        let corners: Vec<DVec3> = random(5, 7).iter().map(|p| *p * 3.0).collect();
        let mut mesh = TetMesh::straight(&corners, &[[0, 1, 2, 3], [1, 2, 3, 4]]);
        for curved in [false, true] {
            if curved {
                let bent = mesh.tets[0][7] as usize;
                mesh.nodes[bent] += DVec3::new(0.02, -0.01, 0.03);
            }
            for d in laws() {
                let model = Model::uniform(&mesh, d);
                let mut supports = Supports::new(mesh.nodes.len());
                supports.fix(&mesh, 2).expect("new");
                supports.prescribe(&mesh, 6, DVec3::new(1.0, 2.0, -0.5), 0.0).expect("new");
                let operator = Operator::new(&model, &supports).expect("positive");
                let law = Law::new(&d).expect("positive");
                let full = assemble(mesh.nodes.len(), &mesh.tets, |t| {
                    element::stiffness(&element::gradient_products(&mesh.places(t)), &law)
                });
                let u = random(mesh.nodes.len(), 3);
                let (mut f, mut g) = (u.clone(), u.clone());
                operator.forces(&u, &mut f, &mut operator.scratch());
                full.apply(&u, &mut g);
                let worst = f.iter().zip(&g).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
                let size = dot(&g, &g).sqrt();
                assert!(worst < 1e-12 * size, "{worst} of {size}, curved: {curved}");
                let diagonal = operator.inverse_diagonal();
                for i in [0, 1, 3] {
                    let k = full.row(i).find(|(j, _)| *j == i).expect("on the diagonal").1;
                    assert!(
                        (*k * diagonal[i] - DMat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < 1e-9)
                    );
                }
                // Rigid motions cost nothing.
                let (shift, turn) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.3, 0.2, -0.7));
                let rigid: Vec<DVec3> = mesh.nodes.iter().map(|p| shift + turn.cross(*p)).collect();
                operator.forces(&rigid, &mut f, &mut operator.scratch());
                assert!(f.iter().all(|f| f.length() < 1e-11 * size), "{f:?}");
            }
        }
    }
}
