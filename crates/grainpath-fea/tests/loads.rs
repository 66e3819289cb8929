//! Bearing loads, torques, remote forces, preloads and centrifugal loads against closed forms, on a bar and a tube.

mod support;

use std::f64::consts::{PI, TAU};

use grainpath_core::math::sin_cos;
use grainpath_core::selection::{Facets, Selection};
use grainpath_core::{DVec3, TriMesh};
use grainpath_fea::load_case::{Action, BoundaryConditions, Fixture, Held, Load, LoadCase};
use grainpath_fea::resultant::Resultant;
use grainpath_fea::solid::{
    LoadedSolid, MeshSettings, Model, SolidError, SolveSettings, mesh, recover, solve,
};
use support::isotropic;

const E_MPA: f64 = 2000.0;
const NU: f64 = 0.3;
const DENSITY_T_MM3: f64 = 1.2e-9;

/// A tube about z from z = 0, or a rod for an inner radius of 0.
fn tube(inner: f64, outer: f64, length: f64, sides: u32) -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut ring = |radius: f64, z: f64| {
        let first = mesh.vertices.len() as u32;
        for i in 0..sides {
            let (s, c) = sin_cos(TAU * f64::from(i) / f64::from(sides));
            mesh.vertices.push(DVec3::new(radius * c, radius * s, z));
        }
        first
    };
    let rings = [ring(outer, 0.0), ring(outer, length)];
    let inside = if inner > 0.0 { Some([ring(inner, 0.0), ring(inner, length)]) } else { None };
    let mut band = |low: u32, high: u32| {
        for i in 0..sides {
            let j = (i + 1) % sides;
            mesh.triangles.push([low + i, low + j, high + j]);
            mesh.triangles.push([low + i, high + j, high + i]);
        }
    };
    band(rings[0], rings[1]);
    match inside {
        Some([low, high]) => {
            band(high, low);
            band(rings[1], high);
            band(low, rings[0]);
        }
        None => {
            let n = mesh.vertices.len() as u32;
            mesh.vertices.extend([DVec3::ZERO, DVec3::Z * length]);
            for i in 0..sides {
                let j = (i + 1) % sides;
                mesh.triangles.push([n, rings[0] + j, rings[0] + i]);
                mesh.triangles.push([n + 1, rings[1] + i, rings[1] + j]);
            }
        }
    }
    mesh
}

fn plane(z: f64) -> Selection {
    Selection::Plane { point: DVec3::Z * z, normal: DVec3::Z, tolerance_mm: 0.01 }
}

struct Solved {
    load: Resultant,
    reaction: Resultant,
    /// Position and displacement of the nodes.
    moved: Vec<(DVec3, DVec3)>,
    volume_mm3: f64,
}

/// A part held at z = 0 under one load.
fn solved(surface: &TriMesh, action: Action, size_mm: f64) -> Solved {
    let held = Fixture {
        name: "fixture 1".into(),
        on: plane(0.0),
        held: Held::Axes([true; 3]),
        displacement_mm: DVec3::ZERO,
    };
    let (low, high) = surface.bounds().expect("a part");
    let load = Load { name: "load 1".into(), action };
    let conditions = BoundaryConditions {
        fixtures: vec![held],
        cases: vec![LoadCase { name: "one".into(), weight: 1.0, loads: vec![load.clone()] }],
        density_t_mm3: DENSITY_T_MM3,
        low,
        high,
    };
    let meshed = mesh(surface, &MeshSettings { size_mm: Some(size_mm), ..MeshSettings::default() });
    let meshed = meshed.expect("a part");
    let loaded = LoadedSolid::new(&meshed.mesh, surface, &conditions);
    let mut forces = vec![DVec3::ZERO; meshed.mesh.nodes.len()];
    loaded.add_load(&mut forces, &load).expect("caught");
    let model = Model::uniform(&meshed.mesh, isotropic(E_MPA, NU));
    let supports = loaded.supports().expect("caught");
    let (solutions, _) = solve(&model, &supports, &[forces], &SolveSettings::default()).expect("held");
    let reaction = loaded.reactions(&solutions[0].reaction).expect("caught").remove(0);
    let nodes = meshed.mesh.nodes.iter().copied();
    Solved {
        load: loaded.resultant(&load).expect("caught"),
        reaction,
        moved: nodes.zip(solutions[0].displacement.iter().copied()).collect(),
        volume_mm3: meshed.volume_mm3,
    }
}

