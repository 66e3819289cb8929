//! How soon a run ends after SIGINT or SIGTERM: at random moments of each stage, with what it wrote after the signal.
//!
//! Times are those of the release build, as users have it. Cost: about eight minutes on two cores.

use crate::bench::rows;
use crate::bench_jobs::number;
use crate::measured::{self, Table};

/// The longest time from the signal to the exit, s: median and worst of a stage. Source: chosen; below 0.2 s an answer to a
/// key is felt as immediate.
const MEDIAN_S: f64 = 0.2;
const WORST_S: f64 = 0.3;

/// `words`: signals a stage (20), and the seed of their moments (1).
pub fn run(words: &[&str]) -> Result<(), String> {
    crate::setup::bench()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let mut script = crate::setup::python();
    script.arg("xtask/py/stop_times.py").arg(crate::built("grainpath"));
    script.arg(crate::target().join("bench/stops")).args(words);
    let header = [
        "stage",
        "stage s",
        "signals",
        "median s",
        "worst s",
        "other exit codes",
        "files after the signal",
        "temporary files left",
        "goal",
    ];
    let rows = rows(&mut script)?;
    let table = Table::new("stops", &header, 1);
    for row in &rows {
        let stage = row["stage"].as_str().unwrap_or_default();
        let [median, worst] = ["median_s", "worst_s"].map(|key| number(&row[key]));
        let is_clean = ["other_codes", "late", "left"].iter().all(|key| row[key] == 0);
        let goal = format!("median {MEDIAN_S} s, worst {WORST_S} s, code 130, nothing written after it");
        table.row(&[
            stage.to_owned(),
            format!("{:.1}", number(&row["length_s"])),
            row["signals"].to_string(),
            format!("{median:.3}"),
            format!("{worst:.3}"),
            row["other_codes"].to_string(),
            row["late"].to_string(),
            row["left"].to_string(),
            measured::goal(stage, &goal, median <= MEDIAN_S && worst <= WORST_S && is_clean),
        ]);
    }
    Ok(())
}
