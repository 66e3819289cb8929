//! Lets short lines go on in their neighbours. Where a line ends beside another, it changes into the lane of that line and
//! goes on as its rest, and the other line ends there:
//!
//! ```text
//!    ---------- short            ----------\
//!    =========================   =========  \==============
//! ```
//!
//! As much is laid as before, in other paths: a line that is too short is long enough with the rest of its neighbour, whose
//! first part may still be long enough by itself. If it is not, that goes on in the next neighbour in turn.

use std::collections::BTreeSet;

use super::surroundings::{
    HAIRPIN_COS, Obstacles, Path, Place, STEEPEST_RAD, STRAIGHT, STRETCH, onward, whole,
};
use crate::math::{cos, sin, tan};
use crate::polyline::{length_mm, shorten_start};
use crate::segment::{self, Meeting};
use crate::turns::{rounded, sharp_turns};
use crate::{Bounds2, DVec2};

/// A line goes on in a neighbour whose direction is the same within this; the cosine of 20 degrees. Source: chosen; as for
/// ends that face each other.
const PARALLEL_COS: f64 = 0.94;
/// Farthest distance sidewise to the lane of a neighbour, in spacings. Source: derived; the next lane is one spacing away, and
/// lines that spread are half a spacing further apart before another fits between them.
const SIDEWISE: f64 = 1.5;
/// The part of a neighbour that ends keeps this distance to the line that changes into its lane, in spacings. Source: as
/// `CLOSER` of the turns.
const APART: f64 = 0.98;
/// A change reaches this far from a line at most, in spacings. Source: derived; a slope of 15 degrees over [`SIDEWISE`] is 5.8 long.
const FARTHEST: f64 = 8.0;
/// Places at which a ring may be opened are this far apart, in spacings. Source: chosen; half the length of a change of lanes.
const OPENED: f64 = 2.0;
/// Most rounds of changes. Source: chosen; a line is changed once in a round, rounds end when nothing is gained, and with 32 nothing
/// more is on `hook-wide` and `plate-wide` of `grainpath new continuous`.
const MOST_ROUNDS: usize = 8;

/// Most lines that go on in each other, one after the other, before something is gained. Source: measured as `MORE` of the rings: with 2, 3
/// and 5 there are 24.47, 24.58 and 24.45 m of fibre. The next steps are not chosen well for what comes after them.
const MOST_PASSED: usize = 3;
/// Only lines of this share of the length that is needed or more begin such a chain. Source: measured as [`MOST_PASSED`]: with 0.15, 0.3 and
/// 0.5 there are 24.67, 24.58 and 24.47 m of fibre, and the time of the step goes with the number of lines.
const SHORTEST_PASSED: f64 = 0.3;

/// A line that goes on in another.
struct Change {
    gain_mm: f64,
    /// The line that goes on, and the one whose rest it takes.
    lines: [usize; 2],
    /// What is laid instead: the longer line and the first part of the other.
    paths: Vec<Path>,
}

/// Changes lines while more of them become as long as is needed.
pub(super) fn hung(mut paths: Vec<Path>, place: &Place<'_>) -> Vec<Path> {
    for _ in 0..MOST_ROUNDS {
        let mut changes = changes(&paths, None, place.spacing_mm, place);
        changes.sort_by(|a, b| b.gain_mm.total_cmp(&a.gain_mm).then(a.lines.cmp(&b.lines)));
        let mut touched = BTreeSet::new();
        let mut ways: Vec<Path> = Vec::new();
        for change in changes {
            if change.lines.iter().any(|l| touched.contains(l)) {
                continue;
            }
            touched.extend(change.lines);
            ways.extend(change.paths);
        }
        if touched.is_empty() {
            break;
        }
        paths = replaced(&paths, |l| touched.contains(&l), ways);
    }
    passed_on(paths, place)
}

/// Paths without some of them, and others after them.
fn replaced(paths: &[Path], without: impl Fn(usize) -> bool, others: Vec<Path>) -> Vec<Path> {
    let kept = paths.iter().enumerate().filter(|(l, _)| !without(*l)).map(|(_, path)| path.clone());
    kept.chain(others).collect()
}

/// Lets short lines go on in neighbours that become too short by it and go on in their own next neighbours:
/// of three arcs of 45, 58 and 62 mm beside each other the first takes 10 mm of the second, which takes as much of the third.
fn passed_on(mut paths: Vec<Path>, place: &Place<'_>) -> Vec<Path> {
    let mut given_up: Vec<Path> = Vec::new();
    loop {
        let length_mm = |(points, closed): &Path| length_mm(points, *closed);
        // The longest gains most, and of equal ones the first is taken.
        let next = (0..paths.len())
            .filter(|&l| length_mm(&paths[l]) < place.needed_mm)
            .filter(|&l| {
                length_mm(&paths[l]) >= SHORTEST_PASSED * place.needed_mm && !given_up.contains(&paths[l])
            })
            .max_by(|&a, &b| length_mm(&paths[a]).total_cmp(&length_mm(&paths[b])).then(b.cmp(&a)));
        let Some(l) = next else { return paths };
        match passed(&paths, l, 0.0, MOST_PASSED, place) {
            Some(changed) => paths = changed,
            None => given_up.push(paths[l].clone()),
        }
    }
}

