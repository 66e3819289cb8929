//! How far the tips of trees move under the drag of the nozzle while they are printed, and how thick branches are made
//! so that they do not move too far.
//!
//! The nozzle drags the bead that it lays, and the branch below it. From a contact down to its foot a tree is a
//! cantilever. By Euler's beam equation a load F at the tip bends every millimetre of it, and the tip moves by
//! `integral of F l^2 / (E I) ds`. Here l is the height of the tip over the piece, `I = pi/4 (r^4 - (r - t)^4)` is
//! that of a ring of radius r and wall t, and E is `stiffness_mpa`.
//!
//! The load: melt under the flat of the nozzle is sheared. Its stress stays below that at which extrusion becomes
//! unstable, 0.1 to 0.2 MPa (`denn2001`), and the flat of a 0.4 mm nozzle is about 1 mm wide, so F is 0.1 N. We know of no
//! measurement of this force; a measured value can be set as `side_load_n`.
//!
//! The thickness: the radii should need the least wall material with which no tip moves too far. A wall t at radius r costs
//! r per millimetre of branch and has `I = pi r^3 t`. With Lagrange's multiplier m of each tip that a piece carries,
//! `d/dr (r + sum of m l^2 / r^3) = 0`, so `r = (3 sum of m l^2)^(1/4)`. The multipliers are found by optimality criteria
//! (`venkayya1971`). Each is multiplied by a power of the ratio of its tip's movement to the allowed one, until no tip moves
//! too far. The multiplier of a tip that is stiff enough goes to zero.
//!
//! Where the part leaves no room for these radii, the nodes of the tree are first moved away from it (`support/spread.rs`).
//!
//! Lengths are mm, forces N. Cost: about 30 sums over all branches of the trees whose tips move too far. Limits: joining
//! branches are assumed not to stiffen a tree. Where a tip moves too far even with the thickest branches that
//! `base_radius_mm` and the part allow, it may move up to twice as far as with those.

use std::collections::BTreeMap;

use grainpath_core::DVec3;
use grainpath_core::math::{pow, tan};
use rayon::prelude::*;

use super::SupportSettings;
use super::clearance::Clearance;
use super::spread::{PIECE_MM, second_moment_mm4, spread};
use super::tree::{Forest, Kind, Node};

/// The largest movement of a tip, and how many tips move too far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bending {
    /// The largest movement of a tip, mm.
    pub worst_mm: f64,
    /// Position of the tip that moves by the most.
    pub at: DVec3,
    /// Number of tips that move by more than is allowed.
    pub over: usize,
}

/// Number of rounds to find the multipliers. Source: derived. A multiplier changes at most by the factor [`MOST_CHANGE`]
/// in a round, so 30 rounds reach any value from a millionth to a million times the first one.
const ROUNDS: usize = 30;
/// Largest factor by which a multiplier grows or shrinks in one round. Source: derived. Radii then change by at most its
/// fourth root, 41 %, so that a tree does not swing between two shapes.
const MOST_CHANGE: f64 = 4.0;
/// A multiplier is multiplied by this power of the ratio of movement to allowed movement. Source: derived. The movement of a
/// single tip is proportional to its multiplier to the power of -3/4.
const POWER: f64 = 4.0 / 3.0;
/// Where no thickness is enough, tips may move this many times as far as with the thickest branches. A trunk is then thinner
/// by a fifth (the cube root of this factor) and needs a fifth less material. Source: chosen.
const SHORTFALL: f64 = 2.0;
/// Factor by which multipliers are raised in a step at the end, until no tip moves too far. Source: derived. Radii grow
/// with the fourth root, by half a percent in a step, so they are at most half a percent larger than needed.
const RAISE: f64 = 1.02;

