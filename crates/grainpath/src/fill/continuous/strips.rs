//! Divides a region into strips two beads wide along the field. Their outlines are the beads' centrelines.
//!
//! The phase ([`phase`](grainpath_core::phase)) makes one turn per two beads across the field. A
//! strip's outline encloses the area in which the cosine of the phase is negative. The two beads of a
//! strip run where the cosine changes sign, and between neighbouring strips it is positive. The cosine
//! is the same for either sign of the axis, so outlines close around every singular point of the
//! field.
//!
//! ```text
//!    cos > 0   between strips
//!    ===========================   bead, cosine changes sign
//!    cos < 0   inside the strip
//!    ===========================   bead, cosine changes sign
//!    cos > 0   between strips
//! ```
//!
//! Lines that leave the infill region are cut at its border and joined along its contours ([`cut_by`]).
//! Places too thin for two strips side by side become strips of their own, whatever the field says. If
//! rounding makes it unclear where lines and contours cross, the whole region becomes one strip. Cost: the
//! phase on about [`MANY_NODES`] nodes, or more if [`MESH_MAX`] bounds the grid squares; then linear in the
//! outlines.

use std::f64::consts::PI;

use grainpath_core::math::{cos, cross};
use grainpath_core::phase::{Diffusion, PhaseInput, Turn, drift, solve, turns};
use grainpath_core::poly::{FillRule, Join, LineClipper};
use grainpath_core::{DVec2, Polygon, Region, segment};

use super::super::field::levels::{EdgePoints, Joints, off_lines_rad};
use super::super::field::stripes::{BORDER_CELL, NearBorder};
use super::super::field::widths::smooth;
use super::Pull;
use crate::fill::FillContext;
use grainpath_core::field_mesh::FieldMesh;
use grainpath_core::polyline::resampled;
use grainpath_core::tuned::Tuned;

/// Smallest side of the grid squares on which the phase is found, in beads.
/// Measured: row `fill.continuous.strips.MESH_MIN` of `cargo xtask bench constants`.
static MESH_MIN: Tuned<f64> = Tuned::new("fill.continuous.strips.MESH_MIN", 1.0);
/// Largest side of the grid squares on which the phase is found, in beads, however large the region.
/// Measured: row `fill.continuous.strips.MESH_MAX` of `cargo xtask bench constants`.
static MESH_MAX: Tuned<f64> = Tuned::new("fill.continuous.strips.MESH_MAX", 3.0);
/// The grid has about this number of nodes at most; a larger region gets larger squares.
/// Measured: row `fill.continuous.strips.MANY_NODES` of `cargo xtask bench constants`.
static MANY_NODES: Tuned<f64> = Tuned::new("fill.continuous.strips.MANY_NODES", 20_000.0);
/// Parts of a region narrower than this are strips by themselves, in beads.
/// Measured: row `fill.continuous.strips.THIN_BEADS` of `cargo xtask bench constants`.
static THIN_BEADS: Tuned<f64> = Tuned::new("fill.continuous.strips.THIN_BEADS", 1.5);
/// Thin parts are grown by this, in beads. Measured: row `fill.continuous.strips.THIN_GROWN` of `cargo xtask bench
/// constants`.
static THIN_GROWN: Tuned<f64> = Tuned::new("fill.continuous.strips.THIN_GROWN", 0.1);
/// Outlines around less than this are left out where thin parts were added, in square beads. Measured: row
/// `fill.continuous.strips.THIN_CRUMB` of `cargo xtask bench constants`.
static THIN_CRUMB: Tuned<f64> = Tuned::new("fill.continuous.strips.THIN_CRUMB", 0.1);
/// Where strips touch, a square that reaches this far to each side is cut out, in beads. Source: derived.
/// The two beads of a strip lie one bead apart, so two squares that reach half a bead would cut the strip
/// through; a quarter of a bead leaves half of the strip's width.
const PARTED_BEADS: f64 = 0.25;
/// Distance between neighbouring points of a strip's outline, in beads.
/// Measured: row `fill.continuous.strips.STEP_BEADS` of `cargo xtask bench constants`.
static STEP_BEADS: Tuned<f64> = Tuned::new("fill.continuous.strips.STEP_BEADS", 1.0);
/// Where an outline is straight, up to this number of its steps become one.
/// Measured: row `fill.continuous.strips.LONGEST_STEPS` of `cargo xtask bench constants`.
static LONGEST_STEPS: Tuned<usize> = Tuned::new("fill.continuous.strips.LONGEST_STEPS", 3);
/// An outline is straight where its points lie nearer to the chord than this, in beads.
/// Measured: row `fill.continuous.strips.STRAIGHT_BEADS` of `cargo xtask bench constants`.
static STRAIGHT_BEADS: Tuned<f64> = Tuned::new("fill.continuous.strips.STRAIGHT_BEADS", 0.005);
/// Least weight of the field, used where the stress is nearly zero. The largest weight is 1.
/// Measured: row `fill.continuous.strips.LEAST_WEIGHT` of `cargo xtask bench constants`.
static LEAST_WEIGHT: Tuned<f64> = Tuned::new("fill.continuous.strips.LEAST_WEIGHT", 0.1);
/// How many rounds the phase is diffused at each width.
/// Measured: row `fill.continuous.strips.DIFFUSION_ROUNDS` of `cargo xtask bench constants`.
static DIFFUSION_ROUNDS: Tuned<usize> = Tuned::new("fill.continuous.strips.DIFFUSION_ROUNDS", 3);
/// Factor on all widths of the diffusion of the phase.
/// Measured: row `fill.continuous.strips.DIFFUSION_SCALE` of `cargo xtask bench constants`.
static DIFFUSION_SCALE: Tuned<f64> = Tuned::new("fill.continuous.strips.DIFFUSION_SCALE", 1.0);
/// Each round of the phase's diffusion is solved to this residual, as a share of the right side. Measured: row
/// `fill.continuous.strips.PHASE_TOLERANCE` of `cargo xtask bench constants`. With 0.1 `hook-wide` of `grainpath new continuous` has
/// 39.6 m of fibre for 41.6, in the mean of eight sizes of elements.
static PHASE_TOLERANCE: Tuned<f64> = Tuned::new("fill.continuous.strips.PHASE_TOLERANCE", 0.01);
/// The drift of the spacing is solved to this residual, as a share of the right side. Measured: row
/// `fill.continuous.strips.DRIFT_TOLERANCE` of `cargo xtask bench constants`.
static DRIFT_TOLERANCE: Tuned<f64> = Tuned::new("fill.continuous.strips.DRIFT_TOLERANCE", 0.001);

