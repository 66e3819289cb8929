//! Elasticity on a grid of equal box-shaped cells. It serves parts that are too large or too intricate for
//! tetrahedra, and parts whose cells change stiffness from one solution to the next, as in a strength test.
//!
//! Method: elements of eight nodes with three incompatible modes (`wilson1973`), so that a wall one cell
//! thick bends without locking. They are applied without being stored: a node between eight equal cells has
//! the same 27 blocks as every other such node of its material. Conjugate gradients solve for the
//! displacements; the preconditioner is the multigrid of the tetrahedra over grids whose cells double in
//! width. It uses the matrix in single precision where memory allows. After a change of cells only the nodes
//! around it are corrected first (`easing`), and the whole part is solved again where that is not enough. The
//! preconditioner is kept through such changes. It is made again when a solution takes more than ten
//! iterations above twice the usual number. A part that is solved once, to a few digits, has a cheaper
//! preconditioner and conjugate gradients in single precision ([`VoxelSystem::solve_once`]).
//!
//! Lengths are in mm, forces in N, stresses in MPa. Cells are numbered with x fastest, `n[0] * n[1] * n[2]`
//! of them, each with a stiffness from the palette and a factor on it. Cost: linear in the nodes in use.
//! Memory: 860 bytes a node in use, about 1750 with the matrix in single precision, and 10 bytes a cell of
//! the grid, refused above the limit before it is allocated.
//!
//! Limits: slanted surfaces are stair-stepped. Void cells stay void, and the factor of a changed cell stays
//! above a millionth, so that every node keeps some stiffness. Supports outside the material are left out. A
//! grid without solid cells, a bad stiffness, and a piece that can move freely are errors; pieces are
//! connected over faces of cells.

use grainpath_core::{DMat3, DVec3, IVec3};
use rayon::prelude::*;

use super::model::constraints::Supports;
use super::model::error::SolidError;
use super::model::memory::fitting_edge_mm;
use super::model::quadratic_tet::{self as element, Law};
use super::solver::block_matrix::{Blocks, RowSums, dot};
use super::solver::easing::{self, RoughPart, Rows};
use super::solver::half_matrix::{self, AFTER, SUM_BYTES, Slab};
use super::solver::multigrid::{CoarseGrid, GRID, Multigrid, Transfer, Use};
use super::solver::operator::inverse;
use super::solver::solution::{Solution, SolveSettings};
use super::solver::solve::{Solved, iterate};
use super::solver::system::System;
use crate::material::Stiffness;
use crate::sparse::BYTES_PER_MIB;

/// Material index of a void cell.
pub const VOID: u16 = u16::MAX;
const NONE: u32 = u32::MAX;
/// Nodes for each task. Source: chosen; it changes speed alone, never the result.
const CHUNK: usize = 1024;

/// A part made of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelPart {
    /// Cells along x, y and z.
    pub n: [usize; 3],
    /// Lowest corner of the grid, mm.
    pub origin: DVec3,
    /// Edges of a cell, mm.
    pub cell_mm: DVec3,
    /// Stiffnesses in part coordinates, with any anisotropy.
    pub palette: Vec<Stiffness>,
    /// Index into the palette for each cell, x fastest, or [`VOID`].
    pub material: Vec<u16>,
    /// Factor on the stiffness for each cell, 0 to 1; a cell at 0 is void.
    pub scale: Vec<f32>,
}

/// A part prepared for any number of solutions.
pub struct VoxelSystem {
    cells: VoxelCells,
    multigrid: Multigrid,
    /// Number of iterations that the first solution with the current preconditioner took.
    usual: Option<usize>,
    stale: bool,
    prepared: usize,
    /// The last solution.
    last: Option<Last>,
    /// Nodes around cells that have changed since the last solution.
    changed: Vec<u32>,
}

struct Last {
    load: Vec<DVec3>,
    displacement: Vec<DVec3>,
    /// Residual forces; zero along supports.
    residual: Vec<DVec3>,
    /// Size of the load with which the residual is compared, including the forces of prescribed
    /// displacements.
    load_size: f64,
}

/// How much work a solution took that started from the one before.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Iterations over the whole part; 0 where correcting the nodes around the changes was enough.
    pub iterations: usize,
    /// Cells around nodes that moved; `None` for all cells.
    pub cells: Option<Vec<usize>>,
}

/// After a change, nodes within this many cells of it are corrected first, but no more than about the share
/// `NEAR` of all nodes. With that share, thirty steps take as long as one iteration over the whole part.
const REACH: usize = 20;
const NEAR: f64 = 0.08;
/// Largest number of steps of a correction.
const MOST_EASING: usize = 60;
/// A correction ends when the residual of the corrected nodes is this share of the goal; the rest
/// is left for the nodes on their rim.
const EASED: f64 = 0.25;

struct VoxelCells {
    part: VoxelPart,
    supports: Supports,
    /// Element matrices of the palette: `[corner][corner]` blocks.
    elements: Vec<[[DMat3; 8]; 8]>,
    /// Coupling of a node to its 27 neighbours if it lies between eight equal cells.
    stencils: Vec<[DMat3; 27]>,
    /// Number of each grid point among the nodes in use; `NONE` for the others.
    node_of: Vec<u32>,
    /// Grid points of the nodes.
    nodes: Vec<IVec3>,
    /// The 27 nodes around each node, x fastest. Where a neighbour is missing, the node itself stands in its place.
    around: Vec<[u32; 27]>,
    /// Material and scale of the eight cells around each node, where all eight are alike.
    uniform: Vec<(u16, f32)>,
    /// The upper half of the matrix in single precision; empty where memory does not suffice.
    rough: Vec<half_matrix::Row>,
    /// The parts of that matrix which threads take.
    slabs: Vec<Slab>,
}

