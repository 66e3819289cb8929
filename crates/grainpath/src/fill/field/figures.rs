//! The figures of the phase and of stripes.

use std::f64::consts::TAU;

use crate::fill::figure::{BLUE, Figure, Panel, RED, hold};
use grainpath_core::field_mesh::FieldMesh;
use grainpath_core::math::{atan2, cos, direction};
use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::{DVec2, DVec3, Density, DirectionField, DirectionSample, Polygon, Region, Role};

use super::levels::{Level, trace};
use super::stripes::{dense, diffusion, phase_input};
use crate::fill::FillContext;
use grainpath_core::phase::{PhaseInput, drift, solve, turns};
use grainpath_job::choices::BeadWidths;

const CRATE: &str = env!("CARGO_MANIFEST_DIR");

/// A field given by its angle.
struct Angle<F>(F);

impl<F: Fn(DVec2) -> f64 + Send + Sync> DirectionField for Angle<F> {
    fn sample(&self, p: DVec3) -> DirectionSample {
        DirectionSample { axis_rad: (self.0)(p.truncate()), strength: 1.0, principal_mpa: None }
    }
}

/// Short strokes along the field on a square grid inside a region.
fn strokes(figure: &mut Figure, panel: &Panel, region: &Region, step_mm: f64, axis: &dyn Fn(DVec2) -> DVec2) {
    let bounds = region.bounds().expect("not empty");
    let n = (bounds.size() / step_mm).floor();
    let mut all = Vec::new();
    for j in 0..n.y as usize {
        for i in 0..n.x as usize {
            let p = bounds.min + step_mm * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
            if region.contains(p) {
                let half = 0.3 * step_mm * axis(p);
                all.push((vec![p - half, p + half], false));
            }
        }
    }
    figure.lines(panel, &all, &format!("stroke=\"{BLUE}\" stroke-width=\"1.2\""));
}

/// The parts of level lines inside a region, as open lines.
fn clipped(region: &LineClipper, levels: &[Level]) -> Vec<(Vec<DVec2>, bool)> {
    let pieces = levels.iter().flat_map(|level| {
        let mut points = level.points.clone();
        if level.closed {
            points.extend(level.points.first());
        }
        region.clip(&points)
    });
    pieces.map(|piece| (piece.points, false)).collect()
}

#[test]
fn the_figure_of_the_phase() {
    // Axes fan out from a point on the left, so that there is space for more beads on the right.
    let region = Region::rectangle(DVec2::ZERO, DVec2::new(12.0, 6.0));
    let source = DVec2::new(-9.0, 3.0);
    let axis = |p: DVec2| (p - source).normalize();
    let spacing_mm = 0.75;
    let mesh = FieldMesh::over(&region, 0.2).expect("a mesh");
    let axes: Vec<DVec2> = mesh.nodes.iter().map(|p| axis(*p)).collect();
    let n = mesh.nodes.len();
    let input = PhaseInput {
        frequency: drift(&mesh, &axes, 1e-3).into_iter().map(|f| f / spacing_mm).collect(),
        axes,
        strength: vec![1.0; n],
        wanted: vec![(0.0, 0.0); n],
    };
    let turns = turns(&mesh, &input);
    // On squares this small the wider steps make lines begin.
    let phase = solve(&mesh, &input, &turns, &diffusion(BeadWidths::Constant));
    let levels = trace(&mesh, &turns, &phase);

    let mut figure = Figure::new(640.0, 190.0);
    let panels = [12.0, 328.0].map(|x| Panel { corner: [x, 160.0], low: DVec2::ZERO, scale: 25.0 });
    strokes(&mut figure, &panels[0], &region, 1.0, &axis);
    figure.area(&panels[0], &region, "fill=\"none\" stroke=\"#000\"");
    figure.text([162.0, 178.0], "middle", "#000", "axis of the field, which fans out");
    // Five greys, and one element for a run of squares of one grey: the file stays small.
    let grey = |k: usize| 95 + 40 * (2.0 + 2.0 * cos(phase[k])).round() as u8;
    let inside: Vec<usize> = (0..n).filter(|k| region.contains(mesh.nodes[*k])).collect();
    let follows = |a: &usize, b: &usize| {
        let step = mesh.nodes[*b] - mesh.nodes[*a];
        step.y.abs() < 1e-9 && (step.x - mesh.cell_mm).abs() < 1e-9 && grey(*a) == grey(*b)
    };
    for run in inside.chunk_by(follows) {
        let first = mesh.nodes[run[0]];
        figure.squares(&panels[1], first, mesh.cell_mm, run.len(), grey(run[0]));
    }
    let clipper = LineClipper::new(&region);
    let lines = clipped(&clipper, &levels);
    figure.lines(&panels[1], &lines, &format!("stroke=\"{RED}\" stroke-width=\"1.6\""));
    // Ends inside the region: there the phase misses a turn.
    let border = region.offset(-0.6, Join::Miter(2.0));
    let ends = lines.iter().flat_map(|(points, _)| [points.first(), points.last()]).flatten();
    let ends: Vec<DVec2> = ends.copied().filter(|p| border.contains(*p)).collect();
    assert!(!ends.is_empty(), "the fan needs more beads on the right");
    for end in &ends {
        figure.dot(&panels[1], *end, 5.0, "fill=\"none\" stroke=\"#000\" stroke-width=\"1.5\"");
    }
    figure.area(&panels[1], &region, "fill=\"none\" stroke=\"#000\"");
    figure.text([478.0, 178.0], "middle", "#000", "phase as grey, levels in red; circles: a bead begins");
    hold(CRATE, "../grainpath-core/src/figures/phase.svg", &figure.svg());
}

