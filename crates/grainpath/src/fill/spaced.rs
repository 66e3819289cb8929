//! Chooses offset and spacing of solid infill lines, so that edges parallel to the lines are neither under-
//! nor over-filled.
//!
//! Where the height of a region across the lines is not a whole number of beads, evenly spaced lines leave
//! part of a bead open along edges parallel to them. For the two outermost edges this is always avoided by
//! adapting the spacing. In a region with steps, other pairs of edges are tried as well: each pair decides
//! offset and spacing for a given number of lines. The pair wins for which the area left open or laid twice
//! along all edges is least.
//!
//! ```text
//!    +------------------+   edges of a tensile bar: grips (outer pair) and gauge (inner pair);
//!    |   +----------+   |   lines that fit the grips alone left 0.24 mm open along the gauge
//!    |   |          |   |
//! ```
//!
//! For such pairs spacing and bead widths change by at most [`PLAY`]. Measured (CHANGELOG 0.1.0): the gap
//! of the tensile bar of ISO 527 at 0 degrees fell from 1.53 % to 0.12 %. Cost: pairs of the [`MOST`]
//! longest edges times a few spacings. Degenerate cases: a region without height gives `None`; a region
//! narrower than two beads gets a single line.

use grainpath_core::Polygon;
use grainpath_core::math::{direction, rotated};

use super::hatch::Lines;

/// Largest change of the spacing, as a share. Lines may lie this much closer or farther apart than
/// beads that just touch, if they then fit more borders than the outermost two. Source: derived.
/// Gap and overlap of 3 % are hardly more than the 2.3 % that a filament of 1.75 +- 0.02 mm
/// causes.
const PLAY: f64 = 0.03;
/// A border counts as parallel to the lines if it rises by at most this share of the spacing over its length.
const RISE: f64 = 0.1;
/// Number of borders that are tried in pairs; the longest ones are taken.
const MOST: usize = 8;

/// A line exactly on a border may be lost when the region cuts it. So it is moved inwards by this share of
/// a strip. Source: derived: 1e-3 of a strip of 0.45 mm is 0.45 um, more than four times the polygon grid
/// of 0.1 um and far below what a machine resolves.
const HAIR: f64 = 1e-3;

/// A border parallel to the lines.
#[derive(Debug, Clone, Copy)]
struct Border {
    y_mm: f64,
    length_mm: f64,
    /// 1 if the region lies above the border, -1 if it lies below.
    side: f64,
}

/// The lines that fill a region with beads whose strips are about `s_mm` wide, and the exact width of the
/// strips. `None` for a region without height.
///
/// The strips of the outermost lines extend half a strip beyond the region, and the other lines are evenly
/// spaced between them. Where a region is narrower in places, lines that fit its lowest and highest border
/// leave a gap along other borders; then all pairs of borders are tried.
pub(super) fn lines(infill_region: &Polygon, angle_rad: f64, s_mm: f64) -> Option<(Lines, f64)> {
    let back = direction(-angle_rad);
    let rows = || infill_region.outer.iter().map(|&p| rotated(p, back).y);
    let (low, high) = rows().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), y| (lo.min(y), hi.max(y)));
    if low >= high {
        return None;
    }
    // The strips extend half a spacing beyond the region on both sides, and share this height evenly. The
    // surplus of 0.02 keeps the last line if rounding has taken up to a fiftieth of a bead from the
    // region.
    let n = ((high - low + s_mm) / s_mm + 0.02).floor().max(1.0);
    if n < 2.0 {
        let middle = Lines { angle_rad, first_mm: 0.5 * (low + high), step_mm: 2.0 * (high - low) };
        return Some((middle, high - low + s_mm));
    }
    let apart = (high - low + s_mm) / n;
    let hair = HAIR * s_mm;
    let even = Lines {
        angle_rad,
        first_mm: (low + 0.5 * (apart - s_mm)).max(low + hair),
        step_mm: (apart * (n - 1.0) - 2.0 * hair) / (n - 1.0),
    };
    let borders = borders(infill_region, angle_rad, s_mm);
    let today = missed_mm2(&borders, &even, s_mm);
    let mut best = (today, even);
    for (i, a) in borders.iter().enumerate() {
        for b in &borders[i + 1..] {
            // `turn` is the number of strips to add to the distance of the borders: 1 if they face each
            // other, 0 if the region lies on the same side of both, -1 if they are back to back.
            let turn = 0.5 * (a.side - b.side);
            let height = b.y_mm - a.y_mm + turn * s_mm;
            let fewest = (height / ((1.0 + PLAY) * s_mm) - turn).ceil().max(1.0);
            let most = (height / ((1.0 - PLAY) * s_mm) - turn).floor().min(fewest + 12.0);
            let mut steps = fewest;
            while steps <= most {
                if steps + turn >= 1.0 {
                    let tried = between(a, b, steps, angle_rad, s_mm);
                    let missed = missed_mm2(&borders, &tried, s_mm);
                    if missed < best.0 {
                        best = (missed, tried);
                    }
                }
                steps += 1.0;
            }
        }
    }
    // A gain below the square of a bead, or below a tenth, is not worth a spacing that differs from the
    // layers above and below.
    let better = best.0 < today - (0.1 * today).max(s_mm * s_mm);
    Some(if better { (best.1, best.1.step_mm) } else { (even, apart) })
}

