//! Infill regions of different shapes under fields of different kinds.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use grainpath_core::math::{atan2, cross, direction, sin_cos};
use grainpath_core::poly::{FillRule, Join, LineClipper};
use grainpath_core::polyline;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{DVec2, DVec3, DirectionField, DirectionSample, Polygon, Region, Role, Toolpath};

use grainpath_job::choices::{BeadEnds, BeadWidths};

use super::line_ends::{Place, Room, fitted, trimmed};
use super::refit::{Beside, fitted_around};
use super::stripes::{Apart, WideBead, covered, filling_their_space, strips_of};
use super::widths::{Line, Neighbours, Side, is_own, settled};
use super::{SeedLines, Streamlines, Stripes};
use crate::fill::{FillContext, Infill, Solid};

const WIDTH: f64 = 0.45;
const HEIGHT: f64 = 0.2;

/// A field given by its angle.
struct Angle(fn(DVec2) -> f64);

impl DirectionField for Angle {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let axis_rad = (self.0)(p.truncate()).rem_euclid(PI);
        DirectionSample { axis_rad, strength: 1.0, principal_mpa: None }
    }
}

fn rings(p: DVec2) -> f64 {
    atan2(p.y + 40.0, p.x + 5.0) + FRAC_PI_2
}

fn rays(p: DVec2) -> f64 {
    atan2(p.y + 40.0, p.x + 5.0)
}

fn half_turn(p: DVec2) -> f64 {
    0.5 * atan2(p.y - 1.3, p.x - 8.1)
}

fn past_a_hole(p: DVec2) -> f64 {
    let k = 16.0 / p.length_squared().powi(2).max(1.0);
    atan2(-k * 2.0 * p.x * p.y, 1.0 - k * (p.x * p.x - p.y * p.y))
}

fn waves(p: DVec2) -> f64 {
    0.4 * sin_cos(p.x / 9.0).0 + 0.5 * sin_cos(p.y / 7.0).0
}

type NamedAngle = (&'static str, fn(DVec2) -> f64);

const FIELDS: [NamedAngle; 6] = [
    ("straight", |_| 0.3),
    ("rings", rings),
    ("rays", rays),
    ("half turn", half_turn),
    ("past a hole", past_a_hole),
    ("waves", waves),
];

/// A plate with a hole, and a bar too narrow for its field.
fn parts() -> [(&'static str, Region); 2] {
    let disc = |k: usize| direction(k as f64 / 72.0 * TAU) * 4.0;
    let hole = Region::from(Polygon { outer: (0..72).map(disc).collect(), holes: Vec::new() });
    let plate = Region::rectangle(DVec2::splat(-12.0), DVec2::splat(12.0)).difference(&hole);
    let bar = Region::rectangle(DVec2::new(-15.0, 2.0), DVec2::new(15.0, 4.6));
    [("plate", plate), ("bar", bar)]
}

/// Fills a part that has no walls.
fn filled(infill: &dyn Infill, part: &Region, field: fn(DVec2) -> f64, density: f64) -> Vec<Toolpath> {
    filled_with(infill, part, field, density, BeadEnds::Joined)
}

fn filled_with(
    infill: &dyn Infill,
    part: &Region,
    field: fn(DVec2) -> f64,
    density: f64,
    ends: BeadEnds,
) -> Vec<Toolpath> {
    filled_along(infill, part, &Angle(field), density, ends, BeadWidths::Variable)
}

fn filled_along(
    infill: &dyn Infill,
    part: &Region,
    field: &dyn DirectionField,
    density: f64,
    ends: BeadEnds,
    widths: BeadWidths,
) -> Vec<Toolpath> {
    let context = context_along(part, field, density);
    filled_in(&FillContext { ends, widths, ..context }, infill, part)
}

fn context_along<'a>(part: &Region, field: &'a dyn DirectionField, density: f64) -> FillContext<'a> {
    let spacing = bead_spacing_mm(WIDTH, HEIGHT);
    let border_mm = 0.28 * spacing + 0.5 * (WIDTH - spacing);
    FillContext {
        z_mid_mm: 0.1,
        height_mm: HEIGHT,
        bead_width_mm: WIDTH,
        min_bead_width_mm: 0.2,
        density: grainpath_core::Density::new(density),
        angle_rad: 0.0,
        part: part.bounds().expect("not empty"),
        role: Role::SolidFill,
        border_mm,
        ends: BeadEnds::Joined,
        shift: crate::fill::Shift::NONE,
        below: None,
        fills_wedges: true,
        widths: BeadWidths::Variable,
        field: Some(field),
    }
}

fn filled_in(context: &FillContext<'_>, infill: &dyn Infill, part: &Region) -> Vec<Toolpath> {
    let mut out = Vec::new();
    for infill_region in part.offset(-context.border_mm, Join::Miter(2.0)).polygons {
        infill.fill(context, &infill_region, &mut out);
    }
    out
}

/// Mean and 95th percentile of the angle to the field, degrees.
fn alignment(paths: &[Toolpath], field: fn(DVec2) -> f64) -> (f64, f64) {
    alignments(paths, &field)
}

