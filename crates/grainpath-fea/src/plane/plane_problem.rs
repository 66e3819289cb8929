//! A plate with its supports, and the check that the supports prevent rigid motion.
//!
//! Method of the check, for each connected piece: every support gives a row of three coefficients, its part
//! along x, along y and its lever arm about a node of the piece, over the size of the piece. The Gram matrix
//! of the rows has full rank if and only if the supports leave no rigid motion. Elimination in the order x,
//! y, rotation finds the first one that is free; a pivot below 1e-9 of the trace counts as zero. The test is
//! our own; it needs no factorization of the stiffness, and it names the motion.
//!
//! Lengths are in mm, stresses in MPa, memory in MiB. A stiffness gives stress xx, yy, xy from strain xx, yy
//! and the doubled strain xy. Cost: linear in nodes and supports for each piece. Degenerate cases: a piece
//! without supports is free to move along x. The direction of a support must be a unit vector.

use grainpath_core::DVec2;
use grainpath_core::math::cross;

use super::plane_mesh::PlaneMesh;
use crate::sparse::SparseError;

/// Stress from strain xx, yy, xy (doubled), MPa.
pub type PlaneStiffness = [[f64; 3]; 3];

/// A node held in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// The node.
    pub node: u32,
    /// Unit vector of the held direction.
    pub along: DVec2,
    /// Prescribed displacement along it, mm.
    pub displacement_mm: f64,
}

/// Why a plate cannot be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// A piece of the part moves freely.
    #[error("the piece around ({x:.2}, {y:.2}) mm is free to {how}; hold it with another fixture")]
    Free {
        /// x of a node of the piece, mm.
        x: f64,
        /// y of a node of the piece, mm.
        y: f64,
        /// The free motion: "move along x" and the like.
        how: &'static str,
    },
    /// Supports that contradict one another.
    #[error("the node at ({x:.2}, {y:.2}) mm is prescribed two different displacements along one direction")]
    Contradiction {
        /// x of the node, mm.
        x: f64,
        /// y of the node, mm.
        y: f64,
    },
    /// The equations could not be solved.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// An element is turned inside out.
    #[error("element {0} of the mesh is turned inside out")]
    Inverted(usize),
}

/// A plate with its supports.
pub struct PlaneProblem<'a> {
    /// Its mesh.
    pub mesh: &'a PlaneMesh,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Stiffness at a point.
    pub stiffness: &'a (dyn Fn(DVec2) -> PlaneStiffness + Sync),
    /// Its supports.
    pub holds: &'a [Hold],
    /// Memory limit of the factorization, MiB.
    pub max_mib: f64,
}

/// Returns an error if a piece of the plate can move as a rigid body.
pub(super) fn check_held(problem: &PlaneProblem<'_>) -> Result<(), PlaneError> {
    let mesh = problem.mesh;
    let (piece, n_pieces) = mesh.pieces();
    let mut first = vec![usize::MAX; n_pieces];
    (0..piece.len()).rev().for_each(|i| first[piece[i] as usize] = i);
    for p in 0..n_pieces {
        let centre = mesh.nodes[first[p]];
        let members = || (0..piece.len()).filter(|&i| piece[i] as usize == p);
        // Lever arms are divided by the size of the piece, so that the rotation has the same scale
        // as the translations.
        let size = members().map(|i| mesh.nodes[i].distance(centre)).fold(1e-12, f64::max);
        // Each support gives a row of three coefficients: two translations and a rotation. The
        // piece is held if the Gram matrix of all rows has full rank.
        let mut gram = [[0.0; 3]; 3];
        for hold in problem.holds.iter().filter(|h| piece[h.node as usize] as usize == p) {
            let r = (mesh.nodes[hold.node as usize] - centre) / size;
            let row = [hold.along.x, hold.along.y, cross(r, hold.along)];
            for i in 0..3 {
                (0..3).for_each(|j| gram[i][j] += row[i] * row[j]);
            }
        }
        if let Some(how) = loose(&mut gram) {
            return Err(PlaneError::Free { x: centre.x, y: centre.y, how });
        }
    }
    Ok(())
}

/// The first rigid motion that the supports leave free, found by elimination on their Gram matrix
/// in the order x, y, rotation.
pub(crate) fn loose(gram: &mut [[f64; 3]; 3]) -> Option<&'static str> {
    let scale = (gram[0][0] + gram[1][1] + gram[2][2]).max(1e-30);
    for k in 0..3 {
        if gram[k][k] < 1e-9 * scale {
            return Some(["move along x", "move along y", "turn about z"][k]);
        }
        for i in k + 1..3 {
            let f = gram[i][k] / gram[k][k];
            (0..3).for_each(|j| gram[i][j] -= f * gram[k][j]);
        }
    }
    None
}