/// A node's place among the 27 around it. Source: derived.
const MIDDLE: usize = 13;
/// Bytes a row of the matrix. Source: derived.
const ROW_BYTES: usize = size_of::<half_matrix::Row>();
/// Bytes a node, with and without the matrix in single precision. The matrix takes its rows, and the sums of its
/// forces. A correction takes rows of its own, with the numbers of their neighbours, for the nodes it moves.
/// Measured: the strength test of a bracket with 459 000 nodes holds 1.1 GiB, and 1.3 GiB with whole rows. The weights of the
/// first grid by its own nodes take 50 bytes more; derived: a node has weight at 27 / 8 nodes of the grid in the mean, of 16
/// bytes each.
const NODE_BYTES: [usize; 2] =
    [860 + ROW_BYTES + SUM_BYTES + (2.0 * NEAR * (ROW_BYTES + 4 * AFTER) as f64) as usize, 860];

fn corner(c: usize) -> IVec3 {
    IVec3::new((c & 1) as i32, (c >> 1 & 1) as i32, (c >> 2) as i32)
}

impl VoxelPart {
    fn size(&self) -> IVec3 {
        IVec3::new(self.n[0] as i32, self.n[1] as i32, self.n[2] as i32)
    }

    /// Position of a cell in the grid.
    fn at(&self, cell: usize) -> IVec3 {
        let [nx, ny, _] = self.n;
        IVec3::new((cell % nx) as i32, (cell / nx % ny) as i32, (cell / nx / ny) as i32)
    }

    fn cell(&self, c: IVec3) -> Option<usize> {
        let inside = c.cmpge(IVec3::ZERO).all() && c.cmplt(self.size()).all();
        inside.then(|| (c.z as usize * self.n[1] + c.y as usize) * self.n[0] + c.x as usize)
    }

    /// Material and scale of a cell, if it has stiffness.
    fn solid(&self, c: IVec3) -> Option<(u16, f32)> {
        let i = self.cell(c)?;
        (self.material[i] != VOID && self.scale[i] > 0.0).then(|| (self.material[i], self.scale[i]))
    }

    fn point_index(&self, p: IVec3) -> usize {
        (p.z as usize * (self.n[1] + 1) + p.y as usize) * (self.n[0] + 1) + p.x as usize
    }
}

impl VoxelSystem {
    /// Prepares a part. `hold` lists grid points (`0..=n` along each axis), each with a direction
    /// and a displacement, mm.
    ///
    /// # Errors
    /// No solid cell, a bad palette, a contradiction, a piece that is not held, or more memory than
    /// allowed.
    pub fn new(
        part: VoxelPart,
        hold: &[([usize; 3], DVec3, f64)],
        settings: &SolveSettings,
    ) -> Result<Self, SolidError> {
        Self::prepared_for(Use::Often, part, hold, settings)
    }

    /// [`VoxelSystem::new`] for [`VoxelSystem::solve_once`]: preparation and solution take less time and give fewer digits.
    ///
    /// # Errors
    /// As [`VoxelSystem::new`].
    pub fn for_one_solution(
        part: VoxelPart,
        hold: &[([usize; 3], DVec3, f64)],
        settings: &SolveSettings,
    ) -> Result<Self, SolidError> {
        Self::prepared_for(Use::Once, part, hold, settings)
    }

    fn prepared_for(
        usage: Use,
        part: VoxelPart,
        hold: &[([usize; 3], DVec3, f64)],
        settings: &SolveSettings,
    ) -> Result<Self, SolidError> {
        let cells = VoxelCells::new(part, hold, settings)?;
        let multigrid = cells.multigrid(usage);
        Ok(Self { cells, multigrid, usual: None, stale: false, prepared: 1, last: None, changed: Vec::new() })
    }

    /// Number of times that the preconditioner was made.
    pub fn prepared(&self) -> usize {
        self.prepared
    }

    /// Adds a stiffness to the palette, so that cells can change to it.
    ///
    /// # Errors
    /// The stiffness is not that of a material, or the palette is full.
    pub fn add(&mut self, stiffness: &Stiffness) -> Result<u16, SolidError> {
        let material = self.cells.elements.len();
        if material >= usize::from(VOID) {
            return Err(SolidError::Material { material });
        }
        let law = Law::new(stiffness).ok_or(SolidError::Material { material })?;
        let element = element_matrix(&law, self.cells.part.cell_mm);
        self.cells.stencils.push(stencil(&element));
        self.cells.elements.push(element);
        self.cells.part.palette.push(*stiffness);
        Ok(material as u16)
    }

    /// Number of nodes in use.
    pub fn n_nodes(&self) -> usize {
        self.cells.nodes.len()
    }

    /// The node at a grid point; `None` where no solid cell touches it.
    pub fn node(&self, point: [usize; 3]) -> Option<usize> {
        let inside = (0..3).all(|a| point[a] <= self.cells.part.n[a]);
        let p = IVec3::new(point[0] as i32, point[1] as i32, point[2] as i32);
        let node = inside.then(|| self.cells.node_of[self.cells.part.point_index(p)])?;
        (node != NONE).then_some(node as usize)
    }

    /// Places of the nodes, mm.
    pub fn places(&self) -> Vec<DVec3> {
        self.cells.nodes.iter().map(|&p| self.cells.place(p)).collect()
    }

    /// Gives cells other materials and scales: (cell, material, scale). Void cells stay void. A
    /// scale is kept above a millionth, so that every node keeps some stiffness.
    pub fn change(&mut self, changes: &[(usize, u16, f32)]) {
        let mut around = Vec::new();
        for &(cell, material, scale) in changes {
            let old = (self.cells.part.material[cell], self.cells.part.scale[cell]);
            // Nodes were numbered when the part was prepared, so a void cell cannot gain stiffness.
            if old.0 == VOID || old.1 <= 0.0 || usize::from(material) >= self.cells.elements.len() {
                continue;
            }
            self.cells.part.material[cell] = material;
            self.cells.part.scale[cell] = scale.max(1e-6);
            around.extend(self.cells.nodes_of(cell));
        }
        around.sort_unstable();
        around.dedup();
        self.cells.update(&around);
        self.stale |= !changes.is_empty();
        self.changed.extend(around);
    }

    /// Solves for forces on the nodes, N. The preconditioner is made anew when cells have changed
    /// and convergence has become slow.
    ///
    /// # Errors
    /// No convergence, or a load that is not finite.
    pub fn solve(&mut self, load: &[DVec3], settings: &SolveSettings) -> Result<Solution, SolidError> {
        self.last = None;
        self.iterated(load, None, settings)
    }

