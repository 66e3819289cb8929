//! A multigrid preconditioner: it turns residual forces into an approximate displacement of the whole part.
//!
//! Levels for quadratic tetrahedra: the quadratic elements, the linear elements over the same corners, a
//! sequence of cubic grids that each double the width, and a dense Cholesky factor of the coarsest grid,
//! which has at most 250 nodes. Parts of equal boxes (`voxel`) use the same grids below a level of boxes of
//! twice the width. A middle node follows the linear field of an element; grids interpolate trilinearly.
//! Rigid motions and uniform strains therefore stay exact on every level. The matrix of a grid is the
//! Galerkin product, transfer transposed times finer matrix times transfer. Directions that supports
//! prescribe are projected out on the two finest levels.
//!
//! Where material that does not touch lies within the reach of one grid node, such as beads on both sides of a gap, that
//! node would tie it together. So it gets a copy for each group of finer nodes around it that are coupled with each other
//! there (`dick2011`), and moves each group by itself. Measured: to a residual of 1e-2 conjugate gradients take 26 iterations
//! instead of 83 on a bar of graded stripes of 105 000 nodes, 21 instead of 37 on one of 49 000, 13 instead of 20 on one of
//! sparse `triangles`, and at most one less on bars of `grid`. The first grid over tetrahedra has no copies.
//!
//! One application is a V-cycle. Each level is smoothed before and after its coarse correction by a Chebyshev
//! polynomial of the matrix scaled by its block diagonal (`adams2003`, recurrence of `saad2003`), 3 to 8
//! products with the matrix each time. Such a polynomial is symmetric and needs no order of the unknowns, so
//! the result is the same for any number of threads. The polynomial needs the largest eigenvalue: 15 steps of
//! power iteration estimate it, and a factor of 1.2 keeps the true one below. Levels that serve one solution
//! with few digits ([`Use::Once`]) take less work.
//!
//! Forces are in N, displacements in mm, vectors `n_nodes` of three numbers. Cost: linear in the nodes, for
//! making the levels and for a cycle. Memory: 76 bytes for each 3 x 3 block of a stored level, up to 125
//! blocks for a node of a grid, and 4.5 MB for the factor. Degenerate cases: a node without an element gets
//! no correction. Directions of the coarsest grid that have no stiffness are left out of the factor. A
//! supported direction of the finest level is never moved by a coarser one.

use grainpath_core::dense::{cholesky_in_place, cholesky_solve};
use grainpath_core::{DMat3, DVec3, IVec3};
use rayon::prelude::*;

use super::block_matrix::{Blocks, RowSums, add, assemble, dot};
use super::half_matrix::HalfMatrix;
use super::operator::CHUNK;
use super::system::System;
use crate::solid::model::constraints::Supports;
use crate::solid::model::error::SolidError;
use crate::solid::model::material_map::Model;
use crate::solid::model::tet_mesh::TetMesh;
use crate::solid::model::{quadratic_tet as element, tet_shape};

/// Smoothing of a level.
#[derive(Clone, Copy)]
pub(crate) struct Smoothing {
    /// Number of times that the matrix is applied.
    steps: usize,
    /// The polynomial damps the eigenvalues between the largest one and the largest one divided by this.
    band: f64,
}

const FINEST: Smoothing = Smoothing { steps: 3, band: 25.0 };
/// Smoothing of the finest level for one solution with few digits. Measured: before grid nodes had copies, on bars of sparse
/// `grid`, `triangles` and graded stripes (43 000 to 105 000 nodes) conjugate gradients take 12, 17, 36 and 91 iterations to a
/// residual of 1e-2 instead of 9, 14, 25 and 56, each with two products with the finest matrix instead of six; other bands
/// from 4 to 12 take as many.
const FINEST_ONCE: Smoothing = Smoothing { steps: 1, band: 8.0 };
/// For the linear elements. The first grid is as wide as the longest side, which is several times the
/// width of elements halved at thin walls. Twice the steps damp a band four times as wide just as well.
const LINEAR: Smoothing = Smoothing { steps: 8, band: 100.0 };
/// For grids, each twice as wide as the one before.
pub(crate) const GRID: Smoothing = Smoothing { steps: 4, band: 25.0 };
/// Largest number of nodes of the level that is factorized. Source: derived: 750 unknowns make a
/// factor of 4.5 MB and 70 million multiplications.
const DENSE_NODES: usize = 250;

