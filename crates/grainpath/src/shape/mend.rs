//! Repair of a damaged mesh without inventing any new surface.
//!
//! The steps, each counted in a warning:
//!
//! 1. vertices that lie together are merged, but only where edges are open, so that intended gaps stay;
//! 2. facets that repeat others are left out ([`find_repeats`]);
//! 3. shells without volume beside a body are left out ([`find_strays`]);
//! 4. facets are turned so that neighbours agree, beginning at the first facet of each shell;
//! 5. shells are turned by nesting ([`turn_outward`]): an outermost shell of negative volume is turned
//!    with all shells inside it, so that outer shells face outward and cavities inward;
//! 6. holes that remain stay in the mesh and are closed in each section ([`super::section`]).
//!
//! No triangle is added: closing holes in sections needs no surface, and a wrong cap would be cut
//! like a true surface. A mesh most of whose edges are open has no volume and is refused.
//! [`Repair::Strict`] refuses every defect. Lengths are in any unit. Cost: linear in the triangles, and
//! what nesting takes.

use grainpath_core::mesh::{EdgeUses, Examined, MeshHealth, find_repeats, find_strays};
use grainpath_core::nesting::turn_outward;
use grainpath_core::spelling::counted;
use grainpath_core::{Diagnostics, TriMesh, WarningId};

use super::ShapeError;
pub use grainpath_job::choices::Repair;

/// Joins bodies into one mesh that is wound outward as far as possible. Near vertices are merged
/// where edges are open. Facets that repeat others, and shells without volume beside a body, are left out. Shells with inconsistent
/// winding are turned face by face, and outermost shells that are inside out are turned whole, with
/// the shells inside them. Holes that remain are closed in the sections. Every change is counted in a
/// warning.
///
/// # Errors
/// [`ShapeError::Defects`] under [`Repair::Strict`]; [`ShapeError::NoVolume`] when most edges are open;
/// [`ShapeError::Interrupted`] when a stop was asked for.
pub fn mend(bodies: Vec<TriMesh>, repair: Repair, diagnostics: &Diagnostics) -> Result<TriMesh, ShapeError> {
    mend_counting(bodies, repair, diagnostics).map(|(mesh, _)| mesh)
}

/// What was changed in a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mended {
    /// Number of shells without volume beside the part that were left out.
    pub stray_shells: usize,
    /// Number of facets and shells that were turned.
    pub turned: usize,
}

/// As [`mend`]; returns in addition what was changed.
///
/// # Errors
/// As [`mend`].
pub fn mend_counting(
    bodies: Vec<TriMesh>,
    repair: Repair,
    diagnostics: &Diagnostics,
) -> Result<(TriMesh, Mended), ShapeError> {
    let mut found = Found::default();
    let mut examined = Vec::with_capacity(bodies.len());
    for body in bodies {
        examined.extend(Examined::new(body, diagnostics)?);
    }
    found.welded = examined.iter().map(|body| body.n_welded).sum();
    let repeats = find_repeats(&examined);
    found.repeated = repeats.n_facets;
    if repair == Repair::Strict && repeats.n_facets > 0 {
        let defects = format!("{} facets that repeat others", repeats.n_facets);
        return Err(ShapeError::Defects { defects });
    }
    if repeats.n_facets > 0 {
        let mut left = Vec::with_capacity(examined.len());
        for (body, is_repeated) in examined.into_iter().zip(repeats.facets) {
            left.extend(body.without(&is_repeated, diagnostics)?);
        }
        examined = left;
    }
    // All bodies are looked at together, because the pieces of one surface may be bodies of their own in the file.
    let strays = find_strays(&examined);
    found.stray = strays.n_shells;
    if repair == Repair::Strict && strays.n_shells > 0 {
        let defects = format!("{} shells without volume beside the part", strays.n_shells);
        return Err(ShapeError::Defects { defects });
    }
    let mut whole = TriMesh::default();
    for (body, is_stray) in examined.into_iter().zip(strays.facets) {
        let Some(body) = body.without(&is_stray, diagnostics)? else { continue };
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
    let changed = Mended { stray_shells: found.stray, turned: found.turned_facets + found.turned_shells };
    if whole.triangles.is_empty() { Err(ShapeError::Empty) } else { Ok((whole, changed)) }
}

/// Counts over all bodies.
#[derive(Default)]
struct Found {
    welded: usize,
    repeated: usize,
    stray: usize,
    open: usize,
    nonmanifold: usize,
    turned_facets: usize,
    turned_shells: usize,
}

impl Found {
    fn warn(&self, diagnostics: &Diagnostics) {
        let warn = |id: WarningId, n: usize, thing: &str, text: &str| {
            if n > 0 {
                diagnostics.warn(id, format!("mesh: {}{text}", counted(n, thing)));
            }
        };
        warn(WarningId::MeshRepaired, self.welded, "open edge", " closed by merging near vertices");
        warn(WarningId::MeshRepaired, self.repeated, "repeated facet", " left out");
        warn(WarningId::MeshStray, self.stray, "shell", " without volume beside the part left out");
        warn(WarningId::MeshOpen, self.open, "open edge", "; the sections were closed where they are cut");
        warn(
            WarningId::MeshNonManifold,
            self.nonmanifold,
            "edge",
            " with more than two faces; sections were united by winding number",
        );
        warn(WarningId::MeshRepaired, self.turned_facets, "badly wound facet", " turned");
        warn(WarningId::MeshRepaired, self.turned_shells, "inside-out shell", " turned");
    }
}

fn mend_body(
    body: Examined,
    repair: Repair,
    found: &mut Found,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, ShapeError> {
    let Examined { mut mesh, health, edges, shells, .. } = body;
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
    for (n, thing, what) in [
        (health.open_edges, "open edge", ""),
        (health.nonmanifold_edges, "edge", " with more than two faces"),
        (health.badly_wound_edges, "badly wound edge", ""),
    ] {
        if n > 0 {
            parts.push(format!("{}{what}", counted(n, thing)));
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
