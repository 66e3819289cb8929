//! `grainpath slice`: plans a mesh, a drawing, a scan or a photograph with default settings.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use grainpath_core::faces::FaceName;
use grainpath_io::image::{ImageError, sniff_other_image};
use grainpath_job::default_profile;

use crate::args::Slice;
use crate::claims::Claims;
use crate::commands::inspect_scan;
use crate::commands::run::execute;
use crate::inputs::settings;
use crate::{Failure, files, outputs, saved_report};

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|e| endings.iter().any(|d| e.eq_ignore_ascii_case(d)))
}

/// Endings of drawings.
const DRAWINGS: [&str; 2] = ["svg", "dxf"];

/// Endings of pictures that are read.
const PICTURES: [&str; 4] = ["png", "jpg", "jpeg", "bmp"];

/// Endings of picture formats that grainpath does not read but names in the error.
const OTHER_PICTURES: [&str; 7] = ["heic", "heif", "webp", "avif", "gif", "jp2", "jxl"];

fn is_picture(path: &Path) -> bool {
    has_ending(path, &PICTURES) || has_ending(path, &OTHER_PICTURES)
}

/// Endings of files that hold no shape, with the error that names the right command.
const NO_SHAPES: [(&[&str], &str); 5] = [
    (&["toml"], "not a mesh, but a job: `grainpath run` takes it"),
    (&["zraw"], "voxels without their header: name the .mhd file beside it"),
    (
        &["raw", "vol"],
        "voxels without their header: name the header file beside it, or set shape.ct.size_px, shape.ct.sample, shape.ct.pixel_mm and shape.ct.slice_mm",
    ),
    (
        &["gcode", "gco", "g"],
        "not a mesh, but a G-code program: `grainpath inspect`, `render` and `strength` take it",
    ),
    (
        &["vtu", "vtk", "frd", "msh", "inp", "csv", "npy", "npz"],
        "not a mesh, but values at points: guide.import reads stress, guide.field reads directions, and `grainpath inspect` says which it holds",
    ),
];

/// What a file is that holds no shape, and what takes it; `None` for all that may hold one.
pub(crate) fn no_shape(file: &Path) -> Option<String> {
    let row = NO_SHAPES.iter().find(|(endings, _)| has_ending(file, endings));
    row.map(|(_, what)| (*what).to_owned()).or_else(|| saved_report::what_it_is(file))
}

/// The text of the default job for a file, and, for a photograph or scan, the assumptions that the job makes about it.
/// `is_raw` says that the user states the size of raw data.
fn job_of(model: &Path, is_raw: bool) -> Result<(String, Option<&'static str>), Failure> {
    // JSON strings are TOML strings too, so a path with quotes or backslashes is escaped correctly.
    let file = serde_json::Value::from(model.display().to_string());
    if is_picture(model) {
        // No skins, since they would hide the grain; dense infill, since sparse lines along the grain would not touch.
        let job = format!(
            "[shape.photo]\nfiles = [{file}]\n# size_mm = [200, 100]    # width and height of the board: measure it\n# thickness_mm = 6\n\n\
             [guide]\nkind = \"grain\"\n\n[fill]\npattern = \"stripes\"\ndensity = 1\n\n\
             [process]\ntop_layers = 0\nbottom_layers = 0\n"
        );
        let assumed = "a photograph that its board fills, unless shape.photo.corners is \"outline\" or \"markers\": dense stripes along its grain, no skins over them";
        return Ok((job, Some(assumed)));
    }
    if model != Path::new("-") && (is_raw || inspect_scan::is_scan(model)?) {
        let assumed = "a scan: voxels above Otsu's threshold are the part, spacing is that of its header where shape.ct.pixel_mm and slice_mm do not state it";
        return Ok((format!("[shape]\nct = {file}\n"), Some(assumed)));
    }
    Ok((String::new(), None))
}

