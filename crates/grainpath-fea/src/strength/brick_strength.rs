//! The strength test of a solid: [`Bricks`] as elements, each with the damaged stiffness of its plies, loaded
//! until they fail.
//!
//! Method: cells are boxes with incompatible modes ([`crate::solid::voxel`]), solved by conjugate gradients
//! with multigrid. The stiffness of a cell is the mean over its plies in proportion to their share, scaled by
//! how full the cell is. Cells share stiffnesses from a library, in which directions are rounded to 32 in
//! half a turn, bonds and shares to eighths, and damage to sixteenths of an octave of what remains. Failure
//! indices use exact directions and bonds. All plies of a cell part from the layer below together. The load
//! is stepped until the part carries no more (`rots2001`); a solution starts from the one before and corrects
//! the nodes around new damage first.
//!
//! Lengths are in mm, forces in N, angles in radians; cells are numbered with x fastest. Cost: one solution
//! for each state of damage, at most 400, and at most 1e9 iterations times nodes in all, a quarter of an hour
//! on two cores. Memory: that of the grid (`voxel`), and about 7 KB for each stiffness of the library, of
//! which there are 30 000 at most. When the library is full, further damage scales the whole stiffness of the
//! undamaged cell.
//!
//! Limits: walls thinner than four cells need [`SolidTest::unresolved_bending`]. Cells marked unbreakable
//! keep their stiffness. A part that moves freely or is too large for the memory allowed, and a load that
//! strains nothing, are errors.
//!
//! The figure shows the damage (white to black) in a section of a beam whose layers part, and its load over
//! displacement:
//!
#![doc = include_str!("figures/solid.svg")]

use std::collections::BTreeMap;
use std::ops::Range;

use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::math::direction;
use grainpath_core::{DVec3, IVec3};
use rayon::prelude::*;

use super::bricks::{Bricks, DIRECTIONS, SHARE_STEPS};
use super::card::StrengthCard;
use super::damage::{carried_stress, damaged_stiffness};
use super::first_failure::{FirstFailure, IndexScale, Judged, first_failures_of};
use super::load_stepping::{
    FailureIndices, LoadedPart, PlyState, StepControl, UnitSolution, highest_index, run_to_failure,
};
use super::strain_fit::{ElementCells, judged_strains};
use super::wall_bending::{
    BendingSample, CellsAlong, MIN_CELLS_ACROSS, UnresolvedBending, WallThrough, is_outside,
    unresolved_bending,
};
use super::{CRACK_NORMAL_COS, Outcome, TestError};
use crate::material::{Orthotropic, Stiffness, rotated_about_z};
use crate::solid::voxel::{VOID, VoxelPart, VoxelSystem};
use crate::solid::{Method, SolidError, SolveSettings};

/// A grid point and a unit vector along which it is held.
pub type SolidHold = ([usize; 3], DVec3);

/// Makes a system of cells from a part, its held points with directions and displacements, and settings.
type Prepare = fn(VoxelPart, &[([usize; 3], DVec3, f64)], &SolveSettings) -> Result<VoxelSystem, SolidError>;

/// A part made of beads, its fixtures and its loads.
pub struct SolidTest<'a> {
    /// The cells.
    pub bricks: &'a Bricks,
    /// Whether each cell takes part in the test as an element.
    pub active: &'a [bool],
    /// The fixtures.
    pub holds: &'a [SolidHold],
    /// The unit load: forces at grid points, N.
    pub forces_n: &'a [([usize; 3], DVec3)],
    /// The size of the unit load as it is reported, N.
    pub load_n: f64,
    /// Whether each cell never fails: those in grips and under rollers.
    pub unbreakable: &'a [bool],
    /// The material.
    pub card: &'a StrengthCard,
    /// Memory limit of the solver, MiB.
    pub max_mib: f64,
    /// Stops the test.
    pub cancel: CancelFlag,
}

