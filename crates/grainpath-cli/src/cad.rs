//! Meshes of files that hold exact surfaces: STEP and IGES, triangulated by gmsh.
//!
//! No library under a permissive licence reads STEP well enough, so grainpath runs gmsh (<https://gmsh.info>) as a
//! separate program if it is installed: gmsh reads the surfaces with OpenCASCADE, turns their unit into mm and writes
//! triangles as STL. It works in a folder of its own below the folder for temporary files, on one thread, without the
//! user's gmsh settings, so the same file gives the same triangles with the same gmsh. A run is ended when the job is
//! stopped, or after [`LONGEST`].
//!
//! Round faces become polygons of [`SIDES`] sides per full turn, which lie at most 0.06 % of the radius inside the true
//! face: 0.03 mm for a radius of 50 mm. Measured on a machined bracket (127 x 63 x 35 mm, many fillets): 165 054
//! triangles in 5 s, a closed mesh whose volume differs by 0.003 % from that of a mesh with twice as many.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use grainpath_core::Diagnostics;
use grainpath_core::units::LengthUnit;
use grainpath_io::{MeshError, MeshFile, parse_mesh, read_binary_stl, sniff_exact_surfaces};

use crate::{Failure, files};

/// Sides per full turn of the polygon that replaces a round face. Source: derived. A face of 80 mm radius is then off by
/// 0.05 mm, an eighth of a usual bead.
const SIDES: u32 = 90;
/// Smallest triangle size that gmsh may choose to follow round faces, mm. Source: derived. A fillet of 0.5 mm is off by
/// 0.02 mm.
const SMALLEST_MM: f64 = 0.3;
/// How long gmsh may take. Source: chosen; the largest file tried took 11 s on a busy machine.
const LONGEST: Duration = Duration::from_secs(600);
/// Interval between checks whether gmsh has ended or the job was stopped. Source: derived. A stopped run must end in 0.2 s.
const POLL: Duration = Duration::from_millis(10);

/// As [`mesh`], for a file. A binary STL is read in pieces; a file of a million triangles takes 50 MB less memory so.
///
/// # Errors
/// As [`mesh`] and [`files::read`].
pub(crate) fn mesh_file(path: &Path, name: &str, diagnostics: &Diagnostics) -> Result<MeshFile, Failure> {
    let file = path.to_owned();
    let in_pieces = diagnostics.leave_at_stop(move || binary_stl(&file)).map_err(grainpath::Error::from)?;
    if let Some(read) = in_pieces {
        return read.map_err(|source| grainpath::Error::Mesh { path: name.to_owned(), source }.into());
    }
    let file = path.to_owned();
    let bytes = diagnostics.leave_at_stop(move || files::read(&file)).map_err(grainpath::Error::from)?;
    mesh(bytes?, name, diagnostics)
}

/// The mesh of a regular file that is a binary STL. `None` for every other file, and for one that cannot be read: reading
/// it as a whole then tells why.
fn binary_stl(path: &Path) -> Option<Result<MeshFile, MeshError>> {
    // `-` is standard input. Files over the limit are refused by name where they are read as a whole.
    let is_taken = |m: &fs::Metadata| m.is_file() && m.len() <= files::MAX_BYTES && path != Path::new("-");
    let metadata = fs::metadata(path).ok().filter(is_taken)?;
    read_binary_stl(fs::File::open(path).ok()?, metadata.len()).ok().flatten()
}

/// The mesh of a file, triangulated by gmsh where it holds exact surfaces.
///
/// # Errors
/// For a faulty file, and for a file that needs gmsh where it is not installed; exit code 3.
pub(crate) fn mesh(bytes: Vec<u8>, name: &str, diagnostics: &Diagnostics) -> Result<MeshFile, Failure> {
    let wrong = |source: MeshError| Failure::from(grainpath::Error::Mesh { path: name.to_owned(), source });
    let shown = name.to_owned();
    let Some(format) = sniff_exact_surfaces(&bytes) else {
        // A parser does not check the stop flag, and it takes 0.4 s for a million triangles.
        let read = diagnostics.leave_at_stop(move || parse_mesh(&bytes, Some(&shown)));
        return read.map_err(grainpath::Error::from)?.map_err(wrong);
    };
    // gmsh is run on this thread, so that the program cannot end before gmsh does.
    let Some(stl) = triangles(&bytes, name, format, diagnostics)? else {
        return Err(wrong(MeshError::ExactSurfaces { format }));
    };
    let read = diagnostics.leave_at_stop(move || parse_mesh(&stl, None)).map_err(grainpath::Error::from)?;
    // STL has no unit; gmsh was asked for mm.
    Ok(MeshFile { unit: Some(LengthUnit::Millimetre), ..read.map_err(wrong)? })
}

