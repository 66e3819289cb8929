//! The thickness of a part's walls, measured by rays from its surface inwards.
//!
//! Method: our own. Four thousand points are spread evenly over the area: at equal steps of area from facet
//! to facet, and within a facet by the R2 sequence (`roberts2018`). From each a ray runs inwards along the
//! normal. It finds a wall if the first facet that it meets faces back, within about 45 degrees of parallel.
//! Walls are judged by the volume that they hold: a point that stands for the area `A` of a wall `t` thick
//! stands for `A t / 2` of the material, because the wall is seen from both sides. Sheets without thickness
//! and the tips of wedges hold next to no volume, and so have no weight. The thickness reported is that which
//! all but two percent exceed, by surface or by volume, whichever is more.
//!
//! Lengths are in mm, areas in mm2, volumes in mm3. Cost: one ray for each of 4000 points, whatever the size
//! of the mesh; a share of two percent is known to about a ninth of itself. The thickness at one point is
//! measured by two rays, one through the wall and one across the gap outside.
//!
//! Degenerate cases: a surface without area, or with an area that is not finite, has no walls and an infinite
//! thickness. Facets without area get no points.

use grainpath_core::{Bvh, DVec3, TriMesh};
use rayon::prelude::*;

/// Number of points on the surface. Source: derived: a share of two percent rests on 80 of them, so
/// it is known to 1 / sqrt 80, about a ninth.
const SAMPLES: usize = 4000;
/// Share of the surface, and of the volume, that may be thinner than the reported thickness: tips
/// of wedges, engraved marks.
const THIN_SHARE: f64 = 0.02;
/// Walls that hold less than this share of the volume are sheets without thickness. Source:
/// derived: two percent of the surface hold so little volume only if they are 20 000 times thinner than
/// the mean of the part, twice its volume over its surface.
const SHEET_SHARE: f64 = 1e-6;
/// A facet faces back if the cosine between the two normals is below this. Source: derived: the sides of a
/// wall are within 45 degrees of parallel, those of a sharper wedge meet.
const FACES_BACK_COS: f64 = -0.7;
/// The same for the thickness at one point, where a single ray decides. Source: derived: within 25 degrees
/// of parallel the ray is at most a tenth longer than the wall is thick.
const PARALLEL_COS: f64 = -0.9;

/// Walls found by rays: thickness and middle point, thinnest first.
pub(super) struct MeasuredWalls {
    found: Vec<(f64, DVec3)>,
    /// Area that a sample stands for, mm2.
    sample_mm2: f64,
    n_samples: usize,
    /// Volume within the surface, mm3.
    volume_mm3: f64,
}

impl MeasuredWalls {
    /// The thickness, mm, that the walls of all but two percent of the surface exceed; the element
    /// size is chosen from it. Where sheets without thickness make up that much of the surface, it
    /// is `bulk_thickness_mm`. Infinite for a surface without opposite sides.
    pub(super) fn thickness_mm(&self) -> f64 {
        let rank = (THIN_SHARE * self.n_samples as f64) as usize;
        let held: f64 = self.found.iter().take(rank + 1).map(|wall| self.share_of_volume(wall.0)).sum();
        if held < SHEET_SHARE {
            return self.bulk_thickness_mm();
        }
        self.found.get(rank).map_or(f64::INFINITY, |wall| wall.0)
    }

    /// The thickness that the walls of all but two percent of the volume exceed, mm.
    fn bulk_thickness_mm(&self) -> f64 {
        let mut held = 0.0;
        let mut thin_enough = self.found.iter().skip_while(|wall| {
            held += self.share_of_volume(wall.0);
            held <= THIN_SHARE
        });
        thin_enough.next().map_or(f64::INFINITY, |wall| wall.0)
    }

    /// Share of the volume that a sample of a wall stands for.
    fn share_of_volume(&self, thickness_mm: f64) -> f64 {
        0.5 * thickness_mm * self.sample_mm2 / self.volume_mm3.max(f64::MIN_POSITIVE)
    }

