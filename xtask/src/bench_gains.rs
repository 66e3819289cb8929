//! What the virtual strength test gives for settings beside the pattern: several beads side by side (`fill.lines`),
//! staggered and extra walls at equal mass (`lines`), the poses of a bracket (`poses`), and plates with graded density
//! beside solids of the same beads and beside `CalculiX` (`stiffness`).
//!
//! Numbers depend on the machine through rounding alone, so the `ci` profile does. Cost: about 10 minutes a part of the
//! bench on two cores.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench_jobs::{Jobs, Part, number, percent, run_parts};
use crate::bench_strength::gain;
use crate::measured::Table;

const PARTS: [Part; 3] = [("lines", lines), ("poses", poses), ("stiffness", stiffness)];

/// The named parts, or all.
pub fn run(wanted: &[&str]) -> Result<(), String> {
    run_parts("gains", &PARTS, wanted)
}

/// What all pieces of [`lines`] share: sparse infill, with walls and infill of about equal weight.
const SPARSE: [&str; 8] = [
    "guide.kind=stress",
    "process.top_layers=2",
    "process.bottom_layers=2",
    "process.skirt_loops=0",
    "fill.pattern=grid",
    "fill.angles_deg=[45, -45]",
    "strength.cell_mm=0.45",
    "material.profile=pla",
];
/// The plan that others are held against.
const PLAIN: [&str; 2] = ["process.walls=2", "fill.density=0.3"];
/// What is held against it at its mass, each with what it is called.
const EXTRAS: [(&str, &[&str]); 6] = [
    ("2 beads a line", &["process.walls=2", "fill.lines=2"]),
    ("3 beads a line", &["process.walls=2", "fill.lines=3"]),
    ("staggered walls", &["process.walls=2", "process.stagger_walls=true"]),
    ("3 walls", &["process.walls=3"]),
    ("4 walls", &["process.walls=4"]),
    ("2 to 4 walls by stress", &["process.walls={ min = 2, max = 4, by = \"stress\" }"]),
];
/// Pieces of standards: two drawn along the layers, one bent within them.
const PIECES: [&str; 3] = ["iso527-1b", "d5766", "s2-bending"];

/// Lines of several beads, staggered walls and extra walls at equal mass.
fn lines(jobs: &Jobs) -> Result<(), String> {
    let header =
        ["piece", "plan", "mass g", "peak N", "low N", "high N", "gain %", "gain low %", "gain high %"];
    let table = Table::new("gains", &header, 2);
    let row = |piece: &str, plan: &str, found: &Value, plain: &Value| {
        let whole = |key: &str| format!("{:.0}", number(&found[key]));
        let [nominal, low, high] = gain(found, plain).map(|g| format!("{g:+.1}"));
        let mass = format!("{:.2}", number(&found["mass_g"]));
        let [peak, least, most] = ["peak_load_n", "low_n", "high_n"].map(whole);
        table.row(&[piece.to_owned(), plan.to_owned(), mass, peak, least, most, nominal, low, high]);
    };
    for piece in PIECES {
        let mesh = jobs.folder.join(piece).with_extension("stl");
        let mut command = Command::new(&jobs.program);
        crate::run(command.args(["specimen", piece, "-o"]).arg(&mesh).stdout(Stdio::null()))?;
        let test = |sets: &[&str]| -> Result<Value, String> {
            Ok(jobs.report("strength", &jobs.folder, &[piece], &[&SPARSE[..], sets].concat())?["strength"]
                .clone())
        };
        let plain = test(&PLAIN)?;
        row(piece, "2 walls, 1 bead a line", &plain, &plain);
        let mass = format!("fill.mass_g={}", number(&plain["mass_g"]));
        for (what, sets) in EXTRAS {
            row(piece, what, &test(&[sets, &[mass.as_str()]].concat())?, &plain);
        }
    }
    Ok(())
}

/// The first three poses of the bracket by `grainpath orient`, and the break test of each.
fn poses(jobs: &Jobs) -> Result<(), String> {
    let folder = jobs.example("stress-lines")?;
    let frame = "guide.frame=part";
    let found = jobs.report("orient", &folder, &["bracket"], &[frame])?;
    let poses = found["poses"].as_array().ok_or("orient without poses")?;
    let header = [
        "pose",
        "rotate deg",
        "reserve",
        "reserve low",
        "reserve high",
        "of the plan",
        "of the plan low",
        "of the plan high",
        "first failure",
        "peak",
        "peak low",
        "peak high",
        "support g",
        "height mm",
        "fails mostly",
    ];
    let table = Table::new("poses", &header, 1);
    for (k, pose) in poses.iter().take(3).enumerate() {
        let rotation = format!("shape.rotate_deg={}", pose["rotate_deg"]);
        let sets = [frame, rotation.as_str(), "strength.cell_mm=0.9", "strength.check=false"];
        let tested = jobs.report("strength", &folder, &["bracket"], &sets)?["strength"].clone();
        let planned = jobs.report("run", &folder, &["bracket"], &sets)?;
        let factor = |key: &str| format!("{:.2}", number(&tested[key]) / number(&tested["job_load_n"]));
        let of = |report: &Value, i: usize| format!("{:.2}", number(&report["reserve"]["first_failure"][i]));
        let [reserve, plan] = [pose, &planned].map(|report| move |i: usize| of(report, i));
        table.row(&[
            (k + 1).to_string(),
            pose["rotate_deg"].to_string(),
            reserve(1),
            reserve(0),
            reserve(2),
            plan(1),
            plan(0),
            plan(2),
            factor("first_n"),
            factor("peak_load_n"),
            factor("low_n"),
            factor("high_n"),
            format!("{:.2}", number(&pose["support_g"])),
            format!("{:.1}", number(&pose["height_mm"])),
            tested["mode"].as_str().unwrap_or_default().to_owned(),
        ]);
    }
    Ok(())
}

