//! Three-dimensional elasticity compared with closed forms and published benchmarks;
//! `docs/verification.md` has the numbers.

mod support;

#[path = "../../../tests/data.rs"]
mod data;

use std::collections::BTreeMap;

use grainpath_core::{DVec3, math};
use grainpath_fea::material::{Orthotropic, Stiffness};
use grainpath_fea::solid::{
    Method, Model, Recovered, SolidError, Solution, SolveSettings, Supports, TetMesh, nodal_forces, recover,
    solve,
};
use support::{Brick, isotropic, rotated};

// Errors of the discretisation are to be seen, so the solver's own must be far below them.
fn tight() -> SolveSettings {
    SolveSettings { tolerance: 1e-12, ..SolveSettings::default() }
}

fn solved(model: &Model<'_>, supports: &Supports, load: Vec<DVec3>) -> Solution {
    let (mut all, info) = solve(model, supports, &[load], &tight()).expect("held and positive");
    println!("{} unknowns, {} iterations, residual {:.1e}", info.n_free, all[0].iterations, all[0].residual);
    all.remove(0)
}

fn nearest(mesh: &TetMesh, p: DVec3) -> usize {
    let nodes = mesh.nodes.iter().enumerate();
    nodes.min_by(|a, b| a.1.distance(p).total_cmp(&b.1.distance(p))).expect("nodes").0
}

/// MacNeal and Harder's cube with inner nodes, whose hexahedra are divided into tetrahedra.
fn patch_mesh() -> TetMesh {
    let inner = [
        [0.249, 0.342, 0.192],
        [0.826, 0.288, 0.288],
        [0.850, 0.649, 0.263],
        [0.273, 0.750, 0.230],
        [0.320, 0.186, 0.643],
        [0.677, 0.305, 0.683],
        [0.788, 0.693, 0.644],
        [0.165, 0.745, 0.702],
    ];
    let outer = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    let vertices: Vec<DVec3> = inner.iter().chain(&outer).map(|&p| DVec3::from_array(p)).collect();
    let faces = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let mut hexes = vec![[0, 1, 2, 3, 4, 5, 6, 7]];
    hexes.extend(faces.map(|f| [f[0], f[1], f[2], f[3], f[0] + 8, f[1] + 8, f[2] + 8, f[3] + 8]));
    // Each hexahedron is divided from its lowest corner: the faces without that corner, each divided from
    // its own lowest corner. Neighbours then divide their common face alike.
    let mut tets = Vec::new();
    for hex in hexes {
        let lowest = *hex.iter().min().expect("eight");
        for f in faces {
            let quad = f.map(|i| hex[i]);
            if quad.contains(&lowest) {
                continue;
            }
            let k = (0..4).min_by_key(|&i| quad[i]).expect("four");
            let q = [0, 1, 2, 3].map(|i| quad[(i + k) % 4]);
            for t in [[q[0], q[1], q[2], lowest], [q[0], q[2], q[3], lowest]] {
                tets.push(t.map(|i| i as u32));
            }
        }
    }
    TetMesh::straight(&vertices, &tets)
}