/// The version of the gmsh that is installed.
pub(crate) fn gmsh_version() -> Option<String> {
    let told = Command::new("gmsh").arg("--version").stdin(Stdio::null()).output().ok()?;
    // Versions before 4.9 print the version to standard error.
    let text = [told.stdout, told.stderr].concat();
    let line = String::from_utf8_lossy(&text).lines().next()?.trim().to_owned();
    (told.status.success() && !line.is_empty()).then_some(line)
}

/// The surfaces of a file as binary STL; `None` where gmsh is not installed.
fn triangles(
    bytes: &[u8],
    name: &str,
    format: &str,
    diagnostics: &Diagnostics,
) -> Result<Option<Vec<u8>>, Failure> {
    let failed =
        |what: &str| Failure::input(format!("{name}: {format}, a file of exact surfaces: gmsh {what}"));
    let folder = tempfile::Builder::new().prefix(".grainpath-cad-").tempdir();
    let folder = folder.map_err(|e| failed(&format!("needs a temporary folder: {}", files::plain(&e))))?;
    // gmsh tells formats apart by the ending, `step` or `iges`.
    let input = folder.path().join(format!("part.{}", format.to_ascii_lowercase()));
    let (output, log) = (folder.path().join("part.stl"), folder.path().join("log"));
    let io = |e: std::io::Error| failed(&format!("cannot use its temporary folder: {}", files::plain(&e)));
    fs::write(&input, bytes).map_err(io)?;
    let mut command = Command::new("gmsh");
    command
        .args(["-nopopup", "-nt", "1", "-v", "1", "-2", "-format", "stl", "-bin"])
        .args(["-setstring", "Geometry.OCCTargetUnit", "MM"])
        .args(["-setnumber", "Mesh.MeshSizeExtendFromBoundary", "0"])
        .args(["-setnumber", "Mesh.MeshSizeFromCurvature", &SIDES.to_string()])
        .args(["-setnumber", "Mesh.MeshSizeMin", &SMALLEST_MM.to_string()])
        .arg(&input)
        .arg("-o")
        .arg(&output)
        .current_dir(folder.path())
        // gmsh reads its settings from HOME: the user's own settings would give other triangles.
        .env("HOME", folder.path())
        .stdin(Stdio::null())
        .stdout(fs::File::create(&log).map_err(io)?)
        .stderr(fs::File::options().append(true).open(&log).map_err(io)?);
    let mut running = match command.spawn() {
        Ok(running) => running,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(failed(&format!("cannot be started: {}", files::plain(&e)))),
    };
    let start = Instant::now();
    let status = loop {
        if let Some(status) = running.try_wait().map_err(io)? {
            break status;
        }
        let stopped = diagnostics.check();
        if stopped.is_err() || start.elapsed() > LONGEST {
            // Errors are ignored: gmsh may just have ended by itself.
            let _ = running.kill();
            let _ = running.wait();
            stopped.map_err(grainpath::Error::from)?;
            return Err(failed(&format!("took more than {} minutes", LONGEST.as_secs() / 60)));
        }
        std::thread::sleep(POLL);
    };
    match fs::read(&output) {
        Ok(stl) if status.success() => Ok(Some(stl)),
        _ => Err(failed(&format!("found no part in it{}", reason(&log)))),
    }
}

/// The first error that gmsh wrote, after a colon.
fn reason(log: &Path) -> String {
    let text = fs::read(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    // gmsh writes `Error   : Could not ...`; OpenCASCADE's lines contain `ERR`, stars and colour codes.
    let line = text.lines().find(|l| l.contains("ERR") || l.starts_with("Error"));
    let plain = |l: &str| {
        let words: Vec<&str> =
            l.split_whitespace().filter(|w| !w.contains('*') && !w.contains('\u{1b}')).collect();
        words.join(" ").trim_start_matches("Error :").trim().to_owned()
    };
    line.map_or(String::new(), |l| format!(": {}", plain(l)))
}
