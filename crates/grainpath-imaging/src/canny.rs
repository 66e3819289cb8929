//! Canny's edge detector (`canny1986` in docs/references.bib): Sobel gradients, non-maximum suppression,
//! hysteresis between two thresholds.
//!
//! # Method
//! The caller smooths the picture. A pixel is a candidate where its gradient magnitude is greatest along
//! the gradient; the magnitudes one step to both sides are interpolated between two neighbours.
//! Candidates above the high threshold begin edges, those above the low one continue them. Without
//! settings the thresholds follow from the candidates: the strongest 40 % begin edges. The edge lies
//! between pixels at the vertex of a parabola through three magnitudes.
//!
//! # Units, cost and limits
//! Pictures are `(height, width)`, row-major, brightness 0 to 1; gradients are brightness per pixel. The
//! cost is linear in the pixels. Border pixels are never edges. A blank picture has no edges, because
//! candidates below 1e-5 are ignored. No library is used, because images may have any depth and because
//! curves need edge positions finer than a pixel.

use rayon::prelude::*;

use super::raster::{Grey, mix, quantile, three};

/// Thresholds on the gradient, as shares of its 99th percentile among edge candidates; `None` chooses
/// them from the picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CannySettings {
    /// Gradients above this begin an edge.
    pub high: Option<f64>,
    /// Gradients above this continue an edge; 0.4 of `high` where not given.
    pub low: Option<f64>,
}

/// The edge pixels of a picture, with the data needed to locate edges more finely than a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Edges {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Whether each pixel is on an edge.
    pub mask: Vec<bool>,
    /// The thresholds that were used: low and high, brightness per pixel.
    pub thresholds: [f32; 2],
    slopes: Grey,
    smooth: Grey,
}

/// Finds the edges of a picture that has been smoothed already. A blank picture has none.
pub fn canny(smooth: &Grey, settings: &CannySettings) -> Edges {
    let (w, h) = (smooth.width, smooth.height);
    let slopes = slopes(smooth);
    let crests = crests(smooth, &slopes);
    let thresholds = thresholds(&crests, settings);
    let mask = hysteresis(&crests, thresholds);
    Edges { width: w, height: h, mask, thresholds, slopes, smooth: smooth.clone() }
}

/// Magnitude of [`gradient`] at every pixel.
fn slopes(smooth: &Grey) -> Grey {
    let w = smooth.width;
    let mut out = Grey::filled(w, smooth.height, 0.0);
    out.data.par_chunks_mut(w.max(1)).enumerate().for_each_init(
        || [(); 2].map(|()| vec![0.0f32; w]),
        |[gx, gy], (y, out)| {
            gradient_row(smooth, y, gx, gy);
            out.iter_mut().zip(&*gx).zip(&*gy).for_each(|((s, x), y)| *s = (x * x + y * y).sqrt());
        },
    );
    out
}

/// Sobel gradient along row `y`, in grey values per pixel. Beyond the border the outermost pixel repeats.
pub(crate) fn gradient_row(smooth: &Grey, y: usize, gx: &mut [f32], gy: &mut [f32]) {
    let w = smooth.width;
    let row = |y: usize| &smooth.data[y * w..(y + 1) * w];
    let (a, b, c) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(smooth.height - 1)));
    let n = w.saturating_sub(2);
    let ([al, am, ar], [bl, _, br], [cl, cm, cr]) = (three(a), three(b), three(c));
    let inner = w.min(1)..w.min(1) + n;
    let (inner_x, inner_y) = (&mut gx[inner.clone()], &mut gy[inner]);
    // The inner pixels need no bounds checks, so the compiler processes several at a time; the two border
    // pixels follow below.
    for k in 0..n {
        // The weights 1, 2, 1 over two pixels sum to 8, so 1/8 gives the slope per pixel.
        inner_x[k] = 0.125 * ((ar[k] - al[k]) + 2.0 * (br[k] - bl[k]) + (cr[k] - cl[k]));
        inner_y[k] = 0.125 * ((cl[k] - al[k]) + 2.0 * (cm[k] - am[k]) + (cr[k] - ar[k]));
    }
    for x in [0, w - 1] {
        [gx[x], gy[x]] = gradient(smooth, x, y);
    }
}

