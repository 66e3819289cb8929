//! Leaves out the vertices of lines and contours that hardly change them.
//!
//! Method: Douglas and Peucker (`douglas1973`). The vertex farthest from the chord between two kept vertices
//! is kept if it lies farther than the tolerance from it. The two halves are then treated in the same way. A
//! closed line needs two vertices to begin with: its leftmost one, and the vertex farthest from that. Both
//! are corners of the convex hull, so the result is independent of where the contour begins. A stack replaces
//! recursion, whose depth could reach the number of vertices.
//!
//! Tolerances are in mm; every vertex left out lies within the tolerance of the simplified line. Cost: n log
//! n for usual lines, n squared at worst; memory is one flag a vertex and the stack.
//!
//! Degenerate cases: open lines of fewer than three points stay. Contours of fewer than three points, and
//! contours whose area becomes 0, become empty; a polygon whose outline becomes empty is dropped with its
//! holes. Contours are simplified one by one, so two that come closer than the tolerance may touch or cross.

use glam::DVec2;

use super::{Contour, Polygon, Region, signed_area_mm2};
use crate::segment;

/// Marks the vertices between `line[lo]` and `line[hi]` that Douglas-Peucker keeps.
fn mark(line: &[DVec2], lo: usize, hi: usize, tolerance2: f64, keep: &mut [bool]) {
    // A stack replaces recursion, whose depth may reach the number of vertices in a spiral.
    let mut stack = vec![(lo, hi)];
    while let Some((lo, hi)) = stack.pop() {
        let far = (lo + 1..hi)
            .map(|i| (segment::distance_squared_mm2(line[i], line[lo], line[hi]), i))
            .fold((tolerance2, usize::MAX), |best, d| if d.0 > best.0 { d } else { best });
        if far.1 != usize::MAX {
            keep[far.1] = true;
            stack.push((lo, far.1));
            stack.push((far.1, hi));
        }
    }
}

/// An open polyline without the vertices that lie within `tolerance_mm` of the simplified line
/// (Douglas-Peucker). The ends stay.
pub fn simplify_line(line: &[DVec2], tolerance_mm: f64) -> Vec<DVec2> {
    if line.len() < 3 {
        return line.to_vec();
    }
    let mut keep = vec![false; line.len()];
    (keep[0], keep[line.len() - 1]) = (true, true);
    mark(line, 0, line.len() - 1, tolerance_mm * tolerance_mm, &mut keep);
    line.iter().zip(keep).filter_map(|(&p, k)| k.then_some(p)).collect()
}

/// A closed line simplified in the same way; empty if no area remains.
pub fn simplify_contour(contour: &[DVec2], tolerance_mm: f64) -> Contour {
    if contour.len() < 3 {
        return Vec::new();
    }
    // The method needs two fixed vertices. The lexicographically lowest one and the one farthest
    // from it are corners of the convex hull, whatever the starting point of the contour.
    let least = |a: DVec2, b: DVec2| (a.x, a.y) < (b.x, b.y);
    let start = (1..contour.len()).fold(0, |s, i| if least(contour[i], contour[s]) { i } else { s });
    let mut line: Vec<DVec2> = contour[start..].iter().chain(&contour[..=start]).copied().collect();
    let last = line.len() - 1;
    let far = (1..last).fold((0.0, 1), |best, i| {
        let d = line[i].distance_squared(line[0]);
        if d > best.0 { (d, i) } else { best }
    });
    let mut keep = vec![false; line.len()];
    keep[0] = true;
    keep[far.1] = true;
    let tolerance2 = tolerance_mm * tolerance_mm;
    mark(&line, 0, far.1, tolerance2, &mut keep);
    // Both halves share their ends, so the contour stays closed.
    mark(&line, far.1, last, tolerance2, &mut keep);
    let mut kept = keep.into_iter();
    line.retain(|_| kept.next() == Some(true));
    if line.len() < 3 || signed_area_mm2(&line) == 0.0 { Vec::new() } else { line }
}

impl Region {
    /// The region without the vertices that lie within `tolerance_mm` of the simplified contours.
    /// Contours are simplified one by one, so two that come closer than the tolerance may touch.
    pub fn simplified(&self, tolerance_mm: f64) -> Self {
        let polygon = |p: &Polygon| {
            let outer = simplify_contour(&p.outer, tolerance_mm);
            let holes =
                p.holes.iter().map(|h| simplify_contour(h, tolerance_mm)).filter(|h| !h.is_empty()).collect();
            (!outer.is_empty()).then_some(Polygon { outer, holes })
        };
        Self { polygons: self.polygons.iter().filter_map(polygon).collect() }
    }
}
