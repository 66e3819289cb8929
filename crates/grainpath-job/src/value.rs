//! Types of setting values: how each is read from TOML, checked, printed and described by a schema.

use std::fmt;

use grainpath_core::Density;
use grainpath_core::slices::SampleType;
use grainpath_core::spelling::near;
use grainpath_core::units::LengthUnit;
use serde_json::json;
use toml::Value;

use crate::choices::{
    Analysis, BeadEnds, BeadWidths, BedOrigin, Bend, BoardCorners, ByteOrder, CaseMix, CellTree, Choice,
    ComponentOrder, Contours, CurveJoin, Denoise, DensityBy, Elasticity, FibreStart, FibreToolKind,
    FibreTurns, Fidelity, FieldAngleUnit, FieldAxes, FieldFrame, FileUnit, Flavour, Flip, Follow, GrainMode,
    GuideKind, Interpolate, LayerShift, LoadFrame, OutlineRule, Pattern, Repair, Seam, StrengthTier,
    StressUnit, SupportStyle, SupportSurface, Threshold, WallOrder, Word,
};

/// The numbers that a setting accepts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Check {
    /// Every number of the type.
    Any,
    /// Numbers from the first to the second, both included. In a list every number is checked.
    Range(f64, f64),
}

/// Description of one setting.
///
/// ```
/// use grainpath_job::{Check, Settings};
///
/// let rows = Settings::params();
/// let walls = rows.iter().find(|p| p.section == "support" && p.key == "walls").unwrap();
/// assert_eq!((walls.kind, walls.default.as_str()), ("integer", "1"));
/// assert_eq!(walls.check, Check::Range(1.0, 100.0));
///
/// let seam = rows.iter().find(|p| p.key == "seam").unwrap();
/// assert!(seam.words.iter().any(|w| w.name == "rear"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Table of the job file that holds the setting, as in `shape.ct`.
    pub section: &'static str,
    /// Key in that table.
    pub key: &'static str,
    /// Unit; empty for numbers without a unit and for other types.
    pub unit: &'static str,
    /// JSON Schema type: `number`, `integer`, `boolean`, `string`, `array`, or several separated by `|`.
    pub kind: &'static str,
    /// Default value as TOML; empty for a setting that is unset by default.
    pub default: String,
    /// Numbers that are accepted.
    pub check: Check,
    /// Words that are accepted; empty for settings that are not a choice.
    pub words: &'static [Word],
    /// Effect of the setting, and when to change it.
    pub help: &'static str,
    /// JSON Schema of the value, without range and description.
    pub schema: serde_json::Value,
}

/// One step of the path from a setting to a part of its value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// An entry of a list, from 0.
    Index(usize),
    /// A key of a table.
    Key(String),
}

/// A number as people write it: with an exponent where it is large.
fn short(v: f64) -> String {
    // Numbers from 1e9 on have an exponent, because their digits are hard to count.
    if v.abs() >= 1e9 { format!("{v:e}") } else { v.to_string() }
}

