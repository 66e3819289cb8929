//! Checks of settings against each other.

use crate::choices::{
    Choice, DensityBy, FibreStart, FibreToolKind, GrainMode, GuideKind, LayerShift, Pattern,
};
use crate::regions::{JobRegion, RegionPlace};
use crate::settings::{MaterialSection, Settings};
use crate::wall_count::WallCount;

/// Checks all settings of a job against each other. The error names the settings that do not fit
/// together.
pub(crate) fn check(s: &Settings) -> Result<(), String> {
    let p = &s.process;
    // The cross-section of a bead is a rectangle with round ends, so its width must be at least its
    // height.
    if p.bead_width_mm < p.layer_height_mm || p.bead_width_mm < p.first_layer_height_mm {
        return Err(format!(
            "process.bead_width_mm ({}) should not be less than the layer height ({})",
            p.bead_width_mm,
            p.layer_height_mm.max(p.first_layer_height_mm)
        ));
    }
    if p.min_bead_width_mm > p.bead_width_mm {
        return Err(format!(
            "process.min_bead_width_mm ({}) should not be more than bead_width_mm ({})",
            p.min_bead_width_mm, p.bead_width_mm
        ));
    }
    if p.adaptive_layers && p.adaptive_min_mm > p.adaptive_max_mm {
        return Err("process.adaptive_min_mm should not be more than adaptive_max_mm".into());
    }
    // A section with several conditions has its own function; the first error ends the check.
    check_outline(s)?;
    check_photos(s)?;
    check_fibre(s)?;
    let bounds = strengths(&s.material);
    // Strength tests run with the low, nominal and high value, so these must be in rising order.
    if let Some((key, Some([a, b, c]))) =
        bounds.iter().find(|(_, v)| v.is_some_and(|[low, mid, high]| low > mid || mid > high))
    {
        return Err(format!("material.{key} should rise: low, nominal, high; is [{a}, {b}, {c}]"));
    }
    if !s.ct.path.is_empty() {
        // Adaptive layer heights follow from the surface of a mesh, and a scan has no mesh.
        for (set, what) in [
            (!s.shape.mesh.is_empty(), "shape.mesh and shape.ct: exactly one shape is printed"),
            (p.adaptive_layers, "process.adaptive_layers = true is for meshes, not for shape.ct"),
            (s.support.lift_mm > 0.0, "support.lift_mm is for meshes, not for shape.ct"),
        ] {
            if set {
                return Err(what.into());
            }
        }
    }
    // `continuous` works without directions; the other patterns here need them from a guide.
    let needs_guide = s.fill.pattern.follows_field() && s.fill.pattern != Pattern::Continuous;
    if needs_guide && s.guide.kind == GuideKind::None {
        return Err(format!(
            "fill.pattern = {:?} needs a guide: [guide] kind = \"stress\", \"field\" or \"angle\"",
            s.fill.pattern.name()
        ));
    }
    if s.guide.kind == GuideKind::Field && s.field.path.is_empty() {
        return Err("guide.kind = \"field\" needs a file of directions: guide.field = \"FILE\"".into());
    }
    check_deck(s)?;
    // Layers use the angles in turn, so an empty list is not possible.
    let lists =
        [("angles_deg", Some(&s.fill.angles_deg)), ("skin_angles_deg", s.fill.skin_angles_deg.as_ref())];
    for (key, angles) in lists {
        if angles.is_some_and(|a| a.ranges().iter().any(|r| r.angles_deg.is_empty())) {
            return Err(format!("fill.{key} should have at least one angle"));
        }
    }
    if s.fill.skin_angles_deg.is_some() && s.fill.density.is_dense() && s.fill.mass_g.is_none() {
        return Err(
            "fill.skin_angles_deg is for skins over sparse infill; with fill.density = 1 there is none"
                .into(),
        );
    }
    check_lines(s)?;
    check_layer_shift(s)?;
    check_graded(s)?;
    check_walls(s)?;
    check_staggered(s)?;
    check_regions(s)
}

