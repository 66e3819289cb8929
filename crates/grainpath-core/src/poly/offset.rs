//! Grows and shrinks regions by a distance, and makes the region around a line.
//!
//! Method: coordinates are rounded to integers of `GRID_MM`, and the crate `clipper2-rust` moves every edge
//! along its normal and joins neighbouring edges by an arc or a sharp corner. These raw outlines may overlap
//! themselves; the winding number decides which places belong to the result (`chen2005`). A boolean with the
//! non-zero rule then orders outlines and holes, and the result is simplified. Opening is an offset inwards
//! and out again; closing is one outwards and in again.
//!
//! Distances are in mm, positive outwards. Arcs are polylines within 0.005 mm, and vertices that move the
//! border by less than 0.002 mm are left out, so the border of one offset is right to about 0.007 mm. Cost: n
//! log n for n vertices of input and arcs together, as long as the raw outlines cross each other in few
//! places.
//!
//! Degenerate cases: an empty region and a distance of 0 return the region itself. A distance below half a
//! grid step only rounds and simplifies. A region thinner than twice a negative distance vanishes. The region
//! around a line without points is empty.

use clipper2_rust as c2;
use glam::DVec2;

use super::{Contour, FillRule, GRID_MM, Region};

/// The shape of an offset at corners where its sides move apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Join {
    /// Arcs, as polylines within 0.005 mm.
    Round,
    /// Sharp corners. A tip that would lie farther from the corner than this many offset distances is cut off.
    Miter(f64),
}

/// Largest error of a polyline that stands for an arc, mm. Source: derived. Below half a microstep: a belt drive of 40 mm
/// a turn with 200 steps of 16 microsteps moves 0.0125 mm a microstep.
const ARC_TOLERANCE_MM: f64 = 0.005;
/// A vertex is dropped if the line without it passes within this distance of it, mm, so that repeated
/// offsets do not collect vertices. Source: derived. Twice the last digit that G-code has, 0.001 mm.
const SIMPLIFY_MM: f64 = 0.002;

impl Region {
    /// The area within `delta_mm` of the region. For a negative distance, the area deeper than that
    /// inside it.
    pub fn offset(&self, delta_mm: f64, join: Join) -> Self {
        if self.is_empty() || delta_mm == 0.0 {
            return self.clone();
        }
        let paths: c2::Paths64 = self.contours().map(|c| to_grid(c)).collect();
        let (join, limit) = match join {
            Join::Round => (c2::JoinType::Round, 2.0),
            Join::Miter(limit) => (c2::JoinType::Miter, limit),
        };
        let grown = c2::inflate_paths_64(
            &paths,
            delta_mm / GRID_MM,
            join,
            c2::EndType::Polygon,
            limit,
            // The library takes the tolerance in its own units, not in mm.
            ARC_TOLERANCE_MM / GRID_MM,
        );
        from_grid(&grown)
    }

    /// The area within `r_mm` of a line.
    pub fn around_line(line: &[DVec2], closed: bool, r_mm: f64) -> Self {
        let end = if closed { c2::EndType::Joined } else { c2::EndType::Round };
        let tolerance = ARC_TOLERANCE_MM / GRID_MM;
        let grown = c2::inflate_paths_64(
            &vec![to_grid(line)],
            r_mm / GRID_MM,
            c2::JoinType::Round,
            end,
            2.0,
            tolerance,
        );
        from_grid(&grown)
    }

    /// The part of the region that a disc of radius `r_mm` inside it can cover: thin places vanish.
    pub fn opened(&self, r_mm: f64) -> Self {
        self.offset(-r_mm, Join::Round).offset(r_mm, Join::Round)
    }

    /// The region together with all places that a disc of radius `r_mm` outside it cannot reach:
    /// thin gaps close.
    pub fn closed(&self, r_mm: f64) -> Self {
        self.offset(r_mm, Join::Round).offset(-r_mm, Join::Round)
    }
}

/// A line in the whole-numbered coordinates of the library.
fn to_grid(line: &[DVec2]) -> c2::Path64 {
    let rounded = |mm: f64| (mm / GRID_MM).round() as i64;
    line.iter().map(|p| c2::Point64::new(rounded(p.x), rounded(p.y))).collect()
}

/// The region that offset contours enclose. Offsets of neighbouring contours may overlap; the non-zero rule unites them.
fn from_grid(grown: &c2::Paths64) -> Region {
    let mm = |p: &c2::Point64| DVec2::new(p.x as f64 * GRID_MM, p.y as f64 * GRID_MM);
    let contours: Vec<Contour> = grown.iter().map(|c| c.iter().map(mm).collect()).collect();
    Region::from_contours(&contours, FillRule::NonZero).simplified(SIMPLIFY_MM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure_svg::FailurePicture;

    #[test]
    fn a_square_shrinks_and_grows() {
        let square = Region::rectangle(DVec2::ZERO, DVec2::splat(10.0));
        let mut picture = FailurePicture::new("offset");
        picture.region("square", &square);
        picture.region("shrunk", &square.offset(-1.0, Join::Miter(2.0)));
        picture.region("grown", &square.offset(1.0, Join::Round));
        assert!((square.offset(-1.0, Join::Miter(2.0)).area_mm2() - 64.0).abs() < 1e-6);
        assert!((square.offset(1.0, Join::Miter(2.0)).area_mm2() - 144.0).abs() < 1e-6);
        let round = square.offset(1.0, Join::Round).area_mm2();
        assert!((round - (100.0 + 40.0 + std::f64::consts::PI)).abs() < 0.03, "{round}");
        assert!(square.offset(-5.1, Join::Round).is_empty());
    }
}
