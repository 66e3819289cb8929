//! Planning a part in windows of a few layers gives the layers that planning it whole gives.

use std::sync::{Arc, Mutex};

use grainpath::guide::given_field::FieldSettings;
use grainpath::guide::graded_density::{DensitySettings, GradedDensity};
use grainpath::region::{RegionAreas, RegionPart};
use grainpath::run::{Inputs, Steps, config, mesh_and_layers, plan_job};
use grainpath::shape::Standing;
use grainpath_core::diagnostics::{EarlyLayers, Progress, Stage};
use grainpath_core::polyline::resampled;
use grainpath_core::segment::distance_squared_mm2;
use grainpath_core::{
    DVec2, Density, Diagnostics, Layer, LayerPlan, LayerStack, Plan, Region, Role, TriMesh,
};
use grainpath_gcode::{Limits, Program, simulate, write_gcode};
use grainpath_io::directions::parse_densities;
use grainpath_io::parse_mesh;
use grainpath_job::choices::DensityBy;
use grainpath_job::{Settings, parse_job};

fn settings(sets: &[&str]) -> Settings {
    settings_of("", sets)
}

fn settings_of(job: &str, sets: &[&str]) -> Settings {
    let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
    parse_job(job, "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job")
}

/// The mounting plate of the preset at a third of its size: it has holes, a slot, a thin rib, and a step
/// in height.
fn plate(settings: &Settings) -> LayerStack {
    let mut bytes = Vec::new();
    grainpath_io::write_stl(&grainpath_parts::presets::plate(), &mut bytes).expect("memory takes all");
    let file = parse_mesh(&bytes, Some("plate.stl")).expect("a sound mesh");
    mesh_and_layers(&config::placing(settings), file, &Diagnostics::default()).expect("a sound mesh").stack
}

/// A job with a graded density gets densities that rise along x.
fn planned(settings: &Settings, stack: &LayerStack, n_layers: usize) -> Vec<LayerPlan> {
    let (step_settings, order) = (config::steps(settings), config::order(settings));
    let diagnostics = Diagnostics::default();
    let table = "x_mm,y_mm,density\n0,0,0.12\n40,0,0.18\n0,40,0.12\n40,40,0.18\n";
    let graded = settings.fill.density.graded().map(|asked| {
        let place = FieldSettings::AS_IN_FILE;
        let range = [asked.min, asked.max];
        let wanted = DensitySettings { range, by: DensityBy::File, spacing_mm: 0.4, card: None, place };
        let samples = parse_densities(table.as_bytes(), "densities.csv", None).expect("a sound table");
        GradedDensity::new(&wanted, stack, None, Some(samples), &diagnostics).expect("densities")
    });
    let part = RegionPart {
        stack,
        mesh: &TriMesh::default(),
        standing: Standing::new(1.0, [0.0; 3], 0.0),
        unit_mm: 1.0,
        unit_of_file: true,
        slicing: config::placing(settings).slicing,
    };
    let areas = (!step_settings.regions.is_empty()).then(|| {
        RegionAreas::new(settings, &Default::default(), &part, &diagnostics).expect("regions in the part")
    });
    let steps = Steps::new(&step_settings, stack).with_density(graded.as_ref()).with_regions(areas.as_ref());
    let mut layers = Vec::new();
    let density = graded.as_ref().map(|graded| Density::new(graded.mean));
    let density = density.or(settings.fill.density.even()).expect("a density");
    steps
        .in_windows(n_layers, density, &order, &diagnostics, |layer| layers.push(layer))
        .expect("not stopped");
    layers
}

