//! Sequences of paths with short ways between them.

use grainpath_core::poly::signed_area_mm2;
use grainpath_core::{Bounds2, DVec2, Toolpath};

use super::WallOrder;
use super::nearest::NearestEnds;
use super::seam::Seams;
use crate::walls::Wall;

/// How far ahead 2-opt looks for an exchange.
const WINDOW: usize = 200;
/// How far a stretch is moved.
const REACH: usize = 100;
/// Passes of 2-opt and Or-opt at the most.
const PASSES: usize = 8;

/// Visits every owner once, entering at one of its ends and leaving at the other: nearest next, then improved by
/// turning round stretches (2-opt) and moving them (Or-opt). Gives owners and whether each is entered at its second end.
pub fn tour(ends: &[[DVec2; 2]], at: DVec2) -> Vec<(usize, bool)> {
    let mut taken = vec![false; ends.len()];
    let index = NearestEnds::new(ends);
    let mut order: Vec<(usize, bool)> = Vec::with_capacity(ends.len());
    let mut from = at;
    while let Some((i, second)) = index.nearest(from, &taken) {
        taken[i] = true;
        order.push((i, second));
        from = ends[i][usize::from(!second)];
    }
    for _ in 0..PASSES {
        let turned = turn_stretches(&mut order, ends, at);
        let moved = move_stretches(&mut order, ends, at);
        if !turned && !moved {
            break;
        }
    }
    order
}

/// Where an owner is entered, and where it is left.
fn enter(ends: &[[DVec2; 2]], (i, second): (usize, bool)) -> DVec2 {
    ends[i][usize::from(second)]
}

fn leave(ends: &[[DVec2; 2]], (i, second): (usize, bool)) -> DVec2 {
    ends[i][usize::from(!second)]
}

/// Turns round stretches where that shortens the way (2-opt); whether it did.
fn turn_stretches(order: &mut [(usize, bool)], ends: &[[DVec2; 2]], at: DVec2) -> bool {
    let mut improved = false;
    for a in 0..order.len() {
        let before = if a == 0 { at } else { leave(ends, order[a - 1]) };
        let first = before.distance(enter(ends, order[a]));
        if first < 1e-6 {
            continue;
        }
        for b in a..(a + WINDOW).min(order.len()) {
            let after = order.get(b + 1).map(|&n| enter(ends, n));
            let old = first + after.map_or(0.0, |n| leave(ends, order[b]).distance(n));
            let new = before.distance(leave(ends, order[b]))
                + after.map_or(0.0, |n| enter(ends, order[a]).distance(n));
            if new < old - 1e-6 {
                order[a..=b].reverse();
                order[a..=b].iter_mut().for_each(|o| o.1 = !o.1);
                improved = true;
                break;
            }
        }
    }
    improved
}

/// Moves stretches of up to three elsewhere where that shortens the way (Or-opt); whether it did.
fn move_stretches(order: &mut [(usize, bool)], ends: &[[DVec2; 2]], at: DVec2) -> bool {
    let n = order.len();
    let mut improved = false;
    for length in 1..=3.min(n.saturating_sub(1)) {
        for a in 0..=n - length {
            let b = a + length;
            let place = |k: usize| if k == 0 { at } else { leave(ends, order[k - 1]) };
            let next = |k: usize| order.get(k).map(|&o| enter(ends, o));
            let way = |from: DVec2, to: Option<DVec2>| to.map_or(0.0, |to| from.distance(to));
            let (first, last) = (enter(ends, order[a]), leave(ends, order[b - 1]));
            let saved = place(a).distance(first) + way(last, next(b)) - way(place(a), next(b));
            if saved < 1e-6 {
                continue;
            }
            // Between k - 1 and k, outside the stretch.
            let mut best = (saved - 1e-6, usize::MAX, false);
            for k in a.saturating_sub(REACH)..=(b + REACH).min(n) {
                if (a..=b).contains(&k) {
                    continue;
                }
                let gap = way(place(k), next(k));
                for (turned, from, to) in [(false, first, last), (true, last, first)] {
                    let cost = place(k).distance(from) + way(to, next(k)) - gap;
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
                order[a..b].reverse();
                order[a..b].iter_mut().for_each(|o| o.1 = !o.1);
            }
            if k < a {
                order[k..b].rotate_right(length);
            } else {
                order[a..k].rotate_left(length);
            }
            improved = true;
        }
    }
    improved
}

/// Makes the vertex nearest to `at` the start of a closed path; turns an open one whose end is nearer.
pub fn start_nearest(path: &mut Toolpath, at: DVec2) {
    if path.closed {
        let near = path.points.iter().map(|p| p.distance_squared(at)).enumerate();
        let start = near.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |n| n.0);
        path.rotate_to(start);
    } else if path.end().distance_squared(at) < path.start().distance_squared(at) {
        path.reverse();
    }
}

/// The walls that follow one contour, with the box around the outermost.
struct Ring {
    bounds: Bounds2,
    is_hole: bool,
    walls: Vec<Wall>,
}

/// Puts walls in order: contour by contour, each from the inside out or the other way.
pub fn walls(walls: Vec<Wall>, order: WallOrder, seams: &mut Seams, at: &mut DVec2, out: &mut Vec<Toolpath>) {
    let mut rings: Vec<Ring> = Vec::new();
    for wall in walls {
        let is_hole = signed_area_mm2(&wall.path.points) < 0.0;
        let Some(bounds) = Bounds2::of(wall.path.points.iter().copied()) else { continue };
        let offset = |r: &Ring| r.bounds.centre().distance_squared(bounds.centre());
        let home = rings
            .iter_mut()
            .filter(|r| wall.depth > 0 && r.is_hole == is_hole)
            .min_by(|a, b| offset(a).total_cmp(&offset(b)));
        match home {
            Some(ring) => ring.walls.push(wall),
            None => rings.push(Ring { bounds, is_hole, walls: vec![wall] }),
        }
    }
    let places: Vec<[DVec2; 2]> = rings.iter().map(|r| [r.walls[0].path.start(); 2]).collect();
    let mut rings: Vec<Option<Ring>> = rings.into_iter().map(Some).collect();
    for (i, _) in tour(&places, *at) {
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

/// Puts single beads and fill in order: by rank, and within a rank by short ways.
pub fn fills(mut fills: Vec<Toolpath>, at: &mut DVec2, out: &mut Vec<Toolpath>) {
    fills.sort_by_key(|p| p.rank);
    for fills in fills.chunk_by_mut(|a, b| a.rank == b.rank) {
        let ends: Vec<[DVec2; 2]> = fills.iter().map(|p| [p.start(), p.end()]).collect();
        for (i, second) in tour(&ends, *at) {
            let path = &mut fills[i];
            if path.closed {
                start_nearest(path, *at);
            } else if second {
                path.reverse();
            }
            *at = path.end();
            out.push(path.clone());
        }
    }
}
