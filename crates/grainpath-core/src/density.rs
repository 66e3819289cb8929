//! The density of an infill region: dense, or sparse with a fraction of the volume.

/// Density of infill: dense, or a fraction of the volume.
///
/// Dense infill follows other rules than sparse infill: bead widths and spacings are fitted to the
/// region, so that no gaps remain. A density is therefore one of two cases, and the stages need not
/// compare a number with 1.
///
/// ```
/// use grainpath_core::Density;
///
/// assert_eq!(Density::new(1.0), Density::Dense);
/// assert_eq!(Density::new(0.2), Density::Sparse(0.2));
/// assert_eq!(Density::Dense.fraction(), 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// Beads lie side by side.
    Dense,
    /// Volume of beads over volume of the region, from 0 to less than 1.
    Sparse(f64),
}

/// Infill with at least this fraction is dense, so that 0.9999, or the result of a search up to 1, counts as 1.
/// Source: derived. This changes the spacing of the beads by 0.4 um, which G-code rounds away.
const DENSE_FROM: f64 = 0.999;

impl Density {
    /// The density for a fraction: the volume of the beads over the volume of the region.
    pub const fn new(fraction: f64) -> Self {
        if fraction >= DENSE_FROM { Self::Dense } else { Self::Sparse(fraction) }
    }

    /// Volume of beads over volume of the region: 1 where it is dense.
    pub const fn fraction(self) -> f64 {
        match self {
            Self::Dense => 1.0,
            Self::Sparse(fraction) => fraction,
        }
    }

    /// Whether beads lie side by side.
    pub const fn is_dense(self) -> bool {
        matches!(self, Self::Dense)
    }
}
