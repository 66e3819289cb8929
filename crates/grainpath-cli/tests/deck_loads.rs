//! The supports and loads of a deck act on the job's part as the same ones written in the job do.

use std::fmt::Write as _;

use grainpath::guide::Guide;
use grainpath::run::{Inputs, check_loads, config};
use grainpath_core::{DVec3, Diagnostics, TriMesh, WarningId, math};
use grainpath_io::fe::parse_fe;
use grainpath_job::parse_job;

/// Size of the bar, mm, and its modulus, MPa.
const SIZE: [f64; 3] = [60.0, 10.0, 8.0];
const E_MPA: f64 = 2000.0;
/// Twenty-node bricks of the deck along each axis.
const N: [usize; 3] = [6, 2, 2];

/// Number of a node by its place among the corners and middles of bricks.
fn node([i, j, k]: [usize; 3]) -> usize {
    1 + i + (2 * N[0] + 1) * (j + (2 * N[1] + 1) * k)
}

/// Nodes of the deck with their places.
fn nodes() -> Vec<(usize, [f64; 3])> {
    let mut all = Vec::new();
    for k in 0..=2 * N[2] {
        for j in 0..=2 * N[1] {
            for i in 0..=2 * N[0] {
                // Bricks have nodes at corners and in the middle of edges.
                if i % 2 + j % 2 + k % 2 < 2 {
                    let at = |a: usize, v: usize| SIZE[a] * v as f64 / (2 * N[a]) as f64;
                    all.push((node([i, j, k]), [at(0, i), at(1, j), at(2, k)]));
                }
            }
        }
    }
    all
}

/// A deck of the bar whose lengths are in `unit_mm`, and whose lines behind the mesh are `rest`.
fn deck(unit_mm: f64, rest: &str) -> String {
    let mut text = "*HEADING\nbar\n*NODE\n".to_owned();
    for (n, p) in nodes() {
        let p = p.map(|c| c / unit_mm);
        let _ = writeln!(text, "{n}, {}, {}, {}", p[0], p[1], p[2]);
    }
    text += "*ELEMENT, TYPE=C3D20, ELSET=ALL\n";
    let corners = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]];
    let edges =
        [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
    let (mut element, mut tip) = (0, String::new());
    for k in 0..N[2] {
        for j in 0..N[1] {
            for i in 0..N[0] {
                element += 1;
                let at = |c: [usize; 3]| node([2 * i + c[0], 2 * j + c[1], 2 * k + c[2]]);
                let middle =
                    |e: &[usize; 2]| at(std::array::from_fn(|a| (corners[e[0]][a] + corners[e[1]][a]) / 2));
                let all = corners.iter().map(|c| at(*c)).chain(edges.iter().map(middle));
                let all: Vec<String> = all.map(|n| n.to_string()).collect();
                let _ = writeln!(text, "{element}, {},\n{}", all[..15].join(", "), all[15..].join(", "));
                if i + 1 == N[0] {
                    let _ = writeln!(tip, "{element}, S4");
                }
            }
        }
    }
    let root: Vec<String> =
        nodes().into_iter().filter(|(_, p)| p[0] == 0.0).map(|(n, _)| n.to_string()).collect();
    let _ = writeln!(text, "*NSET, NSET=ROOT\n{}\n*SURFACE, NAME=TIP, TYPE=ELEMENT\n{tip}", root.join("\n"));
    text + rest
}

/// CLOAD of a force that is spread evenly over the end of the bar: consistent forces of its quadratic faces, of which corners
/// take -1/12 and middles 1/3.
fn spread(axis: usize, force: f64) -> String {
    let mut forces = vec![0.0; node([2 * N[0], 2 * N[1], 2 * N[2]]) + 1];
    let share = force / (N[1] * N[2]) as f64;
    for (j, k) in (0..N[1]).flat_map(|j| (0..N[2]).map(move |k| (j, k))) {
        for (a, b, part) in [
            (0, 0, -1.0 / 12.0),
            (2, 0, -1.0 / 12.0),
            (2, 2, -1.0 / 12.0),
            (0, 2, -1.0 / 12.0),
            (1, 0, 1.0 / 3.0),
            (2, 1, 1.0 / 3.0),
            (1, 2, 1.0 / 3.0),
            (0, 1, 1.0 / 3.0),
        ] {
            forces[node([2 * N[0], 2 * j + a, 2 * k + b])] += part * share;
        }
    }
    let lines = forces.iter().enumerate().filter(|f| *f.1 != 0.0).map(|(n, f)| format!("{n}, {axis}, {f}\n"));
    format!("*CLOAD\n{}", lines.collect::<String>())
}

