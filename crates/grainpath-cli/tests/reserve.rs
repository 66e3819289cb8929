//! The reserve that every run with loads tells, held against the first failure of the virtual test.

mod support;

use std::fmt::Write;
use std::fs;
use std::path::Path;

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

#[test]
fn the_reserve_is_the_first_failure_of_the_test() {
    let dir = folder("reserve pieces");
    write_shapes(&dir);
    let (mut table, mut worst) = (String::new(), 0.0f64);
    for (k, piece) in PIECES.iter().enumerate() {
        let name = format!("piece-{k}.toml");
        fs::write(dir.join(&name), job(piece)).expect("written");
        let out = grainpath(&dir, &["run", &name, "--json", "--set", "strength.enabled=true"]);
        let report = json(&out);
        assert!(out.status.success(), "{}: {report}", piece.name);
        let first = &report["reserve"]["first_failure"];
        let [low, told, high] = [0, 1, 2].map(|k| number(&first[k]));
        let tested = number(&report["strength"]["first_n"]) / number(&report["strength"]["job_load_n"]);
        writeln!(
            table,
            "| {} | {} | {told:.2} ({low:.2} to {high:.2}), {} | {tested:.2} | {:+.1} % | {:.2} |",
            piece.name,
            report["strength"]["fidelity"],
            report["reserve"]["mode"],
            100.0 * (told / tested - 1.0),
            number(&report["reserve"]["seconds"]) / number(&report["stages_s"]["guide"]),
        )
        .expect("a string");
        worst = worst.max((told / tested - 1.0).abs());
        assert!(low <= told && told <= high, "{}: {first}", piece.name);
        assert!(low <= tested && tested <= high, "{}: {tested} is not in {first}", piece.name);
    }
    assert!(worst <= 0.15, "{table}");
    eprintln!("{table}");
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
    let report = json(&grainpath(&dir, &["run", "two.toml", "--json", "--set", "output.report=two.html"]));
    let reserve = &report["reserve"];
    let [one, two] = [0, 1].map(|k| number(&reserve["cases"][k]["first_failure"][1]));
    assert!((one / two - 2.0).abs() < 1e-3, "{reserve}");
    assert_eq!((&reserve["case"], number(&reserve["first_failure"][1])), (&Value::from("double"), two));
    let page = fs::read_to_string(dir.join("two.html")).expect("a page");
    assert!(page.contains("first failure, case double"), "the page tells every case");
}
