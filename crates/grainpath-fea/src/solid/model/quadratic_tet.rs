//! The ten-node tetrahedron: shape functions, quadrature, stiffness and material law.
//!
//! Nodes: four corners, then the middles of the edges in the order of `EDGES`. Barycentric
//! coordinates `l` add up to 1. Stresses are in MPa.

use grainpath_core::{DMat3, DVec3};

use super::tet_shape::EDGES;
use crate::material::Stiffness;

/// A point of a quadrature rule: barycentric coordinates and weight; the weights add up to one
/// sixth.
pub(crate) type Point = ([f64; 4], f64);

/// Quadrature with four points, exact for degree 2: enough for the stiffness of straight-sided
/// elements. Source: `hammer1956`.
pub(crate) const STIFFNESS_RULE: [Point; 4] = {
    // Source: `hammer1956`: (5 + 3 sqrt 5) / 20.
    const A: f64 = 0.585_410_196_624_968_5;
    // Source: `hammer1956`: (5 - sqrt 5) / 20.
    const B: f64 = 0.138_196_601_125_010_5;
    // Source: `hammer1956`: four equal weights of the volume 1/6.
    const W: f64 = 1.0 / 24.0;
    [([A, B, B, B], W), ([B, A, B, B], W), ([B, B, A, B], W), ([B, B, B, A], W)]
};

/// Quadrature with fifteen points, exact for degree 5. Source: `keast1986`.
pub(crate) const FINE_RULE: [Point; 15] = {
    // Source: `keast1986`: the centroids of the faces.
    const T: f64 = 1.0 / 3.0;
    // Source: `keast1986`: points between the centroid and the corners.
    const E: f64 = 1.0 / 11.0;
    // Source: `keast1986`: 1 - 3 / 11.
    const F: f64 = 8.0 / 11.0;
    // Source: `keast1986`: points between the centroid and the middles of the edges.
    const A: f64 = 0.066_550_153_573_664_3;
    // Source: `keast1986`: 1/2 less the coordinate above.
    const B: f64 = 0.433_449_846_426_335_7;
    // Source: `keast1986`: weight of the centroid.
    const W0: f64 = 0.030_283_678_097_089;
    // Source: `keast1986`: weight of the faces' centroids.
    const W1: f64 = 0.006_026_785_714_286;
    // Source: `keast1986`: weight of the points towards the corners.
    const W2: f64 = 0.011_645_249_086_029;
    // Source: `keast1986`: weight of the points towards the edges.
    const W3: f64 = 0.010_949_141_561_386;
    [
        ([0.25; 4], W0),
        ([0.0, T, T, T], W1),
        ([T, 0.0, T, T], W1),
        ([T, T, 0.0, T], W1),
        ([T, T, T, 0.0], W1),
        ([F, E, E, E], W2),
        ([E, F, E, E], W2),
        ([E, E, F, E], W2),
        ([E, E, E, F], W2),
        ([A, A, B, B], W3),
        ([A, B, A, B], W3),
        ([A, B, B, A], W3),
        ([B, A, A, B], W3),
        ([B, A, B, A], W3),
        ([B, B, A, A], W3),
    ]
};

/// Values of the ten shape functions.
pub(crate) fn shapes(l: &[f64; 4]) -> [f64; 10] {
    std::array::from_fn(|a| match a {
        0..4 => l[a] * (2.0 * l[a] - 1.0),
        _ => {
            let (i, j) = EDGES[a - 4];
            4.0 * l[i] * l[j]
        }
    })
}

/// Derivatives of the ten shape functions with respect to the last three barycentric coordinates;
/// the first is 1 minus their sum.
pub(crate) fn shape_slopes(l: &[f64; 4]) -> [DVec3; 10] {
    const BY: [DVec3; 4] = [DVec3::NEG_ONE, DVec3::X, DVec3::Y, DVec3::Z];
    std::array::from_fn(|a| match a {
        0..4 => BY[a] * (4.0 * l[a] - 1.0),
        _ => {
            let (i, j) = EDGES[a - 4];
            4.0 * (l[i] * BY[j] + l[j] * BY[i])
        }
    })
}

