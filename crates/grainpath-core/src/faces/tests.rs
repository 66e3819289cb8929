//! Parts with known faces, written as an exporter would at several chord errors.

use std::f64::consts::{PI, TAU};

use super::*;
use crate::hash::unit_interval;
use crate::math::{acos, sin_cos};
use crate::mesh::VertexWelder;
use crate::triangulation::Triangulation;
use crate::{Contour, DVec2, Polygon, Region};

/// A mesh with the true face of each triangle, and the kind of each true face.
#[derive(Clone, Default)]
struct Part {
    mesh: TriMesh,
    truth: Vec<usize>,
    kinds: Vec<&'static str>,
}

/// A contour: corners, each with the face of the side that starts there.
type Outline = Vec<(DVec2, usize)>;

/// Collects faces while a contour is drawn.
struct Draw {
    chord_mm: f64,
    kinds: Vec<&'static str>,
    line: Outline,
}

impl Draw {
    fn new(chord_mm: f64) -> Self {
        Self { chord_mm, kinds: Vec::new(), line: Vec::new() }
    }

    fn face(&mut self, kind: &'static str) -> usize {
        self.kinds.push(kind);
        self.kinds.len() - 1
    }

    /// A side from this point to the next one.
    fn side(&mut self, x: f64, y: f64, kind: &'static str) {
        let face = self.face(kind);
        self.line.push((DVec2::new(x, y), face));
    }

    /// An arc that turns by `turn_rad` from `from_rad`; its last point is that of the next side.
    fn arc(&mut self, centre: DVec2, radius: f64, from_rad: f64, turn_rad: f64, kind: &'static str) {
        let face = self.face(kind);
        // As exporters do: the chord error, and at most 30 degrees to a facet.
        let step = (2.0 * acos(1.0 - (self.chord_mm / radius).min(0.5))).min(PI / 6.0);
        let n = (turn_rad.abs() / step - 1e-9).ceil();
        for i in 0..n as usize {
            let (s, c) = sin_cos(from_rad + turn_rad * i as f64 / n);
            self.line.push((centre + radius * DVec2::new(c, s), face));
        }
    }

    fn done(&mut self) -> Outline {
        std::mem::take(&mut self.line)
    }
}

struct Builder {
    welder: VertexWelder,
    triangles: Vec<[u32; 3]>,
    truth: Vec<usize>,
}

impl Builder {
    fn new() -> Self {
        Self { welder: VertexWelder::with_capacity(64), triangles: Vec::new(), truth: Vec::new() }
    }

    fn triangle(&mut self, corners: [DVec3; 3], face: usize) {
        let t = corners.map(|p| self.welder.index(p).expect("few"));
        if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
            self.triangles.push(t);
            self.truth.push(face);
        }
    }

    fn part(self, kinds: Vec<&'static str>) -> Part {
        let mesh = TriMesh { vertices: self.welder.into_vertices(), triangles: self.triangles };
        Part { mesh, truth: self.truth, kinds }
    }
}

/// A prism over contours, the first counter-clockwise, holes clockwise.
fn extruded(draw: Draw, contours: &[Outline], height: f64) -> Part {
    let mut kinds = draw.kinds;
    let (bottom, top) = (kinds.len(), kinds.len() + 1);
    kinds.extend(["plane", "plane"]);
    let points = |o: &Outline| -> Contour { o.iter().map(|p| p.0).collect() };
    let polygon = Polygon { outer: points(&contours[0]), holes: contours[1..].iter().map(points).collect() };
    let caps = Triangulation::plain(&Region { polygons: vec![polygon] }).expect("a region");
    let mut b = Builder::new();
    for t in &caps.triangles {
        let [p, q, r] = t.map(|i| caps.points[i as usize]);
        b.triangle([p, r, q].map(|p| p.extend(0.0)), bottom);
        b.triangle([p, q, r].map(|p| p.extend(height)), top);
    }
    for contour in contours {
        for (i, &(p, face)) in contour.iter().enumerate() {
            let q = contour[(i + 1) % contour.len()].0;
            b.triangle([p.extend(0.0), q.extend(0.0), q.extend(height)], face);
            b.triangle([p.extend(0.0), q.extend(height), p.extend(height)], face);
        }
    }
    b.part(kinds)
}

