//! Solves loads in the plane of the layers: the section of the part is a plate in plane stress.
//!
//! Method: all layers must share one section; the middle layer stands for them. The section is simplified to
//! 0.02 mm, since outlines from slicing have many short edges, and cut into quadratic triangles. One sparse
//! Cholesky factor serves all load cases. Stresses are recovered at the nodes by patch recovery
//! (`zienkiewicz1992`), which also gives the estimate of the mesh's error (`zienkiewicz1987`).
//!
//! Lengths are in mm, forces in N, stresses in MPa; the stiffness is that of the material with its beads
//! along one axis. Stress depends on x and y alone. Without a given size an element's side is the root of a
//! 4000th of the area, about ten thousand triangles for a simple section; the shortest side of a border is a
//! twentieth of that. Cost for n nodes: n^1.5 operations for the factor, refused above the memory limit.
//!
//! Limits: sections that differ by more than 0.2 % of their area, a load with a component out of the plane,
//! a fixture from a finite-element deck, and a fixture or load on a part of the height are errors that name the
//! reason ([`NotPlate`]); such parts are solved and tested as solids.
//! A fixture or load that selects nothing, and a piece that can move freely, are errors too.

use std::sync::Arc;

use grainpath_core::math::{rotated, turned_back};
use grainpath_core::{DVec2, DVec3, LayerStack, Region, TriMesh};
use grainpath_fea::load_case::{BoundaryConditions, LoadCase, PartOfHeight};
use grainpath_fea::plane::{PlaneProblem, PlaneStress, PlaneSystem, Plate, mesh_region};
use grainpath_fea::resultant::CaseBalance;
use grainpath_io::fe::{Element, ElementKind};

use super::{
    CaseStress, GuideError, GuidedPart, InPlaneStress, ResultMesh, Solved, StressSettings, StressSummary,
    degenerate_points,
};
use crate::shape::sections_at;

/// Two sections count as equal if they differ by at most this share of their area.
const SAME_SECTION: f64 = 2e-3;
/// Tolerance to which the section is simplified before meshing, mm.
const SIMPLIFY_MM: f64 = 0.02;

impl InPlaneStress for Arc<PlaneStress> {
    fn at(&self, p: DVec3) -> grainpath_fea::principal::PlaneTensor {
        PlaneStress::at(self, p.truncate())
    }
}

/// The section that all layers share, if they do.
pub(super) fn constant_section(stack: &LayerStack) -> Option<&Region> {
    // The middle layer is the reference, because first and last layers are most often special.
    let layers = stack.layers();
    let middle = layers.get(layers.len() / 2)?.region();
    let area = middle.area_mm2();
    let mut last: Option<&Region> = None;
    for layer in layers {
        let region = layer.region();
        // Neighbouring sections are mostly identical, and comparing is much cheaper than a boolean operation.
        if region == middle || last == Some(region) {
            continue;
        }
        let off = region.difference(middle).area_mm2() + middle.difference(region).area_mm2();
        if off > SAME_SECTION * area {
            return None;
        }
        last = Some(region);
    }
    Some(middle)
}

/// Why a part is no plate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum NotPlate {
    #[error("the section is not the same at all heights")]
    Section,
    #[error("a load has a component out of the layers' plane")]
    Load,
    #[error("a fixture comes from a deck")]
    Deck,
    #[error(transparent)]
    PartOfHeight(#[from] PartOfHeight),
}

/// Whether fixtures and loads leave a plate of this section flat. A place that catches nothing is accepted: the solver of the
/// plate refuses it and says where the part lies.
pub(crate) fn check_flat(section: &Region, conditions: &BoundaryConditions) -> Result<(), NotPlate> {
    match check_flat_everywhere(section, conditions) {
        Err(NotPlate::PartOfHeight(place)) if place.share == 0.0 => Ok(()),
        other => other,
    }
}

fn check_flat_everywhere(section: &Region, conditions: &BoundaryConditions) -> Result<(), NotPlate> {
    if !conditions.cases.iter().all(LoadCase::is_in_plane) {
        return Err(NotPlate::Load);
    }
    if conditions.are_held_in_space() {
        return Err(NotPlate::Deck);
    }
    conditions.part_of_height(section).map_or(Ok(()), |place| Err(place.into()))
}

/// Whether a part is a plate wherever the job leaves the choice: in the guide, the strength test and the reserve.
pub(crate) fn is_plate(stack: &LayerStack, conditions: &BoundaryConditions) -> bool {
    constant_section(stack).is_some_and(|section| check_flat_everywhere(section, conditions).is_ok())
}

