//! `grainpath completions` and `grainpath man`: both are generated from the argument definitions, so they stay up to date.

use std::fs;

use clap::CommandFactory;
use clap_complete::generate;
use clap_mangen::Man as Page;

use crate::args::{Args, Completions, Man};
use crate::{Failure, files};

/// `grainpath completions`
pub(crate) fn completions(args: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut Args::command(), "grainpath", &mut script);
    files::print(&String::from_utf8_lossy(&script));
    Ok(())
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
        files::write_atomically(path, |out| out.write_all(&page).map_err(|e| Failure::usage(e.to_string())))?;
    }
    files::print(&format!("{} pages in {}\n", pages.len(), args.dir.display()));
    Ok(())
}
