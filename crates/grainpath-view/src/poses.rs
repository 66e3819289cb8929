//! A picture of the poses in which a part can be printed, with its supports.
//!
//! All poses are drawn at one scale in a parallel projection from the front and above, in the order given from the upper
//! left, and numbered from 1. A ring marks where the part first fails under its loads. Cost: linear in the pixels that the
//! triangles cover.

use grainpath_core::mesh::triangle_normal;
use grainpath_core::{DVec2, DVec3, TriMesh};

use crate::layer::{digits, encode_png};
use crate::mesh_pixels::nearest;

/// A part in a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePicture {
    /// The part as it stands on the plate, which is z = 0, mm.
    pub part: TriMesh,
    /// The surface of its supports, mm.
    pub support: TriMesh,
    /// Where it first fails under its loads, mm.
    pub fails_at_mm: Option<DVec3>,
}

/// Side of the picture of one pose, pixels. Source: chosen; three beside each other fill a wide screen.
const SIZE: usize = 480;
/// Pixels are drawn this many times as fine and averaged. Source: chosen by eye; edges are smooth at 2.
const FINER: usize = 2;
/// Most poses in a row. Source: chosen; see [`SIZE`].
const MOST_COLUMNS: usize = 3;
/// Share of a picture left free on each side. Source: chosen by eye.
const MARGIN: f64 = 0.06;
/// The plate is drawn so far beyond the part and its supports, as a share of their size. Source: chosen by eye.
const PLATE_BEYOND: f64 = 0.08;
/// Radius of the ring, pixels. Source: chosen by eye.
const RING_PX: f64 = 9.0;

/// The ground of the picture. Source: chosen by eye.
const GROUND: [f64; 3] = [250.0, 250.0, 247.0];
/// The plate. Source: chosen by eye.
const PLATE: [f64; 3] = [226.0, 228.0, 232.0];
/// The part. Source: chosen by eye; wood, which no other body of the picture is like.
const PART: [f64; 3] = [232.0, 176.0, 104.0];
/// Supports. Source: chosen by eye; green, as in the pictures of the steps of support.
const SUPPORT: [f64; 3] = [112.0, 186.0, 122.0];
/// The ring. Source: chosen by eye; it stands off from part, supports and plate.
const RING: [f64; 3] = [200.0, 30.0, 30.0];

/// A pose as it is seen: x to the right, y upwards and z towards the eye, mm.
struct Seen {
    /// Two triangles of the plate, those of the part, and those of the supports.
    triangles: Vec<[DVec3; 3]>,
    n_part: usize,
    fails_at: Option<DVec3>,
    low: DVec2,
    high: DVec2,
}

/// The poses side by side; `None` if there are none, or one has no triangles.
pub fn poses_png(poses: &[PosePicture]) -> Option<Vec<u8>> {
    let seen: Vec<Seen> = poses.iter().map(seen).collect::<Option<_>>()?;
    let extent = seen.iter().map(|s| (s.high - s.low).max_element()).reduce(f64::max)?;
    let columns = seen.len().min(MOST_COLUMNS);
    let (w, h) = (columns * SIZE, seen.len().div_ceil(columns) * SIZE);
    let ground = GROUND.map(|v| v as u8);
    let mut rgba = [ground[0], ground[1], ground[2], 255].repeat(w * h);
    for (k, seen) in seen.iter().enumerate() {
        let (left, top) = (k % columns * SIZE, k / columns * SIZE);
        let mut paint = |x: usize, y: usize, colour: [u8; 3]| {
            let at = 4 * ((top + y) * w + left + x);
            rgba[at..at + 3].copy_from_slice(&colour);
        };
        draw(seen, extent, &mut paint);
        digits::write(&(k + 1).to_string(), (8, 8), 4, &mut paint);
    }
    Some(encode_png(w as u32, h as u32, &rgba))
}

/// A pose in the axes of the picture.
fn seen(pose: &PosePicture) -> Option<Seen> {
    let towards = DVec3::new(0.5, -0.75, 0.5).normalize();
    let right = DVec3::Z.cross(towards).normalize();
    let up = towards.cross(right);
    let turn = |p: DVec3| DVec3::new(p.dot(right), p.dot(up), p.dot(towards));
    let mut bounds = pose.part.bounds()?;
    if let Some(support) = pose.support.bounds() {
        bounds = (bounds.0.min(support.0), bounds.1.max(support.1));
    }
    let beyond = PLATE_BEYOND * (bounds.1 - bounds.0).max_element();
    let corner = |x: f64, y: f64| turn(DVec3::new(x, y, 0.0));
    let (low, high) = ((bounds.0 - beyond).truncate(), (bounds.1 + beyond).truncate());
    let [a, b, c, d] =
        [corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)];
    let mut triangles = vec![[a, b, c], [a, c, d]];
    for mesh in [&pose.part, &pose.support] {
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| turn(mesh.vertices[v as usize]))));
    }
    let (low, high) = triangles
        .iter()
        .flatten()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(p.truncate()), h.max(p.truncate())));
    let n_part = pose.part.triangles.len();
    Some(Seen { triangles, n_part, fails_at: pose.fails_at_mm.map(turn), low, high })
}