const MATERIAL: &str =
    "*MATERIAL, NAME=M\n*ELASTIC\n1000, 0.2\n*DENSITY\n2e-9\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n";

struct Checked {
    guide: Guide,
    warnings: Vec<WarningId>,
}

impl Checked {
    /// Mean displacement of the nodes whose place in the file has x = 60, in the axes of the file.
    fn tip(&self, case: usize, turn_deg: f64) -> DVec3 {
        let (s, c) = math::sin_cos(turn_deg.to_radians());
        let back = |v: DVec3| DVec3::new(c * v.x + s * v.y, c * v.y - s * v.x, v.z);
        let result = &self.guide.results[case];
        let moved = result.displacement.as_ref().expect("solved");
        let far = result.nodes.iter().map(|p| back(*p).x).fold(f64::MIN, f64::max);
        let tip: Vec<DVec3> = result
            .nodes
            .iter()
            .zip(moved)
            .filter(|(p, _)| back(**p).x > far - 1e-3)
            .map(|(_, u)| back(*u))
            .collect();
        tip.iter().sum::<DVec3>() / tip.len() as f64
    }
}

fn try_checked(job: &str, deck: Option<&str>) -> Result<Checked, String> {
    let job = format!(
        "[guide]\nkind = \"stress\"\nframe = \"part\"\nanalysis = \"solid\"\nelement_mm = 2.5\n{job}"
    );
    let sets: Vec<String> = [
        "printer.bed_mm=[400, 400, 400]".to_owned(),
        format!("material.e_mpa=[{E_MPA}, {E_MPA}, {E_MPA}]"),
        "material.nu=[0.3, 0.3, 0.3]".to_owned(),
        "material.density_g_cm3=1.2".to_owned(),
    ]
    .into_iter()
    .collect();
    let settings =
        parse_job(&job, "job.toml", &sets, &|path| Err(path.to_owned())).map_err(|e| e.to_string())?;
    let file = deck.map(|text| parse_fe(text.as_bytes(), Some("bar.inp"))).transpose();
    let deck = file.and_then(|file| file.map(|file| config::deck(&settings, &file)).transpose());
    let mut bytes = Vec::new();
    let corner = |i: usize| std::array::from_fn(|a| if i >> a & 1 == 1 { SIZE[a] } else { 0.0 });
    let sides: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mesh = TriMesh {
        vertices: (0..8).map(corner).map(DVec3::from_array).collect(),
        triangles: sides.iter().flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]]).collect(),
    };
    grainpath_io::write_stl(&mesh, &mut bytes).expect("memory takes all");
    let inputs = Inputs {
        mesh: grainpath_io::parse_mesh(&bytes, Some("bar.stl")).expect("a sound mesh"),
        path: "bar.stl".into(),
        stress: None,
        deck: deck.map_err(|e| e.to_string())?,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: Default::default(),
        known: None,
    };
    let diagnostics = Diagnostics::default();
    let guide = check_loads(&settings, inputs, &diagnostics).map_err(|e| e.to_string())?;
    Ok(Checked { guide, warnings: diagnostics.warnings().iter().map(|w| w.id).collect() })
}

fn checked(job: &str, deck: Option<&str>) -> Checked {
    try_checked(job, deck).unwrap_or_else(|e| panic!("{e}"))
}

const ROOT: &str =
    "[[guide.fixture]]\non = { plane = { point_mm = [0, 0, 0], normal = [1, 0, 0] } }\nfix = \"xyz\"\n";

