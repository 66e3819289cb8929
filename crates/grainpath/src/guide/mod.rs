//! Guides turn loads, pictures or a user's own directions into a direction at every point of every
//! layer.
//!
//! A guide solves the loads of a job on the section (a plate) or on the part (a solid), or takes an
//! imported stress. The principal stresses in the plane of each layer give directions, which are
//! smoothed where the stress is nearly the same in all directions. Lengths are in mm, stresses in
//! MPa.

mod deck_loads;
pub mod graded_density;
mod direction;
pub mod given_field;
pub mod grain;
mod import;
mod inside;
mod known;
mod mix;
mod plane;
mod results;
mod solid_stress;
mod trust;

use std::cell::OnceCell;
use std::ops::Range;
use std::sync::Arc;

use grainpath_core::diagnostics::{Interrupted, Stage};
use grainpath_core::faces::{FaceError, Faces, Surface};
use grainpath_core::selection::{Facets, Selection};
use grainpath_core::triangulation::TriangulationError;
use grainpath_core::{DMat3, DVec3, Diagnostics, DirectionField, Layer, LayerStack, TriMesh};
use grainpath_fea::load_case::{Action, BoundaryConditions, CatchesNothing, Fixture, Held, Load, LoadCase};
use grainpath_fea::material::{Orthotropic, Unstable};
use grainpath_fea::plane::{PlaneError, PlaneStress};
use grainpath_fea::principal::{PlaneTensor, plane_principal};
use grainpath_fea::resultant::CaseBalance;
use grainpath_fea::solid::SolidError;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::ply_mix::MOST_SLOTS;
use grainpath_io::fe::{DeckConditions, Element, StressField};
use rayon::prelude::*;

pub use direction::{DirectionSettings, Follow, LayerField, StressedSection};
pub use grainpath_fea::degenerate::{Degenerate, Degenerates, degenerate_points};
use grainpath_job::choices::{Analysis, Elasticity, LoadFrame};
use grainpath_job::loads::{self, Place, Push};
pub use plane::NotPlate;
pub(crate) use plane::{check_flat, is_plate};

use crate::shape::{SliceSettings, Standing};
pub use inside::{ResultVolume, StressLine};
pub use known::KnownStress;
use mix::{Family, Fields, LAYERS_OF_A_MIX, mixes_of};
pub use results::{Families, ResultSurface};

/// Distance from grips and rollers within which elements cannot fail, mm: stress there depends on the contact with the
/// testing machine and not on the part.
pub(crate) const UNBREAKABLE_MM: f64 = 1.5;

/// Distance from a fixture or load within which a strength test with cells of this size does not look for failure, mm.
fn unbreakable_mm(cell_mm: f64) -> f64 {
    // A node of the test lies up to three quarters of a cell from the fixture or load, and a cell up to one cell from its
    // nodes.
    UNBREAKABLE_MM + 1.75 * cell_mm
}

