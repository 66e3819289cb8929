//! The commands but `inspect`.

use std::path::{Path, PathBuf};

use grainpath::Planned;
use grainpath::measure::dimensions::Dimension;
use grainpath_core::diagnostics::Stage;
use grainpath_core::slices::SliceSource;
use grainpath_core::{Bounds2, DVec2, Diagnostics};
use grainpath_gcode::Program;
use grainpath_imaging::photo::Photo;
use grainpath_io::fe::{FeError, StressField, parse_fe};
use grainpath_io::image::decode_luma;
use grainpath_io::{parse_mesh, parse_outline};
use grainpath_job::{PROFILES, Settings, json_schema, markdown, parse_job};
use grainpath_view::layer::LayerPicture;

use crate::args::{Common, Markers, New, Profiles, Render, Run, Schema, Slice};
use crate::{Failure, files, outputs, progress, scan};

/// `grainpath run`
pub fn run(args: &Run) -> Result<(), Failure> {
    let (settings, shape, folder) = read_job(&args.job, &args.common.sets)?;
    let truth = match settings.ct.truth.as_str() {
        "" => None,
        path => {
            let path = folder.join(path);
            let read =
                grainpath::measure::dimensions::parse(&files::read_text(&path)?, &path.display().to_string());
            Some(read.map_err(grainpath::Error::from)?)
        }
    };
    let out = args.out.clone().unwrap_or_else(|| folder.clone());
    execute(&settings, &shape, &folder, &out, truth.as_deref(), &args.common)
}

/// `grainpath slice`
pub fn slice(args: &Slice) -> Result<(), Failure> {
    let mut settings = settings("", "--set", &args.common.sets, Path::new(""))?;
    let output = args.output.clone().unwrap_or_else(|| args.model.with_extension("gcode"));
    settings.output.gcode = output.display().to_string();
    if args.model.extension().is_some_and(|e| ["svg", "dxf"].iter().any(|d| e.eq_ignore_ascii_case(d))) {
        settings.shape.outline = args.model.display().to_string();
        if settings.shape.thickness_mm == 0.0 {
            return Err(Failure::usage("an outline needs --set shape.thickness_mm=N"));
        }
    }
    execute(&settings, &args.model, Path::new(""), Path::new(""), None, &args.common)
}

/// A job's text and overrides as settings.
pub fn settings(text: &str, name: &str, sets: &[String], folder: &Path) -> Result<Settings, Failure> {
    let load = |path: &str| files::read_text(&folder.join(path)).map_err(|f| f.message);
    parse_job(text, name, sets, &load).map_err(|e| Failure::usage(e.to_string()))
}

/// A job's settings, the file of its shape, and the folder its paths are relative to.
pub fn read_job(job: &Path, sets: &[String]) -> Result<(Settings, PathBuf, PathBuf), Failure> {
    let text = files::read_text(job)?;
    let folder = job.parent().map(Path::to_owned).unwrap_or_default();
    let name = job.display().to_string();
    let settings = settings(&text, &name, sets, &folder)?;
    let shape = &settings.shape;
    let given =
        [&shape.mesh, &shape.outline, &settings.ct.path].into_iter().chain(settings.photo.files.first());
    let Some(given) = given.into_iter().find(|p| !p.is_empty()) else {
        return Err(Failure::usage(format!(
            "{name}: [shape] needs mesh = \"FILE\", outline = \"FILE\", ct = \"SCAN\" or photo = {{ files = [\"FILE\"], ... }}"
        )));
    };
    let shape = folder.join(given);
    Ok((settings, shape, folder))
}

