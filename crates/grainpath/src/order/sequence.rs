//! Finds sequences of paths with short travels between them.
//!
//! Method: nearest neighbour, then 2-opt (reverse a run of stops) and Or-opt (move up to three stops)
//! until nothing improves (`Croes1958`, `Or1976`). Tours of up to [`MAX_SHAKEN`] stops are then
//! perturbed by exchanging neighbouring runs and improved again, and the shorter tour is kept
//! (iterated local search, `Lourenco2003`). A stop is a path that may be entered at either end.
//! Stops whose neighbours did not change are not examined again.
//!
//! The result is deterministic: of equal choices the lower number is taken, and the exchanges come
//! from a fixed sequence. A test compares tours of up to 6 stops with all orders. Cost: one search
//! for the nearest end for each stop, then [`REACH`] neighbours for every stop and pass.

use grainpath_core::poly::signed_area_mm2;
use grainpath_core::{Bounds2, DVec2, Toolpath};

use super::WallOrder;
use super::nearest::NearestEnds;
use super::seam::Seams;
use super::starts::{Starts, start_nearest};
use crate::wall::Wall;

/// Largest distance, in stops, over which 2-opt searches for an exchange and Or-opt moves a run.
const REACH: usize = 100;
/// Largest number of passes of 2-opt and Or-opt.
const PASSES: usize = 8;
/// Largest number of stops of a tour that is perturbed. The number of perturbations is the number of stops.
const MAX_SHAKEN: usize = 64;

/// Finds a short tour that visits every stop once, entering at one of its ends and leaving at the other.
/// `at` is the start of the tour, and `to` the point after it, if known. Returns the indices of the
/// stops in order, each with whether it is entered at its second end.
///
/// The module documentation describes the method.
pub(super) fn tour(ends: &[[DVec2; 2]], at: DVec2, to: Option<DVec2>) -> Vec<(usize, bool)> {
    let mut index = NearestEnds::new(ends);
    let mut order: Vec<Stop> = Vec::with_capacity(ends.len());
    while let Some((path, second)) = index.nearest(order.last().map_or(at, |s| s.leave)) {
        index.take(path);
        let [enter, leave] = if second { [ends[path][1], ends[path][0]] } else { ends[path] };
        order.push(Stop { path, second, enter, leave });
    }
    let mut tour = Tour { at, to, gaps_mm: vec![0.0; order.len() + 1], order, look: vec![true; ends.len()] };
    tour.measure_gaps(0, ends.len());
    tour.improve();
    // Fewer than four stops hardly contain two runs to exchange.
    if (4..=MAX_SHAKEN).contains(&ends.len()) {
        tour.shake();
    }
    tour.order.into_iter().map(|s| (s.path, s.second)).collect()
}

/// A path in the tour.
#[derive(Clone, Copy)]
struct Stop {
    path: usize,
    /// Whether the path is entered at its second end.
    second: bool,
    enter: DVec2,
    leave: DVec2,
}

/// A tour that is being improved. Gap `k` is the travel before stop `k`; the last gap leads to `to`.
struct Tour {
    at: DVec2,
    to: Option<DVec2>,
    order: Vec<Stop>,
    /// Length of each gap.
    gaps_mm: Vec<f64>,
    /// For each path, whether the tour next to it has changed since it was last examined without success.
    look: Vec<bool>,
}

impl Tour {
    /// Start of gap `k`.
    fn before(&self, k: usize) -> DVec2 {
        if k == 0 { self.at } else { self.order[k - 1].leave }
    }

    /// End of gap `k`; `None` after the last stop if the next point is unknown.
    fn after(&self, k: usize) -> Option<DVec2> {
        self.order.get(k).map_or(self.to, |s| Some(s.enter))
    }

    /// Measures gaps `a` to `b` again, both included, after the stops between them were moved.
    fn measure_gaps(&mut self, a: usize, b: usize) {
        for k in a..=b {
            self.gaps_mm[k] = way_mm(self.before(k), self.after(k));
        }
    }