/// Why a guide cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum GuideError {
    #[error("[guide] kind = \"stress\" needs {0}")]
    Missing(&'static str),
    #[error(transparent)]
    CatchesNothing(#[from] CatchesNothing),
    #[error("{what} lists facet {facet}; the mesh has {n}")]
    NoFacet { what: String, facet: usize, n: usize },
    #[error("analysis = \"plane\" does not fit: {0}; use \"solid\"")]
    NotPlane(#[from] NotPlate),
    #[error(
        "the imported result lies from ({:.2}, {:.2}, {:.2}) to ({:.2}, {:.2}, {:.2}) mm, the part from ({:.2}, {:.2}, {:.2}) to ({:.2}, {:.2}, {:.2}) mm; a result has to reach over the whole part, in the part's coordinates; the unit of a file is guide.import_length_unit",
        result[0].x, result[0].y, result[0].z, result[1].x, result[1].y, result[1].z,
        part[0].x, part[0].y, part[0].z, part[1].x, part[1].y, part[1].z
    )]
    ImportElsewhere { result: [DVec3; 2], part: [DVec3; 2] },
    #[error(
        "the imported result is a plane one, which turns about z alone; shape.rotate_deg should be [0, 0, ANGLE]"
    )]
    ImportTurned,
    #[error(
        "guide.deck: the part in the deck lies from ({:.2}, {:.2}, {:.2}) to ({:.2}, {:.2}, {:.2}) mm, the part in the job's shape file from ({:.2}, {:.2}, {:.2}) to ({:.2}, {:.2}, {:.2}) mm; check guide.import_length_unit and that both files show the same part",
        found[0].x, found[0].y, found[0].z, found[1].x, found[1].y, found[1].z,
        part[0].x, part[0].y, part[0].z, part[1].x, part[1].y, part[1].z
    )]
    DeckElsewhere { found: [DVec3; 2], part: [DVec3; 2] },
    #[error(
        "guide.deck: a node of {what} lies at ({:.2}, {:.2}, {:.2}) mm, {off_mm:.2} mm off the part's surface",
        at_mm.x, at_mm.y, at_mm.z
    )]
    DeckOffPart { what: String, at_mm: DVec3, off_mm: f64 },
    #[error("{what}: {source}")]
    Face { what: String, source: FaceError },
    #[error(
        "{what}: torque_nmm needs a place with an axis: a cylinder, or a plane, cylindrical or conical face; this is a {shape}"
    )]
    NoAxis { what: String, shape: &'static str },
    #[error("material: {0}")]
    Material(#[from] Unstable),
    #[error("the section cannot be meshed: {0}")]
    Mesh(#[from] TriangulationError),
    #[error("{0}")]
    Plane(#[from] PlaneError),
    #[error("{0}")]
    Solid(SolidError),
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<SolidError> for GuideError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Interrupted(stop) => Self::Interrupted(stop),
            other => Self::Solid(other),
        }
    }
}

impl GuideError {
    /// Whether the job itself contains the error; false for a correct job that has no solution.
    pub(crate) fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::Missing(_)
                | Self::CatchesNothing(_)
                | Self::Solid(
                    SolidError::CatchesNothing(_)
                        | SolidError::PlaceTooSmall { .. }
                        | SolidError::NoBearing { .. }
                )
                | Self::NoFacet { .. }
                | Self::Face { .. }
                | Self::NoAxis { .. }
                | Self::ImportTurned
                | Self::DeckElsewhere { .. }
                | Self::DeckOffPart { .. }
                | Self::NotPlane(_)
                | Self::Material(_)
        )
    }
}

/// In-plane stress xx, yy, xy in MPa at any point of the part.
pub trait InPlaneStress: Send + Sync {
    /// The stress at `p`; outside the part, that of its nearest point.
    fn at(&self, p: DVec3) -> PlaneTensor;

    /// All six components of the stress at `p`, MPa, order xx, yy, zz, xy, yz, zx; those out of the plane are zero in a
    /// plate.
    fn whole(&self, p: DVec3) -> [f64; 6] {
        let [xx, yy, xy] = self.at(p);
        [xx, yy, 0.0, xy, 0.0, 0.0]
    }
}

impl InPlaneStress for PlaneStress {
    fn at(&self, p: DVec3) -> PlaneTensor {
        self.at(p.truncate())
    }
}

/// The stress of one load case.
#[derive(Clone)]
pub struct CaseStress {
    /// Name of the case.
    pub name: String,
    /// Weight of the case.
    pub weight: f64,
    /// Its stress field.
    pub stress: Arc<dyn InPlaneStress>,
}

/// Size, solver and main results of an analysis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StressSummary {
    /// Number of unknowns of the solution; 0 for imported stress, whose residual and mesh error are also unknown.
    pub dofs: usize,
    /// Name of the solver.
    pub solver: String,
    /// Number of finite elements.
    pub elements: usize,
    /// Largest residual of a case, relative to its loads.
    pub residual: f64,
    /// Greatest equivalent stress of any case, MPa.
    pub max_von_mises_mpa: f64,
    /// Greatest displacement of any case, mm.
    pub max_displacement_mm: f64,
    /// Estimated share of the stress that the mesh misses; the largest of all cases.
    pub error_estimate: f64,
    /// Tensile strength of the material along the beads, MPa, if the job states one.
    pub strength_mpa: Option<f64>,
    /// Loads and reactions of each case; empty for imported stress.
    pub balance: Vec<CaseBalance>,
    /// Shape and size of the elements, for solids.
    pub mesh: Option<String>,
    /// Degenerate points of the first case of a plate: points where both principal stresses are
    /// equal. In other parts every layer has its own.
    pub degenerate: Option<Degenerates>,
}

/// Directions for every layer.
pub struct Guide {
    layers: Vec<GuidedLayer>,
    /// The families of directions: either a single one, or one for all cases together and one for each case.
    families: Vec<Family>,
    follow: Follow,
    /// Size, solver and main results.
    pub summary: StressSummary,
    /// Stress fields of the cases.
    pub cases: Vec<CaseStress>,
    /// Results on the mesh, case by case.
    pub results: Vec<ResultMesh>,
    /// Whether the stress is the same at all heights, as in a plate.
    pub is_plate: bool,
    /// Where fixtures and loads act.
    pub places: Vec<Selection>,
}

