//! Which shells are inside out, by how they lie in one another.
//!
//! A shell that lies in no other must face outward, so one of negative volume is inside out. What lies in
//! it was written with it: its cavities and the bodies in them are turned together with it, so that a
//! mesh that is inside out as a whole keeps its cavities. A shell of negative volume in an outermost
//! shell of positive volume is a cavity and stays.
//!
//! A shell lies in another if the middle of its largest facet does, by the winding number. Only the
//! 200 largest shells are taken for containers, so that the cost does not grow with the square
//! of thousands of specks. Cost: nothing but sums if all shells have a positive volume, else at most
//! 200 comparisons of boxes for each shell, and a search of the container where boxes fit.

use std::cell::OnceCell;

use glam::DVec3;

use crate::bvh::Bvh;
use crate::mesh::{Shells, TriMesh};

/// Number of the largest shells that others are compared with. Source: chosen; no file of ours has so many
/// bodies with cavities, and comparing a thousand specks with them takes less than reading their file.
const MOST_OUTER: usize = 200;

struct Shell {
    id: usize,
    /// Signed volume about the origin, then about the middle of the shell's box.
    volume: f64,
    area_vector: DVec3,
    low: DVec3,
    high: DVec3,
    /// Twice the area of the largest facet, and its middle.
    largest: (f64, DVec3),
}

/// Turns outermost shells of negative volume with all shells inside them. Returned is the number of
/// shells turned.
pub fn turn_outward(mesh: &mut TriMesh, shells: &Shells) -> usize {
    let all = measure(mesh, shells);
    if all.iter().all(|s| s.volume >= 0.0) {
        return 0;
    }
    let mut large: Vec<usize> = (0..all.len()).collect();
    large.sort_by(|&i, &j| all[j].volume.abs().total_cmp(&all[i].volume.abs()).then(i.cmp(&j)));
    large.truncate(MOST_OUTER);
    // Most boxes lie in no other, so a search is made only for a shell that is asked about.
    let searches: Vec<OnceCell<Bvh>> = large.iter().map(|_| OnceCell::new()).collect();
    let lies_in = |inner: usize, k: usize| {
        let (s, outer) = (&all[inner], &all[large[k]]);
        let fits = inner != large[k]
            && outer.volume.abs() > s.volume.abs()
            && outer.low.cmple(s.low).all()
            && outer.high.cmpge(s.high).all();
        // The middle of a facet lies on its own shell but, unless shells touch, clearly in or outside another one.
        // Inside a shell that is inside out the winding number is -1.
        fits && searches[k].get_or_init(|| search(mesh, shells, outer.id)).winding_number(s.largest.1).abs()
            > 0.5
    };
    // The largest shell around another is its outermost one.
    let outermost = |i: usize| (0..large.len()).find(|&k| lies_in(i, k)).map_or(i, |k| large[k]);
    let is_root = |i: usize| all[i].volume < 0.0 && outermost(i) == i;
    let roots: Vec<bool> = (0..all.len()).map(is_root).collect();
    let inverted: Vec<usize> = (0..large.len()).filter(|&k| roots[large[k]]).collect();
    let turns = |i: usize| roots[i] || inverted.iter().any(|&k| lies_in(i, k));
    let mut marked = vec![false; mesh.triangles.len()];
    let mut n = 0;
    for i in (0..all.len()).filter(|&i| turns(i)) {
        marked[all[i].id] = true;
        n += 1;
    }
    for (t, triangle) in mesh.triangles.iter_mut().enumerate() {
        if marked[shells.shell(t)] {
            triangle.swap(1, 2);
        }
    }
    n
}

fn measure(mesh: &TriMesh, shells: &Shells) -> Vec<Shell> {
    let mut all: Vec<Shell> = Vec::new();
    let mut slot = vec![u32::MAX; mesh.triangles.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let id = shells.shell(t);
        if slot[id] == u32::MAX {
            slot[id] = all.len() as u32;
            let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let largest = (f64::NEG_INFINITY, DVec3::ZERO);
            all.push(Shell { id, volume: 0.0, area_vector: DVec3::ZERO, low, high, largest });
        }
        let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
        let shell = &mut all[slot[id] as usize];
        // Signed volume of the tetrahedron from the triangle to the origin. Summed over a closed
        // shell, the parts outside the shell cancel.
        shell.volume += a.dot(b.cross(c)) / 6.0;
        let vector = (b - a).cross(c - a);
        shell.area_vector += 0.5 * vector;
        if vector.length() > shell.largest.0 {
            shell.largest = (vector.length(), (a + b + c) / 3.0);
        }
        shell.low = shell.low.min(a).min(b).min(c);
        shell.high = shell.high.max(a).max(b).max(c);
    }
    for shell in &mut all {
        // The volume of an open shell depends on the point it is summed about; about the middle of the
        // shell it does not depend on where the part lies. The area vector of a closed shell is zero.
        shell.volume -= (0.5 * (shell.low + shell.high)).dot(shell.area_vector) / 3.0;
    }
    all
}

/// A search among the facets of one shell.
fn search(mesh: &TriMesh, shells: &Shells, id: usize) -> Bvh {
    let own = mesh.triangles.iter().enumerate().filter(|(t, _)| shells.shell(*t) == id);
    let vertices: Vec<DVec3> = own.flat_map(|(_, t)| t.map(|i| mesh.vertices[i as usize])).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Bvh::new(&TriMesh { vertices, triangles })
}