/// Lines that fit two borders, `a` below `b`, in this number of steps.
fn between(a: &Border, b: &Border, steps: f64, angle_rad: f64, s_mm: f64) -> Lines {
    let (height, turn) = (b.y_mm - a.y_mm, 0.5 * (a.side - b.side));
    let apart = (height + turn * s_mm) / (steps + turn);
    // Wider beads lie farther from the border. Narrower beads must not lie outside the region, so they get
    // no offset.
    let inwards = (0.5 * (apart - s_mm)).max(0.0);
    let inwards = inwards.max(HAIR * s_mm);
    let first_mm = a.y_mm + a.side * inwards;
    let last_mm = b.y_mm + b.side * inwards;
    Lines { angle_rad, first_mm, step_mm: (last_mm - first_mm) / steps }
}

/// Area left open or laid twice along borders, mm2.
fn missed_mm2(borders: &[Border], lines: &Lines, s_mm: f64) -> f64 {
    let wanted = 0.5 * (lines.step_mm - s_mm).max(0.0);
    let one = |b: &Border| {
        let row = (b.y_mm - lines.first_mm) / lines.step_mm;
        let off = lines.step_mm * if b.side > 0.0 { row.ceil() - row } else { row - row.floor() };
        b.length_mm * (off - wanted).abs()
    };
    borders.iter().map(one).sum()
}

/// The longest borders parallel to the lines, from the lowest up.
fn borders(infill_region: &Polygon, angle_rad: f64, s_mm: f64) -> Vec<Border> {
    let back = direction(-angle_rad);
    let mut all: Vec<Border> = Vec::new();
    for contour in infill_region.contours() {
        for (a, b) in grainpath_core::poly::edges(contour) {
            // Short edges are dropped first, because the exact rotation is costly.
            let d = rotated(b - a, back);
            if d.x.abs() < s_mm || d.y.abs() > RISE * s_mm {
                continue;
            }
            let (a, b) = (rotated(a, back).y, rotated(b, back).y);
            // The region lies on the left of its contours.
            let (side, y_mm) = if d.x > 0.0 { (1.0, a.max(b)) } else { (-1.0, a.min(b)) };
            all.push(Border { y_mm, length_mm: d.x.abs(), side });
        }
    }
    all.sort_by(|a, b| a.side.total_cmp(&b.side).then(a.y_mm.total_cmp(&b.y_mm)));
    // Edges of one straight border that a mesh has cut into pieces count as one.
    all.dedup_by(|b, a| {
        let same = a.side == b.side && b.y_mm - a.y_mm < 0.5 * HAIR * s_mm;
        if same {
            a.length_mm += b.length_mm;
        }
        same
    });
    all.retain(|b| b.length_mm > 4.0 * s_mm);
    all.sort_by(|a, b| b.length_mm.total_cmp(&a.length_mm).then(a.y_mm.total_cmp(&b.y_mm)));
    all.truncate(MOST);
    all.sort_by(|a, b| a.y_mm.total_cmp(&b.y_mm).then(b.side.total_cmp(&a.side)));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec2;

    /// The infill region of a tensile bar: grips 19 mm wide, and a gauge of another width between them.
    fn bar(gauge_mm: f64, turned: DVec2) -> Polygon {
        let half = 0.5 * gauge_mm;
        let upper = [(-80.0, -9.5), (-50.0, -9.5), (-40.0, -half), (40.0, -half), (50.0, -9.5), (80.0, -9.5)];
        let lower = upper.iter().rev().map(|&(x, y)| (x, -y));
        let outer = upper.iter().copied().chain(lower).map(|p| rotated(p.into(), turned));
        Polygon { outer: outer.collect(), holes: Vec::new() }
    }

    #[test]
    fn lines_reach_the_walls_of_the_gauge_as_those_of_the_grips() {
        let s = 0.407;
        let (mut before, mut after) = (0.0, 0.0);
        for k in 0..40 {
            let angle = 0.1 * f64::from(k);
            let infill_region = bar(4.0 + 0.3 * f64::from(k), direction(angle));
            let (found, strip_mm) = lines(&infill_region, angle, s).expect("lines");
            assert!((strip_mm / s - 1.0).abs() <= 0.031, "{strip_mm}");
            let borders = borders(&infill_region, angle, s);
            assert_eq!(borders.len(), 4);
            let n = ((19.0 + s) / s + 0.02).floor();
            let even = between(&borders[0], &borders[3], n - 1.0, angle, s);
            let missed = [&even, &found].map(|l| missed_mm2(&borders, l, s));
            assert!(missed[1] <= missed[0] + s * s, "{k}: {missed:?}");
            before += missed[0];
            after += missed[1];
        }
        println!("{:.2} mm2 missed on average, {:.2} with even lines", after / 40.0, before / 40.0);
        assert!(after < 0.3 * before, "{before} {after}");
    }

    #[test]
    fn a_region_of_one_height_is_filled_from_border_to_border() {
        let corners = [(0.0, 0.0), (30.0, 0.0), (30.0, 9.3), (0.0, 9.3)];
        let infill_region = Polygon { outer: corners.map(DVec2::from).to_vec(), holes: Vec::new() };
        let (found, strip_mm) = lines(&infill_region, 0.0, 0.4).expect("lines");
        let n = (9.7 / strip_mm).round();
        assert!((n * strip_mm - 9.7).abs() < 1e-9 && strip_mm >= 0.4, "{strip_mm}");
        assert!((found.first_mm + (n - 1.0) * found.step_mm - (9.3 - found.first_mm)).abs() < 1e-3);
        assert!(lines(&Polygon { outer: vec![DVec2::ZERO; 3], holes: Vec::new() }, 0.0, 0.4).is_none());
    }
}