/// The directions of a layer.
#[derive(Clone)]
struct GuidedLayer {
    field: Arc<LayerField>,
    /// Index of the layer's family in `Guide::families`.
    family: usize,
}

/// The layers whose directions are those of a load case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServedCase {
    /// Name of the case; `None` for layers that serve all cases together.
    pub case: Option<String>,
    /// The layers, from 0.
    pub layers: Vec<usize>,
}

/// Stress at the nodes of a mesh.
#[derive(Debug, Clone)]
pub struct ResultMesh {
    /// Name of the load case.
    pub name: String,
    /// Positions, mm, part coordinates.
    pub nodes: Vec<DVec3>,
    /// Elements, whose corners are indices of `nodes`.
    pub elements: Vec<Element>,
    /// Stress, MPa, xx, yy, zz, xy, yz, zx.
    pub stress: Vec<[f64; 6]>,
    /// Displacement, mm.
    pub displacement: Option<Vec<DVec3>>,
    /// Name and nodes of each fixture and load.
    pub sets: Vec<(String, Vec<u32>)>,
}

impl Guide {
    /// The field of a layer.
    pub fn layer(&self, i: usize) -> &dyn DirectionField {
        &*self.layers[i].field
    }

    /// The layers that serve each load case; empty if every layer follows the weighted sum of all cases.
    pub fn served(&self) -> Vec<ServedCase> {
        if self.families.len() < 2 {
            return Vec::new();
        }
        let of_family = |(k, family): (usize, &Family)| ServedCase {
            case: family.serves.and_then(|case| self.cases.get(case)).map(|case| case.name.clone()),
            layers: (0..self.layers.len()).filter(|i| self.layers[*i].family == k).collect(),
        };
        self.families.iter().enumerate().map(of_family).filter(|s| !s.layers.is_empty()).collect()
    }

    /// How many layers down to search for a layer of the same directions: the layers between may have others.
    pub fn turns(&self) -> usize {
        if self.families.len() < 2 { 2 } else { MOST_SLOTS }
    }

    /// A number for the directions that a layer follows: lines go on from a layer below with the same one.
    pub(crate) fn turn_of(&self, layer: usize) -> usize {
        let family = self.layers.get(layer).map_or(0, |l| l.family);
        2 * family + usize::from(self.follow == Follow::Alternate && layer % 2 == 1)
    }

    /// The axis that follows from the stress alone at a point of a layer, before any smoothing, in
    /// radians, and its weight in MPa.
    pub fn asked(&self, layer: usize, p: DVec3) -> (f64, f64) {
        let family = self.layers.get(layer).and_then(|l| self.families.get(l.family));
        let emphasis = family.map_or(&[][..], |f| &f.emphasis);
        let (double, weight) = direction::asked(&self.cases, emphasis, self.follow, p);
        // A sign change in double angles is a turn by 90 degrees, so that odd layers follow the other
        // principal stress.
        let double = if self.follow == Follow::Alternate && layer % 2 == 1 { -double } else { double };
        (0.5 * grainpath_core::math::atan2(double.y, double.x), weight)
    }

    /// The stress of the case with the largest weight.
    pub fn main_case(&self) -> &dyn InPlaneStress {
        let better = |a: &&CaseStress, b: &&CaseStress| a.weight.total_cmp(&b.weight);
        // Of cases with equal weight, the first one is taken.
        let main = self.cases.iter().rev().max_by(better);
        &*main.expect("a guide has a case").stress
    }

    /// Whether tension and compression of about equal amount cross at a point, in the case with the largest weight.
    /// `None` if the job says which of the two the beads follow.
    pub(crate) fn is_pure_shear(&self, p: DVec3) -> Option<bool> {
        if self.follow != Follow::MaxAbs {
            return None;
        }
        let [a, b] = plane_principal(self.main_case().at(p)).values_mpa;
        Some(a * b < 0.0 && (a.abs() - b.abs()).abs() < direction::EITHER * (a.abs() + b.abs()))
    }

    /// The points where both principal stresses in the plane of a layer are equal, in the case with
    /// the largest weight; for a plate, in the first case.
    pub fn degenerate(&self, layer: usize) -> &Degenerates {
        // A guide that only checked the loads has no layers, but the points of a plate are known even then.
        self.summary.degenerate.as_ref().unwrap_or_else(|| self.layers[layer].field.degenerate())
    }

