//! Plates whose principal lines are known.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use grainpath_core::math::{atan2, direction};
use grainpath_core::{DMat3, DVec2, DVec3, Diagnostics, Polygon, Region, TriMesh};
use grainpath_fea::material::Orthotropic;
use grainpath_fea::plane::{
    Hold, PlaneMesh, PlaneProblem, PlaneStress, PlaneSystem, mesh_region, traction_n,
};
use grainpath_fea::principal::plane_principal;
use grainpath_fea::strength::card::StrengthCard;

use super::{
    CaseStress, Degenerate, DirectionSettings, Family, Fields, Follow, InPlaneStress, LayerField,
    StressedSection, degenerate_points, mixes_of,
};
use grainpath_core::streamlines::{LineSettings, trace_line};

fn circle(radius: f64, n: usize) -> Region {
    let outer = (0..n).map(|i| direction(i as f64 / n as f64 * TAU) * radius).collect();
    Polygon { outer, holes: Vec::new() }.into()
}

fn sides(mesh: &PlaneMesh, on: impl Fn(DVec2) -> bool) -> Vec<[u32; 3]> {
    mesh.border.iter().copied().filter(|s| s.iter().all(|&i| on(mesh.nodes[i as usize]))).collect()
}

/// Holds the three rigid motions at two nodes and solves for forces in balance.
fn balanced(mesh: &PlaneMesh, forces: &[DVec2]) -> PlaneStress {
    let nearest = |p: DVec2| {
        let all = (0..mesh.nodes.len()).map(|i| (mesh.nodes[i].distance(p), i as u32));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("nodes").1
    };
    let low = mesh.nodes.iter().copied().reduce(DVec2::min).expect("nodes");
    let high = mesh.nodes.iter().copied().reduce(DVec2::max).expect("nodes");
    let (a, b) = (nearest(DVec2::new(low.x, 0.0)), nearest(DVec2::new(high.x, 0.0)));
    let hold = |node, along| Hold { node, along, displacement_mm: 0.0 };
    let holds = [hold(a, DVec2::X), hold(a, DVec2::Y), hold(b, DVec2::Y)];
    solved(mesh, &holds, forces)
}

fn solved(mesh: &PlaneMesh, holds: &[Hold], forces: &[DVec2]) -> PlaneStress {
    let c = Orthotropic::isotropic(1000.0, 0.3).plane_stress(0.0).expect("stable");
    let stiffness = move |_: DVec2| c;
    let problem = PlaneProblem { mesh, thickness_mm: 1.0, stiffness: &stiffness, holds, max_mib: 1024.0 };
    let system = PlaneSystem::new(&problem).expect("held");
    system.stress(&system.solve(forces))
}

#[test]
fn the_edge_of_a_hole_in_tension_has_four_degenerate_points() {
    let plate = Region::rectangle(DVec2::splat(-40.0), DVec2::splat(40.0)).difference(&circle(3.0, 120));
    let mesh = mesh_region(&plate, 3.0, 0.02).expect("a sound plate");
    let ends = sides(&mesh, |p| (p.x.abs() - 40.0).abs() < 1e-9);
    let forces = traction_n(&mesh, &ends, 1.0, &|_, n| 10.0 * n);
    let found = degenerate_points(&balanced(&mesh, &forces));
    let mut angles: Vec<f64> = found
        .points
        .iter()
        .filter(|(kind, p)| *kind == Degenerate::Border && p.length() < 3.1)
        .map(|(_, p)| atan2(p.y, p.x).to_degrees())
        .collect();
    angles.sort_by(f64::total_cmp);
    println!("hoop stress changes sign at {angles:.1?} degrees from the load");
    assert_eq!(angles.len(), 4, "{angles:?}");
    for (got, want) in angles.iter().zip([-150.0, -30.0, 30.0, 150.0]) {
        assert!((got - want).abs() < 2.0, "{got} {want}");
    }
}

