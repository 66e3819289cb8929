//! The reserve that every run with loads tells, held against the first failure of the virtual test.

mod support;

use std::fmt::Write;
use std::fs;
use std::path::Path;

use grainpath::measure::report::Report;
use grainpath_cli::Given;
use grainpath_core::segment::distance_squared_mm2;
use grainpath_core::{DVec2, Diagnostics};
use grainpath_gcode::{Bead, Program};
use grainpath_job::parse_job;
use grainpath_view::bead_reserve::BeadReserves;
use serde_json::Value;
use support::{box_stl, folder, grainpath, json};

/// A piece: its shape, the boxes that are held and pulled, the force, and its raster angles.
struct Piece {
    name: &'static str,
    shape: &'static str,
    held: &'static str,
    pulled: &'static str,
    force_n: &'static str,
    angles: &'static str,
}

const ALIGNED: &str = "[process]\nwalls = 2\n[fill]\npattern = \"aligned\"\ndensity = 1.0\n";
const HOLED: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40mm\" height=\"16mm\" viewBox=\"0 0 40 16\">\
    <path fill-rule=\"evenodd\" d=\"M0 0H40V16H0Z M23 8A3 3 0 1 0 17 8A3 3 0 1 0 23 8Z\"/></svg>\n";
const CORNER: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"32mm\" height=\"32mm\" viewBox=\"0 0 32 32\">\
    <path d=\"M0 0H10V18A4 4 0 0 0 14 22H32V32H0Z\"/></svg>\n";

const PIECES: [Piece; 6] = [
    Piece {
        name: "bar along",
        shape: "mesh = \"bar.stl\"",
        held: "[[0, 0, 0], [6, 8, 1]]",
        pulled: "[[34, 0, 0], [40, 8, 1]]",
        force_n: "[100, 0, 0]",
        angles: "angles_deg = [0]",
    },
    Piece {
        name: "bar off axis",
        shape: "mesh = \"bar.stl\"",
        held: "[[0, 0, 0], [6, 8, 1]]",
        pulled: "[[34, 0, 0], [40, 8, 1]]",
        force_n: "[100, 0, 0]",
        angles: "angles_deg = [45]",
    },
    Piece {
        name: "plate with a hole",
        shape: "outline = \"holed.svg\"\nthickness_mm = 2",
        held: "[[0, 0, 0], [5, 16, 2]]",
        pulled: "[[35, 0, 0], [40, 16, 2]]",
        force_n: "[300, 0, 0]",
        angles: "angles_deg = [0, 90]",
    },
    Piece {
        name: "corner with a fillet",
        shape: "outline = \"corner.svg\"\nthickness_mm = 2",
        held: "[[0, 27, 0], [10, 32, 2]]",
        pulled: "[[27, 0, 0], [32, 10, 2]]",
        force_n: "[0, -60, 0]",
        angles: "angles_deg = [0, 90]",
    },
    Piece {
        name: "beam",
        shape: "mesh = \"beam.stl\"",
        held: "[[0, 0, 0], [4, 6, 6]]",
        pulled: "[[28, 0, 0], [32, 6, 6]]",
        force_n: "[0, 0, -20]",
        angles: "angles_deg = [0]",
    },
    Piece {
        name: "post",
        shape: "mesh = \"post.stl\"",
        held: "[[0, 0, 0], [6, 6, 4]]",
        pulled: "[[0, 0, 18], [6, 6, 22]]",
        force_n: "[0, 0, 200]",
        angles: "angles_deg = [45, -45]",
    },
];

fn job(piece: &Piece) -> String {
    format!(
        "[shape]\n{}\n{ALIGNED}{}\n[guide]\nkind = \"stress\"\n[[guide.fixture]]\non = {{ box_mm = {} }}\nfix = \"xyz\"\n\
         [[guide.load]]\non = {{ box_mm = {} }}\nforce_n = {}\n[strength]\ncell_mm = 0.45\ncheck = false\ncorners = false\n",
        piece.shape, piece.angles, piece.held, piece.pulled, piece.force_n
    )
}

