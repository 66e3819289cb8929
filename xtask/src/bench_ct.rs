//! Scans to G-code in one run: directly, with the published method, and by marching cubes, STL and
//! `PrusaSlicer`.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::bench::{Cost, timed};
use crate::measured::Table;

/// A scan, the size of its voxels, its threshold, and its true dimensions.
struct Scan {
    name: &'static str,
    path: String,
    voxel_mm: f64,
    threshold: f64,
    truth: Option<String>,
}

/// Where voxels of 20 generated headers lie, beside SimpleITK.
pub fn headers() -> Result<(), String> {
    crate::setup::simple_itk()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let mut command = crate::setup::python();
    crate::run(
        command.arg("xtask/py/scan_headers.py").arg(crate::built("grainpath")).current_dir(crate::root()),
    )
}

/// Time, peak memory and size error on the hub phantom (512 x 512 x 200) and the engine block, and time
/// and memory on a stack that is larger than the memory.
pub fn run(wanted: &[&str]) -> Result<(), String> {
    let wanted = if wanted.is_empty() { &["hub", "engine", "large"][..] } else { wanted };
    crate::setup::scans()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let root = crate::root();
    let folder = root.join("target/bench/ct");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let program = crate::built("grainpath").display().to_string();
    let hub = folder.join("hub");
    crate::run(Command::new(&program).args(["new", "ct", "--pixels", "512", "--force"]).arg(&hub))?;
    let mut scans = vec![Scan {
        name: "hub",
        path: hub.join("hub.tif").display().to_string(),
        voxel_mm: 0.2,
        // Halfway between the air and the metal of the phantom.
        threshold: 23000.0,
        truth: Some(hub.join("truth.toml").display().to_string()),
    }];
    match crate::setup::data() {
        Ok(data) => {
            let path = data.join("ct/engine_256x256x128_u8.nii.gz").display().to_string();
            scans.push(Scan { name: "engine", path, voxel_mm: 0.4, threshold: 71.5, truth: None });
        }
        Err(missing) => println!("engine left out: {missing}"),
    }
    println!("\n0.2 mm layers, 2 walls, 20 % grid, one run each.\n");
    let header = [
        "scan",
        "way",
        "wall s",
        "CPU s",
        "peak MiB",
        "our wall / its",
        "our CPU / its",
        "our memory / its",
        "mean size error %",
    ];
    let table = Table::new("ct", &header, 2);
    if wanted.contains(&"large") {
        let Cost { wall_s, cpu_s, peak_mib } = large(&program, &folder)?;
        table.row(&[
            "large".to_owned(),
            "grainpath".to_owned(),
            format!("{wall_s:.1}"),
            format!("{cpu_s:.1}"),
            format!("{peak_mib:.0}"),
        ]);
    }
    for scan in scans.iter().filter(|s| wanted.contains(&s.name)) {
        let ours = straight(&program, scan, &folder, "iso")?;
        let paper = straight(&program, scan, &folder, "canny")?;
        let stl = through_stl(&program, scan, &folder)?;
        for (way, (cost, error)) in [("grainpath", &ours), ("grainpath, canny", &paper), ("STL", &stl)] {
            table.row(&[
                scan.name.to_owned(),
                way.to_owned(),
                format!("{:.2}", cost.wall_s),
                format!("{:.2}", cost.cpu_s),
                format!("{:.0}", cost.peak_mib),
                format!("{:.3}", ours.0.wall_s / cost.wall_s),
                format!("{:.3}", ours.0.cpu_s / cost.cpu_s),
                format!("{:.3}", ours.0.peak_mib / cost.peak_mib),
                error.map_or("-".into(), |e| format!("{e:.3}")),
            ]);
        }
    }
    Ok(())
}

/// Number of slices of the large stack.
const LARGE: usize = 2000;

