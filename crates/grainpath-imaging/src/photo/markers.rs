//! A sheet with four corner markers: printed, the board laid on it, photographed.
//!
//! Each marker is a black square with a white square in it and a black one in that; the upper left one's inner square
//! is white, so that the sheet may be photographed from any side.

use std::fmt::Write;

use grainpath_core::DVec2;

use super::corners::{CornersNotFound, four_sides, hull, pieces, refined, shrunk, sorted, square_to};
use crate::raster::Grey;

/// Side of a marker, mm. Its rings are a sixth of that.
pub const MARKER_MM: f64 = 12.0;

/// The sheet for a board of this size, as SVG with the millimetre as its unit. The inner corners of the four markers
/// are the corners of a rectangle of `size_mm`: `corners = "markers"` reads the picture between them.
pub fn marker_sheet_svg(size_mm: DVec2) -> String {
    let margin = MARKER_MM + 5.0;
    let (w, h) = (size_mm.x + 2.0 * margin, size_mm.y + 2.0 * margin);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\">\n\
         <title>grainpath corner markers for {} x {} mm; print at 100 %</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n",
        size_mm.x, size_mm.y
    );
    for (place, rings) in marker_squares(size_mm) {
        let at = place + margin;
        for (k, black) in rings.into_iter().enumerate() {
            let inset = MARKER_MM / 6.0 * k as f64;
            let side = MARKER_MM - 2.0 * inset;
            let fill = if black { "#000" } else { "#fff" };
            let _ = writeln!(
                out,
                "<rect x=\"{}\" y=\"{}\" width=\"{side}\" height=\"{side}\" fill=\"{fill}\"/>",
                at.x + inset,
                at.y + inset
            );
        }
    }
    let _ = writeln!(
        out,
        "<rect x=\"{margin}\" y=\"{margin}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#bbb\" stroke-width=\"0.2\" stroke-dasharray=\"2 2\"/>\n</svg>",
        size_mm.x, size_mm.y
    );
    out
}

