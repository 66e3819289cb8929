//! Joins pieces of lines, as of continuous fibre, by turns that keep a least radius.
//!
//! Two lines a bead apart cannot be joined by a turn that is wider than a bead. So a line returns several beads away, and
//! the turns of a group of lines lie inside each other along the border:
//!
//! ```text
//!    ===================================  border
//!      /-----------------------------\    turn of lines 1 and 9
//!      |   /---------------------\   |    turn of lines 2 and 8
//!      |   |   |   |   |   |   |  |  |
//!      1   2   3   4   5   6   7  8  9    lines 3 to 7 end: their turns would be narrower than two radii
//! ```
//!
//! The pieces are those of a fill that was cut at its sharp turns. [`joined`] takes five steps:
//!
//! 1. what is left of a hairpin goes from the ends of the pieces;
//! 2. ends that face each other are joined again, by a slope of `STEEPEST_RAD` at most: there a path had changed from one
//!    line to the next;
//! 3. ends that meet the border side by side form groups. Lines of a group whose distance is two radii or more are joined
//!    by turns along the border, a bead apart; the lines inside end before them. Where groups begin is chosen so that as much as
//!    can be lies in paths that are long enough, one row of ends after the other until nothing changes;
//! 4. lines that are still too short go on in their neighbours (`hang`);
//! 5. rings take the place of lines that are too short even so, where they have room (`spirals`).
//!
//! Turns that do not cross lie beside or inside each other, and the innermost has lines inside it that cannot turn. So of
//! lines that end side by side some stay cut, here a fifth (`TURNS_PER_LINE`). The steps are this project's own.
//!
//! Lengths are in mm. Cost: linear in the length of the pieces for steps 1 and 3, and in the number of lines times the groups that
//! are tried; step 2 looks at the ends within a few beads of each other. Limits: the turns lie across the lines, in a strip along
//! the border twice as wide as the least turn; lines stay cut where they meet the border at less than 30 degrees, where its
//! curve is tighter than the least radius, and where fewer lie side by side than a turn is wide.

mod crossings;
mod hang;
mod spirals;
mod surroundings;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use crate::buckets::PointGrid2;
use crate::math::{cross, tan};
use crate::polyline::{length_mm, shorten_start};
use crate::segment;
use crate::turns::{rounded, sharp_turns};
use crate::{Bounds2, Contour, DVec2, DisjointSets, Toolpath};

pub use crossings::{any_cross, uncrossed};
pub use surroundings::Place;
use surroundings::{
    CUT_SPACINGS, HAIRPIN_COS, Obstacles, STEEPEST_RAD, STRAIGHT, STRETCH, onward, onward_curved,
};