/// How often the levels are used, which decides how much work goes into them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Use {
    /// For many solutions or many digits.
    Often,
    /// For one solution with few digits: fewer products with each matrix, and those of the grids in single precision.
    Once,
}

/// What [`Use`] decides.
struct Effort {
    finest: Smoothing,
    /// Steps of power iteration for the largest eigenvalue of each level.
    power_steps: usize,
}

impl Use {
    fn effort(self) -> Effort {
        match self {
            Self::Often => Effort { finest: FINEST, power_steps: 15 },
            // Measured: with five steps instead of 15 the bars of `FINEST_ONCE` take 12, 20, 35 and 90 iterations.
            Self::Once => Effort { finest: FINEST_ONCE, power_steps: 5 },
        }
    }
}

enum Matrix {
    /// The matrix of the finest level, which is passed with every call.
    Finest,
    Stored(Blocks),
    /// In single precision, for a preconditioner that is made for one solution with few digits.
    Rough(HalfMatrix),
}

impl Matrix {
    fn apply(&self, finest: &dyn System, x: &[DVec3], y: &mut [DVec3], scratch: &mut [DVec3]) {
        match self {
            Self::Finest => finest.rough_apply(x, y, scratch),
            Self::Stored(blocks) => blocks.apply(x, y),
            Self::Rough(half) => half.apply(x, y),
        }
    }
}

struct Level {
    matrix: Matrix,
    inverse_diagonal: Vec<DMat3>,
    top: f64,
    smoothing: Smoothing,
    /// Transfer from the next coarser level to this one.
    transfer: Transfer,
    x: Vec<DVec3>,
    r: Vec<DVec3>,
    d: Vec<DVec3>,
    t: Vec<DVec3>,
    scratch: Vec<DVec3>,
}

/// Weights of the coarse nodes at each fine node.
#[derive(Default)]
pub(crate) struct Transfer {
    pub(crate) start: Vec<u32>,
    pub(crate) coarse: Vec<u32>,
    pub(crate) weight: Vec<f64>,
    pub(crate) n_coarse: usize,
    /// Projections onto the free directions of supported fine nodes.
    pub(crate) held: Vec<(u32, DMat3)>,
    /// The same weights by coarse nodes.
    pub(crate) back: Transposed,
}

/// Weights of a transfer by coarse nodes. The fine nodes of each are in ascending order.
#[derive(Default)]
pub(crate) struct Transposed {
    start: Vec<u32>,
    fine: Vec<(u32, f64)>,
}

impl Transposed {
    fn of(transfer: &Transfer) -> Self {
        let mut start = vec![0u32; transfer.n_coarse + 1];
        for &c in &transfer.coarse {
            start[c as usize + 1] += 1;
        }
        for c in 0..transfer.n_coarse {
            start[c + 1] += start[c];
        }
        let mut next = start.clone();
        let mut fine = vec![(0u32, 0.0f64); transfer.coarse.len()];
        for i in 0..transfer.n_fine() {
            for (c, w) in transfer.row(i) {
                fine[next[c] as usize] = (i as u32, w);
                next[c] += 1;
            }
        }
        Self { start, fine }
    }

    fn row(&self, c: usize) -> &[(u32, f64)] {
        &self.fine[self.start[c] as usize..self.start[c + 1] as usize]
    }
}

