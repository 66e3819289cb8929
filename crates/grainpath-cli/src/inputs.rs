//! Inputs of commands: job files with their settings, and the files that jobs name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::{fs, io};

use grainpath::Planned;
use grainpath::guide::KnownStress;
use grainpath::order::LayerPaths;
use grainpath_core::diagnostics::Stage;
use grainpath_core::slices::SliceSource;
use grainpath_core::{Diagnostics, LayerStack};
use grainpath_gcode::{Limits, Program, simulate};
use grainpath_imaging::photo::Photo;
use grainpath_imaging::scan::CtStack;
use grainpath_io::directions::{
    DensitySamples, DirectionOptions, DirectionSamples, parse_densities, parse_directions,
};
use grainpath_io::fe::{DeckConditions, FeError, StressField, parse_fe};
use grainpath_io::image::decode_luma;
use grainpath_io::volume::{Files, RawHeader, ReadSeek, open_volume};
use grainpath_io::{MeshFile, parse_outline};
use grainpath_job::choices::GuideKind;
use grainpath_job::regions::RegionPlace;
use grainpath_job::{Settings, parse_job};

use crate::claims::Claims;
use crate::{Failure, cad, files};

/// Parses the text of a job and the overrides of its settings.
pub(crate) fn settings(text: &str, name: &str, sets: &[String], folder: &Path) -> Result<Settings, Failure> {
    let load = |path: &str| files::read_text(&folder.join(path)).map_err(|f| f.message);
    Ok(parse_job(text, name, sets, &load).map_err(grainpath::Error::from)?)
}

/// The settings of a job, the file of its shape, and the folder to which its paths are relative.
pub(crate) fn read_job(job: &Path, sets: &[String]) -> Result<(Settings, PathBuf, PathBuf), Failure> {
    let (settings, folder) = read_settings(job, sets)?;
    let shape = shape_of(&settings, &folder).ok_or_else(|| no_shape(&job.display().to_string()))?;
    Ok((settings, shape, folder))
}

/// Endings of files that hold a shape; users sometimes pass such a file instead of a job.
const MODELS: [&str; 20] = [
    "stl", "obj", "ply", "off", "3mf", "step", "stp", "iges", "igs", "svg", "dxf", "png", "jpg", "jpeg",
    "bmp", "tif", "tiff", "nrrd", "nii", "dcm",
];

/// The settings of a job, and the folder to which its paths are relative. The job need not have a shape.
pub(crate) fn read_settings(job: &Path, sets: &[String]) -> Result<(Settings, PathBuf), Failure> {
    let ending = job.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    if MODELS.contains(&ending.as_str()) && job.is_file() {
        let name = job.display();
        return Err(Failure::usage(format!(
            "{name}: this is a model, not a job; `grainpath slice {name}` plans it with default settings, or name it in [shape] of a job"
        )));
    }
    let text = files::read_text(job)?;
    let folder = job.parent().map(Path::to_owned).unwrap_or_default();
    let settings = settings(&text, &job.display().to_string(), sets, &folder)?;
    Ok((settings, folder))
}

/// The file of a job's shape; `None` if the job names no shape.
pub fn shape_of(settings: &Settings, folder: &Path) -> Option<PathBuf> {
    let shape = &settings.shape;
    let given =
        [&shape.mesh, &shape.outline, &settings.ct.path].into_iter().chain(settings.photo.files.first());
    given.into_iter().find(|p| !p.is_empty()).map(|p| folder.join(p))
}

/// The error for a job that names no shape.
pub fn no_shape(name: &str) -> Failure {
    Failure::usage(format!(
        "{name}: [shape] needs mesh = \"FILE\", outline = \"FILE\", ct = \"SCAN\" or photo = {{ files = [\"FILE\"], ... }}"
    ))
}

/// A shape that the caller passes in memory, so that its file is not read.
pub enum Handed {
    /// A mesh.
    Mesh(MeshFile),
    /// A scan, slice by slice.
    Scan(Box<dyn SliceSource>),
    /// Layers in the position in which they are printed.
    Layers(LayerStack),
}

