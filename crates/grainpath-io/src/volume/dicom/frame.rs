//! What comes out of packed pixels: grey values, or why there are none.

/// The grey values of a frame, row after row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Frame {
    /// A pixel each, in its low `bits`; what stands above them has no meaning.
    pub(super) patterns: Vec<u32>,
    /// Bits of a value.
    pub(super) bits: u32,
    /// Whether the packed pixels say themselves that values have a sign. Where they do not, the header says it.
    pub(super) signed: bool,
}

/// Why a frame cannot be unpacked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Fault {
    /// The bytes are not what their format requires.
    Damaged(String),
    /// The format allows it, and it is not read.
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
