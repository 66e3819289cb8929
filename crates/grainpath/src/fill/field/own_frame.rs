//! A frame that belongs to a region and the field on it, so that it turns with the part on the plate.
//!
//! Grids of seeds, the order of contours and the sign of an axis depend on the axes of the plate. Steps that are taken in
//! this frame give the same lines however the part is turned. Only the rounding of coordinates differs.
//!
//! Method: the X axis comes from the moments of the region about its centroid, as complex numbers: the integral of the
//! `k`-th power of the place turns `k` times as fast as the region, so its angle over `k` gives `k` axes. The least `k` counts
//! whose moment is not small: 2 for a bar, 3 for a triangle, 4 for a square. Of the `k` axes that one is taken along which
//! the region is the most skewed and the field the most aligned. Moments are exact, those of the field are sums over a grid
//! in that frame. Degenerate cases: a region that is round to all these moments gets the mean axis of the field; where the
//! field has none either, any frame is as good as another. Lengths are in mm. Cost: linear in the vertices, and up to
//! [`SAMPLES`] squared samples of the field for each of the `k` axes.

use grainpath_core::math::{atan2, cross, direction, rotated, turned_back};
use grainpath_core::poly::{LineClipper, edges};
use grainpath_core::{Bounds2, DVec2, Region};

/// Powers of the moments that are tried. Source: derived. A region that turns into itself by a fifth of a turn or by less
/// than a sixth is as good as round.
const POWERS: [usize; 4] = [2, 3, 4, 6];
/// A moment counts if it is at least this share of the area times the power of the radius of gyration. Source: derived. The
/// moment of a square is 0.6 of that. Vertices rounded to 1e-4 mm turn an axis from a moment of 0.02 by less than 1e-3 rad on
/// a region of 1 mm.
const LEAST_MOMENT: f64 = 0.02;
/// Samples of the field on each side of the region's bounds. Source: chosen; 600 of them tell one side from the other.
const SAMPLES: usize = 24;
/// Signs of axes and the order of places that are alike follow this direction, radians from the X axis of the frame. Source:
/// chosen. Fields run along and across a part, and corners lie there, more often than square to this.
const FORWARDS_RAD: f64 = 1.1;

/// A frame, given by its X axis in the plane of the layer.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnFrame {
    x: DVec2,
}

impl OwnFrame {
    /// The frame of a region, along which `axis` gives the axis of the field.
    pub(super) fn of(region: &Region, axis: &dyn Fn(DVec2) -> DVec2) -> Self {
        let Some(shape) = Shape::new(region) else { return Self { x: DVec2::X } };
        let inside = LineClipper::new(region);
        let candidates = POWERS.iter().find_map(|&k| {
            let moment = shape.moment(k);
            let least = LEAST_MOMENT * shape.area_mm2 * shape.gyration_mm.powi(k as i32);
            (moment.length() > least).then(|| (k, atan2(moment.y, moment.x) / k as f64))
        });
        let (n, first_rad) = candidates.unwrap_or_else(|| {
            let along = Self { x: DVec2::X }.samples(region, &inside, axis);
            let sum: DVec2 = along.map(|(_, axis)| doubled(axis)).sum();
            (2, 0.5 * atan2(sum.y, sum.x))
        });
        let mut best = (f64::NEG_INFINITY, Self { x: DVec2::X });
        for j in 0..n {
            let frame = Self { x: direction(first_rad + j as f64 / n as f64 * std::f64::consts::TAU) };
            let fit = shape.skew(frame.x) + frame.alignment(&shape, region, &inside, axis);
            if fit > best.0 {
                best = (fit, frame);
            }
        }
        best.1
    }

    /// A place or vector of the layer, as the frame sees it.
    pub(super) fn seen(self, p: DVec2) -> DVec2 {
        turned_back(p, self.x)
    }

    /// A place or vector of the frame, back in the layer.
    pub(super) fn back(self, p: DVec2) -> DVec2 {
        rotated(p, self.x)
    }

