//! The strength test of a plate: a [`Laminate`] under plane stress, loaded until it fails.
//!
//! Method: cells are square elements with incompatible modes, which bend without locking (`wilson1973` in
//! docs/references.bib), solved exactly by fronts (`duff1983`). The membrane stiffness of an element is the
//! sum over its plies of thickness times stiffness, turned into the direction of the beads and reduced by
//! their damage. Failure indices are those of the strain in the middle of a cell, ply by ply, on the area
//! that still carries; those of the first failure are of a strain fitted to the cells around (`strain_fit`).
//! The load is stepped until the plate carries no more (`rots2001`).
//!
//! Lengths are in mm, forces in N, angles in radians. The load is a factor on the unit load, and results are
//! told as factor times `load_n`. Plies are numbered cell by cell. Cost: one solution for each state of
//! damage, with a factorization of the parts that changed; at most 4000.
//!
//! Limits: thin walls that bend in the plane need four cells across ([`PlateTest::unresolved_bending`]).
//! Elements marked unbreakable keep their stiffness. A stiffness that is not positive definite, a factor
//! above the memory limit, and a load that strains nothing are errors.
//!
//! The figure shows the damage (white to black) and the load over displacement:
//!
#![doc = include_str!("figures/plate.svg")]

use std::ops::Range;

use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::math::direction;
use grainpath_core::{DVec2, DVec3};
use rayon::prelude::*;

use super::card::StrengthCard;
use super::damage::{damaged_plane_stiffness, with_joined};
use super::first_failure::{FirstFailure, IndexScale, Judged, first_failures_of};
use super::laminate::Laminate;
use super::load_stepping::{
    FailureIndices, LoadedPart, PlyState, StepControl, UnitSolution, highest_index, run_to_failure,
};
use super::plate_system::PlateSystem;
use super::squares::{GridHold, PlateElements, bending_strain, middle_strain, square};
use super::strain_fit::{ElementCells, fitted_strains};
use super::wall_bending::{
    BendingSample, CellsAlong, MIN_CELLS_ACROSS, UnresolvedBending, WallThrough, is_outside,
    unresolved_bending,
};
use super::{CRACK_NORMAL_COS, Outcome, TestError};
use crate::material::{Unstable, plane_strain_along, rotated_plane};
use crate::plane::PlaneStiffness;

/// A plate made of beads, its fixtures and its loads.
pub struct PlateTest<'a> {
    /// The plies of each cell.
    pub laminate: &'a Laminate,
    /// Its cells as elements.
    pub elements: &'a PlateElements,
    /// The fixtures.
    pub holds: &'a [GridHold],
    /// The unit load: the force at every node, N.
    pub forces_n: &'a [DVec2],
    /// The size of the unit load as it is reported, N.
    pub load_n: f64,
    /// Whether each element never fails: those in grips and under rollers.
    pub unbreakable: &'a [bool],
    /// The materials, in the numbering of the plies.
    pub cards: &'a [StrengthCard],
    /// Memory limit of the solver, MiB.
    pub max_mib: f64,
    /// Stops the test.
    pub cancel: CancelFlag,
}

/// A plate before anything breaks, for other programs: square elements with a membrane stiffness each, fixtures and the
/// unit load.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateModel {
    /// Positions of the nodes, mm.
    pub nodes_mm: Vec<DVec2>,
    /// Corners of each element, counter-clockwise.
    pub corners: Vec<[u32; 4]>,
    /// Membrane stiffness of each element: force over length for a strain in Voigt order (x, y, shear angle), N/mm.
    pub membranes_n_mm: Vec<PlaneStiffness>,
    /// Directions in which nodes are held.
    pub holds: Vec<GridHold>,
    /// Force at each node, N.
    pub forces_n: Vec<DVec2>,
}

/// A wall ends at a cell that is filled to less than this share of the height. Source: derived. [`MIN_CELLS_ACROSS`] has
/// a margin of half a cell; four such cells on either side change the sum over a wall by a sixth of a cell at most.
const MIN_FILL: f64 = 0.02;

