//! Profiles that are shipped with the program, as data.

/// A profile: preset values for the keys of one section, as TOML.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Profile {
    /// Section of the keys: `printer`, `material` or `process`.
    pub kind: &'static str,
    /// Name in job files.
    pub name: &'static str,
    /// Keys as TOML. The first line is a comment with the purpose of the profile.
    pub text: &'static str,
}

impl Profile {
    /// Purpose of the profile, from its first line.
    pub fn about(&self) -> &'static str {
        // The first comment line of a profile is its only description.
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }
}

/// Sections that have profiles, each with its default profile.
pub(super) const KINDS: [(&str, &str); 3] =
    [("printer", "generic-0.4"), ("material", "pla"), ("process", "standard")];

// The files are embedded at compile time, so that the program runs without any data directory.
macro_rules! shipped {
    ($($kind:literal $name:literal),* $(,)?) => {
        [$(Profile { kind: $kind, name: $name, text: include_str!(concat!("../profiles/", $kind, "/", $name, ".toml")) }),*]
    };
}

/// All profiles that are shipped.
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

/// The shipped profiles of a kind.
pub fn profiles_of(kind: &str) -> impl Iterator<Item = &'static Profile> {
    PROFILES.iter().filter(move |p| p.kind == kind)
}

/// The shipped profile of this kind and name.
pub fn profile(kind: &str, name: &str) -> Option<&'static Profile> {
    profiles_of(kind).find(|p| p.name == name)
}

/// The default profile of a kind, for jobs that do not name one.
pub fn default_profile(kind: &str) -> Option<&'static Profile> {
    KINDS.iter().find(|(k, _)| *k == kind).and_then(|(_, name)| profile(kind, name))
}