/// Checks the settings that a deck of loads needs.
fn check_deck(s: &Settings) -> Result<(), String> {
    let (g, of_mesh) = (&s.guide, s.ct.path.is_empty() && s.photo.files.is_empty());
    let problem = match g.deck.is_empty() {
        true if g.deck_step.is_some() => "guide.deck_step needs a deck: guide.deck = \"FILE.inp\"",
        true if g.deck_material => "guide.deck_material needs a deck: guide.deck = \"FILE.inp\"",
        true => return Ok(()),
        false if !g.import.is_empty() => {
            "guide.deck and guide.import: stress is either solved from the loads of a deck or taken as it is"
        }
        false if !of_mesh => "guide.deck is for parts from meshes and outlines",
        false => return Ok(()),
    };
    Err(problem.into())
}

/// Checks the settings of each region with the rules for a whole job.
fn check_regions(s: &Settings) -> Result<(), String> {
    if !s.regions.is_empty() && s.fibre.enabled {
        return Err("[[region]] is not for fibre.enabled = true; fibre.boxes_mm and fibre.layers say where fibre lies".into());
    }
    let of_file = s.ct.path.is_empty() && s.photo.files.is_empty();
    let one = |(k, region): (usize, &JobRegion)| {
        if !of_file && matches!(region.on, RegionPlace::Mesh(_) | RegionPlace::Face { .. }) {
            let number = k + 1;
            return Err(format!("region[{number}].on: mesh and face are for parts from meshes and outlines"));
        }
        check(&s.in_region(region)).map_err(|problem| format!("in region[{}]: {problem}", k + 1))
    };
    s.regions.iter().enumerate().try_for_each(one)
}

/// Checks the settings for sparse infill whose lines are several beads wide.
fn check_lines(s: &Settings) -> Result<(), String> {
    let f = &s.fill;
    let problem = if f.lines == 1 {
        return Ok(());
    } else if f.density.is_dense() && f.mass_g.is_none() {
        "needs fill.density below 1: the lines of dense infill leave no room between them"
    } else if !f.pattern.takes_several_beads() {
        "is for patterns of separate lines, not for fill.pattern = \"seed-lines\" or \"continuous\""
    } else if s.guide.kind == GuideKind::Grain {
        "is not for guide.kind = \"grain\", whose lines are those of the picture"
    } else if s.fibre.enabled {
        "is not for fibre.enabled = true"
    } else {
        return Ok(());
    };
    Err(format!("fill.lines = {} {problem}", f.lines))
}

/// Checks the settings that ends of beads in different places need.
fn check_layer_shift(s: &Settings) -> Result<(), String> {
    let f = &s.fill;
    let problem = if f.layer_shift == LayerShift::None {
        return Ok(());
    } else if !f.pattern.takes_layer_shift() {
        format!("is for fill.pattern = \"stripes\" or \"continuous\", not for {:?}", f.pattern.name())
    } else if !f.density.is_dense() || f.mass_g.is_some() {
        "needs fill.density = 1: it moves the ends of beads that lie side by side".to_owned()
    } else if s.guide.kind == GuideKind::Grain && s.guide.mode == GrainMode::Edges {
        "is not for guide.mode = \"edges\", whose lines are those of the picture".to_owned()
    } else {
        return Ok(());
    };
    Err(format!("fill.layer_shift = {:?} {problem}", f.layer_shift.name()))
}

/// Error text for a setting that follows the stress while the job has none.
const NEEDS_STRESS: &str =
    "by = \"stress\" needs a stress: [guide] kind = \"stress\" with fixtures and loads, or with guide.import";

/// Checks the settings that are needed if the number of walls follows the stress.
fn check_walls(s: &Settings) -> Result<(), String> {
    let problem = match s.process.walls {
        WallCount::Even(_) => return Ok(()),
        WallCount::ByStress { .. } if s.guide.kind != GuideKind::Stress => NEEDS_STRESS,
        WallCount::ByStress { .. } if !s.regions.is_empty() => {
            "as a table is not for jobs with [[region]]; give the regions numbers of walls of their own"
        }
        WallCount::ByStress { .. } => return Ok(()),
    };
    Err(format!("process.walls {problem}"))
}

