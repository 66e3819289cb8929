//! Which support beads lie on something, and the beads added below those that do not.
//!
//! A branch is printed as a ring of bead along the rim of its section. The section may rest on the one below while the
//! ring does not: if a cone narrows by more than a bead in a layer, the upper ring lies over the hollow of the lower one.
//! So the beads themselves are checked, in two passes.
//!
//! From the top down: a point of a bead is held if a bead of the next lower layer lies within [`REACH`] bead widths
//! of it in plan, or if the part lies below it, across the removal gap. Below every stretch that is not held, a bead is
//! added. It is moved towards the nearest bead of its own layer as far as the upper bead still rests on it, but not so
//! far that the two overlap. Added beads are checked in turn. A bead far from a wall is thus carried by a corbel that
//! steps towards the wall, with one or two loops a layer, and the hollow is not filled down to the plate.
//!
//! From the plate up: a stretch that still lies on air, because the part is in the way of a bead below it, is left out
//! together with all that stood on it. All that remains is held; [`on_air`] counts independently to confirm it.
//!
//! Lengths are mm. Cost: one search in a grid of points for every `STEP_MM` of bead and pass; about a second for
//! 100 m of support; the walls of the part are laid once more for it. Limits: the infill of the part is not known yet, so the
//! part is taken to hold a bead wherever it will have area inside its outermost wall. Where it is too thin for a wall, the
//! single beads hold that will be laid there, and nothing does where there are none. Sparse fill inside branches
//! (`support.density` above 0) bridges from wall to wall and is not checked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use grainpath_core::buckets::PointGrid2;
use grainpath_core::math::{direction, tan};
use grainpath_core::poly::{FillRule, LineClipper, simplify_contour, simplify_line};
use grainpath_core::segment;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{Bounds2, DVec2, Density, Layer, LayerStack, Region, Role, Toolpath};
use rayon::prelude::*;

use super::SupportSettings;
use super::beads::{self, BeadSettings, SHORT_MM};
use super::cut::{self, Heights, Layers, SupportLayer, TOUCH_MM, within};
use super::interface::{self, END_MM, WALK};
use super::overhang::Overhangs;
use super::tree::{Forest, Kind};
use crate::order::Island;
use crate::wall::{WallSettings, lay_walls};

/// A point of a bead is held if the centreline of a bead below is at most this many bead widths away in plan. A seventh
/// of the upper bead then lies on the lower one, and the rest leans on the beads beside it.
///
/// Source: the criterion by which printed supports are judged (`CHECKED`). A program that replays the G-code allows
/// 0.95 bead widths between points that it takes up to 0.3 mm apart along the beads. Beads 0.45 mm wide and within
/// 0.86 widths of each other meet it wherever these points fall.
pub const REACH: f64 = 0.86;
/// The reach in bead widths when beads are left out. It is a little more than [`REACH`], so that rounding alone leaves
/// no bead out.
///
/// Source: measured. At 0.89 the program that replays the G-code (`CHECKED`) finds beads on air, because its points
/// lie up to 0.3 mm apart.
const LEAVE: f64 = 0.87;
/// Least distance of an added bead from the nearest bead of its layer, in bead widths. At this distance the wall of an
/// upright trunk holds the added bead from the layer below, and no further bead is added under it.
///
/// Source: [`REACH`] less the 0.01 mm of [`SMOOTH_MM`]; the two beads overlap by a fifteenth of a width in layers of 0.2 mm.
const CLOSE: f64 = 0.84;
/// Least such distance beside a branch that leans away from the added bead, in bead widths. The two beads then overlap by
/// about half, in one layer. Farther away, a bead beside the branch would be needed in every layer down to the plate.
///
/// Source: [`CLOSE`] less the lean of a branch at 40 degrees in a layer of 0.2 mm (0.37 of a bead 0.45 mm wide).
const CLOSEST: f64 = 0.45;
/// Distance of the points at which beads are checked, mm.
///
/// Source: at [`REACH`] of a bead 0.45 mm wide the error of a distance is then 0.003 mm (Pythagoras with half a step).
const STEP_MM: f64 = 0.1;
/// Corners of added lines are cut by at most this, mm.
///
/// Source: a fifth of the slack between [`WALK`] and [`REACH`] in beads 0.45 mm wide.
const SMOOTH_MM: f64 = 0.01;
/// No bead is added farther from the nearest bead of its layer than `base_radius_mm`, the radius of the widest hollow of a
/// trunk, plus this, mm. A bead farther away has no wall to step towards.
///
/// Source: four beads, because the foot of a trunk is that far from its neighbours.
const FAR_MM: f64 = 2.0;
/// Largest distance along a lower bead from any place to the next point at which printed supports are judged
/// (`CHECKED`), mm.
///
/// Source: derived: half of the 0.3 mm by which these points lie apart at most.
const APART_MM: f64 = 0.15;
/// The criterion for a support bead on air: a point of it is held if a point of a bead of the layer below lies within
/// this many bead widths in plan. A program that replays the G-code counts the length that is not held, with points
/// up to 0.3 mm apart along all beads. `crates/grainpath-cli/tests/support_beads.rs` repeats the test with finer
/// points.
///
/// Source: chosen. Two beads of equal width that are farther apart than this overlap by less than a twentieth of a
/// width.
const CHECKED: f64 = 0.95;

