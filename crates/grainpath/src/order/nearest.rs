//! The nearest of many path ends, while paths are removed one by one.
//!
//! Ends lie in a square grid with about one end a cell. A search visits rings of cells around a
//! point and stops when no end of a farther ring can be nearer. Among equally near ends the lowest
//! number wins, so that the order of printing depends on the paths alone. Owners that are removed
//! stay in their cells and are skipped.
//!
//! A grid needs no rebalancing while owners disappear, which a tree does. Cost: constant while many
//! ends are left; a search among the last few visits most of the grid. A property test compares it
//! with a plain search.

use grainpath_core::buckets::{Buckets, CellGrid};
use grainpath_core::{Bounds2, DVec2};

/// Ends of paths in a grid; a path is taken away with both its ends.
pub(crate) struct NearestEnds {
    /// Point `2 i` and `2 i + 1` are the ends of path `i`.
    points: Vec<DVec2>,
    buckets: Buckets,
}

impl NearestEnds {
    /// Both ends of every path.
    pub(crate) fn new(ends: &[[DVec2; 2]]) -> Self {
        let points = ends.as_flattened().to_vec();
        let bounds = Bounds2::around_points(points.iter().copied());
        let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let size = bounds.size().max(DVec2::splat(1e-3));
        // About two ends a cell.
        let cell_mm = (size.x * size.y / points.len().max(1) as f64 * 2.0).sqrt();
        let cells = CellGrid::covering(bounds, cell_mm, 1000);
        let buckets = Buckets::new(cells, points.len(), |i, add| add(cells.index(cells.cell_of(points[i]))));
        Self { points, buckets }
    }

    /// The end nearest to `place` whose path is not taken, and whether it is the path's second. Of equally near ones the
    /// lowest numbered.
    pub(crate) fn nearest(&self, place: DVec2, taken: &[bool]) -> Option<(usize, bool)> {
        let cells = &self.buckets.cells;
        let middle = cells.cell_of(place);
        let mut best = (f64::INFINITY, u32::MAX);
        for ring in 0..cells.n_rings() {
            let reach = cells.ring_distance_mm(ring);
            if best.1 != u32::MAX && reach * reach > best.0 {
                break;
            }
            for cell in cells.ring(middle, ring) {
                for &i in self.buckets.members(cells.index(cell)) {
                    if !taken[i as usize / 2] {
                        let d = self.points[i as usize].distance_squared(place);
                        if d < best.0 || (d == best.0 && i < best.1) {
                            best = (d, i);
                        }
                    }
                }
            }
        }
        (best.1 != u32::MAX).then_some((best.1 as usize / 2, best.1 % 2 == 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn as_a_plain_search_finds(
            ends in proptest::collection::vec(((-50.0f64..50.0, -5.0f64..5.0), (-50.0f64..50.0, -5.0f64..5.0)), 1..60),
            at in (-80.0f64..80.0, -80.0f64..80.0),
            taken in proptest::collection::vec(any::<bool>(), 60),
        ) {
            let ends: Vec<[DVec2; 2]> = ends.into_iter().map(|(a, b)| [a.into(), b.into()]).collect();
            let at = DVec2::from(at);
            let found = NearestEnds::new(&ends).nearest(at, &taken);
            let all = ends.iter().flatten().enumerate().filter(|(i, _)| !taken[i / 2]);
            let plain = all.map(|(i, p)| (p.distance_squared(at), i)).min_by(|a, b| a.0.total_cmp(&b.0));
            prop_assert_eq!(found, plain.map(|(_, i)| (i / 2, i % 2 == 1)));
        }
    }
}
