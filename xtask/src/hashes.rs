//! Hashes of the G-code of small jobs, which show whether a change of the code changed a path.
//!
//! Each job has two hashes. One is of the file as written, the other of the file without comments, which
//! is what a machine acts on. Both stand in `xtask/hashes/gcode.txt`, a line for each job:
//!
//! ```text
//! name  hash-of-the-file  hash-without-comments
//! ```
//!
//! A hash is the first 128 bits of SHA-256 in hexadecimal. Inputs are made by `grainpath new` and
//! `grainpath specimen`, or are files in `xtask/hashes`. Jobs run with one, two or three threads in turn, since the
//! number of threads must not change a byte. Where a change of behaviour is wanted, `cargo xtask hashes --write`
//! rewrites the table, and the commit names the jobs and says why.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use sha2::{Digest, Sha256};

/// A job: its name, the job file below the folder of inputs, and the settings that differ from those in
/// the file.
type Job = (&'static str, &'static str, &'static [&'static str]);

const PLATE: &str = "plate/job.toml";
const TENSION: &str = "stress-lines/tension.toml";

/// Jobs that together reach every pattern, kind of guide, shape, flavour and support. Thick layers, small scales and
/// large elements keep each of them short.
const JOBS: &[Job] = &[
    // Patterns, without a guide.
    ("plate-grid", PLATE, &[]),
    ("plate-dense", PLATE, &["fill.pattern=rectilinear", "fill.density=1", "fill.angles_deg=[0, 60, 120]"]),
    ("plate-triangles", PLATE, &["fill.pattern=triangles", "process.seam=rear"]),
    ("plate-gyroid", PLATE, &["fill.pattern=gyroid", "process.seam=random"]),
    ("plate-concentric", PLATE, &["fill.pattern=concentric", "fill.density=1", "process.seam=nearest"]),
    ("plate-honeycomb", PLATE, &["fill.pattern=honeycomb", "process.wall_order=outer-first"]),
    // Patterns along one angle.
    (
        "angle-aligned",
        PLATE,
        &["fill.pattern=aligned", "fill.density=1", "guide.kind=angle", "guide.angle_deg=30"],
    ),
    ("angle-streamlines", PLATE, &["fill.pattern=streamlines", "fill.density=0.4", "guide.kind=angle"]),
    ("angle-continuous", "continuous/chained.toml", &["fill.widths=constant", "process.chain=false"]),
    ("chain", "continuous/chained.toml", &[]),
    // The process and the machine.
    (
        "adaptive-layers",
        "box.toml",
        &["shape.mesh=ball.stl", "shape.scale=0.4", "process.adaptive_layers=true"],
    ),
    (
        "brim-and-skirt",
        PLATE,
        &["process.brim_width_mm=4", "process.skirt_loops=3", "process.skirt_layers=2", "process.comb=false"],
    ),
    ("arcs", PLATE, &["process.arcs=true", "process.seam=aligned"]),
    ("klipper", PLATE, &["printer.profile=voron-2.4", "material.profile=abs", "process.profile=fine"]),
    ("duet", PLATE, &["printer.profile=duet-delta", "material.profile=petg", "process.profile=draft"]),
    (
        "wide-nozzle",
        PLATE,
        &["printer.profile=generic-0.6", "process.profile=wide", "printer.relative_e=false"],
    ),
    ("prusa-hop", PLATE, &["printer.profile=prusa-mk3s", "process.profile=strong", "printer.z_hop_mm=0.3"]),
    ("thumbnails", PLATE, &["printer.thumbnails_px=[[32, 32], [64, 48]]", "fill.density=0"]),
    ("mass", PLATE, &["fill.mass_g=18", "fill.pattern=aligned"]),
    // More material where the stress is high.
    (
        "graded-stress",
        "stress-lines/bending.toml",
        &[
            "fill.pattern=grid",
            "process.layer_height_mm=0.4",
            "fill.density={ min = 0.1, max = 1, by = \"stress\" }",
        ],
    ),
    (
        "graded-streamlines",
        "stress-lines/bending.toml",
        &[
            "fill.pattern=streamlines",
            "process.layer_height_mm=0.4",
            "fill.density={ min = 0.15, max = 0.9, by = \"stress\" }",
        ],
    ),
    (
        "walls-by-stress",
        "stress-lines/bending.toml",
        &[
            "fill.pattern=gyroid",
            "fill.density=0.15",
            "process.layer_height_mm=0.4",
            "process.walls={ min = 2, max = 6, by = \"stress\" }",
        ],
    ),
    ("spiral", PLATE, &["fill.pattern=concentric", "fill.spiral=true"]),
    // Shapes and their files.
    ("outline-svg", "comb.toml", &[]),
    ("outline-svg-single-beads", "comb.toml", &["process.walls=1", "process.min_bead_width_mm=0.3"]),
    ("outline-svg-without-gap-fill", "comb.toml", &["process.gap_fill=false", "process.thin_walls=false"]),
    ("outline-dxf", "frame.toml", &["shape.rotate_deg=[0, 0, 15]"]),
    ("mesh-obj", "box.toml", &["shape.mesh=box.obj", "fill.pattern=gyroid"]),
    ("mesh-ply", "box.toml", &["shape.mesh=box.ply", "process.walls=0"]),
    ("mesh-off", "box.toml", &["shape.mesh=box.off", "shape.rotate_deg=[10, 20, 0]"]),
    ("mesh-3mf", "box.toml", &["shape.mesh=box.3mf", "process.walls=5"]),
    ("specimen-tensile", "box.toml", &["shape.mesh=iso527.stl", "fill.density=1", "guide.kind=angle"]),
    (
        "specimen-open-hole",
        "box.toml",
        &["shape.mesh=d5766.stl", "fill.pattern=concentric", "fill.density=1"],
    ),
    ("specimen-critical-angle", "box.toml", &["shape.mesh=critical.stl", "shape.scale=0.6"]),
    // Stress.
    ("stress-plane", TENSION, &["output.stress=tension.vtu"]),
    ("stress-seed-lines", "stress-lines/tension-seed-lines.toml", &["guide.follow=tension"]),
    ("stress-alternate", TENSION, &["guide.follow=alternate", "fill.pattern=aligned"]),
    (
        "stress-streamlines",
        "stress-lines/bending.toml",
        &["fill.pattern=streamlines", "process.layer_height_mm=0.4"],
    ),
    ("stress-solid", "stress-lines/bracket.toml", &["guide.element_mm=6", "process.layer_height_mm=0.4"]),
    ("stress-imported", "imported.toml", &[]),
    // Directions of the user's own.
    ("field", "field/job.toml", &["process.layer_height_mm=0.4"]),
    (
        "field-turned",
        "field/job.toml",
        &["shape.rotate_deg=[0, 0, 37]", "fill.pattern=streamlines", "fill.density=0.4"],
    ),
    // Continuous paths and fibre.
    ("fibre-plate", "continuous/plate.toml", &[]),
    ("fibre-hook-cut", "continuous/hook.toml", &["fibre.turns=cut", "fibre.start=calm"]),
    ("fibre-wide", "continuous/plate-wide.toml", &["process.layer_height_mm=0.4"]),
    ("fibre-rings", "continuous/plate-concentric.toml", &["fibre.every=2", "fibre.turns=report"]),
    (
        "fibre-separate",
        "continuous/plate-rectilinear.toml",
        &["printer.profile=fibre-separate", "fibre.layers=[[3, 6]]", "fibre.start=rear"],
    ),
    (
        "continuous-stress",
        "continuous/plate.toml",
        &["fibre.enabled=false", "printer.profile=generic-0.4", "fill.tree=undirected", "fill.cell_aspect=4"],
    ),
    // Supports.
    ("support-tree-ball", "tree-support/ball.toml", &["process.layer_height_mm=0.4"]),
    (
        "support-tree-tray",
        "tree-support/tray.toml",
        &["process.layer_height_mm=0.4", "support.interface_layers=2", "support.from_plate_only=true"],
    ),
    ("support-columns", "tree-support/tray-columns.toml", &["process.layer_height_mm=0.4"]),
    ("support-box", "tree-support/tray-box.toml", &["process.layer_height_mm=0.4", "shape.scale=0.6"]),
    // Scans and photographs.
    ("scan", "ct/job.toml", &["process.layer_height_mm=0.4"]),
    (
        "scan-canny",
        "ct/job.toml",
        &["process.layer_height_mm=0.4", "shape.ct.contours=canny", "shape.ct.interpolate=matched"],
    ),
    (
        "scan-distance",
        "ct/job.toml",
        &["process.layer_height_mm=0.4", "shape.ct.interpolate=distance", "shape.ct.smooth=edges"],
    ),
    ("photo", "woodgrain/job.toml", &["process.layer_height_mm=0.4"]),
    (
        "photo-edges",
        "woodgrain/job.toml",
        &[
            "guide.mode=edges",
            "guide.join=nearest",
            "shape.photo.thickness_mm=1",
            "fill.mass_g=1.9",
            "shape.photo.shift_mm_per_mm=[0, 0]",
        ],
    ),
    ("photo-triangles", "woodgrain/triangles.toml", &[]),
    ("photo-on-plate", "painted.toml", &["guide.bend=both"]),
    ("texture", "texture.toml", &["shape.scale=0.6", "process.layer_height_mm=0.4"]),
];

