//! Pictures of a layer and of the whole part, as they would be printed.
//!
//! Beads are drawn with their true widths. They may come from a plan or from any
//! G-code.

mod canvas;
mod colour;
pub(crate) mod digits;
mod rasteriser;
mod svg;
mod thumbnail;

use grainpath_core::{Bounds2, DVec2, Role};
use grainpath_gcode::BeadLayer;

pub use canvas::{Canvas, Ramp};
pub(crate) use colour::UNASKED;
pub use colour::{ColourBy, Scale, of_role as role_colour};
pub use rasteriser::layer_png;
pub(crate) use rasteriser::png as encode_png;
pub use svg::layer_svg;
pub use thumbnail::{Ground, thumbnail_png, thumbnails};

/// A straight piece of a bead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnBead {
    /// Start, mm.
    pub a: DVec2,
    /// End, mm.
    pub b: DVec2,
    /// Full width, mm.
    pub width_mm: f64,
    /// Role of the bead.
    pub role: Role,
    /// Nominal speed, mm/s.
    pub speed_mm_s: f64,
    /// Angle to the direction of the guide, degrees from 0 to 90; `None` where the guide asks for none.
    pub off_deg: Option<f64>,
    /// Height of its bottom above the layer's bottom, and of its top above the layer's top, mm.
    pub raise_mm: [f64; 2],
}

impl DrawnBead {
    /// Whether `next` continues this piece and looks the same, so that both are drawn as one stroke.
    fn goes_on_as(&self, next: &Self) -> bool {
        // A thousandth of a millimetre is the usual resolution of coordinates in G-code. The other
        // tolerances lie below what a picture shows; equal speeds are written with equal digits.
        self.b.distance_squared(next.a) < 1e-6
            && self.role == next.role
            && (self.width_mm - next.width_mm).abs() < 5e-3
            && self.speed_mm_s == next.speed_mm_s
            && (self.off_deg == next.off_deg
                || self.off_deg.zip(next.off_deg).is_some_and(|(a, b)| (a - b).abs() < 1.0))
    }
}

/// The content of a picture of a layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LayerPicture {
    /// Height of the nozzle, mm.
    pub z_mm: f64,
    /// Thickness of the layer, mm.
    pub height_mm: f64,
    /// Pieces of beads, in printing order.
    pub beads: Vec<DrawnBead>,
    /// Straight moves without extrusion; drawn as thin lines.
    pub travels: Vec<[DVec2; 2]>,
    /// Places where fibre is cut; drawn as crosses.
    pub cuts: Vec<DVec2>,
}

impl From<&BeadLayer> for LayerPicture {
    /// Makes the picture's content from a layer of a program that was read.
    fn from(layer: &BeadLayer) -> Self {
        let beads = layer.beads.iter().map(|b| DrawnBead {
            a: b.start(),
            b: b.end(),
            width_mm: b.width_mm(layer.height_mm),
            role: b.role,
            speed_mm_s: f64::from(b.speed_mm_s),
            // A program has no directions of a guide; `render --job` takes them from the plan.
            off_deg: None,
            raise_mm: b.raise_mm.map(f64::from),
        });
        let point = |p: [f32; 2]| DVec2::new(f64::from(p[0]), f64::from(p[1]));
        Self {
            z_mm: layer.z_mm,
            height_mm: layer.height_mm,
            beads: beads.collect(),
            travels: layer.travels.iter().map(|[a, b]| [point(*a), point(*b)]).collect(),
            cuts: layer.cuts.iter().map(|p| point(*p)).collect(),
        }
    }
}

/// Half the size of the cross that marks a cut, mm. The cross is 1.6 mm across, so that it is wider than
/// a bead of fibre. Source: chosen by eye; only the picture depends on it.
const CUT_MM: f64 = 0.8;

/// The two strokes of a cross.
fn cross_at(p: DVec2) -> [[DVec2; 2]; 2] {
    let (u, v) = (DVec2::new(CUT_MM, CUT_MM), DVec2::new(CUT_MM, -CUT_MM));
    [[p - u, p + u], [p - v, p + v]]
}

impl LayerPicture {
    /// The box around all beads, with their widths.
    pub fn bounds(&self) -> Option<Bounds2> {
        let around = |b: &DrawnBead| Bounds2 { min: b.a.min(b.b), max: b.a.max(b.b) }.grown(0.5 * b.width_mm);
        self.beads.iter().map(around).reduce(Bounds2::union)
    }
}

