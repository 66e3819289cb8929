//! A grid of right triangles over a region, on which direction fields and phases are computed.
//!
//! Nodes lie on a square grid; lengths are in mm. Edges are of three kinds, stored one kind after the
//! other: sides to the right, sides upwards, diagonals. Within a kind they are sorted row by row, so
//! that a product of a matrix with a vector mostly runs over contiguous parts of arrays
//! (`FieldMesh::runs`). Cost and memory: linear in the nodes, which are at most about 400 000.

use std::ops::Range;
use std::sync::OnceLock;

use crate::conjugate_gradients::{CgSettings, conjugate_gradients};
use crate::mask::{Mask, MaskGrid};
use crate::math::{rotated, turned_back};
use crate::poly::Join;
use crate::{Bounds2, DVec2, DisjointSets, Region, lanes};

/// Marks a place of the grid without a node.
const NONE: u32 = u32::MAX;
/// Number of nodes above which the grid becomes coarser. Source: derived. A node, its three edges and two triangles take
/// about 105 bytes, and the matrix and the vectors of a solution 65 more: 70 MB.
const MAX_NODES: f64 = 400_000.0;

/// An edge between two nodes: a side of a square, or a diagonal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Its nodes.
    pub ends: [u32; 2],
    /// Whether the edge is the diagonal of a square. Diagonals have zero weight in the Laplacian of a grid of
    /// right triangles.
    pub diagonal: bool,
}

/// The nodes of a square grid over a region with a margin around it, and the triangles between these nodes.
#[derive(Debug, Clone)]
pub struct FieldMesh {
    /// Positions of the nodes, mm.
    pub nodes: Vec<DVec2>,
    /// Side of a square of the grid, mm.
    pub cell_mm: f64,
    /// Unit vector along the rows of the grid.
    pub along: DVec2,
    /// The first place of the grid, in a frame whose X axis is `along`.
    origin: DVec2,
    nx: usize,
    ny: usize,
    /// Index of the node at each place of the grid, row by row; [`NONE`] without a node.
    index: Vec<u32>,
    /// Every edge once: first the sides to the right, then those upwards, then the diagonals; each kind
    /// row by row.
    pub edges: Vec<Edge>,
    /// The edges that are sides of squares, split into stretches in which edges and nodes have consecutive
    /// numbers.
    runs: Vec<EdgeStretch>,
    /// The triangles, each half of a square, row by row.
    pub triangles: Vec<Triangle>,
    /// The mesh of every second row and column, once it was asked for.
    coarser: OnceLock<Option<Box<Coarser>>>,
}

/// The mesh of every second row and column of another.
#[derive(Debug, Clone)]
pub struct Coarser {
    /// The mesh.
    pub mesh: FieldMesh,
    /// The node of the finer mesh that each of its nodes is.
    pub kept: Vec<u32>,
}

/// A stretch of edges with consecutive numbers. Their first nodes have consecutive numbers, and so have
/// their second nodes.
#[derive(Debug, Clone, Copy)]
struct EdgeStretch {
    edge: u32,
    ends: [u32; 2],
    n: u32,
}

/// A run of edges, as index ranges of the edges and of their first and second nodes.
#[derive(Debug, Clone)]
pub struct RunOf {
    /// Edges.
    pub edges: Range<usize>,
    /// Their first nodes.
    pub from: Range<usize>,
    /// Their second nodes.
    pub to: Range<usize>,
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
    /// Covers the region with a margin of one and a half cells; `None` for an empty region.
    pub fn over(region: &Region, cell_mm: f64) -> Option<Self> {
        Self::along(region, cell_mm, DVec2::X)
    }