#[test]
fn patch_test() {
    let mesh = patch_mesh();
    assert!((mesh.volume_mm3() - 1.0).abs() < 1e-12);
    let field =
        |p: DVec3| 0.5e-3 * DVec3::new(2.0 * p.x + p.y + p.z, p.x + 2.0 * p.y + p.z, p.x + p.y + 2.0 * p.z);
    let strain = [1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3];
    let card =
        Orthotropic { e_mpa: [3120.0, 2770.0, 2500.0], nu: [0.33, 0.3, 0.35], g_mpa: [1050.0, 900.0, 800.0] };
    let turned = rotated(&card.stiffness().expect("stable"), DVec3::new(0.3, -0.7, 1.1));
    for (name, stiffness) in [("isotropic", isotropic(1e6, 0.25)), ("orthotropic", turned)] {
        let model = Model::uniform(&mesh, stiffness);
        let mut supports = Supports::new(mesh.nodes.len());
        let all: Vec<usize> = (0..mesh.faces.len()).collect();
        for n in mesh.nodes_of(&all) {
            let u = field(mesh.nodes[n as usize]);
            for axis in 0..3 {
                supports.prescribe(&mesh, n, DVec3::AXES[axis], u[axis]).expect("one value");
            }
        }
        let solution = solved(&model, &supports, vec![DVec3::ZERO; mesh.nodes.len()]);
        let off = mesh.nodes.iter().zip(&solution.displacement).map(|(p, u)| u.distance(field(*p)));
        let off = off.fold(0.0, f64::max) / 2e-3;
        let want: Vec<f64> =
            stiffness.iter().map(|row| row.iter().zip(strain).map(|(c, e)| c * e).sum()).collect();
        let found = recover(&model, &solution.displacement, None).expect("positive");
        let size = want.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let stress_off =
            found.stress_mpa.iter().flat_map(|s| s.iter().zip(&want)).map(|(a, b)| (a - b).abs());
        let stress_off = stress_off.fold(0.0, f64::max) / size;
        println!(
            "patch test, {name}: displacement {off:.1e}, stress {stress_off:.1e}, estimate {:.1e}",
            found.relative_error
        );
        println!("measured: verification.patch-{name}.displacement = {off:.1e}");
        println!("measured: verification.patch-{name}.stress = {stress_off:.1e}");
        // A linear field is in the element's space, so only rounding remains.
        assert!(off < 1e-9 && stress_off < 1e-9 && found.relative_error < 1e-9);
        if name == "isotropic" {
            assert!((want[0] - 2000.0).abs() < 1e-9 && (want[3] - 400.0).abs() < 1e-9);
        }
    }
}

/// The quarter of an elliptic plate of LE10.
fn ellipse_quarter(n: [usize; 3], thickness: f64) -> (Brick, TetMesh) {
    let brick = Brick::new(n, move |q| {
        let (s, c) = math::sin_cos(q.y * std::f64::consts::FRAC_PI_2);
        let at = |a: f64, b: f64| DVec3::new(a * c, b * s, 0.0);
        at(2.0, 1.0).lerp(at(3.25, 2.75), q.x) + DVec3::Z * thickness * (q.z - 0.5)
    });
    let mesh = brick.mesh();
    (brick, mesh)
}

#[test]
fn nafems_le10_thick_plate() {
    let mut last = 0.0;
    for n in [[4, 6, 2], [8, 12, 4], [16, 20, 6]] {
        let (_, mesh) = ellipse_quarter(n, 0.6);
        let stiffness = isotropic(210_000.0, 0.3);
        let model = Model::uniform(&mesh, stiffness);
        let mut supports = Supports::new(mesh.nodes.len());
        let near = |v: f64, w: f64| (v - w).abs() < 1e-6;
        for (i, p) in (0u32..).zip(&mesh.nodes) {
            let outer = near((p.x / 3.25).powi(2) + (p.y / 2.75).powi(2), 1.0);
            for (held, axis) in [
                (near(p.x, 0.0), DVec3::X),
                (near(p.y, 0.0), DVec3::Y),
                (outer, DVec3::X),
                (outer, DVec3::Y),
                (outer && near(p.z, 0.0), DVec3::Z),
            ] {
                if held {
                    supports.prescribe(&mesh, i, axis, 0.0).expect("all zero");
                }
            }
        }
        let top: Vec<usize> = (0..mesh.faces.len())
            .filter(|&f| mesh.faces[f].nodes.iter().all(|&i| near(mesh.nodes[i as usize].z, 0.3)))
            .collect();
        let mut load = vec![DVec3::ZERO; mesh.nodes.len()];
        nodal_forces::add_pressure(&mut load, &mesh, &top, 1.0);
        let solution = solved(&model, &supports, load);
        let found = recover(&model, &solution.displacement, None).expect("positive");
        last = found.stress_mpa[nearest(&mesh, DVec3::new(2.0, 0.0, 0.3))][1];
        println!("LE10 {n:?}: {last:.3} MPa (-5.38), estimate {:.4}", found.relative_error);
        println!("measured: verification.le10.mpa-with-{}-layers = {last:.3}", n[2]);
    }
    // Source: NAFEMS LE10, target -5.38 MPa.
    assert!((last / -5.38 - 1.0).abs() < 0.01, "{last}");
}

