//! Walls: closed beads along the section's contours, and single beads where a pair of walls does
//! not fit.
//!
//! Beads are laid as strips: a bead of width `w` in a layer of height `h` fills a strip of `s =
//! bead_spacing_mm(w, h)`, and neighbouring strips touch without overlap. The outermost bead is the
//! exception: its full width touches the contour, so that the part has its size. Where the part, or
//! the area inside a wall, is too thin for a loop, both sides of the loop would lie on each other.
//! There the loop is left out and one bead of varying width runs along the medial axis instead,
//! with the volume of the area it fills. Where what remains between the two sides of the innermost
//! loop is too narrow for such a bead, both sides become a little wider (`facing`).
//!
//! Lengths are in mm. Cost: one polygon offset a wall where the polygon shrinks smoothly, about six
//! otherwise.
//!
#![doc = include_str!("figures/walls.svg")]

pub mod adhesion;
pub mod divided;
mod facing;
pub mod graded_walls;
pub mod skin;
pub mod stagger;

use grainpath_core::math::{atan2, cross, tan};
use grainpath_core::medial::medial_axis;
use grainpath_core::poly::{Join, edges};
use grainpath_core::units::{self, bead_spacing_mm};
use grainpath_core::{BeadWidth, Polygon, Region, Role, Toolpath};

/// Settings of the walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallSettings {
    /// Number of walls; 0 for none.
    pub n_walls: usize,
    /// Full width of a bead, mm.
    pub bead_width_mm: f64,
    /// Height of the layer, mm.
    pub height_mm: f64,
    /// Whether places thinner than two walls get one bead of varying width.
    pub thin_walls: bool,
    /// Whether gaps between walls, and between walls and fill, get one bead of varying width.
    pub gap_fill: bool,
    /// The narrowest bead laid, mm.
    pub min_bead_width_mm: f64,
    /// Overlap of the fill with the innermost wall, as a share of the spacing.
    pub fill_overlap: f64,
}

/// One closed wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// The closed path.
    pub path: Toolpath,
    /// Place of the wall counted inwards; 0 for the outermost.
    pub depth: usize,
}

/// The walls of one polygon of a section, and the area for its fill.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walls {
    /// Closed walls, from the outermost inwards.
    pub loops: Vec<Wall>,
    /// Single beads in thin places.
    pub singles: Vec<Toolpath>,
    /// Area for the centrelines of the fill.
    pub fill: Region,
}

/// Corners of offsets stay sharp. A tip farther from its corner than this many times the offset is cut off.
pub(crate) const MITER: Join = Join::Miter(3.0);
/// Share of their spacing by which the two sides of a wall may come closer before one bead replaces
/// the loop.
const MAX_SQUEEZE: f64 = 0.15;
/// Gaps smaller than this are not filled, mm2. Source: derived. A bead 0.4 mm wide covers as much in 0.025 mm of its
/// length, which is less than a nozzle can start and stop in.
const MIN_GAP_MM2: f64 = 0.01;
/// Shorter loops are left out, mm. Source: derived. Such a loop is shorter than the bead of 0.4 mm is wide.
const MIN_LOOP_MM: f64 = 0.3;

/// Distance that the outermost wall keeps from its exact position, mm. Source: derived. About half the last
/// digit of the coordinates written, so that rounding does not move it outside.
const ROUNDING_MM: f64 = 3e-4;

