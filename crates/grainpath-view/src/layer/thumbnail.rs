//! The whole part as one shaded picture, drawn from its beads.
//!
//! Each bead is a tube of eight sides along its path: flat above and below, bevelled, and pointed at half its height, so
//! that neighbouring beads show a groove. The nearest surface wins in each pixel (z-buffer, `catmull1974`). Light is
//! interpolated between the corners of a facet (`gouraud1971`), which rounds the bevels. Grooves and corners are darkened:
//! the more of a point's surroundings lie nearer to the eye, the darker it is (screen-space ambient occlusion,
//! `mittring2007`). A pixel is the mean of nine samples, on larger pictures of four or one.
//!
//! Units: beads in mm, pictures in pixels. Cost: linear in the samples that facets cover; 3DBenchy (240 layers) at 900 x 675
//! takes a second. Limits: no shadows; beads are not cut where they overlap, so a wide bead hides a narrow one.

use grainpath_core::{Bounds2, DVec2, DVec3, Role};
use grainpath_gcode::{Program, Thumbnail};

use super::rasteriser::png;
use super::{DrawnBead, LayerPicture};

/// Colour of the part at full light.
/// Source: chosen by eye; only the picture depends on it.
const BODY: [f64; 3] = [236.0, 150.0, 74.0];
/// Colour of supports: grey, so that the part stands out.
/// Source: chosen by eye; only the picture depends on it.
const SUPPORT: [f64; 3] = [176.0, 182.0, 190.0];
/// The light background of pictures on paper and on pages.
/// Source: chosen by eye; only the picture depends on it.
const PAPER: [u8; 3] = [246, 244, 240];
/// Direction towards the light: left of the part, in front of it and above. Tops are then lightest and
/// the two visible sides differ, which shows the edges. Source: chosen by eye; only the picture depends on it.
const LIGHT: DVec3 = DVec3::new(-0.35, -0.60, 0.72);
/// The greatest number of samples of a picture; larger pictures get fewer samples a pixel: 800 x 600 pixels get nine,
/// 1200 x 900 pixels four. More samples make no visible difference.
/// Measured: eight million take 64 MB, and 3DBenchy at 1200 x 900 takes 2.0 s.
const MOST_SAMPLES: usize = 8_000_000;
/// Width of a bead's bevels as a share of its height.
/// Source: chosen by eye; only the picture depends on it.
const BEVEL: f64 = 0.35;

/// The background behind the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// A transparent background, for printers' screens, which have backgrounds of their own.
    Clear,
    /// A light background, for pages.
    Paper,
}

/// Pictures of a program for the printer's screen; `sizes_px` gives their widths and heights in pixels.
pub fn thumbnails(program: &Program, sizes_px: &[[usize; 2]]) -> Vec<Thumbnail> {
    let layers: Vec<LayerPicture> = program.layers.iter().map(LayerPicture::from).collect();
    let draw = |&[w, h]: &[usize; 2]| {
        let (width, height) = (w as u32, h as u32);
        Thumbnail { width, height, png: thumbnail_png(&layers, width, height, Ground::Clear) }
    };
    sizes_px.iter().map(draw).collect()
}

/// Draws all layers from the front right and above; the nearest surface is visible. A print without beads gives an empty
/// picture.
pub fn thumbnail_png(layers: &[LayerPicture], width: u32, height: u32, ground: Ground) -> Vec<u8> {
    let (w, h) = (width.max(1) as usize, height.max(1) as usize);
    let samples = if w * h * 9 <= MOST_SAMPLES {
        3
    } else if w * h * 4 <= MOST_SAMPLES {
        2
    } else {
        1
    };
    let mut canvas = Canvas::new(w * samples, h * samples);
    if let Some(view) = View::around(layers, w * samples, h * samples) {
        for layer in layers {
            // Skirt, brim and interfaces of supports are not drawn, because they would hide faces of the part.
            let drawn = |b: &DrawnBead| b.role.is_part() || matches!(b.role, Role::Support);
            for path in layer.beads.chunk_by(|a, b| a.b.distance_squared(b.a) < 1e-6 && a.role == b.role) {
                if drawn(&path[0]) {
                    canvas.path(&view, layer, path);
                }
            }
        }
    }
    png(width.max(1), height.max(1), &canvas.pixels(samples, ground))
}