/// Two ends face each other if their directions are opposite within this; the cosine of 20 degrees. Source: chosen; the
/// slope and the curve of the lines are added to it.
const OPPOSITE_COS: f64 = 0.94;
/// Ends that face each other are joined if they are at most this far apart, in spacings. Source: derived; the stretch of a
/// line that a path leaves where it changes to the next is as long as a hairpin at both its ends, two and two spacings.
const FARTHEST_FACING: f64 = 6.0;
/// Ends that face each other are joined if their lines are at most this far apart sidewise, in spacings. Source: derived; the
/// next line is one spacing away.
const MOST_SIDEWISE: f64 = 1.2;
/// The border is looked for so far ahead of an end, in spacings. Source: derived; the hairpins that were cut off had led a
/// line to half a spacing from the border, and they are two spacings long at most.
const AHEAD: f64 = 4.0;
/// The least sine of the angle at which a line meets a border along which it may turn: 30 degrees. Source: derived; at
/// smaller angles lines a bead apart end two beads apart on the border.
const LEAST_SINE: f64 = 0.5;
/// Ends on the border are side by side if they are at most this far apart, in spacings. Source: derived; at [`LEAST_SINE`]
/// lines that are one spacing apart end two spacings apart.
const SIDE_BY_SIDE: f64 = 2.05;
/// Two lines are joined by a turn if their directions are equal within this; the cosine of 30 degrees. Source: chosen; the
/// turn then goes round by 150 degrees at least.
const ALIKE_COS: f64 = 0.866;
/// A line that ends inside a turn comes nearer to it than a spacing by this share at most. Source: chosen; a fiftieth of a
/// bead is less than a printer can show.
const CLOSER: f64 = 0.02;
/// Turns of a group for each line that ends inside them. Source: measured on one layer of `plate-wide` and `hook-wide` of
/// `grainpath new continuous`. With 2 they have 5.11 and 1.83 m of fibre in 45 and 23 pieces; where groups of 1 to 4 may be chosen
/// as well they have 5.10 and 1.79 m in 49 and 22, since lines that return beside each other go on in each other less often.
const TURNS_PER_LINE: usize = 2;
/// Most rounds in which groups are chosen. Source: chosen; rounds end when nothing changes, which takes three on both.
const MOST_ROUNDS: usize = 10;
/// Turns stay this far inside the area for centrelines, mm. Source: derived. A turn has a point on every line that it passes;
/// around a hole of 5 mm radius a straight piece of 1.4 mm between two of them comes 0.05 mm nearer to the hole.
const WITHIN_MM: f64 = 0.05;
/// Least length of a turn along the border, in radii: one for the arc at each of its ends, and what
/// [`rounded`] adds to them. Source: derived from its factor of 1.03.
const LEAST_TURN: f64 = 2.1;

/// Joins open pieces where turns of the least radius fit. Corners of the result are still to be rounded, by
/// [`rounded`]. Closed pieces stay as they are.
///
/// ```
/// use grainpath_core::wide_turns::{Place, joined};
/// use grainpath_core::{DVec2, Region, Role, Toolpath, poly::LineClipper};
///
/// // Nine lines, a bead of 1 mm apart, end at the sides of a rectangle.
/// let line = |k: usize| vec![DVec2::new(0.1, k as f64 + 0.5), DVec2::new(49.9, k as f64 + 0.5)];
/// let pieces = (0..9).map(|k| Toolpath::new(line(k), 1.0, Role::Fibre, false)).collect();
/// let region = Region::rectangle(DVec2::ZERO, DVec2::new(50.0, 9.0));
/// let clipper = LineClipper::new(&region);
/// let place = Place { region: &region, clipper: &clipper, spacing_mm: 1.0, least_mm: 2.0, onward_mm: 0.0, needed_mm: 20.0 };
/// // Turns of 2 mm radius are five beads wide. Four lines end inside them; the others are joined two by two at either side.
/// let joined = joined(pieces, &place);
/// assert!(joined.len() < 9);
/// assert!(joined.iter().map(Toolpath::length_mm).sum::<f64>() > 0.9 * 9.0 * 49.8);
/// ```
pub fn joined(pieces: Vec<Toolpath>, place: &Place<'_>) -> Vec<Toolpath> {
    let (closed, open): (Vec<Toolpath>, Vec<Toolpath>) = pieces.into_iter().partition(|p| p.closed);
    let Some(like) = open.first().cloned() else { return closed };
    let mut lines: Vec<Vec<DVec2>> = open.into_iter().map(|p| without_hairpins(p.points, place)).collect();
    lines.retain(|line| line.len() > 1);
    let rings = || closed.iter().map(|p| [&p.points[..], &p.points[..1]].concat());
    let lines = facing_joined(lines, rings(), place);
    let paths = turned_at_border(lines, rings(), place);
    let paths = hang::hung(paths, place);
    let paths = spirals::ringed(paths, place);
    let mut out: Vec<Toolpath> =
        paths.into_iter().map(|(points, closed)| Toolpath { points, closed, ..like.clone() }).collect();
    out.extend(closed);
    out
}