    /// [`FieldMesh::over`] on a grid whose rows lie along a unit vector.
    pub fn along(region: &Region, cell_mm: f64, along: DVec2) -> Option<Self> {
        let region = &region.turned(DVec2::new(along.x, -along.y));
        let bounds = region.bounds()?;
        let size = bounds.size();
        // The first line limits the places in the bounding box, of which a thin diagonal region fills
        // only few. The second limits the number of nodes.
        let cell_mm = cell_mm.max((size.x * size.y / (4.0 * MAX_NODES)).sqrt());
        let cell_mm = cell_mm.max((region.area_mm2() / MAX_NODES).sqrt());
        // With a margin, every point of the region lies in a square whose four corners are nodes.
        let covered = region.offset(1.5 * cell_mm, Join::Miter(2.0));
        // The array extends two cells beyond the bounds on each side, so that the nodes of the margin
        // have neighbours in it.
        let origin = bounds.min - 2.0 * cell_mm;
        let count = |mm: f64| (mm / cell_mm).ceil() as usize + 5;
        let (nx, ny) = (count(size.x), count(size.y));
        let place = |i: usize, j: usize| origin + cell_mm * DVec2::new(i as f64, j as f64);
        // Places are the centres of the mask's cells.
        let bounds = Bounds2 { min: origin - 0.5 * cell_mm, max: place(nx, ny) };
        let inside = Mask::from_region(MaskGrid::exactly(bounds, cell_mm), &covered);
        let mut index = vec![NONE; nx * ny];
        let mut nodes = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                if inside.contains(place(i, j)) {
                    index[j * nx + i] = nodes.len() as u32;
                    nodes.push(rotated(place(i, j), along));
                }
            }
        }
        Some(Self::connected(nodes, cell_mm, along, origin, [nx, ny], index))
    }

    /// The mesh of every second row and column. `None` where it would have more or fewer parts than this mesh: larger squares bridge
    /// a slit that smaller ones do not.
    pub fn coarser(&self) -> Option<&Coarser> {
        self.coarser.get_or_init(|| self.coarsened().map(Box::new)).as_deref()
    }

    fn coarsened(&self) -> Option<Coarser> {
        let (n_columns, n_rows) = (self.nx.div_ceil(2), self.ny.div_ceil(2));
        // The last row and column stay without nodes, as those of this mesh are: edges begin at the lower left of each square.
        let (nx, ny) = (n_columns + 1, n_rows + 1);
        let mut index = vec![NONE; nx * ny];
        let mut kept = Vec::with_capacity(self.nodes.len() / 4 + nx + ny);
        for j in 0..n_rows {
            for i in 0..n_columns {
                let node = self.index[2 * j * self.nx + 2 * i];
                if node != NONE {
                    index[j * nx + i] = kept.len() as u32;
                    kept.push(node);
                }
            }
        }
        let nodes = kept.iter().map(|&k| self.nodes[k as usize]).collect();
        let mesh = Self::connected(nodes, 2.0 * self.cell_mm, self.along, self.origin, [nx, ny], index);
        (mesh.n_pieces() == self.n_pieces()).then_some(Coarser { mesh, kept })
    }

    /// Number of parts of the mesh that no side of a square connects.
    fn n_pieces(&self) -> usize {
        let mut pieces = DisjointSets::new(self.nodes.len());
        let sides = self.runs().flat_map(|run| run.from.zip(run.to));
        self.nodes.len() - sides.filter(|&(a, b)| pieces.union(a, b)).count()
    }

    /// The sides of squares in runs of consecutive edges. They are all edges except the diagonals, which come last.
    pub fn runs(&self) -> impl Iterator<Item = RunOf> + '_ {
        let range = |first: u32, n: u32| first as usize..(first + n) as usize;
        self.runs.iter().map(move |r| RunOf {
            edges: range(r.edge, r.n),
            from: range(r.ends[0], r.n),
            to: range(r.ends[1], r.n),
        })
    }

    /// The nodes around a point and their interpolation weights, which add up to 1. Missing nodes get weight
    /// zero; far outside the mesh, the nearest node alone has weight 1.
    pub fn around(&self, p: DVec2) -> ([u32; 4], [f64; 4]) {
        let q = (turned_back(p, self.along) - self.origin) / self.cell_mm;
        // The position is kept a little below the last node, so that the upper corners of its square exist.
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
        // The weights of the existing nodes are scaled up, so that the value near the border is their
        // average.
        if sum > 1e-9 {
            return (nodes, shares.map(|s| s / sum));
        }
        ([self.nearest(i, j), 0, 0, 0], [1.0, 0.0, 0.0, 0.0])
    }

    /// The node nearest to a place of the grid, searched in growing squares.
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

    /// The mesh of these nodes, with the edges and triangles between them. `index` holds the node at each place of the grid.
    fn connected(
        nodes: Vec<DVec2>,
        cell_mm: f64,
        along: DVec2,
        origin: DVec2,
        [nx, ny]: [usize; 2],
        index: Vec<u32>,
    ) -> Self {
        let (mut edges, mut runs, mut triangles) = (Vec::new(), Vec::<EdgeStretch>::new(), Vec::new());
        let at = |i: usize, j: usize| index[j * nx + i];
        // The edges of the node at (i, j): the side to the right, the side upwards, and the diagonal of
        // the square to its upper right.
        let mut of_node = vec![[NONE; 3]; nx * ny];
        // Edges are numbered kind by kind, so that the numbers of a kind are consecutive.
        for kind in 0..3 {
            for j in 0..ny - 1 {
                for i in 0..nx - 1 {
                    let [a, b] = match kind {
                        0 => [at(i, j), at(i + 1, j)],
                        1 => [at(i, j), at(i, j + 1)],
                        // The diagonals of adjacent squares alternate, so that no direction is preferred.
                        _ if (i + j) % 2 == 0 => [at(i, j), at(i + 1, j + 1)],
                        _ => [at(i + 1, j), at(i, j + 1)],
                    };
                    if a == NONE || b == NONE {
                        continue;
                    }
                    let edge = edges.len() as u32;
                    of_node[j * nx + i][kind] = edge;
                    edges.push(Edge { ends: [a, b], diagonal: kind == 2 });
                    // A run ends where a node is missing, because the node numbers at both ends
                    // then no longer advance together.
                    match runs.last_mut() {
                        _ if kind == 2 => {}
                        Some(r) if r.ends[0] + r.n == a && r.ends[1] + r.n == b => r.n += 1,
                        _ => runs.push(EdgeStretch { edge, ends: [a, b], n: 1 }),
                    }
                }
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
                        triangles.push(Triangle { corners: c.map(|k| corners[k]), edges });
                    }
                }
            }
        }
        let coarser = OnceLock::new();
        Self { nodes, cell_mm, along, origin, nx, ny, index, edges, runs, triangles, coarser }
    }
}