/// Mean of a value over the nodes at a height.
fn mean(solved: &Solved, z: f64, value: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let at: Vec<f64> =
        solved.moved.iter().filter(|(p, _)| (p.z - z).abs() < 0.01).map(|(p, u)| value(*p, *u)).collect();
    assert!(at.len() > 8, "{} nodes at {z}", at.len());
    at.iter().sum::<f64>() / at.len() as f64
}

#[test]
fn a_torque_twists_a_rod_as_saint_venant_says() {
    let (radius, length, torque) = (4.0, 30.0, 500.0);
    let rod = tube(0.0, radius, length, 96);
    let action = Action::Torque { on: plane(length), point: DVec3::ZERO, axis: DVec3::Z, total_nmm: torque };
    let s = solved(&rod, action, 1.6);
    assert!((s.load.moment_nmm - DVec3::Z * torque).length() < 1e-6 * torque, "{:?}", s.load);
    assert!(s.load.force_n.length() < 1e-6 * torque / radius);
    assert!((s.reaction.moment_nmm.z + torque).abs() < 1e-3 * torque, "{:?}", s.reaction);
    // Twist between two sections away from the ends: T L / (G J). Nodes near the axis say little.
    let twist = |z: f64| {
        let near =
            s.moved.iter().filter(|(p, _)| (p.z - z).abs() < 0.8 && p.truncate().length() > 0.5 * radius);
        let (sum, n) = near.fold((0.0, 0.0), |(sum, n), (p, u)| {
            let r = p.truncate();
            // Each twist is brought to the middle section by its own height.
            (sum + r.perp_dot(u.truncate()) / r.length_squared() / p.z, n + 1.0)
        });
        sum / n
    };
    let shear = E_MPA / (2.0 * (1.0 + NU));
    // The polygon has a little less than the circle: its own moment of area is taken.
    let side = TAU / 96.0;
    let (sin, cos) = sin_cos(side);
    let polar = 96.0 * radius.powi(4) * sin * (2.0 + cos) / 12.0;
    let wanted = torque / (shear * polar);
    assert!((twist(20.0) / wanted - 1.0).abs() < 0.01, "{} for {wanted} rad/mm", twist(20.0));
}

#[test]
fn a_remote_force_bends_like_the_force_and_its_moment() {
    let (radius, length, arm, force) = (4.0, 60.0, 40.0, 5.0);
    let rod = tube(0.0, radius, length, 96);
    let at_mm = DVec3::new(0.0, 0.0, length + arm);
    let action = Action::RemoteForce { on: plane(length), total_n: DVec3::X * force, at_mm };
    let s = solved(&rod, action, 1.8);
    assert!((s.load.force_n - DVec3::X * force).length() < 1e-6 * force);
    assert!((s.load.moment_nmm.y - force * arm).abs() < 1e-6 * force * arm, "{:?}", s.load);
    let held = s.reaction.moment_about_nmm(DVec3::ZERO).y;
    assert!((held + force * (length + arm)).abs() < 1e-3 * force * length, "{held}");
    // Cantilever: F L^3 / 3 E I + M L^2 / 2 E I, and F L / (k G A) of shear (k = 0.9 for a circle).
    let inertia = PI * radius.powi(4) / 4.0;
    let shear = force * length / (0.9 * E_MPA / (2.0 * (1.0 + NU)) * PI * radius * radius);
    let bent = (force * length.powi(3) / 3.0 + force * arm * length.powi(2) / 2.0) / (E_MPA * inertia);
    let found = mean(&s, length, |_, u| u.x);
    assert!((found / (bent + shear) - 1.0).abs() < 0.01, "{found} for {}", bent + shear);
}

#[test]
fn a_turning_rod_pulls_at_its_root() {
    let (radius, length, rad_s) = (3.0, 50.0, 400.0);
    let rod = tube(0.0, radius, length, 64);
    let action = Action::Centrifugal { point: DVec3::ZERO, axis: DVec3::X, rad_s };
    let s = solved(&rod, action, 1.5);
    // rho omega^2 A L^2 / 2, with the area of the mesh.
    let area = s.volume_mm3 / length;
    let pull = DENSITY_T_MM3 * rad_s * rad_s * area * length * length / 2.0;
    assert!((s.load.force_n.z / pull - 1.0).abs() < 0.01, "{:?} for {pull}", s.load);
    assert!((s.reaction.force_n.z / pull + 1.0).abs() < 0.01, "{:?} for {pull}", s.reaction);
    // Its end moves by rho omega^2 L^3 / 3 E.
    let wanted = DENSITY_T_MM3 * rad_s * rad_s * length.powi(3) / (3.0 * E_MPA);
    let found = mean(&s, length, |_, u| u.z);
    assert!((found / wanted - 1.0).abs() < 0.01, "{found} for {wanted} mm");
}