pub(super) fn solve(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
) -> Result<Solved, GuideError> {
    let section = constant_section(part.stack).ok_or(NotPlate::Section)?;
    check_flat(section, conditions)?;
    let rows = part.standing.plan_axis();
    // Sections from slicing have many short edges, and each would force small triangles.
    let section = turned_back_section(part, section, rows).simplified(SIMPLIFY_MM);
    let longest = settings.element_mm.unwrap_or_else(|| default_element_mm(&section));
    let mut mesh = mesh_region(&section, longest, 0.05 * longest)?;
    // Fixtures and loads lie on the plate as the part does.
    mesh.nodes.iter_mut().for_each(|p| *p = rotated(*p, rows));
    let plate = Plate::new(&mesh, conditions);
    let holds = plate.holds()?;
    let c = settings.material.plane_stress(settings.bead_axis_rad)?;
    let stiffness = move |_: DVec2| c;
    let problem = PlaneProblem {
        mesh: &mesh,
        thickness_mm: plate.thickness_mm(),
        stiffness: &stiffness,
        holds: &holds,
        max_mib: settings.max_mib,
    };
    let system = PlaneSystem::new(&problem)?;
    let mut summary = StressSummary {
        solver: "sparse Cholesky, quadratic triangles, plane stress".into(),
        elements: mesh.elements.len(),
        ..StressSummary::default()
    };
    let (mut stresses, mut results) = (Vec::new(), Vec::new());
    let triangle = |e: &[u32; 6]| Element::new(ElementKind::Tri6, e);
    let elements: Vec<Element> = mesh.elements.iter().filter_map(triangle).collect();
    for case in &conditions.cases {
        let mut forces = vec![DVec2::ZERO; mesh.nodes.len()];
        for load in &case.loads {
            forces.iter_mut().zip(plate.forces_n(load)?).for_each(|(sum, f)| *sum += f);
        }
        // One factorization serves all cases.
        let solution = system.solve(&forces);
        let stress = Arc::new(system.stress(&solution));
        summary.balance.push(CaseBalance {
            case: case.name.clone(),
            loads: case.loads.iter().map(|load| plate.resultant(load)).collect::<Result<_, _>>()?,
            reactions: plate.reactions(&system.reactions_n(&solution, &forces)),
        });
        let moved = solution.displacement_mm.iter().map(|u| u.length()).fold(0.0, f64::max);
        summary.dofs = solution.dofs;
        summary.residual = summary.residual.max(solution.residual);
        summary.max_displacement_mm = summary.max_displacement_mm.max(moved);
        summary.max_von_mises_mpa = summary.max_von_mises_mpa.max(stress.max_von_mises_mpa());
        summary.error_estimate = summary.error_estimate.max(stress.error_estimate());
        if results.is_empty() {
            summary.degenerate = Some(degenerate_points(&stress));
        }
        results.push(ResultMesh {
            name: case.name.clone(),
            nodes: mesh.nodes.iter().map(|p| plate.at_mid_height(*p)).collect(),
            elements: elements.clone(),
            stress: stress.nodal_mpa().iter().map(|[xx, yy, xy]| [*xx, *yy, 0.0, *xy, 0.0, 0.0]).collect(),
            displacement: Some(solution.displacement_mm.iter().map(|u| u.extend(0.0)).collect()),
            sets: conditions
                .named_places(case)
                .map(|(name, on)| (name.to_owned(), plate.nodes_on(on)))
                .collect(),
        });
        stresses.push(CaseStress { name: case.name.clone(), weight: case.weight, stress: Arc::new(stress) });
    }
    Ok(Solved { cases: stresses, results, summary, constant: true })
}

/// The section of a plate, turned back until `rows` lie along X: a part that is turned on the plate gets the triangles of one
/// that is not. It is cut from the turned mesh, because the corners of a section are rounded, and triangles follow from the
/// last digits of corners. Layers that are no cuts of the mesh are turned themselves.
fn turned_back_section(part: &GuidedPart<'_>, section: &Region, rows: DVec2) -> Region {
    if rows == DVec2::X {
        return section.clone();
    }
    let turned = section.turned(DVec2::new(rows.x, -rows.y));
    let layers = part.stack.layers();
    let Some(middle) = layers.get(layers.len() / 2) else { return turned };
    let vertices = part.mesh.vertices.iter().map(|p| turned_back(p.truncate(), rows).extend(p.z)).collect();
    let mesh = TriMesh { vertices, triangles: part.mesh.triangles.clone() };
    // The section of a layer is that of the middle of its height.
    let z_mm = middle.z_top_mm() - 0.5 * middle.height_mm();
    let cut = sections_at(&mesh, &[z_mm], &part.slicing).pop().unwrap_or_default();
    // Layers of a scan, or mended ones, differ from the mesh.
    let off = cut.difference(&turned).area_mm2() + turned.difference(&cut).area_mm2();
    if off > SAME_SECTION * turned.area_mm2() { turned } else { cut }
}

/// Default edge length of an element, which gives about ten thousand triangles for a simple section.
fn default_element_mm(section: &Region) -> f64 {
    (section.area_mm2() / 4000.0).sqrt().max(0.02)
}
