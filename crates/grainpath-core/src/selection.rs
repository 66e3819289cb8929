//! Selections: the places of a part where fixtures and loads act.
//!
//! Coordinates are in mm in part coordinates. Cost: constant for simple shapes, logarithmic in the
//! triangles for lists of facets.

use std::sync::Arc;

use crate::{Bvh, DMat3, DVec3, TriMesh};

/// The shape or list of facets that selects a part of a surface; mm, part coordinates.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// Within a box along the axes.
    Box {
        /// Lowest corner.
        low: DVec3,
        /// Highest corner.
        high: DVec3,
    },
    /// Within a box that is turned.
    TurnedBox {
        /// Its middle.
        centre: DVec3,
        /// Half of its lengths along its own axes.
        half: DVec3,
        /// Unit vectors along its axes, as columns.
        axes: DMat3,
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
    Triangles(Facets),
    /// Near these triangles.
    Near {
        /// The triangles of the list.
        triangles: Facets,
        /// Greatest distance from a triangle, mm.
        within_mm: f64,
    },
    /// On a piece of the part's surface, given as triangles of another mesh of the part.
    Patch(SurfacePatch),
    /// At these points. Each is stored as a triangle whose three corners coincide.
    Points(Facets),
}

/// A piece of a part's surface, taken from another mesh of the part. On curved surfaces the two meshes lie slightly apart.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePatch {
    /// Its triangles, counter-clockwise seen from outside.
    pub triangles: Facets,
    /// Greatest distance between the two meshes of the surface, mm.
    pub within_mm: f64,
}

/// Least cosine between the normals of two meshes at the same place of a surface. Source: derived: a circle of six sides and
/// one whose corners lie on the middles of those sides differ by 30 degrees; beyond 60 degrees there is an edge between.
const SAME_SIDE: f64 = 0.5;

impl SurfacePatch {
    /// The triangle of the patch nearest to a point of the part's surface, and the barycentric coordinates of the point
    /// in it. `None` for a point off the patch, and for a point whose outward `normal` shows that it lies across an edge
    /// or a thin wall.
    pub fn at(&self, p: DVec3, normal: Option<DVec3>) -> Option<(usize, [f64; 3])> {
        let found = self.triangles.search.closest_point(p, 1.001 * self.within_mm + f64::MIN_POSITIVE)?;
        let [a, b, c] = self.triangles.triangles.get(found.triangle as usize).copied()?;
        let (u, v) = (b - a, c - a);
        let area = u.cross(v);
        let outward = area.try_normalize()?;
        let off = p - found.point;
        let is_far =
            found.distance > self.within_mm || off.reject_from_normalized(outward).length() > ON_TRIANGLE_MM;
        if is_far || normal.is_some_and(|n| n.dot(outward) < SAME_SIDE) {
            return None;
        }
        let w = found.point - a;
        let square = area.length_squared();
        let (second, third) = (w.cross(v).dot(area) / square, u.cross(w).dot(area) / square);
        Some((found.triangle as usize, [1.0 - second - third, second, third]))
    }

    /// Its area, mm2.
    pub fn area_mm2(&self) -> f64 {
        self.triangles.area_mm2()
    }
}

/// What of a triangle lies on the side of a plane to which its normal points: at most two triangles.
fn side_of(triangle: &[DVec3; 3], point: DVec3, normal: DVec3) -> Vec<[DVec3; 3]> {
    let above = triangle.map(|p| (p - point).dot(normal));
    // The corners of what is kept, in the order of the triangle: three or four where the plane crosses it.
    let mut corners: Vec<DVec3> = Vec::with_capacity(4);
    for k in 0..3 {
        let next = (k + 1) % 3;
        if above[k] >= 0.0 {
            corners.push(triangle[k]);
        }
        if (above[k] > 0.0 && above[next] < 0.0) || (above[k] < 0.0 && above[next] > 0.0) {
            let share = above[k] / (above[k] - above[next]);
            corners.push(triangle[k].lerp(triangle[next], share));
        }
    }
    // A triangle that only touches the plane leaves a point or an edge, which has no area.
    let pieces = (2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]);
    pieces.filter(|piece| area_mm2(piece) > 0.0).collect()
}

