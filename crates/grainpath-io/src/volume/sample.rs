//! Converts stored voxels to grey values.

use grainpath_core::slices::SampleType;

/// Appends the voxels in `bytes`, which holds a whole number of them. Floats may be NaN or infinite.
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
