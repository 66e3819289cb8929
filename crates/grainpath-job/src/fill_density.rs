//! Density of infill: one number, or a range in which it is graded.
//!
//! ```
//! use grainpath_job::choices::DensityBy;
//! use grainpath_job::parse_job;
//!
//! let job = "guide.kind = \"stress\"\n[fill]\npattern = \"grid\"\ndensity = { min = 0.1, max = 1, by = \"stress\" }\n";
//! let settings = parse_job(job, "job.toml", &[], &|_| Err("no profiles of its own".into())).unwrap();
//! let graded = settings.fill.density.graded().unwrap();
//! assert_eq!((graded.min, graded.max, graded.by), (0.1, 1.0, DensityBy::Stress));
//! ```

use grainpath_core::Density;
use serde_json::json;
use toml::Value;

use super::choices::{Choice, DensityBy};
use super::loads::{Reader, needed, table_schema};
use super::value::{Problem, SettingValue, ValueError};

/// The least density that infill is graded down to. Source: derived. At this density single lines of 0.45 mm are about 20 mm
/// apart, which is more than a skin can bridge.
pub const LEAST_GRADED: f64 = 0.02;

/// Density of infill, as typed.
#[derive(Debug, Clone, PartialEq)]
pub enum FillDensity {
    /// The same everywhere.
    Even(Density),
    /// The density varies from place to place.
    Graded(GradedDensity),
}

/// A density that follows the stress or a file.
#[derive(Debug, Clone, PartialEq)]
pub struct GradedDensity {
    /// The least density.
    pub min: f64,
    /// The greatest density.
    pub max: f64,
    /// The quantity that the density follows.
    pub by: DensityBy,
    /// File of densities, for [`DensityBy::File`]; empty otherwise.
    pub file: String,
    /// Name of the array or column in the file. Empty: the only one, or the one called density.
    pub array: String,
}

impl From<Density> for FillDensity {
    fn from(density: Density) -> Self {
        Self::Even(density)
    }
}

impl FillDensity {
    /// The density if it is the same everywhere; otherwise `None`.
    pub fn even(&self) -> Option<Density> {
        match self {
            Self::Even(density) => Some(*density),
            Self::Graded(_) => None,
        }
    }

    /// The grading, if the density is graded; otherwise `None`.
    pub fn graded(&self) -> Option<&GradedDensity> {
        match self {
            Self::Even(_) => None,
            Self::Graded(graded) => Some(graded),
        }
    }

    /// The file that the density follows, and the name of the array or column in it, if one is given.
    pub fn file(&self) -> Option<(&str, Option<&str>)> {
        let graded = self.graded().filter(|g| g.by == DensityBy::File)?;
        Some((&graded.file, Some(graded.array.as_str()).filter(|name| !name.is_empty())))
    }

    /// Whether beads lie side by side everywhere.
    pub fn is_dense(&self) -> bool {
        self.even().is_some_and(Density::is_dense)
    }
}

/// The allowed forms of a density, for error messages.
const EXPECTED: &str = "a number, or { min = 0.1, max = 1.0, by = \"stress\" }";