/// How the phase is diffused. Wide steps arrange the strips of the whole region, narrow steps adjust their borders.
fn diffusion() -> Diffusion<4> {
    let step = |width: f64| (width * DIFFUSION_SCALE.value(), DIFFUSION_ROUNDS.value());
    Diffusion { steps: [60.0, 25.0, 8.0, 3.0].map(step), n_coarse: 0, tolerance: PHASE_TOLERANCE.value() }
}

/// The outlines of all strips of a region at this bead spacing. They are closed, lie inside the region and
/// have the strip on their left. Where a strip ends at the border, its outline follows the region's
/// contour.
pub(super) fn outlines(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    pull: &Pull<'_>,
    spacing_mm: f64,
) -> Vec<Vec<DVec2>> {
    let region = Region::from(infill_region.clone());
    let whole = || vec![infill_region.outer.clone()];
    let Some(field) = context.field else { return whole() };
    let cell_mm = (infill_region.area_mm2() / MANY_NODES.value()).sqrt();
    let cell_mm = cell_mm.clamp(MESH_MIN.value() * spacing_mm, MESH_MAX.value() * spacing_mm)
        * context.shift.grid_factor();
    // The rows turn with the part, and so do the strips.
    let Some(mesh) = FieldMesh::along(&region, cell_mm, field.rows()) else { return Vec::new() };
    let (axes, strength): (Vec<DVec2>, Vec<f64>) = mesh
        .nodes
        .iter()
        .map(|&p| pull.at(p))
        .map(|(axis, w)| (axis, w.clamp(LEAST_WEIGHT.value(), 1.0)))
        .unzip();
    // One turn of the phase is a whole strip, two beads wide.
    let frequency =
        drift(&mesh, &axes, DRIFT_TOLERANCE.value()).into_iter().map(|f| f / (2.0 * spacing_mm)).collect();
    let near = NearBorder::new(&region, BORDER_CELL * (2.0 * spacing_mm));
    let wanted = mesh
        .nodes
        .iter()
        .zip(&axes)
        // At the border the phase is a quarter turn. The cosine changes sign there, so the outermost bead
        // follows the border.
        .map(|(&p, axis)| near.wanted(p, *axis, 2.0 * spacing_mm, 0.25))
        .collect();
    let input = PhaseInput { axes, frequency, strength, wanted };
    let turns = turns(&mesh, &input);
    let phase = solve(&mesh, &input, &turns, &diffusion());
    let mut lines = sign_changes(&mesh, &turns, &phase);
    for line in &mut lines {
        // The triangulation's zigzag is smoothed once only: stronger smoothing would pull the caps
        // of strips inwards.
        line.points = resampled(&line.points, line.closed, STEP_BEADS.value() * spacing_mm);
        smooth(&mut line.points, line.closed, 1);
        line.points = sparse(&line.points, line.closed, STRAIGHT_BEADS.value() * spacing_mm);
    }
    let loops = cut_by(&region, &lines).unwrap_or_else(whole);
    with_thin(&region, loops, spacing_mm).into_iter().filter(|l| l.len() > 2).collect()
}

