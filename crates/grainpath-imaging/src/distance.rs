//! Signed distance from the border of a region on a grid: positive inside.
//!
//! # Method
//! Vector distance transform by sweeps (`danielsson1980` in docs/references.bib), with edges instead of points:
//! each pixel compares its own nearest edge with that of a neighbour, and keeps the one to which its distance is
//! smaller. Four sweeps carry an edge to all pixels. The sign comes from counting the crossings of each row with
//! the border.
//!
//! # Units, cost and limits
//! Distances are in mm, row-major, `(ny, nx)`. The cost is linear in the pixels, plus the pixels along
//! each edge. Distances next to the border are exact. A pixel far away may take the second nearest edge,
//! because a sweep sees only neighbours; the distance then changes by a fraction of a pixel.

use grainpath_core::poly::edges;
use grainpath_core::{Bounds2, DVec2, Region, segment};

/// A grid of pixels in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// The middle of the first pixel, mm.
    pub origin: DVec2,
    /// Distance of pixels, mm.
    pub pixel_mm: DVec2,
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
}

/// Limit on pixels; larger grids are made coarser. Source: derived. A grid takes 8 bytes for each pixel, 32 MB at the
/// limit.
const MAX_PIXELS: f64 = 4e6;

impl Raster {
    /// A grid over a box, with two pixels more on every side.
    pub fn over(bounds: Bounds2, pixel_mm: DVec2) -> Self {
        let n = bounds.size() / pixel_mm;
        // The factor applies to the sides of a pixel, so it is the square root of the ratio of areas.
        let pixel_mm = pixel_mm * ((n.x + 4.0) * (n.y + 4.0) / MAX_PIXELS).sqrt().max(1.0);
        let n = (bounds.size() / pixel_mm).ceil();
        let (nx, ny) = (n.x as usize + 5, n.y as usize + 5);
        Self { origin: bounds.min - 2.0 * pixel_mm, pixel_mm, nx, ny }
    }

    fn at(&self, i: usize, j: usize) -> DVec2 {
        self.origin + DVec2::new(i as f64, j as f64) * self.pixel_mm
    }

    /// Converts a point of a contour from pixels (see [`SignedImage::contours`](crate::scan::SignedImage::contours)) to mm.
    pub fn to_mm(&self, p: DVec2) -> DVec2 {
        self.origin + (p - 0.5) * self.pixel_mm
    }
}

/// Signed distance in mm at every pixel, row-major.
///
/// Each pixel adopts the nearest edge of a neighbour if that edge is nearer than its own; four sweeps
/// carry an edge everywhere. The error is below a hundredth of a pixel near the border, where it matters.
pub fn signed_distance(region: &Region, raster: &Raster) -> Vec<f32> {
    let (nx, ny) = (raster.nx, raster.ny);
    let segments: Vec<(DVec2, DVec2)> = region.contours().flat_map(|c| edges(c)).collect();
    let mut nearest = vec![u32::MAX; nx * ny];
    let mut best = vec![f32::INFINITY; nx * ny];
    let measure = |p: DVec2, s: u32| {
        let (a, b) = segments[s as usize];
        segment::distance_squared_mm2(p, a, b) as f32
    };
    // Pixels beside an edge are measured exactly before the sweeps spread it.
    for (s, (a, b)) in segments.iter().enumerate() {
        let cell = |p: DVec2| (p - raster.origin) / raster.pixel_mm;
        let (low, high) = (cell(a.min(*b)) - 1.0, cell(a.max(*b)) + 2.0);
        let index = |v: f64, n: usize| v.clamp(0.0, n as f64) as usize;
        for j in index(low.y, ny)..index(high.y, ny) {
            for i in index(low.x, nx)..index(high.x, nx) {
                let d = measure(raster.at(i, j), s as u32);
                if d < best[j * nx + i] {
                    (best[j * nx + i], nearest[j * nx + i]) = (d, s as u32);
                }
            }
        }
    }
    let mut hear = |i: usize, j: usize, from: [(isize, isize); 4]| {
        let p = raster.at(i, j);
        for (dx, dy) in from {
            let (x, y) = (i.wrapping_add_signed(dx), j.wrapping_add_signed(dy));
            if x < nx && y < ny {
                let s = nearest[y * nx + x];
                if s != u32::MAX && s != nearest[j * nx + i] {
                    let d = measure(p, s);
                    if d < best[j * nx + i] {
                        (best[j * nx + i], nearest[j * nx + i]) = (d, s);
                    }
                }
            }
        }
    };
    // Upward and downward sweeps, each with a pass to the right and one to the left: together they carry
    // an edge in all eight directions.
    for j in 0..ny {
        for i in 0..nx {
            hear(i, j, [(-1, 0), (-1, -1), (0, -1), (1, -1)]);
        }
        for i in (0..nx).rev() {
            hear(i, j, [(1, 0), (1, -1), (0, -1), (-1, -1)]);
        }
    }
    for j in (0..ny).rev() {
        for i in (0..nx).rev() {
            hear(i, j, [(1, 0), (1, 1), (0, 1), (-1, 1)]);
        }
        for i in 0..nx {
            hear(i, j, [(-1, 0), (-1, 1), (0, 1), (1, 1)]);
        }
    }
    // The sign by even-odd counting along rows: exact for any set of closed contours, and independent of
    // their winding.
    let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); ny];
    for &(a, b) in &segments {
        let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
        let row = |y: f64| ((y - raster.origin.y) / raster.pixel_mm.y).ceil().clamp(0.0, ny as f64) as usize;
        // A half-open range of rows counts a vertex on a row once.
        for j in row(low.y)..row(high.y) {
            let y = raster.at(0, j).y;
            crossings[j].push(low.x + (high.x - low.x) * (y - low.y) / (high.y - low.y));
        }
    }
    for (j, row) in crossings.iter_mut().enumerate() {
        row.sort_by(f64::total_cmp);
        let mut passed = 0;
        for i in 0..nx {
            let x = raster.at(i, j).x;
            while passed < row.len() && row[passed] <= x {
                passed += 1;
            }
            let d = &mut best[j * nx + i];
            // In a region without edges all pixels would stay at infinity. A finite number keeps later
            // interpolation free of NaN.
            *d = if d.is_finite() { d.sqrt() } else { f32::MAX.sqrt() };
            if passed % 2 == 0 {
                *d = -*d;
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_in_a_square_with_a_hole_are_exact() {
        let square = Region::rectangle(DVec2::ZERO, DVec2::splat(20.0));
        let hole = Region::rectangle(DVec2::splat(8.0), DVec2::new(13.0, 11.0));
        let region = square.difference(&hole);
        let raster =
            Raster::over(Bounds2 { min: DVec2::splat(-4.0), max: DVec2::splat(24.0) }, DVec2::new(0.7, 0.9));
        let d = signed_distance(&region, &raster);
        let to_box = |p: DVec2, a: DVec2, b: DVec2| {
            let out = (a - p).max(p - b);
            if out.max_element() < 0.0 { -out.max_element() } else { -out.max(DVec2::ZERO).length() }
        };
        for j in 0..raster.ny {
            for i in 0..raster.nx {
                let p = raster.at(i, j);
                let outer = to_box(p, DVec2::ZERO, DVec2::splat(20.0));
                let inner = to_box(p, DVec2::splat(8.0), DVec2::new(13.0, 11.0));
                let truth = outer.min(-inner);
                let found = f64::from(d[j * raster.nx + i]);
                assert!((found - truth).abs() < 1e-5, "{p}: {found} {truth}");
            }
        }
    }
}
