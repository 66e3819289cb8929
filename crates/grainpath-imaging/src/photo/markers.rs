//! A sheet with four corner markers. The user prints it, lays the board on it, and photographs both.
//!
//! A marker is a black square of 12 mm with a white ring in it (2 mm wide each) and an inner square of 4
//! mm. The black share of the inner square names the corner: 0 for the upper left one, then clockwise
//! 1/3, 1 and 2/3. Rotation and mirroring do not change a share, so each marker identifies its corner.
//! The order of the corners around the sheet then reveals a mirrored photograph, in which the grain would
//! be mirrored too.
//!
//! ```text
//!   upper left      upper right     lower right     lower left      (#: black)
//!   ############    ############    ############    ############
//!   ##        ##    ##        ##    ##        ##    ##        ##
//!   ##        ##    ##   ##   ##    ##  ####  ##    ##  #  #  ##
//!   ##        ##    ##   ##   ##    ##  ####  ##    ##  #  #  ##
//!   ##        ##    ##        ##    ##        ##    ##        ##
//!   ############    ############    ############    ############
//! ```
//!
//! Sheets printed before these shares existed have a white inner square at the upper left and three black ones. They
//! are still read, but a mirrored photograph of them is not noticed; [`FoundMarkers::sheet`] says which
//! sheet it was.
//!
//! Detection: pixels darker than 3/4 of the brightness around them form pieces. The convex hull of a
//! piece is reduced to four sides, and the pattern inside is read through the homography of those sides.
//! A dark ground around the white sheet is such a ring as well, so a piece around others is left out. Of
//! the rest, the four whose sides lie in line with each other are the sheet.
//! The cost is linear in the pixels of a picture shrunk to at most 1400 px; the corners are then refined
//! in the full picture. Tests cover level, rotated, mirrored, blurred and half shaded views, views
//! tilted by up to 60 degrees, and grounds from black to white.

use std::fmt::Write;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, cross};

use super::corners::{
    CornersNotFound, four_sides, hull, on_border, pieces, refined, shrunk, sorted, square_to,
};
use crate::raster::Grey;

/// Side of a marker, mm. Rim and white ring are a sixth of it wide, the inner square is a third.
/// Source: chosen; at six pixels a millimetre a ring is twelve pixels wide, so that blur of some pixels leaves it
/// whole.
pub(crate) const MARKER_MM: f64 = 12.0;

/// The sheet that a photograph shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sheet {
    /// The sheet with four different markers: corners and handedness are certain.
    FourShares,
    /// The older sheet, with one white and three black inner squares: handedness is unknown.
    OneWhite,
}

/// The result of [`find_markers`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundMarkers {
    /// Corners of the rectangle between the markers, px: upper left, upper right, lower right, lower left of the sheet.
    pub corners: [DVec2; 4],
    /// The sheet that was recognised.
    pub sheet: Sheet,
}

/// The sheet for a board of this size, as SVG with the millimetre as its unit. The inner corners of the four markers
/// are the corners of a rectangle of `size_mm`: `corners = "markers"` reads the picture between them.
pub fn marker_sheet_svg(size_mm: DVec2) -> String {
    // 5 mm of white around the markers: office printers cannot print closer to the edge of the page.
    let margin = MARKER_MM + 5.0;
    let (w, h) = (size_mm.x + 2.0 * margin, size_mm.y + 2.0 * margin);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\">\n\
         <title>grainpath corner markers for {} x {} mm; print at 100 %</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n",
        size_mm.x, size_mm.y
    );
    for Patch { low, size, black } in patches(size_mm) {
        let fill = if black { "#000" } else { "#fff" };
        let _ = writeln!(
            out,
            "<rect x=\"{:.4}\" y=\"{:.4}\" width=\"{:.4}\" height=\"{:.4}\" fill=\"{fill}\"/>",
            low.x + margin,
            low.y + margin,
            size.x,
            size.y
        );
    }
    let _ = writeln!(
        out,
        "<rect x=\"{margin}\" y=\"{margin}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#bbb\" stroke-width=\"0.2\" stroke-dasharray=\"2 2\"/>\n</svg>",
        size_mm.x, size_mm.y
    );
    out
}

