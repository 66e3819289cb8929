//! Applies the fixtures and loads of a job to the bricks of a solid strength test.
//!
//! Lengths are in mm, forces in N. Cost: linear in the grid's points.

use std::sync::Arc;

use grainpath_core::selection::Selection;
use grainpath_core::{DVec3, TriMesh};
use grainpath_fea::load_case::{Action, Held};
use grainpath_fea::strength::brick_strength::{SolidHold, SolidTest, connected_cells};
use grainpath_fea::strength::bricks::Bricks;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::grid_turn::Frame;
use grainpath_fea::strength::{Outcome, TestError, UnresolvedBending};
use rayon::prelude::*;

use super::setup::{TestSetup, UNBREAKABLE_MM};
use super::{Limits, StrengthError};

/// Smallest filled share of a cell that is kept. Emptier cells are left out, because they slow the
/// solution without carrying load.
const LEAST_FILLED: f32 = 0.06;

/// Forces at points of the grid, N.
type Forces = Vec<([usize; 3], DVec3)>;

/// A part as bricks, with supports and loads.
pub(super) struct PreparedSolid {
    pub bricks: Arc<Bricks>,
    pub active: Vec<bool>,
    holds: Vec<SolidHold>,
    forces_n: Forces,
    pub load_n: f64,
    unbreakable: Vec<bool>,
    /// Share of the material that is not connected to a fixture.
    pub lost: f64,
}

impl PreparedSolid {
    /// Loads the part until it fails.
    pub(super) fn run(&self, card: &StrengthCard, limits: &Limits) -> Result<Outcome, TestError> {
        self.test(card, limits).run()
    }

    /// How much bending of thin walls the cells of the test cannot represent.
    pub(super) fn unresolved_bending(
        &self,
        card: &StrengthCard,
        limits: &Limits,
    ) -> Result<UnresolvedBending, TestError> {
        self.test(card, limits).unresolved_bending()
    }

    pub(super) fn test<'a>(&'a self, card: &'a StrengthCard, limits: &Limits) -> SolidTest<'a> {
        SolidTest {
            bricks: &self.bricks,
            active: &self.active,
            holds: &self.holds,
            forces_n: &self.forces_n,
            load_n: self.load_n,
            unbreakable: &self.unbreakable,
            card,
            max_mib: limits.max_mib,
            cancel: limits.cancel.clone(),
        }
    }
}

/// The corner points of the bricks, with the amount of material around each point.
struct Points<'a> {
    bricks: &'a Bricks,
    frame: Frame,
    weight: Vec<f32>,
    /// For each point, the number of active cells among the eight around it.
    around: Vec<u8>,
}

impl<'a> Points<'a> {
    fn new(bricks: &'a Bricks, frame: Frame, active: &[bool]) -> Self {
        let [nx, ny, nz] = bricks.n;
        let n = (nx + 1) * (ny + 1) * (nz + 1);
        let mut all = Self { bricks, frame, weight: vec![0.0; n], around: vec![0; n] };
        for cell in (0..active.len()).filter(|c| active[*c]) {
            for k in 0..8 {
                let i = all.index(corner(bricks, cell, k));
                // Each corner gets an eighth of the material, so that body forces add up to the
                // part's weight.
                all.weight[i] += 0.125 * bricks.filled[cell];
                all.around[i] += 1;
            }
        }
        all
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.bricks.n;
        (z * (ny + 1) + y) * (nx + 1) + x
    }

    fn point(&self, i: usize) -> [usize; 3] {
        let (nx, ny) = (self.bricks.n[0] + 1, self.bricks.n[1] + 1);
        [i % nx, i / nx % ny, i / nx / ny]
    }

    /// The position of a point in part coordinates, mm.
    fn place(&self, i: usize) -> DVec3 {
        self.frame.to_part_3d(self.place_in_grid(i))
    }

    fn place_in_grid(&self, i: usize) -> DVec3 {
        let [x, y, z] = self.point(i).map(|v| v as f64);
        self.bricks.origin + self.bricks.cell_mm * DVec3::new(x, y, z)
    }

