//! Our programs beside the peers: the same parts and settings, one after the other in one run, reported
//! as ratios.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::measured::Table;

/// Cost of one program for one part.
#[derive(Clone, Copy)]
pub struct Cost {
    /// Wall time.
    pub wall_s: f64,
    /// Processor time.
    pub cpu_s: f64,
    /// Highest memory held.
    pub peak_mib: f64,
}

/// Runs a program once and measures it.
pub fn timed(words: &[String], folder: &Path) -> Result<Cost, String> {
    timed_output(Command::new(&words[0]).args(&words[1..]), folder).map(|(cost, _)| cost)
}

/// Runs a command once; its cost and its output.
pub fn timed_output(command: &mut Command, folder: &Path) -> Result<(Cost, String), String> {
    let timing = folder.join("time.txt");
    // GNU time reads the peak memory from the system when the child ends; sampling from outside would
    // miss short peaks.
    let mut time = Command::new("time");
    time.args(["-f", "%e %U %S %M", "-o"]).arg(&timing).arg(command.get_program()).args(command.get_args());
    // The command is rebuilt as arguments of `time`, so environment and folder are carried over.
    for (key, value) in command.get_envs() {
        if let Some(value) = value {
            time.env(key, value);
        }
    }
    if let Some(at) = command.get_current_dir() {
        time.current_dir(at);
    }
    let out = time.output().map_err(|e| format!("cannot start `time`: {e}"))?;
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    if !out.status.success() {
        let said = format!("{text}\n{}", String::from_utf8_lossy(&out.stderr));
        // Three lines name the error; peers print pages.
        let last = said.lines().rev().take(3).collect::<Vec<_>>().join(" | ");
        return Err(format!("{command:?} ended with {}: {last}", out.status));
    }
    let found = fs::read_to_string(&timing).map_err(|e| format!("{}: {e}", timing.display()))?;
    let mut numbers = found.split_whitespace().filter_map(|w| w.parse::<f64>().ok());
    let mut next = || numbers.next().unwrap_or(f64::NAN);
    let (wall_s, user_s, system_s, kib) = (next(), next(), next(), next());
    Ok((Cost { wall_s, cpu_s: user_s + system_s, peak_mib: kib / 1024.0 }, text))
}

/// The JSON objects that a script prints, one a line; what it tells on standard error is seen while it runs.
pub fn rows(script: &mut Command) -> Result<Vec<Value>, String> {
    let text = crate::output(script.current_dir(crate::root()).stderr(Stdio::inherit()))?;
    text.lines()
        .map(|line| serde_json::from_str(line).map_err(|e| format!("{script:?}: {line}: {e}")))
        .collect()
}

/// Programs in the order of the tables.
pub const PROGRAMS: [&str; 3] = ["grainpath", "prusa-slicer", "CuraEngine"];
// Best of three: other programs on the machine only ever add time.
const RUNS: usize = 3;

/// Wall time and peak memory with layers of 0.2 mm, 2 walls and 20 % grid.
pub fn slicing(parts: &[&str]) -> Result<(), String> {
    let bench = Bench::prepare()?;
    let all = ["benchy", "bunny", "armadillo", "plate_holes", "skull"];
    let parts = if parts.is_empty() { &all[..] } else { parts };
    println!(
        "\n{RUNS} runs each (skull: 1), best wall time and highest peak. 0.2 mm layers, 2 walls, 20 % grid.\n"
    );
    let table = Table::new(
        "slicing",
        &["part", "program", "wall s", "peak MiB", "our time / its", "our memory / its", "travel m"],
        2,
    );
    for &part in parts {
        let mut ours = None;
        for program in PROGRAMS {
            let Some((cost, gcode)) = bench.cost(program, part, 0.2)? else { continue };
            let ours = *ours.get_or_insert(cost);
            let travel = bench.measure(&gcode, None)?["travel_mm"].as_f64().unwrap_or(f64::NAN) / 1e3;
            table.row(&[
                part.to_owned(),
                program.to_owned(),
                format!("{:.2}", cost.wall_s),
                format!("{:.0}", cost.peak_mib),
                format!("{:.2}", ours.wall_s / cost.wall_s),
                format!("{:.2}", ours.peak_mib / cost.peak_mib),
                format!("{travel:.1}"),
            ]);
        }
    }
    Ok(())
}

