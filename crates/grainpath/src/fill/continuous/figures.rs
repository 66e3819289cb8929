//! The figure of strips, cells and the path through them.

use crate::fill::figure::{BLUE, Figure, GREEN, GREY, Panel, hold};
use grainpath_core::math::{direction, sin_cos};
use grainpath_core::poly::Join;
use grainpath_core::{DVec2, DVec3, Density, DirectionField, DirectionSample, Polygon, Region, Role};

use super::cells::{self, Taken};
use super::rings::{Facing, Rings};
use super::{Continuous, Pull, cell_tree, strips};
use crate::fill::FillContext;

/// Axes that wave along x.
struct Waves;

impl DirectionField for Waves {
    fn sample(&self, p: DVec3) -> DirectionSample {
        let axis_rad = 0.5 * sin_cos(p.x / 3.5).0;
        DirectionSample { axis_rad, strength: 1.0, principal_mpa: None }
    }
}

#[test]
fn the_figure_of_strips_and_cells() {
    let (low, high) = (DVec2::ZERO, DVec2::new(18.0, 11.0));
    let hole = (0..36)
        .map(|i| DVec2::new(12.0, 5.0) + 2.0 * direction(-f64::from(i) / 36.0 * std::f64::consts::TAU));
    let outer = vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let part = Region::from(Polygon { outer, holes: vec![hole.collect()] });
    let width_mm = 0.8;
    let context = FillContext {
        z_mid_mm: 0.1,
        height_mm: 0.2,
        bead_width_mm: width_mm,
        min_bead_width_mm: 0.2,
        density: Density::Dense,
        angle_rad: 0.0,
        part: part.bounds().expect("not empty"),
        role: Role::SolidFill,
        border_mm: 0.5 * width_mm,
        ends: grainpath_job::choices::BeadEnds::Joined,
        shift: crate::fill::Shift::NONE,
        below: None,
        fills_wedges: true,
        widths: grainpath_job::choices::BeadWidths::Variable,
        field: Some(&Waves),
    };
    let fill = Continuous::FOR_TESTS;
    let infill_region = part.offset(-0.5 * width_mm, Join::Miter(3.0)).polygons.remove(0);
    let spacing = context.spacing_mm();
    let pull = Pull::new(&context, &infill_region);
    let outlines = strips::outlines(&context, &infill_region, &pull, spacing);
    let rings = Rings::new(outlines.clone(), &infill_region, spacing);
    let mut taken = Taken::new(&rings, 0.25 * spacing);
    let cells =
        cells::cut(&rings, 2.0 * fill.aspect * spacing, spacing, crate::fill::Shift::NONE, &mut taken);
    let exchanges = cell_tree::join(
        &rings,
        &cells,
        fill.tree,
        spacing,
        crate::fill::Shift::NONE,
        &|p| pull.at(p),
        &mut taken,
    );
    let (mut paths, mut notes) = (Vec::new(), Vec::new());
    fill.lay_island(&context, &[&infill_region], &mut paths, &mut notes);
    assert_eq!((paths.len(), notes.len()), (1, 0), "one path: {notes:?}");

    let across = |f: &Facing| {
        let [a0, a1, b0, b1] = f.corners;
        (vec![0.5 * (a0 + a1), 0.5 * (b0 + b1)], false)
    };
    let cuts: Vec<_> = cells.cuts.iter().map(across).collect();
    let joints: Vec<_> = exchanges.iter().map(across).collect();

    let mut figure = Figure::new(690.0, 162.0);
    let panels = [6.0, 236.0, 466.0].map(|x| Panel { corner: [x, 142.0], low, scale: 12.0 });
    let strips: Vec<_> = outlines.into_iter().map(|o| (o, true)).collect();
    for panel in &panels {
        figure.area(panel, &part, "fill=\"#fff\" stroke=\"#000\"");
    }
    figure.lines(&panels[0], &strips, &format!("stroke=\"{BLUE}\" stroke-width=\"1.3\""));
    figure.text([114.0, 156.0], "middle", "#000", "1 strips, two beads wide, along the field");
    figure.lines(&panels[1], &strips, "stroke=\"#9fc3e6\" stroke-width=\"1.3\"");
    figure.lines(
        &panels[1],
        &cuts,
        &format!("stroke=\"{GREY}\" stroke-width=\"1\" stroke-dasharray=\"2 1.5\""),
    );
    figure.lines(&panels[1], &joints, &format!("stroke=\"{GREEN}\" stroke-width=\"2.6\""));
    figure.text([344.0, 156.0], "middle", "#000", "2 cells (dashed); 3 joints of the tree (green)");
    let path = (paths[0].points.clone(), true);
    figure.lines(&panels[2], &[path], &format!("stroke=\"{BLUE}\" stroke-width=\"1.6\""));
    figure.text([574.0, 156.0], "middle", "#000", "4, 5 one closed path, centred");
    hold(env!("CARGO_MANIFEST_DIR"), "src/fill/continuous/figures/strips.svg", &figure.svg());
}
