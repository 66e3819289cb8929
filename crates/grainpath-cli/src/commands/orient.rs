//! `grainpath orient`: ranks the stable poses of a part by the loads that it carries in them.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use grainpath::orient::{self, BeadDirections, Pose, PoseReserve};
use grainpath::run::config;
use grainpath::run::placed_mesh;
use grainpath::shape::Standing;
use grainpath::support;
use grainpath_core::diagnostics::Stage;
use grainpath_core::units::bead_area_mm2;
use grainpath_core::{DMat3, DVec3, Diagnostics, TriMesh};
use grainpath_io::MeshFile;
use grainpath_job::choices::{FieldFrame, GuideKind, LoadFrame, SupportStyle};
use grainpath_job::edit::with_value;
use grainpath_job::regions::RegionPlace;
use grainpath_job::{JobRegion, Settings};
use grainpath_view::poses::{PosePicture, poses_png};
use serde_json::{Value, json};

use crate::args::Orient;
use crate::claims::Claims;
use crate::commands::run::checked;
use crate::commands::support::supported;
use crate::inputs::{Given, Handed, claim_inputs, read_body, read_job, set_threads, settings as settings_of};
use crate::{ExitCode, Failure, files, outputs, progress};

/// Most poses that are ranked. Source: derived. A usual printed part has six to ten stable poses, and supports are grown
/// for each.
const MOST_POSES: usize = 10;

/// A pose and the values by which it is ranked.
#[derive(Debug)]
struct Ranked {
    rotate_deg: [f64; 3],
    /// The factor on the loads at which the part first fails; `None` if it cannot be computed.
    reserve: Option<PoseReserve>,
    /// Mass of the supports that the pose needs.
    support_g: f64,
    height_mm: f64,
    /// Printing time of part and supports at the speed of solid infill, without travels.
    time_s: f64,
    /// Area of the flat that the part stands on, and the angle by which it can be tilted before it falls.
    flat_mm2: f64,
    tilt_deg: f64,
    /// Only where pictures are asked for.
    picture: Option<PosePicture>,
}

impl Ranked {
    fn json(&self) -> Value {
        let mut value = json!({
            "rotate_deg": self.rotate_deg, "support_g": self.support_g, "height_mm": self.height_mm,
            "time_s": self.time_s, "flat_mm2": self.flat_mm2, "tilt_deg": self.tilt_deg,
        });
        if let Some(reserve) = &self.reserve {
            value["reserve"] = json!(reserve);
        }
        value
    }
}

/// `grainpath orient`
pub(crate) fn orient(args: &Orient) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    let (settings, shape, folder) = read_job(&args.job, &args.common.sets)?;
    let mut claims = Claims::default();
    claims.read("job", &args.job);
    claim_inputs(&settings, &shape, &folder, &mut claims);
    if let Some(image) = &args.image {
        claims.write("--image", image);
    }
    claims.check()?;
    let diagnostics = progress::diagnostics();
    let (mut ranked, standing, solve_s) =
        ranked(&settings, Given::default(), &shape, &folder, args.image.is_some(), &diagnostics)?;
    let warnings = diagnostics.warnings();
    drop(diagnostics);
    args.common.refuse(&warnings, false)?;
    let mut written = BTreeMap::new();
    if let Some(image) = &args.image {
        let pictures: Vec<PosePicture> = ranked.iter_mut().filter_map(|r| r.picture.take()).collect();
        if let Some(png) = poses_png(&pictures) {
            outputs::save(image, &png)?;
            written.insert("image", image.display().to_string());
        }
    }
    let mut refused = None;
    if args.write {
        match turned_job(&files::read_text(&args.job)?, &settings, &standing, ranked[0].rotate_deg, &folder) {
            Ok(text) => {
                outputs::save(&args.job, text.as_bytes())?;
                written.insert("job", args.job.display().to_string());
            }
            Err(why) => refused = Some(Failure::usage(format!("{}: {why}", args.job.display()))),
        }
    }
    if args.common.json && refused.is_none() {
        let mut value = json!({
            "ok": true, "version": env!("CARGO_PKG_VERSION"), "poses": ranked.iter().map(Ranked::json).collect::<Vec<_>>(),
            "stages_s": { "guide": (solve_s * 1e4).round() / 1e4 }, "warnings": warnings,
        });
        if !written.is_empty() {
            value["outputs"] = json!(written);
        }
        files::print(&format!("{value}\n"));
    } else if !args.common.json {
        let mut text = table(&ranked);
        warnings.iter().for_each(|w| text.push_str(&format!("warning: {w}\n")));
        written.iter().for_each(|(what, path)| text.push_str(&format!("{what}: {path}\n")));
        files::print(&text);
    }
    refused.map_or(Ok(()), Err)
}

