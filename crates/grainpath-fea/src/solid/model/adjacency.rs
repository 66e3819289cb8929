//! Adjacency of tetrahedra: shared faces and vertices, and connected pieces.
//!
//! Cost: sorting four faces a tetrahedron; the order of the results depends on the mesh alone.

use grainpath_core::DisjointSets;
use rayon::slice::ParallelSliceMut;

use super::tet_shape::FACES;

/// Faces that belong to a single tetrahedron, wound outwards, with that tetrahedron; sorted by
/// their corners.
pub(crate) fn boundary(tets: &[[u32; 4]]) -> Vec<([u32; 3], u32)> {
    let single = |c: &[SortedFace]| (c.len() == 1).then(|| (FACES[c[0].2 as usize], c[0].1));
    let faces = sorted_faces(tets);
    let alone = faces.chunk_by(|a, b| a.0 == b.0).filter_map(single);
    alone.map(|(f, t)| (f.map(|i| tets[t as usize][i]), t)).collect()
}

/// A face: its corners from low to high, the tetrahedron, and the number of the face in it.
pub(crate) type SortedFace = ([u32; 3], u32, u8);

/// All faces of all tetrahedra, sorted by their corners.
pub(crate) fn sorted_faces(tets: &[[u32; 4]]) -> Vec<SortedFace> {
    let face = |t: u32, f: u8| {
        let mut key = FACES[f as usize].map(|i| tets[t as usize][i]);
        key.sort_unstable();
        (key, t, f)
    };
    let mut faces: Vec<SortedFace> =
        (0..tets.len() as u32).flat_map(|t| (0..4).map(move |f| face(t, f))).collect();
    faces.par_sort_unstable();
    faces
}

/// For each vertex the tetrahedra around it, as offsets into one list.
pub(crate) fn incidence<const N: usize>(n_vertices: usize, tets: &[[u32; N]]) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; n_vertices + 1];
    for &v in tets.iter().flatten() {
        start[v as usize + 1] += 1;
    }
    for v in 0..n_vertices {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut around = vec![0; N * tets.len()];
    for (t, tet) in (0..).zip(tets) {
        for &v in tet {
            around[next[v as usize] as usize] = t;
            next[v as usize] += 1;
        }
    }
    (start, around)
}

/// For each tetrahedron, the lowest-numbered one that it is connected to over faces.
pub(crate) fn pieces_of(tets: &[[u32; 4]]) -> Vec<u32> {
    let mut pieces = DisjointSets::new(tets.len());
    let faces = sorted_faces(tets);
    // A face of more than two tetrahedra would be a defect of the mesh; its first two are joined.
    for pair in faces.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() > 1) {
        pieces.union(pair[0].1 as usize, pair[1].1 as usize);
    }
    pieces.names()
}
