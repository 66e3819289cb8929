//! Histograms of grey values and thresholds derived from them.
//!
//! # Method
//! - The histogram has bins of one width. The width doubles whenever the range outgrows the bins, so a scan of any size is
//!   counted in one pass and at most 2^14 bins; whole numbers have a bin each as long as they fit.
//! - Otsu's threshold (`otsu1979` in docs/references.bib) splits the bins so that the variance between the two groups is
//!   greatest. It is pulled towards the smaller group, so it is a first estimate and not a measure.
//! - ISO-50 lies halfway between the grey values of air and material. A blurred straight edge crosses it where the sharp
//!   edge was, whatever the blur, so sizes are truest there. The two grey values are the modes of the voxels that differ
//!   least from their neighbours: in a thin wall hardly a voxel is all material.
//! - Voxels without a grey value of their own (NaN, padding, places that a moved or turned stack does not reach) come as NaN
//!   and are left out: with the grey value of air, as a fifth of a round field of view, they would be its mode.
//!
//! # Limits
//! The threshold separates two materials; of three, it separates the two groups of Otsu's split. The cost
//! is a few operations per voxel; at most 2^17 samples are kept for the modes.

/// A histogram with bins of one width, which doubles as the range grows.
#[derive(Debug, Clone, Default)]
pub struct Histogram {
    low: f64,
    width: f64,
    counts: Vec<u64>,
    range: Option<(f32, f32)>,
    /// Grey values of pixels spread over all slices, each with its squared difference from its
    /// neighbours.
    samples: Vec<(f32, f32)>,
    /// Distance between sampled pixels of a row.
    stride: usize,
    slices: usize,
}

/// Limit on the bins. Source: derived. 16-bit scans get bins of up to eight grey values. More bins cost memory and change
/// Otsu's threshold by less than a bin.
const MAX_BINS: usize = 1 << 14;
/// Limit on the samples for the modes. Source: derived. They take 1 MiB, and the error of a mode falls with the root of
/// their number, to a third of a percent here. The number bounds the time to sort them.
const MAX_SAMPLES: usize = 1 << 17;

impl Histogram {
    /// Adds the values of a slice in rows of `nx`. NaN stands for no value and is left out; no value is infinite.
    ///
    /// ```
    /// use grainpath_imaging::threshold::Histogram;
    ///
    /// let mut histogram = Histogram::default();
    /// histogram.add(&[f32::NAN, f32::NAN, -1000.0, -900.0, 200.0, 210.0], 3);
    /// assert_eq!(histogram.binned(1), [4]);
    /// ```
    pub fn add(&mut self, values: &[f32], nx: usize) {
        // The least and the greatest of two numbers pass over NaN.
        let (low, high) =
            values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        if low > high {
            return;
        }
        let (all_low, all_high) = self.range.map_or((low, high), |(l, h)| (l.min(low), h.max(high)));
        self.range = Some((all_low, all_high));
        self.make_room(f64::from(all_low), f64::from(all_high));
        let (start, scale) = (self.low, 1.0 / self.width);
        let last = self.counts.len() - 1;
        for &v in values.iter().filter(|v| !v.is_nan()) {
            self.counts[(((f64::from(v) - start) * scale) as usize).min(last)] += 1;
        }
        self.sample(values, nx);
    }

    fn sample(&mut self, values: &[f32], nx: usize) {
        self.stride = self.stride.max(1);
        self.slices += 1;
        for (j, row) in values.chunks_exact(nx).enumerate() {
            let above = &values[j.saturating_sub(1) * nx..];
            let below = &values[((j + 1) * nx).min(values.len() - nx)..];
            // The offset changes with row and slice, so that a stride cannot fall on the same columns of
            // a regular pattern.
            let first = (13 * j + 29 * self.slices) % self.stride;
            for i in (first..nx).step_by(self.stride) {
                let (x, y) = (row[(i + 1).min(nx - 1)] - row[i.saturating_sub(1)], below[i] - above[i]);
                let difference = x * x + y * y;
                // Beside a voxel without a value nothing is known of how much the voxel differs from its neighbours.
                if !difference.is_nan() && !row[i].is_nan() {
                    self.samples.push((row[i], difference));
                }
            }
        }
        // Keeping every second sample halves the density evenly over all slices read so far.
        while self.samples.len() > MAX_SAMPLES {
            self.samples = self.samples.iter().copied().step_by(2).collect();
            self.stride *= 2;
        }
    }

