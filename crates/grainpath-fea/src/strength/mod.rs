//! The virtual strength test: from beads to the load at which a part breaks.
//!
//! Beads become cells of a grid, layers are homogenised through the thickness with directions kept apart
//! ([`cells`]); squares under plane stress are solved ([`plate`]); plies that reach their strength lose it along a
//! straight softening line that spends the card's energy ([`ply`]), and the load is stepped until the part gives way.
//! Parts that are no plates become [`bricks`], solved as a solid ([`solid`]), whose layers can part as well.

pub mod bricks;
pub mod cells;
mod drawing;
mod fronts;
pub mod plate;
pub mod ply;
pub mod solid;

use std::ops::Range;

use grainpath_core::math::direction;
use grainpath_core::{DVec2, DVec3};
use rayon::prelude::*;

use crate::material::Unstable;
use crate::plane::PlaneStiffness;
use crate::solid::SolidError;
use crate::sparse::SparseError;
use cells::Laminate;
use drawing::{Body, Near, Pace, State};
use plate::{Elements, GridHold, System, middle_strain, square};
use ply::{Mode, StrengthCard, broken, turned};

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
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TestError {
    /// The solver gave up.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// The solver of solids gave up.
    #[error(transparent)]
    Solid(#[from] SolidError),
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
    /// Where most energy was spent, mm; plates lie at z = 0.
    pub weakest: DVec3,
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

/// Cosine of the greatest angle to a crack's normal at which a cell lies beside the crack, not ahead of it.
const ASIDE: f64 = 0.6;

/// How plates are drawn.
const PACE: Pace = Pace {
    step: 0.04,
    finest: 0.011,
    slack: 0.0,
    over: [1.7, 1.04],
    fallen: [0.8, 1.2],
    most_solutions: 4000,
    most_work: f64::INFINITY,
};

impl PlateTest<'_> {
    /// Draws the plate until it breaks.
    ///
    /// # Errors
    /// [`TestError`] when it moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn run(&self) -> Result<Outcome, TestError> {
        let whole: Vec<PlaneStiffness> =
            self.cards.iter().map(|c| broken(&c.elastic, [0.0; 2])).collect::<Result<_, _>>()?;
        let n = self.elements.cells.len();
        let first: Vec<[[f64; 8]; 8]> = (0..n)
            .into_par_iter()
            .map(|e| self.stiffness(e, |p| Ok(whole[self.material(p)])))
            .collect::<Result<_, _>>()?;
        let forces: Vec<f64> = self.forces_n.iter().flat_map(|f| [f.x, f.y]).collect();
        let system = System::new(self.elements, &|e| first[e], self.holds, &forces, self.max_bytes)?;
        drop(first);
        let x = Vec::new();
        let cell_mm = self.elements.grid.cell_mm;
        let mut at = vec![None; self.elements.grid.nx * self.elements.grid.ny];
        self.elements.cells.iter().enumerate().for_each(|(e, c)| at[*c as usize] = Some(e as u32));
        let mut body = Plate { test: self, system, forces, x, at };
        drawing::draw(&mut body, self.cards, [cell_mm; 2], self.load_n, &PACE)
    }

    fn material(&self, ply: usize) -> usize {
        usize::from(self.laminate.plies[ply].material)
    }

    fn range(&self, element: usize) -> Range<usize> {
        let cell = self.elements.cells[element] as usize;
        self.laminate.starts[cell] as usize..self.laminate.starts[cell + 1] as usize
    }

    fn stiffness(
        &self,
        element: usize,
        own: impl Fn(usize) -> Result<PlaneStiffness, Unstable>,
    ) -> Result<[[f64; 8]; 8], Unstable> {
        let mut sum: PlaneStiffness = [[0.0; 3]; 3];
        for p in self.range(element) {
            let ply = &self.laminate.plies[p];
            let c = turned(&own(p)?, ply.angle_rad);
            (0..9).for_each(|k| sum[k / 3][k % 3] += ply.thickness_mm * c[k / 3][k % 3]);
        }
        Ok(square(&sum))
    }
}