/// An orthographic view from the front right and above.
struct View {
    scale: f64,
    shift: DVec2,
}

impl View {
    /// A point in the axes of the view: right, up, and towards the eye. The view is turned by 35 degrees about
    /// the vertical and tilted by 30 degrees.
    fn turned(p: DVec3) -> DVec3 {
        // Source: cosine of 35 degrees; the factor below is the cosine of 30 degrees. The numbers are written
        // out because a constant cannot call these functions, and so that they are the same on every machine.
        // Other angles would only change the view.
        const C: f64 = 0.819_152_044_288_991_8;
        // Source: sine of the same angle.
        const S: f64 = 0.573_576_436_351_046;
        let (x, y) = (C * p.x + S * p.y, C * p.y - S * p.x);
        DVec3::new(x, 0.5 * y + 0.866_025_403_784_438_6 * p.z, 0.5 * p.z - 0.866_025_403_784_438_6 * y)
    }

    fn around(layers: &[LayerPicture], w: usize, h: usize) -> Option<Self> {
        let corners = |l: &LayerPicture| {
            let b = l.bounds()?;
            let corner = |i: usize| {
                let x = if i & 1 == 0 { b.min.x } else { b.max.x };
                let y = if i & 2 == 0 { b.min.y } else { b.max.y };
                DVec3::new(x, y, if i & 4 == 0 { l.z_mm - l.height_mm } else { l.z_mm })
            };
            let all = (0..8).map(corner);
            Bounds2::around_points(all.map(|p| Self::turned(p).truncate()))
        };
        let b = layers.iter().filter_map(corners).reduce(Bounds2::union)?;
        let size = b.size().max(DVec2::splat(1e-6));
        // Three per cent of margin on each side.
        let scale = 0.94 * (w as f64 / size.x).min(h as f64 / size.y);
        let shift = DVec2::new(w as f64, h as f64) * 0.5 - b.centre() * scale;
        Some(Self { scale, shift })
    }

    /// Position of a point in the picture, pixels with y upwards, and its nearness to the eye, mm.
    fn at(&self, p: DVec3) -> DVec3 {
        let t = Self::turned(p);
        (t.truncate() * self.scale + self.shift).extend(t.z)
    }
}

struct Canvas {
    w: usize,
    h: usize,
    depth: Vec<f32>,
    /// Brightness from 0 on. It is negative for supports, and NaN where no bead is.
    light: Vec<f32>,
}

/// A corner of a facet: its pixel, nearness to the eye, and brightness.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec3,
    light: f64,
    /// Whether the surface here faces the eye.
    faces_eye: bool,
}

impl Canvas {
    fn new(w: usize, h: usize) -> Self {
        Self { w, h, depth: vec![f32::NEG_INFINITY; w * h], light: vec![f32::NAN; w * h] }
    }

    /// Draws the beads of one path, which meet end to end.
    fn path(&mut self, view: &View, layer: &LayerPicture, path: &[DrawnBead]) {
        // Pieces without length are left out, because they have no direction.
        let path: Vec<&DrawnBead> = path.iter().filter(|b| b.a.distance_squared(b.b) > 1e-12).collect();
        let (Some(first), Some(last)) = (path.first(), path.last()) else { return };
        let closed = path.len() > 2 && first.a.distance_squared(last.b) < 1e-6;
        let support = matches!(first.role, Role::Support);
        let turn = |i: usize, j: usize| mitre(direction(path[i]), direction(path[j]));
        for (i, bead) in path.iter().enumerate() {
            let before = if i > 0 { Some(i - 1) } else { closed.then(|| path.len() - 1) };
            let after = if i + 1 < path.len() { Some(i + 1) } else { closed.then_some(0) };
            let side = left_of(direction(bead));
            let start = before.map_or(side, |j| turn(j, i));
            let end = after.map_or(side, |j| turn(i, j));
            self.tube(
                &rings(view, layer, bead, bead.a, start),
                &rings(view, layer, bead, bead.b, end),
                support,
            );
            for (point, outwards, free) in
                [(bead.a, -direction(bead), before.is_none()), (bead.b, direction(bead), after.is_none())]
            {
                if free {
                    self.end(view, layer, bead, point, outwards, support);
                }
            }
        }
    }

