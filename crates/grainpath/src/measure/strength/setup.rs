//! Applies the fixtures and loads of a job to the cells of a plate test, and moves the beads of a
//! program into part coordinates.
//!
//! A program of any slicer may be tested, so it is first compared with the part: its size, its
//! height, and how much of it lies outside the part's sections. Lengths are in mm, forces in N.
//! Cost: linear in beads and cells.

use std::sync::Arc;

use grainpath_core::math::cross;
use grainpath_core::poly::Join;
use grainpath_core::selection::Selection;
use grainpath_core::{DVec2, DVec3, LayerStack, Region, Role, TriMesh};
use grainpath_fea::load_case::{Action, BoundaryConditions, Held, LoadCase};
use grainpath_fea::strength::TestError;
use grainpath_fea::strength::cell_grid::CellGrid;
use grainpath_fea::strength::grid_turn::Frame;
use grainpath_fea::strength::laminate::{BeadPiece, BeadSheet, Laminate, MAX_BEAD_WIDTH_MM};
use grainpath_fea::strength::squares::{GridHold, PlateElements, connected_cells, free_motion};
use grainpath_gcode::{Bead, BeadLayer, Program};
use grainpath_job::choices;
use rayon::prelude::*;

use super::{CORNERS, StrengthError, StrengthSettings};
pub(super) use crate::guide::UNBREAKABLE_MM;
use crate::guide::{check_flat, is_plate};

/// Smallest share of a cell's height that must be filled; emptier cells are left out.
const LEAST_FILLED: f64 = 0.02;
/// Beads of another slicer's program belong to the part up to this distance outside it, mm.
const OUTSIDE_MM: f64 = 1.0;
/// Largest share of the program's bead length beyond that distance. If the share is larger, the program
/// prints another part, or the part is rotated.
const MOST_OUTSIDE: f64 = 0.05;
/// Least share of a load that has to act on nodes that are not held along it. Source: derived: what rounding leaves of a force
/// along a direction that is held is about 1e-16 of it.
const LEAST_FREE: f64 = 1e-9;
/// Number of sections of the part that are sampled.
const SECTIONS: usize = 9;

/// The model of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fidelity {
    /// A plate: layers homogenised through the thickness.
    Plane,
    /// A solid of box-shaped cells.
    Voxels,
}

impl Fidelity {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Voxels => "voxels",
        }
    }
}

/// The inputs of a strength test that come from the part and the job: all except the beads.
#[derive(Debug, Clone)]
pub struct TestSetup {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// The section in the middle of the part's height.
    pub(super) section: Region,
    /// Sampled sections with their heights, mm, for comparing another slicer's beads.
    sections: Vec<(f64, Region)>,
    /// Volume of the part, mm3.
    pub(super) volume_mm3: f64,
    pub(super) n_layers: usize,
    pub(super) fidelity: Fidelity,
    /// Surface of the part if it is loaded by a pressure; otherwise empty.
    pub(super) mesh: TriMesh,
    pub(super) conditions: BoundaryConditions,
    /// Index of the tested load case.
    case: usize,
    /// The other load cases of the job.
    others: Vec<Self>,
    /// The orientation of the grid.
    pub(super) frame: Frame,
    /// Whether the job has fibre, which has a material card of its own.
    fibre: bool,
}

/// Returns the layers in which the part is printed, their heights, and the height of the part's bottom, mm.
pub(super) fn layers_of_part(program: &Program) -> (Vec<&BeadLayer>, Vec<f64>, f64) {
    let of_part = |l: &&BeadLayer| l.beads.iter().any(|b| b.role.is_part());
    let layers: Vec<&BeadLayer> = program.layers.iter().filter(of_part).collect();
    // A first layer far above the plate stands on a raft or on supports, which are not tested.
    let first = match layers.as_slice() {
        [a, b, ..] if a.z_mm > 3.0 * (b.z_mm - a.z_mm) => a.z_mm - a.height_mm,
        _ => 0.0,
    };
    let mut below = first;
    // The heights are computed from the nozzle heights, because other slicers do not state them.
    let heights = layers.iter().map(|l| l.z_mm - std::mem::replace(&mut below, l.z_mm)).collect();
    (layers, heights, first)
}

/// The section in the middle of the part's height; empty without layers.
fn middle_section(stack: &LayerStack) -> Region {
    let layers = stack.layers();
    layers.get(layers.len() / 2).map(|l| l.region().clone()).unwrap_or_default()
}