    /// Number of degenerate points of a kind: counted once for a plate, and summed over the layers for other parts.
    pub(crate) fn count_degenerate(&self, kind: Degenerate) -> usize {
        let layers = if self.summary.degenerate.is_some() { 1 } else { self.layers.len() };
        (0..layers).map(|i| self.degenerate(i).count(kind)).sum()
    }

    /// The largest equivalent stress at a node of any case, MPa, and the position of that node, mm.
    pub(crate) fn peak_stress(&self) -> Option<(f64, DVec3)> {
        trust::peak_stress(&self.results)
    }

    /// The places of fixtures and loads, grown by the distance within which nothing fails in a strength test with cells
    /// of this size.
    pub fn grips(&self, cell_mm: f64) -> Vec<Selection> {
        self.places.iter().map(|on| on.grown(unbreakable_mm(cell_mm))).collect()
    }

    /// Whether the peak stress can be trusted: neither far beyond the strength nor hidden by the mesh.
    pub(crate) fn is_trusted(&self) -> bool {
        trust::is_trusted(&self.summary)
    }

    /// Tensile strength over the peak stress; `None` if the strength is unknown or the peak cannot be trusted.
    pub fn reserve(&self) -> Option<f64> {
        trust::reserve(&self.summary)
    }

    /// Whether two layers share one field.
    pub fn same(&self, i: usize, j: usize) -> bool {
        Arc::ptr_eq(&self.layers[i].field, &self.layers[j].field)
    }
}

/// Resolves the fixtures and loads of a job on its part. The loads of each `[[guide.case]]` form a case. Loads outside
/// cases form the first case, and each load step of a deck forms a further one. The lists of fixtures and of cases may
/// be empty.
///
/// # Errors
/// [`GuideError::NoFacet`] if a facet is not in the mesh, [`GuideError::Face`] if the name of a face
/// fits no face of the mesh or several, [`GuideError::DeckElsewhere`] if the deck is of another
/// part.
pub fn boundary_conditions(
    typed: &TypedLoads<'_>,
    mesh: &TriMesh,
    standing: &Standing,
) -> Result<BoundaryConditions, GuideError> {
    let places = Places { mesh, standing, frame: typed.frame, faces: OnceCell::new() };
    let mut fixtures = Vec::with_capacity(typed.fixtures.len());
    for (k, fixture) in typed.fixtures.iter().enumerate() {
        let name = format!("fixture {}", k + 1);
        let held = if fixture.normal { Held::Normal } else { places.held(fixture.fixed) };
        let on = places.resolved(&fixture.on, &name)?;
        fixtures.push(Fixture { name, on, held, displacement_mm: places.vector(fixture.displacement_mm) });
    }
    let mut cases = Vec::with_capacity(typed.cases.len() + 1);
    if !typed.loads.is_empty() {
        let loads = places.loads(typed.loads, "")?;
        cases.push(LoadCase { name: "loads".into(), weight: 1.0, loads });
    }
    for case in typed.cases {
        let loads = places.loads(&case.loads, &format!(" of case {:?}", case.name))?;
        cases.push(LoadCase { name: case.name.clone(), weight: case.weight, loads });
    }
    if let Some(deck) = typed.deck {
        let (held, steps) = deck_loads::conditions(deck, mesh, standing, fixtures.len() + 1)?;
        fixtures.extend(held);
        cases.extend(steps);
    }
    let (low, high) = mesh.bounds().unwrap_or_default();
    // 1 g/cm3 is 1e-9 t/mm3.
    let density_t_mm3 = typed.density_g_cm3 * 1e-9;
    Ok(BoundaryConditions { fixtures, cases, density_t_mm3, low, high })
}

/// The part on which the places of fixtures and loads are looked up.
struct Places<'a> {
    mesh: &'a TriMesh,
    standing: &'a Standing,
    frame: LoadFrame,
    /// The faces of the mesh, found when the first face name is looked up.
    faces: OnceCell<Faces>,
}

