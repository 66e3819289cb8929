//! Fixtures and loads of a part on the tetrahedra that fill it.
//!
//! A face of the boundary is selected when the point of the part's surface nearest to its middle
//! lies in the selection. A load therefore stays on its side of an edge, although the elements
//! round the edge off.

use std::collections::BTreeMap;

use grainpath_core::{DVec3, TriMesh};

use super::model::constraints::Supports;
use super::model::error::SolidError;
use super::model::nodal_forces;
use super::model::tet_mesh::TetMesh;
use crate::load_case::{Action, BoundaryConditions, CatchesNothing, Held, Load};
use crate::resultant::Resultant;
use grainpath_core::selection::Selection;

const SEARCHED: &str = "the part's surface";

/// Least cosine of the angle between the normals of a boundary face and of the facet of the part
/// below it, for the face to hold the part along its normal. A face with a smaller cosine bevels a
/// sharp edge, and its normal is slanted. Source: derived: 0.94 is 20 degrees, less than half of
/// the 45 degrees by which a face bevels a right-angled edge.
const MIN_COS_TO_FACET: f64 = 0.94;

/// A meshed part under its boundary conditions.
#[derive(Debug, Clone, Copy)]
pub struct LoadedSolid<'a> {
    mesh: &'a TetMesh,
    surface: &'a TriMesh,
    conditions: &'a BoundaryConditions,
}

impl<'a> LoadedSolid<'a> {
    /// Puts the boundary conditions `conditions` on `mesh`, the tetrahedra made from `surface`.
    pub fn new(mesh: &'a TetMesh, surface: &'a TriMesh, conditions: &'a BoundaryConditions) -> Self {
        Self { mesh, surface, conditions }
    }

    /// The fixtures as supports of the nodes.
    ///
    /// # Errors
    /// [`SolidError::CatchesNothing`] for a fixture without a face, [`SolidError::Contradiction`] where two fixtures
    /// prescribe different displacements.
    pub fn supports(&self) -> Result<Supports, SolidError> {
        let mut supports = Supports::new(self.mesh.nodes.len());
        for fixture in &self.conditions.fixtures {
            let faces = self.caught(&fixture.name, &fixture.on)?;
            match fixture.held {
                Held::Normal => {
                    // At a node between several faces, the normals are added with the face areas as
                    // weights, so small faces hardly turn the direction.
                    for (node, normal) in self.normals(&faces) {
                        let normal = normal.normalize_or_zero();
                        let value_mm = fixture.displacement_mm.dot(normal);
                        supports.prescribe(self.mesh, node, normal, value_mm)?;
                    }
                }
                Held::Axes(fixed) => {
                    for node in self.held_nodes(&fixture.on, &faces) {
                        for axis in (0..3).filter(|&a| fixed[a]) {
                            let value_mm = fixture.displacement_mm[axis];
                            supports.prescribe(self.mesh, node, DVec3::AXES[axis], value_mm)?;
                        }
                    }
                }
                Held::Turned { axes, fixed } => {
                    for node in self.held_nodes(&fixture.on, &faces) {
                        for axis in (0..3).filter(|&a| fixed[a]) {
                            let along = axes.col(axis);
                            let value_mm = fixture.displacement_mm.dot(along);
                            supports.prescribe(self.mesh, node, along, value_mm)?;
                        }
                    }
                }
            }
        }
        Ok(supports)
    }

    /// The nodes that a fixture holds, ascending: the nodes of its faces. For single points they are the nodes of the face
    /// nearest to each point, because the support of a single node weakens as the mesh gets finer and stops multigrid from
    /// converging.
    fn held_nodes(&self, on: &Selection, faces: &[usize]) -> Vec<u32> {
        let Selection::Points(points) = on else { return self.mesh.nodes_of(faces) };
        let search = nodal_forces::flat_faces(self.mesh);
        let nearest = |p: DVec3| search.closest_point(p, f64::INFINITY).map(|f| f.triangle as usize);
        let faces: Vec<usize> = points.triangles().iter().filter_map(|t| nearest(t[0])).collect();
        self.mesh.nodes_of(&faces)
    }

