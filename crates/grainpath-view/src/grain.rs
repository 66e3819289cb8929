//! Pictures of the steps by which curves are derived from a photograph or a scan.

use grainpath_core::DVec2;
use grainpath_core::math::direction;
use tiny_skia::{LineCap, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform};

use grainpath::guide::grain::{GrainGuide, PhotoSteps};
use grainpath_imaging::metric::MetricImage;
use grainpath_imaging::raster::Grey;
use grainpath_imaging::scan::texture::ShownSlice;
use grainpath_imaging::structure_tensor::{AxisGrid, AxisSample};

use crate::layer::encode_png;
use crate::page::Picture;

/// Longest side of a picture, pixels. Larger photographs are shrunk to it, small ones are enlarged at most
/// to it. Source: chosen by eye; only the picture depends on it.
const LONGEST_PX: f64 = 1600.0;

/// File names and pictures of all steps that a guide kept.
pub fn pictures(guide: &GrainGuide) -> Vec<(String, Picture)> {
    let n = guide.photo_steps.len();
    let mut out = Vec::new();
    for (k, found) in guide.photo_steps.iter().enumerate() {
        // File names get a prefix only if there are several photographs.
        let prefix = if n > 1 { format!("photo{}_", k + 1) } else { String::new() };
        out.extend(steps(found).into_iter().map(|(name, p)| (format!("{prefix}{name}"), p)));
    }
    out.extend(guide.shown_slices.iter().map(|slice| texture(guide, slice)));
    out
}

/// Pictures of the steps from a photograph to directions and curves. Numbers in the file names keep a listing
/// in the order of the steps.
fn steps(found: &PhotoSteps) -> Vec<(String, Picture)> {
    let PhotoSteps { photo, corners, image, denoised, edges, axes, curves } = found;
    let mut out = Vec::new();
    let mut put = |name: &str, title: &str, canvas: Canvas| {
        let picture = Picture { title: title.into(), png: canvas.png(), ..Picture::default() };
        out.push((format!("grain_{name}.png"), picture));
    };
    let mut canvas = Canvas::new(photo, 1.0, false);
    let ring: Vec<DVec2> = corners.iter().chain([&corners[0]]).copied().collect();
    canvas.line(&ring, 3.0, [255, 60, 40]);
    canvas.number_corners(*corners);
    put("1_photograph", "The photograph and the corners: 1 upper left of the board, then clockwise", canvas);
    put("2_rectified", "Rectified", Canvas::new(&image.grey, 1.0, true));
    put("3_denoised", "Denoised", Canvas::new(&denoised.grey, 1.0, true));
    if let Some(edges) = edges {
        let mask = Grey {
            width: edges.width,
            height: edges.height,
            data: edges.mask.iter().map(|&m| if m { 1.0 } else { 0.0 }).collect(),
        };
        put("4_edges", "Edges", Canvas::new(&mask, 1.0, true));
    }
    // On the part y points upwards and is in mm; the rows of a picture run from the top.
    let to_px = |p: DVec2| {
        let q = image.pixel(p);
        DVec2::new(q.x, image.grey.height as f64 - q.y)
    };
    let canvas = with_strokes(&image.grey, &|p| axes.sample(image.place(p.x, p.y)));
    put("5_field", "Directions: yellow where the grain is clear, violet where it is unclear", canvas);
    if !curves.is_empty() {
        // At half its brightness the photograph lets the coloured curves stand out.
        let mut canvas = Canvas::new(&image.grey, 0.5, true);
        for (k, curve) in curves.iter().enumerate() {
            let line: Vec<DVec2> = curve.iter().map(|&p| to_px(p)).collect();
            // Curves take four hues in turn, so that neighbouring curves differ.
            let hue = [[255, 200, 60], [90, 220, 255], [140, 255, 120], [255, 130, 180]][k % 4];
            canvas.line(&line, 1.3, hue);
        }
        put("6_curves", "Curves along the edges", canvas);
    }
    out
}

/// A photograph with the directions of its grain: yellow where it is clear, violet where it is unclear.
pub fn axes_png(image: &MetricImage, axes: &AxisGrid) -> Vec<u8> {
    with_strokes(&image.grey, &|p| axes.sample(image.place(p.x, p.y))).png()
}

/// A picture of a slice of a scan with the directions that were found in it.
fn texture(guide: &GrainGuide, slice: &ShownSlice) -> (String, Picture) {
    let ShownSlice { index, height_mm, pixel_mm, grey } = slice;
    // The range is that from 0.5 to 99.5 per cent of the voxels, because a few very bright or dark voxels
    // would flatten the contrast of all others.
    let (low, high) = (grey.quantile(0.005), grey.quantile(0.995));
    let range = (high - low).max(f32::MIN_POSITIVE);
    let data = grey.data.iter().map(|v| ((v - low) / range).clamp(0.0, 1.0)).collect();
    let axis = |p: DVec2| guide.scan_axis((p * *pixel_mm).extend(*height_mm)).unwrap_or_default();
    let png = with_strokes(&Grey { data, ..*grey }, &axis).png();
    let title = format!("Directions at height {height_mm:.2} mm in the scan: yellow clear, violet unclear");
    (format!("texture_{:04}.png", index + 1), Picture { title, png, ..Picture::default() })
}

