//! Chooses the load case that each layer serves, for jobs with several load cases.
//!
//! Beads of one direction carry one load well. Where load cases ask for different directions, the layers alternate:
//!
//! ```text
//!     layer 6   | | | | | | |     serves the pull along y
//!     layer 5   -------------     serves the pull along x
//!     layer 4   | | | | | | |
//!     layer 3   -------------
//! ```
//!
//! Each *family* of directions is a direction field over the section. One family serves all cases together, each weighted
//! by its stress. Each case also has a family of its own, in which the other cases have a factor of `OTHERS` at most.
//! Such a family still follows another case where the stress of that case is far greater. [`PlyMixes`] finds the
//! repeating sequence of families (the mix) whose least reserve over all cases and nodes is largest.
//!
//! A plate has one mix for all layers, and each family's share is its part of the total height. In a solid each group of
//! `LAYERS_OF_A_MIX` layers gets the best mix for its sections. Nodes at fixtures and loads do not count.
//!
//! Limits: walls, skins of other directions and the effect of layer order in bending are ignored. Cost: a field for each
//! family, and the search.

use grainpath_core::DVec3;
use grainpath_fea::material::Unstable;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::ply_mix::{MixNode, PlyMixes};

use super::CaseStress;
use super::direction::{DirectionSettings, LayerField, StressedSection};

/// Largest factor on the other cases in the family of a case. Source: derived. Two equal cases keep directions of their
/// own, but a case with less than half the stress of another is outweighed by that other case.
const OTHERS: f64 = 0.5;
/// Number of consecutive layers of a solid that share one mix. Source: derived: the smallest common multiple of all
/// lengths of a mix, 1 to [`MOST_SLOTS`](grainpath_fea::strength::ply_mix::MOST_SLOTS).
pub(super) const LAYERS_OF_A_MIX: usize = 12;

/// A family of directions: which case it serves, and how much each case counts in it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    /// Index of the load case that the family serves; `None` for all cases together.
    pub(super) serves: Option<usize>,
    /// The factor on the stress of each case.
    pub(super) emphasis: Vec<f64>,
}

impl Family {
    /// The family of all cases, each with its weight from the job.
    pub(super) fn by_weight(cases: &[CaseStress]) -> Self {
        Self { serves: None, emphasis: cases.iter().map(|c| c.weight).collect() }
    }

    /// The families for several cases: first the one of all cases, then one for each case. `card` is the strength card of
    /// the beads.
    pub(super) fn of_cases(n_cases: usize, card: &StrengthCard) -> Vec<Self> {
        let [along, across, _] = card.elastic.e_mpa;
        // In a mix of two equal shares, plies across the load carry 2 E2 / (E1 + E2) of the mean stress. Where the stress
        // of another case is greater by the inverse of this ratio, plies across that stress would fail first, so the
        // family follows that case there.
        let others = (2.0 * across / (along + across)).min(OTHERS);
        let all = Self { serves: None, emphasis: vec![1.0; n_cases] };
        let of_case = |k: usize| {
            let emphasis = (0..n_cases).map(|c| if c == k { 1.0 } else { others }).collect();
            Self { serves: Some(k), emphasis }
        };
        std::iter::once(all).chain((0..n_cases).map(of_case)).collect()
    }
}

/// A section and the field of each family in it.
pub(super) struct Fields<'a> {
    section: StressedSection<'a>,
    of_families: Vec<LayerField>,
}

impl<'a> Fields<'a> {
    /// The fields of all families in a section. `free` has the meaning of the parameter of [`StressedSection::new`].
    pub(super) fn new(
        section: StressedSection<'a>,
        families: &[Family],
        free: &dyn Fn(DVec3) -> bool,
        settings: &DirectionSettings,
    ) -> Self {
        let of_families = families.iter().map(|f| section.field(&f.emphasis, free, settings)).collect();
        Self { section, of_families }
    }

    /// The field of one family.
    pub(super) fn take(mut self, family: usize) -> LayerField {
        self.of_families.swap_remove(family)
    }
}

/// The possible mixes of families for some sections, judged at the nodes for which `counts` is true. If it is true
/// nowhere, all nodes with stress are used.
pub(super) fn mixes_of<'a>(
    card: &StrengthCard,
    cases: &[CaseStress],
    sections: &'a [Fields<'_>],
    counts: &dyn Fn(DVec3) -> bool,
) -> Result<PlyMixes<'a>, Unstable> {
    // Nodes are kept with their positions until those at fixtures and loads are removed: stress is singular there, and
    // these nodes alone would decide the result.
    let mut all: Vec<(DVec3, MixNode<'a>)> = Vec::new();
    for (section, fields) in sections.iter().enumerate() {
        let node = |(node, (p, stresses))| (p, MixNode { section, node, stresses });
        all.extend(fields.section.nodes().enumerate().map(node));
    }
    if all.iter().any(|(p, _)| counts(*p)) {
        all.retain(|(p, _)| counts(*p));
    }
    let axes = |fields: &Fields<'_>| fields.of_families.iter().map(|f| f.axes_rad().collect()).collect();
    let weights = cases.iter().map(|c| c.weight).collect();
    let nodes = all.into_iter().map(|n| n.1).collect();
    PlyMixes::new(card, weights, sections.iter().map(axes).collect(), nodes)
}
