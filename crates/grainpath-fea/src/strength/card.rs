//! The strengths of printed material and how near a stress is to them.
//!
//! A ply is a sheet of parallel beads; its axes are 1 along the beads, 2 across them in the layer, 3 from layer to
//! layer. Failure in the layer follows Tsai and Hill (`azzi1965` in docs/references.bib), with the strength in tension or in
//! compression by the sign of each stress. Layers part under tension and shear alone, by a quadratic criterion
//! (`brewer1988`). Indices are 1 at failure and grow in proportion to the stress, so that one linear solution
//! gives them at every load.
//!
//! After failure a ply softens in a band one element wide. The strain at which nothing is left follows from the fracture
//! energy and from the size of the element (crack band, `bazant1983`), so that a crack spends the same energy
//! on every grid.

use grainpath_core::math::sin_cos;

use crate::material::Orthotropic;

/// The least strain, over that at failure, at which an element has lost all its stress. Source: derived. Load
/// stepping raises the damage strain by 3 % or more at a time, so such an element fails in one step; at 1 the
/// softening line would have no slope.
const LEAST_FINAL: f64 = 1.02;

/// The first failure of materials with a shorter critical distance is told cell by cell, mm. Source: derived. The strains of
/// cells half of its reach away count by half in the field of [`super::strain_fit`]; cards of plastics have 0.57 mm and more,
/// that of continuous carbon fibre 0.33 to 0.48 mm in shear. Measured: over a length, a hook of fibre that
/// breaks at 375 N was told to begin to fail at 490 N.
const LEAST_CRITICAL_MM: f64 = 0.5;

/// Stiffness, strengths and fracture energies of printed material in its own axes: 1 along the beads, 2 across them in
/// the layer, 3 from layer to layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrengthCard {
    /// Stiffness.
    pub elastic: Orthotropic,
    /// Tensile strength along the beads, MPa.
    pub xt_mpa: f64,
    /// Tensile strength across them, MPa.
    pub yt_mpa: f64,
    /// Shear strength in the layer, MPa.
    pub s12_mpa: f64,
    /// Compressive strength along the beads, MPa, positive.
    pub xc_mpa: f64,
    /// Compressive strength across them, MPa, positive.
    pub yc_mpa: f64,
    /// Tensile strength from layer to layer, MPa.
    pub zt_mpa: f64,
    /// Shear strength between layers, MPa.
    pub s_il_mpa: f64,
    /// Fracture energy of a crack through beads, N/mm.
    pub g_along_n_mm: f64,
    /// Fracture energy of a crack between beads, beside or above each other, N/mm.
    pub g_across_n_mm: f64,
}

impl StrengthCard {
    /// Stress along x at which a uniform raster at this angle fails in tension, MPa, after Tsai and Hill.
    pub fn tsai_hill_mpa(&self, angle_rad: f64) -> f64 {
        let (s, c) = sin_cos(angle_rad);
        1.0 / self.index([c * c, s * s, -s * c]).0
    }

    /// Stress along x at which a uniform raster at this angle fails in tension, MPa, after Hankinson.
    pub fn hankinson_mpa(&self, angle_rad: f64) -> f64 {
        let (s, c) = sin_cos(angle_rad);
        self.xt_mpa * self.yt_mpa / (self.xt_mpa * s * s + self.yt_mpa * c * c)
    }

    /// The failure index of stresses 11, 22, 12 (MPa), and the mode of failure.
    pub fn index(&self, stress: [f64; 3]) -> (f64, FailureMode) {
        let [s1, s2, s12] = stress;
        let x = if s1 >= 0.0 { self.xt_mpa } else { self.xc_mpa };
        let y = if s2 >= 0.0 { self.yt_mpa } else { self.yc_mpa };
        let terms = [s1 / x, s2 / y, s12 / self.s12_mpa].map(|t| t * t);
        // The product of Tsai and Hill holds for stresses of the same sign; for opposite signs it is left out.
        let product = (s1 * s2).max(0.0) / (x * x);
        let sum = (terms[0] + terms[1] + terms[2] - product).max(0.0);
        let mode = if terms[0] >= terms[1].max(terms[2]) {
            if s1 >= 0.0 { FailureMode::Along } else { FailureMode::Compression }
        } else if terms[2] >= terms[1] {
            FailureMode::Shear
        } else if s2 >= 0.0 {
            FailureMode::Across
        } else {
            FailureMode::Compression
        };
        (sum.sqrt(), mode)
    }

    /// The failure indices through the beads and between them, and the mode of the larger one.
    pub fn indices(&self, stress: [f64; 3]) -> ([f64; 2], FailureMode) {
        let (all, mode) = self.index(stress);
        let [s1, s2, s12] = stress;
        let x = if s1 >= 0.0 { self.xt_mpa } else { self.xc_mpa };
        let y = if s2 >= 0.0 { self.yt_mpa } else { self.yc_mpa };
        let along = s1.abs() / x;
        let between = ((s2 / y) * (s2 / y) + (s12 / self.s12_mpa) * (s12 / self.s12_mpa)).sqrt();
        let through = mode == FailureMode::Along || (mode == FailureMode::Compression && along >= between);
        (if through { [all, between.min(all)] } else { [along, all] }, mode)
    }

    /// Whether shear along the beads contributes more than opening to the index between beads.
    pub(crate) fn is_sliding(&self, [_, s2, s12]: [f64; 3]) -> bool {
        let y = if s2 >= 0.0 { self.yt_mpa } else { self.yc_mpa };
        s12.abs() / self.s12_mpa > s2.abs() / y
    }

