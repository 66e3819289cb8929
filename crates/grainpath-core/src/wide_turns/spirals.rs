//! Rings in what long paths leave of the area.
//!
//! Where lines are too short even with turns, as beside the neutral line of a bent hook, closed rings a spacing inside each
//! other are long enough, or become so as a spiral, with one long side each along the lines beside them:
//!
//! ```text
//!    ================        ================
//!      | | | | | | |           /----------\
//!      | | | | | | |           | /------\ |
//!      | | | | | | |           | \------/ |
//!      | | | | | | |           \----------/
//!    ================        ================
//! ```
//!
//! The outlines of the rest are opened by the least radius, so that rings have no turn below it. A ring ends up in a long path
//! or is given up. In the middle of the innermost ring, and where no ring is, loops with sharp turns take the place of the lines
//! where they fill more; cut at these turns, they go on in long paths too, or are laid otherwise.

use super::hang::hung;
use super::surroundings::{HAIRPIN_COS, Obstacles, Path, Place, whole};
use crate::DVec2;
use crate::poly::{Contour, FillRule, Join, LineClipper, Region, simplify_line};
use crate::polyline::{length_mm, resampled, shorten_start};
use crate::segments::Segments;
use crate::turns::{rounded, sharp_turns};

/// Rings lie this far from long paths, in spacings. Source: as `CLOSER` of the turns.
const APART: f64 = 0.98;
/// Rings lie this near to the lines whose place they take, in spacings, since what a fill leaves empty stays so. Source: chosen; beside the
/// last line one more may lie, where a long path does not.
const WITHIN: f64 = 1.0;
/// Rings cross gaps between such lines that are up to twice this wider than a spacing, in spacings. Source: measured on one
/// layer of `hook-wide` of `grainpath new continuous` before loops were laid: with 0.5, 1, 2 and 3 it has 1.99, 2.07, 2.07 and 2.15 m of
/// fibre, and 2.15 where rings may lie anywhere.
const BETWEEN: f64 = 3.0;
/// Lines go where they are nearer to a ring than this, in spacings. Source: chosen; at a tenth of a spacing overlap neighbours of
/// the ring stay whole, although their distance varies.
const KEPT: f64 = 0.9;
/// Lines go in any case where they are nearer to a long path than this, in spacings. Source: chosen; there is no room for half a
/// bead.
const UNDER: f64 = 0.6;
/// The line that a ring is compared with is the nearest within this distance, in spacings. Source: chosen; lines farther away tell
/// nothing of the direction there.
const BESIDE: f64 = 2.0;
/// A ring is laid if at least this share of it follows the lines, within 25 degrees. Source: measured as [`MORE`]: the rings
/// beside a neutral line and in the tip of the hook have 0.67 to 0.91, those in corners, where lines of two directions meet, 0.12 to 0.60.
/// Without this the slanted rectangle has 0.6 m more fibre in three layers, of which nothing lies along the load.
const LEAST_ALONG: f64 = 0.55;
/// Loops take the place of lines where they fill more than this multiple of what the lines fill. Source: measured on one layer each of
/// seven parts (hook, hook turned by 37 degrees, plate with a hole, ring, bracket, angle and slanted rectangle, all pulled): with 1, 1.1 and
/// 1.25 they have 24.54, 24.58 and 24.58 m of fibre and leave 8.9, 8.5 and 8.6 % open, in the mean, with all rings laid.
const MORE: f64 = 1.1;
/// Outlines are opened by this multiple of the least radius. Source: measured as [`MORE`], with [`KEPT_WIDER`] 0.03 less: with
/// 1.03, 1.04 and 1.06 there are 24.57, 24.75 and 24.58 m of fibre; with less, arcs are cut where their chords make the radius measure smaller.
const WIDER: f64 = 1.04;
/// Corners of rings are rounded by this multiple of the least radius, which a ring keeps as measured. Source: as [`WIDER`].
const KEPT_WIDER: f64 = 1.01;
/// Vertices of outlines nearer than this to the line without them are left out, mm. Source: derived; an arc of 2 mm radius then has
/// chords of 0.4 mm, whose ends G-code rounds to 0.001 mm, which tells its radius to 2 %.
const STRAIGHT_MM: f64 = 0.01;