    /// Solves for forces on the nodes, N, with a matrix in single precision where memory allows it. The residual of the
    /// whole matrix then tells whether that was enough; if it is more than twice the tolerance, the solution goes on with
    /// the whole matrix.
    ///
    /// # Errors
    /// No convergence, or a load that is not finite.
    pub fn solve_once(&mut self, load: &[DVec3], settings: &SolveSettings) -> Result<Solution, SolidError> {
        self.last = None;
        let cells = &self.cells;
        let Solved { mut solution, load_size, .. } =
            iterate(&RoughCells(cells), &mut self.multigrid, load, None, settings)?;
        let mut residual = vec![DVec3::ZERO; load.len()];
        cells.forces(&solution.displacement, &mut residual, &mut []);
        residual.iter_mut().zip(load).for_each(|(r, f)| *r = *f - *r);
        cells.supports.project(&mut residual);
        let size = dot(&residual, &residual).sqrt();
        // Comparing this way round sends a size that is not a number on to the other matrix, which refuses it.
        if size <= 2.0 * settings.tolerance * load_size {
            solution.residual = if load_size > 0.0 { size / load_size } else { 0.0 };
            let displacement = solution.displacement.clone();
            self.last = Some(Last { load: load.to_vec(), displacement, residual, load_size });
            return Ok(solution);
        }
        let from = Some((std::mem::take(&mut solution.displacement), residual));
        let more = self.iterated(load, from, settings)?;
        Ok(Solution { iterations: solution.iterations + more.iterations, ..more })
    }

    /// Updates the last solution after cells have changed: first at the nodes around them with all
    /// others fixed, then, if the residual is still too large, at all nodes. The residual falls to
    /// `gain` times its value after the change, or to the tolerance times the load if that is less.
    ///
    /// # Errors
    /// No convergence, or a load that is not finite.
    pub fn follow(
        &mut self,
        load: &[DVec3],
        gain: f64,
        settings: &SolveSettings,
    ) -> Result<Followed, SolidError> {
        // The last solution can be updated for the same load only; any other load is solved from zero.
        let Some(mut last) = self.last.take().filter(|last| last.load == load) else {
            let iterations = self.iterated(load, None, settings)?.iterations;
            return Ok(Followed { iterations, cells: None });
        };
        let cells = &self.cells;
        let mut changed = std::mem::take(&mut self.changed);
        changed.sort_unstable();
        changed.dedup();
        // A change affects the rows of the nodes around it alone; all other residuals stay valid.
        easing::residual(cells, &changed, &last.displacement, load, &mut last.residual);
        let most = settings.tolerance * last.load_size;
        let size = |last: &Last| dot(&last.residual, &last.residual).sqrt();
        // Never below a thousandth of the tolerance: small changes would otherwise ask for more
        // digits than rounding leaves.
        let goal = most.min((gain * size(&last)).max(1e-3 * most));
        let most_near = (NEAR * load.len() as f64) as usize;
        let near = easing::within(cells, &changed, (REACH, most_near), load.len());
        // Where much of a part has changed, the whole part is solved at once.
        if near[0].len() < 2 * most_near {
            let (u, r) = (&mut last.displacement, &mut last.residual);
            easing::ease(cells, &near, load, u, r, (EASED * goal, MOST_EASING));
        }
        if size(&last) <= goal || (changed.is_empty() && size(&last) <= most) {
            self.last = Some(last);
            return Ok(Followed { iterations: 0, cells: Some(self.cells.around_nodes(&near[0])) });
        }
        let settings = SolveSettings { tolerance: goal / last.load_size, ..settings.clone() };
        let iterations = self.iterated(load, Some((last.displacement, last.residual)), &settings)?.iterations;
        Ok(Followed { iterations, cells: None })
    }

    /// Displacement of the nodes in the last solution, mm; empty before the first one.
    pub fn displacement(&self) -> &[DVec3] {
        self.last.as_ref().map_or(&[], |last| &last.displacement)
    }

    /// Conjugate gradients from a displacement and its residual, or from zero.
    fn iterated(
        &mut self,
        load: &[DVec3],
        from: Option<(Vec<DVec3>, Vec<DVec3>)>,
        settings: &SolveSettings,
    ) -> Result<Solution, SolidError> {
        self.changed.clear();
        // Up to twice the usual number of iterations, and ten, is tried before the preconditioner
        // is made anew.
        let patience = self.usual.map_or(settings.max_iterations, |n| 2 * n + 10);
        let mut solved = None;
        if self.stale {
            let short =
                SolveSettings { max_iterations: patience.min(settings.max_iterations), ..settings.clone() };
            // The start is copied, because a second attempt with a new preconditioner begins from
            // it again.
            match iterate(&self.cells, &mut self.multigrid, load, from.clone(), &short) {
                Err(SolidError::NotConverged { .. } | SolidError::NotPositive) => {
                    self.multigrid = self.cells.multigrid(Use::Often);
                    self.prepared += 1;
                    self.stale = false;
                    self.usual = None;
                }
                other => solved = Some(other?),
            }
        }
        let Solved { solution, residual, load_size } = match solved {
            Some(solved) => solved,
            None => {
                let solved = iterate(&self.cells, &mut self.multigrid, load, from, settings)?;
                // The first solution with a new preconditioner sets the usual number of iterations for later ones.
                self.usual.get_or_insert(solved.solution.iterations);
                solved
            }
        };
        let displacement = solution.displacement.clone();
        self.last = Some(Last { load: load.to_vec(), displacement, residual, load_size });
        Ok(solution)
    }

    /// Strain at the centre of a cell, in the order xx, yy, zz, xy, yz, zx; `None` for a void cell.
    pub fn strain(&self, displacement: &[DVec3], cell: usize) -> Option<[f64; 6]> {
        self.strain_at(displacement, cell, DVec3::ZERO)
    }

