//! The command line of grainpath: arguments, files, progress, exit codes.
//!
//! [`main_with`] is the program. The functions that read inputs, plan and write outputs are public too, so that the
//! Python module uses the same code.

mod args;
mod cad;
mod claims;
mod commands;
mod exit_code;
mod files;
mod inputs;
mod interrupt;
mod memory;
mod outputs;
mod progress;
mod saved_report;

use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::Path;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use grainpath_core::Warning;

use args::{Args, Command};

pub use commands::compare::{compared, tested_json};
pub use commands::inspect::inspect_file;
pub use commands::inspect_faces::list_faces;
pub use commands::orient::poses_json;
pub use commands::render::{angles_to_guide, tell_directions};
pub use commands::run::checked;
pub use commands::strength::{Done, TestedJob};
pub use commands::support::{Grown, grow};
pub use exit_code::ExitCode;
pub use inputs::{Given, Handed, input_files, no_shape, plan_given, plan_parted, read_body, shape_of};
pub use memory::peak_rss_mb;
pub use outputs::{program_bytes, read_back, report_of};

/// The reason why a command ends early: a line for the user and the exit code.
#[derive(Debug)]
pub struct Failure {
    /// The message: the place of the mistake, the mistake, and the correct form.
    pub message: String,
    /// The exit code.
    pub code: ExitCode,
    /// Warnings that count as a failure under `--strict`.
    pub warnings: Vec<Warning>,
    /// The page of the documentation about this error.
    pub page: Option<&'static str>,
    /// The file that the message is about.
    pub file: Option<String>,
}

impl Failure {
    /// Wrong usage, a wrong job file, or an output that cannot be written.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: ExitCode::Usage, warnings: Vec::new(), page: None, file: None }
    }

    /// Warnings under `--strict`; `written` says whether the outputs exist.
    pub fn strict(warnings: Vec<Warning>, written: bool) -> Self {
        let ids: Vec<&str> = warnings.iter().map(|w| w.id.name()).collect();
        let outcome = if written { "the outputs were written" } else { "nothing was written" };
        let message = format!("--strict refuses {} warnings ({}); {outcome}", ids.len(), ids.join(", "));
        Self { message, code: ExitCode::Physics, warnings, page: None, file: None }
    }

    /// An input file that cannot be used, and why. The message begins with the file.
    pub fn of_file(file: &Path, why: impl std::fmt::Display) -> Self {
        let file = file.display().to_string();
        Self { file: Some(file.clone()), ..Self::input(format!("{file}: {why}")) }
    }

    /// The line of [`Self::file`] that the message names, from 1. Readers name the place of an error right after the file,
    /// and a place in a text is `line` with its number. Readers of several files name the file once more.
    pub fn line(&self) -> Option<usize> {
        let file = self.file.as_deref()?;
        let mut rest = self.message.strip_prefix(file)?.get(2..)?;
        while let Some(next) = rest.strip_prefix(file) {
            rest = next.get(2..)?;
        }
        rest.strip_prefix("line ")?.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    }

    /// The failure with the page of the documentation about it.
    #[must_use]
    pub(crate) fn see(self, page: &'static str) -> Self {
        Self { page: Some(page), ..self }
    }

    /// Input that cannot be used.
    pub fn input(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: ExitCode::Input, warnings: Vec::new(), page: None, file: None }
    }
}

impl From<grainpath::Error> for Failure {
    fn from(error: grainpath::Error) -> Self {
        let code = ExitCode::from(error.kind());
        let file = error.file().map(ToOwned::to_owned);
        Self { message: error.to_string(), code, warnings: Vec::new(), page: error.page(), file }
    }
}

/// The definition of all commands and their options for clap.
pub fn command() -> clap::Command {
    Args::command()
}

