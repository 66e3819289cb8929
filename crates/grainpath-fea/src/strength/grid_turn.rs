//! Aligns the grid of a strength test with the part, so that a part turned on the plate gets the same cells.
//!
//! Cells resolve a wall along the grid better than an oblique one, so a grid along the axes of the plate would give a
//! turned part another peak load. The grid is aligned with the longest straight sides of the convex hull of all beads,
//! and centred on the beads. Sides whose directions differ by less than half a degree count together. Turning or moving
//! all beads turns and moves the grid with them, apart from rounding. Cost: sorting the end points of all beads. A round
//! part has no longest side; the first side of its hull then decides.

use grainpath_core::math::{atan2, cross, direction};
use grainpath_core::{DVec2, DVec3};
use rayon::prelude::*;

use super::laminate::BeadSheet;

/// Sides of the hull whose directions differ by less than this count as parallel, rad. Source: derived. G-code rounds both
/// ends of a bead to 0.001 mm, which turns a side of 0.2 mm by up to 0.4 degrees.
const SAME_DIRECTION_RAD: f64 = 0.0087;
/// An angle between grid and plate below this is taken as zero, rad. Source: derived. Over 200 mm this angle moves a bead by
/// 0.002 mm, about the rounding of G-code.
const MIN_ANGLE_RAD: f64 = 1e-5;

/// The rotation about z between the part and the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Direction of the grid's first axis.
    x: DVec2,
}

impl Default for Frame {
    fn default() -> Self {
        Self { x: DVec2::X }
    }
}

impl Frame {
    /// Finds the frame that is aligned with these beads.
    pub fn new(sheets: &[BeadSheet]) -> Self {
        let of_sheet = |sheet: &BeadSheet| {
            let ends = sheet.beads.iter().flat_map(|b| [b.a, b.b]).filter(|p| p.is_finite());
            let mut ends: Vec<DVec2> = ends.collect();
            // Most beads begin where the one before ended.
            ends.dedup();
            convex_hull(ends)
        };
        let hulls: Vec<Vec<DVec2>> = sheets.par_iter().map(of_sheet).collect();
        let hull = convex_hull(hulls.concat());
        let sides: Vec<DVec2> = (0..hull.len()).map(|i| hull[(i + 1) % hull.len()] - hull[i]).collect();
        let parallel = |side: &DVec2| {
            let near = sides.iter().map(|s| if s.dot(*side) < 0.0 { -*s } else { *s });
            near.filter(|s| cross(*side, *s).abs() <= SAME_DIRECTION_RAD * side.length() * s.length())
                .sum::<DVec2>()
        };
        let longest = sides.iter().map(parallel).fold(DVec2::ZERO, |best, sum| {
            // The margin keeps rounding from deciding between equal sums, such as those of two parallel sides.
            if sum.length_squared() > (1.0 + 1e-9) * best.length_squared() { sum } else { best }
        });
        if longest == DVec2::ZERO {
            return Self::default();
        }
        // A grid turned by a quarter is the same grid.
        let quarter = std::f64::consts::FRAC_PI_2;
        let angle = atan2(longest.y, longest.x);
        let angle = angle - (angle / quarter).round() * quarter;
        if angle.abs() < MIN_ANGLE_RAD { Self::default() } else { Self { x: direction(angle) } }
    }

    /// Transforms a vector from grid to part coordinates.
    pub fn to_part(self, p: DVec2) -> DVec2 {
        self.x * p.x + self.x.perp() * p.y
    }

    /// Transforms a vector from part to grid coordinates.
    pub fn to_grid(self, p: DVec2) -> DVec2 {
        DVec2::new(self.x.dot(p), self.x.perp().dot(p))
    }

    /// [`Frame::to_part`] in space.
    pub fn to_part_3d(self, p: DVec3) -> DVec3 {
        self.to_part(p.truncate()).extend(p.z)
    }

    /// [`Frame::to_grid`] in space.
    pub fn to_grid_3d(self, p: DVec3) -> DVec3 {
        self.to_grid(p.truncate()).extend(p.z)
    }

    /// The beads in grid coordinates.
    pub fn beads(self, mut sheets: Vec<BeadSheet>) -> Vec<BeadSheet> {
        if self != Self::default() {
            sheets.par_iter_mut().flat_map_iter(|s| &mut s.beads).for_each(|bead| {
                (bead.a, bead.b) = (self.to_grid(bead.a), self.to_grid(bead.b));
            });
        }
        sheets
    }
}

