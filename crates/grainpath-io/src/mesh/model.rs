//! The result of every mesh reader, its errors, and the builder that the readers share.

use grainpath_core::mesh::VertexWelder;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, TriMesh, Warning};

use crate::position::BadCoordinate;
use crate::text::TextError;

/// A mesh format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum MeshFormat {
    StlBinary,
    StlAscii,
    Obj,
    Ply,
    Off,
    ThreeMf,
}

impl MeshFormat {
    /// The name shown to people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::StlBinary => "binary STL",
            Self::StlAscii => "ASCII STL",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::ThreeMf => "3MF",
        }
    }
}

/// One body of a file: a solid of an ASCII STL, an item of a 3MF build. Files of the other formats hold one body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshBody {
    /// The name that the file gives the body.
    pub name: Option<String>,
    /// The surface in the file's unit; equal vertices are merged.
    pub mesh: TriMesh,
    /// Support enforcers and blockers painted on the surface, in the file's unit. Only 3MF carries them.
    pub painted_supports: PaintedSupports,
}

/// Facets that a user painted as support enforcers or blockers: loose triangles that lie on the surface of a body.
///
/// ```
/// use grainpath_core::DVec3;
/// let mut painted = grainpath_io::PaintedSupports::default();
/// painted.enforcers.vertices.extend([DVec3::ZERO, DVec3::X, DVec3::Y]);
/// painted.enforcers.triangles.push([0, 1, 2]);
/// // Enforcers and blockers move with the body that they are painted on.
/// for facets in painted.each_mut() {
///     facets.vertices.iter_mut().for_each(|p| p.z += 5.0);
/// }
/// assert_eq!(painted.enforcers.vertices[0].z, 5.0);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PaintedSupports {
    /// Facets painted as support enforcers: supports hold them at any overhang angle.
    pub enforcers: TriMesh,
    /// Facets painted as support blockers: supports never touch them.
    pub blockers: TriMesh,
}

impl PaintedSupports {
    /// Enforcers and blockers, for operations that treat both alike.
    pub fn each_mut(&mut self) -> [&mut TriMesh; 2] {
        [&mut self.enforcers, &mut self.blockers]
    }
}

/// A volume in which a project of another slicer has settings of its own. It is no part of the solid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModifierVolume {
    /// The name that the project gives it.
    pub name: Option<String>,
    /// Its surface in the file's unit, where the body is.
    pub mesh: TriMesh,
    /// Keys and values of its settings, as the project has them.
    pub settings: Vec<(String, String)>,
}

/// The bodies of a part, as a mesh file holds them.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// At least one body, each with triangles.
    pub bodies: Vec<MeshBody>,
    /// The unit that the file states; `None` where the format has none.
    pub unit: Option<LengthUnit>,
    /// Modifier volumes. Only 3MF carries them.
    pub modifiers: Vec<ModifierVolume>,
    /// Warnings about contents that are odd but readable.
    pub warnings: Vec<Warning>,
}

