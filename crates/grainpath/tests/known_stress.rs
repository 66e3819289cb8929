//! Which settings solve the stress again where an earlier run's is at hand, and that its G-code is that of a fresh run.

use std::collections::BTreeSet;
use std::sync::Arc;

use grainpath::guide::KnownStress;
use grainpath::run::{Inputs, plan_job};
use grainpath_core::math::direction;
use grainpath_core::{DVec2, Diagnostics, TriMesh};
use grainpath_gcode::write_gcode;
use grainpath_job::{Check, FirstStage, Param, Settings, parse_job};

/// A strip that is held at its left end and pulled at its right one, with a file in centimetres.
const JOB: &str = "
[shape]
unit = \"cm\"

[guide]
kind = \"stress\"
element_mm = 3

[[guide.fixture]]
on = { box_mm = [[-90, -90, -1], [-11, 90, 9]] }
fix = \"xyz\"

[[guide.load]]
on = { box_mm = [[11, -90, -1], [90, 90, 9]] }
force_n = [50, 20, 0]

[fill]
pattern = \"stripes\"
density = 0.5
";

/// A plate of four layers over a convex outline about the origin, cm.
fn plate(outline: &[DVec2]) -> TriMesh {
    let n = outline.len() as u32;
    let bottom = outline.iter().map(|p| p.extend(0.0));
    let top = outline.iter().map(|p| p.extend(0.08));
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, n + next], [k, n + next, n + k]]
    });
    let lids = (1..n - 1).flat_map(|k| [[0, k + 1, k], [n, n + k, n + k + 1]]);
    TriMesh { vertices: bottom.chain(top).collect(), triangles: sides.chain(lids).collect() }
}

/// 24 x 8 mm.
fn strip() -> TriMesh {
    plate(&[DVec2::new(-1.2, -0.4), DVec2::new(1.2, -0.4), DVec2::new(1.2, 0.4), DVec2::new(-1.2, 0.4)])
}

/// An ellipse of 24 x 8 mm with so many corners that they are simplified.
fn ellipse() -> TriMesh {
    let corner = |k: u32| DVec2::new(1.2, 0.4) * direction(f64::from(k) * std::f64::consts::TAU / 200.0);
    plate(&(0..200).map(corner).collect::<Vec<_>>())
}

/// G-code and warnings of the plate with settings changed; `None` where the job is refused.
fn planned(
    job: &str,
    mesh: &TriMesh,
    sets: &[String],
    known: Option<Arc<KnownStress>>,
) -> Option<(Vec<u8>, Vec<String>)> {
    let settings = parse_job(job, "job.toml", sets, &|path| Err(path.to_owned())).ok()?;
    let mut stl = Vec::new();
    grainpath_io::write_stl(mesh, &mut stl).expect("memory takes all");
    let inputs = Inputs {
        mesh: grainpath_io::parse_mesh(&stl, Some("plate.stl")).expect("a sound mesh"),
        path: "plate.stl".into(),
        stress: None,
        deck: None,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: Default::default(),
        known,
    };
    let diagnostics = Diagnostics::default();
    let planned = plan_job(&settings, inputs, &diagnostics).ok()?;
    let mut bytes = Vec::new();
    write_gcode(&planned.plan, &planned.config, &[], &mut bytes).ok()?;
    Some((bytes, diagnostics.warnings().iter().map(ToString::to_string).collect()))
}

/// Other values of rows for which [`other`] finds none.
const CHOSEN: [(&str, &str); 26] = [
    ("shape.unit", "\"inch\""),
    ("shape.rotate_deg", "[0, 0, 180]"),
    ("shape.position_mm", "[100, 100]"),
    ("printer.thumbnails_px", "[[32, 32]]"),
    ("material.fan_max", "0.9"),
    ("material.fan_bridge", "0.9"),
    ("process.walls", "3"),
    ("guide.element_mm", "2"),
    ("guide.fixture", "[{ on = { box_mm = [[-90, -90, -1], [-10, 90, 9]] }, fix = \"xyz\" }]"),
    ("guide.load", "[{ on = { box_mm = [[11, -90, -1], [90, 90, 9]] }, force_n = [50, -20, 0] }]"),
    (
        "guide.case",
        "[{ name = \"other\", load = [{ on = { box_mm = [[11, -90, -1], [90, 90, 9]] }, force_n = [0, 30, 0] }] }]",
    ),
    ("fill.density", "0.4"),
    ("fill.angles_deg", "[0, 90]"),
    ("fill.skin_angles_deg", "[0, 90]"),
    ("fill.mass_g", "0.15"),
    ("support.fan", "0.9"),
    ("support.enforce_mm", "[[[-12, -4, 0], [0, 4, 1]]]"),
    ("support.block_mm", "[[[-12, -4, 0], [0, 4, 1]]]"),
    ("support.enforce_facets", "[1]"),
    ("support.block_facets", "[1]"),
    ("support.lift_mm", "2"),
    ("fibre.matrix_layers", "[1, 0]"),
    ("fibre.matrix_density", "0.5"),
    ("fibre.layers", "[[1, 2]]"),
    ("fibre.boxes_mm", "[[[-12, -4, 0], [0, 4, 1]]]"),
    ("fibre.material", "\"petg\""),
];