impl SettingValue for FillDensity {
    const KIND: &'static str = "number|object";

    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        if value.is_integer() || value.is_float() {
            return Density::from_toml(value).map(Self::Even);
        }
        let t = Reader::new(value, EXPECTED, &["min", "max", "by", "file", "array"])?;
        let share = |key: &'static str| needed(t.get::<f64>(key, (LEAST_GRADED, 1.0))?, key);
        let (min, max) = (share("min")?, share("max")?);
        if min > max {
            let found = format!("min = {min} above max = {max}");
            return Err(Problem::Kind { expected: "min up to max", found }.into());
        }
        let by: DensityBy = needed(t.get("by", (0.0, 0.0))?, "by = \"stress\" or \"file\"")?;
        let text = |key: &str| t.get::<String>(key, (0.0, 0.0)).map(Option::unwrap_or_default);
        let (file, array) = (text("file")?, text("array")?);
        match (by, file.is_empty()) {
            (DensityBy::File, true) => {
                return Err(Problem::Missing { expected: "file = \"FILE\" with by = \"file\"" }.into());
            }
            (DensityBy::Stress, false) => {
                return Err(Problem::Missing { expected: "by = \"file\" beside file" }.into());
            }
            (DensityBy::File, false) | (DensityBy::Stress, true) => {}
        }
        Ok(Self::Graded(GradedDensity { min, max, by, file, array }))
    }

    fn to_text(&self) -> String {
        match self {
            Self::Even(density) => density.to_text(),
            Self::Graded(g) => {
                let mut text = format!("{{ min = {}, max = {}, by = \"{}\"", g.min, g.max, g.by.name());
                for (key, value) in [("file", &g.file), ("array", &g.array)] {
                    if !value.is_empty() {
                        text += &format!(", {key} = {}", value.to_text());
                    }
                }
                text + " }"
            }
        }
    }

    fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Even(density) => density.numbers(),
            Self::Graded(g) => vec![g.min, g.max],
        }
    }

    fn schema() -> serde_json::Value {
        let words: Vec<&str> = <DensityBy as Choice>::WORDS.iter().map(|w| w.name).collect();
        let share = json!({ "type": "number", "minimum": LEAST_GRADED, "maximum": 1 });
        let keys = json!({
            "min": share, "max": share, "by": { "enum": words }, "file": String::schema(), "array": String::schema(),
        });
        let mut schema = table_schema(&keys, &["min", "max", "by"]);
        schema["type"] = json!(["number", "object"]);
        schema
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<FillDensity, String> {
        let table: toml::Table = format!("v = {text}").parse().expect("TOML");
        FillDensity::from_toml(&table["v"]).map_err(|e| format!("fill.density{e}"))
    }

    #[test]
    fn a_number_stays_a_number_and_a_table_is_graded() {
        assert_eq!(read("0.4"), Ok(FillDensity::Even(Density::Sparse(0.4))));
        assert_eq!(read("1").map(|d| d.to_text()), Ok("1".into()));
        for text in [
            "{ min = 0.1, max = 1, by = \"stress\" }",
            "{ min = 0.2, max = 0.2, by = \"file\", file = \"rho.vtu\", array = \"rho\" }",
        ] {
            let density = read(text).expect("a density");
            assert_eq!(density.to_text(), text);
            assert!(density.graded().is_some() && !density.is_dense());
        }
    }

    #[test]
    fn what_is_wrong_is_said_in_one_line() {
        let wrong = [
            (
                "\"much\"",
                "fill.density should be a number, or { min = 0.1, max = 1.0, by = \"stress\" }, is \"much\"",
            ),
            ("30", "fill.density should be from 0 to 1, is 30"),
            (
                "{ min = 0.5, max = 0.2, by = \"stress\" }",
                "fill.density should be min up to max, is min = 0.5 above max = 0.2",
            ),
            ("{ min = 0, max = 1, by = \"stress\" }", "fill.density.min should be from 0.02 to 1, is 0"),
            ("{ min = 0.1, max = 2, by = \"stress\" }", "fill.density.max should be from 0.02 to 1, is 2"),
            ("{ max = 1, by = \"stress\" }", "fill.density needs min"),
            ("{ min = 0.1, max = 1 }", "fill.density needs by = \"stress\" or \"file\""),
            (
                "{ min = 0.1, max = 1, by = \"size\" }",
                "fill.density.by should be one of stress, file, is \"size\"",
            ),
            (
                "{ min = 0.1, max = 1, by = \"file\" }",
                "fill.density needs file = \"FILE\" with by = \"file\"",
            ),
            (
                "{ min = 0.1, max = 1, by = \"stress\", file = \"a.csv\" }",
                "fill.density needs by = \"file\" beside file",
            ),
            ("{ min = 0.1, mx = 1 }", "fill.density has an unknown key `mx`; did you mean `max`?"),
        ];
        for (text, message) in wrong {
            assert_eq!(read(text), Err(message.to_owned()), "{text}");
        }
    }
}
