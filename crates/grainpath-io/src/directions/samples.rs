//! A field of directions, interpolated between samples at any point.

use grainpath_core::{DVec2, DVec3, Warning, WarningId};

use super::cloud::Carrier;
use super::model::{BlendedDirection, DirectionSummary};

/// Directions at points, interpolated anywhere, in the coordinates of their file in mm.
///
/// ```
/// use grainpath_core::{DMat3, DVec3};
/// use grainpath_io::directions::{DirectionOptions, parse_directions};
///
/// // 170 and 10 degrees are 20 degrees apart: halfway lies 0, not 90.
/// let table = "x_mm,y_mm,angle_deg\n0,0,170\n10,0,10\n0,10,170\n10,10,10\n";
/// let samples = parse_directions(&[("theta.csv", table.as_bytes())], &DirectionOptions::default())?;
/// let (axis_rad, strength) = samples.sample(DVec3::new(5.0, 5.0, 0.0)).in_plane(&DMat3::IDENTITY);
/// assert!(axis_rad.sin().abs() < 1e-9 && strength > 0.9);
/// assert_eq!(samples.summary().samples, 4);
/// # Ok::<(), grainpath_io::directions::DirectionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DirectionSamples {
    carrier: Carrier,
    summary: DirectionSummary,
    warnings: Vec<Warning>,
}

impl DirectionSamples {
    pub(super) fn new(carrier: Carrier, summary: DirectionSummary, warnings: Vec<Warning>) -> Self {
        Self { carrier, summary, warnings }
    }

    /// Adds a warning that counts the samples without a direction.
    pub(super) fn with_count_warning(mut self) -> Self {
        let n = self.summary.without_direction;
        if n > 0 {
            let all = n + self.summary.samples;
            let text = format!("{n} of {all} samples have no direction (NaN, a zero vector or strength 0)");
            self.warnings.push(Warning::new(WarningId::FieldLeftOut, text));
        }
        self
    }

    /// Adds the order of a grid's indices and a warning where it was assumed.
    pub(super) fn with_axes(mut self, axis_order: String, warning: Option<Warning>) -> Self {
        self.summary.axis_order = axis_order;
        self.warnings.extend(warning);
        self
    }

    /// How the file was read.
    pub fn summary(&self) -> &DirectionSummary {
        &self.summary
    }

    /// What was assumed or left out.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Whether the directions are the same at all heights.
    pub fn is_plane(&self) -> bool {
        self.carrier.is_plane()
    }

    /// Columns and rows of a grid without a position; `None` for other samples and after
    /// [`DirectionSamples::place_grid`].
    pub fn unplaced_grid(&self) -> Option<[usize; 2]> {
        match &self.carrier {
            Carrier::Grid(grid) if grid.place.is_none() => Some([grid.columns, grid.rows]),
            Carrier::Grid(_) | Carrier::Planes(_) | Carrier::Cloud(_) => None,
        }
    }

    /// Places a grid by its lower left corner and the size of a cell, mm. Samples of other kinds keep their own
    /// positions.
    pub fn place_grid(&mut self, corner_mm: DVec2, cell_mm: DVec2) {
        if let Carrier::Grid(grid) = &mut self.carrier {
            grid.place = Some((corner_mm, cell_mm));
        }
    }

    /// Lowest and highest corner of the box around the samples, mm; z is 0 for those of a plane.
    /// `None` for a grid that was not placed.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.carrier.bounds()
    }

    /// The direction at a point, mm. Outside the samples it is that of the nearest place.
    pub fn sample(&self, p: DVec3) -> BlendedDirection {
        self.carrier.sample(p)
    }
}
