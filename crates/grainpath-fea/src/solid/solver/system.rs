//! What the iteration and its preconditioner ask of a stiffness.

use grainpath_core::{DMat3, DVec3};

use crate::solid::model::constraints::Supports;

/// A stiffness that is applied, not stored.
pub(crate) trait System: Sync {
    /// Number of nodes.
    fn n_nodes(&self) -> usize;

    /// What holds it.
    fn supports(&self) -> &Supports;

    /// The scratch that `forces` needs.
    fn scratch(&self) -> Vec<DVec3>;

    /// Forces of a displacement, as if nothing were held.
    fn forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]);

    /// [`System::forces`] to a few digits, where that is cheaper: what a preconditioner needs.
    fn rough_forces(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.forces(u, f, scratch);
    }

    /// Inverses of the blocks on the diagonal, of what is held the identity.
    fn inverse_diagonal(&self) -> Vec<DMat3>;

    /// Forces of a displacement that is zero where held, with the held parts of rows replaced by the identity.
    fn apply(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.forces(u, f, scratch);
        self.hold(u, f);
    }

    /// [`System::apply`] to a few digits.
    fn rough_apply(&self, u: &[DVec3], f: &mut [DVec3], scratch: &mut [DVec3]) {
        self.rough_forces(u, f, scratch);
        self.hold(u, f);
    }

    /// Replaces the held parts of rows by the identity.
    fn hold(&self, u: &[DVec3], f: &mut [DVec3]) {
        self.supports().project(f);
        for (i, held) in self.supports().held_part(u) {
            f[i] += held;
        }
    }
}
