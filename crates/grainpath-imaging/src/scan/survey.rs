//! Determines which voxels are taken and where their grey values separate air from material, before any layer is made.
//!
//! # Method
//! Crop, mirroring and spacing of the job are applied to the header of the scan; values from the job win
//! over those of the file. Up to 48 slices, the middles of equal strides, give the histogram, from which
//! the threshold and the grey values of air and material follow (`crate::threshold`). With a given
//! threshold, six slices suffice to decide whether the values are those of a scan at all (`plausible`).
//! Slices at most 1.6 pixels apart are interpolated by grey values, others by contours.
//!
//! # Units, cost and limits
//! Lengths in mm, grey values in the unit of the file. The cost is one pass over the scan, because packed
//! slices cannot be reached without unpacking those before them. A blank scan, values that are all not
//! finite, noise, and a crop outside the scan are refused with the reason.

use grainpath_core::diagnostics::Stage;
use grainpath_core::slices::{SliceSource, VolumeInfo};
use grainpath_core::{Contour, DVec2, Diagnostics};

use super::plausible::{Implausible, Plausibility};
use super::{CtSettings, Denoise, Histogram, Interpolation, ScanError, Threshold, Tracing};

/// Slices that are at most this many pixels apart are interpolated by their grey values: the blur of an
/// edge then reaches from slice to slice. With slices farther apart, a flank between them would show as
/// steps.
const GREY_RATIO: f64 = 1.6;
/// Largest number of slices that are sampled for the histogram. The modes of air and material need a fair sample; reading
/// every slice would double the time to read a scan.
pub const SAMPLED: usize = 48;
/// Largest number of slices that are sampled where only plausibility is checked. More slices cost time; fewer may all lie in
/// the air above the part.
const PLAUSIBLE: usize = 6;

/// Whether slice `k` of `n` is one of at most `most` that are sampled: the middle of each of as many strides, so that the
/// often empty first and last slices do not dominate.
pub fn is_sampled(k: usize, n: usize, most: usize) -> bool {
    let stride = n.div_ceil(most).max(1);
    k % stride == stride / 2 || n < 3
}

/// The voxels that are taken, and where they lie.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    pub(super) file_nx: usize,
    pub(super) crop: [usize; 4],
    pub(super) flip: [bool; 3],
    pub(super) nx: usize,
    pub(super) ny: usize,
    pub(super) first: usize,
    /// Height of every slice taken, mm; rising unless flipped.
    pub(super) z_mm: Vec<f64>,
    /// Half the distance of the outermost slices, mm. The part extends by as much beyond them, since a
    /// voxel is a volume and not a point.
    pub(super) ends_mm: [f64; 2],
    pub(super) spacing_mm: [f64; 3],
}

impl Lattice {
    pub(super) fn new(info: &VolumeInfo, s: &CtSettings) -> Result<Self, ScanError> {
        let [x, y, n] = info.size;
        let crop = s.crop_px.unwrap_or([0, 0, x - 1, y - 1]);
        let [x0, y0, x1, y1] = crop;
        if x0 > x1 || y0 > y1 || x1 >= x || y1 >= y {
            return Err(ScanError::Crop { section: s.section, crop, columns: x, rows: y });
        }
        let [first, last] = s.window.unwrap_or([0, n - 1]);
        if first > last || last >= n {
            return Err(ScanError::Window { section: s.section, first, last, n });
        }
        // A value from the job wins over that of the file: headers are often wrong.
        let known = [0, 1, 2].map(|k| s.spacing_mm[k].or(info.spacing_mm[k]));
        let [Some(dx), Some(dy), Some(dz)] = known else {
            // One message names both missing sizes, so that the user can set them in one go.
            let is_lacking = [known[0].and(known[1]).is_none(), known[2].is_none()];
            let list = |words: [String; 2], and: &str| {
                let lacking = words.into_iter().zip(is_lacking).filter(|(_, lacks)| *lacks);
                lacking.map(|(word, _)| word).collect::<Vec<_>>().join(and)
            };
            return Err(ScanError::NoSpacing {
                what: list(["size of pixels", "distance of slices"].map(str::to_owned), " and no "),
                keys: list(["pixel_mm", "slice_mm"].map(|key| format!("{}.{key}", s.section)), " and "),
            });
        };
        let spacing_mm = [dx, dy, dz].map(|mm| mm * s.scale);
        let count = last - first + 1;
        // A slice distance from the job replaces uneven positions too.
        let even = s.spacing_mm[2].is_some() || info.z_mm.is_empty();
        let mut z_mm: Vec<f64> = if even {
            (0..count).map(|k| k as f64 * spacing_mm[2]).collect()
        } else {
            info.z_mm[first..=last].iter().map(|z| (z - info.z_mm[first]) * s.scale).collect()
        };
        // A single slice has no neighbour; its thickness is the slice distance.
        let gap = |k: usize| z_mm.get(k + 1).map_or(spacing_mm[2], |z| z - z_mm[k]);
        let mut ends_mm = [0.5 * gap(0), 0.5 * gap(count.saturating_sub(2))];
        // Heights are mirrored and slices stay in the order of the file, because reading backwards would
        // cost a pass for each block.
        if s.flip[2] {
            let top = z_mm[count - 1];
            z_mm.iter_mut().for_each(|z| *z = top - *z);
            ends_mm.reverse();
        }
        Ok(Self {
            file_nx: x,
            crop,
            flip: s.flip,
            nx: x1 - x0 + 1,
            ny: y1 - y0 + 1,
            first,
            z_mm,
            ends_mm,
            spacing_mm,
        })
    }

