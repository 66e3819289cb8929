//! Walls of plates that no whole number of beads fits, and dense fill beside walls at flat angles.

use grainpath::measure::report::{QualityReport, measure};
use grainpath::wall::{WallSettings, lay_walls};
use grainpath_core::failure_svg::FailurePicture;
use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::Join;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{BeadWidth, DVec2, Diagnostics, Layer, LayerStack, Polygon, Role};
use grainpath_gcode::{simulate, write_gcode};
use grainpath_job::parse_job;

const SETTINGS: WallSettings = WallSettings {
    n_walls: 2,
    bead_width_mm: 0.45,
    height_mm: 0.2,
    thin_walls: true,
    gap_fill: true,
    min_bead_width_mm: 0.2,
    fill_overlap: 0.0,
};

/// Of a plate of any thickness that walls and single beads fill alone, the beads have the volume, and the outer
/// edges stay on the border.
#[test]
fn a_thin_plate_is_filled_whatever_its_thickness() {
    let s = bead_spacing_mm(0.45, 0.2);
    let turn = direction(0.4);
    let mut widened = 0;
    for step in 0..57 {
        let thick = 0.75 + 0.02 * f64::from(step);
        let corners = [(-20.0, -0.5), (20.0, -0.5), (20.0, 0.5), (-20.0, 0.5)];
        let outer = corners.map(|(x, y)| rotated(DVec2::new(x, y * thick), turn)).to_vec();
        let plate = Polygon { outer, holes: Vec::new() };
        let walls = lay_walls(&plate, &SETTINGS);
        let mut picture = FailurePicture::new("walls of a thin plate");
        picture.region("plate", &plate.clone().into());
        let beads: Vec<_> = walls.loops.iter().map(|w| &w.path).chain(&walls.singles).collect();
        beads.iter().for_each(|b| picture.line("bead", &b.points));
        let fill = walls.fill.offset(0.5 * s, Join::Miter(3.0));
        let laid = beads.iter().map(|b| b.volume_mm3(0.2)).sum::<f64>() / 0.2 + fill.area_mm2();
        // The round edges of the outermost beads leave the rest open.
        let asked = plate.area_mm2() - 0.5 * (0.45 - s) * plate.perimeter_mm();
        assert!((laid / asked - 1.0).abs() < 0.02, "{thick:.2} mm: {laid} of {asked} mm2");
        for path in beads.iter().filter(|b| b.role == Role::OuterWall) {
            widened += usize::from(matches!(path.width, BeadWidth::PerVertex(_)));
            // Beads are written with the mean width of each piece: at neither end it leaves the plate.
            for i in 0..path.n_segments() {
                let (a, b, width) = path.segment(i);
                for p in [a, b].map(|p| rotated(p, DVec2::new(turn.x, -turn.y))) {
                    let out = (p.y.abs() - 0.5 * thick).max(p.x.abs() - 20.0) + 0.5 * width;
                    assert!(out < 0.006, "{thick:.2} mm: {out} mm outside at {p}");
                }
            }
            let mut wide = (f64::INFINITY, 0.0);
            for (i, &p) in path.points.iter().enumerate() {
                let p = rotated(p, DVec2::new(turn.x, -turn.y));
                // At the ends of the plate nothing lies across.
                if p.x.abs() < 19.0 {
                    let edge = p.y.abs() + 0.5 * path.width_at(i);
                    assert!((edge - 0.5 * thick).abs() < 1e-3, "{thick:.2} mm: edge at {edge}");
                    // The other side lies across everywhere, so that all of the side is as wide.
                    wide.0 = f64::min(wide.0, path.width_at(i));
                    wide.1 = f64::max(wide.1, path.width_at(i));
                }
            }
            assert!(wide.1 - wide.0 < 0.01, "{thick:.2} mm: {wide:?} mm wide");
        }
    }
    assert!(widened > 5, "{widened} plates with widened outer walls");
}

