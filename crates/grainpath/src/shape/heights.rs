//! The heights at which layers begin and end.
//!
//! Uniform layers all have the height of the job, the first one excepted. Adaptive layers follow
//! the slopes. A layer on a face whose normal has the vertical component `n_z` leaves stairs that
//! stand `h n_z` off the true face, the cusp height of `Dolenc1994`. The height is the largest that
//! keeps the cusp within bounds for all faces that reach into the layer. Flat faces make no stairs
//! and are left out. Heights grow by at most half from layer to layer, in steps of 0.01 mm. | The
//! last layer is the last one whose middle lies inside the part, so that the printed height is
//! nearest to the true one. Lengths are in mm. Cost: linear in the triangles for the slopes by
//! height, then linear in the layers.

use grainpath_core::TriMesh;

use super::{ShapeError, SliceSettings};

/// Layer heights that follow the slopes of the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// The thinnest layer, mm.
    pub min_height_mm: f64,
    /// The thickest, mm.
    pub max_height_mm: f64,
    /// Greatest distance of the stairs from the slope, measured square to it, mm.
    pub max_cusp_mm: f64,
}

/// Largest number of layers; a greater number is a wrong unit or height. Source: derived: a part of
/// 10 m, the largest that is placed, has as many layers of 0.05 mm.
const MAX_LAYERS: usize = 200_000;

/// The tops of all layers of a part `height_mm` high that stands on z = 0.
///
/// The last layer is the last whose middle is inside the part, so that the printed height is
/// nearest to the true one.
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
    let slopes = settings.adaptive.map(|a| Slopes::of(mesh, height_mm, a));
    let mut tops = vec![first];
    let mut height = settings.layer_height_mm;
    loop {
        let bottom = tops[tops.len() - 1];
        match &slopes {
            Some(s) => height = s.height_at(bottom, height),
            // Counted from the first layer, so that rounding errors do not add up.
            None => height = first + tops.len() as f64 * settings.layer_height_mm - bottom,
        }
        if bottom + 0.5 * height >= height_mm - 1e-6 {
            return Ok(tops);
        }
        tops.push(bottom + height);
    }
}

/// Slopes of the part's faces, by height.
struct Slopes {
    settings: Adaptive,
    /// Height of a bin, mm.
    step_mm: f64,
    /// Largest |n_z| of the facets that reach into each bin; flat ones, which make no stairs, left out.
    steepest: Vec<f64>,
}

impl Slopes {
    fn of(mesh: &TriMesh, height_mm: f64, settings: Adaptive) -> Self {
        // A quarter of the thinnest layer, so that a layer sees slopes with an error of a fraction
        // of its height.
        let step_mm = 0.25 * settings.min_height_mm;
        let mut steepest = vec![0.0f64; (height_mm / step_mm).ceil() as usize + 1];
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
            let nz = (b - a).cross(c - a).normalize_or_zero().z.abs();
            // Within 2.6 degrees of level (0.999 is its cosine) a face is a top or a bottom of the
            // part, without stairs.
            if nz > 0.999 {
                continue;
            }
            let (low, high) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
            let last = ((high / step_mm) as usize).min(steepest.len() - 1);
            for bin in &mut steepest[(low.max(0.0) / step_mm) as usize..=last] {
                *bin = bin.max(nz);
            }
        }
        Self { settings, step_mm, steepest }
    }

    /// The height of the layer that begins at `bottom_mm` above one of `before_mm`: as thick as the
    /// slopes in it allow, in steps of 0.01 mm, and at most half as much again as the layer before.
    fn height_at(&self, bottom_mm: f64, before_mm: f64) -> f64 {
        let s = &self.settings;
        // From layer to layer the height grows by at most half. The bound is on growth alone: a
        // steeper slope ahead shrinks the layer at once.
        let mut height = s.max_height_mm.min(1.5 * before_mm).max(s.min_height_mm);
        let mut bin = (bottom_mm / self.step_mm) as usize;
        while bin < self.steepest.len() && bin as f64 * self.step_mm < bottom_mm + height {
            let allowed = s.max_cusp_mm / self.steepest[bin].max(1e-9);
            // Where even the thinnest layer breaks the cusp bound, it is laid all the same.
            height = height.min(allowed.max(s.min_height_mm));
            bin += 1;
        }
        // Steps of 0.01 mm keep heights readable in the program; the tiny addend undoes rounding of
        // exact hundredths.
        (height * 100.0 + 1e-9).floor().max((s.min_height_mm * 100.0).ceil()) / 100.0
    }
}