/// Paths after a line, what that leaves of its neighbour and so on went on in their neighbours; `None` if nothing is gained.
fn passed(paths: &[Path], l: usize, gained_mm: f64, most: usize, place: &Place<'_>) -> Option<Vec<Path>> {
    let mut changes = changes(paths, Some(l), f64::NEG_INFINITY, place);
    changes.sort_by(|a, b| b.gain_mm.total_cmp(&a.gain_mm).then(a.lines.cmp(&b.lines)));
    for Change { gain_mm, lines, paths: ways } in changes {
        let gained_mm = gained_mm + gain_mm;
        let leaves = ways.len() > 1;
        let changed = replaced(paths, |k| lines.contains(&k), ways);
        if gained_mm >= place.spacing_mm {
            return Some(changed);
        }
        if leaves && most > 1 {
            let further = passed(&changed, changed.len() - 1, gained_mm, most - 1, place);
            if further.is_some() {
                return further;
            }
        }
    }
    None
}

/// What a path is worth: its length if it is long enough.
fn worth_mm(mm: f64, place: &Place<'_>) -> f64 {
    if mm >= place.needed_mm { mm } else { 0.0 }
}

/// All changes that gain a length or more, of all lines or of one.
fn changes(paths: &[Path], of: Option<usize>, least_gain_mm: f64, place: &Place<'_>) -> Vec<Change> {
    let spacing_mm = place.spacing_mm;
    let is_short: Vec<bool> =
        paths.iter().map(|(points, closed)| length_mm(points, *closed) < place.needed_mm).collect();
    // Nothing is gained between two lines that are long enough, and looking around large rings takes long.
    if !is_short.contains(&true) {
        return Vec::new();
    }
    // A change of one line concerns what is near it.
    let bounds = |(points, _): &Path| Bounds2::around_points(points.iter().copied());
    let reach = of.and_then(|l| Some(bounds(&paths[l])?.grown(FARTHEST * spacing_mm)));
    let is_near = |path: &Path| reach.is_none_or(|reach| bounds(path).is_some_and(|b| b.meets(reach)));
    let near = |path: &Path| if is_near(path) { whole(path) } else { Vec::new() };
    let obstacles = Obstacles::new(paths.iter().map(near), 2.0 * spacing_mm);
    let mut first_segment = vec![0; paths.len()];
    for (i, l) in obstacles.line_of.iter().enumerate().rev() {
        first_segment[*l] = i;
    }
    let mut out = Vec::new();
    for (l, path) in paths.iter().enumerate().filter(|(l, _)| of.is_none_or(|of| of == *l)) {
        // The end looked at is the first point.
        for line in from_ends(path, spacing_mm) {
            let Some(u) = onward(&line, spacing_mm) else { continue };
            // The nearest place of each line beside the end.
            let mut near: Vec<(usize, usize, f64)> = obstacles
                .segments
                .within(line[0], SIDEWISE * spacing_mm)
                .map(|(i, mm)| (obstacles.line_of[i], i, mm))
                .filter(|near| near.0 != l)
                .collect();
            near.sort_by(|a, b| a.0.cmp(&b.0).then(a.2.total_cmp(&b.2)).then(a.1.cmp(&b.1)));
            near.dedup_by_key(|near| near.0);
            for (other, i, _) in near {
                // One of both has to gain by it.
                if !is_short[l] && !is_short[other] {
                    continue;
                }
                let at = i - first_segment[other];
                let change = change([l, other], (&line, path.1), u, &paths[other], at, &obstacles, place);
                out.extend(change.filter(|change| change.gain_mm >= least_gain_mm));
            }
        }
    }
    out
}

/// A path from each of its ends on. A ring is opened at places all around it, [`OPENED`] spacings apart.
fn from_ends((points, closed): &Path, spacing_mm: f64) -> Vec<Vec<DVec2>> {
    let backwards = |line: &Vec<DVec2>| line.iter().rev().copied().collect();
    if !closed {
        return vec![points.clone(), backwards(points)];
    }
    let mut out = Vec::new();
    let mut since_mm = f64::INFINITY;
    for k in 0..points.len() {
        if since_mm >= OPENED * spacing_mm {
            since_mm = 0.0;
            let mut line = points[k..].to_vec();
            line.extend(&points[..=k]);
            out.push(backwards(&line));
            out.push(line);
        }
        since_mm += points[k].distance(points[(k + 1) % points.len()]);
    }
    out
}

