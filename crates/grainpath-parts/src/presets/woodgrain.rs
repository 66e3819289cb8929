//! The woodgrain example: a photograph of a board with a live knot, and jobs that compare fills.

use grainpath_core::DVec2;

use super::ExampleFile;
use crate::board::{Board, Knot, wood_rgb};

/// Files of the example.
pub(super) fn files() -> Vec<ExampleFile> {
    let mut files: Vec<ExampleFile> = vec![("job.toml".into(), WOODGRAIN.as_bytes().to_vec())];
    for pattern in ["grid", "triangles", "rectilinear"] {
        files.push((format!("{pattern}.toml").into(), variant(pattern).into_bytes()));
    }
    files.push(("dense.toml".into(), dense().into_bytes()));
    files.push(("board.png".into(), board_png()));
    files
}

const WOODGRAIN: &str = include_str!("../../jobs/woodgrain.toml");

/// The woodgrain job with the fill `pattern` in place of the fill along the grain.
fn variant(pattern: &str) -> String {
    // The text is derived from the woodgrain job, so that the compared jobs always have the same other
    // settings.
    let (head, rest) = WOODGRAIN.split_once("[shape.photo]").unwrap_or_default();
    debug_assert!(!head.is_empty());
    let mut out = format!(
        "# The woodgrain example's part with a {pattern} fill of the same mass, to compare.\n\nformat = 1\n\n[shape.photo]{rest}"
    );
    if let (Some(guide), Some(process)) = (out.find("[guide]"), out.find("[process]")) {
        out.replace_range(guide..process, "");
    }
    let fill = format!("[fill]\npattern = \"{pattern}\"");
    out.replace("[fill]", &fill)
        .replace("woodgrain.gcode", &format!("{pattern}.gcode"))
        .replace("out/report.html", &format!("out/{pattern}.html"))
        .replace(
            "out/preview\"       # every step from photograph to curves, and layers",
            &format!("out/{pattern}\""),
        )
}

/// The woodgrain job with beads that touch, as in the published specimens. The board is so thin that it weighs as much as
/// the sparse boards.
fn dense() -> String {
    let head = "# The woodgrain example with beads side by side along the grain, so that no curve stands alone, as \
                published.\n# The board is thinner: 18 layers of 0.198 mm weigh as much as the sparse boards.\n\n";
    let (_, rest) = WOODGRAIN.split_once("[shape.photo]").unwrap_or_default();
    debug_assert!(!rest.is_empty());
    let process = "[process]\nlayer_height_mm = 0.198\nfirst_layer_height_mm = 0.198";
    format!("{head}format = 1\n\n[shape.photo]{rest}")
        .replace("thickness_mm = 8", "thickness_mm = 3.564")
        .replace("[process]", process)
        .replace("mass_g = 15.7                 # as the comparison's other fills", "density = 1.0")
        .replace(", 8]] }", ", 3.564]] }")
        .replace("woodgrain.gcode", "dense.gcode")
        .replace("out/report.html", "out/dense.html")
        .replace("out/preview\"", "out/dense\"")
}

/// The board of the woodgrain example.
fn woodgrain_board() -> Board {
    Board {
        size_mm: DVec2::new(120.0, 30.0),
        knots: vec![Knot { centre_mm: DVec2::new(58.0, 15.5), radius_mm: 4.0 }],
        noise: 0.012,
        ..Board::default()
    }
}

/// Photograph of the board: in perspective, on a dark cloth.
fn board_png() -> Vec<u8> {
    // The corners are those of an oblique view: no two edges are parallel, so that the example exercises
    // the rectification.
    let corners = [(52.0, 58.0), (842.0, 44.0), (868.0, 258.0), (34.0, 244.0)].map(DVec2::from);
    let photo = woodgrain_board().photograph(900, 300, corners);
    let rgb = wood_rgb(&photo);
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, photo.width as u32, photo.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut w| w.write_image_data(&rgb));
    written.expect("writing to memory cannot fail");
    out
}
