//! The direction of the grain: structure tensor, coherence, smoothing.
//!
//! # Method
//! The gradient of a picture of grain points across the grain. Its outer product with itself has no sign, so its
//! average over a neighbourhood does not cancel over a line with two flanks (`bigun1987` in
//! docs/references.bib). The weak axis of that average is the grain. All averages are of the doubled angle, for
//! which an axis and its opposite are the same. Brightness and contrast are equalised first, so that light and
//! stains do not count as grain. Clear places then pass their direction to unclear ones: the smoothed axes solve
//! a linear system that balances the evidence against the differences between neighbours. Conjugate gradients
//! solve it.
//!
//! # Units, cost and limits
//! Lengths in mm, angles in rad; grids are `(ny, nx)`, row-major, with a node about every third of the
//! integration scale. The cost is linear in the pixels, plus at most 200 iterations over the nodes.
//! Coherence is the difference of the tensor's eigenvalues over their sum: 0 for noise, 1 for parallel
//! lines. A blank picture has coherence 0 and the axis of +x. Two grains that cross in one neighbourhood
//! give one mean axis of low coherence.

use std::f64::consts::PI;

use grainpath_core::conjugate_gradients::{CgGoal, CgSettings, CgSystem, CgValue, conjugate_gradients};
use grainpath_core::math::{atan2, sin_cos};
use grainpath_core::{DVec2, Region};
use rayon::prelude::*;

use super::raster::{Grey, enlarging, half, quantile, three};
use crate::metric::MetricImage;

/// Scales on which a direction is read from a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TensorSettings {
    /// Standard deviation of the Gaussian before gradients are taken, mm.
    pub gradient_mm: f64,
    /// Standard deviation of the neighbourhood over which they are averaged, mm.
    pub integration_mm: f64,
    /// Length over which clear places pass their direction to unclear ones, mm.
    pub smooth_mm: f64,
}

/// An axis at every node of a square grid.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisGrid {
    /// Place of the first node, mm.
    pub min_mm: DVec2,
    /// Distance of neighbouring nodes, mm.
    pub step_mm: f64,
    /// Nodes in a row.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// Cosine and sine of twice the angle, unit length.
    pub double: Vec<[f32; 2]>,
    /// Coherence of the tensor, 0 to 1: how clear the axis is.
    pub coherence: Vec<f32>,
    /// Mean coherence over a neighbourhood three times as wide. Noise has hardly any, wood nearly as much
    /// as on the narrow scale.
    pub wide_coherence: f64,
    /// Darkness of each place against its surroundings, 0 to 1.
    pub darkness: Vec<f32>,
}

/// The result of [`AxisGrid::sample`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisSample {
    /// Cosine and sine of twice the angle, not normalised: shorter where neighbours disagree.
    pub double: [f64; 2],
    /// 0 to 1.
    pub coherence: f64,
    /// 0 to 1.
    pub darkness: f64,
}

impl AxisSample {
    /// The angle from +X, radians in `[0, pi)`.
    pub fn axis_rad(&self) -> f64 {
        (0.5 * atan2(self.double[1], self.double[0])).rem_euclid(PI)
    }

    /// Linear interpolation to another sample by the fraction `t`.
    pub fn towards(self, other: Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + t * (b - a);
        Self {
            double: [mix(self.double[0], other.double[0]), mix(self.double[1], other.double[1])],
            coherence: mix(self.coherence, other.coherence),
            darkness: mix(self.darkness, other.darkness),
        }
    }
}

impl AxisGrid {
    /// The place of a node, mm.
    pub fn place(&self, i: usize, j: usize) -> DVec2 {
        self.min_mm + self.step_mm * DVec2::new(i as f64, j as f64)
    }