#[test]
fn the_figure_of_stripes() {
    // The flow around a hole: beads crowd beside it, and some have to end.
    let hole_mm = 2.4;
    let circle = (0..48).map(|i| hole_mm * direction(-f64::from(i) / 48.0 * TAU)).collect();
    let outer = [(-8.0, -5.0), (8.0, -5.0), (8.0, 5.0), (-8.0, 5.0)].map(DVec2::from).to_vec();
    let part = Region::from(Polygon { outer, holes: vec![circle] });
    let flow = Angle(|p: DVec2| {
        // The velocity is the conjugate of 1 - a^2 / z^2.
        let square =
            DVec2::new(p.x * p.x - p.y * p.y, 2.0 * p.x * p.y) / p.length_squared().powi(2).max(1e-9);
        let velocity = DVec2::new(1.0 - hole_mm * hole_mm * square.x, -hole_mm * hole_mm * square.y);
        atan2(velocity.y, velocity.x)
    });
    let width_mm = 0.7;
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
        widths: BeadWidths::Variable,
        field: Some(&flow),
    };
    let infill_region = part.offset(-0.5 * width_mm, Join::Miter(3.0));
    let border = infill_region.offset(context.border_mm, Join::Miter(2.0));
    let mesh = FieldMesh::over(&border, 1.1 * context.spacing_mm()).expect("a mesh");
    let input = phase_input(&mesh, &flow, &context, &border, context.spacing_mm());
    let turns = turns(&mesh, &input);
    let phase = solve(&mesh, &input, &turns, &diffusion(BeadWidths::Variable));
    let clipper = LineClipper::new(&infill_region);
    let levels = clipped(&clipper, &trace(&mesh, &turns, &phase));
    let mut beads = Vec::new();
    dense(&context, &infill_region.polygons[0], &mut beads);

    let mut figure = Figure::new(640.0, 222.0);
    let panels = [8.0, 328.0].map(|x| Panel { corner: [x, 198.0], low: DVec2::new(-8.0, -5.0), scale: 19.0 });
    figure.area(&panels[0], &part, "fill=\"#fff\" stroke=\"#000\"");
    figure.lines(&panels[0], &levels, &format!("stroke=\"{RED}\" stroke-width=\"1.2\""));
    figure.text([160.0, 214.0], "middle", "#000", "levels of the phase");
    for bead in &beads {
        let style = format!("fill=\"#9fc3e6\" stroke=\"{BLUE}\" stroke-width=\".6\"");
        figure.bead(&panels[1], bead, &style);
    }
    figure.area(&panels[1], &part, "fill=\"none\" stroke=\"#000\"");
    let caption = "beads: centred, joined at the border, as wide as their space";
    figure.text([480.0, 214.0], "middle", "#000", caption);
    hold(CRATE, "src/fill/field/figures/stripes.svg", &figure.svg());
}
