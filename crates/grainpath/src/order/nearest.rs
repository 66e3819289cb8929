//! Finds the nearest of many path ends, while paths are removed one by one.
//!
//! Ends are sorted into a square grid with about two ends per cell. A search visits rings of cells
//! around a point and stops when no end in a farther ring can be nearer. Among equally near ends the
//! lowest number is taken, so that the printing order depends only on the paths.
//!
//! Ends of removed paths stay in their cells and are skipped. Once half of the ends are removed, the
//! grid is rebuilt from the rest, with cells of a suitable size. Cost: a search is linear in the ends
//! and cells nearby, however many are left; all grids together cost twice the first one. A property
//! test compares the results with a plain search.

use grainpath_core::buckets::{Buckets, CellGrid};
use grainpath_core::{Bounds2, DVec2};

/// Ends of paths in a grid; removing a path removes both its ends.
pub(crate) struct NearestEnds {
    buckets: Buckets,
    /// Ends in the order of the cells, each with its number: `2 i` and `2 i + 1` are the ends of path `i`.
    ends: Vec<(DVec2, u32)>,
    /// For each path, whether it is removed.
    taken: Vec<bool>,
    /// Number of paths in the grid that are removed.
    n_stale: usize,
}

impl NearestEnds {
    /// Builds the grid from both ends of every path.
    pub(crate) fn new(ends: &[[DVec2; 2]]) -> Self {
        let numbered: Vec<(DVec2, u32)> = ends.as_flattened().iter().copied().zip(0..).collect();
        let (buckets, numbered) = sorted(&numbered);
        Self { buckets, ends: numbered, taken: vec![false; ends.len()], n_stale: 0 }
    }

    /// Removes a path.
    pub(crate) fn take(&mut self, path: usize) {
        if std::mem::replace(&mut self.taken[path], true) {
            return;
        }
        self.n_stale += 1;
        // A path has two ends, so this is true once more than half of the paths are removed.
        if 4 * self.n_stale > self.ends.len() {
            let taken = &self.taken;
            self.ends.retain(|(_, end)| !taken[*end as usize / 2]);
            (self.buckets, self.ends) = sorted(&self.ends);
            self.n_stale = 0;
        }
    }

    /// Whether a path is removed.
    pub(crate) fn is_taken(&self, path: usize) -> bool {
        self.taken[path]
    }

    /// Of the paths that are not removed, the one whose end is nearest to `place`, and whether that end is its second one.
    /// Of equally near ends, the one with the lowest number is taken.
    pub(crate) fn nearest(&self, place: DVec2) -> Option<(usize, bool)> {
        let cells = &self.buckets.cells;
        let middle = cells.cell_of(place);
        let mut best = (f64::INFINITY, u32::MAX);
        for ring in 0..cells.n_rings() {
            let reach = cells.ring_distance_mm(ring);
            if best.1 != u32::MAX && reach * reach > best.0 {
                break;
            }
            for cell in cells.ring(middle, ring) {
                for &(end, number) in &self.ends[self.buckets.range(cells.index(cell))] {
                    let d = end.distance_squared(place);
                    if (d < best.0 || (d == best.0 && number < best.1)) && !self.taken[number as usize / 2] {
                        best = (d, number);
                    }
                }
            }
        }
        (best.1 != u32::MAX).then_some((best.1 as usize / 2, best.1 % 2 == 1))
    }
}

/// Sorts ends into a grid; returns the grid, and the ends in the order of its cells.
fn sorted(ends: &[(DVec2, u32)]) -> (Buckets, Vec<(DVec2, u32)>) {
    let bounds = Bounds2::around_points(ends.iter().map(|e| e.0));
    let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
    let size = bounds.size().max(DVec2::splat(1e-3));
    // About two ends a cell.
    let cell_mm = (size.x * size.y / ends.len().max(1) as f64 * 2.0).sqrt();
    let cells = CellGrid::covering(bounds, cell_mm, 1000);
    let buckets = Buckets::new(cells, ends.len(), |i, add| add(cells.index(cells.cell_of(ends[i].0))));
    let in_cells =
        buckets.members_of_run(0, cells.nx * cells.ny - 1).iter().map(|&i| ends[i as usize]).collect();
    (buckets, in_cells)
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
            let mut index = NearestEnds::new(&ends);
            for (path, _) in taken.iter().enumerate().take(ends.len()).filter(|t| *t.1) {
                index.take(path);
                // A second time changes nothing.
                index.take(path);
                prop_assert!(index.is_taken(path));
                let all = ends.iter().flatten().enumerate().filter(|(i, _)| !index.is_taken(i / 2));
                let plain = all.map(|(i, p)| (p.distance_squared(at), i)).min_by(|a, b| a.0.total_cmp(&b.0));
                prop_assert_eq!(index.nearest(at), plain.map(|(_, i)| (i / 2, i % 2 == 1)));
            }
        }
    }
}
