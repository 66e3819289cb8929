//! `grainpath strength` and `grainpath compare`: what carries how much.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use grainpath::guide::boundary_conditions;
use grainpath::measure::report::peak_rss_mb;
use grainpath::measure::strength::{StrengthReport, TestSetup, Tested, test};
use grainpath::run::{Sliced, mesh_and_layers};
use grainpath_core::{Diagnostics, Warning};
use grainpath_gcode::{Program, simulate, write_gcode};
use grainpath_job::Settings;
use grainpath_view::strength::chart_svg;
use serde_json::{Value, json};

use crate::args::{Common, Compare, Strength};
use crate::commands::{plan, read_body, read_job, set_threads};
use crate::{Failure, files, outputs, progress};

/// A tested input.
struct Done {
    name: String,
    tested: Tested,
    layers: usize,
    time_s: f64,
    warnings: Vec<Warning>,
}

/// `grainpath strength`
pub fn strength(args: &Strength) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    let done = one(&args.input, args.job.as_deref(), &args.common, None)?;
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
            "strength": done.tested.report, "peak_rss_mb": peak_rss_mb(), "warnings": done.warnings,
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

fn is_job(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// The job an input is, or that a program is tested with.
fn job_of<'a>(input: &'a Path, job: Option<&'a Path>) -> Result<&'a Path, Failure> {
    let none = || {
        Failure::usage(format!(
            "{}: no job (.toml), and G-code needs --job JOB.toml, whose part, loads and material it is tested with",
            input.display()
        ))
    };
    if is_job(input) { Ok(input) } else { job.ok_or_else(none) }
}

/// Tests a job, or a program with the job it belongs to. `mass_g` is what a job's part is to weigh.
fn one(input: &Path, job: Option<&Path>, common: &Common, mass_g: Option<f64>) -> Result<Done, Failure> {
    let job = job_of(input, job)?;
    let (mut settings, shape, folder) = read_job(job, &common.sets)?;
    settings.strength.enabled = true;
    settings.fill.mass_g = mass_g.or(settings.fill.mass_g);
    let diagnostics = progress::diagnostics();
    let failed = |e: grainpath::measure::strength::StrengthError| Failure::from(grainpath::Error::from(e));
    let theirs = if is_job(input) { None } else { Some(read(&settings, &files::read(input)?, input)?) };
    let solid = !settings.shape.mesh.is_empty() || !settings.shape.outline.is_empty();
    let (tested, program) = if let (Some(program), true) = (&theirs, solid) {
        let source = |source| grainpath::Error::Shape { path: shape.display().to_string(), source };
        let (file, _) = read_body(&settings, &shape, &diagnostics)?;
        let Sliced { mesh, stack, .. } = mesh_and_layers(&settings, file, &diagnostics).map_err(source)?;
        let conditions = boundary_conditions(&settings, &mesh).map_err(|e| failed(e.into()))?;
        let setup = TestSetup::of(&settings, &mesh, &stack, conditions).map_err(failed)?;
        let tested = test(&settings, &setup, program, None, &diagnostics);
        (tested.map_err(|e| named(input, failed(e)))?, theirs)
    } else {
        let (planned, _) = plan(&settings, &shape, &folder, &diagnostics)?;
        let setup = planned.test.as_ref();
        let setup = setup.ok_or_else(|| Failure::usage("strength.enabled should be true"))?;
        if let Some(program) = &theirs {
            let tested = test(&settings, setup, program, None, &diagnostics);
            (tested.map_err(|e| named(input, failed(e)))?, theirs)
        } else {
            let mut bytes = Vec::new();
            write_gcode(&planned.plan, &planned.config, &[], &mut bytes)
                .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
            let program = read(&settings, &bytes, input)?;
            let shift = planned.plan.plate_from_part_mm.truncate();
            (test(&settings, setup, &program, Some(shift), &diagnostics).map_err(failed)?, Some(program))
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

/// `grainpath compare`
pub fn compare(args: &Compare) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    // A slip in the last name is told before the first is tested.
    for input in &args.inputs {
        read_job(job_of(input, args.job.as_deref())?, &args.common.sets)?;
        std::fs::metadata(input)
            .map_err(|e| Failure::input(format!("{}: {}", input.display(), files::plain(&e))))?;
    }
    let mut all: Vec<Done> = Vec::new();
    for input in &args.inputs {
        let mass_g = all.first().filter(|_| args.same_mass && is_job(input)).map(|d| d.tested.report.mass_g);
        let done = one(input, args.job.as_deref(), &args.common, mass_g)?;
        if let Some(folder) = &args.preview {
            for (name, picture) in outputs::strength_pictures(&done.tested) {
                let path: PathBuf = folder.join(format!("{}-{name}", done.name));
                outputs::save(&path, &picture.png)?;
            }
        }
        all.push(done);
    }
    let rows: Vec<Value> = all.iter().map(|d| row(d, &all[0].tested.report)).collect();
    if args.common.json {
        let value = json!({ "ok": true, "version": env!("CARGO_PKG_VERSION"), "rows": rows, "peak_rss_mb": peak_rss_mb() });
        files::print(&format!("{value}\n"));
    } else {
        files::print(&table(&all, &rows));
    }
    Ok(())
}

/// Peak loads over those of the first, corner by corner: nominal, lowest, highest.
fn ratios(of: &StrengthReport, to: &StrengthReport) -> [f64; 3] {
    let nominal = of.peak_load_n / to.peak_load_n;
    let each = of.corners.iter().filter_map(|(k, v)| to.corners.get(k).map(|w| v / w));
    each.fold([nominal; 3], |[n, low, high], r| [n, low.min(r), high.max(r)])
}

fn row(done: &Done, first: &StrengthReport) -> Value {
    let r = &done.tested.report;
    let [ratio, low, high] = ratios(r, first).map(|v| (v * 1e4).round() / 1e4);
    json!({
        "name": done.name, "mass_g": r.mass_g, "time_s": (done.time_s * 10.0).round() / 10.0,
        "peak_load_n": r.peak_load_n, "low_n": r.low_n, "high_n": r.high_n,
        "stiffness_n_per_mm": r.stiffness_n_per_mm, "load_per_gram_n_g": r.load_per_gram_n_g,
        "ratio": ratio, "ratio_low": low, "ratio_high": high,
        "mode": r.mode, "weakest": r.weakest, "corners": r.corners, "mesh_change": r.mesh_change,
        "warnings": done.warnings,
    })
}

fn table(all: &[Done], rows: &[Value]) -> String {
    let width = all.iter().map(|d| d.name.chars().count()).max().unwrap_or(4).max(4);
    let mut out = format!(
        "{:<width$}  {:>7}  {:>9}  {:>17}  {:>8}  {:>6}  {:>18}  fails mostly\n",
        "", "g", "time", "peak N", "N/mm", "N/g", "ratio to the first"
    );
    for (d, row) in all.iter().zip(rows) {
        let r = &d.tested.report;
        let number = |key: &str| row[key].as_f64().unwrap_or(0.0);
        let _ = writeln!(
            out,
            "{:<width$}  {:>7.2}  {:>9}  {:>5.0} ({:>4.0}-{:>4.0})  {:>8.0}  {:>6.1}  {:>5.3} ({:.3}-{:.3})  {}",
            d.name,
            r.mass_g,
            format!("{:.0} min", d.time_s / 60.0),
            r.peak_load_n,
            r.low_n,
            r.high_n,
            r.stiffness_n_per_mm,
            r.load_per_gram_n_g,
            number("ratio"),
            number("ratio_low"),
            number("ratio_high"),
            r.mode
        );
    }
    for d in all {
        let _ = writeln!(out, "{}: weakest at {}", d.name, d.tested.report.weakest.words);
        d.warnings.iter().for_each(|w| {
            let _ = writeln!(out, "{}: warning: {w}", d.name);
        });
    }
    out
}
