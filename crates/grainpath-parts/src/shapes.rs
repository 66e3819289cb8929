//! Arcs and prisms that the parts are built from.

use grainpath_core::math::direction;
use grainpath_core::{DVec2, Polygon, TriMesh};

/// Points of `n_quarters` quarters of a circle, counter-clockwise.
pub(crate) fn arc(
    centre: DVec2,
    radius: f64,
    first_quarter: i32,
    n_quarters: i32,
    per_quarter: i32,
) -> Vec<DVec2> {
    // An arc includes its end point. A whole circle leaves it out, because its end point is its first
    // point.
    let whole = i32::from(n_quarters < 4);
    (0..n_quarters * per_quarter + whole)
        .map(|i| {
            let turn = f64::from(first_quarter) + f64::from(i) / f64::from(per_quarter);
            centre + direction(turn * std::f64::consts::FRAC_PI_2) * radius
        })
        .collect()
}

/// Adds a prism over an outline with holes; all rings are given counter-clockwise.
pub(crate) fn prism(outline: &[DVec2], holes: &[Vec<DVec2>], low: f64, high: f64, mesh: &mut TriMesh) {
    // Polygons want holes clockwise. Callers give counter-clockwise rings throughout, so that one arc
    // function serves both.
    let clockwise = |hole: &Vec<DVec2>| hole.iter().rev().copied().collect();
    let polygon = Polygon { outer: outline.to_vec(), holes: holes.iter().map(clockwise).collect() };
    grainpath::shape::prism(&polygon.into(), low, high, mesh).expect("our own outlines do not cross");
}