    /// The axis at a point, linear between nodes. Outside the grid, that of the nearest node.
    pub fn sample(&self, p: DVec2) -> AxisSample {
        let at = (p - self.min_mm) / self.step_mm;
        let place = |v: f64, n: usize| {
            // NaN would pass through clamp and index the first node anyway; this states it.
            let v = if v.is_nan() { 0.0 } else { v.clamp(0.0, n as f64 - 1.0) };
            let i = (v as usize).min(n.saturating_sub(2));
            (i, v - i as f64)
        };
        let ((i, u), (j, v)) = (place(at.x, self.nx), place(at.y, self.ny));
        let (right, up) = (usize::from(self.nx > 1), if self.ny > 1 { self.nx } else { 0 });
        let node = |k: usize| AxisSample {
            double: self.double[k].map(f64::from),
            coherence: self.coherence[k].into(),
            darkness: self.darkness[k].into(),
        };
        let k = j * self.nx + i;
        let low = node(k).towards(node(k + right), u);
        let high = node(k + up).towards(node(k + up + right), u);
        low.towards(high, v)
    }

    /// Share of the nodes where the coherence is at least this.
    pub fn clear_share(&self, coherence: f32) -> f64 {
        let clear = self.coherence.iter().filter(|c| **c >= coherence).count();
        clear as f64 / self.coherence.len().max(1) as f64
    }

    /// The mean coherence.
    pub fn mean_coherence(&self) -> f64 {
        self.coherence.iter().map(|c| f64::from(*c)).sum::<f64>() / self.coherence.len().max(1) as f64
    }
}

/// Input of the smoothing: doubled angles and the weight of each.
pub(crate) struct Evidence {
    pub(crate) double: Vec<[f32; 2]>,
    pub(crate) weight: Vec<f32>,
}

/// Contrast below which pixels count as blank, as a share of white. Source: derived. It is half a step of an 8-bit image;
/// a larger value loses faint grain, a smaller one reads quantisation as grain.
pub(crate) const FAINT: f32 = 2e-3;

/// Standard deviation in pixels from which a Gaussian leaves nothing that an image of half the size would
/// not show. Source: derived. At 2.4 px its gain at the Nyquist frequency of the smaller image is below 0.1 %.
const HALVED_FROM_PX: f64 = 2.4;

