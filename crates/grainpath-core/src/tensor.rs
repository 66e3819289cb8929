//! One stress tensor: von Mises stress, principal values and axes.
//!
//! Components come in the order xx, yy, zz, xy, yz, zx, in MPa, without a factor of two on shear.
//! Method of the principal values: cyclic Jacobi sweeps (`golub2013`, section 8.5), which are
//! accurate for equal principal values too; the closed solution of the cubic equation loses half
//! its digits there.

use glam::DVec3;

/// Principal stresses in descending order with their axes: unit vectors without a sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Principal {
    /// Values in MPa, highest first.
    pub values_mpa: [f64; 3],
    /// Axis of each value. Where two values are equal their axes are any two in the shared plane.
    pub axes: [DVec3; 3],
}

/// Von Mises stress of a tensor in MPa.
pub fn von_mises(s: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *s;
    let (a, b, c) = (xx - yy, yy - zz, zz - xx);
    (0.5 * (a * a + b * b + c * c) + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// Principal values and axes by Jacobi sweeps, which keep the axes at right angles where values are equal.
pub fn principal(s: &[f64; 6]) -> Principal {
    let [xx, yy, zz, xy, yz, zx] = *s;
    let mut a = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let mut v = [DVec3::X, DVec3::Y, DVec3::Z];
    let size = a.iter().flatten().map(|x| x * x).sum::<f64>();
    // Convergence is quadratic, so a few sweeps are enough; the bound guarantees that the loop
    // ends.
    for _ in 0..32 {
        let off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
        // Off-diagonal entries below this are rounding errors of the largest entry.
        if !off.is_finite() || off <= 1e-32 * size {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
            // The smaller of the two roots: a rotation by less than 45 degrees keeps the axes near
            // where they were.
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            let (app, aqq, apq) = (a[p][p], a[q][q], a[p][q]);
            let r = 3 - p - q;
            let (arp, arq) = (a[r][p], a[r][q]);
            // Both formulas add a multiple of the old off-diagonal entry, which loses no digits.
            a[p][p] = app - t * apq;
            a[q][q] = aqq + t * apq;
            (a[p][q], a[q][p]) = (0.0, 0.0);
            (a[r][p], a[r][q]) = (c * arp - s * arq, s * arp + c * arq);
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
            (v[p], v[q]) = (c * v[p] - s * v[q], s * v[p] + c * v[q]);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
    Principal { values_mpa: order.map(|i| a[i][i]), axes: order.map(|i| v[i]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_tensors() {
        assert!((von_mises(&[100.0, 0.0, 0.0, 0.0, 0.0, 0.0]) - 100.0).abs() < 1e-12);
        assert!((von_mises(&[0.0, 0.0, 0.0, 10.0, 0.0, 0.0]) - 300f64.sqrt()).abs() < 1e-12);
        assert!(von_mises(&[7.0, 7.0, 7.0, 0.0, 0.0, 0.0]) < 1e-12);
        assert!(von_mises(&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]).is_nan());
        let p = principal(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
        assert!((p.values_mpa[0] - 5.0).abs() < 1e-14 && (p.values_mpa[2] + 5.0).abs() < 1e-14);
        assert!((p.axes[0].x.abs() - 0.5f64.sqrt()).abs() < 1e-14 && p.axes[0].x * p.axes[0].y > 0.0);
    }

    proptest! {
        #[test]
        fn values_and_axes_give_the_tensor_back(s in proptest::array::uniform6(-100.0f64..100.0), equal in any::<bool>()) {
            let s = if equal { [s[0], s[0], s[2], 0.0, 1e-13 * s[4], 0.0] } else { s };
            let p = principal(&s);
            let mut back = [0.0; 6];
            for (value, n) in p.values_mpa.into_iter().zip(p.axes) {
                for (b, c) in back.iter_mut().zip([n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.y * n.z, n.z * n.x]) {
                    *b += value * c;
                }
            }
            for (a, b) in s.iter().zip(back) {
                prop_assert!((a - b).abs() < 1e-11, "{:?} {:?}", s, back);
            }
            prop_assert!(p.values_mpa[0] >= p.values_mpa[1] && p.values_mpa[1] >= p.values_mpa[2]);
            prop_assert!(p.axes[0].dot(p.axes[1]).abs() < 1e-14 && (p.axes[2].length() - 1.0).abs() < 1e-14);
        }
    }
}
