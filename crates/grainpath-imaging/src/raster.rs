//! A grey picture and the filters that remove its noise.
//!
//! # Method
//! A Gaussian is two passes, along rows and along columns, with taps up to three standard deviations. The
//! median of 3 x 3 pixels comes from sorted columns, each of which serves three windows; for larger
//! windows, up to 15 x 15, all pixels of the window are searched. Halving averages four pixels. All
//! filters repeat the outermost pixel beyond the border.
//!
//! # Units, cost and limits
//! Pictures are `(height, width)`, row-major `f32`, 0 black to 1 white. Points are in pixels, with (0.5,
//! 0.5) as the centre of the first. The cost is linear in the pixels, times the taps for a Gaussian and
//! the window for a median. Rows are processed in parallel, and each result depends on its row alone, so
//! it is the same for any number of threads. Pixels are never NaN; readers replace such values.

use grainpath_core::math::exp;
use rayon::prelude::*;

/// A grey picture, row-major. The direction of rows is the user's choice: photographs begin at the top,
/// rectified pictures at the bottom, so that y grows with the row.
#[derive(Debug, Clone, PartialEq)]
pub struct Grey {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `(height, width)`; 0 black to 1 white.
    pub data: Vec<f32>,
}

impl Grey {
    /// A picture of one brightness.
    pub fn filled(width: usize, height: usize, value: f32) -> Self {
        Self { width, height, data: vec![value; width * height] }
    }

