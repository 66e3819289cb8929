//! Packs layers into few bytes, for the slider of the report page.
//!
//! Method: points are rounded to a grid, which has 65 536 steps along the longer side of the box round beads and travels.
//! Each point is written as its steps from the previous point, modulo 65 536. Widths are multiples of [`WIDTH_STEP_MM`].
//! All is packed with zlib, which every browser unpacks (`DecompressionStream`), and stands in the page as base64.
//!
//! The bytes, little-endian: number of layers (`u32`), left and lower edge and step of the grid (`f32`, mm); per layer
//! its number from 1 (`u32`), height of its top and thickness (`f32`, mm), and the number of paths (`u32`); per path
//! its role (`u8`, an index into `Role::ALL`, or [`TRAVEL`]), its number of beads n (`u16`), n + 1 points of two `u16`,
//! and n widths (`u8`).
//!
//! Limits: if a print has more than [`MOST_BEADS`] beads, only every second, third, ... layer is shown, and the page says
//! so. On a print 300 mm wide the step of the grid is 0.005 mm. `page.js` reads this format.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use grainpath_core::{Bounds2, DVec2, Role};

use crate::layer::{DrawnBead, LayerPicture};

/// Step of bead widths, mm; a width has at most 255 steps. Source: half the last digit that the page shows of a
/// width; only looks depend on it.
pub(super) const WIDTH_STEP_MM: f64 = 0.02;

/// The role of travels in the packed bytes. Source: any number that no role has.
pub(super) const TRAVEL: u8 = 255;

/// The greatest number of beads that one page may hold. Measured: a bead of the gallery's bracket takes 4.0 bytes of the
/// page, so this number takes 6 MB.
const MOST_BEADS: usize = 1_500_000;

/// Layers, packed.
pub(super) struct Packed {
    /// The bytes in the format that this module describes, packed with zlib.
    pub bytes: Vec<u8>,
    /// Indices of the layers that they hold.
    pub shown: Vec<usize>,
    /// The box round all beads, mm.
    pub beads: Bounds2,
    /// Step of the grid, mm.
    #[cfg(test)]
    step_mm: f64,
}

/// Packs layers; `None` where there is nothing to show.
pub(super) fn pack(layers: &[LayerPicture]) -> Option<Packed> {
    pack_at_most(layers, MOST_BEADS)
}

fn pack_at_most(layers: &[LayerPicture], most: usize) -> Option<Packed> {
    let n_beads: usize = layers.iter().map(|l| l.beads.len()).sum();
    let beads = layers.iter().filter_map(LayerPicture::bounds).reduce(Bounds2::union)?;
    let every = n_beads.div_ceil(most).max(1);
    // The last layer is always shown, because it is the one that is seen from above.
    let last = layers.len() - 1;
    let mut shown: Vec<usize> = (0..layers.len()).step_by(every).collect();
    if shown.last() != Some(&last) {
        shown.push(last);
    }
    // The grid covers travels too: they may leave the part, and the modulus would otherwise fold them back.
    let all = layers.iter().flat_map(|l| l.travels.iter().flatten().copied());
    let bounds = all.fold(beads, |b, p| Bounds2 { min: b.min.min(p), max: b.max.max(p) });
    let step = (bounds.size().max_element() / f64::from(u16::MAX)).max(1e-9);
    let grid = CoordinateGrid { min: bounds.min, step };
    let mut raw = Vec::new();
    raw.extend((shown.len() as u32).to_le_bytes());
    for v in [bounds.min.x, bounds.min.y, step] {
        raw.extend((v as f32).to_le_bytes());
    }
    for &k in &shown {
        layer(k, &layers[k], &grid, &mut raw);
    }
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::new(6));
    zlib.write_all(&raw).ok()?;
    Some(Packed {
        bytes: zlib.finish().ok()?,
        shown,
        beads,
        #[cfg(test)]
        step_mm: step,
    })
}

struct CoordinateGrid {
    min: DVec2,
    step: f64,
}

impl CoordinateGrid {
    fn at(&self, p: DVec2) -> [u16; 2] {
        let cell = (p - self.min) / self.step;
        // Rounding may exceed the range by less than a step; `as` clamps the result to the range.
        [cell.x.round() as u16, cell.y.round() as u16]
    }

    /// Writes each point as its steps from the previous point.
    fn steps(&self, points: impl Iterator<Item = DVec2>, out: &mut Vec<u8>) {
        let mut before = [0u16; 2];
        for p in points {
            let now = self.at(p);
            for (a, b) in now.into_iter().zip(before) {
                out.extend(a.wrapping_sub(b).to_le_bytes());
            }
            before = now;
        }
    }
}