/// 2048 x 2048 x 2000 voxels of 16 bit to G-code: 17 GB read from a folder of slices.
fn large(program: &str, folder: &Path) -> Result<Cost, String> {
    let slices = folder.join("large");
    // Seventeen gigabytes are made once; the last slice tells that the stack is complete.
    if !slices.join(format!("slice_{:04}.tif", LARGE - 1)).is_file() {
        let script = crate::root().join("xtask/py/large_stack.py");
        crate::run(crate::setup::python().arg(script).arg(&slices).arg(LARGE.to_string()))?;
    }
    let job = folder.join("large.toml");
    let text = "[shape.ct]\npath = \"large\"\npixel_mm = 0.05\nslice_mm = 0.05\n[process]\nskirt_loops = 0\n\
                [output]\ngcode = \"large.gcode\"\n";
    fs::write(&job, text).map_err(|e| format!("{}: {e}", job.display()))?;
    timed(&[program.to_owned(), "run".to_owned(), job.display().to_string()], folder)
}

type Outcome = (Cost, Option<f64>);

fn straight(program: &str, scan: &Scan, folder: &Path, contours: &str) -> Result<Outcome, String> {
    let job = folder.join(format!("{}_{contours}.toml", scan.name));
    let gcode = format!("{}_{contours}.gcode", scan.name);
    let text = format!(
        "[shape.ct]\npath = {:?}\npixel_mm = {mm}\nslice_mm = {mm}\nthreshold = {}\ncontours = {contours:?}\n\
         [printer]\nbed_mm = [400, 400, 400]\n[process]\nskirt_loops = 0\n[output]\ngcode = {gcode:?}\n",
        scan.path,
        scan.threshold,
        mm = scan.voxel_mm,
    );
    fs::write(&job, text).map_err(|e| format!("{}: {e}", job.display()))?;
    let words = [program.to_owned(), "run".to_owned(), job.display().to_string()];
    let cost = timed(&words, folder)?;
    Ok((cost, error(program, scan, &folder.join(gcode))?))
}

/// Meshing and slicing: their times are added, and the greater memory counts.
fn through_stl(program: &str, scan: &Scan, folder: &Path) -> Result<Outcome, String> {
    let script = crate::root().join("xtask/py/ct_to_stl.py").display().to_string();
    let stl = folder.join(format!("{}.stl", scan.name)).display().to_string();
    let gcode = folder.join(format!("{}_stl.gcode", scan.name));
    let numbers = [scan.threshold.to_string(), scan.voxel_mm.to_string()];
    let mesh = timed(
        &[
            crate::setup::interpreter(),
            script,
            scan.path.clone(),
            numbers[0].clone(),
            numbers[1].clone(),
            stl.clone(),
        ],
        folder,
    )?;
    let slicer = format!(
        "prusa-slicer --export-gcode --bed-shape 0x0,400x0,400x400,0x400 --max-print-height 400 --layer-height 0.2 \
         --first-layer-height 0.2 --perimeters 2 --fill-density 20% --fill-pattern grid --nozzle-diameter 0.4 \
         --extrusion-width 0.45 --perimeter-extrusion-width 0.45 --external-perimeter-extrusion-width 0.45 \
         --top-solid-layers 5 --bottom-solid-layers 4 --skirts 0 -o {} {stl}",
        gcode.display()
    );
    let words: Vec<String> = slicer.split_whitespace().map(str::to_owned).collect();
    let slice = timed(&words, folder)?;
    let cost = Cost {
        wall_s: mesh.wall_s + slice.wall_s,
        cpu_s: mesh.cpu_s + slice.cpu_s,
        peak_mib: mesh.peak_mib.max(slice.peak_mib),
    };
    Ok((cost, error(program, scan, &gcode)?))
}

/// Mean size error of the walls of a G-code file, %.
fn error(program: &str, scan: &Scan, gcode: &Path) -> Result<Option<f64>, String> {
    let Some(truth) = &scan.truth else { return Ok(None) };
    let mut command = Command::new(program);
    command.args(["inspect", "--json", "--truth", truth]).arg(gcode);
    let found: Value = serde_json::from_str(&crate::output(&mut command)?).map_err(|e| e.to_string())?;
    Ok(found["dimensions"]["mean_error_percent"].as_f64())
}
