//! The mix of directions that serves several load cases best, where layers take turns.
//!
//! A *family* of directions gives each node of a section an axis: family 0 follows the stress of all cases together, family
//! k (from 1) that of case k. A *mix* is a list of up to `MOST_SLOTS` families that layers take in turn. A mix is judged as
//! plies of one material with the same strain, each with its share of the thickness. The stress of every case in the plane
//! of the layer acts on them at every node; the ply nearest to failure counts, by the criterion of
//! [`first_failure`](super::first_failure). The reserve of a case is one over its highest failure index at any node. The
//! best mix has the largest minimum reserve over all cases. Of mixes within `TIE` of it the shortest is taken; of equally
//! short ones that with the largest weighted mean of the cases' reserves.
//!
//! Limits: failure between layers is left out, because directions do not change it. At most `MOST_CASES` cases are served by
//! families of their own, those with the least reserve; all are judged. Cost: a small solve for each mix, node and case; a
//! mix is dropped at the first node where it is worse than the best so far, and nodes of the highest stress come first.

use grainpath_core::Diagnostics;
use grainpath_core::diagnostics::Interrupted;

use super::card::StrengthCard;
use super::first_failure::PlyJudge;
use crate::material::Unstable;
use crate::principal::von_mises_plane;

/// The most families that layers take in turn. Source: derived: four layers are 0.8 mm, about the thinnest plate that is
/// printed.
pub const MOST_SLOTS: usize = 4;
/// The most cases with families of their own. Source: derived: as many as there are slots.
const MOST_CASES: usize = MOST_SLOTS;
/// Reserves within this share of the best count as equal. Source: derived: a fifteenth of the error of a reserve.
const TIE: f64 = 0.01;
/// The most nodes at which mixes are judged: those of the highest stress. Source: derived. A plate of 60 x 60 mm with beads
/// of 0.45 mm has as many; judging them takes less time than their fields.
const MOST_NODES: usize = 20_000;

/// A node at which mixes are judged.
#[derive(Debug, Clone, Copy)]
pub struct MixNode<'a> {
    /// The section that it lies in.
    pub section: usize,
    /// Its number in that section.
    pub node: usize,
    /// The stress of each case, MPa, order xx, yy, xy.
    pub stresses: &'a [[f64; 3]],
}

/// Judges mixes of the direction families of some sections.
pub struct PlyMixes<'a> {
    judge: PlyJudge,
    weights: Vec<f64>,
    /// The direction in radians at each node, by section and family.
    axes_rad: Vec<Vec<Vec<f64>>>,
    /// The nodes, those of the highest stress first.
    nodes: Vec<MixNode<'a>>,
}

