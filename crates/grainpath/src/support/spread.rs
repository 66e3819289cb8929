//! Moves branches away from the part where they need more room than they have.
//!
//! Trees are grown for least length, so a branch often passes the part at the least distance that is allowed, and is cut
//! thin there. The nozzle then drags its tips far ([`super::bending`]). Here the nodes of such a tree are moved, one at a
//! time, wherever its tips then move less.
//!
//! 1. A tip at height t on a lone trunk needs the radius `c sqrt(t l)` at a distance l below it, with
//!    `c^3 = 2 F / (3 pi E w m)`: F is the side load, E the stiffness, w the wall, m the allowed movement. These radii are
//!    those of least material ([`super::bending`]), and the factor follows from the integral of `l^2 / I`.
//! 2. The price of a branch is what it adds to the movement of its highest tip if it is that thick, or as thick as the part
//!    leaves room for, times the number of its contacts.
//! 3. A joint, a bend or a foot moves sideways in eight directions, alone or with all below it, and downwards as far as
//!    the lean of branches needs it. The move with the lowest price is taken. This goes on until no move gains anything.
//!
//! Branches keep within the branch angle and never come nearer to the part than they were or than grown branches do.
//! Tips, landings, the nodes on these, and the posts of contacts stay where they are. Lengths are mm, forces N. Cost: about 200 trials for each node and round.
//! Limits: which branches join stays as it was grown; a node in a narrow place may have no first step that gains.

use grainpath_core::math::{direction, pow};
use grainpath_core::{DVec2, DVec3};

use super::SupportSettings;
use super::clearance::Clearance;
use super::tree::{Kind, Node, STUMP_MM, slope};

/// Length of the pieces into which a branch is divided for sums, mm.
///
/// Source: the radius of a branch changes by less than a tenth of a millimetre over this length.
pub(super) const PIECE_MM: f64 = 1.0;
/// Lengths of the steps that are tried, mm. Source: chosen. The longest is the radius of the thickest trunk, the shortest
/// about a cell of the clearance.
const STEPS_MM: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// A move gains at least this share of the movement that a tip may make. Source: chosen. Smaller gains are within the error
/// of the distances.
const LEAST_GAIN: f64 = 0.01;
/// Largest number of rounds over the nodes of a tree. Source: derived. A trunk moves by 100 mm at most, further than
/// `max_reach_mm`.
const ROUNDS: usize = 25;

/// Second moment of area of a branch.
pub(super) fn second_moment_mm4(radius_mm: f64, wall_mm: f64) -> f64 {
    // The section is a ring of beads, or a full disc where the radius is less than the wall.
    let hollow = (radius_mm - wall_mm).max(0.0);
    0.25 * std::f64::consts::PI * (radius_mm.powi(4) - hollow.powi(4))
}

/// Moves the nodes of a tree. `tree` holds the indices of its nodes, lower nodes first.
pub(super) fn spread(nodes: &mut [Node], tree: &[u32], clearance: &Clearance, settings: &SupportSettings) {
    let mut spreader = Spreader::new(nodes, tree, clearance, settings);
    for _ in 0..ROUNDS {
        let mut moved = false;
        for &i in tree {
            moved |= spreader.improve(i);
        }
        if !moved {
            break;
        }
    }
    spreader.set_radii(tree);
}

/// How a node is tried to be moved.
#[derive(Clone, Copy)]
struct Move {
    sideways: DVec2,
    down_mm: f64,
}

struct Spreader<'a> {
    nodes: &'a mut [Node],
    /// For each node, the nodes that stand on it.
    above: Vec<Vec<u32>>,
    /// Whether a node has to stay.
    is_fixed: Vec<bool>,
    clearance: &'a Clearance,
    s: &'a SupportSettings,
    slope: f64,
    /// The factor c of the radius that a lone trunk needs.
    factor: f64,
}

impl<'a> Spreader<'a> {
    fn new(nodes: &'a mut [Node], tree: &[u32], clearance: &'a Clearance, s: &'a SupportSettings) -> Self {
        let mut above = vec![Vec::new(); nodes.len()];
        let mut is_fixed = vec![true; nodes.len()];
        let mut pinned = Vec::new();
        for &i in tree {
            let node = &nodes[i as usize];
            is_fixed[i as usize] &= !matches!(node.kind, Kind::Join | Kind::Bend | Kind::Foot);
            let Some(below) = node.below else { continue };
            above[below as usize].push(i);
            // A post below a contact is upright and thin, and a landing lies on the part: neither may move.
            let is_thin = node.post && matches!(node.kind, Kind::Contact(_));
            if is_thin || nodes[below as usize].kind == Kind::Landing {
                pinned.extend([i, below]);
            }
        }
        pinned.into_iter().for_each(|i| is_fixed[i as usize] = true);
        let cube = 2.0 * s.side_load_n
            / (3.0 * std::f64::consts::PI * s.stiffness_mpa * s.wall_mm() * s.tip_moves_at_most_mm());
        Self { nodes, above, is_fixed, clearance, s, slope: slope(s), factor: pow(cube, 1.0 / 3.0) }
    }

    /// The price of the branch below `upper`, at the given ends.
    fn price(&self, upper: &Node, from: DVec3, to: DVec3) -> f64 {
        let length_mm = from.distance(to);
        let n = (length_mm / PIECE_MM).ceil().max(1.0);
        let mut sum = 0.0;
        for i in 0..n as usize {
            // The middle of the piece: the sum is the midpoint rule.
            let at = from.lerp(to, (i as f64 + 0.5) / n);
            let lever_mm = (upper.top_mm - at.z).max(0.0);
            let needed_mm = (self.factor * (upper.top_mm * lever_mm).sqrt())
                .clamp(self.s.branch_radius_mm, self.s.most_mm());
            let radius_mm = needed_mm.min(self.s.thickest_mm(self.clearance, at));
            sum += length_mm / n * lever_mm * lever_mm / second_moment_mm4(radius_mm, self.s.wall_mm());
        }
        f64::from(upper.carries) * self.s.side_load_n / self.s.stiffness_mpa * sum
    }

