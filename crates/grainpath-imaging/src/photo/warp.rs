//! Rectification: maps a photograph in perspective to a picture in millimetres.
//!
//! # Method
//! A homography takes the four corners of the board to the corners of the picture. Its eight coefficients
//! solve two linear equations for each corner. Each pixel of the picture takes its brightness from its
//! place in the photograph, interpolated linearly from four pixels. Where the photograph has more pixels
//! than the picture, it is halved first, as in a mipmap, and several samples are averaged, so that fine
//! grain does not alias.
//!
//! # Units, cost and limits
//! Photographs are in pixels with rows downwards, the result in mm with its lower left corner at zero.
//! The cost is linear in the pixels of both. The lens is assumed to be free of distortion: sides that
//! a lens has curved stay curved. Corners that lie on a line, are in the wrong order, or enclose less
//! than 32 x 32 pixels are refused.

use std::borrow::Cow;

use grainpath_core::math::cross;
use grainpath_core::{DVec2, DVec3};
use rayon::prelude::*;

use crate::metric::MetricImage;
use crate::raster::{Grey, mix};

/// A projective map of the plane, `(3, 3)` row-major.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Homography([f64; 9]);

impl Homography {
    /// The map that takes four points to four others. `None` where three of them lie on a line.
    pub fn from_points(from: [DVec2; 4], to: [DVec2; 4]) -> Option<Self> {
        let mut rows = [[0.0; 9]; 8];
        for k in 0..4 {
            let (p, q) = (from[k], to[k]);
            // Two linear equations for each pair of points, with the last coefficient fixed at 1.
            rows[2 * k] = [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -p.x * q.x, -p.y * q.x, q.x];
            rows[2 * k + 1] = [0.0, 0.0, 0.0, p.x, p.y, 1.0, -p.x * q.y, -p.y * q.y, q.y];
        }
        let h = solve(rows)?;
        Some(Self([h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0]))
    }

    /// The point to which a point is mapped.
    pub fn map(&self, p: DVec2) -> DVec2 {
        let h = &self.0;
        let w = h[6] * p.x + h[7] * p.y + h[8];
        DVec2::new(h[0] * p.x + h[1] * p.y + h[2], h[3] * p.x + h[4] * p.y + h[5]) / w
    }

    /// The homogeneous image of (0, y), scaled, and its change per step in x. Both are linear in x,
    /// so a pixel in a row costs one division.
    fn along_row(&self, y: f64, scale: f64) -> [DVec3; 2] {
        let h = &self.0;
        let at = |k: usize| DVec3::new(scale * h[k], scale * h[k + 3], h[k + 6]);
        [at(1) * y + at(2), at(0)]
    }

    /// The scale of the map at a point: the length in the image of a unit length here, in x or in y, whichever is
    /// longer.
    fn stretch(&self, p: DVec2, d: f64) -> f64 {
        let o = self.map(p);
        let (u, v) = (self.map(p + DVec2::new(d, 0.0)), self.map(p + DVec2::new(0.0, d)));
        (u - o).length().max((v - o).length()) / d
    }
}

/// Gauss-Jordan elimination with partial pivoting. The last entry of each row is its right-hand side. This matrix is
/// not symmetric, so the Cholesky factors of `grainpath_core::dense` do not serve here.
fn solve(mut rows: [[f64; 9]; 8]) -> Option<[f64; 8]> {
    // Unknowns have very different sizes (mm, pixels), so rows are scaled before pivots are compared.
    for row in &mut rows {
        let largest = row.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        row.iter_mut().for_each(|v| *v /= largest.max(1e-300));
    }
    for k in 0..8 {
        let pivot = (k..8).fold(k, |best, i| if rows[i][k].abs() > rows[best][k].abs() { i } else { best });
        // After scaling, entries are about 1; a pivot at rounding level means that three points lie on a
        // line.
        if rows[pivot][k].abs() < 1e-13 {
            return None;
        }
        rows.swap(k, pivot);
        let lead = rows[k];
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let f = row[k] / lead[k];
            row.iter_mut().zip(lead).for_each(|(v, l)| *v -= f * l);
        }
    }
    Some(std::array::from_fn(|k| rows[k][8] / rows[k][k]))
}

/// Reasons why four corners cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum CornerError {
    #[error("corner {index} ({x:.1}, {y:.1}) is outside the image of {width} x {height} pixels")]
    Outside { index: usize, x: f64, y: f64, width: usize, height: usize },
    #[error(
        "the corners cross or lie on a line; give them as upper left, upper right, lower right, lower left"
    )]
    Crossed,
    #[error("the corners enclose {area_px:.0} pixels; at least {least_px:.0} are needed to see grain")]
    TooSmall { area_px: f64, least_px: f64 },
}

/// Smallest area inside the corners, px2: 32 x 32 pixels. Source: derived. Grain a few pixels wide needs several periods
/// to have a direction.
const LEAST_AREA_PX: f64 = 1024.0;

