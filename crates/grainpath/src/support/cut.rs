//! Cuts support trees into layers.
//!
//! Method: our own. A branch is a skewed cone, so its horizontal sections are discs. The support in a layer
//! is the union of all discs at the middle of its height, less the part with the gap around it. Near the part
//! a branch is first made thinner, by no more a layer than its lean allows, so that less has to be cut off.
//! Tips and posts touch the part and are cut 0.05 mm from it. From the plate upwards every piece is then
//! removed that shares no area with the support below and does not lie on the part across the removal gap.
//! The layers, and not the trees, are checked for this, because the layers are printed. A second count on the
//! finished layers confirms that no piece floats.
//!
//! Lengths are in mm, areas in mm2. Discs are polygons of 10 to 64 sides, within 0.01 mm of the circle up to
//! a radius of 8 mm. Cost: one union and a few booleans a layer; the part is offset in windows around the
//! discs alone. Layers are cut in parallel. Support pieces are found by their boxes.
//!
//! Degenerate cases: pieces below 0.02 mm2 are left out. Two pieces rest on each other if one has a corner in
//! the other or they share more than 1e-4 mm2. Contacts that no support reaches after the cuts are listed.
//! Support outside the bed is cut off. A forest without branches gives empty layers.

use grainpath_core::math::{acos, direction, tan};
use grainpath_core::poly::{FillRule, Join};
use grainpath_core::tuned::Tuned;
use grainpath_core::{Contour, DVec2, LayerStack, Polygon, Region};
use rayon::prelude::*;

use super::SupportSettings;
use super::clearance::Clearance;
use super::contact::Contact;
use super::tree::{Forest, Kind};
use crate::order::Island;

/// The support in one layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SupportLayer {
    /// The whole support of this layer.
    pub region: Region,
    /// The part of it that is laid densely because it touches the part.
    pub interface: Region,
    /// The beads of trees, without sparse fill; `None` for the baselines, whose beads are laid together with the part's.
    pub islands: Option<Vec<Island>>,
}

impl SupportLayer {
    /// The beads of trees.
    pub fn islands(&self) -> &[Island] {
        self.islands.as_deref().unwrap_or_default()
    }
}

/// The support as layers, one for each layer of the part.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layers {
    /// From the plate upwards.
    pub layers: Vec<SupportLayer>,
    /// Number of pieces that stood on nothing after the cuts and were removed.
    pub dropped: usize,
    /// Number of support beads with nothing below them, counted after all cuts; it should be 0. For the baselines,
    /// which have no beads yet, the number of pieces with nothing below them.
    pub floating: usize,
    /// Length of those beads that lies on air, mm.
    pub floating_mm: f64,
    /// Length of the beads that were left out because nothing could be laid below them, mm.
    pub left_out_mm: f64,
    /// Contacts that the support no longer reaches after the cuts, as indices.
    pub lost: Vec<u32>,
}

/// What is cut off a disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Trim {
    /// Nothing: the part is far away.
    Nothing,
    /// Everything within the gap around the part.
    AtGap,
    /// Only what lies in the part, without a gap: the disc belongs to a contact or a post.
    AtPart,
}

#[derive(Debug, Clone, Copy)]
struct Disc {
    at: DVec2,
    radius_mm: f64,
    trim: Trim,
    interface: bool,
}

/// Largest distance between a disc's polygon and the circle, mm. Source: derived. Less than a microstep of a motor of 200
/// steps, divided by 16, on a belt of 40 mm a turn (0.0125 mm).
const CHORD_MM: f64 = 0.01;
/// Distance of a tip from the wall beside it, mm. Measured: row `support.cut.TOUCH_MM` of `cargo xtask bench constants`.
pub(super) static TOUCH_MM: Tuned<f64> = Tuned::new("support.cut.TOUCH_MM", 0.05);
/// Pieces smaller than this are not printed, mm2. Source: derived. The dot of a nozzle of 0.4 mm covers 0.13 mm2, six times
/// as much.
const CRUMB_MM2: f64 = 0.02;
/// A disc that keeps the gap from the part by this much more is not trimmed, mm. Source: derived. Distances are good to
/// half a cell of 0.4 mm and to the slab; at two cells no part can be within the gap, so it changes speed alone.
const FAR_MM: f64 = 0.8;

