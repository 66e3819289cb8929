//! Elementary functions that call no library of the system, so that their bits do not depend on it.
//!
//! `f64::sin` and similar functions call the system's libm, whose results differ in the last bit between
//! platforms. One differing bit can reverse the direction of a path. The functions here are pure
//! Rust; `clippy.toml` bans those of the standard library.

pub use libm::{acos, asin, atan, atan2, cos, exp, hypot, log as ln, pow, sin, tan};

use glam::DVec2;

/// Sine and cosine of an angle in radians.
pub fn sin_cos(angle_rad: f64) -> (f64, f64) {
    (sin(angle_rad), cos(angle_rad))
}

/// The unit vector at `angle_rad` from +X, counter-clockwise.
pub fn direction(angle_rad: f64) -> DVec2 {
    let (s, c) = sin_cos(angle_rad);
    DVec2::new(c, s)
}

/// `p` turned clockwise by the angle whose unit vector is `by`: what [`rotated`] turned is turned back.
pub fn turned_back(p: DVec2, by: DVec2) -> DVec2 {
    rotated(p, DVec2::new(by.x, -by.y))
}

/// `p` turned counter-clockwise by the angle whose unit vector is `by` (see [`direction`]).
pub fn rotated(p: DVec2, by: DVec2) -> DVec2 {
    DVec2::new(p.x * by.x - p.y * by.y, p.x * by.y + p.y * by.x)
}

/// Cross product's z component of two plane vectors: positive when `b` is counter-clockwise of `a`.
pub fn cross(a: DVec2, b: DVec2) -> f64 {
    a.x * b.y - a.y * b.x
}
