//! Supports of a part: prescribed displacements along any directions, and the rigid motions that
//! they leave free.
//!
//! Displacements are in mm. At each node the prescribed directions are kept orthonormal
//! (Gram-Schmidt), so planes and axes may meet at any angle. Cost: linear in the supported nodes.

use grainpath_core::{DMat3, DVec3};

use super::error::SolidError;
use super::tet_mesh::TetMesh;

/// No support.
const NONE: u32 = u32::MAX;

/// Prescribed displacements. Directions at a node are kept orthonormal, so any number of planes and
/// axes may meet.
#[derive(Debug, Clone, Default)]
pub struct Supports {
    /// For each node its index in `held`, or `NONE`.
    slot: Vec<u32>,
    held: Vec<Held>,
}

#[derive(Debug, Clone)]
struct Held {
    node: u32,
    directions: Vec<(DVec3, f64)>,
    /// Projection that removes the prescribed directions from a vector.
    free: DMat3,
}

impl Supports {
    /// Creates a set without supports for this many nodes.
    pub fn new(n_nodes: usize) -> Self {
        Self { slot: vec![NONE; n_nodes], held: Vec::new() }
    }

    /// Prescribes the displacement of a node along a direction (of any length), mm. The other
    /// directions stay free: along a normal this is a roller or a plane of symmetry.
    ///
    /// # Errors
    /// When that direction already has another value.
    pub fn prescribe(
        &mut self,
        mesh: &TetMesh,
        node: u32,
        direction: DVec3,
        value_mm: f64,
    ) -> Result<(), SolidError> {
        self.prescribe_at(node, mesh.nodes[node as usize], direction, value_mm)
    }

    /// As [`Self::prescribe`], for a node whose position is `p`.
    pub(crate) fn prescribe_at(
        &mut self,
        node: u32,
        p: DVec3,
        direction: DVec3,
        value_mm: f64,
    ) -> Result<(), SolidError> {
        let i = node as usize;
        if self.slot[i] == NONE {
            self.slot[i] = self.held.len() as u32;
            self.held.push(Held { node, directions: Vec::new(), free: DMat3::IDENTITY });
        }
        let held = &mut self.held[self.slot[i] as usize];
        let direction = direction.normalize_or_zero();
        let (mut rest, mut value) = (direction, value_mm);
        // `rest` is the part of the direction that is not prescribed yet; `value` is the
        // displacement left for it.
        for &(d, v) in &held.directions {
            rest -= d * d.dot(direction);
            value -= v * d.dot(direction);
        }
        // Nothing is left, so the direction is prescribed already. The requested displacement has
        // to agree with it, within rounding.
        if rest.length() < 1e-6 {
            let known = held.directions.iter().map(|d| d.1.abs()).fold(value_mm.abs(), f64::max);
            if value.abs() > 1e-6 * known {
                let at = format!("({:.3}, {:.3}, {:.3})", p.x, p.y, p.z);
                return Err(SolidError::Contradiction { node: i, at });
            }
            return Ok(());
        }
        value /= rest.length();
        let unit = rest.normalize();
        held.directions.push((unit, value));
        held.free -= DMat3::from_cols(unit * unit.x, unit * unit.y, unit * unit.z);
        // Three prescribed directions leave no free one. The subtraction above would leave a small rounding error.
        if held.directions.len() == 3 {
            held.free = DMat3::ZERO;
        }
        Ok(())
    }

    /// Fixes a node in all directions.
    ///
    /// # Errors
    /// When it is prescribed to move.
    pub fn fix(&mut self, mesh: &TetMesh, node: u32) -> Result<(), SolidError> {
        DVec3::AXES.iter().try_for_each(|&d| self.prescribe(mesh, node, d, 0.0))
    }

    /// Projection onto the free directions of a node; `None` for a node without supports.
    pub(crate) fn free(&self, node: usize) -> Option<&DMat3> {
        self.slot.get(node).filter(|&&s| s != NONE).map(|&s| &self.held[s as usize].free)
    }

    /// Removes the prescribed directions from a field.
    pub(crate) fn project(&self, field: &mut [DVec3]) {
        for held in &self.held {
            let v = &mut field[held.node as usize];
            *v = held.free * *v;
        }
    }

    /// For each supported node its index, and the part of a field along the prescribed directions.
    pub(crate) fn held_part<'a>(&'a self, field: &'a [DVec3]) -> impl Iterator<Item = (usize, DVec3)> + 'a {
        self.held.iter().map(|h| {
            let v = field[h.node as usize];
            (h.node as usize, v - h.free * v)
        })
    }

    /// The displacement with the prescribed values and zero elsewhere, and whether any value
    /// differs from zero.
    pub(crate) fn prescribed(&self) -> (Vec<DVec3>, bool) {
        let mut u = vec![DVec3::ZERO; self.slot.len()];
        for held in &self.held {
            u[held.node as usize] = held.directions.iter().map(|&(d, v)| d * v).sum();
        }
        let any = self.held.iter().any(|h| h.directions.iter().any(|d| d.1 != 0.0));
        (u, any)
    }

    /// Number of prescribed components.
    pub fn count(&self) -> usize {
        self.held.iter().map(|h| h.directions.len()).sum()
    }

    /// Returns an error if a piece of the part can move as a rigid body; it names the piece and the
    /// motion.
    ///
    /// # Errors
    /// [`SolidError::Free`] for the first such piece.
    pub fn check(&self, mesh: &TetMesh) -> Result<(), SolidError> {
        let of_tet = mesh.piece_of_tets();
        let mut of_node = vec![NONE; mesh.nodes.len()];
        for (tet, &first) in mesh.tets.iter().zip(&of_tet) {
            for &n in tet {
                of_node[n as usize] = first;
            }
        }
        let pieces: Vec<_> = mesh.pieces_from(&of_tet).iter().map(|p| (p.first, p.lo, p.hi)).collect();
        self.check_pieces(&mesh.nodes, &of_node, &pieces)
    }

