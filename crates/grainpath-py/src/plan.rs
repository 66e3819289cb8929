//! Plans jobs: turns settings and arrays into paths, the program and the report.

use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use grainpath::Planned;
use grainpath::measure::report::StressReport;
use grainpath::measure::strength::test;
use grainpath::order::paths_from_bytes;
use grainpath_cli::{Failure, Given, Handed};
use grainpath_core::diagnostics::Stage;
use grainpath_core::slices::VolumeInfo;
use grainpath_core::{DVec3, Diagnostics, LayerStack, SpeedClass, Warning, WarningId};
use grainpath_gcode::Written;
use grainpath_imaging::photo::Photo;
use grainpath_imaging::scan::CtStack;
use grainpath_io::MeshFile;
use grainpath_io::directions::{DirectionSamples, parse_directions};
use grainpath_io::fe::{FeFormat, FeResult, StressField};
use grainpath_job::Settings;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::Value;

use crate::errors::{ARRAY, FIELD};
use crate::image::ImageData;
use crate::mesh::MeshData;
use crate::roles::role_number;
use crate::spec::Spec;
use crate::stack::StackData;
use crate::stress::StressData;
use crate::volume::{Slabs, info_with};
use crate::worker::{self, Caller, Request};

/// A planned job, as Python holds it.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct PlanData {
    /// The plan, shared with the threads that write and measure it.
    pub(crate) plan: Arc<Kept>,
    /// The number of threads that the caller asked for; later calls use it too.
    pub(crate) threads: Option<usize>,
}

/// A plan with the data that writing and reporting need.
pub(crate) struct Kept {
    settings: Settings,
    pub(crate) planned: Planned,
    read_s: f64,
    warnings: Vec<Warning>,
    /// The program; `None` until it is written.
    program: Mutex<Option<Arc<Program>>>,
}

/// The program of a plan, its totals, and the seconds that writing took.
struct Program {
    bytes: Vec<u8>,
    written: Written,
    write_s: f64,
}

impl Kept {
    /// The program, written at the first call.
    fn program(&self) -> Result<Arc<Program>, Failure> {
        let mut kept = self.program.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(program) = &*kept {
            return Ok(Arc::clone(program));
        }
        let start = std::time::Instant::now();
        let (bytes, written) = grainpath_cli::program_bytes(&self.settings, &self.planned)?;
        let program = Arc::new(Program { bytes, written, write_s: start.elapsed().as_secs_f64() });
        *kept = Some(Arc::clone(&program));
        Ok(program)
    }

    /// The report, as JSON, of a run whose only output file is the program.
    fn report(&self, diagnostics: &Diagnostics) -> Result<String, Failure> {
        let (settings, planned) = (&self.settings, &self.planned);
        self.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
        let program = self.program()?;
        let read = grainpath_cli::read_back(settings, &program.bytes)?;
        let mut report =
            grainpath_cli::report_of(settings, planned, &program.written, Some(&read), diagnostics);
        report.stages_s.insert(Stage::Read.name(), self.read_s);
        report.stages_s.insert(Stage::Write.name(), program.write_s);
        if let Some(setup) = &planned.test {
            let shift = planned.plan.plate_from_part_mm.truncate();
            let wanted = grainpath::run::config::strength(settings);
            let tested = test(&wanted, setup, &read, Some(shift), diagnostics);
            report.strength = Some(tested.map_err(grainpath::Error::from)?.report);
        }
        report.warnings = diagnostics.warnings();
        report.peak_rss_mb = grainpath_cli::peak_rss_mb();
        Ok(report.to_json().to_string())
    }
}

