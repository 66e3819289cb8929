//! The surface of a scan at a bounded resolution, to be looked at before the scan is planned.
//!
//! # Method
//! Blocks of voxels become one voxel each with their mean grey value, so that about [`MOST_VOXELS`] remain (more in a scan of few
//! slices). These are cut into layers as thick as a block, by the same steps as the scan itself ([`slice_scan`]); a threshold
//! that is found is found from the merged voxels, and may differ a little from that of the plan. The layers are lofted ([`loft`]). Where the surface has more than [`MOST_TRIANGLES`], layers and cells become larger.
//!
//! # Units, cost and limits
//! mm in the frame of the layers that a plan has: from the lower face of the first voxel taken, with the lowest point at
//! z = 0. The scan is read once. Walls and gaps thinner than a block may be lost, and edges are rounded over about one. The
//! last block of a row, a column or a stack may have fewer voxels and is taken for a whole one, so a part that reaches the
//! end of the scan, or that is turned, may lie up to a block aside. Slices are smoothed only where no voxels are merged;
//! contours are traced between pixels, whatever the job says.

use grainpath_core::diagnostics::Stage;
use grainpath_core::slices::{SliceCursor, SliceError, SliceSource, VolumeInfo};
use grainpath_core::{Diagnostics, TriMesh};

use super::survey::Lattice;
use super::{CtSettings, Denoise, ScanError, Tracing, slice_scan};
use crate::loft::{LoftError, loft};

/// Voxels that are left at most. Source: chosen; 126 along each side of a cube, which are cut and lofted in about a second.
const MOST_VOXELS: f64 = 2e6;
/// Triangles of the surface at most. Source: chosen; a page draws them without a graphics card, and they are 5 MB.
const MOST_TRIANGLES: usize = 300_000;
/// Factor by which cells grow beyond what the number of triangles asks for. Source: derived; a surface has triangles in
/// proportion to the inverse square of its cells, and rough ones in a higher power.
const MARGIN: f64 = 1.1;

/// The surface of a scan, and how coarse it is.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanPreview {
    /// The surface, closed, mm.
    pub mesh: TriMesh,
    /// Columns, rows and slices of the scan that are taken.
    pub voxels: [usize; 3],
    /// Columns, rows and slices that were merged into one voxel.
    pub merged: [usize; 3],
    /// Side of the cells of the surface, mm.
    pub cell_mm: f64,
}