/// A body of revolution about z: radius and height of each corner, from the bottom axis to the top one.
fn revolved(draw: Draw, profile: &Outline) -> Part {
    let widest = profile.iter().map(|p| p.0.x).fold(0.0, f64::max);
    let step = (2.0 * acos(1.0 - (draw.chord_mm / widest).min(0.5))).min(PI / 6.0);
    let n = (TAU / step).ceil() as usize;
    let at = |p: DVec2, i: usize| {
        let (s, c) = sin_cos(TAU * (i % n) as f64 / n as f64);
        DVec3::new(p.x * c, p.x * s, p.y)
    };
    let mut b = Builder::new();
    for w in profile.windows(2) {
        for i in 0..n {
            let (p, q) = (w[0].0, w[1].0);
            b.triangle([at(p, i), at(p, i + 1), at(q, i + 1)], w[0].1);
            b.triangle([at(p, i), at(q, i + 1), at(q, i)], w[0].1);
        }
    }
    b.part(draw.kinds)
}

fn circle(d: &mut Draw, x: f64, y: f64, radius: f64) -> Outline {
    d.arc(DVec2::new(x, y), radius, 0.3, -TAU, "cylinder");
    d.done()
}

fn plate_with_holes(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (l, w) = (60.0 + 12.0 * k as f64, 40.0 + 5.0 * k as f64);
    for (x, y) in [(0.0, 0.0), (l, 0.0), (l, w), (0.0, w)] {
        d.side(x, y, "plane");
    }
    let mut all = vec![d.done()];
    for (x, y, r) in [(0.15, 0.2, 2.0), (0.5, 0.5, 6.0), (0.85, 0.2, 2.0), (0.85, 0.8, 3.2)] {
        all.push(circle(d, x * l, y * w, r + 0.3 * k as f64));
    }
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &all, 6.0 + k as f64)
}

fn l_bracket(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (a, t, r) = (50.0 + 10.0 * k as f64, 8.0 + k as f64, 4.0);
    d.side(0.0, 0.0, "plane");
    d.side(a, 0.0, "plane");
    d.side(a, t, "plane");
    d.arc(DVec2::new(t + r, t + r), r, -0.5 * PI, -0.5 * PI, "cylinder");
    d.side(t, t + r, "plane");
    d.side(t, a, "plane");
    d.arc(DVec2::new(0.5 * t, a), 0.5 * t, 0.0, PI, "cylinder");
    // The arc ends at (0, a), where the last side starts.
    d.side(0.0, a, "plane");
    let outer = d.done();
    let hole = circle(d, a - 9.0, 0.5 * t, 2.5);
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &[outer, hole], 20.0 + 3.0 * k as f64)
}

fn rounded_plate(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (l, w, r) = (45.0 + 9.0 * k as f64, 30.0, 3.0 + 2.0 * k as f64);
    let corners = [(l - r, r, -0.5), (l - r, w - r, 0.0), (r, w - r, 0.5), (r, r, 1.0)];
    for (x, y, from) in corners {
        d.arc(DVec2::new(x, y), r, from * PI, 0.5 * PI, "cylinder");
        let (s, c) = sin_cos((from + 0.5) * PI);
        d.side(x + r * c, y + r * s, "plane");
    }
    let outer = d.done();
    let hole = circle(d, 0.4 * l, 0.5 * w, 5.0);
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &[outer, hole], 5.0)
}

fn slotted(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (l, w) = (70.0, 35.0 + 6.0 * k as f64);
    for (x, y) in [(0.0, 0.0), (l, 0.0), (l, w), (0.0, w)] {
        d.side(x, y, "plane");
    }
    let outer = d.done();
    let (r, y) = (3.0 + k as f64, 0.5 * w);
    d.arc(DVec2::new(20.0, y), r, -0.5 * PI, -PI, "cylinder");
    d.side(20.0, y + r, "plane");
    d.arc(DVec2::new(50.0, y), r, 0.5 * PI, -PI, "cylinder");
    d.side(50.0, y - r, "plane");
    let slot = d.done();
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &[outer, slot], 12.0)
}

