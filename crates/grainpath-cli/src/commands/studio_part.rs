//! The part in the studio: its shape with faces and defects, its poses and supports, and the stress under its loads.
//!
//! The shape is placed and mended as in a run, so that the page shows the part that is printed, with the same face names
//! as in a job. Loads are solved as `grainpath run --check` solves them.

use std::path::Path;
use std::sync::Arc;

use grainpath::guide::{KnownStress, ResultMesh, ResultSurface, ResultVolume, StressLine, faces_as_in_file};
use grainpath::measure::report::{StressReport, SupportReport};
use grainpath::run::{Placed, config, placed_mesh};
use grainpath::shape::likely_unit;
use grainpath::support::tree::{Kind as NodeKind, Node};
use grainpath_core::diagnostics::Stage;
use grainpath_core::faces::Faces;
use grainpath_core::mesh::{EdgeUses, MeshHealth, examine};
use grainpath_core::{DMat3, DVec3, Diagnostics, TriMesh, WarningId};
use grainpath_imaging::scan::{PreviewError, ScanError, ScanPreview, preview};
use grainpath_job::Settings;
use grainpath_job::choices::{LoadFrame, SupportStyle};
use grainpath_studio::{Branch, CaseValues, Finished, StressSurface, StressVolume, Surface};
use serde_json::{Value, json};

use super::inspect_faces::face_json;
use super::orient;
use super::support::supported;
use crate::Failure;
use crate::inputs::{Given, open_scan, read_body, read_deck, read_stress};

/// Most faces that are listed with name and measures. Source: chosen; a part with a thousand faces is rare, and the time
/// for naming n faces grows with n squared.
const MOST_FACES: usize = 1000;
/// Number of faces above which only [`FEW_FACES`] are named: the faces of such a mesh are mostly noise. Source: chosen, as
/// [`MOST_FACES`].
const TOO_MANY_FACES: usize = 5000;
/// Faces that are named in a mesh with more than [`TOO_MANY_FACES`]. Source: as many as `grainpath inspect --faces` lists.
const FEW_FACES: usize = 200;

/// Largest number of faulty edges that are drawn. Source: chosen; more would hide the part, and a million unconnected
/// triangles have three million.
const MOST_FAULTS: usize = 100_000;

fn single(p: DVec3) -> [f32; 3] {
    p.as_vec3().to_array()
}