/// Closed meshes that are sliced and measured in minutes, and parts of our own: stars, whose sides meet the lines at flat
/// angles, and pipes, whose walls are no whole number of beads.
const QUALITY_PARTS: [&str; 27] = [
    "plate_holes",
    "featuretype",
    "hinge",
    "screw",
    "box",
    "letter_a",
    "anchor",
    "tardis",
    "lattice",
    "cura_test",
    "text",
    "idler",
    "goblet",
    "idler_riser",
    "knots",
    "overhang",
    "part1",
    "pinion",
    "rotor",
    "sloping_hole",
    "spikey_top",
    "cow",
    "u_overhang",
    "star",
    "star_blunt",
    "twisted_pipes",
    "thin_pipes",
];

/// Gap, spill and overlap with 100 % rectilinear fill, measured by the outside check.
pub fn quality(parts: &[&str]) -> Result<(), String> {
    let bench = Bench::prepare()?;
    let parts = if parts.is_empty() { &QUALITY_PARTS[..] } else { parts };
    println!("\n100 % rectilinear; shares of the part's area in %.\n");
    let table = Table::new(
        "quality",
        &["part", "program", "gap", "spill", "overlap", "volume / mesh", "travel m"],
        2,
    );
    for &part in parts {
        for program in PROGRAMS {
            let Some((_, gcode)) = bench.cost(program, part, 1.0)? else { continue };
            let found = bench.measure(&gcode, Some(&bench.mesh(part)))?;
            let against = &found["against_mesh"];
            let percent = |key: &str| 100.0 * against[key].as_f64().unwrap_or(f64::NAN);
            let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
            table.row(&[
                part.to_owned(),
                program.to_owned(),
                format!("{:.2}", percent("gap")),
                format!("{:.2}", percent("spill")),
                format!("{:.2}", percent("overlap")),
                format!("{:.3}", number(&found["part_mm3"]) / number(&against["mesh_mm3"])),
                format!("{:.1}", number(&found["travel_mm"]) / 1e3),
            ]);
        }
    }
    Ok(())
}