    /// Whether a branch may be moved to the given ends: it must not lean too far, nor come too near to the part.
    fn is_allowed(&self, was: (DVec3, DVec3), from: DVec3, to: DVec3) -> bool {
        let drop_mm = from.z - to.z;
        let across_mm = (from - to).truncate().length();
        if drop_mm < 1e-6 || across_mm > drop_mm * self.slope + 1e-9 {
            return false;
        }
        // A branch that was grown nearer to the part than usual may stay as near.
        let usual_mm = self.s.branch_radius_mm + self.s.xy_gap_mm;
        if self.clearance.is_clear(from, to, usual_mm) {
            return true;
        }
        let least_mm = self.clearance.least_mm(was.0, was.1);
        least_mm < usual_mm && self.clearance.is_clear(from, to, least_mm)
    }

    /// The place of a node after a move of node `i`, of which `chain` are the nodes that move.
    fn place(&self, node: u32, chain: &[u32], m: Move) -> DVec3 {
        let node_at = self.nodes[node as usize].at;
        if !chain.contains(&node) {
            return node_at;
        }
        // A foot stands on the plate, so it only moves sideways.
        let down_mm = if self.nodes[node as usize].kind == Kind::Foot { 0.0 } else { m.down_mm };
        node_at + m.sideways.extend(-down_mm)
    }

    /// Tries all moves of a node and makes the best one. Returns whether there is one.
    fn improve(&mut self, i: u32) -> bool {
        if self.is_fixed[i as usize] {
            return false;
        }
        // The node alone, or with everything below it down to the foot, so that a trunk can move as a whole.
        let mut chains = vec![vec![i]];
        let mut whole = vec![i];
        while let Some(below) = self.nodes[whole[whole.len() - 1] as usize].below {
            whole.push(below);
        }
        if whole.len() > 1 && !whole.iter().any(|&j| self.is_fixed[j as usize]) {
            chains.push(whole);
        }
        let mut best: Option<(f64, bool, Move)> = None;
        for chain in &chains {
            let whole = chain.len() > 1;
            // The branches that change, each by its upper node.
            let mut changed: Vec<u32> = chain.iter().flat_map(|&j| self.above[j as usize].clone()).collect();
            changed.extend(chain.iter().copied().filter(|&j| self.nodes[j as usize].below.is_some()));
            changed.sort_unstable();
            changed.dedup();
            let ends = |upper: u32, m: Move| {
                let below = self.nodes[upper as usize].below.unwrap_or(upper);
                (self.place(upper, chain, m), self.place(below, chain, m))
            };
            let stay = Move { sideways: DVec2::ZERO, down_mm: 0.0 };
            let price = |m: Move| -> f64 {
                changed
                    .iter()
                    .map(|&j| {
                        let (from, to) = ends(j, m);
                        self.price(&self.nodes[j as usize], from, to)
                    })
                    .sum()
            };
            let now = price(stay);
            for step_mm in STEPS_MM {
                for k in 0..8 {
                    let sideways = direction(f64::from(k) * std::f64::consts::FRAC_PI_4) * step_mm;
                    for downs in [0.0, 1.0, 2.0] {
                        let is_foot = self.nodes[i as usize].kind == Kind::Foot;
                        if is_foot && downs > 0.0 {
                            break;
                        }
                        let m = Move { sideways, down_mm: downs * step_mm / self.slope };
                        // Nodes stay above the foot, whose cone would widen them; those below it already stay there.
                        let lowest_mm = self.s.base_height_mm + STUMP_MM.value();
                        let stands = |&j: &u32| {
                            self.nodes[j as usize].kind == Kind::Foot
                                || self.place(j, chain, m).z >= lowest_mm.min(self.nodes[j as usize].at.z)
                        };
                        let allowed = |&j: &u32| {
                            let (from, to) = ends(j, m);
                            self.is_allowed(ends(j, stay), from, to)
                        };
                        if !chain.iter().all(stands) || !changed.iter().all(allowed) {
                            continue;
                        }
                        let gain = now - price(m);
                        if best.is_none_or(|b| gain > b.0) {
                            best = Some((gain, whole, m));
                        }
                    }
                }
            }
        }
        let least = LEAST_GAIN * self.s.tip_moves_at_most_mm();
        let Some((_, whole, m)) = best.filter(|b| b.0 > least) else { return false };
        let chain = chains.swap_remove(usize::from(whole));
        let places: Vec<DVec3> = chain.iter().map(|&j| self.place(j, &chain, m)).collect();
        for (&j, at) in chain.iter().zip(places) {
            self.nodes[j as usize].at = at;
        }
        true
    }

    /// Sets the radii of the moved nodes and of the branches that end in them.
    fn set_radii(&mut self, tree: &[u32]) {
        for &i in tree {
            let node = self.nodes[i as usize];
            if !self.is_fixed[i as usize] && node.kind != Kind::Foot {
                self.nodes[i as usize].radius_mm = self.s.radius_mm(node.carries, node.top_mm - node.at.z);
            }
            if let Some(below) = node.below.filter(|&b| !self.is_fixed[b as usize]) {
                let below = self.nodes[below as usize].at;
                self.nodes[i as usize].end_mm = self.s.radius_mm(node.carries, node.top_mm - below.z);
            }
        }
    }
}
