//! Grey images with a scale in millimetres.

use grainpath_core::DVec2;

use crate::raster::Grey;

/// A picture placed on the part: its pixels are squares of a known size, and its first row is the lowest.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricImage {
    /// The picture; row 0 lies lowest.
    pub grey: Grey,
    /// Position of the picture's lower left corner, mm.
    pub min_mm: DVec2,
    /// Side of a pixel, mm.
    pub px_mm: f64,
}

impl MetricImage {
    /// Converts a point from pixels to millimetres. Pixels count from the lower left corner, so (0.5, 0.5) is the
    /// centre of the first pixel.
    pub fn place(&self, x: f64, y: f64) -> DVec2 {
        self.min_mm + self.px_mm * DVec2::new(x, y)
    }

    /// Converts a point from millimetres to pixels, counted as in [`Self::place`].
    pub fn pixel(&self, p: DVec2) -> DVec2 {
        (p - self.min_mm) / self.px_mm
    }

    /// Width and height of the picture, mm.
    pub fn size_mm(&self) -> DVec2 {
        self.px_mm * DVec2::new(self.grey.width as f64, self.grey.height as f64)
    }
}
