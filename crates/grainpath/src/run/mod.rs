//! Plans a job: from a shape and settings to ordered paths.
//!
//! A run is a sequence of stages. Each stage takes values and returns new ones: place and repair
//! the mesh, slice it, compute the guide, plan supports, then lay walls, skins and infill, and
//! order the paths. The stages from sections to ordered paths are public functions that process a
//! window of layers ([`Steps`]). [`plan_job`], [`plan_photo`], [`plan_scan`] and [`plan_layers`] call
//! them with the whole part as one window. If the first layers are wanted early
//! ([`Progress::wants_layers`](grainpath_core::diagnostics::Progress::wants_layers)), infill and order run in windows that
//! grow, and give the same layers. [`config`] makes the settings of each stage from the job.

pub mod config;
mod mass;
mod placing;
mod short_fill;
mod skin_holds;
mod infill;
mod steps;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use grainpath_core::diagnostics::{EarlyLayers, Stage};
use grainpath_core::slices::SliceSource;
use grainpath_core::{Diagnostics, Layer, LayerPlan, LayerStack, Plan, Role, TriMesh, Warning, WarningId};
use grainpath_gcode::{WriteConfig, check_fits, write_gcode};
use grainpath_imaging::photo::Photo;
use grainpath_imaging::scan::{CtReport, CtStack, ScanError, slice_scan};
use grainpath_io::MeshFile;
use grainpath_io::directions::{DensitySamples, DirectionSamples};
use grainpath_io::fe::{DeckConditions, StressField};

use crate::error::Error;
use crate::guide::given_field::FieldGuide;
use crate::guide::graded_density::{GradedDensity, stress_share};
use crate::guide::grain::{GrainGuide, read_grain, read_scan};
use crate::guide::{self, Guide, GuidedPart, KnownStress, StressSettings};
pub use crate::measure::Planned;
use crate::measure::alignment::warn_if_far;
use crate::measure::laid_density::{AskedDensity, LaidDensity};
use crate::measure::strength::TestSetup;
use crate::measure::{on_air, separate_lines};
use crate::order::{Island, LayerPaths, order_stack};
use crate::region::{self, RegionAreas, RegionPart};
use crate::shape::{ShapeError, loft};
use crate::support;
use grainpath_job::choices::{GuideKind, Pattern, SupportStyle};
use grainpath_job::{Settings, WallCount};
pub use placing::{PlaceSettings, Placed, Sliced, mesh_and_layers, placed_mesh};
use placing::{check_bed, outside_bed, part_bounds, plate_from_part};
pub use steps::{
    ExtrudedMass, FilledLayers, InfillSettings, LayerWalls, RasterAngles, RegionSettings, StepSettings, Steps,
};

/// The inputs of a job whose shape is a mesh, already read.
pub struct Inputs {
    /// The shape.
    pub mesh: MeshFile,
    /// Name of the mesh file, for error messages.
    pub path: String,
    /// Stress solved by another program, for `guide.import`.
    pub stress: Option<StressField>,
    /// Supports and loads of `guide.deck`.
    pub deck: Option<DeckConditions>,
    /// The user's own directions, for `guide.kind = "field"`.
    pub directions: Option<DirectionSamples>,
    /// The densities of a file, for `fill.density.by = "file"`.
    pub densities: Option<DensitySamples>,
    /// Photographs whose grain the infill follows, for `guide.kind = "grain"`.
    pub photos: Vec<Photo>,
    /// The scan whose texture the infill follows, for `guide.volume`.
    pub texture: Option<Box<dyn SliceSource>>,
    /// The meshes of regions, by the index of the region.
    pub regions: BTreeMap<usize, MeshFile>,
    /// Stress that an earlier run solved. It is used again if nothing that it depends on has changed.
    pub known: Option<Arc<KnownStress>>,
}