    fn length_mm(&self) -> f64 {
        self.gaps_mm.iter().sum()
    }

    fn improve(&mut self) {
        for _ in 0..PASSES {
            let turned = self.turn_stretches();
            let moved = self.move_stretches();
            if !turned && !moved {
                break;
            }
        }
    }

    /// Whether the tour next to a stop has changed since the stop was last examined.
    fn is_marked(&self, stop: usize) -> bool {
        self.order.get(stop).is_some_and(|o| self.look[o.path])
    }

    /// Marks the stops on both sides of gap `k` to be examined again.
    fn changed(&mut self, k: usize) {
        for stop in [k.checked_sub(1), Some(k)].into_iter().flatten() {
            if let Some(o) = self.order.get(stop) {
                self.look[o.path] = true;
            }
        }
    }

    fn turn(&mut self, a: usize, b: usize) {
        self.order[a..b].reverse();
        for stop in &mut self.order[a..b] {
            stop.second = !stop.second;
            std::mem::swap(&mut stop.enter, &mut stop.leave);
        }
    }

    /// Reverses runs of stops if that shortens the tour (2-opt). Returns whether any was reversed.
    fn turn_stretches(&mut self) -> bool {
        let n = self.order.len();
        let mut improved = false;
        for k in 0..=n {
            if !(self.is_marked(k) || k > 0 && self.is_marked(k - 1)) {
                continue;
            }
            let way = self.gaps_mm[k];
            // A gap of zero length cannot become shorter; most gaps of a zigzag are of this kind.
            if way < 1e-6 {
                continue;
            }
            for other in k.saturating_sub(REACH)..=(k + REACH).min(n) {
                if other == k {
                    continue;
                }
                let (a, b) = (k.min(other), k.max(other));
                let old = way + self.gaps_mm[other];
                let (before, last) = (self.before(a), self.order[b - 1].leave);
                if is_longer(before, last, old) {
                    continue;
                }
                let new = before.distance(last) + way_mm(self.order[a].enter, self.after(b));
                // A gain below a nanometre is rounding, and accepting it could repeat for ever.
                if new < old - 1e-6 {
                    self.turn(a, b);
                    self.measure_gaps(a, b);
                    self.changed(a);
                    self.changed(b);
                    improved = true;
                    break;
                }
            }
        }
        improved
    }

    /// Moves runs of up to three stops to another place if that shortens the tour (Or-opt). Returns
    /// whether any was moved. Stops examined without success are skipped until the tour changes next
    /// to them.
    fn move_stretches(&mut self) -> bool {
        let n = self.order.len();
        let looked = self.look.clone();
        self.look.fill(false);
        let mut improved = false;
        for length in 1..=3.min(n.saturating_sub(1)) {
            for a in 0..=n - length {
                let b = a + length;
                // A stretch is tried again only after the way to one of its paths has changed.
                if !self.order[a..b].iter().any(|o| looked[o.path] || self.look[o.path]) {
                    continue;
                }
                let (first, last) = (self.order[a].enter, self.order[b - 1].leave);
                // Taken out, the stretch saves the travels to it and from it and costs the one that closes the gap.
                let saved = self.gaps_mm[a] + self.gaps_mm[b] - way_mm(self.before(a), self.after(b));
                if saved < 1e-6 {
                    continue;
                }
                let mut best = (saved - 1e-6, usize::MAX, false);
                for k in a.saturating_sub(REACH)..=(b + REACH).min(n) {
                    if (a..=b).contains(&k) {
                        continue;
                    }
                    let (before, after) = (self.before(k), self.after(k));
                    let gap = self.gaps_mm[k];
                    for (turned, from, to) in [(false, first, last), (true, last, first)] {
                        // The first travel alone may cost more than the best place so far.
                        if is_longer(before, from, best.0 + gap) {
                            continue;
                        }
                        let cost = before.distance(from) + way_mm(to, after) - gap;
                        if cost < best.0 {
                            best = (cost, k, turned);
                        }
                    }
                }
                let (_, k, turned) = best;
                if k == usize::MAX {
                    continue;
                }
                if turned {
                    self.turn(a, b);
                }
                let seams = if k < a {
                    self.order[k..b].rotate_right(length);
                    [k, k + length, b]
                } else {
                    self.order[a..k].rotate_left(length);
                    [a, k - length, k]
                };
                self.measure_gaps(seams[0], seams[2]);
                seams.into_iter().for_each(|seam| self.changed(seam));
                improved = true;
            }
        }
        improved
    }

