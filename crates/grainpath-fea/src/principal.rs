//! Principal stresses in the plane and their axes.
//!
//! Closed form from Mohr's circle: the values are its centre plus and minus its radius. Stresses
//! are in MPa, tension positive; angles in radians from x.

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, direction};

/// Plane stress xx, yy, xy, MPa.
pub type PlaneTensor = [f64; 3];

/// Principal stresses in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanePrincipal {
    /// The greater and the smaller one, MPa.
    pub values_mpa: [f64; 2],
    /// Angle of the greater one's axis from x, radians in `[0, pi)`. Where both are equal every
    /// axis is principal and this is 0.
    pub axis_rad: f64,
}

/// Principal values and axes of a plane tensor.
pub fn plane_principal([xx, yy, xy]: PlaneTensor) -> PlanePrincipal {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = (half * half + xy * xy).sqrt();
    // Without a radius every axis is principal, and the arctangent of two zeros would depend on
    // their signs.
    let axis_rad = if radius > 0.0 { (0.5 * atan2(xy, half)).rem_euclid(std::f64::consts::PI) } else { 0.0 };
    PlanePrincipal { values_mpa: [mean + radius, mean - radius], axis_rad }
}

/// Equivalent stress after von Mises of a plane tensor, MPa.
pub fn von_mises_plane([xx, yy, xy]: PlaneTensor) -> f64 {
    // Rounding may make equal stresses slightly negative under the root.
    (xx * xx - xx * yy + yy * yy + 3.0 * xy * xy).max(0.0).sqrt()
}

/// Normal stress along a direction in the plane, MPa.
pub fn along([xx, yy, xy]: PlaneTensor, axis_rad: f64) -> f64 {
    let DVec2 { x, y } = direction(axis_rad);
    xx * x * x + yy * y * y + 2.0 * xy * x * y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_axes_carry_the_principal_values() {
        for tensor in
            [[3.0, -1.0, 2.0], [1.0, 5.0, -0.5], [0.0, 0.0, 4.0], [-2.0, -7.0, 0.0], [2.0, 2.0, 0.0]]
        {
            let p = plane_principal(tensor);
            assert!((along(tensor, p.axis_rad) - p.values_mpa[0]).abs() < 1e-12);
            let across = p.axis_rad + std::f64::consts::FRAC_PI_2;
            assert!((along(tensor, across) - p.values_mpa[1]).abs() < 1e-12);
        }
        assert!((von_mises_plane([100.0, 0.0, 0.0]) - 100.0).abs() < 1e-12);
    }
}