    /// Strain at a point of a cell from the trilinear displacement between its corners. `place` runs from -1 to 1
    /// along each axis; `None` for a void cell.
    fn strain_at(&self, displacement: &[DVec3], cell: usize, place: DVec3) -> Option<[f64; 6]> {
        let part = &self.cells.part;
        let c = part.at(cell);
        part.solid(c)?;
        let mut grad = DMat3::ZERO;
        for k in 0..8 {
            let u = displacement[self.cells.node_of[part.point_index(c + corner(k))] as usize];
            let s = corner(k).as_dvec3() * 2.0 - 1.0;
            let f = DVec3::ONE + s * place;
            // Derivative of a trilinear shape function: the product of (1 + s xi) / 2 over the axes, with
            // xi = 2 x / edge.
            let slope = DVec3::new(s.x * f.y * f.z, s.y * f.x * f.z, s.z * f.x * f.y) * 0.25 / part.cell_mm;
            grad += DMat3::from_cols(u * slope.x, u * slope.y, u * slope.z);
        }
        Some(element::strain(&grad))
    }

    /// The bending strain of a cell in a wall with normal `axis`: the strain at the cell's face at the upper end of
    /// the axis, less the strain at the cell's middle. Its three components in the plane of the wall follow from
    /// the displacements of the cell's corners. The other three are chosen so that the bending stress on the face
    /// is zero. Order xx, yy, zz, xy, yz, zx; `None` for a void cell.
    pub(crate) fn bending_strain(
        &self,
        displacement: &[DVec3],
        cell: usize,
        axis: usize,
    ) -> Option<[f64; 6]> {
        let part = &self.cells.part;
        let middle = self.strain_at(displacement, cell, DVec3::ZERO)?;
        let face = self.strain_at(displacement, cell, DVec3::AXES[axis])?;
        let free = [[0, 3, 5], [1, 3, 4], [2, 4, 5]][axis];
        let mut bending: [f64; 6] =
            std::array::from_fn(|k| if free.contains(&k) { 0.0 } else { face[k] - middle[k] });
        let stiffness = &part.palette[usize::from(part.material[cell])];
        let stress = element::multiply(stiffness, &bending);
        let block = DMat3::from_cols_array_2d(&free.map(|j| free.map(|i| stiffness[i][j])));
        let strain = -(block.inverse() * DVec3::from_array(free.map(|k| stress[k])));
        free.into_iter().zip(strain.to_array()).for_each(|(k, value)| bending[k] = value);
        Some(bending)
    }

    /// Stress in MPa and strain at the centre of a cell, in the same order; `None` for a void cell.
    pub fn stress(&self, displacement: &[DVec3], cell: usize) -> Option<([f64; 6], [f64; 6])> {
        let strain = self.strain(displacement, cell)?;
        let part = &self.cells.part;
        let stress = element::multiply(&part.palette[usize::from(part.material[cell])], &strain);
        Some((stress.map(|s| s * f64::from(part.scale[cell])), strain))
    }
}

/// Shape functions of a box: those of its eight corners, and the three modes `1 - xi^2` that let it bend.
/// Source: derived. Wilson's incompatible modes, one for each axis.
const MODES: usize = 11;

/// Stiffness of a box of eight nodes that bends without locking, integrated at 2 x 2 x 2 points. Three incompatible modes of
/// displacement are added to the eight trilinear shape functions and condensed (`wilson1973` in docs/references.bib):
/// without them a box under bending deforms in shear, and a wall a few cells thick is far too stiff. Boxes pass the patch
/// test as they are, because the gradients of the modes add up to zero.
fn element_matrix(law: &Law, cell_mm: DVec3) -> [[DMat3; 8]; 8] {
    // Gauss points at 1 / sqrt 3 integrate the stiffness of a box exactly.
    let g = 1.0 / 3.0f64.sqrt();
    let mut sums = [[DMat3::ZERO; MODES]; MODES];
    let weight = cell_mm.element_product() / 8.0;
    for q in 0..8 {
        let at = (corner(q).as_dvec3() * 2.0 - 1.0) * g;
        let slope = |c: usize| {
            if c >= 8 {
                // The size of a condensed mode does not matter.
                return DVec3::AXES[c - 8] * at / cell_mm;
            }
            let s = corner(c).as_dvec3() * 2.0 - 1.0;
            let f = DVec3::ONE + s * at;
            DVec3::new(s.x * f.y * f.z, s.y * f.x * f.z, s.z * f.x * f.y) * 0.25 / cell_mm
        };
        for a in 0..MODES {
            for b in 0..=a {
                let (ga, gb) = (slope(a) * weight, slope(b));
                sums[a][b] += DMat3::from_cols(ga * gb.x, ga * gb.y, ga * gb.z);
            }
        }
    }
    let mut k = element::stiffness(&sums, law);
    for mode in (8..MODES).rev() {
        let solved = k[mode][mode].inverse();
        let row = k[mode];
        for a in 0..mode {
            for b in 0..=a {
                k[a][b] -= row[a].transpose() * solved * row[b];
            }
        }
    }
    // Blocks above the diagonal follow from symmetry.
    std::array::from_fn(|a| std::array::from_fn(|b| if b <= a { k[a][b] } else { k[b][a].transpose() }))
}

/// Blocks of the lower half of an element of eight nodes. Source: derived: 8 x 9 / 2.
const LOWER: usize = 36;

/// Weight of coarse corner `k` at corner `a` of child `c` of a coarse cell.
fn weight(c: usize, a: usize, k: usize) -> f64 {
    // Corners of a child lie at 0, 1/2 or 1 along the edges of the coarse cell.
    let at = corner(c) + corner(a);
    (0..3)
        .map(|i| if corner(k)[i] == 1 { f64::from(at[i]) / 2.0 } else { 1.0 - f64::from(at[i]) / 2.0 })
        .product()
}