/// The tables `fill` and `guide` of a job whose beads follow the stress. `holds` names the faces of the mesh that are
/// held, `loads` the faces that are loaded, each with its force.
fn loaded_job(model: &Path, holds: &[String], loads: &[String], sets: &[String]) -> Result<String, Failure> {
    // A drawing has faces once it has a thickness.
    let sets: String = (sets.iter().filter(|set| set.starts_with("shape.") && has_ending(model, &DRAWINGS)))
        .map(|set| format!(" --set {set}"))
        .collect();
    let mut job = String::from("[fill]\npattern = \"stripes\"\ndensity = 1\n\n[guide]\nkind = \"stress\"\n");
    let face = |option: &str, name: &str| {
        name.trim().parse::<FaceName>().map_err(|_| {
            Failure::usage(format!(
                "{option} {name}: a face has a name such as f:9c1e; `grainpath inspect {} --faces{sets}` lists them",
                model.display()
            ))
        })
    };
    let held = holds.iter().map(|name| face("--hold", name)).collect::<Result<Vec<_>, _>>()?;
    for face in &held {
        writeln!(job, "\n[[guide.fixture]]\non = {{ face = \"{face}\" }}\nfix = \"xyz\"").expect("text");
    }
    for load in loads {
        let force = load.split_once('=').and_then(|(name, force)| {
            let force_n: Vec<f64> = force.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
            (force_n.len() == 3 && force_n.iter().all(|n| n.is_finite())).then_some((name, force_n))
        });
        let (name, force_n) = force.ok_or_else(|| {
            let face = load.split('=').next().unwrap_or_default();
            Failure::usage(format!(
                "--load {load} is no face with its force; write --load {face}=0,0,-50: N along x, y and z of the part, without a unit"
            ))
        })?;
        let face = face("--load", name)?;
        if held.contains(&face) {
            return Err(Failure::usage(format!(
                "--load {load}: this face is held, where a force does nothing; load another face"
            )));
        }
        if force_n.iter().all(|n| *n == 0.0) {
            return Err(Failure::usage(format!(
                "--load {load}: a force of 0 N gives the beads nothing to follow; state it along x, y or z"
            )));
        }
        writeln!(job, "\n[[guide.load]]\non = {{ face = \"{face}\" }}\nforce_n = {force_n:?}").expect("text");
    }
    Ok(job)
}

/// The text of a job that plans a file as [`slice`] does, with the default profiles named in it; `None` for a file that
/// is not a mesh, drawing, photograph or scan.
#[cfg(feature = "studio")]
pub(crate) fn job_text(model: &Path) -> Result<Option<String>, Failure> {
    if let Some(what) = no_shape(model) {
        return Err(Failure::input(format!("{}: {what}", model.display())));
    }
    let file = serde_json::Value::from(model.display().to_string());
    let (job, assumed) = job_of(model, false)?;
    let is_mesh = has_ending(model, &["stl", "obj", "ply", "off", "3mf", "step", "stp", "iges", "igs"]);
    let shape = if has_ending(model, &DRAWINGS) {
        format!(
            "[shape]\noutline = {file}\nthickness_mm = 4    # a drawing has no height: say how thick the part is\n"
        )
    } else if assumed.is_some() {
        job
    } else if is_mesh {
        format!("[shape]\nmesh = {file}\n")
    } else {
        return Ok(None);
    };
    let stem = model.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let gcode = serde_json::Value::from(format!("{stem}.gcode"));
    let profile = |kind: &str, name: &str| {
        let own = format!("[{kind}]\n");
        match shape.split_once(&own) {
            // The job of a photograph already has a [process] table.
            Some(_) => String::new(),
            None => format!("\n{own}profile = \"{name}\"\n"),
        }
    };
    let about = assumed.map_or_else(String::new, |words| format!("# Taken for {words}.\n"));
    Ok(Some(format!(
        "{about}{shape}{}{}{}\n[output]\ngcode = {gcode}\nreport = \"report.html\"\n",
        profile("printer", "generic-0.4"),
        profile("material", "pla"),
        profile("process", "standard"),
    )))
}

/// The profiles that a job without a choice of its own is planned with, for the user to check; `None` where all are
/// chosen in `sets`.
fn assumed_profiles(sets: &[String]) -> Option<String> {
    let is_chosen =
        |kind: &str| sets.iter().any(|set| set.trim_start().starts_with(&format!("{kind}.profile")));
    let assumed: Vec<String> = ["printer", "material", "process"]
        .into_iter()
        .filter(|kind| !is_chosen(kind))
        .filter_map(|kind| default_profile(kind).map(|profile| format!("{kind} {}", profile.name)))
        .collect();
    (!assumed.is_empty()).then(|| {
        format!(
            "assumed {}; --set printer.profile=NAME and so on choose others, which `grainpath profiles` lists",
            assumed.join(", ")
        )
    })
}