/// Step control of solid tests. A solution costs more than for a plate. The load is therefore raised before a crack has
/// quite stopped growing, a falling load is followed less far, and the peak is not refined in smaller steps. In return the
/// overrelaxation is smaller, so that the test overshoots the peak less. Measured: peaks of a bar, notched bars and a
/// layered beam lie within 1.7 % of the peaks found in steps of 1 % that are solved until all cracks stop
/// (`long_steps_find_the_peak_that_small_ones_do`).
const STEP_CONTROL: StepControl = StepControl {
    first_step: 0.05,
    min_step: 0.05,
    tolerance: 0.02,
    overrelaxation: 1.5,
    min_growth: 1.03,
    collapse_load: 0.8,
    collapse_softening: 1.15,
    max_solutions: 400,
    // A quarter of an hour on two cores.
    max_work: 1e9,
};
/// Residual over the load at which the first solution ends. Measured: with it bars of one raster break within 0.1 % of
/// strength times section (`tests/strength.rs`).
const FIRST_TOLERANCE: f64 = 1e-5;
/// Residual over the load at which the solution for [`SolidTest::unresolved_bending`] ends. Measured: it suffices to tell
/// walls one or two cells thick from walls of four or five (`tests/wall_bending.rs`).
const PROBE_TOLERANCE: f64 = 1e-3;
/// Residual over the load at which the solution for [`SolidTest::first_failures`] ends. Measured: on ten bars
/// of sparse `grid`, `gyroid`, `triangles`, `honeycomb` and graded stripes (41 000 to 105 000 nodes) the factor at first failure
/// is within 0.07 % of that at 1e-5, with the same place and mode.
const FAILURE_TOLERANCE: f64 = 1e-2;
/// Residual over the load at which later solutions end. Each starts from the solution before it, see
/// `RESIDUAL_GAIN`. Measured: see [`STEP_CONTROL`]; the small steps of that comparison end at 1e-5.
const LATER_TOLERANCE: f64 = 1e-2;
/// Later solutions also reduce the residual that new damage has caused to this share of it. Measured: see
/// [`STEP_CONTROL`].
const RESIDUAL_GAIN: f64 = 0.1;
/// Number of steps to which the library rounds the stiffness that damage leaves: sixteenths of an octave, down to a
/// thousandth. Source: derived. Ten octaves are a factor of 1024; a step takes 4.2 % of what remains.
const DAMAGE_STEPS: u64 = 160;
/// The largest number of stiffnesses in the library. Source: derived. Cells refer to a stiffness by a 16-bit number, of
/// which the last is [`VOID`]; half of these numbers make 138 MB of matrices of 24 x 24 numbers.
const MAX_STIFFNESSES: usize = 30_000;

