//! Contours on Canny's edges, as published (`tan2020` in docs/references.bib), beside the iso-contours.
//!
//! # Method
//! A Gaussian, Sobel's gradients, non-maximum suppression and two thresholds with hysteresis (`canny1986`) mark the edge
//! pixels. Edges alone are not outlines: they fork where three materials meet, and end where one fades.
//! The iso-contour therefore gives the connections, and each of its points moves along the gradient to
//! the edge, if there is one within 1.5 pixels. The position between pixels is the vertex of a parabola
//! through three gradient magnitudes. A Gaussian moves a curved edge inwards by half its variance over
//! the radius (`verbeek1994`); contours are moved back by this amount. Noise between neighbouring points
//! is smoothed without shrinking the contour (`taubin1995`).
//!
//! # Units, cost and limits
//! Contours are in pixels, with the centre of the first at (0.5, 0.5); thresholds are grey values per
//! pixel. The cost is about ten passes over the slice. Points without an edge move with their neighbours
//! or stay; the caller counts them. Edges of photographs (`crate::canny`) use the same gradient, but are
//! chained from pixels.

use grainpath_core::{Contour, DVec2};

use crate::canny::gradient_row;
use crate::raster::Grey;

/// Parameters of the edge detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CannySettings {
    /// Standard deviation of the Gaussian before the gradients, px.
    pub sigma_px: f64,
    /// Gradient from which edges continue, grey values per pixel.
    pub low: f64,
    /// Gradient from which edges begin, grey values per pixel.
    pub high: f64,
}

/// Distance from the iso-contour within which its edge is sought, px. A larger reach catches edges of
/// neighbouring structures; a smaller one misses edges where the threshold is not halfway between the
/// grey values.
pub(super) const REACH_PX: f64 = 1.5;
/// Half width, in points, of the window that interpolates the shift of contour points without an edge.
/// Points farther from an edge than this stay on the iso-contour.
const BRIDGED: usize = 5;
/// Pixels added around the picture, so that a part that extends beyond it has an edge there. Source: derived. The Gaussian
/// and the gradients need two of them.
const MARGIN: usize = 4;

struct Edges {
    smooth: Grey,
    gx: Vec<f32>,
    gy: Vec<f32>,
    /// 2 for an edge, 0 for none; 1 for a candidate during the search.
    mark: Vec<u8>,
    magnitude: Vec<f32>,
    /// Variance of all smoothing along an edge, px2.
    variance: f64,
}

/// Moves the points of a slice's iso-contours (in pixels, the centre of the first is (0.5, 0.5)) onto the
/// edges.
///
/// A contour without any edge is noise and is left out, unless `clear` says that it encloses pixels that
/// are plainly material or plainly air: in the first and last slice of a dome the faces lean so far that
/// no edge shows. Also returns the number of points and how many of them have no edge within reach; those
/// move as far as their neighbours do, or stay.
pub(super) fn on_edges(
    contours: Vec<Contour>,
    values: &[f32],
    nx: usize,
    ny: usize,
    settings: &CannySettings,
    clear: impl Fn(&Contour) -> bool,
) -> (Vec<Contour>, [usize; 2]) {
    if contours.is_empty() {
        return (contours, [0; 2]);
    }
    // The frame is as dark as the darkest pixel, which is air.
    let dark = values.iter().copied().fold(f32::INFINITY, f32::min);
    let (w, h) = (nx + 2 * MARGIN, ny + 2 * MARGIN);
    let mut framed = Grey::filled(w, h, dark);
    for j in 0..ny {
        let at = (j + MARGIN) * w + MARGIN;
        framed.data[at..at + nx].copy_from_slice(&values[j * nx..(j + 1) * nx]);
    }
    let edges = Edges::find(framed.blurred(settings.sigma_px), settings);
    let shift = DVec2::splat(MARGIN as f64 - 0.5);
    let mut points = [0; 2];
    let moved = |contour: Contour| {
        let ways: Vec<Option<DVec2>> = contour.iter().map(|p| edges.way_to_crest(p + shift)).collect();
        let bare = ways.iter().filter(|w| w.is_none()).count();
        points = [points[0] + ways.len(), points[1] + bare];
        if bare == ways.len() {
            return clear(&contour).then_some(contour);
        }
        Some(evened(&contour.iter().zip(bridged(&ways)).map(|(p, w)| p + w).collect()))
    };
    (contours.into_iter().filter_map(moved).collect(), points)
}

