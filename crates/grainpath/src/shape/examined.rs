//! A body with what is found about it before it is mended.

use grainpath_core::mesh::{EdgeUses, MeshHealth, Shells, examine, weld_within};
use grainpath_core::{Diagnostics, TriMesh};

use super::ShapeError;

/// A body with its edges and shells.
pub(super) struct Examined {
    pub(super) mesh: TriMesh,
    pub(super) health: MeshHealth,
    pub(super) edges: EdgeUses,
    pub(super) shells: Shells,
    /// Number of open edges that merging closed.
    pub(super) n_welded: usize,
}

impl Examined {
    /// Examines a body and merges near vertices where that closes edges; `None` for a body without
    /// triangles.
    pub(super) fn new(mut mesh: TriMesh, diagnostics: &Diagnostics) -> Result<Option<Self>, ShapeError> {
        diagnostics.check()?;
        mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        let Some((mut health, mut edges, mut shells)) = examine(&mesh, diagnostics)? else {
            return Ok(None);
        };
        diagnostics.check()?;
        let mut n_welded = 0;
        if health.open_edges > 0 {
            let open = health.open_edges;
            let (low, high) = health.bounds;
            // The distance is a millionth of the part's size. Rounding of single-precision coordinates
            // in a file is about a sixteenth of that.
            let welded = weld_within(&mesh, 1e-6 * (high - low).max_element(), || diagnostics.check())?;
            // Merging is kept only if it closes edges; otherwise it would only move vertices.
            if let Some(better) = examine(&welded, diagnostics)?.filter(|(h, ..)| h.open_edges < open) {
                n_welded = open - better.0.open_edges;
                mesh = welded;
                (health, edges, shells) = better;
            }
            diagnostics.check()?;
        }
        Ok(Some(Self { mesh, health, edges, shells, n_welded }))
    }

    /// The body without the given facets; `None` if nothing is left. `is_left_out` is empty if all stay.
    pub(super) fn without(
        self,
        is_left_out: &[bool],
        diagnostics: &Diagnostics,
    ) -> Result<Option<Self>, ShapeError> {
        if !is_left_out.contains(&true) {
            return Ok(Some(self));
        }
        let (mut mesh, n_welded) = (self.mesh, self.n_welded);
        let mut facet = is_left_out.iter();
        mesh.triangles.retain(|_| facet.next() != Some(&true));
        let examined = examine(&mesh, diagnostics)?;
        Ok(examined.map(|(health, edges, shells)| Self { mesh, health, edges, shells, n_welded }))
    }
}
