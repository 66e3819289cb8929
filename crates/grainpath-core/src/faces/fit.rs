//! Fits spheres, cylinders and cones to points by least squares.
//!
//! Cylinder and cone share one form: a radius `r + s t` at the length `t` along the axis, measured from a
//! point of the axis, with `s = 0` for a cylinder. This form stays well conditioned for slender cones, whose
//! apex is far away. Levenberg and Marquardt's steps (`more1978`) minimise the distances of the
//! points; they start from an axis found from the normals and a linear fit of circles.

use glam::DVec3;

use crate::dense::solve_spd;
use crate::math::atan;
use crate::tensor::principal;

/// A curved surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Model {
    /// Centre and radius.
    Sphere(DVec3, f64),
    /// Cylinder (slope 0) or cone: radius `radius + slope * t` at `point + t * axis`.
    Turned {
        /// A point of the axis.
        point: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Radius at the point.
        radius: f64,
        /// Growth of the radius along the axis.
        slope: f64,
    },
}

/// The kinds of model to try.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// Four unknowns.
    Sphere,
    /// Five unknowns.
    Cylinder,
    /// Six unknowns.
    Cone,
}

/// Greatest number of steps of a fit. Source: derived: near the solution steps converge quadratically; a fit that has
/// not converged after 12 steps started too far away.
const STEPS: usize = 12;

