//! `grainpath compare`: several plans or programs of one part, side by side.

use std::fmt::Write as _;
use std::path::PathBuf;

use grainpath::measure::strength::StrengthReport;
use serde_json::{Value, json};

use super::strength::{Done, is_job, job_of, test_one};
use crate::args::Compare;
use crate::inputs::{read_job, set_threads};
use crate::{Failure, files, memory, outputs};

/// `grainpath compare`
pub fn compare(args: &Compare) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    // All names are checked before the first test, which may take minutes.
    for input in &args.inputs {
        read_job(job_of(input, args.job.as_deref())?, &args.common.sets)?;
        std::fs::metadata(input)
            .map_err(|e| Failure::input(format!("{}: {}", input.display(), files::plain(&e))))?;
    }
    let mut all: Vec<Done> = Vec::new();
    for input in &args.inputs {
        // The mass of the first is the mark for the others: strength of parts compares at equal mass.
        // G-code cannot be changed, so it keeps its own.
        let mass_g = all.first().filter(|_| args.same_mass && is_job(input)).map(|d| d.tested.report.mass_g);
        let done = test_one(input, args.job.as_deref(), &args.common, mass_g)?;
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
        let value = json!({ "ok": true, "version": env!("CARGO_PKG_VERSION"), "rows": rows, "peak_rss_mb": memory::peak_rss_mb() });
        files::print(&format!("{value}\n"));
    } else {
        files::print(&table(&all, &rows));
    }
    Ok(())
}

/// Ratios of the peak load to that of the first: nominal, and the least and greatest over the corners of
/// the material card.
fn ratios(of: &StrengthReport, to: &StrengthReport) -> [f64; 3] {
    let nominal = of.peak_load_n / to.peak_load_n;
    // Corner by corner: uncertainty of the card that acts on both parts alike cancels. The quotient of
    // the two intervals would be much wider.
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
    // Names are counted in characters, which is near enough to columns on a terminal.
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