#[pymethods]
impl PlanData {
    /// Height of the nozzle and thickness of each layer, mm, alternating.
    fn heights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let layers = &self.plan.planned.plan.layers;
        PyArray1::from_vec(py, layers.iter().flat_map(|l| [l.z_top_mm, l.height_mm]).collect())
    }

    /// Where the part's origin stands on the plate, mm.
    fn plate_from_part_mm(&self) -> [f64; 3] {
        self.plan.planned.plan.plate_from_part_mm.to_array()
    }

    /// A layer as two arrays: its vertices, `(n, 3)`, each x, y and bead width; and its paths as records `PATH` of
    /// `grainpath.plan`.
    #[allow(clippy::type_complexity)]
    fn layer<'py>(
        &self,
        py: Python<'py>,
        k: usize,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<u8>>)> {
        let (mut vertices, mut paths) = (Vec::new(), Vec::new());
        for planned in &self.plan.planned.plan.layers[k].paths {
            let path = &planned.path;
            let first = (vertices.len() / 3) as u32;
            for (i, p) in path.points.iter().enumerate() {
                vertices.extend([p.x, p.y, path.width_at(i)]);
            }
            paths.extend(first.to_ne_bytes());
            paths.extend((path.points.len() as u32).to_ne_bytes());
            let speed = match path.speed {
                SpeedClass::Normal => 0,
                SpeedClass::SmallWall => 1,
                SpeedClass::Overhang => 2,
                SpeedClass::Bridge => 3,
            };
            let closed = u8::from(path.closed);
            let retract = u8::from(planned.travel.retract);
            paths.extend([role_number(path.role), speed, closed, retract, path.rank, 0, 0, 0]);
            paths.extend(path.flow.to_ne_bytes());
            paths.extend(path.length_mm().to_ne_bytes());
        }
        let n = vertices.len() / 3;
        Ok((PyArray1::from_vec(py, vertices).reshape([n, 3])?, PyArray1::from_vec(py, paths)))
    }

    /// The part's cross-sections, one for each layer.
    fn stack(&self) -> StackData {
        StackData { stack: Arc::new(self.plan.planned.stack.clone()) }
    }

    /// Warnings of planning as JSON.
    fn warnings(&self) -> String {
        serde_json::json!(self.plan.warnings).to_string()
    }

    /// For each load case its name and weight, the nodes, and the stress and displacement at the nodes.
    fn stress(&self) -> Vec<StressData> {
        let guide = self.plan.planned.guide.as_ref();
        let cases = guide.map(|g| g.cases.iter().zip(&g.results)).into_iter().flatten();
        cases.map(|(case, mesh)| StressData::new(case.weight, mesh)).collect()
    }

    /// The surface of the supports; `None` if the job has no supports or no overhang needs any.
    fn support(&self, py: Python<'_>) -> PyResult<Option<MeshData>> {
        let plan = Arc::clone(&self.plan);
        let caller = Caller { threads: self.threads, ..Caller::default() };
        worker::run(py, &caller, move |diagnostics, _| {
            let Some(support) = &plan.planned.support else { return Ok(None) };
            let method = plan.settings.support.solid;
            let mesh =
                grainpath::support::surface(&support.cut.layers, &plan.planned.stack, method, diagnostics)
                    .map_err(grainpath::Error::from)?;
            Ok((!mesh.triangles.is_empty()).then(|| MeshData::from_mesh(mesh)))
        })
    }

    /// The program, byte for byte what `grainpath run` writes.
    fn gcode<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let plan = Arc::clone(&self.plan);
        let caller = Caller { threads: self.threads, ..Caller::default() };
        let program = worker::run(py, &caller, move |_, _| plan.program())?;
        Ok(PyBytes::new(py, &program.bytes))
    }

    /// Diameter of the filament that the program is written for, mm.
    fn filament_mm(&self) -> f64 {
        self.plan.settings.printer.filament_mm
    }

    /// The report as JSON.
    fn report(
        &self,
        py: Python<'_>,
        progress: Option<Bound<'_, PyAny>>,
        cancel: Option<Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let plan = Arc::clone(&self.plan);
        let caller = Caller { progress, cancel, threads: self.threads, array: None };
        worker::run(py, &caller, move |diagnostics, _| plan.report(diagnostics))
    }
}

/// A caller's array: columns, rows and slices, the type of a voxel, the distances in x, y and z, mm, a function that reads
/// slices, and the number of chunks that its store has not.
pub(crate) type Array<'py> = ([usize; 3], String, Option<[f64; 3]>, Bound<'py, PyAny>, usize);
/// Stress at points: positions in mm, `(n, 3)`, and stresses in MPa, `(n, 6)`, both flattened row by row.
pub(crate) type PointStress<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

/// Makes a finite-element result from stress at points. It is a copy that another thread can use without the interpreter.
fn stress_result(given: Option<PointStress<'_>>) -> PyResult<Option<FeResult>> {
    let Some((points, stress)) = given else { return Ok(None) };
    let nodes: Vec<DVec3> = points.as_slice()?.chunks_exact(3).map(DVec3::from_slice).collect();
    let six = |s: &[f64]| [s[0], s[1], s[2], s[3], s[4], s[5]];
    let plane = nodes.windows(2).all(|w| w[0].z == w[1].z);
    let stress: Vec<[f64; 6]> = stress.as_slice()?.chunks_exact(6).map(six).collect();
    let mut warnings = Vec::new();
    if stress.iter().flatten().all(|component| *component == 0.0) {
        // As the reader of files has it.
        warnings.push(Warning::new(WarningId::FeZeroStress, "the stress is zero everywhere"));
    }
    Ok(Some(FeResult {
        format: FeFormat::Csv,
        nodes,
        elements: Vec::new(),
        stress,
        displacement: None,
        plane,
        stress_array: ARRAY.to_owned(),
        warnings,
    }))
}

