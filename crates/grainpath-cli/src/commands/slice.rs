//! `grainpath slice`: a mesh or a drawing with default settings.

use std::path::Path;

use crate::Failure;
use crate::args::Slice;
use crate::claims::Claims;
use crate::commands::run::execute;
use crate::inputs::settings;

/// `grainpath slice`
pub fn slice(args: &Slice) -> Result<(), Failure> {
    let mut settings = settings("", "--set", &args.common.sets, Path::new(""))?;
    if args.model == Path::new("-") && args.output.is_none() {
        return Err(Failure::usage("a model from standard input needs -o FILE.gcode"));
    }
    let output = args.output.clone().unwrap_or_else(|| args.model.with_extension("gcode"));
    settings.output.gcode = output.display().to_string();
    if args.model.extension().is_some_and(|e| ["svg", "dxf"].iter().any(|d| e.eq_ignore_ascii_case(d))) {
        settings.shape.outline = args.model.display().to_string();
        if settings.shape.thickness_mm == 0.0 {
            return Err(Failure::usage("an outline needs --set shape.thickness_mm=N"));
        }
    }
    execute(&settings, &args.model, Path::new(""), Path::new(""), None, Claims::default(), &args.common)
}