/// Cuts trees into layers.
pub fn cut(
    forest: &Forest,
    contacts: &[Contact],
    stack: &LayerStack,
    clearance: &Clearance,
    settings: &SupportSettings,
) -> Layers {
    let heights = Heights::new(stack);
    let discs = discs(forest, contacts, &heights, clearance, settings);
    let cut_layer = |k: usize| layer(&discs[k], k, stack, &heights, settings);
    let layers: Vec<SupportLayer> = (0..discs.len()).into_par_iter().map(cut_layer).collect();
    let mut out = Layers { layers, ..Layers::default() };
    settle(&mut out, stack, &heights, settings);
    let tried = forest.nodes.iter().filter_map(|n| match n.kind {
        Kind::Contact(i) => Some(i),
        _ => None,
    });
    let tried: Vec<u32> = tried.collect();
    let lost = |&i: &u32| !is_reached(&contacts[i as usize], &out, &heights, settings);
    let mut lost: Vec<u32> = tried.into_par_iter().filter(lost).collect();
    lost.sort_unstable();
    out.lost = lost;
    out
}

/// The heights at which layers end, and those at which their sections are taken.
pub struct Heights {
    tops: Vec<f64>,
    middles: Vec<f64>,
}

impl Heights {
    /// The heights of a stack.
    pub fn new(stack: &LayerStack) -> Self {
        let layers = stack.layers();
        let tops = layers.iter().map(|l| l.z_top_mm()).collect();
        let middles = layers.iter().map(|l| l.z_top_mm() - 0.5 * l.height_mm()).collect();
        Self { tops, middles }
    }

    /// Thickness of a layer.
    pub(super) fn height_mm(&self, k: usize) -> f64 {
        self.tops[k] - self.bottom(k)
    }

    /// The layers of the part on which a piece of layer `k` may lie, across the removal gap: from the highest down.
    pub(super) fn below(&self, k: usize, gap_mm: f64) -> impl Iterator<Item = usize> + '_ {
        let bottom = self.bottom(k);
        (0..k).rev().take_while(move |&j| self.tops[j] > bottom - gap_mm - 1e-6)
    }

    fn bottom(&self, k: usize) -> f64 {
        if k > 0 { self.tops[k - 1] } else { 0.0 }
    }

    /// The number of support layers below a contact. They end at least the gap below the bottom of the layer in which
    /// the part begins there.
    pub(crate) fn end_below(&self, z_mm: f64, gap_mm: f64) -> usize {
        let part = self.middles.partition_point(|&m| m < z_mm - 1e-9);
        let limit = self.bottom(part.min(self.tops.len())) - gap_mm + 1e-6;
        self.tops.partition_point(|&t| t <= limit)
    }
}

/// The discs of every layer.
fn discs(
    forest: &Forest,
    contacts: &[Contact],
    heights: &Heights,
    clearance: &Clearance,
    settings: &SupportSettings,
) -> Vec<Vec<Disc>> {
    let mut out: Vec<Vec<Disc>> = vec![Vec::new(); heights.tops.len()];
    let slope = tan(settings.branch_angle_rad);
    for (upper, lower) in forest.branches() {
        let tip = match upper.kind {
            Kind::Contact(i) => Some(&contacts[i as usize]),
            _ => None,
        };
        let first = heights.middles.partition_point(|&m| m < lower.at.z);
        let end = match tip {
            Some(c) => heights.end_below(c.at.z, settings.z_gap_mm),
            None => heights.middles.partition_point(|&m| m < upper.at.z),
        };
        let n_interface = if tip.is_some() { settings.interface_layers } else { 0 };
        let at = |z: f64| {
            let share = (z - lower.at.z) / (upper.at.z - lower.at.z).max(1e-9);
            lower.at.lerp(upper.at, share.clamp(0.0, 1.0))
        };
        let is_tip = tip.is_some() && !upper.post;
        let thickest_mm = |k: usize| {
            let at = at(heights.middles[k]).with_z(heights.middles[k]);
            if is_tip { f64::INFINITY } else { settings.thickest_mm(clearance, at) }
        };
        // Where the part is near, the branch is made thinner first, so that less has to be cut off.
        let mut radii: Vec<f64> = (first..end)
            .map(|k| upper.radius_at_mm(lower, heights.middles[k], slope).min(thickest_mm(k)))
            .collect();
        // Where the part makes a branch thinner, its flank slopes by no more than a branch may lean.
        for i in 1..radii.len() {
            radii[i] = radii[i].min(radii[i - 1] + slope * heights.height_mm(first + i));
        }
        for i in (1..radii.len()).rev() {
            radii[i - 1] = radii[i - 1].min(radii[i] + slope * heights.height_mm(first + i));
        }
        for (k, mut radius_mm) in (first..end).zip(radii) {
            let z = heights.middles[k];
            if lower.kind == Kind::Foot && z < settings.base_height_mm {
                let share = 1.0 - z / settings.base_height_mm;
                radius_mm += share * (settings.base_radius_mm - radius_mm).max(0.0);
            }
            let interface = k + n_interface >= end;
            if n_interface > 0 {
                let below = (end.saturating_sub(n_interface)).min(end - 1);
                let flare = settings.interface_radius_mm - (heights.tops[below] - z).max(0.0) * slope;
                radius_mm = radius_mm.max(flare);
            }
            let at = at(z);
            let trim = if tip.is_some() || upper.post {
                Trim::AtPart
            } else {
                let free_mm = clearance.distance_mm(at.with_z(z)) - settings.xy_gap_mm;
                radius_mm = radius_mm.min(thickest_mm(k));
                if free_mm > radius_mm + FAR_MM { Trim::Nothing } else { Trim::AtGap }
            };
            out[k].push(Disc { at: at.truncate(), radius_mm, trim, interface });
        }
    }
    out
}

