//! A job file as settings, or one line that says what is wrong and where.

use grainpath_core::spelling::nearest;
use toml::{Table, Value};

use super::profiles::{KINDS, profile};
use super::settings::{MaterialSection, Settings};

/// What is wrong with a job.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct JobError {
    /// File and line, or the argument.
    pub place: String,
    /// What is wrong and what would be right.
    pub problem: String,
}

fn error(place: impl Into<String>, problem: impl Into<String>) -> JobError {
    JobError { place: place.into(), problem: problem.into() }
}

/// Reads a job. `name` is what errors call the file; `sets` are `section.key=value` as given on the command line,
/// stronger than the file; `load` reads a profile that is named by its path.
///
/// # Errors
/// [`JobError`] with file and line: syntax, unknown keys (with the nearest known one), values out of range.
pub fn parse_job(
    text: &str,
    name: &str,
    sets: &[String],
    load: &dyn Fn(&str) -> Result<String, String>,
) -> Result<Settings, JobError> {
    let job: Table = table(text, name)?;
    let mut settings = Settings::default();
    let set_pairs: Vec<(String, String, Value)> =
        sets.iter().map(|s| split_set(s)).collect::<Result<_, _>>()?;
    for (kind, default) in KINDS {
        let by_set = set_pairs.iter().rev().find(|(s, k, _)| s == kind && k == "profile").map(|(.., v)| v);
        let by_job = job.get(kind).and_then(|s| s.get("profile"));
        let chosen = match by_set.or(by_job) {
            None => default,
            Some(Value::String(s)) => s.as_str(),
            Some(v) => {
                return Err(error(
                    at(text, name, kind, "profile"),
                    format!("profile should be a name in quotes, is {v}"),
                ));
            }
        };
        let place = if by_set.is_some() { "--set".to_owned() } else { at(text, name, kind, "profile") };
        let (profile_text, profile_name) = profile_text(kind, chosen, load).map_err(|p| error(place, p))?;
        let rows: Table = table(&profile_text, &profile_name)?;
        for (key, value) in &rows {
            apply(&mut settings, kind, key, value, || at(&profile_text, &profile_name, "", key))?;
        }
    }
    for (section, rows) in &job {
        if !Settings::SECTIONS.contains(&section.as_str()) {
            let near = nearest(section, Settings::SECTIONS.iter().copied());
            return Err(error(
                at(text, name, section, ""),
                format!("unknown section [{section}]; did you mean [{near}]?"),
            ));
        }
        let Value::Table(rows) = rows else {
            return Err(error(
                at(text, name, "", section),
                format!("{section} should be a section: [{section}]"),
            ));
        };
        for (key, value) in rows.iter().filter(|(k, _)| !is_profile(section, k)) {
            let inner = format!("{section}.{key}");
            if let (Value::Table(rows), true) = (value, Settings::SECTIONS.contains(&inner.as_str())) {
                for (key, value) in rows {
                    apply(&mut settings, &inner, key, value, || at_inner(text, name, &inner, key))?;
                }
                continue;
            }
            apply(&mut settings, section, key, value, || at(text, name, section, key))?;
        }
    }
    for (section, key, value) in set_pairs.iter().filter(|(s, k, _)| !is_profile(s, k)) {
        apply(&mut settings, section, key, value, || "--set".to_owned())?;
    }
    if settings.fibre.enabled {
        settings.fibre_material = fibre_material(&settings, text, name, load)?;
    }
    check_together(&settings, name)?;
    Ok(settings)
}

/// The material that `fibre.material` names.
fn fibre_material(
    settings: &Settings,
    text: &str,
    name: &str,
    load: &dyn Fn(&str) -> Result<String, String>,
) -> Result<MaterialSection, JobError> {
    let chosen = &settings.fibre.material;
    let (text, name) = profile_text("material", chosen, load)
        .map_err(|p| error(at(text, name, "fibre", "material"), format!("fibre.material: {p}")))?;
    let mut own = Settings::default();
    for (key, value) in &table(&text, &name)? {
        apply(&mut own, "material", key, value, || at(&text, &name, "", key))?;
    }
    Ok(own.material)
}

fn is_profile(section: &str, key: &str) -> bool {
    key == "profile" && KINDS.iter().any(|(k, _)| *k == section)
}

fn table(text: &str, name: &str) -> Result<Table, JobError> {
    text.parse().map_err(|e: toml::de::Error| {
        let line = e.span().map_or(1, |s| text[..s.start.min(text.len())].matches('\n').count() + 1);
        error(format!("{name}:{line}"), e.message().replace('\n', "; "))
    })
}

