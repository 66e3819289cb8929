//! Grows support trees downwards from the contacts, after `Shen2016`.
//!
//! A branch may lean by the branch angle at most, so everything it can reach lies in a cone below its upper end. Two
//! branches meet at the highest point that lies in both cones ([`cones_meet`]), which is where their length is least.
//! The steps:
//!
//! 1. Every contact gets a short tip that leaves the part along the surface normal.
//! 2. The highest node is taken. Among its neighbours it joins the one that saves most branch length.
//! 3. A node without such a neighbour goes straight down, or round the part where the part is in the way. It ends on
//!    the plate, or on the part where the plate cannot be reached.
//!
//! Nodes are taken in order of height, so all that a node carries is known when its turn comes, and no choice is ever
//! undone. Lengths are in mm, angles in radians. Cost: about n log n for n contacts. Contacts with neither a way to the
//! plate nor a place on the part below them are reported and left without support.
//!
#![doc = include_str!("figures/tree.svg")]

use std::collections::BinaryHeap;

use grainpath_core::buckets::PointGrid2;
use grainpath_core::math::{direction, pow, sin, tan};
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec2, DVec3};

use super::SupportSettings;
use super::clearance::{Clearance, LEAN_SHARE};
use super::contact::Contact;

/// The kind of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The end at the part, with the index of the contact.
    Contact(u32),
    /// The lower end of the short piece that leaves the part along its normal.
    Tip,
    /// The point where two branches meet.
    Join,
    /// A corner of a branch that goes round the part.
    Bend,
    /// The lower end of a trunk, on the plate.
    Foot,
    /// The lower end of a trunk, on the part.
    Landing,
}

/// A point of a tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position, mm.
    pub at: DVec3,
    /// Radius of the horizontal section there, mm.
    pub radius_mm: f64,
    /// Radius, mm, at the lower end of the branch below this node, before the branch widens to the node it stands on.
    pub end_mm: f64,
    /// Number of contacts it carries.
    pub carries: u32,
    /// Height of the highest contact it carries, mm.
    pub top_mm: f64,
    /// The node that it stands on; none for feet and landings.
    pub below: Option<u32>,
    /// Its kind.
    pub kind: Kind,
    /// Whether the branch from here down is a post, the last resort: it may touch the part and is cut to fit.
    pub post: bool,
}

impl Node {
    /// Radius at height `z_mm` of the branch from here down to `lower`. At its lower end the branch widens to the radius of
    /// `lower`, with flanks that lean no more than a branch may (`slope`), so that each ring rests on the ring below.
    pub fn radius_at_mm(&self, lower: &Self, z_mm: f64, slope: f64) -> f64 {
        let above_mm = z_mm - lower.at.z;
        let share = (above_mm / (self.at.z - lower.at.z).max(1e-9)).clamp(0.0, 1.0);
        let own_mm = self.end_mm + share * (self.radius_mm - self.end_mm);
        own_mm.max(lower.radius_mm - above_mm * slope)
    }
}

/// All trees of a part.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Forest {
    /// Every node. A node names the node below it, whose index may be higher or lower.
    pub nodes: Vec<Node>,
    /// Contacts that no branch could reach.
    pub unreached: Vec<u32>,
}

impl Forest {
    /// Number of trees: feet and landings.
    pub fn n_trees(&self) -> usize {
        self.nodes.iter().filter(|n| n.below.is_none() && n.carries > 0).count()
    }

    /// The upper and the lower node of every piece of a branch.
    pub fn branches(&self) -> impl Iterator<Item = (&Node, &Node)> {
        self.nodes.iter().filter_map(|n| n.below.map(|b| (n, &self.nodes[b as usize])))
    }

    /// The largest lean of any branch from the vertical, radians.
    pub fn steepest_rad(&self) -> f64 {
        let lean = |a: DVec3, b: DVec3| {
            grainpath_core::math::atan2((a - b).truncate().length(), (a.z - b.z).max(0.0))
        };
        self.branches().filter(|(a, b)| a.at != b.at).map(|(a, b)| lean(a.at, b.at)).fold(0.0, f64::max)
    }
}

