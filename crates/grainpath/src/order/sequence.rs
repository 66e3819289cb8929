//! Sequences of paths with short ways between them.

use grainpath_core::poly::signed_area_mm2;
use grainpath_core::{Bounds2, DVec2, Toolpath};

use super::WallOrder;
use super::nearest::NearestEnds;
use super::seam::Seams;
use crate::walls::Wall;

/// How far ahead 2-opt looks for an exchange.
const WINDOW: usize = 200;
/// Passes of 2-opt at the most.
const PASSES: usize = 8;

/// Visits every owner once, entering at one of its ends and leaving at the other: nearest next, then improved by
/// turning round stretches (2-opt). Gives owners and whether each is entered at its second end.
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
    let enter = |(i, second): (usize, bool)| ends[i][usize::from(second)];
    let leave = |(i, second): (usize, bool)| ends[i][usize::from(!second)];
    for _ in 0..PASSES {
        let mut improved = false;
        for a in 0..order.len() {
            let before = if a == 0 { at } else { leave(order[a - 1]) };
            let first = before.distance(enter(order[a]));
            if first < 1e-6 {
                continue;
            }
            for b in a..(a + WINDOW).min(order.len()) {
                let after = order.get(b + 1).map(|&n| enter(n));
                let old = first + after.map_or(0.0, |n| leave(order[b]).distance(n));
                let before = if a == 0 { at } else { leave(order[a - 1]) };
                let new =
                    before.distance(leave(order[b])) + after.map_or(0.0, |n| enter(order[a]).distance(n));
                if new < old - 1e-6 {
                    order[a..=b].reverse();
                    order[a..=b].iter_mut().for_each(|o| o.1 = !o.1);
                    improved = true;
                    break;
                }
            }
        }
        if !improved {
            break;
        }
    }
    order
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

/// Puts single beads and fill in order.
pub fn fills(fills: Vec<Toolpath>, at: &mut DVec2, out: &mut Vec<Toolpath>) {
    let ends: Vec<[DVec2; 2]> = fills.iter().map(|p| [p.start(), p.end()]).collect();
    let mut fills: Vec<Option<Toolpath>> = fills.into_iter().map(Some).collect();
    for (i, second) in tour(&ends, *at) {
        let Some(mut path) = fills[i].take() else { continue };
        if path.closed {
            start_nearest(&mut path, *at);
        } else if second {
            path.reverse();
        }
        *at = path.end();
        out.push(path);
    }
}
