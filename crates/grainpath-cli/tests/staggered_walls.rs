//! Staggered walls: where they are raised, what they hold, and what the program says of them.

use grainpath::run::{Inputs, Planned, Steps, config, mesh_and_layers, plan_job};
use grainpath_core::units::bead_area_mm2;
use grainpath_core::{BeadRaise, DVec2, DVec3, Diagnostics, LayerPlan, Role, TriMesh, segment};
use grainpath_gcode::{Limits, Program, simulate};
use grainpath_io::parse_mesh;
use grainpath_job::parse_job;

fn settings(more: &[&str]) -> grainpath_job::Settings {
    let sets = ["process.walls=4", "fill.density=0.2", "process.skirt_loops=0"];
    let sets: Vec<String> = sets.iter().chain(more).map(|s| (*s).to_owned()).collect();
    parse_job("", "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job")
}

fn planned(mesh: &TriMesh, more: &[&str]) -> (Planned, Vec<String>) {
    let mut bytes = Vec::new();
    grainpath_io::write_stl(mesh, &mut bytes).expect("memory takes all");
    let inputs = Inputs {
        mesh: parse_mesh(&bytes, Some("part.stl")).expect("a sound mesh"),
        path: "part.stl".into(),
        stress: None,
        deck: None,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: std::collections::BTreeMap::new(),
        known: None,
    };
    let diagnostics = Diagnostics::default();
    let planned = plan_job(&settings(more), inputs, &diagnostics).expect("a sound job");
    (planned, diagnostics.warnings().into_iter().map(|w| w.id.name().to_owned()).collect())
}

fn program(planned: &Planned) -> (String, Program) {
    let mut text = Vec::new();
    grainpath_gcode::write_gcode(&planned.plan, &planned.config, &[], &mut text).expect("memory takes all");
    let text = String::from_utf8(text).expect("plain text");
    let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
    (text, program)
}

/// The mounting plate of the preset at a third of its size: holes, a slot, a thin rib, and a step in height.
fn plate() -> TriMesh {
    let mut mesh = grainpath_parts::presets::plate();
    mesh.vertices.iter_mut().for_each(|v| *v *= 0.5);
    mesh
}

/// A pyramid without its tip: 30 mm wide below, `top` mm above, 6 mm high.
fn pyramid(top: f64) -> TriMesh {
    let corner = |k: usize| {
        let (half, z) = if k < 4 { (15.0, 0.0) } else { (0.5 * top, 6.0) };
        let (x, y) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][k % 4];
        DVec3::new(half * x, half * y, z)
    };
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    TriMesh {
        vertices: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect(),
    }
}

/// The heights that the walls of a plan take up at a point: from, to, in mm, lowest first.
fn heights_at(layers: &[LayerPlan], p: DVec2) -> Vec<[f64; 2]> {
    let mut out = Vec::new();
    for layer in layers {
        for planned in layer.paths.iter().filter(|p| p.path.role == Role::InnerWall) {
            let path = &planned.path;
            let on = (0..path.n_segments()).any(|k| {
                let (a, b, _) = path.segment(k);
                segment::distance_squared_mm2(p, a, b) < 0.02 * 0.02
            });
            if on {
                let BeadRaise { bottom_mm, top_mm } = path.raise;
                out.push([layer.z_top_mm - layer.height_mm + bottom_mm, layer.z_top_mm + top_mm]);
            }
        }
    }
    out
}

