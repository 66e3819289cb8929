//! Makes one path of a whole island by joining loops to their neighbours.
//!
//! Two neighbouring loops become one: a piece of each loop, as long as the gap between them, is
//! replaced by two links across the gap. The total length of the beads stays the same, and no place
//! is printed twice:
//!
//! ```text
//!     ====== loop 1 ======            ====+  +====
//!                              ->         |  |
//!     ====== loop 2 ======            ====+  +====
//! ```
//!
//! A loop is joined where it comes nearest to the chain. Paths farther away than a given reach
//! begin a chain of their own. The next layer begins where this one ends, so that a part with one
//! island is a single path without a travel. Lengths are in mm. Cost: the points of the chain are
//! sorted into square cells as wide as the reach, so a loop is compared with few of them.

use grainpath_core::buckets::PointGrid2;
use grainpath_core::{BeadWidth, Bounds2, DVec2, Toolpath, segment};

/// Paths that follow each other without a travel between them.
struct Chain {
    pieces: Vec<Toolpath>,
    closed: bool,
}

/// A point on a path: index of the path, length along it, coordinates.
#[derive(Clone, Copy)]
struct Place {
    piece: usize,
    along_mm: f64,
    at: DVec2,
}

/// Joins paths into chains and orders the chains; each chain begins as near as possible to the end of
/// the previous one. `reach_mm` is the largest distance between paths that are joined. `at` holds the
/// nozzle's position before the call and is set to the position after it.
pub(super) fn chained(paths: Vec<Toolpath>, reach_mm: f64, at: &mut DVec2, out: &mut Vec<Toolpath>) {
    let mut rest: Vec<Toolpath> = paths.into_iter().filter(|p| p.n_segments() > 0).collect();
    let mut chains = Vec::new();
    while !rest.is_empty() {
        // A chain starts from the longest path, because it has the most places where others can join it.
        let length = |p: &Toolpath| p.length_mm();
        let longest = (0..rest.len())
            // Of equally long paths the first one wins; `max_by` alone would take the last.
            .max_by(|&i, &j| length(&rest[i]).total_cmp(&length(&rest[j])).then(j.cmp(&i)))
            .unwrap_or(0);
        let root = rest.remove(longest);
        let mut chain = Chain { closed: root.closed, pieces: vec![root.opened()] };
        chain.take_in(&mut rest, reach_mm);
        chains.push(Some(chain));
    }
    for _ in 0..chains.len() {
        let near = |c: &Option<Chain>| c.as_ref().map_or(f64::INFINITY, |c| c.nearest(*at).1);
        let next = (0..chains.len())
            .min_by(|&i, &j| near(&chains[i]).total_cmp(&near(&chains[j])))
            .and_then(|i| chains[i].take());
        let Some(mut chain) = next else { return };
        chain.begin_near(*at);
        // If the gap to the previous chain is within reach, a bead bridges it.
        let start = chain.pieces[0].start();
        if let Some(last) = out.last_mut()
            && last.role == chain.pieces[0].role
            && (1e-6..reach_mm).contains(&at.distance(start))
            && last.end() == *at
        {
            push(last, start);
        }
        *at = chain.pieces.last().map_or(*at, Toolpath::end);
        out.append(&mut chain.pieces);
    }
}

fn push(path: &mut Toolpath, p: DVec2) {
    path.points.push(p);
    if let BeadWidth::PerVertex(w) = &mut path.width
        && let Some(&last) = w.last()
    {
        w.push(last);
    }
}

/// Points along an open path, at most `step_mm` apart.
fn places(path: &Toolpath, piece: usize, step_mm: f64) -> Vec<Place> {
    let mut out = Vec::new();
    let mut done = 0.0;
    for i in 0..path.n_segments() {
        let (a, b, _) = path.segment(i);
        let l = a.distance(b);
        let n = (l / step_mm).ceil().max(1.0);
        for k in 0..n as usize {
            let t = k as f64 / n;
            out.push(Place { piece, along_mm: done + t * l, at: a.lerp(b, t) });
        }
        done += l;
    }
    if let Some(&at) = path.points.last() {
        out.push(Place { piece, along_mm: done, at });
    }
    out
}