impl Transfer {
    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[i] as usize..self.start[i + 1] as usize;
        self.coarse[range.clone()].iter().map(|&c| c as usize).zip(self.weight[range].iter().copied())
    }

    fn n_fine(&self) -> usize {
        self.start.len() - 1
    }

    /// Gives each coarse node a copy for each group of its fine nodes. `groups` holds, for each coarse node, the group of each
    /// of its fine nodes in ascending order, counted from 0; an empty list stands for one group. Returns, for each copy, the
    /// node that it is a copy of. `None` leaves all as it is: there is one group everywhere, or there would be more copies
    /// than half of the fine nodes, which would keep the levels from becoming smaller.
    pub(crate) fn split(&mut self, groups: &[Vec<u32>]) -> Option<Vec<u32>> {
        let mut node_of_copy = Vec::new();
        let mut first_copy = Vec::with_capacity(self.n_coarse);
        for (node, groups) in groups.iter().enumerate() {
            first_copy.push(node_of_copy.len() as u32);
            let n = groups.iter().max().map_or(1, |last| *last as usize + 1);
            node_of_copy.extend(std::iter::repeat_n(node as u32, n));
        }
        if node_of_copy.len() == self.n_coarse || node_of_copy.len() > self.n_fine() / 2 {
            return None;
        }
        let mut seen = vec![0usize; self.n_coarse];
        for coarse in &mut self.coarse {
            let node = *coarse as usize;
            *coarse = first_copy[node] + groups[node].get(seen[node]).copied().unwrap_or(0);
            seen[node] += 1;
        }
        self.n_coarse = node_of_copy.len();
        Some(node_of_copy)
    }

    /// [`Transfer::split`] where the fine matrix does not couple the fine nodes around a coarse one, and the weights by coarse
    /// nodes. `cells` are the places of the coarse nodes.
    pub(crate) fn split_uncoupled(&mut self, cells: &mut Vec<IVec3>, fine: &Blocks) {
        self.back = Transposed::of(self);
        let groups: Vec<Vec<u32>> =
            (0..self.n_coarse).into_par_iter().map(|c| coupled_groups(self.back.row(c), fine)).collect();
        if let Some(node_of_copy) = self.split(&groups) {
            *cells = node_of_copy.iter().map(|node| cells[*node as usize]).collect();
            self.back = Transposed::of(self);
        }
    }

    fn hold(&self, fine: &mut [DVec3]) {
        for (i, free) in &self.held {
            fine[*i as usize] = *free * fine[*i as usize];
        }
    }

    /// Adds a coarse correction to the fine level; `t` is scratch.
    fn prolong(&self, coarse: &[DVec3], fine: &mut [DVec3], t: &mut [DVec3]) {
        t.par_chunks_mut(CHUNK).enumerate().for_each(|(c, chunk)| {
            for (i, t) in (c * CHUNK..).zip(chunk) {
                *t = self.row(i).map(|(j, w)| coarse[j] * w).sum();
            }
        });
        self.hold(t);
        add(fine, 1.0, t);
    }

    /// The transposed transfer. `fine` serves as scratch and is overwritten.
    fn restrict(&self, fine: &mut [DVec3], coarse: &mut [DVec3]) {
        self.hold(fine);
        coarse.par_chunks_mut(CHUNK / 4).enumerate().for_each(|(c, chunk)| {
            for (j, coarse) in (c * CHUNK / 4..).zip(chunk) {
                *coarse =
                    self.back.row(j).iter().fold(DVec3::ZERO, |sum, (i, w)| sum + fine[*i as usize] * *w);
            }
        });
    }
}

/// The group of each of some fine nodes, counted from 0, where nodes belong together that the matrix couples by way of others
/// among them; an empty list if that is true of all.
fn coupled_groups(members: &[(u32, f64)], matrix: &Blocks) -> Vec<u32> {
    const NO_GROUP: u32 = u32::MAX;
    let mut group = vec![NO_GROUP; members.len()];
    let (mut n_groups, mut n_found) = (0, 0);
    // The node in the middle comes first: it is mostly coupled with all others.
    let middle = (0..members.len()).max_by(|a, b| members[*a].1.total_cmp(&members[*b].1).then(b.cmp(a)));
    let mut todo = Vec::new();
    for start in middle.into_iter().chain(0..members.len()) {
        if group[start] != NO_GROUP {
            continue;
        }
        group[start] = n_groups;
        n_found += 1;
        todo.push(start);
        while let Some(member) = todo.pop() {
            for (other, _) in matrix.row(members[member].0 as usize) {
                let other = members.binary_search_by_key(&(other as u32), |(fine, _)| *fine);
                if let Some(other) = other.ok().filter(|other| group[*other] == NO_GROUP) {
                    group[other] = n_groups;
                    n_found += 1;
                    todo.push(other);
                }
            }
            if n_found == members.len() {
                todo.clear();
            }
        }
        n_groups += 1;
    }
    if n_groups > 1 { group } else { Vec::new() }
}