    /// Columns, rows and slices.
    pub(super) fn size(&self) -> [usize; 3] {
        [self.nx, self.ny, self.z_mm.len()]
    }

    pub(super) fn mode(&self, s: &CtSettings) -> Interpolation {
        let near = self.spacing_mm[2] <= GREY_RATIO * self.spacing_mm[0].min(self.spacing_mm[1]);
        match (s.tracing, s.interpolation) {
            // Canny gives contours and no grey values between slices, so contours are matched.
            (Tracing::Canny, Interpolation::Auto | Interpolation::Grey) => Interpolation::Matched,
            (_, Interpolation::Auto) if near => Interpolation::Grey,
            (_, Interpolation::Auto) => Interpolation::Matched,
            (_, chosen) => chosen,
        }
    }

    pub(super) fn pixel_mm(&self) -> DVec2 {
        DVec2::new(self.spacing_mm[0], self.spacing_mm[1])
    }

    /// Cuts a slice down to the voxels that are taken.
    pub(super) fn cropped(&self, whole: Vec<f32>) -> Vec<f32> {
        let [x0, y0, x1, y1] = self.crop;
        // Without crop and mirror the slice is passed on without a copy.
        if whole.len() == self.nx * self.ny && !self.flip[0] && !self.flip[1] {
            return whole;
        }
        let mut out = Vec::with_capacity(self.nx * self.ny);
        for j in 0..=y1 - y0 {
            let row = if self.flip[1] { y1 - j } else { y0 + j };
            let values = &whole[row * self.file_nx + x0..=row * self.file_nx + x1];
            if self.flip[0] { out.extend(values.iter().rev()) } else { out.extend(values) }
        }
        out
    }

    pub(super) fn to_mm(&self, c: Contour) -> Contour {
        let size = self.pixel_mm();
        c.into_iter().map(|p| p * size).collect()
    }
}

/// Properties of a whole scan that are found before any layer is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Lowest grey value of material.
    pub low: f64,
    /// Highest grey value of material; infinite unless the job states a range.
    pub high: f64,
    /// Difference between the grey values of air and material.
    pub contrast: f64,
    /// The least grey value of the slices sampled, which slices without any value get.
    pub air: f64,
    /// Height at which the part begins, mm, where it is known: in scans that are taken upside down, and after
    /// [`PartedScan::survey`](super::PartedScan::survey).
    pub start_mm: Option<f64>,
}

