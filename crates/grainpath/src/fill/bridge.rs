//! Chooses the direction of a bridge: along the short way between its supports.
//!
//! Twelve directions in steps of 15 degrees are tried, and the directions along and across the four longest
//! edges, because most bridges span two parallel walls. The score of a direction is the share of the total
//! line length that belongs to lines with both ends on the layer below. Among the directions within 1 % of
//! the best share, the one with the shortest mean free span wins. If no direction is supported, the bridge
//! takes the raster angle of the skins.
//!
//! Cost: at most 20 directions times the lines of the bridge, each clipped once.

use std::f64::consts::PI;

use grainpath_core::math::{atan2, direction};
use grainpath_core::poly::{LineClipper, edges};
use grainpath_core::{DVec2, Polygon, Region};

use super::hatch::{Hatch, Joints, Lines};

/// The direction in which most of a bridge's lines have both ends on the layer below; among equal
/// directions the one with the shortest free spans. `None` if no direction has such lines.
///
/// `below` is the section of the layer under the bridge.
pub fn bridge_angle_rad(bridge: &Polygon, below: &Region, spacing_mm: f64) -> Option<f64> {
    let hold = LineClipper::new(below);
    let mut angles: Vec<f64> = (0..12).map(|k| f64::from(k) * PI / 12.0).collect();
    // The directions along and across the longest edges: a bridge between parallel walls runs square to
    // them, or along its free ends.
    let mut long: Vec<(f64, DVec2)> =
        bridge.contours().flat_map(|c| edges(c)).map(|(a, b)| (a.distance(b), b - a)).collect();
    long.sort_by(|a, b| b.0.total_cmp(&a.0));
    let turns = long.iter().take(4).flat_map(|(_, d)| [atan2(d.y, d.x), atan2(d.y, d.x) + 0.5 * PI]);
    angles.extend(turns.map(|a| a.rem_euclid(PI)));
    let mut best: Option<(f64, f64, f64)> = None;
    for angle in angles {
        let (held, span) = score(bridge, &hold, angle, spacing_mm);
        let better = best.is_none_or(|(h, s, _)| held > h + 0.01 || (held > h - 0.01 && span < s * 0.98));
        if held > 0.05 && better {
            best = Some((held, span, angle));
        }
    }
    best.map(|(_, _, angle)| angle)
}

/// Share of the line length that is supported at both ends, and the mean free span of a line, mm.
fn score(bridge: &Polygon, hold: &LineClipper, angle_rad: f64, spacing_mm: f64) -> (f64, f64) {
    // Every other bead is enough to compare directions and halves the cost of twenty trials.
    // The odd offset of 0.37 keeps lines off edges at round coordinates.
    let step_mm = 2.0 * spacing_mm;
    let hatch = Hatch::new(bridge, Lines { angle_rad, first_mm: 0.37 * step_mm, step_mm });
    let along = direction(angle_rad);
    let (mut all, mut held, mut free, mut n) = (0.0, 0.0, 0.0, 0.0);
    for line in hatch.paths(&Joints { longest_mm: 0.0, bulge_mm: 0.0, past_mm: 0.0 }) {
        let (a, b) = (line[0], line[line.len() - 1]);
        let length = a.distance(b);
        // The end of a line lies on the border of the bridge, where rounding decides whether it is inside
        // the layer below. So the test point is moved 0.3 mm inwards along the line, to where the bridge
        // still overlaps its support.
        let step = if (b - a).dot(along) > 0.0 { along } else { -along } * 0.3;
        all += length;
        if hold.contains(a + step) && hold.contains(b - step) {
            held += length;
        }
        let over: f64 =
            hold.clip(&[a, b]).iter().map(|p| p.points[0].distance(p.points[p.points.len() - 1])).sum();
        free += length - over;
        n += 1.0;
    }
    // A direction without any line must lose against every other direction, in the free span too.
    if all > 0.0 { (held / all, free / n) } else { (0.0, f64::INFINITY) }
}
