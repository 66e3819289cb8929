//! Decks of other programs are solved here, and the results agree with theirs.

#[path = "../../../tests/data.rs"]
mod data;

use grainpath_core::{DVec2, DVec3};
use grainpath_fea::material::Orthotropic;
use grainpath_fea::plane::{Hold, PlaneMesh, PlaneProblem, PlaneSystem};
use grainpath_fea::solid::{Model, SolveSettings, Supports, TetMesh, recover, solve};
use grainpath_io::fe::{Elastic, ElementKind, FeFile, FeOptions, StressField, parse_fe, von_mises};

fn read(file: &str) -> FeFile {
    let bytes = data::read_data(&format!("fea/{file}"));
    parse_fe(&bytes, Some(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

/// A deck's mesh of 8-node quads as 6-node triangles: each quad is divided into four about its centre.
/// Nodes of the deck keep their indices.
fn triangles(file: &FeFile) -> PlaneMesh {
    let mut nodes: Vec<DVec2> = file.nodes.iter().map(|p| p.truncate()).collect();
    let mut elements = Vec::new();
    for e in &file.elements {
        assert_eq!(e.kind, ElementKind::Quad8);
        let mut add = |x: f64, y: f64| {
            let weights = e.kind.weights(DVec3::new(x, y, 0.0));
            nodes.push(
                e.nodes().iter().zip(weights).map(|(&i, w)| w * file.nodes[i as usize].truncate()).sum(),
            );
            nodes.len() as u32 - 1
        };
        let middle = add(0.0, 0.0);
        let spokes = [add(-0.5, -0.5), add(0.5, -0.5), add(0.5, 0.5), add(-0.5, 0.5)];
        for k in 0..4 {
            let next = (k + 1) % 4;
            elements.push([e.nodes()[k], e.nodes()[next], middle, e.nodes()[4 + k], spokes[next], spokes[k]]);
        }
    }
    let mut sides: Vec<([u32; 2], [u32; 3])> = Vec::new();
    for e in &elements {
        for k in 0..3 {
            let (a, b) = (e[k], e[(k + 1) % 3]);
            sides.push(([a.min(b), a.max(b)], [a, b, e[3 + k]]));
        }
    }
    sides.sort_unstable();
    let border = sides.chunk_by(|x, y| x.0 == y.0).filter(|c| c.len() == 1).map(|c| c[0].1).collect();
    PlaneMesh { nodes, elements, border }
}

/// Displacements and stresses (xx, yy, xy) at the deck's nodes.
fn solve_plane(file: &FeFile) -> (Vec<DVec2>, Vec<[f64; 3]>) {
    let deck = file.deck.as_ref().expect("a deck");
    let (material, thickness) = deck.section_of(0).expect("a section");
    let Some(Elastic::Isotropic { e, nu }) = material.elastic else { panic!("{material:?}") };
    let stiffness = Orthotropic::isotropic(e, nu).plane_stress(0.0).expect("a stable material");
    let holds: Vec<Hold> = deck
        .fixed
        .iter()
        .chain(&deck.steps[0].fixed)
        .filter(|f| f.axis < 2)
        .map(|f| Hold {
            node: f.node,
            along: if f.axis == 0 { DVec2::X } else { DVec2::Y },
            displacement_mm: f.value,
        })
        .collect();
    let mesh = triangles(file);
    let problem = PlaneProblem {
        mesh: &mesh,
        thickness_mm: thickness.expect("a thickness"),
        stiffness: &|_| stiffness,
        holds: &holds,
        max_mib: 1024.0,
    };
    let system = PlaneSystem::new(&problem).expect("a well held plate");
    let mut forces: Vec<DVec2> =
        file.nodal_forces(0).expect("a step").iter().map(|f: &DVec3| f.truncate()).collect();
    forces.resize(mesh.nodes.len(), DVec2::ZERO);
    let solution = system.solve(&forces);
    let stress = system.stress(&solution);
    let at_nodes = file.nodes.iter().map(|p| stress.at(p.truncate())).collect();
    (solution.displacement_mm[..file.nodes.len()].to_vec(), at_nodes)
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn le1_meets_calculix() {
    let (deck, result) = (read("nafems_le1.inp"), read("nafems_le1.frd"));
    let result = result.result(&FeOptions::default()).expect("a stress");
    let (u, s) = solve_plane(&deck);
    // The result lists the deck's nodes in the deck's order.
    assert!(deck.nodes.iter().zip(&result.nodes).all(|(a, b)| (*a - *b).length() < 1e-5));
    let theirs = result.displacement.as_ref().expect("DISP");
    let longest = theirs.iter().map(|u| u.length()).fold(0.0, f64::max);
    let off = u.iter().zip(theirs).map(|(a, b)| (*a - b.truncate()).length()).fold(0.0, f64::max);
    let d =
        deck.nodes.iter().position(|p| (*p - DVec3::new(2.0, 0.0, 0.0)).length() < 1e-9).expect("point D");
    let mut differences: Vec<f64> = s
        .iter()
        .zip(&result.stress)
        .map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[3]].into_iter().map(f64::abs).fold(0.0, f64::max))
        .collect();
    differences.sort_by(f64::total_cmp);
    let median = differences[differences.len() / 2];
    println!("LE1 SYY at D: CalculiX {:.2} MPa, reference 92.7 MPa", result.stress[d][1]);
    println!("measured: decks.le1.displacement = {:.1e}", off / longest);
    println!("measured: decks.le1.stress-mpa = {median:.3}");
    println!("measured: decks.le1.yy-mpa = {:.2}", s[d][1]);
    // Quads and the triangles cut from them differ a little in stiffness.
    assert!(off < 2e-3 * longest, "displacements differ by {off} of {longest}");
    assert!(
        (s[d][1] / 92.7 - 1.0).abs() < 0.02 && (s[d][1] / result.stress[d][1] - 1.0).abs() < 0.02,
        "{:?}",
        s[d]
    );
    assert!(median < 0.5, "the median difference of the stresses is {median} MPa");
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn plates_of_calculix_carry_a_uniform_stress() {
    // Four quads pulled by 100 MPa at one end, with free sides.
    let deck = read("ccx_planestress.inp");
    let (u, s) = solve_plane(&deck);
    for (p, s) in deck.nodes.iter().zip(&s) {
        let peak = s[0].max(s[1]);
        assert!(
            (peak - 100.0).abs() < 1e-3 && (s[0] + s[1] - 100.0).abs() < 1e-3 && s[2].abs() < 1e-3,
            "{p}: {s:?}"
        );
    }
    assert!(u.iter().all(|u| u.is_finite()) && u.iter().any(|u| u.length() > 1e-5));
}

/// Displacements and stresses of a deck of ten-node tetrahedra at its nodes.
fn solve_solid(file: &FeFile) -> (Vec<DVec3>, Vec<[f64; 6]>) {
    let deck = file.deck.as_ref().expect("a deck");
    let (material, _) = deck.section_of(0).expect("a section");
    let Some(Elastic::Isotropic { e, nu }) = material.elastic else { panic!("{material:?}") };
    let tet = |e: &grainpath_io::fe::Element| <[u32; 10]>::try_from(e.nodes()).expect("ten nodes");
    let mut mesh = TetMesh {
        nodes: file.nodes.clone(),
        tets: file.elements.iter().map(tet).collect(),
        faces: Vec::new(),
    };
    mesh.find_faces();
    let mut supports = Supports::new(mesh.nodes.len());
    for f in deck.fixed.iter().chain(&deck.steps[0].fixed).filter(|f| f.axis < 3) {
        supports
            .prescribe(&mesh, f.node, DVec3::AXES[f.axis as usize], f.value)
            .expect("supports that agree");
    }
    let model = Model::uniform(&mesh, Orthotropic::isotropic(e, nu).stiffness().expect("a stable material"));
    let forces = file.nodal_forces(0).expect("a step");
    let (solutions, info) =
        solve(&model, &supports, &[forces], &SolveSettings::default()).expect("a solution");
    println!(
        "{} unknowns, {} iterations, residual {:.1e}",
        info.n_free, solutions[0].iterations, solutions[0].residual
    );
    let stress = recover(&model, &solutions[0].displacement, None).expect("a stress").stress_mpa;
    (solutions[0].displacement.clone(), stress)
}

/// Four numbers at the nodes of the deck: greatest difference of displacements over the longest, median
/// difference of von Mises stresses over their peak, and both peaks. The result may have other nodes.
fn compared(file: &FeFile, u: &[DVec3], s: &[[f64; 6]], theirs: &StressField) -> (f64, f64, f64, f64) {
    let (mut longest, mut off, mut their_peak) = (0.0f64, 0.0f64, 0.0f64);
    let mut differences = Vec::new();
    for ((p, u), s) in file.nodes.iter().zip(u).zip(s) {
        let (reference, stress) = (theirs.displacement(*p).expect("a displacement"), theirs.sample(*p));
        longest = longest.max(reference.length());
        off = off.max((*u - reference).length());
        their_peak = their_peak.max(von_mises(&stress));
        differences.push((von_mises(s) - von_mises(&stress)).abs());
    }
    differences.sort_by(f64::total_cmp);
    let peak = s.iter().map(von_mises).fold(0.0, f64::max);
    (off / longest, differences[differences.len() / 2] / their_peak, peak, their_peak)
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn solids_meet_calculix() {
    for (key, deck, result) in [
        ("bracket", "bracket.inp", "bracket.vtu"),
        ("plate-with-hole", "plate_hole_freecad.inp", "plate_hole_linear.vtu"),
        ("box", "freecad_box_static.inp", "freecad_box_static.frd"),
    ] {
        let (file, theirs) = (read(deck), read(result));
        let theirs = theirs.result(&FeOptions::default()).expect("a stress");
        let theirs = StressField::new(theirs);
        let (u, s) = solve_solid(&file);
        let (off, stress_off, peak, their_peak) = compared(&file, &u, &s, &theirs);
        println!("{deck}: peak of CalculiX {their_peak:.1} MPa");
        println!("measured: decks.{key}.displacement = {off:.1e}");
        println!("measured: decks.{key}.von-mises = {stress_off:.1e}");
        println!("measured: decks.{key}.peak-mpa = {peak:.1}");
        assert!(off < 1e-4, "{deck}: displacements differ by {off}");
        assert!(stress_off < 0.02, "{deck}: stresses differ by {stress_off}");
        // Peaks lie in sharp inner corners, where recovered and averaged stresses differ.
        assert!((peak / their_peak - 1.0).abs() < 0.15, "{deck}: {peak} {their_peak}");
    }
}