/// Grams and hours of support on the parts of `docs/support.md`, beside our baselines and the peers; speed on the skull.
pub fn support(parts: &[&str]) -> Result<(), String> {
    let bench = Bench::prepare()?;
    let ours = crate::built("grainpath");
    for (specimen, name) in [("hanging-ball", "ball"), ("dental-tray", "tray")] {
        crate::run(Command::new(&ours).args(["specimen", specimen, "-o"]).arg(bench.mesh(name)))?;
    }
    fs::write(bench.mesh("table"), table()).map_err(|e| format!("table.stl: {e}"))?;
    let all = ["table", "ball", "tray", "bone", "featuretype", "armadillo100", "skull"];
    let parts = if parts.is_empty() { &all[..] } else { parts };
    println!(
        "\nCritical angle 40 deg, 0.2 mm layers, 2 walls, 15 % grid; support alone, and the whole print.\n"
    );
    // Grams compare fairly only where the part is held equally well, so the length that is not held stands beside them.
    let header =
        ["part", "program", "support g", "whole g", "print min", "over air mm", "wall s", "peak MiB"];
    let table = Table::new("support", &header, 2);
    let mut equal = Vec::new();
    for &part in parts {
        let mut rows: Vec<SupportRow> = Vec::new();
        for (k, supporter) in SUPPORTERS.iter().enumerate() {
            let name = supporter.name;
            // The peers take many minutes for supports of the skull.
            if part == "skull" && k > 0 {
                continue;
            }
            let out = bench.folder.join(format!("support_{k}_{part}.gcode"));
            let Some(words) = bench.support_command(supporter, part, &out) else { continue };
            let cost = timed(&words, &bench.folder)?;
            let mut command = crate::setup::python();
            command.arg("xtask/py/support_mass.py").arg(&out).current_dir(crate::root());
            let found: Value =
                serde_json::from_str(&crate::output(&mut command)?).map_err(|e| e.to_string())?;
            let mut command = Command::new(&ours);
            let inspected = crate::output(command.args(["inspect", "--json"]).arg(&out))?;
            let inspected: Value = serde_json::from_str(&inspected).map_err(|e| e.to_string())?;
            let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
            let row = SupportRow {
                name,
                peer: supporter.program != SUPPORTERS[0].program,
                grams: number(&found["support_g"]),
                over_air_mm: not_held(&out)?,
            };
            table.row(&[
                part.to_owned(),
                name.to_owned(),
                format!("{:.2}", row.grams),
                format!("{:.2}", number(&found["total_g"])),
                format!("{:.0}", number(&inspected["time_s"]) / 60.0),
                row.over_air_mm.to_string(),
                format!("{:.2}", cost.wall_s),
                format!("{:.0}", cost.peak_mib),
            ]);
            rows.push(row);
        }
        equal.extend(equal_held(part, &rows));
    }
    println!("\nGrams at equal held length: the leanest peer with no more over air than our trees.");
    let header =
        ["part", "trees g", "over air mm", "leanest peer", "peer g", "peer over air mm", "trees / peer"];
    let table = Table::new("support-equal", &header, 1);
    equal.iter().for_each(|row| table.row(row));
    println!("\nOur trees under the drag of the nozzle (`support.side_load_n`):");
    let table = Table::new("support-tips", &["part", "contacts", "furthest tip mm"], 1);
    for &part in parts {
        let mut command = Command::new(&ours);
        command.args(["slice", "--json", "--set", "support.style=tree", "--set", "fill.density=0.15", "-o"]);
        command.arg(bench.folder.join("tips.gcode")).arg(bench.mesh(part));
        let found: Value = serde_json::from_str(&crate::output(&mut command)?).map_err(|e| e.to_string())?;
        let number = |name: &str| found["support"][name].as_f64().unwrap_or(f64::NAN);
        table.row(&[
            part.to_owned(),
            format!("{:.0}", number("contacts")),
            format!("{:.3}", number("tip_moves_mm")),
        ]);
    }
    println!("\nTime over the number of contacts (armadillo, L from 12 to 1.2 mm), `grainpath support`:");
    let table = Table::new("support-contacts", &["L mm", "contacts", "support s"], 1);
    for l in ["12", "6", "3", "1.8", "1.2"] {
        let mut command = Command::new(&ours);
        command.args(["support", "--json", "--set", &format!("support.max_unsupported_mm={l}"), "-o"]);
        command.arg(bench.folder.join("scale.stl")).arg(bench.mesh("armadillo100"));
        let found: Value = serde_json::from_str(&crate::output(&mut command)?).map_err(|e| e.to_string())?;
        let (contacts, seconds) = (&found["support"]["contacts"], &found["stages_s"]["support"]);
        table.row(&[l.to_owned(), contacts.to_string(), seconds.to_string()]);
    }
    Ok(())
}

/// A maker of supports with its settings.
struct Supporter {
    name: &'static str,
    program: &'static str,
    settings: &'static str,
}

/// What one maker of supports needs for a part.
struct SupportRow {
    name: &'static str,
    peer: bool,
    grams: f64,
    over_air_mm: f64,
}