/// The same sheet as a PDF file with one page of the size of the sheet.
pub fn marker_sheet_pdf(size_mm: DVec2) -> Vec<u8> {
    // Source: ISO 32000-1, 8.3.2.3: the unit of user space in PDF is 1/72 inch.
    const POINTS_PER_MM: f64 = 72.0 / 25.4;
    let margin = MARKER_MM + 5.0;
    let (w, h) = (size_mm.x + 2.0 * margin, size_mm.y + 2.0 * margin);
    let mut drawing = format!("{POINTS_PER_MM:.6} 0 0 {POINTS_PER_MM:.6} 0 0 cm\n");
    for Patch { low, size, black } in patches(size_mm) {
        // The origin of a page of PDF is its lower left corner.
        let (x, y) = (low.x + margin, h - (low.y + margin) - size.y);
        let _ = writeln!(drawing, "{} g {x:.4} {y:.4} {:.4} {:.4} re f", i32::from(!black), size.x, size.y);
    }
    let _ = writeln!(drawing, "0.7 G 0.2 w [2 2] 0 d {margin} {margin} {} {} re S", size_mm.x, size_mm.y);
    let objects = [
        "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.3} {:.3}] /Contents 4 0 R /Resources << >> >>",
            w * POINTS_PER_MM,
            h * POINTS_PER_MM
        ),
        format!("<< /Length {} >>\nstream\n{drawing}endstream", drawing.len()),
    ];
    let mut out = "%PDF-1.4\n".to_owned();
    let mut places = Vec::new();
    for (k, object) in objects.iter().enumerate() {
        // The cross-reference table lists the byte offset of every object.
        places.push(out.len());
        let _ = write!(out, "{} 0 obj\n{object}\nendobj\n", k + 1);
    }
    let table = out.len();
    let _ = write!(out, "xref\n0 {}\n0000000000 65535 f \n", objects.len() + 1);
    for p in places {
        let _ = writeln!(out, "{p:010} 00000 n ");
    }
    let _ =
        write!(out, "trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF\n", objects.len() + 1);
    out.into_bytes()
}

/// A filled rectangle of the sheet, mm from the rectangle's upper left corner, rows downwards.
struct Patch {
    low: DVec2,
    size: DVec2,
    black: bool,
}

/// Black stripes of the inner square of each marker, from and to as shares of its width: upper left,
/// upper right, lower right, lower left. Source: the shares 0, 1/3, 1 and 2/3 of the module text,
/// which are as far apart as four values can be.
const STRIPES: [&[[f64; 2]]; 4] =
    [&[], &[[1.0 / 3.0, 2.0 / 3.0]], &[[0.0, 1.0]], &[[0.0, 1.0 / 3.0], [2.0 / 3.0, 1.0]]];

/// The rectangles that make up the four markers. Later ones cover earlier ones.
fn patches(size_mm: DVec2) -> Vec<Patch> {
    let m = MARKER_MM;
    let places = [
        DVec2::new(-m, -m),
        DVec2::new(size_mm.x, -m),
        DVec2::new(size_mm.x, size_mm.y),
        DVec2::new(-m, size_mm.y),
    ];
    let mut out = Vec::new();
    for (low, stripes) in places.into_iter().zip(STRIPES) {
        out.push(Patch { low, size: DVec2::splat(m), black: true });
        out.push(Patch { low: low + m / 6.0, size: DVec2::splat(m * 4.0 / 6.0), black: false });
        let inner = m / 3.0;
        for [from, to] in stripes {
            let corner = low + inner + DVec2::new(from * inner, 0.0);
            out.push(Patch { low: corner, size: DVec2::new((to - from) * inner, inner), black: true });
        }
    }
    out
}

/// A marker found in a photograph.
#[derive(Clone, Copy)]
struct Seen {
    /// Its corners, clockwise as seen, px.
    corners: [DVec2; 4],
    /// The corner of the sheet that the marker names, from 0 at the upper left, clockwise.
    index: usize,
}

impl Seen {
    fn centre(&self) -> DVec2 {
        self.corners.iter().copied().sum::<DVec2>() * 0.25
    }

