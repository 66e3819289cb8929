//! Pictures of the guide of a fill: stress, principal stress lines, directions.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;

use grainpath::guide::{Degenerate, Families, Guide, ResultSurface};
use grainpath_core::math::{atan2, direction};
use grainpath_core::poly::LineClipper;
use grainpath_core::streamlines::TracedLine;
use grainpath_core::{Bounds2, DVec2, DVec3, Region};
use grainpath_fea::principal::von_mises_plane;
use grainpath_fea::resultant::Resultant;

use crate::layer::{Canvas, Ramp};
use crate::mesh_pixels::nearest;

/// A picture of the von Mises stress over a section of the part, with the principal stress lines of both
/// families. Degenerate points are marked: wedges by circles, trisectors by triangles, points on the border
/// by squares. The second value is the scale of the colours, MPa.
pub fn stress_png(
    guide: &Guide,
    layer: usize,
    region: &Region,
    z_mm: f64,
    families: &Families,
    size_px: u32,
) -> (Vec<u8>, Ramp) {
    let Some(bounds) = region.bounds() else { return (Vec::new(), Ramp { low: 0.0, high: 0.0 }) };
    let mut canvas = Canvas::over(bounds, size_px);
    let inside = LineClipper::new(region);
    let stress = guide.main_case();
    let mut values: Vec<f64> = Vec::new();
    let all: Vec<Option<f64>> = canvas
        .pixels()
        .map(|p| inside.contains(p).then(|| von_mises_plane(stress.at(p.extend(z_mm)))))
        .inspect(|v| values.extend(v))
        .collect();
    values.sort_by(f64::total_cmp);
    // The scale ends at 99.5 per cent of the pixels: the stress at a re-entrant corner has no bound, and
    // its peak would leave one colour for all other places.
    let high = values.get(values.len() * 995 / 1000).copied().unwrap_or(1.0);
    let ramp = Ramp { low: 0.0, high };
    canvas.paint(all.into_iter().map(|v| v.map(|v| ramp.colour(v))));
    // Lines of the greater principal stress are white, those of the smaller nearly black, because both show
    // on every colour of the ramp.
    for (lines, colour) in families.iter().zip([[255, 255, 255], [20, 20, 30]]) {
        lines.iter().for_each(|l| canvas.line(&closed_points(l), 1.2, colour, 190));
    }
    // The size of marks scales with the part, so that they have the same size on every picture.
    let radius = bounds.size().max_element() / 130.0;
    // Three lines meet at a trisector, so its mark has three corners.
    for (kind, p) in &guide.degenerate(layer).points {
        let sides = match kind {
            Degenerate::Wedge => 24,
            Degenerate::Trisector => 3,
            Degenerate::Border => 4,
        };
        let turn = |k: i32| FRAC_PI_2 + TAU * f64::from(k) / f64::from(sides);
        let ring: Vec<DVec2> = (0..=sides).map(|k| *p + radius * direction(turn(k))).collect();
        canvas.line(&ring, 2.5, [255, 60, 220], 255);
    }
    (canvas.png(), ramp)
}

/// The part as it moves under its loads, seen along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct DeformedPicture {
    /// The picture: the moved part coloured by its displacement, and the edges at rest in grey.
    pub png: Vec<u8>,
    /// The load case that is shown, which moves the part most.
    pub case: String,
    /// The largest displacement, mm, which is drawn red.
    pub max_mm: f64,
    /// Factor by which displacements are magnified.
    pub magnified: f64,
    /// The axis along which the part is seen.
    pub view: char,
}

/// Length at which the largest displacement is drawn, as a share of the part's longest side. It is seen at a glance, and
/// the shape stays recognisable. Source: chosen by eye; only the picture depends on it.
const DRAWN_DISPLACEMENT: f64 = 0.06;

/// Brightness of a face that is seen edge-on, beside 1 for a face towards the eye. Source: chosen by eye.
const DIMMEST: f64 = 0.6;
/// Cosine of the least angle between faces whose common edge is drawn. Source: derived: 30 degrees, above the angles between
/// the faces of a round wall of twelve sides.
const EDGE_COSINE: f64 = 0.866;

