//! Supports and loads of a deck, converted from nodes and elements to places of the part's surface, in mm, N and MPa.
//!
//! Another mesh of the same part has other nodes, so loads on nodes are turned into tractions that another mesh can take. On
//! surface faces whose nodes carry forces, the traction `t` is found whose consistent nodal forces are the forces `f` of the
//! deck: `sum_j (integral of N_i N_j) t_j = f_i`, with the shape functions `N` of the deck's own elements, over the faces
//! that carry the component. If the nodal forces came from a traction, this recovers it. The traction always has the
//! resultant and the moment of the forces, because the shape functions reproduce a constant and the position. Forces on
//! nodes that make no face stay forces at points. Pressures are tractions already.
//!
//! Units: the deck's forces are its unit of stress times the square of its unit of length, its time is in seconds.

use std::collections::BTreeMap;

use grainpath_core::conjugate_gradients::{CgEnd, CgSettings, CgSystem, conjugate_gradients};
use grainpath_core::disjoint_sets::DisjointSets;
use grainpath_core::mesh::triangle_normal;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, Warning, WarningId};

use super::deck::{Behaviour, BodyForce, Deck, Elastic, Step};
use super::element::ElementKind;
use super::model::{FeError, FeFile, invalid};
use super::nodal_forces::face_of;
use super::problem::FeProblem;
use super::result::{FeOptions, StressUnit};

/// Prefixes of the keywords that change loads, supports or the stress without load, and are not read. A deck with one of them is refused. All other
/// unread keywords concern materials, output and the solver, which are not taken from a deck.
const LOADS_AND_SUPPORTS: [&str; 23] = [
    "CLOAD",
    "DLOAD",
    "DSLOAD",
    "BOUNDARY",
    "SURFACE",
    "INSTANCE",
    "TRANSFORM",
    "EQUATION",
    "MPC",
    "RIGIDBODY",
    "COUPLING",
    "KINEMATIC",
    "DISTRIBUTING",
    "TIE",
    "SPRING",
    "CONTACT",
    "TEMPERATURE",
    "PRE-TENSIONSECTION",
    "SUBMODEL",
    "CYCLICSYMMETRYMODEL",
    "BASEMOTION",
    "CHANGE",
    INITIAL_STRESS,
];

/// A stress that the part has without loads.
const INITIAL_STRESS: &str = "INITIALCONDITIONS, TYPE=STRESS";

/// Limit on the different displacements that supports may prescribe along an axis. Source: chosen; supports that move as a
/// whole have a few, those that turn have one for every node, and would need to be interpolated.
const MAX_DISPLACEMENTS: usize = 16;

/// Limit on the steps that become load cases. Source: chosen; each costs a solution.
const MAX_STEPS: usize = 100;

/// Limit on the steps of the conjugate gradients. Source: derived: mass matrices scaled by their diagonal have condition
/// numbers below 100 (`wathen1987`), so that 12 digits take about 140 steps.
const MAX_CG_STEPS: usize = 1000;

/// A place of the deck's surface.
#[derive(Debug, Clone, PartialEq)]
pub enum DeckPlace {
    /// Faces, cut into triangles that are counter-clockwise seen from outside, mm.
    Faces(Vec<[DVec3; 3]>),
    /// Nodes that make no face, mm.
    Points(Vec<DVec3>),
}

/// A place that is held.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckSupport {
    /// The place.
    pub on: DeckPlace,
    /// Whether motion along x, y and z is prescribed.
    pub held: [bool; 3],
    /// Displacement along them, mm.
    pub displacement_mm: DVec3,
}

/// A load of a step.
#[derive(Debug, Clone, PartialEq)]
pub enum DeckLoad {
    /// A traction on faces.
    Traction {
        /// Triangles of the faces, counter-clockwise seen from outside, mm.
        triangles: Vec<[DVec3; 3]>,
        /// Traction at the corners of each triangle, MPa.
        corners_mpa: Vec<[DVec3; 3]>,
        /// Whether the traction is a pressure. When the part is scaled, the force of a pressure grows with its area; that of
        /// nodal forces stays.
        is_pressure: bool,
        /// Its resultant in the deck, N.
        force_n: DVec3,
        /// The moment of the deck's nodal forces about the origin, N mm.
        moment_nmm: DVec3,
    },
    /// Forces at points of the surface: each point in mm and its force in N.
    Forces(Vec<(DVec3, DVec3)>),
    /// An acceleration of the whole part, mm/s2.
    Acceleration(DVec3),
    /// Rotation of the whole part.
    Centrifugal {
        /// A point of the axis, mm.
        point_mm: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Speed, rad/s.
        rad_s: f64,
    },
}