#[test]
fn a_preload_clamps_a_sleeve_by_force_over_area() {
    let (inner, outer, length, force) = (5.0, 9.0, 40.0, 4000.0);
    let sleeve = tube(inner, outer, length, 96);
    // Held without strain: along z at one end, against turning and sliding at single points.
    let fixture = |name: &str, on: Selection, held: [bool; 3]| Fixture {
        name: name.into(),
        on,
        held: Held::Axes(held),
        displacement_mm: DVec3::ZERO,
    };
    let point = |x: f64| Selection::Points(Facets::new(vec![[DVec3::new(x, 0.0, 0.0); 3]]));
    let ends = [("load 1, on", length, 0.0), ("load 1, to", 0.0, length)];
    let loads = ends.map(|(name, on, towards)| Load {
        name: name.into(),
        action: Action::Clamp { on: plane(on), towards: plane(towards), total_n: force },
    });
    let (low, high) = sleeve.bounds().expect("a part");
    let conditions = BoundaryConditions {
        fixtures: vec![
            fixture("fixture 1", plane(0.0), [false, false, true]),
            fixture("fixture 2", point(outer), [false, true, false]),
            fixture("fixture 3", point(-outer), [true, true, false]),
        ],
        cases: vec![LoadCase { name: "one".into(), weight: 1.0, loads: loads.to_vec() }],
        density_t_mm3: DENSITY_T_MM3,
        low,
        high,
    };
    let meshed =
        mesh(&sleeve, &MeshSettings { size_mm: Some(1.8), ..MeshSettings::default() }).expect("a part");
    let loaded = LoadedSolid::new(&meshed.mesh, &sleeve, &conditions);
    let mut forces = vec![DVec3::ZERO; meshed.mesh.nodes.len()];
    loads.iter().for_each(|load| loaded.add_load(&mut forces, load).expect("caught"));
    let sum: DVec3 = forces.iter().sum();
    let moment: DVec3 = forces.iter().zip(&meshed.mesh.nodes).map(|(f, p)| p.cross(*f)).sum();
    assert!(sum.length() < 1e-9 * force && moment.length() < 1e-9 * force * length, "{sum} {moment}");
    for (load, along) in loads.iter().zip([-DVec3::Z, DVec3::Z]) {
        let found = loaded.resultant(load).expect("caught");
        assert!((found.force_n - along * force).length() < 0.01 * force, "{found:?}");
    }
    let model = Model::uniform(&meshed.mesh, isotropic(E_MPA, NU));
    let supports = loaded.supports().expect("caught");
    let (solutions, _) = solve(&model, &supports, &[forces], &SolveSettings::default()).expect("held");
    let reactions = loaded.reactions(&solutions[0].reaction).expect("caught");
    assert!(reactions.iter().all(|r| r.force_n.length() < 2e-3 * force), "{reactions:?}");
    // Stress F / A at mid-length and shortening F L / (E A), with the area of the polygon of the mesh.
    let area = meshed.volume_mm3 / length;
    let nodes = &meshed.mesh.nodes;
    let mean = |near: &dyn Fn(DVec3) -> bool, value: &dyn Fn(usize) -> f64| {
        let at: Vec<f64> = (0..nodes.len()).filter(|&i| near(nodes[i])).map(value).collect();
        assert!(at.len() > 30, "{} nodes", at.len());
        at.iter().sum::<f64>() / at.len() as f64
    };
    let moved = |z: f64| mean(&|p| (p.z - z).abs() < 0.01, &|i| solutions[0].displacement[i].z);
    let (shorter, wanted) = (moved(0.0) - moved(length), force * length / (E_MPA * area));
    assert!((shorter / wanted - 1.0).abs() < 0.01, "{shorter} for {wanted} mm");
    let recovered = recover(&model, &solutions[0].displacement, None).expect("a stress");
    let stress = mean(&|p| (p.z - 0.5 * length).abs() < 5.0, &|i| recovered.stress_mpa[i][2]);
    assert!((stress / (-force / area) - 1.0).abs() < 0.01, "{stress} for {} MPa", -force / area);
}

