//! Pictures of the steps of making supports: overhangs and contacts seen from below, trees seen from the front
//! and from the side.

use grainpath_core::math::direction;
use grainpath_core::{DVec2, DVec3, TriMesh};
use tiny_skia::{Color, FillRule, LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

use crate::layer::encode_png;
use crate::mesh_pixels::nearest;
use grainpath::support::Support;
use grainpath::support::contact::Reason;
use grainpath::support::tree::Kind;

/// A picture of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepPicture {
    /// Part of the file name that names the picture.
    pub name: &'static str,
    /// What the picture shows.
    pub title: String,
    /// The PNG file.
    pub png: Vec<u8>,
}

/// Longest side of a picture, pixels, including the margin.
/// Source: chosen by eye; only the picture depends on it.
const SIZE: f64 = 1100.0;
// Margin on every side, pixels. Dots on the edge of the part must lie inside the picture.
// Source: chosen by eye; only the picture depends on it.
const MARGIN: f64 = 24.0;

/// The names of all [`pictures`].
pub const NAMES: [&str; 3] = ["overhangs", "trees_front", "trees_side"];

/// The pictures of all steps; none for a part without triangles.
pub fn pictures(mesh: &TriMesh, support: &Support) -> Vec<StepPicture> {
    let Some((low, high)) = mesh.bounds() else { return Vec::new() };
    // The box covers trees too, since they may stand beside the part, and the plate at z = 0.
    let low = support.forest.nodes.iter().fold(low, |l, n| l.min(n.at - n.radius_mm)).min(low.with_z(0.0));
    let high = support.forest.nodes.iter().fold(high, |h, n| h.max(n.at + n.radius_mm));
    let o = &support.overhangs;
    // Each view must be a rotation, because it would otherwise be a mirror image: from below both y and z
    // change their sign.
    let below = View::new(low, high, |p| DVec3::new(p.x, -p.y, -p.z));
    let front = View::new(low, high, |p| DVec3::new(p.x, p.z, -p.y));
    let side = View::new(low, high, |p| DVec3::new(p.y, p.z, p.x));
    let tree_title = |from: &str| {
        format!(
            "{} trees from the {from}: branches, joints (white), feet (blue), landings on the part (orange)",
            support.forest.n_trees()
        )
    };
    vec![
        StepPicture {
            name: NAMES[0],
            title: format!(
                "From below: {} regions beyond the critical angle (red), {} contacts: of facets (yellow), edges (cyan), \
                 lowest points (white); not reached (magenta)",
                o.regions,
                o.contacts.len()
            ),
            png: overhangs(mesh, support, &below),
        },
        StepPicture { name: NAMES[1], title: tree_title("front"), png: trees(mesh, support, &front) },
        StepPicture { name: NAMES[2], title: tree_title("right"), png: trees(mesh, support, &side) },
    ]
}

/// A view: its axes point to the right, upwards, and towards the eye.
struct View {
    turn: fn(DVec3) -> DVec3,
    low: DVec2,
    scale: f64,
    w: usize,
    h: usize,
}

impl View {
    fn new(low: DVec3, high: DVec3, turn: fn(DVec3) -> DVec3) -> Self {
        // These rotations only exchange axes and signs, so two opposite corners still span the turned box.
        let (a, b) = (turn(low), turn(high));
        let (lo, hi) = (a.min(b).truncate(), a.max(b).truncate());
        let size = (hi - lo).max(DVec2::splat(1e-6));
        let scale = (SIZE - 2.0 * MARGIN) / size.max_element();
        let pixels = |mm: f64| (mm * scale + 2.0 * MARGIN).ceil() as usize;
        Self { turn, low: lo, scale, w: pixels(size.x), h: pixels(size.y) }
    }

    /// The pixel of a point, and its nearness to the eye.
    fn at(&self, p: DVec3) -> DVec3 {
        let q = (self.turn)(p);
        let x = MARGIN + (q.x - self.low.x) * self.scale;
        let y = self.h as f64 - MARGIN - (q.y - self.low.y) * self.scale;
        DVec3::new(x, y, q.z)
    }
}

type Rgb = [f64; 3];