fn alignments(paths: &[Toolpath], field: &dyn Fn(DVec2) -> f64) -> (f64, f64) {
    let mut all: Vec<(f64, f64)> = Vec::new();
    for path in paths {
        for i in 0..path.n_segments() {
            let (a, b, _) = path.segment(i);
            let u = direction(field(0.5 * (a + b)));
            let off = atan2(cross(u, b - a).abs(), u.dot(b - a).abs()).to_degrees();
            all.push((off, a.distance(b)));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let length: f64 = all.iter().map(|a| a.1).sum();
    let mut seen = 0.0;
    let p95 = all.iter().find(|a| {
        seen += a.1;
        seen >= 0.95 * length
    });
    (all.iter().map(|a| a.0 * a.1).sum::<f64>() / length, p95.map_or(0.0, |a| a.0))
}

/// Two segments of these paths that cross, if any; neighbours on one path share an end and do not.
fn crossing(paths: &[Toolpath]) -> Option<[DVec2; 4]> {
    let segments: Vec<(DVec2, DVec2)> =
        paths.iter().flat_map(|p| (0..p.n_segments()).map(|i| (p.segment(i).0, p.segment(i).1))).collect();
    for (i, &(a, b)) in segments.iter().enumerate() {
        for &(c, d) in &segments[i + 1..] {
            let near = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
            let sides = |o: DVec2, e: DVec2, p: DVec2, q: DVec2| cross(e - o, p - o) * cross(e - o, q - o);
            if near && sides(a, b, c, d) < -1e-9 && sides(c, d, a, b) < -1e-9 {
                return Some([a, b, c, d]);
            }
        }
    }
    None
}

#[test]
fn stripes_cover_their_region_along_the_field_and_do_not_cross() {
    for (name, part) in parts() {
        for (kind, field) in FIELDS {
            let paths = filled(&Stripes, &part, field, 1.0);
            let strips = covered(&paths, HEIGHT);
            let area = part.area_mm2();
            let gap = part.difference(&strips).area_mm2() / area;
            let spill = strips.difference(&part.offset(0.1, Join::Round)).area_mm2() / area;
            let laid: f64 = paths.iter().map(|p| p.volume_mm3(HEIGHT)).sum::<f64>() / (HEIGHT * area);
            let (mean, p95) = alignment(&paths, field);
            println!(
                "{name}, {kind}: gap {gap:.4} laid {laid:.4} mean {mean:.2} p95 {p95:.1} spill {spill:.4}"
            );
            // Across the bar no line is longer than a few beads: there joints are a good part of all.
            let narrow = name == "bar" && kind != "straight" && kind != "rings";
            assert!(gap < if narrow { 0.035 } else { 0.02 }, "{name}, {kind}: gap {gap}");
            assert!(
                (laid - 1.0).abs() < if name == "bar" { 0.06 } else { 0.03 },
                "{name}, {kind}: laid {laid}"
            );
            assert!(spill < 0.005, "{name}, {kind}: spill {spill}");
            assert!(narrow || (mean < 6.0 && p95 < 25.0), "{name}, {kind}: {mean} {p95} degrees");
            assert_eq!(crossing(&paths), None, "{name}, {kind}");
            for path in &paths {
                for i in 0..path.points.len() {
                    let share = path.width_at(i) / WIDTH;
                    assert!((0.599..1.601).contains(&share), "{name}, {kind}: width {share}");
                }
            }
        }
    }
}

/// Shares of a part's area that paths leave open, lay twice and lay outside.
fn missed(part: &Region, paths: &[Toolpath]) -> [f64; 3] {
    let (strips, area) = (covered(paths, HEIGHT), part.area_mm2());
    let laid: f64 = paths.iter().map(|p| p.volume_mm3(HEIGHT)).sum::<f64>() / HEIGHT;
    let gap = part.difference(&strips).area_mm2();
    // `covered` draws strips a quarter of their width beyond both ends, and none beyond the bends of a taper.
    let spill = strips.difference(&part.offset(0.1, Join::Round)).area_mm2();
    [gap, (laid - strips.area_mm2()).max(0.0), spill].map(|mm2| mm2 / area)
}

/// Waves 0.4 mm apart, of which some end or begin inside, a ring, parabolas that turn back around one focus, and straight lines with
/// an end and a turn between them, in a rectangle.
fn waves_ring_and_hairpins() -> (Vec<Line>, Region) {
    let wave = |k: usize, y: f64| DVec2::new(0.22 * k as f64, y + 0.1 * sin_cos(0.15 * k as f64 + y).0);
    let mut lines: Vec<Line> = (1..16)
        .map(|row| {
            let points = (1..90).map(|k| wave(k, 0.4 * row as f64)).collect::<Vec<DVec2>>();
            let ended = match row % 5 {
                3 => points[45..].to_vec(),
                4 => points[..80].to_vec(),
                _ => points,
            };
            Line { points: ended, closed: false }
        })
        .collect();
    let round = |k: usize| DVec2::new(16.0, 8.0) + 0.9 * direction(k as f64 / 40.0 * TAU);
    lines.push(Line { points: (0..40).map(round).collect(), closed: true });
    for k in 1..6 {
        let focal_mm = 0.2 * f64::from(k);
        let at = |v: i32| {
            let y = 0.16 * f64::from(v);
            DVec2::new(4.0 + y * y / (4.0 * focal_mm) - focal_mm, 8.0 + y)
        };
        let points = (-10..=10).map(at).filter(|p| p.x < 12.0).collect();
        lines.push(Line { points, closed: false });
    }
    // Three straight lines so close together that a line which turns back between two of them, and one which begins between the
    // other two, are met in place of a line within two cells.
    let straight = |y: f64, from: i32, to: i32| (from..to).map(move |k| DVec2::new(0.2 * f64::from(k), y));
    for points in [
        straight(10.5, 5, 90).collect::<Vec<DVec2>>(),
        straight(11.0, 5, 90).collect(),
        straight(11.5, 5, 90).collect(),
        straight(10.67, 40, 70).rev().chain(straight(10.83, 40, 70)).collect(),
        straight(11.25, 50, 90).collect(),
    ] {
        lines.push(Line { points, closed: false });
    }
    (lines, Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 12.0)))
}