/// The highest point common to two downward cones with apexes `p` and `q` and slope `tan_angle`. Two branches that meet
/// there have the least length. If one apex lies in the other's cone, the result is that apex.
pub fn cones_meet(p: DVec3, q: DVec3, tan_angle: f64) -> DVec3 {
    let (high, low) = if p.z >= q.z { (p, q) } else { (q, p) };
    let across = (low - high).truncate();
    let d = across.length();
    let drop = high.z - low.z;
    if d <= drop * tan_angle {
        return low;
    }
    let z = 0.5 * (high.z + low.z) - 0.5 * d / tan_angle;
    let from_high = (high.z - z) * tan_angle;
    (high.truncate() + across * (from_high / d)).extend(z)
}

/// How far branches go sideways for each millimetre down: a little less than the branch angle allows.
pub(super) fn slope(settings: &SupportSettings) -> f64 {
    tan(settings.branch_angle_rad) * LEAN_SHARE
}

/// Grows trees from the contacts to the plate.
pub fn grow(contacts: &[Contact], clearance: &Clearance, settings: &SupportSettings) -> Forest {
    let bounds = Bounds2::around_points(contacts.iter().map(|c| c.at.truncate()));
    let Some(bounds) = bounds else { return Forest::default() };
    let mut grower = Grower {
        s: settings,
        clearance,
        slope: slope(settings),
        forest: Forest::default(),
        queue: BinaryHeap::new(),
        index: grid_from_above(bounds, contacts.len()),
        state: Vec::new(),
    };
    for (i, contact) in contacts.iter().enumerate() {
        grower.begin(i as u32, contact);
    }
    grower.run();
    grower.stand();
    grower.give_ends();
    grower.forest
}

/// How far a node has been processed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// The node waits for its turn; `plate` tells whether the plate can be reached from it.
    Waiting { plate: bool },
    /// The node is on a trunk that goes straight down to the plate. Other branches may still join it.
    Trunk,
    /// The node below it is known.
    Done,
}

/// A grid in plan that finds nodes near a point. Its cells are 2 to 20 mm wide, so that each holds about one node.
fn grid_from_above(bounds: Bounds2, n: usize) -> PointGrid2<u32> {
    let bounds = bounds.grown(10.0);
    let size = bounds.size();
    let [least, most] = CELL_MM;
    let cell_mm =
        (size.x * size.y / n.max(1) as f64).sqrt().clamp(least, most).max(size.max_element() / 1000.0);
    PointGrid2::new(bounds, cell_mm)
}

#[derive(PartialEq)]
struct Turn {
    z: f64,
    name: u32,
}

impl Eq for Turn {}

impl Ord for Turn {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.z.total_cmp(&other.z).then(other.name.cmp(&self.name))
    }
}

impl PartialOrd for Turn {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// A joint that is possible, and the length of branch that it saves.
struct Meeting {
    gain_mm: f64,
    with: u32,
    at: DVec3,
}

/// Largest number of joints tried before a node goes on alone, which bounds the time for crowded parts. Source: chosen. For
/// both specimens of `grainpath specimen` a single try gives the same trees.
const TRIES: usize = 24;
/// Length of branch that counts as much as one foot when joints are compared, mm. Measured: row `support.tree.FOOT_MM` of
/// `cargo xtask bench constants`.
static FOOT_MM: Tuned<f64> = Tuned::new("support.tree.FOOT_MM", 8.0);
/// The shortest piece of trunk left below a joint, mm. A node that is moved stays as far above the cone of a foot.
/// Measured: row `support.tree.STUMP_MM` of `cargo xtask bench constants`.
pub(super) static STUMP_MM: Tuned<f64> = Tuned::new("support.tree.STUMP_MM", 1.0);
/// Factor on the lengths that are tried for a tip: 1, 0.6, 1.5, 2, 2.8 and 4 times the usual length. Measured: row
/// `support.tree.TIP_LENGTHS` of `cargo xtask bench constants`.
static TIP_LENGTHS: Tuned<f64> = Tuned::new("support.tree.TIP_LENGTHS", 1.0);
/// The floor of a post is searched from this far below its contact, mm. Source: derived. Two slabs of the
/// [`Clearance`]: the slab of the contact and the one below it may hold the underside that the post is to carry.
const POST_BELOW_MM: f64 = 0.8;
/// The finest and the coarsest cell of the grid of nodes, mm. Source: chosen for speed. The best joint of a node is
/// found in any grid; which ones are tried next where it has no room may depend on the cells.
const CELL_MM: [f64; 2] = [2.0, 20.0];
/// How far a landing reaches into the part, mm. Source: derived. It is more than twice the height of a slab of the
/// [`Clearance`], to whose top a landing is taken; what lies in the part is cut away.
const SINK_MM: f64 = 1.0;

struct Grower<'a> {
    s: &'a SupportSettings,
    clearance: &'a Clearance,
    slope: f64,
    forest: Forest,
    queue: BinaryHeap<Turn>,
    index: PointGrid2<u32>,
    state: Vec<State>,
}

