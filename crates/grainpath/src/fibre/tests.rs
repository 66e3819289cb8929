use super::*;
use grainpath_core::Layer;
use grainpath_core::math::direction;
use grainpath_core::segment::{self, Meeting};

fn settings() -> FibreSettings {
    FibreSettings {
        layers: Vec::new(),
        matrix_layers: [0, 0],
        n_layers: 15,
        plate_from_part_mm: DVec2::ZERO,
        every: 1,
        rings: 0,
        boxes: Vec::new(),
        bead_width_mm: 0.6,
        min_radius_mm: 3.0,
        turns: FibreTurns::Round,
        min_length_mm: 20.0,
        start: FibreStart::Straight,
    }
}

fn place(region: &Region, onward_mm: f64) -> FibrePlace<'_> {
    let spacing_mm = bead_spacing_mm(0.6, 0.2);
    FibrePlace { region, spacing_mm, load: &|_| 0.0, onward_mm, keep_closed: false, rings: false }
}

fn anywhere(_: DVec2, _: DVec2) -> bool {
    true
}

fn smallest(points: &[DVec2], closed: bool) -> f64 {
    turns(points, closed).iter().map(|t| t.radius_mm).fold(f64::INFINITY, f64::min)
}

#[test]
fn circles_have_their_radius_and_corners_next_to_none() {
    for n in [40, 90, 700] {
        let circle: Vec<DVec2> =
            (0..n).map(|k| direction(f64::from(k) / f64::from(n) * std::f64::consts::TAU) * 8.0).collect();
        let r = smallest(&circle, true);
        assert!((r / 8.0 - 1.0).abs() < 0.06, "{n}: {r}");
        // As G-code has them.
        let written: Vec<DVec2> = circle.iter().map(|p| (p * 1e3).round() * 1e-3).collect();
        let r = smallest(&written, true);
        assert!((r / 8.0 - 1.0).abs() < 0.1, "{n}: {r}");
    }
    let corner = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)].map(DVec2::from);
    assert!(smallest(&corner, false) < 0.2);
    assert_eq!(sharp_turns(&corner, false, 1.0).len(), 1);
    assert_eq!(smallest(&[DVec2::ZERO, DVec2::X, 2.0 * DVec2::X], false), f64::INFINITY);
}

#[test]
fn corners_become_arcs_of_the_radius() {
    for deg in [30.0f64, 45.0, 90.0, 120.0, 140.0] {
        let turn = deg.to_radians();
        let line = [DVec2::new(-30.0, 0.0), DVec2::ZERO, direction(turn) * 30.0];
        let (round, n) = rounded(&line, 3.0, 3.0, &anywhere);
        assert_eq!(n, 1, "{deg}");
        assert!(smallest(&round, false) >= 0.98 * 3.0, "{deg}: {}", smallest(&round, false));
        assert_eq!((round[0], round[round.len() - 1]), (line[0], line[2]));
    }
    // A chamfer: two corners become one arc.
    let line = [(-30.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, 30.0)].map(DVec2::from);
    let (round, n) = rounded(&line, 3.0, 3.0, &anywhere);
    assert_eq!(n, 1);
    assert!(smallest(&round, false) >= 0.98 * 3.0, "{} {round:?}", smallest(&round, false));
}

#[test]
fn where_there_is_no_room_the_corner_stays() {
    let back = [(0.0, 0.0), (30.0, 0.0), (30.0, 0.6), (0.0, 0.6)].map(DVec2::from);
    let (same, n) = rounded(&back, 3.0, 3.0, &anywhere);
    assert_eq!((same.as_slice(), n), (&back[..], 0));
    let corner = [(0.0, 0.0), (30.0, 0.0), (30.0, 30.0)].map(DVec2::from);
    assert_eq!(rounded(&corner, 3.0, 3.0, &|_, _| false).1, 0);
    let short = [(0.0, 0.0), (30.0, 0.0), (30.0, 1.0)].map(DVec2::from);
    assert_eq!(rounded(&short, 3.0, 3.0, &anywhere).1, 0);
}