#[test]
fn a_bead_narrows_to_its_joint_over_no_piece_that_g_code_rounds_away() {
    // With the last loss the bead narrows from 0.001 mm beyond its middle vertex.
    let to_the_middle = (1.0 - 1e-3) / 0.15;
    for (loses_mm, n_points) in [(0.0, 3), (1e-6, 3), (0.004, 3), (0.02, 4), (0.2, 4), (to_the_middle, 3)] {
        let width_mm = 0.3 + loses_mm;
        let points = vec![DVec2::ZERO, DVec2::X, 2.0 * DVec2::X];
        let mut bead = WideBead { points, widths: vec![width_mm; 3], closed: false };
        bead.narrow_end(0.3);
        assert_eq!((bead.points.len(), bead.widths.len()), (n_points, n_points), "{loses_mm}");
        assert_eq!((bead.points[n_points - 1], bead.widths[n_points - 1]), (2.0 * DVec2::X, 0.3));
        assert!(bead.points.windows(2).all(|p| p[0].distance(p[1]) > 1.5e-3), "{loses_mm}");
    }
}

#[test]
fn sides_are_what_rays_through_all_cells_meet() {
    let (lines, border) = waves_ring_and_hairpins();
    let neighbours = Neighbours::new(&lines, &border, 0.28);
    let sides = neighbours.sides(&lines, 0.72);
    let distance_mm = |side: &Side| match *side {
        Side::Line { distance_mm: mm, .. } | Side::Border(mm) | Side::Ahead(mm) => Some(mm),
        Side::Open => None,
    };
    let mut met_lines = 0;
    for (l, (line, sides)) in lines.iter().zip(&sides).enumerate() {
        assert_eq!(line.points.len(), sides.len());
        for (v, sides) in sides.iter().enumerate() {
            let along = line.tangent(v);
            for (side, way) in sides.iter().zip([along.perp(), -along.perp()]) {
                let skips = |other: usize, segment: usize| other == l && is_own(line, v, segment);
                // A search through the cells along the ray knows nothing of the vertex before.
                let expect = neighbours.hit(line.points[v], way, 0.72, skips);
                assert_eq!(distance_mm(side), expect.map(|hit| hit.distance_mm), "line {l}, vertex {v}");
                assert_eq!(matches!(side, Side::Line { .. }), expect.is_some_and(|hit| hit.line.is_some()));
                met_lines += usize::from(matches!(side, Side::Line { .. }));
            }
        }
    }
    assert!(met_lines > 2500, "{met_lines}");
}

#[test]
fn a_line_keeps_the_reach_of_the_nearest_vertex_where_a_border_lies_ahead() {
    let line = |distance_mm: f64| Side::Line { distance_mm, piece: 0 };
    let left = |sides: &[Side], closed: bool| -> Vec<f64> {
        let sides: Vec<[Side; 2]> = sides.iter().map(|&side| [side, Side::Open]).collect();
        settled(&sides, closed, 1.0).iter().map(|reach| reach.left_mm).collect()
    };
    let sides = [line(0.8), Side::Ahead(0.9), Side::Ahead(0.3), Side::Open, Side::Border(0.6)];
    assert_eq!(left(&sides, false), [0.4, 0.4, 0.3, 1.0, 0.6]);
    // The nearest may lie across the seam of a closed line; of two as near the one before counts.
    let sides = [Side::Ahead(2.0), Side::Open, line(0.8), Side::Border(0.5), Side::Ahead(2.0)];
    assert_eq!(left(&sides, true), [0.5, 1.0, 0.4, 0.5, 0.5]);
    assert_eq!(left(&sides, false), [0.4, 1.0, 0.4, 0.5, 0.5]);
    assert_eq!(left(&[Side::Ahead(2.0), Side::Ahead(0.2)], true), [1.0, 0.2]);
}

#[test]
fn rays_meet_what_is_kept_of_lines() {
    let (lines, border) = waves_ring_and_hairpins();
    let mut neighbours = Neighbours::new(&lines, &border, 0.28);
    // Line 3 loses its middle, line 5 goes as a whole, the ring is opened.
    let mut stretches: Vec<(usize, usize, usize)> = Vec::new();
    for (l, line) in lines.iter().enumerate() {
        match l {
            3 => stretches.extend([(3, 0, 20), (3, 40, line.points.len())]),
            5 => {}
            15 => stretches.push((15, 5, 30)),
            _ => stretches.push((l, 0, line.points.len())),
        }
    }
    let segments = stretches.iter().map(|&(l, from, to)| (l, from..to - 1)).collect::<Vec<_>>();
    neighbours.keep(lines.len(), &segments);
    let kept = |&(l, from, to): &(usize, usize, usize)| Line {
        points: lines[l].points[from..to].to_vec(),
        closed: false,
    };
    let kept: Vec<Line> = stretches.iter().map(kept).collect();
    // An index of the lines that remain gives the numbers and the distances.
    let anew = Neighbours::new(&kept, &border, 0.28);
    for p in (0..2000).map(|k| DVec2::new(0.01 * f64::from(k), 0.005 * f64::from(k))) {
        for way in [DVec2::X, DVec2::Y, direction(2.5)] {
            assert_eq!(neighbours.hit(p, way, 1.5, |_, _| false), anew.hit(p, way, 1.5, |_, _| false), "{p}");
        }
    }
}

