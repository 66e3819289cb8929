//! Directions of the user's own lie on the part, turn with it, and say where they do not fit.

use std::f64::consts::PI;

use grainpath::guide::given_field::{FieldError, FieldGuide, FieldSettings};
use grainpath::order::{OrderState, order_window};
use grainpath::run::{Steps, config};
use grainpath_core::buckets::PointGrid2;
use grainpath_core::math::{direction, rotated};
use grainpath_core::{
    Bounds2, DVec2, DVec3, Density, Diagnostics, Layer, LayerPlan, LayerStack, Region, Role, WarningId,
    polyline,
};
use grainpath_io::directions::{DirectionOptions, DirectionSamples, parse_directions};
use grainpath_job::choices::FieldFrame;
use grainpath_job::parse_job;

const TABLE: &str = "x,y,angle_deg\n0,0,10\n20,0,10\n0,10,40\n20,10,40\n";

fn samples(bytes: &[u8]) -> DirectionSamples {
    parse_directions(&[("a.csv", bytes)], &DirectionOptions::default()).expect("directions")
}

fn settings() -> FieldSettings {
    FieldSettings {
        frame: FieldFrame::Part,
        cell_mm: None,
        origin_mm: None,
        scale: 1.0,
        rotate_rad: [0.0; 3],
        lowered_mm: 0.0,
        plate_from_part_mm: DVec3::new(100.0, 80.0, 0.0),
    }
}

/// A rectangle from the origin, turned about the origin and scaled, as one layer.
fn part(size: DVec2, settings: &FieldSettings) -> LayerStack {
    let mut region = Region::rectangle(DVec2::ZERO, size * settings.scale);
    let turn = direction(settings.rotate_rad[2]);
    let contours = region.polygons.iter_mut().flat_map(|p| std::iter::once(&mut p.outer).chain(&mut p.holes));
    contours.flatten().for_each(|p| *p = rotated(*p, turn));
    LayerStack::new(vec![Layer::new(0.2, 0.2, region).expect("a layer")]).expect("a stack")
}

#[test]
fn directions_turn_and_grow_with_the_part() {
    for (degrees, scale) in [(0.0, 1.0), (37.0, 1.0), (90.0, 2.5), (200.0, 0.1)] {
        let turn = f64::to_radians(degrees);
        let settings = FieldSettings { rotate_rad: [0.0, 0.0, turn], scale, ..settings() };
        let stack = part(DVec2::new(20.0, 10.0), &settings);
        let diagnostics = Diagnostics::default();
        let guide = FieldGuide::new(samples(TABLE.as_bytes()), &settings, &stack, &diagnostics);
        let guide = guide.expect("directions on the part");
        let place = scale * rotated(DVec2::new(8.0, 5.0), direction(turn));
        let (axis, strength) = guide.asked(place.extend(0.1));
        let off = (axis - turn - 25f64.to_radians() + PI / 2.0).rem_euclid(PI) - PI / 2.0;
        assert!(off.abs() < 0.01 && strength > 0.8, "{degrees} degrees: {off} {strength}");
        assert!(guide.is_upright() && diagnostics.warnings().is_empty());
    }
}

#[test]
fn directions_beside_the_part_are_refused_and_short_ones_warned_of() {
    let diagnostics = Diagnostics::default();
    let lay = |frame, size: DVec2| {
        let settings = FieldSettings { frame, ..settings() };
        FieldGuide::new(samples(TABLE.as_bytes()), &settings, &part(size, &settings), &diagnostics)
    };
    assert!(matches!(lay(FieldFrame::Plate, DVec2::new(20.0, 10.0)), Err(FieldError::Elsewhere { .. })));
    assert!(lay(FieldFrame::Part, DVec2::new(90.0, 10.0)).is_ok());
    assert_eq!(diagnostics.warnings()[0].id, WarningId::FieldTooSmall);
}

#[test]
fn a_grid_covers_the_part_and_says_when_it_is_stretched() {
    let matrix = "0,0,0,0,0,0,0,0\n".repeat(2) + &"1.5,1.5,1.5,1.5,1.5,1.5,1.5,1.5\n".repeat(2);
    let diagnostics = Diagnostics::default();
    let stack = part(DVec2::new(40.0, 10.0), &settings());
    let guide = FieldGuide::new(samples(matrix.as_bytes()), &settings(), &stack, &diagnostics);
    let guide = guide.expect("a grid");
    // A line of the matrix is a column of the grid, whose cells hold single precision.
    assert!(guide.asked(DVec3::new(5.0, 5.0, 0.1)).0.abs() < 1e-6);
    assert!((guide.asked(DVec3::new(35.0, 5.0, 0.1)).0 - 1.5).abs() < 1e-6);
    assert_eq!(guide.report.low_mm, [0.0, 0.0, 0.0]);
    assert!(diagnostics.warnings().iter().any(|w| w.id == WarningId::FieldStretched));
}