/// Removes what is left of a hairpin from both ends of a line.
fn without_hairpins(mut line: Vec<DVec2>, place: &Place<'_>) -> Vec<DVec2> {
    for _ in 0..2 {
        if let Some(onward) = onward(&line, place.spacing_mm) {
            let (mut way_mm, mut kept_from) = (0.0, 0);
            for (k, w) in line.windows(2).enumerate() {
                if way_mm > STRETCH[0] * place.spacing_mm {
                    break;
                }
                if (w[0] - w[1]).normalize_or(onward).dot(onward) < HAIRPIN_COS {
                    kept_from = k + 1;
                }
                way_mm += w[0].distance(w[1]);
            }
            line.drain(..kept_from);
        }
        line.reverse();
    }
    line
}

/// A way from one end of a line to an end of another: the points between both, and the two ends. End `2 l` is the first
/// point of line `l`, end `2 l + 1` its last.
#[derive(Clone)]
struct Joint {
    ends: [usize; 2],
    way: Vec<DVec2>,
}

/// Points of a line, from one of its ends on.
fn from_end(lines: &[Vec<DVec2>], end: usize) -> Vec<DVec2> {
    let mut line = lines[end / 2].clone();
    if !end.is_multiple_of(2) {
        line.reverse();
    }
    line
}

/// Replaces a line by one that is given from one of its ends on.
fn put_back(lines: &mut [Vec<DVec2>], end: usize, mut line: Vec<DVec2>) {
    if !end.is_multiple_of(2) {
        line.reverse();
    }
    lines[end / 2] = line;
}

/// Joins ends that face each other, the nearest first.
fn facing_joined(
    mut lines: Vec<Vec<DVec2>>,
    rings: impl Iterator<Item = Vec<DVec2>>,
    place: &Place<'_>,
) -> Vec<Vec<DVec2>> {
    let spacing_mm = place.spacing_mm;
    let obstacles = Obstacles::new(lines.iter().cloned().chain(rings), 2.0 * spacing_mm);
    let ends: Vec<(DVec2, Option<DVec2>)> = (0..2 * lines.len())
        .map(|e| {
            let line = from_end(&lines, e);
            (line[0], onward_curved(&line, place))
        })
        .collect();
    let Some(bounds) = Bounds2::around_points(ends.iter().map(|e| e.0)) else { return lines };
    let farthest_mm = FARTHEST_FACING * spacing_mm;
    let mut grid = PointGrid2::new(bounds, farthest_mm);
    ends.iter().enumerate().for_each(|(e, end)| grid.insert(end.0, e));
    let mut pairs = Vec::new();
    for (e, &(p, u)) in ends.iter().enumerate() {
        for (q, f) in grid.within(p, farthest_mm).filter(|&(_, f)| f > e && f / 2 != e / 2) {
            let (Some(u), Some(v)) = (u, ends[f].1) else { continue };
            let along = (u - v).normalize_or(u);
            let sidewise_mm = cross(along, q - p).abs();
            if -u.dot(v) >= OPPOSITE_COS && sidewise_mm <= MOST_SIDEWISE * spacing_mm {
                // What both lines lose so that the slope between them is not too steep, mm.
                let lost_mm = sidewise_mm / tan(STEEPEST_RAD) - along.dot(q - p);
                pairs.push((sidewise_mm + p.distance(q), e, f, lost_mm.max(0.0)));
            }
        }
    }
    // Ends that are equally near are taken in the order of the lines, so that the result is always the same.
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| (a.1, a.2).cmp(&(b.1, b.2))));
    let mut joints: Vec<Joint> = Vec::new();
    let mut taken = vec![false; 2 * lines.len()];
    for (_, e, f, lost_mm) in pairs {
        if taken[e] || taken[f] {
            continue;
        }
        let shortened = [e, f].map(|end| {
            let mut line = from_end(&lines, end);
            let enough = length_mm(&line, false) > 0.5 * lost_mm + STRETCH[1] * spacing_mm;
            shorten_start(&mut line, 0.5 * lost_mm);
            enough.then_some(line)
        });
        let [Some(one), Some(other)] = shortened else { continue };
        let (a, b) = (one[0], other[0]);
        // What both lines lose lies beside the way between them and does not count as crossing it.
        if obstacles.between(a, b, |l| l == e / 2 || l == f / 2) || !place.clipper.segment_inside(a, b) {
            continue;
        }
        put_back(&mut lines, e, one);
        put_back(&mut lines, f, other);
        (taken[e], taken[f]) = (true, true);
        joints.push(Joint { ends: [e, f], way: Vec::new() });
    }
    chained(&lines, &joints)
        .into_iter()
        .map(|(line, closed)| if closed { opened(line) } else { line })
        .collect()
}