/// Plans a job whose shape is a mesh.
///
/// ```
/// use grainpath::{Inputs, plan_job};
/// # let (settings, diagnostics) = (grainpath::Settings::default(), grainpath_core::Diagnostics::default());
/// // A box of 20 x 10 x 2 mm.
/// let inputs = Inputs {
///     mesh: grainpath_parts::file_of_a_box(),
///     path: "box.stl".into(),
///     stress: None,
///     deck: None,
///     directions: None,
///     densities: None,
///     photos: Vec::new(),
///     texture: None,
///     regions: Default::default(),
///     known: None,
/// };
/// let planned = plan_job(&settings, inputs, &diagnostics).unwrap();
/// assert_eq!(planned.plan.layers.len(), 10);
/// assert!((planned.plan.layers[9].z_top_mm - 2.0).abs() < 1e-9);
/// // The part stands in the middle of the bed; the paths keep the coordinates of the mesh.
/// assert!(planned.plan.plate_from_part_mm.x > 0.0);
/// ```
///
/// # Errors
/// [`Error`] for a mesh that cannot be sliced, a part that does not fit the bed, a mass that cannot be reached, and if the
/// run was cancelled.
pub fn plan_job(
    settings: &Settings,
    mut inputs: Inputs,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let mut clock = Clock::start(diagnostics);
    let with_modifiers = (!inputs.mesh.modifiers.is_empty())
        .then(|| region::with_modifiers(settings, &mut inputs.mesh, &mut inputs.regions, diagnostics));
    let settings = with_modifiers.as_ref().unwrap_or(settings);
    let shape_error = |source| Error::Shape { path: inputs.path.clone(), source };
    let sliced =
        mesh_and_layers(&config::placing(settings), inputs.mesh, diagnostics).map_err(shape_error)?;
    clock.stop(Stage::Slice);
    let scan: Option<&mut dyn SliceSource> = match &mut inputs.texture {
        Some(other) => Some(&mut **other),
        None => None,
    };
    let source = GuideSource {
        stress: inputs.stress,
        deck: inputs.deck,
        directions: inputs.directions,
        densities: inputs.densities,
        photos: &inputs.photos,
        scan,
        regions: inputs.regions,
        filled: None,
        known: inputs.known,
    };
    plan_stack(settings, sliced, source, clock, diagnostics)
}

/// Solves the loads of a job whose shape is a mesh, without computing directions and paths. The result has
/// the areas of fixtures and loads, the reactions and the stress.
///
/// ```
/// use grainpath::run::check_loads;
/// # use grainpath::Inputs;
/// # let diagnostics = grainpath_core::Diagnostics::default();
/// // A box of 20 x 10 x 2 mm, held at its left end and pulled to the right with 100 N.
/// let job = r#"
///     [[guide.fixture]]
///     on = { plane = { point_mm = [0, 0, 0], normal = [1, 0, 0] } }
///     fix = "xyz"
///     [[guide.load]]
///     on = { plane = { point_mm = [20, 0, 0], normal = [1, 0, 0] } }
///     force_n = [100, 0, 0]
/// "#;
/// let settings = grainpath_job::parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
/// # let inputs = Inputs {
/// #     mesh: grainpath_parts::file_of_a_box(),
/// #     path: "box.stl".into(),
/// #     stress: None,
/// #     deck: None,
/// #     directions: None,
/// #     densities: None,
/// #     photos: Vec::new(),
/// #     texture: None,
/// #     regions: Default::default(),
/// #     known: None,
/// # };
/// let solved = check_loads(&settings, inputs, &diagnostics).unwrap().summary;
/// let held_n = solved.balance[0].reactions[0].force_n;
/// assert!((held_n.x + 100.0).abs() < 0.01, "the fixture holds the part: {held_n}");
/// // 100 N on 10 x 2 mm are 5 MPa, and more at the corners that are held.
/// assert!(solved.max_von_mises_mpa > 5.0);
/// ```
///
/// # Errors
/// As [`plan_job`], and for a job without loads.
pub fn check_loads(settings: &Settings, inputs: Inputs, diagnostics: &Diagnostics) -> Result<Guide, Error> {
    settings.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
    // The loads of a job may serve only its strength test; they are solved here in any case.
    let mut settings = settings.clone();
    settings.guide.kind = GuideKind::Stress;
    let Inputs { mesh, path, stress, deck, known, .. } = inputs;
    let sliced = mesh_and_layers(&config::placing(&settings), mesh, diagnostics)
        .map_err(|source| Error::Shape { path, source })?;
    let Sliced { stack, mesh, lowered_mm, .. } = sliced;
    let standing = config::standing(&settings, lowered_mm);
    warn_of_deck(deck.as_ref(), diagnostics);
    let loads = config::loads(&settings, deck.as_ref());
    let conditions = guide::boundary_conditions(&loads, &mesh, &standing)?;
    let slicing = config::slicing(&settings);
    let part = GuidedPart { mesh: &mesh, stack: &stack, standing, slicing, known: known.as_deref() };
    let wanted = config::stress(&settings, deck.as_ref()).expect("the kind is stress");
    Ok(guide::solved_only(&wanted, &part, &conditions, stress, diagnostics)?)
}

