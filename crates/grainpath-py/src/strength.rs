//! Virtual strength tests, and the comparison of several tests.

use std::path::PathBuf;

use grainpath_cli::{Failure, TestedJob};
use pyo3::prelude::*;

use crate::errors;
use crate::plan::{Handover, Watch, Work};
use crate::spec::Spec;
use crate::worker;

/// Tests the plan of a job and gives the result as JSON. If `program` is given (bytes and name), tests this program of the job's part instead.
#[pyfunction]
pub(crate) fn strength<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    handover: Handover<'py>,
    program: Option<(Vec<u8>, String)>,
    watch: Watch<'py>,
) -> PyResult<String> {
    let (mut work, caller) = Work::new(spec, handover, watch)?;
    worker::run(py, &caller, move |diagnostics, requests| {
        let given = work.given(requests)?;
        let Work { settings, folder, name, .. } = work;
        let input = program.as_ref().map_or_else(|| PathBuf::from(&name), |p| PathBuf::from(&p.1));
        let tested = TestedJob { settings, folder, name, given, keep_model: false };
        let done = tested.test(&input, program.as_ref().map(|p| &p.0[..]), diagnostics, &|_| {})?;
        Ok(grainpath_cli::tested_json(&done).to_string())
    })
}

/// Compares several tests, each as [`strength`] gave it. Returns the JSON that `grainpath compare --json` prints.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, all: Vec<String>) -> PyResult<String> {
    let wrong = |e: serde_json::Error| Failure::input(format!("a test: {e}"));
    let compared = || {
        let all = all.iter().map(|text| serde_json::from_str(text)).collect::<Result<Vec<_>, _>>();
        grainpath_cli::compared(&all.map_err(wrong)?)
    };
    compared().map(|rows| serde_json::json!(rows).to_string()).map_err(|f| errors::of_failure(py, &f))
}
