//! Writes the outputs of a run: G-code, report, pictures, and files for other programs.

use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use grainpath::Planned;
use grainpath::guide::{Degenerate, Guide};
use grainpath::measure::dimensions::Dimension;
use grainpath::measure::report::{Report, measure, measure_fibre};
use grainpath::measure::strength::{StressedPart, TestSetup, Tested, reserve, test, three_digits};
use grainpath_core::diagnostics::Stage;
use grainpath_core::spelling::meaning;
use grainpath_core::{DVec3, Diagnostics, TriMesh};
use grainpath_gcode::{Program, Replay, Thumbnail, Written, write_gcode};
use grainpath_job::{Row, Settings};
use grainpath_view::bead_reserve::{BeadReserves, SCALE, reserve_png};
use grainpath_view::guide::{deformed_png, field_png, lines_svg, lines_vtp, loads_png, stress_png};
use grainpath_view::layer::{Ground, LayerPicture, PictureOptions, layer_png, layer_svg, thumbnail_png};
use grainpath_view::page;
use grainpath_view::strength::{damage_png, index_png};

use crate::claims::Claims;
use crate::{Failure, files, memory};

/// The name of an output that is named after an input: the input's name without its ending, and `end`. Names need not be
/// text, and keep their bytes.
pub(crate) fn named_after(input: &Path, end: &str) -> OsString {
    let mut name = input.file_stem().map_or_else(|| "part".into(), OsStr::to_owned);
    name.push(end);
    name
}

/// The paths of the outputs.
pub(crate) struct Paths {
    gcode: PathBuf,
    report: Option<PathBuf>,
    preview: Option<PathBuf>,
    plan: Option<PathBuf>,
    support: Option<PathBuf>,
    surface: Option<PathBuf>,
    layers_cli: Option<PathBuf>,
    layers_svg: Option<PathBuf>,
    stress: Option<PathBuf>,
    lines: Option<PathBuf>,
}

impl Paths {
    /// Output paths of a job, relative to `out`.
    pub(crate) fn new(settings: &Settings, mesh: &Path, out: &Path) -> Result<Self, Failure> {
        let o = &settings.output;
        let given = |text: &String| (!text.is_empty()).then(|| out.join(text));
        // G-code is always written; if the job names no file, it gets the name of the shape's file.
        let gcode = given(&o.gcode).unwrap_or_else(|| out.join(named_after(mesh, ".gcode")));
        let paths = Self {
            gcode,
            report: given(&o.report),
            preview: given(&o.preview),
            plan: given(&o.plan),
            support: given(&o.support),
            surface: given(&o.surface),
            layers_cli: given(&o.layers_cli),
            layers_svg: given(&o.layers_svg),
            stress: given(&o.stress),
            lines: given(&o.lines),
        };
        // Endings are checked before planning, so that a mistake in a file name is reported at once.
        if let Some(path) = &paths.support {
            MeshEnding::from_path(path)?;
        }
        if let Some(path) = &paths.lines
            && LinesFormat::from_path(path).is_none()
        {
            return Err(Failure::usage(format!("output.lines = {:?} should end in .svg or .vtp", o.lines)));
        }
        Ok(paths)
    }

    /// The same paths with the program at another one, whose name need not be text.
    pub(crate) fn with_gcode(self, gcode: PathBuf) -> Self {
        Self { gcode, ..self }
    }

    /// Whether the program goes to standard output, which must then hold nothing else.
    pub(crate) fn is_standard_output(&self) -> bool {
        files::is_standard_output(&self.gcode)
    }

    /// Adds all files that are written. Called after the files that are read were added.
    pub(crate) fn claim(&self, claims: &mut Claims) {
        let all = [
            ("output.gcode", Some(&self.gcode)),
            ("output.report", self.report.as_ref()),
            ("output.plan", self.plan.as_ref()),
            ("output.support", self.support.as_ref()),
            ("output.surface", self.surface.as_ref()),
            ("output.layers_cli", self.layers_cli.as_ref()),
            ("output.layers_svg", self.layers_svg.as_ref()),
            ("output.stress", self.stress.as_ref()),
            ("output.lines", self.lines.as_ref()),
        ];
        for (what, path) in all {
            path.into_iter().for_each(|path| claims.write(what, path));
        }
        if let Some(folder) = &self.preview {
            claims.write_into("output.preview", folder, is_picture_name);
        }
    }
}

