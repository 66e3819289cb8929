//! The heights at which layers begin and end.
//!
//! All uniform layers except the first have the height that the job sets. Adaptive layers follow
//! the slopes. A layer on a face whose normal has the vertical component `n_z` leaves stairs that
//! stand `h n_z` off the true face, the cusp height of `Dolenc1994`. The height is the largest that
//! keeps the cusp within bounds for all faces that reach into the layer. Flat faces make no stairs
//! and are left out. Heights grow by at most half from layer to layer, in steps of 0.01 mm.
//!
//! The last uniform layer is the last one whose middle lies inside the part, so that the printed
//! height is nearest to the true one. Adaptive layers end within half a step of the part's height:
//! where the last one would end higher, the topmost layers are made thinner. Lengths are in mm.
//! Cost: linear in the triangles for the slopes by height, then linear in the layers.

use grainpath_core::TriMesh;

use super::{ShapeError, SliceSettings};

/// Layer heights that follow the slopes of the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// The thinnest layer, mm.
    pub min_height_mm: f64,
    /// The thickest, mm.
    pub max_height_mm: f64,
    /// Largest cusp height: distance of the stairs from the slope, measured at right angles to it, mm.
    pub max_cusp_mm: f64,
}

/// Heights of adaptive layers are multiples of this, mm. Source: derived. A leadscrew of 8 mm a turn with a motor of 200
/// steps moves 0.04 mm in a full step; drivers that divide steps by four or more can place a quarter of that.
const STEP_MM: f64 = 0.01;
/// Largest ratio of the heights of an adaptive layer and the one below it.
const MAX_GROWTH: f64 = 1.5;
/// Largest number of layers; a greater number means a wrong unit or layer height. Source: derived: a
/// part of 10 m, the largest that is accepted, has this many layers of 0.05 mm.
const MAX_LAYERS: usize = 200_000;

/// The tops of all layers of a part `height_mm` high that stands on z = 0.
///
/// The last uniform layer is the last whose middle is inside the part; adaptive layers end at the part's height.
///
/// # Errors
/// [`ShapeError::TooFlat`] or [`ShapeError::TooManyLayers`].
pub fn layer_heights(
    mesh: &TriMesh,
    height_mm: f64,
    settings: &SliceSettings,
) -> Result<Vec<f64>, ShapeError> {
    let first = settings.first_layer_height_mm;
    if height_mm < 0.5 * first {
        return Err(ShapeError::TooFlat { height_mm, first_layer_mm: first });
    }
    let thinnest = settings.adaptive.map_or(settings.layer_height_mm, |a| a.min_height_mm);
    let n = (height_mm / thinnest).ceil();
    if n > MAX_LAYERS as f64 {
        return Err(ShapeError::TooManyLayers { n: n as usize, height_mm: thinnest, limit: MAX_LAYERS });
    }
    let mut tops = vec![first];
    if let Some(adaptive) = settings.adaptive {
        let slopes = Slopes::new(mesh, height_mm, adaptive);
        let mut steps = Vec::new();
        let (mut bottom, mut height) = (first, settings.layer_height_mm);
        while bottom < height_mm - 0.5 * STEP_MM {
            height = slopes.height_at(bottom, height);
            bottom += height;
            steps.push((height / STEP_MM).round() as u32);
        }
        let excess = ((bottom - height_mm) / STEP_MM).round().max(0.0) as u32;
        thin_topmost(&mut steps, excess, (adaptive.min_height_mm / STEP_MM).ceil() as u32);
        tops.extend(steps.iter().scan(0, |sum, step| {
            *sum += step;
            Some(first + f64::from(*sum) * STEP_MM)
        }));
        return Ok(tops);
    }
    loop {
        // Each top is computed from the first layer, so that rounding errors do not add up.
        let bottom = tops[tops.len() - 1];
        let height = first + tops.len() as f64 * settings.layer_height_mm - bottom;
        if bottom + 0.5 * height >= height_mm - 1e-6 {
            return Ok(tops);
        }
        tops.push(bottom + height);
    }
}

/// Takes `excess` steps off the topmost layers, the thickest first, so that the last one ends at the part's height.
///
/// The excess is shared by as many layers as are needed if each loses up to a third of its height. If the part has too
/// few layers for that, all of them are thinned, down to `least` steps. If that is not enough either, the last layer is
/// removed if more than half of it stands above the part. The thickest layers are thinned first, so a layer stays at most
/// [`MAX_GROWTH`] times as high as the one below it.
fn thin_topmost(steps: &mut Vec<u32>, excess: u32, least: u32) {
    // How many of the topmost layers are needed to absorb the excess together.
    let enough = |given: &dyn Fn(u32) -> u32| {
        let sums = steps.iter().rev().scan(0, |sum, &h| {
            *sum += given(h);
            Some(*sum)
        });
        1 + sums.take_while(|&sum| sum < excess).count()
    };
    let a_third = |h: u32| h - least.max((f64::from(h) / MAX_GROWTH).ceil() as u32).min(h);
    let all = |h: u32| h.saturating_sub(least);
    let n = enough(&a_third);
    let n = if n > steps.len() { enough(&all).max(steps.len()) } else { n };
    if n > steps.len() {
        if steps.last().is_some_and(|&last| 2 * excess > last) {
            steps.pop();
        }
        return;
    }
    let topmost = steps.len() - n;
    for _ in 0..excess {
        if let Some(thickest) = steps[topmost..].iter_mut().max() {
            *thickest -= 1;
        }
    }
}

