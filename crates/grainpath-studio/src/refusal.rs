//! Errors of the studio, in the words of the command line.

/// The cause of a refusal. The program that serves the studio gives each its exit code ([`crate::Engine::exit_code`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefusalKind {
    /// Wrong usage or a wrong job.
    Usage,
    /// An input file that cannot be used.
    Input,
    /// A job that cannot be fulfilled.
    Physics,
    /// The run was stopped.
    Interrupted,
    /// A fault of grainpath.
    Fault,
}

/// Why a run failed, in the words of the command line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct Refusal {
    /// One line that says what is wrong, where, and what would be right.
    pub message: String,
    /// The cause.
    pub kind: RefusalKind,
}

impl Refusal {
    /// Wrong usage, or a file that may not be read or written.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), kind: RefusalKind::Usage }
    }

    /// An input file that cannot be used.
    pub fn input(message: impl Into<String>) -> Self {
        Self { message: message.into(), kind: RefusalKind::Input }
    }
}

/// An error message of the operating system without its error number.
pub(crate) fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
