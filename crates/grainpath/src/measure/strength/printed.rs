//! Reconstructs the part from the beads of a program, for tests without a model of the part.
//!
//! Besides the beads, the test needs the part's bounding box for places and messages, its sections to distinguish plates
//! from solids, and its volume for the size of the cells. All three follow from the beads. The section of a layer is the
//! union of the strips that its beads cover; voids of sparse fill are closed. A void is a hole of the part if the ring of
//! outer walls around it encloses nothing else: the hole in the union of the outer walls is then as large as the void.
//! Part coordinates are those of the program, with z from the bottom of the part's first printed layer.
//!
//! Cost: one union of strips for each layer, in parallel; 0.1 s for a hundred layers of a thousand beads. Limits: in
//! programs without roles the voids of sparse fill stay open, which only makes the stated volume smaller. A priming line
//! in the first layer becomes part of that layer's section, but not of the bounding box.

use grainpath_core::poly::{Contour, FillRule, Join};
use grainpath_core::{Bounds2, DVec2, Layer, LayerStack, Polygon, Region, Role, TriMesh};
use grainpath_fea::load_case::BoundaryConditions;
use grainpath_fea::strength::laminate::MAX_BEAD_WIDTH_MM;
use grainpath_gcode::{Bead, BeadLayer, Program};
use grainpath_job::loads::{Place, Push};
use rayon::prelude::*;

use super::StrengthError;
use super::setup::layers_of_part;
use crate::guide::{TypedLoads, boundary_conditions};
use crate::shape::Standing;

/// Gaps between strips are closed up to twice this width, mm. Source: a tenth of the narrowest common bead; neighbouring
/// strips touch, apart from the rounding of the program.
const SEAM_MM: f64 = 0.04;
/// A void is a hole of the part if its area is more than this share of the hole in the outer walls. Source: gap fill and
/// brims inside holes cover less than a tenth; a void of sparse fill is a small part of the area inside its walls.
const HOLE_SHARE: f64 = 0.9;
/// Largest share of their area by which layers of a plate may differ. Source: at seams and in corners the strips end up to
/// half a width from the true section; the planner's own sections differ by 0.002 at most.
const SAME_SHARE: f64 = 0.03;

/// A part reconstructed from its program.
#[derive(Debug, Clone, PartialEq)]
pub struct PrintedPart {
    /// Its layers, from z = 0.
    pub stack: LayerStack,
    /// Bounding box of the part as a mesh.
    pub mesh: TriMesh,
    /// Height of the part's bottom above the plate, mm: the height of a raft or of supports, otherwise 0.
    pub bottom_mm: f64,
}

fn strip(bead: &Bead, height_mm: f64) -> Option<Vec<DVec2>> {
    let (a, b) = (bead.start(), bead.end());
    let along = (b - a).normalize_or_zero();
    let r = 0.5 * bead.width_mm(height_mm).min(MAX_BEAD_WIDTH_MM);
    // A strip extends beyond each end of the bead by a quarter of its width, which stands for the round ends of beads.
    let (over, side) = (0.5 * r * along, r * along.perp());
    let corners = vec![a - over - side, b + over - side, b + over + side, a - over + side];
    (along != DVec2::ZERO && r > 0.0).then_some(corners)
}

fn union_of<'a>(beads: impl Iterator<Item = &'a Bead>, height_mm: f64) -> Region {
    let strips: Vec<Vec<DVec2>> = beads.filter_map(|b| strip(b, height_mm)).collect();
    Region::from_contours(&strips, FillRule::NonZero)
        .offset(SEAM_MM, Join::Miter(2.0))
        .offset(-SEAM_MM, Join::Miter(2.0))
}

