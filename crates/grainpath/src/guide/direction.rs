//! The directions of one layer from the stress: an axis at every point of its section, which beads follow.
//!
//! Method: at every node of a square grid the wanted axis is a principal direction of the stress. Its weight
//! is the difference of both principal stresses, because that is what a bead in another direction loses. Axes
//! are written in double angles, `(cos 2a, sin 2a)`, where both senses of an axis are the same vector and the
//! weighted axes of several load cases add up to a single vector. The field is the smoothest one close to the
//! wanted axes: it minimises the squared differences between neighbouring nodes plus the weighted squared
//! distances from the wanted axes (a screened Poisson problem). This energy is our own; it is quadratic, so
//! one linear system has the answer. Where both principal stresses have about the same magnitude, two more
//! rounds let the neighbourhood choose between them.
//!
//! Lengths are in mm, stresses in MPa, angles in radians. Smoothing reaches `smoothing_mm` where the
//! principal stresses differ most, and farther where they differ less. Free borders pull on the axes beside
//! them with a weight of 0.2. Cost: two or six solves by conjugate gradients (`hestenes1952`), at most 400
//! iterations each, linear in the nodes.
//!
//! Degenerate cases: an empty section has axis 0 and strength 0. Without stress and free borders every axis
//! is that of +x, or of y in a layer that follows the other principal direction, with strength 0. Where load
//! cases ask for axes at right angles with equal weight, neighbours decide. Points where the principal
//! stresses are equal are found on request (`degenerate`).

use std::sync::Arc;

use grainpath_core::math::{atan2, sin_cos};
use grainpath_core::poly::edges;
use grainpath_core::{DVec2, DVec3, DirectionField, DirectionSample, Region};
use grainpath_fea::degenerate::{Degenerates, of_section};
use grainpath_fea::principal::{along, plane_principal};

use super::CaseStress;
use grainpath_core::field_mesh::{FieldMesh, GridMatrix};
pub use grainpath_job::choices::Follow;

/// Settings for turning stress into directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionSettings {
    /// The principal stress that beads follow.
    pub follow: Follow,
    /// Whether this layer follows the other principal direction.
    pub across: bool,
    /// Length over which directions are smoothed in places where the principal stresses differ most, mm.
    pub smoothing_mm: f64,
    /// Whether directions are aligned with free borders.
    pub tangent: bool,
    /// Distance between the field's nodes, mm.
    pub cell_mm: f64,
    /// Unit vector along the rows of the nodes.
    pub rows: DVec2,
    /// Whether to find the degenerate points of the layer.
    pub find_degenerate: bool,
}

/// The directions of one layer, smoothed where both principal stresses are nearly equal.
///
/// Each node stores the axis as the vector `(cos 2a, sin 2a)`, which is the same for both signs of the axis.
pub struct LayerField {
    mesh: Option<Arc<FieldMesh>>,
    double: Vec<DVec2>,
    strength: Vec<f64>,
    principal_mpa: Vec<[f64; 2]>,
    degenerate: Degenerates,
}

/// If the magnitudes of the two principal stresses differ by less than this share, a bead may follow either
/// of them.
pub(super) const EITHER: f64 = 0.25;
/// Weight of a free border relative to that of a large stress.
const BORDER_WEIGHT: f64 = 0.2;

/// A layer's section with the stress of every load case at its nodes. Fields for different weights are made from it.
pub struct StressedSection<'a> {
    region: &'a Region,
    z_mm: f64,
    cases: &'a [CaseStress],
    /// `None` for an empty section.
    mesh: Option<Arc<FieldMesh>>,
    /// The stress of each case at each node.
    stresses: Vec<Vec<[f64; 3]>>,
    /// Nodes at free borders, each with the border's tangent.
    border: Vec<(u32, DVec2)>,
}