/// Runs the command in `args`, whose first entry is the name of the program. Returns the exit code.
pub fn main_with(args: impl IntoIterator<Item = OsString>) -> u8 {
    #[cfg(feature = "sweep")]
    if let Ok(constant) = std::env::var("GRAINPATH_SWEEP") {
        grainpath_core::tuned::sweep(&constant);
    }
    let args = with_help_command(args.into_iter().collect());
    let args = match Args::try_parse_from(&args) {
        Ok(args) => args,
        Err(error) => return not_parsed(&error, &args),
    };
    // Read before the arguments move into the command: a failure must be printed as JSON too.
    let json = args.command.json();
    interrupt::set_json(json);
    if !args.command.serves() {
        interrupt::watch();
    }
    let outcome = match args.command {
        Command::Run(a) => commands::run::run(&a),
        Command::Slice(a) => commands::slice::slice(&a),
        Command::New(a) => commands::new::new(&a),
        Command::Support(a) => commands::support::support(&a),
        Command::Specimen(a) => commands::specimen::specimen(&a),
        Command::Inspect(a) => commands::inspect::inspect(&a),
        Command::Strength(a) => commands::strength::strength(&a),
        Command::Compare(a) => commands::compare::compare(&a),
        Command::Orient(a) => commands::orient::orient(&a),
        Command::Render(a) => commands::render::render(&a),
        Command::Markers(a) => commands::markers::markers(&a),
        Command::Schema(a) => commands::schema::schema(&a),
        Command::Profiles(a) => commands::profiles::profiles(&a),
        Command::Doctor(a) => commands::doctor::doctor(&a),
        Command::Licences(a) => commands::licences::licences(&a),
        Command::Completions(a) => commands::completions::completions(&a),
        Command::Man(a) => commands::completions::man(&a),
        #[cfg(feature = "studio")]
        Command::Studio(a) => commands::studio::studio(&a),
    };
    end(outcome, json)
}

/// The word that asks for help where a command is expected.
const HELP: &str = "help";
/// The option that asks for JSON.
const JSON: &str = "--json";

/// `grainpath help COMMAND` as `grainpath COMMAND --help`.
fn with_help_command(mut args: Vec<OsString>) -> Vec<OsString> {
    if args.get(1).is_some_and(|first| first == HELP) {
        // Words behind the command would be taken for its own arguments.
        args.remove(1);
        args.truncate(2);
        args.push("--help".into());
    }
    args
}

/// Ends a command whose arguments ask for help or the version, or are wrong. Returns the exit code.
fn not_parsed(error: &clap::Error, args: &[OsString]) -> u8 {
    let text = error.render();
    let shown = |styled: bool| if styled { text.ansi().to_string() } else { text.to_string() };
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            files::print(&shown(std::io::stdout().is_terminal() && wants_colours()));
            end(Ok(()), false)
        }
        // Without any arguments the help is the answer, and an error nevertheless.
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            eprint!("{}", shown(std::io::stderr().is_terminal() && wants_colours()));
            ExitCode::Usage.number()
        }
        _ => {
            // The arguments were not understood, so whether JSON is wanted is read from the words themselves.
            let json = args.iter().any(|arg| arg == JSON);
            let named =
                |arg: &&OsString| arg.to_str().is_some_and(|arg| command().find_subcommand(arg).is_some());
            let command =
                args.get(1).filter(named).map(|name| format!(" {}", name.display())).unwrap_or_default();
            let mut what = one_line(&text.to_string());
            if error.kind() == ErrorKind::InvalidSubcommand
                && let Some(file) = args.get(1).map(Path::new).filter(|path| path.exists())
            {
                what = format!("{}: a file needs a command before it; {}", file.display(), takers(file));
            }
            end(
                Err(Failure::usage(format!("{what} (`grainpath{command} --help` shows what is right)"))),
                json,
            )
        }
    }
}

/// Whether a terminal may show colours. Source: no-color.org: any text in `NO_COLOR` but the empty one turns them off.
fn wants_colours() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|set| set.is_empty())
}

/// The commands that take a file, for someone who named the file alone.
fn takers(file: &Path) -> String {
    let name = file.display();
    match commands::slice::no_shape(file) {
        // A job and a program have commands of their own, which the answer of `slice` names.
        Some(what) => format!("it is {what}"),
        None => format!("`grainpath slice {name}` plans a part, `grainpath inspect {name}` describes it"),
    }
}

