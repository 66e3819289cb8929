//! OFF and its relatives COFF and NOFF.
//!
//! Source: Geomview manual, section "OFF Files". The header has the numbers of vertices, faces and edges; then follow one
//! vertex and one face a line. Colours and normals after the coordinates are skipped. Faces may have 3 to 65535 corners.
//! Units: the format has none. Binary OFF and 4OFF are not read.

use grainpath_core::TriMesh;

use super::model::{MAX_ELEMENTS, MeshError, MeshFile, merge, triangulate};
use crate::position::checked;
use crate::text::{TextError, Words};
use grainpath_core::number::whole;

pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, MeshError> {
    let mut words = Words::new(bytes, Some(b'#'));
    let header = words.word().ok_or(MeshError::Empty)?;
    // `COFF`, `NOFF` and `CNOFF` end in the same letters. The colours and normals that they add follow the coordinates.
    if header.get(header.len().saturating_sub(3)..).is_none_or(|h| !h.eq_ignore_ascii_case(b"OFF")) {
        return Err(words.wrong(header, "`OFF`").into());
    }
    let n_vertices = words.count("the number of vertices")?;
    let n_faces = words.count("the number of faces")?;
    // The manual requires the number of edges and does not use it.
    words.count("the number of edges")?;
    for (what, n) in [("vertices", n_vertices), ("faces", n_faces)] {
        if n > MAX_ELEMENTS {
            return Err(MeshError::TooMany { what, limit: MAX_ELEMENTS });
        }
    }
    words.next_line();
    // The count may be wrong. A row takes at least four bytes, so no more memory is reserved than the file can
    // fill.
    let capacity = |n: u64| (n as usize).min(bytes.len() / 4);
    let mut mesh = TriMesh {
        vertices: Vec::with_capacity(capacity(n_vertices)),
        triangles: Vec::with_capacity(capacity(n_faces)),
    };
    for _ in 0..n_vertices {
        let p = words.position()?;
        mesh.vertices.push(checked(p, || words.place())?);
        // Normals and colours may follow on the line.
        words.next_line();
    }
    let mut face = Vec::new();
    for _ in 0..n_faces {
        let n = words.count("the number of corners")?;
        if !(3..=65535).contains(&n) {
            return Err(MeshError::BadFace { place: words.place(), n });
        }
        face.clear();
        for _ in 0..n {
            let word = words.word().ok_or_else(|| TextError::UnexpectedEnd {
                place: words.place(),
                expected: "a vertex number",
            })?;
            let index = whole(word).ok_or_else(|| words.wrong(word, "a vertex number"))?;
            if index < 0 || index as u64 >= n_vertices {
                return Err(MeshError::NoSuchVertex {
                    place: words.place(),
                    index,
                    n_vertices: n_vertices as usize,
                });
            }
            face.push(index as u32);
        }
        triangulate(&face, |i| mesh.vertices[i as usize], |t| mesh.triangles.push(t));
        words.next_line();
    }
    let body = merge(mesh)?;
    Ok(MeshFile { bodies: vec![body], unit: None, modifiers: Vec::new(), warnings: Vec::new() })
}
