//! The command line, for the console script of the package.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs a command; `args` begins with the program's name. Returns the exit code. Ctrl-C and wrong usage end the
/// process, as in the program `grainpath`.
#[pyfunction]
pub(crate) fn cli(py: Python<'_>, args: Vec<OsString>) -> u8 {
    py.detach(|| grainpath_cli::main_with(args))
}

/// The commands, each with the names of its arguments. A test checks that `docs/python.md` has a row for each.
#[pyfunction]
pub(crate) fn cli_commands() -> Vec<(String, Vec<String>)> {
    let command = grainpath_cli::command();
    let options = |c: &clap::Command| {
        let shown = c
            .get_arguments()
            .map(|a| a.get_long().map_or_else(|| a.get_id().to_string(), |l| format!("--{l}")));
        (c.get_name().to_owned(), shown.collect())
    };
    command.get_subcommands().map(options).collect()
}
