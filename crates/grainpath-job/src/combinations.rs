//! Checks of settings against each other.

use crate::choices::{DensityBy, FibreStart, FibreToolKind, GrainMode, GuideKind, LayerShift, Pattern};
use crate::combination_error::{
    Combination, GradedProblem, LayerShiftProblem, LinesProblem, StaggerProblem, WallsProblem,
};
use crate::regions::{JobRegion, RegionPlace};
use crate::settings::{MaterialSection, Settings};
use crate::wall_count::WallCount;

/// Checks all settings of a job against each other. The error names the settings that do not fit
/// together.
pub(crate) fn check(s: &Settings) -> Result<(), Combination> {
    let p = &s.process;
    // The cross-section of a bead is a rectangle with round ends, so its width must be at least its
    // height.
    if p.bead_width_mm < p.layer_height_mm || p.bead_width_mm < p.first_layer_height_mm {
        let height_mm = p.layer_height_mm.max(p.first_layer_height_mm);
        return Err(Combination::BeadWidth { width_mm: p.bead_width_mm, height_mm });
    }
    if p.min_bead_width_mm > p.bead_width_mm {
        let (least_mm, width_mm) = (p.min_bead_width_mm, p.bead_width_mm);
        return Err(Combination::LeastBeadWidth { least_mm, width_mm });
    }
    if p.adaptive_layers && p.adaptive_min_mm > p.adaptive_max_mm {
        return Err(Combination::AdaptiveHeights);
    }
    // A section with several conditions has its own function; the first error ends the check.
    check_outline(s)?;
    check_photos(s)?;
    check_fibre(s)?;
    let bounds = strengths(&s.material);
    // Strength tests run with the low, nominal and high value, so these must be in rising order.
    if let Some(&(key, Some(values))) =
        bounds.iter().find(|(_, v)| v.is_some_and(|[low, mid, high]| low > mid || mid > high))
    {
        return Err(Combination::Strengths { key, values });
    }
    if !s.ct.path.is_empty() {
        // Adaptive layer heights follow from the surface of a mesh, and a scan has no mesh.
        for (set, what) in [
            (!s.shape.mesh.is_empty(), Combination::TwoShapes { first: "shape.mesh", second: "shape.ct" }),
            (p.adaptive_layers, Combination::AdaptiveLayers { shape: "shape.ct" }),
            (s.support.lift_mm > 0.0, Combination::LiftOfScan),
        ] {
            if set {
                return Err(what);
            }
        }
    }
    // `continuous` works without directions; the other patterns here need them from a guide.
    let needs_guide = s.fill.pattern.follows_field() && s.fill.pattern != Pattern::Continuous;
    if needs_guide && s.guide.kind == GuideKind::None {
        return Err(Combination::PatternWithoutGuide(s.fill.pattern));
    }
    if s.guide.kind == GuideKind::Field && s.field.path.is_empty() {
        return Err(Combination::FieldWithoutFile);
    }
    check_deck(s)?;
    // Layers use the angles in turn, so an empty list is not possible.
    let lists =
        [("angles_deg", Some(&s.fill.angles_deg)), ("skin_angles_deg", s.fill.skin_angles_deg.as_ref())];
    for (key, angles) in lists {
        if angles.is_some_and(|a| a.ranges().iter().any(|r| r.angles_deg.is_empty())) {
            return Err(Combination::NoAngle { key });
        }
    }
    if s.fill.skin_angles_deg.is_some() && s.fill.density.is_dense() && s.fill.mass_g.is_none() {
        return Err(Combination::SkinsOfDense);
    }
    check_lines(s)?;
    check_layer_shift(s)?;
    check_graded(s)?;
    check_walls(s)?;
    check_staggered(s)?;
    check_regions(s)
}

/// Checks the settings that a deck of loads needs.
fn check_deck(s: &Settings) -> Result<(), Combination> {
    let (g, of_mesh) = (&s.guide, s.ct.path.is_empty() && s.photo.files.is_empty());
    let problem = match g.deck.is_empty() {
        true if g.deck_step.is_some() => Combination::NoDeck { key: "guide.deck_step" },
        true if g.deck_material => Combination::NoDeck { key: "guide.deck_material" },
        true => return Ok(()),
        false if !g.import.is_empty() => Combination::DeckAndImport,
        false if !of_mesh => Combination::DeckOfOther,
        false => return Ok(()),
    };
    Err(problem)
}

