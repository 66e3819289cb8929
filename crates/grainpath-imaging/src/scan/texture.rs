//! The direction of a scan's texture: the structure tensor of the volume, slice by slice.
//!
//! # Method
//! For a fibre along `v` the tensor is `I - v v'`; for a plate with normal `n` it is `n n'`. Beads lie in
//! the plane of a layer, so they can follow the projection of the fibre or the section of the plate. The
//! coherence of each is the distinctness of its eigenvalue times the share that lies in the plane; both
//! candidates are added as doubled angles. Upright fibres have no direction in the plane and get no
//! weight. Gradients are central differences of fourth order on the smoothed scan, because those of
//! second order turn steep directions by degrees. Eigenvalues come from the closed form of Smith (1961).
//!
//! # Units, cost and limits
//! Lengths in mm in the scan's frame, angles in rad. Slices are read once; the sums over cells are held,
//! at most 2 million nodes and 300 MB. Voxels need not be cubes. A scan whose coherence falls over a
//! neighbourhood three times as wide is noise, and a warning says so.

use std::collections::VecDeque;

use grainpath_core::diagnostics::Stage;
use grainpath_core::math::{acos, asin, cos};
use grainpath_core::{Bounds2, DVec2, DVec3, Diagnostics, WarningId};
use rayon::prelude::*;
use serde::Serialize;

use super::{CtSettings, ScanError, Slices};
use crate::raster::{Grey, gaussian_taps, quantile};
use crate::structure_tensor::{AxisSample, Evidence, FAINT, smoothed, spread_darkness};

/// Settings for reading the texture of a scan, and the position of the scan on the part.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureSettings {
    /// Voxels to take, and their size. Settings for contours have no effect.
    pub scan: CtSettings,
    /// Name of the scan in reports.
    pub name: String,
    /// Position on the part of the lower left corner of the lowest voxel taken, mm. `None` puts the
    /// centre of the scan over that of the part, with its bottom on the plate.
    pub origin_mm: Option<DVec3>,
    /// Rotation about that corner, counter-clockwise, radians.
    pub rotate_rad: f64,
    /// Neighbourhood over which the direction is averaged, mm; at least two pixels.
    pub integration_mm: f64,
    /// Length over which clear places pass their direction to unclear ones, mm.
    pub smooth_mm: f64,
    /// How strongly lines close up where the scan is dense; 0 keeps their spacing even.
    pub darkness: f64,
    /// Whether pictures are wanted.
    pub pictures: bool,
    /// Bounds of the part, and its height in mm.
    pub part: (Bounds2, f64),
}

/// Measures of a scan's texture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct TextureReport {
    pub file: String,
    pub voxels: [usize; 3],
    /// Distance of the nodes at which directions are stored, mm.
    pub cell_mm: [f64; 3],
    /// Mean coherence in the plane of the layers, 0 to 1, weighted by contrast.
    pub coherence: f64,
    /// Share of nodes whose coherence is above 0.3.
    pub clear_share: f64,
    /// Mean angle between the texture's own axis and the plane of the layers, degrees, over places where
    /// it has an axis.
    pub lean_deg: f64,
}

/// An axis at every node of a grid in space.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisVolume {
    min_mm: DVec2,
    step_mm: DVec2,
    /// Heights of the nodes, rising.
    z_mm: Vec<f64>,
    n: [usize; 3],
    double: Vec<[f32; 2]>,
    coherence: Vec<f32>,
    dense: Vec<f32>,
}

impl AxisVolume {
    /// The axis at a point in the scan's own millimetres, linear between nodes. Outside the scan, that of
    /// the nearest node.
    pub fn sample(&self, p: DVec3) -> AxisSample {
        let place = |v: f64, n: usize| {
            let v = if v.is_nan() { 0.0 } else { v.clamp(0.0, n as f64 - 1.0) };
            let i = (v as usize).min(n.saturating_sub(2));
            (i, v - i as f64)
        };
        let [nx, ny, nz] = self.n;
        let at = (p.truncate() - self.min_mm) / self.step_mm;
        let ((i, u), (j, v)) = (place(at.x, nx), place(at.y, ny));
        // Heights may be uneven, so the node above is found by bisection.
        let above = self.z_mm.partition_point(|z| *z <= p.z).clamp(1, nz.max(2) - 1).min(nz - 1);
        let l = above.saturating_sub(1);
        let rise = self.z_mm[above] - self.z_mm[l];
        let w = if rise > 0.0 { ((p.z - self.z_mm[l]) / rise).clamp(0.0, 1.0) } else { 0.0 };
        let node = |k: usize| AxisSample {
            double: self.double[k].map(f64::from),
            coherence: self.coherence[k].into(),
            darkness: self.dense[k].into(),
        };
        let (right, up) = (usize::from(nx > 1), if ny > 1 { nx } else { 0 });
        let plane = |l: usize| {
            let k = (l * ny + j) * nx + i;
            let low = node(k).towards(node(k + right), u);
            low.towards(node(k + up).towards(node(k + up + right), u), v)
        };
        plane(l).towards(plane(above), w)
    }

