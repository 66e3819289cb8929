//! Contours between pixels: marching squares on the signed distance of grey values to the threshold.
//!
//! # Method
//! Each cell of four pixel centres whose signs differ gives one or two segments, whose ends lie where the linear
//! interpolation along a side is zero (`lorensen1987` in two dimensions). At saddles the mean of the four values decides.
//! Chords from crossing to crossing, and their simplification, would cut each arc on its inner side.
//! `traced_in_place` moves the contour out by the area that was cut, so that a section keeps its size.
//!
//! # Units, cost and limits
//! Contours are in pixels, with the centre of the first at (0.5, 0.5); outlines run counter-clockwise and
//! holes clockwise. Cost is linear in the number of pixels, and n log n in the segments of contours, which take
//! 16 bytes each. A part that extends beyond the picture ends half a pixel outside. A face that lies in the plane
//! of the slice has values near zero over an area; `with_flats` makes it present or absent as a whole instead of torn by noise.

use grainpath_core::math::{atan2, cross};
use grainpath_core::poly::simplify_contour;
use grainpath_core::{Contour, DVec2, Polygon, Region};

/// An image whose zero line is the border of the part: positive inside.
#[derive(Debug, Clone)]
pub struct SignedImage {
    /// `(rows, columns)`, row-major, with a frame of one pixel that is never inside.
    values: Vec<f32>,
    nx: usize,
    ny: usize,
}

impl SignedImage {
    /// A grid of `nx` x `ny` values, mixed of two: `(1 - t) a + t b`. A part that extends beyond the
    /// picture ends half a pixel outside.
    pub fn mixed(a: &[f32], b: &[f32], t: f32, nx: usize, ny: usize) -> Self {
        let w = nx + 2;
        let mut values = vec![0.0; w * (ny + 2)];
        for j in 0..ny {
            let row = &mut values[(j + 1) * w..(j + 2) * w];
            let (a, b) = (&a[j * nx..(j + 1) * nx], &b[j * nx..(j + 1) * nx]);
            for ((v, &p), &q) in row[1..=nx].iter_mut().zip(a).zip(b) {
                *v = p + t * (q - p);
            }
            row[0] = outside(row[1]);
            row[nx + 1] = outside(row[nx]);
        }
        for i in 0..w {
            values[i] = outside(values[w + i]);
            values[(ny + 1) * w + i] = outside(values[ny * w + i]);
        }
        Self { values, nx, ny }
    }

    /// Removes noise where a face of the part lies in the plane of the slice. There the grey value
    /// changes from slice to slice and is near zero over an area instead of along a line. `step` is the
    /// change between slices at a pixel.
    pub(crate) fn with_flats(mut self, step: impl Fn(usize) -> f32) -> Self {
        const REACH: usize = 2;
        let (w, nx) = (self.nx + 2, self.nx);
        // A value below 12 % of the change means that the face lies within 12 % of a slice distance.
        let is_flat = |v: f32, k: usize| v.abs() < 0.12 * step(k);
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (j, row) in self.values[w..].chunks_exact(w).take(self.ny).enumerate() {
            let in_row = row[1..=nx].iter().enumerate().filter(|(i, v)| is_flat(**v, j * nx + i));
            found.extend(in_row.map(|(i, _)| (i, j)));
        }
        // A few such pixels occur along every contour by chance.
        if found.len() < 25 {
            return self;
        }
        let mut settled: Vec<(usize, f32)> = Vec::new();
        for (i, j) in found {
            let (mut n, mut sum) = (0, 0.0);
            for y in j.saturating_sub(REACH)..=(j + REACH).min(self.ny - 1) {
                for x in i.saturating_sub(REACH)..=(i + REACH).min(nx - 1) {
                    let v = self.values[(y + 1) * w + x + 1];
                    if is_flat(v, y * nx + x) {
                        n += 1;
                        sum += v;
                    }
                }
            }
            // Nearly half of the 5 x 5 neighbourhood: along a contour only a line of five pixels is near
            // zero.
            if n > 10 {
                settled.push((j * nx + i, sum / n as f32));
            }
        }
        level(&mut settled, nx, |k| 0.02 * step(k));
        settled.into_iter().for_each(|(k, v)| self.values[(k / nx + 1) * w + k % nx + 1] = v);
        self
    }