/// Step control of plate tests. Measured: over two cell sizes and three positions of the grid, the peak of a notched bar
/// moves by at most 3.3 %, with the smaller cells by 0.7 % (`tests/strength.rs`).
const STEP_CONTROL: StepControl = StepControl {
    first_step: 0.04,
    min_step: 0.011,
    tolerance: 0.0,
    overrelaxation: 1.7,
    min_growth: 1.04,
    collapse_load: 0.8,
    collapse_softening: 1.2,
    max_solutions: 4000,
    max_work: f64::INFINITY,
};

impl PlateTest<'_> {
    /// Loads the plate until it fails.
    ///
    /// # Errors
    /// [`TestError`] when it moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn run(&self) -> Result<Outcome, TestError> {
        let mut plate = self.loaded()?;
        let cell_mm = self.elements.grid.cell_mm;
        run_to_failure(&mut plate, self.cards, [cell_mm; 2], self.load_n, &STEP_CONTROL, &self.cancel)
    }

    /// The plate as it is before anything breaks.
    ///
    /// # Errors
    /// [`Unstable`] for elastic constants that no stable material has.
    pub fn model(&self) -> Result<PlateModel, Unstable> {
        Ok(PlateModel {
            nodes_mm: (0..self.elements.places.len()).map(|i| self.elements.node(i)).collect(),
            corners: self.elements.corners.clone(),
            membranes_n_mm: self.membranes()?,
            holds: self.holds.to_vec(),
            forces_n: self.forces_n.to_vec(),
        })
    }

    /// How much bending of thin walls the cells fail to resolve. It takes one solution for the unit load if there are
    /// thin walls, none otherwise.
    ///
    /// # Errors
    /// [`TestError`] when the plate moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn unresolved_bending(&self) -> Result<UnresolvedBending, TestError> {
        if !self.has_thin_walls() {
            return Ok(UnresolvedBending::default());
        }
        let (plate, states) = self.before_damage()?;
        unresolved_bending(&plate.bending(&states, &self.membranes()?))
    }

    /// The first failures under the load for each of `N` sets of cards, each in the numbering of the plies and with the
    /// elastic constants of the test's own cards. It takes one solution; `index` of a failure is that of the whole
    /// load, times `scale`.
    ///
    /// # Errors
    /// [`TestError`] when the plate moves freely, is too large for the memory allowed, or the test is stopped.
    pub fn first_failures<const N: usize>(
        &self,
        cards: &[Vec<StrengthCard>; N],
        scale: IndexScale,
    ) -> Result<Judged<N>, TestError> {
        let (plate, states) = self.before_damage()?;
        let strains = plate.fitted_strains();
        let failures = |element: usize| {
            // Stresses do not depend on strengths, so they are the same with all cards.
            let stresses: Vec<[f64; 3]> =
                plate.stresses_of_strain(element, |m| strains[m][element], &states).collect();
            std::array::from_fn(|k| {
                let plies = plate.plies(element).zip(&stresses).map(|(p, stress)| {
                    let indices = indices_of_stress(&cards[k][self.material(p)], *stress);
                    ((p, self.laminate.plies[p].angle_rad), indices)
                });
                FirstFailure::of_plies(self.elements.cells[element] as usize, plies, scale)
            })
        };
        Ok(first_failures_of(&plate, self.laminate.plies.len(), &failures))
    }

    /// The plate under its load before anything is damaged, and the states of its plies.
    fn before_damage(&self) -> Result<(LoadedPlate<'_>, Vec<PlyState>), TestError> {
        let mut plate = self.loaded()?;
        plate.solve()?;
        // The strains at which softening ends do not matter yet, so neither does the size of the cells.
        let whole = |p: usize| PlyState::whole(&self.cards[self.material(p)].final_strains(1.0, 1.0));
        let states: Vec<PlyState> = (0..plate.n_plies()).map(whole).collect();
        Ok((plate, states))
    }

    /// Share of the plate's thickness that a cell fills.
    fn filled(&self, cell: usize) -> f64 {
        (self.laminate.thickness_mm(cell) / self.laminate.height_mm).min(1.0)
    }

    fn run_through(&self, cell: usize, axis: usize) -> CellsAlong {
        let grid = &self.laminate.grid;
        let (stride, n) = [(1, grid.nx), (grid.nx, grid.ny)][axis];
        let place = cell / stride % n;
        let above = (place + 1..n).map(|k| cell + (k - place) * stride);
        let below = (0..place).rev().map(|k| cell - (place - k) * stride);
        let filled = |c: usize| Some(self.filled(c)).filter(|f| *f > MIN_FILL);
        CellsAlong::new(self.filled(cell), above.map_while(filled), below.map_while(filled))
    }

    fn wall_through(&self, cell: usize) -> WallThrough {
        let runs = [self.run_through(cell, 0), self.run_through(cell, 1), CellsAlong::ENDLESS];
        WallThrough { runs, cell_mm: DVec3::splat(self.laminate.grid.cell_mm) }
    }

    /// Whether an element lies in a wall that is thin for the size of the cells.
    fn has_thin_walls(&self) -> bool {
        let cells = (self.elements.cells.par_iter().zip(self.unbreakable)).filter(|(_, u)| !**u);
        cells.any(|(c, _)| self.wall_through(*c as usize).is_thin())
    }

    fn loaded(&self) -> Result<LoadedPlate<'_>, TestError> {
        // The 9 numbers of the membrane stiffness of each element are kept instead of the 64 of its stiffness matrix,
        // because memory is scarcest while the system is factored.
        let membranes = self.membranes()?;
        let forces: Vec<f64> = self.forces_n.iter().flat_map(|f| [f.x, f.y]).collect();
        let stiffness = |e: usize| square(&membranes[e]);
        let cancel = self.cancel.clone();
        let system = PlateSystem::new(self.elements, &stiffness, self.holds, &forces, self.max_mib, cancel)?;
        drop(membranes);
        let mut element_of = vec![None; self.elements.grid.nx * self.elements.grid.ny];
        self.elements.cells.iter().enumerate().for_each(|(e, c)| element_of[*c as usize] = Some(e as u32));
        Ok(LoadedPlate { test: self, system, forces, displacement: Vec::new(), element_of })
    }

    fn material(&self, ply: usize) -> usize {
        usize::from(self.laminate.plies[ply].material)
    }

    fn range(&self, element: usize) -> Range<usize> {
        let cell = self.elements.cells[element] as usize;
        self.laminate.starts[cell] as usize..self.laminate.starts[cell + 1] as usize
    }

    /// The membrane stiffness of every element before anything is damaged, N/mm.
    fn membranes(&self) -> Result<Vec<PlaneStiffness>, Unstable> {
        let elements = (0..self.elements.cells.len()).into_par_iter();
        elements.map(|e| self.membrane(e, |_| [0.0; 2])).collect()
    }

    /// Membrane stiffness of an element, summed over its plies with their damage along and between beads, N/mm.
    fn membrane(
        &self,
        element: usize,
        damage: impl Fn(usize) -> [f64; 2],
    ) -> Result<PlaneStiffness, Unstable> {
        let mut sum: PlaneStiffness = [[0.0; 3]; 3];
        for p in self.range(element) {
            let ply = &self.laminate.plies[p];
            let elastic = &self.cards[self.material(p)].elastic;
            let own = damaged_plane_stiffness(elastic, with_joined(damage(p), ply.joined))?;
            let c = rotated_plane(&own, ply.angle_rad);
            (0..9).for_each(|k| sum[k / 3][k % 3] += ply.thickness_mm * c[k / 3][k % 3]);
        }
        Ok(sum)
    }
}

