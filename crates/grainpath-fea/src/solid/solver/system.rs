//! The interface through which conjugate gradients and their preconditioner use a stiffness matrix.

use grainpath_core::{DMat3, DVec3};

use crate::solid::model::constraints::Supports;

/// A stiffness that is applied without being stored.
pub(crate) trait System: Sync {
    /// Number of nodes.
    fn n_nodes(&self) -> usize;

    /// Its supports.
    fn supports(&self) -> &Supports;

    /// The scratch that `forces` needs.
    fn scratch(&self) -> Vec<DVec3>;

    /// Forces of a displacement, as if no node were supported.
    fn forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]);

    /// `forces` with a few correct digits, where that is cheaper; a preconditioner needs no more.
    fn rough_forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.forces(u, f, scratch);
    }

    /// Inverses of the diagonal blocks; for supported directions the identity.
    fn inverse_diagonal(&self) -> Vec<DMat3>;

    /// Forces of a displacement that is zero along supports. The supported parts of rows are
    /// replaced by the identity.
    fn apply(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.forces(u, f, scratch);
        self.hold(u, f);
    }

    /// [`System::apply`] with a few correct digits.
    fn rough_apply(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.rough_forces(u, f, scratch);
        self.hold(u, f);
    }

    /// Replaces the supported parts of rows by the identity.
    fn hold(&self, u: &[DVec3], f: &mut [DVec3]) {
        self.supports().project(f);
        for (i, held) in self.supports().held_part(u) {
            f[i] += held;
        }
    }
}
