//! Finds the corners of a board that lies on a plain ground.
//!
//! # Method
//! The ground is the median brightness along the border of the picture. Otsu's threshold (`otsu1979` in
//! docs/references.bib) separates the pixels that differ from the ground, and the largest connected piece of
//! them is the board. The convex hull of the piece (`andrew1979`) is reduced to four sides: sides are removed
//! one at a time, always the one whose removal adds the least area. Each side is then fitted to the steepest
//! changes of brightness across it in the full picture. The corners are the points where the sides meet.
//!
//! # Units, cost and limits
//! Pixels, rows downwards; corners run from the upper left one clockwise. The search works on a picture of at
//! most 1400 px and is linear in its pixels. The board must lie inside the picture, cover 2 to 98 % of it,
//! differ from the ground by 2 % of white and be four-sided; everything else is refused with the reason. The
//! outline is the same after a half turn, so a half turn goes unnoticed; see `orientation` for quarter turns.

use grainpath_core::DVec2;
use grainpath_core::math::cross;

use super::warp::Homography;
use crate::raster::Grey;
use crate::threshold::otsu_split;

/// Why corners could not be found.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum CornersNotFound {
    #[error("no outline of a board found: {problem}; give corners_px, or photograph it on a plain ground")]
    Outline { problem: &'static str },
    #[error("{found} of the sheet's 4 corner markers found; give corners_px, or show all four")]
    Markers { found: usize },
    #[error(
        "the photograph is mirrored: the markers of the sheet run the wrong way round; mirror it back, or give corners_px"
    )]
    Mirrored,
    #[error(
        "the outline found has sides of {found:.2} : 1, the board's size_mm has {asked:.2} : 1; correct size_mm, or give corners_px if the picture was cropped"
    )]
    Ratio { found: f64, asked: f64 },
}

/// The picture that is searched is halved until its longest side is at most twice this. Corners are
/// refined in the full picture afterwards, so a finer search would only cost time. Source: chosen; it
/// changes the speed, and the refined corners by less than a pixel.
const SEARCH_PX: usize = 700;

/// The corners of the largest object that differs from the ground along the picture's border: upper left,
/// upper right, lower right, lower left.
///
/// The brightness of the ground is estimated from the border, and pixels that differ from it become a
/// mask. The convex hull of the largest piece of the mask is reduced to four sides. Each side is
/// moved to where brightness changes fastest across it.
///
/// # Errors
/// [`CornersNotFound`] when nothing stands out, when it touches the border, or when it is not four-sided.
pub fn find_corners(photo: &Grey) -> Result<[DVec2; 4], CornersNotFound> {
    let wrong = |problem| CornersNotFound::Outline { problem };
    let (small, level) = shrunk(photo);
    // The median removes grain and knots, the Gaussian the steps between pixels.
    let small = small.median(2).blurred(1.0);
    let mask = foreground(&small).ok_or(wrong("nothing stands out from the ground"))?;
    let piece = largest_piece(&mask, small.width, small.height);
    // A piece smaller than 2 % of the picture is a stain or a tool instead of the board.
    if piece.len() < small.data.len() / 50 {
        return Err(wrong("what stands out is too small"));
    }
    // A few pixels may touch the border because of noise. More mean that the board is cut off, so a corner is missing.
    if piece.iter().filter(|k| on_border(**k, small.width, small.height)).count() > 4 {
        return Err(wrong("it reaches the photograph's border"));
    }
    let hull = hull(&piece, small.width);
    let rough = four_sides(&hull).ok_or(wrong("what stands out is not four-sided"))?;
    let area = 0.5 * cross(rough[2] - rough[0], rough[3] - rough[1]).abs();
    // The hull of an L or a disc is also reduced to four sides, but the piece fills a smaller share of them.
    if (piece.len() as f64) < 0.9 * area {
        return Err(wrong("what stands out is not four-sided"));
    }
    let corners = rough.map(|p| p * level);
    Ok(sorted(refined(photo, corners, 4.0 * level)))
}

/// The picture halved until it is small enough to be searched, and the factor by which it was shrunk.
pub(super) fn shrunk(photo: &Grey) -> (Grey, f64) {
    let (mut small, mut level) = (photo.clone(), 1.0);
    while small.width.max(small.height) > 2 * SEARCH_PX {
        small = small.halved();
        level *= 2.0;
    }
    (small, level)
}

