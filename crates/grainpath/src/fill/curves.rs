//! Lays beads along given curves, and fills the space between them with new lines until no more bead fits in.
//!
//! Preset `woodgrain` lays the edges of a photograph in this way. Curves come in order of importance. A
//! curve is cut where it comes nearer to an earlier curve than beads may lie. The open area between curves
//! is filled with lines that follow the flow. They start one spacing beside every line, and then in the
//! remaining gaps (`Jobard1997`). At full density each bead is as wide as its space, within `STRIP` of the
//! spacing. Below full density the spacing follows the density and, if wanted, the darkness of the
//! picture.
//!
//! Lines keep apart because every point of a new line is looked up among the points of all others
//! before it is kept. Lengths are in mm. Cost: linear in the points laid; a lookup visits a few
//! buckets.

use std::f64::consts::PI;

use grainpath_core::buckets::PointGrid2;
use grainpath_core::math::cross;
use grainpath_core::poly::LineClipper;
use grainpath_core::polyline::{length_mm, resampled};
use grainpath_core::units::bead_width_mm;
use grainpath_core::{BeadWidth, Bounds2, DVec2, Polygon, Region, Toolpath, segment};

use crate::fill::FillContext;

/// Least distance of a new line's seed from all other lines, as a share of the spacing. Two lines are then
/// at most twice this distance apart, because a wider gap would take another seed.
const CLOSEST: f64 = 0.75;
/// A line ends where its distance to another line falls to this share of the closest distance. The share is
/// below 1, so that converging lines run side by side for a while before one of them ends.
const GO_ON: f64 = 0.72;
/// Distance of neighbouring points of a line, as a share of the closest distance.
const STEP: f64 = 0.33;
/// Longest step along a line, mm. It lets sparse lines bend as finely as dense ones.
const LONGEST_STEP_MM: f64 = 0.25;
/// Narrowest and widest strip of a bead, as shares of the spacing.
const STRIP: [f64; 2] = [0.6, 1.5];
/// Points that lie nearer to a chord than this are dropped, mm.
const STRAIGHT_MM: f64 = 0.008;

/// The field that lines follow between the given curves.
pub struct Flow<'a> {
    /// The direction; only its axis counts, not its sign.
    pub axis: &'a dyn Fn(DVec2) -> DVec2,
    /// Factor on the mean distance of lines; it has an effect only below full density.
    pub sparseness: Option<&'a dyn Fn(DVec2) -> f64>,
}

/// Fills an infill region with the given curves, in their order of importance, and with lines along
/// the flow between them.
pub(crate) fn lay_curves(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    curves: &[Vec<DVec2>],
    flow: &Flow<'_>,
    out: &mut Vec<Toolpath>,
) {
    let spacing_mm = context.spacing_mm() / context.density.fraction();
    let Some(bounds) = infill_region.bounds() else { return };
    if !(spacing_mm.is_finite() && infill_region.area_mm2() > 1e-6) {
        return;
    }
    let region = Region::from(infill_region.clone());
    let mut layer = Layout {
        clipper: LineClipper::new(&region),
        flow,
        closest_mm: CLOSEST * spacing_mm,
        step_mm: (STEP * CLOSEST * spacing_mm).min(LONGEST_STEP_MM),
        lines: Vec::new(),
        bounds,
        near: PointGrid2::new(bounds, CLOSEST * spacing_mm),
        border: BorderDistance::new(infill_region, spacing_mm),
        off_border_mm: if context.density.is_dense() { 0.0 } else { 0.5 * spacing_mm },
    };
    // Shorter lines hardly show, and each costs a start and a stop. Sparse fill can drop longer lines than
    // dense fill, because `sparse_paths` makes up for them by the bead width.
    let least_mm = if context.density.is_dense() { 1.5 * spacing_mm } else { 2.0 * spacing_mm };
    // Given curves come first, because lines of the flow must give way to the edges of the
    // picture.
    layer.take(curves, 2.0 * spacing_mm);
    layer.beside_lines(spacing_mm, least_mm);
    layer.in_gaps(bounds, least_mm);
    if context.density.is_dense() {
        let strips = |i| layer.strips(i, spacing_mm, context.border_mm);
        let widths: Vec<Vec<f64>> = (0..layer.lines.len()).map(strips).collect();
        dense_paths(context, infill_region, layer.lines, widths, out);
    } else {
        sparse_paths(context, infill_region, layer.lines, out);
    }
}

