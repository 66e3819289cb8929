//! Which load case each layer serves, where a job has several.
//!
//! Beads of one direction carry one load well. Where load cases ask for different directions the layers take turns:
//!
//! ```text
//!     layer 6   | | | | | | |     serves the pull along y
//!     layer 5   -------------     serves the pull along x
//!     layer 4   | | | | | | |
//!     layer 3   -------------
//! ```
//!
//! Each *family* of directions is a field of the section: that of all cases together, in which each counts by its stress,
//! and one for each case, in which other cases count `OTHERS` at most. A family of a case therefore still follows another
//! case where that one's stress is far greater. [`PlyMixes`] finds the families that layers take in turn so that the least
//! reserve over all cases and nodes is largest.
//!
//! In a plate one mix serves all layers, and shares are those of their heights. In a solid every `LAYERS_OF_A_MIX` layers get
//! the mix that their sections ask for. Nodes at fixtures and loads do not count.
//!
//! Limits: walls, skins of other directions and the order of layers in bending are not seen. Cost: a field for each family,
//! and the search.

use grainpath_core::DVec3;
use grainpath_fea::material::Unstable;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::ply_mix::{MixNode, PlyMixes};

use super::CaseStress;
use super::direction::{DirectionSettings, LayerField, StressedSection};

/// How much other cases count at most in the family of a case. Source: derived. Two equal cases keep directions of their own,
/// and one of less than half the stress of another is outweighed by it.
const OTHERS: f64 = 0.5;
/// The layers of a solid that get one mix. Source: derived: the smallest number that holds each length of turns, from 1 to
/// [`MOST_SLOTS`](grainpath_fea::strength::ply_mix::MOST_SLOTS), a whole number of times.
pub(super) const LAYERS_OF_A_MIX: usize = 12;

/// A family of directions: which case it serves, and how much each case counts in it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    /// The case; `None` for all of them together.
    pub(super) serves: Option<usize>,
    /// The factor on the stress of each case.
    pub(super) emphasis: Vec<f64>,
}

impl Family {
    /// All cases by their weights.
    pub(super) fn by_weight(cases: &[CaseStress]) -> Self {
        Self { serves: None, emphasis: cases.iter().map(|c| c.weight).collect() }
    }

    /// The families of several cases: that of all, then those of each. `card` is that of the beads.
    pub(super) fn of_cases(n_cases: usize, card: &StrengthCard) -> Vec<Self> {
        let [along, across, _] = card.elastic.e_mpa;
        // Plies across the load take 2 E2 / (E1 + E2) of the mean stress in a mix of two equal parts. Where another case's stress is
        // so much greater, plies across it would fail before those of the smaller one gain by their direction.
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
    /// The fields of all families in a section. `free` is that of [`StressedSection::new`].
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

/// The mixes of the families of some sections, at the nodes that `counts` lets through; at all with stress, where it lets none
/// through.
pub(super) fn mixes_of<'a>(
    card: &StrengthCard,
    cases: &[CaseStress],
    sections: &'a [Fields<'_>],
    counts: &dyn Fn(DVec3) -> bool,
) -> Result<PlyMixes<'a>, Unstable> {
    // Nodes keep their places until those at fixtures and loads are sorted out: stress is singular there, and would
    // decide alone.
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
