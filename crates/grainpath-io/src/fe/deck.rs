//! What an INP deck says beyond its mesh: sets, material, sections, supports and loads.

use std::collections::BTreeMap;

use grainpath_core::DVec3;

use super::{Element, ElementKind, FeError, FeFile, invalid};

/// How elements carry load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Behaviour {
    Solid,
    PlaneStress,
    PlaneStrain,
    Axisymmetric,
    Shell,
}

/// Linear elastic constants, in the deck's unit of stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Elastic {
    /// The same in all directions.
    Isotropic {
        /// Young's modulus.
        e: f64,
        /// Poisson's ratio.
        nu: f64,
    },
    /// Engineering constants along the axes.
    Orthotropic {
        /// `E1, E2, E3`.
        e: [f64; 3],
        /// `nu12, nu13, nu23`.
        nu: [f64; 3],
        /// `G12, G13, G23`.
        g: [f64; 3],
    },
}

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// Its constants, where given in a way that is read.
    pub elastic: Option<Elastic>,
    /// Mass per volume in the deck's units.
    pub density: Option<f64>,
}

/// Which elements are of which material.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name of the element set.
    pub elements: String,
    /// Name of the material.
    pub material: String,
    /// Thickness of plane elements and shells; `None` where not given.
    pub thickness: Option<f64>,
}

/// A prescribed displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fixed {
    /// Index of the node.
    pub node: u32,
    /// 0, 1, 2 for x, y, z; 3 to 5 for rotations.
    pub axis: u8,
    /// How far, in the deck's unit of length.
    pub value: f64,
}

/// A force on a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLoad {
    /// Index of the node.
    pub node: u32,
    /// 0, 1, 2 for x, y, z; 3 to 5 for moments.
    pub axis: u8,
    /// Force in the deck's unit.
    pub value: f64,
}

/// A pressure on a face of an element (an edge of a plane one), positive when it pushes inwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceLoad {
    /// Index of the element.
    pub element: u32,
    /// Index into [`super::ElementKind::faces`].
    pub face: u8,
    /// Pressure in the deck's unit of stress.
    pub pressure: f64,
}

/// A load on the volume of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyLoad {
    /// Index of the element.
    pub element: u32,
    /// Acceleration (times density) in the deck's units.
    pub acceleration: [f64; 3],
}

/// A step of the analysis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// The procedure: `STATIC`, `FREQUENCY`, ...; empty when none is given.
    pub procedure: String,
    /// Whether large deformations are asked for.
    pub nlgeom: bool,
    /// Supports that begin here.
    pub fixed: Vec<Fixed>,
    /// Forces on nodes.
    pub point_loads: Vec<PointLoad>,
    /// Pressures.
    pub face_loads: Vec<FaceLoad>,
    /// Loads on volumes.
    pub body_loads: Vec<BodyLoad>,
}

/// A deck without its mesh, which is in [`super::FeFile`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// First line of the heading.
    pub heading: String,
    /// The number the file gives each node.
    pub node_numbers: Vec<i64>,
    /// The number the file gives each element.
    pub element_numbers: Vec<i64>,
    /// How each element carries load.
    pub behaviours: Vec<Behaviour>,
    /// Node sets by name (upper case), indices ascending.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Element sets by name (upper case), indices ascending.
    pub element_sets: BTreeMap<String, Vec<u32>>,
    /// Surfaces by name (upper case): element and face.
    pub surfaces: BTreeMap<String, Vec<(u32, u8)>>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Sections.
    pub sections: Vec<Section>,
    /// Supports before all steps.
    pub fixed: Vec<Fixed>,
    /// Steps.
    pub steps: Vec<Step>,
    /// Keywords that change the result and are not read, each once.
    pub ignored: Vec<String>,
}

impl Deck {
    /// The material and thickness of an element, by the last section that holds it.
    pub fn section_of(&self, element: u32) -> Option<(&Material, Option<f64>)> {
        let holds = |s: &&Section| {
            self.element_sets.get(&s.elements).is_some_and(|set| set.binary_search(&element).is_ok())
        };
        let section = self.sections.iter().rev().find(holds)?;
        let material = self.materials.iter().find(|m| m.name == section.material)?;
        Some((material, section.thickness))
    }
}