impl VoxelCells {
    fn new(
        part: VoxelPart,
        hold: &[([usize; 3], DVec3, f64)],
        settings: &SolveSettings,
    ) -> Result<Self, SolidError> {
        let n_cells = part.n.iter().product::<usize>();
        if n_cells == 0 || part.material.len() != n_cells || part.scale.len() != n_cells {
            return Err(SolidError::NothingInside);
        }
        let law = |(material, d)| Law::new(d).ok_or(SolidError::Material { material });
        let laws: Vec<Law> = part.palette.iter().enumerate().map(law).collect::<Result<_, _>>()?;
        if let Some(bad) = part.material.iter().find(|&&m| m != VOID && usize::from(m) >= laws.len()) {
            return Err(SolidError::Material { material: usize::from(*bad) });
        }
        let elements: Vec<_> = laws.iter().map(|l| element_matrix(l, part.cell_mm)).collect();
        let stencils = elements.iter().map(stencil).collect();
        let points = part.size() + 1;
        let mut node_of = vec![NONE; points.as_u64vec3().element_product() as usize];
        let mut nodes = Vec::new();
        for z in 0..points.z {
            for y in 0..points.y {
                for x in 0..points.x {
                    let p = IVec3::new(x, y, z);
                    // `p - corner(c)` runs over the eight cells around the point.
                    if (0..8).any(|c| part.solid(p - corner(c)).is_some()) {
                        node_of[part.point_index(p)] = nodes.len() as u32;
                        nodes.push(p);
                    }
                }
            }
        }
        if nodes.is_empty() {
            return Err(SolidError::NothingInside);
        }
        // Memory for the vectors of both levels, the stencils of the coarse level, and the tables of neighbours.
        let need_mib = |bytes: usize| (bytes * nodes.len() + 10 * n_cells) as f64 / BYTES_PER_MIB;
        let [roomy, tight] = NODE_BYTES.map(need_mib);
        if tight > settings.max_mib {
            return Err(SolidError::Memory {
                what: "solving on voxels",
                need_mib: tight,
                limit_mib: settings.max_mib,
                fitting_mm: fitting_edge_mm(part.cell_mm.max_element(), tight, settings.max_mib),
            });
        }
        // If memory is short, the single-precision matrix is left out first: the preconditioner is
        // then slower but equally good.
        let rough = if roomy > settings.max_mib { Vec::new() } else { vec![half_matrix::EMPTY; nodes.len()] };
        let uniform = vec![(VOID, 0.0); nodes.len()];
        let supports = Supports::new(nodes.len());
        let around = around(&part, &node_of, &nodes);
        let slabs = half_matrix::slabs(rough.len(), |i| &around[i][MIDDLE + 1..]);
        let mut cells =
            Self { part, supports, elements, stencils, node_of, nodes, around, uniform, rough, slabs };
        for &(p, direction, value) in hold {
            let inside = (0..3).all(|a| p[a] <= cells.part.n[a]);
            let p = IVec3::new(p[0] as i32, p[1] as i32, p[2] as i32);
            let node = if inside { cells.node_of[cells.part.point_index(p)] } else { NONE };
            // A support at a point outside the material is left out.
            if node != NONE {
                let place = cells.place(p);
                cells.supports.prescribe_at(node, place, direction, value)?;
            }
        }
        // A piece that can move freely makes the matrix singular, and the iterations would not converge.
        cells.check()?;
        let all: Vec<u32> = (0..cells.nodes.len() as u32).collect();
        cells.update(&all);
        Ok(cells)
    }

    fn place(&self, p: IVec3) -> DVec3 {
        self.part.origin + self.part.cell_mm * p.as_dvec3()
    }

    /// Checks the supports of every piece; cells are connected over faces.
    fn check(&self) -> Result<(), SolidError> {
        let n = self.part.size();
        let at = |i: usize| self.part.at(i);
        let total = n.as_u64vec3().element_product() as usize;
        let mut piece = vec![NONE; total];
        let mut of_node = vec![NONE; self.nodes.len()];
        let mut pieces = Vec::new();
        for start in 0..total {
            if piece[start] != NONE || self.part.solid(at(start)).is_none() {
                continue;
            }
            let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let mut todo = vec![start];
            piece[start] = start as u32;
            while let Some(i) = todo.pop() {
                let c = at(i);
                lo = lo.min(self.place(c));
                hi = hi.max(self.place(c + 1));
                for k in 0..8 {
                    of_node[self.node_of[self.part.point_index(c + corner(k))] as usize] = start as u32;
                }
                // Cells that share only an edge form a hinge, which leaves a rotation free.
                for step in IVec3::AXES.iter().flat_map(|&e| [e, -e]) {
                    if let Some(j) = self.part.cell(c + step)
                        && piece[j] == NONE
                        && self.part.solid(c + step).is_some()
                    {
                        piece[j] = start as u32;
                        todo.push(j);
                    }
                }
            }
            pieces.push((start as u32, lo, hi));
        }
        let places: Vec<DVec3> = self.nodes.iter().map(|&p| self.place(p)).collect();
        self.supports.check_pieces(&places, &of_node, &pieces)
    }

    fn nodes_of(&self, cell: usize) -> [u32; 8] {
        let c = self.part.at(cell);
        std::array::from_fn(|k| self.node_of[self.part.point_index(c + corner(k))])
    }

    /// Recomputes the stored rows of the matrix at these nodes, after cells around them have
    /// changed.
    fn update(&mut self, nodes: &[u32]) {
        let part = &self.part;
        let uniform = |&i: &u32| {
            let p = self.nodes[i as usize];
            // The cell with the node's own index is the upper one of the eight around the node.
            let first = part.solid(p).unwrap_or((VOID, 0.0));
            let alike = (1..8).all(|c| part.solid(p - corner(c)) == Some(first));
            if alike { first } else { (VOID, 0.0) }
        };
        let found: Vec<(u16, f32)> = nodes.par_iter().map(uniform).collect();
        nodes.iter().zip(found).for_each(|(&i, found)| self.uniform[i as usize] = found);
        if self.rough.is_empty() {
            return;
        }
        // Rows that wait to be copied are computed in chunks to bound the memory: 1024 rows take half a megabyte.
        if nodes.len() == self.nodes.len() {
            let mut rough = std::mem::take(&mut self.rough);
            // A new part writes all rows in place.
            let rows = rough.par_iter_mut().enumerate().with_min_len(CHUNK / 4);
            rows.for_each(|(i, row)| *row = self.half_row(i));
            self.rough = rough;
            return;
        }
        for nodes in nodes.chunks(CHUNK) {
            let rows: Vec<_> = nodes.par_iter().map(|&i| self.half_row(i as usize)).collect();
            nodes.iter().zip(rows).for_each(|(&i, row)| self.rough[i as usize] = row);
        }
    }

