//! Surfaces as converters leave them: each is a sound bar with one kind of defect, and must bend as the
//! sound bar does.

mod support;

use grainpath_core::mesh::VertexWelder;
use grainpath_core::{DVec3, TriMesh, math};
use grainpath_fea::solid::{
    MeshSettings, Meshed, Model, SolidError, SolveSettings, Supports, mesh, nodal_forces, solve,
};
use support::isotropic;

/// A bar of 30 x 12 x 6 mm, 2160 mm3, each side divided into squares of 3 mm.
const SIZE: DVec3 = DVec3::new(30.0, 12.0, 6.0);
const VOLUME_MM3: f64 = 2160.0;
const ELEMENT_MM: f64 = 3.0;

fn triangles_of(surface: &TriMesh) -> Vec<[DVec3; 3]> {
    surface.triangles.iter().map(|t| t.map(|v| surface.vertices[v as usize])).collect()
}

/// The surface of these triangles, with equal corners merged as a reader does.
fn welded(triangles: &[[DVec3; 3]]) -> TriMesh {
    let mut welder = VertexWelder::with_capacity(triangles.len());
    let index = |p: DVec3, welder: &mut VertexWelder| welder.index(p).expect("finite");
    let triangles = triangles.iter().map(|t| t.map(|p| index(p, &mut welder))).collect();
    TriMesh { vertices: welder.into_vertices(), triangles }
}

/// The surface of these triangles, and the same turned by 37 degrees about the z axis.
fn as_it_is_and_turned(triangles: &[[DVec3; 3]]) -> [TriMesh; 2] {
    let (s, c) = math::sin_cos(37f64.to_radians());
    let turn = |p: DVec3| DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    let turned: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(turn)).collect();
    [welded(triangles), welded(&turned)]
}

/// A parallelogram as `2 n m` triangles, outward normal along `u x v`.
fn sheet(at: DVec3, u: DVec3, v: DVec3, [n, m]: [u32; 2]) -> Vec<[DVec3; 3]> {
    let p = |i: u32, j: u32| at + u * (f64::from(i) / f64::from(n)) + v * (f64::from(j) / f64::from(m));
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..n).flat_map(|i| (0..m).flat_map(move |j| [[i, j]])).flat_map(|[i, j]| square(i, j)).collect()
}

fn block(low: DVec3, size: DVec3, cells: [u32; 3]) -> Vec<[DVec3; 3]> {
    let [x, y, z] = DVec3::AXES.map(|a| a * size);
    let [nx, ny, nz] = cells;
    let sides = [
        sheet(low, y, x, [ny, nx]),
        sheet(low + z, x, y, [nx, ny]),
        sheet(low, x, z, [nx, nz]),
        sheet(low + y, z, x, [nz, nx]),
        sheet(low, z, y, [nz, ny]),
        sheet(low + x, y, z, [ny, nz]),
    ];
    sides.concat()
}

fn bar() -> Vec<[DVec3; 3]> {
    block(DVec3::ZERO, SIZE, [10, 4, 2])
}

/// A pseudo-random number in 0..1, the same on each run.
fn noise(k: u32) -> f64 {
    (f64::from(k) * 0.618_033_988_749_895 + 0.37).fract()
}

fn noise_point(k: u32) -> DVec3 {
    DVec3::new(noise(3 * k), noise(3 * k + 1), noise(3 * k + 2))
}

