//! Beads of the support: walls around every branch, dense feet and pads, sparse fill inside thick branches.
//!
//! Method: each piece of a layer is an island. Its walls are offsets inwards, the first by half a bead and
//! each further one by the bead spacing. The interface below the part, and the first layers above the plate,
//! are filled densely with concentric loops. Other pieces get parallel lines where a density is asked for. A
//! piece too narrow for a loop gets one short straight bead along its longer side. Its width is four times
//! area over perimeter, which is the diameter of a disc, within the widths allowed.
//!
//! Widths and lengths are in mm. Cost: one polygon offset for each wall and piece, and the fill inside.
//! Degenerate cases: a loop of 0.3 mm or less is left out. Less than one wall counts as one. A layer without
//! support has no islands.

use grainpath_core::poly::Join;
use grainpath_core::tuned::Tuned;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{DVec2, Density, Polygon, Region, Role, SpeedClass, Toolpath};

use super::cut::SupportLayer;
use super::overhang::inner_point;
use crate::fill::{Concentric, FillContext, Infill, Rectilinear};
use crate::order::Island;
use crate::wall::Wall;

/// The shortest loop that is laid, mm. Source: derived. It is two thirds of a bead of 0.45 mm; anything shorter is a
/// dot and does not stick.
pub(super) const SHORT_MM: f64 = 0.3;
/// A bead in a piece without room for a loop reaches at least this far to both sides of the middle, mm. Measured: row
/// `support.beads.DAB_MM` of `cargo xtask bench constants`.
static DAB_MM: Tuned<f64> = Tuned::new("support.beads.DAB_MM", 0.08);

/// How support is laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeadSettings {
    /// Full width of a bead, mm.
    pub bead_width_mm: f64,
    /// The narrowest bead laid, mm.
    pub min_bead_width_mm: f64,
    /// Walls around every branch.
    pub walls: usize,
    /// Density inside the walls.
    pub density: Density,
    /// Number of layers above the bed that are dense.
    pub dense_layers: usize,
}

/// The beads of one layer, with one island for each piece of support.
pub fn lay(layer: &SupportLayer, context: &FillContext, dense: bool, settings: &BeadSettings) -> Vec<Island> {
    let mut rest = layer.region.clone();
    let mut islands = Vec::new();
    if !layer.interface.is_empty() && !dense {
        rest = rest.difference(&layer.interface);
        let pads = layer.interface.polygons.iter();
        islands.extend(pads.map(|p| island(p, context, true, Role::SupportInterface, settings)));
    }
    islands.extend(rest.polygons.iter().map(|p| island(p, context, dense, Role::Support, settings)));
    islands.retain(|i| !i.walls.is_empty() || !i.fills.is_empty());
    islands
}

fn island(p: &Polygon, context: &FillContext, dense: bool, role: Role, settings: &BeadSettings) -> Island {
    let w = settings.bead_width_mm;
    let s = bead_spacing_mm(w, context.height_mm);
    let region = Region::from(p.clone());
    let mut island = Island::default();
    for depth in 0..settings.walls.max(1) {
        let centre = region.offset(-(0.5 * w + depth as f64 * s), Join::Round);
        for contour in centre.contours() {
            let path = Toolpath::new(contour.clone(), w, role, true);
            if path.length_mm() > SHORT_MM {
                island.walls.push(Wall { path, depth });
            }
        }
    }
    if island.walls.is_empty() {
        island.fills.extend(dab(p, role, settings));
        return island;
    }
    let density = if dense { Density::Dense } else { settings.density };
    if density.fraction() > 0.0 {
        let infill_region = inside(p, context, settings);
        let context = FillContext { density, role, bead_width_mm: w, ..*context };
        let pattern: &dyn Infill = if dense { &Concentric } else { &Rectilinear };
        infill_region.polygons.iter().for_each(|r| pattern.fill(&context, r, &mut island.fills));
    }
    island
}

/// The area for centrelines inside the walls of a piece.
fn inside(p: &Polygon, context: &FillContext, settings: &BeadSettings) -> Region {
    let w = settings.bead_width_mm;
    let inset = 0.5 * w + settings.walls.max(1) as f64 * bead_spacing_mm(w, context.height_mm);
    Region::from(p.clone()).offset(-inset, Join::Round)
}

/// The sparse fill inside the walls of a layer.
pub fn sparse(layer: &SupportLayer, context: &FillContext, settings: &BeadSettings) -> Vec<Island> {
    let context =
        FillContext { density: settings.density, bead_width_mm: settings.bead_width_mm, ..*context };
    let of_piece = |p: &Polygon| {
        let mut island = Island::default();
        let infill_region = inside(p, &context, settings);
        infill_region.polygons.iter().for_each(|r| Rectilinear.fill(&context, r, &mut island.fills));
        island
    };
    let rest = layer.region.difference(&layer.interface);
    rest.polygons.iter().map(of_piece).filter(|i| !i.fills.is_empty()).collect()
}

/// A short bead for a piece in which no loop fits. It runs along the longer side and is as wide as the piece: with round
/// ends it has the area of the piece, so the width of a disc is its diameter and that of a strip its short side.
fn dab(p: &Polygon, role: Role, settings: &BeadSettings) -> Option<Toolpath> {
    let middle = inner_point(p);
    let far = p.outer.iter().copied().max_by(|a, b| a.distance(middle).total_cmp(&b.distance(middle)))?;
    let along = (far - middle).normalize_or(DVec2::X);
    let reach = |d: DVec2| p.outer.iter().map(|q| (*q - middle).dot(d)).fold(0.0, f64::max);
    // A bead of width w and length e with round ends has the area w e - (1 - pi / 4) w^2. Of the two widths with the
    // area of the piece the smaller one is meant; a piece rounder than a disc has none, and the clamp below decides.
    let extent = reach(along) + reach(-along);
    let missing = 1.0 - 0.25 * std::f64::consts::PI;
    let rest = (extent * extent - 4.0 * missing * p.area_mm2()).max(0.0).sqrt();
    let width = (0.5 * (extent - rest) / missing).clamp(settings.min_bead_width_mm, settings.bead_width_mm);
    let (ahead, behind) = (reach(along) - 0.5 * width, reach(-along) - 0.5 * width);
    let points =
        vec![middle - along * behind.max(DAB_MM.value()), middle + along * ahead.max(DAB_MM.value())];
    let mut path = Toolpath::new(points, width, role, false);
    path.speed = SpeedClass::SmallWall;
    Some(path)
}
