//! Slices moved upright ([`Upright`]), and slices with exchanged or reversed axes ([`Reordered`]). Both
//! work while the volume is read.

use grainpath_core::slices::{SliceError, SliceSource, VolumeInfo};

/// A stored axis that serves as an axis of the slices, and whether it runs backwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct StoredAxis {
    pub axis: usize,
    pub reversed: bool,
}

/// Shift of slices and of rows within their plane, in columns and rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shear {
    /// Shift of each row against the one before, columns.
    pub columns_per_row: f64,
    /// Columns and rows that each slice is moved by.
    pub slice_shift_px: Vec<[f64; 2]>,
    /// Position of the first column and row of the upright slices, in columns and rows of the first
    /// stored slice.
    pub first_px: [f64; 2],
    /// The same in mm along the upright axes.
    pub first_mm: [f64; 2],
    /// Columns, rows, slices of the upright volume.
    pub size: [usize; 3],
    /// The lean of the slices against their normal, degrees.
    pub lean_deg: f64,
    /// The lean of the columns within a slice, degrees.
    pub row_lean_deg: f64,
}

/// Marks voxels outside the stored slice, which has no value for them. All that is not finite within it is NaN.
pub(super) const OUTSIDE: f32 = f32::NEG_INFINITY;

/// Slices that are moved within their plane, with rows that are moved within the slice. Values between
/// pixels are interpolated linearly, where those that are not finite count as the lowest of the slice, which is air. A voxel
/// is NaN if the stored pixel nearest to it is not finite, and [`OUTSIDE`] beyond the stored slice.
pub(super) struct Upright {
    inner: Box<dyn SliceSource>,
    info: VolumeInfo,
    shear: Shear,
    stored: Vec<f32>,
    next: usize,
}

impl Upright {
    pub(super) fn new(inner: Box<dyn SliceSource>, info: VolumeInfo, shear: Shear) -> Self {
        Self { inner, info, shear, stored: Vec::new(), next: 0 }
    }

    /// Computes the upright slice `k` from `self.stored`.
    fn moved(&self, k: usize, out: &mut Vec<f32>) {
        let [nx, ny, _] = self.inner.info().size;
        let [columns, rows, _] = self.info.size;
        let air = self.stored.iter().copied().filter(|v| v.is_finite()).fold(f32::INFINITY, f32::min);
        let shift = self.shear.slice_shift_px[k];
        out.clear();
        out.reserve(columns * rows);
        for row in 0..rows {
            let y = row as f64 + self.shear.first_px[1] - shift[1];
            // The shift of a row is proportional to its number in the stored slice, so it depends on y and not on `row`.
            let x0 = self.shear.first_px[0] - shift[0] - self.shear.columns_per_row * y;
            // A pixel is an area, so positions up to one pixel outside the border take the value of the border.
            if y <= -1.0 || y >= ny as f64 {
                out.extend(std::iter::repeat_n(OUTSIDE, columns));
                continue;
            }
            let y = y.clamp(0.0, (ny - 1) as f64);
            let (j, v) = (y as usize, (y - y.floor()) as f32);
            let (low, high) = (&self.stored[j * nx..][..nx], &self.stored[(j + 1).min(ny - 1) * nx..][..nx]);
            for column in 0..columns {
                let x = column as f64 + x0;
                if x <= -1.0 || x >= nx as f64 {
                    out.push(OUTSIDE);
                    continue;
                }
                let x = x.clamp(0.0, (nx - 1) as f64);
                let (i, u) = (x as usize, (x - x.floor()) as f32);
                let next = (i + 1).min(nx - 1);
                let (nearest_row, nearest) =
                    (if v < 0.5 { low } else { high }, if u < 0.5 { i } else { next });
                let finite = |v: f32| if v.is_finite() { v } else { air };
                let along = |row: &[f32]| finite(row[i]) + u * (finite(row[next]) - finite(row[i]));
                let (a, b) = (along(low), along(high));
                out.push(if nearest_row[nearest].is_finite() { a + v * (b - a) } else { f32::NAN });
            }
        }
    }
}

impl SliceSource for Upright {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.next = 0;
        self.inner.restart()
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let mut stored = std::mem::take(&mut self.stored);
        let more = self.inner.next_slice(&mut stored);
        self.stored = stored;
        if !more? {
            return Ok(false);
        }
        self.moved(self.next, out);
        self.next += 1;
        Ok(true)
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        let more = self.inner.skip_slice()?;
        self.next += usize::from(more);
        Ok(more)
    }
}

/// Bytes of slices held at a time if the stored slices are not in the order of the height.
/// Source: derived. A volume of 512 x 512 x 512 voxels is then read twice; see [`cost`].
const HELD_BYTES: usize = 256 << 20;

fn slices_held(info: &VolumeInfo) -> usize {
    (HELD_BYTES / (4 * info.size[0] * info.size[1])).clamp(1, info.size[2])
}

/// Describes the cost of slices that are not stored in the order of the height. `None` if the memory suffices for a single
/// pass over the file.
pub(super) fn cost(info: &VolumeInfo, order: [StoredAxis; 3]) -> Option<String> {
    let held = slices_held(info);
    let mib = (4 * info.size[0] * info.size[1] * held).div_ceil(1 << 20);
    let stored = match order[2] {
        StoredAxis { axis: 2, .. } => "from the top down",
        StoredAxis { axis: 1, .. } => "along the depth of the part (the file's rows are its height)",
        _ => "along the width of the part (the file's columns are its height)",
    };
    let passes = info.size[2].div_ceil(held);
    (passes > 1).then(|| {
        format!(
            "slices are stored {stored}; each reading passes over the file {passes} times and holds {mib} MiB"
        )
    })
}

