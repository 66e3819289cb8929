//! How a voxel is stored.

/// The type of a voxel in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum SampleType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    F32,
    F64,
}

impl SampleType {
    /// The names [`SampleType::from_name`] knows.
    pub const NAMES: [&str; 8] = ["u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"];

    /// The type with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        use SampleType::{F32, F64, I8, I16, I32, U8, U16, U32};
        let all = [U8, I8, U16, I16, U32, I32, F32, F64];
        Self::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Bytes of one voxel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Appends the voxels in `bytes`, a whole number of them. What is not finite becomes 0: nothing is known there.
    pub(crate) fn decode(self, bytes: &[u8], big_endian: bool, out: &mut Vec<f32>) {
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
        let finite = |v: f32| if v.is_finite() { v } else { 0.0 };
        match self {
            Self::U8 => out.extend(bytes.iter().map(|&b| f32::from(b))),
            Self::I8 => out.extend(bytes.iter().map(|&b| f32::from(b as i8))),
            Self::U16 => each(bytes, big_endian, out, |b| f32::from(u16::from_le_bytes(b))),
            Self::I16 => each(bytes, big_endian, out, |b| f32::from(i16::from_le_bytes(b))),
            Self::U32 => each(bytes, big_endian, out, |b| u32::from_le_bytes(b) as f32),
            Self::I32 => each(bytes, big_endian, out, |b| i32::from_le_bytes(b) as f32),
            Self::F32 => each(bytes, big_endian, out, |b| finite(f32::from_le_bytes(b))),
            Self::F64 => each(bytes, big_endian, out, |b| finite(f64::from_le_bytes(b) as f32)),
        }
    }
}
