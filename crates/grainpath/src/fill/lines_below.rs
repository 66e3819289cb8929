//! What lines along a field stand on: those of the layer below.
//!
//! Where directions or densities change with the height, lines that are laid in each layer on its own lie anywhere between
//! those below. So the first lines of a layer start from places on the lines below, and end where they leave its beads.
//! Lengths are in mm. Cost: linear in the beads of a layer.

use grainpath_core::segments::Segments;
use grainpath_core::{DVec2, Toolpath, polyline};

/// A place is held if the middle of a bead below is at most this many bead widths away in plan. Source: as for beads of
/// supports (`REACH` of `support/held.rs`); a seventh of the bead lies on the one below.
pub(crate) const HELD: f64 = 0.86;

/// A side of the cells in which beads are looked up, in bead widths. Source: chosen; a place then looks into one to four cells.
const CELL: f64 = 4.0;

/// Lines of a layer below, from which those along a field go on.
#[derive(Debug)]
pub struct LinesBelow {
    /// In the order in which they are tried.
    places: Vec<DVec2>,
    /// All beads of their layer, where no other layer lies between.
    beads: Option<Segments>,
}

impl LinesBelow {
    /// The sparse lines of a layer along a field, among all paths of it.
    pub(crate) fn new<'a>(
        lines: impl Iterator<Item = &'a Toolpath> + Clone,
        all: impl Iterator<Item = &'a Toolpath>,
        bead_width_mm: f64,
    ) -> Self {
        // The middle of each line, then points a quarter of it from its ends, for lines that a hole or another line cuts in
        // two there.
        let at = |share: f64| {
            lines.clone().filter_map(move |line| {
                let mut rest = line.points.clone();
                polyline::shorten_start(&mut rest, share * polyline::length_mm(&line.points, false));
                rest.first().copied()
            })
        };
        let places = at(0.5).chain(at(0.25)).chain(at(0.75)).collect();
        Self { places, beads: Some(Segments::of_paths(all, CELL * bead_width_mm)) }
    }

    /// Places on the lines, from which others go on.
    pub(crate) fn places(&self) -> &[DVec2] {
        &self.places
    }

    /// Another layer was laid on theirs, whose beads hold what comes next.
    pub(crate) fn cover(&mut self) {
        self.beads = None;
    }

    /// Whether a bead of this width lies on one of their layer. Beads of a layer between hold it anywhere: lines of the two
    /// layers cross.
    pub(crate) fn holds(&self, place: DVec2, bead_width_mm: f64) -> bool {
        self.beads.as_ref().is_none_or(|beads| beads.within(place, HELD * bead_width_mm).next().is_some())
    }
}
