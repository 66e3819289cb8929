//! Walls of the part that run over air between contacts and interface lines, and the contacts and lines that hold them.
//!
//! Contacts are placed on the surface and interface lines along rows of it ([`super::interface`]). A wall follows the rim
//! of its layer and may miss both: beside a post or a leg that cuts a row short, and along a narrow strip. So
//! the walls themselves are followed. A point of a wall is held if a wall of the layer below or the bead of an interface
//! line lies within [`FREE_STEP_BEADS`] of it, or the tip of a contact does. Every stretch that is not held and is longer
//! than [`LONGEST_SHARE`] of L is divided by contacts, each with a short line across all walls.
//!
//! Lengths are mm. Cost: an offset for each wall and a walk along it, in the layers that flat overhangs begin in. Limits: walls
//! so near the plate that no support fits below them, across the removal gap, are left as they are.

use grainpath_core::buckets::{PointGrid2, PointGrid3};
use grainpath_core::math::sin;
use grainpath_core::poly::{Join, edges};
use grainpath_core::polyline::length_mm;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{Bounds2, DVec2, DVec3, LayerStack, TriMesh};
use rayon::prelude::*;

use super::SupportSettings;
use super::contact::{Contact, Reason};
use super::cut::Heights;
use super::held::{Part, PartWalls};
use super::interface::{self, FREE_STEP_BEADS, SPACING_SHARE};
use super::overhang::Overhangs;

/// The longest stretch of a wall or a line of a skin that is left over air, as a share of L. Source: derived. Both ends of a stretch are known
/// to [`STEP_MM`] and move by half a bead with the beads below; at L = 10 mm that is 0.85 mm.
pub(crate) const LONGEST_SHARE: f64 = 0.9;
/// A wall is held by a contact that lies beside it by at most this many bead widths. Source: derived. The line across two walls
/// from a contact below the outer one reaches as far.
const BESIDE_BEADS: f64 = 2.0;
/// Distance of the points at which beads over air are judged, mm. Source: derived. Less than half a bead, so that no bead across
/// one falls between two points.
pub(crate) const STEP_MM: f64 = 0.2;
/// Distance of the points of an interface line, mm. Source: derived. At a reach of 0.3 mm the error of a distance is then
/// 0.004 mm (Pythagoras with half a step).
const LINE_STEP_MM: f64 = 0.1;
/// Points of beads that a program judges lie at most this far apart, mm, so that one of them is within half of it along
/// the bead. Source: as in `held`.
const JUDGED_MM: f64 = 0.3;
/// Where facets are painted or listed as blocked, a wall belongs to an overhang if a sample of the overhang is within this
/// many steps of the grid of samples. Source: derived. On a surface that leans by 60 degrees the middle of a cell is 0.9
/// steps from its corners.
const NEAR_SAMPLES: f64 = 1.5;

/// A stretch of a wall over air.
struct Free {
    layer: usize,
    /// Number of the wall, from the outermost.
    wall: usize,
    points: Vec<DVec2>,
    closed: bool,
}