    /// A picture of `value(column, row)`.
    pub fn from_fn(width: usize, height: usize, value: impl Fn(usize, usize) -> f32 + Sync) -> Self {
        let mut out = Self::filled(width, height, 0.0);
        out.data.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            row.iter_mut().enumerate().for_each(|(x, v)| *v = value(x, y));
        });
        out
    }

    /// The pixel in column `x` and row `y`.
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.data[y * self.width + x]
    }

    /// Brightness at a point in pixels, linear between the centres of pixels; (0.5, 0.5) is the centre of
    /// the first. Outside the picture, that of the nearest pixel.
    pub fn sample(&self, x: f64, y: f64) -> f32 {
        let place = |v: f64, n: usize| {
            let v = (v - 0.5).clamp(0.0, n as f64 - 1.0);
            let i = (v as usize).min(n.saturating_sub(2));
            (i, (v - i as f64) as f32)
        };
        let ((i, u), (j, v)) = (place(x, self.width), place(y, self.height));
        // A picture one pixel wide or high has no neighbour to interpolate with, so the pixel itself is used.
        let right = usize::from(self.width > 1);
        let up = if self.height > 1 { self.width } else { 0 };
        let k = j * self.width + i;
        let low = self.data[k] + u * (self.data[k + right] - self.data[k]);
        let high = self.data[k + up] + u * (self.data[k + up + right] - self.data[k + up]);
        low + v * (high - low)
    }

    /// The picture at half the size; each pixel is the mean of four.
    pub fn halved(&self) -> Self {
        half(&self.data, [self.width, self.height], 0.25, |[a, b, c, d]| (a + b) + (c + d))
    }

    /// Row `y` of this picture enlarged: the values that [`Grey::sample`] has at the pixel centres of the
    /// larger picture. `columns` and `row` are its [`enlarging`] tables; `between` is a buffer for one
    /// row of this picture.
    pub(crate) fn enlarged_row(
        &self,
        columns: &[(u32, f32)],
        row: (u32, f32),
        between: &mut Vec<f32>,
        out: &mut Vec<f32>,
    ) {
        let (j, t) = (row.0 as usize, row.1);
        let row = |j: usize| &self.data[j * self.width..(j + 1) * self.width];
        between.clear();
        between.extend(
            row(j).iter().zip(row((j + 1).min(self.height - 1))).map(|(low, high)| mix(*low, *high, t)),
        );
        // The row gets one more value at its end, so that the last pixel has a right neighbour.
        between.push(between[self.width - 1]);
        out.clear();
        out.extend(columns.iter().map(|&(i, u)| mix(between[i as usize], between[i as usize + 1], u)));
    }

    /// Smoothed by a Gaussian of this standard deviation in pixels. Beyond the border the outermost pixel
    /// repeats.
    pub fn blurred(&self, sigma_px: f64) -> Self {
        // A Gaussian this narrow has weight 1 at its centre within single precision, so it changes nothing.
        if sigma_px < 0.05 || self.data.is_empty() {
            return self.clone();
        }
        let taps = gaussian_taps(sigma_px);
        let r = taps.len() - 1;
        let (w, h) = (self.width, self.height);
        // The Gaussian is separable: two passes of 2 r + 1 taps instead of one of their square.
        let mut across = Self::filled(w, h, 0.0);
        across.data.par_chunks_mut(w).zip(self.data.par_chunks(w)).for_each_init(
            || vec![0.0f32; w + 2 * r],
            |padded, (out, row)| {
                padded[..r].fill(row[0]);
                padded[r..r + w].copy_from_slice(row);
                padded[r + w..].fill(row[w - 1]);
                scaled(out, &padded[r..r + w], taps[0]);
                for (k, &t) in taps.iter().enumerate().skip(1) {
                    add_pair(out, &padded[r - k..r - k + w], &padded[r + k..r + k + w], t);
                }
            },
        );
        let mut out = Self::filled(w, h, 0.0);
        out.data.par_chunks_mut(w).enumerate().for_each(|(y, out)| {
            let row = |k: usize| &across.data[k * w..(k + 1) * w];
            scaled(out, row(y), taps[0]);
            for (k, &t) in taps.iter().enumerate().skip(1) {
                add_pair(out, row(y.saturating_sub(k)), row((y + k).min(h - 1)), t);
            }
        });
        out
    }

    /// The median of the square of `2 radius + 1` pixels around each pixel. Beyond the border the
    /// outermost pixel repeats. Removes specks and leaves edges in place.
    pub fn median(&self, radius: usize) -> Self {
        if radius == 0 || self.data.is_empty() {
            return self.clone();
        }
        if radius == 1 {
            return self.median_of_nine();
        }
        // At most 15 x 15 pixels, which fit the window below.
        let r = radius.min(7) as isize;
        let place = |v: usize, d: isize, n: usize| (v as isize + d).clamp(0, n as isize - 1) as usize;
        Self::from_fn(self.width, self.height, |x, y| {
            let mut window = [0.0f32; 225];
            let mut n = 0;
            for dy in -r..=r {
                let row = place(y, dy, self.height) * self.width;
                for dx in -r..=r {
                    window[n] = self.data[row + place(x, dx, self.width)];
                    n += 1;
                }
            }
            *window[..n].select_nth_unstable_by(n / 2, f32::total_cmp).1
        })
    }

    /// The median of 3 x 3 from sorted columns, each of which serves three windows. The median of nine is
    /// the middle one of three: the largest of the lows, the middle of the middles and the smallest of
    /// the highs.
    fn median_of_nine(&self) -> Self {
        let (w, h) = (self.width, self.height);
        let mut out = Self::filled(w, h, 0.0);
        out.data.par_chunks_mut(w).enumerate().for_each_init(
            || [(); 3].map(|()| vec![0.0f32; w + 2]),
            |[low, middle, high], (y, out)| {
                let row = |y: usize| &self.data[y * w..(y + 1) * w];
                let (a, b, c) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(h - 1)));
                let sorted = [&mut *low, &mut *middle, &mut *high].map(|v| &mut v[1..=w]);
                let [l, m, t] = sorted;
                // Each column is sorted by three comparisons without branches.
                for x in 0..w {
                    let (p, q) = (lesser(a[x], b[x]), greater(a[x], b[x]));
                    let r = lesser(q, c[x]);
                    (l[x], m[x], t[x]) = (lesser(p, r), greater(p, r), greater(q, c[x]));
                }
                for sorted in [&mut *low, &mut *middle, &mut *high] {
                    (sorted[0], sorted[w + 1]) = (sorted[1], sorted[w]);
                }
                let ([la, lb, lc], [ma, mb, mc], [ha, hb, hc]) = (three(low), three(middle), three(high));
                for x in 0..w {
                    let l = greater(greater(la[x], lb[x]), lc[x]);
                    let m = middle_of(ma[x], mb[x], mc[x]);
                    let h = lesser(lesser(ha[x], hb[x]), hc[x]);
                    out[x] = middle_of(l, m, h);
                }
            },
        );
        out
    }

    /// Estimates the difference in brightness between two quantiles from about ten thousand pixels.
    pub fn spread(&self, low: f64, high: f64) -> f32 {
        // A step width that divides the width of the picture would visit the same columns in every row.
        let mut stride = (self.data.len() / 16_384).max(1);
        while stride > 1 && self.width.is_multiple_of(stride) {
            stride += 1;
        }
        let mut some: Vec<f32> = self.data.iter().copied().step_by(stride).collect();
        quantile(&mut some, high) - quantile(&mut some, low)
    }

    /// The brightness below which this share of the pixels lies.
    pub fn quantile(&self, share: f64) -> f32 {
        quantile(&mut self.data.clone(), share)
    }
}

/// The value below which this share of the values lies; 0 for an empty slice. Reorders the values.
pub fn quantile(values: &mut [f32], share: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let k = (share.clamp(0.0, 1.0) * (values.len() - 1) as f64).round() as usize;
    *values.select_nth_unstable_by(k, f32::total_cmp).1
}

/// For each of `n` pixels, the pixel before it in a picture `factor` times smaller, and the fraction
/// of the way from there to the next pixel.
pub(crate) fn enlarging(n: usize, factor: f64, n_small: usize) -> Vec<(u32, f32)> {
    let place = |v: usize| {
        let v = ((v as f64 + 0.5) / factor - 0.5).clamp(0.0, n_small as f64 - 1.0);
        let i = v as u32;
        (i, (v - f64::from(i)) as f32)
    };
    (0..n).map(place).collect()
}

