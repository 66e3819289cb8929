//! `grainpath profiles`: printers, materials and processes that come with grainpath.

use grainpath_core::spelling::question;
use grainpath_job::PROFILES;

use crate::args::Profiles;
use crate::{Failure, files};

/// `grainpath profiles`
pub(crate) fn profiles(args: &Profiles) -> Result<(), Failure> {
    if let Some(name) = &args.name {
        let Some(p) = PROFILES.iter().find(|p| p.name == name) else {
            let near = question(name, PROFILES.iter().map(|p| p.name));
            return Err(Failure::usage(format!("no profile {name:?}{near} `grainpath profiles` lists all")));
        };
        let json = serde_json::json!({ "kind": p.kind, "name": p.name, "toml": p.text });
        // The text of the profile is printed unchanged with its comments, so that users can copy it to a file of
        // their own.
        files::print(&if args.json { format!("{json}\n") } else { p.text.to_owned() });
        return Ok(());
    }
    if args.json {
        let rows: Vec<_> = PROFILES
            .iter()
            .map(|p| serde_json::json!({ "kind": p.kind, "name": p.name, "about": p.about() }))
            .collect();
        files::print(&format!("{}\n", serde_json::json!({ "profiles": rows })));
    } else {
        let rows = PROFILES.iter().map(|p| format!("{:<9} {:<13} {}\n", p.kind, p.name, p.about()));
        files::print(&rows.collect::<String>());
    }
    Ok(())
}