/// One line of a layout.
struct Line {
    points: Vec<DVec2>,
    closed: bool,
    /// Index in `points` of the point that has number 0 in `near`. Points laid backwards from the seed have
    /// negative numbers.
    first: i32,
}

struct Layout<'a> {
    clipper: LineClipper,
    flow: &'a Flow<'a>,
    closest_mm: f64,
    step_mm: f64,
    lines: Vec<Line>,
    bounds: Bounds2,
    /// The points of all lines, each with the line and the point's number on it.
    near: PointGrid2<(u32, i32)>,
    border: BorderDistance,
    /// Least distance of a seed from the border, mm. Below full density it keeps lines away from the wall
    /// along the border.
    off_border_mm: f64,
}

impl Layout<'_> {
    /// The least distance between lines at a point, mm.
    fn closest_at(&self, p: DVec2) -> f64 {
        // The range bounds the contrast of the picture: in a black patch beads would otherwise overlap, and
        // a white patch would become a visible hole.
        self.closest_mm * self.flow.sparseness.map_or(1.0, |s| s(p).clamp(0.4, 2.5))
    }

    /// Whether every point that `counts` accepts, by line and number, is farther away than `distance_mm`.
    fn open(&self, p: DVec2, distance_mm: f64, counts: impl Fn(u32, i32) -> bool) -> bool {
        !self.near.within(p, distance_mm).any(|(_, (line, index))| counts(line, index))
    }

    /// Points fewer steps back along a line than this do not count as its neighbours. The number is that of
    /// the steps around a circle whose diameter is 1.6 times the closest distance: the tightest loop that
    /// leaves space inside.
    fn lag(&self) -> usize {
        (1.6 * PI * self.closest_mm / self.step_mm).ceil() as usize
    }

    /// Lays the curves in their order, and of each the parts that keep the distance to earlier curves.
    fn take(&mut self, curves: &[Vec<DVec2>], least_mm: f64) {
        for curve in curves {
            for piece in self.clipper.clip(curve) {
                let points = resampled(&piece.points, false, self.step_mm);
                let mut run: Vec<DVec2> = Vec::new();
                for &p in &points {
                    // There are two thresholds, as in Canny's hysteresis: a run starts only where the curve
                    // is clear of all others, but continues through places that are a little too close. A
                    // single threshold would cut a curve at every small bend of its neighbour. Earlier runs
                    // of the same curve count as well, so that it cannot cross itself.
                    let share = if run.is_empty() { 0.95 } else { GO_ON };
                    let is_free = self.open(p, share * self.closest_at(p), |_, _| true);
                    if is_free && !self.meets_itself(&run, p) {
                        run.push(p);
                    } else {
                        self.keep(std::mem::take(&mut run), least_mm);
                    }
                }
                self.keep(run, least_mm);
            }
        }
    }

    /// Whether a line returns to a place that it passed more than a few steps ago.
    fn meets_itself(&self, run: &[DVec2], p: DVec2) -> bool {
        let lag = self.lag();
        // A linear search is enough: a curve of a photograph seldom has more than a few thousand points.
        run.len() > lag
            && run[..run.len() - lag].iter().step_by(2).any(|q| q.distance(p) < 0.9 * self.closest_mm)
    }

    fn keep(&mut self, points: Vec<DVec2>, least_mm: f64) {
        if points.len() > 1 && length_mm(&points, false) >= least_mm {
            let id = self.lines.len() as u32;
            points.iter().enumerate().for_each(|(k, &p)| self.near.insert(p, (id, k as i32)));
            // A curve that ends in an open area is continued along the field.
            let n = points.len();
            let (first, last) = (points[0], points[n - 1]);
            let heading = (last - points[n.saturating_sub(4)]).normalize_or_zero();
            let ahead = self.follow(last, heading, n as i32 - 1, 1).0;
            let heading = (first - points[3.min(n - 1)]).normalize_or_zero();
            let back = self.follow(first, heading, 0, -1).0;
            let shift = back.len() as i32;
            let points = back.into_iter().rev().chain(points).chain(ahead).collect();
            self.lines.push(Line { points, closed: false, first: shift });
        }
    }

    /// Seeds new lines one spacing beside each line, then beside the new lines, and so on.
    fn beside_lines(&mut self, spacing_mm: f64, least_mm: f64) {
        let mut next = 0;
        while next < self.lines.len() {
            let n = self.lines[next].points.len();
            let every = ((spacing_mm / self.step_mm) as usize).max(1);
            for k in (0..n).step_by(every) {
                let points = &self.lines[next].points;
                let tangent = (points[(k + 1).min(n - 1)] - points[k.saturating_sub(1)]).normalize_or_zero();
                let p = points[k];
                for side in [tangent.perp(), -tangent.perp()] {
                    // A seed lies a full spacing away, although the closest distance would be allowed.
                    // So a line starts at the wanted spacing, and only a converging field brings it
                    // nearer.
                    let apart = self.closest_at(p) / CLOSEST;
                    self.seed(p + apart * side, least_mm);
                }
            }
            next += 1;
        }
    }

    /// Seeds lines in all remaining gaps, where the distance to every line is above the closest distance.
    fn in_gaps(&mut self, bounds: Bounds2, least_mm: f64) {
        let step = 0.6 * self.closest_mm;
        let count = |mm: f64| (mm / step) as usize + 1;
        let (nx, ny) = (count(bounds.size().x), count(bounds.size().y));
        let first = self.lines.len();
        // Seeds are tried on a raster of 0.6 times the closest distance; a smaller gap may be
        // missed.
        for j in 0..ny {
            for i in 0..nx {
                self.seed(bounds.min + step * DVec2::new(i as f64 + 0.5, j as f64 + 0.5), least_mm);
            }
        }
        debug_assert!(first <= self.lines.len());
    }

    /// Lays a new line through `p` if it keeps its distance from all others.
    fn seed(&mut self, p: DVec2, least_mm: f64) {
        if !self.clipper.contains(p) || !self.open(p, self.closest_at(p), |_, _| true) {
            return;
        }
        let start = (self.flow.axis)(p).normalize_or_zero();
        if start == DVec2::ZERO || self.border.distance(p) < self.off_border_mm {
            return;
        }
        let id = self.lines.len() as u32;
        // The seed is entered before the line is followed, so that each half of the line keeps away from
        // where the line began.
        self.near.insert(p, (id, 0));
        let (ahead, closed) = self.follow(p, start, 0, 1);
        let back = if closed { Vec::new() } else { self.follow(p, -start, 0, -1).0 };
        let first = back.len() as i32;
        let points: Vec<DVec2> = back.into_iter().rev().chain([p]).chain(ahead).collect();
        if points.len() > 1 && length_mm(&points, false) >= least_mm {
            self.lines.push(Line { points, closed, first });
        } else {
            // The points of a rejected line must not keep other lines away.
            points.iter().for_each(|&q| {
                self.near.remove(q, |(line, _)| line == id);
            });
        }
    }

    /// Follows the axis from `p` until the line meets the region's border, another line or its own
    /// beginning, or closes. Returns the points and whether the line is closed. Points are numbered from
    /// `from` at `p`, in steps of `count`: 1 ahead, -1 backwards.
    fn follow(&mut self, p: DVec2, heading: DVec2, from: i32, count: i32) -> (Vec<DVec2>, bool) {
        let h = self.step_mm;
        let flow = self.flow;
        let along = |at: DVec2, heading: DVec2| {
            let a = (flow.axis)(at);
            if a.dot(heading) < 0.0 { -a } else { a }
        };
        let id = self.lines.len() as u32;
        let lag = self.lag() as i32;
        let start = heading;
        let (mut at, mut heading) = (p, heading);
        let mut out: Vec<DVec2> = Vec::new();
        for k in 1..MAX_STEPS {
            // The midpoint rule is of second order. With Euler's steps a closed line of a circular field
            // would spiral outwards.
            let half = along(at, heading);
            let step = along(at + 0.5 * h * half, half);
            // Around a singular point of the field the axis may turn by more than 60 degrees within
            // a step. A bead cannot follow that.
            if step.dot(heading) < 0.5 {
                break;
            }
            let next = at + h * step;
            let index = from + count * k as i32;
            let own = |i: i32| (i - index).abs() > lag;
            // The line ends exactly on the border, so that it touches the wall whatever the step. This
            // last point is left out if it is too near to another line, or nearly equal to the point
            // before.
            if let Some(hit) = self.clipper.crossings(at, next).first() {
                let edge = at.lerp(next, hit.t);
                let clear_mm = GO_ON * self.closest_mm;
                // Points of the same line count too, except its most recent ones.
                if edge.distance(at) > 0.05 * h && self.open(edge, clear_mm, |line, i| line != id || own(i)) {
                    out.push(edge);
                    self.near.insert(edge, (id, index));
                }
                break;
            }
            // A line that starts on the border crosses no edge on its way out, so its first point is tested
            // separately.
            let b = self.bounds;
            let left = next.cmplt(b.min).any() || next.cmpgt(b.max).any();
            if left || (k == 1 && !self.clipper.contains(next)) {
                break;
            }
            if !self.open(next, GO_ON * self.closest_at(next), |line, _| line != id) {
                break;
            }
            let came_round =
                k as i32 > 2 * lag && next.distance(p) < 1.05 * self.closest_mm && step.dot(start) > 0.8;
            // Only the first half of a line, followed ahead from its seed, can close: the other
            // half would meet the first.
            if came_round && count > 0 && from == 0 {
                return (out, true);
            }
            if !self.open(next, 0.95 * self.closest_mm, |line, i| line == id && own(i)) {
                break;
            }
            out.push(next);
            self.near.insert(next, (id, index));
            (at, heading) = (next, step);
        }
        (out, false)
    }

    /// For each point of a line, the width of its strip, mm. On each side the strip reaches half way to the
    /// next line, or to the border of the area to be filled.
    fn strips(&self, i: usize, spacing_mm: f64, border_mm: f64) -> Vec<f64> {
        let line = &self.lines[i];
        let n = line.points.len();
        let [least, most] = STRIP.map(|s| 0.5 * s * spacing_mm);
        let of_point = |k: usize| {
            let p = line.points[k];
            let tangent =
                (line.points[(k + 1).min(n - 1)] - line.points[k.saturating_sub(1)]).normalize_or_zero();
            let mut sides = [most; 2];
            let mut look = |q: DVec2, share: f64| {
                let d = q - p;
                let across = cross(tangent, d);
                let side = usize::from(across > 0.0);
                // Points of the neighbour that lie ahead or behind are seen at a slant. Only those within
                // 45 degrees of the normal measure the distance across.
                if d.dot(tangent).abs() < across.abs() {
                    sides[side] = sides[side].min(share * across.abs());
                }
            };
            let lag = self.lag() as i32;
            self.near.within(p, 2.0 * most).for_each(|(q, (other, index))| {
                let apart = (index + line.first - k as i32).abs();
                // The ends of a closed line are neighbours.
                let apart = if line.closed { apart.min(n as i32 - apart) } else { apart };
                if other != i as u32 || apart > lag {
                    look(q, 0.5);
                }
            });
            let edge = self.border.distance(p);
            if edge < most {
                // Only the distance of the border is known, not its side. It is assumed on the side on
                // which the nearest line is farther away.
                let side = usize::from(sides[1] > sides[0]);
                sides[side] = sides[side].min(edge + border_mm);
            }
            // Each side has its own lower bound: a bead is symmetric about its centreline, so space on one
            // side cannot be used by the other.
            sides[0].max(least) + sides[1].max(least)
        };
        let raw: Vec<f64> = (0..n).map(of_point).collect();
        // Melt pressure follows a change of flow slowly, so the width is averaged over seven
        // points.
        (0..n)
            .map(|k| {
                let r = 3.min(k).min(n - 1 - k);
                raw[k - r..=k + r].iter().sum::<f64>() / (2 * r + 1) as f64
            })
            .collect()
    }
}

