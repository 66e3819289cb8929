//! A grid of right triangles over a room.

use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::{DVec2, Region};

/// No node here.
const NONE: u32 = u32::MAX;
/// More nodes than this and the grid gets coarser.
const MAX_NODES: f64 = 400_000.0;

/// Two nodes that share a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    pub ends: [u32; 2],
    /// Across a square of the grid; carries no weight in a Laplacian of right triangles.
    pub diagonal: bool,
}

/// Nodes on a square grid that cover a region and a margin around it, and the triangles between them.
pub struct FieldMesh {
    pub nodes: Vec<DVec2>,
    pub cell_mm: f64,
    /// Each once, by first node.
    pub edges: Vec<Edge>,
    /// Edge indices; edge `k` lies opposite to corner `k`.
    pub triangles: Vec<Triangle>,
}

/// A triangle of the grid.
#[derive(Debug, Clone, Copy)]
pub struct Triangle {
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
        let mut mesh = Self { nodes, cell_mm, edges: Vec::new(), triangles: Vec::new() };
        mesh.connect(&index, nx, ny);
        Some(mesh)
    }

    fn connect(&mut self, index: &[u32], nx: usize, ny: usize) {
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
    }
}
