//! A photograph as it was taken.

use std::borrow::Cow;

use grainpath_core::image::{Image, Samples};
use rayon::prelude::*;

use super::warp::Shrinking;
use crate::raster::{Grey, half};

/// A photograph as it was taken, in grey, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    /// The name in errors and reports.
    pub name: String,
    light: Light,
}

/// Brightness as the file stores it. A large photograph is halved next, and bytes take a quarter of the
/// memory and time of floats.
#[derive(Debug, Clone, PartialEq)]
enum Light {
    /// Pixels in a row, number of rows, and brightness from 0 (black) to 255 (white).
    Bytes([usize; 2], Vec<u8>),
    Floats(Grey),
}

impl Photo {
    /// A photograph from a grey picture.
    pub fn new(name: String, grey: Grey) -> Self {
        Self { name, light: Light::Floats(grey) }
    }

    /// Converts an image to grey. Floats are stretched so that the lowest value is black and the highest
    /// white.
    pub fn from_image(name: String, image: Image) -> Self {
        let (width, height) = (image.width, image.height);
        let samples = match image.samples {
            Samples::U8(bytes) if image.channels == 1 => {
                return Self { name, light: Light::Bytes([width, height], bytes) };
            }
            other => other,
        };
        let image = Image { samples, ..image };
        let mut data = image.to_grey_f32();
        let (mut low, mut high) = (0.0, image.samples.full_scale());
        // Floats have no agreed white, so their own range is used.
        if matches!(image.samples, Samples::F32(_)) {
            let finite = || data.iter().copied().filter(|v| v.is_finite());
            (low, high) =
                (finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max));
        }
        // A blank image has a range of zero; 1 is used instead, which avoids a division by zero and leaves it black.
        let range = if high > low { high - low } else { 1.0 };
        data.par_iter_mut().for_each(|v| *v = if v.is_finite() { (*v - low) / range } else { 0.0 });
        Self { name, light: Light::Floats(Grey { width, height, data }) }
    }
}

impl Shrinking for Photo {
    fn size(&self) -> [usize; 2] {
        match &self.light {
            Light::Bytes(size, _) => *size,
            Light::Floats(grey) => [grey.width, grey.height],
        }
    }

    fn whole(&self) -> Cow<'_, Grey> {
        match &self.light {
            &Light::Bytes([width, height], ref bytes) => {
                let data = bytes.par_iter().map(|&b| f32::from(b) / 255.0).collect();
                Cow::Owned(Grey { width, height, data })
            }
            Light::Floats(grey) => Cow::Borrowed(grey),
        }
    }

    fn halved(&self) -> Grey {
        match &self.light {
            Light::Bytes(size, bytes) => half(bytes, *size, 0.25 / 255.0, |[a, b, c, d]| {
                f32::from((u16::from(a) + u16::from(b)) + (u16::from(c) + u16::from(d)))
            }),
            Light::Floats(grey) => grey.halved(),
        }
    }
}
