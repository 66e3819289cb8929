//! `grainpath markers`: writes a sheet of corner markers on which a board is photographed.

use grainpath_core::DVec2;
use grainpath_core::spelling::meaning;

use crate::args::Markers;
use crate::{Failure, files, outputs};

/// `grainpath markers`
pub(crate) fn markers(args: &Markers) -> Result<(), Failure> {
    use grainpath_imaging::photo::markers::{marker_sheet_pdf, marker_sheet_svg};
    let size = DVec2::new(args.width_mm, args.height_mm);
    // Written as a negation, the test also refuses NaN.
    if !(size.min_element() >= 20.0 && size.max_element() <= 2000.0) {
        return Err(Failure::usage(format!(
            "{} x {} mm: the rectangle between the markers should be 20 to 2000 mm wide and high",
            size.x, size.y
        )));
    }
    type Sheet = fn(DVec2) -> Vec<u8>;
    let sheets: [(&str, Sheet); 2] =
        [("svg", |size| marker_sheet_svg(size).into_bytes()), ("pdf", marker_sheet_pdf)];
    let bytes = match meaning(&sheets, files::ending(&args.output)) {
        Some(sheet) => sheet(size),
        None => {
            let name = args.output.display();
            return Err(Failure::usage(format!("{name}: a sheet's name should end in .svg or .pdf")));
        }
    };
    outputs::save(&args.output, &bytes)?;
    files::print(&format!("{}\n", args.output.display()));
    Ok(())
}
