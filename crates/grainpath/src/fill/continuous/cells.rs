//! Cuts strips across into cells of about equal length, and finds which cells share an edge.
//!
//! A strip is a closed outline with one bead on each of its long sides. Cuts across the strip divide it
//! into cells, whose length is about [`Continuous::aspect`](super::Continuous) times the strip's width. Two
//! cells of one strip share an edge at the cut between them. Cells of two strips share an edge where the strips
//! face each other a bead apart.
//!
//! ```text
//!    ====+========+======   strip A     + cut across: edge between two cells of A
//!    ====+========+======
//!       o        o              o places beside strips: edges between cells of A and of B
//!    ======+=======+=====   strip B
//!    ======+=======+=====
//! ```
//!
//! The tree decides which cuts are made: at a cut that the tree does not pass, the strip ends in two
//! caps. [`Taken`] records which stretches of the outlines are in use, because two joints must not
//! share a stretch. Constants are in bead spacings, the code in mm. Cost: linear in the length of all
//! strips.

use grainpath_core::DVec2;
use grainpath_core::tuned::Tuned;

use crate::fill::Shift;

use super::rings::{Facing, Rings, Side, Walk, bracket};

/// Two beads that face each other at this distance or more may be joined by a cut across a strip, in beads.
/// Measured: row `fill.continuous.cells.ACROSS_MIN` of `cargo xtask bench constants`.
static ACROSS_MIN: Tuned<f64> = Tuned::new("fill.continuous.cells.ACROSS_MIN", 0.55);
/// Two beads that face each other at this distance or less may be joined by a cut across a strip, in beads.
/// Measured: row `fill.continuous.cells.ACROSS_MAX` of `cargo xtask bench constants`.
static ACROSS_MAX: Tuned<f64> = Tuned::new("fill.continuous.cells.ACROSS_MAX", 1.5);
/// Cells of two strips that face each other at this distance or more share an edge, in beads.
/// Measured: row `fill.continuous.cells.BESIDE_MIN` of `cargo xtask bench constants`.
static BESIDE_MIN: Tuned<f64> = Tuned::new("fill.continuous.cells.BESIDE_MIN", 0.5);
/// Cells of two strips that face each other at this distance or less share an edge, in beads.
/// Measured: row `fill.continuous.cells.BESIDE_MAX` of `cargo xtask bench constants`.
static BESIDE_MAX: Tuned<f64> = Tuned::new("fill.continuous.cells.BESIDE_MAX", 1.7);

/// Least distance between the places that are tried beside strips, in beads. It holds in small regions.
/// Measured: row `fill.continuous.cells.PLACE_MIN` of `cargo xtask bench constants`.
static PLACE_MIN: Tuned<f64> = Tuned::new("fill.continuous.cells.PLACE_MIN", 1.0);
/// Greatest distance between the places that are tried beside strips, in beads, however large the region.
/// Measured: row `fill.continuous.cells.PLACE_MAX` of `cargo xtask bench constants`.
static PLACE_MAX: Tuned<f64> = Tuned::new("fill.continuous.cells.PLACE_MAX", 4.0);
/// About this number of places is tried in a region; in a large region they lie farther apart.
/// Measured: row `fill.continuous.cells.MANY_PLACES` of `cargo xtask bench constants`.
static MANY_PLACES: Tuned<f64> = Tuned::new("fill.continuous.cells.MANY_PLACES", 20_000.0);
/// Stretches in use are marked in steps of this length, in beads. Measured: row `fill.continuous.cells.MARK` of `cargo
/// xtask bench constants`.
pub(super) static MARK: Tuned<f64> = Tuned::new("fill.continuous.cells.MARK", 0.25);
/// A joint keeps this length to both sides of its middle for itself, in beads. Its stretch takes half a bead of that.
/// Measured: row `fill.continuous.cells.TAKEN_HALF` of `cargo xtask bench constants`.
pub(super) static TAKEN_HALF: Tuned<f64> = Tuned::new("fill.continuous.cells.TAKEN_HALF", 0.6);
/// Cuts across a strip lie at least this far apart, in lengths of a cell. Measured: row
/// `fill.continuous.cells.CUT_APART` of `cargo xtask bench constants`.
static CUT_APART: Tuned<f64> = Tuned::new("fill.continuous.cells.CUT_APART", 0.8);
/// Where a strip cannot be cut, the next place is this far onwards, in beads. Measured: row
/// `fill.continuous.cells.CUT_STEP` of `cargo xtask bench constants`.
static CUT_STEP: Tuned<f64> = Tuned::new("fill.continuous.cells.CUT_STEP", 0.5);

/// Two cells and the edge between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub cells: [u32; 2],
    /// Index of the cut, for an edge across a strip; `None` for an edge beside a strip.
    pub cut: Option<u32>,
    /// For an edge beside a strip: the ring, and the position along it, mm.
    pub ring: u32,
    pub at_mm: f64,
    /// The ring and the segment on the other side of the edge.
    pub facing: [u32; 2],
    /// Middles of the two beads that face each other here.
    pub ends: [DVec2; 2],
}