/// The shape of a job as it stands on the plate.
pub(super) fn shape(
    settings: &Settings,
    path: &Path,
    diagnostics: &Diagnostics,
) -> Result<Finished, Failure> {
    let (file, _) = read_body(settings, path, diagnostics)?;
    diagnostics.check().map_err(grainpath::Error::from)?;
    let stated = file.unit;
    let mut faults = Vec::new();
    let mut found: Vec<MeshHealth> = Vec::new();
    for body in &file.bodies {
        let examined = examine(&body.mesh, diagnostics).map_err(grainpath::Error::from)?;
        let Some((health, edges, _)) = examined else { continue };
        let room = MOST_FAULTS.saturating_sub(faults.len());
        let ends = |edge: [u32; 2]| edge.map(|v| body.mesh.vertices[v as usize]);
        faults.extend(edges.unsound().take(room).map(ends));
        found.push(health);
    }
    let sum = |count: &dyn Fn(&MeshHealth) -> usize| found.iter().map(count).sum::<usize>();
    let span = |h: &MeshHealth| (h.bounds.1 - h.bounds.0).max_element();
    let longest = found.iter().map(span).fold(0.0, f64::max);
    let placing = config::placing(settings);
    let likely = likely_unit(longest * settings.shape.scale);
    // A drawing is in mm once it is read.
    let is_asked = placing.unit_of_file && stated.is_none() && settings.shape.outline.is_empty();
    let mut report = json!({
        "ok": true, "kind": "shape", "bodies": found.len(), "shells": sum(&|h| h.shells),
        "open_edges": sum(&|h| h.open_edges), "nonmanifold_edges": sum(&|h| h.nonmanifold_edges),
        "badly_wound_edges": sum(&|h| h.badly_wound_edges), "zero_area_facets": sum(&|h| h.zero_area_facets),
        "unit_is_stated": !is_asked,
        "likely_unit": if is_asked { Value::from(likely.name()) } else { Value::Null },
    });
    let source = |source| grainpath::Error::Shape { path: path.display().to_string(), source };
    let placed = placed_mesh(&placing, file, diagnostics).map_err(source)?;
    let Placed { mesh, lowered_mm, assumed_unit, .. } = placed;
    let of_file = assumed_unit.or(stated).filter(|_| placing.unit_of_file);
    let unit = of_file.unwrap_or(placing.placement.unit);
    report["unit"] = unit.name().into();
    diagnostics.begin(Stage::Slice, 0);
    diagnostics.check().map_err(grainpath::Error::from)?;
    let standing = config::standing(settings, lowered_mm);
    // Finding the faces of a million triangles takes 1 to 2 s, which must not delay a stop when the page is closed.
    let with_faces = move || {
        let faces = faces_as_in_file(&mesh, &standing);
        (mesh, faces)
    };
    let (mesh, faces) = diagnostics.leave_at_stop(with_faces).map_err(grainpath::Error::from)?;
    let (low, high) = mesh.bounds().unwrap_or_default();
    let rows = |m: DMat3| m.transpose().to_cols_array_2d();
    let mut add = |key: &str, value: Value| report[key] = value;
    add("triangles", json!(mesh.triangles.len()));
    add("low_mm", json!(low.to_array()));
    add("high_mm", json!(high.to_array()));
    add("volume_mm3", json!(mesh.signed_volume()));
    add("frame_is_part", json!(settings.guide.frame == LoadFrame::Part));
    add("rotation", json!(rows(standing.rotation)));
    add("shift_mm", json!(standing.shift().to_array()));
    add("scale", json!(standing.scale));
    add("faces_in_all", json!(faces.len()));
    add("faces", face_rows(&faces, standing.rotation, standing.shift()));
    let ends = |edge: [u32; 2]| edge.map(|v| single(mesh.vertices[v as usize]));
    let edges = EdgeUses::count(&mesh);
    let faulty_edges: Vec<_> = edges.faulty().map(ends).collect();
    add("edges_left", json!(faulty_edges.len()));
    let factor = unit.mm() * standing.scale;
    let placed = |p: DVec3| single(standing.rotation * (factor * p) + standing.shift());
    // A noisy mesh has almost as many faces as triangles; drawing all their borders would hide it.
    let borders = if faces.len() > TOO_MANY_FACES { Vec::new() } else { borders(&mesh, &edges, &faces) };
    let surface = Surface {
        borders,
        vertices: mesh.vertices.iter().map(|p| single(*p)).collect(),
        face: (0..mesh.triangles.len())
            .map(|t| faces.of_triangle(t).map_or(u32::MAX, |f| f as u32))
            .collect(),
        faulty_edges,
        file_faults: faults.into_iter().map(|ends: [DVec3; 2]| ends.map(placed)).collect(),
        triangles: mesh.triangles,
    };
    Ok(Finished { report, surface: Some(surface), warnings: diagnostics.warnings(), ..Finished::default() })
}