/// Places along the pieces of a chain, which can be found by their position.
struct Places {
    all: Vec<Place>,
    /// The numbers of the places.
    grid: PointGrid2<usize>,
}

impl Places {
    fn new(pieces: &[Toolpath], reach_mm: f64) -> Self {
        // Four places to a reach: the gap found is longer than the least one by an eighth of the reach at most, on
        // either path.
        let of = |(k, piece)| places(piece, k, 0.25 * reach_mm);
        let all: Vec<Place> = pieces.iter().enumerate().flat_map(of).collect();
        let bounds = Bounds2::around_points(all.iter().map(|place| place.at));
        let mut grid =
            PointGrid2::new(bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO }), reach_mm);
        all.iter().enumerate().for_each(|(k, place)| grid.insert(place.at, k));
        Self { all, grid }
    }
}

impl Chain {
    /// Joins closed paths within reach to the chain, the nearest first, until none is left within reach.
    fn take_in(&mut self, rest: &mut Vec<Toolpath>, reach_mm: f64) {
        loop {
            // The places are sorted again after every join, because lengths along the cut path change.
            let own = Places::new(&self.pieces, reach_mm);
            let found = (0..rest.len()).filter_map(|i| Some((i, self.join(&own, &rest[i], reach_mm)?)));
            let nearest = found.min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.0.cmp(&b.0)));
            let Some((i, (gap_mm, here, there_mm))) = nearest else { return };
            self.graft(here, rest.remove(i).opened(), there_mm, gap_mm);
        }
    }

    /// Finds the place where a loop comes nearest to the chain and both are long enough to be joined.
    /// Returns the distance, the point on the chain, and the length along the loop.
    fn join(&self, own: &Places, path: &Toolpath, reach_mm: f64) -> Option<(f64, Place, f64)> {
        if !path.closed {
            return None;
        }
        let open = path.clone().opened();
        let length = open.length_mm();
        let lengths: Vec<f64> = self.pieces.iter().map(Toolpath::length_mm).collect();
        let mut best: Option<(f64, Place, f64)> = None;
        for there in places(&open, 0, 0.25 * reach_mm) {
            for (_, k) in own.grid.within(there.at, reach_mm) {
                let here = own.all[k];
                // A piece as long as the gap is removed from each path. The piece must lie between the ends
                // of its path.
                let d = here.at.distance(there.at);
                let fits = |along: f64, all: f64| along > d && along + d < all;
                if d > 1e-6
                    && best.as_ref().is_none_or(|b| d < b.0 - 1e-9)
                    && fits(here.along_mm, lengths[here.piece])
                    && fits(there.along_mm, length)
                {
                    best = Some((d, here, there.along_mm));
                }
            }
        }
        best
    }

    /// Joins a loop to the chain.
    fn graft(&mut self, here: Place, path: Toolpath, there_mm: f64, gap_mm: f64) {
        let piece = self.pieces.remove(here.piece);
        let (whole, around) = (piece.length_mm(), path.length_mm());
        let before = piece.part(0.0, here.along_mm - 0.5 * gap_mm);
        let after = piece.part(here.along_mm + 0.5 * gap_mm, whole);
        // The loop without the removed piece.
        let mut taken = path.part(there_mm + 0.5 * gap_mm, around);
        let rest = path.part(0.0, there_mm - 0.5 * gap_mm);
        taken.points.extend(rest.points.iter().skip(1));
        if let (BeadWidth::PerVertex(w), BeadWidth::PerVertex(v)) = (&mut taken.width, &rest.width) {
            w.extend(v.iter().skip(1));
        }
        let (from, to) = (before.end(), after.start());
        // The loop is taken in the direction with the shorter links, because those do not cross.
        let straight = from.distance(taken.start()) + to.distance(taken.end());
        if from.distance(taken.end()) + to.distance(taken.start()) < straight {
            taken.reverse();
        }
        taken.points.insert(0, from);
        taken.points.push(to);
        if let BeadWidth::PerVertex(w) = &mut taken.width {
            let (first, last) = (w[0], w[w.len() - 1]);
            w.insert(0, first);
            w.push(last);
        }
        self.pieces.splice(here.piece..here.piece, [before, taken, after]);
    }

    /// The nearest point to `at` where the chain can begin, and its distance. An open chain can begin only at its ends.
    fn nearest(&self, at: DVec2) -> (Place, f64) {
        let last = self.pieces.len() - 1;
        let ends = [
            Place { piece: 0, along_mm: 0.0, at: self.pieces[0].start() },
            Place { piece: last, along_mm: f64::INFINITY, at: self.pieces[last].end() },
        ];
        let mut best = if ends[1].at.distance(at) < ends[0].at.distance(at) { ends[1] } else { ends[0] };
        if !self.closed {
            return (best, best.at.distance(at));
        }
        for (k, piece) in self.pieces.iter().enumerate() {
            let mut done = 0.0;
            for i in 0..piece.n_segments() {
                let (a, b, _) = piece.segment(i);
                let l = a.distance(b);
                let t = segment::closest_share(at, a, b);
                let p = a.lerp(b, t);
                if p.distance(at) < best.at.distance(at) - 1e-9 {
                    best = Place { piece: k, along_mm: done + t * l, at: p };
                }
                done += l;
            }
        }
        (best, best.at.distance(at))
    }

    /// Lets the chain begin as near as possible to `at`.
    fn begin_near(&mut self, at: DVec2) {
        let (place, _) = self.nearest(at);
        if place.piece > 0 && place.along_mm.is_infinite() {
            self.turn_round();
            return;
        }
        if !self.closed {
            if place.along_mm > 0.0 {
                self.turn_round();
            }
            return;
        }
        // A closed chain can begin anywhere: it is cut at the nearest point, and the part before
        // the cut moves to its end.
        let piece = &self.pieces[place.piece];
        let whole = piece.length_mm();
        let (first, second) = if place.along_mm < 1e-6 {
            (None, Some(piece.clone()))
        } else if place.along_mm > whole - 1e-6 {
            (Some(piece.clone()), None)
        } else {
            (Some(piece.part(0.0, place.along_mm)), Some(piece.part(place.along_mm, whole)))
        };
        let after = self.pieces.split_off(place.piece + 1);
        self.pieces.pop();
        let before = std::mem::take(&mut self.pieces);
        self.pieces = second.into_iter().chain(after).chain(before).chain(first).collect();
    }

    fn turn_round(&mut self) {
        self.pieces.reverse();
        self.pieces.iter_mut().for_each(Toolpath::reverse);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::Role;
    use grainpath_core::math::direction;

    fn ring(r: f64, role: Role) -> Toolpath {
        let point = |k: i32| direction(f64::from(k) / 90.0 * std::f64::consts::TAU) * r;
        Toolpath::new((0..90).map(point).collect(), 0.4, role, true)
    }

    fn check(out: &[Toolpath]) -> usize {
        out.windows(2).filter(|w| w[0].end().distance(w[1].start()) > 1e-9).count()
    }

    #[test]
    fn rings_become_one_chain_that_lays_as_much_and_ends_where_it_begins() {
        let rings: Vec<Toolpath> = (0..6)
            .map(|k| ring(10.0 - 0.4 * f64::from(k), if k == 0 { Role::OuterWall } else { Role::SolidFill }))
            .collect();
        let length: f64 = rings.iter().map(Toolpath::length_mm).sum();
        let mut at = DVec2::new(30.0, 1.0);
        let mut out = Vec::new();
        chained(rings.clone(), 0.8, &mut at, &mut out);
        assert_eq!(check(&out), 0);
        assert!(out[0].start().distance(out[out.len() - 1].end()) < 1e-9, "closed");
        assert_eq!(at, out[out.len() - 1].end());
        let found: f64 = out.iter().map(Toolpath::length_mm).sum();
        assert!((found / length - 1.0).abs() < 0.01, "{found} {length}");
        assert!(
            out.iter().any(|p| p.role == Role::OuterWall) && out.iter().any(|p| p.role == Role::SolidFill)
        );
        // The next layer begins where this one ended.
        let before = at;
        let mut next = Vec::new();
        chained(rings, 0.8, &mut at, &mut next);
        assert!(next[0].start().distance(before) < 1e-6 && check(&next) == 0);
    }

    #[test]
    fn what_is_out_of_reach_is_a_chain_of_its_own() {
        let far =
            Toolpath::new(vec![DVec2::new(20.0, 0.0), DVec2::new(30.0, 0.0)], 0.4, Role::GapFill, false);
        let mut out = Vec::new();
        let mut at = DVec2::new(31.0, 0.0);
        chained(vec![ring(5.0, Role::SolidFill), far], 0.8, &mut at, &mut out);
        assert_eq!(check(&out), 1);
        assert_eq!(out[0].start(), DVec2::new(30.0, 0.0));
    }

    #[test]
    fn of_several_islands_the_one_stood_in_comes_first() {
        use crate::order::{CombSettings, Island, LayerPaths, OrderSettings, Seam, WallOrder};
        use grainpath_core::{Polygon, Region};
        let square = |x: f64, half: f64| {
            let middle = DVec2::new(x, 0.0);
            Region::rectangle(middle - half, middle + half).polygons.remove(0)
        };
        // The middle of the small one is nearer to where the large one ends than its own is.
        let outlines: Vec<Polygon> = vec![square(0.0, 20.0), square(26.0, 2.0)];
        let island = |p: &Polygon| Island {
            walls: Vec::new(),
            fills: vec![Toolpath::new(p.outer.clone(), 0.4, Role::SolidFill, true)],
        };
        let comb = CombSettings { comb: true, retract_min_mm: 2.0, max_detour: 3.0, clearance_mm: 0.4 };
        let settings = OrderSettings {
            starts_apart_mm: 0.0,
            wall_order: WallOrder::InnerFirst,
            seam: Seam::Nearest,
            comb,
            fibre_last: false,
            chain_mm: Some(0.8),
        };
        let mut at = DVec2::new(30.0, 30.0);
        for layer in 0..5 {
            let paths =
                LayerPaths { islands: outlines.iter().map(island).collect(), ..LayerPaths::default() };
            let from = at;
            let mut seams = crate::order::seam::Seams::new(Seam::Nearest);
            let mut starts = crate::order::starts::Starts::default();
            let laid =
                crate::order::order_layer(paths, &outlines, &settings, (&mut seams, &mut starts), &mut at);
            let first = laid[0].paths[0].start();
            assert!(layer == 0 || first.distance(from) < 1e-9, "{layer}: {first} from {from}");
            assert_eq!(laid.len(), 2);
        }
    }

    #[test]
    fn an_open_path_is_walked_back_in_the_next_layer() {
        let line = || Toolpath {
            width: BeadWidth::PerVertex(vec![0.4, 0.5, 0.4]),
            ..Toolpath::new(
                vec![DVec2::ZERO, DVec2::new(5.0, 0.0), DVec2::new(9.0, 3.0)],
                0.4,
                Role::SolidFill,
                false,
            )
        };
        let mut at = DVec2::ZERO;
        let (mut a, mut b) = (Vec::new(), Vec::new());
        chained(vec![line(), ring(60.0, Role::OuterWall)], 0.8, &mut at, &mut a);
        at = DVec2::new(9.0, 3.0);
        chained(vec![line()], 0.8, &mut at, &mut b);
        assert_eq!((b[0].start(), b[0].end()), (DVec2::new(9.0, 3.0), DVec2::ZERO));
    }
}
