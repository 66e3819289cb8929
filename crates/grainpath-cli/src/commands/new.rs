//! `grainpath new`: writes a commented example job and its input files.

use std::io::{BufRead, IsTerminal, Write};
use std::path::PathBuf;

use grainpath_core::spelling::question;
use grainpath_job::edit::{value_of, with_value, without_value};
use grainpath_job::{JobError, Profile, Settings, default_profile, profile, profiles_of};

use crate::args::New;
use crate::{Failure, files};

/// A kind of profile (printer or material), and the keys that belong to the example's own profile of this kind: they are
/// removed from the job if the user chooses another profile.
type Asked = (&'static str, &'static [&'static str]);

const PRINTER: Asked = ("printer", &[]);
const MATERIAL: Asked = ("material", &["nozzle_temp_c", "bed_temp_c"]);

/// `grainpath new`
pub(crate) fn new(args: &New) -> Result<(), Failure> {
    let names = grainpath_parts::presets::PRESETS;
    let example = match (args.preset.as_str(), args.pixels) {
        ("ct", Some(n)) => Some(grainpath_parts::presets::ct(n as usize)),
        (_, Some(_)) => return Err(Failure::usage("--pixels is for the preset ct")),
        (name, None) => grainpath_parts::presets::preset(name),
    };
    let Some(mut example) = example else {
        let near = question(&args.preset, names);
        return Err(Failure::usage(format!(
            "no preset {:?}{near} There are {}",
            args.preset,
            names.join(", ")
        )));
    };
    let folder = args.dir.clone().unwrap_or_else(|| PathBuf::from(&args.preset));
    // All paths are checked before the first file is written, so that a refusal leaves the folder unchanged.
    if let Some((name, _)) = example.iter().find(|(name, _)| folder.join(&**name).exists() && !args.force) {
        let there = folder.join(&**name);
        return Err(Failure::usage(format!("{} is there already; --force writes over it", there.display())));
    }
    let first = String::from_utf8_lossy(&example[0].1).into_owned();
    // Examples with fibre need a fibre printer and the settings made for it, so the user is not asked.
    let for_fibre = parsed(&first).is_ok_and(|settings| settings.fibre.enabled);
    let at_terminal = std::io::stdin().is_terminal() && std::io::stdout().is_terminal();
    let may_ask = at_terminal && !args.yes && !for_fibre;
    for (what, given) in [(PRINTER, &args.printer), (MATERIAL, &args.material)] {
        let (kind, _) = what;
        let own = profile_in(&first, kind);
        let chosen = match given {
            Some(name) => Some(known(kind, name).map_err(Failure::usage)?),
            None if may_ask => ask(kind, own, &mut std::io::stdin().lock(), &mut std::io::stderr())
                .map_err(|e| Failure::usage(format!("the terminal cannot be read: {e}")))?,
            None => None,
        };
        let Some(name) = chosen.filter(|name| *name != own) else { continue };
        for (_, content) in example.iter_mut() {
            if let Some(text) = job_text(content) {
                if let Err(why) = parsed(&with_profile(text, what, name)) {
                    let fits = |p: &Profile| parsed(&with_profile(text, what, p.name)).is_ok();
                    let fitting: Vec<&str> = profiles_of(kind).filter(|p| fits(p)).map(|p| p.name).collect();
                    return Err(Failure::usage(format!(
                        "{kind} {name} does not do for {}: {why}; these do: {}",
                        args.preset,
                        fitting.join(", ")
                    )));
                }
                *content = with_profile(text, what, name).into_bytes();
            }
        }
    }
    for (name, content) in &example {
        let path = folder.join(&**name);
        files::write_atomically(&path, |w| {
            w.write_all(content).map_err(|e| Failure::usage(format!("cannot write {}: {e}", path.display())))
        })?;
    }
    // The answer is the command to type next.
    files::print(&format!("grainpath run {}\n", folder.join(&*example[0].0).display()));
    Ok(())
}

/// The text of a file of an example if it is a job. The file with the true dimensions of a scan is TOML too.
fn job_text(content: &[u8]) -> Option<&str> {
    std::str::from_utf8(content).ok().filter(|text| text.lines().any(|l| l.starts_with("[shape")))
}

/// The settings of a job of an example.
fn parsed(job: &str) -> Result<Settings, JobError> {
    let no_files = |_: &str| Err("examples use shipped profiles alone".to_owned());
    grainpath_job::parse_job(job, "job.toml", &[], &no_files)
}

/// The name of the profile if it exists; otherwise an error that lists the names that do.
fn known(kind: &str, name: &str) -> Result<&'static str, String> {
    profile(kind, name).map(|p| p.name).ok_or_else(|| {
        let names: Vec<&str> = profiles_of(kind).map(|p| p.name).collect();
        let near = question(name, names.iter().copied());
        format!("no {kind} {name:?}{near} There are {}", names.join(", "))
    })
}

/// The profile that the job names, or the default profile of this kind.
fn profile_in<'a>(job: &'a str, kind: &str) -> &'a str {
    let named = value_of(job, kind, "profile").map(|value| value.trim_matches('"'));
    named.unwrap_or_else(|| default_profile(kind).map_or("", |p| p.name))
}

