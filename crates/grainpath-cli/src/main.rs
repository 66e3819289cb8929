//! The command line of grainpath: arguments, files, progress, exit codes.

mod args;
mod claims;
mod commands;
mod files;
mod inputs;
mod outputs;
mod progress;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};

/// What ends a command early: a line for the user and the exit code.
#[derive(Debug)]
pub struct Failure {
    /// What, where, and what would be right.
    pub message: String,
    /// 2 usage or job file; 3 an input file; 4 the physics; 130 interrupted.
    pub code: i32,
}

impl Failure {
    /// Wrong usage, a wrong job file, or an output that cannot be written.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: 2 }
    }

    /// An input file that cannot be used.
    pub fn input(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: 3 }
    }
}

impl From<grainpath::Error> for Failure {
    fn from(error: grainpath::Error) -> Self {
        Self { message: error.to_string(), code: error.exit_code() }
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    let json = args.command.json();
    let outcome = match args.command {
        Command::Run(a) => commands::run::run(&a),
        Command::Slice(a) => commands::slice::slice(&a),
        Command::New(a) => commands::new::new(&a),
        Command::Support(a) => commands::support::support(&a),
        Command::Specimen(a) => commands::specimen::specimen(&a),
        Command::Inspect(a) => commands::inspect::inspect(&a),
        Command::Strength(a) => commands::strength::strength(&a),
        Command::Compare(a) => commands::compare::compare(&a),
        Command::Render(a) => commands::render::render(&a),
        Command::Markers(a) => commands::markers::markers(&a),
        Command::Schema(a) => commands::schema::schema(&a),
        Command::Profiles(a) => commands::profiles::profiles(&a),
    };
    let outcome = outcome.and_then(|()| files::lost_output().map_or(Ok(()), Err));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let line = failure.message.replace('\n', " ");
            if json {
                let report = serde_json::json!({ "ok": false, "error": line, "code": failure.code });
                files::print(&format!("{report}\n"));
            }
            eprintln!("grainpath: {line}");
            ExitCode::from(u8::try_from(failure.code).unwrap_or(1))
        }
    }
}
