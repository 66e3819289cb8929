//! `grainpath inspect`: the kind of a file, its content, and its defects.

use std::convert::Infallible;
use std::path::Path;

use grainpath::run::config::limits;
use grainpath::shape::{Repair, mend_counting, united_volume};
use grainpath_core::math::atan2;
use grainpath_core::mesh::{MeshHealth, diagnose, weld_within};
use grainpath_core::slices::SampleType;
use grainpath_core::{DVec2, DVec3, Diagnostics, Warning, WarningId};
use grainpath_gcode::{Limits, Program, simulate};
use grainpath_imaging::metric::MetricImage;
use grainpath_imaging::photo::Photo;
use grainpath_imaging::photo::warp::Shrinking;
use grainpath_imaging::raster::Grey;
use grainpath_imaging::structure_tensor::{AxisGrid, TensorSettings, grain_axes};
use grainpath_io::directions::{DirectionOptions, DirectionSamples, sniff_directions};
use grainpath_io::fe::{FeError, FeFile, FeFormat, FeOptions, On, parse_fe, sniff_fe};
use grainpath_io::image::{decode, sniff_image, sniff_other_image};
use grainpath_io::volume::RawHeader;
use grainpath_io::{
    Image, MeshFile, MeshFormat, OutlineOptions, Samples, parse_mesh, parse_outline, sniff_exact_surfaces,
    sniff_mesh, sniff_outline,
};
use serde_json::{Value, json};

use super::{inspect_faces as faces, inspect_scan as scan};
use crate::args::Inspect;
use crate::claims::Claims;
use crate::inputs::{self, FILAMENT_MM};
use crate::{Failure, cad, files, outputs};

/// Runs the command.
pub(crate) fn inspect(args: &Inspect) -> Result<(), Failure> {
    let raw = scan::raw_header(args)?;
    let mut claims = Claims::default();
    claims.read("file", &args.file);
    args.truth.iter().for_each(|path| claims.read("--truth", path));
    args.sheet.iter().for_each(|path| claims.write("--sheet", path));
    args.image.iter().for_each(|path| claims.write("--image", path));
    claims.check()?;
    if args.faces {
        return faces::inspect(args);
    }
    let value = describe(args, raw.as_ref())?;
    files::print(&if args.json { format!("{value}\n") } else { table(&value) });
    Ok(())
}

/// Describes a file, as `--json` prints it. `size` is the number of voxels of raw data in x, y and z, `sample` their type.
///
/// # Errors
/// For a file that cannot be read.
pub fn inspect_file(file: &Path, size: Option<Vec<usize>>, sample: &str) -> Result<Value, Failure> {
    let (file, sample) = (file.to_owned(), sample.to_owned());
    let args = Inspect {
        file,
        sheet: None,
        truth: None,
        sets: Vec::new(),
        size,
        sample,
        json: true,
        faces: false,
        image: None,
    };
    describe(&args, scan::raw_header(&args)?.as_ref())
}

