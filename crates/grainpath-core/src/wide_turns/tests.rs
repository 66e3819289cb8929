use proptest::prelude::*;

use super::{Place, joined, uncrossed};
use crate::math::direction;
use crate::poly::{Join, LineClipper};
use crate::segment::{self, Meeting};
use crate::turns::{rounded, sharp_turns};
use crate::{DVec2, Polygon, Region, Role, Toolpath};

fn joined_in(region: &Region, lines: Vec<Vec<DVec2>>, needed_mm: f64) -> Vec<Toolpath> {
    let pieces = lines.into_iter().map(|line| Toolpath::new(line, 1.0, Role::Fibre, false)).collect();
    let clipper = LineClipper::new(region);
    let place =
        Place { region, clipper: &clipper, spacing_mm: 1.0, least_mm: 2.0, onward_mm: 0.0, needed_mm };
    joined(pieces, &place)
}

fn long_mm(paths: &[Toolpath], needed_mm: f64) -> f64 {
    paths.iter().map(Toolpath::length_mm).filter(|&mm| mm >= needed_mm).sum()
}

#[test]
fn a_short_line_goes_on_in_its_neighbour() {
    // Far from the border, so that nothing turns there.
    let region = Region::rectangle(DVec2::new(-20.0, -20.0), DVec2::new(180.0, 20.0));
    let line = |y: f64, x: [f64; 2]| x.map(|x| DVec2::new(x, y)).to_vec();
    for short in [line(1.0, [60.0, 100.0]), line(-1.0, [100.0, 60.0])] {
        let paths = joined_in(&region, vec![line(0.0, [0.0, 160.0]), short], 50.0);
        assert_eq!(paths.len(), 2, "{paths:?}");
        assert!(long_mm(&paths, 50.0) > 195.0, "{paths:?}");
        // The change of lanes is no steeper than 15 degrees, and nothing comes nearer than a spacing.
        let beads = |half_mm: f64| {
            let all = paths.iter().map(|p| Region::around_line(&p.points, false, half_mm));
            let alone: f64 = all.clone().map(|bead| bead.area_mm2()).sum();
            alone - all.fold(Region::default(), |sum, bead| sum.union(&bead)).area_mm2()
        };
        assert!(beads(0.45) < 0.01, "{}", beads(0.45));
        for w in paths.iter().flat_map(|p| p.points.windows(2)) {
            let way = (w[1] - w[0]).normalize();
            assert!(way.x.abs() > 0.965, "{way}");
        }
    }
    // What it leaves would be too short: nothing changes.
    let lines = vec![line(0.0, [0.0, 80.0]), line(1.0, [5.0, 40.0])];
    assert_eq!(long_mm(&joined_in(&region, lines, 50.0), 50.0), 80.0);
}

#[test]
fn a_line_that_gives_too_much_takes_of_the_next() {
    let region = Region::rectangle(DVec2::new(-20.0, -20.0), DVec2::new(180.0, 20.0));
    let line = |y: f64, x: [f64; 2]| x.map(|x| DVec2::new(x, y)).to_vec();
    // The second is too short without what the first takes of it, but not with as much of the third.
    let lines = vec![line(0.0, [0.0, 42.0]), line(1.0, [0.0, 58.0]), line(2.0, [-12.0, 74.0])];
    let paths = joined_in(&region, lines, 50.0);
    assert!(long_mm(&paths, 50.0) > 175.0, "{paths:?}");
    assert!(crossings(&paths.into_iter().map(|p| p.points).collect::<Vec<_>>()).is_empty());
}

#[test]
fn ends_on_a_curve_face_each_other() {
    let arc = |from_rad: f64, to_rad: f64| -> Vec<DVec2> {
        (0..=60).map(|k| 10.0 * direction(from_rad + (to_rad - from_rad) * f64::from(k) / 60.0)).collect()
    };
    let region = Region::rectangle(DVec2::splat(-30.0), DVec2::splat(30.0));
    let paths = joined_in(&region, vec![arc(0.0, 1.5), arc(1.7, 3.1)], 50.0);
    assert_eq!(paths.len(), 1);
    assert!(paths[0].length_mm() > 30.8, "{}", paths[0].length_mm());
}

#[test]
fn short_lines_of_a_strip_become_long_paths() {
    // No line of 20 mm is long enough; in groups of fifteen, each but the innermost returns.
    for n in [15, 18, 24, 40] {
        let region = Region::rectangle(DVec2::ZERO, DVec2::new(20.0, f64::from(n)));
        let grown = region.offset(2e-3, Join::Miter(3.0));
        let lines = (0..n).map(|k| [0.1, 19.9].map(|x| DVec2::new(x, f64::from(k) + 0.5)).to_vec()).collect();
        let paths = joined_in(&grown, lines, 50.0);
        let share = long_mm(&paths, 50.0) / (19.8 * f64::from(n));
        assert!(share > 0.85, "{n}: {share}");
    }
}

