//! The whole part as one shaded picture, drawn from its beads.

use grainpath_core::{Bounds2, DVec2, DVec3, Role};

use super::raster::png;
use super::{Bead, LayerPicture};

/// Colour of the part at full light: only looks depend on it.
const BODY: [f64; 3] = [236.0, 146.0, 62.0];
/// Direction towards the light: left of the part, in front of it and above. Tops are then lightest and
/// the two visible sides differ, which shows the edges.
const LIGHT: DVec3 = DVec3::new(-0.35, -0.60, 0.72);

/// Draws all layers from the front right and above. Walls are drawn as strips of the layer's height, and
/// the fill as flat strips on top; the nearest surface is visible. A print without beads gives an empty
/// picture.
pub fn thumbnail_png(layers: &[LayerPicture], width: u32, height: u32) -> Vec<u8> {
    let (w, h) = (width.max(1) as usize, height.max(1) as usize);
    let mut canvas = Canvas { w, h, depth: vec![f32::NEG_INFINITY; w * h], shade: vec![f32::NAN; w * h] };
    if let Some(view) = View::around(layers, w, h) {
        for layer in layers {
            // Skirt, brim and interfaces of supports are not drawn: they would hide faces of the part.
            for bead in layer.beads.iter().filter(|b| b.role.is_part() || matches!(b.role, Role::Support)) {
                canvas.bead(&view, layer, bead);
            }
        }
    }
    let mut rgba = vec![0u8; w * h * 4];
    for (pixel, shade) in rgba.chunks_exact_mut(4).zip(&canvas.shade) {
        // Pixels without a bead stay transparent.
        if !shade.is_nan() {
            for (c, body) in pixel.iter_mut().zip(BODY) {
                *c = (body * f64::from(*shade)).clamp(0.0, 255.0) as u8;
            }
            pixel[3] = 255;
        }
    }
    png(width.max(1), height.max(1), &rgba)
}

/// An orthographic view from the front right and above.
struct View {
    scale: f64,
    shift: DVec2,
}

impl View {
    /// A point turned by 35 degrees about the vertical and tilted by 30 degrees: right, up, towards the
    /// eye.
    fn turned(p: DVec3) -> DVec3 {
        // Source: cosine and sine of 35 degrees; below, cosine of 30 degrees. Written out because a
        // constant cannot call the functions, and the same on every machine. Other angles change the view
        // only.
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
            Bounds2::of(all.map(|p| Self::turned(p).truncate()))
        };
        let b = layers.iter().filter_map(corners).reduce(Bounds2::union)?;
        let size = b.size().max(DVec2::splat(1e-6));
        // Three per cent of margin on each side.
        let scale = 0.94 * (w as f64 / size.x).min(h as f64 / size.y);
        let shift = DVec2::new(w as f64, h as f64) * 0.5 - b.centre() * scale;
        Some(Self { scale, shift })
    }

    /// Pixel (y up) and nearness to the eye.
    fn at(&self, p: DVec3) -> DVec3 {
        let t = Self::turned(p);
        (t.truncate() * self.scale + self.shift).extend(t.z)
    }
}

struct Canvas {
    w: usize,
    h: usize,
    depth: Vec<f32>,
    shade: Vec<f32>,
}

impl Canvas {
    fn bead(&mut self, view: &View, layer: &LayerPicture, bead: &Bead) {
        let along = bead.b - bead.a;
        let length = along.length();
        // A piece without length has no side.
        if length < 1e-9 {
            return;
        }
        let side = DVec2::new(along.y, -along.x) / length;
        let (low, high) = (layer.z_mm - layer.height_mm, layer.z_mm);
        let half = side * 0.5 * bead.width_mm;
        let flat = |p: DVec2, z: f64| view.at(p.extend(z));
        let top = [bead.a + half, bead.b + half, bead.b - half, bead.a - half].map(|p| flat(p, high));
        self.quad(top, shade(DVec3::Z));
        // Sides of fill are hidden behind walls, so only walls get strips; this halves the work.
        if bead.role.is_wall() {
            for (offset, normal) in [(half, side), (-half, -side)] {
                let (a, b) = (bead.a + offset, bead.b + offset);
                self.quad(
                    [flat(a, low), flat(b, low), flat(b, high), flat(a, high)],
                    shade(normal.extend(0.0)),
                );
            }
        }
    }

    fn quad(&mut self, [a, b, c, d]: [DVec3; 4], shade: f64) {
        self.triangle([a, b, c], shade as f32);
        self.triangle([a, c, d], shade as f32);
    }

    fn triangle(&mut self, [a, b, c]: [DVec3; 3], shade: f32) {
        let edge = |p: DVec3, q: DVec3, x: f64, y: f64| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
        let area = edge(a, b, c.x, c.y);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        // A pixel is covered when its centre is, hence the half.
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
                // The first of two equal depths wins; the order is that of printing and so the same on
                // each run.
                if depth > self.depth[i] {
                    self.depth[i] = depth;
                    self.shade[i] = shade;
                }
            }
        }
    }
}

/// Where a row of pixels crosses a triangle, in pixels along the row, a pixel more on both sides.
///
/// A long bead aslant covers few of the pixels in its box: without spans a picture of 2000 pixels tests millions of pixels
/// for each bead.
fn row_span(corners: [DVec3; 3], y: f64) -> (f64, f64) {
    let mut span = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        // Not a number for a level edge in the row itself; its ends belong to the two other edges.
        let t = (y - p.y) / (q.y - p.y);
        if (-1e-6..=1.0 + 1e-6).contains(&t) {
            let x = p.x + t * (q.x - p.x);
            span = (span.0.min(x - 1.0), span.1.max(x + 1.0));
        }
    }
    span
}

fn shade(normal: DVec3) -> f64 {
    // Ambient light of 0.38 keeps faces that are turned away from becoming black; the sum may exceed 1,
    // which the conversion clamps.
    0.38 + 0.66 * normal.dot(LIGHT.normalize()).max(0.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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
            let mut canvas = Canvas { w, h, depth: vec![f32::NEG_INFINITY; w * h], shade: vec![f32::NAN; w * h] };
            canvas.triangle([a, b, c], 0.5);
            let edge = |p: DVec3, q: DVec3, x: f64, y: f64| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
            let area = edge(a, b, c.x, c.y);
            for y in 0..h {
                for x in 0..w {
                    let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                    let (u, v) = (edge(b, c, px, py) / area, edge(c, a, px, py) / area);
                    let margin = u.min(v).min(1.0 - u - v);
                    let drawn = !canvas.shade[(h - 1 - y) * w + x].is_nan();
                    if area.abs() > 1e-6 && margin.abs() > 1e-8 {
                        prop_assert_eq!(drawn, margin > 0.0, "pixel {} {} of {:?}", x, y, [a, b, c]);
                    }
                }
            }
        }
    }
}