/// Plans and writes a job. `base` is what input paths are relative to, `out` output paths.
fn execute(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    out: &Path,
    truth: Option<&[Dimension]>,
    common: &Common,
) -> Result<(), Failure> {
    set_threads(common.threads)?;
    let diagnostics = progress::diagnostics();
    let paths = outputs::Paths::of(settings, shape, out)?;
    let (planned, read_s) = plan(settings, shape, base, &diagnostics)?;
    let report = outputs::write(settings, planned, &paths, read_s, common.json, truth, &diagnostics)?;
    // The progress line goes before anything is printed.
    drop(diagnostics);
    if common.json {
        files::print(&format!("{}\n", report.to_json()));
    } else {
        files::print(&format!("{}\n", report.summary()));
    }
    Ok(())
}

/// Reads a job's inputs and plans it; with the seconds that reading took.
pub fn plan(
    settings: &Settings,
    shape: &Path,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<(Planned, f64), Failure> {
    let path = shape.display().to_string();
    let start = std::time::Instant::now();
    let photos = read_photos(settings, base, diagnostics)?;
    let photos_s = start.elapsed().as_secs_f64();
    if !settings.photo.files.is_empty() {
        return Ok((grainpath::plan_photo(settings, &photos, diagnostics)?, photos_s));
    }
    if settings.ct.path.is_empty() {
        let (mesh, read_s) = read_body(settings, shape, diagnostics)?;
        let (stress, texture) = (read_stress(settings, base)?, read_texture(settings, base)?);
        let inputs = grainpath::Inputs { mesh, path, stress, photos, texture };
        return Ok((grainpath::plan_job(settings, inputs, diagnostics)?, read_s + photos_s));
    }
    let mut source = scan::open(shape, grainpath::run::config::raw_header(settings).as_ref())?;
    let (stress, texture) = (read_stress(settings, base)?, read_texture(settings, base)?);
    let read_s = start.elapsed().as_secs_f64();
    let planned = grainpath::plan_scan(settings, &mut *source, &path, stress, &photos, texture, diagnostics)?;
    Ok((planned, read_s))
}

/// Limits the threads, where asked for.
pub fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    let Some(n) = threads else { return Ok(()) };
    if n == 0 || n > 1024 {
        return Err(Failure::usage(format!("--threads {n} should be from 1 to 1024")));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build_global();
    pool.map_err(|e| Failure::usage(format!("--threads {n}: {e}")))
}

/// Reads a mesh, or the body of an outline where the job has one; its bodies and the seconds it took.
pub fn read_body(
    settings: &Settings,
    path: &Path,
    diagnostics: &Diagnostics,
) -> Result<(grainpath_io::MeshFile, f64), Failure> {
    let start = std::time::Instant::now();
    diagnostics.begin(Stage::Read, 0);
    let bytes = files::read(path)?;
    let shown = path.display().to_string();
    let file = if settings.shape.outline.is_empty() {
        parse_mesh(&bytes, Some(&shown)).map_err(|source| grainpath::Error::Mesh { path: shown, source })?
    } else {
        let outline = parse_outline(&bytes, &grainpath::run::config::outline(settings))
            .map_err(|source| grainpath::Error::Outline { path: shown.clone(), source })?;
        grainpath::shape::extruded(outline, grainpath::run::config::outline_thickness_mm(settings))
            .map_err(|source| grainpath::Error::Shape { path: shown, source })?
    };
    Ok((file, start.elapsed().as_secs_f64()))
}

/// The photographs whose grain the job follows; none when it follows none.
pub fn read_photos(
    settings: &Settings,
    base: &Path,
    diagnostics: &Diagnostics,
) -> Result<Vec<Photo>, Failure> {
    if settings.guide.kind != "grain" {
        return Ok(Vec::new());
    }
    diagnostics.begin(Stage::Read, 0);
    let own = if settings.image.files.is_empty() { &settings.photo.files } else { &settings.image.files };
    let read = |file: &String| {
        let path = base.join(file);
        let bytes = files::read(&path)?;
        let name = path.display().to_string();
        let image =
            decode_luma(&bytes).map_err(|source| grainpath::Error::Image { path: name.clone(), source })?;
        Ok(Photo::of(name, image))
    };
    own.iter().map(read).collect()
}

/// The scan named by `guide.volume`, where its texture is followed.
pub fn read_texture(settings: &Settings, base: &Path) -> Result<Option<Box<dyn SliceSource>>, Failure> {
    let path = &settings.volume.path;
    if settings.guide.kind != "grain" || path.is_empty() {
        return Ok(None);
    }
    scan::open(&base.join(path), None).map(Some)
}

/// The result named by `guide.import`.
pub fn read_stress(settings: &Settings, base: &Path) -> Result<Option<StressField>, Failure> {
    if settings.guide.import.is_empty() {
        return Ok(None);
    }
    let path = base.join(&settings.guide.import);
    let wrong = |e: FeError| Failure::input(format!("{}: {e}", path.display()));
    let bytes = files::read(&path)?;
    let file = parse_fe(&bytes, path.to_str()).map_err(wrong)?;
    let result = file.result(&grainpath::run::config::import(settings)).map_err(wrong)?;
    Ok(Some(StressField::new(result)))
}

/// `grainpath new`
pub fn new(args: &New) -> Result<(), Failure> {
    let names = grainpath_parts::presets::PRESETS;
    let example = match (args.preset.as_str(), args.pixels) {
        ("ct", Some(n)) => Some(grainpath_parts::presets::ct(n as usize)),
        (_, Some(_)) => return Err(Failure::usage("--pixels is for the preset ct")),
        (name, None) => grainpath_parts::presets::preset(name),
    };
    let Some(example) = example else {
        let near = grainpath_core::spelling::nearest(&args.preset, names);
        return Err(Failure::usage(format!(
            "no preset {:?}; did you mean {near:?}? There are {}",
            args.preset,
            names.join(", ")
        )));
    };
    let folder = args.dir.clone().unwrap_or_else(|| PathBuf::from(&args.preset));
    if let Some((name, _)) = example.iter().find(|(name, _)| folder.join(&**name).exists() && !args.force) {
        let there = folder.join(&**name);
        return Err(Failure::usage(format!("{} is there already; --force writes over it", there.display())));
    }
    for (name, content) in &example {
        let path = folder.join(&**name);
        files::write_atomically(&path, |w| {
            w.write_all(content).map_err(|e| Failure::usage(format!("cannot write {}: {e}", path.display())))
        })?;
    }
    files::print(&format!("grainpath run {}\n", folder.join(&*example[0].0).display()));
    Ok(())
}

/// `grainpath render`
pub fn render(args: &Render) -> Result<(), Failure> {
    use grainpath_view::layer::{ColourBy, PictureOptions, layer_png, layer_svg, thumbnail_png};
    let program = crate::inspect::read_program(&args.gcode)?;
    let n = program.layers.len();
    if n == 0 {
        return Err(Failure::input(format!("{}: nothing is printed in it", args.gcode.display())));
    }
    let output = args.output.clone().unwrap_or_else(|| args.gcode.with_extension("png"));
    let bytes = if args.part {
        let layers: Vec<_> = program.layers.iter().map(outputs::picture).collect();
        thumbnail_png(&layers, args.size, args.size * 3 / 4)
    } else {
        let layer = args.layer.unwrap_or(n.div_ceil(2));
        if layer == 0 || layer > n {
            return Err(Failure::usage(format!("--layer {layer} should be from 1 to {n}")));
        }
        let mut picture = outputs::picture(&program.layers[layer - 1]);
        if let Some(job) = &args.job {
            tell_directions(&mut picture, &program, job)?;
        }
        let options = PictureOptions {
            colour_by: ColourBy::from_name(&args.color).unwrap_or_default(),
            size_px: args.size,
            travels: !args.no_travels,
            window: None,
        };
        match output.extension().and_then(|e| e.to_str()) {
            Some("svg") => layer_svg(&picture, &options).into_bytes(),
            Some("png") => layer_png(&picture, &options),
            _ => {
                return Err(Failure::usage(format!(
                    "{}: a picture's name should end in .png or .svg",
                    output.display()
                )));
            }
        }
    };
    outputs::save(&output, &bytes)?;
    files::print(&format!("{}\n", output.display()));
    Ok(())
}

/// Tells fill how far it is off the direction that a job asks for. The program may be any slicer's: the middle of what it
/// prints is taken for the part's.
fn tell_directions(picture: &mut LayerPicture, program: &Program, job: &Path) -> Result<(), Failure> {
    let (settings, shape, folder) = read_job(job, &[])?;
    let diagnostics = progress::diagnostics();
    let (planned, _) = plan(&settings, &shape, &folder, &diagnostics)?;
    let Some(off) = grainpath::measure::report::direction_error(&planned) else {
        return Err(Failure::usage(format!(
            "{}: the job has no guide that asks for directions",
            job.display()
        )));
    };
    let printed = program.layers.iter().flat_map(|l| &l.beads).filter(|b| b.role.is_part());
    let printed = Bounds2::of(printed.flat_map(|b| [b.start(), b.end()]));
    let part = planned.stack.layers().iter().filter_map(|l| l.region().bounds()).reduce(Bounds2::union);
    let (Some(printed), Some(part)) = (printed, part) else { return Ok(()) };
    let shift = printed.centre() - part.centre();
    let z_mid = picture.z_mm - 0.5 * picture.height_mm;
    for bead in picture.beads.iter_mut().filter(|b| b.role.is_fill()) {
        bead.off_deg = off(z_mid, [bead.a - shift, bead.b - shift]).map(|found| found.0);
    }
    Ok(())
}

/// `grainpath markers`
pub fn markers(args: &Markers) -> Result<(), Failure> {
    use grainpath_imaging::photo::markers::{marker_sheet_pdf, marker_sheet_svg};
    let size = DVec2::new(args.width_mm, args.height_mm);
    if !(size.min_element() >= 20.0 && size.max_element() <= 2000.0) {
        return Err(Failure::usage(format!(
            "{} x {} mm: the rectangle between the markers should be 20 to 2000 mm wide and high",
            size.x, size.y
        )));
    }
    let bytes = match args.output.extension().and_then(|e| e.to_str()) {
        Some("svg") => marker_sheet_svg(size).into_bytes(),
        Some("pdf") => marker_sheet_pdf(size),
        _ => {
            let name = args.output.display();
            return Err(Failure::usage(format!("{name}: a sheet's name should end in .svg or .pdf")));
        }
    };
    outputs::save(&args.output, &bytes)?;
    files::print(&format!("{}\n", args.output.display()));
    Ok(())
}

/// `grainpath schema`
pub fn schema(args: &Schema) -> Result<(), Failure> {
    if args.markdown {
        files::print(&markdown());
    } else {
        files::print(&format!("{:#}\n", json_schema()));
    }
    Ok(())
}

/// `grainpath profiles`
pub fn profiles(args: &Profiles) -> Result<(), Failure> {
    if let Some(name) = &args.name {
        let Some(p) = PROFILES.iter().find(|p| p.name == name) else {
            let near = grainpath_core::spelling::nearest(name, PROFILES.iter().map(|p| p.name));
            return Err(Failure::usage(format!("no profile {name:?}; did you mean {near:?}?")));
        };
        let json = serde_json::json!({ "kind": p.kind, "name": p.name, "toml": p.text });
        files::print(&if args.json { format!("{json}\n") } else { p.text.to_owned() });
        return Ok(());
    }
    if args.json {
        let rows: Vec<_> = PROFILES
            .iter()
            .map(|p| serde_json::json!({ "kind": p.kind, "name": p.name, "about": p.about() }))
            .collect();
        files::print(&format!("{}\n", serde_json::json!({ "profiles": rows })));
    } else {
        let rows = PROFILES.iter().map(|p| format!("{:<9} {:<13} {}\n", p.kind, p.name, p.about()));
        files::print(&rows.collect::<String>());
    }
    Ok(())
}