/// Pictures of a part in the folder of `output.preview`, by their names.
const PICTURES: [&str; 7] =
    ["part.png", "density.png", "damage.png", "index.png", "loads.png", "deformed.png", "reserve.png"];
/// Pictures of a layer or of a step, by the beginnings of their names.
const PICTURES_OF: [&str; 6] = ["layer_", "stress_", "field_", "texture_", "grain_", "support_"];

/// Whether a run may write a picture of this name into the folder of `output.preview`.
fn is_picture_name(name: &str) -> bool {
    let is_picture = name.ends_with(".png") || name.ends_with(".svg");
    PICTURES.contains(&name) || is_picture && PICTURES_OF.iter().any(|start| name.starts_with(start))
}

/// Writes a picture into the folder of `output.preview`, under a name that was checked against all other files.
fn save_picture(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), Failure> {
    let path = folder.join(name);
    if !is_picture_name(name) {
        return Err(Failure::usage(format!("{}: no picture has this name", path.display())));
    }
    save(&path, bytes)
}

/// Writes the outputs of a job and returns the report, and the reserves of the beads if they were drawn. `ready` is called
/// with the program as soon as it is read back, before it is tested, measured and drawn.
pub(crate) fn write(
    settings: &Settings,
    mut planned: Planned,
    paths: &Paths,
    read_s: f64,
    measured: bool,
    truth: Option<&[Dimension]>,
    ready: &dyn Fn(&Arc<Program>, &Planned),
    diagnostics: &Diagnostics,
) -> Result<(Report, Option<BeadReserves>), Failure> {
    let start = Instant::now();
    diagnostics.begin(Stage::Write, planned.plan.layers.len());
    let thumbnails = thumbnails(settings, &planned)?;
    // The program is read back only if something is measured on it, since its beads take more memory than its text.
    let loaded = planned.test.is_some() || planned.guide.is_some();
    let special = loaded || planned.config.fibre.is_some() || truth.is_some();
    let wanted = measured || special || paths.report.is_some() || paths.preview.is_some();
    let (mut program, mut tested, mut write_s) = (None, None, 0.0);
    let written = files::write_atomically(&paths.gcode, |file| {
        let mut tee = Tee { file, replay: wanted.then(|| replay(settings)), replay_s: 0.0 };
        let written = write_gcode(&planned.plan, &planned.config, &thumbnails, &mut tee);
        let written = written.map_err(|e| Failure::from(grainpath::Error::from(e)))?;
        diagnostics.check().map_err(|e| Failure::from(grainpath::Error::from(e)))?;
        write_s = start.elapsed().as_secs_f64() - tee.replay_s;
        // The test runs before the rename, so that a program that fails to be tested does not replace an
        // earlier one.
        program = tee.replay.map(finished).transpose()?.map(Arc::new);
        program.iter().for_each(|program| ready(program, &planned));
        if let (Some(setup), Some(program)) = (&planned.test, &program) {
            tested = Some(strength(settings, &planned, setup, program, diagnostics)?);
            // Pictures and files for other programs are still to come.
            diagnostics.begin(Stage::Write, 0);
        }
        Ok(written)
    })?;
    let mut report = report_of(settings, &planned, &written, program.as_deref(), diagnostics);
    report.stages_s.insert(Stage::Read.name(), seconds(read_s));
    report.stages_s.insert(Stage::Write.name(), seconds(write_s));
    report.outputs.insert("gcode", paths.gcode.display().to_string());
    let mut reserves = None;
    if let Some(program) = program {
        report.dimensions = truth.map(|t| {
            grainpath::measure::dimensions::measure(t, &program, planned.plan.plate_from_part_mm.truncate())
        });
        let mut drawn = guide_pictures(&planned, paths);
        drawn.extend(planned.grain.take().map(|g| grainpath_view::grain::pictures(&g)).unwrap_or_default());
        if let Some((tested, s)) = tested {
            report.stages_s.insert(Stage::Strength.name(), seconds(s));
            drawn.extend(strength_pictures(&tested));
            report.strength = Some(tested.report);
        }
        if let Some(laid) = &planned.laid {
            let picture = page::Picture {
                title:
                    "Density of sparse infill over cells of 5 mm: asked for on the left, laid on the right"
                        .into(),
                png: grainpath_view::density_map::density_png(laid, GUIDE_PX),
                of: page::Of::Density,
                scale: Some(page::ColourScale { low: laid.min, high: laid.max, what: "share" }),
            };
            drawn.push(("density.png".into(), picture));
        }
        if paths.report.is_some() || paths.preview.is_some() {
            // Looking up the cells below all beads takes time, so it is done only for a picture.
            reserves = bead_reserves(&report, &program);
            drawn.extend(reserves.as_ref().and_then(|r| reserve_picture(&report, &program, r)));
        }
        let supports = planned.supported_mesh.as_ref().zip(planned.support.as_ref());
        let pictures =
            supports.map(|(mesh, s)| grainpath_view::support::pictures(mesh, s)).unwrap_or_default();
        drawn.extend(pictures.into_iter().map(|p| {
            let picture = page::Picture { title: p.title, png: p.png, ..page::Picture::default() };
            (format!("support_{}.png", p.name), picture)
        }));
        let marks = marks(&report, &program, planned.plan.plate_from_part_mm);
        previews(settings, &program, (&drawn, &marks), paths, diagnostics, &mut report)?;
    }
    // Files for other programs are written even if the G-code was not read back.
    guide_files(&planned, paths, &mut report)?;
    if let Some(path) = &paths.plan {
        let text = grainpath::measure::plan_json::plan_json(&planned.plan);
        save(path, text.as_bytes())?;
        report.outputs.insert("plan", path.display().to_string());
    }
    if let (Some(path), Some(support)) = (&paths.support, &planned.support) {
        let (layers, method) = (&support.cut.layers, settings.support.solid);
        let mesh = grainpath::support::surface(layers, &planned.stack, method, diagnostics)
            .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
        // A part without overhangs has no support. No file is written, since an empty STL would look like a failure.
        if !mesh.triangles.is_empty() {
            write_mesh(path, &[&mesh])?;
            report.outputs.insert("support", path.display().to_string());
        }
    }
    shapes(&planned, paths, settings.output.surface_cell_mm, diagnostics, &mut report)?;
    // Warnings are collected last, because each output above may add one.
    report.warnings = diagnostics.warnings();
    report.peak_rss_mb = memory::peak_rss_mb();
    Ok((report, reserves))
}