fn describe(args: &Inspect, raw: Option<&RawHeader>) -> Result<Value, Failure> {
    let refuse_printer = || match args.sets.first() {
        Some(set) => Err(Failure::usage(format!("--set {set} is of no use: only G-code has a printer"))),
        None => Ok(()),
    };
    let refused = || {
        Failure::usage(
            "--image draws the faces of a mesh (with --faces), the histogram of a scan, or the grain of a photograph",
        )
    };
    if is_vector_slicer(&args.file) {
        if args.image.is_some() {
            return Err(refused());
        }
        refuse_printer()?;
        let samples = inputs::directions(&args.file, &DirectionOptions::default())?;
        return Ok(directions_json(&args.file.display().to_string(), &samples));
    }
    // Scans before the other files: they can be larger than the memory, and all other kinds are read whole.
    if raw.is_some() || scan::is_scan(&args.file)? {
        refuse_printer()?;
        return scan::inspect(args, raw);
    }
    let bytes = files::read(&args.file)?;
    let name = args.file.display().to_string();
    let lower = name.to_ascii_lowercase();
    // G-code has no signature and may begin with a comment that looks like another format, so its name
    // decides.
    let named_gcode = [".gcode", ".g", ".gco", ".nc", ".bgcode"].iter().any(|e| lower.ends_with(e));
    let is_image = (sniff_image(&bytes).is_some() || sniff_other_image(&bytes).is_some()) && !named_gcode;
    // The option has no effect on other files, so it is refused instead of ignored.
    if args.image.is_some() && !is_image {
        return Err(refused());
    }
    // Formats with a signature are tried before those without. G-code, which any text can be, is the
    // last.
    let value = if !named_gcode && sniff_directions(&bytes, &name) {
        directions_json(&name, &inputs::directions(&args.file, &DirectionOptions::default())?)
    } else if sniff_outline(&bytes) && !named_gcode {
        outline_json(&name, &bytes)?
    } else if is_image {
        let image =
            decode(&bytes).map_err(|source| grainpath::Error::Image { path: name.clone(), source })?;
        let (mut value, grain) = image_json(&name, &image);
        value["guide_field"] = json!(scan::as_field(&bytes));
        if let Some(path) = &args.image {
            outputs::save(path, &grain.png())?;
            let told = "directions of the grain; yellow clear, violet unclear";
            value["image"] = json!(format!("{}: {told}", path.display()));
        }
        value
    } else if !named_gcode && let Some(format) = sniff_exact_surfaces(&bytes) {
        let file = cad::mesh(bytes, &name, &Diagnostics::default())?;
        let by =
            cad::gmsh_version().map_or(String::new(), |version| format!(", triangulated by gmsh {version}"));
        mesh_json(&name, &format!("{format}{by}"), &file)
    } else if !named_gcode && is_fe(&bytes, &name) {
        let file = parse_fe(&bytes, Some(&name)).map_err(|e| Failure::of_file(&args.file, e))?;
        fe_json(&name, &file)
    } else if named_gcode || (sniff_mesh(&bytes, Some(&name)).is_none() && !bytes.is_empty()) {
        if !named_gcode && is_raw(&bytes, &lower) {
            let types = SampleType::NAMES.join("|");
            return Err(Failure::of_file(
                &args.file,
                format!(
                    "voxels without a header? give --size COLUMNS,ROWS,SLICES and --sample {types} (in a job \
                     shape.ct.size_px and shape.ct.sample)"
                ),
            ));
        }
        let (filament_mm, limits) = printer(&args.sets)?;
        let program = simulate(&bytes, filament_mm, &limits);
        let program = program.map_err(|e| Failure::of_file(&args.file, e))?;
        let mut value = gcode_json(&name, &program);
        if let Some(path) = &args.truth {
            value["dimensions"] = dimensions(path, &program)?;
        }
        return Ok(value);
    } else {
        let file = parse_mesh(&bytes, Some(&name));
        let file = file.map_err(|source| grainpath::Error::Mesh { path: name.clone(), source })?;
        let format = sniff_mesh(&bytes, Some(&name)).map_or("mesh", MeshFormat::name);
        mesh_json(&name, format, &file)
    };
    refuse_printer()?;
    Ok(value)
}

/// Filament diameter and limits of the printer of a job with these settings; without any, those that programs are read with
/// where no job is known.
fn printer(sets: &[String]) -> Result<(f64, Limits), Failure> {
    if sets.is_empty() {
        return Ok((FILAMENT_MM, Limits::default()));
    }
    let settings = inputs::settings("", "--set", sets, Path::new(""))?;
    Ok((settings.printer.filament_mm, limits(&settings)))
}

/// Whether bytes without a known signature are binary. `lower` is the file's name in lower case.
fn is_raw(bytes: &[u8], lower: &str) -> bool {
    // Text holds no zero bytes; voxels in 16 bits nearly always do.
    [".raw", ".vol"].iter().any(|e| lower.ends_with(e)) || bytes.iter().take(65_536).any(|b| *b == 0)
}

