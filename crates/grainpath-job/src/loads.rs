//! Fixtures, loads and load cases: the tables of `[guide]`, as typed.
//!
//! Coordinates are those of the part after scaling and rotation, mm, with the plate at z = 0. Which surface or nodes a
//! place selects is for the planner to find out.
//!
//! ```
//! use grainpath_job::loads::{Push, Place};
//! use grainpath_job::parse_job;
//!
//! let job = "[[guide.load]]\non = { facets = [3, 4] }\nforce_n = [0, 0, -25]\n";
//! let settings = parse_job(job, "job.toml", &[], &|_| Err("no profiles of its own".into())).unwrap();
//! let load = &settings.guide.load[0];
//! assert_eq!(load.on, Some(Place::Facets(vec![3, 4])));
//! assert!(matches!(load.push, Push::Force(f) if f.z == -25.0));
//! ```

use std::fmt::Write as _;

use grainpath_core::DVec3;
use grainpath_core::selection::Selection;
use grainpath_core::spelling::nearest;
use serde_json::json;
use toml::{Table, Value};

use super::value::{Problem, SettingValue, ValueError};

/// Place where a fixture or load acts, as typed.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// The part of the surface in a box, on a plane or on a cylinder, or within a sphere.
    Shape(Selection),
    /// Triangles of the mesh, by their index in the file, from 0.
    Facets(Vec<usize>),
}

/// A place whose motion is prescribed.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixture {
    /// The place.
    pub on: Place,
    /// Whether motion along x, y and z is prescribed.
    pub fixed: [bool; 3],
    /// Whether motion along the surface normal is prevented: a roller or a plane of symmetry.
    pub normal: bool,
    /// Prescribed displacement of the fixed directions, mm.
    pub displacement_mm: DVec3,
}

/// Kind and size of a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Push {
    /// Total force in N, spread evenly over the area of the place.
    Force(DVec3),
    /// Pressure in MPa, positive against the surface.
    Pressure(f64),
    /// Moment in N mm about the centroid of the place.
    Moment(DVec3),
    /// Acceleration of the whole part in mm/s2: gravity is `[0, 0, -9810]`.
    Acceleration(DVec3),
}

/// A load.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The place; `None` for an acceleration.
    pub on: Option<Place>,
    /// Kind and size.
    pub push: Push,
}

/// Loads that act at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name in reports.
    pub name: String,
    /// Weight where the directions of several cases are combined.
    pub weight: f64,
    /// Loads of the case.
    pub loads: Vec<Load>,
}

/// Largest number that is accepted. Source: derived. Larger ones are typing errors. Below it, squares and their sums stay
/// far from overflow.
const MAX_NUMBER: f64 = 1e12;

/// The keys that state the kind of a load.
const LOAD_KINDS: &str = "force_n, pressure_mpa, moment_nmm, acceleration_mm_s2";
/// The keys that state a place.
const PLACES: &str = "on = { box_mm, plane, cylinder, sphere or facets }";

/// Reads the entries of a table one by one. Errors name the entry.
struct Reader<'a>(&'a Table);

impl<'a> Reader<'a> {
    /// The table in `value`. Keys that are not in `known` are an error.
    fn new(value: &'a Value, expected: &'static str, known: &[&str]) -> Result<Self, ValueError> {
        let wrong = || Problem::Kind { expected, found: value.to_string() };
        let table = value.as_table().ok_or_else(wrong)?;
        if let Some(key) = table.keys().find(|k| !known.contains(&k.as_str())) {
            // A misspelled key would otherwise be ignored and leave a load out.
            let nearest = nearest(key, known.iter().copied()).to_owned();
            return Err(Problem::UnknownKey { key: key.clone(), nearest }.into());
        }
        Ok(Self(table))
    }

    fn get<T: SettingValue>(&self, key: &str, range: (f64, f64)) -> Result<Option<T>, ValueError> {
        let Some(value) = self.0.get(key) else { return Ok(None) };
        // The range is checked number by number, so that the message can name the number that is outside.
        let read = T::from_toml(value).and_then(|read| {
            match read.numbers().into_iter().find(|n| !(range.0..=range.1).contains(n)) {
                Some(found) => Err(Problem::Range { low: range.0, high: range.1, found }.into()),
                None => Ok(read),
            }
        });
        read.map(Some).map_err(|e| e.in_key(key))
    }