impl Places<'_> {
    /// Resolves loads and names them "load 1", "load 2" and so on, each name followed by `of_case`.
    fn loads(&self, loads: &[loads::Load], of_case: &str) -> Result<Vec<Load>, GuideError> {
        let mut all = Vec::with_capacity(loads.len());
        for (k, load) in loads.iter().enumerate() {
            let name = format!("load {}{of_case}", k + 1);
            let on = load.on.as_ref().map(|on| self.resolved(on, &name)).transpose()?;
            if let (Push::Preload(total_n), Some(head), Some(nut)) = (load.push, &on, &load.to) {
                // Each end is a load of its own, so that the report tells the area of each.
                let nut = self.resolved(nut, &name)?;
                for (end, on, towards) in [("on", head.clone(), nut.clone()), ("to", nut, head.clone())] {
                    let action = Action::Clamp { on, towards, total_n };
                    all.push(Load { name: format!("{name}, {end}"), action });
                }
                continue;
            }
            let action = match (load.push, on) {
                (Push::Acceleration(a), _) => Action::Acceleration { mm_s2: self.vector(a) },
                (Push::Centrifugal { point_mm, axis, speed_rpm }, _) => Action::Centrifugal {
                    point: self.point(point_mm),
                    axis: self.vector(axis),
                    rad_s: speed_rpm * std::f64::consts::TAU / 60.0,
                },
                (Push::Bearing(f), Some(on)) => Action::Bearing { on, total_n: self.vector(f) },
                (Push::Torque(total_nmm), Some(on)) => {
                    let (point, axis) = load
                        .on
                        .as_ref()
                        .and_then(|place| self.axis_of(place, &on))
                        .ok_or_else(|| GuideError::NoAxis { what: name.clone(), shape: on.name() })?;
                    Action::Torque { on, point, axis, total_nmm }
                }
                (Push::Remote { force_n, at_mm }, Some(on)) => {
                    Action::RemoteForce { on, total_n: self.vector(force_n), at_mm: self.point(at_mm) }
                }
                (Push::Force(f), Some(on)) => Action::Force { on, total_n: self.vector(f) },
                (Push::Pressure(mpa), Some(on)) => Action::Pressure { on, mpa },
                (Push::Moment(m), Some(on)) => Action::Moment { on, total_nmm: self.vector(m) },
                // Not reached: reading the job fails for a surface load that states no place.
                (_, None) | (Push::Preload(_), _) => continue,
            };
            all.push(Load { name, action });
        }
        Ok(all)
    }

    /// The selection for a place stated in the job; facets and faces are looked up in the mesh.
    fn resolved(&self, place: &Place, name: &str) -> Result<Selection, GuideError> {
        let mesh = self.mesh;
        let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices[v as usize]);
        match place {
            Place::Shape(shape) => Ok(match self.frame {
                LoadFrame::Placed => shape.clone(),
                LoadFrame::Part => {
                    let s = self.standing;
                    shape.moved(s.scale, s.rotation, s.shift())
                }
            }),
            Place::Facets(ids) => {
                let triangle = |&id: &usize| {
                    let found = mesh.triangles.get(id).map(corners);
                    let n = mesh.triangles.len();
                    found.ok_or_else(|| GuideError::NoFacet { what: name.to_owned(), facet: id, n })
                };
                let all: Vec<_> = ids.iter().map(triangle).collect::<Result<_, _>>()?;
                Ok(Selection::Triangles(Facets::new(all)))
            }
            Place::Face(face) | Place::FaceSide { face, .. } => {
                let faces = self.faces.get_or_init(|| faces_as_in_file(mesh, self.standing));
                let wrong = |source| GuideError::Face { what: name.to_owned(), source };
                let found = &faces.all()[faces.find_name(face).map_err(wrong)?];
                let all = found.triangles.iter().map(|&t| corners(&mesh.triangles[t as usize]));
                let whole = Facets::new(all.collect());
                Ok(Selection::Triangles(if let Place::FaceSide { point_mm, normal, .. } = place {
                    whole.on_side(self.point(*point_mm), self.vector(*normal))
                } else {
                    whole
                }))
            }
        }
    }

    /// A force, moment, acceleration or displacement of the job, in the coordinates of the placed part.
    fn vector(&self, v: DVec3) -> DVec3 {
        match self.frame {
            // Vectors of an unturned part are not multiplied, so that they stay exact to the last bit.
            LoadFrame::Part if !self.standing.is_as_in_file() => self.standing.rotation * v,
            LoadFrame::Part | LoadFrame::Placed => v,
        }
    }

    /// A point of the job, in the coordinates of the placed part.
    fn point(&self, p: DVec3) -> DVec3 {
        match self.frame {
            LoadFrame::Part => self.standing.rotation * (self.standing.scale * p) + self.standing.shift(),
            LoadFrame::Placed => p,
        }
    }

    /// The axis of a cylinder, or of a round or plane face: a point on the axis and its direction.
    fn axis_of(&self, place: &Place, on: &Selection) -> Option<(DVec3, DVec3)> {
        if let Selection::Cylinder { point, axis, .. } = on {
            return Some((*point, *axis));
        }
        let (Place::Face(face) | Place::FaceSide { face, .. }) = place else { return None };
        let faces = self.faces.get()?;
        let found = &faces.all()[faces.find_name(face).ok()?];
        let (point, axis) = match found.surface {
            Surface::Cylinder { point, axis, .. } | Surface::Cone { point, axis, .. } => (point, axis),
            // The axis of a plane face is its normal through the centroid of the face, or of the part of it.
            Surface::Plane { normal } => {
                if let (Place::FaceSide { .. }, Selection::Triangles(part)) = (place, on) {
                    return Some((part.centroid()?, self.standing.rotation * normal));
                }
                (found.centroid, normal)
            }
            Surface::Sphere { .. } | Surface::Free => return None,
        };
        // The faces were measured on the part in the orientation of its file.
        Some((self.standing.rotation * point + self.faces_shift(), self.standing.rotation * axis))
    }

    /// The shift that, after the rotation, moves the mesh of the measured faces onto the placed part.
    fn faces_shift(&self) -> DVec3 {
        if self.standing.rotation == DMat3::IDENTITY { DVec3::ZERO } else { self.standing.shift() }
    }

    /// How a fixture holds that prevents motions along these axes of the job's frame.
    fn held(&self, fixed: [bool; 3]) -> Held {
        match self.frame {
            // Letters that name axes of the placed part need no turn.
            LoadFrame::Placed => Held::Axes(fixed),
            LoadFrame::Part => Held::turned(self.standing.rotation, fixed),
        }
    }
}