    /// A grid of these values.
    pub fn new(values: &[f32], nx: usize, ny: usize) -> Self {
        Self::mixed(values, values, 0.0, nx, ny)
    }

    /// The contours of the inside, in pixels: the centre of the first pixel is (0.5, 0.5). The inside
    /// lies to the left. At a saddle the mean of the four corners decides.
    pub fn contours(&self) -> Vec<Contour> {
        let w = self.nx + 2;
        // Segments from grid edge to grid edge. Each edge is left by at most one segment.
        let mut segments: Vec<(u32, u32)> = Vec::new();
        let mut low_bits = signs(&self.values[..w]);
        for j in 0..=self.ny {
            let (low, high) = (&self.values[j * w..(j + 1) * w], &self.values[(j + 1) * w..(j + 2) * w]);
            let high_bits = signs(high);
            for (i, code) in crossed_cells(&low_bits, &high_bits, self.nx + 1) {
                let p = (j * w + i) as u32;
                // Edges are numbered by the pixel at which they begin: even ones run along x, odd ones
                // along y.
                let (bottom, left) = (2 * p, 2 * p + 1);
                let (top, right) = (2 * (p + w as u32), 2 * (p + 1) + 1);
                let mut link = |from: u32, to: u32| segments.push((from, to));
                let joined = || low[i] + low[i + 1] + high[i] + high[i + 1] > 0.0;
                match code {
                    1 => link(bottom, left),
                    2 => link(right, bottom),
                    3 => link(right, left),
                    4 => link(top, right),
                    6 => link(top, bottom),
                    7 => link(top, left),
                    8 => link(left, top),
                    9 => link(bottom, top),
                    11 => link(right, top),
                    12 => link(left, right),
                    13 => link(bottom, right),
                    14 => link(left, bottom),
                    // Cases 5 and 10 are saddles: two corners across a diagonal are inside.
                    5 if joined() => {
                        link(bottom, right);
                        link(top, left);
                    }
                    5 => {
                        link(bottom, left);
                        link(top, right);
                    }
                    _ if joined() => {
                        link(left, bottom);
                        link(right, top);
                    }
                    _ => {
                        link(right, bottom);
                        link(left, top);
                    }
                }
            }
            low_bits = high_bits;
        }
        // Successors are searched: an array over all edges would take eight bytes a pixel, while contours cross few pixels.
        let mut successors = segments.clone();
        successors.sort_unstable();
        let mut out = Vec::new();
        // Following successors uses them up, so each contour is found once.
        for (start, _) in segments {
            let mut at = start;
            let mut contour = Vec::new();
            while let Ok(k) = successors.binary_search_by_key(&at, |s| s.0)
                && successors[k].1 != NONE
            {
                contour.push(self.point(at));
                at = std::mem::replace(&mut successors[k].1, NONE);
            }
            // A value of exactly zero puts two crossings on the same pixel.
            contour.dedup();
            if contour.len() > 2 {
                out.push(contour);
            }
        }
        out
    }

    /// The point where an edge crosses zero.
    fn point(&self, edge: u32) -> DVec2 {
        let w = self.nx + 2;
        let p = (edge / 2) as usize;
        let q = if edge.is_multiple_of(2) { p + 1 } else { p + w };
        let (a, b) = (f64::from(self.values[p]), f64::from(self.values[q]));
        // The two signs differ, so the denominator is never zero.
        let t = a / (a - b);
        let at = DVec2::new((p % w) as f64 - 0.5, (p / w) as f64 - 0.5);
        if edge.is_multiple_of(2) { at + DVec2::new(t, 0.0) } else { at + DVec2::new(0.0, t) }
    }
}