/// Checks the settings of each region with the rules for a whole job.
fn check_regions(s: &Settings) -> Result<(), Combination> {
    if !s.regions.is_empty() && s.fibre.enabled {
        return Err(Combination::RegionsWithFibre);
    }
    let of_file = s.ct.path.is_empty() && s.photo.files.is_empty();
    let one = |(k, region): (usize, &JobRegion)| {
        if !of_file && matches!(region.on, RegionPlace::Mesh(_) | RegionPlace::Face { .. }) {
            return Err(Combination::RegionPlace(k + 1));
        }
        let inside = |problem| Combination::InRegion { number: k + 1, problem: Box::new(problem) };
        check(&s.in_region(region)).map_err(inside)
    };
    s.regions.iter().enumerate().try_for_each(one)
}

/// Checks the settings for sparse infill whose lines are several beads wide.
fn check_lines(s: &Settings) -> Result<(), Combination> {
    let f = &s.fill;
    let problem = if f.lines == 1 {
        return Ok(());
    } else if f.density.is_dense() && f.mass_g.is_none() {
        LinesProblem::Dense
    } else if !f.pattern.takes_several_beads() {
        LinesProblem::Pattern
    } else if s.guide.kind == GuideKind::Grain {
        LinesProblem::Grain
    } else if s.fibre.enabled {
        LinesProblem::Fibre
    } else {
        return Ok(());
    };
    Err(Combination::Lines { lines: f.lines, problem })
}

/// Checks the settings that ends of beads in different places need, where the job asks for such ends.
fn check_layer_shift(s: &Settings) -> Result<(), Combination> {
    let shift = s.fill.layer_shift;
    match layer_shift_problem(s) {
        Some(problem) if matches!(shift, LayerShift::Inner | LayerShift::All) => {
            Err(Combination::LayerShift { shift, problem })
        }
        _ => Ok(()),
    }
}

impl Settings {
    /// Whether the ends of beads can lie in different places from layer to layer (`fill.layer_shift`).
    pub fn allows_layer_shift(&self) -> bool {
        layer_shift_problem(self).is_none()
    }
}

/// Why ends of beads cannot lie in different places from layer to layer.
fn layer_shift_problem(s: &Settings) -> Option<LayerShiftProblem> {
    let f = &s.fill;
    if !f.pattern.takes_layer_shift() {
        Some(LayerShiftProblem::Pattern(f.pattern))
    } else if !f.density.is_dense() || f.mass_g.is_some() {
        Some(LayerShiftProblem::Sparse)
    } else if s.guide.kind == GuideKind::Grain && s.guide.mode == GrainMode::Edges {
        Some(LayerShiftProblem::Edges)
    } else {
        None
    }
}

/// Checks the settings that are needed if the number of walls follows the stress.
fn check_walls(s: &Settings) -> Result<(), Combination> {
    let problem = match s.process.walls {
        WallCount::Even(_) => return Ok(()),
        WallCount::ByStress { .. } if s.guide.kind != GuideKind::Stress => WallsProblem::NoStress,
        WallCount::ByStress { .. } if !s.regions.is_empty() => WallsProblem::Regions,
        WallCount::ByStress { .. } => return Ok(()),
    };
    Err(Combination::Walls(problem))
}

/// Checks the settings that walls raised by half a layer need.
fn check_staggered(s: &Settings) -> Result<(), Combination> {
    let p = &s.process;
    if !p.stagger_walls {
        return Ok(());
    }
    // The first bead of a raised wall is 1.5 layers high.
    let layer_mm = if p.adaptive_layers { p.adaptive_min_mm } else { p.layer_height_mm };
    let highest_mm = 1.5 * layer_mm;
    let problem = if s.fibre.enabled {
        StaggerProblem::Fibre
    } else if p.chain {
        StaggerProblem::Chain
    } else if p.walls.most() < 2 {
        StaggerProblem::OneWall(p.walls.most())
    } else if highest_mm > p.bead_width_mm {
        StaggerProblem::TooHigh { highest_mm, width_mm: p.bead_width_mm }
    } else {
        return Ok(());
    };
    Err(Combination::Staggered(problem))
}

/// Checks the settings that a graded density needs.
fn check_graded(s: &Settings) -> Result<(), Combination> {
    let Some(graded) = s.fill.density.graded() else { return Ok(()) };
    let of_mesh = s.ct.path.is_empty() && s.photo.files.is_empty();
    let problem = match (s.fill.pattern, graded.by) {
        (pattern @ (Pattern::SeedLines | Pattern::Concentric), _) => GradedProblem::Pattern(pattern),
        (_, DensityBy::Stress) if s.guide.kind != GuideKind::Stress => GradedProblem::NoStress,
        (_, DensityBy::File) if !of_mesh => GradedProblem::FileOfOther,
        _ if s.fill.lines > 1 => GradedProblem::Lines,
        _ if s.fibre.enabled => GradedProblem::Fibre,
        _ if s.guide.kind == GuideKind::Grain => GradedProblem::Grain,
        _ => return Ok(()),
    };
    Err(Combination::Graded(problem))
}