/// Reasons why a value is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum Problem {
    #[error("should be {expected}, is {found}")]
    Kind { expected: &'static str, found: String },
    #[error("should be from {} to {}, is {}", short(*low), short(*high), short(*found))]
    Range { low: f64, high: f64, found: f64 },
    #[error("should be one of {}, is {found:?}", names(words))]
    Word { words: &'static [Word], found: String },
    #[error("should have {expected} entries, has {found}")]
    Count { expected: usize, found: usize },
    #[error("should rise from the first to the second number, is {found}")]
    Falling { found: String },
    #[error(
        "has an unknown key `{key}`; {}",
        near(key, known.iter().map(String::as_str))
            .map_or_else(|| format!("its keys are {}", known.join(", ")), |near| format!("did you mean `{near}`?"))
    )]
    UnknownKey { key: String, known: Vec<String> },
    #[error("needs {expected}")]
    Missing { expected: &'static str },
    #[error("should be a direction, is a vector of length 0")]
    NoDirection,
    #[error("should have exactly one of {keys}")]
    SeveralKinds { keys: &'static str },
    #[error("should give each layer one list of angles, has {layers}")]
    LayerAngles { layers: String },
    #[error("acts on the whole part; remove `on`")]
    PlaceOfAcceleration,
}

fn names(words: &[Word]) -> String {
    words.iter().map(|w| w.name).collect::<Vec<_>>().join(", ")
}

/// A refused value: the reason, and the part of the value that is wrong.
///
/// Printed after the name of the setting: `[2].force_n should be a list in [ ], is 3`. Entries of lists are counted
/// from 1.
#[derive(Debug, Clone, PartialEq)]
pub struct ValueError {
    /// The path from the setting to the wrong part; empty if the whole value is wrong.
    pub path: Vec<Step>,
    /// The reason.
    pub problem: Problem,
}

impl ValueError {
    /// The same error with `step` put in front of its path.
    #[must_use]
    pub fn inside(mut self, step: Step) -> Self {
        // An error arises at the innermost value and is passed outwards, so each outer step goes in front.
        self.path.insert(0, step);
        self
    }

    /// The same error with `key` put in front of its path, for a value that stands in a table.
    #[must_use]
    pub(crate) fn in_key(self, key: &str) -> Self {
        self.inside(Step::Key(key.to_owned()))
    }
}

impl From<Problem> for ValueError {
    fn from(problem: Problem) -> Self {
        Self { path: Vec::new(), problem }
    }
}

impl fmt::Display for ValueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", path_text(&self.path), self.problem)
    }
}

/// A path as messages write it, after the name of its setting.
pub(crate) fn path_text(path: &[Step]) -> String {
    let text = |step: &Step| match step {
        // Messages count entries from 1.
        Step::Index(i) => format!("[{}]", i + 1),
        Step::Key(key) => format!(".{key}"),
    };
    path.iter().map(text).collect()
}

impl std::error::Error for ValueError {}

/// A type that a setting can have.
pub(crate) trait SettingValue: Sized {
    /// JSON Schema type.
    const KIND: &'static str;
    /// The words of a choice.
    const WORDS: &'static [Word] = &[];
    /// Reads the value.
    ///
    /// # Errors
    /// [`ValueError`] for a value of another type, and for words that are not in the list.
    fn from_toml(value: &Value) -> Result<Self, ValueError>;
    /// The value as TOML; empty where it is unset.
    fn to_text(&self) -> String;
    /// All numbers in the value, for range checks.
    fn numbers(&self) -> Vec<f64> {
        Vec::new()
    }
    /// JSON Schema of the type.
    fn schema() -> serde_json::Value {
        // `KIND` separates several kinds by `|`; JSON Schema wants them as a list.
        let kinds: Vec<&str> = Self::KIND.split('|').collect();
        if kinds.len() > 1 { json!({ "type": kinds }) } else { json!({ "type": Self::KIND }) }
    }
}

fn wrong_kind(expected: &'static str, found: &Value) -> ValueError {
    Problem::Kind { expected, found: found.to_string() }.into()
}

impl SettingValue for f64 {
    const KIND: &'static str = "number";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        // TOML distinguishes 1 from 1.0, but users write either for a number. TOML also allows NaN and
        // infinity, which no setting accepts.
        let number = value.as_float().or_else(|| value.as_integer().map(|i| i as Self));
        number.filter(|n| n.is_finite()).ok_or_else(|| wrong_kind("a number", value))
    }
    fn to_text(&self) -> String {
        self.to_string()
    }
    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl SettingValue for Density {
    const KIND: &'static str = "number";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        // Values above 1 are refused here: `Density::new` reads 30 as fully dense, but its user meant 30 %.
        let number = f64::from_toml(value)?;
        let problem = Problem::Range { low: 0.0, high: 1.0, found: number };
        if (0.0..=1.0).contains(&number) { Ok(Self::new(number)) } else { Err(problem.into()) }
    }
    fn to_text(&self) -> String {
        self.fraction().to_text()
    }
    fn numbers(&self) -> Vec<f64> {
        vec![self.fraction()]
    }
}

impl SettingValue for usize {
    const KIND: &'static str = "integer";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        // Settings of this type are counts or indices, so a negative number is refused.
        let whole = value.as_integer().and_then(|i| Self::try_from(i).ok());
        whole.ok_or_else(|| wrong_kind("a whole number from 0", value))
    }
    fn to_text(&self) -> String {
        self.to_string()
    }
    fn numbers(&self) -> Vec<f64> {
        vec![*self as f64]
    }
}

