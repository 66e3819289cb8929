//! The square elements of a plate: numbering, connected pieces, free motions, stiffness and strain.
//!
//! Method: cells of a grid that have material become elements of four nodes. Their stiffness is bilinear with
//! two incompatible modes condensed (`wilson1973`), integrated at 2 x 2 points, so that a strip one cell wide
//! bends without locking. Pieces are found by flood fill over shared sides. A set of supports leaves no rigid
//! motion if the Gram matrix of their rows (along x, along y, lever arm) has full rank.
//!
//! Lengths are in mm. Corners run counter-clockwise from the lowest; the stiffness is `(8, 8)`, N/mm, with x
//! and y of each node in turn, from a membrane stiffness in N/mm. It does not depend on the size of the
//! square. Strains are xx, yy and the doubled xy. Cost: linear in the cells; an element matrix takes about
//! 2500 products.
//!
//! Degenerate cases: cells that touch at a corner share a node but are different pieces. Without supports the
//! first free motion is along x. A grid without active cells has no elements and no nodes.

use grainpath_core::DVec2;

use super::cell_grid::CellGrid;
use crate::plane::PlaneStiffness;

/// A node held along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridHold {
    /// The number of the node.
    pub node: u32,
    /// Unit vector along which it is held.
    pub along: DVec2,
}

const NONE: u32 = u32::MAX;

/// The cells of a grid that have material, as square elements.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateElements {
    /// The cells.
    pub grid: CellGrid,
    /// Cell of each element.
    pub cells: Vec<u32>,
    /// Corners of each element, counter-clockwise from the lowest.
    pub corners: Vec<[u32; 4]>,
    /// Column and row of each node among the corners of the grid.
    pub places: Vec<[u32; 2]>,
}

impl PlateElements {
    /// Makes elements of the cells that are `active`.
    pub fn from_cells(grid: &CellGrid, active: &[bool]) -> Self {
        let row = grid.nx + 1;
        let mut number = vec![NONE; row * (grid.ny + 1)];
        let cells: Vec<u32> = (0..active.len()).filter(|&c| active[c]).map(|c| c as u32).collect();
        let around = |cell: u32| {
            let (i, j) = (cell as usize % grid.nx, cell as usize / grid.nx);
            [j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i]
        };
        for &cell in &cells {
            around(cell).into_iter().for_each(|n| number[n] = 0);
        }
        let mut places = Vec::new();
        for (n, id) in number.iter_mut().enumerate().filter(|(_, id)| **id == 0) {
            *id = places.len() as u32;
            places.push([(n % row) as u32, (n / row) as u32]);
        }
        let corners = cells.iter().map(|&c| around(c).map(|n| number[n])).collect();
        Self { grid: *grid, cells, corners, places }
    }

    /// The position of a node, mm.
    pub fn node(&self, i: usize) -> DVec2 {
        let [x, y] = self.places[i];
        self.grid.low + self.grid.cell_mm * DVec2::new(f64::from(x), f64::from(y))
    }
}

/// For each cell the number of the piece that it belongs to, and the number of pieces. Cells that share a side belong
/// together; `None` for cells that are not `active`.
pub fn connected_cells(grid: &CellGrid, active: &[bool]) -> (Vec<Option<u32>>, usize) {
    let mut piece = vec![None; active.len()];
    let mut n = 0;
    let mut open = Vec::new();
    for start in 0..active.len() {
        if !active[start] || piece[start].is_some() {
            continue;
        }
        piece[start] = Some(n);
        open.push(start);
        while let Some(cell) = open.pop() {
            for (_, next) in grid.around(cell).filter(|(off, _)| off.x * off.y == 0.0) {
                if active[next] && piece[next].is_none() {
                    piece[next] = Some(n);
                    open.push(next);
                }
            }
        }
        n += 1;
    }
    (piece, n as usize)
}

