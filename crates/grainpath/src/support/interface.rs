//! Interface below flat overhangs: single beads from contact to contact, so that no bead of the part runs far over air.
//!
//! A contact holds a point only, so a bead of the part may touch none: the skin under a table can run between two rows of
//! contacts from one edge to the other. So where the beads of a layer lie beyond those of the layer below (the overhang
//! leans by more than `flat_rad`), interface beads are laid along the rows of contacts, in x and in y. Contacts and rows
//! are 0.6 L apart there (L is `max_unsupported_mm`), and L/2 elsewhere. A bead of the part meets an interface bead every
//! 0.6 L, or every 0.85 L where it runs at 45 degrees to both. This method is our own; the paper on trees (`Shen2016`) has
//! points only.
//!
//! 1. [`lines`] finds rows of samples of the overhang: rows along the grid on which contacts are placed, and rows along
//!    the rim, where beads of the part turn back. Samples that are neighbours on the surface are joined to lines that
//!    follow it.
//! 2. [`lay`] cuts each line by layers and lays the beads, wherever the part leaves room for them.
//! 3. These beads need support themselves: [`super::held`] adds beads below them that step towards the nearest branch,
//!    layer by layer, so that each line becomes a thin wall with an arch below.
//!
//! Lengths are mm. Cost: linear in the samples. Limits: an overhang that is narrower than 0.3 L in plan has a contact
//! but no lines. Painted enforcers add samples between the points of the grid, which no line includes.

use std::collections::BTreeMap;

use grainpath_core::buckets::PointGrid3;
use grainpath_core::math::{atan2, sin, tan};
use grainpath_core::poly::simplify_line;
use grainpath_core::{DVec2, DVec3, LayerStack, Role, Toolpath};
use rayon::prelude::*;

use super::SupportSettings;
use super::contact::{Contact, ContactGrid, Sample};
use super::cut::Heights;

/// Largest distance in bead widths by which a layer's outline may lie beyond the one below while its wall still has support.
///
/// Source: the criterion by which beads of the part over air are measured. A program that replays the G-code calls a
/// point of a bead free where every bead below is more than 0.75 of the bead's width away in plan, and measures the
/// free stretches that are longer than L.
pub(super) const FREE_STEP_BEADS: f64 = 0.75;
/// Neighbouring samples belong to one surface if their heights differ by at most this share of their distance in plan.
///
/// Source: derived. A flat overhang leans by 60 degrees or more, so it climbs by 0.58 at most.
const CLIMB: f64 = 0.6;
/// The shortest line, as a share of L. Source: derived. Around an overhang of this length and width a bead runs for 1.2 L,
/// and the contact in the middle of the overhang lies below one of the bead's sides.
const SHORTEST_SHARE: f64 = 0.3;
/// Distance from a rim to the lines along it, as a share of L. Source: derived. Beads of the part that turn back at the rim
/// run over air for little more than twice this.
const SET_BACK_SHARE: f64 = 0.1;
/// The narrowest overhang that has lines along its rim, as a share of L. Source: derived. Twice [`SET_BACK_SHARE`] and the
/// least distance between two lines, 0.2 L. Across a narrower overhang a bead goes there and back within 0.8 L.
const RIM_SHARE: f64 = 0.4;
/// Corners of lines are cut by at most this share of a bead. Source: derived. The steps of the sample grid are smoothed
/// away, and a bead of the part still meets the line within a bead.
const SMOOTH_SHARE: f64 = 0.5;
/// A line that climbs has beads in several layers. Each is lengthened by this many bead widths to overlap the next.
///
/// Source: less than the reach of `held`, so that each bead holds the beginning of the next.
const OVERLAP_BEADS: f64 = 0.8;

/// Distance in plan, in bead widths, by which an added bead steps away from the bead that it is to hold. It is less than the
/// reach of `held`, because smoothing cuts the corners of the added line and moved points spread.
///
/// Source: the reach of `held` less the 0.05 mm by which neighbouring points may diverge when moved, in beads 0.45 mm wide.
pub(super) const WALK: f64 = 0.75;
/// Length of the piece at each end of a bead, mm, that does not hold an upper bead going on beyond the end.
///
/// Source: derived. Printed supports are judged at points of the lower beads; the last of them may lie 0.15 mm from the
/// end of a bead. A point is held if one of these is within 0.95 bead widths. In beads 0.45 mm wide, a reach of 0.86 of
/// the width and this length stay within 0.95 of the width and 0.15 mm.
pub(super) const END_MM: f64 = 0.11;