/// Checks corners in pixels (upper left, upper right, lower right, lower left as seen in the photograph, rows
/// downwards): they must lie inside the image within a pixel, be convex, run in this order, and enclose enough pixels.
///
/// # Errors
/// [`CornerError`].
pub fn check_corners(corners: [DVec2; 4], width: usize, height: usize) -> Result<(), CornerError> {
    let inside = |v: f64, n: usize| (-1.0..=n as f64 + 1.0).contains(&v);
    for (index, c) in corners.iter().enumerate() {
        if !(inside(c.x, width) && inside(c.y, height)) {
            return Err(CornerError::Outside { index: index + 1, x: c.x, y: c.y, width, height });
        }
    }
    let turn = |k: usize| {
        let [a, b, c] = [corners[k], corners[(k + 1) % 4], corners[(k + 2) % 4]];
        cross((b - a).normalize_or_zero(), (c - b).normalize_or_zero())
    };
    // The limit 0.02 is an angle of about one degree. Three corners on a line would leave the map undetermined.
    if (0..4).any(|k| turn(k) < 0.02) {
        return Err(CornerError::Crossed);
    }
    let area_px = 0.5 * (cross(corners[2] - corners[0], corners[3] - corners[1])).abs();
    if area_px < LEAST_AREA_PX {
        return Err(CornerError::TooSmall { area_px, least_px: LEAST_AREA_PX });
    }
    Ok(())
}

/// Mean size on the board of a pixel of the photograph, mm.
pub fn native_px_mm(corners: [DVec2; 4], size_mm: DVec2) -> f64 {
    let area_px = 0.5 * cross(corners[2] - corners[0], corners[3] - corners[1]).abs();
    (size_mm.x * size_mm.y / area_px.max(1.0)).sqrt()
}

/// The brightness of a photograph, in full size and at half the size.
pub trait Shrinking {
    /// Pixels in a row, and rows.
    fn size(&self) -> [usize; 2];
    /// The picture in full size.
    fn whole(&self) -> Cow<'_, Grey>;
    /// The picture with its sides halved once.
    fn halved(&self) -> Grey;
}

impl Shrinking for Grey {
    fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    fn whole(&self) -> Cow<'_, Grey> {
        Cow::Borrowed(self)
    }

    fn halved(&self) -> Grey {
        self.halved()
    }
}

/// The photograph (rows downwards) between four corners as a picture of `size_mm`. Its lower left corner
/// is at zero, and its pixels are about `px_mm`, adjusted to fit the width. Where the photograph is
/// reduced, the pixels that fall into one are averaged.
///
/// The corners must have passed [`check_corners`].
pub fn rectify(photo: &impl Shrinking, corners: [DVec2; 4], size_mm: DVec2, px_mm: f64) -> MetricImage {
    let columns = (size_mm.x / px_mm).round().max(8.0) as usize;
    let px_mm = size_mm.x / columns as f64;
    let rows = (size_mm.y / px_mm).round().max(8.0) as usize;
    let (right, top) = (columns as f64, size_mm.y / px_mm);
    // Pixel coordinates of the result grow upwards, so the upper left corner is at the greatest y.
    let target = [(0.0, top), (right, top), (right, 0.0), (0.0, 0.0)];
    let map = Homography::from_points(target.map(DVec2::from), corners).expect("checked corners are convex");
    let stretch = target.map(|c| map.stretch(DVec2::from(c), 0.5)).into_iter().fold(0.0, f64::max);
    // The source is halved until a step is less than two pixels, as in a mipmap. What remains is averaged
    // from several samples for each pixel.
    let mut level = 1.0;
    let mut smaller: Option<Grey> = None;
    let [width, height] = photo.size();
    while stretch / level >= 2.0 && width as f64 / level > 2.0 && height as f64 / level > 2.0 {
        smaller = Some(smaller.map_or_else(|| photo.halved(), |s| s.halved()));
        level *= 2.0;
    }
    let source = smaller.map_or_else(|| photo.whole(), Cow::Owned);
    // Below 1.15 source pixels for a step one sample is enough; above, 2 x 2 samples prevent aliasing.
    let n = if stretch / level > 1.15 { 2 } else { 1 };
    let mut grey = Grey::filled(columns, rows, 0.0);
    let share = 1.0 / n as f64;
    grey.data.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
        for j in 0..n {
            // Along a row, numerator and denominator of the map are linear.
            let [at, step] = map.along_row(y as f64 + (j as f64 + 0.5) * share, 1.0 / level);
            for i in 0..n {
                add_along(&source, at + (i as f64 + 0.5) * share * step, step, row);
            }
        }
        let share = 1.0 / (n * n) as f32;
        row.iter_mut().for_each(|v| *v *= share);
    });
    MetricImage { grey, min_mm: DVec2::ZERO, px_mm }
}