/// The same sheet as PDF, one page of its size.
pub fn marker_sheet_pdf(size_mm: DVec2) -> Vec<u8> {
    const POINTS_PER_MM: f64 = 72.0 / 25.4;
    let margin = MARKER_MM + 5.0;
    let (w, h) = (size_mm.x + 2.0 * margin, size_mm.y + 2.0 * margin);
    let mut drawing = format!("{POINTS_PER_MM:.6} 0 0 {POINTS_PER_MM:.6} 0 0 cm\n");
    for (place, rings) in marker_squares(size_mm) {
        for (k, black) in rings.into_iter().enumerate() {
            let inset = MARKER_MM / 6.0 * k as f64;
            let side = MARKER_MM - 2.0 * inset;
            let (x, y) = (place.x + margin + inset, h - (place.y + margin + inset) - side);
            let _ = writeln!(drawing, "{} g {x:.3} {y:.3} {side:.3} {side:.3} re f", i32::from(!black));
        }
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

/// Upper left corners of the markers, mm from the rectangle's upper left corner (rows downwards), and the colours of
/// their squares from outside in.
fn marker_squares(size_mm: DVec2) -> [(DVec2, [bool; 3]); 4] {
    let m = MARKER_MM;
    [
        (DVec2::new(-m, -m), [true, false, false]),
        (DVec2::new(size_mm.x, -m), [true, false, true]),
        (DVec2::new(size_mm.x, size_mm.y), [true, false, true]),
        (DVec2::new(-m, size_mm.y), [true, false, true]),
    ]
}

/// The corners between a sheet's markers: upper left, upper right, lower right, lower left of the sheet.
///
/// # Errors
/// [`CornersNotFound::Markers`] unless exactly the four of a sheet are there.
pub fn find_markers(photo: &Grey) -> Result<[DVec2; 4], CornersNotFound> {
    let (small, level) = shrunk(photo);
    let local = small.blurred(small.width.max(small.height) as f64 / 40.0);
    let dark: Vec<bool> = small.data.iter().zip(&local.data).map(|(v, l)| *v < 0.75 * l).collect();
    let (w, h) = (small.width, small.height);
    let least = (w * h) / 20_000;
    let mut found: Vec<([DVec2; 4], bool)> = Vec::new();
    for piece in pieces(&dark, w, h).into_iter().filter(|p| p.len() > least.max(60)) {
        let Some(corners) = four_sides(&hull(&piece, w)) else { continue };
        let corners = sorted(corners);
        if let Some(first) = reads_as_marker(&small, corners) {
            // The rim of a marker is a sixth of its side: a finer look must not reach the next ring.
            let reach = (corners[0].distance(corners[1]) / 14.0).min(3.0);
            found.push((sorted(refined(photo, corners.map(|c| c * level), reach * level)), first));
        }
    }
    let wrong = CornersNotFound::Markers { found: found.len() };
    if found.len() != 4 || found.iter().filter(|(_, first)| *first).count() != 1 {
        return Err(wrong);
    }
    let centre = |c: &[DVec2; 4]| c.iter().copied().sum::<DVec2>() * 0.25;
    let middle = found.iter().map(|(c, _)| centre(c)).sum::<DVec2>() * 0.25;
    // Clockwise as seen, from the one with the white middle.
    let ring = sorted(std::array::from_fn(|k| centre(&found[k].0)));
    let first = ring.iter().position(|p| found.iter().any(|(c, f)| *f && centre(c) == *p)).ok_or(wrong)?;
    Ok(std::array::from_fn(|k| {
        let place = ring[(first + k) % 4];
        let marker = found.iter().find(|(c, _)| centre(c) == place).map_or([place; 4], |(c, _)| *c);
        // The corner that looks to the middle of the sheet.
        marker.into_iter().fold(place, |best, c| {
            if c.distance_squared(middle) < best.distance_squared(middle) { c } else { best }
        })
    }))
}

/// Whether the rings are there; and if so, whether the innermost square is white.
fn reads_as_marker(photo: &Grey, corners: [DVec2; 4]) -> Option<bool> {
    let map = square_to(corners)?;
    let at = |u: f64, v: f64| {
        let p = map.map(DVec2::new(u, v));
        photo.sample(p.x, p.y)
    };
    // Means around the rings, a twelfth, a quarter and a half of the way in.
    let ring = |inset: f64| {
        let line = |k: usize| inset + (1.0 - 2.0 * inset) * (k as f64 + 0.5) / 8.0;
        (0..8)
            .map(|k| {
                at(line(k), inset) + at(line(k), 1.0 - inset) + at(inset, line(k)) + at(1.0 - inset, line(k))
            })
            .sum::<f32>()
            / 32.0
    };
    let (outer, white, inner) = (ring(1.0 / 12.0), ring(0.25), ring(0.42));
    let contrast = white - outer;
    if contrast < 0.15 {
        return None;
    }
    let share = (inner - outer) / contrast;
    (!(0.35..=0.65).contains(&share)).then_some(share > 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::warp::Homography;

    /// A photograph of a sheet, the sheet's corners (upper left first) at `corners`.
    fn sheet(corners: [DVec2; 4]) -> Grey {
        let size = DVec2::new(100.0, 60.0);
        let rectangle = [(0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0)].map(DVec2::from);
        let back = Homography::from_points(corners, rectangle).expect("convex");
        let value = |p: DVec2| {
            let mut v = 0.85;
            for (place, rings) in marker_squares(size) {
                for (k, black) in rings.into_iter().enumerate() {
                    let inset = MARKER_MM / 6.0 * k as f64;
                    let d = p - place;
                    if d.min_element() > inset && d.max_element() < MARKER_MM - inset {
                        v = if black { 0.1 } else { 0.85 };
                    }
                }
            }
            v
        };
        Grey::from_fn(1000, 700, |x, y| {
            let at = |dx: f64, dy: f64| value(back.map(DVec2::new(x as f64 + dx, y as f64 + dy)));
            (0.25 * (at(0.25, 0.25) + at(0.75, 0.25) + at(0.25, 0.75) + at(0.75, 0.75))) as f32
        })
    }

    #[test]
    fn markers_are_found_from_any_side() {
        let quad = [(200.0, 180.0), (800.0, 150.0), (830.0, 520.0), (170.0, 500.0)].map(DVec2::from);
        for turn in 0..4 {
            let corners: [DVec2; 4] = std::array::from_fn(|k| quad[(k + turn) % 4]);
            let found = find_markers(&sheet(corners)).expect("four markers");
            for (f, c) in found.iter().zip(corners) {
                assert!(f.distance(c) < 1.5, "turn {turn}: {f} should be {c}");
            }
        }
        assert_eq!(find_markers(&Grey::filled(200, 200, 0.5)), Err(CornersNotFound::Markers { found: 0 }));
    }

    #[test]
    fn the_sheet_is_svg_in_millimetres() {
        let svg = marker_sheet_svg(DVec2::new(100.0, 30.0));
        assert!(
            svg.starts_with("<svg") && svg.contains("width=\"134mm\"") && svg.matches("<rect").count() == 14
        );
    }
}