/// Why a scan has no preview.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum PreviewError {
    #[error(transparent)]
    Scan(#[from] ScanError),
    #[error(transparent)]
    Loft(#[from] LoftError),
}

/// Makes the surface of a scan at a bounded resolution.
///
/// # Errors
/// [`PreviewError`]: all reasons for which a scan cannot be cut into layers, and no material.
pub fn preview(
    source: &mut dyn SliceSource,
    settings: &CtSettings,
    diagnostics: &Diagnostics,
) -> Result<ScanPreview, PreviewError> {
    let info = source.info().clone();
    info.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
    // Mirroring in z is left to the layers, because slices come in the order of the file.
    let [flip_x, flip_y, flip_z] = settings.flip;
    let lattice = Lattice::new(&info, &CtSettings { flip: [flip_x, flip_y, false], ..settings.clone() })?;
    let (voxels, spacing_mm) = (lattice.size(), lattice.spacing_mm);
    let volume_mm3: f64 = voxels.iter().zip(spacing_mm).map(|(n, mm)| *n as f64 * mm).product();
    // The side of cubes of which two million fill the scan. Voxels that are longer than that in one direction are merged in
    // the others alone.
    let side_mm = (volume_mm3 / MOST_VOXELS).cbrt();
    let merged: [usize; 3] =
        std::array::from_fn(|k| ((side_mm / spacing_mm[k]).ceil() as usize).clamp(1, voxels[k]));
    let mut kept = Merged::new(source, &lattice, merged, &info, diagnostics)?;
    let is_merged = merged != [1; 3];
    let of_blocks: [f64; 3] = std::array::from_fn(|k| spacing_mm[k] * merged[k] as f64);
    let mut cell_mm = of_blocks.iter().copied().fold(f64::INFINITY, f64::min).max(side_mm);
    // A layer is no thicker than the scan, however it is turned.
    let thinnest_mm =
        voxels.iter().zip(spacing_mm).map(|(n, mm)| *n as f64 * mm).fold(f64::INFINITY, f64::min);
    loop {
        let coarse = CtSettings {
            flip: [false, false, flip_z],
            rotate_rad: settings.rotate_rad,
            layer_height_mm: cell_mm.min(thinnest_mm),
            first_layer_height_mm: cell_mm.min(thinnest_mm),
            denoise: if is_merged { Denoise::None } else { settings.denoise },
            tracing: Tracing::Iso,
            ..settings.as_turned()
        };
        // Crop, mirrors in the plane, spacing and scale are in the merged voxels already; turns are not.
        let stack = slice_scan(&mut kept, &coarse, diagnostics)?.stack;
        let mesh = loft(&stack, cell_mm, diagnostics)?;
        if mesh.triangles.len() <= MOST_TRIANGLES {
            return Ok(ScanPreview { mesh, voxels, merged, cell_mm });
        }
        cell_mm *= MARGIN * (mesh.triangles.len() as f64 / MOST_TRIANGLES as f64).sqrt();
    }
}

/// A scan of which each block of voxels is one, in memory.
struct Merged {
    info: VolumeInfo,
    slices: Vec<Vec<f32>>,
    cursor: SliceCursor,
    not_finite: u64,
    absent: u64,
}

impl Merged {
    /// Reads a scan and merges blocks of `by` voxels.
    fn new(
        source: &mut dyn SliceSource,
        lattice: &Lattice,
        by: [usize; 3],
        info: &VolumeInfo,
        diagnostics: &Diagnostics,
    ) -> Result<Self, ScanError> {
        let n = lattice.size();
        let size: [usize; 3] = std::array::from_fn(|k| n[k].div_ceil(by[k]));
        source.restart()?;
        for _ in 0..lattice.first {
            source.skip_slice()?;
        }
        diagnostics.begin(Stage::Read, n[2]);
        let mut slices = Vec::with_capacity(size[2]);
        for from in (0..n[2]).step_by(by[2]) {
            // Sum and number of the voxels of each block. Blocks at the end of a row may have fewer.
            let mut sums = vec![[0.0f64; 2]; size[0] * size[1]];
            for _ in from..(from + by[2]).min(n[2]) {
                diagnostics.check()?;
                let mut slice = Vec::new();
                if !source.next_slice(&mut slice)? {
                    return Err(ScanError::EndsEarly);
                }
                let slice = lattice.cropped(slice);
                for (j, row) in slice.chunks_exact(n[0]).enumerate() {
                    let own = &mut sums[j / by[1] * size[0]..][..size[0]];
                    for (sum, block) in own.iter_mut().zip(row.chunks(by[0])) {
                        sum[0] += block.iter().map(|v| f64::from(*v)).sum::<f64>();
                        sum[1] += block.len() as f64;
                    }
                }
                diagnostics.advance(1);
            }
            slices.push(sums.into_iter().map(|[sum, n]| (sum / n) as f32).collect());
        }
        let mut merged = VolumeInfo::new(info.format, size, info.sample);
        merged.spacing_mm = std::array::from_fn(|k| Some(lattice.spacing_mm[k] * by[k] as f64));
        // Heights of blocks of slices at uneven distances are the means of theirs.
        let is_even = |pair: &[f64]| ((pair[1] - pair[0]) / lattice.spacing_mm[2] - 1.0).abs() < 1e-3;
        if !lattice.z_mm.windows(2).all(is_even) {
            let mean = |block: &[f64]| block.iter().sum::<f64>() / block.len() as f64;
            let heights: Vec<f64> = lattice.z_mm.chunks(by[2]).map(mean).collect();
            merged.z_mm = heights.iter().map(|z| z - heights[0]).collect();
        }
        Ok(Self {
            info: merged,
            cursor: SliceCursor::new(slices.len()),
            slices,
            not_finite: source.n_not_finite(),
            absent: source.n_absent(),
        })
    }
}

impl SliceSource for Merged {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.cursor.restart();
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let Some(k) = self.cursor.slice() else { return Ok(false) };
        out.extend_from_slice(&self.slices[k]);
        Ok(self.cursor.pass())
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        Ok(self.cursor.pass())
    }

    fn n_not_finite(&self) -> u64 {
        self.not_finite
    }

    fn n_absent(&self) -> u64 {
        self.absent
    }
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec3;
    use grainpath_core::poly::{centroid as centroid_of, signed_area_mm2};

    use super::super::tests::{Phantom, settings};
    use super::*;

    /// A block with a tower in one corner; its sides have three lengths, so no mirror image looks the same.
    fn corner(p: [f64; 3]) -> f64 {
        let inside = |low: [f64; 3], high: [f64; 3]| {
            (0..3).map(|k| (p[k] - low[k]).min(high[k] - p[k])).fold(f64::INFINITY, f64::min)
        };
        inside([2.0, 3.0, 2.0], [17.0, 12.0, 6.0]).max(inside([2.0, 3.0, 2.0], [6.0, 6.0, 11.0]))
    }

    fn centroid(mesh: &TriMesh) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
            sum += a.dot(b.cross(c)) / 24.0 * (a + b + c);
        }
        sum / mesh.signed_volume()
    }

    #[test]
    fn a_preview_lies_where_the_layers_lie_however_the_scan_is_turned() {
        let size = [150, 110, 100];
        let plain = settings();
        let all = [
            plain.clone(),
            CtSettings { flip: [true, false, false], ..plain.clone() },
            CtSettings { flip: [false, true, true], ..plain.clone() },
            CtSettings { rotate_rad: [0.0, 0.0, std::f64::consts::FRAC_PI_2], ..plain.clone() },
            CtSettings { crop_px: [6, 9, 147, 105].into(), window: Some([4, 97]), ..plain },
        ];
        for wanted in all {
            let scan = || Phantom::new(corner, size, [0.13, 0.13, 0.13]);
            let stack = slice_scan(&mut scan(), &wanted, &Diagnostics::default()).expect("layers").stack;
            // Volume and centroid of the layers that a plan would have, at full resolution.
            let (mut volume, mut moment) = (0.0, DVec3::ZERO);
            for layer in stack.layers() {
                let z = layer.z_top_mm() - 0.5 * layer.height_mm();
                for contour in layer.region().contours() {
                    let own = signed_area_mm2(contour) * layer.height_mm();
                    (volume, moment) = (volume + own, moment + own * centroid_of(contour).extend(z));
                }
            }
            let found = preview(&mut scan(), &wanted, &Diagnostics::default()).expect("a preview");
            assert!(found.mesh.triangles.len() > 1000 && found.mesh.triangles.len() <= MOST_TRIANGLES);
            let off = found.mesh.signed_volume() / volume - 1.0;
            assert!(off.abs() < 0.03, "{wanted:?}: {off}");
            // A mirrored or shifted surface has its centroid several millimetres aside.
            let far = centroid(&found.mesh).distance(moment / volume);
            assert!(far < found.cell_mm, "{wanted:?}: {far} mm");
        }
    }

    #[test]
    fn a_large_scan_is_merged_and_keeps_its_volume() {
        let ball = |p: [f64; 3]| 8.0 - (0..3).map(|k| (p[k] - 10.0).powi(2)).sum::<f64>().sqrt();
        let mut scan = Phantom::new(ball, [200, 160, 100], [0.1, 0.125, 0.2]);
        let found = preview(&mut scan, &settings(), &Diagnostics::default()).expect("a preview");
        assert_eq!((found.voxels, found.merged), ([200, 160, 100], [2, 2, 1]));
        assert!((found.cell_mm - 0.2).abs() < 1e-9, "{}", found.cell_mm);
        let true_mm3 = 4.0 / 3.0 * std::f64::consts::PI * 512.0;
        assert!((found.mesh.signed_volume() / true_mm3 - 1.0).abs() < 0.03, "{}", found.mesh.signed_volume());
        let (low, high) = found.mesh.bounds().expect("a surface");
        assert!((high - low - 16.0).abs().max_element() < 0.3 && low.z.abs() < 1e-9, "{low} {high}");
    }

    #[test]
    fn a_rough_surface_gets_larger_cells() {
        // Balls of 1 mm in rows: 1000 of them have more triangles than are drawn.
        let balls = |p: [f64; 3]| {
            0.8 - (0..3).map(|k| ((p[k] / 2.0).fract() * 2.0 - 1.0).powi(2)).sum::<f64>().sqrt()
        };
        let mut scan = Phantom::new(balls, [120, 120, 120], [0.1667; 3]);
        let found = preview(&mut scan, &settings(), &Diagnostics::default()).expect("a preview");
        assert!(found.cell_mm > 0.2 && found.mesh.triangles.len() <= MOST_TRIANGLES, "{}", found.cell_mm);
        assert!(found.mesh.triangles.len() > MOST_TRIANGLES / 4, "{}", found.mesh.triangles.len());
    }
}
