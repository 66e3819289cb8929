//! Fixtures and loads of a part, applied to the plate with the part's section.
//!
//! Selections are evaluated at the mid-height of the plate. A node of the mesh is selected when its point at
//! that height lies in the selection. Loads act on the sides of the border whose midpoint is selected; a side
//! that a box, a cylinder or a sphere cuts carries them up to the cut, so that the loaded length does not
//! depend on the mesh. (Half an element more at one edge would move a pull 0.05 mm off the axis of a bar of
//! 10 mm width, and the bar would bend visibly.) The cut is found by halving, 40 times, between quarter
//! points of the side.
//!
//! A force is spread evenly over the selected sides. A moment is spread as tractions around the centroid of
//! the sides, in proportion to the distance from it, and scaled to its exact value. A pressure acts against
//! the outward normal, an acceleration on the whole plate by its density. A fixture along the normal holds
//! nodes of the border alone, because nodes inside have no normal.
//!
//! Lengths are in mm, forces in N, moments in N mm, pressures in MPa; forces are one vector a node. Cost:
//! linear in nodes and sides of the border for each load and fixture. Limits: a selection that catches no
//! node or side is an error that names the load or fixture. Loads that do not act in the plane (bearing,
//! torque, clamp and the like) give no forces here, and fixtures on turned axes no holds; parts with them are
//! solved as solids. A loaded stretch shorter than a quarter of a side may be missed, and one below a
//! hundredth of a side is left out.

use std::collections::BTreeMap;

use grainpath_core::math::cross;
use grainpath_core::{DVec2, DVec3};

use super::edge_loads::{LoadedSide, body_force_n, traction_n};
use super::plane_mesh::PlaneMesh;
use super::plane_problem::Hold;
use crate::load_case::{Action, BoundaryConditions, CatchesNothing, Fixture, Held, Load};
use crate::resultant::Resultant;
use grainpath_core::selection::Selection;

const SEARCHED: &str = "the plate's border";
/// A load on less than this share of a side is left out. Source: derived. On a side of 0.1 mm, the tolerance of
/// selections (1 um) reaches this share around a corner, and less on longer sides.
const LEAST_SHARE: f64 = 0.01;

/// A meshed section of a part, with the height of the part's lowest and highest point.
#[derive(Debug, Clone, Copy)]
pub struct Plate<'a> {
    mesh: &'a PlaneMesh,
    conditions: &'a BoundaryConditions,
}

impl<'a> Plate<'a> {
    /// The plate of a part's section.
    pub fn new(mesh: &'a PlaneMesh, conditions: &'a BoundaryConditions) -> Self {
        Self { mesh, conditions }
    }

    /// Height of the part, mm.
    pub fn thickness_mm(&self) -> f64 {
        self.conditions.high.z - self.conditions.low.z
    }

    /// A point of the section at mid-height of the part, mm.
    pub fn at_mid_height(&self, p: DVec2) -> DVec3 {
        p.extend(0.5 * (self.conditions.low.z + self.conditions.high.z))
    }

    /// The directions in which nodes are held.
    ///
    /// # Errors
    /// [`CatchesNothing`] for a fixture without a node, or without a side of the border where it holds along the normal.
    pub fn holds(&self) -> Result<Vec<Hold>, CatchesNothing> {
        let mut holds = Vec::new();
        for fixture in &self.conditions.fixtures {
            let catches_nothing = || self.conditions.catches_nothing(&fixture.name, &fixture.on, SEARCHED);
            let chosen: Vec<u32> = (0..self.mesh.nodes.len() as u32)
                .filter(|&i| fixture.on.contains(self.at_mid_height(self.mesh.nodes[i as usize])))
                .collect();
            if chosen.is_empty() {
                return Err(catches_nothing());
            }
            match fixture.held {
                Held::Normal => {
                    // Along the normal only the border can hold: nodes inside the plate have no
                    // normal.
                    let normals = self.normals(&fixture.on);
                    if normals.is_empty() {
                        return Err(catches_nothing());
                    }
                    holds.extend(normals.into_iter().map(|(node, along)| {
                        let displacement_mm = fixture.displacement_mm.truncate().dot(along);
                        Hold { node, along, displacement_mm }
                    }));
                }
                held @ (Held::Axes(_) | Held::Turned { .. }) => {
                    for along in held.in_plane() {
                        let displacement_mm = fixture.displacement_mm.truncate().dot(along);
                        holds.extend(chosen.iter().map(|&node| Hold { node, along, displacement_mm }));
                    }
                }
            }
        }
        Ok(holds)
    }