/// The axes of the grain in a picture, with a node about every third of the integration scale.
pub fn grain_axes(image: &MetricImage, settings: &TensorSettings) -> AxisGrid {
    let mut px = image.px_mm;
    let mut sigma_px = (settings.gradient_mm / px).max(0.7);
    let mut small: Option<Grey> = None;
    while sigma_px >= HALVED_FROM_PX && image.grey.width.min(image.grey.height) > 16 {
        small = Some(small.as_ref().unwrap_or(&image.grey).halved());
        // Averaging two pixels acts as a Gaussian of half a pixel, to second order.
        sigma_px = 0.5 * (sigma_px * sigma_px - 0.25).sqrt();
        px *= 2.0;
    }
    let flat = flattened(
        small.as_ref().unwrap_or(&image.grey).blurred(sigma_px),
        3.0 * settings.integration_mm / px,
    );
    // The tensor is smoothed over the integration scale, so 2.5 nodes for each standard deviation lose
    // nothing.
    let cell = ((settings.integration_mm / px / 2.5).floor() as usize).max(1);
    let (nx, ny) = ((flat.width / cell).max(1), (flat.height / cell).max(1));
    let mut sums = vec![[0.0f32; 4]; nx * ny];
    sums.par_chunks_mut(nx).enumerate().for_each_init(
        || [(); 4].map(|()| vec![0.0f32; flat.width]),
        |columns, (j, out)| cell_tensors(&flat, j, cell, columns, out),
    );
    let sigma = settings.integration_mm / px / cell as f64;
    let layer =
        |c: usize| Grey { width: nx, height: ny, data: sums.iter().map(|s| s[c]).collect() }.blurred(sigma);
    let [xx, xy, yy] = [layer(0), layer(1), layer(2)];
    let dark = layer(3);
    let energy: Vec<f32> = xx.data.iter().zip(&yy.data).map(|(a, b)| a + b).collect();
    // The median energy is the contrast of ordinary wood; a knot or a scratch must not outweigh the rest.
    let typical = quantile(&mut energy.clone(), 0.5).max(FAINT * FAINT);
    let wide_coherence =
        mean_coherence(&xx.blurred(3.0 * sigma), &xy.blurred(3.0 * sigma), &yy.blurred(3.0 * sigma));
    let mut grid = AxisGrid {
        min_mm: image.min_mm + DVec2::splat(0.5 * px * cell as f64),
        step_mm: px * cell as f64,
        nx,
        ny,
        double: vec![[1.0, 0.0]; nx * ny],
        coherence: vec![0.0; nx * ny],
        wide_coherence,
        darkness: dark.data,
    };
    let mut weight = Vec::with_capacity(nx * ny);
    for (k, e) in energy.into_iter().enumerate() {
        // The doubled axis of the gradient, turned by 180 degrees, is the doubled axis of the grain.
        let (c, s) = (yy.data[k] - xx.data[k], -2.0 * xy.data[k]);
        let (length, e) = ((c * c + s * s).sqrt(), e.max(1e-12));
        grid.coherence[k] = (length / (e + FAINT * FAINT)).min(1.0);
        if length > 0.0 {
            grid.double[k] = [c / length, s / length];
        }
        // The weight is the square of the coherence, times an energy that saturates at the typical one, so that a strong
        // border does not dominate.
        weight.push(grid.coherence[k] * grid.coherence[k] * e / (e + 0.25 * typical));
    }
    spread_darkness(&mut grid.darkness);
    let evidence = Evidence { double: grid.double.clone(), weight };
    let reach = settings.smooth_mm / grid.step_mm;
    grid.double = smoothed([nx, ny, 1], &evidence, [reach, reach, 0.0]);
    grid
}

/// The mean over all nodes of the tensor's coherence: difference of eigenvalues over their sum.
fn mean_coherence(xx: &Grey, xy: &Grey, yy: &Grey) -> f64 {
    let each = |k: usize| {
        let (c, s) = (yy.data[k] - xx.data[k], 2.0 * xy.data[k]);
        f64::from((c * c + s * s).sqrt() / (xx.data[k] + yy.data[k] + FAINT * FAINT))
    };
    (0..xx.data.len()).map(each).sum::<f64>() / xx.data.len().max(1) as f64
}

/// The picture without slow changes of brightness and contrast, which come from uneven light and stains.
fn flattened(mut grey: Grey, sigma_px: f64) -> Grey {
    let (w, h) = (grey.width, grey.height);
    // A slow average can be computed on a smaller picture.
    let shrunk = |sum: fn([f32; 4]) -> f32, grey: &Grey| {
        let (mut small, mut level) = (half(&grey.data, [w, h], 0.25, sum), 2.0);
        while sigma_px / level > 6.0 && small.width > 16 && small.height > 16 {
            small = small.halved();
            level *= 2.0;
        }
        (small, level)
    };
    let (small, level) = shrunk(|[a, b, c, d]| (a + b) + (c + d), &grey);
    let columns = enlarging(w, level, small.width);
    let rows = enlarging(h, level, small.height);
    let apply = |grey: &mut Grey, slow: &Grey, change: fn(f32, f32) -> f32| {
        let buffers = || (Vec::new(), Vec::new());
        grey.data.par_chunks_mut(w).zip(&rows).for_each_init(buffers, |(between, row), (out, &at)| {
            slow.enlarged_row(&columns, at, between, row);
            out.iter_mut().zip(&*row).for_each(|(o, s)| *o = change(*o, *s));
        });
    };
    apply(&mut grey, &small.blurred(sigma_px / level), |v, mean| v - mean);
    let (squares, _) = shrunk(|[a, b, c, d]| (a * a + b * b) + (c * c + d * d), &grey);
    // Contrast is equalised. The constant 0.01 keeps noise in a blank place from being amplified.
    apply(&mut grey, &squares.blurred(2.0 * sigma_px / level), |v, square| {
        v * (0.1 / (square.max(0.0).sqrt() + 0.01))
    });
    grey
}

