//! The triangles of a mesh with their normals, areas and neighbours.

use std::convert::Infallible;

use glam::DVec3;
use rayon::prelude::*;

use crate::TriMesh;
use crate::mesh::weld_targets;

/// Label of a triangle that belongs to no face.
pub(super) const NONE: u32 = u32::MAX;
/// Stands for the neighbour of a side if it has no neighbour or more than one.
pub(super) const NO_NEIGHBOUR: u32 = u32::MAX;

/// Triangles over welded vertices, with the normals, areas and neighbours needed to grow faces.
pub(super) struct Graph<'a> {
    vertices: &'a [DVec3],
    /// Welded vertices of each triangle.
    pub corners: Vec<[u32; 3]>,
    /// Unit normals; zero for triangles without area.
    pub normal: Vec<DVec3>,
    /// Areas.
    pub area: Vec<f64>,
    /// The triangle beyond each side (0 to 1, 1 to 2, 2 to 0); [`NO_NEIGHBOUR`] on borders.
    pub neighbours: Vec<[u32; 3]>,
    /// Distance from its true surface by which rounding may move a vertex.
    pub tolerance: f64,
}

impl<'a> Graph<'a> {
    /// The triangles of a mesh whose coordinates are rounded by up to `tolerance`.
    pub(super) fn new(mesh: &'a TriMesh, tolerance: f64) -> Self {
        let mut corners = mesh.triangles.clone();
        let mut neighbours = beyond(&corners, mesh.vertices.len());
        // In some files each triangle repeats its vertices with other rounding; then all edges are open.
        if neighbours.iter().flatten().any(|&n| n == NO_NEIGHBOUR) && tolerance > 0.0 {
            let Ok(target) = weld_targets(mesh, tolerance, || Ok::<(), Infallible>(()));
            corners.iter_mut().for_each(|t| *t = t.map(|v| target[v as usize]));
            neighbours = beyond(&corners, mesh.vertices.len());
        }
        let (normal, area) = corners
            .par_iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
                let n = (b - a).cross(c - a);
                (n.normalize_or_zero(), 0.5 * n.length())
            })
            .unzip();
        Self { vertices: &mesh.vertices, corners, normal, area, neighbours, tolerance }
    }

    /// Number of triangles.
    pub(super) fn len(&self) -> usize {
        self.corners.len()
    }

    /// The corners of a triangle.
    pub(super) fn points(&self, triangle: usize) -> [DVec3; 3] {
        self.corners[triangle].map(|v| self.vertices[v as usize])
    }

    /// The position of a vertex.
    pub(super) fn vertex(&self, index: u32) -> DVec3 {
        self.vertices[index as usize]
    }

    /// The centroid of a triangle.
    pub(super) fn centroid(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.points(triangle);
        (a + b + c) / 3.0
    }

    /// The neighbours of a triangle.
    pub(super) fn around(&self, triangle: usize) -> impl Iterator<Item = usize> + '_ {
        self.neighbours[triangle].iter().filter(|&&n| n != NO_NEIGHBOUR).map(|&n| n as usize)
    }

    /// Cosine of the angle between the normals of two triangles; 1 where one of them has no area.
    pub(super) fn cosine(&self, a: usize, b: usize) -> f64 {
        let (m, n) = (self.normal[a], self.normal[b]);
        if m == DVec3::ZERO || n == DVec3::ZERO { 1.0 } else { m.dot(n) }
    }
}

/// The triangle beyond each side. Sides are sorted into buckets by their lower vertex index, which takes linear time.
fn beyond(corners: &[[u32; 3]], n_vertices: usize) -> Vec<[u32; 3]> {
    let side = |t: usize, s: usize| (corners[t][s], corners[t][(s + 1) % 3]);
    let mut start = vec![0u32; n_vertices + 1];
    for t in 0..corners.len() {
        for s in 0..3 {
            let (a, b) = side(t, s);
            start[a.min(b) as usize + 1] += 1;
        }
    }
    (0..n_vertices).for_each(|v| start[v + 1] += start[v]);
    let mut next = start.clone();
    // (higher vertex, triangle * 3 + side) of every side, bucket after bucket.
    let mut sides = vec![(0u32, 0u32); 3 * corners.len()];
    for t in 0..corners.len() {
        for s in 0..3 {
            let (a, b) = side(t, s);
            let slot = &mut next[a.min(b) as usize];
            sides[*slot as usize] = (a.max(b), (3 * t + s) as u32);
            *slot += 1;
        }
    }
    let mut neighbours = vec![[NO_NEIGHBOUR; 3]; corners.len()];
    for v in 0..n_vertices {
        let bucket = &mut sides[start[v] as usize..start[v + 1] as usize];
        bucket.sort_unstable();
        for edge in bucket.chunk_by(|a, b| a.0 == b.0) {
            // A side without length joins nothing. A side with more than two triangles is left out too,
            // since it is undefined which of them continue each other.
            if let &[(high, a), (_, b)] = edge
                && high as usize != v
            {
                neighbours[a as usize / 3][a as usize % 3] = b / 3;
                neighbours[b as usize / 3][b as usize % 3] = a / 3;
            }
        }
    }
    neighbours
}