/// Rounds seconds to four decimals, as in reports.
fn seconds(s: f64) -> f64 {
    (s * 1e4).round() / 1e4
}

/// The report of a plan. If `program`, the G-code read back, is given, the report contains the quantities measured on
/// it. Warnings go to `diagnostics`.
pub fn report_of(
    settings: &Settings,
    planned: &Planned,
    written: &Written,
    program: Option<&Program>,
    diagnostics: &Diagnostics,
) -> Report {
    let mut report = Report::new(planned, written);
    for (stage, s) in &planned.stages_s {
        report.stages_s.insert(stage.name(), seconds(*s));
    }
    let Some(program) = program else { return report };
    // All quantities are measured on the written program instead of the plan, so that errors of the
    // writer show up too.
    let quality = measure(planned, program);
    report.fibre = measure_fibre(settings.fibre.min_radius_mm, planned, program);
    report.fibre.iter().filter_map(|f| f.warning()).for_each(|w| diagnostics.push(w));
    if let Some(width_mm) = grainpath::run::config::dense_fibre_width_mm(settings) {
        quality.fibre_warning(width_mm).into_iter().for_each(|w| diagnostics.push(w));
    }
    report.quality = Some(quality);
    report.reserve = planned.guide.as_ref().map(|guide| {
        let plate_from_part_mm = planned.plan.plate_from_part_mm.truncate();
        let (stack, on_cells) = (&planned.stack, planned.on_cells.as_ref());
        let part = StressedPart { guide, stack, plate_from_part_mm, on_cells };
        reserve(&grainpath::run::config::strength(settings), part, program, diagnostics)
    });
    report
}