/// A shaded picture of the mesh; `colour` gives the colour of each facet.
fn shaded(mesh: &TriMesh, view: &View, colour: impl Fn(usize) -> Rgb) -> Pixmap {
    let mut canvas = Pixmap::new(view.w as u32, view.h as u32).expect("pictures have a size");
    canvas.fill(Color::from_rgba8(28, 30, 34, 255));
    // Unit vector towards the light, in pixels (y down): the light is at the upper left, on the eye's side.
    let light = DVec3::new(-0.4, -0.5, 0.77);
    let corners = |t: usize| mesh.triangles[t].map(|i| view.at(mesh.vertices[i as usize]));
    let shown = nearest((0..mesh.triangles.len()).map(corners), view.w, view.h);
    for (pixel, t) in canvas.data_mut().chunks_exact_mut(4).zip(shown) {
        let Some(t) = t else { continue };
        let [a, b, c] = corners(t);
        let n = (b - a).cross(c - a);
        // Normals are turned to the eye, so that inverted facets are drawn like others: the picture shows
        // the shape only.
        let facing = n.normalize_or_zero() * n.z.signum();
        let shade = 0.35 + 0.65 * facing.dot(light).max(0.0);
        pixel[..3].copy_from_slice(&colour(t).map(|v| (v * shade).clamp(0.0, 255.0) as u8));
    }
    canvas
}

fn dot(canvas: &mut Pixmap, p: DVec3, r: f64, [red, green, blue]: [u8; 3]) {
    let mut builder = PathBuilder::new();
    // At a radius of 3 pixels, twelve corners look like a circle.
    for i in 0..12 {
        let d = direction(f64::from(i) / 12.0 * std::f64::consts::TAU) * r;
        let (x, y) = ((p.x + d.x) as f32, (p.y + d.y) as f32);
        if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
    }
    builder.close();
    let Some(path) = builder.finish() else { return };
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, 255);
    canvas.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
}

fn line(canvas: &mut Pixmap, a: DVec3, b: DVec3, width: f64, [red, green, blue]: [u8; 3]) {
    let mut builder = PathBuilder::new();
    builder.move_to(a.x as f32, a.y as f32);
    builder.line_to(b.x as f32, b.y as f32);
    let Some(path) = builder.finish() else { return };
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, 215);
    let stroke = Stroke { width: width.max(0.8) as f32, line_cap: LineCap::Round, ..Stroke::default() };
    canvas.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
}

fn overhangs(mesh: &TriMesh, support: &Support, view: &View) -> Vec<u8> {
    let mut hangs = vec![false; mesh.triangles.len()];
    support.overhangs.facets.iter().for_each(|&t| hangs[t as usize] = true);
    let mut canvas =
        shaded(mesh, view, |t| if hangs[t] { [214.0, 74.0, 66.0] } else { [150.0, 156.0, 166.0] });
    for c in &support.overhangs.contacts {
        let missing = support.unreached.iter().any(|u| u.at == c.at);
        let colour = match c.reason {
            // A contact without support is magenta whatever its reason, because the reader looks for these
            // contacts.
            _ if missing => [255, 60, 235],
            Reason::Facets => [250, 215, 70],
            Reason::Edge => [80, 220, 230],
            Reason::Lowest => [255, 255, 255],
        };
        dot(&mut canvas, view.at(c.at), 2.6, colour);
    }
    encode_png(canvas.width(), canvas.height(), canvas.data())
}

fn trees(mesh: &TriMesh, support: &Support, view: &View) -> Vec<u8> {
    // The part is drawn dark, and all trees are drawn on top of it, so that no branch is hidden.
    let mut canvas = shaded(mesh, view, |_| [96.0, 101.0, 110.0]);
    for (a, b) in support.forest.branches() {
        let width = (a.radius_mm + a.end_mm) * view.scale;
        let colour = if a.post { [230, 160, 60] } else { [70, 190, 90] };
        line(&mut canvas, view.at(a.at), view.at(b.at), width, colour);
    }
    for n in &support.forest.nodes {
        match n.kind {
            Kind::Join => dot(&mut canvas, view.at(n.at), 1.8, [255, 255, 255]),
            Kind::Foot => dot(&mut canvas, view.at(n.at), 3.0, [80, 140, 240]),
            Kind::Landing => dot(&mut canvas, view.at(n.at), 3.0, [250, 150, 50]),
            Kind::Contact(_) => dot(&mut canvas, view.at(n.at), 1.6, [250, 215, 70]),
            Kind::Tip | Kind::Bend => {}
        }
    }
    for u in &support.unreached {
        dot(&mut canvas, view.at(u.at), 3.0, [255, 60, 235]);
    }
    encode_png(canvas.width(), canvas.height(), canvas.data())
}
