//! One ply: stiffness as it breaks, and how near it is to failing.

use grainpath_core::math::sin_cos;

use crate::material::{Orthotropic, Stiffness, Unstable, rotated_plane};
use crate::plane::PlaneStiffness;

/// What printed material stands, in its own axes: 1 along the beads, 2 across them in the layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrengthCard {
    /// Stiffness.
    pub elastic: Orthotropic,
    /// Tension along the beads, MPa.
    pub xt_mpa: f64,
    /// Tension across them, MPa.
    pub yt_mpa: f64,
    /// Shear in the layer, MPa.
    pub s12_mpa: f64,
    /// Compression along the beads, MPa, positive.
    pub xc_mpa: f64,
    /// Compression across them, MPa, positive.
    pub yc_mpa: f64,
    /// Tension from layer to layer, MPa.
    pub zt_mpa: f64,
    /// Shear between layers, MPa.
    pub s_il_mpa: f64,
    /// Energy to tear through beads, N/mm.
    pub g_along_n_mm: f64,
    /// Energy to tear beads from each other, beside or above, N/mm.
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

    /// How near stresses 11, 22, 12 (MPa) are to failing, 1 being failure, and by which mode. Grows in proportion to
    /// the stress.
    pub fn index(&self, stress: [f64; 3]) -> (f64, Mode) {
        let [s1, s2, s12] = stress;
        let x = if s1 >= 0.0 { self.xt_mpa } else { self.xc_mpa };
        let y = if s2 >= 0.0 { self.yt_mpa } else { self.yc_mpa };
        let terms = [s1 / x, s2 / y, s12 / self.s12_mpa].map(|t| t * t);
        // Tsai and Hill's product belongs to stresses of one sign; for unlike ones it would call them safer.
        let product = (s1 * s2).max(0.0) / (x * x);
        let sum = (terms[0] + terms[1] + terms[2] - product).max(0.0);
        let mode = if terms[0] >= terms[1].max(terms[2]) {
            if s1 >= 0.0 { Mode::Along } else { Mode::Compression }
        } else if terms[2] >= terms[1] {
            Mode::Shear
        } else if s2 >= 0.0 {
            Mode::Across
        } else {
            Mode::Compression
        };
        (sum.sqrt(), mode)
    }

    /// How near a ply is to breaking through its beads, to breaking between them, and by which mode it is nearest.
    pub fn indices(&self, stress: [f64; 3]) -> ([f64; 2], Mode) {
        let (all, mode) = self.index(stress);
        let [s1, s2, s12] = stress;
        let x = if s1 >= 0.0 { self.xt_mpa } else { self.xc_mpa };
        let y = if s2 >= 0.0 { self.yt_mpa } else { self.yc_mpa };
        let along = s1.abs() / x;
        let between = ((s2 / y) * (s2 / y) + (s12 / self.s12_mpa) * (s12 / self.s12_mpa)).sqrt();
        let through = mode == Mode::Along || (mode == Mode::Compression && along >= between);
        (if through { [all, between.min(all)] } else { [along, all] }, mode)
    }

    /// Whether sliding along the beads is a greater part of what parts them than opening.
    pub fn slides(&self, [_, s2, s12]: [f64; 3]) -> bool {
        let y = if s2 >= 0.0 { self.yt_mpa } else { self.yc_mpa };
        s12.abs() / self.s12_mpa > s2.abs() / y
    }

    /// How near a layer is to parting from the one below under stresses 33, 23, 13 (MPa), pressure doing nothing, and
    /// whether by sliding.
    pub fn layers(&self, [s33, s23, s13]: [f64; 3]) -> (f64, bool) {
        let opens = s33.max(0.0) / self.zt_mpa;
        let slides = (s23 * s23 + s13 * s13).sqrt() / self.s_il_mpa;
        ((opens * opens + slides * slides).sqrt(), slides > opens)
    }

    /// Whether every number can be used.
    pub fn is_sound(&self) -> bool {
        let plane = [self.xt_mpa, self.yt_mpa, self.s12_mpa, self.xc_mpa, self.yc_mpa];
        let rest = [self.zt_mpa, self.s_il_mpa, self.g_along_n_mm, self.g_across_n_mm];
        plane.iter().chain(&rest).all(|v| v.is_finite() && *v > 0.0)
    }

    /// How far a broken band one cell wide can be drawn before it carries nothing, in a cell of this width and height.
    /// Cells that are too large to hold the energy break at once.
    pub fn draws(&self, cell_mm: f64, height_mm: f64) -> Draws {
        let [e1, e2, e3] = self.elastic.e_mpa;
        let [g12, _, g13] = self.elastic.g_mpa;
        let (g1, g2) = (self.g_along_n_mm, self.g_across_n_mm);
        let draw = |e: f64, g: f64, s: f64, width: f64| (2.0 * e * g / (width * s * s)).max(1.02);
        let opened = [
            draw(e1, g1, self.xt_mpa, cell_mm),
            draw(e2, g2, self.yt_mpa, cell_mm),
            draw(e3, g2, self.zt_mpa, height_mm),
        ];
        let slid = [opened[0], draw(g12, g2, self.s12_mpa, cell_mm), draw(g13, g2, self.s_il_mpa, height_mm)];
        Draws { opened, slid }
    }
}

/// Strain at which a broken band carries nothing, over the strain at which it began to break: for tearing through
/// beads, between them, and between layers. Opening and sliding spend the same energy per area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draws {
    /// Where they are pulled apart.
    pub opened: [f64; 3],
    /// Where they slide.
    pub slid: [f64; 3],
}

/// How a ply fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Mode {
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

impl Mode {
    /// Every mode.
    pub const ALL: [Self; 5] = [Self::Along, Self::Across, Self::Shear, Self::Compression, Self::Layers];