impl Grower<'_> {
    fn add(&mut self, at: DVec3, carries: u32, top_mm: f64, kind: Kind, state: State) -> u32 {
        let radius_mm = match kind {
            Kind::Contact(_) => self.s.contact_radius_mm,
            _ => self.s.radius_mm(carries, top_mm - at.z),
        };
        self.forest.nodes.push(Node {
            at,
            radius_mm,
            end_mm: radius_mm,
            carries,
            top_mm,
            below: None,
            kind,
            post: false,
        });
        self.state.push(state);
        let name = self.forest.nodes.len() as u32 - 1;
        if let State::Waiting { .. } = state {
            self.queue.push(Turn { z: at.z, name });
            self.index.insert(at.truncate(), name);
        }
        name
    }

    fn node(&self, name: u32) -> &Node {
        &self.forest.nodes[name as usize]
    }

    fn link(&mut self, upper: u32, lower: u32) {
        let at = self.node(upper).at;
        self.forest.nodes[upper as usize].below = Some(lower);
        if self.state[upper as usize] != State::Done {
            self.index.remove(at.truncate(), |node| node == upper);
        }
        self.state[upper as usize] = State::Done;
    }

    /// Adds the tip at a contact. It leaves the part along the normal, or in another direction where that leans too far
    /// or has no room.
    fn begin(&mut self, i: u32, contact: &Contact) {
        let top = contact.at - DVec3::Z * self.s.z_gap_mm;
        if top.z < 0.5 * self.s.first_layer_mm {
            self.forest.unreached.push(i);
            return;
        }
        let keep = self.s.branch_radius_mm + self.s.xy_gap_mm;
        let mut clear = None;
        let usual_mm = self.s.tip_length_mm.max(contact.tip_mm);
        for t in [1.0, 0.6, 1.5, 2.0, 2.8, 4.0].map(|k| k * TIP_LENGTHS.value() * usual_mm) {
            for way in self.tip_directions(contact.normal) {
                let end = top + way * t;
                if end.z < STUMP_MM.value().min(0.5 * top.z) || self.clearance.distance_mm(end) < keep {
                    continue;
                }
                if self.clearance.leads_to_plate(end) {
                    self.tip(i, top, end, true);
                    return;
                }
                clear = clear.or(Some(end));
            }
        }
        match clear {
            Some(end) if !self.s.from_plate_only => self.tip(i, top, end, false),
            _ => self.post(i, top),
        }
    }

    fn tip_directions(&self, normal: DVec3) -> impl Iterator<Item = DVec3> + use<> {
        let limit = self.slope;
        let flat = normal.truncate().normalize_or_zero();
        let leaning = move |across: DVec2, slope: f64| (across * slope).extend(-1.0).normalize();
        let own = normal.truncate().length() / (-normal.z).max(1e-6);
        let along = leaning(flat, own.min(limit));
        let around =
            (0..8).map(move |k| leaning(direction(f64::from(k) * std::f64::consts::FRAC_PI_4), limit));
        [along, -DVec3::Z, leaning(flat, limit)].into_iter().chain(around)
    }

    fn tip(&mut self, i: u32, top: DVec3, end: DVec3, plate: bool) {
        let contact = self.add(top, 1, top.z, Kind::Contact(i), State::Done);
        let tip = self.add(end, 1, top.z, Kind::Tip, State::Waiting { plate });
        self.forest.nodes[contact as usize].below = Some(tip);
    }

    /// Adds a post where there is no room for a branch. It goes straight down to the part or the plate, and is cut to fit
    /// afterwards.
    fn post(&mut self, i: u32, top: DVec3) {
        let below = self.clearance.floor_mm(top - DVec3::Z * POST_BELOW_MM);
        if self.s.from_plate_only && below > 0.0 || top.z - below < 1e-3 {
            self.forest.unreached.push(i);
            return;
        }
        let contact = self.add(top, 1, top.z, Kind::Contact(i), State::Done);
        self.forest.nodes[contact as usize].post = true;
        let kind = if below > 0.0 { Kind::Landing } else { Kind::Foot };
        let foot = self.add(top.with_z((below - self.s.sink_mm()).max(0.0)), 1, top.z, kind, State::Done);
        self.forest.nodes[foot as usize].radius_mm = self.s.branch_radius_mm;
        self.forest.nodes[contact as usize].below = Some(foot);
    }

    fn run(&mut self) {
        while let Some(turn) = self.queue.pop() {
            let State::Waiting { plate } = self.state[turn.name as usize] else { continue };
            if self.meet(turn.name, plate) {
                continue;
            }
            if plate { self.go_on(turn.name) } else { self.land(turn.name) }
        }
    }

    /// Joins a node with the partner that saves the most length. Returns whether there is one.
    fn meet(&mut self, name: u32, plate: bool) -> bool {
        let mut meetings = self.meetings(name, plate);
        meetings.sort_by(|a, b| b.gain_mm.total_cmp(&a.gain_mm).then(a.with.cmp(&b.with)));
        for m in meetings.iter().take(TRIES) {
            if self.can_meet(name, m, plate) {
                self.join(name, m, plate);
                return true;
            }
        }
        false
    }

    fn floor(&self, p: DVec3, plate: bool) -> f64 {
        if plate { 0.0 } else { self.clearance.floor_mm(p) }
    }

    fn meetings(&self, name: u32, plate: bool) -> Vec<Meeting> {
        let p = self.node(name).at;
        let alone = p.z - self.floor(p, plate);
        // Least length that a joint costs for each millimetre between the partners: that of two equally high ones.
        let cost = 1.0 / sin(self.s.branch_angle_rad) - 0.5 / self.slope;
        let mut out: Vec<Meeting> = Vec::new();
        let mut best = f64::NEG_INFINITY;
        for ring in 0..self.index.cells().n_rings() {
            let nearest = self.index.cells().ring_distance_mm(ring);
            let bound = alone + FOOT_MM.value() - cost * nearest;
            if bound < 0.0 || nearest > self.s.max_reach_mm || (out.len() >= TRIES && bound < best) {
                break;
            }
            for (_, other) in self.index.ring(p.truncate(), ring) {
                if other == name {
                    continue;
                }
                let Some(m) = self.meeting(p, alone, other, plate) else { continue };
                best = best.max(m.gain_mm);
                out.push(m);
            }
        }
        out
    }

    fn meeting(&self, p: DVec3, alone: f64, other: u32, plate: bool) -> Option<Meeting> {
        let q = self.node(other).at;
        let (at, gain_mm) = match self.state[other as usize] {
            State::Done => return None,
            State::Trunk => {
                if !plate {
                    return None;
                }
                let d = (p - q).truncate().length();
                let at = q.with_z((p.z - d / self.slope).min(q.z));
                (at, alone - p.distance(at) + FOOT_MM.value())
            }
            State::Waiting { plate: to_plate } => {
                if to_plate != plate {
                    return None;
                }
                let at = cones_meet(p, q, self.slope);
                let other_alone = q.z - self.floor(q, plate);
                let floor = self.floor(at, plate);
                let together = p.distance(at) + q.distance(at) + (at.z - floor);
                (at, alone + other_alone - together + FOOT_MM.value())
            }
        };
        let low =
            self.floor(at, plate) + STUMP_MM.value().max(if plate { self.s.base_height_mm } else { 0.0 });
        let near = (p - at).truncate().length() <= self.s.max_reach_mm;
        (gain_mm > 0.0 && at.z > low && near).then_some(Meeting { gain_mm, with: other, at })
    }

    fn can_meet(&self, name: u32, m: &Meeting, plate: bool) -> bool {
        let (p, q) = (self.node(name), self.node(m.with));
        // A thicker branch is made thinner where the part is near, as on a way around the part.
        let keep = self.s.branch_radius_mm + self.s.xy_gap_mm;
        let clear = |a: &Node| {
            a.at.distance(m.at) < 1e-9
                || self.clearance.is_clear(a.at, m.at, keep.min(self.clearance.distance_mm(a.at)))
        };
        (!plate || self.clearance.leads_to_plate(m.at)) && clear(p) && clear(q)
    }

    fn join(&mut self, name: u32, m: &Meeting, plate: bool) {
        let (p, q) = (*self.node(name), *self.node(m.with));
        let carries = p.carries + q.carries;
        let top = p.top_mm.max(q.top_mm);
        let was = self.state[m.with as usize];
        if m.at.distance(q.at) < 1e-9 && !matches!(q.kind, Kind::Contact(_)) {
            // The branch goes straight to the other node, which now carries more and whose turn is still to come.
            let radius_mm = self.s.radius_mm(carries, top - q.at.z);
            let node = &mut self.forest.nodes[m.with as usize];
            (node.carries, node.top_mm, node.radius_mm) = (carries, top, radius_mm);
            self.link(name, m.with);
            return;
        }
        let state = if was == State::Trunk { State::Trunk } else { State::Waiting { plate } };
        let joint = self.add(m.at, carries, top, Kind::Join, state);
        if state == State::Trunk {
            self.index.insert(m.at.truncate(), joint);
        }
        self.link(name, joint);
        self.link(m.with, joint);
    }

    /// Lets a branch go on alone towards the plate: as a trunk if nothing is below, else round the part.
    fn go_on(&mut self, name: u32) {
        let node = *self.node(name);
        if self.clearance.is_straight(node.at) {
            self.state[name as usize] = State::Trunk;
            return;
        }
        let way = self.clearance.way_down(node.at);
        match way.first() {
            Some(&next) if next.z < node.at.z - 1e-9 => {
                let plate = self.clearance.leads_to_plate(next);
                let bend = self.add(next, node.carries, node.top_mm, Kind::Bend, State::Waiting { plate });
                self.link(name, bend);
            }
            _ => self.land(name),
        }
    }

    /// Lets a branch end alone, straight below, on the part or the plate.
    fn land(&mut self, name: u32) {
        let node = *self.node(name);
        let floor = self.clearance.floor_mm(node.at);
        let kind = if floor > 0.0 { Kind::Landing } else { Kind::Foot };
        let at = node.at.with_z((floor - self.s.sink_mm()).max(0.0));
        let foot = self.add(at, node.carries, node.top_mm, kind, State::Done);
        self.forest.nodes[name as usize].post = true;
        self.link(name, foot);
    }

    /// Gives every trunk its foot.
    fn stand(&mut self) {
        for name in 0..self.forest.nodes.len() as u32 {
            if self.state[name as usize] == State::Trunk {
                let node = *self.node(name);
                let foot = self.add(node.at.with_z(0.0), node.carries, node.top_mm, Kind::Foot, State::Done);
                self.link(name, foot);
            }
        }
    }

    /// Gives the lower end of every branch its radius.
    fn give_ends(&mut self) {
        for name in 0..self.forest.nodes.len() {
            let node = self.forest.nodes[name];
            let Some(below) = node.below else { continue };
            let below = self.node(below);
            // A post ends as wide as its foot.
            let is_thin = node.post && matches!(node.kind, Kind::Contact(_));
            self.forest.nodes[name].end_mm = if is_thin {
                below.radius_mm
            } else {
                self.s.radius_mm(node.carries, node.top_mm - below.at.z)
            };
        }
    }
}

