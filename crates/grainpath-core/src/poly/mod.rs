//! Polygons with holes: their types, areas and point tests, and the modules that combine, offset, clip and
//! simplify them.
//!
//! A [`Contour`] is a closed line without its first point repeated. A [`Polygon`] is one counter-clockwise
//! outline with clockwise holes. A [`Region`] is a list of polygons that do not overlap. Coordinates are mm
//! as `f64`, areas mm2. Booleans and offsets round to integers of [`GRID_MM`], so a result is reproducible to
//! the bit. An operation that needs no work, such as a union with an empty region, returns its input
//! unrounded. Only this module calls clipping libraries.
//!
//! Methods: the area is the shoelace sum, taken from the first vertex so that a small contour far from the
//! origin keeps its digits. A point is inside if a ray to the left crosses an odd number of edges. The count
//! is half-open: of two polygons that share an edge, exactly one contains a point on it.
//!
//! Cost: area, length, centroid, box and point test are linear in the vertices and allocate nothing.
//! Degenerate cases: an empty contour has area and length 0 and contains no point. A contour that encloses no
//! area has its first point as centroid. An empty region has no box.

mod boolean;
mod clip;
mod offset;
mod simplify;
mod straight_strip;
mod stretch;
mod tangle;

use crate::Bounds2;
use glam::DVec2;

pub use boolean::FillRule;
pub use clip::{ClippedLine, Crossing, LineClipper};
pub use offset::Join;
pub use simplify::{simplify_contour, simplify_line};
pub use straight_strip::{StraightStrip, straight_strip};
pub use stretch::stretched_to;
pub use tangle::crosses_more_than;

use crate::math::{cross, rotated};

/// The grid that booleans and offsets round to, mm. Source: derived: a tenth of the last digit of a
/// G-code coordinate, 1 um, so that rounding to the grid does not show in a program.
pub const GRID_MM: f64 = 1e-4;

/// A closed line without its first point repeated.
pub type Contour = Vec<DVec2>;

/// Signed area of a closed line in mm2: positive when it runs counter-clockwise.
pub fn signed_area_mm2(contour: &[DVec2]) -> f64 {
    let Some(&origin) = contour.first() else { return 0.0 };
    // Coordinates are taken from the first vertex, so that a small contour far from the origin loses no digits.
    contour[1..].windows(2).map(|w| cross(w[0] - origin, w[1] - origin)).sum::<f64>() * 0.5
}

/// The centroid of the area that a contour encloses; the first point of a contour that encloses no area.
pub fn centroid(contour: &[DVec2]) -> DVec2 {
    let Some(&first) = contour.first() else { return DVec2::ZERO };
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for (a, b) in edges(contour) {
        // The area is split into triangles with the first point, so that a contour far from the origin loses no digits.
        let (a, b) = (a - first, b - first);
        let twice = cross(a, b);
        area += twice;
        moment += twice / 3.0 * (a + b);
    }
    if area.abs() < f64::MIN_POSITIVE { first } else { first + moment / area }
}

/// Length of a closed line, mm.
pub fn perimeter_mm(contour: &[DVec2]) -> f64 {
    edges(contour).map(|(a, b)| a.distance(b)).sum()
}

/// The edges of a closed line, the closing one last.
pub fn edges(contour: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let n = contour.len();
    (0..n).map(move |i| (contour[i], contour[if i + 1 == n { 0 } else { i + 1 }]))
}

/// Whether `p` is inside the closed lines taken together, by even-odd crossing count. The count is
/// half-open: of two polygons that share an edge exactly one contains a point on it.
pub fn even_odd_contains<'a>(contours: impl IntoIterator<Item = &'a Contour>, p: DVec2) -> bool {
    crossings_left_are_odd(contours.into_iter().flat_map(|c| edges(c)), p)
}

/// Whether a ray from `p` to the left crosses an odd number of edges. A caller may leave out an
/// even number of the edges crossed.
fn crossings_left_are_odd(edges: impl Iterator<Item = (DVec2, DVec2)>, p: DVec2) -> bool {
    let mut odd = false;
    for (a, b) in edges {
        // Half-open in y, so a vertex at the height of `p` counts for one of its two edges.
        if (a.y > p.y) != (b.y > p.y) {
            // Every edge is taken from its lower end to its upper one, so a point on it is left of it,
            // whichever of two polygons that share the edge it belongs to.
            let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
            odd ^= crate::segment::turn(low, high, p) < 0.0;
        }
    }
    odd
}