fn write_shapes(dir: &Path) {
    let boxes = [("bar", [40.0, 8.0, 1.0]), ("beam", [32.0, 6.0, 6.0]), ("post", [6.0, 6.0, 22.0])];
    for (name, size) in boxes {
        fs::write(dir.join(format!("{name}.stl")), box_stl(size)).expect("written");
    }
    fs::write(dir.join("holed.svg"), HOLED).expect("written");
    fs::write(dir.join("corner.svg"), CORNER).expect("written");
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("a number, not {v}"))
}

/// Reserves of pieces beside the first failure of the test on the same program: a table, and the largest difference.
#[derive(Default)]
struct HeldAgainstTest {
    table: String,
    worst: f64,
}

impl HeldAgainstTest {
    /// Runs a job and adds its row. The first failure has to lie in the interval of the reserve.
    fn run(&mut self, dir: &Path, job: &str, piece: &str) {
        let out = grainpath(dir, &["run", job, "--json", "--set", "strength.enabled=true"]);
        let report = json(&out);
        assert!(out.status.success(), "{piece}: {report}");
        let first = &report["reserve"]["first_failure"];
        let [low, told, high] = [0, 1, 2].map(|k| number(&first[k]));
        let tested = number(&report["strength"]["first_n"]) / number(&report["strength"]["job_load_n"]);
        writeln!(
            self.table,
            "| {piece} | {} | {told:.2} ({low:.2} to {high:.2}), {} | {tested:.2} | {:+.1} % | {:.2} |",
            report["strength"]["fidelity"],
            report["reserve"]["mode"],
            100.0 * (told / tested - 1.0),
            number(&report["reserve"]["seconds"]) / number(&report["stages_s"]["guide"]),
        )
        .expect("a string");
        self.worst = self.worst.max((told / tested - 1.0).abs());
        assert!(low <= told && told <= high, "{piece}: {first}");
        assert!(low <= tested && tested <= high, "{piece}: {tested} is not in {first}");
    }

    /// All reserves have to be within 15 % of the first failure.
    fn finish(self) {
        assert!(self.worst <= 0.15, "{}", self.table);
        eprintln!("{}", self.table);
    }
}

#[test]
fn the_reserve_is_the_first_failure_of_the_test() {
    let dir = folder("reserve pieces");
    write_shapes(&dir);
    let mut held = HeldAgainstTest::default();
    for (k, piece) in PIECES.iter().enumerate() {
        let name = format!("piece-{k}.toml");
        fs::write(dir.join(&name), job(piece)).expect("written");
        held.run(&dir, &name, piece.name);
    }
    held.finish();
}

/// Fibre is 10 to 20 times stiffer than the matrix beside it, so the stress of an even solid does not show what each carries.
#[test]
fn the_reserve_of_a_fibre_plate_is_the_first_failure_of_the_test() {
    let dir = folder("reserve fibre");
    assert!(grainpath(&dir, &["new", "continuous", "."]).status.success());
    let mut held = HeldAgainstTest::default();
    for name in ["plate-stripes.toml", "plate.toml"] {
        let job = fs::read_to_string(dir.join(name)).expect("a job");
        assert!(!job.contains("[strength]"), "{job}");
        let tested = format!("{job}\n[strength]\ncell_mm = 0.9\ncheck = false\ncorners = false\n");
        fs::write(dir.join(name), tested).expect("written");
        held.run(&dir, name, name);
    }
    held.finish();
    // On cells too many to be solved larger ones stand for them, and single cells tell less there: the interval says so.
    let width = |cell_mm: f64| {
        let cells = format!("strength.cell_mm={cell_mm}");
        let first =
            &json(&grainpath(&dir, &["run", "plate-stripes.toml", "--json", "--set", &cells]))["reserve"];
        number(&first["first_failure"][2]) / number(&first["first_failure"][0])
    };
    let (on_own, on_larger) = (width(0.9), width(0.1));
    assert!(on_larger > 2.0 * on_own, "{on_own} {on_larger}");
}