/// Sobel gradient of one pixel, brightness per pixel. Beyond the border the outermost pixel repeats.
fn gradient(grey: &Grey, x: usize, y: usize) -> [f32; 2] {
    let w = grey.width;
    let (l, r) = (x.saturating_sub(1), (x + 1).min(w - 1));
    let row = |y: usize| &grey.data[y * w..(y + 1) * w];
    let (a, b, c) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(grey.height - 1)));
    let gx = (a[r] - a[l]) + 2.0 * (b[r] - b[l]) + (c[r] - c[l]);
    let gy = (c[l] - a[l]) + 2.0 * (c[x] - a[x]) + (c[r] - a[r]);
    [gx / 8.0, gy / 8.0]
}

/// Gradients below this count as zero, brightness per pixel. Source: derived. It is above the rounding of `f32` near 1
/// (6e-8) and far below the lowest threshold (4e-4).
const FLAT: f32 = 1e-5;

/// The gradient magnitude where it is greatest along the gradient's direction, zero at all other pixels
/// (non-maximum suppression).
fn crests(smooth: &Grey, slopes: &Grey) -> Grey {
    let (w, h) = (smooth.width, smooth.height);
    let mut out = Grey::filled(w, h, 0.0);
    out.data.par_chunks_mut(w.max(1)).enumerate().for_each_init(
        || [(); 2].map(|()| vec![0.0f32; w]),
        |[gx, gy], (y, out)| {
            // Border pixels have no neighbour on one side and are never edges.
            if y == 0 || y + 1 >= h {
                return;
            }
            gradient_row(smooth, y, gx, gy);
            let row = |y: usize| &slopes.data[y * w..(y + 1) * w];
            let n = w.saturating_sub(2);
            let [[al, am, ar], [bl, bm, br], [cl, cm, cr]] = [y - 1, y, y + 1].map(|y| three(row(y)));
            let inner = w.min(1)..w.min(1) + n;
            let (gx, gy, out) = (&gx[inner.clone()], &gy[inner.clone()], &mut out[inner]);
            // The loop has no branches, so that the compiler processes several pixels at a time.
            for x in 0..n {
                let (ax, ay, same) = (gx[x].abs(), gy[x].abs(), gx[x] * gy[x] >= 0.0);
                let level = ax >= ay;
                let (least, most) = if level { (ay, ax) } else { (ax, ay) };
                let t = least / most.max(f32::MIN_POSITIVE);
                // The neighbour along the nearer axis and the diagonal neighbour: the magnitude one step
                // along the gradient is interpolated between them.
                let (ahead, behind) = if same { (br[x], bl[x]) } else { (bl[x], br[x]) };
                let (ahead, behind) = if level { (ahead, behind) } else { (cm[x], am[x]) };
                let (down, up) = if same { (cr[x], al[x]) } else { (cl[x], ar[x]) };
                let (forth, back) = (mix(ahead, down, t), mix(behind, up, t));
                let here = bm[x];
                // Of two equal magnitudes side by side the first is the edge, so that a plateau gives one
                // line and not two.
                let is_crest = (here >= FLAT) & (here > back) & (here >= forth);
                out[x] = if is_crest { here } else { 0.0 };
            }
        },
    );
    out
}

fn thresholds(crests: &Grey, settings: &CannySettings) -> [f32; 2] {
    let mut values: Vec<f32> = crests.data.iter().copied().filter(|v| *v > 0.0).collect();
    // The 99th percentile is used instead of the maximum, because a single bright scratch must not set the scale.
    let steepest = quantile(&mut values, 0.99);
    // Without a setting the strongest 40 % of candidates begin edges.
    let high = settings.high.map_or_else(|| quantile(&mut values, 0.6), |h| h as f32 * steepest);
    let low = settings.low.map_or(0.4 * high, |l| l as f32 * steepest);
    // A gradient of a thousandth of white is a quarter of an 8-bit step, so it is noise in every
    // photograph.
    let high = high.max(1e-3);
    [low.clamp(4e-4, high), high]
}

/// Candidates above the high threshold, and those above the low one that are connected with them.
fn hysteresis(crests: &Grey, [low, high]: [f32; 2]) -> Vec<bool> {
    let (w, h) = (crests.width, crests.height);
    let mut mask = vec![false; w * h];
    // A stack is kept instead of recursion, because an edge may be millions of pixels long.
    let mut stack = Vec::new();
    for k in 0..w * h {
        if crests.data[k] >= high && !mask[k] {
            mask[k] = true;
            stack.push(k);
        }
        while let Some(k) = stack.pop() {
            for n in neighbours(k, w, h).into_iter().flatten() {
                if !mask[n] && crests.data[n] >= low {
                    mask[n] = true;
                    stack.push(n);
                }
            }
        }
    }
    mask
}