/// An end of a bead that holds nothing is at most this share of the bead.
///
/// Source: derived. The fifth in the middle is then more than half of [`STEP_MM`] in the shortest bead, so that it holds.
const END_SHARE: f64 = 0.4;
/// No removal gap spans more than this number of layers, so sections further below are not needed again.
///
/// Source: chosen; it changes speed alone, because a section that is forgotten is made again.
const KEPT_LAYERS: usize = 8;
/// Number of layers that one thread counts one after the other.
///
/// Source: chosen; it changes speed alone, because each chunk lays walls of the part below its own layers.
const CHUNK: usize = 16;

/// Lays the beads of all layers, adds beads that hold them, and leaves out those that nothing can hold.
pub fn stand(
    out: &mut Layers,
    forest: &Forest,
    overhangs: &Overhangs,
    stack: &LayerStack,
    settings: &SupportSettings,
) {
    let contacts = &overhangs.contacts;
    let heights = &Heights::new(stack);
    let walls = &PartWalls::new(stack, settings);
    let lay = |k: usize, layer: &SupportLayer| lay(layer, k, stack, &settings.beads);
    let islands: Vec<Vec<Island>> =
        out.layers.par_iter().enumerate().map(|(k, layer)| lay(k, layer)).collect();
    for (layer, islands) in out.layers.iter_mut().zip(islands) {
        layer.islands = Some(islands);
    }
    let mut part = Part::new(stack, heights, settings, walls);
    let interface = interface::lay(&overhangs.lines, heights, out.layers.len(), settings);
    for (k, beads) in interface.into_iter().enumerate().rev().filter(|(_, beads)| !beads.is_empty()) {
        add_interface(&mut out.layers[k], k, beads, &mut part);
        part.forget_above(k);
    }
    let mut part = Part::new(stack, heights, settings, walls);
    let mut arches = BTreeSet::new();
    // Beads of a layer are indexed once, before any are added: the deeper layer of one step is the lower one of the next.
    let mut before = out.layers.iter().rev().nth(1).and_then(|layer| Beads::new(layer.islands()));
    for k in (1..out.layers.len()).rev() {
        let (low, high) = out.layers.split_at_mut(k);
        let Some((lower, deeper)) = low.split_last_mut() else { break };
        let deeper = deeper.last().and_then(|layer| Beads::new(layer.islands()));
        arches = hold(
            &high[0],
            lower,
            [before.as_ref(), deeper.as_ref()],
            &arches,
            k,
            &mut part,
            settings,
            heights,
        );
        before = deeper;
        part.forget_above(k);
    }
    let mut part = Part::new(stack, heights, settings, walls);
    let mut left_out_mm = 0.0;
    for k in 1..out.layers.len() {
        let (low, high) = out.layers.split_at_mut(k);
        left_out_mm += leave_out(&mut high[0], &low[k - 1], k, &mut part);
        part.forget_below(k);
    }
    out.left_out_mm = left_out_mm;
    // Beads were left out and added, so the pieces of all layers are checked again for support below them.
    cut::settle(out, stack, heights, settings);
    // A tip is about a bead wide, so its bead lies within a bead of the contact.
    let reach_mm = settings.contact_radius_mm + settings.beads.bead_width_mm;
    let bare = |&i: &u32| {
        let c = &contacts[i as usize];
        let end = heights.end_below(c.at.z, settings.z_gap_mm);
        let near = |k: usize| any_within(&out.layers[k], c.at.truncate(), reach_mm);
        !(end.saturating_sub(2)..end).any(near)
    };
    let tried = forest.nodes.iter().filter_map(|n| match n.kind {
        Kind::Contact(i) => Some(i),
        _ => None,
    });
    let mut lost: Vec<u32> = tried.filter(bare).chain(out.lost.iter().copied()).collect();
    lost.sort_unstable();
    lost.dedup();
    out.lost = lost;
    (out.floating, out.floating_mm) = count_on_air(&out.layers, stack, settings, walls);
}

