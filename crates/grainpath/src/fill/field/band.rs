//! Beads along some stretches of a border: those that the field crosses, or those beside another region.
//!
//! Lines along the field end where they meet the border across. Where they are to end farther from it in some layers
//! ([`Shift`](crate::fill::Shift)), the band that this frees is filled with beads along the border. Stretches of border
//! that run with the field have no ends and get no band.
//!
//! Lengths are in mm. Cost: one offset of the region for each bead of the band, and a boolean operation.

use grainpath_core::math::cross;
use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::polyline::{self, resampled};
use grainpath_core::tuned::Tuned;
use grainpath_core::{DVec2, Region, Toolpath};

use crate::fill::FillContext;

/// The field crosses a border where they meet at more than 30 degrees. Source: derived; below that the next line ends more
/// than two beads away along the border, so that no column of ends is dense.
const ACROSS_SINE: f64 = 0.5;
/// The angle between field and border is taken once in this length, in beads. Source: derived; one line ends in it where
/// the field crosses at a right angle, so no end is judged by the angle at another one.
const STEP: f64 = 1.0;
/// Stretches shorter than this get no band, and beads along the border shorter than this are not laid, in beads.
/// Measured: row `fill.field.band.SHORTEST` of `cargo xtask bench constants`.
static SHORTEST: Tuned<f64> = Tuned::new("fill.field.band.SHORTEST", 6.0);

/// Whether the field crosses an edge of a border.
pub(super) fn is_crossed(axis: &dyn Fn(DVec2) -> DVec2, [a, b]: [DVec2; 2]) -> bool {
    cross(axis(0.5 * (a + b)), (b - a).normalize_or_zero()).abs() > ACROSS_SINE
}

/// Lays `n` beads along the stretches of a border whose edges are `chosen`, and returns what is left for lines: the area for
/// their centrelines. Areas lie to the left of their edges.
pub(crate) fn laid(
    infill_region: &Region,
    chosen: &dyn Fn([DVec2; 2]) -> bool,
    n: usize,
    spacing_mm: f64,
    context: &FillContext<'_>,
    out: &mut Vec<Toolpath>,
) -> Region {
    let stretches = stretches(infill_region, chosen, spacing_mm);
    if n == 0 || stretches.is_empty() {
        return infill_region.clone();
    }
    let within = |mm: f64| {
        let near = stretches.iter().map(|s| Region::around_line(s, false, mm));
        near.fold(Region::default(), |a, b| a.union(&b))
    };
    // The outer edge of the last bead's strip.
    let deep_mm = (n as f64 - 0.5) * spacing_mm;
    let band = LineClipper::new(&within(deep_mm));
    for k in 0..n {
        let inner = infill_region.offset(-(k as f64) * spacing_mm, Join::Miter(2.0));
        for contour in inner.contours() {
            let mut line = contour.clone();
            line.extend(contour.first().copied());
            let mut pieces: Vec<Vec<DVec2>> = band.clip(&line).into_iter().map(|p| p.points).collect();
            // A piece that passes the contour's first point was cut there.
            let meets = |a: &Vec<DVec2>, b: &Vec<DVec2>| a.last() == line.last() && b.first() == line.first();
            if pieces.len() > 1 && meets(&pieces[pieces.len() - 1], &pieces[0]) {
                let mut last = pieces.pop().unwrap_or_default();
                last.extend(pieces[0].drain(1..));
                pieces[0] = last;
            }
            for mut points in pieces {
                let closed = points.first() == points.last();
                if closed {
                    points.pop();
                }
                if polyline::length_mm(&points, closed) > SHORTEST.value() * spacing_mm {
                    out.push(Toolpath::new(points, context.bead_width_mm, context.role, closed));
                }
            }
        }
    }
    infill_region.difference(&within(deep_mm + context.border_mm))
}