fn circle(at: DVec2, radius_mm: f64) -> Contour {
    let half = acos((1.0 - CHORD_MM / radius_mm.max(2.0 * CHORD_MM)).clamp(-1.0, 1.0));
    let n = ((std::f64::consts::PI / half).ceil() as usize).clamp(10, 64);
    (0..n).map(|i| at + direction(i as f64 / n as f64 * std::f64::consts::TAU) * radius_mm).collect()
}

fn union_of(discs: impl Iterator<Item = Disc>) -> Region {
    let contours: Vec<Contour> = discs.map(|d| circle(d.at, d.radius_mm)).collect();
    if contours.is_empty() { Region::default() } else { Region::from_contours(&contours, FillRule::NonZero) }
}

fn layer(
    discs: &[Disc],
    k: usize,
    stack: &LayerStack,
    heights: &Heights,
    settings: &SupportSettings,
) -> SupportLayer {
    let discs_with = |trim: Trim| discs.iter().copied().filter(move |d| d.trim == trim);
    let part = stack.layers()[k].region();
    // Squares around the discs: only the part's area inside them has to be processed.
    let windows = |trim: Trim, gap_mm: f64| {
        let squares = discs_with(trim).map(|d| square(d.at, d.radius_mm + 2.0 * gap_mm + 0.1));
        let windows: Vec<Contour> = squares.collect();
        Region::from_contours(&windows, FillRule::NonZero)
    };
    let mut region = union_of(discs_with(Trim::Nothing));
    if discs_with(Trim::AtGap).next().is_some() {
        let local = part.intersection(&windows(Trim::AtGap, settings.xy_gap_mm));
        let kept =
            union_of(discs_with(Trim::AtGap)).difference(&local.offset(settings.xy_gap_mm, Join::Round));
        region = region.union(&kept);
    }
    let mut interface = Region::default();
    if discs_with(Trim::AtPart).next().is_some() {
        let window = windows(Trim::AtPart, TOUCH_MM.value());
        let mut local = part.intersection(&window).offset(TOUCH_MM.value(), Join::Miter(2.0));
        // The discs must also stay clear of the part's layers above this one, within the removal gap.
        for other in within(heights, k, settings.z_gap_mm) {
            local = local.union(&stack.layers()[other].region().intersection(&window));
        }
        region = region.union(&union_of(discs_with(Trim::AtPart)).difference(&local));
        let pads = union_of(discs.iter().copied().filter(|d| d.interface));
        interface = pads.difference(&local);
    }
    if let Some(bed) = settings.bed {
        region = region.intersection(&Region::rectangle(bed.min, bed.max));
    }
    region.polygons.retain(|p| p.area_mm2() > CRUMB_MM2);
    let interface = if interface.is_empty() { interface } else { interface.intersection(&region) };
    SupportLayer { region, interface, islands: None }
}

/// The layers above `k` whose bottom is less than the gap above the top of layer `k`.
pub(super) fn within(heights: &Heights, k: usize, gap_mm: f64) -> impl Iterator<Item = usize> + '_ {
    let top = heights.tops[k];
    (k + 1..heights.tops.len()).take_while(move |&j| heights.bottom(j) < top + gap_mm - 1e-6)
}

fn square(at: DVec2, half_mm: f64) -> Contour {
    let h = half_mm;
    vec![at + DVec2::new(-h, -h), at + DVec2::new(h, -h), at + DVec2::new(h, h), at + DVec2::new(-h, h)]
}

