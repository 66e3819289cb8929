//! Puts the paths of islands in printing order, chooses the start of closed paths, and plans the
//! travels between paths.
//!
//! The next path depends on the end of the previous one, so layers are ordered one after the other.
//! Travels take more time to plan and depend only on their own layer, so they are planned in parallel
//! for the layers that are already ordered.

mod unordered_bytes;
mod chain;
mod comb;
mod nearest;
mod seam;
mod sequence;
mod starts;

use std::ops::Range;

use grainpath_core::diagnostics::{Interrupted, Stage};
use grainpath_core::poly::edges;
use grainpath_core::segment;
use grainpath_core::{Bounds2, DVec2, Diagnostics, Layer, LayerPlan, LayerStack, Polygon, Role, Toolpath};
use rayon::prelude::*;

use crate::wall::Wall;
pub use comb::CombSettings;
pub use grainpath_job::choices::{Seam, WallOrder};
pub(crate) use nearest::NearestEnds;
pub use unordered_bytes::{PathBytesError, paths_from_bytes, paths_to_bytes};

/// Settings of the printing order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderSettings {
    /// Order of the walls of a contour.
    pub wall_order: WallOrder,
    /// How the start of outer walls is chosen.
    pub seam: Seam,
    /// Settings of travels.
    pub comb: CombSettings,
    /// Least distance of the start of a closed infill path from those in the two layers below, mm; 0 for none.
    pub starts_apart_mm: f64,
    /// Whether fibre comes after everything else of a layer, so that tools are changed once.
    pub fibre_last: bool,
    /// If set, paths of an island are joined into one path if they are at most this far apart, mm.
    pub chain_mm: Option<f64>,
}

/// Paths of one connected piece of a layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Island {
    /// Walls from the outermost inwards.
    pub walls: Vec<Wall>,
    /// Single beads and fill: printed after the walls, in any order and direction.
    pub fills: Vec<Toolpath>,
}

/// Paths of a layer, not yet in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LayerPaths {
    /// Skirt and brim: printed first, in this order.
    pub adhesion: Vec<Toolpath>,
    /// Supports: printed before the part, so that its overhangs have something to lie on.
    pub supports: Vec<Island>,
    /// Islands of the part: one for each polygon of the layer's section.
    pub islands: Vec<Island>,
}

/// The paths of an island in printing order, and the index of its polygon in the section; `None`
/// for adhesion and supports.
struct Ordered {
    island: Option<usize>,
    paths: Vec<Toolpath>,
}

/// State that is passed on from layer to layer: the positions of the nozzle and of the seams in the
/// layer below.
pub struct OrderState {
    nozzle: DVec2,
    seams: seam::Seams,
    starts: starts::Starts,
}

impl OrderState {
    /// The state before the first layer, with the nozzle at the part's origin.
    pub fn new(settings: &OrderSettings) -> Self {
        let starts = starts::Starts::new(settings.starts_apart_mm);
        Self { nozzle: DVec2::ZERO, seams: seam::Seams::new(settings.seam), starts }
    }
}

/// Orders all layers; `layers` has one entry for each layer of the stack.
///
/// ```
/// use grainpath::order::order_stack;
/// use grainpath::run::{config, fill_window};
/// use grainpath_core::Role;
/// # let stack = grainpath_parts::layers_of_a_box(12);
/// # let (settings, diagnostics) = (grainpath::Settings::default(), grainpath_core::Diagnostics::default());
/// let filled = fill_window(&config::steps(&settings), &stack, 0..12, &diagnostics).unwrap();
/// let plans = order_stack(&stack, filled, &config::order(&settings), &diagnostics).unwrap();
/// assert_eq!(plans.len(), 12);
/// // The default order of walls is inner first.
/// let walls: Vec<Role> = plans[5].paths.iter().map(|p| p.path.role).filter(|r| r.is_wall()).collect();
/// assert_eq!(walls, [Role::InnerWall, Role::OuterWall]);
/// ```
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub fn order_stack(
    stack: &LayerStack,
    layers: Vec<LayerPaths>,
    settings: &OrderSettings,
    diagnostics: &Diagnostics,
) -> Result<Vec<LayerPlan>, Interrupted> {
    diagnostics.begin(Stage::Order, layers.len());
    let window = 0..layers.len();
    order_window(stack.layers(), window, layers, settings, &mut OrderState::new(settings), diagnostics)
}