    fn clear_share(&self, coherence: f32) -> f64 {
        let clear = self.coherence.iter().filter(|c| **c >= coherence).count();
        clear as f64 / self.coherence.len().max(1) as f64
    }
}

/// A slice that is kept for a picture with the directions found on it.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownSlice {
    /// Number of the slice in the scan, from 0.
    pub index: usize,
    /// Height of the slice in the scan, mm.
    pub height_mm: f64,
    /// Sides of a pixel, mm.
    pub pixel_mm: DVec2,
    /// Grey values of the slice, smoothed, rows from the bottom.
    pub grey: Grey,
}

/// The result of [`read_texture`].
pub struct Texture {
    /// The axes, in the scan's own millimetres.
    pub axes: AxisVolume,
    /// Statistics of the texture.
    pub report: TextureReport,
    /// Some of the slices, for pictures, if those were asked for.
    pub shown: Vec<ShownSlice>,
}

/// Limit on the nodes. Source: derived. A node takes about 150 bytes while all of them are computed, 300 MB at the limit.
const MAX_NODES: usize = 2_000_000;
/// Standard deviation of the Gaussian before gradients are taken, pixels. One pixel suppresses noise
/// between neighbouring voxels and keeps fibres two voxels wide; a larger value loses thin fibres.
const GRADIENT_PX: f64 = 1.0;
/// Coherence over a wide neighbourhood below which the user is warned that there is hardly any texture.
/// Only the warning depends on the value.
const LEAST_COHERENCE: f64 = 0.2;

