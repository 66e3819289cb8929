//! The program `grainpath`; see the library of this crate.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(grainpath_cli::main_with(std::env::args_os()))
}