/// Outputs that take time and are no G-code.
pub const QUIET: [&str; 4] = ["output.report=", "output.preview=", "output.support=", "output.lines="];

/// The two hashes of each job.
type Table = BTreeMap<String, [String; 2]>;

/// Runs the command: `--write` rewrites the table, `--binary PATH` takes a program that is built already.
pub fn run(words: &[&str]) -> Result<(), String> {
    let (mut write, mut binary, mut words) = (false, None, words.iter());
    while let Some(word) = words.next() {
        match *word {
            "--write" => write = true,
            "--binary" => binary = Some(PathBuf::from(words.next().ok_or("--binary needs a path")?)),
            other => return Err(format!("hashes: what is {other:?}? There are --write and --binary PATH")),
        }
    }
    let binary = match binary {
        Some(path) => path.canonicalize().map_err(|e| format!("{}: {e}", path.display()))?,
        None => {
            crate::cargo(&["build", "--quiet", "--profile", "ci", "--package", "grainpath-cli"])?;
            crate::ci_program()
        }
    };
    let made = hash_all(&binary)?;
    let file = crate::root().join("xtask/hashes/gcode.txt");
    if write {
        fs::write(&file, text(&made)).map_err(|e| format!("{}: {e}", file.display()))?;
        println!("{} jobs written to {}", made.len(), file.display());
        return Ok(());
    }
    let committed = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    compare(&read(&committed), &made)
}

