//! Walls of plates that no whole number of beads fits.

use grainpath::wall::{WallSettings, lay_walls};
use grainpath_core::failure_svg::FailurePicture;
use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::Join;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{BeadWidth, DVec2, Polygon, Role};

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
            for (i, &p) in path.points.iter().enumerate() {
                let p = rotated(p, DVec2::new(turn.x, -turn.y));
                // At the ends of the plate nothing lies across.
                if p.x.abs() < 19.0 {
                    let edge = p.y.abs() + 0.5 * path.width_at(i);
                    assert!((edge - 0.5 * thick).abs() < 1e-3, "{thick:.2} mm: edge at {edge}");
                }
            }
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
