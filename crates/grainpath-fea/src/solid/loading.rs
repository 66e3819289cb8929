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
use crate::load_case::{Action, BoundaryConditions, Held, Load};
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
    /// [`SolidError::CatchesNothing`] or [`SolidError::PlaceTooSmall`] for a load without a face, [`SolidError::NoBearing`] for a
    /// bearing load along or away from its wall.
    pub fn add_load(&self, forces_n: &mut [DVec3], load: &Load) -> Result<(), SolidError> {
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
                let faces = caught(on)?;
                let normals = faces.iter().map(|&f| self.area_and_facet_normal(f));
                if !nodal_forces::faces_force(normals, *total_n) {
                    return Err(SolidError::NoBearing { name: load.name.clone() });
                }
                nodal_forces::add_bearing(forces_n, self.mesh, &faces, *total_n);
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
                    return Err(self.conditions.catches_nothing(&load.name, on, SEARCHED).into());
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
    /// As [`Self::add_load`].
    pub fn resultant(&self, load: &Load) -> Result<Resultant, SolidError> {
        let mut forces_n = vec![DVec3::ZERO; self.mesh.nodes.len()];
        self.add_load(&mut forces_n, load)?;
        let (area_mm2, centroid) = match (&load.action, load.action.on()) {
            // The points catch no faces; the load lies where they do.
            (Action::Points { forces, .. }, _) => (0.0, centre_of_forces(forces.iter().copied())),
            (_, Some(on)) => {
                let faces = self.caught(&load.name, on)?;
                (nodal_forces::area_mm2(self.mesh, &faces), nodal_forces::centroid_mm(self.mesh, &faces))
            }
            (_, None) => (0.0, centre_of_forces(pairs(&self.mesh.nodes, &forces_n))),
        };
        Ok(Resultant::new(&load.name, area_mm2, centroid, pairs(&self.mesh.nodes, &forces_n)))
    }

    /// The reaction of each fixture, from the reactions at the nodes, N, `(n_nodes)`. A node that
    /// several fixtures hold counts for the first of them.
    ///
    /// # Errors
    /// [`SolidError::CatchesNothing`] or [`SolidError::PlaceTooSmall`] for a fixture without a face.
    pub fn reactions(&self, reactions_n: &[DVec3]) -> Result<Vec<Resultant>, SolidError> {
        // Each node's reaction is taken out of `rest` once it has been counted, so that it is counted once.
        let mut rest = reactions_n.to_vec();
        let mut all = Vec::with_capacity(self.conditions.fixtures.len());
        for fixture in &self.conditions.fixtures {
            let faces = self.caught(&fixture.name, &fixture.on)?;
            let area_mm2 = nodal_forces::area_mm2(self.mesh, &faces);
            let nodes = self.held_nodes(&fixture.on, &faces);
            let centroid = match &fixture.on {
                Selection::Points(points) => mean(points.triangles().iter().map(|t| t[0])),
                _ => nodal_forces::centroid_mm(self.mesh, &faces),
            };
            let own =
                nodes.iter().map(|&i| (self.mesh.nodes[i as usize], std::mem::take(&mut rest[i as usize])));
            all.push(Resultant::new(&fixture.name, area_mm2, centroid, own));
        }
        Ok(all)
    }

    /// For a pressure, the area that it catches and the area of the part's surface in its place, mm2, if they differ by more
    /// than `share` of the latter: its force is off by as much. `None` for other loads, whose resultants are given, and for places
    /// whose area on the surface has no closed form: cylinders, spheres and patches.
    ///
    /// # Errors
    /// As [`Self::add_load`].
    pub fn badly_caught(&self, load: &Load, share: f64) -> Result<Option<(f64, f64)>, SolidError> {
        let Action::Pressure { on, .. } = &load.action else { return Ok(None) };
        let caught_mm2 = nodal_forces::area_mm2(self.mesh, &self.caught(&load.name, on)?);
        // Elements are caught whole, so their area differs from that of the place by up to half an element along its border.
        let place_mm2 = on.area_on(self.surface).filter(|a| (caught_mm2 - a).abs() > share * a);
        Ok(place_mm2.map(|a| (caught_mm2, a)))
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

    /// Area of a boundary face, mm2, and the outward normal of the facet of the part below it.
    fn area_and_facet_normal(&self, face: usize) -> (f64, DVec3) {
        (nodal_forces::area_mm2(self.mesh, &[face]), self.facet_normal(self.mesh.faces[face].facet))
    }

    /// The boundary faces in a selection; an error where there are none, except for single points.
    fn caught(&self, name: &str, on: &Selection) -> Result<Vec<usize>, SolidError> {
        let faces = self.faces_in(on);
        if !faces.is_empty() || matches!(on, Selection::Points(_)) {
            return Ok(faces);
        }
        // What lies on the part but catches no element is smaller than the elements, which is another mistake than a place
        // beside the part.
        Err(match on.touches(self.surface) {
            true => SolidError::PlaceTooSmall {
                name: name.to_owned(),
                shape: on.name(),
                element_mm: self.mesh.mean_cell_mm(),
            },
            false => self.conditions.catches_nothing(name, on, SEARCHED).into(),
        })
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
fn pairs<'a>(nodes: &'a [DVec3], forces: &'a [DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + Clone + 'a {
    nodes.iter().copied().zip(forces.iter().copied())
}

/// The mean of points; the origin for none.
fn mean(points: impl ExactSizeIterator<Item = DVec3>) -> DVec3 {
    let n = points.len().max(1) as f64;
    points.sum::<DVec3>() / n
}

/// The point about which parallel forces have no moment; for other forces, the mean of their places, weighted by their sizes.
/// There a resultant that nearly cancels would set the first point anywhere. The origin without forces.
fn centre_of_forces(forces: impl Iterator<Item = (DVec3, DVec3)> + Clone) -> DVec3 {
    /// Forces are parallel if their components across the resultant are at most this share of them. Source: derived: rounding
    /// errors are 1e-15 of a force, and forces of a turning part lie across each other.
    const PARALLEL: f64 = 1e-9;
    // The centre of parallel forces is where their resultant acts. Others, as of a spinning part, may cancel, and their
    // resultant then acts nowhere.
    let along = forces.clone().map(|f| f.1).sum::<DVec3>().normalize_or_zero();
    let amount = |(_, f): (DVec3, DVec3)| f.length();
    let across: f64 = forces.clone().map(|(_, f)| (f - along * f.dot(along)).length()).sum();
    let is_parallel = across <= PARALLEL * forces.clone().map(amount).sum::<f64>();
    let weight = |pair: (DVec3, DVec3)| if is_parallel { pair.1.dot(along) } else { amount(pair) };
    let (sum, size) = forces
        .fold((DVec3::ZERO, 0.0), |(sum, size), pair| (sum + pair.0 * weight(pair), size + weight(pair)));
    if size > 0.0 { sum / size } else { DVec3::ZERO }
}