/// Most points of one line, in case a field never ends it. Source: derived: 100 000 steps of 0.25 mm
/// are 25 m, which fills 11 000 mm2 at a spacing of 0.45 mm with a single line.
const MAX_STEPS: usize = 100_000;

/// Distance to the border of an infill region, for points near it.
struct BorderDistance {
    near: PointGrid2<()>,
    reach_mm: f64,
}

impl BorderDistance {
    fn new(infill_region: &Polygon, reach_mm: f64) -> Self {
        let bounds = infill_region.bounds().unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let mut near = PointGrid2::new(bounds, reach_mm);
        for contour in infill_region.contours() {
            for (a, b) in grainpath_core::poly::edges(contour) {
                // The points lie a fifth of the reach apart. So the nearest of them is off by at most a
                // tenth of the reach along the border, and a distance of half the reach is wrong by 2
                // %.
                let n = (a.distance(b) / (0.2 * reach_mm)).ceil().clamp(1.0, 1e5) as usize;
                (0..n).for_each(|k| near.insert(a.lerp(b, k as f64 / n as f64), ()));
            }
        }
        Self { near, reach_mm }
    }

    /// The distance, or infinity beyond the reach.
    fn distance(&self, p: DVec2) -> f64 {
        let mut best = f64::INFINITY;
        self.near.within(p, self.reach_mm).for_each(|(q, ())| best = best.min(q.distance_squared(p)));
        best.sqrt()
    }
}