/// The loads that act at the end of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckStep {
    /// Its name for messages, such as "step 1".
    pub name: String,
    /// Its loads.
    pub loads: Vec<DeckLoad>,
}

/// The material that all elements of a deck share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeckMaterial {
    /// Young's modulus, MPa.
    pub young_mpa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Mass density, t/mm3, where the deck states it.
    pub density_t_mm3: Option<f64>,
}

/// Supports and loads of a deck.
///
/// ```
/// use grainpath_io::fe::{DeckLoad, FeOptions, parse_fe};
///
/// let deck = b"*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n\
///              *BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n*STEP\n*STATIC\n*DLOAD\n1,P2,5\n*END STEP\n";
/// let conditions = parse_fe(deck, Some("a.inp"))?.deck_conditions(&FeOptions::default())?;
/// assert_eq!(conditions.supports[0].held, [true; 3]);
/// let DeckLoad::Traction { force_n, .. } = &conditions.steps[0].loads[0] else { panic!("a pressure") };
/// assert!((force_n.y - 2.5).abs() < 1e-12, "5 MPa on the face at y = 0, of 0.5 mm2");
/// # Ok::<(), grainpath_io::fe::FeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DeckConditions {
    /// Lowest corner of the box around the solid elements, mm.
    pub low: DVec3,
    /// Highest corner of the box around the solid elements, mm.
    pub high: DVec3,
    /// Its supports; they hold in all steps.
    pub supports: Vec<DeckSupport>,
    /// The steps that load the part: all static ones, or the one asked for.
    pub steps: Vec<DeckStep>,
    /// Its material, where all elements have the same and it is isotropic.
    pub material: Option<DeckMaterial>,
    /// What was left out.
    pub warnings: Vec<Warning>,
}

impl DeckConditions {
    /// The deck's material, for callers that cannot do without its constants.
    ///
    /// # Errors
    /// For a deck without one isotropic material for all its solid elements.
    pub fn needed_material(&self) -> Result<DeckMaterial, FeError> {
        self.material.ok_or_else(|| invalid("the deck", FeProblem::NoOneMaterial))
    }
}

/// A face of the surface of the solid elements.
struct SurfaceFace {
    kind: ElementKind,
    /// Its nodes, counter-clockwise seen from outside: corners, then the middles between them.
    nodes: Vec<u32>,
}

impl SurfaceFace {
    fn corners(&self) -> &[u32] {
        &self.nodes[..self.kind.n_corners()]
    }

    fn middles(&self) -> &[u32] {
        &self.nodes[self.kind.n_corners()..]
    }
}

/// The surface of a deck's solids.
struct DeckSurface<'a> {
    file: &'a FeFile,
    deck: &'a Deck,
    /// Millimetres and megapascals of the deck's units.
    mm: f64,
    mpa: f64,
    faces: Vec<SurfaceFace>,
    /// Index into `faces` for each element face on the surface, by element and number of the face.
    face_of_element: BTreeMap<(u32, u8), u32>,
    /// Whether a solid element has the node.
    in_solid: Vec<bool>,
    /// Whether a face of the surface has the node.
    on_surface: Vec<bool>,
    n_solids: usize,
}