    /// The points with material that a selection contains. A list of facets selects only points on
    /// the surface.
    fn chosen(&self, on: &Selection) -> Vec<usize> {
        // Facets lie on the surface; without this test, inner points within reach would be held too.
        let listed = matches!(on, Selection::Triangles(_) | Selection::Near { .. });
        (0..self.weight.len())
            .into_par_iter()
            .filter(|&i| {
                self.weight[i] > 0.0 && (!listed || self.around[i] < 8) && on.contains(self.place(i))
            })
            .collect()
    }

    /// The point with material nearest to a position, within two cells.
    fn nearest(&self, p: DVec3) -> Option<usize> {
        let p = self.frame.to_grid_3d(p);
        let q = ((p - self.bricks.origin) / self.bricks.cell_mm).round();
        let n = self.bricks.n;
        // The stair-stepped surface of the bricks deviates from the true surface by up to about one cell.
        let range = |k: usize| {
            let at = q[k] as i64;
            (at - 2).max(0)..=(at + 2).min(n[k] as i64)
        };
        let mut best: Option<(f64, usize)> = None;
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let i = self.index([x as usize, y as usize, z as usize]);
                    let d = self.place_in_grid(i).distance_squared(p);
                    if self.weight[i] > 0.0 && best.is_none_or(|b| d < b.0) {
                        best = Some((d, i));
                    }
                }
            }
        }
        best.map(|b| b.1)
    }
}

fn corner(bricks: &Bricks, cell: usize, k: usize) -> [usize; 3] {
    let [nx, ny, _] = bricks.n;
    [cell % nx + (k & 1), cell / nx % ny + (k >> 1 & 1), cell / nx / ny + (k >> 2)]
}

impl TestSetup {
    /// Prepares the held points and the forces of a test on these bricks.
    ///
    /// # Errors
    /// [`StrengthError`] if a fixture or load selects no material that is connected to a fixture.
    pub(super) fn prepared_solid(&self, bricks: Arc<Bricks>) -> Result<PreparedSolid, StrengthError> {
        let cell_mm = bricks.cell_mm.x;
        let mut active: Vec<bool> = bricks.filled.iter().map(|f| *f > LEAST_FILLED).collect();
        let reach = 0.75 * cell_mm;
        let points = Points::new(&bricks, self.frame, &active);
        let wide: Vec<Selection> =
            self.conditions.fixtures.iter().map(|f| contact(&f.on, &points, cell_mm, reach)).collect();
        let caught: Vec<Vec<usize>> = wide.iter().map(|w| points.chosen(w)).collect();
        for (fixture, caught) in self.conditions.fixtures.iter().zip(&caught) {
            if caught.is_empty() {
                return Err(self.catches_nothing(&fixture.name, &fixture.on));
            }
        }
        // Only material connected to a fixture can carry a load.
        let (piece, n_pieces) = connected_cells(bricks.n, &active);
        let mut is_held = vec![false; points.weight.len()];
        caught.iter().flatten().for_each(|i| is_held[*i] = true);
        let mut stands = vec![false; n_pieces];
        for (cell, p) in piece.iter().enumerate().filter_map(|(c, p)| p.map(|p| (c, p as usize))) {
            stands[p] |= (0..8).any(|k| is_held[points.index(corner(&bricks, cell, k))]);
        }
        let mut lost = 0.0;
        for (cell, p) in piece.iter().enumerate().filter_map(|(c, p)| p.map(|p| (c, p as usize))) {
            if !stands[p] {
                active[cell] = false;
                lost += f64::from(bricks.filled[cell]) * bricks.cell_mm.element_product();
            }
        }
        let lost = lost / bricks.laid_mm3;
        // Loose cells no longer add to their corners, so the material is counted again where there are any.
        let points = if lost > 0.0 { Points::new(&bricks, self.frame, &active) } else { points };
        let mut marked = vec![false; points.weight.len()];
        let mut holds = Vec::new();
        for (fixture, caught) in self.conditions.fixtures.iter().zip(&caught) {
            // A point whose cells were all loose has no stiffness, so it cannot be held.
            for &i in caught.iter().filter(|i| points.weight[**i] > 0.0) {
                marked[i] = true;
                let p = points.place(i);
                let normal = match &fixture.on {
                    Selection::Plane { normal, .. } => *normal,
                    Selection::Cylinder { point, axis, .. } => (p - *point).reject_from_normalized(*axis),
                    _ => DVec3::ZERO,
                };
                match fixture.held {
                    Held::Normal => {
                        let along = normal.try_normalize().map(|d| self.frame.to_grid_3d(d));
                        holds.extend(along.map(|d| (points.point(i), d)));
                    }
                    Held::Axes(fixed) => {
                        let axes = DVec3::AXES.into_iter().zip(fixed).filter(|a| a.1);
                        holds.extend(axes.map(|a| (points.point(i), self.frame.to_grid_3d(a.0))));
                    }
                    Held::Turned { axes, fixed } => {
                        let held = (0..3).filter(|&k| fixed[k]);
                        holds.extend(held.map(|k| (points.point(i), self.frame.to_grid_3d(axes.col(k)))));
                    }
                }
            }
        }
        let (forces_n, load_n) = self.solid_forces(&points, reach, &mut marked)?;
        let unbreakable = unbreakable(&points, &active, &marked);
        Ok(PreparedSolid { active, holds, forces_n, load_n, unbreakable, lost, bricks })
    }

