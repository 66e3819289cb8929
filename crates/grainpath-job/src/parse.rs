//! Reads a job file into [`Settings`].

use grainpath_core::spelling::near;
use grainpath_core::{Density, Warning, WarningId};
use toml::{Table, Value};

use super::combinations::{self, strengths};
use super::error::{JobError, Location};
use super::profiles::{KINDS, profile};
use super::regions::JobRegion;
use super::renamed::{Inside, new_key, new_word, path_in_file, removed, rename_names};
use super::settings::{MaterialSection, Settings};
use super::source::Source;
use super::value::{Check, Problem, Step, path_text, read};

/// Version of the job file format that this version of grainpath writes in examples and the studio, and the newest that
/// it reads.
pub const FORMAT: i64 = 1;

/// Reads a job.
///
/// `name` is the name of the file in errors and warnings. `sets` are arguments of the form `section.key=value`,
/// which replace settings of the file. `load` reads a profile that the job names by its path.
///
/// # Errors
/// [`JobError`] with file and line: TOML syntax, unknown keys (with the nearest known one), values that are not allowed,
/// settings that do not fit together, and files of a newer format.
///
/// ```
/// use grainpath_job::parse_job;
///
/// let no_files = |_: &str| Err("no profiles of its own".to_owned());
/// let job = "format = 1\n[process]\nprofile = \"fine\"\nwalls = 4\n";
/// let sets = ["process.walls=5".to_owned()];
/// let settings = parse_job(job, "job.toml", &sets, &no_files).unwrap();
/// assert_eq!(settings.process.walls.least(), 5);
/// ```
pub fn parse_job(
    text: &str,
    name: &str,
    sets: &[String],
    load: &dyn Fn(&str) -> Result<String, String>,
) -> Result<Settings, JobError> {
    let job = Source::parse(text, name)?;
    check_format(&job)?;
    // Arguments are parsed first: one of them may name a profile, which is applied before the file.
    let sets: Vec<Argument> = sets.iter().map(|s| Argument::parse(s)).collect::<Result<_, _>>()?;
    let mut settings = Settings::default();
    for (kind, default) in KINDS {
        apply_profile(&mut settings, kind, default, &job, &sets, load)?;
    }
    let own = [settings.printer.rows(), settings.material.rows(), settings.process.rows()];
    settings.of_profiles.extend(own.into_iter().flatten());
    // The profile's values are kept to find out later which strengths the job replaces.
    let profile_card = settings.material.clone();
    apply_file(&mut settings, &job)?;
    for set in sets.iter().filter(|s| !is_profile(&s.section, &s.key)) {
        let location = |_: &[Step]| Location::set();
        apply(&mut settings, &set.section, &set.key, &set.value, &location)?;
    }
    resolve_mass(&mut settings, &sets);
    name_origins_of_strengths(&mut settings, &profile_card, &job, &sets);
    if settings.fibre.enabled {
        settings.fibre_material = fibre_material(&mut settings, &job, load)?;
    }
    // Combinations are checked last, when every source of settings has been applied.
    let wrong =
        |problem| JobError::Combination { location: Location::file(name), problem: Box::new(problem) };
    combinations::check(&settings).map_err(wrong)?;
    Ok(settings)
}

/// Refuses files of a newer format. Files without `format` are read as format 1.
fn check_format(job: &Source<'_>) -> Result<(), JobError> {
    let Some(value) = job.table.get("format") else { return Ok(()) };
    let location = job.location(&["format"], &[]);
    match value.as_integer() {
        Some(1..=FORMAT) => Ok(()),
        Some(found) if found > FORMAT => Err(JobError::NewerFormat { location, found }),
        Some(_) | None => {
            let problem = Problem::Kind { expected: "a whole number from 1", found: value.to_string() };
            Err(JobError::Value { location, key: "format".into(), error: Box::new(problem.into()) })
        }
    }
}

/// An argument of the form `section.key=value`.
struct Argument {
    section: String,
    key: String,
    value: Value,
}

impl Argument {
    /// Parses an argument. A value that is not TOML is taken as text, so that words need no quotes.
    fn parse(argument: &str) -> Result<Self, JobError> {
        let wrong = || JobError::SetArgument { argument: argument.to_owned() };
        let (path, value) = argument.split_once('=').ok_or_else(wrong)?;
        let path = path.trim();
        // Section names may contain a dot (`shape.ct`); keys do not.
        let (section, key) = match path.rsplit_once('.') {
            Some((inner, key)) if Settings::SECTIONS.contains(&inner) => (inner, key),
            _ => path.split_once('.').ok_or_else(wrong)?,
        };
        let parsed = format!("v = {value}").parse::<Table>().ok().and_then(|mut t| t.remove("v"));
        let value = parsed.unwrap_or_else(|| Value::String(value.trim().into()));
        Ok(Self { section: section.into(), key: key.into(), value })
    }
}

