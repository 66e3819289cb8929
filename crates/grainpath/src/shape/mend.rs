//! Repair of a damaged mesh without inventing any new surface.
//!
//! The steps, each counted in a warning:
//!
//! 1. vertices that lie together are merged, but only where edges are open, so that intended gaps stay;
//! 2. facets are turned so that neighbours agree, beginning at the first facet of each shell;
//! 3. shells of negative volume are turned as a whole, unless they may be cavities, which lie inside
//!    the bounds of a larger shell of positive volume. Only the 200 largest such shells are compared,
//!    so that the cost does not grow with the square of thousands of specks;
//! 4. holes that remain stay in the mesh and are closed in each section ([`super::section`]).
//!
//! No triangle is added: closing holes in sections needs no surface, and a wrong cap would be cut
//! like a true surface. A mesh most of whose edges are open has no volume and is refused.
//! [`Repair::Strict`] refuses every defect. Cost: linear in the triangles, and shells of negative
//! volume times 200.

use grainpath_core::mesh::{EdgeUses, MeshHealth, Shells, examine, weld_within};
use grainpath_core::{DVec3, Diagnostics, TriMesh, WarningId};

use super::ShapeError;
pub use grainpath_job::choices::Repair;

/// Joins bodies into one mesh that is wound outward as far as possible. Near vertices are merged
/// where edges are open. Shells with inconsistent winding are turned face by face, and shells
/// inside out are turned whole unless they are cavities. Holes that remain are closed in the
/// sections. Every change is counted in a warning.
///
/// # Errors
/// [`ShapeError::Defects`] under [`Repair::Strict`]; [`ShapeError::NoVolume`] when most edges are open;
/// [`ShapeError::Interrupted`] when a stop was asked for.
pub fn mend(bodies: Vec<TriMesh>, repair: Repair, diagnostics: &Diagnostics) -> Result<TriMesh, ShapeError> {
    let mut whole = TriMesh::default();
    let mut found = Found::default();
    for body in bodies {
        let body = mend_body(body, repair, &mut found, diagnostics)?;
        if whole.triangles.is_empty() {
            whole = body;
        } else {
            let first = whole.vertices.len() as u32;
            whole.vertices.extend(body.vertices);
            whole.triangles.extend(body.triangles.into_iter().map(|t| t.map(|i| i + first)));
        }
    }
    found.warn(diagnostics);
    if whole.triangles.is_empty() { Err(ShapeError::Empty) } else { Ok(whole) }
}

/// Counts over all bodies.
#[derive(Default)]
struct Found {
    welded: usize,
    open: usize,
    nonmanifold: usize,
    turned_facets: usize,
    turned_shells: usize,
}

impl Found {
    fn warn(&self, diagnostics: &Diagnostics) {
        let warn = |id: WarningId, n: usize, text: &str| {
            if n > 0 {
                diagnostics.warn(id, format!("mesh: {n} {text}"));
            }
        };
        warn(WarningId::MeshRepaired, self.welded, "open edges closed by merging near vertices");
        warn(WarningId::MeshOpen, self.open, "open edges; the sections were closed where they are cut");
        warn(
            WarningId::MeshNonManifold,
            self.nonmanifold,
            "edges with more than two faces; sections were united by winding number",
        );
        warn(WarningId::MeshRepaired, self.turned_facets, "badly wound facets turned");
        warn(WarningId::MeshRepaired, self.turned_shells, "inside-out shells turned");
    }
}

