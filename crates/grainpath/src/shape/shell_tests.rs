//! Shells beside a body and shells in one another: what of them is left after mending, and which way they face.

use super::tests::{box_at, facet, turned};
use super::{Repair, ShapeError, mend};
use grainpath_core::{DVec2, DVec3, Diagnostics, Polygon, TriMesh, WarningId};

fn joined(parts: &[TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    for part in parts {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&part.vertices);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

/// The mended mesh, and the number of shells that were left out by the warning.
fn left(bodies: Vec<TriMesh>) -> (TriMesh, usize) {
    let diagnostics = Diagnostics::default();
    let mesh = mend(bodies, Repair::Auto, &diagnostics).expect("a part");
    let told = diagnostics.warnings().into_iter().find(|w| w.id == WarningId::MeshStray);
    let n = told.map_or(0, |w| w.text.split(' ').nth(1).and_then(|n| n.parse().ok()).expect("a count"));
    (mesh, n)
}

#[test]
fn facets_and_sheets_beside_a_body_go_wherever_they_lie() {
    let body = box_at([0.0; 3], [20.0, 10.0, 5.0]);
    let sheet = |z: f64| {
        let (top, mut back) = (facet([0.0, 0.0, z], 7.0), facet([0.0, 0.0, z], 7.0));
        back.triangles[0].swap(1, 2);
        // A double sheet is closed: its two sides share their vertices.
        TriMesh { vertices: top.vertices.clone(), triangles: [top.triangles, back.triangles].concat() }
    };
    let many = (0..50).map(|i| facet([f64::from(i), -40.0 + f64::from(i * i % 17), f64::from(i % 7)], 1.0));
    for strays in [
        vec![facet([0.0, 0.0, -6.5], 2.0)],
        vec![facet([5.0, 5.0, 2.0], 1.0)],
        vec![sheet(30.0), sheet(-300.0), facet([200.0, 0.0, 0.0], 0.01)],
        many.collect(),
    ] {
        let n = strays.len();
        let mut parts = strays.clone();
        parts.insert(n / 2, body.clone());
        for bodies in [vec![joined(&parts)], parts.clone()] {
            let (mesh, n_left_out) = left(bodies);
            assert_eq!((mesh.bounds(), n_left_out), (body.bounds(), n));
            assert!((mesh.signed_volume() - 1000.0).abs() < 1e-9);
        }
        let strict = mend(parts, Repair::Strict, &Diagnostics::default());
        assert!(matches!(strict, Err(ShapeError::Defects { defects }) if defects.contains(&n.to_string())));
    }
}

#[test]
fn open_surfaces_small_bodies_and_pieces_of_a_surface_stay() {
    let body = box_at([0.0; 3], [200.0, 200.0, 200.0]);
    // A body of a ten thousand millionth of the volume beside it.
    let small = box_at([300.0, 0.0, 0.0], [0.1, 0.1, 0.1]);
    let mut lid_off = box_at([0.0; 3], [10.0, 10.0, 5.0]);
    // The upper side.
    let lid = lid_off.triangles.drain(2..4).collect();
    // The lid's edges are too far from those of the box to be merged.
    let mut lid = TriMesh { vertices: lid_off.vertices.clone(), triangles: lid };
    lid.vertices.iter_mut().for_each(|p| p.x += 1e-3);
    for bodies in [vec![joined(&[body.clone(), small])], vec![lid_off.clone()], vec![joined(&[lid_off, lid])]]
    {
        let n = bodies.iter().map(|b| b.triangles.len()).sum::<usize>();
        let (mesh, n_left_out) = left(bodies);
        assert_eq!((mesh.triangles.len(), n_left_out), (n, 0));
    }
    // A body whose facets share no vertices, beside one whose facets do.
    let whole = box_at([0.0; 3], [10.0, 10.0, 5.0]);
    let apart = whole.triangles.iter().enumerate().map(|(i, t)| TriMesh {
        vertices: t.map(|v| whole.vertices[v as usize] + DVec3::new(400.0, 1e-3 * i as f64, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2]],
    });
    let mut parts: Vec<TriMesh> = apart.collect();
    parts.push(body);
    let bodies: Vec<TriMesh> = vec![joined(&parts)];
    let diagnostics = Diagnostics::default();
    let _ = mend(bodies, Repair::Auto, &diagnostics);
    assert!(diagnostics.warnings().iter().all(|w| w.id != WarningId::MeshStray));
}

fn volume(shells: &[TriMesh]) -> f64 {
    mend(vec![joined(shells)], Repair::Auto, &Diagnostics::default()).expect("a part").signed_volume()
}

#[test]
fn nested_shells_face_alternately_whichever_way_they_were_written() {
    let outer = box_at([0.0; 3], [10.0, 10.0, 10.0]);
    let cavity = turned(&box_at([2.0; 3], [6.0, 6.0, 6.0]));
    let island = box_at([4.0; 3], [2.0, 2.0, 2.0]);
    let beside = box_at([20.0, 0.0, 0.0], [3.0, 3.0, 3.0]);
    let nest = [outer, cavity, island, beside];
    let expected = 1000.0 - 216.0 + 8.0 + 27.0;
    for places in [[0.0; 3], [-50.0, 70.0, -1e3]] {
        let moved = |m: &TriMesh| {
            let mut m = m.clone();
            m.vertices.iter_mut().for_each(|p| *p += DVec3::from_array(places));
            m
        };
        let as_written: Vec<TriMesh> = nest.iter().map(moved).collect();
        let whole: Vec<TriMesh> = as_written.iter().map(turned).collect();
        // The nest alone is inside out, the body beside it is not, and the other way round.
        let mixed = [&whole[..3], &as_written[3..]].concat();
        let other = [&as_written[..3], &whole[3..]].concat();
        for shells in [as_written, whole, mixed, other] {
            let mut backwards = shells.clone();
            backwards.reverse();
            assert!((volume(&shells) - expected).abs() < 1e-6, "{}", volume(&shells));
            assert!((volume(&backwards) - expected).abs() < 1e-6);
        }
    }
    // A body in the notch of another lies in its box and not in it.
    let ring = [[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [1.0, 1.0], [1.0, 9.0], [0.0, 9.0]];
    let ring = Polygon { outer: ring.map(DVec2::from_array).to_vec(), holes: Vec::new() };
    let mut angle = TriMesh::default();
    super::prism(&ring.into(), 0.0, 9.0, &mut angle).expect("an outline");
    let small = box_at([4.0; 3], [1.0, 1.0, 1.0]);
    for (a, b) in
        [(turned(&angle), small.clone()), (angle.clone(), turned(&small)), (turned(&angle), turned(&small))]
    {
        assert!((volume(&[a, b]) - (17.0 * 9.0 + 1.0)).abs() < 1e-9);
    }
}

#[test]
fn facets_that_repeat_others_go() {
    let body = box_at([0.0; 3], [20.0, 10.0, 5.0]);
    let with = |more: Vec<[u32; 3]>| {
        let mut mesh = body.clone();
        mesh.triangles.extend(more);
        mesh
    };
    let all = body.triangles.clone();
    let (back, some) = (turned(&body).triangles, vec![all[1], all[4], all[5], all[9]]);
    let apart = joined(&[body.clone(), body.clone()]);
    for (bodies, n) in [
        (vec![with(all.clone())], 12),
        (vec![with([all.clone(), all.clone()].concat())], 24),
        (vec![with(back)], 12),
        (vec![with(some.clone())], 4),
        (vec![with([some.clone(), some].concat())], 8),
        // Copies that share no vertices with what they repeat, in the same body and in another one.
        (vec![apart], 12),
        (vec![body.clone(), body.clone()], 12),
    ] {
        let diagnostics = Diagnostics::default();
        let mesh = mend(bodies.clone(), Repair::Auto, &diagnostics).expect("a part");
        assert_eq!(mesh.triangles.len(), 12);
        assert!((mesh.signed_volume() - 1000.0).abs() < 1e-9, "{}", mesh.signed_volume());
        let told: Vec<_> = diagnostics.warnings().into_iter().map(|w| (w.id, w.text)).collect();
        let wanted = format!("mesh: {} left out", grainpath_core::spelling::counted(n, "repeated facet"));
        assert_eq!(told, [(WarningId::MeshRepaired, wanted)]);
        let strict = mend(bodies, Repair::Strict, &Diagnostics::default());
        assert!(matches!(strict, Err(ShapeError::Defects { defects }) if defects.contains(&n.to_string())));
    }
    // Bodies that touch with a whole side, and bodies with a side in common, would be open without it.
    let touching = box_at([20.0, 0.0, 0.0], [5.0, 10.0, 5.0]);
    let longer = box_at([0.0; 3], [30.0, 10.0, 5.0]);
    for other in [touching, longer] {
        for bodies in [vec![joined(&[body.clone(), other.clone()])], vec![body.clone(), other]] {
            let diagnostics = Diagnostics::default();
            assert_eq!(mend(bodies, Repair::Auto, &diagnostics).expect("a part").triangles.len(), 24);
            assert!(diagnostics.warnings().is_empty());
        }
    }
}