    fn area(&self) -> f64 {
        0.5 * cross(self.corners[2] - self.corners[0], self.corners[3] - self.corners[1])
    }

    fn contains(&self, p: DVec2) -> bool {
        let c = &self.corners;
        // Rows run downwards, so the inside of a clockwise ring has positive cross products.
        (0..4).all(|k| cross(c[(k + 1) % 4] - c[k], p - c[k]) > 0.0)
    }
}

/// Greatest number of pieces that are tried as the markers of a sheet; the largest are kept. Source: chosen; the
/// markers of four sheets. It bounds the number of sheets tried to a few hundred.
const MOST_SEEN: usize = 16;
/// Sine of the greatest angle between the side of a marker and the side of the sheet in line with it. Source: derived. A corner
/// of the smallest marker, ten pixels wide, is found to 1.5 pixels; as much again is left for paper that curls.
const OUT_OF_LINE: f64 = 0.3;

/// Finds the corners between a sheet's markers in a photograph.
///
/// # Errors
/// [`CornersNotFound::Markers`] unless the four of a sheet are there, [`CornersNotFound::Mirrored`] for a
/// mirrored photograph.
pub fn find_markers(photo: &Grey) -> Result<FoundMarkers, CornersNotFound> {
    let mut seen = seen_markers(photo);
    let centres: Vec<DVec2> = seen.iter().map(Seen::centre).collect();
    // A marker has nothing in it that reads as a marker; the ground around a sheet has four.
    seen.retain(|m| centres.iter().filter(|c| m.contains(**c)).count() < 2);
    // The largest are kept: a photograph of the sheet shows its markers larger than the print on anything beside it.
    seen.sort_by(|a, b| b.area().total_cmp(&a.area()));
    seen.truncate(MOST_SEEN);
    let fitting = rings(&seen).into_iter().filter_map(|(ring, sheet)| {
        let corners = inner_corners(&ring)?;
        let off = out_of_line(&ring, corners);
        (off < OUT_OF_LINE).then_some((off, ring, corners, sheet))
    });
    // Of several rings that could be a sheet, the one whose sides are straightest.
    let Some((_, ring, corners, sheet)) = fitting.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        let count = |index: usize| seen.iter().filter(|m| m.index == index).count();
        let named = (0..4).filter(|&index| count(index) > 0).count();
        // Three black squares may belong to an older sheet. Four pieces that form no sheet are not its four.
        let found = named.max(count(0).min(1) + count(2).min(3)).min(3);
        return Err(CornersNotFound::Markers { found });
    };
    let [a, b, c, d] = ring.map(|m| m.centre());
    // Rows run downwards, so a positive cross product is clockwise as seen.
    if sheet == Sheet::FourShares && cross(c - a, d - b) < 0.0 {
        return Err(CornersNotFound::Mirrored);
    }
    Ok(FoundMarkers { corners, sheet })
}

/// All choices of four markers with the names of a sheet, in the order of its corners.
fn rings(seen: &[Seen]) -> Vec<([Seen; 4], Sheet)> {
    let named = |index: usize| seen.iter().filter(move |m| m.index == index).copied();
    let mut out = Vec::new();
    for first in named(0) {
        for second in named(1) {
            for third in named(2) {
                out.extend(named(3).map(|fourth| ([first, second, third, fourth], Sheet::FourShares)));
            }
        }
        // One white and three black squares are those of the older sheet. Only the order tells which corner a black
        // square belongs to.
        // An older sheet has one marker with a white square and three black ones.
        let black: Vec<Seen> = named(2).collect();
        for (i, &a) in black.iter().enumerate() {
            for (j, &b) in black.iter().enumerate().skip(i + 1) {
                let rest = black.iter().skip(j + 1);
                out.extend(rest.map(|&c| (clockwise_from_first([first, a, b, c]), Sheet::OneWhite)));
            }
        }
    }
    out
}

