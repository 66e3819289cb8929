//! Synthetic boards: growth lines that flow round live knots, with the true direction at every point.

use std::f64::consts::PI;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, pow};

use grainpath_imaging::photo::warp::Homography;
use grainpath_imaging::raster::Grey;

/// A knot: a branch that the board's face cuts across. Growth rings lie inside it and the grain flows
/// round it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// Centre of the knot, mm.
    pub centre_mm: DVec2,
    /// Radius of the branch, mm.
    pub radius_mm: f64,
}

/// A board and the quality of its photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// Width and height, mm; the grain runs along the width.
    pub size_mm: DVec2,
    /// Knots of the board.
    pub knots: Vec<Knot>,
    /// Spacing of growth lines far from knots, mm.
    pub ring_mm: f64,
    /// Amplitude of the waves in the growth lines, mm.
    pub wave_mm: f64,
    /// Standard deviation of the camera's noise, as a share of white.
    pub noise: f64,
    /// Loss of light from one end to the other, 0 to 1.
    pub uneven_light: f64,
    /// Seed of every random number.
    pub seed: u32,
}

impl Default for Board {
    fn default() -> Self {
        Self {
            size_mm: DVec2::new(100.0, 30.0),
            knots: vec![Knot { centre_mm: DVec2::new(50.0, 15.5), radius_mm: 4.0 }],
            ring_mm: 1.5,
            wave_mm: 0.6,
            noise: 0.02,
            uneven_light: 0.3,
            seed: 1,
        }
    }
}

/// Step of the central differences for slopes, mm. Source: derived. It is far below the spacing of growth lines, and far
/// above the rounding of coordinates in mm.
const STEP_MM: f64 = 1e-3;

impl Board {
    /// The point of a board without waves that the waves move to `p`.
    fn unwaved(&self, p: DVec2) -> DVec2 {
        let wave = |x: f64, y: f64, seed: u32| 2.0 * noise(x, y, self.seed.wrapping_add(seed)) - 1.0;
        // Wavelengths of a few centimetres, none a multiple of another, so that no pattern repeats on the
        // board. Waves across the grain have a second, shorter part, because they turn the grain; waves
        // along it only stretch it.
        let shift = DVec2::new(
            wave(p.x / 37.0, p.y / 29.0, 11),
            wave(p.x / 31.0, p.y / 23.0, 12) + 0.4 * wave(p.x / 13.0, p.y / 17.0, 13),
        );
        p + self.wave_mm * shift
    }

    /// Stream function of the grain, mm: growth lines are its contours. Outside knots it is the ideal
    /// flow round a cylinder; inside a knot its contours are rings.
    fn growth(&self, p: DVec2) -> f64 {
        let p = self.unwaved(p);
        let mut height = p.y;
        for knot in &self.knots {
            let d = p - knot.centre_mm;
            let (r2, radius2) = (d.length_squared(), knot.radius_mm * knot.radius_mm);
            // Rings of a knot are spaced a little wider than growth lines of the board: from the knot's centre
            // outwards the function falls by 0.9 mm for each mm.
            if r2 < radius2 {
                return knot.centre_mm.y + 0.9 * (knot.radius_mm - r2.sqrt());
            }
            // The dipole term of the flow round a cylinder: on the rim the sum is constant, so growth
            // lines close round the knot.
            height -= radius2 * d.y / r2;
        }
        height
    }

    /// The knot that contains a point, if there is one.
    fn knot_at(&self, p: DVec2) -> Option<&Knot> {
        let p = self.unwaved(p);
        self.knots.iter().find(|k| p.distance_squared(k.centre_mm) < k.radius_mm * k.radius_mm)
    }

    /// True direction of the grain, radians in `[0, pi)`. `None` within `clear_mm` of places where
    /// the direction is undefined: the rim and the centre of a knot, and the stagnation points before and
    /// after the knot, where the flow parts.
    pub fn axis_rad(&self, p: DVec2, clear_mm: f64) -> Option<f64> {
        let q = self.unwaved(p);
        for knot in &self.knots {
            let d = q - knot.centre_mm;
            let at_rim = (d.length() - knot.radius_mm).abs() < clear_mm;
            // Near a stagnation point and near a knot's centre the direction turns fastest, so twice
            // the distance is kept from both.
            let parts = DVec2::new(d.x.abs() - knot.radius_mm, d.y).length() < 2.0 * clear_mm;
            if at_rim || parts || d.length() < 2.0 * clear_mm {
                return None;
            }
        }
        let slope = |d: DVec2| self.growth(p + d) - self.growth(p - d);
        let g = DVec2::new(slope(DVec2::new(STEP_MM, 0.0)), slope(DVec2::new(0.0, STEP_MM)));
        // The grain is tangent to the contour, a quarter turn from the gradient; modulo pi, since
        // opposite directions are the same grain.
        Some(atan2(g.x, -g.y).rem_euclid(PI))
    }

    /// Brightness of the wood itself at a point, 0 to 1, before the effects of light and camera.
    pub fn brightness(&self, p: DVec2) -> f64 {
        let growth = self.growth(p);
        // Early wood is light and darkens slowly; late wood ends abruptly. The sawtooth gives each
        // ring one soft and one sharp edge.
        let turns = growth / self.ring_mm + 0.35 * noise(growth / 3.1, 0.5, self.seed.wrapping_add(21));
        let phase = turns - turns.floor();
        let ring = if phase < 0.86 { pow(phase / 0.86, 2.5) } else { 1.0 - (phase - 0.86) / 0.14 };
        // Each ring has its own darkness, and fibre streaks run along the grain: structure finer than the
        // rings, which an orientation filter must average out.
        let depth = 0.6 + 0.8 * noise(turns.floor() * 0.37, 7.5, self.seed.wrapping_add(22));
        let fibre = noise(p.x * 0.22, growth * 9.0, self.seed.wrapping_add(23)) - 0.5;
        let inside = if self.knot_at(p).is_some() { 0.22 } else { 0.0 };
        // The clamp keeps the wood off black and white, as a correct exposure would.
        (0.78 - inside - 0.34 * depth * ring + 0.10 * fibre).clamp(0.02, 0.98)
    }

