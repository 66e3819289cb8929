//! Resultants of loads on a mesh, and reactions against them, for a bar in any position, mirrored and
//! scaled.

mod support;

use grainpath_core::math::sin_cos;
use grainpath_core::selection::{Facets, Selection};
use grainpath_core::{DMat3, DVec2, DVec3, Region, TriMesh};
use grainpath_fea::load_case::{Action, BoundaryConditions, Fixture, Held, Load, LoadCase};
use grainpath_fea::material::Orthotropic;
use grainpath_fea::plane::{PlaneProblem, PlaneSystem, Plate, mesh_region};
use grainpath_fea::resultant::CaseBalance;
use grainpath_fea::solid::{LoadedSolid, MeshSettings, Model, SolveSettings, mesh, solve};
use support::isotropic;

const SIZE: DVec3 = DVec3::new(24.0, 10.0, 6.0);
const DENSITY_T_MM3: f64 = 1.24e-9;

fn block() -> TriMesh {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * SIZE;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    TriMesh { vertices: (0..8).map(corner).collect(), triangles }
}

/// Maps of space, and whether each reverses the orientation of the surface.
fn maps() -> Vec<(&'static str, DMat3, bool)> {
    let (s, c) = sin_cos(37f64.to_radians());
    let about_z = DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c));
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    vec![
        ("as it is", DMat3::IDENTITY, false),
        ("turned by 37 degrees", about_z, false),
        ("turned about two axes", about_x * about_z, false),
        ("mirrored", mirror, true),
        ("turned, mirrored, ten times as large", about_z * mirror * 10.0, true),
        ("a tenth as large", DMat3::IDENTITY * 0.1, false),
    ]
}

fn facets(surface: &TriMesh, ids: [usize; 2]) -> Selection {
    let corners = |t: usize| surface.triangles[t].map(|v| surface.vertices[v as usize]);
    Selection::Triangles(Facets::new(ids.map(corners).to_vec()))
}

