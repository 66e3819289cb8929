//! Rooms of all shapes under fields of all kinds: one path, nothing crossed, nothing left open.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use grainpath_core::math::{atan2, cross, direction, sin_cos};
use grainpath_core::poly::Join;
use grainpath_core::{DVec2, DVec3, DirectionField, DirectionSample, Polygon, Region, Role, Toolpath};
use proptest::prelude::*;

use super::super::field::stripes::covered;
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

fn context<'a>(part: &Region, width: f64, field: &'a dyn DirectionField) -> FillContext<'a> {
    FillContext {
        z_mid_mm: 0.1,
        height_mm: HEIGHT,
        bead_width_mm: width,
        density: 1.0,
        angle_rad: 0.0,
        part: part.bounds().expect("not empty"),
        role: Role::SolidFill,
        border_mm: 0.5 * width,
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
    let rooms = part.offset(-0.5 * width, Join::Miter(3.0)).polygons;
    let rooms: Vec<&Polygon> = rooms.iter().collect();
    continuous.lay_island(&context(part, width, field), &rooms, &mut paths, &mut notes);
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
            let (paths, notes) = filled(Continuous::DEFAULT, &part, WIDTH, &field);
            let open = gap(&paths, &part);
            let off = off_field(&paths, &field);
            println!("{name}, {kind}: {} paths, gap {open:.4}, {off:.2} deg", paths.len());
            assert_eq!(paths.len(), 1, "{name}, {kind}: {notes:?}");
            assert!(notes.is_empty() && paths[0].closed, "{name}, {kind}: {notes:?}");
            assert!(open < 0.03, "{name}, {kind}: gap {open}");
            // Where the part is a few beads wide, turning back is a good part of the way.
            if name == "open hole" {
                let undirected = Continuous { tree: TreeKind::Undirected, ..Continuous::DEFAULT };
                let other = off_field(&filled(undirected, &part, WIDTH, &field).0, &field);
                assert!(off < 8.0 && off < 0.7 * other, "{name}, {kind}: {off}, undirected {other}");
            }
        }
    }
}

#[test]
fn beads_of_one_width_leave_little_open() {
    let constant = Continuous { variable: false, ..Continuous::DEFAULT };
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
    let (paths, notes) = filled(Continuous::DEFAULT, &part, WIDTH, &Angle(|_| 0.0));
    assert_eq!(paths.len(), 2);
    let [note] = notes.as_slice() else { panic!("{notes:?}") };
    assert!(matches!(note.what, Problem::Neck { .. }) && note.at_mm.length() < 0.5, "{note}");
}

#[test]
fn rooms_of_no_size_do_no_harm() {
    let sliver = Region::rectangle(DVec2::ZERO, DVec2::new(5.0, 0.01));
    let crumb = Region::rectangle(DVec2::ZERO, DVec2::splat(0.05));
    let field = Angle(|p: DVec2| p.x);
    for part in [sliver, crumb] {
        Continuous::DEFAULT.fill(&context(&part, WIDTH, &field), &part.polygons[0], &mut Vec::new());
    }
    let empty = Polygon::default();
    let part = Region::rectangle(DVec2::ZERO, DVec2::splat(1.0));
    Continuous::DEFAULT.fill(&context(&part, WIDTH, &field), &empty, &mut Vec::new());
}

/// A star-shaped polygon with holes: smooth enough that most of it is wider than two beads.
fn polygon() -> impl Strategy<Value = Region> {
    let radii = proptest::collection::vec(0.6f64..1.0, 5..30);
    let holes = proptest::collection::vec((0.0f64..TAU, 0.0f64..0.9, 0.4f64..2.5, 5usize..30), 0..6);
    (radii, holes, 6.0f64..16.0).prop_map(|(radii, holes, size)| {
        let n = radii.len() as f64;
        let outer =
            radii.iter().enumerate().map(|(i, r)| direction(i as f64 / n * TAU) * *r * size).collect();
        let whole = Region::from(Polygon { outer, holes: Vec::new() });
        holes.into_iter().fold(whole, |part, (turn, out, radius, sides)| {
            part.difference(&disc(direction(turn) * out * size, radius, sides))
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn any_room_under_any_field_is_one_path_or_says_why(
        part in polygon(),
        c in proptest::array::uniform8(0.0f64..1.0),
        width in 0.35f64..0.6,
    ) {
        let field = Angle(move |p: DVec2| {
            3.0 * c[0] + c[1] * sin_cos(0.25 * c[2] * p.x + 6.0 * c[3]).0
                + c[4] * sin_cos(0.25 * c[5] * p.y + 6.0 * c[6]).0
                + if c[7] < 0.5 { 0.5 * atan2(p.y - 3.0 * c[1], p.x - 3.0 * c[4]) } else { 0.0 }
        });
        for room in part.offset(-0.5 * width, Join::Miter(3.0)).polygons {
            // What is no longer than a few beads cannot be filled well by any path.
            if room.area_mm2() < 80.0 * width * width {
                continue;
            }
            let (mut paths, mut notes) = (Vec::new(), Vec::new());
            Continuous::DEFAULT.lay_island(&context(&part, width, &field), &[&room], &mut paths, &mut notes);
            let apart = |n: &Note| matches!(n.what, Problem::Apart { .. });
            prop_assert!(notes.iter().all(apart), "{notes:?}");
            prop_assert_eq!(paths.len(), 1 + notes.len());
            // Behind a corner a ring may be out of reach; it is never much.
            let rest: f64 = paths[1..].iter().map(Toolpath::length_mm).sum();
            prop_assert!(rest < 0.3 * paths[0].length_mm(), "{notes:?}");
            // A round nozzle reaches no further into corners.
            let reach = Region::from(room.clone()).offset(0.5 * width, Join::Round);
            let open = gap(&paths, &reach);
            prop_assert!(open < 0.1, "gap {}", open);
            let mut again = Vec::new();
            Continuous::DEFAULT.fill(&context(&part, width, &field), &room, &mut again);
            prop_assert_eq!(&paths, &again);
        }
    }
}