#[test]
fn rings_take_the_place_of_short_lines() {
    // A strip between two long lines.
    let region = Region::rectangle(DVec2::ZERO, DVec2::new(80.0, 14.0));
    let strip = |lines: Vec<Vec<DVec2>>| {
        let beside = [0.1, 13.9].map(|y| [0.1, 79.9].map(|x| DVec2::new(x, y)).to_vec());
        joined_in(&region, [beside.to_vec(), lines].concat(), 50.0)
    };
    // Across lines that are two spacings apart, so that they do not turn, rings would lead nowhere.
    let across =
        (0..40).map(|k| [1.1, 12.9].map(|y| DVec2::new(2.0 * f64::from(k) + 1.0, y)).to_vec()).collect();
    assert!(long_mm(&strip(across), 50.0) < 160.0);
    // Lines of 31 mm that cross it at 22 degrees, two spacings apart.
    let slanted = (-6..16).filter_map(|k| {
        let [x0, y0, y1] = [5.34 * f64::from(k), 1.1, 12.9];
        let at = |y: f64| DVec2::new(x0 + 2.475 * (y - y0), y);
        let low = y0.max(y0 + (1.1 - x0) / 2.475);
        let high = y1.min(y0 + (78.9 - x0) / 2.475);
        (high > low + 1.0).then(|| vec![at(low), at(high)])
    });
    let paths = strip(slanted.collect());
    assert!(long_mm(&paths, 50.0) > 160.0 + 600.0, "{}", long_mm(&paths, 50.0));
    let clipper = LineClipper::new(&region.offset(1e-3, Join::Miter(2.0)));
    for path in &paths {
        let points = path.clone().opened().points;
        assert!(points.windows(2).all(|w| clipper.segment_inside(w[0], w[1])));
        // What is rounded afterwards are the ends of the slopes between rings.
        if path.length_mm() >= 50.0 {
            let inside = |a: DVec2, b: DVec2| clipper.segment_inside(a, b);
            let points = rounded(&points, 2.0, 2.0, &inside).0;
            assert!(sharp_turns(&points, false, 2.0).is_empty(), "{points:?}");
        }
    }
    // Where lines lay apart, loops fill the middle of the rings.
    let around = |half_mm: f64| paths.iter().map(move |p| Region::around_line(&p.points, p.closed, half_mm));
    let together =
        |half_mm: f64| around(half_mm).fold(Region::default(), |sum, bead| sum.union(&bead)).area_mm2();
    assert!(together(0.5) > 0.9 * 81.0 * 15.0, "{}", together(0.5) / 81.0 / 15.0);
    let alone: f64 = around(0.4).map(|bead| bead.area_mm2()).sum();
    assert!(alone < 1.01 * together(0.4), "{alone} {}", together(0.4));
    assert!(crossings(&paths.iter().map(|p| p.clone().opened().points).collect::<Vec<_>>()).is_empty());
}

/// Pairs of segments of paths that cross.
fn crossings(paths: &[Vec<DVec2>]) -> Vec<[[DVec2; 2]; 2]> {
    let segments: Vec<[DVec2; 2]> = paths.iter().flat_map(|p| p.windows(2).map(|w| [w[0], w[1]])).collect();
    let pairs = |(k, a): (usize, &[DVec2; 2])| {
        let crossed = segments[k + 1..].iter().filter(|b| segment::meeting(*a, **b) == Meeting::Cross);
        crossed.map(|b| [*a, *b]).collect::<Vec<_>>()
    };
    segments.iter().enumerate().flat_map(pairs).collect()
}

/// Zigzag over a slanted rectangle of 100 mm by `n` lines, cut at its hairpins, joined and rounded.
fn rounded_on_slant(slant: f64, n: i32, [least_mm, onward_mm]: [f64; 2]) -> Vec<Vec<DVec2>> {
    let spacing_mm = 0.557;
    let high = f64::from(n) * spacing_mm;
    let corners = [(0.0, 0.0), (100.0, 0.0), (100.0 + slant * high, high), (slant * high, high)];
    let region = Region::from(Polygon { outer: corners.map(DVec2::from).to_vec(), holes: Vec::new() });
    let clipper = LineClipper::new(&region);
    let place =
        Place { region: &region, clipper: &clipper, spacing_mm, least_mm, onward_mm, needed_mm: 20.0 };
    let line = |k: i32| {
        let y = (f64::from(k) + 0.5) * spacing_mm;
        [0.6, 99.4].map(|x| DVec2::new(x + slant * y, y)).to_vec()
    };
    let pieces = (0..n).map(|k| Toolpath::new(line(k), 0.6, Role::Fibre, false)).collect();
    let inside = |a: DVec2, b: DVec2| clipper.segment_inside(a, b);
    let begun = |mut path: Toolpath| {
        // A ring begins in the middle of a line and not at a corner, which would stay sharp.
        if path.closed {
            path.points.insert(1, 0.5 * (path.points[0] + path.points[1]));
            path.rotate_to(1);
        }
        rounded(&path.opened().points, least_mm, least_mm, &inside).0
    };
    joined(pieces, &place).into_iter().map(begun).collect()
}

