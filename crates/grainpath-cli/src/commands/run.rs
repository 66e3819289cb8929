//! `grainpath run`: the main job, whole.

use std::path::Path;

use grainpath::measure::dimensions::Dimension;
use grainpath_job::Settings;

use crate::args::{Common, Run};
use crate::claims::Claims;
use crate::inputs::{claim_inputs, plan, read_job, set_threads};
use crate::{Failure, files, outputs, progress};

/// `grainpath run`
pub fn run(args: &Run) -> Result<(), Failure> {
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
    execute(&settings, &shape, &folder, &out, truth.as_deref(), claims, &args.common)
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
