//! A part made of beads as a solid: [`Bricks`] as elements, each with the stiffness of its plies, damaged as they are.

use std::collections::BTreeMap;
use std::ops::Range;

use grainpath_core::math::direction;
use grainpath_core::{DVec3, IVec3};

use super::bricks::Bricks;
use super::drawing::{self, Body, Near, Pace, State};
use super::ply::{StrengthCard, broken_solid, left};
use super::{ASIDE, Outcome, TestError};
use crate::material::{Orthotropic, Stiffness, rotated_about_z};
use crate::solid::voxel::{VOID, VoxelPart, VoxelSystem};
use crate::solid::{Method, SolidError, SolveSettings};

/// A grid point, and a direction along which it is held.
pub type SolidHold = ([usize; 3], DVec3);

/// A part made of beads, held, loaded, and drawn until it breaks.
pub struct SolidTest<'a> {
    /// What it is made of.
    pub bricks: &'a Bricks,
    /// Cells that are elements.
    pub taken: &'a [bool],
    /// Where it is held.
    pub holds: &'a [SolidHold],
    /// Force at grid points, N: the load that a factor of 1 stands for.
    pub forces_n: &'a [([usize; 3], DVec3)],
    /// What that load is called, N.
    pub load_n: f64,
    /// Cells that do not break: those in grips and under rollers.
    pub spared: &'a [bool],
    /// The material.
    pub card: &'a StrengthCard,
    /// The most the solver may take, MiB.
    pub most_mib: f64,
}

/// How solids are drawn. A solution is dear: a crack need not have come quite to rest before the load rises, what
/// plainly falls is not followed further, and the peak is not looked for in smaller steps. For that the steps are
/// small, and plies are drawn less far beyond what is asked: one load beyond the peak harms little.
const PACE: Pace = Pace {
    step: 0.05,
    finest: 0.05,
    slack: 0.02,
    over: [1.5, 1.03],
    fallen: [0.8, 1.15],
    most_solutions: 400,
    // A quarter of an hour on two cores.
    most_work: 1e9,
};
/// Error of the first solution, as its residual over the load.
const TOLERANCE: f64 = 1e-5;
/// The same of those that follow, in which little has changed; what did change is found to a tenth.
const TOLERANCE_AFTER: f64 = 1e-2;
const GAIN: f64 = 0.1;
/// Directions that stiffness tells apart in half a turn. Failure knows them exactly.
const TURNS: f64 = 32.0;
/// Shares of a second ply, and bonds, that stiffness tells apart.
const SHARES: f64 = 8.0;
/// Stiffness is lost in steps of a sixteenth of an octave, down to a thousandth.
const LOSSES: u64 = 160;
/// The most stiffnesses that are told apart.
const MOST_STIFFNESSES: usize = 30_000;

impl SolidTest<'_> {
    /// Draws the part until it breaks. Outcomes go by element: cells that are taken, in order.
    ///
    /// # Errors
    /// [`TestError`] when it moves freely, is too large for the memory allowed, or nothing is strained.
    pub fn run(&self) -> Result<Outcome, TestError> {
        self.drawn(&PACE, TOLERANCE_AFTER)
    }

    fn drawn(&self, pace: &Pace, tolerance_after: f64) -> Result<Outcome, TestError> {
        let cells: Vec<u32> = (0..self.taken.len()).filter(|&c| self.taken[c]).map(|c| c as u32).collect();
        let mut starts = vec![0];
        let mut plies = Vec::new();
        for &c in &cells {
            let range = self.bricks.starts[c as usize]..self.bricks.starts[c as usize + 1];
            plies.extend(range);
            starts.push(plies.len() as u32);
        }
        let mut library = Library { elastic: self.card.elastic, known: BTreeMap::new(), all: Vec::new() };
        let mut material = vec![VOID; self.taken.len()];
        let mut scale = vec![0.0; self.taken.len()];
        let whole = [[0.0; 3]; 2];
        for &c in &cells {
            let c = c as usize;
            (material[c], _) = library.of(self.bricks, c, whole)?;
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
            tolerance: TOLERANCE,
            most_iterations: 300,
            most_mib: self.most_mib,
            method: Method::Iterative,
        };
        let system = VoxelSystem::new(part, &holds, &settings)?;
        let mut forces = vec![DVec3::ZERO; system.n_nodes()];
        for (p, f) in self.forces_n {
            if let Some(i) = system.node(*p) {
                forces[i] += *f;
            }
        }
        let size_mm = [self.bricks.cell_mm.x, self.bricks.cell_mm.z];
        let mut at = vec![None; self.taken.len()];
        cells.iter().enumerate().for_each(|(e, c)| at[*c as usize] = Some(e as u32));
        let mut body = Solid {
            test: self,
            cells,
            at,
            starts,
            plies,
            library,
            system,
            settings,
            tolerance_after,
            forces,
            solved: 0,
            iterations: 0,
        };
        drawing::draw(&mut body, std::slice::from_ref(self.card), size_mm, self.load_n, pace)
    }
}

