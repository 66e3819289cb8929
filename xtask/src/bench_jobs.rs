//! Small jobs whose numbers pages tell: continuous fibre and its strength (`docs/continuous.md`), layers that take turns
//! between two load cases, smoothing of the field, and given directions (`docs/stress.md`).
//!
//! Numbers are those of the jobs' own reports; fills of given directions are measured by the outside checks. None
//! depends on the machine but through rounding, so the `ci` profile does. Cost: about ten minutes of one core.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench::rows;
use crate::measured::Table;

/// A part of the bench: its name on the command line, and what runs it.
pub(crate) type Part = (&'static str, fn(&Jobs) -> Result<(), String>);

const PARTS: [Part; 5] = [
    ("fibre", fibre),
    ("fibre-strength", fibre_strength),
    ("cases", cases),
    ("smoothing", smoothing),
    ("fields", fields),
];

/// The named parts, or all.
pub fn run(wanted: &[&str]) -> Result<(), String> {
    run_parts("jobs", &PARTS, wanted)
}

/// Runs the named parts of a bench, or all.
pub(crate) fn run_parts(bench: &str, parts: &[Part], wanted: &[&str]) -> Result<(), String> {
    if let Some(unknown) = wanted.iter().find(|w| parts.iter().all(|(name, _)| name != *w)) {
        let names: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
        return Err(format!("bench {bench} knows {}, not {unknown}", names.join(", ")));
    }
    let jobs = Jobs::prepare(bench)?;
    let chosen = parts.iter().filter(|(name, _)| wanted.is_empty() || wanted.contains(name));
    chosen.into_iter().try_for_each(|(_, part)| part(&jobs))
}

/// The program, and the folder that jobs are written to.
pub(crate) struct Jobs {
    pub(crate) program: PathBuf,
    pub(crate) folder: PathBuf,
}

impl Jobs {
    /// Builds the program, and makes the folder of a bench.
    fn prepare(bench: &str) -> Result<Self, String> {
        crate::cargo(&["build", "--profile", "ci", "-p", "grainpath-cli"])?;
        let folder = crate::target().join("bench").join(bench);
        fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        Ok(Self { program: crate::ci_program(), folder })
    }

    /// The folder of an example of `grainpath new`, made anew.
    pub(crate) fn example(&self, name: &str) -> Result<PathBuf, String> {
        let folder = self.folder.join(name);
        let mut command = Command::new(&self.program);
        crate::run(command.args(["new", "--force", name]).arg(&folder).stdout(Stdio::null()))?;
        Ok(folder)
    }

    /// What a command prints as JSON about jobs of a folder.
    pub(crate) fn report(
        &self,
        verb: &str,
        folder: &Path,
        jobs: &[&str],
        sets: &[&str],
    ) -> Result<Value, String> {
        self.report_with(verb, folder, jobs, sets, &[])
    }

    /// As [`Self::report`], with options beside the settings.
    pub(crate) fn report_with(
        &self,
        verb: &str,
        folder: &Path,
        jobs: &[&str],
        sets: &[&str],
        options: &[&OsStr],
    ) -> Result<Value, String> {
        let mut command = Command::new(&self.program);
        command.args([verb, "--json"]).args(sets.iter().flat_map(|set| ["--set", set])).args(options);
        command.args(jobs.iter().map(|job| folder.join(job).with_extension("toml")));
        serde_json::from_str(&crate::output(&mut command)?)
            .map_err(|e| format!("{verb} {}: {e}", jobs.join(" ")))
    }

    /// Rows of `compare`, one for each job.
    fn compare(&self, folder: &Path, jobs: &[&str], sets: &[&str]) -> Result<Vec<Value>, String> {
        let found = self.report("compare", folder, jobs, sets)?;
        let rows = found["rows"].as_array().filter(|rows| rows.len() == jobs.len());
        rows.cloned().ok_or_else(|| format!("compare {}: not a row for each job", jobs.join(" ")))
    }
}

pub(crate) fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or(f64::NAN)
}

pub(crate) fn percent(v: &Value) -> String {
    format!("{:.2}", 100.0 * number(v))
}