fn nut(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let r = 12.0 + 4.0 * k as f64;
    for i in 0..6 {
        let (s, c) = sin_cos(f64::from(i) * PI / 3.0);
        d.side(r * c, r * s, "plane");
    }
    let outer = d.done();
    let bore = circle(d, 0.0, 0.0, 0.5 * r);
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &[outer, bore], 8.0 + k as f64)
}

fn channel(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (w, h, t) = (40.0, 25.0 + 5.0 * k as f64, 3.0);
    for (x, y) in [(0.0, 0.0), (w, 0.0), (w, h), (w - t, h), (w - t, t), (t, t), (t, h), (0.0, h)] {
        d.side(x, y, "plane");
    }
    let outer = d.done();
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &[outer], 80.0)
}

fn d_shaft(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (r, half) = (8.0 + 3.0 * k as f64, 0.6);
    d.arc(DVec2::ZERO, r, half, TAU - 2.0 * half, "cylinder");
    let (s, c) = sin_cos(-half);
    d.side(r * c, r * s, "plane");
    let outer = d.done();
    extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &[outer], 50.0)
}

fn turned_pin(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let r = 10.0 + 2.0 * k as f64;
    d.side(0.0, 0.0, "plane");
    d.side(r, 0.0, "cylinder");
    d.side(r, 20.0, "cone");
    d.side(0.6 * r, 32.0, "cylinder");
    d.side(0.6 * r, 45.0, "plane");
    // A ball on a collar.
    let (ball, collar) = (0.9 * r, 0.5 * r);
    let half = crate::math::asin(collar / ball);
    let centre = DVec2::new(0.0, 45.0 + ball * crate::math::cos(half));
    d.arc(centre, ball, half - 0.5 * PI, PI - half, "sphere");
    d.side(0.0, centre.y + ball, "end");
    let profile = d.done();
    d.kinds.pop();
    revolved(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &profile)
}

fn bush(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (r, b, h) = (15.0 + 3.0 * k as f64, 7.0 + k as f64, 30.0);
    for (x, y, kind) in [
        (b, 0.0, "plane"),
        (r - 2.0, 0.0, "cone"),
        (r, 2.0, "cylinder"),
        (r, h - 3.0, "cone"),
        (r - 3.0, h, "plane"),
        (b, h, "cylinder"),
    ] {
        d.side(x, y, kind);
    }
    d.side(b, 0.0, "end");
    let profile = d.done();
    d.kinds.pop();
    revolved(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &profile)
}

fn filleted_knob(chord: f64, k: usize) -> Part {
    let d = &mut Draw::new(chord);
    let (r, f, h) = (18.0 + 2.0 * k as f64, 4.0, 22.0 + 3.0 * k as f64);
    d.side(0.0, 0.0, "plane");
    d.side(r, 0.0, "cylinder");
    d.arc(DVec2::new(r - f, h - f), f, 0.0, 0.5 * PI, "free");
    d.side(r - f, h, "plane");
    d.side(0.0, h, "end");
    let profile = d.done();
    d.kinds.pop();
    revolved(Draw { kinds: d.kinds.clone(), ..Draw::new(chord) }, &profile)
}

type Make = fn(f64, usize) -> Part;

const PARTS: [(&str, Make); 10] = [
    ("plate with holes", plate_with_holes),
    ("L bracket", l_bracket),
    ("rounded plate", rounded_plate),
    ("slotted block", slotted),
    ("nut", nut),
    ("channel", channel),
    ("D shaft", d_shaft),
    ("turned pin", turned_pin),
    ("bush", bush),
    ("filleted knob", filleted_knob),
];