/// Plans a job whose shape is the board of its photographs; `directions` are those of `guide.field`.
///
/// ```
/// use grainpath::plan_photo;
/// use grainpath_core::Diagnostics;
/// use grainpath_imaging::{photo::Photo, raster::Grey};
/// // A picture of 60 x 40 pixels shows a board of 30 x 20 mm.
/// let job = "[shape.photo]\nfiles = [\"board.png\"]\nsize_mm = [30, 20]\nthickness_mm = 1\n";
/// let settings = grainpath_job::parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
/// let photos = [Photo::new("board.png".into(), Grey::filled(60, 40, 0.5))];
/// let planned = plan_photo(&settings, &photos, None, &Diagnostics::default()).unwrap();
/// assert_eq!(planned.stack.layers().len(), 5);
/// assert!((planned.stack.layers()[0].region().area_mm2() - 600.0).abs() < 0.1);
/// ```
///
/// # Errors
/// As [`plan_job`].
pub fn plan_photo(
    settings: &Settings,
    photos: &[Photo],
    directions: Option<DirectionSamples>,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let mut clock = Clock::start(diagnostics);
    let board = config::photo_board(settings);
    let shape_error = |source| Error::Shape {
        path: photos.first().map_or_else(|| "shape.photo".into(), |p| p.name.clone()),
        source,
    };
    let stack = board.slice(&config::slicing(settings), diagnostics).map_err(shape_error)?;
    let mesh = surface_if_wanted(settings, &stack, diagnostics).map_err(shape_error)?;
    clock.stop(Stage::Slice);
    let sliced = Sliced { stack, mesh, ..Sliced::default() };
    let source = GuideSource { directions, photos, ..GuideSource::default() };
    plan_stack(settings, sliced, source, clock, diagnostics)
}

/// Plans a job whose shape is a scan; only a few slices are in memory at a time. `path` is the scan's
/// name in errors. `stress` was solved by another program, in the coordinates of the scan with its
/// lowest point on the plate. `texture` is the scan of `guide.volume`, and `directions` are those of
/// `guide.field`.
///
/// ```
/// use grainpath::plan_scan;
/// use grainpath_core::{Diagnostics, slices::SampleType};
/// use grainpath_io::volume::{Files, RawHeader, open_volume};
/// // A scan of a block of 16 x 8 x 4 mm. Its voxels measure 0.5 mm; they are 200 in the block and 0 in the air.
/// let mut voxels = vec![0_u8; 40 * 24 * 12];
/// for (x, y, z) in (4..36).flat_map(|x| (4..20).flat_map(move |y| (2..10).map(move |z| (x, y, z)))) {
///     voxels[(z * 24 + y) * 40 + x] = 200;
/// }
/// let files = Files::single("block.raw", move |_| Ok(Box::new(std::io::Cursor::new(voxels.clone()))));
/// let header = RawHeader { size: [40, 24, 12], sample: SampleType::U8, big_endian: false, offset_bytes: 0 };
/// let mut scan = open_volume(files, Some(&header)).unwrap();
///
/// let job = "[shape.ct]\npath = \"block.raw\"\npixel_mm = 0.5\nslice_mm = 0.5\n";
/// let settings = grainpath_job::parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
/// let diagnostics = Diagnostics::default();
/// let planned = plan_scan(&settings, &mut *scan, "block.raw", None, None, &[], None, &diagnostics).unwrap();
/// assert_eq!(planned.plan.layers.len(), 20);
/// assert!((planned.stack.layers()[10].region().area_mm2() - 16.0 * 8.0).abs() < 1.0);
/// ```
///
/// # Errors
/// As [`plan_job`], and for files that cannot be read and scans that give no layers.
pub fn plan_scan(
    settings: &Settings,
    source: &mut dyn SliceSource,
    path: &str,
    stress: Option<StressField>,
    directions: Option<DirectionSamples>,
    photos: &[Photo],
    mut texture: Option<Box<dyn SliceSource>>,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let clock = Clock::start(diagnostics);
    let scan = slice_scan(source, &config::scan(settings), diagnostics).map_err(|e| scan_error(e, path))?;
    let texture: &mut dyn SliceSource = match &mut texture {
        Some(other) => &mut **other,
        None => source,
    };
    let source = GuideSource { stress, directions, photos, scan: Some(texture), ..GuideSource::default() };
    plan_cut(settings, scan, path, source, clock, diagnostics)
}

