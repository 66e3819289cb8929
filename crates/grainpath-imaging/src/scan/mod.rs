//! CT scans to layers without a mesh in between.
//!
//! The pipeline is that of Tan et al. (`tan2020` in docs/references.bib). Each slice gives contours,
//! which are matched with those of the neighbouring slice; contours between the slices are then made at
//! the heights of the print's layers. Slices are read one after another and released; a few for each
//! thread are held at a time.
//!
//! # Steps
//! 1. `survey`: which voxels are taken, whether they can be a scan at all (`plausible`), and the grey values of air and
//!    material (`crate::threshold`). `turned` turns the scan first, if asked.
//! 2. `trace`: a slice becomes contours where the grey value crosses the threshold, between pixels; `edges` moves these onto
//!    Canny's edges, as published.
//! 3. Between two slices: grey values are mixed where slices lie as close as pixels, otherwise contours are matched and
//!    moved (`matching`, `correspond`, `split`), or signed distances are mixed.
//! 4. Small islands and holes are dropped by the area of their section, loose pieces by their volume
//!    (`pieces`).
//!
//! # Units and frame
//! Columns are x, rows y, slices z, right-handed; mm from the lower face of the first voxel taken. Grey values are `f32` in
//! the unit of the file.
//!
//! # Cost and limits
//! Linear in voxels; slices are prepared in parallel and collected in order, so the result is the same for any number of
//! threads. One threshold, or one range, separates material from air; parts of several materials are
//! printed as one. The blur of a scanner moves a curved face inwards by half the blur's variance over the
//! radius; this is not corrected.

mod correspond;
mod edges;
mod error;
mod matching;
mod parts;
mod pieces;
mod plausible;
mod preview;
mod sheet;
mod split;
mod survey;
pub mod texture;
mod trace;
mod turned;

use std::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;

use grainpath_core::diagnostics::Stage;
use grainpath_core::poly::{FillRule, signed_area_mm2};
use grainpath_core::slices::{SampleType, SliceError, SliceSource, VolumeInfo};
use grainpath_core::spelling::counted;
use grainpath_core::{Contour, DVec2, Diagnostics, Layer, LayerStack, Region, Warning, WarningId};
use rayon::prelude::*;

pub use crate::distance::{Raster, signed_distance};
pub use crate::smooth::Smoothing;
pub use crate::threshold::Histogram;
pub use edges::CannySettings;
pub use error::{GreyRange, GreyValues, ScanError};
pub use matching::{Events, Group, MatchSettings, Slab, match_entities};
pub use parts::{PartedScan, ScanPart};
pub use plausible::{Implausible, Plausibility};
pub use preview::{PreviewError, ScanPreview, preview};
pub use sheet::ContactSheet;
pub use survey::{SAMPLED, Survey, is_sampled};
pub use trace::SignedImage;

use survey::Lattice;
use turned::Turned;

/// Rule that places the part's border among the grey values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// Otsu's threshold of the histogram (`otsu1979`).
    Otsu,
    /// Halfway between the grey values of air and material, found or given.
    Iso50(Option<[f64; 2]>),
    /// Material from this grey value up.
    Value(f64),
    /// Material between these grey values.
    Range(f64, f64),
}

/// Method that removes noise; see [`Smoothing`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Denoise {
    /// No smoothing.
    None,
    /// Gaussian of this standard deviation, px.
    Gaussian(f64),
    /// Median of 3 x 3.
    Median,
    /// Diffusion that stops at edges.
    Edges,
}

/// Method that finds contours in a slice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tracing {
    /// Contours where the grey value crosses the threshold, between pixels.
    Iso,
    /// Contours on Canny's edges, as in the paper.
    Canny,
}

/// Method that makes layers between two slices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Grey values where slices lie as close as pixels, otherwise matched contours.
    Auto,
    /// Grey values, interpolated.
    Grey,
    /// Contours, matched and moved.
    Matched,
    /// Signed distances, interpolated.
    Distance,
}

impl Interpolation {
    /// The word of the setting.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Grey => "grey",
            Self::Matched => "matched",
            Self::Distance => "distance",
        }
    }
}