/// The faces of a part. Their names refer to the orientation of the part in its file, whichever way it stands on the
/// plate.
pub fn faces_as_in_file(mesh: &TriMesh, standing: &Standing) -> Faces {
    if standing.rotation == DMat3::IDENTITY {
        // The mesh is not moved back, so that coordinates of unturned parts stay exact to the last bit.
        return Faces::segment(mesh).told_in_file(standing.scale, standing.shift());
    }
    let back = standing.rotation.transpose();
    let vertices = mesh.vertices.iter().map(|p| back * (*p - standing.shift())).collect();
    let turned = TriMesh { vertices, triangles: mesh.triangles.clone() };
    Faces::segment(&turned).told_in_file(standing.scale, DVec3::ZERO)
}

/// The part whose directions a guide computes.
pub struct GuidedPart<'a> {
    /// Mesh of the part, repaired and placed on the plate.
    pub mesh: &'a TriMesh,
    /// Its layers.
    pub stack: &'a LayerStack,
    /// Position and rotation of the part on the plate.
    pub standing: Standing,
    /// How its layers were cut.
    pub slicing: SliceSettings,
    /// Stress of an earlier run, which is used again if part and loads are the same.
    pub known: Option<&'a KnownStress>,
}

/// The fixtures and loads of a job as read, not yet resolved on the part.
#[derive(Debug, Clone, Copy)]
pub struct TypedLoads<'a> {
    /// `[[guide.fixture]]`.
    pub fixtures: &'a [loads::Fixture],
    /// `[[guide.load]]`, outside cases.
    pub loads: &'a [loads::Load],
    /// `[[guide.case]]`.
    pub cases: &'a [loads::Case],
    /// Mass density of the material, g/cm3, for accelerations.
    pub density_g_cm3: f64,
    /// Coordinate system of places and vectors.
    pub frame: LoadFrame,
    /// Supports and loads of `guide.deck`.
    pub deck: Option<&'a DeckConditions>,
}

/// Settings of a guide by stress.
#[derive(Debug, Clone, PartialEq)]
pub struct StressSettings {
    /// Model of the analysis.
    pub analysis: Analysis,
    /// Longest edge of an element, mm; `None` chooses it from the size of the part.
    pub element_mm: Option<f64>,
    /// Elastic constants.
    pub material: Orthotropic,
    /// Elastic model; with [`Elasticity::Isotropic`], `material` must be isotropic.
    pub elasticity: Elasticity,
    /// Direction of the beads in the elastic model, counter-clockwise from +X.
    pub bead_axis_rad: f64,
    /// Memory limit, MiB.
    pub max_mib: f64,
    /// Tensile strength along the beads, MPa, if known: a stress peak far above it gives a warning.
    pub strength_mpa: Option<f64>,
    /// The principal stress that beads follow.
    pub follow: Follow,
    /// Length over which directions are smoothed, mm.
    pub smoothing_mm: f64,
    /// Whether directions are aligned with free borders.
    pub tangent: bool,
    /// Distance between the nodes of a layer's field, mm.
    pub cell_mm: f64,
    /// Strength card of the beads, if each layer is to serve one of several load cases so that the least reserve is
    /// largest. With `None` every layer follows the weighted sum of the cases.
    pub mix: Option<StrengthCard>,
}

