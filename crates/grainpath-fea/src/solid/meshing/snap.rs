//! Sharp edges for a stuffed mesh: vertices near a sharp edge or corner of the surface move onto it.
//!
//! Method: our own. Stuffing rounds off sharp edges, since it samples the surface only on lattice edges.
//! Corners take the nearest suitable vertex first. Then, in three rounds, an edge of the boundary that runs
//! from one smooth patch to another gives one of its ends to the sharp edge between them, the shortest move
//! first. A move is accepted if every tetrahedron around the vertex keeps a mean ratio (`liu1994`) of 0.25,
//! or does not get worse where it is below that already. Otherwise neighbouring vertices are moved aside, and
//! all are put back if that fails. After each round vertices of tetrahedra below 0.5 are improved by a short
//! pattern search on the worst tetrahedron around them. A vertex only moves within its freedom: in its patch,
//! along its edge, or not at all in a corner.
//!
//! The mean ratio of a tetrahedron is 1 if it is regular, 0 if it is flat and negative if it is inside out.
//! Lengths are in mm. Cost: linear in the tetrahedra, with a query of a tree for each vertex near a sharp
//! edge. Vertices move one after the other in a fixed order, so the result is reproducible.
//!
//! Limits: a vertex moves by at most 0.8 of its cell onto an edge and by less than one cell onto a corner.
//! Where no move is good enough, the edge stays rounded there. A surface without sharp edges only has its
//! poor tetrahedra improved.

use grainpath_core::{Bvh, DVec3, TriMesh};

use super::features::Features;
use super::stuffing::Tets;
use crate::solid::model::adjacency::{boundary, incidence};
use crate::solid::model::tet_shape::mean_ratio;

/// Least mean ratio that the tetrahedra must have after a move; a sliver of 10 degrees has about 0.25.
const LEAST_RATIO: f64 = 0.25;
/// Mean ratio below which tetrahedra are improved.
const GOOD_RATIO: f64 = 0.5;
const ROUNDS: usize = 3;

/// Where a vertex may move.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Bound {
    Free,
    /// On a smooth patch.
    Patch(u32),
    /// On a sharp edge between these patches.
    Edge([u32; 2]),
    /// On a corner between these patches.
    Corner(Vec<u32>),
}

impl Bound {
    pub(super) fn patches(&self) -> &[u32] {
        match self {
            Self::Free => &[],
            Self::Patch(p) => std::slice::from_ref(p),
            Self::Edge(both) => both,
            Self::Corner(all) => all,
        }
    }
}

struct Snapper<'a> {
    mesh: &'a mut Tets,
    features: &'a Features,
    surface: &'a Bvh,
    bounds: Vec<Bound>,
    /// Tetrahedra at each vertex: `around[start[v]..start[v + 1]]`.
    start: Vec<u32>,
    around: Vec<u32>,
    boundary_edges: Vec<[u32; 2]>,
}

