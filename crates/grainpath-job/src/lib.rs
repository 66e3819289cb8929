//! Settings, loads and profiles of a job, as typed by its author.
//!
//! A job file is TOML. Each setting is declared once, as a row in `settings.rs` with its key, type, default, unit, range and
//! help text; the parser, `--set`, the JSON Schema and `docs/settings.md` come from those rows. A setting with a list of
//! words is an enum of [`choices`], so the planner's stages never compare texts.
//!
//! [`parse_job`] reads a job in this order, where each step overrides the one before: defaults, the profiles of
//! printer, material and process, the file, and the `--set` arguments. It then checks the settings against each other.
//! No later stage has to check a setting again. Errors name the file and the line, which come from the spans of the
//! TOML parser.
//!
//! Old files stay readable: `format` is the version of the file format, and [`RENAMED`] lists keys that have a new
//! name. A renamed key is read with a warning that names the new one.
//!
//! This crate has no geometry; the planner finds which part of the mesh a place selects.
//!
//! ```
//! use grainpath_job::choices::GuideKind;
//! use grainpath_job::parse_job;
//!
//! let job = "format = 1\n[shape]\nmesh = \"bracket.stl\"\n[process]\nwals = 3\n";
//! let no_files = |_: &str| Err("no profiles of its own".to_owned());
//! let error = parse_job(job, "job.toml", &[], &no_files).unwrap_err();
//! assert_eq!(error.to_string(), "job.toml:5: unknown key `wals` in [process]; did you mean `walls`?");
//!
//! let settings = parse_job("", "job.toml", &["guide.kind=stress".to_owned()], &no_files).unwrap();
//! assert_eq!(settings.guide.kind, GuideKind::Stress);
//! ```

pub mod choices;
mod combination_error;
mod combinations;
pub mod edit;
mod error;
mod fill_density;
mod first_stage;
mod layer_angles;
pub mod loads;
mod parse;
mod profiles;
pub mod modifiers;
pub mod regions;
mod renamed;
mod schema;
mod settings;
mod source;
mod value;
mod wall_count;

pub use combination_error::{
    Combination, GradedProblem, LayerShiftProblem, LinesProblem, StaggerProblem, WallsProblem,
};
pub use error::{JobError, Location};
pub use fill_density::{FillDensity, GradedDensity, LEAST_GRADED};
pub use first_stage::{FirstStage, first_stages_markdown};
pub use layer_angles::{AngleRange, LayerAngles};
pub use parse::{FORMAT, parse_job};
pub use profiles::{PROFILES, Profile, default_profile, profile, profiles_of};
pub use regions::JobRegion;
pub use renamed::{REMOVED, RENAMED, Removed, Renamed};
pub use schema::{json_schema, markdown};
pub use settings::{
    CtSection, FibreSection, FillSection, GuideSection, ImageSection, MaterialSection, OutputSection,
    PhotoSection, PrinterSection, ProcessSection, Row, Settings, ShapeSection, StrengthSection,
    SupportSection, VolumeSection,
};
pub use value::{Check, Pair, Param, Problem, Step, ValueError};
pub use wall_count::WallCount;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