/// Reads the texture of a scan, a few slices at a time.
///
/// # Errors
/// [`ScanError`] for files that cannot be read and when a stop was asked for.
pub fn read_texture(
    slices: &mut Slices<'_>,
    s: &TextureSettings,
    diagnostics: &Diagnostics,
) -> Result<Texture, ScanError> {
    let n = slices.size();
    let spacing = slices.spacing_mm();
    let heights = slices.heights_mm();
    let pixel = 0.5 * (spacing[0] + spacing[1]);
    let integration_mm = s.integration_mm.max(2.0 * pixel);
    let cell = cells(n, [pixel, pixel, spacing[2]], integration_mm);
    diagnostics.begin(Stage::Guide, n[2]);
    let Sums { n: nodes, each, shown } = sums(slices, cell, s.pictures, diagnostics)?;
    let step = [pixel * cell[0] as f64, spacing[2] * cell[2] as f64];
    let sigma = step.map(|step| integration_mm / step);
    let near: Vec<Vec<f32>> = each.iter().map(|c| blurred(c, nodes, sigma)).collect();
    let range = {
        let mut grey = each[6].clone();
        (quantile(&mut grey, 0.98) - quantile(&mut grey, 0.02)).abs()
    };
    // The sums are the largest arrays; they are freed before the next ones are made.
    drop(each);
    // Contrast below this share of the range of grey values counts as blank.
    let floor = FAINT * FAINT * range * range;
    let found: Vec<Node> =
        (0..near[0].len()).into_par_iter().with_min_len(4096).map(|k| Node::mean(&near, k, floor)).collect();
    // Noise is coherent by chance over a few voxels, texture over many. The coherence over three times the neighbourhood
    // tells them apart.
    let wide = {
        let wide: Vec<Vec<f32>> =
            near[..6].iter().map(|c| blurred(c, nodes, sigma.map(|s| 3.0 * s))).collect();
        let all: Vec<Node> = (0..found.len())
            .into_par_iter()
            .with_min_len(4096)
            .map(|k| Node::mean(&wide, k, floor))
            .collect();
        mean_coherence(&all)
    };
    if wide < LEAST_COHERENCE {
        diagnostics.warn(WarningId::GrainUnclear, format!(
            "{}: hardly any direction in the layers' plane: its coherence is {wide:.2} (0 none, 1 perfect; bone and fibres have 0.3 and more)",
            s.name
        ));
    }
    let typical = found.iter().map(|f| f64::from(f.energy)).sum::<f64>() / found.len().max(1) as f64;
    let evidence = Evidence {
        double: found.iter().map(|f| f.double).collect(),
        weight: found
            .iter()
            // As for photographs: the weight is the square of the coherence, times an energy that saturates at its mean.
            .map(|f| f.coherence * f.coherence * f.energy / (f.energy + 0.25 * typical as f32 + 1e-30))
            .collect(),
    };
    let reach = [s.smooth_mm / step[0], s.smooth_mm / step[0], s.smooth_mm / step[1]];
    let mut dense: Vec<f32> = near[6].iter().map(|v| -v).collect();
    drop(near);
    spread_darkness(&mut dense);
    let mut axes = AxisVolume {
        min_mm: 0.5 * DVec2::new(spacing[0], spacing[1]) * cell[0] as f64,
        step_mm: DVec2::new(spacing[0], spacing[1]) * cell[0] as f64,
        // A cell's height is the mean of its slices.
        z_mm: heights.chunks_exact(cell[2]).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect(),
        n: nodes,
        double: smoothed(nodes, &evidence, reach),
        coherence: found.iter().map(|f| f.coherence).collect(),
        dense,
    };
    axes.z_mm.truncate(nodes[2]);
    if axes.z_mm.first() > axes.z_mm.last() {
        // A scan taken upside down arrives from the top.
        axes.z_mm.reverse();
        let plane = nodes[0] * nodes[1];
        axes.double = axes.double.chunks_exact(plane).rev().flatten().copied().collect();
        axes.coherence = axes.coherence.chunks_exact(plane).rev().flatten().copied().collect();
        axes.dense = axes.dense.chunks_exact(plane).rev().flatten().copied().collect();
    }
    let round = |v: f64| (v * 1e4).round() * 1e-4;
    let report = TextureReport {
        file: s.name.clone(),
        voxels: n,
        cell_mm: [axes.step_mm.x, axes.step_mm.y, step[1]].map(round),
        coherence: round(mean_coherence(&found)),
        clear_share: round(axes.clear_share(0.3)),
        lean_deg: round(mean_lean_rad(&found).to_degrees()),
    };
    let pixel_mm = DVec2::new(spacing[0], spacing[1]);
    let shown = shown
        .into_iter()
        .map(|(index, grey)| ShownSlice { index, height_mm: heights[index], pixel_mm, grey })
        .collect();
    Ok(Texture { axes, report, shown })
}

/// Voxels of a cell along x, y and z: fine enough for the neighbourhood, and at most [`MAX_NODES`] cells.
fn cells(n: [usize; 3], spacing_mm: [f64; 3], integration_mm: f64) -> [usize; 3] {
    // The tensor is smoothed over the neighbourhood, so 2.5 cells for each standard deviation lose
    // nothing.
    let fine = |k: usize| ((integration_mm / spacing_mm[k] / 2.5).floor() as usize).clamp(1, n[k]);
    let mut plane = fine(0).min(n[1]);
    let mut depth = fine(2);
    while (n[0] / plane) * (n[1] / plane) * (n[2] / depth) > MAX_NODES {
        let wider = plane < n[0].min(n[1]);
        // The shorter side of a cell grows, so that cells stay nearly cubes.
        let deeper = depth < n[2] && (!wider || depth as f64 * spacing_mm[2] < plane as f64 * spacing_mm[0]);
        if deeper { depth += 1 } else { plane += 1 }
    }
    [plane, plane, depth]
}

/// Means over cells.
struct Sums {
    n: [usize; 3],
    /// Products xx, yy, zz, xy, yz, zx of the gradient, and the grey value: means over each cell.
    each: [Vec<f32>; 7],
    /// Slices for pictures, by their number.
    shown: Vec<(usize, Grey)>,
}