/// The text of a job with its part turned, and its loads with it. Loads that are given in the frame of the plate become
/// loads in the frame of the part where their numbers mean the same in both.
///
/// # Errors
/// What to write by hand.
fn turned_job(
    text: &str,
    settings: &Settings,
    standing: &Standing,
    rotate_deg: [f64; 3],
    folder: &Path,
) -> Result<String, String> {
    // What `--set` gives is not in the file.
    let own = settings_of(text, "job", &[], folder);
    let settings = own.as_ref().unwrap_or(settings);
    let is_placed = has_places(settings) && settings.guide.frame == LoadFrame::Placed;
    let staying = places_of_plate(settings);
    if rotate_deg != settings.shape.rotate_deg && !staying.is_empty() {
        return Err(format!(
            "--write would turn the part but not {}, in coordinates of the plate; give their places in the pose, and add \
             shape.rotate_deg = {rotate_deg:?}",
            staying.join(", ")
        ));
    }
    if is_placed && !(standing.is_as_in_file() && standing.shift() == DVec3::ZERO) {
        return Err(format!(
            "--write would turn the part but not its loads; give their coordinates as in the shape's file, and add \
             guide.frame = \"part\" and shape.rotate_deg = {rotate_deg:?}"
        ));
    }
    let [x, y, z] = rotate_deg;
    let turned = with_value(text, "shape", "rotate_deg", &format!("[{x}, {y}, {z}]"));
    let turned = match turned {
        Some(text) if is_placed => with_value(&text, "guide", "frame", "\"part\""),
        turned => turned,
    };
    let is_read = |text: &String| {
        settings_of(text, "job", &[], folder).is_ok_and(|s| {
            s.shape.rotate_deg == rotate_deg && (!is_placed || s.guide.frame == LoadFrame::Part)
        })
    };
    turned.filter(is_read).ok_or_else(|| {
        let (table, frame) =
            if is_placed { (" or [guide]", " and guide.frame = \"part\"") } else { ("", "") };
        format!("there is no line [shape]{table} to write below; add shape.rotate_deg = {rotate_deg:?}{frame} by hand")
    })
}

/// The poses of a job's part, the best first, as `grainpath orient --json` prints them. The part is read from the job's
/// file if it is not given.
///
/// # Errors
/// [`Failure`] if the part is neither a mesh nor an outline, has no flat to stand on, or its loads cannot be solved.
pub fn poses_json(
    settings: &Settings,
    given: Given,
    shape: &Path,
    folder: &Path,
    diagnostics: &Diagnostics,
) -> Result<Vec<Value>, Failure> {
    let (ranked, ..) = ranked(settings, given, shape, folder, false, diagnostics)?;
    Ok(ranked.iter().map(Ranked::json).collect())
}