#[test]
fn principal_lines_of_a_ring_under_pressure_are_closed_circles_and_rays() {
    let ring = circle(20.0, 240).difference(&circle(10.0, 160));
    let mesh = mesh_region(&ring, 0.8, 0.02).expect("a sound ring");
    let inner = sides(&mesh, |p| p.length() < 10.01);
    let forces = traction_n(&mesh, &inner, 1.0, &|_, n| -10.0 * n);
    let stress = balanced(&mesh, &forces);
    let settings = LineSettings { tolerance_mm: 1e-6, step_mm: 0.4, longest_mm: 200.0 };
    let seed = direction(0.3) * 14.0;
    for (turn, circle) in [(0.0, true), (PI / 2.0, false)] {
        let axis = |p: DVec2| {
            let inside = (10.05..19.95).contains(&p.length());
            inside.then(|| direction(plane_principal(stress.at(p)).axis_rad + turn))
        };
        let line = trace_line(seed, &axis, &|_, _| false, &settings);
        assert_eq!(line.closed, circle, "{} points", line.points.len());
        if circle {
            let off = line.points.iter().map(|p| (p.length() - 14.0).abs()).fold(0.0, f64::max);
            println!("the circle of 14 mm closes within {off:.1e} mm");
            assert!(off < 1e-3 * 14.0, "{off}");
        } else {
            let ends = [line.points[0], line.points[line.points.len() - 1]].map(|p| p.length());
            assert!(ends.iter().any(|r| *r < 10.2) && ends.iter().any(|r| *r > 19.8), "{ends:?}");
            let bend = line.points.iter().map(|p| (atan2(p.y, p.x) - 0.3).abs()).fold(0.0, f64::max);
            assert!(bend < 2e-3, "{bend}");
        }
    }
}

#[test]
fn principal_lines_of_a_cantilever_cross_its_axis_at_45_degrees() {
    let beam = Region::rectangle(DVec2::new(0.0, -6.0), DVec2::new(48.0, 6.0));
    let mesh = mesh_region(&beam, 0.8, 0.02).expect("a sound beam");
    let root = (0..mesh.nodes.len() as u32).filter(|&i| mesh.nodes[i as usize].x < 1e-9);
    let holds: Vec<Hold> = root
        .flat_map(|node| [DVec2::X, DVec2::Y].map(|along| Hold { node, along, displacement_mm: 0.0 }))
        .collect();
    let tip = sides(&mesh, |p| p.x > 48.0 - 1e-9);
    let forces = traction_n(&mesh, &tip, 1.0, &|p, _| DVec2::new(0.0, p.y * p.y / 36.0 - 1.0));
    let stress = solved(&mesh, &holds, &forces);
    for x in [16.0, 24.0, 32.0] {
        let axis = plane_principal(stress.at(DVec2::new(x, 0.0))).axis_rad.to_degrees();
        println!("at x = {x}: {axis:.2} degrees");
        assert!((axis.rem_euclid(90.0) - 45.0).abs() < 0.5, "{axis}");
    }
    // At the upper and lower edges the lines run along and across them.
    for y in [-6.0, 6.0] {
        let axis = plane_principal(stress.at(DVec2::new(24.0, y))).axis_rad.to_degrees();
        assert!((axis + 45.0).rem_euclid(90.0) - 45.0 < 0.5, "{axis}");
    }
}

/// A stress that is known at every point.
struct Known<F>(F);

impl<F: Fn(DVec2) -> [f64; 3] + Send + Sync> InPlaneStress for Known<F> {
    fn at(&self, p: DVec3) -> [f64; 3] {
        (self.0)(p.truncate())
    }
}

fn layer_of(region: &Region, stress: impl Fn(DVec2) -> [f64; 3] + Send + Sync + 'static) -> LayerField {
    let case = CaseStress { name: "known".into(), weight: 1.0, stress: Arc::new(Known(stress)) };
    let settings = DirectionSettings {
        follow: Follow::MaxAbs,
        across: false,
        smoothing_mm: 1.0,
        tangent: false,
        cell_mm: 0.45,
        rows: DVec2::X,
        find_degenerate: true,
    };
    let cases = [case];
    StressedSection::new(region, 1.0, &cases, &|_| true, &settings).field(&[1.0], &|_| true, &settings)
}

