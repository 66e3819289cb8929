//! Kinds of surfaces of a face, with their measures.

use glam::DVec3;

/// The kind of a face's surface, with its measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surface {
    /// A plane.
    Plane {
        /// Unit normal; it points away from the material if the mesh is correctly oriented.
        normal: DVec3,
    },
    /// A circular cylinder, or a part of one.
    Cylinder {
        /// The point of the axis nearest to the centroid of the face.
        point: DVec3,
        /// Unit vector along the axis; its largest component is positive.
        axis: DVec3,
        /// Radius.
        radius_mm: f64,
        /// Whether the material lies outside: a hole or an inner fillet.
        hollow: bool,
    },
    /// A circular cone, or a part of one.
    Cone {
        /// The point of the axis nearest to the centroid of the face.
        point: DVec3,
        /// Unit vector along the axis; the cone widens along it.
        axis: DVec3,
        /// Radius at `point`.
        radius_mm: f64,
        /// Angle between the axis and the surface.
        half_angle_rad: f64,
        /// Whether the material lies outside.
        hollow: bool,
    },
    /// A sphere, or a part of one.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Radius.
        radius_mm: f64,
        /// Whether the material lies outside.
        hollow: bool,
    },
    /// Any other surface: a torus, a spline, a scan.
    Free,
}

impl Surface {
    /// The word for the kind of surface, for example "plane".
    pub fn word(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Free => "free",
        }
    }
}