/// Adds contacts and lines below walls that would run too far over air.
pub(super) fn hold(out: &mut Overhangs, mesh: &TriMesh, stack: &LayerStack, settings: &SupportSettings) {
    let heights = Heights::new(stack);
    let begins = flat_layers(mesh, &out.facets, stack, settings);
    if !begins.contains(&true) {
        return;
    }
    let part_walls = &PartWalls::new(stack, settings);
    let w = settings.beads.bead_width_mm;
    // Beside a post a strip may be too narrow for samples, so they may lie further off where nothing is blocked by hand.
    let by_hand = !settings.block_facets.is_empty() || !settings.painted.blockers.triangles.is_empty();
    let near_mm = if by_hand { NEAR_SAMPLES * settings.sample_mm() } else { settings.spacing_mm() };
    let mut overhang = PointGrid3::new(near_mm);
    out.samples.iter().for_each(|s| overhang.insert(s.at, ()));
    // Points of lines and contacts, by the number of support layers below them.
    let mut holders: Vec<Vec<DVec2>> = vec![Vec::new(); stack.layers().len() + 1];
    let mut add = |p: DVec3| holders[heights.end_below(p.z, settings.z_gap_mm)].push(p.truncate());
    for pair in out.lines.iter().flat_map(|line| line.windows(2)) {
        points_between(pair[0], pair[1]).for_each(&mut add);
    }
    out.contacts.iter().for_each(|c| add(c.at));
    let reach_mm = ((FREE_STEP_BEADS * w).powi(2) - 0.25 * JUDGED_MM * JUDGED_MM).max(0.0).sqrt();
    let longest_mm = LONGEST_SHARE * settings.max_unsupported_mm;
    let of_layer = |k: usize| -> Vec<Free> {
        let layer = &stack.layers()[k];
        let bottom_mm = layer.z_top_mm() - layer.height_mm();
        let end = heights.end_below(bottom_mm, settings.z_gap_mm);
        let Some(bounds) = layer.region().bounds() else { return Vec::new() };
        if !begins[k] || end == 0 {
            return Vec::new();
        }
        let mut part = Part::new(stack, &heights, settings, part_walls);
        let mut held = PointGrid2::new(bounds.grown(1.0), 1.0);
        let room = |p: &&DVec2| {
            bounds.meets(Bounds2 { min: **p, max: **p }.grown(w)) && part.leaves_room(end - 1, **p, w)
        };
        holders[end].iter().filter(room).for_each(|&p| held.insert(p, ()));
        let step_mm = interface::step_mm(layer.height_mm(), settings);
        let is_beyond = |p: DVec2, part: &mut Part<'_>| {
            held.within(p, reach_mm).next().is_none()
                && !part.contains(k - 1, p)
                && overhang.within(p.extend(bottom_mm), near_mm).next().is_some()
                && !settings.blocked(p.extend(bottom_mm))
        };
        let mut found = Vec::new();
        for wall in 0..settings.walls.n_walls {
            let walls = layer.region().offset(-depth_mm(wall, layer.height_mm(), settings), Join::Miter(2.0));
            if walls.is_empty() {
                break;
            }
            for contour in walls.contours() {
                let points = points_along(contour);
                // The walls of the layer below cost two offsets, so they are laid only where a stretch lies beyond its section.
                let mut free: Vec<bool> = points.iter().map(|&p| is_beyond(p, &mut part)).collect();
                if stretches(&points, true, &free, longest_mm).is_empty() {
                    continue;
                }
                let beside: Vec<bool> = free
                    .iter()
                    .zip(&points)
                    .map(|(free, p)| *free && part.has_bead_near(k - 1, *p, step_mm))
                    .collect();
                drop_grazes(&mut free, &beside, &points, w);
                let stretches = stretches(&points, true, &free, longest_mm);
                found.extend(stretches.into_iter().map(|(points, closed)| Free {
                    layer: k,
                    wall,
                    points,
                    closed,
                }));
            }
        }
        found
    };
    let found: Vec<Vec<Free>> = (1..stack.layers().len()).into_par_iter().map(of_layer).collect();
    let spacing_mm = SPACING_SHARE * settings.max_unsupported_mm;
    let placed: Vec<(usize, DVec2)> = out
        .contacts
        .iter()
        .map(|c| (heights.end_below(c.at.z, settings.z_gap_mm), c.at.truncate()))
        .collect();
    for in_layer in found {
        let mut added: Vec<DVec2> = Vec::new();
        for Free { layer, wall, points, closed } in in_layer {
            let layer = &stack.layers()[layer];
            let (h, z_mm) = (layer.height_mm(), layer.z_top_mm() - layer.height_mm());
            // A contact beside the wall, as in the middle of a narrow strip, holds it by a line of its own.
            let end = heights.end_below(z_mm, settings.z_gap_mm);
            for c in placed.iter().filter(|c| c.0 == end).map(|c| c.1) {
                // On a narrow strip the contact may hold the walls of both sides.
                for p in nearest(&points, closed, c).filter(|p| p.distance(c) <= BESIDE_BEADS * w) {
                    let last = p + (p - c).normalize_or_zero() * depth_mm(wall, h, settings);
                    add_line([c, last].map(|p| p.extend(z_mm)), &mut out.lines, &mut added);
                }
            }
            let free: Vec<bool> =
                points.iter().map(|p| added.iter().all(|q| q.distance(*p) > reach_mm)).collect();
            for (stretch, closed) in stretches(&points, closed, &free, longest_mm) {
                for (p, inwards) in divided(&stretch, closed, spacing_mm) {
                    let own_mm = depth_mm(wall, h, settings);
                    let inner_mm = depth_mm(settings.walls.n_walls - 1, h, settings) + 0.5 * w - own_mm;
                    // Of very many walls, each gets its own contacts.
                    let [first, last] = [-own_mm, inner_mm.min(0.5 * spacing_mm)].map(|mm| p + inwards * mm);
                    add_line([first, last].map(|p| p.extend(z_mm)), &mut out.lines, &mut added);
                    out.contacts.push(Contact {
                        at: p.extend(z_mm),
                        normal: -DVec3::Z,
                        area_mm2: 0.0,
                        reason: Reason::Facets,
                        tip_mm: 0.0,
                    });
                }
            }
        }
    }
}