/// Spacing of interface lines and of the contacts below them, as a share of L. Source: derived. A point in the middle
/// of four contacts is 0.43 L from them, and a bead at 45 degrees runs over air for 0.85 L.
pub(super) const SPACING_SHARE: f64 = 0.6;
/// Lines are cut by layers at points this far apart, in bead widths. Source: derived. A bead then ends within a
/// twentieth of its width of where its layer ends, far less than [`OVERLAP_BEADS`].
const CUT_BEADS: f64 = 0.1;

/// The least lean from the vertical, radians, at which walls of a part hang over those below: a layer `height_mm`
/// thick then steps outwards by three quarters of a bead.
pub(crate) fn flat_rad(height_mm: f64, settings: &SupportSettings) -> f64 {
    atan2(FREE_STEP_BEADS * settings.beads.bead_width_mm, height_mm).max(settings.critical_angle_rad)
}

/// The largest distance in plan at which a wall lies on one below it, mm.
pub(super) fn step_mm(height_mm: f64, settings: &SupportSettings) -> f64 {
    (FREE_STEP_BEADS * settings.beads.bead_width_mm).max(height_mm * tan(settings.critical_angle_rad))
}

/// Whether interface lines run below a sample.
pub fn is_flat(sample: &Sample, stack: &LayerStack, settings: &SupportSettings) -> bool {
    -sample.normal.z > sin(flat_rad(usual_height_mm(stack, settings), settings))
}

/// Spacing of interface lines and of the contacts below them, mm. It is the largest at which no point of the overhang is
/// farther than 0.43 L from a contact, and no bead across the lines runs over air for more than 0.85 L.
pub fn spacing_mm(settings: &SupportSettings) -> f64 {
    SPACING_SHARE * settings.max_unsupported_mm
}

/// A sample of an overhang.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Number of the grid that the sample belongs to.
    pub group: u32,
    /// Its position, mm.
    pub at: DVec3,
    /// Whether interface lines run below it.
    pub is_flat: bool,
}

/// Lines on the undersides of flat overhangs. Points lie at multiples of `SupportSettings::sample_mm` in plan.
pub fn lines(
    points: &[Point],
    grids: &BTreeMap<u32, ContactGrid>,
    settings: &SupportSettings,
) -> Vec<Vec<DVec3>> {
    let mut groups: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
    points.iter().for_each(|p| groups.entry(p.group).or_default().push(*p));
    let groups: Vec<(ContactGrid, Vec<Point>)> = groups
        .into_iter()
        .filter(|(_, points)| points.iter().any(|p| p.is_flat))
        .map(|(g, points)| (grids[&g], points))
        .collect();
    let swap = |p: DVec3| DVec3::new(p.y, p.x, p.z);
    let of_group = |(grid, points): &(ContactGrid, Vec<Point>)| {
        let mut lines = rows(points, *grid, settings);
        let turned: Vec<Point> = points.iter().map(|p| Point { at: swap(p.at), ..*p }).collect();
        let across = rows(&turned, ContactGrid { low: swap(grid.low), ..*grid }, settings);
        lines.extend(across.into_iter().map(|line| line.into_iter().map(swap).collect()));
        lines
    };
    let lines: Vec<Vec<Vec<DVec3>>> = groups.par_iter().map(of_group).collect();
    lines.into_iter().flatten().collect()
}

/// Lengthens the tips below lines to the height of the arches that carry the lines. A tip under a flat overhang is upright,
/// so both sides of an arch can end on it. The branch below the tip leans, and one side would follow it far down.
pub(crate) fn lengthen_tips(
    contacts: &mut [Contact],
    lines: &[Vec<DVec3>],
    stack: &LayerStack,
    settings: &SupportSettings,
) {
    let reach_mm = 0.5 * spacing_mm(settings);
    let step_mm = (WALK * settings.beads.bead_width_mm - END_MM).max(0.05);
    let arch_mm = reach_mm / step_mm * usual_height_mm(stack, settings);
    let mut index = PointGrid3::new(reach_mm);
    lines.iter().flatten().for_each(|&p| index.insert(p, ()));
    for contact in contacts.iter_mut().filter(|c| index.within(c.at, reach_mm).next().is_some()) {
        contact.tip_mm = arch_mm;
    }
}

