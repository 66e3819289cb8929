//! Outlines of flat parts: drawings read as regions.
//!
//! [`parse_outline`] recognises SVG and ASCII DXF. Each reader turns its file into a [`drawing`]: closed and open lines in
//! mm, with the fill rule of each shape. Filled shapes are material by their own fill rule and are united. The even-odd rule
//! applies to all closed lines without fill together, so that a circle in a rectangle is a hole whether or not the rectangle
//! is filled. Curves are divided into chords within a given tolerance.

use grainpath_core::{Warning, WarningId};

mod drawing;
mod dxf;
mod path;
mod svg;
#[cfg(test)]
mod tests;

pub use drawing::{Outline, OutlineError, OutlineOptions, OutlineProblem};

/// Reads an outline from an SVG or an ASCII DXF drawing. Filled shapes are material by their own fill rule and are united.
/// Closed lines without fill follow the even-odd rule: they cut holes into material and add material elsewhere. A DXF has
/// only lines; those whose ends meet are joined.
///
/// # Errors
/// [`OutlineError`]: another format, damage (with its place), no closed line, too many points.
///
/// ```
/// use grainpath_io::{OutlineOptions, parse_outline};
/// let svg = br#"<svg width="20mm" height="10mm" viewBox="0 0 20 10"><rect width="20" height="10"/></svg>"#;
/// let options = OutlineOptions { unit: None, tolerance_mm: 0.005, even_odd: false };
/// let outline = parse_outline(svg, &options)?;
/// assert_eq!(outline.region.area_mm2(), 200.0);
/// # Ok::<(), grainpath_io::OutlineError>(())
/// ```
pub fn parse_outline(bytes: &[u8], options: &OutlineOptions) -> Result<Outline, OutlineError> {
    if bytes.is_empty() {
        return Err(OutlineError::Empty);
    }
    let mut drawing = if is_svg(bytes) {
        let text = std::str::from_utf8(bytes).map_err(|e| OutlineError::NotUtf8 { byte: e.valid_up_to() })?;
        svg::read(text, options)?
    } else if dxf::sniff(bytes) {
        dxf::read(bytes, options)?
    } else if dxf::is_binary(bytes) {
        return Err(OutlineError::BinaryDxf);
    } else {
        return Err(OutlineError::Unknown);
    };
    if drawing.dropped > 0 {
        let n = drawing.dropped;
        let text = format!("{n} open lines without fill bound nothing and were left out");
        drawing.warnings.push(Warning::new(WarningId::OutlineOpen, text));
    }
    let region = drawing.region(options.even_odd);
    if region.is_empty() {
        let hints: Vec<&str> = drawing.warnings.iter().map(|w| w.text.as_str()).collect();
        let hints = hints.join("; ");
        let hints = if hints.is_empty() { hints } else { format!(" ({hints})") };
        return Err(OutlineError::NoArea { hints });
    }
    Ok(Outline { region, warnings: drawing.warnings })
}

/// Whether these bytes are a drawing: SVG or DXF.
///
/// ```
/// assert!(grainpath_io::sniff_outline(b"<svg viewBox='0 0 9 9'/>"));
/// assert!(!grainpath_io::sniff_outline(b"solid part"));
/// ```
pub fn sniff_outline(bytes: &[u8]) -> bool {
    is_svg(bytes) || dxf::sniff(bytes) || dxf::is_binary(bytes)
}

fn is_svg(bytes: &[u8]) -> bool {
    let text = crate::text::skip_space(bytes);
    let head = &text[..text.len().min(4096)];
    text.starts_with(b"<") && head.windows(4).any(|w| w == b"<svg" || w == b":svg")
}