    /// The failure index between layers for stresses 33, 23, 13 (MPa), and whether shear contributes more than
    /// opening. Compression between layers has no effect.
    pub fn layer_index(&self, [s33, s23, s13]: [f64; 3]) -> (f64, bool) {
        let opens = s33.max(0.0) / self.zt_mpa;
        let slides = (s23 * s23 + s13 * s13).sqrt() / self.s_il_mpa;
        ((opens * opens + slides * slides).sqrt(), slides > opens)
    }

    /// Whether the first failure in the layer is told from the stress over a length: where the shortest critical distance,
    /// `E G / (pi strength^2)` (`taylor2008`), of tearing, parting and sliding is at least 0.5 mm.
    pub fn fails_over_a_length(&self) -> bool {
        let [e1, e2, _] = self.elastic.e_mpa;
        let (g1, g2) = (self.g_along_n_mm, self.g_across_n_mm);
        let modes = [(e1, g1, self.xt_mpa), (e2, g2, self.yt_mpa), (self.elastic.g_mpa[0], g2, self.s12_mpa)];
        modes.into_iter().all(is_over_a_length)
    }

    /// [`StrengthCard::fails_over_a_length`] for failure between layers.
    pub fn layers_part_over_a_length(&self) -> bool {
        let ([_, _, e3], [_, _, g13]) = (self.elastic.e_mpa, self.elastic.g_mpa);
        let g2 = self.g_across_n_mm;
        [(e3, g2, self.zt_mpa), (g13, g2, self.s_il_mpa)].into_iter().all(is_over_a_length)
    }

    /// The strains at which an element of this width and height has lost all its stress. Elements that are too large
    /// for the fracture energy fail at once.
    pub fn final_strains(&self, cell_mm: f64, height_mm: f64) -> FinalStrains {
        let [e1, e2, e3] = self.elastic.e_mpa;
        let [g12, _, g13] = self.elastic.g_mpa;
        let (g1, g2) = (self.g_along_n_mm, self.g_across_n_mm);
        let final_strain =
            |e: f64, g: f64, s: f64, width: f64| (2.0 * e * g / (width * s * s)).max(LEAST_FINAL);
        let opening = [
            final_strain(e1, g1, self.xt_mpa, cell_mm),
            final_strain(e2, g2, self.yt_mpa, cell_mm),
            final_strain(e3, g2, self.zt_mpa, height_mm),
        ];
        let sliding = [
            opening[0],
            final_strain(g12, g2, self.s12_mpa, cell_mm),
            final_strain(g13, g2, self.s_il_mpa, height_mm),
        ];
        FinalStrains { opening, sliding }
    }
}

/// Whether a critical distance is long enough, from a modulus, a fracture energy and a strength.
fn is_over_a_length((e_mpa, g_n_mm, strength_mpa): (f64, f64, f64)) -> bool {
    e_mpa * g_n_mm / (std::f64::consts::PI * strength_mpa * strength_mpa) >= LEAST_CRITICAL_MM
}

/// Strain at which a crack band has lost all its stress, over the strain at which it failed: for tearing through
/// beads, parting between them, and parting of layers. Opening and sliding spend the same energy per area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinalStrains {
    /// Under opening.
    pub opening: [f64; 3],
    /// Under sliding.
    pub sliding: [f64; 3],
}

/// How a ply fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum FailureMode {
    /// Beads tear.
    #[default]
    Along,
    /// Beads part from their neighbours.
    Across,
    /// Beads slide along their neighbours.
    Shear,
    /// Crushing.
    Compression,
    /// Layers part from each other.
    Layers,
}

impl FailureMode {
    /// Every mode.
    pub const ALL: [Self; 5] = [Self::Along, Self::Across, Self::Shear, Self::Compression, Self::Layers];

    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Along => "along the beads",
            Self::Across => "across the beads",
            Self::Shear => "shear between beads",
            Self::Compression => "compression",
            Self::Layers => "between layers",
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn pla() -> StrengthCard {
        StrengthCard {
            elastic: Orthotropic {
                e_mpa: [2669.0, 2583.0, 2208.0],
                nu: [0.43, 0.37, 0.37],
                g_mpa: [919.0, 844.0, 844.0],
            },
            xt_mpa: 52.0,
            yt_mpa: 37.0,
            s12_mpa: 18.0,
            xc_mpa: 70.0,
            yc_mpa: 70.0,
            zt_mpa: 40.0,
            s_il_mpa: 18.0,
            g_along_n_mm: 4.0,
            g_across_n_mm: 1.3,
        }
    }

    #[test]
    fn the_curve_off_axis_ends_at_the_strengths() {
        let card = pla();
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!((card.tsai_hill_mpa(0.0) - 52.0).abs() < 1e-9);
        assert!((card.tsai_hill_mpa(quarter) - 37.0).abs() < 1e-9);
        assert_eq!(card.index([-30.0, 0.0, 0.0]).1, FailureMode::Compression);
        assert_eq!(card.index([0.0, 10.0, 9.0]).1, FailureMode::Shear);
        let mut last = f64::INFINITY;
        for deg in [0.0, 15.0, 30.0f64] {
            let now = card.tsai_hill_mpa(deg.to_radians());
            assert!(now < last && now <= card.hankinson_mpa(deg.to_radians()) + 1e-9);
            last = now;
        }
    }
}