/// A job that the program has planned.
pub struct Made {
    pub name: String,
    /// The job file.
    pub job: PathBuf,
    /// Settings that differ from those in the file.
    pub sets: Vec<String>,
    /// The program that was written.
    pub gcode: PathBuf,
}

/// Runs all jobs but some, and gives the programs that were written.
pub fn programs(binary: &Path, left_out: &[&str]) -> Result<Vec<Made>, String> {
    hash_all(binary)?;
    let folder = crate::target().join("hashes");
    let made = |(name, job, sets): &Job| Made {
        name: (*name).to_owned(),
        job: folder.join(job),
        sets: sets.iter().filter(|s| !s.starts_with("output.")).map(|s| (*s).to_owned()).collect(),
        gcode: folder.join("made").join(name).join("job.gcode"),
    };
    Ok(JOBS.iter().filter(|j| !left_out.contains(&j.0)).map(made).collect())
}

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("writing to a string cannot fail");
        text
    })
}

fn compare(committed: &Table, made: &Table) -> Result<(), String> {
    let mut different = 0;
    let names: std::collections::BTreeSet<&String> = committed.keys().chain(made.keys()).collect();
    for name in names {
        let what = match (committed.get(name), made.get(name)) {
            (Some(old), Some(new)) if old == new => continue,
            // The second hash leaves comments out, so equal ones mean that a machine does the same.
            (Some(old), Some(new)) if old[1] == new[1] => "only comments differ",
            (Some(_), Some(_)) => "the program differs",
            (None, _) => "is not in the table",
            (_, None) => "is in the table and is no job",
        };
        different += 1;
        println!("{name}: {what}");
    }
    if different == 0 {
        println!("{} jobs, every byte as committed", made.len());
        return Ok(());
    }
    Err(format!(
        "{different} of {} jobs differ from xtask/hashes/gcode.txt; if that is wanted, run \
         `cargo xtask hashes --write` and say in the commit which jobs changed and why",
        made.len()
    ))
}

fn text(table: &Table) -> String {
    table.iter().fold(String::new(), |mut text, (name, [whole, bare])| {
        writeln!(text, "{name}  {whole}  {bare}").expect("writing to a string cannot fail");
        text
    })
}

fn read(text: &str) -> Table {
    let line = |line: &str| {
        let mut words = line.split_whitespace().map(str::to_owned);
        Some((words.next()?, [words.next()?, words.next()?]))
    };
    text.lines().filter_map(line).collect()
}

