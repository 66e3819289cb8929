//! Decides whether grey values can be those of a scan, before time is spent on tracing noise.
//!
//! # Method
//! In a scan neighbouring voxels have similar values. The roughness of a volume is `E[(a - b)^2] / (2
//! Var)` over neighbours `a`, `b` within slices: 1 where neighbours are unrelated, close to 0 where the
//! image is smooth (von Neumann's ratio, halved). Bytes read in the wrong order turn the small steps of a
//! smooth image into large ones. A few voxels of absurd values (hot pixels, 3e38 for "no data") would decide the ratio alone,
//! so values are clipped near the range that is left when every voxel is the median of itself and its neighbours in the
//! row. The values with their bytes exchanged then show which order is right.
//!
//! With little noise a volume is smooth in either order. Samples of 4 bytes often hold small numbers, and those have their
//! empty bytes at the wrong end: integers are all multiples of 2^16, numbers all below the least normal one, 1.2e-38. Such a
//! volume is in the wrong order unless the stored one is the smoother of both, as of 16 bits that were shifted to the top.
//! Cost: one pass over the sampled slices.
//!
//! # Limits
//! Only integers and floats of 2 and 4 bytes can be exchanged. With little noise, 8 bits in samples of 2 bytes pass in either
//! order: shifted to the top they are usual. An integer of 4 bytes has lost its last byte in `f32`, which is 0
//! anyway in exchanged values below 2^24; of negative ones it makes steps at 0 that a scan can have.

use grainpath_core::slices::SampleType;

/// Roughness from which a volume is tested with its bytes exchanged. Measured: on nine scans (bolt, bone,
/// cranium, engine, fibre preform, nut, weave, cement, DICOM phantom): 0.008 to 0.076 as stored. The two
/// of 16 bits, exchanged: 0.68 and 0.24.
const SUSPICIOUS: f64 = 0.15;
/// Exchanged bytes are taken to be the right order where their roughness is below this share of the stored one. Derived:
/// 0.03 on both scans of 16 bits, from the roughness above.
const SMOOTHER: f64 = 0.25;
/// Roughness from which a volume is noise. Source: derived. A scan that is half material has 0.9 when the noise
/// has 1.5 times the contrast, and no threshold separates material from air in that.
const NOISE: f64 = 0.9;

/// A voxel that stands alone may lie beyond the range of the others by this many times that range. Source: derived. In air
/// with noise, whose range is some six deviations, walls of one voxel keep a contrast of 24 deviations; a hot voxel adds at
/// most 25 squared ranges to a sum over thousands of voxels.
const BEYOND: f64 = 4.0;

/// Faults of the grey values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Implausible {
    /// The volume is smooth when the bytes of every voxel are exchanged.
    ByteOrder,
    /// Neighbouring voxels are unrelated.
    Noise,
}

/// Sums over neighbouring voxels.
#[derive(Debug, Clone, Default)]
struct Roughness {
    steps: f64,
    n_steps: f64,
    sum: f64,
    squares: f64,
    n: f64,
}

impl Roughness {
    fn add(&mut self, rows: &[Vec<f64>]) {
        let (low, high) = clip(rows);
        rows.iter().for_each(|row| self.add_row(row.iter().map(|v| v.clamp(low, high))));
    }

    fn add_row(&mut self, row: impl Iterator<Item = f64>) {
        let mut before: Option<f64> = None;
        for v in row {
            if let Some(b) = before {
                self.steps += (v - b) * (v - b);
                self.n_steps += 1.0;
            }
            before = Some(v);
            self.sum += v;
            self.squares += v * v;
            self.n += 1.0;
        }
    }

    fn ratio(&self) -> f64 {
        let mean = self.sum / self.n;
        // Sums of squares in f64 keep enough digits for 16-bit values of any number of voxels.
        let variance = self.squares / self.n - mean * mean;
        if variance > 0.0 && self.n_steps > 0.0 { self.steps / self.n_steps / (2.0 * variance) } else { 0.0 }
    }
}

/// The range that values of these rows are clipped to.
fn clip(rows: &[Vec<f64>]) -> (f64, f64) {
    let median = |w: &[f64]| w[0].min(w[1]).max(w[0].max(w[1]).min(w[2]));
    let medians = rows.iter().flat_map(|row| row.windows(3).map(median));
    let (low, high) = medians.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    // Rows of less than three voxels have no medians.
    if low > high {
        return (f64::NEG_INFINITY, f64::INFINITY);
    }
    // Real edges of a scan may lie somewhat beyond what the medians keep of it.
    let beyond = BEYOND * (high - low);
    (low - beyond, high + beyond)
}

