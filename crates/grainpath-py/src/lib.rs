//! The planner as a Python module.
//!
//! This crate is the part of the package `grainpath` that is written in Rust: it converts arrays to the types of the
//! planner and back. What users call is in `python/grainpath`, which checks arguments and documents them. Reading,
//! planning and writing use the code of the command line, so that both give the same bytes.
//!
//! Only the caller's thread touches Python objects; `worker` describes how this thread watches long work.

mod cli;
mod errors;
mod image;
mod mesh;
mod tools;
mod plan;
mod pool;
mod program;
mod roles;
mod scan;
mod spec;
mod stack;
mod strength;
mod stress;
mod volume;
mod worker;

/// The functions and classes that `python/grainpath` builds on.
#[pyo3::pymodule]
mod _grainpath {
    #[pymodule_export]
    use crate::cli::{cli, cli_commands};
    #[pymodule_export]
    use crate::image::{ImageData, image_from_array};
    #[pymodule_export]
    use crate::mesh::{MeshData, mesh_from_file, mesh_from_parts};
    #[pymodule_export]
    use crate::plan::{PlanData, ScanData, check, orient, plan, plan_parted};
    #[pymodule_export]
    use crate::program::{ProgramData, program_from_bytes};
    #[pymodule_export]
    use crate::roles::roles;
    #[pymodule_export]
    use crate::scan::{fill_window, fills_in_windows, scan_join, scan_part, scan_survey};
    #[pymodule_export]
    use crate::spec::{Spec, profiles, schema};
    #[pymodule_export]
    use crate::stack::{StackData, stack_from_bytes, stack_from_rings};
    #[pymodule_export]
    use crate::strength::{compare, strength};
    #[pymodule_export]
    use crate::stress::{StressData, stress_from_parts};
    #[pymodule_export]
    use crate::tools::{example, inspect, marker_sheet, pieces, specimen, support};
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