/// Number of positions that are computed before any of them is looked up, so that the compiler processes
/// several at a time. Source: chosen; it changes only the speed, never the result.
const AT_ONCE: usize = 64;

/// Adds to the k-th entry of `out` the value that [`Grey::sample`] has at the homogeneous pixel `at + k
/// step`.
fn add_along(source: &Grey, at: DVec3, step: DVec3, out: &mut [f32]) {
    let (w, h) = (source.width, source.height);
    let place = |k: usize| {
        let q = at + step * k as f64;
        let w = 1.0 / q.z;
        (q.x * w, q.y * w)
    };
    if w < 2 || h < 2 {
        out.iter_mut().enumerate().for_each(|(k, out)| {
            let (x, y) = place(k);
            *out += source.sample(x, y);
        });
        return;
    }
    // Single precision is exact to a thousandth of a pixel at the far end of the largest photographs.
    let inside = |v: f64, n: usize| ((v - 0.5) as f32).clamp(0.0, n as f32 - 1.0);
    let (mut xs, mut ys) = ([0.0f32; AT_ONCE], [0.0f32; AT_ONCE]);
    for (chunk, out) in out.chunks_mut(AT_ONCE).enumerate() {
        for k in 0..AT_ONCE {
            let (x, y) = place(chunk * AT_ONCE + k);
            (xs[k], ys[k]) = (inside(x, w), inside(y, h));
        }
        for ((out, &x), &y) in out.iter_mut().zip(&xs).zip(&ys) {
            let (i, j) = ((x as i32 as usize).min(w - 2), (y as i32 as usize).min(h - 2));
            let (u, v) = (x - i as f32, y - j as f32);
            // One slice for both rows: a single bounds check covers the four pixels.
            let low = &source.data[j * w + i..][..w + 2];
            *out += mix(mix(low[0], low[1], u), mix(low[w], low[w + 1], u), v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> [DVec2; 4] {
        [(60.0, 50.0), (740.0, 90.0), (700.0, 430.0), (90.0, 360.0)].map(DVec2::from)
    }

    #[test]
    fn spots_come_back_to_their_place() {
        // Spots on a board of 100 x 50 mm, photographed in perspective.
        let size = DVec2::new(100.0, 50.0);
        let board = [(0.0, 50.0), (100.0, 50.0), (100.0, 0.0), (0.0, 0.0)].map(DVec2::from);
        let back = Homography::from_points(corners(), board).expect("convex");
        let spots: Vec<DVec2> = (0..28)
            .map(|i| DVec2::new(7.0 + 14.0 * f64::from(i % 7), 6.0 + 12.0 * f64::from(i / 7)))
            .collect();
        let spot = |p: DVec2| {
            spots.iter().map(|s| grainpath_core::math::exp(-p.distance_squared(*s) / 2.0)).sum::<f64>() as f32
        };
        let photo =
            Grey::from_fn(800, 480, |x, y| spot(back.map(DVec2::new(x as f64 + 0.5, y as f64 + 0.5))));
        for px_mm in [0.08, 0.15, 0.4] {
            let flat = rectify(&photo, corners(), size, px_mm);
            for s in &spots {
                let c = flat.pixel(*s);
                let r = 4.5 / flat.px_mm;
                let (mut sum, mut moment) = (0.0, DVec2::ZERO);
                for y in (c.y - r).max(0.0) as usize..((c.y + r) as usize).min(flat.grey.height) {
                    for x in (c.x - r).max(0.0) as usize..((c.x + r) as usize).min(flat.grey.width) {
                        let v = f64::from(flat.grey.at(x, y));
                        sum += v;
                        moment += v * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    }
                }
                let off = (moment / sum).distance(c);
                assert!(off < 0.2, "{s} is {off:.3} px off at {px_mm} mm");
            }
        }
    }

    #[test]
    fn shrinking_averages() {
        let stripes = Grey::from_fn(640, 320, |x, _| (x % 2) as f32);
        let whole = [(0.0, 0.0), (640.0, 0.0), (640.0, 320.0), (0.0, 320.0)].map(DVec2::from);
        let flat = rectify(&stripes, whole, DVec2::new(100.0, 50.0), 1.3);
        assert!(flat.grey.data.iter().all(|v| (v - 0.5).abs() < 0.1), "moiré: {:?}", flat.grey.quantile(1.0));
    }

    #[test]
    fn bad_corners_are_told_apart() {
        assert_eq!(check_corners(corners(), 800, 480), Ok(()));
        let [a, b, c, d] = corners();
        assert_eq!(check_corners([a, c, b, d], 800, 480), Err(CornerError::Crossed));
        assert_eq!(check_corners([a, d, c, b], 800, 480), Err(CornerError::Crossed));
        assert!(matches!(check_corners([a, b, c, d], 600, 480), Err(CornerError::Outside { index: 2, .. })));
        let tiny = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(DVec2::from);
        assert!(matches!(check_corners(tiny, 800, 480), Err(CornerError::TooSmall { .. })));
    }
}