/// The cells of an infill region.
pub(super) struct Cells {
    pub n: usize,
    /// Places where strips can be cut across. If the two stretches there are not exchanged, the strip stays
    /// whole; if they are, it ends in two caps.
    pub cuts: Vec<Facing>,
    pub edges: Vec<Edge>,
    /// Distance between neighbouring places that are tried beside strips, mm.
    pub place_mm: f64,
}

/// Records which stretches of the rings are in use.
pub(super) struct Taken {
    step_mm: f64,
    starts: Vec<usize>,
    marks: Vec<bool>,
}

impl Taken {
    pub(super) fn new(rings: &Rings, step_mm: f64) -> Self {
        let mut starts = vec![0];
        for r in 0..rings.lines.len() {
            starts.push(starts[r] + (rings.length_mm(r) / step_mm) as usize + 1);
        }
        let marks = vec![false; starts[starts.len() - 1]];
        Self { step_mm, starts, marks }
    }

    /// Indices of the marks that belong to a stretch.
    fn range(&self, ring: usize, from_mm: f64, to_mm: f64) -> impl Iterator<Item = usize> + use<> {
        let (start, n) = (self.starts[ring], (self.starts[ring + 1] - self.starts[ring]) as i64);
        let index = |mm: f64| (mm / self.step_mm).floor() as i64;
        let (i, j) = (index(from_mm), index(to_mm));
        // An index within the ring needs no modulo, which is costly; only a stretch that passes the ring's
        // first point needs it.
        let at = move |k: i64| if (0..n).contains(&k) { k } else { k.rem_euclid(n) };
        (i..=j.min(i + n - 1)).map(move |k| start + at(k) as usize)
    }

    /// The first free place of a ring at or after `at_mm`; the ring's length where there is none.
    fn next_free(&self, ring: usize, at_mm: f64) -> f64 {
        let first = (at_mm / self.step_mm) as usize;
        let marks = &self.marks[self.starts[ring]..self.starts[ring + 1]];
        let taken = marks.iter().skip(first).take_while(|m| **m).count();
        if taken == 0 { at_mm } else { (first + taken) as f64 * self.step_mm }
    }

    pub(super) fn is_free(&self, ring: usize, from_mm: f64, to_mm: f64) -> bool {
        self.range(ring, from_mm, to_mm).all(|k| !self.marks[k])
    }

    /// Both stretches of an exchange, each from `half_mm` before its middle to `half_mm` after it.
    fn stretches(f: &Facing, half_mm: f64) -> [(usize, f64, f64); 2] {
        [
            (f.one_ring, f.one[1] - half_mm, f.one[1] + half_mm),
            (f.other_ring, f.other[1] - half_mm, f.other[1] + half_mm),
        ]
    }

    pub(super) fn fits(&self, f: &Facing, half_mm: f64) -> bool {
        Self::stretches(f, half_mm).iter().all(|&(r, a, b)| self.is_free(r, a, b))
    }

    pub(super) fn take_both(&mut self, f: &Facing, half_mm: f64) {
        for (ring, from_mm, to_mm) in Self::stretches(f, half_mm) {
            for k in self.range(ring, from_mm, to_mm) {
                self.marks[k] = true;
            }
        }
    }
}

/// Cuts strips into cells of about `length_mm`, and marks the stretches at the cuts in `taken`.
pub(super) fn cut(rings: &Rings, length_mm: f64, spacing_mm: f64, shift: Shift, taken: &mut Taken) -> Cells {
    let step = MARK.value() * spacing_mm;
    // Two sets of marks: `near` spaces the cuts a cell's length apart on both sides of the strip,
    // `taken` keeps only the stretches themselves, which later joints have to avoid.
    let mut near = Taken::new(rings, step);
    let mut cuts: Vec<Facing> = Vec::new();
    for ring in 0..rings.lines.len() {
        let length = rings.length_mm(ring);
        let first_mm = 0.5 * length_mm + shift.onward_mm();
        let mut at = near.next_free(ring, if first_mm < length { first_mm } else { 0.5 * length_mm });
        while at < length - 0.5 * spacing_mm {
            let found = rings.stretches(ring, at, Side::Left, [ACROSS_MIN.value(), ACROSS_MAX.value()], None);
            if let Some(f) =
                found.filter(|f| near.fits(f, 0.0) && taken.fits(f, TAKEN_HALF.value() * spacing_mm))
            {
                near.take_both(&f, CUT_APART.value() * length_mm);
                taken.take_both(&f, TAKEN_HALF.value() * spacing_mm);
                cuts.push(f);
                at += CUT_APART.value() * length_mm;
            }
            at = near.next_free(ring, at + CUT_STEP.value() * spacing_mm);
        }
    }
    let ends = Ends::new(rings, &cuts);
    let (cell_of, n) = ends.cells();
    let mut edges = Vec::new();
    for (k, f) in cuts.iter().enumerate() {
        let [a, b] = [2 * k, 2 * k + 1].map(|c| cell_of[c]);
        // A cut separates the stretch of ring before it from the stretch after it. Both may still belong to
        // one cell, if they are connected another way around.
        if a != b {
            let (p, q) = (rings.point(f.one_ring, f.one[0]).0, rings.point(f.one_ring, f.one[2]).0);
            edges.push(Edge {
                cells: [a, b],
                cut: Some(k as u32),
                ring: f.one_ring as u32,
                at_mm: f.one[1],
                facing: [f.other_ring as u32, 0],
                ends: [p, q],
            });
        }
    }
    let all_mm: f64 = (0..rings.lines.len()).map(|r| rings.length_mm(r)).sum();
    let [least, most] = [PLACE_MIN.value(), PLACE_MAX.value()].map(|beads| beads * spacing_mm);
    let place_mm = (all_mm / MANY_PLACES.value()).clamp(least, most);
    for ring in 0..rings.lines.len() {
        let length = rings.length_mm(ring);
        let n = (length / place_mm).floor().max(1.0);
        let (mut walk, mut own, mut others) = (Walk::default(), 0, (usize::MAX, 0));
        for k in 0..n as usize {
            let at_mm = length * (k as f64 + 0.5) / n;
            let Some((other, points)) =
                rings.facing(ring, at_mm, Side::Right, [BESIDE_MIN.value(), BESIDE_MAX.value()], &mut walk)
            else {
                continue;
            };
            let a = cell_of[ends.after(ring, at_mm, &mut own)];
            // The number of cut ends before the facing place changes slowly along a ring, so the search
            // starts from the previous number.
            if others.0 != other.ring {
                others = (other.ring, ends.likely(other.ring, other.at_mm));
            }
            let b = cell_of[ends.after(other.ring, other.at_mm, &mut others.1)];
            if a != b {
                let facing = [other.ring, other.segment].map(|v| v as u32);
                edges.push(Edge { cells: [a, b], cut: None, ring: ring as u32, at_mm, facing, ends: points });
            }
        }
    }
    Cells { n, cuts, edges, place_mm }
}

