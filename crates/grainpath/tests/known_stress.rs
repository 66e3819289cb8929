//! Which settings solve the stress again where an earlier run's is at hand, and that its G-code is that of a fresh run.

use std::collections::BTreeSet;
use std::sync::Arc;

use grainpath::guide::KnownStress;
use grainpath::run::{Inputs, plan_job};
use grainpath_core::{DVec3, Diagnostics, TriMesh};
use grainpath_gcode::write_gcode;
use grainpath_job::{Check, Param, Settings, parse_job};

const JOB: &str = "
[guide]
kind = \"stress\"
element_mm = 3

[[guide.fixture]]
on = { box_mm = [[0, 0, 0], [0, 8, 0.8]] }
fix = \"xyz\"

[[guide.load]]
on = { box_mm = [[24, 0, 0], [24, 8, 0.8]] }
force_n = [50, 20, 0]

[fill]
pattern = \"stripes\"
density = 0.5
";

/// A plate of four layers.
fn plate() -> TriMesh {
    let corner =
        |k: u32| DVec3::new(24.0 * f64::from(k & 1), 8.0 * f64::from(k >> 1 & 1), 0.8 * f64::from(k >> 2));
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices: (0..8).map(corner).collect(), triangles }
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

/// Another value than the default; `None` for rows that name files and the like.
fn other(row: &Param) -> Option<String> {
    if let Some(word) = row.words.iter().find(|w| format!("\"{}\"", w.name) != row.default) {
        return Some(format!("\"{}\"", word.name));
    }
    let within = |v: f64| match row.check {
        Check::Any => true,
        Check::Range(low, high) => (low..=high).contains(&v),
    };
    let changed =
        |v: f64, step: &dyn Fn(f64) -> f64| [step(v), -step(-v)].into_iter().find(|o| within(*o) && *o != v);
    match row.kind {
        "boolean" => Some((row.default != "true").to_string()),
        "integer" => changed(row.default.parse().ok()?, &|v| v + 1.0).map(|v| format!("{v}")),
        "number" => changed(row.default.parse().ok()?, &|v| 1.1 * v + 0.01).map(|v| format!("{v:?}")),
        "array" => {
            let numbers = row.default.trim_matches(['[', ']']).split(',').map(|v| v.trim().parse::<f64>());
            let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
            let numbers: Vec<String> = numbers.iter().map(|v| format!("{:?}", 0.98 * v)).collect();
            Some(format!("[{}]", numbers.join(", ")))
        }
        _ => None,
    }
}

/// Settings of the tables that a mesh with loads reads. A new value gives the G-code and the warnings of a fresh run; the
/// stress is solved again for those alone that the solver reads.
#[test]
fn settings_that_the_solver_does_not_read_solve_nothing() {
    let mesh = plate();
    let sections = ["printer", "material", "process", "guide", "fill", "support", "strength"];
    let (mut solving, mut tried) = (BTreeSet::new(), 0);
    for row in Settings::params().iter().filter(|row| sections.contains(&row.section)) {
        let Some(value) = other(row) else { continue };
        let sets = [format!("{}.{}={value}", row.section, row.key)];
        let Some(fresh) = planned(JOB, &mesh, &sets, None) else { continue };
        let known = Arc::new(KnownStress::default());
        planned(JOB, &mesh, &[], Some(Arc::clone(&known))).expect("a plan");
        assert_eq!(known.n_solved(), 1);
        let again = planned(JOB, &mesh, &sets, Some(Arc::clone(&known))).expect("as without it");
        assert!(again == fresh, "{}: other bytes or warnings than a fresh run", sets[0]);
        tried += 1;
        if known.n_solved() > 1 {
            solving.insert(format!("{}.{}", row.section, row.key));
        }
    }
    assert!(tried > 100, "{tried}");
    let expected = [
        "guide.analysis",
        "guide.elasticity",
        "guide.elasticity_deg",
        "guide.memory_mib",
        "material.density_g_cm3",
        "material.e_mpa",
        "material.nu",
    ];
    let expected: BTreeSet<String> = expected.into_iter().map(str::to_owned).collect();
    assert_eq!(solving, expected);
}

/// What the solver reads beside settings with a default: the part, its loads, and what a job leaves to the planner.
#[test]
fn another_part_and_other_loads_are_solved() {
    let mesh = plate();
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
    let nothing_held = JOB.replace("[[0, 0, 0], [0, 8, 0.8]]", "[[90, 0, 0], [91, 8, 0.8]]");
    assert_eq!(planned(&nothing_held, &wide, &[], Some(Arc::clone(&known))), None);
    assert_eq!(solves(JOB, &wide, &["guide.analysis=\"solid\"", "fill.density=0.3"]), 5);
    assert_eq!(solves(JOB, &mesh, &[]), 6);
}
