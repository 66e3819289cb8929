//! Synthetic boards: growth lines that flow round live knots, with the true direction at every point.

use std::f64::consts::PI;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, pow};

use grainpath_imaging::photo::warp::Homography;
use grainpath_imaging::raster::Grey;

/// A branch cut across: rings inside, the grain parts around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// Its middle, mm.
    pub centre_mm: DVec2,
    /// Radius of the branch, mm.
    pub radius_mm: f64,
}

/// A board and how well it was photographed.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// Width and height, mm; the grain runs along the width.
    pub size_mm: DVec2,
    /// Its knots.
    pub knots: Vec<Knot>,
    /// Distance of growth lines away from knots, mm.
    pub ring_mm: f64,
    /// How far growth lines wave, mm.
    pub wave_mm: f64,
    /// Standard deviation of the camera's noise, share of white.
    pub noise: f64,
    /// How much darker one end is lit than the other, 0 to 1.
    pub uneven_light: f64,
    /// Seed of everything random.
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

/// A step for slopes, mm.
const STEP_MM: f64 = 1e-3;

impl Board {
    /// A point of the straight board that waves carried to `p`.
    fn unwaved(&self, p: DVec2) -> DVec2 {
        let wave = |x: f64, y: f64, seed: u32| 2.0 * noise(x, y, self.seed.wrapping_add(seed)) - 1.0;
        let shift = DVec2::new(
            wave(p.x / 37.0, p.y / 29.0, 11),
            wave(p.x / 31.0, p.y / 23.0, 12) + 0.4 * wave(p.x / 13.0, p.y / 17.0, 13),
        );
        p + self.wave_mm * shift
    }

    /// Growth lines are where this is constant, mm: ideal flow round the knots, rings inside them.
    fn growth(&self, p: DVec2) -> f64 {
        let p = self.unwaved(p);
        let mut height = p.y;
        for knot in &self.knots {
            let d = p - knot.centre_mm;
            let (r2, radius2) = (d.length_squared(), knot.radius_mm * knot.radius_mm);
            if r2 < radius2 {
                return knot.centre_mm.y + 0.9 * (knot.radius_mm - r2.sqrt());
            }
            height -= radius2 * d.y / r2;
        }
        height
    }

    /// The knot a point lies in.
    fn knot_at(&self, p: DVec2) -> Option<&Knot> {
        let p = self.unwaved(p);
        self.knots.iter().find(|k| p.distance_squared(k.centre_mm) < k.radius_mm * k.radius_mm)
    }

    /// The true direction of the grain, radians in `[0, pi)`; `None` within `clear_mm` of where it has none: the rim
    /// and the middle of a knot, the points before and behind it where the flow parts.
    pub fn axis_rad(&self, p: DVec2, clear_mm: f64) -> Option<f64> {
        let q = self.unwaved(p);
        for knot in &self.knots {
            let d = q - knot.centre_mm;
            let at_rim = (d.length() - knot.radius_mm).abs() < clear_mm;
            let parts = DVec2::new(d.x.abs() - knot.radius_mm, d.y).length() < 2.0 * clear_mm;
            if at_rim || parts || d.length() < 2.0 * clear_mm {
                return None;
            }
        }
        let slope = |d: DVec2| self.growth(p + d) - self.growth(p - d);
        let g = DVec2::new(slope(DVec2::new(STEP_MM, 0.0)), slope(DVec2::new(0.0, STEP_MM)));
        Some(atan2(g.x, -g.y).rem_euclid(PI))
    }

    /// Brightness of the wood at a point, 0 to 1, before light and camera.
    pub fn brightness(&self, p: DVec2) -> f64 {
        let growth = self.growth(p);
        // Early wood is light and turns dark slowly; late wood ends at once.
        let turns = growth / self.ring_mm + 0.35 * noise(growth / 3.1, 0.5, self.seed.wrapping_add(21));
        let phase = turns - turns.floor();
        let ring = if phase < 0.86 { pow(phase / 0.86, 2.5) } else { 1.0 - (phase - 0.86) / 0.14 };
        let depth = 0.6 + 0.8 * noise(turns.floor() * 0.37, 7.5, self.seed.wrapping_add(22));
        let fibre = noise(p.x * 0.22, growth * 9.0, self.seed.wrapping_add(23)) - 0.5;
        let inside = if self.knot_at(p).is_some() { 0.22 } else { 0.0 };
        (0.78 - inside - 0.34 * depth * ring + 0.10 * fibre).clamp(0.02, 0.98)
    }