/// The exchange of stretches at an edge between two strips; `None` if the stretches are not straight
/// enough.
pub(super) fn beside(rings: &Rings, edge: &Edge) -> Option<Facing> {
    let facing = edge.facing.map(|v| v as usize);
    rings.stretches(
        edge.ring as usize,
        edge.at_mm,
        Side::Right,
        [BESIDE_MIN.value(), BESIDE_MAX.value()],
        Some(facing.into()),
    )
}

/// The ends of cuts on each ring, in order.
struct Ends<'a> {
    rings: &'a Rings,
    /// `(position in mm, 2 * cut + side)` for each cut end, ring by ring.
    all: Vec<Vec<(f64, u32)>>,
    n_cuts: usize,
}

impl<'a> Ends<'a> {
    fn new(rings: &'a Rings, cuts: &[Facing]) -> Self {
        let mut all = vec![Vec::new(); rings.lines.len()];
        for (k, f) in cuts.iter().enumerate() {
            all[f.one_ring].push((f.one[1], 2 * k as u32));
            all[f.other_ring].push((f.other[1], 2 * k as u32 + 1));
        }
        all.iter_mut().for_each(|a| a.sort_by(|a, b| a.0.total_cmp(&b.0)));
        Self { rings, all, n_cuts: cuts.len() }
    }

    /// Estimates the number of cut ends before a place: cells are about equally long.
    fn likely(&self, ring: usize, at_mm: f64) -> usize {
        (at_mm / self.rings.length_mm(ring).max(1e-12) * self.all[ring].len() as f64) as usize
    }

    /// The number of the stretch of ring on which a place lies: that of the cut end before it, or a number
    /// of its own if the ring has no cuts. On entry `before` is an estimate of the number of ends before
    /// the place, on return the true number.
    fn after(&self, ring: usize, at_mm: f64, before: &mut usize) -> usize {
        let ends = &self.all[ring];
        *before = bracket(ends.len(), *before, |k| ends[k].0 <= at_mm);
        match ends.get(before.wrapping_sub(1)).or(ends.last()) {
            Some(e) => e.1 as usize,
            None => 2 * self.n_cuts + ring,
        }
    }

    /// The cell of each stretch of ring, and the number of cells. If all cuts are exchanged, each ring that
    /// results is one cell.
    fn cells(&self) -> (Vec<u32>, usize) {
        let mut next = vec![0u32; 2 * self.n_cuts];
        for ends in &self.all {
            for (i, e) in ends.iter().enumerate() {
                next[e.1 as usize] = ends[(i + 1) % ends.len()].1;
            }
        }
        let mut cell_of = vec![u32::MAX; 2 * self.n_cuts + self.rings.lines.len()];
        let mut n = 0;
        for first in 0..2 * self.n_cuts {
            let mut at = first;
            if cell_of[at] != u32::MAX {
                continue;
            }
            while cell_of[at] == u32::MAX {
                cell_of[at] = n;
                // At a cut the path changes over to the partner of the next cut end; the numbers of two
                // partners differ in the last bit.
                at = next[at] as usize ^ 1;
            }
            n += 1;
        }
        for (ring, ends) in self.all.iter().enumerate() {
            if ends.is_empty() {
                cell_of[2 * self.n_cuts + ring] = n;
                n += 1;
            }
        }
        (cell_of, n as usize)
    }
}