/// The deformed shape of the case that moves most, seen along the axis of least motion; `None` without displacements.
pub fn deformed_png(guide: &Guide, size_px: u32) -> Option<DeformedPicture> {
    let largest = |moved: &[DVec3]| moved.iter().map(|u| u.length()).fold(0.0, f64::max);
    let moving = guide.results.iter().filter_map(|r| Some((r, r.displacement.as_deref()?)));
    let (result, moved) = moving.max_by(|a, b| largest(a.1).total_cmp(&largest(b.1)))?;
    let max_mm = largest(moved);
    if max_mm <= 0.0 {
        return None;
    }
    let motion = moved.iter().fold(DVec3::ZERO, |sum, u| sum + u.abs());
    // Among equal axes the last one is taken, so that plates are seen from above.
    let view = (0..3).rev().min_by(|a, b| motion[*a].total_cmp(&motion[*b]))?;
    // To the right, upwards, and towards the eye.
    let axes = match view {
        0 => [DVec3::Y, DVec3::Z, DVec3::X],
        1 => [DVec3::X, DVec3::Z, DVec3::NEG_Y],
        _ => [DVec3::X, DVec3::Y, DVec3::Z],
    };
    let flat = |p: DVec3| DVec2::new(p.dot(axes[0]), p.dot(axes[1]));
    let (low, high) = result
        .nodes
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    let magnified = DRAWN_DISPLACEMENT * (high - low).max_element() / max_mm;
    let grown = DVec2::splat(magnified * max_mm);
    let mut canvas = Canvas::over(Bounds2 { min: flat(low) - grown, max: flat(high) + grown }, size_px);
    // A plate is seen from above, where its thickness does not show: it gets none.
    let surface = result.surface(low.z);
    let shift = |i: u32| moved[surface.nodes[i as usize] as usize];
    let at_rest = |i: u32| surface.points[i as usize];
    let at = |i: u32| at_rest(i) + magnified * shift(i);
    let on_picture = |p: DVec3| canvas.pixel_of(flat(p)).extend(p.dot(axes[2]) * canvas.scale());
    let (width, height) = canvas.size();
    let seen = |place: &dyn Fn(u32) -> DVec3| {
        nearest(surface.triangles.iter().map(|t| t.map(|i| on_picture(place(i)))), width, height)
    };
    let (shown_at_rest, shown) = (seen(&at_rest), seen(&at));
    let ramp = Ramp { low: 0.0, high: max_mm };
    let colour = |(pixel, shown): (DVec2, &Option<usize>)| {
        let corners = surface.triangles[(*shown)?];
        let [a, b, c] = corners.map(|i| flat(at(i)));
        let twice = (b - a).perp_dot(c - a);
        let (u, v) = ((pixel - a).perp_dot(c - a) / twice, (b - a).perp_dot(pixel - a) / twice);
        let [first, second, third] = corners.map(|i| shift(i).length());
        let bright = DIMMEST + (1.0 - DIMMEST) * normal(corners.map(at)).dot(axes[2]).abs();
        let colour = ramp.colour(first + u * (second - first) + v * (third - first));
        Some(colour.map(|part| (bright * f64::from(part)).round() as u8))
    };
    // All colours are found before the first is painted, since the picture lends its measures to them.
    let painted: Vec<_> = canvas.pixels().zip(&shown).map(colour).collect();
    canvas.paint(painted.into_iter());
    let edges = bent_edges(&surface);
    for line in visible(&edges, &|k| flat(at_rest(k)), &shown_at_rest, &canvas) {
        canvas.line(&line, 1.6, [170, 174, 180], 170);
    }
    for line in visible(&edges, &|k| flat(at(k)), &shown, &canvas) {
        canvas.line(&line, 1.2, [14, 15, 17], 255);
    }
    let view = ['x', 'y', 'z'][view];
    Some(DeformedPicture { png: canvas.png(), case: result.name.clone(), max_mm, magnified, view })
}

/// The unit normal of a triangle; zero where it has no area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// An edge of a surface: its two points, and the triangles on its sides.
struct Edge {
    points: [u32; 2],
    triangles: Vec<usize>,
}