/// The text of a job with its profile of this kind replaced by `name`.
fn with_profile(job: &str, (kind, own_keys): Asked, name: &str) -> String {
    let value = format!("\"{name}\"");
    let Some(job) = with_value(job, kind, "profile", &value) else {
        return format!("{job}\n[{kind}]\nprofile = {value}\n");
    };
    own_keys.iter().fold(job, |job, key| without_value(&job, kind, key))
}

/// Asks for a profile until the user types a name or number from the list. An empty line or the end of the input gives
/// `None`: the example keeps its profile.
fn ask(
    kind: &str,
    own: &str,
    input: &mut dyn BufRead,
    terminal: &mut dyn Write,
) -> std::io::Result<Option<&'static str>> {
    let all: Vec<_> = profiles_of(kind).collect();
    writeln!(terminal, "Which {kind}? A number or a name; Enter takes {own}.")?;
    for (k, profile) in all.iter().enumerate() {
        writeln!(terminal, "  {} {:<17} {}", k + 1, profile.name, profile.about())?;
    }
    loop {
        write!(terminal, "{kind} [{own}]: ")?;
        terminal.flush()?;
        let mut typed = String::new();
        if input.read_line(&mut typed)? == 0 || typed.trim().is_empty() {
            return Ok(None);
        }
        let typed = typed.trim();
        let by_number = typed.parse().ok().and_then(|n: usize| all.get(n.checked_sub(1)?)).map(|p| p.name);
        match by_number.map_or_else(|| known(kind, typed), Ok) {
            Ok(name) => return Ok(Some(name)),
            Err(wrong) => writeln!(terminal, "{wrong}")?,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(typed: &str) -> (Option<&'static str>, String) {
        let mut terminal = Vec::new();
        let answer = ask("material", "pla", &mut typed.as_bytes(), &mut terminal).expect("memory");
        (answer, String::from_utf8(terminal).expect("text"))
    }

    #[test]
    fn names_and_numbers_are_taken_and_enter_keeps_the_example() {
        let third = profiles_of("material").nth(2).map(|p| p.name);
        assert_eq!(asked("petg\n").0, Some("petg"));
        assert_eq!(asked("3\n").0, third);
        assert_eq!(asked("\n").0, None);
        assert_eq!(asked("").0, None);
        let (answer, told) = asked("petgg\n0\n99\nabs\n");
        assert_eq!(answer, Some("abs"));
        assert!(told.contains("did you mean \"petg\"?"), "{told}");
        assert_eq!(told.matches("material [pla]: ").count(), 4, "{told}");
    }

    #[test]
    fn a_profile_replaces_that_of_the_job_in_its_section_alone() {
        let job = "[printer]\nprofile = \"generic-0.4\"  # note\nz_hop_mm = 1\n\n[material]\nprofile = \"pla\"\nnozzle_temp_c = 200\n\n[process]\nprofile = \"standard\"\n";
        let changed = with_profile(&with_profile(job, PRINTER, "voron-2.4"), MATERIAL, "abs");
        assert_eq!(profile_in(&changed, "printer"), "voron-2.4");
        assert_eq!(profile_in(&changed, "material"), "abs");
        assert!(changed.contains("z_hop_mm = 1") && !changed.contains("nozzle_temp_c"), "{changed}");
        assert!(changed.contains("[process]\nprofile = \"standard\""), "{changed}");
        let without = with_profile("[shape]\nmesh = \"a.stl\"\n", PRINTER, "voron-2.4");
        assert_eq!(profile_in(&without, "printer"), "voron-2.4");
        assert_eq!(profile_in("[shape]\n", "printer"), "generic-0.4");
    }
}