impl FeFile {
    /// The supports and loads of an INP deck, for another mesh of the same part. Of `options`, only the units and the step
    /// are used.
    ///
    /// # Errors
    /// [`FeError`] for files of other formats, for decks without solid elements, and for loads and supports that are not
    /// understood, so that none is lost silently.
    pub fn deck_conditions(&self, options: &FeOptions) -> Result<DeckConditions, FeError> {
        let deck = self.deck.as_deref().ok_or(FeError::NoDeck { format: self.format.name() })?;
        let changes = |k: &&String| LOADS_AND_SUPPORTS.iter().any(|l| k.starts_with(l));
        if let Some(keyword) = deck.ignored.iter().find(changes) {
            let problem = match keyword {
                k if k.starts_with(INITIAL_STRESS) => FeProblem::InitialStress,
                k if k.contains("AMPLITUDE") => FeProblem::Amplitude,
                _ => FeProblem::ChangesLoads,
            };
            return Err(invalid(format!("*{keyword}"), problem));
        }
        let surface = DeckSurface::new(self, deck, options)?;
        let mut warnings = self.warnings.clone();
        let mut warn = |text: String| warnings.push(Warning::new(WarningId::FeLeftOut, text));
        for (what, n) in self.left_out.iter().filter(|(what, _)| what != "points" && what != "lines") {
            warn(format!("{n} elements are left out: {what}"));
        }
        let chosen = chosen_steps(deck, options.step, &mut warn)?;
        let supports = surface.supports(&chosen, &mut warn)?;
        let moves = supports.iter().any(|s| s.displacement_mm != DVec3::ZERO);
        let mut steps = Vec::new();
        for &i in &chosen {
            let name = format!("step {}", i + 1);
            if deck.steps[i].nlgeom {
                warn(format!("{name} asks for large displacements (NLGEOM); it is solved for small ones"));
            }
            let loads = surface.loads(&deck.steps[i], &name)?;
            // A step without a load only writes output or precedes the load. It is kept where supports move or the job asks
            // for it.
            if !loads.is_empty() || moves || options.step.is_some() {
                steps.push(DeckStep { name, loads });
            }
        }
        if supports.is_empty() && steps.iter().all(|s| s.loads.is_empty()) {
            return Err(invalid("the deck", FeProblem::NothingActs));
        }
        let (low, high) = surface.bounds();
        Ok(DeckConditions { low, high, supports, steps, material: surface.material(), warnings })
    }
}

/// The steps that become load cases: the one asked for, or all static ones.
fn chosen_steps(
    deck: &Deck,
    step: Option<usize>,
    warn: &mut impl FnMut(String),
) -> Result<Vec<usize>, FeError> {
    let is_static = |s: &Step| s.procedure.is_empty() || s.procedure == "STATIC";
    let n = deck.steps.len();
    if let Some(k) = step {
        let no_step = || invalid(format!("step {k}"), FeProblem::NoSuchStep { last: n });
        let found = deck.steps.get(k.wrapping_sub(1)).ok_or_else(no_step)?;
        if !is_static(found) {
            return Err(invalid(format!("step {k}"), FeProblem::NotStatic(found.procedure.clone())));
        }
        return Ok(vec![k - 1]);
    }
    let (chosen, others): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| is_static(&deck.steps[i]));
    if let (Some(&first), true) = (others.first(), chosen.is_empty()) {
        let procedure = deck.steps[first].procedure.clone();
        return Err(invalid(format!("step {}", first + 1), FeProblem::NotStatic(procedure)));
    }
    if let Some(&first) = others.first() {
        let (k, procedure) = (first + 1, &deck.steps[first].procedure);
        warn(format!(
            "{} steps are not static and are left out; the first is step {k}, *{procedure}",
            others.len()
        ));
    }
    if chosen.len() > MAX_STEPS {
        return Err(invalid("the deck", FeProblem::TooManySteps { found: chosen.len(), most: MAX_STEPS }));
    }
    Ok(chosen)
}