/// Mean products of gradients, and mean brightness, over the cells of row `j`. `columns` is a buffer for
/// the sums of pixel columns, as long as a row of pixels.
fn cell_tensors(flat: &Grey, j: usize, cell: usize, columns: &mut [Vec<f32>; 4], out: &mut [[f32; 4]]) {
    let (w, h) = (flat.width, flat.height);
    columns.iter_mut().for_each(|c| c.fill(0.0));
    let n = w.saturating_sub(2);
    for y in cell * j..(cell * (j + 1)).min(h) {
        let row = |y: usize| &flat.data[y * w..(y + 1) * w];
        let rows = [row(y.saturating_sub(1)), row(y), row((y + 1).min(h - 1))];
        let [xx, xy, yy, light] = columns.each_mut();
        // Border pixels repeat their neighbours; they are added apart so that the inner loop has no
        // conditions.
        let mut add = |x: usize, a: [f32; 3], b: [f32; 3], c: [f32; 3]| {
            let (gx, gy) = scharr(a, b, c);
            xx[x] += gx * gx;
            xy[x] += gx * gy;
            yy[x] += gy * gy;
            light[x] += b[1];
        };
        for x in [0, w - 1].into_iter().take(w) {
            let around = |row: &[f32]| [row[x.saturating_sub(1)], row[x], row[(x + 1).min(w - 1)]];
            add(x, around(rows[0]), around(rows[1]), around(rows[2]));
        }
        let ([al, am, ar], [bl, bm, br], [cl, cm, cr]) = (three(rows[0]), three(rows[1]), three(rows[2]));
        let [xx, xy, yy, light] = columns.each_mut().map(|c| &mut c[w.min(1)..][..n]);
        for x in 0..n {
            let (gx, gy) = scharr([al[x], am[x], ar[x]], [bl[x], bm[x], br[x]], [cl[x], cm[x], cr[x]]);
            xx[x] += gx * gx;
            xy[x] += gx * gy;
            yy[x] += gy * gy;
            light[x] += bm[x];
        }
    }
    let [xx, xy, yy, light] = columns;
    for (i, out) in out.iter_mut().enumerate() {
        let columns = cell * i..(cell * (i + 1)).min(w);
        let mean = |sums: &[f32]| sums[columns.clone()].iter().sum::<f32>() / (cell * cell) as f32;
        *out = [mean(xx), mean(xy), mean(yy), mean(light)];
    }
}