    /// Brightness of the pixel `(x, y)` in the photograph, with uneven light and the camera's noise.
    fn seen(&self, value: f64, p: DVec2, x: usize, y: usize) -> f32 {
        let u = p / self.size_mm;
        let light = 1.0 - self.uneven_light * (0.7 * u.x + 0.3 * u.y * u.y);
        // As in a real camera, the light first scales the brightness and the noise is then added.
        (value * light + self.noise * gauss(x as u32, y as u32, self.seed)).clamp(0.0, 1.0) as f32
    }

    /// The board from straight above, rows from the top, pixels of `px_mm`. `blur_px` is the blur of
    /// the picture.
    pub fn flat(&self, px_mm: f64, blur_px: f64) -> Grey {
        let n = |mm: f64| (mm / px_mm).round().max(1.0) as usize;
        let (w, h) = (n(self.size_mm.x), n(self.size_mm.y));
        let place = |x: f64, y: f64| DVec2::new(x * px_mm, self.size_mm.y - y * px_mm);
        let clean = Grey::from_fn(w, h, |x, y| self.brightness(place(x as f64 + 0.5, y as f64 + 0.5)) as f32);
        // Blur comes before the noise, since a lens blurs and a sensor adds noise afterwards.
        let clean = clean.blurred(blur_px);
        Grey::from_fn(w, h, |x, y| {
            self.seen(clean.at(x, y).into(), place(x as f64 + 0.5, y as f64 + 0.5), x, y)
        })
    }

    /// A photograph of the board on a dark cloth. Its corners (upper left, upper right, lower right,
    /// lower left) are at `corners`, pixels, in a picture of `width` x `height` pixels.
    pub fn photograph(&self, width: usize, height: usize, corners: [DVec2; 4]) -> Grey {
        let s = self.size_mm;
        let board = [(0.0, s.y), (s.x, s.y), (s.x, 0.0), (0.0, 0.0)].map(DVec2::from);
        // Corners on a line have no homography; the picture is then black.
        let Some(back) = Homography::from_points(corners, board) else {
            return Grey::filled(width, height, 0.0);
        };
        let on = |p: DVec2| p.x >= 0.0 && p.y >= 0.0 && p.x <= s.x && p.y <= s.y;
        let cloth = |x: usize, y: usize| {
            0.10 + 0.05 * noise(x as f64 / 3.0, y as f64 / 3.0, self.seed.wrapping_add(31))
        };
        Grey::from_fn(width, height, |x, y| {
            // Four samples a pixel smooth the edges of the board, as a lens does.
            let points = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
            let places = points.map(|(dx, dy)| back.map(DVec2::new(x as f64 + dx, y as f64 + dy)));
            let sum: f64 = places.iter().map(|&p| if on(p) { self.brightness(p) } else { cloth(x, y) }).sum();
            self.seen(0.25 * sum, places[0].clamp(DVec2::ZERO, s), x, y)
        })
    }
}

/// Wood colours for the pixels of a grey picture: red, green and blue, row by row.
pub(crate) fn wood_rgb(grey: &Grey) -> Vec<u8> {
    // Blue falls faster than red as wood darkens, so late wood is brown and not grey. The curves are
    // chosen for looks.
    let tint = |v: f32| {
        let v = f64::from(v);
        [pow(v, 0.72), pow(v, 1.05) * 0.86, pow(v, 1.5) * 0.68].map(|c| (c * 255.0).round() as u8)
    };
    grey.data.iter().flat_map(|&v| tint(v)).collect()
}

// Source: the finaliser of MurmurHash3, whose multipliers these are; the start value is 2^32 divided by
// the golden ratio. The value of a pixel is a hash of its position, so it is the same in any order of the
// rows. The values of a running generator would depend on that order.
fn hash(x: i64, y: i64, seed: u32) -> u32 {
    let mut h = seed ^ 0x9e37_79b9;
    for v in [x as u32, y as u32] {
        h = (h ^ v).wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 16;
    }
    h
}

/// Smooth noise from 0 to 1 whose lattice has a spacing of one unit.
fn noise(x: f64, y: f64, seed: u32) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    // Source: `perlin2002`, the quintic whose first and second derivatives vanish at lattice points.
    // Growth lines depend on the gradient of this noise, which would otherwise jump at these points.
    let ease = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (ease(x - i), ease(y - j));
    let value = |di: i64, dj: i64| f64::from(hash(i as i64 + di, j as i64 + dj, seed)) / f64::from(u32::MAX);
    let low = value(0, 0) + u * (value(1, 0) - value(0, 0));
    let high = value(0, 1) + u * (value(1, 1) - value(0, 1));
    low + v * (high - low)
}

/// Nearly normal noise of variance one, different for each pixel.
fn gauss(x: u32, y: u32, seed: u32) -> f64 {
    let h = u64::from(hash(x.into(), y.into(), seed.wrapping_add(41)));
    let g = u64::from(hash(x.into(), y.into(), seed.wrapping_add(42)));
    // The sum of four uniform numbers has a variance of 4 / 12 in units of their range, hence the
    // square root of 3.
    let sum = (h & 0xffff) + (h >> 16) + (g & 0xffff) + (g >> 16);
    (sum as f64 / 65535.0 - 2.0) * 3.0f64.sqrt()
}
