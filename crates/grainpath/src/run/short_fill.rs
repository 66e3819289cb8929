//! Warns of infill regions that get much less material than their density asks for.
//!
//! Lines do not fit everywhere: a place narrower than the distance of sparse lines, or than a few beads where lines of one
//! width follow a field, may stay empty while the rest of the part is filled. Mass and strength then differ from what the
//! density promises. Patterns that follow a guide are looked at; the others vary with every small part.
//!
//! Method: the volume of the beads of each infill region is set beside the area to be filled, times height and density, and
//! both are added up over the part, dense and sparse fill apart. Layers that the run copies count once. Fibre, bridges and
//! graded density are left out; they have measures of their own. Volumes are in mm3. Cost: one polygon offset a region.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use grainpath_core::{Bounds2, DVec2, Diagnostics, LayerStack, Polygon, Toolpath, Warning, WarningId};

use crate::fill::FillContext;

/// Warned of where less than this share of the material was laid. Source: chosen. Sparse patterns come within a tenth of their
/// density on parts wider than a few distances of their lines, and a quarter less infill is felt in the part.
const LEAST_LAID: f64 = 0.75;
/// And where what is missing is at least this share of the part's volume. Source: chosen; less than the 5 % by which flow
/// and filament scatter, so that a part with one narrow rib of infill among large skins does not warn.
const LEAST_MISSING: f64 = 0.01;

/// The material of the infill regions of a layer.
#[derive(Debug, Clone, Copy, Default)]
struct Share {
    asked_mm3: f64,
    laid_mm3: f64,
    /// The most that a single region lacks, and the middle of that region.
    worst: Option<(f64, DVec2)>,
}

/// The material of all infill regions, by layer and by whether they are dense.
#[derive(Debug, Default)]
pub(super) struct ShortFill(Mutex<BTreeMap<(usize, bool), Share>>);

impl ShortFill {
    /// Counts the beads that were laid in some regions of a layer. Calls for one layer come in the order of its regions, so
    /// that sums do not depend on the number of threads.
    pub(super) fn add(
        &self,
        layer_idx: usize,
        context: &FillContext<'_>,
        regions: &[&Polygon],
        laid: &[Toolpath],
    ) {
        let asked_mm3: f64 = regions.iter().map(|region| context.wanted_mm3(region)).sum();
        let laid_mm3: f64 = laid.iter().map(|path| path.volume_mm3(context.height_mm)).sum();
        let bounds = regions.iter().filter_map(|region| region.bounds()).reduce(Bounds2::union);
        // Dense and sparse fill of a layer are added up apart: a skin would hide that the infill below it is missing.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let share = all.entry((layer_idx, context.density.is_dense())).or_default();
        share.asked_mm3 += asked_mm3;
        share.laid_mm3 += laid_mm3;
        let missing_mm3 = asked_mm3 - laid_mm3;
        if let Some(bounds) = bounds.filter(|_| share.worst.is_none_or(|worst| missing_mm3 > worst.0)) {
            share.worst = Some((missing_mm3, bounds.centre()));
        }
    }

    /// Forgets what was counted, after fills that are only tried.
    pub(super) fn clear(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Warns of dense and of sparse fill that lacks much of its material.
    pub(super) fn report(&self, stack: &LayerStack, diagnostics: &Diagnostics) {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for dense in [false, true] {
            let layers = || all.iter().filter(|((_, is_dense), _)| *is_dense == dense);
            let asked_mm3: f64 = layers().map(|(_, share)| share.asked_mm3).sum();
            let laid_mm3: f64 = layers().map(|(_, share)| share.laid_mm3).sum();
            let least_mm3 = LEAST_MISSING * stack.volume_mm3();
            if laid_mm3 >= LEAST_LAID * asked_mm3 || asked_mm3 - laid_mm3 < least_mm3 {
                continue;
            }
            // The first of equal places counts, so that the warning is the same on every run.
            let found = layers().filter_map(|(key, share)| share.worst.map(|(mm3, at)| (mm3, key.0, at)));
            let Some((_, k, at)) = found.reduce(|a, b| if b.0 > a.0 { b } else { a }) else { continue };
            let kind = if dense { "dense" } else { "sparse" };
            let text = format!(
                "{kind} infill got {:.0} % of the material that its density asks for, as lines do not fit into all of its \
                 regions; the region around ({:.1}, {:.1}) mm lacks most",
                100.0 * laid_mm3 / asked_mm3,
                at.x,
                at.y
            );
            let z_mm = stack.layers()[k].z_top_mm();
            diagnostics.push(Warning::new(WarningId::FillMissing, text).in_layer(k, z_mm));
        }
    }
}