/// A plate and a hook of continuous fibre by several patterns; the layers of `chained.toml` in one path.
fn fibre(jobs: &Jobs) -> Result<(), String> {
    let folder = jobs.example("continuous")?;
    let header = [
        "job",
        "fibre m",
        "pieces",
        "matrix g",
        "turns below 2 mm",
        "smallest radius mm",
        "within 15 deg %",
        "gap %",
        "overlap %",
        "spill %",
    ];
    let table = Table::new("fibre", &header, 1);
    let cut = ["fibre.turns=\"cut\""];
    for (name, job, sets) in [
        ("plate", "plate", &[][..]),
        ("plate-wide", "plate-wide", &[]),
        ("plate-stripes", "plate-stripes", &[]),
        ("plate-concentric", "plate-concentric", &[]),
        ("plate-rectilinear", "plate-rectilinear", &[]),
        ("hook", "hook", &[]),
        ("hook-wide", "hook-wide", &[]),
        ("plate-cut", "plate", &cut),
        ("plate-concentric-cut", "plate-concentric", &cut),
    ] {
        let report = jobs.report("run", &folder, &[job], sets)?;
        let (fibre, quality) = (&report["fibre"], &report["quality"]);
        table.row(&[
            name.to_owned(),
            format!("{:.1}", number(&fibre["length_mm"]) / 1e3),
            fibre["pieces"].to_string(),
            format!("{:.2}", number(&report["mass_g"]) - number(&fibre["mass_g"])),
            fibre["sharp_turns"].to_string(),
            format!("{:.2}", number(&fibre["min_radius_mm"])),
            format!("{:.1}", 100.0 * number(&fibre["within_15_deg"])),
            percent(&quality["gap"]),
            percent(&quality["overlap"]),
            percent(&quality["spill"]),
        ]);
    }
    let report = jobs.report("run", &folder, &["chained"], &[])?;
    let table = Table::new("fibre", &["job", "gap %", "overlap %"], 1);
    let quality = &report["quality"];
    table.row(&["chained".to_owned(), percent(&quality["gap"]), percent(&quality["overlap"])]);
    Ok(())
}

/// The plates of [`fibre`] in the virtual strength test, over the cards of both materials.
fn fibre_strength(jobs: &Jobs) -> Result<(), String> {
    let folder = jobs.example("continuous")?;
    let plates = ["plate-rectilinear", "plate-concentric", "plate-stripes", "plate-wide", "plate"];
    let rows = jobs.compare(&folder, &plates, &["strength.cell_mm=0.4"])?;
    let header = [
        "job",
        "mass g",
        "time min",
        "peak N",
        "low N",
        "high N",
        "stiffness N/mm",
        "ratio",
        "ratio low",
        "ratio high",
        "moved when cells were halved %",
        "fails mostly",
    ];
    let table = Table::new("fibre-strength", &header, 1);
    for (plate, row) in plates.iter().zip(&rows) {
        let whole = |key: &str| format!("{:.0}", number(&row[key]));
        let ratio = |key: &str| format!("{:.2}", number(&row[key]));
        table.row(&[
            (*plate).to_owned(),
            format!("{:.2}", number(&row["mass_g"])),
            format!("{:.0}", number(&row["time_s"]) / 60.0),
            whole("peak_load_n"),
            whole("low_n"),
            whole("high_n"),
            whole("stiffness_n_per_mm"),
            ratio("ratio"),
            ratio("ratio_low"),
            ratio("ratio_high"),
            format!("{:.1}", 100.0 * number(&row["mesh_change"])),
            row["mode"].as_str().unwrap_or_default().to_owned(),
        ]);
    }
    Ok(())
}

/// A square plate of PA-CF that is pulled along x and, at another time, along y: layers by turns, and all layers for one
/// case; as it stands, and turned.
fn cases(jobs: &Jobs) -> Result<(), String> {
    let folder = jobs.folder.join("cases");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let write = |name: &str, text: &str| {
        fs::write(folder.join(name), text).map_err(|e| format!("{}: {e}", folder.join(name).display()))
    };
    write(
        "square.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"30mm\" height=\"30mm\" viewBox=\"0 0 30 30\">\
         <path d=\"M0 0H30V30H0Z\"/></svg>\n",
    )?;
    let header =
        ["plate", "plan", "reserve, pull along x", "reserve, pull along y", "peak N", "low N", "high N"];
    let table = Table::new("cases", &header, 2);
    for (plate, deg) in [("straight", 0), ("turned", 37)] {
        let plans = ["turns", "x", "y"];
        // Weights of the two cases where all layers follow their weighted sum.
        for (plan, weights) in plans.iter().zip([None, Some([1.0, 1e-6]), Some([1e-6, 1.0])]) {
            write(&format!("{plan}.toml"), &crossed(deg, weights))?;
        }
        let rows = jobs.compare(&folder, &plans, &[])?;
        for (plan, row) in plans.iter().zip(&rows) {
            let report = jobs.report("run", &folder, &[plan], &[])?;
            let reserve =
                |case: usize| format!("{:.2}", number(&report["reserve"]["cases"][case]["first_failure"][1]));
            let whole = |key: &str| format!("{:.0}", number(&row[key]));
            table.row(&[
                plate.to_owned(),
                (*plan).to_owned(),
                reserve(0),
                reserve(1),
                whole("peak_load_n"),
                whole("low_n"),
                whole("high_n"),
            ]);
        }
    }
    Ok(())
}

