//! One file for each command.

pub mod compare;
pub mod completions;
pub mod doctor;
pub mod inspect;
pub mod inspect_faces;
mod inspect_scan;
pub mod licences;
pub mod markers;
pub mod new;
pub mod orient;
pub mod profiles;
pub mod render;
pub mod run;
pub mod schema;
pub mod slice;
pub mod specimen;
pub mod strength;
#[cfg(feature = "studio")]
pub mod studio;
#[cfg(feature = "studio")]
mod studio_part;
pub mod support;
