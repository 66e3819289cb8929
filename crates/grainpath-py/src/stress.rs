//! Stress at any point of a part.

use std::sync::{Arc, OnceLock};

use grainpath::guide::ResultMesh;
use grainpath_core::DVec3;
use grainpath_io::fe::{FeFormat, FeResult, StressField};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::worker::{self, Caller};

/// The stress of one load case.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct StressData {
    name: String,
    weight: f64,
    mesh: Arc<ResultMesh>,
    /// The field that finds the stress at a point, made at the first query.
    field: Arc<OnceLock<StressField>>,
}

impl StressData {
    /// The stress of a case.
    pub fn new(weight: f64, mesh: &ResultMesh) -> Self {
        Self { name: mesh.name.clone(), weight, mesh: Arc::new(mesh.clone()), field: Arc::default() }
    }
}

/// The result in the form that file readers give.
fn result(mesh: &ResultMesh) -> FeResult {
    FeResult {
        format: FeFormat::Vtu,
        nodes: mesh.nodes.clone(),
        elements: mesh.elements.clone(),
        stress: mesh.stress.clone(),
        displacement: mesh.displacement.clone(),
        plane: mesh.elements.first().is_some_and(|e| e.kind.dimension() == 2),
        stress_array: String::new(),
        warnings: Vec::new(),
    }
}

#[pymethods]
impl StressData {
    /// Name of the case.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Weight of the case.
    #[getter]
    fn weight(&self) -> f64 {
        self.weight
    }

    /// Positions of the nodes, mm, part coordinates, `(n, 3)`.
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flat = self.mesh.nodes.iter().flat_map(|p| p.to_array()).collect();
        PyArray1::from_vec(py, flat).reshape([self.mesh.nodes.len(), 3])
    }

    /// Stress at the nodes, MPa, `(n, 6)`: xx, yy, zz, xy, yz, zx.
    fn at_nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flat = self.mesh.stress.iter().flatten().copied().collect();
        PyArray1::from_vec(py, flat).reshape([self.mesh.stress.len(), 6])
    }

    /// Displacement of the nodes, mm, `(n, 3)`, where it is known.
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(all) = &self.mesh.displacement else { return Ok(None) };
        let flat = all.iter().flat_map(|p| p.to_array()).collect();
        PyArray1::from_vec(py, flat).reshape([all.len(), 3]).map(Some)
    }

    /// Stress `(n, 6)`, MPa, at points `(n, 3)`. A point outside the part has the stress of the part's nearest point.
    fn at<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points: Vec<DVec3> = points.as_slice()?.chunks_exact(3).map(DVec3::from_slice).collect();
        // The thread shares the data, since it may run on for a while after Ctrl-C has ended this call.
        let (n, field, mesh) = (points.len(), Arc::clone(&self.field), Arc::clone(&self.mesh));
        let found = worker::run(py, &Caller::default(), move |diagnostics, _| {
            let field = field.get_or_init(|| StressField::new(result(&mesh)));
            let mut out = Vec::with_capacity(6 * points.len());
            // The stop flag is read once in 4096 points, each of which takes microseconds.
            for some in points.chunks(4096) {
                diagnostics.check().map_err(grainpath::Error::from)?;
                out.extend(some.iter().flat_map(|p| field.sample(*p)));
            }
            Ok(out)
        })?;
        PyArray1::from_vec(py, found).reshape([n, 6])
    }
}
