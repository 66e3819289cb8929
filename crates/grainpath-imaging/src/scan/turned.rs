//! Rotates a scan about its axes before it is cut into layers.
//!
//! # Method
//! The voxels of the rotated scan fill the box around the rotated stack. Each takes the grey value at its
//! position in the stored scan, interpolated linearly from the eight voxels around it. Rotations by
//! quarter turns map voxels onto voxels and change no value. Up to half a voxel beyond the outermost
//! centres the outermost value is used; farther out voxels have no value of their own, nor where the nearest stored voxel has
//! none. These get the least value, which is air.
//!
//! Slices come in blocks of bounded memory. For each block the stored slices are read once, two at a
//! time. Along each row of the block the slope of the row gives the voxels between the two slices, so
//! each voxel is visited once.
//!
//! # Limits
//! Slices at uneven distances are refused. The rotated voxels are cubes with the least stored distance as
//! their side, except that quarter turns keep the stored distances. Linear interpolation at a fraction
//! `f` blurs with the variance `f (1 - f)` along each axis, at most a quarter of a square voxel.

use grainpath_core::math::sin_cos;
use grainpath_core::slices::{SliceCursor, SliceError, SliceSource, VolumeInfo};
use grainpath_core::{DMat3, DVec3};

use super::ScanError;
use super::survey::Lattice;

/// Bytes of rotated slices that are made at a time. Larger blocks mean fewer passes over the file.
/// Source: chosen; a quarter of the 1 GiB that a worker has.
const BLOCK_BYTES: usize = 256 << 20;

/// A scan rotated about its centre. Its slices have even distances, and it has no world frame.
pub(super) struct Turned<S> {
    stored: S,
    lattice: Lattice,
    info: VolumeInfo,
    /// Position of the first rotated voxel among the stored ones, in stored voxels.
    first: DVec3,
    step: [DVec3; 3],
    block: Vec<f32>,
    block_start: usize,
    cursor: SliceCursor,
    /// The least grey value of the stored slices read so far.
    air: f32,
}

/// The rotation about x, then y, then z, by these angles. Quarter turns are exact.
pub(super) fn rotation(rotate_rad: [f64; 3]) -> DMat3 {
    let about = |axis: DVec3, angle_rad: f64| {
        let (s, c) = sin_cos(angle_rad);
        // A sine that differs from 0 or 1 by less than its rounding means a quarter turn.
        let clean = |v: f64| if (v - v.round()).abs() < 1e-12 { v.round() } else { v };
        let (s, c) = (clean(s), clean(c));
        // Rodrigues' formula for a unit axis.
        let turned = |v: DVec3| v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0 - c));
        DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
    };
    about(DVec3::Z, rotate_rad[2]) * about(DVec3::Y, rotate_rad[1]) * about(DVec3::X, rotate_rad[0])
}

