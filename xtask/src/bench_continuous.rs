//! One path a layer: its angle to the stress, the gaps it leaves, and its time over the number of cells.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench_paths::{field_of_bar, row, table};
use crate::measured::Table;

/// Numbers of cells of the plates that are timed.
const CELLS: [f64; 4] = [1e3, 1e4, 1e5, 1e6];
const BEAD_MM: f64 = 0.45;
const HEIGHT_MM: f64 = 0.2;

/// Three tables. The tensile bar with beads of varying and of constant width, and with cells joined
/// without regard to the field. The same for sections of test meshes, beside `stripes` and the least
/// angle that any closed path can have. The fill of one layer of plates of a thousand to a million cells
/// on one core.
pub fn run() -> Result<(), String> {
    crate::setup::bench()?;
    crate::setup::fea()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let root = crate::root();
    let folder = root.join("target/bench/continuous");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let grainpath = crate::built("grainpath");
    crate::run(
        Command::new(&grainpath).args(["new", "--force", "stress-lines"]).arg(&folder).stdout(Stdio::null()),
    )?;
    let field = field_of_bar(&folder)?;
    let paths = table("continuous");
    for (name, more) in [
        ("variable", ["fill.widths=variable", "fill.tree=directed"]),
        ("constant", ["fill.widths=constant", "fill.tree=directed"]),
        ("undirected", ["fill.widths=variable", "fill.tree=undirected"]),
    ] {
        let out = folder.join(name);
        let mut command = Command::new(&grainpath);
        command.args(["run", "--json", "--set", "process.skirt_loops=0", "--set", "process.walls=0"]);
        command.args(["--set", "fill.pattern=continuous", "--set", more[0], "--set", more[1], "--out"]);
        let text = crate::output(command.arg(&out).arg(folder.join("tension.toml")))?;
        let gcode = out.join("out/tension.gcode");
        row(&paths, "tensile bar", name, &text, &gcode, &folder.join("tension.stl"), &field)?;
    }
    for smoothing_mm in ["0.5", "0.25"] {
        sections(&grainpath, &folder, smoothing_mm)?;
    }
    let header = ["shape", "cells", "plate mm", "fill s", "s for 100 000 cells", "peak MB"];
    let table = Table::new("continuous", &header, 2);
    CELLS.iter().try_for_each(|&cells| plate(&grainpath, &folder, cells, &table))
}

/// Sections of the test meshes; the numbers are those of the job's own report.
fn sections(grainpath: &Path, folder: &Path, smoothing_mm: &str) -> Result<(), String> {
    let meshes = match crate::setup::data() {
        Ok(data) => data.join("meshes"),
        Err(missing) => {
            println!("\nsections left out: {missing}");
            return Ok(());
        }
    };
    let python = |args: &[&std::ffi::OsStr]| {
        crate::output(crate::setup::python().arg(crate::root().join("xtask/py/sections.py")).args(args))
    };
    let names = python(&["write".as_ref(), meshes.as_os_str(), folder.as_os_str()])?;
    let header = [
        "smoothing",
        "section",
        "islands",
        "paths",
        "mean deg",
        "turns, square and round",
        "stripes",
        "undirected",
        "better by %",
        "filled %",
        "filled %, one width",
    ];
    let table = Table::new("continuous", &header, 2);
    for line in names.lines() {
        let (name, islands) = line.split_once(' ').unwrap_or((line, ""));
        let job = folder.join(name).with_extension("toml");
        let quality = |set: &str| -> Result<Value, String> {
            let smoothing = format!("guide.smoothing_mm={smoothing_mm}");
            let mut command = Command::new(grainpath);
            command.args(["run", "--json", "--set", &smoothing, "--set", set]).arg(&job);
            let report: Value =
                serde_json::from_str(&crate::output(&mut command)?).map_err(|e| format!("{name}: {e}"))?;
            Ok(report["quality"].clone())
        };
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
        let [one, constant, undirected, stripes] =
            ["fill.widths=variable", "fill.widths=constant", "fill.tree=undirected", "fill.pattern=stripes"]
                .map(quality);
        let (one, constant, undirected, stripes) = (one?, constant?, undirected?, stripes?);
        let angle = |q: &Value| number(&q["alignment_mean_deg"]);
        let filled = |q: &Value| 100.0 * (1.0 - number(&q["gap"]));
        let turns = python(&["turns".as_ref(), folder.as_os_str(), name.as_ref()])?;
        table.row(&[
            format!("{smoothing_mm} mm"),
            name.to_owned(),
            islands.to_owned(),
            one["paths_per_layer_max"].to_string(),
            format!("{:.1}", angle(&one)),
            turns.trim().to_owned(),
            format!("{:.1}", angle(&stripes)),
            format!("{:.1}", angle(&undirected)),
            format!("{:.0}", 100.0 * (1.0 - angle(&one) / angle(&undirected))),
            format!("{:.1}", filled(&one)),
            format!("{:.1}", filled(&constant)),
        ]);
    }
    Ok(())
}

/// A square plate of one layer, held at one corner and pulled at its right side.
fn plate(grainpath: &Path, folder: &Path, cells: f64, table: &Table) -> Result<(), String> {
    // Source: the rounded bead of slicers: neighbours overlap by height (1 - pi / 4), so that the section
    // equals the flow.
    let spacing = BEAD_MM - HEIGHT_MM * (1.0 - std::f64::consts::FRAC_PI_4);
    // A cell is 2 x 5 beads, hence ten squares of the spacing.
    let side = (10.0 * spacing * spacing * cells).sqrt();
    let mesh = folder.join("square.stl");
    let script =
        "import sys, trimesh; a = float(sys.argv[2]); trimesh.creation.box((a, a, 0.2)).export(sys.argv[1])";
    crate::run(
        crate::setup::python().args(["-c", script]).arg(&mesh).arg(format!("{side}")).stdout(Stdio::null()),
    )?;
    let (half, tenth, bed) = (0.5 * side, 0.1 * side, side + 20.0);
    let job = folder.join("square.toml");
    let text = format!(
        "[shape]\nmesh = \"square.stl\"\n[printer]\nbed_mm = [{bed}, {bed}, 100]\n[process]\nwalls = 0\nskirt_loops = 0\n\
         [fill]\npattern = \"continuous\"\ndensity = 1.0\n[guide]\nkind = \"stress\"\nelement_mm = {}\n[[guide.fixture]]\n\
         on = {{ box_mm = [[-{bed}, -{bed}, 0], [{}, {}, 9]] }}\nfix = \"xyz\"\n[[guide.load]]\n\
         on = {{ plane = {{ point_mm = [{half}, 0, 0], normal = [1, 0, 0] }} }}\nforce_n = [100, -300, 0]\n",
        side / 60.0,
        tenth - half,
        tenth - half
    );
    fs::write(&job, text).map_err(|e| format!("{}: {e}", job.display()))?;
    let text = crate::output(Command::new(grainpath).args(["run", "--json", "--threads", "1"]).arg(&job))?;
    let report: Value = serde_json::from_str(&text).map_err(|e| format!("plate: {e}"))?;
    let seconds = report["stages_s"]["fill"].as_f64().unwrap_or(f64::NAN);
    table.row(&[
        "plate".to_owned(),
        cells.to_string(),
        format!("{side:.0}"),
        format!("{seconds:.2}"),
        format!("{:.2}", seconds * 1e5 / cells),
        report["peak_rss_mb"].to_string(),
    ]);
    Ok(())
}
