//! Skins: which part of a layer's fill is seen from above or below, which spans air, and which is inside.
//!
//! Method: our own. A place is inside when all of the next `top_layers` sections above and `bottom_layers`
//! below cover it. This is tested with masks instead of polygons. The accuracy of a cell, half a bead
//! spacing, is enough, because skins reach two cells under their cover anyway, and polygons would cost ten
//! booleans a layer. The fill's polygons are then cut along the border of the mask. The cutting zone is grown
//! where no sparse fill is near, so that outer edges stay as they were. Slivers of sparse fill up to about
//! six cells wide become dense. A bridge is dense fill with no section directly below, with 1 mm around it
//! that lies on the part. A top is dense fill with none directly above.
//!
//! Lengths are in mm, areas in mm2. Layers are divided in chunks of 16, in parallel. Cost: one mask a layer
//! and one `and` for each skin layer, a few instructions for 64 cells, and one cut for each polygon that lies
//! partly in a zone. Memory: a bit a cell, at most about 600 000 cells, for each layer that a chunk needs at
//! once.
//!
//! Degenerate cases: where fewer layers are above or below than skins ask for, all fill is dense. The lowest
//! layer has no bridge, and in the highest all other dense fill is top. Bridges below 1.5 mm2 are printed as
//! other dense fill. Fill is divided into top and rest only if both are larger than 4 mm2. A layer without
//! fill gives an empty split.

use std::collections::VecDeque;
use std::ops::Range;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::{Bounds2, Contour, Diagnostics, Layer, Polygon, Region};
use rayon::prelude::*;

use grainpath_core::mask::{Coverage, Mask, MaskGrid};

/// Settings of skins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinSettings {
    /// Dense layers under a top surface.
    pub top_layers: usize,
    /// Dense layers over a bottom surface.
    pub bottom_layers: usize,
    /// Spacing of the beads, mm. It sets the size of the cells and how far skins reach under their
    /// cover.
    pub spacing_mm: f64,
    /// Whether the inside is dense too. Then only bridges and top surfaces are told apart.
    pub dense: bool,
}

/// A polygon of fill and the island it belongs to.
pub type IslandPolygon = (usize, Polygon);

/// The fill of one layer divided by use. The parts do not overlap.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SkinSplit {
    /// Dense fill that is seen from above.
    pub top: Vec<IslandPolygon>,
    /// Dense fill that is not seen from above.
    pub solid: Vec<IslandPolygon>,
    /// Dense fill over air.
    pub bridge: Vec<IslandPolygon>,
    /// Sparse fill inside the part.
    pub sparse: Vec<IslandPolygon>,
    /// The cells of the section below; `None` on the plate.
    pub below: Option<Mask>,
    /// The same division for each region of the job; empty where no region meets the layer.
    pub regions: Vec<SkinSplit>,
}

/// Number of layers that one thread divides one after the other. Each chunk also makes the masks of layers next to
/// it, which another chunk makes too. Source: chosen; it changes speed alone, never the result.
const CHUNK: usize = 16;
/// Number of cells between an octagon of three cells, pushed into a corner of sparse fill, and the corner's tip. Source:
/// derived. It is 3 (1 / sin(a / 2) - 1) for an angle a: 1.2 in a right angle, 2 at 74 degrees. Sharper corners keep a
/// dense tip.
const CORNER_CELLS: usize = 2;
/// Bridges smaller than this are printed like other dense fill, mm2.
const MIN_BRIDGE_MM2: f64 = 1.5;
/// The fill is divided only if the area seen from above and the area of the rest are both larger than this, mm2.
const MIN_SPLIT_MM2: f64 = 4.0;