/// The message of an error of clap without the usage, and without the pointer to the help that ends it.
fn one_line(text: &str) -> String {
    let is_last = |line: &&str| line.starts_with("Usage:") || line.starts_with("For more information");
    // An option of another slicer is tried more often than a file is named whose name begins with a dash.
    let misleads = |line: &&str| line.starts_with("tip: to pass '--");
    let lines = text.lines().map(str::trim).take_while(|line| !is_last(line));
    let lines = lines.filter(|line| !line.is_empty() && !misleads(line));
    let mut all = String::new();
    for line in lines {
        let line = line.strip_prefix("error: ").or_else(|| line.strip_prefix("tip: ")).unwrap_or(line);
        let link = if all.is_empty() {
            ""
        } else if all.ends_with(':') || line.starts_with('[') {
            " "
        } else {
            "; "
        };
        all.push_str(link);
        all.push_str(line);
    }
    all
}

/// A page of the documentation: its path where a package installed it with the program, else its name in the sources.
fn installed(page: &str) -> String {
    // `usr/bin/grainpath` has its pages in `usr/share/doc/grainpath/docs`.
    let program = std::env::current_exe().ok();
    let prefix = program.as_deref().and_then(Path::parent).and_then(Path::parent);
    // Where /proc is not mounted, as in a bare root, a program does not know its own path.
    let prefix = prefix.unwrap_or(Path::new("/usr"));
    let path = prefix.join("share/doc/grainpath").join(page);
    if path.is_file() { path.display().to_string() } else { page.to_owned() }
}

/// Prints the failure of a command. Returns the exit code.
fn end(outcome: Result<(), Failure>, json: bool) -> u8 {
    // If standard output is redirected to a full disk, the error is found here: a command whose result
    // was not printed has failed.
    let outcome = outcome.and_then(|()| files::lost_output().map_or(Ok(()), Err));
    match outcome {
        Ok(()) => 0,
        Err(failure) if failure.code == ExitCode::Interrupted => interrupt::end(),
        Err(failure) => {
            // The message is one line, so that a script can read it as the last line of standard error.
            let line = failure.message.replace('\n', " ");
            if json {
                let mut report =
                    serde_json::json!({ "ok": false, "error": line, "code": failure.code.number() });
                if !failure.warnings.is_empty() {
                    report["warnings"] = serde_json::json!(failure.warnings);
                }
                if let Some(page) = failure.page {
                    report["page"] = page.into();
                }
                files::print(&format!("{report}\n"));
            }
            failure.warnings.iter().for_each(|w| eprintln!("warning: {w}"));
            let page = failure.page.map(|page| format!(" (see {})", installed(page))).unwrap_or_default();
            eprintln!("grainpath: {line}{page}");
            failure.code.number()
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn errors_of_arguments_are_one_line_that_keeps_what_helps() {
        for (text, line) in [
            (
                "error: unexpected argument '--jsn' found\n\n  tip: a similar argument exists: '--json'\n\nUsage: grainpath run --json <JOB>\n\nFor more information, try '--help'.\n",
                "unexpected argument '--jsn' found; a similar argument exists: '--json'",
            ),
            (
                "error: the following required arguments were not provided:\n  <MODEL>\n  --size <PX>\n\nUsage: grainpath slice <MODEL>\n",
                "the following required arguments were not provided: <MODEL>; --size <PX>",
            ),
            (
                "error: invalid value 'mauve' for '--color <BY>'\n  [possible values: role, width]\n\nFor more information, try '--help'.\n",
                "invalid value 'mauve' for '--color <BY>' [possible values: role, width]",
            ),
        ] {
            assert_eq!(super::one_line(text), line);
        }
    }

    /// The table of docs/python.md says how each command and option is called from Python.
    #[test]
    fn every_command_and_option_is_on_the_page_of_python() {
        let page = include_str!("../../../docs/python.md");
        let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
        let command = super::command();
        let commands: Vec<_> = command.get_subcommands().filter(|c| c.get_name() != "help").collect();
        for command in &commands {
            let start = format!("| `{}` | ", command.get_name());
            let row = rows.iter().find(|row| row.starts_with(&start));
            let row = row.unwrap_or_else(|| panic!("no row of `{}`", command.get_name()));
            let options = row.split(" | ").nth(1).unwrap_or_default();
            for argument in command.get_arguments() {
                let id = argument.get_id().to_string();
                let shown = argument.get_long().map_or(id, |long| format!("--{long}"));
                let is_everywhere = ["--help", "--version"].contains(&&*shown);
                assert!(is_everywhere || options.contains(&format!("`{shown}`")), "{start} lacks {shown}");
            }
        }
        assert_eq!(rows.len(), commands.len(), "the page has a row of a command that does not exist");
    }
}