/// A picture of half the size: `sum` of four pixels times `share`. An odd border pixel is repeated.
pub(crate) fn half<T: Copy + Sync>(
    data: &[T],
    [width, height]: [usize; 2],
    share: f32,
    sum: impl Fn([T; 4]) -> f32 + Sync,
) -> Grey {
    let (w, h) = (width.div_ceil(2), height.div_ceil(2));
    let mut out = Grey::filled(w, h, 0.0);
    out.data.par_chunks_mut(w.max(1)).enumerate().for_each(|(y, out)| {
        let row = |y: usize| &data[y * width..(y + 1) * width];
        let (a, b) = (row(2 * y), row((2 * y + 1).min(height - 1)));
        for ((out, a), b) in out.iter_mut().zip(a.as_chunks().0).zip(b.as_chunks().0) {
            let (&[a, b], &[c, d]) = (a, b);
            *out = share * sum([a, b, c, d]);
        }
        if width % 2 == 1 {
            let (a, b) = (a[width - 1], b[width - 1]);
            out[w - 1] = share * sum([a, a, b, b]);
        }
    });
    out
}

/// Linear interpolation from `a` to `b` by the fraction `t`.
#[inline]
pub(crate) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + t * (b - a)
}

/// The left neighbours, the pixels and the right neighbours of a row's inner pixels. Slices of one length
/// let the compiler drop bounds checks and process several pixels at a time.
#[inline]
pub(crate) fn three(row: &[f32]) -> [&[f32]; 3] {
    let n = row.len().saturating_sub(2);
    [0, 1, 2].map(|k| &row[k.min(row.len() - n)..][..n])
}

// No pixel is NaN, so these compile to one instruction each, unlike `f32::min`.
#[inline]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline]
fn greater(a: f32, b: f32) -> f32 {
    if a < b { b } else { a }
}

#[inline]
fn middle_of(a: f32, b: f32, c: f32) -> f32 {
    greater(lesser(a, b), lesser(greater(a, b), c))
}

fn scaled(out: &mut [f32], row: &[f32], t: f32) {
    out.iter_mut().zip(row).for_each(|(o, v)| *o = t * v);
}

fn add_pair(out: &mut [f32], a: &[f32], b: &[f32], t: f32) {
    out.iter_mut().zip(a).zip(b).for_each(|((o, a), b)| *o += t * (a + b));
}

/// Weights of a Gaussian from its centre outwards. They sum to one over both sides.
pub(crate) fn gaussian_taps(sigma_px: f64) -> Vec<f32> {
    // Three standard deviations hold 99.7 % of the weight; dividing by the sum restores the rest.
    let r = (3.0 * sigma_px).ceil().max(1.0) as usize;
    let weight = |k: usize| exp(-0.5 * (k as f64 / sigma_px) * (k as f64 / sigma_px));
    let sum: f64 = (0..=r).map(|k| if k == 0 { 1.0 } else { 2.0 * weight(k) }).sum();
    (0..=r).map(|k| (weight(k) / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blurring_keeps_the_sum_and_has_its_width() {
        let mut dot = Grey::filled(61, 41, 0.0);
        dot.data[20 * 61 + 30] = 1.0;
        let soft = dot.blurred(2.5);
        let sum: f32 = soft.data.iter().sum();
        assert!((sum - 1.0).abs() < 1e-5);
        let second: f64 = (0..61)
            .map(|x| (x as f64 - 30.0).powi(2) * f64::from(soft.data[x..].iter().step_by(61).sum::<f32>()))
            .sum();
        assert!((second.sqrt() - 2.5).abs() < 0.06, "{}", second.sqrt());
    }

    #[test]
    fn a_median_removes_a_speck_and_keeps_an_edge() {
        let mut edge = Grey::from_fn(20, 20, |x, _| if x < 10 { 0.0 } else { 1.0 });
        let clean = edge.clone();
        edge.data[5 * 20 + 4] = 1.0;
        assert_eq!(edge.median(1), clean);
        let mixed = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 257) as f32;
        for (w, h) in [(1, 1), (2, 3), (31, 17)] {
            let noise = Grey::from_fn(w, h, mixed);
            let at = |x: isize, y: isize| {
                noise.at(x.clamp(0, w as isize - 1) as usize, y.clamp(0, h as isize - 1) as usize)
            };
            let slow = Grey::from_fn(w, h, |x, y| {
                let mut near: Vec<f32> =
                    (0..9).map(|k| at(x as isize + k % 3 - 1, y as isize + k / 3 - 1)).collect();
                near.sort_by(f32::total_cmp);
                near[4]
            });
            assert_eq!(noise.median(1), slow);
        }
    }

    #[test]
    fn sampling_is_linear_between_centres() {
        let ramp = Grey::from_fn(8, 4, |x, y| x as f32 + 10.0 * y as f32);
        assert!((ramp.sample(3.25, 2.0) - (2.75 + 15.0)).abs() < 1e-5);
        assert_eq!(ramp.sample(-5.0, -5.0), 0.0);
        assert_eq!(ramp.sample(50.0, 50.0), 37.0);
    }
}