#[test]
fn where_the_radius_does_not_fit_the_largest_that_fits_is_taken() {
    // A hairpin 0.9 mm wide, and a corner 2 mm before the end of the line. The chords of an arc
    // take away up to 0.01 mm, and a radius is found to 2 %; the second corner of a hairpin is left
    // a little less than the first.
    let hairpin = [(0.0, 0.0), (30.0, 0.0), (30.0, 0.9), (0.0, 0.9)].map(DVec2::from);
    let corner = [(0.0, 0.0), (30.0, 0.0), (30.0, 2.0)].map(DVec2::from);
    for (line, fits_mm, arcs) in [(&hairpin[..], 0.45, 2), (&corner[..], 2.0, 1)] {
        let (round, n) = rounded(line, 3.0, SMALLEST_MM, &anywhere);
        let r = smallest(&round, false);
        assert_eq!(n, arcs);
        assert!(r > 0.85 * fits_mm && r < 1.02 * fits_mm, "{r} of {fits_mm}");
        assert_eq!((round[0], round[round.len() - 1]), (line[0], line[line.len() - 1]));
        // All vertices of a hairpin are one turn, and so are its two corners.
        assert_eq!(sharp_bends(&round, false, 3.0).len(), 1);
        assert_eq!(sharp_bends(line, false, 3.0).len(), 1);
        assert!((sharp_bends(&round, false, 3.0)[0].radius_mm - r).abs() < 1e-12);
    }
    // Corners farther apart than the radius are turns of their own, and so are those of a zigzag.
    let square = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(DVec2::from);
    assert_eq!(sharp_bends(&square, true, 3.0).len(), 4);
    let zigzag = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, 1.0), (4.0, 0.0)].map(DVec2::from);
    assert_eq!(sharp_bends(&zigzag, false, 3.0).len(), 3);
    assert!(sharp_bends(&hairpin[..2], false, 3.0).is_empty());
}

#[test]
fn a_square_loop_turns_by_the_radius_and_begins_on_a_side() {
    let square = [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0)].map(DVec2::from);
    let infill_region = Region::from(Polygon { outer: square.to_vec(), holes: Vec::new() });
    let path = Toolpath::new(square.to_vec(), 0.45, Role::SolidFill, true);
    let mut out = Vec::new();
    let tally = settings().lay(vec![path.clone()], &place(&infill_region, 0.0), &mut out);
    assert_eq!((tally.rounded, tally.short, out.len()), (4, 0, 1));
    assert_eq!((out[0].role, out[0].width.clone()), (Role::Fibre, BeadWidth::Constant(0.6)));
    assert_eq!(out[0].start(), out[0].end());
    assert_eq!(out[0].start(), DVec2::new(20.0, 0.0));
    let points = &out[0].points[..out[0].points.len() - 1];
    assert!(smallest(points, true) >= 0.98 * 3.0, "{}", smallest(points, true));
    // Moved on, it begins that much farther along the same line.
    let mut moved = Vec::new();
    settings().lay(vec![path.clone()], &place(&infill_region, 1.5), &mut moved);
    assert!(moved[0].start().distance(DVec2::new(21.5, 0.0)) < 1e-9, "{}", moved[0].start());
    assert_eq!(moved[0].start(), moved[0].end());
    assert!((moved[0].length_mm() - out[0].length_mm()).abs() < 1e-9);
    // Too short for what is asked: it stays matrix.
    let mut out = Vec::new();
    let tally = FibreSettings { min_length_mm: 200.0, ..settings() }.lay(
        vec![path],
        &place(&infill_region, 0.0),
        &mut out,
    );
    assert_eq!((tally.short, out[0].role), (1, Role::SolidFill));
}