/// For each true face the found face that has most of it, and the share of the area that is right:
/// the found face holds more of this face than of any other and has its kind.
fn compared(part: &Part, faces: &Faces) -> (Vec<usize>, f64) {
    let mut shared = vec![vec![0.0; faces.len()]; part.kinds.len()];
    let mut total = 0.0;
    for (i, t) in part.mesh.triangles.iter().enumerate() {
        let [a, b, c] = t.map(|v| part.mesh.vertices[v as usize]);
        let area = 0.5 * (b - a).cross(c - a).length();
        total += area;
        shared[part.truth[i]][faces.of_triangle(i).expect("a face")] += area;
    }
    let best = |values: &mut dyn Iterator<Item = f64>| {
        values.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).expect("not empty").0
    };
    let found: Vec<usize> = shared.iter().map(|row| best(&mut row.iter().copied())).collect();
    let right = |&(truth, face): &(usize, usize)| {
        let back = best(&mut shared.iter().map(|row| row[face]));
        back == truth && faces.all()[face].surface.word() == part.kinds[truth]
    };
    let pairs = found.iter().copied().enumerate();
    (found.clone(), pairs.filter(right).map(|(t, f)| shared[t][f]).sum::<f64>() / total)
}

#[test]
fn known_faces_are_found() {
    for (name, make) in PARTS {
        for chord in [0.01, 0.05, 0.2] {
            for k in 0..3 {
                let part = make(chord, k);
                let faces = Faces::segment(&part.mesh);
                let (_, right) = compared(&part, &faces);
                let words: Vec<_> = faces.all().iter().map(|f| f.surface.word()).collect();
                assert!(right >= 0.95, "{name} {k} at {chord} mm: {right:.3}, {words:?}");
            }
        }
    }
}

#[test]
fn measures_are_those_of_the_part() {
    let part = turned_pin(0.02, 0);
    let faces = Faces::segment(&part.mesh);
    let (found, _) = compared(&part, &faces);
    let surface = |k: usize| faces.all()[found[k]].surface;
    let Surface::Cylinder { radius_mm, axis, hollow, .. } = surface(1) else { panic!("{:?}", surface(1)) };
    assert!((radius_mm - 10.0).abs() < 1e-6 && axis.z > 1.0 - 1e-9 && !hollow);
    let Surface::Cone { half_angle_rad, axis, .. } = surface(2) else { panic!("{:?}", surface(2)) };
    assert!((half_angle_rad - crate::math::atan(4.0 / 12.0)).abs() < 1e-6 && axis.z < 1e-9 - 1.0);
    let Surface::Sphere { radius_mm, centre, .. } = surface(5) else { panic!("{:?}", surface(5)) };
    assert!((radius_mm - 9.0).abs() < 1e-6 && centre.truncate().length() < 1e-6);
    let holes = Faces::segment(&plate_with_holes(0.05, 0).mesh);
    let hollow = |f: &&Face| matches!(f.surface, Surface::Cylinder { hollow: true, .. });
    assert_eq!(holes.all().iter().filter(hollow).count(), 4);
}

/// The triangles in another order, each beginning with another corner.
fn shuffled(part: &Part, seed: u64) -> Part {
    let mut order: Vec<usize> = (0..part.truth.len()).collect();
    order.sort_by_key(|&i| crate::hash::splitmix64(i as u64 ^ (seed << 32)));
    let turn = |i: usize| {
        let mut t = part.mesh.triangles[i];
        t.rotate_left(crate::hash::splitmix64(i as u64 + seed) as usize % 3);
        t
    };
    let triangles = order.iter().map(|&i| turn(i)).collect();
    let truth = order.iter().map(|&i| part.truth[i]).collect();
    Part {
        mesh: TriMesh { vertices: part.mesh.vertices.clone(), triangles },
        truth,
        kinds: part.kinds.clone(),
    }
}

/// Every corner changed by a function of its place and number: triangles with corners of their own.
fn soup(part: &Part, of: impl Fn(DVec3, usize) -> DVec3) -> Part {
    let mut mesh = TriMesh::default();
    for t in &part.mesh.triangles {
        let n = mesh.vertices.len() as u32;
        for v in t {
            mesh.vertices.push(of(part.mesh.vertices[*v as usize], mesh.vertices.len()));
        }
        mesh.triangles.push([n, n + 1, n + 2]);
    }
    Part { mesh, ..part.clone() }
}

