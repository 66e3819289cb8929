//! `grainpath inspect FILE --faces`: lists the faces of a mesh or a drawing, each with the line that selects it in a job.
//!
//! Coordinates are those of the file in mm. The unit, scale, rotation and position that a job sets do not
//! change the names of faces, so the names listed here hold in every job with this file.

use std::fmt::Write as _;
use std::path::Path;

use grainpath::shape::{Repair, assumed_unit, mend};
use grainpath_core::faces::{Face, Faces, Surface};
use grainpath_core::spelling::counted;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, Diagnostics, TriMesh};
use grainpath_io::{MeshFile, sniff_outline};
use grainpath_view::faces::faces_png;
use serde_json::{Value, json};

use crate::args::Inspect;
use crate::inputs::{read_body, settings};
use crate::{ExitCode, Failure, cad, files};

/// Most faces that are listed; a mesh without flat or round faces may have a face for each facet.
/// Source: derived. A person still reads a list of this length to its end.
const LISTED: usize = 200;
/// Longer side of the picture, pixels. Source: derived: two views beside each other on a wide screen.
const IMAGE_PX: u32 = 1600;

/// Runs the command.
pub(crate) fn inspect(args: &Inspect) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let bytes = files::read(&args.file)?;
    // Names that a job may read as those of a drawing are read as such here too.
    let is_outline = sniff_outline(&bytes);
    let file = if is_outline {
        let mut settings = settings("", "--set", &args.sets, Path::new(""))?;
        settings.shape.outline.clone_from(&name);
        if settings.shape.thickness_mm == 0.0 {
            let why = "a drawing has faces once it has a thickness: add --set shape.thickness_mm=N";
            return Err(Failure { code: ExitCode::Usage, ..Failure::of_file(&args.file, why) });
        }
        read_body(&settings, &args.file, &Diagnostics::default())?.0
    } else if let Some(set) = args.sets.first() {
        return Err(Failure::usage(format!(
            "--set {set} is of no use: the faces of a mesh depend on no setting"
        )));
    } else {
        cad::mesh(bytes, &name, &Diagnostics::default())?
    };
    let by = match (is_outline, file.unit.is_some()) {
        (true, _) => "extruded",
        (false, true) => "the file says so",
        (false, false) => "assumed",
    };
    let (mesh, faces, unit) = of_file(file, &name, &Diagnostics::default())?;
    let unit = format!("{} ({by})", unit.name());
    let shown = faces.len().min(LISTED);
    let rows: Vec<Value> = (0..shown).map(|i| face_json(&faces, i)).collect();
    if let Some(path) = &args.image {
        let png = faces_png(&mesh, &faces, IMAGE_PX);
        files::write_atomically(path, |out| out.write_all(&png).map_err(|e| Failure::usage(e.to_string())))?;
    }
    if args.json {
        let value = json!({
            "ok": true, "file": name, "kind": "faces", "unit_of_file": unit, "faces_in_all": faces.len(),
            "faces": rows,
        });
        files::print(&format!("{value}\n"));
        return Ok(());
    }
    let mut text = format!(
        "{name}: {}, lengths in mm in the coordinates of the file, unit of the file {unit}\n",
        counted(faces.len(), "face")
    );
    let low_mm = mesh.bounds().map_or(0.0, |(low, _)| rounded(low.z));
    if low_mm != 0.0 {
        let _ = writeln!(
            text,
            "a job's part stands on z = 0, which is z {low_mm} here, unless guide.frame is \"part\""
        );
    }
    for row in &rows {
        text.push_str(&line(row));
    }
    if faces.len() > shown {
        let _ = writeln!(text, "and {} smaller faces", faces.len() - shown);
    }
    // A name that two faces share selects neither.
    if let Some(first) = rows.iter().find(|row| row["doubtful"] == json!(false)) {
        let face = word(first, "name");
        let sets: String = args.sets.iter().map(|set| format!(" --set {set}")).collect();
        let _ = writeln!(
            text,
            "to plan along a load, N: grainpath slice {name}{sets} --hold {face} --load FACE=X,Y,Z"
        );
    }
    files::print(&text);
    Ok(())
}

/// The mended mesh of a file in mm, its faces, and the unit of the file.
fn of_file(
    file: MeshFile,
    name: &str,
    diagnostics: &Diagnostics,
) -> Result<(TriMesh, Faces, LengthUnit), Failure> {
    let bodies = file.bodies.into_iter().map(|body| body.mesh).collect();
    // The mesh is mended as in a run, since facets that are inside out would have reversed normals.
    let mut mesh = mend(bodies, Repair::Auto, diagnostics)
        .map_err(|source| grainpath::Error::Shape { path: name.to_owned(), source })?;
    let longest = mesh.bounds().map_or(0.0, |(low, high)| (high - low).max_element());
    let unit = file.unit.unwrap_or_else(|| assumed_unit(longest));
    mesh.vertices.iter_mut().for_each(|p| *p *= unit.mm());
    diagnostics.check().map_err(grainpath::Error::from)?;
    let faces = Faces::segment(&mesh);
    Ok((mesh, faces, unit))
}

