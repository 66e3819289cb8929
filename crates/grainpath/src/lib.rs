//! The planner: from a job to a plan and its report.
//!
//! It opens no file: front ends read bytes, call [`run::plan_job`], and write what comes back.

pub mod adhesion;
pub mod config;
pub mod dimensions;
pub mod error;
pub mod examples;
pub mod fibre;
mod field_mesh;
pub mod fill;
pub mod grain;
pub mod guide;
pub mod html;
pub mod job;
pub mod mask;
pub mod order;
pub mod plan_json;
pub mod render;
pub mod report;
pub mod run;
pub mod shape;
pub mod skin;
pub mod specimen;
pub mod strength;
pub mod support;
pub mod test_pieces;
pub mod walls;

pub use error::Error;
pub use job::Settings;
pub use run::{Inputs, Planned, plan_job, plan_photo, plan_scan};