/// Of a ring of any thickness the beads have the volume: in round places the other side lies across too.
#[test]
fn a_thin_ring_is_filled_whatever_its_thickness() {
    let s = bead_spacing_mm(0.45, 0.2);
    let circle = |r: f64, sign: f64| {
        (0..120).map(|k| r * direction(sign * f64::from(k) * std::f64::consts::TAU / 120.0)).collect()
    };
    for step in 0..57 {
        let thick = 0.75 + 0.02 * f64::from(step);
        let ring = Polygon { outer: circle(2.5 + thick, 1.0), holes: vec![circle(2.5, -1.0)] };
        let walls = lay_walls(&ring, &SETTINGS);
        let beads = walls.loops.iter().map(|w| &w.path).chain(&walls.singles);
        let fill = walls.fill.offset(0.5 * s, Join::Miter(3.0));
        let laid = beads.map(|b| b.volume_mm3(0.2)).sum::<f64>() / 0.2 + fill.area_mm2();
        let asked = ring.area_mm2() - 0.5 * (0.45 - s) * ring.perimeter_mm();
        assert!((laid / asked - 1.0).abs() < 0.02, "{thick:.2} mm: {laid} of {asked} mm2");
    }
}

/// Gap, overlap and spill of layers with this section, filled densely.
fn quality(section: &Polygon) -> QualityReport {
    let job = "[fill]\npattern = \"rectilinear\"\ndensity = 1\n";
    let settings = parse_job(job, "job.toml", &[], &|path| Err(path.to_owned())).expect("a sound job");
    let layer =
        |k: i32| Layer::new(0.2 * f64::from(k + 1), 0.2, section.clone().into()).expect("a sound layer");
    let stack = LayerStack::new((0..8).map(layer).collect()).expect("heights rise");
    let quiet = Diagnostics::default();
    let planned = grainpath::plan_layers(&settings, stack, "a section", None, None, &[], None, &quiet);
    let planned = planned.expect("a plan");
    let mut bytes = Vec::new();
    write_gcode(&planned.plan, &planned.config, &[], &mut bytes).expect("memory takes all");
    let machine = &planned.config.machine;
    let program = simulate(&bytes, machine.filament_mm, &machine.limits).expect("our own program");
    measure(&planned, &program)
}

/// Beads beside walls that the lines meet at a small angle go on into the tips of the wedges.
#[test]
fn stars_are_filled_into_the_wedges_beside_their_sides() {
    for (n_tips, inner_mm, most) in [(5, 6.0, 0.005), (12, 11.0, 0.0025)] {
        let corner = |k: u32| {
            let radius = if k.is_multiple_of(2) { 15.0 } else { inner_mm };
            radius * direction(std::f64::consts::PI * f64::from(k) / f64::from(n_tips))
        };
        let found = quality(&Polygon { outer: (0..2 * n_tips).map(corner).collect(), holes: Vec::new() });
        println!("{n_tips} tips: {found:?}");
        assert!(found.gap < most && found.overlap < 0.005 && found.spill < 1e-3, "{n_tips} tips: {found:?}");
    }
}

/// Where lines turn at a wall, the acute corner reaches into the notch beside it, at no more than the volume of the area.
#[test]
fn notches_beside_acute_corners_are_filled() {
    // A square, and a plate whose lines are so short that they cannot become narrow enough for all notches.
    for (size, most, overlap) in [([20.0, 20.0], 5e-4, 5e-4), ([60.0, 3.17], 0.0055, 0.016)] {
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let outer = corners.map(|(x, y)| DVec2::new(x * size[0], y * size[1])).to_vec();
        let found = quality(&Polygon { outer, holes: Vec::new() });
        println!("{size:?} mm: {found:?}");
        assert!(found.gap < most && found.overlap < overlap && found.spill < 1e-4, "{size:?} mm: {found:?}");
    }
}