/// The beads of a layer without sparse fill.
fn lay(layer: &SupportLayer, k: usize, stack: &LayerStack, settings: &BeadSettings) -> Vec<Island> {
    if layer.region.is_empty() {
        return Vec::new();
    }
    let settings = BeadSettings { density: Density::new(0.0), ..*settings };
    let context = crate::fill::FillContext {
        z_mid_mm: 0.0,
        height_mm: stack.layers()[k].height_mm(),
        bead_width_mm: settings.bead_width_mm,
        min_bead_width_mm: settings.min_bead_width_mm,
        density: Density::Dense,
        angle_rad: 0.0,
        part: Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO },
        role: Role::Support,
        border_mm: 0.0,
        ends: grainpath_job::choices::BeadEnds::Joined,
        shift: crate::fill::Shift::NONE,
        below: None,
        fills_wedges: false,
        widths: grainpath_job::choices::BeadWidths::Variable,
        field: None,
    };
    beads::lay(layer, &context, k < settings.dense_layers, &settings)
}

/// The number of support beads that lie partly or wholly on air, and the length that does, mm, counted independently from
/// the finished beads.
pub fn on_air(layers: &[SupportLayer], stack: &LayerStack, settings: &SupportSettings) -> (usize, f64) {
    count_on_air(layers, stack, settings, &PartWalls::new(stack, settings))
}

fn count_on_air(
    layers: &[SupportLayer],
    stack: &LayerStack,
    settings: &SupportSettings,
    walls: &PartWalls,
) -> (usize, f64) {
    let heights = Heights::new(stack);
    let of_layer = |part: &mut Part<'_>, k: usize| -> (usize, f64) {
        let below = Beads::new(layers[k - 1].islands());
        let air_mm = paths(layers[k].islands()).map(|path| {
            let samples = samples(path);
            let free = samples.iter().filter(|s| !held(s, below.as_ref(), part, k, LEAVE + 1e-6)).count();
            free as f64 / samples.len().max(1) as f64 * path.length_mm()
        });
        air_mm.filter(|&mm| mm > 0.0).fold((0, 0.0), |(n, sum), mm| (n + 1, sum + mm))
    };
    let all: Vec<usize> = (1..layers.len()).collect();
    // Neighbouring layers stand on the same layers of the part.
    let of_chunk = |chunk: &[usize]| -> Vec<(usize, f64)> {
        let mut part = Part::new(stack, &heights, settings, walls);
        let of_layer = |&k: &usize| {
            part.forget_below(k);
            of_layer(&mut part, k)
        };
        chunk.iter().map(of_layer).collect()
    };
    let all: Vec<Vec<(usize, f64)>> = all.par_chunks(CHUNK).map(of_chunk).collect();
    all.into_iter().flatten().fold((0, 0.0), |(n, sum), (m, mm)| (n + m, sum + mm))
}

/// Whether a bead of the layer lies within a distance of a point.
pub(crate) fn any_within(layer: &SupportLayer, p: DVec2, reach_mm: f64) -> bool {
    let near = |path: &Toolpath| {
        let mut segments = (0..path.n_segments()).map(|i| path.segment(i));
        segments.any(|(a, b, _)| segment::distance_squared_mm2(p, a, b) <= reach_mm * reach_mm)
    };
    paths(layer.islands()).any(near)
}

fn paths(islands: &[Island]) -> impl Iterator<Item = &Toolpath> {
    islands.iter().flat_map(|i| i.walls.iter().map(|w| &w.path).chain(&i.fills))
}

/// A point of a bead and its width there.
#[derive(Clone, Copy)]
struct Sample {
    at: DVec2,
    width_mm: f64,
}

/// Points along a path, both ends included. In a closed path the first point is not repeated.
fn samples(path: &Toolpath) -> Vec<Sample> {
    let mut out = Vec::new();
    for i in 0..path.n_segments() {
        let (a, b, width_mm) = path.segment(i);
        let n = ((a.distance(b) / STEP_MM).ceil() as usize).max(1);
        out.extend((0..n).map(|j| Sample { at: a.lerp(b, j as f64 / n as f64), width_mm }));
    }
    if let (false, Some(&at)) = (path.closed, path.points.last()) {
        out.push(Sample { at, width_mm: path.width_at(path.points.len() - 1) });
    }
    out
}

/// The beads of a layer, indexed by position, each with the number of its island.
struct Beads(PointGrid2<u32>);