/// A load on the end of the bar.
fn on_tip(load: &str) -> String {
    format!("[[guide.load]]\non = {{ plane = {{ point_mm = [60, 0, 0], normal = [1, 0, 0] }} }}\n{load}\n")
}

fn shape(turn_deg: f64) -> String {
    format!("deck = \"bar.inp\"\n[shape]\nmesh = \"bar.stl\"\nrotate_deg = [0, 0, {turn_deg}]\n")
}

#[test]
fn forces_on_nodes_bend_the_bar_as_the_same_force_of_the_job_does() {
    let text = deck(1.0, &format!("*BOUNDARY\nROOT, 1, 3\n*STEP\n*STATIC\n{}*END STEP\n", spread(3, -20.0)));
    for turn_deg in [0.0, 37.0] {
        let of_deck = checked(&shape(turn_deg), Some(&text));
        assert_eq!(of_deck.warnings, [], "{turn_deg}");
        let own = checked(
            &format!(
                "[shape]\nmesh = \"bar.stl\"\nrotate_deg = [0, 0, {turn_deg}]\n{ROOT}{}",
                on_tip("force_n = [0, 0, -20]")
            ),
            None,
        );
        // The deck's resultant about its origin, to 1e-6: 20 N at the middle of the end.
        let load = &of_deck.guide.summary.balance[0].loads[0];
        let (s, c) = math::sin_cos(f64::to_radians(turn_deg));
        let middle = DVec3::new(60.0 * c - 5.0 * s, 60.0 * s + 5.0 * c, 4.0);
        let force = DVec3::new(0.0, 0.0, -20.0);
        assert!((load.force_n - force).length() < 1e-6 * 20.0, "{load:?}");
        let about_origin = load.moment_about_nmm(DVec3::ZERO);
        assert!(
            (about_origin - middle.cross(force)).length() < 1e-6 * 1200.0,
            "{about_origin} at {turn_deg}"
        );
        let (a, b) = (of_deck.tip(0, turn_deg), own.tip(0, turn_deg));
        assert!((a - b).length() < 1e-3 * b.length(), "{a} for {b} at {turn_deg} degrees");
        // F L^3 / 3 E I, and F L / (5/6 G A) of shear; the root is held against thinning, which stiffens it.
        let (bent, shear) = (
            20.0 * 60f64.powi(3) / (3.0 * E_MPA * 10.0 * 512.0 / 12.0),
            20.0 * 60.0 * 1.2 * 2.6 / E_MPA / 80.0,
        );
        assert!((a.z / -(bent + shear) - 1.0).abs() < 0.02, "{} for {}", a.z, bent + shear);
    }
}

#[test]
fn the_same_force_on_every_node_keeps_its_resultant() {
    // As decks written by hand have it; consistent forces would be larger in the middle of the face.
    let tip: Vec<usize> = nodes().into_iter().filter(|(_, p)| p[0] == SIZE[0]).map(|(n, _)| n).collect();
    let lines: String = tip.iter().map(|n| format!("{n}, 2, 1.5\n")).collect();
    let text = deck(1.0, &format!("*BOUNDARY\nROOT, 1, 3\n*STEP\n*STATIC\n*CLOAD\n{lines}*END STEP\n"));
    let found = checked(&shape(0.0), Some(&text));
    let total = 1.5 * tip.len() as f64;
    let load = &found.guide.summary.balance[0].loads[0];
    assert!((load.force_n - DVec3::Y * total).length() < 1e-6 * total, "{load:?}");
    let moment = load.moment_about_nmm(DVec3::ZERO);
    assert!((moment - DVec3::new(60.0, 5.0, 4.0).cross(DVec3::Y * total)).length() < 1e-6 * 60.0 * total);
}

