//! The stress field of a plate: its values at any point, and an estimate of the error that the mesh leaves.
//!
//! Method: stresses at the nodes are recovered from those inside the elements (`zienkiewicz1992`). Their
//! difference from the stresses inside, in the mean square over the area, estimates the error relative to the
//! recovered stress (`zienkiewicz1987`); the norm of the stress stands for the energy norm. Between nodes
//! each component is linear in the four triangles between corners and middle nodes, so no value overshoots
//! the nodal ones. A grid of buckets, about one element in each, finds the element at a point.
//!
//! Stresses are in MPa, components xx, yy, xy, `(n_nodes)`; positions in mm. Cost: linear in the elements to
//! build. A query visits a few buckets; a point outside the plate may visit many rings of them.
//!
//! Degenerate cases: outside the plate the stress is that of the nearest point. A mesh without elements has
//! stress zero everywhere. Without stress the estimated error is zero. Elements are searched by their
//! corners, as if their sides were straight.

use grainpath_core::buckets::{Buckets, CellGrid};
use grainpath_core::math::cross;
use grainpath_core::{Bounds2, DVec2, segment};

use super::patch_fit;
use super::plane_mesh::PlaneMesh;
use super::plane_problem::PlaneProblem;
use super::quadratic_triangle::POINTS;
use crate::principal::{PlaneTensor, von_mises_plane};

/// Stress at the nodes of a plate, searchable by position.
#[derive(Debug, Clone)]
pub struct PlaneStress {
    mesh: PlaneMesh,
    /// Stress at every node, MPa.
    nodal: Vec<PlaneTensor>,
    /// Estimated share of the energy norm that the mesh misses (`zienkiewicz1987`).
    error: f64,
    buckets: Buckets,
}

impl PlaneStress {
    pub(super) fn recovered(problem: &PlaneProblem<'_>, displacement_mm: &[DVec2]) -> Self {
        let (nodal, inner) = patch_fit::recover(problem, displacement_mm);
        let mesh = problem.mesh.clone();
        let (mut missed, mut all) = (0.0, 0.0);
        for (e, stresses) in mesh.elements.iter().zip(&inner) {
            let [a, b, c] = [e[0], e[1], e[2]].map(|i| mesh.nodes[i as usize]);
            let area = 0.5 * cross(b - a, c - a);
            for ((l, _), inside) in POINTS.iter().zip(stresses) {
                let smooth = interpolated(&nodal, e, *l);
                // The norm of the stress replaces the energy norm: it needs no compliance, and the
                // two norms differ by a bounded factor only.
                let square = |t: PlaneTensor| t[0] * t[0] + t[1] * t[1] + 2.0 * t[2] * t[2];
                let off = [0, 1, 2].map(|k| smooth[k] - inside[k]);
                missed += area * square(off);
                all += area * square(smooth);
            }
        }
        let error = (missed / all.max(f64::MIN_POSITIVE)).sqrt();
        Self::from_nodes(mesh, nodal, error)
    }

    /// A field from stresses given at the nodes.
    pub(crate) fn from_nodes(mesh: PlaneMesh, nodal: Vec<PlaneTensor>, error: f64) -> Self {
        let bounds = Bounds2::around_points(mesh.nodes.iter().copied());
        let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
        let size = bounds.size().max(DVec2::splat(1e-9));
        let cell_mm = (size.x * size.y / mesh.elements.len().max(1) as f64).sqrt();
        let cells = CellGrid::covering(Bounds2 { min: bounds.min, max: bounds.min + size }, cell_mm, 3000);
        let buckets = Buckets::new(cells, mesh.elements.len(), |t, add| {
            let e = &mesh.elements[t];
            let p = [e[0], e[1], e[2]].map(|i| mesh.nodes[i as usize]);
            let (low, high) = (p[0].min(p[1]).min(p[2]), p[0].max(p[1]).max(p[2]));
            cells.block(cells.cell_of(low), cells.cell_of(high)).for_each(|at| add(cells.index(at)));
        });
        Self { mesh, nodal, error, buckets }
    }

    /// The mesh.
    pub fn mesh(&self) -> &PlaneMesh {
        &self.mesh
    }

    /// Stress at every node of the mesh, MPa, `(n_nodes)`.
    pub fn nodal_mpa(&self) -> &[PlaneTensor] {
        &self.nodal
    }

    /// Estimated share of the stress, in the mean square, that the mesh misses.
    pub fn error_estimate(&self) -> f64 {
        self.error
    }

