//! Units of length that input files may be in, and the bead's cross-section.

use std::f64::consts::PI;

/// A unit of length, stated in a mesh file or in a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// Micrometre.
    Micron,
    /// Millimetre, the unit of everything inside grainpath.
    Millimetre,
    /// Centimetre.
    Centimetre,
    /// Inch, 25.4 mm.
    Inch,
    /// Foot, 304.8 mm.
    Foot,
    /// Metre.
    Metre,
}

impl LengthUnit {
    /// Length of this unit, mm.
    pub const fn mm(self) -> f64 {
        match self {
            Self::Micron => 1e-3,
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Inch => 25.4,
            Self::Foot => 304.8,
            Self::Metre => 1000.0,
        }
    }

    /// The name used in jobs, reports and warnings.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Micron => "micron",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "inch",
            Self::Foot => "foot",
            Self::Metre => "m",
        }
    }

    /// The unit with this name: a name of [`LengthUnit::name`], or a spelling that 3MF or OME-Zarr uses.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "micron" | "um" | "micrometer" => Self::Micron,
            "mm" | "millimeter" => Self::Millimetre,
            "cm" | "centimeter" => Self::Centimetre,
            "inch" | "in" => Self::Inch,
            "foot" | "ft" => Self::Foot,
            "m" | "meter" => Self::Metre,
            _ => return None,
        })
    }
}

/// Cross-section of a bead in mm2: a stadium, `h (w - h (1 - pi/4))`.
///
/// `width_mm` is the full width, `height_mm` the layer height. The formula does not hold for a
/// bead narrower than it is high; its section is taken as that of the ellipse inscribed in `w` x
/// `h`.
///
/// ```
/// use grainpath_core::units::{bead_area_mm2, bead_spacing_mm};
///
/// assert!((bead_area_mm2(0.45, 0.2) - 0.0814).abs() < 1e-4);
/// assert!((bead_spacing_mm(0.45, 0.2) - 0.4071).abs() < 1e-4);
/// ```
pub fn bead_area_mm2(width_mm: f64, height_mm: f64) -> f64 {
    let stadium = height_mm * (width_mm - height_mm * (1.0 - PI / 4.0));
    // At w = h both formulas give the circle's area, so the change from one to the other is
    // continuous.
    stadium.max(PI / 4.0 * width_mm * height_mm)
}

/// Spacing in mm at which parallel beads of this width fill a layer exactly: `w - h (1 - pi/4)`.
pub fn bead_spacing_mm(width_mm: f64, height_mm: f64) -> f64 {
    bead_area_mm2(width_mm, height_mm) / height_mm
}

/// Width of the bead that fills a strip of this width exactly, mm; the inverse of
/// [`bead_spacing_mm`].
pub fn bead_width_mm(spacing_mm: f64, height_mm: f64) -> f64 {
    let stadium = spacing_mm + height_mm * (1.0 - PI / 4.0);
    // For beads narrower than high the section is an ellipse, as in `bead_area_mm2`.
    if stadium >= height_mm { stadium } else { spacing_mm * 4.0 / PI }
}

/// A number rounded to the given number of decimals, for reports.
///
/// ```
/// assert_eq!(grainpath_core::units::rounded(2.34567, 2), 2.35);
/// ```
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_and_spacing_are_inverse() {
        for w in [0.05, 0.15, 0.2, 0.3, 0.45, 0.8] {
            let back = bead_width_mm(bead_spacing_mm(w, 0.2), 0.2);
            assert!((back - w).abs() < 1e-12, "{w} came back as {back}");
        }
        assert!((bead_area_mm2(0.42, 0.2) - 0.0754).abs() < 1e-4);
    }
}