#[test]
fn windows_of_any_size_give_the_same_layers() {
    // Quarters are exact in binary, so equal layers are equal to the bit. Other heights differ by the
    // rounding of their tops: the last bits then show whether a layer was copied from its equal or
    // planned anew across the border of a window.
    let small = [
        "shape.scale=0.35",
        "process.layer_height_mm=0.25",
        "process.first_layer_height_mm=0.25",
        "process.skirt_layers=3",
        "fill.density=0.3",
    ];
    for more in [
        &["fill.pattern=gyroid", "process.seam=random"][..],
        // Seams and starts of paths follow the layer below, across the borders of windows.
        &["fill.pattern=grid", "process.seam=aligned", "process.brim_width_mm=2"],
        &["fill.pattern=rectilinear", "process.chain=true", "process.top_layers=3"],
        // Equal layers are planned once and copied.
        &["fill.pattern=stripes", "guide.kind=angle", "guide.angle_deg=30"],
        // Sparse lines along a field go on from layer to layer.
        &["fill.pattern=streamlines", "fill.density=0.3", "guide.kind=angle", "guide.angle_deg=30"],
        &["fill.pattern=continuous", "guide.kind=angle"],
        // Whether a wall rises depends on the layers below and above it.
        &["process.stagger_walls=true", "process.walls=4"],
    ] {
        let all: Vec<&str> = small.iter().chain(more).copied().collect();
        let settings = settings(&all);
        let stack = plate(&settings);
        let n = stack.layers().len();
        assert!(n > 7, "{n} layers are too few for this test");
        let whole = planned(&settings, &stack, n);
        assert_eq!(whole.len(), n);
        for window in [1, 3, 7] {
            let layers = planned(&settings, &stack, window);
            for (i, (a, b)) in layers.iter().zip(&whole).enumerate() {
                assert_eq!(a, b, "layer {i} of {more:?} in windows of {window}");
            }
            assert_eq!(layers.len(), n);
        }
    }
}

/// Length of the longest stretch of dense fill whose middle is further from every bead of the layer below than 0.75 of its width.
fn longest_over_air_mm(layers: &[LayerPlan]) -> f64 {
    let mut longest = 0.0f64;
    for pair in layers.windows(2) {
        let below = pair[0].paths.iter().map(|p| &p.path);
        let below: Vec<(DVec2, DVec2)> =
            below.flat_map(|p| (0..p.n_segments()).map(|i| (p.segment(i).0, p.segment(i).1))).collect();
        for path in pair[1].paths.iter().map(|p| &p.path) {
            if !matches!(path.role, Role::SolidFill | Role::TopSkin) {
                continue;
            }
            let reach_mm = 0.75 * path.width_at(0);
            let (step_mm, mut run_mm) = (0.15, 0.0);
            for p in resampled(&path.points, path.closed, step_mm) {
                let held = |(a, b): &(DVec2, DVec2)| distance_squared_mm2(p, *a, *b) < reach_mm * reach_mm;
                run_mm = if below.iter().any(held) { 0.0 } else { run_mm + step_mm };
                longest = longest.max(run_mm);
            }
        }
    }
    longest
}

#[test]
fn skins_over_sparse_infill_reach_beads_that_hold_them() {
    // Below the floor of a narrow slot, a skin lies across the cells of the grid.
    let stack = |slot_mm: f64| {
        let section = |i: usize| {
            let whole = Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 40.0));
            let slot = Region::rectangle(DVec2::new(slot_mm, 5.0), DVec2::new(slot_mm + 2.2, 35.0));
            if i < 20 { whole } else { whole.difference(&slot) }
        };
        let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section(i)).expect("a sound layer");
        LayerStack::new((0..30).map(layer).collect()).expect("sound layers")
    };
    let even = "fill = { pattern = \"grid\", density = 0.15 }\n";
    let region = |x: &str, density: f64| {
        format!(
            "{even}[[region]]\non = {{ box_mm = [[{x}, -1, 0], [50, 50, 9]] }}\nfill = {{ density = {density} }}\n"
        )
    };
    let graded = |pattern: &str| {
        format!(
            "fill = {{ pattern = \"{pattern}\", density = {{ min = 0.1, max = 0.2, by = \"file\", file = \"d.csv\" }} }}\n"
        )
    };
    for (job, most_mm) in [
        (even.to_owned(), 10.0),
        (region("-1", 0.12), 10.0),
        (region("10", 0.15).replacen("0.15", "0.3", 1), 10.0),
        // Where the border of the region crosses cells below the skin, lines that turn there still do so over air.
        (region("20.3", 0.17), 10.0),
        (region("20.3", 0.12), 11.0),
        (graded("grid"), 10.0),
        (graded("triangles"), 10.0),
    ] {
        let long = settings_of(&job, &["support.max_unsupported_mm=100"]);
        let held = settings_of(&job, &[]);
        let mut as_they_were = 0.0f64;
        for slot_mm in [18.2, 19.2, 20.2, 21.2] {
            let stack = stack(slot_mm);
            let whole = planned(&held, &stack, 30);
            let longest_mm = longest_over_air_mm(&whole);
            assert!(
                longest_mm > 3.0 && longest_mm <= most_mm,
                "slot at {slot_mm} mm: {longest_mm} mm in {job}"
            );
            // What lies below the first layer of a window counts as well.
            assert!(planned(&held, &stack, 4) == whole, "slot at {slot_mm} mm in windows, {job}");
            as_they_were = as_they_were.max(longest_over_air_mm(&planned(&long, &stack, 30)));
        }
        // A printer that bridges further leaves skins as they are.
        assert!(as_they_were > 10.0, "{as_they_were} mm in {job}");
    }
}

