//! A body with what is found about it before it is mended.

use super::topology::{EdgeUses, MeshHealth, Shells, examine};
use super::{TriMesh, weld_within};
use crate::Diagnostics;
use crate::diagnostics::Interrupted;

/// A body with its edges and shells.
pub struct Examined {
    /// The body, its near vertices merged where that closes edges.
    pub mesh: TriMesh,
    /// Counts of its defects.
    pub health: MeshHealth,
    /// The triangles at each edge.
    pub edges: EdgeUses,
    /// The shell of each triangle.
    pub shells: Shells,
    /// Number of open edges that merging closed.
    pub n_welded: usize,
}

impl Examined {
    /// Examines a body and merges near vertices where that closes edges; `None` for a body without
    /// triangles.
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn new(mut mesh: TriMesh, diagnostics: &Diagnostics) -> Result<Option<Self>, Interrupted> {
        diagnostics.check()?;
        // A triangle with two equal corners has no area, and its edges would count as defects.
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
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn without(
        self,
        is_left_out: &[bool],
        diagnostics: &Diagnostics,
    ) -> Result<Option<Self>, Interrupted> {
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
