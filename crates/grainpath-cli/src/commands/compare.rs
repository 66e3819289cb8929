//! `grainpath compare`: strength of several jobs or G-code programs of one part, side by side.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use grainpath::measure::strength::three_digits;
use serde::Deserialize;
use serde_json::{Value, json};

use super::strength::{Done, claims_of, is_job, job_of, test_one};
use crate::args::Compare;
use crate::inputs::{read_job, read_settings, set_threads};
use crate::{Failure, files, memory, outputs};

/// `grainpath compare`
pub(crate) fn compare(args: &Compare) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    // All names are checked before the first test, which may take minutes.
    for input in &args.inputs {
        let job = job_of(input, args.job.as_deref())?;
        // A G-code program can stand for the part itself; a job must name a shape.
        if is_job(input) {
            read_job(job, &args.common.sets)?;
        } else {
            read_settings(job, &args.common.sets)?;
        }
        std::fs::metadata(input)
            .map_err(|e| Failure::input(format!("{}: {}", input.display(), files::plain(&e))))?;
    }
    if let Some(folder) = &args.preview {
        for input in &args.inputs {
            let mut claims = claims_of(input, args.job.as_deref(), &args.common)?;
            args.inputs.iter().for_each(|other| claims.read("program", other));
            claims.write_into("--preview", folder, |name| {
                outputs::STRENGTH_PICTURES.iter().any(|picture| name.ends_with(&format!("-{picture}")))
            });
            claims.check()?;
        }
    }
    let mut all: Vec<Done> = Vec::new();
    for input in &args.inputs {
        // With --same-mass, the other jobs get the mass of the first part, so that strengths are comparable.
        // G-code cannot be changed, so it keeps its own mass.
        let mass_g = all.first().filter(|_| args.same_mass && is_job(input)).map(|d| d.tested.report.mass_g);
        let name = input.display();
        let note = |text: &str| {
            if !args.common.json {
                eprintln!("{name}: {text}");
            }
        };
        note("planning");
        let mut done = test_one(input, args.job.as_deref(), &args.common, mass_g, None, &note)?;
        args.common.refuse(&done.warnings, false)?;
        // The beads take most of a program's memory, and the table does not need them.
        done.program.layers = Vec::new();
        let report = &done.tested.report;
        note(&format!("{} N ({})", three_digits(report.peak_load_n), report.over()));
        if let Some(folder) = &args.preview {
            for (name, picture) in outputs::strength_pictures(&done.tested) {
                let path: PathBuf = folder.join(format!("{}-{name}", done.name));
                outputs::save(&path, &picture.png)?;
            }
        }
        all.push(done);
    }
    let rows = compared(&all.iter().map(tested_json).collect::<Vec<_>>())?;
    if args.common.json {
        let value = json!({ "ok": true, "version": env!("CARGO_PKG_VERSION"), "rows": rows, "peak_rss_mb": memory::peak_rss_mb() });
        files::print(&format!("{value}\n"));
    } else {
        files::print(&table(&all, &rows));
    }
    Ok(())
}

/// What a comparison needs of a test. It is read from the test's JSON too, as [`tested_json`] writes it.
#[derive(Debug, Clone, Deserialize)]
struct Compared {
    name: String,
    time_s: f64,
    warnings: Value,
    strength: Strengths,
}

/// The numbers of a [`StrengthReport`](grainpath::measure::strength::StrengthReport) that a comparison shows or needs for a ratio.
#[derive(Debug, Clone, Deserialize)]
struct Strengths {
    mass_g: f64,
    peak_load_n: f64,
    low_n: f64,
    high_n: f64,
    stiffness_n_per_mm: f64,
    load_per_gram_n_g: f64,
    grid_share: f64,
    mode: String,
    weakest: Value,
    corners: BTreeMap<String, f64>,
    card: String,
    mesh_change: Option<f64>,
}

/// A test as JSON: what `grainpath strength --json` has of it, and its name.
pub fn tested_json(done: &Done) -> Value {
    json!({
        "name": done.name, "layers": done.program.layers.len(), "mass_g": done.tested.report.mass_g,
        "time_s": done.program.time_s, "strength": done.tested.report, "warnings": done.warnings,
    })
}

/// A row for each test of a list, which [`tested_json`] wrote, with the ratio of its peak load to that of the first test.
///
/// # Errors
/// For a test that lacks a number.
pub fn compared(all: &[Value]) -> Result<Vec<Value>, Failure> {
    let read = |(k, test): (usize, &Value)| {
        Compared::deserialize(test).map_err(|e| Failure::input(format!("test {k}: {e}")))
    };
    let all = all.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = all.first() else { return Ok(Vec::new()) };
    Ok(all.iter().enumerate().map(|(k, test)| row(test, (k > 0).then_some(&first.strength))).collect())
}

