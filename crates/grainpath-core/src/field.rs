//! Direction fields: which way the force, or the grain, runs.

use glam::DVec3;

/// What a direction field says at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionSample {
    /// Angle of the undirected axis from +X in the layer's plane, radians in `[0, pi)`.
    pub axis_rad: f64,
    /// How much the direction matters here, 0 (any will do) to 1.
    pub strength: f64,
    /// The two in-plane principal stresses in MPa, along and across the axis, where known.
    pub principal_mpa: Option<[f64; 2]>,
}

/// An undirected in-plane axis at every point of the part, in part coordinates (mm).
pub trait DirectionField: Send + Sync {
    /// The axis at `p`. Outside the part it is the nearest sensible value, never an error.
    fn sample(&self, p: DVec3) -> DirectionSample;
}

/// The same axis everywhere.
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
