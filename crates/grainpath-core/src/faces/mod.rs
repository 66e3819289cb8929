//! Faces of a part: its triangles grouped into planes, cylinders, cones, spheres and free surfaces,
//! with names that survive another export of the same part.
//!
//! Method. (1) Vertices are welded where the mesh has open edges. (2) Coplanar triangles become flat
//! pieces. (3) From small patches of neighbouring pieces a cylinder, a cone or a sphere is fitted to
//! the vertices by Levenberg and Marquardt's least squares (`more1978`) and grown over neighbours as
//! long as all vertices lie on it; a larger region gives a better fit, which lets it grow further.
//! Growth from seeds with a test of the fit follows `besl1988`. Exporters place the vertices of a
//! curved surface exactly on it for any chord error. The vertices therefore distinguish a fillet from the
//! plane that it runs into; the angles between triangles cannot. (4) Flat pieces that do not
//! continue as a chain of equal bends are planes. (5) The other pieces are joined across edges below 20
//! degrees, and across edges below 40 degrees inside such a chain (hysteresis, as in `canny1986`).
//!
//! A region needs at least three pieces to count as curved: two planes that meet in a blunt edge always
//! lie on some cylinder. A prism of 10 sides or more is therefore reported as a cylinder; one of 9
//! sides or fewer (edges of 40 degrees or more) as planes.
//!
//! Units: those of the mesh, mm after scaling; angles in radians. Cost: linear in the triangles,
//! plus a sort; the number of failed seeds is bounded. Limits: surfaces with noise above 5e-6 of
//! their coordinates (scans) fit no primitive and stay free surfaces; tori and splines are free. Cones and cylinders
//! of meshes with a chord error of 3e-5 mm and less may fall into pieces.
//!
//! Names are described in [`name`].

mod fit;
mod graph;
mod grow;
mod leftovers;
pub mod name;
mod planes;
mod face_kind;

use std::fmt::Write as _;

use glam::DVec3;

use crate::TriMesh;
pub use face_kind::Surface;
use graph::{Graph, NONE};
use name::{DIGITS, Description, MAX_DISTANCE, MIN_MARGIN};
pub use name::{FaceError, FaceName};

/// A face of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Kind and measures of its surface.
    pub surface: Surface,
    /// The indices of its triangles in the mesh, ascending.
    pub triangles: Vec<u32>,
    /// Sum of their areas.
    pub area_mm2: f64,
    /// Centroid of its surface; for a full cylinder this is a point of the axis.
    pub centroid: DVec3,
}

/// The faces of a mesh.
///
/// ```
/// use grainpath_core::faces::{Faces, Surface};
/// use grainpath_core::{DVec3, TriMesh};
///
/// let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
/// let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
/// let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
/// let cube = TriMesh { vertices: (0..8).map(corner).collect(), triangles };
///
/// let faces = Faces::segment(&cube);
/// assert_eq!(faces.len(), 6);
/// let top = faces.of_triangle(10).unwrap();
/// assert_eq!(faces.all()[top].surface, Surface::Plane { normal: DVec3::Z });
/// // The name of a face finds it again.
/// assert_eq!(faces.find(&faces.name(top)).unwrap(), top);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Faces {
    faces: Vec<Face>,
    descriptions: Vec<Description>,
    of_triangle: Vec<u32>,
    /// Scale and shift of the mesh from its file, for messages.
    from_file: (f64, DVec3),
}

/// Rounding error of coordinates in mesh files, as a share of the largest coordinate: 6e-8 for 32-bit
/// floats, 5e-7 to 5e-6 for text of six digits. Source: derived: half a unit in the sixth digit of 1.00000.
const ROUNDING: f64 = 5e-6;

impl Faces {
    /// Finds the faces of a mesh, largest first.
    pub fn segment(mesh: &TriMesh) -> Self {
        let Some((low, high)) = mesh.bounds() else { return Self::empty() };
        let largest = low.abs().max(high.abs()).max_element().max((high - low).length());
        let graph = Graph::new(mesh, ROUNDING * largest);
        let pieces = planes::flat_pieces(&graph);
        let mut label = vec![NONE; mesh.triangles.len()];
        let mut surfaces = grow::curved(&graph, &pieces, &mut label);
        leftovers::label(&graph, &pieces, &mut label, &mut surfaces);
        Self::gathered(&graph, label, &surfaces, (low, high))
    }

    /// No faces.
    fn empty() -> Self {
        Self {
            faces: Vec::new(),
            descriptions: Vec::new(),
            of_triangle: Vec::new(),
            from_file: (1.0, DVec3::ZERO),
        }
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.faces.len()
    }

    /// Whether the mesh has no triangle with an area.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// The faces, by area, largest first.
    pub fn all(&self) -> &[Face] {
        &self.faces
    }

    /// The same faces, told by errors in the coordinates of the file, as `grainpath inspect --faces` lists them. The mesh
    /// is the file's scaled by `scale` and then shifted by `shift_mm`.
    #[must_use]
    pub fn told_in_file(self, scale: f64, shift_mm: DVec3) -> Self {
        Self { from_file: (scale, shift_mm), ..self }
    }

