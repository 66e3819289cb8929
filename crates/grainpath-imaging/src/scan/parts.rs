//! Scans cut in parts, each on a machine of its own, and the parts joined.
//!
//! # Method
//! The layers of a scan lie between pairs of neighbouring slices, and each layer is made of one pair alone. Of the whole
//! scan, only the threshold and the height at which the part begins have to be known before ([`Survey`]). A part is a range
//! of slices; its layers lie between these slices and the ones just below them, so that one slice of the part below is read
//! twice. Results that need the whole stack, such as loose pieces, are found when the parts are joined.
//! [`super::slice_scan`] takes the same steps with the whole scan as one part.
//!
//! # Units, cost and limits
//! As for whole scans. The survey reads up to 48 slices, and all below the first material. A turned scan is refused,
//! because each of its slices meets all slices of the file. Parts travel as bytes: contours, of which a point takes 4 to
//! 6 bytes, and no voxel.

use std::ops::Range;

use grainpath_core::layer::LayerStackError;
use grainpath_core::slices::{SliceSource, VolumeInfo};
use grainpath_core::{Diagnostics, Layer, LayerStack, Region};

use super::survey::Lattice;
use super::{
    Collected, CtSettings, CtStack, Events, Job, Lost, ScanError, Survey, as_fine_as_pixels, warn_of_values,
};

/// A scan that is cut in parts.
#[derive(Debug, Clone)]
pub struct PartedScan {
    info: VolumeInfo,
    settings: CtSettings,
    lattice: Lattice,
}

impl PartedScan {
    /// Prepares the cutting of a scan from its header alone.
    ///
    /// # Errors
    /// [`ScanError`]: no voxel size, a window or crop outside the scan, a scan that is turned.
    pub fn new(info: &VolumeInfo, settings: &CtSettings) -> Result<Self, ScanError> {
        if settings.rotate_rad != [0.0; 3] {
            return Err(ScanError::TurnedInParts);
        }
        let lattice = Lattice::new(info, settings)?;
        let settings = as_fine_as_pixels(settings, &lattice);
        Ok(Self { info: info.clone(), settings, lattice })
    }

    /// The slices of the file that are taken, by their numbers in the file, from 0.
    pub fn slices(&self) -> Range<usize> {
        self.lattice.first..self.lattice.first + self.lattice.z_mm.len()
    }

    /// Finds what every part needs of the whole scan: the threshold and the height at which the part begins.
    ///
    /// # Errors
    /// As [`super::slice_scan`].
    pub fn survey(
        &self,
        source: &mut dyn SliceSource,
        diagnostics: &Diagnostics,
    ) -> Result<Survey, ScanError> {
        let survey = Survey::run(source, &self.lattice, &self.settings, diagnostics)?;
        let job = self.job(&survey);
        job.begin_layers(diagnostics)?;
        let start_mm = match survey.start_mm {
            Some(mm) => Some(mm),
            None => job.find_start(source, diagnostics)?,
        };
        Ok(Survey { start_mm, ..survey })
    }

    /// Cuts the layers between each of these slices and the slice just below it. Slices count from the first one taken.
    ///
    /// # Errors
    /// [`ScanError`] for slices that the scan does not have, and for faults of the files.
    pub fn cut(
        &self,
        source: &mut dyn SliceSource,
        survey: &Survey,
        slices: Range<usize>,
        diagnostics: &Diagnostics,
    ) -> Result<ScanPart, ScanError> {
        let n = self.lattice.z_mm.len();
        if slices.is_empty() || slices.end > n {
            return Err(ScanError::PartOutside { first: slices.start, end: slices.end, n });
        }
        let job = self.job(survey);
        source.restart()?;
        // Where the survey found no start, there is no material, and `collect` makes no layer.
        let all = job.collect(source, slices.clone(), diagnostics)?;
        Ok(ScanPart { slices, all })
    }

