//! A decoded image. Readers of image files produce it; photographs and slices of scans are made from it.
//!
//! Samples are row-major with shape `(height, width, channels)`, rows from the top.

/// An image format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ImageFormat {
    Png,
    Jpeg,
    Tiff,
    Bmp,
}

impl ImageFormat {
    /// The name shown to people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Tiff => "TIFF",
            Self::Bmp => "BMP",
        }
    }
}

/// The samples of an image as the file stores them.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 1 to 8 bits in the file; values of fewer than 8 bits are scaled to 0 to 255.
    U8(Vec<u8>),
    /// 16 bits, unsigned.
    U16(Vec<u16>),
    /// Floats; also signed or 32-bit integers, converted to floats without scaling.
    F32(Vec<f32>),
}

impl Samples {
    /// The number of samples: pixels times channels.
    pub const fn count(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// The sample value of white: 255, 65535, or 1 for floats.
    pub const fn full_scale(&self) -> f32 {
        match self {
            Self::U8(_) => 255.0,
            Self::U16(_) => 65535.0,
            Self::F32(_) => 1.0,
        }
    }
}

/// An upright image: rows start at the top, and the channels of a pixel are stored together.
///
/// ```
/// use grainpath_core::image::{Image, ImageFormat, Samples};
///
/// // A red and a white pixel, one above the other.
/// let samples = Samples::U8(vec![255, 0, 0, 255, 255, 255]);
/// let image = Image { format: ImageFormat::Png, width: 1, height: 2, channels: 3, samples };
/// let grey = image.to_grey_f32();
/// assert_eq!(grey.len(), image.width * image.height);
/// assert!((grey[0] - 0.299 * 255.0).abs() < 1e-3);
/// assert!((grey[1] - image.samples.full_scale()).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Format of the file.
    pub format: ImageFormat,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Channels: 1 grey, 2 grey and alpha, 3 red green blue, 4 with alpha.
    pub channels: usize,
    /// `(height, width, channels)`, row-major.
    pub samples: Samples,
}

impl Image {
    /// Brightness of each pixel in the unit of the samples ([`Samples::full_scale`] is white), row-major.
    /// Brightness is the luma of ITU-R BT.601, 0.299 R + 0.587 G + 0.114 B, as in JPEG. Alpha is
    /// ignored.
    pub fn to_grey_f32(&self) -> Vec<f32> {
        match &self.samples {
            Samples::U8(v) => grey(v, self.channels, f32::from),
            Samples::U16(v) => grey(v, self.channels, f32::from),
            Samples::F32(v) => grey(v, self.channels, |s| s),
        }
    }
}

fn grey<T: Copy>(samples: &[T], channels: usize, value: impl Fn(T) -> f32) -> Vec<f32> {
    match channels {
        1 => samples.iter().map(|&s| value(s)).collect(),
        2 => samples.chunks_exact(2).map(|p| value(p[0])).collect(),
        n => {
            let luma = |p: &[T]| 0.299 * value(p[0]) + 0.587 * value(p[1]) + 0.114 * value(p[2]);
            samples.chunks_exact(n).map(luma).collect()
        }
    }
}
