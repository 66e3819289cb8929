//! A multifrontal factorization of a plate's stiffness that is repeated only where elements changed.
//!
//! Method: the nodes are ordered by nested dissection (`george1973` in docs/references.bib) and eliminated in fronts
//! (`duff1983`). A line of nodes divides the grid into two halves, further lines divide the halves, and so on. Both halves
//! are eliminated before the line between them. A *front* is the dense matrix in which the nodes of one line are
//! eliminated. The rest, a Schur complement on the surrounding nodes, is added to its parent, the front of the next longer
//! line. The fronts form a binary tree whose root is the first line.
//!
//! When elements lose stiffness, only the fronts that contain them and all fronts between these and the root are
//! factored again.
//!
//! Stiffnesses are in N/mm, displacements in mm. Cost for n nodes: n^1.5 operations and n log n numbers for a whole
//! factorization. Where the memory limit does not allow keeping the Schur complements, every factorization is a whole
//! one. A plate that can move freely is an error.

use std::sync::{Mutex, PoisonError};

use grainpath_core::diagnostics::CancelFlag;

use super::squares::PlateElements;
use crate::dense_elimination::eliminate;
use crate::sparse::{BYTES_PER_MIB, SparseError};

/// The lower half of an element's stiffness by columns, `(8, 8)`.
pub(super) type Lower = [f64; 36];

/// A factor in fronts; each comes after both of its children.
pub(super) struct Fronts {
    fronts: Vec<Front>,
    /// The front to which each element is added.
    of_element: Vec<u32>,
    /// Stops a factorization when it is set.
    pub cancel: CancelFlag,
    /// Whether Schur complements are kept, so that a factorization can be limited to what changed.
    keeps: bool,
    /// Memory of whole fronts, one for each thread that works on them. Asking the system for it anew each time took a twentieth
    /// of a test (profile of the plate of `cargo xtask bench strength time`).
    spare: Mutex<Vec<Vec<f64>>>,
}

/// What a factorization reads and works in.
struct Factorization<'a> {
    stiffness: &'a [Lower],
    keeps: bool,
    cancel: &'a CancelFlag,
    spare: &'a Mutex<Vec<Vec<f64>>>,
}

#[derive(Default)]
struct Front {
    /// Its nodes in the order of elimination. The first `own` are eliminated here, the others further up.
    nodes: Vec<u32>,
    own: usize,
    /// Number of fronts in the first and in the second half; both halves stand directly before this front in the list.
    halves: [usize; 2],
    /// Places of its other nodes among the nodes of its parent.
    up: Vec<u32>,
    /// Elements added here, and the places of their corners among its nodes.
    elements: Vec<(u32, [u32; 4])>,
    /// Stiffness of fixtures and of the weak springs at every node: row and column among its unknowns, and value.
    added: Vec<(u32, u32, f64)>,
    /// The `2 own` columns of the factor, from the last to the first, each from the diagonal down to the last of `2 nodes`
    /// rows: the order in which back substitution reads them. Reading is what it spends its time on.
    factor: Vec<f64>,
    /// The Schur complement for the parent: the lower half of a square of `2 (nodes - own)`, by columns, each from the
    /// diagonal.
    rest: Vec<f64>,
    /// Forces on the nodes that are eliminated here, N.
    forces: Vec<f64>,
    /// The forces after forward substitution: first on its own nodes, then those that it adds to the nodes of its
    /// parent.
    eased: Vec<f64>,
    /// Displacements of its nodes, mm.
    found: Vec<f64>,
    stale: bool,
}

/// Halving ends at this number of nodes, which are eliminated in one front: the bookkeeping of smaller fronts costs more
/// than they save. Source: chosen; it changes speed and the order of additions alone.
const LEAF: usize = 24;
/// Two halves with at most this number of fronts together are done by one thread, since a second one would cost more than
/// it saves. Source: chosen; it changes speed alone.
const MANY: usize = 64;

