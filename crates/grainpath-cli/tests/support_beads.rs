//! The printed beads of supports, judged from outside: every one lies on a bead below, on classes of parts.

use std::collections::HashMap;

use grainpath::{Inputs, plan_job};
use grainpath_core::hash::unit_interval;
use grainpath_core::math::{cos, direction, sin};
use grainpath_core::{DVec2, DVec3, Diagnostics, LayerPlan, Role, TriMesh};
use grainpath_job::parse_job;

/// Points of beads in plan, found by cell.
struct Points {
    cells: HashMap<[i64; 2], Vec<DVec2>>,
}

const CELL_MM: f64 = 1.0;

impl Points {
    fn new<'a>(layers: impl Iterator<Item = &'a LayerPlan>, wanted: impl Fn(Role) -> bool) -> Self {
        let mut cells: HashMap<[i64; 2], Vec<DVec2>> = HashMap::new();
        for path in layers.flat_map(|l| &l.paths).map(|p| &p.path).filter(|p| wanted(p.role)) {
            for i in 0..path.n_segments() {
                let (a, b, _) = path.segment(i);
                let n = (a.distance(b) / 0.05).ceil().max(1.0) as usize;
                for j in 0..=n {
                    let p = a.lerp(b, j as f64 / n as f64);
                    cells.entry(Self::cell(p)).or_default().push(p);
                }
            }
        }
        Self { cells }
    }

    fn cell(p: DVec2) -> [i64; 2] {
        [(p.x / CELL_MM).floor() as i64, (p.y / CELL_MM).floor() as i64]
    }

    fn near(&self, p: DVec2, reach_mm: f64) -> bool {
        assert!(reach_mm <= CELL_MM);
        let [x, y] = Self::cell(p);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        let near =
            |c: [i64; 2]| self.cells.get(&c).is_some_and(|v| v.iter().any(|q| q.distance(p) <= reach_mm));
        around.into_iter().any(near)
    }
}

fn is_support(role: Role) -> bool {
    matches!(role, Role::Support | Role::SupportInterface)
}

/// Millimetres of support beads further than 0.95 of their width from every support bead of the layer below and from
/// every bead of the part within 0.65 mm below; and those of all support beads.
fn on_air_mm(layers: &[LayerPlan]) -> (f64, f64) {
    let (mut air_mm, mut all_mm) = (0.0, 0.0);
    for k in 1..layers.len() {
        let support = Points::new(layers[k - 1..k].iter(), is_support);
        let near = |l: &&LayerPlan| l.z_top_mm > layers[k].z_top_mm - 0.65;
        let part = Points::new(layers[..k].iter().filter(near), Role::is_part);
        for path in layers[k].paths.iter().map(|p| &p.path).filter(|p| is_support(p.role)) {
            for i in 0..path.n_segments() {
                let (a, b, w) = path.segment(i);
                let n = (a.distance(b) / 0.1).ceil().max(1.0) as usize;
                let step_mm = a.distance(b) / n as f64;
                for j in 0..n {
                    let p = a.lerp(b, (j as f64 + 0.5) / n as f64);
                    all_mm += step_mm;
                    if !support.near(p, 0.95 * w) && !part.near(p, 0.95 * w) {
                        air_mm += step_mm;
                    }
                }
            }
        }
    }
    (air_mm, all_mm)
}

/// The longest stretch of a bead of the part that lies further than 0.75 of its width from every bead within 0.65 mm
/// below, mm.
fn longest_free_mm(layers: &[LayerPlan]) -> f64 {
    let mut longest_mm: f64 = 0.0;
    for k in 1..layers.len() {
        let near = |l: &&LayerPlan| l.z_top_mm > layers[k].z_top_mm - 0.65;
        let below = Points::new(layers[..k].iter().filter(near), |role| is_support(role) || role.is_part());
        for path in layers[k].paths.iter().map(|p| &p.path).filter(|p| p.role.is_part()) {
            let mut run_mm = 0.0;
            for i in 0..path.n_segments() {
                let (a, b, w) = path.segment(i);
                let n = (a.distance(b) / 0.1).ceil().max(1.0) as usize;
                for j in 0..n {
                    let held = below.near(a.lerp(b, (j as f64 + 0.5) / n as f64), 0.75 * w);
                    run_mm = if held { 0.0 } else { run_mm + a.distance(b) / n as f64 };
                    longest_mm = longest_mm.max(run_mm);
                }
            }
        }
    }
    longest_mm
}

struct Outcome {
    free_mm: f64,
    air_mm: f64,
    support_mm: f64,
    floating: usize,
    left_out_mm: f64,
    contacts: usize,
    unreached: usize,
}