/// A bar that stands up, held on a part of its height and pushed aside on another. Its section is the same everywhere and the
/// force lies in the plane of its layers, but it bends in space.
const UPRIGHT: Piece = Piece {
    name: "bar standing up, pushed aside",
    shape: "mesh = \"post.stl\"",
    held: "[[0, 0, 0], [6, 6, 4]]",
    pulled: "[[0, 0, 18], [6, 6, 22]]",
    force_n: "[10, 0, 0]",
    angles: "angles_deg = [45, -45]",
};

#[test]
fn places_on_a_part_of_the_height_make_a_solid_of_guide_test_and_reserve() {
    let dir = folder("reserve upright");
    write_shapes(&dir);
    let dense = job(&UPRIGHT);
    fs::write(dir.join("upright.toml"), &dense).expect("written");
    let mut held = HeldAgainstTest::default();
    held.run(&dir, "upright.toml", UPRIGHT.name);
    assert!(held.table.contains("\"voxels\""), "{}", held.table);
    held.finish();
    let checked = json(&grainpath(&dir, &["run", "upright.toml", "--check", "--json"]));
    let solver = checked["stress"]["solver"].as_str().expect("a solver");
    assert!(solver.contains("multigrid"), "{solver}");
    // Held and pushed on the same face, which as a plate would hold any load.
    let shelf = dense
        .replace(UPRIGHT.held, "[[0, 0, 0], [0, 6, 12]]")
        .replace(UPRIGHT.pulled, "[[0, 0, 11], [0, 6, 22]]");
    fs::write(dir.join("shelf.toml"), shelf).expect("written");
    let tested =
        json(&grainpath(&dir, &["strength", "shelf.toml", "--json", "--set", "strength.cell_mm=0.9"]));
    let peak_n = number(&tested["strength"]["peak_load_n"]);
    assert!(peak_n > 10.0 && peak_n < 2000.0, "{tested}");
    // Where a plate is held on the place that is pulled, nothing is tested; springs under it seemed to carry 1e15 N.
    let gripped = job(&PIECES[0]).replace(PIECES[0].pulled, PIECES[0].held);
    fs::write(dir.join("gripped.toml"), gripped).expect("written");
    let out = grainpath(&dir, &["strength", "gripped.toml"]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(4), "{text}");
    assert!(text.contains("the load strains nothing that can break"), "{text}");
    // Who asks for a plate by name is told which place is none of a plate.
    for set in ["guide.analysis=\"plane\"", "strength.fidelity=\"plane\""] {
        let out = grainpath(&dir, &["run", "upright.toml", "--set", "strength.enabled=true", "--set", set]);
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{text}");
        let told = "plane\" does not fit: fixture 1 (box) acts on 20 % of the part's height, not on all of it; use \"";
        assert!(text.contains(told), "{text}");
    }
}

/// The reserve of sparse infill is solved on cells of a solid where the guide was.
#[test]
fn the_reserve_follows_a_guide_that_is_asked_to_be_solid() {
    let dir = folder("reserve follows");
    write_shapes(&dir);
    let sparse = job(&PIECES[0]).replace("density = 1.0", "density = 0.5");
    fs::write(dir.join("bar.toml"), sparse).expect("written");
    let reserve = |sets: &[&str]| {
        let sets = sets.iter().flat_map(|set| ["--set", *set]);
        let args: Vec<&str> = ["run", "bar.toml", "--json"].into_iter().chain(sets).collect();
        let report = json(&grainpath(&dir, &args));
        number(&report["reserve"]["first_failure"][1])
    };
    let solid = reserve(&["guide.analysis=\"solid\""]);
    assert_eq!(solid, reserve(&["guide.analysis=\"solid\"", "strength.fidelity=\"voxels\""]));
    assert_ne!(solid, reserve(&[]));
}

/// A piece with sparse infill: its shape, its load in N, its infill, and the size of the test's cells.
struct SparsePiece {
    name: &'static str,
    size_mm: [f64; 3],
    force_n: [f64; 3],
    fill: &'static str,
    cell_mm: f64,
}