/// One outline, counter-clockwise, and the holes in it, clockwise.
///
/// ```
/// use grainpath_core::{DVec2, Polygon};
///
/// let outer = vec![DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(0.0, 3.0)];
/// let triangle = Polygon { outer, holes: Vec::new() };
/// assert_eq!((triangle.area_mm2(), triangle.perimeter_mm()), (6.0, 12.0));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polygon {
    /// The outline.
    pub outer: Contour,
    /// The holes. They lie inside the outline and do not overlap.
    pub holes: Vec<Contour>,
}

impl Polygon {
    /// The outline, then the holes.
    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        std::iter::once(&self.outer).chain(&self.holes)
    }

    /// Area in mm2, without the holes.
    pub fn area_mm2(&self) -> f64 {
        self.contours().map(|c| signed_area_mm2(c)).sum()
    }

    /// Length of all contours, mm.
    pub fn perimeter_mm(&self) -> f64 {
        self.contours().map(|c| perimeter_mm(c)).sum()
    }

    /// The box around the outline.
    pub fn bounds(&self) -> Option<Bounds2> {
        Bounds2::around_points(self.outer.iter().copied())
    }

    /// Whether `p` is inside; see [`even_odd_contains`] for points on an edge.
    pub fn contains(&self, p: DVec2) -> bool {
        even_odd_contains(self.contours(), p)
    }
}

/// Polygons that do not overlap: the section of a part, or an area to be filled.
///
/// ```
/// use grainpath_core::{DVec2, Region, poly::Join};
///
/// let square = Region::rectangle(DVec2::ZERO, DVec2::splat(10.0));
/// let inner = square.offset(-1.0, Join::Miter(2.0));
/// assert!((inner.area_mm2() - 64.0).abs() < 1e-6);
/// let frame = square.difference(&inner);
/// assert_eq!((frame.polygons.len(), frame.polygons[0].holes.len()), (1, 1));
/// assert!(frame.contains(DVec2::splat(0.5)) && !frame.contains(DVec2::splat(5.0)));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region {
    /// The polygons. Their order has no meaning, but is the same in every run.
    pub polygons: Vec<Polygon>,
}

impl From<Polygon> for Region {
    fn from(polygon: Polygon) -> Self {
        Self { polygons: vec![polygon] }
    }
}

impl Region {
    /// An axis-aligned rectangle.
    pub fn rectangle(min: DVec2, max: DVec2) -> Self {
        let outer = vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        Polygon { outer, holes: Vec::new() }.into()
    }

    /// Whether the region has no polygon.
    pub fn is_empty(&self) -> bool {
        self.polygons.is_empty()
    }

    /// All contours: each polygon's outline followed by its holes.
    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        self.polygons.iter().flat_map(Polygon::contours)
    }

    /// The region turned about zero, counter-clockwise by the angle whose unit vector is `by`.
    pub fn turned(&self, by: DVec2) -> Self {
        let contour = |c: &Contour| c.iter().map(|p| rotated(*p, by)).collect();
        let polygon =
            |p: &Polygon| Polygon { outer: contour(&p.outer), holes: p.holes.iter().map(contour).collect() };
        Self { polygons: self.polygons.iter().map(polygon).collect() }
    }

    /// Area in mm2, without the holes.
    pub fn area_mm2(&self) -> f64 {
        self.polygons.iter().map(Polygon::area_mm2).sum()
    }

    /// Length of all contours, mm.
    pub fn perimeter_mm(&self) -> f64 {
        self.polygons.iter().map(Polygon::perimeter_mm).sum()
    }

    /// The box around the region; `None` for an empty one.
    pub fn bounds(&self) -> Option<Bounds2> {
        Bounds2::around_points(self.polygons.iter().flat_map(|p| p.outer.iter().copied()))
    }

    /// Whether `p` is inside; see [`even_odd_contains`] for points on an edge.
    pub fn contains(&self, p: DVec2) -> bool {
        even_odd_contains(self.contours(), p)
    }

    /// Number of vertices in all contours.
    pub fn n_vertices(&self) -> usize {
        self.contours().map(Vec::len).sum()
    }
}
