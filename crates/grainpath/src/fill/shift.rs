//! Ends of beads that differ from layer to layer.
//!
//! Where equal layers lie on each other, so do the ends of their beads, and a column of ends is a joint through the part.
//! So layers take [`TURNS`] arrangements in turn, of the same quality. They differ by these means:
//!
//! - the grid on which the phase of a fill along a field is found has another size, and its lines need more room, so that
//!   they end elsewhere;
//! - strips of a continuous path are cut at other places, and joints between them, whose place is free, keep to squares
//!   that belong to their turn;
//! - closed paths begin elsewhere;
//! - where the job asks for it, beads along the border lie in a band that is wider in each turn, so that lines which
//!   meet the border across end farther from it.
//!
//! Lengths are in mm. The arrangement depends on the number of the layer alone. Cost: equal layers are planned once for
//! each arrangement instead of once. Limits: lines that meet the border across end on it, less than a column apart; without
//! the band no arrangement keeps a column of them free. Ends that the field forces into one place stay there.
//! `measure::stacked` counts what stands on each other.

use grainpath_core::DVec2;
use grainpath_core::hash::splitmix64;
use grainpath_core::tuned::Tuned;

/// Number of arrangements. Source: derived; with three of them a place is met in every third layer and never twice in a
/// row. Measured: with six, 37 instead of 40 % of the ends inside of a tensile bar stand on each other, at twice the time.
pub(crate) const TURNS: usize = 3;
/// Cuts and starts lie this much farther along their line in each turn, mm. Source: derived; the diagonal of a column of
/// 1 mm is 1.41 mm, so they lie in different columns whatever the direction of the line.
pub(crate) const STEP_MM: f64 = 1.5;
/// The squares of the grid grow by this share in each turn.
/// Measured: row `fill.shift.GRID_SHARE` of `cargo xtask bench constants`.
static GRID_SHARE: Tuned<f64> = Tuned::new("fill.shift.GRID_SHARE", 0.02);
/// The least room of a line grows by this share in each turn, so that lines which end for lack of room end elsewhere.
/// Source: derived. In a field that fans out by one bead in ten, ends move by about two beads along their line in each turn.
const ROOM_SHARE: f64 = 0.15;
/// Side of the squares that belong to a turn, mm. Source: derived; columns of 1 mm then lie in one square each, up to those
/// along its sides.
const SQUARE_MM: f64 = 4.0;
/// Distance that joints keep from the sides of their square, mm. Source: derived; half a column, so that no column holds
/// joints of two squares.
const MARGIN_MM: f64 = 0.5;
/// Least width of the band that a turn adds along the border, mm.
/// Measured: row `fill.shift.BAND_MM` of `cargo xtask bench constants`.
static BAND_MM: Tuned<f64> = Tuned::new("fill.shift.BAND_MM", 1.0);

/// The ends that differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Those inside of the infill, joints and starts.
    Inner,
    /// Also those on borders that beads meet across.
    All,
}

/// Which arrangement of ends a layer takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shift {
    /// `None` where all layers are laid alike.
    ends: Option<Ends>,
    turn: usize,
}

impl Shift {
    /// All layers alike.
    pub const NONE: Self = Self { ends: None, turn: 0 };

    /// The arrangement of a layer, counted from 0.
    pub fn of_layer(ends: Option<Ends>, layer_idx: usize) -> Self {
        if ends.is_some() { Self { ends, turn: layer_idx % TURNS } } else { Self::NONE }
    }

    /// How far cuts and starts move on along their line, mm.
    pub(crate) fn onward_mm(self) -> f64 {
        self.turn as f64 * STEP_MM
    }

    /// Factor on the squares of the grid of a phase.
    pub(crate) fn grid_factor(self) -> f64 {
        1.0 + self.turn as f64 * GRID_SHARE.value()
    }

    /// Factor on the least room of lines whose beads may be narrowed.
    pub(crate) fn room_factor(self) -> f64 {
        1.0 + self.turn as f64 * ROOM_SHARE
    }

    /// Whether a joint whose place is free may lie here.
    pub(crate) fn may_join(self, p: DVec2) -> bool {
        if self.ends.is_none() {
            return true;
        }
        let square = (p / SQUARE_MM).floor();
        let within = p - SQUARE_MM * square;
        let kept = within.min_element() >= MARGIN_MM && within.max_element() <= SQUARE_MM - MARGIN_MM;
        let name = u64::from(square.x as i32 as u32) << 32 | u64::from(square.y as i32 as u32);
        // A hash: in any regular pattern of three some straight lines meet two turns only.
        kept && splitmix64(name) as usize % TURNS == self.turn
    }

    /// The same arrangement without a band along the border, for a region whose band is laid already.
    #[must_use]
    pub(crate) fn without_border(self) -> Self {
        Self { ends: self.ends.map(|_| Ends::Inner), ..self }
    }

    /// Number of beads along the border that come before the lines, for beads `spacing_mm` apart that come in groups of
    /// `group`.
    pub(crate) fn border_beads(self, spacing_mm: f64, group: usize) -> usize {
        match self.ends {
            None | Some(Ends::Inner) => 0,
            Some(Ends::All) => {
                self.turn * group * (BAND_MM.value() / (group as f64 * spacing_mm)).ceil().max(1.0) as usize
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_column_holds_joints_of_two_turns() {
        let turns = [0, 1, 2].map(|k| Shift::of_layer(Some(Ends::Inner), k));
        let at = |i: i32, j: i32| 0.13 * DVec2::new(f64::from(i), f64::from(j));
        let mut counts = [0; TURNS];
        for (i, j) in (-200..200).flat_map(|i| (-200..200).map(move |j| (i, j))) {
            let here: Vec<usize> = (0..TURNS).filter(|&k| turns[k].may_join(at(i, j))).collect();
            here.iter().for_each(|&k| counts[k] += 1);
            // Places up to 0.91 mm away, seven steps, belong to no other turn.
            let near = (0..8).map(|d| at(i + d, j)).chain((0..8).map(|d| at(i, j + d)));
            for (&k, p) in here.iter().flat_map(|k| near.clone().map(move |p| (k, p))) {
                let other = (0..TURNS).find(|&o| o != k && turns[o].may_join(p));
                assert_eq!(other, None, "turn {k} at {}, another at {p}", at(i, j));
            }
        }
        // Each turn has about its share of the squares, which are 9/16 of the plane without their margins.
        let share = counts.map(|c| f64::from(c) / 160_000.0 / (9.0 / 16.0));
        assert!(share.iter().all(|s| (s - 1.0 / 3.0).abs() < 0.08), "{share:?}");
        assert!(Shift::NONE.may_join(DVec2::ZERO) && Shift::of_layer(None, 7) == Shift::NONE);
    }

    #[test]
    fn layers_three_apart_are_alike() {
        for ends in [Ends::Inner, Ends::All] {
            let all: Vec<Shift> = (0..9).map(|i| Shift::of_layer(Some(ends), i)).collect();
            assert!((0..6).all(|i| all[i] == all[i + 3] && all[i] != all[i + 1] && all[i] != all[i + 2]));
        }
        // Whole strips of two beads, at least a millimetre wide.
        let all = Shift::of_layer(Some(Ends::All), 1);
        assert_eq!(
            [all.border_beads(0.41, 1), all.border_beads(0.41, 2), all.border_beads(0.76, 2)],
            [3, 4, 2]
        );
        assert_eq!(all.without_border().border_beads(0.41, 1), 0);
    }
}