    /// Forces at the nodes of a load, N, `(n_nodes)`.
    ///
    /// # Errors
    /// [`CatchesNothing`] for a load without a side of the border.
    pub fn forces_n(&self, load: &Load) -> Result<Vec<DVec2>, CatchesNothing> {
        let t = self.thickness_mm();
        let caught = |on: &Selection| {
            let sides = self.sides(on);
            match sides.is_empty() {
                true => Err(self.conditions.catches_nothing(&load.name, on, SEARCHED)),
                false => Ok(sides),
            }
        };
        Ok(match &load.action {
            Action::Acceleration { mm_s2 } => {
                body_force_n(self.mesh, t, self.conditions.density_t_mm3 * mm_s2.truncate())
            }
            Action::Force { on, total_n } => {
                let sides = caught(on)?;
                let area = self.length_mm(&sides) * t;
                traction_n(self.mesh, &sides, t, &|_, _| total_n.truncate() / area)
            }
            Action::Pressure { on, mpa } => traction_n(self.mesh, &caught(on)?, t, &|_, n| -*mpa * n),
            Action::Moment { on, total_nmm } => self.moment_n(&caught(on)?, total_nmm.z),
            // Loads of these kinds never act in the plane, so this function is not called for them.
            Action::Bearing { .. }
            | Action::Torque { .. }
            | Action::RemoteForce { .. }
            | Action::Clamp { .. }
            | Action::Carried { .. }
            | Action::Points { .. }
            | Action::Centrifugal { .. } => vec![DVec2::ZERO; self.mesh.nodes.len()],
        })
    }

    /// Force, moment, area and centroid of a load.
    ///
    /// # Errors
    /// [`CatchesNothing`] for a load without a side of the border.
    pub fn resultant(&self, load: &Load) -> Result<Resultant, CatchesNothing> {
        let forces_n = self.forces_n(load)?;
        let (area_mm2, centroid) = match load.action.on() {
            Some(on) => {
                let sides = self.sides(on);
                (self.length_mm(&sides) * self.thickness_mm(), self.centroid(&sides))
            }
            None => {
                // The centre of the parallel forces, about which their moment is zero.
                let along = forces_n.iter().sum::<DVec2>().normalize_or_zero();
                let total: f64 = forces_n.iter().map(|f| f.dot(along)).sum();
                let sum: DVec2 = self.mesh.nodes.iter().zip(&forces_n).map(|(p, f)| *p * f.dot(along)).sum();
                (0.0, if total > 0.0 { sum / total } else { DVec2::ZERO })
            }
        };
        let forces = self.mesh.nodes.iter().zip(&forces_n);
        let forces = forces.map(|(p, f)| (self.at_mid_height(*p), f.extend(0.0)));
        Ok(Resultant::new(&load.name, area_mm2, self.at_mid_height(centroid), forces))
    }

    /// The reaction of each fixture, from the reactions at the nodes, N, `(n_nodes)`. A node that
    /// several fixtures hold counts for the first of them. Moments are about the mean of the
    /// fixture's nodes.
    pub fn reactions(&self, reactions_n: &[DVec2]) -> Vec<Resultant> {
        let mut rest = reactions_n.to_vec();
        let of_fixture = |fixture: &Fixture| {
            let place = |i: usize| self.at_mid_height(self.mesh.nodes[i]);
            let own: Vec<usize> =
                (0..self.mesh.nodes.len()).filter(|&i| fixture.on.contains(place(i))).collect();
            let mean = own.iter().map(|&i| place(i)).sum::<DVec3>() / own.len().max(1) as f64;
            let area_mm2 = self.length_mm(&self.sides(&fixture.on)) * self.thickness_mm();
            let forces = own.iter().map(|&i| (place(i), std::mem::take(&mut rest[i]).extend(0.0)));
            Resultant::new(&fixture.name, area_mm2, mean, forces)
        };
        self.conditions.fixtures.iter().map(of_fixture).collect()
    }

    /// The nodes in a selection, ascending.
    pub fn nodes_on(&self, on: &Selection) -> Vec<u32> {
        let is_on = |i: &u32| on.contains(self.at_mid_height(self.mesh.nodes[*i as usize]));
        (0..self.mesh.nodes.len() as u32).filter(is_on).collect()
    }