fn printed(mesh: &TriMesh, sets: &[&str]) -> Outcome {
    let always = ["support.style=tree", "fill.density=0.15", "printer.bed_mm=[300, 300, 300]"];
    let sets: Vec<String> = always.iter().chain(sets).map(|s| (*s).to_owned()).collect();
    let settings = parse_job("", "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job");
    let mut bytes = Vec::new();
    grainpath_io::write_stl(mesh, &mut bytes).expect("memory takes all");
    let inputs = Inputs {
        mesh: grainpath_io::parse_mesh(&bytes, Some("part.stl")).expect("a sound mesh"),
        path: "part.stl".into(),
        stress: None,
        deck: None,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: Default::default(),
        known: None,
    };
    let planned = plan_job(&settings, inputs, &Diagnostics::default()).expect("a plan");
    let (air_mm, support_mm) = on_air_mm(&planned.plan.layers);
    let support = planned.support.expect("trees");
    Outcome {
        free_mm: longest_free_mm(&planned.plan.layers),
        air_mm,
        support_mm,
        floating: support.cut.floating,
        left_out_mm: support.cut.left_out_mm,
        contacts: support.n_contacts(),
        unreached: support.unreached.len(),
    }
}

fn stands(what: &str, mesh: &TriMesh, sets: &[&str]) {
    let o = printed(mesh, sets);
    assert!(o.support_mm > 50.0 && o.contacts > 0, "{what}: {} mm of support", o.support_mm);
    assert_eq!((o.floating, o.unreached), (0, 0), "{what}");
    assert!(o.air_mm < 0.05, "{what}: {} of {} mm on air", o.air_mm, o.support_mm);
    assert!(o.left_out_mm < 0.01 * o.support_mm, "{what}: {} mm left out", o.left_out_mm);
}

