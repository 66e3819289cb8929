//! Stresses at the nodes of a mesh of tetrahedra, and an estimate of the error that the mesh leaves in them.
//!
//! Method: superconvergent patch recovery (`zienkiewicz1992`). Stresses are computed at the four integration
//! points of each element, where they are most accurate. Around each corner node a polynomial is fitted to
//! them by least squares, one for each component. It is quadratic if the patch has 30 samples or more, linear
//! from 8 on, constant below. The patch grows by up to two rings of elements to reach 30. A middle node takes
//! the mean of the fits at both ends of its side. The difference between recovered and computed stress,
//! measured in energy, estimates the error (`zienkiewicz1987`).
//!
//! Stresses are in MPa in the order xx, yy, zz, xy, yz, zx, one for each node. Errors are in the energy norm,
//! the root of N mm, one for each element; the error of the whole is relative to the energy of the recovered
//! stress. Cost: linear in the nodes. Memory while it runs: about 0.3 KB an element and 0.6 KB a node.
//!
//! Degenerate cases: the patch of a corner inside one material stops at other materials; a corner where
//! materials meet takes a mean over them. Terms of a polynomial that the samples cannot tell apart are left
//! out. A node without an element has no stress. Without stress the relative error is 0. A material that is
//! not positive definite is an error.

use grainpath_core::dense::solve_spd;
use grainpath_core::{DMat3, DVec3};
use rayon::prelude::*;

use super::model::adjacency::incidence;
use super::model::error::SolidError;
use super::model::material_map::Model;
use super::model::quadratic_tet::{self as element, STIFFNESS_RULE};
use super::model::tet_shape::EDGES;

/// Stress in MPa, order xx, yy, zz, xy, yz, zx.
pub type Stress = [f64; 6];

/// Recovered stresses.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// At each node; where materials meet, a mean over them.
    pub stress_mpa: Vec<Stress>,
    /// Estimated error of each element in the energy norm, root of N mm.
    pub error: Vec<f64>,
    /// Estimated error over the whole, as a share of the solution in the energy norm: 0 for an exact one, and 1 or more
    /// for a mesh that shows next to nothing of the stress.
    pub relative_error: f64,
}

/// Least number of samples for a quadratic fit. Source: derived: three samples for each of its ten
/// coefficients.
const FOR_QUADRATIC: usize = 30;

