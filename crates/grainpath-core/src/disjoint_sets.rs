//! Disjoint sets: tell which of `n` items are connected while connections are added one by one.
//!
//! Union by lowest member with path halving (Tarjan and van Leeuwen 1984, `tarjan1984` in
//! docs/references.bib). A set is named by its lowest member, so names depend neither on the order
//! of the unions nor on the number of threads. In exchange, the inverse-Ackermann bound of union by
//! rank does not hold: with path halving alone, a call costs O(log n) amortised.
//! Memory: 4 bytes per item.

/// A partition of the numbers below `n` into sets.
///
/// ```
/// use grainpath_core::DisjointSets;
///
/// let mut sets = DisjointSets::new(5);
/// assert!(sets.union(4, 2));
/// assert!(sets.union(2, 3));
/// assert!(!sets.union(3, 4), "already in one set");
/// assert_eq!(sets.lowest(4), 2);
/// assert_eq!(sets.names(), [0, 1, 2, 2, 2]);
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DisjointSets {
    /// For each member, a member of the same set with a lower number; for the lowest member, itself.
    parent: Vec<u32>,
}

impl DisjointSets {
    /// `n` sets of one member each; `n` is below 2³².
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// Number of items in all sets.
    pub fn len(&self) -> usize {
        self.parent.len()
    }

    /// Whether there are no items at all.
    pub fn is_empty(&self) -> bool {
        self.parent.is_empty()
    }

    /// The lowest member of the set that holds `member`.
    pub fn lowest(&mut self, member: usize) -> usize {
        let mut member = member as u32;
        while self.parent[member as usize] != member {
            // Path halving: every visited member is linked to its grandparent, so paths get shorter
            // with each query.
            let above = self.parent[self.parent[member as usize] as usize];
            self.parent[member as usize] = above;
            member = above;
        }
        member as usize
    }

    /// Unites the sets of `a` and `b`. Returns true if they were different sets before.
    pub fn union(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.lowest(a), self.lowest(b));
        // Linking to the lower root keeps the lowest member as the name of the set.
        self.parent[a.max(b)] = a.min(b) as u32;
        a != b
    }

    /// Whether `a` and `b` are in one set.
    pub fn together(&mut self, a: usize, b: usize) -> bool {
        self.lowest(a) == self.lowest(b)
    }

    /// For each item, the lowest member of its set.
    pub fn names(mut self) -> Vec<u32> {
        (0..self.len()).for_each(|i| self.parent[i] = self.lowest(i) as u32);
        self.parent
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The sets are those of a flood over the same connections, whatever their order.
        #[test]
        fn sets_are_the_connected_components(links in prop::collection::vec((0usize..40, 0usize..40), 0..60)) {
            let mut sets = DisjointSets::new(40);
            links.iter().for_each(|&(a, b)| {
                sets.union(a, b);
            });
            let mut lowest: Vec<u32> = (0..40).collect();
            for _ in 0..40 {
                for &(a, b) in &links {
                    let low = lowest[a].min(lowest[b]);
                    (lowest[a], lowest[b]) = (low, low);
                }
            }
            prop_assert_eq!(sets.names(), lowest);
        }
    }
}