    fn make_room(&mut self, low: f64, high: f64) {
        if self.counts.is_empty() {
            // Whole numbers get a bin each while they fit; then counts are exact.
            self.width = if high - low > 16.0 { 1.0 } else { ((high - low) / 4096.0).max(1e-12) };
            self.low = low - 0.5 * self.width;
            self.counts = vec![0];
        }
        while (high - self.low.min(low)) / self.width >= (MAX_BINS - 2) as f64 {
            self.width *= 2.0;
            // Pairs of bins are added, so no count is lost when the width doubles.
            self.counts = self.counts.chunks(2).map(|c| c.iter().sum()).collect();
        }
        if low < self.low {
            let before = ((self.low - low) / self.width).ceil() as usize;
            self.counts.splice(0..0, std::iter::repeat_n(0, before));
            self.low -= before as f64 * self.width;
        }
        let needed = ((high - self.low) / self.width) as usize + 1;
        if needed > self.counts.len() {
            self.counts.resize(needed, 0);
        }
    }

    /// The lowest and the highest value.
    pub fn range(&self) -> Option<(f32, f32)> {
        self.range
    }

    /// The counts in `n` bins over the range.
    pub fn binned(&self, n: usize) -> Vec<u64> {
        let mut out = vec![0; n];
        let total = self.counts.len().max(1);
        for (i, c) in self.counts.iter().enumerate() {
            out[i * n / total] += c;
        }
        out
    }

    fn value(&self, bin: f64) -> f64 {
        self.low + (bin + 0.5) * self.width
    }

    /// Otsu's threshold, a grey value between two bins; see `otsu_split`.
    pub fn otsu(&self) -> f64 {
        // The split lies between two bins, half a bin below the centre of the next.
        self.value(otsu_split(&self.counts) - 0.5)
    }

    /// The most frequent grey values below and above Otsu's threshold, away from edges: air and material.
    pub fn materials(&self) -> (f64, f64) {
        let split = self.otsu();
        let (mut low, mut high): (Vec<_>, Vec<_>) =
            self.samples.iter().copied().partition(|s| f64::from(s.0) < split);
        // Voxels that are partly air pull both means towards the threshold, and many of them are alike
        // where faces run along the voxels. The modes are therefore sought outside the halfway points
        // between threshold and means.
        let outer = |side: &[(f32, f32)]| {
            let mean = side.iter().map(|s| f64::from(s.0)).sum::<f64>() / side.len().max(1) as f64;
            0.5 * (split + mean)
        };
        let (low_end, high_start) = (outer(&low), outer(&high));
        low.retain(|s| f64::from(s.0) <= low_end);
        high.retain(|s| f64::from(s.0) >= high_start);
        // The mode is the densest window of 4 % of the range: narrower ones follow the noise, wider ones
        // reach into the partly filled voxels.
        let width = self.range.map_or(0.0, |(a, b)| b - a) * 0.04;
        let mode = |side: Vec<(f32, f32)>| commonest(away_from_edges(side), width).unwrap_or(split);
        (mode(low), mode(high))
    }
}

/// Split of a histogram into two groups, in bins from the lower end: the split with the greatest variance
/// between the groups (`otsu1979`). Of equally good splits, which lie in a run of empty bins, the middle
/// one is taken.
///
/// ```
/// use grainpath_imaging::threshold::otsu_split;
///
/// // Two peaks, with bins 3 to 6 empty between them.
/// assert_eq!(otsu_split(&[1, 8, 1, 0, 0, 0, 0, 2, 9, 2]), 5.0);
/// ```
pub fn otsu_split(counts: &[u64]) -> f64 {
    let all: f64 = counts.iter().map(|&c| c as f64).sum();
    let sum: f64 = counts.iter().enumerate().map(|(i, &c)| i as f64 * c as f64).sum();
    let (mut below, mut below_sum) = (0.0, 0.0);
    let (mut best, mut first, mut last) = (-1.0, 0, 0);
    for (i, &c) in counts.iter().enumerate() {
        below += c as f64;
        below_sum += i as f64 * c as f64;
        let above = all - below;
        // A split with an empty side has no variance between groups.
        if below == 0.0 || above == 0.0 {
            continue;
        }
        let d = below_sum / below - (sum - below_sum) / above;
        let variance = below * above * d * d;
        // Splits within a run of empty bins are equal up to rounding; the tolerance keeps both ends of
        // the run.
        if variance > best * (1.0 + 1e-12) {
            (best, first, last) = (variance, i, i);
        } else if variance >= best * (1.0 - 1e-12) {
            last = i;
        }
    }
    0.5 * (first + last) as f64 + 1.0
}

