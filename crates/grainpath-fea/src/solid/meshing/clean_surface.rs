//! Takes shells without volume out of a surface before it is meshed.
//!
//! Converted CAD files contain stray facets, double sheets whose two sides coincide, and specks beside the
//! body. They enclose no volume that could carry a load, but the rays that measure wall thickness would find
//! walls of zero thickness there. A shell is a set of facets connected over edges. Any number of facets may
//! meet at an edge, so that a flap on the body stays with it.
//!
//! Method: our own. Facets are joined to shells over their common edges by union-find. The volume of a shell
//! is the sum of the tetrahedra between its facets and its own first vertex, so a flat shell has none
//! wherever it lies. A closed shell is removed below a millionth of the volume of all shells, an open one
//! below a thousandth.
//!
//! Lengths are in mm, volumes in mm3. Cost: sorting three edges a facet. Degenerate cases: a surface of one
//! shell stays as it is. So does a surface whose facets share no vertices, because it falls into shells of
//! one facet each. So does one whose flat shells together hold more than a hundredth of the volume, and one
//! that consists of flat shells alone.

use std::borrow::Cow;
use std::collections::BTreeMap;

use grainpath_core::mesh::EdgeUses;
use grainpath_core::{DisjointSets, TriMesh};

/// A closed shell with less than this share of the volume is taken out. Source: derived: a
/// millionth of the volume is a body a hundredth of the part's size across, while pieces of up to a
/// thousandth are left out of the elements anyway.
const MAX_CLOSED_SHARE: f64 = 1e-6;
/// An open shell with less than this share of the volume is taken out, since what it encloses is
/// unknown. Source: derived: the share below which pieces are left out of the elements.
const MAX_OPEN_SHARE: f64 = 1e-3;

/// A surface without its flat shells.
pub(super) struct CleanSurface<'a> {
    pub(super) mesh: Cow<'a, TriMesh>,
    /// Number of shells taken out.
    pub(super) n_removed: usize,
    /// For each facet its number in the given surface; empty if no shell was removed.
    original: Vec<u32>,
}

impl CleanSurface<'_> {
    /// The number that a facet had in the surface that was given.
    pub(super) fn original_facet(&self, facet: u32) -> u32 {
        self.original.get(facet as usize).copied().unwrap_or(facet)
    }
}

/// Sums over a shell.
#[derive(Default, Clone, Copy)]
struct Shell {
    /// Volume between the facets and the shell's first vertex, mm3.
    volume_mm3: f64,
    open: bool,
}

/// The surface without shells that enclose next to no volume.
pub(super) fn without_flat_shells(surface: &TriMesh) -> CleanSurface<'_> {
    let unchanged = || CleanSurface { mesh: Cow::Borrowed(surface), n_removed: 0, original: Vec::new() };
    let shell_of = shells(surface);
    let mut shells: BTreeMap<u32, Shell> = BTreeMap::new();
    for (t, &shell) in shell_of.iter().enumerate() {
        // Volumes are measured from a vertex of the shell itself, so that a flat shell far from the
        // origin has none.
        let from = surface.vertices[surface.triangles[shell as usize][0] as usize];
        let [a, b, c] = surface.triangles[t].map(|i| surface.vertices[i as usize] - from);
        shells.entry(shell).or_default().volume_mm3 += a.cross(b).dot(c) / 6.0;
    }
    if shells.len() < 2 {
        return unchanged();
    }
    for edge in EdgeUses::count(surface).edges() {
        let uses: Vec<usize> = edge.map(|u| u.0).collect();
        if let Some(shell) = shells.get_mut(&shell_of[uses[0]]) {
            shell.open |= uses.len() == 1;
        }
    }
    let total: f64 = shells.values().map(|s| s.volume_mm3.abs()).sum();
    let is_flat = |s: &Shell| {
        let share = if s.open { MAX_OPEN_SHARE } else { MAX_CLOSED_SHARE };
        s.volume_mm3.abs() <= share * total
    };
    let removed_mm3: f64 = shells.values().filter(|s| is_flat(s)).map(|s| s.volume_mm3.abs()).sum();
    let n_removed = shells.values().filter(|s| is_flat(s)).count();
    // In a soup every facet is a shell of its own: measured from their own vertices the volumes are
    // zero, but the whole surface encloses a volume.
    let is_soup = surface.signed_volume().abs() > 2.0 * total;
    // Flat shells that together hold more than a hundredth of the volume belong to the part, so the
    // surface is left as it is.
    if n_removed == 0 || n_removed == shells.len() || is_soup || removed_mm3 > 0.01 * total {
        return unchanged();
    }
    let original: Vec<u32> =
        (0..shell_of.len() as u32).filter(|&t| !is_flat(&shells[&shell_of[t as usize]])).collect();
    let triangles = original.iter().map(|&t| surface.triangles[t as usize]).collect();
    let mesh = TriMesh { vertices: surface.vertices.clone(), triangles };
    CleanSurface { mesh: Cow::Owned(mesh), n_removed, original }
}

/// For each facet, the lowest-numbered facet that it is connected to over edges.
fn shells(surface: &TriMesh) -> Vec<u32> {
    let mut shells = DisjointSets::new(surface.triangles.len());
    for mut edge in EdgeUses::count(surface).edges() {
        let Some((first, _)) = edge.next() else { continue };
        for (other, _) in edge {
            shells.union(first, other);
        }
    }
    shells.names()
}