/// Points of an interface line from one end to the other, [`LINE_STEP_MM`] apart at most.
fn points_between(first: DVec3, last: DVec3) -> impl Iterator<Item = DVec3> {
    let n = (first.distance(last) / LINE_STEP_MM).ceil().max(1.0) as usize;
    (0..=n).map(move |i| first.lerp(last, i as f64 / n as f64))
}

/// Adds an interface line, and its points to those that hold walls.
fn add_line([first, last]: [DVec3; 2], lines: &mut Vec<Vec<DVec3>>, holders: &mut Vec<DVec2>) {
    holders.extend(points_between(first, last).map(DVec3::truncate));
    lines.push(vec![first, last]);
}

/// The points of a stretch that are nearer to a place than those beside them: one of each side of a narrow strip.
fn nearest(points: &[DVec2], closed: bool, place: DVec2) -> impl Iterator<Item = DVec2> {
    let n = points.len();
    let mm = move |i: usize| points[i % n].distance(place);
    let is_nearest = move |i: &usize| {
        // Of two points at one distance the first is taken. The ends of an open stretch have one neighbour.
        let (has_before, has_after) = (closed || *i > 0, closed || i + 1 < n);
        (!has_before || mm(*i) < mm(i + n - 1)) && (!has_after || mm(*i) <= mm(i + 1))
    };
    (0..n).filter(is_nearest).map(|i| points[i])
}

/// Depth of the centreline of a wall below the rim of its layer.
fn depth_mm(wall: usize, height_mm: f64, settings: &SupportSettings) -> f64 {
    let w = settings.beads.bead_width_mm;
    0.5 * w + wall as f64 * bead_spacing_mm(w, height_mm)
}

/// The layers in which flat overhangs begin.
fn flat_layers(mesh: &TriMesh, facets: &[u32], stack: &LayerStack, settings: &SupportSettings) -> Vec<bool> {
    let layers = stack.layers();
    let middles: Vec<f64> = layers.iter().map(|l| l.z_top_mm() - 0.5 * l.height_mm()).collect();
    let mut begins = vec![false; layers.len()];
    for &t in facets {
        let triangle = mesh.triangles[t as usize];
        let z = triangle.map(|i| mesh.vertices[i as usize].z);
        let (low, high) =
            z.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
        let first = middles.partition_point(|&m| m < low - 1e-9);
        let last = middles.partition_point(|&m| m < high - 1e-9);
        let flat =
            |k: usize| -mesh.normal(triangle).z > sin(interface::flat_rad(layers[k].height_mm(), settings));
        for k in
            (first..=last.min(layers.len().saturating_sub(1))).filter(|&k| !begins[k]).collect::<Vec<_>>()
        {
            begins[k] = flat(k);
        }
    }
    begins
}

/// Points along a closed line.
fn points_along(contour: &[DVec2]) -> Vec<DVec2> {
    let points = |(a, b): (DVec2, DVec2)| {
        let n = (a.distance(b) / STEP_MM).ceil().max(1.0) as usize;
        (0..n).map(move |i| a.lerp(b, i as f64 / n as f64))
    };
    edges(contour).flat_map(points).collect()
}