/// A meridian of LE11 from bottom to top: inner point (r, z) and outer point (r, z).
fn le11_meridian(v: f64) -> (f64, f64, f64, f64) {
    // The contour has three parts: sphere, taper, cylinder.
    let r = std::f64::consts::FRAC_1_SQRT_2;
    if v <= 1.0 {
        let (s, c) = math::sin_cos(v * std::f64::consts::FRAC_PI_4);
        let (so, co) = math::sin_cos(v * std::f64::consts::PI / 6.0);
        (c, s, 1.4 * co, 1.4 * so)
    } else if v <= 2.0 {
        let t = v - 1.0;
        let outer = DVec3::new(1.4 * 3.0f64.sqrt() / 2.0, 0.7, 0.0).lerp(DVec3::new(1.0, 1.39, 0.0), t);
        (r, r + t * (1.39 - r), outer.x, outer.y)
    } else {
        let z = 1.39 + (v - 2.0) * 0.4;
        (r, z, 1.0, z)
    }
}

#[test]
fn nafems_le11_thermal() {
    let mut last = 0.0;
    for m in [2, 4, 6] {
        // A quarter of the turn about the axis.
        let brick = Brick::new([m, 7 * m / 2, 2 * m], move |q| {
            let (ri, zi, ro, zo) = le11_meridian(3.0 * q.y);
            let (r, z) = (ri + (ro - ri) * q.x, zi + (zo - zi) * q.x);
            let (s, c) = math::sin_cos(q.z * std::f64::consts::FRAC_PI_2);
            DVec3::new(r * c, r * s, z)
        });
        let mesh = brick.mesh();
        let model = Model::uniform(&mesh, isotropic(210_000.0, 0.3));
        let mut supports = Supports::new(mesh.nodes.len());
        let near = |v: f64, w: f64| (v - w).abs() < 1e-9;
        for (i, p) in (0u32..).zip(&mesh.nodes) {
            let ends = near(p.z, 0.0) || near(p.z, 1.79);
            for (held, axis) in [(near(p.x, 0.0), DVec3::X), (near(p.y, 0.0), DVec3::Y), (ends, DVec3::Z)] {
                if held {
                    supports.prescribe(&mesh, i, axis, 0.0).expect("all zero");
                }
            }
        }
        let strain = |p: DVec3| {
            // Source: NAFEMS LE11: temperature is r + z, the coefficient of expansion 2.3e-4.
            let e = 2.3e-4 * ((p.x * p.x + p.y * p.y).sqrt() + p.z);
            [e, e, e, 0.0, 0.0, 0.0]
        };
        let mut load = vec![DVec3::ZERO; mesh.nodes.len()];
        nodal_forces::add_initial_strain(&mut load, &model, strain).expect("positive");
        let solution = solved(&model, &supports, load);
        let found = recover(&model, &solution.displacement, Some(&strain)).expect("positive");
        let a = [DVec3::X, DVec3::Y].map(|p| found.stress_mpa[nearest(&mesh, p)][2]);
        last = 0.5 * (a[0] + a[1]);
        println!("LE11 m = {m}: {last:.2} MPa (-105), both ends {a:?}, estimate {:.4}", found.relative_error);
        println!("measured: verification.le11.mpa-with-{m}-cells = {last:.2}");
    }
    // Source: NAFEMS LE11, target -105 MPa.
    assert!((last / -105.0 - 1.0).abs() < 0.01, "{last}");
}