/// The change of a line, given from its end on and with whether it is an opened ring, into the lane of another beside its segment `at`.
fn change(
    lines: [usize; 2],
    (line, was_ring): (&[DVec2], bool),
    u: DVec2,
    other: &Path,
    at: usize,
    obstacles: &Obstacles,
    place: &Place<'_>,
) -> Option<Change> {
    let end = line[0];
    // The other line as two parts from the place beside the end: its rest in direction `u`, and its first part, backwards.
    let (points, closed) = other;
    let n = points.len();
    let (a, b) = (points[at], points[(at + 1) % n]);
    let beside = a.lerp(b, segment::closest_share(end, a, b));
    let along = (b - a).try_normalize()?;
    if along.dot(u).abs() < PARALLEL_COS {
        return None;
    }
    // A ring is opened beside the end; all of it is then the rest.
    let (mut after, mut before): (Vec<DVec2>, Vec<DVec2>) = if *closed {
        let mut ring = points[at + 1..].to_vec();
        ring.extend(&points[..=at]);
        (ring, Vec::new())
    } else {
        (points[at + 1..].to_vec(), points[..=at].iter().rev().copied().collect())
    };
    if along.dot(u) < 0.0 {
        if *closed { after.reverse() } else { std::mem::swap(&mut after, &mut before) }
    }
    after.insert(0, beside);
    before.insert(0, beside);
    let sidewise_mm = end.distance(beside);
    // Where the slope arrives, and where the first part ends so that it keeps its distance to the slope.
    let slope_mm = sidewise_mm / tan(STEEPEST_RAD);
    let back_mm = ((APART * place.spacing_mm - sidewise_mm * cos(STEEPEST_RAD)) / sin(STEEPEST_RAD)).max(0.0);
    let all_mm = |points: &[DVec2]| length_mm(points, false);
    if all_mm(&after) < slope_mm + place.least_mm || back_mm > sidewise_mm {
        return None;
    }
    shorten_start(&mut after, slope_mm);
    // What is left of the other line ends before the slope; of a ring that is the far end of its rest.
    if *closed {
        after.reverse();
        shorten_start(&mut after, back_mm);
        after.reverse();
    } else if all_mm(&before) > back_mm {
        shorten_start(&mut before, back_mm);
    } else {
        before.clear();
    }
    // Where the other line turns or ends beside the end, what follows is not its lane.
    let slope = (after[0] - end).normalize_or_zero();
    if slope.dot(u) < HAIRPIN_COS {
        return None;
    }
    let [l, other_l] = lines;
    if !place.clipper.segment_inside(end, after[0])
        || obstacles.between(end, after[0], |k| k == l || k == other_l)
    {
        return None;
    }
    let mut longer: Vec<DVec2> = line.iter().rev().copied().collect();
    if was_ring {
        // A ring begins where it ends, in the lane that the slope leaves.
        shorten_start(&mut longer, slope_mm + back_mm);
    }
    let there: Vec<DVec2> = longer.iter().rev().copied().collect();
    if [&there, &after, &before].iter().any(|points| returns_to(points, [end, after[0]], place)) {
        return None;
    }
    longer.extend(&after);
    let was_mm = worth_mm(all_mm(line), place) + worth_mm(length_mm(points, *closed), place);
    let gain_mm = worth_mm(all_mm(&longer), place) + worth_mm(all_mm(&before), place) - was_mm;
    if all_mm(&longer) < place.needed_mm || !bends_wide(line, &after, &before, place) {
        return None;
    }
    let mut paths = vec![(longer, false)];
    if before.len() > 1 {
        paths.push((before, false));
    }
    Some(Change { gain_mm, lines, paths })
}

/// Whether a line meets a way beside its beginning again farther on, as a spiral may.
fn returns_to(line: &[DVec2], way: [DVec2; 2], place: &Place<'_>) -> bool {
    let mut along_mm = 0.0;
    line.windows(2).any(|w| {
        let from_mm = along_mm;
        along_mm += w[0].distance(w[1]);
        from_mm > STRETCH[0] * place.spacing_mm && segment::meeting([w[0], w[1]], way) != Meeting::Apart
    })
}

/// Whether the way from the end of a line to a rest of another can be rounded to the least radius, and then does not meet the
/// first part of the other.
fn bends_wide(line: &[DVec2], after: &[DVec2], before: &[DVec2], place: &Place<'_>) -> bool {
    let head = |points: &[DVec2]| {
        let mut way_mm = 0.0;
        let mut out = vec![points[0]];
        for w in points.windows(2) {
            if way_mm > STRAIGHT * place.least_mm {
                break;
            }
            way_mm += w[0].distance(w[1]);
            out.push(w[1]);
        }
        out
    };
    // The way around the slope: the end of the line, backwards, and the beginning of the rest.
    let mut points = head(line);
    points.reverse();
    points.extend(head(after));
    let inside = |a: DVec2, b: DVec2| place.clipper.segment_inside(a, b);
    let (points, _) = rounded(&points, place.least_mm, place.least_mm, &inside);
    let beside = if before.is_empty() { Vec::new() } else { head(before) };
    let met = |w: &[DVec2]| {
        beside.windows(2).any(|b| segment::meeting([w[0], w[1]], [b[0], b[1]]) != Meeting::Apart)
    };
    sharp_turns(&points, false, place.least_mm).is_empty() && !points.windows(2).any(met)
}