/// Whether each value of a row is inside, 64 to a word, the first in the lowest bit.
fn signs(row: &[f32]) -> Vec<u64> {
    let word = |values: &[f32]| values.iter().rev().fold(0, |bits, v| bits << 1 | u64::from(*v > 0.0));
    row.chunks(64).map(word).collect()
}

/// The word of a row whose bits are those of the next values.
fn shifted(bits: &[u64], word: usize) -> u64 {
    bits[word] >> 1 | bits.get(word + 1).map_or(0, |next| next << 63)
}

/// The first `n` cells between two rows that a contour crosses, each with a code: bit 0 for its corner at the lower left, and
/// on counter-clockwise.
fn crossed_cells<'a>(low: &'a [u64], high: &'a [u64], n: usize) -> impl Iterator<Item = (usize, u64)> + 'a {
    (0..low.len()).flat_map(move |word| {
        let corners = [low[word], shifted(low, word), shifted(high, word), high[word]];
        let surplus = (64 * (word + 1)).saturating_sub(n);
        let crossed = corners.iter().fold(0, |bits, corner| bits | (corner ^ corners[0]));
        let mut left = crossed & u64::MAX.checked_shr(surplus as u32).unwrap_or(0);
        std::iter::from_fn(move || {
            let bit = left.trailing_zeros();
            let code = |bit: u32| corners.iter().rev().fold(0, |code, c| code << 1 | (c >> bit & 1));
            left &= left.checked_sub(1)?;
            Some((64 * word + bit as usize, code(bit)))
        })
    })
}

/// Sets every connected level patch to its mean value. A patch is level if the means of its halves differ by less than
/// `tolerance`. A face that lies almost exactly in the plane is then present as a whole or not at all. Entries of `patch`
/// are ordered by pixel number.
fn level(patch: &mut [(usize, f32)], nx: usize, tolerance: impl Fn(usize) -> f32) {
    let mut free = vec![true; patch.len()];
    for seed in 0..patch.len() {
        if !std::mem::replace(&mut free[seed], false) {
            continue;
        }
        let mut members = vec![seed];
        let mut next = 0;
        while next < members.len() {
            let k = patch[members[next]].0;
            next += 1;
            let row = [k.checked_sub(1), Some(k + 1)].map(|m| m.filter(|m| m / nx == k / nx));
            for m in row.into_iter().chain([k.checked_sub(nx), Some(k + nx)]).flatten() {
                if let Ok(i) = patch.binary_search_by_key(&m, |p| p.0)
                    && std::mem::replace(&mut free[i], false)
                {
                    members.push(i);
                }
            }
        }
        if members.len() < 25 {
            continue;
        }
        let mean = |part: &[usize]| part.iter().map(|&i| patch[i].1).sum::<f32>() / part.len() as f32;
        // The patch is halved by column and by row. A patch that leans has different means in its halves.
        let halves = |key: &dyn Fn(usize) -> usize| {
            let mut sorted = members.clone();
            sorted.sort_by_key(|&i| (key(patch[i].0), patch[i].0));
            let (low, high) = sorted.split_at(sorted.len() / 2);
            (mean(low) - mean(high)).abs()
        };
        let apart = halves(&|k| k % nx).max(halves(&|k| k / nx));
        if apart < tolerance(patch[seed].0) {
            let value = mean(&members);
            members.into_iter().for_each(|i| patch[i].1 = value);
        }
    }
}

const NONE: u32 = u32::MAX;

// The frame mirrors the border's value with a negative sign, so a part that leaves the picture crosses
// zero half a pixel outside.
fn outside(inside: f32) -> f32 {
    -inside.abs().max(f32::MIN_POSITIVE)
}

/// Simplifies a contour so that it keeps its size. Chords cut each arc on its inner side, by two thirds
/// of the tolerance on average. The sides that remain are therefore moved out by the area that was cut
/// off.
pub(super) fn simplified_in_place(contour: &[DVec2], tolerance_mm: f64) -> Contour {
    resized(contour, tolerance_mm, |_| 0.0)
}