/// The poses of a job's part, the best first, with their pictures if `pictured`; where the part stands in the job; and the
/// seconds that solving the loads took. Without fixtures and loads, poses are ranked by support and height.
fn ranked(
    settings: &Settings,
    given: Given,
    shape: &Path,
    folder: &Path,
    pictured: bool,
    diagnostics: &Diagnostics,
) -> Result<(Vec<Ranked>, Standing, f64), Failure> {
    let needed = || Failure::usage("orient needs a part from a mesh or an outline");
    let file = match given.shape {
        Some(Handed::Mesh(file)) => file,
        Some(Handed::Scan(_) | Handed::Layers(_)) => return Err(needed()),
        None if settings.shape.mesh.is_empty() && settings.shape.outline.is_empty() => return Err(needed()),
        None => read_body(settings, shape, diagnostics)?.0,
    };
    let start = Instant::now();
    // The part is needed again for its poses, so the solver gets a copy.
    let known = given.known;
    let given = || Given { shape: Some(Handed::Mesh(file.clone())), known, ..Given::default() };
    let guide = if is_loaded(settings) {
        Some(checked(settings, given(), shape, folder, diagnostics)?)
    } else {
        None
    };
    let solve_s = start.elapsed().as_secs_f64();
    let source = |source| grainpath::Error::Shape { path: shape.display().to_string(), source };
    let placed = placed_mesh(&config::placing(settings), file.clone(), diagnostics).map_err(source)?;
    let standing = config::standing(settings, placed.lowered_mm);
    let poses = orient::poses(&placed.mesh, standing.rotation.transpose(), MOST_POSES).map_err(|e| {
        Failure { code: ExitCode::Physics, ..Failure::usage(format!("{}: {e}", shape.display())) }
    })?;
    let strength = config::strength(settings);
    let beads = beads(settings);
    let lowest = |rotation: DMat3, mesh: &TriMesh| {
        mesh.vertices.iter().fold(DVec3::INFINITY, |low, p| low.min(rotation * *p))
    };
    let mut ranked = Vec::with_capacity(poses.len());
    diagnostics.begin(Stage::Support, poses.len());
    for pose in poses {
        let reserve = |guide| orient::reserve(guide, pose.rotation(), &beads, &strength);
        let reserve = guide.as_ref().map(reserve).transpose().map_err(grainpath::Error::from)?.flatten();
        let (settings, file, name) = (settings.clone(), file.clone(), shape.display().to_string());
        // The part was solved as it stands in the job; its pose is moved so that it stands on the plate.
        let fails_at = |r: &PoseReserve| {
            let rotation = pose.rotation();
            rotation * DVec3::from_array(r.at_mm) - lowest(rotation, &placed.mesh)
        };
        let pictured = pictured.then(|| reserve.as_ref().map(fails_at));
        let rank = move || ranked_pose(settings, &pose, reserve, file, &name, pictured);
        ranked.push(diagnostics.leave_at_stop(rank).map_err(grainpath::Error::from)??);
        diagnostics.advance(1);
    }
    let key = |r: &Ranked| {
        let nominal = r.reserve.as_ref().map(|r| r.first_failure[1]);
        orient::rank(nominal, r.support_g, r.height_mm, r.time_s)
    };
    // The sort is stable: poses of equal rank stay sorted by the flat they stand on.
    ranked.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
    Ok((ranked, standing, solve_s))
}

/// Whether a job has fixtures, loads or load cases of its own, those of a deck, or a stress result.
fn is_loaded(settings: &Settings) -> bool {
    let guide = &settings.guide;
    has_places(settings) || !guide.deck.is_empty() || !guide.import.is_empty()
}

/// Whether a job has fixtures, loads or load cases of its own, whose places are in `guide.frame`. Those of decks and results
/// are in the frame of the part.
fn has_places(settings: &Settings) -> bool {
    let guide = &settings.guide;
    !guide.fixture.is_empty() || !guide.load.is_empty() || !guide.case.is_empty()
}

/// The settings whose places stay where they are on the plate when the part is turned.
fn places_of_plate(settings: &Settings) -> Vec<String> {
    let of_region = |(k, region): (usize, &JobRegion)| match region.on {
        RegionPlace::Box { .. } => Some(format!("region[{}].on.box_mm", k + 1)),
        RegionPlace::Layers(_) => Some(format!("region[{}].on.layers", k + 1)),
        RegionPlace::Mesh(_) | RegionPlace::Face { .. } => None,
    };
    let (support, fibre) = (&settings.support, &settings.fibre);
    let others = [
        ("support.enforce_mm", !support.enforce_mm.is_empty()),
        ("support.block_mm", !support.block_mm.is_empty()),
        ("fibre.boxes_mm", !fibre.boxes_mm.is_empty()),
        (
            "the directions of guide.field",
            settings.guide.kind == GuideKind::Field && settings.field.frame == FieldFrame::Plate,
        ),
    ];
    let others = others.into_iter().filter(|(_, is_given)| *is_given).map(|(key, _)| key.to_owned());
    settings.regions.iter().enumerate().filter_map(of_region).chain(others).collect()
}

