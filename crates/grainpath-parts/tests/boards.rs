//! Results of the imaging crate on photographs of synthetic boards, compared with the truth that the
//! boards know.

use std::f64::consts::PI;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, direction, exp, rotated, sin_cos};
use grainpath_core::polyline::length_mm;
use grainpath_imaging::canny::{CannySettings, canny};
use grainpath_imaging::metric::MetricImage;
use grainpath_imaging::photo::corners::find_corners;
use grainpath_imaging::photo::edge_curves::{CurveSettings, Join, edge_curves};
use grainpath_imaging::photo::warp::rectify;
use grainpath_imaging::photo::width_side::{Turn, oriented};
use grainpath_imaging::raster::Grey;
use grainpath_imaging::structure_tensor::{TensorSettings, axis_difference_rad, grain_axes};
use grainpath_parts::board::{Board, Knot};

const CURVES: CurveSettings =
    CurveSettings { join: Join::Trace, max_turn_rad: 1.0, bridge_mm: 1.0, min_length_mm: 3.0 };
/// The damage that JPEG does to a picture at a quality from 1 to 100: blocks of eight, cosine transform,
/// rounding with the standard's table. It shows how much of it a method bears.
fn jpeg_like(grey: &Grey, quality: u32) -> Grey {
    const TABLE: [u16; 64] = [
        16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14,
        17, 22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49,
        64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
    ];
    let q = f64::from(quality.clamp(1, 100));
    let scale = if q < 50.0 { 5000.0 / q } else { 200.0 - 2.0 * q };
    let table = TABLE.map(|t| ((f64::from(t) * scale + 50.0) / 100.0).floor().clamp(1.0, 255.0));
    let wave: [[f64; 8]; 8] = std::array::from_fn(|k| {
        let c = if k == 0 { 0.125f64.sqrt() } else { 0.5 };
        std::array::from_fn(|n| c * grainpath_core::math::cos((2 * n + 1) as f64 * k as f64 * PI / 16.0))
    });
    let mut out = grey.clone();
    for by in (0..grey.height).step_by(8) {
        for bx in (0..grey.width).step_by(8) {
            let pixel =
                |x: usize, y: usize| grey.at((bx + x).min(grey.width - 1), (by + y).min(grey.height - 1));
            let value = |x: usize, y: usize| (f64::from(pixel(x, y)) * 255.0).round() - 128.0;
            let mut rounded = [[0.0; 8]; 8];
            for (v, row) in rounded.iter_mut().enumerate() {
                for (u, r) in row.iter_mut().enumerate() {
                    let each = (0..64).map(|k| value(k % 8, k / 8) * wave[u][k % 8] * wave[v][k / 8]);
                    let t = table[8 * v + u];
                    *r = (each.sum::<f64>() / t).round() * t;
                }
            }
            for y in 0..8.min(grey.height - by) {
                for x in 0..8.min(grey.width - bx) {
                    let each = (0..64).map(|k| rounded[k / 8][k % 8] * wave[k % 8][x] * wave[k / 8][y]);
                    out.data[(by + y) * grey.width + bx + x] =
                        ((each.sum::<f64>() + 128.0) / 255.0).clamp(0.0, 1.0) as f32;
                }
            }
        }
    }
    out
}

/// Darkens a picture towards its corners, to show how much of it a method bears.
fn vignetted(grey: &Grey, strength: f64) -> Grey {
    let middle = DVec2::new(grey.width as f64, grey.height as f64) * 0.5;
    Grey::from_fn(grey.width, grey.height, |x, y| {
        let r2 = ((DVec2::new(x as f64, y as f64) - middle) / middle).length_squared();
        grey.at(x, y) * exp(-strength * r2) as f32
    })
}

const SETTINGS: TensorSettings = TensorSettings { gradient_mm: 0.15, integration_mm: 0.6, smooth_mm: 0.5 };

/// Mean angle to the truth, degrees, over all points that have a true direction.
fn mean_error_deg(board: &Board, photo: &Grey) -> f64 {
    let (w, h) = (photo.width as f64, photo.height as f64);
    let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(DVec2::from);
    let image = rectify(photo, corners, board.size_mm, board.size_mm.x / w);
    let axes = grain_axes(&image, &SETTINGS);
    let (mut sum, mut n) = (0.0, 0);
    for j in 1..60 {
        for i in 1..200 {
            let p = board.size_mm * DVec2::new(f64::from(i) / 200.0, f64::from(j) / 60.0);
            if let Some(truth) = board.axis_rad(p, 0.4) {
                sum += axis_difference_rad(axes.sample(p).axis_rad(), truth).to_degrees();
                n += 1;
            }
        }
    }
    sum / f64::from(n)
}

