//! Where both principal stresses are equal: there no direction is better than another, and around it lines turn.

use grainpath_core::DVec2;
use grainpath_core::math::cross;
use grainpath_fea::plane::PlaneStress;
use grainpath_fea::principal::von_mises_plane;

/// Kinds of degenerate points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Degenerate {
    /// Index +1/2: lines turn around it.
    Wedge,
    /// Index -1/2: lines part in three ways.
    Trisector,
    /// On a free border, where the stress along it changes sign.
    Border,
}

/// Degenerate points of a section.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Degenerates {
    /// What and where, mm.
    pub points: Vec<(Degenerate, DVec2)>,
}

impl Degenerates {
    /// How many there are of a kind.
    pub fn count(&self, kind: Degenerate) -> usize {
        self.points.iter().filter(|p| p.0 == kind).count()
    }
}

/// Stress below this share of the greatest is noise.
const NOISE: f64 = 5e-3;

/// Finds the degenerate points: inside elements from the stress at their corners, and on the border where the stress
/// along it passes zero while that across it is zero already.
pub fn degenerate_points(stress: &PlaneStress) -> Degenerates {
    let mesh = stress.mesh();
    let nodal = stress.nodal_mpa();
    let greatest = stress.max_von_mises_mpa();
    let deviator = |i: u32| {
        let [xx, yy, xy] = nodal[i as usize];
        DVec2::new(0.5 * (xx - yy), xy)
    };
    let mut points = Vec::new();
    for e in &mesh.elements {
        let d = [e[0], e[1], e[2]].map(deviator);
        let strong =
            [e[0], e[1], e[2]].iter().any(|&i| von_mises_plane(nodal[i as usize]) > NOISE * greatest);
        let (u, v) = (d[1] - d[0], d[2] - d[0]);
        let det = cross(u, v);
        if !strong || det.abs() < (1e-3 * greatest).powi(2) * 1e-3 {
            continue;
        }
        let (s, t) = (cross(v, d[0]) / det, cross(d[0], u) / det);
        if s > 0.0 && t > 0.0 && s + t < 1.0 {
            let p = [e[0], e[1], e[2]].map(|i| mesh.nodes[i as usize]);
            let kind = if det > 0.0 { Degenerate::Wedge } else { Degenerate::Trisector };
            points.push((kind, p[0] + s * (p[1] - p[0]) + t * (p[2] - p[0])));
        }
    }
    for &[a, b, _] in &mesh.border {
        let [p, q] = [a, b].map(|i| mesh.nodes[i as usize]);
        let t = (q - p).normalize_or(DVec2::X);
        let parts = |i: u32| {
            let [xx, yy, xy] = nodal[i as usize];
            let along = xx * t.x * t.x + yy * t.y * t.y + 2.0 * xy * t.x * t.y;
            (along, xx + yy - along)
        };
        let ((first, across), (second, other)) = (parts(a), parts(b));
        let change = (first - second).abs();
        let free = across.abs().max(other.abs()) < 0.25 * change + NOISE * greatest;
        if first * second < 0.0 && free && change > NOISE * greatest {
            points.push((Degenerate::Border, p.lerp(q, first / (first - second))));
        }
    }
    Degenerates { points }
}