impl Fronts {
    /// Orders the nodes and allocates the fronts; nothing is factored yet. `added` are stiffnesses between the unknowns
    /// of one node: row, column, value. `forces` act on the unknowns, N.
    ///
    /// # Errors
    /// [`SparseError::Memory`] when the factor would take more than `max_mib` MiB.
    pub(super) fn new(
        elements: &PlateElements,
        added: &[(usize, usize, f64)],
        forces: &[f64],
        max_mib: f64,
    ) -> Result<Self, SparseError> {
        let mut fronts = Vec::new();
        let mut all: Vec<u32> = (0..elements.places.len() as u32).collect();
        cut(elements, &mut all, &mut fronts);
        // `rank` is the place of a node in the order of elimination, `home` the front that eliminates it.
        let (mut rank, mut home) = (vec![0u32; all.len()], vec![0u32; all.len()]);
        let mut next = 0;
        for (f, front) in fronts.iter().enumerate() {
            for &node in &front.nodes {
                (rank[node as usize], home[node as usize]) = (next, f as u32);
                next += 1;
            }
        }
        let mut of_element = Vec::with_capacity(elements.corners.len());
        for (e, corners) in elements.corners.iter().enumerate() {
            // An element is assembled where the first of its nodes is eliminated.
            let first = corners.iter().min_by_key(|c| rank[**c as usize]).copied().unwrap_or(0);
            of_element.push(home[first as usize]);
            fronts[home[first as usize] as usize].elements.push((e as u32, *corners));
        }
        for f in 0..fronts.len() {
            // The nodes of a front: its own, those of its elements, and those that its children pass on.
            let own = fronts[f].nodes.len();
            let mut nodes = fronts[f].nodes.clone();
            nodes.extend(fronts[f].elements.iter().flat_map(|e| e.1));
            for child in fronts[f].children(f).into_iter().flatten() {
                nodes.extend_from_slice(&fronts[child].nodes[fronts[child].own..]);
            }
            nodes.sort_unstable_by_key(|n| rank[*n as usize]);
            nodes.dedup();
            let at = |node: u32| {
                nodes.binary_search_by_key(&rank[node as usize], |n| rank[*n as usize]).unwrap_or(0) as u32
            };
            for child in fronts[f].children(f).into_iter().flatten() {
                let up = fronts[child].nodes[fronts[child].own..].iter().map(|n| at(*n)).collect();
                fronts[child].up = up;
            }
            // From here on elements name the places of their nodes in the front.
            fronts[f].elements.iter_mut().for_each(|(_, corners)| *corners = corners.map(at));
            let force = |n: &u32| [forces[2 * *n as usize], forces[2 * *n as usize + 1]];
            fronts[f].forces = nodes[..own].iter().flat_map(force).collect();
            (fronts[f].own, fronts[f].nodes, fronts[f].stale) = (own, nodes, true);
        }
        for &(row, column, value) in added {
            let node = row as u32 / 2;
            let front = &mut fronts[home[node as usize] as usize];
            let at =
                front.nodes[..front.own].binary_search_by_key(&rank[node as usize], |n| rank[*n as usize]);
            let at = 2 * at.unwrap_or(0) as u32;
            front.added.push((at + row as u32 % 2, at + column as u32 % 2, value));
        }
        let mib = |sum: &dyn Fn(&Front) -> usize| {
            (8 * fronts.iter().map(sum).sum::<usize>()) as f64 / BYTES_PER_MIB
        };
        // Besides the factor, the matrices that fronts pass on are kept where memory allows, so that a change of a few
        // elements repeats the fronts above them alone.
        let needed_mib = mib(&Front::factor_len);
        let kept_mib = mib(&|f| {
            let n = 2 * (f.nodes.len() - f.own);
            n * (n + 1) / 2
        });
        if needed_mib > max_mib {
            return Err(SparseError::Memory { needed_mib, limit_mib: max_mib });
        }
        Ok(Self {
            fronts,
            of_element,
            cancel: CancelFlag::default(),
            keeps: needed_mib + kept_mib <= max_mib,
            spare: Mutex::default(),
        })
    }

    /// Notes that the stiffness of an element changed.
    pub(super) fn change(&mut self, element: usize) {
        self.fronts[self.of_element[element] as usize].stale = true;
    }

