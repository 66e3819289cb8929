//! Virtual strength tests, and the comparison of several tests.

use std::path::PathBuf;
use std::sync::Arc;

use grainpath_cli::{Done, TestedJob};
use pyo3::prelude::*;
use serde_json::json;

use crate::plan::{Handover, Watch, Work};
use crate::spec::Spec;
use crate::worker;

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

/// Tests the plan of a job. If `program` is given (bytes and name), tests this program of the job's part instead.
#[pyfunction]
pub(crate) fn strength<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    handover: Handover<'py>,
    program: Option<(Vec<u8>, String)>,
    watch: Watch<'py>,
) -> PyResult<StrengthData> {
    let (mut work, caller) = Work::new(spec, handover, watch)?;
    let done = worker::run(py, &caller, move |diagnostics, requests| {
        let given = work.given(requests)?;
        let Work { settings, folder, name, .. } = work;
        let input = program.as_ref().map_or_else(|| PathBuf::from(&name), |p| PathBuf::from(&p.1));
        let tested = TestedJob { settings, folder, name, given, keep_model: false };
        tested.test(&input, program.as_ref().map(|p| &p.0[..]), diagnostics, &|_| {})
    })?;
    Ok(StrengthData { done: Arc::new(done) })
}

/// Compares several tests. Returns the JSON that `grainpath compare --json` prints.
#[pyfunction]
pub(crate) fn compare(all: Vec<Bound<'_, StrengthData>>) -> String {
    let all: Vec<&Done> = all.iter().map(|s| &*s.get().done).collect();
    json!(grainpath_cli::compared(&all)).to_string()
}