/// The rigid motion that supports (places and directions) leave free, in words; `None` where they leave none.
pub fn free_motion(holds: &[(DVec2, DVec2)]) -> Option<&'static str> {
    let Some(&(centre, _)) = holds.first() else { return Some("move along x") };
    let size = holds.iter().map(|h| h.0.distance(centre)).fold(1e-9, f64::max);
    let mut gram = [[0.0; 3]; 3];
    for (place, along) in holds {
        let row = [along.x, along.y, grainpath_core::math::cross((*place - centre) / size, *along)];
        for i in 0..3 {
            (0..3).for_each(|j| gram[i][j] += row[i] * row[j]);
        }
    }
    crate::plane::loose(&mut gram)
}

/// Strain xx, yy, xy (doubled) in the middle of a square from its corners' displacements.
pub fn middle_strain(u: &[DVec2; 4], cell_mm: f64) -> [f64; 3] {
    let h = 0.5 / cell_mm;
    let dx = (u[1] + u[2] - u[0] - u[3]) * h;
    let dy = (u[2] + u[3] - u[0] - u[1]) * h;
    [dx.x, dy.y, dx.y + dy.x]
}

/// The bending strain of a square in a strip with normal `axis`: the strain at the side at the upper end of the axis,
/// less the strain in the middle of the square. The strain along the strip follows from the displacements of the
/// corners. The other two components are chosen so that the bending stress on the side is zero. Order xx, yy, xy.
pub(crate) fn bending_strain(
    u: &[DVec2; 4],
    cell_mm: f64,
    axis: usize,
    membrane: &PlaneStiffness,
) -> [f64; 3] {
    let twist = (u[0] - u[1] + u[2] - u[3]) * (0.5 / cell_mm);
    // Components along the strip, across it, and shear.
    let (along, across, change) = if axis == 0 { (1, 0, twist.y) } else { (0, 1, twist.x) };
    let mut strain = [0.0; 3];
    strain[along] = change;
    let rhs = [-membrane[across][along] * change, -membrane[2][along] * change];
    let [a, b, c] = [membrane[across][across], membrane[across][2], membrane[2][2]];
    let det = a * c - b * b;
    strain[across] = (c * rhs[0] - b * rhs[1]) / det;
    strain[2] = (a * rhs[1] - b * rhs[0]) / det;
    strain
}

/// Stiffness of a square element, `(8, 8)`, N/mm, from the membrane stiffness in N/mm. It is bilinear with Wilson's
/// incompatible modes condensed, so it bends without locking. It does not depend on the size of the square.
pub fn square(membrane: &PlaneStiffness) -> [[f64; 8]; 8] {
    // Source: 1 / sqrt(3), the points of the two-point Gauss rule.
    const GAUSS: f64 = 0.577_350_269_189_625_8;
    let mut k = [[0.0; 12]; 12];
    for (xi, eta) in [(-GAUSS, -GAUSS), (GAUSS, -GAUSS), (GAUSS, GAUSS), (-GAUSS, GAUSS)] {
        let mut b = [[0.0; 12]; 3];
        for (i, (x, y)) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].into_iter().enumerate() {
            let (dx, dy) = (0.25 * x * (1.0 + y * eta), 0.25 * y * (1.0 + x * xi));
            fill(&mut b, 2 * i, dx, dy);
        }
        fill(&mut b, 8, -2.0 * xi, 0.0);
        fill(&mut b, 10, 0.0, -2.0 * eta);
        for r in 0..12 {
            let cb: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| membrane[i][j] * b[j][r]).sum());
            for c in 0..12 {
                k[r][c] += (0..3).map(|i| b[i][c] * cb[i]).sum::<f64>();
            }
        }
    }
    for p in (8..12).rev() {
        let pivot = k[p][p];
        for r in 0..p {
            let f = k[r][p] / pivot;
            for c in 0..p {
                k[r][c] -= f * k[p][c];
            }
        }
    }
    std::array::from_fn(|i| std::array::from_fn(|j| k[i][j]))
}

fn fill(b: &mut [[f64; 12]; 3], column: usize, dx: f64, dy: f64) {
    b[0][column] = dx;
    b[1][column + 1] = dy;
    b[2][column] = dy;
    b[2][column + 1] = dx;
}
