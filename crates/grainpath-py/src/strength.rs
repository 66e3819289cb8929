//! Virtual tests, and several of them side by side.

use std::path::PathBuf;
use std::sync::Arc;

use grainpath_cli::{Done, Given, TestedJob};
use grainpath_io::fe::StressField;
use pyo3::prelude::*;
use serde_json::json;

use crate::mesh::MeshData;
use crate::plan::{Array, PointStress, Shape, field, halves, stress_result};
use crate::spec::Spec;
use crate::worker::{self, Caller};

/// A finished test.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct StrengthData {
    done: Arc<Done>,
}

#[pymethods]
impl StrengthData {
    /// The result as `grainpath strength --json` has it.
    fn report(&self) -> String {
        let d = &self.done;
        json!({
            "layers": d.program.layers.len(), "mass_g": d.tested.report.mass_g, "time_s": d.program.time_s,
            "strength": d.tested.report, "warnings": d.warnings,
        })
        .to_string()
    }
}

/// Tests the plan of a job, or `program`, a program of its part, with its name.
#[pyfunction]
#[pyo3(signature = (spec, mesh, array, directions, stress, program, watch))]
pub fn strength<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    mesh: Option<Bound<'py, MeshData>>,
    array: Option<Array<'py>>,
    directions: Option<Vec<u8>>,
    stress: Option<PointStress<'py>>,
    program: Option<(Vec<u8>, String)>,
    watch: (Option<usize>, Option<Bound<'py, PyAny>>, Option<Bound<'py, PyAny>>),
) -> PyResult<StrengthData> {
    let spec = spec.get();
    let (settings, job, folder) = (spec.settings.clone(), spec.name.clone(), spec.folder.clone());
    let mesh = mesh.map(|m| m.get().file.clone());
    let (array, slices) = halves(array);
    let (threads, progress, cancel) = watch;
    let caller = Caller { progress, cancel, array: slices, threads };
    let stress = stress_result(stress)?;
    let done = worker::run(py, &caller, move |diagnostics, requests| {
        let given = Given {
            shape: Shape { mesh, array }.handed(requests),
            directions: field(directions.as_deref(), &settings)?,
            stress: stress.map(StressField::new),
        };
        let input = program.as_ref().map_or_else(|| PathBuf::from(&job), |p| PathBuf::from(&p.1));
        let tested = TestedJob { settings, folder, name: job, given };
        tested.test(&input, program.as_ref().map(|p| &p.0[..]), diagnostics, &|_| {})
    })?;
    Ok(StrengthData { done: Arc::new(done) })
}

/// Several tests side by side, as `grainpath compare --json` has them.
#[pyfunction]
pub fn compare(all: Vec<Bound<'_, StrengthData>>) -> String {
    let all: Vec<&Done> = all.iter().map(|s| &*s.get().done).collect();
    json!(grainpath_cli::compared(&all)).to_string()
}