/// The levels, finest first, and the factor of the coarsest one.
pub(crate) struct Multigrid {
    levels: Vec<Level>,
    dense: CoarsestFactor,
    dense_x: Vec<f64>,
}

impl Multigrid {
    /// Makes the levels for quadratic tetrahedra.
    pub(crate) fn new(
        model: &Model<'_>,
        supports: &Supports,
        operator: &dyn System,
    ) -> Result<Self, SolidError> {
        let laws = model.laws()?;
        let mesh = model.mesh;
        // The corners alone, numbered in the order of all nodes.
        let mut id = vec![u32::MAX; mesh.nodes.len()];
        for t in &mesh.tets {
            t[..4].iter().for_each(|&v| id[v as usize] = 0);
        }
        let corners: Vec<u32> = (0..id.len() as u32).filter(|&v| id[v as usize] == 0).collect();
        for (i, &v) in (0u32..).zip(&corners) {
            id[v as usize] = i;
        }
        let tets: Vec<[u32; 4]> =
            mesh.tets.iter().map(|t| std::array::from_fn(|i| id[t[i] as usize])).collect();
        let first = from_linear(mesh, &id, corners.len(), supports);
        let free = |i: usize| supports.free(corners[i] as usize);
        let matrix = assemble(corners.len(), &tets, |t| {
            let products = element::linear_gradient_products(&mesh.corners(t));
            let mut k = element::stiffness(&products, &laws[model.material(t)]);
            // Supports are projected out here as on the finest level, so that no correction from a
            // coarser level moves a supported direction.
            for a in 0..4 {
                for b in 0..=a {
                    if let Some(p) = free(tets[t][a] as usize) {
                        k[a][b] = *p * k[a][b];
                    }
                    if let Some(p) = free(tets[t][b] as usize) {
                        k[a][b] *= *p;
                    }
                }
            }
            k
        });
        let places: Vec<DVec3> = corners.iter().map(|&v| mesh.nodes[v as usize]).collect();
        let longest = tets.par_iter().map(|t| {
            let x = t.map(|i| places[i as usize]);
            tet_shape::EDGES.iter().map(|&(i, j)| x[i].distance(x[j])).fold(0.0, f64::max)
        });
        let longest = longest.reduce(|| 0.0, f64::max);
        let volume: f64 = (0..tets.len()).map(|t| tet_shape::volume(&mesh.corners(t))).sum();
        // A cell of a body-centred lattice of width a holds two corners; the grid is twice as wide
        // as such a cell.
        let width = longest.max(2.0 * (2.0 * volume / places.len() as f64).cbrt());
        let held: Vec<(u32, DMat3)> =
            (0..corners.len()).filter_map(|i| free(i).map(|p| (i as u32, *p))).collect();
        let grid = CoarseGrid { origin: places[0] - 0.37 * width, width };
        // A node of the first grid has many corners around it, which few gaps part: no groups are looked for.
        let (mut transfer, cells) = grid.over(&places, held);
        transfer.back = Transposed::of(&transfer);
        Ok(Self::below(operator, first, (matrix, LINEAR), (transfer, cells), Use::Often))
    }