impl SolidTest<'_> {
    /// Loads the part until it fails. Lists in the outcome are ordered like the active cells.
    ///
    /// # Errors
    /// [`TestError`] when it moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn run(&self) -> Result<Outcome, TestError> {
        self.run_with(&STEP_CONTROL, LATER_TOLERANCE)
    }

    /// How much bending of thin walls the cells fail to resolve. It takes one solution for the unit load if there are
    /// thin walls, none otherwise.
    ///
    /// # Errors
    /// [`TestError`] when the part moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn unresolved_bending(&self) -> Result<UnresolvedBending, TestError> {
        if !self.has_thin_walls() {
            return Ok(UnresolvedBending::default());
        }
        let (solid, states) = self.before_damage()?;
        unresolved_bending(&solid.bending(&states))
    }

    /// The first failures under the load for each of `N` cards with the elastic constants of the test's own card. It takes one
    /// solution; `index` of a failure is that of the whole load, times `scale`.
    ///
    /// # Errors
    /// [`TestError`] when the part moves freely, is too large for the memory allowed, or the test is stopped.
    pub fn first_failures<const N: usize>(
        &self,
        cards: &[StrengthCard; N],
        scale: IndexScale,
    ) -> Result<Judged<N>, TestError> {
        let mut solid = self.loaded(LATER_TOLERANCE, VoxelSystem::for_one_solution)?;
        let settings = SolveSettings { tolerance: FAILURE_TOLERANCE, ..solid.settings.clone() };
        solid.system.solve_once(&solid.forces, &settings)?;
        let states = self.undamaged(&solid);
        let strains = solid.judged_strains();
        let failures = |element: usize| {
            let cell = solid.cells[element] as usize;
            // Stresses do not depend on strengths, so they are the same with all cards.
            let stresses: Vec<[f64; 6]> =
                solid.stresses_of_strains(element, strains[element], &states).collect();
            cards.each_ref().map(|card| {
                let indices = stresses.iter().enumerate().map(|(k, s)| indices_of_stress(card, k, *s));
                let plies = solid.plies(element).map(|p| solid.plies[p] as usize);
                let plies = plies.map(|p| (p, self.bricks.plies[p].angle_rad));
                FirstFailure::of_plies(cell, plies.zip(indices), scale)
            })
        };
        Ok(first_failures_of(&solid, self.bricks.plies.len(), &failures))
    }

    /// The part under its load before anything is damaged, and the states of its plies.
    fn before_damage(&self) -> Result<(LoadedSolid<'_>, Vec<PlyState>), TestError> {
        let mut solid = self.loaded(LATER_TOLERANCE, VoxelSystem::new)?;
        solid.settings.tolerance = PROBE_TOLERANCE;
        solid.solve()?;
        let states = self.undamaged(&solid);
        Ok((solid, states))
    }

    fn undamaged(&self, solid: &LoadedSolid<'_>) -> Vec<PlyState> {
        // The strains at which softening ends do not matter yet, so neither does the size of the cells.
        let whole = PlyState::whole(&self.card.final_strains(1.0, 1.0));
        vec![whole; solid.n_plies()]
    }

    fn run_through(&self, cell: usize, axis: usize) -> CellsAlong {
        let bricks = self.bricks;
        let stride = [1, bricks.n[0], bricks.n[0] * bricks.n[1]][axis];
        let place = cell / stride % bricks.n[axis];
        let above = (place + 1..bricks.n[axis]).map(|k| cell + (k - place) * stride);
        let below = (0..place).rev().map(|k| cell - (place - k) * stride);
        let filled = |c: usize| self.active[c].then_some(f64::from(bricks.filled[c]));
        CellsAlong::new(f64::from(bricks.filled[cell]), above.map_while(filled), below.map_while(filled))
    }

    fn wall_through(&self, cell: usize) -> WallThrough {
        let runs = std::array::from_fn(|axis| self.run_through(cell, axis));
        WallThrough { runs, cell_mm: self.bricks.cell_mm }
    }

    /// Whether any breakable cell lies in a wall that has few cells across.
    fn has_thin_walls(&self) -> bool {
        let cells =
            (0..self.active.len()).into_par_iter().filter(|c| self.active[*c] && !self.unbreakable[*c]);
        cells.any(|c| self.wall_through(c).is_thin())
    }

    fn run_with(&self, control: &StepControl, later_tolerance: f64) -> Result<Outcome, TestError> {
        let mut solid = self.loaded(later_tolerance, VoxelSystem::new)?;
        let size_mm = [self.bricks.cell_mm.x, self.bricks.cell_mm.z];
        run_to_failure(
            &mut solid,
            std::slice::from_ref(self.card),
            size_mm,
            self.load_n,
            control,
            &self.cancel,
        )
    }

    fn loaded(&self, later_tolerance: f64, prepared: Prepare) -> Result<LoadedSolid<'_>, TestError> {
        let cells: Vec<u32> = (0..self.active.len()).filter(|&c| self.active[c]).map(|c| c as u32).collect();
        // The plies of an element are those of its cell, one list after the other.
        let mut starts = vec![0];
        let mut plies = Vec::new();
        for &c in &cells {
            let range = self.bricks.starts[c as usize]..self.bricks.starts[c as usize + 1];
            plies.extend(range);
            starts.push(plies.len() as u32);
        }
        let mut library = Library { elastic: self.card.elastic, known: BTreeMap::new(), all: Vec::new() };
        let mut material = vec![VOID; self.active.len()];
        let mut scale = vec![0.0; self.active.len()];
        // Undamaged cells get the stiffness of their plies, scaled by the share of the cell that is filled.
        let whole = [[0.0; 3]; 2];
        for &c in &cells {
            let c = c as usize;
            (material[c], _) = library.find(self.bricks, c, whole)?;
            scale[c] = self.bricks.filled[c];
        }
        let part = VoxelPart {
            n: self.bricks.n,
            origin: self.bricks.origin,
            cell_mm: self.bricks.cell_mm,
            palette: library.all.clone(),
            material,
            scale,
        };
        let holds: Vec<_> = self.holds.iter().map(|(p, d)| (*p, *d, 0.0)).collect();
        let settings = SolveSettings {
            tolerance: FIRST_TOLERANCE,
            max_iterations: 300,
            max_mib: self.max_mib,
            method: Method::Iterative,
            cancel: self.cancel.clone(),
        };
        let system = prepared(part, &holds, &settings)?;
        // Corners without an active cell have no node; their forces are left out.
        let mut forces = vec![DVec3::ZERO; system.n_nodes()];
        for (p, f) in self.forces_n {
            if let Some(i) = system.node(*p) {
                forces[i] += *f;
            }
        }
        let mut element_of = vec![None; self.active.len()];
        cells.iter().enumerate().for_each(|(e, c)| element_of[*c as usize] = Some(e as u32));
        Ok(LoadedSolid {
            test: self,
            cells,
            element_of,
            starts,
            plies,
            library,
            system,
            settings,
            later_tolerance,
            forces,
            solved: 0,
            iterations: 0,
        })
    }
}

/// The properties of a cell on which its stiffness depends, in steps: directions of both plies, share of the second, bond,
/// and the damage of each ply along its three axes.
type Properties = ([u64; 2], u64, u64, [[u64; 3]; 2]);

/// The stiffnesses in use, each stored once under the properties that it was made from.
struct Library {
    elastic: Orthotropic,
    known: BTreeMap<Properties, u16>,
    all: Vec<Stiffness>,
}

/// The first step of damage that is at least this much, but for rounding.
fn damage_step(loss: f64) -> u64 {
    let octaves = -grainpath_core::math::ln((1.0 - loss).max(1e-9)) / std::f64::consts::LN_2;
    ((16.0 * octaves - 1e-6).ceil().max(0.0) as u64).min(DAMAGE_STEPS)
}

fn damage_of_step(step: u64) -> f64 {
    // Source: derived, 2 to the power of -1/16.
    const ROOT: f64 = 0.957_603_280_698_573_6;
    1.0 - 0.5f64.powi((step / 16) as i32) * ROOT.powi((step % 16) as i32)
}