impl Beads {
    fn new(islands: &[Island]) -> Option<Self> {
        let points = || paths(islands).flat_map(|p| p.points.iter().copied());
        let bounds = Bounds2::around_points(points())?.grown(1.0);
        let mut beads = Self(PointGrid2::new(bounds, 1.0));
        for (i, island) in islands.iter().enumerate() {
            for path in paths(std::slice::from_ref(island)) {
                beads.add(path, i as u32);
            }
        }
        Some(beads)
    }

    /// Adds the points of a bead. An open bead is added without its end pieces, which are taken to hold nothing.
    fn add(&mut self, path: &Toolpath, island: u32) {
        if path.closed || path.n_segments() == 0 {
            samples(path).into_iter().for_each(|s| self.0.insert(s.at, island));
            return;
        }
        // An upper bead that goes on beyond the end of an open bead has nothing to lie on there, so the end piece counts as
        // holding nothing. Short beads keep their middle.
        let end_mm = END_MM.min(END_SHARE * path.length_mm());
        let ends = [path.segment(0), path.segment(path.n_segments() - 1)];
        let [first, last] = ends.map(|(a, b, _)| (a, b));
        for (end, inwards) in [(first.0, first.1 - first.0), (last.1, last.0 - last.1)] {
            self.0.insert(end + inwards.normalize_or_zero() * end_mm, island);
        }
        let carries = |s: &Sample| [first.0, last.1].iter().all(|end| end.distance(s.at) >= end_mm);
        samples(path).into_iter().filter(carries).for_each(|s| self.0.insert(s.at, island));
    }

    /// The nearest bead: its nearest point, the distance, and the number of its island.
    fn nearest(&self, p: DVec2) -> Option<(DVec2, f64, u32)> {
        self.0.nearest(p, |_| true).map(|(q, island)| (q, q.distance(p), island))
    }
}

/// Sections of the part near the layer that is being processed.
pub(super) struct Part<'a> {
    stack: &'a LayerStack,
    heights: &'a Heights,
    gap_mm: f64,
    walls: &'a PartWalls,
    clippers: BTreeMap<usize, LineClipper>,
    beads: BTreeMap<usize, PartBeads>,
}

/// The outermost walls of the part, layer by layer, each laid when it is first asked for.
pub(super) struct PartWalls {
    settings: WallSettings,
    layers: Vec<OnceLock<OuterWalls>>,
}

/// The outermost walls of a layer.
struct OuterWalls {
    /// The area within their centrelines.
    inside: Region,
    /// The single beads where the part is too thin for a wall.
    thin: Island,
}

impl PartWalls {
    pub(super) fn new(stack: &LayerStack, settings: &SupportSettings) -> Self {
        let layers = stack.layers().iter().map(|_| OnceLock::new()).collect();
        Self { settings: settings.walls, layers }
    }

    fn of_layer(&self, layer_idx: usize, layer: &Layer) -> &OuterWalls {
        self.layers[layer_idx].get_or_init(|| {
            let settings = WallSettings { height_mm: layer.height_mm(), ..self.settings };
            let (mut rims, mut thin) = (Vec::new(), Island::default());
            for polygon in &layer.region().polygons {
                let walls = lay_walls(polygon, &settings);
                // A part without walls ends with its infill.
                if settings.n_walls == 0 {
                    rims.extend(walls.fill.contours().cloned());
                }
                let outer = walls.loops.into_iter().filter(|wall| wall.depth == 0);
                rims.extend(outer.map(|wall| wall.path.points));
                thin.fills.extend(walls.singles.into_iter().filter(|path| path.role == Role::ThinWall));
            }
            OuterWalls { inside: Region::from_contours(&rims, FillRule::EvenOdd), thin }
        })
    }
}

/// What holds in a layer of the part, indexed by position: the area of its [`OuterWalls`] and the single beads.
struct PartBeads {
    inside: LineClipper,
    thin: Option<Beads>,
}

impl PartBeads {
    fn new(walls: &OuterWalls) -> Self {
        Self { inside: LineClipper::new(&walls.inside), thin: Beads::new(std::slice::from_ref(&walls.thin)) }
    }
}

impl<'a> Part<'a> {
    pub(super) fn new(
        stack: &'a LayerStack,
        heights: &'a Heights,
        settings: &SupportSettings,
        walls: &'a PartWalls,
    ) -> Self {
        Self {
            stack,
            heights,
            gap_mm: settings.z_gap_mm,
            walls,
            clippers: BTreeMap::new(),
            beads: BTreeMap::new(),
        }
    }

