//! Tests whether closed lines cross each other too often to be united, before the union begins.
//!
//! A union makes a point of every crossing of edges, and its time grows with the number of points. Sections of sound
//! parts have few crossings: about two for each pair of outlines that overlap. In sections of a damaged mesh every
//! edge may cross every other one, so that the number grows with the square of the edges. [`crosses_more_than`] tells
//! the two kinds apart in a bounded time.
//!
//! Method: edges are sorted into square cells, about one cell an edge. Two edges that cross do so in a cell that both
//! pass, so the number of pairs in all cells is an upper bound of the crossings. For most sound sections this bound is
//! below the limit, and nothing more is done. Otherwise pairs are tested exactly ([`crate::segment::meeting`]) until the
//! limit is reached.
//!
//! Cost: linear in the edges and the cells they pass, then a multiple of the limit or of the edges in pairs.
//! Degenerate cases: lines without an edge or without extent do not cross. Edges that only touch are not counted.

use super::{Contour, edges};
use crate::Bounds2;
use crate::DVec2;
use crate::buckets::{Buckets, CellGrid};
use crate::segment::{Meeting, meeting};

/// Pairs of edges tested for each crossing allowed: bounds the work where many edges share cells without crossing.
/// Source: derived. Two edges of random direction through one cell cross in it with a probability of about 0.2 to 0.5; in a
/// tangle the limit is therefore reached within a tenth of these tests.
const PAIRS_PER_CROSSING: usize = 50;
/// The greatest number of cells in a direction; it bounds the memory for contours of many edges.
/// Source: derived. 2000 x 2000 cells of a list each take 96 MB.
const MAX_CELLS_PER_SIDE: usize = 2000;

/// Whether closed lines cross themselves and each other in more than `limit` places. It is also true where the count
/// takes more tests than `PAIRS_PER_CROSSING` times the limit or the number of edges, whichever is larger.
///
/// ```
/// use grainpath_core::{DVec2, poly::crosses_more_than};
///
/// // A star of five points crosses itself five times.
/// let corner = |k: f64| DVec2::new((1.2566 * k).sin(), (1.2566 * k).cos());
/// let star = vec![[0.0, 2.0, 4.0, 1.0, 3.0].map(corner).to_vec()];
/// assert!(crosses_more_than(&star, 4) && !crosses_more_than(&star, 5));
/// ```
pub fn crosses_more_than(contours: &[Contour], limit: usize) -> bool {
    let all: Vec<[DVec2; 2]> =
        contours.iter().flat_map(|c| edges(c)).filter(|(a, b)| a != b).map(|(a, b)| [a, b]).collect();
    let n = all.len();
    let Some(bounds) = Bounds2::around_points(all.iter().flatten().copied()) else { return false };
    if n * n.saturating_sub(1) / 2 <= limit {
        return false;
    }
    let size = bounds.size();
    let cell_mm = (size.x * size.y / n as f64).sqrt().max(size.max_element() / n as f64);
    let grid = CellGrid::covering(bounds, cell_mm, MAX_CELLS_PER_SIDE);
    let mut counts = vec![0usize; grid.nx * grid.ny];
    for [a, b] in &all {
        grid.for_each_passed(*a, *b, |cell| counts[cell] += 1);
    }
    let pairs: usize = counts.iter().map(|&m| m * m.saturating_sub(1) / 2).sum();
    if pairs <= limit {
        return false;
    }
    let buckets = Buckets::of_segments(grid, n, |i| all[i]);
    let (mut crossings, mut tested) = (0, 0);
    for cell in 0..counts.len() {
        let members = buckets.members(cell);
        for (k, &i) in members.iter().enumerate() {
            for &j in &members[k + 1..] {
                let (one, other) = (all[i as usize], all[j as usize]);
                tested += 1;
                if meeting(one, other) == Meeting::Cross
                    && grid.index(grid.cell_of(crossing(one, other))) == cell
                {
                    crossings += 1;
                }
                if crossings > limit || tested > PAIRS_PER_CROSSING * limit.max(n) {
                    return true;
                }
            }
        }
    }
    false
}

/// The crossing of two segments that are known to cross.
fn crossing([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> DVec2 {
    let (along, across) = (b - a, d - c);
    a + along * ((c - a).perp_dot(across) / along.perp_dot(across)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Lines of any corners: the answer is that of testing every pair, but for crossings on the border of two cells.
        #[test]
        fn crossings_are_those_of_all_pairs(
            corners in prop::collection::vec((0.0f64..10.0, 0.0f64..10.0), 3..60),
        ) {
            let line: Contour = corners.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
            let all: Vec<[DVec2; 2]> = edges(&line).map(|(a, b)| [a, b]).collect();
            let mut crossings = 0;
            for (i, one) in all.iter().enumerate() {
                crossings += all[i + 1..].iter().filter(|other| meeting(*one, **other) == Meeting::Cross).count();
            }
            let contours = [line];
            prop_assert!(!crosses_more_than(&contours, crossings + 1));
            prop_assert!(crossings < 2 || crosses_more_than(&contours, crossings - 2));
        }
    }
}