fn boxes(all: &[[[f64; 3]; 2]]) -> TriMesh {
    let mut mesh = TriMesh::default();
    for [low, high] in all {
        let first = mesh.vertices.len() as u32;
        let pick = |i: usize, k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        mesh.vertices.extend((0..8).map(|i| DVec3::new(pick(i, 0), pick(i, 1), pick(i, 2))));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in quads.map(|q: [u32; 4]| q.map(|i| i + first)) {
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// The mesh turned about its middle, its lowest point on the plate.
fn turned(mesh: &TriMesh, x_deg: f64, y_deg: f64) -> TriMesh {
    let (a, b) = (x_deg.to_radians(), y_deg.to_radians());
    let turn = |p: DVec3| {
        let p = DVec3::new(p.x, p.y * cos(a) - p.z * sin(a), p.y * sin(a) + p.z * cos(a));
        DVec3::new(p.x * cos(b) + p.z * sin(b), p.y, -p.x * sin(b) + p.z * cos(b))
    };
    let mut out = mesh.clone();
    out.vertices.iter_mut().for_each(|p| *p = turn(*p));
    let low = out.vertices.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    out.vertices.iter_mut().for_each(|p| p.z -= low);
    out
}

fn table() -> TriMesh {
    boxes(&[[[-3.0, -3.0, 0.0], [3.0, 3.0, 14.0]], [[-16.0, -12.0, 14.0], [16.0, 12.0, 17.0]]])
}

/// Coarser than printed, so that a test takes seconds; the lean of a layer grows with its height.
const QUICK: &[&str] = &["process.layer_height_mm=0.3", "process.walls=1"];

#[test]
fn feet_and_tips_of_a_table_turned_any_way_lie_on_beads() {
    for (x, y) in [(0.0, 0.0), (120.0, 10.0), (90.0, 20.0), (35.0, 15.0)] {
        stands(&format!("a table turned by {x} and {y} degrees"), &turned(&table(), x, y), QUICK);
    }
}

#[test]
fn thick_trunks_wide_feet_and_pads_lie_on_beads() {
    let tall = boxes(&[[[-3.0, -3.0, 0.0], [3.0, 3.0, 40.0]], [[-25.0, -12.0, 40.0], [25.0, 12.0, 42.0]]]);
    for sets in [
        &["support.base_radius_mm=7", "support.base_height_mm=1"][..],
        &["support.base_radius_mm=3", "support.base_height_mm=0.4", "support.dense_layers=1"],
        &["support.branch_radius_mm=2", "support.load_per_contact_n=20"],
        &["support.interface_layers=3", "support.interface_radius_mm=2"],
        &["support.critical_angle_deg=60"],
        &["process.bead_width_mm=0.6", "support.walls=2"],
    ] {
        stands(&sets.join(" "), &tall, &[QUICK, sets].concat());
    }
}

#[test]
fn beads_below_random_parts_lie_on_beads() {
    for seed in 0..6u64 {
        let mut state = seed << 32;
        let mut number = |low: f64, high: f64| {
            state += 1;
            low + (high - low) * unit_interval(state)
        };
        // A stem, and prisms about it that begin at any height, with any number of sides, leaning outwards.
        let mut mesh = boxes(&[[[-4.0, -4.0, 0.0], [4.0, 4.0, 24.0]]]);
        for _ in 0..5 {
            let (low, high) = (number(4.0, 12.0), number(14.0, 24.0));
            let n = number(3.0, 9.0) as u32;
            let (middle, radius) = (direction(number(0.0, 6.2)) * number(2.0, 8.0), number(3.0, 7.0));
            let lean = direction(number(0.0, 6.2)) * number(0.0, 6.0);
            let first = mesh.vertices.len() as u32;
            for (z, shift, r) in [(low, DVec2::ZERO, radius), (high, lean, radius * number(0.5, 1.6))] {
                for i in 0..n {
                    let p =
                        middle + shift + r * direction(f64::from(i) / f64::from(n) * std::f64::consts::TAU);
                    mesh.vertices.push(p.extend(z));
                }
            }
            for i in 0..n {
                let (a, b) = (first + i, first + (i + 1) % n);
                mesh.triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
                if i > 1 {
                    mesh.triangles.extend([[first, first + i, first + i - 1]]);
                    mesh.triangles.extend([[first + n, first + n + i - 1, first + n + i]]);
                }
            }
        }
        let o = printed(&mesh, QUICK);
        assert!(o.support_mm > 50.0, "seed {seed}: {} mm", o.support_mm);
        assert_eq!(o.floating, 0, "seed {seed}");
        assert!(o.air_mm < 0.05, "seed {seed}: {} of {} mm on air", o.air_mm, o.support_mm);
    }
}

#[test]
fn no_bead_of_a_flat_overhang_runs_further_than_asked_over_air() {
    let table = table();
    let turned = |deg: f64| {
        let (c, s) = (cos(deg.to_radians()), sin(deg.to_radians()));
        let mut mesh = table.clone();
        mesh.vertices.iter_mut().for_each(|p| *p = DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z));
        mesh
    };
    for deg in [0.0, 15.0, 45.0] {
        let o = printed(&turned(deg), QUICK);
        assert!(o.free_mm > 3.0 && o.free_mm <= 10.0, "{deg} degrees: {} mm", o.free_mm);
        assert!(o.air_mm < 0.05 && o.floating == 0, "{deg} degrees: {} mm of support on air", o.air_mm);
    }
    let o = printed(&table, &[QUICK, &["support.max_unsupported_mm=6"]].concat());
    assert!(o.free_mm <= 6.0, "{} mm", o.free_mm);
    // Contacts alone leave the skin between two rows of them on air.
    let o = printed(&table, &[QUICK, &["support.interface_lines=false"]].concat());
    assert!(o.free_mm > 20.0, "{} mm", o.free_mm);
}

#[test]
fn no_wall_beside_a_post_runs_further_than_asked_over_air() {
    let post = |x: f64, y: f64, half: f64, top: f64| [[x - half, y - half, 0.0], [x + half, y + half, top]];
    // A plate whose legs stand close to its rim, and a ring on three posts: both cut rows of interface lines short.
    let legs = [(-17.0, -12.0), (17.0, -12.0), (0.0, 12.0)].map(|(x, y)| post(x, y, 2.0, 16.0));
    let plate = [[-20.0, -15.0, 15.0], [20.0, 15.0, 18.0]];
    let mut parts = vec![("plate".to_owned(), boxes(&[plate, legs[0], legs[1], legs[2]]))];
    for deg in [60.0f64, 100.0] {
        let posts = [0.0, 120.0, 240.0].map(|k: f64| {
            let at = 14.0 * direction((deg + k).to_radians());
            post(at.x, at.y, 1.5, 17.0)
        });
        let mut mesh = boxes(&posts);
        let (first, n) = (mesh.vertices.len() as u32, 48);
        for (radius, z) in [(16.0, 14.0), (16.0, 18.0), (12.0, 18.0), (12.0, 14.0)] {
            let at =
                |i: u32| (direction(f64::from(i) / f64::from(n) * std::f64::consts::TAU) * radius).extend(z);
            mesh.vertices.extend((0..n).map(at));
        }
        for (ring, i) in (0..4).flat_map(|ring| (0..n).map(move |i| (ring, i))) {
            let at = |ring: u32, i: u32| first + ring % 4 * n + i % n;
            let [a, b, c, d] = [at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        parts.push((format!("ring on posts at {deg} degrees"), mesh));
    }
    for (what, mesh) in parts {
        let o = printed(&mesh, QUICK);
        assert!(o.free_mm > 3.0 && o.free_mm <= 10.0, "{what}: {} mm", o.free_mm);
        assert!(o.air_mm < 0.05 && o.floating == 0, "{what}: {} mm of support on air", o.air_mm);
    }
}

#[test]
fn the_judge_sees_beads_on_air() {
    // A ring over a wider ring, a bead and a half apart: what the feet of cones once were.
    let ring = |r: f64, z: f64| {
        let points = (0..60).map(|i| direction(f64::from(i) / 60.0 * std::f64::consts::TAU) * r).collect();
        let path = grainpath_core::Toolpath::new(points, 0.45, Role::Support, true);
        let travel = grainpath_core::Travel::default();
        LayerPlan { z_top_mm: z, height_mm: 0.2, paths: vec![grainpath_core::PlannedPath { path, travel }] }
    };
    let (air, all) = on_air_mm(&[ring(3.0, 0.2), ring(2.3, 0.4)]);
    assert!((air - all).abs() < 1e-9 && (all - 14.4).abs() < 0.1, "{air} of {all}");
    assert_eq!(on_air_mm(&[ring(3.0, 0.2), ring(2.6, 0.4)]).0, 0.0);
}
