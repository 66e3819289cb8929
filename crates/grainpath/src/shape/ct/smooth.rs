//! Noise taken out of a slice before its contours are traced.

/// How.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smoothing {
    /// Not at all.
    None,
    /// Gaussian of this standard deviation, px.
    Gaussian(f64),
    /// Median of 3 x 3.
    Median,
    /// Diffusion that stops at edges (Perona & Malik 1990); the grey step that counts as an edge.
    Edges(f64),
}

/// Smooths a slice in place.
pub fn smooth(values: &mut [f32], nx: usize, ny: usize, how: Smoothing) {
    match how {
        Smoothing::None => {}
        Smoothing::Gaussian(sigma_px) => gaussian(values, nx, ny, sigma_px),
        Smoothing::Median => median(values, nx, ny),
        Smoothing::Edges(step) => (0..6).for_each(|_| diffuse(values, nx, ny, step as f32)),
    }
}

/// Separable Gaussian; the border's values go on outside.
pub fn gaussian(values: &mut [f32], nx: usize, ny: usize, sigma_px: f64) {
    if sigma_px < 0.05 {
        return;
    }
    let reach = (3.0 * sigma_px).ceil() as usize;
    let weight = |i: usize| {
        let x = i as f64 / sigma_px;
        grainpath_core::math::exp(-0.5 * x * x)
    };
    let half: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = half[0] + 2.0 * half[1..].iter().sum::<f64>();
    let half: Vec<f32> = half.iter().map(|w| (w / sum) as f32).collect();
    let mut across = vec![0.0f32; values.len()];
    for j in 0..ny {
        let row = &values[j * nx..(j + 1) * nx];
        for (i, out) in across[j * nx..(j + 1) * nx].iter_mut().enumerate() {
            let mut v = half[0] * row[i];
            for (k, w) in half.iter().enumerate().skip(1) {
                v += w * (row[i.saturating_sub(k)] + row[(i + k).min(nx - 1)]);
            }
            *out = v;
        }
    }
    for j in 0..ny {
        let out = &mut values[j * nx..(j + 1) * nx];
        for (v, a) in out.iter_mut().zip(&across[j * nx..(j + 1) * nx]) {
            *v = half[0] * a;
        }
        for (k, w) in half.iter().enumerate().skip(1) {
            let (up, down) = (j.saturating_sub(k) * nx, (j + k).min(ny - 1) * nx);
            for (i, v) in out.iter_mut().enumerate() {
                *v += w * (across[up + i] + across[down + i]);
            }
        }
    }
}

fn median(values: &mut [f32], nx: usize, ny: usize) {
    let old = values.to_vec();
    for j in 0..ny {
        for i in 0..nx {
            let mut near = [0.0f32; 9];
            for (k, v) in near.iter_mut().enumerate() {
                let x = (i + k % 3).saturating_sub(1).min(nx - 1);
                let y = (j + k / 3).saturating_sub(1).min(ny - 1);
                *v = old[y * nx + x];
            }
            near.sort_unstable_by(f32::total_cmp);
            values[j * nx + i] = near[4];
        }
    }
}

fn diffuse(values: &mut [f32], nx: usize, ny: usize, step: f32) {
    let old = values.to_vec();
    let scale = 1.0 / step.max(f32::MIN_POSITIVE);
    let flow = |d: f32| d / (1.0 + (d * scale) * (d * scale));
    for j in 0..ny {
        let (up, down) = (j.saturating_sub(1) * nx, (j + 1).min(ny - 1) * nx);
        for i in 0..nx {
            let v = old[j * nx + i];
            let (left, right) = (old[j * nx + i.saturating_sub(1)], old[j * nx + (i + 1).min(nx - 1)]);
            let sum = flow(left - v) + flow(right - v) + flow(old[up + i] - v) + flow(old[down + i] - v);
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
            let mut v = before.clone();
            smooth(&mut v, nx, ny, how);
            assert!(rough(&v) < 0.8 * rough(&before), "{how:?}: {} {}", rough(&v), rough(&before));
            let mean = |i: usize| (0..ny).map(|j| v[j * nx + i]).sum::<f32>() / ny as f32;
            assert!(mean(19) < 100.0 && mean(20) > 100.0, "{how:?}: {} {}", mean(19), mean(20));
        }
    }
}