/// Another value than the default; `None` for rows that name files and the like.
fn other(row: &Param) -> Option<String> {
    let name = format!("{}.{}", row.section, row.key);
    if let Some((_, value)) = CHOSEN.iter().find(|(chosen, _)| *chosen == name) {
        return Some((*value).to_owned());
    }
    if let Some(word) = row.words.iter().find(|w| format!("\"{}\"", w.name) != row.default) {
        return Some(format!("\"{}\"", word.name));
    }
    let within = |v: f64| match row.check {
        Check::Any => true,
        Check::Range(low, high) => (low..=high).contains(&v),
    };
    let changed =
        |v: f64, step: &dyn Fn(f64) -> f64| [step(v), -step(-v)].into_iter().find(|o| within(*o) && *o != v);
    match (row.kind, row.default.as_str()) {
        ("boolean", default) => Some((default != "true").to_string()),
        ("integer", default) => changed(default.parse().ok()?, &|v| v + 1.0).map(|v| format!("{v}")),
        // A number that is unset.
        ("number", "") => [0.3, 5.0].into_iter().find(|v| within(*v)).map(|v| format!("{v:?}")),
        ("number", default) => changed(default.parse().ok()?, &|v| 1.1 * v + 0.01).map(|v| format!("{v:?}")),
        // Three numbers that are unset: a strength or an energy.
        ("array", "") => Some("[20, 30, 40]".to_owned()),
        ("array", default) => {
            let numbers = default.trim_matches(['[', ']']).split(',').map(|v| v.trim().parse::<f64>());
            let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
            let numbers: Vec<String> = numbers.iter().map(|v| format!("{:?}", 0.98 * v)).collect();
            Some(format!("[{}]", numbers.join(", ")))
        }
        ("string", _) => Some("\"; other\"".to_owned()),
        _ => None,
    }
}

/// Settings that need another input than a sound mesh with loads of its own: a scan, photographs, directions, a result or a
/// deck of another program, or a broken mesh.
const OTHER_INPUTS: [&str; 20] = [
    "shape.mesh",
    "shape.outline",
    "shape.thickness_mm",
    "shape.outline_rule",
    "shape.repair",
    "shape.gap_closing_mm",
    "shape.photo",
    "shape.ct",
    "guide.deck",
    "guide.deck_step",
    "guide.deck_material",
    "guide.import",
    "guide.import_array",
    "guide.import_order",
    "guide.import_stress_unit",
    "guide.import_length_unit",
    "guide.image",
    "guide.volume",
    "guide.field",
    "output",
];

