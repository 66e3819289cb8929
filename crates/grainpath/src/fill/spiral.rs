//! Joins closed rings that lie inside each other into one spiral.
//!
//! Concentric infill, and beads along a field that turns around a point, consist of rings. Each ring starts
//! and stops, and the nozzle travels from one to the next; a spiral is a single bead. A ring is printed up
//! to [`RAMP`] steps before its end. Its rest becomes a ramp, which begins on the ring and gradually
//! changes over to the next ring, where that ring starts:
//!
//! ```text
//!     ===== ring 1 ====.          <- ends here
//!     ===== ring 2 ===. `-.____ ring 1 goes on as ring 2
//! ```
//!
//! Ramps of consecutive rings lie beside each other at the distance of the rings, so nothing stays open
//! between them. The first and the last ramp leave a triangular wedge beside the bead, [`RAMP`] steps long
//! and one step wide. The next ring is the nearest one that lies along the whole ramp. If rings split into
//! two groups, one group continues the spiral and the other begins its own. Each spiral begins on the
//! longest ring that is left, in the middle of the long edge nearest to the shortest ring, so that ramps
//! keep clear of corners.
//!
//! Lengths are in mm. Cost: the number of rings times the number of all their points. Open paths are not changed.

use std::collections::BTreeSet;

use grainpath_core::segment::{closest_share, distance_squared_mm2};
use grainpath_core::{BeadWidth, DVec2, Toolpath};

/// Length of a ramp, in distances between rings. Source: derived. The area of the wedge beside the first
/// ramp is half this number times the square of a bead's width: one square. On a shorter ramp the bead
/// turns by more than 27 degrees.
const RAMP: f64 = 2.0;
/// Largest share of a ring that becomes its ramp. Source: derived. With a half, at least as
/// much of each ring lies along the guide as leaves it.
const MOST_OF_RING: f64 = 0.5;
/// Greatest distance of the next ring, in distances between rings. Source: derived. Beads along a field lie
/// up to 1.6 times their usual distance apart (`WIDEST` of stripes); from twice the usual distance on
/// another ring fits between.
const REACH: f64 = 1.7;
/// Number of points of a ramp. Source: derived. On the smallest ring, 1.3 steps across and with a ramp of
/// half its length, the chord of an eighth of the ramp lies 0.01 steps off the arc.
const RAMP_POINTS: usize = 8;

/// A ring, stored as an open path that ends at its start.
struct ClosedBead {
    path: Toolpath,
    length_mm: f64,
}

/// The place of a ring that is nearest to a point.
struct Nearest {
    distance_mm: f64,
    along_mm: f64,
    at: DVec2,
    width_mm: f64,
    /// Vector from the start to the end of the segment at this place.
    ahead: DVec2,
}

impl ClosedBead {
    fn new(path: Toolpath) -> Self {
        let path = path.opened();
        Self { length_mm: path.length_mm(), path }
    }

    fn nearest(&self, p: DVec2) -> Nearest {
        let pieces = || (0..self.path.n_segments()).map(|i| self.path.segment(i));
        let distance = |i: usize| {
            let (a, b, _) = self.path.segment(i);
            distance_squared_mm2(p, a, b)
        };
        let i = (0..self.path.n_segments()).min_by(|i, j| distance(*i).total_cmp(&distance(*j))).unwrap_or(0);
        let before: f64 = pieces().take(i).map(|(a, b, _)| a.distance(b)).sum();
        let (a, b, _) = self.path.segment(i);
        let t = closest_share(p, a, b);
        let at = a.lerp(b, t);
        Nearest {
            distance_mm: at.distance(p),
            along_mm: before + t * a.distance(b),
            at,
            width_mm: self.path.width_at(i) * (1.0 - t) + self.path.width_at(i + 1) * t,
            ahead: b - a,
        }
    }

    /// A place to start near a point: the middle of the nearest edge that is long enough for two straight
    /// ramps, or the ring's own nearest point if no edge is long enough.
    fn start_near(&self, target: DVec2, step_mm: f64) -> DVec2 {
        let edges = (0..self.path.n_segments()).map(|i| self.path.segment(i));
        let long = edges.filter(|(a, b, _)| a.distance(*b) > 2.0 * RAMP * step_mm);
        let middles = long.map(|(a, b, _)| a.midpoint(b));
        middles
            .min_by(|a, b| a.distance_squared(target).total_cmp(&b.distance_squared(target)))
            .unwrap_or_else(|| self.nearest(target).at)
    }