/// Removes points of a line that lie on the straight line between their neighbours.
fn sparse(points: &[DVec2], closed: bool, off_mm: f64) -> Vec<DVec2> {
    let n = points.len();
    let mut out = Vec::with_capacity(n / 2 + 2);
    let end = if closed { n } else { n - 1 };
    let mut at = 0;
    while at < end {
        out.push(points[at]);
        let straight = |to: usize| {
            let (a, d) = (points[at], points[to % n] - points[at]);
            let most = off_mm * d.length();
            (at + 1..to).all(|k| cross(d, points[k] - a).abs() < most && d.dot(points[k] - a) > 0.0)
        };
        let furthest = (at + 2..=(at + LONGEST_STEPS.value()).min(end)).take_while(|&to| straight(to)).last();
        at = furthest.unwrap_or(at + 1);
    }
    if !closed {
        out.push(points[n - 1]);
    }
    out
}

/// The outlines of a region, with strips along its border before those along the field, where the layer asks for them.
pub(super) fn with_border(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    pull: &Pull<'_>,
    spacing_mm: f64,
) -> Vec<Vec<DVec2>> {
    let n = context.shift.border_beads(spacing_mm, 2);
    if n == 0 {
        return outlines(context, infill_region, pull, spacing_mm);
    }
    let mut rest = Region::from(infill_region.clone());
    let mut loops: Vec<Vec<DVec2>> = Vec::new();
    for k in 0..n {
        // The strip lies on the left of its outline: inside of the outer bead, and outside of the inner one.
        let turned = |c: &Vec<DVec2>| if k % 2 == 0 { c.clone() } else { c.iter().rev().copied().collect() };
        loops.extend(rest.contours().map(turned));
        rest = rest.offset(-spacing_mm, Join::Miter(2.0));
    }
    loops.extend(rest.polygons.iter().flat_map(|p| outlines(context, p, pull, spacing_mm)));
    loops.retain(|l| l.len() > 2);
    loops
}

/// Adds the parts of a region too thin for two strips side by side as strips of their own, whatever the
/// field says. Each is outlined by two beads along its sides.
fn with_thin(region: &Region, loops: Vec<Vec<DVec2>>, spacing_mm: f64) -> Vec<Vec<DVec2>> {
    let thick = region.opened(0.5 * THIN_BEADS.value() * spacing_mm);
    let mut thin = region.difference(&thick);
    // Every corner of a region is thin in this sense. So small parts count only if they connect two thick
    // parts.
    thin.polygons.retain(|p| {
        let is_neck = || {
            let grown = Region::from(p.clone()).offset(THIN_GROWN.value() * spacing_mm, Join::Miter(2.0));
            grown.intersection(&thick).polygons.len() > 1
        };
        p.area_mm2() > spacing_mm * spacing_mm || is_neck()
    });
    if thin.is_empty() {
        return loops;
    }
    let strips = Region::from_contours(&loops, FillRule::Positive);
    // The thin parts are grown a little, so that they overlap the strips they touch and merge with
    // them.
    let thin = thin.offset(THIN_GROWN.value() * spacing_mm, Join::Miter(2.0)).intersection(region);
    let mut all = strips.union(&thin);
    all.polygons.retain(|p| p.area_mm2() > THIN_CRUMB.value() * spacing_mm * spacing_mm);
    all.contours().cloned().collect()
}

