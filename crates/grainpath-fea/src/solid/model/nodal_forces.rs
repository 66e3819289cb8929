//! Loads as consistent nodal forces, N: tractions and body forces integrated against the shape
//! functions.
//!
//! Lengths are in mm, stresses in MPa. Faces are curved, so points, normals and areas come from the
//! quadratic map.

use grainpath_core::bvh::Bvh;
use grainpath_core::{DMat3, DVec3, TriMesh};

use super::error::SolidError;
use super::material_map::Model;
use super::quadratic_tet::{self as element, FINE_RULE, STIFFNESS_RULE};
use super::tet_mesh::{Face, TetMesh};

/// Quadrature of a triangle with seven points, exact for degree 5; the weights add up to one half.
/// Source: `radon1948`.
const FACE_RULE: [([f64; 3], f64); 7] = {
    // Source: `radon1948`: (6 - sqrt 15) / 21.
    const A: f64 = 0.101_286_507_323_456_3;
    // Source: `radon1948`: (9 + 2 sqrt 15) / 21.
    const B: f64 = 0.797_426_985_353_087_3;
    // Source: `radon1948`: (6 + sqrt 15) / 21.
    const C: f64 = 0.470_142_064_105_115_1;
    // Source: `radon1948`: (9 - 2 sqrt 15) / 21.
    const D: f64 = 0.059_715_871_789_769_8;
    // Source: `radon1948`: (155 - sqrt 15) / 2400.
    const W: f64 = 0.062_969_590_272_413_6;
    // Source: `radon1948`: (155 + sqrt 15) / 2400.
    const V: f64 = 0.066_197_076_394_253_1;
    [
        ([1.0 / 3.0; 3], 0.1125),
        ([B, A, A], W),
        ([A, B, A], W),
        ([A, A, B], W),
        ([D, C, C], V),
        ([C, D, C], V),
        ([C, C, D], V),
    ]
};

/// Shape functions, and their derivatives by the second and third barycentric coordinates.
fn face_shapes([a, b, c]: [f64; 3]) -> ([f64; 6], [[f64; 2]; 6]) {
    let n = [
        a * (2.0 * a - 1.0),
        b * (2.0 * b - 1.0),
        c * (2.0 * c - 1.0),
        4.0 * a * b,
        4.0 * b * c,
        4.0 * c * a,
    ];
    let slopes = [
        [1.0 - 4.0 * a, 1.0 - 4.0 * a],
        [4.0 * b - 1.0, 0.0],
        [0.0, 4.0 * c - 1.0],
        [4.0 * (a - b), -4.0 * b],
        [4.0 * c, 4.0 * b],
        [-4.0 * c, 4.0 * (a - c)],
    ];
    (n, slopes)
}

/// Calls `at(face nodes, shape values, position, outward area vector)` at every point of the rule
/// on some faces.
fn over_faces(mesh: &TetMesh, faces: &[usize], mut at: impl FnMut(&[u32; 6], &[f64; 6], DVec3, DVec3)) {
    for &f in faces {
        let nodes = &mesh.faces[f].nodes;
        let x = nodes.map(|i| mesh.nodes[i as usize]);
        for (l, w) in &FACE_RULE {
            let (n, slopes) = face_shapes(*l);
            let mut sides = [DVec3::ZERO; 2];
            let mut p = DVec3::ZERO;
            for (k, &q) in x.iter().enumerate() {
                p += q * n[k];
                sides[0] += q * slopes[k][0];
                sides[1] += q * slopes[k][1];
            }
            // The cross product of both tangents is the area per unit area of the reference
            // triangle. The area of that triangle is one half, as is the sum of the weights.
            at(nodes, &n, p, sides[0].cross(sides[1]) * *w);
        }
    }
}

/// Area of some faces of the boundary, mm2.
pub fn area_mm2(mesh: &TetMesh, faces: &[usize]) -> f64 {
    let mut area = 0.0;
    over_faces(mesh, faces, |_, _, _, a| area += a.length());
    area
}