/// Lays the walls of one polygon.
pub fn lay_walls(polygon: &Polygon, settings: &WallSettings) -> Walls {
    let s = bead_spacing_mm(settings.bead_width_mm, settings.height_mm);
    let w = settings.bead_width_mm;
    let region = Region::from(polygon.clone());
    let depth_mm = |k: usize| 0.5 * w + k as f64 * s;
    let fill_depth =
        if settings.n_walls == 0 { 0.5 * w } else { depth_mm(settings.n_walls) - settings.fill_overlap * s };
    let fill = region.offset(-fill_depth, MITER);
    // The common case: nothing is too thin, and each wall is a single offset of the polygon.
    if shrinks_smoothly(polygon, &fill, fill_depth) {
        let mut walls = Walls { fill, ..Walls::default() };
        for k in 0..settings.n_walls {
            let guard = if k == 0 { ROUNDING_MM } else { 0.0 };
            push_loops(&mut walls.loops, &region.offset(-depth_mm(k) - guard, MITER), k, w);
        }
        return walls;
    }
    let mut walls = lay_crowded_walls(region, settings, s);
    if settings.gap_fill {
        // More space than this gets a bead or infill of its own.
        let narrowest = bead_spacing_mm(settings.min_bead_width_mm, settings.height_mm);
        let most = narrowest.min((1.0 - MAX_SQUEEZE) * s);
        // Both sides become narrower by half of what they overlap, and no bead is narrower than the job allows.
        let least = (-MAX_SQUEEZE * s).max(2.0 * (narrowest - s)).min(0.0);
        let mut loops: Vec<_> = walls.loops.iter_mut().map(|w| (w.depth, &mut w.path)).collect();
        facing::share_the_space(&mut loops, s, settings.height_mm, (least, most));
    }
    walls
}

/// Whether a polygon keeps its shape when shrunk by `d_mm` to `inset`: no hole, neck or tail was
/// swallowed. Then the area lost follows from perimeter and corners alone (Steiner's formula for
/// sharp corners).
pub(crate) fn shrinks_smoothly(polygon: &Polygon, inset: &Region, d_mm: f64) -> bool {
    let [only] = inset.polygons.as_slice() else { return false };
    // A hole that vanished or merged with the outline shows in the number of contours; a neck that
    // closed shows in the area.
    if only.holes.len() != polygon.holes.len() {
        return false;
    }
    let area = polygon.area_mm2();
    let corners: f64 = polygon.contours().map(|c| corner_sum(c)).sum();
    let predicted = area - d_mm * polygon.perimeter_mm() + d_mm * d_mm * corners;
    (predicted - only.area_mm2()).abs() < 0.02 + 5e-4 * area
}

/// Sum of tan(turn / 2) over the corners of a closed line. A turn beyond 154 degrees counts as one
/// of 126 degrees, which is about where the mitre limit cuts a tip off.
fn corner_sum(contour: &[grainpath_core::DVec2]) -> f64 {
    let mut previous = None;
    let mut first = None;
    let mut sum = 0.0;
    let mut corner = |u: grainpath_core::DVec2, v: grainpath_core::DVec2| {
        let (c, d) = (cross(u, v), u.dot(v));
        let scale = (u.length_squared() * v.length_squared()).sqrt();
        // tan(turn/2) = sin / (1 + cos)
        // Close to a full reversal the quotient divides two small numbers.
        let denominator = scale + d;
        sum +=
            if denominator > 0.1 * scale { c / denominator } else { tan(0.5 * atan2(c, d).clamp(-2.2, 2.2)) };
    };
    for (a, b) in edges(contour) {
        let edge = b - a;
        if edge.length_squared() == 0.0 {
            continue;
        }
        if let Some(u) = previous {
            corner(u, edge);
        } else {
            first = Some(edge);
        }
        previous = Some(edge);
    }
    if let (Some(u), Some(v)) = (previous, first) {
        corner(u, v);
    }
    sum
}