#[test]
fn lines_far_from_a_place_that_lines_lost_stay_as_they_are() {
    let spacing = 0.4;
    for turned_rad in [0.0, 0.7] {
        let along = direction(turned_rad);
        let line = |k: i32, to: f64| {
            let (y, n) = (spacing * (f64::from(k) + 0.5), (to / 0.22).round());
            let at = |v: i32| along.rotate(DVec2::new(0.1 + (to - 0.1) * f64::from(v) / n, y));
            Line { points: (0..=n as i32).map(at).collect(), closed: false }
        };
        // The line in the middle has lost its second half.
        let lines: Vec<Line> = (0..21).map(|k| line(k, if k == 10 { 30.0 } else { 59.9 })).collect();
        let widths: Vec<Vec<f64>> = lines.iter().map(|l| vec![spacing; l.points.len()]).collect();
        let corners = [(0.0, 0.0), (60.0, 0.0), (60.0, 8.4), (0.0, 8.4)];
        let outer = corners.map(|(x, y)| along.rotate(DVec2::new(x, y))).to_vec();
        let border = Region::from(Polygon { outer, holes: Vec::new() });
        let (area, beside) = (LineClipper::new(&border), Beside::default());
        let place = Place {
            border: &border,
            beside: &beside,
            edge: &Neighbours::new(&[], &border, 0.28),
            border_mm: 0.1,
            area: &area,
            axis: &|_| along,
            cosine: &|_, way| along.dot(way).abs(),
            spacing_mm: spacing,
            shortest_mm: 2.0 * spacing,
            longest_joint_mm: 2.0 * spacing,
        };
        let room = Room { least: 0.55, tip: 0.4, begins: 0.8, middle: true, rests: 0.0 };
        let lost = [along.rotate(DVec2::new(30.2, spacing * 10.5))];
        let again = |moving: Vec<Line>, beside: &Beside| {
            let place = place.beside(beside);
            let moving = trimmed(fitted(moving, &place, room), &place);
            let apart = filling_their_space(moving, beside, &border, spacing);
            (apart.lines, apart.widths)
        };
        let (all, widths) = fitted_around(&lost, (lines.clone(), widths), spacing, place.shortest_mm, again);
        assert_eq!(all.len(), 21);
        for line in &lines {
            let y = along.perp().dot(line.points[0]);
            let by_y = |l: &&Line| (along.perp().dot(l.points[0]) - y).abs() < 0.1 * spacing;
            let now = all.iter().find(by_y).expect("a line in the place of each");
            // Lines lie whole, and what lies farther than twice the reach from the place has not moved.
            assert!((polyline::length_mm(&now.points, false) - 59.8).abs() < 0.01);
            let far = |p: &&DVec2| (along.dot(**p) - 30.2).abs() > 20.0 * spacing;
            assert!(line.points.iter().filter(far).all(|p| now.points.contains(p)));
            let steps = now.points.windows(2).map(|p| along.dot(p[1] - p[0]));
            assert!(steps.map(f64::abs).all(|mm| mm > 0.01 && mm < 0.35));
        }
        for (line, widths) in all.iter().zip(&widths) {
            assert_eq!(line.points.len(), widths.len());
            assert!(widths.iter().all(|w| (w - spacing).abs() < 0.02 * spacing));
        }
    }
}

#[test]
fn beads_keep_their_width_up_to_the_end_of_another() {
    // Two lines 0.7 mm apart, and one between them from x = 10 on.
    let line = |y: f64, from: f64| Line {
        points: (0..=60).map(|k| DVec2::new(from + (20.0 - from) * f64::from(k) / 60.0, y)).collect(),
        closed: false,
    };
    for turned_rad in [0.0, 0.7] {
        let turn = direction(turned_rad);
        let mut lines = vec![line(0.0, 0.0), line(0.35, 10.0), line(0.7, 0.0)];
        lines.iter_mut().flat_map(|l| &mut l.points).for_each(|p| *p = turn.rotate(*p));
        let corners = [(0.0, -0.2), (20.0, -0.2), (20.0, 0.9), (0.0, 0.9)];
        let outer = corners.map(|(x, y)| turn.rotate(DVec2::new(x, y))).to_vec();
        let border = Region::from(Polygon { outer, holes: Vec::new() });
        let Apart { lines, widths, freed, .. } = filling_their_space(lines, &Beside::default(), &border, 0.4);
        assert!(freed.is_empty() && lines.len() == 3);
        for (line, widths) in lines.iter().zip(&widths).step_by(2) {
            for (p, width) in line.points.iter().zip(widths) {
                let x = turn.dot(*p);
                let expect = if x < 10.0 { 0.55 } else { 0.375 };
                assert!((width - expect).abs() < 0.01, "{width} mm at {x}");
            }
        }
    }
}

#[test]
fn a_straight_field_gives_what_straight_lines_give_at_any_angle() {
    let part = Region::rectangle(DVec2::new(-11.0, -5.5), DVec2::new(11.0, 5.5));
    let border_mm = 0.5 * WIDTH;
    for degrees in [0.0_f64, 15.0, 22.0, 26.0, 28.0, 29.0, 37.0, 45.0, 90.0] {
        let field = grainpath_core::UniformField { axis_rad: degrees.to_radians() };
        let context =
            FillContext { angle_rad: field.axis_rad, border_mm, ..context_along(&part, &field, 1.0) };
        let measured = |infill: &dyn Infill, widths: BeadWidths| {
            let paths = filled_in(&FillContext { widths, ..context }, infill, &part);
            let [gap, overlap, spill] = missed(&part, &paths);
            let widest = paths.iter().flat_map(|p| (0..p.points.len()).map(|i| p.width_at(i)));
            println!("{degrees}: gap {gap:.4} overlap {overlap:.4} spill {spill:.4}, {} paths", paths.len());
            ([gap, overlap, spill], widest.fold(0.0, f64::max), alignments(&paths, &|_| field.axis_rad).0)
        };
        let straight = measured(&Solid, BeadWidths::Variable);
        for widths in [BeadWidths::Variable, BeadWidths::Constant] {
            let along = measured(&Stripes, widths);
            for k in 0..3 {
                let (ours, theirs) = (along.0, straight.0);
                assert!(ours[k] < theirs[k] + 0.003, "{degrees}, {widths:?}: {ours:?} {theirs:?}");
            }
            assert!(along.1 < 1.601 * WIDTH, "{degrees}, {widths:?}: a bead of {} mm", along.1);
            let (ours, theirs) = (along.2, straight.2);
            assert!(ours < theirs + 0.5, "{degrees}, {widths:?}: {ours} and {theirs} degrees");
        }
    }
}