/// Whether any bead of the program is raised above its layer.
pub(super) fn is_staggered(layers: &[&BeadLayer]) -> bool {
    layers.iter().flat_map(|l| &l.beads).any(|b| b.raise_mm != [0.0; 2])
}

/// The beads of a part's layers, moved by `-shift`. If some walls are half a layer higher than others, each layer becomes
/// two sheets, and each sheet gets the beads at its height.
pub(super) fn sheets_of(
    layers: &[&BeadLayer],
    heights: &[f64],
    shift: DVec2,
    fibre: bool,
    taken: &(dyn Fn(&Bead) -> bool + Sync),
) -> Vec<BeadSheet> {
    let piece = |b: &Bead| BeadPiece {
        a: b.start() - shift,
        b: b.end() - shift,
        volume_mm3: f64::from(b.volume_mm3),
        material: u8::from(fibre && b.role == Role::Fibre),
    };
    let sheet = |(l, h): (&&BeadLayer, &f64)| BeadSheet {
        height_mm: *h,
        beads: l.beads.iter().filter(|b| b.role.is_part() && taken(b)).map(piece).collect(),
    };
    if !is_staggered(layers) {
        return layers.par_iter().zip(heights).map(sheet).collect();
    }
    let half = |h: &f64| BeadSheet { height_mm: 0.5 * h, beads: Vec::new() };
    let mut sheets: Vec<BeadSheet> = heights.iter().flat_map(|h| [half(h), half(h)]).collect();
    for (i, (l, h)) in layers.iter().zip(heights).enumerate() {
        for b in l.beads.iter().filter(|b| b.role.is_part() && taken(b)) {
            // Bottom and top of the bead above the bottom of its layer.
            let [low, high] = [f64::from(b.raise_mm[0]), h + f64::from(b.raise_mm[1])];
            let mut bottom = 0.0;
            for sheet in &mut sheets[2 * i..] {
                let top = bottom + sheet.height_mm;
                let share = ((high.min(top) - low.max(bottom)) / (high - low).max(1e-9)).max(0.0);
                if bottom >= high {
                    break;
                }
                // Heights are rounded to a micrometre, so a bead may reach into a sheet by a sliver, which is ignored.
                if share > 0.02 {
                    let whole = piece(b);
                    sheet.beads.push(BeadPiece { volume_mm3: share * whole.volume_mm3, ..whole });
                }
                bottom = top;
            }
        }
    }
    sheets
}

impl TestSetup {
    /// Sets up one test for every load case of the job, that with the largest weight first.
    ///
    /// # Errors
    /// [`StrengthError`] if a fixture, a load or a strength of the material is missing, or if
    /// a plate test has a load out of the layers' plane.
    pub fn new(
        settings: &StrengthSettings,
        mesh: &TriMesh,
        stack: &LayerStack,
        conditions: BoundaryConditions,
    ) -> Result<Self, StrengthError> {
        settings.cards(CORNERS[0])?;
        let heaviest = conditions.heaviest_case().ok_or(StrengthError::Missing("a [[guide.load]]"))?;
        if conditions.fixtures.is_empty() {
            return Err(StrengthError::Missing("a [[guide.fixture]]"));
        }
        let section = middle_section(stack);
        let fidelity = match settings.fidelity {
            choices::Fidelity::Plane => {
                check_flat(&section, &conditions).map_err(StrengthError::NotFlat)?;
                Fidelity::Plane
            }
            choices::Fidelity::Auto if is_plate(stack, &conditions) => Fidelity::Plane,
            // Fibre can be tested only in plates, so a part with fibre is a plate wherever the loads allow it.
            choices::Fidelity::Auto
                if settings.fibre.is_some() && check_flat(&section, &conditions).is_ok() =>
            {
                Fidelity::Plane
            }
            choices::Fidelity::Auto | choices::Fidelity::Voxels => Fidelity::Voxels,
        };
        if fidelity == Fidelity::Voxels && settings.fibre.is_some() {
            return Err(StrengthError::FibreInSpace);
        }
        let of_case = |case: usize| Self::of_case(settings, mesh, stack, conditions.clone(), case, fidelity);
        let others = (0..conditions.cases.len()).filter(|case| *case != heaviest).map(of_case);
        Ok(Self { others: others.collect::<Result<_, _>>()?, ..of_case(heaviest)? })
    }

