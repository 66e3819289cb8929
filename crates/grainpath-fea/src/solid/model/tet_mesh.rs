//! Meshes of ten-node tetrahedra and their boundary.
//!
//! Lengths are in mm. The order of nodes is that of VTK and Abaqus.

use grainpath_core::DVec3;
use rayon::prelude::*;

use super::adjacency::{boundary, incidence, pieces_of};
use super::quadratic_tet as element;
use super::tet_shape::{self as shape, EDGES, MeshQuality, TetQuality};
use grainpath_core::selection::Selection;

/// A mesh of ten-node tetrahedra.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TetMesh {
    /// Node positions, mm.
    pub nodes: Vec<DVec3>,
    /// Four corners of positive volume, then the nodes between corners 01, 12, 20, 03, 13, 23.
    pub tets: Vec<[u32; 10]>,
    /// Faces that belong to a single element.
    pub faces: Vec<Face>,
}

/// One face of the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// Three corners, counter-clockwise seen from outside, then the nodes between 01, 12, 20.
    pub nodes: [u32; 6],
    /// The element it belongs to.
    pub tet: u32,
    /// The facet of the meshed surface on which it lies; 0 where the mesh did not come from a
    /// surface.
    pub facet: u32,
    /// The point of that surface nearest to the face's middle. A face that rounds off a sharp edge
    /// lies at a slant; this point tells to which side of the edge it belongs.
    pub foot: Option<DVec3>,
}

/// Elements connected over faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Number of its elements.
    pub n_tets: usize,
    /// Volume, mm3.
    pub volume_mm3: f64,
    /// Lowest corner of its box, mm.
    pub lo: DVec3,
    /// Highest corner of its box, mm.
    pub hi: DVec3,
    /// One of its elements.
    pub first: u32,
}

impl TetMesh {
    /// Ten-node elements with straight sides over four-node ones, and their boundary (facet 0).
    /// Elements of negative volume are turned over.
    pub fn straight(vertices: &[DVec3], tets: &[[u32; 4]]) -> Self {
        let upright = |t: &[u32; 4]| {
            // Two corners change places; middle nodes come later and follow the new order.
            let v = shape::volume(&t.map(|i| vertices[i as usize]));
            if v < 0.0 { [t[0], t[2], t[1], t[3]] } else { *t }
        };
        let tets: Vec<[u32; 4]> = tets.iter().map(upright).collect();
        let mut sides: Vec<(u64, u32)> = Vec::with_capacity(6 * tets.len());
        for (t, tet) in tets.iter().enumerate() {
            for (e, &(i, j)) in EDGES.iter().enumerate() {
                let (a, b) = (tet[i].min(tet[j]), tet[i].max(tet[j]));
                sides.push((u64::from(a) << 32 | u64::from(b), (6 * t + e) as u32));
            }
        }
        // Sorted by their ends, the copies of a side lie next to each other and get one node.
        sides.par_sort_unstable();
        let mut nodes = vertices.to_vec();
        let mut all: Vec<[u32; 10]> =
            tets.iter().map(|t| std::array::from_fn(|i| if i < 4 { t[i] } else { 0 })).collect();
        for side in sides.chunk_by(|a, b| a.0 == b.0) {
            let (a, b) = ((side[0].0 >> 32) as usize, (side[0].0 & 0xffff_ffff) as usize);
            for &(_, slot) in side {
                all[slot as usize / 6][4 + slot as usize % 6] = nodes.len() as u32;
            }
            nodes.push(0.5 * (vertices[a] + vertices[b]));
        }
        let mut mesh = Self { nodes, tets: all, faces: Vec::new() };
        mesh.find_faces();
        mesh
    }

    /// Recomputes the boundary from the tetrahedra. The link from faces to surface facets is lost.
    pub fn find_faces(&mut self) {
        let corners: Vec<[u32; 4]> = self.tets.iter().map(|t| [t[0], t[1], t[2], t[3]]).collect();
        let face = |(f, t): ([u32; 3], u32)| {
            let tet = &self.tets[t as usize];
            let between = |a: u32, b: u32| {
                let is = |&(i, j): &(usize, usize)| [tet[i], tet[j]] == [a, b] || [tet[j], tet[i]] == [a, b];
                tet[4 + EDGES.iter().position(is).expect("a side of the element")]
            };
            let mid = [between(f[0], f[1]), between(f[1], f[2]), between(f[2], f[0])];
            Face { nodes: [f[0], f[1], f[2], mid[0], mid[1], mid[2]], tet: t, facet: 0, foot: None }
        };
        self.faces = boundary(&corners).into_iter().map(face).collect();
    }

