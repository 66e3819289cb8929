//! The main job: from a shape and settings to a plan.
//!
//! A pipeline of stages, each taking values and giving new ones: place and mend, slice, walls, skins, fill, order.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::Instant;

use grainpath_core::diagnostics::{Interrupted, Stage};
use grainpath_core::math::direction;
use grainpath_core::units::{LengthUnit, bead_spacing_mm};
use grainpath_core::{
    BeadWidth, Bounds2, DVec2, DVec3, Diagnostics, DirectionField, Layer, LayerStack, Plan, Polygon, Region,
    Role, SpeedClass, Toolpath, TriMesh, UniformField,
};
use grainpath_gcode::{WriteConfig, check_fits};
use grainpath_io::fe::StressField;
use grainpath_io::volume::SliceSource;
use grainpath_io::{Marks, MeshFile};
use rayon::prelude::*;

use crate::adhesion::{AdhesionSettings, brim, skirt};
use crate::config;
use crate::error::Error;
use crate::fibre::{FibreSettings, Tally};
use crate::fill::{Continuous, FillContext, GUIDED, Infill, Note, Solid, Stripes, bridge_angle_rad, pattern};
use crate::grain::guide::Mode;
use crate::grain::lay::{Flow, lay_curves};
use crate::grain::{GrainGuide, Photo, read_grain, read_scan};
use crate::guide::{self, Guide, GuidedPart};
use crate::job::Settings;
use crate::mask::Mask;
use crate::order::{Island, LayerPaths, order_stack};
use crate::shape;
use crate::skin::{IslandPolygon, SkinInput, SkinSettings, SkinSplit, split_stack};
use crate::strength::TestSetup;
use crate::support::beads::BeadSettings;
use crate::support::{self, Support, SupportSettings};
use crate::walls::{WallSettings, lay_walls};

/// A planned job.
pub struct Planned {
    /// What is printed.
    pub plan: Plan,
    /// The sections it was made from.
    pub stack: LayerStack,
    /// How it is written.
    pub config: WriteConfig,
    /// Seconds of each stage so far.
    pub stages_s: Vec<(Stage, f64)>,
    /// The supports, where asked for.
    pub support: Option<Support>,
    /// Pictures of how they came about.
    pub support_pictures: Vec<support::picture::StepPicture>,
    /// The density of the inside: the one asked for, or the one found for a mass.
    pub density: f64,
    /// The grain it follows, where it does.
    pub grain: Option<GrainGuide>,
    /// Directions and the stress they come from, for jobs that have loads.
    pub guide: Option<Guide>,
    /// What a strength test needs to know of the part, for jobs that want one.
    pub test: Option<TestSetup>,
    /// What was found in a scan, where the shape is one.
    pub scan: Option<shape::ct::CtReport>,
}

/// Shorter closed walls are small, mm.
const SMALL_WALL_MM: f64 = 30.0;
/// Walls with more than this share of their length over air are overhangs.
const OVERHANG_SHARE: f64 = 0.25;

/// What a job is made from, read already.
pub struct Inputs {
    /// The shape.
    pub mesh: MeshFile,
    /// What errors call it.
    pub path: String,
    /// Stress solved elsewhere, for `guide.import`.
    pub stress: Option<StressField>,
    /// Photographs whose grain the part is filled with, for `guide.kind = "grain"`.
    pub photos: Vec<Photo>,
    /// The scan whose texture it is filled along, for `guide.volume`.
    pub texture: Option<Box<dyn SliceSource>>,
}

/// Plans a job whose shape is a mesh.
///
/// # Errors
/// [`Error`] for a mesh that cannot be sliced, a part that does not fit the bed, a mass that cannot be met, and when
/// a stop was asked for.
pub fn plan_job(
    settings: &Settings,
    mut inputs: Inputs,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let mut clock = Clock { since: Instant::now(), stages: Vec::new() };
    let shape_error = |source| Error::Shape { path: inputs.path.clone(), source };
    let sliced = mesh_and_layers(settings, inputs.mesh, diagnostics).map_err(shape_error)?;
    clock.stop(Stage::Slice);
    let scan: Option<&mut dyn SliceSource> = match &mut inputs.texture {
        Some(other) => Some(&mut **other),
        None => None,
    };
    let grain = GrainSource { photos: &inputs.photos, scan };
    plan_stack(settings, sliced, inputs.stress, grain, clock, diagnostics)
}

/// Plans a job whose shape is the board of its photographs.
///
/// # Errors
/// As [`plan_job`].
pub fn plan_photo(
    settings: &Settings,
    photos: &[Photo],
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let mut clock = Clock { since: Instant::now(), stages: Vec::new() };
    let board = config::photo_board(settings);
    let shape_error = |source| Error::Shape {
        path: photos.first().map_or_else(|| "shape.photo".into(), |p| p.name.clone()),
        source,
    };
    let stack = board.slice(&config::slicing(settings)).map_err(shape_error)?;
    let mesh = if wants_surface(settings) {
        shape::surface(&stack, settings.output.surface_cell_mm, diagnostics).map_err(shape_error)?
    } else {
        TriMesh::default()
    };
    clock.stop(Stage::Slice);
    let sliced = Sliced { stack, mesh, ..Sliced::default() };
    plan_stack(settings, sliced, None, GrainSource { photos, scan: None }, clock, diagnostics)
}