/// A symmetric matrix over the nodes of a grid, with entries only for nodes that share an edge.
pub struct GridMatrix<'a> {
    mesh: &'a FieldMesh,
    /// Diagonal entries, one for each node.
    pub own: Vec<f64>,
    /// Off-diagonal entries, one for each edge; those of diagonal edges may be left out.
    pub beside: Vec<f64>,
}

/// The entries of the diagonal edges that meet at a node, four at most, in the order of the edges. Summed node by node, no
/// addition waits for that of the edge before.
struct DiagonalsOf {
    node: u32,
    n: usize,
    others: [u32; 4],
    beside: [f64; 4],
}

impl<'a> GridMatrix<'a> {
    /// The zero matrix, with entries for the sides of squares; with `diagonals`, also for diagonal edges.
    pub fn zero(mesh: &'a FieldMesh, diagonals: bool) -> Self {
        let n_edges = mesh.edges.iter().filter(|e| diagonals || !e.diagonal).count();
        Self { mesh, own: vec![0.0; mesh.nodes.len()], beside: vec![0.0; n_edges] }
    }

    /// Adds a spring along every side of a square; each spring pulls its two nodes to the same value.
    pub fn add_springs(&mut self, stiffness: f64) {
        for (edge, beside) in self.mesh.edges.iter().zip(&mut self.beside).filter(|e| !e.0.diagonal) {
            *beside -= stiffness;
            edge.ends.iter().for_each(|&k| self.own[k as usize] += stiffness);
        }
    }