    fn of_case(
        settings: &StrengthSettings,
        mesh: &TriMesh,
        stack: &LayerStack,
        conditions: BoundaryConditions,
        case: usize,
        fidelity: Fidelity,
    ) -> Result<Self, StrengthError> {
        let layers = stack.layers();
        let section = middle_section(stack);
        let sections = (0..layers.len()).step_by(layers.len().div_ceil(SECTIONS).max(1)).map(|i| {
            let layer = &layers[i];
            (layer.z_top_mm() - 0.5 * layer.height_mm(), layer.region().clone())
        });
        let sections = sections.collect();
        for fixture in &conditions.fixtures {
            let what = fixture.name.clone();
            if fixture.displacement_mm != DVec3::ZERO {
                return Err(StrengthError::Moved(what));
            }
            // Only planes and cylinders define a normal.
            let has_normal = matches!(fixture.on, Selection::Plane { .. } | Selection::Cylinder { .. });
            if fixture.held == Held::Normal && !has_normal {
                return Err(StrengthError::NoNormal { what, shape: fixture.on.name() });
            }
        }
        for load in conditions.cases.iter().flat_map(|case| &case.loads) {
            if load.action.is_for_solids() {
                return Err(StrengthError::LoadOfSolids { what: load.name.clone(), key: load.action.key() });
            }
        }
        let is_pressure = |a: &Action| matches!(a, Action::Pressure { .. });
        let pressed = conditions.cases[case].loads.iter().any(|l| is_pressure(&l.action));
        // The mesh may be large, so it is kept only for pressures.
        let mesh = if pressed { mesh.clone() } else { TriMesh::default() };
        let volume_mm3 = layers.iter().map(|l| l.region().area_mm2() * l.height_mm()).sum();
        let n_layers = layers.len();
        Ok(Self {
            low: conditions.low,
            high: conditions.high,
            section,
            sections,
            volume_mm3,
            n_layers,
            fidelity,
            mesh,
            conditions,
            case,
            others: Vec::new(),
            frame: Frame::default(),
            fibre: settings.fibre.is_some(),
        })
    }

    /// The same test of solid cells, for a part whose stress was solved as that of a solid. Fibre has no such cells.
    pub(crate) fn into_solid(mut self) -> Self {
        if !self.fibre {
            self.fidelity = Fidelity::Voxels;
            self.others = self.others.into_iter().map(Self::into_solid).collect();
        }
        self
    }

    /// This test and those of the other load cases, in the order of the job.
    pub(super) fn all_cases(&self) -> Vec<&Self> {
        let mut all: Vec<&Self> = std::iter::once(self).chain(&self.others).collect();
        all.sort_by_key(|setup| setup.case);
        all
    }

    /// The tested load case.
    pub fn case(&self) -> &LoadCase {
        &self.conditions.cases[self.case]
    }

    /// The same test with another orientation of the grid.
    pub(super) fn in_frame(&self, frame: Frame) -> Self {
        Self { frame, others: Vec::new(), ..self.clone() }
    }

    fn at(&self, p: DVec2) -> DVec3 {
        p.extend(0.5 * (self.low.z + self.high.z))
    }

    pub(super) fn catches_nothing(&self, what: &str, on: &Selection) -> StrengthError {
        self.conditions.catches_nothing(what, on, "what is printed and held").into()
    }

