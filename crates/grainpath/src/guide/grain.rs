//! A guide from the grain in photographs or in a scan: directions and curves for every layer.
//!
//! Method: the board is found in a photograph by given corners, by its outline or by printed markers, and
//! rectified. A median removes specks. The structure tensor gives the directions (`bigun1987`), edge
//! detection the curves (`canny1986`). Curves at more than 0.6 rad to the grain are left out: they are
//! cracks, nails or saw marks. The part's borders, and in mode `Edges` the curves, bend the directions near
//! them. Between photographs of several heights directions are interpolated in double angles. A curve of the
//! nearer photograph is moved part of the way towards its partner in the other, if at least three fifths of
//! its points have that line nearest, within 3 mm. The method for curves is our own; it rests on growth lines
//! moving little from one photograph to the next. A scan gives directions from its texture in space, and no
//! curves.
//!
//! Three frames are in use: pixels of the photograph, mm of the rectified picture from its lower left corner,
//! and mm of the part. Heights are in mm above the plate, angles in radians. The grain may shift sideways
//! with height, as around an inclined knot. Cost: linear in the pixels; the rectified picture has at most 16
//! million pixels where their size is not given.
//!
//! Degenerate cases: a picture whose brightness varies by less than 0.004 of white is an error. Grain of low
//! coherence gives a warning. Below the lowest photograph and above the highest one, that photograph counts.
//! Where the part reaches beyond a scan the nearest directions are taken, with a warning.

use std::f64::consts::PI;

use grainpath_core::math::{direction, rotated};
use grainpath_core::slices::SliceSource;
use grainpath_core::{
    Bounds2, DVec2, DVec3, Diagnostics, DirectionField, DirectionSample, Region, WarningId,
};
use serde::Serialize;

use grainpath_core::buckets::PointGrid2;
use grainpath_core::polyline::length_mm;
use grainpath_imaging::canny::{CannySettings, Edges, canny};
use grainpath_imaging::metric::MetricImage;
use grainpath_imaging::photo::Photo;
use grainpath_imaging::photo::corners::{CornersNotFound, find_corners};
use grainpath_imaging::photo::edge_curves::{CurveSettings, along_grain, edge_curves};
use grainpath_imaging::photo::markers::{Sheet, find_markers};
use grainpath_imaging::photo::warp::{CornerError, Shrinking, check_corners, native_px_mm, rectify};
use grainpath_imaging::photo::width_side::{FITS, Turn, oriented, stretched};
use grainpath_imaging::raster::Grey;
use grainpath_imaging::scan::texture::{
    AxisVolume, ShownSlice, TextureReport, TextureSettings, read_texture,
};
use grainpath_imaging::scan::{ScanError, Slices};
use grainpath_imaging::structure_tensor::{
    AxisGrid, AxisSample, Guideline, Tangent, TensorSettings, along_lines, border_lines, grain_axes,
};

/// Position of the board's corners in a photograph.
#[derive(Debug, Clone, PartialEq)]
pub enum Corners {
    /// At these pixels: upper left, upper right, lower right, lower left; one set for all
    /// photographs, or one for each.
    Given(Vec<[DVec2; 4]>),
    /// The corners of the photograph itself, because the board fills the whole picture.
    Image,
    /// The corners of the board's outline on a plain background.
    Outline,
    /// The markers of a printed sheet.
    Markers,
}

/// Which lines the beads follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Along the directions of the grain.
    Field,
    /// Along the edges of the picture, with further lines between them.
    Edges,
}