    /// Makes the levels from the finest level, the transfer to it, the matrix of the next level with
    /// its smoothing, and the grid of the level after that, whose weights are there by coarse nodes too.
    pub(crate) fn below(
        finest: &dyn System,
        mut first: Transfer,
        (mut matrix, mut smoothing): (Blocks, Smoothing),
        (mut transfer, mut cells): (Transfer, Vec<IVec3>),
        usage: Use,
    ) -> Self {
        let effort = usage.effort();
        first.back = Transposed::of(&first);
        let diagonal = finest.inverse_diagonal();
        let mut levels =
            vec![Level::new(finest, Matrix::Finest, diagonal, first, effort.finest, effort.power_steps)];
        while levels.len() < 2 || matrix.n() > DENSE_NODES {
            let coarse = galerkin(&matrix, &transfer, &cells);
            let diagonal = matrix.inverse_diagonal();
            let half = if usage == Use::Once { HalfMatrix::new(&matrix) } else { None };
            let stored = half.map_or(Matrix::Stored(matrix), Matrix::Rough);
            levels.push(Level::new(finest, stored, diagonal, transfer, smoothing, effort.power_steps));
            (matrix, smoothing) = (coarse, GRID);
            let places: Vec<DVec3> = cells.iter().map(|c| c.as_dvec3()).collect();
            // The origin of each coarser grid is that of the finer one, so that every second node
            // coincides.
            (transfer, cells) = CoarseGrid { origin: DVec3::ZERO, width: 2.0 }.over(&places, Vec::new());
            transfer.split_uncoupled(&mut cells, &matrix);
        }
        let dense = CoarsestFactor::new(&matrix);
        let dense_x = vec![0.0; 3 * matrix.n()];
        Self { levels, dense, dense_x }
    }

    /// Bytes of all levels.
    pub(crate) fn bytes(&self) -> usize {
        let stored = |l: &Level| match &l.matrix {
            Matrix::Stored(b) => b.bytes(),
            Matrix::Rough(half) => half.bytes(),
            Matrix::Finest => 0,
        };
        let level = |l: &Level| stored(l) + l.x.len() * (4 * 24 + 72 + (12 + 16) * 4);
        self.levels.iter().map(level).sum::<usize>() + self.dense.factor.len() * 8
    }

    /// Nodes of each level.
    pub(crate) fn sizes(&self) -> Vec<usize> {
        let mut sizes: Vec<usize> = self.levels.iter().map(|l| l.x.len()).collect();
        sizes.push(self.dense.n / 3);
        sizes
    }

    /// An approximate solution `z` for the residual forces `r`: one V-cycle.
    pub(crate) fn apply(&mut self, finest: &dyn System, r: &[DVec3], z: &mut [DVec3]) {
        self.levels[0].r.copy_from_slice(r);
        self.cycle(finest, 0);
        z.copy_from_slice(&self.levels[0].x);
    }

    fn cycle(&mut self, finest: &dyn System, at: usize) {
        let (upper, below) = self.levels.split_at_mut(at + 1);
        let level = &mut upper[at];
        level.smooth_first(finest);
        // The residual goes to the scratch vector, because the right-hand side is needed again
        // after the coarse correction.
        level.matrix.apply(finest, &level.x, &mut level.t, &mut level.scratch);
        for_each(&mut level.t, &level.r, |t, r| *t = *r - *t);
        if let Some(next) = below.first_mut() {
            level.transfer.restrict(&mut level.t, &mut next.r);
            // A supported corner must not follow free middle nodes beside it.
            next.transfer.hold(&mut next.r);
            self.cycle(finest, at + 1);
            let (upper, below) = self.levels.split_at_mut(at + 1);
            let level = &mut upper[at];
            level.transfer.prolong(&below[0].x, &mut level.x, &mut level.t);
        } else {
            let mut coarse = vec![DVec3::ZERO; self.dense.n / 3];
            level.transfer.restrict(&mut level.t, &mut coarse);
            for (x, c) in self.dense_x.chunks_exact_mut(3).zip(&coarse) {
                x.copy_from_slice(&c.to_array());
            }
            self.dense.solve(&mut self.dense_x);
            for (c, x) in coarse.iter_mut().zip(self.dense_x.chunks_exact(3)) {
                *c = DVec3::new(x[0], x[1], x[2]);
            }
            level.transfer.prolong(&coarse, &mut level.x, &mut level.t);
        }
        self.levels[at].smooth(finest);
    }
}

fn for_each(a: &mut [DVec3], b: &[DVec3], f: impl Fn(&mut DVec3, &DVec3) + Sync) {
    a.par_chunks_mut(CHUNK).zip(b.par_chunks(CHUNK)).for_each(|(a, b)| {
        a.iter_mut().zip(b).for_each(|(a, b)| f(a, b));
    });
}