fn jacobian(x: &[DVec3; 10], slopes: &[DVec3; 10]) -> DMat3 {
    let mut j = DMat3::ZERO;
    for (p, s) in x.iter().zip(slopes) {
        j.x_axis += *p * s.x;
        j.y_axis += *p * s.y;
        j.z_axis += *p * s.z;
    }
    j
}

/// Gradients of the shape functions at a point, and the determinant of the map.
pub(crate) fn gradients(x: &[DVec3; 10], l: &[f64; 4]) -> ([DVec3; 10], f64) {
    let slopes = shape_slopes(l);
    let j = jacobian(x, &slopes);
    let turn = j.inverse().transpose();
    (slopes.map(|s| turn * s), j.determinant())
}

/// Volume with curved sides.
pub(crate) fn volume(x: &[DVec3; 10]) -> f64 {
    STIFFNESS_RULE.iter().map(|(l, w)| w * jacobian(x, &shape_slopes(l)).determinant()).sum()
}

/// The smallest determinant of the map at the nodes and at the points of the rule, relative to that
/// of the straight element.
pub(crate) fn least_jacobian(x: &[DVec3; 10]) -> f64 {
    let corner = |i: usize| std::array::from_fn(|k| f64::from(u8::from(k == i)));
    let middle = |(i, j): (usize, usize)| std::array::from_fn(|k| if k == i || k == j { 0.5 } else { 0.0 });
    let nodes = (0..4).map(corner).chain(EDGES.map(middle));
    let all = nodes.chain(STIFFNESS_RULE.iter().map(|p| p.0));
    let least = all.map(|l| jacobian(x, &shape_slopes(&l)).determinant()).fold(f64::INFINITY, f64::min);
    least / (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0])
}

/// Stiffness of an element from its products of gradients: `k[a][b]` is the 3 x 3 block of nodes a
/// and b, for b <= a.
pub(crate) fn stiffness<const N: usize>(sums: &[[DMat3; N]; N], law: &Law) -> [[DMat3; N]; N] {
    let mut k = [[DMat3::ZERO; N]; N];
    for a in 0..N {
        for b in 0..=a {
            k[a][b] = law.couple(&sums[a][b]);
        }
    }
    k
}

/// The diagonal blocks alone.
pub(crate) fn diagonal(x: &[DVec3; 10], law: &Law) -> [DMat3; 10] {
    let mut sums = [DMat3::ZERO; 10];
    for (l, w) in &STIFFNESS_RULE {
        let (g, det) = gradients(x, l);
        for (s, g) in sums.iter_mut().zip(g) {
            *s += outer(g * (w * det), g);
        }
    }
    sums.map(|s| law.couple(&s))
}

/// Integrals of the products of gradients: `sums[a][b]` is the integral of grad a times grad b
/// transposed, for b <= a.
pub(crate) fn gradient_products(x: &[DVec3; 10]) -> [[DMat3; 10]; 10] {
    let mut sums = [[DMat3::ZERO; 10]; 10];
    for (l, w) in &STIFFNESS_RULE {
        let (g, det) = gradients(x, l);
        for a in 0..10 {
            let ga = g[a] * (w * det);
            for b in 0..=a {
                let s = &mut sums[a][b];
                s.x_axis += ga * g[b].x;
                s.y_axis += ga * g[b].y;
                s.z_axis += ga * g[b].z;
            }
        }
    }
    sums
}