/// Like [`simplified_in_place`], for a contour fresh from the pixels. Its sides are chords already, and
/// the area between chord and arc is added as well: l^2 a / 12 for a side of length l between turns of
/// mean angle a.
pub(super) fn traced_in_place(contour: &[DVec2], tolerance_mm: f64) -> Contour {
    let n = contour.len();
    let side = |k: usize| contour[(k + 1) % n] - contour[k % n];
    let turn = |k: usize| atan2(cross(side(k), side(k + 1)), side(k).dot(side(k + 1)));
    let turns: Vec<f64> = (0..n).map(turn).collect();
    resized(contour, tolerance_mm, |k| {
        side(k).length_squared() * 0.5 * (turns[(k + n - 1) % n] + turns[k]) / 12.0
    })
}

/// Simplifies a contour, and moves each side out by the area that was cut off there plus `outside_mm2` of
/// the sides it replaces.
fn resized(contour: &[DVec2], tolerance_mm: f64, outside_mm2: impl Fn(usize) -> f64) -> Contour {
    let kept = simplify_contour(contour, tolerance_mm);
    let n = kept.len();
    if n < 3 {
        return kept;
    }
    // Both contours run the same way, and the vertices that are kept are vertices of the original.
    let Some(start) = contour.iter().position(|p| *p == kept[0]) else { return kept };
    let mut at = start;
    let mut cut = Vec::with_capacity(n);
    for k in 0..n {
        let (a, b) = (kept[k], kept[(k + 1) % n]);
        let mut area = 0.0;
        loop {
            let next = (at + 1) % contour.len();
            // The shoelace sum of the cut-off polygon, relative to the side's first point.
            area += 0.5 * cross(contour[at] - a, contour[next] - a) + outside_mm2(at);
            at = next;
            if contour[at] == b || at == start {
                break;
            }
        }
        cut.push((area, a.distance(b)));
    }
    let moved = |k: usize| {
        let (before, after) = (kept[(k + n - 1) % n], kept[(k + 1) % n]);
        let ((a, la), (b, lb)) = (cut[(k + n - 1) % n], cut[k]);
        // A positive area lies to the right of a side, which is outside the material.
        let out = (kept[k] - before).normalize_or_zero() + (after - kept[k]).normalize_or_zero();
        // The vertex moves by the mean height of the cut-off area over its two sides. The clamp bounds the move where sides
        // are tiny.
        let step = ((a + b) / (la + lb)).clamp(-tolerance_mm, tolerance_mm);
        kept[k] + step * DVec2::new(out.y, -out.x).normalize_or_zero()
    };
    (0..n).map(moved).collect()
}