/// The volume to be printed: that of the region and of the strips between it and the wall around it.
fn wanted_mm3(context: &FillContext<'_>, infill_region: &Polygon) -> f64 {
    // Source: derived: a rectangle grown by b on all sides gains its perimeter times b and four
    // corners of b x b. Other regions differ in the corners alone.
    let area = infill_region.area_mm2()
        + context.border_mm * (infill_region.perimeter_mm() + 4.0 * context.border_mm);
    area * context.height_mm * context.density.fraction()
}

fn dense_paths(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    lines: Vec<Line>,
    strips: Vec<Vec<f64>>,
    out: &mut Vec<Toolpath>,
) {
    let height = context.height_mm;
    // A bead fills exactly the cross-section of its strip, so the widths of strips give the volume.
    let each = |(line, widths): (&Line, &Vec<f64>)| {
        let mean = |k: usize| 0.5 * (widths[k] + widths[(k + 1) % widths.len()]);
        let n = if line.closed { line.points.len() } else { line.points.len() - 1 };
        let length = |k: usize| line.points[k].distance(line.points[(k + 1) % line.points.len()]);
        (0..n).map(|k| mean(k) * length(k)).sum::<f64>()
    };
    let laid: f64 = lines.iter().zip(&strips).map(each).sum::<f64>() * height;
    // The factor corrects for the rounding of many strips. A value outside the range means that lines are
    // missing; wider beads would not make up for them there.
    let factor = (wanted_mm3(context, infill_region) / laid.max(1e-9)).clamp(0.96, 1.08);
    for (line, strips) in lines.into_iter().zip(strips) {
        let widths: Vec<f64> = strips.iter().map(|s| bead_width_mm(factor * s, height)).collect();
        let kept = kept(&line.points, &widths);
        let mut path = Toolpath::new(
            kept.iter().map(|&k| line.points[k]).collect(),
            context.bead_width_mm,
            context.role,
            line.closed,
        );
        path.width = BeadWidth::PerVertex(kept.iter().map(|&k| widths[k]).collect());
        out.push(path);
    }
}

