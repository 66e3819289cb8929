//! Fixtures, loads and load cases: the tables of `[guide]`, as typed.
//!
//! Coordinates are those of the part after scaling and rotation, mm, with the plate at z = 0. The planner finds the surface
//! or nodes that a place selects.
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

use grainpath_core::faces::FaceName;
use grainpath_core::math::sin_cos;
use grainpath_core::selection::Selection;
use grainpath_core::{DMat3, DVec3};
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
    /// A face of the part, by the name that `grainpath inspect --faces` gives it.
    Face(FaceName),
    /// The part of a face on one side of a plane.
    FaceSide {
        /// The face.
        face: FaceName,
        /// A point of the plane, mm.
        point_mm: DVec3,
        /// Unit normal of the plane; it points to the part of the face that is meant.
        normal: DVec3,
    },
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
    /// Force in N of a pin or bolt against the wall of a hole.
    Bearing(DVec3),
    /// Torque in N mm about the axis of the place.
    Torque(f64),
    /// Preload in N of a bolt that clamps the part between this place and a second one.
    Preload(f64),
    /// A force in N that acts at a point elsewhere, mm.
    Remote {
        /// The force, N.
        force_n: DVec3,
        /// The point where it acts.
        at_mm: DVec3,
    },
    /// The part turns about an axis.
    Centrifugal {
        /// A point of the axis.
        point_mm: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Speed, revolutions a minute.
        speed_rpm: f64,
    },
    /// Acceleration of the whole part in mm/s2: gravity is `[0, 0, -9810]`.
    Acceleration(DVec3),
}

/// A load.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The place; `None` for an acceleration.
    pub on: Option<Place>,
    /// The place under the other end of a bolt; `None` for loads that are not a preload.
    pub to: Option<Place>,
    /// Kind and size.
    pub push: Push,
}

/// Loads that act at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name in reports.
    pub name: String,
    /// Weight of the case in a sum of the cases; it also decides between mixes of the cases that are equally good.
    pub weight: f64,
    /// Loads of the case.
    pub loads: Vec<Load>,
}

/// Largest number that is accepted. Source: derived. Larger ones are typing errors. Below it, squares and their sums stay
/// far from overflow.
pub(super) const MAX_NUMBER: f64 = 1e12;

/// The keys that state the kind of a load.
const LOAD_KINDS: &str =
    "force_n, pressure_mpa, moment_nmm, bearing_n, torque_nmm, preload_n, centrifugal, acceleration_mm_s2";
/// The keys that state a place.
const PLACES: &str = "on = { face, box_mm, turned_box, plane, cylinder, sphere or facets }";

/// Reads the entries of a table one by one. Errors name the entry.
pub(super) struct Reader<'a>(pub(super) &'a Table);

impl<'a> Reader<'a> {
    /// The table in `value`. Keys that are not in `known` are an error.
    pub(super) fn new(value: &'a Value, expected: &'static str, known: &[&str]) -> Result<Self, ValueError> {
        let wrong = || Problem::Kind { expected, found: value.to_string() };
        let table = value.as_table().ok_or_else(wrong)?;
        if let Some(key) = table.keys().find(|k| !known.contains(&k.as_str())) {
            // A misspelled key would otherwise be ignored and leave a load out.
            let known = known.iter().map(|&known| known.to_owned()).collect();
            return Err(Problem::UnknownKey { key: key.clone(), known }.into());
        }
        Ok(Self(table))
    }