/// Area of a triangle, mm2.
fn area_mm2([a, b, c]: &[DVec3; 3]) -> f64 {
    0.5 * (*b - *a).cross(*c - *a).length()
}

/// A list of triangles that answers quickly how far a point is from them.
#[derive(Debug, Clone)]
pub struct Facets {
    triangles: Arc<Vec<[DVec3; 3]>>,
    search: Arc<Bvh>,
}

impl Facets {
    /// The triangles with these corners.
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let mesh = TriMesh {
            vertices: triangles.iter().flatten().copied().collect(),
            triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        };
        Self { search: Arc::new(Bvh::new(&mesh)), triangles: Arc::new(triangles) }
    }

    /// The corners of each triangle.
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.triangles
    }

    /// What lies on the side of a plane to which its normal points. Triangles that the plane crosses are cut along it.
    #[must_use]
    pub fn on_side(&self, point: DVec3, normal: DVec3) -> Self {
        let mut kept = Vec::with_capacity(self.triangles.len());
        self.triangles.iter().for_each(|t| kept.extend(side_of(t, point, normal)));
        Self::new(kept)
    }

    /// Area of all triangles, mm2.
    pub fn area_mm2(&self) -> f64 {
        self.triangles.iter().map(area_mm2).sum()
    }

    /// Centroid of the area; `None` without an area.
    pub fn centroid(&self) -> Option<DVec3> {
        let sum: DVec3 = self.triangles.iter().map(|t| t.iter().sum::<DVec3>() / 3.0 * area_mm2(t)).sum();
        let area = self.area_mm2();
        (area > 0.0).then(|| sum / area)
    }

    /// Whether a point lies within a distance of a triangle.
    fn is_near(&self, p: DVec3, within_mm: f64) -> bool {
        // The search radius is slightly larger than the distance asked for, so that no point is lost by rounding.
        let found = self.search.closest_point(p, 1.001 * within_mm + f64::MIN_POSITIVE);
        found.is_some_and(|found| found.distance <= within_mm)
    }
}

impl PartialEq for Facets {
    fn eq(&self, other: &Self) -> bool {
        self.triangles == other.triangles
    }
}

/// Greatest distance of a selected point from a listed triangle, mm. Source: derived. A tenth of a layer of 0.2 mm.
/// Meshing and rounding move a point by less, and the next surface is farther away.
const ON_TRIANGLE_MM: f64 = 0.02;

/// Every box, plane, cylinder and sphere is taken this much larger, mm. Nodes of a section lie up to this far from its true
/// outline, and coordinates typed in a job still have to select the faces that lie on them. Source: derived. Ten times the
/// grid that outlines are rounded to ([`GRID_MM`](crate::poly::GRID_MM)), and a micrometre, the last digit of G-code.
const ROUNDED_MM: f64 = 1e-3;

impl Selection {
    /// Whether a point of the part is selected.
    pub fn contains(&self, p: DVec3) -> bool {
        let hair = ROUNDED_MM;
        match self {
            Self::Box { low, high } => (*low - hair).cmple(p).all() && p.cmple(*high + hair).all(),
            Self::TurnedBox { centre, half, axes } => {
                (axes.transpose() * (p - *centre)).abs().cmple(*half + hair).all()
            }
            Self::Plane { point, normal, tolerance_mm } => {
                (p - *point).dot(*normal).abs() <= *tolerance_mm + hair
            }
            Self::Cylinder { point, axis, radius_mm, length_mm } => {
                let along = (p - *point).dot(*axis);
                let off = (p - *point - along * *axis).length();
                off <= *radius_mm + hair && length_mm.is_none_or(|l| along.abs() <= 0.5 * l + hair)
            }
            Self::Sphere { centre, radius_mm } => p.distance(*centre) <= *radius_mm + hair,
            Self::Triangles(all) => all.is_near(p, ON_TRIANGLE_MM),
            Self::Near { triangles, within_mm } => triangles.is_near(p, *within_mm),
            Self::Patch(patch) => patch.at(p, None).is_some(),
            Self::Points(points) => points.is_near(p, ON_TRIANGLE_MM),
        }
    }

