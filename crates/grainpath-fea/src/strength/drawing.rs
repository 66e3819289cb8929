//! Drawing a body until it breaks: the load rises in steps, plies that stand less lose stiffness until all stand it.

use std::ops::Range;

use grainpath_core::DVec3;
use rayon::prelude::*;

use super::ply::{Draws, Mode, StrengthCard, spent};
use super::{Outcome, TestError};

/// What a ply has gone through: through its beads, between them, and between it and the layer below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct State {
    /// Strain over that at which it began to break.
    pub drawn: [f64; 3],
    /// That strain at which nothing is left.
    pub most: [f64; 3],
    /// The mode it broke by, through and between its beads.
    pub mode: Mode,
}

impl State {
    fn whole(draws: &Draws) -> Self {
        Self { drawn: [1.0; 3], most: draws.opened, mode: Mode::Along }
    }

    /// Shares of stiffness lost.
    pub fn losses(&self) -> [f64; 3] {
        std::array::from_fn(|k| super::ply::lost(self.drawn[k], self.most[k]))
    }
}

/// How near a ply is to breaking further at a load factor of 1.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Near {
    pub index: [f64; 3],
    /// Whether sliding, not opening, is the greater part of it.
    pub slides: [bool; 3],
    pub mode: Mode,
}

/// Elements with plies, held and loaded, that can be solved again and again.
pub(super) trait Body: Sync {
    fn n_elements(&self) -> usize;
    fn n_plies(&self) -> usize;
    fn plies(&self, element: usize) -> Range<usize>;
    /// Which of the cards a ply has.
    fn material(&self, _ply: usize) -> usize {
        0
    }
    /// How much there is of a ply, in a unit that is the same for all.
    fn amount(&self, ply: usize) -> f64;
    fn centre(&self, element: usize) -> DVec3;
    fn cell_mm(&self) -> f64;
    fn is_spared(&self, element: usize) -> bool;
    /// Elements over whose sides and corners a crack through a ply of this one would run on to widen, not to grow:
    /// those that lie along its normal. `how` is through its beads, between them, between layers.
    fn rivals(&self, _ply: usize, _element: usize, _how: usize) -> Vec<usize> {
        Vec::new()
    }
    /// Solves for a load factor of 1 and gives force times displacement, and the elements whose nodes have moved or that
    /// have changed, in order; `None` for all.
    fn solve(&mut self) -> Result<(f64, Option<Vec<usize>>), TestError>;
    fn near(&self, element: usize, states: &[State]) -> Vec<Near>;
    /// Gives elements the stiffness that these states leave.
    fn change(&mut self, elements: &[usize], states: &[State]) -> Result<(), TestError>;
    /// Moves a state on to the next one for which there is a stiffness.
    fn settle(&self, _: &mut State) {}
    fn dofs(&self) -> usize;
    /// What solving took so far, for bodies whose solutions differ in it.
    fn work(&self) -> f64 {
        0.0
    }
    /// Solutions and factorisations so far.
    fn effort(&self) -> [usize; 2];
}

/// How the load is stepped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    /// The first step of the load.
    pub step: f64,
    /// The step below which the peak is not looked for more closely.
    pub finest: f64,
    /// A body rests once all plies stand this share less than the load.
    pub slack: f64,
    /// Plies are drawn so many times as far as asked, so that a crack comes to rest in fewer solutions, and so many
    /// times as far as before at least: steps that hardly move the stiffness only cost solutions.
    pub over: [f64; 2],
    /// A body has also given way when it carries less than this share of the highest load, so many times as soft as when it last rested.
    pub fallen: [f64; 2],
    /// The most solutions in a test.
    pub most_solutions: usize,
    /// The most work in a test, in the body's own unit.
    pub most_work: f64,
}

/// A body has given way when it is this many times as soft as at first.
const SOFT: f64 = 2.5;
/// Steps become this many times smaller where a body gave way.
const CLOSER: f64 = 4.0;