    /// Coupling of a node with itself and its neighbours of higher number, in single precision.
    fn half_row(&self, i: usize) -> half_matrix::Row {
        let p = self.nodes[i];
        let mut blocks = [DMat3::ZERO; AFTER + 1];
        for a in 0..8 {
            let Some((material, scale)) = self.part.solid(p - corner(a)) else { continue };
            for (b, block) in self.elements[usize::from(material)][a].iter().enumerate() {
                // Blocks with nodes of lower number are those of the other half.
                if BETWEEN[a][b] >= MIDDLE {
                    blocks[BETWEEN[a][b] - MIDDLE] += *block * f64::from(scale);
                }
            }
        }
        let mut row = half_matrix::EMPTY;
        for (k, block) in blocks.iter().enumerate() {
            half_matrix::put(&mut row, k, block);
        }
        row
    }

    fn force(&self, i: usize, u: &[DVec3]) -> DVec3 {
        // Where a neighbour is missing, the node itself stands in its place; the block there is zero.
        let near = self.around[i].map(|j| u[j as usize]);
        let (material, scale) = self.uniform[i];
        // Most nodes lie between eight equal cells, whose stencil is computed once for each
        // material.
        if material != VOID {
            let stencil = &self.stencils[usize::from(material)];
            let sum: DVec3 = stencil.iter().zip(&near).map(|(block, u)| *block * *u).sum();
            return sum * f64::from(scale);
        }
        let p = self.nodes[i];
        let mut sum = DVec3::ZERO;
        for a in 0..8 {
            let Some((material, scale)) = self.part.solid(p - corner(a)) else { continue };
            let row = &self.elements[usize::from(material)][a];
            let own: DVec3 = row.iter().zip(&BETWEEN[a]).map(|(block, &k)| *block * near[k]).sum();
            sum += own * f64::from(scale);
        }
        sum
    }

    /// Cells around some nodes, in order.
    fn around_nodes(&self, nodes: &[u32]) -> Vec<usize> {
        let around = nodes.iter().flat_map(|&i| {
            let p = self.nodes[i as usize];
            (0..8).filter_map(move |c| self.part.cell(p - corner(c)))
        });
        let mut cells: Vec<usize> = around.collect();
        cells.par_sort_unstable();
        cells.dedup();
        cells
    }

    /// The diagonal block; for supported directions the identity.
    fn block(&self, i: usize) -> DMat3 {
        let p = self.nodes[i];
        let k = (0..8).fold(DMat3::ZERO, |s, a| match self.part.solid(p - corner(a)) {
            Some((m, scale)) => s + self.elements[usize::from(m)][a][a] * f64::from(scale),
            None => s,
        });
        self.supports.free(i).map_or(k, |p| *p * k * *p + (DMat3::IDENTITY - *p))
    }

    /// Neighbours of a node that have a higher number; where one is missing, the node itself.
    fn after(&self, i: usize) -> &[u32] {
        &self.around[i][MIDDLE + 1..]
    }

    /// The group of each of the nodes in use up to one cell from a grid point, counted from 0, where nodes belong together that
    /// solid cells around them join; an empty list if they join all.
    fn touching_groups(&self, point: IVec3) -> Vec<u32> {
        let mut groups: Vec<u32> = Vec::new();
        for (cell, nodes) in AROUND_POINT {
            if self.part.solid(point + IVec3::from_array(cell)).is_none() {
                continue;
            }
            let joined =
                groups.extract_if(.., |group| *group & nodes != 0).fold(nodes, |all, group| all | group);
            if joined == ALL_AROUND {
                return Vec::new();
            }
            groups.push(joined);
        }
        if groups.len() < 2 {
            return Vec::new();
        }
        groups.sort_unstable_by_key(|group| group.trailing_zeros());
        let all = groups.iter().fold(0, |all, group| all | group);
        let group_of = |node: u32| groups.iter().position(|group| group >> node & 1 == 1);
        (0..27).filter(|node| all >> node & 1 == 1).filter_map(group_of).map(|group| group as u32).collect()
    }