/// `section.key=value`; a value that is not TOML is taken as text.
fn split_set(set: &str) -> Result<(String, String, Value), JobError> {
    let wrong = || error("--set", format!("{set:?} should be section.key=value"));
    let (path, value) = set.split_once('=').ok_or_else(wrong)?;
    let path = path.trim();
    let (section, key) = match path.rsplit_once('.') {
        Some((inner, key)) if Settings::SECTIONS.contains(&inner) => (inner, key),
        _ => path.split_once('.').ok_or_else(wrong)?,
    };
    let parsed = format!("v = {value}").parse::<Table>().ok().and_then(|mut t| t.remove("v"));
    Ok((section.into(), key.into(), parsed.unwrap_or_else(|| Value::String(value.trim().into()))))
}

fn profile_text(
    kind: &str,
    chosen: &str,
    load: &dyn Fn(&str) -> Result<String, String>,
) -> Result<(String, String), String> {
    if let Some(p) = profile(kind, chosen) {
        return Ok((p.text.to_owned(), format!("profile {chosen}")));
    }
    if chosen.ends_with(".toml") || chosen.contains('/') {
        return Ok((load(chosen)?, chosen.to_owned()));
    }
    let names: Vec<&str> = super::PROFILES.iter().filter(|p| p.kind == kind).map(|p| p.name).collect();
    let near = nearest(chosen, names.iter().copied());
    Err(format!(
        "no {kind} profile {chosen:?}; did you mean {near:?}? There are {}; a path ending in .toml works too",
        names.join(", ")
    ))
}

fn apply(
    settings: &mut Settings,
    section: &str,
    key: &str,
    value: &Value,
    place: impl Fn() -> String,
) -> Result<(), JobError> {
    // A scan with nothing but its path.
    let (section, key) =
        if (section, key) == ("shape", "ct") { ("shape.ct", "path") } else { (section, key) };
    match settings.set(section, key, value) {
        Some(Ok(())) => Ok(()),
        Some(Err(problem)) => {
            Err(error(place(), later(section, key, value).unwrap_or(format!("{section}.{key} {problem}"))))
        }
        None => {
            let params = Settings::params();
            let in_section: Vec<&str> =
                params.iter().filter(|p| p.section == section).map(|p| p.key).collect();
            if in_section.is_empty() {
                let near = nearest(section, Settings::SECTIONS.iter().copied());
                return Err(error(place(), format!("unknown section {section}; did you mean {near}?")));
            }
            let near = nearest(key, in_section);
            Err(error(place(), format!("unknown key `{key}` in [{section}]; did you mean `{near}`?")))
        }
    }
}

/// Values that will be right once their part of grainpath is there.
fn later(section: &str, key: &str, value: &Value) -> Option<String> {
    let word = value.as_str().unwrap_or_default();
    let known = match (section, key) {
        ("fill", "pattern") => word == "continuous",
        ("support", "style") => word == "tree",
        _ => false,
    };
    known.then(|| format!("{section}.{key} = {value} is not in this version of grainpath"))
}

/// Checks that no single key can make.
fn check_together(s: &Settings, name: &str) -> Result<(), JobError> {
    let p = &s.process;
    let wrong = |problem: String| Err(error(name, problem));
    if p.bead_width_mm < p.layer_height_mm || p.bead_width_mm < p.first_layer_height_mm {
        return wrong(format!(
            "process.bead_width_mm ({}) should not be less than the layer height ({})",
            p.bead_width_mm,
            p.layer_height_mm.max(p.first_layer_height_mm)
        ));
    }
    if p.min_bead_width_mm > p.bead_width_mm {
        return wrong(format!(
            "process.min_bead_width_mm ({}) should not be more than bead_width_mm ({})",
            p.min_bead_width_mm, p.bead_width_mm
        ));
    }
    if p.adaptive_layers && p.adaptive_min_mm > p.adaptive_max_mm {
        return wrong("process.adaptive_min_mm should not be more than adaptive_max_mm".into());
    }
    check_outline(s, name)?;
    check_photos(s, name)?;
    check_fibre(s, name)?;
    let m = &s.material;
    let bounds = [
        ("xt_mpa", m.xt_mpa),
        ("yt_mpa", m.yt_mpa),
        ("zt_mpa", m.zt_mpa),
        ("s12_mpa", m.s12_mpa),
        ("s_il_mpa", m.s_il_mpa),
        ("xc_mpa", m.xc_mpa),
        ("yc_mpa", m.yc_mpa),
        ("g_along_n_mm", m.g_along_n_mm),
        ("g_across_n_mm", m.g_across_n_mm),
    ];
    if let Some((key, Some([a, b, c]))) =
        bounds.iter().find(|(_, v)| v.is_some_and(|[low, mid, high]| low > mid || mid > high))
    {
        return wrong(format!("material.{key} should rise: low, nominal, high; is [{a}, {b}, {c}]"));
    }
    if !s.ct.path.is_empty() {
        for (set, what) in [
            (!s.shape.mesh.is_empty(), "shape.mesh and shape.ct: exactly one shape is printed"),
            (p.adaptive_layers, "process.adaptive_layers = true is for meshes, not for shape.ct"),
            (s.shape.rotate_deg != [0.0; 3], "shape.rotate_deg is for meshes, not for shape.ct"),
            (s.support.lift_mm > 0.0, "support.lift_mm is for meshes, not for shape.ct"),
        ] {
            if set {
                return wrong(what.into());
            }
        }
    }
    let needs_guide =
        crate::choices::GUIDED.contains(&s.fill.pattern.as_str()) && s.fill.pattern != "continuous";
    if needs_guide && s.guide.kind == "none" {
        return wrong(format!(
            "fill.pattern = {:?} needs a guide: [guide] kind = \"stress\" or \"angle\"",
            s.fill.pattern
        ));
    }
    if s.fill.angles_deg.is_empty() {
        return wrong("fill.angles_deg should have at least one angle".into());
    }
    Ok(())
}