/// Why a mesh cannot be read. `place` says where: a line, a facet, a part of an archive.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum MeshError {
    #[error("the file is empty")]
    Empty,
    #[error("not a mesh: neither STL, OBJ, PLY, OFF nor 3MF")]
    Unknown,
    #[error(
        "a {format} file holds exact surfaces, not triangles; install gmsh, through which grainpath reads it (Debian: apt \
         install gmsh), or export STL or 3MF from the CAD program"
    )]
    ExactSurfaces { format: &'static str },
    #[error("{format} is not read; export STL, OBJ, PLY or 3MF instead")]
    NotRead { format: &'static str },
    #[error("binary STL is cut short: the header promises {promised} facets, the file holds {held}")]
    Truncated { promised: u64, held: u64 },
    #[error(transparent)]
    Text(#[from] TextError),
    #[error(transparent)]
    BadCoordinate(#[from] BadCoordinate),
    #[error("{place}: vertex {index} does not exist; there are {n_vertices}")]
    NoSuchVertex { place: String, index: i64, n_vertices: usize },
    #[error("{place}: a face of {n} corners; a face needs 3 to 65535")]
    BadFace { place: String, n: u64 },
    #[error("no triangles in the file{hints}")]
    NoTriangles { hints: String },
    #[error("more than {limit} {what}; grainpath reads no more")]
    TooMany { what: &'static str, limit: u64 },
    #[error("{place}: {problem}")]
    Invalid { place: String, problem: Box<MeshProblem> },
}

/// What is wrong at the place that [`MeshError::Invalid`] names.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum MeshProblem {
    // PLY.
    #[error("a property before any element")]
    PropertyFirst,
    #[error("no `format` line")]
    NoFormat,
    #[error("element {element} has {rows} rows and no properties")]
    NoProperties { element: String, rows: u64 },
    // 3MF.
    /// The ZIP or XML reader's own words.
    #[error("{0}")]
    Reader(String),
    #[error("the archive has no such part")]
    NoPart,
    #[error("inflates to more than {limit} bytes; refused as a zip bomb")]
    Bomb { limit: u64 },
    #[error("no 3D model part is named (3MF core 2.1.1)")]
    NoModelPart,
    #[error("more than one 3D model part is named (3MF core 2.1.2)")]
    ModelParts,
    #[error("more than {0} relationships")]
    Relationships(usize),
    #[error("a document type definition, which 3MF forbids (3MF core 2.3.2)")]
    DocumentType,
    #[error("the XML ends in the middle")]
    Ends,
    #[error("unit {0:?} is not one of 3MF's")]
    Unit(String),
    #[error("an object without an id")]
    ObjectWithoutId,
    #[error("no <model> element (3MF core 3.4)")]
    NoModel,
    #[error("more than one <model> element (3MF core 3.4)")]
    Models,
    #[error("no <resources> element (3MF core 3.4)")]
    NoResources,
    #[error("no objectid where one is needed (3MF core 3.4.3.1, 4.2.1)")]
    NoObjectId,
    #[error("transform {0:?} is not 12 numbers (3MF core 3.3)")]
    Transform(String),
    #[error("components of object {id} are nested deeper than {max}, or in a circle (3MF core 3.4)")]
    Nested { id: u32, max: usize },
    #[error("{axis} is {text:?}, which is not a number such as 5.0")]
    NotNumber { axis: char, text: String },
    #[error("object {0} is used and does not exist (3MF core 3.4.3.1, 4.2.1)")]
    NoObject(u32),
}

/// Limit on vertices and on triangles of every reader. Source: derived. Indices have 32 bits; a mesh of this size takes
/// about 7 GB.
pub(crate) const MAX_ELEMENTS: u64 = 200_000_000;
/// Builds a body from triangles given by their corners, and merges corners with equal coordinates.
pub(crate) struct SoupBuilder {
    welder: VertexWelder,
    triangles: Vec<[u32; 3]>,
}

impl SoupBuilder {
    pub(crate) fn with_capacity(n_triangles: usize) -> Self {
        // Euler's formula: a closed mesh has about half as many vertices as triangles.
        Self {
            welder: VertexWelder::with_capacity(n_triangles / 2 + 4),
            triangles: Vec::with_capacity(n_triangles),
        }
    }

    pub(crate) fn index(&mut self, p: DVec3) -> Result<u32, MeshError> {
        self.welder.index(p).ok_or(MeshError::TooMany { what: "vertices", limit: u64::from(u32::MAX) })
    }

    pub(crate) fn push(&mut self, triangle: [u32; 3]) -> Result<(), MeshError> {
        if self.triangles.len() as u64 >= MAX_ELEMENTS {
            return Err(MeshError::TooMany { what: "triangles", limit: MAX_ELEMENTS });
        }
        self.triangles.push(triangle);
        Ok(())
    }

    pub(crate) fn finish(self, name: Option<String>) -> MeshBody {
        let mesh = TriMesh { vertices: self.welder.into_vertices(), triangles: self.triangles };
        MeshBody { name, mesh, painted_supports: PaintedSupports::default() }
    }
}

/// Makes a body of indexed faces, as OFF and PLY have them, and merges equal vertices.
pub(super) fn merge(mesh: TriMesh) -> Result<MeshBody, MeshError> {
    let mut soup = SoupBuilder::with_capacity(mesh.triangles.len());
    // Many exporters write each face with corners of its own. Without merging no edge would be shared and
    // every mesh would count as open.
    let merged = mesh.vertices.iter().map(|&p| soup.index(p)).collect::<Result<Vec<u32>, MeshError>>()?;
    for t in mesh.triangles {
        soup.push(t.map(|i| merged[i as usize]))?;
    }
    Ok(soup.finish(None))
}

/// Cuts a face with any number of corners into triangles by ear clipping. Where no ear is found, the rest
/// becomes a fan.
pub(crate) fn triangulate(corners: &[u32], position: impl Fn(u32) -> DVec3, mut emit: impl FnMut([u32; 3])) {
    if let &[a, b, c] = corners {
        return emit([a, b, c]);
    }
    let n = corners.len();
    // Newell's normal (`ericson2005`), which is right for every planar face, convex or not.
    let normal = (0..n).fold(DVec3::ZERO, |sum, i| {
        let (p, q) = (position(corners[i]), position(corners[(i + 1) % n]));
        sum + (p - q).cross(p + q)
    });
    let turn = |a: u32, b: u32, c: u32| {
        let (a, b, c) = (position(a), position(b), position(c));
        (b - a).cross(c - b).dot(normal)
    };
    let mut ring: Vec<u32> = corners.to_vec();
    // Ear clipping takes quadratic time, so faces of more than 256 corners become fans. Such faces are
    // discs and caps, which are convex.
    while ring.len() > 3 && n <= 256 {
        let m = ring.len();
        // An ear is a convex corner whose triangle holds no other corner.
        let ear = (0..m).find(|&i| {
            let (a, b, c) = (ring[(i + m - 1) % m], ring[i], ring[(i + 1) % m]);
            let inside = |&p: &u32| {
                p != a
                    && p != b
                    && p != c
                    && turn(a, b, p) >= 0.0
                    && turn(b, c, p) >= 0.0
                    && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 0.0 && !ring.iter().any(inside)
        });
        // A face that crosses itself may have no ear; the fan below keeps the surface closed all the
        // same.
        let Some(i) = ear else { break };
        emit([ring[(i + m - 1) % m], ring[i], ring[(i + 1) % m]]);
        ring.remove(i);
    }
    for i in 1..ring.len().saturating_sub(1) {
        emit([ring[0], ring[i], ring[i + 1]]);
    }
}
