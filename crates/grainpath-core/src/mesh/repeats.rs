//! Facets that repeat another facet of a mesh: the same three points a second time.
//!
//! Method. Facets are sorted by their points, so that copies lie next to each other. Copies wound alike are left out but for the
//! first. Copies wound against each other are the two sides of a face where bodies touch, and stay; only where every facet has
//! its opposite is the whole surface doubled, and one side of it is left out.
//!
//! Copies that are connected over edges go together, and only if more edges get an even number of facets by it than lose one:
//! bodies that share a face of their surfaces would be left open without it. Cost: n log n in the facets, where there are several
//! shells or edges with more than two facets; other meshes hold no copies and cost nothing.

use super::topology::EdgeUses;
use super::weld::VertexWelder;
use super::{Examined, TriMesh};
use crate::DisjointSets;

/// Facets that repeat others.
pub struct Repeats {
    /// Their number.
    pub n_facets: usize,
    /// For each body, which of its facets they are; empty for a body without any.
    pub facets: Vec<Vec<bool>>,
}

/// Finds the facets that can be left out because they repeat others, of the same or of another body.
pub fn find_repeats(bodies: &[Examined]) -> Repeats {
    let none = || Repeats { n_facets: 0, facets: vec![Vec::new(); bodies.len()] };
    let n_shells: usize = bodies.iter().map(|b| b.health.shells).sum();
    if n_shells < 2 && bodies.iter().all(|b| b.health.nonmanifold_edges == 0) {
        return none();
    }
    // Copies may lie in different bodies, so all are looked at together.
    let Some(whole) = joined(bodies) else { return none() };
    let copies = copies(&whole);
    if !copies.contains(&true) {
        return none();
    }
    let edges = EdgeUses::count(&whole);
    // Copies that share an edge go or stay as one: a hole in the middle of a doubled surface would help nobody.
    let mut patches = DisjointSets::new(copies.len());
    for edge in edges.edges() {
        let mut at_edge = edge.map(|(t, _)| t).filter(|&t| copies[t]);
        if let Some(first) = at_edge.next() {
            at_edge.for_each(|other| {
                patches.union(first, other);
            });
        }
    }
    let patch_of = patches.names();
    // How many edges of each patch, named by its lowest facet, get an even number of facets without it, less those that lose one.
    let mut gain = vec![0i64; copies.len()];
    for edge in edges.edges() {
        let (mut n, mut n_copies, mut patch) = (0usize, 0usize, 0);
        for (t, _) in edge {
            n += 1;
            if copies[t] {
                n_copies += 1;
                patch = patch_of[t] as usize;
            }
        }
        // An even number of copies leaves the edge as even or odd as it was.
        if n_copies % 2 == 1 {
            gain[patch] += if n % 2 == 1 { 1 } else { -1 };
        }
    }
    let goes = |t: usize| copies[t] && gain[patch_of[t] as usize] >= 0;
    let mut first = 0;
    let mut found = Repeats { n_facets: 0, facets: Vec::with_capacity(bodies.len()) };
    for body in bodies {
        let n = body.mesh.triangles.len();
        let of_body: Vec<bool> = (first..first + n).map(goes).collect();
        first += n;
        let n_going = of_body.iter().filter(|goes| **goes).count();
        found.n_facets += n_going;
        found.facets.push(if n_going > 0 { of_body } else { Vec::new() });
    }
    found
}

/// The facets of all bodies, with one index for each point; `None` for more points than 32 bits count.
fn joined(bodies: &[Examined]) -> Option<TriMesh> {
    let n_vertices = bodies.iter().map(|b| b.mesh.vertices.len()).sum();
    let mut welder = VertexWelder::with_capacity(n_vertices);
    let mut triangles = Vec::with_capacity(bodies.iter().map(|b| b.mesh.triangles.len()).sum());
    for body in bodies {
        let index: Option<Vec<u32>> = body.mesh.vertices.iter().map(|p| welder.index(*p)).collect();
        let index = index?;
        triangles.extend(body.mesh.triangles.iter().map(|t| t.map(|i| index[i as usize])));
    }
    Some(TriMesh { vertices: welder.into_vertices(), triangles })
}

/// The facets that repeat one of a lower index.
fn copies(mesh: &TriMesh) -> Vec<bool> {
    // The points in ascending order, and whether the facet runs around them in this direction.
    let mut keyed: Vec<([u32; 3], bool, u32)> = (0u32..)
        .zip(&mesh.triangles)
        .map(|(t, &[a, b, c])| {
            let mut key = [a, b, c];
            key.sort_unstable();
            (key, [[a, b, c], [b, c, a], [c, a, b]].contains(&key), t)
        })
        .collect();
    keyed.sort_unstable();
    let same = || keyed.chunk_by(|a, b| a.0 == b.0);
    let has_opposites =
        |group: &[([u32; 3], bool, u32)]| 2 * group.iter().filter(|f| f.1).count() == group.len();
    // A surface that is there once for each side has no inside, so that its copies are no faces where bodies touch.
    let is_doubled = same().all(has_opposites);
    let mut copies = vec![false; mesh.triangles.len()];
    for group in same().filter(|group| group.len() > 1) {
        let lowest = |way: bool| group.iter().filter(|f| f.1 == way || is_doubled).map(|f| f.2).min();
        let kept = [lowest(false), lowest(true)];
        group.iter().filter(|f| !kept.contains(&Some(f.2))).for_each(|f| copies[f.2 as usize] = true);
    }
    copies
}