/// The section of a layer.
fn section(layer: &BeadLayer, height_mm: f64) -> Region {
    let of_part = || layer.beads.iter().filter(|b| b.role.is_part());
    let all = union_of(of_part(), height_mm);
    let walls = union_of(of_part().filter(|b| b.role == Role::OuterWall), height_mm);
    let area = |contour: &[DVec2]| grainpath_core::poly::signed_area_mm2(contour).abs();
    let holes: Vec<(f64, Polygon)> = (walls.polygons.iter())
        .flat_map(|p| &p.holes)
        .map(|h| (area(h), Polygon { outer: h.clone(), holes: Vec::new() }))
        .collect();
    let is_hole = |void: &Contour| {
        // A void without fill shares its border with the hole in the walls, so a point inside the void is tested.
        let inside = point_inside(void);
        let around = holes.iter().filter(|(_, h)| h.contains(inside));
        // The void belongs to the smallest ring of walls around it.
        let own = around.map(|(area, _)| *area).fold(f64::INFINITY, f64::min);
        area(void) > HOLE_SHARE * own
    };
    // Every void with its area and whether it stays open.
    let voids: Vec<(f64, bool, Polygon)> = (all.polygons.iter())
        .flat_map(|p| &p.holes)
        .map(|h| (area(h), is_hole(h), Polygon { outer: h.clone(), holes: Vec::new() }))
        .collect();
    let open = voids.iter().filter(|v| v.1).map(|v| v.2.outer.clone());
    // An island in a closed void adds nothing to the section, and its outline would count twice around its
    // holes.
    let stands_alone = |outer: &Contour| {
        let inside = point_inside(outer);
        let around = voids.iter().filter(|v| v.2.contains(inside));
        around.min_by(|v, w| v.0.total_cmp(&w.0)).is_none_or(|v| v.1)
    };
    let outers = all.polygons.iter().map(|p| p.outer.clone()).filter(stands_alone);
    let contours: Vec<Contour> = outers.chain(open).collect();
    Region::from_contours(&contours, FillRule::NonZero)
}

/// A point inside a contour, close to the middle of its longest side.
fn point_inside(contour: &[DVec2]) -> DVec2 {
    // Source: a quarter of SEAM_MM; gaps narrower than twice SEAM_MM were closed.
    const BESIDE_MM: f64 = 0.01;
    let sides = grainpath_core::poly::edges(contour);
    let longest = sides.max_by(|(a, b), (c, d)| a.distance_squared(*b).total_cmp(&c.distance_squared(*d)));
    let Some((a, b)) = longest else { return DVec2::ZERO };
    // The area lies to the left of a counter-clockwise contour.
    let left = grainpath_core::poly::signed_area_mm2(contour).signum();
    0.5 * (a + b) + (b - a).normalize_or_zero().perp() * left * BESIDE_MM
}

impl PrintedPart {
    /// Reconstructs the part from a program.
    ///
    /// # Errors
    /// [`StrengthError::NothingPrinted`] for a program without beads of a part.
    pub fn new(program: &Program) -> Result<Self, StrengthError> {
        let (layers, heights, bottom_mm) = layers_of_part(program);
        let below_mm = layers.last().map_or(bottom_mm, |l| l.z_mm);
        let mut sections: Vec<Region> =
            layers.par_iter().zip(&heights).map(|(l, h)| section(l, *h)).collect();
        // Seams and fill change equal sections slightly. All layers of a plate get the section of its middle layer.
        if let Some(middle) = sections.get(sections.len() / 2).cloned() {
            let off = |r: &Region| r.difference(&middle).area_mm2() + middle.difference(r).area_mm2();
            // The first layer is not compared, because it may contain priming lines.
            let most = SAME_SHARE * middle.area_mm2();
            if sections.len() > 2 && sections[1..].par_iter().all(|r| off(r) <= most) {
                sections.iter_mut().for_each(|r| r.clone_from(&middle));
            }
        }
        let skipped = usize::from(layers.len() > 2);
        let bounds = sections[skipped.min(sections.len())..].iter().filter_map(Region::bounds);
        let bounds = bounds.reduce(Bounds2::union).ok_or(StrengthError::NothingPrinted)?;
        let tops = layers.iter().map(|l| l.z_mm - bottom_mm);
        let stack = tops.zip(&heights).zip(sections).map(|((top, h), region)| Layer::new(top, *h, region));
        let stack = stack.collect::<Option<Vec<Layer>>>().and_then(LayerStack::new);
        let stack = stack.ok_or(StrengthError::NothingPrinted)?;
        let high = bounds.max.extend(below_mm - bottom_mm);
        Ok(Self { stack, mesh: TriMesh::cuboid(bounds.min.extend(0.0), high), bottom_mm })
    }