const SPARSE_PIECES: [SparsePiece; 4] = [
    SparsePiece {
        name: "bar, bent upwards, graded grid",
        size_mm: [40.0, 12.0, 10.0],
        force_n: [0.0, 0.0, -40.0],
        fill: "pattern = \"grid\"\ndensity = { min = 0.1, max = 1.0, by = \"stress\" }",
        cell_mm: 0.9,
    },
    SparsePiece {
        name: "bar, pulled, even gyroid",
        size_mm: [40.0, 10.0, 8.0],
        force_n: [200.0, 0.0, 0.0],
        fill: "pattern = \"gyroid\"\ndensity = 0.25",
        cell_mm: 0.9,
    },
    SparsePiece {
        name: "bar, bent sideways, graded stripes",
        size_mm: [40.0, 12.0, 8.0],
        force_n: [0.0, -30.0, 10.0],
        fill: "pattern = \"stripes\"\ndensity = { min = 0.1, max = 1.0, by = \"stress\" }",
        cell_mm: 0.9,
    },
    SparsePiece {
        name: "plate, bent in its plane, graded stripes",
        size_mm: [40.0, 16.0, 1.2],
        force_n: [0.0, -20.0, 0.0],
        fill: "pattern = \"stripes\"\ndensity = { min = 0.1, max = 1.0, by = \"stress\" }",
        cell_mm: 0.45,
    },
];

#[test]
fn the_reserve_of_sparse_infill_is_the_first_failure_of_the_test() {
    let dir = folder("reserve sparse");
    let mut held = HeldAgainstTest::default();
    for (k, piece) in SPARSE_PIECES.iter().enumerate() {
        let ([x, y, z], [fx, fy, fz]) = (piece.size_mm, piece.force_n);
        let fix = if fz == 0.0 && z < 2.0 { "xy" } else { "xyz" };
        fs::write(dir.join("piece.stl"), box_stl(piece.size_mm)).expect("written");
        let text = format!(
            "[shape]\nmesh = \"piece.stl\"\n[process]\nwalls = 1\ntop_layers = 2\nbottom_layers = 2\n[guide]\nkind = \"stress\"\n\
             [[guide.fixture]]\non = {{ box_mm = [[0, 0, 0], [1, {y}, {z}]] }}\nfix = \"{fix}\"\n\
             [[guide.load]]\non = {{ box_mm = [[{}, 0, 0], [{x}, {y}, {z}]] }}\nforce_n = [{fx}, {fy}, {fz}]\n\
             [fill]\n{}\n[strength]\ncell_mm = {}\ncheck = false\ncorners = false\n",
            x - 1.0,
            piece.fill,
            piece.cell_mm
        );
        let name = format!("sparse-{k}.toml");
        fs::write(dir.join(&name), text).expect("written");
        held.run(&dir, &name, piece.name);
    }
    held.finish();
}

/// Plans a job with the code of the command line. Returns the report, the program, read back, and where the part stands on
/// the plate.
fn planned(dir: &Path, job: &str) -> (Report, Program, DVec2) {
    let settings = parse_job(job, "job.toml", &[], &|_| Err("no own profiles".into())).expect("a job");
    let shape = grainpath_cli::shape_of(&settings, dir).expect("a shape");
    let diagnostics = Diagnostics::default();
    let planned = grainpath_cli::plan_given(&settings, Given::default(), &shape, dir, &diagnostics);
    let (planned, _) = planned.expect("a plan");
    let (bytes, written) = grainpath_cli::program_bytes(&settings, &planned).expect("G-code");
    let program = grainpath_cli::read_back(&settings, &bytes).expect("a program");
    let report = grainpath_cli::report_of(&settings, &planned, &written, Some(&program), &diagnostics);
    (report, program, planned.plan.plate_from_part_mm.truncate())
}

