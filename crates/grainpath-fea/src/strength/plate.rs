//! A grid of square elements under plane stress: assembled, factored, solved again as stiffness is lost.

use grainpath_core::DVec2;

use super::cells::Grid;
use super::fronts::{Fronts, Lower};
use crate::plane::PlaneStiffness;
use crate::sparse::SparseError;

/// A node held along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridHold {
    /// Which node.
    pub node: u32,
    /// Unit vector along which it is held.
    pub along: DVec2,
}

const NONE: u32 = u32::MAX;

/// Squares of a grid that have material, and their corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Elements {
    /// The cells.
    pub grid: Grid,
    /// Cell of each element.
    pub cells: Vec<u32>,
    /// Corners of each element, counter-clockwise from the lowest.
    pub corners: Vec<[u32; 4]>,
    /// Place of each node on the grid's corners.
    pub places: Vec<[u32; 2]>,
}

impl Elements {
    /// Elements for the cells that are `taken`.
    pub fn of(grid: &Grid, taken: &[bool]) -> Self {
        let row = grid.nx + 1;
        let mut number = vec![NONE; row * (grid.ny + 1)];
        let cells: Vec<u32> = (0..taken.len()).filter(|&c| taken[c]).map(|c| c as u32).collect();
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

    /// Where a node is, mm.
    pub fn node(&self, i: usize) -> DVec2 {
        let [x, y] = self.places[i];
        self.grid.low + self.grid.cell_mm * DVec2::new(f64::from(x), f64::from(y))
    }
}

/// Cells that hang together over their sides, numbered from 0; `None` for cells that are not `taken`.
pub fn pieces(grid: &Grid, taken: &[bool]) -> (Vec<Option<u32>>, usize) {
    let mut piece = vec![None; taken.len()];
    let mut n = 0;
    let mut open = Vec::new();
    for start in 0..taken.len() {
        if !taken[start] || piece[start].is_some() {
            continue;
        }
        piece[start] = Some(n);
        open.push(start);
        while let Some(cell) = open.pop() {
            for (_, next) in grid.around(cell).filter(|(off, _)| off.x * off.y == 0.0) {
                if taken[next] && piece[next].is_none() {
                    piece[next] = Some(n);
                    open.push(next);
                }
            }
        }
        n += 1;
    }
    (piece, n as usize)
}

/// The motion that these holds leave free, if any: places and directions.
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

/// Stiffness of a square element, `(8, 8)`, N/mm, from membrane stiffness in N/mm: bilinear with Wilson's
/// incompatible modes condensed, so that it bends without locking. The same for squares of any size.
pub fn square(membrane: &PlaneStiffness) -> [[f64; 8]; 8] {
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

/// Holds are this much stiffer than the stiffest node.
const HOLD: f64 = 1e5;
/// What every node has, of the stiffest: hinges at single corners do not make the matrix singular.
const LEAST: f64 = 1e-10;

/// The stiffness of a plate and how to solve it.
pub struct System {
    fronts: Fronts,
    stiffness: Vec<Lower>,
    dofs: usize,
    /// Factorisations so far, of parts too.
    pub factored: usize,
    /// Solutions so far.
    pub solved: usize,
    stale: bool,
}

fn lower(k: &[[f64; 8]; 8]) -> Lower {
    let mut out = [0.0; 36];
    let mut at = 0;
    for (j, row) in k.iter().enumerate() {
        for value in &row[j..] {
            out[at] = *value;
            at += 1;
        }
    }
    out
}

impl System {
    /// Adds up and factors. `forces` act on the unknowns, N.
    ///
    /// # Errors
    /// [`SparseError`] when the factor would take more than `max_bytes` or the plate is not held.
    pub fn new(
        elements: &Elements,
        stiffness: &dyn Fn(usize) -> [[f64; 8]; 8],
        holds: &[GridHold],
        forces: &[f64],
        max_bytes: u64,
    ) -> Result<Self, SparseError> {
        let dofs = 2 * elements.places.len();
        let stiffness: Vec<Lower> = (0..elements.corners.len()).map(|e| lower(&stiffness(e))).collect();
        let stiffest = stiffness.iter().map(|k| k[0].max(k[8])).fold(0.0, f64::max);
        let mut added: Vec<(usize, usize, f64)> = (0..dofs).map(|i| (i, i, LEAST * stiffest)).collect();
        for hold in holds {
            let i = 2 * hold.node as usize;
            let (x, y) = (hold.along.x, hold.along.y);
            for (r, c, share) in [(i, i, x * x), (i + 1, i, x * y), (i + 1, i + 1, y * y)] {
                if share != 0.0 {
                    added.push((r, c, HOLD * stiffest * share));
                }
            }
        }
        let mut fronts = Fronts::new(elements, &added, forces, max_bytes)?;
        fronts.refactor(&stiffness)?;
        Ok(Self { fronts, stiffness, dofs, factored: 1, solved: 0, stale: false })
    }

    /// Unknowns.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Gives an element another stiffness.
    pub fn change(&mut self, element: usize, stiffness: &[[f64; 8]; 8]) {
        self.stiffness[element] = lower(stiffness);
        self.fronts.change(element);
        self.stale = true;
    }

    /// Displacements of the unknowns, mm.
    ///
    /// # Errors
    /// [`SparseError`] when too little stiffness is left.
    pub fn solve(&mut self) -> Result<Vec<f64>, SparseError> {
        if self.stale {
            self.fronts.refactor(&self.stiffness)?;
            self.factored += 1;
            self.stale = false;
        }
        self.solved += 1;
        Ok(self.fronts.solve())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Orthotropic;

    fn bar(nx: usize, ny: usize, cell_mm: f64) -> Elements {
        let grid = Grid { low: DVec2::ZERO, cell_mm, nx, ny };
        Elements::of(&grid, &vec![true; nx * ny])
    }

    #[test]
    fn a_square_has_three_free_motions_and_bends_truly() {
        let c = Orthotropic::isotropic(2000.0, 0.3).plane_stress(0.3).expect("stable");
        let k = square(&c);
        let motions: [[f64; 8]; 3] = [
            [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0],
        ];
        for m in motions {
            for row in &k {
                let f: f64 = row.iter().zip(m).map(|(k, m)| k * m).sum();
                assert!(f.abs() < 1e-9 * c[0][0], "{f}");
            }
        }
        // A cantilever of one element's depth: the beam's deflection by a moment, which plain squares miss by half.
        let (n, h, e, t) = (20, 1.0, 2000.0, 1.0);
        let elements = bar(n, 1, h);
        let held = |i: &u32| elements.places[*i as usize][0] == 0;
        let all = 0..elements.places.len() as u32;
        let holds: Vec<GridHold> = all
            .clone()
            .filter(held)
            .flat_map(|node| {
                let y = elements.places[node as usize][1] == 0;
                let x = GridHold { node, along: DVec2::X };
                std::iter::once(x).chain(y.then_some(GridHold { node, along: DVec2::Y }))
            })
            .collect();
        let c = Orthotropic::isotropic(e, 0.3).plane_stress(0.0).expect("stable");
        let mut f = vec![0.0; 2 * elements.places.len()];
        for i in all.filter(|i| elements.places[*i as usize][0] == n as u32) {
            f[2 * i as usize] = if elements.places[i as usize][1] == 0 { 1.0 } else { -1.0 };
        }
        let mut system = System::new(&elements, &|_| square(&c), &holds, &f, 1 << 30).expect("held");
        let x = system.solve().expect("solved");
        let tip = x[2 * elements.places.iter().position(|p| *p == [n as u32, 0]).expect("tip") + 1];
        let length = n as f64 * h;
        let want = h * length * length / (2.0 * e * t * h * h * h / 12.0);
        assert!((tip.abs() / want - 1.0).abs() < 1e-3, "{tip} {want}");
    }

    #[test]
    fn stiffness_lost_later_is_the_same_as_from_the_start() {
        let elements = bar(30, 12, 0.5);
        let c = Orthotropic::isotropic(2000.0, 0.3).plane_stress(0.0).expect("stable");
        let (whole, soft) = (square(&c), square(&c.map(|r| r.map(|v| 0.01 * v))));
        let all = 0..elements.places.len() as u32;
        let left = all.clone().filter(|i| elements.places[*i as usize][0] == 0);
        let holds: Vec<GridHold> =
            left.flat_map(|node| [DVec2::X, DVec2::Y].map(|along| GridHold { node, along })).collect();
        let mut f = vec![0.0; 2 * elements.places.len()];
        all.filter(|i| elements.places[*i as usize][0] == 30).for_each(|i| f[2 * i as usize] = 1.0);
        let row = |e: usize| elements.cells[e] / 30;
        let column = |e: usize| elements.cells[e] % 30;
        let crack = |e: usize| row(e) < 5 && column(e) == 14;
        let spot = |e: usize| row(e) > 9 && column(e) > 20;
        let n = elements.cells.len();
        let direct = |e: usize| if crack(e) || spot(e) { soft } else { whole };
        let want =
            System::new(&elements, &direct, &holds, &f, 1 << 30).expect("held").solve().expect("solved");
        let longest = want.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // With room for all that fronts hand on, and with just enough for the factor.
        let least =
            (10..).map(|k| 1u64 << k).find(|b| System::new(&elements, &|_| whole, &holds, &f, *b).is_ok());
        for bytes in [1 << 30, least.expect("some size is enough")] {
            let mut system = System::new(&elements, &|_| whole, &holds, &f, bytes).expect("held");
            let intact = system.solve().expect("solved");
            (0..n).filter(|e| crack(*e)).for_each(|e| system.change(e, &soft));
            assert_ne!(system.solve().expect("solved"), intact);
            (0..n).filter(|e| spot(*e)).for_each(|e| system.change(e, &soft));
            let x = system.solve().expect("solved");
            assert!(x.iter().zip(&want).all(|(a, b)| (a - b).abs() < 1e-9 * longest), "{bytes}");
            (0..n).for_each(|e| system.change(e, &whole));
            let x = system.solve().expect("solved");
            assert!(x.iter().zip(&intact).all(|(a, b)| a == b), "{bytes}: the same bytes");
        }
    }
}