/// Makers of supports, in the order of the tables; our trees are the first. Every peer has its defaults and leaner
/// settings, so that a peer is not charged for support that the part does not need (docs/support.md tells which were
/// tried).
const SUPPORTERS: [Supporter; 10] = [
    Supporter { name: "grainpath tree", program: "grainpath", settings: "--set support.style=tree" },
    Supporter { name: "grainpath columns", program: "grainpath", settings: "--set support.style=columns" },
    Supporter { name: "grainpath box", program: "grainpath", settings: "--set support.style=box" },
    Supporter {
        name: "PrusaSlicer snug",
        program: "prusa-slicer",
        settings: "--support-material-style snug",
    },
    Supporter {
        name: "PrusaSlicer snug 9 mm, one dense interface layer",
        program: "prusa-slicer",
        settings: "--support-material-style snug --support-material-spacing 9 --no-support-material-with-sheath \
                   --support-material-interface-layers 1 --support-material-interface-spacing 0.2",
    },
    Supporter {
        name: "PrusaSlicer snug 9 mm, one open interface layer",
        program: "prusa-slicer",
        settings: "--support-material-style snug --support-material-spacing 9 --no-support-material-with-sheath \
                   --support-material-interface-layers 1 --support-material-interface-spacing 4",
    },
    Supporter {
        name: "PrusaSlicer snug 7 mm, no interface",
        program: "prusa-slicer",
        settings: "--support-material-style snug --support-material-spacing 7 --no-support-material-with-sheath \
                   --support-material-interface-layers 0",
    },
    Supporter {
        name: "CuraEngine tree",
        program: "CuraEngine",
        settings: "-s support_structure=tree -s support_line_distance=0 -s support_initial_layer_line_distance=0 \
                   -s support_wall_count=1",
    },
    Supporter {
        name: "CuraEngine tree, one dense roof layer",
        program: "CuraEngine",
        settings: "-s support_structure=tree -s support_line_distance=0 -s support_initial_layer_line_distance=0 \
                   -s support_wall_count=1 -s support_roof_enable=true -s support_roof_height=0.2 \
                   -s support_roof_line_distance=0.45 -s support_roof_pattern=lines",
    },
    Supporter {
        name: "CuraEngine lines 7 mm",
        program: "CuraEngine",
        settings: "-s support_structure=normal -s support_line_distance=7 \
                   -s support_initial_layer_line_distance=7 -s support_pattern=lines",
    },
];

/// Our trees beside the leanest peer that leaves no more of the part over air; no row without our trees.
fn equal_held(part: &str, rows: &[SupportRow]) -> Option<Vec<String>> {
    let ours = rows.first().filter(|r| !r.peer)?;
    let leanest = rows
        .iter()
        .filter(|r| r.peer && r.over_air_mm <= ours.over_air_mm)
        .min_by(|a, b| a.grams.total_cmp(&b.grams));
    let peer = match leanest {
        Some(p) => {
            let share = format!("{:.2}", ours.grams / p.grams);
            [p.name.to_owned(), format!("{:.2}", p.grams), p.over_air_mm.to_string(), share]
        }
        None => ["none of those tried", "-", "-", "-"].map(str::to_owned),
    };
    let first = [part.to_owned(), format!("{:.2}", ours.grams), ours.over_air_mm.to_string()];
    Some(first.into_iter().chain(peer).collect())
}

/// Length of beads of the part that run over air for more than 10 mm, by the outside check.
fn not_held(gcode: &Path) -> Result<f64, String> {
    let checks = crate::setup::check("")?;
    let mut command = crate::setup::python();
    // 10 mm is the default of our `support.max_unsupported_mm`.
    command.arg("xtask/py/support_held.py").arg(checks).arg(gcode).arg("10").current_dir(crate::root());
    let found: Value =
        serde_json::from_str(&crate::output(&mut command)?).map_err(|e| format!("support_held.py: {e}"))?;
    found["part_over_reach_mm"].as_f64().ok_or_else(|| "support_held.py: no length".to_owned())
}

