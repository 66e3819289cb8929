//! `grainpath completions` and `grainpath man`: both are generated from the argument definitions, so they stay up to date.

use std::fs;

use clap::builder::PossibleValuesParser;
use clap::{Command, CommandFactory};
use clap_complete::generate;
use clap_mangen::Man as Page;
use grainpath_job::{PROFILES, profiles_of};
use grainpath_parts::presets::PRESETS;
use grainpath_parts::specimen::SPECIMENS;
use grainpath_parts::test_pieces::TEST_PIECES;

use crate::args::{Args, Completions, Man};
use crate::{Failure, files};

/// `grainpath completions`
pub(crate) fn completions(args: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut with_names(Args::command()), "grainpath", &mut script);
    files::print(&String::from_utf8_lossy(&script));
    Ok(())
}

/// The commands with the names of presets, profiles and specimens, which a shell then completes. Commands themselves take
/// the names as text, because their errors name the nearest one.
fn with_names(program: Command) -> Command {
    let names = |kind: &str| profiles_of(kind).map(|p| p.name).collect::<Vec<_>>();
    let named = |command: Command, argument: &'static str, all: Vec<&'static str>| {
        command.mut_arg(argument, |a| a.value_parser(PossibleValuesParser::new(all)))
    };
    let specimens = SPECIMENS.iter().map(|s| s.name).chain(TEST_PIECES.iter().map(|p| p.name)).collect();
    program
        .mut_subcommand("new", |new| {
            let new = named(new, "preset", PRESETS.to_vec());
            named(named(new, "printer", names("printer")), "material", names("material"))
        })
        .mut_subcommand("specimen", |c| named(c, "name", specimens))
        .mut_subcommand("profiles", |c| named(c, "name", PROFILES.iter().map(|p| p.name).collect()))
}

/// `grainpath man`
pub(crate) fn man(args: &Man) -> Result<(), Failure> {
    let mut program = Args::command();
    // clap fills in the full names of commands and their options only in `build`.
    program.build();
    let mut pages = vec![("grainpath.1".to_owned(), program.clone())];
    for command in program.get_subcommands() {
        let name = format!("grainpath-{}", command.get_name());
        pages.push((format!("{name}.1"), command.clone().display_name(name)));
    }
    fs::create_dir_all(&args.dir)
        .map_err(|e| Failure::usage(format!("{}: cannot be made a folder: {e}", args.dir.display())))?;
    let paths: Vec<_> = pages.iter().map(|(name, _)| args.dir.join(name)).collect();
    if let Some(there) = paths.iter().find(|p| p.exists())
        && !args.force
    {
        return Err(Failure::usage(format!("{} is there already; --force writes over it", there.display())));
    }
    for ((_, command), path) in pages.iter().zip(&paths) {
        let mut page = Vec::new();
        Page::new(command.clone()).render(&mut page).map_err(|e| Failure::usage(e.to_string()))?;
        let page = with_usual_headings(&String::from_utf8_lossy(&page));
        files::write_atomically(path, |out| {
            out.write_all(page.as_bytes()).map_err(|e| Failure::usage(e.to_string()))
        })?;
    }
    files::print(&format!("{} pages in {}\n", pages.len(), args.dir.display()));
    Ok(())
}

/// A manual page with an empty date, which keeps its bytes the same on every day, and with the examples under their usual
/// heading. clap_mangen writes an empty date as no date, so that the version takes its place.
fn with_usual_headings(page: &str) -> String {
    // The heading says what the line below it says.
    let page = page.replace("\n.SH EXTRA\n", "\n.SH EXAMPLES\n").replace("\nExamples:\n", "\n");
    let titled = |line: &str| match line.strip_prefix(".TH ").and_then(|rest| rest.split(' ').next()) {
        Some(title) => format!(".TH {title} 1 \"\" \"grainpath {}\" \"\"\n", env!("CARGO_PKG_VERSION")),
        None => format!("{line}\n"),
    };
    // Every line ends with a newline, the last one too, as groff wants it.
    page.lines().map(titled).collect()
}