#[test]
fn degenerate_points_of_a_section_are_found_where_they_are() {
    let (wedge, trisector) = (DVec2::new(-5.1, 1.3), DVec2::new(6.2, -2.4));
    let plate = Region::rectangle(DVec2::new(-12.0, -8.0), DVec2::new(12.0, 8.0));
    let field = layer_of(&plate, move |p| {
        let (a, b) = (p - wedge, p - trisector);
        // One turn of the deviator about the wedge, one the other way about the trisector.
        let d = DVec2::new(a.x * b.x + a.y * b.y, a.y * b.x - a.x * b.y);
        [30.0 + d.x, 30.0 - d.x, d.y]
    });
    let found = &field.degenerate().points;
    let place = |kind| found.iter().find(|p| p.0 == kind).expect("found").1;
    println!("{found:?}");
    assert_eq!(found.iter().filter(|p| p.0 != Degenerate::Border).count(), 2);
    assert!(place(Degenerate::Wedge).distance(wedge) < 0.05);
    assert!(place(Degenerate::Trisector).distance(trisector) < 0.05);

    // Kirsch's hole in tension along x, as a layer of a solid would have it.
    let holed = Region::rectangle(DVec2::splat(-20.0), DVec2::splat(20.0)).difference(&circle(4.0, 240));
    let field = layer_of(&holed, |p| {
        let (r, t) = (p.length().max(4.0), atan2(p.y, p.x));
        let (q, two, four) = (16.0 / (r * r), direction(2.0 * t), direction(4.0 * t));
        let c = 1.5 * q * q;
        [
            10.0 * (1.0 - q * (1.5 * two.x + four.x) + c * four.x),
            10.0 * (-q * (0.5 * two.x - four.x) - c * four.x),
            10.0 * (-q * (0.5 * two.y + four.y) + c * four.y),
        ]
    });
    let near = |p: &&(Degenerate, DVec2)| p.0 == Degenerate::Border && p.1.length() < 4.3;
    let border: Vec<f64> =
        field.degenerate().points.iter().filter(near).map(|(_, p)| atan2(p.y, p.x).to_degrees()).collect();
    assert_eq!(border.len(), 4, "{border:?}");
    for angle in border {
        let off = (angle.abs() - 30.0).abs().min((angle.abs() - 150.0).abs());
        assert!(off < 2.0, "{angle}");
    }
}

/// Stiff and strong along the beads.
fn card(e_mpa: [f64; 3], yt_mpa: f64) -> StrengthCard {
    StrengthCard {
        elastic: Orthotropic { e_mpa, nu: [0.4, 0.37, 0.37], g_mpa: [1700.0, 1500.0, 1500.0] },
        xt_mpa: 105.0,
        yt_mpa,
        s12_mpa: 35.0,
        xc_mpa: 110.0,
        yc_mpa: 95.0,
        zt_mpa: 67.7,
        s_il_mpa: 33.0,
        g_along_n_mm: 4.0,
        g_across_n_mm: 1.3,
    }
}

/// The mix for a square under cases of an even stress, each with its weight, as families that layers take in turn: 0 for
/// that of all cases, 1 for that of the first.
fn mix_of(cases: &[(f64, [f64; 3])], card: &StrengthCard) -> Vec<usize> {
    let square = Region::rectangle(DVec2::ZERO, DVec2::splat(12.0));
    let case = |&(weight, stress): &(f64, [f64; 3])| CaseStress {
        name: format!("{stress:?}"),
        weight,
        stress: Arc::new(Known(move |_| stress)),
    };
    let cases: Vec<CaseStress> = cases.iter().map(case).collect();
    let settings = DirectionSettings {
        follow: Follow::MaxAbs,
        across: false,
        smoothing_mm: 1.0,
        tangent: false,
        cell_mm: 1.0,
        rows: DVec2::X,
        find_degenerate: false,
    };
    let families = Family::of_cases(cases.len(), card);
    let section = StressedSection::new(&square, 1.0, &cases, &|_| true, &settings);
    let sections = [Fields::new(section, &families, &|_| true, &settings)];
    let mixes = mixes_of(card, &cases, &sections, &|_| true).expect("stable");
    mixes.best(&|n| vec![1.0 / n as f64; n], &Diagnostics::default()).expect("not stopped")
}