    /// Whether a point of the part's surface with this outward normal is selected. Only patches use the normal.
    pub fn contains_on(&self, p: DVec3, normal: DVec3) -> bool {
        match self {
            Self::Patch(patch) => patch.at(p, Some(normal)).is_some(),
            _ => self.contains(p),
        }
    }

    /// Area of a mesh's surface in the selection, mm2, for boxes, planes and listed facets: facets are cut where a side of
    /// the selection crosses them. `None` for the other shapes.
    pub fn area_on(&self, surface: &TriMesh) -> Option<f64> {
        let slabs = |point: DVec3, axes: DMat3, half: DVec3| -> Vec<(DVec3, DVec3)> {
            let slab = |k: usize| {
                let reach = (half[k] + ROUNDED_MM) * axes.col(k);
                [(point - reach, axes.col(k)), (point + reach, -axes.col(k))]
            };
            (0..3).flat_map(slab).collect()
        };
        // Shapes between planes have an area that is cut exactly; round ones would need pieces of arcs.
        let sides = match self {
            Self::Box { low, high } => slabs(0.5 * (*low + *high), DMat3::IDENTITY, 0.5 * (*high - *low)),
            Self::TurnedBox { centre, half, axes } => slabs(*centre, *axes, *half),
            Self::Plane { point, normal, tolerance_mm } => {
                let reach = (tolerance_mm + ROUNDED_MM) * *normal;
                vec![(*point - reach, *normal), (*point + reach, -*normal)]
            }
            Self::Triangles(all) => return Some(all.area_mm2()),
            Self::Cylinder { .. }
            | Self::Sphere { .. }
            | Self::Near { .. }
            | Self::Patch(_)
            | Self::Points(_) => return None,
        };
        let within = |t: &[u32; 3]| {
            let mut pieces = vec![t.map(|i| surface.vertices[i as usize])];
            for &(point, normal) in &sides {
                pieces = pieces.iter().flat_map(|piece| side_of(piece, point, normal)).collect();
            }
            pieces.iter().map(area_mm2).sum::<f64>()
        };
        Some(surface.triangles.iter().map(within).sum())
    }

    /// Whether a mesh's surface reaches into the selection; for shapes without an area ([`Self::area_on`]), whether the point
    /// of the surface nearest to their middle, or a corner, lies in it.
    pub fn touches(&self, surface: &TriMesh) -> bool {
        if let Some(area) = self.area_on(surface) {
            return area > 0.0;
        }
        let middle = match self {
            Self::Cylinder { point, .. } => Some(*point),
            Self::Sphere { centre, .. } => Some(*centre),
            _ => None,
        };
        // A round shape touches the surface where its middle is nearest to it, or around a corner that it holds.
        let nearest = middle.and_then(|p| Bvh::new(surface).closest_point(p, f64::INFINITY));
        nearest.is_some_and(|found| self.contains(found.point))
            || surface.vertices.iter().any(|p| self.contains(*p))
    }