/// The height of the middle layer, which stands for most layers.
fn usual_height_mm(stack: &LayerStack, settings: &SupportSettings) -> f64 {
    let layers = stack.layers();
    layers.get(layers.len() / 2).map_or(settings.first_layer_mm, |l| l.height_mm())
}

/// Lines in x along the rows of points nearest to the middles of the grid's cells, and lines along the parts of the rim
/// that run more in y than in x.
fn rows(points: &[Point], grid: ContactGrid, settings: &SupportSettings) -> Vec<Vec<DVec3>> {
    let (pitch_mm, cell_mm) = (settings.sample_mm(), grid.cell_mm);
    let index = |v: f64| (v / pitch_mm).round() as i64;
    // The row of samples in the middle of the cell that contains `v`. The first row of a cell lies on its border. Of two
    // middle rows the lower one is taken, as for contacts.
    let middle_row = |v: f64, low: f64| {
        let cell = ((v - low) / cell_mm + 1e-9).floor();
        index(low + (cell + 0.5) * cell_mm - 0.5 * pitch_mm - 1e-9)
    };
    let mut surface = Surface { heights: BTreeMap::new(), climb_mm: CLIMB * pitch_mm };
    for Point { at: p, is_flat, .. } in points {
        let (i, j) = (index(p.x), index(p.y));
        if (DVec2::new(i as f64, j as f64) * pitch_mm).distance(p.truncate()) <= 1e-6 {
            surface.heights.entry((i, j)).or_default().push((p.z, *is_flat));
        }
    }
    surface.heights.values_mut().for_each(|z| z.sort_by(|a, b| a.0.total_cmp(&b.0)));
    let at = |i: i64, j: i64, z: f64| DVec3::new(i as f64 * pitch_mm, j as f64 * pitch_mm, z);
    let mut out = Vec::new();
    let stretches = surface.stretches();
    let shortest = SHORTEST_SHARE * settings.max_unsupported_mm / pitch_mm;
    for (&j, stretches) in
        stretches.iter().filter(|(j, _)| **j == middle_row(**j as f64 * pitch_mm, grid.low.y))
    {
        for stretch in stretches {
            for flat in flat_parts(stretch).filter(|flat| flat.len() as f64 >= shortest) {
                let (first, last) = (stretch[flat.start], stretch[flat.end - 1]);
                // A wall at the end of the flat part may still hang over the one below, so the line goes on to one more
                // sample. Where there is none, it goes on by a pitch: the overhang may end that far beyond its last sample.
                let before = flat
                    .start
                    .checked_sub(1)
                    .map_or((first.0 - 1, first.1), |i| (stretch[i].0, stretch[i].1));
                let behind = stretch.get(flat.end).map_or((last.0 + 1, last.1), |s| (s.0, s.1));
                let mut points = vec![at(before.0, j, before.1)];
                points.extend(stretch[flat].iter().map(|&(i, z, _)| at(i, j, z)));
                points.push(at(behind.0, j, behind.1));
                out.push(points);
            }
        }
    }
    let flat_rows = |stretches: &Vec<Stretch>| -> Vec<Stretch> {
        stretches.iter().flat_map(|s| flat_parts(s).map(|flat| s[flat].to_vec())).collect()
    };
    let flat_rows = stretches.iter().map(|(j, stretches)| (*j, flat_rows(stretches))).collect();
    let rim = surface.rim(&flat_rows, settings);
    out.extend(rim.into_iter().map(|line| line.into_iter().map(|(i, j, z)| at(i, j, z)).collect()));
    out
}

/// The flat parts of a stretch.
fn flat_parts(stretch: &[(i64, f64, bool)]) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
    let mut end = 0;
    stretch.chunk_by(|a, b| a.2 == b.2).filter_map(move |part| {
        end += part.len();
        part[0].2.then(|| end - part.len()..end)
    })
}

/// The samples of an overhang by their place on the grid; surfaces may lie above each other.
struct Surface {
    heights: BTreeMap<(i64, i64), Vec<(f64, bool)>>,
    /// Largest difference in height between neighbouring samples of one surface, mm.
    climb_mm: f64,
}

/// Neighbouring samples of a row on one surface: place in the row, height, and whether the surface is flat there.
type Stretch = Vec<(i64, f64, bool)>;