    fn solid_forces(
        &self,
        points: &Points<'_>,
        reach: f64,
        marked: &mut [bool],
    ) -> Result<(Forces, f64), StrengthError> {
        let mut forces = vec![DVec3::ZERO; points.weight.len()];
        let mut greatest: f64 = 0.0;
        let weight = |i: usize| f64::from(points.weight[i]);
        for load in &self.case().loads {
            let Some(on) = load.action.on() else {
                let Action::Acceleration { mm_s2: a } = load.action else { continue };
                let cell_t = points.bricks.cell_mm.element_product() * self.conditions.density_t_mm3;
                (0..forces.len()).for_each(|i| forces[i] += a * (cell_t * weight(i)));
                continue;
            };
            if let Action::Pressure { mpa: p, .. } = load.action {
                if !press(p, on, &self.mesh, points, &mut forces, marked) {
                    return Err(self.catches_nothing(&load.name, on));
                }
                continue;
            }
            let chosen = points.chosen(&on.grown(reach));
            let sum: f64 = chosen.iter().map(|&i| weight(i)).sum();
            if sum <= 0.0 {
                return Err(self.catches_nothing(&load.name, on));
            }
            chosen.iter().for_each(|&i| marked[i] = true);
            match load.action {
                Action::Force { total_n: f, .. } => {
                    greatest = greatest.max(f.length());
                    chosen.iter().for_each(|&i| forces[i] += f * (weight(i) / sum));
                }
                Action::Moment { total_nmm: m, .. } => {
                    let centre = chosen.iter().map(|&i| points.place(i) * weight(i)).sum::<DVec3>() / sum;
                    let Some(axis) = m.try_normalize() else { continue };
                    let turned = |i: usize| axis.cross(points.place(i) - centre);
                    // The forces are proportional to the distance from the axis, and scaled so that their
                    // moments add up to the load.
                    let arm: f64 = chosen.iter().map(|&i| weight(i) * turned(i).length_squared()).sum();
                    for &i in &chosen {
                        forces[i] += turned(i) * (weight(i) * m.length() / f64::max(arm, 1e-30));
                    }
                }
                // Pressures and accelerations are handled above; the other loads were refused when the test was set up.
                Action::Pressure { .. }
                | Action::Acceleration { .. }
                | Action::Bearing { .. }
                | Action::Torque { .. }
                | Action::RemoteForce { .. }
                | Action::Clamp { .. }
                | Action::Carried { .. }
                | Action::Points { .. }
                | Action::Centrifugal { .. } => {}
            }
        }
        // Loads without a total force, such as moments and pressures, count with half the sum of all
        // magnitudes, so that a pair of opposite forces counts once.
        let pulled: f64 = 0.5 * forces.iter().map(|f| f.length()).sum::<f64>();
        let load_n = if greatest > 0.0 { greatest } else { pulled };
        if load_n <= 0.0 {
            return Err(StrengthError::Missing("a load that is not zero"));
        }
        let pushed = (0..forces.len()).filter(|i| forces[*i] != DVec3::ZERO);
        Ok((pushed.map(|i| (points.point(i), self.frame.to_grid_3d(forces[i]))).collect(), load_n))
    }
}