#[test]
fn beads_of_a_raised_wall_stand_on_each_other_and_begin_and_end_level() {
    for heights in [
        &["process.layer_height_mm=0.2"][..],
        &["process.layer_height_mm=0.15", "process.first_layer_height_mm=0.2"],
        &["process.adaptive_layers=true", "process.adaptive_min_mm=0.1", "process.adaptive_max_mm=0.25"],
    ] {
        let all: Vec<&str> = heights.iter().chain(&["process.stagger_walls=true"]).copied().collect();
        let (planned, warnings) = planned_of_plate(&all);
        assert!(!warnings.contains(&"walls-level".to_owned()), "{warnings:?}");
        let layers = &planned.plan.layers;
        let (mut columns, mut raised) = (0, 0);
        for (k, layer) in layers.iter().enumerate() {
            let rising = layer.paths.iter().filter(|p| p.path.raise.top_mm > 0.0);
            for (n, path) in rising.map(|p| &p.path).enumerate() {
                raised += 1;
                assert!((path.raise.top_mm - 0.5 * layers[k + 1].height_mm).abs() < 6e-4);
                // Every few walls are enough; each is followed through all layers.
                if n % 3 > 0 || k % 5 > 0 {
                    continue;
                }
                columns += 1;
                let at = heights_at(layers, path.points[0]);
                for pair in at.windows(2) {
                    let level =
                        |z: f64| layers.iter().any(|l| (l.z_top_mm - z).abs() < 2e-3) || z.abs() < 2e-3;
                    // Another wall of the same place may lie above a gap of the part; its column begins level.
                    let joined = (pair[1][0] - pair[0][1]).abs() < 2e-3;
                    assert!(joined || level(pair[1][0]) && level(pair[0][1]), "{at:?}");
                }
                let (bottom, top) = (at[0][0], at[at.len() - 1][1]);
                let ends =
                    |z: f64, of: fn(&LayerPlan) -> f64| layers.iter().any(|l| (of(l) - z).abs() < 1e-6);
                assert!(ends(bottom, |l| l.z_top_mm - l.height_mm) && ends(top, |l| l.z_top_mm), "{at:?}");
                // A last bead of half a layer.
                let tallest = layers.iter().map(|l| l.height_mm).fold(0.0, f64::max);
                assert!(at.iter().any(|[low, high]| high - low < 0.6 * tallest), "{at:?}");
            }
        }
        assert!(columns > 5 && raised > 40, "{heights:?}: {columns} columns, {raised} raised");
        let top = &layers[layers.len() - 1];
        assert!(top.paths.iter().all(|p| p.path.raise.top_mm == 0.0));
    }
}

fn planned_of_plate(more: &[&str]) -> (Planned, Vec<String>) {
    planned(&plate(), more)
}

#[test]
fn the_program_has_the_volume_heights_and_layers_of_level_walls() {
    // The same part twice: what differs comes from the heights of walls alone.
    let (level, _) = planned_of_plate(&[]);
    let (staggered, _) = planned_of_plate(&["process.stagger_walls=true"]);
    let (level_text, level) = program(&level);
    let (text, read) = program(&staggered);
    assert!(!level_text.contains(";RAISED:"));
    let more = read.extruded_mm3 / level.extruded_mm3 - 1.0;
    assert!(more.abs() < 5e-3, "{more}");
    // Wall by wall it is closer still: a column has the volume that it has level.
    let walls = |p: &Program| -> f64 {
        let all = p.layers.iter().flat_map(|l| &l.beads);
        all.filter(|b| b.role == Role::InnerWall).map(|b| f64::from(b.volume_mm3)).sum()
    };
    let more = walls(&read) / walls(&level) - 1.0;
    assert!(more.abs() < 1e-3, "{more}");
    // Read back, beads belong to their layers, whose heights are as asked.
    let z = |p: &Program| p.layers.iter().map(|l| (l.z_mm * 1e3).round() as i64).collect::<Vec<_>>();
    assert_eq!(z(&read), z(&level));
    let beads = || read.layers.iter().flat_map(|l| l.beads.iter().map(move |b| (b, l.height_mm)));
    let [mut first, mut usual, mut last] = [0; 3];
    for (b, h) in beads() {
        // Tenths of a millimetre.
        match b.raise_mm.map(|mm| (10.0 * mm).round() as i32) {
            [0, 0] => continue,
            [0, 1] => first += 1,
            [1, 1] => usual += 1,
            [1, 0] => last += 1,
            other => panic!("{other:?}"),
        }
        // The strip is that of a level wall, to the rounding of coordinates on short pieces.
        if b.start().distance(b.end()) > 5.0 {
            let own = b.height_mm(h);
            let strip = f64::from(b.volume_mm3) / (b.start().distance(b.end()) * own);
            assert!((strip - bead_area_mm2(0.45, 0.2) / 0.2).abs() < 2e-3, "{strip} {own}");
        }
    }
    assert!(first > 0 && first == last && usual > 5 * first, "{first} {usual} {last}");
    // The nozzle is half a layer up while it lays them, and never comes down within a layer.
    // Read line by line, without our own reader of G-code.
    let (mut z, mut raised, mut layer, mut n) = (0.0, false, 0.0, 0);
    for line in text.lines() {
        if let Some(at) = line.strip_prefix(";Z:") {
            (layer, raised) = (at.parse::<f64>().expect("a number"), false);
        } else if let Some(mm) = line.strip_prefix(";RAISED:") {
            raised = mm.ends_with(" 0.1");
        }
        let word = |letter: char| {
            line.split(' ').find_map(|w| w.strip_prefix(letter)).and_then(|w| w.parse::<f64>().ok())
        };
        if line.starts_with("G1") {
            z = word('Z').unwrap_or(z);
            if word('E').is_some_and(|e| e > 0.0) && (word('X').is_some() || word('Y').is_some()) {
                let own = layer + if raised { 0.1 } else { 0.0 };
                assert!((z - own).abs() < 1e-9, "{line}: {z} {own}");
                n += usize::from(raised);
            }
        }
    }
    assert!(n > 100, "{n}");
    for l in &staggered.plan.layers {
        let tops: Vec<f64> = l.paths.iter().map(|p| p.path.raise.top_mm).collect();
        assert!(tops.is_sorted(), "raised walls come last");
    }
}