fn dimensions(path: &Path, program: &Program) -> Result<Value, Failure> {
    let (text, name) = (files::read_text(path)?, path.display().to_string());
    let wrong = |e: grainpath::measure::dimensions::DimensionError| Failure::from(grainpath::Error::from(e));
    let truth = grainpath::measure::dimensions::parse(&text, &name).map_err(wrong)?;
    let shift = grainpath::measure::dimensions::shift_of(&text, &name, program).map_err(wrong)?;
    serde_json::to_value(grainpath::measure::dimensions::measure(&truth, program, shift))
        .map_err(|e| Failure::input(format!("{name}: {e}")))
}

/// Whether a folder was written by `vector_slicer` and holds matrices of directions.
fn is_vector_slicer(path: &Path) -> bool {
    ["thetaField.csv", "theta_field.csv", "xField.csv"].iter().any(|name| path.join(name).is_file())
}

fn directions_json(name: &str, samples: &DirectionSamples) -> Value {
    let s = samples.summary();
    let bounds = samples.bounds();
    let stated = |text: &str| if text.is_empty() { Value::Null } else { json!(text) };
    json!({
        "ok": true, "file": name, "kind": "directions", "format": s.format, "layout": s.layout,
        "samples": s.samples, "without_direction": s.without_direction, "directions": s.directions,
        "length_unit": stated(&s.length_unit), "axis_order": stated(&s.axis_order),
        "frame": "that of the part, unless the job sets guide.field.frame = \"plate\"",
        "strength": s.has_strength, "spacing": s.has_spacing,
        "low_mm": bounds.map(|b| b.0.to_array()), "high_mm": bounds.map(|b| b.1.to_array()),
        "warnings": samples.warnings(),
    })
}