    /// The beads of the part in part coordinates, and the vector from part coordinates to program coordinates. For a program
    /// of grainpath the part's position on the plate is known; otherwise the centre of the printed beads gives it.
    ///
    /// # Errors
    /// [`StrengthError`] if no part is printed, or if its size differs from the job's part.
    pub(super) fn sheets(
        &self,
        program: &Program,
        plate_from_part: Option<DVec2>,
    ) -> Result<(Vec<BeadSheet>, DVec3), StrengthError> {
        let (layers, heights, first) = layers_of_part(program);
        let below = layers.last().map_or(first, |l| l.z_mm);
        let box_of = |l: &BeadLayer, h: f64| {
            let mut bounds = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for b in l.beads.iter().filter(|b| b.role.is_part()) {
                let r = 0.5 * strip_mm(b, h);
                bounds.0 = bounds.0.min(b.start().min(b.end()) - r);
                bounds.1 = bounds.1.max(b.start().max(b.end()) + r);
            }
            bounds
        };
        // The first layer is skipped: it may contain purge lines of another slicer, whose role does not
        // distinguish them from the part.
        let skipped = usize::from(layers.len() > 2);
        let boxes = layers.iter().zip(&heights).skip(skipped).map(|(l, h)| box_of(l, *h));
        let found = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).ok_or(StrengthError::NothingPrinted)?;
        let (size, part) = (found.1 - found.0, (self.high - self.low).truncate());
        let tall = below - first;
        // Another slicer may scale or simplify slightly; a difference of more than 3 % and 1.5 mm is another part.
        let far = |a: f64, b: f64| (a - b).abs() > f64::max(1.5, 0.03 * b);
        // The program of another slicer may end up to one layer higher or lower. If more is missing,
        // the program is incomplete.
        let layer = heights.iter().copied().fold(0.0, f64::max);
        let (height, most) = (self.high.z - self.low.z, f64::max(1.01 * layer, 0.01 * tall));
        if far(size.x, part.x) || far(size.y, part.y) || (tall - height).abs() > most {
            let part = self.high - self.low;
            return Err(StrengthError::WrongPart { printed: size.extend(tall), part });
        }
        let shift =
            plate_from_part.unwrap_or(0.5 * (found.0 + found.1) - 0.5 * (self.low + self.high).truncate());
        // Beads more than 2 mm outside the bounding box of the upper layers are purge lines.
        let near = |p: DVec2| (p - found.0).min(found.1 - p).min_element() > -2.0;
        let is_near = |b: &Bead| near(b.start()) && near(b.end());
        let sheets = sheets_of(&layers, &heights, shift, self.fibre, &is_near);
        // For a program of grainpath the position is exact and is not checked.
        let share = if plate_from_part.is_some() { 0.0 } else { self.outside(&sheets) };
        if share > MOST_OUTSIDE {
            return Err(StrengthError::Outside { percent: 100.0 * share });
        }
        Ok((sheets, shift.extend(first - self.low.z)))
    }

    /// The share of the beads' length that lies outside the part. Only the layers at the sampled
    /// sections are measured.
    fn outside(&self, sheets: &[BeadSheet]) -> f64 {
        let (mut all, mut outside) = (0.0, 0.0);
        for (z_mm, section) in &self.sections {
            let mut top = self.low.z;
            let at = sheets.iter().find(|s| {
                top += s.height_mm;
                top >= *z_mm
            });
            let grown = section.offset(OUTSIDE_MM, Join::Miter(2.0));
            for b in at.iter().flat_map(|s| &s.beads) {
                let length = b.a.distance(b.b);
                all += length;
                // A long bead is sampled every two millimetres.
                let n = (0.5 * length).ceil().clamp(1.0, 1000.0) as usize;
                let place = |k: usize| b.a.lerp(b.b, (k as f64 + 0.5) / n as f64);
                let without = (0..n).filter(|k| !grown.contains(place(*k))).count();
                outside += length * without as f64 / n as f64;
            }
        }
        outside / f64::max(all, 1e-12)
    }

    /// Prepares the held nodes and the forces of a test on these cells.
    ///
    /// # Errors
    /// [`StrengthError`] if a fixture or load selects no material, or if a piece can move freely.
    pub(super) fn prepared(&self, laminate: Arc<Laminate>) -> Result<Prepared, StrengthError> {
        let grid = laminate.grid;
        let cell_mm = grid.cell_mm;
        let n = grid.nx * grid.ny;
        let least = LEAST_FILLED * laminate.height_mm;
        let mut taken: Vec<bool> = (0..n).map(|c| laminate.thickness_mm(c) > least).collect();
        let (piece, n_pieces) = connected_cells(&grid, &taken);
        // Only material connected to a fixture can carry a load.
        // Nodes lie up to half a cell from the true border, or more along a diagonal, so the selections
        // are grown by 0.75 cells.
        let reach = 0.75 * cell_mm;
        let mut holds_of = vec![Vec::new(); n_pieces];
        let elements = PlateElements::from_cells(&grid, &taken);
        let wide: Vec<Selection> =
            self.conditions.fixtures.iter().map(|f| contact(&f.on, &elements, self.frame, reach)).collect();
        for (cell, corners) in elements.cells.iter().zip(&elements.corners) {
            let Some(p) = piece[*cell as usize] else { continue };
            for &node in corners {
                let place = self.frame.to_part(elements.node(node as usize));
                let along = self.directions(&wide, place);
                holds_of[p as usize].extend(along.map(|a| (place, a)));
            }
        }
        for (fixture, wide) in self.conditions.fixtures.iter().zip(&wide) {
            if !(0..elements.places.len())
                .any(|i| wide.contains(self.at(self.frame.to_part(elements.node(i)))))
            {
                return Err(self.catches_nothing(&fixture.name, &fixture.on));
            }
        }
        let mut lost = 0.0;
        for cell in 0..n {
            let Some(p) = piece[cell] else { continue };
            if holds_of[p as usize].is_empty() {
                taken[cell] = false;
                lost += laminate.thickness_mm(cell) * cell_mm * cell_mm;
            }
        }
        for holds in holds_of.iter().filter(|h| !h.is_empty()) {
            // If a held piece can still turn or slide, the stiffness matrix would be singular.
            if let Some(how) = free_motion(holds) {
                let at = holds[0].0;
                return Err(StrengthError::Free { x: at.x, y: at.y, how });
            }
        }
        let elements = PlateElements::from_cells(&grid, &taken);
        let in_grid: Vec<DVec2> = (0..elements.places.len()).map(|i| elements.node(i)).collect();
        let nodes: Vec<DVec2> = in_grid.iter().map(|p| self.frame.to_part(*p)).collect();
        let mut marked = vec![false; nodes.len()];
        // Loose cells were removed, so the nodes have new numbers.
        let mut holds = Vec::new();
        for (i, p) in nodes.iter().enumerate() {
            for along in self.directions(&wide, *p) {
                holds.push(GridHold { node: i as u32, along: self.frame.to_grid(along) });
                marked[i] = true;
            }
        }
        let weight = weights(&laminate, &elements);
        let (mut forces_n, load_n) =
            self.forces(&laminate, &elements, &nodes, &weight, reach, &mut marked)?;
        forces_n.iter_mut().for_each(|f| *f = self.frame.to_grid(*f));
        // Springs stand for the fixtures, and forces on held nodes alone would strain the part by next to nothing: it would
        // seem to carry any load.
        let mut free_n = forces_n.clone();
        for hold in &holds {
            let force = &mut free_n[hold.node as usize];
            *force -= hold.along * hold.along.dot(*force);
        }
        let sum = |forces: &[DVec2]| forces.iter().map(|f| f.length()).sum::<f64>();
        if sum(&free_n) <= LEAST_FREE * sum(&forces_n) {
            return Err(TestError::Unloaded.into());
        }
        let unbreakable = unbreakable(&grid, &elements, &in_grid, &marked);
        let lost = lost / laminate.laid_mm3;
        Ok(Prepared { laminate, elements, holds, forces_n, load_n, unbreakable, lost })
    }

    /// The directions in which a point is held.
    fn directions(&self, wide: &[Selection], p: DVec2) -> impl Iterator<Item = DVec2> + use<> {
        let mut all = [None; 6];
        let mut n = 0;
        let here = self.conditions.fixtures.iter().zip(wide).filter(|(_, w)| w.contains(self.at(p)));
        for (f, _) in here {
            let normal = match &f.on {
                Selection::Plane { normal, .. } => normal.truncate(),
                Selection::Cylinder { point, .. } => p - point.truncate(),
                _ => DVec2::ZERO,
            };
            let own = if f.held == Held::Normal { normal.try_normalize() } else { None };
            for along in own.into_iter().chain(f.held.in_plane()) {
                if n < all.len() && !all.contains(&Some(along)) {
                    all[n] = Some(along);
                    n += 1;
                }
            }
        }
        all.into_iter().flatten()
    }

    fn forces(
        &self,
        laminate: &Laminate,
        elements: &PlateElements,
        nodes: &[DVec2],
        weight: &[f64],
        reach: f64,
        marked: &mut [bool],
    ) -> Result<(Vec<DVec2>, f64), StrengthError> {
        let mut forces = vec![DVec2::ZERO; nodes.len()];
        let mut greatest: f64 = 0.0;
        for load in &self.case().loads {
            let Some(on) = load.action.on() else {
                let Action::Acceleration { mm_s2: a } = load.action else { continue };
                let all: f64 = weight.iter().sum();
                let mass_t = laminate.volume_mm3 * self.conditions.density_t_mm3;
                nodes.iter().enumerate().for_each(|(i, _)| {
                    forces[i] += a.truncate() * (mass_t * weight[i] / f64::max(all, 1e-30));
                });
                continue;
            };
            let wide = on.grown(reach);
            let chosen: Vec<usize> = (0..nodes.len()).filter(|&i| wide.contains(self.at(nodes[i]))).collect();
            let sum: f64 = chosen.iter().map(|&i| weight[i]).sum();
            if sum <= 0.0 {
                return Err(self.catches_nothing(&load.name, on));
            }
            chosen.iter().for_each(|&i| marked[i] = true);
            match load.action {
                Action::Force { total_n: f, .. } => {
                    // The force is distributed by the material at each node, so that every ligament gets its share.
                    greatest = greatest.max(f.truncate().length());
                    chosen.iter().for_each(|&i| forces[i] += f.truncate() * (weight[i] / sum));
                }
                Action::Moment { total_nmm: m, .. } => {
                    let centre = chosen.iter().map(|&i| nodes[i] * weight[i]).sum::<DVec2>() / sum;
                    let turned = |i: usize| DVec2::new(-(nodes[i] - centre).y, (nodes[i] - centre).x);
                    let arm: f64 =
                        chosen.iter().map(|&i| weight[i] * cross(nodes[i] - centre, turned(i))).sum();
                    for &i in &chosen {
                        forces[i] += turned(i) * (weight[i] * m.z / f64::max(arm, 1e-30));
                    }
                }
                Action::Pressure { mpa: p, .. } => {
                    self.press(p, on, elements, nodes, &mut forces);
                }
                // Accelerations are handled above; the other loads were refused when the test was set up.
                Action::Acceleration { .. }
                | Action::Bearing { .. }
                | Action::Torque { .. }
                | Action::RemoteForce { .. }
                | Action::Clamp { .. }
                | Action::Carried { .. }
                | Action::Points { .. }
                | Action::Centrifugal { .. } => {}
            }
        }
        // Without a total force, the load is half the sum of all magnitudes, so that two equal and
        // opposite pressures count once.
        let pulled: f64 = 0.5 * forces.iter().map(|f| f.length()).sum::<f64>();
        let load_n = if greatest > 0.0 { greatest } else { pulled };
        if load_n <= 0.0 {
            return Err(StrengthError::Missing("a load that is not zero"));
        }
        Ok((forces, load_n))
    }

    /// Applies a pressure to the border: the force on each short piece of the border acts on the nearest node.
    fn press(
        &self,
        mpa: f64,
        on: &Selection,
        elements: &PlateElements,
        nodes: &[DVec2],
        forces: &mut [DVec2],
    ) {
        let thickness = self.high.z - self.low.z;
        let step = 0.25 * elements.grid.cell_mm;
        for contour in self.section.contours() {
            for (a, b) in grainpath_core::poly::edges(contour) {
                let length = a.distance(b);
                let n = (length / step).ceil().clamp(1.0, 1e6) as usize;
                let normal = DVec2::new((b - a).y, -(b - a).x) / f64::max(length, 1e-30);
                for k in 0..n {
                    let p = a + (b - a) * ((k as f64 + 0.5) / n as f64);
                    if on.contains(self.at(p)) {
                        let near = |i: &usize, j: &usize| {
                            nodes[*i].distance_squared(p).total_cmp(&nodes[*j].distance_squared(p))
                        };
                        let reach = 2.0 * elements.grid.cell_mm;
                        let close = (0..nodes.len()).filter(|&i| nodes[i].distance(p) < reach);
                        if let Some(i) = close.min_by(near) {
                            forces[i] -= normal * (mpa * thickness * length / n as f64);
                        }
                    }
                }
            }
        }
    }
}