/// Runs all jobs, as many at once as there are processors.
fn hash_all(binary: &Path) -> Result<Table, String> {
    let folder = crate::target().join("hashes");
    prepare(binary, &folder)?;
    let (next, table, failed) = (AtomicUsize::new(0), Mutex::new(Table::new()), Mutex::new(Vec::new()));
    // The job whose output another job reads runs first.
    let first = |(name, ..): &&Job| *name == "stress-plane";
    let jobs: Vec<&Job> = JOBS.iter().filter(first).chain(JOBS.iter().filter(|j| !first(j))).collect();
    let work = || {
        loop {
            // A shared counter gives each thread the next job, so that a long job holds up no others.
            let index = next.fetch_add(1, Ordering::SeqCst);
            let Some(job) = jobs.get(index) else { return };
            // The number of threads follows from the place in the list, so a job has the same number on
            // each machine.
            match hash(binary, &folder, job, 1 + index % 3) {
                Ok(hashes) => {
                    table.lock().expect("no thread panics").insert(job.0.to_owned(), hashes);
                }
                Err(message) => {
                    failed.lock().expect("no thread panics").push(format!("{}: {message}", job.0))
                }
            }
        }
    };
    // The first job runs alone, the others side by side.
    match jobs.first() {
        Some(job) => {
            next.store(1, Ordering::SeqCst);
            let hashes = hash(binary, &folder, job, 1)?;
            table.lock().expect("no thread panics").insert(job.0.to_owned(), hashes);
        }
        None => return Ok(Table::new()),
    }
    std::thread::scope(|scope| {
        for _ in 0..crate::cores() {
            scope.spawn(work);
        }
    });
    let failed = failed.into_inner().expect("no thread panics");
    if failed.is_empty() {
        Ok(table.into_inner().expect("no thread panics"))
    } else {
        Err(format!("jobs failed:\n{}", failed.join("\n")))
    }
}

fn hash(binary: &Path, folder: &Path, job: &Job, n_threads: usize) -> Result<[String; 2], String> {
    let (name, file, settings) = job;
    let made = folder.join("made").join(name);
    fs::create_dir_all(&made).map_err(|e| format!("{}: {e}", made.display()))?;
    let mut command = Command::new(binary);
    command.current_dir(folder).arg("run").arg(file).arg("--out").arg(&made);
    command.args(["--threads", &n_threads.to_string(), "--set", "output.gcode=job.gcode"]);
    // All outputs but the program are switched off; the one job's stress file is the input of another.
    let stress = if *name == "stress-plane" { "output.stress=tension.vtu" } else { "output.stress=" };
    for setting in QUIET.iter().chain([&stress]).chain(settings.iter()) {
        command.args(["--set", setting]);
    }
    crate::output(&mut command)?;
    let program = made.join("job.gcode");
    let bytes = fs::read(&program).map_err(|e| format!("{}: {e}", program.display()))?;
    Ok([digest(&bytes), digest(&without_comments(&bytes))])
}

/// The lines of a program up to their `;`, without blanks at their ends and without empty lines.
fn without_comments(program: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(program.len());
    for line in program.split(|&b| b == b'\n') {
        let code = line.split(|&b| b == b';').next().unwrap_or_default().trim_ascii_end();
        if !code.is_empty() {
            out.extend_from_slice(code);
            out.push(b'\n');
        }
    }
    out
}

fn digest(bytes: &[u8]) -> String {
    // 128 bits are far more than chance or a mistake needs; the table stays narrow.
    sha256(bytes)[..32].to_owned()
}

/// Makes all inputs anew.
fn prepare(binary: &Path, folder: &Path) -> Result<(), String> {
    // Inputs of an earlier version of the program would hide a change of the presets.
    match fs::remove_dir_all(folder) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            return Err(format!("{}: {e}", folder.display()));
        }
        _ => fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?,
    }
    let grainpath =
        |args: &[&str]| crate::output(Command::new(binary).current_dir(folder).args(args)).map(|_| ());
    for preset in ["plate", "stress-lines", "field", "woodgrain", "tree-support", "continuous"] {
        grainpath(&["new", preset])?;
    }
    grainpath(&["new", "ct", "--pixels", "64"])?;
    for (specimen, file) in [
        ("s1-box", "box.stl"),
        ("hanging-ball", "ball.stl"),
        ("iso527-1b", "iso527.stl"),
        ("d5766", "d5766.stl"),
        ("critical-angle", "critical.stl"),
    ] {
        grainpath(&["specimen", specimen, "-o", file])?;
    }
    let own = crate::root().join("xtask/hashes");
    for entry in fs::read_dir(&own).map_err(|e| format!("{}: {e}", own.display()))?.flatten() {
        fs::copy(entry.path(), folder.join(entry.file_name())).map_err(|e| e.to_string())?;
    }
    let io = |e: std::io::Error| format!("mesh formats: {e}");
    let (points, facets) = indexed(&fs::read(folder.join("box.stl")).map_err(io)?);
    for (file, bytes) in [
        ("box.obj", obj(&points, &facets).into_bytes()),
        ("box.ply", ply(&points, &facets).into_bytes()),
        ("box.off", off(&points, &facets).into_bytes()),
        ("box.3mf", threemf(&points, &facets).map_err(io)?),
    ] {
        fs::write(folder.join(file), bytes).map_err(io)?;
    }
    Ok(())
}