/// Inputs that the caller passes in memory; the others are read from the files that the job names.
#[derive(Default)]
pub struct Given {
    /// The shape.
    pub shape: Option<Handed>,
    /// The directions of `guide.field`.
    pub directions: Option<DirectionSamples>,
    /// The stress of `guide.import`.
    pub stress: Option<StressField>,
    /// The photographs of `guide.image`; if it names none, those of `shape.photo`.
    pub photos: Option<Vec<Photo>>,
    /// Stress solved in earlier runs.
    pub known: Option<Arc<KnownStress>>,
}

/// Adds all files that a job reads, except the job itself.
pub(crate) fn claim_inputs(settings: &Settings, shape: &Path, base: &Path, claims: &mut Claims) {
    claims.read("of [shape]", shape);
    let photos = settings.photo.files.iter().map(|f| ("of shape.photo.files", f));
    let images = settings.image.files.iter().map(|f| ("of guide.image.files", f));
    let others = [
        ("of shape.ct.truth", &settings.ct.truth),
        ("of guide.import", &settings.guide.import),
        ("of guide.deck", &settings.guide.deck),
        ("of guide.volume", &settings.volume.path),
        ("of guide.field", &settings.field.path),
    ];
    for (what, file) in photos.chain(images).chain(others).filter(|(_, f)| !f.is_empty()) {
        claims.read(what, &base.join(file));
    }
    if let Some((file, _)) = settings.fill.density.file() {
        claims.read("of fill.density", &base.join(file));
    }
    for region in &settings.regions {
        if let RegionPlace::Mesh(file) = &region.on {
            claims.read("of a region", &base.join(file));
        }
    }
}

/// All files that decide a job's plan, except the job itself and the profiles that it names: those of the settings, and
/// those that the header of a scan names in turn. For a folder of slices or a Zarr it is the folder. Files that are
/// missing are listed too.
pub fn input_files(settings: &Settings, base: &Path) -> Vec<PathBuf> {
    let mut claims = Claims::default();
    let shape = shape_of(settings, base);
    claim_inputs(settings, shape.as_deref().unwrap_or(Path::new("")), base, &mut claims);
    let mut all = claims.paths().0.to_vec();
    let raw = grainpath::run::config::raw_header(settings);
    let scans = [(&settings.ct.path, raw.as_ref()), (&settings.volume.path, None)];
    for (path, raw) in scans.into_iter().filter(|(path, _)| !path.is_empty()) {
        let opened = Arc::new(Mutex::new(Vec::new()));
        let note = Arc::clone(&opened);
        let open = move |name: &str| {
            note.lock().unwrap_or_else(PoisonError::into_inner).push(PathBuf::from(name));
            open_file(name)
        };
        // A scan that cannot be opened is an error of the plan, not of this list: what was opened before it still counts.
        let _ = opened_scan(&base.join(path), raw, settings.ct.outside_folder, open);
        all.append(&mut opened.lock().unwrap_or_else(PoisonError::into_inner));
    }
    all.sort();
    all.dedup();
    all
}