fn is_profile(section: &str, key: &str) -> bool {
    key == "profile" && KINDS.iter().any(|(k, _)| *k == section)
}

/// Applies the profile of a section: the one named by `--set`, otherwise by the job, otherwise the
/// default one.
fn apply_profile(
    settings: &mut Settings,
    kind: &'static str,
    default: &str,
    job: &Source<'_>,
    sets: &[Argument],
    load: &dyn Fn(&str) -> Result<String, String>,
) -> Result<(), JobError> {
    // The last argument wins, as for all other keys.
    let by_set = sets.iter().rev().find(|s| s.section == kind && s.key == "profile").map(|s| &s.value);
    let by_job = job.table.get(kind).and_then(|s| s.get("profile"));
    let location = if by_set.is_some() { Location::set() } else { job.location(&[kind, "profile"], &[]) };
    let chosen = match by_set.or(by_job) {
        None => default,
        Some(Value::String(s)) => s.as_str(),
        Some(v) => {
            let problem = Problem::Kind { expected: "a name in quotes", found: v.to_string() };
            return Err(JobError::Value {
                location,
                key: format!("{kind}.profile"),
                error: Box::new(problem.into()),
            });
        }
    };
    let (text, name) = profile_text(kind, chosen, load, location)?;
    settings.of_profiles.insert(format!("{kind}.profile"), format!("{chosen:?}"));
    let source = Source::parse(&text, &name)?;
    apply_table(settings, kind, &source.table, &source, &[])
}

/// The text of a profile, and its name in errors.
fn profile_text(
    kind: &'static str,
    chosen: &str,
    load: &dyn Fn(&str) -> Result<String, String>,
    location: Location,
) -> Result<(String, String), JobError> {
    if let Some(p) = profile(kind, chosen) {
        return Ok((p.text.to_owned(), format!("profile {chosen}")));
    }
    // A path is recognised by its form. So a missing file is reported as a missing file, not as an
    // unknown profile.
    if chosen.ends_with(".toml") || chosen.contains('/') {
        let text = load(chosen).map_err(|message| JobError::ProfileFile { location, message })?;
        return Ok((text, chosen.to_owned()));
    }
    Err(JobError::UnknownProfile { location, kind, name: chosen.to_owned() })
}

/// Applies the sections of the file.
fn apply_file(settings: &mut Settings, job: &Source<'_>) -> Result<(), JobError> {
    for (section, rows) in job.table.iter().filter(|(key, _)| *key != "format") {
        if section == "region" {
            let location = |steps: &[Step]| job.location(&[section], steps);
            let (rows, renamed) = rename_inside(settings, section, rows, &location)?;
            settings.regions =
                read::<Vec<JobRegion>>(&rows, Check::Any).map_err(|error| JobError::Value {
                    location: location(&path_in_file(&error.path, &renamed)),
                    key: section.clone(),
                    error: Box::new(error),
                })?;
            continue;
        }
        if !Settings::SECTIONS.contains(&section.as_str()) {
            let near = near(section, Settings::SECTIONS);
            let location = job.location(&[section], &[]);
            return Err(JobError::UnknownSection { location, section: section.clone(), near });
        }
        let Value::Table(rows) = rows else {
            let location = job.location(&[section], &[]);
            return Err(JobError::NotASection { location, name: section.clone() });
        };
        // In TOML `[shape.ct]` is a table inside `shape`; here it is treated as a separate section.
        let is_inner = |key: &str| Settings::SECTIONS.contains(&format!("{section}.{key}").as_str());
        let mut own = Table::new();
        for (key, value) in rows.iter().filter(|(k, _)| !is_profile(section, k)) {
            match value {
                Value::Table(inner) if is_inner(key) => {
                    let name = format!("{section}.{key}");
                    apply_table(settings, &name, inner, job, &[section.as_str(), key.as_str()])?;
                }
                _ => drop(own.insert(key.clone(), value.clone())),
            }
        }
        apply_table(settings, section, &own, job, &[section.as_str()])?;
    }
    Ok(())
}

/// Applies the keys of a table. `keys` is the path of the table in its file, for messages.
fn apply_table(
    settings: &mut Settings,
    section: &str,
    rows: &Table,
    source: &Source<'_>,
    keys: &[&str],
) -> Result<(), JobError> {
    for (key, value) in rows {
        let keys: Vec<&str> = keys.iter().copied().chain([key.as_str()]).collect();
        let location = |steps: &[Step]| source.location(&keys, steps);
        // If the table contains both names, it is not clear which value is meant.
        if let Some(new) = new_key(section, key).filter(|new| rows.contains_key(*new)) {
            let (old, new) = (format!("{section}.{key}"), format!("{section}.{new}"));
            return Err(JobError::BothNames { location: location(&[]), old, new });
        }
        apply(settings, section, key, value, &location)?;
    }
    Ok(())
}

