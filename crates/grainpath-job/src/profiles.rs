//! Profiles that come with the program, as data.

/// One profile: a table of keys of its section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Profile {
    /// printer, material or process.
    pub kind: &'static str,
    /// What a job calls it.
    pub name: &'static str,
    /// Its keys as TOML; the first comment line says what it is for.
    pub text: &'static str,
}

impl Profile {
    /// What it is for.
    pub fn about(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }
}

/// Kinds of profiles, and which one is taken when a job names none.
pub(super) const KINDS: [(&str, &str); 3] =
    [("printer", "generic-0.4"), ("material", "pla"), ("process", "standard")];

macro_rules! shipped {
    ($($kind:literal $name:literal),* $(,)?) => {
        [$(Profile { kind: $kind, name: $name, text: include_str!(concat!("../profiles/", $kind, "/", $name, ".toml")) }),*]
    };
}

/// All that come with the program.
pub const PROFILES: [Profile; 17] = shipped![
    "printer" "generic-0.4",
    "printer" "generic-0.6",
    "printer" "prusa-mk3s",
    "printer" "voron-2.4",
    "printer" "duet-delta",
    "printer" "fibre-coextruded",
    "printer" "fibre-separate",
    "material" "pla",
    "material" "petg",
    "material" "abs",
    "material" "pa-cf",
    "material" "continuous-carbon",
    "process" "standard",
    "process" "fine",
    "process" "draft",
    "process" "strong",
    "process" "wide",
];

/// The shipped profile of this kind and name.
pub fn profile(kind: &str, name: &str) -> Option<&'static Profile> {
    PROFILES.iter().find(|p| p.kind == kind && p.name == name)
}