impl SettingValue for bool {
    const KIND: &'static str = "boolean";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        value.as_bool().ok_or_else(|| wrong_kind("true or false", value))
    }
    fn to_text(&self) -> String {
        self.to_string()
    }
}

impl SettingValue for String {
    const KIND: &'static str = "string";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        value.as_str().map(str::to_owned).ok_or_else(|| wrong_kind("a text in quotes", value))
    }
    fn to_text(&self) -> String {
        // TOML's own writer quotes and escapes, so that the text can be read back.
        Value::String(self.clone()).to_string()
    }
}

/// Reads and prints each choice as its word.
macro_rules! choice_values {
    ($($name:ty),* $(,)?) => {$(
        impl SettingValue for $name {
            const KIND: &'static str = "string";
            const WORDS: &'static [Word] = <Self as Choice>::WORDS;
            fn from_toml(value: &Value) -> Result<Self, ValueError> {
                let word = value.as_str().ok_or_else(|| wrong_kind("a word in quotes", value))?;
                let unknown = || Problem::Word { words: <Self as Choice>::WORDS, found: word.to_owned() };
                Ok(Self::from_word(word).ok_or_else(unknown)?)
            }
            fn to_text(&self) -> String {
                Value::from(Choice::name(*self)).to_string()
            }
        }
    )*};
}

choice_values!(
    Analysis,
    BeadEnds,
    BeadWidths,
    BedOrigin,
    Bend,
    BoardCorners,
    ByteOrder,
    CaseMix,
    CellTree,
    ComponentOrder,
    Contours,
    CurveJoin,
    Denoise,
    DensityBy,
    Elasticity,
    FibreStart,
    FibreToolKind,
    FibreTurns,
    Fidelity,
    FieldAngleUnit,
    FieldAxes,
    FieldFrame,
    FileUnit,
    Flavour,
    Flip,
    Follow,
    GrainMode,
    GuideKind,
    Interpolate,
    LayerShift,
    LengthUnit,
    LoadFrame,
    OutlineRule,
    Pattern,
    Repair,
    SampleType,
    Seam,
    StrengthTier,
    StressUnit,
    SupportStyle,
    SupportSurface,
    WallOrder,
);

/// One number for x and y, or a number for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair(pub [f64; 2]);

impl SettingValue for Pair {
    const KIND: &'static str = "number|array";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        if value.is_array() {
            <[f64; 2]>::from_toml(value).map(Self)
        } else {
            f64::from_toml(value).map(|v| Self([v; 2]))
        }
    }
    fn to_text(&self) -> String {
        // Two equal numbers are printed as one, which is how users mostly write them.
        if self.0[0] == self.0[1] { self.0[0].to_text() } else { self.0.to_text() }
    }
    fn numbers(&self) -> Vec<f64> {
        self.0.to_vec()
    }
    fn schema() -> serde_json::Value {
        list_schema(Self::KIND, &f64::schema(), Some(2))
    }
}

impl SettingValue for Threshold {
    const KIND: &'static str = "string|number|array";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        // Accepts several kinds of values, so the message lists them all.
        let expected = "\"otsu\", \"iso50\", a grey value or [low, high]";
        match value {
            Value::String(s) if s == "otsu" => Ok(Self::Otsu),
            Value::String(s) if s == "iso50" => Ok(Self::Iso50(None)),
            Value::Array(_) => {
                let [low, high] = <[f64; 2]>::from_toml(value)?;
                // A range whose ends are exchanged would select nothing.
                if low >= high {
                    return Err(Problem::Falling { found: value.to_string() }.into());
                }
                Ok(Self::Range(low, high))
            }
            Value::Integer(_) | Value::Float(_) => f64::from_toml(value).map(Self::Value),
            Value::String(_) | Value::Boolean(_) | Value::Datetime(_) | Value::Table(_) => {
                Err(wrong_kind(expected, value))
            }
        }
    }
    fn to_text(&self) -> String {
        match self {
            Self::Otsu => "\"otsu\"".into(),
            Self::Iso50(_) => "\"iso50\"".into(),
            Self::Value(v) => v.to_text(),
            Self::Range(a, b) => [*a, *b].to_text(),
        }
    }
    fn schema() -> serde_json::Value {
        let mut schema = list_schema(Self::KIND, &f64::schema(), Some(2));
        schema["pattern"] = json!("^(otsu|iso50)$");
        schema
    }
}