    fn forget_above(&mut self, k: usize) {
        self.clippers.retain(|&j, _| j <= k);
        self.beads.retain(|&j, _| j <= k);
    }

    fn forget_below(&mut self, k: usize) {
        // Lower sections are not needed again.
        self.clippers.retain(|&j, _| j + KEPT_LAYERS >= k);
        self.beads.retain(|&j, _| j + KEPT_LAYERS >= k);
    }

    /// Whether a section lies within a distance of a point.
    fn near(&mut self, layer: usize, p: DVec2, reach_mm: f64) -> bool {
        self.section_near(layer, p, reach_mm).is_some_and(|section| is_near(section, p, reach_mm))
    }

    /// Whether a section contains a point.
    pub(super) fn contains(&mut self, layer: usize, p: DVec2) -> bool {
        self.section_near(layer, p, 0.0).is_some_and(|section| section.contains(p))
    }

    /// A section whose bounds lie within a distance of a point.
    fn section_near(&mut self, layer: usize, p: DVec2, reach_mm: f64) -> Option<&LineClipper> {
        let new = || LineClipper::new(self.stack.layers()[layer].region());
        // The clipper knows its bounds; those of the region would be found anew for every point.
        let section: &LineClipper = self.clippers.entry(layer).or_insert_with(new);
        let here = Bounds2 { min: p, max: p }.grown(reach_mm);
        section.bounds().filter(|b| b.meets(here)).map(|_| section)
    }

    /// Whether a bead of the part lies below a point of layer `k`, across the removal gap.
    fn holds(&mut self, k: usize, p: DVec2, reach_mm: f64) -> bool {
        let below = self.heights.below(k, self.gap_mm);
        below.into_iter().any(|j| self.has_bead_near(j, p, reach_mm))
    }

    /// Whether a centreline of the part's beads lies within a distance of a point, or the point inside its walls.
    pub(super) fn has_bead_near(&mut self, layer: usize, p: DVec2, reach_mm: f64) -> bool {
        if !self.near(layer, p, reach_mm) {
            return false;
        }
        let section = &self.stack.layers()[layer];
        let beads =
            self.beads.entry(layer).or_insert_with(|| PartBeads::new(self.walls.of_layer(layer, section)));
        let on_bead = |thin: &Beads| thin.0.within(p, reach_mm).next().is_some();
        is_near(&beads.inside, p, reach_mm) || beads.thin.as_ref().is_some_and(on_bead)
    }

    /// Whether a bead may lie here in layer `k`.
    pub(super) fn leaves_room(&mut self, k: usize, p: DVec2, width_mm: f64) -> bool {
        let above: Vec<usize> = within(self.heights, k, self.gap_mm).collect();
        !self.near(k, p, 0.5 * width_mm + TOUCH_MM.value())
            && above.into_iter().all(|j| !self.near(j, p, 0.5 * width_mm))
    }
}

/// Whether a region lies within a distance of a point.
fn is_near(region: &LineClipper, p: DVec2, reach_mm: f64) -> bool {
    // Where the point lies outside, eight chords through it find a region nearby, far faster than an exact distance.
    let across = |i: u32| direction(f64::from(i) * std::f64::consts::FRAC_PI_8) * reach_mm;
    region.contains(p) || (0..8).any(|i| region.meets(p - across(i), p + across(i)))
}

fn held(s: &Sample, below: Option<&Beads>, part: &mut Part<'_>, k: usize, reach: f64) -> bool {
    let reach_mm = reach_mm(s.width_mm, reach);
    let on_bead = |b: &Beads| b.0.within(s.at, reach_mm).next().is_some();
    below.is_some_and(on_bead) || part.holds(k, s.at, reach_mm)
}

/// The largest distance, mm, at which a lower bead holds a bead of width `width_mm`, for a `reach` in bead widths. Narrow
/// beads have a shorter reach, because the points at which beads are judged (`CHECKED`) lie far apart for their width.
fn reach_mm(width_mm: f64, reach: f64) -> f64 {
    let checked_mm = ((CHECKED * width_mm).powi(2) - APART_MM * APART_MM).max(0.0).sqrt();
    (reach * width_mm).min(checked_mm)
}