#[test]
fn a_bearing_load_presses_one_half_of_a_hole_by_the_cosine() {
    let (inner, outer, length, force) = (5.0, 10.0, 12.0, 80.0);
    let eye = tube(inner, outer, length, 96);
    let wall =
        Selection::Cylinder { point: DVec3::ZERO, axis: DVec3::Z, radius_mm: inner + 0.05, length_mm: None };
    let along = DVec3::new(0.6, 0.8, 0.0);
    let s = solved(&eye, Action::Bearing { on: wall.clone(), total_n: along * force }, 1.4);
    assert!((s.load.force_n - along * force).length() < 1e-6 * force, "{:?}", s.load);
    assert!((s.reaction.force_n + along * force).length() < 1e-3 * force, "{:?}", s.reaction);
    assert!((s.load.area_mm2 / (TAU * inner * length) - 1.0).abs() < 0.02, "{:?}", s.load);
    // The part of the force on an arc, in closed form: the pressure 2 F / (pi r L) times the cosine
    // pushes with F (2 a + sin 2 a) / pi along the force within an angle a on either side.
    let surface = &eye;
    let conditions = BoundaryConditions {
        fixtures: Vec::new(),
        cases: Vec::new(),
        density_t_mm3: 0.0,
        low: DVec3::ZERO,
        high: DVec3::ONE,
    };
    let meshed =
        mesh(surface, &MeshSettings { size_mm: Some(1.4), ..MeshSettings::default() }).expect("an eye");
    let loaded = LoadedSolid::new(&meshed.mesh, surface, &conditions);
    let mut forces = vec![DVec3::ZERO; meshed.mesh.nodes.len()];
    let load = Load { name: "load 1".into(), action: Action::Bearing { on: wall, total_n: along * force } };
    loaded.add_load(&mut forces, &load).expect("caught");
    let within = |angle: f64| -> f64 {
        let near = forces
            .iter()
            .zip(&meshed.mesh.nodes)
            .filter(|(_, p)| p.truncate().normalize().dot(along.truncate()) > sin_cos(angle).1);
        near.map(|(f, _)| f.dot(along)).sum()
    };
    let share = |a: f64| (2.0 * a + sin_cos(2.0 * a).0) / PI;
    // The nodes at the end of an arc carry a part of what lies beyond it: half the width of a face.
    for angle in [0.6, 0.9, 1.2] {
        let (low, high) = (share(angle - 0.08), share(angle + 0.08));
        let found = within(angle) / force;
        assert!(found > low && found < high, "{found} within {angle}, between {low} and {high}");
    }
    assert!((within(PI / 2.0 + 0.15) / force - 1.0).abs() < 0.01);
    // Nothing pulls at the other half.
    let back = forces.iter().zip(&meshed.mesh.nodes).filter(|(_, p)| p.dot(along) < -1.0);
    assert!(back.map(|(f, _)| f.length()).sum::<f64>() < 0.01 * force);
}

/// The resultant of a load on a part, and the area that it catches with that of its place where they differ by a tenth.
fn caught(
    surface: &TriMesh,
    action: Action,
    size_mm: f64,
) -> Result<(Resultant, Option<(f64, f64)>), SolidError> {
    let (low, high) = surface.bounds().expect("a part");
    let conditions = BoundaryConditions {
        fixtures: Vec::new(),
        cases: Vec::new(),
        density_t_mm3: DENSITY_T_MM3,
        low,
        high,
    };
    let meshed = mesh(surface, &MeshSettings { size_mm: Some(size_mm), ..MeshSettings::default() })?;
    let loaded = LoadedSolid::new(&meshed.mesh, surface, &conditions);
    let load = Load { name: "load 1".into(), action };
    Ok((loaded.resultant(&load)?, loaded.badly_caught(&load, 0.1)?))
}

