//! A guide from the user's own directions: places the directions on the part and turns them with it.
//!
//! The reader, the interpolation and their limits are in [`grainpath_io::directions`]. This module
//! maps a point of the part to the coordinates of the directions file. With the frame "part", these
//! are the coordinates of the shape's file: unit, scale, rotation and lowering of the part are undone,
//! and the direction found at the mapped point is turned like the part. With the frame "plate", the
//! file's positions are bed coordinates, and its directions are used unchanged.
//!
//! A grid without positions is centred on the part. Without a cell size it is stretched to cover the
//! part. Degenerate cases: samples that lie entirely beside the part are an error; a part that reaches
//! beyond the samples gives a warning, and so do directions that have no part in the layers, as those that stand upright
//! on them.

use grainpath_core::math::sin_cos;
use grainpath_core::poly::LineClipper;
use grainpath_core::{
    DMat3, DVec2, DVec3, Diagnostics, DirectionField, DirectionSample, LayerStack, Warning, WarningId,
};
use grainpath_io::directions::{DirectionSamples, DirectionSummary};
use grainpath_job::choices::FieldFrame;
use serde::Serialize;

/// Settings that place directions on a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldSettings {
    /// The coordinate system of the file's positions: that of the part or that of the plate.
    pub frame: FieldFrame,
    /// Size of a cell of a grid, mm.
    pub cell_mm: Option<f64>,
    /// Lower left corner of a grid, mm.
    pub origin_mm: Option<DVec2>,
    /// Factor by which the part was scaled, apart from the unit of its file.
    pub scale: f64,
    /// Turns of the part about x, then y, then z, radians.
    pub rotate_rad: [f64; 3],
    /// How far the part was lowered to stand on the plate, mm.
    pub lowered_mm: f64,
    /// Position of the part's origin on the bed, mm.
    pub plate_from_part_mm: DVec3,
}

impl FieldSettings {
    /// For positions in the coordinates of a part that stands as in its file, at the origin of the bed. Source: derived; nothing is
    /// scaled, turned or moved.
    pub const AS_IN_FILE: Self = Self {
        frame: FieldFrame::Part,
        cell_mm: None,
        origin_mm: None,
        scale: 1.0,
        rotate_rad: [0.0; 3],
        lowered_mm: 0.0,
        plate_from_part_mm: DVec3::ZERO,
    };
}

/// Why directions cannot guide a part.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum FieldError {
    #[error(
        "the directions lie from ({:.2}, {:.2}) to ({:.2}, {:.2}) mm and the part from ({:.2}, {:.2}) to ({:.2}, {:.2}); \
         check guide.field.frame and guide.field.length_unit",
        directions[0].x, directions[0].y, directions[1].x, directions[1].y, part[0].x, part[0].y, part[1].x, part[1].y
    )]
    Elsewhere { directions: [DVec3; 2], part: [DVec3; 2] },
}

/// How directions were read and placed on the part, for the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct FieldReport {
    pub format: &'static str,
    pub layout: String,
    pub samples: usize,
    pub without_direction: usize,
    pub directions: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub length_unit: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub axis_order: String,
    pub frame: &'static str,
    pub low_mm: [f64; 3],
    pub high_mm: [f64; 3],
}

/// Directions placed on a part.
pub struct FieldGuide {
    samples: DirectionSamples,
    /// Rotation that turns a direction of the file into part coordinates.
    turn: DMat3,
    /// From part coordinates to the file's: `to_file * (p + shift_mm)`.
    to_file: DMat3,
    shift_mm: DVec3,
    /// How the directions were read and placed on the part.
    pub report: FieldReport,
}

