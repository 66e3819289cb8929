//! A wheel hub as a CT scanner would image it, with its true dimensions.

use std::f64::consts::TAU;

use grainpath_core::DVec2;
use grainpath_core::math::{cross, direction, exp};
use rayon::prelude::*;

/// Side of the scanned square, mm. Source: chosen; the shape of an example of ours.
const SIDE_MM: f64 = 102.4;
/// Height of the scan, mm. The part stands 4 mm above the bottom of the scan, so that air surrounds
/// it on every side. Source: chosen; the shape of an example of ours.
const HEIGHT_MM: f64 = 40.0;
/// Source: chosen; the shape of an example of ours.
const BOTTOM_MM: f64 = 4.0;
// Inner and outer radius of the rim, mm. The rim is the tallest part of the wheel, so its height is the
// height of the whole. The file of true dimensions is written from the constants of this module.
// Source: chosen; the shape of an example of ours.
const RIM_MM: [f64; 2] = [38.0, 46.0];
/// Source: chosen; the shape of an example of ours.
const RIM_HEIGHT_MM: f64 = 32.0;
/// Inner and outer radius of the hub, mm. Source: chosen; the shape of an example of ours.
const HUB_MM: [f64; 2] = [7.5, 15.0];
/// Source: chosen; the shape of an example of ours.
const HUB_HEIGHT_MM: f64 = 26.0;
/// Source: chosen; the shape of an example of ours.
const SPOKE_WIDTH_MM: f64 = 8.0;
/// Source: chosen; the shape of an example of ours.
const SPOKE_HEIGHT_MM: f64 = 12.0;
/// Source: chosen; the shape of an example of ours.
const BOLT_RADIUS_MM: f64 = 2.0;
/// Radius of the circle on which the bolt holes lie, mm: halfway between the hub's two radii.
/// Source: chosen; the shape of an example of ours.
const BOLT_CIRCLE_MM: f64 = 11.25;

/// Numbers of columns, rows and slices of a scan with `n` columns, and the edge of its voxels, mm.
pub(super) fn lattice(n: usize) -> ([usize; 3], f64) {
    let mm = SIDE_MM / n as f64;
    ([n, n, (HEIGHT_MM / mm).round() as usize], mm)
}

/// Depth of a point of the scan below the part's surface, mm; negative outside.
fn depth(p: DVec2, z: f64) -> f64 {
    let p = p - 0.5 * SIDE_MM;
    let (r, z) = (p.length(), z - BOTTOM_MM);
    // The depth in a union is the greatest depth of its bodies, after a cut the smallest. Near a face this is
    // the distance to the surface, near an edge a bound of it. That is enough: the blur reaches one voxel.
    let ring = |[inner, outer]: [f64; 2], height: f64| (outer - r).min(r - inner).min(height - z);
    let mut d = ring(RIM_MM, RIM_HEIGHT_MM).max(ring(HUB_MM, HUB_HEIGHT_MM));
    for k in 0..5 {
        let way = direction(f64::from(k) / 5.0 * TAU);
        let (along, aside) = (p.dot(way), cross(way, p).abs());
        // Spokes begin inside the hub and end inside the rim, so that the unions leave no gap.
        let spoke = (0.5 * SPOKE_WIDTH_MM - aside).min(along - 11.0).min(42.0 - along);
        d = d.max(spoke.min(SPOKE_HEIGHT_MM - z));
    }
    // Bolt holes lie between the spokes.
    for k in 0..5 {
        let bolt = direction((f64::from(k) + 0.5) / 5.0 * TAU) * BOLT_CIRCLE_MM;
        d = d.min(p.distance(bolt) - BOLT_RADIUS_MM);
    }
    d.min(z)
}

/// Slice `k` of the scan: air at 6000, metal at 40000, edges blurred over one voxel, noise of 400.
pub(super) fn slice(n: usize, k: usize) -> Vec<u16> {
    let (_, mm) = lattice(n);
    let z = (k as f64 + 0.5) * mm;
    let pixel = |p: usize| {
        let (i, j) = (p % n, p / n);
        let d = depth(DVec2::new(i as f64 + 0.5, j as f64 + 0.5) * mm, z) / (0.8 * mm);
        // A logistic curve approximates the integral of a Gaussian; with the factor 1.702 the greatest
        // difference is below 0.01. The clamp keeps the exponential finite.
        let share = 1.0 / (1.0 + exp(-1.702 * d.clamp(-20.0, 20.0)));
        (6000.0 + 34000.0 * share + 400.0 * noise(i, j, k)).clamp(0.0, 65535.0).round() as u16
    };
    (0..n * n).into_par_iter().with_min_len(n).map(pixel).collect()
}