/// `grainpath slice`
pub(crate) fn slice(args: &Slice) -> Result<(), Failure> {
    let name = args.model.display();
    let is_raw = args.common.sets.iter().any(|set| set.trim_start().starts_with("shape.ct.size_px"));
    if args.model.is_file() {
        if let Some(what) = no_shape(&args.model).filter(|_| !is_raw) {
            return Err(Failure::input(format!("{name}: {what}")));
        }
        // Whoever has a format that is not read should not have to measure the board first.
        if has_ending(&args.model, &OTHER_PICTURES)
            && let Some(format) = sniff_other_image(&files::read(&args.model)?)
        {
            return Err(Failure::input(format!("{name}: {}", ImageError::OtherFormat(format))));
        }
        // A photograph has no size, and any default would be a guess.
        let says_size = args.common.sets.iter().any(|s| s.starts_with("shape.photo"));
        if has_ending(&args.model, &PICTURES) && !says_size {
            return Err(Failure::usage(
                "a photograph needs the size of its board in mm: --set 'shape.photo.size_mm=[WIDTH,HEIGHT]' --set shape.photo.thickness_mm=N",
            )
            .see("docs/tutorials/photograph.md"));
        }
    } else if is_picture(&args.model) {
        return Err(Failure::input(format!("{name}: no such file or directory")));
    }
    // The job names the photographs as text.
    if is_picture(&args.model) && args.model.to_str().is_none() {
        return Err(Failure::input(format!(
            "{name}: the name of a photograph should be UTF-8 text; rename the file"
        )));
    }
    let (mut job, mut assumed) = job_of(&args.model, is_raw)?;
    if !args.loads.is_empty() {
        if assumed.is_some() {
            return Err(Failure::usage(format!(
                "{name}: --hold and --load name faces of a mesh or a drawing, which it is not"
            )));
        }
        job = loaded_job(&args.model, &args.hold, &args.loads, &args.common.sets)?;
        assumed = Some("a part with a load on its faces: dense stripes along the stress");
    }
    let mut settings = settings(&job, "--set", &args.common.sets, Path::new(""))?;
    if args.output.as_deref() == Some(Path::new("-")) {
        return Err(Failure::usage(
            "-o - names no file; /dev/stdout is standard output, and ./- a file with the name -",
        ));
    }
    if args.model == Path::new("-") && args.output.is_none() && settings.output.gcode.is_empty() {
        return Err(Failure::usage("a model from standard input needs -o FILE.gcode"));
    }
    // Both names are the user's own words, so neither may lose in silence.
    let set = (!settings.output.gcode.is_empty()).then(|| PathBuf::from(&settings.output.gcode));
    let output = match (&args.output, set) {
        (Some(output), Some(set)) if *output != set => {
            return Err(Failure::usage(format!(
                "-o {} and output.gcode = {}: give one name of the program",
                output.display(),
                set.display()
            )));
        }
        (Some(output), _) => output.clone(),
        (None, Some(set)) => set,
        (None, None) => args.model.with_extension("gcode"),
    };
    settings.output.gcode = output.display().to_string();
    if has_ending(&args.model, &DRAWINGS) {
        settings.shape.outline = args.model.display().to_string();
        // A drawing has no height, and any default would be a guess.
        if settings.shape.thickness_mm == 0.0 {
            return Err(Failure::usage("an outline needs --set shape.thickness_mm=N").see("docs/formats.md"));
        }
    }
    let here = Path::new("");
    let paths = outputs::Paths::new(&settings, &args.model, here)?.with_gcode(output);
    execute(&settings, &args.model, here, &paths, None, Claims::default(), &args.common)?;
    if args.common.json {
        return Ok(());
    }
    let mut told: Vec<String> =
        assumed.iter().map(|words| format!("taken for {words} (--set changes it)")).collect();
    told.extend(assumed_profiles(&args.common.sets));
    if settings.output.report.is_empty() {
        told.push("--set output.report=report.html adds a page with the layers".to_owned());
    }
    let text: String = told.iter().map(|line| format!("{line}\n")).collect();
    // A program that goes to standard output must stand there alone.
    if paths.is_standard_output() {
        eprint!("{text}");
    } else {
        files::print(&text);
    }
    Ok(())
}
