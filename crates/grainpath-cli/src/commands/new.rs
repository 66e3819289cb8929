//! `grainpath new`: a commented job and its input.

use std::path::PathBuf;

use crate::args::New;
use crate::{Failure, files};

/// `grainpath new`
pub(crate) fn new(args: &New) -> Result<(), Failure> {
    let names = grainpath_parts::presets::PRESETS;
    let example = match (args.preset.as_str(), args.pixels) {
        ("ct", Some(n)) => Some(grainpath_parts::presets::ct(n as usize)),
        (_, Some(_)) => return Err(Failure::usage("--pixels is for the preset ct")),
        (name, None) => grainpath_parts::presets::preset(name),
    };
    let Some(example) = example else {
        let near = grainpath_core::spelling::nearest(&args.preset, names);
        return Err(Failure::usage(format!(
            "no preset {:?}; did you mean {near:?}? There are {}",
            args.preset,
            names.join(", ")
        )));
    };
    let folder = args.dir.clone().unwrap_or_else(|| PathBuf::from(&args.preset));
    // All names are checked before the first is written, so that a refusal leaves the folder as it was.
    if let Some((name, _)) = example.iter().find(|(name, _)| folder.join(&**name).exists() && !args.force) {
        let there = folder.join(&**name);
        return Err(Failure::usage(format!("{} is there already; --force writes over it", there.display())));
    }
    for (name, content) in &example {
        let path = folder.join(&**name);
        files::write_atomically(&path, |w| {
            w.write_all(content).map_err(|e| Failure::usage(format!("cannot write {}: {e}", path.display())))
        })?;
    }
    // The next command to type.
    files::print(&format!("grainpath run {}\n", folder.join(&*example[0].0).display()));
    Ok(())
}