    /// The whole ring as a path that starts and ends at a place, in the direction of `ahead`.
    fn from(&self, place: &Nearest, ahead: DVec2) -> Toolpath {
        let mut path = self.path.part(place.along_mm, self.length_mm);
        append(&mut path, self.path.part(0.0, place.along_mm));
        if ahead.dot(place.ahead) < 0.0 {
            path.reverse();
        }
        path
    }
}

/// Appends a path that begins where `path` ends.
fn append(path: &mut Toolpath, next: Toolpath) {
    let again =
        usize::from(path.points.last().zip(next.points.first()).is_some_and(|(a, b)| a.distance(*b) < 1e-9));
    if let BeadWidth::PerVertex(widths) = &mut path.width {
        widths.extend((again..next.points.len()).map(|i| next.width_at(i)));
    }
    path.points.extend(next.points.into_iter().skip(again));
}

/// Joins closed paths into spirals where they lie about `step_mm` apart.
pub(crate) fn join_rings(paths: &mut Vec<Toolpath>, step_mm: f64) {
    let (closed, open): (Vec<_>, Vec<_>) = std::mem::take(paths).into_iter().partition(|p| p.closed);
    *paths = open;
    let rings: Vec<ClosedBead> =
        closed.into_iter().filter(|p| p.points.len() > 2).map(ClosedBead::new).collect();
    let mut left: BTreeSet<usize> = (0..rings.len()).collect();
    let by_length = |i: &usize, j: &usize| rings[*i].length_mm.total_cmp(&rings[*j].length_mm);
    // Among equally long rings the first one is taken.
    while let Some(first) = left.iter().copied().max_by(|i, j| by_length(i, j).then(j.cmp(i))) {
        let shortest = left.iter().copied().min_by(by_length).unwrap_or(first);
        left.remove(&first);
        let target = rings[shortest].path.start();
        let start = rings[first].nearest(rings[first].start_near(target, step_mm));
        let mut ring = rings[first].from(&start, start.ahead);
        let mut spiral: Option<Toolpath> = None;
        while let Some((next, ramp, rest)) = ramp_to_next(&rings, &left, &ring, step_mm) {
            left.remove(&next);
            let body = ring.part(0.0, ring.length_mm() - ramp.length_mm);
            let mut so_far = match spiral.take() {
                Some(mut so_far) => {
                    append(&mut so_far, body);
                    so_far
                }
                None => body,
            };
            append(&mut so_far, ramp.path);
            spiral = Some(so_far);
            ring = rest;
        }
        paths.push(match spiral {
            Some(mut spiral) => {
                append(&mut spiral, ring);
                spiral
            }
            // A ring without a neighbour stays closed.
            None => {
                ring.points.pop();
                if let BeadWidth::PerVertex(widths) = &mut ring.width {
                    widths.pop();
                }
                Toolpath { closed: true, ..ring }
            }
        });
    }
}

/// The bead from one ring to the next.
struct Ramp {
    path: Toolpath,
    /// Length of the piece of ring that the ramp replaces, mm.
    length_mm: f64,
}