/// Slices whose axes are exchanged or reversed. If the stored slices are in the order of the height, they are turned one by
/// one. Otherwise each pass over the file gathers a block of slices.
pub(super) struct Reordered {
    inner: Box<dyn SliceSource>,
    info: VolumeInfo,
    order: [StoredAxis; 3],
    stored: Vec<f32>,
    /// Consecutive slices that were gathered.
    block: Vec<f32>,
    block_start: usize,
    next: usize,
}

impl Reordered {
    pub(super) fn new(inner: Box<dyn SliceSource>, info: VolumeInfo, order: [StoredAxis; 3]) -> Self {
        Self { inner, info, order, stored: Vec::new(), block: Vec::new(), block_start: 0, next: 0 }
    }

    /// Whether stored slices come in the order of the height.
    fn streams(&self) -> bool {
        self.order[2] == StoredAxis { axis: 2, reversed: false }
    }

    /// Offset of the first value of an axis in a stored volume, and the step to the next value.
    fn walk(&self, axis: usize) -> (usize, isize) {
        let StoredAxis { axis: stored, reversed } = self.order[axis];
        let size = self.inner.info().size;
        let step = [1, size[0], size[0] * size[1]][stored] as isize;
        if reversed { ((size[stored] - 1) * step as usize, -step) } else { (0, step) }
    }

    /// Copies the stored slice `k` to its place among the slices from `self.block_start` on.
    fn scatter(&mut self, k: usize, n_block: usize) {
        let [columns, rows, _] = self.info.size;
        let area = columns * rows;
        let n_stored = self.inner.info().size[2];
        // One of the three axes runs across the stored slices. It is fixed here; the loops run over the other two.
        let walks = [0, 1, 2].map(|axis| self.walk(axis));
        let across = self.order.iter().position(|o| o.axis == 2).unwrap_or(2);
        let place = if self.order[across].reversed { n_stored - 1 - k } else { k };
        let mut ranges = [0..columns, 0..rows, self.block_start..self.block_start + n_block];
        if !ranges[across].contains(&place) {
            return;
        }
        ranges[across] = place..place + 1;
        let index = |axis: usize, i: usize| {
            let (start, step) = walks[axis];
            if axis == across { 0 } else { start as isize + step * i as isize }
        };
        for z in ranges[2].clone() {
            for y in ranges[1].clone() {
                let base = index(2, z) + index(1, y);
                let row = (z - self.block_start) * area + y * columns;
                for x in ranges[0].clone() {
                    self.block[row + x] = self.stored[(base + index(0, x)) as usize];
                }
            }
        }
    }

    /// Reads everything that the slices from `self.next` on need. Returns `false` where the file ends
    /// early.
    fn gather(&mut self) -> Result<bool, SliceError> {
        let n_block = slices_held(&self.info).min(self.info.size[2] - self.next);
        self.block_start = self.next;
        self.block.clear();
        self.block.resize(n_block * self.info.size[0] * self.info.size[1], 0.0);
        let n_stored = self.inner.info().size[2];
        // If the stack is stored upside down, the block is a run of stored slices. If it is stored sideways, every stored
        // slice holds a part of the block.
        let needed = if self.order[2].axis == 2 {
            n_stored - self.block_start - n_block..n_stored - self.block_start
        } else {
            0..n_stored
        };
        self.inner.restart()?;
        for _ in 0..needed.start {
            self.inner.skip_slice()?;
        }
        for k in needed {
            if !self.read()? {
                return Ok(false);
            }
            self.scatter(k, n_block);
        }
        Ok(true)
    }

    fn read(&mut self) -> Result<bool, SliceError> {
        self.inner.next_slice(&mut self.stored)
    }

    fn held(&self) -> std::ops::Range<usize> {
        let area = self.info.size[0] * self.info.size[1];
        self.block_start..self.block_start + self.block.len() / area
    }
}

impl SliceSource for Reordered {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.next = 0;
        // A gathered block stays valid after a restart, which saves a pass over the file.
        if self.streams() { self.inner.restart() } else { Ok(()) }
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        if self.next >= self.info.size[2] {
            return Ok(false);
        }
        // Nothing is exchanged: the slice is passed through without a copy.
        if self.streams() && [0, 1].iter().all(|&a| self.order[a] == StoredAxis { axis: a, reversed: false })
        {
            let more = self.inner.next_slice(out)?;
            self.next += usize::from(more);
            return Ok(more);
        }
        let area = self.info.size[0] * self.info.size[1];
        if self.streams() {
            if !self.read()? {
                return Ok(false);
            }
            self.block.resize(area, 0.0);
            self.block_start = self.next;
            self.scatter(self.next, 1);
        } else if !self.held().contains(&self.next) && !self.gather()? {
            return Ok(false);
        }
        let start = (self.next - self.block_start) * area;
        out.extend_from_slice(&self.block[start..start + area]);
        self.next += 1;
        Ok(true)
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        if self.next >= self.info.size[2] {
            return Ok(false);
        }
        if self.streams() && !self.inner.skip_slice()? {
            return Ok(false);
        }
        self.next += 1;
        Ok(true)
    }
}
