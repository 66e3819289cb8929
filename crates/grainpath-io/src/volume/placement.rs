//! Computes where a file says its voxels lie, and brings its slices into a right-handed, upright order.
//!
//! # Frames
//! A header gives the world position of the centre of voxel `(i, j, k)` as `origin + i a + j b + k c`, in mm. The world
//! is LPS as in DICOM (x left, y back, z head); readers convert other frames into LPS, for example NIfTI's RAS by a half
//! turn about z. LPS and RAS are both right-handed, so the sign of `det [a b c]` says whether the stored order of the
//! voxels shows the object or its mirror image.
//!
//! # Method
//! 1. `[a b c] = Q R` by Gram-Schmidt, in this order, so that `R` is upper triangular with a positive diagonal: the
//!    spacing stands on the diagonal and the shear above it. A tilted gantry is a shear of slices along rows.
//! 2. A shear is taken out by moving each slice, and each row within a slice, in the plane ([`super::resliced`]). Slices
//!    are never mixed.
//! 3. Of the 24 signed permutations `M` with `det M = det Q`, the one with the greatest trace of `Q M` is taken: the
//!    stored axes are exchanged and reversed so that the slices' axes lie nearest to those of the world. `Q M` is a
//!    rotation, so the part is never mirrored. What is left of it (an oblique scan) is not resampled; the part stands
//!    along its voxels and a warning states the angle.
//!
//! Sources: the equations of a plane's voxels in DICOM PS3.3 C.7.6.2.1.1; `nifti1.h`, methods 1 to 3; the NRRD format,
//! "space directions"; `MetaIO`, whose `TransformMatrix` lists the direction of one axis after another.
//!
//! # Limits
//! Axes that do not span a volume, and leans of more than [`MAX_LEAN_DEG`], are refused. Slices at uneven distances can
//! be reversed but not exchanged with columns or rows.

use grainpath_core::math::{acos, atan2};
use grainpath_core::slices::{SliceSource, VolumeInfo, WorldFrame};
use grainpath_core::{DMat3, DVec3, Warning, WarningId};

use super::finite::Finite;
use super::resliced::{Reordered, Shear, StoredAxis, Upright};
use super::{VolumeError, VolumeProblem, check_size, error, spacing, unsupported};

/// Larger leans are refused, because the upright slices would be mostly empty. Source: gantries tilt by up to 30 degrees;
/// the rest is margin for hand-made headers.
const MAX_LEAN_DEG: f64 = 60.0;
/// Limit up to which a shear counts as rounding of the header: the largest movement of a voxel in the whole volume, px.
/// Source: derived. Decimals of six places in DICOM and the single precision of NIfTI move the last of 1000 voxels by up to
/// 0.001 px; contours are simplified to 0.1 px, so a smaller shear leaves no trace.
const ROUNDING_PX: f64 = 0.1;
/// A scan that is turned against the world's axes by more than this gives a warning, degrees. Source: derived. 1 degree
/// moves the end of a part of 100 mm by 1.7 mm, which is visible.
const OBLIQUE_DEG: f64 = 1.0;

/// The world positions of a file's voxels, as stored: `origin_mm + i step[0] + j step[1] + k step[2]`, LPS, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    pub origin_mm: DVec3,
    pub step_mm: [DVec3; 3],
    /// Whether the file states the spacing along each stored axis; a step of unstated length is 1 mm.
    pub stated: [bool; 3],
}

/// `[a b c] = Q R`.
struct Decomposed {
    /// Unit directions of the upright axes; may be left-handed.
    q: DMat3,
    /// Spacing on the diagonal, shear above it, mm.
    r: DMat3,
}

impl Placement {
    /// Axes along those of the world, for headers that state signed distances of voxels and no directions. `None` where
    /// no axis runs backwards.
    pub(super) fn of_signed(spacing_mm: [f64; 3]) -> Option<Self> {
        let stated = spacing_mm.map(|mm| spacing(mm).is_some());
        let is_backwards = (0..3).any(|k| stated[k] && spacing_mm[k] < 0.0);
        let length = |k: usize| if stated[k] { spacing_mm[k] } else { 1.0 };
        let step_mm = [DVec3::X * length(0), DVec3::Y * length(1), DVec3::Z * length(2)];
        is_backwards.then_some(Self { origin_mm: DVec3::ZERO, step_mm, stated })
    }

    /// Converts a placement in RAS (x right, y front) to LPS.
    pub(super) fn ras_to_lps(self) -> Self {
        let turn = DVec3::new(-1.0, -1.0, 1.0);
        Self { origin_mm: self.origin_mm * turn, step_mm: self.step_mm.map(|v| v * turn), ..self }
    }

