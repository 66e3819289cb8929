//! Runs of fibre: paths that are laid with one piece of fibre, and the position of each path in its run.
//!
//! The writer feeds fibre where a run begins. It cuts the fibre before the end, at the distance of the
//! cutter, so that the fibre beyond the cutter is used up. It therefore needs to know, for every path,
//! how much of its run lies before and after it.

use grainpath_core::{Plan, PlannedPath, Role};

/// Position of a path in its run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct InRun {
    /// Whether the run begins with this path.
    pub begins: bool,
    /// Length of the run before the path, mm.
    pub before_mm: f64,
    /// Length of the run after the path, mm.
    pub after_mm: f64,
}

/// The position of every path of a plan in its run. Paths without fibre belong to no run and get the
/// default.
pub(super) fn runs(plan: &Plan) -> Vec<Vec<InRun>> {
    let mut all: Vec<Vec<InRun>> =
        plan.layers.iter().map(|l| vec![InRun::default(); l.paths.len()]).collect();
    // Paths without a segment write nothing and must not separate two pieces.
    let printed = |p: &&PlannedPath| p.path.n_segments() > 0;
    let order: Vec<(usize, usize)> = (plan.layers.iter().enumerate())
        .flat_map(|(i, l)| (0..l.paths.len()).map(move |k| (i, k)))
        .filter(|&(i, k)| printed(&&plan.layers[i].paths[k]))
        .collect();
    let path = |at: usize| &plan.layers[order[at].0].paths[order[at].1];
    let mut at = 0;
    while at < order.len() {
        if path(at).path.role != Role::Fibre {
            at += 1;
            continue;
        }
        // A run continues where the next path is fibre, begins where the last one ended (within the
        // writer's rounding to 1 um) and needs no travel.
        let goes_on = |k: &usize| {
            let (last, next) = (path(*k - 1), path(*k));
            next.path.role == Role::Fibre
                && next.travel.via.is_empty()
                && last.path.end().distance(next.path.start()) < 1.1e-3
        };
        let end = (at + 1..order.len()).find(|k| !goes_on(k)).unwrap_or(order.len());
        let lengths: Vec<f64> = (at..end).map(|k| path(k).path.length_mm()).collect();
        let (mut before_mm, mut after_mm) = (0.0, lengths.iter().sum::<f64>());
        for (k, length) in lengths.iter().enumerate() {
            after_mm -= length;
            let (i, p) = order[at + k];
            all[i][p] = InRun { begins: k == 0, before_mm, after_mm: after_mm.max(0.0) };
            before_mm += length;
        }
        at = end;
    }
    all
}
