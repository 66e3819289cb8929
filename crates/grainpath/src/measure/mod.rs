//! What is known once a job is planned, and what is measured on the program that was written.

pub mod dimensions;
pub mod fibre;
pub mod plan_json;
mod planned;
pub mod report;
pub mod strength;

pub use planned::Planned;
