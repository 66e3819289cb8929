//! Numbers from raw bytes, base64 and compressed blocks, and node numbers turned into indices.

use std::collections::HashMap;
use std::io::Read;

use super::problem::FeProblem;

/// A type of number in a binary array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    pub(crate) const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number at the beginning of `b`, which is long enough.
    fn take(self, b: &[u8], big: bool) -> f64 {
        macro_rules! number {
            ($t:ty, $n:literal) => {{
                let mut a = [0u8; $n];
                a.copy_from_slice(&b[..$n]);
                // A 64-bit integer above 2^53 loses digits as f64. Such numbers occur only as node
                // labels, and a label that is not exact is refused where it is used.
                (if big { <$t>::from_be_bytes(a) } else { <$t>::from_le_bytes(a) }) as f64
            }};
        }
        match self {
            Self::I8 => number!(i8, 1),
            Self::U8 => number!(u8, 1),
            Self::I16 => number!(i16, 2),
            Self::U16 => number!(u16, 2),
            Self::I32 => number!(i32, 4),
            Self::U32 => number!(u32, 4),
            Self::I64 => number!(i64, 8),
            Self::U64 => number!(u64, 8),
            Self::F32 => number!(f32, 4),
            Self::F64 => number!(f64, 8),
        }
    }

    /// All numbers of this type in `bytes`. Bytes at the end that make no whole number are dropped.
    pub(crate) fn all(self, bytes: &[u8], big: bool) -> Vec<f64> {
        bytes.chunks_exact(self.bytes()).map(|b| self.take(b, big)).collect()
    }
}

/// Walks through bytes number by number.
pub(crate) struct Raw<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) big: bool,
}

impl<'a> Raw<'a> {
    pub(crate) fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.bytes.split_at_checked(n)?;
        self.bytes = tail;
        Some(head)
    }

    pub(crate) fn number(&mut self, scalar: Scalar) -> Option<f64> {
        let big = self.big;
        self.take(scalar.bytes()).map(|b| scalar.take(b, big))
    }
}

/// Decodes base64 that may be broken into lines. VTK encodes the header and the data of an array apart,
/// so padding may stand in the middle.
/// Stops after `limit` bytes or at the first character that is not base64.
pub(crate) fn base64(text: &[u8], limit: usize) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => Some(c - b'A'),
        b'a'..=b'z' => Some(c - b'a' + 26),
        b'0'..=b'9' => Some(c - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    // The capacity follows from the text alone: a `limit` from a damaged header must not reserve memory.
    let mut out = Vec::with_capacity((text.len() / 4 * 3).min(limit));
    let (mut word, mut n, mut pad) = (0u32, 0, 0);
    for &c in text {
        if c.is_ascii_whitespace() {
            continue;
        }
        let bits = match value(c) {
            // RFC 4648, section 4: `=` may stand only in the last two places of a group of four, and no
            // letter may follow it inside the group.
            Some(v) if pad == 0 => u32::from(v),
            None if c == b'=' && n >= 2 => {
                pad += 1;
                0
            }
            _ => break,
        };
        word = word << 6 | bits;
        n += 1;
        if n == 4 {
            // Four characters hold three bytes of data. Each padding character takes one of these away.
            out.extend_from_slice(&word.to_be_bytes()[1..4 - pad]);
            (word, n, pad) = (0, 0, 0);
            if out.len() >= limit {
                break;
            }
        }
    }
    out.truncate(limit);
    out
}

/// Compression of blocks of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compression {
    /// A zlib stream.
    Zlib,
    /// An xz stream, which VTK calls LZMA.
    Xz,
    /// A block of LZ4 without a frame.
    Lz4,
}

/// Memory limit of the xz decoder, KiB. A larger dictionary is refused, since a header may ask for 4 GiB.
/// Source: xz(1), table of presets; the largest dictionary of a preset is 64 MiB and its decoder takes 65
/// MiB.
const XZ_MEMORY_KIB: u32 = 80 << 10;

