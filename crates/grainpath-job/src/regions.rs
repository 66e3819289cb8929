//! Regions of the part with settings of their own: the tables `[[region]]` of a job, as typed.
//!
//! A region states where it lies and the few settings that differ there. `Settings::in_region` returns the complete
//! settings that apply in the region, so every check and every stage that takes settings works for a region too. The
//! planner finds the area of each layer that a region covers.
//!
//! ```
//! use grainpath_job::parse_job;
//!
//! let job = "[[region]]\non = { layers = [[1, 10]] }\nfill = { density = 0.6 }\nprocess = { walls = 4 }\n";
//! let settings = parse_job(job, "job.toml", &[], &|_| Err("no profiles of its own".into())).unwrap();
//! let inside = settings.in_region(&settings.regions[0]);
//! assert_eq!((inside.process.walls.least(), inside.fill.density.even().unwrap().fraction()), (4, 0.6));
//! assert_eq!(inside.fill.pattern, settings.fill.pattern);
//! ```

use grainpath_core::faces::FaceName;
use grainpath_core::{DVec3, Density};
use serde_json::json;
use toml::Value;

use crate::choices::Pattern;
use crate::layer_angles::LayerAngles;
use crate::loads::{MAX_NUMBER, Reader, needed, read_corners, read_face, table_schema, vector_text};
use crate::value::{Problem, SettingValue, Step, ValueError};

/// Where a region lies, in coordinates of the part after scaling and rotation, mm, with the plate at z = 0.
#[derive(Debug, Clone, PartialEq)]
pub enum RegionPlace {
    /// A box.
    Box {
        /// Its lowest corner.
        low: DVec3,
        /// Its highest corner.
        high: DVec3,
    },
    /// Whole layers: first and last of each range, counted from 1.
    Layers(Vec<[usize; 2]>),
    /// The inside of a mesh, given by the path of its file; its coordinates are those of the part's file.
    Mesh(String),
    /// The material within a given depth below a face of the part.
    Face {
        /// The name that `grainpath inspect --faces` gives it.
        face: FaceName,
        /// The depth, mm.
        depth_mm: f64,
    },
}

/// A region of the part and the settings that differ there; with `None` the job's own setting applies.
#[derive(Debug, Clone, PartialEq)]
pub struct JobRegion {
    /// Where it lies.
    pub on: RegionPlace,
    /// Infill pattern.
    pub pattern: Option<Pattern>,
    /// Density of infill.
    pub density: Option<Density>,
    /// Raster angles.
    pub angles_deg: Option<LayerAngles>,
    /// Beads in a line of sparse infill.
    pub lines: Option<usize>,
    /// Number of walls.
    pub walls: Option<usize>,
    /// Number of dense layers below top surfaces.
    pub top_layers: Option<usize>,
    /// Number of dense layers above bottom surfaces.
    pub bottom_layers: Option<usize>,
    /// Whether infill follows the job's guide.
    pub guide: bool,
}

/// The keys that give a place, for messages.
const PLACES: &str = "box_mm, layers, mesh, face";

fn read_place(value: &Value) -> Result<RegionPlace, ValueError> {
    let t = Reader::new(value, "a table in { }", &["box_mm", "layers", "mesh", "face", "depth_mm"])?;
    let depth_mm = t.get::<f64>("depth_mm", (1e-3, MAX_NUMBER))?;
    let mut given = t.0.iter().filter(|(key, _)| key.as_str() != "depth_mm");
    // Exactly one place is allowed: with two it would be unclear whether the region is their union or their intersection.
    let (Some((kind, value)), None) = (given.next(), given.next()) else {
        return Err(Problem::SeveralKinds { keys: PLACES }.into());
    };
    let read = match (kind.as_str(), depth_mm) {
        ("face", Some(depth_mm)) => read_face(value).map(|face| RegionPlace::Face { face, depth_mm }),
        ("face", None) => return Err(Problem::Missing { expected: "depth_mm beside face" }.into()),
        (_, Some(_)) => return Err(Problem::Missing { expected: "face beside depth_mm" }.into()),
        ("box_mm", None) => read_corners(value).and_then(|[low, high]| match low.cmplt(high).all() {
            true => Ok(RegionPlace::Box { low, high }),
            false => {
                let expected = "two corners of a box with a volume, which differ in x, y and z";
                Err(Problem::Kind { expected, found: value.to_string() }.into())
            }
        }),
        ("layers", None) => read_layers(value).map(RegionPlace::Layers),
        (_, None) => String::from_toml(value).map(RegionPlace::Mesh),
    };
    read.map_err(|e| e.in_key(kind))
}

fn read_layers(value: &Value) -> Result<Vec<[usize; 2]>, ValueError> {
    let layers = Vec::<[usize; 2]>::from_toml(value)?;
    let wrong = layers.iter().position(|&[first, last]| first == 0 || last < first);
    if let Some(k) = wrong {
        let found = layers[k].to_text();
        let problem = Problem::Kind { expected: "[first, last] counted from 1", found };
        return Err(ValueError::from(problem).inside(Step::Index(k)));
    }
    Ok(layers)
}

