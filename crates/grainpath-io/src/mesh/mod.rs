//! Triangle meshes: what their readers return ([`model`]) and one reader for each format.

pub(crate) mod model;
pub(crate) mod obj;
pub(crate) mod off;
pub(crate) mod ply;
pub(crate) mod stl;