/// Separates outlines of strips at the places `at` where they touch.
pub(super) fn parted(loops: &[Vec<DVec2>], at: &[DVec2], spacing_mm: f64) -> Vec<Vec<DVec2>> {
    let half = DVec2::splat(PARTED_BEADS * spacing_mm);
    let squares = at.iter().flat_map(|&p| Region::rectangle(p - half, p + half).polygons);
    let squares: Vec<Vec<DVec2>> = squares.map(|p| p.outer).collect();
    let all = Region::from_contours(loops, FillRule::Positive)
        .difference(&Region::from_contours(&squares, FillRule::NonZero));
    all.contours().filter(|l| l.len() > 2).cloned().collect()
}

/// A line on which the cosine changes sign, with the strip on its left. Open lines end outside the
/// region.
struct Line {
    points: Vec<DVec2>,
    closed: bool,
}

fn sign_changes(mesh: &FieldMesh, turns: &[Turn], phase: &[f64]) -> Vec<Line> {
    // Sign changes of the cosine lie at odd multiples of a quarter turn.
    let found = EdgePoints::new(mesh, turns, phase, PI, 0.5);
    let EdgePoints { starts, points } = &found;
    let edge_of = |point: u32| starts.partition_point(|&start| start <= point) - 1;
    let is_strip = |node: u32| cos(off_lines_rad(phase, node as usize)) < 0.0;
    let line = |(line, closed): (Vec<u32>, bool)| {
        // The first pair of points on different edges of a triangle shows on which side the strip
        // lies. A line whose points are all on one edge encloses no area, so it is no strip.
        let w = line.windows(2).find(|w| edge_of(w[0]) != edge_of(w[1]))?;
        let e = edge_of(w[0]);
        let end = mesh.edges[e].ends[0];
        let odd = (w[0] - starts[e]) % 2 == 1;
        let [p, q] = [points[w[0] as usize], points[w[1] as usize]];
        let left = cross(q - p, mesh.nodes[end as usize] - p) > 0.0;
        let mut points: Vec<DVec2> = line.iter().map(|&k| points[k as usize]).collect();
        // Other sign changes may lie between the edge's first node and the point. Each of them swaps the
        // sides.
        if left != (is_strip(end) ^ odd) {
            points.reverse();
        }
        Some(Line { points, closed })
    };
    joints(mesh, &found).lines().into_iter().filter_map(line).collect()
}

/// Joins the points around each triangle. There the cosine changes sign an even number of times, so every
/// point finds a partner. Where a turn of the phase is missing, neighbouring points on the same side are
/// joined: there a strip ends, or the gap between two strips.
fn joints(mesh: &FieldMesh, found: &EdgePoints) -> Joints {
    let mut joints = Joints::new(found.points.len());
    for t in &mesh.triangles {
        let count = found.counts(t);
        let most = (0..3).fold(0, |m, k| if count[k] > count[m] { k } else { m });
        let others = count[(most + 1) % 3] + count[(most + 2) % 3];
        let from = |side: usize, corner: usize, p: u32| found.corner_point(mesh, t, side, corner, p);
        for corner in 0..3 {
            let sides = [(corner + 1) % 3, (corner + 2) % 3];
            // If one side has more points than the other two together, all points of those two are joined
            // to it, and its surplus points are joined in pairs along the side.
            let around = if count[most] > others {
                if corner == most { 0 } else { count[3 - corner - most] }
            } else {
                (count[sides[0]] + count[sides[1]] - count[corner]) / 2
            };
            for p in 0..around {
                joints.join(from(sides[0], corner, p), from(sides[1], corner, p));
            }
        }
        if count[most] > others {
            let corner = (most + 1) % 3;
            let first = count[3 - corner - most];
            for k in 0..(count[most] - others) / 2 {
                joints.join(from(most, corner, first + 2 * k), from(most, corner, first + 2 * k + 1));
            }
        }
    }
    joints
}

/// A point where a piece of a line meets the region's border.
struct Meeting {
    contour: usize,
    edge: usize,
    /// Position along the edge of the contour, mm.
    along_mm: f64,
    at: DVec2,
    piece: usize,
    leaves: bool,
}

