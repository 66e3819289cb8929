//! `grainpath specimen`: writes calibration pieces, and test pieces of standards with their jobs.

use std::path::{Path, PathBuf};

use grainpath_core::spelling::question;
use grainpath_parts::specimen::SPECIMENS;
use grainpath_parts::test_pieces::{TEST_PIECES, TestPiece};

use crate::args::Specimen;
use crate::outputs::write_mesh;
use crate::{Failure, files, outputs};

/// `grainpath specimen`
pub(crate) fn specimen(args: &Specimen) -> Result<(), Failure> {
    let all =
        || SPECIMENS.iter().map(|s| (s.name, s.about)).chain(TEST_PIECES.iter().map(|p| (p.name, p.about)));
    let Some(name) = &args.name else {
        files::print(&all().map(|(name, about)| format!("{name:<16} {about}\n")).collect::<String>());
        return Ok(());
    };
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.stl")));
    if let Some(piece) = TestPiece::named(name) {
        return test_piece(piece, &output);
    }
    let Some(specimen) = SPECIMENS.iter().find(|s| s.name == name) else {
        let names: Vec<&str> = all().map(|s| s.0).collect();
        let near = question(name, names.iter().copied());
        return Err(Failure::usage(format!("no specimen {name:?}{near} There are {}", names.join(", "))));
    };
    write_mesh(&output, &[&(specimen.mesh)()])?;
    files::print(&format!("{}\n", output.display()));
    Ok(())
}

/// Writes the mesh of a test piece and, in the same folder, a drawing and a job that tests the piece.
fn test_piece(piece: &TestPiece, output: &Path) -> Result<(), Failure> {
    write_mesh(output, &[&piece.mesh()])?;
    // The job refers to the mesh by name, so job and drawing take the file name that the user chose for the mesh.
    let file = output.file_stem().map_or_else(|| piece.name.into(), |s| s.to_string_lossy().into_owned());
    let (job, drawing) = (output.with_extension("toml"), output.with_extension("svg"));
    outputs::save(&job, piece.job(&file).as_bytes())?;
    outputs::save(&drawing, piece.drawing().as_bytes())?;
    files::print(&format!("{}\n{}\n{}\n", output.display(), drawing.display(), job.display()));
    Ok(())
}