/// The edges at which a surface bends or ends.
fn bent_edges(surface: &ResultSurface) -> Vec<Edge> {
    let mut sides: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * surface.triangles.len());
    for (t, corners) in surface.triangles.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (corners[k], corners[(k + 1) % 3]);
            sides.push(([i.min(j), i.max(j)], t));
        }
    }
    sides.sort_unstable();
    let of = |t: usize| normal(surface.triangles[t].map(|i| surface.points[i as usize]));
    let of_edge = sides.chunk_by(|a, b| a.0 == b.0);
    // An edge of one triangle is the end of the surface; one of more than two is where bodies touch.
    let bends = |same: &&[([u32; 2], usize)]| !matches!(same, [one, other] if of(one.1).dot(of(other.1)) >= EDGE_COSINE);
    let edge = |same: &[([u32; 2], usize)]| Edge {
        points: same[0].0,
        triangles: same.iter().map(|side| side.1).collect(),
    };
    of_edge.filter(bends).map(edge).collect()
}

/// Distance between the places at which an edge is tested for being hidden, pixels. Source: chosen by eye.
const HIDDEN_STEP_PX: f64 = 4.0;

/// The pieces of edges that no face hides. `shown` is the triangle of each pixel; an edge is seen where a pixel beside it
/// shows one of its triangles.
fn visible(
    edges: &[Edge],
    place: &dyn Fn(u32) -> DVec2,
    shown: &[Option<usize>],
    canvas: &Canvas,
) -> Vec<[DVec2; 2]> {
    let (width, height) = canvas.size();
    let is_seen = |edge: &Edge, p: DVec2| {
        let at = canvas.pixel_of(p);
        // An edge lies between pixels, and its own triangles may show a pixel beside it.
        let around = |v: f64, n: usize| {
            let v = v.max(0.0) as usize;
            v.saturating_sub(1)..(v + 2).min(n)
        };
        around(at.y, height).any(|y| {
            around(at.x, width).any(|x| shown[y * width + x].is_some_and(|t| edge.triangles.contains(&t)))
        })
    };
    let mut out = Vec::new();
    for edge in edges {
        let [a, b] = edge.points.map(place);
        let n = (a.distance(b) * canvas.scale() / HIDDEN_STEP_PX).ceil().max(1.0);
        for k in 0..n as usize {
            let [from, middle, to] = [0.0, 0.5, 1.0].map(|part| a.lerp(b, (k as f64 + part) / n));
            if is_seen(edge, middle) {
                out.push([from, to]);
            }
        }
    }
    out
}

/// Length of the arrow of the largest force, as a share of the part's longest side. The arrow is
/// visible beside the part and not longer than it.
/// Source: derived: a margin of 1.3 arrows leaves half of the picture to the part.
const ARROW: f64 = 0.22;
/// An arrow below this share of the largest, or of all forces of a load at nodes, is not drawn. Source: derived: it is too short to
/// see, 2 px of a picture of 1000.
const LEAST_ARROW: f64 = 0.01;
/// Colours of loads, reactions and moments. Source: derived: they differ in brightness, for readers who see red like green.
const ARROW_COLOURS: [[u8; 3]; 3] = [[255, 90, 80], [90, 220, 120], [255, 200, 70]];