#[test]
fn fibre_is_cut_where_it_cannot_turn() {
    let zigzag: Vec<DVec2> = (0..10)
        .flat_map(|k| {
            let y = 0.6 * f64::from(k);
            let (a, b) = (DVec2::new(0.0, y), DVec2::new(40.0, y));
            if k % 2 == 0 { [a, b] } else { [b, a] }
        })
        .collect();
    let infill_region = Region::default();
    let path = Toolpath::new(zigzag, 0.6, Role::SolidFill, false);
    let mut out = Vec::new();
    FibreSettings { turns: FibreTurns::Cut, ..settings() }.lay(
        vec![path],
        &place(&infill_region, 0.0),
        &mut out,
    );
    assert_eq!(out.iter().filter(|p| p.role == Role::Fibre).count(), 10);
    for p in out.iter().filter(|p| p.role == Role::Fibre) {
        assert_eq!(smallest(&p.points, false), f64::INFINITY);
    }
}

#[test]
fn fibre_is_cut_where_rounded_coordinates_turn_more_sharply() {
    // Arcs above the radius that counts as sharp, in chords of 0.3 mm: coordinates with three decimals tell it to some percent.
    // Half of the coordinates lie between two micrometres, and where the part stands decides to which they are rounded.
    let arc = |n: f64| {
        // Each lies beside the one before, left and right of the origin.
        let (r_mm, middle) = (2.95 + 1e-2 * n, DVec2::X * 8.1 * (n - 20.0));
        let points = (0..=30).map(|k| r_mm * direction(0.1 * f64::from(k)) + middle);
        Toolpath::new(points.map(|p| (p * 2e3).round() / 2e3).collect(), 0.6, Role::SolidFill, false)
    };
    let paths: Vec<Toolpath> = (0..40).map(|n| arc(f64::from(n))).collect();
    for plate_from_part_mm in [DVec2::ZERO, DVec2::new(200.309, 103.5)] {
        let f =
            FibreSettings { turns: FibreTurns::Cut, min_length_mm: 2.0, plate_from_part_mm, ..settings() };
        let mut out = Vec::new();
        f.lay(paths.clone(), &place(&Region::default(), 0.0), &mut out);
        let fibre: Vec<&Toolpath> = out.iter().filter(|p| p.role == Role::Fibre).collect();
        assert!(fibre.iter().map(|p| p.length_mm()).sum::<f64>() > 200.0);
        for path in fibre {
            let written: Vec<DVec2> = path.points.iter().map(|p| as_written(*p, &f)).collect();
            assert!(
                sharp_bends(&written, false, f.min_radius_mm).is_empty(),
                "{}",
                smallest(&written, false)
            );
        }
    }
}

/// A point as G-code has it.
fn as_written(p: DVec2, f: &FibreSettings) -> DVec2 {
    ((p + f.plate_from_part_mm) * 1e3).round() * 1e-3
}

#[test]
fn a_ring_that_starts_within_an_arc_has_no_sharp_turn() {
    let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0)].map(DVec2::from);
    let ring = Toolpath::new(corners.to_vec(), 0.6, Role::SolidFill, true);
    let region = Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 30.0));
    let f = FibreSettings { turns: FibreTurns::Cut, ..settings() };
    let starts: Vec<DVec2> = (0..130)
        .map(|onward_mm| {
            let mut out = Vec::new();
            f.lay(vec![ring.clone()], &place(&region, f64::from(onward_mm)), &mut out);
            assert_eq!((out.len(), out[0].role), (1, Role::Fibre), "{onward_mm}");
            let points: Vec<DVec2> = out[0].points.iter().map(|p| as_written(*p, &f)).collect();
            assert_eq!(sharp_bends(&points, false, f.min_radius_mm), [], "{onward_mm}");
            points[0]
        })
        .collect();
    // The start still moves on all around.
    assert!(starts.windows(2).filter(|w| w[0].distance(w[1]) > 0.5).count() > 100, "{starts:?}");
}