/// The stretches of a path whose samples are `wanted`, each with a flag that marks the whole of a closed path.
fn stretches(samples: &[Sample], closed: bool, wanted: &[bool]) -> Vec<(Vec<Sample>, bool)> {
    if wanted.iter().all(|&w| w) {
        return vec![(samples.to_vec(), closed)];
    }
    // A closed path is read from a sample that is not wanted, so that no stretch is cut in two at the path's start.
    let first = if closed { wanted.iter().position(|&w| !w).unwrap_or(0) } else { 0 };
    let mut out: Vec<(Vec<Sample>, bool)> = Vec::new();
    let mut open = false;
    for i in (0..samples.len()).map(|i| (i + first) % samples.len()) {
        if wanted[i] && !open {
            out.push((Vec::new(), false));
        }
        open = wanted[i];
        if let (true, Some(last)) = (open, out.last_mut()) {
            last.0.push(samples[i]);
        }
    }
    out
}

/// The union of many regions at once.
fn all_of(regions: &[Region]) -> Region {
    let contours = regions.iter().flat_map(|r| &r.polygons).flat_map(|p| p.contours());
    Region::from_contours(contours, FillRule::NonZero)
}

/// Adds interface beads to a layer wherever the part leaves room for them.
fn add_interface(layer: &mut SupportLayer, k: usize, beads: Vec<Toolpath>, part: &mut Part<'_>) {
    let Some(islands) = &mut layer.islands else { return };
    let mut around = Vec::new();
    for bead in beads {
        let samples = samples(&bead);
        let room: Vec<bool> = samples.iter().map(|s| part.leaves_room(k, s.at, s.width_mm)).collect();
        if !room.contains(&true) {
            continue;
        }
        for (stretch, _) in stretches(&samples, false, &room) {
            let points: Vec<DVec2> = stretch.iter().map(|s| s.at).collect();
            let points = simplify_line(&points, 0.1 * SMOOTH_MM);
            if points.len() < 2 {
                continue;
            }
            let path = Toolpath { points, ..bead.clone() };
            if path.length_mm() >= SHORT_MM {
                around.push(Region::around_line(&path.points, false, 0.5 * samples[0].width_mm));
                islands.push(Island { fills: vec![path], ..Island::default() });
            }
        }
    }
    let around = all_of(&around);
    layer.region = layer.region.union(&around);
    layer.interface = layer.interface.union(&around);
}

/// Whether a bead is an interface line rather than a wall or the fill of a pad.
fn is_line(path: &Toolpath) -> bool {
    !path.closed && path.role == Role::SupportInterface
}

/// The beads of a layer that carry interface lines, each identified by the bits of its first point.
type Arches = BTreeSet<[u64; 2]>;

fn name(path: &Toolpath) -> [u64; 2] {
    path.points.first().map_or([0; 2], |p| p.to_array().map(f64::to_bits))
}

/// Adds beads to `lower`, the layer below `upper`, until `upper` is held. Returns the names of the added beads that carry
/// interface lines. The two sides of an arch step towards the beads that were there `before`, and not towards the beads
/// just added for the other side, which lead to no branch. `deeper` are the beads below `lower`.
fn hold(
    upper: &SupportLayer,
    lower: &mut SupportLayer,
    [before, deeper]: [Option<&Beads>; 2],
    arches: &Arches,
    k: usize,
    part: &mut Part<'_>,
    settings: &SupportSettings,
    heights: &Heights,
) -> Arches {
    let mut next = Arches::new();
    let (Some(before), Some(mut below)) = (before, Beads::new(lower.islands())) else {
        return next;
    };
    let w = settings.beads.bead_width_mm;
    let height_mm = heights.height_mm(k - 1);
    let spacing_mm = bead_spacing_mm(w, height_mm);
    let close_mm = spacing_mm.min(CLOSE * w);
    let lean_mm = height_mm * tan(settings.branch_angle_rad);
    let far_mm = settings.base_radius_mm + FAR_MM;
    let leaning_mm = (close_mm - lean_mm).max(CLOSEST * w);
    let added = Added { width_mm: w, close_mm: [close_mm, leaning_mm], far_mm, deeper };
    let mut around = Vec::new();
    for path in paths(upper.islands()) {
        let samples = samples(path);
        let free: Vec<bool> = samples.iter().map(|s| !held(s, Some(&below), part, k, REACH)).collect();
        if !free.contains(&true) {
            continue;
        }
        let is_arch = is_line(path) || arches.contains(&name(path));
        for (stretch, closed) in stretches(&samples, path.closed, &free) {
            let neighbours = if is_arch { before } else { &below };
            for (points, closed, island) in carriers(&stretch, closed, k, neighbours, part, &added) {
                let path = Toolpath::new(points, w, Role::Support, closed);
                if is_arch {
                    next.insert(name(&path));
                }
                below.add(&path, island);
                if path.points.iter().any(|&p| !lower.region.contains(p)) {
                    around.push(Region::around_line(&path.points, closed, 0.5 * w));
                }
                if let Some(islands) = &mut lower.islands {
                    islands[island as usize].fills.push(path);
                }
            }
        }
    }
    if !around.is_empty() {
        lower.region = lower.region.union(&all_of(&around));
    }
    next
}

