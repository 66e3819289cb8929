//! Ends paths before other paths that they would cross.
//!
//! Turns are laid on corners that are rounded afterwards, and lines of several groups meet in the corners of an area. So a
//! rounded path can cross another one, or itself. Fibre cannot be laid over fibre: one of both is cut there and ends a spacing
//! before the other:
//!
//! ```text
//!         |                        |
//!         |                        |
//!    -----+------ b           -----|   -- b
//!         |                        |
//!         a                        a
//! ```
//!
//! Method: of the two cuts that are possible at a crossing, the one is made that leaves more length in paths that are long enough.
//! Cutting adds no crossing, so this ends. Lengths are in mm. Cost: linear in the segments and the crossings, once for every
//! round of cuts. Limit: paths that come near each other and do not cross stay as they are.

use std::collections::BTreeSet;

use super::surroundings::CUT_SPACINGS;
use crate::polyline::resampled;
use crate::segment::{self, Meeting};
use crate::segments::Segments;
use crate::{DVec2, Toolpath};

/// A cut path ends this far from the other, in spacings. Source: as `CLOSER` of the turns.
const APART: f64 = 0.98;
/// A cut reaches this far from the crossing along either path at most, in spacings. Source: derived; two paths that cross at 7
/// degrees are a spacing apart after that way.
const REACH: f64 = 8.0;
/// Steps in which a cut looks for its end, in spacings. Source: chosen; less than a printer can show.
const STEP: f64 = 0.02;

/// Cuts paths, which have one width each, where they cross. What is longer than `needed_mm` is worth keeping whole.
///
/// ```
/// use grainpath_core::wide_turns::uncrossed;
/// use grainpath_core::{DVec2, Role, Toolpath};
///
/// let line = |a, b| Toolpath::new(vec![DVec2::from(a), DVec2::from(b)], 1.0, Role::Fibre, false);
/// let paths = vec![line((0.0, 0.0), (100.0, 0.0)), line((30.0, -80.0), (30.0, 10.0))];
/// // The upper end of the second path is shorter than any other part at the crossing.
/// let paths = uncrossed(paths, 1.0, 50.0);
/// assert_eq!(paths.len(), 3);
/// assert_eq!(paths[0].length_mm(), 100.0);
/// assert!((paths[1].length_mm() - 79.0).abs() < 0.05);
/// ```
pub fn uncrossed(mut paths: Vec<Toolpath>, spacing_mm: f64, needed_mm: f64) -> Vec<Toolpath> {
    loop {
        let crossings = crossings(&paths, spacing_mm);
        if crossings.is_empty() {
            return paths;
        }
        // A path is cut once in a round, since a cut may take other crossings away.
        let mut met = BTreeSet::new();
        let mut pieces: Vec<Option<Vec<Toolpath>>> = vec![None; paths.len()];
        for pair in crossings {
            if pair.iter().any(|place| met.contains(&place.path)) {
                continue;
            }
            met.extend(pair.iter().map(|place| place.path));
            // What lies in long paths, less what their cuts are worth, and all that is laid.
            let worth_mm = |pieces: &[Toolpath]| -> [f64; 2] {
                let lengths_mm = || pieces.iter().map(Toolpath::length_mm);
                let long = lengths_mm().filter(|&mm| mm >= needed_mm);
                [long.map(|mm| mm - CUT_SPACINGS * spacing_mm).sum(), lengths_mm().sum()]
            };
            let [first, second] = pair;
            let cuts = [(first, second), (second, first)].map(|(place, other)| {
                let pieces = cut(&paths[place.path], place, (&paths[other.path], other), spacing_mm);
                let [now, before] = [&pieces[..], &paths[place.path..=place.path]].map(worth_mm);
                ([0, 1].map(|k| before[k] - now[k]), place.path, pieces)
            });
            let [one, other] = cuts;
            let cheaper = one.0[0].total_cmp(&other.0[0]).then(one.0[1].total_cmp(&other.0[1])).is_le();
            let (_, path, left) = if cheaper { one } else { other };
            pieces[path] = Some(left);
        }
        paths =
            paths.into_iter().zip(pieces).flat_map(|(path, cut)| cut.unwrap_or_else(|| vec![path])).collect();
    }
}

