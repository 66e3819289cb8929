//! A grid of right triangles over a region: where direction fields and phases are solved for.

use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::{DVec2, Region};

/// No node here.
const NONE: u32 = u32::MAX;
/// More nodes than this and the grid gets coarser.
const MAX_NODES: f64 = 400_000.0;

/// Two nodes that share a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Its nodes.
    pub ends: [u32; 2],
    /// Across a square of the grid; carries no weight in a Laplacian of right triangles.
    pub diagonal: bool,
}

/// Nodes on a square grid that cover a region and a margin around it, and the triangles between them.
#[derive(Debug, Clone)]
pub struct FieldMesh {
    /// Positions, mm.
    pub nodes: Vec<DVec2>,
    /// Side of a square of the grid, mm.
    pub cell_mm: f64,
    origin: DVec2,
    nx: usize,
    ny: usize,
    /// Node at each place of the grid, row by row.
    index: Vec<u32>,
    /// Each once, by first node.
    pub edges: Vec<Edge>,
    /// Edge indices; edge `k` lies opposite to corner `k`.
    pub triangles: Vec<Triangle>,
}

/// A triangle of the grid.
#[derive(Debug, Clone, Copy)]
pub struct Triangle {
    /// Its nodes.
    pub corners: [u32; 3],
    /// Edge `k` lies opposite to corner `k`.
    pub edges: [u32; 3],
}

impl FieldMesh {
    /// Covers the region; `None` when it is empty.
    pub fn over(region: &Region, cell_mm: f64) -> Option<Self> {
        let bounds = region.bounds()?;
        let size = bounds.size();
        let cell_mm = cell_mm.max((size.x * size.y / (4.0 * MAX_NODES)).sqrt());
        let cell_mm = cell_mm.max((region.area_mm2() / MAX_NODES).sqrt());
        let covered = region.offset(1.5 * cell_mm, Join::Miter(2.0));
        let inside = LineClipper::new(&covered);
        let origin = bounds.min - 2.0 * cell_mm;
        let count = |mm: f64| (mm / cell_mm).ceil() as usize + 5;
        let (nx, ny) = (count(size.x), count(size.y));
        let place = |i: usize, j: usize| origin + cell_mm * DVec2::new(i as f64, j as f64);
        let mut index = vec![NONE; nx * ny];
        let mut nodes = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                if inside.contains(place(i, j)) {
                    index[j * nx + i] = nodes.len() as u32;
                    nodes.push(place(i, j));
                }
            }
        }
        let (edges, triangles) = (Vec::new(), Vec::new());
        let mut mesh = Self { nodes, cell_mm, origin, nx, ny, index, edges, triangles };
        mesh.connect();
        Some(mesh)
    }

    /// The nodes around a point and their shares of it, nodes outside the mesh left out; far outside, the nearest
    /// node alone.
    pub fn around(&self, p: DVec2) -> ([u32; 4], [f64; 4]) {
        let q = (p - self.origin) / self.cell_mm;
        let clamp = |v: f64, n: usize| v.clamp(0.0, n as f64 - 1.001);
        let q = DVec2::new(clamp(q.x, self.nx), clamp(q.y, self.ny));
        let (i, j) = (q.x as usize, q.y as usize);
        let (u, v) = (q.x - i as f64, q.y - j as f64);
        let places = [
            (i, j, (1.0 - u) * (1.0 - v)),
            (i + 1, j, u * (1.0 - v)),
            (i, j + 1, (1.0 - u) * v),
            (i + 1, j + 1, u * v),
        ];
        let mut nodes = [0; 4];
        let mut shares = [0.0; 4];
        let mut sum = 0.0;
        for (k, (i, j, share)) in places.into_iter().enumerate() {
            let node = self.index[j * self.nx + i];
            if node != NONE {
                (nodes[k], shares[k]) = (node, share);
                sum += share;
            }
        }
        if sum > 1e-9 {
            return (nodes, shares.map(|s| s / sum));
        }
        ([self.nearest(i, j), 0, 0, 0], [1.0, 0.0, 0.0, 0.0])
    }

    /// The node nearest to a place of the grid, looked for in growing squares.
    fn nearest(&self, i: usize, j: usize) -> u32 {
        for ring in 1..self.nx.max(self.ny) {
            let mut best = (usize::MAX, NONE);
            for jj in j.saturating_sub(ring)..=(j + ring).min(self.ny - 1) {
                for ii in i.saturating_sub(ring)..=(i + ring).min(self.nx - 1) {
                    let node = self.index[jj * self.nx + ii];
                    let off = ii.abs_diff(i).pow(2) + jj.abs_diff(j).pow(2);
                    if node != NONE && off < best.0 {
                        best = (off, node);
                    }
                }
            }
            if best.1 != NONE {
                return best.1;
            }
        }
        0
    }

    fn connect(&mut self) {
        let (nx, ny) = (self.nx, self.ny);
        let index = std::mem::take(&mut self.index);
        let at = |i: usize, j: usize| index[j * nx + i];
        // Edges of the node at (i, j): to the right, upwards, and the diagonal of the square to its upper right.
        let mut of_node = vec![[NONE; 3]; nx * ny];
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let mut add = |a: u32, b: u32, diagonal: bool| {
                    if a == NONE || b == NONE {
                        return NONE;
                    }
                    self.edges.push(Edge { ends: [a, b], diagonal });
                    self.edges.len() as u32 - 1
                };
                let here = at(i, j);
                let right = add(here, at(i + 1, j), false);
                let up = add(here, at(i, j + 1), false);
                // Diagonals alternate, so that no direction is favoured.
                let across = if (i + j) % 2 == 0 {
                    add(here, at(i + 1, j + 1), true)
                } else {
                    add(at(i + 1, j), at(i, j + 1), true)
                };
                of_node[j * nx + i] = [right, up, across];
            }
        }
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let [bottom, left, across] = of_node[j * nx + i];
                let right = of_node[j * nx + i + 1][1];
                let top = of_node[(j + 1) * nx + i][0];
                let halves: [([usize; 3], [u32; 3]); 2] = if (i + j) % 2 == 0 {
                    [([0, 1, 2], [right, across, bottom]), ([0, 2, 3], [top, left, across])]
                } else {
                    [([0, 1, 3], [across, left, bottom]), ([1, 2, 3], [top, across, right])]
                };
                for (c, edges) in halves {
                    if edges.iter().all(|&e| e != NONE) {
                        self.triangles.push(Triangle { corners: c.map(|k| corners[k]), edges });
                    }
                }
            }
        }
        self.index = index;
    }
}

/// Solves a symmetric positive definite system to a residual of `tolerance` times the right side's length.
pub fn conjugate_gradients(
    mut x: Vec<f64>,
    rhs: &[f64],
    apply: impl Fn(&[f64], &mut [f64]),
    tolerance: f64,
    max_steps: usize,
) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut q = vec![0.0; x.len()];
    apply(&x, &mut q);
    let mut r: Vec<f64> = rhs.iter().zip(&q).map(|(b, q)| b - q).collect();
    let mut p = r.clone();
    let mut rr = dot(&r, &r);
    let enough = tolerance * tolerance * dot(rhs, rhs);
    for _ in 0..max_steps {
        if rr <= enough {
            break;
        }
        apply(&p, &mut q);
        let alpha = rr / dot(&p, &q);
        x.iter_mut().zip(&p).for_each(|(x, p)| *x += alpha * p);
        r.iter_mut().zip(&q).for_each(|(r, q)| *r -= alpha * q);
        let new = dot(&r, &r);
        let beta = new / rr;
        rr = new;
        p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + beta * *p);
    }
    x
}
