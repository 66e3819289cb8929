//! Examples made by our own code.

mod hub;
mod stress_lines;
mod tree_support;
mod woodgrain;

use std::borrow::Cow;

use grainpath_core::math::direction;
use grainpath_core::{DVec2, DVec3, TriMesh};

/// A file of an example: its name and its content.
pub type ExampleFile = (Cow<'static, str>, Vec<u8>);

/// Names that [`preset`] knows.
pub const PRESETS: [&str; 5] = ["plate", "stress-lines", "ct", "woodgrain", "tree-support"];

/// The files of a preset; `None` for an unknown name.
pub fn preset(name: &str) -> Option<Vec<ExampleFile>> {
    match name {
        "plate" => Some(vec![
            ("job.toml".into(), include_bytes!("../../profiles/examples/plate.toml").to_vec()),
            ("plate.stl".into(), stl(&plate())),
        ]),
        "stress-lines" => Some(stress_lines::files()),
        "woodgrain" => Some(woodgrain::files()),
        "tree-support" => Some(tree_support::files()),
        "ct" => Some(ct(256)),
        _ => None,
    }
}

/// The wheel hub scanned with `n` x `n` pixels a slice, its true dimensions, and the job.
pub fn ct(n: usize) -> Vec<ExampleFile> {
    let (size, mm) = hub::lattice(n);
    let mut tif = Vec::with_capacity(size.iter().product::<usize>() * 2 + size[2] * 400);
    grainpath_io::volume::write_tiff_stack(size, [mm; 3], |k| hub::slice(n, k), &mut tif)
        .expect("memory takes all that is written");
    vec![
        ("job.toml".into(), include_bytes!("../../profiles/examples/ct.toml").to_vec()),
        ("hub.tif".into(), tif),
        ("truth.toml".into(), hub::truth().into_bytes()),
    ]
}

fn stl(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    grainpath_io::write_stl(mesh, &mut bytes).expect("memory takes all that is written");
    bytes
}

/// A mounting plate, 80 x 50 x 6 mm, with rounded corners, four bolt holes, a slot, and a thin rib on top.
pub fn plate() -> TriMesh {
    let corners: Vec<DVec2> = [(76.0, 46.0, 0), (4.0, 46.0, 1), (4.0, 4.0, 2), (76.0, 4.0, 3)]
        .into_iter()
        .flat_map(|(x, y, quarter)| arc(DVec2::new(x, y), 4.0, quarter, 1, 8))
        .collect();
    let bolts = [(10.0, 10.0), (70.0, 10.0), (70.0, 40.0), (10.0, 40.0)];
    let mut holes: Vec<Vec<DVec2>> =
        bolts.into_iter().map(|(x, y)| arc(DVec2::new(x, y), 2.75, 0, 4, 12)).collect();
    let slot = arc(DVec2::new(50.0, 25.0), 5.0, 3, 2, 12).into_iter();
    holes.push(slot.chain(arc(DVec2::new(30.0, 25.0), 5.0, 1, 2, 12)).collect());
    let mut mesh = TriMesh::default();
    prism(&corners, &holes, 0.0, 6.0, &mut mesh);
    // The rib reaches into the plate: bodies that overlap are united.
    let rib = [(20.0, 34.0), (60.0, 34.0), (60.0, 35.2), (20.0, 35.2)].map(DVec2::from);
    prism(&rib, &[], 5.0, 12.0, &mut mesh);
    mesh
}

/// Points of `n_quarters` quarters of a circle, counter-clockwise.
pub(crate) fn arc(
    centre: DVec2,
    radius: f64,
    first_quarter: i32,
    n_quarters: i32,
    per_quarter: i32,
) -> Vec<DVec2> {
    let whole = i32::from(n_quarters < 4);
    (0..n_quarters * per_quarter + whole)
        .map(|i| {
            let turn = f64::from(first_quarter) + f64::from(i) / f64::from(per_quarter);
            centre + direction(turn * std::f64::consts::FRAC_PI_2) * radius
        })
        .collect()
}

/// Adds a prism over an outline with holes, all given counter-clockwise.
pub(crate) fn prism(outline: &[DVec2], holes: &[Vec<DVec2>], low: f64, high: f64, mesh: &mut TriMesh) {
    let ring = bridged(outline, holes);
    let first = mesh.vertices.len() as u32;
    let mut vertex = |p: DVec2, z: f64| {
        let p = p.extend(z);
        let known = mesh.vertices[first as usize..].iter().position(|q| *q == p);
        known.map_or_else(
            || {
                mesh.vertices.push(p);
                mesh.vertices.len() as u32 - 1
            },
            |i| first + i as u32,
        )
    };
    let mut triangles = Vec::new();
    for [a, b, c] in ears(&ring) {
        let top = [a, b, c].map(|p| vertex(p, high));
        let bottom = [a, c, b].map(|p| vertex(p, low));
        triangles.extend([top, bottom]);
    }
    let mut side = |a: DVec2, b: DVec2| {
        let [p, q, r, s] = [(a, low), (b, low), (b, high), (a, high)].map(|(p, z)| vertex(p, z));
        triangles.extend([[p, q, r], [p, r, s]]);
    };
    grainpath_core::poly::edges(outline).for_each(|(a, b)| side(a, b));
    for hole in holes {
        grainpath_core::poly::edges(hole).for_each(|(a, b)| side(b, a));
    }
    mesh.triangles.extend(triangles);
    debug_assert!(mesh.vertices.iter().all(|v: &DVec3| v.is_finite()));
}

/// An outline with its holes joined to it by cuts, so that it is one ring.
fn bridged(outline: &[DVec2], holes: &[Vec<DVec2>]) -> Vec<DVec2> {
    let mut ring = outline.to_vec();
    let right = |h: &Vec<DVec2>| {
        (0..h.len()).max_by(|&i, &j| h[i].x.total_cmp(&h[j].x).then(h[j].y.total_cmp(&h[i].y))).unwrap_or(0)
    };
    let mut order: Vec<&Vec<DVec2>> = holes.iter().collect();
    order.sort_by(|a, b| b[right(b)].x.total_cmp(&a[right(a)].x));
    for hole in order {
        let start = right(hole);
        let from = hole[start];
        // The nearest ring vertex to the right that can be seen without crossing the ring.
        let mut candidates: Vec<usize> = (0..ring.len()).collect();
        candidates
            .sort_by(|&i, &j| ring[i].distance_squared(from).total_cmp(&ring[j].distance_squared(from)));
        let crosses = |to: DVec2| {
            grainpath_core::poly::edges(&ring).any(|(a, b)| {
                let side = |p: DVec2, q: DVec2, r: DVec2| grainpath_core::math::cross(q - p, r - p);
                side(from, to, a) * side(from, to, b) < 0.0 && side(a, b, from) * side(a, b, to) < 0.0
            })
        };
        let seen = |i: &usize| ring[*i].x >= from.x && !crosses(ring[*i]);
        let to = candidates.into_iter().find(seen).unwrap_or(0);
        // Clockwise around the hole and back along the cut.
        let around = (0..=hole.len()).map(|k| hole[(start + hole.len() - k % hole.len()) % hole.len()]);
        let insert: Vec<DVec2> = around.chain([ring[to]]).collect();
        ring.splice(to + 1..to + 1, insert);
    }
    ring
}

/// Cuts a ring, counter-clockwise and perhaps touching itself, into triangles.
fn ears(ring: &[DVec2]) -> Vec<[DVec2; 3]> {
    let turn = |a: DVec2, b: DVec2, c: DVec2| grainpath_core::math::cross(b - a, c - a);
    let mut rest = ring.to_vec();
    let mut out = Vec::new();
    while rest.len() > 3 {
        let n = rest.len();
        let ear = (0..n).find(|&i| {
            let (a, b, c) = (rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]);
            let inside = |&p: &DVec2| {
                p != a
                    && p != b
                    && p != c
                    && turn(a, b, p) >= 0.0
                    && turn(b, c, p) >= 0.0
                    && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 1e-12 && !rest.iter().any(inside)
        });
        let i = ear.unwrap_or(0);
        let corner = [rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]];
        if turn(corner[0], corner[1], corner[2]) > 1e-12 {
            out.push(corner);
        }
        rest.remove(i);
    }
    out.push([rest[0], rest[1], rest[2]]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn the_plate_is_closed_and_has_its_volume() {
        let mesh = plate();
        let health = diagnose(&mesh).expect("triangles");
        assert!(health.is_closed() && health.shells == 2, "{health:?}");
        let pi = std::f64::consts::PI;
        let area = 80.0 * 50.0 - (4.0 - pi) * 16.0 - 4.0 * pi * 2.75 * 2.75 - pi * 25.0 - 20.0 * 10.0;
        let volume = area * 6.0 + 40.0 * 1.2 * 7.0;
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 2e-3, "{} {volume}", mesh.signed_volume());
    }
}
