//! `grainpath schema`: prints all settings as a JSON Schema or as a reference page.

use grainpath_job::{json_schema, markdown};

use crate::args::Schema;
use crate::{Failure, files};

/// `grainpath schema`
pub(crate) fn schema(args: &Schema) -> Result<(), Failure> {
    if args.markdown {
        files::print(&markdown());
    } else {
        files::print(&format!("{:#}\n", json_schema()));
    }
    Ok(())
}
