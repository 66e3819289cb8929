//! Converts stored voxels to grey values.

use grainpath_core::slices::SampleType;

/// Counts and replaces voxels that are NaN or infinite in the file, or that a reader made NaN because they are padding.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NotFinite {
    /// Number of such voxels since the last restart.
    pub(super) n_voxels: u64,
    /// The lowest finite value of the slices read so far.
    least: Option<f32>,
}

impl NotFinite {
    /// Starts counting again. The lowest value is kept.
    pub(super) fn restart(&mut self) {
        self.n_voxels = 0;
    }

    /// Takes the lowest value of a slice that is not given out, so that slices without finite values before it get air.
    pub(super) fn learn(&mut self, slice: &[f32]) {
        let least = slice.iter().copied().filter(|v| v.is_finite()).reduce(f32::min);
        self.least = self.least.into_iter().chain(least).reduce(f32::min);
    }

    /// Whether a finite value was seen.
    pub(super) fn knows_air(&self) -> bool {
        self.least.is_some()
    }

    /// Replaces values that are not finite by the lowest value of the slice, which is air. A slice
    /// without finite values gets the lowest value so far, or 0 where none is known yet.
    pub(super) fn replace_in(&mut self, slice: &mut [f32]) {
        let least = slice.iter().copied().filter(|v| v.is_finite()).reduce(f32::min);
        self.learn(slice);
        // The lowest value is used, because 0 is water in Hounsfield units and would add material.
        let air = least.or(self.least).unwrap_or(0.0);
        for v in slice.iter_mut().filter(|v| !v.is_finite()) {
            *v = air;
            self.n_voxels += 1;
        }
    }
}

/// Appends the voxels in `bytes`, which holds a whole number of them. Floats may be NaN.
pub(super) fn decode(sample: SampleType, bytes: &[u8], big_endian: bool, out: &mut Vec<f32>) {
    fn each<const N: usize>(bytes: &[u8], big: bool, out: &mut Vec<f32>, f: impl Fn([u8; N]) -> f32) {
        let values = bytes.chunks_exact(N).map(|c| {
            let mut b: [u8; N] = c.try_into().unwrap_or([0; N]);
            if big {
                b.reverse();
            }
            f(b)
        });
        out.extend(values);
    }
    match sample {
        SampleType::U8 => out.extend(bytes.iter().map(|&b| f32::from(b))),
        SampleType::I8 => out.extend(bytes.iter().map(|&b| f32::from(b as i8))),
        SampleType::U16 => each(bytes, big_endian, out, |b| f32::from(u16::from_le_bytes(b))),
        SampleType::I16 => each(bytes, big_endian, out, |b| f32::from(i16::from_le_bytes(b))),
        // Integers above 2^24 lose digits as f32; grey values need far fewer.
        SampleType::U32 => each(bytes, big_endian, out, |b| u32::from_le_bytes(b) as f32),
        SampleType::I32 => each(bytes, big_endian, out, |b| i32::from_le_bytes(b) as f32),
        SampleType::F32 => each(bytes, big_endian, out, f32::from_le_bytes),
        SampleType::F64 => each(bytes, big_endian, out, |b| f64::from_le_bytes(b) as f32),
    }
}
