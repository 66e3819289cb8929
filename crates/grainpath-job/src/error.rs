//! Errors of job files.

use std::fmt;

use grainpath_core::spelling::question;

use crate::combination_error::Combination;
use crate::profiles::profiles_of;
use crate::settings::Settings;
use crate::value::ValueError;

/// A place in a file, or the command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// Name of the file; `--set` for an argument.
    pub file: String,
    /// Line in the file, from 1. `None` for an argument of the command line, or if a problem concerns the whole
    /// file.
    pub line: Option<usize>,
}

impl Location {
    /// The whole of a file.
    pub fn file(name: &str) -> Self {
        Self { file: name.to_owned(), line: None }
    }

    /// An argument of `--set`.
    pub fn set() -> Self {
        Self::file("--set")
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file),
            None => f.write_str(&self.file),
        }
    }
}

/// An error in a job. Its text says where the error is, what is wrong, and what would be correct.
///
/// ```
/// use grainpath_job::{JobError, parse_job};
///
/// let job = "[process]\nwalls = \"two\"\n";
/// let error = parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap_err();
/// assert!(matches!(&error, JobError::Value { location, .. } if location.line == Some(2)));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum JobError {
    #[error("{location}: {message}")]
    Syntax { location: Location, message: String },
    #[error(
        "{location}: unknown section [{section}]{}",
        near.map_or_else(|| format!("; the sections are {}", Settings::SECTIONS.join(", ")), |near| format!("; did you mean [{near}]?"))
    )]
    UnknownSection { location: Location, section: String, near: Option<&'static str> },
    #[error(
        "{location}: unknown key `{key}` in [{section}]{}",
        near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
    )]
    UnknownKey { location: Location, section: String, key: String, near: Option<&'static str> },
    #[error("{location}: {name} should be a section: [{name}]")]
    NotASection { location: Location, name: String },
    #[error("{location}: {key}{error}")]
    Value { location: Location, key: String, error: Box<ValueError> },
    #[error("{location}: {new} has the new name of {old}; remove {old}")]
    BothNames { location: Location, old: String, new: String },
    #[error(
        "{location}: format = {found} is newer than this version of grainpath, which reads up to format {}; install a newer version",
        crate::FORMAT
    )]
    NewerFormat { location: Location, found: i64 },
    #[error(
        "{location}: no {kind} profile {name:?}{} There are {}; a path ending in .toml works too",
        question(name, profiles_of(kind).map(|p| p.name)),
        profile_names(kind)
    )]
    UnknownProfile { location: Location, kind: &'static str, name: String },
    #[error("{location}: {message}")]
    ProfileFile { location: Location, message: String },
    #[error("--set: {argument:?} should be section.key=value")]
    SetArgument { argument: String },
    /// Settings that are each valid but do not fit together.
    #[error("{location}: {problem}")]
    Combination { location: Location, problem: Box<Combination> },
}

impl JobError {
    /// The place of the error; `None` for a malformed `--set` argument.
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::Syntax { location, .. }
            | Self::UnknownSection { location, .. }
            | Self::UnknownKey { location, .. }
            | Self::NotASection { location, .. }
            | Self::Value { location, .. }
            | Self::BothNames { location, .. }
            | Self::NewerFormat { location, .. }
            | Self::UnknownProfile { location, .. }
            | Self::ProfileFile { location, .. }
            | Self::Combination { location, .. } => Some(location),
            Self::SetArgument { .. } => None,
        }
    }
}

/// Names of all shipped profiles of a kind, for the message.
fn profile_names(kind: &str) -> String {
    // Only profiles of the same section are listed; printer names do not help a user who needs a material.
    profiles_of(kind).map(|p| p.name).collect::<Vec<_>>().join(", ")
}