/// A mask of the pixels whose brightness differs from the ground by more than the border itself varies.
/// Otsu's threshold separates small from large differences; `None` if there is no clear separation.
fn foreground(grey: &Grey) -> Option<Vec<bool>> {
    let (w, h) = (grey.width, grey.height);
    if w < 16 || h < 16 {
        return None;
    }
    let mut border: Vec<f32> = (0..w).flat_map(|x| [grey.at(x, 0), grey.at(x, h - 1)]).collect();
    border.extend((0..h).flat_map(|y| [grey.at(0, y), grey.at(w - 1, y)]));
    // The median of the border: a board that reaches into it in one place must not shift the ground.
    let ground = crate::raster::quantile(&mut border, 0.5);
    let off: Vec<f32> = grey.data.iter().map(|v| (v - ground).abs()).collect();
    let mut spread: Vec<f32> = border.iter().map(|v| (v - ground).abs()).collect();
    let rough = crate::raster::quantile(&mut spread, 0.95);
    // The threshold is at least 1.3 times the 95th percentile of the border's own deviation. This keeps
    // shadows and textured ground out of the mask.
    let threshold = otsu(&off).max(1.3 * rough);
    let n = off.iter().filter(|v| **v > threshold).count();
    // The object must cover between 2 % and 98 % of the picture and differ by at least 2 % of white.
    // Otherwise there is no board or no ground.
    let stands_out = threshold > 0.02 && n > off.len() / 50 && n < off.len() * 49 / 50;
    stands_out.then(|| off.iter().map(|v| *v > threshold).collect())
}

/// Otsu's threshold of values from 0 to 1.
fn otsu(values: &[f32]) -> f32 {
    // Number of bins of the histogram. Source: derived. Photographs have 8 bits, and a finer split would only follow
    // noise.
    const BINS: usize = 256;
    let mut counts = [0u64; BINS];
    values.iter().for_each(|v| counts[((v * BINS as f32) as usize).min(BINS - 1)] += 1);
    (otsu_split(&counts) / BINS as f64) as f32
}

/// Whether a pixel lies on the border of a picture of this size.
pub(super) fn on_border(pixel: usize, w: usize, h: usize) -> bool {
    let (x, y) = (pixel % w, pixel / w);
    x == 0 || y == 0 || x + 1 == w || y + 1 == h
}

/// The pixels of the largest connected piece of a mask; of equal pieces, the first.
pub(super) fn largest_piece(mask: &[bool], w: usize, h: usize) -> Vec<usize> {
    pieces(mask, w, h).into_iter().fold(Vec::new(), |best, p| if p.len() > best.len() { p } else { best })
}

/// The connected pieces of a mask; neighbours share a side.
pub(super) fn pieces(mask: &[bool], w: usize, h: usize) -> Vec<Vec<usize>> {
    let mut left = mask.to_vec();
    let mut out = Vec::new();
    for start in 0..w * h {
        if !left[start] {
            continue;
        }
        left[start] = false;
        // The piece serves as its own queue, so no recursion depends on its size.
        let (mut piece, mut next) = (vec![start], 0);
        while next < piece.len() {
            let k = piece[next];
            next += 1;
            let (x, y) = (k % w, k / w);
            let around = [
                (x > 0).then(|| k - 1),
                (x + 1 < w).then(|| k + 1),
                (y > 0).then(|| k - w),
                (y + 1 < h).then(|| k + w),
            ];
            for n in around.into_iter().flatten() {
                if left[n] {
                    left[n] = false;
                    piece.push(n);
                }
            }
        }
        out.push(piece);
    }
    out
}

/// The convex hull of the pixels' centres, clockwise as seen (rows downwards).
pub(super) fn hull(pixels: &[usize], w: usize) -> Vec<DVec2> {
    let mut points: Vec<DVec2> =
        pixels.iter().map(|k| DVec2::new((k % w) as f64 + 0.5, (k / w) as f64 + 0.5)).collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    // Andrew's monotone chain makes the lower and the upper half of the hull from the sorted points.
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while chain.len() > 1 && {
                let (a, b) = (chain[chain.len() - 2], chain[chain.len() - 1]);
                cross(b - a, p - b) <= 0.0
            } {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut out = half(&mut points.iter().copied());
    out.extend(half(&mut points.iter().rev().copied()));
    out
}

/// Reduces a hull to four corners. The side whose removal adds the least area goes first; its neighbours
/// are extended until they meet.
pub(super) fn four_sides(hull: &[DVec2]) -> Option<[DVec2; 4]> {
    let mut ring = hull.to_vec();
    while ring.len() > 4 {
        let n = ring.len();
        let cost = |i: usize| {
            // If the side b-c is removed, a-b and d-c are extended to the tip where they meet.
            let [a, b, c, d] = [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n], ring[(i + 2) % n]];
            let tip = meet(a, b, c, d)?;
            Some((0.5 * cross(tip - b, c - b).abs(), tip))
        };
        let best = (0..n).filter_map(|i| cost(i).map(|(area, tip)| (area, i, tip)));
        let (_, i, tip) = best.fold(
            None,
            |best: Option<(f64, usize, DVec2)>, c| {
                if best.is_none_or(|b| c.0 < b.0) { Some(c) } else { best }
            },
        )?;
        ring[i] = tip;
        ring.remove((i + 1) % n);
    }
    ring.try_into().ok()
}

