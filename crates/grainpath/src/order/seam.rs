//! Chooses the seam of closed outer walls, the point where they start and end.
//!
//! A seam leaves a visible mark, so the user chooses its place: nearest to the nozzle, at the rear,
//! at random, or aligned with the seam in the layer below. Coordinates are in mm. Cost: linear in the
//! vertices of the wall; for aligned seams also in the seams of the layer below.

use grainpath_core::math::{atan2, cross};
use grainpath_core::{DVec2, Toolpath};
use grainpath_job::choices::Seam;

/// Finds seams layer by layer.
pub(super) struct Seams {
    rule: Seam,
    layer_idx: usize,
    n_walls: usize,
    /// Seams of the layer below; `here` holds those of this layer so far.
    below: Vec<DVec2>,
    here: Vec<DVec2>,
}

/// A seam follows the one below if a vertex of the wall lies within this distance of it, mm.
const FOLLOW_MM: f64 = 3.0;

impl Seams {
    pub(super) fn new(rule: Seam) -> Self {
        Self { rule, layer_idx: 0, n_walls: 0, below: Vec::new(), here: Vec::new() }
    }

    pub(super) fn next_layer(&mut self, layer_idx: usize) {
        self.layer_idx = layer_idx;
        self.n_walls = 0;
        self.below = std::mem::take(&mut self.here);
    }

    /// Chooses the seam of an outer wall and lets the wall start there. `at` is the nozzle's position.
    pub(super) fn place(&mut self, wall: &mut Toolpath, at: DVec2) {
        self.n_walls += 1;
        let points = &wall.points;
        let best = |score: &dyn Fn(usize) -> f64| {
            (0..points.len()).map(|i| (score(i), i)).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |b| b.1)
        };
        let start = match self.rule {
            Seam::Nearest => best(&|i| points[i].distance_squared(at)),
            Seam::Rear => best(&|i| -points[i].y),
            Seam::Random => {
                // A hash of layer and wall is used instead of a random generator, so that a seam does
                // not depend on which layers were planned before.
                (hash(self.layer_idx as u64, self.n_walls as u64) % points.len().max(1) as u64) as usize
            }
            Seam::Aligned => {
                let near =
                    |p: DVec2| self.below.iter().map(|b| b.distance_squared(p)).fold(f64::INFINITY, f64::min);
                let follow = best(&|i| near(points[i]));
                if near(points[follow]) < FOLLOW_MM * FOLLOW_MM {
                    follow
                } else {
                    // Without a seam below, the sharpest corner is taken, because it hides the seam best. The
                    // small term in y prefers the rearmost of equal corners.
                    best(&|i| -corner(points, i).abs() - 1e-3 * points[i].y)
                }
            }
        };
        wall.rotate_to(start);
        if self.rule == Seam::Aligned {
            self.here.push(wall.start());
        }
    }
}

/// The angle by which the wall turns at a vertex, radians, positive to the left.
fn corner(points: &[DVec2], i: usize) -> f64 {
    let n = points.len();
    let (u, v) = (points[i] - points[(i + n - 1) % n], points[(i + 1) % n] - points[i]);
    atan2(cross(u, v), u.dot(v))
}

fn hash(a: u64, b: u64) -> u64 {
    let mut h = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    for _ in 0..3 {
        h ^= h >> 31;
        h = h.wrapping_mul(0xd6e8_feb8_6659_fd93);
    }
    h ^ h >> 32
}