/// Settings for reading photographs.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainSettings {
    /// Position of the board in the photographs.
    pub corners: Corners,
    /// Width and height of the area between the corners, mm.
    pub size_mm: DVec2,
    /// Position of the lower left corner on the part, mm.
    pub origin_mm: DVec2,
    /// Rotation of the picture about its lower left corner, counter-clockwise, radians.
    pub rotate_rad: f64,
    /// Whether left and right are exchanged before the rotation.
    pub mirror: bool,
    /// Height that each photograph shows, mm above the plate, ascending.
    pub heights_mm: Vec<f64>,
    /// Horizontal displacement of the grain for each millimetre upwards: the knot's inclination.
    pub shift_mm_per_mm: DVec2,
    /// Which lines the beads follow.
    pub mode: Mode,
    /// Side of a pixel of the rectified picture, mm; `None` takes that of the photograph.
    pub pixel_mm: Option<f64>,
    /// Standard deviation of the Gaussian filter against noise, mm; `None` for 1.3 pixels, at least
    /// 0.12 mm.
    pub blur_mm: Option<f64>,
    /// Radius of the median filter against specks, pixels.
    pub median_px: usize,
    /// Thresholds of the edge detection.
    pub canny: CannySettings,
    /// Settings for joining edges into curves.
    pub curves: CurveSettings,
    /// Neighbourhood over which the direction is averaged, mm.
    pub integration_mm: f64,
    /// Distance over which clear directions spread into places with unclear grain, mm.
    pub smooth_mm: f64,
    /// Borders along which the grain is bent.
    pub tangent: Tangent,
    /// How much closer lines lie where the picture is dark: 0 for no effect, 1 for twice as close
    /// as on average.
    pub darkness: f64,
    /// Whether to keep pictures of the processing steps.
    pub pictures: bool,
}

/// Why a photograph cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum GrainError {
    #[error(transparent)]
    Corners(#[from] CornerError),
    #[error(transparent)]
    NotFound(#[from] CornersNotFound),
    #[error(
        "nothing to see: the brightness between the corners varies by {spread:.4} of white; grain varies by 0.02 and more"
    )]
    Blank { spread: f32 },
}

/// What was found in a photograph.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct PhotoReport {
    pub file: String,
    pub z_mm: f64,
    pub corners_px: [[f64; 2]; 4],
    pub pixel_mm: f64,
    /// Mean coherence of the structure tensor, 0 to 1.
    pub coherence: f64,
    /// Share of the board where the coherence is above 0.3.
    pub clear_share: f64,
    pub curves: usize,
    pub curves_mm: f64,
}

/// The grain at one height, in millimetres of the picture.
struct Slice {
    z_mm: f64,
    axes: AxisGrid,
    curves: Vec<Vec<DVec2>>,
    near: PointGrid2<u32>,
}

/// Source of the directions.
enum Seen {
    /// Photographs, lowest first; at least one once they are read.
    Photos(Vec<Slice>),
    /// A scan, and the height of its lowest voxel above the part's bottom, mm.
    Texture(AxisVolume, f64),
}

/// The grain of a part.
pub struct GrainGuide {
    seen: Seen,
    origin_mm: DVec2,
    turn: DVec2,
    rotate_rad: f64,
    mirror_mm: Option<f64>,
    shift_mm_per_mm: DVec2,
    darkness: f64,
    /// Which lines the beads follow.
    pub mode: Mode,
    /// What was found in each photograph.
    pub photos: Vec<PhotoReport>,
    /// What was found in the scan.
    pub texture: Option<TextureReport>,
    /// The processing steps of each photograph, if pictures were asked for.
    pub photo_steps: Vec<PhotoSteps>,
    /// Slices of the scan over which its directions are drawn, if pictures were asked for.
    pub shown_slices: Vec<ShownSlice>,
}

/// Intermediate results between a photograph and its directions and curves, kept for pictures.
pub struct PhotoSteps {
    /// The photograph as taken, in grey, rows from the top.
    pub photo: Grey,
    /// Corners of the board in it, pixels.
    pub corners: [DVec2; 4],
    /// The board, rectified.
    pub image: MetricImage,
    /// The rectified board without noise.
    pub denoised: MetricImage,
    /// Edges, where they were computed.
    pub edges: Option<Edges>,
    /// Directions.
    pub axes: AxisGrid,
    /// Curves along the edges, in the picture's millimetres.
    pub curves: Vec<Vec<DVec2>>,
}