/// Width and distances of beads to be added, and the layer below them.
#[derive(Clone, Copy)]
struct Added<'a> {
    width_mm: f64,
    /// Least distance of an added bead's centreline from the nearest bead of its layer, mm: first beside an upright
    /// branch, second beside one that leans away from the bead.
    close_mm: [f64; 2],
    /// Largest distance of an added bead from the nearest bead of its layer, mm.
    far_mm: f64,
    /// The beads of the layer below that of the added ones.
    deeper: Option<&'a Beads>,
}

impl Added<'_> {
    /// How far an added bead steps from `p` towards its neighbour `far_mm` away. Beside a branch that leans away it comes
    /// nearer if a bead of the next lower layer then holds it. Otherwise beads would be added all along the branch.
    fn walk_mm(&self, p: DVec2, towards: DVec2, far_mm: f64, width_mm: f64) -> f64 {
        let [upright, leaning] = self.close_mm.map(|close| (WALK * width_mm).min(far_mm - close).max(0.0));
        let held = |walk_mm: f64| {
            let at = p + towards * walk_mm;
            self.deeper.is_some_and(|beads| beads.0.within(at, REACH * self.width_mm).next().is_some())
        };
        if !held(upright) && held(leaning) { leaning } else { upright }
    }
}

/// Lines to add in layer `k - 1` to hold a stretch of a bead in layer `k`. Each comes with a flag for a closed line and
/// the number of the island it belongs to.
fn carriers(
    stretch: &[Sample],
    closed: bool,
    k: usize,
    beads: &Beads,
    part: &mut Part<'_>,
    added: &Added<'_>,
) -> Vec<(Vec<DVec2>, bool, u32)> {
    let w = added.width_mm;
    let mut lines: Vec<(Vec<DVec2>, u32, DVec2)> = Vec::new();
    let mut broken = true;
    for s in stretch {
        let found = beads.nearest(s.at).filter(|n| n.1 < added.far_mm).and_then(|(q, far_mm, island)| {
            let towards = (q - s.at).normalize_or_zero();
            let walk_mm = added.walk_mm(s.at, towards, far_mm, s.width_mm);
            let tries = [1.0, 0.5, 0.0].map(|share| s.at + towards * share * walk_mm);
            let around = (0..8).map(|i| {
                let way = direction(f64::from(i) * std::f64::consts::FRAC_PI_4);
                s.at + way * WALK * s.width_mm
            });
            let mut places = tries.into_iter().chain(around);
            places.find(|&p| part.leaves_room(k - 1, p, w)).map(|p| (p, island, towards))
        });
        let Some((p, island, towards)) = found else {
            broken = true;
            continue;
        };
        // Neighbouring points end up far apart where they stepped towards different beads or around a corner of the part.
        let mut joins = |l: DVec2| {
            let steps = (l.distance(p) / STEP_MM).ceil() as usize;
            l.distance(p) < w
                && (1..steps).all(|i| part.leaves_room(k - 1, l.lerp(p, i as f64 / steps as f64), w))
        };
        match lines.last_mut() {
            Some((line, ..)) if !broken && line.last().is_some_and(|&l| joins(l)) => line.push(p),
            _ => lines.push((vec![p], island, towards)),
        }
        broken = false;
    }
    let whole = closed && lines.len() == 1 && lines[0].0.len() == stretch.len();
    let finish = |(mut line, island, towards): (Vec<DVec2>, u32, DVec2)| {
        let ends_meet = line[0].distance(line[line.len() - 1]) < w;
        let closed = whole && ends_meet && line.len() > 3;
        if closed {
            line = simplify_contour(&line, SMOOTH_MM);
        } else {
            // A short line would not stick, so it is lengthened, or dropped where there is no room for that.
            let mut has_room = |p: DVec2| part.leaves_room(k - 1, p, w);
            line = with_longer_ends(simplify_line(&line, SMOOTH_MM), &mut has_room);
            line = lengthened(line, towards, &mut has_room)?;
        }
        let enough = if closed { line.len() >= 3 } else { line.len() >= 2 };
        enough.then_some((line, closed, island))
    };
    lines.into_iter().filter_map(finish).collect()
}

