//! A picture of the histogram of a scan, with the grey values from which thresholds are derived.

use grainpath_core::{Bounds2, DVec2};

use crate::layer::Canvas;

/// A grey value marked in a histogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// The grey value.
    pub value: f64,
    /// Its colour.
    pub colour: [u8; 3],
}

/// Height of the picture divided by its width. Source: derived: at two thirds close peaks would look like one, at one third
/// their heights would be hard to compare.
const HEIGHT: f64 = 0.5;

/// A histogram as bars over grey values from `low` to `high`, with marks as upright lines. The height of
/// a bar grows with the logarithm of its count: air is often a thousand times as frequent as material.
pub fn histogram_png(counts: &[u64], (low, high): (f64, f64), marks: &[Mark], size_px: u32) -> Vec<u8> {
    let logarithm = |n: u64| grainpath_core::math::ln(1.0 + n as f64);
    let most = counts.iter().map(|n| logarithm(*n)).fold(f64::MIN_POSITIVE, f64::max);
    // One unit is the width of the picture.
    let mut canvas = Canvas::over(Bounds2 { min: DVec2::ZERO, max: DVec2::new(1.0, HEIGHT) }, size_px);
    let width = 1.0 / counts.len().max(1) as f64;
    let colours: Vec<_> = canvas
        .pixels()
        .map(|p| {
            let inside = p.x >= 0.0 && p.x < 1.0 && p.y >= 0.0;
            let count = inside.then(|| counts.get((p.x / width) as usize)).flatten()?;
            (p.y <= HEIGHT * logarithm(*count) / most).then_some([150, 160, 175])
        })
        .collect();
    canvas.paint(colours.into_iter());
    for mark in marks.iter().filter(|m| m.value.is_finite()) {
        let x = (mark.value - low) / (high - low).max(f64::MIN_POSITIVE);
        canvas.line(&[DVec2::new(x, 0.0), DVec2::new(x, HEIGHT)], 2.0, mark.colour, 255);
    }
    canvas.png()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(png: &[u8], fx: f64, fy: f64) -> [u8; 3] {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut bytes).expect("a picture");
        let (x, y) = ((f64::from(info.width) * fx) as usize, (f64::from(info.height) * fy) as usize);
        let at = 4 * (y * info.width as usize + x);
        [bytes[at], bytes[at + 1], bytes[at + 2]]
    }

    #[test]
    fn bars_and_marks_stand_at_their_grey_values() {
        let mark = Mark { value: 75.0, colour: [255, 90, 80] };
        let png = histogram_png(&[1000, 0, 0, 1000], (0.0, 100.0), &[mark], 400);
        // The picture has a margin around the histogram: 0.2 and two per cent of 1 unit.
        let at = |x: f64| (x + 0.22) / 1.44;
        let bar = [150, 160, 175];
        assert_eq!((pixel(&png, at(0.1), 0.5), pixel(&png, at(0.9), 0.5)), (bar, bar));
        assert_eq!(pixel(&png, at(0.4), 0.5), [28, 30, 34]);
        assert_eq!(pixel(&png, at(0.75), 0.5), [255, 90, 80]);
        // Nothing at all is drawn without a panic.
        assert_eq!(&histogram_png(&[], (0.0, 0.0), &[Mark { value: f64::NAN, ..mark }], 50)[1..4], b"PNG");
    }
}