    /// The preconditioner: a level of cells of twice the width, whose element matrices are the
    /// Galerkin products of the cells in them, and coarser grids below it.
    fn multigrid(&self, usage: Use) -> Multigrid {
        // An odd number of cells leaves one half of the last coarse cell empty.
        let coarse_n = (self.part.size() + 1) / 2;
        let points = coarse_n + 1;
        let index =
            |p: IVec3| (p.z as usize * points.y as usize + p.y as usize) * points.x as usize + p.x as usize;
        let mut id = vec![NONE; points.as_u64vec3().element_product() as usize];
        let mut first = Transfer { start: vec![0], ..Transfer::default() };
        let weights = |p: IVec3| {
            // Along each axis, an even point coincides with a coarse one, and an odd point lies
            // half-way between two.
            let (low, odd) = (p / 2, p - p / 2 * 2);
            let n = (0..8).filter(move |&k| (corner(k) - odd).cmple(IVec3::ZERO).all());
            let w = 0.5f64.powi(odd.x + odd.y + odd.z);
            n.map(move |k| (low + corner(k), w))
        };
        for &p in &self.nodes {
            for (q, _) in weights(p) {
                id[index(q)] = 0;
            }
        }
        // Coarse nodes are numbered by position, so that neighbours are near each other in memory.
        let mut places = Vec::new();
        for z in 0..points.z {
            for y in 0..points.y {
                for x in 0..points.x {
                    let p = IVec3::new(x, y, z);
                    if id[index(p)] != NONE {
                        id[index(p)] = places.len() as u32;
                        places.push(p.as_dvec3());
                    }
                }
            }
        }
        for &p in &self.nodes {
            for (q, w) in weights(p) {
                first.coarse.push(id[index(q)]);
                first.weight.push(w);
            }
            first.start.push(first.coarse.len() as u32);
        }
        first.n_coarse = places.len();
        let groups: Vec<Vec<u32>> =
            places.par_iter().map(|p| self.touching_groups(p.as_ivec3() * 2)).collect();
        if let Some(node_of_copy) = first.split(&groups) {
            places = node_of_copy.iter().map(|node| places[*node as usize]).collect();
        }
        first.held =
            (0..self.nodes.len()).filter_map(|i| self.supports.free(i).map(|p| (i as u32, *p))).collect();
        let cell_index = |c: IVec3| {
            (c.z as usize * coarse_n.y as usize + c.y as usize) * coarse_n.x as usize + c.x as usize
        };
        let mut hex_of = vec![NONE; coarse_n.as_u64vec3().element_product() as usize];
        let mut hexes: Vec<[u32; 8]> = Vec::new();
        let mut origins = Vec::new();
        for z in 0..coarse_n.z {
            for y in 0..coarse_n.y {
                for x in 0..coarse_n.x {
                    let c = IVec3::new(x, y, z);
                    if (0..8).any(|k| self.part.solid(c * 2 + corner(k)).is_some()) {
                        // The centre of a coarse cell is a corner of each of its children, so all
                        // eight corners of the coarse cell are in use, and its children belong to the same copies.
                        let centre = self.node_of[self.part.point_index(c * 2 + 1)] as usize;
                        let corners = first.start[centre] as usize;
                        hex_of[cell_index(c)] = hexes.len() as u32;
                        hexes.push(std::array::from_fn(|k| first.coarse[corners + k]));
                        origins.push(c * 2);
                    }
                }
            }
        }
        // Only stiffnesses in use are gathered: broken cells leave many unused ones behind.
        let mut used = vec![false; self.elements.len()];
        let in_use = self.part.material.iter().filter(|m| **m != VOID);
        in_use.for_each(|m| used[usize::from(*m)] = true);
        let children: Vec<Vec<[[DMat3; 8]; 8]>> = (self.elements.par_iter().zip(&used))
            .map(|(k, used)| (0..8).filter(|_| *used).map(|c| gathered(c, k)).collect())
            .collect();
        // The stiffness of a coarse cell is computed once and added to the rows of its eight nodes below, each of which adds its
        // cells in the same order whatever thread takes it.
        let of_hex = |h: usize| {
            let mut sum = [DMat3::ZERO; LOWER];
            for c in 0..8 {
                let child = origins[h] + corner(c);
                let Some((material, scale)) = self.part.solid(child) else { continue };
                let held: [Option<&DMat3>; 8] = std::array::from_fn(|a| {
                    self.supports.free(self.node_of[self.part.point_index(child + corner(a))] as usize)
                });
                let mut own = &children[usize::from(material)][c];
                let with_held;
                // Supports are applied to an element before it is transferred, so that the coarse
                // level does not see supported motions.
                if held.iter().any(Option::is_some) {
                    let mut k = self.elements[usize::from(material)];
                    for a in 0..8 {
                        for b in 0..8 {
                            if let Some(p) = held[a] {
                                k[a][b] = *p * k[a][b];
                            }
                            if let Some(p) = held[b] {
                                k[a][b] *= *p;
                            }
                        }
                    }
                    with_held = gathered(c, &k);
                    own = &with_held;
                }
                let blocks = (0..8).flat_map(|a| own[a][..=a].iter());
                sum.iter_mut().zip(blocks).for_each(|(sum, own)| *sum += *own * f64::from(scale));
            }
            sum
        };
        let stiffness: Vec<[DMat3; LOWER]> = (0..hexes.len()).into_par_iter().map(of_hex).collect();
        let row = |(own, p): (usize, &DVec3)| {
            let p = p.as_ivec3();
            let mut sums = RowSums::<27>::new();
            // The coarse cells around the node in the order of their numbers: the last corner of a cell is the first to come.
            for a in (0..8).rev() {
                let c = p - corner(a);
                let inside = c.cmpge(IVec3::ZERO).all() && c.cmplt(coarse_n).all();
                let h = if inside { hex_of[cell_index(c)] } else { NONE };
                if h == NONE || hexes[h as usize][a] != own as u32 {
                    continue;
                }
                let k = &stiffness[h as usize];
                for b in 0..8 {
                    let block =
                        if b <= a { k[a * (a + 1) / 2 + b] } else { k[b * (b + 1) / 2 + a].transpose() };
                    sums.add(BETWEEN[a][b], hexes[h as usize][b], block);
                }
            }
            sums.into_row()
        };
        let rows = places.par_iter().enumerate().map(row).collect();
        // Elements take as much memory as the rows that were made of them.
        drop(stiffness);
        let matrix = Blocks::from_rows(rows);
        let (mut transfer, mut cells) =
            CoarseGrid { origin: DVec3::ZERO, width: 2.0 }.over(&places, Vec::new());
        transfer.split_uncoupled(&mut cells, &matrix);
        Multigrid::below(self, first, (matrix, GRID), (transfer, cells), usage)
    }
}

/// A set of the 27 nodes up to one cell from a grid point, by bits, x fastest. Source: derived.
const ALL_AROUND: u32 = (1 << 27) - 1;

