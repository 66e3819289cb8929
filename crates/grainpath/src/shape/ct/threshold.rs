//! Grey values counted, and thresholds found from them.

/// Counts of grey values in bins of one width, which doubles as the range grows.
#[derive(Debug, Clone, Default)]
pub struct Histogram {
    low: f64,
    width: f64,
    counts: Vec<u64>,
    range: Option<(f32, f32)>,
}

/// Never more bins than this.
const MAX_BINS: usize = 1 << 14;

impl Histogram {
    /// Counts these values, all finite.
    pub fn add(&mut self, values: &[f32]) {
        let Some(&first) = values.first() else { return };
        let (low, high) = values.iter().fold((first, first), |(l, h), &v| (l.min(v), h.max(v)));
        let (all_low, all_high) = self.range.map_or((low, high), |(l, h)| (l.min(low), h.max(high)));
        self.range = Some((all_low, all_high));
        self.make_room(f64::from(all_low), f64::from(all_high));
        let (start, scale) = (self.low, 1.0 / self.width);
        let last = self.counts.len() - 1;
        for &v in values {
            self.counts[(((f64::from(v) - start) * scale) as usize).min(last)] += 1;
        }
    }

    fn make_room(&mut self, low: f64, high: f64) {
        if self.counts.is_empty() {
            // Whole numbers get a bin each as long as there are not too many.
            self.width = if high - low > 16.0 { 1.0 } else { ((high - low) / 4096.0).max(1e-12) };
            self.low = low - 0.5 * self.width;
            self.counts = vec![0];
        }
        while (high - self.low.min(low)) / self.width >= (MAX_BINS - 2) as f64 {
            self.width *= 2.0;
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

    /// The least and the greatest value.
    pub fn range(&self) -> Option<(f32, f32)> {
        self.range
    }

    /// Counts in `n` bins over the range.
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

    /// The threshold with the greatest variance between the two sides (Otsu 1979), between two bins.
    pub fn otsu(&self) -> f64 {
        let all: f64 = self.counts.iter().map(|&c| c as f64).sum();
        let sum: f64 = self.counts.iter().enumerate().map(|(i, &c)| i as f64 * c as f64).sum();
        let (mut below, mut below_sum) = (0.0, 0.0);
        // Empty bins between two peaks are all as good: the middle one is taken.
        let (mut best, mut first, mut last) = (-1.0, 0, 0);
        for (i, &c) in self.counts.iter().enumerate() {
            below += c as f64;
            below_sum += i as f64 * c as f64;
            let above = all - below;
            if below == 0.0 || above == 0.0 {
                continue;
            }
            let d = below_sum / below - (sum - below_sum) / above;
            let variance = below * above * d * d;
            if variance > best * (1.0 + 1e-12) {
                (best, first, last) = (variance, i, i);
            } else if variance >= best * (1.0 - 1e-12) {
                last = i;
            }
        }
        self.value(0.5 * (first + last) as f64 + 0.5)
    }

    /// The commonest grey values below and above the Otsu threshold: air and material.
    pub fn materials(&self) -> (f64, f64) {
        let split = (((self.otsu() - self.low) / self.width) as usize).min(self.counts.len());
        // Averaged over a hundredth of the range, so that noise does not choose the peak.
        let reach = (self.counts.len() / 200).max(1);
        let mut sums = vec![0u64; self.counts.len() + 1];
        for (i, c) in self.counts.iter().enumerate() {
            sums[i + 1] = sums[i] + c;
        }
        let peak = |from: usize, to: usize| {
            let weight = |i: usize| {
                let (a, b) = (i.saturating_sub(reach).max(from), (i + reach + 1).min(to));
                (sums[b] - sums[a]) as f64 / (b - a) as f64
            };
            let mut best = (from..to).fold((f64::NEG_INFINITY, from), |best, i| {
                let w = weight(i);
                if w > best.0 { (w, i) } else { best }
            });
            // The middle of a flat top.
            let end = (best.1..to).take_while(|&i| weight(i) >= best.0).last().unwrap_or(best.1);
            best.1 = (best.1 + end) / 2;
            // The mean about the peak is finer than a bin.
            let (a, b) = (best.1.saturating_sub(reach).max(from), (best.1 + reach + 1).min(to));
            let (n, sum) = (a..b).fold((0.0, 0.0), |(n, s), i| {
                let c = self.counts[i] as f64;
                (n + c, s + c * i as f64)
            });
            self.value(if n > 0.0 { sum / n } else { best.1 as f64 })
        };
        // Voxels that are partly air pull both means towards the split, and pile up where faces lie along the voxels:
        // peaks are looked for from halfway to the means outwards.
        let mean = |from: usize, to: usize| {
            let (n, sum) = (from..to).fold((0.0, 0.0), |(n, s), i| {
                let c = self.counts[i] as f64;
                (n + c, s + c * i as f64)
            });
            if n > 0.0 { sum / n } else { split as f64 }
        };
        let last = self.counts.len();
        let low_end = (0.5 * (split as f64 + mean(0, split))).ceil() as usize;
        let high_start = (0.5 * (split as f64 + mean(split, last))) as usize;
        (peak(0, low_end.clamp(1, last)), peak(high_start.min(last - 1), last))
    }
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
                h.add(&values);
            }
            let (air, solid) = h.materials();
            let near = |a: f64, b: f64| (a / f64::from(scale) - b).abs() < 3.0;
            assert!(near(air, 20.0) && near(solid, 180.0), "{scale}: {air} {solid}");
            assert!(near(h.otsu(), 100.0) || (40.0..160.0).contains(&(h.otsu() / f64::from(scale))));
            assert_eq!(h.binned(10).iter().sum::<u64>(), 15_000);
        }
    }
}
