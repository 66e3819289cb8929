//! The contents of a finite-element file as every reader returns them, and the errors of the readers.

use grainpath_core::{DVec3, Warning};

use super::deck::Deck;
use super::element::{ElementKind, MAX_NODES};
use super::problem::FeProblem;
use crate::position::BadCoordinate;
use crate::text::TextError;

/// A format finite-element files are read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum FeFormat {
    Vtu,
    Vtk,
    Gmsh,
    Frd,
    Inp,
    Medit,
    Csv,
    /// STEP geometry: recognised in order to be refused with advice.
    Step,
    /// A binary result file of ANSYS: recognised in order to be refused with advice.
    AnsysRst,
}

impl FeFormat {
    /// The name shown to people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vtu => "VTU",
            Self::Vtk => "legacy VTK",
            Self::Gmsh => "Gmsh MSH",
            Self::Frd => "CalculiX FRD",
            Self::Inp => "Abaqus/CalculiX INP",
            Self::Medit => "Medit mesh",
            Self::Csv => "CSV",
            Self::Step => "STEP",
            Self::AnsysRst => "ANSYS RST",
        }
    }
}

/// One element. Nodes are numbered as VTK numbers them, see [`ElementKind`].
///
/// ```
/// use grainpath_core::DVec3;
/// use grainpath_io::fe::{Element, ElementKind};
/// let nodes = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let tetrahedron = Element::new(ElementKind::Tet4, &[0, 1, 2, 3]).expect("four nodes");
/// assert!((tetrahedron.size(&nodes) - 1.0 / 6.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Kind of the element.
    pub kind: ElementKind,
    nodes: [u32; MAX_NODES],
}

impl Element {
    /// An element over these node indices; `None` where there are fewer than the kind has. Further
    /// indices are ignored.
    pub fn new(kind: ElementKind, nodes: &[u32]) -> Option<Self> {
        let mut all = [0; MAX_NODES];
        all[..kind.n_nodes()].copy_from_slice(nodes.get(..kind.n_nodes())?);
        Some(Self { kind, nodes: all })
    }

    /// Indices of its nodes.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.kind.n_nodes()]
    }

    /// Indices of its corners.
    pub fn corners(&self) -> &[u32] {
        &self.nodes[..self.kind.n_corners()]
    }

    /// Volume of a solid or area of a surface, in the unit of the nodes.
    pub fn size(&self, nodes: &[DVec3]) -> f64 {
        let measure = |(x, weight): (DVec3, f64)| {
            let shape = self.kind.shape(x);
            let mut columns = [DVec3::ZERO; 3];
            for (&i, d) in self.nodes().iter().zip(&shape.d) {
                let p = nodes[i as usize];
                for k in 0..3 {
                    columns[k] += p * d[k];
                }
            }
            let [r, s, t] = columns;
            weight * if self.kind.dimension() == 2 { r.cross(s).length() } else { r.cross(s).dot(t) }
        };
        // The sum is negative for an element wound the other way round; its size is the absolute value.
        self.kind.quadrature().into_iter().map(measure).sum::<f64>().abs()
    }
}

/// Entities that the tuples of an array belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum On {
    Nodes,
    Elements,
}

/// An array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct FeArray {
    /// Name in the file.
    pub name: String,
    /// Entities that the tuples belong to.
    pub on: On,
    /// Numbers in a tuple.
    pub components: usize,
    /// Names of the components; empty when the file has none.
    pub component_names: Vec<String>,
    /// All numbers, tuple after tuple, in the file's unit. NaN where the file has none.
    pub values: Vec<f64>,
    /// Step of the analysis, from 1, where the file has several.
    pub step: Option<usize>,
}

/// A named group of nodes: a physical group, a set, a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Name of the group.
    pub name: String,
    /// Indices of its nodes, ascending.
    pub nodes: Vec<u32>,
}

/// A file as it was read, in its own units.
#[derive(Debug, Clone, PartialEq)]
pub struct FeFile {
    /// Format of the file.
    pub format: FeFormat,
    /// Positions in the file's unit.
    pub nodes: Vec<DVec3>,
    /// Surfaces and solids; points and lines are counted in [`FeFile::left_out`].
    pub elements: Vec<Element>,
    /// Every array on nodes or elements.
    pub arrays: Vec<FeArray>,
    /// Named groups of nodes.
    pub groups: Vec<Group>,
    /// Elements that are not read, counted by kind.
    pub left_out: Vec<(String, usize)>,
    /// Material, supports and loads of an INP deck.
    pub deck: Option<Box<Deck>>,
    /// Warnings about contents that are odd but readable.
    pub warnings: Vec<Warning>,
}

impl FeFile {
    pub(super) fn empty(format: FeFormat) -> Self {
        Self {
            format,
            nodes: Vec::new(),
            elements: Vec::new(),
            arrays: Vec::new(),
            groups: Vec::new(),
            left_out: Vec::new(),
            deck: None,
            warnings: Vec::new(),
        }
    }