#[test]
fn lines_change_lanes_and_not_into_turns_beside_them() {
    // A line ends beside the corner at which its neighbour turns along the border: what follows there is no lane.
    let cases = [(-0.5, 60, [2.0, 0.0]), (0.5, 60, [3.0, 0.0]), (1.0, 45, [3.0, 0.0]), (1.0, 60, [4.5, 0.0])];
    for (slant, n, turns) in cases {
        let crossed = crossings(&rounded_on_slant(slant, n, turns));
        assert!(crossed.is_empty(), "{slant} {n} {turns:?}: {crossed:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Whatever crosses is cut, nothing is added, and paths that cross nothing stay as they are.
    #[test]
    fn paths_end_before_those_that_they_would_cross(
        all in prop::collection::vec(
            (prop::collection::vec((0.0..60.0f64, 0.0..60.0f64), 2..7), any::<bool>()), 1..7)
    ) {
        let path = |(points, closed): (Vec<(f64, f64)>, bool)| {
            let points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
            let closed = closed && points.len() > 2;
            Toolpath::new(points, 1.0, Role::Fibre, closed)
        };
        let paths: Vec<Toolpath> = all.into_iter().map(path).collect();
        let opened = |paths: &[Toolpath]| -> Vec<Vec<DVec2>> {
            paths.iter().map(|p| p.clone().opened().points).collect()
        };
        let before = opened(&paths);
        let cut = uncrossed(paths.clone(), 1.0, 20.0);
        prop_assert!(crossings(&opened(&cut)).is_empty());
        let length_mm = |paths: &[Toolpath]| paths.iter().map(Toolpath::length_mm).sum::<f64>();
        prop_assert!(length_mm(&cut) <= length_mm(&paths) + 1e-6);
        for (k, path) in paths.iter().enumerate() {
            let others = before.iter().enumerate().filter(|(l, _)| *l != k).map(|(_, line)| line.clone());
            let alone = crossings(&before[k..=k]).len();
            let met = crossings(&others.collect::<Vec<_>>()).len() + alone;
            if crossings(&before).len() == met && alone == 0 {
                prop_assert!(cut.contains(path), "{path:?}");
            }
        }
        // Each piece lies on one of the paths.
        for p in cut.iter().flat_map(|piece| &piece.points) {
            let on = before.iter().flat_map(|line| line.windows(2));
            let off_mm2 = on.map(|w| segment::distance_squared_mm2(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
            prop_assert!(off_mm2 < 1e-12, "{p}");
        }
    }
}

#[test]
fn of_two_paths_that_cross_the_one_that_loses_less_is_cut() {
    let line = |points: &[(f64, f64)]| {
        Toolpath::new(points.iter().map(|p| DVec2::from(*p)).collect(), 1.0, Role::Fibre, false)
    };
    let across = line(&[(0.0, 0.0), (100.0, 0.0)]);
    // 40 and 45 mm on either side of the crossing: either part would be too short for fibre, while 70 mm of the other are enough.
    let upright = line(&[(30.0, -40.0), (30.0, 45.0)]);
    let cut = uncrossed(vec![across.clone(), upright.clone()], 1.0, 50.0);
    assert_eq!(cut.len(), 3);
    assert_eq!(cut[2], upright);
    assert!((cut[1].length_mm() - 69.0).abs() < 0.05 && (cut[0].length_mm() - 29.0).abs() < 0.05, "{cut:?}");
    // A ring is opened where that takes less than the end of a line.
    let ring = Toolpath { closed: true, ..line(&[(20.0, -5.0), (80.0, -5.0), (80.0, 40.0), (20.0, 40.0)]) };
    let into = line(&[(70.0, 100.0), (70.0, 20.0)]);
    let cut = uncrossed(vec![ring.clone(), into.clone()], 1.0, 50.0);
    assert_eq!((cut.len(), cut[0].closed), (2, false), "{cut:?}");
    assert_eq!(cut[1], into);
    assert!((cut[0].length_mm() - 208.0).abs() < 0.1, "{}", cut[0].length_mm());
    // Less than a bead of the line lies in the ring. At a slant of 45 degrees more goes than a spacing.
    let touching = line(&[(70.0, 100.0), (70.0, 50.0), (60.2, 39.8)]);
    let cut = uncrossed(vec![ring.clone(), touching.clone()], 1.0, 50.0);
    assert_eq!((cut.len(), &cut[0]), (2, &ring), "{cut:?}");
    let lost_mm = touching.length_mm() - cut[1].length_mm();
    assert!((1.4..2.0).contains(&lost_mm), "{lost_mm}");
    // A path that crosses itself.
    let loops = line(&[(0.0, 0.0), (60.0, 0.0), (60.0, 30.0), (50.0, 30.0), (50.0, -3.0)]);
    let cut = uncrossed(vec![loops], 1.0, 50.0);
    assert_eq!(cut.len(), 2, "{cut:?}");
    assert!((cut[0].length_mm() + cut[1].length_mm() - 131.0).abs() < 0.1, "{cut:?}");
}