/// A ring as an open line that ends where it begins.
fn opened(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    ring.extend(ring.first().copied());
    ring
}

/// The end of a line before the border.
struct BorderEnd {
    end: usize,
    /// Where the line, going on, meets the border.
    at: DVec2,
    /// Unit vector from the line to the border.
    onward: DVec2,
    /// Sine of the angle between line and border.
    sine: f64,
    /// Contour and distance along it, mm.
    contour: usize,
    along_mm: f64,
    /// Distance from the end of the line to the border, mm.
    ahead_mm: f64,
}

impl BorderEnd {
    fn of(
        lines: &[Vec<DVec2>],
        end: usize,
        contours: &[(&Contour, Vec<f64>)],
        place: &Place<'_>,
    ) -> Option<Self> {
        let line = from_end(lines, end);
        let onward = onward(&line, place.spacing_mm)?;
        let reach_mm = AHEAD * place.spacing_mm;
        let hit = *place.clipper.crossings(line[0], line[0] + reach_mm * onward).first()?;
        let (contour, lengths) = contours.get(hit.contour)?;
        let (a, b) = (contour[hit.edge], contour[(hit.edge + 1) % contour.len()]);
        let at = line[0] + hit.t * reach_mm * onward;
        let sine = cross(onward, (b - a).try_normalize()?).abs();
        let along_mm = lengths[hit.edge] + a.distance(at);
        (sine >= LEAST_SINE).then_some(Self {
            end,
            at,
            onward,
            sine,
            contour: hit.contour,
            along_mm,
            ahead_mm: hit.t * reach_mm,
        })
    }

    /// The place on the line that is `depth_mm` from the border.
    fn at_depth(&self, depth_mm: f64) -> DVec2 {
        self.at - (depth_mm + WITHIN_MM) / self.sine * self.onward
    }
}

/// Joins lines by turns along the border. Each result is a line, and whether it is closed.
fn turned_at_border(
    mut lines: Vec<Vec<DVec2>>,
    rings: impl Iterator<Item = Vec<DVec2>>,
    place: &Place<'_>,
) -> Vec<(Vec<DVec2>, bool)> {
    let spacing_mm = place.spacing_mm;
    let contours: Vec<(&Contour, Vec<f64>)> = place
        .region
        .contours()
        .map(|c| {
            let mut sum_mm = 0.0;
            let lengths = (0..c.len()).map(|k| {
                let before_mm = sum_mm;
                sum_mm += c[k].distance(c[(k + 1) % c.len()]);
                before_mm
            });
            (c, lengths.collect())
        })
        .collect();
    let obstacles = Obstacles::new(lines.iter().cloned().chain(rings), 2.0 * spacing_mm);
    let mut ends: Vec<BorderEnd> =
        (0..2 * lines.len()).filter_map(|e| BorderEnd::of(&lines, e, &contours, place)).collect();
    ends.sort_by(|a, b| {
        a.contour.cmp(&b.contour).then(a.along_mm.total_cmp(&b.along_mm)).then(a.end.cmp(&b.end))
    });
    let runs = runs(&ends, SIDE_BY_SIDE * spacing_mm);
    let divisions: Vec<Vec<Laid>> = runs.iter().map(|run| divisions(run, &obstacles, place)).collect();
    let lengths_mm: Vec<f64> = lines.iter().map(|line| length_mm(line, false)).collect();
    let chosen = best_divisions(&runs, &divisions, &lengths_mm, place);
    let mut joints = Vec::new();
    for ((run, divisions), k) in runs.iter().zip(divisions).zip(chosen) {
        let Some(laid) = divisions.into_iter().nth(k) else { continue };
        // Lines are moved only now, since every division was tried on the same ones.
        for (end, depth_mm) in run.iter().zip(laid.depths_mm) {
            moved_to(&mut lines, end, depth_mm, &obstacles);
        }
        joints.extend(laid.joints);
    }
    chained(&lines, &joints)
}

