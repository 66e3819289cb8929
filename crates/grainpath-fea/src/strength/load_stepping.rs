//! Load stepping: raises the load on a part until the part fails, with damage that softens the plies.
//!
//! A [`LoadedPart`] (a plate or a solid) is linear for a given state of damage, so one solution for the unit load
//! gives every failure index at every load: the damage of a ply grows at the load factor `damage strain / index`,
//! and the smallest such factor is the load that the part carries in that state. The steps are:
//!
//! 1. Solve for the unit load. The smallest load factor of all plies is the load of this state.
//! 2. If it reaches the level of the current step, the part is in equilibrium: the state is stored and the level
//!    rises by one step.
//! 3. Otherwise every ply that fails below the level gets the damage strain that the level demands, and the stiffness
//!    that remains at this strain on a straight softening line. Of elements side by side across one crack only the
//!    weakest is damaged; the next solution shows whether this relieved the others.
//! 4. If the load falls or the part becomes soft, the peak lies within the last step: the test returns to the last
//!    equilibrium and continues in smaller steps, until the smallest step is reached.
//!
//! The peak load is the largest load factor of any state that was solved. It is a lower bound that lies within one step
//! of the peak: every state that counts was in equilibrium. This is a sequentially linear analysis with a secant
//! stiffness (`rots2001` in docs/references.bib) on a crack band (`bazant1983`).
//!
//! Lengths are in mm, loads in N. The cost is one solution for each state, usually 20 to 200.

use std::collections::BTreeMap;
use std::ops::Range;

use grainpath_core::DVec3;
use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::tuned::Tuned;
use rayon::prelude::*;

use super::card::{FailureMode, FinalStrains, StrengthCard};
use super::damage::{damage, energy_share};
use super::{BROKEN_SHARE, Outcome, TestError};

/// Damage of a ply, in this order: through its beads, between them, and between it and the layer below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlyState {
    /// The largest strain that the ply has reached, over the strain at which damage began; 1 for a ply without damage.
    pub damage_strain: [f64; 3],
    /// The strain at which no stiffness is left, over the strain at which damage began.
    pub final_strain: [f64; 3],
    /// The mode in which the ply failed, through and between its beads.
    pub mode: FailureMode,
}

impl PlyState {
    pub(super) fn whole(limits: &FinalStrains) -> Self {
        Self { damage_strain: [1.0; 3], final_strain: limits.opening, mode: FailureMode::Along }
    }

    /// Shares of the stiffness that are lost, 0 to 1.
    pub(super) fn damage(&self) -> [f64; 3] {
        std::array::from_fn(|k| damage(self.damage_strain[k], self.final_strain[k]))
    }
}

/// Failure indices of a ply at the unit load, in the order of [`PlyState`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FailureIndices {
    pub index: [f64; 3],
    /// Whether sliding is a larger part of the index than opening.
    pub slides: [bool; 3],
    pub mode: FailureMode,
}

/// The highest failure index of an element's plies.
pub(super) fn highest_index(indices: impl IntoIterator<Item = FailureIndices>) -> f64 {
    indices.into_iter().flat_map(|i| i.index).fold(0.0, f64::max)
}

