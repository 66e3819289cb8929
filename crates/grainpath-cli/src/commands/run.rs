//! `grainpath run`: plans a job file and writes all its outputs.

use std::path::Path;
use std::process::Command;

use grainpath::guide::Guide;
use grainpath::measure::dimensions::Dimension;
use grainpath_core::Diagnostics;
use grainpath_job::Settings;

use crate::args::{Common, RunArguments};
use crate::claims::Claims;
use crate::inputs::{
    Given, Handed, claim_inputs, plan, read_body, read_deck, read_job, read_stress, set_threads,
};
use crate::{Failure, files, outputs, progress};

/// `grainpath run`
pub(crate) fn run(args: &RunArguments) -> Result<(), Failure> {
    if let Some(scheduler) = &args.scheduler {
        return run_folder(args, scheduler);
    }
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
    let paths = outputs::Paths::new(&settings, &shape, &out)?;
    execute(&settings, &shape, &folder, &paths, truth.as_deref(), claims, &args.common)
}

/// Runs the jobs of a folder on a cluster, by starting the Python package.
fn run_folder(args: &RunArguments, scheduler: &str) -> Result<(), Failure> {
    // The Python package passes its interpreter in this variable; another `python3` may lack the package.
    let python = std::env::var_os("GRAINPATH_PYTHON").unwrap_or_else(|| "python3".into());
    let mut command = Command::new(&python);
    command.args(["-m", "grainpath.cluster"]).arg(&args.job).args(["--scheduler", scheduler]);
    if let Some(out) = &args.out {
        command.arg("--out").arg(out);
    }
    for set in &args.common.sets {
        command.args(["--set", set]);
    }
    if let Some(threads) = args.common.threads {
        command.args(["--threads", &threads.to_string()]);
    }
    if args.common.json {
        command.arg("--json");
    }
    let install = "--scheduler needs the Python package with Dask: pip install \"grainpath[dask]\"";
    let ended =
        command.status().map_err(|e| Failure::usage(format!("{install} ({}: {e})", python.display())))?;
    match ended.code() {
        Some(0) => Ok(()),
        // Python exits with 1 if the module is missing and on any fault of its own; it has printed which.
        Some(1) => Err(Failure::usage(format!("the run on the cluster failed as printed above; {install}"))),
        // The table of jobs or the error has been printed already; with --json no second object may follow.
        Some(code) => std::process::exit(code),
        None => Err(Failure::usage("the run on the cluster was ended by a signal")),
    }
}

/// Solves the loads of a job and reports where fixtures and loads act; no G-code is written.
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
    let paths = outputs::Paths::new(settings, shape, out)?;
    claim_inputs(settings, shape, base, &mut claims);
    paths.claim(&mut claims);
    claims.check()?;
    let guide = checked(settings, Given::default(), shape, base, &diagnostics)?;
    let warnings = diagnostics.warnings();
    common.refuse(&warnings, false)?;
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

/// Solves the loads of a job without planning it. Inputs in `given` replace the files; if the shape is given, `shape` is
/// only its name in error messages.
///
/// # Errors
/// For a shape that is neither mesh nor outline, and errors of reading and solving.
pub fn checked(
    settings: &Settings,
    given: Given,
    shape: &Path,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<Guide, Failure> {
    let mesh = match given.shape {
        Some(Handed::Mesh(mesh)) => mesh,
        None if !settings.shape.mesh.is_empty() || !settings.shape.outline.is_empty() => {
            read_body(settings, shape, diagnostics)?.0
        }
        Some(Handed::Scan(_) | Handed::Layers(_)) | None => {
            return Err(Failure::usage(
                "checking loads without planning needs a part from a mesh or an outline; parts of scans and photographs have no shape before planning",
            ));
        }
    };
    let stress = match given.stress {
        Some(handed) => Some(handed),
        None => read_stress(settings, base)?,
    };
    let path = shape.display().to_string();
    let inputs = grainpath::Inputs {
        mesh,
        path,
        stress,
        deck: read_deck(settings, base)?,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: Default::default(),
        known: given.known,
    };
    Ok(grainpath::run::check_loads(settings, inputs, diagnostics)?)
}

/// Plans a job and writes its outputs. Input paths are relative to `base`; `claims` holds the files that were read
/// already.
pub(crate) fn execute(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    paths: &outputs::Paths,
    truth: Option<&[Dimension]>,
    mut claims: Claims,
    common: &Common,
) -> Result<(), Failure> {
    set_threads(common.threads)?;
    let diagnostics = progress::diagnostics();
    claim_inputs(settings, shape, base, &mut claims);
    paths.claim(&mut claims);
    claims.check()?;
    let (planned, read_s) = plan(settings, shape, base, &diagnostics)?;
    // With --strict, a warning during planning ends the job before anything is written. Warnings during
    // writing can only be reported afterwards.
    common.refuse(&diagnostics.warnings(), false)?;
    let (report, _) =
        outputs::write(settings, planned, paths, read_s, common.json, truth, &|_, _| {}, &diagnostics)?;
    // The progress line is cleared before anything is printed.
    drop(diagnostics);
    let refused = common.strict && !report.warnings.is_empty();
    if common.json {
        // The caller prints a refusal as one JSON object with the warnings, so the report must not be
        // printed as well.
        if !refused {
            files::print(&format!("{}\n", report.to_json()));
        }
    } else {
        // If the program goes to standard output, the summary must not be mixed into it.
        if paths.is_standard_output() {
            eprintln!("{}", report.summary());
        } else {
            files::print(&format!("{}\n", report.summary()));
        }
    }
    common.refuse(&report.warnings, true)
}