/// Ends that lie side by side on a contour, in the order along it. A run that goes all around begins anywhere.
fn runs(ends: &[BorderEnd], apart_mm: f64) -> Vec<Vec<&BorderEnd>> {
    let mut out: Vec<Vec<&BorderEnd>> = Vec::new();
    for of_contour in ends.chunk_by(|a, b| a.contour == b.contour) {
        let near = |a: &BorderEnd, b: &BorderEnd| a.at.distance(b.at) <= apart_mm;
        let mut here: Vec<Vec<&BorderEnd>> =
            of_contour.chunk_by(near).map(|run| run.iter().collect()).collect();
        // The contour is closed, so its last run may go on as the first.
        if here.len() > 1 && near(&of_contour[of_contour.len() - 1], &of_contour[0]) {
            let first = here.remove(0);
            if let Some(last) = here.last_mut() {
                last.extend(first);
            }
        }
        out.extend(here);
    }
    out
}

/// Turns of a run that is divided into groups.
struct Laid {
    /// How far each end stays from the border, mm.
    depths_mm: Vec<f64>,
    joints: Vec<Joint>,
}

/// The ways to lay turns in a run: none, and groups of one size of which the first may begin anywhere.
fn divisions(run: &[&BorderEnd], obstacles: &Obstacles, place: &Place<'_>) -> Vec<Laid> {
    let mut out = vec![Laid { depths_mm: vec![0.0; run.len()], joints: Vec::new() }];
    // Lines inside the narrowest turn.
    let first = run[0].at;
    let Some(n_inside) =
        run.iter().position(|end| end.at.distance(first) >= LEAST_TURN * place.least_mm).map(|w| w - 1)
    else {
        return out;
    };
    let first_tried = (place.onward_mm / place.spacing_mm) as usize;
    let size = (1 + 2 * TURNS_PER_LINE) * n_inside.max(1);
    // A group has the same turns in every division that it is in.
    let mut groups = BTreeMap::new();
    for k in 0..size {
        let mut laid = Laid { depths_mm: Vec::with_capacity(run.len()), joints: Vec::new() };
        let (mut from, mut to) = (0, (first_tried + k) % size);
        while from < run.len() {
            if to <= from {
                to = from + size;
            }
            to = to.min(run.len());
            let group: &Laid =
                groups.entry([from, to]).or_insert_with(|| laid_in_group(&run[from..to], obstacles, place));
            laid.depths_mm.extend(&group.depths_mm);
            laid.joints.extend(group.joints.iter().cloned());
            from = to;
        }
        out.push(laid);
    }
    out
}