/// The shifts of all points. A point without an edge takes the mean shift of its neighbours, with weights
/// that fall with distance.
fn bridged(ways: &[Option<DVec2>]) -> Vec<DVec2> {
    let n = ways.len();
    let way = |i: usize| {
        ways[i].unwrap_or_else(|| {
            let (mut sum, mut weights) = (DVec2::ZERO, 0.0);
            for d in 1..=BRIDGED.min(n - 1) {
                let weight = 1.0 - d as f64 / (BRIDGED + 1) as f64;
                for way in [ways[(i + d) % n], ways[(i + n - d) % n]].into_iter().flatten() {
                    sum += weight * way;
                    weights += weight;
                }
            }
            // With few or far neighbours the shift fades towards zero instead of being taken over in
            // full.
            sum / f64::max(weights, 0.5)
        })
    };
    (0..n).map(way).collect()
}

/// Evens out the scatter that noise causes between neighbouring points, without shrinking (`taubin1995`).
/// Bows of many points keep their shape.
fn evened(contour: &Contour) -> Contour {
    let n = contour.len();
    let mut c = contour.clone();
    // A smoothing step and a slightly larger step back: 1/0.5 - 1/0.53 = 0.11 is the pass band, near the
    // 0.1 that the paper proposes.
    for share in [0.5, -0.53] {
        let old = c.clone();
        for i in 0..n {
            let mean = 0.5 * (old[(i + 1) % n] + old[(i + n - 1) % n]);
            c[i] += share * (mean - old[i]);
        }
    }
    c
}

impl Edges {
    fn find(smooth: Grey, s: &CannySettings) -> Self {
        let (nx, ny) = (smooth.width, smooth.height);
        let n = nx * ny;
        let (mut gx, mut gy, mut magnitude) = (vec![0.0f32; n], vec![0.0f32; n], vec![0.0f32; n]);
        for j in 1..ny - 1 {
            let row = j * nx..(j + 1) * nx;
            let (gx, gy) = (&mut gx[row.clone()], &mut gy[row.clone()]);
            gradient_row(&smooth, j, gx, gy);
            magnitude[row].iter_mut().zip(gx).zip(gy).for_each(|((m, x), y)| *m = (*x * *x + *y * *y).sqrt());
        }
        // Variances add: the Gaussian's, Sobel's (1/2 along the axes and 5/12 between them, mean 11/24),
        // and 1/6 for values interpolated between four pixels.
        let variance = s.sigma_px * s.sigma_px + 11.0 / 24.0 + 1.0 / 6.0;
        let mut edges = Self { smooth, gx, gy, mark: vec![0; n], magnitude, variance };
        let mut stack = Vec::new();
        // Two pixels of the frame are left out, because `beside` reads one pixel farther.
        for j in 2..ny - 2 {
            for i in 2..nx - 2 {
                let k = j * nx + i;
                if f64::from(edges.magnitude[k]) > s.low && edges.is_ridge(k) {
                    edges.mark[k] = 1;
                    if f64::from(edges.magnitude[k]) > s.high {
                        stack.push(k);
                    }
                }
            }
        }
        // Hysteresis: from strong candidates along connected weak ones.
        while let Some(k) = stack.pop() {
            if std::mem::replace(&mut edges.mark[k], 2) == 2 {
                continue;
            }
            stack.extend(edges.around(k).into_iter().filter(|&m| edges.mark[m] == 1));
        }
        // Candidates that were never reached are noise.
        edges.mark.iter_mut().filter(|m| **m == 1).for_each(|m| *m = 0);
        edges
    }

    /// Gradient magnitudes one pixel before and after a pixel, along its gradient.
    fn beside(&self, k: usize) -> (f32, f32) {
        let (x, y) = (self.gx[k], self.gy[k]);
        let m = self.magnitude[k].max(f32::MIN_POSITIVE);
        let (ux, uy) = (x / m, y / m);
        let sample = |s: f32| {
            let (fx, fy) = ((k % self.smooth.width) as f32 + s * ux, (k / self.smooth.width) as f32 + s * uy);
            let (i, j) = (fx.floor(), fy.floor());
            let (a, b) = (fx - i, fy - j);
            let p = j as usize * self.smooth.width + i as usize;
            let q = &self.magnitude;
            (q[p] * (1.0 - a) + q[p + 1] * a) * (1.0 - b)
                + (q[p + self.smooth.width] * (1.0 - a) + q[p + self.smooth.width + 1] * a) * b
        };
        (sample(-1.0), sample(1.0))
    }

    fn is_ridge(&self, k: usize) -> bool {
        let (before, after) = self.beside(k);
        self.magnitude[k] > before && self.magnitude[k] >= after
    }

