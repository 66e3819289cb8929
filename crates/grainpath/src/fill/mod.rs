//! Infill patterns: they lay beads inside the walls.
//!
//! A pattern gets the area in which centrelines may lie, and lays paths there; it never looks at other
//! layers. The density is the volume of the beads over the volume of the area to be filled.

mod bridge;
mod concentric;
mod continuous;
pub mod curves;
mod field;
pub(crate) mod density_windows;
mod gap_lines;
#[cfg(test)]
#[path = "../../../../tests/figure.rs"]
mod figure;
pub mod graded_infill;
mod gyroid;
mod hatch;
mod honeycomb;
mod lines_below;
mod rectilinear;
pub(crate) mod shift;
mod side_by_side;
mod spaced;
mod spiral;

use grainpath_core::poly::Join;
use grainpath_core::{Bounds2, DVec2, Density, DirectionField, Polygon, Region, Role, Toolpath};

pub use bridge::bridge_angle_rad;
pub use concentric::Concentric;
pub use continuous::{Continuous, Note, Problem, TreeKind};
pub(crate) use field::band;
pub(crate) use field::is_streamlines;
pub use field::{SeedLines, Streamlines, Stripes};
use grainpath_job::choices::{BeadEnds, BeadWidths, Pattern};
pub use gyroid::Gyroid;
pub use honeycomb::Honeycomb;
pub(crate) use lines_below::HELD;
pub use lines_below::LinesBelow;
pub use rectilinear::{Crossed, Rectilinear, Solid};
pub use shift::{Ends, Shift};
pub use side_by_side::{LineFit, SideBySide};
pub(crate) use spiral::join_rings;

/// What a pattern needs to know of a layer.
#[derive(Clone, Copy)]
pub struct FillContext<'a> {
    /// Height of the layer's middle above the plate, mm.
    pub z_mid_mm: f64,
    /// Thickness of the layer, mm.
    pub height_mm: f64,
    /// Full width of a bead, mm.
    pub bead_width_mm: f64,
    /// Width of the narrowest bead that the job allows, mm. As wide as a bead where no bead may be narrower, as of fibre.
    pub min_bead_width_mm: f64,
    /// Density of the infill; the fraction is above 0.
    pub density: Density,
    /// Direction of the lines from +X, radians.
    pub angle_rad: f64,
    /// Bounds of the whole part in plan. They align the lines of different islands and layers.
    pub part: Bounds2,
    /// Role of the paths.
    pub role: Role,
    /// Distance from the area for centrelines to the edge of the area to be filled, mm. At that edge the
    /// strips of the surrounding beads begin.
    pub border_mm: f64,
    /// How beads along a field end at the border: joined or open.
    pub ends: BeadEnds,
    /// Whether beads along a field widen and narrow with the space they have.
    pub widths: BeadWidths,
    /// Where beads end, so that they differ from layer to layer.
    pub shift: Shift,
    /// Lines of the highest layer below with the same directions; lines along a field go on from them.
    pub below: Option<&'a LinesBelow>,
    /// Whether straight solid lines fill the wedges beside borders that they meet at a small angle.
    pub fills_wedges: bool,
    /// Direction field for the patterns that follow one.
    pub field: Option<&'a dyn DirectionField>,
}