/// Decompresses a block and appends it; the block must hold exactly `size` bytes. Never reserves more
/// than that.
pub(crate) fn decompress(
    packed: &[u8],
    compression: Compression,
    size: usize,
    out: &mut Vec<u8>,
) -> Result<(), FeProblem> {
    let before = out.len();
    // One byte more than expected is read, so that a block that is too long is noticed.
    let limit = size as u64 + 1;
    let read = match compression {
        Compression::Zlib => flate2::read::ZlibDecoder::new(packed).take(limit).read_to_end(out),
        Compression::Xz => {
            lzma_rust2::XzReader::new_mem_limit(packed, false, XZ_MEMORY_KIB).take(limit).read_to_end(out)
        }
        Compression::Lz4 => {
            // A length in LZ4 grows by at most 255 for each byte that encodes it (LZ4 block format,
            // "Literals" and "Match"), so a longer claim is false. Without this test `resize` below would
            // reserve what the header claims.
            if size / 255 > packed.len() {
                return Err(FeProblem::PackedTooShort { packed: packed.len(), size });
            }
            out.resize(before + size, 0);
            let n =
                lz4_flex::block::decompress_into(packed, &mut out[before..]).map_err(std::io::Error::other);
            if let Ok(n) = n {
                out.truncate(before + n);
            }
            n
        }
    };
    let compression = format!("{compression:?}");
    if let Err(e) = read {
        return Err(FeProblem::PackedDamaged { compression, reason: e.to_string() });
    }
    match out.len() - before {
        n if n == size => Ok(()),
        found => Err(FeProblem::PackedLength { compression, found, size }),
    }
}

/// Maps the numbers that a file gives its nodes or elements to indices from 0.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    /// Index by number. The table holds numbers that are at most a few times the count of entries.
    table: Vec<u32>,
    /// Index of all other numbers.
    rest: HashMap<i64, u32>,
    len: u32,
}

impl Numbers {
    const NONE: u32 = u32::MAX;

    /// Gives `number` the next index; `None` when it has one already.
    pub(crate) fn insert(&mut self, number: i64) -> Option<u32> {
        if self.get(number).is_some() || self.len == Self::NONE {
            return None;
        }
        let index = self.len;
        match usize::try_from(number) {
            // The table grows only up to eight times the entries read so far: one node with number 2 000
            // 000 000 must not allocate 8 GB. Numbers beyond that go to the hash map.
            Ok(n) if n < 64 + 8 * index as usize => {
                if self.table.len() <= n {
                    self.table.resize(n + 1, Self::NONE);
                }
                self.table[n] = index;
            }
            _ => {
                self.rest.insert(number, index);
            }
        }
        self.len += 1;
        Some(index)
    }

    pub(crate) fn get(&self, number: i64) -> Option<u32> {
        let quick = usize::try_from(number).ok().and_then(|n| self.table.get(n)).copied();
        match quick {
            Some(i) if i != Self::NONE => Some(i),
            _ if self.rest.is_empty() => None,
            _ => self.rest.get(&number).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_with_padding_inside() {
        assert_eq!(base64(b"aGk=aGVs\nbG8=", 100), b"hihello");
        assert_eq!(base64(b"aGk=aGVsbG8=", 4), b"hihe");
        assert_eq!(base64(b"aGVsbG8h<", 100), b"hello!");
        assert_eq!(base64(b"a=bc", 100), b"");
        assert_eq!(base64(b"aG=k", 100), b"");
    }

    #[test]
    fn numbers_far_apart_and_twice() {
        let mut all = Numbers::default();
        for (i, n) in [5, 1, 7_000_000_000, 100, -3, 400].into_iter().enumerate() {
            assert_eq!(all.insert(n), Some(i as u32));
        }
        assert_eq!(all.insert(100), None);
        let found: Vec<_> = [5, 1, 7_000_000_000, 100, -3, 400, 2].map(|n| all.get(n)).to_vec();
        assert_eq!(found, [Some(0), Some(1), Some(2), Some(3), Some(4), Some(5), None]);
    }

    #[test]
    fn both_ends_of_numbers() {
        assert_eq!(Scalar::I16.all(&[1, 0, 255, 255], false), [1.0, -1.0]);
        assert_eq!(Scalar::U16.all(&[1, 0, 255], true), [256.0]);
        assert_eq!(Scalar::F64.all(&1.5f64.to_be_bytes(), true), [1.5]);
    }
}