/// A plate and its last solution.
struct LoadedPlate<'a> {
    test: &'a PlateTest<'a>,
    system: PlateSystem,
    forces: Vec<f64>,
    displacement: Vec<f64>,
    /// Element of each cell.
    element_of: Vec<Option<u32>>,
}

fn in_plane(damage: [f64; 3]) -> [f64; 2] {
    [damage[0], damage[1]]
}

/// Failure indices of a ply of this material under a stress in its axes.
fn indices_of_stress(card: &StrengthCard, stress: [f64; 3]) -> FailureIndices {
    let ([through, between], mode) = card.indices(stress);
    let slides = [false, card.is_sliding(stress), false];
    FailureIndices { index: [through, between, 0.0], slides, mode }
}

impl LoadedPlate<'_> {
    /// Displacements of an element's corners, mm.
    fn corners(&self, element: usize) -> [DVec2; 4] {
        let at =
            |i: u32| DVec2::new(self.displacement[2 * i as usize], self.displacement[2 * i as usize + 1]);
        self.test.elements.corners[element].map(at)
    }

    /// The strains of every element from which the first failure is told, by material, see [`super::strain_fit`].
    fn fitted_strains(&self) -> Vec<Vec<[f64; 3]>> {
        let PlateElements { grid, cells, .. } = self.test.elements;
        let elements = 0..self.n_elements();
        let strains: Vec<[f64; 3]> =
            elements.clone().into_par_iter().map(|e| middle_strain(&self.corners(e), grid.cell_mm)).collect();
        let of_material = |(material, card): (usize, &StrengthCard)| {
            if !card.fails_over_a_length() {
                return strains.clone();
            }
            let amount = |e: usize| {
                let plies = self.plies(e).filter(|p| self.material(*p) == material);
                plies.map(|p| self.amount(p)).sum()
            };
            let amounts: Vec<f64> = elements.clone().map(amount).collect();
            let part = ElementCells {
                n: [grid.nx, grid.ny, 1],
                cell_mm: DVec3::splat(grid.cell_mm),
                element_of: &self.element_of,
                cells,
            };
            fitted_strains(&part, &amounts, &strains, &|_| true)
        };
        self.test.cards.iter().enumerate().map(of_material).collect()
    }

    /// The stress of each ply of an element under the strain of its material, order xx, yy, xy, in the axes of the ply and on
    /// the area that still carries.
    fn stresses_of_strain(
        &self,
        element: usize,
        strain: impl Fn(usize) -> [f64; 3],
        states: &[PlyState],
    ) -> impl Iterator<Item = [f64; 3]> {
        let test = self.test;
        let each = move |p: usize| {
            let ply = &test.laminate.plies[p];
            let own = plane_strain_along(strain(test.material(p)), ply.angle_rad);
            let damage = with_joined(in_plane(states[p].damage()), ply.joined);
            let elastic = &test.cards[test.material(p)].elastic;
            let stiffness = damaged_plane_stiffness(elastic, damage).unwrap_or_default();
            // The strengths are those of undamaged material, so the stress is taken on the area that still carries.
            let across = 1.0 - damage[1].max(damage[0]);
            let remaining = [1.0 - damage[0], across, across];
            std::array::from_fn(|i| {
                stiffness[i].iter().zip(own).map(|(c, e)| c * e).sum::<f64>() / remaining[i]
            })
        };
        self.plies(element).map(each)
    }

    /// Failure indices of an element under the strain of each material, order xx, yy, xy.
    fn indices_of_strain(
        &self,
        element: usize,
        strain: impl Fn(usize) -> [f64; 3],
        states: &[PlyState],
    ) -> impl Iterator<Item = FailureIndices> {
        let test = self.test;
        let plies = self.plies(element).zip(self.stresses_of_strain(element, strain, states));
        plies.map(move |(p, stress)| indices_of_stress(&test.cards[test.material(p)], stress))
    }

    /// The failure index of each element in its middle and on the sides of thin walls, see [`unresolved_bending`].
    fn bending(&self, states: &[PlyState], membranes: &[PlaneStiffness]) -> Vec<BendingSample> {
        let sample = |element: usize| {
            if self.is_unbreakable(element) {
                return BendingSample::default();
            }
            let cell = self.test.elements.cells[element] as usize;
            let test = self.test;
            let beside = test.elements.grid.around(cell).filter(|(_, c)| self.element_of[*c].is_some());
            if is_outside(test.filled(cell), beside.map(|(_, c)| test.filled(c))) {
                return BendingSample::default();
            }
            let u = self.corners(element);
            let middle = middle_strain(&u, self.cell_mm());
            let index = |strain: [f64; 3]| highest_index(self.indices_of_strain(element, |_| strain, states));
            let wall = test.wall_through(cell);
            let around = || {
                let beside = test.elements.grid.around(cell);
                let cells = std::iter::once((DVec2::ZERO, cell)).chain(beside);
                let elements = cells.filter_map(|(off, c)| Some((off, c, self.element_of[c]? as usize)));
                let strained = elements.map(|(off, c, e)| {
                    let strain = middle_strain(&self.corners(e), self.cell_mm());
                    ((off * self.cell_mm()).extend(0.0), test.filled(c), strain)
                });
                strained.collect()
            };
            if let Some(sample) = wall.leaning_sample(around, index) {
                return sample;
            }
            let mut sample = BendingSample { middle: index(middle), ..BendingSample::default() };
            sample.face = sample.middle;
            for axis in 0..2 {
                let across = wall.runs[axis].cells;
                if across >= MIN_CELLS_ACROSS {
                    continue;
                }
                let bending = bending_strain(&u, self.cell_mm(), axis, &membranes[element]);
                let sides =
                    [-1.0, 1.0].map(|side| index(std::array::from_fn(|k| middle[k] + side * bending[k])));
                let face = sides[0].max(sides[1]);
                if face > sample.face {
                    sample.face = face;
                    sample.wall_mm = across * self.cell_mm();
                }
            }
            sample
        };
        (0..self.n_elements()).into_par_iter().map(sample).collect()
    }
}