/// The next ring, the ramp that leads to it from the end of this ring, and the path around the next ring.
fn ramp_to_next(
    rings: &[ClosedBead],
    left: &BTreeSet<usize>,
    ring: &Toolpath,
    step_mm: f64,
) -> Option<(usize, Ramp, Toolpath)> {
    let length_mm = ring.length_mm();
    let ramp_mm = (RAMP * step_mm).min(MOST_OF_RING * length_mm);
    let end = ring.end();
    let alike = |path: &Toolpath| path.role == ring.role && path.flow == ring.flow && path.rank == ring.rank;
    let mut near: Vec<(usize, Nearest)> = left
        .iter()
        .filter(|k| alike(&rings[**k].path))
        .map(|k| (*k, rings[*k].nearest(end)))
        .filter(|(_, place)| place.distance_mm < REACH * step_mm)
        .collect();
    near.sort_by(|a, b| a.1.distance_mm.total_cmp(&b.1.distance_mm));
    // The last piece of the ring itself, which the ramp replaces.
    let own = ring.part(length_mm - ramp_mm, length_mm);
    let ahead = own.points.last().zip(own.points.iter().rev().nth(1)).map(|(b, a)| *b - *a)?;
    near.into_iter().find_map(|(next, place)| {
        let mut points = Vec::with_capacity(RAMP_POINTS);
        let mut widths = Vec::with_capacity(RAMP_POINTS);
        for k in 1..=RAMP_POINTS {
            let t = k as f64 / RAMP_POINTS as f64;
            let along = own.part(0.0, t * ramp_mm);
            let (p, w) = (along.end(), along.width_at(along.points.len() - 1));
            let q = rings[next].nearest(p);
            // The neighbour must lie along the whole ramp.
            if q.distance_mm > REACH * step_mm {
                return None;
            }
            points.push(p.lerp(q.at, t));
            widths.push(w + t * (q.width_mm - w));
        }
        let constant = matches!(ring.width, BeadWidth::Constant(_));
        let width = if constant { ring.width.clone() } else { BeadWidth::PerVertex(widths) };
        let rest = rings[next].from(&place, ahead);
        Some((next, Ramp { path: Toolpath { points, width, ..own.clone() }, length_mm: ramp_mm }, rest))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::tests::{context, outlines};
    use crate::fill::{Concentric, Infill};
    use grainpath_core::segment::{Meeting, meeting};

    fn rings_of(name: &str, density: f64) -> (Vec<Toolpath>, f64) {
        let (_, region) = outlines().into_iter().find(|(outline, _)| *outline == name).expect("an outline");
        let context = context(density, 0.0, 0.1);
        let mut rings = Vec::new();
        region.polygons.iter().for_each(|p| Concentric.fill(&context, p, &mut rings));
        (rings, context.spacing_mm() / density)
    }

    fn volume_mm3(paths: &[Toolpath]) -> f64 {
        paths.iter().map(|p| p.volume_mm3(0.2)).sum()
    }

    fn crosses_itself(path: &Toolpath) -> bool {
        let n = path.n_segments();
        let ends = |i: usize| {
            let (a, b, _) = path.segment(i);
            [a, b]
        };
        (0..n).any(|i| (i + 2..n).any(|j| meeting(ends(i), ends(j)) == Meeting::Cross))
    }

    #[test]
    fn rings_around_each_other_are_one_spiral_of_the_same_volume() {
        for (outline, density, spirals) in [
            ("disc", 1.0, 1),
            ("square", 1.0, 1),
            ("ring", 1.0, 1),
            ("triangle", 0.3, 1),
            ("square", 0.2, 1),
            ("l", 1.0, 2),
        ] {
            let (rings, step) = rings_of(outline, density);
            let mut paths = rings.clone();
            join_rings(&mut paths, step);
            assert!(
                paths.len() <= spirals,
                "{outline} {density}: {} paths of {} rings",
                paths.len(),
                rings.len()
            );
            let ratio = volume_mm3(&paths) / volume_mm3(&rings);
            assert!((ratio - 1.0).abs() < 0.01, "{outline} {density}: {ratio}");
            for path in &paths {
                assert!(!crosses_itself(path), "{outline} {density}");
            }
        }
    }

    #[test]
    fn single_rings_and_open_paths_stay_as_they_are() {
        let (rings, step) = rings_of("disc", 1.0);
        let open = Toolpath { closed: false, ..rings[1].clone() };
        let mut paths = vec![rings[0].clone(), open.clone()];
        join_rings(&mut paths, step);
        assert_eq!(paths[0], open);
        assert!(paths[1].closed && (paths[1].length_mm() - rings[0].length_mm()).abs() < 1e-9);
        let mut far = vec![rings[0].clone(), rings[5].clone()];
        join_rings(&mut far, step);
        assert!(far.iter().all(|p| p.closed), "five beads apart");
    }

    #[test]
    fn widths_pass_from_one_ring_to_the_next() {
        let (mut rings, step) = rings_of("disc", 1.0);
        for (k, ring) in rings.iter_mut().enumerate() {
            ring.width = BeadWidth::PerVertex(vec![0.4 + 0.01 * (k % 5) as f64; ring.points.len()]);
        }
        join_rings(&mut rings, step);
        let BeadWidth::PerVertex(widths) = &rings[0].width else { panic!("widths of each vertex") };
        assert_eq!((rings.len(), widths.len()), (1, rings[0].points.len()));
        assert!(widths.iter().all(|w| (0.4 - 1e-12..0.44 + 1e-12).contains(w)));
    }
}