/// Lays the walls of a polygon that is too thin for them in places, one wall after the other. Where a
/// wall does not fit, single beads are laid.
fn lay_crowded_walls(region: Region, settings: &WallSettings, s: f64) -> Walls {
    let (w, h) = (settings.bead_width_mm, settings.height_mm);
    let mut walls = Walls::default();
    // The area still to be filled; its border is the edge of the strips laid so far.
    let mut rest = region;
    for k in 0..settings.n_walls {
        // The outermost bead shows its full width; the strip of every other one touches its neighbour's.
        let half = if k == 0 { 0.5 * w } else { 0.5 * s };
        let squeeze = 0.5 * s * (1.0 - MAX_SQUEEZE);
        // The area is shrunk farther than the wall needs and grown back. Places too thin for both
        // sides of the loop vanish for good; all others return to the wall's centreline.
        let centre = rest.offset(-(half + squeeze), MITER).offset(squeeze, MITER);
        if (k == 0 && settings.thin_walls) || (k > 0 && settings.gap_fill) {
            // The single beads get the area that the strips of this wall do not reach.
            let left = rest.difference(&centre.offset(half, MITER));
            lay_singles(&left, settings, k == 0, h, &mut walls.singles);
        }
        if k == 0 {
            push_loops(&mut walls.loops, &centre.offset(-ROUNDING_MM, MITER), k, w);
        } else {
            push_loops(&mut walls.loops, &centre, k, w);
        }
        rest = centre.offset(-0.5 * s, MITER);
        if rest.is_empty() {
            return walls;
        }
    }
    let half = if settings.n_walls == 0 { 0.5 * w } else { 0.5 * s };
    // Places up to 15 % narrower than one strip still get fill. The same share holds for walls.
    let least = half * (1.0 - MAX_SQUEEZE);
    let core = rest.offset(-least, MITER);
    if settings.gap_fill && settings.n_walls > 0 {
        let left = rest.difference(&core.offset(least, MITER));
        lay_singles(&left, settings, false, h, &mut walls.singles);
    }
    let kept = core.offset(least, MITER);
    let inset = if settings.n_walls == 0 { half } else { half - settings.fill_overlap * s };
    walls.fill = kept.offset(-inset, MITER);
    walls
}

fn push_loops(loops: &mut Vec<Wall>, centre: &Region, depth: usize, width_mm: f64) {
    let role = if depth == 0 { Role::OuterWall } else { Role::InnerWall };
    for contour in centre.contours() {
        let path = Toolpath::new(contour.clone(), width_mm, role, true);
        if path.length_mm() > MIN_LOOP_MM {
            loops.push(Wall { path, depth });
        }
    }
}

fn lay_singles(left: &Region, settings: &WallSettings, outer: bool, h: f64, out: &mut Vec<Toolpath>) {
    let role = if outer { Role::ThinWall } else { Role::GapFill };
    single_beads(left, settings.bead_width_mm, settings.min_bead_width_mm, h, role, out);
}

/// The widest place that a single bead fills, mm: as wide as a bead and the strip of another.
pub(crate) fn widest_single_mm(bead_width_mm: f64, height_mm: f64) -> f64 {
    bead_width_mm + bead_spacing_mm(bead_width_mm, height_mm)
}

/// One bead along the middle of each leftover that is thinner than two beads. Where the leftover is
/// the part itself ([`Role::ThinWall`]), the bead is as wide as the part is thick. Between strips,
/// the strip of the bead is as wide as the gap.
pub(crate) fn single_beads(
    left: &Region,
    bead_width_mm: f64,
    min_bead_width_mm: f64,
    height_mm: f64,
    role: Role,
    out: &mut Vec<Toolpath>,
) {
    let h = height_mm;
    let outer = role == Role::ThinWall;
    let keep = |p: &&Polygon| p.area_mm2() > MIN_GAP_MM2;
    let left = Region { polygons: left.polygons.iter().filter(keep).cloned().collect() };
    if left.is_empty() {
        return;
    }
    let max_mm = widest_single_mm(bead_width_mm, h);
    let min_mm = if outer { min_bead_width_mm } else { bead_spacing_mm(min_bead_width_mm, h) };
    for axis in medial_axis(&left, min_mm, max_mm) {
        let width = |t: &f64| if outer { *t } else { units::bead_width_mm(*t, h) };
        let widths: Vec<f64> = axis.widths_mm.iter().map(width).collect();
        let width = BeadWidth::PerVertex(widths);
        out.push(Toolpath { width, ..Toolpath::new(axis.points, bead_width_mm, role, axis.closed) });
    }
}