impl<'a> PlyMixes<'a> {
    /// Prepares the judging of mixes for beads of one card, under cases with these weights. `axes_rad` gives the direction
    /// at each node, by section and family.
    ///
    /// # Errors
    /// [`Unstable`] when the elastic constants are not those of a stable material.
    pub fn new(
        card: &StrengthCard,
        weights: Vec<f64>,
        axes_rad: Vec<Vec<Vec<f64>>>,
        nodes: Vec<MixNode<'a>>,
    ) -> Result<Self, Unstable> {
        let most_mpa = |n: &MixNode<'_>| n.stresses.iter().map(|s| von_mises_plane(*s)).fold(0.0, f64::max);
        let mut nodes: Vec<(f64, MixNode<'a>)> = nodes.into_iter().map(|n| (most_mpa(&n), n)).collect();
        nodes.retain(|(most_mpa, _)| *most_mpa > 0.0 && most_mpa.is_finite());
        nodes.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1.section, a.1.node).cmp(&(b.1.section, b.1.node))));
        nodes.truncate(MOST_NODES);
        let nodes = nodes.into_iter().map(|n| n.1).collect();
        Ok(Self { judge: PlyJudge::new(card)?, weights, axes_rad, nodes })
    }

    /// The highest failure index of each case under a mix of families, each with its share of the thickness. `None` as soon
    /// as one of them is above `most`.
    fn indices(&self, mix: &[(usize, f64)], most: f64) -> Option<Vec<f64>> {
        let (mut highest, mut here) = (vec![0.0f64; self.weights.len()], Vec::new());
        let mut plies = Vec::with_capacity(mix.len());
        for node in &self.nodes {
            let axes = &self.axes_rad[node.section];
            plies.clear();
            plies.extend(mix.iter().map(|&(family, share)| (axes[family][node.node], share)));
            self.judge.indices(&plies, node.stresses, &mut here);
            for (highest, index) in highest.iter_mut().zip(&here) {
                *highest = highest.max(*index);
            }
            if highest.iter().any(|index| *index > most) {
                return None;
            }
        }
        Some(highest)
    }

    /// The best mix: the numbers of the families that layers take in turn. For a number of turns, `shares` returns the part
    /// of the thickness that each turn has.
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn best(
        &self,
        shares: &dyn Fn(usize) -> Vec<f64>,
        diagnostics: &Diagnostics,
    ) -> Result<Vec<usize>, Interrupted> {
        let (mut least, mut found) = (f64::INFINITY, Vec::new());
        // Short mixes come first, so that the bound is low before the many long ones are tried.
        for mix in mixes(&self.picked()) {
            diagnostics.check()?;
            let shares = shares(mix.len());
            // With fewer layers than turns, some families of the mix would be missing.
            if shares.iter().any(|share| *share <= 0.0) {
                continue;
            }
            // All turns of a family form one ply, because the order of layers has no effect in the plane.
            let mut plies: Vec<(usize, f64)> = Vec::new();
            for (&family, share) in mix.iter().zip(shares) {
                match plies.iter_mut().find(|p| p.0 == family) {
                    Some(ply) => ply.1 += share,
                    None => plies.push((family, share)),
                }
            }
            if let Some(indices) = self.indices(&plies, least * (1.0 + TIE)) {
                least = indices.iter().copied().fold(0.0, f64::max).min(least);
                found.push((mix, indices));
            }
        }
        found.retain(|(_, indices)| indices.iter().all(|index| *index <= least * (1.0 + TIE)));
        // Of equal mixes, one whose layers each serve a single case is preferred: it is easier to explain.
        let is_vague = |mix: &[usize]| mix.len() > 1 && mix.contains(&0);
        let order =
            |(mix, indices): &(Vec<usize>, Vec<f64>)| (mix.len(), self.steps_below(indices), is_vague(mix));
        Ok(found.into_iter().min_by_key(order).map_or_else(|| vec![0], |(mix, _)| mix))
    }

    /// The families that may be mixed: family 0, and those of the cases with the least reserve under family 0.
    fn picked(&self) -> Vec<usize> {
        let mut of_cases: Vec<usize> = (1..=self.weights.len()).collect();
        if of_cases.len() > MOST_CASES {
            let indices = self.indices(&[(0, 1.0)], f64::INFINITY).unwrap_or_default();
            let index = |family: usize| indices.get(family - 1).copied().unwrap_or(0.0);
            of_cases.sort_by(|a, b| index(*b).total_cmp(&index(*a)));
            of_cases.truncate(MOST_CASES);
            of_cases.sort_unstable();
        }
        std::iter::once(0).chain(of_cases).collect()
    }

    /// The weighted mean of the cases' reserves on a falling logarithmic scale, in steps of `TIE`: the smaller, the
    /// better.
    fn steps_below(&self, indices: &[f64]) -> i64 {
        let all: f64 = self.weights.iter().sum();
        let reserves = indices.iter().zip(&self.weights).filter(|(index, _)| **index > 0.0);
        let mean: f64 = reserves.map(|(index, weight)| weight / all / index).sum();
        -(grainpath_core::math::ln(mean.max(f64::MIN_POSITIVE)) / TIE).round() as i64
    }
}

/// Every list of up to `MOST_SLOTS` of these families, shorter lists first. Lists that merely repeat a shorter list are left
/// out. A family that comes several times in a list is spread over it.
fn mixes(families: &[usize]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    let mut longer: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..MOST_SLOTS {
        let with = |list: &Vec<usize>| {
            let first = list.last().copied();
            let next = families.iter().filter(move |f| first.is_none_or(|first| first <= **f));
            let list = list.clone();
            next.map(move |f| list.iter().copied().chain([*f]).collect::<Vec<_>>()).collect::<Vec<_>>()
        };
        longer = longer.iter().flat_map(with).collect();
        all.extend(longer.iter().filter(|list| !is_repeated(list)).map(|list| in_turns(list)));
    }
    all
}

/// Whether the numbers of times that the families occur in a list have a common divisor above 1.
fn is_repeated(list: &[usize]) -> bool {
    let counts = list.chunk_by(|a, b| a == b).map(<[usize]>::len);
    let divides = |by: usize| counts.clone().all(|n| n.is_multiple_of(by));
    (2..=list.len()).any(divides)
}

/// The families of a sorted list in the order of their layers: equal ones as far apart as they can be.
fn in_turns(list: &[usize]) -> Vec<usize> {
    let mut places: Vec<(f64, usize)> = Vec::new();
    for equal in list.chunk_by(|a, b| a == b) {
        let place = |k: usize| (k as f64 + 0.5) / equal.len() as f64;
        places.extend(equal.iter().enumerate().map(|(k, family)| (place(k), *family)));
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    places.into_iter().map(|p| p.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixes_are_listed_once_with_equal_families_apart() {
        let all = mixes(&[0, 1]);
        let wanted: [&[usize]; 7] =
            [&[0], &[1], &[0, 1], &[0, 1, 0], &[1, 0, 1], &[0, 0, 1, 0], &[1, 0, 1, 1]];
        assert_eq!(all.len(), wanted.len(), "{all:?}");
        for (found, wanted) in all.iter().zip(wanted) {
            let sorted = |list: &[usize]| {
                let mut list = list.to_vec();
                list.sort_unstable();
                list
            };
            assert_eq!(sorted(found), sorted(wanted), "{all:?}");
        }
        assert_eq!(in_turns(&[1, 1, 2]), [1, 2, 1]);
        assert_eq!(in_turns(&[1, 2, 3, 4]), [1, 2, 3, 4]);
        assert!(is_repeated(&[1, 1, 2, 2]) && is_repeated(&[1, 1]) && !is_repeated(&[1, 1, 2]));
    }
}