fn variants(make: Make, k: usize) -> Vec<(String, Part)> {
    let mut all = Vec::new();
    for chord in [0.01, 0.02, 0.1, 0.2] {
        all.push((format!("chord error {chord}"), make(chord, k)));
    }
    let base = make(0.05, k);
    all.push(("order".into(), shuffled(&base, 7)));
    let shift = DVec3::new(312.5, -871.3, 44.4);
    let single = |p: DVec3| p.as_vec3().as_dvec3();
    all.push(("32-bit floats, shifted".into(), soup(&base, |p, _| single(p + shift))));
    let noise = |i: usize| 2.0 * unit_interval(i as u64) - 1.0;
    let noisy =
        |p: DVec3, i: usize| p * (1.0 + DVec3::new(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)) * 6e-7);
    all.push(("noise of each corner".into(), soup(&base, noisy)));
    let six = |v: f64| format!("{v:.5e}").parse::<f64>().expect("a number");
    let text = |p: DVec3, _| DVec3::new(six(p.x), six(p.y), six(p.z));
    all.push(("text of six digits".into(), soup(&base, text)));
    all.push(("inches".into(), soup(&shuffled(&make(0.03, k), 3), |p, _| single(p / 25.4))));
    all
}

#[test]
fn names_survive_another_export() {
    let (mut all, mut kept) = (0, 0);
    let mut lost = Vec::new();
    for (name, make) in PARTS {
        for k in 0..3 {
            let part = make(0.05, k);
            let faces = Faces::segment(&part.mesh);
            let (found, _) = compared(&part, &faces);
            let names: Vec<String> = found.iter().map(|&f| faces.name(f)).collect();
            assert!(names.iter().all(|n| faces.find(n).is_ok()), "{name} {k}: {names:?}");
            for (what, other) in variants(make, k) {
                let others = Faces::segment(&other.mesh);
                let (wanted, _) = compared(&other, &others);
                for (face, text) in names.iter().enumerate() {
                    all += 1;
                    match others.find(text) {
                        Ok(f) => {
                            assert_eq!(f, wanted[face], "{name} {k}, {what}: {text} moved to another face");
                            kept += 1;
                        }
                        Err(e) => lost.push(format!("{name} {k}, {what}, face {face}: {e}")),
                    }
                }
            }
        }
    }
    assert!(all > 1500 && f64::from(kept) >= 0.98 * f64::from(all), "{kept} of {all}: {lost:#?}");
}

#[test]
fn names_look_the_same_after_rounding() {
    let (mut all, mut same) = (0, 0);
    for (_, make) in PARTS {
        let part = make(0.05, 1);
        let inches = soup(&shuffled(&part, 5), |p, _| (p / 25.4).as_vec3().as_dvec3());
        let (before, after) = (Faces::segment(&part.mesh), Faces::segment(&inches.mesh));
        let (old, new) = (compared(&part, &before).0, compared(&inches, &after).0);
        for (o, n) in old.into_iter().zip(new) {
            all += 1;
            same += u32::from(before.name(o) == after.name(n));
        }
    }
    assert!(all > 60 && f64::from(same) >= 0.95 * f64::from(all), "{same} of {all}");
}