    /// A region of the layer, as the frame sees it.
    pub(super) fn seen_region(self, region: &Region) -> Region {
        region.turned(DVec2::new(self.x.x, -self.x.y))
    }

    /// An axis of the layer, as the frame sees it, with the sign that belongs to the frame.
    pub(super) fn seen_axis(self, axis: DVec2) -> DVec2 {
        let seen = self.seen(axis);
        if seen.dot(direction(FORWARDS_RAD)) < 0.0 { -seen } else { seen }
    }

    /// Places of a region on a grid along the frame, and the axis of the field there, both as the frame sees them.
    fn samples<'a>(
        self,
        region: &Region,
        inside: &'a LineClipper,
        axis: &'a dyn Fn(DVec2) -> DVec2,
    ) -> impl Iterator<Item = (DVec2, DVec2)> + 'a {
        let points = region.contours().flatten().map(|p| self.seen(*p));
        let bounds = Bounds2::around_points(points).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let cell = bounds.size() / SAMPLES as f64;
        let at = move |k: usize| {
            bounds.min + cell * (DVec2::new((k % SAMPLES) as f64, (k / SAMPLES) as f64) + 0.5)
        };
        (0..SAMPLES * SAMPLES)
            .map(at)
            .filter(move |p| inside.contains(self.back(*p)))
            .map(move |p| (p, self.seen(axis(self.back(p)))))
    }

    /// How well the field is aligned with the frame: a number that differs between frames turned against each other by a half,
    /// a third or a quarter of a turn, unless region and field turn into themselves.
    fn alignment(
        self,
        shape: &Shape,
        region: &Region,
        inside: &LineClipper,
        axis: &dyn Fn(DVec2) -> DVec2,
    ) -> f64 {
        let centre = self.seen(shape.centroid);
        let (mut sum, mut n) = (0.0, 0.0_f64);
        for (p, axis) in self.samples(region, inside, axis) {
            let (at, along) = ((p - centre) / shape.gyration_mm, doubled(axis));
            // Weights that are no multiples of each other, so that terms rarely cancel.
            sum += 0.8 * along.x + 0.6 * along.y;
            sum += at.x * (along.x + 0.7 * along.y) + at.y * (0.45 * along.x + 0.3 * along.y);
            n += 1.0;
        }
        sum / n.max(1.0)
    }
}

/// Of places in such a frame the one that lies farthest along the direction in which axes point.
pub(super) fn foremost(places: impl Iterator<Item = DVec2>) -> Option<DVec2> {
    let forwards = direction(FORWARDS_RAD);
    places.max_by(|a, b| a.dot(forwards).total_cmp(&b.dot(forwards)))
}

/// A unit vector at twice the angle, the same for both signs of an axis.
fn doubled(axis: DVec2) -> DVec2 {
    rotated(axis, axis)
}

/// A region about its centroid.
struct Shape {
    /// Both ends of every edge, as seen from the centroid.
    edges: Vec<(DVec2, DVec2)>,
    centroid: DVec2,
    area_mm2: f64,
    gyration_mm: f64,
}

impl Shape {
    /// `None` for a region without area.
    fn new(region: &Region) -> Option<Self> {
        let origin = region.bounds()?.centre();
        let about = |centre: DVec2| {
            let all = region.contours().flat_map(|c| edges(c));
            all.map(|(a, b)| (a - centre, b - centre)).collect::<Vec<_>>()
        };
        let area = |edges: &[(DVec2, DVec2)]| edges.iter().map(|e| 0.5 * cross(e.0, e.1)).sum::<f64>();
        let rough = about(origin);
        let area_mm2 = area(&rough);
        if area_mm2 < f64::MIN_POSITIVE {
            return None;
        }
        let moment: DVec2 = rough.iter().map(|(a, b)| cross(*a, *b) / 6.0 * (*a + *b)).sum();
        let centroid = origin + moment / area_mm2;
        let edges = about(centroid);
        let squares: f64 =
            edges.iter().map(|(a, b)| cross(*a, *b) / 12.0 * (a.dot(*a) + a.dot(*b) + b.dot(*b))).sum();
        let gyration_mm = (squares / area_mm2).max(f64::MIN_POSITIVE).sqrt();
        Some(Self { edges, centroid, area_mm2, gyration_mm })
    }

