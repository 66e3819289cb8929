//! `grainpath licences`: the notices that licences require to be passed on with the program.

use crate::args::Licences;
use crate::{Failure, files};

/// Made by `cargo xtask licences` from the manifests and licence files of the libraries; `cargo xtask test` compares.
const NOTICES: &str = include_str!("../../licences.txt");

/// `grainpath licences`
pub(crate) fn licences(Licences {}: &Licences) -> Result<(), Failure> {
    files::print(NOTICES);
    #[cfg(feature = "studio")]
    files::print(&format!("\n{}", grainpath_studio::LICENCES_OF_PAGE));
    Ok(())
}