    fn around(&self, k: usize) -> [usize; 8] {
        let w = self.smooth.width;
        [k + 1, k + w, k - 1, k - w, k + w + 1, k + w - 1, k - w - 1, k - w + 1]
    }

    /// The gradient at a point between pixels, interpolated linearly.
    fn gradient(&self, p: DVec2) -> DVec2 {
        let (i, j) = (p.x.floor(), p.y.floor());
        let (a, b) = (p.x - i, p.y - j);
        let k = j as usize * self.smooth.width + i as usize;
        let between = |v: &[f32]| {
            let at = |k: usize| f64::from(v[k]);
            let row = |k: usize| at(k) + a * (at(k + 1) - at(k));
            let (low, high) = (row(k), row(k + self.smooth.width));
            low + b * (high - low)
        };
        DVec2::new(between(&self.gx), between(&self.gy))
    }

    /// The shift from a point along its gradient to the place where the gradient is greatest. `None` where that place is out
    /// of reach or no marked edge. A parabola through three slopes has its vertex there; the three are moved until the
    /// vertex lies at the middle one. The displacement by blur is added.
    fn way_to_crest(&self, p: DVec2) -> Option<DVec2> {
        let up = self.gradient(p).try_normalize()?;
        let slopes = |s: f64| [s - 1.0, s, s + 1.0].map(|s| self.gradient(p + s * up).dot(up));
        let mut s = 0.0;
        for _ in 0..6 {
            let [a, b, c] = slopes(s);
            let bend = a - 2.0 * b + c;
            // Where the three slopes have no maximum between them, the search moves towards the greater end.
            let top = if bend < 0.0 { 0.5 * (a - c) / bend } else { f64::INFINITY.copysign(c - a) };
            let step = top.clamp(-0.5, 0.5);
            s += step;
            if s.abs() > REACH_PX {
                return None;
            }
            if step.abs() < 0.02 {
                break;
            }
        }
        let at = (p + s * up).round();
        let k = at.y as usize * self.smooth.width + at.x as usize;
        // Rounding may put the place one pixel beside the marked edge pixel.
        let is_edge = self.mark[k] == 2 || self.around(k).into_iter().any(|m| self.mark[m] == 2);
        is_edge.then(|| (s + self.drawn_inwards(k)) * up)
    }

    /// Distance by which a bent edge has to be moved back up the gradient after smoothing, px. Smoothing moves the
    /// steepest place of a bent edge towards the centre of the bend by half the curvature times the variance
    /// (`verbeek1994`).
    fn drawn_inwards(&self, k: usize) -> f64 {
        let w = self.smooth.width as isize;
        let v = |dx: isize, dy: isize| self.smooth.data[k.wrapping_add_signed(dy * w + dx)];
        let m = self.magnitude[k].max(f32::MIN_POSITIVE);
        let (ux, uy) = (self.gx[k] / m, self.gy[k] / m);
        let (xx, yy) = (v(1, 0) - 2.0 * v(0, 0) + v(-1, 0), v(0, 1) - 2.0 * v(0, 0) + v(0, -1));
        let xy = 0.25 * (v(1, 1) - v(1, -1) - v(-1, 1) + v(-1, -1));
        // Curvature of the line of equal grey at this place, positive where it bends around dark.
        let curvature = (xx * uy * uy - 2.0 * xy * ux * uy + yy * ux * ux) / m;
        // A bend as tight as the smoothing is wide is a corner, for which the formula does not hold; a
        // quarter of a pixel is the limit.
        (0.5 * f64::from(curvature) * self.variance).clamp(-0.25, 0.25)
    }
}

#[cfg(test)]
mod tests {
    use grainpath_core::Region;
    use grainpath_core::math::exp;
    use grainpath_core::poly::{FillRule, signed_area_mm2};

    use super::*;
    use crate::scan::SignedImage;

    const SETTINGS: CannySettings = CannySettings { sigma_px: 1.0, low: 40.0, high: 100.0 };
    const PI: f64 = std::f64::consts::PI;

    /// Signed areas of what is above the threshold, by its edges, and the points that have none.
    fn areas(n: usize, threshold: f32, value: impl Fn(DVec2) -> f64) -> (Vec<f64>, [usize; 2]) {
        let at = |i: usize| value(DVec2::new((i % n) as f64 + 0.5, (i / n) as f64 + 0.5)) as f32;
        let values: Vec<f32> = (0..n * n).map(at).collect();
        let signed: Vec<f32> = values.iter().map(|v| v - threshold).collect();
        let (found, points) =
            on_edges(SignedImage::new(&signed, n, n).contours(), &values, n, n, &SETTINGS, |_| false);
        let mut areas: Vec<f64> = found.iter().map(|c| signed_area_mm2(c)).collect();
        areas.sort_by(f64::total_cmp);
        let covered = Region::from_contours(&found, FillRule::Positive);
        assert_eq!(covered.contours().count(), found.len(), "contours cross");
        assert!((covered.area_mm2() - areas.iter().sum::<f64>()).abs() < 0.05, "contours cross");
        (areas, points)
    }

