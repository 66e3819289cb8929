//! The result of unpacking pixels: grey values, or the reason why unpacking failed.

/// The grey values of a frame, row after row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Frame {
    /// One number for each pixel. The value is in the low `bits`; the bits above them have no meaning.
    pub(super) patterns: Vec<u32>,
    /// Bits of a value.
    pub(super) bits: u32,
    /// Whether the packed pixels state that values have a sign. If they state nothing, the header decides.
    pub(super) signed: bool,
}

/// Why a frame cannot be unpacked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Fault {
    /// The bytes are not what their format requires.
    Damaged(String),
    /// The format allows these bytes, but this reader does not support them.
    Unsupported(String),
}

impl From<&str> for Fault {
    fn from(reason: &str) -> Self {
        Self::Damaged(reason.to_owned())
    }
}

impl From<String> for Fault {
    fn from(reason: String) -> Self {
        Self::Damaged(reason)
    }
}
