//! Layers for other programs: the Common Layer Interface (CLI) and SVG.
//!
//! Source: *Common Layer Interface (CLI)*, version 2.0, Brite EuRam project BE2578, 1994, ASCII form. Both formats are
//! written in mm with four decimals, which is the grid that sections lie on.

use std::io::{self, Write};

use grainpath_core::poly::signed_area_mm2;
use grainpath_core::{Bounds2, Contour, DVec2, LayerStack};

/// Decimals of coordinates: tenths of a micrometre, the grid that sections lie on.
fn number(mm: f64) -> String {
    // Adding 0.0 turns -0.0 into 0.0, so that no "-0" is written.
    let text = format!("{:.4}", mm + 0.0);
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.to_owned() }
}

fn bounds(stack: &LayerStack) -> Bounds2 {
    let all = stack.layers().iter().filter_map(|l| l.region().bounds());
    // An empty stack gets an empty box: both formats need numbers there.
    all.reduce(Bounds2::union).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO })
}

/// Writes layers as a Common Layer Interface file in mm: each layer at its top, outlines counter-clockwise (direction
/// 1), holes clockwise (0), the first point of a contour repeated at its end as the format wants it.
///
/// # Errors
/// The errors of `out`.
///
/// ```
/// use grainpath_core::{DVec2, Layer, LayerStack, Region};
/// let square = Region::rectangle(DVec2::ZERO, DVec2::splat(10.0));
/// let layer = Layer::new(0.2, 0.2, square).expect("a positive height");
/// let stack = LayerStack::new(vec![layer]).expect("one layer");
/// let mut text = Vec::new();
/// grainpath_io::write_cli(&stack, &mut text)?;
/// assert!(String::from_utf8(text)?.contains("$$LAYERS/1"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_cli(stack: &LayerStack, out: &mut dyn Write) -> io::Result<()> {
    let b = bounds(stack);
    let top = stack.layers().last().map_or(0.0, grainpath_core::Layer::z_top_mm);
    let corners = [b.min.x, b.min.y, 0.0, b.max.x, b.max.y, top].map(number).join(",");
    write!(
        out,
        "$$HEADERSTART\n$$ASCII\n$$UNITS/1\n$$VERSION/200\n$$LABEL/1,part\n$$DIMENSION/{corners}\n$$LAYERS/{}\n\
         $$HEADEREND\n$$GEOMETRYSTART\n",
        stack.layers().len()
    )?;
    for layer in stack.layers() {
        writeln!(out, "$$LAYER/{}", number(layer.z_top_mm()))?;
        for contour in layer.region().contours() {
            // CLI 2.0, section POLYLINE: direction 0 is clockwise (hole), 1 counter-clockwise (outline).
            let direction = u8::from(signed_area_mm2(contour) > 0.0);
            // The count includes the repeated first point.
            write!(out, "$$POLYLINE/1,{direction},{}", contour.len() + 1)?;
            for p in contour.iter().chain(contour.first()) {
                write!(out, ",{},{}", number(p.x), number(p.y))?;
            }
            writeln!(out)?;
        }
    }
    writeln!(out, "$$GEOMETRYEND")
}

/// Writes layers as one SVG in mm, with one group for each layer and y upwards.
///
/// # Errors
/// The errors of `out`.
///
/// ```
/// let mut text = Vec::new();
/// grainpath_io::write_svg_layers(&grainpath_core::LayerStack::default(), &mut text)?;
/// assert!(text.starts_with(b"<svg"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_svg_layers(stack: &LayerStack, out: &mut dyn Write) -> io::Result<()> {
    let b = bounds(stack);
    // SVG's y points down. Every y is negated, so the view box begins at minus the greatest y.
    let (size, [x, y]) = (b.size(), [b.min.x, -b.max.y].map(number));
    let [w, h] = [size.x, size.y].map(number);
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"{x} {y} {w} {h}\">"
    )?;
    for (i, layer) in stack.layers().iter().enumerate() {
        let z = number(layer.z_top_mm());
        write!(out, "<g id=\"layer{}\" data-z-mm=\"{z}\" fill=\"#888\" fill-rule=\"evenodd\">", i + 1)?;
        // One path for each polygon: the even-odd rule cuts its holes out.
        for polygon in &layer.region().polygons {
            let path = |c: &Contour| {
                let points: Vec<String> =
                    c.iter().map(|p| format!("{},{}", number(p.x), number(-p.y))).collect();
                format!("M{}Z", points.join(" "))
            };
            write!(out, "<path d=\"{}\"/>", polygon.contours().map(path).collect::<String>())?;
        }
        writeln!(out, "</g>")?;
    }
    writeln!(out, "</svg>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::{Layer, Region};

    #[test]
    fn layers_come_out_with_their_areas() {
        let outer = Region::rectangle(DVec2::ZERO, DVec2::new(10.0, 8.0));
        let region = outer.difference(&Region::rectangle(DVec2::splat(2.0), DVec2::splat(4.5)));
        let layers = (1..=3).filter_map(|i| Layer::new(0.2 * f64::from(i), 0.2, region.clone())).collect();
        let stack = LayerStack::new(layers).expect("rising");
        let mut text = Vec::new();
        write_cli(&stack, &mut text).expect("memory");
        let text = String::from_utf8(text).expect("ASCII");
        assert!(text.contains("$$LAYERS/3\n") && text.contains("$$DIMENSION/0,0,0,10,8,0.6\n"), "{text}");
        let mut areas = Vec::new();
        for line in text.lines().filter_map(|l| l.strip_prefix("$$POLYLINE/")) {
            let v: Vec<f64> = line.split(',').map(|w| w.parse().expect("a number")).collect();
            assert_eq!(v[2] as usize * 2 + 3, v.len());
            assert_eq!(v[3..5], v[v.len() - 2..], "closed");
            let contour: Contour = v[3..v.len() - 2].chunks(2).map(|p| DVec2::new(p[0], p[1])).collect();
            let area = signed_area_mm2(&contour);
            assert_eq!(v[1] as u8, u8::from(area > 0.0));
            areas.push(area);
        }
        assert_eq!(areas, [80.0, -6.25, 80.0, -6.25, 80.0, -6.25]);
        let mut svg = Vec::new();
        write_svg_layers(&stack, &mut svg).expect("memory");
        let svg = String::from_utf8(svg).expect("text");
        assert_eq!((svg.matches("<g ").count(), svg.matches('Z').count()), (3, 6));
        assert!(svg.contains("viewBox=\"0 -8 10 8\""));
    }
}
