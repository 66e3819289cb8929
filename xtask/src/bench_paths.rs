//! Paths compared with principal stresses that another solver found.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::measured::Table;

/// The machined bracket of the data, with the conditions of its CalculiX result: held at least x, 500 N
/// down at greatest x.
const BRACKET: &str = "
[process]
walls = 1
skirt_loops = 0
[guide]
kind = \"stress\"
analysis = \"solid\"
element_mm = 2.5
[[guide.fixture]]
on = { plane = { point_mm = [LOW, 0, 0], normal = [1, 0, 0] } }
fix = \"xyz\"
[[guide.load]]
on = { plane = { point_mm = [HIGH, 0, 0], normal = [1, 0, 0] } }
force_n = [0, 0, -500]
[fill]
density = 1.0
";

/// The table whose lines [`row`] prints.
pub fn table(bench: &'static str) -> Table {
    let header = [
        "part",
        "fill",
        "seconds",
        "mean deg",
        "within 15 deg %",
        "gap %",
        "overlap %",
        "spill %",
        "widths mm",
    ];
    Table::new(bench, &header, 2)
}

/// Plans the tensile bar and the bracket, and prints the angles between their fill and CalculiX's
/// principal stresses, with gap, overlap and spill from the outside check.
pub fn run() -> Result<(), String> {
    let root = crate::root();
    let data = crate::setup::data()?;
    crate::setup::bench()?;
    crate::setup::fea()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let folder = root.join("target/bench/paths");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let grainpath = crate::built("grainpath");
    crate::run(
        Command::new(&grainpath).args(["new", "--force", "stress-lines"]).arg(&folder).stdout(Stdio::null()),
    )?;

    let field = field_of_bar(&folder)?;
    let paths = table("paths");
    for job in ["tension", "tension-seed-lines", "tension-0", "tension-90"] {
        let text = crate::output(
            Command::new(&grainpath)
                .args(["run", "--json", "--set", "process.skirt_loops=0"])
                .arg(folder.join(job).with_extension("toml")),
        )?;
        row(
            &paths,
            "tensile bar",
            job,
            &text,
            &folder.join("out").join(job).with_extension("gcode"),
            &folder.join("tension.stl"),
            &field,
        )?;
    }

    speed(&grainpath, &folder)?;
    let paths = table("paths");

    let field = folder.join("bracket.npz");
    python(&["vtu".as_ref(), data.join("fea/bracket.vtu").as_path(), field.as_path()])?;
    let mesh = folder.join("bracket_mm.stl");
    // The mesh of the data is in inches.
    let script = "import sys, trimesh; m = trimesh.load(sys.argv[1]); m.apply_scale(25.4); m.export(sys.argv[2]); \
                  print(m.bounds[0][0], m.bounds[1][0])";
    let bounds = crate::output(
        crate::setup::python().args(["-c", script]).arg(data.join("meshes/featuretype_inch.stl")).arg(&mesh),
    )?;
    let mut ends = bounds.split_whitespace();
    let (low, high) = (ends.next().unwrap_or("0"), ends.next().unwrap_or("0"));
    let job = BRACKET.replace("LOW", low).replace("HIGH", high);
    for pattern in ["stripes", "seed-lines"] {
        let path = folder.join(format!("bracket_{pattern}.toml"));
        let text = format!(
            "[shape]\nmesh = \"bracket_mm.stl\"\n[output]\ngcode = \"bracket_{pattern}.gcode\"\n{job}pattern = \"{pattern}\"\n"
        );
        fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        let text = crate::output(Command::new(&grainpath).args(["run", "--json"]).arg(&path))?;
        row(&paths, "bracket", pattern, &text, &path.with_extension("gcode"), &mesh, &field)?;
    }
    Ok(())
}