/// The kinds of defects, each with the least number of shells that should be removed.
fn dirty() -> Vec<(&'static str, TriMesh, usize)> {
    let with = |more: Vec<[DVec3; 3]>| welded(&[bar(), more].concat());
    let flipped = |t: &[DVec3; 3]| [t[0], t[2], t[1]];
    let two_sided = |one: Vec<[DVec3; 3]>| {
        let back: Vec<_> = one.iter().map(flipped).collect();
        [one, back].concat()
    };
    let facet =
        |k: u32, at: DVec3| [at, at + 4.0 * (noise_point(k) - 0.5), at + 4.0 * (noise_point(k + 500) - 0.5)];
    let outside = |k: u32| DVec3::new(-8.0, 20.0, 9.0) + noise_point(k) * 5.0;
    let mut doubled = bar();
    doubled.extend_from_within(20..24);
    let mut turned = bar();
    turned[30] = flipped(&turned[30]);
    let mut holed = bar();
    holed.remove(17);
    let mut flat_facets = bar();
    for k in 0..40 {
        let [a, b, _] = flat_facets[2 * k];
        flat_facets.push([a, b, b]);
    }
    vec![
        ("stray facets beside the body", with((0..178).map(|k| facet(k, outside(k))).collect()), 1),
        ("stray facets within the body", with((0..40).map(|k| facet(k, SIZE / 2.0)).collect()), 1),
        (
            "a sheet of two sides beside the body",
            with(two_sided(sheet(DVec3::new(0.0, 30.0, 0.0), DVec3::X * 40.0, DVec3::Z * 20.0, [4, 4]))),
            1,
        ),
        (
            "a sheet of two sides within the body",
            with(two_sided(sheet(DVec3::new(5.0, 6.1, 1.0), DVec3::X * 20.0, DVec3::Z * 4.0, [3, 2]))),
            1,
        ),
        (
            "boxes a hundred-millionth of a millimetre thick",
            with(
                (0..20)
                    .flat_map(|k| {
                        block(outside(k) + DVec3::Z * f64::from(k), DVec3::new(9.0, 7.0, 1e-8), [1; 3])
                    })
                    .collect(),
            ),
            20,
        ),
        ("specks", with((0..178).flat_map(|k| block(outside(k), DVec3::splat(2e-3), [1; 3])).collect()), 100),
        ("facets twice", welded(&doubled), 0),
        ("a facet turned over", welded(&turned), 0),
        ("a facet missing", welded(&holed), 0),
        ("facets without area", welded(&flat_facets), 0),
        ("a flap on an edge", with(vec![[DVec3::ZERO, DVec3::X * 3.0, DVec3::new(0.0, -4.0, -4.0)]]), 0),
    ]
}

/// Displacement of the free end along z under a force there, mm.
fn deflection_mm(found: &Meshed) -> f64 {
    let tets = &found.mesh;
    let faces = |x: f64| -> Vec<usize> {
        let near = |f: &usize| {
            tets.faces[*f].nodes[..3].iter().all(|&n| (tets.nodes[n as usize].x - x).abs() < 0.05)
        };
        (0..tets.faces.len()).filter(near).collect()
    };
    let mut supports = Supports::new(tets.nodes.len());
    for node in tets.nodes_of(&faces(0.0)) {
        supports.fix(tets, node).expect("held once");
    }
    let mut load = vec![DVec3::ZERO; tets.nodes.len()];
    nodal_forces::add_force(&mut load, tets, &faces(SIZE.x), DVec3::new(0.0, 0.0, -10.0));
    let model = Model::uniform(tets, isotropic(2000.0, 0.3));
    let (solutions, _) = solve(&model, &supports, &[load], &SolveSettings::default()).expect("held");
    solutions[0].displacement.iter().map(|u| -u.z).fold(0.0, f64::max)
}

#[test]
fn dirty_surfaces_bend_as_the_sound_one() {
    let settings = MeshSettings { size_mm: Some(ELEMENT_MM), ..MeshSettings::default() };
    let sound = mesh(&welded(&bar()), &settings).expect("a sound bar");
    assert_eq!(sound.n_flat_shells, 0);
    let want_mm = deflection_mm(&sound);
    for (name, surface, n_removed) in dirty() {
        let found = mesh(&surface, &settings).unwrap_or_else(|e| panic!("{name}: {e}"));
        let off = found.volume_mm3 / VOLUME_MM3 - 1.0;
        let bend = deflection_mm(&found) / want_mm - 1.0;
        println!(
            "{name}: {} shells taken out, volume {:+.2} %, deflection {:+.2} %, wall {:.2} mm",
            found.n_flat_shells,
            100.0 * off,
            100.0 * bend,
            found.wall_mm
        );
        assert!(found.n_flat_shells >= n_removed, "{name}: {}", found.n_flat_shells);
        assert!(off.abs() < 0.02 && bend.abs() < 0.03, "{name}: volume {off}, deflection {bend}");
    }
}