    /// The share of a patch's area that lies on the boundary of this mesh; the patch comes from another mesh of the part.
    /// `None` for other selections.
    pub fn covered_share(&self, on: &Selection) -> Option<f64> {
        let Selection::Patch(patch) = on else { return None };
        let mut forces = vec![DVec3::ZERO; self.mesh.nodes.len()];
        let on_patch = |p, normal| patch.at(p, Some(normal)).map(|_| DVec3::ZERO);
        let nothing = (DVec3::ZERO, DVec3::ZERO);
        Some(nodal_forces::add_carried(&mut forces, self.mesh, on_patch, nothing) / patch.area_mm2())
    }

    /// Adds a load to the forces at the nodes, N, `(n_nodes)`.
    ///
    /// # Errors
    /// [`CatchesNothing`] for a load without a face.
    pub fn add_load(&self, forces_n: &mut [DVec3], load: &Load) -> Result<(), CatchesNothing> {
        let caught = |on: &Selection| self.caught(&load.name, on);
        match &load.action {
            Action::Acceleration { mm_s2 } => {
                let density = self.conditions.density_t_mm3;
                nodal_forces::add_body_force(forces_n, self.mesh, |_| density * *mm_s2);
            }
            Action::Centrifugal { point, axis, rad_s } => {
                let density = self.conditions.density_t_mm3;
                nodal_forces::add_body_force(forces_n, self.mesh, |p| {
                    let arm = (p - *point).reject_from_normalized(*axis);
                    density * rad_s * rad_s * arm
                });
            }
            Action::Bearing { on, total_n } => {
                nodal_forces::add_bearing(forces_n, self.mesh, &caught(on)?, *total_n);
            }
            Action::Torque { on, point, axis, total_nmm } => {
                let faces = caught(on)?;
                nodal_forces::add_torque(forces_n, self.mesh, &faces, (*point, *axis), *total_nmm);
            }
            Action::RemoteForce { on, total_n, at_mm } => {
                let faces = caught(on)?;
                let arm = *at_mm - nodal_forces::centroid_mm(self.mesh, &faces);
                nodal_forces::add_force(forces_n, self.mesh, &faces, *total_n);
                nodal_forces::add_moment(forces_n, self.mesh, &faces, arm.cross(*total_n));
            }
            Action::Clamp { on, towards, total_n } => {
                let (faces, other) = (caught(on)?, caught(towards)?);
                let [from, to] = [&faces, &other].map(|f| nodal_forces::centroid_mm(self.mesh, f));
                nodal_forces::add_force(
                    forces_n,
                    self.mesh,
                    &faces,
                    *total_n * (to - from).normalize_or_zero(),
                );
            }
            Action::Carried { on, traction } => {
                let wanted = (traction.force_n, traction.moment_nmm);
                let at = |p, normal| traction.at(p, normal);
                if nodal_forces::add_carried(forces_n, self.mesh, at, wanted) == 0.0 {
                    return Err(self.conditions.catches_nothing(&load.name, on, SEARCHED));
                }
            }
            Action::Points { forces, .. } => nodal_forces::add_points(forces_n, self.mesh, forces),
            Action::Force { on, total_n } => {
                nodal_forces::add_force(forces_n, self.mesh, &caught(on)?, *total_n);
            }
            Action::Pressure { on, mpa } => {
                nodal_forces::add_pressure(forces_n, self.mesh, &caught(on)?, *mpa);
            }
            Action::Moment { on, total_nmm } => {
                nodal_forces::add_moment(forces_n, self.mesh, &caught(on)?, *total_nmm);
            }
        }
        Ok(())
    }

    /// Force, moment, area and centroid of a load.
    ///
    /// # Errors
    /// [`CatchesNothing`] for a load without a face.
    pub fn resultant(&self, load: &Load) -> Result<Resultant, CatchesNothing> {
        let mut forces_n = vec![DVec3::ZERO; self.mesh.nodes.len()];
        self.add_load(&mut forces_n, load)?;
        let (area_mm2, centroid) = match load.action.on() {
            Some(on) => {
                let faces = self.caught(&load.name, on)?;
                (nodal_forces::area_mm2(self.mesh, &faces), nodal_forces::centroid_mm(self.mesh, &faces))
            }
            None => (0.0, parallel_centre(&self.mesh.nodes, &forces_n)),
        };
        Ok(Resultant::new(&load.name, area_mm2, centroid, pairs(&self.mesh.nodes, &forces_n)))
    }