/// The G-code of a plan, with the same bytes as `grainpath run` writes.
///
/// # Errors
/// Errors of the G-code writer.
pub fn program_bytes(settings: &Settings, planned: &Planned) -> Result<(Vec<u8>, Written), Failure> {
    let mut bytes = Vec::new();
    let written = write_gcode(&planned.plan, &planned.config, &thumbnails(settings, planned)?, &mut bytes)
        .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
    Ok((bytes, written))
}

/// Writes the layers and the surface of the part if the job asks for them.
fn shapes(
    planned: &Planned,
    paths: &Paths,
    cell_mm: f64,
    diagnostics: &Diagnostics,
    report: &mut Report,
) -> Result<(), Failure> {
    type Write1 = fn(&grainpath_core::LayerStack, &mut dyn Write) -> std::io::Result<()>;
    let formats: [(&str, &Option<PathBuf>, Write1); 2] = [
        ("layers_cli", &paths.layers_cli, grainpath_io::write_cli),
        ("layers_svg", &paths.layers_svg, grainpath_io::write_svg_layers),
    ];
    for (what, path, write) in formats {
        let Some(path) = path else { continue };
        let failed = |e: std::io::Error| Failure::usage(format!("cannot write {}: {e}", path.display()));
        files::write_atomically(path, |w| write(&planned.stack, w).map_err(failed))?;
        report.outputs.insert(what, path.display().to_string());
    }
    if let Some(path) = &paths.surface {
        let mesh = grainpath::shape::loft(&planned.stack, cell_mm, diagnostics)
            .map_err(|e| grainpath::Error::Shape { path: path.display().to_string(), source: e.into() })?;
        write_mesh(path, &[&mesh])?;
        report.outputs.insert("surface", path.display().to_string());
    }
    Ok(())
}

/// Writes to a file and replays the same bytes, if that is wanted.
struct Tee<'a> {
    file: &'a mut dyn Write,
    replay: Option<Replay>,
    /// Time spent on replaying, s.
    replay_s: f64,
}