/// All contours of a region through [`simplified_in_place`]. Contours that vanish are left out.
pub(super) fn region_in_place(region: &Region, tolerance_mm: f64) -> Region {
    let polygon = |p: &Polygon| {
        let outer = simplified_in_place(&p.outer, tolerance_mm);
        let holes = p.holes.iter().map(|h| simplified_in_place(h, tolerance_mm));
        let holes = holes.filter(|h| !h.is_empty()).collect();
        (!outer.is_empty()).then_some(Polygon { outer, holes })
    };
    Region { polygons: region.polygons.iter().filter_map(polygon).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::poly::signed_area_mm2;

    #[test]
    fn a_disc_has_its_area_to_a_thousandth() {
        let (nx, ny, r) = (64, 50, 17.3);
        let value = |i: usize| {
            let p = DVec2::new((i % nx) as f64 + 0.5 - 30.2, (i / nx) as f64 + 0.5 - 24.9);
            (r - p.length()) as f32
        };
        let values: Vec<f32> = (0..nx * ny).map(value).collect();
        let contours = SignedImage::new(&values, nx, ny).contours();
        assert_eq!(contours.len(), 1);
        let area = signed_area_mm2(&contours[0]);
        assert!((area / (std::f64::consts::PI * r * r) - 1.0).abs() < 1e-3, "{area}");
    }

    /// Signs are kept 64 to a word, so the same picture is traced at every place of the words, ending with the row or before it.
    #[test]
    fn contours_are_the_same_wherever_a_word_ends() {
        let (nx, ny) = (19, 17);
        let value = |i: usize| ((i * i * 7 + i * 3) % 23) as f32 - 11.5;
        let picture: Vec<f32> = (0..nx * ny).map(value).collect();
        let expected = SignedImage::new(&picture, nx, ny).contours();
        assert!(expected.len() > 15, "{} contours", expected.len());
        for (before, after) in (0..130).flat_map(|k| [(k, 0), (k, 1), (k, 130 - k)]) {
            let width = before + nx + after;
            // Air as deep as what lies beyond the border of a picture, which mirrors the outermost values.
            let row = |j: usize| {
                let own = &picture[j * nx..(j + 1) * nx];
                let air = |v: f32, n: usize| vec![outside(v); n];
                [air(own[0], before), own.to_vec(), air(own[nx - 1], after)].concat()
            };
            let values: Vec<f32> = (0..ny).flat_map(row).collect();
            let contours = SignedImage::new(&values, width, ny).contours();
            assert_eq!(contours.len(), expected.len(), "{before} {after}");
            for (contour, expected) in contours.iter().zip(&expected) {
                let moved = expected.iter().map(|p| *p + DVec2::new(before as f64, 0.0));
                assert!(contour.len() == expected.len(), "{before} {after}");
                assert!(contour.iter().zip(moved).all(|(a, b)| a.distance(b) < 1e-9), "{before} {after}");
            }
        }
    }

    #[test]
    fn what_fills_the_picture_ends_half_a_pixel_outside_its_middles() {
        let contours = SignedImage::new(&[1.0; 12], 4, 3).contours();
        assert_eq!(contours.len(), 1);
        assert!((signed_area_mm2(&contours[0]) - 12.0).abs() < 0.6);
        let hole = [1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0, 1.0];
        let areas: Vec<f64> =
            SignedImage::new(&hole, 3, 3).contours().iter().map(|c| signed_area_mm2(c)).collect();
        assert!(areas.len() == 2 && areas[0] > 0.0 && areas[1] < 0.0, "{areas:?}");
        assert!(SignedImage::new(&[-1.0; 9], 3, 3).contours().is_empty());
        // Exact zeros are outside and break nothing; what meets at corners hangs together if its mean is inside.
        assert_eq!(
            SignedImage::new(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0], 3, 3).contours().len(),
            1
        );
        assert_eq!(
            SignedImage::new(&[-2.0, 1.0, -2.0, 1.0, -2.0, 1.0, -2.0, 1.0, -2.0], 3, 3).contours().len(),
            4
        );
    }

    #[test]
    fn a_flat_face_in_the_plane_is_not_torn_by_noise() {
        let n = 40;
        let noise = |i: usize, s: usize| ((((i * 7919 + s) * 104_729) >> 3) % 101) as f32 * 0.02 - 1.0;
        // The face lies a twentieth of the way above the plane: everything is inside but for the noise.
        let framed = |i: usize| (4..36).contains(&(i % n)) && (4..36).contains(&(i / n));
        let below: Vec<f32> =
            (0..n * n).map(|i| if framed(i) { 10.0 + noise(i, 1) } else { -10.0 }).collect();
        let above: Vec<f32> = (0..n * n).map(|i| -10.0 + noise(i, 5)).collect();
        let torn = SignedImage::mixed(&below, &above, 0.48, n, n);
        assert!(torn.contours().len() > 1);
        let whole =
            SignedImage::mixed(&below, &above, 0.48, n, n).with_flats(|k| (below[k] - above[k]).abs());
        assert_eq!(whole.contours().len(), 1);
    }
}