#[test]
fn a_bearing_load_needs_a_wall_that_faces_it() {
    let eye = tube(5.0, 10.0, 12.0, 96);
    let hole = Selection::Cylinder { point: DVec3::ZERO, axis: DVec3::Z, radius_mm: 5.05, length_mm: None };
    // A force that leans by 27 degrees out of the plane across the hole is carried, its part along the hole as shear.
    let leaning = DVec3::new(30.0, 40.0, 25.0);
    let (found, _) =
        caught(&eye, Action::Bearing { on: hole.clone(), total_n: leaning }, 1.6).expect("a wall");
    assert!((found.force_n - leaning).length() < 1e-6 * leaning.length(), "{found:?}");
    // Along the hole and nearly so, along a flat side, and away from it.
    let flat = plane(12.0);
    // A wider place holds rings around the ends of the hole too.
    let wide = Selection::Cylinder { point: DVec3::ZERO, axis: DVec3::Z, radius_mm: 5.25, length_mm: None };
    for (on, total_n) in [
        (wide, DVec3::Z * 25.0),
        (hole.clone(), DVec3::Z * 25.0),
        (hole, DVec3::new(1.0, 0.0, 25.0)),
        (flat.clone(), DVec3::X * 10.0),
        (flat.clone(), DVec3::new(10.0, 0.0, -1e-3)),
        (flat, DVec3::Z * 10.0),
    ] {
        for size_mm in [1.6, 2.5] {
            let told = caught(&eye, Action::Bearing { on: on.clone(), total_n }, size_mm);
            assert!(matches!(told, Err(SolidError::NoBearing { .. })), "{total_n}: {told:?}");
        }
    }
}

#[test]
fn loads_on_the_volume_and_at_points_lie_where_they_act() {
    let ring = tube(6.0, 9.0, 10.0, 64);
    // A turning ring has no resultant to speak of; its load lies at its centre.
    let action = Action::Centrifugal { point: DVec3::ZERO, axis: DVec3::Z, rad_s: 600.0 };
    let (found, _) = caught(&ring, action, 1.6).expect("a load");
    assert!(found.centroid_mm.distance(DVec3::Z * 5.0) < 0.2, "{found:?}");
    let action = Action::Acceleration { mm_s2: DVec3::new(0.0, 3e3, -9810.0) };
    let (found, _) = caught(&ring, action, 1.6).expect("a load");
    assert!(found.centroid_mm.distance(DVec3::Z * 5.0) < 0.05, "{found:?}");
    assert!(found.moment_nmm.length() < 1e-6 * found.force_n.length(), "{found:?}");
    let at = DVec3::new(0.0, 9.0, 10.0);
    let on = Selection::Points(Facets::new(vec![[at; 3]]));
    let action = Action::Points { on, forces: vec![(at, DVec3::X * 3.0)].into() };
    let (found, _) = caught(&ring, action, 1.6).expect("a load");
    assert_eq!(found.centroid_mm, at);
    assert!(found.moment_nmm.length() < 1e-9, "{found:?}");
}

#[test]
fn places_smaller_than_the_elements_are_told() {
    let rod = tube(0.0, 8.0, 20.0, 64);
    let top = DVec3::new(3.1, 1.3, 20.0);
    let sphere = |centre, radius_mm| Selection::Sphere { centre, radius_mm };
    let pressure = |on| Action::Pressure { on, mpa: 1.0 };
    let told = caught(&rod, pressure(sphere(top, 0.02)), 4.0);
    assert!(matches!(told, Err(SolidError::PlaceTooSmall { .. })), "{told:?}");
    let told = caught(&rod, pressure(sphere(top + DVec3::Z * 9.0, 0.02)), 4.0);
    assert!(matches!(told, Err(SolidError::CatchesNothing(_))), "{told:?}");
    // Whole sides of elements in small boxes on top, and all of the top.
    let halves = (4..16).map(|k| 0.15 * f64::from(k));
    let small = halves.map(|half| {
        let on = Selection::Box { low: top - half, high: top + half };
        let (found, differs) = caught(&rod, pressure(on), 2.0).ok()?;
        let (area, place) = differs?;
        assert!((place - 4.0 * half * half).abs() < 0.02 && area == found.area_mm2, "{area} for {place}");
        assert!((area / place - 1.0).abs() > 0.1);
        Some(area)
    });
    let small: Vec<_> = small.collect();
    println!("areas of small places: {small:?}");
    assert!(small.iter().any(Option::is_some), "{small:?}");
    let (found, differs) = caught(&rod, pressure(plane(20.0)), 1.6).expect("sides");
    assert_eq!(differs, None, "{found:?}");
}