struct Lame {
    /// Relative errors: of the displacement as a mean over the nodes, and of the stress in the energy
    /// norm.
    displacement: f64,
    energy_norm: f64,
    hoop_mpa: f64,
    radial_mpa: f64,
    found: Recovered,
}

/// A quarter of a thick cylinder under inner pressure in plane strain; each cut is held along its normal.
fn lame_cylinder(n: usize) -> Lame {
    let (a, b, p) = (10.0, 20.0, 10.0);
    let brick = Brick::new([n, 2 * n, 1], move |q| {
        let r = a + (b - a) * q.x;
        let (s, c) = math::sin_cos(q.y * std::f64::consts::FRAC_PI_2);
        DVec3::new(r * c, r * s, 10.0 / n as f64 * q.z)
    });
    let mesh = brick.mesh();
    let model = Model::uniform(&mesh, isotropic(1000.0, 0.3));
    let mut supports = Supports::new(mesh.nodes.len());
    let height = 10.0 / n as f64;
    for (i, q) in (0u32..).zip(&mesh.nodes) {
        let near = |v: f64, w: f64| (v - w).abs() < 1e-9;
        let ends = near(q.z, 0.0) || near(q.z, height);
        for (held, axis) in [(near(q.x, 0.0), DVec3::X), (near(q.y, 0.0), DVec3::Y), (ends, DVec3::Z)] {
            if held {
                supports.prescribe(&mesh, i, axis, 0.0).expect("all zero");
            }
        }
    }
    let on_inside = |f: &usize| {
        mesh.faces[*f].nodes.iter().all(|&i| {
            let q = mesh.nodes[i as usize];
            ((q.x * q.x + q.y * q.y).sqrt() - a).abs() < 1e-6
        })
    };
    let inside: Vec<usize> = (0..mesh.faces.len()).filter(on_inside).collect();
    let mut load = vec![DVec3::ZERO; mesh.nodes.len()];
    nodal_forces::add_pressure(&mut load, &mesh, &inside, p);
    let solution = solved(&model, &supports, load.clone());
    let found = recover(&model, &solution.displacement, None).expect("positive");
    // Error of the displacement as a mean over the nodes. Source: Lamé, u = A r + B / r for plane strain.
    let (e, nu) = (1000.0, 0.3);
    let k = p * a * a / (b * b - a * a);
    let exact = |r: f64| (1.0 + nu) / e * k * ((1.0 - 2.0 * nu) * r + b * b / r);
    assert!((exact(10.0) - 0.190_667).abs() < 1e-6);
    let squares: f64 = mesh
        .nodes
        .iter()
        .zip(&solution.displacement)
        .map(|(q, u)| {
            let r = (q.x * q.x + q.y * q.y).sqrt();
            (u.x - exact(r) * q.x / r).powi(2) + (u.y - exact(r) * q.y / r).powi(2)
        })
        .sum();
    let work: f64 = load.iter().zip(&solution.displacement).map(|(f, u)| f.dot(*u)).sum();
    let exact_work = p * exact(a) * std::f64::consts::FRAC_PI_2 * a * height;
    let at = nearest(&mesh, DVec3::new(a, 0.0, 0.0));
    Lame {
        displacement: (squares / mesh.nodes.len() as f64).sqrt() / exact(a),
        // Galerkin's solution does less work than the exact one, and the difference is the square of the
        // error in the energy norm.
        energy_norm: (work / exact_work - 1.0).abs().sqrt(),
        hoop_mpa: found.stress_mpa[at][1],
        radial_mpa: found.stress_mpa[at][0],
        found,
    }
}