impl FeFile {
    /// The forces of a deck's step on every node, in the deck's unit of force: forces on nodes as they are, pressures
    /// and gravity by the shape functions. Moments are left out; the nodes of solids do not turn.
    ///
    /// # Errors
    /// No such step, axisymmetric elements, or a plane element without thickness under load.
    pub fn nodal_forces(&self, step: usize) -> Result<Vec<DVec3>, FeError> {
        let deck = self.deck.as_deref();
        let (deck, step) = deck
            .and_then(|d| Some((d, d.steps.get(step)?)))
            .ok_or_else(|| invalid(format!("step {}", step + 1), "the file has no such step"))?;
        let mut forces = vec![DVec3::ZERO; self.nodes.len()];
        for load in step.point_loads.iter().filter(|l| l.axis < 3) {
            forces[load.node as usize][load.axis as usize] += load.value;
        }
        for load in &step.face_loads {
            let e = &self.elements[load.element as usize];
            let Some((kind, nodes)) = face_of(e, load.face as usize) else { continue };
            // An element wound the other way round has its outside on the other side.
            let sign = -load.pressure * self.thickness(deck, load.element)? * self.winding(e);
            for (x, weight) in kind.quadrature() {
                let shape = kind.shape(x);
                let column = |k: usize| {
                    nodes.iter().zip(shape.d).map(|(&i, d)| self.nodes[i as usize] * d[k]).sum::<DVec3>()
                };
                let normal = column(0).cross(column(1));
                for (&i, n) in nodes.iter().zip(shape.n) {
                    forces[i as usize] += sign * weight * n * normal;
                }
            }
        }
        for load in &step.face_loads {
            let e = &self.elements[load.element as usize];
            let Some(nodes) = edge_of(e, load.face as usize) else { continue };
            let sign = -load.pressure * self.thickness(deck, load.element)? * self.winding(e);
            let p = |k: usize| self.nodes[nodes[k] as usize];
            // Three points along a parabola, exact to degree 5.
            let far = 0.6f64.sqrt();
            for (t, weight) in [(-far, 5.0 / 9.0), (0.0, 8.0 / 9.0), (far, 5.0 / 9.0)] {
                let (n, d) = if nodes.len() == 3 {
                    ([0.5 * t * (t - 1.0), 0.5 * t * (t + 1.0), 1.0 - t * t], [t - 0.5, t + 0.5, -2.0 * t])
                } else {
                    ([0.5 * (1.0 - t), 0.5 * (1.0 + t), 0.0], [-0.5, 0.5, 0.0])
                };
                let along = (0..nodes.len()).map(|k| d[k] * p(k)).sum::<DVec3>();
                let normal = DVec3::new(along.y, -along.x, 0.0);
                for (k, &i) in nodes.iter().enumerate() {
                    forces[i as usize] += sign * weight * n[k] * normal;
                }
            }
        }
        for load in &step.body_loads {
            let e = &self.elements[load.element as usize];
            let density = deck.section_of(load.element).and_then(|(m, _)| m.density).unwrap_or(0.0);
            let size = e.size(&self.nodes) * density * self.thickness(deck, load.element)?;
            // Weights of the middle of each Gauss point, by its share of the volume.
            let points = e.kind.quadrature();
            let whole: f64 = points.iter().map(|p| p.1).sum();
            for (x, weight) in points {
                for (&i, n) in e.nodes().iter().zip(e.kind.weights(x)) {
                    forces[i as usize] += size * weight / whole * n * DVec3::from(load.acceleration);
                }
            }
        }
        Ok(forces)
    }

    /// Thickness of a plane element; 1 for solids.
    fn thickness(&self, deck: &Deck, element: u32) -> Result<f64, FeError> {
        let place = || format!("element {}", deck.element_numbers[element as usize]);
        match deck.behaviours[element as usize] {
            Behaviour::Solid => Ok(1.0),
            Behaviour::Axisymmetric => Err(FeError::Unsupported {
                what: format!("{}: axisymmetric", place()),
                reads: "plane and solid elements",
            }),
            _ => match deck.section_of(element) {
                Some((_, thickness)) => Ok(thickness.unwrap_or(1.0)),
                None => Err(invalid(place(), "has no section")),
            },
        }
    }

    /// 1 where the nodes run as they should, -1 where the other way round.
    fn winding(&self, e: &Element) -> f64 {
        let shape = e.kind.shape(e.kind.centre());
        let column = |k: usize| {
            e.nodes().iter().zip(shape.d).map(|(&i, d)| self.nodes[i as usize] * d[k]).sum::<DVec3>()
        };
        let normal = column(0).cross(column(1));
        let size = if e.kind.dimension() == 2 { normal.z } else { normal.dot(column(2)) };
        if size < 0.0 { -1.0 } else { 1.0 }
    }
}

/// The face of a solid as a surface element of its own, seen from outside.
fn face_of(e: &Element, face: usize) -> Option<(ElementKind, Vec<u32>)> {
    if e.kind.dimension() != 3 {
        return None;
    }
    let corners = e.kind.faces().get(face)?;
    let n = corners.len();
    let mut nodes: Vec<u32> = corners.iter().map(|&i| e.nodes()[i]).collect();
    nodes.extend((0..n).filter_map(|i| middle(e, corners[i], corners[(i + 1) % n])));
    let kind = match nodes.len() {
        3 => ElementKind::Tri3,
        4 => ElementKind::Quad4,
        6 => ElementKind::Tri6,
        8 => ElementKind::Quad8,
        _ => return None,
    };
    Some((kind, nodes))
}

/// An edge of a plane element: its ends and, where there is one, its middle.
fn edge_of(e: &Element, edge: usize) -> Option<Vec<u32>> {
    if e.kind.dimension() != 2 {
        return None;
    }
    let &[a, b] = *e.kind.faces().get(edge)? else { return None };
    let mut nodes = vec![e.nodes()[a], e.nodes()[b]];
    nodes.extend(middle(e, a, b));
    Some(nodes)
}

/// The node in the middle of the edge between two corners.
fn middle(e: &Element, a: usize, b: usize) -> Option<u32> {
    let k = e.kind.edges().iter().position(|edge| *edge == [a, b] || *edge == [b, a])?;
    e.nodes().get(e.kind.n_corners() + k).copied()
}
