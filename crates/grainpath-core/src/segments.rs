//! Straight pieces of lines, searchable by place.
//!
//! Method: a grid of cells over the box around all pieces; each cell lists the pieces that pass it. Cost: building is linear
//! in the cells passed, a search in the pieces of the cells around the place.

use crate::buckets::{Buckets, CellGrid};
use crate::segment::{Meeting, closest_share, meeting};
use crate::{Bounds2, DVec2, Toolpath};

/// Largest number of cells along a side of the grid. Source: derived; a cell takes 4 bytes, so all take 16 MB.
const MAX_CELLS_PER_SIDE: usize = 2000;

/// Pieces, each by its two ends.
///
/// ```
/// use grainpath_core::{DVec2, segments::Segments};
///
/// let pieces = Segments::new(vec![[DVec2::ZERO, DVec2::X], [DVec2::Y, DVec2::ONE]], 1.0);
/// let (piece, share) = pieces.within(DVec2::new(0.25, 0.9), 0.2).next().unwrap();
/// assert_eq!((piece, share), (1, 0.25));
/// assert!(pieces.meets(DVec2::new(0.5, 0.5), DVec2::new(0.5, 2.0), |piece| piece == 1));
/// ```
#[derive(Debug, Clone)]
pub struct Segments {
    all: Vec<[DVec2; 2]>,
    near: Buckets,
}

impl Segments {
    /// Prepares a search among `all` with cells of `cell_mm`.
    pub fn new(all: Vec<[DVec2; 2]>, cell_mm: f64) -> Self {
        let bounds = Bounds2::around_points(all.iter().flatten().copied());
        let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let cells = CellGrid::covering(bounds, cell_mm, MAX_CELLS_PER_SIDE);
        let near = Buckets::of_segments(cells, all.len(), |i| all[i]);
        Self { all, near }
    }

    /// Prepares a search among the segments of paths, in their order, with cells of `cell_mm`.
    pub fn of_paths<'a>(paths: impl Iterator<Item = &'a Toolpath>, cell_mm: f64) -> Self {
        let of_path = |path: &'a Toolpath| (0..path.n_segments()).map(|i| path.segment(i));
        Self::new(paths.flat_map(of_path).map(|(a, b, _)| [a, b]).collect(), cell_mm)
    }

    /// The ends of a piece.
    pub fn ends(&self, i: usize) -> [DVec2; 2] {
        self.all[i]
    }

    /// Whether one of the pieces that `counts` names crosses or touches the way from `a` to `b`.
    pub fn meets(&self, a: DVec2, b: DVec2, counts: impl Fn(usize) -> bool) -> bool {
        let mut met = false;
        self.near.cells.for_each_passed(a, b, |cell| {
            met |= self
                .near
                .members(cell)
                .iter()
                .any(|&i| counts(i as usize) && meeting([a, b], self.all[i as usize]) != Meeting::Apart);
        });
        met
    }

    /// Pairs of pieces that cross or touch, the lower number first.
    pub fn meetings(&self) -> Vec<[usize; 2]> {
        self.near.pairs(|i, j| meeting(self.all[i], self.all[j]) != Meeting::Apart)
    }

    /// The pieces within `distance_mm` of `place`, each with the share of its length at which its nearest point lies. A piece
    /// in several cells comes several times.
    pub fn within(&self, place: DVec2, distance_mm: f64) -> impl Iterator<Item = (usize, f64)> {
        let cells = &self.near.cells;
        let found = cells.block(cells.cell_of(place - distance_mm), cells.cell_of(place + distance_mm));
        found.flat_map(move |cell| self.near.members(cells.index(cell))).filter_map(move |&i| {
            // A cell holds pieces that pass it anywhere, so each is measured.
            let [a, b] = self.all[i as usize];
            let share = closest_share(place, a, b);
            let near = a.lerp(b, share).distance_squared(place) <= distance_mm * distance_mm;
            near.then_some((i as usize, share))
        })
    }
}