/// Keeps the programs of the first layers.
struct Early(Arc<Mutex<Vec<Program>>>);

impl Progress for Early {
    fn begin(&self, _: Stage, _: usize) {}

    fn advance(&self, _: usize) {}

    fn wants_layers(&self) -> bool {
        true
    }

    fn layers(&self, early: &EarlyLayers<'_>) {
        let program = simulate(early.gcode, early.filament_mm, &Limits::default()).expect("G-code");
        self.0.lock().expect("no panic").push(program);
    }
}

fn plan_whole(settings: &Settings, diagnostics: &Diagnostics) -> (Plan, Program) {
    let mut bytes = Vec::new();
    grainpath_io::write_stl(&grainpath_parts::presets::plate(), &mut bytes).expect("memory takes all");
    let inputs = Inputs {
        mesh: parse_mesh(&bytes, Some("plate.stl")).expect("a sound mesh"),
        path: "plate.stl".to_owned(),
        stress: None,
        deck: None,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: Default::default(),
        known: None,
    };
    let planned = plan_job(settings, inputs, diagnostics).expect("a sound job");
    let mut gcode = Vec::new();
    write_gcode(&planned.plan, &planned.config, &[], &mut gcode).expect("memory takes all");
    let program = simulate(&gcode, 1.75, &Limits::default()).expect("G-code");
    (planned.plan, program)
}

#[test]
fn layers_that_are_wanted_early_change_nothing() {
    // Heights of 0.1 mm are not exact in binary: layers planned anew in place of copies would show in the last bits.
    let small = ["shape.scale=0.35", "process.layer_height_mm=0.1", "process.first_layer_height_mm=0.2"];
    for more in [
        &["fill.pattern=gyroid", "process.seam=random"][..],
        &["fill.pattern=stripes", "guide.kind=angle", "guide.angle_deg=30"],
        &["fill.pattern=continuous", "guide.kind=angle", "process.chain=true"],
        &["process.stagger_walls=true", "process.walls=4", "process.skirt_layers=3"],
    ] {
        let all: Vec<&str> = small.iter().chain(more).copied().collect();
        let settings = settings(&all);
        let (plan, program) = plan_whole(&settings, &Diagnostics::default());
        let found = Arc::default();
        let (early, _) =
            plan_whole(&settings, &Diagnostics::with_progress(Box::new(Early(Arc::clone(&found)))));
        assert!(early == plan, "{more:?}");
        let programs = found.lock().expect("no panic");
        let counts: Vec<usize> = programs.iter().map(|p| p.layers.len()).collect();
        assert!(counts.starts_with(&[1, 4]) && counts.iter().all(|n| *n < plan.layers.len()), "{counts:?}");
        for (layers, whole) in programs.iter().flat_map(|p| p.layers.iter().zip(&program.layers)) {
            assert!(layers.beads == whole.beads, "{more:?} at {} mm", layers.z_mm);
        }
    }
}