/// A darkened copy of `grey`, whose rows run from the bottom, with strokes along the grain. Strokes are 14 pixels
/// of the drawing apart. `axis` gives the grain direction at a pixel of `grey`.
fn with_strokes(grey: &Grey, axis: &dyn Fn(DVec2) -> AxisSample) -> Canvas {
    let mut canvas = Canvas::new(grey, 0.55, true);
    let every = 14.0 / canvas.scale;
    let turned = |p: DVec2| DVec2::new(p.x, grey.height as f64 - p.y);
    for j in 0..(grey.height as f64 / every) as usize {
        for i in 0..(grey.width as f64 / every) as usize {
            let p = every * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
            let s = axis(p);
            let half = direction(s.axis_rad()) * 0.42 * every;
            // Colour-blind readers can tell yellow from violet, but not red from green.
            let c = (s.coherence * 255.0) as u8;
            canvas.line(&[turned(p - half), turned(p + half)], 1.6, [255, c, 255 - c]);
        }
    }
    canvas
}

struct Canvas {
    pixels: Pixmap,
    /// Number of pixels of the drawing along one pixel of the grey picture.
    scale: f64,
}

impl Canvas {
    /// Draws a grey picture, scaled to fit. `upwards` says that its rows run from the bottom.
    fn new(grey: &Grey, brightness: f32, upwards: bool) -> Self {
        let longest = grey.width.max(grey.height).max(1) as f64;
        // Small pictures are enlarged, up to six times, so that lines on them can be told apart.
        let scale = (LONGEST_PX / longest).min(6.0);
        let size = |n: usize| ((n as f64 * scale).round() as u32).max(1);
        let (w, h) = (size(grey.width), size(grey.height));
        let mut pixels = Pixmap::new(w, h).expect("a size from 1 to 1600 pixels");
        let mut small = grey.clone();
        let mut level = 1.0;
        // Halving averages the pixels that one pixel of the drawing covers. Without it, sampling would turn the
        // grain into false stripes (aliasing).
        while scale * level < 0.6 {
            small = small.halved();
            level *= 2.0;
        }
        for (k, pixel) in pixels.pixels_mut().iter_mut().enumerate() {
            let (x, row) = (k as u32 % w, k as u32 / w);
            let y = if upwards { h - 1 - row } else { row };
            let at = |v: u32| (f64::from(v) + 0.5) / (scale * level);
            let v = (small.sample(at(x), at(y)) * brightness * 255.0).clamp(0.0, 255.0) as u8;
            *pixel = PremultipliedColorU8::from_rgba(v, v, v, 255).expect("opaque");
        }
        Self { pixels, scale }
    }

    fn png(&self) -> Vec<u8> {
        encode_png(self.pixels.width(), self.pixels.height(), self.pixels.data())
    }

    /// Draws the numbers 1 to 4 beside the corners of a board, on the side of its middle.
    fn number_corners(&mut self, corners: [DVec2; 4]) {
        // Strokes of the digits in a box of 0.6 by 1, rows from the top. No font is used, since that would be
        // a dependency for four characters. Source: chosen by eye; only the picture depends on it.
        const DIGITS: [&[[f64; 2]]; 4] = [
            &[[0.1, 0.2], [0.35, 0.0], [0.35, 1.0]],
            &[[0.0, 0.2], [0.15, 0.0], [0.45, 0.0], [0.6, 0.2], [0.6, 0.4], [0.0, 1.0], [0.6, 1.0]],
            &[[0.0, 0.0], [0.6, 0.0], [0.25, 0.4], [0.6, 0.65], [0.5, 0.95], [0.2, 1.0], [0.0, 0.9]],
            &[[0.45, 1.0], [0.45, 0.0], [0.0, 0.7], [0.6, 0.7]],
        ];
        let middle = corners.iter().copied().sum::<DVec2>() * 0.25;
        // Digits are a sixteenth of the longer diagonal high, so that they can be read on any photograph.
        let height = corners[0].distance(corners[2]).max(corners[1].distance(corners[3])) / 16.0;
        for (corner, strokes) in corners.into_iter().zip(DIGITS) {
            let centre = corner + 1.2 * height * (middle - corner).normalize_or_zero();
            let place = |p: &[f64; 2]| centre + height * (DVec2::from(*p) - DVec2::new(0.3, 0.5));
            let points: Vec<DVec2> = strokes.iter().map(place).collect();
            // A white stroke under the red one keeps the digit legible on any wood.
            self.line(&points, 6.0, [255, 255, 255]);
            self.line(&points, 3.0, [255, 60, 40]);
        }
    }

    /// Draws a line through points, which are in pixels of the grey picture, rows from the top. The width is in
    /// pixels of the drawing.
    fn line(&mut self, points: &[DVec2], width: f32, [r, g, b]: [u8; 3]) {
        let mut builder = PathBuilder::new();
        for (k, p) in points.iter().enumerate() {
            let (x, y) = ((p.x * self.scale) as f32, (p.y * self.scale) as f32);
            if k == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        let Some(path) = builder.finish() else { return };
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color_rgba8(r, g, b, 255);
        let stroke = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
        self.pixels.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
    }
}