/// Stiffnesses by what they are made of, each once.
struct Library {
    elastic: Orthotropic,
    known: BTreeMap<u64, u16>,
    all: Vec<Stiffness>,
}

/// The step that has lost at least this much, but for rounding.
fn step_of(loss: f64) -> u64 {
    let octaves = -grainpath_core::math::ln((1.0 - loss).max(1e-9)) / std::f64::consts::LN_2;
    ((16.0 * octaves - 1e-6).ceil().max(0.0) as u64).min(LOSSES)
}

fn loss_of(step: u64) -> f64 {
    const ROOT: f64 = 0.957_603_280_698_573_6;
    1.0 - 0.5f64.powi((step / 16) as i32) * ROOT.powi((step % 16) as i32)
}

impl Library {
    /// Which stiffness a cell has with these losses of its plies, and a factor on it: 1 but where the library is full.
    fn of(&mut self, bricks: &Bricks, cell: usize, losses: [[f64; 3]; 2]) -> Result<(u16, f32), TestError> {
        let plies = bricks.of_cell(cell);
        let turn = |angle: f64| (angle / std::f64::consts::PI * TURNS).round().rem_euclid(TURNS) as u64;
        let bond = (f64::from(bricks.bond[cell]) * SHARES).round().max(1.0) as u64;
        let (first, second) = (plies.first(), plies.get(1));
        let a = [first, second].map(|p| p.map_or(0, |p| turn(p.angle_rad)));
        let share = second.map_or(0, |p| (p.share * SHARES).round().max(1.0) as u64);
        let lost = losses.map(|l| l.map(step_of));
        let mut key = 0;
        for (value, bits) in [(a[0], 5), (a[1], 5), (share, 4), (bond, 4)] {
            key = key << bits | value;
        }
        for (k, l) in lost.iter().enumerate() {
            for step in l {
                key = key << 8 | if k == 1 && share == 0 { 0 } else { *step };
            }
        }
        if let Some(known) = self.known.get(&key) {
            return Ok((*known, 1.0));
        }
        let mut sum = [[0.0; 6]; 6];
        for k in 0..if share > 0 { 2 } else { 1 } {
            let own = broken_solid(&self.elastic, lost[k].map(loss_of), bond as f64 / SHARES)?;
            let c = rotated_about_z(&own, a[k] as f64 / TURNS * std::f64::consts::PI);
            let second = share as f64 / SHARES;
            let weight = if k == 1 { second } else { 1.0 - second };
            for i in 0..6 {
                (0..6).for_each(|j| sum[i][j] += weight * c[i][j]);
            }
        }
        // Rounding of the turn leaves it a hair off symmetric.
        let c = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (sum[i][j] + sum[j][i])));
        if self.all.len() >= MOST_STIFFNESSES {
            let least = losses.iter().flatten().fold(1.0, |m: f64, l| m.min(1.0 - l));
            let whole = [[0.0; 3]; 2];
            return if losses == whole {
                Err(SolidError::NotPositive.into())
            } else {
                self.of(bricks, cell, whole).map(|(m, _)| (m, least as f32))
            };
        }
        let id = self.all.len() as u16;
        self.all.push(c);
        self.known.insert(key, id);
        Ok((id, 1.0))
    }
}

/// A part and its last solution.
struct Solid<'a> {
    test: &'a SolidTest<'a>,
    /// Cell of each element.
    cells: Vec<u32>,
    /// Element of each cell.
    at: Vec<Option<u32>>,
    starts: Vec<u32>,
    /// Each ply among those of the bricks.
    plies: Vec<u32>,
    library: Library,
    system: VoxelSystem,
    settings: SolveSettings,
    tolerance_after: f64,
    forces: Vec<DVec3>,
    solved: usize,
    iterations: usize,
}