    /// Both ends of the loaded stretch of a side, mm.
    fn ends(&self, side: &LoadedSide) -> [DVec2; 2] {
        let [a, b] = [side.nodes[0], side.nodes[1]].map(|i| self.mesh.nodes[i as usize]);
        [a.lerp(b, side.from), a.lerp(b, side.to)]
    }

    /// Length of sides of the border, mm.
    fn length_mm(&self, sides: &[LoadedSide]) -> f64 {
        sides.iter().map(|s| self.ends(s)).map(|[a, b]| a.distance(b)).sum()
    }

    /// Centroid of straight sides of the border, mm.
    fn centroid(&self, sides: &[LoadedSide]) -> DVec2 {
        let (sum, length) = sides.iter().fold((DVec2::ZERO, 0.0), |(sum, length), s| {
            let [a, b] = self.ends(s);
            (sum + 0.5 * (a + b) * a.distance(b), length + a.distance(b))
        });
        if length > 0.0 { sum / length } else { DVec2::ZERO }
    }

    /// Forces of a moment about z, N mm: tractions around the centroid of the sides, in proportion
    /// to the distance from it.
    fn moment_n(&self, sides: &[LoadedSide], moment_nmm: f64) -> Vec<DVec2> {
        let centroid = self.centroid(sides);
        let turned = |p: DVec2| DVec2::new(-(p - centroid).y, (p - centroid).x);
        let unit = traction_n(self.mesh, sides, self.thickness_mm(), &|p, _| turned(p));
        let sum: f64 = unit.iter().zip(&self.mesh.nodes).map(|(f, p)| cross(*p - centroid, *f)).sum();
        // Forces are scaled by the ratio to the moment that they have on the mesh, so that the
        // total is exact on any mesh.
        unit.into_iter().map(|f| f * (moment_nmm / sum)).collect()
    }

    /// The sides of the border, or the parts of them, that lie in a selection.
    fn sides(&self, on: &Selection) -> Vec<LoadedSide> {
        // Planes, triangles and patches select whole faces; at the ends they only touch the
        // neighbouring sides, which are not cut.
        let cuts = matches!(
            on,
            Selection::Box { .. }
                | Selection::TurnedBox { .. }
                | Selection::Cylinder { .. }
                | Selection::Sphere { .. }
        );
        self.mesh.border.iter().filter_map(|&nodes| self.loaded(nodes, on, cuts)).collect()
    }

    /// The stretch of a side that lies in a selection; without `cuts` it is the whole side.
    fn loaded(&self, nodes: [u32; 3], on: &Selection, cuts: bool) -> Option<LoadedSide> {
        let [a, b, m] = nodes.map(|i| self.mesh.nodes[i as usize]);
        let holds = |p: DVec2| on.contains(self.at_mid_height(p));
        if !cuts {
            return holds(m).then(|| nodes.into());
        }
        let at = |s: f64| (1.0 - s) * (1.0 - 2.0 * s) * a + s * (2.0 * s - 1.0) * b + 4.0 * s * (1.0 - s) * m;
        // Selections are convex, so a side lies in one over a single stretch. A stretch shorter than a quarter of the
        // side is missed if it lies between these points.
        let shares = [0.0, 0.25, 0.5, 0.75, 1.0];
        let inside = shares.map(|s| holds(at(s)));
        let first = inside.iter().position(|i| *i)?;
        let last = inside.iter().rposition(|i| *i)?;
        // Halving a quarter of a side of 1 mm forty times leaves less than a picometre.
        let border = |mut within: f64, mut beyond: f64| {
            for _ in 0..40 {
                let middle = 0.5 * (within + beyond);
                if holds(at(middle)) { within = middle } else { beyond = middle }
            }
            within
        };
        let from = if first == 0 { 0.0 } else { border(shares[first], shares[first - 1]) };
        let to = if last == 4 { 1.0 } else { border(shares[last], shares[last + 1]) };
        // A side that only touches the selection carries nothing.
        (to - from > LEAST_SHARE).then_some(LoadedSide { nodes, from, to })
    }

    /// Nodes of selected sides with their outward normals, weighted by the lengths of the sides
    /// that meet there.
    fn normals(&self, on: &Selection) -> Vec<(u32, DVec2)> {
        let mut sums = BTreeMap::new();
        for side in self.sides(on) {
            let [a, b] = self.ends(&side);
            let normal = DVec2::new((b - a).y, -(b - a).x);
            for node in side.nodes {
                *sums.entry(node).or_insert(DVec2::ZERO) += normal;
            }
        }
        sums.into_iter().map(|(node, n)| (node, n.normalize_or(DVec2::X))).collect()
    }
}