#[test]
fn dirt_does_not_renumber_the_facets_that_loads_name() {
    let speck = block(DVec3::new(-5.0, 0.0, 0.0), DVec3::splat(2e-3), [1; 3]);
    let surface = welded(&[speck, bar()].concat());
    let found = mesh(&surface, &MeshSettings { size_mm: Some(ELEMENT_MM), ..MeshSettings::default() });
    let found = found.expect("a sound bar and a speck");
    let triangles = triangles_of(&surface);
    for face in &found.mesh.faces {
        let [a, b, c] = triangles[face.facet as usize];
        let normal = (b - a).cross(c - a).normalize();
        let foot = face.foot.expect("made from a surface");
        assert!(face.facet >= 12 && (foot - a).dot(normal).abs() < 1e-9, "{}", face.facet);
    }
}

#[test]
fn a_refusal_names_a_size_that_is_accepted() {
    let plate = block(DVec3::ZERO, DVec3::new(60.0, 40.0, 0.5), [1; 3]);
    for surface in as_it_is_and_turned(&plate) {
        let coarse = |max_mib| MeshSettings { size_mm: Some(8.0), max_mib, ..MeshSettings::default() };
        let refused = mesh(&surface, &coarse(4096.0)).expect_err("walls of half a millimetre");
        let SolidError::ThinWalls { fitting_mm: Some(fitting_mm), .. } = refused else { panic!("{refused}") };
        println!("{refused}");
        let again = MeshSettings { size_mm: Some(fitting_mm), ..MeshSettings::default() };
        let found = mesh(&surface, &again).expect("the size that the refusal names");
        assert!((found.volume_mm3 / 1200.0 - 1.0).abs() < 0.02, "{}", found.volume_mm3);
        // The refusal names a limit that no size can meet.
        let refused = mesh(&surface, &coarse(0.5)).expect_err("walls of half a millimetre");
        assert!(matches!(refused, SolidError::ThinWalls { fitting_mm: None, .. }), "{refused}");
    }
}

#[test]
fn a_mesh_that_memory_cannot_solve_is_refused_before_it_is_made() {
    let part = block(DVec3::ZERO, DVec3::new(20.0, 12.0, 6.0), [1; 3]);
    for surface in as_it_is_and_turned(&part) {
        let sized =
            |size_mm| MeshSettings { size_mm: Some(size_mm), max_mib: 64.0, ..MeshSettings::default() };
        let refused = mesh(&surface, &sized(0.5)).expect_err("64 MiB hold elements of 0.8 mm");
        let SolidError::Memory { need_mib, fitting_mm, .. } = refused else { panic!("{refused}") };
        let mib = |found: &Meshed| 1250.0 * found.mesh.nodes.len() as f64 / f64::from(1 << 20);
        // What the elements take, and what those take that the refusal names.
        let free = MeshSettings { max_mib: f64::INFINITY, ..sized(0.5) };
        let made = mib(&mesh(&surface, &free).expect("elements of half a millimetre"));
        println!("{need_mib} MiB told, {made} made, elements of {fitting_mm} mm fit");
        assert!((need_mib / made - 1.0).abs() < 0.1, "{need_mib} told, {made} made");
        let made = mib(&mesh(&surface, &sized(fitting_mm)).expect("the size that the refusal names"));
        assert!(made <= 64.0 && made > 50.0, "{made} MiB");
    }
}