impl Body for Solid<'_> {
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

    fn is_spared(&self, element: usize) -> bool {
        self.test.spared[self.cells[element] as usize]
    }

    fn rivals(&self, ply: usize, element: usize, how: usize) -> Vec<usize> {
        let along = direction(self.test.bricks.plies[self.plies[ply] as usize].angle_rad);
        let normal = match how {
            0 => along.extend(0.0),
            1 => along.perp().extend(0.0),
            _ => DVec3::Z,
        };
        let around = self.test.bricks.around(self.cells[element] as usize);
        let beside = around.filter(|(off, _)| off.dot(normal).abs() >= ASIDE * off.length());
        beside.filter_map(|(_, other)| self.at[other].map(|e| e as usize)).collect()
    }

    fn solve(&mut self) -> Result<(f64, Option<Vec<usize>>), TestError> {
        self.solved += 1;
        let settings = if self.solved == 1 {
            self.settings
        } else {
            SolveSettings { tolerance: self.tolerance_after, ..self.settings }
        };
        let followed = self.system.follow(&self.forces, GAIN, &settings)?;
        self.iterations += followed.iterations;
        let work = self.forces.iter().zip(self.system.displacement()).map(|(f, u)| f.dot(*u)).sum();
        let element = |c: usize| self.at[c].map(|e| e as usize);
        Ok((work, followed.cells.map(|cells| cells.into_iter().filter_map(element).collect())))
    }

    fn near(&self, element: usize, states: &[State]) -> Vec<Near> {
        let test = self.test;
        let cell = self.cells[element] as usize;
        let strain = self.system.strain(self.system.displacement(), cell);
        let [xx, yy, zz, xy, yz, zx] = strain.unwrap_or_default();
        let bond = f64::from(test.bricks.bond[cell]).max(1.0 / SHARES);
        let each = |(k, p): (usize, usize)| {
            let (s, c) = grainpath_core::math::sin_cos(test.bricks.plies[self.plies[p] as usize].angle_rad);
            let own = [
                c * c * xx + s * s * yy + s * c * xy,
                s * s * xx + c * c * yy - s * c * xy,
                zz,
                2.0 * s * c * (yy - xx) + (c * c - s * s) * xy,
                c * yz - s * zx,
                s * yz + c * zx,
            ];
            let losses = states[p].losses();
            let stiffness = broken_solid(&test.card.elastic, losses, bond).unwrap_or_default();
            // Per area that still carries: the strength is that of whole material.
            let left = left(losses, bond);
            let stress: [f64; 6] = std::array::from_fn(|i| {
                stiffness[i].iter().zip(own).map(|(c, e)| c * e).sum::<f64>() / left[i]
            });
            let plane = [stress[0], stress[1], stress[3]];
            let ([through, between], mode) = test.card.indices(plane);
            let (apart, slides) = test.card.layers([stress[2], stress[4], stress[5]]);
            // What lies above one ply lies above the other.
            let apart = if k == 0 { apart } else { 0.0 };
            Near { index: [through, between, apart], slides: [false, test.card.slides(plane), slides], mode }
        };
        self.plies(element).enumerate().map(each).collect()
    }

    fn change(&mut self, elements: &[usize], states: &[State]) -> Result<(), TestError> {
        let mut changes = Vec::with_capacity(elements.len());
        for &e in elements {
            let cell = self.cells[e] as usize;
            let mut losses = [[0.0; 3]; 2];
            for (own, p) in losses.iter_mut().zip(self.plies(e)) {
                *own = states[p].losses();
            }
            // Layers part across the whole brick.
            losses[1][2] = losses[0][2];
            let known = self.library.all.len();
            let (material, factor) = self.library.of(self.test.bricks, cell, losses)?;
            for stiffness in &self.library.all[known..] {
                self.system.add(stiffness)?;
            }
            changes.push((cell, material, factor * self.test.bricks.filled[cell]));
        }
        self.system.change(&changes);
        Ok(())
    }

    fn settle(&self, state: &mut State) {
        let losses = state.losses();
        for k in 0..3 {
            let step = step_of(losses[k]);
            let most = state.most[k];
            if step > 0 {
                let left = 1.0 - loss_of(step);
                // The softening line, from what is left to how far it is drawn.
                let drawn = if step == LOSSES { most } else { most / (1.0 + left * (most - 1.0)) };
                state.drawn[k] = drawn.clamp(state.drawn[k], most);
            }
        }
    }

    fn dofs(&self) -> usize {
        3 * self.system.n_nodes()
    }

    /// Iterations times nodes.
    fn work(&self) -> f64 {
        (self.iterations * self.system.n_nodes()) as f64
    }

    fn effort(&self) -> [usize; 2] {
        [self.solved, self.system.prepared()]
    }
}