/// The surface of a scan at a bounded resolution, in the coordinates of the part that is planned from it.
pub(super) fn scan(settings: &Settings, path: &Path, diagnostics: &Diagnostics) -> Result<Finished, Failure> {
    let raw = config::raw_header(settings);
    let mut source = open_scan(path, raw.as_ref(), settings.ct.outside_folder)?;
    let name = path.display().to_string();
    let made = preview(&mut *source, &config::scan(settings), diagnostics).map_err(|e| match e {
        PreviewError::Scan(ScanError::Slices(e)) => grainpath::Error::Slices(e),
        PreviewError::Scan(source) => grainpath::Error::Scan { path: name.clone(), source },
        PreviewError::Loft(e) => grainpath::Error::Shape { path: name.clone(), source: e.into() },
    })?;
    let ScanPreview { mesh, voxels, merged, cell_mm } = made;
    let (low, high) = mesh.bounds().unwrap_or_default();
    let report = json!({
        "ok": true, "kind": "shape", "preview": { "resolution_mm": cell_mm, "voxels": voxels, "merged": merged },
        "triangles": mesh.triangles.len(), "low_mm": low.to_array(), "high_mm": high.to_array(),
        "volume_mm3": mesh.signed_volume(), "unit": "mm", "unit_is_stated": true, "likely_unit": Value::Null,
        "open_edges": 0, "nonmanifold_edges": 0, "badly_wound_edges": 0, "zero_area_facets": 0, "edges_left": 0,
        "frame_is_part": false, "rotation": DMat3::IDENTITY.to_cols_array_2d(), "shift_mm": [0.0, 0.0, 0.0],
        "scale": settings.shape.scale, "faces_in_all": 0, "faces": [],
    });
    let surface = Surface {
        vertices: mesh.vertices.iter().map(|p| single(*p)).collect(),
        face: vec![u32::MAX; mesh.triangles.len()],
        triangles: mesh.triangles,
        ..Surface::default()
    };
    // The height of the print follows from its own layers, not from those of the preview.
    let warnings = diagnostics.warnings().into_iter().filter(|w| w.id != WarningId::ScanHeightRounded);
    Ok(Finished { report, surface: Some(surface), warnings: warnings.collect(), ..Finished::default() })
}

/// The edges between two faces.
fn borders(mesh: &TriMesh, edges: &EdgeUses, faces: &Faces) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    for mut uses in edges.edges() {
        let (Some((a, _)), Some((b, _)), None) = (uses.next(), uses.next(), uses.next()) else { continue };
        if faces.of_triangle(a) == faces.of_triangle(b) {
            continue;
        }
        let (a, b) = (mesh.triangles[a], mesh.triangles[b]);
        let mut shared = a.into_iter().filter(|corner| b.contains(corner));
        if let (Some(from), Some(to)) = (shared.next(), shared.next()) {
            found.push([from, to]);
        }
    }
    found
}

/// The faces with their names and measures, in the position in which the part stands on the plate.
fn face_rows(faces: &Faces, rotation: DMat3, shift: DVec3) -> Value {
    let shown = if faces.len() > TOO_MANY_FACES { FEW_FACES } else { faces.len().min(MOST_FACES) };
    // A turned part has its faces measured in the pose of its file, so they are moved here; others need no move.
    let is_turned = rotation != DMat3::IDENTITY;
    let row = |i: usize| {
        let mut row = face_json(faces, i);
        for (key, is_point) in [("centre_mm", true), ("point_mm", true), ("normal", false), ("axis", false)] {
            let numbers: Option<Vec<f64>> =
                row[key].as_array().map(|v| v.iter().filter_map(Value::as_f64).collect());
            if let (true, Some([x, y, z])) = (is_turned, numbers.as_deref()) {
                let moved = rotation * DVec3::new(*x, *y, *z) + if is_point { shift } else { DVec3::ZERO };
                row[key] = json!(moved.to_array());
            }
        }
        row
    };
    (0..shown).map(row).collect()
}

/// The poses in which the part of a job can stand, the best first.
pub(super) fn orient(
    settings: &Settings,
    path: &Path,
    base: &Path,
    known: Arc<KnownStress>,
    diagnostics: &Diagnostics,
) -> Result<Finished, Failure> {
    let given = Given { known: Some(known), ..Given::default() };
    let poses = orient::poses_json(settings, given, path, base, diagnostics)?;
    let report = json!({ "ok": true, "kind": "orient", "poses": poses });
    Ok(Finished { report, warnings: diagnostics.warnings(), ..Finished::default() })
}

