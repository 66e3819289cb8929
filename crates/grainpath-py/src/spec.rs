//! Reads the settings of a job from its text and its overrides.

use std::cell::RefCell;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;

use grainpath_job::{PROFILES, Settings, json_schema, parse_job};
use pyo3::prelude::*;

use crate::errors;
use crate::worker::{self, Caller};

/// The settings of a job, read once.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct Spec {
    /// The settings.
    pub settings: Settings,
    /// The job's name in errors.
    pub name: String,
    /// The folder to which paths are relative.
    pub folder: PathBuf,
    /// The files of profiles that the job names.
    profiles: Vec<PathBuf>,
}

#[pymethods]
impl Spec {
    /// Reads a job. `sets` are of the form `section.key=value`.
    #[new]
    fn new(py: Python<'_>, text: &str, name: String, folder: PathBuf, sets: Vec<String>) -> PyResult<Self> {
        let profiles = RefCell::new(Vec::new());
        let load = |path: &str| {
            let path = folder.join(path);
            profiles.borrow_mut().push(path.clone());
            fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
        };
        match parse_job(text, &name, &sets, &load) {
            Ok(settings) => Ok(Self { settings, name, folder, profiles: profiles.into_inner() }),
            Err(error) => Err(errors::of_job(py, &error)),
        }
    }

    /// All files that decide the plan, except the job's own: inputs, what headers of scans name, and profiles. A folder
    /// stands for its files.
    fn files(&self, py: Python<'_>) -> PyResult<Vec<OsString>> {
        let (settings, folder) = (self.settings.clone(), self.folder.clone());
        // Finding what a header names means opening the scan.
        let inputs = worker::run(py, &Caller::default(), move |_, _| {
            Ok(grainpath_cli::input_files(&settings, &folder))
        })?;
        Ok(inputs.into_iter().chain(self.profiles.clone()).map(PathBuf::into_os_string).collect())
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
