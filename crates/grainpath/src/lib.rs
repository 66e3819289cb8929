//! The planner: from a job to a plan and its report.
//!
//! The crate opens no files: front ends read bytes, call [`run::plan_job`], and write the result.
//!
//! The modules are listed in reading order, from the whole run down to the stages that it calls. A
//! module uses only modules listed below it.

pub mod run;
pub mod error;
pub mod orient;
pub mod measure;
pub mod support;
pub mod region;
pub mod fibre;
pub mod fill;
pub mod order;
pub mod guide;
pub mod shape;
pub mod wall;
pub mod error_kind;

pub use error::Error;
pub use error_kind::ErrorKind;
pub use grainpath_job::Settings;
pub use run::{Inputs, Planned, plan_job, plan_layers, plan_parted_scan, plan_photo, plan_scan};
