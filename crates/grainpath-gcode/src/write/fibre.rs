//! Continuous fibre: fed where a run begins, cut so far before its end that the rest of it is just laid.
//!
//! A run is what is laid of one piece of fibre: a path, or several that follow each other without a way between,
//! over layers too.

use grainpath_core::PlannedPath;

use super::fibre_runs::InRun;
use super::program::{Writer, micro};
use super::template::{self, Values};
use super::{GcodeError, WriteConfig};
use crate::machine::FibreTool;

/// Checks the fibre tool's programs, before anything is written.
pub fn check(config: &WriteConfig, n_layers: usize, top_mm: f64) -> Result<(), GcodeError> {
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
        ("tool_nozzle_temp_c", {
            let m = if Some(number) == tool.tool { &tool.material } else { &config.material };
            m.nozzle_temp_c.to_string()
        }),
    ]);
    values
}

impl Writer<'_> {
    /// Takes the tool that a path wants.
    pub(super) fn take_tool(&mut self, fibre: bool) {
        let config = self.config;
        let Some(tool) = config.fibre.as_ref() else { return };
        let (filament, material) = if fibre {
            (tool.filament_mm, &tool.material)
        } else {
            (config.machine.filament_mm, &config.material)
        };
        self.filament_mm2 = 0.25 * std::f64::consts::PI * filament * filament;
        self.material = material;
        let Some(number) = tool.tool else { return };
        if fibre == self.fibre_tool {
            return;
        }
        // The nozzle left behind must not drip; the fibre's has been cut.
        if fibre {
            self.retract();
        }
        self.fibre_tool = fibre;
        self.program(&tool.tool_change_gcode, "tool_change_gcode", if fibre { number } else { 0 }, 0.0);
        // Changers park the head where they like.
        self.at = [None; 3];
    }

    /// Writes one of the tool's programs.
    fn program(&mut self, text: &str, name: &'static str, number: usize, run_mm: f64) {
        let config = self.config;
        let Some(tool) = config.fibre.as_ref() else { return };
        // They were checked before anything was written.
        let values = values(config, tool, self.n_layers, self.top_mm, number, run_mm);
        if let Ok(text) = values.filled(name, text)
            && !text.trim().is_empty()
        {
            self.line(text.trim_end());
        }
        if !self.config.machine.relative_e {
            self.line("G92 E0");
            self.e_reset = self.e_steps;
        }
        // Whatever the program did with feed and acceleration, the next move says its own.
        (self.feed, self.acceleration) = (0, 0.0);
    }

    /// Lays a path of fibre: slowly where it is anchored, and cut where what is left reaches its end.
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
        // From the path's own start. A run shorter than the cutter's distance is cut where it begins.
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
            // Where within the segment something changes.
            let mut stops: Vec<f64> =
                [anchored - done, cut - done].into_iter().filter(|s| *s >= 0.0 && *s < l).collect();
            stops.sort_by(f64::total_cmp);
            for stop in stops {
                let to = a + (b - a) * (stop / l.max(1e-12));
                let v = if done + stop <= anchored + 1e-9 { slow } else { speed };
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
