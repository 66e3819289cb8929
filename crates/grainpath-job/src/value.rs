//! Values of settings: out of TOML, checked, and described.

use toml::Value;

use crate::choices::Threshold;

/// What a value must satisfy beside its type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Check {
    /// Nothing.
    Any,
    /// A number, or every number of a list, in this range.
    Range(f64, f64),
    /// One of these words.
    Words(&'static [&'static str]),
}

/// One setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// The table it stands in.
    pub section: &'static str,
    /// Its key there.
    pub key: &'static str,
    /// Unit, empty for none.
    pub unit: &'static str,
    /// JSON Schema type: number, integer, boolean, string or array.
    pub kind: &'static str,
    /// The default as TOML; empty where leaving it out means something of its own.
    pub default: String,
    /// Which values are allowed.
    pub check: Check,
    /// What it does and why one would change it.
    pub help: &'static str,
}

/// A type a setting can have.
pub trait SettingValue: Sized {
    /// JSON Schema type.
    const KIND: &'static str;
    /// Out of TOML; the error says what would be right.
    fn from_toml(value: &Value) -> Result<Self, String>;
    /// As TOML.
    fn to_text(&self) -> String;
    /// The numbers in it, for range checks.
    fn numbers(&self) -> Vec<f64> {
        Vec::new()
    }
    /// The word, for choices.
    fn text(&self) -> Option<&str> {
        None
    }
}

impl SettingValue for f64 {
    const KIND: &'static str = "number";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let number = value.as_float().or_else(|| value.as_integer().map(|i| i as Self));
        number.filter(|n| n.is_finite()).ok_or_else(|| format!("should be a number, is {value}"))
    }
    fn to_text(&self) -> String {
        self.to_string()
    }
    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl SettingValue for usize {
    const KIND: &'static str = "integer";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let whole = value.as_integer().and_then(|i| Self::try_from(i).ok());
        whole.ok_or_else(|| format!("should be a whole number from 0, is {value}"))
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
    fn from_toml(value: &Value) -> Result<Self, String> {
        value.as_bool().ok_or_else(|| format!("should be true or false, is {value}"))
    }
    fn to_text(&self) -> String {
        self.to_string()
    }
}

impl SettingValue for String {
    const KIND: &'static str = "string";
    fn from_toml(value: &Value) -> Result<Self, String> {
        value.as_str().map(str::to_owned).ok_or_else(|| format!("should be a text in quotes, is {value}"))
    }
    fn to_text(&self) -> String {
        Value::String(self.clone()).to_string()
    }
    fn text(&self) -> Option<&str> {
        Some(self)
    }
}

/// A number for both axes, or one for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair(pub [f64; 2]);

impl SettingValue for Pair {
    const KIND: &'static str = "number|array";
    fn from_toml(value: &Value) -> Result<Self, String> {
        if value.is_array() {
            <[f64; 2]>::from_toml(value).map(Self)
        } else {
            f64::from_toml(value).map(|v| Self([v; 2]))
        }
    }
    fn to_text(&self) -> String {
        if self.0[0] == self.0[1] { self.0[0].to_text() } else { self.0.to_text() }
    }
    fn numbers(&self) -> Vec<f64> {
        self.0.to_vec()
    }
}

impl SettingValue for Threshold {
    const KIND: &'static str = "string|number|array";
    fn from_toml(value: &Value) -> Result<Self, String> {
        match value {
            Value::String(s) if s == "otsu" => Ok(Self::Otsu),
            Value::String(s) if s == "iso50" => Ok(Self::Iso50(None)),
            Value::Array(_) => {
                let [low, high] = <[f64; 2]>::from_toml(value)?;
                if low < high { Ok(Self::Range(low, high)) } else { Err(format!("should rise, is {value}")) }
            }
            Value::Integer(_) | Value::Float(_) => f64::from_toml(value).map(Self::Value),
            _ => Err(format!("should be \"otsu\", \"iso50\", a grey value or [low, high], is {value}")),
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
}

impl<T: SettingValue> SettingValue for Option<T> {
    const KIND: &'static str = T::KIND;
    fn from_toml(value: &Value) -> Result<Self, String> {
        T::from_toml(value).map(Some)
    }
    fn to_text(&self) -> String {
        self.as_ref().map(T::to_text).unwrap_or_default()
    }
    fn numbers(&self) -> Vec<f64> {
        self.as_ref().map(T::numbers).unwrap_or_default()
    }
    fn text(&self) -> Option<&str> {
        self.as_ref().and_then(T::text)
    }
}

impl<T: SettingValue> SettingValue for Vec<T> {
    const KIND: &'static str = "array";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let items = value.as_array().ok_or_else(|| format!("should be a list in [ ], is {value}"))?;
        items.iter().map(T::from_toml).collect()
    }
    fn to_text(&self) -> String {
        format!("[{}]", self.iter().map(T::to_text).collect::<Vec<_>>().join(", "))
    }
    fn numbers(&self) -> Vec<f64> {
        self.iter().flat_map(T::numbers).collect()
    }
}

impl<T: SettingValue, const N: usize> SettingValue for [T; N] {
    const KIND: &'static str = "array";
    fn from_toml(value: &Value) -> Result<Self, String> {
        let items = Vec::<T>::from_toml(value)?;
        let n = items.len();
        Self::try_from(items).map_err(|_| format!("should have {N} entries, has {n}"))
    }
    fn to_text(&self) -> String {
        format!("[{}]", self.iter().map(T::to_text).collect::<Vec<_>>().join(", "))
    }
    fn numbers(&self) -> Vec<f64> {
        self.iter().flat_map(T::numbers).collect()
    }
}

/// Reads and checks one value.
pub fn read<T: SettingValue>(value: &Value, check: Check) -> Result<T, String> {
    let read = T::from_toml(value)?;
    match check {
        Check::Any => {}
        Check::Range(low, high) => {
            if let Some(bad) = read.numbers().into_iter().find(|n| !(low..=high).contains(n)) {
                return Err(format!("should be from {low} to {high}, is {bad}"));
            }
        }
        Check::Words(words) => {
            if let Some(bad) = read.text().filter(|t| !words.contains(t)) {
                return Err(format!("should be one of {}, is {bad:?}", words.join(", ")));
            }
        }
    }
    Ok(read)
}