/// Draws a pose into a square of [`SIZE`] pixels.
fn draw(seen: &Seen, extent: f64, paint: &mut dyn FnMut(usize, usize, [u8; 3])) {
    let fine = SIZE * FINER;
    let scale = (1.0 - 2.0 * MARGIN) * fine as f64 / extent;
    let middle = 0.5 * (seen.low + seen.high);
    let pixel = |p: DVec3| {
        let q = (p.truncate() - middle) * scale;
        DVec3::new(0.5 * fine as f64 + q.x, 0.5 * fine as f64 - q.y, p.z)
    };
    let shown = nearest(seen.triangles.iter().map(|t| t.map(pixel)), fine, fine);
    let light = DVec3::new(-0.4, 0.5, 0.77);
    let colour = |t: Option<usize>| match t {
        None => GROUND,
        Some(0 | 1) => PLATE,
        Some(t) => {
            let n = triangle_normal(seen.triangles[t]);
            let shade = 0.45 + 0.55 * (n * n.z.signum()).dot(light).max(0.0);
            (if t < 2 + seen.n_part { PART } else { SUPPORT }).map(|v| v * shade)
        }
    };
    let ring = seen.fails_at.map(|p| pixel(p).truncate() / FINER as f64);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let mut sum = [0.0; 3];
            for (i, j) in (0..FINER * FINER).map(|k| (k % FINER, k / FINER)) {
                let found = colour(shown[(y * FINER + j) * fine + x * FINER + i]);
                sum.iter_mut().zip(found).for_each(|(s, v)| *s += v);
            }
            let off =
                ring.map(|at| (at.distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)) - RING_PX).abs());
            let mean = sum.map(|s| s / (FINER * FINER) as f64);
            // The ring is three pixels wide, with a light edge of one that sets it off from the part.
            let mixed = match off {
                Some(off) if off < 1.5 => RING,
                Some(off) if off < 2.5 => GROUND,
                _ => mean,
            };
            paint(x, y, mixed.map(|v| v.clamp(0.0, 255.0) as u8));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn part_support_and_the_place_of_failure_are_seen_in_their_colours() {
        let pose = |fails_at_mm| PosePicture {
            part: TriMesh::cuboid(DVec3::new(0.0, 0.0, 10.0), DVec3::new(20.0, 20.0, 20.0)),
            support: TriMesh::cuboid(DVec3::ZERO, DVec3::new(20.0, 20.0, 9.5)),
            fails_at_mm,
        };
        let count = |pose: &PosePicture| {
            let seen = seen(pose).expect("triangles");
            let mut n = [0; 3];
            draw(&seen, (seen.high - seen.low).max_element(), &mut |_, _, [r, g, b]| {
                n[0] += usize::from(r > g && g > b && r > 100 && i32::from(r) - i32::from(b) > 40 && g > 60);
                n[1] += usize::from(g > r && g > b);
                n[2] += usize::from([r, g, b] == RING.map(|v| v as u8));
            });
            n
        };
        let with = count(&pose(Some(DVec3::new(10.0, 10.0, 20.0))));
        let without = count(&PosePicture { support: TriMesh::default(), ..pose(None) });
        assert!(with[0] > 5000 && with[1] > 5000 && with[2] > 100, "{with:?}");
        assert!(without[0] >= with[0] && without[1] == 0 && without[2] == 0, "{without:?}");
    }

    #[test]
    fn five_poses_stand_in_two_rows() {
        let pose = PosePicture {
            part: TriMesh::cuboid(DVec3::ZERO, DVec3::splat(5.0)),
            support: TriMesh::default(),
            fails_at_mm: None,
        };
        let png = poses_png(&vec![pose; 5]).expect("a picture");
        // Width and height stand in the header of a PNG file.
        let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes"));
        assert_eq!((number(16), number(20)), (3 * SIZE as u32, 2 * SIZE as u32));
        assert_eq!(poses_png(&[]), None);
    }
}