    /// The fixtures and loads of a job on this part.
    ///
    /// # Errors
    /// [`StrengthError::NeedsSurface`] for faces, lists of facets and pressures, which need the surface of the part.
    pub fn conditions(&self, typed: &TypedLoads<'_>) -> Result<BoundaryConditions, StrengthError> {
        let is_facets =
            |place: &Place| matches!(place, Place::Facets(_) | Place::Face(_) | Place::FaceSide { .. });
        let loads = typed.loads.iter().chain(typed.cases.iter().flat_map(|c| &c.loads));
        for (k, fixture) in typed.fixtures.iter().enumerate() {
            if is_facets(&fixture.on) {
                return Err(StrengthError::NeedsSurface(format!("fixture {}", k + 1)));
            }
        }
        for (k, load) in loads.enumerate() {
            let presses = matches!(load.push, Push::Pressure(_));
            if presses || load.on.as_ref().is_some_and(is_facets) {
                return Err(StrengthError::NeedsSurface(format!("load {}", k + 1)));
            }
        }
        // The part has no file, so it is neither scaled nor turned.
        let standing = Standing::new(1.0, [0.0; 3], 0.0);
        Ok(boundary_conditions(typed, &self.mesh, &standing)?)
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use grainpath_core::DVec3;
    use grainpath_gcode::{Limits, simulate};

    use super::*;

    /// A plate of 40 x 20 mm with a hole of 8 x 8 mm, two layers of walls and sparse lines, after a priming line.
    fn plate(n: usize) -> Program {
        let mut text = String::from("M83\nG1 Z0.2 F600\n;TYPE:External perimeter\nG1 X-20 Y-20\nG1 X60 E3\n");
        // 0.45 mm wide and 0.2 mm high: 0.0814 mm2, of filament of 2.405 mm2.
        let e = |length: f64| length * 0.081_416 / 2.405_28;
        let ring = |text: &mut String, r: f64, c: [f64; 2], size: [f64; 2]| {
            let (w, h) = (size[0] - 2.0 * r, size[1] - 2.0 * r);
            let (x, y) = (c[0] - 0.5 * w, c[1] - 0.5 * h);
            let _ = writeln!(text, "G1 X{x} Y{y}");
            for (dx, dy, l) in [(w, 0.0, w), (w, h, h), (0.0, h, w), (0.0, 0.0, h)] {
                let _ = writeln!(text, "G1 X{} Y{} E{:.5}", x + dx, y + dy, e(l));
            }
        };
        for k in 0..n {
            let _ = writeln!(text, ";LAYER_CHANGE\nG1 Z{:.2}", 0.2 * (k + 1) as f64);
            text.push_str(";TYPE:External perimeter\n");
            ring(&mut text, 0.225, [20.0, 10.0], [40.0, 20.0]);
            ring(&mut text, -0.225, [20.0, 10.0], [8.0, 8.0]);
            text.push_str(";TYPE:Internal infill\n");
            for line in [4.0, 8.0, 12.0, 28.0, 32.0, 36.0] {
                let _ = writeln!(text, "G1 X{line} Y0.5\nG1 Y19.5 E{:.5}", e(19.0));
            }
        }
        simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code")
    }

    #[test]
    fn voids_of_fill_are_part_and_holes_are_not() {
        let part = PrintedPart::new(&plate(4)).expect("a part");
        let layers = part.stack.layers();
        assert_eq!(layers.len(), 4);
        let section = layers[2].region();
        let holes: usize = section.polygons.iter().map(|p| p.holes.len()).sum();
        assert_eq!((section.polygons.len(), holes), (1, 1));
        // 40 x 20 less 8 x 8 mm.
        assert!((section.area_mm2() - 736.0).abs() < 3.0, "{}", section.area_mm2());
        let (low, high) = part.mesh.bounds().expect("a box");
        assert!((low - DVec3::ZERO).abs().max_element() < 0.02, "{low}");
        assert!((high - DVec3::new(40.0, 20.0, 0.8)).abs().max_element() < 0.02, "{high}");
        // The priming line is no part of the plate.
        assert_eq!(layers[0].region(), section);
    }

    #[test]
    fn nothing_printed_is_no_part() {
        let program = simulate(b"G28\nG1 X10 Y10\n", 1.75, &Limits::default()).expect("G-code");
        assert_eq!(PrintedPart::new(&program), Err(StrengthError::NothingPrinted));
    }
}
