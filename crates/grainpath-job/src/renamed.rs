//! Keys and words that were renamed, and keys that were removed. Files with the old names are still read.

use toml::Value;

use super::value::Step;

/// A key or a word with a new name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Renamed {
    /// A key of a section, or of a table inside it.
    Key {
        /// The section, for example `shape.ct`, or the path of the table without the numbers of entries, for example
        /// `guide.load.on` or `region.fill`.
        table: &'static str,
        /// The name in old files.
        old: &'static str,
        /// The name from now on.
        new: &'static str,
    },
    /// A word that is the value of a setting, or of a key of a table inside a section.
    Word {
        /// The section or the path of the table, as above.
        table: &'static str,
        /// The setting or the key.
        key: &'static str,
        /// The word in old files.
        old: &'static str,
        /// The word from now on.
        new: &'static str,
    },
}

/// All keys and words that were renamed. Rows are never removed, because old job files stay readable.
///
/// ```
/// use grainpath_job::parse_job;
///
/// let job = "[guide]\nmemory_mb = 512\n";
/// let settings = parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
/// assert_eq!(settings.guide.memory_mib, 512);
/// assert_eq!(settings.warnings[0].text, "guide.memory_mb is now called guide.memory_mib");
/// ```
pub const RENAMED: &[Renamed] = &[
    // The value always meant units of 1024 x 1024 bytes; only the name was wrong.
    Renamed::Key { table: "guide", old: "memory_mb", new: "memory_mib" },
];

/// A key that no longer is a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Removed {
    /// The section of the key.
    pub section: &'static str,
    /// The key.
    pub key: &'static str,
    /// Why it is not needed any more, as half a sentence for the warning.
    pub reason: &'static str,
}

const NO_STRUTS: &str = "branches are thick enough to stand alone, see support.side_load_n";

/// All keys that were removed. They are left out with a warning, so that old job files stay readable.
///
/// ```
/// use grainpath_job::parse_job;
///
/// let settings = parse_job("[support]\nbrace = false\n", "job.toml", &[], &|_| Err(String::new())).unwrap();
/// assert!(settings.warnings[0].text.starts_with("support.brace was removed and is left out"));
/// ```
pub const REMOVED: &[Removed] = &[
    // Struts between trunks. Trunks near enough for one join, and the others are stiff by their thickness: on eight meshes
    // with 2 to 87 trees no strut was ever built.
    Removed { section: "support", key: "brace", reason: NO_STRUTS },
    Removed { section: "support", key: "brace_slenderness", reason: NO_STRUTS },
];

/// Why a key was removed; `None` for any other key.
pub(super) fn removed(section: &str, key: &str) -> Option<&'static str> {
    REMOVED.iter().find(|r| (r.section, r.key) == (section, key)).map(|r| r.reason)
}

/// All rows of [`RENAMED`]. Tests add their own, since a kind of row may have no entry yet.
fn rows() -> impl Iterator<Item = &'static Renamed> {
    #[cfg(test)]
    let all = RENAMED.iter().chain(tests::ROWS);
    #[cfg(not(test))]
    let all = RENAMED.iter();
    all
}

/// The new name of a key of a section or table; `None` for a key that was not renamed.
pub(super) fn new_key(table: &str, key: &str) -> Option<&'static str> {
    rows().find_map(|r| match r {
        Renamed::Key { table: t, old, new } if (*t, *old) == (table, key) => Some(*new),
        Renamed::Key { .. } | Renamed::Word { .. } => None,
    })
}

/// The new form of a word; `None` for a word that was not renamed.
pub(super) fn new_word(table: &str, key: &str, word: &str) -> Option<&'static str> {
    rows().find_map(|r| match r {
        Renamed::Word { table: t, key: k, old, new } if (*t, *k, *old) == (table, key, word) => Some(*new),
        Renamed::Key { .. } | Renamed::Word { .. } => None,
    })
}

/// A place inside the value of a setting: its path in the file, and its path with the new names of keys.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Inside {
    /// The path in the file, for lines of messages.
    pub(super) old: Vec<Step>,
    /// The path after renaming.
    pub(super) new: Vec<Step>,
    /// The old and the new word, if the word at this place was renamed and not the key.
    pub(super) word: Option<(String, &'static str)>,
}

impl Inside {
    fn push(&mut self, old: Step, new: Step) {
        self.old.push(old);
        self.new.push(new);
    }

    fn pop(&mut self) {
        self.old.pop();
        self.new.pop();
    }
}

/// The path in the file of a place whose path after renaming is `new`.
pub(super) fn path_in_file(new: &[Step], renamed: &[Inside]) -> Vec<Step> {
    // Outer tables come first in the list, so the last match has the most of the path.
    let found = renamed.iter().rev().find_map(|r| Some((&r.old, new.strip_prefix(r.new.as_slice())?)));
    found.map_or_else(|| new.to_vec(), |(old, rest)| [old.as_slice(), rest].concat())
}