/// Settings for converting a scan to layers.
#[derive(Debug, Clone, PartialEq)]
pub struct CtSettings {
    /// The section of the job that holds these settings, for messages.
    pub section: &'static str,
    /// Distance of voxels along x, y, z, mm; `None` takes that of the file.
    pub spacing_mm: [Option<f64>; 3],
    /// Factor on all lengths.
    pub scale: f64,
    /// First and last slice that are taken, counted from 0.
    pub window: Option<[usize; 2]>,
    /// First column, first row, last column, last row that are taken, counted from 0.
    pub crop_px: Option<[usize; 4]>,
    /// Whether x, y and z are mirrored.
    pub flip: [bool; 3],
    /// Rotations about x, then y, then z, after cropping and mirroring, rad.
    pub rotate_rad: [f64; 3],
    /// Rule that places the part's border among the grey values.
    pub threshold: Threshold,
    /// Method that removes noise.
    pub denoise: Denoise,
    /// Method that finds contours.
    pub tracing: Tracing,
    /// Canny's low and high threshold, as shares of the step from air to material per pixel, and the
    /// standard deviation of its Gaussian in px.
    pub canny: [f64; 3],
    /// Method that makes layers between two slices.
    pub interpolation: Interpolation,
    /// Least overlap of entities that belong together.
    pub overlap: f64,
    /// Smaller islands of a section are dropped, mm2.
    pub min_island_mm2: f64,
    /// Smaller holes of a section are filled, mm2.
    pub min_pore_mm2: f64,
    /// Loose pieces of less volume are dropped, mm3; 0 keeps all.
    pub min_piece_mm3: f64,
    /// Thickness of a layer, mm.
    pub layer_height_mm: f64,
    /// Thickness of the first layer, mm.
    pub first_layer_height_mm: f64,
    /// Largest distance of simplified contours from the original, mm; at least a tenth of a pixel.
    pub simplify_mm: f64,
}

impl CtSettings {
    /// The settings for a scan that has been cropped, mirrored, scaled and rotated already.
    fn as_turned(&self) -> Self {
        Self {
            spacing_mm: [None; 3],
            scale: 1.0,
            window: None,
            crop_px: None,
            flip: [false; 3],
            rotate_rad: [0.0; 3],
            ..self.clone()
        }
    }
}

/// Measures of a scan.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CtReport {
    /// Columns, rows, slices taken.
    pub voxels: [usize; 3],
    /// Distance of voxels, mm.
    pub spacing_mm: [f64; 3],
    /// Grey value of the border; two values for a range.
    pub threshold: Vec<f64>,
    /// Method that made layers between slices.
    pub interpolation: &'static str,
    /// Height of the part's lowest point above the lower face of the first voxel taken, mm.
    pub bottom_mm: f64,
    /// Size of the part in x, y and z, mm.
    pub size_mm: [f64; 3],
    /// Islands of sections below the least area, which were dropped.
    pub dropped_islands: usize,
    /// Loose pieces below the least volume, which were dropped.
    pub dropped_pieces: usize,
    /// Holes of sections below the least area, which were filled.
    pub filled_pores: usize,
    /// Entities that begin between slices; 0 where contours are not matched.
    pub births: usize,
    /// Entities that end.
    pub deaths: usize,
    /// Entities that divide or merge.
    pub branches: usize,
}

/// The layers of a scan with their report.
#[derive(Debug, Clone, PartialEq)]
pub struct CtStack {
    /// The layers.
    pub stack: LayerStack,
    /// Measures of the scan.
    pub report: CtReport,
}

/// A pixel is plainly material or plainly air where its grey value lies beyond the threshold by this share of the step from
/// air to material. Source: derived. With the threshold halfway, noise of 10 % of the step makes air look plainly material
/// only at six standard deviations.
const CLEAR: f64 = 0.1;
/// Steps of `f32` that are enough between the lowest and the highest grey value. Source: derived. Detectors give 12 to 16 bits.
const MIN_STEPS: f64 = 4096.0;
/// Limit on the layers. Source: derived. At 0.05 mm it is a part 10 m high.
const MAX_LAYERS: f64 = 200_000.0;
/// Cuts a scan into layers at the printer's heights. Holds a few slices at a time.
///
/// # Errors
/// [`ScanError`]: no voxel size, a window or crop outside the scan, a threshold that leaves nothing or everything, and
/// faults of the files.
pub fn slice_scan(
    source: &mut dyn SliceSource,
    settings: &CtSettings,
    diagnostics: &Diagnostics,
) -> Result<CtStack, ScanError> {
    let info = source.info().clone();
    info.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
    let lattice = Lattice::new(&info, settings)?;
    // The rotated scan is a source of slices like any other, so the code below treats both alike.
    if settings.rotate_rad != [0.0; 3] {
        let mut turned = Turned::new(source, lattice, settings.rotate_rad)?;
        return slice_scan(&mut turned, &settings.as_turned(), diagnostics);
    }
    let settings = &as_fine_as_pixels(settings, &lattice);
    let survey = Survey::run(source, &lattice, settings, diagnostics)?;
    let job = Job { settings, lattice: &lattice, survey: &survey, mode: lattice.mode(settings) };
    job.begin_layers(diagnostics)?;
    let all = job.collect(source, 0..lattice.z_mm.len(), diagnostics)?;
    let (not_finite, range) = (all.not_finite, all.range);
    let absent = source.n_absent();
    let made = job.finish(all, diagnostics)?;
    warn_of_values(not_finite, range, &info, diagnostics);
    if absent > 0 {
        let text = format!("{absent} chunks of the scan are not there; they have its fill value");
        diagnostics.warn(WarningId::ScanChunksMissing, text);
    }
    Ok(made)
}