/// Sets one key. A renamed key is set under its new name and a removed one is left out, each with a warning.
fn apply(
    settings: &mut Settings,
    section: &str,
    key: &str,
    value: &Value,
    location: &dyn Fn(&[Step]) -> Location,
) -> Result<(), JobError> {
    // For a scan or a file of directions, its path alone may replace the section.
    let (section, key) = match (section, key) {
        ("shape", "ct") => ("shape.ct", "path"),
        ("guide", "field") => ("guide.field", "path"),
        other => other,
    };
    if let Some(reason) = removed(section, key) {
        let text = format!("{section}.{key} was removed and is left out: {reason}");
        settings.warnings.push(in_job(Warning::new(WarningId::JobRemoved, text), location(&[])));
        return Ok(());
    }
    let key = match new_key(section, key) {
        Some(new) => {
            let (old, new_name) = (format!("{section}.{key}"), format!("{section}.{new}"));
            settings.warnings.push(renamed_warning(&old, &new_name, location(&[])));
            new
        }
        None => key,
    };
    let word = value.as_str().and_then(|word| new_word(section, key, word));
    if let Some(new) = word {
        let (old, new) = (format!("{section}.{key} = {value}"), format!("{new:?}"));
        settings.warnings.push(renamed_warning(&old, &new, location(&[])));
    }
    let name = format!("{section}.{key}");
    let (new_value, renamed) = match word {
        Some(word) => (Value::from(word), Vec::new()),
        None => rename_inside(settings, &name, value, location)?,
    };
    match settings.set(section, key, &new_value) {
        Some(Ok(())) => Ok(()),
        Some(Err(error)) => {
            let location = location(&path_in_file(&error.path, &renamed));
            Err(JobError::Value { location, key: name, error: Box::new(error) })
        }
        None => Err(unknown_key(section, key, location(&[]))),
    }
}

/// A value with the new names of keys and words in its tables, each with a warning, and what was renamed. `name` is the name
/// of the value in messages.
fn rename_inside(
    settings: &mut Settings,
    name: &str,
    value: &Value,
    location: &dyn Fn(&[Step]) -> Location,
) -> Result<(Value, Vec<Inside>), JobError> {
    let full = |path: &[Step]| format!("{name}{}", path_text(path));
    let mut renamed = Vec::new();
    // If the table contains both names, it is not clear which value is meant.
    let both = |key: Inside| JobError::BothNames {
        location: location(&key.old),
        old: full(&key.old),
        new: full(&key.new),
    };
    let mut value = value.clone();
    rename_names(name, &mut value, &mut Inside::default(), &mut renamed).map_err(both)?;
    let warning = |found: &Inside| match &found.word {
        Some((old, new)) => {
            let old = format!("{} = {old:?}", full(&found.new));
            renamed_warning(&old, &format!("{new:?}"), location(&found.old))
        }
        None => renamed_warning(&full(&found.old), &full(&found.new), location(&found.old)),
    };
    settings.warnings.extend(renamed.iter().map(warning));
    Ok((value, renamed))
}

fn renamed_warning(old: &str, new: &str, place: Location) -> Warning {
    in_job(Warning::new(WarningId::JobRenamed, format!("{old} is now called {new}")), place)
}

/// A warning with its place in the job file.
fn in_job(warning: Warning, place: Location) -> Warning {
    let warning = warning.in_file(place.file);
    match place.line {
        Some(line) => warning.in_line(line),
        None => warning,
    }
}

fn unknown_key(section: &str, key: &str, location: Location) -> JobError {
    let params = Settings::params();
    let in_section: Vec<&'static str> =
        params.iter().filter(|p| p.section == section).map(|p| p.key).collect();
    // If the section is unknown as well, the error names the section.
    if in_section.is_empty() {
        let near = near(section, Settings::SECTIONS);
        return JobError::UnknownSection { location, section: section.to_owned(), near };
    }
    let near = near(key, in_section);
    JobError::UnknownKey { location, section: section.to_owned(), key: key.to_owned(), near }
}

/// The material that `fibre.material` names.
fn fibre_material(
    settings: &mut Settings,
    job: &Source<'_>,
    load: &dyn Fn(&str) -> Result<String, String>,
) -> Result<MaterialSection, JobError> {
    let location = job.location(&["fibre", "material"], &[]);
    let (text, name) = profile_text("material", &settings.fibre.material, load, location)?;
    let source = Source::parse(&text, &name)?;
    // The fibre's material starts from the defaults, so that it does not inherit keys of the matrix.
    let mut own = Settings::default();
    apply_table(&mut own, "material", &source.table, &source, &[])?;
    settings.warnings.append(&mut own.warnings);
    Ok(own.material)
}

