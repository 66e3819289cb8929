//! Flat pieces: neighbouring triangles in one plane.

use glam::DVec3;

use super::graph::Graph;

/// Flat pieces of a mesh.
pub(super) struct Pieces {
    /// The piece of each triangle.
    pub piece_of: Vec<u32>,
    /// The triangles of each piece; the first is the seed from which it grew. Pieces are sorted by the area
    /// of their seeds, largest first.
    pub members: Vec<Vec<u32>>,
    /// Unit normal of each piece.
    pub normal: Vec<DVec3>,
    /// Area of each piece.
    pub area: Vec<f64>,
}

/// Marks a triangle that is not yet in a piece.
const FREE: u32 = u32::MAX;

/// Least cosine of the angle between a triangle and the plane that it joins, about 45 degrees. This test only excludes
/// folds. Whether a triangle lies in the plane is decided by the distances of its corners, since the normal of a
/// triangle narrower than the rounding is meaningless. Source: derived. A fold turns by more than 90 degrees, and
/// corners within the tolerance turn a triangle of usual width by far less than 45.
const NO_FOLD: f64 = 0.7;

/// Grows planes from the largest triangles outwards. The plane is refitted whenever its area has
/// doubled, since the normal of a small triangle is too inexact far away from it.
pub(super) fn flat_pieces(graph: &Graph) -> Pieces {
    let mut order: Vec<u32> = (0..graph.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| {
        graph.area[b as usize].total_cmp(&graph.area[a as usize]).then_with(|| a.cmp(&b))
    });
    let mut pieces = Pieces {
        piece_of: vec![FREE; graph.len()],
        members: Vec::new(),
        normal: Vec::new(),
        area: Vec::new(),
    };
    for seed in order {
        if pieces.piece_of[seed as usize] == FREE {
            grow(graph, seed, &mut pieces);
        }
    }
    pieces
}

fn grow(graph: &Graph, seed: u32, pieces: &mut Pieces) {
    let id = pieces.members.len() as u32;
    let s = seed as usize;
    let (mut normal, mut point) = (graph.normal[s], graph.centroid(s));
    let (mut vector, mut moment) = (graph.area[s] * normal, graph.area[s] * point);
    let (mut area, mut fitted) = (graph.area[s], graph.area[s]);
    let mut members = vec![seed];
    pieces.piece_of[s] = id;
    let mut at = 0;
    while let Some(&t) = members.get(at) {
        at += 1;
        for n in graph.around(t as usize) {
            let flat = |p: &DVec3| (*p - point).dot(normal).abs() <= graph.tolerance;
            let turned = graph.normal[n].dot(normal) < NO_FOLD && graph.normal[n] != DVec3::ZERO;
            if pieces.piece_of[n] != FREE || turned || !graph.points(n).iter().all(flat) {
                continue;
            }
            pieces.piece_of[n] = id;
            members.push(n as u32);
            vector += graph.area[n] * graph.normal[n];
            moment += graph.area[n] * graph.centroid(n);
            area += graph.area[n];
            if area >= 2.0 * fitted && area > 0.0 {
                fitted = area;
                normal = vector.normalize_or(normal);
                point = moment / area;
            }
        }
    }
    pieces.members.push(members);
    pieces.normal.push(vector.normalize_or_zero());
    pieces.area.push(area);
}
