//! A layer as SVG, in millimetres.

use std::fmt::Write;

use grainpath_core::Bounds2;
use grainpath_core::DVec2;

use super::{LayerPicture, PictureOptions, Scale};

/// Draws a layer as SVG whose user unit is the millimetre. Beads are strokes of their true width, and
/// their class names the role. y points up in the part and down in the SVG.
pub fn layer_svg(picture: &LayerPicture, options: &PictureOptions) -> String {
    let window = options.window.or(picture.bounds()).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
    let b = window.grown(0.02 * window.size().max_element() + 0.2);
    let size = b.size();
    let mut out = String::new();
    let mut line =
        |text: std::fmt::Arguments<'_>| writeln!(out, "{text}").expect("writing to a String cannot fail");
    line(format_args!(
        // Round caps and joins give beads round ends, as the nozzle lays them.
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{:.3}mm" height="{:.3}mm" viewBox="{:.3} {:.3} {:.3} {:.3}" stroke-linecap="round" stroke-linejoin="round" fill="none">"#,
        size.x, size.y, b.min.x, -b.max.y, size.x, size.y
    ));
    line(format_args!("<title>layer at {:.3} mm</title>", picture.z_mm));
    line(format_args!(
        r##"<rect x="{:.3}" y="{:.3}" width="{:.3}" height="{:.3}" fill="#1c1e22"/>"##,
        b.min.x, -b.max.y, size.x, size.y
    ));
    let colours = Scale::new(picture, options.colour_by);
    for run in picture.beads.chunk_by(super::DrawnBead::goes_on_as) {
        let [r, g, bl] = colours.colour(&run[0]);
        // y changes its sign, because it points downwards in SVG.
        let mut points = format!("{:.3},{:.3}", run[0].a.x, -run[0].a.y);
        for bead in run {
            write!(points, " {:.3},{:.3}", bead.b.x, -bead.b.y).expect("writing to a String cannot fail");
        }
        line(format_args!(
            r##"<polyline class="{}" stroke="#{r:02x}{g:02x}{bl:02x}" stroke-width="{:.3}" points="{points}"/>"##,
            // The name of a CSS class may not contain a blank.
            run[0].role.gcode_name().replace(' ', "-").to_lowercase(),
            run[0].width_mm
        ));
    }
    if options.travels {
        for [p, q] in &picture.travels {
            line(format_args!(
                r##"<path class="travel" stroke="#6ebeff" stroke-width="0.06" d="M{:.3} {:.3}L{:.3} {:.3}"/>"##,
                p.x, -p.y, q.x, -q.y
            ));
        }
    }
    for [p, q] in picture.cuts.iter().flat_map(|&p| super::cross_at(p)) {
        line(format_args!(
            r##"<path class="cut" stroke="#ff4646" stroke-width="0.25" d="M{:.3} {:.3}L{:.3} {:.3}"/>"##,
            p.x, -p.y, q.x, -q.y
        ));
    }
    out.push_str("</svg>\n");
    out
}