/// Only solvers and supports ask for a surface.
fn wants_surface(settings: &Settings) -> bool {
    settings.guide.kind == "stress" || settings.support.style != "none" || settings.strength.enabled
}

/// What the grain of a part is read from, where it follows any: photographs, else a scan.
struct GrainSource<'a> {
    photos: &'a [Photo],
    scan: Option<&'a mut dyn SliceSource>,
}

/// The grain the job asks for; `own` is what was found in the scan that is the shape.
fn grain(
    settings: &Settings,
    stack: &LayerStack,
    own: Option<&shape::ct::CtReport>,
    source: GrainSource<'_>,
    diagnostics: &Diagnostics,
) -> Result<Option<GrainGuide>, Error> {
    if settings.guide.kind != "grain" {
        return Ok(None);
    }
    let layers = stack.layers();
    let top = layers.last().map_or(0.0, Layer::z_top_mm);
    let part = part_bounds(stack);
    let GrainSource { photos, scan } = source;
    if let (true, Some(scan)) = (photos.is_empty(), scan) {
        let wanted = config::texture(settings, own, part, top);
        let read = read_scan(scan, &wanted, diagnostics);
        return read.map(Some).map_err(|e| scan_error(e, &wanted.name));
    }
    let grain = config::grain(settings, photos.len(), part, top);
    let section = |z_mm: f64| {
        let above = layers.partition_point(|l| l.z_top_mm() < z_mm).min(layers.len().saturating_sub(1));
        layers.get(above).map(|l| l.region().clone()).unwrap_or_default()
    };
    let read = read_grain(photos, &grain, &section, diagnostics);
    read.map(Some).map_err(|(k, source)| Error::Grain { path: photos[k].name.clone(), source })
}

fn scan_error(e: shape::ct::CtError, path: &str) -> Error {
    match e {
        shape::ct::CtError::Volume(e) => Error::Volume(e),
        shape::ct::CtError::Shape(source) => Error::Shape { path: path.to_owned(), source },
    }
}

/// Plans a job whose shape is a scan, of which a few slices are held at a time. `path` is what errors call it;
/// `stress` was solved elsewhere, in the scan's own place with its lowest point on the plate; `texture` is the scan of
/// `guide.volume`.
///
/// # Errors
/// As [`plan_job`], and for files that cannot be read and scans that give no layers.
pub fn plan_scan(
    settings: &Settings,
    source: &mut dyn SliceSource,
    path: &str,
    stress: Option<StressField>,
    photos: &[Photo],
    mut texture: Option<Box<dyn SliceSource>>,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let mut clock = Clock { since: Instant::now(), stages: Vec::new() };
    let shape_error = |source| Error::Shape { path: path.to_owned(), source };
    let scan = shape::ct::slice_scan(source, &config::scan(settings), diagnostics)
        .map_err(|e| scan_error(e, path))?;
    let mesh = if wants_surface(settings) {
        shape::surface(&scan.stack, settings.output.surface_cell_mm, diagnostics).map_err(shape_error)?
    } else {
        TriMesh::default()
    };
    clock.stop(Stage::Slice);
    let sliced = Sliced { stack: scan.stack, mesh, scan: Some(scan.report), ..Sliced::default() };
    let texture: &mut dyn SliceSource = match &mut texture {
        Some(other) => &mut **other,
        None => source,
    };
    let grain = GrainSource { photos, scan: Some(texture) };
    plan_stack(settings, sliced, stress, grain, clock, diagnostics)
}

/// A shape as layers, wherever they come from.
/// A shape in layers, on the plate.
#[derive(Debug, Default)]
pub struct Sliced {
    /// Its sections.
    pub stack: LayerStack,
    /// Its surface; empty where nothing asked for one.
    pub mesh: TriMesh,
    /// How far it was lowered to stand on the plate, mm.
    pub lowered_mm: f64,
    /// What is painted on its surface.
    pub marks: Marks,
    scan: Option<shape::ct::CtReport>,
}