/// Checks the settings that walls raised by half a layer need.
fn check_staggered(s: &Settings) -> Result<(), String> {
    let p = &s.process;
    if !p.stagger_walls {
        return Ok(());
    }
    // The first bead of a raised wall is 1.5 layers high.
    let layer_mm = if p.adaptive_layers { p.adaptive_min_mm } else { p.layer_height_mm };
    let highest_mm = 1.5 * layer_mm;
    let problem = if s.fibre.enabled {
        "is not for fibre.enabled = true, whose fibre lies level".to_owned()
    } else if p.chain {
        "is not for process.chain = true, whose path joins walls and infill at one height".to_owned()
    } else if p.walls.most() < 2 {
        format!(
            "needs two walls at least, since the outermost stays level; process.walls is {}",
            p.walls.most()
        )
    } else if highest_mm > p.bead_width_mm {
        format!(
            "begins with beads of {} mm, 1.5 layers, which a bead of {} mm cannot be high; make layers thinner or beads wider",
            (highest_mm * 1e3).round() * 1e-3,
            p.bead_width_mm
        )
    } else {
        return Ok(());
    };
    Err(format!("process.stagger_walls {problem}"))
}

/// Checks the settings that a graded density needs.
fn check_graded(s: &Settings) -> Result<(), String> {
    let Some(graded) = s.fill.density.graded() else { return Ok(()) };
    let of_mesh = s.ct.path.is_empty() && s.photo.files.is_empty();
    let problem = match (s.fill.pattern, graded.by) {
        (Pattern::SeedLines | Pattern::Concentric, _) => {
            return Err(format!(
                "fill.density as a table is not for fill.pattern = {:?}, whose lines cannot end or begin along the way; use \
                 \"stripes\", \"streamlines\" or \"continuous\" along a guide, or \"rectilinear\", \"grid\", \"triangles\", \"gyroid\" or \"honeycomb\"",
                s.fill.pattern.name()
            ));
        }
        (_, DensityBy::Stress) if s.guide.kind != GuideKind::Stress => NEEDS_STRESS,
        (_, DensityBy::File) if !of_mesh => "by = \"file\" is for parts from meshes and outlines",
        _ if s.fill.lines > 1 => "as a table is not for fill.lines above 1",
        _ if s.fibre.enabled => "as a table is not for fibre.enabled = true",
        _ if s.guide.kind == GuideKind::Grain => "as a table is not for guide.kind = \"grain\"",
        _ => return Ok(()),
    };
    Err(format!("fill.density {problem}"))
}

/// Checks the settings of drawings.
fn check_outline(s: &Settings) -> Result<(), String> {
    let shape = &s.shape;
    let others = [
        ("shape.mesh", !shape.mesh.is_empty()),
        ("shape.ct", !s.ct.path.is_empty()),
        ("shape.photo", !s.photo.files.is_empty()),
    ];
    let problem = match others.iter().find(|o| o.1) {
        _ if shape.outline.is_empty() => return Ok(()),
        Some((other, _)) => format!("{other} and shape.outline: exactly one shape is printed"),
        None if shape.thickness_mm == 0.0 => "shape.outline needs shape.thickness_mm".into(),
        None => return Ok(()),
    };
    Err(problem)
}

/// Checks the settings of continuous fibre: the printer's tool, and values that belong together.
fn check_fibre(s: &Settings) -> Result<(), String> {
    let (f, p) = (&s.fibre, &s.printer);
    if !f.enabled {
        return Ok(());
    }
    if p.fibre_tool == FibreToolKind::None {
        return Err(
            "fibre.enabled = true needs a printer with a fibre tool: printer.fibre_tool = \"coextruded\" or \"separate\", or a profile such as fibre-coextruded"
                .into(),
        );
    }
    // Without a cut the first piece of fibre would run through the whole print.
    if p.fibre_cut_gcode.trim().is_empty() {
        return Err(
            "fibre.enabled = true needs printer.fibre_cut_gcode, the program that cuts the fibre".into()
        );
    }
    if p.fibre_tool == FibreToolKind::Separate && p.fibre_tool_number == 0 {
        return Err("printer.fibre_tool_number should not be 0, which is the matrix's".into());
    }
    if p.fibre_tool == FibreToolKind::Separate && p.tool_change_gcode.trim().is_empty() {
        return Err("printer.fibre_tool = \"separate\" needs printer.tool_change_gcode".into());
    }
    if let Some([a, b]) = f.layers.iter().find(|[a, b]| a > b) {
        return Err(format!("fibre.layers should be [first, last] from 1, is [{a}, {b}]"));
    }
    if let Some(b) = f.boxes_mm.iter().find(|[low, high]| (0..3).any(|k| low[k] >= high[k])) {
        return Err(format!("fibre.boxes_mm should be [lowest corner, highest corner], has {b:?}"));
    }
    // As for other beads, the width must be at least the layer height.
    let width = f.bead_width_mm.unwrap_or(s.process.bead_width_mm);
    if width < s.process.layer_height_mm || width < s.process.first_layer_height_mm {
        return Err(format!("fibre.bead_width_mm ({width}) should not be less than the layer height"));
    }
    if f.start == FibreStart::Calm && s.guide.kind != GuideKind::Stress {
        return Err("fibre.start = \"calm\" needs [guide] kind = \"stress\"".into());
    }
    // Fibre is laid in the infill, so the part must have infill.
    if s.fill.density.even().is_some_and(|d| d.fraction() == 0.0) {
        return Err("fibre.enabled = true needs fill.density above 0".into());
    }
    if f.matrix_pattern.follows_field() && s.guide.kind == GuideKind::None {
        return Err(format!("fibre.matrix_pattern = {:?} needs a guide", f.matrix_pattern.name()));
    }
    Ok(())
}