/// Returns the tenth of the values that differ least from their neighbours, or a few hundred if that is
/// more. In a thin wall hardly any voxel has the full grey value, and these come nearest to it.
fn away_from_edges(mut side: Vec<(f32, f32)>) -> Vec<f32> {
    let wanted = (side.len() / 10).max(300);
    let slope = if wanted < side.len() {
        side.select_nth_unstable_by(wanted, |a, b| a.1.total_cmp(&b.1)).1.1
    } else {
        f32::INFINITY
    };
    side.into_iter().filter(|s| s.1 <= slope).map(|s| s.0).collect()
}

/// The middle of the window of this width that holds the most values.
fn commonest(mut values: Vec<f32>, width: f32) -> Option<f64> {
    values.sort_by(f32::total_cmp);
    let within = |from: f64, to: f64| {
        let at = |v: f64| values.partition_point(|&w| f64::from(w) < v);
        &values[at(from)..at(to)]
    };
    let reach = 0.5 * f64::from(width);
    let mut middle = f64::from(*values.first()?);
    let (mut most, mut start) = (0, 0);
    // A window slides over the sorted values, so the search is linear after sorting.
    for (end, &v) in values.iter().enumerate() {
        while v - values[start] > width {
            start += 1;
        }
        if end - start >= most {
            (most, middle) = (end - start, 0.5 * (f64::from(v) + f64::from(values[start])));
        }
    }
    // Neighbouring windows hold nearly the same number of values, so chance decides partly which is the best. The window is
    // therefore moved to the mean of its values, again and again, until it settles on the peak.
    for _ in 0..20 {
        let held = within(middle - reach, middle + reach + f64::MIN_POSITIVE);
        if !held.is_empty() {
            middle = held.iter().map(|&v| f64::from(v)).sum::<f64>() / held.len() as f64;
        }
    }
    Some(middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_materials_are_told_apart_whatever_their_scale() {
        for scale in [1.0f32, 200.0, 1e-3] {
            let mut h = Histogram::default();
            for slice in 0..5 {
                let noise = |i: usize| ((i * 7919 + slice * 104_729) % 101) as f32 * 0.05 - 2.5;
                let values: Vec<f32> =
                    (0..3000).map(|i| (if i % 4 == 0 { 180.0 } else { 20.0 } + noise(i)) * scale).collect();
                h.add(&values, 60);
            }
            let (air, solid) = h.materials();
            let near = |a: f64, b: f64| (a / f64::from(scale) - b).abs() < 3.0;
            assert!(near(air, 20.0) && near(solid, 180.0), "{scale}: {air} {solid}");
            assert!(near(h.otsu(), 100.0) || (40.0..160.0).contains(&(h.otsu() / f64::from(scale))));
            assert_eq!(h.binned(10).iter().sum::<u64>(), 15_000);
        }
    }

    /// 4 pixels thick at a blur of one: the middle has 0.97 of the full grey value, most of the rest far less.
    #[test]
    fn hardly_a_voxel_of_a_thin_wall_is_all_material() {
        let (nx, ny) = (80, 60);
        let mut h = Histogram::default();
        for slice in 0..20 {
            let value = |i: usize| {
                let off = ((i % nx) as f64 - 40.0 - 0.37 * slice as f64).abs() - 2.0;
                let noise = ((i * 7919 + slice * 104_729) % 101) as f64 * 0.2 - 10.0;
                (1000.0 / (1.0 + grainpath_core::math::exp(1.702 * off)) + noise) as f32
            };
            let values: Vec<f32> = (0..nx * ny).map(value).collect();
            h.add(&values, nx);
        }
        let (air, solid) = h.materials();
        assert!(air.abs() < 3.0 && (solid - 962.0).abs() < 8.0, "{air} {solid}");
    }
}
