//! Ends of beads do not stand on each other from layer to layer.

use grainpath::guide::given_field::{FieldGuide, FieldSettings};
use grainpath::run::{Steps, config};
use grainpath_core::math::direction;
use grainpath_core::stacked::{Stacked, count};
use grainpath_core::{DVec2, Density, Diagnostics, Layer, LayerPlan, LayerStack, Polygon, Region};
use grainpath_io::directions::{DirectionOptions, parse_directions};
use grainpath_job::parse_job;

const LAYERS: usize = 12;

/// Equal layers of a plate of 30 x 18 mm with a hole of 8 mm.
fn plate() -> LayerStack {
    let round = |k: usize| direction(k as f64 / 48.0 * std::f64::consts::TAU) * 4.0 + DVec2::new(15.0, 9.0);
    let hole = Region::from(Polygon { outer: (0..48).map(round).collect(), holes: Vec::new() });
    let section = Region::rectangle(DVec2::ZERO, DVec2::new(30.0, 18.0)).difference(&hole);
    let layer = |i: usize| Layer::new(0.25 * (i + 1) as f64, 0.25, section.clone()).expect("a layer");
    LayerStack::new((0..LAYERS).map(layer).collect()).expect("a stack")
}

/// Directions that fan out: by 30 degrees from the lower to the upper side.
fn fan(stack: &LayerStack) -> FieldGuide {
    let table = "x,y,angle_deg\n0,0,-15\n30,0,15\n0,18,15\n30,18,-15\n";
    let samples =
        parse_directions(&[("a.csv", table.as_bytes())], &DirectionOptions::default()).expect("a table");
    let settings = FieldSettings::AS_IN_FILE;
    FieldGuide::new(samples, &settings, stack, &Diagnostics::default()).expect("directions on the part")
}

fn planned(pattern: &str, shift: &str) -> (LayerStack, Vec<LayerPlan>) {
    let sets = [
        format!("fill.pattern={pattern}"),
        format!("fill.layer_shift={shift}"),
        // The field of the steps takes the place of the angle.
        "guide.kind=angle".into(),
        "fill.density=1".into(),
        "process.layer_height_mm=0.25".into(),
        "process.first_layer_height_mm=0.25".into(),
        "process.top_layers=0".into(),
        "process.bottom_layers=0".into(),
    ];
    let settings = parse_job("", "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job");
    let stack = plate();
    let field = fan(&stack);
    let step_settings = config::steps(&settings);
    let steps = Steps::new(&step_settings, &stack).with_field(Some(&field));
    let mut layers = Vec::new();
    let order = config::order(&settings);
    steps
        .in_windows(LAYERS, Density::new(1.0), &order, &Diagnostics::default(), |layer| layers.push(layer))
        .expect("not stopped");
    (stack, layers)
}

fn stacked(pattern: &str, shift: &str) -> Stacked {
    let (stack, layers) = planned(pattern, shift);
    let found = count(&layers, &stack).expect("a plan with infill");
    println!("{pattern}, {shift}: {found:?}");
    found
}

/// Shares of the places inside and at the border that are stacked.
fn shares(of: &Stacked) -> [f64; 2] {
    let share = |part: usize, all: usize| part as f64 / all.max(1) as f64;
    [share(of.inside.stacked, of.inside.n), share(of.at_border.stacked, of.at_border.n)]
}

#[test]
fn ends_of_equal_layers_stand_on_each_other_without_a_shift() {
    for pattern in ["stripes", "continuous"] {
        let found = stacked(pattern, "none");
        assert_eq!(
            (found.layers, found.inside.most_layers, found.inside.longest_run),
            (LAYERS, LAYERS, LAYERS),
            "{pattern}"
        );
        assert!(shares(&found).iter().all(|s| *s > 0.95), "{pattern}: {found:?}");
    }
}

#[test]
fn a_shift_moves_ends_inside_and_a_band_those_at_the_border() {
    for pattern in ["stripes", "continuous"] {
        let [inside, _] = shares(&stacked(pattern, "inner"));
        assert!(inside < 0.6, "{pattern}: {inside}");
        let found = stacked(pattern, "all");
        let [inside, at_border] = shares(&found);
        assert!(inside < 0.5 && at_border < 0.5, "{pattern}: {found:?}");
    }
}

#[test]
fn a_shift_lays_as_much_as_equal_layers_do() {
    for pattern in ["stripes", "continuous"] {
        let laid = |shift: &str| -> Vec<f64> {
            let (_, layers) = planned(pattern, shift);
            let volume = |l: &LayerPlan| l.paths.iter().map(|p| p.path.volume_mm3(0.25)).sum();
            layers.iter().map(volume).collect()
        };
        let same = laid("none");
        for shift in ["inner", "all"] {
            let found = laid(shift);
            for (a, b) in same.iter().zip(&found) {
                assert!((a / b - 1.0).abs() < 0.015, "{pattern}, {shift}: {a} and {b} mm3");
            }
        }
    }
}

#[test]
fn fibre_has_a_shift_where_the_job_says_nothing() {
    let shift = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let settings = parse_job("", "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job");
        format!("{:?}", config::steps(&settings).infill.layer_shift)
    };
    let fibre = [
        "printer.profile=fibre-coextruded",
        "material.profile=pa-cf",
        "fibre.enabled=true",
        "guide.kind=angle",
    ];
    let dense = [&fibre[..], &["fill.density=1"]].concat();
    for (pattern, expected) in
        [("stripes", "Some(Inner)"), ("continuous", "Some(Inner)"), ("honeycomb", "None")]
    {
        let pattern = format!("fill.pattern={pattern}");
        let of_pattern = [&dense[..], &[&pattern]].concat();
        assert_eq!(shift(&of_pattern), expected, "{pattern}");
        assert_eq!(shift(&[&of_pattern[..], &["fibre.enabled=false"]].concat()), "None", "{pattern}");
        assert_eq!(shift(&[&of_pattern[..], &["fill.density=0.5"]].concat()), "None", "{pattern}");
    }
    let stripes = [&dense[..], &["fill.pattern=stripes"]].concat();
    assert_eq!(shift(&[&stripes[..], &["fill.layer_shift=none"]].concat()), "None");
    assert_eq!(shift(&[&stripes[..], &["fill.layer_shift=all"]].concat()), "Some(All)");
}
