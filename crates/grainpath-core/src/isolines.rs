//! Finds the lines on which a function is zero, from its values at the nodes of a grid.
//!
//! Marching squares: in every square the zeros on two sides are joined by a line. If all four sides have a zero, the
//! value in the middle decides which are joined. Positive values lie to the left of a line. Cost: linear in the nodes.

use crate::DVec2;

/// A line on which a function is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Isoline {
    /// Its points.
    pub points: Vec<DVec2>,
    /// Whether the last point is joined to the first. A line that is not closed ends on the border of the grid.
    pub closed: bool,
}

/// Marks a side after which no point of the line follows.
const NONE: u32 = u32::MAX;

/// The lines on which a function is zero. `values` are given row by row at `n` nodes in x and y, `cell_mm` apart; the
/// first node is at `origin`.
///
/// ```
/// use grainpath_core::isolines::isolines;
/// use grainpath_core::poly::signed_area_mm2;
/// use grainpath_core::DVec2;
///
/// // A disc of radius 3 in a square of 8 x 8.
/// let values: Vec<f32> = (0..81).map(|i| 3.0 - ((i % 9 - 4) as f32).hypot((i / 9 - 4) as f32)).collect();
/// let lines = isolines([9, 9], DVec2::splat(-4.0), 1.0, &values);
/// assert!(lines.len() == 1 && lines[0].closed);
/// assert!((signed_area_mm2(&lines[0].points) / 28.27 - 1.0).abs() < 0.06);
/// ```
pub fn isolines(n: [usize; 2], origin: DVec2, cell_mm: f64, values: &[f32]) -> Vec<Isoline> {
    let [nx, ny] = n;
    // For each side, the next side on the line. Sides to the right of a node come first, then sides upwards.
    let mut next = vec![NONE; 2 * nx * ny];
    let mut is_start = vec![true; 2 * nx * ny];
    let above = |i: usize, j: usize| values[j * nx + i] >= 0.0;
    for j in 0..ny.saturating_sub(1) {
        for i in 0..nx.saturating_sub(1) {
            // Corners and sides are listed counter-clockwise.
            let corners = [above(i, j), above(i + 1, j), above(i + 1, j + 1), above(i, j + 1)];
            if corners == [true; 4] || corners == [false; 4] {
                continue;
            }
            let at = |i: usize, j: usize| j * nx + i;
            let sides = [at(i, j), nx * ny + at(i + 1, j), at(i, j + 1), nx * ny + at(i, j)];
            let crossed = |k: usize| corners[k] != corners[(k + 1) % 4];
            let mut join = |from: usize, to: usize| {
                next[sides[from]] = sides[to] as u32;
                is_start[sides[to]] = false;
            };
            // Going around counter-clockwise, a line starts where values fall below zero and ends where they rise again.
            let outs = (0..4).filter(|&k| crossed(k) && corners[k]);
            let middle: f32 =
                [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)].map(|k| values[k]).iter().sum();
            for out in outs {
                let turns = if (0..4).all(crossed) {
                    // If the middle is above zero, the line cuts off the corner after the side, otherwise the one before.
                    if middle >= 0.0 { 1 } else { 3 }
                } else {
                    (1..4).find(|t| crossed((out + t) % 4)).unwrap_or(1)
                };
                join(out, (out + turns) % 4);
            }
        }
    }
    let zero = |side: usize| {
        let (node, up) = (side % (nx * ny), side >= nx * ny);
        let (i, j) = (node % nx, node / nx);
        let a = f64::from(values[node]);
        let b = f64::from(values[if up { node + nx } else { node + 1 }]);
        let t = if a == b { 0.5 } else { (a / (a - b)).clamp(0.0, 1.0) };
        let (x, y) = if up { (i as f64, j as f64 + t) } else { (i as f64 + t, j as f64) };
        origin + cell_mm * DVec2::new(x, y)
    };
    let mut out = Vec::new();
    // Lines that end on the border are traced first; the remaining lines are closed.
    for closed in [false, true] {
        for side in 0..next.len() {
            if next[side] == NONE || (!closed && !is_start[side]) {
                continue;
            }
            let mut points = vec![zero(side)];
            let mut here = side;
            while next[here] != NONE {
                let to = next[here] as usize;
                next[here] = NONE;
                here = to;
                if here != side {
                    points.push(zero(here));
                }
            }
            out.push(Isoline { points, closed });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_on_the_border_and_saddles_are_cut_by_their_middle() {
        // x + 0.25 over 3 x 3 nodes from -1 to 1: one upright line that is above zero on its left, so downwards.
        let values: Vec<f32> = (0..9).map(|i| 0.25 - (i % 3 - 1) as f32).collect();
        let lines = isolines([3, 3], DVec2::splat(-1.0), 1.0, &values);
        assert_eq!(lines.len(), 1);
        assert!(!lines[0].closed && lines[0].points.iter().all(|p| (p.x - 0.25).abs() < 1e-6));
        assert!(lines[0].points[0].y < lines[0].points[2].y);
        for (middle, joined) in [(0.5f32, true), (-0.5, false)] {
            let values = [1.0 + middle, -1.0, -1.0, 1.0 + middle];
            let lines = isolines([2, 2], DVec2::ZERO, 1.0, &values);
            assert_eq!(lines.len(), 2);
            // Lines around the corners below zero keep the middle on the left.
            let p = lines[0].points[0];
            let q = lines[0].points[1];
            let left = crate::math::cross(q - p, DVec2::splat(0.5) - p) > 0.0;
            assert_eq!(left, joined);
        }
    }
}
