//! Pictures of the surface of a part, seen from two sides: its numbered faces, or a value such as the stress.
//!
//! There are two parallel projections, one from the front and above, one from behind and below. Together
//! they show most faces that can be seen from outside.

use std::cmp::Reverse;

use grainpath_core::faces::Faces;
use grainpath_core::mesh::triangle_normal;
use grainpath_core::{DVec2, DVec3, TriMesh};

use crate::layer::{Ramp, digits, encode_png as png};
use crate::mesh_pixels::nearest;

/// Colour behind the part. Source: that of all pictures of layers.
const BACKGROUND: [u8; 3] = [28, 30, 34];
/// Share of a view left free on each side. Source: derived: a number at the edge of the part stays inside.
const MARGIN: f64 = 0.04;
/// Least number of visible pixels of a face that is numbered. Source: derived: a number of two digits covers 100.
const LEAST_PIXELS: usize = 120;

/// A view: which triangle each pixel shows, and how bright it is.
struct View {
    triangle: Vec<Option<usize>>,
    light: Vec<f64>,
    size: usize,
}

/// A face, and the pixel of its number, x and y.
type Numbered = (usize, (usize, usize));

/// A picture of the faces, `width_px` wide and half as high; numbers count from 1.
pub fn faces_png(mesh: &TriMesh, faces: &Faces, width_px: u32) -> Vec<u8> {
    numbered_png(mesh, &|t| faces.of_triangle(t), faces.len(), width_px)
}

/// A picture as [`faces_png`] draws it, of `n_faces` faces; `face_of` tells that of a triangle. Triangles without a face are
/// left out.
pub fn numbered_png(
    mesh: &TriMesh,
    face_of: &dyn Fn(usize) -> Option<usize>,
    n_faces: usize,
    width_px: u32,
) -> Vec<u8> {
    let numbers = |view: &View| {
        let shown: Vec<Option<usize>> = view.triangle.iter().map(|t| t.and_then(face_of)).collect();
        numbered(&shown, view.size, n_faces)
    };
    both_sides(
        mesh,
        &|t| face_of(t).is_some(),
        &|t| colour(face_of(t).unwrap_or_default()),
        &numbers,
        width_px,
    )
}

/// A picture of a value at each vertex, of the same two sides as [`faces_png`]: blue at 0, red at the largest value. Each
/// triangle has the mean of its corners.
pub fn values_png(mesh: &TriMesh, value_of_vertex: &[f64], width_px: u32) -> Vec<u8> {
    let high = value_of_vertex.iter().copied().fold(0.0, f64::max);
    let ramp = Ramp { low: 0.0, high };
    let mean = |t: usize| mesh.triangles[t].iter().map(|&v| value_of_vertex[v as usize]).sum::<f64>() / 3.0;
    both_sides(mesh, &|_| true, &|t| ramp.colour(mean(t)), &|_| Vec::new(), width_px)
}

/// Both views side by side. `is_drawn` and `colour` ask for triangles; `numbers` are written at pixels of a view.
fn both_sides(
    mesh: &TriMesh,
    is_drawn: &dyn Fn(usize) -> bool,
    colour: &dyn Fn(usize) -> [u8; 3],
    numbers: &dyn Fn(&View) -> Vec<Numbered>,
    width_px: u32,
) -> Vec<u8> {
    let size = (width_px / 2).max(8) as usize;
    let towards = DVec3::new(0.55, -0.7, 0.46).normalize();
    let views = [towards, -towards].map(|t| view(mesh, is_drawn, t, size));
    // Opaque: a picture of a part lies on pages of any ground.
    let mut rgba = vec![255u8; 2 * size * size * 4];
    for (side, view) in views.iter().enumerate() {
        let place = |x: usize, y: usize| 4 * (y * 2 * size + side * size + x);
        for (i, triangle) in view.triangle.iter().enumerate() {
            let shade = |c: u8| (f64::from(c) * view.light[i]) as u8;
            let colour = triangle.map_or(BACKGROUND, |t| colour(t).map(shade));
            let at = place(i % size, i / size);
            rgba[at..at + 3].copy_from_slice(&colour);
        }
        for (face, (x, y)) in numbers(view) {
            // A number at the rim of a view stays inside its half of the picture.
            let mut paint = |x: usize, y: usize, colour: [u8; 3]| {
                if x < size && y < size {
                    let at = place(x, y);
                    rgba[at..at + 3].copy_from_slice(&colour);
                }
            };
            // Large pictures get larger digits, which stay as large beside the part.
            let (text, dot) = ((face + 1).to_string(), (size / 300).max(1));
            let (wide, high) = digits::size(&text, dot);
            digits::write(&text, (x.saturating_sub(wide / 2), y.saturating_sub(high / 2)), dot, &mut paint);
        }
    }
    png(2 * size as u32, size as u32, &rgba)
}

/// The colour of a face. Hues are a golden angle apart, so that successive faces differ.
fn colour(face: usize) -> [u8; 3] {
    let hue = (face as f64 * 0.618_033_988_75).fract() * 6.0;
    let part = |k: f64| {
        let h = (hue + k).rem_euclid(6.0);
        let value = (h - 3.0).abs() - 1.0;
        (90.0 + 150.0 * value.clamp(0.0, 1.0)) as u8
    };
    [part(0.0), part(4.0), part(2.0)]
}