impl<'a> StressedSection<'a> {
    /// The section at height `z_mm` under all load cases. `free` is true for points of the border that are
    /// neither held nor loaded.
    pub fn new(
        region: &'a Region,
        z_mm: f64,
        cases: &'a [CaseStress],
        free: &dyn Fn(DVec3) -> bool,
        settings: &DirectionSettings,
    ) -> Self {
        let mesh = FieldMesh::along(region, settings.cell_mm, settings.rows).map(Arc::new);
        let nodes = mesh.as_ref().map_or(&[][..], |m| &m.nodes);
        let stresses =
            nodes.iter().map(|p| cases.iter().map(|c| c.stress.at(p.extend(z_mm))).collect()).collect();
        let border = match &mesh {
            Some(mesh) if settings.tangent => tangents(mesh, region, z_mm, free),
            _ => Vec::new(),
        };
        Self { region, z_mm, cases, mesh, stresses, border }
    }

    /// The position of each node, and the stress of every load case there.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (DVec3, &[[f64; 3]])> {
        let nodes = self.mesh.iter().flat_map(|m| &m.nodes).map(|p| p.extend(self.z_mm));
        nodes.zip(self.stresses.iter().map(Vec::as_slice))
    }

    /// The field for load cases weighted by `emphasis`. `free` means the same as in [`Self::new`].
    pub fn field(
        &self,
        emphasis: &[f64],
        free: &dyn Fn(DVec3) -> bool,
        settings: &DirectionSettings,
    ) -> LayerField {
        let Self { region, z_mm, cases, stresses, border, .. } = self;
        let Some(mesh) = self.mesh.clone() else {
            return LayerField {
                mesh: None,
                double: Vec::new(),
                strength: Vec::new(),
                principal_mpa: Vec::new(),
                degenerate: Degenerates::default(),
            };
        };
        // The loss of a direction is the sum over cases of |s1 - s2| times the squared sine of the
        // angle to the principal axis. In double angles that sum is a single vector.
        let wanted = |near: Option<&[DVec2]>| -> Vec<(DVec2, f64)> {
            let node = |(i, tensors): (usize, &Vec<[f64; 3]>)| {
                tensors.iter().zip(emphasis).fold((DVec2::ZERO, 0.0), |(sum, all), (tensor, emphasis)| {
                    let (axis, certain) = followed(*tensor, settings.follow, near.map(|n| n[i]));
                    let p = plane_principal(*tensor);
                    let loss = emphasis * (p.values_mpa[0] - p.values_mpa[1]);
                    (sum + certain * loss * axis, all + loss)
                })
            };
            stresses.iter().enumerate().map(node).collect()
        };
        let first = wanted(None);
        let scale = typical(first.iter().map(|w| w.1));
        let mut double = settle(&mesh, &first, scale, border, settings, None);
        // Where both principal stresses have about the same magnitude, the neighbourhood decides: two more
        // rounds follow the field found so far.
        if matches!(settings.follow, Follow::MaxAbs | Follow::Alternate) {
            for _ in 0..2 {
                double = settle(&mesh, &wanted(Some(&double)), scale, border, settings, Some(&double));
            }
        }
        double.iter_mut().for_each(|q| *q = q.normalize_or(DVec2::X));
        let strength = first.iter().map(|w| (w.1 / scale).min(1.0)).collect();
        // Negating double angles turns every axis by 90 degrees.
        if settings.across {
            double.iter_mut().for_each(|q| *q = -*q);
        }
        // The stresses along and across the axis are those of the load case with the largest emphasis.
        let main = heaviest(emphasis);
        let principal_mpa = stresses
            .iter()
            .zip(&double)
            .map(|(s, q)| {
                let axis = 0.5 * atan2(q.y, q.x);
                let across = axis + std::f64::consts::FRAC_PI_2;
                main.map_or([0.0; 2], |m| [along(s[m], axis), along(s[m], across)])
            })
            .collect();
        let weights: Vec<f64> = cases.iter().map(|c| c.weight).collect();
        let degenerate = heaviest(&weights).filter(|_| settings.find_degenerate).map(|m| {
            let nodal: Vec<[f64; 3]> = stresses.iter().map(|s| s[m]).collect();
            let at = |p: DVec2| cases[m].stress.at(p.extend(*z_mm));
            of_section(&mesh, &nodal, region, &at, &|p| free(p.extend(*z_mm)))
        });
        LayerField {
            mesh: Some(mesh),
            double,
            strength,
            principal_mpa,
            degenerate: degenerate.unwrap_or_default(),
        }
    }
}