    /// Draws the facets between two cross-sections.
    fn tube(&mut self, a: &[Corner; SECTION], b: &[Corner; SECTION], support: bool) {
        for i in 0..SECTION {
            let j = (i + 1) % SECTION;
            self.facet([a[i], a[j], b[j], b[i]], support);
        }
    }

    /// Draws the round end of a path as a fan of tubes about the end point.
    fn end(
        &mut self,
        view: &View,
        layer: &LayerPicture,
        bead: &DrawnBead,
        at: DVec2,
        outwards: DVec2,
        support: bool,
    ) {
        let side = left_of(outwards);
        // Half a circle is drawn in four steps; the inner corners of the tubes meet at the end point.
        let steps = [
            side,
            side * HALF_SQRT + outwards * HALF_SQRT,
            outwards,
            outwards * HALF_SQRT - side * HALF_SQRT,
            -side,
        ];
        for pair in steps.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|s| rings(view, layer, bead, at, s));
            // Only the half of each section that points outwards is drawn, because the other half lies inside the bead.
            for i in 0..SECTION / 2 {
                self.facet([a[i], a[i + 1], b[i + 1], b[i]], support);
            }
        }
    }

    /// Draws a facet of a tube if it faces the eye. Leaving out the far side of the tubes saves two fifths of the time.
    fn facet(&mut self, [a, b, c, d]: [Corner; 4], support: bool) {
        if [a, b, c, d].iter().any(|corner| corner.faces_eye) {
            self.triangle([a, b, c], support);
            self.triangle([a, c, d], support);
        }
    }

    fn triangle(&mut self, corners: [Corner; 3], support: bool) {
        let [a, b, c] = corners.map(|c| c.at);
        let edge = |p: DVec3, q: DVec3, x: f64, y: f64| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
        let area = edge(a, b, c.x, c.y);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        // A pixel counts as covered if its centre is covered. Centres lie half a pixel from the pixel's edges.
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let range = |lo: f64, hi: f64, n: usize| {
            (lo - 0.5).ceil().max(0.0) as usize..((hi + 0.5).floor().max(0.0) as usize).min(n)
        };
        for y in range(lo.y, hi.y, self.h) {
            let (from, to) = row_span([a, b, c], y as f64 + 0.5);
            for x in range(from.max(lo.x), to.min(hi.x), self.w) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                // Barycentric weights. Dividing by the signed area accepts both orders of corners, so
                // that sides seen from behind are drawn too.
                let (u, v) = (edge(b, c, px, py) / area, edge(c, a, px, py) / area);
                let t = 1.0 - u - v;
                if u < -1e-9 || v < -1e-9 || t < -1e-9 {
                    continue;
                }
                let depth = (u * a.z + v * b.z + t * c.z) as f32;
                let i = (self.h - 1 - y) * self.w + x;
                // Of two equal depths the first in printing order wins, so that each run gives the same
                // picture.
                if depth > self.depth[i] {
                    self.depth[i] = depth;
                    let light = u * corners[0].light + v * corners[1].light + t * corners[2].light;
                    self.light[i] = (if support { -light } else { light }) as f32;
                }
            }
        }
    }

    /// The picture with `samples` by `samples` samples a pixel, RGBA.
    fn pixels(&self, samples: usize, ground: Ground) -> Vec<u8> {
        let (w, h) = (self.w / samples, self.h / samples);
        let mut rgba = vec![0u8; w * h * 4];
        let per_pixel = (samples * samples) as f64;
        for (i, pixel) in rgba.chunks_exact_mut(4).enumerate() {
            let (mut sum, mut covered) = ([0.0; 3], 0.0);
            for k in 0..samples * samples {
                let (x, y) = (i % w * samples + k % samples, i / w * samples + k / samples);
                let light = f64::from(self.light[y * self.w + x]);
                if light.is_nan() {
                    continue;
                }
                covered += 1.0;
                let body = if light < 0.0 { SUPPORT } else { BODY };
                let light = light.abs() * self.openness(x, y, samples);
                sum.iter_mut().zip(body).for_each(|(s, b)| *s += (b * light).min(255.0));
            }
            let share = covered / per_pixel;
            match ground {
                Ground::Clear if covered > 0.0 => {
                    pixel.iter_mut().zip(sum).for_each(|(p, s)| *p = (s / covered).round() as u8);
                    pixel[3] = (255.0 * share).round() as u8;
                }
                Ground::Clear => {}
                Ground::Paper => {
                    for ((p, s), paper) in pixel.iter_mut().zip(sum).zip(PAPER) {
                        *p = (s / per_pixel + f64::from(paper) * (1.0 - share)).round() as u8;
                    }
                    pixel[3] = 255;
                }
            }
        }
        rgba
    }

    /// Factor on the brightness, 0.6 to 1. The more of eight neighbours at two distances lie nearer to the eye, the smaller
    /// it is. The darkening is chosen by eye; only the picture depends on it.
    fn openness(&self, x: usize, y: usize, samples: usize) -> f64 {
        // Source: chosen by eye; only the picture depends on it.
        const RING: [(i64, i64); 8] = [(3, 0), (2, 2), (0, 3), (-2, 2), (-3, 0), (-2, -2), (0, -3), (2, -2)];
        let here = self.depth[y * self.w + x];
        let mut hidden = 0;
        for reach in [1, 3] {
            for (dx, dy) in RING {
                let step = reach * samples as i64;
                let (u, v) = (x as i64 + dx * step, y as i64 + dy * step);
                if u < 0 || v < 0 || u >= self.w as i64 || v >= self.h as i64 {
                    continue;
                }
                let there = self.depth[v as usize * self.w + u as usize];
                // A step of 1 mm tells a corner of the part from the grooves between beads. Depths are never NaN.
                hidden += usize::from(there > here + 1.0);
            }
        }
        1.0 - 0.4 * hidden as f64 / 16.0
    }
}