/// Plans the layers of a scan that was sliced in parts. `filled` holds the paths of all layers from [`fill_window`], if
/// they were computed before. Other arguments are those of [`plan_scan`].
///
/// ```
/// use grainpath::plan_parted_scan;
/// use grainpath::run::{config, fill_window};
/// use grainpath_imaging::scan::slice_scan;
/// # use grainpath_core::{Diagnostics, slices::SampleType};
/// # use grainpath_io::volume::{Files, RawHeader, open_volume};
/// # let mut voxels = vec![0_u8; 40 * 24 * 12];
/// # for (x, y, z) in (4..36).flat_map(|x| (4..20).flat_map(move |y| (2..10).map(move |z| (x, y, z)))) {
/// #     voxels[(z * 24 + y) * 40 + x] = 200;
/// # }
/// # let files = Files::single("block.raw", move |_| Ok(Box::new(std::io::Cursor::new(voxels.clone()))));
/// # let header = RawHeader { size: [40, 24, 12], sample: SampleType::U8, big_endian: false, offset_bytes: 0 };
/// # let mut source = open_volume(files, Some(&header)).unwrap();
/// # let job = "[shape.ct]\npath = \"block.raw\"\npixel_mm = 0.5\nslice_mm = 0.5\n";
/// # let settings = grainpath_job::parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
/// # let diagnostics = Diagnostics::default();
/// // A scan of a block that gives 20 layers.
/// let scan = slice_scan(&mut *source, &config::scan(&settings), &diagnostics).unwrap();
/// // Each half of the layers could be filled by a machine of its own.
/// let steps = config::steps(&settings);
/// let mut filled = fill_window(&steps, &scan.stack, 0..10, &diagnostics).unwrap();
/// filled.extend(fill_window(&steps, &scan.stack, 10..20, &diagnostics).unwrap());
/// let plan = |filled| {
///     let scan = scan.clone();
///     plan_parted_scan(&settings, scan, filled, "block.raw", None, None, &[], &diagnostics).unwrap().plan
/// };
/// // The plan is that of a scan that is filled as a whole.
/// assert!(plan(Some(filled)) == plan(None));
/// ```
///
/// # Errors
/// As [`plan_scan`], and if `filled` has another number of layers than the scan.
pub fn plan_parted_scan(
    settings: &Settings,
    scan: CtStack,
    filled: Option<Vec<LayerPaths>>,
    path: &str,
    stress: Option<StressField>,
    directions: Option<DirectionSamples>,
    photos: &[Photo],
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let clock = Clock::start(diagnostics);
    let source = GuideSource { stress, directions, photos, filled, ..GuideSource::default() };
    plan_cut(settings, scan, path, source, clock, diagnostics)
}

/// Whether windows of layers can be filled independently once all sections are known. This needs a job in which only the
/// printing order depends on the paths of other layers, and no guide or support is computed for the whole part.
///
/// ```
/// use grainpath::run::fills_in_windows;
/// let mut settings = grainpath::Settings::default();
/// assert!(fills_in_windows(&settings));
/// // One density for the whole part is found from its mass.
/// settings.fill.mass_g = Some(12.0);
/// assert!(!fills_in_windows(&settings));
/// ```
pub fn fills_in_windows(settings: &Settings) -> bool {
    let steps = config::steps(settings);
    matches!(settings.guide.kind, GuideKind::None | GuideKind::Angle)
        && settings.support.style == SupportStyle::None
        && settings.regions.is_empty()
        && !settings.fibre.enabled
        && steps.infill.mass_g.is_none()
        && !steps.infill.graded
        // Sparse lines along a field go on from layer to layer.
        && !steps.infill.lines_go_on(steps.infill.density)
        // The continuous pattern gives one warning for the whole part if it cannot lay an island as one path.
        && steps.infill.pattern != Pattern::Continuous
}

/// Lays the walls, skins and infill of a window of layers, for jobs for which [`fills_in_windows`] is true.
///
/// ```
/// use grainpath::run::{config, fill_window};
/// # let stack = grainpath_parts::layers_of_a_box(12);
/// # let (settings, diagnostics) = (grainpath::Settings::default(), grainpath_core::Diagnostics::default());
/// // Layers 4 to 6 of twelve, not yet in printing order.
/// let window = fill_window(&config::steps(&settings), &stack, 4..7, &diagnostics).unwrap();
/// assert_eq!(window.len(), 3);
/// let island = &window[0].islands[0];
/// assert!(island.walls.len() == 2 && !island.fills.is_empty());
/// ```
///
/// # Errors
/// [`Error`] if the run was cancelled.
pub fn fill_window(
    step_settings: &StepSettings,
    stack: &LayerStack,
    window: Range<usize>,
    diagnostics: &Diagnostics,
) -> Result<Vec<LayerPaths>, Error> {
    let steps = Steps::new(step_settings, stack);
    let mut walls = steps.walls(window.clone(), diagnostics)?;
    let skins = steps.skins(window.clone(), &mut walls, diagnostics)?;
    let density = step_settings.infill.density;
    Ok(steps.infill(window, walls, skins, density, diagnostics)?.layers)
}

