//! One file for each command.

pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod doctor;
pub(crate) mod inspect;
pub(crate) mod inspect_faces;
mod inspect_scan;
pub(crate) mod licences;
pub(crate) mod markers;
pub(crate) mod new;
pub(crate) mod orient;
pub(crate) mod profiles;
pub(crate) mod render;
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod slice;
pub(crate) mod specimen;
pub(crate) mod strength;
#[cfg(feature = "studio")]
pub(crate) mod studio;
#[cfg(feature = "studio")]
mod studio_part;
pub(crate) mod support;