#[test]
fn lame_cylinder_and_orders_of_convergence() {
    let runs: Vec<Lame> = [2, 4, 8].map(lame_cylinder).into();
    for r in &runs {
        println!(
            "Lame: displacement {:.2e}, energy norm {:.2e}, hoop {:.3} (16.667), radial {:.3} (-10), estimate {:.4}",
            r.displacement, r.energy_norm, r.hoop_mpa, r.radial_mpa, r.found.relative_error
        );
    }
    let order = |f: fn(&Lame) -> f64| math::ln(f(&runs[1]) / f(&runs[2])) / math::ln(2.0);
    let (u, energy) = (order(|r| r.displacement), order(|r| r.energy_norm));
    println!("order of the displacement {u:.2} (3), of the energy norm {energy:.2} (2)");
    let ratio = runs[2].found.relative_error / runs[2].energy_norm;
    println!("measured: verification.lame-cylinder.hoop-mpa = {:.3}", runs[2].hoop_mpa);
    println!("measured: verification.lame-cylinder.radial-mpa = {:.2}", runs[2].radial_mpa);
    println!("measured: verification.lame-cylinder.order-of-displacement = {u:.2}");
    println!("measured: verification.lame-cylinder.order-of-energy-norm = {energy:.2}");
    println!("measured: verification.lame-cylinder.estimated-over-true = {ratio:.2}");
    assert!(
        (runs[2].hoop_mpa / 16.667 - 1.0).abs() < 0.01 && (runs[2].radial_mpa / -10.0 - 1.0).abs() < 0.01
    );
    // Orders of quadratic elements: 3 for displacements, 2 for the energy norm.
    assert!((u - 3.0).abs() < 0.3 && (energy - 2.0).abs() < 0.3, "{u} {energy}");
    // The estimate has the size of the error.
    assert!((0.5..2.0).contains(&ratio));
}

#[test]
fn cantilever_bends_as_timoshenko_says() {
    let (l, w, h) = (100.0, 8.0, 10.0);
    let mesh = Brick::new([40, 3, 4], move |q| q * DVec3::new(l, w, h)).mesh();
    // Without lateral strain the clamped end does not stiffen the beam, so beam theory applies.
    let (e, nu) = (2000.0, 0.0);
    let model = Model::uniform(&mesh, isotropic(e, nu));
    let mut supports = Supports::new(mesh.nodes.len());
    for (i, p) in (0u32..).zip(&mesh.nodes) {
        if p.x == 0.0 {
            supports.fix(&mesh, i).expect("all zero");
        }
    }
    let tip: Vec<usize> = (0..mesh.faces.len())
        .filter(|&f| mesh.faces[f].nodes.iter().all(|&i| mesh.nodes[i as usize].x > l - 1e-9))
        .collect();
    let mut load = vec![DVec3::ZERO; mesh.nodes.len()];
    nodal_forces::add_force(&mut load, &mesh, &tip, DVec3::new(0.0, 0.0, -10.0));
    let solution = solved(&model, &supports, load);
    let down = -solution.displacement[nearest(&mesh, DVec3::new(l, w / 2.0, h / 2.0))].z;
    let i = w * h * h * h / 12.0;
    let shear = e / (2.0 + 2.0 * nu) * w * h * 5.0 / 6.0;
    let want = 10.0 * l.powi(3) / (3.0 * e * i) + 10.0 * l / shear;
    println!("cantilever: beam theory {want:.4} mm");
    println!("measured: verification.cantilever.mm = {down:.4}");
    assert!((down / want - 1.0).abs() < 0.005);
    let reaction: DVec3 = solution.reaction.iter().sum();
    assert!((reaction - DVec3::new(0.0, 0.0, 10.0)).length() < 1e-6, "{reaction}");
}

/// A CalculiX deck of ten-node tetrahedra: mesh, sets of nodes, concentrated forces, and pressures.
struct Deck {
    mesh: TetMesh,
    sets: BTreeMap<String, Vec<u32>>,
    forces: Vec<DVec3>,
    /// Pressures on faces of elements: element, face from 1, MPa.
    pressures: Vec<(u32, usize, f64)>,
}

