//! The last check of a continuous path: finds its faults and their places.
//!
//! Every path is checked for crossings with itself and with other paths, and for places outside its infill
//! region. Every island is checked for necks too narrow for two beads side by side. A finding is a
//! [`Note`]; the planner turns notes into warnings with layer and place, once for each kind. Without a
//! finding the paths are sound, because the search covers every pair of segments that share a bucket, and
//! compares sides exactly.

use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::{DVec2, Polygon, Region, Toolpath, Warning, WarningId, segment};

use super::super::field::widths::{Line, Neighbours};
use super::rings::SEEN_BEADS;

/// A reason why an island of a layer is not filled by one sound path.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Place, in part coordinates.
    pub at_mm: DVec2,
    /// Kind of problem.
    pub what: Problem,
}

/// Problems of a continuous path.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// Two infill regions of an island are connected by a neck too narrow for two beads side by
    /// side.
    Neck {
        /// The least width of the neck that would be enough, mm.
        needed_mm: f64,
    },
    /// A ring that could not be joined, because no other ring is close enough.
    Apart {
        /// Its length, mm.
        length_mm: f64,
    },
    /// A path crosses itself or another one.
    Crossing,
    /// A path leaves its infill region.
    Outside,
}

impl Note {
    /// The warning for the user. The caller has to add the layer.
    pub fn warning(&self) -> Warning {
        let warning = match self.what {
            Problem::Neck { needed_mm } => {
                let text = "a neck is too narrow for two beads side by side, so the areas it joins are printed separately";
                let remedy = format!("make it {needed_mm:.2} mm wide, or the bead narrower");
                Warning::new(WarningId::PathNeck, text).with_remedy(remedy)
            }
            Problem::Apart { length_mm } => {
                let text = format!(
                    "{length_mm:.1} mm of path lie too far from the rest to be joined and are printed on their own"
                );
                Warning::new(WarningId::PathNotJoined, text)
            }
            Problem::Crossing => Warning::new(WarningId::PathCrossing, "the path crosses itself"),
            Problem::Outside => Warning::new(WarningId::PathOutside, "the path leaves its infill region"),
        };
        warning.at_mm(self.at_mm.x, self.at_mm.y)
    }
}

/// Paths may lie this far outside their infill region, mm, because coordinates are rounded and points are
/// left out. Source: derived. Twice the distance by which leaving out points moves a line.
const SLACK_MM: f64 = 0.01;
/// A neck joins two areas for centrelines if it is this wide, in bead widths. Source: derived. The two beads of a strip
/// have their centrelines one spacing apart, which is less than a width; a fifth more is for rounding of contours.
const NECK_WIDTHS: f64 = 1.2;

/// Checks the paths of a region for rings that were not joined, crossings, and places outside the region.
pub(super) fn check(paths: &[Toolpath], infill_region: &Polygon, spacing_mm: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    for path in paths.iter().skip(1) {
        notes.push(Note { at_mm: path.start(), what: Problem::Apart { length_mm: path.length_mm() } });
    }
    let lines: Vec<Line> =
        paths.iter().map(|p| Line { points: p.points.clone(), closed: p.closed }).collect();
    for [(line, segment), _] in
        Neighbours::new(&lines, &Region::default(), SEEN_BEADS * spacing_mm).crossings().into_iter().take(3)
    {
        notes.push(Note { at_mm: lines[line].points[segment], what: Problem::Crossing });
    }
    let inside = LineClipper::new(&Region::from(infill_region.clone()).offset(SLACK_MM, Join::Miter(2.0)));
    let leaves = |l: &Line| {
        let out = l.points.first().is_some_and(|&p| !inside.contains(p));
        let crossing = || (0..l.n_segments()).map(|s| l.segment(s)).find(|s| inside.meets(s.0, s.1));
        if out { l.points.first().copied() } else { crossing().map(|s| s.0) }
    };
    notes.extend(lines.iter().filter_map(leaves).map(|at_mm| Note { at_mm, what: Problem::Outside }));
    notes
}

/// Notes the necks between the infill regions of one island: for each region the place where it comes
/// nearest to the regions before it.
pub(in crate::fill) fn necks(infill_regions: &[Polygon], bead_width_mm: f64, notes: &mut Vec<Note>) {
    let nearest = |k: usize| {
        let mut best = (f64::INFINITY, DVec2::ZERO);
        for p in infill_regions[k].contours().flatten() {
            for (a, b) in infill_regions[..k]
                .iter()
                .flat_map(|r| r.contours())
                .flat_map(|c| grainpath_core::poly::edges(c))
            {
                let q = segment::closest_point(*p, a, b);
                if p.distance(q) < best.0 {
                    best = (p.distance(q), p.midpoint(q));
                }
            }
        }
        best
    };
    for k in 1..infill_regions.len() {
        let (_, at_mm) = nearest(k);
        let what = Problem::Neck { needed_mm: NECK_WIDTHS * bead_width_mm };
        notes.push(Note { at_mm, what });
    }
}
