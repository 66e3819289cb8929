//! Shape measures of a tetrahedron: dihedral angles, aspect, mean ratio.

use grainpath_core::{DVec3, math};

/// Shape of one tetrahedron, measured on its four corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TetQuality {
    /// Smallest and largest angle between two faces, degrees; 70.5 all round for a regular one.
    pub dihedral_min_deg: f64,
    /// See `dihedral_min_deg`.
    pub dihedral_max_deg: f64,
    /// Longest edge over shortest height, 1 for a regular tetrahedron, infinite for a flat one.
    pub aspect: f64,
}

/// The worst shapes of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshQuality {
    /// Smallest and largest angle between two faces of any tetrahedron, degrees.
    pub dihedral_min_deg: f64,
    /// See `dihedral_min_deg`.
    pub dihedral_max_deg: f64,
    /// Largest and mean ratio of longest edge to shortest height, where a regular tetrahedron has 1.
    pub aspect_max: f64,
    /// See `aspect_max`.
    pub aspect_mean: f64,
    /// Tetrahedra with a dihedral angle below 10 or above 165 degrees.
    pub n_poor: usize,
}

/// Pairs of corners in the order of the middle nodes. Source: definition, the order of VTK and
/// Abaqus.
pub(crate) const EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
/// Corners of the face opposite to each corner, counter-clockwise seen from outside. Source:
/// derived from the positive volume of the corners in order.
pub(crate) const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

pub(crate) fn volume(p: &[DVec3; 4]) -> f64 {
    (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) / 6.0
}

/// Mean ratio (`liu1994`): 1 for a regular tetrahedron, 0 for a flat one, negative for one turned
/// inside out.
pub(crate) fn mean_ratio(p: &[DVec3; 4]) -> f64 {
    let squares: f64 = EDGES.iter().map(|&(i, j)| p[i].distance_squared(p[j])).sum();
    let v = 3.0 * volume(p);
    // The cube root of the squared volume is divided by the sum of the squared edges, so the
    // measure does not depend on size.
    12.0 * (v.abs() * v.abs()).cbrt().copysign(v) / squares
}

pub(crate) fn quality(p: &[DVec3; 4]) -> TetQuality {
    let areas = FACES.map(|f| (p[f[1]] - p[f[0]]).cross(p[f[2]] - p[f[0]]));
    let (mut lo, mut hi) = (180.0f64, 0.0f64);
    for i in 0..4 {
        for j in 0..i {
            let cos = -areas[i].dot(areas[j]) / (areas[i].length() * areas[j].length());
            let angle = math::acos(cos.clamp(-1.0, 1.0)).to_degrees();
            lo = lo.min(angle);
            hi = hi.max(angle);
        }
    }
    let longest = EDGES.iter().map(|&(i, j)| p[i].distance(p[j])).fold(0.0, f64::max);
    let height = 6.0 * volume(p).abs() / areas.iter().map(|a| a.length()).fold(0.0, f64::max);
    let regular = (2.0f64 / 3.0).sqrt();
    TetQuality { dihedral_min_deg: lo, dihedral_max_deg: hi, aspect: regular * longest / height }
}