/// Points inside the octagon by more than this share of its longest side are no corners of the hull. Source: derived.
/// Rounding moves a point by 1e-15 of the size of the part.
const INSIDE: f64 = 1e-9;

/// Removes the points inside the octagon of those that lie farthest in eight directions (`akl1978` in
/// docs/references.bib): nearly all ends of the beads of a part, which then need no sorting.
fn remove_inner(points: &mut Vec<DVec2>) {
    let Some(&first) = points.first() else { return };
    // Along x, the diagonal, y and the other diagonal; then against each of them.
    let mut octagon = [first; 8];
    let ways = |p: DVec2| [p.x, p.x + p.y, p.y, p.y - p.x];
    let mut far = [f64::NEG_INFINITY; 8];
    for &p in points.iter() {
        for (k, along) in ways(p).into_iter().enumerate() {
            for (k, along) in [(k, along), (k + 4, -along)] {
                if along > far[k] {
                    (far[k], octagon[k]) = (along, p);
                }
            }
        }
    }
    let next = octagon.iter().cycle().skip(1);
    let sides = octagon.iter().zip(next).map(|(a, b)| (*a, *b - *a)).filter(|(_, side)| *side != DVec2::ZERO);
    let longest_mm = sides.clone().map(|(_, side)| side.length()).fold(0.0, f64::max);
    let sides: Vec<(DVec2, DVec2, f64)> =
        sides.map(|(a, side)| (a, side, INSIDE * longest_mm * side.length())).collect();
    // Points in a line have two sides at most, and each of them lies on both.
    let is_outside = |p: &DVec2| sides.iter().any(|(a, side, least)| cross(*side, *p - *a) <= *least);
    if !sides.is_empty() {
        points.retain(is_outside);
    }
}

/// Corners of the convex hull, counter-clockwise (`andrew1979` in docs/references.bib).
pub fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    remove_inner(&mut points);
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<DVec2> = Vec::new();
    let reversed: Vec<DVec2> = points.iter().rev().copied().collect();
    for chain in [&points, &reversed] {
        let first = hull.len();
        for p in chain {
            while hull.len() >= first + 2
                && cross(hull[hull.len() - 1] - hull[hull.len() - 2], *p - hull[hull.len() - 1]) <= 0.0
            {
                hull.pop();
            }
            hull.push(*p);
        }
        hull.pop();
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::super::laminate::BeadPiece;
    use super::*;

    fn outline(corners: &[DVec2]) -> Vec<BeadSheet> {
        let n = corners.len();
        let bead =
            |i: usize| BeadPiece { a: corners[i], b: corners[(i + 1) % n], volume_mm3: 1.0, material: 0 };
        vec![BeadSheet { height_mm: 0.2, beads: (0..n).map(bead).collect() }]
    }

    #[test]
    fn a_turned_and_moved_part_has_the_same_beads_in_its_grid() {
        let bar = [(0.0, 0.0), (150.0, 0.0), (150.0, 8.0), (149.0, 20.0), (1.0, 20.0), (0.0, 9.0)];
        let bar = bar.map(|(x, y)| DVec2::new(x, y));
        let straight = outline(&bar);
        assert_eq!(Frame::new(&straight), Frame::default());
        for deg in [0.0, 3.0, 37.0, 44.0, 61.0, 90.0, 143.0, 200.0f64] {
            let turn = direction(deg.to_radians());
            let moved = bar.map(|p| {
                let q = turn * p.x + turn.perp() * p.y + DVec2::new(31.7, -12.3);
                // As G-code rounds.
                (q * 1000.0).round() / 1000.0
            });
            let frame = Frame::new(&outline(&moved));
            let seen = frame.beads(outline(&moved));
            // Lengths along the axes are those of the straight bar, whichever way round.
            let spans = |s: &[BeadSheet]| {
                let ends = s[0].beads.iter().map(|b| b.a);
                let (low, high) = (ends.clone().reduce(DVec2::min), ends.reduce(DVec2::max));
                let size = high.expect("beads") - low.expect("beads");
                [size.max_element(), size.min_element()]
            };
            for (a, b) in spans(&seen).into_iter().zip(spans(&straight)) {
                assert!((a - b).abs() < 0.003, "{deg}: {a} {b}");
            }
            let p = DVec2::new(3.0, 4.0);
            assert!(frame.to_part(frame.to_grid(p)).distance(p) < 1e-12);
        }
    }
}