/// Solves the loads of a job, or takes the imported stress, and computes the directions of every
/// layer.
///
/// # Errors
/// [`GuideError`] for missing or misplaced fixtures and loads, for parts that move freely, and for
/// analyses that exceed the memory limit.
pub fn build(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
    imported: Option<StressField>,
    diagnostics: &Diagnostics,
) -> Result<Guide, GuideError> {
    diagnostics.begin(Stage::Guide, 0);
    let solved = solved_or_imported(settings, part, conditions, imported, diagnostics)?;
    let layers = lay_directions(settings, part, conditions, &solved, diagnostics)?;
    Ok(guide_of(settings, conditions, solved, layers))
}

/// Solves the loads of a job, or takes the imported stress, but computes no directions: a check of the areas that loads
/// and fixtures act on.
///
/// # Errors
/// As [`build`].
pub(crate) fn solved_only(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
    imported: Option<StressField>,
    diagnostics: &Diagnostics,
) -> Result<Guide, GuideError> {
    diagnostics.begin(Stage::Guide, 0);
    let solved = solved_or_imported(settings, part, conditions, imported, diagnostics)?;
    Ok(guide_of(settings, conditions, solved, LaidDirections::default()))
}

fn guide_of(
    settings: &StressSettings,
    conditions: &BoundaryConditions,
    solved: Solved,
    laid: LaidDirections,
) -> Guide {
    let Solved { cases, results, summary, constant: is_plate } = solved;
    let places = conditions.places().cloned().collect();
    let LaidDirections { layers, families } = laid;
    Guide { layers, families, follow: settings.follow, summary, cases, results, is_plate, places }
}

fn solved_or_imported(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
    imported: Option<StressField>,
    diagnostics: &Diagnostics,
) -> Result<Solved, GuideError> {
    let mut solved = match imported {
        Some(field) => {
            field.result().warnings.iter().for_each(|w| diagnostics.push(w.clone()));
            import::solved(field, part)?
        }
        None => solve(settings, part, conditions, diagnostics)?,
    };
    solved.summary.strength_mpa = settings.strength_mpa;
    trust::warn(settings, part, &solved.summary, &solved.results, diagnostics);
    diagnostics.check()?;
    Ok(solved)
}

fn solve(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
    diagnostics: &Diagnostics,
) -> Result<Solved, GuideError> {
    if conditions.cases.is_empty() {
        return Err(GuideError::Missing("a [[guide.load]], or a guide.deck with loads"));
    }
    if conditions.fixtures.is_empty() {
        return Err(GuideError::Missing("a [[guide.fixture]], or a guide.deck with supports"));
    }
    let solve = || match settings.analysis {
        Analysis::Plane => plane::solve(settings, part, conditions),
        Analysis::Solid => solid_stress::solve(settings, part, conditions, diagnostics),
        Analysis::Auto if is_plate(part.stack, conditions) => {
            match plane::solve(settings, part, conditions) {
                // Loads act on the border of a plate, so one that lies inside it catches nothing. On the solid it acts on the
                // top and the bottom.
                Err(GuideError::CatchesNothing(_)) => {
                    solid_stress::solve(settings, part, conditions, diagnostics)
                }
                other => other,
            }
        }
        Analysis::Auto => solid_stress::solve(settings, part, conditions, diagnostics),
    };
    match part.known {
        Some(known) => known.or_solve(settings, part, conditions, diagnostics, solve),
        None => solve(),
    }
}

/// Result of a solver.
#[derive(Clone)]
struct Solved {
    cases: Vec<CaseStress>,
    results: Vec<ResultMesh>,
    summary: StressSummary,
    /// Whether the stress is the same at all heights.
    constant: bool,
}

/// The direction fields of all layers, and the families that they belong to.
#[derive(Default)]
struct LaidDirections {
    layers: Vec<GuidedLayer>,
    families: Vec<Family>,
}

