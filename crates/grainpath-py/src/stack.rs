//! Cross-sections of parts: made from rings, given as rings, and kept as bytes.

use std::sync::Arc;

use grainpath_cli::Failure;
use grainpath_core::poly::{Contour, FillRule};
use grainpath_core::{DVec2, Layer, LayerStack, Polygon, Region};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;

use crate::worker::{self, Caller};

/// A part as a stack of cross-sections with heights.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct StackData {
    /// The sections.
    pub stack: Arc<LayerStack>,
}

#[pymethods]
impl StackData {
    /// Height of the top and thickness of each layer, mm, alternating.
    fn heights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let layers = self.stack.layers();
        PyArray1::from_vec(py, layers.iter().flat_map(|l| [l.z_top_mm(), l.height_mm()]).collect())
    }

    /// Area of each section, mm2.
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let layers = self.stack.layers();
        PyArray1::from_vec(py, layers.iter().map(|l| l.region().area_mm2()).collect())
    }

    /// The rings of a section: for each polygon its outer ring and its holes, `(n, 2)`.
    #[allow(clippy::type_complexity)]
    fn section<'py>(&self, py: Python<'py>, k: usize) -> PyResult<Vec<Vec<Bound<'py, PyArray2<f64>>>>> {
        let ring = |points: &[DVec2]| {
            let flat: Vec<f64> = points.iter().flat_map(|p| p.to_array()).collect();
            PyArray1::from_vec(py, flat).reshape([points.len(), 2])
        };
        let rings = |p: &Polygon| p.contours().map(|c| ring(c)).collect();
        self.stack.layers()[k].region().polygons.iter().map(rings).collect()
    }

    /// The stack as bytes. Equal stacks give equal bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.stack.to_bytes()))
    }
}

/// Reads a stack from the bytes that [`StackData::to_bytes`] made.
#[pyfunction]
pub(crate) fn stack_from_bytes(py: Python<'_>, bytes: Vec<u8>) -> PyResult<StackData> {
    worker::run(py, &Caller::default(), move |_, _| {
        let stack = LayerStack::from_bytes(&bytes).map_err(|e| Failure::input(e.to_string()))?;
        Ok(StackData { stack: Arc::new(stack) })
    })
}

/// Makes a stack from rings. `heights` alternates the top and the thickness of each layer. `points` holds the points of all
/// rings, and `counts` the number of points of each ring, layer by layer. Rings may cross and overlap. Which points are
/// inside follows the even-odd rule if `even_odd` is true, otherwise the non-zero rule.
#[pyfunction]
pub(crate) fn stack_from_rings(
    py: Python<'_>,
    heights: PyReadonlyArray1<'_, f64>,
    points: PyReadonlyArray2<'_, f64>,
    counts: Vec<Vec<usize>>,
    even_odd: bool,
) -> PyResult<StackData> {
    let heights = heights.as_slice()?.to_vec();
    let mut points = points.as_slice()?.chunks_exact(2).map(DVec2::from_slice);
    let of_layer = |counts: &Vec<usize>| counts.iter().map(|n| points.by_ref().take(*n).collect()).collect();
    let rings: Vec<Vec<Contour>> = counts.iter().map(of_layer).collect();
    worker::run(py, &Caller::default(), move |diagnostics, _| {
        let rule = if even_odd { FillRule::EvenOdd } else { FillRule::NonZero };
        let wrong = |k: usize| {
            Failure::input(format!(
                "layer {k} should begin above the plate, be higher than 0, and end above the layer below"
            ))
        };
        let layers = rings.par_iter().zip(heights.par_chunks_exact(2)).enumerate().map(|(k, (rings, z))| {
            diagnostics.check().map_err(grainpath::Error::from)?;
            Layer::new(z[0], z[1], Region::from_contours(rings, rule)).ok_or_else(|| wrong(k))
        });
        let layers = layers.collect::<Result<Vec<Layer>, Failure>>()?;
        let falls = layers.windows(2).position(|w| w[0].z_top_mm() >= w[1].z_top_mm());
        if let Some(k) = falls {
            return Err(wrong(k + 1));
        }
        let stack = LayerStack::new(layers).ok_or_else(|| wrong(0))?;
        Ok(StackData { stack: Arc::new(stack) })
    })
}