    /// What reports call it.
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

/// What a ply has left: a share of 1 along its beads and between them.
pub const LEAST_LEFT: f64 = 1e-4;

/// How much is lost once a ply was drawn to `drawn` times the strain at which it began to break, where it carries
/// nothing at `most`: softening in a straight line.
pub fn lost(drawn: f64, most: f64) -> f64 {
    if drawn <= 1.0 {
        return 0.0;
    }
    let left = (most - drawn) / (drawn * (most - 1.0));
    (1.0 - left).clamp(0.0, 1.0 - LEAST_LEFT)
}

/// Share of the energy spent at this strain.
pub fn spent(drawn: f64, most: f64) -> f64 {
    // Triangle under the softening line, less what unloads elastically.
    let at = drawn.clamp(1.0, most);
    ((at - 1.0) / (most - 1.0)).clamp(0.0, 1.0)
}

/// Stress from strain in the ply's axes with these shares lost along and between beads.
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub fn broken(elastic: &Orthotropic, lost: [f64; 2]) -> Result<PlaneStiffness, Unstable> {
    // Torn beads hold nothing sideways either.
    let (l1, l2) = (1.0 - lost[0], 1.0 - lost[1].max(lost[0]));
    let [e1, e2, _] = elastic.e_mpa;
    let n12 = elastic.nu[0];
    let s = [1.0 / (e1 * l1), -n12 / e1, 1.0 / (e2 * l2)];
    let det = s[0] * s[2] - s[1] * s[1];
    let g = elastic.g_mpa[0] * l2;
    if !(det > 0.0 && det.is_finite() && g > 0.0 && s[0] > 0.0) {
        return Err(Unstable);
    }
    Ok([[s[2] / det, -s[1] / det, 0.0], [-s[1] / det, s[0] / det, 0.0], [0.0, 0.0, g]])
}

/// Shares left of stresses 11, 22, 33, 12, 23, 13 with these shares lost along the beads, between them and between
/// layers, and this share of a layer lying on the one below.
pub fn left(lost: [f64; 3], bond: f64) -> [f64; 6] {
    let (along, across, up) = (1.0 - lost[0], 1.0 - lost[1].max(lost[0]), (1.0 - lost[2]) * bond);
    [along, across, up, across, across.min(up), up]
}

/// The same as [`broken`] in space: stress from strain, order 11, 22, 33, 12, 23, 13, of a layer that also parts from
/// the one below. `bond` is the share of it that lies on that.
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub fn broken_solid(elastic: &Orthotropic, lost: [f64; 3], bond: f64) -> Result<Stiffness, Unstable> {
    let l = left(lost, bond);
    let (e, nu, g) = (elastic.e_mpa, elastic.nu, elastic.g_mpa);
    // Only what resists directly becomes softer: the compliances between axes stay, and with them stability.
    let softer = Orthotropic {
        e_mpa: [e[0] * l[0], e[1] * l[1], e[2] * l[2]],
        nu: [nu[0] * l[0], nu[1] * l[1], nu[2] * l[0]],
        g_mpa: [g[0] * l[3], g[1] * l[4], g[2] * l[5]],
    };
    softer.stiffness()
}

/// A ply stiffness seen from x and y.
pub fn turned(c: &PlaneStiffness, angle_rad: f64) -> PlaneStiffness {
    rotated_plane(c, angle_rad)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn pla() -> StrengthCard {
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
    fn an_unbroken_ply_is_plane_stress_and_a_broken_one_softer() {
        let card = pla();
        let whole = broken(&card.elastic, [0.0, 0.0]).expect("stable");
        let want = card.elastic.plane_stress(0.0).expect("stable");
        for (a, b) in whole.iter().flatten().zip(want.iter().flatten()) {
            assert!((a - b).abs() < 1e-9 * whole[0][0], "{whole:?} {want:?}");
        }
        let between = broken(&card.elastic, [0.0, 0.99]).expect("stable");
        assert!(between[0][0] > 0.8 * card.elastic.e_mpa[0] && between[1][1] < 0.02 * whole[1][1]);
        let through = broken(&card.elastic, [0.99, 0.0]).expect("stable");
        assert!(through[0][0] < 0.02 * whole[0][0] && through[1][1] < 0.02 * whole[1][1]);
    }

    #[test]
    fn the_curve_off_axis_ends_at_the_strengths() {
        let card = pla();
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!((card.tsai_hill_mpa(0.0) - 52.0).abs() < 1e-9);
        assert!((card.tsai_hill_mpa(quarter) - 37.0).abs() < 1e-9);
        assert_eq!(card.index([-30.0, 0.0, 0.0]).1, Mode::Compression);
        assert_eq!(card.index([0.0, 10.0, 9.0]).1, Mode::Shear);
        let mut last = f64::INFINITY;
        for deg in [0.0, 15.0, 30.0f64] {
            let now = card.tsai_hill_mpa(deg.to_radians());
            assert!(now < last && now <= card.hankinson_mpa(deg.to_radians()) + 1e-9);
            last = now;
        }
    }

    #[test]
    fn softening_is_a_straight_line_that_holds_the_energy() {
        for most in [1.5, 4.0, 40.0] {
            // Stress over strength at strain `d` is d (1 - lost); its area is that of the triangle.
            let n = 4000;
            let step = most / f64::from(n);
            let area: f64 =
                (0..n).map(|k| (f64::from(k) + 0.5) * step).map(|d| d * (1.0 - lost(d, most)) * step).sum();
            assert!((area - 0.5 * most).abs() < 2e-3 * most, "{most}: {area}");
            assert!(lost(most, most) > 0.999 && lost(1.0, most) == 0.0);
        }
    }
}
