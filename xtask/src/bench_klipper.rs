//! The printing time that grainpath tells beside that of Klipper's own planner.
//!
//! Times are of the printer and not of this machine, so the `ci` profile does. Cost: about three minutes of one core.

use serde_json::Value;

use crate::bench::rows;
use crate::bench_jobs::number;
use crate::measured::{self, Table};

/// How far a told time may be off. Source: chosen, below what heating and filament changes add to every print.
const OFF_PERCENT: f64 = 1.0;

/// Ten programs of different kinds: nine of ours, and one of another slicer.
pub fn run() -> Result<(), String> {
    let checkout = crate::setup::klipper()?;
    let data = crate::setup::data()?;
    crate::cargo(&["build", "--profile", "ci", "-p", "grainpath-cli"])?;
    let mut script = crate::setup::python();
    script.arg("xtask/py/klipper_time.py").arg(crate::ci_program()).arg(checkout);
    script.arg(crate::target().join("bench/klipper")).arg(data);
    let rows = rows(&mut script)?;
    let table = Table::new(
        "klipper",
        &["program", "Klipper s", "slice s", "inspect s", "slice off %", "inspect off %", "goal"],
        1,
    );
    for row in &rows {
        let name = row["program"].as_str().unwrap_or_default();
        // In hundredths of a percent; the sum has no negative zero.
        let off =
            |told: &Value| (1e4 * (number(told) / number(&row["klipper_s"]) - 1.0)).round() / 100.0 + 0.0;
        // Times of another slicer's program are told by `inspect` alone.
        let by_slice = row["slice_s"].is_number().then(|| off(&row["slice_s"]));
        let by_inspect = off(&row["inspect_s"]);
        let seconds = |v: &Value| v.as_f64().map_or_else(|| "-".to_owned(), |s| format!("{s:.0}"));
        let is_near = |off: f64| off.abs() <= OFF_PERCENT;
        table.row(&[
            name.to_owned(),
            seconds(&row["klipper_s"]),
            seconds(&row["slice_s"]),
            seconds(&row["inspect_s"]),
            by_slice.map_or_else(|| "-".to_owned(), |off| format!("{off:+.2}")),
            format!("{by_inspect:+.2}"),
            measured::goal(
                name,
                &format!("within {OFF_PERCENT} %"),
                by_slice.is_none_or(is_near) && is_near(by_inspect),
            ),
        ]);
    }
    Ok(())
}
