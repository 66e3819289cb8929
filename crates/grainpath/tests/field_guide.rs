//! Directions of the user's own lie on the part, turn with it, and say where they do not fit.

use std::f64::consts::PI;

use grainpath::guide::given_field::{FieldError, FieldGuide, FieldSettings};
use grainpath_core::math::{direction, rotated};
use grainpath_core::{DVec2, DVec3, Diagnostics, Layer, LayerStack, Region, WarningId};
use grainpath_io::directions::{DirectionOptions, DirectionSamples, parse_directions};
use grainpath_job::choices::FieldFrame;

const TABLE: &str = "x,y,angle_deg\n0,0,10\n20,0,10\n0,10,40\n20,10,40\n";

fn samples(bytes: &[u8]) -> DirectionSamples {
    parse_directions(&[("a.csv", bytes)], &DirectionOptions::default()).expect("directions")
}

fn settings() -> FieldSettings {
    FieldSettings { plate_from_part_mm: DVec3::new(100.0, 80.0, 0.0), ..FieldSettings::AS_IN_FILE }
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

#[test]
fn directions_that_stand_upright_on_the_layers_are_warned_of() {
    // Half of the samples of the part are upright; the places between them are cut off by the middle of a cell.
    let half = "x,y,vx,vy,vz\n0,0,1,0,0\n9.9,0,1,0,0\n10.1,0,0,0,1\n20,0,0,0,1\n\
                0,10,1,0,0\n9.9,10,1,0,0\n10.1,10,0,0,1\n20,10,0,0,1\n";
    // Directions along y of a part that was turned by a right angle about x.
    let plane = "x,y,angle_deg\n0,-9,90\n20,-9,90\n0,9,90\n20,9,90\n";
    for (table, rotate_rad, share) in [
        (TABLE, [0.0; 3], None),
        (half, [0.0; 3], Some("in 50 %")),
        (plane, [PI / 2.0, 0.0, 0.0], Some("in 100 %")),
    ] {
        let settings = FieldSettings { rotate_rad, ..settings() };
        let stack = part(DVec2::new(20.0, 10.0), &FieldSettings { rotate_rad: [0.0; 3], ..settings });
        let diagnostics = Diagnostics::default();
        FieldGuide::new(samples(table.as_bytes()), &settings, &stack, &diagnostics).expect("directions");
        let told = diagnostics.warnings();
        let told = told.iter().find(|w| w.id == WarningId::FieldLeftOut).map(|w| w.text.as_str());
        assert_eq!(told.is_some(), share.is_some(), "{told:?}");
        assert!(told.unwrap_or_default().starts_with(share.unwrap_or_default()), "{told:?}");
    }
}