/// The settings without bends of less than a tenth of a pixel: these are noise, and every point costs time when sections
/// are offset.
fn as_fine_as_pixels(settings: &CtSettings, lattice: &Lattice) -> CtSettings {
    let simplify_mm = settings.simplify_mm.max(0.1 * lattice.pixel_mm().min_element());
    CtSettings { simplify_mm, ..settings.clone() }
}

/// Warns of grey values that are not finite, and of those that lost their lower digits as `f32`.
fn warn_of_values(not_finite: u64, (low, high): (f32, f32), info: &VolumeInfo, diagnostics: &Diagnostics) {
    let is_exact = matches!(
        info.sample,
        SampleType::U8 | SampleType::I8 | SampleType::U16 | SampleType::I16 | SampleType::F32
    );
    let steps = f64::from(high - low) / (f64::from(low.abs().max(high.abs())) * f64::from(f32::EPSILON));
    if !is_exact && steps < MIN_STEPS {
        let steps = counted(steps.round() as usize, "step");
        let text =
            format!("the grey values lie from {low} to {high}, where float32 has {steps} between them");
        diagnostics.warn(WarningId::ScanValuesRounded, text);
    }

    if not_finite > 0 {
        let n_voxels: u64 = info.size.iter().map(|&n| n as u64).product();
        let share = 100.0 * not_finite as f64 / n_voxels as f64;
        let what = if info.padded { "padding" } else { "NaN or infinite" };
        let text = format!("{not_finite} voxels ({share:.3} %) are {what}; they are taken for air");
        diagnostics.warn(WarningId::ScanNotFinite, text);
    }
}

/// The slices of a scan one after another, cropped and mirrored as the job states.
pub struct Slices<'a> {
    source: Box<dyn SliceSource + 'a>,
    lattice: Lattice,
}

impl<'a> Slices<'a> {
    /// Starts at the first slice that is taken.
    ///
    /// # Errors
    /// [`ScanError`]: no voxel size, a window or crop outside the scan, files that can no longer be read.
    pub fn new(source: &'a mut dyn SliceSource, settings: &CtSettings) -> Result<Self, ScanError> {
        let mut lattice = Lattice::new(&source.info().clone(), settings)?;
        let mut source: Box<dyn SliceSource + 'a> = if settings.rotate_rad == [0.0; 3] {
            Box::new(source)
        } else {
            let turned = Turned::new(source, lattice, settings.rotate_rad)?;
            lattice = Lattice::new(turned.info(), &settings.as_turned())?;
            Box::new(turned)
        };
        source.restart()?;
        for _ in 0..lattice.first {
            source.skip_slice()?;
        }
        Ok(Self { source, lattice })
    }

    /// Columns, rows and slices.
    pub fn size(&self) -> [usize; 3] {
        [self.lattice.nx, self.lattice.ny, self.lattice.z_mm.len()]
    }

    /// Distance of voxels, mm.
    pub fn spacing_mm(&self) -> [f64; 3] {
        self.lattice.spacing_mm
    }

    /// Heights of the centres of the slices above the lower face of the lowest voxel, mm. They are in the
    /// order of reading, which is falling where z is mirrored.
    pub fn heights_mm(&self) -> Vec<f64> {
        self.lattice.z_mm.iter().map(|z| z + self.lattice.ends_mm[0]).collect()
    }

    /// The next slice, row by row.
    ///
    /// # Errors
    /// [`ScanError`] for files that cannot be read, and after the last slice.
    pub fn next_slice(&mut self) -> Result<Vec<f32>, ScanError> {
        let mut slice = Vec::new();
        if !self.source.next_slice(&mut slice)? {
            return Err(ScanError::EndsEarly);
        }
        Ok(self.lattice.cropped(slice))
    }
}

/// A slice that is ready for tracing.
struct Prepared {
    /// Grey value minus threshold: positive inside the material, zero at its border.
    signed: Vec<f32>,
    /// The section, where layers are made from sections.
    region: Option<Region>,
    inside: usize,
    range: (f32, f32),
    lost: Lost,
}

/// Counts of islands and holes that were too small, and of contour points without an edge.
#[derive(Debug, Clone, Copy, Default)]
struct Lost {
    islands: usize,
    pores: usize,
    /// Points of Canny's contours, and how many of them have no edge.
    points: [usize; 2],
}

impl Lost {
    fn add(&mut self, other: Self) {
        self.islands += other.islands;
        self.pores += other.pores;
        (0..2).for_each(|k| self.points[k] += other.points[k]);
    }
}

struct Job<'a> {
    settings: &'a CtSettings,
    lattice: &'a Lattice,
    survey: &'a Survey,
    mode: Interpolation,
}

/// The result of a slab: its layers by number, what was dropped, and events.
type SlabLayers = (Vec<(usize, Region)>, Lost, Events);

/// Two neighbouring slices and their heights.
struct Between {
    lower: Arc<Prepared>,
    upper: Arc<Prepared>,
    z: [f64; 2],
}

