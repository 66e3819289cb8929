//! Fixtures and loads of a part on the plate that its section makes.
//!
//! Selections are evaluated at the mid-height of the plate. A node of the mesh, or the midpoint of
//! a side of the border, is selected when its point at that height lies in the selection. Loads act
//! on selected sides of the border.

use std::collections::BTreeMap;

use grainpath_core::math::cross;
use grainpath_core::{DVec2, DVec3};

use super::edge_loads::{body_force_n, traction_n};
use super::plane_mesh::PlaneMesh;
use super::plane_problem::Hold;
use crate::load_case::{Action, BoundaryConditions, CatchesNothing, Fixture, Held, Load};
use crate::resultant::Resultant;
use grainpath_core::selection::Selection;

const SEARCHED: &str = "the plate's border";

/// A meshed section between the lowest and the highest point of its part.
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
                // Parts that are held so are solved as solids.
                Held::Turned { .. } => {}
                Held::Axes(fixed) => {
                    for (axis, along) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
                        if fixed[axis] {
                            let displacement_mm = fixture.displacement_mm[axis];
                            holds.extend(chosen.iter().map(|&node| Hold { node, along, displacement_mm }));
                        }
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
                let area = self.mesh.border_length_mm(&sides) * t;
                traction_n(self.mesh, &sides, t, &|_, _| total_n.truncate() / area)
            }
            Action::Pressure { on, mpa } => traction_n(self.mesh, &caught(on)?, t, &|_, n| -*mpa * n),
            Action::Moment { on, total_nmm } => self.moment_n(&caught(on)?, total_nmm.z),
            // Never in the plane, so plates are not asked for these.
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
                (self.mesh.border_length_mm(&sides) * self.thickness_mm(), self.centroid(&sides))
            }
            None => {
                // The centre of parallel forces: about this point they have no moment.
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
            let area_mm2 = self.mesh.border_length_mm(&self.sides(&fixture.on)) * self.thickness_mm();
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

    /// Centroid of straight sides of the border, mm.
    fn centroid(&self, sides: &[[u32; 3]]) -> DVec2 {
        let (sum, length) = sides.iter().fold((DVec2::ZERO, 0.0), |(sum, length), s| {
            let [a, b] = [s[0], s[1]].map(|i| self.mesh.nodes[i as usize]);
            (sum + 0.5 * (a + b) * a.distance(b), length + a.distance(b))
        });
        if length > 0.0 { sum / length } else { DVec2::ZERO }
    }

    /// Forces of a moment about z, N mm: tractions around the centroid of the sides, in proportion
    /// to the distance from it.
    fn moment_n(&self, sides: &[[u32; 3]], moment_nmm: f64) -> Vec<DVec2> {
        let ends = || {
            sides.iter().map(|s| {
                let [a, b] = [s[0], s[1]].map(|i| self.mesh.nodes[i as usize]);
                (0.5 * (a + b), a.distance(b))
            })
        };
        let length: f64 = ends().map(|e| e.1).sum();
        let centroid = ends().map(|(p, l)| p * l).sum::<DVec2>() / length;
        let turned = |p: DVec2| DVec2::new(-(p - centroid).y, (p - centroid).x);
        let unit = traction_n(self.mesh, sides, self.thickness_mm(), &|p, _| turned(p));
        let sum: f64 = unit.iter().zip(&self.mesh.nodes).map(|(f, p)| cross(*p - centroid, *f)).sum();
        // Scaled by the moment that the discrete forces have, so that the total is exact on any
        // mesh.
        unit.into_iter().map(|f| f * (moment_nmm / sum)).collect()
    }

    /// Sides of the border whose midpoint lies in the selection.
    fn sides(&self, on: &Selection) -> Vec<[u32; 3]> {
        let caught = |s: &&[u32; 3]| on.contains(self.at_mid_height(self.mesh.nodes[s[2] as usize]));
        self.mesh.border.iter().filter(caught).copied().collect()
    }

    /// Nodes of selected sides with their outward normals, weighted by the lengths of the sides
    /// that meet there.
    fn normals(&self, on: &Selection) -> Vec<(u32, DVec2)> {
        let mut sums = BTreeMap::new();
        for side in self.sides(on) {
            let along = self.mesh.nodes[side[1] as usize] - self.mesh.nodes[side[0] as usize];
            let normal = DVec2::new(along.y, -along.x);
            for node in side {
                *sums.entry(node).or_insert(DVec2::ZERO) += normal;
            }
        }
        sums.into_iter().map(|(node, n)| (node, n.normalize_or(DVec2::X))).collect()
    }
}