/// Divides the fill of a window of layers and hands each layer's skins to `each`, whose results
/// come back in order.
///
/// `sections` are those of the whole part, since the skins of a layer depend on the `top_layers`
/// sections above and the `bottom_layers` below it. `fills` holds the areas for infill in each layer of the window: first
/// the area outside all regions, then that of each region. `settings` has an entry for each of these areas. `each` gets
/// the number of the layer in the window.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub(crate) fn split_window<T: Send>(
    sections: &[Layer],
    window: Range<usize>,
    fills: &[Vec<Vec<IslandPolygon>>],
    bounds: Bounds2,
    settings: &[SkinSettings],
    diagnostics: &Diagnostics,
    each: impl Fn(usize, SkinSplit) -> T + Sync,
) -> Result<Vec<T>, Interrupted> {
    // Cells of half a bead: finer ones would resolve details that no bead can follow.
    let most = |layers: fn(&SkinSettings) -> usize| settings.iter().map(layers).max().unwrap_or(0);
    let (most_top, most_bottom) = (most(|s| s.top_layers), most(|s| s.bottom_layers));
    let grid = MaskGrid::over(bounds, 0.5 * settings.first().map_or(1.0, |s| s.spacing_mm));
    let chunks: Vec<usize> = window.clone().step_by(CHUNK).collect();
    let results: Vec<Result<Vec<T>, Interrupted>> = chunks
        .into_par_iter()
        .map(|first| {
            let end = (first + CHUNK).min(window.end);
            let mut masks = Window { grid, masks: VecDeque::new(), lowest: 0, sections };
            (first..end)
                .map(|i| {
                    diagnostics.check()?;
                    // At least one layer below and above, because bridges and top surfaces need them even
                    // where no skins are asked for.
                    masks.slide(i.saturating_sub(most_bottom.max(1))..i + most_top.max(1) + 1);
                    let k = i - window.start;
                    let divided = |(fill, settings): (&Vec<IslandPolygon>, &SkinSettings)| {
                        split(fill, masks.cover(i, settings), settings)
                    };
                    let mut all = fills[k].iter().zip(settings).map(divided);
                    let whole = all.next().unwrap_or_default();
                    let regions = all.map(|region| SkinSplit { below: None, ..region }).collect();
                    let result = each(k, SkinSplit { regions, ..whole });
                    diagnostics.advance(1);
                    Ok(result)
                })
                .collect()
        })
        .collect();
    let mut all = Vec::with_capacity(window.len());
    for chunk in results {
        all.extend(chunk?);
    }
    Ok(all)
}

/// The sections of some consecutive layers as masks.
struct Window<'a> {
    grid: MaskGrid,
    masks: VecDeque<Mask>,
    lowest: usize,
    sections: &'a [Layer],
}

/// The masks of the sections over and under a layer.
struct Cover {
    grid: MaskGrid,
    /// Cells covered by all of the skin layers above and below. `None` near the top and the plate,
    /// where no cell can be covered, and where the inside is dense too.
    inside: Option<Mask>,
    above: Option<Mask>,
    below: Option<Mask>,
}

impl Window<'_> {
    /// Drops the masks of layers below `layers` and makes those that are missing. Ranges come in rising order.
    fn slide(&mut self, layers: Range<usize>) {
        self.masks.drain(..layers.start.saturating_sub(self.lowest).min(self.masks.len()));
        self.lowest = layers.start;
        for layer in &self.sections[self.lowest + self.masks.len()..layers.end.min(self.sections.len())] {
            self.masks.push_back(Mask::from_region(self.grid, layer.region()));
        }
    }

    fn mask(&self, layer: usize) -> &Mask {
        &self.masks[layer - self.lowest]
    }

    fn cover(&self, i: usize, settings: &SkinSettings) -> Cover {
        let fits = i + settings.top_layers < self.sections.len() && i >= settings.bottom_layers;
        let inside = (!settings.dense && fits).then(|| {
            let over = (i + 1..=i + settings.top_layers).chain(i - settings.bottom_layers..i);
            over.fold(self.mask(i).clone(), |m, k| m.and(self.mask(k)))
        });
        let above = (i + 1 < self.sections.len()).then(|| self.mask(i + 1).clone());
        let below = (i > 0).then(|| self.mask(i - 1).clone());
        Cover { grid: self.grid, inside, above, below }
    }
}

fn split(fill: &[IslandPolygon], mut cover: Cover, settings: &SkinSettings) -> SkinSplit {
    if fill.is_empty() {
        return SkinSplit { below: cover.below, ..SkinSplit::default() };
    }
    let cells = cells_of(cover.grid, fill);
    let (dense, sparse) = match cover.inside.take() {
        Some(inside) if !settings.dense => cut(fill.to_vec(), &skin_zone(&cells, inside)),
        _ => (fill.to_vec(), Vec::new()),
    };
    let (bridge, solid) = bridges(dense, &cells, &cover);
    let (top, solid) = tops(solid, &cells, &cover);
    SkinSplit { top, solid, bridge, sparse, below: cover.below, regions: Vec::new() }
}

