//! How far the tips of trees move under the drag of the nozzle while they are printed.
//!
//! The nozzle drags the bead that it lays, and a branch with it. From a contact down to its foot a tree is a
//! cantilever: a load F at the tip bends every millimetre of it, by Euler's beam, and the tip moves by
//! `integral of F l^2 / (E I) ds`, where l is the height of the tip over the piece, `I = pi/4 (r^4 - (r - t)^4)` of a
//! ring of radius r and wall t, and E is `stiffness_mpa`.
//!
//! The load: melt under the flat of the nozzle is sheared. Its stress stays below that at which extrusion becomes
//! unstable, 0.1 to 0.2 MPa (`denn2001`), and the flat of a 0.4 mm nozzle is about 1 mm wide, so F is 0.1 N. We know of no
//! measurement of this force; `side_load_n` takes one.
//!
//! Lengths are mm, forces N. Cost: a sum over the branches below every contact. Limits: braces and the branches that
//! join are taken not to help, and a branch that is thinned beside the part bends more than is counted here.

use grainpath_core::DVec3;

use super::SupportSettings;
use super::tree::{Forest, Kind};

/// What moves most.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bending {
    /// The largest movement of a tip, mm.
    pub worst_mm: f64,
    /// The tip that moves so.
    pub at: DVec3,
    /// Number of tips that move by more than they may.
    pub over: usize,
}

/// Length of the pieces that are summed, mm.
///
/// Source: the radius of a branch changes by less than a tenth of a millimetre over this length.
const PIECE_MM: f64 = 1.0;

/// The movement of every tip under the side load.
pub fn tip_bending(forest: &Forest, settings: &SupportSettings) -> Bending {
    let mut out = Bending::default();
    let limit_mm = settings.tip_moves_at_most_mm();
    for tip in forest.nodes.iter().filter(|n| matches!(n.kind, Kind::Contact(_))) {
        let mut moved_mm = 0.0;
        let mut upper = tip;
        while let Some(below) = upper.below {
            let lower = &forest.nodes[below as usize];
            let length = upper.at.distance(lower.at);
            let n = (length / PIECE_MM).ceil().max(1.0);
            for i in 0..n as usize {
                let share = (i as f64 + 0.5) / n;
                let arm = tip.at.z - (upper.at.z + share * (lower.at.z - upper.at.z));
                let radius = upper.radius_mm + share * (lower.radius_mm - upper.radius_mm);
                moved_mm += arm * arm * (length / n) / second_moment_mm4(radius, settings.wall_mm());
            }
            upper = lower;
        }
        moved_mm *= settings.side_load_n / settings.stiffness_mpa;
        out.over += usize::from(moved_mm > limit_mm);
        if moved_mm > out.worst_mm {
            (out.worst_mm, out.at) = (moved_mm, tip.at);
        }
    }
    out
}

fn second_moment_mm4(radius_mm: f64, wall_mm: f64) -> f64 {
    let hollow = (radius_mm - wall_mm).max(0.0);
    0.25 * std::f64::consts::PI * (radius_mm.powi(4) - hollow.powi(4))
}

impl SupportSettings {
    /// Half a bead: less than that the next bead still lies on the tip.
    pub fn tip_moves_at_most_mm(&self) -> f64 {
        0.5 * self.beads.bead_width_mm
    }

    /// Thickness of the walls of a branch.
    fn wall_mm(&self) -> f64 {
        self.beads.walls.max(1) as f64 * self.beads.bead_width_mm
    }
}