fn deck(name: &str) -> Deck {
    let text = String::from_utf8(data::read_data(&format!("fea/{name}"))).expect("a deck is text");
    let (mut nodes, mut elements, mut sets) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    let (mut point_loads, mut face_loads) = (Vec::new(), Vec::new());
    let mut card = String::new();
    for line in text.lines().filter(|l| !l.starts_with("**") && !l.trim().is_empty()) {
        if line.starts_with('*') {
            card = line.to_uppercase();
            continue;
        }
        let words: Vec<&str> = line.split(',').map(str::trim).filter(|w| !w.is_empty()).collect();
        let number = |i: usize| words[i].parse::<f64>().expect("a number");
        let id = |i: usize| words[i].parse::<u32>().expect("an index");
        if card.starts_with("*NODE,") {
            nodes.insert(id(0), DVec3::new(number(1), number(2), number(3)));
        } else if card.starts_with("*ELEMENT") {
            elements.insert(id(0), (1..11).map(id).collect::<Vec<u32>>());
        } else if card.starts_with("*NSET") {
            let set: &mut Vec<u32> =
                sets.entry(card.split('=').nth(1).expect("a name").to_owned()).or_default();
            set.extend((0..words.len()).map(id));
        } else if card.starts_with("*CLOAD") {
            point_loads.push((id(0), words[1].parse::<usize>().expect("a component") - 1, number(2)));
        } else if card.starts_with("*DLOAD") {
            face_loads.push((id(0), words[1][1..].parse::<usize>().expect("a face"), number(2)));
        }
    }
    let ids: Vec<u32> = nodes.keys().copied().collect();
    let index = |i: u32| ids.binary_search(&i).expect("a node") as u32;
    let tets = elements.values().map(|e| std::array::from_fn(|k| index(e[k]))).collect();
    let mut mesh = TetMesh { nodes: nodes.into_values().collect(), tets, faces: Vec::new() };
    mesh.find_faces();
    let element_ids: Vec<u32> = elements.into_keys().collect();
    let mut forces = vec![DVec3::ZERO; mesh.nodes.len()];
    for (node, axis, value) in point_loads {
        forces[index(node) as usize][axis] += value;
    }
    let element = |e: u32| element_ids.binary_search(&e).expect("an element") as u32;
    let pressures = face_loads.into_iter().map(|(e, face, p)| (element(e), face, p)).collect();
    let sets = sets.into_iter().map(|(name, set)| (name, set.into_iter().map(index).collect())).collect();
    Deck { mesh, sets, forces, pressures }
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn calculix_bracket() {
    let deck = deck("bracket.inp");
    let model = Model::uniform(&deck.mesh, isotropic(210_000.0, 0.3));
    let mut supports = Supports::new(deck.mesh.nodes.len());
    for &n in &deck.sets["FIX"] {
        supports.fix(&deck.mesh, n).expect("all zero");
    }
    let solution = solved(&model, &supports, deck.forces);
    let found = recover(&model, &solution.displacement, None).expect("positive");
    let most = solution.displacement.iter().map(|u| u.length()).fold(0.0, f64::max);
    let peak = found.stress_mpa.iter().map(grainpath_core::tensor::von_mises).fold(0.0, f64::max);
    println!("bracket: CalculiX 0.028610 mm, peak 43.6 MPa (averaged)");
    println!("measured: verification.bracket-deck.mm = {most:.6}");
    println!("measured: verification.bracket-deck.peak-mpa = {peak:.2}");
    // The same elements give the same displacement. The peak stress lies in a sharp inner corner of two
    // or three elements, where the stress has no limit; recovered and averaged values need not agree
    // closely there.
    assert!((most / 0.028_610_267 - 1.0).abs() < 1e-5);
    assert!((peak / 43.6 - 1.0).abs() < 0.15, "{peak}");
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn calculix_plate_with_a_hole() {
    let deck = deck("plate_hole_freecad.inp");
    let model = Model::uniform(&deck.mesh, isotropic(210_000.0, 0.3));
    let mut supports = Supports::new(deck.mesh.nodes.len());
    for &n in &deck.sets["CONSTRAINTFIXED"] {
        supports.fix(&deck.mesh, n).expect("all zero");
    }
    let mut load = deck.forces;
    for (tet, side, pressure) in &deck.pressures {
        // Source: the manual of CalculiX: face 1 has corners 1 2 3, face 2 1 4 2, face 3 2 4 3, face 4 3
        // 4 1.
        let corners = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]][side - 1];
        let corners = corners.map(|c| deck.mesh.tets[*tet as usize][c]);
        let own = |f: &usize| {
            let face = &deck.mesh.faces[*f];
            face.tet == *tet && face.nodes[..3].iter().all(|n| corners.contains(n))
        };
        let faces: Vec<usize> = (0..deck.mesh.faces.len()).filter(own).collect();
        assert_eq!(faces.len(), 1);
        nodal_forces::add_pressure(&mut load, &deck.mesh, &faces, *pressure);
    }
    let solution = solved(&model, &supports, load);
    let found = recover(&model, &solution.displacement, None).expect("positive");
    let most = solution.displacement.iter().map(|u| u.length()).fold(0.0, f64::max);
    let peak = found.stress_mpa.iter().map(|s| s[0]).fold(0.0, f64::max);
    println!("plate with a hole: CalculiX 0.353140 mm, peak xx 578 MPa (averaged)");
    println!("measured: verification.plate-deck.mm = {most:.6}");
    println!("measured: verification.plate-deck.peak-xx-mpa = {peak:.1}");
    assert!((most / 0.353_139_97 - 1.0).abs() < 1e-4);
    assert!((peak / 578.4 - 1.0).abs() < 0.05, "{peak}");
}