/// Draws a body until it breaks. `size_mm` is width and height of its cells.
///
/// # Errors
/// [`TestError`] when it cannot be solved or nothing is strained.
pub(super) fn draw(
    body: &mut dyn Body,
    cards: &[StrengthCard],
    size_mm: [f64; 2],
    load_n: f64,
    pace: &Pace,
) -> Result<Outcome, TestError> {
    let n = body.n_elements();
    let draws: Vec<Draws> = cards.iter().map(|c| c.draws(size_mm[0], size_mm[1])).collect();
    let mut states: Vec<State> =
        (0..body.n_plies()).map(|p| State::whole(&draws[body.material(p)])).collect();
    let mut test = Progress::default();
    let mut index = Vec::new();
    // The last state in which the body stood its load, and which elements changed since.
    let (mut rest, mut rest_factor, mut rest_len, mut rest_work) = (states.clone(), 0.0, 0, 0.0);
    let mut touched = Vec::new();
    // What each element stands.
    let (mut near, mut weak) = (vec![Vec::new(); n], vec![Weakest::NONE; n]);
    let (mut level, mut step) = (0.0, pace.step);
    let ended = loop {
        let (work, moved) = body.solve()?;
        let moved = moved.unwrap_or_else(|| (0..n).collect());
        let looked = |&e: &usize| {
            let near = body.near(e, &states);
            let weakest = weakest(body, e, &near, &states);
            (near, weakest)
        };
        let new: Vec<_> = moved.par_iter().map(looked).collect();
        for (e, new) in moved.into_iter().zip(new) {
            (near[e], weak[e]) = new;
        }
        // The load factor at which the next ply breaks further.
        let critical = weak.iter().map(|w| w.stands).fold(f64::INFINITY, f64::min);
        if !critical.is_finite() {
            if test.factors.is_empty() {
                return Err(TestError::Unloaded);
            }
            break true;
        }
        test.push(critical, work);
        if index.is_empty() {
            let highest = |e: usize| near[e].iter().flat_map(|p| p.index).fold(0.0, f64::max);
            index = (0..n).map(|e| (highest(e) * critical) as f32).collect();
        }
        let fallen = critical < pace.fallen[0] * test.best() && work > pace.fallen[1] * rest_work;
        let fell = fallen || work > SOFT * test.works[0];
        let out = body.effort()[0] >= pace.most_solutions || body.work() >= pace.most_work;
        if out || (fell && step <= pace.finest) {
            break !out;
        }
        if fell {
            // The peak lies in between: back to where it stood, and on in smaller steps.
            states.clone_from(&rest);
            body.change(&touched, &states)?;
            touched.clear();
            test.back_to(rest_len);
            step /= CLOSER;
            level = rest_factor * (1.0 + step);
            continue;
        }
        if critical > (1.0 - pace.slack) * level {
            rest.clone_from(&states);
            touched.clear();
            (rest_factor, rest_len, rest_work) = (critical, test.factors.len(), work);
            level = critical * (1.0 + step);
        }
        let changed = drawn(body, &near, &weak, &mut states, &draws, level, pace.over);
        body.change(&changed, &states)?;
        touched.extend(changed);
        touched.sort_unstable();
        touched.dedup();
    };
    Ok(outcome(body, cards, &test, &states, load_n, index, ended))
}

/// The ply of an element that breaks further first, how, and the load factor that it stands.
#[derive(Clone, Copy)]
struct Weakest {
    stands: f64,
    ply: usize,
    how: usize,
}

impl Weakest {
    const NONE: Self = Self { stands: f64::INFINITY, ply: 0, how: 0 };
}

/// Of an element; those that are spared stand everything.
fn weakest(body: &dyn Body, element: usize, near: &[Near], states: &[State]) -> Weakest {
    let mut weakest = Weakest::NONE;
    if body.is_spared(element) {
        return weakest;
    }
    for (ply, near) in body.plies(element).zip(near) {
        let state = &states[ply];
        for how in 0..3 {
            let stands = state.drawn[how] / near.index[how];
            if state.drawn[how] < state.most[how] && near.index[how] > 0.0 && stands < weakest.stands {
                weakest = Weakest { stands, ply, how };
            }
        }
    }
    weakest
}

/// Draws plies that stand less than this load, but one row of elements only where several would break side by side:
/// they spend the energy of one crack, and the first to lose stiffness relieves the others. Which elements changed.
fn drawn(
    body: &dyn Body,
    near: &[Vec<Near>],
    weakest: &[Weakest],
    states: &mut [State],
    draws: &[Draws],
    level: f64,
    [over, least]: [f64; 2],
) -> Vec<usize> {
    let mut changed = Vec::new();
    let first = |e: usize| {
        let own = weakest[e];
        let mut rivals = body.rivals(own.ply, e, own.how).into_iter();
        rivals.all(|r| weakest[r].stands > own.stands || (weakest[r].stands == own.stands && r > e))
    };
    for e in (0..near.len()).filter(|&e| weakest[e].stands < level && first(e)) {
        let mut any = false;
        for (p, near) in body.plies(e).zip(&near[e]) {
            let state = &mut states[p];
            let draws = &draws[body.material(p)];
            let mut own = false;
            for k in 0..3 {
                let now = state.drawn[k];
                let asked = level * near.index[k];
                if asked > now && now < state.most[k] {
                    if now == 1.0 {
                        state.most[k] = if near.slides[k] { draws.slid[k] } else { draws.opened[k] };
                        if k < 2 {
                            state.mode = near.mode;
                        }
                    }
                    state.drawn[k] = (now + over * (asked - now)).max(now * least).min(state.most[k]);
                    own = true;
                }
            }
            if own {
                body.settle(state);
                any = true;
            }
        }
        if any {
            changed.push(e);
        }
    }
    changed
}