    fn number(&self, key: &str) -> Result<Option<f64>, ValueError> {
        self.get(key, (-MAX_NUMBER, MAX_NUMBER))
    }

    fn length(&self, key: &str) -> Result<Option<f64>, ValueError> {
        self.get(key, (0.0, MAX_NUMBER))
    }

    fn vector(&self, key: &str) -> Result<Option<DVec3>, ValueError> {
        Ok(self.get::<[f64; 3]>(key, (-MAX_NUMBER, MAX_NUMBER))?.map(DVec3::from))
    }

    fn direction(&self, key: &'static str) -> Result<DVec3, ValueError> {
        // Directions are normalised here; later stages may rely on unit vectors.
        let v = needed(self.vector(key)?, key)?;
        v.try_normalize().ok_or_else(|| ValueError::from(Problem::NoDirection).in_key(key))
    }

    /// The place where the fixture or load acts.
    fn place(&self) -> Result<Place, ValueError> {
        place(needed(self.0.get("on"), PLACES)?).map_err(|e| e.in_key("on"))
    }
}

fn needed<T>(found: Option<T>, expected: &'static str) -> Result<T, ValueError> {
    Ok(found.ok_or(Problem::Missing { expected })?)
}

fn place(value: &Value) -> Result<Place, ValueError> {
    let keys = "box_mm, plane, cylinder, sphere, facets";
    let known = ["box_mm", "plane", "cylinder", "sphere", "facets"];
    let Reader(on) = Reader::new(value, "a table in { }", &known)?;
    let mut entries = on.iter();
    // Exactly one kind: two would leave open which of them counts.
    let (Some((kind, value)), None) = (entries.next(), entries.next()) else {
        return Err(Problem::SeveralKinds { keys }.into());
    };
    let read = match kind.as_str() {
        "box_mm" => read_box(value).map(Place::Shape),
        "plane" => read_plane(value).map(Place::Shape),
        "cylinder" => read_cylinder(value).map(Place::Shape),
        "sphere" => read_sphere(value).map(Place::Shape),
        // The list of known keys above leaves only `facets` for this arm.
        _ => Vec::<usize>::from_toml(value).map(Place::Facets),
    };
    read.map_err(|e| e.in_key(kind))
}

fn read_box(value: &Value) -> Result<Selection, ValueError> {
    let [a, b] = <[[f64; 3]; 2]>::from_toml(value)?.map(DVec3::from);
    // Corners may be given in any order.
    Ok(Selection::Box { low: a.min(b), high: a.max(b) })
}

fn read_plane(value: &Value) -> Result<Selection, ValueError> {
    let t = Reader::new(value, "a table in { }", &["point_mm", "normal", "tolerance_mm"])?;
    Ok(Selection::Plane {
        point: needed(t.vector("point_mm")?, "point_mm")?,
        normal: t.direction("normal")?,
        // 0.01 mm accepts the rounding of mesh files and separates parallel faces of any printed part.
        tolerance_mm: t.length("tolerance_mm")?.unwrap_or(0.01),
    })
}

fn read_cylinder(value: &Value) -> Result<Selection, ValueError> {
    let t = Reader::new(value, "a table in { }", &["point_mm", "axis", "radius_mm", "length_mm"])?;
    Ok(Selection::Cylinder {
        point: needed(t.vector("point_mm")?, "point_mm")?,
        axis: t.direction("axis")?,
        radius_mm: needed(t.length("radius_mm")?, "radius_mm")?,
        length_mm: t.length("length_mm")?,
    })
}

fn read_sphere(value: &Value) -> Result<Selection, ValueError> {
    let t = Reader::new(value, "a table in { }", &["centre_mm", "radius_mm"])?;
    Ok(Selection::Sphere {
        centre: needed(t.vector("centre_mm")?, "centre_mm")?,
        radius_mm: needed(t.length("radius_mm")?, "radius_mm")?,
    })
}