/// Every bead has its reserve, in plates and solids, dense and sparse, with one load case and with two.
#[test]
fn the_least_reserve_of_all_beads_is_the_one_that_is_told() {
    let dir = folder("reserve of beads");
    write_shapes(&dir);
    let sparse = "[shape]\nmesh = \"beam.stl\"\n[process]\nwalls = 1\ntop_layers = 2\nbottom_layers = 2\n[guide]\nkind = \"stress\"\n\
                  [[guide.fixture]]\non = { box_mm = [[0, 0, 0], [1, 6, 6]] }\nfix = \"xyz\"\n\
                  [[guide.load]]\non = { box_mm = [[31, 0, 0], [32, 6, 6]] }\nforce_n = [0, 0, -10]\n\
                  [fill]\npattern = \"grid\"\ndensity = 0.3\n[strength]\ncell_mm = 0.9\ncheck = false\n";
    let twice = "[[guide.case]]\nname = \"double\"\nload = [{ on = { box_mm = [[34, 0, 0], [40, 8, 1]] }, force_n = [200, 0, 0] }]\n[strength]";
    let off_axis = job(&PIECES[1]);
    let jobs = [
        ("plate", off_axis.clone()),
        ("plate, two cases", off_axis.replace("[strength]", twice)),
        ("solid", job(&PIECES[4])),
        ("sparse", sparse.to_owned()),
    ];
    // The cells of a plate reach through all layers, those of a solid do not, and those of sparse infill are solved instead
    // of judged by the stress of a solid part.
    let mut least = Vec::new();
    for (name, job) in jobs {
        let (report, program, shift) = planned(&dir, &job);
        let reserve = report.reserve.as_ref().expect("loads");
        let told = reserve.least.as_ref().unwrap_or_else(|| panic!("{name}: {:?}", reserve.untold));
        let map = reserve.map.as_ref().expect("a map");
        // The studio and the pictures take the values of the beads from here.
        let beads = BeadReserves::new(map, &program).expect("values");
        // The report rounds to five digits.
        let off = f64::from(beads.least) / told.first_failure[1] - 1.0;
        assert!(off.abs() < 1e-4, "{name}: {} and {}", beads.least, told.first_failure[1]);
        let all: Vec<(usize, &Bead, f32)> = (program.layers.iter().zip(&beads.of_beads).enumerate())
            .flat_map(|(k, (layer, own))| layer.beads.iter().zip(own).map(move |(b, f)| (k, b, *f)))
            .collect();
        let found = all.iter().map(|(.., f)| *f).fold(f32::INFINITY, f32::min);
        assert_eq!(found, beads.least, "{name}");
        // One of the beads that hold it lies where the report says: within a cell, and in a solid within a cell's layers.
        let [x, y, z] = told.at_mm;
        let at = DVec2::new(x, y) + shift;
        let near = |(k, bead, f): &(usize, &Bead, f32)| {
            let layer = &program.layers[*k];
            *f == beads.least
                && distance_squared_mm2(at, bead.start(), bead.end()) < 1.0
                && (name.starts_with("plate") || (layer.z_mm - 0.5 * layer.height_mm - z).abs() < 0.7)
        };
        assert!(all.iter().any(near), "{name}: no bead near {at} with {}", beads.least);
        // Long beads that begin in a grip have the value of what lies between the grips.
        // Skirts have none; of the part nearly all have one, but for what lies in the grips.
        let part: Vec<f32> = all.iter().filter(|(_, b, _)| b.role.is_part()).map(|(.., f)| *f).collect();
        let with = part.iter().filter(|f| f.is_finite()).count();
        assert!(10 * with > 3 * part.len(), "{name}: {with} of {}", part.len());
        assert!(all.iter().all(|(_, b, f)| b.role.is_part() || f.is_infinite()), "{name}");
        least.push(beads.least);
        assert!(report.to_json()["reserve"]["map"].is_null(), "the map is no part of the JSON");
    }
    assert!((least[0] / least[1] - 2.0).abs() < 1e-3, "the case of twice the load counts: {least:?}");
}

