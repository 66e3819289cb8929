//! `grainpath run`: the main job, whole.

use std::path::Path;

use grainpath::measure::dimensions::Dimension;
use grainpath_job::Settings;

use crate::args::{Common, Run};
use crate::inputs::{plan, read_job, set_threads};
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
    execute(&settings, &shape, &folder, &out, truth.as_deref(), &args.common)
}

/// Plans and writes a job. `base` is what input paths are relative to, `out` output paths.
pub fn execute(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    out: &Path,
    truth: Option<&[Dimension]>,
    common: &Common,
) -> Result<(), Failure> {
    set_threads(common.threads)?;
    let diagnostics = progress::diagnostics();
    let paths = outputs::Paths::of(settings, shape, out)?;
    let (planned, read_s) = plan(settings, shape, base, &diagnostics)?;
    let report = outputs::write(settings, planned, &paths, read_s, common.json, truth, &diagnostics)?;
    // The progress line goes before anything is printed.
    drop(diagnostics);
    if common.json {
        files::print(&format!("{}\n", report.to_json()));
    } else {
        files::print(&format!("{}\n", report.summary()));
    }
    Ok(())
}