/// Checks the settings of drawings.
fn check_outline(s: &Settings) -> Result<(), Combination> {
    let shape = &s.shape;
    let others = [
        ("shape.mesh", !shape.mesh.is_empty()),
        ("shape.ct", !s.ct.path.is_empty()),
        ("shape.photo", !s.photo.files.is_empty()),
    ];
    let problem = match others.iter().find(|o| o.1) {
        _ if shape.outline.is_empty() => return Ok(()),
        Some((other, _)) => Combination::TwoShapes { first: other, second: "shape.outline" },
        None if shape.thickness_mm == 0.0 => Combination::OutlineThickness,
        None => return Ok(()),
    };
    Err(problem)
}

/// Checks the settings of continuous fibre: the printer's tool, and values that belong together.
fn check_fibre(s: &Settings) -> Result<(), Combination> {
    let (f, p) = (&s.fibre, &s.printer);
    if !f.enabled {
        return Ok(());
    }
    if p.fibre_tool == FibreToolKind::None {
        return Err(Combination::NoFibreTool);
    }
    // Without a cut the first piece of fibre would run through the whole print.
    if p.fibre_cut_gcode.trim().is_empty() {
        return Err(Combination::NoFibreCut);
    }
    if p.fibre_tool == FibreToolKind::Separate && p.fibre_tool_number == 0 {
        return Err(Combination::FibreToolNumber);
    }
    if p.fibre_tool == FibreToolKind::Separate && p.tool_change_gcode.trim().is_empty() {
        return Err(Combination::NoToolChange);
    }
    if let Some(range) = f.layers.iter().find(|[a, b]| a > b) {
        return Err(Combination::FibreLayers(*range));
    }
    if let Some(b) = f.boxes_mm.iter().find(|[low, high]| (0..3).any(|k| low[k] >= high[k])) {
        return Err(Combination::FibreBox(*b));
    }
    // As for other beads, the width must be at least the layer height.
    let width = f.bead_width_mm.unwrap_or(s.process.bead_width_mm);
    if width < s.process.layer_height_mm || width < s.process.first_layer_height_mm {
        return Err(Combination::FibreWidth(width));
    }
    if f.start == FibreStart::Calm && s.guide.kind != GuideKind::Stress {
        return Err(Combination::FibreStart);
    }
    // Fibre is laid in the infill, so the part must have infill.
    if s.fill.density.even().is_some_and(|d| d.fraction() == 0.0) {
        return Err(Combination::FibreWithoutInfill);
    }
    if f.matrix_pattern.follows_field() && s.guide.kind == GuideKind::None {
        return Err(Combination::MatrixPattern(f.matrix_pattern));
    }
    Ok(())
}

/// Checks the settings of photographs.
fn check_photos(s: &Settings) -> Result<(), Combination> {
    let photo = !s.photo.files.is_empty();
    for (other, path) in [("shape.mesh", &s.shape.mesh), ("shape.ct", &s.ct.path)] {
        if photo && !path.is_empty() {
            return Err(Combination::TwoShapes { first: other, second: "shape.photo" });
        }
    }
    if photo && (s.photo.size_mm.contains(&0.0) || s.photo.thickness_mm == 0.0) {
        return Err(Combination::PhotoSize);
    }
    if photo && s.process.adaptive_layers {
        return Err(Combination::AdaptiveLayers { shape: "shape.photo" });
    }
    let (image, volume) = (!s.image.files.is_empty(), !s.volume.path.is_empty());
    if image && volume {
        return Err(Combination::ImageAndVolume);
    }
    // The grain may come from the photographs of `shape.photo`, from other photographs, or from a scan.
    if s.guide.kind == GuideKind::Grain && !photo && !image {
        if !volume && s.ct.path.is_empty() {
            return Err(Combination::NoGrain);
        }
        if s.guide.mode == GrainMode::Edges {
            return Err(Combination::EdgesOfScan);
        }
    }
    if photo && volume {
        return Err(Combination::PhotoAndVolume);
    }
    for (section, files, corners, heights) in [
        ("shape.photo", &s.photo.files, &s.photo.corners_px, &s.photo.heights_mm),
        ("guide.image", &s.image.files, &s.image.corners_px, &s.image.heights_mm),
    ] {
        // With a fixed camera four corners hold for all files; otherwise each file needs its own four.
        if ![0, 4, 4 * files.len()].contains(&corners.len()) {
            return Err(Combination::Corners { section, files: files.len(), corners: corners.len() });
        }
        if !heights.is_empty() && heights.len() != files.len() {
            return Err(Combination::Heights { section, files: files.len(), heights: heights.len() });
        }
        // Grain between two photographs is interpolated in this order.
        if heights.windows(2).any(|w| w[0] >= w[1]) {
            return Err(Combination::HeightsFall { section });
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
