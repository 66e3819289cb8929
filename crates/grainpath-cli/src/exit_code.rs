//! The exit codes of the program. Each number is written here alone.

use grainpath::ErrorKind;

/// The code with which a command ends after a failure. It says who has to act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExitCode {
    /// A fault of grainpath.
    Fault = 1,
    /// Wrong usage, a wrong job file, or an output that cannot be written.
    Usage = 2,
    /// An input file that cannot be used.
    Input = 3,
    /// A job that cannot be fulfilled, or warnings under `--strict`.
    Physics = 4,
    /// The run was interrupted. Source: shells add 128 to the number of the signal, and SIGINT is 2.
    Interrupted = 130,
}

impl ExitCode {
    /// The number that the system gets.
    pub const fn number(self) -> u8 {
        self as u8
    }
}

impl From<ErrorKind> for ExitCode {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::Job => Self::Usage,
            ErrorKind::Input => Self::Input,
            ErrorKind::Physics => Self::Physics,
            ErrorKind::Interrupted => Self::Interrupted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ExitCode;

    /// A fault is a mistake of ours, so the page does not list its code.
    #[test]
    fn the_page_of_commands_lists_the_exit_codes() {
        let page = include_str!("../../../docs/commands.md");
        let listed =
            page.split_once("Exit codes: ").and_then(|(_, rest)| rest.split_once(". ")).expect("a list").0;
        let listed: Vec<&str> = listed.split("; ").filter_map(|entry| entry.split(' ').next()).collect();
        let codes = [ExitCode::Usage, ExitCode::Input, ExitCode::Physics, ExitCode::Interrupted];
        let wanted: Vec<String> =
            [0].into_iter().chain(codes.map(ExitCode::number)).map(|n| n.to_string()).collect();
        assert_eq!(listed, wanted);
    }
}
