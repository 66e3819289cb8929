//! Which triangle each pixel shows, in a parallel projection.
//!
//! Each triangle is drawn pixel by pixel with a depth for each pixel; the nearest one stays. Cost: linear in the pixels
//! that the triangles cover.

use grainpath_core::{DVec2, DVec3};

/// The triangle that the middle of each pixel shows, row by row from the top. Corners have x to the right and y down in
/// pixels, and z towards the eye.
pub(crate) fn nearest(
    triangles: impl Iterator<Item = [DVec3; 3]>,
    width: usize,
    height: usize,
) -> Vec<Option<usize>> {
    let mut shown = vec![None; width * height];
    let mut depth = vec![f64::NEG_INFINITY; width * height];
    for (t, corners) in triangles.enumerate() {
        let [a, b, c] = corners.map(DVec3::truncate);
        let twice = (b - a).perp_dot(c - a);
        // A triangle that is seen edge-on covers no pixel.
        if !(twice.abs() > 0.0 && twice.is_finite()) {
            continue;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range = |low: f64, high: f64, n: usize| {
            ((low - 0.5).ceil().max(0.0) as usize)..((high + 0.5).floor().max(0.0) as usize).min(n)
        };
        for y in range(low.y, high.y, height) {
            for x in range(low.x, high.x, width) {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let (u, v) = ((p - a).perp_dot(c - a) / twice, (b - a).perp_dot(p - a) / twice);
                if u < 0.0 || v < 0.0 || u + v > 1.0 {
                    continue;
                }
                // Depth is linear in the pixel, since the projection is parallel.
                let z = corners[0].z + u * (corners[1].z - corners[0].z) + v * (corners[2].z - corners[0].z);
                let at = y * width + x;
                if z > depth[at] {
                    (depth[at], shown[at]) = (z, Some(t));
                }
            }
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_of_two_triangles_is_shown() {
        let triangle = |z: [f64; 3]| {
            [DVec3::new(0.0, 0.0, z[0]), DVec3::new(8.0, 0.0, z[1]), DVec3::new(0.0, 8.0, z[2])]
        };
        // They cross: the second is nearer on the left, the first on the right.
        let shown = nearest([triangle([0.0, 4.0, 0.0]), triangle([2.0; 3])].into_iter(), 8, 8);
        assert_eq!((shown[0], shown[3], shown[4], shown[6]), (Some(1), Some(1), Some(0), Some(0)));
        assert_eq!(shown[63], None);
        // Turned over it covers the same pixels; on its edge it covers none.
        let [a, b, c] = triangle([0.0; 3]);
        let n = |corners| nearest(std::iter::once(corners), 8, 8).iter().flatten().count();
        assert_eq!(n([a, b, c]), n([b, a, c]));
        assert_eq!(n([a, b, b]), 0);
    }
}