/// The largest movement of a tip under the side load. A branch has the thickness set in the [`Forest`], or less where the
/// part is too near for it.
pub fn tip_bending(forest: &Forest, clearance: &Clearance, settings: &SupportSettings) -> Bending {
    let beams = Beams::new(forest, clearance, settings);
    let mut out = Bending::default();
    for tree in trees(forest) {
        for (tip, moved_mm) in beams.tips_mm(&forest.nodes, &tree) {
            out.over += usize::from(moved_mm > settings.tip_moves_at_most_mm());
            if moved_mm > out.worst_mm {
                (out.worst_mm, out.at) = (moved_mm, forest.nodes[tip as usize].at);
            }
        }
    }
    out
}

/// Makes the branches of every tree as thick as its tips need, and moves them away from the part where they have no room
/// for that.
pub fn stiffen(forest: &mut Forest, clearance: &Clearance, settings: &SupportSettings) {
    let all = trees(forest);
    let stiff: Vec<Vec<Node>> =
        all.par_iter().map(|tree| stiff_tree(alone(forest, tree), clearance, settings)).collect();
    for (tree, nodes) in all.iter().zip(stiff) {
        for (&i, node) in tree.iter().zip(nodes) {
            let below = forest.nodes[i as usize].below;
            forest.nodes[i as usize] = Node { below, ..node };
        }
    }
}

/// A tree as a forest of its own, lower nodes first.
fn alone(forest: &Forest, tree: &[u32]) -> Forest {
    let names: BTreeMap<u32, u32> = tree.iter().zip(0..).map(|(&i, name)| (i, name)).collect();
    let node = |&i: &u32| {
        let node = forest.nodes[i as usize];
        Node { below: node.below.map(|below| names[&below]), ..node }
    };
    Forest { nodes: tree.iter().map(node).collect(), ..Forest::default() }
}

/// The nodes of a single tree, made as stiff as its tips need.
fn stiff_tree(mut grown: Forest, clearance: &Clearance, settings: &SupportSettings) -> Vec<Node> {
    let limit_mm = settings.tip_moves_at_most_mm();
    let tree: Vec<u32> = (0..grown.nodes.len() as u32).collect();
    // The nodes, the number of tips that still move too far, and the furthest movement.
    let thickened = |forest: &Forest| {
        let beams = Beams::new(forest, clearance, settings);
        let rank = |nodes: &[Node]| {
            let tips = beams.tips_mm(nodes, &tree);
            let over = tips.iter().filter(|tip| tip.1 > limit_mm).count();
            (over, tips.iter().map(|tip| tip.1).fold(0.0, f64::max))
        };
        if rank(&forest.nodes).0 == 0 {
            return (forest.nodes.clone(), (0, 0.0));
        }
        let nodes = beams.stiffened(forest, &tree, limit_mm);
        let rank = rank(&nodes);
        (nodes, rank)
    };
    let (as_grown, before) = thickened(&grown);
    if before.0 == 0 {
        return as_grown;
    }
    spread(&mut grown.nodes, &tree, clearance, settings);
    let (apart, after) = thickened(&grown);
    if after < before { apart } else { as_grown }
}

/// The nodes of every tree, lower nodes first. Cost: linear in the nodes.
///
/// A branch may stand on a node that was made before its own, so the index of a node does not say which of two is lower.
fn trees(forest: &Forest) -> Vec<Vec<u32>> {
    let mut tree_of = vec![usize::MAX; forest.nodes.len()];
    let mut out: Vec<Vec<u32>> = Vec::new();
    let mut way_down = Vec::new();
    for i in (0..forest.nodes.len()).rev() {
        let mut next = Some(i);
        while let Some(node) = next.filter(|&node| tree_of[node] == usize::MAX) {
            way_down.push(node);
            next = forest.nodes[node].below.map(|below| below as usize);
        }
        let tree = next.map_or(out.len(), |node| tree_of[node]);
        if tree == out.len() && !way_down.is_empty() {
            out.push(Vec::new());
        }
        for node in way_down.drain(..).rev() {
            tree_of[node] = tree;
            out[tree].push(node as u32);
        }
    }
    out
}

/// A piece of a branch.
struct BeamPiece {
    z_mm: f64,
    length_mm: f64,
    /// Largest radius that the distance from the part allows, mm.
    thickest_mm: f64,
}

