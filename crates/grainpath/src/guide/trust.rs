//! Warnings about a stress result: whether its numbers can be trusted.
//!
//! A case without stress has loads of zero, or loads that fixtures take up at once. A stress far beyond the strength points
//! to a wrong load or unit. A large mesh error hides the peak. Loads and reactions that do not cancel mean a broken model.
//! A large displacement breaks the assumption of small strains.

use super::{GuidedPart, ResultMesh, StressSettings, StressSummary};
use grainpath_core::tensor::von_mises;
use grainpath_core::{DMat3, DVec3, Diagnostics, TriMesh, Warning, WarningId};

/// A peak above this multiple of the strength along the beads points to a mistake in the loads or
/// in a unit, or to a singular corner. Source: chosen; a requirement of the project.
const MAX_STRENGTH_MULTIPLE: f64 = 2.0;
/// A warning is given if the mesh misses more than this estimated share of the stress. Source: chosen; a requirement of the project.
pub(super) const MAX_MESH_ERROR: f64 = 0.1;
/// A warning is given if the relative imbalance of loads and reactions is above this. Source: chosen; a requirement of the project.
const MAX_IMBALANCE: f64 = 1e-3;
/// The report states no reserve if the peak stress is above this multiple of the strength. Source: chosen; a requirement of the
/// project.
const MAX_RESERVE_MULTIPLE: f64 = 5.0;
/// The report states no reserve if the mesh misses more than this estimated share of the stress. Source: chosen; a requirement of the
/// project.
const MAX_RESERVE_MESH_ERROR: f64 = 0.3;
/// Displacement over the longest side of the part at which small displacements are no longer small.
/// Source: chosen; a requirement of the project.
const MAX_DISPLACEMENT_SHARE: f64 = 0.05;
/// Stresses along x and y that differ by less than this share of the largest component are the same. Source: derived: turning
/// a tensor with its part rounds it to 1e-15 of its size, and files have at most 17 digits.
const SAME_STRESS: f64 = 1e-12;

/// Adds a warning for each limit that a result exceeds.
pub(super) fn warn(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    summary: &StressSummary,
    results: &[ResultMesh],
    diagnostics: &Diagnostics,
) {
    // Imported stress of zero is told by its reader.
    for case in results.iter().filter(|case| summary.dofs > 0 && !has_stress(case)) {
        let text = format!(
            "case {:?} leaves the part without stress: its loads are zero, or act only where the part is held",
            case.name
        );
        diagnostics.warn(WarningId::StressNone, text);
    }
    if summary.dofs == 0 && results.iter().all(|case| has_stress(case) && !has_direction(case)) {
        let text = "the stress is the same in all directions of the layers; the beads have no direction to follow and run along x";
        diagnostics.warn(WarningId::FeZeroStress, text);
    }
    let peak = peak_stress(results);
    if let (Some((stress_mpa, place)), Some(strength_mpa)) = (peak, settings.strength_mpa)
        && stress_mpa > MAX_STRENGTH_MULTIPLE * strength_mpa
    {
        let text = format!(
            "the peak stress of {stress_mpa:.0} MPa is {:.1} times the material's strength of {strength_mpa:.0} MPa",
            stress_mpa / strength_mpa
        );
        diagnostics.push(Warning::new(WarningId::StressBeyondStrength, text).at_point_mm(place));
    }
    if summary.error_estimate > MAX_MESH_ERROR {
        let text = format!(
            "the elements miss about {:.0} % of the stress; more than {:.0} % makes the peak unreliable",
            100.0 * summary.error_estimate,
            100.0 * MAX_MESH_ERROR
        );
        diagnostics.warn(WarningId::StressMeshError, text);
    }
    for balance in &summary.balance {
        let imbalance = balance.imbalance();
        if imbalance > MAX_IMBALANCE {
            let text = format!(
                "loads and reactions of case {:?} fail to cancel by {:.2} %",
                balance.case,
                100.0 * imbalance
            );
            diagnostics.warn(WarningId::StressUnbalanced, text);
        }
    }
    let size_mm = longest_side_mm(part.mesh, part.standing.rotation);
    if summary.max_displacement_mm > MAX_DISPLACEMENT_SHARE * size_mm {
        let text = format!(
            "the part moves by {:.2} mm, {:.0} % of its longest side; linear elasticity holds for small displacements",
            summary.max_displacement_mm,
            100.0 * summary.max_displacement_mm / size_mm
        );
        diagnostics.warn(WarningId::StressLargeDisplacement, text);
    }
}

/// The longest side of a part's box before it was turned by `rotation`, mm. That of the turned part would depend on the turn.
pub(super) fn longest_side_mm(mesh: &TriMesh, rotation: DMat3) -> f64 {
    let back = rotation.transpose();
    let (low, high) = mesh.vertices.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        let p = back * *p;
        (low.min(p), high.max(p))
    });
    (high - low).max_element().max(0.0)
}

/// Whether any component of a case's stress differs from zero. Without force on nodes that can move, the solution is exactly zero.
fn has_stress(case: &ResultMesh) -> bool {
    case.stress.iter().flatten().any(|component| *component != 0.0)
}

/// Whether the principal stresses in the plane of the layers differ at any node, by more than rounding.
fn has_direction(case: &ResultMesh) -> bool {
    let largest =
        case.stress.iter().flatten().fold(0.0, |largest: f64, component| largest.max(component.abs()));
    let differs = |[xx, yy, _, xy, ..]: &[f64; 6]| (xx - yy).abs().max(xy.abs()) > SAME_STRESS * largest;
    case.stress.iter().any(differs)
}

/// Whether a stress is good enough to state a reserve: its peak is not far beyond the strength (if that is known), and
/// the mesh error is small enough.
pub(super) fn is_trusted(summary: &StressSummary) -> bool {
    let peak_mpa = summary.max_von_mises_mpa;
    let is_below = |strength_mpa: f64| peak_mpa <= MAX_RESERVE_MULTIPLE * strength_mpa;
    peak_mpa > 0.0
        && summary.strength_mpa.is_none_or(is_below)
        && summary.error_estimate <= MAX_RESERVE_MESH_ERROR
}

/// Strength over peak stress; `None` unless both are known and the peak can be trusted.
pub(super) fn reserve(summary: &StressSummary) -> Option<f64> {
    let strength_mpa = summary.strength_mpa?;
    is_trusted(summary).then(|| strength_mpa / summary.max_von_mises_mpa)
}

/// The largest equivalent stress of all cases, MPa, and the position of its node.
pub(super) fn peak_stress(results: &[ResultMesh]) -> Option<(f64, DVec3)> {
    results.iter().filter_map(ResultMesh::peak_stress).max_by(|a, b| a.0.total_cmp(&b.0))
}

impl ResultMesh {
    /// Its largest equivalent stress, MPa, and the position of that node.
    pub(crate) fn peak_stress(&self) -> Option<(f64, DVec3)> {
        let all = self.stress.iter().zip(&self.nodes);
        all.map(|(stress, place)| (von_mises(stress), *place)).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Its largest displacement, mm; `None` where none is known.
    pub(crate) fn max_displacement_mm(&self) -> Option<f64> {
        self.displacement.as_ref().map(|all| all.iter().map(|u| u.length()).fold(0.0, f64::max))
    }
}