impl Surface {
    /// The stretches of each row. Where surfaces lie above each other, each has its own stretches.
    fn stretches(&self) -> BTreeMap<i64, Vec<Stretch>> {
        let mut rows: BTreeMap<i64, Vec<Stretch>> = BTreeMap::new();
        for (&(i, j), heights) in &self.heights {
            let stretches = rows.entry(j).or_default();
            for &(z, is_flat) in heights {
                // Samples at the end of a flat part are not flat and may climb twice as much.
                let climbs =
                    |other_is_flat: bool| if is_flat && other_is_flat { 1.0 } else { 2.0 } * self.climb_mm;
                let follows = |stretch: &&mut Stretch| {
                    let last = stretch.last();
                    last.is_some_and(|&(h, y, flat)| h + 1 == i && (z - y).abs() <= climbs(flat))
                };
                match stretches.iter_mut().find(follows) {
                    Some(stretch) => stretch.push((i, z, is_flat)),
                    None => stretches.push(vec![(i, z, is_flat)]),
                }
            }
        }
        rows
    }

    /// Lines a little inside the rim, wherever the rim runs at less than 45 degrees to y. They join samples near the ends
    /// of the rows, from row to row.
    fn rim(
        &self,
        rows: &BTreeMap<i64, Vec<Stretch>>,
        settings: &SupportSettings,
    ) -> Vec<Vec<(i64, i64, f64)>> {
        let pitch_mm = settings.sample_mm();
        let samples = |share: f64| (share * settings.max_unsupported_mm / pitch_mm).round() as usize;
        let (set_back, widest) = (samples(SET_BACK_SHARE), samples(RIM_SHARE));
        let mut out: Vec<Vec<(i64, i64, f64)>> = Vec::new();
        for side in [false, true] {
            let mut lines: Vec<Vec<(i64, i64, f64)>> = Vec::new();
            for (&j, stretches) in rows {
                for stretch in stretches.iter().filter(|stretch| stretch.len() >= widest) {
                    let (i, z, _) =
                        if side { stretch[stretch.len() - 1 - set_back] } else { stretch[set_back] };
                    let follows = |line: &&mut Vec<(i64, i64, f64)>| {
                        line.last().is_some_and(|&(h, g, y)| {
                            g + 1 == j && (h - i).abs() <= 1 && (z - y).abs() <= 2.0 * self.climb_mm
                        })
                    };
                    match lines.iter_mut().find(follows) {
                        Some(line) => line.push((i, j, z)),
                        None => lines.push(vec![(i, j, z)]),
                    }
                }
            }
            out.extend(lines);
        }
        out.retain(|line| line.len() >= samples(SHORTEST_SHARE));
        out
    }
}

/// The interface beads of every layer below the lines.
pub fn lay(
    lines: &[Vec<DVec3>],
    heights: &Heights,
    n_layers: usize,
    settings: &SupportSettings,
) -> Vec<Vec<Toolpath>> {
    let width_mm = settings.beads.bead_width_mm;
    let overlap_mm = OVERLAP_BEADS * width_mm;
    let step_mm = CUT_BEADS * width_mm;
    let mut out: Vec<Vec<Toolpath>> = vec![Vec::new(); n_layers];
    for line in lines {
        let mut pieces: Vec<(usize, Vec<DVec2>)> = Vec::new();
        for pair in line.windows(2) {
            let n = ((pair[0].distance(pair[1]) / step_mm).ceil() as usize).max(1);
            for p in (0..=n).map(|i| pair[0].lerp(pair[1], i as f64 / n as f64)) {
                let end = heights.end_below(p.z, settings.z_gap_mm);
                match pieces.last_mut() {
                    Some((e, points)) if *e == end => points.push(p.truncate()),
                    _ => pieces.push((end, vec![p.truncate()])),
                }
            }
        }
        let n_pieces = pieces.len();
        for (i, (end, mut points)) in pieces.into_iter().enumerate() {
            if end == 0 {
                continue;
            }
            let n = points.len();
            let (first, last) = (points[0], points[n - 1]);
            let start = (points[1.min(n - 1)] - first).normalize_or_zero();
            let end_way = (last - points[n.saturating_sub(2)]).normalize_or_zero();
            if i > 0 {
                points.insert(0, first - start * overlap_mm);
            }
            if i + 1 < n_pieces {
                points.push(last + end_way * overlap_mm);
            }
            let points = simplify_line(&points, SMOOTH_SHARE * width_mm);
            if points.len() > 1 {
                out[end - 1].push(Toolpath::new(points, width_mm, Role::SupportInterface, false));
            }
        }
    }
    out
}