impl Model {
    /// Signed distance of a point from the surface, positive outside.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        match *self {
            Self::Sphere(centre, radius) => p.distance(centre) - radius,
            Self::Turned { point, axis, radius, slope } => {
                let v = p - point;
                let t = v.dot(axis);
                ((v - t * axis).length() - (radius + slope * t)) / (1.0 + slope * slope).sqrt()
            }
        }
    }

    /// Unit normal of the surface near a point, pointing outwards.
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        match *self {
            Self::Sphere(centre, _) => (p - centre).normalize_or_zero(),
            Self::Turned { point, axis, slope, .. } => {
                let v = p - point;
                ((v - v.dot(axis) * axis).normalize_or_zero() - slope * axis).normalize_or_zero()
            }
        }
    }

    /// Radius at a point of the surface.
    pub(super) fn radius_at(&self, p: DVec3) -> f64 {
        match *self {
            Self::Sphere(_, radius) => radius,
            Self::Turned { point, axis, radius, slope } => radius + slope * (p - point).dot(axis),
        }
    }

    /// Half the opening angle of a cone; 0 for other models.
    pub(super) fn half_angle(&self) -> f64 {
        match *self {
            Self::Sphere(..) => 0.0,
            Self::Turned { slope, .. } => atan(slope),
        }
    }

    /// Fits a model of this kind to points. `normals` holds normals of the surface, each with its area as
    /// weight. `None` if the points do not determine a model.
    pub(super) fn fitted(shape: Shape, points: &[DVec3], normals: &[(DVec3, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let middle = points.iter().sum::<DVec3>() / n;
        let size = points.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
        // The points are shifted to their middle and scaled to size 1, so that the normal equations are well scaled.
        let scaled: Vec<DVec3> = points.iter().map(|p| (*p - middle) / size).collect();
        let fit = match shape {
            Shape::Sphere => sphere(&scaled),
            Shape::Cylinder => turned(&scaled, spread(normals, false), false),
            Shape::Cone => {
                let all = [spread(normals, true), spread(normals, false)];
                let fits = all.into_iter().filter_map(|axis| turned(&scaled, axis, true));
                fits.min_by(|a, b| a.worst(&scaled).total_cmp(&b.worst(&scaled)))
            }
        }?;
        Some(match fit {
            Self::Sphere(c, r) => Self::Sphere(middle + size * c, size * r),
            Self::Turned { point, axis, radius, slope } => {
                Self::Turned { point: middle + size * point, axis, radius: size * radius, slope }
            }
        })
    }

    /// Greatest distance of a point from the surface.
    pub(super) fn worst(&self, points: &[DVec3]) -> f64 {
        points.iter().map(|p| self.distance(*p).abs()).fold(0.0, f64::max)
    }
}

/// The direction in which the normals vary least: about their mean if `centred`, otherwise about zero.
fn spread(normals: &[(DVec3, f64)], centred: bool) -> DVec3 {
    let total: f64 = normals.iter().map(|n| n.1).sum();
    let mean = normals.iter().map(|(n, w)| *n * *w).sum::<DVec3>() / total;
    let about = if centred { mean } else { DVec3::ZERO };
    let mut s = [0.0; 6];
    for (n, w) in normals {
        let d = *n - about;
        let products = [d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.z * d.x];
        s.iter_mut().zip(products).for_each(|(s, p)| *s += w / total * p);
    }
    principal(&s).axes[2]
}

/// The sphere from a linear fit of `|p|² = 2 c·p + k` with the centre `c`.
fn sphere(points: &[DVec3]) -> Option<Model> {
    let (mut m, mut b) = ([[0.0; 4]; 4], [[0.0]; 4]);
    for p in points {
        add(&mut m, &mut b, [2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0], p.length_squared());
    }
    let [[x], [y], [z], [k]] = solve_spd(m, b);
    let centre = DVec3::new(x, y, z);
    let r2 = k + centre.length_squared();
    (r2 > 0.0 && r2.is_finite()).then(|| Model::Sphere(centre, r2.sqrt()))
}

fn add<const N: usize>(m: &mut [[f64; N]; N], b: &mut [[f64; 1]; N], row: [f64; N], value: f64) {
    for i in 0..N {
        (0..N).for_each(|j| m[i][j] += row[i] * row[j]);
        b[i][0] += row[i] * value;
    }
}

/// Fits a cylinder, or a cone if `tapered`; `axis` is the first estimate of its axis.
fn turned(points: &[DVec3], axis: DVec3, tapered: bool) -> Option<Model> {
    let (e1, e2) = axis.any_orthonormal_pair();
    // The squared distances from the axis of a cone give an equation linear in the position `c` of the axis:
    // x² + y² = 2 c·(x, y) + k0 + k1 t + k2 t².
    let (mut m, mut b) = ([[0.0; 5]; 5], [[0.0]; 5]);
    for p in points {
        let (x, y, t) = (p.dot(e1), p.dot(e2), p.dot(axis));
        let taper = if tapered { [t, t * t] } else { [0.0; 2] };
        add(&mut m, &mut b, [2.0 * x, 2.0 * y, 1.0, taper[0], taper[1]], x * x + y * y);
    }
    let [[x], [y], [k0], [k1], _] = solve_spd(m, b);
    let radius = (k0 + x * x + y * y).max(0.0).sqrt();
    if !(radius > 0.0 && radius.is_finite()) {
        return None;
    }
    let slope = if tapered { 0.5 * k1 / radius } else { 0.0 };
    let mut best = (x * e1 + y * e2, axis, radius, slope);
    let mut cost = squares(points, best);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let next = step(points, best, tapered, damping);
        let lower = squares(points, next);
        if lower < cost {
            let done = cost - lower <= 1e-6 * cost;
            (best, cost, damping) = (next, lower, 0.1 * damping);
            if done {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    let (point, axis, radius, slope) = best;
    // If the radius is far above the size of the points, they lie on a plane.
    let is_curved = radius.is_finite() && radius > 0.0 && radius < 1e4 && slope.abs() < 20.0;
    is_curved.then_some(Model::Turned { point, axis, radius, slope })
}

type Turned = (DVec3, DVec3, f64, f64);

fn squares(points: &[DVec3], (point, axis, radius, slope): Turned) -> f64 {
    let model = Model::Turned { point, axis, radius, slope };
    points.iter().map(|p| model.distance(*p).powi(2)).sum()
}

fn step(points: &[DVec3], (point, axis, radius, slope): Turned, tapered: bool, damping: f64) -> Turned {
    let (e1, e2) = axis.any_orthonormal_pair();
    let (mut m, mut b) = ([[0.0; 6]; 6], [[0.0]; 6]);
    for p in points {
        let v = *p - point;
        let t = v.dot(axis);
        let q = v - t * axis;
        let d = q.length();
        let q = q.normalize_or_zero();
        // Derivatives of d - (radius + slope t) with respect to the rotation of the axis towards e1 and e2,
        // the shift of its point along e1 and e2, the radius and the slope.
        let arm = t + slope * d;
        let taper = if tapered { -t } else { 0.0 };
        let row = [-q.dot(e1) * arm, -q.dot(e2) * arm, -q.dot(e1), -q.dot(e2), -1.0, taper];
        add(&mut m, &mut b, row, -(d - radius - slope * t));
    }
    let trace: f64 = (0..6).map(|i| m[i][i]).sum();
    (0..6).for_each(|i| m[i][i] += damping * (m[i][i] + 1e-9 * trace));
    let x = solve_spd(m, b);
    let turned = (axis + x[0][0] * e1 + x[1][0] * e2).normalize_or(axis);
    let slope = if tapered { slope + x[5][0] } else { 0.0 };
    (point + x[2][0] * e1 + x[3][0] * e2, turned, radius + x[4][0], slope)
}