/// Collects the roughness of slices as they are read.
#[derive(Debug, Clone)]
pub struct Plausibility {
    sample: SampleType,
    stored: Roughness,
    exchanged: Roughness,
    /// Whether all values so far could be exchanged.
    exchangeable: bool,
    /// Whether all values so far have nothing in the bytes that hold small numbers.
    small_bytes_empty: bool,
    /// Whether any value so far is not 0.
    any: bool,
}

impl Plausibility {
    /// Nothing is read yet.
    pub fn new(sample: SampleType) -> Self {
        let exchangeable = match sample {
            SampleType::U16 | SampleType::I16 | SampleType::U32 | SampleType::I32 | SampleType::F32 => true,
            SampleType::U8 | SampleType::I8 | SampleType::F64 => false,
        };
        let (stored, exchanged) = (Roughness::default(), Roughness::default());
        Self { sample, stored, exchanged, exchangeable, small_bytes_empty: true, any: false }
    }

    /// Looks at a slice of rows of `nx`. NaN stands for no value and is passed over.
    pub fn add(&mut self, slice: &[f32], nx: usize) {
        // 256 rows estimate the roughness well enough. Of a small slice every row counts, since a thin
        // wall may lie in any of them.
        let every = (slice.len() / nx.max(1) / 256).max(1);
        let rows = || slice.chunks_exact(nx).step_by(every);
        let known = |row: &[f32]| row.iter().copied().filter(|v| !v.is_nan()).collect::<Vec<f32>>();
        let rows: Vec<Vec<f32>> = rows().map(known).collect();
        let stored: Vec<Vec<f64>> =
            rows.iter().map(|row| row.iter().map(|v| f64::from(*v)).collect()).collect();
        self.stored.add(&stored);
        for v in stored.iter().flatten() {
            self.any |= *v != 0.0;
            self.small_bytes_empty &= match self.sample {
                SampleType::U32 => v % 65_536.0 == 0.0,
                // The high bytes of negative numbers are full.
                SampleType::I32 => [0.0, 65_535.0].contains(&v.rem_euclid(65_536.0)),
                SampleType::F32 => v.abs() < f64::from(f32::MIN_POSITIVE),
                _ => false,
            };
        }
        if self.exchangeable {
            // A rescaled value is not the stored one and cannot be exchanged.
            let of_row = |row: &Vec<f32>| row.iter().map(|v| exchanged(self.sample, *v)).collect();
            match rows.iter().map(of_row).collect::<Option<Vec<Vec<f64>>>>() {
                Some(values) => self.exchanged.add(&values),
                None => self.exchangeable = false,
            }
        }
    }

    /// The fault, if there is one.
    pub fn verdict(&self) -> Option<Implausible> {
        let roughness = self.stored.ratio();
        let exchanged = self.exchanged.ratio();
        let is_smooth_exchanged = roughness > SUSPICIOUS && exchanged < SMOOTHER * roughness;
        // Volumes of two grey values are equally smooth in both orders, up to rounding.
        let is_small_exchanged = self.any && self.small_bytes_empty && exchanged <= roughness * (1.0 + 1e-9);
        if self.exchangeable && (is_smooth_exchanged || is_small_exchanged) {
            return Some(Implausible::ByteOrder);
        }
        (roughness > NOISE).then_some(Implausible::Noise)
    }
}

