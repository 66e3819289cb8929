//! Recognises the format of a mesh file and calls the reader of that format.

use crate::mesh::model::{MeshError, MeshFile, MeshFormat};
use crate::mesh::{obj, off, ply, stl};
use crate::text::skip_space;
use crate::threemf;

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
        MeshFormat::StlBinary => stl::read_binary(bytes)?,
        MeshFormat::StlAscii => stl::read_ascii(bytes)?,
        MeshFormat::Obj => obj::read(bytes)?,
        MeshFormat::Ply => ply::read(bytes)?,
        MeshFormat::Off => off::read(bytes)?,
        MeshFormat::ThreeMf => threemf::read(bytes)?,
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
    if stl::has_binary_size(bytes) {
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
