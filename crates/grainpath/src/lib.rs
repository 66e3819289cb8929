//! The planner: from a job to a plan and its report.

pub mod mask;
pub mod render;
pub mod skin;