impl Survey {
    pub(super) fn run(
        source: &mut dyn SliceSource,
        lattice: &Lattice,
        s: &CtSettings,
        diagnostics: &Diagnostics,
    ) -> Result<Self, ScanError> {
        let found = matches!(s.threshold, Threshold::Otsu | Threshold::Iso50(None));
        let contrast = s.tracing == Tracing::Canny || s.denoise == Denoise::Edges;
        let n = lattice.z_mm.len();
        let mut histogram = Histogram::default();
        let mut plausibility = Plausibility::new(source.info().sample);
        // A given threshold needs no histogram; a few slices show whether the values are those of a scan.
        let sampled = if found || contrast { SAMPLED } else { PLAUSIBLE };
        diagnostics.begin(Stage::Read, n);
        // All slices are read through, because packed slices cannot be reached without unpacking those before
        // them.
        let (mut slice, mut air) = (Vec::new(), f32::INFINITY);
        let (mut n_voxels, mut n_unknown) = (0, 0);
        source.restart()?;
        for _ in 0..lattice.first {
            source.skip_slice()?;
        }
        for k in 0..n {
            diagnostics.check()?;
            if is_sampled(k, n, sampled) {
                source.next_known(&mut slice)?;
                let values = lattice.cropped(std::mem::take(&mut slice));
                n_voxels += values.len() as u64;
                n_unknown += values.iter().filter(|v| v.is_nan()).count() as u64;
                air = values.iter().copied().fold(air, f32::min);
                plausibility.add(&values, lattice.nx);
                if found || contrast {
                    histogram.add(&values, lattice.nx);
                }
            } else {
                source.skip_slice()?;
            }
            diagnostics.advance(1);
        }
        // All values not finite: the sample type is almost certainly wrong.
        if n_voxels > 0 && n_unknown == n_voxels {
            return Err(ScanError::NotFinite { voxels: n_voxels });
        }
        match plausibility.verdict() {
            Some(Implausible::ByteOrder) => {
                return Err(ScanError::ByteOrder { section: s.section });
            }
            // A user who smooths has seen the noise and means this scan.
            Some(Implausible::Noise) if s.denoise == Denoise::None => {
                return Err(ScanError::Noise { section: s.section });
            }
            Some(Implausible::Noise) | None => {}
        }
        let materials = match s.threshold {
            Threshold::Iso50(Some([a, b])) => (a.min(b), a.max(b)),
            Threshold::Otsu | Threshold::Iso50(None) | Threshold::Value(_) | Threshold::Range(..) => {
                if found || contrast { histogram.materials() } else { (0.0, 0.0) }
            }
        };
        // A blank scan has no two groups, and every threshold would be arbitrary.
        if let Some((low, _)) = histogram.range().filter(|(l, h)| l == h) {
            return Err(ScanError::Blank { grey: low });
        }
        let (low, high) = match s.threshold {
            Threshold::Otsu => (histogram.otsu(), f64::INFINITY),
            Threshold::Iso50(_) => (0.5 * (materials.0 + materials.1), f64::INFINITY),
            Threshold::Value(v) => (v, f64::INFINITY),
            Threshold::Range(a, b) => (a, b),
        };
        let contrast = (materials.1 - materials.0).abs();
        let mut survey = Self { low, high, contrast, air: f64::from(air), start_mm: None };
        if lattice.flip[2] {
            survey.start_mm = survey.find_bottom(source, lattice, s)?;
        }
        source.restart()?;
        Ok(survey)
    }

    /// Height of the lower end of the last slice with material.
    fn find_bottom(
        &self,
        source: &mut dyn SliceSource,
        lattice: &Lattice,
        s: &CtSettings,
    ) -> Result<Option<f64>, ScanError> {
        source.restart()?;
        for _ in 0..lattice.first {
            source.skip_slice()?;
        }
        let least = s.min_island_mm2 / (lattice.spacing_mm[0] * lattice.spacing_mm[1]);
        let (mut slice, mut bottom) = (Vec::new(), None);
        for (k, z) in lattice.z_mm.iter().enumerate() {
            source.next_known(&mut slice)?;
            let inside = slice.iter().filter(|&&v| self.signed(v) > 0.0).count();
            // Specks below the plate would otherwise lift the part.
            if inside as f64 > least.max(1.0) {
                let below = lattice.z_mm.get(k + 1).map_or(lattice.ends_mm[0], |next| 0.5 * (z - next));
                bottom = Some(z - below);
            }
        }
        Ok(bottom)
    }

    /// Grey value minus threshold: positive inside the material.
    pub(super) fn signed(&self, v: f32) -> f32 {
        let v = f64::from(v);
        // For a range the nearer of the two thresholds counts, so that both borders lie at zero.
        (v - self.low).min(self.high - v) as f32
    }
}