/// Every setting of a mesh with loads. A new value gives the G-code and the warnings of a fresh run, and the stress is solved
/// again for those settings alone of which [`Param::first_stage`] says so.
#[test]
fn the_stress_is_solved_again_for_the_settings_that_are_declared() {
    let other_job = JOB
        .replace("element_mm = 3", "element_mm = 3\nelasticity = \"orthotropic\"")
        .replace("[shape]", "[printer]\nfibre_tool = \"separate\"\nfibre_cut_gcode = \"M400\"\nfibre_cutter_mm = 1\n[fibre]\nmin_length_mm = 5\nanchor_mm = 1\n[shape]\nrotate_deg = [0, 0, 180]")
        .replace("density = 0.5", "density = 1");
    let parts = [(JOB, strip()), (other_job.as_str(), ellipse())];
    let (mut solving, mut untried) = (BTreeSet::new(), BTreeSet::new());
    let needs_other_input = |row: &Param| {
        let name = format!("{}.{}", row.section, row.key);
        OTHER_INPUTS.contains(&name.as_str()) || OTHER_INPUTS.contains(&row.section)
    };
    let rows = Settings::params();
    let rows: Vec<&Param> = rows.iter().filter(|row| !needs_other_input(row)).collect();
    for row in &rows {
        untried.insert(format!("{}.{}", row.section, row.key));
    }
    for (job, mesh) in &parts {
        let known = Arc::new(KnownStress::default());
        let mut is_of_job = false;
        for row in &rows {
            let name = format!("{}.{}", row.section, row.key);
            let Some(value) = other(row) else { continue };
            let sets = [format!("{name}={value}")];
            let Some(fresh) = planned(job, mesh, &sets, None) else { continue };
            if !is_of_job {
                planned(job, mesh, &[], Some(Arc::clone(&known))).expect("a plan");
            }
            let before = known.n_solved();
            let again = planned(job, mesh, &sets, Some(Arc::clone(&known))).expect("as without it");
            assert!(again == fresh, "{}: other bytes or warnings than a fresh run", sets[0]);
            untried.remove(&name);
            is_of_job = known.n_solved() == before;
            match known.n_solved() - before {
                0 => {}
                1 => drop(solving.insert(name)),
                n => panic!("{}: the stress was solved {n} times", sets[0]),
            }
        }
    }
    assert!(untried.is_empty(), "settings for which no other value gives a plan: {untried:?}");
    let is_declared = |row: &&&Param| row.first_stage() < FirstStage::Paths;
    let declared = rows.iter().filter(is_declared).map(|row| format!("{}.{}", row.section, row.key));
    assert_eq!(solving, declared.collect::<BTreeSet<String>>());
}

/// What the solver reads beside settings with a default: the part, its loads, and what a job leaves to the planner.
#[test]
fn another_part_and_other_loads_are_solved() {
    let mesh = strip();
    let known = Arc::new(KnownStress::default());
    let solves = |job: &str, mesh: &TriMesh, sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
        let again = planned(job, mesh, &sets, Some(Arc::clone(&known))).expect("a plan");
        assert!(Some(again) == planned(job, mesh, &sets, None), "{sets:?}");
        known.n_solved()
    };
    assert_eq!(solves(JOB, &mesh, &[]), 1);
    assert_eq!(solves(JOB, &mesh, &["process.layer_height_mm=0.1"]), 1);
    assert_eq!(solves(&JOB.replace("element_mm = 3", "element_mm = 2"), &mesh, &[]), 2);
    assert_eq!(solves(&JOB.replace("[50, 20, 0]", "[50, -20, 0]"), &mesh, &[]), 3);
    let wide =
        TriMesh { vertices: mesh.vertices.iter().map(|p| p.with_y(1.5 * p.y)).collect(), ..mesh.clone() };
    assert_eq!(solves(JOB, &wide, &[]), 4);
    assert_eq!(solves(JOB, &wide, &["guide.analysis=\"solid\""]), 5);
    // A solid keeps its stress under other layers; a refused job leaves what is known.
    assert_eq!(solves(JOB, &wide, &["guide.analysis=\"solid\"", "process.layer_height_mm=0.1"]), 5);
    // A plate is solved with the section of its middle layer, which is another one where the part tapers.
    let mut tapered = mesh.clone();
    tapered.vertices[4..].iter_mut().for_each(|p| *p = (1.0008 * p.truncate()).extend(p.z));
    assert_eq!(solves(JOB, &tapered, &[]), 6);
    assert_eq!(solves(JOB, &tapered, &["process.top_speed_mm_s=20"]), 6);
    assert_eq!(solves(JOB, &tapered, &["process.layer_height_mm=0.1"]), 7);
    let nothing_held = JOB.replace("[[-90, -90, -1], [-11, 90, 9]]", "[[90, 0, 0], [91, 8, 0.8]]");
    assert_eq!(planned(&nothing_held, &wide, &[], Some(Arc::clone(&known))), None);
    assert_eq!(solves(JOB, &wide, &["guide.analysis=\"solid\"", "fill.density=0.3"]), 8);
    assert_eq!(solves(JOB, &wide, &["guide.analysis=\"solid\"", "fill.density=0.4"]), 8);
    assert_eq!(solves(JOB, &mesh, &[]), 9);
}