    pub(super) fn get<T: SettingValue>(&self, key: &str, range: (f64, f64)) -> Result<Option<T>, ValueError> {
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

pub(super) fn needed<T>(found: Option<T>, expected: &'static str) -> Result<T, ValueError> {
    Ok(found.ok_or(Problem::Missing { expected })?)
}

fn place(value: &Value) -> Result<Place, ValueError> {
    let keys = "face, box_mm, turned_box, plane, cylinder, sphere, facets";
    let known = ["face", "side", "box_mm", "turned_box", "plane", "cylinder", "sphere", "facets"];
    let Reader(on) = Reader::new(value, "a table in { }", &known)?;
    let side = on.get("side");
    let mut entries = on.iter().filter(|(key, _)| *key != "side");
    // Exactly one kind is allowed, since two would be ambiguous.
    let (Some((kind, value)), None) = (entries.next(), entries.next()) else {
        return Err(Problem::SeveralKinds { keys }.into());
    };
    if let (Some(side), "face") = (side, kind.as_str()) {
        let face = read_face(value).map_err(|e| e.in_key("face"))?;
        let [point_mm, normal] = read_side(side).map_err(|e| e.in_key("side"))?;
        return Ok(Place::FaceSide { face, point_mm, normal });
    }
    if side.is_some() {
        return Err(Problem::Missing { expected: "face beside side" }.into());
    }
    let read = match kind.as_str() {
        "face" => read_face(value).map(Place::Face),
        "box_mm" => read_box(value).map(Place::Shape),
        "turned_box" => read_turned_box(value).map(Place::Shape),
        "plane" => read_plane(value).map(Place::Shape),
        "cylinder" => read_cylinder(value).map(Place::Shape),
        "sphere" => read_sphere(value).map(Place::Shape),
        // All other known keys are handled above, so this key is `facets`.
        _ => Vec::<usize>::from_toml(value).map(Place::Facets),
    };
    read.map_err(|e| e.in_key(kind))
}

fn read_box(value: &Value) -> Result<Selection, ValueError> {
    let [low, high] = read_corners(value)?;
    Ok(Selection::Box { low, high })
}

/// The lowest and the highest corner of a box.
pub(super) fn read_corners(value: &Value) -> Result<[DVec3; 2], ValueError> {
    let [a, b] = <[[f64; 3]; 2]>::from_toml(value)?.map(DVec3::from);
    // Corners may be given in any order.
    Ok([a.min(b), a.max(b)])
}

fn read_centrifugal(value: &Value) -> Result<Push, ValueError> {
    let t = Reader::new(value, "a table in { }", &["point_mm", "axis", "speed_rpm"])?;
    Ok(Push::Centrifugal {
        point_mm: needed(t.vector("point_mm")?, "point_mm")?,
        axis: t.direction("axis")?,
        speed_rpm: needed(t.number("speed_rpm")?, "speed_rpm")?,
    })
}

pub(super) fn read_face(value: &Value) -> Result<FaceName, ValueError> {
    let wrong = || Problem::Kind {
        expected: "a name as \"f:9c1e\", which `grainpath inspect FILE --faces` lists",
        found: value.to_string(),
    };
    Ok(value.as_str().and_then(|text| text.parse().ok()).ok_or_else(wrong)?)
}

fn read_turned_box(value: &Value) -> Result<Selection, ValueError> {
    let t = Reader::new(value, "a table in { }", &["centre_mm", "size_mm", "rotate_deg"])?;
    let centre = needed(t.vector("centre_mm")?, "centre_mm")?;
    let size = needed(t.get::<[f64; 3]>("size_mm", (0.0, MAX_NUMBER))?, "size_mm")?;
    let turn = needed(t.get::<[f64; 3]>("rotate_deg", (-3600.0, 3600.0))?, "rotate_deg")?;
    Ok(Selection::TurnedBox { centre, half: 0.5 * DVec3::from(size), axes: rotation(turn) })
}

/// The matrix of rotations about x, then y, then z, as in `shape.rotate_deg`.
fn rotation(turn_deg: [f64; 3]) -> DMat3 {
    let [x, y, z] = turn_deg.map(|deg| sin_cos(deg.to_radians()));
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.1, x.0), DVec3::new(0.0, -x.0, x.1));
    let about_y = DMat3::from_cols(DVec3::new(y.1, 0.0, -y.0), DVec3::Y, DVec3::new(y.0, 0.0, y.1));
    let about_z = DMat3::from_cols(DVec3::new(z.1, z.0, 0.0), DVec3::new(-z.0, z.1, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// The rotations about x, y and z that make a matrix, in degrees.
fn turn_deg(axes: &DMat3) -> [f64; 3] {
    use grainpath_core::math::{asin, atan2};
    let y = asin((-axes.x_axis.z).clamp(-1.0, 1.0));
    let turn = if axes.x_axis.z.abs() < 1.0 - 1e-12 {
        [atan2(axes.y_axis.z, axes.z_axis.z), y, atan2(axes.x_axis.y, axes.x_axis.x)]
    } else {
        // If the rotation about y is a right angle, those about x and z have the same axis; all of it is given to x.
        [atan2(-axes.z_axis.y, axes.y_axis.y), y, 0.0]
    };
    // Rounds to 1e-8 degrees, so that 30 is printed as 30.
    turn.map(|rad| (rad.to_degrees() * 1e8).round() / 1e8)
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

/// The plane that cuts a face: a point and the unit normal, which points to the part that is meant.
fn read_side(value: &Value) -> Result<[DVec3; 2], ValueError> {
    let t = Reader::new(value, "a table in { }", &["point_mm", "normal"])?;
    Ok([needed(t.vector("point_mm")?, "point_mm")?, t.direction("normal")?])
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
        Place::Face(name) => format!("{{ face = \"{name}\" }}"),
        Place::FaceSide { face, point_mm, normal } => format!(
            "{{ face = \"{face}\", side = {{ point_mm = {}, normal = {} }} }}",
            v(point_mm),
            v(normal)
        ),
        Place::Facets(f) => format!("{{ facets = {} }}", f.to_text()),
        Place::Shape(Selection::TurnedBox { centre, half, axes }) => format!(
            "{{ turned_box = {{ centre_mm = {}, size_mm = {}, rotate_deg = {} }} }}",
            v(centre),
            v(&(2.0 * *half)),
            v(&DVec3::from(turn_deg(axes)))
        ),
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
        // Places of this kind come from other stages and cannot be written in a job file; this text is for
        // reports.
        Place::Shape(
            Selection::Triangles(t) | Selection::Near { triangles: t, .. } | Selection::Points(t),
        ) => {
            format!("{{ {} facets }}", t.triangles().len())
        }
        Place::Shape(Selection::Patch(patch)) => {
            format!("{{ {} facets }}", patch.triangles.triangles().len())
        }
    }
}

pub(super) fn vector_text(v: DVec3) -> String {
    format!("[{}, {}, {}]", v.x, v.y, v.z)
}

/// Schema of a vector.
fn vector_schema() -> serde_json::Value {
    <[f64; 3]>::schema()
}

/// Schema of a table with these keys.
pub(super) fn table_schema(properties: &serde_json::Value, required: &[&str]) -> serde_json::Value {
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
    let turned_box = json!({ "centre_mm": vector, "size_mm": vector, "rotate_deg": vector });
    let plane = json!({ "point_mm": vector, "normal": vector, "tolerance_mm": number });
    let cylinder = json!({ "point_mm": vector, "axis": vector, "radius_mm": number, "length_mm": number });
    let sphere = json!({ "centre_mm": vector, "radius_mm": number });
    let side = json!({ "point_mm": vector, "normal": vector });
    let kinds = ["face", "box_mm", "turned_box", "plane", "cylinder", "sphere", "facets"];
    json!({
        "type": "object",
        "additionalProperties": false,
        "oneOf": kinds.map(|key| json!({ "required": [key] })),
        "dependentRequired": { "side": ["face"] },
        "properties": {
            "face": { "type": "string", "pattern": "^f:[0-9a-fA-F]{4,15}$" },
            "side": table_schema(&side, &["point_mm", "normal"]),
            "box_mm": <[[f64; 3]; 2]>::schema(),
            "turned_box": table_schema(&turned_box, &["centre_mm", "size_mm", "rotate_deg"]),
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
        // A fixture without `fix` would hold nothing, which is surely a mistake.
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
        let known = [
            "on",
            "force_n",
            "at_mm",
            "pressure_mpa",
            "moment_nmm",
            "bearing_n",
            "torque_nmm",
            "preload_n",
            "to",
            "centrifugal",
            "acceleration_mm_s2",
        ];
        let t = Reader::new(value, "a table: on = ..., force_n = [x, y, z]", &known)?;
        let at_mm = t.vector("at_mm")?;
        let force = |force_n| match at_mm {
            Some(at_mm) => Push::Remote { force_n, at_mm },
            None => Push::Force(force_n),
        };
        let kinds = [
            t.vector("force_n")?.map(force),
            t.number("pressure_mpa")?.map(Push::Pressure),
            t.vector("moment_nmm")?.map(Push::Moment),
            t.vector("bearing_n")?.map(Push::Bearing),
            t.number("torque_nmm")?.map(Push::Torque),
            t.length("preload_n")?.map(Push::Preload),
            t.0.get("centrifugal").map(read_centrifugal).transpose().map_err(|e| e.in_key("centrifugal"))?,
            t.vector("acceleration_mm_s2")?.map(Push::Acceleration),
        ];
        // Exactly one kind of load in each table, so that every load has one place and one unit.
        let mut given = kinds.into_iter().flatten();
        let push = needed(
            given.next(),
            "force_n, pressure_mpa, moment_nmm, bearing_n, torque_nmm, preload_n, centrifugal or acceleration_mm_s2",
        )?;
        if given.next().is_some() {
            return Err(Problem::SeveralKinds { keys: LOAD_KINDS }.into());
        }
        if at_mm.is_some() && !matches!(push, Push::Remote { .. }) {
            return Err(Problem::Missing { expected: "force_n beside at_mm" }.into());
        }
        let to = match (push, t.0.get("to")) {
            (Push::Preload(_), other) => {
                let expected = "to = { face, box_mm, turned_box, plane, cylinder, sphere or facets }, the place below the nut";
                Some(place(needed(other, expected)?).map_err(|e| e.in_key("to"))?)
            }
            (_, Some(_)) => return Err(Problem::Missing { expected: "preload_n beside to" }.into()),
            (_, None) => None,
        };
        let on = match push {
            // Gravity acts on the whole part. A place would suggest that it acts there alone, so it is
            // refused.
            Push::Acceleration(_) | Push::Centrifugal { .. } if !t.0.contains_key("on") => None,
            Push::Acceleration(_) | Push::Centrifugal { .. } => {
                return Err(Problem::PlaceOfAcceleration.into());
            }
            Push::Force(_)
            | Push::Pressure(_)
            | Push::Moment(_)
            | Push::Bearing(_)
            | Push::Torque(_)
            | Push::Preload(_)
            | Push::Remote { .. } => Some(t.place()?),
        };
        Ok(Self { on, to, push })
    }
    fn to_text(&self) -> String {
        let kind = match self.push {
            Push::Force(f) => format!("force_n = {}", vector_text(f)),
            Push::Pressure(p) => format!("pressure_mpa = {p}"),
            Push::Moment(m) => format!("moment_nmm = {}", vector_text(m)),
            Push::Bearing(f) => format!("bearing_n = {}", vector_text(f)),
            Push::Torque(t) => format!("torque_nmm = {t}"),
            Push::Preload(f) => {
                let to = self.to.as_ref().map(|to| format!("to = {}, ", place_text(to))).unwrap_or_default();
                format!("{to}preload_n = {f}")
            }
            Push::Remote { force_n, at_mm } => {
                format!("force_n = {}, at_mm = {}", vector_text(force_n), vector_text(at_mm))
            }
            Push::Centrifugal { point_mm, axis, speed_rpm } => format!(
                "centrifugal = {{ point_mm = {}, axis = {}, speed_rpm = {speed_rpm} }}",
                vector_text(point_mm),
                vector_text(axis)
            ),
            Push::Acceleration(a) => format!("acceleration_mm_s2 = {}", vector_text(a)),
        };
        match &self.on {
            Some(on) => format!("{{ on = {}, {kind} }}", place_text(on)),
            None => format!("{{ {kind} }}"),
        }
    }
    fn schema() -> serde_json::Value {
        let vector = vector_schema();
        let turning = json!({ "point_mm": vector, "axis": vector, "speed_rpm": f64::schema() });
        let keys = json!({
            "on": place_schema(),
            "force_n": vector,
            "pressure_mpa": f64::schema(),
            "at_mm": vector,
            "moment_nmm": vector,
            "bearing_n": vector,
            "torque_nmm": f64::schema(),
            "preload_n": { "type": "number", "minimum": 0 },
            "to": place_schema(),
            "centrifugal": table_schema(&turning, &["point_mm", "axis", "speed_rpm"]),
            "acceleration_mm_s2": vector,
        });
        // Each key by itself is optional; `oneOf` demands exactly one of them, as the parser does.
        let mut schema = table_schema(&keys, &[]);
        let one = |key: &str| json!({ "required": [key] });
        let all: Vec<serde_json::Value> = LOAD_KINDS.split(", ").map(one).collect();
        schema["oneOf"] = json!(all);
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