impl Level {
    fn new(
        finest: &dyn System,
        matrix: Matrix,
        inverse_diagonal: Vec<DMat3>,
        transfer: Transfer,
        smoothing: Smoothing,
        power_steps: usize,
    ) -> Self {
        let n = inverse_diagonal.len();
        let zero = || vec![DVec3::ZERO; n];
        let scratch = match &matrix {
            Matrix::Finest => finest.scratch(),
            Matrix::Stored(_) | Matrix::Rough(_) => Vec::new(),
        };
        let (x, r, d, t) = (zero(), zero(), zero(), zero());
        let mut level = Self { matrix, inverse_diagonal, top: 1.0, smoothing, transfer, x, r, d, t, scratch };
        // Power iteration approaches the largest eigenvalue from below. The factor 1.2 keeps the
        // true one within the range of the polynomial.
        level.top = 1.2 * level.largest_eigenvalue(finest, power_steps);
        level
    }

    /// Largest eigenvalue of the scaled matrix, by power iteration.
    fn largest_eigenvalue(&mut self, finest: &dyn System, steps: usize) -> f64 {
        let n = self.x.len();
        // A pseudorandom start contains all eigenvectors; the fixed seed makes it the same
        // everywhere.
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut next = || {
            // Linear congruential generator with the multiplier and increment of Knuth's MMIX.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
        };
        let mut x: Vec<DVec3> = (0..n).map(|_| DVec3::new(next(), next(), next())).collect();
        let mut found = 1.0;
        for _ in 0..steps {
            let size = dot(&x, &x).sqrt();
            x.par_chunks_mut(CHUNK).for_each(|x| x.iter_mut().for_each(|v| *v /= size));
            self.matrix.apply(finest, &x, &mut self.t, &mut self.scratch);
            scaled_into(&mut x, &self.t, &self.inverse_diagonal);
            found = dot(&x, &x).sqrt();
        }
        found
    }

    fn smooth_first(&mut self, finest: &dyn System) {
        self.x.fill(DVec3::ZERO);
        self.t.copy_from_slice(&self.r);
        self.chebyshev(finest);
    }

    fn smooth(&mut self, finest: &dyn System) {
        self.matrix.apply(finest, &self.x, &mut self.t, &mut self.scratch);
        for_each(&mut self.t, &self.r, |t, r| *t = *r - *t);
        self.chebyshev(finest);
    }

    /// Chebyshev iteration from `x`, whose residual is in `t`.
    fn chebyshev(&mut self, finest: &dyn System) {
        // The recurrence of `saad2003`, algorithm 12.1, for eigenvalues between `low` and `high`.
        let (high, low) = (self.top, self.top / self.smoothing.band);
        let (middle, half) = (0.5 * (high + low), 0.5 * (high - low));
        let sigma = middle / half;
        let mut rho = 1.0 / sigma;
        scaled(&mut self.d, &self.t, &self.inverse_diagonal, 0.0, 1.0 / middle);
        for step in 0..self.smoothing.steps {
            add(&mut self.x, 1.0, &self.d);
            // The residual is not needed after the last step; leaving it out saves one product with the matrix.
            if step + 1 == self.smoothing.steps {
                break;
            }
            self.matrix.apply(finest, &self.x, &mut self.t, &mut self.scratch);
            for_each(&mut self.t, &self.r, |t, r| *t = *r - *t);
            let next = 1.0 / (2.0 * sigma - rho);
            scaled(&mut self.d, &self.t, &self.inverse_diagonal, next * rho, 2.0 * next / half);
            rho = next;
        }
    }
}

/// `x = D^-1 r`.
fn scaled_into(x: &mut [DVec3], r: &[DVec3], inverse: &[DMat3]) {
    let chunks = x.par_chunks_mut(CHUNK).zip(r.par_chunks(CHUNK)).zip(inverse.par_chunks(CHUNK));
    chunks.for_each(|((x, r), inverse)| {
        x.iter_mut().zip(r).zip(inverse).for_each(|((x, r), m)| *x = *m * *r);
    });
}