#[test]
fn pressures_units_and_scale_go_with_the_part() {
    // The bar is pulled by 2.5 MPa, 200 N: F L / E A = 0.075 mm, less where the root does not thin.
    let step = "*STEP\n*STATIC\n*DSLOAD\nTIP, P, PULL\n*END STEP\n";
    let rest = |pull: &str| format!("*BOUNDARY\nROOT, 1, 3\n{}", step.replace("PULL", pull));
    let of_deck = checked(&shape(0.0), Some(&deck(1.0, &rest("-2.5"))));
    let own = checked(&format!("[shape]\nmesh = \"bar.stl\"\n{ROOT}{}", on_tip("pressure_mpa = -2.5")), None);
    let (a, b) = (of_deck.tip(0, 0.0), own.tip(0, 0.0));
    assert!((a - b).length() < 1e-4 * b.length(), "{a} for {b}");
    assert!((a.x / 0.075 - 1.0).abs() < 0.02, "{a}");
    // The same deck in metres and pascals.
    let si = "import_length_unit = \"m\"\nimport_stress_unit = \"Pa\"\n";
    let si = checked(&format!("{si}{}", shape(0.0)), Some(&deck(1000.0, &rest("-2.5e6"))));
    assert!((si.tip(0, 0.0) - a).length() < 1e-6 * a.length(), "{}", si.tip(0, 0.0));
    // Twice the part: the pressure stays, the force is four times as large, and the bar stretches twice as far.
    let large = checked(&format!("{}scale = 2\n", shape(0.0)), Some(&deck(1.0, &rest("-2.5"))));
    let force = large.guide.summary.balance[0].loads[0].force_n;
    assert!((force - DVec3::X * 800.0).length() < 1e-6 * 800.0, "{force}");
    assert!((large.tip(0, 0.0).x / (2.0 * a.x) - 1.0).abs() < 0.01, "{}", large.tip(0, 0.0));
    // A force on nodes stays: half the stretch.
    let text = deck(1.0, &format!("*BOUNDARY\nROOT, 1, 3\n*STEP\n*STATIC\n{}*END STEP\n", spread(1, 200.0)));
    let large = checked(&format!("{}scale = 2\n", shape(0.0)), Some(&text));
    assert!((large.tip(0, 0.0).x / (0.5 * a.x) - 1.0).abs() < 0.01, "{}", large.tip(0, 0.0));
}

#[test]
fn single_nodes_and_prescribed_displacements_hold_along_the_axes_of_the_deck() {
    // The root slides on its plane, three directions are held at single nodes, and the end is drawn out by 0.06 mm.
    let (corner, beside) = (node([0, 0, 0]), node([0, 2 * N[1], 0]));
    let tip: Vec<String> =
        nodes().into_iter().filter(|(_, p)| p[0] == SIZE[0]).map(|(n, _)| n.to_string()).collect();
    let tip = tip.join("\n");
    let rest = format!(
        "*NSET, NSET=END\n{tip}\n*BOUNDARY\nROOT, 1\n{corner}, 2, 3\n{beside}, 3\n*STEP\n*STATIC\n*BOUNDARY\nEND, 1, 1, 0.06\n*END STEP\n"
    );
    let text = deck(1.0, &rest);
    for turn_deg in [0.0, 37.0] {
        let found = checked(&shape(turn_deg), Some(&text));
        let tip = found.tip(0, turn_deg);
        assert!((tip.x - 0.06).abs() < 1e-6, "{tip} at {turn_deg}");
        // Free to thin: a stress of E u / L all over, 160 N in all.
        let reactions = &found.guide.summary.balance[0].reactions;
        let along = DVec3::new(
            math::sin_cos(f64::to_radians(turn_deg)).1,
            math::sin_cos(f64::to_radians(turn_deg)).0,
            0.0,
        );
        let pull = reactions.iter().map(|r| r.force_n.dot(along)).fold(0.0, f64::max);
        assert!((pull / 160.0 - 1.0).abs() < 0.01, "{pull} N at {turn_deg}: {reactions:?}");
    }
}

