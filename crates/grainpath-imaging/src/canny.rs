//! Canny's edges: gradients by Sobel, only the crest of each slope, two thresholds.
//!
//! Our own because it works on brightnesses of any depth, and because curves need the crest between pixels.

use rayon::prelude::*;

use super::raster::{Grey, mix, quantile, three};

/// Thresholds on the slope, as shares of the steepest hundredth of all slopes; `None` chooses by the picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CannySettings {
    /// Slopes above this begin an edge.
    pub high: Option<f64>,
    /// Slopes above this go on with one; 0.4 of `high` when left out.
    pub low: Option<f64>,
}

/// Where brightness changes fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Edges {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Which pixels are on an edge.
    pub mask: Vec<bool>,
    /// The thresholds used: low and high, brightness per pixel.
    pub thresholds: [f32; 2],
    slopes: Grey,
    smooth: Grey,
}

/// Finds edges in a picture that has been smoothed already. A blank picture has none.
pub fn canny(smooth: &Grey, settings: &CannySettings) -> Edges {
    let (w, h) = (smooth.width, smooth.height);
    let slopes = slopes(smooth);
    let crests = crests(smooth, &slopes);
    let thresholds = thresholds(&crests, settings);
    let mask = hysteresis(&crests, thresholds);
    Edges { width: w, height: h, mask, thresholds, slopes, smooth: smooth.clone() }
}

/// The length of [`gradient`] at every pixel.
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

/// Sobel's gradient along row `y`, grey steps a pixel; the border repeats.
pub(crate) fn gradient_row(smooth: &Grey, y: usize, gx: &mut [f32], gy: &mut [f32]) {
    let w = smooth.width;
    let row = |y: usize| &smooth.data[y * w..(y + 1) * w];
    let (a, b, c) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(smooth.height - 1)));
    let n = w.saturating_sub(2);
    let ([al, am, ar], [bl, _, br], [cl, cm, cr]) = (three(a), three(b), three(c));
    let inner = w.min(1)..w.min(1) + n;
    let (inner_x, inner_y) = (&mut gx[inner.clone()], &mut gy[inner]);
    for k in 0..n {
        inner_x[k] = 0.125 * ((ar[k] - al[k]) + 2.0 * (br[k] - bl[k]) + (cr[k] - cl[k]));
        inner_y[k] = 0.125 * ((cl[k] - al[k]) + 2.0 * (cm[k] - am[k]) + (cr[k] - ar[k]));
    }
    for x in [0, w - 1] {
        [gx[x], gy[x]] = gradient(smooth, x, y);
    }
}

/// Sobel's gradient, brightness per pixel; the border repeats.
fn gradient(grey: &Grey, x: usize, y: usize) -> [f32; 2] {
    let w = grey.width;
    let (l, r) = (x.saturating_sub(1), (x + 1).min(w - 1));
    let row = |y: usize| &grey.data[y * w..(y + 1) * w];
    let (a, b, c) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(grey.height - 1)));
    let gx = (a[r] - a[l]) + 2.0 * (b[r] - b[l]) + (c[r] - c[l]);
    let gy = (c[l] - a[l]) + 2.0 * (c[x] - a[x]) + (c[r] - a[r]);
    [gx / 8.0, gy / 8.0]
}

/// Gentler slopes than this are none, brightness per pixel.
const FLAT: f32 = 1e-5;

/// The slope where it is steepest up and down the slope, zero at all other pixels.
fn crests(smooth: &Grey, slopes: &Grey) -> Grey {
    let (w, h) = (smooth.width, smooth.height);
    let mut out = Grey::filled(w, h, 0.0);
    out.data.par_chunks_mut(w.max(1)).enumerate().for_each_init(
        || [(); 2].map(|()| vec![0.0f32; w]),
        |[gx, gy], (y, out)| {
            if y == 0 || y + 1 >= h {
                return;
            }
            gradient_row(smooth, y, gx, gy);
            let row = |y: usize| &slopes.data[y * w..(y + 1) * w];
            let n = w.saturating_sub(2);
            let [[al, am, ar], [bl, bm, br], [cl, cm, cr]] = [y - 1, y, y + 1].map(|y| three(row(y)));
            let inner = w.min(1)..w.min(1) + n;
            let (gx, gy, out) = (&gx[inner.clone()], &gy[inner.clone()], &mut out[inner]);
            // Without branches, so that the compiler takes several pixels at a time.
            for x in 0..n {
                let (ax, ay, same) = (gx[x].abs(), gy[x].abs(), gx[x] * gy[x] >= 0.0);
                let level = ax >= ay;
                let (least, most) = if level { (ay, ax) } else { (ax, ay) };
                let t = least / most.max(f32::MIN_POSITIVE);
                // Neighbours straight along the axis nearest to the gradient, and diagonally: the slope one step along
                // the gradient lies between them.
                let (ahead, behind) = if same { (br[x], bl[x]) } else { (bl[x], br[x]) };
                let (ahead, behind) = if level { (ahead, behind) } else { (cm[x], am[x]) };
                let (down, up) = if same { (cr[x], al[x]) } else { (cl[x], ar[x]) };
                let (forth, back) = (mix(ahead, down, t), mix(behind, up, t));
                let here = bm[x];
                // On a plateau of two equal slopes the first is the crest.
                let is_crest = (here >= FLAT) & (here > back) & (here >= forth);
                out[x] = if is_crest { here } else { 0.0 };
            }
        },
    );
    out
}

fn thresholds(crests: &Grey, settings: &CannySettings) -> [f32; 2] {
    let mut values: Vec<f32> = crests.data.iter().copied().filter(|v| *v > 0.0).collect();
    let steepest = quantile(&mut values, 0.99);
    let high = settings.high.map_or_else(|| quantile(&mut values, 0.6), |h| h as f32 * steepest);
    let low = settings.low.map_or(0.4 * high, |l| l as f32 * steepest);
    // Below this there is nothing to see, whatever the picture.
    let high = high.max(1e-3);
    [low.clamp(4e-4, high), high]
}

/// Crests above the high threshold, and those above the low one that hang together with them.
fn hysteresis(crests: &Grey, [low, high]: [f32; 2]) -> Vec<bool> {
    let (w, h) = (crests.width, crests.height);
    let mut mask = vec![false; w * h];
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

    /// The crest near the centre of an edge pixel, in pixels ((0.5, 0.5) is the centre of the first), and the
    /// direction along the edge.
    pub fn crest(&self, k: usize) -> ([f64; 2], [f64; 2]) {
        let (x, y) = (k % self.width, k / self.width);
        let [gx, gy] = gradient(&self.smooth, x, y).map(f64::from);
        let length = (gx * gx + gy * gy).sqrt().max(1e-12);
        let (ux, uy) = (gx / length, gy / length);
        let (cx, cy) = (x as f64 + 0.5, y as f64 + 0.5);
        let at = |t: f64| f64::from(self.slopes.sample(cx + t * ux, cy + t * uy));
        let (back, here, forth) = (at(-1.0), at(0.0), at(1.0));
        let bend = back - 2.0 * here + forth;
        let shift = if bend < -1e-9 { (0.5 * (back - forth) / bend).clamp(-0.6, 0.6) } else { 0.0 };
        ([cx + shift * ux, cy + shift * uy], [-uy, ux])
    }

    /// The edge pixels' crests in the order of rows.
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