/// Sine and cosine of 45 degrees, half the square root of two.
const HALF_SQRT: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Corners of a cross-section. Source: the rows of the table in [`rings`].
const SECTION: usize = 8;

fn direction(bead: &DrawnBead) -> DVec2 {
    (bead.b - bead.a).normalize_or_zero()
}

fn left_of(direction: DVec2) -> DVec2 {
    DVec2::new(-direction.y, direction.x)
}

/// The side vector at a joint of two beads. It lies on the bisector and is lengthened so that the width is kept, at most
/// to twice (at sharper turns the corner would stick out).
fn mitre(before: DVec2, after: DVec2) -> DVec2 {
    let (a, b) = (left_of(before), left_of(after));
    let sum = a + b;
    if sum.length_squared() < 1e-3 {
        return b;
    }
    let bisector = sum.normalize();
    bisector / bisector.dot(b).max(0.5)
}

/// The corners of a bead's cross-section at a point, in the order left side, top, right side, bottom.
fn rings(view: &View, layer: &LayerPicture, bead: &DrawnBead, at: DVec2, side: DVec2) -> [Corner; SECTION] {
    let half = 0.5 * bead.width_mm;
    let [bottom, top] = bead.raise_mm;
    let height_mm = layer.height_mm + (top - bottom);
    let bevel = (BEVEL * height_mm).min(0.9 * half);
    let (low, high) = (layer.z_mm - layer.height_mm + bottom, layer.z_mm + top);
    let out = side.normalize_or_zero().extend(0.0);
    // Each corner has its offset to the left, its height, and the outward normal in the plane of the section.
    let third = height_mm / 3.0;
    let section = [
        (half, low + third, DVec2::new(1.0, -0.2)),
        (half, high - third, DVec2::new(1.0, 0.3)),
        (half - bevel, high, DVec2::new(0.25, 1.0)),
        (bevel - half, high, DVec2::new(-0.25, 1.0)),
        (-half, high - third, DVec2::new(-1.0, 0.3)),
        (-half, low + third, DVec2::new(-1.0, -0.2)),
        (bevel - half, low, DVec2::new(-0.3, -1.0)),
        (half - bevel, low, DVec2::new(0.3, -1.0)),
    ];
    section.map(|(left, z, normal)| {
        let normal = (out * normal.x + DVec3::Z * normal.y).normalize();
        Corner {
            at: view.at((at + side * left).extend(z)),
            light: light(normal),
            faces_eye: View::turned(normal).z > 0.0,
        }
    })
}