#[test]
fn a_reserve_is_told_in_words_or_the_reason_why_not() {
    let dir = folder("reserve words");
    write_shapes(&dir);
    let plain = job(&PIECES[0]);
    fs::write(dir.join("bar.toml"), &plain).expect("written");
    // Without JSON and pages the line is told too.
    let out = grainpath(&dir, &["run", "bar.toml"]);
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let line = text.lines().find(|l| l.starts_with("first failure: at ")).unwrap_or_else(|| panic!("{text}"));
    assert!(line.contains(" times the load (") && line.contains("along the beads"), "{line}");
    // A load far beyond the strength is a slip, and nothing is told from it.
    fs::write(dir.join("heavy.toml"), plain.replace("[100, 0, 0]", "[10000, 0, 0]")).expect("written");
    let report = json(&grainpath(&dir, &["run", "heavy.toml", "--json"]));
    assert_eq!(report["reserve"]["untold"], "the peak of the stress cannot be trusted");
    assert!(report["reserve"]["first_failure"].is_null(), "{report}");
    // Two cases: the one with twice the load has half the reserve.
    let load = "[[guide.case]]\nname = \"double\"\nload = [{ on = { box_mm = [[34, 0, 0], [40, 8, 1]] }, force_n = [200, 0, 0] }]\n[strength]";
    fs::write(dir.join("two.toml"), plain.replace("[strength]", load)).expect("written");
    let drawn =
        ["run", "two.toml", "--json", "--set", "output.report=two.html", "--set", "output.preview=drawn"];
    let report = json(&grainpath(&dir, &drawn));
    let reserve = &report["reserve"];
    let [one, two] = [0, 1].map(|k| number(&reserve["cases"][k]["first_failure"][1]));
    assert!((one / two - 2.0).abs() < 1e-3, "{reserve}");
    assert_eq!((&reserve["case"], number(&reserve["first_failure"][1])), (&Value::from("double"), two));
    let page = fs::read_to_string(dir.join("two.html")).expect("a page");
    assert!(page.contains("first failure, case double"), "the page tells every case");
    // The page shows the layer of the least reserve with its scale, and so does the folder of pictures.
    let scale = format!("<span>{two:.3}</span><span>times the load</span>");
    assert!(page.contains("alt=\"Reserve in layer 1 at ") && page.contains(&scale), "{scale}");
    assert!(dir.join("drawn").join("reserve.png").is_file());
}

/// A square plate that is pulled along x and, at another time, along y, turned by an angle. `single` is the weight of the pull
/// along y and of that along x where all layers follow the weighted sum.
fn crossed(deg: f64, single: Option<[f64; 2]>) -> String {
    let side = |at: [f64; 3], normal: [f64; 3]| {
        format!("{{ plane = {{ point_mm = {at:?}, normal = {normal:?}, tolerance_mm = 0.01 }} }}")
    };
    let (left, below) = (side([0.0; 3], [1.0, 0.0, 0.0]), side([0.0; 3], [0.0, 1.0, 0.0]));
    let (right, above) = (side([20.0, 0.0, 0.0], [1.0, 0.0, 0.0]), side([0.0, 20.0, 0.0], [0.0, 1.0, 0.0]));
    let [of_x, of_y] = single.unwrap_or([1.0; 2]);
    let mix = if single.is_some() { "weights" } else { "reserve" };
    format!(
        "[shape]\noutline = \"square.svg\"\nthickness_mm = 0.8\nrotate_deg = [0, 0, {deg}]\n[material]\nprofile = \"pa-cf\"\n\
         [process]\nwalls = 1\n[guide]\nkind = \"stress\"\nframe = \"part\"\nelement_mm = 1.5\ncase_mix = \"{mix}\"\n\
         [[guide.fixture]]\non = {left}\nfix = \"normal\"\n[[guide.fixture]]\non = {below}\nfix = \"normal\"\n\
         [[guide.case]]\nname = \"pull-x\"\nweight = {of_x}\nload = [{{ on = {right}, force_n = [300, 0, 0] }}]\n\
         [[guide.case]]\nname = \"pull-y\"\nweight = {of_y}\nload = [{{ on = {above}, force_n = [0, 300, 0] }}]\n\
         [fill]\npattern = \"stripes\"\ndensity = 1.0\n[strength]\ncell_mm = 0.45\ncheck = false\ncorners = false\n"
    )
}