    /// The face that a triangle of the mesh belongs to.
    pub fn of_triangle(&self, triangle: usize) -> Option<usize> {
        self.of_triangle.get(triangle).filter(|&&f| f != NONE).map(|&f| f as usize)
    }

    /// The name of a face: the shortest name that finds it. If none does, the longest name.
    ///
    /// # Panics
    /// When there is no such face.
    pub fn name(&self, face: usize) -> String {
        let own = &self.descriptions[face];
        let alone = |digits: &usize| {
            let name = own.name(*digits);
            let mut others = self.descriptions.iter().enumerate().filter(|(i, _)| *i != face);
            others.all(|(_, other)| name.distance(other) >= MAX_DISTANCE + MIN_MARGIN)
        };
        let digits = (DIGITS.0..=DIGITS.1).find(alone).unwrap_or(DIGITS.1);
        own.name(digits).to_string()
    }

    /// The face that a name means.
    ///
    /// # Errors
    /// [`FaceError`] for text that is not a name, and for names that mean no face or several faces; it lists
    /// the nearest faces.
    pub fn find(&self, text: &str) -> Result<usize, FaceError> {
        self.find_name(&text.parse()?)
    }

    /// The face that a name means.
    ///
    /// # Errors
    /// As [`Faces::find`].
    pub fn find_name(&self, name: &FaceName) -> Result<usize, FaceError> {
        let mut near: Vec<(f64, usize)> =
            self.descriptions.iter().enumerate().map(|(i, d)| (name.distance(d), i)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let first = near.first().copied().filter(|n| n.0 <= MAX_DISTANCE);
        let Some((distance, face)) = first else {
            let candidates = self.listed(near.iter().take(3).map(|n| n.1));
            return Err(FaceError::NotFound { name: name.to_string(), candidates });
        };
        let alike: Vec<usize> =
            near.iter().take_while(|n| n.0 < distance + MIN_MARGIN).take(4).map(|n| n.1).collect();
        if alike.len() > 1 {
            let candidates = self.listed(alike.into_iter());
            return Err(FaceError::Doubtful { name: name.to_string(), candidates });
        }
        Ok(face)
    }

    /// A list of faces as text for error messages.
    fn listed(&self, faces: impl Iterator<Item = usize>) -> String {
        let mut text = String::new();
        for face in faces {
            let f = &self.faces[face];
            let (scale, shift_mm) = self.from_file;
            let c = (f.centroid - shift_mm) / scale;
            let join = if text.is_empty() { "" } else { ", " };
            // Writing to a `String` cannot fail.
            let _ = write!(
                text,
                "{join}{} ({} of {:.1} mm2 at {:.2}, {:.2}, {:.2} in the file)",
                self.name(face),
                f.surface.word(),
                f.area_mm2 / (scale * scale),
                c.x,
                c.y,
                c.z
            );
        }
        text
    }

    /// Measures the labelled faces and sorts them by area.
    fn gathered(graph: &Graph, label: Vec<u32>, kinds: &[grow::Kind], bounds: (DVec3, DVec3)) -> Self {
        let mut members = vec![Vec::new(); kinds.len()];
        for (t, &l) in label.iter().enumerate().filter(|(_, l)| **l != NONE) {
            members[l as usize].push(t as u32);
        }
        let mut faces: Vec<(Face, Description)> = Vec::with_capacity(kinds.len());
        for (triangles, kind) in members.into_iter().zip(kinds) {
            let (mut area, mut vector, mut moment) = (0.0, DVec3::ZERO, DVec3::ZERO);
            for &t in &triangles {
                area += graph.area[t as usize];
                vector += graph.area[t as usize] * graph.normal[t as usize];
                moment += graph.area[t as usize] * graph.centroid(t as usize);
            }
            if area <= 0.0 {
                continue;
            }
            let centroid = moment / area;
            // The surface integral of the normal times the position about the centroid: radius times area for a
            // whole cylinder, negative for a hole, zero for a plane.
            let flux: f64 = triangles
                .iter()
                .map(|&t| graph.area[t as usize] * graph.normal[t as usize])
                .zip(triangles.iter().map(|&t| graph.centroid(t as usize) - centroid))
                .map(|(a, p)| a.dot(p))
                .sum();
            let description = Description::new(centroid, vector / area, area, flux / area, bounds);
            let surface = kind.surface(centroid, vector.normalize_or(DVec3::Z));
            faces.push((Face { surface, triangles, area_mm2: area, centroid }, description));
        }
        let lowest = |f: &Face| f.triangles[0];
        faces.sort_by(|(a, _), (b, _)| {
            b.area_mm2.total_cmp(&a.area_mm2).then_with(|| lowest(a).cmp(&lowest(b)))
        });
        let mut of_triangle = vec![NONE; label.len()];
        for (f, (face, _)) in faces.iter().enumerate() {
            face.triangles.iter().for_each(|&t| of_triangle[t as usize] = f as u32);
        }
        let (faces, descriptions) = faces.into_iter().unzip();
        Self { faces, descriptions, of_triangle, from_file: (1.0, DVec3::ZERO) }
    }
}

#[cfg(test)]
mod tests;