/// Checks the settings of photographs.
fn check_photos(s: &Settings) -> Result<(), String> {
    let photo = !s.photo.files.is_empty();
    for (other, path) in [("shape.mesh", &s.shape.mesh), ("shape.ct", &s.ct.path)] {
        if photo && !path.is_empty() {
            return Err(format!("{other} and shape.photo: exactly one shape is printed"));
        }
    }
    if photo && (s.photo.size_mm.contains(&0.0) || s.photo.thickness_mm == 0.0) {
        return Err("shape.photo needs size_mm = [width, height] and thickness_mm".into());
    }
    if photo && s.process.adaptive_layers {
        return Err("process.adaptive_layers = true is for meshes, not for shape.photo".into());
    }
    let (image, volume) = (!s.image.files.is_empty(), !s.volume.path.is_empty());
    if image && volume {
        return Err("guide.image and guide.volume: exactly one gives the grain".into());
    }
    // The grain may come from the photographs of `shape.photo`, from other photographs, or from a scan.
    if s.guide.kind == GuideKind::Grain && !photo && !image {
        if !volume && s.ct.path.is_empty() {
            return Err(
                "guide.kind = \"grain\" needs photographs or a scan: guide.image = { files = [\"FILE\"] } or guide.volume = { path = \"SCAN\" }".into(),
            );
        }
        if s.guide.mode == GrainMode::Edges {
            return Err("guide.mode = \"edges\" is for photographs; a scan's texture gives directions".into());
        }
    }
    if photo && volume {
        return Err("guide.volume is for meshes and scans; shape.photo has its own grain".into());
    }
    for (section, files, corners, heights) in [
        ("shape.photo", &s.photo.files, &s.photo.corners_px, &s.photo.heights_mm),
        ("guide.image", &s.image.files, &s.image.corners_px, &s.image.heights_mm),
    ] {
        // With a fixed camera four corners hold for all files; otherwise each file needs its own four.
        if ![0, 4, 4 * files.len()].contains(&corners.len()) {
            return Err(format!(
                "{section}.corners_px should have 4 corners, or 4 for each of the {} files; it has {}",
                files.len(),
                corners.len()
            ));
        }
        if !heights.is_empty() && heights.len() != files.len() {
            return Err(format!(
                "{section}.heights_mm should have a height for each of the {} files; it has {}",
                files.len(),
                heights.len()
            ));
        }
        // Grain between two photographs is interpolated in this order.
        if heights.windows(2).any(|w| w[0] >= w[1]) {
            return Err(format!("{section}.heights_mm should rise from file to file"));
        }
    }
    Ok(())
}

/// The strengths of a material card, by key.
pub(super) fn strengths(m: &MaterialSection) -> [(&'static str, Option<[f64; 3]>); 9] {
    [
        ("xt_mpa", m.xt_mpa),
        ("yt_mpa", m.yt_mpa),
        ("zt_mpa", m.zt_mpa),
        ("s12_mpa", m.s12_mpa),
        ("s_il_mpa", m.s_il_mpa),
        ("xc_mpa", m.xc_mpa),
        ("yc_mpa", m.yc_mpa),
        ("g_along_n_mm", m.g_along_n_mm),
        ("g_across_n_mm", m.g_across_n_mm),
    ]
}