/// Gives the keys and words in the tables of a value their new names. `table` is the path of the value without numbers of
/// entries, `at` its place, which is the same again afterwards. Each key and word that was renamed is added to `renamed`.
///
/// # Errors
/// A key that its table has under both names.
pub(super) fn rename_names(
    table: &str,
    value: &mut Value,
    at: &mut Inside,
    renamed: &mut Vec<Inside>,
) -> Result<(), Inside> {
    match value {
        Value::Array(items) => {
            // The entries of a list are tables of one kind, so rows name them without numbers; messages and lines of
            // the file need the numbers.
            for (i, item) in items.iter_mut().enumerate() {
                at.push(Step::Index(i), Step::Index(i));
                rename_names(table, item, at, renamed)?;
                at.pop();
            }
        }
        Value::Table(rows) => {
            for key in rows.keys().cloned().collect::<Vec<_>>() {
                let new = new_key(table, &key);
                let new_key = new.unwrap_or(&key);
                at.push(Step::Key(key.clone()), Step::Key(new_key.to_owned()));
                if new.is_some() {
                    // Taking either of the two values would lose the other without a word.
                    if rows.contains_key(new_key) {
                        return Err(at.clone());
                    }
                    renamed.push(at.clone());
                    if let Some(inner) = rows.remove(&key) {
                        rows.insert(new_key.to_owned(), inner);
                    }
                }
                if let Some(Value::String(word)) = rows.get_mut(new_key)
                    && let Some(new) = new_word(table, new_key, word)
                {
                    let old = std::mem::replace(word, new.to_owned());
                    renamed.push(Inside { word: Some((old, new)), ..at.clone() });
                }
                if let Some(inner) = rows.get_mut(new_key) {
                    rename_names(&format!("{table}.{new_key}"), inner, at, renamed)?;
                }
                at.pop();
            }
        }
        Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Settings, json_schema};

    /// Renamed keys and words inside tables, of which there are none so far.
    pub(super) const ROWS: &[Renamed] = &[
        Renamed::Key { table: "guide.load", old: "pull_n", new: "force_n" },
        Renamed::Key { table: "guide.load", old: "where", new: "on" },
        Renamed::Key { table: "guide.load.on", old: "ball", new: "sphere" },
        Renamed::Key { table: "guide.case", old: "importance", new: "weight" },
        Renamed::Key { table: "guide.case.load", old: "pull_n", new: "force_n" },
        Renamed::Key { table: "fill.density", old: "least", new: "min" },
        Renamed::Key { table: "region", old: "where", new: "on" },
        Renamed::Key { table: "region.fill", old: "share", new: "density" },
        Renamed::Key { table: "region.fill", old: "style", new: "pattern" },
        Renamed::Word { table: "region.fill", key: "pattern", old: "lines", new: "rectilinear" },
    ];

    /// The keys of a table inside a value, from the schema.
    fn keys_of(table: &str) -> serde_json::Value {
        let inner = |schema: serde_json::Value, key: &str| {
            let schema = schema.get("items").unwrap_or(&schema);
            schema["properties"][key].clone()
        };
        let schema = table.split('.').fold(json_schema(), inner);
        schema.get("items").unwrap_or(&schema)["properties"].clone()
    }

    #[test]
    fn removed_keys_are_no_settings() {
        let params = Settings::params();
        for Removed { section, key, .. } in REMOVED {
            assert!(!params.iter().any(|p| (p.section, p.key) == (*section, *key)), "{section}.{key}");
        }
    }

    /// A row would be dead if its old name were still a setting, and wrong if its new one were none.
    #[test]
    fn old_names_are_gone_and_new_names_exist() {
        let params = Settings::params();
        let is_section = |table: &str| Settings::SECTIONS.contains(&table);
        let find = |section: &str, key: &str| params.iter().find(|p| p.section == section && p.key == key);
        for renamed in rows() {
            match renamed {
                Renamed::Key { table, old, new } if is_section(table) => {
                    assert!(find(table, old).is_none(), "{table}.{old}");
                    assert!(find(table, new).is_some(), "{table}.{new}");
                }
                Renamed::Key { table, old, new } => {
                    let keys = keys_of(table);
                    assert!(keys.get(old).is_none(), "{table}.{old}");
                    assert!(keys.get(new).is_some(), "{table}.{new}");
                }
                Renamed::Word { table, key, old, new } => {
                    let words: Vec<String> = if is_section(table) {
                        let words = find(table, key).map(|p| p.words).unwrap_or_default();
                        words.iter().map(|w| w.name.to_owned()).collect()
                    } else {
                        let listed = keys_of(table)[key]["enum"].as_array().cloned().unwrap_or_default();
                        listed.iter().filter_map(|w| w.as_str().map(str::to_owned)).collect()
                    };
                    assert!(words.iter().all(|w| w != old), "{table}.{key} = {old}");
                    assert!(words.iter().any(|w| w == new), "{table}.{key} = {new}: {words:?}");
                }
            }
        }
    }
}