/// A part as cells, with supports and loads.
pub(super) struct Prepared {
    pub laminate: Arc<Laminate>,
    pub elements: PlateElements,
    pub holds: Vec<GridHold>,
    pub forces_n: Vec<DVec2>,
    pub load_n: f64,
    pub unbreakable: Vec<bool>,
    /// Share of the material that is not connected to a fixture.
    pub lost: f64,
}

/// The selection of nodes that a fixture holds. A cylinder whose axis lies in the material is a
/// roller: it holds only the node nearest to its axis, because two held nodes would keep the part
/// from turning there. A cylinder around a hole holds the hole's wall.
fn contact(on: &Selection, elements: &PlateElements, frame: Frame, reach: f64) -> Selection {
    let mut wide = on.grown(reach);
    let Selection::Cylinder { point: axis_at, axis, .. } = on else { return wide };
    let place = |i: usize| frame.to_part(elements.node(i));
    let off = |i: usize| place(i).distance_squared(axis_at.truncate());
    let nearest = (0..elements.places.len()).min_by(|a, b| off(*a).total_cmp(&off(*b)));
    let cell_mm = elements.grid.cell_mm;
    if let Selection::Cylinder { point, radius_mm, .. } = &mut wide
        && let Some(i) = nearest.filter(|i| axis.z.abs() > 0.99 && off(*i) <= cell_mm * cell_mm)
    {
        (*point, *radius_mm) = (place(i).extend(axis_at.z), 1e-3 * cell_mm);
    }
    wide
}