type Points = Vec<[f32; 3]>;
type Facets = Vec<[usize; 3]>;

/// The points, each once, and the facets of a binary STL file.
fn indexed(stl: &[u8]) -> (Points, Facets) {
    let (mut points, mut facets, mut index) = (Points::new(), Facets::new(), BTreeMap::new());
    // Source: the binary STL layout: 80 bytes of header, a count of 4, then 50 bytes for each facet:
    // normal, three corners, attribute.
    for facet in stl.get(84..).unwrap_or_default().chunks_exact(50) {
        let number = |at: usize| f32::from_le_bytes(facet[at..at + 4].try_into().expect("four bytes"));
        let corner = |corner: usize| [0, 1, 2].map(|axis| number(12 + 12 * corner + 4 * axis));
        facets.push([0, 1, 2].map(|k| {
            let point = corner(k);
            // Corners are compared by their bits: STL repeats a corner exactly.
            *index.entry(point.map(f32::to_bits)).or_insert_with(|| {
                points.push(point);
                points.len() - 1
            })
        }));
    }
    (points, facets)
}

fn lines<const N: usize, T: ToString>(rows: &[[T; N]], before: &str) -> String {
    let row = |row: &[T; N]| format!("{before}{}\n", row.each_ref().map(T::to_string).join(" "));
    rows.iter().map(row).collect()
}

fn obj(points: &Points, facets: &Facets) -> String {
    // OBJ counts vertices from 1.
    let from_one: Facets = facets.iter().map(|f| f.map(|i| i + 1)).collect();
    format!("{}{}", lines(points, "v "), lines(&from_one, "f "))
}

fn off(points: &Points, facets: &Facets) -> String {
    format!("OFF\n{} {} 0\n{}{}", points.len(), facets.len(), lines(points, ""), lines(facets, "3 "))
}

fn ply(points: &Points, facets: &Facets) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n{}{}",
        points.len(),
        facets.len(),
        lines(points, ""),
        lines(facets, "3 ")
    )
}

fn threemf(points: &Points, facets: &Facets) -> std::io::Result<Vec<u8>> {
    let mut model = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>\
         <object id=\"1\" type=\"model\"><mesh><vertices>",
    );
    for [x, y, z] in points {
        model += &format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
    }
    model += "</vertices><triangles>";
    for [a, b, c] in facets {
        model += &format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    model += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
    let types = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
         <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
         <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\
         </Types>";
    let relations = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
         <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
         Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for (name, text) in
        [("[Content_Types].xml", types), ("_rels/.rels", relations), ("3D/3dmodel.model", model.as_str())]
    {
        archive.start_file(name, options)?;
        archive.write_all(text.as_bytes())?;
    }
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_dropped_and_code_is_kept() {
        let program = b"; head\nG1 X1 ; move\n\n  ;\nM84\n";
        assert_eq!(without_comments(program), b"G1 X1\nM84\n");
    }

    #[test]
    fn the_table_is_read_as_it_is_written() {
        let table = Table::from([("a".to_owned(), [digest(b"1"), digest(b"2")])]);
        assert_eq!(read(&text(&table)), table);
        assert!(compare(&table, &table).is_ok());
        let other = Table::from([("a".to_owned(), [digest(b"1"), digest(b"3")])]);
        assert!(compare(&table, &other).is_err());
    }

    #[test]
    fn names_of_jobs_are_unique() {
        let names: std::collections::BTreeSet<&str> = JOBS.iter().map(|j| j.0).collect();
        assert_eq!(names.len(), JOBS.len());
    }
}