/// A job of [`cases`], turned by an angle.
fn crossed(deg: u32, weights: Option<[f64; 2]>) -> String {
    let side = |at: [f64; 3], normal: [f64; 3]| {
        format!("{{ plane = {{ point_mm = {at:?}, normal = {normal:?}, tolerance_mm = 0.01 }} }}")
    };
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let (left, below) = (side([0.0; 3], x), side([0.0; 3], y));
    let (right, above) = (side([30.0, 0.0, 0.0], x), side([0.0, 30.0, 0.0], y));
    let [of_x, of_y] = weights.unwrap_or([1.0; 2]);
    let mix = if weights.is_some() { "weights" } else { "reserve" };
    format!(
        "[shape]\noutline = \"square.svg\"\nthickness_mm = 1.6\nrotate_deg = [0, 0, {deg}]\n\
         [material]\nprofile = \"pa-cf\"\n[process]\nwalls = 2\n[fill]\npattern = \"stripes\"\ndensity = 1.0\n\
         [guide]\nkind = \"stress\"\nframe = \"part\"\ncase_mix = \"{mix}\"\n\
         [[guide.fixture]]\non = {left}\nfix = \"normal\"\n[[guide.fixture]]\non = {below}\nfix = \"normal\"\n\
         [[guide.case]]\nname = \"pull-x\"\nweight = {of_x}\nload = [{{ on = {right}, force_n = [1000, 0, 0] }}]\n\
         [[guide.case]]\nname = \"pull-y\"\nweight = {of_y}\nload = [{{ on = {above}, force_n = [0, 1000, 0] }}]\n\
         [strength]\ncell_mm = 0.45\n"
    )
}

/// The bending bar with fields of several smoothness.
fn smoothing(jobs: &Jobs) -> Result<(), String> {
    let folder = jobs.example("stress-lines")?;
    let header = ["smoothing mm", "mean deg", "95 % within deg", "gap %", "paths a layer"];
    let table = Table::new("smoothing", &header, 1);
    for smoothing_mm in ["2", "1", "0.5", "0.25"] {
        let set = format!("guide.smoothing_mm={smoothing_mm}");
        let report = jobs.report("run", &folder, &["bending"], &[&set])?;
        let quality = &report["quality"];
        table.row(&[
            smoothing_mm.to_owned(),
            format!("{:.1}", number(&quality["alignment_mean_deg"])),
            format!("{:.0}", number(&quality["alignment_p95_deg"])),
            percent(&quality["gap"]),
            quality["paths_per_layer_max"].to_string(),
        ]);
    }
    Ok(())
}

/// Fills of given directions, measured by the outside checks.
fn fields(jobs: &Jobs) -> Result<(), String> {
    crate::setup::fields()?;
    let mut command = crate::setup::python();
    command.arg("xtask/py/direction_fields.py").arg(crate::setup::check("field")?);
    command.arg(jobs.folder.join("fields")).arg(&jobs.program);
    let header = [
        "field",
        "fill",
        "ends",
        "gap %",
        "overlap %",
        "spill %",
        "angle deg",
        "paths",
        "penalty 1e-4",
        "largest void beads",
        "voids above one bead",
    ];
    let table = Table::new("fields", &header, 3);
    for found in rows(&mut command)? {
        let word = |key: &str| found[key].as_str().unwrap_or_default().to_owned();
        // The sum has no negative zero.
        let short = |key: &str| format!("{:.1}", (10.0 * number(&found[key])).round() / 10.0 + 0.0);
        table.row(&[
            word("field"),
            word("fill"),
            word("ends"),
            short("gap"),
            short("overlap"),
            short("spill"),
            short("angle"),
            found["paths"].to_string(),
            format!("{:.1}", 1e4 * number(&found["penalty"])),
            short("largest"),
            found["voids"].to_string(),
        ]);
    }
    Ok(())
}