impl SettingValue for JobRegion {
    const KIND: &'static str = "object";

    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        let t = Reader::new(value, "a table: on = ..., fill = { ... }", &["on", "fill", "process", "guide"])?;
        let on = needed(t.0.get("on"), "on = { box_mm, layers, mesh, or face and depth_mm }")?;
        let inner = |key: &'static str, known: &[&str]| {
            let empty = Value::Table(toml::Table::new());
            let table = t.0.get(key).cloned().unwrap_or(empty);
            Reader::new(&table, "a table in { }", known).map(|r| r.0.clone()).map_err(|e| e.in_key(key))
        };
        let fill = inner("fill", &["pattern", "density", "angles_deg", "lines"])?;
        let process = inner("process", &["walls", "top_layers", "bottom_layers"])?;
        let (fill, process) = (Reader(&fill), Reader(&process));
        let in_fill = |e: ValueError| e.in_key("fill");
        let in_process = |e: ValueError| e.in_key("process");
        // The same ranges as those of the rows of [fill] and [process].
        let region = Self {
            on: read_place(on).map_err(|e| e.in_key("on"))?,
            pattern: fill.get("pattern", (0.0, 0.0)).map_err(in_fill)?,
            density: fill.get("density", (0.0, 1.0)).map_err(in_fill)?,
            angles_deg: fill.get("angles_deg", (-3600.0, 3600.0)).map_err(in_fill)?,
            lines: fill.get("lines", (1.0, 8.0)).map_err(in_fill)?,
            walls: process.get("walls", (0.0, 1000.0)).map_err(in_process)?,
            top_layers: process.get("top_layers", (0.0, 10000.0)).map_err(in_process)?,
            bottom_layers: process.get("bottom_layers", (0.0, 10000.0)).map_err(in_process)?,
            guide: t.get("guide", (0.0, 0.0))?.unwrap_or(true),
        };
        if region.guide && fill.0.is_empty() && process.0.is_empty() {
            let expected = "a setting of its own: fill = { ... }, process = { ... } or guide = false";
            return Err(Problem::Missing { expected }.into());
        }
        Ok(region)
    }

    fn to_text(&self) -> String {
        let on = match &self.on {
            RegionPlace::Box { low, high } => {
                format!("box_mm = [{}, {}]", vector_text(*low), vector_text(*high))
            }
            RegionPlace::Layers(layers) => format!("layers = {}", layers.to_text()),
            RegionPlace::Mesh(path) => format!("mesh = {}", path.to_text()),
            RegionPlace::Face { face, depth_mm } => format!("face = \"{face}\", depth_mm = {depth_mm}"),
        };
        let table = |key: &str, rows: &[(&str, String)]| {
            let given: Vec<String> = rows
                .iter()
                .filter(|r| !r.1.is_empty())
                .map(|(key, value)| format!("{key} = {value}"))
                .collect();
            if given.is_empty() { String::new() } else { format!(", {key} = {{ {} }}", given.join(", ")) }
        };
        let fill = table(
            "fill",
            &[
                ("pattern", self.pattern.to_text()),
                ("density", self.density.to_text()),
                ("angles_deg", self.angles_deg.to_text()),
                ("lines", self.lines.to_text()),
            ],
        );
        let process = table(
            "process",
            &[
                ("walls", self.walls.to_text()),
                ("top_layers", self.top_layers.to_text()),
                ("bottom_layers", self.bottom_layers.to_text()),
            ],
        );
        let guide = if self.guide { "" } else { ", guide = false" };
        format!("{{ on = {{ {on} }}{fill}{process}{guide} }}")
    }

    fn schema() -> serde_json::Value {
        let count = |low: usize, high: usize| json!({ "type": "integer", "minimum": low, "maximum": high });
        let words: Vec<&str> = Pattern::WORDS.iter().map(|w| w.name).collect();
        let one_of = ["box_mm", "layers", "mesh", "face"].map(|key| json!({ "required": [key] }));
        let on = json!({
            "type": "object",
            "additionalProperties": false,
            "oneOf": one_of,
            "properties": {
                "box_mm": <[[f64; 3]; 2]>::schema(),
                "layers": Vec::<[usize; 2]>::schema(),
                "mesh": String::schema(),
                "face": { "type": "string", "pattern": "^f:[0-9a-fA-F]{4,15}$" },
                "depth_mm": f64::schema(),
            },
        });
        let fill = json!({
            "pattern": { "enum": words },
            "density": { "type": "number", "minimum": 0, "maximum": 1 },
            "angles_deg": LayerAngles::schema(),
            "lines": count(1, 8),
        });
        let process = json!({
            "walls": count(0, 1000),
            "top_layers": count(0, 10000),
            "bottom_layers": count(0, 10000),
        });
        let keys = json!({
            "on": on,
            "fill": table_schema(&fill, &[]),
            "process": table_schema(&process, &[]),
            "guide": bool::schema(),
        });
        table_schema(&keys, &["on"])
    }
}