/// Reads a job's inputs and plans it. Returns the plan and the time for reading, in seconds.
pub(crate) fn plan(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<(Planned, f64), Failure> {
    plan_given(settings, Given::default(), shape, base, diagnostics)
}

/// Reads the inputs of a job that are not `given`, and plans it. If the shape is given, `shape` is only its name in
/// error messages. Returns the plan and the time for reading, in seconds.
///
/// # Errors
/// Errors of reading and planning.
pub fn plan_given(
    settings: &Settings,
    given: Given,
    shape: &Path,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<(Planned, f64), Failure> {
    let path = shape.display().to_string();
    let start = std::time::Instant::now();
    let photos = photos_of(settings, given.photos, base, diagnostics)?;
    let directions = directions_of(settings, given.directions, base)?;
    let photos_s = start.elapsed().as_secs_f64();
    // With `shape.photo`, the shape comes from the photographs, so no mesh is read.
    if given.shape.is_none() && !settings.photo.files.is_empty() {
        return Ok((grainpath::plan_photo(settings, &photos, directions, diagnostics)?, photos_s));
    }
    // A scan is read slice by slice while it is planned, so only opening it counts as reading.
    let open = || {
        let raw = grainpath::run::config::raw_header(settings);
        open_scan(shape, raw.as_ref(), settings.ct.outside_folder)
    };
    let read = match given.shape {
        Some(handed) => handed,
        None if settings.ct.path.is_empty() => Handed::Mesh(read_body(settings, shape, diagnostics)?.0),
        None => Handed::Scan(open()?),
    };
    let stress = stress_of(settings, given.stress, base)?;
    let texture = read_texture(settings, base)?;
    let read_s = start.elapsed().as_secs_f64();
    let planned = match read {
        Handed::Mesh(mesh) => {
            let regions = read_regions(settings, base)?;
            let densities = read_densities(settings, base)?;
            let deck = read_deck(settings, base)?;
            let inputs = grainpath::Inputs {
                mesh,
                path,
                stress,
                deck,
                directions,
                densities,
                photos,
                texture,
                regions,
                known: given.known,
            };
            grainpath::plan_job(settings, inputs, diagnostics)?
        }
        Handed::Layers(stack) => {
            grainpath::plan_layers(settings, stack, &path, stress, directions, &photos, texture, diagnostics)?
        }
        Handed::Scan(mut scan) => grainpath::plan_scan(
            settings,
            &mut *scan,
            &path,
            stress,
            directions,
            &photos,
            texture,
            diagnostics,
        )?,
    };
    Ok((planned, read_s))
}

/// Reads the guide of a job whose scan was sliced in parts, and plans it; see [`grainpath::plan_parted_scan`]. `name` is
/// the scan's name in error messages. Returns the plan and the time for reading, in seconds.
///
/// # Errors
/// Errors of reading and planning; also if the infill follows the texture of the scan, since its voxels are not available.
pub fn plan_parted(
    settings: &Settings,
    scan: CtStack,
    filled: Option<Vec<LayerPaths>>,
    given: Given,
    name: &str,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<(Planned, f64), Failure> {
    let start = std::time::Instant::now();
    let photos = photos_of(settings, given.photos, base, diagnostics)?;
    if settings.guide.kind == GuideKind::Grain && photos.is_empty() {
        return Err(Failure::usage(
            "guide.kind = \"grain\": the texture cannot be read from a scan in parts; plan the scan as a whole, or name photographs",
        ));
    }
    let directions = directions_of(settings, given.directions, base)?;
    let stress = stress_of(settings, given.stress, base)?;
    let read_s = start.elapsed().as_secs_f64();
    let planned =
        grainpath::plan_parted_scan(settings, scan, filled, name, stress, directions, &photos, diagnostics)?;
    Ok((planned, read_s))
}

fn photos_of(
    settings: &Settings,
    given: Option<Vec<Photo>>,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<Vec<Photo>, Failure> {
    match given {
        // As with files, photographs are ignored unless the infill follows their grain.
        Some(_) if settings.guide.kind != GuideKind::Grain => Ok(Vec::new()),
        Some(handed) => Ok(handed),
        None => read_photos(settings, base, diagnostics),
    }
}

fn directions_of(
    settings: &Settings,
    given: Option<DirectionSamples>,
    base: &Path,
) -> Result<Option<DirectionSamples>, Failure> {
    if given.is_some() { Ok(given) } else { read_directions(settings, base) }
}

fn stress_of(
    settings: &Settings,
    given: Option<StressField>,
    base: &Path,
) -> Result<Option<StressField>, Failure> {
    if given.is_some() { Ok(given) } else { read_stress(settings, base) }
}

/// Sets the number of threads of the pool, if one is given.
pub(crate) fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    let Some(n) = threads else { return Ok(()) };
    // The thread pool would take zero for all cores, which is the default without the option anyway. A
    // number above 1024 is taken for a mistake.
    if n == 0 || n > 1024 {
        return Err(Failure::usage(format!("--threads {n} should be from 1 to 1024")));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build_global();
    pool.map_err(|e| Failure::usage(format!("--threads {n}: {e}")))
}

/// Reads the mesh of a job, or extrudes its outline if the job has one. Returns the bodies and the time
/// in seconds.
pub fn read_body(
    settings: &Settings,
    path: &Path,
    diagnostics: &Diagnostics,
) -> Result<(MeshFile, f64), Failure> {
    let start = std::time::Instant::now();
    diagnostics.begin(Stage::Read, 0);
    let shown = path.display().to_string();
    let file = if settings.shape.outline.is_empty() {
        cad::mesh_file(path, &shown, diagnostics)?
    } else {
        let bytes = files::read(path)?;
        let outline = parse_outline(&bytes, &grainpath::run::config::outline(settings))
            .map_err(|source| grainpath::Error::Outline { path: shown.clone(), source })?;
        grainpath::shape::extruded(outline, grainpath::run::config::outline_thickness_mm(settings))
            .map_err(|source| grainpath::Error::Shape { path: shown, source })?
    };
    Ok((file, start.elapsed().as_secs_f64()))
}

/// Reads the meshes of the job's regions; the key is the index of the region.
pub(crate) fn read_regions(settings: &Settings, base: &Path) -> Result<BTreeMap<usize, MeshFile>, Failure> {
    let mut all = BTreeMap::new();
    for (k, region) in settings.regions.iter().enumerate() {
        if let RegionPlace::Mesh(file) = &region.on {
            let path = base.join(file);
            let shown = path.display().to_string();
            all.insert(k, cad::mesh_file(&path, &shown, &Diagnostics::default())?);
        }
    }
    Ok(all)
}

/// Reads the photographs whose grain the infill follows; empty if the job has none.
pub(crate) fn read_photos(
    settings: &Settings,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<Vec<Photo>, Failure> {
    let photos = settings.grain_photos();
    if !photos.is_empty() {
        diagnostics.begin(Stage::Read, 0);
    }
    let read = |file: &String| {
        let path = base.join(file);
        let bytes = files::read(&path)?;
        let name = path.display().to_string();
        let image =
            decode_luma(&bytes).map_err(|source| grainpath::Error::Image { path: name.clone(), source })?;
        Ok(Photo::from_image(name, image))
    };
    photos.iter().map(read).collect()
}

/// Opens the scan of `guide.volume` if its texture guides the infill.
pub(crate) fn read_texture(
    settings: &Settings,
    base: &Path,
) -> Result<Option<Box<dyn SliceSource>>, Failure> {
    let path = &settings.volume.path;
    if settings.guide.kind != GuideKind::Grain || path.is_empty() {
        return Ok(None);
    }
    open_scan(&base.join(path), None, settings.ct.outside_folder).map(Some)
}

/// Reads the directions of `guide.field`: from a file, or from the matrices in a folder that `vector_slicer` wrote.
pub(crate) fn read_directions(settings: &Settings, base: &Path) -> Result<Option<DirectionSamples>, Failure> {
    if settings.guide.kind != GuideKind::Field {
        return Ok(None);
    }
    let path = base.join(&settings.field.path);
    directions(&path, &grainpath::run::config::directions(settings)).map(Some)
}

/// Reads the file of densities that `fill.density` names.
pub(crate) fn read_densities(settings: &Settings, base: &Path) -> Result<Option<DensitySamples>, Failure> {
    let Some((file, array)) = settings.fill.density.file() else { return Ok(None) };
    let path = base.join(file);
    let (bytes, path) = (files::read(&path)?, path.display().to_string());
    let read = parse_densities(&bytes, &path, array);
    Ok(Some(read.map_err(|source| grainpath::Error::Densities { path, source })?))
}

/// Reads directions from a file, or from the matrices in a folder that `vector_slicer` wrote.
pub(crate) fn directions(path: &Path, options: &DirectionOptions) -> Result<DirectionSamples, Failure> {
    let mut all = Vec::new();
    if path.is_dir() {
        for name in ["thetaField.csv", "theta_field.csv", "xField.csv", "yField.csv", "shape.csv"] {
            let file = path.join(name);
            if file.is_file() {
                all.push((file.display().to_string(), files::read(&file)?));
            }
        }
    } else {
        all.push((path.display().to_string(), files::read(path)?));
    }
    let borrowed: Vec<(&str, &[u8])> = all.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
    let read = parse_directions(&borrowed, options);
    Ok(read.map_err(|source| grainpath::Error::Directions { path: path.display().to_string(), source })?)
}

/// Reads the stress from the result file of `guide.import`.
pub(crate) fn read_stress(settings: &Settings, base: &Path) -> Result<Option<StressField>, Failure> {
    if settings.guide.import.is_empty() {
        return Ok(None);
    }
    let path = base.join(&settings.guide.import);
    let wrong = |e: FeError| Failure::of_file(&path, e);
    let bytes = files::read(&path)?;
    let file = parse_fe(&bytes, path.to_str()).map_err(wrong)?;
    let result = file.result(&grainpath::run::config::import(settings)).map_err(wrong)?;
    Ok(Some(StressField::new(result)))
}

/// Reads the supports and loads from the solver deck of `guide.deck`.
pub(crate) fn read_deck(settings: &Settings, base: &Path) -> Result<Option<DeckConditions>, Failure> {
    if settings.guide.deck.is_empty() {
        return Ok(None);
    }
    let path = base.join(&settings.guide.deck);
    let wrong = |e: FeError| Failure::of_file(&path, e);
    let bytes = files::read(&path)?;
    let file = parse_fe(&bytes, path.to_str()).map_err(wrong)?;
    grainpath::run::config::deck(settings, &file).map(Some).map_err(wrong)
}

/// Opens a file of a scan. Only regular files are opened: reading a named pipe could wait forever, and
/// a device has no end.
fn open_file(name: &str) -> io::Result<Box<dyn ReadSeek>> {
    if !fs::metadata(name)?.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "is not a regular file; scans are read only from regular files",
        ));
    }
    Ok(Box::new(fs::File::open(name)?))
}

/// Whether the file `other`, once links are followed, lies neither in the folder of the header `name` nor below. A file
/// that is not there lies nowhere; opening it tells.
fn leads_outside(name: &str, other: &str) -> bool {
    let folder = Path::new(name).parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (fs::canonicalize(folder), fs::canonicalize(other)) {
        (Ok(folder), Ok(other)) => !other.starts_with(folder),
        _ => false,
    }
}

/// Opens a scan: the files of a folder are its slices. With `outside_folder` a header may name a file in
/// another folder.
pub(crate) fn open_scan(
    path: &Path,
    raw: Option<&RawHeader>,
    outside_folder: bool,
) -> Result<Box<dyn SliceSource>, Failure> {
    opened_scan(path, raw, outside_folder, open_file)
}

/// As [`open_scan`]; `open` opens each file.
fn opened_scan(
    path: &Path,
    raw: Option<&RawHeader>,
    outside_folder: bool,
    open: impl Fn(&str) -> io::Result<Box<dyn ReadSeek>> + Send + Sync + 'static,
) -> Result<Box<dyn SliceSource>, Failure> {
    let shown = path.display().to_string();
    let wrong = |e: io::Error| Failure::of_file(path, files::plain(&e));
    let as_text = |path: &Path| {
        let no_text =
            || Failure::of_file(path, "the name of a file of a scan should be UTF-8 text; rename the file");
        path.to_str().map(str::to_owned).ok_or_else(no_text)
    };
    let all = if fs::metadata(path).map_err(wrong)?.is_dir() {
        let mut names = Vec::new();
        for entry in fs::read_dir(path).map_err(wrong)? {
            let entry = entry.map_err(wrong)?;
            if entry.path().is_file() {
                names.push(as_text(&entry.path())?);
            }
        }
        Files::folder(shown.clone(), names, open)
    } else {
        Files::single(as_text(path)?, open).staying_within(leads_outside)
    };
    open_volume(all.allowing_outside(outside_folder), raw).map_err(|e| grainpath::Error::from(e).into())
}

/// Filament diameter for G-code that does not state one, mm. Source: the nominal diameter of the common
/// filament. With the other size, 2.85 mm, all volumes would be 2.7 times as large.
pub(crate) const FILAMENT_MM: f64 = 1.75;

/// Reads a G-code file and simulates it.
pub(crate) fn read_program(path: &Path) -> Result<Program, Failure> {
    let bytes = files::read(path)?;
    simulate(&bytes, FILAMENT_MM, &Limits::default()).map_err(|e| Failure::of_file(path, e))
}
