//! What every mesh reader gives and how it fails.

use grainpath_core::mesh::VertexWelder;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, TriMesh};

/// A format meshes are read from.
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

/// One body of a file: a solid of an ASCII STL, an item of a 3MF build; other formats have one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Body {
    /// What the file calls it.
    pub name: Option<String>,
    /// In the file's unit, equal vertices merged.
    pub mesh: TriMesh,
    /// What is painted on it, in the same place; only 3MF has such marks.
    pub marks: Marks,
}

/// Where supports are wanted and where not, painted on the surface: loose triangles that lie on it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Marks {
    /// Held, whatever the angle.
    pub enforce: TriMesh,
    /// Not held.
    pub block: TriMesh,
}

impl Marks {
    /// Both, for what is done to each alike.
    pub fn each_mut(&mut self) -> [&mut TriMesh; 2] {
        [&mut self.enforce, &mut self.block]
    }
}

/// What was read.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// What it was read as.
    pub format: MeshFormat,
    /// At least one, each with triangles.
    pub bodies: Vec<Body>,
    /// The unit the file states; `None` where the format has none.
    pub unit: Option<LengthUnit>,
    /// What was odd but could be read.
    pub warnings: Vec<String>,
}

/// Why a mesh cannot be read. `place` says where: a line, a facet, a part of an archive.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum MeshError {
    #[error("the file is empty")]
    Empty,
    #[error("not a mesh: neither STL, OBJ, PLY, OFF nor 3MF")]
    Unknown,
    #[error("binary STL is cut short: the header promises {promised} facets, the file holds {held}")]
    Truncated { promised: u64, held: u64 },
    #[error("{place}: found {found:?} where {wanted} should be")]
    Syntax { place: String, found: String, wanted: &'static str },
    #[error("{place}: the file ends where {wanted} should be")]
    UnexpectedEnd { place: String, wanted: &'static str },
    #[error("{place}: coordinate {value} is not a finite number below 1e9")]
    BadCoordinate { place: String, value: f64 },
    #[error("{place}: vertex {index} does not exist; there are {n_vertices}")]
    NoSuchVertex { place: String, index: i64, n_vertices: usize },
    #[error("{place}: a face of {n} corners; a face needs 3 to 65535")]
    BadFace { place: String, n: u64 },
    #[error("no triangles in the file{hints}")]
    NoTriangles { hints: String },
    #[error("more than {limit} {what}; grainpath reads no more")]
    TooMany { what: &'static str, limit: u64 },
    #[error("{place}: {problem}")]
    Invalid { place: String, problem: String },
}

/// No reader makes more vertices or triangles than this.
pub(crate) const MAX_ELEMENTS: u64 = 200_000_000;
/// Coordinates beyond this are damage, whatever the unit.
const MAX_COORDINATE: f64 = 1e9;

/// Checks a position read from a file.
pub(crate) fn checked(p: [f64; 3], place: impl Fn() -> String) -> Result<DVec3, MeshError> {
    match p.into_iter().find(|c| c.is_nan() || c.abs() > MAX_COORDINATE) {
        Some(value) => Err(MeshError::BadCoordinate { place: place(), value }),
        None => Ok(DVec3::from(p)),
    }
}

/// Reads a mesh of any format. The format is told from the content; `name` (a file name) decides only between text
/// formats that begin alike.
///
/// # Errors
/// [`MeshError`] with what is wrong and where.
pub fn parse_mesh(bytes: &[u8], name: Option<&str>) -> Result<MeshFile, MeshError> {
    if bytes.is_empty() {
        return Err(MeshError::Empty);
    }
    let mut file = match sniff_mesh(bytes, name).ok_or(MeshError::Unknown)? {
        MeshFormat::StlBinary => crate::stl::read_binary(bytes)?,
        MeshFormat::StlAscii => crate::stl::read_ascii(bytes)?,
        MeshFormat::Obj => crate::obj::read(bytes)?,
        MeshFormat::Ply => crate::ply::read(bytes)?,
        MeshFormat::Off => crate::off::read(bytes)?,
        MeshFormat::ThreeMf => crate::threemf::read(bytes)?,
    };
    file.bodies.retain(|b| !b.mesh.triangles.is_empty());
    if file.bodies.is_empty() {
        return Err(MeshError::NoTriangles {
            hints: file.warnings.iter().map(|w| format!("; {w}")).collect(),
        });
    }
    Ok(file)
}

/// The format of these bytes, if they can be a mesh.
pub fn sniff_mesh(bytes: &[u8], name: Option<&str>) -> Option<MeshFormat> {
    let extension = name.and_then(|n| n.rsplit_once('.')).map(|(_, e)| e.to_ascii_lowercase());
    let is = |e: &str| extension.as_deref() == Some(e);
    let starts =
        |word: &str| bytes.get(..word.len()).is_some_and(|b| b.eq_ignore_ascii_case(word.as_bytes()));
    if starts("PK\x03\x04") {
        return Some(MeshFormat::ThreeMf);
    }
    if starts("ply\n") || starts("ply\r") {
        return Some(MeshFormat::Ply);
    }
    // By size, not by the word: many binary STL headers begin with "solid".
    if crate::stl::has_binary_size(bytes) {
        return Some(MeshFormat::StlBinary);
    }
    let text = crate::text::skip_space(bytes);
    let word = |w: &str| text.get(..w.len()).is_some_and(|b| b.eq_ignore_ascii_case(w.as_bytes()));
    if word("solid") || (is("stl") && word("facet")) {
        return Some(MeshFormat::StlAscii);
    }
    if ["OFF", "COFF", "NOFF", "CNOFF", "STOFF"].iter().any(|w| word(w)) {
        return Some(MeshFormat::Off);
    }
    if is("obj") || ((word("v ") || word("#") || word("o ") || word("mtllib")) && bytes.is_ascii()) {
        return Some(MeshFormat::Obj);
    }
    // What is left cannot be text: a binary STL that was cut short, if the name says so.
    (is("stl") && bytes.len() < 84 || crate::stl::is_cut_short(bytes, is("stl")))
        .then_some(MeshFormat::StlBinary)
}

/// Builds a body out of triangles given by their corners, merging equal ones.
pub(crate) struct SoupBuilder {
    welder: VertexWelder,
    triangles: Vec<[u32; 3]>,
}

impl SoupBuilder {
    pub(crate) fn with_capacity(n_triangles: usize) -> Self {
        // A closed mesh has about half as many vertices as triangles.
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

    pub(crate) fn finish(self, name: Option<String>) -> Body {
        let mesh = TriMesh { vertices: self.welder.into_vertices(), triangles: self.triangles };
        Body { name, mesh, marks: Marks::default() }
    }
}

/// Cuts a face with any number of corners into triangles: a fan for convex ones, ears else.
pub(crate) fn triangulate(corners: &[u32], position: impl Fn(u32) -> DVec3, mut emit: impl FnMut([u32; 3])) {
    if let &[a, b, c] = corners {
        return emit([a, b, c]);
    }
    let n = corners.len();
    // Newell's normal: right for any planar face, convex or not.
    let normal = (0..n).fold(DVec3::ZERO, |sum, i| {
        let (p, q) = (position(corners[i]), position(corners[(i + 1) % n]));
        sum + (p - q).cross(p + q)
    });
    let turn = |a: u32, b: u32, c: u32| {
        let (a, b, c) = (position(a), position(b), position(c));
        (b - a).cross(c - b).dot(normal)
    };
    let mut ring: Vec<u32> = corners.to_vec();
    // Faces of a few hundred corners and more are cut as fans: ear clipping is quadratic.
    while ring.len() > 3 && n <= 256 {
        let m = ring.len();
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
        let Some(i) = ear else { break };
        emit([ring[(i + m - 1) % m], ring[i], ring[(i + 1) % m]]);
        ring.remove(i);
    }
    for i in 1..ring.len().saturating_sub(1) {
        emit([ring[0], ring[i], ring[i + 1]]);
    }
}