#[test]
fn arcs_in_corners_do_not_cross_what_ends_there() {
    // A line turns at the corner of a square. Another ends a bead inside the corner, beyond the arc by which it is rounded.
    let line = |points: &[(f64, f64)]| {
        Toolpath::new(points.iter().map(|p| DVec2::from(*p)).collect(), 0.6, Role::SolidFill, false)
    };
    let paths = vec![line(&[(0.0, 49.0), (49.0, 49.0), (49.0, 0.0)]), line(&[(0.0, 0.0), (48.5, 48.5)])];
    let region = Region::rectangle(DVec2::ZERO, DVec2::splat(50.0));
    for turns in [FibreTurns::Round, FibreTurns::Cut] {
        let mut out = Vec::new();
        FibreSettings { turns, ..settings() }.lay(paths.clone(), &place(&region, 0.0), &mut out);
        assert!(out.iter().all(|p| p.role == Role::Fibre) && out.len() == 2, "{out:?}");
        let [corner, inside] = [&out[0], &out[1]];
        // The arc has 3.09 mm radius, so it passes the diagonal 1.28 mm before the corner.
        let end = inside.points[inside.points.len() - 1];
        let arc = corner.points.windows(2).map(|w| segment::distance_squared_mm2(end, w[0], w[1]).sqrt());
        let apart_mm = arc.fold(f64::INFINITY, f64::min);
        let spacings = apart_mm / bead_spacing_mm(0.6, 0.2);
        assert!((0.97..1.03).contains(&spacings), "{spacings}");
        assert!(inside.length_mm() > 65.0, "{inside:?}");
    }
}

#[test]
fn families_of_lines_that_cross_stay_whole() {
    let line = |points: [(f64, f64); 2]| {
        Toolpath::new(points.map(DVec2::from).to_vec(), 0.6, Role::SolidFill, false)
    };
    let families = (1..5).flat_map(|k| {
        let at = 10.0 * f64::from(k);
        [line([(1.0, at), (49.0, at)]), line([(at, 1.0), (at, 49.0)])]
    });
    let paths: Vec<Toolpath> = families.collect();
    let mut out = Vec::new();
    let region = Region::rectangle(DVec2::ZERO, DVec2::splat(50.0));
    settings().lay(paths.clone(), &place(&region, 0.0), &mut out);
    let laid: Vec<Vec<DVec2>> = out.into_iter().map(|p| p.points).collect();
    assert_eq!(laid, paths.into_iter().map(|p| p.points).collect::<Vec<_>>());
}

#[test]
fn rings_go_around_outlines_and_holes_before_the_rest() {
    let n = 360;
    let hole = (0..n).map(|k| direction(-f64::from(k) / f64::from(n) * std::f64::consts::TAU) * 5.0);
    let outer = [(-30.0, -15.0), (30.0, -15.0), (30.0, 15.0), (-30.0, 15.0)].map(DVec2::from).to_vec();
    let plate = Polygon { outer, holes: vec![hole.collect()] };
    let s = bead_spacing_mm(0.6, 0.2);
    let mut paths = Vec::new();
    let f = FibreSettings { rings: 2, ..settings() };
    let rest = f.lay_rings(std::slice::from_ref(&plate), 0.2, Role::SolidFill, &mut paths);
    let mut lengths: Vec<f64> = paths.iter().map(Toolpath::length_mm).collect();
    lengths.sort_by(f64::total_cmp);
    let around = |r: f64| std::f64::consts::TAU * r;
    let wanted = [around(5.0), around(5.0 + s), 180.0 - 8.0 * s, 180.0];
    assert!(paths.iter().all(|p| p.closed) && lengths.len() == 4, "{lengths:?}");
    lengths.iter().zip(wanted).for_each(|(l, w)| assert!((l / w - 1.0).abs() < 1e-3, "{l} {w}"));
    let area: f64 = rest.iter().map(Polygon::area_mm2).sum();
    let left = (60.0 - 4.0 * s) * (30.0 - 4.0 * s) - std::f64::consts::PI * (5.0 + 2.0 * s).powi(2);
    assert!((area / left - 1.0).abs() < 1e-3, "{area} {left}");
    let none = settings().lay_rings(std::slice::from_ref(&plate), 0.2, Role::SolidFill, &mut Vec::new());
    assert_eq!(none, [plate]);
}

