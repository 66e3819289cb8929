//! Infill regions of all shapes under fields of all kinds: one path, nothing crossed, nothing left open.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use grainpath_core::math::{atan2, cross, direction, sin_cos};
use grainpath_core::poly::{FillRule, Join};
use grainpath_core::{DVec2, DVec3, DirectionField, DirectionSample, Polygon, Region, Role, Toolpath};
use proptest::prelude::*;

use super::super::field::stripes::covered;
use super::rings::Rings;
use super::strips::parted;
use super::{Continuous, Note, Problem, TreeKind};
use crate::fill::{FillContext, Infill};

const HEIGHT: f64 = 0.2;
const WIDTH: f64 = 0.45;

/// A field given by its angle.
struct Angle<F>(F);

impl<F: Fn(DVec2) -> f64 + Send + Sync> DirectionField for Angle<F> {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let axis_rad = (self.0)(p.truncate()).rem_euclid(PI);
        DirectionSample { axis_rad, strength: 1.0, principal_mpa: None }
    }
}

fn disc(centre: DVec2, radius: f64, n: usize) -> Region {
    let outer = (0..n).map(|i| centre + radius * direction(i as f64 / n as f64 * TAU)).collect();
    Region::from(Polygon { outer, holes: Vec::new() })
}

pub(super) fn context<'a>(part: &Region, width: f64, field: &'a dyn DirectionField) -> FillContext<'a> {
    FillContext {
        z_mid_mm: 0.1,
        height_mm: HEIGHT,
        bead_width_mm: width,
        min_bead_width_mm: 0.2,
        density: grainpath_core::Density::Dense,
        angle_rad: 0.0,
        part: part.bounds().expect("not empty"),
        role: Role::SolidFill,
        border_mm: 0.5 * width,
        ends: grainpath_job::choices::BeadEnds::Joined,
        shift: crate::fill::Shift::NONE,
        below: None,
        fills_wedges: true,
        widths: grainpath_job::choices::BeadWidths::Variable,
        field: Some(field),
    }
}

/// The paths of a part without walls, and what was noted.
fn filled(
    continuous: Continuous,
    part: &Region,
    width: f64,
    field: &dyn DirectionField,
) -> (Vec<Toolpath>, Vec<Note>) {
    let (mut paths, mut notes) = (Vec::new(), Vec::new());
    let infill_regions = part.offset(-0.5 * width, Join::Miter(3.0)).polygons;
    let infill_regions: Vec<&Polygon> = infill_regions.iter().collect();
    continuous.lay_island(&context(part, width, field), &infill_regions, &mut paths, &mut notes);
    (paths, notes)
}

/// Mean angle to the field, degrees.
fn off_field(paths: &[Toolpath], field: &dyn DirectionField) -> f64 {
    let (mut sum, mut length) = (0.0, 0.0);
    for path in paths {
        for i in 0..path.n_segments() {
            let (a, b, _) = path.segment(i);
            let u = direction(field.sample((0.5 * (a + b)).extend(0.1)).axis_rad);
            sum += atan2(cross(u, b - a).abs(), u.dot(b - a).abs()).to_degrees() * a.distance(b);
            length += a.distance(b);
        }
    }
    sum / length
}

/// The share of a part that no bead lies on: their full widths count, as of beads in a layer of no height.
fn gap(paths: &[Toolpath], part: &Region) -> f64 {
    part.difference(&covered(paths, 1e-6)).area_mm2() / part.area_mm2()
}

fn parts() -> Vec<(&'static str, Region)> {
    let plate = Region::rectangle(DVec2::new(-20.0, -12.0), DVec2::new(20.0, 12.0));
    let holes = (0..12).fold(plate.clone(), |r, k| {
        let at = DVec2::new(-15.0 + 10.0 * f64::from(k % 4), -8.0 + 8.0 * f64::from(k / 4));
        r.difference(&disc(at, 1.3, 24))
    });
    let bells = disc(DVec2::new(-8.0, 0.0), 5.0, 60).union(&disc(DVec2::new(8.0, 0.0), 5.0, 60));
    vec![
        ("open hole", plate.difference(&disc(DVec2::ZERO, 4.0, 60))),
        ("holes", holes),
        ("thin ring", disc(DVec2::ZERO, 12.0, 100).difference(&disc(DVec2::ZERO, 11.1, 90))),
        ("neck", bells.union(&Region::rectangle(DVec2::new(-8.0, -0.3), DVec2::new(8.0, 0.3)))),
        ("bar", Region::rectangle(DVec2::new(-20.0, -1.5), DVec2::new(20.0, 1.5))),
    ]
}