/// Noise of standard deviation 1 that is the same on each run: the scaled sum of four hashed bytes.
fn noise(i: usize, j: usize, k: usize) -> f64 {
    let mut h = (i as u64) << 42 ^ (j as u64) << 21 ^ k as u64;
    // Source: `steele2014`, the increment and the first multiplier of SplitMix64.
    h = (h ^ h >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ h >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h ^= h >> 32;
    let sum: f64 = (0..4).map(|b| (h >> (8 * b) & 255) as f64 - 127.5).sum();
    // A uniform byte has a standard deviation of 73.9, the sum of four of them has twice that.
    sum / 147.8
}

/// True dimensions of the hub, as `shape.ct.truth` reads them.
pub(super) fn truth() -> String {
    let c = 0.5 * SIDE_MM;
    let circle = |name: &str, kind: &str, centre: [f64; 2], diameter: f64, z: f64| {
        format!(
            "[[dimension]]\nname = \"{name}\"\nkind = \"{kind}\"\ncentre_mm = [{:.6}, {:.6}]\ntrue_mm = {diameter:?}\nz_mm = {z:?}\n\n",
            centre[0], centre[1]
        )
    };
    let mut out = format!(
        "# True dimensions of the hub; heights are above its lowest point.\n\nmiddle_mm = [{c:?}, {c:?}]\n\n"
    );
    out += &circle("rim, outside", "outside", [c, c], 2.0 * RIM_MM[1], 20.0);
    out += &circle("rim, inside", "bore", [c, c], 2.0 * RIM_MM[0], 22.0);
    out += &circle("hub, outside", "outside", [c, c], 2.0 * HUB_MM[1], 20.0);
    out += &circle("bore, low", "bore", [c, c], 2.0 * HUB_MM[0], 4.0);
    out += &circle("bore, high", "bore", [c, c], 2.0 * HUB_MM[0], 22.0);
    for k in 0..5 {
        let at = direction((f64::from(k) + 0.5) / 5.0 * TAU) * BOLT_CIRCLE_MM + c;
        out += &circle(&format!("bolt hole {}", k + 1), "bore", [at.x, at.y], 2.0 * BOLT_RADIUS_MM, 18.0);
    }
    // The width of a spoke is measured between two points in air, each one width from the spoke's axis.
    for k in 0..5 {
        let way = direction(f64::from(k) / 5.0 * TAU);
        let aside = DVec2::new(-way.y, way.x) * SPOKE_WIDTH_MM;
        let (a, b) = (way * 26.0 + c - aside, way * 26.0 + c + aside);
        out += &format!(
            "[[dimension]]\nname = \"spoke {}, width\"\nkind = \"width\"\nfrom_mm = [{:.6}, {:.6}]\nto_mm = [{:.6}, {:.6}]\ntrue_mm = {SPOKE_WIDTH_MM:?}\nz_mm = 6.0\n\n",
            k + 1,
            a.x,
            a.y,
            b.x,
            b.y
        );
    }
    out + &format!("[[dimension]]\nname = \"height\"\nkind = \"height\"\ntrue_mm = {RIM_HEIGHT_MM:?}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scan_is_of_air_and_metal_and_its_truth_can_be_read() {
        let ([n, _, slices], mm) = lattice(64);
        assert_eq!((n, slices), (64, 25));
        let values = slice(64, 8);
        let metal = values.iter().filter(|v| **v > 23000).count() as f64 * mm * mm;
        assert!((2000.0..4000.0).contains(&metal), "{metal} mm2 of metal");
        assert!(slice(64, 0).iter().all(|v| *v < 10000), "air below");
        let all = grainpath::measure::dimensions::parse(&truth(), "truth.toml").expect("its own truth");
        assert_eq!(all.len(), 16);
    }
}