fn layer(k: usize, layer: &LayerPicture, grid: &CoordinateGrid, out: &mut Vec<u8>) {
    // Successive pieces of the same role that meet are one path. They meet if their ends are less than a thousandth
    // of a millimetre apart, as for pictures.
    let meets = |a: &DrawnBead, b: &DrawnBead| a.b.distance_squared(b.a) < 1e-6 && a.role == b.role;
    let paths: Vec<&[DrawnBead]> =
        layer.beads.chunk_by(meets).flat_map(|path| path.chunks(usize::from(u16::MAX))).collect();
    out.extend((k as u32 + 1).to_le_bytes());
    out.extend((layer.z_mm as f32).to_le_bytes());
    out.extend((layer.height_mm as f32).to_le_bytes());
    out.extend(((paths.len() + layer.travels.len()) as u32).to_le_bytes());
    for path in paths {
        let role = Role::ALL.iter().position(|r| *r == path[0].role).unwrap_or_default();
        out.push(role as u8);
        out.extend((path.len() as u16).to_le_bytes());
        grid.steps(path.first().map(|b| b.a).into_iter().chain(path.iter().map(|b| b.b)), out);
        out.extend(path.iter().map(|b| (b.width_mm / WIDTH_STEP_MM).round() as u8));
    }
    for travel in &layer.travels {
        out.push(TRAVEL);
        out.extend(1u16.to_le_bytes());
        grid.steps(travel.iter().copied(), out);
        out.push(0);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    /// A path round a square and a line apart from it, and a travel between them that leaves the part.
    fn picture(z_mm: f64) -> LayerPicture {
        let p = [(10.0, 20.0), (40.0, 20.0), (40.0, 45.5), (10.0, 45.5)].map(DVec2::from);
        let bead = |a: DVec2, b: DVec2, width_mm: f64, role: Role| DrawnBead {
            a,
            b,
            width_mm,
            role,
            speed_mm_s: 30.0,
            off_deg: None,
            raise_mm: [0.0; 2],
        };
        let mut beads: Vec<DrawnBead> =
            (0..4).map(|i| bead(p[i], p[(i + 1) % 4], 0.45, Role::OuterWall)).collect();
        beads.push(bead(DVec2::new(12.5, 30.0), DVec2::new(37.0, 30.25), 0.6, Role::SparseFill));
        let travels = vec![[DVec2::new(10.0, 20.0), DVec2::new(5.0, 30.0)]];
        LayerPicture { z_mm, height_mm: 0.2, beads, travels, cuts: Vec::new() }
    }

    /// Role, points and widths.
    type Path = (u8, Vec<DVec2>, Vec<f64>);

    /// Reads the bytes as `page.js` does: for each layer its number and its paths.
    fn unpack(bytes: &[u8]) -> Vec<(u32, Vec<Path>)> {
        let mut raw = Vec::new();
        flate2::read::ZlibDecoder::new(bytes).read_to_end(&mut raw).expect("zlib");
        let mut at = 0;
        let mut take = |n: usize| {
            at += n;
            raw[at - n..at].to_vec()
        };
        let u32_of = |b: Vec<u8>| u32::from_le_bytes(b.try_into().expect("four bytes"));
        let f32_of = |b: Vec<u8>| f64::from(f32::from_le_bytes(b.try_into().expect("four bytes")));
        let u16_of = |b: Vec<u8>| u16::from_le_bytes(b.try_into().expect("two bytes"));
        let n = u32_of(take(4));
        let (min, step) = (DVec2::new(f32_of(take(4)), f32_of(take(4))), f32_of(take(4)));
        (0..n)
            .map(|_| {
                let number = u32_of(take(4));
                take(8);
                let paths = (0..u32_of(take(4))).map(|_| {
                    let (role, beads) = (take(1)[0], u16_of(take(2)));
                    let mut now = [0u16; 2];
                    let points = (0..=beads).map(|_| {
                        now = now.map(|v| v.wrapping_add(u16_of(take(2))));
                        min + step * DVec2::new(f64::from(now[0]), f64::from(now[1]))
                    });
                    let points: Vec<DVec2> = points.collect();
                    let widths = (0..beads).map(|_| f64::from(take(1)[0]) * WIDTH_STEP_MM).collect();
                    (role, points, widths)
                });
                (number, paths.collect())
            })
            .collect()
    }

    #[test]
    fn what_is_packed_is_read_back_within_the_grid() {
        let layers = [picture(0.2), picture(0.4)];
        let packed = pack(&layers).expect("beads");
        let read = unpack(&packed.bytes);
        assert_eq!(read.iter().map(|l| l.0).collect::<Vec<_>>(), [1, 2]);
        let (_, paths) = &read[1];
        // The square closes: four beads in one path. The line and the travel are paths of their own.
        let sizes: Vec<(u8, usize)> = paths.iter().map(|p| (p.0, p.2.len())).collect();
        assert_eq!(sizes, [(0, 4), (6, 1), (TRAVEL, 1)]);
        let step = packed.step_mm;
        assert!(step < 36.0 / 65_535.0, "{step}");
        let near = |p: DVec2, q: (f64, f64)| p.distance(q.into()) < step;
        assert!(near(paths[0].1[2], (40.0, 45.5)) && near(paths[0].1[4], (10.0, 20.0)), "{:?}", paths[0]);
        assert!(near(paths[1].1[1], (37.0, 30.25)) && (paths[1].2[0] - 0.6).abs() < 1e-9, "{:?}", paths[1]);
        assert!(near(paths[2].1[1], (5.0, 30.0)), "a travel may leave the part: {:?}", paths[2]);
    }

    #[test]
    fn a_large_print_shows_every_third_layer_and_the_last() {
        let layers: Vec<LayerPicture> = (1..=11).map(|k| picture(0.2 * f64::from(k))).collect();
        let packed = pack_at_most(&layers, 5 * 11 / 3 + 1).expect("beads");
        assert_eq!(packed.shown, [0, 3, 6, 9, 10]);
        assert_eq!(unpack(&packed.bytes).len(), 5);
        assert!(pack(&[]).is_none(), "nothing printed, nothing shown");
    }
}
