//! Loads of a plate as forces at its nodes.
//!
//! Method: consistent forces. A traction on the border or a force per volume is integrated against the shape
//! functions of the element. The nodal forces therefore do the same work as the load in every displacement of
//! the mesh. A constant traction on a straight side, for example, gives the middle node four times the force
//! of an end node. A side is integrated at three Gauss points, which is exact for a traction that is quadratic
//! along a straight side; sides may be curved. An element is integrated at three points, which is exact to
//! degree 2. A load may begin or end within a side.
//!
//! Tractions are in MPa, forces per volume in N/mm3, thickness in mm. Results are forces in N, one vector for
//! each node. The normal points out of the plate. Cost: linear in the loaded sides, or in the elements for a
//! force per volume. Degenerate cases: without sides all forces are zero, and a loaded stretch of length zero
//! adds no force. A side of length zero has no normal and gives forces that are not a number.

use grainpath_core::DVec2;

use super::plane_mesh::PlaneMesh;
use super::quadratic_triangle as element;

/// A side of an element on the border, and the stretch of it that carries a load. The material lies to the left
/// of the way from the first end to the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadedSide {
    /// The nodes at both ends, then the node in the middle.
    pub nodes: [u32; 3],
    /// Where the load begins: 0 at the first end, 0.5 at the middle node, 1 at the second end.
    pub from: f64,
    /// Where the load ends, in the same measure; not less than `from`.
    pub to: f64,
}

impl From<[u32; 3]> for LoadedSide {
    fn from(nodes: [u32; 3]) -> Self {
        Self { nodes, from: 0.0, to: 1.0 }
    }
}

/// Forces at the nodes, N, from a traction on sides of the border. `traction` gets the point, mm, and the
/// outward unit normal, and returns the traction there, MPa.
pub fn traction_n<S: Copy + Into<LoadedSide>>(
    mesh: &PlaneMesh,
    sides: &[S],
    thickness_mm: f64,
    traction: &dyn Fn(DVec2, DVec2) -> DVec2,
) -> Vec<DVec2> {
    let mut forces = vec![DVec2::ZERO; mesh.nodes.len()];
    for side in sides {
        let LoadedSide { nodes: side, from, to } = (*side).into();
        let [a, b, m] = side.map(|i| mesh.nodes[i as usize]);
        // Three points are exact to degree 5: enough for a quadratic traction times a quadratic shape function.
        // The points are moved from the whole side, -1 to 1, onto its loaded stretch.
        for (xi, weight) in element::GAUSS_3 {
            let (xi, weight) = (from + to - 1.0 + (to - from) * xi, (to - from) * weight);
            let shape = [0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi];
            let slope = [xi - 0.5, xi + 0.5, -2.0 * xi];
            // Sides may be curved, so point and normal are those of the quadratic through the three nodes.
            let p = shape[0] * a + shape[1] * b + shape[2] * m;
            let along = slope[0] * a + slope[1] * b + slope[2] * m;
            // The material lies to the left of a side, so the outward normal points to the right.
            let normal = DVec2::new(along.y, -along.x) / along.length();
            let f = traction(p, normal) * (weight * along.length() * thickness_mm);
            side.iter().zip(shape).for_each(|(&i, s)| forces[i as usize] += s * f);
        }
    }
    forces
}

/// Forces at the nodes, N, from a constant force per volume, N/mm3.
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
