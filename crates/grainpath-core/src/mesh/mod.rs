//! Triangle meshes as read from a file: vertices, triangles, and their defects.

mod examined;
mod repeats;
mod stray;
mod topology;
mod weld;

use glam::DVec3;

pub use examined::Examined;
pub use repeats::{Repeats, find_repeats};
pub use stray::{Strays, find_strays};
pub use topology::{EdgeUses, MeshHealth, Shells, diagnose, examine};
pub use weld::{VertexWelder, weld_targets, weld_within};

/// Unit normal of a triangle, towards the side from which its corners are counter-clockwise; zero for one without area.
///
/// ```
/// use grainpath_core::{DVec3, mesh::triangle_normal};
///
/// assert_eq!(triangle_normal([DVec3::ZERO, DVec3::X, DVec3::Y]), DVec3::Z);
/// assert_eq!(triangle_normal([DVec3::ZERO, DVec3::X, 2.0 * DVec3::X]), DVec3::ZERO);
/// ```
pub fn triangle_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// Triangles over shared vertices; positions are in mm once the file is read. The mesh may have
/// holes and triangles of either winding; [`diagnose`] counts such defects.
///
/// ```
/// use grainpath_core::{DVec3, TriMesh, mesh::diagnose};
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let tetrahedron = TriMesh { vertices, triangles };
/// assert!((tetrahedron.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
/// assert_eq!(diagnose(&tetrahedron).unwrap().open_edges, 0);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// Vertex positions, `(n_vertices, 3)`.
    pub vertices: Vec<DVec3>,
    /// Vertex indices, `(n_triangles, 3)`; counter-clockwise seen from outside, unless the file winds them wrongly.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// A box between its lowest and its highest corner, wound outwards.
    ///
    /// ```
    /// use grainpath_core::{DVec3, TriMesh};
    ///
    /// let plate = TriMesh::cuboid(DVec3::ZERO, DVec3::new(40.0, 20.0, 0.5));
    /// assert_eq!(plate.triangles.len(), 12);
    /// assert!((plate.signed_volume() - 400.0).abs() < 1e-9);
    /// ```
    pub fn cuboid(low: DVec3, high: DVec3) -> Self {
        // Bit 0 of a corner is x, bit 1 y, bit 2 z; each face is counter-clockwise from outside.
        let corner = |k: usize| {
            DVec3::from_array(std::array::from_fn(|a| if k >> a & 1 == 1 { high[a] } else { low[a] }))
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Self {
            vertices: (0..8).map(corner).collect(),
            triangles: faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect(),
        }
    }

    /// Unit normal of a triangle of the mesh, see [`triangle_normal`].
    pub fn normal(&self, triangle: [u32; 3]) -> DVec3 {
        triangle_normal(triangle.map(|i| self.vertices[i as usize]))
    }

    /// Signed volume in the cube of the vertices' unit; positive for outward winding.
    pub fn signed_volume(&self) -> f64 {
        let v = |i: u32| self.vertices[i as usize];
        self.triangles.iter().map(|&[a, b, c]| v(a).dot(v(b).cross(v(c))) / 6.0).sum()
    }

    /// Lowest and highest corner of the box around all vertices that a triangle uses; `None` for an
    /// empty mesh.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut points = self.triangles.iter().flatten().map(|&i| self.vertices[i as usize]);
        let first = points.next()?;
        Some(points.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }
}