/// The value with its bytes in the opposite order; `None` where it cannot be the stored value.
fn exchanged(sample: SampleType, v: f32) -> Option<f64> {
    let whole = |low: f32, high: f32| v.fract() == 0.0 && (low..=high).contains(&v);
    match sample {
        SampleType::U16 if whole(0.0, 65535.0) => Some(f64::from((v as u16).swap_bytes())),
        SampleType::I16 if whole(-32768.0, 32767.0) => Some(f64::from((v as i16).swap_bytes())),
        // The next float above the greatest integer is out of range.
        SampleType::U32 if whole(0.0, 4_294_967_040.0) => Some(f64::from((v as u32).swap_bytes())),
        SampleType::I32 if whole(-2_147_483_648.0, 2_147_483_520.0) => {
            Some(f64::from((v as i32).swap_bytes()))
        }
        SampleType::F32 => {
            let other = f32::from_bits(v.to_bits().swap_bytes());
            // Exchanged bytes of a sound float give tiny, huge and invalid numbers. Those of no plausible
            // size count as 0.
            Some(if other.is_finite() && other.abs() < 1e12 { f64::from(other) } else { 0.0 })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball in air with noise of 2 %.
    fn ball(k: usize, noise: f32) -> Vec<f32> {
        let value = |i: usize| {
            let (x, y, z) = ((i % 60) as f32 - 30.0, (i / 60) as f32 - 30.0, k as f32 - 10.0);
            let hash = (i * 7919 + k * 104_729) % 1013;
            let inside = if x * x + y * y + z * z < 400.0 { 20000.0 } else { 1000.0 };
            (inside + noise * (hash as f32 - 506.0)).round().max(0.0)
        };
        (0..3600).map(value).collect()
    }

    fn verdict(sample: SampleType, change: impl Fn(f32) -> f32, noise: f32) -> Option<Implausible> {
        let mut seen = Plausibility::new(sample);
        for k in 0..20 {
            seen.add(&ball(k, noise).into_iter().map(&change).collect::<Vec<f32>>(), 60);
        }
        seen.verdict()
    }

    #[test]
    fn a_wrong_byte_order_is_found_and_a_right_one_passes() {
        let swapped = |v: f32| f32::from((v as u16).swap_bytes());
        let signed = |v: f32| f32::from(((v - 10000.0) as i16).swap_bytes());
        assert_eq!(verdict(SampleType::U16, |v| v, 1.0), None);
        assert_eq!(verdict(SampleType::U16, swapped, 1.0), Some(Implausible::ByteOrder));
        assert_eq!(verdict(SampleType::I16, signed, 1.0), Some(Implausible::ByteOrder));
        // Air of one value is smooth in either order, and less than half of the voxels are noise.
        let clean = |v: f32| if v < 5000.0 { 0.0 } else { v };
        assert_eq!(verdict(SampleType::U32, clean, 1.0), None);
        assert_eq!(verdict(SampleType::I32, move |v| clean(v) - 10000.0, 1.0), None);
        let swapped = move |v: f32| (clean(v) as u32).swap_bytes() as f32;
        assert_eq!(verdict(SampleType::U32, swapped, 1.0), Some(Implausible::ByteOrder));
        let signed = move |v: f32| (clean(v) as i32 - 10000).swap_bytes() as f32;
        assert_eq!(verdict(SampleType::I32, signed, 1.0), Some(Implausible::ByteOrder));
        assert_eq!(verdict(SampleType::F32, |v| v / 20000.0, 1.0), None);
        let float = |v: f32| {
            let w = f32::from_bits((v / 20000.0).to_bits().swap_bytes());
            if w.is_finite() { w } else { 0.0 }
        };
        assert!(verdict(SampleType::F32, float, 1.0).is_some());
        // Noise as strong as half the step still leaves a part.
        assert_eq!(verdict(SampleType::U16, |v| v, 15.0), None);
    }

    #[test]
    fn small_numbers_in_wide_samples_show_the_byte_order_without_noise() {
        for noise in [0.0, 0.004, 0.1] {
            let unsigned = |v: f32| (v as u32).swap_bytes() as f32;
            let signed = |v: f32| (v as i32 - 10000).swap_bytes() as f32;
            let float = |v: f32| f32::from_bits((v / 10.0).round().to_bits().swap_bytes());
            let changed = [
                verdict(SampleType::U32, unsigned, noise),
                verdict(SampleType::U32, |v| unsigned(v / 100.0), noise),
                verdict(SampleType::I32, signed, noise),
                verdict(SampleType::F32, float, noise),
            ];
            assert_eq!(changed, [Some(Implausible::ByteOrder); 4], "{noise}");
            let right = [
                verdict(SampleType::U32, |v| v, noise),
                verdict(SampleType::I32, |v| v - 10000.0, noise),
                verdict(SampleType::F32, |v| (v / 10.0).round(), noise),
            ];
            assert_eq!(right, [None; 3], "{noise}");
        }
        // 16 bits shifted to the top of 32: smoother as they are.
        assert_eq!(verdict(SampleType::U32, |v| v * 65_536.0, 0.1), None);
        assert_eq!(verdict(SampleType::F32, |_| 0.0, 0.0), None);
    }

    /// 3e38 is a usual value for "no data"; one such voxel decided the ratio alone.
    #[test]
    fn a_few_hot_voxels_are_no_fault() {
        for n_hot in [1, 2, 5] {
            let mut seen = Plausibility::new(SampleType::F32);
            for k in 0..20 {
                let mut slice = ball(k, 1.0);
                if k == 10 {
                    (0..n_hot).for_each(|n| slice[1000 + 300 * n] = 3e38);
                }
                seen.add(&slice, 60);
            }
            assert_eq!(seen.verdict(), None, "{n_hot}");
        }
    }

    #[test]
    fn noise_alone_is_no_scan() {
        let mut seen = Plausibility::new(SampleType::U8);
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as f32
        };
        (0..5).for_each(|_| seen.add(&(0..3600).map(|_| random()).collect::<Vec<f32>>(), 60));
        assert_eq!(seen.verdict(), Some(Implausible::Noise));
        // A scan of one grey value is not noise and has its own error.
        let mut flat = Plausibility::new(SampleType::U8);
        flat.add(&[3.0; 3600], 60);
        assert_eq!(flat.verdict(), None);
    }
}
