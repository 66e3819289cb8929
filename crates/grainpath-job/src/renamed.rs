//! Keys and words that were renamed. Files with the old names are still read.

/// A key or a word with a new name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Renamed {
    /// A key of a section.
    Key {
        /// The section of the key, for example `shape.ct`.
        section: &'static str,
        /// The name in old files.
        old: &'static str,
        /// The name from now on.
        new: &'static str,
    },
    /// One of the words that a setting allows.
    Word {
        /// The section of the setting.
        section: &'static str,
        /// The setting.
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
    Renamed::Key { section: "guide", old: "memory_mb", new: "memory_mib" },
];

/// The new name of a key; `None` for a key that was not renamed.
pub(super) fn new_key(section: &str, key: &str) -> Option<&'static str> {
    RENAMED.iter().find_map(|r| match r {
        Renamed::Key { section: s, old, new } if (*s, *old) == (section, key) => Some(*new),
        Renamed::Key { .. } | Renamed::Word { .. } => None,
    })
}

/// The new form of a word; `None` for a word that was not renamed.
pub(super) fn new_word(section: &str, key: &str, word: &str) -> Option<&'static str> {
    RENAMED.iter().find_map(|r| match r {
        Renamed::Word { section: s, key: k, old, new } if (*s, *k, *old) == (section, key, word) => {
            Some(*new)
        }
        Renamed::Key { .. } | Renamed::Word { .. } => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;

    /// A row would be dead if its old name were still a setting, and wrong if its new one were none.
    #[test]
    fn old_names_are_gone_and_new_names_exist() {
        let params = Settings::params();
        let find = |section: &str, key: &str| params.iter().find(|p| p.section == section && p.key == key);
        for renamed in RENAMED {
            match renamed {
                Renamed::Key { section, old, new } => {
                    assert!(find(section, old).is_none(), "{section}.{old}");
                    assert!(find(section, new).is_some(), "{section}.{new}");
                }
                Renamed::Word { section, key, old, new } => {
                    let words = find(section, key).map(|p| p.words).unwrap_or_default();
                    assert!(words.iter().all(|w| w.name != *old), "{section}.{key} = {old}");
                    assert!(words.iter().any(|w| w.name == *new), "{section}.{key} = {new}");
                }
            }
        }
    }
}