impl<S: SliceSource> Turned<S> {
    /// Rotates the cropped and mirrored voxels of a job about x, then y, then z.
    ///
    /// # Errors
    /// [`ScanError`] for slices at uneven distances, and turned slices of too many pixels.
    pub(super) fn new(stored: S, lattice: Lattice, rotate_rad: [f64; 3]) -> Result<Self, ScanError> {
        let rotation = rotation(rotate_rad);
        let spacing_mm = lattice.spacing_mm;
        let stored_size = lattice.size();
        let even = |pair: &[f64]| ((pair[1] - pair[0]).abs() / spacing_mm[2] - 1.0).abs() < 1e-3;
        // Slices at uneven distances would have to be resampled twice.
        if !lattice.z_mm.windows(2).all(even) {
            return Err(ScanError::UnevenSlices);
        }
        let spacing = DVec3::from(spacing_mm);
        let half_mm = 0.5 * DVec3::from(stored_size.map(|n| n as f64)) * spacing;
        let columns = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
        let quarter = columns.iter().all(|c| c.abs().max_element() == 1.0);
        let turned_spacing = if quarter {
            columns.iter().zip(spacing_mm).map(|(c, mm)| c.abs() * mm).sum()
        } else {
            // Cubes with the smallest stored distance lose no detail in any direction.
            DVec3::splat(spacing.min_element())
        };
        // Half the size of the upright box around the rotated one: the extents of its three rotated half axes, added.
        let reach_mm: DVec3 = columns.iter().zip(half_mm.to_array()).map(|(c, half)| c.abs() * half).sum();
        // The small constant keeps rounding from adding an empty row to quarter turns.
        let size = (2.0 * reach_mm / turned_spacing - 1e-9).ceil().max(DVec3::ONE);
        let to_stored = rotation.transpose();
        let n = size.to_array();
        // Both boxes have the same centre. Voxel centres lie half a voxel inside their boxes.
        let first_mm = -0.5 * (size - DVec3::ONE) * turned_spacing;
        let middle = 0.5 * (half_mm * 2.0 / spacing - DVec3::ONE);
        let mut first = to_stored * first_mm / spacing + middle;
        let mut step =
            [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_stored * (axis * turned_spacing) / spacing);
        // Mirroring in z is part of the map, so slices are read in the order of the file.
        if lattice.flip[2] {
            first.z = (stored_size[2] - 1) as f64 - first.z;
            step.iter_mut().for_each(|s| s.z = -s.z);
        }
        if n[0] * n[1] > MAX_PIXELS {
            return Err(ScanError::TooManyPixels { columns: n[0], rows: n[1], limit: MAX_PIXELS });
        }
        let mut info =
            VolumeInfo::new(stored.info().format, n.map(|count| count as usize), stored.info().sample);
        info.spacing_mm = turned_spacing.to_array().map(Some);
        info.padded = stored.info().padded;
        let cursor = SliceCursor::new(info.size[2]);
        Ok(Self {
            stored,
            lattice,
            info,
            first,
            step,
            block: Vec::new(),
            block_start: 0,
            cursor,
            air: f32::INFINITY,
        })
    }

    fn area(&self) -> usize {
        self.info.size[0] * self.info.size[1]
    }

    /// Makes the slices from `next` on, as many as a block holds.
    fn make_block(&mut self, next: usize) -> Result<(), SliceError> {
        let [columns, rows, n_slices] = self.info.size;
        let n_block = (BLOCK_BYTES / (4 * self.area())).clamp(1, n_slices - next);
        self.block_start = next;
        self.block.clear();
        // NaN marks voxels that no stored slice has reached; they become air when a slice is handed out.
        self.block.resize(n_block * self.area(), f32::NAN);
        let [_, _, n_stored] = self.lattice.size();
        // The stored slices that lie between the corners of the block.
        let height = |x: usize, y: usize, z: usize| {
            (self.first + self.step[0] * x as f64 + self.step[1] * y as f64 + self.step[2] * z as f64).z
        };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in [0, columns - 1] {
            for y in [0, rows - 1] {
                for z in [self.block_start, self.block_start + n_block - 1] {
                    (low, high) = (low.min(height(x, y, z)), high.max(height(x, y, z)));
                }
            }
        }
        let last = n_stored - 1;
        let k0 = low.floor().clamp(0.0, last as f64) as usize;
        let k1 = (high.ceil().clamp(0.0, last as f64) as usize).max(k0);
        self.stored.restart()?;
        for _ in 0..self.lattice.first + k0 {
            self.stored.skip_slice()?;
        }
        let mut lower = self.read()?;
        if k0 == k1 {
            self.mix(&lower, &lower, k0);
        }
        for k in k0..k1 {
            let upper = self.read()?;
            self.mix(&lower, &upper, k);
            lower = upper;
        }
        Ok(())
    }

    fn read(&mut self) -> Result<Vec<f32>, SliceError> {
        let mut slice = Vec::new();
        self.stored.next_known(&mut slice)?;
        let slice = self.lattice.cropped(slice);
        self.air = slice.iter().copied().fold(self.air, f32::min);
        Ok(slice)
    }