/// Cells that hang together over their faces, numbered from 0; `None` for cells that are not `taken`.
pub fn pieces(n: [usize; 3], taken: &[bool]) -> (Vec<Option<u32>>, usize) {
    let mut piece = vec![None; taken.len()];
    let mut count = 0;
    let mut open = Vec::new();
    let size = IVec3::new(n[0] as i32, n[1] as i32, n[2] as i32);
    let index = |c: IVec3| (c.z as usize * n[1] + c.y as usize) * n[0] + c.x as usize;
    for start in 0..taken.len() {
        if !taken[start] || piece[start].is_some() {
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
                    if taken[i] && piece[i].is_none() {
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
    use super::super::ply::tests::pla;
    use super::*;

    /// The same in steps so small that nothing is carried past the peak, each solved exactly.
    const SMALL: Pace = Pace {
        step: 0.01,
        finest: 0.01,
        slack: 0.0,
        over: [1.0, 1.01],
        fallen: [0.5, 1.3],
        most_solutions: 4000,
        most_work: f64::INFINITY,
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

    /// Peak loads as solids are drawn and in small steps, held at x = 0 and pulled at the far end, on the upper side
    /// only where it is to bend open.
    fn peaks(bricks: &Bricks, taken: &[bool], pull: DVec3) -> [Outcome; 2] {
        let [nx, ny, nz] = bricks.n;
        let face = |x: usize| (0..=nz).flat_map(move |z| (0..=ny).map(move |y| [x, y, z]));
        let holds: Vec<SolidHold> = face(0).flat_map(|p| DVec3::AXES.map(|a| (p, a))).collect();
        let above = if pull.z > 0.0 { nz } else { 0 };
        let ends: Vec<_> = face(nx).filter(|p| p[2] >= above).collect();
        let forces: Vec<_> = ends.iter().map(|p| (*p, pull / ends.len() as f64)).collect();
        let spared: Vec<bool> = (0..taken.len()).map(|c| c % nx < 3 || c % nx + 3 >= nx).collect();
        let test = SolidTest {
            bricks,
            taken,
            holds: &holds,
            forces_n: &forces,
            load_n: pull.length(),
            spared: &spared,
            card: &pla(),
            most_mib: 1024.0,
        };
        [test.run().expect("an answer"), test.drawn(&SMALL, 1e-5).expect("an answer")]
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
        for (what, bricks, taken, pull) in [
            ("bar", block(bar, |_| 0.0, |_| 1.0), all(bar), DVec3::X),
            ("notched, along", block(notched, |_| 0.0, |_| 1.0), open.clone(), DVec3::X),
            ("notched, crossed", block(notched, crossed, |_| 1.0), open, DVec3::X),
            ("layered", block(layered, |_| 0.0, weak), slit, DVec3::Z),
        ] {
            let [long, small] = peaks(&bricks, &taken, 100.0 * pull);
            println!(
                "{what}: {:.1} N in {} solutions, {:.1} N in {} small steps; first {:.1} N",
                long.peak_load_n, long.effort[0], small.peak_load_n, small.effort[0], small.first_n
            );
            assert!(long.ended && small.ended, "{what}");
            let off = long.peak_load_n / small.peak_load_n - 1.0;
            assert!(off.abs() < 0.02, "{what}: {} {}", long.peak_load_n, small.peak_load_n);
            assert!(long.effort[0] < 100, "{what}: {}", long.effort[0]);
        }
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
            let taken: Vec<bool> = bricks.filled.iter().map(|f| *f > 0.06).collect();
            let both = peaks(&bricks, &taken, 100.0 * DVec3::X).map(|o| o.peak_load_n);
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
