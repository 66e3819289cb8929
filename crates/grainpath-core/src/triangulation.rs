//! Triangulations of a region: with triangles of good shape, for finite elements, or over its
//! corners alone, for the flat ends of bodies.
//!
//! Method: constrained Delaunay triangulation, refined after `ruppert1995`. Lengths are in mm.
//! Cost: n log n in the points. Degenerate cases: an empty region, contours that cross, and sides
//! so short that the triangles would not fit into memory are errors.

use glam::DVec2;
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, DelaunayTriangulation, HasPosition, Point2,
    RefinementParameters, Triangulation as _,
};

use crate::Region;
use crate::poly::edges;

/// Triangles over shared points, counter-clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Triangulation {
    /// Corners, mm.
    pub points: Vec<DVec2>,
    /// Indices of points, `(n_triangles, 3)`.
    pub triangles: Vec<[u32; 3]>,
}

/// Fineness of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleSize {
    /// Greatest length of a side, mm. A few sides are slightly longer.
    pub longest_mm: f64,
    /// Least number of sides of a closed contour, so that triangles are small around small holes.
    pub sides_of_hole: usize,
    /// Shortest side that a contour is cut into, mm.
    pub shortest_mm: f64,
}

/// Why a region cannot be cut into triangles.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TriangulationError {
    /// The region has no area.
    #[error("the region is empty")]
    Empty,
    /// Contours cross each other.
    #[error("the region's contours cross each other")]
    Crossing,
    /// Triangles of good shape and this size would need too many points.
    #[error("more than {0} points are needed; allow longer sides")]
    TooMany(usize),
}

/// Largest number of points; a triangulation with more needs longer sides. Source: derived. For each point
/// `spade` keeps a vertex, six half edges of four 32-bit numbers and two faces, about 140 bytes: 420 MB.
const MAX_POINTS: usize = 3_000_000;
/// Smallest angle of a triangle, degrees, except at the region's own corners. Source: refinement is
/// proved to end for angles up to 20.7 degrees (`ruppert1995`) and ends in practice up to about 33
/// (`shewchuk2002`).
const LEAST_ANGLE_DEG: f64 = 25.0;

/// A point with its index in the input.
struct Numbered(Point2<f64>, u32);

impl HasPosition for Numbered {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.0
    }
}

/// Coordinates nearer to 0 than this are rounded to 0 for a Delaunay triangulation, mm. Source: the library refuses
/// numbers below 1.8e-43, whose products are no longer exact.
const MIN_COORDINATE_MM: f64 = 1e-40;

/// Delaunay triangles over finite points that differ, counter-clockwise, as indices of the points. There are none for fewer
/// than three points and for points on one line.
///
/// ```
/// use grainpath_core::{DVec2, triangulation::delaunay};
///
/// let square = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
/// assert_eq!(delaunay(&square).len(), 2);
/// assert!(delaunay(&[DVec2::ZERO, DVec2::X, 2.0 * DVec2::X]).is_empty());
/// ```
pub fn delaunay(points: &[DVec2]) -> Vec<[u32; 3]> {
    let whole = |v: f64| if v.abs() < MIN_COORDINATE_MM { 0.0 } else { v };
    let numbered = |(i, p): (usize, &DVec2)| Numbered(Point2::new(whole(p.x), whole(p.y)), i as u32);
    let all = points.iter().enumerate().map(numbered).collect();
    let Ok(triangulation) = DelaunayTriangulation::<Numbered>::bulk_load(all) else { return Vec::new() };
    let mut triangles: Vec<[u32; 3]> =
        triangulation.inner_faces().map(|f| f.vertices().map(|v| v.data().1)).collect();
    // The library does not guarantee the order of its faces.
    triangles.sort_unstable();
    triangles
}

impl Triangulation {
    /// Triangulates a region. `extra` are further corners, around which triangles become small.
    ///
    /// # Errors
    /// [`TriangulationError`] for an empty region, crossing contours, and sides so short that memory does not suffice.
    pub fn new(region: &Region, size: &TriangleSize, extra: &[DVec2]) -> Result<Self, TriangulationError> {
        if region.is_empty() {
            return Err(TriangulationError::Empty);
        }
        // An estimate of the number of points: the area of a triangle is about 0.4 times the square of
        // its side, and each point has two triangles. The test is made before any memory is allocated.
        let estimate = region.area_mm2() / (0.8 * size.longest_mm * size.longest_mm);
        if estimate > MAX_POINTS as f64 {
            return Err(TriangulationError::TooMany(MAX_POINTS));
        }
        let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        for contour in region.contours() {
            let around: f64 = crate::poly::perimeter_mm(contour);
            let step = (around / size.sides_of_hole as f64).clamp(size.shortest_mm, size.longest_mm);
            let mut ring = Vec::new();
            for (a, b) in edges(contour) {
                let n = (a.distance(b) / step).ceil().clamp(1.0, 1e5) as usize;
                ring.extend((0..n).map(|k| a.lerp(b, k as f64 / n as f64)));
            }
            constrain(&mut cdt, ring)?;
        }
        for p in extra {
            cdt.insert(Point2::new(p.x, p.y)).map_err(|_| TriangulationError::Crossing)?;
        }
        let result = cdt.refine(
            RefinementParameters::new()
                .exclude_outer_faces(true)
                .with_angle_limit(AngleLimit::from_deg(LEAST_ANGLE_DEG))
                // Triangles with an area above that of an equilateral triangle (0.433 of its side
                // squared) are divided.
                .with_max_allowed_area(0.433 * size.longest_mm * size.longest_mm)
                .with_max_additional_vertices(MAX_POINTS),
        );
        // The refinement stops without an error when its number of vertices is used up.
        if !result.refinement_complete {
            return Err(TriangulationError::TooMany(MAX_POINTS));
        }
        let mut outside = vec![false; cdt.num_all_faces()];
        result.excluded_faces.iter().for_each(|f| outside[f.index()] = true);
        let points: Vec<DVec2> = cdt.vertices().map(|v| DVec2::new(v.position().x, v.position().y)).collect();
        let kept = cdt.inner_faces().filter(|f| !outside[f.fix().index()]);
        let triangles = kept.map(|f| f.vertices().map(|v| v.fix().index() as u32)).collect();
        Ok(Self { points, triangles }.compacted())
    }