impl LoadedPart for LoadedPlate<'_> {
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

    fn is_unbreakable(&self, element: usize) -> bool {
        self.test.unbreakable[element]
    }

    fn neighbours_across_crack(&self, ply: usize, element: usize, how: usize) -> Vec<usize> {
        let along = direction(self.test.laminate.plies[ply].angle_rad);
        let normal = if how == 0 { along } else { along.perp() };
        let grid = &self.test.elements.grid;
        let cell = self.test.elements.cells[element] as usize;
        let beside = grid
            .around(cell)
            .filter(|(off, _)| off.dot(normal).abs() >= CRACK_NORMAL_COS.value() * off.length());
        beside.filter_map(|(_, other)| self.element_of[other].map(|e| e as usize)).collect()
    }

    fn solve(&mut self) -> Result<UnitSolution, TestError> {
        self.displacement = self.system.solve()?;
        let force_times_displacement = self.forces.iter().zip(&self.displacement).map(|(f, u)| f * u).sum();
        Ok(UnitSolution { force_times_displacement, changed: None })
    }

    fn failure_indices(&self, element: usize, states: &[PlyState], out: &mut Vec<FailureIndices>) {
        out.clear();
        let strain = middle_strain(&self.corners(element), self.cell_mm());
        out.extend(self.indices_of_strain(element, |_| strain, states));
    }

    fn first_indices(&self, states: &[PlyState]) -> Vec<f64> {
        let strains = self.fitted_strains();
        let highest = |e: usize| highest_index(self.indices_of_strain(e, |m| strains[m][e], states));
        (0..self.n_elements()).into_par_iter().map(highest).collect()
    }

    fn update_stiffness(&mut self, elements: &[usize], states: &[PlyState]) -> Result<(), TestError> {
        let test = self.test;
        let damage = |p: usize| in_plane(states[p].damage());
        let stiffness = |&e: &usize| Ok((e, square(&test.membrane(e, damage)?)));
        let new: Vec<(usize, [[f64; 8]; 8])> =
            elements.par_iter().map(stiffness).collect::<Result<_, Unstable>>()?;
        new.iter().for_each(|(e, k)| self.system.change(*e, k));
        Ok(())
    }

    fn dofs(&self) -> usize {
        self.system.dofs()
    }

    fn n_solutions(&self) -> usize {
        self.system.solved
    }

    fn n_factorizations(&self) -> usize {
        self.system.factored
    }
}
