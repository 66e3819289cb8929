//! Raster angles, for all layers or per range of layers.
//!
//! ```
//! use grainpath_job::parse_job;
//!
//! let job = "[fill]\nangles_deg = { layers = { \"1-10\" = [0], \"11-\" = [45, -45] } }\n";
//! let settings = parse_job(job, "job.toml", &[], &|_| Err("no profiles of its own".into())).unwrap();
//! let ranges = settings.fill.angles_deg.ranges();
//! assert_eq!((ranges[1].first_layer, ranges[1].angles_deg.as_slice()), (11, [45.0, -45.0].as_slice()));
//! ```

use serde_json::json;
use toml::Value;

use super::value::{Problem, SettingValue, Step, ValueError};

/// Raster angles from one layer up to the next range.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleRange {
    /// First layer, counted from 1.
    pub first_layer: usize,
    /// Angles, used in turn from this layer on, degrees from +X.
    pub angles_deg: Vec<f64>,
}

/// Raster angles of every layer: ranges without gap or overlap, from the first layer upwards.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerAngles(Vec<AngleRange>);

/// The allowed forms of a list of angles, for error messages.
const EXPECTED: &str = "a list of angles, or { layers = { \"1-10\" = [0], \"11-\" = [45, -45] } }";
/// The allowed names of a range, for error messages.
const RANGE: &str = "layers as \"1-10\", \"5\" or \"11-\"";

impl LayerAngles {
    /// The same angles, in turn, for all layers.
    pub fn all(angles_deg: Vec<f64>) -> Self {
        Self(vec![AngleRange { first_layer: 1, angles_deg }])
    }

    /// The ranges from the first layer upwards. Each ends where the next one begins; the last one has no end.
    pub fn ranges(&self) -> &[AngleRange] {
        &self.0
    }
}

/// First and last layer of a range such as `"1-10"`; the last one is `None` for `"11-"`.
fn range(text: &str) -> Option<(usize, Option<usize>)> {
    let whole = |part: &str| part.trim().parse::<usize>().ok().filter(|&n| n > 0);
    let (first, last) = match text.split_once('-') {
        None => (whole(text)?, Some(whole(text)?)),
        Some((first, last)) if last.trim().is_empty() => (whole(first)?, None),
        Some((first, last)) => (whole(first)?, Some(whole(last)?)),
    };
    last.is_none_or(|last| last >= first).then_some((first, last))
}

fn read_ranges(layers: &toml::Table) -> Result<Vec<AngleRange>, ValueError> {
    let mut all = Vec::with_capacity(layers.len());
    for (name, angles) in layers {
        let wrong = || Problem::Kind { expected: RANGE, found: format!("{name:?}") };
        let (first, last) = range(name).ok_or_else(wrong)?;
        let angles_deg = Vec::<f64>::from_toml(angles).map_err(|e| e.in_key(name))?;
        all.push((first, last, angles_deg));
    }
    all.sort_by_key(|r| (r.0, r.1));
    let problem = |layers: String| Err(Problem::LayerAngles { layers }.into());
    let mut next = Some(1);
    for &(first, last, _) in &all {
        match next {
            Some(next) if first == next => {}
            Some(next) if first > next => return problem(format!("none for layers {next} to {}", first - 1)),
            Some(_) | None => return problem(format!("two for layer {first}")),
        }
        next = last.map(|last| last + 1);
    }
    if let Some(next) = next {
        return problem(format!("none for layers from {next} on, as \"{next}-\" would give them"));
    }
    Ok(all.into_iter().map(|(first_layer, _, angles_deg)| AngleRange { first_layer, angles_deg }).collect())
}

impl SettingValue for LayerAngles {
    const KIND: &'static str = "array|object";

    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        match value {
            Value::Array(_) => Vec::<f64>::from_toml(value).map(Self::all),
            Value::Table(table) => {
                let layers = table.get("layers").filter(|_| table.len() == 1).and_then(Value::as_table);
                let wrong = || Problem::Kind { expected: EXPECTED, found: value.to_string() };
                let read = read_ranges(layers.ok_or_else(wrong)?);
                read.map(Self).map_err(|e| e.inside(Step::Key("layers".into())))
            }
            Value::String(_)
            | Value::Integer(_)
            | Value::Float(_)
            | Value::Boolean(_)
            | Value::Datetime(_) => {
                Err(Problem::Kind { expected: EXPECTED, found: value.to_string() }.into())
            }
        }
    }

    fn to_text(&self) -> String {
        if let [all] = self.0.as_slice() {
            return all.angles_deg.to_text();
        }
        let last = |i: usize| self.0.get(i + 1).map(|r| (r.first_layer - 1).to_string()).unwrap_or_default();
        let row = |(i, r): (usize, &AngleRange)| {
            format!("\"{}-{}\" = {}", r.first_layer, last(i), r.angles_deg.to_text())
        };
        let rows: Vec<String> = self.0.iter().enumerate().map(row).collect();
        format!("{{ layers = {{ {} }} }}", rows.join(", "))
    }

    fn numbers(&self) -> Vec<f64> {
        self.0.iter().flat_map(|r| r.angles_deg.iter().copied()).collect()
    }

    fn schema() -> serde_json::Value {
        let angles = Vec::<f64>::schema();
        json!({
            "type": ["array", "object"],
            "items": f64::schema(),
            "additionalProperties": false,
            "properties": { "layers": {
                "type": "object",
                "additionalProperties": false,
                "patternProperties": { "^ *[0-9]+ *(- *[0-9]* *)?$": angles },
            } },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<LayerAngles, String> {
        let table: toml::Table = format!("v = {text}").parse().expect("TOML");
        LayerAngles::from_toml(&table["v"]).map_err(|e| format!("angles_deg{e}"))
    }

    #[test]
    fn ranges_are_read_in_any_order_and_printed_in_their_own() {
        for (text, printed) in [
            ("[0, 90]", "[0, 90]"),
            ("{ layers = { \"1-\" = [30] } }", "[30]"),
            (
                "{ layers = { \"11-\" = [45, -45], \"1-9\" = [0], \"10\" = [90] } }",
                "{ layers = { \"1-9\" = [0], \"10-10\" = [90], \"11-\" = [45, -45] } }",
            ),
        ] {
            let angles = read(text).expect(text);
            assert_eq!(angles.to_text(), printed);
            assert_eq!(read(printed).expect("printed as it is read"), angles);
        }
    }

    #[test]
    fn layers_with_no_angles_or_two_are_named() {
        for (text, expect) in [
            ("{ layers = { \"2-\" = [0] } }", "none for layers 1 to 1"),
            ("{ layers = { \"1-10\" = [0] } }", "none for layers from 11 on, as \"11-\" would give them"),
            ("{ layers = { \"1-10\" = [0], \"10-\" = [1] } }", "two for layer 10"),
            ("{ layers = { \"1-\" = [0], \"10-20\" = [1] } }", "two for layer 10"),
            ("{ layers = { \"10-1\" = [0] } }", RANGE),
            ("{ layers = { \"0-\" = [0] } }", RANGE),
            ("{ layers = { } }", "none for layers from 1 on"),
            ("{ layers = { \"1-\" = [0, \"a\"] } }", "angles_deg.layers.1-[2] should be a number"),
            ("{ 1 = [0] }", EXPECTED),
            ("45", EXPECTED),
        ] {
            let found = read(text).expect_err(text);
            assert!(found.contains(expect), "{found}\nshould hold\n{expect}");
        }
    }
}