/// Recovers the stresses of a displacement field. `initial_strain` is the strain that causes no stress,
/// such as thermal expansion, with engineering shears.
///
/// # Errors
/// A material whose stiffness is not positive definite.
pub fn recover(
    model: &Model<'_>,
    displacement: &[DVec3],
    initial_strain: Option<&(dyn Fn(DVec3) -> [f64; 6] + Sync)>,
) -> Result<Recovered, SolidError> {
    let mesh = model.mesh;
    let laws = model.laws()?;
    let sample = |t: usize| -> [(DVec3, Stress); 4] {
        let x = mesh.places(t);
        let u = mesh.tets[t].map(|i| displacement[i as usize]);
        // Stresses are sampled at the integration points, where elements give them most accurately.
        STIFFNESS_RULE.map(|(l, _)| {
            let (g, _) = element::gradients(&x, &l);
            let n = element::shapes(&l);
            let p: DVec3 = x.iter().zip(&n).map(|(p, n)| *p * *n).sum();
            let grad = u
                .iter()
                .zip(&g)
                .fold(DMat3::ZERO, |m, (u, g)| m + DMat3::from_cols(*u * g.x, *u * g.y, *u * g.z));
            let mut strain = element::strain(&grad);
            if let Some(initial) = initial_strain {
                for (s, e) in strain.iter_mut().zip(initial(p)) {
                    *s -= e;
                }
            }
            (p, components(&laws[model.material(t)].stress_of_strain(&strain)))
        })
    };
    let samples: Vec<[(DVec3, Stress); 4]> = (0..mesh.tets.len()).into_par_iter().map(sample).collect();
    let corners: Vec<[u32; 4]> = mesh.tets.iter().map(|t| [t[0], t[1], t[2], t[3]]).collect();
    let (start, around) = incidence(mesh.nodes.len(), &corners);
    let at = |v: u32| &around[start[v as usize] as usize..start[v as usize + 1] as usize];
    let fit = |v: u32| -> Option<Fit> {
        let first = at(v);
        if first.is_empty() {
            return None;
        }
        let mut patch = first.to_vec();
        // Rings of elements are added, at most two, until the patch has enough samples.
        for _ in 0..2 {
            if 4 * patch.len() >= FOR_QUADRATIC {
                break;
            }
            patch = patch.iter().flat_map(|&t| corners[t as usize]).flat_map(at).copied().collect();
            patch.sort_unstable();
            patch.dedup();
        }
        // Elements of another material are left out, because their stresses follow another function.
        let own = model.material(first[0] as usize);
        if first.iter().all(|&t| model.material(t as usize) == own) {
            patch.retain(|&t| model.material(t as usize) == own);
        }
        Some(Fit::new(mesh.nodes[v as usize], patch.iter().flat_map(|&t| samples[t as usize])))
    };
    let fits: Vec<Option<Fit>> = (0..mesh.nodes.len() as u32).into_par_iter().map(fit).collect();
    let mut ends = vec![[u32::MAX; 2]; mesh.nodes.len()];
    for tet in &mesh.tets {
        for (e, &(i, j)) in EDGES.iter().enumerate() {
            // The ends are stored in ascending order, so it does not matter which element wrote them last.
            ends[tet[4 + e] as usize] = [tet[i].min(tet[j]), tet[i].max(tet[j])];
        }
    }
    let value = |i: usize| -> Stress {
        let p = mesh.nodes[i];
        if let Some(fit) = &fits[i] {
            return fit.at(p);
        }
        // A middle node takes the mean of the fits at both ends of its side.
        let mut sum = [0.0; 6];
        for fit in ends[i].iter().filter_map(|&e| fits.get(e as usize)?.as_ref()) {
            for (s, v) in sum.iter_mut().zip(fit.at(p)) {
                *s += 0.5 * v;
            }
        }
        sum
    };
    let stress_mpa: Vec<Stress> = (0..mesh.nodes.len()).into_par_iter().map(value).collect();
    let inverses: Vec<[[f64; 6]; 6]> = model.materials.iter().map(inverse).collect();
    let energy = |t: usize| {
        let x = mesh.places(t);
        // Energy needs strains; the compliance turns the recovered stresses into strains.
        let compliance = &inverses[model.material(t)];
        let mut sums = [0.0; 2];
        for ((l, w), (_, raw)) in STIFFNESS_RULE.iter().zip(&samples[t]) {
            let n = element::shapes(l);
            let mut smooth = [0.0; 6];
            for (&i, n) in mesh.tets[t].iter().zip(&n) {
                for (s, v) in smooth.iter_mut().zip(stress_mpa[i as usize]) {
                    *s += n * v;
                }
            }
            let (_, det) = element::gradients(&x, l);
            // The gap to the recovered stress estimates the error; the recovered stress gives the
            // scale.
            let gap: Stress = std::array::from_fn(|k| smooth[k] - raw[k]);
            for (sum, s) in sums.iter_mut().zip([gap, smooth]) {
                let e = element::multiply(compliance, &s);
                *sum += w * det * s.iter().zip(e).map(|(s, e)| s * e).sum::<f64>();
            }
        }
        sums
    };
    let energies: Vec<[f64; 2]> = (0..mesh.tets.len()).into_par_iter().map(energy).collect();
    let total = energies.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    let relative_error = if total[1] > 0.0 { (total[0] / total[1]).sqrt() } else { 0.0 };
    let error = energies.iter().map(|e| e[0].max(0.0).sqrt()).collect();
    Ok(Recovered { stress_mpa, error, relative_error })
}

fn components(s: &DMat3) -> Stress {
    [s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.y_axis.z, s.z_axis.x]
}

/// A polynomial around a point for each component.
struct Fit {
    origin: DVec3,
    scale: f64,
    n_terms: usize,
    terms: [[f64; 6]; 10],
}

fn powers(d: DVec3) -> [f64; 10] {
    [1.0, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.z * d.x]
}

impl Fit {
    fn new(origin: DVec3, samples: impl Iterator<Item = (DVec3, Stress)> + Clone) -> Self {
        let reach = samples.clone().map(|s| s.0.distance(origin)).fold(0.0, f64::max);
        // Coordinates are scaled to at most 1, so that the normal equations have terms of similar size.
        let scale = 1.0 / reach.max(f64::MIN_POSITIVE);
        let n_terms = match samples.clone().count() {
            n if n >= FOR_QUADRATIC => 10,
            // A linear fit has four terms and needs at least four samples; eight make it stable.
            n if n >= 8 => 4,
            _ => 1,
        };
        let mut m = [[0.0; 10]; 10];
        let mut b = [[0.0; 6]; 10];
        for (p, s) in samples {
            let q = powers((p - origin) * scale);
            for i in 0..n_terms {
                for j in 0..=i {
                    m[i][j] += q[i] * q[j];
                }
                for (b, s) in b[i].iter_mut().zip(s) {
                    *b += q[i] * s;
                }
            }
        }
        let terms = solve_spd(m, b);
        Self { origin, scale, n_terms, terms }
    }

    fn at(&self, p: DVec3) -> Stress {
        let q = powers((p - self.origin) * self.scale);
        std::array::from_fn(|k| (0..self.n_terms).map(|i| q[i] * self.terms[i][k]).sum())
    }
}

/// The inverse of a stiffness, which is positive definite.
fn inverse(d: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let identity = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    solve_spd(*d, identity)
}