/// Options of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureOptions {
    /// Quantity that the colour shows.
    pub colour_by: ColourBy,
    /// Longest side of a PNG, pixels.
    pub size_px: u32,
    /// Whether travels are drawn.
    pub travels: bool,
    /// The part of the plane that is shown, mm; `None` for all beads.
    pub window: Option<Bounds2>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self { colour_by: ColourBy::Role, size_px: 1600, travels: true, window: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(z_mm: f64) -> LayerPicture {
        let ring = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0), (0.0, 0.0)];
        let bead = |w: &[(f64, f64)], role| DrawnBead {
            a: w[0].into(),
            b: w[1].into(),
            width_mm: 0.45,
            role,
            speed_mm_s: 50.0,
            off_deg: (role == Role::TopSkin).then_some(30.0),
            raise_mm: [0.0; 2],
        };
        let mut beads: Vec<DrawnBead> = ring.windows(2).map(|w| bead(w, Role::OuterWall)).collect();
        beads.push(bead(&[(1.0, 5.0), (19.0, 5.0)], Role::TopSkin));
        LayerPicture {
            z_mm,
            height_mm: 0.2,
            beads,
            travels: vec![[DVec2::ZERO, DVec2::new(1.0, 5.0)]],
            cuts: Vec::new(),
        }
    }

    /// Decodes RGBA and gives the pixel at a share of width and height, from the upper left.
    fn pixel(png: &[u8], fx: f64, fy: f64) -> [u8; 4] {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
        let mut data = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut data).expect("a frame");
        let at = |f: f64, n: u32| ((f * f64::from(n)) as usize).min(n as usize - 1);
        let i = 4 * (at(fy, info.height) * info.width as usize + at(fx, info.width));
        [data[i], data[i + 1], data[i + 2], data[i + 3]]
    }

    #[test]
    fn a_layer_shows_beads_where_they_are() {
        let options = PictureOptions { travels: false, size_px: 400, ..PictureOptions::default() };
        let png = layer_png(&layer(0.2), &options);
        assert_eq!(pixel(&png, 0.5, 0.5)[..3], colour::of_role(Role::TopSkin));
        assert_eq!(pixel(&png, 0.5, 0.25)[..3], [28, 30, 34]);
        let svg = layer_svg(&layer(0.2), &options);
        assert!(svg.contains(r#"stroke-width="0.450""#) && svg.matches("<polyline").count() == 2, "{svg}");
    }

    #[test]
    fn widths_and_speeds_have_a_scale() {
        let mut picture = layer(0.2);
        picture.beads[0].width_mm = 0.6;
        let scale = Scale::new(&picture, ColourBy::Width);
        assert_eq!((scale.low, scale.high), (0.45, 0.6));
        assert_ne!(scale.colour(&picture.beads[0]), scale.colour(&picture.beads[1]));
    }

    #[test]
    fn only_what_was_asked_for_a_direction_shows_its_error() {
        let scale = Scale::new(&layer(0.2), ColourBy::Direction);
        let [wall, .., fill] = &layer(0.2).beads[..] else { panic!("no beads") };
        assert_eq!((scale.low, scale.high), (0.0, 45.0));
        assert_eq!(scale.colour(wall), UNASKED);
        assert_eq!(scale.colour(fill), colour::ramp(30.0, 0.0, 45.0));
    }

    #[test]
    fn a_thumbnail_shows_the_part_in_the_middle() {
        let layers: Vec<LayerPicture> = (1..40).map(|i| layer(0.2 * f64::from(i))).collect();
        let png = thumbnail_png(&layers, 200, 150, Ground::Clear);
        assert_eq!(pixel(&png, 0.5, 0.5)[3], 255);
        assert_eq!(pixel(&png, 0.01, 0.01)[3], 0);
    }

    #[test]
    fn nothing_gives_an_empty_picture() {
        let empty = LayerPicture::default();
        assert!(!layer_png(&empty, &PictureOptions::default()).is_empty());
        assert!(layer_svg(&empty, &PictureOptions::default()).contains("</svg>"));
        assert!(!thumbnail_png(&[], 32, 32, Ground::Paper).is_empty());
    }
}
