//! A layer as PNG.

use grainpath_core::{Bounds2, DVec2};
use tiny_skia::{Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

use super::colour::Rgb;
use super::{DrawnBead, LayerPicture, PictureOptions, Scale};

/// Draws a layer, y upwards: each bead at its true width with a darker rim, which shows where beads
/// touch, overlap or leave a gap. An empty layer gives an empty picture.
pub fn layer_png(picture: &LayerPicture, options: &PictureOptions) -> Vec<u8> {
    let window = options.window.or(picture.bounds()).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
    let size = window.grown(0.02 * window.size().max_element() + 0.2);
    let scale = f64::from(options.size_px) / size.size().max_element().max(1e-9);
    let pixels = |mm: f64| ((mm * scale).ceil() as u32).clamp(1, options.size_px.max(1));
    let (w, h) = (pixels(size.size().x), pixels(size.size().y));
    let mut canvas = Pixmap::new(w, h).expect("the size is between 1 and what was asked for");
    canvas.fill(Color::from_rgba8(28, 30, 34, 255));
    let at = |p: DVec2| (((p.x - size.min.x) * scale) as f32, ((size.max.y - p.y) * scale) as f32);
    let colours = Scale::new(picture, options.colour_by);
    // Beads outside the window are left out, because they would cost time and draw nothing.
    let visible =
        |b: &&DrawnBead| Bounds2 { min: b.a.min(b.b), max: b.a.max(b.b) }.grown(0.5 * b.width_mm).meets(size);
    let beads: Vec<&DrawnBead> = picture.beads.iter().filter(visible).collect();
    // A run of pieces is drawn as one stroke, because separate strokes would show a rim at each joint.
    for run in beads.chunk_by(|x, y| x.goes_on_as(y)) {
        let base = colours.colour(run[0]);
        let rim: Rgb = base.map(|c| (f64::from(c) * 0.55) as u8);
        let width = (run[0].width_mm * scale) as f32;
        draw(&mut canvas, run, &at, width, rim);
        // The rim is one pixel on each side. On a bead of few pixels it is a tenth of the bead's width.
        draw(&mut canvas, run, &at, (width - 2.0).max(width * 0.8), base);
    }
    if options.travels {
        for &[a, b] in &picture.travels {
            draw_line(&mut canvas, &[at(a), at(b)], 1.0, [110, 190, 255], 150);
        }
    }
    // Cuts are drawn last, so that no bead hides them.
    for [a, b] in picture.cuts.iter().flat_map(|&p| super::cross_at(p)) {
        draw_line(&mut canvas, &[at(a), at(b)], (0.25 * scale) as f32, [255, 70, 70], 255);
    }
    png(w, h, canvas.data())
}

fn draw(canvas: &mut Pixmap, run: &[&DrawnBead], at: &impl Fn(DVec2) -> (f32, f32), width: f32, colour: Rgb) {
    let points: Vec<(f32, f32)> = std::iter::once(at(run[0].a)).chain(run.iter().map(|b| at(b.b))).collect();
    draw_line(canvas, &points, width, colour, 255);
}

pub(super) fn draw_line(canvas: &mut Pixmap, points: &[(f32, f32)], width: f32, [r, g, b]: Rgb, alpha: u8) {
    let mut builder = PathBuilder::new();
    builder.move_to(points[0].0, points[0].1);
    for p in &points[1..] {
        builder.line_to(p.0, p.1);
    }
    let Some(path) = builder.finish() else { return };
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, alpha);
    let stroke = Stroke {
        // A line thinner than half a pixel would be too faint to see.
        width: width.max(0.5),
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    canvas.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
}

/// Encodes opaque RGBA as PNG.
pub(crate) fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut w| w.write_image_data(rgba));
    written.expect("writing a PNG into memory cannot fail");
    out
}