    /// The entries of diagonal edges, node by node.
    fn diagonals(&self) -> Vec<DiagonalsOf> {
        let n_sides = self.mesh.runs().last().map_or(0, |run| run.edges.end);
        // Edges come in the order of the mesh, so each node's entries keep that order and sums their bits.
        let mut of_node = vec![NONE; self.own.len()];
        let mut out: Vec<DiagonalsOf> = Vec::new();
        for (edge, beside) in self.mesh.edges.iter().zip(&self.beside).skip(n_sides) {
            let [a, b] = edge.ends;
            for (node, other) in [(a, b), (b, a)] {
                let at = &mut of_node[node as usize];
                if *at == NONE {
                    *at = out.len() as u32;
                    out.push(DiagonalsOf { node, n: 0, others: [node; 4], beside: [0.0; 4] });
                }
                let of = &mut out[*at as usize];
                (of.others[of.n], of.beside[of.n]) = (other, *beside);
                of.n += 1;
            }
        }
        out
    }

    fn times(&self, diagonals: &[DiagonalsOf], x: &[f64], y: &mut [f64]) {
        y.iter_mut().zip(&self.own).zip(x).for_each(|((y, own), x)| *y = own * x);
        let mut add = |to: &Range<usize>, from: &Range<usize>, beside: &[f64]| {
            lanes::add_products_f64(&mut y[to.clone()], beside, &x[from.clone()]);
        };
        for run in self.mesh.runs() {
            let beside = &self.beside[run.edges];
            add(&run.from, &run.to, beside);
            add(&run.to, &run.from, beside);
        }
        for d in diagonals {
            let y = &mut y[d.node as usize];
            d.others.iter().zip(&d.beside).for_each(|(other, beside)| *y += beside * x[*other as usize]);
        }
    }

