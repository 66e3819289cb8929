//! Roles of beads as numbers.

use grainpath_core::Role;
use pyo3::prelude::*;

/// The number of a role: its index in [`Role::ALL`]. `roles` gives the names in this order.
pub(crate) fn role_number(role: Role) -> u8 {
    Role::ALL.iter().position(|r| *r == role).unwrap_or_default() as u8
}

/// The names of roles, as G-code has them, in the order of their numbers.
#[pyfunction]
pub(crate) fn roles() -> Vec<&'static str> {
    Role::ALL.iter().map(|r| r.gcode_name()).collect()
}
