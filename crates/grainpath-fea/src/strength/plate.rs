//! A grid of square elements under plane stress: assembled, factored, solved again as stiffness is lost.

use grainpath_core::DVec2;

use super::cells::Grid;
use crate::plane::PlaneStiffness;
use crate::sparse::{Cholesky, SparseError, Symmetric};

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

    /// Nodes in an order that keeps the factor small: halves first, the line between them last.
    fn dissection(&self) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.places.len());
        let mut all: Vec<usize> = (0..self.places.len()).collect();
        self.dissect(&mut all, &mut order);
        order
    }

    fn dissect(&self, nodes: &mut [usize], order: &mut Vec<usize>) {
        if nodes.len() <= 24 {
            order.extend_from_slice(nodes);
            return;
        }
        let place = |i: usize, k: usize| self.places[i][k];
        let span = |k: usize| {
            let values = nodes.iter().map(|&i| place(i, k));
            values.fold((u32::MAX, 0), |(a, b), v| (a.min(v), b.max(v)))
        };
        let spans = [span(0), span(1)];
        let axis = usize::from(spans[1].1 - spans[1].0 > spans[0].1 - spans[0].0);
        if spans[axis].0 == spans[axis].1 {
            order.extend_from_slice(nodes);
            return;
        }
        // The line at the median node: halves even in number.
        let mut values: Vec<u32> = nodes.iter().map(|&i| place(i, axis)).collect();
        let half = values.len() / 2;
        let cut = *values.select_nth_unstable(half).1;
        let cut = cut.clamp(spans[axis].0 + 1, spans[axis].1.max(spans[axis].0 + 1));
        let side = |i: usize| match place(i, axis).cmp(&cut) {
            std::cmp::Ordering::Less => 0,
            std::cmp::Ordering::Greater => 1,
            std::cmp::Ordering::Equal => 2,
        };
        nodes.sort_by_key(|&i| (side(i), i));
        let first = nodes.partition_point(|&i| side(i) < 1);
        let second = nodes.partition_point(|&i| side(i) < 2);
        let (left, rest) = nodes.split_at_mut(first);
        let (right, line) = rest.split_at_mut(second - first);
        self.dissect(left, order);
        self.dissect(right, order);
        order.extend_from_slice(line);
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
            let (i, j) = (cell % grid.nx, cell / grid.nx);
            let sides = [
                (i > 0).then(|| cell - 1),
                (i + 1 < grid.nx).then_some(cell + 1),
                (j > 0).then(|| cell - grid.nx),
                (j + 1 < grid.ny).then_some(cell + grid.nx),
            ];
            for next in sides.into_iter().flatten() {
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

/// The matrix of a plate and how to solve it.
pub struct System {
    matrix: Symmetric,
    factor: Cholesky,
    /// Where each entry of an element goes, `(n_elements, 36)`: the lower half by columns.
    scatter: Vec<u32>,
    stiffness: Vec<[f64; 36]>,
    /// What holds and the least stiffness add.
    added: Vec<(usize, f64)>,
    fresh: bool,
    /// Solutions since the last factorisation and the iterations they took.
    since: [usize; 2],
    /// Factorisations so far.
    pub factored: usize,
    /// Solutions so far.
    pub solved: usize,
}

fn lower(k: &[[f64; 8]; 8]) -> [f64; 36] {
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
    /// Assembles and factors.
    ///
    /// # Errors
    /// [`SparseError`] when the factor would take more than `max_bytes` or the plate is not held.
    pub fn new(
        elements: &Elements,
        stiffness: &dyn Fn(usize) -> [[f64; 8]; 8],
        holds: &[GridHold],
        max_bytes: u64,
    ) -> Result<Self, SparseError> {
        let n = 2 * elements.places.len();
        let mut pairs: Vec<u64> = Vec::with_capacity(10 * elements.corners.len());
        for e in &elements.corners {
            for (a, &i) in e.iter().enumerate() {
                pairs.extend(e[..=a].iter().map(|&j| (u64::from(i.min(j)) << 32) | u64::from(i.max(j))));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut matrix = Symmetric { starts: vec![0], ..Symmetric::default() };
        for column in pairs.chunk_by(|a, b| a >> 32 == b >> 32) {
            let j = (column[0] >> 32) as usize;
            for c in 0..2 {
                for pair in column {
                    let i = (pair & 0xffff_ffff) as usize;
                    matrix.rows.extend([2 * i, 2 * i + 1].into_iter().filter(|r| *r >= 2 * j + c));
                }
                matrix.starts.push(matrix.rows.len());
            }
        }
        matrix.values = vec![0.0; matrix.rows.len()];
        let place = |row: usize, column: usize| {
            let (r, c) = (row.max(column), row.min(column));
            let range = matrix.starts[c]..matrix.starts[c + 1];
            range.start + matrix.rows[range].binary_search(&r).unwrap_or(0)
        };
        let mut scatter = Vec::with_capacity(36 * elements.corners.len());
        for e in &elements.corners {
            let dof = |a: usize| 2 * e[a / 2] as usize + a % 2;
            for j in 0..8 {
                scatter.extend((j..8).map(|i| place(dof(i), dof(j)) as u32));
            }
        }
        let stiffness: Vec<[f64; 36]> = (0..elements.corners.len()).map(|e| lower(&stiffness(e))).collect();
        let stiffest = stiffness.iter().map(|k| k[0].max(k[8])).fold(0.0, f64::max);
        let mut added: Vec<(usize, f64)> = (0..n).map(|i| (matrix.starts[i], LEAST * stiffest)).collect();
        for hold in holds {
            let i = 2 * hold.node as usize;
            let (x, y) = (hold.along.x, hold.along.y);
            for (r, c, share) in [(i, i, x * x), (i + 1, i, x * y), (i + 1, i + 1, y * y)] {
                if share != 0.0 {
                    added.push((place(r, c), HOLD * stiffest * share));
                }
            }
        }
        let order: Vec<usize> = elements.dissection().into_iter().flat_map(|i| [2 * i, 2 * i + 1]).collect();
        fill_matrix(&mut matrix, &scatter, &stiffness, &added);
        let factor = Cholesky::new(&matrix, Some(&order), max_bytes)?;
        Ok(Self {
            matrix,
            factor,
            scatter,
            stiffness,
            added,
            fresh: true,
            since: [0; 2],
            factored: 1,
            solved: 0,
        })
    }

    /// Unknowns.
    pub fn dofs(&self) -> usize {
        self.matrix.n()
    }

    /// Gives an element another stiffness.
    pub fn change(&mut self, element: usize, stiffness: &[[f64; 8]; 8]) {
        self.stiffness[element] = lower(stiffness);
        self.fresh = false;
    }

    /// Displacements under forces, N; `x` is where it begins, the last solution being best.
    ///
    /// # Errors
    /// [`SparseError`] when too little stiffness is left.
    pub fn solve(&mut self, forces: &[f64], x: &mut [f64]) -> Result<(), SparseError> {
        self.solved += 1;
        if self.fresh {
            x.copy_from_slice(forces);
            self.factor.solve(x);
            return Ok(());
        }
        fill_matrix(&mut self.matrix, &self.scatter, &self.stiffness, &self.added);
        let made = (FACTOR * (self.matrix.n() as f64).sqrt()) as usize;
        let taken = self.iterate(forces, x, made.max(LEAST_ITERATIONS));
        let iterations = taken.unwrap_or(0);
        self.since = [self.since[0] + 1, self.since[1] + iterations];
        // A factor has had its time when a solution takes longer than the mean so far, its own making counted.
        let worn = iterations * self.since[0] > made + self.since[1];
        if taken.is_some() && !worn {
            return Ok(());
        }
        self.factor.refactor(&self.matrix)?;
        self.factored += 1;
        self.since = [0; 2];
        if taken.is_none() {
            x.copy_from_slice(forces);
            self.factor.solve(x);
            self.iterate(forces, x, 2);
        }
        Ok(())
    }

    /// Conjugate gradients with the last factor; how many iterations they took where they came to an end.
    fn iterate(&self, b: &[f64], x: &mut [f64], most: usize) -> Option<usize> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let ax = self.matrix.times(x);
        let mut r: Vec<f64> = b.iter().zip(&ax).map(|(b, a)| b - a).collect();
        let mut z = r.clone();
        self.factor.solve(&mut z);
        let mut p = z.clone();
        let mut rz = dot(&r, &z);
        // In energy, measured against that of the solution.
        let whole = dot(b, x).abs().max(f64::MIN_POSITIVE);
        for k in 0..most {
            if !rz.is_finite() {
                return None;
            }
            if rz <= TOLERANCE * TOLERANCE * whole {
                return Some(k);
            }
            let ap = self.matrix.times(&p);
            let alpha = rz / dot(&p, &ap);
            for i in 0..x.len() {
                x[i] += alpha * p[i];
                r[i] -= alpha * ap[i];
            }
            z.copy_from_slice(&r);
            self.factor.solve(&mut z);
            let next = dot(&r, &z);
            let beta = next / rz;
            rz = next;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + beta * *p);
        }
        (rz <= TOLERANCE * TOLERANCE * whole).then_some(most)
    }
}

/// Error in energy at which iterating ends.
const TOLERANCE: f64 = 1e-4;
/// At least so many iterations are tried before a new factor is made.
const LEAST_ITERATIONS: usize = 14;
/// A new factor costs as much as this many iterations for each square root of the unknowns.
const FACTOR: f64 = 0.04;

fn fill_matrix(matrix: &mut Symmetric, scatter: &[u32], stiffness: &[[f64; 36]], added: &[(usize, f64)]) {
    matrix.values.fill(0.0);
    for (k, to) in stiffness.iter().zip(scatter.chunks_exact(36)) {
        k.iter().zip(to).for_each(|(k, &at)| matrix.values[at as usize] += k);
    }
    added.iter().for_each(|&(at, k)| matrix.values[at] += k);
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
        let mut system = System::new(&elements, &|_| square(&c), &holds, 1 << 30).expect("held");
        let mut f = vec![0.0; system.dofs()];
        for i in all.filter(|i| elements.places[*i as usize][0] == n as u32) {
            f[2 * i as usize] = if elements.places[i as usize][1] == 0 { 1.0 } else { -1.0 };
        }
        let mut x = vec![0.0; f.len()];
        system.solve(&f, &mut x).expect("solved");
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
        let broken = |e: usize| (elements.cells[e] / 30) < 5 && elements.cells[e] % 30 == 14;
        let mut x = vec![0.0; f.len()];
        let mut system = System::new(&elements, &|_| whole, &holds, 1 << 30).expect("held");
        system.solve(&f, &mut x).expect("solved");
        (0..elements.cells.len()).filter(|e| broken(*e)).for_each(|e| system.change(e, &soft));
        system.solve(&f, &mut x).expect("solved");
        let direct = |e: usize| if broken(e) { soft } else { whole };
        let mut y = vec![0.0; f.len()];
        System::new(&elements, &direct, &holds, 1 << 30).expect("held").solve(&f, &mut y).expect("solved");
        let longest = y.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(x.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-3 * longest));
    }
}