/// The part seen from a direction.
fn view(mesh: &TriMesh, is_drawn: &dyn Fn(usize) -> bool, towards: DVec3, size: usize) -> View {
    let right = DVec3::Z.cross(towards).normalize();
    let up = towards.cross(right);
    let flat: Vec<DVec3> =
        mesh.vertices.iter().map(|p| DVec3::new(p.dot(right), p.dot(up), p.dot(towards))).collect();
    let used = mesh.triangles.iter().flatten().map(|&v| flat[v as usize]);
    let (low, high) = used.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let extent = (high - low).truncate().max_element().max(1e-9);
    let scale = (1.0 - 2.0 * MARGIN) * size as f64 / extent;
    let middle = 0.5 * (low + high).truncate();
    let pixel = |p: DVec3| {
        let q = (p.truncate() - middle) * scale;
        DVec2::new(0.5 * size as f64 + q.x, 0.5 * size as f64 - q.y)
    };
    let drawn: Vec<(usize, [DVec3; 3])> = mesh
        .triangles
        .iter()
        .enumerate()
        .filter(|(i, _)| is_drawn(*i))
        .map(|(i, t)| (i, t.map(|v| flat[v as usize])))
        .collect();
    let shown = nearest(drawn.iter().map(|(_, t)| t.map(|p| pixel(p).extend(p.z))), size, size);
    let light = |t: usize| 0.45 + 0.55 * triangle_normal(drawn[t].1).dot(DVec3::new(-0.3, 0.5, 0.81)).abs();
    View {
        triangle: shown.iter().map(|t| t.map(|t| drawn[t].0)).collect(),
        light: shown.iter().map(|t| t.map_or(0.0, light)).collect(),
        size,
    }
}

/// The faces that are large enough to be numbered, of a view with the face `shown` in each of its pixels, `size` a row. Each
/// has the pixel that is furthest from the border of the face, along rows and columns; of several the nearest to the middle
/// of its visible pixels. So the number of an L lies on it.
///
/// Method: the distance is that of one neighbour plus one pixel; it is found downwards and to the right, then back. Cost:
/// linear in the pixels.
fn numbered(shown: &[Option<usize>], size: usize, n_faces: usize) -> Vec<Numbered> {
    let mut sums = vec![(0usize, 0usize, 0usize); n_faces];
    let seen = || shown.iter().enumerate().filter_map(|(i, f)| Some((i % size, i / size, (*f)?)));
    for (x, y, f) in seen() {
        sums[f] = (sums[f].0 + 1, sums[f].1 + x, sums[f].2 + y);
    }
    let mut inwards = vec![usize::MAX; shown.len()];
    let near = |inwards: &[usize], i: usize, is_inside: bool, other: usize| {
        // Pixels beside the picture are of no face.
        if is_inside && shown[other] == shown[i] { inwards[other].saturating_add(1) } else { 1 }
    };
    for i in 0..shown.len() {
        let left = near(&inwards, i, i % size > 0, i.wrapping_sub(1));
        inwards[i] = left.min(near(&inwards, i, i >= size, i.wrapping_sub(size)));
    }
    for i in (0..shown.len()).rev() {
        let right = near(&inwards, i, i % size + 1 < size, i + 1);
        let below = near(&inwards, i, i + size < shown.len(), i + size);
        inwards[i] = inwards[i].min(right).min(below);
    }
    // How good the best pixel of each face is, and that pixel.
    let mut best = vec![((0, Reverse(usize::MAX)), (0, 0)); n_faces];
    for (x, y, f) in seen().filter(|&(_, _, f)| sums[f].0 >= LEAST_PIXELS) {
        let (n, sx, sy) = sums[f];
        let far = (x * n).abs_diff(sx).pow(2) / n + (y * n).abs_diff(sy).pow(2) / n;
        let found = (inwards[y * size + x], Reverse(far));
        // Of equal places the first one stays.
        if found > best[f].0 {
            best[f] = (found, (x, y));
        }
    }
    let is_numbered = |f: &usize| sums[*f].0 >= LEAST_PIXELS;
    (0..n_faces).filter(is_numbered).map(|f| (f, best[f].1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_face_of_a_cube_is_seen_once() {
        let cube = TriMesh::cuboid(DVec3::ZERO, DVec3::splat(10.0));
        let faces = Faces::segment(&cube);
        let towards = DVec3::new(0.55, -0.7, 0.46).normalize();
        let shown = |t: DVec3| -> Vec<Option<usize>> {
            let view = view(&cube, &|_| true, t, 200);
            view.triangle.iter().map(|t| t.and_then(|t| faces.of_triangle(t))).collect()
        };
        let seen = |t: DVec3| -> Vec<usize> {
            numbered(&shown(t), 200, faces.len()).into_iter().map(|n| n.0).collect()
        };
        let (front, back) = (seen(towards), seen(-towards));
        assert_eq!((front.len(), back.len()), (3, 3));
        assert!(front.iter().all(|f| !back.contains(f)), "{front:?} {back:?}");
        // The number of a face lies on the face.
        let shown = shown(towards);
        assert!(numbered(&shown, 200, 6).into_iter().all(|(f, (x, y))| shown[y * 200 + x] == Some(f)));
        assert_eq!(&faces_png(&cube, &faces, 300)[1..4], b"PNG");
    }

    #[test]
    fn the_number_of_an_l_lies_on_it_with_room_around() {
        // Arms of 24 and 16 pixels; the middle of all pixels lies beside them.
        let shown: Vec<Option<usize>> =
            (0..100 * 100).map(|i| (i % 100 < 24 || i / 100 >= 84).then_some(0)).collect();
        let [(0, (x, y))] = numbered(&shown, 100, 1)[..] else { panic!("one face") };
        let around = [(x - 11, y), (x + 11, y), (x, y - 11), (x, y + 11)];
        assert!(around.iter().all(|(x, y)| shown[y * 100 + x] == Some(0)), "{x} {y}");
    }
}