fn plan_stack(
    settings: &Settings,
    sliced: Sliced,
    stress: Option<StressField>,
    grain_source: GrainSource<'_>,
    mut clock: Clock,
    diagnostics: &Diagnostics,
) -> Result<Planned, Error> {
    let Sliced { stack, mesh, lowered_mm, marks, scan } = sliced;
    let part = part_bounds(&stack);
    let plate_from_part_mm = plate_from_part(settings, part);
    check_bed(settings, &stack, part, plate_from_part_mm)?;
    let fibre = config::fibre(settings);
    fibre.iter().try_for_each(|f| f.check(&stack, part))?;
    let guide = {
        let guided = GuidedPart { mesh: &mesh, stack: &stack, lowered_mm };
        guide::build(settings, &guided, stress, diagnostics)?
    };
    let grain = grain(settings, &stack, scan.as_ref(), grain_source, diagnostics)?;
    let test = settings.strength.enabled.then(|| TestSetup::of(settings, &mesh, &stack)).transpose()?;
    if guide.is_some() || grain.is_some() {
        clock.stop(Stage::Guide);
    }
    let support = match config::support(settings, plate_from_part_mm.truncate()) {
        Some(wanted) => {
            let wanted = SupportSettings { marks, ..wanted };
            Some(support::plan(&mesh, &stack, &wanted, diagnostics)?)
        }
        None => None,
    };
    let drawn = !settings.output.report.is_empty() || !settings.output.preview.is_empty();
    let support_pictures = match &support {
        Some(found) if drawn => support::picture::pictures(&mesh, found),
        _ => Vec::new(),
    };
    if support.is_some() {
        clock.stop(Stage::Support);
    }
    drop(mesh);
    let uniform = UniformField { axis_rad: settings.guide.angle_deg.to_radians() };
    let job = Job {
        settings,
        stack: &stack,
        part,
        support: support.as_ref(),
        guide: guide.as_ref(),
        grain: grain.as_ref(),
        fibre: fibre.as_ref(),
        uniform,
        continuous: config::continuous(settings),
        notes: Mutex::default(),
    };
    diagnostics.begin(Stage::Fill, 2 * stack.layers().len());
    let (mut walls, fills): (Vec<_>, Vec<_>) = job.walls(diagnostics)?.into_iter().unzip();
    let skins = job.skins(&mut walls, &fills, diagnostics)?;
    drop(fills);
    let density = job.density(&walls, &skins)?;
    let layers = job.fill(walls, &skins, density, diagnostics)?;
    job.tell_notes(diagnostics);
    drop(skins);
    clock.stop(Stage::Fill);
    let layers = order_stack(&stack, layers, &config::order(settings), diagnostics)?;
    clock.stop(Stage::Order);
    let plan = Plan { layers, plate_from_part_mm };
    let config = config::writing(settings);
    check_fits(&plan, &config.machine)?;
    let stages_s = clock.stages;
    Ok(Planned {
        plan,
        stack,
        config,
        stages_s,
        support,
        support_pictures,
        density,
        grain,
        guide,
        test,
        scan,
    })
}

/// Fill, and the island each path lies in.
type IslandPaths = Vec<(usize, Toolpath)>;

/// The islands of a layer with their walls, and where its fill may lie.
type LayerWalls = (Vec<Island>, Vec<IslandPolygon>);

struct Clock {
    since: Instant,
    stages: Vec<(Stage, f64)>,
}

impl Clock {
    fn stop(&mut self, stage: Stage) {
        let now = Instant::now();
        self.stages.push((stage, now.duration_since(self.since).as_secs_f64()));
        self.since = now;
    }
}

/// A mesh where it is to be printed, mended, and its layers.
///
/// # Errors
/// As [`shape::mend`] and [`shape::slice`].
pub fn mesh_and_layers(
    settings: &Settings,
    file: MeshFile,
    diagnostics: &Diagnostics,
) -> Result<Sliced, shape::ShapeError> {
    let (mut bodies, mut lowered_mm) = place_bodies(settings, file, diagnostics)?;
    let block = bodies.pop().unwrap_or_default();
    let enforce = bodies.pop().unwrap_or_default();
    let mut marks = Marks { enforce, block };
    if settings.support.style != "none" {
        let lift = settings.support.lift_mm;
        let all = bodies.iter_mut().chain(marks.each_mut());
        all.flat_map(|b| &mut b.vertices).for_each(|p| p.z += lift);
        lowered_mm -= lift;
    }
    let mesh = shape::mend(bodies, config::repair(settings), diagnostics)?;
    let stack = shape::slice(&mesh, &config::slicing(settings), diagnostics)?;
    Ok(Sliced { stack, mesh, lowered_mm, marks, scan: None })
}

/// The bodies of a file in millimetres on the plate, last what is painted on them, held and left free; and how far they
/// were lowered to stand there.
fn place_bodies(
    settings: &Settings,
    file: MeshFile,
    diagnostics: &Diagnostics,
) -> Result<(Vec<TriMesh>, f64), shape::ShapeError> {
    file.warnings.iter().for_each(|w| diagnostics.warn(format!("mesh: {w}")));
    let mut marks = Marks::default();
    let mut bodies = Vec::with_capacity(file.bodies.len() + 2);
    for mut body in file.bodies {
        for (all, more) in marks.each_mut().into_iter().zip(body.marks.each_mut()) {
            let first = all.vertices.len() as u32;
            all.vertices.append(&mut more.vertices);
            all.triangles.extend(more.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        bodies.push(body.mesh);
    }
    bodies.extend([marks.enforce, marks.block]);
    let mut placement = config::placement(settings);
    let bounds = bodies.iter().filter_map(TriMesh::bounds);
    let all = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).ok_or(shape::ShapeError::Empty)?;
    if settings.shape.unit == "auto" {
        placement.unit = file.unit.unwrap_or(LengthUnit::Millimetre);
        let longest = (all.1 - all.0).max_element() * settings.shape.scale;
        let likely = shape::likely_unit(longest);
        if file.unit.is_none() && likely != LengthUnit::Millimetre {
            diagnostics.warn(format!(
                "the mesh is {longest:.3} long and its unit is taken for mm; if it is in {}, set shape.unit = \"{}\"",
                likely.name(),
                likely.name()
            ));
        }
    }
    let lowered_mm = shape::place(&mut bodies, &placement)?;
    Ok((bodies, lowered_mm))
}

fn part_bounds(stack: &LayerStack) -> Bounds2 {
    let all = stack.layers().iter().filter_map(|l| l.region().bounds());
    all.reduce(Bounds2::union).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO })
}

