//! Stress at the nodes of a plate from the stress inside its elements.
//!
//! Method: superconvergent patch recovery (`zienkiewicz1992`). Stresses are computed at the three integration
//! points of each element, where they are most accurate. For each corner node a quadratic in x and y is
//! fitted to them by least squares, one for each component. The patch holds the elements around the corner,
//! and up to three rings of elements more until it has 12 samples, twice the coefficients. The middle of a
//! side gets the mean of the quadratics of both its ends.
//!
//! Stresses are in MPa, components xx, yy, xy, one for each node. Cost: linear in the elements. The stiffness
//! is taken at the middle of each element.
//!
//! Degenerate cases: coefficients that the samples do not determine stay zero. A node that belongs to no
//! element has no stress. A fit reaches across a jump of the stiffness, and smooths the jump of stress that
//! belongs to it.

use grainpath_core::DVec2;
use grainpath_core::dense::solve_spd;
use rayon::prelude::*;

use super::plane_problem::PlaneProblem;
use super::quadratic_triangle::{self as element, POINTS};
use crate::principal::PlaneTensor;

/// A patch with fewer samples than this also uses the elements around it. Source: derived: a quadratic in
/// the plane has six coefficients; with twice as many samples no single sample decides a coefficient.
const ENOUGH: usize = 12;

/// Stress at every node, and at the integration points of every element. Each corner's quadratic is
/// evaluated at the corner and at the middles of its sides.
pub(super) fn recover(problem: &PlaneProblem<'_>, u: &[DVec2]) -> (Vec<PlaneTensor>, Vec<[PlaneTensor; 3]>) {
    let mesh = problem.mesh;
    let samples: Vec<[(DVec2, PlaneTensor); 3]> = mesh
        .elements
        .par_iter()
        .map(|e| {
            let p = e.map(|i| mesh.nodes[i as usize]);
            let d = e.map(|i| u[i as usize]);
            let c = (problem.stiffness)((p[0] + p[1] + p[2]) / 3.0);
            POINTS.map(|(l, _)| {
                let (n, _) = element::shape(&p, l);
                let at = (0..6).map(|k| n[k] * p[k]).sum();
                (at, element::stress(&p, &d, &c, l))
            })
        })
        .collect();
    // A counting sort of the elements by their corners.
    let mut starts = vec![0u32; mesh.nodes.len() + 1];
    let corners = || mesh.elements.iter().enumerate().flat_map(|(t, e)| e[..3].iter().map(move |&i| (t, i)));
    corners().for_each(|(_, i)| starts[i as usize + 1] += 1);
    (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
    let mut next = starts.clone();
    let mut around = vec![0u32; starts[mesh.nodes.len()] as usize];
    for (t, i) in corners() {
        around[next[i as usize] as usize] = t as u32;
        next[i as usize] += 1;
    }
    let touching = |i: usize| &around[starts[i] as usize..starts[i + 1] as usize];
    let fits: Vec<Option<Fit>> = (0..mesh.nodes.len())
        .into_par_iter()
        .map(|i| {
            let mut patch = touching(i).to_vec();
            if patch.is_empty() {
                return None;
            }
            // A patch is extended by three rings of elements at most: a corner that belongs to a
            // single element starts with three samples.
            for _ in 0..3 {
                if 3 * patch.len() >= ENOUGH {
                    break;
                }
                let ring: Vec<u32> = patch
                    .iter()
                    .flat_map(|&t| mesh.elements[t as usize][..3].iter())
                    .flat_map(|&k| touching(k as usize).iter().copied())
                    .collect();
                patch.extend(ring);
                patch.sort_unstable();
                patch.dedup();
            }
            Some(Fit::new(mesh.nodes[i], patch.iter().flat_map(|&t| samples[t as usize])))
        })
        .collect();
    let mut sum = vec![([0.0; 3], 0.0); mesh.nodes.len()];
    let mut add = |at: usize, value: PlaneTensor| {
        (0..3).for_each(|k| sum[at].0[k] += value[k]);
        sum[at].1 += 1.0;
    };
    for (i, fit) in fits.iter().enumerate() {
        if let Some(fit) = fit {
            add(i, fit.at(mesh.nodes[i]));
        }
    }
    // The middle of a side gets the mean of the quadratics of both its ends.
    for e in &mesh.elements {
        for k in 0..3 {
            for end in [k, (k + 1) % 3] {
                if let Some(fit) = &fits[e[end] as usize] {
                    add(e[3 + k] as usize, fit.at(mesh.nodes[e[3 + k] as usize]));
                }
            }
        }
    }
    let nodal = sum.into_iter().map(|(s, n): (PlaneTensor, f64)| s.map(|v| v / n.max(1.0))).collect();
    (nodal, samples.into_iter().map(|s| s.map(|(_, stress)| stress)).collect())
}

/// A quadratic in x and y about a point, for each stress component.
struct Fit {
    origin: DVec2,
    scale: f64,
    coefficients: [PlaneTensor; 6],
}

impl Fit {
    fn new(origin: DVec2, samples: impl Iterator<Item = (DVec2, PlaneTensor)> + Clone) -> Self {
        // Coordinates are divided by the size of the patch, so that the terms of the normal
        // equations are of the same order.
        let scale = samples.clone().map(|(p, _)| p.distance(origin)).fold(1e-12, f64::max);
        let mut normal = [[0.0; 6]; 6];
        let mut rhs = [[0.0; 3]; 6];
        for (p, value) in samples {
            let row = terms((p - origin) / scale);
            for i in 0..6 {
                (0..6).for_each(|j| normal[i][j] += row[i] * row[j]);
                (0..3).for_each(|j| rhs[i][j] += row[i] * value[j]);
            }
        }
        Self { origin, scale, coefficients: solve_spd(normal, rhs) }
    }

    fn at(&self, p: DVec2) -> PlaneTensor {
        let row = terms((p - self.origin) / self.scale);
        let mut out = [0.0; 3];
        for (t, c) in row.iter().zip(&self.coefficients) {
            (0..3).for_each(|k| out[k] += t * c[k]);
        }
        out
    }
}

fn terms(p: DVec2) -> [f64; 6] {
    [1.0, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y]
}