/// The stretches of a region's contours whose edges are `chosen`.
fn stretches(region: &Region, chosen: &dyn Fn([DVec2; 2]) -> bool, spacing_mm: f64) -> Vec<Vec<DVec2>> {
    let mut out = Vec::new();
    for contour in region.contours() {
        // Vertices stay, so that the band has the border's corners.
        let mut points: Vec<DVec2> = Vec::new();
        for (a, b) in grainpath_core::poly::edges(contour) {
            let mut piece = resampled(&[a, b], false, STEP * spacing_mm);
            piece.pop();
            points.append(&mut piece);
        }
        let n = points.len();
        let marks: Vec<bool> = (0..n).map(|i| chosen([points[i], points[(i + 1) % n]])).collect();
        let Some(start) = marks.iter().position(|m| !m) else {
            points.extend(points.first().copied());
            out.push(points);
            continue;
        };
        let mut stretch: Vec<DVec2> = Vec::new();
        for i in (start..start + n).map(|i| i % n) {
            if marks[i] {
                if stretch.is_empty() {
                    stretch.push(points[i]);
                }
                stretch.push(points[(i + 1) % n]);
            } else if !stretch.is_empty() {
                out.push(std::mem::take(&mut stretch));
            }
        }
        if !stretch.is_empty() {
            out.push(stretch);
        }
    }
    out.retain(|s| polyline::length_mm(s, false) > SHORTEST.value() * spacing_mm);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::Shift;
    use grainpath_core::math::direction;
    use grainpath_core::{Density, Polygon, Role};
    use grainpath_job::choices::{BeadEnds, BeadWidths};

    const SPACING_MM: f64 = 0.4;

    fn laid_in(region: &Region, axis: &dyn Fn(DVec2) -> DVec2, n: usize) -> (Region, Vec<Toolpath>) {
        let context = FillContext {
            z_mid_mm: 0.1,
            height_mm: 0.2,
            bead_width_mm: 0.44,
            min_bead_width_mm: 0.2,
            density: Density::new(1.0),
            angle_rad: 0.0,
            part: region.bounds().expect("a region"),
            role: Role::SolidFill,
            border_mm: 0.5 * SPACING_MM,
            ends: BeadEnds::Joined,
            shift: Shift::NONE,
            below: None,
            fills_wedges: true,
            widths: BeadWidths::Variable,
            field: None,
        };
        let mut out = Vec::new();
        let chosen = |edge| is_crossed(axis, edge);
        let rest = laid(region, &chosen, n, SPACING_MM, &context, &mut out);
        (rest, out)
    }

    fn disk(radius_mm: f64) -> Region {
        let round = |k: usize| direction(k as f64 / 180.0 * std::f64::consts::TAU) * radius_mm;
        Region::from(Polygon { outer: (0..180).map(round).collect(), holes: Vec::new() })
    }

    #[test]
    fn only_sides_that_the_field_crosses_get_a_band() {
        let region = Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0));
        let (rest, beads) = laid_in(&region, &|_| DVec2::X, 3);
        // Three beads at each short side, a spacing apart, which turn the corners within the band.
        let depths = |b: &Toolpath| Vec::from_iter(b.points.iter().map(|p| p.x.min(20.0 - p.x)));
        let mut at = Vec::from_iter(beads.iter().map(|b| depths(b).into_iter().fold(9.0, f64::min)));
        at.sort_by(f64::total_cmp);
        let expect = [0.0, 0.0, 0.4, 0.4, 0.8, 0.8];
        assert!(at.len() == 6 && at.iter().zip(expect).all(|(a, e)| (a - e).abs() < 0.01), "{at:?}");
        assert!(
            beads.iter().all(|b| !b.closed && depths(b).iter().all(|d| *d < 1.01) && b.length_mm() > 8.5)
        );
        // Centrelines of the lines begin one spacing behind that of the last bead, and keep the long sides.
        let bounds = rest.bounds().expect("a rest");
        let middle = rest.polygons.iter().flat_map(|p| &p.outer).filter(|p| (p.y - 5.0).abs() < 4.0);
        assert!(middle.clone().all(|p| p.x >= 1.19 && p.x <= 18.81));
        assert!((bounds.min.y.abs() < 0.01) && (bounds.max.y - 10.0).abs() < 0.01, "{bounds:?}");
        assert!((rest.area_mm2() - 17.6 * 10.0).abs() < 2.0, "{}", rest.area_mm2());
    }

    #[test]
    fn a_field_across_the_whole_border_gives_closed_beads() {
        let (rest, beads) = laid_in(&disk(8.0), &|p| p.normalize_or_zero(), 2);
        let mut radii: Vec<f64> = beads.iter().map(|b| b.points[0].length()).collect();
        radii.sort_by(f64::total_cmp);
        assert!(beads.len() == 2 && beads.iter().all(|b| b.closed), "{beads:?}");
        assert!((radii[0] - 7.6).abs() < 0.02 && (radii[1] - 8.0).abs() < 0.02, "{radii:?}");
        let expect = std::f64::consts::PI * 7.2 * 7.2;
        assert!((rest.area_mm2() / expect - 1.0).abs() < 0.01, "{} and {expect}", rest.area_mm2());
    }

    #[test]
    fn a_field_along_the_border_or_short_sides_leave_the_region_as_it_is() {
        // Sides across the field of 2 mm, shorter than six beads of 0.4 mm.
        let strip = Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 2.0));
        let around = |p: DVec2| p.perp().normalize_or_zero();
        for (region, axis) in [(disk(8.0), &around as &dyn Fn(DVec2) -> DVec2), (strip, &|_| DVec2::X)] {
            let (rest, beads) = laid_in(&region, axis, 3);
            assert!(beads.is_empty());
            assert_eq!(rest.area_mm2(), region.area_mm2());
        }
    }
}