/// Moves vertices onto the sharp edges and corners of the surface. Returns where each vertex may
/// still move afterwards.
pub(super) fn snap(mesh: &mut Tets, features: &Features, surface: &Bvh) -> Vec<Bound> {
    let faces = boundary(&mesh.tets);
    let sides = faces.iter().flat_map(|(f, _)| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]]);
    let mut edges: Vec<[u32; 2]> = sides.map(sorted).collect();
    edges.sort_unstable();
    edges.dedup();
    let (start, around) = incidence(mesh.vertices.len(), &mesh.tets);
    let mut bounds = vec![Bound::Free; mesh.vertices.len()];
    for &v in edges.iter().flatten() {
        let p = mesh.vertices[v as usize];
        let facet = surface.closest_point(p, f64::INFINITY).map_or(0, |c| c.triangle);
        bounds[v as usize] = Bound::Patch(features.patch[facet as usize]);
    }
    let mut snapper = Snapper { mesh, features, surface, bounds, start, around, boundary_edges: edges };
    // Corners come first, because only a few vertices are near enough to each. Edges then use the
    // remaining vertices.
    snapper.corners();
    for _ in 0..ROUNDS {
        snapper.edges();
        snapper.improve();
    }
    snapper.bounds
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Snapper<'_> {
    fn tets_at(&self, v: u32) -> impl Iterator<Item = &[u32; 4]> {
        let range = self.start[v as usize] as usize..self.start[v as usize + 1] as usize;
        self.around[range].iter().map(|&t| &self.mesh.tets[t as usize])
    }

    /// The worst mean ratio around a vertex if it were at `p`; negative for a tetrahedron turned
    /// inside out.
    fn worst(&self, v: u32, p: DVec3) -> f64 {
        let place = |i: u32| if i == v { p } else { self.mesh.vertices[i as usize] };
        self.tets_at(v).map(|t| mean_ratio(&t.map(place))).fold(f64::INFINITY, f64::min)
    }

    /// Moves a vertex to a point of the surface if its tetrahedra stay good. If that helps,
    /// neighbouring vertices are moved aside first.
    fn take(&mut self, v: u32, to: DVec3, bound: Bound) -> bool {
        let from = self.mesh.vertices[v as usize];
        let old = self.bounds[v as usize].clone();
        // A neighbourhood that is already bad may stay as bad, but must not get worse.
        let enough = LEAST_RATIO.min(self.worst(v, from));
        if self.worst(v, to) >= enough {
            self.mesh.vertices[v as usize] = to;
            self.bounds[v as usize] = bound;
            return true;
        }
        // The tetrahedra would be turned so far inside out that smoothing the neighbours cannot repair them.
        if self.worst(v, to) < -0.2 {
            return false;
        }
        // Neighbours give way one after the other as long as the worst tetrahedron improves. If
        // that is not enough, all of them are put back.
        let mut neighbours: Vec<u32> = self.tets_at(v).flatten().copied().filter(|&u| u != v).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        let places: Vec<DVec3> = neighbours.iter().map(|&u| self.mesh.vertices[u as usize]).collect();
        self.mesh.vertices[v as usize] = to;
        self.bounds[v as usize] = bound;
        for _ in 0..2 {
            for &u in &neighbours {
                self.improve_at(u);
            }
        }
        let good = self.worst(v, to) >= enough
            && neighbours.iter().all(|&u| self.worst(u, self.mesh.vertices[u as usize]) >= enough);
        if !good {
            self.mesh.vertices[v as usize] = from;
            self.bounds[v as usize] = old;
            for (&u, p) in neighbours.iter().zip(places) {
                self.mesh.vertices[u as usize] = p;
            }
        }
        good
    }

    fn corners(&mut self) {
        let surface: Vec<u32> =
            (0..self.bounds.len() as u32).filter(|&v| self.bounds[v as usize] != Bound::Free).collect();
        let points = TriMesh {
            vertices: surface.iter().map(|&v| self.mesh.vertices[v as usize]).collect(),
            triangles: (0..surface.len() as u32).map(|i| [i; 3]).collect(),
        };
        let tree = Bvh::new(&points);
        let features = self.features;
        let coarsest = self.mesh.size_mm.iter().copied().fold(0.0, f64::max);
        for (corner, patches) in &features.corners {
            let Some(near) = tree.closest_point(*corner, coarsest) else { continue };
            let first = surface[near.triangle as usize];
            // The nearest vertex first, then its neighbours on the surface by distance.
            let mut tries: Vec<u32> = self
                .tets_at(first)
                .flatten()
                .copied()
                .filter(|&u| !matches!(self.bounds[u as usize], Bound::Free | Bound::Corner(_)))
                .collect();
            let distance = |u: u32| self.mesh.vertices[u as usize].distance(*corner);
            tries.sort_unstable_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
            tries.dedup();
            tries.retain(|&u| distance(u) < self.mesh.size_mm[u as usize]);
            for u in tries.into_iter().take(4) {
                if self.take(u, *corner, Bound::Corner(patches.clone())) {
                    break;
                }
            }
        }
    }

    /// Whether an edge of the boundary runs from one patch to another without a vertex on the sharp
    /// edge between.
    fn crosses(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (self.bounds[a as usize].patches(), self.bounds[b as usize].patches());
        !a.iter().any(|p| b.contains(p))
    }

    fn edges(&mut self) {
        let mut crossing: Vec<(f64, u32, [u32; 2])> = Vec::new();
        for &edge in self.boundary_edges.iter().filter(|&&e| self.crosses(e)) {
            for v in edge {
                if let Some((_, d, _)) = self.target(v, edge) {
                    crossing.push((d, v, edge));
                }
            }
        }
        // The shortest move comes first: it distorts least, and often makes moving the other end
        // unnecessary.
        crossing.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for (_, v, edge) in crossing {
            if self.crosses(edge)
                && let Some((to, _, sides)) = self.target(v, edge)
            {
                self.take(v, to, Bound::Edge(sides));
            }
        }
    }

    /// Where a vertex on a smooth patch would move to stand on the sharp edge that its boundary
    /// edge crosses: the point, its distance, and the patches beside the sharp edge.
    fn target(&self, v: u32, edge: [u32; 2]) -> Option<(DVec3, f64, [u32; 2])> {
        let Bound::Patch(own) = self.bounds[v as usize] else { return None };
        let other = if edge[0] == v { edge[1] } else { edge[0] };
        let p = self.mesh.vertices[v as usize];
        let (to, at) = self.features.nearest(p, 0.8 * self.mesh.size_mm[v as usize])?;
        let sides = self.features.edges[at].1;
        let far = self.bounds[other as usize].patches();
        let right = sides.contains(&own) || far.iter().any(|f| sides.contains(f));
        right.then(|| (to, to.distance(p), sides))
    }

    fn improve(&mut self) {
        let place = |t: &[u32; 4]| t.map(|i| self.mesh.vertices[i as usize]);
        let poor = self.mesh.tets.iter().filter(|t| mean_ratio(&place(t)) < GOOD_RATIO);
        let mut at: Vec<u32> = poor.flatten().copied().collect();
        at.sort_unstable();
        at.dedup();
        for _ in 0..2 {
            for &v in &at {
                self.improve_at(v);
            }
        }
    }

    /// Moves a vertex, within its freedom, to where the worst of its tetrahedra is best, by a short
    /// pattern search.
    fn improve_at(&mut self, v: u32) {
        if matches!(self.bounds[v as usize], Bound::Corner(_)) {
            return;
        }
        let start = self.mesh.vertices[v as usize];
        let (mut best, mut value) = (start, self.worst(v, start));
        if value > GOOD_RATIO {
            return;
        }
        let n = self.start[v as usize + 1] - self.start[v as usize];
        let sum: DVec3 = self.tets_at(v).flatten().map(|&u| self.mesh.vertices[u as usize]).sum();
        // The sum contains the vertex itself once for each tetrahedron, so this vector covers part
        // of the way to the mean of the neighbours.
        let to_middle = sum / f64::from(4 * n) - start;
        let mut step = 0.2 * self.mesh.size_mm[v as usize];
        let mut tries = vec![to_middle, 0.5 * to_middle];
        for _ in 0..3 {
            tries.extend(DVec3::AXES.iter().flat_map(|&e| [e * step, -e * step]));
            for d in std::mem::take(&mut tries) {
                let Some(p) = self.held(v, best + d) else { continue };
                let new = self.worst(v, p);
                if new > value + 1e-6 {
                    (best, value) = (p, new);
                }
            }
            step *= 0.5;
        }
        self.mesh.vertices[v as usize] = best;
    }

    /// The nearest point allowed for a vertex; `None` where that point lies on another patch.
    fn held(&self, v: u32, p: DVec3) -> Option<DVec3> {
        match &self.bounds[v as usize] {
            Bound::Free => Some(p),
            Bound::Patch(patch) => {
                let near = self.surface.closest_point(p, 0.5 * self.mesh.size_mm[v as usize])?;
                (self.features.patch[near.triangle as usize] == *patch).then_some(near.point)
            }
            Bound::Edge(sides) => {
                let (to, edge) = self.features.nearest(p, 0.5 * self.mesh.size_mm[v as usize])?;
                (self.features.edges[edge].1 == *sides).then_some(to)
            }
            Bound::Corner(_) => None,
        }
    }
}
