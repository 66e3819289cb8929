//! The virtual strength test: from beads to the load at which a part breaks.
//!
//! Beads become cells of a grid, layers are homogenised through the thickness with directions kept apart
//! ([`cells`]); squares under plane stress are solved ([`plate`]); plies that reach their strength lose it along a
//! straight softening line that spends the card's energy ([`ply`]), and the load is stepped until the part gives way.

pub mod cells;
pub mod plate;
pub mod ply;

use grainpath_core::DVec2;
use rayon::prelude::*;

use crate::material::Unstable;
use crate::plane::PlaneStiffness;
use crate::sparse::SparseError;
use cells::Laminate;
use plate::{Elements, GridHold, System, middle_strain, square};
use ply::{Mode, StrengthCard, broken, lost, spent, turned};

/// A plate made of beads, held, loaded, and drawn until it breaks.
pub struct PlateTest<'a> {
    /// What it is made of.
    pub laminate: &'a Laminate,
    /// Its cells as elements.
    pub elements: &'a Elements,
    /// Where it is held.
    pub holds: &'a [GridHold],
    /// Force at every node, N: the load that a factor of 1 stands for.
    pub forces_n: &'a [DVec2],
    /// What that load is called, N.
    pub load_n: f64,
    /// Elements that do not break: those in grips and under rollers.
    pub spared: &'a [bool],
    /// The materials, as the plies number them.
    pub cards: &'a [StrengthCard],
    /// The most the solver may take.
    pub max_bytes: u64,
}

/// Why there is no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TestError {
    /// The solver gave up.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// The card's constants.
    #[error(transparent)]
    Material(#[from] Unstable),
    /// Nothing is strained by the load.
    #[error("the load strains nothing that can break")]
    Unloaded,
}

/// How a test went.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The most it carries, N.
    pub peak_load_n: f64,
    /// Load at which the first ply begins to break, N.
    pub first_n: f64,
    /// Load over the displacement of where it acts, before anything breaks, N/mm.
    pub stiffness_n_per_mm: f64,
    /// Displacement in mm and load in N, as it is drawn.
    pub curve: Vec<[f64; 2]>,
    /// Share of the energy spent by each mode, in the order of [`Mode::ALL`].
    pub modes: [f64; 5],
    /// Where most energy was spent, mm.
    pub weakest: DVec2,
    /// Share of each element's material that has broken, 0 to 1.
    pub broken: Vec<f32>,
    /// How near each element was to breaking when the first one did, 0 to 1.
    pub index: Vec<f32>,
    /// Unknowns.
    pub dofs: usize,
    /// Solutions and factorisations it took.
    pub effort: [usize; 2],
    /// Whether the load was seen to fall after the peak.
    pub ended: bool,
}

impl Outcome {
    /// The mode that spent most energy.
    pub fn mode(&self) -> Mode {
        let better = |a: &usize, b: &usize| self.modes[*a].total_cmp(&self.modes[*b]).then(b.cmp(a));
        Mode::ALL[(0..5).max_by(better).unwrap_or(0)]
    }
}

/// Steps of the load.
const STEP: f64 = 0.04;
/// The plate has given way when it is this many times as soft as at first.
const SOFT: f64 = 2.5;
/// The most solutions at one load: a plate that has not come to rest by then does not.
const MOST_AT_A_LOAD: usize = 25;
/// The most solutions in a test.
const MOST_SOLUTIONS: usize = 400;
/// Plies are drawn a little further than asked, so that a crack comes to rest in fewer solutions.
const OVER: f64 = 1.7;

/// What a ply has gone through.
#[derive(Debug, Clone, Copy)]
struct State {
    /// Strain over that at which it began to break: through its beads, and between them.
    drawn: [f64; 2],
    /// The mode it broke by.
    mode: Mode,
}

/// How near a ply is to breaking further at a load factor of 1.
#[derive(Debug, Clone, Copy)]
struct Near {
    index: [f64; 2],
    mode: Mode,
}