/// Chooses a division for each run, so that as much as can be lies in long paths. The runs are looked at in turn while
/// that adds anything, since what a turn joins depends on the turns at the other ends of its lines.
fn best_divisions(
    runs: &[Vec<&BorderEnd>],
    divisions: &[Vec<Laid>],
    lengths_mm: &[f64],
    place: &Place<'_>,
) -> Vec<usize> {
    let mut chosen = vec![0; runs.len()];
    let add = |r: usize, laid: &Laid, chains: &mut DisjointSets, of_line_mm: &mut [f64]| {
        for joint in &laid.joints {
            chains.union(joint.ends[0] / 2, joint.ends[1] / 2);
        }
        add_lengths(of_line_mm, &runs[r], laid);
    };
    for _ in 0..MOST_ROUNDS {
        let before = chosen.clone();
        for r in 0..runs.len() {
            // Chains that the other runs make.
            let (mut chains, mut of_line_mm) = (DisjointSets::new(lengths_mm.len()), lengths_mm.to_vec());
            for other in (0..runs.len()).filter(|&other| other != r) {
                add(other, &divisions[other][chosen[other]], &mut chains, &mut of_line_mm);
            }
            let worth_mm = |laid: &Laid| {
                let (mut chains, mut of_line_mm) = (chains.clone(), of_line_mm.clone());
                add(r, laid, &mut chains, &mut of_line_mm);
                let mut of_chain_mm = vec![0.0; of_line_mm.len()];
                for (l, mm) in of_line_mm.iter().enumerate() {
                    of_chain_mm[chains.lowest(l)] += mm;
                }
                let long = of_chain_mm.iter().filter(|&&mm| mm > 0.0 && mm >= place.needed_mm);
                long.map(|mm| mm - CUT_SPACINGS * place.spacing_mm).sum::<f64>()
            };
            let mut best_mm = worth_mm(&divisions[r][chosen[r]]);
            for (k, laid) in divisions[r].iter().enumerate() {
                let mm = worth_mm(laid);
                // Rounding errors must not choose.
                if mm > best_mm + 1e-6 {
                    (chosen[r], best_mm) = (k, mm);
                }
            }
        }
        if chosen == before {
            break;
        }
    }
    chosen
}

/// Adds to the lengths of lines what a division lays more of them, mm.
fn add_lengths(of_line_mm: &mut [f64], run: &[&BorderEnd], laid: &Laid) {
    for (end, depth_mm) in run.iter().zip(&laid.depths_mm) {
        of_line_mm[end.end / 2] += end.ahead_mm - (depth_mm + WITHIN_MM) / end.sine;
    }
    for joint in &laid.joints {
        of_line_mm[joint.ends[0] / 2] += length_mm(&joint.way, false);
    }
}

/// Lays turns in a group of lines, each inside the one before.
fn laid_in_group(run: &[&BorderEnd], obstacles: &Obstacles, place: &Place<'_>) -> Laid {
    let mut depths_mm = vec![0.0; run.len()];
    let mut joints = Vec::new();
    let members: BTreeSet<usize> = run.iter().map(|end| end.end / 2).collect();
    let mut depth_mm = 0.0;
    // The innermost turn so far.
    let mut around: Option<Vec<DVec2>> = None;
    let (mut low, mut high) = (0, run.len());
    while high - low > 1 {
        let (a, b) = (run[low], run[high - 1]);
        let way: Vec<DVec2> = run[low..high].iter().map(|end| end.at_depth(depth_mm)).collect();
        // Lines further inside are nearer still.
        let wide = way[0].distance(way[way.len() - 1]) >= LEAST_TURN * place.least_mm;
        if !wide {
            break;
        }
        let free = |w: &[DVec2]| {
            place.clipper.segment_inside(w[0], w[1])
                && !obstacles.between(w[0], w[1], |l| members.contains(&l))
        };
        let fits = a.onward.dot(b.onward) >= ALIKE_COS && way.windows(2).all(free);
        if let Some(turn) = fits.then(|| rounded_turn([a, b], depth_mm, &way, place)).flatten() {
            (depths_mm[low], depths_mm[high - 1]) = (depth_mm, depth_mm);
            joints.push(Joint { ends: [a.end, b.end], way: way[1..way.len() - 1].to_vec() });
            depth_mm += place.spacing_mm;
            around = Some(turn);
        } else if let Some(around) = &around {
            for k in [low, high - 1] {
                depths_mm[k] = depth_inside(run[k], around, depth_mm, place);
            }
        }
        (low, high) = (low + 1, high - 1);
    }
    if let Some(around) = around {
        (low..high).for_each(|k| depths_mm[k] = depth_inside(run[k], &around, depth_mm, place));
    }
    Laid { depths_mm, joints }
}