/// A density on the command line replaces the mass of the job file. A mass of 0 counts as unset.
fn resolve_mass(settings: &mut Settings, sets: &[Argument]) {
    let last = |key: &str| sets.iter().rposition(|s| s.section == "fill" && s.key == key);
    let mass_g = settings.fill.mass_g.filter(|m| *m > 0.0);
    settings.fill.mass_g = mass_g;
    // Of both on the command line, the last one applies. Of both in the job file, the mass applies.
    if let (Some(mass_g), Some(density)) = (mass_g, last("density"))
        && last("mass_g").is_none_or(|mass| mass < density)
    {
        settings.fill.mass_g = None;
        // A graded density states where material goes, and the mass how much of it there is; both apply.
        let Some(density) = settings.fill.density.even().map(Density::fraction) else {
            settings.fill.mass_g = Some(mass_g);
            return;
        };
        let text = format!("--set fill.density={density} replaces fill.mass_g = {mass_g} of the job");
        settings.warnings.push(Warning::new(WarningId::JobOverruled, text));
    }
}

/// States the origin of each strength if some are from the job and others from the profile. The origins
/// are written into the source of the strengths, which reports print, and into a warning.
fn name_origins_of_strengths(
    settings: &mut Settings,
    profile_card: &MaterialSection,
    job: &Source<'_>,
    sets: &[Argument],
) {
    let in_job = |key: &str| job.table.get("material").is_some_and(|m| m.get(key).is_some());
    let by_job = |key: &str| in_job(key) || sets.iter().any(|s| s.section == "material" && s.key == key);
    let all = strengths(profile_card);
    let own: Vec<&str> = all.iter().filter(|(key, _)| by_job(key)).map(|(key, _)| *key).collect();
    let rest: Vec<&str> =
        all.iter().filter(|(key, v)| v.is_some() && !by_job(key)).map(|(key, _)| *key).collect();
    // If all strengths have one origin, the source as stated is right.
    if own.is_empty() || rest.is_empty() {
        return;
    }
    let (own, rest) = (own.join(", "), rest.join(", "));
    let material = &mut settings.material;
    let own_source =
        if by_job("strength_source") { material.strength_source.as_str() } else { "source not stated" };
    let profile_source = &profile_card.strength_source;
    material.strength_source =
        format!("{own}: the job ({own_source}); {rest}: the profile ({profile_source})");
    let text = format!("the material card is mixed: {own} from the job, {rest} from the profile");
    settings.warnings.push(Warning::new(WarningId::MaterialMixed, text));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profiles::PROFILES;

    fn parse(text: &str, sets: &[&str]) -> Result<Settings, String> {
        let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
        parse_job(text, "job.toml", &sets, &|p| Err(format!("cannot read {p}"))).map_err(|e| e.to_string())
    }

    #[test]
    fn rows_differ_from_the_profile_by_what_the_job_states() {
        let changed = |text: &str| -> Vec<String> {
            let job = parse(text, &[]).expect("a good job");
            let rows = job.profile_rows().into_iter().chain(job.rows());
            rows.filter(|r| r.value != r.default).map(|r| r.key).collect()
        };
        assert_eq!(changed(""), Vec::<String>::new(), "the default profiles replace no setting of the job");
        let job = "[material]\nprofile = \"petg\"\nbed_temp_c = 71\n[process]\nwalls = 3\n";
        assert_eq!(changed(job), ["material.profile", "material.bed_temp_c", "process.walls"]);
    }

    #[test]
    fn every_profile_is_sound_and_the_file_and_set_are_stronger() {
        for p in PROFILES {
            let text = format!("[{}]\nprofile = \"{}\"\n", p.kind, p.name);
            parse(&text, &[]).unwrap_or_else(|e| panic!("{}: {e}", p.name));
        }
        let s = parse(
            "[process]\nlayer_height_mm = 0.15\nwalls = 4\n",
            &["process.walls=5", "fill.pattern=gyroid"],
        );
        let s = s.expect("a good job");
        assert_eq!(
            (s.process.layer_height_mm, s.process.walls.least(), s.fill.pattern),
            (0.15, 5, crate::choices::Pattern::Gyroid)
        );
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, expect) in [
            (
                "[process]\n\nlayer_heigth_mm = 0.2\n",
                "job.toml:3: unknown key `layer_heigth_mm` in [process]; did you mean `layer_height_mm`?",
            ),
            (
                "[process]\nbead_width_mm = -0.4\n",
                "job.toml:2: process.bead_width_mm should be from 0.05 to 10, is -0.4",
            ),
            ("[proces]\nwalls = 2\n", "job.toml:1: unknown section [proces]; did you mean [process]?"),
            // No name is near, so none is proposed.
            ("[process]\ncolour = 3\n", "job.toml:2: unknown key `colour` in [process]"),
            (
                "[tools]\nwalls = 2\n",
                "job.toml:1: unknown section [tools]; the sections are shape, shape.photo, ",
            ),
            ("[printer]\nprofile = \"wax\"\n", "job.toml:2: no printer profile \"wax\". There are "),
            (
                "[[region]]\non = { layers = [[1, 10]], colour = 3 }\n",
                "job.toml:2: region[1].on has an unknown key `colour`; its keys are box_mm, layers, mesh, face, depth_mm",
            ),
            (
                "[process]\nwalls = \"two\"\n",
                "job.toml:2: process.walls should be a whole number from 0, or { min = 2, max = 6, by = \"stress\" }, is \"two\"",
            ),
            (
                "[fill]\npattern = \"grit\"\n",
                "job.toml:2: fill.pattern should be one of rectilinear, grid, triangles, gyroid, concentric, honeycomb, aligned, stripes, streamlines, seed-lines, continuous, is \"grit\"",
            ),
            (
                "[shape]\nct = { path = \"scan\", pixel = 0.1 }\n",
                "job.toml:2: unknown key `pixel` in [shape.ct]; did you mean `pixel_mm`?",
            ),
            (
                "[shape.ct]\npath = \"scan\"\nthreshold = \"otzu\"\n",
                "job.toml:3: shape.ct.threshold should be \"otsu\", \"iso50\", a grey value or [low, high], is \"otzu\"",
            ),
            (
                "[shape]\nmesh = \"a.stl\"\nct = \"scan\"\n",
                "job.toml: shape.mesh and shape.ct: exactly one shape is printed",
            ),
            (
                "[guide]\nkind = \"grain\"\n",
                "job.toml: guide.kind = \"grain\" needs photographs or a scan: guide.image = { files = [\"FILE\"] } or guide.volume = { path = \"SCAN\" }",
            ),
            (
                "[shape]\nct = \"scan\"\n[guide]\nkind = \"grain\"\nmode = \"edges\"\n",
                "job.toml: guide.mode = \"edges\" is for photographs; a scan's texture gives directions",
            ),
            (
                "[guide]\nkind = \"grain\"\nimage = { files = [\"a.png\"] }\nvolume = { path = \"scan\" }\n",
                "job.toml: guide.image and guide.volume: exactly one gives the grain",
            ),
            (
                "[printer]\nprofile = \"generic-0.5\"\n",
                "job.toml:2: no printer profile \"generic-0.5\"; did you mean \"generic-0.4\"?",
            ),
            (
                "[shape]\nphoto = { files = [\"a.png\"], sise_mm = [1, 2] }\n",
                "job.toml:2: unknown key `sise_mm` in [shape.photo]; did you mean `size_mm`?",
            ),
            (
                "[guide.image]\nfiles = [\"a.png\"]\ncorners_px = [[0, 0]]\n",
                "job.toml: guide.image.corners_px should have 4 corners, or 4 for each of the 1 files; it has 1",
            ),
            (
                "[fill]\nangles_deg = { layers = { \"1-10\" = [0], \"12-\" = [45, -45] } }\n",
                "job.toml:2: fill.angles_deg.layers should give each layer one list of angles, has none for layers 11 to 11",
            ),
            (
                "[fill]\nskin_angles_deg = []\n",
                "job.toml: fill.skin_angles_deg should have at least one angle",
            ),
            (
                "[fill]\nskin_angles_deg = [0]\ndensity = 1\n",
                "job.toml: fill.skin_angles_deg is for skins over sparse infill; with fill.density = 1 there is none",
            ),
            (
                "[[region]]\non = { layers = [[1, 10]] }\nguide = false\n[[region]]\non = { layers = [[3, 2]] }\n",
                "job.toml:5: region[2].on.layers[1] should be [first, last] counted from 1, is [3, 2]",
            ),
            (
                "[[region]]\non = { layers = [[1, 10]] }\nfill = { patern = \"grid\" }\n",
                "job.toml:3: region[1].fill has an unknown key `patern`; did you mean `pattern`?",
            ),
            (
                "[[region]]\non = { face = \"f:9c1e\" }\n",
                "job.toml:2: region[1].on needs depth_mm beside face",
            ),
            (
                "[[region]]\non = { box_mm = [[0, 0, 0], [1, 1, 1]], layers = [[1, 2]] }\n",
                "job.toml:2: region[1].on should have exactly one of box_mm, layers, mesh, face",
            ),
            (
                "[[region]]\non = { box_mm = [[0, 0, 0], [0, 9, 9]] }\nfill = { density = 0.5 }\n",
                "job.toml:2: region[1].on.box_mm should be two corners of a box with a volume, which differ in x, y and z, \
                 is [[0, 0, 0], [0, 9, 9]]",
            ),
            (
                "[[region]]\non = { layers = [[1, 2]] }\nfill = {}\n",
                "job.toml:1: region[1] needs a setting of its own: fill = { ... }, process = { ... } or guide = false",
            ),
            (
                "[[region]]\nfill = { density = 0.5 }\n",
                "job.toml:1: region[1] needs on = { box_mm, layers, mesh",
            ),
            (
                "[[region]]\non = { layers = [[1, 2]] }\nfill = { pattern = \"stripes\" }\n",
                "job.toml: in region[1]: fill.pattern = \"stripes\" needs a guide",
            ),
            ("[fill]\ndensity = 30\n", "job.toml:2: fill.density should be from 0 to 1, is 30"),
            ("[fill]\nlines = 9\n", "job.toml:2: fill.lines should be from 1 to 8, is 9"),
            (
                "[fill]\nlines = 2\ndensity = 1\n",
                "job.toml: fill.lines = 2 needs fill.density below 1: the lines of dense infill leave no room between them",
            ),
            (
                "[fill]\nlines = 2\npattern = \"continuous\"\n",
                "job.toml: fill.lines = 2 is for patterns of separate lines, not for fill.pattern = \"seed-lines\" or \"continuous\"",
            ),
            (
                "[fill]\nlines = 2\n[guide]\nkind = \"grain\"\nimage = { files = [\"a.png\"] }\n",
                "job.toml: fill.lines = 2 is not for guide.kind = \"grain\", whose lines are those of the picture",
            ),
            (
                "[fill]\nlayer_shift = \"inner\"\n",
                "job.toml: fill.layer_shift = \"inner\" is for fill.pattern = \"stripes\" or \"continuous\", not for \"grid\"",
            ),
            (
                "[fill]\nlayer_shift = \"all\"\npattern = \"continuous\"\ndensity = 0.5\n",
                "job.toml: fill.layer_shift = \"all\" needs fill.density = 1: it moves the ends of beads",
            ),
            (
                "[fill]\nlayer_shift = \"all\"\npattern = \"stripes\"\ndensity = 1\n[guide]\nkind = \"grain\"\nmode = \"edges\"\nimage = { files = [\"a.png\"] }\n",
                "job.toml: fill.layer_shift = \"all\" is not for guide.mode = \"edges\", whose lines",
            ),
            ("[printer]\nbed_mm = [1, 2]\n", "job.toml:2: printer.bed_mm should have 3 entries, has 2"),
        ] {
            let found = parse(text, &[]).expect_err(text);
            assert!(found.starts_with(expect), "{found}\nshould begin with\n{expect}");
        }
        assert!(parse("[process\n", &[]).expect_err("syntax").starts_with("job.toml:1: "));
        assert!(parse("", &["walls=2"]).expect_err("no section").contains("section.key=value"));
        assert!(parse("", &["process.wals=2"]).expect_err("unknown").contains("did you mean `walls`"));
        assert!(
            parse("[material]\nprofile = \"my.toml\"\n", &[])
                .expect_err("missing")
                .contains("cannot read my.toml")
        );
    }

    #[test]
    fn a_renamed_key_is_read_with_a_warning_that_names_the_new_one() {
        let s = parse("[guide]\n\nmemory_mb = 100\n", &[]).expect("old names are read");
        assert_eq!(s.guide.memory_mib, 100);
        let warning = s.warnings[0].to_string();
        assert!(
            warning.starts_with("job.toml, line 3: guide.memory_mb is now called guide.memory_mib"),
            "{warning}"
        );
        let s = parse("", &["guide.memory_mb=100"]).expect("old names are read");
        assert_eq!((s.guide.memory_mib, s.warnings.len()), (100, 1));
        let both = parse("[guide]\nmemory_mb = 100\nmemory_mib = 200\n", &[]).expect_err("two values");
        assert_eq!(
            both,
            "job.toml:2: guide.memory_mib has the new name of guide.memory_mb; remove guide.memory_mb"
        );
    }

    /// The old names are those of `renamed::tests::ROWS`.
    #[test]
    fn renamed_keys_and_words_inside_tables_are_read_with_the_same_warning() {
        let ball = "{ ball = { centre_mm = [0, 0, 0], radius_mm = 1 } }";
        let job = format!(
            "guide.kind = \"stress\"
[[guide.load]]
where = {ball}
pull_n = [0, 0, 1]
[[guide.case]]
importance = 2
[[guide.case.load]]
on = {{ facets = [1] }}
pull_n = [0, 1, 0]
[fill]
density = {{ least = 0.1, max = 1, by = \"stress\" }}
[[region]]
on = {{ layers = [[1, 2]] }}
process = {{ walls = 3 }}
[[region]]
where = {{ layers = [[3, 4]] }}
fill = {{ share = 0.6 }}
[[region]]
on = {{ layers = [[5, 6]] }}
fill = {{ style = \"lines\" }}
"
        );
        let s = parse(&job, &[]).expect("old names are read");
        assert_eq!(s.guide.load[0].push, crate::loads::Push::Force(grainpath_core::DVec3::Z));
        assert!(matches!(&s.guide.load[0].on, Some(crate::loads::Place::Shape(_))));
        assert_eq!((s.guide.case[0].weight, s.guide.case[0].loads.len()), (2.0, 1));
        assert_eq!(s.fill.density.graded().map(|g| g.min), Some(0.1));
        assert_eq!(s.regions[1].density, Some(Density::Sparse(0.6)));
        assert_eq!(s.regions[2].pattern, Some(crate::choices::Pattern::Rectilinear));
        let mut found: Vec<String> = s.warnings.iter().map(ToString::to_string).collect();
        found.sort_by_key(|w| w.split([' ', ':']).nth(2).and_then(|line| line.parse::<usize>().ok()));
        let expect = [
            "job.toml, line 3: guide.load[1].where is now called guide.load[1].on",
            "job.toml, line 3: guide.load[1].where.ball is now called guide.load[1].on.sphere",
            "job.toml, line 4: guide.load[1].pull_n is now called guide.load[1].force_n",
            "job.toml, line 6: guide.case[1].importance is now called guide.case[1].weight",
            "job.toml, line 9: guide.case[1].load[1].pull_n is now called guide.case[1].load[1].force_n",
            "job.toml, line 11: fill.density.least is now called fill.density.min",
            "job.toml, line 16: region[2].where is now called region[2].on",
            "job.toml, line 17: region[2].fill.share is now called region[2].fill.density",
            "job.toml, line 20: region[3].fill.style is now called region[3].fill.pattern",
            "job.toml, line 20: region[3].fill.pattern = \"lines\" is now called \"rectilinear\"",
        ];
        assert_eq!(found.len(), expect.len(), "{found:#?}");
        for (found, expect) in found.iter().zip(expect) {
            assert!(found.starts_with(expect), "{found}\nshould begin with\n{expect}");
        }
        let set = "fill.density={ least = 0.1, max = 1, by = \"stress\" }";
        let s = parse("guide.kind = \"stress\"\n", &[set]).expect("old names are read");
        assert_eq!((s.fill.density.graded().map(|g| g.min), s.warnings.len()), (Some(0.1), 1));
    }

    #[test]
    fn wrong_values_of_renamed_keys_inside_tables_name_the_line_in_the_file() {
        for (text, expect) in [
            (
                "[[guide.load]]\non = { facets = [1] }\npull_n = [0, \"1\", 1]\n",
                "job.toml:3: guide.load[1].force_n[2] should be a number, is \"1\"",
            ),
            (
                "[[region]]\non = { layers = [[1, 2]] }\n[region.fill]\n\nshare = 2\n",
                "job.toml:5: region[1].fill.density should be from 0 to 1, is 2",
            ),
            (
                "[[guide.load]]\non = { facets = [1] }\n[[guide.load]]\nforce_n = [0, 0, 1]\npull_n = [0, 0, 1]\n",
                "job.toml:5: guide.load[2].force_n has the new name of guide.load[2].pull_n; remove guide.load[2].pull_n",
            ),
        ] {
            assert_eq!(parse(text, &[]).expect_err(text), expect);
        }
    }

    #[test]
    fn formats_that_are_newer_are_refused() {
        assert!(parse("format = 1\n", &[]).expect("the present format").warnings.is_empty());
        assert!(parse("", &[]).expect("a file without format").warnings.is_empty());
        let newer = parse("# a job\nformat = 2\n", &[]).expect_err("newer");
        assert!(newer.starts_with("job.toml:2: format = 2 is newer than this version"), "{newer}");
        for text in ["format = 0", "format = \"1\"", "format = 1.0"] {
            let wrong = parse(text, &[]).expect_err(text);
            assert!(wrong.starts_with("job.toml:1: format should be a whole number from 1"), "{wrong}");
        }
    }

    #[test]
    fn the_command_line_overrules_and_unsets_the_mass() {
        let job = "[fill]\nmass_g = 18\n";
        assert_eq!(parse(job, &[]).expect("sound").fill.mass_g, Some(18.0));
        let s = parse(job, &["fill.density=0.4"]).expect("sound");
        assert_eq!((s.fill.mass_g, s.fill.density), (None, Density::Sparse(0.4).into()));
        assert_eq!(s.warnings[0].id, WarningId::JobOverruled);
        for unset in ["fill.mass_g=0", "fill.mass_g=none", "fill.mass_g=\"none\""] {
            let s = parse(job, &[unset]).expect(unset);
            assert_eq!((s.fill.mass_g, s.warnings.len()), (None, 0), "{unset}");
        }
        let s = parse(job, &["fill.density=0.4", "fill.mass_g=20"]).expect("sound");
        assert_eq!((s.fill.mass_g, s.warnings.len()), (Some(20.0), 0));
    }

    #[test]
    fn a_mixed_material_card_names_the_origin_of_each_strength() {
        let s = parse("[material]\nxt_mpa = [40, 45, 50]\n", &[]).expect("sound");
        assert_eq!(s.warnings[0].id, WarningId::MaterialMixed);
        assert!(s.material.strength_source.starts_with("xt_mpa: the job (source not stated); yt_mpa,"));
        assert!(parse("", &[]).expect("sound").warnings.is_empty());
    }

    #[test]
    fn a_preload_is_read_with_both_of_its_places() {
        let s = parse("[[guide.load]]\non = { facets = [1] }\nto = { facets = [2] }\npreload_n = 500\n", &[]);
        let load = &s.expect("sound").guide.load[0];
        assert_eq!(load.push, crate::loads::Push::Preload(500.0));
        assert_eq!(load.to, Some(crate::loads::Place::Facets(vec![2])));
        assert_eq!(
            crate::value::SettingValue::to_text(load),
            "{ on = { facets = [1] }, to = { facets = [2] }, preload_n = 500 }"
        );
    }

    #[test]
    fn a_part_of_a_face_is_read_with_the_plane_that_cuts_it() {
        let text = "[[guide.load]]\non = { side = { point_mm = [1, 2, 3], normal = [0, 0, -2] }, face = \"f:9c1e\" }\nforce_n = [1, 0, 0]\n";
        let load = &parse(text, &[]).expect("sound").guide.load[0];
        let again = "{ on = { face = \"f:9c1e\", side = { point_mm = [1, 2, 3], normal = [0, 0, -1] } }, force_n = [1, 0, 0] }";
        assert_eq!(crate::value::SettingValue::to_text(load), again);
        let read = parse(&format!("guide.load = [{again}]\n"), &[]).expect("sound");
        assert_eq!(&read.guide.load[0], load);
    }

    #[test]
    fn wrong_loads_name_their_entry_and_line() {
        let on = "on = { plane = { point_mm = [0, 0, 0], normal = [0, 0, 1] } }";
        for (text, expect) in [
            (
                format!("[[guide.load]]\n{on}\nforce_n = [0, 0, 1]\n[[guide.load]]\n{on}\nforce = [1, 2, 3]\n"),
                "job.toml:4: guide.load[2] has an unknown key `force`; did you mean `force_n`?",
            ),
            (
                format!("[[guide.load]]\n{on}\nforce_n = [0, \"1\", 1]\n"),
                "job.toml:3: guide.load[1].force_n[2] should be a number, is \"1\"",
            ),
            (
                "[[guide.load]]\non = { plane = { point_mm = [0, 0, 0], normal = [0, 0, 0] } }\npressure_mpa = 1\n".into(),
                "job.toml:2: guide.load[1].on.plane.normal should be a direction, is a vector of length 0",
            ),
            (
                "[[guide.load]]\non = { facets = [1], side = { point_mm = [0, 0, 0], normal = [0, 0, 1] } }\nforce_n = [1, 0, 0]\n".into(),
                "job.toml:2: guide.load[1].on needs face beside side",
            ),
            (
                "[[guide.load]]\non = { face = \"f:9c1e\", side = { point_mm = [0, 0, 0] } }\nforce_n = [1, 0, 0]\n".into(),
                "job.toml:2: guide.load[1].on.side needs normal",
            ),
            (
                format!("[[guide.fixture]]\n{on}\nfix = \"xq\"\n"),
                "job.toml:3: guide.fixture[1].fix should be some of \"xyz\", or \"normal\", is \"xq\"",
            ),
            (
                format!("[[guide.load]]\n{on}\nforce_n = [1e200, 0, 0]\n"),
                "job.toml:3: guide.load[1].force_n should be from -1e12 to 1e12, is 1e200",
            ),
            (
                format!("[[guide.load]]\n{on}\npreload_n = 500\n"),
                "job.toml:1: guide.load[1] needs to = { face, box_mm, turned_box, plane, cylinder, sphere or facets }, the place below the nut",
            ),
            (
                format!("[[guide.load]]\n{on}\npreload_n = -500\nto = {{ facets = [1] }}\n"),
                "job.toml:3: guide.load[1].preload_n should be from 0 to 1e12, is -500",
            ),
            (
                format!("[[guide.load]]\n{on}\nforce_n = [0, 0, 1]\nto = {{ facets = [1] }}\n"),
                "job.toml:1: guide.load[1] needs preload_n beside to",
            ),
            (
                "[[guide.load]]\non = { facets = [1], sphere = 2 }\nforce_n = [1, 0, 0]\n".into(),
                "job.toml:2: guide.load[1].on should have exactly one of face, box_mm, turned_box, plane, cylinder, sphere, facets",
            ),
        ] {
            let found = parse(&text, &[]).expect_err(&text);
            assert!(found.starts_with(expect), "{found}\nshould begin with\n{expect}");
        }
    }
}