impl<'a> DeckSurface<'a> {
    fn new(file: &'a FeFile, deck: &'a Deck, options: &FeOptions) -> Result<Self, FeError> {
        let mut in_solid = vec![false; file.nodes.len()];
        let mut keyed: Vec<([u32; 4], u32, u8)> = Vec::new();
        let mut n_solids = 0;
        for (i, e) in (0u32..).zip(&file.elements).filter(|(_, e)| e.kind.dimension() == 3) {
            n_solids += 1;
            e.nodes().iter().for_each(|&n| in_solid[n as usize] = true);
            for (f, corners) in (0u8..).zip(e.kind.faces()) {
                // Triangles fill the fourth place with a number that no node has.
                let mut key = [u32::MAX; 4];
                key.iter_mut().zip(*corners).for_each(|(k, &c)| *k = e.nodes()[c]);
                key.sort_unstable();
                keyed.push((key, i, f));
            }
        }
        if n_solids == 0 {
            return Err(invalid("the deck", FeProblem::NoSolids));
        }
        keyed.sort_unstable();
        let mut faces = Vec::new();
        let mut face_of_element = BTreeMap::new();
        let mut on_surface = vec![false; file.nodes.len()];
        // A face of the surface belongs to one element alone.
        for same in keyed.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1) {
            let (_, element, face) = same[0];
            let e = &file.elements[element as usize];
            let Some((kind, mut nodes)) = face_of(e, face as usize) else { continue };
            if file.winding(e) < 0.0 {
                let n = kind.n_corners();
                nodes[1..n].reverse();
                nodes[n..].reverse();
            }
            nodes.iter().for_each(|&n| on_surface[n as usize] = true);
            face_of_element.insert((element, face), faces.len() as u32);
            faces.push(SurfaceFace { kind, nodes });
        }
        let mm = options.length_unit.unwrap_or(LengthUnit::Millimetre).mm();
        let mpa = options.stress_unit.unwrap_or(StressUnit::Megapascal).mpa();
        Ok(Self { file, deck, mm, mpa, faces, face_of_element, in_solid, on_surface, n_solids })
    }

    /// A node's position, mm.
    fn at(&self, node: u32) -> DVec3 {
        self.file.nodes[node as usize] * self.mm
    }

    /// N of the deck's unit of force.
    fn newton(&self) -> f64 {
        self.mpa * self.mm * self.mm
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        let all = self.faces.iter().flat_map(|f| &f.nodes).map(|&n| self.at(n));
        all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
    }

    fn node_name(&self, node: u32) -> String {
        format!("node {}", self.deck.node_numbers[node as usize])
    }

    /// Refuses loads and supports on nodes that are in no solid element: they would act on the part through elements that
    /// are not read.
    fn check_in_solid(&self, node: u32) -> Result<(), FeError> {
        match self.in_solid[node as usize] {
            true => Ok(()),
            false => Err(invalid(self.node_name(node), FeProblem::NoSolidHasIt)),
        }
    }

    /// The faces whose nodes are listed. With `all`, every node of a face must be. Otherwise its corners or its middle nodes
    /// suffice: under an even traction the corners of quadratic triangles carry no force.
    fn faces_among(&self, listed: &[bool], all: bool) -> Vec<u32> {
        let is = |nodes: &[u32]| nodes.iter().all(|&n| listed[n as usize]);
        let taken = |f: &SurfaceFace| match all {
            true => is(&f.nodes),
            false => is(f.corners()) || (!f.middles().is_empty() && is(f.middles())),
        };
        (0u32..).zip(&self.faces).filter(|(_, f)| taken(f)).map(|(i, _)| i).collect()
    }

    /// Faces in groups that share nodes, in the order of their first faces.
    fn connected(&self, faces: &[u32]) -> Vec<Vec<u32>> {
        let mut sets = DisjointSets::new(self.file.nodes.len());
        for &f in faces {
            let nodes = &self.faces[f as usize].nodes;
            nodes.iter().for_each(|&n| _ = sets.union(nodes[0] as usize, n as usize));
        }
        let mut groups: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for &f in faces {
            groups.entry(sets.lowest(self.faces[f as usize].nodes[0] as usize)).or_default().push(f);
        }
        let mut all: Vec<Vec<u32>> = groups.into_values().collect();
        all.sort_by_key(|group| group[0]);
        all
    }

    /// The triangles of a face, mm, with the weights of its nodes at their corners.
    fn triangles(&self, face: u32) -> impl Iterator<Item = [(DVec3, [f64; 8]); 3]> + '_ {
        let SurfaceFace { kind, nodes } = &self.faces[face as usize];
        let corner = |x: DVec3| {
            let shape = kind.shape(x);
            let weights: [f64; 8] = std::array::from_fn(|k| if k < nodes.len() { shape.n[k] } else { 0.0 });
            (nodes.iter().zip(weights).map(|(&n, w)| self.at(n) * w).sum(), weights)
        };
        cut(*kind).into_iter().map(move |t| t.map(corner))
    }

    /// The triangles of faces, mm.
    fn triangles_of(&self, faces: &[u32]) -> Vec<[DVec3; 3]> {
        faces.iter().flat_map(|&f| self.triangles(f)).map(|t| t.map(|(p, _)| p)).collect()
    }

    /// The supports at the end of a step, by node and axis, in the deck's unit. Rotations are left out: nodes of solids have
    /// none.
    fn held(&self, step: Option<usize>) -> BTreeMap<(u32, u8), f64> {
        let mut held = BTreeMap::new();
        let add = |held: &mut BTreeMap<(u32, u8), f64>, fixed: &[super::deck::Fixed]| {
            held.extend(fixed.iter().filter(|f| f.axis < 3).map(|f| ((f.node, f.axis), f.value)));
        };
        add(&mut held, &self.deck.fixed);
        for s in self.deck.steps.iter().take(step.map_or(0, |k| k + 1)) {
            if s.releases {
                held.clear();
            }
            add(&mut held, &s.fixed);
        }
        held
    }

    fn supports(&self, steps: &[usize], warn: &mut impl FnMut(String)) -> Result<Vec<DeckSupport>, FeError> {
        let held = self.held(steps.first().copied());
        for &k in steps.iter().skip(1) {
            if self.held(Some(k)) != held {
                let problem = FeProblem::OtherSupports { first: steps[0] + 1 };
                return Err(invalid(format!("step {}", k + 1), problem));
            }
        }
        // Groups the nodes by axis and displacement. Adding zero makes -0 and 0 the same.
        let mut by_value: BTreeMap<(u8, u64), Vec<u32>> = BTreeMap::new();
        for (&(node, axis), value) in &held {
            self.check_in_solid(node)?;
            by_value.entry((axis, (value + 0.0).to_bits())).or_default().push(node);
        }
        if (0..3).any(|axis| by_value.keys().filter(|k| k.0 == axis).count() > MAX_DISPLACEMENTS) {
            return Err(invalid("the supports", FeProblem::ManyDisplacements { most: MAX_DISPLACEMENTS }));
        }
        // Axes along which the same nodes are held become one support.
        let mut merged: Vec<(Vec<u32>, [bool; 3], DVec3)> = Vec::new();
        for ((axis, bits), nodes) in by_value {
            let (axis, value) = (axis as usize, f64::from_bits(bits) * self.mm);
            let slot = match merged.iter().position(|m| !m.1[axis] && m.0 == nodes) {
                Some(slot) => slot,
                None => {
                    merged.push((nodes, [false; 3], DVec3::ZERO));
                    merged.len() - 1
                }
            };
            merged[slot].1[axis] = true;
            merged[slot].2[axis] = value;
        }
        let (mut supports, mut n_inside) = (Vec::new(), 0);
        for (nodes, held, displacement_mm) in merged {
            let mut listed = vec![false; self.file.nodes.len()];
            nodes.iter().for_each(|&n| listed[n as usize] = true);
            let faces = self.faces_among(&listed, true);
            let mut add = |on| supports.push(DeckSupport { on, held, displacement_mm });
            for group in self.connected(&faces) {
                add(DeckPlace::Faces(self.triangles_of(&group)));
            }
            faces
                .iter()
                .flat_map(|&f| &self.faces[f as usize].nodes)
                .for_each(|&n| listed[n as usize] = false);
            let rest = || nodes.iter().filter(|&&n| listed[n as usize]);
            let points: Vec<DVec3> =
                rest().filter(|&&n| self.on_surface[n as usize]).map(|&n| self.at(n)).collect();
            n_inside += rest().count() - points.len();
            if !points.is_empty() {
                add(DeckPlace::Points(points));
            }
        }
        if n_inside > 0 {
            warn(format!("{n_inside} held nodes are inside the part; it is held on its surface alone"));
        }
        Ok(supports)
    }

    fn loads(&self, step: &Step, name: &str) -> Result<Vec<DeckLoad>, FeError> {
        let mut loads = self.nodal_loads(step)?;
        loads.extend(self.pressures(step)?);
        loads.extend(self.body_loads(step, name)?);
        Ok(loads)
    }

    /// Converts forces on nodes: to tractions where the nodes make faces, to forces at points elsewhere.
    fn nodal_loads(&self, step: &Step) -> Result<Vec<DeckLoad>, FeError> {
        let mut by_axis: [BTreeMap<u32, f64>; 3] = Default::default();
        for load in &step.point_loads {
            if load.axis > 2 {
                if load.value != 0.0 {
                    return Err(invalid(self.node_name(load.node), FeProblem::NodesDoNotTurn));
                }
                continue;
            }
            self.check_in_solid(load.node)?;
            if load.value != 0.0 && !self.on_surface[load.node as usize] {
                return Err(invalid(self.node_name(load.node), FeProblem::LoadInside));
            }
            *by_axis[load.axis as usize].entry(load.node).or_default() += load.value * self.newton();
        }
        // Each component is spread only over the faces whose nodes carry it, so that different loads on neighbouring places
        // do not mix.
        let mut carries: BTreeMap<u32, [bool; 3]> = BTreeMap::new();
        let mut tractions = vec![DVec3::ZERO; self.file.nodes.len()];
        let mut points: BTreeMap<u32, DVec3> = BTreeMap::new();
        for (axis, forces) in by_axis.iter().enumerate() {
            let mut listed = vec![false; self.file.nodes.len()];
            forces.keys().for_each(|&n| listed[n as usize] = true);
            let faces = self.faces_among(&listed, false);
            let (nodes, found) = self.traction(&faces, forces);
            if let Some(found) = found {
                nodes.iter().zip(found).for_each(|(&n, t)| tractions[n as usize][axis] = t);
                faces.iter().for_each(|&f| carries.entry(f).or_default()[axis] = true);
                nodes.iter().for_each(|&n| listed[n as usize] = false);
            }
            for (&n, &value) in forces.iter().filter(|(n, v)| listed[**n as usize] && **v != 0.0) {
                points.entry(n).or_default()[axis] += value;
            }
        }
        let faces: Vec<u32> = carries.keys().copied().collect();
        let mut loads = Vec::new();
        for group in self.connected(&faces) {
            let (mut triangles, mut corners_mpa) = (Vec::new(), Vec::new());
            // The components that the group carries at each node, so that the force of a shared node counts once.
            let mut forces: BTreeMap<u32, [bool; 3]> = BTreeMap::new();
            for &f in &group {
                let (mask, nodes) = (carries[&f], &self.faces[f as usize].nodes);
                let masked = |n: u32| {
                    let t = tractions[n as usize];
                    DVec3::from_array(std::array::from_fn(|k| if mask[k] { t[k] } else { 0.0 }))
                };
                for t in self.triangles(f) {
                    triangles.push(t.map(|(p, _)| p));
                    corners_mpa.push(t.map(|(_, w)| nodes.iter().zip(w).map(|(&n, w)| masked(n) * w).sum()));
                }
                for &n in nodes {
                    let taken = forces.entry(n).or_default();
                    (0..3).for_each(|k| taken[k] |= mask[k]);
                }
            }
            let (mut force_n, mut moment_nmm) = (DVec3::ZERO, DVec3::ZERO);
            for (n, taken) in forces {
                let of = |k: usize| if taken[k] { by_axis[k].get(&n).copied().unwrap_or(0.0) } else { 0.0 };
                let f = DVec3::from_array(std::array::from_fn(of));
                force_n += f;
                moment_nmm += self.at(n).cross(f);
            }
            loads.push(DeckLoad::Traction {
                triangles,
                corners_mpa,
                is_pressure: false,
                force_n,
                moment_nmm,
            });
        }
        if !points.is_empty() {
            loads.push(DeckLoad::Forces(points.into_iter().map(|(n, f)| (self.at(n), f)).collect()));
        }
        Ok(loads)
    }

    /// The nodes of these faces, and the traction at each node, MPa, whose consistent nodal forces are `forces_n`. The
    /// traction is `None` where the solver fails, as for faces without area.
    fn traction(&self, faces: &[u32], forces_n: &BTreeMap<u32, f64>) -> (Vec<u32>, Option<Vec<f64>>) {
        let mut nodes: Vec<u32> =
            faces.iter().flat_map(|&f| &self.faces[f as usize].nodes).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.is_empty() {
            return (nodes, None);
        }
        let index = |n: u32| nodes.binary_search(&n).map_or(0, |i| i as u32);
        let mass = Mass::new(self, faces, &index, nodes.len());
        let right: Vec<f64> = nodes.iter().map(|n| forces_n.get(n).copied().unwrap_or(0.0)).collect();
        let mut found = vec![0.0; nodes.len()];
        let settings = CgSettings::relative(&right, 1e-12, MAX_CG_STEPS);
        let (_, end) = conjugate_gradients(&mass, &right, &mut found, settings);
        let found = (end == CgEnd::Converged).then_some(found);
        (nodes, found)
    }

    fn pressures(&self, step: &Step) -> Result<Vec<DeckLoad>, FeError> {
        let mut by_face: BTreeMap<u32, f64> = BTreeMap::new();
        for load in &step.face_loads {
            let place = || {
                let element = self.deck.element_numbers[load.element as usize];
                format!("element {element}, face {}", load.face + 1)
            };
            if self.deck.behaviours[load.element as usize] != Behaviour::Solid {
                return Err(invalid(place(), FeProblem::PressureNotOnSolid));
            }
            let face = self.face_of_element.get(&(load.element, load.face));
            let face = face.ok_or_else(|| invalid(place(), FeProblem::PressureInside))?;
            *by_face.entry(*face).or_default() += load.pressure * self.mpa;
        }
        by_face.retain(|_, mpa| *mpa != 0.0);
        let faces: Vec<u32> = by_face.keys().copied().collect();
        let mut loads = Vec::new();
        for group in self.connected(&faces) {
            let (mut triangles, mut corners_mpa) = (Vec::new(), Vec::new());
            let (mut force_n, mut moment_nmm) = (DVec3::ZERO, DVec3::ZERO);
            for &f in &group {
                let mpa = by_face[&f];
                for t in self.triangles(f) {
                    let corners = t.map(|(p, _)| p);
                    let normal = triangle_normal(corners);
                    triangles.push(corners);
                    corners_mpa.push([-mpa * normal; 3]);
                }
                self.over_face(f, |_, p, area| {
                    force_n -= mpa * area;
                    moment_nmm -= p.cross(mpa * area);
                });
            }
            loads.push(DeckLoad::Traction { triangles, corners_mpa, is_pressure: true, force_n, moment_nmm });
        }
        Ok(loads)
    }

    /// Calls `at(weights of the nodes, position in mm, outward area vector in mm2)` at each quadrature point of a face.
    fn over_face(&self, face: u32, mut at: impl FnMut(&[f64; 8], DVec3, DVec3)) {
        let SurfaceFace { kind, nodes } = &self.faces[face as usize];
        for (x, weight) in rule(*kind) {
            let shape = kind.shape(x);
            let (mut p, mut sides) = (DVec3::ZERO, [DVec3::ZERO; 2]);
            let mut weights = [0.0; 8];
            for (k, &n) in nodes.iter().enumerate() {
                let q = self.at(n);
                weights[k] = shape.n[k];
                p += q * shape.n[k];
                sides[0] += q * shape.d[k].x;
                sides[1] += q * shape.d[k].y;
            }
            at(&weights, p, weight * sides[0].cross(sides[1]));
        }
    }

    fn body_loads(&self, step: &Step, name: &str) -> Result<Vec<DeckLoad>, FeError> {
        // Accelerations are added for each element, so that several keywords that each name some elements can make one load
        // on all.
        let mut gravity: BTreeMap<u32, DVec3> = BTreeMap::new();
        let mut turning: BTreeMap<[u64; 7], (usize, DeckLoad)> = BTreeMap::new();
        for load in &step.body_loads {
            match load.force {
                BodyForce::Gravity(a) => {
                    *gravity.entry(load.element).or_default() += DVec3::from(a) * self.mm
                }
                BodyForce::Centrifugal { speed_squared, point, axis } => {
                    let along = DVec3::from(axis).try_normalize();
                    let wrong = || invalid(name, FeProblem::NoAxis);
                    let axis = along.filter(|_| speed_squared >= 0.0).ok_or_else(wrong)?;
                    let point_mm = DVec3::from(point) * self.mm;
                    let rad_s = speed_squared.sqrt();
                    let [a, b, c] = point_mm.to_array();
                    let key = [rad_s, a, b, c, axis.x, axis.y, axis.z].map(f64::to_bits);
                    let load = DeckLoad::Centrifugal { point_mm, axis, rad_s };
                    turning.entry(key).or_insert((0, load)).0 += 1;
                }
            }
        }
        let on_part = |found: usize| FeProblem::OnPartOfIt { found, all: self.n_solids };
        let mut loads = Vec::new();
        gravity.retain(|_, a| *a != DVec3::ZERO);
        if let Some(&first) = gravity.values().next() {
            let alike = gravity.values().filter(|a| (**a - first).length() <= 1e-9 * first.length()).count();
            if alike != self.n_solids {
                return Err(invalid(format!("{name}, GRAV"), on_part(alike)));
            }
            loads.push(DeckLoad::Acceleration(first));
        }
        for (found, load) in turning.into_values() {
            if found != self.n_solids {
                return Err(invalid(format!("{name}, CENTRIF"), on_part(found)));
            }
            loads.push(load);
        }
        Ok(loads)
    }

    fn material(&self) -> Option<DeckMaterial> {
        let solids = (0u32..).zip(&self.file.elements).filter(|(_, e)| e.kind.dimension() == 3);
        let mut all = solids.map(|(i, _)| self.deck.section_of(i).map(|(m, _)| m));
        let first = all.next()??;
        if !all.all(|m| m == Some(first)) {
            return None;
        }
        let Some(Elastic::Isotropic { e, nu }) = first.elastic else { return None };
        // A density is a force times s2 over the fourth power of a length.
        let density_t_mm3 = first.density.map(|d| d * self.mpa / (self.mm * self.mm));
        Some(DeckMaterial { young_mpa: e * self.mpa, poisson: nu, density_t_mm3 })
    }
}