fn sums(
    slices: &mut Slices<'_>,
    cell: [usize; 3],
    pictures: bool,
    diagnostics: &Diagnostics,
) -> Result<Sums, ScanError> {
    let size = slices.size();
    let n: [usize; 3] = std::array::from_fn(|k| size[k] / cell[k]);
    let spacing = slices.spacing_mm();
    let pixel = 0.5 * (spacing[0] + spacing[1]);
    let shown_at: Vec<usize> =
        // Pictures show the slices at a quarter, a half and three quarters of the height; the end slices show little.
        if pictures { vec![size[2] / 4, size[2] / 2, 3 * size[2] / 4] } else { Vec::new() };
    let mut smoother = Smoother {
        size,
        // The Gaussian is as long across slices as within them, and at least 0.3 slices to suppress noise.
        taps: gaussian_taps((GRADIENT_PX * pixel / spacing[2]).max(0.3)),
        held: VecDeque::new(),
        first: 0,
        number: 0,
        shown_at,
        shown: Vec::new(),
        slices,
    };
    // Converts all directions to the same unit, a step per pixel.
    let per_px = [pixel / spacing[0], pixel / spacing[1], pixel / spacing[2]].map(|s| s as f32);
    let mut window: VecDeque<Vec<f32>> = VecDeque::new();
    let mut first = 0;
    let mut each: [Vec<f32>; 7] = Default::default();
    let mut slab = vec![[0.0f32; 7]; n[0] * n[1]];
    let last = size[2] - 1;
    for k in 0..n[2] * cell[2] {
        diagnostics.check()?;
        // Differences of the fourth order need two slices below and above.
        while first + window.len() <= (k + 2).min(last) {
            window.push_back(smoother.next()?);
        }
        while first + 2 < k {
            window.pop_front();
            first += 1;
        }
        let plane = |d: isize| &window[(k as isize + d).clamp(0, last as isize) as usize - first][..];
        let planes = [plane(-2), plane(-1), plane(0), plane(1), plane(2)];
        slab.par_chunks_mut(n[0]).enumerate().for_each_init(
            || vec![0.0f32; 3 * size[0]],
            |rows, (j, row)| {
                for y in j * cell[1]..(j + 1) * cell[1] {
                    gradients(&planes, size, y, per_px, rows);
                    add_row(rows, &planes[2][y * size[0]..(y + 1) * size[0]], cell[0], row);
                }
            },
        );
        if (k + 1) % cell[2] == 0 {
            let share = 1.0 / (cell[0] * cell[1] * cell[2]) as f32;
            for (c, out) in each.iter_mut().enumerate() {
                out.extend(slab.iter().map(|s| s[c] * share));
            }
            slab.fill([0.0; 7]);
        }
        diagnostics.advance(1);
    }
    Ok(Sums { n, each, shown: smoother.shown })
}

/// Slices smoothed in all three directions, one after another.
struct Smoother<'a, 'b> {
    slices: &'a mut Slices<'b>,
    size: [usize; 3],
    taps: Vec<f32>,
    /// Slices smoothed in their own plane, from number `first` on.
    held: VecDeque<Grey>,
    first: usize,
    /// Number of the slice that comes next.
    number: usize,
    shown_at: Vec<usize>,
    shown: Vec<(usize, Grey)>,
}

impl Smoother<'_, '_> {
    /// The next slice. The caller asks for no more slices than there are.
    fn next(&mut self) -> Result<Vec<f32>, ScanError> {
        let [width, height, nz] = self.size;
        let r = self.taps.len() - 1;
        let k = self.number;
        self.number += 1;
        while self.first + self.held.len() <= (k + r).min(nz - 1) {
            let number = self.first + self.held.len();
            let grey = Grey { width, height, data: self.slices.next_slice()? };
            self.held.push_back(grey.blurred(GRADIENT_PX));
            if self.shown_at.contains(&number) {
                self.shown.push((number, grey));
            }
        }
        while self.first + r < k {
            self.held.pop_front();
            self.first += 1;
        }
        let plane = |i: usize| &self.held[i - self.first].data;
        let mut out = vec![0.0f32; width * height];
        // The slice is summed in pieces that fit the cache, however many slices the Gaussian spans.
        let chunk = 1 << 14;
        out.par_chunks_mut(chunk).enumerate().for_each(|(c, out)| {
            let part = |i: usize| &plane(i)[c * chunk..c * chunk + out.len()];
            let taps = self.taps.iter().enumerate();
            let sources: Vec<(f32, &[f32], &[f32])> =
                taps.map(|(d, &t)| (t, part(k.saturating_sub(d)), part((k + d).min(nz - 1)))).collect();
            out.iter_mut().zip(sources[0].1).for_each(|(o, v)| *o = sources[0].0 * v);
            for (t, low, high) in &sources[1..] {
                out.iter_mut().zip(*low).zip(*high).for_each(|((o, a), b)| *o += t * (a + b));
            }
        });
        Ok(out)
    }
}