impl PlateTest<'_> {
    fn cell_mm(&self) -> f64 {
        self.elements.grid.cell_mm
    }

    fn range(&self, element: usize) -> std::ops::Range<usize> {
        let cell = self.elements.cells[element] as usize;
        self.laminate.starts[cell] as usize..self.laminate.starts[cell + 1] as usize
    }

    fn card(&self, ply: usize) -> &StrengthCard {
        &self.cards[usize::from(self.laminate.plies[ply].material)]
    }

    /// How far each ply is drawn until it carries nothing.
    fn draws(&self) -> Vec<[f64; 2]> {
        let of: Vec<[f64; 2]> = self.cards.iter().map(|c| c.draws(self.cell_mm())).collect();
        self.laminate.plies.iter().map(|p| of[usize::from(p.material)]).collect()
    }

    fn losses(&self, state: &State, draws: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| lost(state.drawn[k], draws[k]))
    }

    fn stiffness(
        &self,
        element: usize,
        states: &[State],
        draws: &[[f64; 2]],
    ) -> Result<[[f64; 8]; 8], Unstable> {
        let mut sum: PlaneStiffness = [[0.0; 3]; 3];
        for p in self.range(element) {
            let ply = &self.laminate.plies[p];
            let c = broken(&self.card(p).elastic, self.losses(&states[p], draws[p]))?;
            let c = turned(&c, ply.angle_rad);
            (0..9).for_each(|k| sum[k / 3][k % 3] += ply.thickness_mm * c[k / 3][k % 3]);
        }
        Ok(square(&sum))
    }

    fn near(&self, element: usize, x: &[f64], states: &[State], draws: &[[f64; 2]]) -> Vec<Near> {
        let u = self.elements.corners[element].map(|i| DVec2::new(x[2 * i as usize], x[2 * i as usize + 1]));
        let strain = middle_strain(&u, self.cell_mm());
        let each = |p: usize| {
            let angle = self.laminate.plies[p].angle_rad;
            let (s, c) = grainpath_core::math::sin_cos(angle);
            let [xx, yy, xy] = strain;
            let own = [
                c * c * xx + s * s * yy + s * c * xy,
                s * s * xx + c * c * yy - s * c * xy,
                2.0 * s * c * (yy - xx) + (c * c - s * s) * xy,
            ];
            let losses = self.losses(&states[p], draws[p]);
            let stiffness = broken(&self.card(p).elastic, losses).unwrap_or_default();
            // Per area that still carries: the strength is that of whole material.
            let left = [1.0 - losses[0], 1.0 - losses[1].max(losses[0]), 1.0 - losses[1].max(losses[0])];
            let stress: [f64; 3] = std::array::from_fn(|i| {
                stiffness[i].iter().zip(own).map(|(c, e)| c * e).sum::<f64>() / left[i]
            });
            let (index, mode) = self.card(p).indices(stress);
            Near { index, mode }
        };
        self.range(element).map(each).collect()
    }

    /// Draws the plate until it breaks.
    ///
    /// # Errors
    /// [`TestError`] when it moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn run(&self) -> Result<Outcome, TestError> {
        self.cards.iter().try_for_each(|c| broken(&c.elastic, [0.0; 2]).map(|_| ()))?;
        let draws = self.draws();
        let draws = draws.as_slice();
        let n = self.elements.cells.len();
        let mut states = vec![State { drawn: [1.0; 2], mode: Mode::Along }; self.laminate.plies.len()];
        let first: Vec<[[f64; 8]; 8]> =
            (0..n).into_par_iter().map(|e| self.stiffness(e, &states, draws)).collect::<Result<_, _>>()?;
        let mut system = System::new(self.elements, &|e| first[e], self.holds, self.max_bytes)?;
        drop(first);
        let forces: Vec<f64> = self.forces_n.iter().flat_map(|f| [f.x, f.y]).collect();
        let mut x = vec![0.0; forces.len()];
        let mut test = Progress::default();
        let mut index = Vec::new();
        let (mut level, mut at_load) = (0.0, 0);
        loop {
            system.solve(&forces, &mut x)?;
            let near: Vec<Vec<Near>> =
                (0..n).into_par_iter().map(|e| self.near(e, &x, &states, draws)).collect();
            let critical = self.critical(&near, &states, draws);
            if !critical.is_finite() {
                return Err(TestError::Unloaded);
            }
            let work: f64 = forces.iter().zip(&x).map(|(f, u)| f * u).sum();
            test.push(critical, work);
            if test.factors.len() == 1 {
                let highest =
                    |e: usize| near[e].iter().map(|p| p.index[0].max(p.index[1])).fold(0.0, f64::max);
                index = (0..n).map(|e| (highest(e) * critical) as f32).collect();
            }
            at_load += 1;
            if critical > level {
                level = critical * (1.0 + STEP);
                at_load = 0;
            }
            if test.gave_way() || at_load > MOST_AT_A_LOAD || system.solved >= MOST_SOLUTIONS {
                break;
            }
            let changed = self.draw(&near, &mut states, draws, level);
            let new: Vec<(usize, [[f64; 8]; 8])> = changed
                .into_par_iter()
                .map(|e| self.stiffness(e, &states, draws).map(|k| (e, k)))
                .collect::<Result<_, _>>()?;
            new.iter().for_each(|(e, k)| system.change(*e, k));
        }
        Ok(self.outcome(&test, &states, draws, index, &system))
    }

    /// The load factor at which the next ply breaks further.
    fn critical(&self, near: &[Vec<Near>], states: &[State], draws: &[[f64; 2]]) -> f64 {
        let of = |e: usize| {
            let mut least = f64::INFINITY;
            for (p, near) in self.range(e).zip(&near[e]) {
                for k in 0..2 {
                    let s = states[p].drawn[k];
                    if s < draws[p][k] && near.index[k] > 0.0 {
                        least = least.min(s / near.index[k]);
                    }
                }
            }
            least
        };
        (0..near.len()).filter(|&e| !self.spared[e]).map(of).fold(f64::INFINITY, f64::min)
    }

    /// Draws every ply that stands less than this load; which elements that changed.
    fn draw(&self, near: &[Vec<Near>], states: &mut [State], draws: &[[f64; 2]], level: f64) -> Vec<usize> {
        let mut changed = Vec::new();
        for e in (0..near.len()).filter(|&e| !self.spared[e]) {
            let mut any = false;
            for (p, near) in self.range(e).zip(&near[e]) {
                for k in 0..2 {
                    let now = states[p].drawn[k];
                    let asked = level * near.index[k];
                    if asked > now && now < draws[p][k] {
                        if now == 1.0 {
                            states[p].mode = near.mode;
                        }
                        // Steps that hardly move the stiffness only cost solutions.
                        states[p].drawn[k] = (now + OVER * (asked - now)).max(now * 1.04).min(draws[p][k]);
                        any = true;
                    }
                }
            }
            if any {
                changed.push(e);
            }
        }
        changed
    }

    fn outcome(
        &self,
        test: &Progress,
        states: &[State],
        draws: &[[f64; 2]],
        index: Vec<f32>,
        system: &System,
    ) -> Outcome {
        let mut modes = [0.0; 5];
        let mut broken = Vec::with_capacity(self.elements.cells.len());
        let mut most = (0.0, 0);
        for e in 0..self.elements.cells.len() {
            let (mut energy, mut gone, mut all) = (0.0, 0.0, 0.0);
            for p in self.range(e) {
                let t = self.laminate.plies[p].thickness_mm;
                let card = self.card(p);
                let energies = [card.g_along_n_mm, card.g_across_n_mm];
                let losses = self.losses(&states[p], draws[p]);
                all += t;
                gone += t * losses[0].max(losses[1]);
                for k in 0..2 {
                    let spent = t * energies[k] * spent(states[p].drawn[k], draws[p][k]);
                    // Through the beads is along or crushing; between them all but along.
                    let mode = match (k, states[p].mode) {
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
        let peak = test.best();
        Outcome {
            peak_load_n: peak * self.load_n,
            first_n: test.factors[0] * self.load_n,
            stiffness_n_per_mm: self.load_n * self.load_n / test.works[0],
            curve: test.curve(self.load_n),
            modes,
            weakest: self.weakest(most.1, &broken),
            broken,
            index,
            dofs: system.dofs(),
            effort: [system.solved, system.factored],
            ended: system.solved < MOST_SOLUTIONS,
        }
    }

    /// The middle of what is broken around an element.
    fn weakest(&self, element: usize, broken: &[f32]) -> DVec2 {
        let grid = &self.elements.grid;
        let centre = |e: usize| grid.centre(self.elements.cells[e] as usize);
        let at = centre(element);
        let (mut sum, mut weights) = (DVec2::ZERO, 0.0);
        for e in 0..broken.len() {
            let p = centre(e);
            if p.distance(at) <= 2.0 * grid.cell_mm {
                sum += p * f64::from(broken[e]);
                weights += f64::from(broken[e]);
            }
        }
        if weights > 0.0 { sum / weights } else { at }
    }
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

    fn best(&self) -> f64 {
        self.factors.iter().copied().fold(0.0, f64::max)
    }

    fn gave_way(&self) -> bool {
        self.works.last().is_some_and(|w| *w > SOFT * self.works[0])
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
