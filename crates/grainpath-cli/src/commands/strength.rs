//! `grainpath strength`: the load that a part carries until it breaks.

use std::path::Path;

use grainpath::guide::boundary_conditions;
use grainpath::measure::strength::{TestSetup, Tested, test_noting};
use grainpath::run::{Sliced, mesh_and_layers};
use grainpath_core::{Diagnostics, Warning};
use grainpath_gcode::{Program, simulate, write_gcode};
use grainpath_job::Settings;
use grainpath_view::strength::chart_svg;
use serde_json::{Value, json};

use crate::args::{Common, Strength};
use crate::inputs::{plan, read_body, read_job, set_threads};
use crate::{Failure, files, memory, outputs, progress};

/// A tested job or program.
pub struct Done {
    /// File name without its extension.
    pub name: String,
    /// The test.
    pub tested: Tested,
    /// Layers of the program.
    pub layers: usize,
    /// Printing time, s.
    pub time_s: f64,
    /// All warnings.
    pub warnings: Vec<Warning>,
}

/// `grainpath strength`
pub fn strength(args: &Strength) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    let done = test_one(&args.input, args.job.as_deref(), &args.common, None, &|_| {})?;
    let mut written = Value::Null;
    if let Some(folder) = &args.preview {
        for (name, picture) in outputs::strength_pictures(&done.tested) {
            outputs::save(&folder.join(name), &picture.png)?;
        }
        outputs::save(&folder.join("curve.svg"), chart_svg(&done.tested.report).as_bytes())?;
        written = json!({ "preview": folder.display().to_string() });
    }
    if args.common.json {
        let mut value = json!({
            "ok": true, "version": env!("CARGO_PKG_VERSION"), "layers": done.layers,
            "mass_g": done.tested.report.mass_g, "time_s": (done.time_s * 10.0).round() / 10.0,
            "strength": done.tested.report, "peak_rss_mb": memory::peak_rss_mb(), "warnings": done.warnings,
        });
        if !written.is_null() {
            value["outputs"] = written;
        }
        files::print(&format!("{value}\n"));
    } else {
        let warnings: String = done.warnings.iter().map(|w| format!("\nwarning: {w}")).collect();
        files::print(&format!("{}{warnings}\n", done.tested.report.summary()));
    }
    Ok(())
}

/// Whether a path has the ending of a job file.
pub fn is_job(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// The job of an input: the input itself, or the job a program is tested with.
pub fn job_of<'a>(input: &'a Path, job: Option<&'a Path>) -> Result<&'a Path, Failure> {
    let none = || {
        Failure::usage(format!(
            "{}: no job (.toml), and G-code needs --job JOB.toml, whose part, loads and material it is tested with",
            input.display()
        ))
    };
    if is_job(input) { Ok(input) } else { job.ok_or_else(none) }
}

/// Tests a job, or a program with the job it belongs to. `mass_g` is the mass that a job's part should have; `note`
/// receives the first answer.
pub fn test_one(
    input: &Path,
    job: Option<&Path>,
    common: &Common,
    mass_g: Option<f64>,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Done, Failure> {
    let job = job_of(input, job)?;
    let (mut settings, shape, folder) = read_job(job, &common.sets)?;
    settings.strength.enabled = true;
    settings.fill.mass_g = mass_g.or(settings.fill.mass_g);
    let diagnostics = progress::diagnostics();
    let failed = |e: grainpath::measure::strength::StrengthError| Failure::from(grainpath::Error::from(e));
    let theirs = if is_job(input) { None } else { Some(read(&settings, &files::read(input)?, input)?) };
    // A photograph or a scan has its shape only after planning, so those jobs are planned even for a
    // program of another slicer.
    let solid = !settings.shape.mesh.is_empty() || !settings.shape.outline.is_empty();
    // For a program of another slicer the fill need not be planned: section, fixtures and loads are
    // enough.
    let (tested, program) = if let (Some(program), true) = (&theirs, solid) {
        let source = |source| grainpath::Error::Shape { path: shape.display().to_string(), source };
        let (file, _) = read_body(&settings, &shape, &diagnostics)?;
        let Sliced { mesh, stack, .. } =
            mesh_and_layers(&grainpath::run::config::placing(&settings), file, &diagnostics)
                .map_err(source)?;
        let conditions = boundary_conditions(&grainpath::run::config::loads(&settings), &mesh)
            .map_err(|e| failed(e.into()))?;
        let setup = TestSetup::of(&settings, &mesh, &stack, conditions).map_err(failed)?;
        // Without a shift the test finds the part on the bed by itself, since another slicer may have
        // placed it anywhere.
        let tested = test_noting(&settings, &setup, program, None, &diagnostics, note);
        (tested.map_err(|e| named(input, failed(e)))?, theirs)
    } else {
        let (planned, _) = plan(&settings, &shape, &folder, &diagnostics)?;
        let setup = planned.test.as_ref();
        let setup = setup.ok_or_else(|| Failure::usage("strength.enabled should be true"))?;
        if let Some(program) = &theirs {
            let tested = test_noting(&settings, setup, program, None, &diagnostics, note);
            (tested.map_err(|e| named(input, failed(e)))?, theirs)
        } else {
            let mut bytes = Vec::new();
            // The plan is written and read back, so that the test sees the rounding of the program as for
            // any other.
            write_gcode(&planned.plan, &planned.config, &[], &mut bytes)
                .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
            let program = read(&settings, &bytes, input)?;
            let shift = planned.plan.plate_from_part_mm.truncate();
            let tested = test_noting(&settings, setup, &program, Some(shift), &diagnostics, note);
            (tested.map_err(failed)?, Some(program))
        }
    };
    let program = program.unwrap_or_default();
    let warnings = warnings(&diagnostics, &program);
    drop(diagnostics);
    let name = input.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Done { name, tested, layers: program.layers.len(), time_s: program.time_s, warnings })
}

fn named(input: &Path, f: Failure) -> Failure {
    Failure { message: format!("{}: {}", input.display(), f.message), ..f }
}

fn read(settings: &Settings, bytes: &[u8], path: &Path) -> Result<Program, Failure> {
    let limits = grainpath::run::config::limits(settings);
    simulate(bytes, settings.printer.filament_mm, &limits)
        .map_err(|e| Failure::input(format!("{}: {e}", path.display())))
}

fn warnings(diagnostics: &Diagnostics, program: &Program) -> Vec<Warning> {
    let mut all = diagnostics.warnings();
    all.extend(program.warnings.iter().cloned());
    all
}