/// A top of 60 x 40 x 3 mm, 20 mm above the plate, on four legs of 5 x 5 mm: a flat underside that must be held.
fn table() -> String {
    // The legs reach 1 mm into the top, so that the bodies are one in every program.
    let boxes = [
        ([-30, -20, 20], [30, 20, 23]),
        ([-30, -20, 0], [-25, -15, 21]),
        ([25, -20, 0], [30, -15, 21]),
        ([-30, 15, 0], [-25, 20, 21]),
        ([25, 15, 0], [30, 20, 21]),
    ];
    let mut text = String::from("solid table\n");
    for (low, high) in boxes {
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for upper in [false, true] {
                let corner = |at_u: bool, at_v: bool| {
                    let mut p: [i32; 3] = low;
                    p[axis] = if upper { high[axis] } else { low[axis] };
                    p[u] = if at_u { high[u] } else { low[u] };
                    p[v] = if at_v { high[v] } else { low[v] };
                    p
                };
                let square =
                    [(false, false), (true, false), (true, true), (false, true)].map(|(a, b)| corner(a, b));
                for mut facet in [[0, 1, 2], [0, 2, 3]] {
                    if !upper {
                        facet.reverse();
                    }
                    text += "facet normal 0 0 0\nouter loop\n";
                    for at in facet {
                        let [x, y, z] = square[at];
                        text += &format!("vertex {x} {y} {z}\n");
                    }
                    text += "endloop\nendfacet\n";
                }
            }
        }
    }
    text + "endsolid table\n"
}

/// The programs, the parts and where they are sliced.
pub struct Bench {
    pub folder: PathBuf,
    /// CuraEngine's definition files, which come with the package of its front end.
    definitions: Option<PathBuf>,
}

impl Bench {
    pub fn prepare() -> Result<Self, String> {
        let root = crate::root();
        let data = crate::setup::data()?;
        crate::setup::bench()?;
        crate::setup::peers().unwrap_or_else(|e| eprintln!("xtask: going on without missing peers: {e}"));
        crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
        let folder = root.join("target/bench");
        crate::run(
            crate::setup::python()
                .arg("xtask/py/prepare_meshes.py")
                .args([data.join("meshes"), folder.join("meshes")]),
        )?;
        let definitions = crate::setup::cura_definitions(&folder);
        Ok(Self { folder, definitions })
    }

    pub fn mesh(&self, part: &str) -> PathBuf {
        self.folder.join("meshes").join(part).with_extension("stl")
    }

    /// The command that slices a part; `None` without the program.
    fn command(&self, program: &str, part: &str, density: f64, out: &Path) -> Option<Vec<String>> {
        let mesh = self.mesh(part).display().to_string();
        let out = out.display().to_string();
        let grid = density < 1.0;
        let text = match program {
            "grainpath" => format!(
                "{} slice {mesh} -o {out} --set printer.bed_mm=[400,400,400] \
                 --set process.skirt_loops=0 --set fill.density={density} --set fill.pattern={}",
                crate::built("grainpath").display(),
                if grid { "grid" } else { "rectilinear" }
            ),
            "prusa-slicer" => format!(
                // Each peer is set to our layers, walls, widths and fill; skirts are off, so that only
                // the part is compared.
                "prusa-slicer --export-gcode --bed-shape 0x0,400x0,400x400,0x400 --max-print-height 400 \
                 --layer-height 0.2 --first-layer-height 0.2 --perimeters 2 --fill-density {}% --fill-pattern {} \
                 --nozzle-diameter 0.4 --top-solid-layers 5 --bottom-solid-layers 4 --skirts 0 -o {out} {mesh}",
                100.0 * density,
                if grid { "grid" } else { "rectilinear" }
            ),
            _ => {
                let definitions = self.definitions.as_ref()?.display().to_string();
                format!(
                    "CuraEngine slice -j {definitions}/fdmprinter.def.json -s machine_width=400 -s machine_depth=400 \
                     -s machine_height=400 -s machine_center_is_zero=true -s layer_height=0.2 -s layer_height_0=0.2 \
                     -s wall_line_count=2 -s line_width=0.45 -s wall_line_width_0=0.45 -s wall_line_width_x=0.45 \
                     -s infill_line_width=0.45 -s skin_line_width=0.45 -s infill_pattern={} \
                     -s infill_sparse_density={} -s infill_line_distance={} -s top_layers=5 -s bottom_layers=4 \
                     -s adhesion_type=none -s machine_nozzle_size=0.4 -s support_enable=false \
                     -s roofing_layer_count=0 -e0 -j {definitions}/fdmextruder.def.json \
                     -s machine_nozzle_offset_x=0 -s machine_nozzle_offset_y=0 -s material_diameter=1.75 \
                     -l {mesh} -o {out}",
                    if grid { "grid" } else { "lines" },
                    100.0 * density,
                    // A grid lays two families of lines, so each has twice the spacing of a single one.
                    if grid { 2.0 * 0.45 / density } else { 0.45 }
                )
            }
        };
        let is_there = program == "grainpath" || crate::setup::is_installed(program);
        is_there.then(|| text.split_whitespace().map(str::to_owned).collect())
    }