/// A part of elements with plies, under supports and a load, that is solved again after each change of damage.
pub(super) trait LoadedPart: Sync {
    fn n_elements(&self) -> usize;
    fn n_plies(&self) -> usize;
    fn plies(&self, element: usize) -> Range<usize>;
    /// The number of a ply's card.
    fn material(&self, _ply: usize) -> usize {
        0
    }
    /// The amount of material in a ply, in a unit that is the same for all plies.
    fn amount(&self, ply: usize) -> f64;
    fn centre(&self, element: usize) -> DVec3;
    fn cell_mm(&self) -> f64;
    /// Whether an element never fails, because it lies in a grip or under a roller.
    fn is_unbreakable(&self, element: usize) -> bool;
    /// The neighbours of an element that lie along the normal of a crack through one of its plies. Damage in them would
    /// widen the crack instead of lengthening it. `how` is the kind of damage, in the order of [`PlyState`].
    fn neighbours_across_crack(&self, _ply: usize, _element: usize, _how: usize) -> Vec<usize> {
        Vec::new()
    }
    /// Solves for the unit load.
    fn solve(&mut self) -> Result<UnitSolution, TestError>;
    /// The failure indices of the plies of an element at the unit load. They replace the content of `out`, whose memory is
    /// used again for the next element. Without a change of the element's strain and states they are the same each time.
    fn failure_indices(&self, element: usize, states: &[PlyState], out: &mut Vec<FailureIndices>);
    /// The highest failure index of each element at the unit load, from which the first failure is told; `states` are those of
    /// undamaged plies.
    fn first_indices(&self, states: &[PlyState]) -> Vec<f64> {
        let highest = |indices: &mut Vec<FailureIndices>, e: usize| {
            self.failure_indices(e, states, indices);
            highest_index(indices.iter().copied())
        };
        (0..self.n_elements()).into_par_iter().map_init(Vec::new, highest).collect()
    }
    /// Gives elements the stiffness that their states leave.
    fn update_stiffness(&mut self, elements: &[usize], states: &[PlyState]) -> Result<(), TestError>;
    /// Raises the damage of a state to the next step for which a stiffness is tabulated.
    fn round_up(&self, _: &mut PlyState) {}
    fn dofs(&self) -> usize;
    /// The work of all solutions so far; 0 for parts whose solutions all cost the same.
    fn solver_work(&self) -> f64 {
        0.0
    }
    fn n_solutions(&self) -> usize;
    fn n_factorizations(&self) -> usize;
}

/// The result of a solution for the unit load.
pub(super) struct UnitSolution {
    /// Sum of force times displacement, N mm. It serves as the flexibility, because the load is the unit load.
    pub force_times_displacement: f64,
    /// The elements whose strain or stiffness changed since the last solution, in order; `None` for all.
    pub changed: Option<Vec<usize>>,
}

/// How the load is raised step by step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StepControl {
    /// The first step of the load, as a share of it.
    pub first_step: f64,
    /// Steps at most this large are not made smaller.
    pub min_step: f64,
    /// The part counts as in equilibrium once all plies carry the level of the load, less this share of it.
    pub tolerance: f64,
    /// The rise of the damage strain that the load demands is multiplied by this, so that a crack stops after fewer
    /// solutions.
    pub overrelaxation: f64,
    /// Damage strain is raised to at least this multiple of its last value: smaller changes hardly change the
    /// stiffness but still cost a solution.
    pub min_growth: f64,
    /// The part has failed when it carries less than this share of its highest load and is also as soft as
    /// `collapse_softening` says.
    pub collapse_load: f64,
    /// Least flexibility of a failed part over that of the last equilibrium, see `collapse_load`.
    pub collapse_softening: f64,
    /// The largest number of solutions in a test.
    pub max_solutions: usize,
    /// The largest work in a test, in the unit of [`LoadedPart::solver_work`].
    pub max_work: f64,
}

/// A part has failed when its flexibility is this multiple of the first one. Source: measured by the test
/// `long_steps_find_the_peak_that_small_ones_do`: without it the beam whose layers part slowly breaks at 19.1 N instead of
/// the 34.5 N that small steps give; at 2.5 both agree within 2 %.
const FAILED_FLEXIBILITY: f64 = 2.5;
/// Each time the part has failed, the step is divided by this number. Measured: row
/// `fea.strength.load_stepping.STEP_REFINEMENT` of `cargo xtask bench constants`.
static STEP_REFINEMENT: Tuned<f64> = Tuned::new("fea.strength.load_stepping.STEP_REFINEMENT", 4.0);

