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
//! The cost is linear in the pixels of a picture shrunk to at most 1400 px; the corners are then refined
//! in the full picture. Tests cover level, rotated, mirrored, blurred and half shaded views, and views
//! tilted by up to 60 degrees.

use std::fmt::Write;

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, cross};

use super::corners::{CornersNotFound, four_sides, hull, pieces, refined, shrunk, sorted, square_to};
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
}

/// Finds the corners between a sheet's markers in a photograph.
///
/// # Errors
/// [`CornersNotFound::Markers`] unless exactly the four of a sheet are there, [`CornersNotFound::Mirrored`] for a
/// mirrored photograph.
pub fn find_markers(photo: &Grey) -> Result<FoundMarkers, CornersNotFound> {
    let seen = seen_markers(photo);
    let wrong = CornersNotFound::Markers { found: seen.len() };
    let Ok(all) = <[Seen; 4]>::try_from(seen) else { return Err(wrong) };
    let count = |index: usize| all.iter().filter(|m| m.index == index).count();
    let (markers, sheet) = match [count(0), count(1), count(2), count(3)] {
        [1, 1, 1, 1] => {
            let mut ring = all;
            ring.sort_by_key(|m| m.index);
            let [a, b, c, d] = ring.map(|m| m.centre());
            // Rows run downwards, so a positive cross product is clockwise as seen.
            if cross(c - a, d - b) < 0.0 {
                return Err(CornersNotFound::Mirrored);
            }
            (ring, Sheet::FourShares)
        }
        // One white and three black squares are those of the older sheet. Only the order tells which corner a black
        // square belongs to.
        [1, 0, 3, 0] => (clockwise_from_first(all), Sheet::OneWhite),
        _ => return Err(wrong),
    };
    let centres = markers.map(|m| m.centre());
    let corners = std::array::from_fn(|k| {
        // The corner of the marker that points towards both neighbouring markers. It is measured along the sides
        // of the sheet in the photograph, so that neither perspective nor a long sheet selects another corner.
        let (origin, u, v) =
            (centres[k], centres[(k + 1) % 4] - centres[k], centres[(k + 3) % 4] - centres[k]);
        let det = cross(u, v);
        let inwards = |p: &DVec2| (cross(*p - origin, v) / det).min(cross(u, *p - origin) / det);
        let corners = markers[k].corners;
        corners.into_iter().fold(corners[0], |best, c| if inwards(&c) > inwards(&best) { c } else { best })
    });
    Ok(FoundMarkers { corners, sheet })
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
    for piece in pieces(&dark, w, h).into_iter().filter(|p| p.len() > least) {
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
        let rectangle = [(0.0, 0.0), (SIZE.x, 0.0), (SIZE.x, SIZE.y), (0.0, SIZE.y)].map(DVec2::from);
        let back = Homography::from_points(corners, rectangle).expect("convex");
        let value = |p: DVec2| {
            let inside =
                |q: &&Patch| (p - q.low).min_element() > 0.0 && (q.low + q.size - p).min_element() > 0.0;
            patches.iter().rev().find(inside).map_or(0.85, |q| if q.black { 0.1 } else { 0.85 })
        };
        Grey::from_fn(1000, 800, |x, y| {
            let at = |dx: f64, dy: f64| value(back.map(DVec2::new(x as f64 + dx, y as f64 + dy)));
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