/// A turn from one line to another, rounded, with a straight piece of both lines; `None` if it stays too sharp.
fn rounded_turn(
    ends: [&BorderEnd; 2],
    depth_mm: f64,
    way: &[DVec2],
    place: &Place<'_>,
) -> Option<Vec<DVec2>> {
    let [first, last] = ends.map(|end| end.at_depth(depth_mm + STRAIGHT * place.least_mm));
    let points = [&[first], way, &[last]].concat();
    let inside = |a: DVec2, b: DVec2| place.clipper.segment_inside(a, b);
    let (points, _) = rounded(&points, place.least_mm, place.least_mm, &inside);
    sharp_turns(&points, false, place.least_mm).is_empty().then_some(points)
}

/// How far a line that ends inside a turn stays from the border, mm: `depth_mm`, or more where the turn's arc is nearer than
/// a bead.
fn depth_inside(end: &BorderEnd, turn: &[DVec2], depth_mm: f64, place: &Place<'_>) -> f64 {
    // The first and the last segment are the straight pieces of the lines that turn.
    let arc = turn.windows(2).skip(1).take(turn.len().saturating_sub(3));
    let arc: Vec<&[DVec2]> = arc.collect();
    let apart_mm = (1.0 - CLOSER) * place.spacing_mm;
    let near =
        |p: DVec2| arc.iter().any(|w| segment::distance_squared_mm2(p, w[0], w[1]) < apart_mm * apart_mm);
    // The line comes from deep inside the turn, since its place at `depth_mm` may lie beyond the arc.
    let step_mm = CLOSER * place.spacing_mm;
    let mut at_mm = depth_mm + STRAIGHT * place.least_mm;
    while at_mm > depth_mm + step_mm && !near(end.at_depth(at_mm - step_mm)) {
        at_mm -= step_mm;
    }
    if at_mm > depth_mm + step_mm { at_mm } else { depth_mm }
}

/// Shortens or extends the end of a line to `depth_mm` from the border.
fn moved_to(lines: &mut [Vec<DVec2>], end: &BorderEnd, depth_mm: f64, obstacles: &Obstacles) {
    let mut line = from_end(lines, end.end);
    let onward_mm = end.ahead_mm - (depth_mm + WITHIN_MM) / end.sine;
    if onward_mm < 0.0 {
        shorten_start(&mut line, -onward_mm);
    } else if onward_mm > 0.0 {
        let to = end.at_depth(depth_mm);
        if obstacles.between(line[0], to, |l| l == end.end / 2) {
            return;
        }
        line.insert(0, to);
    }
    put_back(lines, end.end, line);
}

/// Puts lines together whose ends are joined. Each result is a line, and whether it is closed.
fn chained(lines: &[Vec<DVec2>], joints: &[Joint]) -> Vec<(Vec<DVec2>, bool)> {
    let mut joint_of = vec![None; 2 * lines.len()];
    for (k, joint) in joints.iter().enumerate() {
        joint.ends.iter().for_each(|&e| joint_of[e] = Some(k));
    }
    let mut used = vec![false; lines.len()];
    let mut out = Vec::new();
    // Chains are followed from their free ends first; those that remain are rings.
    let free = (0..joint_of.len()).filter(|&e| joint_of[e].is_none());
    for first in free.chain((0..lines.len()).map(|l| 2 * l)) {
        let mut points: Vec<DVec2> = Vec::new();
        let (mut at, mut closed) = (first, false);
        while !used[at / 2] {
            used[at / 2] = true;
            points.extend(from_end(lines, at));
            let Some(k) = joint_of[at ^ 1] else { break };
            let Joint { ends, way } = &joints[k];
            let forwards = ends[0] == at ^ 1;
            if forwards {
                points.extend(way)
            } else {
                points.extend(way.iter().rev())
            }
            at = ends[usize::from(forwards)];
            closed = at == first;
        }
        if !points.is_empty() {
            out.push((points, closed));
        }
    }
    out
}
