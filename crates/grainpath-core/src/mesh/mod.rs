//! Triangle meshes as read from a file.

mod topology;
mod weld;

use glam::DVec3;

pub use topology::{EdgeUses, MeshHealth, Shells, diagnose};
pub use weld::{VertexWelder, weld_within};

/// Triangles over shared vertices, in mm once read. Nothing is promised about closedness or winding.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// Vertex positions, `(n_vertices, 3)`.
    pub vertices: Vec<DVec3>,
    /// Vertex indices, `(n_triangles, 3)`, counter-clockwise seen from outside where the file is right.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Signed volume in the cube of the vertices' unit; positive for outward winding.
    pub fn signed_volume(&self) -> f64 {
        let v = |i: u32| self.vertices[i as usize];
        self.triangles.iter().map(|&[a, b, c]| v(a).dot(v(b).cross(v(c))) / 6.0).sum()
    }

    /// Lowest and highest corner of the box around all vertices that a triangle uses; `None` for an empty mesh.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut points = self.triangles.iter().flatten().map(|&i| self.vertices[i as usize]);
        let first = points.next()?;
        Some(points.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }
}
