//! Reads the settings of a job from its text and its overrides.

use std::fs;
use std::path::PathBuf;

use grainpath_job::{PROFILES, Settings, json_schema, parse_job};
use pyo3::prelude::*;

use crate::errors;

/// The settings of a job, read once.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct Spec {
    /// The settings.
    pub settings: Settings,
    /// The job's name in errors.
    pub name: String,
    /// The folder to which paths are relative.
    pub folder: PathBuf,
}

#[pymethods]
impl Spec {
    /// Reads a job. `sets` are of the form `section.key=value`.
    #[new]
    fn new(py: Python<'_>, text: &str, name: String, folder: PathBuf, sets: Vec<String>) -> PyResult<Self> {
        let load = |path: &str| {
            let path = folder.join(path);
            fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
        };
        match parse_job(text, &name, &sets, &load) {
            Ok(settings) => Ok(Self { settings, name, folder }),
            Err(error) => Err(errors::of_job(py, &error)),
        }
    }

    /// All settings in use and their values as text.
    fn rows(&self) -> Vec<(String, String)> {
        self.settings.rows().into_iter().map(|r| (r.key, r.value)).collect()
    }

    /// Warnings about values that were assumed, as JSON.
    fn warnings(&self) -> String {
        serde_json::json!(self.settings.warnings).to_string()
    }
}

/// The JSON Schema of job files.
#[pyfunction]
pub(crate) fn schema() -> String {
    json_schema().to_string()
}

/// The profiles that come with grainpath: kind, name and text.
#[pyfunction]
pub(crate) fn profiles() -> Vec<(&'static str, &'static str, &'static str)> {
    PROFILES.iter().map(|p| (p.kind, p.name, p.text)).collect()
}