/// The directions of beads in a layer of the job.
fn beads(settings: &Settings) -> BeadDirections {
    if settings.fill.pattern.follows_field() {
        return BeadDirections::AlongStress;
    }
    let first = settings.fill.angles_deg.ranges().first();
    let angles = first.map_or(vec![0.0], |r| r.angles_deg.iter().map(|a| a.to_radians()).collect());
    BeadDirections::Raster(angles)
}

fn ranked_pose(
    mut settings: Settings,
    pose: &Pose,
    reserve: Option<PoseReserve>,
    file: MeshFile,
    name: &str,
    pictured: Option<Option<DVec3>>,
) -> Result<Ranked, Failure> {
    settings.shape.rotate_deg = pose.rotate_deg;
    if settings.support.style == SupportStyle::None {
        settings.support.style = SupportStyle::Tree;
    }
    // Warnings of a single pose are dropped here: a run of the job in that pose reports them.
    let quiet = Diagnostics::default();
    let (mesh, stack, support, _) = supported(&settings, file, name, &quiet)?;
    let supports_mm3 = support.beads_mm3(&stack).unwrap_or_else(|| support.volume_mm3(&stack));
    let part_mm3: f64 = stack.layers().iter().map(|l| l.region().area_mm2() * l.height_mm()).sum();
    let p = &settings.process;
    let flow_mm3_s = bead_area_mm2(p.bead_width_mm, p.layer_height_mm) * p.solid_speed_mm_s;
    let picture = match pictured {
        Some(fails_at) => {
            let surface = support::surface(&support.cut.layers, &stack, settings.support.solid, &quiet)
                .map_err(grainpath::Error::from)?;
            let low = mesh.bounds().map_or(DVec3::ZERO, |(low, _)| low);
            Some(PosePicture { fails_at_mm: fails_at.map(|at| at + low), part: mesh, support: surface })
        }
        None => None,
    };
    // The volume without support is -0; adding zero turns it into 0.
    let round = |v: f64, to: f64| (v * to).round() / to + 0.0;
    Ok(Ranked {
        rotate_deg: pose.rotate_deg,
        reserve,
        support_g: round(supports_mm3 * 1e-3 * settings.material.density_g_cm3, 100.0),
        height_mm: round(pose.height_mm, 100.0),
        time_s: round((part_mm3 + supports_mm3) / flow_mm3_s, 1.0),
        flat_mm2: round(pose.flat_mm2, 10.0),
        tilt_deg: round(pose.tilt_deg, 10.0),
        picture,
    })
}

/// The poses as a table, the best first.
fn table(ranked: &[Ranked]) -> String {
    let mut out = String::from(
        "rank  rotate_deg               first failure (low to high)   support g  height mm  about s  flat mm2\n",
    );
    for (k, r) in ranked.iter().enumerate() {
        let rotation = format!("[{}, {}, {}]", r.rotate_deg[0], r.rotate_deg[1], r.rotate_deg[2]);
        let reserve = r.reserve.as_ref().map_or("none told".to_owned(), |f| {
            let [low, nominal, high] = f.first_failure;
            format!("{nominal:.2} ({low:.2} to {high:.2})")
        });
        out.push_str(&format!(
            "{:<5} {rotation:<24} {reserve:<29} {:>9.2} {:>10.2} {:>8.0} {:>9.1}\n",
            k + 1,
            r.support_g,
            r.height_mm,
            r.time_s,
            r.flat_mm2
        ));
    }
    out
}
