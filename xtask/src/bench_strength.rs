//! The virtual strength test: time and memory of a plate and of a solid, the papers' comparisons beside the papers' own
//! numbers, and the programs of other slicers.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench::{Bench, PROGRAMS, timed_output};
use crate::measured::Table;

/// A test: its name, what it is, its job, settings beside it, and the most it may take in seconds and MiB.
type Case<'a> = (&'a str, &'a str, &'a str, &'a [&'a str], f64, f64);

const CASES: [Case<'static>; 2] = [
    (
        "plate",
        "bar 150 x 20 x 4 mm as a plate, cells of 0.2 mm, nominal card",
        "iso527-1b",
        &["strength.cell_mm=0.2", "strength.corners=false", "strength.check=false"],
        20.0,
        1536.0,
    ),
    (
        "solid",
        "bracket of 60 mm as a solid, cells of a bead, nominal card",
        "bracket",
        &["strength.corners=false", "strength.check=false"],
        180.0,
        4096.0,
    ),
];

/// Takes too long for every day.
const WHOLE: Case<'static> = (
    "solid, whole",
    "the same with the corners of the card and the check of the cells",
    "bracket",
    &[],
    f64::NAN,
    4096.0,
);

/// Plans that a paper compared, each with what it is called, and what the paper found: the first of a pair over the
/// second, %.
struct Published {
    what: &'static str,
    example: &'static str,
    /// Size of the cells with which the pages quote it, mm.
    cell_mm: &'static str,
    plans: &'static [(&'static str, &'static str)],
    paper: &'static [(usize, usize, f64)],
}

const S2: [Published; 2] = [
    Published {
        what: "S2, bar with a hole in tension",
        example: "stress-lines",
        cell_mm: "0.225",
        plans: &[
            ("tension-0", "beads at 0 degrees"),
            ("tension-90", "beads at 90 degrees"),
            ("tension", "stress lines"),
        ],
        paper: &[(2, 0, 8.3), (2, 1, 19.7), (0, 1, 10.5)],
    },
    Published {
        what: "S2, three-point bending",
        example: "stress-lines",
        cell_mm: "0.225",
        plans: &[
            ("bending-0", "beads at 0 degrees"),
            ("bending-90", "beads at 90 degrees"),
            ("bending", "stress lines"),
        ],
        paper: &[(2, 0, 11.5), (2, 1, 20.5), (0, 1, 8.1)],
    },
];

const S1: Published = Published {
    what: "S1, sparse fills of equal mass around an oblique hole",
    example: "woodgrain",
    cell_mm: "0.9",
    plans: &[
        ("job", "grain"),
        ("grid", "grid"),
        ("triangles", "triangles"),
        ("rectilinear", "rectilinear"),
        ("dense", "grain, beads that touch"),
    ],
    paper: &[(0, 1, 115.0), (0, 2, 72.9), (0, 3, 64.4), (4, 1, 115.0), (4, 2, 72.9), (4, 3, 64.4)],
};

/// The parts of the bench that are named, or all that fit into ten minutes; `all` adds the one that does not.
pub fn run(wanted: &[&str]) -> Result<(), String> {
    let usual = ["time", "s2", "s1", "slicers"];
    if let Some(unknown) = wanted.iter().find(|w| **w != "all" && !usual.contains(w)) {
        return Err(format!("bench strength knows {} and all, not {unknown}", usual.join(", ")));
    }
    let all = wanted.contains(&"all");
    let wants = |part: &str| all || wanted.is_empty() || wanted.contains(&part);
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let folder = crate::root().join("target/bench/strength");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let grainpath = crate::built("grainpath");
    println!("\nOne run of each test.");
    if wants("time") {
        let quietly = |args: &[&str], out: &Path| {
            crate::run(Command::new(&grainpath).args(args).arg(out).stdout(Stdio::null()))
        };
        quietly(&["new", "--force", "stress-lines"], &folder)?;
        quietly(&["specimen", "iso527-1b", "-o"], &folder.join("iso527-1b.stl"))?;
        let header = ["test", "wall s", "CPU s", "MiB", "peak N", "solutions", "aim", "what"];
        let table = Table::new("strength-time", &header, 1);
        let cases = CASES.iter().chain(all.then_some(&WHOLE));
        cases.map(|case| time(&grainpath, &folder, case)).try_for_each(|row| row.map(|r| table.row(&r)))?;
    }
    if wants("s2") {
        // What the test takes by itself, and twice as large, which shows how far cells matter.
        for cell_mm in ["0.225", "0.45"] {
            S2.iter().try_for_each(|published| published.compare(&grainpath, &folder, cell_mm))?;
        }
    }
    if wants("s1") {
        S1.compare(&grainpath, &folder, S1.cell_mm)?;
    }
    if wants("slicers") { foreign() } else { Ok(()) }
}

/// One row: how long a test takes, planning included.
fn time(grainpath: &Path, folder: &Path, case: &Case<'_>) -> Result<Vec<String>, String> {
    let (name, what, job, sets, most_s, most_mib) = *case;
    let mut command = Command::new(grainpath);
    command.args(["strength", "--json"]).arg(folder.join(job).with_extension("toml"));
    for set in sets {
        command.args(["--set", set]);
    }
    let (cost, text) = timed_output(&mut command, folder)?;
    let found: Value = serde_json::from_str(&text).map_err(|e| format!("{what}: {e}"))?;
    let aim = if most_s.is_finite() { format!("{most_s:.0} s, {most_mib:.0} MiB") } else { "none".into() };
    Ok(vec![
        name.to_owned(),
        format!("{:.1}", cost.wall_s),
        format!("{:.1}", cost.cpu_s),
        format!("{:.0}", cost.peak_mib),
        found["strength"]["peak_load_n"].to_string(),
        found["strength"]["solutions"].to_string(),
        aim,
        what.to_owned(),
    ])
}