/// Whether paths cross each other or themselves, as those of a pattern with several families of lines do.
///
/// ```
/// use grainpath_core::wide_turns::any_cross;
/// use grainpath_core::{DVec2, Role, Toolpath};
///
/// let line = |a, b| Toolpath::new(vec![DVec2::from(a), DVec2::from(b)], 1.0, Role::Fibre, false);
/// let across = line((0.0, 0.0), (100.0, 0.0));
/// assert!(any_cross(&[across.clone(), line((30.0, -80.0), (30.0, 10.0))], 1.0));
/// // A path that ends on another does not cross it.
/// assert!(!any_cross(&[across, line((30.0, -80.0), (30.0, 0.0))], 1.0));
/// ```
pub fn any_cross(paths: &[Toolpath], spacing_mm: f64) -> bool {
    let segments = paths.iter().flat_map(|path| (0..path.n_segments()).map(|k| path.segment(k)));
    let all = Segments::new(segments.map(|(a, b, _)| [a, b]).collect(), 2.0 * spacing_mm);
    let crosses = |[i, j]: [usize; 2]| segment::meeting(all.ends(i), all.ends(j)) == Meeting::Cross;
    all.meetings().into_iter().any(crosses)
}

/// A place on a path.
#[derive(Clone, Copy)]
struct On {
    path: usize,
    /// Distance from its beginning, mm.
    along_mm: f64,
}

/// Places at which two paths, or two segments of one that do not follow each other, have a point in common.
fn crossings(paths: &[Toolpath], spacing_mm: f64) -> Vec<[On; 2]> {
    // Path and number of each segment, and how far from its path's beginning it begins.
    let mut segments = Vec::new();
    let mut of: Vec<(usize, usize, f64)> = Vec::new();
    for (p, path) in paths.iter().enumerate() {
        let mut along_mm = 0.0;
        for k in 0..path.n_segments() {
            let (a, b, _) = path.segment(k);
            segments.push([a, b]);
            of.push((p, k, along_mm));
            along_mm += a.distance(b);
        }
    }
    let follow = |i: usize, j: usize| {
        let ((p, k, _), (q, l, _)) = (of[i], of[j]);
        let n = paths[p].n_segments();
        p == q && (k.abs_diff(l) <= 1 || (paths[p].closed && k.abs_diff(l) == n - 1))
    };
    let all = Segments::new(segments, 2.0 * spacing_mm);
    let place = |i: usize, j: usize| {
        let ([a, b], [c, d]) = (all.ends(i), all.ends(j));
        // The share of the way from `a` to `b` at which the other segment is met. Segments on one line meet somewhere.
        let (from_a, to_b) = (segment::turn(c, d, a).abs(), segment::turn(c, d, b).abs());
        let share = if from_a + to_b > 0.0 { from_a / (from_a + to_b) } else { 0.5 };
        On { path: of[i].0, along_mm: of[i].2 + share * a.distance(b) }
    };
    let met = all.meetings().into_iter().filter(|&[i, j]| !follow(i, j));
    met.map(|[i, j]| [place(i, j), place(j, i)]).collect()
}

/// What is left of a path that is cut at a place and ends before another.
fn cut(path: &Toolpath, at: On, (other, there): (&Toolpath, On), spacing_mm: f64) -> Vec<Toolpath> {
    let reach_mm = REACH * spacing_mm;
    let beside = other.clone().opened().part(there.along_mm - reach_mm, there.along_mm + reach_mm).points;
    let is_near = |p: DVec2| {
        let apart_mm2 = (APART * spacing_mm).powi(2);
        beside.windows(2).any(|w| segment::distance_squared_mm2(p, w[0], w[1]) < apart_mm2)
    };
    // A ring is opened at the cut, with which it begins and ends.
    let length_mm = path.length_mm();
    let open = path.clone().opened();
    let rounds = if path.closed {
        let mut twice = open.clone();
        twice.points.extend(&open.points[1..]);
        twice.part(at.along_mm, at.along_mm + length_mm)
    } else {
        open
    };
    let [low_mm, high_mm] = if path.closed { [length_mm, 0.0] } else { [at.along_mm; 2] };
    // How far from the crossing the cut ends on one side of it, from the points of that side.
    let away_mm = |mut side: Vec<DVec2>, is_before: bool| {
        if is_before {
            side.reverse();
        }
        let step_mm = STEP * spacing_mm;
        let first = resampled(&side, false, step_mm).iter().position(|p| !is_near(*p));
        // Equal steps are not exactly as long as asked for; one more makes up for it, so that every cut takes something away.
        first.map_or(reach_mm, |k| (k + 1) as f64 * step_mm)
    };
    let before_mm = low_mm - away_mm(rounds.part(low_mm - reach_mm, low_mm).points, true);
    let after_mm = high_mm + away_mm(rounds.part(high_mm, high_mm + reach_mm).points, false);
    let parts =
        if path.closed { vec![[after_mm, before_mm]] } else { vec![[0.0, before_mm], [after_mm, length_mm]] };
    // What is shorter than a bead is wide is left out, as at sharp turns.
    let long = parts.into_iter().filter(|[from_mm, to_mm]| to_mm - from_mm > spacing_mm);
    long.map(|[from_mm, to_mm]| Toolpath { closed: false, ..rounds.part(from_mm, to_mm) }).collect()
}