fn plate_from_part(settings: &Settings, part: Bounds2) -> DVec3 {
    let machine = config::machine(settings);
    let (low, high) = machine.bed_bounds_mm();
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let target = settings.shape.position_mm.unwrap_or(middle);
    let centre = part.centre();
    // Whole micrometres, so that moving the part does not change how its numbers round.
    let whole = |mm: f64| (mm * 1e3).round() * 1e-3;
    DVec3::new(whole(target[0] - centre.x), whole(target[1] - centre.y), 0.0)
}

/// Refuses a part that cannot fit before any time is spent on it.
fn check_bed(settings: &Settings, stack: &LayerStack, part: Bounds2, shift: DVec3) -> Result<(), Error> {
    let machine = config::machine(settings);
    let half = 1e-3;
    let (low, high) = machine.bed_bounds_mm();
    let reach = [
        (part.min.x + shift.x, 0),
        (part.max.x + shift.x, 0),
        (part.min.y + shift.y, 1),
        (part.max.y + shift.y, 1),
    ];
    for (at_mm, k) in reach {
        if at_mm < low[k] - half || at_mm > high[k] + half {
            let axis = ['X', 'Y'][k];
            return Err(grainpath_gcode::GcodeError::OutsideBed {
                axis,
                at_mm,
                low_mm: low[k],
                high_mm: high[k],
            }
            .into());
        }
    }
    let top = stack.layers().last().map_or(0.0, Layer::z_top_mm);
    if top > machine.bed_mm[2] + half {
        let high_mm = machine.bed_mm[2];
        return Err(
            grainpath_gcode::GcodeError::OutsideBed { axis: 'Z', at_mm: top, low_mm: 0.0, high_mm }.into()
        );
    }
    Ok(())
}

/// How a room is to be filled.
struct Wanted<'a> {
    density: f64,
    role: Role,
    pattern: Option<&'a dyn Infill>,
    grain: Option<&'a GrainGuide>,
}

struct Job<'a> {
    settings: &'a Settings,
    stack: &'a LayerStack,
    part: Bounds2,
    support: Option<&'a Support>,
    guide: Option<&'a Guide>,
    grain: Option<&'a GrainGuide>,
    /// How fibre is laid, where any is.
    fibre: Option<&'a FibreSettings>,
    /// The field of `kind = "angle"`.
    uniform: UniformField,
    continuous: Continuous,
    /// What kept islands from being one path, by layer and role.
    notes: Mutex<BTreeMap<(usize, Role), Vec<Note>>>,
}