    /// Fills the voxels of the block that lie between the stored slices `k` and `k + 1`.
    fn mix(&mut self, lower: &[f32], upper: &[f32], k: usize) {
        let [nx, ny, nz] = self.lattice.size();
        let [columns, rows, _] = self.info.size;
        let (area, air) = (self.area(), self.air);
        // A voxel is a volume, so the outermost slices reach half a voxel farther.
        let bottom = if k == 0 { -0.5 - EDGE } else { k as f64 };
        let top = if k + 2 >= nz { nz as f64 - 0.5 + EDGE } else { (k + 1) as f64 };
        for n in 0..self.block.len() / columns {
            let (z, y) = (self.block_start + n * columns / area, n % rows);
            let start = self.first + self.step[1] * y as f64 + self.step[2] * z as f64;
            let step = self.step[0];
            // Along a row z changes linearly, so the columns between both slices form one range.
            let range = if step.z == 0.0 {
                if (bottom..top).contains(&start.z) { 0..columns } else { 0..0 }
            } else {
                let (a, b) = ((bottom - start.z) / step.z, (top - start.z) / step.z);
                // One voxel more on each side; the exact test follows below.
                let bound = |v: f64| v.clamp(0.0, columns as f64) as usize;
                bound(a.min(b).floor() - 1.0)..bound(a.max(b).ceil() + 2.0)
            };
            let out = &mut self.block[n * columns..(n + 1) * columns];
            for x in range {
                let p = start + step * x as f64;
                let beyond = |v: f64, n: usize| v < -0.5 - EDGE || v > n as f64 - 0.5 + EDGE;
                if !(bottom..top).contains(&p.z) || beyond(p.x, nx) || beyond(p.y, ny) {
                    continue;
                }
                let inside = |v: f64, n: usize| v.clamp(0.0, (n - 1) as f64);
                let (px, py) = (inside(p.x, nx), inside(p.y, ny));
                let (i, j) = (px as usize, py as usize);
                let (i1, j1) = ((i + 1).min(nx - 1), (j + 1).min(ny - 1));
                let (u, v) = ((px - i as f64) as f32, (py - j as f64) as f32);
                let w = (p.z - k as f64).clamp(0.0, 1.0) as f32;
                let nearest = if w < 0.5 { lower } else { upper };
                let (column, row) = (if u < 0.5 { i } else { i1 }, if v < 0.5 { j } else { j1 });
                if nearest[row * nx + column].is_nan() {
                    continue;
                }
                let known = |v: f32| if v.is_nan() { air } else { v };
                let plane = |s: &[f32]| {
                    let (from, to) =
                        (|row: usize| known(s[row * nx + i]), |row: usize| known(s[row * nx + i1]));
                    let along = |row: usize| from(row) + u * (to(row) - from(row));
                    let (a, b) = (along(j), along(j1));
                    a + v * (b - a)
                };
                let (a, b) = (plane(lower), plane(upper));
                out[x] = a + w * (b - a);
            }
        }
    }
}

/// Limit on the pixels of a rotated slice. Source: derived. 256 MiB as `f32`, as for stored slices.
const MAX_PIXELS: f64 = (1u64 << 26) as f64;
/// Rounding accepted at the faces of the stored stack, in voxels. Source: derived. With 0 a voxel on a face could be taken
/// for one outside; positions of 1e5 voxels round by 1e-11.
const EDGE: f64 = 1e-9;

