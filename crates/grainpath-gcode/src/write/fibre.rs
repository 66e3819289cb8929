//! Lays continuous fibre. It is fed where a run begins. It is cut before the end of the run, at the
//! distance of the cutter, so that the fibre beyond the cutter is used up.
//!
//! A run is what is laid with one piece of fibre. It is one path, or several paths, even over several
//! layers, that follow each other without a travel between them.

use grainpath_core::PlannedPath;

use super::fibre_runs::InRun;
use super::program::{Writer, micro};
use super::template::{self, Values};
use super::{GcodeError, WriteConfig};
use crate::machine::FibreTool;

/// Checks the templates of the fibre tool, before anything is written.
pub(super) fn check(config: &WriteConfig, n_layers: usize, top_mm: f64) -> Result<(), GcodeError> {
    let Some(tool) = &config.fibre else { return Ok(()) };
    let values = values(config, tool, n_layers, top_mm, 0, 0.0);
    for (name, text) in programs(tool) {
        values.filled(name, text)?;
    }
    Ok(())
}

fn programs(tool: &FibreTool) -> [(&'static str, &str); 3] {
    [
        ("tool_change_gcode", &tool.tool_change_gcode),
        ("fibre_feed_gcode", &tool.feed_gcode),
        ("fibre_cut_gcode", &tool.cut_gcode),
    ]
}

fn values(
    config: &WriteConfig,
    tool: &FibreTool,
    n_layers: usize,
    top_mm: f64,
    number: usize,
    run_mm: f64,
) -> Values {
    let mut values = template::values(config, n_layers, top_mm);
    values.extend([
        ("tool", number.to_string()),
        ("feed_mm", format!("{:.3}", tool.cutter_mm)),
        ("fibre_mm", format!("{run_mm:.3}")),
        ("fibre_nozzle_temp_c", tool.material.nozzle_temp_c.to_string()),
        // The template may select either tool, so the temperature depends on the tool number.
        ("tool_nozzle_temp_c", {
            let m = if Some(number) == tool.tool { &tool.material } else { &config.material };
            m.nozzle_temp_c.to_string()
        }),
    ]);
    values
}

impl Writer<'_> {
    /// Changes to the tool that a path needs.
    pub(super) fn take_tool(&mut self, fibre: bool) {
        let config = self.config;
        let Some(tool) = config.fibre.as_ref() else { return };
        let (filament, material) = if fibre {
            (tool.filament_mm, &tool.material)
        } else {
            (config.machine.filament_mm, &config.material)
        };
        // Material and filament diameter change with the path even if there is only one nozzle.
        self.filament_mm2 = 0.25 * std::f64::consts::PI * filament * filament;
        self.material = material;
        let Some(number) = tool.tool else { return };
        if fibre == self.fibre_tool {
            return;
        }
        // The nozzle that is left must not drip, so the matrix is retracted. Fibre is cut and needs no
        // retraction.
        if fibre {
            self.retract();
        }
        self.fibre_tool = fibre;
        self.program(&tool.tool_change_gcode, "tool_change_gcode", if fibre { number } else { 0 }, 0.0);
        // A tool changer may leave the head anywhere.
        self.at = [None; 3];
    }

    /// Writes one of the fibre tool's templates.
    fn program(&mut self, text: &str, name: &'static str, number: usize, run_mm: f64) {
        let config = self.config;
        let Some(tool) = config.fibre.as_ref() else { return };
        // All templates were checked before anything was written, so this cannot fail.
        let values = values(config, tool, self.n_layers, self.top_mm, number, run_mm);
        if let Ok(text) = values.filled(name, text)
            && !text.trim().is_empty()
        {
            self.line(text.trim_end());
        }
        // The template may have moved E by an unknown length.
        if !self.config.machine.relative_e {
            self.line("G92 E0");
            self.e_reset = self.e_steps;
        }
        // The template may have changed feed rate and acceleration, so the next move states its own.
        (self.feed, self.acceleration) = (0, 0.0);
    }

    /// Lays a path of fibre. It is slow where the fibre is anchored, and the fibre is cut where the rest
    /// reaches the end.
    pub(super) fn lay_fibre(&mut self, planned: &PlannedPath, run: InRun, height_mm: f64, speed: f64) {
        let config = self.config;
        let Some(tool) = config.fibre.as_ref() else { return };
        let path = &planned.path;
        let length = path.length_mm();
        let run_mm = run.before_mm + length + run.after_mm;
        let number = tool.tool.unwrap_or(0);
        if run.begins {
            self.written.fibre_runs += 1;
            self.line(";FIBRE_START");
            self.program(&tool.feed_gcode, "fibre_feed_gcode", number, run_mm);
        }
        // The position of the cut, from the start of the path. A run shorter than the cutter's distance
        // is cut at its start.
        let from_start = length + run.after_mm - tool.cutter_mm;
        let cut = if run.begins { from_start.max(0.0) } else { from_start };
        let anchored = tool.anchor_mm - run.before_mm;
        let slow = speed.min(tool.anchor_speed_mm_s);
        let per_mm = path.flow * self.material.flow / self.filament_mm2;
        self.written.fibre_mm += length;
        let mut done = 0.0;
        for i in 0..path.n_segments() {
            let (a, b, width) = path.segment(i);
            let l = a.distance(b);
            let area = grainpath_core::units::bead_area_mm2(width, height_mm);
            let mut at = a;
            // Positions within the segment where the speed changes or the fibre is cut.
            let mut stops: Vec<f64> =
                [anchored - done, cut - done].into_iter().filter(|s| *s >= 0.0 && *s < l).collect();
            stops.sort_by(f64::total_cmp);
            for stop in stops {
                let to = a + (b - a) * (stop / l.max(1e-12));
                let v = if done + stop <= anchored + 1e-9 { slow } else { speed };
                // Two stops that round to the same position need no move between them.
                if micro(to.x) != micro(at.x) || micro(to.y) != micro(at.y) {
                    self.extrude(at, to, at.distance(to), area * per_mm, v);
                    at = to;
                }
                if stop == cut - done {
                    self.written.cuts += 1;
                    self.line(";FIBRE_CUT");
                    self.program(&tool.cut_gcode, "fibre_cut_gcode", number, run_mm);
                }
            }
            let v = if done + l <= anchored + 1e-9 { slow } else { speed };
            self.extrude(at, b, at.distance(b), area * per_mm, v);
            done += l;
        }
    }
}
