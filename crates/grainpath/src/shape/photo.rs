//! The board in a photograph, as a rectangle of constant thickness with holes that are inclined like
//! its knots.
//!
//! Lengths are in mm. Cost: one polygon difference for each hole and layer.

use grainpath_core::math::direction;
use grainpath_core::{DVec2, Diagnostics, Layer, LayerStack, Polygon, Region, TriMesh, Warning, WarningId};

use super::heights::layer_heights;
use super::{ShapeError, SliceSettings};

/// A round hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Centre at the height `shown_mm`, mm.
    pub centre_mm: DVec2,
    /// Its radius, the same at every height, mm.
    pub radius_mm: f64,
}

/// A board.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoBoard {
    /// Width and height of the rectangle; its lower left corner is at zero, mm.
    pub size_mm: DVec2,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Holes through it.
    pub holes: Vec<Hole>,
    /// Displacement of the holes for each millimetre upwards.
    pub shift_mm_per_mm: DVec2,
    /// Height at which the holes lie at their given centres, mm.
    pub shown_mm: f64,
}

impl PhotoBoard {
    /// The section at a height.
    pub fn section(&self, z_mm: f64) -> Region {
        let board = Region::rectangle(DVec2::ZERO, self.size_mm);
        let shift = (z_mm - self.shown_mm) * self.shift_mm_per_mm;
        self.holes.iter().fold(board, |rest, hole| {
            // Source: derived: a chord over the angle 2 pi / n leaves the circle by r (pi / n)^2 /
            // 2, which is 0.0015 mm for n = 4 sqrt(r / 0.005).
            let n = (4.0 * (hole.radius_mm / 0.005).sqrt()).clamp(24.0, 720.0) as usize;
            let point = |k: usize| {
                let turn = k as f64 / n as f64 * std::f64::consts::TAU;
                hole.centre_mm + shift + hole.radius_mm * direction(turn)
            };
            rest.difference(&Polygon { outer: (0..n).map(point).collect(), holes: Vec::new() }.into())
        })
    }

    /// Warns of each hole that lies beside the board at every height between the two faces.
    fn report_holes_outside(&self, diagnostics: &Diagnostics) {
        for (k, hole) in self.holes.iter().enumerate() {
            // The hole's centre moves along a straight line with the height. It is checked at 65 heights, so that no
            // hole wider than a bead is missed.
            let inside = |z_mm: f64| {
                let middle = hole.centre_mm + (z_mm - self.shown_mm) * self.shift_mm_per_mm;
                let nearest = middle.clamp(DVec2::ZERO, self.size_mm);
                nearest.distance(middle) < hole.radius_mm
            };
            if !(0..=64).any(|i| inside(self.thickness_mm * f64::from(i) / 64.0)) {
                let text = format!(
                    "hole {} of shape.photo.holes_mm lies outside the board of {} x {} mm and was not cut",
                    k + 1,
                    self.size_mm.x,
                    self.size_mm.y
                );
                let warning = Warning::new(WarningId::PhotoHoleOutside, text);
                diagnostics.push(warning.at_mm(hole.centre_mm.x, hole.centre_mm.y));
            }
        }
    }

    /// The layers of the board.
    ///
    /// # Errors
    /// [`ShapeError`]: too flat, too many layers, no layer with an area.
    pub fn slice(
        &self,
        settings: &SliceSettings,
        diagnostics: &Diagnostics,
    ) -> Result<LayerStack, ShapeError> {
        self.report_holes_outside(diagnostics);
        let tops = layer_heights(&TriMesh::default(), self.thickness_mm, settings)?;
        let mut layers = Vec::with_capacity(tops.len());
        let mut bottom = 0.0;
        for top in tops {
            let region = self.section(0.5 * (bottom + top));
            layers.push(Layer::new(top, top - bottom, region).expect("layer heights are positive"));
            bottom = top;
        }
        if layers.iter().all(|l| l.region().is_empty()) {
            return Err(ShapeError::NothingLeft);
        }
        Ok(LayerStack::new(layers).expect("layer heights rise"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inclined_hole_moves_from_layer_to_layer() {
        let board = PhotoBoard {
            size_mm: DVec2::new(100.0, 30.0),
            thickness_mm: 4.0,
            holes: vec![Hole { centre_mm: DVec2::new(50.0, 15.0), radius_mm: 4.0 }],
            shift_mm_per_mm: DVec2::new(0.5, 0.0),
            shown_mm: 0.0,
        };
        let settings = SliceSettings {
            layer_height_mm: 0.2,
            first_layer_height_mm: 0.2,
            adaptive: None,
            gap_closing_mm: 0.0,
            simplify_mm: 0.0,
        };
        let diagnostics = Diagnostics::default();
        let stack = board.slice(&settings, &diagnostics).expect("layers");
        assert!(diagnostics.warnings().is_empty());
        assert_eq!(stack.layers().len(), 20);
        let area = 3000.0 - std::f64::consts::PI * 16.0;
        for layer in stack.layers() {
            let hole = &layer.region().polygons[0].holes[0];
            let middle = hole.iter().copied().sum::<DVec2>() / hole.len() as f64;
            let z = layer.z_top_mm() - 0.1;
            assert!((middle.x - 50.0 - 0.5 * z).abs() < 1e-3, "{middle} at {z}");
            assert!((layer.region().area_mm2() / area - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_hole_beside_the_board_is_told_of() {
        let warnings = |x: f64, shift: f64| {
            let board = PhotoBoard {
                size_mm: DVec2::new(100.0, 30.0),
                thickness_mm: 4.0,
                holes: vec![Hole { centre_mm: DVec2::new(x, 15.0), radius_mm: 4.0 }],
                shift_mm_per_mm: DVec2::new(shift, 0.0),
                shown_mm: 0.0,
            };
            let diagnostics = Diagnostics::default();
            board.report_holes_outside(&diagnostics);
            diagnostics.warnings()
        };
        assert!(warnings(103.0, 0.0).is_empty(), "its rim cuts the edge");
        assert!(warnings(106.0, -1.0).is_empty(), "it leans into the board");
        let outside = warnings(106.0, 1.0);
        assert_eq!(outside.len(), 1);
        assert_eq!(outside[0].id, WarningId::PhotoHoleOutside);
        assert_eq!(outside[0].place.as_ref().map(|p| p.point_mm.clone()), Some(vec![106.0, 15.0]));
    }
}
