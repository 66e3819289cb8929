//! Stress over a plate.

use grainpath_core::math::cross;
use grainpath_core::{Bounds2, DVec2};

use super::element::POINTS;
use super::{PlaneMesh, PlaneProblem, recover};
use crate::principal::{PlaneTensor, von_mises_plane};

/// Stress at the nodes of a plate, and where they are: for asking at any point.
#[derive(Debug, Clone)]
pub struct PlaneStress {
    mesh: PlaneMesh,
    /// Stress at every node, MPa.
    nodal: Vec<PlaneTensor>,
    /// Estimated share of the energy norm that the mesh misses (Zienkiewicz and Zhu).
    error: f64,
    origin: DVec2,
    cell_mm: f64,
    nx: usize,
    ny: usize,
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl PlaneStress {
    pub(super) fn recovered(problem: &PlaneProblem<'_>, displacement_mm: &[DVec2]) -> Self {
        let (nodal, inner) = recover::recover(problem, displacement_mm);
        let mesh = problem.mesh.clone();
        let (mut missed, mut all) = (0.0, 0.0);
        for (e, stresses) in mesh.elements.iter().zip(&inner) {
            let [a, b, c] = [e[0], e[1], e[2]].map(|i| mesh.nodes[i as usize]);
            let area = 0.5 * cross(b - a, c - a);
            for ((l, _), inside) in POINTS.iter().zip(stresses) {
                let smooth = interpolated(&nodal, e, *l);
                let square = |t: PlaneTensor| t[0] * t[0] + t[1] * t[1] + 2.0 * t[2] * t[2];
                let off = [0, 1, 2].map(|k| smooth[k] - inside[k]);
                missed += area * square(off);
                all += area * square(smooth);
            }
        }
        let error = (missed / all.max(f64::MIN_POSITIVE)).sqrt();
        Self::of(mesh, nodal, error)
    }

    /// Stress given at the nodes.
    pub fn of(mesh: PlaneMesh, nodal: Vec<PlaneTensor>, error: f64) -> Self {
        let bounds = Bounds2::of(mesh.nodes.iter().copied());
        let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
        let size = bounds.size().max(DVec2::splat(1e-9));
        let cell_mm = (size.x * size.y / mesh.elements.len().max(1) as f64).sqrt();
        let cell_mm = cell_mm.max(size.max_element() / 3000.0);
        let count = |mm: f64| (mm / cell_mm) as usize + 1;
        let (nx, ny) = (count(size.x), count(size.y));
        let mut this = Self {
            mesh,
            nodal,
            error,
            origin: bounds.min,
            cell_mm,
            nx,
            ny,
            starts: vec![0; nx * ny + 1],
            members: Vec::new(),
        };
        let mut starts = std::mem::take(&mut this.starts);
        let all: Vec<[usize; 4]> = this.mesh.elements.iter().map(|e| this.cells(e)).collect();
        let each = |[i0, i1, j0, j1]: [usize; 4]| (j0..=j1).flat_map(move |j| (i0..=i1).map(move |i| (i, j)));
        all.iter().for_each(|r| each(*r).for_each(|(i, j)| starts[j * nx + i + 1] += 1));
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut next = starts.clone();
        let mut members = vec![0; starts[nx * ny] as usize];
        for (t, r) in all.iter().enumerate() {
            for (i, j) in each(*r) {
                members[next[j * nx + i] as usize] = t as u32;
                next[j * nx + i] += 1;
            }
        }
        (this.starts, this.members) = (starts, members);
        this
    }

    fn cells(&self, e: &[u32; 6]) -> [usize; 4] {
        let p = [e[0], e[1], e[2]].map(|i| self.mesh.nodes[i as usize]);
        let (low, high) = (p[0].min(p[1]).min(p[2]), p[0].max(p[1]).max(p[2]));
        let ([i0, j0], [i1, j1]) = (self.cell(low), self.cell(high));
        [i0, i1, j0, j1]
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        let q = (p - self.origin) / self.cell_mm;
        [(q.x.max(0.0) as usize).min(self.nx - 1), (q.y.max(0.0) as usize).min(self.ny - 1)]
    }

    /// The mesh.
    pub fn mesh(&self) -> &PlaneMesh {
        &self.mesh
    }

    /// Stress at every node of the mesh, MPa.
    pub fn nodal_mpa(&self) -> &[PlaneTensor] {
        &self.nodal
    }

    /// Estimated share of the stress, in the mean square, that the mesh misses.
    pub fn error_estimate(&self) -> f64 {
        self.error
    }

    /// The greatest equivalent stress at any node, MPa.
    pub fn max_von_mises_mpa(&self) -> f64 {
        self.nodal.iter().map(|t| von_mises_plane(*t)).fold(0.0, f64::max)
    }

    /// Stress at a point, components interpolated; outside, that of the nearest place of the plate.
    pub fn at(&self, p: DVec2) -> PlaneTensor {
        let Some((t, l)) = self.locate(p) else { return [0.0; 3] };
        interpolated(&self.nodal, &self.mesh.elements[t], l)
    }

    /// The element at a point and the area coordinates in it; the nearest place where it is in none.
    pub fn locate(&self, p: DVec2) -> Option<(usize, [f64; 3])> {
        let [ci, cj] = self.cell(p);
        let mut best: Option<(f64, usize, [f64; 3])> = None;
        for ring in 0..self.nx.max(self.ny) {
            let reach = ring.saturating_sub(1) as f64 * self.cell_mm;
            if best.is_some_and(|b| ring > 0 && b.0 <= reach * reach) {
                break;
            }
            let rows = cj.saturating_sub(ring)..=(cj + ring).min(self.ny - 1);
            for j in rows {
                for i in ci.saturating_sub(ring)..=(ci + ring).min(self.nx - 1) {
                    if i.abs_diff(ci).max(j.abs_diff(cj)) != ring {
                        continue;
                    }
                    let cell = j * self.nx + i;
                    for &t in &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                        let e = self.mesh.elements[t as usize];
                        let c = [e[0], e[1], e[2]].map(|i| self.mesh.nodes[i as usize]);
                        let l = nearest_in(c, p);
                        let off = p.distance_squared(l[0] * c[0] + l[1] * c[1] + l[2] * c[2]);
                        if best.is_none_or(|b| off < b.0) {
                            best = Some((off, t as usize, l));
                        }
                        if off == 0.0 {
                            return best.map(|b| (b.1, b.2));
                        }
                    }
                }
            }
        }
        best.map(|b| (b.1, b.2))
    }
}

/// Area coordinates of the point of a triangle nearest to `p`.
fn nearest_in(c: [DVec2; 3], p: DVec2) -> [f64; 3] {
    let double = cross(c[1] - c[0], c[2] - c[0]);
    let l = [cross(c[1] - p, c[2] - p) / double, cross(c[2] - p, c[0] - p) / double];
    let l = [l[0], l[1], 1.0 - l[0] - l[1]];
    if l.iter().all(|v| *v >= -1e-12) {
        return l.map(|v| v.max(0.0));
    }
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for k in 0..3 {
        let (a, b) = (c[k], c[(k + 1) % 3]);
        let t = ((p - a).dot(b - a) / a.distance_squared(b).max(1e-300)).clamp(0.0, 1.0);
        let off = p.distance_squared(a.lerp(b, t));
        if off < best.0 {
            let mut l = [0.0; 3];
            (l[k], l[(k + 1) % 3]) = (1.0 - t, t);
            best = (off, l);
        }
    }
    best.1
}

/// Components between the nodes: linear in the four triangles that the middles of the sides make, so that nothing
/// overshoots.
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