/// The loads and reactions of the first load case as arrows over the edges of the mesh, seen from the front and above.
/// The arrow of a force ends where the force acts, and its length is proportional to the force. Loads are red, reactions
/// of fixtures green. A moment is a yellow arrow with two heads along its axis. A
/// load whose forces cancel, such as that of a part that turns about its middle, has none. `None` where nothing was solved.
pub fn loads_png(guide: &Guide, size_px: u32) -> Option<Vec<u8>> {
    let (result, balance) = (guide.results.first()?, guide.summary.balance.first()?);
    let towards = DVec3::new(0.5, -0.75, 0.43).normalize();
    let right = DVec3::Z.cross(towards).normalize();
    let up = towards.cross(right);
    let flat = |p: DVec3| DVec2::new(p.dot(right), p.dot(up));
    let bounds = result.nodes.iter().map(|p| flat(*p)).fold(None::<Bounds2>, |all, p| {
        let here = Bounds2 { min: p, max: p };
        Some(all.map_or(here, |b| b.union(here)))
    })?;
    let reach = ARROW * bounds.size().max_element();
    let mut canvas = Canvas::over(bounds.grown(1.3 * reach), size_px);
    for [i, j] in result.surface_edges() {
        canvas.line(&[i, j].map(|k| flat(result.nodes[k as usize])), 1.0, [120, 124, 130], 110);
    }
    for (name, nodes) in &result.sets {
        let is_load = balance.loads.iter().any(|l| l.name == *name);
        let colour = ARROW_COLOURS[usize::from(!is_load)];
        for p in nodes.iter().map(|n| flat(result.nodes[*n as usize])) {
            canvas.line(&[p, p + DVec2::new(1e-3 * reach, 0.0)], 3.0, colour, 160);
        }
    }
    let all = || balance.loads.iter().map(|r| (r, 0)).chain(balance.reactions.iter().map(|r| (r, 1)));
    let largest = |size: fn(&Resultant) -> f64| all().map(|(r, _)| size(r)).fold(0.0, f64::max);
    let (force, moment) = (largest(|r| r.force_n.length()), largest(|r| r.moment_nmm.length()));
    // Forces of a load that cancel one another leave rounding errors and errors of the mesh, which are no force.
    let of_loads = |amount: fn(&Resultant) -> f64| balance.loads.iter().map(amount).fold(0.0, f64::max);
    let least_force = LEAST_ARROW * force.max(of_loads(|r| r.amount_n));
    let mut least_moment = LEAST_ARROW * moment.max(of_loads(|r| r.moment_amount_nmm));
    // Where neither is left of a load, its reactions are errors of the mesh, with levers of the size of the part.
    let cancels = |r: &&Resultant| {
        r.force_n.length() <= least_force && r.moment_nmm.length() <= LEAST_ARROW * r.moment_amount_nmm
    };
    for r in balance.loads.iter().filter(cancels) {
        least_moment = least_moment.max(LEAST_ARROW * r.amount_n * bounds.size().max_element());
    }
    for (r, kind) in all() {
        let at = flat(r.centroid_mm);
        if r.force_n.length() > least_force {
            arrow(&mut canvas, at, flat(r.force_n) * (reach / force), reach, 1, ARROW_COLOURS[kind]);
        } else if r.moment_nmm.length() > least_moment {
            // A load or reaction with a force may also have a moment about its centroid; only the report states it.
            arrow(&mut canvas, at, flat(r.moment_nmm) * (reach / moment), reach, 2, ARROW_COLOURS[2]);
        }
    }
    Some(canvas.png())
}

/// An arrow that ends at a point, with one head or two.
fn arrow(canvas: &mut Canvas, end: DVec2, along: DVec2, reach: f64, heads: usize, colour: [u8; 3]) {
    canvas.line(&[end - along, end], 3.0, colour, 255);
    let Some(way) = along.try_normalize() else { return };
    let (back, side) = (way * (0.12 * reach), way.perp() * (0.06 * reach));
    for k in 0..heads {
        let tip = end - back * k as f64;
        canvas.line(&[tip - back + side, tip, tip - back - side], 3.0, colour, 255);
    }
}

/// The directions that the fill follows in a layer, as short strokes. The length of a stroke shows its
/// weight.
pub fn field_png(guide: &Guide, layer: usize, region: &Region, z_mm: f64, size_px: u32) -> Vec<u8> {
    let Some(bounds) = region.bounds() else { return Vec::new() };
    let mut canvas = Canvas::over(bounds, size_px);
    let inside = LineClipper::new(region);
    for contour in region.contours() {
        let mut ring = contour.clone();
        ring.extend(contour.first().copied());
        canvas.line(&ring, 1.5, [200, 204, 210], 255);
    }
    // Ninety strokes along the longer side have 18 pixels each on a picture of 1600 pixels.
    let pitch = (bounds.size().max_element() / 90.0).max(1e-3);
    let field = guide.layer(layer);
    // Angles from 0 to 180 degrees use the whole ramp. Its two ends mean the same direction but differ in
    // colour; this does no harm, since the stroke itself shows the angle.
    let ramp = Ramp { low: 0.0, high: std::f64::consts::PI };
    let Bounds2 { min, max } = bounds;
    let mut y = min.y + 0.5 * pitch;
    while y < max.y {
        let mut x = min.x + 0.5 * pitch;
        while x < max.x {
            let p = DVec2::new(x, y);
            if inside.contains(p) {
                let sample = field.sample(p.extend(z_mm));
                // A stroke without weight keeps a visible length, and one of full weight reaches a little
                // past its cell.
                let half = direction(sample.axis_rad) * (pitch * (0.15 + 0.4 * sample.strength));
                canvas.line(&[p - half, p + half], 2.0, ramp.colour(sample.axis_rad), 255);
            }
            x += pitch;
        }
        y += pitch;
    }
    canvas.png()
}