    /// The reaction of each fixture, from the reactions at the nodes, N, `(n_nodes)`. A node that
    /// several fixtures hold counts for the first of them.
    ///
    /// # Errors
    /// [`CatchesNothing`] for a fixture without a face.
    pub fn reactions(&self, reactions_n: &[DVec3]) -> Result<Vec<Resultant>, CatchesNothing> {
        // Each node's reaction is taken out of `rest` once it has been counted, so that it is counted once.
        let mut rest = reactions_n.to_vec();
        let mut all = Vec::with_capacity(self.conditions.fixtures.len());
        for fixture in &self.conditions.fixtures {
            let faces = self.caught(&fixture.name, &fixture.on)?;
            let area_mm2 = nodal_forces::area_mm2(self.mesh, &faces);
            let centroid = nodal_forces::centroid_mm(self.mesh, &faces);
            let nodes = self.held_nodes(&fixture.on, &faces);
            let own =
                nodes.iter().map(|&i| (self.mesh.nodes[i as usize], std::mem::take(&mut rest[i as usize])));
            all.push(Resultant::new(&fixture.name, area_mm2, centroid, own));
        }
        Ok(all)
    }

    /// The nodes of the boundary faces in a selection, ascending.
    pub fn nodes_on(&self, on: &Selection) -> Vec<u32> {
        self.held_nodes(on, &self.faces_in(on))
    }

    /// The boundary faces in a selection. For a patch, the point of the part's surface below a face must lie on the patch,
    /// and the normal there must fit.
    fn faces_in(&self, on: &Selection) -> Vec<usize> {
        let mut faces = self.mesh.faces_in(on);
        if matches!(on, Selection::Patch(_)) {
            faces.retain(|&f| {
                let face = &self.mesh.faces[f];
                face.foot.is_none_or(|foot| on.contains_on(foot, self.facet_normal(face.facet)))
            });
        }
        faces
    }

    /// The outward normal of a facet of the part's surface.
    fn facet_normal(&self, facet: u32) -> DVec3 {
        self.surface.normal(self.surface.triangles[facet as usize])
    }

    /// The boundary faces in a selection; an error where there are none, except for single points.
    fn caught(&self, name: &str, on: &Selection) -> Result<Vec<usize>, CatchesNothing> {
        let faces = self.faces_in(on);
        match faces.is_empty() && !matches!(on, Selection::Points(_)) {
            true => Err(self.conditions.catches_nothing(name, on, SEARCHED)),
            false => Ok(faces),
        }
    }

    /// Nodes of the faces that lie along the part's surface, each with the sum of the face normals
    /// around it (not of unit length).
    fn normals(&self, faces: &[usize]) -> BTreeMap<u32, DVec3> {
        let mut normals = BTreeMap::new();
        for &f in faces {
            let face = &self.mesh.faces[f];
            let [a, b, c] = [0, 1, 2].map(|i| self.mesh.nodes[face.nodes[i] as usize]);
            let normal = (b - a).cross(c - a);
            let facet = self.facet_normal(face.facet);
            if normal.normalize_or_zero().dot(facet).abs() < MIN_COS_TO_FACET {
                continue;
            }
            face.nodes.iter().for_each(|n| *normals.entry(*n).or_insert(DVec3::ZERO) += normal);
        }
        normals
    }
}

/// Each node's position with the force on it.
fn pairs<'a>(nodes: &'a [DVec3], forces: &'a [DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
    nodes.iter().copied().zip(forces.iter().copied())
}

/// The point about which parallel forces have no moment; the origin where the forces cancel.
fn parallel_centre(nodes: &[DVec3], forces: &[DVec3]) -> DVec3 {
    let along = forces.iter().sum::<DVec3>().normalize_or_zero();
    let (sum, size) = pairs(nodes, forces)
        .fold((DVec3::ZERO, 0.0), |(sum, size), (p, f)| (sum + p * f.dot(along), size + f.dot(along)));
    if size > 0.0 { sum / size } else { DVec3::ZERO }
}
