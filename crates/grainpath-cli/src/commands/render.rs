//! `grainpath render`: draws a layer or the whole part of a G-code program.

use std::path::Path;

use grainpath::Planned;
use grainpath::measure::report::direction_error;
use grainpath_core::Bounds2;
use grainpath_core::spelling::meaning;
use grainpath_gcode::{Bead, Program};
use grainpath_view::layer::LayerPicture;

use crate::args::Render;
use crate::claims::Claims;
use crate::inputs::{plan, read_job, read_program};
use crate::{Failure, files, outputs, progress};

/// `grainpath render`
pub(crate) fn render(args: &Render) -> Result<(), Failure> {
    use grainpath_view::layer::{ColourBy, Ground, PictureOptions, layer_png, layer_svg, thumbnail_png};
    let program = read_program(&args.gcode)?;
    let n = program.layers.len();
    if n == 0 {
        return Err(Failure::input(format!("{}: nothing is printed in it", args.gcode.display())));
    }
    let output = args.output.clone().unwrap_or_else(|| args.gcode.with_extension("png"));
    let mut claims = Claims::default();
    claims.read("program", &args.gcode);
    args.job.iter().for_each(|job| claims.read("--job", job));
    claims.write("--output", &output);
    claims.check()?;
    let bytes = if args.part {
        let layers: Vec<_> = program.layers.iter().map(LayerPicture::from).collect();
        thumbnail_png(&layers, args.size, args.size * 3 / 4, Ground::Paper)
    } else {
        // The middle layer shows the fill; the first and the last show brims and skins.
        let layer = args.layer.unwrap_or(n.div_ceil(2));
        if layer == 0 || layer > n {
            return Err(Failure::usage(format!("--layer {layer} should be from 1 to {n}")));
        }
        let mut picture = LayerPicture::from(&program.layers[layer - 1]);
        if let Some(job) = &args.job {
            compare_with_job(&mut picture, &program, job)?;
        }
        let options = PictureOptions {
            colour_by: ColourBy::from_name(&args.color).unwrap_or_default(),
            size_px: args.size,
            travels: !args.no_travels,
            window: None,
        };
        type Draw = fn(&LayerPicture, &PictureOptions) -> Vec<u8>;
        let formats: [(&str, Draw); 2] =
            [("svg", |picture, options| layer_svg(picture, options).into_bytes()), ("png", layer_png)];
        match meaning(&formats, files::ending(&output)) {
            Some(draw) => draw(&picture, &options),
            None => {
                return Err(Failure::usage(format!(
                    "{}: a picture's name should end in .png or .svg",
                    output.display()
                )));
            }
        }
    };
    outputs::save(&output, &bytes)?;
    files::print(&format!("{}\n", output.display()));
    Ok(())
}

/// Plans a job and compares the infill beads of a layer with the directions that the job's guide asks for.
fn compare_with_job(picture: &mut LayerPicture, program: &Program, job: &Path) -> Result<(), Failure> {
    let (settings, shape, folder) = read_job(job, &[])?;
    let diagnostics = progress::diagnostics();
    let (planned, _) = plan(&settings, &shape, &folder, &diagnostics)?;
    if tell_directions(picture, program, &planned) {
        return Ok(());
    }
    Err(Failure::usage(format!("{}: the job has no guide that asks for directions", job.display())))
}

/// Stores in each infill bead its angle to the direction that the plan's guide asks for; `false` if the plan has no such
/// guide. The program may come from any slicer, so the printed part is aligned with the planned one by their centres.
pub fn tell_directions(picture: &mut LayerPicture, program: &Program, planned: &Planned) -> bool {
    let Some(off) = direction_error(planned) else { return false };
    // Skirts and supports are left out: they lie outside the part and would shift its centre.
    let printed = program.layers.iter().flat_map(|l| &l.beads).filter(|b| b.role.is_part());
    let printed = Bounds2::around_points(printed.flat_map(|b| [b.start(), b.end()]));
    let part = planned.stack.layers().iter().filter_map(|l| l.region().bounds()).reduce(Bounds2::union);
    let (Some(printed), Some(part)) = (printed, part) else { return true };
    let shift = printed.centre() - part.centre();
    let z_mid = picture.z_mm - 0.5 * picture.height_mm;
    for bead in picture.beads.iter_mut().filter(|b| b.role.is_fill()) {
        bead.off_deg = off(z_mid, [bead.a - shift, bead.b - shift]).map(|found| found.0);
    }
    true
}

/// The angle of each bead of a plan's own program to the direction that its guide asks for, degrees, as `told` tells it; `told`
/// gets `None` for beads of which the guide asks nothing. `None` if the plan has no such guide.
pub fn angles_to_guide<T>(
    program: &Program,
    planned: &Planned,
    told: impl Fn(Option<f64>) -> T,
) -> Option<Vec<Vec<T>>> {
    let off = direction_error(planned)?;
    let shift = planned.plan.plate_from_part_mm.truncate();
    let layers = program.layers.iter().map(|layer| {
        // Guides are read at mid-height of the layer, where its section was cut.
        let z_mid_mm = layer.z_mm - 0.5 * layer.height_mm;
        let angle = |bead: &Bead| {
            let ends = [bead.start() - shift, bead.end() - shift];
            // A weight of zero says that no direction is better than another here.
            let found = Some(bead).filter(|b| b.role.is_part()).and_then(|_| off(z_mid_mm, ends));
            told(found.filter(|(_, weight)| *weight > 0.0).map(|(deg, _)| deg))
        };
        layer.beads.iter().map(angle).collect()
    });
    Some(layers.collect())
}