impl Library {
    /// The stiffness of a cell with this damage of its plies, and a factor on it that is 1 unless the library is full.
    fn find(&mut self, bricks: &Bricks, cell: usize, damage: [[f64; 3]; 2]) -> Result<(u16, f32), TestError> {
        let plies = bricks.plies_in(cell);
        let turn =
            |angle: f64| (angle / std::f64::consts::PI * DIRECTIONS).round().rem_euclid(DIRECTIONS) as u64;
        let bond = (f64::from(bricks.bond[cell]) * SHARE_STEPS).round().max(1.0) as u64;
        let (first, second) = (plies.first(), plies.get(1));
        let a = [first, second].map(|p| p.map_or(0, |p| turn(p.angle_rad)));
        let share = second.map_or(0, |p| (p.share * SHARE_STEPS).round().max(1.0) as u64);
        let mut steps = damage.map(|l| l.map(damage_step));
        if share == 0 {
            steps[1] = [0; 3];
        }
        let properties = (a, share, bond, steps);
        if let Some(known) = self.known.get(&properties) {
            return Ok((*known, 1.0));
        }
        let mut sum = [[0.0; 6]; 6];
        for k in 0..if share > 0 { 2 } else { 1 } {
            let own =
                damaged_stiffness(&self.elastic, steps[k].map(damage_of_step), bond as f64 / SHARE_STEPS)?;
            let c = rotated_about_z(&own, a[k] as f64 / DIRECTIONS * std::f64::consts::PI);
            let second = share as f64 / SHARE_STEPS;
            let weight = if k == 1 { second } else { 1.0 - second };
            for i in 0..6 {
                (0..6).for_each(|j| sum[i][j] += weight * c[i][j]);
            }
        }
        // Rotation leaves the matrix slightly asymmetric because of rounding.
        let c = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (sum[i][j] + sum[j][i])));
        if self.all.len() >= MAX_STIFFNESSES {
            let remaining = damage.iter().flatten().fold(1.0, |m: f64, l| m.min(1.0 - l));
            let whole = [[0.0; 3]; 2];
            return if damage == whole {
                Err(SolidError::NotPositive.into())
            } else {
                self.find(bricks, cell, whole).map(|(m, _)| (m, remaining as f32))
            };
        }
        let id = self.all.len() as u16;
        self.all.push(c);
        self.known.insert(properties, id);
        Ok((id, 1.0))
    }
}

/// A part and its last solution.
struct LoadedSolid<'a> {
    test: &'a SolidTest<'a>,
    /// Cell of each element.
    cells: Vec<u32>,
    /// Element of each cell.
    element_of: Vec<Option<u32>>,
    starts: Vec<u32>,
    /// The index of each ply in the list of the bricks.
    plies: Vec<u32>,
    library: Library,
    system: VoxelSystem,
    settings: SolveSettings,
    later_tolerance: f64,
    forces: Vec<DVec3>,
    solved: usize,
    iterations: usize,
}

/// Failure indices of the ply with this number in its element under a stress in its axes.
fn indices_of_stress(card: &StrengthCard, ply: usize, stress: [f64; 6]) -> FailureIndices {
    let [s11, s22, s33, s12, s23, s13] = stress;
    let in_layer = [s11, s22, s12];
    let ([through, between], mode) = card.indices(in_layer);
    let (apart, slides) = card.layer_index([s33, s23, s13]);
    // All plies of a brick separate from the layer below together, so the first one stands for all.
    let apart = if ply == 0 { apart } else { 0.0 };
    FailureIndices {
        index: [through, between, apart],
        slides: [false, card.is_sliding(in_layer), slides],
        mode,
    }
}