    fn decomposed(&self, file: &str) -> Result<Decomposed, VolumeError> {
        let [a, b, c] = self.step_mm;
        let finite = self.origin_mm.is_finite() && self.step_mm.iter().all(|v| v.is_finite());
        let volume = a.dot(b.cross(c));
        // Relative to a box with these edges. The bound is far below the volume of any shear that
        // MAX_LEAN_DEG accepts.
        if !finite || volume.abs() <= 1e-6 * a.length() * b.length() * c.length() {
            return Err(error(file, VolumeProblem::FlatAxes { step_mm: self.step_mm.map(|v| v.to_array()) }));
        }
        let x = a.normalize();
        let y = (b - x * b.dot(x)).normalize();
        let normal = x.cross(y);
        // A negative volume means that the stored order shows a mirror image; z then points backwards and
        // `q` is left-handed.
        let z = if volume > 0.0 { normal } else { -normal };
        let r = DMat3::from_cols(
            DVec3::new(a.length(), 0.0, 0.0),
            DVec3::new(b.dot(x), b.dot(y), 0.0),
            DVec3::new(c.dot(x), c.dot(y), c.dot(z)),
        );
        if let Some(mm) = [r.x_axis.x, r.y_axis.y, r.z_axis.z].into_iter().find(|mm| spacing(*mm).is_none()) {
            return Err(error(file, VolumeProblem::Spacing { mm }));
        }
        Ok(Decomposed { q: DMat3::from_cols(x, y, z), r })
    }
}

/// The signed permutation that brings the columns of `q` nearest to the world's axes. Its determinant has
/// the sign of that of `q`.
fn nearest_order(q: &DMat3) -> [StoredAxis; 3] {
    const ORDERS: [([usize; 3], f64); 6] = [
        ([0, 1, 2], 1.0),
        ([1, 2, 0], 1.0),
        ([2, 0, 1], 1.0),
        ([1, 0, 2], -1.0),
        ([0, 2, 1], -1.0),
        ([2, 1, 0], -1.0),
    ];
    let handedness = q.determinant().signum();
    let (mut best, mut best_trace) = ([StoredAxis { axis: 0, reversed: false }; 3], f64::NEG_INFINITY);
    for (order, parity) in ORDERS {
        for signs in 0..8u8 {
            let reversed = [0, 1, 2].map(|axis| signs >> axis & 1 == 1);
            let sign = |axis: usize| if reversed[axis] { -1.0 } else { 1.0 };
            // Only permutations of the same handedness make `Q M` a rotation, so the part is never
            // mirrored.
            if parity * sign(0) * sign(1) * sign(2) != handedness {
                continue;
            }
            let trace: f64 = (0..3).map(|axis| sign(axis) * q.col(order[axis])[axis]).sum();
            // Among equally near permutations the first is taken, independent of rounding.
            if trace > best_trace + 1e-6 {
                best_trace = trace;
                best = [0, 1, 2].map(|axis| StoredAxis { axis: order[axis], reversed: reversed[axis] });
            }
        }
    }
    best
}

/// Brings the slices of `source`, which are stored as `placement` says, upright and into the order of the
/// world's axes.
///
/// # Errors
/// [`VolumeError`] for axes that do not span a volume, lean too far, or cannot be exchanged.
pub(super) fn oriented(
    source: impl SliceSource + 'static,
    placement: &Placement,
    file: &str,
) -> Result<Box<dyn SliceSource>, VolumeError> {
    let Decomposed { q, r } = placement.decomposed(file)?;
    let mut info = source.info().clone();
    info.spacing_mm = [Some(r.x_axis.x), Some(r.y_axis.y), Some(r.z_axis.z)];
    let mut source: Box<dyn SliceSource> = Box::new(source);
    let mut origin_mm = placement.origin_mm;
    // The shear comes first: it is defined by the stored axes.
    let shear = Shear::find(&r, &info, file)?;
    let is_moved = shear.is_some();
    if let Some(shear) = shear {
        info.warnings.push(Warning::new(WarningId::ScanSheared, shear.told(&info)).in_file(file));
        info.size = shear.size;
        check_size(file, info.size)?;
        origin_mm += q.x_axis * shear.first_mm[0] + q.y_axis * shear.first_mm[1];
        source = Box::new(Upright::new(source, info.clone(), shear));
    }
    let order = nearest_order(&q);
    let axes = DMat3::from_cols_array_2d(&order.map(|o| {
        let direction = q.col(o.axis);
        (if o.reversed { -direction } else { direction }).to_array()
    }));
    // A reversed axis begins at its other end.
    for stored in order.iter().filter(|o| o.reversed) {
        let length_mm = match (stored.axis, info.z_mm.last()) {
            (2, Some(top)) => *top,
            (axis, _) => (info.size[axis] - 1) as f64 * info.spacing_mm[axis].unwrap_or(0.0),
        };
        origin_mm += q.col(stored.axis) * length_mm;
    }
    // The rotation angle follows from the trace of a rotation matrix: 1 + 2 cos.
    let turned_deg = acos((0.5 * (axes.x_axis.x + axes.y_axis.y + axes.z_axis.z - 1.0)).clamp(-1.0, 1.0));
    let turned_deg = turned_deg.to_degrees();
    if turned_deg > OBLIQUE_DEG {
        let text = format!(
            "the voxels are turned by {turned_deg:.2} degrees in the world; the part stands along them"
        );
        info.warnings.push(Warning::new(WarningId::ScanOblique, text).in_file(file));
    }
    info.world = Some(WorldFrame { origin_mm, axes });
    let across = order[2].axis != 2;
    // Rows and columns have an even pitch. Exchanging them with uneven slices would lose the positions.
    if across && !info.z_mm.is_empty() {
        return Err(unsupported(
            file,
            "slices at uneven distances that lie along the height of the part",
            "resample them to even distances",
        ));
    }
    if order[2].reversed && !info.z_mm.is_empty() {
        let top = info.z_mm[info.z_mm.len() - 1];
        info.z_mm = info.z_mm.iter().rev().map(|z| top - z).collect();
    }
    info.size = order.map(|o| info.size[o.axis]);
    info.spacing_mm = order.map(|o| info.spacing_mm[o.axis].filter(|_| placement.stated[o.axis]));
    // Without a spacing the world positions are unknown.
    if placement.stated != [true; 3] {
        info.world = None;
    }
    if across || order[2].reversed {
        check_size(file, info.size)?;
        if let Some(text) = super::resliced::cost(&info, order) {
            info.warnings.push(Warning::new(WarningId::ScanReadAgain, text).in_file(file));
        }
    }
    let reordered = Reordered::new(source, info, order);
    Ok(Box::new(if is_moved { Finite::of_moved(reordered) } else { Finite::new(reordered) }))
}