/// Orders a window of layers. `sections` are those of the whole part; `layers` has one entry for
/// each layer of the window. The order of a layer depends on the layer below through `state`, so
/// windows must be given from the plate upwards without a gap.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub fn order_window(
    sections: &[Layer],
    window: Range<usize>,
    layers: Vec<LayerPaths>,
    settings: &OrderSettings,
    state: &mut OrderState,
    diagnostics: &Diagnostics,
) -> Result<Vec<LayerPlan>, Interrupted> {
    let OrderState { nozzle, seams, starts } = state;
    let ordered = layers.into_iter().zip(window).map(|(paths, layer_idx)| {
        let layer = &sections[layer_idx];
        let start = *nozzle;
        seams.next_layer(layer_idx);
        starts.next_layer();
        let islands = order_layer(paths, &layer.region().polygons, settings, (seams, starts), nozzle);
        (layer_idx, layer, start, islands)
    });
    let plan = |(layer_idx, layer, start, islands): (usize, &Layer, DVec2, Vec<Ordered>)| {
        diagnostics.check()?;
        let mut from = start;
        let mut paths = Vec::with_capacity(islands.iter().map(|i| i.paths.len()).sum());
        for ordered in islands {
            let outline = ordered.island.map(|i| &layer.region().polygons[i]);
            comb::plan_travels(outline, ordered.paths, &settings.comb, &mut from, &mut paths);
        }
        diagnostics.advance(1);
        Ok((layer_idx, LayerPlan { z_top_mm: layer.z_top_mm(), height_mm: layer.height_mm(), paths }))
    };
    // Ordering passes the nozzle's position and the seams from layer to layer. Travels start from
    // the recorded position, so they can be planned in any order. `par_bridge` orders one layer at a
    // time, while other threads plan travels.
    let mut plans: Vec<(usize, LayerPlan)> =
        ordered.par_bridge().map(plan).collect::<Result<_, Interrupted>>()?;
    // Threads finish in any order, so the plans are sorted by layer.
    plans.sort_unstable_by_key(|p| p.0);
    Ok(plans.into_iter().map(|p| p.1).collect())
}

