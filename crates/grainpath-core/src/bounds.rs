//! Axis-aligned bounding boxes in the plane.

use crate::DVec2;

/// An axis-aligned box in the plane, mm.
///
/// ```
/// use grainpath_core::{Bounds2, DVec2};
///
/// let bounds = Bounds2::around_points([DVec2::new(1.0, 5.0), DVec2::new(4.0, 2.0)]).unwrap();
/// assert_eq!(bounds.size(), DVec2::new(3.0, 3.0));
/// assert_eq!(bounds.grown(1.0).min, DVec2::new(0.0, 1.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds2 {
    /// Lowest corner.
    pub min: DVec2,
    /// Highest corner.
    pub max: DVec2,
}

impl Bounds2 {
    /// The box around these points; `None` when there are none.
    pub fn around_points(points: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let (min, max) = points.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
        Some(Self { min, max })
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box grown by `d_mm` on every side.
    pub fn grown(self, d_mm: f64) -> Self {
        Self { min: self.min - d_mm, max: self.max + d_mm }
    }

    /// Width and height, mm.
    pub fn size(self) -> DVec2 {
        self.max - self.min
    }

    /// The middle.
    pub fn centre(self) -> DVec2 {
        0.5 * (self.min + self.max)
    }

    /// Whether the boxes share a point.
    pub fn meets(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}