/// The index of the largest weight; if several are equal, the first of them.
fn heaviest(weights: &[f64]) -> Option<usize> {
    (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]).then(b.cmp(&a)))
}

impl LayerField {
    /// The axis at each node, radians, in the order of [`StressedSection::nodes`].
    pub(super) fn axes_rad(&self) -> impl Iterator<Item = f64> {
        self.double.iter().map(|q| 0.5 * atan2(q.y, q.x))
    }

    /// The points where the principal stresses of the load case with the largest weight are equal. The list
    /// is empty if the settings did not ask for them.
    pub fn degenerate(&self) -> &Degenerates {
        &self.degenerate
    }
}

impl DirectionField for LayerField {
    fn rows(&self) -> DVec2 {
        self.mesh.as_ref().map_or(DVec2::X, |mesh| mesh.along)
    }

    fn sample(&self, p: DVec3) -> DirectionSample {
        let Some(mesh) = &self.mesh else {
            return DirectionSample { axis_rad: 0.0, strength: 0.0, principal_mpa: None };
        };
        // Double angles are interpolated: the mean of axes at 1 and 179 degrees then is 0, not 90.
        let (nodes, shares) = mesh.around(p.truncate());
        let mut q = DVec2::ZERO;
        let (mut strength, mut principal) = (0.0, [0.0; 2]);
        for (&i, share) in nodes.iter().zip(shares).filter(|(_, s)| *s > 0.0) {
            let i = i as usize;
            q += share * self.double[i];
            strength += share * self.strength[i];
            (0..2).for_each(|k| principal[k] += share * self.principal_mpa[i][k]);
        }
        let axis_rad = (0.5 * atan2(q.y, q.x)).rem_euclid(std::f64::consts::PI);
        DirectionSample { axis_rad, strength, principal_mpa: Some(principal) }
    }
}

/// The axis to follow, in double angles, and its certainty. If both principal stresses have about the same
/// magnitude, the axis nearer to `near` is taken.
fn followed(tensor: [f64; 3], follow: Follow, near: Option<DVec2>) -> (DVec2, f64) {
    let p = plane_principal(tensor);
    let [a, b] = p.values_mpa;
    let (s, c) = sin_cos(2.0 * p.axis_rad);
    let greater = DVec2::new(c, s);
    match follow {
        Follow::Tension => return (greater, 1.0),
        Follow::Compression => return (-greater, 1.0),
        Follow::MaxAbs | Follow::Alternate => {}
    }
    let apart = (a.abs() - b.abs()) / (a.abs() + b.abs()).max(f64::MIN_POSITIVE);
    let axis = if apart >= 0.0 { greater } else { -greater };
    if apart.abs() >= EITHER {
        return (axis, 1.0);
    }
    match near {
        Some(q) => (if greater.dot(q) >= 0.0 { greater } else { -greater }, 1.0),
        // Without a neighbourhood the certainty falls to zero where both magnitudes are equal, so that
        // other nodes decide.
        None => (axis, (apart / EITHER).powi(2)),
    }
}

/// The axis that the stress alone asks for at a point, as a vector in double angles, and its weight in MPa:
/// the length of the sum over all load cases of |s1 - s2| along the followed axis, weighted by `emphasis`.
pub(super) fn asked(cases: &[CaseStress], emphasis: &[f64], follow: Follow, p: DVec3) -> (DVec2, f64) {
    let sum = cases.iter().zip(emphasis).fold(DVec2::ZERO, |sum, (case, emphasis)| {
        let tensor = case.stress.at(p);
        let [a, b] = plane_principal(tensor).values_mpa;
        let greater = if follow == Follow::Compression || (follow != Follow::Tension && b.abs() > a.abs()) {
            -1.0
        } else {
            1.0
        };
        let (s, c) = sin_cos(2.0 * plane_principal(tensor).axis_rad);
        sum + emphasis * (a - b) * greater * DVec2::new(c, s)
    });
    (sum.normalize_or(DVec2::X), sum.length())
}