/// The corners of the rectangle between four markers; `None` if the markers are not the corners of a convex ring.
fn inner_corners(ring: &[Seen; 4]) -> Option<[DVec2; 4]> {
    let centres = ring.map(|m| m.centre());
    // Sides of the ring from a marker to the next and to the one before.
    let sides = |k: usize| (centres[(k + 1) % 4] - centres[k], centres[(k + 3) % 4] - centres[k]);
    let turns: [f64; 4] = std::array::from_fn(|k| cross(sides(k).0, sides(k).1));
    // A ring that turns both ways crosses itself or has a dent, which no view of a sheet has.
    if !(turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0)) {
        return None;
    }
    Some(std::array::from_fn(|k| {
        // The corner of the marker that points towards both neighbouring markers. It is measured along the sides
        // of the sheet in the photograph, so that neither perspective nor a long sheet selects another corner.
        let (origin, (u, v), det) = (centres[k], sides(k), turns[k]);
        let inwards = |p: &DVec2| (cross(*p - origin, v) / det).min(cross(u, *p - origin) / det);
        let corners = ring[k].corners;
        corners.into_iter().fold(corners[0], |best, c| if inwards(&c) > inwards(&best) { c } else { best })
    }))
}

/// How far the sides of four markers are from lying in line with the rectangle between them: sine of the greatest angle.
fn out_of_line(ring: &[Seen; 4], inner: [DVec2; 4]) -> f64 {
    let mut worst = 0.0f64;
    for (k, marker) in ring.iter().enumerate() {
        let at = marker.corners.iter().position(|c| *c == inner[k]).unwrap_or(0);
        for next in [inner[(k + 1) % 4], inner[(k + 3) % 4]] {
            let line = (next - inner[k]).normalize_or_zero();
            // Each side of the rectangle goes on along one of the two sides of the marker.
            let off = [1, 3].map(|step| {
                let side = (marker.corners[(at + step) % 4] - inner[k]).normalize_or_zero();
                // A side that runs into the rectangle is not the one.
                if side.dot(line) < 0.0 { cross(side, line).abs() } else { 1.0 }
            });
            worst = worst.max(off[0].min(off[1]));
        }
    }
    worst
}

/// All pieces of a photograph that read as a marker.
fn seen_markers(photo: &Grey) -> Vec<Seen> {
    let (small, level) = shrunk(photo);
    // The brightness around a pixel is a Gaussian mean a fortieth of the picture wide, several markers
    // across. It follows uneven light.
    let local = small.blurred(small.width.max(small.height) as f64 / 40.0);
    let dark: Vec<bool> = small.data.iter().zip(&local.data).map(|(v, l)| *v < 0.75 * l).collect();
    let (w, h) = (small.width, small.height);
    // The rim of a marker ten pixels wide has about 60 pixels. The rings of a smaller one cannot be told
    // apart.
    let least = (w * h / 20_000).max(60);
    let mut found = Vec::new();
    // A piece on the border is cut off, or is the ground.
    let whole = |p: &Vec<usize>| p.len() > least && !p.iter().any(|&k| on_border(k, w, h));
    for piece in pieces(&dark, w, h).into_iter().filter(whole) {
        let Some(corners) = four_sides(&hull(&piece, w)) else { continue };
        let corners = sorted(corners);
        if let Some(index) = reads_as_marker(&small, corners) {
            // The rim of a marker is a sixth of its side, so the refinement must not reach the next ring.
            let shortest =
                (0..4).map(|k| corners[k].distance(corners[(k + 1) % 4])).fold(f64::INFINITY, f64::min);
            let reach = (shortest / 14.0).min(3.0);
            let corners = sorted(refined(photo, corners.map(|c| c * level), reach * level));
            found.push(Seen { corners, index });
        }
    }
    found
}

/// The markers clockwise as seen, beginning with the white inner square.
fn clockwise_from_first(mut markers: [Seen; 4]) -> [Seen; 4] {
    let middle = markers.iter().map(Seen::centre).sum::<DVec2>() * 0.25;
    let angle = |m: &Seen| {
        let d = m.centre() - middle;
        atan2(d.y, d.x)
    };
    markers.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    let first = markers.iter().position(|m| m.index == 0).unwrap_or(0);
    markers.rotate_left(first);
    markers
}