/// Seconds on one core for a plate of 100 x 100 mm: stress, field and dense fill of one layer and of ten
/// equal layers, beside rectilinear fill; and a solve of 200 000 unknowns.
fn speed(grainpath: &Path, folder: &Path) -> Result<(), String> {
    let script = "import sys, trimesh; m = trimesh.creation.box((100, 100, float(sys.argv[2]))); m.export(sys.argv[1])";
    println!("\n| job, one core | layers | unknowns | guide s | fill s |\n|---|---|---|---|---|");
    // Ten equal layers show whether the stress and the field are computed once or ten times.
    for (layers, pattern, element) in [
        (1, "stripes", "2"),
        (10, "stripes", "2"),
        (1, "aligned", "2"),
        (10, "aligned", "2"),
        (1, "aligned", "0.85"),
    ] {
        let mesh = folder.join("plate100.stl");
        let height = format!("{}", 0.2 * f64::from(layers));
        crate::run(
            crate::setup::python().args(["-c", script]).arg(&mesh).arg(&height).stdout(Stdio::null()),
        )?;
        let job = folder.join("plate100.toml");
        let text = format!(
            "[shape]\nmesh = \"plate100.stl\"\n[fill]\npattern = \"{pattern}\"\ndensity = 1.0\n[guide]\nkind = \"stress\"\n\
             element_mm = {element}\n[[guide.fixture]]\non = {{ box_mm = [[-51, -51, 0], [-20, -49, 9]] }}\nfix = \"xyz\"\n\
             [[guide.load]]\non = {{ plane = {{ point_mm = [50, 0, 0], normal = [1, 0, 0] }} }}\nforce_n = [100, -300, 0]\n"
        );
        fs::write(&job, text).map_err(|e| format!("{}: {e}", job.display()))?;
        let text =
            crate::output(Command::new(grainpath).args(["run", "--json", "--threads", "1"]).arg(&job))?;
        let report: Value = serde_json::from_str(&text).map_err(|e| format!("plate: {e}"))?;
        println!(
            "| plate 100 x 100, {pattern} | {layers} | {} | {} | {} |",
            report["stress"]["dofs"], report["stages_s"]["guide"], report["stages_s"]["fill"]
        );
    }
    Ok(())
}

/// The principal stresses of the tensile bar, from gmsh and CalculiX.
pub fn field_of_bar(folder: &Path) -> Result<PathBuf, String> {
    let field = folder.join("bar.npz");
    python(&["bar".as_ref(), folder, field.as_path()])?;
    Ok(field)
}

fn python(args: &[&Path]) -> Result<(), String> {
    crate::run(crate::setup::python().arg(crate::root().join("xtask/py/principal_field.py")).args(args))
}

/// Seconds, angles and shares of one plan, as the outside check finds them.
pub fn row(
    table: &Table,
    part: &str,
    fill: &str,
    report: &str,
    gcode: &Path,
    mesh: &PathBuf,
    field: &Path,
) -> Result<(), String> {
    let report: Value = serde_json::from_str(report).map_err(|e| format!("{fill}: {e}"))?;
    let seconds: f64 = ["guide", "fill"].iter().filter_map(|s| report["stages_s"][s].as_f64()).sum();
    let check = crate::setup::check("gcode_check.py")?;
    let mut command = crate::setup::python();
    command.arg(check).arg(gcode).arg("--mesh").arg(mesh).arg("--field").arg(field).arg("--infill-only");
    let found: Value =
        serde_json::from_str(&crate::output(&mut command)?).map_err(|e| format!("gcode_check.py: {e}"))?;
    let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
    let (angle, against) = (&found["alignment"], &found["against_mesh"]);
    let percent = |key: &str| format!("{:.2}", 100.0 * number(&against[key]));
    table.row(&[
        part.to_owned(),
        fill.to_owned(),
        format!("{seconds:.1}"),
        format!("{:.2}", number(&angle["mean_deg"])),
        format!("{:.1}", 100.0 * number(&angle["within_15_deg"])),
        percent("gap"),
        percent("overlap"),
        percent("spill"),
        report["quality"]["bead_width_mm"].to_string(),
    ]);
    Ok(())
}
