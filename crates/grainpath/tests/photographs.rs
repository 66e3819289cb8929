//! Photographs of synthetic boards as guides: the place of the grain on the part, and the photographs
//! that are refused.

use grainpath::guide::grain::{Corners, GrainError, GrainGuide, GrainSettings, Mode, read_grain};
use grainpath_core::{DVec2, DVec3, Diagnostics, DirectionField, Region};
use grainpath_imaging::canny::CannySettings;
use grainpath_imaging::photo::Photo;
use grainpath_imaging::photo::edge_curves::{CurveSettings, Join};
use grainpath_imaging::photo::warp::CornerError;
use grainpath_imaging::raster::Grey;
use grainpath_imaging::structure_tensor::{Tangent, axis_difference_rad};
use grainpath_parts::board::{Board, Knot};

fn settings(size_mm: DVec2, mode: Mode) -> GrainSettings {
    GrainSettings {
        corners: Corners::Image,
        size_mm,
        origin_mm: DVec2::ZERO,
        rotate_rad: 0.0,
        mirror: false,
        heights_mm: vec![0.0],
        shift_mm_per_mm: DVec2::ZERO,
        mode,
        pixel_mm: None,
        blur_mm: None,
        median_px: 1,
        canny: CannySettings::default(),
        curves: CurveSettings { join: Join::Trace, max_turn_rad: 1.0, bridge_mm: 1.5, min_length_mm: 3.0 },
        integration_mm: 0.6,
        smooth_mm: 0.6,
        tangent: Tangent::None,
        darkness: 0.0,
        pictures: false,
    }
}

fn photo(board: &Board) -> Photo {
    Photo::new("board".into(), board.flat(0.12, 0.5))
}

fn guide(photos: &[Photo], s: &GrainSettings) -> GrainGuide {
    read_grain(photos, s, &|_| Region::default(), &Diagnostics::default()).expect("a guide")
}

#[test]
fn placed_turned_and_mirrored_the_grain_keeps_its_truth() {
    let board = Board::default();
    for (rotate_rad, mirror) in [(0.0, false), (0.7, false), (2.0, true)] {
        let s = GrainSettings {
            origin_mm: DVec2::new(12.0, -7.0),
            rotate_rad,
            mirror,
            shift_mm_per_mm: DVec2::new(0.3, -0.2),
            ..settings(board.size_mm, Mode::Field)
        };
        let g = guide(&[photo(&board)], &s);
        let (mut worst, z) = (0.0f64, 5.0);
        for i in 1..20 {
            let q = DVec2::new(5.0 * f64::from(i), 24.0);
            let Some(truth) = board.axis_rad(q, 1.0) else { continue };
            let p = g.to_part(q) + z * s.shift_mm_per_mm;
            let truth = if mirror { -truth } else { truth } + rotate_rad;
            worst = worst.max(axis_difference_rad(g.sample(p.extend(z)).axis_rad, truth).to_degrees());
            assert!(g.to_picture(g.to_part(q)).distance(q) < 1e-9);
        }
        assert!(worst < 5.0, "turned {rotate_rad}, mirrored {mirror}: {worst} deg");
    }
}

#[test]
fn between_two_photographs_grain_and_curves_are_between_them() {
    let lower =
        Board { knots: vec![Knot { centre_mm: DVec2::new(45.0, 15.0), radius_mm: 4.0 }], ..Board::default() };
    let upper =
        Board { knots: vec![Knot { centre_mm: DVec2::new(47.0, 15.0), radius_mm: 4.0 }], ..Board::default() };
    let middle =
        Board { knots: vec![Knot { centre_mm: DVec2::new(46.0, 15.0), radius_mm: 4.0 }], ..Board::default() };
    let s = GrainSettings { heights_mm: vec![0.0, 4.0], ..settings(lower.size_mm, Mode::Edges) };
    let g = guide(&[photo(&lower), photo(&upper)], &s);
    let (mut sum, mut length) = (0.0, 0.0);
    for w in g.curves(2.0).iter().flat_map(|c| c.windows(9)).step_by(9) {
        let d = w[8] - w[0];
        if let Some(truth) = middle.axis_rad(w[4], 1.0) {
            sum +=
                axis_difference_rad(grainpath_core::math::atan2(d.y, d.x), truth).to_degrees() * d.length();
            length += d.length();
        }
    }
    assert!(length > 1000.0 && sum / length < 4.0, "{} deg over {length} mm", sum / length);
    assert_eq!(g.curves(-1.0), g.curves(0.0));
    let (a, b) = (DVec3::new(30.0, 20.0, 1.0), DVec3::new(30.0, 20.0, 2.0));
    assert!(axis_difference_rad(g.sample(a).axis_rad, g.sample(b).axis_rad) < 0.2);
}

#[test]
fn no_photograph_of_wood_is_told() {
    let size = DVec2::new(60.0, 40.0);
    let s = settings(size, Mode::Field);
    let black = Photo::new("black".into(), Grey::filled(300, 200, 0.0));
    let none = |_: f64| Region::default();
    let error = read_grain(std::slice::from_ref(&black), &s, &none, &Diagnostics::default()).err();
    assert!(matches!(error, Some((0, GrainError::Blank { .. }))), "{error:?}");
    // Plain paper: noise without grain.
    let mixed = |i: usize| {
        let mut h = i as u32;
        for (shift, factor) in [(16, 0x7feb_352d_u32), (15, 0x846c_a68b)] {
            h = (h ^ (h >> shift)).wrapping_mul(factor);
        }
        (h ^ (h >> 16)) as f32 / u32::MAX as f32
    };
    let paper = Grey::from_fn(300, 200, |x, y| 0.8 + 0.05 * (mixed(300 * y + x) - 0.5));
    let d = Diagnostics::default();
    let paper = Photo::new("paper.png".into(), paper);
    read_grain(&[paper], &s, &none, &d).expect("paper can be followed, though there is nothing to follow");
    assert!(d.warnings().iter().any(|w| w.text.contains("coherence")), "{:?}", d.warnings());
    let crossed = [(0.0, 0.0), (300.0, 200.0), (300.0, 0.0), (0.0, 200.0)].map(DVec2::from);
    let s = GrainSettings { corners: Corners::Given(vec![crossed]), ..s };
    let error = read_grain(&[black], &s, &none, &d).err();
    assert_eq!(error, Some((0, GrainError::Corners(CornerError::Crossed))));
}
