//! The last look: what is not as it should be, and where.

use std::fmt;

use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::{DVec2, Polygon, Region, Toolpath};

use super::super::field::widths::{Line, Neighbours};
use super::rings::SEEN_BEADS;

/// Something that kept a layer's island from being one sound path.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Where, in part coordinates.
    pub at_mm: DVec2,
    /// What.
    pub what: Problem,
}

/// What can be wrong with a path.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// The place between two rooms of an island holds no bead there and back.
    Neck {
        /// The narrowest place that would do, mm.
        needed_mm: f64,
    },
    /// A ring that nothing runs along closely enough to join it.
    Apart {
        /// Its length, mm.
        length_mm: f64,
    },
    /// A path crosses itself or another one.
    Crossing,
    /// A path leaves its room.
    Outside,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = (self.at_mm.x, self.at_mm.y);
        match self.what {
            Problem::Neck { needed_mm } => write!(
                f,
                "the neck at ({x:.2}, {y:.2}) is too narrow for a bead there and back, so its sides are printed one after the other: make it {needed_mm:.2} mm wide, or the bead narrower"
            ),
            Problem::Apart { length_mm } => write!(
                f,
                "{length_mm:.1} mm of path at ({x:.2}, {y:.2}) lie too far from the rest to be joined and are printed on their own: make the place wider, or the bead narrower"
            ),
            Problem::Crossing => write!(f, "the path crosses itself at ({x:.2}, {y:.2})"),
            Problem::Outside => write!(f, "the path leaves its room at ({x:.2}, {y:.2})"),
        }
    }
}

/// Paths may lie this far outside their room, mm: rounding and thinning of points.
const SLACK_MM: f64 = 0.01;

/// Looks at the paths of a room: what lies apart from the first one, crossings, and what lies outside.
pub fn check(paths: &[Toolpath], room: &Polygon, spacing_mm: f64) -> Vec<Note> {
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
    let inside = LineClipper::new(&Region::from(room.clone()).offset(SLACK_MM, Join::Miter(2.0)));
    let leaves = |l: &Line| {
        let out = l.points.first().is_some_and(|&p| !inside.contains(p));
        let crossing = || (0..l.n_segments()).map(|s| l.segment(s)).find(|s| inside.meets(s.0, s.1));
        if out { l.points.first().copied() } else { crossing().map(|s| s.0) }
    };
    notes.extend(lines.iter().filter_map(leaves).map(|at_mm| Note { at_mm, what: Problem::Outside }));
    notes
}

/// The necks that part the rooms of one island: each room's nearest way to those before it.
pub fn necks(rooms: &[Polygon], bead_width_mm: f64, notes: &mut Vec<Note>) {
    let nearest = |k: usize| {
        let mut best = (f64::INFINITY, DVec2::ZERO);
        for p in rooms[k].contours().flatten() {
            for (a, b) in
                rooms[..k].iter().flat_map(|r| r.contours()).flat_map(|c| grainpath_core::poly::edges(c))
            {
                let d = b - a;
                let t = ((*p - a).dot(d) / d.length_squared().max(1e-18)).clamp(0.0, 1.0);
                let q = a + t * d;
                if p.distance(q) < best.0 {
                    best = (p.distance(q), p.midpoint(q));
                }
            }
        }
        best
    };
    for k in 1..rooms.len() {
        let (_, at_mm) = nearest(k);
        let what = Problem::Neck { needed_mm: 1.2 * bead_width_mm };
        notes.push(Note { at_mm, what });
    }
}