/// `d = keep * d + take * D^-1 r`.
fn scaled(d: &mut [DVec3], r: &[DVec3], inverse: &[DMat3], keep: f64, take: f64) {
    let chunks = d.par_chunks_mut(CHUNK).zip(r.par_chunks(CHUNK)).zip(inverse.par_chunks(CHUNK));
    chunks.for_each(|((d, r), inverse)| {
        for ((d, r), m) in d.iter_mut().zip(r).zip(inverse) {
            *d = *d * keep + *m * *r * take;
        }
    });
}

/// Transfer from the corners to all nodes. Corners keep their value; a middle node gets the linear
/// field of an element at its position. On a straight side that is the mean of both ends. On a
/// curved side the mean would not reproduce rigid rotations.
fn from_linear(mesh: &TetMesh, id: &[u32], n_coarse: usize, supports: &Supports) -> Transfer {
    let n = mesh.nodes.len();
    let mut tet_of = vec![u32::MAX; n];
    for (t, tet) in (0u32..).zip(&mesh.tets) {
        tet[4..].iter().for_each(|&m| tet_of[m as usize] = t);
    }
    let mut transfer = Transfer { start: vec![0], n_coarse, ..Transfer::default() };
    for i in 0..n {
        if id[i] != u32::MAX {
            transfer.coarse.push(id[i]);
            transfer.weight.push(1.0);
        } else if tet_of[i] != u32::MAX {
            let tet = &mesh.tets[tet_of[i] as usize];
            let x = mesh.corners(tet_of[i] as usize);
            // Barycentric coordinates of the node in the straight tetrahedron over its corners.
            let turn = DMat3::from_cols(x[1] - x[0], x[2] - x[0], x[3] - x[0]).inverse();
            let l = turn * (mesh.nodes[i] - x[0]);
            let weights = [1.0 - l.x - l.y - l.z, l.x, l.y, l.z];
            for (&v, w) in tet.iter().zip(weights).filter(|(_, w)| w.abs() > 1e-9) {
                transfer.coarse.push(id[v as usize]);
                transfer.weight.push(w);
            }
        }
        // A node without an element gets an empty row, so its correction is zero.
        transfer.start.push(transfer.coarse.len() as u32);
    }
    transfer.held = (0..n).filter_map(|i| supports.free(i).map(|p| (i as u32, *p))).collect();
    transfer
}

pub(crate) struct CoarseGrid {
    pub(crate) origin: DVec3,
    pub(crate) width: f64,
}

impl CoarseGrid {
    /// Trilinear weights of the grid's nodes at some places, and the grid nodes in use.
    pub(crate) fn over(&self, places: &[DVec3], held: Vec<(u32, DMat3)>) -> (Transfer, Vec<IVec3>) {
        let weights = |&p: &DVec3| {
            let q = (p - self.origin) / self.width;
            let cell = q.floor();
            let (part, cell) = (q - cell, cell.as_ivec3());
            (0..8i32).filter_map(move |i| {
                let bits = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
                let side = |axis: usize| if bits[axis] == 1 { part[axis] } else { 1.0 - part[axis] };
                // Grid nodes of weight zero would only enlarge the coarse matrix.
                let w = side(0) * side(1) * side(2);
                (w > 1e-10).then_some((cell + bits, w))
            })
        };
        let key = |c: IVec3| (c.z, c.y, c.x);
        let mut used: Vec<(i32, i32, i32)> =
            places.par_iter().flat_map_iter(|p| weights(p).map(|(c, _)| key(c))).collect();
        used.par_sort_unstable();
        used.dedup();
        let row = |p: &DVec3| {
            weights(p).map(|(cell, w)| (used.binary_search(&key(cell)).expect("listed above") as u32, w))
        };
        let rows: Vec<u32> = places.par_iter().map(|p| weights(p).count() as u32).collect();
        let (coarse, weight) = places.par_iter().flat_map_iter(row).unzip();
        let mut transfer = Transfer { start: vec![0], coarse, weight, held, ..Transfer::default() };
        transfer.n_coarse = used.len();
        for n in rows {
            transfer.start.push(transfer.start[transfer.start.len() - 1] + n);
        }
        (transfer, used.into_iter().map(|(z, y, x)| IVec3::new(x, y, z)).collect())
    }
}