impl SupportSettings {
    /// Radius of a branch at `length_mm` below the highest of the contacts it `carries`. It withstands Euler's load for a
    /// column of that length, and is never more slender than allowed.
    pub fn radius_mm(&self, carries: u32, length_mm: f64) -> f64 {
        let length = length_mm.max(0.0);
        let load_n = f64::from(carries) * self.load_per_contact_n;
        let pi3 = std::f64::consts::PI.powi(3);
        let euler = pow(16.0 * load_n / (pi3 * self.stiffness_mpa), 0.25) * length.sqrt();
        let slender = 0.5 * length / self.max_slenderness;
        euler.max(slender).clamp(self.branch_radius_mm, self.most_mm())
    }

    /// The largest radius of a branch, mm.
    pub(super) fn most_mm(&self) -> f64 {
        self.base_radius_mm.max(self.branch_radius_mm)
    }

    /// The largest radius that a branch may have at a place near the part, mm.
    pub(super) fn thickest_mm(&self, clearance: &Clearance, at: DVec3) -> f64 {
        (clearance.distance_mm(at) - self.xy_gap_mm).max(self.branch_radius_mm)
    }

    /// How far a landing reaches into the part, mm.
    pub(super) fn sink_mm(&self) -> f64 {
        SINK_MM
    }
}