/// The gradient by Scharr's weights 3, 10, 3, whose direction is right to a tenth of a degree.
#[inline]
fn scharr(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> (f32, f32) {
    let gx = 3.0 * ((a[2] - a[0]) + (c[2] - c[0])) + 10.0 * (b[2] - b[0]);
    let gy = 3.0 * ((c[0] - a[0]) + (c[2] - a[2])) + 10.0 * (c[1] - a[1]);
    (gx / 32.0, gy / 32.0)
}

/// Converts equalised brightness to 0 (light) to 1 (dark), between the lightest and the darkest
/// twentieth.
pub(crate) fn spread_darkness(values: &mut [f32]) {
    let mut copy = values.to_vec();
    let (low, high) = (quantile(&mut copy, 0.05), quantile(&mut copy, 0.95));
    let range = (high - low).max(1e-6);
    values.iter_mut().for_each(|v| *v = ((high - *v) / range).clamp(0.0, 1.0));
}

/// The linear system on a grid of nodes whose solution differs little from the evidence and between neighbours.
struct Smoothing {
    /// Nodes in x, y and z.
    n: [usize; 3],
    /// Weight of the evidence at each node.
    weight: Vec<f32>,
    /// Stiffness between neighbours in x, y and z.
    stiff: [f32; 3],
    /// The matrix's diagonal.
    diagonal: Vec<f32>,
}

impl Smoothing {
    fn new(n: [usize; 3], evidence: &Evidence, reach: [f64; 3]) -> Self {
        let stiff = reach.map(|r| (r * r).max(1e-3) as f32);
        // The small constant keeps the system regular where there is no evidence.
        let weight: Vec<f32> = evidence.weight.iter().map(|w| w + 1e-4).collect();
        let mut system = Self { n, diagonal: weight.clone(), weight, stiff };
        let mut diagonal = std::mem::take(&mut system.diagonal);
        for (row, out) in diagonal.chunks_mut(n[0]).enumerate() {
            let beside: f32 = system.rows_beside(row).into_iter().flatten().map(|(_, stiff)| stiff).sum();
            for (x, d) in out.iter_mut().enumerate() {
                *d += beside + stiff[0] * (f32::from(x > 0) + f32::from(x + 1 < n[0]));
            }
        }
        system.diagonal = diagonal;
        system
    }

    /// The neighbouring rows of nodes in y and z, with the stiffness towards them.
    fn rows_beside(&self, row: usize) -> [Option<(usize, f32)>; 4] {
        let [_, ny, nz] = self.n;
        let (j, l) = (row % ny, row / ny);
        [
            (j > 0).then(|| (row - 1, self.stiff[1])),
            (j + 1 < ny).then(|| (row + 1, self.stiff[1])),
            (l > 0).then(|| (row - ny, self.stiff[2])),
            (l + 1 < nz).then(|| (row + ny, self.stiff[2])),
        ]
    }
}

impl CgSystem<[f32; 2]> for Smoothing {
    const PRECONDITIONED: bool = true;

    /// Row by row: neighbours in y and z are whole rows, which are added one after the other.
    fn apply(&self, x: &[[f32; 2]], out: &mut [[f32; 2]]) {
        let nx = self.n[0];
        out.par_chunks_mut(nx).enumerate().with_min_len(4096usize.div_ceil(nx)).for_each(|(row, out)| {
            let values = |row: usize| x[row * nx..(row + 1) * nx].as_flattened();
            let own = values(row);
            for ((o, v), w) in out.iter_mut().zip(&x[row * nx..]).zip(&self.weight[row * nx..]) {
                *o = [w * v[0], w * v[1]];
            }
            let out = out.as_flattened_mut();
            let add_difference = |out: &mut [f32], own: &[f32], beside: &[f32], stiff: f32| {
                out.iter_mut().zip(own).zip(beside).for_each(|((o, v), n)| *o += stiff * (v - n));
            };
            add_difference(&mut out[2..], &own[2..], own, self.stiff[0]);
            add_difference(out, own, &own[2..], self.stiff[0]);
            for (beside, stiff) in self.rows_beside(row).into_iter().flatten() {
                add_difference(out, own, values(beside), stiff);
            }
        });
    }

    fn precondition(&self, residual: &[[f32; 2]], out: &mut [[f32; 2]]) {
        let scaled = residual.iter().zip(&self.diagonal).map(|(r, d)| [r[0] / d, r[1] / d]);
        out.iter_mut().zip(scaled).for_each(|(o, z)| *o = z);
    }
}

/// The axes that differ least from the evidence and from each other: one linear system for the doubled angles, solved by
/// conjugate gradients. `reach` is the length, in nodes of `n` in x, y and z, over which evidence of weight 1 holds
/// against its neighbours.
pub(crate) fn smoothed(n: [usize; 3], evidence: &Evidence, reach: [f64; 3]) -> Vec<[f32; 2]> {
    let system = Smoothing::new(n, evidence, reach);
    let right: Vec<[f32; 2]> =
        evidence.double.iter().zip(&system.weight).map(|(d, w)| [w * d[0], w * d[1]]).collect();
    let mut scaled = right.clone();
    system.precondition(&right, &mut scaled);
    let goal = CgGoal::Energy(1e-6 * CgValue::dot(&right, &scaled));
    let mut x = evidence.double.clone();
    conjugate_gradients(&system, &right, &mut x, CgSettings { goal, max_steps: 200, flexible: false });
    x.into_iter()
        .map(|[c, s]| {
            let length = (c * c + s * s).sqrt();
            // Where the doubled angles cancel there is no axis; any unit vector is as good.
            if length > 1e-9 { [c / length, s / length] } else { [1.0, 0.0] }
        })
        .collect()
}

/// A line that axes are to follow, with its weight.
pub struct Guideline<'a> {
    /// The line, mm.
    pub points: &'a [DVec2],
    /// Whether its end joins its start.
    pub closed: bool,
    /// Weight relative to that of the picture's evidence, which is at most 1.
    pub weight: f32,
}

