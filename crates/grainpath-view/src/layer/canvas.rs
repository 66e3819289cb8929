//! A picture that is drawn in millimetres.

use grainpath_core::math::direction;
use grainpath_core::{Bounds2, DVec2};
use tiny_skia::{Color, Pixmap};

use super::colour::{Rgb, ramp};
use super::digits;
use super::rasteriser::{draw_line, png};

/// A colour scale: blue through green and yellow to red.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// The value that is blue.
    pub low: f64,
    /// The value that is red.
    pub high: f64,
}

impl Ramp {
    /// The colour of a value.
    pub fn colour(&self, value: f64) -> Rgb {
        ramp(value, self.low, self.high)
    }
}

/// Width of a ring without its rims, pixels. Source: chosen by eye.
const RING_PX: f32 = 3.0;
/// Sides of the polygon that is drawn for a ring. Source: chosen; a side of a ring of 50 pixels is off its arc by 0.02.
const RING_SIDES: f64 = 96.0;

/// A picture of a window of the plane in mm, y upwards.
pub struct Canvas {
    window: Bounds2,
    scale: f64,
    pixels: Pixmap,
}

impl Canvas {
    /// An empty dark picture of `bounds` with a margin; its longer side has `size_px` pixels.
    pub fn over(bounds: Bounds2, size_px: u32) -> Self {
        // A margin of two per cent and 0.2 mm keeps lines on the border of `bounds` inside the picture.
        let window = bounds.grown(0.02 * bounds.size().max_element() + 0.2);
        let scale = f64::from(size_px) / window.size().max_element().max(1e-9);
        // The clamp is needed because rounding up may give one pixel too many, and a part without extent
        // gives none.
        let pixels = |mm: f64| ((mm * scale).ceil() as u32).clamp(1, size_px.max(1));
        let (w, h) = (pixels(window.size().x), pixels(window.size().y));
        let mut pixels = Pixmap::new(w, h).expect("the size is between 1 and what was asked for");
        pixels.fill(Color::from_rgba8(28, 30, 34, 255));
        Self { window, scale, pixels }
    }

    /// The centre of each pixel, row by row from the top, mm.
    pub fn pixels(&self) -> impl Iterator<Item = DVec2> + use<> {
        let (w, h) = (self.pixels.width(), self.pixels.height());
        let (window, scale) = (self.window, self.scale);
        let at = move |i: u32, j: u32| {
            let off = DVec2::new(f64::from(i) + 0.5, -(f64::from(j) + 0.5)) / scale;
            DVec2::new(window.min.x, window.max.y) + off
        };
        (0..h).flat_map(move |j| (0..w).map(move |i| at(i, j)))
    }

    /// Paints all pixels with these colours, in the order of `Canvas::pixels`; `None` leaves a pixel unchanged.
    pub fn paint(&mut self, colours: impl Iterator<Item = Option<Rgb>>) {
        for (pixel, colour) in self.pixels.data_mut().chunks_exact_mut(4).zip(colours) {
            if let Some(rgb) = colour {
                pixel[..3].copy_from_slice(&rgb);
            }
        }
    }

    /// Number of pixels of a length in mm.
    pub fn pixels_of(&self, mm: f64) -> f32 {
        (mm * self.scale) as f32
    }

    /// Columns and rows of the picture, pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.pixels.width() as usize, self.pixels.height() as usize)
    }

    /// Pixels for each mm.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The place of a point in mm on the picture: pixels from the left and from the top.
    pub fn pixel_of(&self, p: DVec2) -> DVec2 {
        DVec2::new(p.x - self.window.min.x, self.window.max.y - p.y) * self.scale
    }

    /// Draws a line through points in mm; its width is in pixels.
    pub fn line(&mut self, points: &[DVec2], width_px: f32, colour: Rgb, alpha: u8) {
        let at = |p: &DVec2| self.pixel_of(*p).as_vec2();
        let points: Vec<(f32, f32)> = points.iter().map(|p| at(p).into()).collect();
        if points.len() > 1 {
            draw_line(&mut self.pixels, &points, width_px, colour, alpha);
        }
    }

    /// Draws a ring about a place in mm, white between two dark rims so that it is seen on any colour, and writes a number
    /// beside it, above or below it in a picture that is too narrow.
    pub fn ring(&mut self, centre: DVec2, radius_px: f64, text: &str) {
        let around = |k: i32| {
            let turn = f64::from(k) * std::f64::consts::TAU / RING_SIDES;
            centre + direction(turn) * (radius_px / self.scale)
        };
        let points: Vec<DVec2> = (0..=RING_SIDES as i32).map(around).collect();
        // The rims are what is left of a wider dark ring below the light one.
        self.line(&points, RING_PX + 6.0, [14, 15, 17], 255);
        self.line(&points, RING_PX, digits::PLATE, 255);
        let (w, h) = (self.pixels.width() as usize, self.pixels.height() as usize);
        // Dots grow with the picture, so that numbers stay readable where a page shows it smaller.
        let dot = (w.max(h) / 300).max(1);
        let (wide, high) = digits::size(text, dot);
        let off = (centre - DVec2::new(self.window.min.x, self.window.max.y)) * self.scale;
        let (x, y) = (off.x, -off.y);
        // The plate stays clear of the outer rim.
        let gap = radius_px + f64::from(RING_PX) + 4.0;
        let (right, below) = (w as f64 - x, h as f64 - y);
        let beside =
            |low: f64, size: usize, end: usize| low.clamp(0.0, end.saturating_sub(size) as f64) as usize;
        let corner = if right.max(x) >= gap + wide as f64 {
            let left = if right >= x { x + gap } else { x - gap - wide as f64 };
            (beside(left, wide, w), beside(y - 0.5 * high as f64, high, h))
        } else {
            let top = if below >= y { y + gap } else { y - gap - high as f64 };
            (beside(x - 0.5 * wide as f64, wide, w), beside(top, high, h))
        };
        let data = self.pixels.data_mut();
        digits::write(text, corner, dot, |x, y, colour| {
            if x < w && y < h {
                let at = 4 * (y * w + x);
                data[at..at + 3].copy_from_slice(&colour);
            }
        });
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Vec<u8> {
        png(self.pixels.width(), self.pixels.height(), self.pixels.data())
    }
}