/// The range in which a row of pixels crosses a triangle, in pixels along the row, with a pixel more on both sides.
///
/// A long oblique bead covers only few of the pixels in its box. Without these ranges, a picture of 2000 pixels would test
/// millions of pixels for each bead.
fn row_span(corners: [DVec3; 3], y: f64) -> (f64, f64) {
    let mut span = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        // For a horizontal edge in the row this is NaN; the two other edges then give its ends.
        let t = (y - p.y) / (q.y - p.y);
        if (-1e-6..=1.0 + 1e-6).contains(&t) {
            let x = p.x + t * (q.x - p.x);
            span = (span.0.min(x - 1.0), span.1.max(x + 1.0));
        }
    }
    span
}

fn light(normal: DVec3) -> f64 {
    // Ambient light of 0.42 keeps faces that are turned away from the light from being black. The sum may exceed
    // 1, but colours are clamped later. Chosen by eye.
    0.42 + 0.62 * normal.dot(LIGHT.normalize()).max(0.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use ::png as png_crate;

    use super::*;

    proptest! {
        /// Every pixel inside a triangle of any shape is drawn, and none outside: as a test of all pixels says.
        #[test]
        fn spans_leave_no_pixel_of_a_triangle_out(
            corners in prop::array::uniform3((-10.0f64..50.0, -10.0f64..50.0)),
            whole in any::<bool>(),
        ) {
            // Corners on whole and half pixels meet rows exactly.
            let corner = |(x, y): (f64, f64)| {
                if whole { DVec3::new((2.0 * x).round() / 2.0, (2.0 * y).round() / 2.0, 1.0) } else { DVec3::new(x, y, 1.0) }
            };
            let [a, b, c] = corners.map(corner);
            let (w, h) = (40, 40);
            let mut canvas = Canvas::new(w, h);
            canvas.triangle([a, b, c].map(|at| Corner { at, light: 0.5, faces_eye: true }), false);
            let edge = |p: DVec3, q: DVec3, x: f64, y: f64| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
            let area = edge(a, b, c.x, c.y);
            for y in 0..h {
                for x in 0..w {
                    let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                    let (u, v) = (edge(b, c, px, py) / area, edge(c, a, px, py) / area);
                    let margin = u.min(v).min(1.0 - u - v);
                    let drawn = !canvas.light[(h - 1 - y) * w + x].is_nan();
                    if area.abs() > 1e-6 && margin.abs() > 1e-8 {
                        prop_assert_eq!(drawn, margin > 0.0, "pixel {} {} of {:?}", x, y, [a, b, c]);
                    }
                }
            }
        }
    }

    /// A solid block of dense layers: the ground shows nowhere inside its outline, and the light differs between top
    /// and sides.
    #[test]
    fn no_ground_shows_through_a_solid_block() {
        let layer = |k: usize| {
            let y = |i: usize| 0.225 + 0.45 * i as f64;
            let line = |i: usize| DrawnBead {
                a: DVec2::new(0.0, y(i)),
                b: DVec2::new(20.0, y(i)),
                width_mm: 0.45,
                role: Role::SolidFill,
                speed_mm_s: 50.0,
                off_deg: None,
                raise_mm: [0.0; 2],
            };
            let z_mm = 0.2 * (k + 1) as f64;
            LayerPicture {
                z_mm,
                height_mm: 0.2,
                beads: (0..40).map(line).collect(),
                travels: vec![],
                cuts: vec![],
            }
        };
        let layers: Vec<LayerPicture> = (0..40).map(layer).collect();
        let bytes = thumbnail_png(&layers, 200, 150, Ground::Clear);
        let mut reader = png_crate::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("PNG");
        let mut rgba = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut rgba).expect("a frame");
        let mut n_inside = 0;
        for row in rgba.chunks_exact(200 * 4) {
            let alpha: Vec<u8> = row.chunks_exact(4).map(|p| p[3]).collect();
            let (Some(first), Some(last)) =
                (alpha.iter().position(|a| *a == 255), alpha.iter().rposition(|a| *a == 255))
            else {
                continue;
            };
            // The outline of a block is convex.
            assert!(alpha[first..=last].iter().all(|a| *a == 255), "a hole in {alpha:?}");
            n_inside += last - first + 1;
        }
        assert!(n_inside > 8000, "{n_inside} pixels");
        let greens: std::collections::BTreeSet<u8> =
            rgba.chunks_exact(4).filter(|p| p[3] == 255).map(|p| p[1] / 16).collect();
        assert!(greens.len() >= 3, "{greens:?}");
    }
}
