//! Defects of a mesh: shells, open, non-manifold and badly wound edges, triangles without area.
//!
//! Edges are found by sorting the sides of all triangles: by their lower vertex in one counting pass, then within each
//! vertex. The cost is linear in the triangles; sides that meet at one vertex cost n log n.

use glam::DVec3;

use super::TriMesh;
use crate::diagnostics::Interrupted;
use crate::{Diagnostics, DisjointSets};

/// Size and defects of a mesh. Edges are counted after equal vertices were merged.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshHealth {
    /// Number of triangles.
    pub n_triangles: usize,
    /// Number of different vertices in use.
    pub n_vertices: usize,
    /// Groups of triangles connected over edges of two faces; bodies that only touch are separate.
    pub shells: usize,
    /// Edges with one face.
    pub open_edges: usize,
    /// Edges with more than two faces.
    pub nonmanifold_edges: usize,
    /// Edges that several triangles run along in the same direction: neighbouring triangles wound against each other.
    pub badly_wound_edges: usize,
    /// Triangles of practically no area (under 1e-12 of the longest extent squared).
    pub zero_area_facets: usize,
    /// Signed volume in the cube of the file's unit; negative when the mesh is inside out.
    pub volume: f64,
    /// Lowest and highest corner, in the file's unit.
    pub bounds: (DVec3, DVec3),
}

impl MeshHealth {
    /// Whether every edge belongs to exactly two triangles, which run along it in opposite directions.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0 && self.nonmanifold_edges == 0 && self.badly_wound_edges == 0
    }
}

/// The use of an undirected edge by one triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Use {
    /// The higher of the edge's two vertices.
    high: u32,
    /// Triangle index times two, plus one when the triangle runs from high to low.
    triangle: u32,
}

/// The edges of a mesh with the triangles at each, sorted by edge.
pub struct EdgeUses {
    /// For each vertex the first of the uses whose lower vertex it is; the last entry is their number.
    starts: Vec<u32>,
    uses: Vec<Use>,
}

impl EdgeUses {
    /// Finds all edges; 8 bytes for each side of each triangle and 4 for each vertex. Sides of no length are left out.
    pub fn count(mesh: &TriMesh) -> Self {
        let sides = || {
            mesh.triangles.iter().enumerate().flat_map(|(t, &[a, b, c])| {
                let side = move |(from, to): (u32, u32)| {
                    let triangle = 2 * t as u32 + u32::from(from > to);
                    (from.min(to), Use { high: from.max(to), triangle })
                };
                [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from != to).map(side)
            })
        };
        // A counting sort by the lower vertex. A million triangles take 0.1 s; comparing all sides took 0.3 s. Readers
        // allow 200 million triangles, so that 32 bits hold the number of sides.
        let mut starts = vec![0u32; mesh.vertices.len() + 1];
        sides().for_each(|(low, _)| starts[low as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut uses = vec![Use { high: 0, triangle: 0 }; starts[mesh.vertices.len()] as usize];
        for (low, side) in sides() {
            let place = &mut starts[low as usize];
            uses[*place as usize] = side;
            *place += 1;
        }
        // Every entry has come to the start of the vertex after its own.
        starts.rotate_right(1);
        starts[0] = 0;
        starts.windows(2).for_each(|s| uses[s[0] as usize..s[1] as usize].sort_unstable());
        Self { starts, uses }
    }

    /// For each edge its lower vertex and its uses.
    fn by_edge(&self) -> impl Iterator<Item = (u32, &[Use])> + '_ {
        (0u32..).zip(self.starts.windows(2)).flat_map(|(low, s)| {
            let of_vertex = &self.uses[s[0] as usize..s[1] as usize];
            of_vertex.chunk_by(|a, b| a.high == b.high).map(move |uses| (low, uses))
        })
    }

    /// For each edge its uses as (triangle, runs from the higher to the lower vertex).
    pub fn edges(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, bool)> + '_> + '_ {
        let split = |u: &Use| ((u.triangle / 2) as usize, u.triangle & 1 == 1);
        self.by_edge().map(move |(_, uses)| uses.iter().map(split))
    }

    /// Edges that do not have exactly two triangles, as pairs of vertices: open ones and those where surfaces meet.
    pub fn faulty(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.by_edge().filter(|(_, uses)| uses.len() != 2).map(|(low, uses)| [low, uses[0].high])
    }

    /// Edges with a single triangle, as pairs of vertices with that triangle.
    pub fn open(&self) -> impl Iterator<Item = ([u32; 2], usize)> + '_ {
        let open = self.by_edge().filter(|(_, uses)| uses.len() == 1);
        open.map(|(low, uses)| ([low, uses[0].high], (uses[0].triangle / 2) as usize))
    }