    /// Joins the parts of a scan, in any order. Together they must hold every slice.
    ///
    /// # Errors
    /// [`ScanError::MissingPart`], and as [`super::slice_scan`].
    pub fn join(
        &self,
        survey: &Survey,
        mut parts: Vec<ScanPart>,
        diagnostics: &Diagnostics,
    ) -> Result<CtStack, ScanError> {
        self.info.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
        parts.sort_by_key(|p| p.slices.start);
        let mut all = Collected { start_mm: survey.start_mm, ..Collected::default() };
        let mut next = 0;
        for ScanPart { slices, all: part } in parts {
            if slices.start != next {
                return Err(ScanError::MissingPart { slice: next });
            }
            if next == 0 {
                all.ends[0] = part.ends[0];
            }
            next = slices.end;
            all.ends[1] = part.ends[1];
            all.layers.extend(part.layers);
            all.lost.add(part.lost);
            all.events.births += part.events.births;
            all.events.deaths += part.events.deaths;
            all.events.branches += part.events.branches;
            all.inside += part.inside;
            all.range = (all.range.0.min(part.range.0), all.range.1.max(part.range.1));
            all.not_finite += part.not_finite;
        }
        if next != self.lattice.z_mm.len() {
            return Err(ScanError::MissingPart { slice: next });
        }
        // Parts that were cut with different surveys may hold layers of the same number.
        let mut numbers: Vec<usize> = all.layers.iter().map(|l| l.0).collect();
        numbers.sort_unstable();
        if numbers.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(ScanError::PartsOverlap);
        }
        let (not_finite, range) = (all.not_finite, all.range);
        let made = self.job(survey).finish(all, diagnostics)?;
        warn_of_values(not_finite, range, &self.info, diagnostics);
        Ok(made)
    }

    fn job<'a>(&'a self, survey: &'a Survey) -> Job<'a> {
        let mode = self.lattice.mode(&self.settings);
        Job { settings: &self.settings, lattice: &self.lattice, survey, mode }
    }
}

/// The layers of a range of slices, and the counts for the report of the scan.
#[derive(Debug, Clone)]
pub struct ScanPart {
    slices: Range<usize>,
    all: Collected,
}

/// How many counts precede the layers in the bytes of a part. Source: derived: those that [`ScanPart::to_bytes`] writes.
const N_COUNTS: usize = 15;
/// Limit on each of these counts. Source: derived. A scan has at most 2^46 voxels, and as many parts as slices.
const MAX_COUNT: u64 = 1 << 47;

impl ScanPart {
    /// The part as bytes: counts of eight bytes each, then the layers as a [`LayerStack`] with layer numbers in place of
    /// heights.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Collected { lost, events, inside, range, ends, not_finite, .. } = &self.all;
        let counts: [u64; N_COUNTS] = [
            self.slices.start as u64,
            self.slices.end as u64,
            lost.islands as u64,
            lost.pores as u64,
            lost.points[0] as u64,
            lost.points[1] as u64,
            events.births as u64,
            events.deaths as u64,
            events.branches as u64,
            *inside as u64,
            range.0.to_bits().into(),
            range.1.to_bits().into(),
            ends[0].into(),
            ends[1].into(),
            *not_finite,
        ];
        let mut layers: Vec<&(usize, Region)> = self.all.layers.iter().collect();
        // In a mirrored scan layers come from the top.
        layers.sort_by_key(|l| l.0);
        let layer = |l: &(usize, Region)| Layer::new((l.0 + 1) as f64, 1.0, l.1.clone());
        let stack = LayerStack::new(layers.into_iter().filter_map(layer).collect());
        let mut out: Vec<u8> = counts.iter().flat_map(|c| c.to_le_bytes()).collect();
        out.extend(stack.expect("numbers of layers rise").to_bytes());
        out
    }

    /// The part in these bytes.
    ///
    /// # Errors
    /// [`LayerStackError`] for bytes that are no part, or are damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LayerStackError> {
        let counts: Vec<u64> = bytes
            .chunks_exact(8)
            .take(N_COUNTS)
            .filter_map(|c| c.first_chunk().copied())
            .map(u64::from_le_bytes)
            .collect();
        if counts.len() < N_COUNTS {
            return Err(LayerStackError::NotAStack);
        }
        // The limit keeps sums over all parts far below the bounds of their type.
        if let Some(k) = counts.iter().position(|&c| c >= MAX_COUNT) {
            return Err(LayerStackError::Invalid { offset: 8 * (k + 1), found: "a count beyond all bounds" });
        }
        let stack = LayerStack::from_bytes(&bytes[8 * N_COUNTS..])?;
        // Layer numbers are whole. Heights that are not show that the bytes hold a stack of another kind.
        let whole = |l: &Layer| l.height_mm() == 1.0 && l.z_top_mm().fract() == 0.0;
        if !stack.layers().iter().all(whole) {
            return Err(LayerStackError::Invalid {
                offset: bytes.len(),
                found: "heights that are no numbers of layers",
            });
        }
        let layers = stack.layers().iter();
        let layers = layers.map(|l| ((l.z_top_mm() - 1.0).max(0.0) as usize, l.region().clone())).collect();
        let n = |k: usize| counts[k] as usize;
        let all = Collected {
            start_mm: None,
            layers,
            lost: Lost { islands: n(2), pores: n(3), points: [n(4), n(5)] },
            events: Events { births: n(6), deaths: n(7), branches: n(8) },
            inside: n(9),
            range: (f32::from_bits(n(10) as u32), f32::from_bits(n(11) as u32)),
            ends: [n(12) == 1, n(13) == 1],
            not_finite: counts[14],
        };
        Ok(Self { slices: n(0)..n(1), all })
    }
}
