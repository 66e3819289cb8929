//! Synthetic boards: growth lines that flow round live knots, with the true direction at every point.

use std::f64::consts::PI;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, exp, pow};

use super::raster::Grey;
use super::warp::Homography;

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

/// What JPEG does to a picture at a quality from 1 to 100: blocks of eight, cosine transform, rounding with the
/// table of its standard. For trying out how much of it a method bears.
pub fn jpeg_like(grey: &Grey, quality: u32) -> Grey {
    const TABLE: [u16; 64] = [
        16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14,
        17, 22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49,
        64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
    ];
    let q = f64::from(quality.clamp(1, 100));
    let scale = if q < 50.0 { 5000.0 / q } else { 200.0 - 2.0 * q };
    let table = TABLE.map(|t| ((f64::from(t) * scale + 50.0) / 100.0).floor().clamp(1.0, 255.0));
    let wave: [[f64; 8]; 8] = std::array::from_fn(|k| {
        let c = if k == 0 { 0.125f64.sqrt() } else { 0.5 };
        std::array::from_fn(|n| c * grainpath_core::math::cos((2 * n + 1) as f64 * k as f64 * PI / 16.0))
    });
    let mut out = grey.clone();
    for by in (0..grey.height).step_by(8) {
        for bx in (0..grey.width).step_by(8) {
            let pixel =
                |x: usize, y: usize| grey.at((bx + x).min(grey.width - 1), (by + y).min(grey.height - 1));
            let value = |x: usize, y: usize| (f64::from(pixel(x, y)) * 255.0).round() - 128.0;
            let mut rounded = [[0.0; 8]; 8];
            for (v, row) in rounded.iter_mut().enumerate() {
                for (u, r) in row.iter_mut().enumerate() {
                    let each = (0..64).map(|k| value(k % 8, k / 8) * wave[u][k % 8] * wave[v][k / 8]);
                    let t = table[8 * v + u];
                    *r = (each.sum::<f64>() / t).round() * t;
                }
            }
            for y in 0..8.min(grey.height - by) {
                for x in 0..8.min(grey.width - bx) {
                    let each = (0..64).map(|k| rounded[k / 8][k % 8] * wave[k % 8][x] * wave[k / 8][y]);
                    out.data[(by + y) * grey.width + bx + x] =
                        ((each.sum::<f64>() + 128.0) / 255.0).clamp(0.0, 1.0) as f32;
                }
            }
        }
    }
    out
}

/// How much a picture is darkened towards its corners; for trying out.
pub fn vignetted(grey: &Grey, strength: f64) -> Grey {
    let middle = DVec2::new(grey.width as f64, grey.height as f64) * 0.5;
    Grey::from_fn(grey.width, grey.height, |x, y| {
        let r2 = ((DVec2::new(x as f64, y as f64) - middle) / middle).length_squared();
        grey.at(x, y) * exp(-strength * r2) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::super::tensor::{TensorSettings, axis_difference_rad, grain_axes};
    use super::super::warp::rectify;
    use super::*;

    const SETTINGS: TensorSettings =
        TensorSettings { gradient_mm: 0.15, integration_mm: 0.6, smooth_mm: 0.5 };

    /// Mean angle to the truth, degrees, over all points but those where there is none.
    fn mean_error_deg(board: &Board, photo: &Grey) -> f64 {
        let (w, h) = (photo.width as f64, photo.height as f64);
        let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(DVec2::from);
        let image = rectify(photo, corners, board.size_mm, board.size_mm.x / w);
        let axes = grain_axes(&image, &SETTINGS);
        let (mut sum, mut n) = (0.0, 0);
        for j in 1..60 {
            for i in 1..200 {
                let p = board.size_mm * DVec2::new(f64::from(i) / 200.0, f64::from(j) / 60.0);
                if let Some(truth) = board.axis_rad(p, 0.4) {
                    sum += axis_difference_rad(axes.sample(p).axis_rad(), truth).to_degrees();
                    n += 1;
                }
            }
        }
        sum / f64::from(n)
    }

    #[test]
    fn the_grain_of_boards_is_found_whatever_the_photograph() {
        let mut rows = Vec::new();
        for noise in [0.0, 0.02, 0.06] {
            for (uneven_light, blur, quality) in
                [(0.0, 0.0, 100), (0.3, 1.0, 90), (0.6, 2.0, 70), (0.3, 0.5, 40)]
            {
                for knots in [
                    vec![],
                    Board::default().knots,
                    vec![
                        Knot { centre_mm: DVec2::new(28.0, 10.0), radius_mm: 3.0 },
                        Knot { centre_mm: DVec2::new(70.0, 20.0), radius_mm: 5.0 },
                    ],
                ] {
                    let board = Board { noise, uneven_light, knots, seed: 7, ..Board::default() };
                    let photo = vignetted(&jpeg_like(&board.flat(0.1, blur), quality), 0.5 * uneven_light);
                    let error = mean_error_deg(&board, &photo);
                    rows.push((error, format!("noise {noise} light {uneven_light} blur {blur} quality {quality} knots {}: {error:.2} deg", board.knots.len())));
                }
            }
        }
        for (_, row) in &rows {
            println!("{row}");
        }
        let wrong: Vec<&String> = rows.iter().filter(|(e, _)| *e > 3.0).map(|(_, row)| row).collect();
        assert!(wrong.is_empty(), "{wrong:#?}");
    }

    #[test]
    fn jpeg_at_full_quality_changes_little() {
        let photo = Board::default().flat(0.2, 0.5);
        let off = |q| {
            let coded = jpeg_like(&photo, q);
            photo.data.iter().zip(&coded.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        assert!(off(100) < 0.012 && off(20) > 0.03, "{} {}", off(100), off(20));
    }
}