/// A ratio of two peak loads and its interval.
struct Ratio {
    nominal: f64,
    low: f64,
    high: f64,
}

impl Ratio {
    /// The peak load of `part` over that of `first`. If both parts share the material card, the interval spans the ratios at
    /// all its corners and is widened on both sides by the larger `grid_share`. A corner is one choice of low, nominal or
    /// high for the strengths along the beads and for the others.
    fn new(part: &Strengths, first: &Strengths) -> Self {
        let nominal = part.peak_load_n / first.peak_load_n;
        // Errors of two cards are independent: one material may be at its low strengths while the other is at its high ones.
        if part.card != first.card {
            return Self { nominal, low: part.low_n / first.high_n, high: part.high_n / first.low_n };
        }
        // Each ratio is formed at one corner, that is with the same strengths for both parts. An error of the strengths
        // that affects both parts alike then cancels. Dividing the two intervals would give a much wider one.
        let corners = part.corners.iter().filter_map(|(k, v)| first.corners.get(k).map(|w| v / w));
        let (low, high) = corners.fold((nominal, nominal), |(low, high), r| (low.min(r), high.max(r)));
        let grid = part.grid_share.max(first.grid_share);
        Self { nominal, low: low * (1.0 - grid), high: high * (1.0 + grid) }
    }

    /// Whether the interval leaves no doubt which part carries more.
    fn is_decided(&self) -> bool {
        self.low > 1.0 || self.high < 1.0
    }
}

/// A row of the comparison. The first part is not compared with itself, so its `first` is `None`.
fn row(test: &Compared, first: Option<&Strengths>) -> Value {
    let r = &test.strength;
    let ratio = first.map_or(Ratio { nominal: 1.0, low: 1.0, high: 1.0 }, |first| Ratio::new(r, first));
    let round = |v: f64| (v * 1e4).round() / 1e4;
    let decided = first.map_or(Value::Null, |_| json!(ratio.is_decided()));
    json!({
        "name": test.name, "mass_g": r.mass_g, "time_s": (test.time_s * 10.0).round() / 10.0,
        "peak_load_n": r.peak_load_n, "low_n": r.low_n, "high_n": r.high_n,
        "stiffness_n_per_mm": r.stiffness_n_per_mm, "load_per_gram_n_g": r.load_per_gram_n_g,
        "ratio": round(ratio.nominal), "ratio_low": round(ratio.low), "ratio_high": round(ratio.high),
        "decided": decided, "grid_share": r.grid_share,
        "mode": r.mode, "weakest": r.weakest, "corners": r.corners, "card": r.card, "mesh_change": r.mesh_change,
        "warnings": test.warnings,
    })
}

fn table(all: &[Done], rows: &[Value]) -> String {
    // The width of a name is its number of characters, which is close to its columns on a terminal.
    let width = all.iter().map(|d| d.name.chars().count()).max().unwrap_or(4).max(4);
    let mut out = format!(
        "{:<width$}  {:>7}  {:>9}  {:>17}  {:>8}  {:>6}  {:>18}  fails mostly\n",
        "", "g", "time", "peak N", "N/mm", "N/g", "ratio to the first"
    );
    let three = three_digits;
    for (d, row) in all.iter().zip(rows) {
        let r = &d.tested.report;
        let number = |key: &str| row[key].as_f64().unwrap_or(0.0);
        let _ = writeln!(
            out,
            "{:<width$}  {:>7.2}  {:>9}  {:>5} ({:>4}-{:>4})  {:>8}  {:>6}  {:>5.3} ({:.3}-{:.3})  {}{}",
            d.name,
            r.mass_g,
            format!("{:.0} min", d.program.time_s / 60.0),
            three(r.peak_load_n),
            three(r.low_n),
            three(r.high_n),
            three(r.stiffness_n_per_mm),
            three(r.load_per_gram_n_g),
            number("ratio"),
            number("ratio_low"),
            number("ratio_high"),
            if row["decided"] == json!(false) { "not decided; " } else { "" },
            r.mode
        );
    }
    let cards: Vec<&str> = all.iter().map(|d| d.tested.report.card.as_str()).collect();
    if cards.iter().any(|card| *card != cards[0]) {
        let named: Vec<String> =
            all.iter().zip(&cards).map(|(d, card)| format!("{} {card}", d.name)).collect();
        let _ = writeln!(
            out,
            "the materials differ ({}): their ratios go from the low load of one over the high load of the other to the reverse",
            named.join(", ")
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