#[test]
fn the_grain_of_boards_is_found_whatever_the_photograph() {
    let mut rows = Vec::new();
    for noise in [0.0, 0.02, 0.06] {
        for (uneven_light, blur, quality) in [(0.0, 0.0, 100), (0.3, 1.0, 90), (0.6, 2.0, 70), (0.3, 0.5, 40)]
        {
            for knots in [
                vec![],
                Board::default().knots,
                vec![
                    Knot { centre_mm: DVec2::new(28.0, 10.0), radius_mm: 3.0 },
                    Knot { centre_mm: DVec2::new(70.0, 20.0), radius_mm: 5.0 },
                ],
            ] {
                let board = Board { noise, uneven_light, knots, seed: 7, ..Board::default() };
                let photo = vignetted(&jpeg_like(&board.flat(0.1, blur), quality), 0.5 * uneven_light);
                let error = mean_error_deg(&board, &photo);
                rows.push((error, format!("noise {noise} light {uneven_light} blur {blur} quality {quality} knots {}: {error:.2} deg", board.knots.len())));
            }
        }
    }
    for (_, row) in &rows {
        println!("{row}");
    }
    let wrong: Vec<&String> = rows.iter().filter(|(e, _)| *e > 3.0).map(|(_, row)| row).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn jpeg_at_full_quality_changes_little() {
    let photo = Board::default().flat(0.2, 0.5);
    let off = |q| {
        let coded = jpeg_like(&photo, q);
        photo.data.iter().zip(&coded.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    assert!(off(100) < 0.012 && off(20) > 0.03, "{} {}", off(100), off(20));
}

fn board_image() -> (Board, MetricImage) {
    let board = Board::default();
    let photo = board.flat(0.08, 0.5);
    let (w, h) = (photo.width as f64, photo.height as f64);
    let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(DVec2::from);
    let mut image = rectify(&photo, corners, board.size_mm, 0.08);
    image.grey = image.grey.blurred(2.5);
    (board, image)
}

#[test]
fn a_board_on_a_cloth_is_found_to_a_pixel() {
    for corners in [
        [(110.0, 90.0), (860.0, 130.0), (830.0, 380.0), (140.0, 330.0)],
        [(60.0, 200.0), (700.0, 60.0), (780.0, 260.0), (130.0, 420.0)],
    ] {
        let corners = corners.map(DVec2::from);
        let photo = Board::default().photograph(960, 480, corners);
        let found = find_corners(&photo).expect("a board");
        for (f, c) in found.iter().zip(corners) {
            assert!(f.distance(c) < 1.0, "{f} should be {c}");
        }
    }
}

#[test]
fn no_board_is_said() {
    assert!(find_corners(&Grey::filled(300, 200, 0.5)).is_err());
    let whole = Board::default().flat(0.2, 0.5);
    assert!(find_corners(&whole).is_err());
    let disc = Grey::from_fn(300, 300, |x, y| {
        let d = (x as f64 - 150.0).powi(2) + (y as f64 - 150.0).powi(2);
        if d < 8000.0 { 0.9 } else { 0.1 }
    });
    assert!(find_corners(&disc).is_err());
}

#[test]
fn curves_follow_the_grain_both_ways_of_joining() {
    let (board, image) = board_image();
    let edges = canny(&image.grey, &CannySettings::default());
    for join in [Join::Trace, Join::Nearest] {
        let curves = edge_curves(&edges, &image, &CurveSettings { join, ..CURVES });
        let total: f64 = curves.iter().map(|c| length_mm(c, false)).sum();
        let (mut sum, mut weight, mut jump) = (0.0, 0.0, 0.0f64);
        for w in curves.iter().flat_map(|c| c.windows(5)) {
            let d = w[4] - w[0];
            jump = jump.max(d.length());
            if let Some(truth) = board.axis_rad(w[2], 0.6) {
                let angle = atan2(d.y, d.x);
                sum += axis_difference_rad(angle, truth).to_degrees() * d.length();
                weight += d.length();
            }
        }
        println!("{join:?}: {} curves, {total:.0} mm, {:.2} deg", curves.len(), sum / weight);
        // About 20 growth lines of 100 mm with two flanks, where both flanks are sharp enough.
        assert!(total > 1200.0, "{join:?}: {total}");
        assert!(sum / weight < 6.0, "{join:?}: {}", sum / weight);
        assert!(jump < 2.0, "{join:?}: a jump of {jump}");
    }
    let longest = edge_curves(&edges, &image, &CURVES).first().map_or(0.0, |c| length_mm(c, false));
    assert!(longest > 60.0, "{longest}");
}

/// The corners of a board in the middle of a picture, seen by a camera of this focal length (in diagonals). The board is
/// rotated in its plane, then tilted about an axis in the picture.
fn view(
    size_mm: DVec2,
    size_px: DVec2,
    [turn_deg, tilt_deg, axis_deg]: [f64; 3],
    focal: f64,
    share: f64,
) -> [DVec2; 4] {
    let (s, c) = sin_cos(tilt_deg.to_radians());
    let axis = direction(axis_deg.to_radians());
    let across = DVec2::new(-axis.y, axis.x);
    let focal_px = focal * size_px.length();
    // The board's diagonal takes this share of the picture's.
    let distance_mm = focal / share * size_mm.length();
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
        let p = rotated(0.5 * size_mm * DVec2::new(x, y), direction(turn_deg.to_radians()));
        let (along, off) = (p.dot(axis), p.dot(across));
        0.5 * size_px + focal_px * (along * axis + c * off * across) / (distance_mm + s * off)
    })
}

#[test]
fn the_outline_of_a_board_gives_its_width_from_every_side() {
    let board = Board::default();
    let size_px = DVec2::new(720.0, 960.0);
    for turn in (0..12).map(|k| 30.0 * f64::from(k)) {
        for (tilt, axis) in [(0.0, 0.0), (30.0, 20.0), (45.0, 110.0)] {
            let truth = view(board.size_mm, size_px, [turn, tilt, axis], 0.62, 0.54);
            let photo = board.photograph(720, 960, truth);
            let found = find_corners(&photo).unwrap_or_else(|e| panic!("turned {turn}, tilted {tilt}: {e}"));
            let corners = oriented(found, board.size_mm, size_px).expect("a board of this size").corners;
            // An outline cannot show a half turn.
            let half_turned = [truth[2], truth[3], truth[0], truth[1]];
            let off =
                |to: &[DVec2; 4]| corners.iter().zip(to).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            let worst = off(&truth).min(off(&half_turned));
            assert!(worst < 2.0, "turned {turn}, tilted {tilt} about {axis}: {worst} px off");
        }
    }
}

#[test]
fn the_outline_gives_the_grain_whatever_lens_tilt_and_crop() {
    let size_px = DVec2::new(640.0, 480.0);
    let mut worst = (0.0f64, String::new());
    let (mut n, mut n_guessed) = (0, 0);
    for size_mm in [(60.0, 50.0), (70.0, 50.0), (120.0, 50.0)].map(DVec2::from) {
        let board = Board { size_mm, knots: Vec::new(), ..Board::default() };
        for (tilt, turn, axis) in [0.0, 35.0, 50.0, 60.0]
            .into_iter()
            .flat_map(|tilt| [(0.0, 90.0), (0.0, 0.0), (20.0, 60.0)].map(|(turn, axis)| (tilt, turn, axis)))
        {
            // 27 and 56 mm as 35 mm equivalent.
            for focal in [0.62, 1.3] {
                let truth = view(size_mm, size_px, [turn, tilt, axis], focal, 0.45);
                let whole = board.photograph(640, 480, truth);
                let low = truth.into_iter().reduce(DVec2::min).expect("four corners").floor() - 20.0;
                let high = truth.into_iter().reduce(DVec2::max).expect("four corners").ceil() + 20.0;
                let (low, high) = (low.max(DVec2::ZERO), high.min(size_px));
                let cropped = Grey::from_fn((high.x - low.x) as usize, (high.y - low.y) as usize, |x, y| {
                    whole.at(x + low.x as usize, y + low.y as usize)
                });
                for (photo, cut) in [(&whole, "whole"), (&cropped, "cropped")] {
                    let what = format!(
                        "{size_mm} {cut}, turned {turn}, tilted {tilt} about {axis}, focal length {focal}"
                    );
                    let found = find_corners(photo).unwrap_or_else(|e| panic!("{what}: {e}"));
                    let picture = DVec2::new(photo.width as f64, photo.height as f64);
                    let found = oriented(found, size_mm, picture).unwrap_or_else(|e| panic!("{what}: {e}"));
                    n += 1;
                    if found.turn != Turn::Certain {
                        // The user is told to look at the numbered corners.
                        n_guessed += 1;
                        assert!(tilt > 0.0 && size_mm.x < 1.7 * size_mm.y, "{what}: a guess");
                        continue;
                    }
                    let image = rectify(photo, found.corners, size_mm, 0.25);
                    let axes = grain_axes(&image, &SETTINGS);
                    let points = (0..800).map(|k| {
                        let share = DVec2::new(f64::from(k % 40) + 0.5, f64::from(k / 40) + 0.5);
                        size_mm * share / DVec2::new(40.0, 20.0)
                    });
                    // An outline cannot show a half turn.
                    let errors = [false, true].map(|half_turn| {
                        let off = points.clone().filter_map(|p| {
                            let truth = board.axis_rad(if half_turn { size_mm - p } else { p }, 0.4)?;
                            Some(axis_difference_rad(axes.sample(p).axis_rad(), truth).to_degrees())
                        });
                        let (sum, n) = off.fold((0.0, 0), |(sum, n), e| (sum + e, n + 1));
                        sum / f64::from(n)
                    });
                    let error = errors[0].min(errors[1]);
                    if error > worst.0 {
                        worst = (error, what);
                    }
                }
            }
        }
    }
    println!("{n} views, {n_guessed} warned of; grain off by up to {:.2} degrees: {}", worst.0, worst.1);
    assert!(worst.0 < 8.0 && n_guessed < n / 2, "{worst:?}, {n_guessed} of {n} warned of");
}