/// A bar bent in its plane with graded density: as a plate, whose layers are homogenised through the thickness, as a solid
/// of cells of a bead, and as the deck that `strength --deck` writes of the plate, solved by `CalculiX`.
fn stiffness(jobs: &Jobs) -> Result<(), String> {
    crate::setup::fea()?;
    write_bar(&jobs.folder)?;
    let header = [
        "pattern",
        "mass g",
        "plate N/mm",
        "solid N/mm",
        "CalculiX N/mm",
        "plate over solid %",
        "plate over CalculiX %",
    ];
    let table = Table::new("stiffness", &header, 1);
    for pattern in ["rectilinear", "grid", "gyroid", "stripes"] {
        let pattern_set = format!("fill.pattern={pattern}");
        let deck = jobs.folder.join(format!("{pattern}.inp"));
        let tested = |fidelity: &str, options: &[&OsStr]| -> Result<Value, String> {
            let sets = [pattern_set.as_str(), &format!("strength.fidelity={fidelity}")];
            let found = jobs.report_with("strength", &jobs.folder, &["graded-bar"], &sets, options)?;
            Ok(found["strength"].clone())
        };
        let plate = tested("plane", &["--deck".as_ref(), deck.as_os_str()])?;
        let solid = tested("voxels", &[])?;
        let [of_plate, of_solid] = [&plate, &solid].map(|s| number(&s["stiffness_n_per_mm"]));
        let of_peer = calculix_n_per_mm(&deck, number(&plate["job_load_n"]))?;
        table.row(&[
            pattern.to_owned(),
            format!("{:.2}", number(&plate["mass_g"])),
            format!("{of_plate:.1}"),
            format!("{of_solid:.1}"),
            format!("{of_peer:.1}"),
            percent(&Value::from(of_plate / of_solid - 1.0)),
            format!("{:+.2}", 100.0 * (of_plate / of_peer - 1.0)),
        ]);
    }
    Ok(())
}

/// Load over the displacement along it that `CalculiX` finds for a deck: the load squared over the work of all forces, N/mm.
fn calculix_n_per_mm(deck: &Path, load_n: f64) -> Result<f64, String> {
    let read = |path: &Path| fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()));
    // CalculiX leaves a log in the folder where it runs.
    let folder = deck.parent().unwrap_or(Path::new("."));
    crate::output(Command::new("ccx").arg(deck.with_extension("")).current_dir(folder))?;
    // Rows of numbers: node and axis beside a force, node beside displacements.
    let rows = |text: &str, separator: fn(char) -> bool, n: usize| -> Vec<Vec<f64>> {
        let row = |line: &str| {
            line.split(separator)
                .filter(|w| !w.is_empty())
                .map(str::parse)
                .collect::<Result<Vec<f64>, _>>()
                .ok()
        };
        text.lines().filter_map(row).filter(|row| row.len() == n).collect()
    };
    let text = read(deck)?;
    let forces = text.split("*CLOAD\n").nth(1).and_then(|rest| rest.split('*').next()).unwrap_or_default();
    let forces = rows(forces, |c| c == ',' || c == ' ', 3);
    let moved = rows(&read(&deck.with_extension("dat"))?, char::is_whitespace, 4);
    let moved: BTreeMap<u64, &Vec<f64>> = moved.iter().map(|row| (row[0] as u64, row)).collect();
    let work = forces.iter().map(|force| {
        let at = moved.get(&(force[0] as u64)).and_then(|row| row.get(force[1] as usize));
        at.map_or(f64::NAN, |mm| mm * force[2])
    });
    Ok(load_n * load_n / work.sum::<f64>())
}

/// Writes the bar of [`stiffness`].
fn write_bar(folder: &Path) -> Result<(), String> {
    let files = [
        (
            "graded-bar.svg",
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60mm\" height=\"20mm\" viewBox=\"0 0 60 20\">\
             <path d=\"M0 0H60V20H0Z\"/></svg>\n",
        ),
        (
            "graded-bar.toml",
            "[shape]\noutline = \"graded-bar.svg\"\nthickness_mm = 4.5\n[material]\nprofile = \"pla\"\n\
             [process]\nlayer_height_mm = 0.3\nwalls = 1\ntop_layers = 1\nbottom_layers = 1\nskirt_loops = 0\n\
             [guide]\nkind = \"stress\"\n[[guide.fixture]]\non = { box_mm = [[0, 0, 0], [3, 20, 5]] }\nfix = \"xyz\"\n\
             [[guide.load]]\non = { box_mm = [[57, 0, 0], [60, 20, 5]] }\nforce_n = [0, -100, 0]\n\
             [fill]\ndensity = { min = 0.15, max = 0.9, by = \"stress\" }\n\
             [strength]\ncell_mm = 0.45\ncorners = false\ncheck = false\n",
        ),
    ];
    files.iter().try_for_each(|(name, text)| {
        fs::write(folder.join(name), text).map_err(|e| format!("{}: {e}", folder.join(name).display()))
    })
}