/// The supports of a job's part, and the load on each branch.
pub(super) fn supports(
    settings: &Settings,
    path: &Path,
    diagnostics: &Diagnostics,
) -> Result<Finished, Failure> {
    let mut settings = settings.clone();
    // The user asked to see supports, so they are grown even if the job has none.
    if settings.support.style == SupportStyle::None {
        settings.support.style = SupportStyle::Tree;
    }
    let (file, _) = read_body(&settings, path, diagnostics)?;
    diagnostics.begin(Stage::Support, 0);
    let name = path.display().to_string();
    let grow = {
        let settings = settings.clone();
        move || {
            let quiet = Diagnostics::default();
            supported(&settings, file, &name, &quiet).map(|grown| (grown, quiet.warnings()))
        }
    };
    let (grown, warnings) = diagnostics.leave_at_stop(grow).map_err(grainpath::Error::from)??;
    let (_, stack, support, _) = grown;
    warnings.into_iter().for_each(|w| diagnostics.push(w));
    let nodes = &support.forest.nodes;
    let end = |node: &Node| node.at.extend(node.radius_mm).as_vec4().to_array();
    let branch = |node: &Node| {
        let below = &nodes[node.below? as usize];
        Some(Branch {
            ends: [end(node), end(below)],
            load_n: (f64::from(node.carries) * settings.support.load_per_contact_n) as f32,
            is_contact: matches!(node.kind, NodeKind::Contact(_)),
        })
    };
    let branches: Vec<Branch> = nodes.iter().filter_map(branch).collect();
    let (beads, solid) = (support.beads_mm3(&stack), support.volume_mm3(&stack));
    let told = SupportReport::new(&support, beads, solid, settings.material.density_g_cm3);
    let report = json!({ "ok": true, "kind": "supports", "support": told });
    Ok(Finished { report, branches: Some(branches), warnings: diagnostics.warnings(), ..Finished::default() })
}

/// The stress under the loads of a job, on the surface of the mesh that was solved.
pub(super) fn stress(
    settings: &Settings,
    path: &Path,
    base: &Path,
    known: Arc<KnownStress>,
    diagnostics: &Diagnostics,
) -> Result<Finished, Failure> {
    let (mesh, _) = read_body(settings, path, diagnostics)?;
    let inputs = grainpath::Inputs {
        mesh,
        path: path.display().to_string(),
        stress: read_stress(settings, base)?,
        deck: read_deck(settings, base)?,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: Default::default(),
        known: Some(known),
    };
    let guide = grainpath::run::check_loads(settings, inputs, diagnostics)?;
    let bottom_mm = config::placing(settings).lift_mm;
    // All load cases are solved on the same mesh, so the first case gives the surface.
    let drawn: ResultSurface = guide.results.first().map(|r| r.surface(bottom_mm)).unwrap_or_default();
    let volume: ResultVolume = guide.results.first().map(|r| r.volume(bottom_mm)).unwrap_or_default();
    let values = |result: &ResultMesh| {
        let moved = |n: usize| result.displacement.as_ref().map_or(DVec3::ZERO, |all| all[n]);
        let nine = |n: &u32| {
            let n = *n as usize;
            let (stress, by) = (result.stress[n], moved(n).to_array());
            let mut nine = [0.0_f32; 9];
            nine.iter_mut().zip(stress.into_iter().chain(by)).for_each(|(to, v)| *to = v as f32);
            nine
        };
        let line = |line: &StressLine| {
            let both = line.points.iter().zip(&line.values_mpa);
            both.map(|(p, v)| p.extend(*v).as_vec4().to_array()).collect()
        };
        CaseValues {
            name: result.name.clone(),
            values: drawn.nodes.iter().map(nine).collect(),
            inside: volume.nodes.iter().map(nine).collect(),
            lines: result.stress_lines().iter().map(line).collect(),
        }
    };
    let stress = StressSurface {
        points: drawn.points.iter().map(|p| single(*p)).collect(),
        cases: guide.results.iter().map(values).collect(),
        triangles: drawn.triangles.clone(),
        volume: StressVolume {
            points: volume.points.iter().map(|p| single(*p)).collect(),
            tetrahedra: volume.tetrahedra.clone(),
        },
    };
    let warnings = diagnostics.warnings();
    let report =
        json!({ "ok": true, "kind": "check", "stress": StressReport::from(&guide), "warnings": warnings });
    Ok(Finished { report, stress: Some(stress), warnings, ..Finished::default() })
}