type NamedAngle = (&'static str, fn(DVec2) -> f64);

const FIELDS: [NamedAngle; 5] = [
    ("straight", |_| 0.3),
    ("rings", |p| atan2(p.y + 40.0, p.x + 5.0) + FRAC_PI_2),
    ("half turn", |p| 0.5 * atan2(p.y - 1.3, p.x - 8.1)),
    ("circles", |p| atan2(p.y, p.x) + FRAC_PI_2),
    ("waves", |p| 0.4 * sin_cos(p.x / 9.0).0 + 0.5 * sin_cos(p.y / 7.0).0),
];

#[test]
fn every_part_is_one_path_along_the_field() {
    for (name, part) in parts() {
        for (kind, angle) in FIELDS {
            let field = Angle(angle);
            let (paths, notes) = filled(Continuous::FOR_TESTS, &part, WIDTH, &field);
            let open = gap(&paths, &part);
            let off = off_field(&paths, &field);
            println!("{name}, {kind}: {} paths, gap {open:.4}, {off:.2} deg", paths.len());
            assert_eq!(paths.len(), 1, "{name}, {kind}: {notes:?}");
            assert!(notes.is_empty() && paths[0].closed, "{name}, {kind}: {notes:?}");
            assert!(open < 0.03, "{name}, {kind}: gap {open}");
            // Where the part is a few beads wide, turning back is a good part of the way.
            if !["thin ring", "bar"].contains(&name) {
                let undirected = Continuous { tree: TreeKind::Undirected, ..Continuous::FOR_TESTS };
                let other = off_field(&filled(undirected, &part, WIDTH, &field).0, &field);
                let most = if name == "open hole" { 6.5 } else { 14.0 };
                assert!(off < most && off < 0.7 * other, "{name}, {kind}: {off}, undirected {other}");
            }
        }
    }
}

#[test]
fn beads_of_one_width_leave_little_open() {
    let constant = Continuous { variable: false, ..Continuous::FOR_TESTS };
    for (name, part) in parts().into_iter().filter(|p| p.0 != "thin ring") {
        for (kind, angle) in FIELDS {
            let (paths, notes) = filled(constant, &part, WIDTH, &Angle(angle));
            assert!(paths.len() == 1 && notes.is_empty(), "{name}, {kind}: {notes:?}");
            let open = gap(&paths, &part);
            assert!(open < 0.08, "{name}, {kind}: gap {open}");
            assert!((0..paths[0].points.len()).all(|v| paths[0].width_at(v) == WIDTH));
        }
    }
}

#[test]
fn a_neck_thinner_than_a_bead_is_named() {
    let bells = disc(DVec2::new(-8.0, 0.0), 5.0, 60).union(&disc(DVec2::new(8.0, 0.0), 5.0, 60));
    let part = bells.union(&Region::rectangle(DVec2::new(-8.0, -0.15), DVec2::new(8.0, 0.15)));
    let (paths, notes) = filled(Continuous::FOR_TESTS, &part, WIDTH, &Angle(|_| 0.0));
    assert_eq!(paths.len(), 2);
    let [note] = notes.as_slice() else { panic!("{notes:?}") };
    assert!(matches!(note.what, Problem::Neck { .. }) && note.at_mm.length() < 0.5, "{note:?}");
}

#[test]
fn regions_of_no_size_get_no_beads_outside() {
    let sliver = Region::rectangle(DVec2::ZERO, DVec2::new(5.0, 0.01));
    let crumb = Region::rectangle(DVec2::ZERO, DVec2::splat(0.05));
    let field = Angle(|p: DVec2| p.x);
    for part in [sliver, crumb] {
        let mut paths = Vec::new();
        Continuous::FOR_TESTS.fill(&context(&part, WIDTH, &field), &part.polygons[0], &mut paths);
        let near = part.offset(1e-3, Join::Miter(3.0));
        assert!(paths.iter().flat_map(|p| &p.points).all(|p| near.contains(*p)), "{paths:?}");
        let length: f64 = paths.iter().map(Toolpath::length_mm).sum();
        assert!(length <= part.polygons[0].perimeter_mm() + WIDTH, "{length}");
    }
    let empty = Polygon::default();
    let part = Region::rectangle(DVec2::ZERO, DVec2::splat(1.0));
    let mut paths = Vec::new();
    Continuous::FOR_TESTS.fill(&context(&part, WIDTH, &field), &empty, &mut paths);
    assert!(paths.is_empty(), "{paths:?}");
}

/// A star-shaped polygon, down to spikes, with holes that may meet each other and the outline.
fn polygon() -> impl Strategy<Value = Region> {
    let radii = (0.35f64..0.9, proptest::collection::vec(0.0f64..1.0, 5..40));
    let holes = proptest::collection::vec((0.0f64..TAU, 0.0f64..0.9, 0.3f64..2.5, 5usize..30), 0..6);
    (radii, holes, 4.0f64..16.0).prop_map(|((least, radii), holes, size)| {
        let n = radii.len() as f64;
        let outer = radii
            .iter()
            .enumerate()
            .map(|(i, r)| direction(i as f64 / n * TAU) * (least + (1.0 - least) * *r) * size)
            .collect();
        let whole = Region::from(Polygon { outer, holes: Vec::new() });
        holes.into_iter().fold(whole, |part, (turn, out, radius, sides)| {
            part.difference(&disc(direction(turn) * out * size, radius, sides))
        })
    })
}

/// Whether two segments of a path that do not follow each other have a point in common, found by
/// looking at all.
fn crosses_itself(path: &Toolpath) -> bool {
    let n = path.n_segments();
    let side = |o: DVec2, e: DVec2, p: DVec2| cross(e - o, p - o);
    (0..n).any(|i| {
        let (a, b, _) = path.segment(i);
        (i + 2..n).filter(|&j| (j + 1) % n != i).any(|j| {
            let (c, d, _) = path.segment(j);
            // On one line they may still lie apart.
            let apart = a.max(b).cmplt(c.min(d)).any() || c.max(d).cmplt(a.min(b)).any();
            !apart && side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn any_region_under_any_field_is_one_path(
        part in polygon(),
        c in proptest::array::uniform8(0.0f64..1.0),
        width in 0.35f64..0.6,
        variable in proptest::bool::ANY,
    ) {
        let field = Angle(move |p: DVec2| {
            3.0 * c[0] + c[1] * sin_cos(0.25 * c[2] * p.x + 6.0 * c[3]).0
                + c[4] * sin_cos(0.25 * c[5] * p.y + 6.0 * c[6]).0
                + if c[7] < 0.5 { 0.5 * atan2(p.y - 3.0 * c[1], p.x - 3.0 * c[4]) } else { 0.0 }
        });
        let continuous = Continuous { variable, ..Continuous::FOR_TESTS };
        for infill_region in part.offset(-0.5 * width, Join::Miter(3.0)).polygons {
            // A crumb is less than a bead there and back.
            if infill_region.area_mm2() < 4.0 * width * width {
                continue;
            }
            let (mut paths, mut notes) = (Vec::new(), Vec::new());
            continuous.lay_island(&context(&part, width, &field), &[&infill_region], &mut paths, &mut notes);
            prop_assert!(notes.is_empty(), "{notes:?}");
            prop_assert_eq!(paths.len(), 1);
            prop_assert!(paths[0].closed && !crosses_itself(&paths[0]));
            // A round nozzle reaches no further into corners.
            let reach = Region::from(infill_region.clone()).offset(0.5 * width, Join::Round);
            let open = gap(&paths, &reach);
            // What is no longer than a few beads cannot be filled well by any path.
            let most = match (infill_region.area_mm2() > 80.0 * width * width, variable) {
                (true, true) => 0.08,
                (true, false) => 0.15,
                (false, _) => 0.3,
            };
            prop_assert!(open < most, "gap {}", open);
            let mut again = Vec::new();
            continuous.lay_island(&context(&part, width, &field), &[&infill_region], &mut again, &mut Vec::new());
            prop_assert_eq!(&paths, &again);
        }
    }
}

#[test]
fn strips_that_touch_are_taken_apart() {
    let square =
        |x: f64| Region::rectangle(DVec2::new(x, 0.0), DVec2::new(x + 4.0, 4.0)).polygons.remove(0).outer;
    // The second one's corner lies on the side of the first.
    let turned: Vec<DVec2> =
        square(0.0).iter().map(|p| DVec2::new(4.0 + p.x + p.y, 2.0 + p.x - p.y)).rev().collect();
    let infill_region = Region::rectangle(DVec2::splat(-9.0), DVec2::splat(20.0)).polygons.remove(0);
    let rings = Rings::new(vec![square(0.0), turned], &infill_region, WIDTH);
    let touching = rings.crossings();
    assert!(
        !touching.is_empty() && touching.iter().all(|p| p.distance(DVec2::new(4.0, 2.0)) < 1e-6),
        "{touching:?}"
    );
    let loops: Vec<Vec<DVec2>> = rings.lines.into_iter().map(|l| l.points).collect();
    let apart = parted(&loops, &touching, WIDTH);
    let area: f64 = Region::from_contours(&apart, FillRule::Positive).area_mm2();
    assert!(apart.len() == 2 && area > 47.8 && area < 48.0, "{} {area}", apart.len());
    assert!(Rings::new(apart, &infill_region, WIDTH).crossings().is_empty());
}