/// All branches in pieces.
struct Beams<'a> {
    settings: &'a SupportSettings,
    /// For each node, the pieces of the branch below it.
    pieces: Vec<Vec<BeamPiece>>,
}

impl<'a> Beams<'a> {
    fn new(forest: &Forest, clearance: &Clearance, settings: &'a SupportSettings) -> Self {
        let of_branch = |upper: &Node| {
            let Some(below) = upper.below else { return Vec::new() };
            let lower = &forest.nodes[below as usize];
            let length = upper.at.distance(lower.at);
            let n = (length / PIECE_MM).ceil().max(1.0);
            let keeps_off = upper.post || !matches!(upper.kind, Kind::Contact(_));
            let piece = |i: usize| {
                let at = upper.at.lerp(lower.at, (i as f64 + 0.5) / n);
                let thickest_mm = if keeps_off { settings.thickest_mm(clearance, at) } else { f64::INFINITY };
                BeamPiece { z_mm: at.z, length_mm: length / n, thickest_mm }
            };
            (0..n as usize).map(piece).collect()
        };
        Self { settings, pieces: forest.nodes.iter().map(of_branch).collect() }
    }

    /// The tips of a tree and how far each moves, mm. `tree` holds the indices of the tree's nodes, lower nodes first.
    fn tips_mm(&self, nodes: &[Node], tree: &[u32]) -> Vec<(u32, f64)> {
        let slope = tan(self.settings.branch_angle_rad);
        let mut sums: BTreeMap<u32, Quadratic> = BTreeMap::new();
        let mut out = Vec::new();
        for &i in tree {
            let node = &nodes[i as usize];
            let Some(below) = node.below else { continue };
            let mut sum = sums.get(&below).copied().unwrap_or_default();
            for piece in &self.pieces[i as usize] {
                let radius = node.radius_at_mm(&nodes[below as usize], piece.z_mm, slope);
                let second = second_moment_mm4(radius.min(piece.thickest_mm), self.settings.wall_mm());
                sum.add(piece.length_mm / second, piece.z_mm);
            }
            sums.insert(i, sum);
            if let Kind::Contact(_) = node.kind {
                let moved = sum.at(node.at.z) * self.settings.side_load_n / self.settings.stiffness_mpa;
                out.push((i, moved));
            }
        }
        out
    }

    /// The nodes of a tree with radii at which its tips move by `limit_mm` at most, in the order of `tree`.
    fn stiffened(&self, forest: &Forest, tree: &[u32], limit_mm: f64) -> Vec<Node> {
        let mut nodes = forest.nodes.clone();
        let mut with = |multipliers: &[(u32, f64)]| {
            self.set_radii(&mut nodes, forest, tree, multipliers);
            let tips = self.tips_mm(&nodes, tree);
            (tips, tree.iter().map(|&i| nodes[i as usize]).collect::<Vec<_>>())
        };
        let tips = self.tips_mm(&forest.nodes, tree);
        let all = |multiplier: f64| -> Vec<(u32, f64)> { tips.iter().map(|t| (t.0, multiplier)).collect() };
        // With this multiplier every branch has its largest radius from a millimetre below its tip.
        let (stiffest, _) = with(&all(self.settings.most_mm().powi(4)));
        let may_move: Vec<f64> =
            stiffest.iter().map(|&(_, mm)| if mm > limit_mm { SHORTFALL * mm } else { limit_mm }).collect();
        // The first multiplier gives a single trunk 30 mm high a radius of 1.5 mm.
        let mut multipliers = all(1.5f64.powi(4) / 30f64.powi(2));
        for _ in 0..ROUNDS {
            let (moved, _) = with(&multipliers);
            for ((multiplier, (_, mm)), most_mm) in multipliers.iter_mut().zip(moved).zip(&may_move) {
                multiplier.1 *= pow(mm / most_mm, POWER).clamp(1.0 / MOST_CHANGE, MOST_CHANGE);
            }
        }
        // The multipliers are now nearly large enough. Small steps raise them until no tip moves too far.
        loop {
            let (moved, nodes) = with(&multipliers);
            let is_over = moved.iter().zip(&may_move).any(|(&(_, mm), &most)| mm > most);
            let is_least = multipliers.iter().all(|m| m.1 > self.settings.most_mm().powi(4));
            if !is_over || is_least {
                return nodes;
            }
            multipliers.iter_mut().for_each(|m| m.1 *= RAISE);
        }
    }

