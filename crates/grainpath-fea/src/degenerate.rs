//! Finds degenerate points, where both principal stresses are equal.
//!
//! At such a point all directions are equally good. On a walk around it the principal lines make half a turn: in
//! the sense of the walk at a *wedge* (index +1/2), against it at a *trisector* (index -1/2)
//! (`Delmarcelle1994`). On a free border the stress across it is zero, so a point where the stress along it
//! changes sign is degenerate too.
//!
//! Method: the deviator (half the difference of the normal stresses, and the shear stress) is linear inside
//! an element. It has a zero there if its values at the three corners surround the origin, and their sense
//! of rotation gives the index. Pairs of a wedge and a trisector within a few cells of each other come and
//! go with the noise of the solution, so they are removed.
//!
//! Units: MPa, mm. Limits: stresses below `NOISE` of the greatest count as zero. Tests check linear
//! fields, Kirsch's hole (four points on its edge) and a ring. Cost: linear in the elements.

use grainpath_core::field_mesh::FieldMesh;
use grainpath_core::math::cross;
use grainpath_core::poly::{LineClipper, edges};
use grainpath_core::{DVec2, Region};

use crate::plane::PlaneStress;
use crate::principal::{PlaneTensor, von_mises_plane};

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
    /// Kind and position, mm.
    pub points: Vec<(Degenerate, DVec2)>,
}

impl Degenerates {
    /// Number of points of a kind.
    pub fn count(&self, kind: Degenerate) -> usize {
        self.points.iter().filter(|p| p.0 == kind).count()
    }
}

/// Stresses below this share of the greatest count as noise. Measured: away from corners, the recovered
/// stresses of the test plates have errors of about this share (docs/verification.md).
const NOISE: f64 = 5e-3;