    /// The same selection and everything within `by_mm` of it.
    #[must_use]
    pub fn grown(&self, by_mm: f64) -> Self {
        let mut wide = self.clone();
        match &mut wide {
            Self::Box { low, high } => (*low, *high) = (*low - by_mm, *high + by_mm),
            Self::TurnedBox { half, .. } => *half += by_mm,
            Self::Plane { tolerance_mm, .. } => *tolerance_mm += by_mm,
            Self::Cylinder { radius_mm, length_mm, .. } => {
                *radius_mm += by_mm;
                if let Some(length) = length_mm {
                    *length += 2.0 * by_mm;
                }
            }
            Self::Sphere { radius_mm, .. } => *radius_mm += by_mm,
            Self::Near { within_mm, .. } => *within_mm += by_mm,
            Self::Patch(patch) => {
                wide = Self::Near { triangles: patch.triangles.clone(), within_mm: patch.within_mm + by_mm };
            }
            Self::Triangles(all) | Self::Points(all) => {
                // A list of triangles has no distance that could be enlarged, so it becomes `Near`, which has one.
                wide = Self::Near { triangles: all.clone(), within_mm: ON_TRIANGLE_MM + by_mm };
            }
        }
        wide
    }

    /// The selection after the part has been scaled, turned by a rotation matrix and shifted, in this
    /// order. A box that is turned becomes a `TurnedBox`.
    #[must_use]
    pub fn moved(&self, scale: f64, rotation: DMat3, shift: DVec3) -> Self {
        let at = |p: DVec3| rotation * (scale * p) + shift;
        let listed = |all: &Facets| Facets::new(all.triangles().iter().map(|t| t.map(at)).collect());
        match self {
            Self::Box { low, high } if rotation == DMat3::IDENTITY => {
                Self::Box { low: at(*low), high: at(*high) }
            }
            Self::Box { low, high } => Self::TurnedBox {
                centre: at(0.5 * (*low + *high)),
                half: 0.5 * scale * (*high - *low),
                axes: rotation,
            },
            Self::TurnedBox { centre, half, axes } => {
                Self::TurnedBox { centre: at(*centre), half: scale * *half, axes: rotation * *axes }
            }
            // The tolerance belongs to the coordinates, not to the part, so it is not scaled.
            Self::Plane { point, normal, tolerance_mm } => {
                Self::Plane { point: at(*point), normal: rotation * *normal, tolerance_mm: *tolerance_mm }
            }
            Self::Cylinder { point, axis, radius_mm, length_mm } => Self::Cylinder {
                point: at(*point),
                axis: rotation * *axis,
                radius_mm: scale * radius_mm,
                length_mm: length_mm.map(|l| scale * l),
            },
            Self::Sphere { centre, radius_mm } => {
                Self::Sphere { centre: at(*centre), radius_mm: scale * radius_mm }
            }
            Self::Triangles(all) => Self::Triangles(listed(all)),
            Self::Near { triangles, within_mm } => {
                Self::Near { triangles: listed(triangles), within_mm: scale * within_mm }
            }
            Self::Patch(patch) => Self::Patch(SurfacePatch {
                triangles: listed(&patch.triangles),
                within_mm: scale * patch.within_mm,
            }),
            Self::Points(points) => Self::Points(listed(points)),
        }
    }