#[test]
fn loads_and_reactions_of_solids_cancel() {
    for (name, map, inside_out) in maps() {
        let mut surface = block();
        surface.vertices.iter_mut().for_each(|p| *p = map * *p);
        if inside_out {
            surface.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let scale = map.x_axis.length();
        let (root, end, top) =
            (facets(&surface, [8, 9]), facets(&surface, [10, 11]), facets(&surface, [2, 3]));
        let force = DVec3::new(3.0, -40.0, 25.0);
        let moment = DVec3::new(100.0, 50.0, -70.0);
        let gravity = DVec3::new(0.0, 0.0, -9810.0);
        let load = |k: usize, action| Load { name: format!("load {k}"), action };
        let loads = vec![
            load(1, Action::Force { on: end.clone(), total_n: force }),
            load(2, Action::Moment { on: end, total_nmm: moment }),
            load(3, Action::Pressure { on: top, mpa: 0.5 }),
            load(4, Action::Acceleration { mm_s2: gravity }),
        ];
        // The resultant force of each of these alone is zero.
        let whole = Selection::Box { low: DVec3::splat(-1e3), high: DVec3::splat(1e3) };
        let alone = [
            load(1, Action::Moment { on: facets(&surface, [10, 11]), total_nmm: moment }),
            load(1, Action::Pressure { on: whole, mpa: 0.5 }),
        ];
        let case = |loads| LoadCase { name: "case".into(), weight: 1.0, loads };
        let cases = [loads].into_iter().chain(alone.map(|load| vec![load])).map(case).collect();
        let fixture = Fixture {
            name: "fixture 1".into(),
            on: root,
            held: Held::Axes([true; 3]),
            displacement_mm: DVec3::ZERO,
        };
        let (low, high) = surface.bounds().expect("eight corners");
        let conditions =
            BoundaryConditions { fixtures: vec![fixture], cases, density_t_mm3: DENSITY_T_MM3, low, high };
        let settings = MeshSettings { size_mm: Some(3.0 * scale), ..MeshSettings::default() };
        let meshed = mesh(&surface, &settings).expect("a block");
        let loaded = LoadedSolid::new(&meshed.mesh, &surface, &conditions);
        let of_case = |case: &LoadCase| {
            let mut forces = vec![DVec3::ZERO; meshed.mesh.nodes.len()];
            case.loads.iter().for_each(|l| loaded.add_load(&mut forces, l).expect("caught"));
            forces
        };
        let forces: Vec<_> = conditions.cases.iter().map(of_case).collect();
        let model = Model::uniform(&meshed.mesh, isotropic(2000.0, 0.3));
        let supports = loaded.supports().expect("caught");
        let (solutions, _) = solve(&model, &supports, &forces, &SolveSettings::default()).expect("held");
        let resultant = |l| loaded.resultant(l).expect("caught");
        let balances = conditions.cases.iter().zip(&solutions).map(|(case, solution)| CaseBalance {
            case: case.name.clone(),
            loads: case.loads.iter().map(resultant).collect(),
            reactions: loaded.reactions(&solution.reaction).expect("caught"),
        });
        let balances: Vec<_> = balances.collect();
        let loads = &balances[0].loads;
        println!("{name}: {:.3} mm2 for {:.3}", loads[0].area_mm2, 60.0 * scale * scale);
        assert!((loads[0].force_n - force).length() < 1e-6 * force.length());
        assert!((loads[1].moment_nmm - moment).length() < 1e-6 * moment.length());
        assert!(loads[1].force_n.length() < 1e-6 * moment.length() / scale);
        let weight = meshed.volume_mm3 * DENSITY_T_MM3 * gravity;
        assert!((loads[3].force_n - weight).length() < 1e-6 * weight.length());
        assert!((loads[0].area_mm2 / (60.0 * scale * scale) - 1.0).abs() < 0.06, "{name}");
        for (k, balance) in balances.iter().enumerate() {
            println!("{name}, case {k}: loads and reactions cancel to {:.1e}", balance.imbalance());
            assert!(balance.imbalance() < 1e-6, "{name}, case {k}: {}", balance.imbalance());
        }
        // Reactions of another load do not cancel.
        let mixed = CaseBalance { reactions: balances[0].reactions.clone(), ..balances[1].clone() };
        assert!(mixed.imbalance() > 0.01, "{name}: {}", mixed.imbalance());
        let half = CaseBalance { reactions: Vec::new(), ..balances[1].clone() };
        assert!(half.imbalance() > 0.1, "{name}: {}", half.imbalance());
    }
}

#[test]
fn loads_and_reactions_of_plates_cancel() {
    for angle in [0.0, 37f64.to_radians()] {
        let (s, c) = sin_cos(angle);
        let turned = |p: DVec2| DVec2::new(c * p.x - s * p.y, s * p.x + c * p.y);
        let corners =
            [(0.0, 0.0), (24.0, 0.0), (24.0, 10.0), (0.0, 10.0)].map(|(x, y)| turned(DVec2::new(x, y)));
        let region: Region = grainpath_core::Polygon { outer: corners.to_vec(), holes: Vec::new() }.into();
        let plane = mesh_region(&region, 2.0, 0.1).expect("a rectangle");
        let axis = turned(DVec2::X).extend(0.0);
        let side = |x: f64| Selection::Plane {
            point: turned(DVec2::new(x, 0.0)).extend(0.0),
            normal: axis,
            tolerance_mm: 1e-6,
        };
        let force = DVec3::new(30.0, -8.0, 0.0);
        let load = |k: usize, action| Load { name: format!("load {k}"), action };
        let loads = vec![
            load(1, Action::Force { on: side(24.0), total_n: force }),
            load(2, Action::Moment { on: side(24.0), total_nmm: DVec3::Z * 55.0 }),
            load(3, Action::Acceleration { mm_s2: DVec3::new(0.0, -9810.0, 0.0) }),
        ];
        let conditions = BoundaryConditions {
            fixtures: vec![Fixture {
                name: "fixture 1".into(),
                on: side(0.0),
                held: Held::Axes([true; 3]),
                displacement_mm: DVec3::ZERO,
            }],
            cases: vec![LoadCase { name: "all".into(), weight: 1.0, loads }],
            density_t_mm3: DENSITY_T_MM3,
            low: DVec3::ZERO,
            high: DVec3::new(0.0, 0.0, 4.0),
        };
        let plate = Plate::new(&plane, &conditions);
        let stiffness = Orthotropic::isotropic(2000.0, 0.3).plane_stress(0.0).expect("stable");
        let problem = PlaneProblem {
            mesh: &plane,
            thickness_mm: plate.thickness_mm(),
            stiffness: &|_| stiffness,
            holds: &plate.holds().expect("caught"),
            max_mib: 1024.0,
        };
        let system = PlaneSystem::new(&problem).expect("held");
        let case = &conditions.cases[0];
        let mut forces = vec![DVec2::ZERO; plane.nodes.len()];
        for load in &case.loads {
            let more = plate.forces_n(load).expect("caught");
            forces.iter_mut().zip(more).for_each(|(sum, f)| *sum += f);
        }
        let solution = system.solve(&forces);
        let loads: Vec<_> = case.loads.iter().map(|l| plate.resultant(l).expect("caught")).collect();
        assert!((loads[0].area_mm2 - 40.0).abs() < 1e-6, "{}", loads[0].area_mm2);
        assert!((loads[0].force_n - force).length() < 1e-6 * force.length());
        assert!((loads[1].moment_nmm.z - 55.0).abs() < 1e-6 * 55.0);
        let reactions = plate.reactions(&system.reactions_n(&solution, &forces));
        let balance = CaseBalance { case: case.name.clone(), loads, reactions };
        println!("plate: loads and reactions cancel to {:.1e}", balance.imbalance());
        assert!(balance.imbalance() < 1e-6, "{}", balance.imbalance());
    }
}
