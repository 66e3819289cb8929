//! Verification against closed forms and published benchmarks; the figures are in `docs/verification.md`.
// Howland's factor for a hole of a fifth of the width happens to be 3.14.
#![allow(clippy::approx_constant)]

use std::f64::consts::{FRAC_PI_2, TAU};

use grainpath_core::math::{direction, sin_cos};
use grainpath_core::triangulation::Triangulation;
use grainpath_core::{DVec2, Polygon, Region};

use super::*;
use crate::material::Orthotropic;
use crate::sparse::{Cholesky, Symmetric};

/// `nu` by `nv` squares over the unit square, halved, laid where `map` says, curved sides and all.
fn mapped(nu: usize, nv: usize, map: impl Fn(f64, f64) -> DVec2) -> PlaneMesh {
    let at = |i: usize, j: usize| (j * (nu + 1) + i) as u32;
    let unit: Vec<DVec2> = (0..=nv)
        .flat_map(|j| (0..=nu).map(move |i| DVec2::new(i as f64 / nu as f64, j as f64 / nv as f64)))
        .collect();
    let mut triangles = Vec::new();
    for j in 0..nv {
        for i in 0..nu {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    let mut mesh = PlaneMesh::quadratic(&Triangulation { points: unit, triangles });
    mesh.nodes.iter_mut().for_each(|p| *p = map(p.x, p.y));
    mesh
}

fn hold(mesh: &PlaneMesh, along: DVec2, on: impl Fn(DVec2) -> bool) -> Vec<Hold> {
    let nodes = mesh.nodes.iter().enumerate().filter(|(_, p)| on(**p));
    nodes.map(|(i, _)| Hold { node: i as u32, along, displacement_mm: 0.0 }).collect()
}

fn sides(mesh: &PlaneMesh, on: impl Fn(DVec2) -> bool) -> Vec<[u32; 3]> {
    mesh.border.iter().copied().filter(|s| s.iter().all(|&i| on(mesh.nodes[i as usize]))).collect()
}

fn solved(
    mesh: &PlaneMesh,
    c: PlaneStiffness,
    thickness_mm: f64,
    holds: &[Hold],
    forces: &[DVec2],
) -> (PlaneSolution, PlaneStress) {
    let stiffness = move |_: DVec2| c;
    let problem = PlaneProblem { mesh, thickness_mm, stiffness: &stiffness, holds, max_mib: 1024.0 };
    let system = PlaneSystem::new(&problem).expect("a sound problem");
    let solution = system.solve(forces);
    assert!(solution.residual < 1e-10, "residual {}", solution.residual);
    let stress = system.stress(&solution);
    (solution, stress)
}

fn isotropic(e_mpa: f64, nu: f64) -> PlaneStiffness {
    Orthotropic::isotropic(e_mpa, nu).plane_stress(0.0).expect("stable")
}

#[test]
fn patch_of_constant_strain_is_exact() {
    // MacNeal and Harder's patch, and the same with a turned orthotropic lamina.
    let points =
        [[0.0, 0.0], [0.24, 0.0], [0.24, 0.12], [0.0, 0.12], [0.04, 0.02], [0.18, 0.03], [0.16, 0.08]];
    let points: Vec<DVec2> = points.into_iter().chain([[0.08, 0.08]]).map(DVec2::from).collect();
    let quads = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = PlaneMesh::quadratic(&Triangulation { points, triangles });
    let exact = |p: DVec2| 1e-3 * DVec2::new(p.x + 0.5 * p.y, p.y + 0.5 * p.x);
    let border: std::collections::BTreeSet<u32> = mesh.border.iter().flatten().copied().collect();
    let held = |axis: DVec2| {
        let mesh = &mesh;
        border.iter().map(move |&node| {
            let u = exact(mesh.nodes[node as usize]);
            Hold { node, along: axis, displacement_mm: u.dot(axis) }
        })
    };
    let turned =
        Orthotropic { e_mpa: [60000.0, 3500.0, 3500.0], nu: [0.3; 3], g_mpa: [1900.0, 1300.0, 1900.0] };
    for c in [isotropic(1e6, 0.25), turned.plane_stress(0.7).expect("stable")] {
        for skew in [0.0, 0.6] {
            let (e, f) = (direction(skew), direction(skew + 1.1));
            let holds: Vec<Hold> = held(e).chain(held(f)).collect();
            let (solution, stress) = solved(&mesh, c, 0.001, &holds, &vec![DVec2::ZERO; mesh.nodes.len()]);
            for (u, p) in solution.displacement_mm.iter().zip(&mesh.nodes) {
                assert!(u.distance(exact(*p)) < 1e-12, "{u} at {p}");
            }
            let strain = [1e-3, 1e-3, 1e-3];
            let want = c.map(|r| r[0] * strain[0] + r[1] * strain[1] + r[2] * strain[2]);
            for got in stress.nodal_mpa() {
                (0..3).for_each(|k| {
                    assert!((got[k] - want[k]).abs() < 1e-9 * want[0].abs(), "{got:?} {want:?}")
                });
            }
        }
    }
}

#[test]
fn an_element_has_three_rigid_motions_and_no_more() {
    let p = [[0.0, 0.0], [3.0, 0.4], [0.7, 2.0], [1.5, 0.1], [1.9, 1.3], [0.3, 1.0]].map(DVec2::from);
    let lamina = Orthotropic { e_mpa: [3376.0, 3125.0, 3000.0], nu: [0.33; 3], g_mpa: [1092.0; 3] };
    let k = quadratic_triangle::stiffness(&p, &lamina.plane_stress(0.5).expect("stable"), 1.0)
        .expect("not inverted");
    let rigid = [|_: DVec2| DVec2::X, |_: DVec2| DVec2::Y, |p: DVec2| DVec2::new(-p.y, p.x)];
    for motion in rigid {
        let u: Vec<f64> = p.iter().flat_map(|&q| motion(q).to_array()).collect();
        for row in &k {
            assert!(row.iter().zip(&u).map(|(a, b)| a * b).sum::<f64>().abs() < 1e-9 * 3376.0);
        }
    }
    // Held against those three, what remains is positive definite.
    let keep: Vec<usize> = (0..12).filter(|i| ![0, 1, 3].contains(i)).collect();
    let mut a = Symmetric { starts: vec![0], ..Symmetric::default() };
    for (j, &c) in keep.iter().enumerate() {
        for (i, &r) in keep.iter().enumerate().skip(j) {
            a.rows.push(i);
            a.values.push(k[r][c]);
        }
        a.starts.push(a.rows.len());
    }
    assert!(Cholesky::new(&a, None, 1024.0).is_ok());
}

/// Stress yy at D of NAFEMS LE1; lengths in m, stresses in MPa.
fn le1(n: usize) -> f64 {
    let mesh = mapped(2 * n, n, |u, v| {
        let t = FRAC_PI_2 * (1.0 - u);
        let (s, c) = sin_cos(t);
        DVec2::new(2.0 * c, s).lerp(DVec2::new(3.25 * c, 2.75 * s), v)
    });
    let mut holds = hold(&mesh, DVec2::X, |p| p.x.abs() < 1e-9);
    holds.extend(hold(&mesh, DVec2::Y, |p| p.y.abs() < 1e-9));
    let outer = sides(&mesh, |p| ((p.x / 3.25).powi(2) + (p.y / 2.75).powi(2) - 1.0).abs() < 1e-9);
    let forces = traction_n(&mesh, &outer, 0.1, &|_, n| 10.0 * n);
    let total: f64 = forces.iter().map(|f| f.x).sum();
    assert!((total - 2.75).abs() < 1e-3, "{total}");
    let (_, stress) = solved(&mesh, isotropic(210_000.0, 0.3), 0.1, &holds, &forces);
    stress.at(DVec2::new(2.0, 0.0))[1]
}

#[test]
fn nafems_le1() {
    let found: Vec<f64> = [8, 16, 32].map(le1).to_vec();
    println!("LE1 sigma_yy(D): {found:.2?} MPa, reference 92.7");
    assert!((found[2] - 92.7).abs() < 0.01 * 92.7, "{found:?}");
    assert!((found[2] - found[1]).abs() < (found[1] - found[0]).abs(), "{found:?}");
}

/// From 0 to 1, the steps at the end `ratio` times those at the start.
fn graded(t: f64, ratio: f64) -> f64 {
    (libm::pow(ratio, t) - 1.0) / (ratio - 1.0)
}

/// Greatest stress over the mean stress of the whole width, at a central hole of `ratio` of the
/// width, load along x.
fn hole_factor(ratio: f64, c: PlaneStiffness, long: f64, n: usize) -> f64 {
    let (w, r) = (1.0, 0.5 * ratio);
    let mesh = mapped(n, n, |u, v| {
        // From the hole's rim to the rim of a quarter plate, closer together near the hole
        // and towards its top, where the greatest stress is.
        let u = if u < 0.5 { 1.0 - 0.5 * graded(2.0 * u, 20.0) } else { 1.0 - u };
        let rim = direction(FRAC_PI_2 * u) * r;
        let edge = if u < 0.5 {
            DVec2::new(0.5 * long, 0.5 * w * (2.0 * u))
        } else {
            DVec2::new(0.5 * long * (2.0 - 2.0 * u), 0.5 * w)
        };
        rim.lerp(edge, graded(v, 400.0))
    });
    let mut holds = hold(&mesh, DVec2::X, |p| p.x.abs() < 1e-9);
    holds.extend(hold(&mesh, DVec2::Y, |p| p.y.abs() < 1e-9));
    let end = sides(&mesh, |p| (p.x - 0.5 * long).abs() < 1e-9);
    let forces = traction_n(&mesh, &end, 1.0, &|_, _| DVec2::X);
    let (_, stress) = solved(&mesh, c, 1.0, &holds, &forces);
    stress.at(DVec2::new(0.0, r))[0]
}

#[test]
fn holes_in_strips_of_finite_width() {
    let c = isotropic(3000.0, 0.3);
    // Howland's factors on the gross section.
    for (ratio, want) in [(0.1, 3.03), (0.2, 3.14), (0.3, 3.36), (0.4, 3.74), (0.5, 4.32)] {
        let got = hole_factor(ratio, c, 3.0, 40);
        println!("hole d/W = {ratio}: Kt = {got:.3}, Howland {want}");
        assert!((got - want).abs() < 0.015 * want, "{ratio}: {got} {want}");
    }
}

#[test]
fn holes_in_orthotropic_plates() {
    let card = |e1, e2, g12| Orthotropic { e_mpa: [e1, e2, e2], nu: [0.33; 3], g_mpa: [g12; 3] };
    let pla = card(3120.0, 2770.0, 1050.0);
    let carbon = Orthotropic { nu: [0.3; 3], ..card(60000.0, 3500.0, 1900.0) };
    let infinite =
        |e1: f64, e2: f64, nu12: f64, g12: f64| 1.0 + (2.0 * ((e1 / e2).sqrt() - nu12) + e1 / g12).sqrt();
    let cases = [
        ("PLA along", pla.plane_stress(0.0), infinite(3120.0, 2770.0, 0.33, 1050.0)),
        ("PLA across", pla.plane_stress(FRAC_PI_2), infinite(2770.0, 3120.0, 0.33 * 2770.0 / 3120.0, 1050.0)),
        (
            "carbon across",
            carbon.plane_stress(FRAC_PI_2),
            infinite(3500.0, 60000.0, 0.3 * 3500.0 / 60000.0, 1900.0),
        ),
        ("carbon along", carbon.plane_stress(0.0), infinite(60000.0, 3500.0, 0.3, 1900.0)),
    ];
    for (name, c, want) in cases {
        let got = hole_factor(0.02, c.expect("stable"), 2.0, 96);
        println!("Lekhnitskii, {name}: Kt = {got:.3}, infinite plate {want:.3}");
        assert!((got - want).abs() < 0.015 * want, "{name}: {got} {want}");
    }
}

#[test]
fn thick_ring_under_pressure() {
    let (a, b, p, e, nu) = (10.0, 20.0, 10.0, 1000.0, 0.3);
    let errors: Vec<f64> = [4, 8, 16]
        .iter()
        .map(|&n| {
            let mesh = mapped(2 * n, n, |u, v| direction(FRAC_PI_2 * (1.0 - u)) * (a + (b - a) * v));
            let mut holds = hold(&mesh, DVec2::X, |p| p.x.abs() < 1e-9);
            holds.extend(hold(&mesh, DVec2::Y, |p| p.y.abs() < 1e-9));
            let inner = sides(&mesh, |p| (p.length() - a).abs() < 1e-9);
            let forces = traction_n(&mesh, &inner, 1.0, &|_, n| -p * n);
            let (solution, stress) = solved(&mesh, isotropic(e, nu), 1.0, &holds, &forces);
            let hoop = stress.at(DVec2::new(a, 0.0))[1];
            let node = mesh.nodes.iter().position(|q| q.distance(DVec2::new(a, 0.0)) < 1e-9);
            let u = solution.displacement_mm[node.expect("a corner of the mesh")].x;
            println!("Lame n = {n}: hoop {hoop:.4} (16.6667), u {u:.6} (0.196667)");
            assert!((u - 0.196_667).abs() < 2e-4, "{u}");
            (hoop - 50.0 / 3.0).abs()
        })
        .collect();
    assert!(errors[2] < 0.005 * 16.67, "{errors:?}");
}

#[test]
fn timoshenko_cantilever_converges_at_the_order_of_theory() {
    let (l, d, e, nu, load) = (48.0, 12.0, 3e7, 0.3, 1000.0);
    let i = d * d * d / 12.0;
    let exact = |p: DVec2| {
        let DVec2 { x, y } = p;
        let k = load / (6.0 * e * i);
        DVec2::new(
            k * y * ((6.0 * l - 3.0 * x) * x + (2.0 + nu) * (y * y - d * d / 4.0)),
            -k * (3.0 * nu * y * y * (l - x) + (4.0 + 5.0 * nu) * d * d * x / 4.0 + (3.0 * l - x) * x * x),
        )
    };
    // The sign convention of the field: load upwards on the tip turns the stresses over.
    let run = |n: usize| {
        let mesh = mapped(4 * n, n, |u, v| DVec2::new(l * u, d * (v - 0.5)));
        let root: Vec<u32> =
            (0..mesh.nodes.len() as u32).filter(|&k| mesh.nodes[k as usize].x < 1e-9).collect();
        let held = |along: DVec2| {
            let mesh = &mesh;
            root.iter().map(move |&node| {
                let displacement_mm = exact(mesh.nodes[node as usize]).dot(along);
                Hold { node, along, displacement_mm }
            })
        };
        let holds: Vec<Hold> = held(DVec2::X).chain(held(DVec2::Y)).collect();
        let tip = sides(&mesh, |p| p.x > l - 1e-9);
        let shear = |p: DVec2, _| DVec2::new(0.0, -load / (2.0 * i) * (d * d / 4.0 - p.y * p.y));
        let forces = traction_n(&mesh, &tip, 1.0, &shear);
        let (solution, _) = solved(&mesh, isotropic(e, nu), 1.0, &holds, &forces);
        let all = solution.displacement_mm.iter().zip(&mesh.nodes);
        let square: f64 = all.map(|(u, p)| u.distance_squared(exact(*p))).sum();
        (square / mesh.nodes.len() as f64).sqrt()
    };
    let errors = [1, 2, 4].map(run);
    let order = (errors[1] / errors[2]).log2();
    println!("Timoshenko: rms errors {errors:?}, order {order:.2} (theory 3)");
    assert!((exact(DVec2::new(l, 0.0)).y + 0.0089).abs() < 1e-4);
    assert!(errors[2] < 1e-3 * 0.0089 && order > 2.7, "{errors:?} {order}");
}

#[test]
fn cooks_membrane() {
    let run = |n: usize| {
        let mesh = mapped(n, n, |u, v| DVec2::new(48.0 * u, (44.0 * u) * (1.0 - v) + (44.0 + 16.0 * u) * v));
        let mut holds = hold(&mesh, DVec2::X, |p| p.x < 1e-9);
        holds.extend(hold(&mesh, DVec2::Y, |p| p.x < 1e-9));
        let right = sides(&mesh, |p| p.x > 48.0 - 1e-9);
        let forces = traction_n(&mesh, &right, 1.0, &|_, _| DVec2::Y / 16.0);
        let (solution, _) = solved(&mesh, isotropic(1.0, 1.0 / 3.0), 1.0, &holds, &forces);
        let tip = mesh.nodes.iter().position(|p| p.distance(DVec2::new(48.0, 52.0)) < 1e-9);
        solution.displacement_mm[tip.expect("a node in the middle of the edge")].y
    };
    let found = [4, 8, 16, 32].map(run);
    println!("Cook: {found:.3?}, reference 23.96");
    assert!((found[3] - 23.96).abs() < 0.003 * 23.96 && found[0] < found[3], "{found:?}");
}

#[test]
fn a_loose_part_is_named() {
    let mesh = mapped(4, 2, |u, v| DVec2::new(4.0 * u, 2.0 * v));
    let c = isotropic(1000.0, 0.3);
    let stiffness = move |_: DVec2| c;
    let free = |holds: &[Hold]| {
        let problem =
            PlaneProblem { mesh: &mesh, thickness_mm: 1.0, stiffness: &stiffness, holds, max_mib: 1024.0 };
        match PlaneSystem::new(&problem) {
            Err(PlaneError::Free { how, .. }) => how,
            _ => "nothing",
        }
    };
    assert_eq!(free(&[]), "move along x");
    assert_eq!(free(&hold(&mesh, DVec2::X, |p| p.x < 1e-9)), "move along y");
    let corner = |along| hold(&mesh, along, |p| p.length() < 1e-9);
    let pinned: Vec<Hold> = corner(DVec2::X).into_iter().chain(corner(DVec2::Y)).collect();
    assert_eq!(free(&pinned), "turn about z");
    let both: Vec<Hold> = pinned.into_iter().chain(hold(&mesh, DVec2::Y, |p| p.x > 3.9)).collect();
    assert_eq!(free(&both), "nothing");
}

#[test]
fn contradictory_supports_are_refused_and_repeats_are_not() {
    let mesh = mapped(4, 2, |u, v| DVec2::new(4.0 * u, 2.0 * v));
    let c = isotropic(1000.0, 0.3);
    let stiffness = move |_: DVec2| c;
    let refused = |more: &[(DVec2, f64)]| {
        let mut holds = hold(&mesh, DVec2::X, |p| p.x < 1e-9);
        holds.extend(hold(&mesh, DVec2::Y, |p| p.x < 1e-9));
        let node = holds[0].node;
        holds.extend(more.iter().map(|&(along, displacement_mm)| Hold { node, along, displacement_mm }));
        let problem = PlaneProblem {
            mesh: &mesh,
            thickness_mm: 1.0,
            stiffness: &stiffness,
            holds: &holds,
            max_mib: 1024.0,
        };
        matches!(PlaneSystem::new(&problem), Err(PlaneError::Contradiction { .. }))
    };
    assert!(!refused(&[(DVec2::X, 0.0), (DVec2::ONE.normalize(), 0.0)]));
    assert!(refused(&[(DVec2::X, 0.1)]));
    assert!(refused(&[(DVec2::ONE.normalize(), -0.1)]));
}

#[test]
fn a_free_mesh_of_a_plate_with_a_hole_finds_the_stress_at_its_rim() {
    // Meshed as the planner does, from a polygon of a circle: Howland's 3.14 at d/W = 0.2.
    let disc = |k: usize| direction(k as f64 / 96.0 * TAU) * 2.0;
    let hole = Region::from(Polygon { outer: (0..96).map(disc).collect(), holes: Vec::new() });
    let plate = Region::rectangle(DVec2::new(-30.0, -10.0), DVec2::new(30.0, 10.0)).difference(&hole);
    let mesh = mesh_region(&plate, 1.5, 0.05).expect("a sound plate");
    let mut holds = hold(&mesh, DVec2::X, |p| p.x < -30.0 + 1e-9);
    holds.push(Hold { node: holds[0].node, along: DVec2::Y, displacement_mm: 0.0 });
    let end = sides(&mesh, |p| p.x > 30.0 - 1e-9);
    let forces = traction_n(&mesh, &end, 4.0, &|_, _| DVec2::X);
    let (_, stress) = solved(&mesh, isotropic(3000.0, 0.3), 4.0, &holds, &forces);
    let top = stress.at(DVec2::new(0.0, 2.0))[0];
    println!("free mesh: Kt = {top:.3}, error estimate {:.3}", stress.error_estimate());
    assert!((top - 3.14).abs() < 0.02 * 3.14, "{top}");
    assert!(stress.error_estimate() < 0.03, "{}", stress.error_estimate());
}
