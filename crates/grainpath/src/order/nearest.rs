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

use grainpath_core::{Bounds2, DVec2};

/// Points in a grid; each belongs to an owner, and owners are removed as a whole.
pub struct NearestEnds {
    points: Vec<(DVec2, u32)>,
    starts: Vec<u32>,
    origin: DVec2,
    cell_mm: f64,
    nx: i64,
    ny: i64,
}

impl NearestEnds {
    /// Both ends of every owner: point `2 i` and `2 i + 1` belong to owner `i`.
    pub fn new(ends: &[[DVec2; 2]]) -> Self {
        let all = || ends.iter().flatten().copied();
        let bounds = Bounds2::of(all()).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let size = bounds.size().max(DVec2::splat(1e-3));
        let n = (2 * ends.len()).max(1) as f64;
        // At most 1000 cells along the longer side: ends on one line would otherwise make a long
        // grid of empty cells.
        let cell_mm = (size.x * size.y / n * 2.0).sqrt().max(size.max_element() / 1000.0);
        let (nx, ny) = ((size.x / cell_mm) as i64 + 1, (size.y / cell_mm) as i64 + 1);
        let cell = |p: DVec2| {
            let c = (p - bounds.min) / cell_mm;
            (c.y as i64).clamp(0, ny - 1) * nx + (c.x as i64).clamp(0, nx - 1)
        };
        let mut starts = vec![0u32; (nx * ny) as usize + 1];
        for p in all() {
            starts[cell(p) as usize] += 1;
        }
        let mut total = 0;
        for s in &mut starts {
            total += std::mem::replace(s, total);
        }
        let mut next = starts.clone();
        let mut points = vec![(DVec2::ZERO, 0); 2 * ends.len()];
        for (i, p) in all().enumerate() {
            let slot = &mut next[cell(p) as usize];
            points[*slot as usize] = (p, i as u32);
            *slot += 1;
        }
        Self { points, starts, origin: bounds.min, cell_mm, nx, ny }
    }

    /// The end nearest to `at` whose owner is not taken, and whether it is the owner's second end.
    /// Among equally near ends the one with the lowest number.
    pub fn nearest(&self, at: DVec2, taken: &[bool]) -> Option<(usize, bool)> {
        let c = (at - self.origin) / self.cell_mm;
        let (cx, cy) =
            ((c.x.floor() as i64).clamp(0, self.nx - 1), (c.y.floor() as i64).clamp(0, self.ny - 1));
        let mut best = (f64::INFINITY, u32::MAX);
        for ring in 0..self.nx.max(self.ny) {
            // Every end in this ring and beyond is at least this far away.
            let reach = (ring - 1) as f64 * self.cell_mm;
            if best.1 != u32::MAX && reach > 0.0 && reach * reach > best.0 {
                break;
            }
            for y in (cy - ring).max(0)..=(cy + ring).min(self.ny - 1) {
                // Inner rows of a ring have only their first and last cell in it.
                let rim = y == cy - ring || y == cy + ring;
                let step = if rim { 1 } else { (2 * ring).max(1) };
                let mut x = cx - ring;
                while x <= cx + ring {
                    if (0..self.nx).contains(&x) {
                        self.search(y * self.nx + x, at, taken, &mut best);
                    }
                    x += step;
                }
            }
        }
        (best.1 != u32::MAX).then_some((best.1 as usize / 2, best.1 % 2 == 1))
    }

    fn search(&self, cell: i64, at: DVec2, taken: &[bool], best: &mut (f64, u32)) {
        let range = self.starts[cell as usize] as usize..self.starts[cell as usize + 1] as usize;
        for &(p, i) in &self.points[range] {
            if !taken[i as usize / 2] {
                let d = p.distance_squared(at);
                if d < best.0 || (d == best.0 && i < best.1) {
                    *best = (d, i);
                }
            }
        }
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
