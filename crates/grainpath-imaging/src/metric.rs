//! Grey images with a scale in millimetres.

use grainpath_core::DVec2;

use crate::raster::Grey;

/// A picture with a scale in millimetres, whose rows start at the bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricImage {
    /// The picture; row 0 lies lowest.
    pub grey: Grey,
    /// Lower left corner, mm.
    pub min_mm: DVec2,
    /// Side of a pixel, mm.
    pub px_mm: f64,
}

impl MetricImage {
    /// Converts a point from pixels, where (0.5, 0.5) is the centre of the first pixel, to millimetres.
    pub fn place(&self, x: f64, y: f64) -> DVec2 {
        self.min_mm + self.px_mm * DVec2::new(x, y)
    }

    /// Converts a point from millimetres to pixels.
    pub fn pixel(&self, p: DVec2) -> DVec2 {
        (p - self.min_mm) / self.px_mm
    }

    /// Width and height, mm.
    pub fn size_mm(&self) -> DVec2 {
        self.px_mm * DVec2::new(self.grey.width as f64, self.grey.height as f64)
    }
}
