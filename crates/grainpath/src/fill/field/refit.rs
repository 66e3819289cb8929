//! Fits lines once more where some of them were ended before others.
//!
//! Beside a singular point of the field, lines that were moved to the middle of their space may cross, and one of the two ends
//! before the other. The lines beside the place then have more room. Only the stretches of lines around such places are fitted
//! again; the rest stays as it is:
//!
//! 1. lines are cut where they come within the reach of a place and where they leave it;
//! 2. the stretches within the reach begin, end and move as in the rounds before, beside the others; where a stretch was cut,
//!    its end stays;
//! 3. stretches are put together again at the cuts.
//!
//! The steps are this project's own. Lengths are in mm. Cost: linear in the length of the stretches around the places, plus one
//! look at every point. Limits: rings are fitted as a whole; where the fit ends a stretch that was cut, the rest of its line ends at
//! the cut.

use std::collections::HashMap;
use std::mem::take;

use grainpath_core::{Bounds2, DVec2};

use super::widths::{Cuts, FAR_BEADS, Line, Near, bits_of};

/// Stretches of lines that lie so near to a place that a line lost are fitted once more, in spacings. Source: measured on the radial
/// disk with joined ends (`cargo xtask bench jobs fields`), with the phase diffused on one mesh: with 3, 4, 6, 10 and 20, and for all
/// lines, 0.57, 0.60, 0.58, 0.51, 0.46 and 0.46 % stay open, 0.96, 0.82, 0.84, 0.86, 0.86 and 0.86 % are laid twice. In the mean of ten
/// fields 0.45 % stay open with 10.
const FREED_REACH: f64 = 10.0;

/// Lines beside those that are fitted, which stay as they are.
#[derive(Default)]
pub(super) struct Beside {
    /// The lines.
    pub lines: Vec<Line>,
    /// Where they go on in lines that are fitted. These ends are no ends of a bead, so they stay where they are.
    pub cuts: Cuts,
}

/// Lets lines begin, end and fill their space once more around places that lines have lost. `widths` are those of the lines at their
/// points, mm. `fit` does so with stretches of lines beside others, and tells them with their widths. Shorter stretches than
/// `shortest_mm` stay.
pub(super) fn fitted_around(
    freed: &[DVec2],
    (lines, widths): (Vec<Line>, Vec<Vec<f64>>),
    spacing_mm: f64,
    shortest_mm: f64,
    fit: impl FnOnce(Vec<Line>, &Beside) -> (Vec<Line>, Vec<Vec<f64>>),
) -> (Vec<Line>, Vec<Vec<f64>>) {
    let points = || lines.iter().flat_map(|l| l.points.iter().copied());
    let Some(bounds) = Bounds2::around_points(points()) else { return (lines, widths) };
    let around_freed = Near::new(bounds, freed.iter().copied(), FREED_REACH * spacing_mm);
    let (mut moving, mut staying, mut staying_widths) = (Vec::new(), Vec::new(), Vec::new());
    let mut cuts = Cuts::default();
    for (line, widths) in lines.into_iter().zip(widths) {
        let runs = around_freed.runs(&line, shortest_mm);
        let n = line.points.len();
        if runs.is_empty() {
            staying.push(line);
            staying_widths.push(widths);
            continue;
        }
        if line.closed {
            moving.push(line);
            continue;
        }
        // Both parts have the point at which a line is cut.
        let mut from = 0;
        for [first, last] in runs.into_iter().chain([[n - 1; 2]]) {
            if first > from {
                staying.push(Line { points: line.points[from..=first].to_vec(), closed: false });
                staying_widths.push(widths[from..=first].to_vec());
            }
            if last > first {
                let inner = [first, last].into_iter().filter(|v| (1..n - 1).contains(v));
                inner.for_each(|v| cuts.insert(line.points[v]));
                moving.push(Line { points: line.points[first..=last].to_vec(), closed: false });
            }
            from = last;
        }
    }
    // A line with room on one side looks twice as far for one more.
    let far_mm = 2.0 * FAR_BEADS.value() * spacing_mm;
    let around_moving = Near::new(bounds, moving.iter().flat_map(|l| l.points.iter().copied()), far_mm);
    // A line that goes on may pass them along their whole length.
    let near = staying.iter().filter(|line| around_moving.passed_by(line)).cloned();
    let beside = Beside { lines: near.collect(), cuts };
    let (lines, widths) = fit(moving, &beside);
    staying.extend(lines);
    staying_widths.extend(widths);
    rejoined(staying, staying_widths, &beside.cuts)
}

/// Puts lines together that end at one cut.
fn rejoined(mut lines: Vec<Line>, mut widths: Vec<Vec<f64>>, cuts: &Cuts) -> (Vec<Line>, Vec<Vec<f64>>) {
    // End `2 l` is the first point of line `l`, end `2 l + 1` its last.
    let mut joined_to = vec![None; 2 * lines.len()];
    let mut first_at: HashMap<[u64; 2], usize> = HashMap::new();
    for (l, line) in lines.iter().enumerate().filter(|(_, line)| !line.closed) {
        let ends = [line.points[0], line.points[line.points.len() - 1]];
        for (e, p) in ends.into_iter().enumerate().filter(|(_, p)| cuts.contains(*p)) {
            if let Some(f) = first_at.insert(bits_of(p), 2 * l + e) {
                (joined_to[2 * l + e], joined_to[f]) = (Some(f), Some(2 * l + e));
            }
        }
    }
    let chains = chains(lines.len(), &joined_to);
    let joined = |chain: Vec<(usize, bool)>| {
        let closed = chain.len() == 1 && lines[chain[0].0].closed;
        let (mut points, mut wide): (Vec<DVec2>, Vec<f64>) = (Vec::new(), Vec::new());
        for (l, reversed) in chain {
            let (mut more, mut their) = (take(&mut lines[l].points), take(&mut widths[l]));
            if reversed {
                more.reverse();
                their.reverse();
            }
            if points.is_empty() {
                (points, wide) = (more, their);
            } else {
                // The first point of a further line is the last one of the line before.
                points.extend_from_slice(&more[1..]);
                wide.extend_from_slice(&their[1..]);
            }
        }
        (Line { points, closed }, wide)
    };
    chains.into_iter().map(joined).unzip()
}

/// The lines of each chain of `n_lines` lines whose ends are joined, and whether the chain goes through a line from its last point
/// to its first. End `2 l` is the first point of line `l`, end `2 l + 1` its last.
pub(super) fn chains(n_lines: usize, joined_to: &[Option<usize>]) -> Vec<Vec<(usize, bool)>> {
    let mut used = vec![false; n_lines];
    let mut out = Vec::with_capacity(n_lines);
    // Chains are followed from their free ends first; those that remain go round.
    let free = (0..joined_to.len()).filter(|&e| joined_to[e].is_none());
    for first in free.chain((0..n_lines).map(|l| 2 * l)) {
        let (mut at, mut chain) = (first, Vec::new());
        while !used[at / 2] {
            used[at / 2] = true;
            chain.push((at / 2, !at.is_multiple_of(2)));
            let Some(next) = joined_to[at ^ 1] else { break };
            at = next;
        }
        if !chain.is_empty() {
            out.push(chain);
        }
    }
    out
}