/// Replaces short lines by rings where these become parts of long paths.
pub(super) fn ringed(paths: Vec<Path>, place: &Place<'_>) -> Vec<Path> {
    let spacing_mm = place.spacing_mm;
    let is_long = |(points, closed): &Path| length_mm(points, *closed) >= place.needed_mm;
    let (mut long, short): (Vec<Path>, Vec<Path>) = paths.into_iter().partition(is_long);
    if short.is_empty() {
        return long;
    }
    let there = around(&short, (WITHIN + BETWEEN) * spacing_mm).offset(-BETWEEN * spacing_mm, Join::Round);
    let there = place.region.intersection(&there);
    // Nothing but what lies in or beside that area matters.
    let near = LineClipper::new(&there.offset(2.0 * spacing_mm, Join::Round));
    let around_near = |paths: &[Path], half_mm: f64| {
        let pieces = paths.iter().flat_map(|path| near.clip(&whole(path)));
        around(&pieces.map(|piece| (piece.points, false)).collect::<Vec<_>>(), half_mm)
    };
    let mut rings = rings(&there.difference(&around_near(&long, APART * spacing_mm)), place);
    let lines = Obstacles::new(short.iter().map(whole), 2.0 * spacing_mm);
    rings.retain(|ring| follows(ring, &lines.segments, place));
    if rings.is_empty() {
        long.extend(short);
        return long;
    }
    let beside = around_near(&long, KEPT * spacing_mm);
    long.extend(rings.into_iter().map(|ring| (ring, true)));
    let (mut out, left): (Vec<Path>, Vec<Path>) = hung(long, place).into_iter().partition(is_long);
    // Lines that have always been near a long path stay, unless they come to lie under one.
    let under = around_near(&out, KEPT * spacing_mm)
        .difference(&beside)
        .union(&around_near(&out, UNDER * spacing_mm));
    let clipper = LineClipper::new(&place.region.difference(&under));
    // A ring that is still closed and short did not become part of a path.
    let mut lines: Vec<Vec<DVec2>> = left.into_iter().filter(|path| !path.1).map(|path| path.0).collect();
    let pieces = short.iter().flat_map(|path| clipper.clip(&whole(path))).map(|piece| piece.points);
    lines.extend(pieces.filter(|piece| length_mm(piece, false) > spacing_mm));
    let free = there.difference(&around_near(&out, APART * spacing_mm));
    out.extend(filled(&free, lines, place).into_iter().map(|line| (line, false)));
    hung(out, place)
}

/// Whether a ring follows the lines whose place it takes: across them it would carry nothing.
fn follows(ring: &Contour, lines: &Segments, place: &Place<'_>) -> bool {
    let points = resampled(&whole(&(ring.clone(), true)), false, place.spacing_mm);
    let (mut along, mut all) = (0, 0);
    for w in points.windows(2) {
        let beside = lines.within(w[0].midpoint(w[1]), BESIDE * place.spacing_mm);
        let Some((nearest, _)) = beside.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))) else {
            continue;
        };
        let [a, b] = lines.ends(nearest);
        let (u, v) = ((w[1] - w[0]).normalize_or_zero(), (b - a).normalize_or_zero());
        all += 1;
        along += usize::from(u.dot(v).abs() >= HAIRPIN_COS);
    }
    along as f64 >= LEAST_ALONG * all as f64
}

/// Lines, or loops instead of them in those parts of a region that loops fill better.
fn filled(region: &Region, lines: Vec<Vec<DVec2>>, place: &Place<'_>) -> Vec<Vec<DVec2>> {
    let (spacing_mm, half_mm) = (place.spacing_mm, 0.5 * place.spacing_mm);
    let clipped = |region: &Region| -> Vec<Vec<DVec2>> {
        let clipper = LineClipper::new(region);
        let pieces = lines.iter().flat_map(|line| clipper.clip(line)).map(|piece| piece.points);
        pieces.filter(|piece| length_mm(piece, false) > spacing_mm).collect()
    };
    let mut out = Vec::new();
    let mut looped = Region::default();
    for part in &region.polygons {
        let part = Region::from(part.clone());
        let loops = loops(&part, place);
        let beads = part.offset(half_mm, Join::Round);
        let covered_mm2 = |lines: Vec<Vec<DVec2>>| {
            let all: Vec<Path> = lines.into_iter().map(|line| (line, false)).collect();
            around(&all, half_mm).intersection(&beads).area_mm2()
        };
        let grown = part.offset((APART - KEPT) * spacing_mm, Join::Round);
        if covered_mm2(loops.clone()) > MORE * covered_mm2(clipped(&grown)) {
            out.extend(loops);
            looped = looped.union(&part);
        }
    }
    out.extend(clipped(&place.region.difference(&looped.offset(KEPT * spacing_mm, Join::Round))));
    out
}