fn closed_points(line: &TracedLine) -> Vec<DVec2> {
    // A closed line holds its first point once; for drawing, the point is repeated at the end.
    let mut points = line.points.clone();
    if line.closed {
        points.extend(line.points.first().copied());
    }
    points
}

/// Both families of principal stress lines as SVG in mm: those of the greater stress red, those of the smaller blue.
pub fn lines_svg(region: &Region, families: &Families) -> String {
    // An empty section gets a window of 1 mm, because viewers refuse an SVG without size.
    let bounds = region.bounds().unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE }).grown(1.0);
    let size = bounds.size();
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.3}mm\" height=\"{:.3}mm\" viewBox=\"0 0 {:.3} {:.3}\">\n",
        size.x, size.y, size.x, size.y
    );
    let path = |points: &[DVec2], closed: bool| {
        let mut d = String::new();
        for (i, p) in points.iter().enumerate() {
            let letter = if i == 0 { 'M' } else { 'L' };
            // y changes its sign, because it points downwards in SVG.
            let _ = write!(d, "{letter}{:.4} {:.4}", p.x - bounds.min.x, bounds.max.y - p.y);
        }
        if closed {
            d.push('Z');
        }
        d
    };
    let outline: String = region.contours().map(|c| path(c, true)).collect();
    let _ = writeln!(out, "<path d=\"{outline}\" fill=\"none\" stroke=\"#444\" stroke-width=\"0.15\"/>");
    for (lines, (id, colour)) in families.iter().zip([("greater", "#d33"), ("smaller", "#36c")]) {
        let _ = writeln!(out, "<g id=\"{id}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.12\">");
        for line in lines {
            let _ = writeln!(out, "<path d=\"{}\"/>", path(&line.points, line.closed));
        }
        out.push_str("</g>\n");
    }
    out + "</svg>\n"
}

/// Both families of principal stress lines as VTP (VTK's PolyData in XML, ASCII) at height `z_mm`. Each line
/// has its `family`: 1 for the greater principal stress, 2 for the smaller. Each point has the angle of the
/// line there, in degrees.
pub fn lines_vtp(families: &Families, z_mm: f64) -> String {
    let (mut points, mut angles, mut nodes, mut offsets, mut family) =
        (String::new(), String::new(), String::new(), String::new(), String::new());
    let (mut n, mut end, mut n_lines) = (0, 0, 0);
    for (f, lines) in families.iter().enumerate() {
        for line in lines {
            let first = n;
            let count = line.points.len();
            // The angle at a point is that of the segment after it; the last point takes the segment
            // before it.
            for (i, p) in line.points.iter().enumerate() {
                let next = line.points[(i + 1).min(count - 1)];
                let d = if next == *p && i > 0 { *p - line.points[i - 1] } else { next - *p };
                let _ = write!(points, "{:.6} {:.6} {z_mm:.6} ", p.x, p.y);
                let _ = write!(angles, "{:.4} ", atan2(d.y, d.x).to_degrees());
                let _ = write!(nodes, "{n} ");
                n += 1;
            }
            // VTK's offsets give the end of each cell in the list of nodes, not its beginning. In this list a
            // closed line repeats its first node, but the point of this node is written only once.
            end += count;
            if line.closed {
                let _ = write!(nodes, "{first} ");
                end += 1;
            }
            n_lines += 1;
            let _ = write!(offsets, "{end} ");
            let _ = write!(family, "{} ", f + 1);
        }
    }
    // Source: VTK File Formats (Kitware), serial XML files, PolyData. The piece states all five counts,
    // including those that are zero.
    format!(
        "<?xml version=\"1.0\"?>
<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">
<PolyData><Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"0\" NumberOfLines=\"{n_lines}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">
<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points>
<PointData><DataArray type=\"Float64\" Name=\"angle_deg\" format=\"ascii\">{angles}</DataArray></PointData>
<CellData><DataArray type=\"UInt8\" Name=\"family\" format=\"ascii\">{family}</DataArray></CellData>
<Lines><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{nodes}</DataArray>
<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{offsets}</DataArray></Lines>
</Piece></PolyData></VTKFile>
"
    )
}