fn plan_cut(
    settings: &Settings,
    scan: CtStack,
    path: &str,
    source: GuideSource<'_>,
    mut clock: Clock<'_>,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let shape_error = |source| Error::Shape { path: path.to_owned(), source };
    let mesh = surface_if_wanted(settings, &scan.stack, diagnostics).map_err(shape_error)?;
    clock.stop(Stage::Slice);
    let sliced = Sliced { stack: scan.stack, mesh, scan: Some(scan.report), ..Sliced::default() };
    plan_stack(settings, sliced, source, clock, diagnostics)
}

/// Plans a job whose shape is a stack of sections with their own heights, in the position in which it is printed. `path`
/// is the stack's name in errors. Other arguments are those of [`plan_scan`].
///
/// ```
/// use grainpath::plan_layers;
/// # let stack = grainpath_parts::layers_of_a_box(12);
/// # let (settings, diagnostics) = (grainpath::Settings::default(), grainpath_core::Diagnostics::default());
/// // `stack` has twelve layers of 20 x 10 mm.
/// let planned = plan_layers(&settings, stack, "box", None, None, &[], None, &diagnostics).unwrap();
/// assert_eq!(planned.plan.layers.len(), 12);
/// let printed_mm: f64 = planned.plan.layers[5].paths.iter().map(|p| p.path.length_mm()).sum();
/// assert!(printed_mm > 2.0 * 55.0, "two walls and infill: {printed_mm} mm");
/// ```
///
/// # Errors
/// As [`plan_job`], and for a stack without area.
pub fn plan_layers(
    settings: &Settings,
    stack: LayerStack,
    path: &str,
    stress: Option<StressField>,
    directions: Option<DirectionSamples>,
    photos: &[Photo],
    mut texture: Option<Box<dyn SliceSource>>,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let mut clock = Clock::start(diagnostics);
    let shape_error = |source| Error::Shape { path: path.to_owned(), source };
    if stack.layers().iter().all(|l| l.region().is_empty()) {
        return Err(shape_error(ShapeError::NothingLeft));
    }
    let mesh = surface_if_wanted(settings, &stack, diagnostics).map_err(shape_error)?;
    clock.stop(Stage::Slice);
    let sliced = Sliced { stack, mesh, ..Sliced::default() };
    let scan: Option<&mut dyn SliceSource> = match &mut texture {
        Some(other) => Some(&mut **other),
        None => None,
    };
    let source = GuideSource { stress, directions, photos, scan, ..GuideSource::default() };
    plan_stack(settings, sliced, source, clock, diagnostics)
}

/// The surface of a stack if a stress analysis, supports or the strength test need it; otherwise an empty mesh, because
/// making a surface takes longer than making the sections.
fn surface_if_wanted(
    settings: &Settings,
    stack: &LayerStack,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, ShapeError> {
    let is_wanted = settings.guide.kind == GuideKind::Stress
        || settings.support.style != SupportStyle::None
        || settings.strength.enabled;
    if !is_wanted {
        return Ok(TriMesh::default());
    }
    Ok(loft(stack, settings.output.surface_cell_mm, diagnostics)?)
}

/// Inputs for guides and regions: stress solved by another program, the user's own directions, and, for a guide
/// by grain, photographs or otherwise a scan.
#[derive(Default)]
struct GuideSource<'a> {
    stress: Option<StressField>,
    deck: Option<DeckConditions>,
    directions: Option<DirectionSamples>,
    densities: Option<DensitySamples>,
    photos: &'a [Photo],
    scan: Option<&'a mut dyn SliceSource>,
    regions: BTreeMap<usize, MeshFile>,
    /// The paths of all layers, if they were computed before.
    filled: Option<Vec<LayerPaths>>,
    known: Option<Arc<KnownStress>>,
}