impl LoadedSolid<'_> {
    /// The strain of an element in its middle.
    fn strain(&self, element: usize) -> [f64; 6] {
        let cell = self.cells[element] as usize;
        self.system.strain(self.system.displacement(), cell).unwrap_or_default()
    }

    /// The strains of every element from which the first failure in its layers and between them is told.
    fn judged_strains(&self) -> Vec<[[f64; 6]; 2]> {
        let elements = 0..self.cells.len();
        let strains: Vec<[f64; 6]> = elements.into_par_iter().map(|element| self.strain(element)).collect();
        let Bricks { n, cell_mm, .. } = self.test.bricks;
        let cells =
            ElementCells { n: *n, cell_mm: *cell_mm, element_of: &self.element_of, cells: &self.cells };
        let is_asked = |element: usize| !self.is_unbreakable(element);
        judged_strains(self.test.bricks, self.test.card, &cells, &strains, &is_asked)
    }

    /// Failure indices of an element under a strain, order xx, yy, zz, xy, yz, zx.
    fn indices_of_strain(
        &self,
        element: usize,
        strain: [f64; 6],
        states: &[PlyState],
    ) -> impl Iterator<Item = FailureIndices> {
        self.indices_of_strains(element, [strain; 2], states)
    }

    /// Failure indices of an element under one strain in its layers and another between them.
    fn indices_of_strains(
        &self,
        element: usize,
        strains: [[f64; 6]; 2],
        states: &[PlyState],
    ) -> impl Iterator<Item = FailureIndices> {
        let stresses = self.stresses_of_strains(element, strains, states);
        stresses.enumerate().map(|(k, stress)| indices_of_stress(self.test.card, k, stress))
    }

    /// The stress of each ply of an element, order 11, 22, 33, 12, 23, 13, in the axes of the ply and on the area that still
    /// carries, under one strain in its layers and another between them.
    fn stresses_of_strains(
        &self,
        element: usize,
        strains: [[f64; 6]; 2],
        states: &[PlyState],
    ) -> impl Iterator<Item = [f64; 6]> {
        let test = self.test;
        let cell = self.cells[element] as usize;
        let bond = f64::from(test.bricks.bond[cell]).max(1.0 / SHARE_STEPS);
        let each = move |p: usize| {
            let angle_rad = test.bricks.plies[self.plies[p] as usize].angle_rad;
            let damage = states[p].damage();
            carried_stress(&test.card.elastic, damage, bond, strains, angle_rad).unwrap_or_default()
        };
        self.plies(element).map(each)
    }

    /// The failure index of each element in its middle and on the faces of thin walls, see [`unresolved_bending`].
    fn bending(&self, states: &[PlyState]) -> Vec<BendingSample> {
        let sample = |element: usize| {
            if self.is_unbreakable(element) {
                return BendingSample::default();
            }
            let cell = self.cells[element] as usize;
            let test = self.test;
            let filled = |c: usize| f64::from(test.bricks.filled[c]);
            let beside = test.bricks.around(cell).filter(|(_, c)| test.active[*c]);
            if is_outside(filled(cell), beside.map(|(_, c)| filled(c))) {
                return BendingSample::default();
            }
            let displacement = self.system.displacement();
            let middle = self.strain(element);
            let index = |strain: [f64; 6]| highest_index(self.indices_of_strain(element, strain, states));
            let wall = test.wall_through(cell);
            let around = || {
                let cells = std::iter::once((DVec3::ZERO, cell)).chain(test.bricks.around(cell));
                let strained =
                    cells.filter_map(|(off, c)| Some((off, c, self.system.strain(displacement, c)?)));
                strained.map(|(off, c, strain)| (off, filled(c), strain)).collect()
            };
            if let Some(sample) = wall.leaning_sample(around, index) {
                return sample;
            }
            let mut sample = BendingSample { middle: index(middle), ..BendingSample::default() };
            sample.face = sample.middle;
            for axis in 0..3 {
                let across = wall.runs[axis].cells;
                if across >= MIN_CELLS_ACROSS {
                    continue;
                }
                let bending = self.system.bending_strain(displacement, cell, axis).unwrap_or_default();
                let faces =
                    [-1.0, 1.0].map(|side| index(std::array::from_fn(|k| middle[k] + side * bending[k])));
                let face = faces[0].max(faces[1]);
                if face > sample.face {
                    sample.face = face;
                    sample.wall_mm = across * wall.cell_mm[axis];
                }
            }
            sample
        };
        (0..self.cells.len()).into_par_iter().map(sample).collect()
    }
}