/// Reads directions from the bytes of an `.npz` file.
fn field(bytes: Option<&[u8]>, settings: &Settings) -> Result<Option<DirectionSamples>, Failure> {
    let Some(bytes) = bytes else { return Ok(None) };
    let read = parse_directions(&[("field.npz", bytes)], &grainpath::run::config::directions(settings));
    let wrong = |source| grainpath::Error::Directions { path: FIELD.to_owned(), source };
    Ok(Some(read.map_err(wrong)?))
}

/// Inputs that replace files: a mesh, an array, sections, photographs, directions (the bytes of a `.npz`), stress.
pub(crate) type Handover<'py> = (
    Option<Bound<'py, MeshData>>,
    Option<Array<'py>>,
    Option<Bound<'py, StackData>>,
    Option<Vec<Bound<'py, ImageData>>>,
    Option<Vec<u8>>,
    Option<PointStress<'py>>,
);
/// The number of threads, the function that receives progress, and the token that cancels the work.
pub(crate) type Watch<'py> = (Option<usize>, Option<Bound<'py, PyAny>>, Option<Bound<'py, PyAny>>);

/// A job and the inputs that were handed over with it, without any Python object.
pub(crate) struct Work {
    /// The settings.
    pub settings: Settings,
    /// The job's name in errors.
    pub name: String,
    /// The folder to which paths are relative.
    pub folder: PathBuf,
    mesh: Option<MeshFile>,
    array: Option<VolumeInfo>,
    layers: Option<Arc<LayerStack>>,
    photos: Option<Vec<Photo>>,
    directions: Option<Vec<u8>>,
    stress: Option<FeResult>,
}

impl Work {
    /// The job, and the caller that waits for it.
    pub(crate) fn new<'py>(
        spec: &Bound<'py, Spec>,
        handover: Handover<'py>,
        watch: Watch<'py>,
    ) -> PyResult<(Self, Caller<'py>)> {
        let (mesh, array, layers, photos, directions, stress) = handover;
        let (array, slices) = match array {
            Some((size, sample, spacing_mm, slices, n_missing)) => {
                (Some(info_with(&(size, sample, spacing_mm), n_missing)), Some(slices))
            }
            None => (None, None),
        };
        let (threads, progress, cancel) = watch;
        let spec = spec.get();
        let work = Self {
            settings: spec.settings.clone(),
            name: spec.name.clone(),
            folder: spec.folder.clone(),
            mesh: mesh.map(|m| m.get().file.clone()),
            array,
            layers: layers.map(|l| Arc::clone(&l.get().stack)),
            photos: photos.map(|all| all.iter().map(|p| p.get().photo.clone()).collect()),
            directions,
            stress: stress_result(stress)?,
        };
        Ok((work, Caller { progress, cancel, array: slices, threads }))
    }

    /// The inputs that were handed over, in the planner's types. The planner asks for slices through `requests`.
    pub(crate) fn given(&mut self, requests: Sender<Request>) -> Result<Given, Failure> {
        let scan = |info: VolumeInfo| Handed::Scan(Box::new(Slabs::in_order(info, usize::MAX, requests)));
        let layers = self.layers.take().map(|stack| Handed::Layers(Arc::unwrap_or_clone(stack)));
        Ok(Given {
            shape: self.mesh.take().map(Handed::Mesh).or(layers).or_else(|| self.array.take().map(scan)),
            directions: field(self.directions.as_deref(), &self.settings)?,
            stress: self.stress.take().map(StressField::new),
            photos: self.photos.take(),
            known: None,
        })
    }

    /// The path of the shape's file. If the shape was handed over, the name that errors use for it.
    fn shape_path(&self, given: &Given) -> Result<PathBuf, Failure> {
        match given.shape {
            Some(_) => Ok(PathBuf::from(ARRAY)),
            None => grainpath_cli::shape_of(&self.settings, &self.folder)
                .ok_or_else(|| grainpath_cli::no_shape(&self.name)),
        }
    }
}

