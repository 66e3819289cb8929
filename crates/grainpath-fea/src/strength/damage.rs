//! The stiffness that a ply keeps after it has failed.
//!
//! Method: stress falls on a straight line from the strength at damage strain 1 to nothing at the final
//! strain ([`FinalStrains`](super::card::FinalStrains)); unloading goes back to the origin (secant
//! stiffness). The area below the line is the fracture energy. A damage of `d` leaves `1 - d` of the modulus
//! in its direction; Poisson's coupling compliances stay as they are, which keeps the stiffness positive
//! definite (`matzenmiller1995` in docs/references.bib). Beads torn through carry no stress across their
//! direction either, so the damage across is at least that along.
//!
//! Damage is counted along the beads, between beads of a layer and between layers, 0 for whole material. A
//! damage strain is the strain over the strain at which failure begins. Plane stiffnesses are `(3, 3)` in the
//! order 11, 22, 12, those in space `(6, 6)` in the order 11, 22, 33, 12, 23, 13, in MPa for moduli in MPa.
//! Cost: a few dozen operations a ply, without memory.
//!
//! Limits: a damage of at most 1 - 1e-4 keeps the matrix definite. Stiffness lost is lost in compression as
//! well: a crack that closes does not carry again. Elastic constants that no stable material has are an
//! error. A final strain must be above 1.

use crate::material::{Orthotropic, Stiffness, Unstable, strain_along};
use crate::plane::PlaneStiffness;

/// The smallest share of the stiffness that damage leaves. Source: derived. A crack right through a bar still carries
/// this share of its load, which is below the accuracy of a peak, and the matrix stays definite.
pub(crate) const MIN_REMAINING: f64 = 1e-4;

/// Share of the stiffness that is lost at a damage strain: 0 up to a damage strain of 1, and all but
/// `MIN_REMAINING` from the final strain on. In between, stress falls on a straight line.
pub fn damage(damage_strain: f64, final_strain: f64) -> f64 {
    if damage_strain <= 1.0 {
        return 0.0;
    }
    let remaining = (final_strain - damage_strain) / (damage_strain * (final_strain - 1.0));
    (1.0 - remaining).clamp(0.0, 1.0 - MIN_REMAINING)
}

/// Share of the fracture energy that is spent at a damage strain, 0 to 1.
pub(crate) fn energy_share(damage_strain: f64, final_strain: f64) -> f64 {
    // The triangle under the softening line, minus the energy that unloading to the origin gives back.
    let strain = damage_strain.clamp(1.0, final_strain);
    ((strain - 1.0) / (final_strain - 1.0)).clamp(0.0, 1.0)
}

/// Plane stiffness of a ply in its own axes, with shares of it lost along and between the beads.
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub(crate) fn damaged_plane_stiffness(
    elastic: &Orthotropic,
    damage: [f64; 2],
) -> Result<PlaneStiffness, Unstable> {
    // Torn beads carry no stress across their direction either.
    let (l1, l2) = (1.0 - damage[0], 1.0 - damage[1].max(damage[0]));
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

/// The damage in the plane of a ply of which only the share `joined` carries across its beads ([`Ply::joined`]).
///
/// [`Ply::joined`]: super::laminate::Ply::joined
pub(crate) fn with_joined(damage: [f64; 2], joined: f64) -> [f64; 2] {
    [damage[0], 1.0 - (1.0 - damage[1]) * joined]
}

/// The share of each of the stresses 11, 22, 33, 12, 23, 13 that remains. `damage` is given along the beads,
/// between beads and between layers; `bond` is the share of a layer that rests on the one below.
pub(crate) fn remaining_shares(damage: [f64; 3], bond: f64) -> [f64; 6] {
    let (along, across, up) = (1.0 - damage[0], 1.0 - damage[1].max(damage[0]), (1.0 - damage[2]) * bond);
    [along, across, up, across, across.min(up), up]
}

/// Stiffness of a ply in space, order 11, 22, 33, 12, 23, 13, reduced to its [`remaining_shares`].
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub(crate) fn damaged_stiffness(
    elastic: &Orthotropic,
    damage: [f64; 3],
    bond: f64,
) -> Result<Stiffness, Unstable> {
    let l = remaining_shares(damage, bond);
    let (e, nu, g) = (elastic.e_mpa, elastic.nu, elastic.g_mpa);
    // Only the direct moduli fall. Poisson's compliances stay, and the stiffness stays positive definite.
    let softer = Orthotropic {
        e_mpa: [e[0] * l[0], e[1] * l[1], e[2] * l[2]],
        nu: [nu[0] * l[0], nu[1] * l[1], nu[2] * l[0]],
        g_mpa: [g[0] * l[3], g[1] * l[4], g[2] * l[5]],
    };
    softer.stiffness()
}

/// The stress of a ply in space on the area that still carries, order 11, 22, 33, 12, 23, 13, in its axes, which are turned by
/// `angle_rad`. The stress in the layer is that of the first strain, the stress between layers (33, 23, 13) that of the second.
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub(crate) fn carried_stress(
    elastic: &Orthotropic,
    damage: [f64; 3],
    bond: f64,
    strains: [[f64; 6]; 2],
    angle_rad: f64,
) -> Result<[f64; 6], Unstable> {
    let stiffness = damaged_stiffness(elastic, damage, bond)?;
    // Strengths are those of undamaged material, so the stress is taken on what remains.
    let remaining = remaining_shares(damage, bond);
    let [in_layer, between_layers] = strains.map(|strain| strain_along(strain, angle_rad));
    Ok(std::array::from_fn(|i| {
        let own = if matches!(i, 2 | 4 | 5) { between_layers } else { in_layer };
        stiffness[i].iter().zip(own).map(|(c, e)| c * e).sum::<f64>() / remaining[i]
    }))
}

#[cfg(test)]
mod tests {
    use super::super::card::tests::pla;
    use super::*;

    #[test]
    fn an_unbroken_ply_is_plane_stress_and_a_broken_one_softer() {
        let card = pla();
        let whole = damaged_plane_stiffness(&card.elastic, [0.0, 0.0]).expect("stable");
        let want = card.elastic.plane_stress(0.0).expect("stable");
        for (a, b) in whole.iter().flatten().zip(want.iter().flatten()) {
            assert!((a - b).abs() < 1e-9 * whole[0][0], "{whole:?} {want:?}");
        }
        let between = damaged_plane_stiffness(&card.elastic, [0.0, 0.99]).expect("stable");
        assert!(between[0][0] > 0.8 * card.elastic.e_mpa[0] && between[1][1] < 0.02 * whole[1][1]);
        let through = damaged_plane_stiffness(&card.elastic, [0.99, 0.0]).expect("stable");
        assert!(through[0][0] < 0.02 * whole[0][0] && through[1][1] < 0.02 * whole[1][1]);
    }

    #[test]
    fn softening_is_a_straight_line_that_holds_the_energy() {
        for most in [1.5, 4.0, 40.0] {
            // Stress over strength at strain `d` is d (1 - damage); its area is that of the triangle.
            let n = 4000;
            let step = most / f64::from(n);
            let area: f64 =
                (0..n).map(|k| (f64::from(k) + 0.5) * step).map(|d| d * (1.0 - damage(d, most)) * step).sum();
            assert!((area - 0.5 * most).abs() < 2e-3 * most, "{most}: {area}");
            assert!(damage(most, most) > 0.999 && damage(1.0, most) == 0.0);
        }
    }
}