/// Drawings: what must be given together.
fn check_outline(s: &Settings, name: &str) -> Result<(), JobError> {
    let shape = &s.shape;
    let others = [
        ("shape.mesh", !shape.mesh.is_empty()),
        ("shape.ct", !s.ct.path.is_empty()),
        ("shape.photo", !s.photo.files.is_empty()),
    ];
    let problem = match others.iter().find(|o| o.1) {
        _ if shape.outline.is_empty() => return Ok(()),
        Some((other, _)) => format!("{other} and shape.outline: exactly one shape is printed"),
        None if shape.thickness_mm == 0.0 => "shape.outline needs shape.thickness_mm".into(),
        None => return Ok(()),
    };
    Err(error(name, problem))
}

/// Continuous fibre: a tool for it, and settings that go together.
fn check_fibre(s: &Settings, name: &str) -> Result<(), JobError> {
    let (f, p) = (&s.fibre, &s.printer);
    let wrong = |problem: String| Err(error(name, problem));
    if !f.enabled {
        return Ok(());
    }
    if p.fibre_tool == "none" {
        return wrong(
            "fibre.enabled = true needs a printer with a fibre tool: printer.fibre_tool = \"coextruded\" or \"separate\", or a profile such as fibre-coextruded"
                .into(),
        );
    }
    if p.fibre_cut_gcode.trim().is_empty() {
        return wrong(
            "fibre.enabled = true needs printer.fibre_cut_gcode, the program that cuts the fibre".into(),
        );
    }
    if p.fibre_tool == "separate" && p.fibre_tool_number == 0 {
        return wrong("printer.fibre_tool_number should not be 0, which is the matrix's".into());
    }
    if p.fibre_tool == "separate" && p.tool_change_gcode.trim().is_empty() {
        return wrong("printer.fibre_tool = \"separate\" needs printer.tool_change_gcode".into());
    }
    if let Some([a, b]) = f.layers.iter().find(|[a, b]| a > b) {
        return wrong(format!("fibre.layers should be [first, last] from 1, is [{a}, {b}]"));
    }
    if let Some(b) = f.boxes_mm.iter().find(|[low, high]| (0..3).any(|k| low[k] >= high[k])) {
        return wrong(format!("fibre.boxes_mm should be [lowest corner, highest corner], has {b:?}"));
    }
    let width = f.bead_width_mm.unwrap_or(s.process.bead_width_mm);
    if width < s.process.layer_height_mm || width < s.process.first_layer_height_mm {
        return wrong(format!("fibre.bead_width_mm ({width}) should not be less than the layer height"));
    }
    if f.start == "calm" && s.guide.kind != "stress" {
        return wrong("fibre.start = \"calm\" needs [guide] kind = \"stress\"".into());
    }
    if s.fill.density == 0.0 {
        return wrong("fibre.enabled = true needs fill.density above 0".into());
    }
    if crate::choices::GUIDED.contains(&f.matrix_pattern.as_str()) && s.guide.kind == "none" {
        return wrong(format!("fibre.matrix_pattern = {:?} needs a guide", f.matrix_pattern));
    }
    Ok(())
}