/// Raises the load on a part until the part fails. `size_mm` is the width and the height of its elements; `load_n` is
/// the load at a factor of 1.
///
/// # Errors
/// [`TestError`] when the part cannot be solved, or when the load strains nothing that can fail.
pub(super) fn run_to_failure(
    part: &mut dyn LoadedPart,
    cards: &[StrengthCard],
    size_mm: [f64; 2],
    load_n: f64,
    control: &StepControl,
    cancel: &CancelFlag,
) -> Result<Outcome, TestError> {
    let n = part.n_elements();
    let limits: Vec<FinalStrains> = cards.iter().map(|c| c.final_strains(size_mm[0], size_mm[1])).collect();
    let mut states: Vec<PlyState> =
        (0..part.n_plies()).map(|p| PlyState::whole(&limits[part.material(p)])).collect();
    let mut history = History::default();
    let (mut first_factor, mut first_index) = (0.0, Vec::new());
    let mut equilibrium = Equilibrium::default();
    let mut broke_at = vec![None; n];
    let mut weakest = vec![WeakestPly::NONE; n];
    let (mut level, mut step) = (0.0, control.first_step);
    let past_peak = loop {
        cancel.check()?;
        let UnitSolution { force_times_displacement: flexibility, changed } = part.solve()?;
        let changed = changed.unwrap_or_else(|| (0..n).collect());
        // Only the weakest ply of each element is kept. The indices of all plies would take 32 bytes each, and the few
        // elements that fail can compute theirs again.
        let evaluate = |indices: &mut Vec<FailureIndices>, &e: &usize| {
            part.failure_indices(e, &states, indices);
            weakest_ply(part, e, indices, &states)
        };
        let new: Vec<WeakestPly> = changed.par_iter().map_init(Vec::new, evaluate).collect();
        changed.iter().zip(new).for_each(|(e, new)| weakest[*e] = new);
        // The load factor at which the damage of the next ply grows.
        let critical = weakest.iter().map(|w| w.load_factor).fold(f64::INFINITY, f64::min);
        if !critical.is_finite() {
            if history.factors.is_empty() {
                return Err(TestError::Unloaded);
            }
            break true;
        }
        history.push(critical, flexibility);
        if first_index.is_empty() {
            let highest = part.first_indices(&states);
            let breakable = highest.iter().enumerate().filter(|(e, _)| !part.is_unbreakable(*e));
            let most = breakable.map(|(_, index)| *index).fold(0.0, f64::max);
            first_factor = if most > 0.0 { 1.0 / most } else { critical };
            first_index = highest.into_iter().map(|index| (index * first_factor) as f32).collect();
        }
        let collapsed = critical < control.collapse_load * history.max_factor()
            && flexibility > control.collapse_softening * equilibrium.flexibility;
        let failed = collapsed || flexibility > FAILED_FLEXIBILITY * history.flexibilities[0];
        let exhausted = part.n_solutions() >= control.max_solutions || part.solver_work() >= control.max_work;
        if exhausted || (failed && step <= control.min_step) {
            break !exhausted;
        }
        if failed {
            // The peak lies within this step: the test returns to the last equilibrium and continues
            // in smaller steps. Plies that have not changed since the equilibrium need no reset.
            let before = std::mem::take(&mut equilibrium.before);
            before.iter().for_each(|(e, before)| states[part.plies(*e)].copy_from_slice(before));
            let changed: Vec<usize> = before.into_keys().collect();
            part.update_stiffness(&changed, &states)?;
            for e in changed.into_iter().filter(|e| lost_share(part, &states, *e) < BROKEN_SHARE) {
                broke_at[e] = None;
            }
            history.return_to(equilibrium.n_states);
            step /= STEP_REFINEMENT.value();
            level = equilibrium.factor * (1.0 + step);
            continue;
        }
        if critical > (1.0 - control.tolerance) * level {
            equilibrium.before.clear();
            equilibrium.factor = critical;
            equilibrium.n_states = history.factors.len();
            equilibrium.flexibility = flexibility;
            level = critical * (1.0 + step);
        }
        let grown = grow_damage(part, &weakest, &mut states, &limits, level, control);
        let changed: Vec<usize> = grown.iter().map(|(e, _)| *e).collect();
        // The first stored state of an element is that of the equilibrium; later ones must not replace it.
        for (e, before) in grown {
            equilibrium.before.entry(e).or_insert(before);
        }
        part.update_stiffness(&changed, &states)?;
        for &e in changed.iter().filter(|e| lost_share(part, &states, **e) >= BROKEN_SHARE) {
            // The current damage takes effect in the next state that is solved.
            broke_at[e].get_or_insert(history.factors.len() as u32);
        }
    };
    let last = history.factors.len().saturating_sub(1) as u32;
    let broke_at = broke_at.into_iter().map(|at| at.map(|at| at.min(last))).collect();
    let first = FirstFailed { factor: first_factor.min(history.max_factor()), index: first_index };
    Ok(Outcome { broke_at, ..outcome(part, cards, &history, &states, load_n, first, past_peak) })
}

/// The last state in which the part carried the level of the load.
#[derive(Default)]
struct Equilibrium {
    /// The states that plies had in this equilibrium, by element, for elements that have changed since.
    before: BTreeMap<usize, Vec<PlyState>>,
    factor: f64,
    /// Number of states in the history up to this one.
    n_states: usize,
    flexibility: f64,
}

