//! Replays the programs of any slicer and gives them as arrays.

use std::path::Path;
use std::sync::Arc;

use grainpath_cli::Failure;
use grainpath_gcode::{Limits, Program, simulate};
use grainpath_view::layer::{
    ColourBy, Ground, LayerPicture, PictureOptions, layer_png, layer_svg, thumbnail_png,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::plan::PlanData;
use crate::roles::role_number;
use crate::worker::{self, Caller};

/// A program that was replayed.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct ProgramData {
    /// The program, shared with the threads that draw it.
    program: Arc<Program>,
}

#[pymethods]
impl ProgramData {
    /// Height of the nozzle and thickness of each layer, mm, alternating.
    fn heights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.program.layers.iter().flat_map(|l| [l.z_mm, l.height_mm]).collect())
    }

    /// All beads as packed records, `BEAD` of `grainpath.gcode`.
    fn beads<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        let n: usize = self.program.layers.iter().map(|l| l.beads.len()).sum();
        let mut out = Vec::with_capacity(36 * n);
        for (k, layer) in self.program.layers.iter().enumerate() {
            for bead in &layer.beads {
                let [a, b] = [bead.a, bead.b];
                let width = bead.width_mm(layer.height_mm) as f32;
                for v in [a[0], a[1], b[0], b[1], width, bead.volume_mm3, bead.speed_mm_s] {
                    out.extend(v.to_ne_bytes());
                }
                out.extend((k as u32).to_ne_bytes());
                out.extend([role_number(bead.role), u8::from(bead.starts), 0, 0]);
            }
        }
        PyArray1::from_vec(py, out)
    }

    /// All travels as packed records, `TRAVEL` of `grainpath.gcode`.
    fn travels<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        let mut out = Vec::new();
        for (k, layer) in self.program.layers.iter().enumerate() {
            for v in layer.travels.iter().flat_map(|ends| ends.as_flattened().chunks_exact(4)) {
                v.iter().for_each(|c| out.extend(c.to_ne_bytes()));
                out.extend((k as u32).to_ne_bytes());
            }
        }
        PyArray1::from_vec(py, out)
    }

    /// The angle of each bead of the program of a plan to the direction that its guide asks for, degrees; NaN for beads of
    /// which it asks nothing. `None` if the plan has no guide that asks for directions.
    fn angles<'py>(
        &self,
        py: Python<'py>,
        plan: &Bound<'_, PlanData>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let caller = Caller { threads: plan.get().threads, ..Caller::default() };
        let (plan, program) = (Arc::clone(&plan.get().plan), Arc::clone(&self.program));
        let found = worker::run(py, &caller, move |_, _| {
            let told = |off: Option<f64>| off.unwrap_or(f64::NAN);
            Ok(grainpath_cli::angles_to_guide(&program, &plan.planned, told).map(|layers| layers.concat()))
        })?;
        Ok(found.map(|angles| PyArray1::from_vec(py, angles)))
    }

    /// A picture of layer `k`, or of the whole part: PNG, or SVG as text.
    #[pyo3(signature = (k, color, size_px, travels, svg, plan))]
    #[allow(clippy::too_many_arguments)]
    fn render<'py>(
        &self,
        py: Python<'py>,
        k: Option<usize>,
        color: &str,
        size_px: u32,
        travels: bool,
        svg: bool,
        plan: Option<Bound<'_, PlanData>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let (program, plan) = (Arc::clone(&self.program), plan.map(|plan| Arc::clone(&plan.get().plan)));
        let colour_by = ColourBy::from_name(color).unwrap_or_default();
        let drawn = worker::run(py, &Caller::default(), move |_, _| {
            let Some(k) = k else {
                let layers: Vec<_> = program.layers.iter().map(LayerPicture::from).collect();
                return Ok(thumbnail_png(&layers, size_px, size_px * 3 / 4, Ground::Paper));
            };
            let mut picture = LayerPicture::from(&program.layers[k]);
            if let Some(plan) = plan {
                grainpath_cli::tell_directions(&mut picture, &program, &plan.planned);
            }
            let options = PictureOptions { colour_by, size_px, travels, window: None };
            Ok(if svg { layer_svg(&picture, &options).into_bytes() } else { layer_png(&picture, &options) })
        })?;
        Ok(PyBytes::new(py, &drawn))
    }

    /// The program's counts, lengths, times and warnings, as JSON.
    fn summary(&self) -> String {
        let p = &self.program;
        json!({
            "generator": p.generator, "layers": p.layers.len(), "printed_mm": p.printed_mm,
            "travel_mm": p.travel_mm, "extruded_mm3": p.extruded_mm3, "filament_mm": p.filament_mm,
            "retractions": p.retractions, "time_s": p.time_s, "commands": p.commands, "arcs": p.arcs,
            "nozzle_temp_c": p.nozzle_temp_c, "bed_temp_c": p.bed_temp_c, "thumbnails": p.thumbnails,
            "warnings": p.warnings,
        })
        .to_string()
    }
}

/// Replays a program; `name` is its name in errors.
#[pyfunction]
pub(crate) fn program_from_bytes(
    py: Python<'_>,
    bytes: Vec<u8>,
    name: String,
    filament_mm: f64,
) -> PyResult<ProgramData> {
    worker::run(py, &Caller::default(), move |_, _| {
        let program = simulate(&bytes, filament_mm, &Limits::default());
        let program = program.map_err(|e| Failure::of_file(Path::new(&name), e))?;
        Ok(ProgramData { program: Arc::new(program) })
    })
}
