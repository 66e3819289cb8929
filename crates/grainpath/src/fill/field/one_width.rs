//! Dense fill of one bead width along a field.
//!
//! With `fill.widths = "constant"` all beads have one width. They cannot widen where the field diverges or
//! narrow where it converges, so lines have to end. Whether one more bead fits between two others follows
//! from the distance `d` of their centrelines in spacings: without it `d - 1` of a bead stays open, with it
//! `2 - d` of a bead is laid twice. Both are equal at `d` = 1.5; the additional bead then has half of that,
//! [`LEAST_ROOM`], as its own space.
//!
//! ```text
//!    ------------------------------- bead
//!            ======================= new bead: it begins where the two are 1.5 spacings apart
//!    ------------------------------- bead
//! ```
//!
//! The lines are those of the phase ([`phase`](grainpath_core::phase)), which keeps to one spacing, without the drift that beads of any
//! width allow. [`line_ends`](super::line_ends) lets them begin and end by [`ROOM`]. They stay where the phase and the
//! field put them. A gap that then remains gets a single bead as wide as itself, as with beads of any width. Fibre cannot
//! taper; there such a gap gets a bead of the one width if it is at least half a bead wide.
//!
//! Lengths are in mm. Limits: on a field that diverges like that of a radial disk of 50 beads, about 4 % of the area stays
//! open and 4 % is laid twice.

use grainpath_core::phase::Diffusion;

use super::line_ends::Room;

/// The least space of a line, in spacings: half of the distance between its two neighbours. Source:
/// derived, see the head of this file.
const LEAST_ROOM: f64 = 0.75;
/// The narrowest gap that gets a bead, in beads. Source: derived as [`LEAST_ROOM`]: a bead in such a gap
/// overlaps others by as much as it fills.
pub(super) const LEAST_GAP: f64 = 0.5;
/// Where lines of beads of one width begin and end.
pub(super) const ROOM: Room =
    Room { least: LEAST_ROOM, tip: LEAST_ROOM, begins: LEAST_ROOM, middle: false, rests: 0.0 };
/// How the phase of such lines is diffused. Source: measured on ten fields at five sizes of squares, with open ends: with the steps for
/// beads of any width 2.74 in place of 2.67 % stay open and 1.78 in place of 1.75 % are laid twice.
pub(super) const DIFFUSION: Diffusion<3> =
    Diffusion { steps: [(60.0, 6), (25.0, 6), (8.0, 6)], n_coarse: 0, tolerance: 0.01 };