/// The grain that infill follows; `None` for other guides. `own` is the report of the scan that is
/// the shape.
fn grain(
    settings: &Settings,
    stack: &LayerStack,
    own: Option<&CtReport>,
    source: (&[Photo], Option<&mut dyn SliceSource>),
    diagnostics: &Diagnostics,
) -> Result<Option<GrainGuide>, Error> {
    if settings.guide.kind != GuideKind::Grain {
        return Ok(None);
    }
    let layers = stack.layers();
    let top = layers.last().map_or(0.0, Layer::z_top_mm);
    let part = part_bounds(stack);
    let (photos, scan) = source;
    if let (true, Some(scan)) = (photos.is_empty(), scan) {
        let wanted = config::texture(settings, own, part, top);
        let read = read_scan(scan, &wanted, diagnostics);
        return read.map(Some).map_err(|e| scan_error(e, &wanted.name));
    }
    let grain = config::grain(settings, photos.len(), part, top);
    let section = |z_mm: f64| {
        // A height on the border of two layers belongs to the lower one.
        let above = layers.partition_point(|l| l.z_top_mm() < z_mm).min(layers.len().saturating_sub(1));
        layers.get(above).map(|l| l.region().clone()).unwrap_or_default()
    };
    let read = read_grain(photos, &grain, &section, diagnostics);
    read.map(Some).map_err(|(k, source)| Error::Grain { path: photos[k].name.clone(), source })
}

fn scan_error(e: ScanError, path: &str) -> Error {
    match e {
        ScanError::Slices(e) => Error::Slices(e),
        source => Error::Scan { path: path.to_owned(), source },
    }
}

/// Passes on the warnings about everything in a deck that is not used.
fn warn_of_deck(deck: Option<&DeckConditions>, diagnostics: &Diagnostics) {
    deck.iter().flat_map(|deck| &deck.warnings).for_each(|w| diagnostics.push(w.clone()));
}

