//! The studio: a local server, and the page it gives to the user's browser.
//!
//! The server listens on 127.0.0.1 alone. Every request carries the token of this start and names a host that is
//! allowed ([`access`]); files are read below the folders that were given and written below one working folder
//! ([`roots`]). Runs (reading a program, planning a job, testing strength) wait in a queue and are done one at a time on a
//! thread of their own ([`runs`]); what they compute is up to an [`Engine`], which the command line implements with the
//! code of its own commands. Toolpaths cross the wire as eight bytes a segment, layer by layer ([`records`]).
//!
//! Cost: a program of n beads takes 32 n bytes in the server. Limits: HTTP/1.1 without encryption; one user; runs are
//! kept until the program ends or newer ones take their place.

pub mod access;
mod answers;
mod api;
mod assets;
mod engine;
mod file_kind;
mod gate;
mod history;
mod openapi;
pub mod records;
mod refusal;
pub mod roots;
pub mod runs;
mod cut_view;
mod drafts;
mod serve;
mod studio;
mod surface_bytes;
mod uploads;

pub use api::{description, router};
pub use assets::LICENCES_OF_PAGE;
pub use engine::{
    Branch, CaseValues, Damage, Engine, Example, ExampleFile, Finished, JobText, Output, Pictured, ReadFile,
    StressLine, StressSurface, StressVolume, Surface,
};
pub use refusal::{Refusal, RefusalKind};
pub use serve::serve;
pub use studio::{Options, Studio};