fn mend_body(
    mut mesh: TriMesh,
    repair: Repair,
    found: &mut Found,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, ShapeError> {
    diagnostics.check()?;
    mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    let Some((mut health, mut edges, mut shells)) = examine(&mesh, diagnostics)? else {
        return Ok(TriMesh::default());
    };
    diagnostics.check()?;
    if health.open_edges > 0 {
        let open = health.open_edges;
        let (low, high) = health.bounds;
        // The distance is a millionth of the part's size. Rounding of single-precision coordinates
        // in a file is about a sixteenth of that.
        let welded = weld_within(&mesh, 1e-6 * (high - low).max_element(), || diagnostics.check())?;
        // Merging is kept only if it closes edges; otherwise it would only move vertices.
        if let Some(better) = examine(&welded, diagnostics)?.filter(|(h, ..)| h.open_edges < open) {
            found.welded += open - better.0.open_edges;
            mesh = welded;
            (health, edges, shells) = better;
        }
        diagnostics.check()?;
    }
    // Each triangle has three edges, each shared by two triangles unless it is open.
    let n_edges = (3 * health.n_triangles + health.open_edges) / 2;
    if 2 * health.open_edges > n_edges {
        return Err(ShapeError::NoVolume { open_edges: health.open_edges, n_edges });
    }
    if repair == Repair::Strict && (!health.is_closed() || health.volume < 0.0) {
        return Err(ShapeError::Defects { defects: defects(&health) });
    }
    found.open += health.open_edges;
    found.nonmanifold += health.nonmanifold_edges;
    // Edges and shells were found before facets are turned: turning changes no adjacency.
    if health.badly_wound_edges > 0 {
        found.turned_facets += wind_alike(&mut mesh, &edges);
    }
    diagnostics.check()?;
    found.turned_shells += turn_outward(&mut mesh, &shells);
    Ok(mesh)
}

/// The defects of a mesh in words.
pub(crate) fn defects(health: &MeshHealth) -> String {
    let mut parts = Vec::new();
    for (n, what) in [
        (health.open_edges, "open edges"),
        (health.nonmanifold_edges, "edges with more than two faces"),
        (health.badly_wound_edges, "badly wound edges"),
    ] {
        if n > 0 {
            parts.push(format!("{n} {what}"));
        }
    }
    if health.volume < 0.0 {
        parts.push("a negative volume (inside out)".into());
    }
    parts.join(", ")
}

/// Turns facets so that neighbours over edges of two faces agree, beginning at the lowest-numbered
/// facet of each shell. Returned is the number of facets turned.
fn wind_alike(mesh: &mut TriMesh, edges: &EdgeUses) -> usize {
    // Up to three neighbours of each facet, each with a flag: whether the two are wound alike so far.
    let mut neighbours = vec![[(u32::MAX, true); 3]; mesh.triangles.len()];
    let mut add = |t: usize, other: usize, alike: bool| {
        if let Some(slot) = neighbours[t].iter_mut().find(|s| s.0 == u32::MAX) {
            *slot = (other as u32, alike);
        }
    };
    for mut edge in edges.edges() {
        // An edge tells whether its facets are wound alike only if it has exactly two facets.
        let (Some((a, down_a)), Some((b, down_b)), None) = (edge.next(), edge.next(), edge.next()) else {
            continue;
        };
        add(a, b, down_a != down_b);
        add(b, a, down_a != down_b);
    }
    let mut turn: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    let mut stack = Vec::new();
    for seed in 0..mesh.triangles.len() {
        if turn[seed].is_some() {
            continue;
        }
        turn[seed] = Some(false);
        stack.push(seed);
        while let Some(t) = stack.pop() {
            let turned = turn[t] == Some(true);
            for &(other, alike) in neighbours[t].iter().filter(|n| n.0 != u32::MAX) {
                if turn[other as usize].is_none() {
                    turn[other as usize] = Some(turned == alike);
                    stack.push(other as usize);
                }
            }
        }
    }
    let mut n = 0;
    for (triangle, turn) in mesh.triangles.iter_mut().zip(turn) {
        if turn == Some(true) {
            triangle.swap(1, 2);
            n += 1;
        }
    }
    n
}

/// Turns shells of negative volume that do not lie in a shell of positive volume. Returned is their
/// number.
fn turn_outward(mesh: &mut TriMesh, shells: &Shells) -> usize {
    struct Shell {
        id: usize,
        volume: f64,
        low: DVec3,
        high: DVec3,
    }
    let mut all: Vec<Shell> = Vec::new();
    let mut slot = vec![u32::MAX; mesh.triangles.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let id = shells.shell(t);
        if slot[id] == u32::MAX {
            slot[id] = all.len() as u32;
            all.push(Shell { id, volume: 0.0, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY });
        }
        let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
        let shell = &mut all[slot[id] as usize];
        // Signed volume of the tetrahedron from the triangle to the origin. Summed over a closed
        // shell, the parts outside the shell cancel.
        shell.volume += a.dot(b.cross(c)) / 6.0;
        shell.low = shell.low.min(a).min(b).min(c);
        shell.high = shell.high.max(a).max(b).max(c);
    }
    let hold = |outer: &Shell, inner: &Shell| {
        outer.low.cmple(inner.low).all() && outer.high.cmpge(inner.high).all() && outer.volume > -inner.volume
    };
    let mut outer: Vec<usize> = (0..all.len()).filter(|&i| all[i].volume > 0.0).collect();
    // Only the largest shells can contain others. The bound keeps thousands of specks from costing
    // the square of their number.
    outer.sort_by(|&i, &j| all[j].volume.total_cmp(&all[i].volume).then(i.cmp(&j)));
    outer.truncate(200);
    let inverted = |s: &&Shell| s.volume < 0.0 && !outer.iter().any(|&o| hold(&all[o], s));
    let turned: Vec<usize> = all.iter().filter(inverted).map(|s| s.id).collect();
    if !turned.is_empty() {
        let mut marked = vec![false; mesh.triangles.len()];
        turned.iter().for_each(|&id| marked[id] = true);
        for t in 0..mesh.triangles.len() {
            if marked[shells.shell(t)] {
                mesh.triangles[t].swap(1, 2);
            }
        }
    }
    turned.len()
}