/// Centroid of some faces of the boundary, mm; the origin for faces without area.
pub fn centroid_mm(mesh: &TetMesh, faces: &[usize]) -> DVec3 {
    let (mut area, mut sum) = (0.0, DVec3::ZERO);
    over_faces(mesh, faces, |_, _, p, a| {
        area += a.length();
        sum += p * a.length();
    });
    if area > 0.0 { sum / area } else { DVec3::ZERO }
}

/// Adds the forces of a traction: a function of a point and its outward unit normal that returns MPa.
pub fn add_traction(
    forces: &mut [DVec3],
    mesh: &TetMesh,
    faces: &[usize],
    traction_mpa: impl Fn(DVec3, DVec3) -> DVec3,
) {
    over_faces(mesh, faces, |nodes, n, p, area| {
        let f = traction_mpa(p, area.normalize_or_zero()) * area.length();
        for (&i, n) in nodes.iter().zip(n) {
            forces[i as usize] += f * *n;
        }
    });
}

/// Adds a pressure in MPa, positive inwards.
pub fn add_pressure(forces: &mut [DVec3], mesh: &TetMesh, faces: &[usize], pressure_mpa: f64) {
    add_traction(forces, mesh, faces, |_, normal| -normal * pressure_mpa);
}

/// Adds a total force in N, spread evenly over the area.
pub fn add_force(forces: &mut [DVec3], mesh: &TetMesh, faces: &[usize], force_n: DVec3) {
    let area = area_mm2(mesh, faces);
    if area > 0.0 {
        add_traction(forces, mesh, faces, |_, _| force_n / area);
    }
}

/// Adds a pure moment in N mm about the middle of the faces, by tractions that grow with the
/// distance from the axis. No force is added where the faces are too small to carry a moment.
pub fn add_moment(forces: &mut [DVec3], mesh: &TetMesh, faces: &[usize], moment_nmm: DVec3) {
    let (mut area, mut middle) = (0.0, DVec3::ZERO);
    over_faces(mesh, faces, |_, _, p, a| {
        area += a.length();
        middle += p * a.length();
    });
    middle /= area;
    // The area's inertia tensor relates the moment to the rotation whose displacements serve as
    // tractions.
    let mut inertia = DMat3::ZERO;
    over_faces(mesh, faces, |_, _, p, a| {
        let r = p - middle;
        let square = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(r.length_squared())) - square) * a.length();
    });
    let turn = inertia.inverse() * moment_nmm;
    // Faces without extent make the tensor singular.
    if turn.is_finite() {
        add_traction(forces, mesh, faces, |p, _| turn.cross(p - middle));
    }
}

/// Adds the force of a pin against the wall of a hole, N: a pressure that falls with the cosine of the angle
/// between the wall's normal and the force, over the half of the wall that the pin pushes on. The part of
/// the force that a pressure on this wall cannot carry, such as a force along the hole, is spread evenly.
///
/// The wall has to face the force ([`faces_force`]).
///
/// Source: the peak of the pressure is `2 F / (pi r L)`, the usual bearing load of a pin without play
/// (`shigley2015`).
pub(crate) fn add_bearing(forces: &mut [DVec3], mesh: &TetMesh, faces: &[usize], force_n: DVec3) {
    let Some(along) = force_n.try_normalize() else { return };
    // The pin pushes where the outward normal of the part points against the force.
    let unit = |_: DVec3, normal: DVec3| -normal * (-normal.dot(along)).max(0.0);
    let mut shape = vec![DVec3::ZERO; forces.len()];
    add_traction(&mut shape, mesh, faces, unit);
    let carried: DVec3 = shape.iter().sum();
    let size = force_n.length() / carried.dot(along);
    // Without a wall that faces the force there is nothing to press on.
    if !size.is_finite() || size <= 0.0 {
        return;
    }
    forces.iter_mut().zip(&shape).for_each(|(f, s)| *f += *s * size);
    // The mesh of the wall is not quite symmetric about the force, so a small part of it is still missing.
    add_force(forces, mesh, faces, force_n - carried * size);
}

