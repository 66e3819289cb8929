//! Settings of a job, declared once, profiles, and the checks that make a job file trustworthy.
//!
//! Each setting is one row in `settings.rs`; the job parser, `--set`, the JSON Schema and the reference page all come
//! from those rows. After [`parse_job`] nobody checks a setting again.

pub mod choices;
pub mod loads;
mod parse;
mod profiles;
mod schema;
mod settings;
mod value;

pub use parse::{JobError, parse_job};
pub use profiles::{PROFILES, Profile, profile};
pub use schema::{json_schema, markdown};
pub use settings::{
    FibreSection, FillSection, GuideSection, ImageSection, MaterialSection, OutputSection, PhotoSection,
    PrinterSection, ProcessSection, Settings, ShapeSection, StrengthSection, SupportSection, VolumeSection,
};
pub use value::{Check, Param};