/// Slopes of the part's faces, by height.
struct Slopes {
    settings: Adaptive,
    /// Height of a bin, mm.
    step_mm: f64,
    /// Largest |n_z| of the facets that reach into each bin. Flat facets make no stairs and are left out.
    steepest: Vec<f64>,
}

impl Slopes {
    fn new(mesh: &TriMesh, height_mm: f64, settings: Adaptive) -> Self {
        // A bin is a quarter of the thinnest layer, so that slopes are located to a fraction of a
        // layer's height.
        let step_mm = 0.25 * settings.min_height_mm;
        let mut steepest = vec![0.0f64; (height_mm / step_mm).ceil() as usize + 1];
        for t in &mesh.triangles {
            let nz = mesh.normal(*t).z.abs();
            // Within 2.6 degrees of level (0.999 is its cosine) a face is a top or a bottom of the
            // part, without stairs.
            if nz > 0.999 {
                continue;
            }
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize].z);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let last = ((high / step_mm) as usize).min(steepest.len() - 1);
            for bin in &mut steepest[(low.max(0.0) / step_mm) as usize..=last] {
                *bin = bin.max(nz);
            }
        }
        Self { settings, step_mm, steepest }
    }

    /// The thickness of the layer that begins at `bottom_mm`, above a layer `before_mm` thick. It is as thick as the
    /// slopes in it allow, in steps of 0.01 mm, and at most 1.5 times as thick as the layer below.
    fn height_at(&self, bottom_mm: f64, before_mm: f64) -> f64 {
        let s = &self.settings;
        // From layer to layer the height grows by at most half. The bound is on growth alone: a
        // steeper slope ahead shrinks the layer at once.
        let mut height = s.max_height_mm.min(MAX_GROWTH * before_mm).max(s.min_height_mm);
        let mut bin = (bottom_mm / self.step_mm) as usize;
        while bin < self.steepest.len() && bin as f64 * self.step_mm < bottom_mm + height {
            let allowed = s.max_cusp_mm / self.steepest[bin].max(1e-9);
            // Where even the thinnest layer exceeds the cusp height, the thinnest layer is used.
            height = height.min(allowed.max(s.min_height_mm));
            bin += 1;
        }
        // Steps of 0.01 mm keep heights readable in the program; the tiny addend undoes rounding of
        // exact hundredths.
        (height * 100.0 + 1e-9).floor().max((s.min_height_mm * 100.0).ceil()) / 100.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn settings(min_height_mm: f64, max_height_mm: f64) -> SliceSettings {
        let adaptive = Some(Adaptive { min_height_mm, max_height_mm, max_cusp_mm: 0.1 });
        SliceSettings {
            layer_height_mm: 0.2,
            first_layer_height_mm: 0.2,
            adaptive,
            gap_closing_mm: 0.05,
            simplify_mm: 0.005,
        }
    }

    proptest! {
        /// Parts of any height without slopes: adaptive layers end at the part's height, none is thinner than asked for,
        /// and none is more than half higher than the one below it.
        #[test]
        fn adaptive_layers_end_at_the_height_of_the_part(
            height_mm in 1.0f64..60.0,
            min in 2u32..12,
            more in 5u32..30,
        ) {
            let (min, max) = (f64::from(min) * STEP_MM, f64::from(min + more) * STEP_MM);
            let tops = layer_heights(&TriMesh::default(), height_mm, &settings(min, max)).expect("tops");
            let top = tops[tops.len() - 1];
            prop_assert!((top - height_mm).abs() <= 0.5 * STEP_MM + 1e-9, "{} for {}", top, height_mm);
            let heights: Vec<f64> = tops.windows(2).map(|w| w[1] - w[0]).collect();
            prop_assert!(heights.iter().all(|h| (min - 1e-9..max + 1e-9).contains(h)), "{:?}", heights);
            for w in heights.windows(2) {
                prop_assert!(w[1] <= MAX_GROWTH * w[0] + STEP_MM, "{:?}", heights);
            }
        }
    }

    #[test]
    fn what_cannot_be_thinned_ends_at_the_nearest_layer() {
        let mut steps = vec![8, 8];
        thin_topmost(&mut steps, 5, 8);
        assert_eq!(steps, [8]);
        let mut steps = vec![8, 8];
        thin_topmost(&mut steps, 3, 8);
        assert_eq!(steps, [8, 8]);
    }

    /// The last uniform layer is the last whose middle is inside the part.
    #[test]
    fn uniform_layers_end_within_half_a_layer() {
        for (height_mm, wanted) in [(20.0, 20.0), (20.09, 20.0), (20.11, 20.2)] {
            let uniform = SliceSettings { adaptive: None, ..settings(0.08, 0.28) };
            let tops = layer_heights(&TriMesh::default(), height_mm, &uniform).expect("tops");
            assert!((tops[tops.len() - 1] - wanted).abs() < 1e-9, "{height_mm}");
        }
    }
}
