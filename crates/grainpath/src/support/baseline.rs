//! The two baselines that tree supports are compared with: straight walls under all overhangs, and one box
//! around all.
//!
//! Method: every sample and every contact of an overhang asks for a square of support in all layers below it,
//! half a sample distance and the radius of a contact in each direction. From the top down the wanted area
//! only grows: a layer has the area of the layer above and the squares that begin there. For the box, one box
//! around all squares starts at the highest of them. The part with the gap around it is then cut out, and
//! places that a disc of 0.2 mm radius does not fit into are dropped.
//!
//! Lengths are in mm. Cost: one union for each layer in which squares begin, then an offset, a difference and
//! an opening a layer, in parallel. Degenerate cases: without overhangs all layers are empty. Pieces that
//! stand on nothing are counted, not removed.

use grainpath_core::poly::{FillRule, Join};
use grainpath_core::{Bounds2, Contour, DVec2, LayerStack, Region};
use rayon::prelude::*;

use super::cut::{Heights, Layers, SupportLayer, count_floating};
use super::overhang::Overhangs;
use super::{Style, SupportSettings};

/// Corners of the area below overhangs are cut by at most this, mm. Source: derived. It is a ninth of a bead of 0.45
/// mm.
const CUT_MM: f64 = 0.05;
/// Necks thinner than twice this are cut off, mm. Source: derived. A bead of 0.45 mm does not fit into 0.4 mm.
const THIN_MM: f64 = 0.2;

/// Layers of the baseline: the area below all overhangs, or the box around them, less the part and the gap around it.
pub fn layers(overhangs: &Overhangs, stack: &LayerStack, settings: &SupportSettings) -> Layers {
    let heights = Heights::new(stack);
    let half = 0.5 * settings.sample_mm() + settings.contact_radius_mm;
    let square = |p: DVec2, half: f64| Bounds2 { min: p - half, max: p + half };
    // The square that each sample and each contact needs supported, and the number of layers below it.
    let spots = overhangs.samples.iter().map(|s| s.at).chain(overhangs.contacts.iter().map(|c| c.at));
    let mut wanted: Vec<(usize, Bounds2)> =
        spots.map(|p| (heights.end_below(p.z, settings.z_gap_mm), square(p.truncate(), half))).collect();
    if settings.style == Style::Box {
        let all = wanted.iter().map(|w| w.1).reduce(Bounds2::union);
        let top = wanted.iter().map(|w| w.0).max();
        wanted = top.zip(all).into_iter().collect();
    }
    wanted.sort_by_key(|w| std::cmp::Reverse(w.0));
    let contour = |b: &Bounds2| -> Contour {
        vec![b.min, DVec2::new(b.max.x, b.min.y), b.max, DVec2::new(b.min.x, b.max.y)]
    };
    // From the top down the wanted area only grows. Each layer adds to the area of the layer above.
    let mut area = Region::default();
    let mut next = 0;
    let mut areas = vec![Region::default(); stack.layers().len()];
    for k in (0..stack.layers().len()).rev() {
        let first = next;
        while next < wanted.len() && wanted[next].0 > k {
            next += 1;
        }
        if next > first {
            let new: Vec<Contour> = wanted[first..next].iter().map(|w| contour(&w.1)).collect();
            area = area.union(&Region::from_contours(&new, FillRule::NonZero)).simplified(CUT_MM);
        }
        areas[k] = area.clone();
    }
    let cut = |k: usize| {
        let part = stack.layers()[k].region();
        let mut region = areas[k].difference(&part.offset(settings.xy_gap_mm, Join::Round));
        region = region.opened(THIN_MM);
        SupportLayer { region, ..SupportLayer::default() }
    };
    let mut out = Layers { layers: (0..areas.len()).into_par_iter().map(cut).collect(), ..Layers::default() };
    out.floating = count_floating(&out.layers, stack, settings);
    out
}
