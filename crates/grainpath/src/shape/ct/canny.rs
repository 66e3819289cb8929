//! Contours by Canny's edges, as in the paper: kept beside the iso-contours so that its results can be reproduced.

use grainpath_core::math::ln;
use grainpath_core::poly::signed_area_mm2;
use grainpath_core::{Contour, DVec2};

use crate::grain::canny::gradient_row;
use crate::grain::raster::Grey;

/// How edges are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CannySettings {
    /// Standard deviation of the Gaussian before the gradients, px.
    pub sigma_px: f64,
    /// Grey steps a pixel over which edges go on, and begin.
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// Chains of edges are joined over gaps up to this, px.
    pub gap_px: f64,
}

struct Edges {
    nx: usize,
    smooth: Grey,
    gx: Vec<f32>,
    gy: Vec<f32>,
    /// 2: an edge, 0: none.
    mark: Vec<u8>,
    magnitude: Vec<f32>,
}

/// The closed contours of a slice in pixels (the middle of the first is (0.5, 0.5)), the bright side on the left, and
/// how many chains stayed open.
pub fn contours(values: &[f32], nx: usize, ny: usize, settings: &CannySettings) -> (Vec<Contour>, usize) {
    if nx < 3 || ny < 3 {
        return (Vec::new(), 0);
    }
    // A frame of the darkest value, so that what runs out of the picture has an edge there.
    let dark = values.iter().copied().fold(f32::INFINITY, f32::min);
    let margin = 4;
    let (w, h) = (nx + 2 * margin, ny + 2 * margin);
    let mut framed = vec![dark; w * h];
    for j in 0..ny {
        let at = (j + margin) * w + margin;
        framed[at..at + nx].copy_from_slice(&values[j * nx..(j + 1) * nx]);
    }
    let framed = Grey { width: w, height: h, data: framed };
    let edges = Edges::find(framed.blurred(settings.sigma_px), settings);
    let (closed, open) = edges.chains(settings.gap_px);
    let shift = DVec2::splat(0.5 - margin as f64);
    let contours = closed.into_iter().map(|c| edges.oriented(&c)).filter(|c| c.len() > 2);
    (contours.map(|c| c.into_iter().map(|p| p + shift).collect()).collect(), open)
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
        let mut edges = Self { nx, smooth, gx, gy, mark: vec![0; n], magnitude };
        let mut stack = Vec::new();
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
        while let Some(k) = stack.pop() {
            if std::mem::replace(&mut edges.mark[k], 2) == 2 {
                continue;
            }
            stack.extend(edges.around(k).into_iter().filter(|&m| edges.mark[m] == 1));
        }
        edges.mark.iter_mut().filter(|m| **m == 1).for_each(|m| *m = 0);
        edges
    }

    /// Gradients along the gradient's direction on both sides of a pixel.
    fn beside(&self, k: usize) -> (f32, f32) {
        let (x, y) = (self.gx[k], self.gy[k]);
        let m = self.magnitude[k].max(f32::MIN_POSITIVE);
        let (ux, uy) = (x / m, y / m);
        let sample = |s: f32| {
            let (fx, fy) = ((k % self.nx) as f32 + s * ux, (k / self.nx) as f32 + s * uy);
            let (i, j) = (fx.floor(), fy.floor());
            let (a, b) = (fx - i, fy - j);
            let p = j as usize * self.nx + i as usize;
            let q = &self.magnitude;
            (q[p] * (1.0 - a) + q[p + 1] * a) * (1.0 - b)
                + (q[p + self.nx] * (1.0 - a) + q[p + self.nx + 1] * a) * b
        };
        (sample(-1.0), sample(1.0))
    }

    fn is_ridge(&self, k: usize) -> bool {
        let (before, after) = self.beside(k);
        self.magnitude[k] > before && self.magnitude[k] >= after
    }

    fn around(&self, k: usize) -> [usize; 8] {
        let w = self.nx;
        [k + 1, k + w, k - 1, k - w, k + w + 1, k + w - 1, k - w - 1, k - w + 1]
    }

    /// The edge's place between pixels: the top of a parabola through three gradients, moved back by what smoothing
    /// moved it.
    fn point(&self, k: usize) -> DVec2 {
        let (a, c) = self.beside(k);
        let b = self.magnitude[k];
        let bend = a - 2.0 * b + c;
        let s = if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 };
        let m = b.max(f32::MIN_POSITIVE);
        let s = s + self.drawn_inwards(k, [a, m, c]);
        let (x, y) = (s * self.gx[k] / m, s * self.gy[k] / m);
        DVec2::new((k % self.nx) as f64 + f64::from(x), (k / self.nx) as f64 + f64::from(y))
    }

    /// How far up the gradient the true edge lies, px: where an edge is bent, blur draws its steepest place towards the
    /// centre of the bend by half the curvature times the blur's variance, the scanner's and ours together
    /// (Verbeek & van Vliet 1994). `slopes` are gradients a pixel before, at, and a pixel behind the edge.
    fn drawn_inwards(&self, k: usize, slopes: [f32; 3]) -> f32 {
        let v = |dx: isize, dy: isize| self.smooth.data[k.wrapping_add_signed(dy * self.nx as isize + dx)];
        let m = slopes[1];
        let (ux, uy) = (self.gx[k] / m, self.gy[k] / m);
        let (xx, yy) = (v(1, 0) - 2.0 * v(0, 0) + v(-1, 0), v(0, 1) - 2.0 * v(0, 0) + v(0, -1));
        let xy = 0.25 * (v(1, 1) - v(1, -1) - v(-1, 1) + v(-1, -1));
        // Of the line of equal grey through here, positive where it bends around what is dark.
        let curvature = (xx * uy * uy - 2.0 * xy * ux * uy + yy * ux * ux) / m;
        let [a, b, c] = slopes.map(|s| ln(f64::from(s.max(f32::MIN_POSITIVE))));
        // Across a blurred edge gradients are a Gaussian; a third of its variance is the Sobel's step of two pixels,
        // which draws nothing.
        let bend = 2.0 * b - a - c;
        let variance = if bend > 1e-3 { (1.0 / bend - 1.0 / 3.0).max(0.0) } else { 0.0 };
        (0.5 * curvature * variance as f32).clamp(-0.5, 0.5)
    }

    /// Chains of edge pixels; joined at their ends, nearest first; the closed ones and the number of the others.
    fn chains(&self, gap_px: f64) -> (Vec<Vec<usize>>, usize) {
        let mut free: Vec<bool> = self.mark.iter().map(|m| *m == 2).collect();
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for seed in 0..free.len() {
            if !free[seed] {
                continue;
            }
            free[seed] = false;
            let mut chain = vec![seed];
            self.extend(&mut chain, &mut free);
            chain.reverse();
            self.extend(&mut chain, &mut free);
            if chain.len() > 2 {
                chains.push(chain);
            }
        }
        self.drop_doubles(&mut chains);
        let place = |k: usize| DVec2::new((k % self.nx) as f64, (k / self.nx) as f64);
        let mut closed = Vec::new();
        loop {
            let end = |c: &Vec<usize>, last: bool| place(if last { c[c.len() - 1] } else { c[0] });
            let mut k = 0;
            while k < chains.len() {
                let c = &chains[k];
                if c.len() > 7 && end(c, false).distance(end(c, true)) <= gap_px.max(2.0) {
                    closed.push(chains.swap_remove(k));
                } else {
                    k += 1;
                }
            }
            let mut best = (gap_px, 0, 0, false, false);
            for i in 0..chains.len() {
                for j in i + 1..chains.len() {
                    for (a, b) in [(false, false), (false, true), (true, false), (true, true)] {
                        let d = end(&chains[i], a).distance(end(&chains[j], b));
                        if d < best.0 {
                            best = (d, i, j, a, b);
                        }
                    }
                }
            }
            let (_, i, j, a, b) = best;
            if i == j || chains.len() > 4000 {
                let open = chains.iter().filter(|c| c.len() > 7).count();
                return (closed, open);
            }
            let mut second = chains.swap_remove(j);
            if !a {
                chains[i].reverse();
            }
            if b {
                second.reverse();
            }
            chains[i].append(&mut second);
        }
    }

    /// Where an edge is two pixels wide, a second chain runs along the first: it goes.
    fn drop_doubles(&self, chains: &mut Vec<Vec<usize>>) {
        let mut owner = vec![u32::MAX; self.mark.len()];
        for (c, chain) in chains.iter().enumerate() {
            chain.iter().for_each(|&k| owner[k] = c as u32);
        }
        let lengths: Vec<usize> = chains.iter().map(Vec::len).collect();
        let longer = |k: usize, c: usize| {
            let near = self.around(k).into_iter().map(|m| owner[m]);
            near.into_iter().any(|o| o != u32::MAX && lengths[o as usize] > lengths[c])
        };
        let mut c = 0;
        chains.retain(|chain| {
            let beside = chain.iter().filter(|&&k| longer(k, c)).count();
            c += 1;
            2 * beside < chain.len()
        });
    }

    fn extend(&self, chain: &mut Vec<usize>, free: &mut [bool]) {
        loop {
            let at = chain[chain.len() - 1];
            let before = chain.len().checked_sub(4).map_or(chain[0], |i| chain[i]);
            let way = |k: usize, from: usize| {
                let d = |a: usize, b: usize| a as f64 - b as f64;
                DVec2::new(d(k % self.nx, from % self.nx), d(k / self.nx, from / self.nx))
            };
            let ahead = way(at, before).normalize_or_zero();
            let score = |k: usize| {
                let step = way(k, at);
                ahead.dot(step) / step.length() - 0.1 * step.length()
            };
            let next = self.around(at).into_iter().filter(|&k| free[k]);
            let Some(next) = next.max_by(|&a, &b| score(a).total_cmp(&score(b)).then(b.cmp(&a))) else {
                return;
            };
            free[next] = false;
            chain.push(next);
        }
    }

    /// The chain as a contour with its bright side on the left: outlines run counter-clockwise, holes clockwise.
    fn oriented(&self, chain: &[usize]) -> Contour {
        let mut c: Contour = chain.iter().map(|&k| self.point(k)).collect();
        let n = c.len();
        // Neighbours scatter against each other by what noise does to their gradients: evened out without shrinking
        // (Taubin 1995), which leaves bows of many points as they are.
        for share in [0.5, -0.53] {
            let old = c.clone();
            for i in 0..n {
                let mean = 0.5 * (old[(i + 1) % n] + old[(i + n - 1) % n]);
                c[i] += share * (mean - old[i]);
            }
        }
        // The gradient points to the bright side; summed along the contour against its left side.
        let mut left = 0.0;
        for i in 0..n {
            let way = c[(i + 1) % n] - c[(i + n - 1) % n];
            let k = chain[i];
            left += f64::from(self.gy[k]) * way.x - f64::from(self.gx[k]) * way.y;
        }
        if left < 0.0 {
            c.reverse();
        }
        if signed_area_mm2(&c).abs() < 3.0 { Contour::new() } else { c }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blurred_ring_with_noise_gives_two_closed_contours_of_the_right_area() {
        let (nx, ny) = (120, 110);
        let value = |i: usize| {
            let p = DVec2::new((i % nx) as f64 + 0.5 - 60.3, (i / nx) as f64 + 0.5 - 54.6);
            let ramp = |d: f64| (0.5 + 0.35 * d).clamp(0.0, 1.0);
            let noise = ((i * 7919) % 97) as f64 - 48.0;
            (1000.0 * ramp(40.0 - p.length()) * ramp(p.length() - 18.0) + 0.3 * noise) as f32
        };
        let values: Vec<f32> = (0..nx * ny).map(value).collect();
        let settings = CannySettings { sigma_px: 1.0, low: 80.0, high: 200.0, gap_px: 5.0 };
        let (found, open) = contours(&values, nx, ny, &settings);
        let mut areas: Vec<f64> = found.iter().map(|c| signed_area_mm2(c)).collect();
        areas.sort_by(f64::total_cmp);
        let pi = std::f64::consts::PI;
        assert_eq!((areas.len(), open), (2, 0), "{areas:?}");
        assert!(
            (areas[0] / (-pi * 324.0) - 1.0).abs() < 0.02 && (areas[1] / (pi * 1600.0) - 1.0).abs() < 0.01,
            "{areas:?}"
        );
        // A part that fills the picture is closed by the frame.
        let (full, _) = contours(&[100.0; 400].map(|v: f32| v), 20, 20, &settings);
        assert!(full.is_empty(), "one grey value has no edges");
    }

    #[test]
    fn small_bores_and_pins_keep_their_size() {
        let n = 48;
        let settings = CannySettings { sigma_px: 1.0, low: 40.0, high: 100.0, gap_px: 5.0 };
        for (radius, blur) in [(8.0, 0.8), (10.0, 0.8), (15.0, 0.8), (10.0, 1.2)] {
            for sign in [-1.0, 1.0] {
                let value = |i: usize| {
                    let p = DVec2::new((i % n) as f64 + 0.5 - 24.2, (i / n) as f64 + 0.5 - 23.9);
                    let d = sign * (radius - p.length());
                    (1000.0 / (1.0 + grainpath_core::math::exp(-1.702 * d / blur))) as f32
                };
                let values: Vec<f32> = (0..n * n).map(value).collect();
                let (found, open) = contours(&values, n, n, &settings);
                // A bore is in a plate, which has an outline.
                let areas = found.iter().map(|c| signed_area_mm2(c) * sign).filter(|a| *a > 0.0);
                let area = areas.fold(0.0, f64::max);
                let off = 100.0 * ((area / std::f64::consts::PI).sqrt() / radius - 1.0);
                println!("radius {radius}, blur {blur}, sign {sign}: {off:.3} %, {open} open");
                // Left where the gradient is steepest they would be smaller by this, 0.4 to 1.3 %.
                let drawn = 50.0 * (blur * blur + 1.0) / (radius * radius);
                assert!(off.abs() < 0.4 * drawn, "radius {radius}, blur {blur}, sign {sign}: {off} %");
            }
        }
    }
}