/// Greatest distance between coupled nodes of a grid along each axis: no side is longer than the
/// grid is wide.
const REACH: i32 = 2;
/// Number of nodes to which a node can be coupled, itself included. Source: derived: (2 x 2 + 1)^3.
const STENCIL: usize = 125;

/// The product of transposed transfer, matrix and transfer.
fn galerkin(fine: &Blocks, transfer: &Transfer, cells: &[IVec3]) -> Blocks {
    let row = |c: usize| {
        // Coupled nodes are at most two steps apart, so a full cube of slots replaces a search.
        let mut sums = RowSums::<STENCIL>::new();
        for &(i, wi) in transfer.back.row(c) {
            for (j, a) in fine.row(i as usize) {
                let a = *a * wi;
                for (d, wj) in transfer.row(j) {
                    let step = cells[d] - cells[c] + REACH;
                    sums.add(((step.z * 5 + step.y) * 5 + step.x) as usize, d as u32, a * wj);
                }
            }
        }
        sums.into_row()
    };
    Blocks::from_rows((0..transfer.n_coarse).into_par_iter().map(row).collect())
}

/// Cholesky factor of the coarsest matrix. Some directions have no stiffness: those of nodes whose weights depend on
/// other nodes, and of nodes whose finer nodes are all supported. They are left out, as [`cholesky_in_place`] does with
/// dependent unknowns.
struct CoarsestFactor {
    n: usize,
    /// Lower triangle by rows.
    factor: Vec<f64>,
}

impl CoarsestFactor {
    fn new(matrix: &Blocks) -> Self {
        let n = 3 * matrix.n();
        let mut a = vec![0.0; n * n];
        for i in 0..matrix.n() {
            for (j, block) in matrix.row(i) {
                for r in 0..3 {
                    for c in 0..3 {
                        a[(3 * i + r) * n + 3 * j + c] = block.col(c)[r];
                    }
                }
            }
        }
        cholesky_in_place(&mut a, n);
        Self { n, factor: a }
    }

    fn solve(&self, x: &mut [f64]) {
        cholesky_solve(&self.factor, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::TetMesh;

    #[test]
    fn a_cube_of_linear_shape_converges_in_a_few_steps() {
        let n = 8u32;
        let id = |x: u32, y: u32, z: u32| (z * (n + 1) + y) * (n + 1) + x;
        let mut vertices = Vec::new();
        let mut tets = Vec::new();
        for z in 0..=n {
            for y in 0..=n {
                for x in 0..=n {
                    vertices.push(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
                    if x < n && y < n && z < n {
                        for p in [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]] {
                            let v = |b: u32| id(x + (b & 1), y + (b >> 1 & 1), z + (b >> 2));
                            tets.push([v(0), v(p[0]), v(p[1]), v(7)]);
                        }
                    }
                }
            }
        }
        let mesh = TetMesh::straight(&vertices, &tets);
        let mut d = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                d[i][j] = match (i < 3 && j < 3, i == j) {
                    (true, same) => 1.2 + if same { 1.6 } else { 0.0 },
                    (false, same) => {
                        if same {
                            0.8
                        } else {
                            0.0
                        }
                    }
                };
            }
        }
        let model = Model::uniform(&mesh, d);
        let mut supports = Supports::new(mesh.nodes.len());
        for i in 0..mesh.nodes.len() as u32 {
            if mesh.nodes[i as usize].x == 0.0 {
                supports.fix(&mesh, i).expect("new");
            }
        }
        let mut r = vec![DVec3::ZERO; mesh.nodes.len()];
        for (i, p) in mesh.nodes.iter().enumerate() {
            if p.x == 8.0 {
                r[i] = DVec3::new(0.1, 0.0, 1.0);
            }
        }
        let (supports, model) = (&supports, &model);
        let (solutions, info) =
            crate::solid::solve(model, supports, &[r], &Default::default()).expect("held");
        assert!(
            solutions[0].iterations < 40 && solutions[0].residual < 1e-8,
            "{:?}",
            solutions[0].iterations
        );
        assert_eq!(info.levels, [4913, 729, 125]);
    }
}