/// The jobs of a crossed pair of cases: the mix, and all layers along x and along y.
fn write_crossed(dir: &Path, deg: f64) {
    let square = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20mm\" height=\"20mm\" viewBox=\"0 0 20 20\"><path d=\"M0 0H20V20H0Z\"/></svg>\n";
    fs::write(dir.join("square.svg"), square).expect("written");
    for (name, single) in [("mix", None), ("x", Some([1.0, 1e-6])), ("y", Some([1e-6, 1.0]))] {
        fs::write(dir.join(format!("{name}.toml")), crossed(deg, single)).expect("written");
    }
}

#[test]
fn layers_in_turn_serve_a_crossed_pair_of_cases() {
    for deg in [0.0, 37.0] {
        let dir = folder(&format!("crossed cases {deg}"));
        write_crossed(&dir, deg);
        let [mix, x, y] = ["mix", "x", "y"].map(|name| {
            let out = grainpath(&dir, &["run", &format!("{name}.toml"), "--json"]);
            let report = json(&out);
            assert!(out.status.success(), "{report}");
            (number(&report["reserve"]["first_failure"][1]), report)
        });
        assert!(mix.0 >= 1.25 * x.0.max(y.0), "{deg}: {} {} {}", mix.0, x.0, y.0);
        let served = &mix.1["stress"]["served"];
        assert_eq!(served[0]["case"], "pull-x", "{served}");
        assert_eq!(
            (&served[0]["layers"], &served[1]["layers"]),
            (&Value::from(vec![1, 3]), &Value::from(vec![2, 4]))
        );
        assert!(x.1["stress"]["served"].is_null());
        // The greater weight is that of the first case in `x` and of the second in `y`.
        for (report, stronger) in [(&x.1, 0), (&y.1, 1)] {
            let cases = &report["reserve"]["cases"];
            assert_eq!(
                (&cases[0]["case"], &cases[1]["case"]),
                (&"pull-x".into(), &"pull-y".into()),
                "{cases}"
            );
            let [own, other] = [stronger, 1 - stronger].map(|k: usize| number(&cases[k]["first_failure"][1]));
            assert!(own > 1.2 * other, "{cases}");
        }
        let told = grainpath(&dir, &["run", "mix.toml", "--set", "output.report=mix.html"]);
        let text = String::from_utf8_lossy(&told.stdout).into_owned();
        assert!(text.contains("directions of case pull-y: layers 2, 4"), "{text}");
        let page = fs::read_to_string(dir.join("mix.html")).expect("a page");
        assert!(page.contains("directions of case pull-x"), "the page tells the layers of each case");
    }
}

#[test]
fn the_strength_test_confirms_layers_in_turn() {
    for deg in [0.0, 37.0] {
        let dir = folder(&format!("crossed cases broken {deg}"));
        write_crossed(&dir, deg);
        let [mix, x, y] = ["mix", "x", "y"].map(|name| {
            let out = grainpath(&dir, &["strength", &format!("{name}.toml"), "--json"]);
            let report = json(&out);
            assert!(out.status.success(), "{report}");
            let cases = report["strength"]["cases"].as_array().expect("both cases");
            cases.iter().map(|case| number(&case["factor"])).fold(f64::INFINITY, f64::min)
        });
        eprintln!("{deg} degrees: in turn {mix:.2}, along x {x:.2}, along y {y:.2} times the load");
        assert!(mix >= 1.25 * x.max(y), "{deg}: {mix} {x} {y}");
    }
}

#[test]
fn cases_without_strengths_are_summed_and_said_to_be() {
    let dir = folder("crossed cases without strengths");
    write_crossed(&dir, 0.0);
    let plain = crossed(0.0, None).replace("profile = \"pa-cf\"", "profile = \"bare.toml\"");
    fs::write(dir.join("bare.toml"), "name = \"bare\"\n").expect("written");
    fs::write(dir.join("plain.toml"), plain).expect("written");
    let report = json(&grainpath(&dir, &["run", "plain.toml", "--json"]));
    let warnings = report["warnings"].as_array().unwrap_or_else(|| panic!("{report}"));
    assert!(warnings.iter().any(|w| w["id"] == "cases-by-weight"), "{report}");
    assert!(report["stress"]["served"].is_null(), "{report}");
}
