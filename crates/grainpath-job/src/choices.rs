//! Values a setting can have that are neither numbers nor free text.

/// Grey value at which the part begins in a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// By the histogram, Otsu 1979.
    Otsu,
    /// Halfway between the two commonest materials, found or given.
    Iso50(Option<[f64; 2]>),
    /// From this grey value up.
    Value(f64),
    /// Between these.
    Range(f64, f64),
}

/// The names of the patterns for the inside.
pub const PATTERNS: [&str; 11] = [
    "rectilinear",
    "grid",
    "triangles",
    "gyroid",
    "concentric",
    "honeycomb",
    "aligned",
    "stripes",
    "streamlines",
    "seed-lines",
    "continuous",
];

/// Those of them that follow a direction field.
pub const GUIDED: [&str; 4] = ["stripes", "streamlines", "seed-lines", "continuous"];