/// A round plate under a field of rays: every bead meets its border at a right angle.
#[test]
fn open_ends_reach_the_border_and_stay_on_the_field() {
    let rim = |k: usize| direction(k as f64 / 144.0 * TAU) * 11.25;
    let disk = Region::from(Polygon { outer: (0..144).map(rim).collect(), holes: Vec::new() });
    let star = |p: DVec2| atan2(p.y, p.x);
    let measured = [BeadEnds::Joined, BeadEnds::Open].map(|ends| {
        let paths = filled_with(&Stripes, &disk, star, 1.0, ends);
        let strips = covered(&paths, HEIGHT);
        let gap = disk.difference(&strips).area_mm2() / disk.area_mm2();
        // `covered` draws strips a quarter of their width beyond both ends.
        let spill = strips.difference(&disk.offset(0.12, Join::Round)).area_mm2() / disk.area_mm2();
        assert_eq!(crossing(&paths), None, "{ends:?}");
        println!("{ends:?}: gap {gap:.4} spill {spill:.4} angle {:.2}", alignment(&paths, star).0);
        // The last 0.2 mm below the border are covered as far as the beads are.
        let rim_mm2 = disk.difference(&disk.offset(-0.2, Join::Round)).area_mm2();
        let open_rim = disk.difference(&disk.offset(-0.2, Join::Round)).difference(&strips).area_mm2();
        (gap, spill, alignment(&paths, star).0, open_rim / rim_mm2, missed(&disk, &paths)[1])
    });
    let [joined, open] = measured;
    assert!(open.0 < 0.03 && open.1 < 0.002, "gap {} spill {}", open.0, open.1);
    // Measured: vector_slicer lies 3.8 degrees off on this disk. With joints as wide as the beads ours lie 6.7 degrees off by
    // length, and 2 % are laid twice.
    assert!(open.2 < 3.8 && joined.2 < 5.0, "{} and {} degrees", open.2, joined.2);
    assert!(joined.0 < 0.01 && joined.4 < 0.0125, "gap {}, twice {}", joined.0, joined.4);
    assert!(open.3 < 0.1, "{} of the rim is open", open.3);
}

/// A smooth field with point defects, drawn by a number, and turned with its part.
struct Drawn {
    by_rad: f64,
    base_rad: f64,
    per_mm: DVec2,
    wave: (f64, DVec2),
    defects: Vec<(DVec2, f64)>,
}

impl Drawn {
    fn new(seed: u64, by_deg: f64) -> Self {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        // A number from -1 to 1.
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        (0..9).for_each(|_| _ = next());
        Self {
            by_rad: by_deg.to_radians(),
            base_rad: PI * next(),
            per_mm: 0.04 * DVec2::new(next(), next()),
            wave: (0.3 + 0.2 * next(), 0.25 * DVec2::new(next(), next())),
            defects: (0..seed % 7)
                .map(|_| {
                    let at = DVec2::new(3.0, -2.0) + 10.0 * DVec2::new(next(), next());
                    (at, [-0.5, 0.5, 0.5, 1.0][((next() + 1.0) * 2.0) as usize % 4])
                })
                .collect(),
        }
    }
}

impl DirectionField for Drawn {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let p = direction(-self.by_rad).rotate(p.truncate());
        let around = |(at, turns): &(DVec2, f64)| turns * atan2(p.y - at.y, p.x - at.x);
        let wave_rad = self.wave.0 * sin_cos(self.wave.1.dot(p)).0;
        let defects_rad: f64 = self.defects.iter().map(around).sum();
        let own_rad = self.base_rad + self.per_mm.dot(p) + wave_rad + defects_rad;
        let axis_rad = (own_rad + self.by_rad).rem_euclid(PI);
        DirectionSample { axis_rad, strength: 1.0, principal_mpa: None }
    }
}