    /// Repeatedly exchanges two neighbouring runs of stops, improves the tour, and keeps it if it is
    /// shorter. The ends of the runs come from a fixed pseudorandom sequence.
    fn shake(&mut self) {
        let n = self.order.len();
        let mut state = n as u64;
        let mut below = |m: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % m as u64) as usize
        };
        let mut best = (self.length_mm(), self.order.clone());
        for _ in 0..n {
            let mut cuts = [0; 3].map(|_| below(n + 1));
            cuts.sort_unstable();
            let [a, b, c] = cuts;
            if a == b || b == c {
                continue;
            }
            // This exchange is the double bridge of iterated local search: neither 2-opt nor Or-opt
            // can undo it in one step.
            self.order[a..c].rotate_left(b - a);
            self.look.fill(false);
            self.measure_gaps(a, c);
            [a, a + c - b, c].into_iter().for_each(|seam| self.changed(seam));
            self.improve();
            let length = self.length_mm();
            if length < best.0 - 1e-6 {
                best = (length, self.order.clone());
            } else {
                self.order.copy_from_slice(&best.1);
                self.measure_gaps(0, n);
            }
        }
    }
}

/// Whether two points lie farther apart than `length_mm`, by more than rounding. It takes no square root, and most exchanges
/// fail by their first travel alone.
fn is_longer(a: DVec2, b: DVec2, length_mm: f64) -> bool {
    a.distance_squared(b) > length_mm * length_mm * (1.0 + 1e-9)
}

/// Length of a travel, mm; 0 if its end is unknown.
fn way_mm(from: DVec2, to: Option<DVec2>) -> f64 {
    to.map_or(0.0, |to| from.distance(to))
}

/// The walls along one contour, with the bounding box of the outermost wall.
struct WallGroup {
    bounds: Bounds2,
    is_hole: bool,
    walls: Vec<Wall>,
}

/// Puts walls in order: contour by contour, each from the inside out or from the outside in.
pub(super) fn walls(
    walls: Vec<Wall>,
    order: WallOrder,
    seams: &mut Seams,
    at: &mut DVec2,
    out: &mut Vec<Toolpath>,
) {
    let mut rings: Vec<WallGroup> = Vec::new();
    for wall in walls {
        let is_hole = signed_area_mm2(&wall.path.points) < 0.0;
        let Some(bounds) = Bounds2::around_points(wall.path.points.iter().copied()) else { continue };
        let offset = |r: &WallGroup| r.bounds.centre().distance_squared(bounds.centre());
        let home = rings
            // An outermost wall starts a group. An inner wall joins the group of the same orientation
            // whose centre is nearest.
            .iter_mut()
            .filter(|r| wall.depth > 0 && r.is_hole == is_hole)
            .min_by(|a, b| offset(a).total_cmp(&offset(b)));
        match home {
            Some(ring) => ring.walls.push(wall),
            None => rings.push(WallGroup { bounds, is_hole, walls: vec![wall] }),
        }
    }
    let places: Vec<[DVec2; 2]> = rings.iter().map(|r| [r.walls[0].path.start(); 2]).collect();
    let mut rings: Vec<Option<WallGroup>> = rings.into_iter().map(Some).collect();
    for (i, _) in tour(&places, *at, None) {
        let Some(mut ring) = rings[i].take() else { continue };
        ring.walls.sort_by_key(|w| w.depth);
        if order == WallOrder::InnerFirst {
            ring.walls.reverse();
        }
        for mut wall in ring.walls {
            if wall.depth == 0 {
                seams.place(&mut wall.path, *at);
            } else {
                start_nearest(&mut wall.path, *at);
            }
            *at = wall.path.end();
            out.push(wall.path);
        }
    }
}