/// The word that unsets an optional setting, so that the command line can undo what a job file sets.
pub(super) const UNSET: &str = "none";

/// Whether [`UNSET`] unsets a setting of this type. A free text cannot be unset, because "none" may be a
/// name.
fn can_be_unset<T: SettingValue>() -> bool {
    T::KIND != "string" || !T::WORDS.is_empty()
}

impl<T: SettingValue> SettingValue for Option<T> {
    const KIND: &'static str = T::KIND;
    const WORDS: &'static [Word] = T::WORDS;
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        if can_be_unset::<T>() && value.as_str() == Some(UNSET) {
            return Ok(None);
        }
        T::from_toml(value).map(Some)
    }
    fn to_text(&self) -> String {
        self.as_ref().map(T::to_text).unwrap_or_default()
    }
    fn numbers(&self) -> Vec<f64> {
        self.as_ref().map(T::numbers).unwrap_or_default()
    }
    fn schema() -> serde_json::Value {
        let mut schema = T::schema();
        // The schema of a type that is not a choice accepts the text "none" besides values of the
        // type itself.
        if can_be_unset::<T>() && T::WORDS.is_empty() {
            let kinds: Vec<&str> = T::KIND.split('|').chain(["string"]).collect();
            schema["type"] = json!(kinds);
            schema["pattern"] = json!(format!("^{UNSET}$"));
        }
        schema
    }
}

/// Schema of a list: its type, the schema of an entry, and the number of entries.
fn list_schema(kind: &str, item: &serde_json::Value, n: Option<usize>) -> serde_json::Value {
    let kinds: Vec<&str> = kind.split('|').collect();
    let kind = if kinds.len() > 1 { json!(kinds) } else { json!(kind) };
    match n {
        Some(n) => json!({ "type": kind, "items": item, "minItems": n, "maxItems": n }),
        None => json!({ "type": kind, "items": item }),
    }
}

impl<T: SettingValue> SettingValue for Vec<T> {
    const KIND: &'static str = "array";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        let items = value.as_array().ok_or_else(|| wrong_kind("a list in [ ]", value))?;
        // The error names the entry, counted from 1 when printed.
        let entry = |(i, v)| T::from_toml(v).map_err(|e: ValueError| e.inside(Step::Index(i)));
        items.iter().enumerate().map(entry).collect()
    }
    fn to_text(&self) -> String {
        format!("[{}]", self.iter().map(T::to_text).collect::<Vec<_>>().join(", "))
    }
    fn numbers(&self) -> Vec<f64> {
        self.iter().flat_map(T::numbers).collect()
    }
    fn schema() -> serde_json::Value {
        list_schema(Self::KIND, &T::schema(), None)
    }
}

impl<T: SettingValue, const N: usize> SettingValue for [T; N] {
    const KIND: &'static str = "array";
    fn from_toml(value: &Value) -> Result<Self, ValueError> {
        // The length is checked after the entries, so that a wrong entry is reported first.
        let items = Vec::<T>::from_toml(value)?;
        let found = items.len();
        Ok(Self::try_from(items).map_err(|_| Problem::Count { expected: N, found })?)
    }
    fn to_text(&self) -> String {
        format!("[{}]", self.iter().map(T::to_text).collect::<Vec<_>>().join(", "))
    }
    fn numbers(&self) -> Vec<f64> {
        self.iter().flat_map(T::numbers).collect()
    }
    fn schema() -> serde_json::Value {
        list_schema(Self::KIND, &T::schema(), Some(N))
    }
}

/// Reads a value and checks its range.
pub(super) fn read<T: SettingValue>(value: &Value, check: Check) -> Result<T, ValueError> {
    let read = T::from_toml(value)?;
    if let Check::Range(low, high) = check
        // If several numbers of a list are out of range, the error reports the first.
        && let Some(found) = read.numbers().into_iter().find(|n| !(low..=high).contains(n))
    {
        return Err(Problem::Range { low, high, found }.into());
    }
    Ok(read)
}
