//! Sorts the pieces that belong to no curved face into planes and free surfaces.

use super::graph::{Graph, NONE};
use super::grow::{Kind, SHARP};
use super::planes::Pieces;
use crate::DisjointSets;

/// Below this cosine (an edge of 20 degrees) free pieces are joined only inside a chain of equal bends.
/// Source: derived: half of the angle at which an edge is sharp.
const BLUNT: f64 = 0.94;
/// If the areas of two pieces differ by more than this factor, they are not two facets of one surface.
/// Source: derived: facets of one surface differ by less.
const LARGER: f64 = 8.0;
/// Greatest ratio of two successive bends in a chain. Source: derived: the bend from a plane to the first
/// facet of a fillet is half of the bend between facets; 3 leaves room for rounding.
const EQUAL_BENDS: f64 = 3.0;
/// A free face with less than this share of the whole area joins its neighbour. Source: derived: a
/// thousandth of a face that covers a hundredth of the surface.
const SPLINTER: f64 = 1e-5;
/// Bends below this are mere rounding, radians. Source: derived: 0.1 degrees.
const FLAT_RAD: f64 = 2e-3;

/// A smooth edge from one piece to another.
#[derive(Clone, Copy)]
struct Bend {
    to: u32,
    /// Angle between the normals of both pieces, radians.
    rad: f64,
}

/// Labels the triangles that have no label yet.
pub(super) fn label(graph: &Graph, pieces: &Pieces, label: &mut [u32], kinds: &mut Vec<Kind>) {
    let n = pieces.members.len();
    // A piece is left over if any of its triangles is: at a ragged border growth may have taken only some.
    let left = |id: usize, label: &[u32]| pieces.members[id].iter().any(|&t| label[t as usize] == NONE);
    let is_left: Vec<bool> = (0..n).map(|id| left(id, label)).collect();
    let mut bends: Vec<Vec<Bend>> = vec![Vec::new(); n];
    for t in 0..graph.len() {
        let id = pieces.piece_of[t] as usize;
        if !is_left[id] || label[t] != NONE {
            continue;
        }
        for other in graph.around(t) {
            let to = pieces.piece_of[other];
            // The normals of whole pieces are used, since those of slender triangles are inexact.
            let cosine = pieces.normal[id].dot(pieces.normal[to as usize]);
            let is_new = to as usize != id && bends[id].iter().all(|b| b.to != to);
            if label[other] == NONE && is_new && cosine > SHARP {
                bends[id].push(Bend { to, rad: crate::math::acos(cosine.min(1.0)) });
            }
        }
    }
    let is_plane: Vec<bool> =
        (0..n).map(|id| is_left[id] && pieces.area[id] > 0.0 && is_plane(id, pieces, &bends)).collect();
    let mut sets = DisjointSets::new(n);
    for id in (0..n).filter(|&id| !is_plane[id]) {
        for bend in bends[id].iter().filter(|b| !is_plane[b.to as usize]) {
            let gentle = pieces.normal[id].dot(pieces.normal[bend.to as usize]) > BLUNT;
            if gentle || continues(id, bend, pieces, &bends) {
                sets.union(id, bend.to as usize);
            }
        }
    }
    let root = sets.names();
    let mut label_of = vec![NONE; n];
    for id in (0..n).filter(|&id| is_left[id] && pieces.area[id] > 0.0) {
        let root = root[id] as usize;
        if label_of[root] == NONE {
            label_of[root] = kinds.len() as u32;
            kinds.push(if is_plane[id] { Kind::Plane } else { Kind::Free });
        }
        label_of[id] = label_of[root];
    }
    for t in 0..graph.len() {
        if label[t] == NONE {
            label[t] = label_of[pieces.piece_of[t] as usize];
        }
    }
    splinters(graph, label, kinds);
}

/// Whether a piece is a plane: none of its smooth edges belongs to a chain of equal bends.
fn is_plane(id: usize, pieces: &Pieces, bends: &[Vec<Bend>]) -> bool {
    !bends[id].iter().any(|b| continues(id, b, pieces, bends))
}

/// Whether the bend between two pieces belongs to a chain of about equal bends, between pieces of similar size.
fn continues(id: usize, bend: &Bend, pieces: &Pieces, bends: &[Vec<Bend>]) -> bool {
    let alike = |a: f64, b: f64, ratio: f64| a <= ratio * b && b <= ratio * a;
    let to = bend.to as usize;
    if !alike(pieces.area[id], pieces.area[to], LARGER) {
        return false;
    }
    let goes_on = |from: usize, except: usize| {
        bends[from].iter().any(|b| {
            b.to as usize != except
                && alike(b.rad.max(FLAT_RAD), bend.rad.max(FLAT_RAD), EQUAL_BENDS)
                && alike(pieces.area[b.to as usize], pieces.area[from], LARGER)
        })
    };
    goes_on(id, to) || goes_on(to, id)
}

/// Gives triangles without area, and free faces with almost none, to the neighbouring face across their
/// smoothest edge.
fn splinters(graph: &Graph, label: &mut [u32], kinds: &[Kind]) {
    let total: f64 = graph.area.iter().sum();
    let mut area = vec![0.0; kinds.len()];
    (0..graph.len()).filter(|&t| label[t] != NONE).for_each(|t| area[label[t] as usize] += graph.area[t]);
    let is_small =
        |l: u32| l == NONE || (kinds[l as usize] == Kind::Free && area[l as usize] < SPLINTER * total);
    let mut waiting: Vec<usize> = (0..graph.len()).filter(|&t| is_small(label[t])).collect();
    // Labels spread from the borders inwards. Each round uses only labels of earlier rounds, so the result does
    // not depend on the order.
    while !waiting.is_empty() {
        let taken: Vec<(usize, u32)> = waiting
            .iter()
            .filter_map(|&t| {
                let smooth = |o: &usize| graph.cosine(t, *o) > SHARP && !is_small(label[*o]);
                let nearest = graph.around(t).filter(smooth).max_by(|&a, &b| {
                    graph.cosine(t, a).total_cmp(&graph.cosine(t, b)).then_with(|| label[b].cmp(&label[a]))
                });
                nearest.map(|o| (t, label[o]))
            })
            .collect();
        if taken.is_empty() {
            break;
        }
        taken.iter().for_each(|&(t, l)| label[t] = l);
        waiting.retain(|&t| is_small(label[t]));
    }
}