fn plan_stack(
    settings: &Settings,
    sliced: Sliced,
    source: GuideSource<'_>,
    mut clock: Clock<'_>,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    // Warnings about the job come first, so that they are shown even if the run fails later.
    settings.warnings.iter().for_each(|w| diagnostics.push(w.clone()));
    let Sliced { stack, mesh, lowered_mm, painted, assumed_unit, scan } = sliced;
    let part = part_bounds(&stack);
    let config = config::writing(settings);
    let plate_from_part_mm = plate_from_part(&config.machine, settings.shape.position_mm, part);
    // Checked before any costly stage.
    let step_settings = config::steps(settings);
    check_bed(&config.machine, &stack, part, plate_from_part_mm, &step_settings.adhesion)?;
    let fibre = config::fibre(settings, stack.layers().len(), plate_from_part_mm);
    fibre.iter().try_for_each(|f| f.check(&stack, part))?;
    let standing = config::standing(settings, lowered_mm);
    let placing = config::placing(settings);
    // Regions are computed before any costly stage, because a region outside the part is an error.
    let areas = if settings.regions.is_empty() {
        None
    } else {
        // The files of regions are taken to be in the unit that was assumed for the part.
        let unit_mm = assumed_unit.unwrap_or(placing.placement.unit).mm();
        let slicing = placing.slicing;
        let unit_of_file = placing.unit_of_file;
        let part = RegionPart { stack: &stack, mesh: &mesh, standing, unit_mm, unit_of_file, slicing };
        Some(RegionAreas::new(settings, &source.regions, &part, diagnostics)?)
    };
    // Fixtures and loads are resolved once, so that the guide and the strength test use the same
    // places.
    let deck = source.deck;
    warn_of_deck(deck.as_ref(), diagnostics);
    let loads = config::loads(settings, deck.as_ref());
    let conditions = guide::boundary_conditions(&loads, &mesh, &standing)?;
    // The strength test runs on the finished program. Its setup keeps the data that it needs from the mesh.
    let test_setup = || TestSetup::new(&config::strength(settings), &mesh, &stack, conditions.clone());
    let test = settings.strength.enabled.then(test_setup).transpose()?;
    let (slicing, known) = (config::slicing(settings), source.known.as_deref());
    let guided = GuidedPart { mesh: &mesh, stack: &stack, standing, slicing, known };
    let stress_settings = config::stress(settings, deck.as_ref());
    config::warn_of_mix(settings, deck.as_ref(), diagnostics);
    let build = |s: &StressSettings| guide::build(s, &guided, &conditions, source.stress, diagnostics);
    let guide = stress_settings.as_ref().map(build).transpose()?;
    // The reserve of plates, and of parts whose beads do not share the load evenly, needs fixtures and loads as a test does.
    // Where a test cannot have them, the reserve of a dense part comes from the stress, and that of others is missing.
    let is_uneven = config::loads_beads_unevenly(settings);
    let on_cells = guide.as_ref().filter(|guide| is_uneven || guide.is_plate).and_then(|guide| {
        let setup = test.clone().map_or_else(test_setup, Ok);
        match setup {
            // Bearing loads, torque and imported stress are none of a test's loads.
            Err(_) if !is_uneven => None,
            setup if guide.is_plate => Some(setup),
            setup => Some(setup.map(TestSetup::into_solid)),
        }
    });
    let grain = grain(settings, &stack, scan.as_ref(), (source.photos, source.scan), diagnostics)?;
    let place = config::field(settings, lowered_mm, plate_from_part_mm);
    let lay = |samples| FieldGuide::new(samples, &place, &stack, diagnostics);
    let field = source.directions.map(lay).transpose();
    let field = field.map_err(|source| Error::Field { path: settings.field.path.clone(), source })?;
    if guide.is_some() || grain.is_some() || field.is_some() {
        clock.stop(Stage::Guide);
    }
    let graded = config::graded_density(settings, lowered_mm, plate_from_part_mm)
        .map(|s| GradedDensity::new(&s, &stack, guide.as_ref(), source.densities, diagnostics))
        .transpose()?;
    let share = |guide: &Guide| stress_share(&stack, guide, config::nominal_card(settings).as_ref());
    let graded_walls = matches!(settings.process.walls, WallCount::ByStress { .. });
    let stress_share = guide.as_ref().filter(|_| graded_walls).map(share).transpose()?;
    let support = match config::support(settings, Some(plate_from_part_mm.truncate()), painted) {
        Some(wanted) => Some(support::plan(&mesh, &stack, &wanted, diagnostics)?),
        None => {
            support::warn_of_mid_air(&stack, diagnostics);
            None
        }
    };
    let drawn = !settings.output.report.is_empty() || !settings.output.preview.is_empty();
    if support.is_some() {
        clock.stop(Stage::Support);
    }
    // The mesh is among the largest objects and is kept only where a picture shows the supports on
    // it.
    let supported_mesh = (support.is_some() && drawn).then_some(mesh);
    let order = config::order(settings);
    let steps = Steps::new(&step_settings, &stack)
        .with_support(support.as_ref())
        .with_guide(guide.as_ref(), grain.as_ref())
        .with_field(field.as_ref())
        .with_density(graded.as_ref())
        .with_stress_share(stress_share.as_ref())
        .with_fibre(fibre.as_ref())
        .with_regions(areas.as_ref());
    let mut laid = None;
    let n_layers = stack.layers().len();
    let mut plan = Plan { layers: Vec::new(), plate_from_part_mm };
    let (filled, density) = match source.filled {
        Some(layers) if layers.len() != stack.layers().len() => {
            return Err(Error::FilledElsewhere { n: layers.len(), n_layers: stack.layers().len() });
        }
        Some(layers) => {
            if step_settings.stagger_walls {
                warn_of_level_walls(layers.iter().flat_map(|l| &l.islands), diagnostics);
            }
            (FilledLayers { layers, ..FilledLayers::default() }, step_settings.infill.density)
        }
        None => {
            let all = 0..n_layers;
            // Early layers are left out where the writer needs the fibre of the whole plan, and where a graded density is
            // measured on paths that have no order yet.
            let is_early = diagnostics.wants_layers() && fibre.is_none() && graded.is_none();
            // Walls, skins and infill count each layer once, and so does the order where it is found here.
            diagnostics.begin(Stage::Fill, if is_early { 4 } else { 3 } * n_layers);
            let mut walls = steps.walls(all.clone(), diagnostics)?;
            let skins = steps.skins(all.clone(), &mut walls, diagnostics)?;
            let density = steps.density(&walls, &skins, diagnostics)?;
            let sparse_areas = graded.as_ref().map(|_| steps.sparse_areas(&skins));
            if step_settings.stagger_walls {
                warn_of_level_walls(walls.iter().flat_map(|l| &l.islands), diagnostics);
            }
            let filled = if is_early {
                let each = |window: Vec<LayerPlan>| {
                    plan.layers.extend(window);
                    // Beyond half of the part, writing the layers once more would cost more time than it saves.
                    if plan.layers.len() <= n_layers / 2 {
                        pass_on(&plan, &config, diagnostics);
                    }
                };
                steps.in_growing_windows(walls, skins, density, &order, diagnostics, each)?;
                FilledLayers::default()
            } else {
                steps.infill(all, walls, skins, density, diagnostics)?
            };
            laid = graded.as_ref().zip(sparse_areas).map(|(graded, mut sparse)| {
                filled.sparse_areas.iter().for_each(|(i, area)| sparse[*i] = area.clone());
                let asked = AskedDensity {
                    map: &graded.of_mean(density.fraction()),
                    range: graded.range(),
                    by: graded.by(),
                    fall_mm: graded.fall_mm(),
                    areas: &sparse,
                    beside_others: areas.is_some(),
                };
                LaidDensity::measure(&asked, &stack, &filled.layers)
            });
            (filled, density)
        }
    };
    laid.iter().filter_map(LaidDensity::warning).for_each(|warning| diagnostics.push(warning));
    if let Some(fibre) = &fibre {
        let islands = filled.layers.iter().flat_map(|l| &l.islands);
        let any = islands.flat_map(|i| &i.fills).any(|p| p.role == Role::Fibre);
        fibre.report_outcome(&filled.fibre, any, diagnostics)?;
    }
    steps.report_notes(diagnostics);
    clock.stop(Stage::Fill);
    // Layers that were wanted early are in order already; their time counts as that of the infill.
    if plan.layers.is_empty() {
        plan.layers = order_stack(&stack, filled.layers, &order, diagnostics)?;
    }
    clock.stop(Stage::Order);
    // Gyroids and honeycombs are not checked, because their lines support each other over several layers.
    if !matches!(step_settings.infill.pattern, Pattern::Gyroid | Pattern::Honeycomb) {
        separate_lines::check(&plan.layers).into_iter().for_each(|warning| diagnostics.push(warning));
    }
    // Lines of the other patterns lie alike in all layers, or cross those below.
    if step_settings.infill.pattern.follows_field() || graded.is_some() {
        on_air::check(&plan.layers).into_iter().for_each(|warning| diagnostics.push(warning));
    }
    // Skirt, brim and supports reach beyond the part, so the finished plan is checked again.
    check_fits(&plan, &config.machine).map_err(|e| outside_bed(e, &stack, part))?;
    let stages_s = clock.stages;
    let planned = Planned {
        plan,
        stack,
        config,
        stages_s,
        support,
        supported_mesh,
        density,
        laid,
        grain,
        field,
        guide,
        test,
        on_cells,
        scan,
    };
    planned.empty_warning().into_iter().for_each(|warning| diagnostics.push(warning));
    let density_by = graded.as_ref().map(GradedDensity::by);
    warn_if_far(&planned, settings.fill.pattern, density_by, diagnostics);
    Ok(planned)
}

