//! Sharp features of a surface: edges, corners, and the smooth patches between them.
//!
//! Method: two facets meet in a sharp edge if their normals differ by more than 40 degrees. Facets connected
//! without a sharp edge form a patch, named by its lowest facet (union-find). A corner is a point where one
//! sharp edge ends, three or more meet, or the line of two turns by more than 40 degrees. A tree of boxes
//! over the sharp edges answers which is the nearest one; each edge is stored in it as a triangle with a
//! repeated corner.
//!
//! Lengths are in mm. `patch` has one entry for each facet. Cost: sorting three edges a facet and building
//! the tree; a query takes a time that grows with the logarithm of the sharp edges.
//!
//! Degenerate cases: facets wound against each other are compared as if they were wound alike. A facet
//! without area joins its neighbours. An edge of one facet, or of three or more, joins no patches and is not
//! sharp.

use std::collections::BTreeMap;

use grainpath_core::mesh::EdgeUses;
use grainpath_core::{Bvh, DVec3, DisjointSets, TriMesh};

/// Cosine of the turn (40 degrees) above which two facets meet in a sharp edge.
const SHARP_COS: f64 = 0.766;

/// The sharp edges of a mesh.
pub(super) struct Features {
    /// Smooth patch of each facet, named by its first facet.
    pub(super) patch: Vec<u32>,
    /// The sharp edges with the patches on both sides.
    pub(super) edges: Vec<([DVec3; 2], [u32; 2])>,
    /// Points where sharp edges end, branch or turn, with the patches around.
    pub(super) corners: Vec<(DVec3, Vec<u32>)>,
    tree: Bvh,
}

impl Features {
    pub(super) fn find(mesh: &TriMesh) -> Self {
        let v = |i: u32| mesh.vertices[i as usize];
        let normal = |t: usize| mesh.normal(mesh.triangles[t]);
        let mut patches = DisjointSets::new(mesh.triangles.len());
        let mut sharp = Vec::new();
        for uses in EdgeUses::count(mesh).edges() {
            let uses: Vec<(usize, bool)> = uses.collect();
            let &[(s, s_down), (t, t_down)] = uses.as_slice() else { continue };
            // Facets wound against each other have normals of opposite sign.
            let turned = normal(s).dot(normal(t)) * if s_down == t_down { -1.0 } else { 1.0 };
            // A facet without area has no normal and joins its neighbours, or it would cut the
            // patch in two.
            if turned > SHARP_COS || normal(s) == DVec3::ZERO || normal(t) == DVec3::ZERO {
                patches.union(s, t);
            } else {
                sharp.push((shared(mesh.triangles[s], mesh.triangles[t]), [s as u32, t as u32]));
            }
        }
        let patch = patches.names();
        let mut at: BTreeMap<u32, Vec<(u32, [u32; 2])>> = BTreeMap::new();
        let mut edges = Vec::new();
        for (ends, facets) in sharp {
            let Some([a, b]) = ends else { continue };
            let sides = facets.map(|f| patch[f as usize]);
            edges.push(([v(a), v(b)], sides));
            at.entry(a).or_default().push((b, sides));
            at.entry(b).or_default().push((a, sides));
        }
        // Two sharp edges that meet at a point make a corner only if the line turns there. Any
        // other number of edges always makes one.
        let is_corner = |p: u32, ways: &[(u32, [u32; 2])]| match ways {
            [(q, _), (r, _)] => {
                (v(p) - v(*q)).normalize_or_zero().dot((v(*r) - v(p)).normalize_or_zero()) < SHARP_COS
            }
            _ => true,
        };
        let corners = at.iter().filter(|(p, ways)| is_corner(**p, ways)).map(|(&p, ways)| {
            let mut patches: Vec<u32> = ways.iter().flat_map(|w| w.1).collect();
            patches.sort_unstable();
            patches.dedup();
            (v(p), patches)
        });
        let corners = corners.collect();
        let tree = segments(&edges);
        Self { patch, edges, corners, tree }
    }

    /// The nearest point on a sharp edge within `reach`, and the edge's index.
    pub(super) fn nearest(&self, p: DVec3, reach: f64) -> Option<(DVec3, usize)> {
        self.tree.closest_point(p, reach).map(|c| (c.point, c.triangle as usize))
    }
}

fn segments(edges: &[([DVec3; 2], [u32; 2])]) -> Bvh {
    let vertices = edges.iter().flat_map(|e| e.0).collect();
    // Segments are stored as triangles with a repeated corner, so that one tree serves both.
    let triangles = (0..edges.len() as u32).map(|i| [2 * i, 2 * i + 1, 2 * i + 1]).collect();
    Bvh::new(&TriMesh { vertices, triangles })
}

fn shared(s: [u32; 3], t: [u32; 3]) -> Option<[u32; 2]> {
    let both: Vec<u32> = s.into_iter().filter(|i| t.contains(i)).collect();
    <[u32; 2]>::try_from(both).ok()
}