/// Derivatives along x, y and z for a row, one after another in `out`. They are central differences of
/// fourth order, because those of second order turn steep directions by degrees.
fn gradients(planes: &[&[f32]; 5], [nx, ny, _]: [usize; 3], y: usize, per_px: [f32; 3], out: &mut [f32]) {
    let row = |d: isize| {
        let y = (y as isize + d).clamp(0, ny as isize - 1) as usize;
        &planes[2][y * nx..(y + 1) * nx]
    };
    let across = |k: usize| &planes[k][y * nx..(y + 1) * nx];
    let slope = |a: f32, b: f32, c: f32, d: f32| (8.0 * (c - b) - (d - a)) * (1.0 / 12.0);
    let (gx, rest) = out.split_at_mut(nx);
    let (gy, gz) = rest.split_at_mut(nx);
    let middle = row(0);
    let at = |x: usize, d: isize| middle[(x as isize + d).clamp(0, nx as isize - 1) as usize];
    // Two pixels at each end repeat the border; the loop below needs no conditions.
    for x in (0..nx.min(2)).chain(nx.saturating_sub(2)..nx) {
        gx[x] = slope(at(x, -2), at(x, -1), at(x, 1), at(x, 2)) * per_px[0];
    }
    if nx > 4 {
        for (g, w) in gx[2..nx - 2].iter_mut().zip(middle.windows(5)) {
            *g = slope(w[0], w[1], w[3], w[4]) * per_px[0];
        }
    }
    let [a, b, c, d] = [row(-2), row(-1), row(1), row(2)];
    for x in 0..nx {
        gy[x] = slope(a[x], b[x], c[x], d[x]) * per_px[1];
    }
    let [a, b, c, d] = [across(0), across(1), across(3), across(4)];
    for x in 0..nx {
        gz[x] = slope(a[x], b[x], c[x], d[x]) * per_px[2];
    }
}

/// Adds the products and grey values of a row to its cells.
fn add_row(gradients: &[f32], grey: &[f32], cell: usize, cells: &mut [[f32; 7]]) {
    let nx = grey.len();
    let [gx, gy, gz] = [0, 1, 2].map(|k| &gradients[k * nx..(k + 1) * nx]);
    for (i, sum) in cells.iter_mut().enumerate() {
        for x in i * cell..(i + 1) * cell {
            let (x, y, z, v) = (gx[x], gy[x], gz[x], grey[x]);
            for (s, v) in sum.iter_mut().zip([x * x, y * y, z * z, x * y, y * z, z * x, v]) {
                *s += v;
            }
        }
    }
}

/// The values smoothed by a Gaussian. `plane` and `depth` are its standard deviations within the layers' plane and across
/// it, in nodes.
fn blurred(values: &[f32], [nx, ny, nz]: [usize; 3], [plane, depth]: [f64; 2]) -> Vec<f32> {
    let mut flat = Vec::with_capacity(values.len());
    for l in 0..nz {
        let data = values[l * nx * ny..(l + 1) * nx * ny].to_vec();
        flat.extend(Grey { width: nx, height: ny, data }.blurred(plane).data);
    }
    // A narrower Gaussian has all its weight at its centre.
    if depth < 0.05 {
        return flat;
    }
    let taps = gaussian_taps(depth);
    let mut out = vec![0.0f32; flat.len()];
    out.par_chunks_mut(nx * ny).enumerate().for_each(|(l, out)| {
        let level = |l: usize| &flat[l * nx * ny..(l + 1) * nx * ny];
        out.iter_mut().zip(level(l)).for_each(|(o, v)| *o = taps[0] * v);
        for (d, t) in taps.iter().enumerate().skip(1) {
            let (low, high) = (level(l.saturating_sub(d)), level((l + d).min(nz - 1)));
            out.iter_mut().zip(low).zip(high).for_each(|((o, a), b)| *o += t * (a + b));
        }
    });
    out
}