/// Loops in a region, a spacing apart, cut where they turn below the least radius.
fn loops(region: &Region, place: &Place<'_>) -> Vec<Vec<DVec2>> {
    let mut out = Vec::new();
    // A loop whose sides are nearer to each other than a bead would lie on itself.
    let half_mm = 0.5 * APART * place.spacing_mm;
    let opened = |region: &Region| {
        region.offset(-half_mm, Join::Round).offset(half_mm, Join::Miter(2.0)).intersection(region)
    };
    let mut left = opened(region);
    while !left.is_empty() {
        for contour in left.contours() {
            let mut line = contour.clone();
            let sharp = sharp_turns(&line, true, place.least_mm);
            let Some(first) = sharp.first() else {
                line.extend(contour.first().copied());
                out.push(line);
                continue;
            };
            line.rotate_left(first.vertex);
            line.extend(line.first().copied());
            let mut from = 0;
            for turn in sharp.iter().skip(1).map(|t| t.vertex - first.vertex).chain([contour.len()]) {
                if turn > from {
                    out.push(line[from..=turn].to_vec());
                }
                from = turn;
            }
        }
        left = opened(&left.offset(-place.spacing_mm, Join::Round));
    }
    for line in &mut out {
        shorten_start(line, 0.5 * place.spacing_mm);
    }
    out.retain(|line| line.len() > 1 && length_mm(line, false) > place.spacing_mm);
    out
}

/// The area within a distance of paths.
fn around(paths: &[Path], half_mm: f64) -> Region {
    let all: Vec<Region> =
        paths.iter().map(|(points, closed)| Region::around_line(points, *closed, half_mm)).collect();
    Region::from_contours(all.iter().flat_map(Region::contours), FillRule::NonZero)
}

/// Rings in a region, a spacing apart, with turns of the least radius or more.
fn rings(region: &Region, place: &Place<'_>) -> Vec<Contour> {
    let r_mm = WIDER * place.least_mm;
    let opened =
        |region: &Region| region.offset(-r_mm, Join::Round).offset(r_mm, Join::Round).intersection(region);
    let mut out = Vec::new();
    let mut left = opened(region);
    while !left.is_empty() {
        out.extend(left.contours().filter_map(|contour| ring(contour, place)));
        left = opened(&left.offset(-place.spacing_mm, Join::Round));
    }
    out
}

/// A ring along an outline; `None` if it has a turn below the least radius, as at an inner corner of the region.
fn ring(contour: &Contour, place: &Place<'_>) -> Option<Contour> {
    let n = contour.len();
    let side_mm = |k: usize| contour[k].distance(contour[(k + 1) % n]);
    let longest = (0..n).max_by(|&i, &j| side_mm(i).total_cmp(&side_mm(j)).then(j.cmp(&i)))?;
    // The ring begins in the middle of its longest side, where nothing is to be rounded.
    let first = 0.5 * (contour[longest] + contour[(longest + 1) % n]);
    let mut line = vec![first];
    line.extend((1..=n).map(|k| contour[(longest + k) % n]));
    line.push(first);
    let inside = |a: DVec2, b: DVec2| place.clipper.segment_inside(a, b);
    let line = simplify_line(&line, STRAIGHT_MM);
    let least_mm = KEPT_WIDER * place.least_mm;
    let (mut points, _) = rounded(&line, least_mm, least_mm, &inside);
    points.pop();
    sharp_turns(&points, true, least_mm).is_empty().then_some(points)
}