    /// As [`Self::check`], for nodes that each state the name of their piece. A piece is given by
    /// its name and its lowest and highest corner.
    pub(crate) fn check_pieces(
        &self,
        nodes: &[DVec3],
        of_node: &[u32],
        pieces: &[(u32, DVec3, DVec3)],
    ) -> Result<(), SolidError> {
        for (i, &(name, lo, hi)) in pieces.iter().enumerate() {
            let middle = 0.5 * (lo + hi);
            let radius = (0.5 * (hi - lo).length()).max(f64::MIN_POSITIVE);
            let mut rows: Vec<[f64; 6]> = Vec::new();
            for held in self.held.iter().filter(|h| of_node[h.node as usize] == name) {
                // Lever arms are divided by the size of the piece, so that rotations and
                // translations have the same scale.
                let arm = (nodes[held.node as usize] - middle) / radius;
                for &(d, _) in &held.directions {
                    let turn = arm.cross(d);
                    rows.push([d.x, d.y, d.z, turn.x, turn.y, turn.z]);
                }
            }
            let free = free_motions(&rows);
            if !free.is_empty() {
                let around = format!("({:.1}, {:.1}, {:.1})", middle.x, middle.y, middle.z);
                let free = free.iter().map(motion_name).collect::<Vec<_>>().join(", ");
                return Err(SolidError::Free { piece: i + 1, pieces: pieces.len(), around, free });
            }
        }
        Ok(())
    }
}

/// A basis of the rigid motions (translation, then rotation) that no row prevents, each with as
/// many zeros as possible.
fn free_motions(rows: &[[f64; 6]]) -> Vec<[f64; 6]> {
    // Reduced row echelon form, with pivots taken from the rotations first and the translations
    // last. A motion that can be described as a translation is then described as one.
    let mut rows = rows.to_vec();
    let mut pivots: Vec<usize> = Vec::new();
    for column in (0..6).rev() {
        let done = pivots.len();
        let best =
            (done..rows.len()).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()));
        let Some(best) = best.filter(|&b| rows[b][column].abs() > 1e-6) else { continue };
        rows.swap(done, best);
        let pivot = rows[done].map(|v| v / rows[done][column]);
        rows[done] = pivot;
        for (i, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            if i != done && factor != 0.0 {
                for (v, p) in row.iter_mut().zip(pivot) {
                    *v -= factor * p;
                }
            }
        }
        pivots.push(column);
    }
    // Each column without a pivot gives one motion: 1 there; the pivot columns follow from the rows.
    let motion = |free: usize| {
        let mut m = [0.0; 6];
        m[free] = 1.0;
        for (row, &pivot) in rows.iter().zip(&pivots) {
            m[pivot] = -row[free];
        }
        m
    };
    (0..6).filter(|c| !pivots.contains(c)).map(motion).collect()
}

fn motion_name(m: &[f64; 6]) -> String {
    let (shift, turn) = (DVec3::new(m[0], m[1], m[2]), DVec3::new(m[3], m[4], m[5]));
    let name = |d: DVec3| {
        let d = d.normalize();
        let axis = (0..3).find(|&a| d[a].abs() > 1.0 - 1e-6);
        axis.map_or_else(
            || format!("({:.2}, {:.2}, {:.2})", d.x, d.y, d.z),
            |a| ["x", "y", "z"][a].to_owned(),
        )
    };
    if turn.length() < 1e-6 {
        format!("move along {}", name(shift))
    } else {
        format!("rotate about {}", name(turn))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_tet() -> TetMesh {
        TetMesh::straight(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], &[[0, 1, 2, 3]])
    }

    fn complaint(supports: &Supports) -> String {
        supports.check(&one_tet()).expect_err("free").to_string()
    }

    #[test]
    fn free_motions_are_named() {
        let mesh = one_tet();
        let mut s = Supports::new(mesh.nodes.len());
        assert!(complaint(&s).ends_with(
            "free to move along x, move along y, move along z, rotate about x, rotate about y, rotate about z"
        ));
        for n in 0..3 {
            s.prescribe(&mesh, n, DVec3::Z, 0.0).expect("new");
        }
        assert!(
            complaint(&s).ends_with("free to move along x, move along y, rotate about z"),
            "{}",
            complaint(&s)
        );
        s.prescribe(&mesh, 0, DVec3::X, 0.0).expect("new");
        s.prescribe(&mesh, 0, DVec3::Y, 0.0).expect("new");
        assert!(complaint(&s).ends_with("free to rotate about z"), "{}", complaint(&s));
        s.prescribe(&mesh, 1, DVec3::new(1.0, 1.0, 0.0), 0.5).expect("new");
        assert!(s.check(&mesh).is_ok());
        assert_eq!(s.count(), 6);
    }

    #[test]
    fn contradictions_are_refused_and_repeats_are_not() {
        let mesh = one_tet();
        let mut s = Supports::new(mesh.nodes.len());
        s.prescribe(&mesh, 0, DVec3::X, 1.0).expect("new");
        s.prescribe(&mesh, 0, DVec3::new(1.0, 1.0, 0.0), 0.0).expect("another direction");
        s.prescribe(&mesh, 0, DVec3::Y, -1.0).expect("follows from both");
        assert!(matches!(
            s.prescribe(&mesh, 0, DVec3::Y, 1.0),
            Err(SolidError::Contradiction { node: 0, .. })
        ));
        assert_eq!(s.prescribed().0[0], DVec3::new(1.0, -1.0, 0.0));
    }
}