    /// The command that slices a part with supports; `None` without the program.
    fn support_command(&self, supporter: &Supporter, part: &str, out: &Path) -> Option<Vec<String>> {
        let name = supporter.program;
        let common = match name {
            "grainpath" => "",
            // PrusaSlicer measures its threshold from the horizontal: 50 degrees are our 40. As it stands it takes flat
            // undersides between walls for bridges and makes no support there.
            "prusa-slicer" => "--support-material --support-material-threshold 50 --no-dont-support-bridges",
            // The command line evaluates no expressions, so distances that follow from other settings must be told:
            // the front end computes no infill for trees.
            _ => {
                "-s support_enable=true -s support_type=everywhere -s support_angle=40 -s support_line_width=0.45 \
                  -s support_z_distance=0.2 -s support_top_distance=0.2 -s support_bottom_distance=0.2"
            }
        };
        let more = format!("{common} {}", supporter.settings);
        let mut words = self.command(name, part, 0.15, out)?;
        words.retain(|w| w != "support_enable=false");
        // CuraEngine applies to a mesh the settings before its name only.
        let at = words.iter().position(|w| w == "-e0").unwrap_or(if name == "grainpath" {
            words.len()
        } else {
            1
        });
        let tidy = |w: Vec<String>| -> Vec<String> {
            let mut out: Vec<String> = Vec::new();
            for word in w {
                if out.last().is_some_and(|l| l == "-s") && word == "-s" {
                    continue;
                }
                out.push(word);
            }
            out
        };
        words.splice(at..at, more.split_whitespace().map(str::to_owned));
        Some(tidy(words))
    }

    /// Slices a part several times; the best time, the highest peak, and the last G-code.
    pub fn cost(&self, program: &str, part: &str, density: f64) -> Result<Option<(Cost, PathBuf)>, String> {
        let out = self.folder.join(format!("{program}_{part}_{}.gcode", 100.0 * density));
        let Some(words) = self.command(program, part, density, &out) else { return Ok(None) };
        let mut best = Cost { wall_s: f64::INFINITY, cpu_s: f64::INFINITY, peak_mib: 0.0 };
        for _ in 0..if density < 1.0 && part != "skull" { RUNS } else { 1 } {
            let cost = timed(&words, &self.folder)?;
            best = Cost {
                wall_s: best.wall_s.min(cost.wall_s),
                cpu_s: best.cpu_s.min(cost.cpu_s),
                peak_mib: best.peak_mib.max(cost.peak_mib),
            };
        }
        Ok(Some((best, out)))
    }

    /// Measurements of a G-code file by the outside check.
    fn measure(&self, gcode: &Path, mesh: Option<&Path>) -> Result<Value, String> {
        let mut command = crate::setup::python();
        match mesh {
            Some(mesh) => {
                command.arg("xtask/py/gap.py").arg(crate::setup::check("")?).arg(gcode).arg(mesh);
                command.current_dir(crate::root());
            }
            None => {
                command.arg(crate::setup::check("gcode_check.py")?).arg(gcode);
            }
        }
        serde_json::from_str(&crate::output(&mut command)?).map_err(|e| format!("gcode_check.py: {e}"))
    }
}