    /// Counts an element that is not read.
    pub(super) fn leave_out(&mut self, what: &str) {
        match self.left_out.iter_mut().find(|(name, _)| name == what) {
            Some((_, n)) => *n += 1,
            None => self.left_out.push((what.to_owned(), 1)),
        }
    }

    /// Adds an element, or counts it where there is no kind for it. Returns whether it was added.
    pub(super) fn add(&mut self, kind: Result<ElementKind, &str>, nodes: &[u32]) -> bool {
        match kind.map(|k| Element::new(k, nodes)) {
            Ok(Some(element)) => {
                self.elements.push(element);
                true
            }
            Ok(None) => {
                self.leave_out("with too few nodes");
                false
            }
            Err(what) => {
                self.leave_out(what);
                false
            }
        }
    }

    /// Lowest and highest corner of the box around the nodes that elements use (all nodes where there are none).
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let grown = |(lo, hi): (DVec3, DVec3), p: DVec3| (lo.min(p), hi.max(p));
        // Unused nodes are common (centres of arcs, reference points) and would inflate the box.
        let used = self.elements.iter().flat_map(|e| e.nodes()).map(|&i| self.nodes[i as usize]);
        let start = |p: DVec3| (p, p);
        if self.elements.is_empty() {
            let first = *self.nodes.first()?;
            return Some(self.nodes.iter().copied().fold(start(first), grown));
        }
        let first = self.nodes[self.elements[0].nodes()[0] as usize];
        Some(used.fold(start(first), grown))
    }

    /// Number of elements of each kind, in the order of [`ElementKind::ALL`]; kinds that do not occur are
    /// left out.
    pub fn kinds(&self) -> Vec<(ElementKind, usize)> {
        let count = |k: ElementKind| (k, self.elements.iter().filter(|e| e.kind == k).count());
        ElementKind::ALL.into_iter().map(count).filter(|&(_, n)| n > 0).collect()
    }
}

/// Why a finite-element file cannot be used. `place` says where: a line, an array, an element.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum FeError {
    #[error("the file is empty")]
    Empty,
    #[error(
        "not a finite-element file: neither VTU, legacy VTK, Gmsh MSH, FRD, INP, Medit nor CSV with a header"
    )]
    Unknown,
    #[error(
        "a STEP file holds exact surfaces, neither a mesh nor a result; export STL or 3MF from the CAD program, or mesh it \
         with gmsh: gmsh part.step -3 -order 2 -o part.msh"
    )]
    Geometry,
    #[error(
        "an ANSYS result file, whose binary format is not published; export the stress as VTU, for example in Python: \
         from ansys.mapdl import reader; reader.read_binary(\"file.rst\").save_as_vtk(\"part.vtu\")"
    )]
    AnsysRst,
    #[error(transparent)]
    Text(#[from] TextError),
    #[error(transparent)]
    BadCoordinate(#[from] BadCoordinate),
    #[error("{place}: {problem}")]
    Invalid { place: String, problem: Box<FeProblem> },
    #[error("{what}: grainpath reads {reads}")]
    Unsupported { what: String, reads: &'static str },
    #[error("element {element}: node {node} does not exist")]
    NoSuchNode { element: String, node: i64 },
    #[error(
        "a file of the format {format} states no loads and supports; those are read from Abaqus and CalculiX decks (INP)"
    )]
    NoDeck { format: &'static str },
    #[error("no nodes in the file")]
    NoNodes,
    #[error("no stress in the file{arrays}")]
    NoStress { arrays: String },
    #[error("no array {name:?} in the file{arrays}")]
    NoSuchArray { name: String, arrays: String },
    #[error("more than {limit} {what}; grainpath reads no more")]
    TooMany { what: &'static str, limit: u64 },
}

pub(super) fn invalid(place: impl Into<String>, problem: FeProblem) -> FeError {
    FeError::Invalid { place: place.into(), problem: Box::new(problem) }
}

/// Limit on nodes, elements and groups of a file. Source: derived. Indices are 32 bits wide, and a mesh of this size takes
/// about 20 GB, more than any solver of parts needs.
pub(super) const MAX_COUNT: u64 = 200_000_000;

/// Checks a position as mesh readers do.
pub(super) fn position(p: [f64; 3], place: impl Fn() -> String) -> Result<DVec3, FeError> {
    Ok(crate::position::checked(p, place)?)
}

/// Numbers that all arrays of a file of this size may hold together, after missing tuples are filled with
/// NaN. Eight numbers a byte leave room for sparse results and bound the memory at 64 times the file.
pub(super) fn array_capacity(n_bytes: usize) -> usize {
    n_bytes.saturating_mul(8).max(1 << 20)
}
