//! Number of walls: the same everywhere, or more where the stress is high.
//!
//! ```
//! use grainpath_job::parse_job;
//!
//! let job = "guide.kind = \"stress\"\n[process]\nwalls = { min = 2, max = 6, by = \"stress\" }\n";
//! let settings = parse_job(job, "job.toml", &[], &|_| Err("no profiles of its own".into())).unwrap();
//! assert_eq!((settings.process.walls.least(), settings.process.walls.most()), (2, 6));
//! ```

use serde_json::json;
use toml::Value;

use super::choices::{Choice, DensityBy};
use super::loads::{Reader, needed, table_schema};
use super::value::{Problem, SettingValue, ValueError};

/// The greatest number of walls that is accepted. Source: derived. A thousand walls on each side fill a part 0.8 m thick.
const MOST: usize = 1000;

/// Number of walls, as the user sets it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WallCount {
    /// The same everywhere.
    Even(usize),
    /// From `min` to `max` walls, more where the stress is higher.
    ByStress {
        /// The least number, which is laid everywhere.
        min: usize,
        /// The number where the stress is highest.
        max: usize,
    },
}

impl WallCount {
    /// The number that is laid everywhere.
    pub fn least(self) -> usize {
        match self {
            Self::Even(n) => n,
            Self::ByStress { min, .. } => min,
        }
    }

    /// The greatest number.
    pub fn most(self) -> usize {
        match self {
            Self::Even(n) => n,
            Self::ByStress { max, .. } => max,
        }
    }
}

/// The accepted forms of a number of walls, as error messages list them.
const EXPECTED: &str = "a whole number from 0, or { min = 2, max = 6, by = \"stress\" }";

impl SettingValue for WallCount {
    const KIND: &'static str = "integer|object";

    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        if value.is_integer() || value.is_float() {
            return usize::from_toml(value).map(Self::Even);
        }
        let t = Reader::new(value, EXPECTED, &["min", "max", "by"])?;
        let count = |key: &'static str| needed(t.get::<usize>(key, (0.0, MOST as f64))?, key);
        let (min, max) = (count("min")?, count("max")?);
        if min > max {
            let found = format!("min = {min} above max = {max}");
            return Err(Problem::Kind { expected: "min up to max", found }.into());
        }
        let by: DensityBy = needed(t.get("by", (0.0, 0.0))?, "by = \"stress\"")?;
        match by {
            DensityBy::Stress => Ok(Self::ByStress { min, max }),
            DensityBy::File => {
                Err(Problem::Kind { expected: "by = \"stress\"", found: by.name().into() }.into())
            }
        }
    }

    fn to_text(&self) -> String {
        match self {
            Self::Even(n) => n.to_text(),
            Self::ByStress { min, max } => format!("{{ min = {min}, max = {max}, by = \"stress\" }}"),
        }
    }

    fn numbers(&self) -> Vec<f64> {
        [self.least(), self.most()].map(|n| n as f64).to_vec()
    }

    fn schema() -> serde_json::Value {
        let count = json!({ "type": "integer", "minimum": 0, "maximum": MOST });
        let keys = json!({ "min": count, "max": count, "by": { "enum": ["stress"] } });
        let mut schema = table_schema(&keys, &["min", "max", "by"]);
        schema["type"] = json!(["integer", "object"]);
        schema
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<WallCount, String> {
        let table: toml::Table = format!("v = {text}").parse().expect("TOML");
        WallCount::from_toml(&table["v"]).map_err(|e| format!("process.walls{e}"))
    }

    #[test]
    fn a_number_stays_a_number_and_mistakes_are_said_in_one_line() {
        assert_eq!(read("3"), Ok(WallCount::Even(3)));
        let text = "{ min = 2, max = 6, by = \"stress\" }";
        assert_eq!(read(text).map(|w| w.to_text()), Ok(text.into()));
        let wrong = [
            (
                "{ min = 6, max = 2, by = \"stress\" }",
                "process.walls should be min up to max, is min = 6 above max = 2",
            ),
            ("{ min = 2, max = 6 }", "process.walls needs by = \"stress\""),
            ("{ min = 2, max = 6, by = \"file\" }", "process.walls should be by = \"stress\", is file"),
            ("{ max = 6, by = \"stress\" }", "process.walls needs min"),
            ("{ min = 2, most = 6 }", "process.walls has an unknown key `most`; its keys are min, max, by"),
            ("{ min = 2, maxi = 6 }", "process.walls has an unknown key `maxi`; did you mean `max`?"),
        ];
        for (text, message) in wrong {
            assert_eq!(read(text), Err(message.to_owned()), "{text}");
        }
    }
}
