//! Brim and skirt: loops around the first layer that hold it down or start the flow.
//!
//! Method: a brim loop is the outline of the first layer, grown by half a bead spacing for the first loop and
//! by a whole one more for each further loop. Its number of loops is the width over the spacing, rounded. A
//! skirt runs around all islands together: their outlines are grown by the brim, its distance and 5 mm, holes
//! are filled, and 5 mm are taken off again, so that islands near each other get one loop. Both are laid from
//! the outside in; the last loop of a brim touches the part.
//!
//! Distances and widths are in mm. Cost: one polygon offset a loop, and two for the skirt. Degenerate cases:
//! an empty first layer, a brim narrower than half a spacing and a skirt of no loops give no paths. Holes get
//! no loops. An island in the hole of another one is covered by the outline around it.

use grainpath_core::poly::Join;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{Polygon, Region, Role, Toolpath};

/// Settings of brim and skirt, the loops around the first layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesionSettings {
    /// Width of the brim, mm; 0 for none.
    pub brim_width_mm: f64,
    /// Number of skirt loops.
    pub skirt_loops: usize,
    /// Distance of the skirt from the part or its brim, mm.
    pub skirt_distance_mm: f64,
    /// Full width of a bead, mm.
    pub bead_width_mm: f64,
    /// Height of the first layer, mm.
    pub height_mm: f64,
}

impl AdhesionSettings {
    /// How far brim and skirt together reach beyond the part, mm.
    pub fn reach_mm(&self) -> f64 {
        let loops = self.skirt_loops as f64 * bead_spacing_mm(self.bead_width_mm, self.height_mm);
        self.brim_width_mm + if self.skirt_loops > 0 { self.skirt_distance_mm + loops } else { 0.0 }
    }
}

/// Brim loops from the outside in, so that the last one touches the part. Holes get none.
pub fn brim(first_layer: &Region, settings: &AdhesionSettings) -> Vec<Toolpath> {
    let s = bead_spacing_mm(settings.bead_width_mm, settings.height_mm);
    let solid = outlines(first_layer);
    let n = (settings.brim_width_mm / s).round() as usize;
    let ring = |k: usize| {
        loops(&solid.offset((k as f64 + 0.5) * s, Join::Round), settings.bead_width_mm, Role::Brim)
    };
    (0..n).rev().flat_map(ring).collect()
}

/// Skirt loops from the outside in, around all islands of the first layer together.
pub fn skirt(first_layer: &Region, settings: &AdhesionSettings) -> Vec<Toolpath> {
    let s = bead_spacing_mm(settings.bead_width_mm, settings.height_mm);
    // Growing and shrinking by 5 mm closes the gaps between near islands, so that one loop runs
    // around them.
    let around = settings.brim_width_mm + settings.skirt_distance_mm;
    let near = outlines(&outlines(first_layer).offset(around + 5.0, Join::Round)).offset(-5.0, Join::Round);
    let ring = |k: usize| {
        loops(&near.offset((k as f64 + 0.5) * s, Join::Round), settings.bead_width_mm, Role::Skirt)
    };
    (0..settings.skirt_loops).rev().flat_map(ring).collect()
}

/// A region without its holes.
fn outlines(region: &Region) -> Region {
    let filled = |p: &Polygon| Polygon { outer: p.outer.clone(), holes: Vec::new() };
    let flat = Region { polygons: region.polygons.iter().map(filled).collect() };
    // Without holes, an island in the hole of another one lies inside the other's outline, so both are united.
    Region::from_contours(
        &flat.contours().cloned().collect::<Vec<_>>(),
        grainpath_core::poly::FillRule::NonZero,
    )
}

fn loops(region: &Region, width_mm: f64, role: Role) -> Vec<Toolpath> {
    outlines(region).contours().map(|c| Toolpath::new(c.clone(), width_mm, role, true)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec2;

    #[test]
    fn a_brim_joins_the_part_and_a_skirt_keeps_its_distance() {
        let square = Region::rectangle(DVec2::ZERO, DVec2::splat(20.0));
        let settings = AdhesionSettings {
            brim_width_mm: 2.0,
            skirt_loops: 2,
            skirt_distance_mm: 3.0,
            bead_width_mm: 0.45,
            height_mm: 0.2,
        };
        let brim = brim(&square, &settings);
        assert_eq!(brim.len(), 5);
        let last = brim[4].points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        assert!((last + 0.5 * bead_spacing_mm(0.45, 0.2)).abs() < 0.01, "{last}");
        let skirt = skirt(&square, &settings);
        let low = |t: &Toolpath| t.points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        assert!(skirt.len() == 2 && (low(&skirt[1]) + 5.2).abs() < 0.05, "{}", low(&skirt[1]));
        assert!(low(&skirt[0]) >= -settings.reach_mm() && low(&skirt[0]) < low(&skirt[1]));
    }
}