/// The selection of points that a fixture holds. A cylinder whose axis lies in the material is a
/// roller and holds a line of points. A cylinder around a hole holds the hole's wall.
fn contact(on: &Selection, points: &Points<'_>, cell_mm: f64, reach: f64) -> Selection {
    let wide = on.grown(reach);
    let mut line = wide.clone();
    if let Selection::Cylinder { radius_mm, .. } = &mut line {
        *radius_mm = cell_mm;
        // The bottom of a blind hole also lies on the axis, but has too few points for a roller.
        if 20 * points.chosen(&line).len() > points.chosen(&wide).len() {
            return line;
        }
    }
    wide
}

/// Applies a pressure to the surface: the force on each small piece of the surface acts on the nearest
/// point. Returns whether any point was found.
fn press(
    mpa: f64,
    on: &Selection,
    mesh: &TriMesh,
    points: &Points<'_>,
    forces: &mut [DVec3],
    marked: &mut [bool],
) -> bool {
    let step = 0.5 * points.bricks.cell_mm.x;
    let mut any = false;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        let (u, v) = (b - a, c - a);
        let longest = u.length().max(v.length()).max((c - b).length());
        // Pieces of half a cell are small enough to load every point; the upper limit bounds the work for a
        // huge facet.
        let n = (longest / step).ceil().clamp(1.0, 2000.0) as usize;
        let piece = u.cross(v) * (0.5 / (n * n) as f64);
        for i in 0..n {
            for j in 0..n - i {
                // A facet is divided into rows of alternately upright and inverted triangles; the last
                // upright triangle of a row has no inverted partner.
                for (third, is_one) in [(1.0 / 3.0, true), (2.0 / 3.0, i + j + 1 < n)] {
                    let p = a + (u * (i as f64 + third) + v * (j as f64 + third)) / n as f64;
                    let at = if is_one && on.contains(p) { points.nearest(p) } else { None };
                    if let Some(i) = at {
                        forces[i] -= piece * mpa;
                        marked[i] = true;
                        any = true;
                    }
                }
            }
        }
    }
    any
}

/// Marks the cells near held or loaded points, which cannot fail.
fn unbreakable(points: &Points<'_>, active: &[bool], marked: &[bool]) -> Vec<bool> {
    let bricks = points.bricks;
    let [nx, ny, nz] = bricks.n;
    let radius = UNBREAKABLE_MM + bricks.cell_mm.x;
    let mut near = vec![false; active.len()];
    let marked: Vec<DVec3> =
        (0..marked.len()).filter(|i| marked[*i]).map(|i| points.place_in_grid(i)).collect();
    near.par_chunks_mut((nx * ny).max(1)).enumerate().for_each(|(z, near)| {
        for &p in &marked {
            let cell =
                |q: DVec3, k: usize, n: usize| (q[k] / bricks.cell_mm[k]).clamp(0.0, n as f64 - 1.0) as usize;
            let (a, b) = (p - bricks.origin - radius, p - bricks.origin + radius);
            if !(cell(a, 2, nz)..=cell(b, 2, nz)).contains(&z) {
                continue;
            }
            for y in cell(a, 1, ny)..=cell(b, 1, ny) {
                for x in cell(a, 0, nx)..=cell(b, 0, nx) {
                    let (at, in_layer) = ((z * ny + y) * nx + x, y * nx + x);
                    // Most cells are near several points, and one suffices.
                    near[in_layer] =
                        near[in_layer] || (active[at] && bricks.centre(at).distance(p) <= radius);
                }
            }
        }
    });
    near
}