#[test]
fn layers_and_boxes_choose() {
    let f = FibreSettings { layers: vec![[3, 8], [12, 12]], every: 2, ..settings() };
    let chosen: Vec<usize> = (0..15).filter(|&i| f.in_layer(i)).map(|i| i + 1).collect();
    assert_eq!(chosen, [3, 5, 7, 12]);
    let f = FibreSettings { matrix_layers: [2, 1], ..settings() };
    let chosen: Vec<usize> = (0..15).filter(|&i| f.in_layer(i)).map(|i| i + 1).collect();
    assert_eq!(chosen, (3..=14).collect::<Vec<_>>());
    let f = FibreSettings { boxes: vec![[DVec3::ZERO, DVec3::new(20.0, 50.0, 1.0)]], ..settings() };
    let infill_region = &Region::rectangle(DVec2::new(-10.0, 1.0), DVec2::new(40.0, 21.0)).polygons[0];
    let (with, without) = f.split((0, 0.5), 0.2, infill_region, 0.6);
    let area = |all: &[Polygon]| all.iter().map(Polygon::area_mm2).sum::<f64>();
    let s = bead_spacing_mm(0.6, 0.2);
    assert!((area(&with) - 20.0 * (20.0 - s)).abs() < 0.01, "{}", area(&with));
    assert!((area(&without) - 20.0 * (30.0 - s)).abs() < 0.01, "{}", area(&without));
    let (with, without) = f.split((0, 1.5), 0.2, infill_region, 0.6);
    assert!(with.is_empty() && (area(&without) - 1000.0).abs() < 1e-6);
    assert!(f.same((0, 0.1), (4, 0.9)) && !f.same((0, 0.1), (9, 1.1)));
}

#[test]
fn what_does_not_go_with_the_part_is_said() {
    let region = Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 10.0));
    let layers = (1..=5).filter_map(|k| Layer::new(0.2 * f64::from(k), 0.2, region.clone())).collect();
    let Some(stack) = LayerStack::new(layers) else { panic!("a stack") };
    let part = Bounds2 { min: DVec2::ZERO, max: DVec2::new(40.0, 10.0) };
    let said = |f: FibreSettings| f.check(&stack, part).expect_err("wrong").to_string();
    assert!(settings().check(&stack, part).is_ok());
    assert!(
        said(FibreSettings { min_radius_mm: 21.0, ..settings() })
            .contains("42.0 mm wide and the part 40.0 mm")
    );
    assert!(
        said(FibreSettings { layers: vec![[2, 6]], ..settings() }).contains("[2, 6]: the part has 5 layers")
    );
    assert!(
        said(FibreSettings { matrix_layers: [3, 2], ..settings() })
            .contains("[3, 2]: the part has 5 layers, which leaves none for fibre")
    );
    let far = vec![[DVec3::new(50.0, 0.0, 0.0), DVec3::new(60.0, 5.0, 1.0)]];
    assert!(said(FibreSettings { boxes: far, ..settings() }).contains("box 1 misses the part"));
}

/// Pieces of fibre that a zigzag over a rectangle of 100 mm along x becomes with wide turns.
fn zigzag_with_wide_turns(n_lines: usize, slant_mm: f64) -> (Vec<Toolpath>, f64, Region) {
    let s = bead_spacing_mm(0.6, 0.2);
    // Lines end half a bead inside; the hairpins are two right-angled corners.
    let zigzag: Vec<DVec2> = (0..n_lines)
        .flat_map(|k| {
            let y = (k as f64 + 0.5) * s;
            let (a, b) = (DVec2::new(0.3 + slant_mm * y, y), DVec2::new(99.7 + slant_mm * y, y));
            if k % 2 == 0 { [a, b] } else { [b, a] }
        })
        .collect();
    let high = n_lines as f64 * s;
    let corners = [(0.0, 0.0), (100.0, 0.0), (100.0 + slant_mm * high, high), (slant_mm * high, high)];
    let region = Region::from(Polygon { outer: corners.map(DVec2::from).to_vec(), holes: Vec::new() });
    let path = Toolpath::new(zigzag, 0.6, Role::SolidFill, false);
    let length_mm = path.length_mm();
    let mut out = Vec::new();
    FibreSettings { turns: FibreTurns::Wide, ..settings() }.lay(vec![path], &place(&region, 0.0), &mut out);
    (out, length_mm, region)
}