/// Least coherence over a wide neighbourhood; a photograph below it gives the warning that there is hardly any grain.
const LEAST_COHERENCE: f64 = 0.2;
/// Spread of brightness, as a share of white, below which a picture is blank. Source:
/// derived. One step of an image of 8 bits is 0.0039.
const LEAST_SPREAD: f32 = 0.004;
/// Largest angle between a curve and the grain, radians. Curves with a larger angle are left out: they are
/// cracks, nails or saw marks.
const STRAY_RAD: f64 = 0.6;
/// Standard deviation of the Gaussian filter where none is given, mm.
const BLUR_MM: f64 = 0.12;
/// Largest number of pixels of the rectified picture when its pixel size is not given.
const MAX_PIXELS: f64 = 16e6;

/// Reads at least one photograph, one for each height. `section` gives the part's section at a height;
/// its borders bend the grain.
///
/// # Errors
/// The index of the photograph that failed and its [`GrainError`].
pub fn read_grain(
    photos: &[Photo],
    settings: &GrainSettings,
    section: &dyn Fn(f64) -> Region,
    diagnostics: &Diagnostics,
) -> Result<GrainGuide, (usize, GrainError)> {
    debug_assert_eq!(photos.len(), settings.heights_mm.len());
    let mut guide = GrainGuide {
        seen: Seen::Photos(Vec::new()),
        origin_mm: settings.origin_mm,
        turn: direction(settings.rotate_rad),
        rotate_rad: settings.rotate_rad,
        mirror_mm: settings.mirror.then_some(settings.size_mm.x),
        shift_mm_per_mm: settings.shift_mm_per_mm,
        darkness: settings.darkness,
        mode: settings.mode,
        photos: Vec::new(),
        texture: None,
        photo_steps: Vec::new(),
        shown_slices: Vec::new(),
    };
    let mut slices = Vec::new();
    for (k, (photo, &z_mm)) in photos.iter().zip(&settings.heights_mm).enumerate() {
        let read = read_photo(photo, k, settings, diagnostics).map_err(|e| (k, e))?;
        // The directions are computed in the coordinates of the picture, so the part's borders are
        // mapped into the picture.
        let borders = guide.in_picture(&section(z_mm), guide.shift_at(z_mm, settings.heights_mm[0]));
        let axes = guided_axes(&read, &borders, settings);
        let coherence = read.axes.mean_coherence();
        if read.axes.wide_coherence < LEAST_COHERENCE {
            diagnostics.warn(WarningId::GrainUnclear, format!(
                "{}: hardly any grain to see: its coherence is {:.2} (0 none, 1 perfect; wood has 0.3 and more)",
                photo.name, read.axes.wide_coherence
            ));
        }
        guide.photos.push(PhotoReport {
            file: photo.name.clone(),
            z_mm,
            corners_px: read.corners.map(|c| [round(c.x, 2), round(c.y, 2)]),
            pixel_mm: round(read.image.px_mm, 5),
            coherence: round(coherence, 4),
            clear_share: round(read.axes.clear_share(0.3), 4),
            curves: read.curves.len(),
            curves_mm: round(read.curves.iter().map(|c| length_mm(c, false)).sum(), 1),
        });
        if settings.pictures {
            guide.photo_steps.push(PhotoSteps {
                photo: photo.whole().into_owned(),
                corners: read.corners,
                image: read.image,
                denoised: read.denoised,
                edges: read.edges,
                axes: axes.clone(),
                curves: read.curves.clone(),
            });
        }
        // This index is needed only to move curves towards those of another photograph.
        let near = points_of_lines(if photos.len() > 1 { &read.curves } else { &[] }, 1.0);
        slices.push(Slice { z_mm, axes, curves: read.curves, near });
    }
    guide.seen = Seen::Photos(slices);
    Ok(guide)
}

