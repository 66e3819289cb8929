//! Wavefront OBJ: vertices (`v`) and faces (`f`).
//!
//! Source: Wavefront Technologies, *Advanced Visualizer manual*, appendix B1, format version 3.0. Faces may have 3 to 65535
//! corners and are cut into triangles; negative numbers count back from the last vertex. Materials, normals, texture
//! coordinates, groups and free-form surfaces are skipped. Units: the format has none. A face that names a vertex which
//! does not come before it is refused.

use super::model::{MAX_ELEMENTS, MeshError, MeshFile, SoupBuilder, triangulate};
use crate::position::checked;
use crate::text::Words;
use grainpath_core::number::whole;

pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, MeshError> {
    let mut words = Words::new(bytes, Some(b'#'));
    // Index of the merged vertex for each vertex of the file.
    let mut merged: Vec<u32> = Vec::new();
    // A vertex line and a face line take about 30 bytes each. A mesh has half as many vertices as triangles, so a triangle
    // takes about 45 bytes; 64 reserves too little memory rather than too much.
    let mut soup = SoupBuilder::with_capacity(bytes.len() / 64);
    let mut positions = Vec::new();
    let mut face = Vec::new();
    let mut triangles = Vec::new();
    while let Some(word) = words.word() {
        match word {
            b"v" => {
                if merged.len() as u64 >= MAX_ELEMENTS {
                    return Err(MeshError::TooMany { what: "vertices", limit: MAX_ELEMENTS });
                }
                let p = checked(words.position()?, || words.place())?;
                let index = soup.index(p)?;
                // The index is new unless the vertex was merged into an earlier one.
                if index as usize == positions.len() {
                    positions.push(p);
                }
                merged.push(index);
                words.next_line();
            }
            b"f" => {
                face.clear();
                while let Some(corner) = words.word_on_line() {
                    face.push(vertex(corner, &merged, &words)?);
                }
                if face.len() < 3 || face.len() > 65535 {
                    return Err(MeshError::BadFace { place: words.place(), n: face.len() as u64 });
                }
                // Triangles are collected first, because the builder cannot be borrowed while it
                // triangulates.
                triangulate(&face, |i| positions[i as usize], |t| triangles.push(t));
                for t in triangles.drain(..) {
                    soup.push(t)?;
                }
            }
            // Normals, texture coordinates, groups and materials do not change the shape.
            _ => words.next_line(),
        }
    }
    let body = soup.finish(None);
    Ok(MeshFile { bodies: vec![body], unit: None, modifiers: Vec::new(), warnings: Vec::new() })
}

/// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative numbers count from the last.
fn vertex(corner: &[u8], merged: &[u32], words: &Words<'_>) -> Result<u32, MeshError> {
    let number = corner.split(|&b| b == b'/').next().unwrap_or_default();
    let index = whole(number).ok_or_else(|| words.wrong(corner, "a vertex number"))?;
    // OBJ counts from 1; -1 is the vertex before this line.
    let at = if index < 0 { merged.len() as i64 + index } else { index - 1 };
    usize::try_from(at).ok().and_then(|i| merged.get(i)).copied().ok_or_else(|| MeshError::NoSuchVertex {
        place: words.place(),
        index,
        n_vertices: merged.len(),
    })
}
