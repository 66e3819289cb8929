//! Fixtures, loads and load cases: the tables of `[guide]`.

use std::fmt::Write as _;

use grainpath_core::DVec3;
use grainpath_core::selection::Selection;
use grainpath_core::spelling::nearest;
use toml::{Table, Value};

use super::value::SettingValue;

/// Where a fixture or load acts, as written.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A shape.
    Shape(Selection),
    /// Triangles of the mesh, by number.
    Facets(Vec<usize>),
}

/// How something is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixture {
    /// Where.
    pub on: Place,
    /// Which of x, y and z cannot move.
    pub fixed: [bool; 3],
    /// Whether the surface cannot move along its normal: a roller or a plane of symmetry.
    pub normal: bool,
    /// Where the held directions are moved to, mm.
    pub displacement_mm: DVec3,
}

/// What pushes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Push {
    /// A force in N, spread over the area.
    Force(DVec3),
    /// MPa against the surface.
    Pressure(f64),
    /// N mm about the middle of the area.
    Moment(DVec3),
    /// An acceleration of the whole part, mm/s2: gravity is `[0, 0, -9810]`.
    Acceleration(DVec3),
}

/// A load.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Where; nowhere for an acceleration.
    pub on: Option<Place>,
    /// What.
    pub push: Push,
}

/// Loads that act together.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// What it is called in reports.
    pub name: String,
    /// How much it counts beside the others.
    pub weight: f64,
    /// Its loads.
    pub loads: Vec<Load>,
}

fn table<'a>(value: &'a Value, what: &str) -> Result<&'a Table, String> {
    value.as_table().ok_or_else(|| format!("should hold tables: {what}; is {value}"))
}

/// Refuses keys that are not known.
fn only(table: &Table, what: &str, known: &[&str]) -> Result<(), String> {
    match table.keys().find(|k| !known.contains(&k.as_str())) {
        Some(k) => {
            let near = nearest(k, known.iter().copied());
            Err(format!("{what} has an unknown key `{k}`; did you mean `{near}`?"))
        }
        None => Ok(()),
    }
}

/// Larger numbers are slips, and their squares are not finite.
const MOST: f64 = 1e12;

fn number(table: &Table, what: &str, key: &str) -> Result<Option<f64>, String> {
    let read = |v: &Value| match f64::from_toml(v) {
        Ok(n) if n.abs() > MOST => Err(format!("{what}: {key} should be at most 1e12, is {n:e}")),
        found => found.map_err(|e| format!("{what}: {key} {e}")),
    };
    table.get(key).map(read).transpose()
}

fn length(table: &Table, what: &str, key: &str) -> Result<Option<f64>, String> {
    match number(table, what, key)? {
        Some(l) if l < 0.0 => Err(format!("{what}: {key} should not be negative, is {l}")),
        found => Ok(found),
    }
}

fn vector(table: &Table, what: &str, key: &str) -> Result<Option<DVec3>, String> {
    let read = |v: &Value| match <[f64; 3]>::from_toml(v).map(DVec3::from) {
        Ok(found) if found.abs().max_element() > MOST => {
            Err(format!("{what}: {key} should hold numbers of at most 1e12, is {v}"))
        }
        found => found.map_err(|e| format!("{what}: {key} {e}")),
    };
    table.get(key).map(read).transpose()
}

fn needed<T>(found: Option<T>, what: &str, key: &str) -> Result<T, String> {
    found.ok_or_else(|| format!("{what} needs {key}"))
}

fn unit(table: &Table, what: &str, key: &str) -> Result<DVec3, String> {
    let v = needed(vector(table, what, key)?, what, key)?;
    v.try_normalize().ok_or_else(|| format!("{what}: {key} should not be zero"))
}

fn place(table: &Table, what: &str) -> Result<Place, String> {
    let on = needed(table.get("on"), what, "on = { box_mm, plane, cylinder, sphere or facets }")?;
    let on = on.as_table().filter(|t| t.len() == 1).ok_or_else(|| {
        format!("{what}: on should be one of box_mm, plane, cylinder, sphere, facets in {{ }}, is {on}")
    })?;
    let what = &format!("{what}: on");
    only(on, what, &["box_mm", "plane", "cylinder", "sphere", "facets"])?;
    let (kind, value) = on.iter().next().ok_or_else(|| format!("{what} is empty"))?;
    let inner =
        || value.as_table().ok_or_else(|| format!("{what}.{kind} should be a table in {{ }}, is {value}"));
    let shape = match kind.as_str() {
        "box_mm" => {
            let [a, b] = <[[f64; 3]; 2]>::from_toml(value).map_err(|e| format!("{what}.box_mm {e}"))?;
            let (a, b) = (DVec3::from(a), DVec3::from(b));
            Selection::Box { low: a.min(b), high: a.max(b) }
        }
        "plane" => {
            let t = inner()?;
            only(t, what, &["point_mm", "normal", "tolerance_mm"])?;
            Selection::Plane {
                point: needed(vector(t, what, "point_mm")?, what, "point_mm")?,
                normal: unit(t, what, "normal")?,
                tolerance_mm: length(t, what, "tolerance_mm")?.unwrap_or(0.01),
            }
        }
        "cylinder" => {
            let t = inner()?;
            only(t, what, &["point_mm", "axis", "radius_mm", "length_mm"])?;
            Selection::Cylinder {
                point: needed(vector(t, what, "point_mm")?, what, "point_mm")?,
                axis: unit(t, what, "axis")?,
                radius_mm: needed(length(t, what, "radius_mm")?, what, "radius_mm")?,
                length_mm: length(t, what, "length_mm")?,
            }
        }
        "sphere" => {
            let t = inner()?;
            only(t, what, &["centre_mm", "radius_mm"])?;
            Selection::Sphere {
                centre: needed(vector(t, what, "centre_mm")?, what, "centre_mm")?,
                radius_mm: needed(length(t, what, "radius_mm")?, what, "radius_mm")?,
            }
        }
        _ => {
            let facets = Vec::<usize>::from_toml(value).map_err(|e| format!("{what}.facets {e}"))?;
            return Ok(Place::Facets(facets));
        }
    };
    Ok(Place::Shape(shape))
}