/// Reads the grain of a part from a scan's texture.
///
/// # Errors
/// As [`read_texture`], and [`ScanError`] for a window or crop outside the scan.
pub(crate) fn read_scan(
    source: &mut dyn SliceSource,
    settings: &TextureSettings,
    diagnostics: &Diagnostics,
) -> Result<GrainGuide, ScanError> {
    let mut slices = Slices::new(source, &settings.scan)?;
    let (n, spacing) = (slices.size(), slices.spacing_mm());
    let size = DVec2::new(spacing[0] * n[0] as f64, spacing[1] * n[1] as f64);
    let top = slices.heights_mm().into_iter().fold(0.0, f64::max) + 0.5 * spacing[2];
    let texture = read_texture(&mut slices, settings, diagnostics)?;
    let turn = direction(settings.rotate_rad);
    let (part, height) = settings.part;
    let middle = part.centre() - rotated(0.5 * size, turn);
    // Without an origin the scan is centred on the part and stands on its bottom.
    let origin = settings.origin_mm.unwrap_or(middle.extend(0.0));
    let guide = GrainGuide {
        seen: Seen::Texture(texture.axes, origin.z),
        origin_mm: origin.truncate(),
        turn,
        rotate_rad: settings.rotate_rad,
        mirror_mm: None,
        shift_mm_per_mm: DVec2::ZERO,
        darkness: settings.darkness,
        mode: Mode::Field,
        photos: Vec::new(),
        texture: Some(texture.report),
        photo_steps: Vec::new(),
        shown_slices: texture.shown,
    };
    let corners =
        [part.min, part.max, DVec2::new(part.min.x, part.max.y), DVec2::new(part.max.x, part.min.y)];
    let outside = corners.map(|c| {
        // Distance of a corner of the part outside the scan, negative inside.
        let p = guide.to_picture(c);
        (-p).max(p - size).max_element()
    });
    let upright = (origin.z).max(height - origin.z - top);
    let beyond = outside.into_iter().fold(upright, f64::max);
    // A distance below one voxel comes from rounding the scan's size.
    if beyond > spacing[0].max(spacing[2]) {
        diagnostics.warn(
            WarningId::ScanTooSmall,
            format!(
                "{}: the part reaches {beyond:.2} mm beyond the scan, where the nearest directions are taken",
                settings.name
            ),
        );
    }
    Ok(guide)
}

/// The points of all lines, each with the number of its line.
fn points_of_lines(lines: &[Vec<DVec2>], cell_mm: f64) -> PointGrid2<u32> {
    let bounds = Bounds2::around_points(lines.iter().flatten().copied());
    let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
    let mut grid = PointGrid2::new(bounds, cell_mm);
    for (line, number) in lines.iter().zip(0..) {
        line.iter().for_each(|&p| grid.insert(p, number));
    }
    grid
}

fn round(v: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (v * scale).round() / scale
}

/// A photograph after all processing steps.
struct Read {
    corners: [DVec2; 4],
    image: MetricImage,
    denoised: MetricImage,
    axes: AxisGrid,
    edges: Option<Edges>,
    curves: Vec<Vec<DVec2>>,
}