fn mesh_json(name: &str, format: &str, file: &MeshFile) -> Value {
    let all: Vec<MeshHealth> = file.bodies.iter().filter_map(|b| diagnose(&b.mesh)).collect();
    let sum = |f: &dyn Fn(&MeshHealth) -> usize| all.iter().map(f).sum::<usize>();
    let Inspected { volume, volume_problem, bounds, stray_shells, warnings: told } = inspected(file);
    // Of a mesh that cannot be mended, the size is that of everything in the file.
    let read = all.iter().map(|h| h.bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = bounds.or(read).unwrap_or_default();
    let open = sum(&|h| h.open_edges);
    // Open edges may be mere seams, which close when vertices within a millionth of the size are merged.
    // Edges that are still open after merging belong to holes.
    let tolerance = 1e-6 * (high - low).max_element();
    let open_after = if open == 0 {
        0
    } else {
        file.bodies
            .iter()
            .filter_map(|b| {
                let Ok(welded) = weld_within(&b.mesh, tolerance, || Ok::<(), Infallible>(()));
                diagnose(&welded)
            })
            .map(|h| h.open_edges)
            .sum()
    };
    let likely = match file.unit {
        Some(unit) => format!("{} (the file says so)", unit.name()),
        None => by_size((high - low).max_element()),
    };
    let mut warnings = file.warnings.clone();
    warnings.extend(told);
    json!({
        "ok": true, "file": name, "kind": "mesh", "format": format,
        "bodies": file.bodies.len(), "triangles": sum(&|h| h.n_triangles), "vertices": sum(&|h| h.n_vertices),
        "shells": sum(&|h| h.shells), "stray_shells": stray_shells, "open_edges": open, "open_edges_after_merging": open_after,
        "nonmanifold_edges": sum(&|h| h.nonmanifold_edges), "badly_wound_edges": sum(&|h| h.badly_wound_edges),
        "zero_area_facets": sum(&|h| h.zero_area_facets), "closed": all.iter().all(MeshHealth::is_closed),
        "volume": volume, "volume_problem": volume_problem,
        "extents": (high - low).to_array(), "low": low.to_array(), "high": high.to_array(),
        "likely_unit": likely, "warnings": warnings,
    })
}

/// The likely unit of a mesh whose file states none, and what slicing takes where that is another.
fn by_size(longest: f64) -> String {
    let (likely, taken) = (grainpath::shape::likely_unit(longest), grainpath::shape::assumed_unit(longest));
    let but = if likely == taken {
        String::new()
    } else {
        format!("; slicing takes {} unless shape.unit = \"{}\"", taken.name(), likely.name())
    };
    format!("{} (by its size{but})", likely.name())
}

/// What mending a mesh shows, in the unit of the file.
#[derive(Default)]
struct Inspected {
    /// Volume in the cube of the unit; `None` for a surface that is not closed.
    volume: Option<f64>,
    /// What was assumed for the volume, or the reason if there is none.
    volume_problem: Option<String>,
    /// Lowest and highest corner of the part, without stray shells.
    bounds: Option<(DVec3, DVec3)>,
    /// Number of shells without volume beside the part.
    stray_shells: usize,
    /// The warning of slicing about them.
    warnings: Vec<Warning>,
}

/// Share by which the volume of the united bodies must differ from the sum of volumes to be told instead of it.
/// Source: derived; it is the error of `united_volume`.
const UNITED_SHARE: f64 = 0.005;

/// The volume and the size of a mesh. As in slicing, shells without volume are left out, and facets and shells that are
/// inside out are turned first.
fn inspected(file: &MeshFile) -> Inspected {
    let bodies = file.bodies.iter().map(|b| b.mesh.clone()).collect();
    let diagnostics = Diagnostics::default();
    let (mended, changed) = match mend_counting(bodies, Repair::Auto, &diagnostics) {
        Ok(found) => found,
        Err(e) => return Inspected { volume_problem: Some(e.to_string()), ..Inspected::default() },
    };
    let told = diagnostics.warnings().into_iter().filter(|w| w.id == WarningId::MeshStray);
    let mut found = Inspected {
        bounds: mended.bounds(),
        stray_shells: changed.stray_shells,
        warnings: told.collect(),
        ..Inspected::default()
    };
    let health = diagnose(&mended);
    let shells_left = health.as_ref().map_or(0, |h| h.shells);
    let n_open = health.map_or(0, |h| h.open_edges);
    if n_open > 0 {
        let text =
            format!("none: the surface is not closed ({n_open} open edges); slicing closes each section");
        found.volume_problem = Some(text);
        return found;
    }
    let volume = mended.signed_volume();
    let text =
        "facets or shells are inside out; slicing turns them, and this is the volume after they are turned";
    found.volume = Some(volume);
    found.volume_problem = (changed.turned > 0).then(|| text.to_owned());
    // Sections are cut only where bodies can overlap at all.
    if shells_left > 1 {
        let united = united_volume(&mended);
        if volume - united > UNITED_SHARE * volume {
            let also = found.volume_problem.map_or_else(String::new, |turned| format!("; {turned}"));
            let text = format!(
                "bodies overlap; slicing unites them, and this is the volume of their union to 0.5 % (their sum is {}){also}",
                digits(volume)
            );
            (found.volume, found.volume_problem) = (Some(united), Some(text));
        }
    }
    found
}

fn outline_json(name: &str, bytes: &[u8]) -> Result<Value, Failure> {
    // The default tolerance of `shape.outline`: the counts then equal those of a job with default settings.
    let options = OutlineOptions { unit: None, tolerance_mm: 0.005, even_odd: false };
    let outline = parse_outline(bytes, &options);
    let outline = outline.map_err(|source| grainpath::Error::Outline { path: name.to_owned(), source })?;
    let bounds = outline.region.bounds();
    let round = |v: f64| (v * 1e4).round() / 1e4;
    Ok(json!({
        "ok": true, "file": name, "kind": "outline", "pieces": outline.region.polygons.len(),
        "holes": outline.region.polygons.iter().map(|p| p.holes.len()).sum::<usize>(),
        "vertices": outline.region.n_vertices(), "area_mm2": round(outline.region.area_mm2()),
        "low_mm": bounds.map(|b| b.min.to_array().map(round)), "high_mm": bounds.map(|b| b.max.to_array().map(round)),
        "warnings": outline.warnings,
    }))
}

fn image_json(name: &str, image: &Image) -> (Value, Grain) {
    let photo = Photo::from_image(name.to_owned(), image.clone());
    let grey = photo.whole();
    let round = |v: f32| (f64::from(v) * 1e3).round() / 1e3;
    let sample = match image.samples {
        Samples::U8(_) => "8 bit",
        Samples::U16(_) => "16 bit",
        Samples::F32(_) => "float or 32 bit",
    };
    let grain = Grain::of(&grey);
    let value = json!({
        "ok": true, "file": name, "kind": "image", "format": image.format.name(),
        "width": image.width, "height": image.height, "channels": image.channels, "samples": sample,
        // The darkest and brightest 1 % are left out: dust and highlights would hide that a picture has
        // low contrast.
        "darkest": round(grey.quantile(0.01)), "median": round(grey.quantile(0.5)),
        "brightest": round(grey.quantile(0.99)),
        "grain": grain.json(),
    });
    (value, grain)
}

/// The grain that a plan would follow. The size of the board is unknown here, so lengths are pixels of a picture with at
/// most [`GRAIN_PX`] on its longer side.
struct Grain {
    picture: MetricImage,
    axes: AxisGrid,
}

impl Grain {
    fn of(grey: &Grey) -> Self {
        let mut small = grey.clone();
        while small.width.max(small.height) > GRAIN_PX && small.width.min(small.height) > 32 {
            small = small.halved();
        }
        // Rows of a photograph start at the top; they are flipped so that the axis counts counter-clockwise from x.
        let upright = Grey::from_fn(small.width, small.height, |x, y| small.at(x, small.height - 1 - y));
        let picture = MetricImage { grey: upright, min_mm: DVec2::ZERO, px_mm: 1.0 };
        // The two scales have the same ratio as their defaults in a job, 0.12 and 0.6 mm.
        let axes =
            grain_axes(&picture, &TensorSettings { gradient_mm: 1.0, integration_mm: 5.0, smooth_mm: 5.0 });
        Self { picture, axes }
    }

    /// A picture of it.
    fn png(&self) -> Vec<u8> {
        grainpath_view::grain::axes_png(&self.picture, &self.axes)
    }

    /// Its mean axis, its coherence, and the share of the picture where it is clear.
    fn json(&self) -> Value {
        let axes = &self.axes;
        let weight = axes.coherence.iter().map(|&c| f64::from(c));
        let sum = axes
            .double
            .iter()
            .zip(weight.clone())
            .fold(DVec2::ZERO, |sum, ([c, s], w)| sum + w * DVec2::new(f64::from(*c), f64::from(*s)));
        let total: f64 = weight.sum();
        let round = |v: f64| (v * 100.0).round() / 100.0;
        let axis_deg = (0.5 * atan2(sum.y, sum.x)).to_degrees().rem_euclid(180.0);
        json!({
            "axis_deg": (axis_deg * 10.0).round() / 10.0,
            "same_direction": round(if total > 0.0 { sum.length() / total } else { 0.0 }),
            "coherence": round(axes.mean_coherence()),
            "clear_share": round(axes.clear_share(0.3)),
        })
    }
}

/// Longer side of the picture that the grain is read from, pixels. Source: derived. A board 100 mm wide has growth rings
/// 1 mm apart or more, which is six pixels.
const GRAIN_PX: usize = 640;

/// Whether a file is a finite-element mesh or result. A table must have the ending `.csv`, since
/// G-code may begin like a table.
fn is_fe(bytes: &[u8], name: &str) -> bool {
    sniff_fe(bytes, Some(name))
        .is_some_and(|f| f != FeFormat::Csv || name.to_ascii_lowercase().ends_with(".csv"))
}

fn fe_json(name: &str, file: &FeFile) -> Value {
    let (low, high) = file.bounds().unwrap_or_default();
    let size = (high - low).max_element();
    let counts = |rows: &mut dyn Iterator<Item = (String, usize)>| -> Value {
        Value::Object(rows.map(|(k, n)| (k, json!(n))).collect())
    };
    let elements = counts(&mut file.kinds().into_iter().map(|(k, n)| (k.name().to_owned(), n)));
    let left_out = counts(&mut file.left_out.iter().cloned());
    let mut arrays: Vec<String> = Vec::new();
    for a in &file.arrays {
        let on = if a.on == On::Nodes { "nodes" } else { "elements" };
        let step = a.step.map_or(String::new(), |s| format!(", step {s}"));
        let parts = if a.component_names.is_empty() {
            String::new()
        } else {
            format!(": {}", a.component_names.join(" "))
        };
        arrays.push(format!("{} ({} on {on}{step}{parts})", a.name, a.components));
    }
    let groups: Vec<String> =
        file.groups.iter().map(|g| format!("{} ({} nodes)", g.name, g.nodes.len())).collect();
    let mut value = json!({
        "ok": true, "file": name, "kind": "fe", "format": file.format.name(),
        "nodes": file.nodes.len(), "elements": elements, "left_out": left_out,
        "extents": (high - low).to_array(), "low": low.to_array(), "high": high.to_array(),
        "likely_unit": format!("{} (by its size)", grainpath::shape::likely_unit(size).name()),
        "arrays": arrays, "groups": groups,
    });
    let mut warnings = file.warnings.clone();
    match file.result(&FeOptions::default()) {
        Ok(result) => {
            let peak = result.max_von_mises_mpa();
            value["stress"] = json!(result.stress_array);
            value["plane"] = json!(result.plane);
            value["max_von_mises"] = json!((peak * 1e6).round() / 1e6);
            value["likely_stress_unit"] =
                // No common plastic or metal withstands 10 GPa, so a larger number must be in Pa.
                json!(if peak > 1e4 { "Pa (by its size)" } else { "MPa (by its size)" });
            if let Some(u) = &result.displacement {
                let longest = u.iter().map(|u| u.length()).filter(|l| l.is_finite()).fold(0.0, f64::max);
                value["max_displacement"] = json!(longest);
            }
            warnings = result.warnings;
        }
        // A mesh without stress is a valid file: its stress is simply left out of the answer.
        Err(FeError::NoStress { .. }) => {}
        Err(e) => warnings.push(Warning::new(WarningId::FeLeftOut, e.to_string())),
    }
    if let Some(deck) = &file.deck {
        let materials: Vec<String> = deck.materials.iter().map(|m| m.name.clone()).collect();
        let sum = |f: &dyn Fn(&grainpath_io::fe::Step) -> usize| deck.steps.iter().map(f).sum::<usize>();
        value["materials"] = json!(materials);
        value["steps"] = json!(deck.steps.len());
        value["fixed"] = json!(deck.fixed.len() + sum(&|s| s.fixed.len()));
        value["loads"] = json!(sum(&|s| s.point_loads.len() + s.face_loads.len() + s.body_loads.len()));
    }
    value["warnings"] = json!(warnings);
    value
}

fn gcode_json(name: &str, p: &Program) -> Value {
    let heights: Vec<f64> = p.layers.iter().map(|l| l.height_mm).collect();
    let mut sorted = heights.clone();
    sorted.sort_by(f64::total_cmp);
    let round = |v: f64| (v * 1e3).round() / 1e3;
    json!({
        "ok": true, "file": name, "kind": "gcode", "generator": p.generator,
        "commands": p.commands, "arcs": p.arcs, "layers": p.layers.len(),
        "z_max_mm": p.layers.last().map_or(0.0, |l| l.z_mm),
        // The median is used because the first layer and variable heights would shift a mean.
        "layer_height_mm": sorted.get(sorted.len() / 2).copied().map(round),
        "printed_mm": round(p.printed_mm), "travel_mm": round(p.travel_mm), "extruded_mm3": round(p.extruded_mm3),
        "filament_mm": round(p.filament_mm), "retractions": p.retractions, "time_s": round(p.time_s),
        "paths_per_layer_max": p.layers.iter().map(|l| l.paths).max(),
        "nozzle_temp_c": p.nozzle_temp_c, "bed_temp_c": p.bed_temp_c,
        "fibre": fibre_json(p), "thumbnails": p.thumbnails, "warnings": p.warnings,
    })
}

/// Length, pieces, cuts and radii of the fibre in a program; null for programs without fibre.
fn fibre_json(p: &Program) -> Value {
    let fibre = grainpath::measure::laid_fibre::measure(p, DVec2::ZERO, 0.0, 0.0, None);
    if fibre.layers.is_empty() {
        return Value::Null;
    }
    json!({
        "length_mm": fibre.length_mm, "pieces": fibre.pieces, "cuts": fibre.cuts,
        "layers": fibre.layers.len(), "min_radius_mm": fibre.min_radius_mm,
        "shortest_mm": fibre.layers.iter().map(|l| l.shortest_mm).fold(f64::INFINITY, f64::min),
    })
}

/// Keys that the table shows under another name. Lengths of a mesh are in its own unit, shown in the row `likely unit`.
const NAMES: [(&str, &str); 4] = [
    ("volume", "volume (cubic units)"),
    ("extents", "size (units)"),
    ("low", "low corner (units)"),
    ("high", "high corner (units)"),
];
/// Keys that are not rows of the table: the exit code replaces `ok`, and the warnings are printed below the table.
const ELSEWHERE: [&str; 2] = ["ok", "warnings"];

/// The answer as text: a line for each key and value, then the warnings in the format of the other commands.
fn table(value: &Value) -> String {
    let Some(rows) = value.as_object() else { return String::new() };
    let name = |key: &str| {
        let own = NAMES.iter().find(|(k, _)| *k == key);
        own.map_or_else(|| key.replace('_', " "), |(_, name)| (*name).to_owned())
    };
    let line = |(k, v): (&String, &Value)| format!("{:<26} {}\n", name(k), shown(v));
    // Empty values are left out of the table for people; JSON keeps them, since programs expect the keys.
    let skip = |v: &Value| {
        v.is_null() || v.as_array().is_some_and(Vec::is_empty) || v.as_object().is_some_and(|o| o.is_empty())
    };
    let mut text: String =
        rows.iter().filter(|(k, v)| !ELSEWHERE.contains(&k.as_str()) && !skip(v)).map(line).collect();
    for warning in rows.get("warnings").and_then(Value::as_array).into_iter().flatten() {
        match warning["text"].as_str() {
            Some(told) => {
                let id = warning["id"].as_str().unwrap_or_default();
                text += &format!("warning: {told} [{id}]\n");
                if let Some(remedy) = warning["remedy"].as_str() {
                    text += &format!("  remedy: {remedy}\n");
                }
            }
            None => text += &format!("warning: {}\n", shown(warning)),
        }
    }
    text
}

/// A value as text, numbers with six digits: no input of grainpath is measured more precisely.
fn shown(value: &Value) -> String {
    match value {
        Value::String(s) => s.clone(),
        Value::Bool(true) => "yes".to_owned(),
        Value::Bool(false) => "no".to_owned(),
        Value::Number(n) if n.is_f64() => digits(n.as_f64().unwrap_or_default()),
        Value::Array(a) if a.iter().all(Value::is_string) => {
            a.iter().filter_map(Value::as_str).map(|s| format!("\n  {s}")).collect()
        }
        // A scan may state the distance of its pixels without that of its slices.
        Value::Null => "not stated".to_owned(),
        Value::Array(a) if a.iter().all(Value::is_null) => "not stated".to_owned(),
        Value::Array(a) => a.iter().map(shown).collect::<Vec<_>>().join("  "),
        Value::Object(o) => o
            .iter()
            .map(|(k, v)| format!("{} {}", k.replace('_', " "), shown(v)))
            .collect::<Vec<_>>()
            .join(", "),
        other => other.to_string(),
    }
}

/// A number with six significant digits; powers of ten where it is very small or large.
fn digits(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e9).contains(&size) {
        return format!("{number:.5e}");
    }
    // As many decimals as make six digits in all; the digits before the point are never cut.
    let decimals = (5 - size.max(1e-4).log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::TriMesh;
    use grainpath_io::MeshBody;

    /// A cube of side 1 at a place; turned inside out where asked.
    fn cube(x: f64, inverted: bool) -> TriMesh {
        let corner = |i: i32| DVec3::new(x + f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut triangles: Vec<[u32; 3]> =
            quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        if inverted {
            triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        TriMesh { vertices: (0..8).map(corner).collect(), triangles }
    }

    fn file(meshes: Vec<TriMesh>) -> MeshFile {
        let bodies = meshes.into_iter().map(|mesh| MeshBody { mesh, ..MeshBody::default() }).collect();
        MeshFile { bodies, unit: None, modifiers: Vec::new(), warnings: Vec::new() }
    }

    #[test]
    fn people_read_six_digits_and_no_json() {
        for (number, text) in [
            (38.641143798828125, "38.6411"),
            (3013.32599007147, "3013.33"),
            (3.013325951231324e-6, "3.01333e-6"),
            (0.4, "0.4"),
            (20.0, "20"),
            (-0.0, "0"),
            (123_456_789.0, "123456789"),
        ] {
            assert_eq!(digits(number), text);
        }
        let value = json!({ "ok": true, "closed": true, "low_mm": [0.0, 1.5], "world": { "frame": "LPS" },
            "warnings": [{ "id": "field-assumed", "text": "the order was assumed", "remedy": "set axes" }] });
        assert_eq!(
            table(&value).lines().map(str::trim).collect::<Vec<_>>(),
            [
                "closed                     yes",
                "low mm                     0  1.5",
                "world                      frame LPS",
                "warning: the order was assumed [field-assumed]",
                "remedy: set axes"
            ]
        );
    }

    #[test]
    fn the_volume_is_that_of_the_part_or_none() {
        let volume = |f: &MeshFile| {
            let Inspected { volume, volume_problem, .. } = inspected(f);
            (volume, volume_problem)
        };
        let (volume_of_two, problem) = volume(&file(vec![cube(0.0, false), cube(3.0, false)]));
        assert!(volume_of_two.is_some_and(|v| (v - 2.0).abs() < 1e-12) && problem.is_none());
        for inverted in [vec![cube(0.0, true)], vec![cube(0.0, false), cube(3.0, true)]] {
            let n = inverted.len() as f64;
            let (found, problem) = volume(&file(inverted));
            assert!(found.is_some_and(|v| (v - n).abs() < 1e-12), "{found:?}");
            assert!(problem.is_some_and(|p| p.contains("inside out")));
        }
        let mut open = cube(0.0, false);
        open.triangles.truncate(11);
        let (found, problem) = volume(&file(vec![open]));
        assert!(found.is_none() && problem.is_some_and(|p| p.contains("3 open edges")));
        // Bodies that overlap, and a body with a cavity, both right and inside out.
        let inner = |inverted: bool| {
            let mut small = cube(0.0, inverted);
            small.vertices.iter_mut().for_each(|p| *p = 0.25 + 0.5 * *p);
            small
        };
        for inverted in [false, true] {
            for (other, expected) in [(cube(0.5, inverted), 1.5), (inner(!inverted), 1.0 - 0.125)] {
                for bodies in [vec![cube(0.0, inverted), other.clone()], vec![other, cube(0.0, inverted)]] {
                    let mut one = TriMesh::default();
                    for body in &bodies {
                        let first = one.vertices.len() as u32;
                        one.vertices.extend(&body.vertices);
                        one.triangles.extend(body.triangles.iter().map(|t| t.map(|i| i + first)));
                    }
                    let (found, _) = volume(&file(vec![one]));
                    let found = found.expect("a volume");
                    assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn facets_beside_a_body_are_counted_and_change_neither_size_nor_volume() {
        let mut mesh = cube(0.0, false);
        for i in 0..50 {
            let at = DVec3::new(f64::from(i), 4.0, -7.0);
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend([at, at + 0.1 * DVec3::X, at + 0.1 * DVec3::ONE]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        let value = mesh_json("part.stl", "binary STL", &file(vec![mesh]));
        assert_eq!((&value["stray_shells"], &value["shells"]), (&json!(50), &json!(51)));
        assert_eq!(value["extents"], json!([1.0, 1.0, 1.0]));
        assert!(value["volume"].as_f64().is_some_and(|v| (v - 1.0).abs() < 1e-12), "{value}");
        assert_eq!(value["warnings"][0]["id"], "mesh-stray");
        assert!(value["volume_problem"].is_null(), "nothing is turned: {value}");
    }
}