/// The axis that the tensor at a node gives, with its weights.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Cosine and sine of twice the angle of the axis in the layers' plane, unit length.
    double: [f32; 2],
    coherence: f32,
    energy: f32,
    /// Angle between the texture's own axis and the plane, radians.
    lean_rad: f32,
    line: f32,
}

impl Node {
    fn mean(each: &[Vec<f32>], k: usize, floor: f32) -> Self {
        let tensor: [f64; 6] = std::array::from_fn(|c| f64::from(each[c][k]));
        let floor = f64::from(floor) + 1e-30;
        let e = eigenvalues(tensor);
        // The texture counts fully as a fibre where the middle eigenvalue is at least halfway between the others. Curved
        // plates count partly as fibres.
        let fibrous = (2.0 * (e[1] - e[2]) / (e[0] - e[2] + floor)).min(1.0);
        let line = fibrous * (e[1] - e[2]) / (e[1] + e[2].max(0.0) + floor);
        let plate = (1.0 - fibrous) * (e[0] - e[1]) / (e[0] + e[1].max(0.0) + floor);
        let (v, n) = (eigenvector(tensor, e[2]), eigenvector(tensor, e[0]));
        // Doubled angles of both candidates are added with their weights; the plate's line is at a right
        // angle to its normal.
        let c = line * (v.x * v.x - v.y * v.y) + plate * (n.y * n.y - n.x * n.x);
        let s = 2.0 * (line * v.x * v.y - plate * n.x * n.y);
        let length = (c * c + s * s).sqrt();
        Self {
            double: if length > 0.0 { [(c / length) as f32, (s / length) as f32] } else { [1.0, 0.0] },
            coherence: length.min(1.0) as f32,
            energy: e.iter().sum::<f64>() as f32,
            lean_rad: asin(v.z.abs().min(1.0)) as f32,
            line: line.clamp(0.0, 1.0) as f32,
        }
    }
}

fn mean_coherence(nodes: &[Node]) -> f64 {
    weighted_mean(nodes, |n| (n.coherence, n.energy))
}

fn mean_lean_rad(nodes: &[Node]) -> f64 {
    weighted_mean(nodes, |n| (n.lean_rad, n.energy * n.line))
}

fn weighted_mean(nodes: &[Node], value_and_weight: impl Fn(&Node) -> (f32, f32)) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for node in nodes {
        let (v, w) = value_and_weight(node);
        sum += f64::from(v) * f64::from(w);
        weight += f64::from(w);
    }
    if weight > 0.0 { sum / weight } else { 0.0 }
}

