//! Directions in the cells of a regular grid.

use grainpath_core::{DVec2, DVec3};

use super::model::BlendedDirection;

/// Strength of cells without a direction: their filled-in direction decides only where no other cell counts. Source:
/// derived: far below the smallest strength that eight bits of alpha can state, 1/255, and far above the rounding of the
/// sums.
const FILLED_STRENGTH: f32 = 1e-6;

/// A grid of directions; cells are numbered from the lower left one, row by row.
#[derive(Debug, Clone)]
pub(super) struct DirectionGrid {
    pub columns: usize,
    pub rows: usize,
    /// Cosine and sine of the doubled angle.
    double: Vec<[f32; 2]>,
    /// From 0 to 1; [`FILLED_STRENGTH`] where the cell had no direction.
    strength: Vec<f32>,
    spacing_mm: Option<Vec<f32>>,
    /// Lower left corner of the first cell and the size of a cell, mm, once known.
    pub place: Option<(DVec2, DVec2)>,
}

/// A cell as read: the vector of the doubled angle, of any length, and the strength; `None` without
/// a direction.
pub(super) type GridCell = Option<(DVec2, f64)>;

impl DirectionGrid {
    /// A grid of `columns` x `rows` cells, at least one of which has a direction. `cell` gives a
    /// cell by column and row from the lower left.
    pub(super) fn new(columns: usize, rows: usize, cell: impl Fn(usize, usize) -> GridCell) -> Self {
        let n = columns * rows;
        let (mut double, mut strength) = (vec![[0.0; 2]; n], vec![0.0f32; n]);
        for row in 0..rows {
            for column in 0..columns {
                if let Some((q, s)) = cell(column, row) {
                    let q = q.normalize_or_zero();
                    double[row * columns + column] = [q.x as f32, q.y as f32];
                    strength[row * columns + column] = s as f32;
                }
            }
        }
        if strength.contains(&0.0) {
            fill(columns, rows, &mut double, &strength);
            strength.iter_mut().for_each(|s| *s = s.max(FILLED_STRENGTH));
        }
        Self { columns, rows, double, strength, spacing_mm: None, place: None }
    }

    /// Adds distances of beads, mm, a number for each cell.
    pub(super) fn with_spacing(self, spacing_mm: Vec<f32>) -> Self {
        Self { spacing_mm: Some(spacing_mm), ..self }
    }

    /// Lowest and highest corner, mm.
    pub(super) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let (corner, cell) = self.place?;
        let size = cell * DVec2::new(self.columns as f64, self.rows as f64);
        Some((corner.extend(0.0), (corner + size).extend(0.0)))
    }

    /// The direction at a point, bilinear between the centres of cells.
    pub(super) fn sample(&self, p: DVec3) -> BlendedDirection {
        let (corner, cell) = self.place.unwrap_or((DVec2::ZERO, DVec2::ONE));
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        let at = ((p.truncate() - corner) / cell - 0.5).clamp(DVec2::ZERO, last);
        let low = at.floor();
        let share = at - low;
        let column = [low.x as usize, (low.x as usize + 1).min(self.columns - 1)];
        let row = [low.y as usize, (low.y as usize + 1).min(self.rows - 1)];
        let (mut double, mut strength, mut spacing) = (DVec2::ZERO, 0.0, 0.0);
        for (i, wx) in [1.0 - share.x, share.x].into_iter().enumerate() {
            for (j, wy) in [1.0 - share.y, share.y].into_iter().enumerate() {
                let k = row[j] * self.columns + column[i];
                let s = wx * wy * f64::from(self.strength[k]);
                double += s * DVec2::new(f64::from(self.double[k][0]), f64::from(self.double[k][1]));
                strength += s;
                spacing += wx * wy * self.spacing_mm.as_ref().map_or(0.0, |all| f64::from(all[k]));
            }
        }
        // The trace of the tensor is the strength; the doubled angle gives the deviatoric rest.
        let half = 0.5 * double;
        BlendedDirection {
            tensor: [0.5 * strength + half.x, 0.5 * strength - half.x, 0.0, half.y, 0.0, 0.0],
            spacing_mm: self.spacing_mm.is_some().then_some(spacing),
        }
    }
}

/// A level of the pyramid. Each cell holds the weighted sum of the doubled angle (two numbers) and the weight, at most
/// 1.
struct Level {
    columns: usize,
    rows: usize,
    cells: Vec<[f32; 3]>,
}

impl Level {
    /// The level of half the size. Each of its cells combines four cells of this level.
    fn halved(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let mut cells = vec![[0.0f32; 3]; columns * rows];
        for row in 0..self.rows {
            for column in 0..self.columns {
                let from = self.cells[row * self.columns + column];
                let to = &mut cells[row / 2 * columns + column / 2];
                (0..3).for_each(|k| to[k] += from[k]);
            }
        }
        for cell in &mut cells {
            let scale = 1.0 / cell[2].max(1.0);
            cell.iter_mut().for_each(|v| *v *= scale);
        }
        Self { columns, rows, cells }
    }

    /// Fills up every cell with values interpolated bilinearly from the level of half the size.
    fn complete(&mut self, coarse: &Self) {
        let corner = |i: usize, n: usize| {
            let at = (0.5 * i as f32 - 0.25).clamp(0.0, (n - 1) as f32);
            (at as usize, (at as usize + 1).min(n - 1), at.fract())
        };
        for row in 0..self.rows {
            let (r0, r1, ty) = corner(row, coarse.rows);
            for column in 0..self.columns {
                let cell = &mut self.cells[row * self.columns + column];
                let open = 1.0 - cell[2];
                if open <= 0.0 {
                    continue;
                }
                let (c0, c1, tx) = corner(column, coarse.columns);
                for k in 0..3 {
                    let value = |r: usize, c: usize| coarse.cells[r * coarse.columns + c][k];
                    let low = value(r0, c0) * (1.0 - tx) + value(r0, c1) * tx;
                    let high = value(r1, c0) * (1.0 - tx) + value(r1, c1) * tx;
                    cell[k] += open * (low * (1.0 - ty) + high * ty);
                }
            }
        }
    }
}

/// Gives cells without a direction that of the cells around, by push-pull (`Gortler1996`).
fn fill(columns: usize, rows: usize, double: &mut [[f32; 2]], strength: &[f32]) {
    let known = |(q, s): (&[f32; 2], &f32)| if *s > 0.0 { [q[0], q[1], 1.0] } else { [0.0; 3] };
    let first = Level { columns, rows, cells: double.iter().zip(strength).map(known).collect() };
    let mut levels = vec![first];
    while let Some(last) = levels.last().filter(|l| l.columns * l.rows > 1) {
        let next = last.halved();
        levels.push(next);
    }
    let mut coarse = levels.pop().unwrap_or(Level { columns: 1, rows: 1, cells: vec![[1.0, 0.0, 1.0]] });
    while let Some(mut level) = levels.pop() {
        level.complete(&coarse);
        coarse = level;
    }
    for ((q, s), cell) in double.iter_mut().zip(strength).zip(&coarse.cells) {
        if *s == 0.0 {
            let length = (cell[0] * cell[0] + cell[1] * cell[1]).sqrt();
            *q = if length > 0.0 { [cell[0] / length, cell[1] / length] } else { [1.0, 0.0] };
        }
    }
}