/// The axes of `grid`, bent to follow lines near them. `keep` is the weight of the present axes of `grid`.
pub fn along_lines(grid: &AxisGrid, lines: &[Guideline<'_>], keep: f32, reach_mm: f64) -> AxisGrid {
    let mut sums = vec![[0.0f32; 3]; grid.nx * grid.ny];
    for line in lines {
        let n = line.points.len();
        let segments = if line.closed { n } else { n.saturating_sub(1) };
        for k in 0..segments {
            let (a, b) = (line.points[k], line.points[(k + 1) % n]);
            add_segment(grid, a, b, line.weight, &mut sums);
        }
    }
    let mut evidence = Evidence { double: grid.double.clone(), weight: Vec::with_capacity(sums.len()) };
    for (k, [c, s, w]) in sums.into_iter().enumerate() {
        let own = keep * grid.coherence[k] * grid.coherence[k];
        let total = own + w;
        if total > 0.0 {
            let old = evidence.double[k];
            let mixed = [(own * old[0] + c) / total, (own * old[1] + s) / total];
            evidence.double[k] = mixed;
        }
        evidence.weight.push(total);
    }
    let mut out = grid.clone();
    let reach = reach_mm / grid.step_mm;
    out.double = smoothed([grid.nx, grid.ny, 1], &evidence, [reach, reach, 0.0]);
    out
}

fn add_segment(grid: &AxisGrid, a: DVec2, b: DVec2, weight: f32, sums: &mut [[f32; 3]]) {
    let d = b - a;
    let length = d.length();
    if length < 1e-9 {
        return;
    }
    let double = [(d.x * d.x - d.y * d.y) / (length * length), 2.0 * d.x * d.y / (length * length)];
    // Two samples for each node distance, so that no node along the line is missed.
    let n = (2.0 * length / grid.step_mm).ceil().clamp(1.0, 1e5) as usize;
    for k in 0..n {
        let p = (a + d * ((k as f64 + 0.5) / n as f64) - grid.min_mm) / grid.step_mm;
        let (i, j) = (p.x.round(), p.y.round());
        if i >= 0.0 && j >= 0.0 && (i as usize) < grid.nx && (j as usize) < grid.ny {
            let s = &mut sums[j as usize * grid.nx + i as usize];
            // Weight is proportional to length, so a line cut into short segments counts no more than a
            // long one.
            let w = weight * (length / (n as f64 * grid.step_mm)) as f32;
            *s = [s[0] + w * double[0] as f32, s[1] + w * double[1] as f32, s[2] + w];
        }
    }
}

/// Weight of borders. Source: derived. Against evidence of at most 1 it makes axes follow the border whatever the picture
/// shows there.
const BORDER_WEIGHT: f32 = 200.0;

/// Borders of the part along which the grain is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tangent {
    /// None: the picture alone decides.
    None,
    /// The outline.
    Outline,
    /// The holes.
    Holes,
    /// Both.
    Both,
}

