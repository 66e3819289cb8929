//! Planning of a scan on several machines: a survey of the whole scan, the layers of a range of slices, the joining of
//! these parts, and the paths of a window of layers.

use std::sync::Arc;

use grainpath::order::paths_to_bytes;
use grainpath::run::{config, fill_window as filled, fills_in_windows as in_windows};
use grainpath_cli::Failure;
use grainpath_core::Diagnostics;
use grainpath_imaging::scan::{PartedScan, ScanError, ScanPart, Survey};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::ARRAY;
use crate::plan::{Array, ScanData, Watch};
use crate::spec::Spec;
use crate::stack::StackData;
use crate::volume::{ArrayShape, ArraySource, Slabs, info_of, info_with};
use crate::worker::{self, Caller};

/// The survey of a whole scan before it is cut: the lowest and the highest grey value of material, the step from air to
/// material, the least grey value, and the height at which the part begins.
type Found = (f64, f64, f64, f64, Option<f64>);

fn survey_of((low, high, contrast, air, start_mm): Found) -> Survey {
    Survey { low, high, contrast, air, start_mm }
}

/// Turns an error of a scan into the failure that planning a job reports for it.
fn failure(error: ScanError) -> Failure {
    match error {
        ScanError::Slices(e) => grainpath::Error::Slices(e),
        source => grainpath::Error::Scan { path: ARRAY.to_owned(), source },
    }
    .into()
}

/// Runs `work` on the slices of an array. Slices from `end` on are not read ahead, because `work` does not need them.
fn with_slices<'py, T: Send + 'static>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    (size, sample, spacing_mm, slices, _): Array<'py>,
    end: usize,
    (threads, progress, cancel): Watch<'py>,
    work: impl FnOnce(&PartedScan, &mut ArraySource, &Diagnostics) -> Result<T, ScanError> + Send + 'static,
) -> PyResult<T> {
    let settings = spec.get().settings.clone();
    let caller = Caller { progress, cancel, array: Some(slices), threads };
    worker::run(py, &caller, move |diagnostics, requests| {
        let info = info_of(&(size, sample, spacing_mm));
        let mut source = Slabs::in_order(info.clone(), end, requests);
        let scan = PartedScan::new(&info, &config::scan(&settings)).map_err(failure)?;
        work(&scan, &mut source, diagnostics).map_err(failure)
    })
}

/// Surveys a whole scan, as cutting a part of it requires. Returns the survey and the range of slices in use.
#[pyfunction]
pub(crate) fn scan_survey<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    array: Array<'py>,
    watch: Watch<'py>,
) -> PyResult<(Found, [usize; 2])> {
    let end = array.0[2];
    with_slices(py, spec, array, end, watch, |scan, source, diagnostics| {
        let Survey { low, high, contrast, air, start_mm } = scan.survey(source, diagnostics)?;
        Ok(((low, high, contrast, air, start_mm), [scan.slices().start, scan.slices().end]))
    })
}

/// The layers between each of these slices and the slice just below it, as bytes. Slices count from the first one taken.
#[pyfunction]
pub(crate) fn scan_part<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    array: Array<'py>,
    found: Found,
    slices: (usize, usize, usize),
    watch: Watch<'py>,
) -> PyResult<Bound<'py, PyBytes>> {
    let (first, end, taken) = slices;
    let part = with_slices(py, spec, array, taken + end, watch, move |scan, source, diagnostics| {
        Ok(scan.cut(source, &survey_of(found), first..end, diagnostics)?.to_bytes())
    })?;
    Ok(PyBytes::new(py, &part))
}

/// Joins the parts that [`scan_part`] made into the layers of the scan. `n_missing` is the number of chunks that its store
/// has not.
#[pyfunction]
#[pyo3(signature = (spec, array, found, parts, watch, n_missing=0))]
pub(crate) fn scan_join<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    array: ArrayShape,
    found: Found,
    parts: Vec<Vec<u8>>,
    watch: Watch<'py>,
    n_missing: usize,
) -> PyResult<ScanData> {
    let settings = spec.get().settings.clone();
    let (threads, progress, cancel) = watch;
    let caller = Caller { progress, cancel, threads, array: None };
    worker::run(py, &caller, move |diagnostics, _| {
        let scan =
            PartedScan::new(&info_with(&array, n_missing), &config::scan(&settings)).map_err(failure)?;
        let read = |bytes: &Vec<u8>| ScanPart::from_bytes(bytes).map_err(|e| Failure::input(e.to_string()));
        let parts = parts.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let cut = scan.join(&survey_of(found), parts, diagnostics).map_err(failure)?;
        Ok(ScanData { cut, warnings: diagnostics.warnings() })
    })
}

/// Whether the layers of a job can be filled in windows that do not depend on each other.
#[pyfunction]
pub(crate) fn fills_in_windows(spec: &Bound<'_, Spec>) -> bool {
    in_windows(&spec.get().settings)
}

/// The walls, skins and infill of a window of layers as bytes, not yet in printing order.
#[pyfunction]
pub(crate) fn fill_window<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    stack: &Bound<'py, StackData>,
    window: (usize, usize),
    watch: Watch<'py>,
) -> PyResult<Bound<'py, PyBytes>> {
    let (settings, stack) = (spec.get().settings.clone(), Arc::clone(&stack.get().stack));
    let (threads, progress, cancel) = watch;
    let caller = Caller { progress, cancel, threads, array: None };
    let bytes = worker::run(py, &caller, move |diagnostics, _| {
        let (first, end) = window;
        if first > end || end > stack.layers().len() {
            return Err(Failure::input(format!("no layers {first} to {end} of {}", stack.layers().len())));
        }
        Ok(paths_to_bytes(&filled(&config::steps(&settings), &stack, first..end, diagnostics)?))
    })?;
    Ok(PyBytes::new(py, &bytes))
}