/// The eight neighbours of a pixel, row by row.
fn neighbours(k: usize, w: usize, h: usize) -> [Option<usize>; 8] {
    let (x, y) = (k % w, k / w);
    let at = |dx: isize, dy: isize| {
        let (nx, ny) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
        (nx < w && ny < h).then(|| ny * w + nx)
    };
    [at(-1, -1), at(0, -1), at(1, -1), at(-1, 0), at(1, 0), at(-1, 1), at(0, 1), at(1, 1)]
}

impl Edges {
    /// Neighbours of pixel `k` that are on an edge.
    pub(crate) fn next_to(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        neighbours(k, self.width, self.height).into_iter().flatten().filter(|&n| self.mask[n])
    }

    /// Number of edge pixels.
    pub fn count(&self) -> usize {
        self.mask.iter().filter(|m| **m).count()
    }

    /// The edge near the centre of an edge pixel, in pixels ((0.5, 0.5) is the centre of the first), and
    /// the direction along the edge.
    pub(crate) fn crest(&self, k: usize) -> ([f64; 2], [f64; 2]) {
        let (x, y) = (k % self.width, k / self.width);
        let [gx, gy] = gradient(&self.smooth, x, y).map(f64::from);
        let length = (gx * gx + gy * gy).sqrt().max(1e-12);
        let (ux, uy) = (gx / length, gy / length);
        let (cx, cy) = (x as f64 + 0.5, y as f64 + 0.5);
        let at = |t: f64| f64::from(self.slopes.sample(cx + t * ux, cy + t * uy));
        // The vertex of a parabola through three magnitudes along the gradient.
        let (back, here, forth) = (at(-1.0), at(0.0), at(1.0));
        let bend = back - 2.0 * here + forth;
        // Beyond 0.6 pixels the vertex belongs to the neighbouring pixel, which has a point of its own.
        let shift = if bend < -1e-9 { (0.5 * (back - forth) / bend).clamp(-0.6, 0.6) } else { 0.0 };
        ([cx + shift * ux, cy + shift * uy], [-uy, ux])
    }

    /// The points of all edge pixels, row by row.
    pub fn crests(&self) -> Vec<[f64; 2]> {
        let pixels: Vec<usize> = (0..self.mask.len()).filter(|&k| self.mask[k]).collect();
        pixels.par_iter().with_min_len(1024).map(|&k| self.crest(k).0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::direction;

    #[test]
    fn a_disc_has_one_closed_edge_between_pixels() {
        let (cx, cy, r) = (60.3, 50.8, 31.4);
        let disc = Grey::from_fn(120, 100, |x, y| {
            let d = ((x as f64 + 0.5 - cx).powi(2) + (y as f64 + 0.5 - cy).powi(2)).sqrt();
            (0.5 + 0.4 * (r - d).clamp(-1.0, 1.0)) as f32
        })
        .blurred(1.4);
        let edges = canny(&disc, &CannySettings::default());
        let off: Vec<f64> =
            edges.crests().iter().map(|[x, y]| ((x - cx).powi(2) + (y - cy).powi(2)).sqrt() - r).collect();
        assert!(off.len() > 170 && off.len() < 320, "{}", off.len());
        let worst = off.iter().fold(0.0f64, |m, o| m.max(o.abs()));
        assert!(worst < 0.2, "{worst}");
        // Every degree of the circle has its edge.
        for deg in 0..360 {
            let p = direction(f64::from(deg).to_radians()) * r;
            let near = edges.crests().iter().any(|[x, y]| (x - cx - p.x).abs() + (y - cy - p.y).abs() < 2.0);
            assert!(near, "nothing at {deg} degrees");
        }
    }

    #[test]
    fn a_blank_or_black_picture_has_no_edges() {
        for value in [0.0, 0.7] {
            assert_eq!(canny(&Grey::filled(50, 40, value), &CannySettings::default()).count(), 0);
        }
        assert_eq!(canny(&Grey::filled(1, 1, 0.5), &CannySettings::default()).count(), 0);
    }
}