/// The ply of an element whose damage grows first, with the kind of damage and the load factor at which it grows.
#[derive(Clone, Copy)]
struct WeakestPly {
    load_factor: f64,
    ply: usize,
    how: usize,
}

impl WeakestPly {
    const NONE: Self = Self { load_factor: f64::INFINITY, ply: 0, how: 0 };
}

/// The weakest ply of an element; none where the element is unbreakable.
fn weakest_ply(
    part: &dyn LoadedPart,
    element: usize,
    indices: &[FailureIndices],
    states: &[PlyState],
) -> WeakestPly {
    let mut weakest = WeakestPly::NONE;
    if part.is_unbreakable(element) {
        return weakest;
    }
    for (ply, indices) in part.plies(element).zip(indices) {
        let state = &states[ply];
        for how in 0..3 {
            let load_factor = state.damage_strain[how] / indices.index[how];
            if state.damage_strain[how] < state.final_strain[how]
                && indices.index[how] > 0.0
                && load_factor < weakest.load_factor
            {
                weakest = WeakestPly { load_factor, ply, how };
            }
        }
    }
    weakest
}

/// Raises the damage of plies that fail below a level of the load. Of elements side by side across a crack only the
/// weakest is damaged: together they spend the energy of one crack, and the first to lose stiffness relieves the
/// others. Returns the elements that changed, with their states until now.
fn grow_damage(
    part: &dyn LoadedPart,
    weakest: &[WeakestPly],
    states: &mut [PlyState],
    limits: &[FinalStrains],
    level: f64,
    control: &StepControl,
) -> Vec<(usize, Vec<PlyState>)> {
    let mut changed = Vec::new();
    let mut indices = Vec::new();
    let is_weakest_across = |e: usize| {
        let own = weakest[e];
        let mut neighbours = part.neighbours_across_crack(own.ply, e, own.how).into_iter();
        neighbours.all(|other| {
            let its = weakest[other].load_factor;
            its > own.load_factor || (its == own.load_factor && other > e)
        })
    };
    for e in (0..weakest.len()).filter(|&e| weakest[e].load_factor < level && is_weakest_across(e)) {
        let mut element_changed = false;
        // Only the states of an element that fails are copied, which is far less than a copy of all plies.
        let unchanged = states[part.plies(e)].to_vec();
        part.failure_indices(e, states, &mut indices);
        for (p, indices) in part.plies(e).zip(&indices) {
            let state = &mut states[p];
            let limits = &limits[part.material(p)];
            let mut ply_changed = false;
            for k in 0..3 {
                let now = state.damage_strain[k];
                let demand = level * indices.index[k];
                if demand > now && now < state.final_strain[k] {
                    if now == 1.0 {
                        state.final_strain[k] =
                            if indices.slides[k] { limits.sliding[k] } else { limits.opening[k] };
                        if k < 2 {
                            state.mode = indices.mode;
                        }
                    }
                    state.damage_strain[k] = (now + control.overrelaxation * (demand - now))
                        .max(now * control.min_growth)
                        .min(state.final_strain[k]);
                    ply_changed = true;
                }
            }
            if ply_changed {
                part.round_up(state);
                element_changed = true;
            }
        }
        if element_changed {
            changed.push((e, unchanged));
        }
    }
    changed
}

/// The share of its stiffness that an element has lost; for each ply the most advanced damage counts.
fn lost_share(part: &dyn LoadedPart, states: &[PlyState], element: usize) -> f32 {
    let (mut lost, mut all) = (0.0, 0.0);
    for p in part.plies(element) {
        all += part.amount(p);
        lost += part.amount(p) * states[p].damage().into_iter().fold(0.0, f64::max);
    }
    (lost / f64::max(all, 1e-30)) as f32
}

/// The load factor of the first failure, and the highest failure index of each element at it.
struct FirstFailed {
    factor: f64,
    index: Vec<f32>,
}

