//! Errors of the studio, in the words of the command line.

/// Why a run failed, in the words of the command line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct Refusal {
    /// One line that says what is wrong, where, and what would be right.
    pub message: String,
    /// Exit code of the command line: 2 usage or job, 3 an input file, 4 the physics, 130 interrupted.
    pub code: i32,
}

impl Refusal {
    /// Wrong usage, or a file that may not be read or written.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: 2 }
    }

    /// An input file that cannot be used.
    pub fn input(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: 3 }
    }
}

/// An error message of the operating system without its error number.
pub(crate) fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