    /// The name used in errors.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Box { .. } | Self::TurnedBox { .. } => "box",
            Self::Plane { .. } => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Sphere { .. } => "sphere",
            Self::Triangles(_) | Self::Near { .. } => "list of facets",
            Self::Patch(_) => "faces of the deck",
            Self::Points(_) => "nodes of the deck",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_within_shapes_are_cut_at_their_sides() {
        let cube = TriMesh::cuboid(DVec3::ZERO, DVec3::splat(10.0));
        let area = |on: &Selection| on.area_on(&cube).expect("a shape with sides");
        let inner = Selection::Box { low: DVec3::new(2.0, 3.0, 9.0), high: DVec3::new(4.0, 6.0, 11.0) };
        let edge = Selection::Box { low: DVec3::new(-1.0, 3.0, 9.0), high: DVec3::new(4.0, 6.0, 11.0) };
        let side = Selection::Plane { point: DVec3::ZERO, normal: DVec3::Z, tolerance_mm: 0.0 };
        for (on, wanted) in [(&inner, 6.0), (&edge, 12.0 + 3.0), (&side, 100.0)] {
            // Shapes are taken larger by a micrometre.
            assert!((area(on) - wanted).abs() < 0.05, "{} for {wanted}", area(on));
            assert!(on.touches(&cube));
        }
        let turn = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
        let moved = Selection::area_on(
            &edge.moved(2.0, turn, DVec3::X),
            &TriMesh {
                vertices: cube.vertices.iter().map(|p| turn * (2.0 * *p) + DVec3::X).collect(),
                ..cube.clone()
            },
        );
        assert!((moved.expect("a turned box") - 60.0).abs() < 0.1, "{moved:?}");
        let within = Selection::Box { low: DVec3::splat(3.0), high: DVec3::splat(4.0) };
        assert!(area(&within) == 0.0 && !within.touches(&cube));
        let ball = |z: f64| Selection::Sphere { centre: DVec3::new(5.0, 5.0, z), radius_mm: 0.5 };
        assert!(
            ball(10.4).area_on(&cube).is_none() && ball(10.4).touches(&cube) && !ball(10.6).touches(&cube)
        );
    }

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
        let facets = Selection::Triangles(Facets::new(vec![triangle]));
        assert!(facets.contains(DVec3::new(2.0, 3.0, 0.01)) && !facets.contains(p));
        assert!(!facets.contains(DVec3::new(8.0, 8.0, 0.0)));
    }

    #[test]
    fn a_patch_holds_its_side_of_the_surface_alone() {
        // A square of 4 mm whose outward normal is +z, on a surface that lies up to 0.3 mm off it.
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let square = [
            [corner(0.0, 0.0), corner(4.0, 0.0), corner(4.0, 4.0)],
            [corner(0.0, 0.0), corner(4.0, 4.0), corner(0.0, 4.0)],
        ];
        let patch = SurfacePatch { triangles: Facets::new(square.to_vec()), within_mm: 0.3 };
        assert!((patch.area_mm2() - 16.0).abs() < 1e-12);
        let (triangle, shares) =
            patch.at(DVec3::new(3.0, 1.0, 0.2), Some(DVec3::Z)).expect("above the first triangle");
        assert_eq!(triangle, 0);
        let back: DVec3 = square[0].iter().zip(shares).map(|(p, w)| *p * w).sum();
        assert!((back - DVec3::new(3.0, 1.0, 0.0)).length() < 1e-12, "{shares:?}");
        let selection = Selection::Patch(patch.clone());
        let above = DVec3::new(1.0, 2.0, 0.29);
        assert!(selection.contains(above) && selection.contains_on(above, DVec3::new(0.5, 0.0, 0.8)));
        // Too far away, beside the border, around an edge, and on the back of a thin wall.
        assert!(!selection.contains(DVec3::new(1.0, 2.0, 0.31)));
        assert!(!selection.contains(DVec3::new(4.1, 2.0, 0.0)));
        assert!(!selection.contains_on(DVec3::new(4.0, 2.0, -0.2), DVec3::X));
        assert!(!selection.contains_on(DVec3::new(1.0, 2.0, -0.2), -DVec3::Z));
        assert!(selection.grown(1.0).contains(DVec3::new(4.5, 2.0, 1.0)));
        let points = Selection::Points(Facets::new(vec![[DVec3::X; 3], [DVec3::Y; 3]]));
        assert!(points.contains(DVec3::X) && points.contains(DVec3::Y) && !points.contains(DVec3::ZERO));
    }

    /// A plane cuts triangles where it crosses them: both sides together are the whole, and each has its exact area.
    #[test]
    fn facets_are_cut_exactly_by_a_plane() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        let square = Facets::new(vec![
            [corner(0.0, 0.0), corner(4.0, 0.0), corner(4.0, 4.0)],
            [corner(0.0, 0.0), corner(4.0, 4.0), corner(0.0, 4.0)],
        ]);
        // Across both triangles, aslant, along the diagonal edge, along a side, and beside the square.
        let slant = DVec3::new(0.6, 0.8, 0.0);
        let diagonal = DVec3::new(1.0, -1.0, 0.0).normalize();
        for (point, normal, area) in [
            (DVec3::new(1.0, 0.0, 0.0), DVec3::X, 12.0),
            (DVec3::new(1.0, 0.0, 0.0), -DVec3::X, 4.0),
            // 0.6 x + 0.8 y < 1.2 is the triangle of 2 x 1.5 mm at the origin.
            (DVec3::new(2.0, 0.0, 0.0), slant, 14.5),
            (DVec3::new(2.0, 0.0, 0.0), -slant, 1.5),
            (DVec3::ZERO, diagonal, 8.0),
            (DVec3::ZERO, DVec3::X, 16.0),
            (DVec3::ZERO, -DVec3::X, 0.0),
            (DVec3::new(9.0, 0.0, 0.0), DVec3::X, 0.0),
        ] {
            let part = square.on_side(point, normal);
            assert!((part.area_mm2() - area).abs() < 1e-12, "{point} {normal}: {}", part.area_mm2());
            assert!(part.triangles().iter().flatten().all(|p| (*p - point).dot(normal) > -1e-12));
            // Seen from the same side as before.
            assert!(part.triangles().iter().all(|[a, b, c]| (*b - *a).cross(*c - *a).z > 0.0));
        }
        let part = square.on_side(DVec3::new(1.0, 0.0, 0.0), DVec3::X);
        assert!((part.centroid().expect("an area") - corner(2.5, 2.0)).length() < 1e-12);
        assert_eq!(square.on_side(DVec3::X * 9.0, DVec3::X).centroid(), None);
        let selection = Selection::Triangles(part);
        assert!(selection.contains(corner(1.05, 2.0)) && !selection.contains(corner(0.95, 2.0)));
    }

    #[test]
    fn selections_go_with_a_moved_part() {
        let (scale, shift) = (2.0, DVec3::new(5.0, -3.0, 1.0));
        let rotation = DMat3::from_cols(DVec3::new(0.8, 0.6, 0.0), DVec3::new(-0.6, 0.8, 0.0), DVec3::Z);
        let facet = [DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
        let all = [
            Selection::Box { low: DVec3::new(-1.0, 0.0, -1.0), high: DVec3::new(3.0, 2.0, 2.0) },
            Selection::Plane { point: DVec3::X, normal: DVec3::X, tolerance_mm: 1e-4 },
            Selection::Cylinder { point: DVec3::X, axis: DVec3::Y, radius_mm: 1.5, length_mm: Some(4.0) },
            Selection::Sphere { centre: DVec3::Y, radius_mm: 1.7 },
            Selection::Triangles(Facets::new(vec![facet])),
            Selection::Patch(SurfacePatch { triangles: Facets::new(vec![facet]), within_mm: 0.75 }),
        ];
        for selection in all {
            let moved = selection.moved(scale, rotation, shift);
            let again = moved.moved(1.0, rotation, DVec3::ZERO);
            let mut inside = 0;
            for i in 0..4096u32 {
                // A grid of points, some of them on the faces of every shape.
                let p = DVec3::new(f64::from(i % 16), f64::from(i / 16 % 16), f64::from(i / 256)) * 0.5 - 2.0;
                let q = rotation * (scale * p) + shift;
                inside += usize::from(selection.contains(p));
                assert_eq!(selection.contains(p), moved.contains(q), "{selection:?} at {p}");
                assert_eq!(moved.contains(q), again.contains(rotation * q), "{selection:?} at {p}");
            }
            assert!(inside > 10, "{selection:?}");
        }
    }
}