/// Width of the strip that a bead fills in its layer, mm.
fn strip_mm(bead: &Bead, height_mm: f64) -> f64 {
    let length = bead.start().distance(bead.end()).max(1e-9);
    (f64::from(bead.volume_mm3) / (length * bead.height_mm(height_mm).max(1e-3))).min(MAX_BEAD_WIDTH_MM)
}

/// Material at each node: the sum of a quarter of the thickness of every element around it.
fn weights(laminate: &Laminate, elements: &PlateElements) -> Vec<f64> {
    let mut weight = vec![0.0; elements.places.len()];
    for (cell, corners) in elements.cells.iter().zip(&elements.corners) {
        let t = 0.25 * laminate.thickness_mm(*cell as usize);
        corners.iter().for_each(|&i| weight[i as usize] += t);
    }
    weight
}

/// Marks the elements near held or loaded nodes, which cannot fail.
fn unbreakable(grid: &CellGrid, elements: &PlateElements, nodes: &[DVec2], marked: &[bool]) -> Vec<bool> {
    let mut near = vec![false; grid.nx * grid.ny];
    let radius = UNBREAKABLE_MM + grid.cell_mm;
    for (p, _) in nodes.iter().zip(marked).filter(|(_, m)| **m) {
        let cell = |q: f64, n: usize| (q / grid.cell_mm).clamp(0.0, n as f64 - 1.0) as usize;
        let (a, b) = (*p - grid.low - radius, *p - grid.low + radius);
        for j in cell(a.y, grid.ny)..=cell(b.y, grid.ny) {
            for i in cell(a.x, grid.nx)..=cell(b.x, grid.nx) {
                let at = j * grid.nx + i;
                near[at] |= grid.centre(at).distance(*p) <= radius;
            }
        }
    }
    elements.cells.iter().map(|c| near[*c as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three layers of 0.2 mm, each with a level bead and one of a staggered wall beside it.
    #[test]
    fn beads_half_a_layer_higher_lie_in_the_sheets_of_their_height() {
        let bead = |y: f32, raise_mm: [f32; 2]| {
            let height = 0.2 + raise_mm[1] - raise_mm[0];
            Bead {
                a: [0.0, y],
                b: [10.0, y],
                volume_mm3: 10.0 * 0.4 * height,
                speed_mm_s: 50.0,
                role: Role::InnerWall,
                starts: true,
                raise_mm,
            }
        };
        let layer = |k: usize, raise_mm| {
            let beads = vec![bead(0.0, [0.0, 0.0]), bead(0.4, raise_mm)];
            BeadLayer { z_mm: 0.2 * (k + 1) as f64, height_mm: 0.2, beads, ..BeadLayer::default() }
        };
        let layers = [layer(0, [0.0, 0.1]), layer(1, [0.1, 0.1]), layer(2, [0.1, 0.0])];
        let layers: Vec<&BeadLayer> = layers.iter().collect();
        let sheets = sheets_of(&layers, &[0.2; 3], DVec2::ZERO, false, &|_| true);
        assert_eq!(sheets.len(), 6);
        for sheet in &sheets {
            // In each half layer both walls fill their strips.
            let walls = [0.0, 0.4].map(|y| {
                let own = sheet.beads.iter().filter(|b| (b.a.y - y).abs() < 1e-3);
                own.map(|b| b.volume_mm3).sum::<f64>()
            });
            assert!(walls.iter().all(|mm3| (mm3 - 10.0 * 0.4 * 0.1).abs() < 1e-4), "{walls:?}");
        }
        let level = [layer(0, [0.0, 0.0])];
        assert_eq!(sheets_of(&[&level[0]], &[0.2], DVec2::ZERO, false, &|_| true).len(), 1);
    }
}