fn lay_directions(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
    solved: &Solved,
    diagnostics: &Diagnostics,
) -> Result<LaidDirections, GuideError> {
    let layers = part.stack.layers();
    let cases = &solved.cases;
    // A border is free where no fixture or load acts. Only there is the stress across the border zero.
    let free = |p: DVec3| !conditions.places().any(|s| s.contains(p));
    let follow = settings.follow;
    let turns = follow == Follow::Alternate;
    let direction = |i: usize| DirectionSettings {
        follow,
        across: turns && i % 2 == 1,
        smoothing_mm: settings.smoothing_mm,
        tangent: settings.tangent,
        cell_mm: settings.cell_mm,
        rows: part.standing.plan_axis(),
        find_degenerate: solved.summary.degenerate.is_none(),
    };
    let section = |i: usize| {
        let z_mm = layers[i].z_top_mm() - 0.5 * layers[i].height_mm();
        StressedSection::new(layers[i].region(), z_mm, cases, &free, &direction(i))
    };
    let several = settings.mix.as_ref().filter(|_| cases.len() > 1);
    let families =
        several.map_or_else(|| vec![Family::by_weight(cases)], |card| Family::of_cases(cases.len(), card));
    let grips: Vec<Selection> =
        conditions.places().map(|on| on.grown(unbreakable_mm(settings.cell_mm))).collect();
    let counts = |p: DVec3| !grips.iter().any(|on| on.contains(p));
    // The mix whose least reserve in the given layers is largest, and the fields of all families there.
    let mixed = |card: &StrengthCard, some: Range<usize>, shares: &dyn Fn(usize) -> Vec<f64>| {
        let fields = |i: usize| {
            diagnostics.check()?;
            Ok(Fields::new(section(i), &families, &free, &direction(i)))
        };
        let sections = some.into_par_iter().map(fields).collect::<Result<Vec<_>, Interrupted>>()?;
        let mix = mixes_of(card, cases, &sections, &counts)?.best(shares, diagnostics)?;
        Ok::<_, GuideError>((mix, sections))
    };
    // A plate has one mix for all layers; each layer counts by its height.
    let middle = layers.len() / 2;
    let of_plate = match several.filter(|_| solved.constant && !layers.is_empty()) {
        Some(card) => {
            let all_mm: f64 = layers.iter().map(Layer::height_mm).sum();
            let shares = |n: usize| -> Vec<f64> {
                let of_turn =
                    |turn: usize| layers.iter().skip(turn).step_by(n).map(Layer::height_mm).sum::<f64>();
                (0..n).map(|turn| of_turn(turn) / all_mm).collect()
            };
            Some(mixed(card, middle..middle + 1, &shares)?.0)
        }
        None => None,
    };
    let family = |i: usize| of_plate.as_ref().map_or(0, |mix| mix[i % mix.len()]);
    // For each layer, the earlier layer whose field it shares; its own index if it shares none.
    let like: Vec<usize> = (0..layers.len())
        .map(|i| {
            let same = |k: usize| layers[k].region() == layers[i].region() && family(k) == family(i);
            // If the principal stresses alternate, a layer is compared with the one two below; in a mix, with each layer
            // up to one mix length below.
            let steps = match &of_plate {
                Some(mix) => 1..=mix.len(),
                None if turns => 2..=2,
                None => 1..=1,
            };
            let found = steps.filter(|step| solved.constant && i >= *step).find(|step| same(i - step));
            found.map_or(i, |step| i - step)
        })
        .collect();
    diagnostics.begin(Stage::Guide, layers.len());
    if let Some(card) = several.filter(|_| !solved.constant) {
        let firsts: Vec<usize> = (0..layers.len()).step_by(LAYERS_OF_A_MIX).collect();
        let lay = |first: usize| {
            let some = first..(first + LAYERS_OF_A_MIX).min(layers.len());
            diagnostics.advance(some.len());
            let (mix, sections) = mixed(card, some.clone(), &|n| vec![1.0 / n as f64; n])?;
            let laid = some.zip(sections).map(|(i, fields)| {
                let family = mix[i % mix.len()];
                GuidedLayer { field: Arc::new(fields.take(family)), family }
            });
            Ok(laid.collect::<Vec<_>>())
        };
        let laid = firsts.into_par_iter().map(lay).collect::<Result<Vec<_>, GuideError>>()?;
        return Ok(LaidDirections { layers: laid.into_iter().flatten().collect(), families });
    }
    let made: Vec<Result<Option<GuidedLayer>, Interrupted>> = (0..layers.len())
        .into_par_iter()
        .map(|i| {
            diagnostics.check()?;
            diagnostics.advance(1);
            if like[i] != i {
                // Shared fields are filled in afterwards, once their originals exist.
                return Ok(None);
            }
            let family = family(i);
            let field = section(i).field(&families[family].emphasis, &free, &direction(i));
            Ok(Some(GuidedLayer { field: Arc::new(field), family }))
        })
        .collect();
    let mut laid: Vec<GuidedLayer> = Vec::with_capacity(layers.len());
    for (i, layer) in made.into_iter().enumerate() {
        let layer = layer?.unwrap_or_else(|| laid[like[i]].clone());
        laid.push(layer);
    }
    Ok(LaidDirections { layers: laid, families })
}

#[cfg(test)]
mod tests;