    /// Sets the radii of a tree by the multipliers of its tips; no branch becomes thinner than it was.
    fn set_radii(&self, nodes: &mut [Node], forest: &Forest, tree: &[u32], multipliers: &[(u32, f64)]) {
        let mut sums: BTreeMap<u32, Quadratic> = BTreeMap::new();
        // A tip bends a piece below it in proportion to the lever arm squared. The sum of a node adds up these squares.
        for &(tip, multiplier) in multipliers {
            sums.entry(tip).or_default().add(multiplier, forest.nodes[tip as usize].at.z);
        }
        // Goes from the tips down: a node carries all tips of the branches that end in it.
        for &i in tree.iter().rev() {
            let was = forest.nodes[i as usize];
            let sum = sums.get(&i).copied().unwrap_or_default();
            let thick = |z: f64, least_mm: f64| {
                pow(sum.at(z).max(0.0), 0.25).clamp(least_mm, self.settings.most_mm().max(least_mm))
            };
            let node = &mut nodes[i as usize];
            // A tip stays as fine as its contact: it has to come off the part.
            let is_tip = matches!(was.kind, Kind::Contact(_));
            if !is_tip {
                node.radius_mm = thick(was.at.z, was.radius_mm);
            }
            let Some(below) = was.below else { continue };
            node.end_mm = thick(forest.nodes[below as usize].at.z, was.end_mm);
            // A tip that bends a branch also bends all branches below it.
            sums.entry(below).or_default().join(sum);
        }
    }
}

/// A sum of `a (z - b)^2` over many a and b, as a polynomial in z.
#[derive(Clone, Copy, Default)]
struct Quadratic([f64; 3]);

impl Quadratic {
    fn add(&mut self, a: f64, b: f64) {
        self.join(Self([a, a * b, a * b * b]));
    }

    fn join(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, more)| *sum += more);
    }

    fn at(&self, z: f64) -> f64 {
        let [whole, first, second] = self.0;
        whole * z * z - 2.0 * first * z + second
    }
}

impl SupportSettings {
    /// Largest allowed movement of a tip: half a bead, so that the next bead still lies on the tip.
    pub fn tip_moves_at_most_mm(&self) -> f64 {
        0.5 * self.beads.bead_width_mm
    }

    /// Thickness of the walls of a branch.
    pub(super) fn wall_mm(&self) -> f64 {
        self.beads.walls.max(1) as f64 * self.beads.bead_width_mm
    }
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec3;

    use super::*;

    /// Two contacts on one foot, where each branch stands on a node that was made before its own.
    #[test]
    fn a_tree_is_found_whatever_the_order_of_its_nodes() {
        let node = |z_mm: f64, kind: Kind, below: Option<u32>| Node {
            at: DVec3::new(0.0, 0.0, z_mm),
            radius_mm: 1.0,
            end_mm: 1.0,
            carries: 1,
            top_mm: 20.0,
            below,
            kind,
            post: false,
        };
        let nodes = vec![
            node(5.0, Kind::Bend, Some(4)),
            node(10.0, Kind::Join, Some(0)),
            node(20.0, Kind::Contact(0), Some(1)),
            node(18.0, Kind::Contact(1), Some(1)),
            node(0.0, Kind::Foot, None),
            node(0.0, Kind::Foot, None),
            node(9.0, Kind::Contact(2), Some(5)),
        ];
        let forest = Forest { nodes, ..Forest::default() };
        assert_eq!(trees(&forest), [vec![5, 6], vec![4, 0, 1, 3, 2]]);
    }
}
