//! Meshes of quadratic triangles for plates.
//!
//! Method: the region is cut into triangles of good shape (`ruppert1995`), with shorter sides around small
//! holes. Each side then gets a node half way between its ends, shared by both triangles. To number them, the
//! sides are sorted by their ends; a side that occurs once lies on the border. Connected pieces are found by
//! union-find over the nodes.
//!
//! Lengths are in mm. `nodes` is `(n)`, corners first; `elements` is `(n_elements, 6)`, counter-clockwise:
//! corners, then the middles of sides 01, 12 and 20. `border` has both ends and the middle of a side, with
//! the material on the left. Cost: sorting three sides a triangle, after the triangulation.
//!
//! Limits: sides are straight; the contour of a hole is cut into at least 72 of them where these are longer
//! than the shortest side allowed. An empty region, contours that cross, and more than three million points
//! are errors of the triangulation.

use std::collections::BTreeMap;

use grainpath_core::triangulation::{TriangleSize, Triangulation, TriangulationError};
use grainpath_core::{DVec2, DisjointSets, Region};

/// Quadratic triangles: three corners, then the nodes in the middle of sides 01, 12 and 20.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneMesh {
    /// Nodes, mm.
    pub nodes: Vec<DVec2>,
    /// Node indices, `(n_elements, 6)`, counter-clockwise.
    pub elements: Vec<[u32; 6]>,
    /// Sides that belong to one element: both ends and the middle node, with the material on the
    /// left.
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
        // After sorting by end nodes, the two copies of a shared side are neighbours in the list.
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

    /// The connected piece of each node, and the number of pieces.
    pub fn pieces(&self) -> (Vec<u32>, usize) {
        let mut connected = DisjointSets::new(self.nodes.len());
        for e in &self.elements {
            e[1..].iter().for_each(|&node| {
                connected.union(e[0] as usize, node as usize);
            });
        }
        // Pieces are numbered in the order of their first node, whatever the order of the unions.
        let mut number = BTreeMap::new();
        let piece: Vec<u32> = connected
            .names()
            .into_iter()
            .map(|lowest| {
                let next = number.len() as u32;
                *number.entry(lowest).or_insert(next)
            })
            .collect();
        (piece, number.len())
    }
}

/// Meshes a region with element sides of at most `longest_mm`, and smaller ones around small holes.
///
/// # Errors
/// When the region cannot be cut into triangles.
pub fn mesh_region(
    region: &Region,
    longest_mm: f64,
    shortest_mm: f64,
) -> Result<PlaneMesh, TriangulationError> {
    // 72 sides cut a circle into steps of 5 degrees, so that small holes get small triangles.
    let size = TriangleSize { longest_mm, sides_of_hole: 72, shortest_mm };
    Ok(PlaneMesh::quadratic(&Triangulation::new(region, &size, &[])?))
}