/// Share of the length of sparse lines below which no bead of the layer below lies, from the third layer on.
fn share_on_air(layers: &[LayerPlan]) -> f64 {
    let (mut air, mut all) = (0u32, 0u32);
    for pair in layers.windows(2).skip(1) {
        let mut below = PointGrid2::new(Bounds2 { min: DVec2::ZERO, max: DVec2::new(60.0, 30.0) }, 1.0);
        let points = |layer: &LayerPlan, sparse: bool| -> Vec<DVec2> {
            let paths = layer.paths.iter().map(|p| &p.path);
            let paths = paths.filter(|p| p.role.is_part() && (!sparse || p.role == Role::SparseFill));
            paths.flat_map(|p| polyline::resampled(&p.points, p.closed, 0.1)).collect()
        };
        points(&pair[0], false).into_iter().for_each(|p| below.insert(p, ()));
        for p in points(&pair[1], true) {
            all += 1;
            air += u32::from(below.within(p, 0.225).next().is_none());
        }
    }
    assert!(all > 10_000, "{all} points");
    f64::from(air) / f64::from(all)
}

#[test]
fn sparse_lines_stand_on_those_below_where_the_field_changes_with_the_height() {
    // Parallel on the plate, spread by 15 degrees to either side and turned by 10 degrees above it.
    let mut table = String::from("x,y,z,angle_deg\n");
    for (z, spread, turn) in [(0.0, 0.0, 0.0), (6.0, 15.0, 10.0)] {
        for (x, y) in [(0.0, 0.0), (60.0, 0.0), (0.0, 30.0), (60.0, 30.0)] {
            let angle = turn + spread * (y - 15.0) / 15.0 * if x > 30.0 { 1.0 } else { -1.0 };
            table += &format!("{x},{y},{z},{angle}\n");
        }
    }
    let job = "[guide]\nkind = \"angle\"\n[fill]\npattern = \"streamlines\"\ndensity = 0.25\n\
               [process]\ntop_layers = 0\nbottom_layers = 0\n";
    let job = parse_job(job, "job.toml", &[], &|path| Err(path.to_owned())).expect("a sound job");
    let section = || Region::rectangle(DVec2::ZERO, DVec2::new(60.0, 30.0));
    let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section()).expect("a layer");
    let stack = LayerStack::new((0..30).map(layer).collect()).expect("a stack");
    let diagnostics = Diagnostics::default();
    let guide = FieldGuide::new(samples(table.as_bytes()), &settings(), &stack, &diagnostics);
    let guide = guide.expect("directions on the part");
    assert!(!guide.is_upright());
    let (step_settings, order) = (config::steps(&job), config::order(&job));
    let steps = Steps::new(&step_settings, &stack).with_field(Some(&guide));
    let planned = |n_layers: usize| {
        let mut layers = Vec::new();
        steps
            .in_windows(n_layers, Density::new(0.25), &order, &diagnostics, |layer| layers.push(layer))
            .expect("not stopped");
        layers
    };
    let layers = planned(30);
    assert!(planned(7) == layers, "windows change nothing");
    let share = share_on_air(&layers);
    // Each layer filled on its own.
    let alone = |i: usize| {
        let mut walls = steps.walls(i..i + 1, &diagnostics).expect("not stopped");
        let skins = steps.skins(i..i + 1, &mut walls, &diagnostics).expect("not stopped");
        let filled = steps.infill(i..i + 1, walls, skins, Density::new(0.25), &diagnostics);
        let mut state = OrderState::new(&order);
        let layers = filled.expect("not stopped").layers;
        order_window(stack.layers(), i..i + 1, layers, &order, &mut state, &diagnostics)
            .expect("ordered")
            .remove(0)
    };
    let without = share_on_air(&(0..30).map(alone).collect::<Vec<_>>());
    println!("on air: {share:.4}, and {without:.4} where each layer begins anew");
    assert!(share < 0.03, "{share}");
    assert!(without > 0.2, "{without}");
}