/// The cells of skins over sparse fill, and a little beyond. `inside` are the cells covered by all skin layers. Masks are
/// as large as the plate is, so none is kept beyond its last use.
fn skin_zone(cells: &Mask, inside: Mask) -> Mask {
    // Skins reach two cells under their cover. Slivers of sparse fill, little more than walls, become dense.
    let exposed = cells.clone().and_not(&inside).grown(2);
    drop(inside);
    let hidden = cells.clone().and_not(&exposed);
    drop(exposed);
    // Opening with an octagon also removes the corners of sparse fill, which are then added back.
    let sparse = hidden.opened(3).grown(CORNER_CELLS).and(&hidden);
    drop(hidden);
    // The zone is grown by three cells, but never into sparse fill: the polygon's own edge then lies inside the zone and is
    // not cut along the coarse edge of the mask.
    cells.clone().and_not(&sparse).grown(3).and_not(&sparse)
}

fn cells_of(grid: MaskGrid, polygons: &[IslandPolygon]) -> Mask {
    Mask::of_contours(grid, polygons.iter().flat_map(|(_, p)| p.contours()))
}

/// Divides polygons into what lies in the cells and what does not. Only a polygon that is partly in is cut.
fn cut(polygons: Vec<IslandPolygon>, cells: &Mask) -> (Vec<IslandPolygon>, Vec<IslandPolygon>) {
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    let mut zone = None;
    for (island, polygon) in polygons {
        match cells.coverage(&polygon) {
            Coverage::All => inside.push((island, polygon)),
            Coverage::None => outside.push((island, polygon)),
            Coverage::Part => {
                let zone: &Vec<(Bounds2, Polygon)> = zone.get_or_insert_with(|| {
                    let ring = |outer: Contour| {
                        let bounds = Bounds2::around_points(outer.iter().copied())?;
                        Some((bounds, Polygon { outer, holes: Vec::new() }))
                    };
                    cells.contours().into_iter().filter_map(ring).collect()
                });
                // The cut uses only those polygons of the zone that are near, because a layer may have
                // a thousand islands.
                let Some(around) = polygon.bounds() else { continue };
                let near = zone.iter().filter(|(b, _)| b.meets(around)).map(|(_, p)| p.clone());
                let zone = &Region { polygons: near.collect() };
                let whole = Region::from(polygon);
                inside.extend(whole.intersection(zone).polygons.into_iter().map(|p| (island, p)));
                outside.extend(whole.difference(zone).polygons.into_iter().map(|p| (island, p)));
            }
        }
    }
    (inside, outside)
}

/// Divides dense fill into what spans air, with a margin of one millimetre that lies on the part, and the rest.
fn bridges(
    dense: Vec<IslandPolygon>,
    cells: &Mask,
    cover: &Cover,
) -> (Vec<IslandPolygon>, Vec<IslandPolygon>) {
    let Some(below) = &cover.below else { return (Vec::new(), dense) };
    let air = cells.clone().and_not(below);
    // Opening only takes cells away, so it is left out where too few are there before it.
    if air.area_mm2() < MIN_BRIDGE_MM2 || dense.is_empty() {
        return (Vec::new(), dense);
    }
    // Two cells of opening drop the narrow strips over air that slopes leave in every layer.
    let air = air.opened(2);
    if air.area_mm2() < MIN_BRIDGE_MM2 {
        return (Vec::new(), dense);
    }
    let hold = (1.0 / cover.grid.cell_mm()).round() as usize;
    cut(dense, &air.grown(hold))
}