/// The same for the four-node element over the corners.
pub(crate) fn linear_gradient_products(x: &[DVec3; 4]) -> [[DMat3; 4]; 4] {
    let j = DMat3::from_cols(x[1] - x[0], x[2] - x[0], x[3] - x[0]);
    let turn = j.inverse().transpose();
    let (a, b, c) = (turn.x_axis, turn.y_axis, turn.z_axis);
    let g = [-(a + b + c), a, b, c];
    let volume = j.determinant() / 6.0;
    std::array::from_fn(|a| std::array::from_fn(|b| outer(g[a] * volume, g[b])))
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// A stiffness prepared for elements.
#[derive(Debug, Clone)]
pub(crate) enum Law {
    /// Lame's constants.
    Isotropic { lambda: f64, mu: f64 },
    /// All components; then the same numbers as a linear map of second-order tensors, stored by
    /// columns: `c[3 l + j][3 k + i]` = C_ikjl.
    General { d: Box<Stiffness>, c: Box<[[f64; 9]; 9]> },
}

/// Index of a pair of axes in the order xx, yy, zz, xy, yz, zx. Source: definition of that order.
const VOIGT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

impl Law {
    /// Prepares a stiffness; `None` unless it is symmetric and positive definite.
    pub(crate) fn new(d: &Stiffness) -> Option<Self> {
        let top = d.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * top;
        let symmetric = (0..6).all(|i| (0..i).all(|j| near(d[i][j], d[j][i])));
        if !top.is_finite() || !symmetric || !positive(d) {
            return None;
        }
        let (lambda, mu) = (d[0][1], d[3][3]);
        let isotropic = |i: usize, j: usize| match (i < 3, j < 3) {
            (true, true) => lambda + if i == j { 2.0 * mu } else { 0.0 },
            (false, false) if i == j => mu,
            _ => 0.0,
        };
        // An isotropic law needs a handful of multiplications instead of 81, and most parts are isotropic.
        if (0..6).all(|i| (0..6).all(|j| near(d[i][j], isotropic(i, j)))) {
            return Some(Self::Isotropic { lambda, mu });
        }
        let entry = |row: usize, column: usize| {
            let ((i, k), (j, l)) = ((column % 3, column / 3), (row % 3, row / 3));
            d[VOIGT[i][k]][VOIGT[j][l]]
        };
        let c = std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)));
        Some(Self::General { d: Box::new(*d), c: Box::new(c) })
    }

    /// Stress from the gradient of the displacement (columns: derivatives by x, y, z).
    pub(crate) fn stress(&self, grad: &DMat3) -> DMat3 {
        match self {
            Self::Isotropic { lambda, mu } => {
                let trace = grad.x_axis.x + grad.y_axis.y + grad.z_axis.z;
                (*grad + grad.transpose()) * *mu + DMat3::from_diagonal(DVec3::splat(lambda * trace))
            }
            Self::General { d, .. } => {
                let s = multiply(d, &strain(grad));
                DMat3::from_cols_array(&[s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]])
            }
        }
    }

    /// Stress of a strain given with engineering shears.
    pub(crate) fn stress_of_strain(&self, e: &[f64; 6]) -> DMat3 {
        let half = e.map(|v| 0.5 * v);
        self.stress(&DMat3::from_cols_array(&[
            e[0], half[3], half[5], half[3], e[1], half[4], half[5], half[4], e[2],
        ]))
    }

    /// Block of the stiffness from the integrated products of gradients: K_ij = C_ikjl G_kl.
    fn couple(&self, g: &DMat3) -> DMat3 {
        match self {
            Self::Isotropic { lambda, mu } => {
                let trace = g.x_axis.x + g.y_axis.y + g.z_axis.z;
                *g * *lambda + g.transpose() * *mu + DMat3::from_diagonal(DVec3::splat(mu * trace))
            }
            Self::General { c, .. } => {
                let g = g.to_cols_array();
                let mut k = [0.0; 9];
                for j in 0..3 {
                    for l in 0..3 {
                        let row = &c[3 * l + j];
                        for m in 0..3 {
                            let gkl = g[3 * l + m];
                            for i in 0..3 {
                                k[3 * j + i] += row[3 * m + i] * gkl;
                            }
                        }
                    }
                }
                DMat3::from_cols_array(&k)
            }
        }
    }
}

/// Engineering strain from the gradient of the displacement, in the order xx, yy, zz, xy, yz, zx.
pub(crate) fn strain(g: &DMat3) -> [f64; 6] {
    [
        g.x_axis.x,
        g.y_axis.y,
        g.z_axis.z,
        g.x_axis.y + g.y_axis.x,
        g.y_axis.z + g.z_axis.y,
        g.z_axis.x + g.x_axis.z,
    ]
}

/// The product of the 6 x 6 matrix `d` with the vector `e`.
pub(crate) fn multiply(d: &Stiffness, e: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|i| (0..6).map(|j| d[i][j] * e[j]).sum())
}

fn positive(d: &Stiffness) -> bool {
    // A Cholesky factorization succeeds only if every pivot is positive.
    let mut l = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..=i {
            let rest = d[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j {
                if rest.is_nan() || rest <= 1e-12 * d[i][i].abs() {
                    return false;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    true
}
