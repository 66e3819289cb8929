//! Direction fields: the axis that beads are to follow, from a stress, the grain of wood or a rule.
//!
//! A direction has no sign: an axis and its opposite are the same, so angles are in `[0, pi)`.
//! Fields are evaluated at points in part coordinates (mm) and have a value everywhere, even outside the part.

use glam::{DVec2, DVec3};

/// The value of a direction field at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionSample {
    /// Angle of the undirected axis from +X in the layer's plane, radians in `[0, pi)`.
    pub axis_rad: f64,
    /// Weight of the direction at this point, from 0 (any direction will do) to 1.
    pub strength: f64,
    /// The two in-plane principal stresses in MPa, along and across the axis; `None` if unknown.
    pub principal_mpa: Option<[f64; 2]>,
}

/// An undirected in-plane axis at every point of the part, in part coordinates (mm).
///
/// ```
/// use grainpath_core::{DVec3, DirectionField, DirectionSample, math::atan2};
///
/// /// Circles around the z axis: the growth rings of a tree.
/// struct Rings;
///
/// impl DirectionField for Rings {
///     fn sample(&self, p: DVec3) -> DirectionSample {
///         let axis_rad = atan2(p.x, -p.y).rem_euclid(std::f64::consts::PI);
///         DirectionSample { axis_rad, strength: 1.0, principal_mpa: None }
///     }
/// }
///
/// assert!((Rings.sample(DVec3::X).axis_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// ```
pub trait DirectionField: Send + Sync {
    /// The axis at `p`. Outside the part a field returns a sensible nearby value, never an error.
    fn sample(&self, p: DVec3) -> DirectionSample;

    /// The spacing of beads that the field asks for at `p`, mm; `None` if the infill density determines it.
    fn spacing_mm(&self, _p: DVec3) -> Option<f64> {
        None
    }

    /// Unit vector along which the rows of grids over the field lie. A field that turns with its part turns this too, so that
    /// what is computed on a grid is the same however the part lies.
    fn rows(&self) -> DVec2 {
        DVec2::X
    }
}

/// A field with the same axis everywhere.
///
/// ```
/// use grainpath_core::{DVec3, DirectionField, UniformField};
///
/// // An axis has no sign: 200 degrees are 20.
/// let field = UniformField { axis_rad: 200f64.to_radians() };
/// assert!((field.sample(DVec3::ZERO).axis_rad - 20f64.to_radians()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformField {
    /// Angle of the axis from +X, radians.
    pub axis_rad: f64,
}

impl DirectionField for UniformField {
    fn sample(&self, _p: DVec3) -> DirectionSample {
        DirectionSample {
            axis_rad: self.axis_rad.rem_euclid(std::f64::consts::PI),
            strength: 1.0,
            principal_mpa: None,
        }
    }
}
