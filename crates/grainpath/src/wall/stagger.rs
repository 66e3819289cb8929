//! Staggered walls: every other wall stands half a layer higher than its neighbours, as bricks do.
//!
//! The joints between the layers of a raised wall then lie at half the height of its neighbours' beads, and a crack that
//! runs between two layers has to climb at each wall. The outermost wall stays level, for the part's look and size; the
//! second, fourth and so on from outside are raised:
//!
//! ```text
//!     top of the part ─────────────
//!              │   ├───┤   │           raised walls end with half a layer
//!              ├───┤ 2 ├───┤
//!              │ 1 ├───┤ 3 │
//!              ├───┤ 2 ├───┤
//!              │ 1 │   │ 3 │           and begin with one and a half
//!     plate    ────┴───┴────
//! ```
//!
//! *Where.* A joint lies between a closed wall and the wall on top of it. To raise a joint, the lower wall grows by half of
//! the next layer's height, and the upper wall begins that much higher. A joint is raised if both are closed walls with the
//! same place in the order from outside, their centrelines lie on each other to within `APART`, and the lower wall lies on
//! the section below it. Every other joint stays level, so where a wall begins, ends, leans or changes, its column begins
//! and ends level. No bead lies on air or overlaps another, since both sides of a joint move alike.
//!
//! *Volume.* A bead fills its strip over its own height, so a staggered column of walls has the same volume as a level one.
//!
//! Units: mm. Cost: one comparison of each wall with those of the next layer, about linear in the points.

use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{BeadWidth, Bounds2, DVec2, Layer, Toolpath, segment};
use rayon::prelude::*;

use super::Wall;

/// How far the centrelines of two walls may lie apart for one to stand on the other half a layer higher, as a share of
/// their strip. Source: derived. Half of a bead's height then lies off its strip by a twentieth at most: 2.5 % of the bead
/// overlaps its neighbour, and a gap of the same size opens on the other side.
const APART: f64 = 0.05;
/// Step to which heights are rounded, mm. Source: z has three decimals in the G-code.
const STEP_MM: f64 = 1e-3;

/// A joint to raise: the walls below and above it, each by its island and its number there.
struct Joint {
    below: (usize, usize),
    above: (usize, usize),
}

/// Raises the joints of walls in consecutive layers, as described for this module. `walls` holds the walls of the islands
/// of each layer and `sections` holds these layers. `lower` is the section below the first one; `None` on the plate.
pub(crate) fn stagger(
    walls: &mut [Vec<&mut [Wall]>],
    sections: &[Layer],
    lower: Option<&Layer>,
    bead_mm: f64,
) {
    let joints: Vec<Vec<Joint>> = (0..walls.len().saturating_sub(1))
        .into_par_iter()
        .map(|k| {
            let under = if k > 0 { sections.get(k - 1) } else { lower };
            joints(&walls[k], &walls[k + 1], under, [&sections[k], &sections[k + 1]], bead_mm)
        })
        .collect();
    for (k, joints) in joints.into_iter().enumerate() {
        // Both sides of a joint move by the same height, so nothing opens and nothing overlaps.
        let raise_mm = half_mm(&sections[k + 1]);
        for Joint { below, above } in joints {
            walls[k][below.0][below.1].path.raise.top_mm = raise_mm;
            walls[k + 1][above.0][above.1].path.raise.bottom_mm = raise_mm;
        }
    }
    for (layer, section) in walls.iter_mut().zip(sections) {
        let h = section.height_mm();
        for wall in layer.iter_mut().flat_map(|island| island.iter_mut()) {
            let own_mm = wall.path.height_mm(h);
            if let BeadWidth::Constant(width) = &mut wall.path.width
                && (own_mm - h).abs() > 0.5 * STEP_MM
            {
                // The strip stays, so the width follows from the height.
                *width = bead_width_mm(bead_spacing_mm(*width, h), own_mm);
            }
        }
    }
}

/// Half of a layer's height, mm.
fn half_mm(layer: &Layer) -> f64 {
    (0.5 * layer.height_mm() / STEP_MM).round() * STEP_MM
}

/// The joints between two layers that can be raised.
fn joints(
    lower: &[&mut [Wall]],
    upper: &[&mut [Wall]],
    under: Option<&Layer>,
    layers: [&Layer; 2],
    bead_mm: f64,
) -> Vec<Joint> {
    // The first bead of a raised column is the highest; a bead has to be as wide as it is high.
    if layers[0].height_mm() + half_mm(layers[1]) > bead_mm {
        return Vec::new();
    }
    let mut out = Vec::new();
    let apart_mm = APART * bead_spacing_mm(bead_mm, layers[0].height_mm());
    let numbered = |walls: &[&mut [Wall]]| -> Vec<((usize, usize), Bounds2)> {
        let all = walls.iter().enumerate().flat_map(|(i, island)| {
            let own = island.iter().enumerate().filter(|(_, w)| may_rise(w));
            own.filter_map(move |(j, w)| {
                Some(((i, j), Bounds2::around_points(w.path.points.iter().copied())?))
            })
            .collect::<Vec<_>>()
        });
        all.collect()
    };
    // Neighbouring walls lie a strip apart, so at most one wall above is near enough.
    let above = numbered(upper);
    for (a, bounds) in numbered(lower) {
        let wall = &lower[a.0][a.1];
        let near = |other: &Bounds2| {
            let off = (other.min - bounds.min).abs().max((other.max - bounds.max).abs());
            off.max_element() <= apart_mm
        };
        let on_it = |(b, other): &((usize, usize), Bounds2)| {
            let upper = &upper[b.0][b.1];
            near(other)
                && upper.depth == wall.depth
                && lies_on(&wall.path, &upper.path, apart_mm)
                && lies_on(&upper.path, &wall.path, apart_mm)
        };
        // Where the lower wall overhangs, its bead would sag more, because it is one and a half times as high.
        let held = || under.is_none_or(|l| wall.path.points.iter().all(|p| l.region().contains(*p)));
        if let Some((b, _)) = above.iter().find(|b| on_it(b))
            && held()
        {
            out.push(Joint { below: a, above: *b });
        }
    }
    out
}

/// Whether a wall is one of those that rise: every other one, and not the outermost.
fn may_rise(wall: &Wall) -> bool {
    wall.depth % 2 == 1 && wall.path.closed && matches!(wall.path.width, BeadWidth::Constant(_))
}

/// Whether every point of a closed path lies on another one.
fn lies_on(path: &Toolpath, other: &Toolpath, apart_mm: f64) -> bool {
    let n = other.points.len();
    let most = apart_mm * apart_mm;
    let near = |p: DVec2, k: usize| {
        segment::distance_squared_mm2(p, other.points[k], other.points[(k + 1) % n]) <= most
    };
    // Both paths mostly run alike, so the search goes on from where the last point was found.
    let mut at = 0;
    path.points.iter().all(|p| {
        let found = (0..n).map(|k| (at + k) % n).find(|&k| near(*p, k));
        at = found.unwrap_or(at);
        found.is_some()
    })
}