    /// Solves the system until the residual is at most `tolerance` times as long as the right side `rhs`, starting
    /// from `x`. The matrix has to be positive definite.
    pub fn solve(&self, mut x: Vec<f64>, rhs: &[f64], tolerance: f64, max_steps: usize) -> Vec<f64> {
        let settings = CgSettings::relative(rhs, tolerance, max_steps);
        let diagonals = self.diagonals();
        let times = |x: &[f64], y: &mut [f64]| self.times(&diagonals, x, y);
        conjugate_gradients(&times, rhs, &mut x, settings);
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_turns_with_its_region() {
        let l = Region::rectangle(DVec2::ZERO, DVec2::new(7.0, 5.0))
            .difference(&Region::rectangle(DVec2::new(3.0, 2.0), DVec2::new(8.0, 6.0)));
        let mesh = FieldMesh::over(&l, 0.7).expect("a mesh");
        for deg in [15.0, 37.0, 90.0, 200.0_f64] {
            let by = crate::math::direction(deg.to_radians());
            let turned = FieldMesh::along(&l.turned(by), 0.7, by).expect("a mesh");
            assert_eq!(
                (turned.nodes.len(), turned.edges.len()),
                (mesh.nodes.len(), mesh.edges.len()),
                "{deg}"
            );
            for p in [DVec2::new(0.3, 0.2), DVec2::new(6.1, 1.4), DVec2::new(2.9, 4.8), DVec2::new(-3.0, 9.0)]
            {
                let ((nodes, shares), (of_turned, their)) = (mesh.around(p), turned.around(rotated(p, by)));
                assert_eq!(nodes, of_turned, "{deg}");
                assert!(shares.iter().zip(their).all(|(a, b)| (a - b).abs() < 1e-9), "{deg}");
            }
        }
    }

    #[test]
    fn a_coarser_mesh_has_every_second_row_and_column() {
        let l = Region::rectangle(DVec2::ZERO, DVec2::new(7.0, 5.0))
            .difference(&Region::rectangle(DVec2::new(3.0, 2.0), DVec2::new(8.0, 6.0)));
        let by = crate::math::direction(0.6);
        let mesh = FieldMesh::along(&l.turned(by), 0.3, by).expect("a mesh");
        let Coarser { mesh: coarse, kept } = mesh.coarser().expect("one part, as the mesh");
        assert_eq!((coarse.cell_mm, coarse.nodes.len()), (0.6, kept.len()));
        assert!((mesh.nodes.len() / 5..mesh.nodes.len() / 3).contains(&kept.len()));
        assert!(kept.iter().zip(&coarse.nodes).all(|(&k, p)| mesh.nodes[k as usize] == *p));
        for edge in coarse.edges.iter().filter(|e| !e.diagonal) {
            let [a, b] = edge.ends.map(|k| coarse.nodes[k as usize]);
            assert!((a.distance(b) - 0.6).abs() < 1e-9);
        }
    }

    #[test]
    fn a_square_has_a_coarser_mesh_whatever_the_number_of_its_rows() {
        for k in 0..12 {
            let side_mm = 10.0 + 0.25 * f64::from(k);
            let square = Region::rectangle(DVec2::ZERO, DVec2::splat(side_mm));
            let mesh = FieldMesh::over(&square, 0.5).expect("a mesh");
            let Coarser { mesh: coarse, .. } = mesh.coarser().expect("one piece, as the mesh");
            let (n, sides) = (coarse.nodes.len().isqrt(), coarse.edges.iter().filter(|e| !e.diagonal));
            assert_eq!((n * n, sides.count()), (coarse.nodes.len(), 2 * n * (n - 1)), "{side_mm} mm");
        }
    }

    #[test]
    fn a_coarser_mesh_bridges_no_slit() {
        // One column of nodes is missing between both halves. Larger squares have it where its number is even.
        for (left_mm, has_coarser) in [(3.0, false), (4.0, true)] {
            let half = |from: f64, to: f64| Region::rectangle(DVec2::new(from, 0.0), DVec2::new(to, 10.0));
            let both = half(0.0, left_mm).union(&half(left_mm + 3.6, 12.0));
            let mesh = FieldMesh::over(&both, 1.0).expect("a mesh");
            assert_eq!(mesh.n_pieces(), 2);
            assert_eq!(mesh.coarser().is_some(), has_coarser, "{left_mm}");
        }
    }

    #[test]
    fn products_hold_every_entry_once_for_either_end_of_its_edge() {
        let l = Region::rectangle(DVec2::ZERO, DVec2::new(7.0, 5.0))
            .difference(&Region::rectangle(DVec2::new(3.0, 2.0), DVec2::new(8.0, 6.0)));
        let mesh = FieldMesh::over(&l, 0.7).expect("a mesh");
        let mut matrix = GridMatrix::zero(&mesh, true);
        matrix.own.iter_mut().enumerate().for_each(|(k, own)| *own = 1.0 + (k % 7) as f64);
        matrix.beside.iter_mut().enumerate().for_each(|(k, beside)| *beside = (k % 5) as f64 - 1.7);
        let x: Vec<f64> = (0..mesh.nodes.len()).map(|k| (k % 11) as f64 - 4.3).collect();
        let mut product = vec![0.0; x.len()];
        matrix.times(&matrix.diagonals(), &x, &mut product);
        let mut expect: Vec<f64> = matrix.own.iter().zip(&x).map(|(own, x)| own * x).collect();
        for (edge, beside) in mesh.edges.iter().zip(&matrix.beside) {
            let [a, b] = edge.ends.map(|k| k as usize);
            expect[a] += beside * x[b];
            expect[b] += beside * x[a];
        }
        let off = product.iter().zip(&expect).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{off}");
    }
}