impl Job<'_> {
    fn wall_settings(&self, layer: &Layer) -> WallSettings {
        let p = &self.settings.process;
        WallSettings {
            n_walls: p.walls,
            bead_width_mm: p.bead_width_mm,
            height_mm: layer.height_mm(),
            thin_walls: p.thin_walls,
            gap_fill: p.gap_fill,
            min_bead_width_mm: p.min_bead_width_mm,
            fill_overlap: self.settings.fill.overlap,
        }
    }

    /// The walls of every layer, and where its fill may lie.
    fn walls(&self, diagnostics: &Diagnostics) -> Result<Vec<LayerWalls>, Interrupted> {
        let of_layer = |layer: &Layer| {
            diagnostics.check()?;
            let settings = self.wall_settings(layer);
            let mut islands = Vec::with_capacity(layer.region().polygons.len());
            let mut fill = Vec::new();
            for (i, polygon) in layer.region().polygons.iter().enumerate() {
                let walls = lay_walls(polygon, &settings);
                fill.extend(walls.fill.polygons.into_iter().map(|p| (i, p)));
                islands.push(Island { walls: walls.loops, fills: walls.singles });
            }
            for wall in islands.iter_mut().flat_map(|i: &mut Island| &mut i.walls) {
                if wall.path.length_mm() < SMALL_WALL_MM {
                    wall.path.speed = SpeedClass::SmallWall;
                }
            }
            diagnostics.advance(1);
            Ok((islands, fill))
        };
        let all: Vec<Result<_, Interrupted>> =
            self.stack.layers().par_iter().with_min_len(2).map(of_layer).collect();
        all.into_iter().collect()
    }

    /// Divides the fill of every layer, and marks walls over air.
    fn skins(
        &self,
        walls: &mut [Vec<Island>],
        fills: &[Vec<IslandPolygon>],
        diagnostics: &Diagnostics,
    ) -> Result<Vec<SkinSplit>, Interrupted> {
        let input: Vec<SkinInput<'_>> = self
            .stack
            .layers()
            .iter()
            .zip(fills)
            .map(|(layer, fill)| SkinInput { section: layer.region(), fill })
            .collect();
        let p = &self.settings.process;
        let settings = SkinSettings {
            top_layers: p.top_layers,
            bottom_layers: p.bottom_layers,
            spacing_mm: bead_spacing_mm(p.bead_width_mm, p.layer_height_mm),
            dense: self.settings.fill.density >= 0.999 && self.settings.fill.mass_g.is_none(),
        };
        let walls: Vec<Mutex<&mut Vec<Island>>> = walls.iter_mut().map(Mutex::new).collect();
        // One path knows no skins: where all is dense it takes the whole room.
        let whole = self.settings.fill.pattern == "continuous" && settings.dense;
        split_stack(&input, self.part, &settings, diagnostics, |i, mut split| {
            if whole {
                split = SkinSplit { solid: fills[i].clone(), below: split.below, ..SkinSplit::default() };
            }
            if let Some(below) = split.below.take() {
                let mut islands = walls[i].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                islands
                    .iter_mut()
                    .flat_map(|i| &mut i.walls)
                    .for_each(|w| mark_overhang(&mut w.path, &below));
            }
            split
        })
    }

    /// Lays the fill of every layer.
    fn fill(
        &self,
        walls: Vec<Vec<Island>>,
        skins: &[SkinSplit],
        density: f64,
        diagnostics: &Diagnostics,
    ) -> Result<Vec<LayerPaths>, Error> {
        let adhesion = self.adhesion();
        let like = self.alike(skins);
        // What was noted while a density was sought is of no matter.
        self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clear();
        let lay = |i: usize| {
            diagnostics.check()?;
            let mut paths = Vec::new();
            let mut tally = Tally::default();
            if like[i] == i {
                let mut add = |island, path| paths.push((island, path));
                tally = self.dense_fill(i, &skins[i], &mut add);
                tally = tally.and(self.sparse_fill(i, &skins[i], density, &mut add));
            }
            diagnostics.advance(1);
            Ok((paths, tally))
        };
        let laid: Vec<Result<(IslandPaths, Tally), Interrupted>> = (0..walls.len())
            .into_par_iter()
            .with_min_len(if self.guide.is_some() { 1 } else { 2 })
            .map(lay)
            .collect();
        let (mut laid, tallies): (Vec<_>, Vec<_>) =
            laid.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        // Copies first: the layers they are copied from come later or are taken whole.
        for i in (0..laid.len()).rev().filter(|&i| like[i] != i) {
            laid[i] = laid[like[i]].clone();
        }
        if let Some(fibre) = self.fibre {
            let all = like.iter().map(|&i| tallies[i]).fold(Tally::default(), Tally::and);
            let any = laid.iter().flatten().any(|(_, p)| p.role == Role::Fibre);
            fibre.came_to(&all, any, diagnostics)?;
        }
        let mut supports: Vec<Vec<Island>> =
            (0..laid.len()).into_par_iter().map(|i| self.supports(i)).collect();
        let whole = |(i, (mut islands, paths)): (usize, (Vec<Island>, IslandPaths))| {
            paths.into_iter().for_each(|(island, path)| islands[island].fills.push(path));
            let adhesion = adhesion.get(i).cloned().unwrap_or_default();
            LayerPaths { adhesion, supports: std::mem::take(&mut supports[i]), islands }
        };
        Ok(walls.into_iter().zip(laid).enumerate().map(whole).collect())
    }

    /// For each layer the first one that has the same room and the same field, where the fill depends on nothing
    /// else.
    fn alike(&self, skins: &[SkinSplit]) -> Vec<usize> {
        let layers = self.stack.layers();
        let guided = self.grain.is_some() || GUIDED.contains(&self.settings.fill.pattern.as_str());
        let mut like: Vec<usize> = (0..skins.len()).collect();
        if !guided {
            return like;
        }
        for i in 1..skins.len() {
            let same = |&j: &usize| {
                (layers[i].height_mm() - layers[j].height_mm()).abs() < 1e-9
                    && skins[i].bridge.is_empty()
                    && skins[i] == skins[j]
                    && self.guide.is_none_or(|g| g.same(i, j))
                    && self.grain.is_none_or(GrainGuide::is_upright)
                    && self.fibre.is_none_or(|f| f.same((i, self.z_mid_mm(i)), (j, self.z_mid_mm(j))))
            };
            if let Some(j) = (i.saturating_sub(2)..i).rev().find(same) {
                like[i] = like[j];
            }
        }
        like
    }

    fn z_mid_mm(&self, layer_idx: usize) -> f64 {
        let layer = &self.stack.layers()[layer_idx];
        layer.z_top_mm() - 0.5 * layer.height_mm()
    }

    fn context(&self, layer_idx: usize, density: f64, role: Role) -> FillContext<'_> {
        let layer = &self.stack.layers()[layer_idx];
        FillContext {
            z_mid_mm: self.z_mid_mm(layer_idx),
            height_mm: layer.height_mm(),
            bead_width_mm: self.settings.process.bead_width_mm,
            density,
            angle_rad: self.angle_rad(layer_idx, density),
            part: self.part,
            role,
            border_mm: self.border_mm(layer),
            field: Some(match (self.guide, self.grain) {
                (Some(guide), _) => guide.layer(layer_idx),
                (None, Some(grain)) => grain,
                (None, None) => &self.uniform,
            }),
        }
    }

    /// How far what fill is to fill reaches beyond the room of its centrelines: to the strips of the walls, and a
    /// little more for what the round edge of the outer wall leaves out, so that the layer has the part's volume.
    fn border_mm(&self, layer: &Layer) -> f64 {
        let w = self.settings.process.bead_width_mm;
        let s = bead_spacing_mm(w, layer.height_mm());
        if self.settings.process.walls == 0 {
            return 0.5 * w;
        }
        (0.5 - self.settings.fill.overlap) * s + 0.5 * (w - s)
    }

    /// The direction of a layer's lines. Crossed patterns and `aligned` keep the first angle of the list.
    fn angle_rad(&self, layer_idx: usize, density: f64) -> f64 {
        let s = self.settings;
        let turns = density >= 0.999 || s.fill.pattern == "rectilinear";
        let turns = turns && s.fill.pattern != "aligned";
        let angles = &s.fill.angles_deg;
        let deg = if s.guide.kind == "angle" {
            s.guide.angle_deg
        } else {
            angles[if turns { layer_idx % angles.len() } else { 0 }]
        };
        deg.to_radians()
    }

    /// Skins, bridges, and the inside where it is dense.
    fn dense_fill(&self, i: usize, split: &SkinSplit, add: &mut dyn FnMut(usize, Toolpath)) -> Tally {
        let mut paths = Vec::new();
        let mut tally = Tally::default();
        let fill = &self.settings.fill;
        let all_dense = fill.density >= 0.999;
        // Skins over sparse fill stay straight lines without fibre: they close the part.
        let grain = self.grain.filter(|_| all_dense);
        let fibre = self.fibre.filter(|_| all_dense);
        for (polygons, role) in [(&split.solid, Role::SolidFill), (&split.top, Role::TopSkin)] {
            let asked =
                Wanted { density: 1.0, role, pattern: Some(self.dense_pattern(&fill.pattern)), grain };
            for rooms in polygons.chunk_by(|a, b| a.0 == b.0) {
                tally = tally.and(self.rooms(i, rooms, &asked, fibre, &mut paths));
                paths.drain(..).for_each(|p| add(rooms[0].0, p));
            }
        }
        for (island, polygon) in &split.bridge {
            self.bridge(i, polygon, &mut paths);
            paths.drain(..).for_each(|p| add(*island, p));
        }
        tally
    }

    /// Dense fill beside sparse one is plain; where all is dense it is the pattern asked for, and a part with a
    /// guide follows it in its skins too.
    fn dense_pattern(&self, name: &str) -> &dyn Infill {
        match name {
            "continuous" => &self.continuous,
            "concentric" if self.settings.fill.density >= 0.999 => &crate::fill::Concentric,
            "stripes" | "streamlines" => &Stripes,
            "seed-lines" => &crate::fill::SeedLines,
            _ => &Solid,
        }
    }

    /// Whether all fill of an island is to be one path.
    fn is_continuous(&self) -> bool {
        self.settings.fill.pattern == "continuous" && self.grain.is_none_or(|g| g.mode == Mode::Field)
    }

    /// Warns of each kind of trouble once, at its first place, and says in how many layers more it is.
    fn tell_notes(&self, diagnostics: &Diagnostics) {
        let all = self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut told = Vec::new();
        for (&(layer_idx, _), note) in all.iter().flat_map(|(key, notes)| notes.iter().map(move |n| (key, n)))
        {
            let kind = std::mem::discriminant(&note.what);
            if told.contains(&kind) {
                continue;
            }
            told.push(kind);
            let same = |notes: &[Note]| notes.iter().any(|n| std::mem::discriminant(&n.what) == kind);
            let layers: BTreeSet<usize> =
                all.iter().filter(|(_, notes)| same(notes)).map(|(key, _)| key.0).collect();
            let more = match layers.len() - 1 {
                0 => String::new(),
                n => format!(" (and the like in {n} more)"),
            };
            let z_mm = self.stack.layers()[layer_idx].z_top_mm();
            diagnostics
                .warn_at(1 + layer_idx, format!("layer {} at {z_mm:.2} mm{more}: {note}", layer_idx + 1));
        }
    }

    /// Fills the rooms of an island, with fibre where that is asked for and the matrix around it.
    fn rooms(
        &self,
        i: usize,
        rooms: &[IslandPolygon],
        asked: &Wanted<'_>,
        fibre: Option<&FibreSettings>,
        out: &mut Vec<Toolpath>,
    ) -> Tally {
        let mut context = self.context(i, asked.density, asked.role);
        let Some(fibre) = fibre else {
            let rooms: Vec<&Polygon> = rooms.iter().map(|r| &r.1).collect();
            self.fill_rooms(i, &context, &rooms, asked, out);
            return Tally::default();
        };
        let z_mm = self.z_mid_mm(i);
        let matrix_mm = self.settings.process.bead_width_mm;
        let (mut with, mut without) = (Vec::new(), Vec::new());
        for (_, room) in rooms {
            let (a, b) = fibre.split((i, z_mm), context.height_mm, room, matrix_mm);
            with.extend(a);
            without.extend(b);
        }
        let f = &self.settings.fibre;
        let density = f.matrix_density;
        if density > 0.0 {
            let dense = density >= 0.999;
            let role = if dense { asked.role } else { Role::SparseFill };
            let name = f.matrix_pattern.as_str();
            let matrix = if dense { Some(self.dense_pattern(name)) } else { self.pattern(name) };
            if let Some(matrix) = matrix {
                let context = self.context(i, density, role);
                without.iter().for_each(|room| matrix.fill(&context, room, out));
            }
        }
        context.bead_width_mm = fibre.bead_width_mm;
        context.border_mm += 0.5 * (fibre.bead_width_mm - matrix_mm);
        let load = |p: DVec2| self.guide.map_or(0.0, |guide| guide.asked(i, p.extend(z_mm)).1);
        let mut paths = Vec::new();
        self.fill_rooms(i, &context, &with.iter().collect::<Vec<_>>(), asked, &mut paths);
        fibre.lay(paths, &Region { polygons: with }, &load, self.settings.process.chain, out)
    }

    /// Fills the rooms of an island; as one path where that is asked for and can be.
    fn fill_rooms(
        &self,
        i: usize,
        context: &FillContext<'_>,
        rooms: &[&Polygon],
        asked: &Wanted<'_>,
        out: &mut Vec<Toolpath>,
    ) {
        if self.is_continuous() {
            let mut notes = Vec::new();
            self.continuous.lay_island(context, rooms, out, &mut notes);
            if !notes.is_empty() {
                let mut all = self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                all.entry((i, context.role)).or_default().extend(notes);
            }
            return;
        }
        for room in rooms {
            match (asked.grain, asked.pattern) {
                (Some(grain), _) => self.along_grain(grain, context, room, out),
                (None, Some(pattern)) => pattern.fill(context, room, out),
                (None, None) => {}
            }
        }
    }

    /// A pattern for the inside.
    fn pattern(&self, name: &str) -> Option<&dyn Infill> {
        match name {
            "continuous" => Some(&self.continuous),
            name => pattern(name).map(|p| p as &dyn Infill),
        }
    }

    fn bridge(&self, i: usize, polygon: &Polygon, out: &mut Vec<Toolpath>) {
        let mut context = self.context(i, 1.0, Role::Bridge);
        let below = self.stack.layers()[i - 1].region();
        if let Some(angle) = bridge_angle_rad(polygon, below, context.spacing_mm()) {
            context.angle_rad = angle;
        }
        let first = out.len();
        Solid.fill(&context, polygon, out);
        for path in &mut out[first..] {
            path.flow = self.settings.process.bridge_flow;
            path.speed = SpeedClass::Bridge;
        }
    }

    fn sparse_fill(
        &self,
        i: usize,
        split: &SkinSplit,
        density: f64,
        add: &mut dyn FnMut(usize, Toolpath),
    ) -> Tally {
        let mut tally = Tally::default();
        if density <= 0.0 {
            return tally;
        }
        let role = if density >= 0.999 { Role::SolidFill } else { Role::SparseFill };
        let pattern = self.pattern(&self.settings.fill.pattern);
        let asked = Wanted { density, role, pattern, grain: self.grain };
        let mut paths = Vec::new();
        for rooms in split.sparse.chunk_by(|a, b| a.0 == b.0) {
            tally = tally.and(self.rooms(i, rooms, &asked, self.fibre, &mut paths));
            paths.drain(..).for_each(|p| add(rooms[0].0, p));
        }
        tally
    }

    /// Fills a room with the grain: the picture's edges, the guided pattern asked for, or else stripes where it is
    /// dense and lines at even distances where it is not.
    fn along_grain(
        &self,
        grain: &GrainGuide,
        context: &FillContext<'_>,
        room: &Polygon,
        out: &mut Vec<Toolpath>,
    ) {
        let z_mm = context.z_mid_mm;
        let axis = |p: DVec2| direction(grain.sample(p.extend(z_mm)).axis_rad);
        let sparseness = |p: DVec2| grain.sparseness(p.extend(z_mm));
        let flow = Flow { axis: &axis, sparseness: grain.has_darkness().then_some(&sparseness) };
        let name = self.settings.fill.pattern.as_str();
        match (grain.mode, self.pattern(name).filter(|_| GUIDED.contains(&name))) {
            (Mode::Edges, _) => lay_curves(context, room, &grain.curves(z_mm), &flow, out),
            (Mode::Field, Some(asked)) => asked.fill(context, room, out),
            (Mode::Field, None) if context.density >= 0.999 => Stripes.fill(context, room, out),
            (Mode::Field, None) => lay_curves(context, room, &[], &flow, out),
        }
    }

    /// The beads of the support in a layer.
    fn supports(&self, i: usize) -> Vec<Island> {
        let Some(layer) = self.support.map(|s| &s.cut.layers[i]) else { return Vec::new() };
        let s = &self.settings.support;
        let settings = BeadSettings {
            bead_width_mm: self.settings.process.bead_width_mm,
            min_bead_width_mm: self.settings.process.min_bead_width_mm,
            walls: s.walls,
            density: if s.style == "tree" { s.density } else { s.density.max(0.15) },
        };
        let context = self.context(i, 1.0, Role::Support);
        support::beads::lay(layer, &context, i < s.dense_layers, &settings)
    }

    /// Skirt and brim of the layers that have any.
    fn adhesion(&self) -> Vec<Vec<Toolpath>> {
        let p = &self.settings.process;
        let Some(first) = self.stack.layers().first() else { return Vec::new() };
        let settings = AdhesionSettings {
            brim_width_mm: p.brim_width_mm,
            skirt_loops: p.skirt_loops,
            skirt_distance_mm: p.skirt_distance_mm,
            bead_width_mm: p.bead_width_mm,
            height_mm: first.height_mm(),
        };
        let standing = match self.support {
            Some(s) => first.region().union(&s.cut.layers[0].region),
            None => first.region().clone(),
        };
        let skirts = if p.skirt_loops > 0 { skirt(&standing, &settings) } else { Vec::new() };
        let n = if p.skirt_loops > 0 { p.skirt_layers.min(self.stack.layers().len()) } else { 1 };
        let mut all = vec![skirts; n];
        if p.brim_width_mm > 0.0 {
            all[0].extend(brim(&standing, &settings));
        }
        all
    }

    /// The density asked for, or the one that gives the mass asked for.
    fn density(&self, walls: &[Vec<Island>], skins: &[SkinSplit]) -> Result<f64, Error> {
        let Some(asked_g) = self.settings.fill.mass_g else { return Ok(self.settings.fill.density) };
        let grams = |path: &Toolpath, height_mm: f64| {
            let s = self.settings;
            let m = if path.role == Role::Fibre { &s.fibre_material } else { &s.material };
            path.volume_mm3(height_mm) * 1e-3 * m.density_g_cm3 * m.flow
        };
        let layers: Vec<usize> = (0..self.stack.layers().len()).collect();
        let sum = |each: &(dyn Fn(usize) -> f64 + Sync)| -> f64 {
            // Collected in order and added one after the other: the same sum for any number of threads.
            layers.par_iter().map(|&i| each(i)).collect::<Vec<f64>>().into_iter().sum()
        };
        let height = |i: usize| self.stack.layers()[i].height_mm();
        let fixed = sum(&|i| {
            let walls =
                walls[i].iter().flat_map(|island| island.walls.iter().map(|w| &w.path).chain(&island.fills));
            let mut mass: f64 = walls.map(|p| grams(p, height(i))).sum();
            self.dense_fill(i, &skins[i], &mut |_, p| mass += grams(&p, height(i)));
            mass
        });
        let mass = |density: f64| {
            fixed
                + sum(&|i| {
                    let mut mass = 0.0;
                    self.sparse_fill(i, &skins[i], density, &mut |_, p| mass += grams(&p, height(i)));
                    mass
                })
        };
        // Mass is nearly proportional to density: two or three steps along the chord find most.
        let mut density = 0.3;
        let mut nearest = (f64::INFINITY, density);
        for _ in 0..6 {
            let found = mass(density);
            let off = (found - asked_g).abs();
            if off < nearest.0 {
                nearest = (off, density);
            }
            if off < 2.5e-3 * asked_g {
                return Ok(density);
            }
            density *= (asked_g - fixed) / (found - fixed).max(1e-9);
            if !(0.01..0.95).contains(&density) {
                break;
            }
        }
        if nearest.0 < 5e-3 * asked_g {
            return Ok(nearest.1);
        }
        let high_g = mass(1.0);
        if asked_g < fixed * 0.99 || asked_g > high_g * 1.01 {
            return Err(Error::Mass { asked_g, low_g: fixed, high_g });
        }
        // Mass rises with density, in small steps where a line comes or goes: halving finds it.
        let (mut low, mut high) = (0.0, 1.0);
        let mut best = (f64::INFINITY, 0.0);
        for _ in 0..14 {
            let middle = 0.5 * (low + high);
            let off = mass(middle) - asked_g;
            if off.abs() < best.0 {
                best = (off.abs(), middle);
            }
            if off.abs() < 1e-3 * asked_g {
                break;
            }
            if off < 0.0 { low = middle } else { high = middle }
        }
        Ok(best.1)
    }
}

/// Marks a wall as overhanging when enough of it lies over air.
fn mark_overhang(path: &mut Toolpath, below: &Mask) {
    let (mut free, mut all) = (0.0, 0.0);
    for i in 0..path.n_segments() {
        let (a, b, _) = path.segment(i);
        let length = a.distance(b);
        all += length;
        if !below.contains(0.5 * (a + b)) {
            free += length;
        }
    }
    if free > OVERHANG_SHARE * all {
        path.speed = SpeedClass::Overhang;
    }
    debug_assert!(matches!(path.width, BeadWidth::Constant(_)));
}