/// Marks the points beside a bead of the layer below as held, unless they only graze it: where such a run is shorter than
/// `least_mm` and over air at both ends, a corner of the bead comes near, and the printed bead cuts corners off.
fn drop_grazes(free: &mut [bool], beside: &[bool], points: &[DVec2], least_mm: f64) {
    let n = free.len();
    let Some(first) = (0..n).find(|&i| !beside[i]) else {
        free.fill(false);
        return;
    };
    let order: Vec<usize> = (0..n).map(|i| (i + first) % n).collect();
    let mut end = 0;
    for run in order.chunk_by(|&i, &j| beside[i] == beside[j]) {
        end += run.len();
        let (before, after) = (order[(end + n - run.len() - 1) % n], order[end % n]);
        let line: Vec<DVec2> = run.iter().map(|&i| points[i]).collect();
        let grazes = length_mm(&line, false) < least_mm && free[before] && free[after];
        if beside[run[0]] && !grazes {
            run.iter().for_each(|&i| free[i] = false);
        }
    }
}

/// The stretches of `free` points that are longer than `longest_mm`, each with a flag that marks the whole of a closed line.
fn stretches(points: &[DVec2], closed: bool, free: &[bool], longest_mm: f64) -> Vec<(Vec<DVec2>, bool)> {
    let length_mm = |line: &[DVec2]| length_mm(line, false);
    if !free.contains(&false) {
        return if length_mm(points) > longest_mm { vec![(points.to_vec(), closed)] } else { Vec::new() };
    }
    // A closed line is read from a point that is held, so that no stretch is cut in two at the line's start.
    let first = if closed { free.iter().position(|f| !f).unwrap_or(0) } else { 0 };
    let order: Vec<usize> = (0..points.len()).map(|i| (i + first) % points.len()).collect();
    let all = order.chunk_by(|&i, &j| free[i] == free[j]).filter(|stretch| free[stretch[0]]);
    let all = all.map(|stretch| stretch.iter().map(|&i| points[i]).collect::<Vec<DVec2>>());
    all.filter(|stretch| length_mm(stretch) > longest_mm).map(|stretch| (stretch, false)).collect()
}

/// Points that divide a line into equal pieces no longer than `piece_mm`, each with the direction to the left of the line,
/// which is inwards for walls.
fn divided(line: &[DVec2], closed: bool, piece_mm: f64) -> Vec<(DVec2, DVec2)> {
    let ways: Vec<(DVec2, DVec2)> =
        if closed { edges(line).collect() } else { line.windows(2).map(|w| (w[0], w[1])).collect() };
    let total_mm: f64 = ways.iter().map(|(a, b)| a.distance(*b)).sum();
    let pieces = (total_mm / piece_mm).ceil().max(1.0) as usize;
    let mut out = Vec::new();
    let (mut behind_mm, mut next) = (0.0, usize::from(!closed));
    for (a, b) in ways {
        let length_mm = a.distance(b);
        while next < pieces && total_mm * next as f64 / pieces as f64 <= behind_mm + length_mm {
            let share = (total_mm * next as f64 / pieces as f64 - behind_mm) / length_mm.max(1e-12);
            out.push((a.lerp(b, share), (b - a).normalize_or_zero().perp()));
            next += 1;
        }
        behind_mm += length_mm;
    }
    out
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec2;

    use super::{STEP_MM, drop_grazes};

    /// Points of a closed wall: `-` over air, `b` over air beside a bead of the layer below, `#` held otherwise.
    fn held(wall: &str) -> String {
        let mut free: Vec<bool> = wall.chars().map(|c| c != '#').collect();
        let beside: Vec<bool> = wall.chars().map(|c| c == 'b').collect();
        let points: Vec<DVec2> = (0..wall.len()).map(|i| STEP_MM * i as f64 * DVec2::X).collect();
        drop_grazes(&mut free, &beside, &points, 0.45);
        free.iter().map(|free| if *free { '-' } else { '#' }).collect()
    }

    #[test]
    fn a_wall_that_grazes_a_corner_of_a_bead_below_is_not_held_there() {
        assert_eq!(held("---bb---#--"), "--------#--");
        // A bead that crosses below holds it, and a bead that goes on from another.
        assert_eq!(held("---bbbb---#b-"), "---####---##-");
        assert_eq!(held("b----#-----"), "-----#-----");
        assert_eq!(held("b----#----#"), "#----#----#");
        assert_eq!(held("bbb"), "###");
    }
}
