//! Smoothing of a slice before its contours are traced.
//!
//! - A Gaussian moves every bent edge inwards; it suits scans whose edges are blurred anyway.
//! - The median of 3 x 3 pixels removes single bright pixels and leaves straight edges in place.
//! - Diffusion that stops at edges (`perona1990` in docs/references.bib, its second conductance
//!   `1 / (1 + (d / step)^2)`): six steps of 0.2, which is within the stability limit of 0.25 in two
//!   dimensions. `step` is the grey step that counts as an edge.
//!
//! Slices are `(ny, nx)`, row-major, in the grey values of the scan; lengths are in pixels. The border values
//! continue beyond the border. Cost: linear in the pixels; for a Gaussian times its standard deviation, as it
//! is separable. A copy of the slice is made for each step.
//!
//! Degenerate cases: an empty slice stays empty. A Gaussian narrower than 0.05 px and an edge step of 0
//! change nothing. Pixels that are not numbers spread to their neighbours in a Gaussian and in diffusion.

use crate::raster::Grey;

/// A method of smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smoothing {
    /// No smoothing.
    None,
    /// Gaussian of this standard deviation, px.
    Gaussian(f64),
    /// Median of 3 x 3.
    Median,
    /// Diffusion that stops at edges (Perona & Malik 1990); the grey step that counts as an edge.
    Edges(f64),
}

/// Returns the slice smoothed by the given method.
pub fn smoothed(mut values: Vec<f32>, nx: usize, ny: usize, how: Smoothing) -> Vec<f32> {
    let grey = |data| Grey { width: nx, height: ny, data };
    match how {
        Smoothing::None => {}
        Smoothing::Gaussian(sigma_px) => return grey(values).blurred(sigma_px).data,
        Smoothing::Median => return grey(values).median(1).data,
        Smoothing::Edges(step) => (0..6).for_each(|_| diffuse(&mut values, nx, ny, step as f32)),
    }
    values
}

fn diffuse(values: &mut [f32], nx: usize, ny: usize, step: f32) {
    // Explicit steps read the old values only, so the result does not depend on the order of pixels.
    let old = values.to_vec();
    // A step of 0 would divide by zero; the smallest float switches diffusion off instead.
    let scale = 1.0 / step.max(f32::MIN_POSITIVE);
    let flow = |d: f32| d / (1.0 + (d * scale) * (d * scale));
    for j in 0..ny {
        let (up, down) = (j.saturating_sub(1) * nx, (j + 1).min(ny - 1) * nx);
        for i in 0..nx {
            let v = old[j * nx + i];
            let (left, right) = (old[j * nx + i.saturating_sub(1)], old[j * nx + (i + 1).min(nx - 1)]);
            let sum = flow(left - v) + flow(right - v) + flow(old[up + i] - v) + flow(old[down + i] - v);
            // 0.2 of the sum over four neighbours; the scheme is stable up to 0.25.
            values[j * nx + i] = v + 0.2 * sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_goes_and_the_edge_stays_where_it_was() {
        let (nx, ny) = (40, 30);
        let noisy = |i: usize| {
            let noise = ((i * 7919) % 41) as f32 - 20.0;
            if i % nx < 20 { 0.0 + noise } else { 200.0 + noise }
        };
        let before: Vec<f32> = (0..nx * ny).map(noisy).collect();
        let rough = |v: &[f32]| (0..ny).map(|j| (v[j * nx + 10]).powi(2)).sum::<f32>();
        for how in [Smoothing::Gaussian(1.0), Smoothing::Median, Smoothing::Edges(60.0)] {
            let v = smoothed(before.clone(), nx, ny, how);
            assert!(rough(&v) < 0.8 * rough(&before), "{how:?}: {} {}", rough(&v), rough(&before));
            let mean = |i: usize| (0..ny).map(|j| v[j * nx + i]).sum::<f32>() / ny as f32;
            assert!(mean(19) < 100.0 && mean(20) > 100.0, "{how:?}: {} {}", mean(19), mean(20));
        }
    }
}
