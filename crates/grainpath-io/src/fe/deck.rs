//! The contents of an INP deck besides its mesh: sets, material, sections, supports and loads.

use std::collections::BTreeMap;

/// Mechanical model of elements.
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
    /// Name of the material.
    pub name: String,
    /// Elastic constants; `None` where the deck gives them in a form that is not read.
    pub elastic: Option<Elastic>,
    /// Mass per volume in the deck's units.
    pub density: Option<f64>,
}

/// Assigns a material to a set of elements.
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
    /// Prescribed displacement or rotation, in the deck's units.
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
    /// Index into [`super::element::ElementKind::faces`].
    pub face: u8,
    /// Pressure in the deck's unit of stress.
    pub pressure: f64,
}

/// Kind of a body force. The force per volume is an acceleration times the density of the element's material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BodyForce {
    /// An acceleration in the deck's units.
    Gravity([f64; 3]),
    /// Rotation about an axis, which accelerates outwards.
    Centrifugal {
        /// Square of the angular speed, 1/s2.
        speed_squared: f64,
        /// A point of the axis, in the deck's units.
        point: [f64; 3],
        /// A vector along the axis, of any length.
        axis: [f64; 3],
    },
}

/// A load on the volume of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyLoad {
    /// Index of the element.
    pub element: u32,
    /// The body force that acts on the element's mass.
    pub force: BodyForce,
}

/// A step of the analysis. Its loads are all that act at its end, including those kept from earlier steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// The procedure: `STATIC`, `FREQUENCY`, ...; empty when none is given.
    pub procedure: String,
    /// Whether large deformations are asked for.
    pub nlgeom: bool,
    /// Whether the step removes all earlier supports (`*BOUNDARY, OP=NEW`).
    pub releases: bool,
    /// Supports that begin here.
    pub fixed: Vec<Fixed>,
    /// Forces on nodes.
    pub point_loads: Vec<PointLoad>,
    /// Pressures.
    pub face_loads: Vec<FaceLoad>,
    /// Loads on volumes.
    pub body_loads: Vec<BodyLoad>,
}

/// A deck without its mesh, which is in [`super::model::FeFile`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// First line of the heading.
    pub heading: String,
    /// The number the file gives each node.
    pub node_numbers: Vec<i64>,
    /// The number the file gives each element.
    pub element_numbers: Vec<i64>,
    /// Mechanical model of each element.
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
    /// Keywords that change the result and are not supported; each is named once.
    pub ignored: Vec<String>,
}

impl Deck {
    /// The material and thickness of an element, by the last section that holds it.
    pub fn section_of(&self, element: u32) -> Option<(&Material, Option<f64>)> {
        let holds = |s: &&Section| {
            self.element_sets.get(&s.elements).is_some_and(|set| set.binary_search(&element).is_ok())
        };
        // Abaqus and CalculiX let a later section overwrite an earlier one, so the search runs from the
        // end.
        let section = self.sections.iter().rev().find(holds)?;
        let material = self.materials.iter().find(|m| m.name == section.material)?;
        Some((material, section.thickness))
    }
}