    /// Edges, as pairs of vertices, that do not belong to exactly two triangles running along them in opposite
    /// directions: those of [`EdgeUses::faulty`], and those between triangles wound against each other.
    pub fn unsound(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let is_sound = |uses: &[Use]| uses.len() == 2 && (uses[0].triangle ^ uses[1].triangle) & 1 == 1;
        self.by_edge().filter(move |(_, uses)| !is_sound(uses)).map(|(low, uses)| [low, uses[0].high])
    }
}

/// Triangles grouped into shells, which are connected over edges of two faces.
pub struct Shells(Vec<u32>);

impl Shells {
    /// Finds the shells of a mesh.
    pub fn find(mesh: &TriMesh, edges: &EdgeUses) -> Self {
        let mut shells = DisjointSets::new(mesh.triangles.len());
        for mut edge in edges.edges() {
            // Where an edge has more than two faces, bodies touch. Which faces continue each other is undefined
            // there, so such an edge connects none.
            if let (Some((first, _)), Some((other, _)), None) = (edge.next(), edge.next(), edge.next()) {
                shells.union(first, other);
            }
        }
        Self(shells.names())
    }

    /// The shell of a triangle, given as the lowest index of a triangle in it.
    pub fn shell(&self, triangle: usize) -> usize {
        self.0[triangle] as usize
    }

    /// Number of shells.
    pub fn count(&self) -> usize {
        self.0.iter().enumerate().filter(|&(i, &s)| i == s as usize).count()
    }
}

/// Examines a mesh. `None` for one without triangles.
pub fn diagnose(mesh: &TriMesh) -> Option<MeshHealth> {
    let never_stopped = examine(mesh, &Diagnostics::default()).ok()?;
    never_stopped.map(|(health, ..)| health)
}

/// As [`diagnose`]; returns in addition the edges and shells from which the defects are counted.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for. It is looked for between passes over the mesh, of which each takes at most
/// 0.2 s for a million triangles.
pub fn examine(
    mesh: &TriMesh,
    diagnostics: &Diagnostics,
) -> Result<Option<(MeshHealth, EdgeUses, Shells)>, Interrupted> {
    let Some(bounds) = mesh.bounds() else { return Ok(None) };
    diagnostics.check()?;
    let uses = EdgeUses::count(mesh);
    diagnostics.check()?;
    let shells = Shells::find(mesh, &uses);
    diagnostics.check()?;
    let (mut open, mut nonmanifold, mut badly_wound) = (0, 0, 0);
    for edge in uses.edges() {
        let (mut up, mut down) = (0usize, 0usize);
        for (_, runs_down) in edge {
            if runs_down { down += 1 } else { up += 1 }
        }
        open += usize::from(up + down == 1);
        nonmanifold += usize::from(up + down > 2);
        // In a sound mesh, triangles run along each edge once in either direction.
        badly_wound += usize::from(up > 1) + usize::from(down > 1);
    }
    diagnostics.check()?;
    let extent = (bounds.1 - bounds.0).max_element();
    let v = |i: u32| mesh.vertices[i as usize];
    // Twice the area is compared, hence 2e-12 for a limit of 1e-12.
    let flat = |&&[a, b, c]: &&[u32; 3]| (v(b) - v(a)).cross(v(c) - v(a)).length() < 2e-12 * extent * extent;
    let mut used = vec![false; mesh.vertices.len()];
    for &i in mesh.triangles.iter().flatten() {
        used[i as usize] = true;
    }
    let health = MeshHealth {
        n_triangles: mesh.triangles.len(),
        n_vertices: used.iter().filter(|&&u| u).count(),
        shells: shells.count(),
        open_edges: open,
        nonmanifold_edges: nonmanifold,
        badly_wound_edges: badly_wound,
        zero_area_facets: mesh.triangles.iter().filter(flat).count(),
        volume: mesh.signed_volume(),
        bounds,
    };
    Ok(Some((health, uses, shells)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron(at: DVec3, first: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + at).to_vec();
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|t| t.map(|i| i + first)).to_vec();
        (vertices, triangles)
    }

    #[test]
    fn two_closed_shells_and_what_damage_does() {
        let (mut vertices, mut triangles) = tetrahedron(DVec3::ZERO, 0);
        let (v, t) = tetrahedron(DVec3::splat(5.0), 4);
        vertices.extend(v);
        triangles.extend(t);
        let mut mesh = TriMesh { vertices, triangles };
        let health = diagnose(&mesh).expect("not empty");
        assert!(health.is_closed() && health.shells == 2);
        assert!((health.volume - 2.0 / 6.0).abs() < 1e-12);
        mesh.triangles[0].swap(0, 1);
        let flipped = diagnose(&mesh).expect("not empty");
        assert_eq!((flipped.badly_wound_edges, flipped.open_edges), (3, 0));
        mesh.triangles.remove(0);
        assert_eq!(diagnose(&mesh).expect("not empty").open_edges, 3);
        assert!(diagnose(&TriMesh::default()).is_none());
    }
}