/// Largest relative difference between the stretch factors of a grid in x and y that gives no warning.
/// Source: derived: a direction at 45 degrees turns by half of this share, 0.6 degrees, which is less
/// than the angle between a plan's beads and its guide.
const MAX_STRETCH: f64 = 0.02;
/// Share of the part that may have no direction without a warning. Source: chosen; the beads of 1 % of a part change neither its
/// stiffness nor its mean angle by what a plan can be told by.
const MAX_UNDIRECTED: f64 = 0.01;
/// Layers, and places along each side of their box, at which directions are looked for. Source: derived: of 8 x 32 x 32
/// places, 1 % are 80, and all take some milliseconds.
const LOOKED_LAYERS: usize = 8;
const LOOKED_PLACES: usize = 32;

impl FieldGuide {
    /// Places samples on the part from which `stack` was sliced.
    ///
    /// # Errors
    /// [`FieldError::Elsewhere`] if the bounding box of the samples does not overlap that of the part.
    pub fn new(
        mut samples: DirectionSamples,
        settings: &FieldSettings,
        stack: &LayerStack,
        diagnostics: &Diagnostics,
    ) -> Result<Self, FieldError> {
        samples.warnings().iter().for_each(|w| diagnostics.push(w.clone()));
        let (turn, to_file, shift_mm) = to_file(settings);
        let corners = stack.layers().iter().flat_map(|layer| {
            let z = layer.z_top_mm() - 0.5 * layer.height_mm();
            layer.region().contours().flatten().map(move |p| to_file * (p.extend(z) + shift_mm))
        });
        let (mut low, mut high) =
            corners.fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
        if low.x > high.x {
            (low, high) = (DVec3::ZERO, DVec3::ZERO);
        }
        if let Some([columns, rows]) = samples.unplaced_grid() {
            let n = DVec2::new(columns as f64, rows as f64);
            let part = (high - low).truncate();
            let cell = settings.cell_mm.map_or(part / n, DVec2::splat).max(DVec2::splat(1e-6));
            if settings.cell_mm.is_none() && (cell.x / cell.y - 1.0).abs() > MAX_STRETCH {
                let text = format!(
                    "the grid of {columns} x {rows} cells was stretched over the part: a cell measures {:.4} x {:.4} mm",
                    cell.x, cell.y
                );
                diagnostics.warn(WarningId::FieldStretched, text);
            }
            let centred = 0.5 * (low + high).truncate() - 0.5 * cell * n;
            samples.place_grid(settings.origin_mm.unwrap_or(centred), cell);
        }
        let bounds = samples.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
        let summary = samples.summary().clone();
        let guide =
            Self { report: report(&summary, settings.frame, bounds), samples, turn, to_file, shift_mm };
        guide.check_cover(bounds, (low, high), diagnostics)?;
        guide.warn_of_undirected(stack, diagnostics);
        Ok(guide)
    }

    /// Warns if the directions have no part in the layers in a clear share of the part.
    fn warn_of_undirected(&self, stack: &LayerStack, diagnostics: &Diagnostics) {
        let layers = stack.layers();
        let (mut n, mut n_undirected) = (0usize, 0usize);
        for layer in layers.iter().step_by(layers.len().div_ceil(LOOKED_LAYERS).max(1)) {
            let Some(bounds) = layer.region().bounds() else { continue };
            let (inside, z) = (LineClipper::new(layer.region()), layer.z_top_mm() - 0.5 * layer.height_mm());
            let step = bounds.size() / LOOKED_PLACES as f64;
            let places = (0..LOOKED_PLACES).flat_map(|j| (0..LOOKED_PLACES).map(move |i| (i, j)));
            for (i, j) in places {
                let p = bounds.min + step * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
                if inside.contains(p) {
                    n += 1;
                    n_undirected += usize::from(self.asked(p.extend(z)).1 == 0.0);
                }
            }
        }
        let share = n_undirected as f64 / n.max(1) as f64;
        if share > MAX_UNDIRECTED {
            let text = format!(
                "in {:.0} % of the part the directions stand upright on the layers or cancel each other; the beads have no \
                 direction to follow there and run along x",
                100.0 * share
            );
            diagnostics.push(Warning::new(WarningId::FieldLeftOut, text).with_remedy(
                "turn the part (shape.rotate_deg) so that its layers lie along the directions, or check guide.field.frame",
            ));
        }
    }