impl Job<'_> {
    /// Refuses heights that give no layers or too many, and begins their progress.
    fn begin_layers(&self, diagnostics: &Diagnostics) -> Result<(), ScanError> {
        let l = self.lattice;
        let n = l.z_mm.len();
        let height = (l.z_mm[n - 1] - l.z_mm[0]).abs() + l.ends_mm[0] + l.ends_mm[1];
        let expected = height / self.settings.layer_height_mm;
        if expected > MAX_LAYERS {
            return Err(ScanError::TooManyLayers {
                n: expected as usize,
                height_mm: self.settings.layer_height_mm,
                limit: MAX_LAYERS as usize,
            });
        }
        if height < 0.5 * self.settings.first_layer_height_mm {
            let first_layer_mm = self.settings.first_layer_height_mm;
            return Err(ScanError::TooFlat { height_mm: height, first_layer_mm });
        }
        diagnostics.begin(Stage::Slice, expected.ceil() as usize);
        Ok(())
    }

    /// The layers between each of these slices and the slice just below it. The slice below the first one is read too, but
    /// counted in the part that holds it. `source` stands before the first slice of the file.
    fn collect(
        &self,
        source: &mut dyn SliceSource,
        slices: Range<usize>,
        diagnostics: &Diagnostics,
    ) -> Result<Collected, ScanError> {
        let l = self.lattice;
        let n = l.z_mm.len();
        let from = slices.start.saturating_sub(1);
        // Enough slices for every thread, and at most 256 MiB of them.
        let batch =
            (2 * rayon::current_num_threads()).clamp(2, 64).min(((256 << 20) / (4 * l.nx * l.ny)).max(1));
        let mut all = Collected { start_mm: self.survey.start_mm, ..Collected::default() };
        // Reading is often slower than tracing (packed files, network drives), so it runs beside it.
        let before = std::thread::scope(|scope| -> Result<u64, ScanError> {
            // The reader is ahead by two slices at most. It ends when the receiver is gone.
            let (send, receive) = sync_channel::<Result<Vec<f32>, SliceError>>(2);
            let (source, end) = (&mut *source, slices.end);
            let reader = scope.spawn(move || {
                // Non-finite voxels read before the first slice of this part; another part of the scan counts them.
                let mut below = 0;
                let read = |source: &mut dyn SliceSource, below: &mut u64| -> Result<(), SliceError> {
                    for _ in 0..l.first + from {
                        source.skip_slice()?;
                    }
                    for k in from..end {
                        let mut slice = Vec::new();
                        source.next_known(&mut slice)?;
                        if k < slices.start {
                            *below = source.n_not_finite();
                        }
                        if send.send(Ok(l.cropped(slice))).is_err() {
                            return Ok(());
                        }
                    }
                    Ok(())
                };
                if let Err(e) = read(source, &mut below) {
                    let _ = send.send(Err(e));
                }
                below
            });
            let mut last: Option<Arc<Prepared>> = None;
            let mut k = from;
            while k < end {
                diagnostics.check().map_err(ScanError::from)?;
                let mut raw = Vec::with_capacity(batch);
                while raw.len() < batch.min(end - k) {
                    raw.push(receive.recv().map_err(|_| ScanError::EndsEarly)??);
                }
                // Collected in order, so that the result is the same for any number of threads.
                let ready: Vec<Arc<Prepared>> =
                    raw.into_par_iter().map(|values| Arc::new(self.prepare(values))).collect();
                let mut slabs = Vec::with_capacity(ready.len() + 2);
                for slice in ready {
                    if k >= slices.start {
                        all.count(&slice);
                    }
                    let z = l.z_mm[k];
                    match last.take() {
                        // The first slice also fills the half slice below it, the last one the half slice
                        // above.
                        None if slices.start == 0 => slabs.push(self.end_slab(&slice, 0, true)),
                        None => {}
                        Some(lower) => {
                            slabs.push(Between { lower, upper: Arc::clone(&slice), z: [l.z_mm[k - 1], z] });
                        }
                    }
                    k += 1;
                    if k == n {
                        slabs.push(self.end_slab(&slice, n - 1, false));
                    }
                    last = Some(slice);
                }
                self.layers_of(slabs, &mut all, diagnostics)?;
            }
            drop(receive);
            Ok(reader.join().unwrap_or_default())
        })?;
        all.not_finite = source.n_not_finite() - before;
        Ok(all)
    }

    /// Height at which the part begins. It lies in the first slab with material. `source` stands before the first slice.
    fn find_start(
        &self,
        source: &mut dyn SliceSource,
        diagnostics: &Diagnostics,
    ) -> Result<Option<f64>, ScanError> {
        let l = self.lattice;
        for _ in 0..l.first {
            source.skip_slice()?;
        }
        let mut last: Option<Arc<Prepared>> = None;
        for k in 0..l.z_mm.len() {
            diagnostics.check().map_err(ScanError::from)?;
            let mut slice = Vec::new();
            if !source.next_known(&mut slice)? {
                return Err(ScanError::EndsEarly);
            }
            let slice = Arc::new(self.prepare(l.cropped(slice)));
            let slab = match last.take() {
                None => self.end_slab(&slice, 0, true),
                Some(lower) => Between { lower, upper: Arc::clone(&slice), z: [l.z_mm[k - 1], l.z_mm[k]] },
            };
            if let Some(start_mm) = self.start(&slab) {
                return Ok(Some(start_mm));
            }
            last = Some(slice);
        }
        Ok(None)
    }

    /// The half slice below the first slice or above the last one.
    fn end_slab(&self, slice: &Arc<Prepared>, k: usize, first: bool) -> Between {
        let l = self.lattice;
        let z = l.z_mm[k];
        // In a scan taken upside down, the first slice read is the highest.
        let below = first != l.flip[2];
        let end = if below { z - l.ends_mm[0] } else { z + l.ends_mm[1] };
        Between { lower: Arc::clone(slice), upper: Arc::clone(slice), z: [z, end] }
    }

    /// Finds the section of a slice. NaN stands for no value and is taken for air: the least value of the slice.
    fn prepare(&self, mut values: Vec<f32>) -> Prepared {
        let least = values.iter().copied().fold(f32::INFINITY, f32::min);
        let air = if least.is_finite() { least } else { self.survey.air as f32 };
        values.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = air);
        let (nx, ny) = (self.lattice.nx, self.lattice.ny);
        let how = match self.settings.denoise {
            Denoise::None => Smoothing::None,
            Denoise::Gaussian(px) => Smoothing::Gaussian(px),
            Denoise::Median => Smoothing::Median,
            // 15 % of the step from air to material counts as an edge: noise is usually below, a face
            // above.
            Denoise::Edges => Smoothing::Edges(0.15 * self.survey.contrast),
        };
        let values = crate::smooth::smoothed(values, nx, ny, how);
        let range = values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        let signed: Vec<f32> = values.iter().map(|&v| self.survey.signed(v)).collect();
        let inside = signed.iter().filter(|v| **v > 0.0).count();
        let mut lost = Lost::default();
        // For interpolated grey values sections are made per layer, so none is needed here.
        let region = (self.mode != Interpolation::Grey).then(|| {
            let step = self.survey.contrast as f32;
            let mut contours = SignedImage::new(&signed, nx, ny).with_flats(|_| step).contours();
            // Points are kept denser than in the result, because pairing needs them.
            let mut simplify_mm = 0.2 * self.settings.simplify_mm;
            if self.settings.tracing == Tracing::Canny {
                let [low, high, sigma_px] = self.settings.canny;
                let canny = CannySettings {
                    sigma_px,
                    low: low * self.survey.contrast,
                    high: high * self.survey.contrast,
                };
                (contours, lost.points) =
                    edges::on_edges(contours, &values, nx, ny, &canny, |c| self.is_clear(c, &signed));
                // Points scattered by noise carry no shape, and all of them would be offset later.
                simplify_mm = self.settings.simplify_mm;
            }
            self.without_specks(self.section(contours, simplify_mm), &mut lost)
        });
        Prepared { signed, region, inside, range, lost }
    }

    /// Whether a contour in pixels encloses a pixel that is plainly material or, for a hole, plainly air.
    fn is_clear(&self, contour: &Contour, signed: &[f32]) -> bool {
        let (nx, ny) = (self.lattice.nx, self.lattice.ny);
        let Some(bounds) = grainpath_core::Bounds2::around_points(contour.iter().copied()) else {
            return false;
        };
        let side = if signed_area_mm2(contour) > 0.0 { 1.0 } else { -1.0 };
        let least = (CLEAR * self.survey.contrast) as f32;
        let index = |v: f64, n: usize| v.clamp(0.0, n as f64) as usize;
        (index(bounds.min.y, ny)..index(bounds.max.y + 1.0, ny)).any(|j| {
            (index(bounds.min.x, nx)..index(bounds.max.x + 1.0, nx)).any(|i| {
                let p = DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
                side * signed[j * nx + i] > least && grainpath_core::poly::even_odd_contains([contour], p)
            })
        })
    }

    /// The region that contours in pixels enclose, in mm.
    fn section(&self, contours: Vec<Contour>, simplify_mm: f64) -> Region {
        let contours = contours.into_iter().map(|c| self.lattice.to_mm(c));
        // Slivers below a hundredth of a pixel come from values of exactly zero.
        let least = 0.01 * self.lattice.spacing_mm[0] * self.lattice.spacing_mm[1];
        let contours: Vec<Contour> = contours
            .filter(|c| signed_area_mm2(c).abs() > least)
            .map(|c| trace::traced_in_place(&c, simplify_mm))
            .filter(|c| c.len() > 2)
            .collect();
        Region::from_contours(&contours, FillRule::Positive)
    }

    fn without_specks(&self, mut region: Region, lost: &mut Lost) -> Region {
        let s = self.settings;
        let before = region.polygons.len();
        region.polygons.retain(|p| signed_area_mm2(&p.outer) >= s.min_island_mm2);
        lost.islands += before - region.polygons.len();
        for p in &mut region.polygons {
            let before = p.holes.len();
            p.holes.retain(|h| -signed_area_mm2(h) >= s.min_pore_mm2);
            lost.pores += before - p.holes.len();
        }
        region
    }

    /// The section of a slice.
    fn region(&self, slice: &Prepared) -> Region {
        slice.region.clone().unwrap_or_else(|| {
            let grid = SignedImage::new(&slice.signed, self.lattice.nx, self.lattice.ny);
            self.without_specks(
                self.section(grid.contours(), self.settings.simplify_mm),
                &mut Lost::default(),
            )
        })
    }

    /// Makes the layers whose centres lie in these slabs.
    fn layers_of(
        &self,
        slabs: Vec<Between>,
        all: &mut Collected,
        diagnostics: &Diagnostics,
    ) -> Result<(), ScanError> {
        if all.start_mm.is_none() {
            all.start_mm = slabs.iter().find_map(|slab| self.start(slab));
        }
        let Some(start) = all.start_mm else { return Ok(()) };
        let made: Vec<Result<SlabLayers, ScanError>> = slabs
            .into_par_iter()
            .map(|slab| {
                diagnostics.check()?;
                let made = self.slab_layers(&slab, start);
                diagnostics.advance(made.0.len());
                Ok(made)
            })
            .collect();
        for slab in made {
            let (layers, lost, events) = slab?;
            all.layers.extend(layers);
            all.lost.add(lost);
            all.events.births += events.births;
            all.events.deaths += events.deaths;
            all.events.branches += events.branches;
        }
        Ok(())
    }

    /// Height at which the part begins, if it begins in this slab: where most of the upper slice's
    /// material appears.
    fn start(&self, slab: &Between) -> Option<f64> {
        let least = self.settings.min_island_mm2 / (self.lattice.spacing_mm[0] * self.lattice.spacing_mm[1]);
        if (slab.upper.inside as f64) < least.max(1.0) {
            return None;
        }
        let region = self.region(&slab.upper);
        if region.is_empty() {
            return None;
        }
        if Arc::ptr_eq(&slab.lower, &slab.upper) {
            return Some(slab.z[0].min(slab.z[1]));
        }
        // Specks beside the part must not move its bottom.
        let largest = region.polygons.iter().max_by(|a, b| a.area_mm2().total_cmp(&b.area_mm2()))?;
        let share = self.change_share(slab, &largest.outer, false);
        Some(slab.z[0] + share * (slab.z[1] - slab.z[0]))
    }

    /// Fraction of the way at which the inside of a contour changes between air and material: the median
    /// over its pixels.
    fn change_share(&self, slab: &Between, contour: &Contour, of_lower: bool) -> f64 {
        let l = self.lattice;
        let Some(bounds) = grainpath_core::Bounds2::around_points(contour.iter().copied()) else {
            return 0.5;
        };
        let size = l.pixel_mm();
        let (low, high) = (bounds.min / size - 0.5, bounds.max / size - 0.5);
        let index = |v: f64, n: usize| v.clamp(0.0, (n - 1) as f64) as usize;
        let (i0, i1) = (index(low.x.ceil(), l.nx), index(high.x.floor(), l.nx));
        let (j0, j1) = (index(low.y.ceil(), l.ny), index(high.y.floor(), l.ny));
        // A few thousand pixels give the median as well as all of them.
        let pixels = (j1 + 1).saturating_sub(j0) * (i1 + 1).saturating_sub(i0);
        let stride = (pixels as f64 / 4000.0).sqrt().ceil().max(1.0) as usize;
        let mut shares = Vec::new();
        for j in (j0..=j1).step_by(stride) {
            for i in (i0..=i1).step_by(stride) {
                let k = j * l.nx + i;
                let (a, b) = (slab.lower.signed[k], slab.upper.signed[k]);
                let p = DVec2::new(i as f64 + 0.5, j as f64 + 0.5) * size;
                let changes = if of_lower { a > 0.0 && b <= 0.0 } else { a <= 0.0 && b > 0.0 };
                if changes && grainpath_core::poly::even_odd_contains([contour], p) {
                    // The signed values cross zero at this fraction of a straight line between both
                    // slices.
                    shares.push(f64::from(a / (a - b)));
                }
            }
        }
        shares.sort_by(f64::total_cmp);
        shares.get(shares.len() / 2).copied().unwrap_or(0.5)
    }

    fn slab_layers(&self, slab: &Between, start: f64) -> SlabLayers {
        let s = self.settings;
        let (first, h) = (s.first_layer_height_mm, s.layer_height_mm);
        // Layers are cut at their centres, so that faces that lean are neither too large nor too small on
        // average.
        let middle = |i: usize| if i == 0 { 0.5 * first } else { first + (i as f64 - 0.5) * h };
        let (low, high) = (slab.z[0].min(slab.z[1]) - start, slab.z[0].max(slab.z[1]) - start);
        // Number of the first layer whose centre is above `z`.
        let above = |z: f64| {
            if z < 0.5 * first { 0 } else { (((z - first) / h + 0.5).floor() + 1.0).max(1.0) as usize }
        };
        let range = above(low)..above(high);
        let mut lost = Lost::default();
        if range.is_empty() {
            return (Vec::new(), lost, Events::default());
        }
        let share = |i: usize| ((middle(i) + start - slab.z[0]) / (slab.z[1] - slab.z[0])).clamp(0.0, 1.0);
        let (nx, ny) = (self.lattice.nx, self.lattice.ny);
        if self.mode == Interpolation::Grey {
            let layer = |i: usize| {
                let (a, b) = (&slab.lower.signed, &slab.upper.signed);
                let grid =
                    SignedImage::mixed(a, b, share(i) as f32, nx, ny).with_flats(|k| (a[k] - b[k]).abs());
                let region = self.section(grid.contours(), s.simplify_mm);
                (i, self.without_specks(region, &mut lost))
            };
            return (range.map(layer).collect(), lost, Events::default());
        }
        let (lower, upper) = (self.region(&slab.lower), self.region(&slab.upper));
        // A half slice at an end of the scan is bounded by one slice only, whose section holds throughout.
        if Arc::ptr_eq(&slab.lower, &slab.upper) {
            let layer = |i: usize| (i, trace::region_in_place(&lower, s.simplify_mm));
            return (range.map(layer).collect(), lost, Events::default());
        }
        if self.mode == Interpolation::Distance {
            return (self.by_distance(&lower, &upper, range, &share, &mut lost), lost, Events::default());
        }
        let matching = MatchSettings {
            overlap: s.overlap,
            pixel_mm: self.lattice.pixel_mm(),
            features: s.tracing == Tracing::Canny,
        };
        let change = |c: &Contour, of_lower: bool| self.change_share(slab, c, of_lower);
        let matched = Slab::between(&lower, &upper, &matching, &change);
        let layer = |i: usize| {
            let region = trace::region_in_place(&matched.at(share(i)), s.simplify_mm);
            (i, self.without_specks(region, &mut lost))
        };
        (range.map(layer).collect(), lost, matched.events)
    }

    fn by_distance(
        &self,
        lower: &Region,
        upper: &Region,
        range: Range<usize>,
        share: &dyn Fn(usize) -> f64,
        lost: &mut Lost,
    ) -> Vec<(usize, Region)> {
        let bounds = [lower.bounds(), upper.bounds()].into_iter().flatten().reduce(|a, b| a.union(b));
        let Some(bounds) = bounds else { return range.map(|i| (i, Region::default())).collect() };
        let raster = Raster::over(bounds, self.lattice.pixel_mm());
        let distance = |r: &Region, other: &Region| {
            if r.is_empty() {
                // An empty slice gets one constant distance: minus the greatest depth inside the other section. The part
                // then ends halfway between the slices where it is thickest.
                let deepest = signed_distance(other, &raster).into_iter().fold(0.0, f32::max);
                vec![-deepest; raster.nx * raster.ny]
            } else {
                signed_distance(r, &raster)
            }
        };
        let (a, b) = (distance(lower, upper), distance(upper, lower));
        let layer = |i: usize| {
            let grid = SignedImage::mixed(&a, &b, share(i) as f32, raster.nx, raster.ny);
            let contours: Vec<Contour> = grid
                .contours()
                .into_iter()
                .map(|c| c.into_iter().map(|p| raster.to_mm(p)).collect::<Contour>())
                .map(|c| trace::simplified_in_place(&c, self.settings.simplify_mm))
                .collect();
            (i, self.without_specks(Region::from_contours(&contours, FillRule::NonZero), lost))
        };
        range.map(layer).collect()
    }

    fn finish(&self, mut all: Collected, diagnostics: &Diagnostics) -> Result<CtStack, ScanError> {
        let total = self.lattice.nx * self.lattice.ny * self.lattice.z_mm.len();
        let greys = GreyValues(all.range.0, all.range.1);
        let threshold = GreyRange { low: self.survey.low, high: self.survey.high };
        if all.inside == 0 {
            return Err(ScanError::ThresholdTooHigh { threshold, greys });
        }
        if all.inside == total {
            return Err(ScanError::ThresholdTooLow { threshold, greys });
        }
        // In a mirrored scan slabs arrive from the top.
        all.layers.sort_by_key(|l| l.0);
        let (first, h) = (self.settings.first_layer_height_mm, self.settings.layer_height_mm);
        let least_mm3 = self.settings.min_piece_mm3;
        let mut dropped_pieces = 0;
        if least_mm3 > 0.0 {
            let height_mm = |layer: usize| if layer == 0 { first } else { h };
            dropped_pieces = pieces::drop_loose(&mut all.layers, height_mm, least_mm3);
        }
        // Empty layers inside the part stay, since they keep the heights; above it they would be printed
        // as air.
        while all.layers.last().is_some_and(|l| l.1.is_empty()) {
            all.layers.pop();
        }
        let scan_height_mm = all.cut_height_mm(self.lattice);
        let layers: Vec<Layer> = all
            .layers
            .into_iter()
            .filter_map(|(i, region)| {
                Layer::new(first + i as f64 * h, if i == 0 { first } else { h }, region)
            })
            .collect();
        // A part of one layer takes its thickness from the scan, because a whole number of layers may be far off.
        let layers = match (layers.as_slice(), scan_height_mm) {
            ([only], Some(mm)) => Layer::new(mm, mm, only.region().clone()).into_iter().collect(),
            _ => layers,
        };
        let [points, bare] = all.lost.points;
        if points > 0 && points == bare {
            return Err(ScanError::NoEdge { threshold, section: self.settings.section });
        }
        let bounds = layers.iter().filter_map(|l| l.region().bounds()).reduce(grainpath_core::Bounds2::union);
        let Some(bounds) = bounds else {
            return Err(ScanError::OnlySpecks {
                threshold,
                min_island_mm2: self.settings.min_island_mm2,
                greys,
            });
        };
        let z_max = layers.last().map_or(0.0, Layer::z_top_mm);
        // Layers have fixed heights, so a part is printed to the nearest layer; 5 % is worth a warning.
        if let Some(true_mm) = scan_height_mm.filter(|mm| (z_max / mm - 1.0).abs() > 0.05) {
            let text = format!("the scan is {true_mm:.3} mm high and is printed {z_max:.3} mm high");
            diagnostics.warn(WarningId::ScanHeightRounded, text);
        }
        let size = bounds.size();
        let longest = size.max_element().max(z_max);
        // Voxel sizes in wrong units (um for mm) are the usual cause.
        if !(2.0..=2000.0).contains(&longest) {
            let text = format!("the scanned part measures {longest:.3} mm");
            diagnostics.push(
                Warning::new(WarningId::SizeDoubtful, text)
                    .with_remedy("check shape.ct.pixel_mm and shape.ct.slice_mm, or set shape.scale"),
            );
        }
        // One point in twenty without an edge is normal at corners.
        if 20 * bare > points {
            diagnostics.warn(WarningId::ScanEdgesMissing, format!(
                "Canny: along {:.0} % of the contours there is no edge within {} pixels; there they lie where the \
                 threshold is crossed",
                100.0 * bare as f64 / points as f64,
                edges::REACH_PX
            ));
        }
        let report = CtReport {
            voxels: [self.lattice.nx, self.lattice.ny, self.lattice.z_mm.len()],
            spacing_mm: self.lattice.spacing_mm,
            threshold: [self.survey.low, self.survey.high].into_iter().filter(|v| v.is_finite()).collect(),
            interpolation: self.mode.name(),
            bottom_mm: ((all.start_mm.unwrap_or(0.0) + self.lattice.ends_mm[0]) * 1e4).round() / 1e4,
            size_mm: [size.x, size.y, z_max].map(|v| (v * 1e4).round() / 1e4),
            dropped_islands: all.lost.islands,
            dropped_pieces,
            filled_pores: all.lost.pores,
            births: all.events.births,
            deaths: all.events.deaths,
            branches: all.events.branches,
        };
        let stack = LayerStack::new(layers).expect("layers were sorted by height");
        Ok(CtStack { stack, report })
    }
}

