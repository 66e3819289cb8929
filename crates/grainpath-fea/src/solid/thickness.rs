//! How thin a part gets, measured by rays from its surface inwards.

use grainpath_core::{Bvh, DVec3, TriMesh};
use rayon::prelude::*;

const SAMPLES: usize = 4000;
/// Share of the surface that may be thinner than what is reported: tips of wedges, engraved marks.
const QUANTILE: f64 = 0.02;

/// The wall thickness that all but two percent of the surface have at least, mm; infinite for a surface without
/// opposite sides. A wall is measured where the way in meets a facet that faces back.
pub fn wall_thickness_mm(mesh: &TriMesh, bvh: &Bvh) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
    let area_normal = |t: &[u32; 3]| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a) * 0.5
    };
    let total: f64 = mesh.triangles.iter().map(|t| area_normal(t).length()).sum();
    let Some((lo, hi)) = mesh.bounds().filter(|_| total > 0.0 && total.is_finite()) else {
        return f64::INFINITY;
    };
    let skin = 1e-7 * (hi - lo).length();
    // Facets hit by equal steps of area, each sampled inside by a low-discrepancy pair.
    let mut picks = Vec::with_capacity(SAMPLES);
    let (mut seen, step) = (0.0, total / SAMPLES as f64);
    for t in &mesh.triangles {
        seen += area_normal(t).length();
        while picks.len() < SAMPLES && (picks.len() as f64 + 0.5) * step < seen {
            let k = picks.len() as f64;
            let (mut u, mut v) = ((k * 0.754_877_666).fract(), (k * 0.569_840_291).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = corners(t);
            picks.push((a + (b - a) * u + (c - a) * v, area_normal(t).normalize_or_zero()));
        }
    }
    let through = |&(p, normal): &(DVec3, DVec3)| {
        let hit = bvh.first_hit(p - normal * skin, -normal, (0.0, f64::INFINITY))?;
        let faces_back = area_normal(&mesh.triangles[hit.triangle as usize]).normalize_or_zero().dot(normal);
        (hit.leaves && faces_back < -0.7).then_some(hit.t + skin)
    };
    let mut found: Vec<f64> = picks.par_iter().filter_map(through).collect();
    found.sort_unstable_by(f64::total_cmp);
    let rank = (QUANTILE * picks.len() as f64) as usize;
    found.get(rank).copied().unwrap_or(f64::INFINITY)
}