/// Whether a pin can press on faces with this force: whether enough of their area faces the force, and whether the resultant
/// of the pressure leans by at most 60 degrees from it. Each face is given by its area and the outward normal of the part below
/// it; faces that round off an edge would face directions that the part does not.
pub(crate) fn faces_force(faces: impl Iterator<Item = (f64, DVec3)>, force_n: DVec3) -> bool {
    /// Least area that faces the force, weighted by the squared cosine, as a share of all area.
    /// Source: derived: the wall of a round hole has 1/4, and 1/16 if the force leans by 60 degrees. A place a little wider than the
    /// hole also holds rings around its ends, which have 1/50 for a force along it.
    const LEAST_SHARE: f64 = 0.05;
    /// Least cosine between the force and the resultant of the pressure. Source: derived: at 60 degrees, the wall takes half of
    /// the force; what is along the hole is friction, of which a pin bears less than that.
    const LEAST_COS: f64 = 0.5;
    let Some(along) = force_n.try_normalize() else { return true };
    let (mut all, mut pressed) = (0.0, DVec3::ZERO);
    for (area, normal) in faces {
        all += area;
        pressed -= normal * ((-normal.dot(along)).max(0.0) * area);
    }
    let taken = pressed.dot(along);
    taken >= LEAST_SHARE * all && taken >= LEAST_COS * pressed.length() && taken > 0.0
}

/// Adds tractions in MPa where `traction` returns one. Their sum may fall short of a force in N and of a moment about the
/// origin in N mm; the difference is spread evenly over the same faces. Returns the area on which the tractions act, mm2.
pub(crate) fn add_carried(
    forces: &mut [DVec3],
    mesh: &TetMesh,
    traction: impl Fn(DVec3, DVec3) -> Option<DVec3>,
    (force_n, moment_nmm): (DVec3, DVec3),
) -> f64 {
    let mut raw = vec![DVec3::ZERO; forces.len()];
    let (mut faces, mut covered) = (Vec::new(), 0.0);
    for f in 0..mesh.faces.len() {
        let before = covered;
        over_faces(mesh, &[f], |nodes, n, p, area| {
            let Some(t) = traction(p, area.normalize_or_zero()) else { return };
            covered += area.length();
            for (&i, n) in nodes.iter().zip(n) {
                raw[i as usize] += t * area.length() * *n;
            }
        });
        if covered > before {
            faces.push(f);
        }
    }
    if faces.is_empty() {
        return 0.0;
    }
    complete(&mut raw, mesh, &faces, (force_n, moment_nmm));
    forces.iter_mut().zip(raw).for_each(|(f, r)| *f += r);
    covered
}

/// The corners of a face, mm.
fn corners(mesh: &TetMesh, face: &Face) -> [DVec3; 3] {
    [0, 1, 2].map(|k| mesh.nodes[face.nodes[k] as usize])
}