#[test]
fn a_factorization_agrees_with_the_iteration() {
    let mesh =
        Brick::new([6, 4, 5], |q| DVec3::new(12.0 * q.x, 8.0 * q.y + q.x * q.x, 9.0 * q.z + q.x * q.y))
            .mesh();
    let card =
        Orthotropic { e_mpa: [3120.0, 2770.0, 2500.0], nu: [0.33, 0.3, 0.35], g_mpa: [1050.0, 900.0, 800.0] };
    let model = Model::uniform(&mesh, card.stiffness().expect("stable"));
    let mut supports = Supports::new(mesh.nodes.len());
    for (i, p) in (0u32..).zip(&mesh.nodes) {
        if p.x == 0.0 {
            supports.prescribe(&mesh, i, DVec3::new(1.0, 0.4, 0.1), 0.01).expect("new");
            supports.prescribe(&mesh, i, DVec3::Z, 0.0).expect("new");
        }
        if p.x == 12.0 {
            supports.prescribe(&mesh, i, DVec3::Y, -0.02).expect("new");
        }
    }
    let load = |k: usize| (0..mesh.nodes.len()).map(|i| DVec3::Z * 0.01 * ((i * k) % 7) as f64).collect();
    let all: Vec<Vec<DVec3>> = (1..=6).map(load).collect();
    let (one, info) = solve(&model, &supports, &all, &tight()).expect("held");
    assert_eq!(info.solver, "sparse Cholesky");
    let (two, info) = solve(&model, &supports, &all, &SolveSettings { method: Method::Iterative, ..tight() })
        .expect("held");
    assert_ne!(info.solver, "sparse Cholesky");
    for (a, b) in one.iter().zip(&two) {
        let size = a.displacement.iter().map(|u| u.length()).fold(0.0, f64::max);
        let gap = a.displacement.iter().zip(&b.displacement).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(gap < 1e-9 * size && a.residual < 1e-12, "{gap} of {size}, {}", a.residual);
    }
    let small = SolveSettings { method: Method::Direct, max_mib: 2.0, ..tight() };
    assert!(matches!(solve(&model, &supports, &all, &small), Err(SolidError::Memory { .. })));
}