/// Passes on the first layers of a plan. Where they cannot be written, nothing is passed on: writing the whole plan gives
/// the same error.
fn pass_on(plan: &Plan, config: &WriteConfig, diagnostics: &Diagnostics) {
    let mut gcode = Vec::new();
    if write_gcode(plan, config, &[], &mut gcode).is_ok() {
        let (low, high) = config.machine.bed_bounds_mm();
        let filament_mm = config.machine.filament_mm;
        diagnostics.layers(&EarlyLayers { gcode: &gcode, filament_mm, bed_mm: [low, high] });
    }
}

/// Warns if no wall is raised in a job that staggers its walls.
fn warn_of_level_walls<'a>(mut islands: impl Iterator<Item = &'a Island>, diagnostics: &Diagnostics) {
    if !islands.any(|i| i.walls.iter().any(|w| w.path.raise.top_mm > 0.0)) {
        let text =
            "process.stagger_walls: no wall was raised, because no inner wall continues from layer to layer";
        diagnostics.push(Warning::new(WarningId::WallsLevel, text));
    }
}

/// Measures the time of each stage, in seconds.
struct Clock<'a> {
    diagnostics: &'a Diagnostics,
    since_s: f64,
    stages: Vec<(Stage, f64)>,
}

impl<'a> Clock<'a> {
    fn start(diagnostics: &'a Diagnostics) -> Self {
        Self { diagnostics, since_s: diagnostics.now_s(), stages: Vec::new() }
    }

    fn stop(&mut self, stage: Stage) {
        let now_s = self.diagnostics.now_s();
        self.stages.push((stage, now_s - self.since_s));
        self.since_s = now_s;
    }
}
