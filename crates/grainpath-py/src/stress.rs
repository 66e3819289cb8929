//! Stress at any point of a part.

use std::sync::{Arc, OnceLock};

use grainpath::guide::ResultMesh;
use grainpath_core::DVec3;
use grainpath_io::fe::{Element, ElementKind, FeFormat, FeResult, StressField};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::{self, Kind};
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

/// Elements of one kind that follow each other: the kind, and the nodes of each, `(n, nodes of the kind)`.
type ElementRun<'py> = (String, Bound<'py, PyArray2<u32>>);
/// A case in parts: name, weight, nodes, stress, displacement, elements, and the nodes of each fixture and load.
type Parts<'py> = (
    String,
    f64,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<f64>>>,
    Vec<ElementRun<'py>>,
    Vec<(String, Vec<u32>)>,
);
/// As [`Parts`], from the caller.
type GivenParts<'py> = (
    String,
    f64,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
    Option<PyReadonlyArray2<'py, f64>>,
    Vec<(String, PyReadonlyArray2<'py, u32>)>,
    Vec<(String, Vec<u32>)>,
);

/// A case of the parts that [`StressData::parts`] gave.
#[pyfunction]
pub(crate) fn stress_from_parts(py: Python<'_>, parts: GivenParts<'_>) -> PyResult<StressData> {
    let (name, weight, nodes, stress, displacement, runs, sets) = parts;
    let wrong = |message: &str| errors::exception(py, Kind::Input, message, None, None);
    let points = |array: &PyReadonlyArray2<'_, f64>| -> PyResult<Vec<DVec3>> {
        Ok(array.as_slice()?.chunks_exact(3).map(DVec3::from_slice).collect())
    };
    let nodes = points(&nodes)?;
    let six = |s: &[f64]| [s[0], s[1], s[2], s[3], s[4], s[5]];
    let stress: Vec<[f64; 6]> = stress.as_slice()?.chunks_exact(6).map(six).collect();
    let displacement = displacement.as_ref().map(points).transpose()?;
    let n = nodes.len();
    if stress.len() != n || displacement.as_ref().is_some_and(|all| all.len() != n) {
        return Err(wrong("a stress should have one row for each node"));
    }
    let mut elements = Vec::new();
    for (kind, rows) in &runs {
        let kind = ElementKind::ALL.into_iter().find(|k| k.name() == kind);
        let kind = kind.ok_or_else(|| wrong("a stress has elements of an unknown kind"))?;
        for row in rows.as_slice()?.chunks(kind.n_nodes()) {
            let element = Element::new(kind, row).filter(|_| row.iter().all(|i| (*i as usize) < n));
            elements.push(element.ok_or_else(|| wrong("an element names a node that does not exist"))?);
        }
    }
    Ok(StressData::new(weight, &ResultMesh { name, nodes, elements, stress, displacement, sets }))
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

    /// All data, from which [`stress_from_parts`] makes the case again.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let mut runs = Vec::new();
        for run in self.mesh.elements.chunk_by(|a, b| a.kind == b.kind) {
            let flat = run.iter().flat_map(|e| e.nodes()).copied().collect();
            let rows = PyArray1::from_vec(py, flat).reshape([run.len(), run[0].kind.n_nodes()])?;
            runs.push((run[0].kind.name().to_owned(), rows));
        }
        let (name, sets) = (self.name.clone(), self.mesh.sets.clone());
        Ok((name, self.weight, self.nodes(py)?, self.at_nodes(py)?, self.displacement(py)?, runs, sets))
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
