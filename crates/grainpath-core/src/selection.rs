//! Selections: the places of a part where fixtures and loads act.
//!
//! Coordinates are in mm in part coordinates. Cost: constant for simple shapes, linear in the
//! triangles for lists of facets.

use crate::DVec3;

/// The part of a surface that lies in a shape, mm, part coordinates.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// Between two corners.
    Box {
        /// Lowest corner.
        low: DVec3,
        /// Highest corner.
        high: DVec3,
    },
    /// Within a distance of a plane.
    Plane {
        /// A point of it.
        point: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Greatest distance from the plane, mm.
        tolerance_mm: f64,
    },
    /// Within a radius of an axis: the wall of a bolt hole, the contact of a roller.
    Cylinder {
        /// A point of the axis; with a length given, the middle of the cylinder.
        point: DVec3,
        /// Unit vector along it.
        axis: DVec3,
        /// Points up to this far from the axis count, mm.
        radius_mm: f64,
        /// Length of the cylinder, mm; `None` for an endless one.
        length_mm: Option<f64>,
    },
    /// Within a radius of a point.
    Sphere {
        /// The point.
        centre: DVec3,
        /// The radius, mm.
        radius_mm: f64,
    },
    /// On these triangles.
    Triangles(Vec<[DVec3; 3]>),
    /// Near these triangles.
    Near {
        /// The triangles of the list.
        triangles: Vec<[DVec3; 3]>,
        /// Greatest distance from a triangle, mm.
        within_mm: f64,
    },
}

/// Greatest distance of a selected point from a listed triangle, mm. Source: derived. A tenth of a layer of 0.2 mm: more
/// than meshing and rounding move a point, less than the next surface is away.
const ON_TRIANGLE_MM: f64 = 0.02;

impl Selection {
    /// Whether a point of the part is selected.
    pub fn contains(&self, p: DVec3) -> bool {
        // A nanometre of tolerance: coordinates typed in a job select the faces that lie on them,
        // whatever the rounding.
        let hair = 1e-6;
        match self {
            Self::Box { low, high } => (*low - hair).cmple(p).all() && p.cmple(*high + hair).all(),
            Self::Plane { point, normal, tolerance_mm } => {
                (p - *point).dot(*normal).abs() <= *tolerance_mm + hair
            }
            Self::Cylinder { point, axis, radius_mm, length_mm } => {
                let along = (p - *point).dot(*axis);
                let off = (p - *point - along * *axis).length();
                off <= *radius_mm + hair && length_mm.is_none_or(|l| along.abs() <= 0.5 * l + hair)
            }
            Self::Sphere { centre, radius_mm } => p.distance(*centre) <= *radius_mm + hair,
            Self::Triangles(all) => all.iter().any(|t| distance_to_triangle(p, t) <= ON_TRIANGLE_MM),
            Self::Near { triangles, within_mm } => {
                triangles.iter().any(|t| distance_to_triangle(p, t) <= *within_mm)
            }
        }
    }

    /// The same selection and everything within `by_mm` of it.
    #[must_use]
    pub fn grown(&self, by_mm: f64) -> Self {
        let mut wide = self.clone();
        match &mut wide {
            Self::Box { low, high } => (*low, *high) = (*low - by_mm, *high + by_mm),
            Self::Plane { tolerance_mm, .. } => *tolerance_mm += by_mm,
            Self::Cylinder { radius_mm, length_mm, .. } => {
                *radius_mm += by_mm;
                if let Some(length) = length_mm {
                    *length += 2.0 * by_mm;
                }
            }
            Self::Sphere { radius_mm, .. } => *radius_mm += by_mm,
            Self::Near { within_mm, .. } => *within_mm += by_mm,
            Self::Triangles(all) => {
                // The list has no distance of its own to enlarge, so it becomes a list with one.
                wide = Self::Near { triangles: std::mem::take(all), within_mm: ON_TRIANGLE_MM + by_mm };
            }
        }
        wide
    }

    /// The name used in errors.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Plane { .. } => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Sphere { .. } => "sphere",
            Self::Triangles(_) | Self::Near { .. } => "list of facets",
        }
    }
}

/// Distance of a point from a triangle, mm.
fn distance_to_triangle(p: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let (u, v, w) = (*b - *a, *c - *a, p - *a);
    let n = u.cross(v);
    let n2 = n.length_squared();
    if n2 > 0.0 {
        let (s, t) = (w.cross(v).dot(n) / n2, u.cross(w).dot(n) / n2);
        // Inside the triangle's prism the nearest point is the projection; elsewhere it lies on a
        // side.
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return w.dot(n).abs() / n2.sqrt();
        }
    }
    let to_segment = |a: DVec3, b: DVec3| {
        let d = b - a;
        let t = ((p - a).dot(d) / d.length_squared().max(1e-300)).clamp(0.0, 1.0);
        p.distance(a + t * d)
    };
    to_segment(*a, *b).min(to_segment(*b, *c)).min(to_segment(*c, *a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_hold_what_they_should() {
        let p = DVec3::new(3.0, 4.0, 1.0);
        let hole = |radius_mm, length_mm| Selection::Cylinder {
            point: DVec3::ZERO,
            axis: DVec3::Z,
            radius_mm,
            length_mm,
        };
        assert!(hole(5.0, None).contains(p) && !hole(4.99, None).contains(p));
        assert!(hole(5.0, Some(2.0)).contains(p) && !hole(5.0, Some(1.9)).contains(p));
        assert!(Selection::Sphere { centre: DVec3::Z, radius_mm: 5.0 }.contains(p));
        assert!(Selection::Box { low: DVec3::ZERO, high: p }.contains(p));
        let plane = |tolerance_mm| Selection::Plane { point: DVec3::ZERO, normal: DVec3::X, tolerance_mm };
        assert!(plane(3.0).contains(p) && !plane(2.9).contains(p));
        let triangle = [DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
        let facets = Selection::Triangles(vec![triangle]);
        assert!(facets.contains(DVec3::new(2.0, 3.0, 0.01)) && !facets.contains(p));
        assert!(!facets.contains(DVec3::new(8.0, 8.0, 0.0)));
    }
}
