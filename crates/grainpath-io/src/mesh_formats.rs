//! Recognises the format of a mesh file and calls the reader of that format.

use std::io::{self, BufReader, Read};

use crate::mesh::model::{MeshError, MeshFile, MeshFormat};
use crate::mesh::{obj, off, ply, stl};
use crate::text::skip_space;
use crate::threemf;

/// Reads a mesh of any format. The content decides the format; `name` (a file name) decides only between
/// text formats that begin alike.
///
/// # Errors
/// [`MeshError`] with what is wrong and where.
///
/// ```
/// let obj = b"v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
/// let file = grainpath_io::parse_mesh(obj, Some("corner.obj"))?;
/// assert_eq!(file.bodies[0].mesh.vertices.len(), 4);
/// let error = grainpath_io::parse_mesh(b"v 0 0 0\nf 1 2 3\n", Some("broken.obj")).unwrap_err();
/// assert_eq!(error.to_string(), "line 2: vertex 2 does not exist; there are 1");
/// # Ok::<(), grainpath_io::MeshError>(())
/// ```
pub fn parse_mesh(bytes: &[u8], name: Option<&str>) -> Result<MeshFile, MeshError> {
    if bytes.is_empty() {
        return Err(MeshError::Empty);
    }
    if let Some(error) = known_and_not_read(bytes) {
        return Err(error);
    }
    let file = match sniff_mesh(bytes, name).ok_or(MeshError::Unknown)? {
        // A header cut short is the only read that can fail in memory.
        MeshFormat::StlBinary => stl::read_binary(bytes, bytes.len() as u64)
            .unwrap_or(Err(MeshError::Truncated { promised: 0, held: 0 }))?,
        MeshFormat::StlAscii => stl::read_ascii(bytes)?,
        MeshFormat::Obj => obj::read(bytes)?,
        MeshFormat::Ply => ply::read(bytes)?,
        MeshFormat::Off => off::read(bytes)?,
        MeshFormat::ThreeMf => threemf::read(bytes)?,
    };
    with_triangles(file)
}

/// Reads a binary STL from a file of `n_bytes` bytes facet by facet, so that it is never in memory as a whole; `None` if the
/// file has another format, which [`parse_mesh`] reads.
///
/// # Errors
/// Errors of `file`; inside, as [`parse_mesh`].
///
/// ```
/// let mut stl = vec![0; 80];
/// stl.extend(1u32.to_le_bytes());
/// stl.extend([0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
/// stl.extend([0, 0]);
/// let read = grainpath_io::read_binary_stl(&stl[..], stl.len() as u64)?.expect("a binary STL")?;
/// assert_eq!(read.bodies[0].mesh.triangles, [[0, 1, 2]]);
/// assert!(grainpath_io::read_binary_stl(&b"solid part"[..], 10)?.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_binary_stl(mut file: impl Read, n_bytes: u64) -> io::Result<Option<Result<MeshFile, MeshError>>> {
    let mut head = Vec::new();
    file.by_ref().take(HEAD).read_to_end(&mut head)?;
    if known_and_not_read(&head).is_some() || !is_binary_stl(&head, n_bytes) {
        return Ok(None);
    }
    let read = stl::read_binary(BufReader::new(head.as_slice().chain(file)), n_bytes)?;
    Ok(Some(read.and_then(with_triangles)))
}

/// Drops bodies without triangles; a file without any other is refused.
fn with_triangles(mut file: MeshFile) -> Result<MeshFile, MeshError> {
    // Empty objects are common in 3MF (placeholders) and must not reach the slicer.
    file.bodies.retain(|b| !b.mesh.triangles.is_empty());
    if file.bodies.is_empty() {
        return Err(MeshError::NoTriangles {
            // The reader's warnings say why the file has no triangles: surfaces that were left out, or an empty build.
            hints: file.warnings.iter().map(|w| format!("; {w}")).collect(),
        });
    }
    Ok(file)
}

/// The format of a file that holds exact surfaces, which have to be triangulated by another program.
///
/// ```
/// use grainpath_io::sniff_exact_surfaces;
/// assert_eq!(sniff_exact_surfaces(b"ISO-10303-21;\nHEADER;\n"), Some("STEP"));
/// assert_eq!(sniff_exact_surfaces(b"solid part\n"), None);
/// ```
pub fn sniff_exact_surfaces(bytes: &[u8]) -> Option<&'static str> {
    if skip_space(bytes).starts_with(b"ISO-10303-21") {
        return Some("STEP");
    }
    // Every line of an IGES file has its section in column 73 and its number after it; the first section is `S`.
    let first = bytes.get(72..80)?;
    (first[0] == b'S' && first[1..].trim_ascii() == b"1" || first == b"S0000001").then_some("IGES")
}

/// Number of first bytes that tell a binary STL from other formats. Source: derived; 1024 bytes are enough for an XML
/// declaration, a comment and the root element of the formats that are named and not read, and some are left for space.
const HEAD: u64 = 4096;

fn is_zip(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04")
}

fn is_ply(head: &[u8]) -> bool {
    head.len() > 3 && head[..3].eq_ignore_ascii_case(b"ply") && matches!(head[3], b'\n' | b'\r')
}

/// By size, not by the word: many binary STL headers begin with "solid".
fn is_binary_stl(head: &[u8], n_bytes: u64) -> bool {
    !is_zip(head) && !is_ply(head) && stl::has_binary_size(head, n_bytes)
}

/// Recognises known formats of parts that are not read, so that the error can name them.
fn known_and_not_read(bytes: &[u8]) -> Option<MeshError> {
    let text = skip_space(bytes);
    // 1024 bytes are enough for an XML declaration, a comment and the root element.
    let head = &text[..text.len().min(1024)];
    let has = |word: &[u8]| head.windows(word.len()).any(|w| w.eq_ignore_ascii_case(word));
    if let Some(format) = sniff_exact_surfaces(bytes) {
        return Some(MeshError::ExactSurfaces { format });
    }
    let format = match text {
        t if t.starts_with(b"#VRML") => "VRML",
        t if t.starts_with(b"glTF") => "glTF",
        t if t.starts_with(b"<") && has(b"<amf") => "AMF",
        t if t.starts_with(b"<") && has(b"<COLLADA") => "COLLADA",
        _ => return None,
    };
    Some(MeshError::NotRead { format })
}

/// The format of these bytes, if they can be a mesh.
///
/// ```
/// use grainpath_io::{MeshFormat, sniff_mesh};
/// assert_eq!(sniff_mesh(b"ply\nformat ascii 1.0\n", None), Some(MeshFormat::Ply));
/// assert_eq!(sniff_mesh(b"hello", None), None);
/// ```
pub fn sniff_mesh(bytes: &[u8], name: Option<&str>) -> Option<MeshFormat> {
    let extension = name.and_then(|n| n.rsplit_once('.')).map(|(_, e)| e.to_ascii_lowercase());
    let is = |e: &str| extension.as_deref() == Some(e);
    // Every ZIP archive is read as 3MF; another archive then fails for its missing model part.
    if is_zip(bytes) {
        return Some(MeshFormat::ThreeMf);
    }
    if is_ply(bytes) {
        return Some(MeshFormat::Ply);
    }
    if is_binary_stl(bytes, bytes.len() as u64) {
        return Some(MeshFormat::StlBinary);
    }
    let text = skip_space(bytes);
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
    (is("stl") && bytes.len() < 84 || stl::is_cut_short(bytes, is("stl"))).then_some(MeshFormat::StlBinary)
}