    /// Triangulates a region over the corners of its contours alone, whatever the shape of the
    /// triangles.
    ///
    /// # Errors
    /// [`TriangulationError`] for an empty region and crossing contours.
    pub fn plain(region: &Region) -> Result<Self, TriangulationError> {
        let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        for contour in region.contours() {
            constrain(&mut cdt, contour.iter().copied())?;
        }
        let inside = inside_faces(&cdt);
        let points: Vec<DVec2> = cdt.vertices().map(|v| DVec2::new(v.position().x, v.position().y)).collect();
        let kept = cdt.inner_faces().filter(|f| inside[f.fix().index()]);
        let triangles: Vec<[u32; 3]> = kept.map(|f| f.vertices().map(|v| v.fix().index() as u32)).collect();
        if triangles.is_empty() {
            return Err(TriangulationError::Empty);
        }
        Ok(Self { points, triangles }.compacted())
    }

    /// The triangulation without points that no triangle uses.
    fn compacted(self) -> Self {
        let mut number = vec![u32::MAX; self.points.len()];
        let mut points = Vec::new();
        let mut triangles = self.triangles;
        for corner in triangles.iter_mut().flatten() {
            let slot = &mut number[*corner as usize];
            if *slot == u32::MAX {
                *slot = points.len() as u32;
                points.push(self.points[*corner as usize]);
            }
            *corner = *slot;
        }
        Self { points, triangles }
    }
}

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Adds a closed line whose sides no triangle may cross.
fn constrain(cdt: &mut Cdt, ring: impl IntoIterator<Item = DVec2>) -> Result<(), TriangulationError> {
    let mut handles = Vec::new();
    for p in ring {
        let handle = cdt.insert(Point2::new(p.x, p.y)).map_err(|_| TriangulationError::Crossing)?;
        // Two points that coincide share a vertex, and a side between them would have no length.
        if handles.last() != Some(&handle) {
            handles.push(handle);
        }
    }
    for k in 0..handles.len() {
        let (a, b) = (handles[k], handles[(k + 1) % handles.len()]);
        if a != b {
            if !cdt.can_add_constraint(a, b) {
                return Err(TriangulationError::Crossing);
            }
            cdt.add_constraint(a, b);
        }
    }
    Ok(())
}

/// For each face, whether it lies inside, that is, whether a way from outside to the face crosses
/// an odd number of border edges. Edges are counted because testing a point would fail: a face
/// between samples of one straight border is flat.
pub(crate) fn inside_faces(cdt: &Cdt) -> Vec<bool> {
    let mut side: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
    let outer = cdt.outer_face();
    side[outer.fix().index()] = Some(false);
    let mut stack = Vec::new();
    for edge in cdt.convex_hull() {
        // The face of a hull edge is the outer one; the outermost triangle lies on its other side.
        let (face, crossed) = (edge.rev().face(), edge.is_constraint_edge());
        if side[face.fix().index()].is_none() {
            side[face.fix().index()] = Some(crossed);
            stack.push(face.fix());
        }
    }
    while let Some(fixed) = stack.pop() {
        let here = side[fixed.index()] == Some(true);
        let Some(face) = cdt.face(fixed).as_inner() else { continue };
        for edge in face.adjacent_edges() {
            let next = edge.rev().face().fix();
            if side[next.index()].is_none() {
                side[next.index()] = Some(here ^ edge.is_constraint_edge());
                stack.push(next);
            }
        }
    }
    side.into_iter().map(|s| s == Some(true)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{cross, direction};

    #[test]
    fn a_plate_with_a_hole_is_filled_with_good_triangles() {
        let disc = |k: usize| direction(k as f64 / 64.0 * std::f64::consts::TAU) * 2.0;
        let hole = Region::from(crate::Polygon { outer: (0..64).map(disc).collect(), holes: Vec::new() });
        let plate = Region::rectangle(DVec2::splat(-10.0), DVec2::splat(10.0)).difference(&hole);
        let size = TriangleSize { longest_mm: 1.0, sides_of_hole: 64, shortest_mm: 0.05 };
        let mesh = Triangulation::new(&plate, &size, &[]).expect("a sound region");
        let mut area = 0.0;
        for &[a, b, c] in &mesh.triangles {
            let [a, b, c] = [a, b, c].map(|i| mesh.points[i as usize]);
            let double = cross(b - a, c - a);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            assert!(double > 0.15 * longest * longest, "a sliver at {a}");
            area += 0.5 * double;
        }
        assert!((area - plate.area_mm2()).abs() < 1e-6, "{area}");
    }
}