#[test]
fn only_the_second_and_fourth_wall_rise() {
    let settings = settings(&["process.stagger_walls=true"]);
    let mut bytes = Vec::new();
    grainpath_io::write_stl(&plate(), &mut bytes).expect("memory takes all");
    let file = parse_mesh(&bytes, Some("plate.stl")).expect("a sound mesh");
    let stack =
        mesh_and_layers(&config::placing(&settings), file, &Diagnostics::default()).expect("a mesh").stack;
    let step_settings = config::steps(&settings);
    let n = stack.layers().len();
    let walls = Steps::new(&step_settings, &stack).walls(0..n, &Diagnostics::default()).expect("not stopped");
    // A plan no longer says which wall is which, so the walls are taken before they are put in order.
    let mut by_depth = [0; 4];
    for wall in walls.iter().flat_map(|l| &l.islands).flat_map(|i| &i.walls) {
        by_depth[wall.depth] += usize::from(wall.path.raise != BeadRaise::default());
    }
    assert!(by_depth[0] == 0 && by_depth[2] == 0 && by_depth[1] > n && by_depth[3] > n, "{by_depth:?}");
}

#[test]
fn walls_that_lean_stay_level() {
    // 45 degrees and 1.4 degrees from the vertical: the walls shift by 0.2 and by 0.005 mm a layer.
    let (leaning, warnings) = planned(&pyramid(18.0), &["process.stagger_walls=true"]);
    assert!(warnings.contains(&"walls-level".to_owned()), "{warnings:?}");
    let raised = |p: &Planned| {
        let all = p.plan.layers.iter().flat_map(|l| &l.paths);
        all.filter(|p| p.path.raise != BeadRaise::default()).count()
    };
    assert_eq!(raised(&leaning), 0);
    let (steep, warnings) = planned(&pyramid(29.7), &["process.stagger_walls=true"]);
    assert!(raised(&steep) > 50 && !warnings.contains(&"walls-level".to_owned()), "{warnings:?}");
    // Upside down it hangs over, and leans as far.
    let (over, _) = planned(&pyramid(42.0), &["process.stagger_walls=true"]);
    assert_eq!(raised(&over), 0);
}

#[test]
fn what_cannot_be_staggered_is_refused_in_one_line() {
    for (more, expected) in [
        (&["process.walls=1"][..], "needs two walls at least"),
        (&["process.chain=true"], "is not for process.chain = true"),
        (&["process.layer_height_mm=0.35", "process.first_layer_height_mm=0.3"], "1.5 layers"),
    ] {
        let sets = ["process.stagger_walls=true"].iter().chain(more).map(|s| (*s).to_owned());
        let sets: Vec<String> = sets.collect();
        let refused = parse_job("", "job.toml", &sets, &|path| Err(path.to_owned()));
        let text = refused.expect_err("a refusal").to_string();
        assert!(text.contains("process.stagger_walls") && text.contains(expected), "{text}");
        assert!(!text.trim_end().contains('\n'), "{text}");
    }
}