fn read_photo(
    photo: &Photo,
    k: usize,
    s: &GrainSettings,
    diagnostics: &Diagnostics,
) -> Result<Read, GrainError> {
    let [w, h] = photo.size();
    let corners = match &s.corners {
        Corners::Given(all) => all[k.min(all.len() - 1)],
        Corners::Image => {
            [(0.0, 0.0), (w as f64, 0.0), (w as f64, h as f64), (0.0, h as f64)].map(DVec2::from)
        }
        Corners::Outline => {
            let found = oriented(find_corners(&photo.whole())?, s.size_mm, DVec2::new(w as f64, h as f64))?;
            let guess = match found.turn {
                Turn::Certain => None,
                Turn::NearlySquare => Some(
                    "the board is nearly square, so its outline does not tell which side is its width; the corner \
                     at the upper left of the photograph was taken as the board's",
                ),
                Turn::ByLens => Some(
                    "seen at this angle either side of the outline may be the board's width, depending on the lens \
                     and on how the photograph was cropped; the side that fits a usual lens better was taken",
                ),
            };
            if let Some(why) = guess {
                diagnostics.warn(WarningId::BoardTurnAssumed, format!("{}: {why}", photo.name));
            }
            found.corners
        }
        Corners::Markers => {
            let found = find_markers(&photo.whole())?;
            if found.sheet == Sheet::OneWhite {
                diagnostics.warn(
                    WarningId::MarkerSheetOld,
                    format!(
                        "{}: on this marker sheet a mirrored photograph looks like a good one",
                        photo.name
                    ),
                );
            }
            found.corners
        }
    };
    check_corners(corners, w, h)?;
    let off = stretched(corners, s.size_mm, DVec2::new(w as f64, h as f64));
    if off > FITS {
        diagnostics.warn(
            WarningId::PhotoProportions,
            format!(
                "{}: for its height the board is {off:.2} times as wide or as narrow as its size of {} x {} mm; its \
                 grain was stretched to fit",
                photo.name, s.size_mm.x, s.size_mm.y
            ),
        );
    }
    let native = native_px_mm(corners, s.size_mm);
    let coarsest = (s.size_mm.x * s.size_mm.y / MAX_PIXELS).sqrt();
    // Pixels smaller than half the standard deviation of the Gaussian filter add no detail.
    let needed = 0.5 * s.blur_mm.unwrap_or(BLUR_MM).max(0.02);
    let pixel_mm = s.pixel_mm.unwrap_or(native.max(coarsest).max(needed));
    let image = rectify(photo, corners, s.size_mm, pixel_mm);
    // The spread is taken from the 2nd to the 98th percentile, so that a few specks do not make a blank
    // picture look like grain.
    let spread = image.grey.spread(0.02, 0.98);
    if spread < LEAST_SPREAD {
        return Err(GrainError::Blank { spread });
    }
    let tensor = TensorSettings {
        gradient_mm: 0.15,
        integration_mm: s.integration_mm.max(2.0 * image.px_mm),
        smooth_mm: s.smooth_mm,
    };
    let in_mm = |grey: Grey| MetricImage { grey, min_mm: image.min_mm, px_mm: image.px_mm };
    let cleaned = in_mm(image.grey.median(s.median_px));
    let blur_px = s.blur_mm.map_or((BLUR_MM / image.px_mm).max(1.3), |mm| mm / image.px_mm);
    let wanted = s.mode == Mode::Edges || s.pictures;
    // Tracing curves uses one thread, and most of the computation of directions does too, so both run at
    // the same time.
    let (axes, (denoised, edges, curves)) = rayon::join(
        || grain_axes(&cleaned, &tensor),
        || {
            let denoised = in_mm(cleaned.grey.blurred(blur_px));
            let edges = wanted.then(|| canny(&denoised.grey, &s.canny));
            let curves = edges.as_ref().map(|e| edge_curves(e, &denoised, &s.curves)).unwrap_or_default();
            (denoised, edges, curves)
        },
    );
    let curves = along_grain(curves, &axes, STRAY_RAD, s.curves.min_length_mm);
    Ok(Read { corners, image, denoised, axes, edges, curves })
}

/// The axes of the photograph, bent along the part's borders and, in mode `Edges`, along the curves.
fn guided_axes(read: &Read, borders: &Region, s: &GrainSettings) -> AxisGrid {
    let mut lines = border_lines(borders, s.tangent);
    if s.mode == Mode::Edges {
        lines.extend(read.curves.iter().map(|c| Guideline { points: c, closed: false, weight: 1.0 }));
    }
    if lines.is_empty() {
        return read.axes.clone();
    }
    // In mode `Edges` the lines between the curves have to follow the curves closely, so the axes of
    // the picture keep only a fifth of their weight.
    along_lines(&read.axes, &lines, if s.mode == Mode::Edges { 0.2 } else { 1.0 }, s.smooth_mm.max(0.3))
}