/// Takes away, from the plate upwards, every piece that stands neither on the plate, nor on support, nor on the part.
pub(super) fn settle(out: &mut Layers, stack: &LayerStack, heights: &Heights, settings: &SupportSettings) {
    let rests = |k: usize| -> Vec<(bool, Vec<u32>)> {
        let region = &out.layers[k].region;
        let below = &out.layers[k - 1].region;
        let index = Boxes::new(below);
        let on = |p: &Polygon| {
            let on_support: Vec<u32> =
                index.meeting(p).filter(|&i| overlap(p, &below.polygons[i as usize])).collect();
            // Whether a piece rests on the part is tested only where no support is below it.
            let on_part = on_support.is_empty() && rests_on_part(p, k, stack, heights, settings);
            (on_part, on_support)
        };
        region.polygons.iter().map(on).collect()
    };
    let stands: Vec<Vec<(bool, Vec<u32>)>> =
        (0..out.layers.len()).into_par_iter().map(|k| if k == 0 { Vec::new() } else { rests(k) }).collect();
    let mut below: Vec<bool> = vec![true; out.layers.first().map_or(0, |l| l.region.polygons.len())];
    let mut drop: Vec<Vec<bool>> = vec![below.clone()];
    for (k, rows) in stands.iter().enumerate().skip(1) {
        let here: Vec<bool> = rows
            .iter()
            .enumerate()
            .map(|(i, (on_part, on))| {
                let held = on.iter().any(|&i| below[i as usize]);
                // A piece that stood on removed support may still rest on the part.
                let piece = &out.layers[k].region.polygons[i];
                *on_part || held || (!on.is_empty() && rests_on_part(piece, k, stack, heights, settings))
            })
            .collect();
        below = here.clone();
        drop.push(here);
    }
    for (layer, keep) in out.layers.iter_mut().zip(drop) {
        if keep.iter().all(|&k| k) {
            continue;
        }
        out.dropped += keep.iter().filter(|&&k| !k).count();
        let mut kept = keep.into_iter();
        layer.region.polygons.retain(|_| kept.next() == Some(true));
        layer.interface = layer.interface.intersection(&layer.region);
    }
    out.floating = count_floating(&out.layers, stack, settings);
}

/// Whether a piece of layer `k` lies on the part, across the removal gap.
fn rests_on_part(
    p: &Polygon,
    k: usize,
    stack: &LayerStack,
    heights: &Heights,
    settings: &SupportSettings,
) -> bool {
    heights
        .below(k, settings.z_gap_mm)
        .any(|j| Region::from(p.clone()).intersection(stack.layers()[j].region()).area_mm2() > 1e-4)
}

/// The number of pieces of support with nothing below them, counted independently from the finished layers.
pub fn count_floating(layers: &[SupportLayer], stack: &LayerStack, settings: &SupportSettings) -> usize {
    let heights = Heights::new(stack);
    let of_layer = |k: usize| {
        let below = &layers[k - 1].region;
        let index = Boxes::new(below);
        let stands = |p: &&Polygon| {
            index.meeting(p).any(|i| overlap(p, &below.polygons[i as usize]))
                || rests_on_part(p, k, stack, &heights, settings)
        };
        layers[k].region.polygons.iter().filter(|p| !stands(p)).count()
    };
    (1..layers.len()).into_par_iter().map(of_layer).collect::<Vec<_>>().into_iter().sum()
}

/// Whether two polygons share an area.
fn overlap(a: &Polygon, b: &Polygon) -> bool {
    if a.outer.iter().any(|&p| b.contains(p)) || b.outer.iter().any(|&p| a.contains(p)) {
        return true;
    }
    Region::from(a.clone()).intersection(&Region::from(b.clone())).area_mm2() > 1e-4
}

/// The polygons of a region, indexed by their bounding boxes.
struct Boxes {
    /// Low x, high x, low y, high y and index, by low x.
    rows: Vec<([f64; 4], u32)>,
    widest: f64,
}

impl Boxes {
    fn new(region: &Region) -> Self {
        let boxed =
            |(i, p): (usize, &Polygon)| p.bounds().map(|b| ([b.min.x, b.max.x, b.min.y, b.max.y], i as u32));
        let mut rows: Vec<_> = region.polygons.iter().enumerate().filter_map(boxed).collect();
        rows.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.1.cmp(&b.1)));
        let widest = rows.iter().map(|(b, _)| b[1] - b[0]).fold(0.0, f64::max);
        Self { rows, widest }
    }

    fn meeting(&self, p: &Polygon) -> impl Iterator<Item = u32> + '_ {
        let b = p.bounds();
        let (low, high) = b.map_or((0.0, -1.0), |b| (b.min.x - self.widest, b.max.x));
        let first = self.rows.partition_point(|r| r.0[0] < low);
        let rows = self.rows[first..].iter().take_while(move |r| r.0[0] <= high);
        rows.filter(move |(r, _)| b.is_some_and(|b| r[1] >= b.min.x && r[2] <= b.max.y && r[3] >= b.min.y))
            .map(|r| r.1)
    }
}

/// Whether one of the two topmost layers that belong below a contact has support there.
fn is_reached(c: &Contact, cut: &Layers, heights: &Heights, settings: &SupportSettings) -> bool {
    let end = heights.end_below(c.at.z, settings.z_gap_mm);
    let p = c.at.truncate();
    let reach = settings.contact_radius_mm;
    (end.saturating_sub(2)..end).any(|k| {
        let near = |q: &Polygon| q.contains(p) || q.outer.iter().any(|v| v.distance(p) <= reach);
        cut.layers[k].region.polygons.iter().any(near)
    })
}