#[test]
fn loads_on_the_mass_take_the_material_that_the_job_asks_for() {
    let step = "*STEP\n*STATIC\n*DLOAD\nALL, GRAV, 9810, 0, 0, -1\n*END STEP\n\
                *STEP\n*STATIC\n*DLOAD, OP=NEW\nALL, CENTRIF, 1e4, 0, 0, 0, 0, 0, 1\n*END STEP\n";
    let text = deck(1.0, &format!("{MATERIAL}*BOUNDARY\nROOT, 1, 3\n{step}"));
    let volume = SIZE.iter().product::<f64>();
    for (job, density) in [("", 1.2e-9), ("deck_material = true\n", 2e-9)] {
        let found = checked(&format!("{job}{}", shape(0.0)), Some(&text));
        let weight = found.guide.summary.balance[0].loads[0].force_n;
        assert!((weight.z / (-9810.0 * density * volume) - 1.0).abs() < 1e-6, "{weight}");
        // The middle of the mass is 30 mm out along x and 5 mm along y.
        let pull = found.guide.summary.balance[1].loads[0].force_n;
        let wanted = DVec3::new(30.0, 5.0, 0.0) * 1e4 * density * volume;
        assert!((pull - wanted).length() < 1e-6 * wanted.length(), "{pull} for {wanted}");
        assert_eq!(found.guide.summary.balance[1].loads.len(), 1, "OP=NEW removes gravity");
    }
    // Half the modulus of the job's material bends twice as far.
    let step = format!("*STEP\n*STATIC\n{}*END STEP\n", spread(3, -20.0));
    let text = deck(1.0, &format!("{MATERIAL}*BOUNDARY\nROOT, 1, 3\n{step}"));
    let [own, taken] = ["", "deck_material = true\n"]
        .map(|job| checked(&format!("{job}{}", shape(0.0)), Some(&text)).tip(0, 0.0).z);
    assert!((taken / own / 2.0 - 1.0).abs() < 0.01, "{taken} for {own}");
}

#[test]
fn steps_become_cases_and_loads_stay_until_they_are_replaced() {
    let steps = format!(
        "*BOUNDARY\nROOT, 1, 3\n*STEP\n*STATIC\n{}*END STEP\n*STEP, NLGEOM\n*STATIC\n*DSLOAD\nTIP, P, 1\n*END STEP\n\
         *STEP\n*STATIC\n{}*END STEP\n*STEP\n*STATIC\n*CLOAD, OP=NEW\n*END STEP\n*STEP\n*FREQUENCY\n3\n*END STEP\n",
        spread(1, 200.0),
        spread(1, 50.0)
    );
    let text = deck(1.0, &steps);
    let found = checked(&shape(0.0), Some(&text));
    assert_eq!(found.warnings, [WarningId::FeLeftOut, WarningId::FeLeftOut], "NLGEOM and *FREQUENCY");
    let sums: Vec<(String, f64)> = found
        .guide
        .summary
        .balance
        .iter()
        .map(|b| (b.case.clone(), b.loads.iter().map(|l| l.force_n.x).sum()))
        .collect();
    let wanted = [("step 1", 200.0), ("step 2", 120.0), ("step 3", -30.0), ("step 4", -80.0)];
    assert_eq!(sums.len(), 4);
    for ((name, sum), (wanted_name, wanted)) in sums.iter().zip(wanted) {
        assert!(name == wanted_name && (sum - wanted).abs() < 1e-6 * 200.0, "{sums:?}");
    }
    // One step alone, with a load of the job as a case of its own.
    let job = format!("deck_step = 3\n{}{}", shape(0.0), on_tip("force_n = [7, 0, 0]"));
    let found = checked(&job, Some(&text));
    let cases: Vec<&str> = found.guide.summary.balance.iter().map(|b| b.case.as_str()).collect();
    assert_eq!(cases, ["loads", "step 3"]);
    // Layers serve the cases of a deck in turn, as they serve those of the job.
    let is_mixed = |guide: &str| {
        let job =
            format!("fill.pattern = \"stripes\"\n[guide]\nkind = \"stress\"\ndeck = \"bar.inp\"\n{guide}");
        let settings = parse_job(&job, "job.toml", &[], &|path| Err(path.to_owned())).expect("a sound job");
        let file = parse_fe(text.as_bytes(), Some("bar.inp")).expect("a sound deck");
        let deck = config::deck(&settings, &file).expect("a sound deck");
        config::stress(&settings, Some(&deck)).expect("the kind is stress").mix.is_some()
    };
    assert!(is_mixed("") && !is_mixed("deck_step = 3\n") && !is_mixed("case_mix = \"weights\"\n"));
}