impl GrainGuide {
    fn shift_at(&self, z_mm: f64, from_mm: f64) -> DVec2 {
        (z_mm - from_mm) * self.shift_mm_per_mm
    }

    /// Maps a point of the part to the picture. The caller has already subtracted the grain's shift from `p`.
    pub fn to_picture(&self, p: DVec2) -> DVec2 {
        let back = DVec2::new(self.turn.x, -self.turn.y);
        let p = rotated(p - self.origin_mm, back);
        self.mirror_mm.map_or(p, |w| DVec2::new(w - p.x, p.y))
    }

    /// Maps a point of the rectified picture to the part. The caller adds the grain's shift.
    pub fn to_part(&self, p: DVec2) -> DVec2 {
        let p = self.mirror_mm.map_or(p, |w| DVec2::new(w - p.x, p.y));
        rotated(p, self.turn) + self.origin_mm
    }

    fn in_picture(&self, region: &Region, shift: DVec2) -> Region {
        let mut out = region.clone();
        for polygon in &mut out.polygons {
            let contours = std::iter::once(&mut polygon.outer).chain(&mut polygon.holes);
            contours.flatten().for_each(|p| *p = self.to_picture(*p - shift));
        }
        out
    }

    /// The axis of the scan at a position in the scan's own millimetres; `None` for photographs.
    pub fn scan_axis(&self, p: DVec3) -> Option<AxisSample> {
        match &self.seen {
            Seen::Texture(axes, _) => Some(axes.sample(p)),
            Seen::Photos(_) => None,
        }
    }

    fn sample_seen(&self, p: DVec3) -> AxisSample {
        match &self.seen {
            Seen::Texture(axes, bottom_mm) => {
                axes.sample(self.to_picture(p.truncate()).extend(p.z - bottom_mm))
            }
            Seen::Photos(slices) => {
                let shift = self.shift_at(p.z, slices[0].z_mm);
                let q = self.to_picture(p.truncate() - shift);
                let (low, high, t) = around(slices, p.z);
                let below = low.axes.sample(q);
                if t == 0.0 { below } else { below.towards(high.axes.sample(q), t) }
            }
        }
    }

    /// Factor on the mean line spacing at a point, for lines that are denser where the picture is dark;
    /// 1 if darkness has no effect.
    pub(crate) fn sparseness(&self, p: DVec3) -> f64 {
        if self.darkness <= 0.0 {
            return 1.0;
        }
        let dark = self.sample_seen(p).darkness;
        grainpath_core::math::pow(1.0 + self.darkness, 1.0 - 2.0 * dark)
    }

    /// The direction of the grain at a point of the part, radians, and its coherence. A coherence of 0.3 or
    /// less is returned as 0.
    pub fn asked(&self, p: DVec3) -> (f64, f64) {
        let s = self.sample(p);
        (s.axis_rad, if s.strength > 0.3 { s.strength } else { 0.0 })
    }

    /// Whether the grain is the same at every height.
    pub fn is_upright(&self) -> bool {
        matches!(&self.seen, Seen::Photos(s) if s.len() == 1) && self.shift_mm_per_mm == DVec2::ZERO
    }

    /// Whether lines are denser where the picture is dark.
    pub(crate) fn has_darkness(&self) -> bool {
        self.darkness > 0.0
    }