/// Plans a job.
#[pyfunction]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    handover: Handover<'py>,
    watch: Watch<'py>,
) -> PyResult<PlanData> {
    let (mut work, caller) = Work::new(spec, handover, watch)?;
    let kept = worker::run(py, &caller, move |diagnostics, requests| {
        let given = work.given(requests)?;
        let path = work.shape_path(&given)?;
        let Work { settings, folder, .. } = work;
        let (planned, read_s) = grainpath_cli::plan_given(&settings, given, &path, &folder, diagnostics)?;
        let warnings = diagnostics.warnings();
        Ok(Kept { settings, planned, read_s, warnings, program: Mutex::new(None) })
    })?;
    Ok(PlanData { plan: Arc::new(kept), threads: caller.threads })
}

/// The layers of a scan whose parts were joined.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct ScanData {
    /// The layers, and the values that were measured on the scan.
    pub cut: CtStack,
    /// Warnings of joining.
    pub warnings: Vec<Warning>,
}

#[pymethods]
impl ScanData {
    /// The layers.
    fn stack(&self) -> StackData {
        StackData { stack: Arc::new(self.cut.stack.clone()) }
    }
}

/// Plans the layers of a scan whose parts were joined. `filled` holds the bytes of windows that together make up all
/// layers, in order; `None` if the layers were not filled before. A shape in `handover` is not used.
#[pyfunction]
pub(crate) fn plan_parted<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    scan: &Bound<'py, ScanData>,
    filled: Option<Vec<Vec<u8>>>,
    handover: Handover<'py>,
    watch: Watch<'py>,
) -> PyResult<PlanData> {
    let (mut work, caller) = Work::new(spec, handover, watch)?;
    let (cut, warnings) = (scan.get().cut.clone(), scan.get().warnings.clone());
    let kept = worker::run(py, &caller, move |diagnostics, requests| {
        let given = work.given(requests)?;
        let Work { settings, folder, .. } = work;
        warnings.into_iter().for_each(|w| diagnostics.push(w));
        let read = |bytes: Vec<u8>| paths_from_bytes(&bytes).map_err(|e| Failure::input(e.to_string()));
        let filled = match filled {
            Some(windows) => {
                let windows = windows.into_iter().map(read).collect::<Result<Vec<_>, _>>()?;
                Some(windows.into_iter().flatten().collect())
            }
            None => None,
        };
        let (planned, read_s) =
            grainpath_cli::plan_parted(&settings, cut, filled, given, ARRAY, &folder, diagnostics)?;
        let warnings = diagnostics.warnings();
        Ok(Kept { settings, planned, read_s, warnings, program: Mutex::new(None) })
    })?;
    Ok(PlanData { plan: Arc::new(kept), threads: caller.threads })
}

/// Runs a part of a job. Returns what `find` found, under its name, and the warnings, as JSON.
fn reported<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    handover: Handover<'py>,
    watch: Watch<'py>,
    find: impl FnOnce(&Work, Given, &Path, &Diagnostics) -> Result<(&'static str, Value), Failure>
    + Send
    + 'static,
) -> PyResult<String> {
    let (mut work, caller) = Work::new(spec, handover, watch)?;
    worker::run(py, &caller, move |diagnostics, requests| {
        let given = work.given(requests)?;
        let path = work.shape_path(&given)?;
        let (name, found) = find(&work, given, &path, diagnostics)?;
        Ok(serde_json::json!({ name: found, "warnings": diagnostics.warnings() }).to_string())
    })
}

/// The stable poses of a job's part, the best first. Returns them and the warnings as `grainpath orient --json` prints
/// them.
#[pyfunction]
pub(crate) fn orient<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    handover: Handover<'py>,
    watch: Watch<'py>,
) -> PyResult<String> {
    reported(py, spec, handover, watch, |work, given, path, diagnostics| {
        // Scans and sections, which have no surface to stand on, are refused by the call with the command's sentence.
        let poses = grainpath_cli::poses_json(&work.settings, given, path, &work.folder, diagnostics)?;
        Ok(("poses", poses.into()))
    })
}

/// Solves the loads of a job without planning it. Returns the nodes that each load selected and the stress, as
/// `grainpath run --check --json` prints them.
#[pyfunction]
pub(crate) fn check<'py>(
    py: Python<'py>,
    spec: &Bound<'py, Spec>,
    handover: Handover<'py>,
    watch: Watch<'py>,
) -> PyResult<String> {
    reported(py, spec, handover, watch, |work, given, path, diagnostics| {
        let guide = grainpath_cli::checked(&work.settings, given, path, &work.folder, diagnostics)?;
        Ok(("stress", serde_json::json!(StressReport::from(&guide))))
    })
}
