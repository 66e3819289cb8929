//! Turns surfaces into bytes: the part with its faces, and its stress and displacement under loads.
//!
//! All numbers are 32 bits, little-endian. A surface begins with its counts, so that the page can lay typed arrays over
//! the answer without a copy. Cost: 12 bytes a vertex and 16 bytes a triangle; 36 bytes a point and case.

use crate::cut_view::StressSection;
use crate::engine::{Branch, CaseValues, StressLine, StressSurface, Surface};

fn put(bytes: &mut Vec<u8>, words: impl IntoIterator<Item = u32>) {
    words.into_iter().for_each(|w| bytes.extend(w.to_le_bytes()));
}

fn put_reals(bytes: &mut Vec<u8>, reals: impl IntoIterator<Item = f32>) {
    reals.into_iter().for_each(|r| bytes.extend(r.to_le_bytes()));
}

/// Counts of vertices, triangles, faulty edges, borders and faults of the file; then x, y, z of the vertices, corners of
/// the triangles, the face of each triangle, both ends of each faulty edge, the corners of each border between two faces,
/// and both ends of each fault of the file.
pub(crate) fn part(surface: &Surface) -> Vec<u8> {
    let Surface { vertices, triangles, face, faulty_edges, file_faults, borders } = surface;
    let edges = 6 * (faulty_edges.len() + file_faults.len()) + 2 * borders.len();
    let words = 5 + 3 * vertices.len() + 4 * triangles.len() + edges;
    let mut bytes = Vec::with_capacity(4 * words);
    put(
        &mut bytes,
        [vertices.len(), triangles.len(), faulty_edges.len(), borders.len(), file_faults.len()]
            .map(|n| n as u32),
    );
    put_reals(&mut bytes, vertices.iter().flatten().copied());
    put(&mut bytes, triangles.iter().flatten().copied());
    put(&mut bytes, face.iter().copied());
    put_reals(&mut bytes, faulty_edges.iter().flatten().flatten().copied());
    put(&mut bytes, borders.iter().flatten().copied());
    put_reals(&mut bytes, file_faults.iter().flatten().flatten().copied());
    bytes
}

/// Ten numbers a branch: x, y, z and radius of its upper and of its lower end, its load, and 1 for a contact with the part.
pub(crate) fn branches(branches: &[Branch]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(40 * branches.len());
    for Branch { ends, load_n, is_contact } in branches {
        put_reals(&mut bytes, ends.iter().flatten().copied());
        put_reals(&mut bytes, [*load_n, f32::from(u8::from(*is_contact))]);
    }
    bytes
}

/// Counts of points and triangles; then x, y, z of the points and corners of the triangles.
pub(crate) fn stressed(surface: &StressSurface) -> Vec<u8> {
    let StressSurface { points, triangles, .. } = surface;
    let mut bytes = Vec::with_capacity(4 * (2 + 3 * points.len() + 3 * triangles.len()));
    put(&mut bytes, [points.len(), triangles.len()].map(|n| n as u32));
    put_reals(&mut bytes, points.iter().flatten().copied());
    put(&mut bytes, triangles.iter().flatten().copied());
    bytes
}

/// Nine values a point: stress xx, yy, zz, xy, yz, zx in MPa, displacement x, y, z in mm.
pub(crate) fn case(case: &CaseValues) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(36 * case.values.len());
    put_reals(&mut bytes, case.values.iter().flatten().copied());
    bytes
}

/// Counts of points and triangles; then x, y, z of the points, corners of the triangles, and nine values a point as those
/// of a case.
pub(crate) fn section(section: &StressSection) -> Vec<u8> {
    let StressSection { points, triangles, values } = section;
    let mut bytes = Vec::with_capacity(4 * (2 + 12 * points.len() + 3 * triangles.len()));
    put(&mut bytes, [points.len(), triangles.len()].map(|n| n as u32));
    put_reals(&mut bytes, points.iter().flatten().copied());
    put(&mut bytes, triangles.iter().flatten().copied());
    put_reals(&mut bytes, values.iter().flatten().copied());
    bytes
}

/// The count of lines, the count of points of each, then x, y, z in mm and the stress along the line in MPa of each point.
pub(crate) fn lines(lines: &[StressLine]) -> Vec<u8> {
    let mut bytes = Vec::new();
    put(&mut bytes, [lines.len() as u32]);
    put(&mut bytes, lines.iter().map(|l| l.len() as u32));
    put_reals(&mut bytes, lines.iter().flatten().flatten().copied());
    bytes
}