    /// Greatest von Mises stress at any node, MPa.
    pub fn max_von_mises_mpa(&self) -> f64 {
        self.nodal.iter().map(|t| von_mises_plane(*t)).fold(0.0, f64::max)
    }

    /// Stress at a point, MPa, components interpolated; outside the plate, that of its nearest
    /// point.
    pub fn at(&self, p: DVec2) -> PlaneTensor {
        let Some((t, l)) = self.locate(p) else { return [0.0; 3] };
        interpolated(&self.nodal, &self.mesh.elements[t], l)
    }

    /// The element at a point and the area coordinates in it; outside the plate, those of its
    /// nearest point.
    pub fn locate(&self, p: DVec2) -> Option<(usize, [f64; 3])> {
        let cells = &self.buckets.cells;
        let own = cells.cell_of(p);
        let corners = |t: u32| {
            let e = self.mesh.elements[t as usize];
            [e[0], e[1], e[2]].map(|i| self.mesh.nodes[i as usize])
        };
        // Most points lie in an element of their own cell, which is found without the distances to the others.
        for &t in self.buckets.members(cells.index(own)) {
            if let Some(l) = shares_inside(corners(t), p) {
                return Some((t as usize, l));
            }
        }
        let mut best: Option<(f64, usize, [f64; 3])> = None;
        for ring in 0..cells.nx.max(cells.ny) {
            // Every element in this ring or beyond is at least this far away.
            let reach = ring.saturating_sub(1) as f64 * cells.cell_mm;
            if best.is_some_and(|b| ring > 0 && b.0 <= reach * reach) {
                break;
            }
            let away = |at: &[usize; 2]| at[0].abs_diff(own[0]).max(at[1].abs_diff(own[1])) == ring;
            for at in cells.neighbourhood(own, ring).filter(away) {
                for &t in self.buckets.members(cells.index(at)) {
                    let (off, l) = nearest_in(corners(t), p);
                    if best.is_none_or(|b| off < b.0) {
                        best = Some((off, t as usize, l));
                    }
                    if off == 0.0 {
                        return best.map(|b| (b.1, b.2));
                    }
                }
            }
        }
        best.map(|b| (b.1, b.2))
    }
}

/// The area coordinates of a point in a triangle; `None` outside.
fn shares_inside(c: [DVec2; 3], p: DVec2) -> Option<[f64; 3]> {
    let double = cross(c[1] - c[0], c[2] - c[0]);
    let l = [cross(c[1] - p, c[2] - p) / double, cross(c[2] - p, c[0] - p) / double];
    let l = [l[0], l[1], 1.0 - l[0] - l[1]];
    // The limit of -1e-12 allows for rounding, so that points on a shared side belong to both elements.
    l.iter().all(|v| *v >= -1e-12).then(|| l.map(|v| v.max(0.0)))
}

/// The point of a triangle nearest to `p`: its squared distance (0 inside) and its area
/// coordinates.
fn nearest_in(c: [DVec2; 3], p: DVec2) -> (f64, [f64; 3]) {
    if let Some(l) = shares_inside(c, p) {
        return (0.0, l);
    }
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for k in 0..3 {
        let (a, b) = (c[k], c[(k + 1) % 3]);
        let t = segment::closest_share(p, a, b);
        let off = p.distance_squared(a.lerp(b, t));
        if off < best.0 {
            let mut l = [0.0; 3];
            (l[k], l[(k + 1) % 3]) = (1.0 - t, t);
            best = (off, l);
        }
    }
    best
}

/// Stress components between the nodes. They are linear in each of the four triangles between
/// corners and middle nodes, so no value overshoots the nodal values.
fn interpolated(nodal: &[PlaneTensor], e: &[u32; 6], l: [f64; 3]) -> PlaneTensor {
    let (at, w): ([usize; 3], [f64; 3]) = if l[0] >= 0.5 {
        ([0, 3, 5], [2.0 * l[0] - 1.0, 2.0 * l[1], 2.0 * l[2]])
    } else if l[1] >= 0.5 {
        ([1, 4, 3], [2.0 * l[1] - 1.0, 2.0 * l[2], 2.0 * l[0]])
    } else if l[2] >= 0.5 {
        ([2, 5, 4], [2.0 * l[2] - 1.0, 2.0 * l[0], 2.0 * l[1]])
    } else {
        ([4, 5, 3], [1.0 - 2.0 * l[0], 1.0 - 2.0 * l[1], 1.0 - 2.0 * l[2]])
    };
    let v = at.map(|k| nodal[e[k] as usize]);
    [0, 1, 2].map(|c| w[0] * v[0][c] + w[1] * v[1][c] + w[2] * v[2][c])
}