impl FillContext<'_> {
    /// Distance between the centrelines of beads that touch, mm.
    pub fn spacing_mm(&self) -> f64 {
        grainpath_core::units::bead_spacing_mm(self.bead_width_mm, self.height_mm)
    }

    /// Whether all beads have one width without exception, as those of fibre.
    pub(crate) fn is_one_width(&self) -> bool {
        self.widths == BeadWidths::Constant && self.min_bead_width_mm >= self.bead_width_mm
    }

    /// Whether beads run up to the border and end there.
    ///
    /// A joint as wide as its beads lies twice over their ends and off the field, and only beads of varying width can be
    /// joined by a narrower one. Measured: table of fields in docs/stress.md; on a radial disk beads of one width lie 6.5
    /// degrees off with joints and 3.2 without, with 4.7 and 3.7 % laid twice. Fibre is joined, for each of its ends is a cut.
    pub(crate) fn has_open_ends(&self) -> bool {
        match self.ends {
            BeadEnds::Open => true,
            BeadEnds::Joined => false,
            BeadEnds::Auto => {
                self.widths == BeadWidths::Constant && self.density.is_dense() && !self.is_one_width()
            }
        }
    }

    /// Whether a bead at this place lies on the layer below; everywhere where lines do not go on from one.
    pub(crate) fn is_held(&self, place: DVec2) -> bool {
        self.below.is_none_or(|below| below.holds(place, self.bead_width_mm))
    }

    /// Whether the field asks for distances of its own in an area; these then decide the density.
    pub(crate) fn field_asks(&self, infill_region: &Polygon) -> bool {
        let at = infill_region.outer.first().zip(self.field);
        at.is_some_and(|(p, field)| field.spacing_mm(p.extend(self.z_mid_mm)).is_some())
    }

    /// The volume that beads along a field should have in an area for centrelines, mm3: the share of the area to be
    /// filled, which reaches `border_mm` further, that the density asks for.
    pub(crate) fn wanted_mm3(&self, infill_region: &Polygon) -> f64 {
        let filled = Region::from(infill_region.clone()).offset(self.border_mm, Join::Miter(2.0));
        self.density.fraction() * filled.area_mm2() * self.height_mm
    }
}

/// Fills one polygon of one layer with paths whose centrelines stay inside it.
///
/// The result depends only on the polygon and the context. Everything else that depends on other layers, such as
/// bridges and skins, has been decided before.
pub trait Infill: Send + Sync {
    /// Adds paths to `out`, or nothing if no path fits.
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>);
}