/// Eigenvalues of a symmetric tensor xx, yy, zz, xy, yz, zx, in descending order. The closed form (Smith
/// 1961) loses half its digits where two are equal. The angles here do not depend on those digits.
fn eigenvalues([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> [f64; 3] {
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let p = ((a * a + b * b + c * c + 2.0 * (xy * xy + yz * yz + zx * zx)) / 6.0).sqrt();
    // A multiple of the identity has no axes; the division below would be by zero.
    if p <= 1e-15 * mean.abs() {
        return [mean; 3];
    }
    let det = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
    let third = acos((det / (2.0 * p * p * p)).clamp(-1.0, 1.0)) / 3.0;
    let first = mean + 2.0 * p * cos(third);
    let last = mean + 2.0 * p * cos(third + 2.0 * std::f64::consts::PI / 3.0);
    [first, 3.0 * mean - first - last, last]
}

/// The unit axis of an eigenvalue; zero where another eigenvalue is equal.
fn eigenvector([xx, yy, zz, xy, yz, zx]: [f64; 6], value: f64) -> DVec3 {
    // The axis is perpendicular to every row of the tensor minus the eigenvalue. The two rows that are
    // farthest from parallel give it best.
    let rows =
        [DVec3::new(xx - value, xy, zx), DVec3::new(xy, yy - value, yz), DVec3::new(zx, yz, zz - value)];
    let across = [rows[0].cross(rows[1]), rows[1].cross(rows[2]), rows[2].cross(rows[0])];
    let longer = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
    across.into_iter().fold(DVec3::ZERO, longer).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use grainpath_core::math::{direction, exp, sin_cos};
    use grainpath_core::slices::{SampleType, SliceError, SliceSource, VolumeInfo};

    use super::super::Threshold;
    use super::*;
    use crate::structure_tensor::axis_difference_rad;

    /// A volume made up as it is read.
    struct Made<F: Fn(DVec3) -> f64 + Send> {
        info: VolumeInfo,
        grey: F,
        next: usize,
    }

    impl<F: Fn(DVec3) -> f64 + Send> SliceSource for Made<F> {
        fn info(&self) -> &VolumeInfo {
            &self.info
        }

        fn restart(&mut self) -> Result<(), SliceError> {
            self.next = 0;
            Ok(())
        }

        fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
            let [nx, ny, nz] = self.info.size;
            let s = DVec3::from(self.info.spacing_mm.map(|v| v.unwrap_or(1.0)));
            out.clear();
            let at = |i: usize| i as f64 + 0.5;
            let z = at(self.next);
            out.extend((0..nx * ny).map(|p| (self.grey)(DVec3::new(at(p % nx), at(p / nx), z) * s) as f32));
            self.next += 1;
            Ok(self.next <= nz)
        }

        fn skip_slice(&mut self) -> Result<bool, SliceError> {
            self.next += 1;
            Ok(self.next <= self.info.size[2])
        }
    }

    fn read(
        size: [usize; 3],
        spacing: [f64; 3],
        flip: &str,
        grey: impl Fn(DVec3) -> f64 + Send,
    ) -> (Texture, Vec<grainpath_core::Warning>) {
        let mut info = VolumeInfo::new("made", size, SampleType::U16);
        info.spacing_mm = spacing.map(Some);
        let flipped = ["x", "y", "z"].map(|axis| flip.contains(axis));
        let scan =
            CtSettings { flip: flipped, threshold: Threshold::Otsu, ..super::super::tests::settings() };
        let settings = TextureSettings {
            scan,
            name: "made".into(),
            origin_mm: None,
            rotate_rad: 0.0,
            integration_mm: 0.6,
            smooth_mm: 0.4,
            darkness: 0.0,
            pictures: false,
            part: (Bounds2 { min: DVec2::ZERO, max: DVec2::ONE }, 1.0),
        };
        let mut source = Made { info, grey, next: 0 };
        let diagnostics = Diagnostics::default();
        let mut slices = Slices::new(&mut source, &settings.scan).expect("slices");
        let texture = read_texture(&mut slices, &settings, &diagnostics).expect("a texture");
        (texture, diagnostics.warnings())
    }

    /// Fibres along `v`, some 0.8 mm apart, at places that follow no grid.
    fn fibres(v: DVec3) -> impl Fn(DVec3) -> f64 + Send {
        let a = v.any_orthonormal_vector();
        let b = v.cross(a);
        move |p: DVec3| {
            let (x, y) = (p.dot(a) / 0.8, p.dot(b) / 0.8);
            let wave = |u: f64, k: f64| sin_cos(2.0 * PI * u * k + 1.3 * k).0;
            100.0 + 40.0 * (wave(x, 1.0) + wave(y, 1.1) + 0.6 * wave(x + y, 0.73) + 0.6 * wave(x - y, 0.57))
        }
    }

    #[test]
    fn fibres_have_their_direction_and_lean() {
        for (deg, lean_deg) in [(0.0f64, 0.0f64), (27.0, 0.0), (61.0, 25.0), (118.0, 40.0), (160.0, 60.0)] {
            let d = direction(deg.to_radians());
            let (s, c) = sin_cos(lean_deg.to_radians());
            let v = DVec3::new(c * d.x, c * d.y, s);
            let (texture, warnings) = read([60, 56, 48], [0.1, 0.1, 0.12], "", fibres(v));
            let mut worst = 0.0f64;
            for p in [(3.0, 2.8, 2.9), (2.0, 4.0, 1.5), (4.1, 1.5, 4.2)].map(DVec3::from) {
                let off = axis_difference_rad(texture.axes.sample(p).axis_rad(), deg.to_radians());
                worst = worst.max(off.to_degrees());
            }
            let r = &texture.report;
            println!(
                "{deg} leaning {lean_deg}: {worst:.2} deg off, coherence {:.2}, lean {:.1}",
                r.coherence, r.lean_deg
            );
            assert!(worst < 3.0, "{deg} leaning {lean_deg}: {worst} degrees off");
            assert!((r.lean_deg - lean_deg).abs() < 3.0, "leans {} instead of {lean_deg}", r.lean_deg);
            // Fibres that lean out of the plane are less coherent in it, by the square of the cosine.
            assert!((r.coherence - c * c).abs() < 0.2, "coherence {} for cos2 {}", r.coherence, c * c);
            assert!(warnings.is_empty(), "{warnings:?}");
        }
    }

    #[test]
    fn what_turns_with_height_is_followed_and_mirrored_with_the_scan() {
        // Plates that turn by a right angle from bottom to top, about the upright through (3, 3).
        let plates = |p: DVec3| {
            let across = direction(0.25 * PI * p.z / 3.0 + 0.5 * PI);
            100.0 + 50.0 * sin_cos(2.0 * PI * (p.truncate() - 3.0).dot(across) / 0.9).0
        };
        let wanted = |z: f64| 0.25 * PI * z / 3.0;
        let (upright, _) = read([60, 60, 60], [0.1; 3], "", plates);
        let (turned, _) = read([60, 60, 60], [0.1; 3], "z", plates);
        for z in [1.0, 3.0, 5.0] {
            let p = DVec3::new(3.0, 3.0, z);
            let off = axis_difference_rad(upright.axes.sample(p).axis_rad(), wanted(z)).to_degrees();
            assert!(off < 4.0, "{off} degrees off at {z} mm");
            let q = DVec3::new(3.0, 3.0, 6.0 - z);
            let off = axis_difference_rad(turned.axes.sample(q).axis_rad(), wanted(z)).to_degrees();
            assert!(off < 4.0, "upside down {off} degrees off at {z} mm");
        }
    }

    #[test]
    fn blobs_and_upright_fibres_give_nothing_to_follow_and_say_so() {
        let blob = |p: DVec3| {
            let cell = (p / 0.7).floor();
            let [i, j, k] = cell.to_array().map(|v| v as i64);
            let mut h = (i * 73_856_093 + j * 19_349_663 + k * 83_492_791) as u64;
            h = (h ^ h >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let jitter = |k: u32| ((h >> (16 * k) & 255) as f64 / 255.0 - 0.5) * 0.3;
            let c = (cell + 0.5 + DVec3::new(jitter(1), jitter(2), jitter(3))) * 0.7;
            100.0 + 80.0 * exp(-(p - c).length_squared() / 0.02)
        };
        let (texture, warnings) = read([60, 60, 60], [0.1; 3], "", blob);
        assert!(warnings.iter().any(|w| w.text.contains("hardly any direction")), "{:?}", texture.report);
        let (texture, warnings) = read([60, 60, 60], [0.1; 3], "", fibres(DVec3::Z));
        assert!(warnings.iter().any(|w| w.text.contains("hardly any direction")), "{:?}", texture.report);
        assert!(texture.report.lean_deg > 85.0);
        // Nothing at all is no panic.
        let (texture, _) = read([9, 7, 3], [0.1, 0.1, 0.5], "", |_| 5.0);
        assert_eq!(texture.report.coherence, 0.0);
    }

    #[test]
    fn large_scans_are_kept_in_no_more_nodes_than_fit() {
        for n in [[2048, 2048, 2000], [20_000, 20_000, 3], [10, 10, 100_000_000], [1, 1, 1]] {
            let [a, b, c] = cells(n, [0.01, 0.01, 0.02], 0.02);
            assert!((n[0] / a) * (n[1] / b) * (n[2] / c) <= MAX_NODES && a <= n[0] && b <= n[1] && c <= n[2]);
        }
    }

    #[test]
    fn eigenvalues_are_those_of_known_tensors() {
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near(eigenvalues([2.0, 5.0, 3.0, 0.0, 0.0, 0.0]), [5.0, 3.0, 2.0]));
        assert!(near(eigenvalues([2.0, 2.0, 3.0, 1.0, 0.0, 0.0]), [3.0, 3.0, 1.0]));
        assert!(near(eigenvalues([1.0, 1.0, 1.0, 1.0, 1.0, 1.0]), [3.0, 0.0, 0.0]));
        assert!(near(eigenvalues([0.0; 6]), [0.0; 3]));
    }
}
