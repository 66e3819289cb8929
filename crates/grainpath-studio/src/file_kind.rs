//! Kinds of files, and the endings that tell them.

use std::path::Path;

use serde::{Deserialize, Serialize};

/// The kind of a file, taken from its ending.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FileKind {
    Job,
    Mesh,
    Outline,
    Photo,
    Scan,
    Program,
    Other,
}

/// Endings of files that the studio opens. Scans of many files (DICOM, TIFF, PNG) are opened as their folder.
const ENDINGS: [(&str, FileKind); 32] = [
    ("toml", FileKind::Job),
    ("stl", FileKind::Mesh),
    ("obj", FileKind::Mesh),
    ("ply", FileKind::Mesh),
    ("off", FileKind::Mesh),
    ("3mf", FileKind::Mesh),
    ("step", FileKind::Mesh),
    ("stp", FileKind::Mesh),
    ("iges", FileKind::Mesh),
    ("igs", FileKind::Mesh),
    ("svg", FileKind::Outline),
    ("dxf", FileKind::Outline),
    ("png", FileKind::Photo),
    ("jpg", FileKind::Photo),
    ("jpeg", FileKind::Photo),
    ("bmp", FileKind::Photo),
    ("nrrd", FileKind::Scan),
    ("nhdr", FileKind::Scan),
    ("mhd", FileKind::Scan),
    ("mha", FileKind::Scan),
    ("nii", FileKind::Scan),
    ("nii.gz", FileKind::Scan),
    ("tif", FileKind::Scan),
    ("tiff", FileKind::Scan),
    ("dcm", FileKind::Scan),
    ("gcode", FileKind::Program),
    ("gco", FileKind::Program),
    ("g", FileKind::Program),
    ("nc", FileKind::Program),
    ("ngc", FileKind::Program),
    ("tap", FileKind::Program),
    ("bgcode", FileKind::Program),
];

impl FileKind {
    /// The kind that the ending of a file tells.
    pub(crate) fn from_path(path: &Path) -> Self {
        // An ending may have two parts (`.nii.gz`), so the end of the whole name is compared.
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let has = |ending: &str| name.strip_suffix(ending).is_some_and(|stem| stem.ends_with('.'));
        ENDINGS.iter().find(|(ending, _)| has(ending)).map_or(Self::Other, |(_, kind)| *kind)
    }
}