/// A line with both ends moved outwards by [`END_MM`], the length at an end that holds nothing, where there is room.
fn with_longer_ends(mut line: Vec<DVec2>, has_room: &mut dyn FnMut(DVec2) -> bool) -> Vec<DVec2> {
    for _ in 0..2 {
        if let [.., before, last] = line[..] {
            let further = last + (last - before).normalize_or_zero() * END_MM;
            if has_room(further) {
                line.push(further);
            }
        }
        line.reverse();
    }
    line
}

/// Makes a line at least as long as the shortest bead. It is centred on the line's middle, or moved to one side where the
/// part leaves no room; `None` where there is no room at all. A single point becomes a line in the direction `towards`.
fn lengthened(
    line: Vec<DVec2>,
    towards: DVec2,
    has_room: &mut dyn FnMut(DVec2) -> bool,
) -> Option<Vec<DVec2>> {
    let length: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
    let (&first, &last) = (line.first()?, line.last()?);
    if length >= SHORT_MM {
        return Some(line);
    }
    let along = (last - first).normalize_or(towards);
    let middle = 0.5 * (first + last);
    let ends = [0.5, 0.25, 0.75]
        .map(|share| [middle - along * share * SHORT_MM, middle + along * (1.0 - share) * SHORT_MM]);
    ends.into_iter().find(|ends| ends.iter().all(|&end| has_room(end))).map(|ends| ends.to_vec())
}

/// Removes from `upper` the stretches of beads that lie on air above `lower`. Returns the length removed, mm.
fn leave_out(upper: &mut SupportLayer, lower: &SupportLayer, k: usize, part: &mut Part<'_>) -> f64 {
    let below = Beads::new(lower.islands());
    let mut lost_mm = 0.0;
    let Some(islands) = &mut upper.islands else { return 0.0 };
    for island in islands.iter_mut() {
        let mut open: Vec<Toolpath> = Vec::new();
        let mut keep = |path: &Toolpath| -> bool {
            let samples = samples(path);
            let on: Vec<bool> = samples.iter().map(|s| held(s, below.as_ref(), part, k, LEAVE)).collect();
            if !on.contains(&false) {
                return true;
            }
            lost_mm += path.length_mm();
            for (stretch, _) in stretches(&samples, path.closed, &on) {
                let points: Vec<DVec2> = stretch.iter().map(|s| s.at).collect();
                let mut rest = path.clone();
                rest.points = simplify_line(&points, 0.1 * SMOOTH_MM);
                rest.closed = false;
                let width_mm = stretch.iter().map(|s| s.width_mm).fold(f64::INFINITY, f64::min);
                rest.width = grainpath_core::BeadWidth::Constant(width_mm);
                if rest.points.len() > 1 && rest.length_mm() >= SHORT_MM {
                    lost_mm -= rest.length_mm();
                    open.push(rest);
                }
            }
            false
        };
        island.walls.retain(|w| keep(&w.path));
        island.fills.retain(&mut keep);
        island.fills.append(&mut open);
    }
    islands.retain(|i| !i.walls.is_empty() || !i.fills.is_empty());
    lost_mm
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::config;

    #[test]
    fn thin_places_of_the_part_hold_where_a_bead_is_laid() {
        let support =
            grainpath_job::parse_job("support.style = \"tree\"", "job.toml", &[], &|_| Err(String::new()));
        let settings =
            config::support(&support.expect("a sound job"), None, Default::default()).expect("trees");
        // Strips along y: too thin for any bead, as thin as a bead, and nearly as thick as two.
        let strips = [(0.0, 0.15), (10.0, 0.4), (20.0, 0.7)];
        let strip = |(x, wide): (f64, f64)| {
            Region::rectangle(DVec2::new(x - 0.5 * wide, 0.0), DVec2::new(x + 0.5 * wide, 20.0))
        };
        let section = Region { polygons: strips.into_iter().flat_map(|one| strip(one).polygons).collect() };
        let stack = LayerStack::new(vec![Layer::new(0.2, 0.2, section).expect("a layer")]).expect("a stack");
        let heights = Heights::new(&stack);
        let walls = PartWalls::new(&stack, &settings);
        let mut part = Part::new(&stack, &heights, &settings, &walls);
        let reach_mm = 0.39;
        let mut held = |x: f64| part.has_bead_near(0, DVec2::new(x, 10.0), reach_mm);
        assert!(!held(0.0) && !held(0.2), "nothing is laid in a sliver");
        for x in [10.0, 20.0] {
            // One bead runs along the middle.
            assert!(held(x) && held(x - 0.37) && held(x + 0.37), "beside the bead at {x} mm");
            assert!(!held(x - 0.41) && !held(x + 0.41), "beyond the bead at {x} mm");
        }
    }
}