    /// The faces whose nearest point of the surface lies in a selection. Without a surface the
    /// middle of the face is tested.
    pub fn faces_in(&self, selection: &Selection) -> Vec<usize> {
        let middle = |f: &Face| f.nodes[3..].iter().map(|&m| self.nodes[m as usize]).sum::<DVec3>() / 3.0;
        (0..self.faces.len())
            .filter(|&f| selection.contains(self.faces[f].foot.unwrap_or_else(|| middle(&self.faces[f]))))
            .collect()
    }

    /// The nodes of some faces, each once, in ascending order.
    pub fn nodes_of(&self, faces: &[usize]) -> Vec<u32> {
        let mut nodes: Vec<u32> = faces.iter().flat_map(|&f| self.faces[f].nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Number of unknowns without any support.
    pub fn n_dofs(&self) -> usize {
        3 * self.nodes.len()
    }

    /// The corners of an element.
    pub fn corners(&self, tet: usize) -> [DVec3; 4] {
        std::array::from_fn(|i| self.nodes[self.tets[tet][i] as usize])
    }

    /// All ten nodes of an element.
    pub fn places(&self, tet: usize) -> [DVec3; 10] {
        self.tets[tet].map(|i| self.nodes[i as usize])
    }

    /// Volume with curved sides, mm3.
    pub fn volume_mm3(&self) -> f64 {
        self.tets.iter().map(|t| element::volume(&t.map(|i| self.nodes[i as usize]))).sum()
    }

    /// Edge of the cubes of a body-centred lattice whose tetrahedra have the mean volume of these,
    /// mm. A cube has the volume of twelve tetrahedra.
    pub(crate) fn mean_cell_mm(&self) -> f64 {
        (12.0 * self.volume_mm3().abs() / self.tets.len().max(1) as f64).cbrt()
    }

    /// Shape of each element.
    pub(crate) fn qualities(&self) -> Vec<TetQuality> {
        (0..self.tets.len()).into_par_iter().map(|t| shape::quality(&self.corners(t))).collect()
    }

    /// The worst shapes.
    pub fn quality(&self) -> MeshQuality {
        let all = self.qualities();
        let worst = all.iter().fold((180.0f64, 0.0f64, 0.0f64), |(lo, hi, aspect), q| {
            (lo.min(q.dihedral_min_deg), hi.max(q.dihedral_max_deg), aspect.max(q.aspect))
        });
        let poor = |q: &&TetQuality| q.dihedral_min_deg < 10.0 || q.dihedral_max_deg > 165.0;
        MeshQuality {
            dihedral_min_deg: worst.0,
            dihedral_max_deg: worst.1,
            aspect_max: worst.2,
            aspect_mean: all.iter().map(|q| q.aspect).sum::<f64>() / all.len().max(1) as f64,
            n_poor: all.iter().filter(poor).count(),
        }
    }

    /// For each element, the lowest-numbered one that it is connected to over faces.
    pub(crate) fn piece_of_tets(&self) -> Vec<u32> {
        let corners: Vec<[u32; 4]> = self.tets.iter().map(|t| [t[0], t[1], t[2], t[3]]).collect();
        pieces_of(&corners)
    }

    /// The pieces connected over faces, the piece of the lowest element first.
    pub fn pieces(&self) -> Vec<Piece> {
        self.pieces_from(&self.piece_of_tets())
    }

    pub(crate) fn pieces_from(&self, piece_of_tets: &[u32]) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut slot = vec![usize::MAX; self.tets.len()];
        for (t, &first) in piece_of_tets.iter().enumerate() {
            // `first` is the lowest element of its piece, so it is met before the others.
            if slot[first as usize] == usize::MAX {
                slot[first as usize] = pieces.len();
                let (lo, hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                pieces.push(Piece { n_tets: 0, volume_mm3: 0.0, lo, hi, first });
            }
            let piece = &mut pieces[slot[first as usize]];
            piece.n_tets += 1;
            piece.volume_mm3 += element::volume(&self.places(t));
            for p in self.corners(t) {
                piece.lo = piece.lo.min(p);
                piece.hi = piece.hi.max(p);
            }
        }
        pieces
    }

    /// Moves middle nodes. Moves are undone where they would bend an element too much.
    pub(crate) fn curve(&mut self, moves: &[(u32, DVec3)]) {
        let mut from: Vec<(u32, DVec3)> = moves.iter().map(|&(m, _)| (m, self.nodes[m as usize])).collect();
        from.sort_unstable_by_key(|f| f.0);
        for &(m, to) in moves {
            self.nodes[m as usize] = to;
        }
        let is_curved = |m: &u32| from.binary_search_by_key(m, |f| f.0).is_ok();
        let mut bent: Vec<usize> =
            (0..self.tets.len()).filter(|&t| self.tets[t][4..].iter().any(is_curved)).collect();
        let (start, around) = incidence(self.nodes.len(), &self.tets);
        while !bent.is_empty() {
            // The least Jacobian must be at least a quarter of the straight element's: below that,
            // the inverse map distorts stresses.
            let bad = |&t: &usize| element::least_jacobian(&self.places(t)) < 0.25;
            let mut back: Vec<u32> = bent.into_iter().filter(bad).flat_map(|t| self.tets[t]).collect();
            back.retain(is_curved);
            back.sort_unstable();
            back.dedup();
            let home = |m: u32| from[from.binary_search_by_key(&m, |f| f.0).expect("a curved node")].1;
            // Nodes that are back already are dropped; otherwise the loop would not end.
            back.retain(|&m| self.nodes[m as usize] != home(m));
            for &m in &back {
                self.nodes[m as usize] = home(m);
            }
            // The neighbours of nodes that moved back are tested again, because their other curved
            // sides may no longer fit.
            let at = |m: u32| &around[start[m as usize] as usize..start[m as usize + 1] as usize];
            bent = back.iter().flat_map(|&m| at(m)).map(|&t| t as usize).collect();
            bent.sort_unstable();
            bent.dedup();
        }
    }

    /// Numbers nodes and elements along a space-filling curve (Morton's), so that neighbours are
    /// near each other in memory.
    pub(crate) fn sort_in_space(&mut self) {
        let Some(&first) = self.nodes.first() else { return };
        let fold = self.nodes.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        // 21 bits for each axis fill a 64-bit code.
        let scale = 2_097_151.0 / (fold.1 - fold.0).max_element().max(f64::MIN_POSITIVE);
        let code = |p: DVec3| {
            let q = (p - fold.0) * scale;
            spread(q.x as u64) | spread(q.y as u64) << 1 | spread(q.z as u64) << 2
        };
        let mut order: Vec<(u64, u32)> = (0u32..).zip(&self.nodes).map(|(i, &p)| (code(p), i)).collect();
        order.par_sort_unstable();
        let mut new = vec![0u32; order.len()];
        for (i, &(_, old)) in (0u32..).zip(&order) {
            new[old as usize] = i;
        }
        let mut tets: Vec<(u64, u32)> = (0..self.tets.len() as u32)
            .map(|t| (code(self.corners(t as usize).iter().sum::<DVec3>() / 4.0), t))
            .collect();
        tets.par_sort_unstable();
        let mut new_tet = vec![0u32; tets.len()];
        for (i, &(_, old)) in (0u32..).zip(&tets) {
            new_tet[old as usize] = i;
        }
        self.tets = tets.iter().map(|&(_, t)| self.tets[t as usize].map(|i| new[i as usize])).collect();
        self.nodes = order.iter().map(|&(_, i)| self.nodes[i as usize]).collect();
        for face in &mut self.faces {
            face.nodes = face.nodes.map(|i| new[i as usize]);
            face.tet = new_tet[face.tet as usize];
        }
    }
}

/// Inserts two zero bits after each of the 21 low bits of a number.
fn spread(mut x: u64) -> u64 {
    x &= 0x1f_ffff;
    for (shift, mask) in [
        (32, 0x1f_0000_0000_ffff),
        (16, 0x1f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}
