//! Functions beside planning: growing supports, making specimens, examples and marker sheets, and inspecting files.

use std::path::PathBuf;

use grainpath::measure::report::SupportReport;
use grainpath_core::DVec2;
use grainpath_imaging::photo::markers::{marker_sheet_pdf, marker_sheet_svg};
use grainpath_parts::presets;
use grainpath_parts::specimen::SPECIMENS;
use grainpath_parts::test_pieces::TEST_PIECES;
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::MESH;
use crate::mesh::MeshData;
use crate::spec::Spec;
use crate::worker::{self, Caller};

/// Grows supports for a mesh. Returns their surface, `None` if no overhang needs support, and the report as JSON.
#[pyfunction]
pub(crate) fn support(
    py: Python<'_>,
    spec: &Bound<'_, Spec>,
    mesh: &Bound<'_, MeshData>,
) -> PyResult<(Option<MeshData>, String)> {
    let (settings, file) = (spec.get().settings.clone(), mesh.get().file.clone());
    worker::run(py, &Caller::default(), move |diagnostics, _| {
        settings.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
        let grown = grainpath_cli::grow(&settings, file, MESH, diagnostics)?;
        let (beads, solid) = (grown.support.beads_mm3(&grown.stack), grown.support.volume_mm3(&grown.stack));
        let report = SupportReport::new(&grown.support, beads, solid, settings.material.density_g_cm3);
        let report = json!({ "support": report, "warnings": diagnostics.warnings() }).to_string();
        let is_some = !grown.surface.triangles.is_empty();
        Ok((is_some.then(|| MeshData::from_mesh(grown.surface)), report))
    })
}

/// Inspects a file and describes its kind and content as JSON.
#[pyfunction]
pub(crate) fn inspect(
    py: Python<'_>,
    path: PathBuf,
    size: Option<Vec<usize>>,
    sample: String,
) -> PyResult<String> {
    worker::run(py, &Caller::default(), move |_, _| {
        Ok(grainpath_cli::inspect_file(&path, size, &sample)?.to_string())
    })
}

/// Specimens and test pieces: the name of each, its purpose, and whether it comes with a job that tests it.
#[pyfunction]
pub(crate) fn pieces() -> Vec<(&'static str, &'static str, bool)> {
    let plain = SPECIMENS.iter().map(|s| (s.name, s.about, false));
    plain.chain(TEST_PIECES.iter().map(|p| (p.name, p.about, true))).collect()
}

/// The mesh of a piece, and its job as text where it has one; `None` for an unknown name.
#[pyfunction]
pub(crate) fn specimen(name: &str) -> Option<(MeshData, Option<String>)> {
    if let Some(piece) = TEST_PIECES.iter().find(|p| p.name == name) {
        return Some((MeshData::from_mesh(piece.mesh()), Some(piece.job(name))));
    }
    let piece = SPECIMENS.iter().find(|s| s.name == name)?;
    Some((MeshData::from_mesh((piece.mesh)()), None))
}

/// The files of an example as names and contents, the job first; `None` for an unknown name. With `pixels`, the files of
/// the example `ct` with slices of that many pixels a side. The second value lists the names of all examples.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub(crate) fn example(
    py: Python<'_>,
    name: String,
    pixels: Option<usize>,
) -> PyResult<(Option<Vec<(String, Vec<u8>)>>, Vec<&'static str>)> {
    let made = worker::run(py, &Caller::default(), move |_, _| {
        Ok(pixels.map_or_else(|| presets::preset(&name), |n| Some(presets::ct(n))))
    })?;
    let files = made.map(|files| files.into_iter().map(|(name, bytes)| (name.to_string(), bytes)).collect());
    Ok((files, presets::PRESETS.to_vec()))
}

/// A sheet with corner markers round a rectangle of this size, mm, as SVG or PDF.
#[pyfunction]
pub(crate) fn marker_sheet(width_mm: f64, height_mm: f64, pdf: bool) -> Vec<u8> {
    let size = DVec2::new(width_mm, height_mm);
    if pdf { marker_sheet_pdf(size) } else { marker_sheet_svg(size).into_bytes() }
}