impl<S: SliceSource> SliceSource for Turned<S> {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.cursor.restart();
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        let more = self.next_known(out)?;
        let air = if self.air.is_finite() { self.air } else { 0.0 };
        out.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = air);
        Ok(more)
    }

    fn next_known(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let Some(k) = self.cursor.slice() else { return Ok(false) };
        let area = self.area();
        let held = self.block_start..self.block_start + self.block.len() / area;
        if !held.contains(&k) {
            self.make_block(k)?;
        }
        let start = (k - self.block_start) * area;
        out.extend_from_slice(&self.block[start..start + area]);
        Ok(self.cursor.pass())
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        Ok(self.cursor.pass())
    }

    fn n_not_finite(&self) -> u64 {
        self.stored.n_not_finite()
    }

    fn n_absent(&self) -> u64 {
        self.stored.n_absent()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use grainpath_core::slices::SampleType;

    use super::*;

    /// A stack whose grey values are linear in the place: mixing keeps them.
    struct Ramp {
        info: VolumeInfo,
        next: usize,
    }

    const SPACING_MM: [f64; 3] = [0.5, 0.4, 0.8];

    fn grey(p: DVec3) -> f64 {
        100.0 + p.dot(DVec3::new(3.0, 5.0, 7.0))
    }

    impl SliceSource for Ramp {
        fn info(&self) -> &VolumeInfo {
            &self.info
        }
        fn restart(&mut self) -> Result<(), SliceError> {
            self.next = 0;
            Ok(())
        }
        fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
            let [nx, ny, _] = self.info.size;
            out.clear();
            let spacing = DVec3::from(SPACING_MM);
            let at = |n: usize| DVec3::new((n % nx) as f64, (n / nx) as f64, self.next as f64) * spacing;
            out.extend((0..nx * ny).map(|n| grey(at(n)) as f32));
            self.skip_slice()
        }
        fn skip_slice(&mut self) -> Result<bool, SliceError> {
            let more = self.next < self.info.size[2];
            self.next += usize::from(more);
            Ok(more)
        }
    }

    fn turned(rotate_deg: [f64; 3]) -> (VolumeInfo, Vec<Vec<f32>>) {
        let mut ramp = Ramp { info: VolumeInfo::new("ramp", [9, 8, 7], SampleType::F32), next: 0 };
        let rotate_rad = rotate_deg.map(|d| d * PI / 180.0);
        ramp.info.spacing_mm = SPACING_MM.map(Some);
        let lattice = Lattice::new(&ramp.info, &super::super::tests::settings()).expect("a lattice");
        let mut source = Turned::new(&mut ramp, lattice, rotate_rad).expect("a turned stack");
        let (mut slice, mut all) = (Vec::new(), Vec::new());
        while source.next_slice(&mut slice).expect("slices") {
            all.push(slice.clone());
        }
        (source.info.clone(), all)
    }

    #[test]
    fn quarter_turns_keep_every_voxel() {
        let (info, slices) = turned([90.0, 0.0, 0.0]);
        assert_eq!(info.size, [9, 7, 8]);
        assert_eq!(info.spacing_mm, [Some(0.5), Some(0.8), Some(0.4)]);
        // About x by a quarter, y becomes z and z becomes -y.
        let stored = DVec3::new(2.0 * 0.5, 3.0 * 0.4, 1.0 * 0.8);
        assert_eq!(slices[3][(7 - 1 - 1) * 9 + 2], grey(stored) as f32);
        let (info, slices) = turned([0.0, 0.0, 180.0]);
        assert_eq!(info.size, [9, 8, 7]);
        assert_eq!(slices[4][9 + 2], grey(DVec3::new(6.0 * 0.5, 6.0 * 0.4, 4.0 * 0.8)) as f32);
    }

    #[test]
    fn other_turns_follow_the_stored_values() {
        for rotate_deg in [[30.0, 0.0, 0.0], [0.0, 0.0, 45.0], [20.0, -35.0, 50.0]] {
            let (info, slices) = turned(rotate_deg);
            let turn = rotation(rotate_deg.map(f64::to_radians));
            let spacing = info.spacing_mm.map(|mm| mm.expect("a spacing"));
            let middle = |size: [usize; 3], mm: [f64; 3]| {
                DVec3::from([0, 1, 2].map(|a| 0.5 * (size[a] - 1) as f64 * mm[a]))
            };
            let (from, to) = (middle([9, 8, 7], SPACING_MM), middle(info.size, spacing));
            let mut n_inside = 0;
            for (z, slice) in slices.iter().enumerate() {
                for (n, found) in slice.iter().enumerate() {
                    let at = DVec3::new((n % info.size[0]) as f64, (n / info.size[0]) as f64, z as f64);
                    let stored = turn.transpose() * (at * DVec3::from(spacing) - to) + from;
                    if stored.min_element() >= 0.0 && (stored - 2.0 * from).max_element() <= 0.0 {
                        n_inside += 1;
                        assert!(
                            (f64::from(*found) - grey(stored)).abs() < 1e-3,
                            "{rotate_deg:?} {at}: {found}"
                        );
                    }
                }
            }
            let volume = 8.0 * 0.5 * 7.0 * 0.4 * 6.0 * 0.8 / (0.4f64 * 0.4 * 0.4);
            assert!((n_inside as f64 / volume - 1.0).abs() < 0.2, "{rotate_deg:?}: {n_inside} of {volume}");
        }
    }
}
