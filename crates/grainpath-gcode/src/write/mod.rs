//! Writes a plan as a G-code program.

mod arcs;
mod fibre;
mod fibre_runs;
mod number;
mod program;
mod template;

use std::io;

use grainpath_core::{BeadWidth, Plan, PlannedPath};

use crate::machine::{Cooling, FibreTool, Machine, Material, Retraction, Speeds};

/// Input of the writer besides the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct WriteConfig {
    /// The printer.
    pub machine: Machine,
    /// The material of the matrix.
    pub material: Material,
    /// Speeds of all roles.
    pub speeds: Speeds,
    /// Fan speeds and layer times.
    pub cooling: Cooling,
    /// Retraction for travel moves.
    pub retraction: Retraction,
    /// The tool for fibre paths. Without it, fibre paths are printed like all others.
    pub fibre: Option<FibreTool>,
    /// Largest distance between an arc (G2, G3) and the path that it replaces, mm; `None` writes no arcs.
    pub arc_tolerance_mm: Option<f64>,
    /// Lines for the header, without the semicolon.
    pub header: Vec<String>,
}

/// A preview picture for the printer's screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Thumbnail {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// The PNG file.
    pub png: Vec<u8>,
}

/// Totals of the program that was written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Written {
    /// Length of all beads, mm.
    pub printed_mm: f64,
    /// Length of all travels in plan, mm.
    pub travel_mm: f64,
    /// Volume of all beads, mm3.
    pub extruded_mm3: f64,
    /// Length of filament used, mm.
    pub filament_mm: f64,
    /// Mass of the filament used, g.
    pub mass_g: f64,
    /// Estimated time, s.
    pub time_s: f64,
    /// Number of retractions.
    pub retractions: usize,
    /// Number of paths.
    pub toolpaths: usize,
    /// Length of fibre laid, mm.
    pub fibre_mm: f64,
    /// Number of pieces of fibre.
    pub fibre_runs: usize,
    /// Number of cuts.
    pub cuts: usize,
}

/// Reasons why a plan cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum GcodeError {
    #[error("the print reaches {axis} = {at_mm:.2} mm; the bed allows {low_mm:.2} to {high_mm:.2} mm")]
    OutsideBed { axis: char, at_mm: f64, low_mm: f64, high_mm: f64 },
    #[error(
        "{template}: unknown placeholder {{{name}}}{}",
        near.as_ref().map_or_else(String::new, |near| format!("; did you mean {{{near}}}?"))
    )]
    UnknownPlaceholder { template: &'static str, name: String, near: Option<String> },
    #[error(
        "layer at {z_mm:.3} mm: a coordinate, height, width or flow is not a number, or a height or width is not above 0"
    )]
    NotANumber { z_mm: f64 },
    #[error("writing G-code: {0}")]
    Io(#[from] io::Error),
}

/// Checks that every bead and travel stays on the bed, before anything is written.
///
/// # Errors
/// [`GcodeError::OutsideBed`] with the axis that exceeds the bed furthest, [`GcodeError::NotANumber`].
pub fn check_fits(plan: &Plan, machine: &Machine) -> Result<(), GcodeError> {
    let shift = plan.plate_from_part_mm;
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut top = 0.0f64;
    for layer in &plan.layers {
        // The comparison is written so that NaN fails it.
        if !(shift.is_finite()
            && layer.z_top_mm.is_finite()
            && layer.height_mm.is_finite()
            && layer.height_mm > 0.0)
        {
            return Err(GcodeError::NotANumber { z_mm: layer.z_top_mm });
        }
        top = top.max(layer.z_top_mm);
        for planned in &layer.paths {
            // A bead reaches half its width beyond its centre line.
            let half = 0.5 * widest_sound(planned).ok_or(GcodeError::NotANumber { z_mm: layer.z_top_mm })?;
            for p in planned.path.points.iter().chain(&planned.travel.via) {
                for (k, c) in [p.x + shift.x, p.y + shift.y].into_iter().enumerate() {
                    low[k] = low[k].min(c - half);
                    high[k] = high[k].max(c + half);
                }
            }
        }
    }
    let (bed_low, bed_high) = machine.bed_bounds_mm();
    let reaches = [
        ('X', low[0], bed_low[0], bed_high[0]),
        ('X', high[0], bed_low[0], bed_high[0]),
        ('Y', low[1], bed_low[1], bed_high[1]),
        ('Y', high[1], bed_low[1], bed_high[1]),
        ('Z', top, 0.0, machine.bed_mm[2]),
    ];
    // The axis that exceeds the bed furthest is reported, so that moving the part once is enough.
    let mut worst: Option<(f64, GcodeError)> = None;
    for (axis, at_mm, low_mm, high_mm) in reaches {
        let out = (at_mm - high_mm).max(low_mm - at_mm);
        // A plan without paths has no finite extent. Up to 1e-6 mm beyond the bed is rounding.
        if at_mm.is_finite() && out > 1e-6 && worst.as_ref().is_none_or(|(most, _)| out > *most) {
            worst = Some((out, GcodeError::OutsideBed { axis, at_mm, low_mm, high_mm }));
        }
    }
    worst.map_or(Ok(()), |(_, error)| Err(error))
}

/// The greatest width of a path, mm. `None` where a coordinate, width or flow of the path or of its
/// travel is not a sound number.
fn widest_sound(planned: &PlannedPath) -> Option<f64> {
    let path = &planned.path;
    let points = path.points.iter().chain(&planned.travel.via);
    let widths = match &path.width {
        BeadWidth::Constant(w) => std::slice::from_ref(w),
        // Every vertex must have a width, or the writer would read past the end of the list.
        BeadWidth::PerVertex(w) if w.len() == path.points.len() => w.as_slice(),
        BeadWidth::PerVertex(_) => return None,
    };
    let sound = path.flow.is_finite()
        && path.flow >= 0.0
        && points.clone().all(|p| p.is_finite())
        && widths.iter().all(|w| w.is_finite() && *w > 0.0);
    sound.then(|| widths.iter().copied().fold(0.0, f64::max))
}

/// Writes a plan. The same plan and settings give the same bytes.
///
/// # Errors
/// [`GcodeError`]: outside the bed, an unknown placeholder, values that are not numbers, or an error of the output.
pub fn write_gcode(
    plan: &Plan,
    config: &WriteConfig,
    thumbnails: &[Thumbnail],
    out: &mut dyn io::Write,
) -> Result<Written, GcodeError> {
    check_fits(plan, &config.machine)?;
    let top = plan.layers.last().map_or(0.0, |l| l.z_top_mm);
    let values = template::values(config, plan.layers.len(), top);
    // All templates are checked before the first byte is written: half a program is worse than none.
    let start = values.filled("start_gcode", &config.machine.start_gcode)?;
    let end = values.filled("end_gcode", &config.machine.end_gcode)?;
    fibre::check(config, plan.layers.len(), top)?;
    program::Writer::new(config, plan, out).write(plan, thumbnails, &start, &end)
}

#[cfg(test)]
mod tests;