/// The results collected so far.
#[derive(Debug, Clone)]
struct Collected {
    start_mm: Option<f64>,
    layers: Vec<(usize, Region)>,
    lost: Lost,
    events: Events,
    inside: usize,
    range: (f32, f32),
    /// Whether there is material in the first and in the last slice read.
    ends: [bool; 2],
    /// Voxels that are not finite in the file.
    not_finite: u64,
}

impl Default for Collected {
    fn default() -> Self {
        Self {
            start_mm: None,
            layers: Vec::new(),
            lost: Lost::default(),
            events: Events::default(),
            inside: 0,
            range: (f32::INFINITY, f32::NEG_INFINITY),
            ends: [false; 2],
            not_finite: 0,
        }
    }
}

impl Collected {
    /// Height of a part that fills the scan from the lowest to the highest slice, mm; `None` where it
    /// ends inside.
    fn cut_height_mm(&self, lattice: &Lattice) -> Option<f64> {
        let (low, high) =
            lattice.z_mm.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &z| (l.min(z), h.max(z)));
        (self.ends == [true; 2]).then_some(high - low + lattice.ends_mm[0] + lattice.ends_mm[1])
    }

    fn count(&mut self, slice: &Prepared) {
        let any = slice.inside > 0;
        if self.range.0 > self.range.1 {
            self.ends[0] = any;
        }
        self.ends[1] = any;
        self.inside += slice.inside;
        self.range = (self.range.0.min(slice.range.0), self.range.1.max(slice.range.1));
        self.lost.add(slice.lost);
    }
}

#[cfg(test)]
mod figures;
#[cfg(test)]
mod tests;