/// The ninth decile: a typical value that does not depend on peaks at corners and at the edges of
/// loads.
fn typical(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    let at = all.len() * 9 / 10;
    if all.is_empty() {
        return 1.0;
    }
    let (_, value, _) = all.select_nth_unstable_by(at, f64::total_cmp);
    value.max(1e-9)
}

/// The smoothest field close to the wanted axes: it minimises `sum |q_i - q_j|^2 + (cell / smoothing)^2 sum
/// w |q - wanted|^2`. The iteration starts from `before` if it is given. Vectors are shorter than 1 where
/// wanted axes disagree.
fn settle(
    mesh: &FieldMesh,
    wanted: &[(DVec2, f64)],
    scale: f64,
    border: &[(u32, DVec2)],
    settings: &DirectionSettings,
    before: Option<&[DVec2]>,
) -> Vec<DVec2> {
    let n = mesh.nodes.len();
    let keep = (mesh.cell_mm / settings.smoothing_mm).powi(2);
    // The tiny weight keeps the matrix positive definite if no stress acts at all.
    let mut weight = vec![1e-7; n];
    let mut pull = vec![DVec2::ZERO; n];
    for (i, (q, all)) in wanted.iter().enumerate() {
        let w = keep * (all / scale).min(1.0);
        // Load cases that disagree, or an uncertain choice, get less weight.
        let length = q.length();
        let certain = if *all > 0.0 { (length / all).min(1.0) } else { 0.0 };
        weight[i] += w * certain;
        pull[i] += w * certain * q.normalize_or_zero();
    }
    for &(i, tangent) in border {
        weight[i as usize] += keep * BORDER_WEIGHT;
        pull[i as usize] += keep * BORDER_WEIGHT * tangent;
    }
    let mut matrix = GridMatrix::zero(mesh, false);
    matrix.add_springs(1.0);
    matrix.own.iter_mut().zip(&weight).for_each(|(own, w)| *own += w);
    let solve = |part: fn(&DVec2) -> f64| {
        let rhs: Vec<f64> = pull.iter().map(part).collect();
        let start: Vec<f64> = match before {
            Some(q) => q.iter().map(part).collect(),
            None => pull.iter().zip(&weight).map(|(p, w)| part(p) / w.max(1e-3)).collect(),
        };
        matrix.solve(start, &rhs, 1e-5, 400)
    };
    let (x, y) = (solve(|p| p.x), solve(|p| p.y));
    x.into_iter().zip(y).map(|(x, y)| DVec2::new(x, y)).collect()
}

/// Nodes next to the free border, each with the border's tangent in double angles.
fn tangents(mesh: &FieldMesh, region: &Region, z_mm: f64, free: &dyn Fn(DVec3) -> bool) -> Vec<(u32, DVec2)> {
    let mut sums: std::collections::BTreeMap<u32, DVec2> = std::collections::BTreeMap::new();
    for contour in region.contours() {
        for (a, b) in edges(contour) {
            let d = b - a;
            let Some(t) = d.try_normalize() else { continue };
            let double = DVec2::new(t.x * t.x - t.y * t.y, 2.0 * t.x * t.y);
            let steps = (d.length() / (0.5 * mesh.cell_mm)).ceil().max(1.0) as usize;
            for k in 0..steps {
                let p = a + d * ((k as f64 + 0.5) / steps as f64);
                if !free(p.extend(z_mm)) {
                    continue;
                }
                let (nodes, shares) = mesh.around(p);
                // A node with less than a fifth of the interpolation weight is too far from the border to
                // be aligned with it.
                for (&i, share) in nodes.iter().zip(shares).filter(|(_, s)| *s > 0.2) {
                    *sums.entry(i).or_insert(DVec2::ZERO) += share * double * (d.length() / steps as f64);
                }
            }
        }
    }
    sums.into_iter().filter_map(|(i, q)| Some((i, q.try_normalize()?))).collect()
}