/// The borders of a region that axes are to follow.
pub fn border_lines(region: &Region, tangent: Tangent) -> Vec<Guideline<'_>> {
    let mut lines = Vec::new();
    for polygon in &region.polygons {
        let line = |points| Guideline { points, closed: true, weight: BORDER_WEIGHT };
        if matches!(tangent, Tangent::Outline | Tangent::Both) {
            lines.push(line(polygon.outer.as_slice()));
        }
        if matches!(tangent, Tangent::Holes | Tangent::Both) {
            lines.extend(polygon.holes.iter().map(|h| line(h.as_slice())));
        }
    }
    lines
}

/// Angle between two undirected axes, from 0 to a right angle, radians.
pub fn axis_difference_rad(a: f64, b: f64) -> f64 {
    let (s, c) = sin_cos(2.0 * (a - b));
    0.5 * atan2(s, c).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::direction;

    fn stripes(angle_rad: f64) -> MetricImage {
        let across = direction(angle_rad + 0.5 * PI);
        let grey = Grey::from_fn(240, 160, |x, y| {
            let d = DVec2::new(x as f64, y as f64).dot(across);
            0.5 + 0.3 * sin_cos(d * 0.9).0 as f32
        });
        MetricImage { grey, min_mm: DVec2::ZERO, px_mm: 0.1 }
    }

    #[test]
    fn stripes_have_their_angle_to_half_a_degree() {
        let settings = TensorSettings { gradient_mm: 0.12, integration_mm: 0.6, smooth_mm: 0.5 };
        for deg in [0.0f64, 7.0, 30.0, 45.0, 88.0, 120.0, 179.0] {
            let grid = grain_axes(&stripes(deg.to_radians()), &settings);
            let (mut worst, mut least) = (0.0f64, 1.0f64);
            for p in [(3.0, 3.0), (12.0, 8.0), (20.0, 13.0)].map(DVec2::from) {
                let s = grid.sample(p);
                worst = worst.max(axis_difference_rad(s.axis_rad(), deg.to_radians()));
                least = least.min(s.coherence);
            }
            assert!(worst.to_degrees() < 0.5, "{deg}: {}", worst.to_degrees());
            assert!(least > 0.9, "{deg}: coherence {least}");
        }
    }

    #[test]
    fn a_blank_picture_has_no_direction() {
        let settings = TensorSettings { gradient_mm: 0.12, integration_mm: 0.6, smooth_mm: 0.5 };
        for value in [0.0, 0.5, 1.0] {
            let image = MetricImage { grey: Grey::filled(200, 100, value), min_mm: DVec2::ZERO, px_mm: 0.1 };
            assert!(grain_axes(&image, &settings).mean_coherence() < 0.01);
        }
    }

    #[test]
    fn borders_bend_the_axes() {
        let settings = TensorSettings { gradient_mm: 0.12, integration_mm: 0.6, smooth_mm: 0.5 };
        let grid = grain_axes(&stripes(0.0), &settings);
        let hole = grainpath_core::Polygon {
            outer: Region::rectangle(DVec2::ZERO, DVec2::new(24.0, 16.0)).polygons[0].outer.clone(),
            holes: vec![
                (0..48)
                    .rev()
                    .map(|i| DVec2::new(12.0, 8.0) + 3.0 * direction(f64::from(i) * PI / 24.0))
                    .collect(),
            ],
        };
        let hole = Region::from(hole);
        let bent = along_lines(&grid, &border_lines(&hole, Tangent::Holes), 1.0, 1.0);
        let left = bent.sample(DVec2::new(9.0, 8.0)).axis_rad();
        assert!(axis_difference_rad(left, 0.5 * PI).to_degrees() < 12.0, "{}", left.to_degrees());
        let far = bent.sample(DVec2::new(2.0, 14.0)).axis_rad();
        assert!(axis_difference_rad(far, 0.0).to_degrees() < 3.0, "{}", far.to_degrees());
    }
}