#[test]
fn beads_along_drawn_fields_with_defects_do_not_cross() {
    let mut wrong = Vec::new();
    // Drawn from 400. The first seven had crossings at ends, beside defects or in joints, and the eighth in a joint while
    // another shape of joints was tried. In the last two seed lines curled. From 48 on the part is turned with its field.
    for seed in [11, 13, 20, 26, 31, 33, 37, 76, 181, 291] {
        let by_deg = if seed < 48 { 0.0 } else { 37.0 * seed as f64 };
        let (part, field) = (turned(&lopsided(), |_| 0.0, by_deg).0, Drawn::new(seed, by_deg));
        for (ends, widths, density) in [
            (BeadEnds::Joined, BeadWidths::Variable, 1.0),
            (BeadEnds::Open, BeadWidths::Variable, 1.0),
            (BeadEnds::Joined, BeadWidths::Constant, 1.0),
            (BeadEnds::Open, BeadWidths::Constant, 1.0),
            (BeadEnds::Joined, BeadWidths::Constant, 0.9),
        ] {
            let paths = filled_along(&Stripes, &part, &field, density, ends, widths);
            let [gap, overlap, _] = missed(&part, &paths);
            println!("{seed} {ends:?} {widths:?} {density}: gap {gap:.3} overlap {overlap:.3}");
            if let Some(at) = crossing(&paths) {
                wrong.push(format!("{seed}, {ends:?}, {widths:?}, {density}: {at:?}"));
            }
        }
        let seeds = filled_along(&SeedLines, &part, &field, 1.0, BeadEnds::Open, BeadWidths::Constant);
        if let Some(at) = crossing(&seeds) {
            wrong.push(format!("{seed}, seed lines: {at:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn streamlines_have_the_density_asked_for() {
    let (_, part) = &parts()[0];
    for (kind, field) in FIELDS {
        for density in [0.15, 0.4] {
            let paths = filled(&Streamlines, part, field, density);
            let volume: f64 = paths.iter().map(|p| p.volume_mm3(HEIGHT)).sum();
            let share = volume / (part.area_mm2() * HEIGHT);
            println!("{kind} at {density}: {share:.3} {:.2}", alignment(&paths, field).0);
            assert!((share - density).abs() < 0.03 * density, "{kind} at {density}: {share}");
            assert_eq!(crossing(&paths), None, "{kind} at {density}");
            assert!(alignment(&paths, field).0 < 1.5, "{kind} at {density}");
        }
    }
}

#[test]
fn streamlines_become_stripes_without_a_jump() {
    let (_, part) = &parts()[0];
    let area = part.area_mm2();
    for (kind, field) in FIELDS {
        let mut before: Option<[f64; 2]> = None;
        for twentieths in 6..=20 {
            let density = f64::from(twentieths) / 20.0;
            let paths = filled(&Streamlines, part, field, density);
            let laid: f64 = paths.iter().map(|p| p.volume_mm3(HEIGHT)).sum::<f64>() / (HEIGHT * area);
            let [gap, overlap, _] = missed(part, &paths);
            // Free space between the lines is no gap.
            let found = [gap - (1.0 - density), overlap];
            println!(
                "{kind} at {density}: laid {laid:.3} gap {:.4} overlap {overlap:.4}, {:.2} degrees, {} paths",
                found[0],
                alignment(&paths, field).0,
                paths.len()
            );
            assert!((laid / density - 1.0).abs() < 0.03, "{kind} at {density}: {laid} of the volume");
            let last = before.replace(found).unwrap_or(found);
            for k in 0..2 {
                assert!((found[k] - last[k]).abs() < 0.015, "{kind} at {density}: {last:?} {found:?}");
            }
        }
    }
}

#[test]
fn seed_lines_and_their_offsets_do_not_cross_and_fill_most() {
    let (_, part) = &parts()[0];
    let inside = LineClipper::new(&part.offset(0.01, Join::Round));
    for (kind, field) in FIELDS {
        let paths = filled(&SeedLines, part, field, 1.0);
        let share = covered(&paths, HEIGHT).intersection(part).area_mm2() / part.area_mm2();
        assert!(share > 0.94, "{kind}: {share}");
        assert_eq!(crossing(&paths), None, "{kind}");
        assert!(paths.iter().flat_map(|p| &p.points).all(|p| inside.contains(*p)), "{kind}");
    }
}

/// A field that has been turned on the plate with its part.
struct Turned {
    field: fn(DVec2) -> f64,
    by_rad: f64,
}

impl DirectionField for Turned {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let back = direction(-self.by_rad).rotate(p.truncate());
        let axis_rad = ((self.field)(back) + self.by_rad).rem_euclid(PI);
        DirectionSample { axis_rad, strength: 1.0, principal_mpa: None }
    }
}

/// A part turned on the plate, with its field.
fn turned(part: &Region, field: fn(DVec2) -> f64, by_deg: f64) -> (Region, Turned) {
    let turn = direction(by_deg.to_radians());
    let turned = |c: &Vec<DVec2>| c.iter().map(|p| turn.rotate(*p)).collect::<Vec<_>>();
    let polygons = part
        .polygons
        .iter()
        .map(|p| Polygon { outer: turned(&p.outer), holes: p.holes.iter().map(turned).collect() });
    (Region { polygons: polygons.collect() }, Turned { field, by_rad: by_deg.to_radians() })
}

/// Gap, mean angle in degrees, and paths of seed lines in a part that is turned with its field.
fn turned_seed_lines(part: &Region, field: fn(DVec2) -> f64, by_deg: f64) -> (f64, f64, usize) {
    let (part, field) = turned(part, field, by_deg);
    let paths = filled_along(&SeedLines, &part, &field, 1.0, BeadEnds::Open, BeadWidths::Variable);
    let gap = 1.0 - covered(&paths, HEIGHT).intersection(&part).area_mm2() / part.area_mm2();
    let (mean_deg, _) = alignments(&paths, &|p| field.sample(p.extend(0.1)).axis_rad);
    assert_eq!(crossing(&paths), None, "turned by {by_deg}");
    (gap, mean_deg, paths.len())
}

/// A part without any symmetry: its outline has waves of several lengths, and the hole lies off its middle.
fn lopsided() -> Region {
    let at = |k: usize| {
        let a = k as f64 / 96.0 * TAU;
        let r =
            10.0 + 1.8 * sin_cos(2.0 * a + 0.3).0 + 1.1 * sin_cos(3.0 * a).0 + 0.6 * sin_cos(5.0 * a + 1.0).0;
        DVec2::new(3.0, -2.0) + direction(a) * r
    };
    let hole = |k: usize| DVec2::new(4.5, -1.0) + direction(k as f64 / 48.0 * TAU) * 2.5;
    let outline = Region::from(Polygon { outer: (0..96).map(at).collect(), holes: Vec::new() });
    outline.difference(&Region::from(Polygon { outer: (0..48).map(hole).collect(), holes: Vec::new() }))
}

#[test]
fn seed_lines_are_the_same_in_a_turned_part() {
    let [(_, plate), _] = parts();
    for (name, part) in [("plate", plate), ("lopsided", lopsided())] {
        for (kind, field) in FIELDS {
            let found = [0.0, 15.0, 37.0, 45.0, 90.0].map(|deg| turned_seed_lines(&part, field, deg));
            println!("{name}, {kind}: {found:.4?}");
            for (gap, mean_deg, n) in found {
                assert!((gap - found[0].0).abs() < 0.003, "{name}, {kind}: {found:?}");
                assert!((mean_deg - found[0].1).abs() < 0.5, "{name}, {kind}: {found:?}");
                let few = n.abs_diff(found[0].2) <= 2 + found[0].2 / 10;
                assert!(mean_deg < 6.0 && few, "{name}, {kind}: {found:?}");
            }
        }
    }
}

fn is_of_width(path: &Toolpath) -> bool {
    (0..path.points.len()).all(|i| (path.width_at(i) - WIDTH).abs() < 1e-12)
}

type Strip = (&'static str, Region, fn(DVec2) -> f64);

/// A strip and a ring of this width, mm, each under a field that meets its borders across, aslant or not at all.
fn strips(mm: f64) -> [Strip; 5] {
    let bar = Region::rectangle(DVec2::new(-10.0, -0.5 * mm), DVec2::new(10.0, 0.5 * mm));
    let disk = |r: f64| {
        let rim = |k: usize| direction(k as f64 / 144.0 * TAU) * r;
        Region::from(Polygon { outer: (0..144).map(rim).collect(), holes: Vec::new() })
    };
    let ring = disk(5.0 + 0.5 * mm).difference(&disk(5.0 - 0.5 * mm));
    [
        ("across", bar.clone(), |_| FRAC_PI_2),
        ("aslant", bar.clone(), |_| 0.8),
        ("along", bar, |_| 0.0),
        ("ring", ring.clone(), |_| 0.6),
        ("ring of rays", ring, |p| atan2(p.y, p.x)),
    ]
}

#[test]
fn strips_narrower_than_their_lines_are_filled() {
    let mut wrong = Vec::new();
    for mm in [0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2] {
        for (name, part, field) in strips(mm) {
            for by_deg in [0.0, 37.0] {
                let (part, field) = turned(&part, field, by_deg);
                for widths in [BeadWidths::Constant, BeadWidths::Variable] {
                    let context = FillContext { widths, ..context_along(&part, &field, 1.0) };
                    let paths = filled_in(&context, &Stripes, &part);
                    let [gap, overlap, spill] = missed(&part, &paths);
                    let found = format!(
                        "{mm} {name} {by_deg} {widths:?}: gap {gap:.3} overlap {overlap:.3} spill {spill:.3}"
                    );
                    println!("{found}");
                    // Short lines aslant of a strip lie on their joints, and the single bead in a strip of two beads and
                    // a half is not wide enough.
                    let (most_gap, most_overlap) = match widths {
                        BeadWidths::Constant => (0.12, 0.03),
                        BeadWidths::Variable => (0.17, 0.12),
                    };
                    if gap > most_gap || overlap > most_overlap || spill > 0.01 {
                        wrong.push(found);
                    }
                    assert_eq!(crossing(&paths), None, "{mm} {name} {by_deg} {widths:?}");
                }
                // Where no bead may be narrower than another, as of fibre, all have one width.
                let only = FillContext {
                    widths: BeadWidths::Constant,
                    min_bead_width_mm: WIDTH,
                    ..context_along(&part, &field, 1.0)
                };
                assert!(filled_in(&only, &Stripes, &part).iter().all(is_of_width), "{mm} {name} {by_deg}");
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Gap, overlap and mean angle in degrees of beads of one width in a part that is turned with its field.
fn of_one_width(part: &Region, field: fn(DVec2) -> f64, by_deg: f64, ends: BeadEnds) -> [f64; 3] {
    let (part, field) = turned(part, field, by_deg);
    let paths = filled_along(&Stripes, &part, &field, 1.0, ends, BeadWidths::Constant);
    // Only single beads in gaps differ.
    let differ = paths.iter().filter(|p| !is_of_width(p)).map(Toolpath::length_mm).sum::<f64>();
    let all = paths.iter().map(Toolpath::length_mm).sum::<f64>();
    assert!(differ < 0.08 * all, "turned by {by_deg}: {differ} of {all} mm");
    assert_eq!(crossing(&paths), None, "turned by {by_deg}");
    let inside = LineClipper::new(&part.offset(0.01, Join::Round));
    assert!(paths.iter().flat_map(|p| &p.points).all(|p| inside.contains(*p)), "turned by {by_deg}");
    let [gap, overlap, _] = missed(&part, &paths);
    [gap, overlap, alignments(&paths, &|p| field.sample(p.extend(0.1)).axis_rad).0]
}

#[test]
fn beads_of_one_width_are_packed_along_any_field_turned_any_way() {
    for (name, part) in parts() {
        for (kind, field) in FIELDS {
            for ends in [BeadEnds::Joined, BeadEnds::Open] {
                let found = [0.0, 15.0, 37.0, 90.0].map(|deg| of_one_width(&part, field, deg, ends));
                println!("{name}, {kind}, {ends:?}: {found:.3?}");
                for [gap, overlap, mean_deg] in found {
                    // Six beads and a third lie across the bar, so a third of a bead is open at least.
                    let (most_gap, most_overlap) = if name == "bar" { (0.1, 0.04) } else { (0.035, 0.025) };
                    assert!(gap < most_gap && overlap < most_overlap, "{name}, {kind}, {ends:?}: {found:?}");
                    let off = (gap - found[0][0]).abs().max((overlap - found[0][1]).abs());
                    assert!(name == "bar" || off < 0.01, "{name}, {kind}, {ends:?}: {found:?}");
                    assert!(ends == BeadEnds::Joined || mean_deg < 5.0, "{name}, {kind}: {found:?}");
                }
            }
        }
    }
}

/// vector_slicer, which lays one width too, leaves 5.1 % of this disk open, lays 8.6 % twice and lies
/// 3.8 degrees off.
#[test]
fn beads_of_one_width_pack_a_disk_of_rays() {
    let rim = |k: usize| direction(k as f64 / 144.0 * TAU) * 11.25;
    let disk = Region::from(Polygon { outer: (0..144).map(rim).collect(), holes: Vec::new() });
    let star = |p: DVec2| atan2(p.y, p.x);
    let [gap, overlap, mean_deg] = of_one_width(&disk, star, 0.0, BeadEnds::Auto);
    println!("gap {gap:.4} overlap {overlap:.4} angle {mean_deg:.2}");
    assert!(gap < 0.051 && overlap < 0.086 && mean_deg < 3.8, "{gap} {overlap} {mean_deg}");
}

/// Beads that may be narrowed, and fibre, whose ends are cuts, are joined where the job does not say.
#[test]
fn ends_are_joined_where_that_costs_little_or_a_cut() {
    let [(_, plate), _] = parts();
    let context = context_along(&plate, &Angle(past_a_hole), 1.0);
    let n = |ends: BeadEnds, widths: BeadWidths, min_bead_width_mm: f64| {
        let context = FillContext { ends, widths, min_bead_width_mm, ..context };
        filled_in(&context, &Stripes, &plate).len()
    };
    for (widths, least_mm, like) in [
        (BeadWidths::Variable, 0.2, BeadEnds::Joined),
        (BeadWidths::Constant, WIDTH, BeadEnds::Joined),
        (BeadWidths::Constant, 0.2, BeadEnds::Open),
    ] {
        let auto = n(BeadEnds::Auto, widths, least_mm);
        let [joined, open] = [BeadEnds::Joined, BeadEnds::Open].map(|ends| n(ends, widths, least_mm));
        assert!(joined < open, "{widths:?}, {least_mm}: {joined} and {open} paths");
        assert_eq!(auto, if like == BeadEnds::Open { open } else { joined }, "{widths:?}, {least_mm}");
    }
}

/// Where the flow parts before a hole, three beads leave a corner open.
#[test]
fn a_void_between_three_beads_gets_a_bead() {
    let [(_, plate), _] = parts();
    let spacing = bead_spacing_mm(WIDTH, HEIGHT);
    for by_deg in [0.0, 15.0, 37.0, 45.0, 80.0] {
        let (part, field) = turned(&plate, past_a_hole, by_deg);
        let paths = filled_along(&Stripes, &part, &field, 1.0, BeadEnds::Open, BeadWidths::Variable);
        let voids = part.difference(&covered(&paths, HEIGHT)).polygons;
        let largest = voids.iter().map(Polygon::area_mm2).fold(0.0, f64::max) / (spacing * spacing);
        println!("turned by {by_deg}: {largest:.2} squares of a bead");
        // Measured: 0.25 to 0.74. With strips that reach beyond every bend, 1.3 and 1.6 stayed open at two of these turns.
        assert!(largest < 0.8, "turned by {by_deg}: {largest} squares of a bead are open");
    }
}

/// Slanting ends at a border, corners, and lines that part leave triangles, which a bead along the medial axis does not fill.
#[test]
fn triangles_beside_ends_of_lines_get_a_bead() {
    let [(_, plate), _] = parts();
    let spacing = bead_spacing_mm(WIDTH, HEIGHT);
    let mut worst = 0.0_f64;
    for (name, field) in FIELDS {
        for (by_deg, ends) in
            [0.0, 37.0].into_iter().flat_map(|d| [(d, BeadEnds::Joined), (d, BeadEnds::Open)])
        {
            let (part, field) = turned(&plate, field, by_deg);
            let paths = filled_along(&Stripes, &part, &field, 1.0, ends, BeadWidths::Variable);
            // Beads have flat ends here.
            let strips = paths.iter().flat_map(|p| strips_of(p, HEIGHT, 0.0)).map(|s| s.to_vec());
            let open = part.difference(&Region::from_contours(&Vec::from_iter(strips), FillRule::NonZero));
            let largest =
                open.polygons.iter().map(Polygon::area_mm2).fold(0.0, f64::max) / (spacing * spacing);
            println!("{name} turned by {by_deg}, {ends:?}: {largest:.2} squares of a bead");
            worst = worst.max(largest);
            let narrowest = paths.iter().flat_map(|p| (0..=p.n_segments()).map(|v| p.width_at(v)));
            assert!(narrowest.fold(WIDTH, f64::min) >= 0.599 * WIDTH, "{name} turned by {by_deg}, {ends:?}");
            assert!(crossing(&paths).is_none(), "{name} turned by {by_deg}, {ends:?}: beads cross");
        }
    }
    assert!(worst < 0.6, "{worst} squares of a bead are open");
}

#[test]
fn seed_lines_have_a_role_of_their_own_and_come_first() {
    let (_, plate) = &parts()[0];
    let paths = filled(&SeedLines, plate, past_a_hole, 1.0);
    let seeds = paths.iter().filter(|p| p.role == Role::SeedLine).count();
    assert!(seeds > 2 && seeds < paths.len(), "{seeds} of {}", paths.len());
    assert!(paths.iter().all(|p| (p.role == Role::SeedLine) == (p.rank == 0)));
}

#[test]
fn nothing_comes_of_nothing() {
    let sliver = Region::rectangle(DVec2::ZERO, DVec2::new(5.0, 0.01));
    let crumb = Region::rectangle(DVec2::ZERO, DVec2::splat(0.05));
    for part in [sliver, crumb] {
        for infill in [&Stripes as &dyn Infill, &Streamlines, &SeedLines] {
            let context = FillContext {
                z_mid_mm: 0.1,
                height_mm: HEIGHT,
                bead_width_mm: WIDTH,
                min_bead_width_mm: 0.2,
                density: grainpath_core::Density::Dense,
                angle_rad: 0.0,
                part: part.bounds().expect("not empty"),
                role: Role::SolidFill,
                border_mm: 0.1,
                ends: BeadEnds::Open,
                shift: crate::fill::Shift::NONE,
                below: None,
                fills_wedges: true,
                widths: BeadWidths::Variable,
                field: Some(&Angle(rings)),
            };
            infill.fill(&context, &part.polygons[0], &mut Vec::new());
        }
    }
}