/// The largest faces of a mesh, as many as the command lists, largest first, each as `--json` prints it.
///
/// # Errors
/// For a mesh that cannot be mended, and where the work is stopped.
pub fn list_faces(file: MeshFile, diagnostics: &Diagnostics) -> Result<Value, Failure> {
    let (_, faces, _) = of_file(file, "the mesh", diagnostics)?;
    let row = |i: usize| {
        diagnostics.check().map_err(grainpath::Error::from)?;
        Ok(face_json(&faces, i))
    };
    (0..faces.len().min(LISTED)).map(row).collect()
}

/// One face; numbers count from 1, as in the picture.
pub(crate) fn face_json(faces: &Faces, i: usize) -> Value {
    let Face { surface, triangles, area_mm2, centroid } = &faces.all()[i];
    let name = faces.name(i);
    let mut row = json!({
        "number": i + 1, "name": name, "kind": surface.word(), "area_mm2": rounded(*area_mm2),
        "centre_mm": vector(*centroid), "triangles": triangles.len(),
        "line": format!("on = {{ face = {name:?} }}"),
        // If two faces are alike, the name of either cannot tell them apart.
        "doubtful": faces.find(&name).is_err(),
    });
    let mut add = |key: &str, value: Value| row[key] = value;
    match *surface {
        Surface::Plane { normal } => add("normal", vector(normal)),
        Surface::Cylinder { point, axis, radius_mm, hollow } => {
            add("axis", vector(axis));
            add("point_mm", vector(point));
            add("radius_mm", json!(rounded(radius_mm)));
            add("hollow", json!(hollow));
        }
        Surface::Cone { point, axis, radius_mm, half_angle_rad, hollow } => {
            add("axis", vector(axis));
            add("point_mm", vector(point));
            add("radius_mm", json!(rounded(radius_mm)));
            add("half_angle_deg", json!(rounded(half_angle_rad.to_degrees())));
            add("hollow", json!(hollow));
        }
        Surface::Sphere { centre, radius_mm, hollow } => {
            add("point_mm", vector(centre));
            add("radius_mm", json!(rounded(radius_mm)));
            add("hollow", json!(hollow));
        }
        Surface::Free => {}
    }
    row
}

/// A text of a face's row.
fn word<'a>(row: &'a Value, key: &str) -> &'a str {
    row[key].as_str().unwrap_or_default()
}

/// A face as text for the terminal.
fn line(row: &Value) -> String {
    let mut measures = String::new();
    // For a round face, a point of its axis is more useful than the centre of its area.
    let centre = if row["point_mm"].is_null() { "centre_mm" } else { "point_mm" };
    for (key, shown) in [
        ("radius_mm", "radius"),
        ("half_angle_deg", "half angle"),
        ("axis", "axis"),
        ("normal", "normal"),
        (centre, "at"),
    ] {
        if !row[key].is_null() {
            let _ = write!(measures, ", {shown} {}", measure(&row[key]));
        }
    }
    let hollow = if row["hollow"] == json!(true) { " (hollow)" } else { "" };
    let doubtful =
        if row["doubtful"] == json!(true) { "  # another face is alike: select it by its shape" } else { "" };
    format!(
        "{:>4}  {:<8} {}{hollow} {} mm2{measures}\n      {}{doubtful}\n",
        row["number"],
        word(row, "name"),
        word(row, "kind"),
        measure(&row["area_mm2"]),
        word(row, "line"),
    )
}

/// A number, or the components of a vector in parentheses, as text rounded to a micrometre.
fn measure(value: &Value) -> String {
    let number = |v: &Value| format!("{}", (v.as_f64().unwrap_or_default() * 1e3).round() / 1e3 + 0.0);
    match value.as_array() {
        Some(vector) => format!("({})", vector.iter().map(number).collect::<Vec<_>>().join(", ")),
        None => number(value),
    }
}

/// Rounds to a tenth of a micrometre: further digits would only show rounding errors.
fn rounded(v: f64) -> f64 {
    // Adding zero turns -0 into 0.
    (v * 1e4).round() / 1e4 + 0.0
}

fn vector(v: DVec3) -> Value {
    json!(v.to_array().map(rounded))
}