impl Write for Tee<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        // Bytes are replayed only after the file has taken all of them, so nothing is measured that is not in the file.
        self.file.write_all(bytes)?;
        if let Some(replay) = &mut self.replay {
            let start = Instant::now();
            replay.push(bytes);
            self.replay_s += start.elapsed().as_secs_f64();
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

/// A replay of G-code with the limits and the filament diameter of the job's printer.
fn replay(settings: &Settings) -> Replay {
    Replay::new(settings.printer.filament_mm, &grainpath::run::config::limits(settings))
}

fn finished(replay: Replay) -> Result<Program, Failure> {
    replay.finish().map_err(|e| Failure::input(e.to_string()))
}

/// Reads G-code back with the limits and the filament diameter of the job's printer.
///
/// # Errors
/// Exit code 3 for a program that cannot be replayed.
pub fn read_back(settings: &Settings, gcode: &[u8]) -> Result<Program, Failure> {
    let mut replay = replay(settings);
    replay.push(gcode);
    finished(replay)
}

/// Thumbnails for the printer's screen, drawn from the program that will be written.
fn thumbnails(settings: &Settings, planned: &Planned) -> Result<Vec<Thumbnail>, Failure> {
    if settings.printer.thumbnails_px.is_empty() {
        return Ok(Vec::new());
    }
    // Thumbnails stand at the top of the program but show its beads, so the program is first written
    // without them.
    let mut replay = replay(settings);
    write_gcode(&planned.plan, &planned.config, &[], &mut replay)
        .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
    let program = finished(replay)?;
    Ok(grainpath_view::layer::thumbnails(&program, &settings.printer.thumbnails_px))
}

/// Layers drawn for the report: the first, those at each quarter, and the last. The first and the last
/// layer have other problems than those between.
fn shown(n: usize) -> Vec<usize> {
    let mut layers: Vec<usize> =
        [0, n / 4, n / 2, 3 * n / 4, n.saturating_sub(1)].into_iter().filter(|&i| i < n).collect();
    // In a part with few layers, two of these can be the same layer.
    layers.dedup();
    layers
}

fn previews(
    settings: &Settings,
    program: &Program,
    (drawn, marks): (&[(String, page::Picture)], &[page::Mark]),
    paths: &Paths,
    diagnostics: &Diagnostics,
    report: &mut Report,
) -> Result<(), Failure> {
    if paths.report.is_none() && paths.preview.is_none() {
        return Ok(());
    }
    let all: Vec<LayerPicture> = program.layers.iter().map(LayerPicture::from).collect();
    let part = thumbnail_png(&all, 1200, 900, Ground::Paper);
    let part = page::Picture { title: "The part".into(), png: part, of: page::Of::Part, scale: None };
    let mut pictures = vec![part];
    let options = PictureOptions::default();
    for i in shown(all.len()) {
        let title = format!("Layer {} at {:.2} mm", i + 1, all[i].z_mm);
        let png = layer_png(&all[i], &options);
        pictures.push(page::Picture { title, png, of: page::Of::Layer, scale: None });
    }
    if let Some(folder) = &paths.preview {
        save_picture(folder, "part.png", &pictures[0].png)?;
        // The first picture shows the whole part; those of layers follow from the second on.
        for (i, p) in shown(all.len()).into_iter().zip(&pictures[1..]) {
            let svg = layer_svg(&all[i], &options);
            save_picture(folder, &format!("layer_{:04}.png", i + 1), &p.png)?;
            save_picture(folder, &format!("layer_{:04}.svg", i + 1), svg.as_bytes())?;
        }
        for (name, picture) in drawn {
            save_picture(folder, name, &picture.png)?;
        }
        report.outputs.insert("preview", folder.display().to_string());
    }
    // The page is written last and lists the other outputs, so warnings and memory are taken now.
    if let Some(path) = &paths.report {
        report.warnings = diagnostics.warnings();
        report.outputs.insert("report", path.display().to_string());
        report.peak_rss_mb = memory::peak_rss_mb();
        // The page draws its layers by script; a picture of the middle layer is for browsers without scripts.
        let stills = pictures.split_off(1);
        let middle = stills.len() / 2;
        pictures.extend(stills.into_iter().nth(middle));
        pictures.extend(drawn.iter().map(|d| d.1.clone()));
        let setting = |r: Row| page::Setting { key: r.key, value: r.value, default: r.default, unit: r.unit };
        let rows = settings.profile_rows().into_iter().chain(settings.rows());
        let settings: Vec<page::Setting> = rows.map(setting).collect();
        let contents = page::Contents { settings: &settings, pictures: &pictures, layers: &all, marks };
        save(path, page::report_html(report, &contents).as_bytes())?;
    }
    Ok(())
}

/// Points that the report links to: the peak stress, the point of first failure, and the point of breakage.
fn marks(report: &Report, program: &Program, plate_from_part_mm: DVec3) -> Vec<page::Mark> {
    let mark = |what: &str, at: DVec3| page::Mark { what: what.into(), at: at.truncate(), z_mm: at.z };
    let stress = report.stress.as_ref().and_then(|s| s.peak_at_mm).map(DVec3::from_array);
    let weakest = report.strength.as_ref().map(|s| {
        // A plate breaks through its whole thickness and has no z; its mid height is used.
        let z_mm = s.weakest.z_mm.unwrap_or(0.5 * report.z_max_mm - plate_from_part_mm.z);
        DVec3::new(s.weakest.x_mm, s.weakest.y_mm, z_mm)
    });
    let first = report.reserve.as_ref().and_then(|r| r.least.as_ref()).map(|c| {
        // The button leads to the layer that is told: a place in a plate stands at its mid height.
        let told = c.layer.checked_sub(1).and_then(|k| program.layers.get(k));
        let [x, y, z] = c.at_mm;
        DVec3::new(x, y, told.map_or(z, |layer| layer.z_mm - plate_from_part_mm.z))
    });
    [("peak stress", stress), ("where it fails first", first), ("where it breaks", weakest)]
        .into_iter()
        .filter_map(|(what, at)| at.map(|at| mark(what, at + plate_from_part_mm)))
        .collect()
}

/// The reserves of the beads of a program whose report tells a reserve.
pub(crate) fn bead_reserves(report: &Report, program: &Program) -> Option<BeadReserves> {
    BeadReserves::new(report.reserve.as_ref()?.map.as_ref()?, program)
}

/// A picture of the layer that holds the least reserve, with its name.
fn reserve_picture(
    report: &Report,
    program: &Program,
    reserves: &BeadReserves,
) -> Option<(String, page::Picture)> {
    let map = report.reserve.as_ref()?.map.as_ref()?;
    let (beads, least) = (&program.layers[reserves.layer], f64::from(reserves.least));
    let title = format!(
        "Reserve in layer {} at {:.2} mm, which holds the least: the factor on the loads at first failure, red where the part \
         fails first, which the ring marks; grey beads lie near fixtures and loads and do not count",
        reserves.layer + 1,
        beads.z_mm
    );
    let png = reserve_png(map, beads, least, GUIDE_PX);
    let scale = page::ColourScale { low: SCALE * least, high: least, what: "times the load" };
    Some(("reserve.png".into(), page::Picture { title, png, of: page::Of::Stress, scale: Some(scale) }))
}

/// Tests the strength of the program. Returns the test and its time in seconds.
fn strength(
    settings: &Settings,
    planned: &Planned,
    setup: &TestSetup,
    program: &Program,
    diagnostics: &Diagnostics,
) -> Result<(Tested, f64), Failure> {
    let start = Instant::now();
    let shift = planned.plan.plate_from_part_mm.truncate();
    let wanted = grainpath::run::config::strength(settings);
    let tested = test(&wanted, setup, program, Some(shift), diagnostics)
        .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
    Ok((tested, start.elapsed().as_secs_f64()))
}

/// The names of [`strength_pictures`].
pub(crate) const STRENGTH_PICTURES: [&str; 2] = ["damage.png", "index.png"];
/// Name of the chart of load over displacement.
pub(crate) const STRENGTH_CURVE: &str = "curve.svg";

/// Pictures of the damage and of the failure index.
pub(crate) fn strength_pictures(tested: &Tested) -> Vec<(String, page::Picture)> {
    let picture = |title: &str, (png, where_is): (Vec<u8>, String)| page::Picture {
        title: format!("{title}{where_is}"),
        png,
        of: page::Of::Strength,
        scale: Some(page::ColourScale { low: 0.0, high: 1.0, what: "share" }),
    };
    vec![
        (
            STRENGTH_PICTURES[0].into(),
            picture("Share of the material that broke, blue none, red all", damage_png(tested, GUIDE_PX)),
        ),
        (
            STRENGTH_PICTURES[1].into(),
            picture("Failure index when the first ply broke, red 1", index_png(tested, GUIDE_PX)),
        ),
    ]
}

/// Longer side of pictures of stress or directions, pixels: the same as in `PictureOptions` for layers, so
/// that all pictures of a layer have the same size. Source: chosen by eye; only the picture depends on it.
const GUIDE_PX: u32 = 1600;

/// Pictures of stress, lines and directions, with their file names.
fn guide_pictures(planned: &Planned, paths: &Paths) -> Vec<(String, page::Picture)> {
    let Some(guide) = planned.guide.as_ref().filter(|_| paths.report.is_some() || paths.preview.is_some())
    else {
        return Vec::new();
    };
    let layers = planned.stack.layers();
    // Fields are sampled at the mid height of a layer, at which its section was cut too.
    let z_mid = |i: usize| layers[i].z_top_mm() - 0.5 * layers[i].height_mm();
    let mut drawn = Vec::new();
    // Layers with the same field need only one set of pictures.
    let mut seen: Vec<usize> = Vec::new();
    for i in shown(layers.len()) {
        if seen.iter().any(|&j| guide.same(i, j)) {
            continue;
        }
        seen.push(i);
        let (region, z) = (layers[i].region(), z_mid(i));
        let families = guide.lines(region, z);
        let at = format!("layer {} at {:.2} mm", i + 1, layers[i].z_top_mm());
        let mut add = |kind: &str, title: String, png: Vec<u8>, scale: Option<page::ColourScale>| {
            let picture = page::Picture { title, png, of: page::Of::Stress, scale };
            drawn.push((format!("{kind}_{:04}.png", i + 1), picture));
        };
        let [rings, triangles, squares] = [Degenerate::Wedge, Degenerate::Trisector, Degenerate::Border]
            .map(|kind| guide.degenerate(i).count(kind));
        let (png, scale) = stress_png(guide, i, region, z, &families, GUIDE_PX);
        let title = format!(
            "Equivalent stress, blue 0 MPa to red {:.3} MPa and above, and principal lines (greater white, smaller dark), {at}; {rings} wedges (rings), \
             {triangles} trisectors (triangles), {squares} changes of sign on free borders (squares)",
            scale.high
        );
        add("stress", title, png, Some(page::ColourScale { low: 0.0, high: scale.high, what: "MPa" }));
        let directions = field_png(guide, i, region, z, GUIDE_PX);
        add("field", format!("Directions that fill follows, {at}"), directions, None);
    }
    drawn.extend(load_pictures(guide));
    drawn
}

/// Pictures of the fixtures and loads of the part, and of its deformed shape.
fn load_pictures(guide: &Guide) -> Vec<(String, page::Picture)> {
    let mut drawn = Vec::new();
    if let Some(png) = loads_png(guide, GUIDE_PX) {
        let title = "Forces of loads (red) and of fixtures (green) as arrows that end where the force acts, with lengths in proportion; \
                     moments yellow with two heads; nodes in the colour of the fixture or load that selects them";
        let title = title.into();
        drawn.push(("loads.png".into(), page::Picture { title, png, of: page::Of::Stress, scale: None }));
    }
    if let Some(shape) = deformed_png(guide, GUIDE_PX) {
        let title = format!(
            "Deformed shape under case {}, seen along {}, drawn {} times larger; blue 0 mm to red {:.4} mm, at rest grey",
            shape.case,
            shape.view,
            three_digits(shape.magnified),
            shape.max_mm
        );
        let scale = Some(page::ColourScale { low: 0.0, high: shape.max_mm, what: "mm" });
        let picture = page::Picture { title, png: shape.png, of: page::Of::Stress, scale };
        drawn.push(("deformed.png".into(), picture));
    }
    drawn
}

/// Writes the results of a load check, pictures and stress, to the files that the job names for them.
pub(crate) fn write_check(guide: &Guide, paths: &Paths) -> Result<Vec<(&'static str, String)>, Failure> {
    let mut written = Vec::new();
    if let Some(folder) = &paths.preview {
        for (name, picture) in load_pictures(guide) {
            save_picture(folder, &name, &picture.png)?;
        }
        written.push(("preview", folder.display().to_string()));
    }
    if let Some(path) = &paths.stress {
        let vtu = guide.vtu().map_err(|e| Failure::usage(format!("cannot write {}: {e}", path.display())))?;
        save(path, &vtu)?;
        written.push(("stress", path.display().to_string()));
    }
    Ok(written)
}

/// Stress and principal lines as files for other programs.
fn guide_files(planned: &Planned, paths: &Paths, report: &mut Report) -> Result<(), Failure> {
    let Some(guide) = &planned.guide else { return Ok(()) };
    if let Some(path) = &paths.stress {
        let vtu = guide.vtu().map_err(|e| Failure::usage(format!("cannot write {}: {e}", path.display())))?;
        save(path, &vtu)?;
        report.outputs.insert("stress", path.display().to_string());
    }
    if let Some(path) = &paths.lines {
        // Only one section is written: that of the middle layer, away from the bed and the top.
        let middle = &planned.stack.layers()[planned.stack.layers().len() / 2];
        let z = middle.z_top_mm() - 0.5 * middle.height_mm();
        let families = guide.lines(middle.region(), z);
        let text = match LinesFormat::from_path(path) {
            Some(LinesFormat::Vtp) => lines_vtp(&families, z),
            Some(LinesFormat::Svg) | None => lines_svg(middle.region(), &families),
        };
        save(path, text.as_bytes())?;
        report.outputs.insert("lines", path.display().to_string());
    }
    Ok(())
}

/// Writes bytes to a file.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::write_atomically(path, |w| {
        w.write_all(bytes).map_err(|e| Failure::usage(format!("cannot write {}: {e}", path.display())))
    })
}