fn order_layer(
    layer: LayerPaths,
    outlines: &[Polygon],
    settings: &OrderSettings,
    (seams, starts): (&mut seam::Seams, &mut starts::Starts),
    at: &mut DVec2,
) -> Vec<Ordered> {
    let mut out = Vec::with_capacity(layer.islands.len() + 1);
    if !layer.adhesion.is_empty() {
        let mut paths = layer.adhesion;
        for path in &mut paths {
            starts::start_nearest(path, *at);
            *at = path.end();
        }
        out.push(Ordered { island: None, paths });
    }
    let first =
        |i: &Island| i.walls.first().map(|w| &w.path).or(i.fills.first()).map_or(DVec2::ZERO, |p| p.start());
    // A support island is represented by the start of its first path, which stands for both ends
    // of the island.
    let places: Vec<[DVec2; 2]> = layer.supports.iter().map(|i| [first(i); 2]).collect();
    let mut supports: Vec<Option<Island>> = layer.supports.into_iter().map(Some).collect();
    for (i, _) in sequence::tour(&places, *at, None) {
        let Some(island) = supports[i].take() else { continue };
        let mut paths = Vec::with_capacity(island.walls.len() + island.fills.len());
        // The starts of support beads are not visible, so they are chosen for short travels,
        // whatever the seam setting.
        sequence::walls(
            island.walls,
            settings.wall_order,
            &mut seam::Seams::new(Seam::Nearest),
            at,
            &mut paths,
        );
        sequence::fills(island.fills, &mut starts::Starts::default(), at, None, &mut paths);
        out.push(Ordered { island: None, paths });
    }
    let mut islands: Vec<Option<Island>> = layer.islands.into_iter().map(Some).collect();
    let middle = |p: &Polygon| p.bounds().map_or(DVec2::ZERO, Bounds2::centre);
    // An island is represented by the centre of its bounding box, because its first path is known
    // only once its paths are in order.
    let places: Vec<[DVec2; 2]> = outlines.iter().take(islands.len()).map(|p| [middle(p); 2]).collect();
    let mut fibre: Vec<Vec<Toolpath>> = vec![Vec::new(); islands.len()];
    // Walls that rise above the layer are printed last, so that the nozzle does not hit them.
    let mut raised: Vec<Vec<Wall>> = vec![Vec::new(); islands.len()];
    for (island, raised) in islands.iter_mut().flatten().zip(&mut raised) {
        *raised = island.walls.extract_if(.., |w| w.path.raise.top_mm > 0.0).collect();
    }
    // A chain begins in the island in which the chain of the layer below ended.
    let here = settings.chain_mm.and_then(|_| nearest_outline(&outlines[..places.len()], *at));
    let tour = sequence::tour(&places, here.map_or(*at, |i| places[i][0]), None);
    for (stop, &(i, _)) in tour.iter().enumerate() {
        let Some(mut island) = islands[i].take() else { continue };
        let next = tour.get(stop + 1).map(|&(i, _)| places[i][0]);
        let mut paths = Vec::with_capacity(island.walls.len() + island.fills.len());
        if settings.fibre_last {
            let (last, first) = island.fills.into_iter().partition(|p| p.role == Role::Fibre);
            (fibre[i], island.fills) = (last, first);
        }
        match settings.chain_mm {
            Some(reach_mm) => {
                let walls = island.walls.into_iter().map(|w| w.path);
                // A chain cuts loops to join them to others. Fibre and matrix are chained separately, so
                // that no fibre is cut for a matrix bead.
                let all = walls.chain(island.fills);
                let (last, first): (Vec<_>, Vec<_>) = all.partition(|p| p.role == Role::Fibre);
                chain::chained(first, reach_mm, at, &mut paths);
                chain::chained(last, reach_mm, at, &mut paths);
            }
            None => {
                sequence::walls(island.walls, settings.wall_order, seams, at, &mut paths);
                sequence::fills(island.fills, starts, at, next, &mut paths);
            }
        }
        out.push(Ordered { island: Some(i), paths });
    }
    for (i, _) in sequence::tour(&places, *at, None) {
        let mut paths = Vec::new();
        match settings.chain_mm {
            _ if fibre[i].is_empty() => continue,
            Some(reach_mm) => chain::chained(std::mem::take(&mut fibre[i]), reach_mm, at, &mut paths),
            None => sequence::fills(std::mem::take(&mut fibre[i]), starts, at, None, &mut paths),
        }
        out.push(Ordered { island: Some(i), paths });
    }
    if raised.iter().any(|walls| !walls.is_empty()) {
        for (i, _) in sequence::tour(&places, *at, None) {
            let mut paths = Vec::new();
            sequence::walls(std::mem::take(&mut raised[i]), settings.wall_order, seams, at, &mut paths);
            if !paths.is_empty() {
                out.push(Ordered { island: Some(i), paths });
            }
        }
    }
    out
}

/// The outline that contains a point, or else the nearest one.
fn nearest_outline(outlines: &[Polygon], at: DVec2) -> Option<usize> {
    let off = |p: &Polygon| {
        let to = |(a, b): (DVec2, DVec2)| segment::distance_squared_mm2(at, a, b);
        let edges = p.contours().flat_map(|c| edges(c));
        if p.contains(at) { 0.0 } else { edges.map(to).fold(f64::INFINITY, f64::min) }
    };
    let all = outlines.iter().map(off).enumerate();
    all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}
