//! `grainpath slice`: a mesh, a drawing or a photograph with default settings.

use std::path::Path;

use crate::Failure;
use crate::args::Slice;
use crate::claims::Claims;
use crate::commands::run::execute;
use crate::inputs::settings;

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|e| endings.iter().any(|d| e.eq_ignore_ascii_case(d)))
}

/// Endings of pictures. The last seven are known and not read, so that the error names them.
const PICTURES: [&str; 11] =
    ["png", "jpg", "jpeg", "bmp", "heic", "heif", "webp", "avif", "gif", "jp2", "jxl"];

/// The job of a file that is sliced without one. A photograph is taken as a board whose fill follows its
/// grain.
fn job_of(model: &Path) -> String {
    if !has_ending(model, &PICTURES) {
        return String::new();
    }
    // JSON strings are TOML strings too, so a path with quotes or backslashes is escaped correctly.
    let file = serde_json::Value::from(model.display().to_string());
    format!("[shape.photo]\nfiles = [{file}]\n[guide]\nkind = \"grain\"\n")
}

/// `grainpath slice`
pub fn slice(args: &Slice) -> Result<(), Failure> {
    let mut settings = settings(&job_of(&args.model), "--set", &args.common.sets, Path::new(""))?;
    if args.model == Path::new("-") && args.output.is_none() {
        return Err(Failure::usage("a model from standard input needs -o FILE.gcode"));
    }
    let output = args.output.clone().unwrap_or_else(|| args.model.with_extension("gcode"));
    settings.output.gcode = output.display().to_string();
    if has_ending(&args.model, &["svg", "dxf"]) {
        settings.shape.outline = args.model.display().to_string();
        // A drawing has no height, and any default would be a guess.
        if settings.shape.thickness_mm == 0.0 {
            return Err(Failure::usage("an outline needs --set shape.thickness_mm=N"));
        }
    }
    execute(&settings, &args.model, Path::new(""), Path::new(""), None, Claims::default(), &args.common)
}