    /// Factors the fronts that are affected by changed elements.
    ///
    /// # Errors
    /// [`SparseError::Singular`] when a part of the plate can move freely.
    pub(super) fn refactor(&mut self, stiffness: &[Lower]) -> Result<(), SparseError> {
        let stale = !self.keeps && self.fronts.iter().any(|f| f.stale);
        for f in 0..self.fronts.len() {
            let below = self.fronts[f].children(f).into_iter().flatten().any(|c| self.fronts[c].stale);
            self.fronts[f].stale |= below || stale;
        }
        let (cancel, spare) = (&self.cancel, &self.spare);
        make(&mut self.fronts, &Factorization { stiffness, keeps: self.keeps, cancel, spare })
    }

    /// Displacements, mm, of all unknowns; the factor must be up to date.
    pub(super) fn solve(&mut self) -> Vec<f64> {
        back(&mut self.fronts, &[]);
        let mut x = vec![0.0; self.fronts.iter().map(|f| 2 * f.own).sum()];
        for front in &self.fronts {
            for (node, found) in front.nodes[..front.own].iter().zip(front.found.chunks_exact(2)) {
                x[2 * *node as usize..][..2].copy_from_slice(found);
            }
        }
        x
    }
}

impl Front {
    /// The indices of its two children, if the index of this front is `own`.
    fn children(&self, own: usize) -> [Option<usize>; 2] {
        let [first, second] = self.halves;
        [(first > 0).then(|| own - 1 - second), (second > 0).then(|| own - 1)].map(|c| c.filter(|c| *c < own))
    }

    /// Number of entries of its factor.
    fn factor_len(&self) -> usize {
        let (size, k) = (2 * self.nodes.len(), 2 * self.own);
        k * size - k * k.saturating_sub(1) / 2
    }

    /// Assembles its elements and the Schur complements of its children, and eliminates its nodes.
    fn make(&mut self, halves: [Option<&Self>; 2], work: &Factorization<'_>) -> Result<(), SparseError> {
        let (size, k) = (2 * self.nodes.len(), 2 * self.own);
        let spare = || work.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let mut whole = spare().pop().unwrap_or_default();
        whole.clear();
        whole.resize(size * size, 0.0);
        let mut add = |row: usize, column: usize, value: f64| {
            whole[row.min(column) * size + row.max(column)] += value;
        };
        for (element, corners) in &self.elements {
            let at = |i: usize| 2 * corners[i / 2] as usize + i % 2;
            let mut values = work.stiffness[*element as usize].iter();
            for j in 0..8 {
                (j..8).zip(&mut values).for_each(|(i, value)| add(at(i), at(j), *value));
            }
        }
        for &(row, column, value) in &self.added {
            add(row as usize, column as usize, value);
        }
        self.eased.clone_from(&self.forces);
        self.eased.resize(size, 0.0);
        for half in halves.into_iter().flatten() {
            let n = 2 * half.up.len();
            let at = |i: usize| 2 * half.up[i / 2] as usize + i % 2;
            let mut rest = half.rest.iter();
            for j in 0..n {
                let to = at(j);
                for (i, value) in (j..n).zip(&mut rest) {
                    add(at(i), to, *value);
                }
                self.eased[to] += half.eased[2 * half.own + j];
            }
        }
        eliminate(&mut whole, size, k)?;
        for (j, column) in whole[..k * size].chunks_exact(size.max(1)).enumerate() {
            let value = self.eased[j] / column[j];
            self.eased[j] = value;
            self.eased[j + 1..].iter_mut().zip(&column[j + 1..]).for_each(|(e, l)| *e -= l * value);
        }
        self.factor.clear();
        self.factor.reserve_exact(self.factor_len());
        for (j, column) in whole[..k * size].chunks_exact(size.max(1)).enumerate().rev() {
            self.factor.extend_from_slice(&column[j..]);
        }
        self.rest.clear();
        // The exact size is reserved, because growth could take twice the memory and this is most of what a test holds.
        self.rest.reserve_exact((size - k) * (size - k + 1) / 2);
        for (j, column) in whole[k * size..].chunks_exact(size.max(1)).enumerate() {
            self.rest.extend_from_slice(&column[k + j..]);
        }
        spare().push(whole);
        self.stale = false;
        Ok(())
    }
}