#[test]
fn decks_that_cannot_be_taken_are_refused_in_one_line() {
    let held = "*BOUNDARY\nROOT, 1, 3\n";
    let step = |what: &str| format!("{held}*STEP\n*STATIC\n{what}*END STEP\n");
    let inner = node([2, 2, 2]);
    let force = spread(1, 10.0);
    let cases = [
        (step(&format!("*CLOAD\n{inner}, 1, 5\n")), "carries a force inside the part"),
        (step("*CLOAD\n1, 4, 5\n"), "node 1: carries a moment, and nodes of solids do not turn"),
        (
            format!("*NODE, NSET=REF\n9999, 70, 0, 0\n{}", step("*CLOAD\nREF, 1, 5\n")),
            "node 9999: carries a load or a support, and is in no solid",
        ),
        (
            format!("*RIGID BODY, NSET=ROOT, REF NODE=1\n{}", step(&force)),
            "*RIGIDBODY: changes loads or supports and is not read",
        ),
        (
            format!("*TRANSFORM, NSET=ROOT, TYPE=C\n0,0,0,0,0,1\n{}", step(&force)),
            "*TRANSFORM: changes loads or supports",
        ),
        (step("*DSLOAD\nTIP, TRVEC, 1, 1, 0, 0\n"), "*DSLOAD other than P: changes loads"),
        (step("*CLOAD, USER\n1, 1, 5\n"), "*CLOAD, USER: changes loads"),
        (step("*DLOAD\n1, P4, 5\n"), "element 1, face 4: carries a pressure inside the part"),
        (step("*DLOAD\n1, GRAV, 9810, 0, 0, -1\n"), "step 1, GRAV: acts alike on 1 of 24 solid elements"),
        (step("*DLOAD\nALL, CENTRIF, 100, 0, 0, 0, 0, 0, 0\n"), "step 1: a centrifugal load needs"),
        (held.to_owned() + "*STEP\n*FREQUENCY\n3\n*END STEP\n", "step 1: *FREQUENCY is not static"),
        (
            format!("{}*STEP\n*STATIC\n*BOUNDARY, OP=NEW\nROOT, 1\n*END STEP\n", step(&force)),
            "step 2: holds the part in another way than step 1 does; choose one of them with guide.deck_step",
        ),
        (String::new(), "the deck: has neither supports nor loads"),
    ];
    for (rest, wanted) in cases {
        let told =
            try_checked(&shape(0.0), Some(&deck(1.0, &rest))).err().unwrap_or_else(|| panic!("{wanted}"));
        assert!(told.contains(wanted) && !told.contains('\n'), "{told:?} for {wanted:?}");
    }
    let refused = |job: &str, deck: &str| try_checked(job, Some(deck)).err().unwrap_or_default();
    let good = deck(1.0, &step(&force));
    let told = refused(&format!("import_length_unit = \"m\"\n{}", shape(0.0)), &good);
    assert!(
        told.contains("guide.deck: the part in the deck lies from (0.00, 0.00, 0.00) to (60000.00")
            && told.contains("check guide.import_length_unit"),
        "{told}"
    );
    let told = refused(&format!("deck_step = 2\n{}", shape(0.0)), &good);
    assert!(told.contains("step 2: there are steps 1 to 1"), "{told}");
    let told = refused(&format!("deck_material = true\n{}", shape(0.0)), &good);
    assert!(told.contains("has no isotropic material"), "{told}");
    let told = refused(&shape(0.0), "x,y,z,sxx,syy,szz,sxy,syz,szx\n0,0,0,1,0,0,0,0,0\n");
    assert!(told.contains("a file of the format CSV states no loads"), "{told}");
    let told = refused(&format!("import = \"r.vtu\"\n{}", shape(0.0)), &good);
    assert!(told.contains("guide.deck and guide.import"), "{told}");
}