/// Finds the degenerate points of a plate. Inside elements they follow from the stress at the corners. On
/// the border they lie where the stress along it changes sign and the stress across it is zero.
pub fn degenerate_points(stress: &PlaneStress) -> Degenerates {
    let mesh = stress.mesh();
    let nodal = stress.nodal_mpa();
    let greatest = stress.max_von_mises_mpa();
    let deviator = |i: u32| deviator(nodal[i as usize]);
    let mut points = Vec::new();
    for e in &mesh.elements {
        let corners = [e[0], e[1], e[2]];
        // If all corners are nearly free of stress, a zero of the deviator is noise.
        let strong = corners.iter().any(|&i| von_mises_plane(nodal[i as usize]) > NOISE * greatest);
        if let Some((kind, s, t)) = within(corners.map(deviator), greatest).filter(|_| strong) {
            let p = corners.map(|i| mesh.nodes[i as usize]);
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
        // On a free border the stress across is zero, except for the error of recovery, which grows with
        // the gradient along the border.
        let free = across.abs().max(other.abs()) < 0.25 * change + NOISE * greatest;
        if first * second < 0.0 && free && change > NOISE * greatest {
            points.push((Degenerate::Border, p.lerp(q, first / (first - second))));
        }
    }
    Degenerates { points }
}

fn deviator([xx, yy, xy]: PlaneTensor) -> DVec2 {
    DVec2::new(0.5 * (xx - yy), xy)
}

/// The point of a counter-clockwise triangle where the deviator is zero, from its values at the corners,
/// MPa. Returned as the shares of the second and the third corner.
fn within(d: [DVec2; 3], greatest_mpa: f64) -> Option<(Degenerate, f64, f64)> {
    let (u, v) = (d[1] - d[0], d[2] - d[0]);
    let det = cross(u, v);
    // With nearly parallel deviators the position of a zero is uncertain.
    if det.abs() < (1e-3 * greatest_mpa).powi(2) * 1e-3 {
        return None;
    }
    let (s, t) = (cross(v, d[0]) / det, cross(d[0], u) / det);
    let kind = if det > 0.0 { Degenerate::Wedge } else { Degenerate::Trisector };
    (s > 0.0 && t > 0.0 && s + t < 1.0).then_some((kind, s, t))
}

/// A wedge and a trisector nearer to each other than this number of cells are both removed. Such pairs come
/// and go with the noise of the stress, and no bead can follow them.
const PAIR_CELLS: f64 = 4.0;
/// Stress along a border below this share of the greatest stress has no certain sign.
const BORDER_NOISE: f64 = 0.02;

/// The degenerate points of a section of a solid: inside the section from the in-plane stress at the nodes
/// of a grid, and along its free border from the stress that `at` gives.
pub fn of_section(
    grid: &FieldMesh,
    nodal_mpa: &[PlaneTensor],
    region: &Region,
    at: &dyn Fn(DVec2) -> PlaneTensor,
    free: &dyn Fn(DVec2) -> bool,
) -> Degenerates {
    let inside = LineClipper::new(region);
    let mises = |i: u32| von_mises_plane(nodal_mpa[i as usize]);
    // The grid reaches beyond the section; stress there is extrapolated and does not count.
    let own = (0..grid.nodes.len() as u32).filter(|&i| inside.contains(grid.nodes[i as usize]));
    let greatest = own.map(mises).fold(0.0, f64::max);
    let mut points = Vec::new();
    for triangle in &grid.triangles {
        let mut corners = triangle.corners;
        let mut p = corners.map(|i| grid.nodes[i as usize]);
        // Triangles of the grid have either sense of rotation, and the sign of the index depends on
        // it.
        if cross(p[1] - p[0], p[2] - p[0]) < 0.0 {
            corners.swap(1, 2);
            p.swap(1, 2);
        }
        if !corners.iter().any(|&i| mises(i) > NOISE * greatest) {
            continue;
        }
        let found = within(corners.map(|i| deviator(nodal_mpa[i as usize])), greatest);
        let place = found.map(|(kind, s, t)| (kind, p[0] + s * (p[1] - p[0]) + t * (p[2] - p[0])));
        points.extend(place.filter(|(_, q)| inside.contains(*q)));
    }
    annul_pairs(&mut points, PAIR_CELLS * grid.cell_mm);
    for contour in region.contours() {
        let mut along: Vec<(DVec2, f64)> = Vec::new();
        for (a, b) in edges(contour) {
            let t = (b - a).normalize_or(DVec2::X);
            let steps = (a.distance(b) / grid.cell_mm).ceil().max(1.0);
            for k in 0..steps as usize {
                let p = a.lerp(b, (k as f64 + 0.5) / steps);
                let [xx, yy, xy] = at(p);
                let stress = xx * t.x * t.x + yy * t.y * t.y + 2.0 * xy * t.x * t.y;
                along.push((p, if free(p) { stress } else { f64::NAN }));
            }
        }
        // The loop goes once around the contour and starts with the last sign that is certain. Held or
        // loaded parts of the border have no sign.
        let clear = |v: f64| v.abs() > BORDER_NOISE * greatest;
        let mut last = along.iter().rposition(|a| clear(a.1)).map(|i| along[i]);
        for &(p, v) in &along {
            if v.is_nan() {
                last = None;
            } else if clear(v) {
                if let Some((q, w)) = last.filter(|l| l.1 * v < 0.0) {
                    points.push((Degenerate::Border, q.lerp(p, w / (w - v))));
                }
                last = Some((p, v));
            }
        }
    }
    Degenerates { points }
}

/// Removes pairs of a wedge and a trisector within reach of each other, the nearest pairs first.
fn annul_pairs(points: &mut Vec<(Degenerate, DVec2)>, reach_mm: f64) {
    let mut pairs = Vec::new();
    for (i, (kind, p)) in points.iter().enumerate() {
        for (j, (other, q)) in points.iter().enumerate().skip(i + 1) {
            if kind != other && p.distance(*q) < reach_mm {
                pairs.push((p.distance(*q), i, j));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut gone = vec![false; points.len()];
    for (_, i, j) in pairs {
        if !gone[i] && !gone[j] {
            (gone[i], gone[j]) = (true, true);
        }
    }
    let mut keep = gone.iter().map(|g| !g);
    points.retain(|_| keep.next().unwrap_or(true));
}