    /// The integral of the `k`-th complex power of the place.
    fn moment(&self, k: usize) -> DVec2 {
        // Over a triangle with a corner at zero it is twice the area over (k + 1) (k + 2), times the sum of all products of
        // `k` factors, each of which is one of the other corners.
        let share = 1.0 / ((k + 1) * (k + 2)) as f64;
        let of_edge = |(a, b): &(DVec2, DVec2)| {
            let (mut products, mut power) = (DVec2::X, DVec2::X);
            for _ in 0..k {
                power = rotated(power, *a);
                products = rotated(products, *b) + power;
            }
            share * cross(*a, *b) * products
        };
        self.edges.iter().map(of_edge).sum()
    }

    /// The skewness of the region along a direction.
    fn skew(&self, along: DVec2) -> f64 {
        let of_edge = |(a, b): &(DVec2, DVec2)| {
            let (x, y) = (a.dot(along), b.dot(along));
            cross(*a, *b) / 20.0 * (x * x * x + x * x * y + x * y * y + y * y * y)
        };
        let third: f64 = self.edges.iter().map(of_edge).sum();
        third / (self.area_mm2 * self.gyration_mm.powi(3))
    }
}

#[cfg(test)]
mod tests {
    use grainpath_core::Polygon;

    use super::*;

    /// The angle of the frame of a shape that is turned with a straight field, radians.
    fn frame_rad(corners: &[(f64, f64)], field_rad: f64, by_rad: f64) -> f64 {
        let outer = corners.iter().map(|&(x, y)| rotated(DVec2::new(x + 20.0, y - 7.0), direction(by_rad)));
        let region = Region::from(Polygon { outer: outer.collect(), holes: Vec::new() });
        // The sign that a field gives to its axis has no meaning.
        let axis = direction((field_rad + by_rad).rem_euclid(std::f64::consts::PI));
        let x = OwnFrame::of(&region, &|_| axis).x;
        atan2(x.y, x.x)
    }

    #[test]
    fn the_frame_turns_with_its_region() {
        let shapes: [&[(f64, f64)]; 4] = [
            &[(0.0, 0.0), (30.0, 0.0), (30.0, 12.0), (14.0, 12.0), (14.0, 22.0), (0.0, 22.0)],
            &[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)],
            &[(0.0, 0.0), (8.0, 0.0), (4.0, 6.928_203)],
            &[(0.0, 0.0), (40.0, 0.0), (30.0, 9.0)],
        ];
        for corners in shapes {
            let first = frame_rad(corners, 0.4, 0.0);
            for degrees in [1.0_f64, 15.0, 37.0, 45.0, 90.0, 133.0, 180.0, 291.0] {
                let turned = frame_rad(corners, 0.4, degrees.to_radians()) - first - degrees.to_radians();
                // A square under a straight field turns into itself by half a turn.
                let period = std::f64::consts::PI * if corners.len() == 4 { 1.0 } else { 2.0 };
                let off = turned - period * (turned / period).round();
                assert!(off.abs() < 1e-6, "{corners:?} turned by {degrees}: {off}");
            }
        }
    }

    #[test]
    fn a_region_without_area_keeps_the_axes_of_the_plate() {
        let line = Region::from(Polygon { outer: vec![DVec2::ONE; 3], holes: Vec::new() });
        for region in [Region::default(), line] {
            assert_eq!(OwnFrame::of(&region, &|_| DVec2::Y).x, DVec2::X);
        }
    }
}