/// The faces of the boundary as flat triangles, to look up the nearest one.
pub(crate) fn flat_faces(mesh: &TetMesh) -> Bvh {
    Bvh::new(&TriMesh {
        vertices: mesh.faces.iter().flat_map(|face| corners(mesh, face)).collect(),
        triangles: (0..mesh.faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    })
}

/// Adds forces in N at points of the surface. Each is distributed to the nodes of the nearest face by the shape functions.
/// Moving a force onto the face changes its moment; the difference is spread over the faces concerned.
pub(crate) fn add_points(forces: &mut [DVec3], mesh: &TetMesh, points: &[(DVec3, DVec3)]) {
    let search = flat_faces(mesh);
    let mut raw = vec![DVec3::ZERO; forces.len()];
    let mut faces = Vec::new();
    let (mut force_n, mut moment_nmm) = (DVec3::ZERO, DVec3::ZERO);
    for &(p, force) in points {
        let Some(found) = search.closest_point(p, f64::INFINITY) else { return };
        let face = &mesh.faces[found.triangle as usize];
        let [a, b, c] = corners(mesh, face);
        let (u, v, w) = (b - a, c - a, found.point - a);
        let area = u.cross(v);
        let square = area.length_squared().max(f64::MIN_POSITIVE);
        let (second, third) = (w.cross(v).dot(area) / square, u.cross(w).dot(area) / square);
        let (shapes, _) = face_shapes([1.0 - second - third, second, third]);
        for (&i, n) in face.nodes.iter().zip(shapes) {
            raw[i as usize] += force * n;
        }
        force_n += force;
        moment_nmm += p.cross(force);
        faces.push(found.triangle as usize);
    }
    faces.sort_unstable();
    faces.dedup();
    complete(&mut raw, mesh, &faces, (force_n, moment_nmm));
    forces.iter_mut().zip(raw).for_each(|(f, r)| *f += r);
}

/// Adds what the sums of `forces` lack of a given force (N) and moment about the origin (N mm), spread over faces.
fn complete(forces: &mut [DVec3], mesh: &TetMesh, faces: &[usize], (force_n, moment_nmm): (DVec3, DVec3)) {
    let sums = |forces: &[DVec3]| {
        forces
            .iter()
            .zip(&mesh.nodes)
            .fold((DVec3::ZERO, DVec3::ZERO), |(sum, moment), (f, p)| (sum + *f, moment + p.cross(*f)))
    };
    let missing = force_n - sums(forces).0;
    add_force(forces, mesh, faces, missing);
    // The sum of the forces is now complete, so the missing moment is the same about every point.
    let missing = moment_nmm - sums(forces).1;
    add_moment(forces, mesh, faces, missing);
}

/// Adds a torque in N mm about an axis (a point on it and a unit vector), by tractions perpendicular to
/// the radius that grow with the distance. Faces on one side of the axis alone would also make a net
/// force, which is subtracted evenly.
pub(crate) fn add_torque(
    forces: &mut [DVec3],
    mesh: &TetMesh,
    faces: &[usize],
    (point, axis): (DVec3, DVec3),
    torque_nmm: f64,
) {
    let mut shape = vec![DVec3::ZERO; forces.len()];
    add_traction(&mut shape, mesh, faces, |p, _| axis.cross(p - point));
    let net: DVec3 = shape.iter().sum();
    add_force(&mut shape, mesh, faces, -net);
    let moment: f64 = shape.iter().zip(&mesh.nodes).map(|(f, p)| (*p - point).cross(*f).dot(axis)).sum();
    // Faces that all lie on the axis carry no torque.
    if moment > 0.0 {
        forces.iter_mut().zip(&shape).for_each(|(f, s)| *f += *s * (torque_nmm / moment));
    }
}

/// Adds a force per volume, N/mm3, at each point: gravity is density times acceleration, 1e-9 g/mm2 t/mm3.
pub fn add_body_force(forces: &mut [DVec3], mesh: &TetMesh, force_n_mm3: impl Fn(DVec3) -> DVec3) {
    for tet in &mesh.tets {
        let x = tet.map(|i| mesh.nodes[i as usize]);
        for (l, w) in &FINE_RULE {
            let n = element::shapes(l);
            let p: DVec3 = x.iter().zip(&n).map(|(p, n)| *p * *n).sum();
            let (_, det) = element::gradients(&x, l);
            let f = force_n_mm3(p) * (w * det);
            for (&i, n) in tet.iter().zip(&n) {
                forces[i as usize] += f * *n;
            }
        }
    }
}

/// Adds the forces of strains that no stress causes, such as heat or shrinkage. The strains are
/// given at a point, in the order xx, yy, zz, xy, yz, zx with engineering shears.
///
/// # Errors
/// A material whose stiffness is not positive definite.
pub fn add_initial_strain(
    forces: &mut [DVec3],
    model: &Model<'_>,
    strain: impl Fn(DVec3) -> [f64; 6],
) -> Result<(), SolidError> {
    let laws = model.laws()?;
    for (t, tet) in model.mesh.tets.iter().enumerate() {
        let x = model.mesh.places(t);
        for (l, w) in &STIFFNESS_RULE {
            let n = element::shapes(l);
            let p: DVec3 = x.iter().zip(&n).map(|(p, n)| *p * *n).sum();
            let (g, det) = element::gradients(&x, l);
            let stress = laws[model.material(t)].stress_of_strain(&strain(p));
            for (&i, g) in tet.iter().zip(&g) {
                forces[i as usize] += stress * *g * (w * det);
            }
        }
    }
    Ok(())
}