/// A plate and its last solution.
struct Plate<'a> {
    test: &'a PlateTest<'a>,
    system: System,
    forces: Vec<f64>,
    x: Vec<f64>,
    /// Element of each cell.
    at: Vec<Option<u32>>,
}

fn in_plane(losses: [f64; 3]) -> [f64; 2] {
    [losses[0], losses[1]]
}

impl Body for Plate<'_> {
    fn n_elements(&self) -> usize {
        self.test.elements.cells.len()
    }

    fn n_plies(&self) -> usize {
        self.test.laminate.plies.len()
    }

    fn plies(&self, element: usize) -> Range<usize> {
        self.test.range(element)
    }

    fn material(&self, ply: usize) -> usize {
        self.test.material(ply)
    }

    fn amount(&self, ply: usize) -> f64 {
        self.test.laminate.plies[ply].thickness_mm
    }

    fn centre(&self, element: usize) -> DVec3 {
        self.test.elements.grid.centre(self.test.elements.cells[element] as usize).extend(0.0)
    }

    fn cell_mm(&self) -> f64 {
        self.test.elements.grid.cell_mm
    }

    fn is_spared(&self, element: usize) -> bool {
        self.test.spared[element]
    }

    fn rivals(&self, ply: usize, element: usize, how: usize) -> Vec<usize> {
        let along = direction(self.test.laminate.plies[ply].angle_rad);
        let normal = if how == 0 { along } else { along.perp() };
        let grid = &self.test.elements.grid;
        let cell = self.test.elements.cells[element] as usize;
        let beside = grid.around(cell).filter(|(off, _)| off.dot(normal).abs() >= ASIDE * off.length());
        beside.filter_map(|(_, other)| self.at[other].map(|e| e as usize)).collect()
    }

    fn solve(&mut self) -> Result<(f64, Option<Vec<usize>>), TestError> {
        self.x = self.system.solve()?;
        Ok((self.forces.iter().zip(&self.x).map(|(f, u)| f * u).sum(), None))
    }

    fn near(&self, element: usize, states: &[State]) -> Vec<Near> {
        let test = self.test;
        let place = |i: u32| DVec2::new(self.x[2 * i as usize], self.x[2 * i as usize + 1]);
        let u = test.elements.corners[element].map(place);
        let [xx, yy, xy] = middle_strain(&u, self.cell_mm());
        let each = |p: usize| {
            let (s, c) = grainpath_core::math::sin_cos(test.laminate.plies[p].angle_rad);
            let own = [
                c * c * xx + s * s * yy + s * c * xy,
                s * s * xx + c * c * yy - s * c * xy,
                2.0 * s * c * (yy - xx) + (c * c - s * s) * xy,
            ];
            let losses = in_plane(states[p].losses());
            let card = &test.cards[test.material(p)];
            let stiffness = broken(&card.elastic, losses).unwrap_or_default();
            // Per area that still carries: the strength is that of whole material.
            let left = [1.0 - losses[0], 1.0 - losses[1].max(losses[0]), 1.0 - losses[1].max(losses[0])];
            let stress: [f64; 3] = std::array::from_fn(|i| {
                stiffness[i].iter().zip(own).map(|(c, e)| c * e).sum::<f64>() / left[i]
            });
            let ([through, between], mode) = card.indices(stress);
            let slides = [false, card.slides(stress), false];
            Near { index: [through, between, 0.0], slides, mode }
        };
        self.plies(element).map(each).collect()
    }

    fn change(&mut self, elements: &[usize], states: &[State]) -> Result<(), TestError> {
        let test = self.test;
        let own = |p: usize| broken(&test.cards[test.material(p)].elastic, in_plane(states[p].losses()));
        let of = |&e: &usize| Ok((e, test.stiffness(e, own)?));
        let new: Vec<(usize, [[f64; 8]; 8])> =
            elements.par_iter().map(of).collect::<Result<_, Unstable>>()?;
        new.iter().for_each(|(e, k)| self.system.change(*e, k));
        Ok(())
    }

    fn dofs(&self) -> usize {
        self.system.dofs()
    }

    fn effort(&self) -> [usize; 2] {
        [self.system.solved, self.system.factored]
    }
}