impl Published {
    /// Prints the loads of the plans with their intervals, and each pair beside the number of the paper. Numbers on cells of
    /// another size are recorded beside those that the pages quote.
    fn compare(&self, grainpath: &Path, folder: &Path, cell_mm: &str) -> Result<(), String> {
        let folder = folder.join(self.example);
        let quietly = &mut Command::new(grainpath);
        crate::run(quietly.args(["new", "--force", self.example]).arg(&folder).stdout(Stdio::null()))?;
        let mut command = Command::new(grainpath);
        command.args(["compare", "--json", "--set", &format!("strength.cell_mm={cell_mm}")]);
        command.args(self.plans.iter().map(|(job, _)| folder.join(job).with_extension("toml")));
        let (cost, text) = timed_output(&mut command, &folder)?;
        let found: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", self.what))?;
        let rows = found["rows"].as_array().filter(|r| r.len() == self.plans.len());
        let rows = rows.ok_or_else(|| format!("{}: not a row for each plan", self.what))?;
        println!(
            "\n{}; cells of {cell_mm} mm, corners of the card; {:.0} s by the clock, {:.0} s of processors, {:.0} MiB.\n",
            self.what, cost.wall_s, cost.cpu_s, cost.peak_mib
        );
        let header = [
            "example",
            "job",
            "plan",
            "mass g",
            "stiffness N/mm",
            "peak N",
            "low N",
            "high N",
            "moved when cells were halved %",
            "fails mostly",
        ];
        let table = Table::new("strength", &header, 2);
        let example = if cell_mm == self.cell_mm {
            self.example.to_owned()
        } else {
            format!("{} {cell_mm} mm", self.example)
        };
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
        for ((job, plan), row) in self.plans.iter().zip(rows) {
            let whole = |key: &str| format!("{:.0}", number(&row[key]));
            table.row(&[
                example.clone(),
                (*job).to_owned(),
                (*plan).to_owned(),
                format!("{:.2}", number(&row["mass_g"])),
                whole("stiffness_n_per_mm"),
                whole("peak_load_n"),
                whole("low_n"),
                whole("high_n"),
                format!("{:.1}", 100.0 * number(&row["mesh_change"])),
                row["mode"].as_str().unwrap_or_default().to_owned(),
            ]);
        }
        let ratios = ["example", "comparison", "paper %", "ours %", "low %", "high %"];
        let table = Table::new("strength", &ratios, 2);
        let percent = |v: f64| format!("{v:+.1}");
        for &(a, b, paper) in self.paper {
            let [ours, low, high] = gain(&rows[a], &rows[b]);
            table.row(&[
                example.clone(),
                format!("{} over {}", self.plans[a].0, self.plans[b].0),
                percent(paper),
                percent(ours),
                percent(low),
                percent(high),
            ]);
        }
        Ok(())
    }
}

/// How much more the first carries than the second, %: nominal, lowest and highest over the corners of the card.
pub(crate) fn gain(of: &Value, to: &Value) -> [f64; 3] {
    let over = |a: &Value, b: &Value| {
        100.0 * (a.as_f64().unwrap_or(f64::NAN) / b.as_f64().unwrap_or(f64::NAN) - 1.0)
    };
    let nominal = over(&of["peak_load_n"], &to["peak_load_n"]);
    let corners = of["corners"].as_object().into_iter().flatten();
    let each = corners.map(|(corner, load)| over(load, &to["corners"][corner]));
    each.fold([nominal; 3], |[n, low, high], g| [n, low.min(g), high.max(g)])
}

/// An open-hole plate sliced by each program at 100 % rectilinear, drawn until it breaks.
fn foreign() -> Result<(), String> {
    let bench = match Bench::prepare() {
        Err(skipped) if skipped.starts_with("skipped") => {
            println!("{skipped}");
            return Ok(());
        }
        other => other?,
    };
    let ours = crate::built("grainpath");
    crate::run(Command::new(&ours).args(["specimen", "d5766", "-o"]).arg(bench.mesh("d5766")))?;
    println!("\nASTM D5766 open-hole plate, 100 % rectilinear, nominal card, cells of 0.45 mm.\n");
    println!("| sliced by | mass g | peak N | stiffness N/mm | fails mostly |\n|---|---|---|---|---|");
    for program in PROGRAMS {
        let Some((_, gcode)) = bench.cost(program, "d5766", 1.0)? else { continue };
        let mut command = Command::new(&ours);
        command.arg("strength").arg(&gcode).arg("--job").arg(bench.mesh("d5766").with_extension("toml"));
        for set in ["corners=false", "check=false", "cell_mm=0.45"] {
            command.args(["--set", &format!("strength.{set}")]);
        }
        let found: Value =
            serde_json::from_str(&crate::output(command.arg("--json"))?).map_err(|e| e.to_string())?;
        let found = &found["strength"];
        println!(
            "| {program} | {} | {} | {} | {} |",
            found["mass_g"],
            found["peak_load_n"],
            found["stiffness_n_per_mm"],
            found["mode"].as_str().unwrap_or_default()
        );
    }
    Ok(())
}