/// The 64 cells that touch these nodes, those at the point first: where each lies, as steps from the cell above the point, and
/// which of the nodes are its corners. Source: derived.
const AROUND_POINT: [([i32; 3], u32); 64] = {
    let mut out = [([0; 3], 0); 64];
    let (mut n, mut outer) = (0, 0);
    while outer < 2 {
        let mut k = 0;
        while k < 64 {
            let cell = [k % 4 - 2, k / 4 % 4 - 2, k / 16 - 2];
            let (mut nodes, mut inside, mut corner) = (0u32, 0, 0);
            while corner < 8 {
                let (x, y, z) =
                    (cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
                if -1 <= x && x <= 1 && -1 <= y && y <= 1 && -1 <= z && z <= 1 {
                    nodes |= 1 << ((z + 1) * 9 + (y + 1) * 3 + x + 1);
                    inside += 1;
                }
                corner += 1;
            }
            if (inside == 8) == (outer == 0) {
                out[n] = (cell, nodes);
                n += 1;
            }
            k += 1;
        }
        outer += 1;
    }
    out
};

/// The stiffness of a cell expressed in the corners of the coarse cell of which it is child `c`.
fn gathered(c: usize, k: &[[DMat3; 8]; 8]) -> [[DMat3; 8]; 8] {
    let half: [[DMat3; 8]; 8] = std::array::from_fn(|a| {
        std::array::from_fn(|q| (0..8).fold(DMat3::ZERO, |s, b| s + k[a][b] * weight(c, b, q)))
    });
    std::array::from_fn(|p| {
        std::array::from_fn(|q| (0..8).fold(DMat3::ZERO, |s, a| s + half[a][q] * weight(c, a, p)))
    })
}

fn around(part: &VoxelPart, node_of: &[u32], nodes: &[IVec3]) -> Vec<[u32; 27]> {
    let step = |k: usize| IVec3::new(k as i32 % 3, k as i32 / 3 % 3, k as i32 / 9) - 1;
    // In memory the points around a point lie equally far from it everywhere.
    let (nx, ny) = (part.n[0] as isize + 1, part.n[1] as isize + 1);
    let off: [isize; 27] = std::array::from_fn(|k| {
        let d = step(k);
        (d.z as isize * ny + d.y as isize) * nx + d.x as isize
    });
    let neighbours = |(own, &p): (usize, &IVec3)| {
        // Nearly all points have all their neighbours within the grid.
        let at = part.point_index(p);
        let within = p.cmpgt(IVec3::ZERO).all() && p.cmplt(part.size()).all();
        std::array::from_fn(|k| {
            let q = p + step(k);
            let inside = within || (q.cmpge(IVec3::ZERO).all() && q.cmple(part.size()).all());
            let node = if inside { node_of[at.wrapping_add_signed(off[k])] } else { NONE };
            if node == NONE { own as u32 } else { node }
        })
    };
    nodes.par_iter().enumerate().map(neighbours).collect()
}

/// For corners `a` and `b` of a cell, the position of `b` among the 27 neighbours of `a`. Source:
/// derived, computed here.
const BETWEEN: [[usize; 8]; 8] = {
    let mut out = [[0; 8]; 8];
    let mut i = 0;
    while i < 64 {
        let (a, b) = (i / 8, i % 8);
        let (x, y, z) = ((b & 1) + 1 - (a & 1), (b >> 1 & 1) + 1 - (a >> 1 & 1), (b >> 2) + 1 - (a >> 2));
        out[a][b] = (z * 3 + y) * 3 + x;
        i += 1;
    }
    out
};

fn stencil(k: &[[DMat3; 8]; 8]) -> [DMat3; 27] {
    let mut out = [DMat3::ZERO; 27];
    for a in 0..8 {
        for b in 0..8 {
            out[BETWEEN[a][b]] += k[a][b];
        }
    }
    out
}

impl Rows for VoxelCells {
    fn around(&self, node: usize) -> &[u32] {
        &self.around[node]
    }

    fn row(&self, node: usize, u: &[DVec3]) -> DVec3 {
        self.force(node, u)
    }

    fn rough_part<'a>(&'a self, nodes: &'a [u32]) -> RoughPart<'a> {
        let n = self.nodes.len();
        if self.rough.is_empty() {
            let mut whole = vec![DVec3::ZERO; n];
            return Box::new(move |u, forces| {
                nodes.iter().zip(u).for_each(|(&i, u)| whole[i as usize] = *u);
                let force = |(force, &i): (&mut DVec3, &u32)| *force = self.force(i as usize, &whole);
                forces.par_iter_mut().zip(nodes).with_min_len(CHUNK / 4).for_each(force);
            });
        }
        let mut number = vec![NONE; n];
        (0u32..).zip(nodes).for_each(|(own, &i)| number[i as usize] = own);
        // Only nodes of the part move and only their forces are asked for, so the blocks of all others are left out. A part
        // is corrected in up to `MOST_EASING` steps, and reads its rows in each, so they are gathered once.
        let within_part = |(own, &i): (usize, &u32)| {
            let (mut row, mut after) = (self.rough[i as usize], [own as u32; AFTER]);
            for (k, &j) in self.after(i as usize).iter().enumerate() {
                match number[j as usize] {
                    NONE => row.iter_mut().for_each(|line| line[3 + 3 * k..][..3].fill(0.0)),
                    number => after[k] = number,
                }
            }
            (row, after)
        };
        let (rows, after): (Vec<half_matrix::Row>, Vec<[u32; AFTER]>) =
            nodes.par_iter().enumerate().map(within_part).unzip();
        let slabs = half_matrix::slabs(nodes.len(), |i| &after[i]);
        Box::new(move |u, forces| {
            half_matrix::forces(&rows, |i| &after[i], &slabs, &half_matrix::rounded(u), forces)
        })
    }

    fn inverse_block(&self, node: usize) -> DMat3 {
        inverse(self.block(node))
    }

    fn free(&self, node: usize) -> Option<&DMat3> {
        self.supports.free(node)
    }
}

/// The cells with their matrix in single precision, in place of the whole one.
struct RoughCells<'a>(&'a VoxelCells);

impl System for RoughCells<'_> {
    fn n_nodes(&self) -> usize {
        self.0.n_nodes()
    }

    fn supports(&self) -> &Supports {
        &self.0.supports
    }

    fn scratch(&self) -> Vec<DVec3> {
        Vec::new()
    }

    fn forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        let cells = self.0;
        if cells.rough.is_empty() {
            return cells.forces(u, f, scratch);
        }
        half_matrix::forces_of_differences(&cells.rough, |i| cells.after(i), &cells.slabs, u, f);
    }

    fn rough_forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.0.rough_forces(u, f, scratch);
    }

    fn inverse_diagonal(&self) -> Vec<DMat3> {
        self.0.inverse_diagonal()
    }
}

impl System for VoxelCells {
    fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    fn supports(&self) -> &Supports {
        &self.supports
    }

    fn scratch(&self) -> Vec<DVec3> {
        Vec::new()
    }

    fn forces(&self, u: &[DVec3], f: &mut [DVec3], _: &mut [DVec3]) {
        f.par_chunks_mut(CHUNK).enumerate().for_each(|(c, chunk)| {
            for (i, f) in (c * CHUNK..).zip(chunk) {
                *f = self.force(i, u);
            }
        });
    }

    fn rough_forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        if self.rough.is_empty() {
            return self.forces(u, f, scratch);
        }
        half_matrix::forces(&self.rough, |i| self.after(i), &self.slabs, &half_matrix::rounded(u), f);
    }

    fn inverse_diagonal(&self) -> Vec<DMat3> {
        (0..self.nodes.len()).into_par_iter().map(|i| self.inverse_block(i)).collect()
    }
}