fn sparse_paths(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    lines: Vec<Line>,
    out: &mut Vec<Toolpath>,
) {
    let first = out.len();
    for line in lines {
        let kept = kept(&line.points, &vec![0.0; line.points.len()]);
        let points = kept.iter().map(|&k| line.points[k]).collect();
        out.push(Toolpath::new(points, context.bead_width_mm, context.role, line.closed));
    }
    // Lines are laid whole or left out, so the length laid misses the density by a little. The bead width
    // is corrected for it, by 15 % at most.
    let laid: f64 = out[first..].iter().map(|p| p.volume_mm3(context.height_mm)).sum();
    let factor = (wanted_mm3(context, infill_region) / laid.max(1e-9)).clamp(0.85, 1.15);
    let spacing = factor * context.spacing_mm();
    let width = BeadWidth::Constant(bead_width_mm(spacing, context.height_mm));
    out[first..].iter_mut().for_each(|p| p.width = width.clone());
}

/// Indices of the points to keep. The line simplification of `douglas1973` is applied to position and width
/// together.
fn kept(points: &[DVec2], widths: &[f64]) -> Vec<usize> {
    let n = points.len();
    let mut keep = vec![false; n];
    (keep[0], keep[n - 1]) = (true, true);
    let mut stack = vec![(0, n - 1)];
    while let Some((lo, hi)) = stack.pop() {
        let far = (lo + 1..hi).fold((STRAIGHT_MM, usize::MAX), |best, k| {
            let (a, b, p) = (points[lo], points[hi], points[k]);
            let t = segment::closest_share(p, a, b);
            let aside = p.distance(a + t * (b - a));
            // An error of width counts 0.3 times an error of position: it is shared by the two sides of the
            // bead, and no outline depends on it.
            let wider = 0.3 * (widths[k] - widths[lo] - t * (widths[hi] - widths[lo])).abs();
            let off = aside.max(wider);
            if off > best.0 { (off, k) } else { best }
        });
        if far.1 != usize::MAX {
            keep[far.1] = true;
            stack.extend([(lo, far.1), (far.1, hi)]);
        }
    }
    (0..n).filter(|&k| keep[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::direction;
    use grainpath_core::{Density, Role};

    fn context(density: Density) -> FillContext<'static> {
        FillContext {
            z_mid_mm: 0.1,
            height_mm: 0.2,
            bead_width_mm: 0.45,
            min_bead_width_mm: 0.2,
            density,
            angle_rad: 0.0,
            part: Bounds2 { min: DVec2::ZERO, max: DVec2::new(40.0, 20.0) },
            role: Role::SparseFill,
            border_mm: 0.11,
            ends: grainpath_job::choices::BeadEnds::Joined,
            shift: crate::fill::Shift::NONE,
            below: None,
            fills_wedges: true,
            widths: grainpath_job::choices::BeadWidths::Variable,
            field: None,
        }
    }

    fn infill_region() -> Polygon {
        let hole = (0..60).rev().map(|i| DVec2::new(20.0, 10.0) + 3.0 * direction(f64::from(i) * PI / 30.0));
        Polygon {
            outer: Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 20.0)).polygons[0].outer.clone(),
            holes: vec![hole.collect()],
        }
    }

    /// Flow round the hole.
    fn axis(p: DVec2) -> DVec2 {
        let d = p - DVec2::new(20.0, 10.0);
        let (r2, a2) = (d.length_squared().max(1.0), 9.0);
        DVec2::new(1.0 - a2 * (d.x * d.x - d.y * d.y) / (r2 * r2), -2.0 * a2 * d.x * d.y / (r2 * r2))
            .normalize_or_zero()
    }

    fn seen() -> Vec<Vec<DVec2>> {
        let wavy = |y: f64| {
            (0..200).map(|i| DVec2::new(0.2 * f64::from(i), y + 0.3 * (f64::from(i) * 0.05))).collect()
        };
        vec![wavy(2.0), wavy(2.2), wavy(15.0)]
    }

    #[test]
    fn no_two_lines_cross_and_no_gap_is_left() {
        for density in [1.0, 0.3] {
            let context = context(Density::new(density));
            let mut paths = Vec::new();
            lay_curves(
                &context,
                &infill_region(),
                &seen(),
                &Flow { axis: &axis, sparseness: None },
                &mut paths,
            );
            let spacing = context.spacing_mm() / density;
            let region = Region::from(infill_region());
            let segments: Vec<(usize, DVec2, DVec2)> = paths
                .iter()
                .enumerate()
                .flat_map(|(i, p)| (0..p.n_segments()).map(move |k| (i, p.segment(k).0, p.segment(k).1)))
                .collect();
            for (n, &(i, a, b)) in segments.iter().enumerate() {
                for &(j, p, q) in &segments[n + 1..] {
                    let side = |u: DVec2, v: DVec2, w: DVec2| cross(v - u, w - u);
                    let apart = i == j
                        || side(a, b, p) * side(a, b, q) >= 0.0
                        || side(p, q, a) * side(p, q, b) >= 0.0;
                    assert!(apart, "{a} - {b} crosses {p} - {q}");
                }
                assert!(
                    region.offset(1e-3, grainpath_core::poly::Join::Miter(2.0)).contains(a) || n % 17 != 0
                );
            }
            let to_line = |p: DVec2| {
                let d = |&(_, a, b): &(usize, DVec2, DVec2)| segment::distance_squared_mm2(p, a, b);
                segments.iter().map(d).fold(f64::INFINITY, f64::min).sqrt()
            };
            let mut widest = 0.0f64;
            for j in 1..66 {
                for i in 1..133 {
                    let p = DVec2::new(0.3 * f64::from(i), 0.3 * f64::from(j));
                    if region.contains(p) {
                        widest = widest.max(to_line(p));
                    }
                }
            }
            assert!(
                widest < if density < 1.0 { 1.4 } else { 1.0 } * spacing,
                "density {density}: a place {widest:.2} mm from any line"
            );
            let volume: f64 = paths.iter().map(|p| p.volume_mm3(0.2)).sum();
            let share = volume / wanted_mm3(&context, &infill_region());
            assert!((share - 1.0).abs() < 0.02, "density {density}: {share} of the volume");
        }
    }

    /// An eight and a loop with long ends: both cross themselves.
    #[test]
    fn a_curve_that_crosses_itself_is_laid_without_a_crossing() {
        use grainpath_core::segment::{Meeting, meeting};
        let eight = (0..400).map(|i| {
            let t = f64::from(i) * PI / 200.0;
            DVec2::new(10.0 + 8.0 * direction(t).y, 10.0 + 6.0 * direction(2.0 * t).y)
        });
        let turn = |t: f64| DVec2::new(30.0 + 1.5 * (t - PI), 10.0) + 5.0 * direction(t - 0.5 * PI);
        let looped = (0..600).map(|i| turn(f64::from(i) * PI / 150.0 - PI));
        let curves = [eight.collect::<Vec<_>>(), looped.collect()];
        let outer = Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 20.0)).polygons[0].outer.clone();
        let square = Polygon { outer, holes: Vec::new() };
        for density in [1.0, 0.4, 0.3] {
            let mut paths = Vec::new();
            let flow = Flow { axis: &|_| DVec2::X, sparseness: None };
            lay_curves(&context(Density::new(density)), &square, &curves, &flow, &mut paths);
            let segments: Vec<[DVec2; 2]> = (paths.iter())
                .flat_map(|p| (0..p.n_segments()).map(|k| [p.segment(k).0, p.segment(k).1]))
                .collect();
            assert!(segments.len() > 100);
            for (n, &a) in segments.iter().enumerate() {
                for &b in &segments[n + 1..] {
                    assert_ne!(meeting(a, b), Meeting::Cross, "density {density}: {a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn points_are_dropped_only_where_the_line_is_straight() {
        let line: Vec<DVec2> =
            (0..100).map(|i| DVec2::new(0.1 * f64::from(i), if i == 50 { 0.1 } else { 0.0 })).collect();
        assert_eq!(kept(&line, &[0.4; 100]), [0, 49, 50, 51, 99]);
        assert_eq!(resampled(&line[..3], false, 0.05).len(), 5);
    }
}
