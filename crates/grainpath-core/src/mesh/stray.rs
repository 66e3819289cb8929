//! Shells without volume beside a body: stray facets, double sheets and pieces of surfaces that a CAD
//! program left in the file.
//!
//! They print nothing, but they would decide where the part stands on the plate and which unit it is
//! taken to be in. A shell here is a set of facets connected over edges, any number of which may meet at an
//! edge, so that a flap on a body stays with it. The rule:
//!
//! 1. a shell has no volume if it is as thin as the rounding of its coordinates (a millionth of the largest), or if it
//!    is open along more than half of its edges, which is the rule by which a whole mesh is refused;
//! 2. an open shell of that kind stays if its box meets the box around the open edges of the shells with
//!    volume, because it may be a piece of their surface that was not joined;
//! 3. open shells stay if together they enclose a volume: a body whose facets share no vertices;
//! 4. if no shell has a volume, all stay, and slicing tells what it makes of them.
//!
//! Method: our own. Cost: linear in the triangles, and nothing for a mesh of one shell.

use std::collections::BTreeMap;

use glam::DVec3;

use super::examined::Examined;
use crate::DisjointSets;

/// Mean thickness of a shell, as a share of its largest coordinate, up to which it counts as flat.
/// Source: derived; 16 times the rounding of single-precision coordinates, 2^-24, as in the merging of
/// vertices. It is 0.1 um at 100 mm, where a bead is 200 um high.
const FLAT_SHARE: f64 = 1e-6;
/// Share of their area up to which the area vectors of shells cancel, which they do in a closed surface.
/// Source: derived; the vectors of n facets lying at random add up to a share of about 1 / sqrt(n), so
/// that ten thousand stray facets are needed to come this low.
const CLOSED_SHARE: f64 = 0.01;

/// The shells without volume beside the bodies of a mesh.
pub struct Strays {
    /// Their number.
    pub n_shells: usize,
    /// For each body, whether each of its facets belongs to one; empty if none does.
    pub facets: Vec<Vec<bool>>,
}

/// A box around points.
#[derive(Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn add(&mut self, p: DVec3) {
        (self.low, self.high) = (self.low.min(p), self.high.max(p));
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// Sums over the facets and edges of a shell.
struct Shell {
    /// Volume between the facets and the first vertex, so that a flat shell has none wherever it lies.
    volume: f64,
    /// Volume between the facets and the origin of the file.
    volume_of_origin: f64,
    area: f64,
    area_vector: DVec3,
    bounds: Bounds,
    /// Box around the open edges.
    open: Bounds,
    n_edges: usize,
    n_open: usize,
}

impl Default for Shell {
    fn default() -> Self {
        let (bounds, open) = (Bounds::EMPTY, Bounds::EMPTY);
        let area_vector = DVec3::ZERO;
        Self {
            volume: 0.0,
            volume_of_origin: 0.0,
            area: 0.0,
            area_vector,
            bounds,
            open,
            n_edges: 0,
            n_open: 0,
        }
    }
}

impl Shell {
    fn has_volume(&self) -> bool {
        let reach = self.bounds.low.abs().max(self.bounds.high.abs()).max_element();
        2 * self.n_open <= self.n_edges && !is_flat(self.volume, self.area, reach)
    }
}

/// Whether a volume is that of a sheet: both its sides together have the area.
fn is_flat(volume: f64, area: f64, reach: f64) -> bool {
    2.0 * volume.abs() <= FLAT_SHARE * reach * area
}

/// Finds the shells without volume beside the bodies of a mesh.
pub fn find_strays(bodies: &[Examined]) -> Strays {
    let none = || Strays { n_shells: 0, facets: vec![Vec::new(); bodies.len()] };
    if bodies.iter().map(|b| b.health.shells).sum::<usize>() < 2 {
        return none();
    }
    let measured: Vec<_> = bodies.iter().map(shells).collect();
    let all = || measured.iter().flat_map(|(_, shells)| shells.values());
    if !all().any(Shell::has_volume) {
        return none();
    }
    // Pieces of a surface that were not joined to it lie at its holes.
    let mut hole = Bounds::EMPTY;
    for shell in all().filter(|s| s.has_volume() && s.n_open > 0) {
        hole.add(shell.open.low);
        hole.add(shell.open.high);
    }
    let may_go = |s: &Shell| !s.has_volume() && (s.n_open == 0 || !s.bounds.meets(&hole));
    let open: Vec<&Shell> = all().filter(|s| s.n_open > 0 && may_go(s)).collect();
    // Facets that share no vertices are a shell each, and may be the surface of a body all the same.
    let area: f64 = open.iter().map(|s| s.area).sum();
    let vector: DVec3 = open.iter().map(|s| s.area_vector).sum();
    let volume: f64 = open.iter().map(|s| s.volume_of_origin).sum();
    let reach = open.iter().map(|s| s.bounds.low.abs().max(s.bounds.high.abs()).max_element());
    let is_body = vector.length() <= CLOSED_SHARE * area && !is_flat(volume, area, reach.fold(0.0, f64::max));
    let goes = |s: &Shell| may_go(s) && (s.n_open == 0 || !is_body);
    let n_shells = all().filter(|s| goes(s)).count();
    let facets = measured.iter().map(|(shell_of, shells)| {
        if shells.values().any(goes) {
            shell_of.iter().map(|id| goes(&shells[id])).collect()
        } else {
            Vec::new()
        }
    });
    Strays { n_shells, facets: facets.collect() }
}

/// The shell of each facet of a body, and the shells.
fn shells(body: &Examined) -> (Vec<u32>, BTreeMap<u32, Shell>) {
    let mesh = &body.mesh;
    let mut sets = DisjointSets::new(mesh.triangles.len());
    for mut edge in body.edges.edges() {
        let Some((first, _)) = edge.next() else { continue };
        for (other, _) in edge {
            sets.union(first, other);
        }
    }
    let shell_of = sets.names();
    let mut shells: BTreeMap<u32, Shell> = BTreeMap::new();
    for (triangle, id) in mesh.triangles.iter().zip(&shell_of) {
        let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
        let first = mesh.vertices[mesh.triangles[*id as usize][0] as usize];
        let shell = shells.entry(*id).or_default();
        let vector = 0.5 * (b - a).cross(c - a);
        shell.volume += (a - first).dot(vector) / 3.0;
        shell.volume_of_origin += a.dot(vector) / 3.0;
        shell.area += vector.length();
        shell.area_vector += vector;
        [a, b, c].into_iter().for_each(|p| shell.bounds.add(p));
    }
    for mut edge in body.edges.edges() {
        let Some((first, _)) = edge.next() else { continue };
        if let Some(shell) = shells.get_mut(&shell_of[first]) {
            shell.n_edges += 1;
            shell.n_open += usize::from(edge.next().is_none());
        }
    }
    // Where most bodies are sound, no edge is open and the second pass is skipped.
    if body.health.open_edges > 0 {
        for ([low, high], facet) in body.edges.open() {
            if let Some(shell) = shells.get_mut(&shell_of[facet]) {
                [low, high].into_iter().for_each(|i| shell.open.add(mesh.vertices[i as usize]));
            }
        }
    }
    (shell_of, shells)
}