/// The corner of the sheet that a square names; `None` if its rings are not those of a marker.
fn reads_as_marker(photo: &Grey, corners: [DVec2; 4]) -> Option<usize> {
    let map = square_to(corners)?;
    let at = |u: f64, v: f64| {
        let p = map.map(DVec2::new(u, v));
        photo.sample(p.x, p.y)
    };
    // Mean brightness along two rings, a twelfth and a quarter of the side inwards. They are the
    // middles of the black rim and of the white ring.
    let ring = |inset: f64| {
        let line = |k: usize| inset + (1.0 - 2.0 * inset) * (k as f64 + 0.5) / 8.0;
        let each = (0..8).map(|k| {
            at(line(k), inset) + at(line(k), 1.0 - inset) + at(inset, line(k)) + at(1.0 - inset, line(k))
        });
        each.sum::<f32>() / 32.0
    };
    let (black, white) = (ring(1.0 / 12.0), ring(0.25));
    // The comparison is relative, so that a marker in the shade counts as much as one in the light.
    if white - black < 0.3 * white || white < 0.05 {
        return None;
    }
    // The inner square is read as two brightness profiles, one along each side, each a mean over the
    // middle half across it. A mean over the whole square would include the white ring of a blurred
    // photograph. Stripes show in the profile that varies more.
    let n = 12;
    let place = |k: usize| (1.0 + (k as f64 + 0.5) / n as f64) / 3.0;
    let profile = |turned: bool| {
        let point = |k: usize, j: usize| if turned { at(place(j), place(k)) } else { at(place(k), place(j)) };
        let values: [f32; 12] =
            std::array::from_fn(|k| (n / 4..n - n / 4).map(|j| point(k, j)).sum::<f32>() / 6.0);
        let mean = values.iter().sum::<f32>() / n as f32;
        (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>(), mean)
    };
    let (along, across) = (profile(false), profile(true));
    let mean = if along.0 > across.0 { along.1 } else { across.1 };
    let share = (white - mean) / (white - black);
    // The share among 0, 1/3, 2/3 and 1 that is nearest; each of them names a corner.
    Some(match share {
        s if s < 1.0 / 6.0 => 0,
        s if s < 0.5 => 1,
        s if s < 5.0 / 6.0 => 3,
        _ => 2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::warp::Homography;

    const SIZE: DVec2 = DVec2::new(100.0, 60.0);

    /// The rectangles of the sheet as it was before the corners carried shares.
    fn old_patches() -> Vec<Patch> {
        let m = MARKER_MM;
        let inner = |p: &Patch| Patch { low: p.low + m / 3.0, size: DVec2::splat(m / 3.0), black: true };
        let mut out: Vec<Patch> = patches(SIZE).into_iter().filter(|p| p.size.x > 0.5 * m).collect();
        let rims: Vec<Patch> = out.iter().filter(|p| p.size.x == m).skip(1).map(inner).collect();
        out.extend(rims);
        out
    }

    /// A photograph of a sheet, the rectangle's corners (upper left first) at `corners`, under this light.
    fn sheet(patches: &[Patch], corners: [DVec2; 4], light: &(dyn Fn(DVec2) -> f64 + Sync)) -> Grey {
        on_ground(patches, corners, light, &|_, _| 0.85)
    }

    /// The same on a ground of this brightness.
    fn on_ground(
        patches: &[Patch],
        corners: [DVec2; 4],
        light: &(dyn Fn(DVec2) -> f64 + Sync),
        ground: &(dyn Fn(usize, usize) -> f64 + Sync),
    ) -> Grey {
        let rectangle = [(0.0, 0.0), (SIZE.x, 0.0), (SIZE.x, SIZE.y), (0.0, SIZE.y)].map(DVec2::from);
        let back = Homography::from_points(corners, rectangle).expect("convex");
        let value = |p: DVec2, ground: f64| {
            let inside =
                |q: &&Patch| (p - q.low).min_element() > 0.0 && (q.low + q.size - p).min_element() > 0.0;
            let margin = MARKER_MM + 5.0;
            let beyond = (-margin - p).max(p - SIZE - margin).max_element() > 0.0;
            let paper = if beyond { ground } else { 0.85 };
            patches.iter().rev().find(inside).map_or(paper, |q| if q.black { 0.1 } else { 0.85 })
        };
        Grey::from_fn(1000, 800, |x, y| {
            let ground = ground(x, y);
            let at = |dx: f64, dy: f64| value(back.map(DVec2::new(x as f64 + dx, y as f64 + dy)), ground);
            let mean = 0.25 * (at(0.25, 0.25) + at(0.75, 0.25) + at(0.25, 0.75) + at(0.75, 0.75));
            (mean * light(DVec2::new(x as f64, y as f64))) as f32
        })
    }

    /// The rectangle as a camera of 1.2 image widths focal length sees it: turned in its plane, then tilted about an
    /// axis in the picture at `axis_deg`.
    fn view(turn_deg: f64, tilt_deg: f64, axis_deg: f64) -> [DVec2; 4] {
        use grainpath_core::DVec3;
        use grainpath_core::math::{direction, rotated, sin_cos};
        let (s, c) = sin_cos(tilt_deg.to_radians());
        let axis = direction(axis_deg.to_radians());
        let across = DVec2::new(-axis.y, axis.x);
        let (focal, distance) = (1200.0, 240.0);
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let p = rotated(0.5 * SIZE * DVec2::new(x, y), direction(turn_deg.to_radians()));
            let (along, off) = (p.dot(axis), p.dot(across));
            let q = DVec3::new(0.0, 0.0, distance + s * off);
            DVec2::new(500.0, 400.0) + focal * (along * axis + c * off * across) / q.z
        })
    }

    fn even(_: DVec2) -> f64 {
        1.0
    }

    fn assert_found(photo: &Grey, corners: [DVec2; 4], sheet: Sheet, limit_px: f64, what: &str) {
        let found = find_markers(photo).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(found.sheet, sheet, "{what}");
        for (f, c) in found.corners.iter().zip(corners) {
            assert!(f.distance(c) < limit_px, "{what}: {f} should be {c}");
        }
    }

    #[test]
    fn the_own_sheet_is_read_level_turned_and_tilted() {
        for tilt in [0.0, 20.0, 45.0, 60.0] {
            for turn in (0..9).map(|k| 40.0 * f64::from(k)) {
                for axis in [0.0, 37.0, 90.0] {
                    let corners = view(turn, tilt, axis);
                    let what = format!("turned {turn}, tilted {tilt} about {axis}");
                    let photo = sheet(&patches(SIZE), corners, &even);
                    assert_found(&photo, corners, Sheet::FourShares, 1.5, &what);
                }
            }
        }
    }

    #[test]
    fn blur_and_half_shade_change_nothing() {
        let corners = view(25.0, 30.0, 10.0);
        let shade = |p: DVec2| if p.x + 0.4 * p.y < 620.0 { 1.0 } else { 0.35 };
        let photo = sheet(&patches(SIZE), corners, &shade);
        assert_found(&photo, corners, Sheet::FourShares, 1.5, "half in shade");
        for sigma_px in [1.0, 2.0, 3.0] {
            let photo = sheet(&patches(SIZE), corners, &even).blurred(sigma_px);
            assert_found(&photo, corners, Sheet::FourShares, 2.0, &format!("blurred by {sigma_px} px"));
        }
    }

    #[test]
    fn a_mirrored_photograph_is_refused_as_such() {
        for turn in [0.0, 75.0, 180.0, 250.0] {
            let photo = sheet(&patches(SIZE), view(turn, 20.0, 30.0), &even);
            let mirrored = Grey::from_fn(photo.width, photo.height, |x, y| photo.at(photo.width - 1 - x, y));
            assert_eq!(find_markers(&mirrored), Err(CornersNotFound::Mirrored), "turned {turn}");
        }
    }

    #[test]
    fn an_old_sheet_is_read_as_an_old_sheet() {
        for turn in [0.0, 90.0, 130.0, 217.0, 300.0] {
            let corners = view(turn, 25.0, 60.0);
            let photo = sheet(&old_patches(), corners, &even);
            assert_found(&photo, corners, Sheet::OneWhite, 1.5, &format!("turned {turn}"));
        }
    }

    #[test]
    fn the_ground_may_be_of_any_brightness() {
        let views = [(0.0, 0.0, 0.0), (-30.0, 40.0, 90.0), (60.0, 50.0, 30.0), (200.0, 60.0, 10.0)];
        // A dark table, brighter and darker by turns over some pixels.
        let table = |x: usize, y: usize| 0.14 + 0.06 * f64::from(((x / 7 + 3 * (y / 9)) % 5) as u8 / 2);
        let mut worst = 0.0f64;
        for (turn, tilt, axis) in views {
            let corners = view(turn, tilt, axis);
            let mut try_on = |what: String, ground: &(dyn Fn(usize, usize) -> f64 + Sync)| {
                let photo = on_ground(&patches(SIZE), corners, &even, ground);
                let what = format!("ground {what}, turned {turn}, tilted {tilt} about {axis}");
                assert_found(&photo, corners, Sheet::FourShares, 1.5, &what);
                let found = find_markers(&photo).expect("found above").corners;
                worst = found.iter().zip(corners).map(|(f, c)| f.distance(c)).fold(worst, f64::max);
                let mirrored =
                    Grey::from_fn(photo.width, photo.height, |x, y| photo.at(photo.width - 1 - x, y));
                assert_eq!(find_markers(&mirrored), Err(CornersNotFound::Mirrored), "{what}");
            };
            for grey in [5, 20, 40, 45, 110, 250] {
                try_on(grey.to_string(), &|_, _| f64::from(grey) / 255.0);
            }
            try_on("of a table".to_owned(), &table);
        }
        println!("corners off by up to {worst:.2} px");
        let photo = on_ground(&old_patches(), view(130.0, 25.0, 60.0), &even, &|_, _| 0.02);
        assert_found(&photo, view(130.0, 25.0, 60.0), Sheet::OneWhite, 1.5, "older sheet");
    }

    #[test]
    fn a_sheet_that_is_cut_off_is_told_with_the_markers_left() {
        for ground in [0.02, 0.45, 0.98] {
            for (shift, left) in [(280.0, 2), (0.0, 3)] {
                let corners = view(if left == 3 { 40.0 } else { 0.0 }, 0.0, 0.0);
                let cut = DVec2::new(shift, if left == 3 { -170.0 } else { 0.0 });
                let photo = on_ground(&patches(SIZE), corners.map(|c| c + cut), &even, &|_, _| ground);
                assert_eq!(find_markers(&photo), Err(CornersNotFound::Markers { found: left }), "{ground}");
            }
        }
    }

    #[test]
    fn markers_of_another_sheet_do_not_hide_a_sheet() {
        // The second lies outside the first; two of its markers are in the picture.
        let corners = view(0.0, 0.0, 0.0).map(|c| c * 0.6);
        let other = view(0.0, 0.0, 0.0).map(|c| c * 0.35 + DVec2::new(760.0, 500.0));
        let [photo, beside] = [corners, other].map(|c| sheet(&patches(SIZE), c, &even));
        let both = Grey::from_fn(photo.width, photo.height, |x, y| photo.at(x, y).min(beside.at(x, y)));
        assert_found(&both, corners, Sheet::FourShares, 1.5, "two sheets");
    }

    #[test]
    fn no_sheet_is_refused() {
        assert_eq!(find_markers(&Grey::filled(200, 200, 0.5)), Err(CornersNotFound::Markers { found: 0 }));
        // Three of the four: one lies outside the photograph.
        let corners = view(0.0, 0.0, 0.0).map(|c| c + DVec2::new(300.0, 0.0));
        let photo = sheet(&patches(SIZE), corners, &even);
        assert!(matches!(find_markers(&photo), Err(CornersNotFound::Markers { found: 0..=3 })));
    }

    #[test]
    fn the_sheet_is_svg_in_millimetres() {
        let svg = marker_sheet_svg(DVec2::new(100.0, 30.0));
        // The page, two squares a marker, four stripes and the rectangle.
        assert!(
            svg.starts_with("<svg") && svg.contains("width=\"134mm\"") && svg.matches("<rect").count() == 14
        );
    }
}