/// The outcome but for the states in which elements broke.
fn outcome(
    part: &dyn LoadedPart,
    cards: &[StrengthCard],
    history: &History,
    states: &[PlyState],
    load_n: f64,
    first: FirstFailed,
    past_peak: bool,
) -> Outcome {
    let mut mode_shares = [0.0; 5];
    let mut damage = Vec::with_capacity(part.n_elements());
    let mut most_energy = (0.0, 0);
    for e in 0..part.n_elements() {
        let mut energy = 0.0;
        for p in part.plies(e) {
            let amount = part.amount(p);
            let card = &cards[part.material(p)];
            let energies = [card.g_along_n_mm, card.g_across_n_mm, card.g_across_n_mm];
            for k in 0..3 {
                let spent = amount
                    * energies[k]
                    * energy_share(states[p].damage_strain[k], states[p].final_strain[k]);
                // Damage through the beads is tension or crushing; between them, any mode but tension along them.
                let mode = match (k, states[p].mode) {
                    (2, _) => FailureMode::Layers,
                    (0, FailureMode::Compression) => FailureMode::Compression,
                    (0, _) => FailureMode::Along,
                    (_, FailureMode::Along) => FailureMode::Across,
                    (_, mode) => mode,
                };
                energy += spent;
                mode_shares[mode as usize] += spent;
            }
        }
        damage.push(lost_share(part, states, e));
        if energy > most_energy.0 {
            most_energy = (energy, e);
        }
    }
    let sum: f64 = mode_shares.iter().sum();
    mode_shares.iter_mut().for_each(|m| *m /= f64::max(sum, f64::MIN_POSITIVE));
    Outcome {
        peak_load_n: history.max_factor() * load_n,
        first_failure_n: first.factor * load_n,
        stiffness_n_per_mm: load_n * load_n / history.flexibilities[0],
        curve: history.curve(load_n),
        states: history.points(load_n).collect(),
        mode_shares,
        weakest: centre_of_damage(part, most_energy.1, &damage),
        damage,
        broke_at: Vec::new(),
        failure_index: first.index,
        dofs: part.dofs(),
        solutions: part.n_solutions(),
        factorizations: part.n_factorizations(),
        past_peak,
    }
}

/// The mean place of the damage within two cells of an element.
fn centre_of_damage(part: &dyn LoadedPart, element: usize, damage: &[f32]) -> DVec3 {
    let centre = part.centre(element);
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for e in 0..damage.len() {
        let p = part.centre(e);
        if damage[e] > 0.0 && p.distance(centre) <= 2.0 * part.cell_mm() {
            sum += p * f64::from(damage[e]);
            weights += f64::from(damage[e]);
        }
    }
    if weights > 0.0 { sum / weights } else { centre }
}

/// A point of the curve of load over displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CurvePoint {
    /// Displacement of the load along itself, mm.
    pub displacement_mm: f64,
    /// Load, N.
    pub load_n: f64,
}

/// Load factor and flexibility of every state that was solved.
#[derive(Default)]
struct History {
    factors: Vec<f64>,
    flexibilities: Vec<f64>,
}

impl History {
    fn push(&mut self, factor: f64, flexibility: f64) {
        self.factors.push(factor);
        self.flexibilities.push(flexibility);
    }

    /// Drops the states after the first `n_states`, but keeps those up to the highest load.
    fn return_to(&mut self, n_states: usize) {
        let max = self.max_factor();
        let keep = self.factors.iter().position(|f| *f >= max).map_or(n_states, |i| n_states.max(i + 1));
        self.factors.truncate(keep);
        self.flexibilities.truncate(keep);
    }

    fn max_factor(&self) -> f64 {
        self.factors.iter().copied().fold(0.0, f64::max)
    }

    /// Displacement and load of every state.
    fn points(&self, load_n: f64) -> impl Iterator<Item = CurvePoint> {
        let both = self.factors.iter().zip(&self.flexibilities);
        both.map(move |(f, w)| CurvePoint { displacement_mm: f * w / load_n, load_n: f * load_n })
    }

    /// The points at which the load reaches a new maximum, and after the peak those on the way down.
    fn curve(&self, load_n: f64) -> Vec<CurvePoint> {
        let mut curve = vec![CurvePoint::default()];
        let max = self.max_factor();
        let (mut highest, mut after_peak) = (0.0, false);
        for (f, point) in self.factors.iter().zip(self.points(load_n)) {
            let descends = curve.last().is_some_and(|last: &CurvePoint| {
                point.displacement_mm >= last.displacement_mm && point.load_n <= last.load_n
            });
            if (!after_peak && *f > highest) || (after_peak && descends) {
                curve.push(point);
            }
            highest = f64::max(highest, *f);
            after_peak |= *f >= max;
        }
        curve
    }
}
