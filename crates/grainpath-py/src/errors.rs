//! Turns errors of grainpath into the exceptions of `grainpath.errors`.

use std::any::Any;

use grainpath_cli::{ExitCode, Failure};
use grainpath_job::JobError;
use pyo3::prelude::*;

/// What messages call a shape, a picture or stress that does not come from a file.
pub(crate) const ARRAY: &str = "an array";
/// What messages call directions that do not come from a file.
pub(crate) const FIELD: &str = "the field";
/// What messages call a mesh whose supports are grown.
pub(crate) const MESH: &str = "the mesh";
/// What messages call a program that does not come from a file; `grainpath.gcode.Program` has the same word.
const PROGRAM: &str = "program";

/// Exceptions of `grainpath.errors`.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Job,
    Input,
    Physics,
    Cancelled,
    Internal,
}

impl Kind {
    const fn class(self) -> &'static str {
        match self {
            Self::Job => "JobError",
            Self::Input => "InputError",
            Self::Physics => "PhysicsError",
            Self::Cancelled => "Cancelled",
            Self::Internal => "InternalError",
        }
    }
}

/// An exception with its message, and with the file and line of the error where they are known.
pub(crate) fn exception(
    py: Python<'_>,
    kind: Kind,
    message: &str,
    file: Option<&str>,
    line: Option<usize>,
) -> PyErr {
    let class = py.import("grainpath.errors").and_then(|errors| errors.getattr(kind.class()));
    match class.and_then(|class| class.call1((message, file, line))) {
        Ok(made) => PyErr::from_value(made),
        Err(error) => error,
    }
}

/// What messages call an input that the caller passed in memory. It is no file.
const IN_MEMORY: [&str; 4] = [ARRAY, FIELD, MESH, PROGRAM];

/// The exception for a failure of reading, planning or writing.
pub(crate) fn of_failure(py: Python<'_>, failure: &Failure) -> PyErr {
    // Exit codes and exceptions both say who has to act, so each exit code has its exception.
    let kind = match failure.code {
        ExitCode::Usage => Kind::Job,
        ExitCode::Input => Kind::Input,
        ExitCode::Physics => Kind::Physics,
        ExitCode::Interrupted => Kind::Cancelled,
        ExitCode::Fault => Kind::Internal,
    };
    let file = failure.file.as_deref().filter(|file| !IN_MEMORY.contains(file));
    exception(py, kind, &failure.message, file, failure.line().filter(|_| file.is_some()))
}

/// The exception for an error in a job, with its file and line.
pub(crate) fn of_job(py: Python<'_>, error: &JobError) -> PyErr {
    let place = error.location();
    let file = place.map(|p| p.file.as_str());
    exception(py, Kind::Job, &error.to_string(), file, place.and_then(|p| p.line))
}

/// The exception for a panic, which is an error in grainpath itself.
pub(crate) fn of_panic(py: Python<'_>, payload: &(dyn Any + Send)) -> PyErr {
    let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
    let message = format!("grainpath failed: {text}; this is an error of grainpath, please report it");
    exception(py, Kind::Internal, &message, None, None)
}