fn outcome(
    body: &dyn Body,
    cards: &[StrengthCard],
    test: &Progress,
    states: &[State],
    load_n: f64,
    index: Vec<f32>,
    ended: bool,
) -> Outcome {
    let mut modes = [0.0; 5];
    let mut broken = Vec::with_capacity(body.n_elements());
    let mut most = (0.0, 0);
    for e in 0..body.n_elements() {
        let (mut energy, mut gone, mut all) = (0.0, 0.0, 0.0);
        for p in body.plies(e) {
            let amount = body.amount(p);
            let card = &cards[body.material(p)];
            let energies = [card.g_along_n_mm, card.g_across_n_mm, card.g_across_n_mm];
            all += amount;
            gone += amount * states[p].losses().into_iter().fold(0.0, f64::max);
            for k in 0..3 {
                let spent = amount * energies[k] * spent(states[p].drawn[k], states[p].most[k]);
                // Through the beads is along or crushing; between them all but along.
                let mode = match (k, states[p].mode) {
                    (2, _) => Mode::Layers,
                    (0, Mode::Compression) => Mode::Compression,
                    (0, _) => Mode::Along,
                    (_, Mode::Along) => Mode::Across,
                    (_, mode) => mode,
                };
                energy += spent;
                modes[mode as usize] += spent;
            }
        }
        broken.push((gone / f64::max(all, 1e-30)) as f32);
        if energy > most.0 {
            most = (energy, e);
        }
    }
    let sum: f64 = modes.iter().sum();
    modes.iter_mut().for_each(|m| *m /= f64::max(sum, f64::MIN_POSITIVE));
    Outcome {
        peak_load_n: test.best() * load_n,
        first_n: test.factors[0] * load_n,
        stiffness_n_per_mm: load_n * load_n / test.works[0],
        curve: test.curve(load_n),
        modes,
        weakest: middle_of_broken(body, most.1, &broken),
        broken,
        index,
        dofs: body.dofs(),
        effort: body.effort(),
        ended,
    }
}

/// The middle of what is broken around an element.
fn middle_of_broken(body: &dyn Body, element: usize, broken: &[f32]) -> DVec3 {
    let at = body.centre(element);
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for e in 0..broken.len() {
        let p = body.centre(e);
        if broken[e] > 0.0 && p.distance(at) <= 2.0 * body.cell_mm() {
            sum += p * f64::from(broken[e]);
            weights += f64::from(broken[e]);
        }
    }
    if weights > 0.0 { sum / weights } else { at }
}

/// Load factors and work of a unit load, solution by solution.
#[derive(Default)]
struct Progress {
    factors: Vec<f64>,
    works: Vec<f64>,
}

impl Progress {
    fn push(&mut self, factor: f64, work: f64) {
        self.factors.push(factor);
        self.works.push(work);
    }

    /// Forgets what came after so many solutions, but for the highest load seen on the way.
    fn back_to(&mut self, len: usize) {
        let best = self.best();
        let keep = self.factors.iter().position(|f| *f >= best).map_or(len, |at| len.max(at + 1));
        self.factors.truncate(keep);
        self.works.truncate(keep);
    }

    fn best(&self) -> f64 {
        self.factors.iter().copied().fold(0.0, f64::max)
    }

    /// Displacement and load at each new height of the load, and on the way down after the peak.
    fn curve(&self, load_n: f64) -> Vec<[f64; 2]> {
        let mut curve = vec![[0.0, 0.0]];
        let best = self.best();
        let (mut highest, mut down) = (0.0, false);
        for (f, w) in self.factors.iter().zip(&self.works) {
            let point = [f * w / load_n, f * load_n];
            let further =
                curve.last().is_some_and(|last: &[f64; 2]| point[0] >= last[0] && point[1] <= last[1]);
            if (!down && *f > highest) || (down && further) {
                curve.push(point);
            }
            highest = f64::max(highest, *f);
            down |= *f >= best;
        }
        curve
    }
}