    /// The thickness that the cells have to resolve, mm: the larger of the thicknesses by surface
    /// and by volume.
    pub(super) fn decisive_thickness_mm(&self) -> f64 {
        self.thickness_mm().max(self.bulk_thickness_mm())
    }

    /// Share of the surface that `n` samples stand for.
    pub(super) fn share_of_surface(&self, n: usize) -> f64 {
        n as f64 / self.n_samples.max(1) as f64
    }

    /// Middles of the walls thinner than `thickness_mm`, each with the share of the volume that it
    /// stands for.
    pub(super) fn middles_under(&self, thickness_mm: f64) -> impl Iterator<Item = (DVec3, f64)> {
        let thin = self.found.iter().take_while(move |w| w.0 < thickness_mm);
        thin.map(|w| (w.1, self.share_of_volume(w.0)))
    }
}

/// Measures walls where the ray inwards meets a facet that faces back.
pub(super) fn walls(mesh: &TriMesh, bvh: &Bvh) -> MeasuredWalls {
    let corners = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
    let area_normal = |t: &[u32; 3]| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a) * 0.5
    };
    let total: f64 = mesh.triangles.iter().map(|t| area_normal(t).length()).sum();
    let Some((lo, hi)) = mesh.bounds().filter(|_| total > 0.0 && total.is_finite()) else {
        return MeasuredWalls { found: Vec::new(), sample_mm2: 0.0, n_samples: 0, volume_mm3: 0.0 };
    };
    let skin = 1e-7 * (hi - lo).length();
    // Points at equal steps of area. Within a facet they follow the R2 low-discrepancy sequence,
    // whose constants are the inverse powers of the plastic number (`roberts2018`).
    let mut picks = Vec::with_capacity(SAMPLES);
    let (mut seen, step) = (0.0, total / SAMPLES as f64);
    for t in &mesh.triangles {
        seen += area_normal(t).length();
        while picks.len() < SAMPLES && (picks.len() as f64 + 0.5) * step < seen {
            let k = picks.len() as f64;
            let (mut u, mut v) = ((k * 0.754_877_666).fract(), (k * 0.569_840_291).fract());
            // Points beyond the diagonal are mirrored into the triangle, which keeps the density
            // even.
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = corners(t);
            picks.push((a + (b - a) * u + (c - a) * v, area_normal(t).normalize_or_zero()));
        }
    }
    let through = |&(p, normal): &(DVec3, DVec3)| {
        // The ray starts below the surface by a ten-millionth of the size, so that it does not meet
        // its own facet.
        let hit = bvh.first_hit(p - normal * skin, -normal, (0.0, f64::INFINITY))?;
        let faces_back = area_normal(&mesh.triangles[hit.triangle as usize]).normalize_or_zero().dot(normal);
        let wall = (hit.t + skin, p - normal * (0.5 * hit.t));
        (hit.leaves && faces_back < FACES_BACK_COS).then_some(wall)
    };
    let mut found: Vec<(f64, DVec3)> = picks.par_iter().filter_map(through).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sample_mm2 = total / picks.len().max(1) as f64;
    MeasuredWalls { found, sample_mm2, n_samples: picks.len(), volume_mm3: mesh.signed_volume().abs() }
}

/// The thinner of wall and gap at a point of a facet, mm; `None` where neither ray meets a facet
/// that faces back.
pub(super) fn least_at(mesh: &TriMesh, bvh: &Bvh, p: DVec3, facet: u32) -> Option<f64> {
    let normal = |facet: u32| mesh.normal(mesh.triangles[facet as usize]);
    let out = normal(facet);
    let skin = 1e-7 * p.abs().max_element().max(1.0);
    let across = |along: DVec3, leaves: bool| {
        let hit = bvh.first_hit(p + along * skin, along, (0.0, f64::INFINITY))?;
        // The sides of a wedge have no thickness; those of a wall are nearly parallel.
        let is_wall = hit.leaves == leaves && normal(hit.triangle).dot(out) < PARALLEL_COS;
        is_wall.then_some(hit.t + skin)
    };
    [across(-out, true), across(out, false)].into_iter().flatten().reduce(f64::min)
}
