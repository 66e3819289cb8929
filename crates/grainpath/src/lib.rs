//! The planner: from a job to a plan and its report.

pub mod adhesion;
pub mod fill;
pub mod mask;
pub mod order;
pub mod render;
pub mod shape;
pub mod skin;
pub mod walls;