/// Photographs: what must be given together.
fn check_photos(s: &Settings, name: &str) -> Result<(), JobError> {
    let wrong = |problem: String| Err(error(name, problem));
    let photo = !s.photo.files.is_empty();
    for (other, path) in [("shape.mesh", &s.shape.mesh), ("shape.ct", &s.ct.path)] {
        if photo && !path.is_empty() {
            return wrong(format!("{other} and shape.photo: exactly one shape is printed"));
        }
    }
    if photo && (s.photo.size_mm.contains(&0.0) || s.photo.thickness_mm == 0.0) {
        return wrong("shape.photo needs size_mm = [width, height] and thickness_mm".into());
    }
    if photo && s.process.adaptive_layers {
        return wrong("process.adaptive_layers = true is for meshes, not for shape.photo".into());
    }
    let (image, volume) = (!s.image.files.is_empty(), !s.volume.path.is_empty());
    if image && volume {
        return wrong("guide.image and guide.volume: exactly one gives the grain".into());
    }
    if s.guide.kind == "grain" && !photo && !image {
        if !volume && s.ct.path.is_empty() {
            return wrong(
                "guide.kind = \"grain\" needs photographs or a scan: guide.image = { files = [\"FILE\"] } or guide.volume = { path = \"SCAN\" }".into(),
            );
        }
        if s.guide.mode == "edges" {
            return wrong(
                "guide.mode = \"edges\" is for photographs; a scan's texture gives directions".into(),
            );
        }
    }
    if photo && volume {
        return wrong("guide.volume is for meshes and scans; shape.photo has its own grain".into());
    }
    for (section, files, corners, heights) in [
        ("shape.photo", &s.photo.files, &s.photo.corners_px, &s.photo.heights_mm),
        ("guide.image", &s.image.files, &s.image.corners_px, &s.image.heights_mm),
    ] {
        if ![0, 4, 4 * files.len()].contains(&corners.len()) {
            return wrong(format!(
                "{section}.corners_px should have 4 corners, or 4 for each of the {} files; it has {}",
                files.len(),
                corners.len()
            ));
        }
        if !heights.is_empty() && heights.len() != files.len() {
            return wrong(format!(
                "{section}.heights_mm should have a height for each of the {} files; it has {}",
                files.len(),
                heights.len()
            ));
        }
        if heights.windows(2).any(|w| w[0] >= w[1]) {
            return wrong(format!("{section}.heights_mm should rise from file to file"));
        }
    }
    Ok(())
}

/// File and line of a key in its section, by looking for it; of the section where the key is nowhere plain.
fn at(text: &str, name: &str, section: &str, key: &str) -> String {
    let (mut current, mut section_line) = (String::new(), 1);
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(rest) = line.strip_prefix('[') {
            current = rest.trim_start_matches('[').split(']').next().unwrap_or_default().trim().to_owned();
            let first = current.split('.').next().unwrap_or_default();
            if first == section && section_line == 1 {
                section_line = i + 1;
            }
            if current == format!("{section}.{key}") {
                return format!("{name}:{}", i + 1);
            }
        } else if current == section {
            let word = line.split(['=', ' ', '\t', '.']).next().unwrap_or_default().trim_matches(['"', '\'']);
            if !key.is_empty() && word == key {
                return format!("{name}:{}", i + 1);
            }
        }
    }
    format!("{name}:{section_line}")
}

/// File and line of a key in a table within a section, or of the table where it stands on one line.
fn at_inner(text: &str, name: &str, inner: &str, key: &str) -> String {
    if text.lines().any(|l| l.trim().starts_with(&format!("[{inner}]"))) {
        return at(text, name, inner, key);
    }
    let (section, table) = inner.split_once('.').unwrap_or((inner, ""));
    at(text, name, section, table)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, sets: &[&str]) -> Result<Settings, String> {
        let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
        parse_job(text, "job.toml", &sets, &|p| Err(format!("cannot read {p}"))).map_err(|e| e.to_string())
    }

    #[test]
    fn every_profile_is_sound_and_the_file_and_set_are_stronger() {
        for p in super::super::PROFILES {
            let text = format!("[{}]\nprofile = \"{}\"\n", p.kind, p.name);
            parse(&text, &[]).unwrap_or_else(|e| panic!("{}: {e}", p.name));
        }
        let s = parse(
            "[process]\nlayer_height_mm = 0.15\nwalls = 4\n",
            &["process.walls=5", "fill.pattern=gyroid"],
        );
        let s = s.expect("a good job");
        assert_eq!(
            (s.process.layer_height_mm, s.process.walls, s.fill.pattern.as_str()),
            (0.15, 5, "gyroid")
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
            (
                "[process]\nwalls = \"two\"\n",
                "job.toml:2: process.walls should be a whole number from 0, is \"two\"",
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
}
