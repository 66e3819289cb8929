//! The first stage of a run that reads a setting, for programs that plan one part again and again.
//!
//! The studio keeps the stress of its last run. The two lists below name the settings that need it anew; every other setting
//! is read by later stages alone. The table of `docs/studio.md` and `x-first-stage` in the JSON Schema are made from them. The
//! test `crates/grainpath/tests/known_stress.rs` changes every setting and counts how often the solver runs.

use std::fmt::Write;

use super::settings::Settings;
use super::value::Param;

/// The first stage that runs again where a setting has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FirstStage {
    /// The part and its sections are made anew, and with them the stress and the paths.
    Shape,
    /// The part stays, and its stress is solved or read anew.
    Stress,
    /// Part and stress stay. Paths are planned anew, with all that is measured on them.
    Paths,
}

/// Settings that change the part or its sections: whole sections, or single keys.
const OF_SHAPE: [&str; 4] = ["shape", "shape.photo", "shape.ct", "process.simplify_mm"];

/// Settings that a section above holds although they leave the part as it is: paths have the coordinates of its file, and
/// only the written G-code those of the bed.
const NOT_OF_SHAPE: [&str; 1] = ["shape.position_mm"];

/// What the solvers read: the model, its material, supports and loads, or the result that replaces them.
const OF_STRESS: [&str; 21] = [
    "guide.analysis",
    "guide.element_mm",
    "guide.elasticity",
    "guide.elasticity_deg",
    // Supports and loads, and the coordinates in which they are given.
    "guide.frame",
    "guide.fixture",
    "guide.load",
    "guide.case",
    "guide.deck",
    "guide.deck_step",
    "guide.deck_material",
    // A result of another program, which is read in place of solving.
    "guide.import",
    "guide.import_array",
    "guide.import_order",
    "guide.import_stress_unit",
    "guide.import_length_unit",
    // A part that did not fit is solved where the limit is raised.
    "guide.memory_mib",
    // The weight of the part is a load.
    "material.density_g_cm3",
    "material.e_mpa",
    "material.nu",
    "material.g_mpa",
];

impl FirstStage {
    /// Every stage, in order.
    pub const ALL: [Self; 3] = [Self::Shape, Self::Stress, Self::Paths];

    /// Its name in the JSON Schema, where the key of a setting is `x-first-stage`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::Stress => "stress",
            Self::Paths => "paths",
        }
    }

    /// What runs again, in words.
    const fn again(self) -> &'static str {
        match self {
            Self::Shape => "the shape, then its stress and its paths",
            Self::Stress => "the stress, then the paths",
            Self::Paths => "the paths; the stress is kept",
        }
    }
}

impl Param {
    /// The first stage that runs again where this setting has changed.
    ///
    /// ```
    /// use grainpath_job::{FirstStage, Settings};
    ///
    /// let of = |section: &str, key: &str| {
    ///     let rows = Settings::params();
    ///     rows.iter().find(|p| p.section == section && p.key == key).unwrap().first_stage()
    /// };
    /// assert_eq!(of("shape", "scale"), FirstStage::Shape);
    /// assert_eq!(of("guide", "element_mm"), FirstStage::Stress);
    /// assert_eq!(of("process", "top_speed_mm_s"), FirstStage::Paths);
    /// ```
    pub fn first_stage(&self) -> FirstStage {
        let name = format!("{}.{}", self.section, self.key);
        let is_in = |list: &[&str]| list.contains(&name.as_str()) || list.contains(&self.section);
        // A setting that both the shape and the solver read belongs to the earlier stage, after which all others run.
        if is_in(&OF_SHAPE) && !is_in(&NOT_OF_SHAPE) {
            FirstStage::Shape
        } else if is_in(&OF_STRESS) {
            FirstStage::Stress
        } else {
            FirstStage::Paths
        }
    }
}

/// The table of `docs/studio.md`: what runs again where a setting has changed.
pub fn first_stages_markdown() -> String {
    let mut out = String::from("| changed | what runs again |\n|---|---|\n");
    let rows = Settings::params();
    for stage in FirstStage::ALL {
        let mut parts = Vec::new();
        for section in Settings::SECTIONS {
            let (own, others): (Vec<_>, Vec<_>) =
                rows.iter().filter(|p| p.section == section).partition(|p| p.first_stage() == stage);
            let keys =
                |rows: &[&Param]| rows.iter().map(|p| format!("`{}`", p.key)).collect::<Vec<_>>().join(", ");
            // The shorter list is written: the settings of the stage, or the one of the section that is not among them.
            match (own.len(), others.len()) {
                (0, _) => {}
                (_, 0) => parts.push(format!("[{section}]")),
                (n, m) if n <= m => parts.push(format!("{} of [{section}]", keys(&own))),
                (_, 1) => parts.push(format!("[{section}] without {}", keys(&others))),
                // The others stand in the rows above.
                _ => parts.push(format!("the rest of [{section}]")),
            }
        }
        let _ = writeln!(out, "| {} | {} |", parts.join("; "), stage.again());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_a_setting_or_a_section() {
        let rows = Settings::params();
        for name in OF_SHAPE.iter().chain(&NOT_OF_SHAPE).chain(&OF_STRESS) {
            let is_row = rows.iter().any(|p| format!("{}.{}", p.section, p.key) == *name);
            assert!(is_row || Settings::SECTIONS.contains(name), "{name}");
        }
    }

    /// `UPDATE_TABLES=1 cargo test --profile ci -p grainpath-job table` writes it.
    #[test]
    fn the_table_of_the_page_is_what_the_rows_say() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/studio.md");
        let page = std::fs::read_to_string(path).expect("the page");
        let (begin, end) = ("<!-- first stages -->\n", "<!-- end of first stages -->");
        let (before, rest) = page.split_once(begin).expect("the table begins");
        let (_, after) = rest.split_once(end).expect("the table ends");
        let made = format!("{before}{begin}\n{}\n{end}{after}", first_stages_markdown());
        if std::env::var_os("UPDATE_TABLES").is_some() {
            std::fs::write(path, &made).expect("the page is written");
        } else {
            assert!(
                made == page,
                "docs/studio.md is out of date: UPDATE_TABLES=1 cargo test -p grainpath-job table"
            );
        }
    }
}