    /// Light and camera noise on top of a brightness, for the pixel `(x, y)`.
    fn seen(&self, value: f64, p: DVec2, x: usize, y: usize) -> f32 {
        let u = p / self.size_mm;
        let light = 1.0 - self.uneven_light * (0.7 * u.x + 0.3 * u.y * u.y);
        (value * light + self.noise * gauss(x as u32, y as u32, self.seed)).clamp(0.0, 1.0) as f32
    }

    /// The board from straight above, rows from the top, pixels of `px_mm`. `blur_px` is how unsharp the picture is.
    pub fn flat(&self, px_mm: f64, blur_px: f64) -> Grey {
        let n = |mm: f64| (mm / px_mm).round().max(1.0) as usize;
        let (w, h) = (n(self.size_mm.x), n(self.size_mm.y));
        let place = |x: f64, y: f64| DVec2::new(x * px_mm, self.size_mm.y - y * px_mm);
        let clean = Grey::from_fn(w, h, |x, y| self.brightness(place(x as f64 + 0.5, y as f64 + 0.5)) as f32);
        let clean = clean.blurred(blur_px);
        Grey::from_fn(w, h, |x, y| {
            self.seen(clean.at(x, y).into(), place(x as f64 + 0.5, y as f64 + 0.5), x, y)
        })
    }

    /// A photograph of the board on a dark cloth: its corners (upper left, upper right, lower right, lower left) are
    /// at `corners` in a picture of `width` x `height` pixels.
    pub fn photograph(&self, width: usize, height: usize, corners: [DVec2; 4]) -> Grey {
        let s = self.size_mm;
        let board = [(0.0, s.y), (s.x, s.y), (s.x, 0.0), (0.0, 0.0)].map(DVec2::from);
        let Some(back) = Homography::from_points(corners, board) else {
            return Grey::filled(width, height, 0.0);
        };
        let on = |p: DVec2| p.x >= 0.0 && p.y >= 0.0 && p.x <= s.x && p.y <= s.y;
        let cloth = |x: usize, y: usize| {
            0.10 + 0.05 * noise(x as f64 / 3.0, y as f64 / 3.0, self.seed.wrapping_add(31))
        };
        Grey::from_fn(width, height, |x, y| {
            // Four points a pixel, so that the edges are as smooth as a lens makes them.
            let points = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
            let places = points.map(|(dx, dy)| back.map(DVec2::new(x as f64 + dx, y as f64 + dy)));
            let sum: f64 = places.iter().map(|&p| if on(p) { self.brightness(p) } else { cloth(x, y) }).sum();
            self.seen(0.25 * sum, places[0].clamp(DVec2::ZERO, s), x, y)
        })
    }
}

/// The colours of wood for brightnesses: rows of red, green, blue.
pub fn wood_rgb(grey: &Grey) -> Vec<u8> {
    let tint = |v: f32| {
        let v = f64::from(v);
        [pow(v, 0.72), pow(v, 1.05) * 0.86, pow(v, 1.5) * 0.68].map(|c| (c * 255.0).round() as u8)
    };
    grey.data.iter().flat_map(|&v| tint(v)).collect()
}

fn hash(x: i64, y: i64, seed: u32) -> u32 {
    let mut h = seed ^ 0x9e37_79b9;
    for v in [x as u32, y as u32] {
        h = (h ^ v).wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 16;
    }
    h
}

/// Smooth noise from 0 to 1 with a grain of one unit.
fn noise(x: f64, y: f64, seed: u32) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (ease(x - i), ease(y - j));
    let value = |di: i64, dj: i64| f64::from(hash(i as i64 + di, j as i64 + dj, seed)) / f64::from(u32::MAX);
    let low = value(0, 0) + u * (value(1, 0) - value(0, 0));
    let high = value(0, 1) + u * (value(1, 1) - value(0, 1));
    low + v * (high - low)
}

/// Nearly normal noise of variance one, different for every pixel.
fn gauss(x: u32, y: u32, seed: u32) -> f64 {
    let h = u64::from(hash(x.into(), y.into(), seed.wrapping_add(41)));
    let g = u64::from(hash(x.into(), y.into(), seed.wrapping_add(42)));
    // The sum of four even numbers from 0 to 65535.
    let sum = (h & 0xffff) + (h >> 16) + (g & 0xffff) + (g >> 16);
    (sum as f64 / 65535.0 - 2.0) * 3.0f64.sqrt()
}
