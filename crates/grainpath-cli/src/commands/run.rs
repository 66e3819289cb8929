//! `grainpath run`: the main job, whole.

use std::path::Path;

use grainpath::measure::dimensions::Dimension;
use grainpath_job::Settings;

use crate::args::{Common, RunArguments};
use crate::claims::Claims;
use crate::inputs::{claim_inputs, plan, read_body, read_job, read_stress, set_threads};
use crate::{Failure, files, outputs, progress};

/// `grainpath run`
pub fn run(args: &RunArguments) -> Result<(), Failure> {
    let (settings, shape, folder) = read_job(&args.job, &args.common.sets)?;
    let truth = match settings.ct.truth.as_str() {
        "" => None,
        path => {
            let path = folder.join(path);
            let read =
                grainpath::measure::dimensions::parse(&files::read_text(&path)?, &path.display().to_string());
            Some(read.map_err(grainpath::Error::from)?)
        }
    };
    let out = args.out.clone().unwrap_or_else(|| folder.clone());
    let mut claims = Claims::default();
    claims.read("the job file", &args.job);
    if args.check {
        return check(&settings, &shape, &folder, &out, claims, &args.common);
    }
    execute(&settings, &shape, &folder, &out, truth.as_deref(), claims, &args.common)
}

/// Solves the loads of a job and tells what they caught; no G-code is written.
fn check(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    out: &Path,
    mut claims: Claims,
    common: &Common,
) -> Result<(), Failure> {
    set_threads(common.threads)?;
    let diagnostics = progress::diagnostics();
    if settings.shape.mesh.is_empty() && settings.shape.outline.is_empty() {
        return Err(Failure::usage(
            "--check needs a part from a mesh or an outline; those of scans and photographs are known after planning",
        ));
    }
    let paths = outputs::Paths::of(settings, shape, out)?;
    claim_inputs(settings, shape, base, &mut claims);
    paths.claim(&mut claims);
    claims.check()?;
    let (mesh, _) = read_body(settings, shape, &diagnostics)?;
    let inputs = grainpath::Inputs {
        mesh,
        path: shape.display().to_string(),
        stress: read_stress(settings, base)?,
        directions: None,
        photos: Vec::new(),
        texture: None,
    };
    let guide = grainpath::run::check_loads(settings, inputs, &diagnostics)?;
    let warnings = diagnostics.warnings();
    if common.strict && !warnings.is_empty() {
        return Err(Failure::strict(warnings, false));
    }
    let outputs = outputs::write_check(&guide, &paths)?;
    // The progress line is cleared before anything is printed.
    drop(diagnostics);
    let report = grainpath::measure::report::StressReport::from(&guide);
    if common.json {
        let outputs: serde_json::Map<String, serde_json::Value> =
            outputs.into_iter().map(|(what, path)| (what.to_owned(), path.into())).collect();
        let value = serde_json::json!({
            "ok": true, "kind": "check", "stress": report, "outputs": outputs, "warnings": warnings,
        });
        files::print(&format!("{value}\n"));
        return Ok(());
    }
    let mut text: String = report.rows().iter().map(|(what, value)| format!("{what}: {value}\n")).collect();
    outputs.iter().for_each(|(what, path)| text.push_str(&format!("{what}: {path}\n")));
    warnings.iter().for_each(|w| text.push_str(&format!("warning: {w}\n")));
    files::print(&text);
    Ok(())
}

/// Plans and writes a job. Input paths are relative to `base`, output paths to `out`; `claims` holds the
/// files that were read before.
pub fn execute(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    out: &Path,
    truth: Option<&[Dimension]>,
    mut claims: Claims,
    common: &Common,
) -> Result<(), Failure> {
    set_threads(common.threads)?;
    let diagnostics = progress::diagnostics();
    let paths = outputs::Paths::of(settings, shape, out)?;
    claim_inputs(settings, shape, base, &mut claims);
    paths.claim(&mut claims);
    claims.check()?;
    let (planned, read_s) = plan(settings, shape, base, &diagnostics)?;
    // Warnings of planning refuse the job before anything is written; those of writing can only be told
    // afterwards.
    if common.strict {
        let warnings = diagnostics.warnings();
        if !warnings.is_empty() {
            return Err(Failure::strict(warnings, false));
        }
    }
    let report = outputs::write(settings, planned, &paths, read_s, common.json, truth, &diagnostics)?;
    // The progress line is cleared before anything is printed.
    drop(diagnostics);
    let refused = common.strict && !report.warnings.is_empty();
    if common.json {
        // A refusal is printed as one JSON object, with the warnings; a report before it would be a
        // second.
        if !refused {
            files::print(&format!("{}\n", report.to_json()));
        }
    } else {
        // A program on standard output leaves no room for the summary there.
        if paths.is_standard_output() {
            eprintln!("{}", report.summary());
        } else {
            files::print(&format!("{}\n", report.summary()));
        }
    }
    if refused { Err(Failure::strict(report.warnings, true)) } else { Ok(()) }
}