/// Closed outlines of the area that lies inside the region and to the left of the lines. `None` if rounding
/// makes it unclear where lines and contours cross.
fn cut_by(region: &Region, lines: &[Line]) -> Option<Vec<Vec<DVec2>>> {
    let clipper = LineClipper::new(region);
    let contours: Vec<&Vec<DVec2>> = region.contours().collect();
    let mut pieces: Vec<Vec<DVec2>> = Vec::new();
    let mut meetings: Vec<Meeting> = Vec::new();
    let mut loops = Vec::new();
    for line in lines {
        let n = line.points.len();
        let first_piece = pieces.len();
        let starts_inside = clipper.contains(line.points[0]);
        let mut current = starts_inside.then(|| vec![line.points[0]]);
        let mut crossed = false;
        for i in 0..if line.closed { n } else { n - 1 } {
            let (a, b) = (line.points[i], line.points[(i + 1) % n]);
            for c in clipper.crossings(a, b) {
                crossed = true;
                let at = a.lerp(b, c.t);
                let contour = contours[c.contour];
                let along_mm = at.distance(contour[c.edge]);
                let leaves = current.is_some();
                let piece = pieces.len();
                meetings.push(Meeting { contour: c.contour, edge: c.edge, along_mm, at, piece, leaves });
                match current.take() {
                    Some(mut points) => {
                        points.push(at);
                        pieces.push(points);
                    }
                    None => current = Some(vec![at]),
                }
            }
            if let Some(points) = &mut current {
                points.push(b);
            }
        }
        let Some(mut rest) = current else { continue };
        if !crossed {
            if line.closed {
                rest.pop();
                loops.push(rest);
            }
            continue;
        }
        // An open line ends inside, or a closed line left without coming back: rounding has hidden a
        // crossing.
        if !(line.closed && starts_inside) {
            return None;
        }
        // A closed line's last piece continues in its first one.
        let head = &mut pieces[first_piece];
        rest.pop();
        rest.append(head);
        *head = rest;
        let last = pieces.len();
        meetings.iter_mut().rev().take(1).filter(|m| m.piece == last).for_each(|m| m.piece = first_piece);
    }
    let key = |m: &Meeting| (m.contour, m.edge);
    meetings.sort_by(|a, b| key(a).cmp(&key(b)).then(a.along_mm.total_cmp(&b.along_mm)));
    // From the end of each piece the outline follows the contour to the start of the next piece.
    let mut next: Vec<Option<(usize, Vec<DVec2>)>> = pieces.iter().map(|_| None).collect();
    for group in meetings.chunk_by(|a, b| a.contour == b.contour) {
        let contour = contours[group[0].contour];
        for (k, m) in group.iter().enumerate().filter(|(_, m)| m.leaves) {
            let to = &group[(k + 1) % group.len()];
            // Along a contour, ends and starts of pieces alternate, unless rounding has swapped two
            // crossings.
            if to.leaves {
                return None;
            }
            let n = contour.len();
            let mut way = Vec::new();
            let wraps = to.edge < m.edge || (to.edge == m.edge && to.along_mm < m.along_mm);
            let steps = to.edge + if wraps { n } else { 0 } - m.edge;
            way.extend((1..=steps).map(|s| contour[(m.edge + s) % n]));
            if m.at == to.at && steps == 0 {
                way.clear();
            }
            next[m.piece] = Some((to.piece, way));
        }
    }
    let mut used = vec![false; pieces.len()];
    for first in 0..pieces.len() {
        if used[first] {
            continue;
        }
        let mut ring: Vec<DVec2> = Vec::new();
        let mut at = first;
        while !used[at] {
            used[at] = true;
            ring.append(&mut pieces[at]);
            let (to, way) = next[at].take()?;
            ring.extend(way);
            at = to;
        }
        if at != first {
            return None;
        }
        loops.push(ring);
    }
    // Contours that no line touches lie in a strip or in a gap as a whole.
    let touched: Vec<usize> = meetings.iter().map(|m| m.contour).collect();
    for (c, contour) in contours.iter().enumerate() {
        if touched.binary_search(&c).is_err() && in_strip(contour[0], lines) {
            loops.push((*contour).clone());
        }
    }
    Some(loops)
}

/// Whether a point lies left of the nearest line. Without lines the whole region is one strip.
fn in_strip(p: DVec2, lines: &[Line]) -> bool {
    let mut best = (f64::INFINITY, true);
    for line in lines {
        let n = line.points.len();
        for i in 0..if line.closed { n } else { n - 1 } {
            let (a, b) = (line.points[i], line.points[(i + 1) % n]);
            let off = segment::distance_squared_mm2(p, a, b);
            if off < best.0 {
                best = (off, cross(b - a, p - a) > 0.0);
            }
        }
    }
    best.1
}
