//! Linear elasticity: stiffness matrices from engineering constants, and their rotation.
//!
//! Components come in the order xx, yy, zz, xy, yz, zx with engineering (doubled) shear strains;
//! moduli are in MPa. Formulas: `jones1999`, chapter 2.

use grainpath_core::math::sin_cos;

/// Stresses from strains, `(6, 6)`, MPa, order xx, yy, zz, xy, yz, zx with doubled shear strains.
pub type Stiffness = [[f64; 6]; 6];

/// An orthotropic material in its own axes: 1 along the beads, 2 across them in the layer, 3 from
/// layer to layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    /// Young's moduli along 1, 2 and 3, MPa.
    pub e_mpa: [f64; 3],
    /// Poisson's ratios 12, 23 and 13: strain along the second for stress along the first.
    pub nu: [f64; 3],
    /// Shear moduli 12, 23 and 13, MPa.
    pub g_mpa: [f64; 3],
}

/// The error for elastic constants with which a material would release energy under load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the elastic constants are not those of a stable material")]
pub struct Unstable;

impl Orthotropic {
    /// A material with the same constants in all directions.
    pub fn isotropic(e_mpa: f64, nu: f64) -> Self {
        Self { e_mpa: [e_mpa; 3], nu: [nu; 3], g_mpa: [e_mpa / (2.0 * (1.0 + nu)); 3] }
    }

    /// Stresses from strains in the material's axes.
    ///
    /// # Errors
    /// [`Unstable`] when the constants do not make a positive definite matrix.
    pub fn stiffness(&self) -> Result<Stiffness, Unstable> {
        let [e1, e2, e3] = self.e_mpa;
        let [n12, n23, n13] = self.nu;
        // Normal strains from normal stresses. The inverse of this compliance is the upper left
        // part of the stiffness; shear is uncoupled in the material's axes.
        let mut s = [
            [1.0 / e1, -n12 / e1, -n13 / e1],
            [-n12 / e1, 1.0 / e2, -n23 / e2],
            [-n13 / e1, -n23 / e2, 1.0 / e3],
        ];
        let all = self.e_mpa.iter().chain(&self.g_mpa);
        if !all.clone().all(|m| *m > 0.0 && m.is_finite()) || !invert3(&mut s) {
            return Err(Unstable);
        }
        // Sylvester's criterion: all leading minors are positive. Poisson's ratios may violate it
        // together although each of them is plausible.
        let minors = [s[0][0], s[0][0] * s[1][1] - s[0][1] * s[1][0]];
        if !(minors[0] > 0.0 && minors[1] > 0.0 && determinant3(&s) > 0.0) {
            return Err(Unstable);
        }
        let mut c = [[0.0; 6]; 6];
        for i in 0..3 {
            c[i][..3].copy_from_slice(&s[i]);
            c[3 + i][3 + i] = self.g_mpa[i];
        }
        Ok(c)
    }

    /// Stresses xx, yy, xy from strains in a layer whose beads run at `angle_rad` from x, with no
    /// stress on its faces (plane stress).
    ///
    /// # Errors
    /// [`Unstable`] when the constants do not make a positive definite matrix.
    pub fn plane_stress(&self, angle_rad: f64) -> Result<[[f64; 3]; 3], Unstable> {
        let c = self.stiffness()?;
        // Static condensation: the strain zz across the layer is eliminated by the condition that the stress zz is zero.
        let condensed = |i: usize, j: usize| c[i][j] - c[i][2] * c[2][j] / c[2][2];
        let (c11, c12, c22, c66) = (condensed(0, 0), condensed(0, 1), condensed(1, 1), c[3][3]);
        Ok(rotated_plane(&[[c11, c12, 0.0], [c12, c22, 0.0], [0.0, 0.0, c66]], angle_rad))
    }
}

/// A plane stiffness rotated by an angle: `T C T'`. `T` transforms stresses, its transpose
/// engineering strains.
pub(crate) fn rotated_plane(c: &[[f64; 3]; 3], angle_rad: f64) -> [[f64; 3]; 3] {
    let (s, k) = sin_cos(angle_rad);
    // The matrix `T`: stresses in the axes x, y from stresses in the material's axes.
    let t = [[k * k, s * s, -2.0 * s * k], [s * s, k * k, 2.0 * s * k], [s * k, -s * k, k * k - s * s]];
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for a in 0..3 {
                for b in 0..3 {
                    out[i][j] += t[i][a] * c[a][b] * t[j][b];
                }
            }
        }
    }
    out
}

/// The strain xx, yy, xy in axes turned by this angle in the layer; shear is engineering strain.
pub(crate) fn plane_strain_along(strain: [f64; 3], angle_rad: f64) -> [f64; 3] {
    turned_strain(strain, sin_cos(angle_rad))
}

/// The strain xx, yy, zz, xy, yz, zx in axes turned about z by this angle; shear is engineering strain.
pub(crate) fn strain_along([xx, yy, zz, xy, yz, zx]: [f64; 6], angle_rad: f64) -> [f64; 6] {
    let (s, c) = sin_cos(angle_rad);
    let [along, across, shear] = turned_strain([xx, yy, xy], (s, c));
    [along, across, zz, shear, c * yz - s * zx, s * yz + c * zx]
}