/// The mass matrix of some faces: integrals of the products of their shape functions, mm2.
struct Mass {
    /// For each face the indices of its nodes among the unknowns, and its integrals, row by row.
    faces: Vec<(Vec<u32>, [f64; 64])>,
    diagonal: Vec<f64>,
}

impl Mass {
    fn new(surface: &DeckSurface<'_>, faces: &[u32], index: &dyn Fn(u32) -> u32, n: usize) -> Self {
        let mut diagonal = vec![0.0; n];
        let mut all = Vec::with_capacity(faces.len());
        for &f in faces {
            let nodes: Vec<u32> = surface.faces[f as usize].nodes.iter().map(|&n| index(n)).collect();
            let mut products = [0.0; 64];
            surface.over_face(f, |weights, _, area| {
                let area = area.length();
                for (k, product) in products.iter_mut().enumerate() {
                    *product += weights[k / 8] * weights[k % 8] * area;
                }
            });
            nodes.iter().enumerate().for_each(|(k, &i)| diagonal[i as usize] += products[9 * k]);
            all.push((nodes, products));
        }
        Self { faces: all, diagonal }
    }
}

impl CgSystem<f64> for Mass {
    const PRECONDITIONED: bool = true;

    fn apply(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (nodes, products) in &self.faces {
            for (a, &i) in nodes.iter().enumerate() {
                let row = &products[8 * a..8 * a + nodes.len()];
                out[i as usize] += row.iter().zip(nodes).map(|(m, &j)| m * x[j as usize]).sum::<f64>();
            }
        }
    }