#[test]
fn equal_and_missing_faces_are_refused_with_candidates() {
    // Two copies of one nut in one place: every face is there twice.
    let mut part = nut(0.05, 0);
    let n = part.mesh.vertices.len() as u32;
    part.mesh.vertices.extend_from_within(..);
    let copy: Vec<[u32; 3]> = part.mesh.triangles.iter().map(|t| t.map(|v| v + n)).collect();
    part.mesh.triangles.extend(copy);
    // Welding joins the vertices of both copies. Every edge then has four triangles, and no face grows over such an edge.
    let faces = Faces::segment(&part.mesh);
    let error = faces.find(&faces.name(0)).expect_err("equal faces");
    assert!(matches!(error, FaceError::Doubtful { .. }), "{error}");
    assert!(error.to_string().matches("mm2").count() >= 2, "{error}");
    let faces = Faces::segment(&channel(0.05, 0).mesh);
    let hole = Faces::segment(&nut(0.05, 0).mesh);
    let bore = hole.all().iter().position(|f| f.surface.word() == "cylinder").expect("a bore");
    let error = faces.find(&hole.name(bore)).expect_err("a channel has no bore");
    assert!(matches!(&error, FaceError::NotFound { candidates, .. } if candidates.contains("f:")), "{error}");
    for wrong in ["9c1e", "f:9c", "f:9c1g", "f:0123456789abcdef", ""] {
        assert!(matches!(faces.find(wrong), Err(FaceError::InvalidName(_))), "{wrong}");
    }
}

#[test]
fn odd_meshes_have_faces_too() {
    assert!(Faces::segment(&TriMesh::default()).is_empty());
    let vertices = vec![DVec3::ZERO, DVec3::NAN, DVec3::X, DVec3::X * 2.0, DVec3::Y];
    let odd = TriMesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3], [2, 2, 2], [0, 2, 4]] };
    let faces = Faces::segment(&odd);
    assert!(faces.all().iter().all(|f| f.area_mm2 > 0.0));
    // A roof of 30 degrees is two planes, although one cylinder goes through all its vertices.
    let d = &mut Draw::new(0.1);
    let (s, c) = sin_cos(PI / 12.0);
    for (x, y) in [(-20.0 * c, 0.0), (20.0 * c, 0.0), (0.0, 20.0 * s)] {
        d.side(x, y, "plane");
    }
    let outline = d.done();
    let roof = extruded(Draw { kinds: d.kinds.clone(), ..Draw::new(0.1) }, &[outline], 30.0);
    let words: Vec<_> = Faces::segment(&roof.mesh).all().iter().map(|f| f.surface.word()).collect();
    assert_eq!(words, ["plane"; 5]);
}

/// A sheet of waves on which no primitive lies: `n` squares along each side.
fn waves(n: u32) -> TriMesh {
    let height = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) * 100.0 / f64::from(n), f64::from(j) * 100.0 / f64::from(n));
        DVec3::new(x, y, 3.0 * sin_cos(0.2 * x).0 * sin_cos(0.13 * y + 0.4).1)
    };
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let square = |i: u32, j: u32| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    TriMesh {
        vertices: (0..=n).flat_map(|i| (0..=n).map(move |j| height(i, j))).collect(),
        triangles: (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect(),
    }
}

#[test]
fn a_free_surface_is_one_face() {
    let faces = Faces::segment(&waves(40));
    assert!(faces.all()[0].area_mm2 > 0.95 * faces.all().iter().map(|f| f.area_mm2).sum::<f64>());
    assert_eq!(faces.all()[0].surface, Surface::Free);
}

#[test]
#[ignore = "slow: two meshes of 640 000 and a million triangles"]
fn fine_meshes_have_the_faces_of_coarse_ones() {
    // How long they take is a row of `cargo xtask bench studio`. Measured: with a chord error of 32 nm instead of 60, 1.2
    // million triangles, the cone and one cylinder fall into 279 pieces.
    let (fine, coarse) = (turned_pin(6e-5, 0).mesh, turned_pin(0.02, 0).mesh);
    assert!(fine.triangles.len() > 600_000);
    let (of_fine, of_coarse) = (Faces::segment(&fine), Faces::segment(&coarse));
    assert_eq!((of_fine.len(), of_coarse.len()), (6, 6));
    for (a, b) in of_fine.all().iter().zip(of_coarse.all()) {
        assert_eq!(a.surface.word(), b.surface.word());
        assert!((a.area_mm2 / b.area_mm2 - 1.0).abs() < 0.01, "{} {}", a.area_mm2, b.area_mm2);
    }
    let sheet = Faces::segment(&waves(710));
    assert_eq!(sheet.all()[0].surface, Surface::Free);
}