/// The implementation of a pattern; `continuous` is that of the pattern of this name, which has settings of its own.
pub fn infill(pattern: Pattern, continuous: &Continuous) -> &dyn Infill {
    match pattern {
        // The two differ only in the raster angles that the caller gives layer by layer.
        Pattern::Rectilinear | Pattern::Aligned => &Rectilinear,
        Pattern::Grid => &Crossed { directions: 2 },
        Pattern::Triangles => &Crossed { directions: 3 },
        Pattern::Gyroid => &Gyroid,
        Pattern::Concentric => &Concentric,
        Pattern::Honeycomb => &Honeycomb,
        Pattern::Stripes => &Stripes,
        Pattern::Streamlines => &Streamlines,
        Pattern::SeedLines => &SeedLines,
        Pattern::Continuous => continuous,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::failure_svg::FailurePicture;
    use grainpath_core::math::direction;
    use grainpath_core::{BeadWidth, DVec2};
    use grainpath_job::choices::Choice;

    pub(super) fn outlines() -> Vec<(&'static str, Region)> {
        let disc = |r: f64, n: usize| {
            let outer = (0..n).map(|i| direction(i as f64 / n as f64 * std::f64::consts::TAU) * r).collect();
            Region::from(Polygon { outer, holes: Vec::new() })
        };
        let square = Region::rectangle(DVec2::splat(-30.0), DVec2::splat(30.0));
        let l = square.difference(&Region::rectangle(DVec2::ZERO, DVec2::splat(31.0)));
        vec![
            ("square", square.clone()),
            ("disc", disc(30.0, 90)),
            ("ring", disc(35.0, 120).difference(&disc(12.0, 60))),
            ("l", l),
            (
                "triangle",
                Region::from(Polygon { outer: disc(40.0, 3).polygons[0].outer.clone(), holes: Vec::new() }),
            ),
        ]
    }

    static FIELD: grainpath_core::UniformField = grainpath_core::UniformField { axis_rad: 0.4 };

    pub(super) fn context(density: f64, angle_rad: f64, z_mid_mm: f64) -> FillContext<'static> {
        let part = Bounds2 { min: DVec2::splat(-40.0), max: DVec2::splat(40.0) };
        let role = Role::SparseFill;
        let border_mm = 0.5 * grainpath_core::units::bead_spacing_mm(0.45, 0.2);
        FillContext {
            z_mid_mm,
            height_mm: 0.2,
            bead_width_mm: 0.45,
            min_bead_width_mm: 0.2,
            density: Density::new(density),
            angle_rad,
            part,
            role,
            border_mm,
            ends: BeadEnds::Joined,
            shift: Shift::NONE,
            below: None,
            fills_wedges: true,
            widths: BeadWidths::Variable,
            field: Some(&FIELD),
        }
    }

    fn volume_share(pattern: Pattern, region: &Region, density: f64) -> f64 {
        // Only the gyroid differs from height to height. The others repeat after two raster angles.
        let layers = if pattern == Pattern::Gyroid { 40 } else { 2 };
        let mut sum = 0.0;
        for layer in 0..layers {
            let angle = if layer % 2 == 0 { 0.8 } else { 2.3 };
            let context = context(density, angle, 0.2 * f64::from(layer));
            let mut paths = Vec::new();
            region
                .polygons
                .iter()
                .for_each(|p| infill(pattern, &Continuous::FOR_TESTS).fill(&context, p, &mut paths));
            sum += paths.iter().map(|p| p.volume_mm3(0.2)).sum::<f64>();
        }
        sum / (region.area_mm2() * 0.2 * f64::from(layers))
    }

    /// The range of the volume share that a pattern may lay: about 1.3 times what was measured.
    fn expected_share(
        pattern: Pattern,
        outline: &str,
        region: &Region,
        density: f64,
    ) -> std::ops::Range<f64> {
        let context = context(density, 0.8, 0.1);
        let mm2 = region.area_mm2();
        // The share of one bead along the whole border.
        let border =
            region.polygons.iter().map(Polygon::perimeter_mm).sum::<f64>() * context.spacing_mm() / mm2;
        let within = |off: f64| density - off..density + off;
        match pattern {
            // Pieces of the border that join the lines come on top of the density. A zigzag runs along every other
            // piece, which is up to half of the border for each direction. Pieces at a flat angle are left out.
            Pattern::Rectilinear | Pattern::Aligned => density + 0.25 * border..density + 0.53 * border,
            Pattern::Grid => density + 0.45 * border..density + 1.05 * border,
            // Lines of one direction are far apart, and few of them meet a round border.
            Pattern::Triangles => density + 0.45 * border..density + 1.15 * border,
            // The waves are cut at the border, so that only the rounding of their number remains.
            Pattern::Gyroid => within(0.011 * density),
            // Cells are cut at the border.
            Pattern::Honeycomb => within(0.005),
            // Loops have a whole number. On an L and a ring, the last ones run out in the middle.
            Pattern::Concentric if ["l", "ring"].contains(&outline) => within(0.016),
            Pattern::Concentric => within(0.0005),
            // Rings have a whole number, and their widths cannot make up for it in the sharp corners of the triangle.
            Pattern::Continuous if outline == "triangle" => {
                density..density + if density < 0.15 { 0.028 } else { 0.0135 }
            }
            Pattern::Continuous => within(0.005),
            // On a ring one line more or less fits beside the first.
            Pattern::SeedLines if outline == "ring" => within(0.0039),
            Pattern::SeedLines => within(0.0016),
            // Widths of the lines are scaled to the volume of the area to be filled, which begins at the strips of
            // the surrounding beads.
            Pattern::Streamlines | Pattern::Stripes => {
                let filled = region.offset(context.border_mm, Join::Miter(2.0)).area_mm2();
                let share = density * filled / mm2;
                0.999 * share..1.001 * share
            }
        }
    }

    #[test]
    fn every_pattern_has_the_density_asked_for() {
        let mut wrong = Vec::new();
        for pattern in Pattern::ALL.iter().copied() {
            for (outline, region) in outlines() {
                for density in [0.1, 0.2, 0.4] {
                    let found = volume_share(pattern, &region, density);
                    let expected = expected_share(pattern, outline, &region, density);
                    if !expected.contains(&found) {
                        let name = pattern.name();
                        wrong.push(format!(
                            "{name} on {outline} at {density}: {found:.4}, not in {expected:.4?}"
                        ));
                    }
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn paths_stay_in_the_region_and_come_out_the_same() {
        for pattern in Pattern::ALL.iter().copied() {
            for (outline, region) in outlines() {
                let grown = region.offset(1e-3, Join::Miter(5.0));
                let draw = || {
                    let mut paths = Vec::new();
                    let context = context(0.25, 0.3, 1.1);
                    region
                        .polygons
                        .iter()
                        .for_each(|p| infill(pattern, &Continuous::FOR_TESTS).fill(&context, p, &mut paths));
                    paths
                };
                let paths = draw();
                let mut picture = FailurePicture::new("fill in the region");
                picture.region("region", &region);
                paths.iter().for_each(|p| picture.line(pattern.name(), &p.points));
                assert_eq!(paths, draw());
                assert!(!paths.is_empty(), "{} on {outline}", pattern.name());
                for p in paths.iter().flat_map(|p| &p.points) {
                    if !grown.contains(*p) {
                        picture.point("outside", *p);
                    }
                    assert!(grown.contains(*p), "{} on {outline}: {p} is outside", pattern.name());
                }
            }
        }
    }

    #[test]
    fn dense_lines_have_the_volume_of_the_region_and_half_a_spacing_around_it() {
        for (outline, region) in outlines() {
            for angle in [0.0, 0.3, 0.8, std::f64::consts::FRAC_PI_2] {
                let context = context(1.0, angle, 0.1);
                let mut paths = Vec::new();
                region.polygons.iter().for_each(|p| Solid.fill(&context, p, &mut paths));
                let volume: f64 = paths.iter().map(|p| p.volume_mm3(0.2)).sum();
                let filled = region.offset(0.5 * context.spacing_mm(), Join::Miter(3.0));
                let mut picture = FailurePicture::new("dense lines");
                picture.region("filled", &filled);
                paths.iter().for_each(|p| picture.line("line", &p.points));
                let expected = filled.area_mm2() * 0.2;
                assert!(
                    (volume / expected - 1.0).abs() < 0.01,
                    "{outline} at {angle}: {}",
                    volume / expected
                );
                // Beads in wedges have widths of their own.
                let n = paths.iter().filter(|p| matches!(p.width, BeadWidth::Constant(_))).count();
                assert!(n <= 40, "{outline} at {angle}: {n} paths of lines");
            }
        }
    }

    #[test]
    fn crumbs_and_slivers_do_no_harm() {
        // A bead along a field reaches a tenth of a spacing out of a sliver. A shape without area has no inside, so its
        // offsets, of up to half a step, lie outside.
        // The origin is the centre of the rasters, so lines and waves pass through it.
        let shapes = [DVec2::ZERO, DVec2::new(0.13, 0.21)].map(|corner| {
            let sliver = vec![corner, corner + DVec2::new(10.0, 0.0), corner + DVec2::new(10.0, 1e-4)];
            let crumb = vec![corner, corner + DVec2::new(0.01, 0.0), corner + DVec2::new(0.0, 0.01)];
            [(sliver, 0.05), (crumb, 0.05), (vec![corner; 3], 2.1), (vec![], 0.0)]
        });
        for (outer, most_mm) in shapes.into_iter().flatten() {
            let polygon = Polygon { outer, holes: Vec::new() };
            let near = polygon.bounds().map(|b| b.grown(most_mm));
            for pattern in Pattern::ALL.iter().copied() {
                for density in [0.1, 1.0] {
                    let mut paths = Vec::new();
                    infill(pattern, &Continuous::FOR_TESTS).fill(
                        &context(density, 0.2, 0.1),
                        &polygon,
                        &mut paths,
                    );
                    let is_in =
                        |p: &DVec2| near.is_some_and(|b| p.cmpge(b.min).all() && p.cmple(b.max).all());
                    assert!(paths.iter().flat_map(|p| &p.points).all(is_in), "{}: {paths:?}", pattern.name());
                    let length: f64 = paths.iter().map(Toolpath::length_mm).sum();
                    let most = polygon.perimeter_mm() + 8.0 * most_mm + 0.45;
                    assert!(length <= most, "{} of {density}: {length} mm", pattern.name());
                }
            }
        }
    }

    #[test]
    fn a_bridge_goes_the_short_way_between_its_holds() {
        let bridge = &Region::rectangle(DVec2::ZERO, DVec2::new(10.0, 40.0)).polygons[0];
        let left = Region::rectangle(DVec2::new(-5.0, 0.0), DVec2::new(0.5, 40.0));
        let right = Region::rectangle(DVec2::new(9.5, 0.0), DVec2::new(15.0, 40.0));
        let angle = bridge_angle_rad(bridge, &left.union(&right), 0.4).expect("held on both sides");
        assert!(grainpath_core::math::sin(angle).abs() < 0.05, "{angle}");
        assert_eq!(bridge_angle_rad(bridge, &Region::default(), 0.4), None);
    }
}