fn place_text(place: &Place) -> String {
    let v = |p: &DVec3| vector_text(*p);
    match place {
        Place::Facets(f) => format!("{{ facets = {} }}", f.to_text()),
        Place::Shape(Selection::Box { low, high }) => format!("{{ box_mm = [{}, {}] }}", v(low), v(high)),
        Place::Shape(Selection::Plane { point, normal, tolerance_mm }) => format!(
            "{{ plane = {{ point_mm = {}, normal = {}, tolerance_mm = {tolerance_mm} }} }}",
            v(point),
            v(normal)
        ),
        Place::Shape(Selection::Cylinder { point, axis, radius_mm, length_mm }) => {
            let length = length_mm.map(|l| format!(", length_mm = {l}")).unwrap_or_default();
            format!(
                "{{ cylinder = {{ point_mm = {}, axis = {}, radius_mm = {radius_mm}{length} }} }}",
                v(point),
                v(axis)
            )
        }
        Place::Shape(Selection::Sphere { centre, radius_mm }) => {
            format!("{{ sphere = {{ centre_mm = {}, radius_mm = {radius_mm} }} }}", v(centre))
        }
        // Places of this kind come from other stages and have no spelling in a job file; the text is for
        // reports.
        Place::Shape(Selection::Triangles(t) | Selection::Near { triangles: t, .. }) => {
            format!("{{ {} facets }}", t.len())
        }
    }
}

fn vector_text(v: DVec3) -> String {
    format!("[{}, {}, {}]", v.x, v.y, v.z)
}

/// Schema of a vector.
fn vector_schema() -> serde_json::Value {
    <[f64; 3]>::schema()
}

/// Schema of a table with these keys.
fn table_schema(properties: &serde_json::Value, required: &[&str]) -> serde_json::Value {
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
        "required": required,
    })
}

/// Schema of a place.
fn place_schema() -> serde_json::Value {
    let (vector, number) = (vector_schema(), f64::schema());
    let plane = json!({ "point_mm": vector, "normal": vector, "tolerance_mm": number });
    let cylinder = json!({ "point_mm": vector, "axis": vector, "radius_mm": number, "length_mm": number });
    let sphere = json!({ "centre_mm": vector, "radius_mm": number });
    json!({
        "type": "object",
        "additionalProperties": false,
        "minProperties": 1,
        "maxProperties": 1,
        "properties": {
            "box_mm": <[[f64; 3]; 2]>::schema(),
            "plane": table_schema(&plane, &["point_mm", "normal"]),
            "cylinder": table_schema(&cylinder, &["point_mm", "axis", "radius_mm"]),
            "sphere": table_schema(&sphere, &["centre_mm", "radius_mm"]),
            "facets": Vec::<usize>::schema(),
        },
    })
}

impl SettingValue for Fixture {
    const KIND: &'static str = "object";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        let t = Reader::new(value, "a table: on = ..., fix = \"xyz\"", &["on", "fix", "displacement_mm"])?;
        // Without `fix` a fixture would hold nothing, which is never intended.
        let fix = needed(t.0.get("fix"), "fix = \"xyz\", some of x, y and z, or \"normal\"")?;
        let word = fix.as_str().unwrap_or_default();
        let normal = word == "normal";
        let letters = word.chars().all(|c| "xyz".contains(c)) && !word.is_empty();
        if !normal && !letters {
            let expected = "some of \"xyz\", or \"normal\"";
            let problem = Problem::Kind { expected, found: fix.to_string() };
            return Err(ValueError::from(problem).in_key("fix"));
        }
        let fixed = ['x', 'y', 'z'].map(|c| !normal && word.contains(c));
        let displacement_mm = t.vector("displacement_mm")?.unwrap_or_default();
        Ok(Self { on: t.place()?, fixed, normal, displacement_mm })
    }
    fn to_text(&self) -> String {
        // Letters are printed in the order x, y, z whatever the order in the file, so that equal fixtures
        // print alike.
        let fix: String = if self.normal {
            "normal".into()
        } else {
            ['x', 'y', 'z'].iter().zip(self.fixed).filter(|(_, f)| *f).map(|(c, _)| *c).collect()
        };
        let mut text = format!("{{ on = {}, fix = \"{fix}\"", place_text(&self.on));
        // A displacement of zero is the default and is left out, as a user would.
        if self.displacement_mm != DVec3::ZERO {
            let _ = write!(text, ", displacement_mm = {}", vector_text(self.displacement_mm));
        }
        text + " }"
    }
    fn schema() -> serde_json::Value {
        let fix = json!({ "type": "string", "pattern": "^([xyz]+|normal)$" });
        let keys = json!({ "on": place_schema(), "fix": fix, "displacement_mm": vector_schema() });
        table_schema(&keys, &["on", "fix"])
    }
}