/// Pairs of segments that cross, of one path or of two.
fn crossings(paths: &[Toolpath]) -> Vec<[[DVec2; 2]; 2]> {
    let segments: Vec<[DVec2; 2]> =
        paths.iter().flat_map(|p| (0..p.n_segments()).map(|i| [p.segment(i).0, p.segment(i).1])).collect();
    let pairs = |(k, a): (usize, &[DVec2; 2])| {
        let crossed = segments[k + 1..].iter().filter(|b| segment::meeting(*a, **b) == Meeting::Cross);
        crossed.map(|b| [*a, *b]).collect::<Vec<_>>()
    };
    segments.iter().enumerate().flat_map(pairs).collect()
}

#[test]
fn wide_turns_keep_the_least_radius_and_most_of_the_fibre() {
    // Turns around an acute corner of 45 degrees reach deeper.
    for (slant_mm, least_share) in [(0.0, 0.95), (0.5, 0.95), (-1.0, 0.93)] {
        let (out, length_mm, region) = zigzag_with_wide_turns(60, slant_mm);
        let fibre: Vec<&Toolpath> = out.iter().filter(|p| p.role == Role::Fibre).collect();
        // Cut at every hairpin there would be 60 pieces.
        assert!((1..=30).contains(&fibre.len()), "{slant_mm}: {} pieces", fibre.len());
        let laid_mm: f64 = fibre.iter().map(|p| p.length_mm()).sum();
        assert!(laid_mm > least_share * length_mm, "{slant_mm}: {laid_mm} of {length_mm} mm");
        for piece in &fibre {
            let r_mm = smallest(&piece.points, piece.closed);
            assert!(r_mm >= 0.98 * settings().min_radius_mm, "{slant_mm}: {r_mm} mm");
        }
        assert!(crossings(&out).is_empty(), "{slant_mm}: {:?}", crossings(&out));
        let clipper = LineClipper::new(&region.offset(0.01, Join::Miter(2.0)));
        assert!(out.iter().all(|p| p.points.windows(2).all(|w| clipper.segment_inside(w[0], w[1]))));
        // Beads lie beside each other and not on each other.
        let lines: Vec<Region> = out.iter().map(|p| Region::around_line(&p.points, p.closed, 0.2)).collect();
        let alone: f64 = lines.iter().map(Region::area_mm2).sum();
        let together = lines.iter().fold(Region::default(), |sum, one| sum.union(one)).area_mm2();
        assert!(alone < 1.01 * together, "{slant_mm}: {alone} {together}");
    }
}

#[test]
fn too_few_lines_for_a_wide_turn_stay_cut() {
    let (out, length_mm, _) = zigzag_with_wide_turns(8, 0.0);
    assert_eq!(out.iter().filter(|p| p.role == Role::Fibre).count(), 8);
    assert!(out.iter().map(Toolpath::length_mm).sum::<f64>() > 0.99 * (length_mm - 8.0 * 0.6));
}

#[test]
fn lines_that_a_path_changes_are_joined_again() {
    let s = bead_spacing_mm(0.6, 0.2);
    let half = |x: [f64; 2]| {
        let points = [(x[0], 0.0), (x[1], 0.0), (x[1], s), (x[0], s)].map(DVec2::from);
        Toolpath::new(points.to_vec(), 0.6, Role::SolidFill, false)
    };
    let region = Region::rectangle(DVec2::new(-0.3, -0.3), DVec2::new(100.3, s + 0.3));
    let mut out = Vec::new();
    let f = FibreSettings { turns: FibreTurns::Wide, ..settings() };
    f.lay(vec![half([0.0, 49.7]), half([100.0, 50.3])], &place(&region, 0.0), &mut out);
    // Two lines of the whole length, and not four of half of it.
    assert_eq!(out.len(), 2);
    assert!(out.iter().all(|p| (p.length_mm() - 100.5).abs() < 0.3 && p.role == Role::Fibre));
    assert!(out.iter().all(|p| smallest(&p.points, false) > 100.0));
}