impl LoadedPart for LoadedSolid<'_> {
    fn n_elements(&self) -> usize {
        self.cells.len()
    }

    fn n_plies(&self) -> usize {
        self.plies.len()
    }

    fn plies(&self, element: usize) -> Range<usize> {
        self.starts[element] as usize..self.starts[element + 1] as usize
    }

    fn amount(&self, ply: usize) -> f64 {
        self.test.bricks.plies[self.plies[ply] as usize].share
    }

    fn centre(&self, element: usize) -> DVec3 {
        self.test.bricks.centre(self.cells[element] as usize)
    }

    fn cell_mm(&self) -> f64 {
        self.test.bricks.cell_mm.x
    }

    fn is_unbreakable(&self, element: usize) -> bool {
        self.test.unbreakable[self.cells[element] as usize]
    }

    fn neighbours_across_crack(&self, ply: usize, element: usize, how: usize) -> Vec<usize> {
        let along = direction(self.test.bricks.plies[self.plies[ply] as usize].angle_rad);
        let normal = match how {
            0 => along.extend(0.0),
            1 => along.perp().extend(0.0),
            _ => DVec3::Z,
        };
        let around = self.test.bricks.around(self.cells[element] as usize);
        let beside =
            around.filter(|(off, _)| off.dot(normal).abs() >= CRACK_NORMAL_COS.value() * off.length());
        beside.filter_map(|(_, other)| self.element_of[other].map(|e| e as usize)).collect()
    }

    fn solve(&mut self) -> Result<UnitSolution, TestError> {
        self.solved += 1;
        let settings = if self.solved == 1 {
            self.settings.clone()
        } else {
            SolveSettings { tolerance: self.later_tolerance, ..self.settings.clone() }
        };
        let followed = self.system.follow(&self.forces, RESIDUAL_GAIN, &settings)?;
        self.iterations += followed.iterations;
        let force_times_displacement =
            self.forces.iter().zip(self.system.displacement()).map(|(f, u)| f.dot(*u)).sum();
        let element = |c: usize| self.element_of[c].map(|e| e as usize);
        let changed = followed.cells.map(|cells| cells.into_iter().filter_map(element).collect());
        Ok(UnitSolution { force_times_displacement, changed })
    }

    fn failure_indices(&self, element: usize, states: &[PlyState], out: &mut Vec<FailureIndices>) {
        out.clear();
        out.extend(self.indices_of_strain(element, self.strain(element), states));
    }

    fn first_indices(&self, states: &[PlyState]) -> Vec<f64> {
        let of_element = |(element, strains): (usize, [[f64; 6]; 2])| {
            highest_index(self.indices_of_strains(element, strains, states))
        };
        self.judged_strains().into_par_iter().enumerate().map(of_element).collect()
    }

    fn update_stiffness(&mut self, elements: &[usize], states: &[PlyState]) -> Result<(), TestError> {
        let mut changes = Vec::with_capacity(elements.len());
        for &e in elements {
            let cell = self.cells[e] as usize;
            let mut damage = [[0.0; 3]; 2];
            for (own, p) in damage.iter_mut().zip(self.plies(e)) {
                *own = states[p].damage();
            }
            // Layers part over the whole brick, so both plies get the same damage.
            damage[1][2] = damage[0][2];
            let known = self.library.all.len();
            let (material, factor) = self.library.find(self.test.bricks, cell, damage)?;
            for stiffness in &self.library.all[known..] {
                self.system.add(stiffness)?;
            }
            changes.push((cell, material, factor * self.test.bricks.filled[cell]));
        }
        self.system.change(&changes);
        Ok(())
    }

    fn round_up(&self, state: &mut PlyState) {
        let damage = state.damage();
        for k in 0..3 {
            let step = damage_step(damage[k]);
            let final_strain = state.final_strain[k];
            if step > 0 {
                let remaining = 1.0 - damage_of_step(step);
                // The softening line solved for the strain.
                let strain = if step == DAMAGE_STEPS {
                    final_strain
                } else {
                    final_strain / (1.0 + remaining * (final_strain - 1.0))
                };
                state.damage_strain[k] = strain.clamp(state.damage_strain[k], final_strain);
            }
        }
    }

    fn dofs(&self) -> usize {
        3 * self.system.n_nodes()
    }

    /// Number of iterations times number of nodes.
    fn solver_work(&self) -> f64 {
        (self.iterations * self.system.n_nodes()) as f64
    }

    fn n_solutions(&self) -> usize {
        self.solved
    }

    fn n_factorizations(&self) -> usize {
        self.system.prepared()
    }
}