/// Puts single beads and fill in order: by rank, and within a rank by short travels. `to` is the point
/// after the last path, if known.
pub(super) fn fills(
    mut fills: Vec<Toolpath>,
    starts: &mut Starts,
    at: &mut DVec2,
    to: Option<DVec2>,
    out: &mut Vec<Toolpath>,
) {
    fills.sort_by_key(|p| p.rank);
    while let Some(rank) = fills.first().map(|p| p.rank) {
        let later = fills.split_off(fills.partition_point(|p| p.rank == rank));
        let ends: Vec<[DVec2; 2]> = fills.iter().map(|p| [p.start(), p.end()]).collect();
        let mut stops: Vec<Option<Toolpath>> = fills.into_iter().map(Some).collect();
        // `to` follows only the last rank; the other ranks are followed by the next rank.
        for (i, second) in tour(&ends, *at, to.filter(|_| later.is_empty())) {
            let Some(mut path) = stops[i].take() else { continue };
            if path.closed {
                starts.place(&mut path, *at);
            } else if second {
                path.reverse();
            }
            *at = path.end();
            out.push(path);
        }
        fills = later;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length_mm(ends: &[[DVec2; 2]], order: &[(usize, bool)], at: DVec2) -> f64 {
        let mut from = at;
        let mut sum = 0.0;
        for &(i, second) in order {
            sum += from.distance(ends[i][usize::from(second)]);
            from = ends[i][usize::from(!second)];
        }
        sum
    }

    /// The shortest of all orders and directions.
    fn shortest_mm(ends: &[[DVec2; 2]], left: &mut Vec<usize>, from: DVec2) -> f64 {
        let mut best = if left.is_empty() { 0.0 } else { f64::INFINITY };
        for k in 0..left.len() {
            let i = left.swap_remove(k);
            for second in [false, true] {
                let way = from.distance(ends[i][usize::from(second)]);
                best = best.min(way + shortest_mm(ends, left, ends[i][usize::from(!second)]));
            }
            left.push(i);
            let last = left.len() - 1;
            left.swap(k, last);
        }
        best
    }

    #[test]
    fn tours_visit_each_once_and_are_near_the_shortest() {
        let mut state = 1_u64;
        let mut coordinate = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 * 1e-5
        };
        let (mut sum, mut least) = (0.0, 0.0);
        for n in (1..7).cycle().take(300) {
            let ends: Vec<[DVec2; 2]> =
                (0..n).map(|_| [(); 2].map(|()| DVec2::new(coordinate(), coordinate()))).collect();
            let order = tour(&ends, DVec2::ZERO, None);
            let mut visited: Vec<usize> = order.iter().map(|o| o.0).collect();
            visited.sort_unstable();
            assert_eq!(visited, (0..n).collect::<Vec<_>>());
            sum += length_mm(&ends, &order, DVec2::ZERO);
            least += shortest_mm(&ends, &mut visited, DVec2::ZERO);
        }
        assert!(sum < 1.01 * least, "{sum} mm where {least} mm would do");
    }

    #[test]
    fn a_tour_ends_where_the_way_goes_on() {
        let ends: Vec<[DVec2; 2]> = (0..9).map(|k| [DVec2::new(f64::from(k) - 4.0, 1.0); 2]).collect();
        let last = |to| ends[tour(&ends, DVec2::ZERO, Some(DVec2::new(to, 1.0)))[8].0][0].x;
        assert_eq!((last(-50.0), last(50.0)), (-4.0, 4.0));
    }
}