/// Divides solid fill into what is seen from above, and the rest.
fn tops(solid: Vec<IslandPolygon>, cells: &Mask, cover: &Cover) -> (Vec<IslandPolygon>, Vec<IslandPolygon>) {
    let Some(above) = &cover.above else { return (solid, Vec::new()) };
    // What is seen from above is a part of these cells. Most layers have fewer than the least area that is divided.
    if solid.is_empty() || cells.clone().and_not(above).area_mm2() < MIN_SPLIT_MM2 {
        return (Vec::new(), solid);
    }
    let dense = cells_of(cover.grid, &solid).and(cells);
    // One cell of opening drops narrow strips, such as the steps of steep walls.
    let seen = dense.clone().and_not(above).opened(1);
    if seen.area_mm2() < MIN_SPLIT_MM2 {
        return (Vec::new(), solid);
    }
    let hidden = dense.and_not(&seen.grown(2)).opened(2);
    if hidden.area_mm2() < MIN_SPLIT_MM2 {
        return (solid, Vec::new());
    }
    cut(solid, &seen.grown(4).and_not(&hidden))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec2;
    use grainpath_core::poly::Join;

    fn stack(sections: &[Region], dense: bool) -> Vec<SkinSplit> {
        let fills: Vec<Vec<Vec<IslandPolygon>>> = sections
            .iter()
            .map(|s| vec![s.offset(-1.0, Join::Miter(3.0)).polygons.into_iter().enumerate().collect()])
            .collect();
        let layer = |(i, s): (usize, &Region)| Layer::new(0.2 * (i + 1) as f64, 0.2, s.clone());
        let layers: Vec<Layer> =
            sections.iter().enumerate().map(|s| layer(s).expect("a sound layer")).collect();
        let bounds = sections.iter().filter_map(Region::bounds).reduce(Bounds2::union).expect("not empty");
        let settings = SkinSettings { top_layers: 3, bottom_layers: 2, spacing_mm: 0.4, dense };
        split_window(&layers, 0..layers.len(), &fills, bounds, &[settings], &Diagnostics::default(), |_, s| s)
            .expect("not stopped")
    }

    fn area(parts: &[IslandPolygon]) -> f64 {
        parts.iter().map(|(_, p)| p.area_mm2()).sum()
    }

    fn square(side: f64) -> Region {
        Region::rectangle(DVec2::ZERO, DVec2::splat(side))
    }

    #[test]
    fn a_step_gets_a_top_skin_as_deep_as_asked() {
        let sections: Vec<Region> = (0..20).map(|i| square(if i < 10 { 30.0 } else { 15.0 })).collect();
        let split = stack(&sections, false);
        for (i, s) in split.iter().enumerate() {
            let fill = if i < 10 { 28.0f64 * 28.0 } else { 13.0 * 13.0 };
            let sum = area(&s.top) + area(&s.solid) + area(&s.bridge) + area(&s.sparse);
            assert!((sum - fill).abs() < 1e-2, "layer {i}: {sum} of {fill}");
            let closed = !(2..17).contains(&i);
            let step = (7..10).contains(&i);
            assert_eq!(area(&s.sparse) == 0.0, closed, "layer {i}");
            assert_eq!(area(&s.sparse) < 0.5 * fill, closed || step, "layer {i}");
            assert_eq!(area(&s.top) > 100.0, i == 9 || i == 19, "layer {i}: top {}", area(&s.top));
            assert!(s.bridge.is_empty(), "layer {i}");
        }
    }

    #[test]
    fn corners_of_sparse_fill_are_not_dense() {
        for turn_rad in [0.0, 0.3, 0.65] {
            let x = grainpath_core::math::direction(turn_rad);
            let corner = |i: usize| x * [0.0, 30.0, 30.0, 0.0][i] + x.perp() * [0.0, 0.0, 30.0, 30.0][i];
            let outer = (0..4).map(corner).collect();
            let turned = Region::from(Polygon { outer, holes: Vec::new() });
            for s in &stack(&vec![turned; 10], false)[3..6] {
                assert_eq!((s.sparse.len(), s.solid.len(), s.top.len()), (1, 0, 0), "{turn_rad}");
            }
        }
    }

    #[test]
    fn a_lid_over_a_box_is_a_bridge() {
        let hollow = square(40.0).difference(&Region::rectangle(DVec2::splat(5.0), DVec2::splat(35.0)));
        let mut sections = vec![hollow; 6];
        sections.extend(vec![square(40.0); 6]);
        let split = stack(&sections, true);
        let over_air: Vec<bool> = split.iter().map(|s| area(&s.bridge) > 900.0).collect();
        assert_eq!(over_air.iter().filter(|&&b| b).count(), 1);
        assert!(over_air[6] && area(&split[6].bridge) < 1100.0, "{}", area(&split[6].bridge));
    }
}