/// The iteration and the factorization refuse it, on nodes that move and on nodes that are held.
#[test]
fn a_load_that_is_not_finite_is_refused_as_one() {
    let mesh = Brick::new([4, 2, 2], |q| q * DVec3::new(20.0, 6.0, 6.0)).mesh();
    let model = Model::uniform(&mesh, isotropic(1000.0, 0.3));
    let mut supports = Supports::new(mesh.nodes.len());
    for (i, _) in (0u32..).zip(&mesh.nodes).filter(|(_, p)| p.x == 0.0) {
        supports.fix(&mesh, i).expect("all zero");
    }
    let held = mesh.nodes.iter().position(|p| p.x == 0.0).expect("held");
    let moves = mesh.nodes.iter().position(|p| p.x == 20.0).expect("free");
    // The square of the last force overflows.
    for force in [f64::NAN, f64::INFINITY, 1e200] {
        for node in [held, moves].into_iter().filter(|&i| i == moves || !force.is_finite()) {
            for method in [Method::Direct, Method::Iterative] {
                let mut load = vec![DVec3::ZERO; mesh.nodes.len()];
                load[node].z = force;
                let error = solve(&model, &supports, &[load], &SolveSettings { method, ..tight() }).err();
                assert_eq!(error, Some(SolidError::LoadNotFinite), "{force} at node {node}, {method:?}");
            }
        }
    }
}

#[test]
fn a_moment_bends_and_gravity_pulls() {
    let mesh = Brick::new([8, 2, 2], |q| q * DVec3::new(40.0, 6.0, 6.0)).mesh();
    let stiffness: Stiffness = isotropic(1000.0, 0.0);
    let model = Model::uniform(&mesh, stiffness);
    let mut supports = Supports::new(mesh.nodes.len());
    for (i, p) in (0u32..).zip(&mesh.nodes) {
        if p.x == 0.0 {
            supports.fix(&mesh, i).expect("all zero");
        }
    }
    let end: Vec<usize> = (0..mesh.faces.len())
        .filter(|&f| mesh.faces[f].nodes.iter().all(|&i| mesh.nodes[i as usize].x == 40.0))
        .collect();
    let mut bend = vec![DVec3::ZERO; mesh.nodes.len()];
    nodal_forces::add_moment(&mut bend, &mesh, &end, DVec3::new(0.0, 100.0, 0.0));
    assert!(bend.iter().sum::<DVec3>().length() < 1e-9);
    let moment: DVec3 = mesh.nodes.iter().zip(&bend).map(|(p, f)| p.cross(*f)).sum();
    assert!((moment - DVec3::new(0.0, 100.0, 0.0)).length() < 1e-9);
    let mut hang = vec![DVec3::ZERO; mesh.nodes.len()];
    nodal_forces::add_body_force(&mut hang, &mesh, |_| DVec3::new(1e-3, 0.0, 0.0));
    let (found, _) = solve(&model, &supports, &[bend, hang], &tight()).expect("held");
    // Without lateral strain quadratic elements are exact in both cases: M L^2 / 2 E I, and w L^2 / 2 E
    // at the end.
    let middle = nearest(&mesh, DVec3::new(40.0, 3.0, 3.0));
    let w = found[0].displacement[middle].z;
    let want = -100.0 * 1600.0 / (2.0 * 1000.0 * 108.0);
    assert!((w / want - 1.0).abs() < 1e-6, "{w} {want}");
    let u = found[1].displacement[middle].x;
    assert!((u / (1e-3 * 1600.0 / 2000.0) - 1.0).abs() < 1e-6, "{u}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| lame_cylinder(4).found)
    };
    let one = run(1);
    assert!([2, 5].map(run).iter().all(|r| *r == one));
}