fn place_text(place: &Place) -> String {
    let v = |p: &DVec3| format!("[{}, {}, {}]", p.x, p.y, p.z);
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
        Place::Shape(Selection::Triangles(t) | Selection::Near { triangles: t, .. }) => {
            format!("{{ {} facets }}", t.len())
        }
    }
}

impl SettingValue for Fixture {
    const KIND: &'static str = "object";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let what = "a fixture";
        let t = table(value, "on = ..., fix = \"xyz\"")?;
        only(t, what, &["on", "fix", "displacement_mm"])?;
        let fix =
            needed(t.get("fix").and_then(Value::as_str), what, "fix = \"xyz\", some of it, or \"normal\"")?;
        let normal = fix == "normal";
        let letters = fix.chars().all(|c| "xyz".contains(c)) && !fix.is_empty();
        if !normal && !letters {
            return Err(format!("{what}: fix should be some of \"xyz\", or \"normal\", is {fix:?}"));
        }
        let fixed = ['x', 'y', 'z'].map(|c| !normal && fix.contains(c));
        let displacement_mm = vector(t, what, "displacement_mm")?.unwrap_or_default();
        Ok(Self { on: place(t, what)?, fixed, normal, displacement_mm })
    }
    fn to_text(&self) -> String {
        let fix: String = if self.normal {
            "normal".into()
        } else {
            ['x', 'y', 'z'].iter().zip(self.fixed).filter(|(_, f)| *f).map(|(c, _)| *c).collect()
        };
        let mut text = format!("{{ on = {}, fix = \"{fix}\"", place_text(&self.on));
        if self.displacement_mm != DVec3::ZERO {
            let d = self.displacement_mm;
            let _ = write!(text, ", displacement_mm = [{}, {}, {}]", d.x, d.y, d.z);
        }
        text + " }"
    }
}

impl SettingValue for Load {
    const KIND: &'static str = "object";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let what = "a load";
        let t = table(value, "on = ..., force_n = [x, y, z]")?;
        only(t, what, &["on", "force_n", "pressure_mpa", "moment_nmm", "acceleration_mm_s2"])?;
        let pushes = [
            vector(t, what, "force_n")?.map(Push::Force),
            number(t, what, "pressure_mpa")?.map(Push::Pressure),
            vector(t, what, "moment_nmm")?.map(Push::Moment),
            vector(t, what, "acceleration_mm_s2")?.map(Push::Acceleration),
        ];
        let mut given = pushes.into_iter().flatten();
        let push = needed(given.next(), what, "force_n, pressure_mpa, moment_nmm or acceleration_mm_s2")?;
        if given.next().is_some() {
            return Err(format!(
                "{what} should have one of force_n, pressure_mpa, moment_nmm, acceleration_mm_s2"
            ));
        }
        let on = match push {
            Push::Acceleration(_) if !t.contains_key("on") => None,
            Push::Acceleration(_) => {
                return Err(format!("{what}: an acceleration acts on the whole part; leave `on` out"));
            }
            _ => Some(place(t, what)?),
        };
        Ok(Self { on, push })
    }
    fn to_text(&self) -> String {
        let v = |p: DVec3| format!("[{}, {}, {}]", p.x, p.y, p.z);
        let push = match self.push {
            Push::Force(f) => format!("force_n = {}", v(f)),
            Push::Pressure(p) => format!("pressure_mpa = {p}"),
            Push::Moment(m) => format!("moment_nmm = {}", v(m)),
            Push::Acceleration(a) => format!("acceleration_mm_s2 = {}", v(a)),
        };
        match &self.on {
            Some(on) => format!("{{ on = {}, {push} }}", place_text(on)),
            None => format!("{{ {push} }}"),
        }
    }
}

impl SettingValue for Case {
    const KIND: &'static str = "object";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let what = "a case";
        let t = table(value, "name = \"...\", weight = 1, load = [...]")?;
        only(t, what, &["name", "weight", "load"])?;
        let name = t.get("name").and_then(Value::as_str).unwrap_or("case").to_owned();
        let weight = number(t, what, "weight")?.unwrap_or(1.0);
        if weight <= 0.0 {
            return Err(format!("{what}: weight should be over 0, is {weight}"));
        }
        let loads = needed(t.get("load"), what, "loads: [[guide.case.load]]")?;
        Ok(Self { name, weight, loads: Vec::<Load>::from_toml(loads)? })
    }
    fn to_text(&self) -> String {
        let name = Value::String(self.name.clone());
        format!("{{ name = {name}, weight = {}, load = {} }}", self.weight, self.loads.to_text())
    }
}