/// The number, from 0, of the face-connected piece of each cell; `None` for cells that are not `active`.
pub fn connected_cells(n: [usize; 3], active: &[bool]) -> (Vec<Option<u32>>, usize) {
    let mut piece = vec![None; active.len()];
    let mut count = 0;
    let mut open = Vec::new();
    let size = IVec3::new(n[0] as i32, n[1] as i32, n[2] as i32);
    let index = |c: IVec3| (c.z as usize * n[1] + c.y as usize) * n[0] + c.x as usize;
    for start in 0..active.len() {
        if !active[start] || piece[start].is_some() {
            continue;
        }
        piece[start] = Some(count);
        open.push(start);
        while let Some(cell) = open.pop() {
            let at =
                IVec3::new((cell % n[0]) as i32, (cell / n[0] % n[1]) as i32, (cell / n[0] / n[1]) as i32);
            for next in IVec3::AXES.iter().flat_map(|a| [at + a, at - a]) {
                if next.cmpge(IVec3::ZERO).all() && next.cmplt(size).all() {
                    let i = index(next);
                    if active[i] && piece[i].is_none() {
                        piece[i] = Some(count);
                        open.push(i);
                    }
                }
            }
        }
        count += 1;
    }
    (piece, count as usize)
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec2;

    use super::super::bricks::BrickPly;
    use super::super::card::tests::pla;
    use super::*;

    /// The same in steps so small that nothing is carried past the peak, each solved exactly.
    const SMALL: StepControl = StepControl {
        first_step: 0.01,
        min_step: 0.01,
        tolerance: 0.0,
        overrelaxation: 1.0,
        min_growth: 1.01,
        collapse_load: 0.5,
        collapse_softening: 1.3,
        max_solutions: 4000,
        max_work: f64::INFINITY,
    };

    /// Full bricks of one millimetre with one ply each, of which some are left out; bond by place.
    fn block(
        n: [usize; 3],
        angle_rad: impl Fn([usize; 3]) -> f64,
        bond: impl Fn([usize; 3]) -> f32,
    ) -> Bricks {
        let count = n[0] * n[1] * n[2];
        let at = |c: usize| [c % n[0], c / n[0] % n[1], c / n[0] / n[1]];
        Bricks {
            n,
            origin: DVec3::ZERO,
            cell_mm: DVec3::ONE,
            filled: vec![1.0; count],
            bond: (0..count).map(|c| bond(at(c))).collect(),
            starts: (0..=count as u32).collect(),
            plies: (0..count).map(|c| BrickPly { share: 1.0, angle_rad: angle_rad(at(c)) }).collect(),
            volume_mm3: count as f64,
            laid_mm3: count as f64,
        }
    }

    /// Outcomes with the step control of solids and with small steps, held at x = 0 and pulled at the far end, on the upper
    /// side only where it is to bend open.
    fn peaks(bricks: &Bricks, active: &[bool], pull: DVec3) -> [Outcome; 2] {
        let [nx, ny, nz] = bricks.n;
        let face = |x: usize| (0..=nz).flat_map(move |z| (0..=ny).map(move |y| [x, y, z]));
        let holds: Vec<SolidHold> = face(0).flat_map(|p| DVec3::AXES.map(|a| (p, a))).collect();
        let above = if pull.z > 0.0 { nz } else { 0 };
        let ends: Vec<_> = face(nx).filter(|p| p[2] >= above).collect();
        let forces: Vec<_> = ends.iter().map(|p| (*p, pull / ends.len() as f64)).collect();
        let unbreakable: Vec<bool> = (0..active.len()).map(|c| c % nx < 3 || c % nx + 3 >= nx).collect();
        let test = SolidTest {
            bricks,
            active,
            holds: &holds,
            forces_n: &forces,
            load_n: pull.length(),
            unbreakable: &unbreakable,
            card: &pla(),
            max_mib: 1024.0,
            cancel: CancelFlag::default(),
        };
        [test.run().expect("an answer"), test.run_with(&SMALL, 1e-5).expect("an answer")]
    }

    #[test]
    fn each_direction_of_beads_has_its_own_stiffness() {
        let n = DIRECTIONS as usize;
        let bricks = block([n, 1, 1], |p| p[0] as f64 / DIRECTIONS * std::f64::consts::PI, |_| 1.0);
        let elastic = pla().elastic;
        let mut library = Library { elastic, known: BTreeMap::new(), all: Vec::new() };
        for cell in 0..n {
            let (id, factor) = library.find(&bricks, cell, [[0.0; 3]; 2]).expect("sound cells");
            assert_eq!(
                (usize::from(id), factor),
                (cell, 1.0),
                "cells of all directions before have other stiffnesses"
            );
            let wanted = rotated_about_z(
                &elastic.stiffness().expect("a law"),
                cell as f64 / DIRECTIONS * std::f64::consts::PI,
            );
            let found = &library.all[usize::from(id)];
            let off = (0..6).flat_map(|i| (0..6).map(move |j| (found[i][j] - wanted[i][j]).abs()));
            assert!(off.fold(0.0, f64::max) < 1e-9 * wanted[0][0], "{cell}");
        }
    }

    #[test]
    fn long_steps_find_the_peak_that_small_ones_do() {
        let all = |n: [usize; 3]| vec![true; n[0] * n[1] * n[2]];
        let bar = [18, 4, 4];
        let notched = [26, 12, 4];
        let crossed = |p: [usize; 3]| [0.0, 0.8, -0.8][p[2] % 3];
        let mut open = all(notched);
        for (c, open) in open.iter_mut().enumerate() {
            let (x, y) = (c % 26, c / 26 % 12);
            *open = !((12..14).contains(&x) && y < 4);
        }
        // Layers of a beam that bends, of which the middle ones hardly touch, and not at all at the end.
        let layered = [36, 4, 8];
        let mut slit = all(layered);
        for (c, slit) in slit.iter_mut().enumerate() {
            *slit = !(c % 36 >= 22 && c / 36 / 4 == 4);
        }
        let weak = |p: [usize; 3]| if p[2] == 4 { 0.3 } else { 1.0 };
        for (what, bricks, active, pull) in [
            ("bar", block(bar, |_| 0.0, |_| 1.0), all(bar), DVec3::X),
            ("notched, along", block(notched, |_| 0.0, |_| 1.0), open.clone(), DVec3::X),
            ("notched, crossed", block(notched, crossed, |_| 1.0), open, DVec3::X),
            ("layered", block(layered, |_| 0.0, weak), slit, DVec3::Z),
        ] {
            let [long, small] = peaks(&bricks, &active, 100.0 * pull);
            println!(
                "{what}: {:.1} N in {} solutions, {:.1} N in {} small steps; first {:.1} N",
                long.peak_load_n, long.solutions, small.peak_load_n, small.solutions, small.first_failure_n
            );
            assert!(long.past_peak && small.past_peak, "{what}");
            let off = long.peak_load_n / small.peak_load_n - 1.0;
            assert!(off.abs() < 0.02, "{what}: {} {}", long.peak_load_n, small.peak_load_n);
            assert!(long.solutions < 100, "{what}: {}", long.solutions);
        }
    }

    #[test]
    fn an_edge_of_a_bead_between_two_bars_does_not_fail_first() {
        // Two bars beside each other, one of them pulled, and a cell between them that holds next to nothing.
        let n = [24, 9, 4];
        let beside = |c: usize| c / n[0] % n[1] == 4;
        let is_edge = |c: usize| beside(c) && c % n[0] == 18 && c / (n[0] * n[1]) == 1;
        let is_neck = |c: usize| beside(c) && (15..19).contains(&(c % n[0]));
        let first_n = |card: StrengthCard, is_edge: &dyn Fn(usize) -> bool, edge: Option<(f32, f32)>| {
            let mut bricks = block(n, |_| 0.0, |_| 1.0);
            let count = bricks.filled.len();
            for c in (0..count).filter(|c| is_edge(*c)) {
                (bricks.filled[c], bricks.bond[c]) = edge.unwrap_or((0.0, 1.0));
            }
            let active: Vec<bool> =
                (0..count).map(|c| !beside(c) || (is_edge(c) && edge.is_some())).collect();
            let face =
                |x: usize, y: Range<usize>| (0..=n[2]).flat_map(move |z| y.clone().map(move |y| [x, y, z]));
            let holds: Vec<SolidHold> = face(0, 0..10).flat_map(|p| DVec3::AXES.map(|a| (p, a))).collect();
            let ends: Vec<_> = face(n[0], 0..5).collect();
            let forces: Vec<_> = ends.iter().map(|p| (*p, 100.0 * DVec3::X / ends.len() as f64)).collect();
            let unbreakable: Vec<bool> = (0..count).map(|c| c % n[0] < 3 || c % n[0] + 3 >= n[0]).collect();
            let test = SolidTest {
                bricks: &bricks,
                active: &active,
                holds: &holds,
                forces_n: &forces,
                load_n: 100.0,
                unbreakable: &unbreakable,
                card: &card,
                max_mib: 1024.0,
                cancel: CancelFlag::default(),
            };
            let all = test.first_failures(&[card], IndexScale::ONE);
            let told = 100.0 / all.expect("an answer").first[0].expect("a failure").index;
            // What the test finds while it loads the part is the same.
            let tested = test.run().expect("an answer").first_failure_n;
            assert!((told / tested - 1.0).abs() < 0.01, "{told} {tested}");
            told
        };
        // A brittle material is judged cell by cell.
        let brittle = StrengthCard { g_along_n_mm: 0.1, g_across_n_mm: 0.1, ..pla() };
        let alone = first_n(pla(), &is_edge, None);
        for edge in [(0.07, 1.0), (0.07, 0.1), (0.15, 0.02)] {
            let [with, of_cell] = [pla(), brittle].map(|card| first_n(card, &is_edge, Some(edge)));
            println!("{edge:?}: {with:.0} N, {alone:.0} N without it, {of_cell:.0} N cell by cell");
            assert!((with / alone - 1.0).abs() < 0.06, "{edge:?}: {with} {alone}");
        }
        // The single cell that is most of all strained tears at a twelfth of the load.
        let of_cell = first_n(brittle, &is_edge, Some((0.07, 1.0)));
        assert!(of_cell < 0.1 * alone, "{of_cell} {alone}");
        // A full neck of four by four cells is a part of the piece, and both tell the same.
        let [neck, of_cells] = [pla(), brittle].map(|card| first_n(card, &is_neck, Some((1.0, 1.0))));
        assert!(neck < 0.9 * alone && (neck / of_cells - 1.0).abs() < 0.02, "{neck} {of_cells}");
    }

    #[test]
    fn a_solid_with_a_hole_answers_alike_wherever_its_cells_lie() {
        // 30 x 10 x 2 mm with a hole of 3 mm, cells of half a millimetre; two rows of cells beside the middle of the hole
        // break alike, one in the middle, or none does.
        let n = [60, 20, 4];
        let peak = |moved: f64| {
            let mut bricks = Bricks { cell_mm: DVec3::splat(0.5), ..block(n, |_| 0.0, |_| 1.0) };
            let middle = DVec3::new(15.0 + moved, 5.0 + moved, 0.0);
            for c in 0..bricks.filled.len() {
                let off = bricks.centre(c) - middle;
                let corner = |k: i32| DVec2::new(f64::from(k % 8) - 3.5, f64::from(k / 8) - 3.5) / 16.0;
                let outside = (0..64).filter(|k| (off.truncate() + corner(*k)).length() > 1.5);
                bricks.filled[c] = outside.count() as f32 / 64.0;
            }
            let active: Vec<bool> = bricks.filled.iter().map(|f| *f > 0.06).collect();
            let both = peaks(&bricks, &active, 100.0 * DVec3::X).map(|o| o.peak_load_n);
            println!("moved by {moved} mm: {:.1} N, {:.1} N in small steps", both[0], both[1]);
            assert!((both[0] / both[1] - 1.0).abs() < 0.025, "{both:?}");
            both
        };
        let all = [peak(0.0), peak(0.125), peak(0.25)];
        for k in 0..2 {
            let peaks = all.map(|both| both[k]);
            let [low, high] = [f64::min, f64::max].map(|f| peaks.into_iter().reduce(f).expect("three"));
            assert!(high < 1.06 * low, "{peaks:?}");
        }
    }
}