    /// The curves at a height, in part coordinates, longest first. Between two photographs these are the curves
    /// of the nearer photograph, moved towards those of the other. A scan has no curves.
    pub fn curves(&self, z_mm: f64) -> Vec<Vec<DVec2>> {
        let Seen::Photos(slices) = &self.seen else { return Vec::new() };
        let shift = self.shift_at(z_mm, slices[0].z_mm);
        let (low, high, t) = around(slices, z_mm);
        let mut curves =
            if t == 0.0 || std::ptr::eq(low, high) { low.curves.clone() } else { between(low, high, t) };
        curves.iter_mut().flatten().for_each(|p| *p = self.to_part(*p) + shift);
        curves
    }
}

/// The slices below and above a height, and the height's relative position between them, 0 to 1.
fn around(slices: &[Slice], z_mm: f64) -> (&Slice, &Slice, f64) {
    let above = slices.partition_point(|s| s.z_mm <= z_mm);
    let last = slices.len() - 1;
    let (low, high) = (&slices[above.saturating_sub(1)], &slices[above.min(last)]);
    let rise = high.z_mm - low.z_mm;
    let t = if rise > 1e-9 { ((z_mm - low.z_mm) / rise).clamp(0.0, 1.0) } else { 0.0 };
    (low, high, t)
}

impl DirectionField for GrainGuide {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let s = self.sample_seen(p);
        let own = s.axis_rad();
        // Mirroring reverses the sense of angles; the rotation is applied after it.
        let axis = if self.mirror_mm.is_some() { -own } else { own } + self.rotate_rad;
        DirectionSample { axis_rad: axis.rem_euclid(PI), strength: s.coherence, principal_mpa: None }
    }
}

/// Largest distance between two curves of neighbouring photographs that still show the same growth line, mm.
const SAME_MM: f64 = 3.0;

/// The curves at a height between two photographs. A curve of the nearer photograph that has a partner in the
/// other photograph is moved part of the way to its partner; a curve without a partner stays.
fn between(low: &Slice, high: &Slice, t: f64) -> Vec<Vec<DVec2>> {
    let (from, to, share) = if t < 0.5 { (low, high, t) } else { (high, low, 1.0 - t) };
    from.curves.iter().map(|curve| moved(curve, to, share)).collect()
}

fn moved(curve: &[DVec2], to: &Slice, share: f64) -> Vec<DVec2> {
    let nearest = |p: DVec2| {
        let mut best = (SAME_MM * SAME_MM, None);
        to.near.within(p, SAME_MM).for_each(|(q, line)| {
            let d = q.distance_squared(p);
            if d < best.0 {
                best = (d, Some((line, q - p)));
            }
        });
        best.1
    };
    let found: Vec<Option<(u32, DVec2)>> = curve.iter().map(|&p| nearest(p)).collect();
    // The partner is the line that is nearest to the largest number of points of the curve.
    let mut lines: Vec<u32> = found.iter().flatten().map(|(line, _)| *line).collect();
    lines.sort_unstable();
    let runs = lines.chunk_by(|a, b| a == b).map(|run| (run.len(), run[0]));
    let Some((n, partner)) = runs.fold(
        None,
        |best: Option<(usize, u32)>, run| {
            if best.is_none_or(|b| run.0 > b.0) { Some(run) } else { best }
        },
    ) else {
        return curve.to_vec();
    };
    // If fewer than three fifths of the points lie near the partner, the two curves are different growth lines.
    if 5 * n < 3 * curve.len() {
        return curve.to_vec();
    }
    // The displacements towards the partner are averaged along the curve, so that the moved curve is smooth.
    let steps: Vec<Option<DVec2>> =
        found.iter().map(|f| f.filter(|(l, _)| *l == partner).map(|(_, d)| d)).collect();
    let reach = 20;
    curve
        .iter()
        .enumerate()
        .map(|(k, &p)| {
            let window = &steps[k.saturating_sub(reach)..(k + reach + 1).min(steps.len())];
            let known: Vec<DVec2> = window.iter().copied().flatten().collect();
            let step = if known.is_empty() {
                DVec2::ZERO
            } else {
                known.iter().copied().sum::<DVec2>() / known.len() as f64
            };
            p + share * step
        })
        .collect()
}
