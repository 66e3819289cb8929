//! One and the same set of beads, turned and moved on the plate, in the virtual strength test: its peak load should not
//! depend on where the cells of the test lie.
//!
//! Numbers depend on the machine through rounding alone, so the `ci` profile does. Cost: about five minutes on two cores.

use std::fs;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench::rows;
use crate::bench_jobs::number;
use crate::measured::{self, Table};

/// How far the peak of a copy may be off that of the unturned part. Source: chosen, a tenth of what an interval spans.
const OFF_PERCENT: f64 = 2.0;
/// The least share of copies in the interval told for the unturned part.
const INSIDE_PERCENT: f64 = 90.0;

/// `words`: number of copies (50), and the seed of their places (1).
pub fn run(words: &[&str]) -> Result<(), String> {
    crate::setup::bench()?;
    crate::cargo(&["build", "--profile", "ci", "-p", "grainpath-cli"])?;
    let program = crate::ci_program();
    let folder = crate::target().join("bench/turned");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut new = Command::new(&program);
    crate::run(new.args(["new", "--force", "stress-lines"]).arg(&folder).stdout(Stdio::null()))?;
    let mut script = crate::setup::python();
    script.arg("xtask/py/turned_beads.py").arg(&program).arg(folder.join("tension-0.toml"));
    script.arg(folder.join("programs")).args(words);
    let rows = rows(&mut script)?;
    let found = rows.first().ok_or("turned_beads.py printed nothing")?;
    let [peak, low, high] = ["peak_load_n", "low_n", "high_n"].map(|key| number(&found[key]));
    let copies: Vec<f64> = found["copies_n"].as_array().into_iter().flatten().map(number).collect();
    let off = copies.iter().map(|n| 100.0 * (n / peak - 1.0).abs()).fold(0.0, f64::max);
    let least = copies.iter().copied().fold(f64::INFINITY, f64::min);
    let most = copies.iter().copied().fold(0.0, f64::max);
    let inside = copies.iter().filter(|n| (low..=high).contains(*n)).count();
    let inside_percent = 100.0 * inside as f64 / copies.len() as f64;
    let table = Table::new(
        "turned",
        &[
            "part",
            "copies",
            "cells mm",
            "peak N",
            "low N",
            "high N",
            "least N",
            "most N",
            "furthest off %",
            "inside",
            "goal",
        ],
        1,
    );
    let goal = format!("off at most {OFF_PERCENT} %, {INSIDE_PERCENT} % inside");
    let whole = |n: f64| format!("{n:.0}");
    table.row(&[
        "S2 bar at 0 degrees".to_owned(),
        copies.len().to_string(),
        Value::to_string(&found["cell_mm"]),
        whole(peak),
        whole(low),
        whole(high),
        whole(least),
        whole(most),
        format!("{off:.2}"),
        inside.to_string(),
        measured::goal("turned beads", &goal, off <= OFF_PERCENT && inside_percent >= INSIDE_PERCENT),
    ]);
    Ok(())
}