    fn precondition(&self, residual: &[f64], better: &mut [f64]) {
        better.iter_mut().zip(residual).zip(&self.diagonal).for_each(|((b, r), d)| *b = r / d);
    }
}

/// Gauss-Legendre quadrature with four points on 0..1, exact to degree 7: points and weights.
/// Source: derived: the roots of the fourth Legendre polynomial, `x2 = 3/7 -+ 2/7 sqrt(6/5)`.
const LINE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Quadrature of a face, exact for products of two quadratic shape functions on a straight face. On triangles a square is
/// collapsed onto one corner.
fn rule(kind: ElementKind) -> Vec<(DVec3, f64)> {
    let is_triangle = kind.n_corners() == 3;
    let at = |(u, a): (f64, f64), (v, b): (f64, f64)| match is_triangle {
        true => (DVec3::new(u, v * (1.0 - u), 0.0), a * b * (1.0 - u)),
        false => (DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0), 4.0 * a * b),
    };
    LINE.iter().flat_map(|&u| LINE.iter().map(move |&v| at(u, v))).collect()
}

/// Triangles that fill a face, in natural coordinates and with its winding. A plain triangle stays whole. Other faces are
/// cut, so that the triangles follow a curved face and a varying traction.
fn cut(kind: ElementKind) -> Vec<[DVec3; 3]> {
    let n: usize = if kind == ElementKind::Tri3 { 1 } else { 2 };
    let is_triangle = kind.n_corners() == 3;
    let at = |i: usize, j: usize| {
        let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
        if is_triangle { DVec3::new(u, v, 0.0) } else { DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0) }
    };
    let mut all = Vec::new();
    for i in 0..n {
        for j in 0..if is_triangle { n - i } else { n } {
            all.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if !is_triangle || i + j + 1 < n {
                all.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    all
}