impl SettingValue for Load {
    const KIND: &'static str = "object";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        let known = ["on", "force_n", "pressure_mpa", "moment_nmm", "acceleration_mm_s2"];
        let t = Reader::new(value, "a table: on = ..., force_n = [x, y, z]", &known)?;
        let kinds = [
            t.vector("force_n")?.map(Push::Force),
            t.number("pressure_mpa")?.map(Push::Pressure),
            t.vector("moment_nmm")?.map(Push::Moment),
            t.vector("acceleration_mm_s2")?.map(Push::Acceleration),
        ];
        // Exactly one kind of load in each table, so that every load has one place and one unit.
        let mut given = kinds.into_iter().flatten();
        let push = needed(given.next(), "force_n, pressure_mpa, moment_nmm or acceleration_mm_s2")?;
        if given.next().is_some() {
            return Err(Problem::SeveralKinds { keys: LOAD_KINDS }.into());
        }
        let on = match push {
            // Gravity acts on the whole part; with a place it would mean something else than what is
            // computed.
            Push::Acceleration(_) if !t.0.contains_key("on") => None,
            Push::Acceleration(_) => return Err(Problem::PlaceOfAcceleration.into()),
            Push::Force(_) | Push::Pressure(_) | Push::Moment(_) => Some(t.place()?),
        };
        Ok(Self { on, push })
    }
    fn to_text(&self) -> String {
        let kind = match self.push {
            Push::Force(f) => format!("force_n = {}", vector_text(f)),
            Push::Pressure(p) => format!("pressure_mpa = {p}"),
            Push::Moment(m) => format!("moment_nmm = {}", vector_text(m)),
            Push::Acceleration(a) => format!("acceleration_mm_s2 = {}", vector_text(a)),
        };
        match &self.on {
            Some(on) => format!("{{ on = {}, {kind} }}", place_text(on)),
            None => format!("{{ {kind} }}"),
        }
    }
    fn schema() -> serde_json::Value {
        let vector = vector_schema();
        let keys = json!({
            "on": place_schema(),
            "force_n": vector,
            "pressure_mpa": f64::schema(),
            "moment_nmm": vector,
            "acceleration_mm_s2": vector,
        });
        // The keys are optional one by one; `oneOf` demands exactly one of them, as the reader does.
        let mut schema = table_schema(&keys, &[]);
        let one = |key: &str| json!({ "required": [key] });
        schema["oneOf"] =
            json!([one("force_n"), one("pressure_mpa"), one("moment_nmm"), one("acceleration_mm_s2")]);
        schema
    }
}

impl SettingValue for Case {
    const KIND: &'static str = "object";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        let t = Reader::new(value, "a table: name, weight, load", &["name", "weight", "load"])?;
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        // A single case needs no name.
        let name = t.get::<String>("name", any)?.unwrap_or_else(|| "case".to_owned());
        // A weight of 0 would be a case that is computed and not used.
        let weight = t.get::<f64>("weight", (f64::MIN_POSITIVE, MAX_NUMBER))?.unwrap_or(1.0);
        let loads = needed(t.get::<Vec<Load>>("load", any)?, "loads: [[guide.case.load]]")?;
        Ok(Self { name, weight, loads })
    }
    fn to_text(&self) -> String {
        let name = Value::String(self.name.clone());
        format!("{{ name = {name}, weight = {}, load = {} }}", self.weight, self.loads.to_text())
    }
    fn schema() -> serde_json::Value {
        let weight = json!({ "type": "number", "exclusiveMinimum": 0 });
        let keys = json!({ "name": String::schema(), "weight": weight, "load": Vec::<Load>::schema() });
        table_schema(&keys, &["load"])
    }
}