    /// Returns an error for samples that lie beside the part, and warns if the part reaches beyond them.
    fn check_cover(
        &self,
        samples: (DVec3, DVec3),
        part: (DVec3, DVec3),
        diagnostics: &Diagnostics,
    ) -> Result<(), FieldError> {
        let axes = if self.samples.is_plane() { 2 } else { 3 };
        let one_place = samples.0 == samples.1;
        let beyond = |k: usize| (samples.0[k] - part.0[k]).max(part.1[k] - samples.1[k]);
        let apart = |k: usize| samples.0[k] > part.1[k] || samples.1[k] < part.0[k];
        if (0..axes).any(apart) {
            return Err(FieldError::Elsewhere { directions: [samples.0, samples.1], part: [part.0, part.1] });
        }
        // Samples lie at the centres of cells, so the outermost ones lie half a cell inside the part's border.
        let size = (samples.1 - samples.0).truncate();
        let pitch = (size.x * size.y / self.samples.summary().samples as f64).sqrt();
        let far = (0..axes).map(beyond).fold(0.0, f64::max);
        if far > pitch && !one_place {
            let text = format!(
                "the part reaches {far:.2} mm beyond the directions; those of the nearest place were used there"
            );
            diagnostics.push(Warning::new(WarningId::FieldTooSmall, text));
        }
        Ok(())
    }

    /// Whether the directions are the same at every height of the part.
    pub fn is_upright(&self) -> bool {
        self.samples.is_plane() && self.turn.z_axis == DVec3::Z
    }

    /// The direction that the file gives at a point of the part, radians, and its strength, 0 to 1. Where there is none in
    /// the plane of the layer, the strength is 0.
    pub fn asked(&self, p: DVec3) -> (f64, f64) {
        self.samples.sample(self.to_file * (p + self.shift_mm)).in_plane(&self.turn)
    }
}

impl DirectionField for FieldGuide {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let (axis_rad, strength) = self.asked(p);
        DirectionSample { axis_rad, strength, principal_mpa: None }
    }

    fn spacing_mm(&self, p: DVec3) -> Option<f64> {
        self.samples.sample(self.to_file * (p + self.shift_mm)).spacing_mm
    }
}

/// Returns the rotation from the file to the part, then `to_file` and `shift_mm` of the map from a point of the part to
/// the file: `to_file * (p + shift_mm)`.
pub(super) fn to_file(settings: &FieldSettings) -> (DMat3, DMat3, DVec3) {
    match settings.frame {
        FieldFrame::Part => {
            let [x, y, z] = settings.rotate_rad;
            let turn = turn_about(2, z) * turn_about(1, y) * turn_about(0, x);
            let back = turn.transpose() * (1.0 / settings.scale);
            (turn, back, DVec3::new(0.0, 0.0, settings.lowered_mm))
        }
        FieldFrame::Plate => (DMat3::IDENTITY, DMat3::IDENTITY, settings.plate_from_part_mm),
    }
}

/// The rotation matrix about an axis (0 is x, 1 is y, 2 is z) by the right-hand rule.
fn turn_about(axis: usize, angle_rad: f64) -> DMat3 {
    let (s, c) = sin_cos(angle_rad);
    match axis {
        0 => DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c)),
        1 => DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c)),
        _ => DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z),
    }
}

fn report(summary: &DirectionSummary, frame: FieldFrame, bounds: (DVec3, DVec3)) -> FieldReport {
    let round = |p: DVec3| p.to_array().map(|v| (v * 1e4).round() / 1e4);
    FieldReport {
        format: summary.format,
        layout: summary.layout.clone(),
        samples: summary.samples,
        without_direction: summary.without_direction,
        directions: summary.directions.clone(),
        length_unit: summary.length_unit.clone(),
        axis_order: summary.axis_order.clone(),
        frame: match frame {
            FieldFrame::Part => "part",
            FieldFrame::Plate => "plate",
        },
        low_mm: round(bounds.0),
        high_mm: round(bounds.1),
    }
}