/// The file format of principal lines.
#[derive(Clone, Copy)]
enum LinesFormat {
    Svg,
    Vtp,
}

impl LinesFormat {
    /// The format for the ending of a file name.
    fn from_path(path: &Path) -> Option<Self> {
        meaning(&[("svg", Self::Svg), ("vtp", Self::Vtp)], files::ending(path))
    }
}

/// The file format of a mesh.
#[derive(Clone, Copy)]
pub(crate) enum MeshEnding {
    Stl,
    ThreeMf,
}

impl MeshEnding {
    /// The format for the ending of a file name.
    pub(crate) fn from_path(path: &Path) -> Result<Self, Failure> {
        let ending = files::ending(path).to_ascii_lowercase();
        meaning(&[("stl", Self::Stl), ("3mf", Self::ThreeMf)], &ending).ok_or_else(|| {
            let name = path.display();
            Failure::usage(format!("{name}: the name of a mesh to write should end in .stl or .3mf"))
        })
    }
}

/// Writes bodies as STL or 3MF, by the file's ending.
pub(crate) fn write_mesh(path: &Path, bodies: &[&TriMesh]) -> Result<(), Failure> {
    let format = MeshEnding::from_path(path)?;
    let wrong = |e: std::io::Error| Failure::usage(format!("cannot write {}: {e}", path.display()));
    // STL has no bodies, so they are joined; 3MF keeps them apart, so that a slicer can print the support
    // with other settings.
    files::write_atomically(path, |out| match format {
        MeshEnding::Stl => grainpath_io::write_stl(&joined(bodies), out).map_err(wrong),
        MeshEnding::ThreeMf => grainpath_io::write_3mf(bodies, out).map_err(wrong),
    })
}

/// All bodies as one mesh; vertices are copied and not merged, since bodies may touch.
fn joined(bodies: &[&TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    for body in bodies {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&body.vertices);
        all.triangles.extend(body.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_outputs_keep_the_bytes_of_the_input() {
        assert_eq!(named_after(Path::new("a/b.c.stl"), "_x.stl"), "b.c_x.stl");
        assert_eq!(named_after(Path::new("/"), ".gcode"), "part.gcode");
        #[cfg(unix)]
        {
            use std::os::unix::ffi::{OsStrExt, OsStringExt};
            let input = OsString::from_vec(b"br\xfccke.stl".to_vec());
            assert_eq!(named_after(Path::new(&input), ".gcode").as_bytes(), b"br\xfccke.gcode");
        }
    }

    #[test]
    fn names_of_pictures_are_told_from_other_files() {
        for name in [
            "part.png",
            "layer_0001.svg",
            "layer_12345.png",
            "grain_1_photograph.png",
            "support_overhangs.png",
        ] {
            assert!(is_picture_name(name), "{name}");
        }
        for name in ["part.stl", "layer_0001.stl", "job.toml", "board.png", "report.html", "part.gcode"] {
            assert!(!is_picture_name(name), "{name}");
        }
    }
}