/// Sum of products, in four independent sums that the processor can compute at the same time.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, others) = (a.chunks_exact(4), a.len() / 4 * 4);
    for (x, y) in fours.zip(b.chunks_exact(4)) {
        (0..4).for_each(|i| sums[i] += x[i] * y[i]);
    }
    let rest: f64 = a[others..].iter().zip(&b[others..]).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Factors the outdated fronts of a subtree; its root comes last.
fn make(fronts: &mut [Front], work: &Factorization<'_>) -> Result<(), SparseError> {
    let Some((last, before)) = fronts.split_last_mut() else { return Ok(()) };
    if !last.stale {
        return Ok(());
    }
    let (first, second) = before.split_at_mut(last.halves[0]);
    let (a, b) = rayon::join(|| make(first, work), || make(second, work));
    a.and(b)?;
    work.cancel.check()?;
    last.make([first.last(), second.last()], work)?;
    if !work.keeps {
        [first.last_mut(), second.last_mut()].into_iter().flatten().for_each(|f| f.rest = Vec::new());
    }
    Ok(())
}

/// Back substitution in a subtree; its root comes last. `above` are the displacements of the nodes of the root's parent.
fn back(fronts: &mut [Front], above: &[f64]) {
    let Some((last, before)) = fronts.split_last_mut() else { return };
    let size = 2 * last.nodes.len();
    let part = &mut last.found;
    part.clear();
    part.extend_from_slice(&last.eased[..2 * last.own]);
    part.extend(last.up.iter().flat_map(|at| [above[2 * *at as usize], above[2 * *at as usize + 1]]));
    let mut columns = &last.factor[..];
    for j in (0..2 * last.own).rev() {
        let (column, others) = columns.split_at(size - j);
        part[j] = (part[j] - dot(&part[j + 1..], &column[1..])) / column[0];
        columns = others;
    }
    let many = before.len() > MANY;
    let (first, second) = before.split_at_mut(last.halves[0]);
    if many {
        rayon::join(|| back(first, part), || back(second, part));
    } else {
        back(first, part);
        back(second, part);
    }
}

/// Orders nodes by nested dissection: adds the fronts of both halves, then that of the line between them.
fn cut(elements: &PlateElements, nodes: &mut [u32], fronts: &mut Vec<Front>) {
    if nodes.is_empty() {
        return;
    }
    let place = |i: u32, k: usize| elements.places[i as usize][k];
    let span = |k: usize| {
        let values = nodes.iter().map(|&i| place(i, k));
        values.fold((u32::MAX, 0), |(a, b), v| (a.min(v), b.max(v)))
    };
    let spans = [span(0), span(1)];
    let axis = usize::from(spans[1].1 - spans[1].0 > spans[0].1 - spans[0].0);
    if nodes.len() <= LEAF || spans[axis].0 == spans[axis].1 {
        fronts.push(Front { nodes: nodes.to_vec(), ..Front::default() });
        return;
    }
    // The line through the median node divides the nodes into two halves of about equal number.
    let mut values: Vec<u32> = nodes.iter().map(|&i| place(i, axis)).collect();
    let half = values.len() / 2;
    let at = *values.select_nth_unstable(half).1;
    let at = at.clamp(spans[axis].0 + 1, spans[axis].1.max(spans[axis].0 + 1));
    nodes.sort_by_key(|&i| (place(i, axis) == at, place(i, axis), i));
    let first = nodes.partition_point(|&i| place(i, axis) < at);
    let line = nodes.partition_point(|&i| place(i, axis) != at);
    let before = fronts.len();
    cut(elements, &mut nodes[..first], fronts);
    let between = fronts.len();
    cut(elements, &mut nodes[first..line], fronts);
    let halves = [between - before, fronts.len() - between];
    fronts.push(Front { nodes: nodes[line..].to_vec(), halves, ..Front::default() });
}
