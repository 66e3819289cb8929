//! The quadratic triangle with six nodes: shape functions, stiffness and stress.
//!
//! Method: isoparametric, so sides may be curved. Nodes are three corners, then the middles of sides 01, 12
//! and 20. The stiffness is integrated at three points, exact for straight sides, where the integrand is of
//! degree 2. Strains follow from the gradients of the shape functions at a point.
//!
//! Area coordinates `l` sum to 1. Positions and displacements are in mm, stresses in MPa with components xx,
//! yy, xy, the stiffness in N/mm, `(12, 12)`, with x and y of each node in turn. Cost: about a thousand
//! products for a stiffness. Degenerate cases: an element whose Jacobian is zero, negative or not a number at
//! an integration point has no stiffness. Gradients there are not finite.

use grainpath_core::DVec2;
use grainpath_core::math::cross;

use super::plane_problem::PlaneStiffness;

/// Integration points in area coordinates, with weights that sum to 1/2: exact to degree 2. Source:
/// derived: with three symmetric points, 2/3 and 1/6 are the values that integrate L1^2 and L1 L2
/// exactly.
pub(super) const POINTS: [([f64; 3], f64); 3] = {
    let (a, b, w) = (2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0);
    [([a, b, b], w), ([b, a, b], w), ([b, b, a], w)]
};

/// Gauss points and weights on [-1, 1]. Source: roots of the Legendre polynomial of degree 3, 0 and
/// the square root of 3/5; exact to degree 5.
pub(super) const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Shape functions at area coordinates `l`, and twice the area there.
pub(super) fn shape(p: &[DVec2; 6], l: [f64; 3]) -> ([f64; 6], f64) {
    let n = [
        l[0] * (2.0 * l[0] - 1.0),
        l[1] * (2.0 * l[1] - 1.0),
        l[2] * (2.0 * l[2] - 1.0),
        4.0 * l[0] * l[1],
        4.0 * l[1] * l[2],
        4.0 * l[2] * l[0],
    ];
    (n, jacobian(p, l).2)
}

/// Derivatives of the shape functions in the first two area coordinates.
fn slopes(l: [f64; 3]) -> [[f64; 2]; 6] {
    // The third area coordinate is 1 - l0 - l1, hence the negative terms.
    [
        [4.0 * l[0] - 1.0, 0.0],
        [0.0, 4.0 * l[1] - 1.0],
        [1.0 - 4.0 * l[2], 1.0 - 4.0 * l[2]],
        [4.0 * l[1], 4.0 * l[0]],
        [-4.0 * l[1], 4.0 * (l[2] - l[1])],
        [4.0 * (l[2] - l[0]), -4.0 * l[0]],
    ]
}

/// Columns of the Jacobian and its determinant.
fn jacobian(p: &[DVec2; 6], l: [f64; 3]) -> (DVec2, DVec2, f64) {
    let s = slopes(l);
    let column = |k: usize| (0..6).map(|i| s[i][k] * p[i]).sum::<DVec2>();
    let (u, v) = (column(0), column(1));
    (u, v, cross(u, v))
}

/// Gradients of the shape functions, and the Jacobian's determinant.
pub(super) fn gradients(p: &[DVec2; 6], l: [f64; 3]) -> ([DVec2; 6], f64) {
    let s = slopes(l);
    let (u, v, det) = jacobian(p, l);
    // Rows of the inverse.
    let (du, dv) = (DVec2::new(v.y, -v.x) / det, DVec2::new(-u.y, u.x) / det);
    (s.map(|[a, b]| a * du + b * dv), det)
}

/// Stiffness in N/mm, `(12, 12)`, degrees of freedom node by node; `None` for an element turned
/// inside out.
pub(super) fn stiffness(p: &[DVec2; 6], c: &PlaneStiffness, thickness_mm: f64) -> Option<[[f64; 12]; 12]> {
    // For straight sides the integrand is of degree 2, so three points are exact.
    let mut k = [[0.0; 12]; 12];
    for (l, weight) in POINTS {
        let (g, det) = gradients(p, l);
        if det.is_nan() || det <= 0.0 {
            return None;
        }
        let w = weight * det * thickness_mm;
        for a in 0..6 {
            // C B of node a: stresses for unit displacements.
            let (x, y) = (g[a].x, g[a].y);
            let cb = |i: usize| [c[i][0] * x + c[i][2] * y, c[i][1] * y + c[i][2] * x];
            let cb = [cb(0), cb(1), cb(2)];
            for b in 0..6 {
                for j in 0..2 {
                    k[2 * b][2 * a + j] += w * (g[b].x * cb[0][j] + g[b].y * cb[2][j]);
                    k[2 * b + 1][2 * a + j] += w * (g[b].y * cb[1][j] + g[b].x * cb[2][j]);
                }
            }
        }
    }
    Some(k)
}

/// Stress at area coordinates from the displacements of the nodes, MPa.
pub(super) fn stress(p: &[DVec2; 6], u: &[DVec2; 6], c: &PlaneStiffness, l: [f64; 3]) -> [f64; 3] {
    let (g, _) = gradients(p, l);
    let strain = (0..6).fold([0.0; 3], |e, i| {
        [e[0] + g[i].x * u[i].x, e[1] + g[i].y * u[i].y, e[2] + g[i].y * u[i].x + g[i].x * u[i].y]
    });
    c.map(|row| row[0] * strain[0] + row[1] * strain[1] + row[2] * strain[2])
}

/// Rotates the rows and columns of node `a` into a frame whose first axis is `axis`.
pub(super) fn turn(k: &mut [[f64; 12]; 12], a: usize, axis: DVec2) {
    let (c, s) = (axis.x, axis.y);
    let (i, j) = (2 * a, 2 * a + 1);
    for row in k.iter_mut() {
        (row[i], row[j]) = (c * row[i] + s * row[j], -s * row[i] + c * row[j]);
    }
    for col in 0..12 {
        (k[i][col], k[j][col]) = (c * k[i][col] + s * k[j][col], -s * k[i][col] + c * k[j][col]);
    }
}