fn turned_strain([xx, yy, xy]: [f64; 3], (s, c): (f64, f64)) -> [f64; 3] {
    [
        c * c * xx + s * s * yy + s * c * xy,
        s * s * xx + c * c * yy - s * c * xy,
        2.0 * s * c * (yy - xx) + (c * c - s * s) * xy,
    ]
}

/// A stiffness rotated about z: `T C T'`. `T` transforms stresses, its transpose engineering
/// strains.
pub fn rotated_about_z(c: &Stiffness, angle_rad: f64) -> Stiffness {
    let (s, k) = sin_cos(angle_rad);
    // The matrix `T`: stresses in the axes x, y, z from stresses in the material's axes, in the
    // order xx, yy, zz, xy, yz, zx.
    let t = [
        [k * k, s * s, 0.0, -2.0 * s * k, 0.0, 0.0],
        [s * s, k * k, 0.0, 2.0 * s * k, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [s * k, -s * k, 0.0, k * k - s * s, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, k, s],
        [0.0, 0.0, 0.0, 0.0, -s, k],
    ];
    let mut out = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            for a in 0..6 {
                for b in 0..6 {
                    out[i][j] += t[i][a] * c[a][b] * t[j][b];
                }
            }
        }
    }
    out
}

fn determinant3(m: &[[f64; 3]; 3]) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

fn invert3(m: &mut [[f64; 3]; 3]) -> bool {
    let det = determinant3(m);
    if det == 0.0 || !det.is_finite() {
        return false;
    }
    let a = *m;
    for i in 0..3 {
        for j in 0..3 {
            let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            m[j][i] = (a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1]) / det;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_stress_of_an_isotropic_material_is_the_textbook_matrix() {
        let (e, nu) = (2100.0, 0.3);
        for angle in [0.0, 0.4, 1.3] {
            let c = Orthotropic::isotropic(e, nu).plane_stress(angle).expect("stable");
            let k = e / (1.0 - nu * nu);
            let want = [[k, k * nu, 0.0], [k * nu, k, 0.0], [0.0, 0.0, k * (1.0 - nu) / 2.0]];
            for (got, want) in c.iter().flatten().zip(want.iter().flatten()) {
                assert!((got - want).abs() < 1e-9 * k, "{c:?}");
            }
        }
    }

    #[test]
    fn stiffness_across_directions_follows_the_lamina_formula() {
        let m = Orthotropic { e_mpa: [3376.0, 3125.0, 2900.0], nu: [0.33; 3], g_mpa: [1092.0, 900.0, 900.0] };
        for deg in [0.0, 30.0, 45.0, 60.0, 90.0f64] {
            let mut c = m.plane_stress(deg.to_radians()).expect("stable");
            assert!(invert3(&mut c));
            let (s, k) = sin_cos(deg.to_radians());
            let [e1, e2, _] = m.e_mpa;
            let want =
                k.powi(4) / e1 + s.powi(4) / e2 + (1.0 / m.g_mpa[0] - 2.0 * m.nu[0] / e1) * (s * k).powi(2);
            assert!((c[0][0] - want).abs() < 1e-12, "{deg}: {} {want}", c[0][0]);
        }
    }

    #[test]
    fn a_quarter_turn_about_z_swaps_along_and_across() {
        let m = Orthotropic {
            e_mpa: [3376.0, 3125.0, 2900.0],
            nu: [0.33, 0.3, 0.25],
            g_mpa: [1092.0, 900.0, 800.0],
        };
        let c = m.stiffness().expect("stable");
        let q = rotated_about_z(&c, std::f64::consts::FRAC_PI_2);
        let swap = [1, 0, 2, 3, 5, 4];
        for i in 0..6 {
            for j in 0..6 {
                assert!((q[i][j].abs() - c[swap[i]][swap[j]].abs()).abs() < 1e-9 * c[0][0], "{i} {j}");
            }
        }
        // In the plane it is what plane stress says.
        let condensed = |c: &Stiffness, i: usize, j: usize| c[i][j] - c[i][2] * c[2][j] / c[2][2];
        let (turned, plane) = (rotated_about_z(&c, 0.4), m.plane_stress(0.4).expect("stable"));
        for (i, a) in [0, 1, 3].into_iter().enumerate() {
            for (j, b) in [0, 1, 3].into_iter().enumerate() {
                assert!((condensed(&turned, a, b) - plane[i][j]).abs() < 1e-9 * c[0][0]);
            }
        }
    }

    #[test]
    fn impossible_constants_are_refused() {
        assert!(Orthotropic::isotropic(1000.0, 0.6).stiffness().is_err());
        assert!(Orthotropic::isotropic(-1.0, 0.3).stiffness().is_err());
        assert!(Orthotropic::isotropic(f64::NAN, 0.3).stiffness().is_err());
    }
}