    fn step(d: f64, blur: f64) -> f64 {
        1.0 / (1.0 + exp(-1.702 * d / blur))
    }

    #[test]
    fn a_noisy_ring_has_its_area_wherever_the_threshold_lies() {
        for threshold in [250.0, 500.0, 700.0] {
            let value = |p: DVec2| {
                let noise = ((p.x * 7919.0 + p.y * 104_729.0) % 97.0) - 48.0;
                let r = p.distance(DVec2::new(60.3, 54.6));
                1000.0 * step(40.0 - r, 1.2) * step(r - 18.0, 1.2) + 0.3 * noise
            };
            let (areas, points) = areas(120, threshold, value);
            let off = |k: usize, r: f64| (areas[k].abs() / (PI * r * r)).sqrt() - 1.0;
            assert_eq!((areas.len(), points[1]), (2, 0), "{areas:?}");
            println!("threshold {threshold}: {:.4} {:.4}", off(0, 18.0), off(1, 40.0));
            assert!(off(0, 18.0).abs() < 2e-3 && off(1, 40.0).abs() < 1e-3, "{areas:?}");
        }
        // A part that fills the picture is closed by the frame; one grey value is no part.
        assert!(areas(20, 50.0, |_| 100.0).0.is_empty());
        let (full, _) = areas(20, 50.0, |p| if p.x < 1.0 { 0.0 } else { 1000.0 });
        assert!(full.len() == 1 && (full[0] - 380.0).abs() < 8.0, "{full:?}");
    }

    #[test]
    fn small_bores_and_pins_keep_their_size() {
        for (radius, blur) in [(8.0, 0.8), (10.0, 0.8), (15.0, 0.8), (10.0, 1.2)] {
            for sign in [-1.0, 1.0] {
                let value =
                    |p: DVec2| 1000.0 * step(sign * (radius - p.distance(DVec2::new(24.2, 23.9))), blur);
                let (areas, _) = areas(48, 450.0, value);
                // A bore is in a plate, which has an outline.
                let area = areas.into_iter().map(|a| a * sign).fold(0.0, f64::max);
                let off = 100.0 * ((area / PI).sqrt() / radius - 1.0);
                println!("radius {radius}, blur {blur}, sign {sign}: {off:.3} %");
                // Left where the gradient is steepest they would be smaller by this, 0.4 to 1.3 %.
                let drawn = 50.0 * 1.6 / (radius * radius);
                assert!(off.abs() < 0.2 * drawn, "radius {radius}, blur {blur}, sign {sign}: {off} %");
            }
        }
    }

    #[test]
    fn a_joint_of_two_metals_leaves_the_outline_whole() {
        // The left half is twice as dense as the right one; the joint between is an edge, and ends on the outline.
        let value = |p: DVec2| {
            let dense = 450.0 + 550.0 * step(48.3 - p.x, 0.8);
            dense * step(35.0 - p.distance(DVec2::new(50.0, 49.0)), 0.8)
        };
        let (areas, points) = areas(100, 225.0, value);
        let off = (areas[0] / (PI * 35.0 * 35.0)).sqrt() - 1.0;
        println!("two metals: {:.4} %, {points:?}", 100.0 * off);
        assert!(areas.len() == 1 && off.abs() < 1e-3, "{areas:?}");
        assert!(20 * points[1] < points[0], "{points:?}");
    }

    #[test]
    fn where_an_edge_fades_the_contour_stays_at_the_threshold() {
        // Sharp on the left, so gentle on the right that Canny finds nothing.
        let value =
            |p: DVec2| if p.x < 30.0 { 1000.0 * step(p.x - 10.0, 0.8) } else { 1000.0 - 18.0 * (p.x - 30.0) };
        let framed = |p: DVec2| value(p) * step(p.y - 10.0, 0.8) * step(90.0 - p.y, 0.8);
        let (areas, points) = areas(100, 300.0, framed);
        // 1000 - 18 (x - 30) = 300 at x = 68.9.
        assert!(areas.len() == 1 && (areas[0] / ((68.9 - 10.0) * 80.0) - 1.0).abs() < 0.01, "{areas:?}");
        assert!(points[1] > 50 && points[1] < points[0] / 2, "{points:?}");
    }
}