/// The point where the lines a-b and d-c meet beyond b and c.
fn meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<DVec2> {
    let (u, v) = (b - a, c - d);
    let denominator = cross(u, v);
    // Parallel neighbours never meet, so the side between them cannot be removed.
    if denominator.abs() < 1e-9 * u.length() * v.length() {
        return None;
    }
    let t = cross(d - a, v) / denominator;
    // If the lines met before b, the sides would have to be shortened, which cuts area off instead of adding it.
    (t >= 1.0).then(|| a + t * u)
}

/// Moves each side to where brightness changes fastest across it and returns the points where the sides
/// then meet.
pub(super) fn refined(photo: &Grey, corners: [DVec2; 4], reach: f64) -> [DVec2; 4] {
    // Number of points along a side. Source: derived. The line is fitted through all of them, so its error falls with
    // the square root of their number; 60 are enough even if a third is hidden.
    const SAMPLES: usize = 60;
    let side = |k: usize| -> (DVec2, DVec2) {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        let along = (b - a).normalize_or_zero();
        let normal = DVec2::new(-along.y, along.x);
        let mut found = Vec::new();
        for i in 0..SAMPLES {
            // The ends of a side are left out, since the brightness changes there because of the
            // neighbouring side.
            let p = a.lerp(b, 0.06 + 0.88 * (i as f64 + 0.5) / SAMPLES as f64);
            let at = |t: f64| f64::from(photo.sample(p.x + t * normal.x, p.y + t * normal.y));
            let steps = (2.0 * reach) as i32 * 2;
            // Slopes over three pixels, at every half pixel.
            let slope = |k: i32| {
                let t = f64::from(k) * 0.5;
                (at(t + 1.5) + at(t + 0.75) - at(t - 0.75) - at(t - 1.5)).abs()
            };
            let best = (-steps / 2..=steps / 2).fold((0.0, 0), |best, k| {
                let s = slope(k);
                if s > best.0 { (s, k) } else { best }
            });
            let (before, after) = (slope(best.1 - 1), slope(best.1 + 1));
            let bend = before - 2.0 * best.0 + after;
            let shift = if bend < -1e-9 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
            // A weaker change is grain or noise, not the border of the board.
            if best.0 > 0.05 {
                found.push(p + 0.5 * (f64::from(best.1) + shift) * normal);
            }
        }
        // Too few points: the side stays where the hull has it.
        fit_line(&found).unwrap_or((a, b))
    };
    let sides = [side(0), side(1), side(2), side(3)];
    std::array::from_fn(|k| {
        let ((a, b), (c, d)) = (sides[(k + 3) % 4], sides[k]);
        let (u, v) = (b - a, d - c);
        let denominator = cross(u, v);
        if denominator.abs() < 1e-9 { corners[k] } else { a + cross(c - a, v) / denominator * u }
    })
}

/// Fits a line to points, and leaves out the farthest points in each of three rounds. Returns two points
/// on the line; `None` if there are too few points.
fn fit_line(points: &[DVec2]) -> Option<(DVec2, DVec2)> {
    let mut kept = points.to_vec();
    let mut line = None;
    for _ in 0..4 {
        if kept.len() < 8 {
            return None;
        }
        let centre = kept.iter().copied().sum::<DVec2>() / kept.len() as f64;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for d in kept.iter().map(|p| *p - centre) {
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
        }
        // The direction of greatest variance is the eigenvector of the covariance, found in closed form.
        let angle = 0.5 * grainpath_core::math::atan2(2.0 * xy, xx - yy);
        let along = grainpath_core::math::direction(angle);
        line = Some((centre, centre + along));
        let off = |p: &DVec2| cross(along, *p - centre).abs();
        let mut all: Vec<f64> = kept.iter().map(off).collect();
        all.sort_by(f64::total_cmp);
        // The limit of 2.5 times the median distance removes points on knots and shadows. A limit of at
        // least 0.3 pixels keeps a perfect line from losing points to rounding.
        let limit = (2.5 * all[all.len() / 2]).max(0.3);
        kept.retain(|p| off(p) <= limit);
    }
    line
}

/// Orders four corners as upper left, upper right, lower right, lower left.
pub(super) fn sorted(mut corners: [DVec2; 4]) -> [DVec2; 4] {
    // A negative cross product of the diagonals means counter-clockwise.
    if cross(corners[2] - corners[0], corners[3] - corners[1]) < 0.0 {
        corners.reverse();
    }
    // The upper left corner is the one nearest to that of the picture.
    let first = (0..4).fold(0, |best, k| {
        let sum = |k: usize| corners[k].x + corners[k].y;
        if sum(k) < sum(best) { k } else { best }
    });
    corners.rotate_left(first);
    corners
}

/// The map from a unit square to a quadrilateral, for reading and drawing inside it.
pub(super) fn square_to(corners: [DVec2; 4]) -> Option<Homography> {
    Homography::from_points([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from), corners)
}