impl Shear {
    /// The shear in `r`, or `None` if it is only rounding.
    fn find(r: &DMat3, info: &VolumeInfo, file: &str) -> Result<Option<Self>, VolumeError> {
        let [nx, ny, nz] = info.size;
        let (pixel_x, pixel_y, rise_mm) = (r.x_axis.x, r.y_axis.y, r.z_axis.z);
        let columns_per_row = r.y_axis.x / pixel_x;
        let per_slice = [r.z_axis.x / pixel_x, r.z_axis.y / pixel_y];
        // A slice shifts in proportion to its height. Its index gives the height only if the slices are evenly spaced.
        let steps = |k: usize| info.z_mm.get(k).map_or(k as f64, |z| z / rise_mm);
        let slice_shift_px: Vec<[f64; 2]> = (0..nz).map(|k| per_slice.map(|px| px * steps(k))).collect();
        let last = slice_shift_px[nz - 1];
        let row_px = columns_per_row * (ny - 1) as f64;
        let largest = [row_px, last[0], last[1]].into_iter().fold(0.0f64, |m, px| m.max(px.abs()));
        if largest <= ROUNDING_PX {
            return Ok(None);
        }
        let lean_deg = atan2(r.z_axis.truncate().length(), rise_mm).to_degrees();
        let row_lean_deg = atan2(r.y_axis.x.abs(), pixel_y).to_degrees();
        let steepest = lean_deg.max(row_lean_deg);
        if steepest > MAX_LEAN_DEG {
            return Err(error(file, VolumeProblem::Leans { lean_deg: steepest, limit_deg: MAX_LEAN_DEG }));
        }
        let low = [last[0].min(0.0) + row_px.min(0.0), last[1].min(0.0)];
        let high = [last[0].max(0.0) + row_px.max(0.0), last[1].max(0.0)];
        // Shifts are whole pixels where possible, so that slices that are not moved are not blurred.
        let first_px = low.map(f64::floor);
        let grown = |axis: usize, n: usize| n.saturating_add((high[axis].ceil() - first_px[axis]) as usize);
        Ok(Some(Self {
            columns_per_row,
            slice_shift_px,
            first_px,
            first_mm: [first_px[0] * pixel_x, first_px[1] * pixel_y],
            size: [grown(0, nx), grown(1, ny), nz],
            lean_deg,
            row_lean_deg,
        }))
    }

    /// Describes the shear that was removed and the blur that this causes, for the user. Linear interpolation at a fraction
    /// `f` between two pixels is a filter of variance `f (1 - f)`, at most a quarter of a square pixel.
    fn told(&self, info: &VolumeInfo) -> String {
        let last = self.slice_shift_px[self.slice_shift_px.len() - 1];
        let what = if self.row_lean_deg > self.lean_deg {
            format!("the columns lean by {:.2} degrees within the slices", self.row_lean_deg)
        } else {
            format!("the stack leans by {:.2} degrees, as with a tilted gantry", self.lean_deg)
        };
        format!(
            "{what}; slices were moved upright by up to {:.1} columns and {:.1} rows and grew from {} x {} to \
             {} x {} pixels, which blurs edges by at most 0.5 pixels",
            last[0].abs() + (self.columns_per_row * (info.size[1] - 1) as f64).abs(),
            last[1].abs(),
            info.size[0],
            info.size[1],
            self.size[0],
            self.size[1],
        )
    }
}