#[test]
fn layers_take_turns_where_cases_disagree() {
    let stiff = card([7453.0, 4500.0, 4354.0], 65.0);
    let (x, y) = ([20.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
    assert_eq!(mix_of(&[(1.0, x), (1.0, y)], &stiff), [1, 2]);
    // Weights change nothing where one mix is best.
    assert_eq!(mix_of(&[(1.0, x), (50.0, y)], &stiff), [1, 2]);
    // The same turned by 37 degrees.
    let turned = |deg: f64| {
        let d = direction(deg.to_radians());
        [20.0 * d.x * d.x, 20.0 * d.y * d.y, 20.0 * d.x * d.y]
    };
    assert_eq!(mix_of(&[(1.0, turned(37.0)), (1.0, turned(127.0))], &stiff), [1, 2]);
    // Cases that agree, and one that hardly loads the part, need no turns.
    assert_eq!(mix_of(&[(1.0, x), (1.0, [12.0, 0.0, 0.0])], &stiff).len(), 1);
    assert_eq!(mix_of(&[(1.0, x), (1.0, [0.0, 2.0, 0.0])], &stiff).len(), 1);
    // A case of three quarters of the other's stress needs fewer layers.
    let uneven = mix_of(&[(1.0, x), (1.0, [0.0, 15.0, 0.0])], &stiff);
    let count = |family: usize| uneven.iter().filter(|f| **f == family).count();
    assert!(count(1) > count(2), "{uneven:?}");
}

#[test]
fn weights_decide_between_mixes_of_one_reserve() {
    // As stiff across as along, and weak in shear: plies share alike, and any mix fails across the beads at the same load.
    let even = StrengthCard { s12_mpa: 15.0, ..card([3000.0; 3], 50.0) };
    let (x, y) = ([20.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
    assert_eq!(mix_of(&[(1.0, x), (3.0, y)], &even), [2]);
    let other = mix_of(&[(3.0, x), (1.0, y)], &even);
    assert!(other.len() == 1 && other != [2], "{other:?}");
}

#[test]
fn many_cases_are_all_judged() {
    let stiff = card([7453.0, 4500.0, 4354.0], 65.0);
    let pull = |deg: f64, mpa: f64| {
        let d = direction(deg.to_radians());
        (1.0, [mpa * d.x * d.x, mpa * d.y * d.y, mpa * d.x * d.y])
    };
    // Six cases, of which the last two are by far the largest and cross each other.
    let cases = [0.0, 20.0, 45.0, 70.0].map(|deg| pull(deg, 2.0));
    let mut cases = cases.to_vec();
    cases.extend([pull(10.0, 20.0), pull(100.0, 20.0)]);
    assert_eq!(mix_of(&cases, &stiff), [5, 6]);
}

#[test]
fn the_longest_side_of_a_part_does_not_depend_on_its_turn() {
    let bar = TriMesh::cuboid(DVec3::ZERO, DVec3::new(50.0, 8.0, 6.0));
    for turn in [
        DMat3::IDENTITY,
        DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        crate::shape::Standing::new(1.0, [0.3, -0.7, 0.6], 0.0).rotation,
    ] {
        let turned = TriMesh { vertices: bar.vertices.iter().map(|p| turn * *p).collect(), ..bar.clone() };
        assert!((super::trust::longest_side_mm(&turned, turn) - 50.0).abs() < 1e-9);
    }
}
