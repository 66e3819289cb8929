//! The elements of a DICOM file, one after another.
//!
//! Source: DICOM PS3.5, 7 (elements, sequences). Every read is bounded by the file: a value is held in memory only up to a
//! limit, whatever length the element states, and elements that are not needed are skipped.

use std::io::{BufRead, Read, Seek};

use super::super::{ReadSeek, VolumeError, damaged, io_error};
use super::FORMAT;

/// An element: its tag and the length of its value; `u32::MAX` stands for an unknown length.
pub(super) struct Element {
    pub(super) tag: u32,
    pub(super) length: u32,
}

/// Reads elements one after another.
pub(super) struct Parser<'a> {
    pub(super) reader: std::io::BufReader<Box<dyn ReadSeek>>,
    /// The file's name, for messages.
    pub(super) name: &'a str,
    /// Elements state no value representation.
    pub(super) implicit: bool,
    pub(super) big_endian: bool,
}

impl Parser<'_> {
    pub(super) fn damaged(&self, what: &str) -> VolumeError {
        damaged(self.name, FORMAT, what)
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], VolumeError> {
        let mut b = [0; N];
        self.reader.read_exact(&mut b).map_err(|_| self.damaged("it ends before the pixels"))?;
        Ok(b)
    }

    fn u16(&mut self) -> Result<u16, VolumeError> {
        let b = self.bytes()?;
        Ok(if self.big_endian { u16::from_be_bytes(b) } else { u16::from_le_bytes(b) })
    }

    fn u32(&mut self) -> Result<u32, VolumeError> {
        let b = self.bytes()?;
        Ok(if self.big_endian { u32::from_be_bytes(b) } else { u32::from_le_bytes(b) })
    }

    pub(super) fn element(&mut self) -> Result<Element, VolumeError> {
        let (group, number) = (self.u16()?, self.u16()?);
        let tag = u32::from(group) << 16 | u32::from(number);
        // Items and delimiters have no value representation, in no syntax (PS3.5, 7.5).
        if self.implicit || group == 0xfffe {
            return Ok(Element { tag, length: self.u32()? });
        }
        let vr: [u8; 2] = self.bytes()?;
        // These have two reserved bytes and a length of 32 bits (PS3.5, 7.1.2); all others a length of 16
        // bits.
        let long =
            [b"OB", b"OW", b"OF", b"OD", b"OL", b"SQ", b"UC", b"UR", b"UT", b"UN", b"OV", b"SV", b"UV"];
        let length = if long.contains(&&vr) {
            self.u16()?;
            self.u32()?
        } else {
            u32::from(self.u16()?)
        };
        Ok(Element { tag, length })
    }

    pub(super) fn value(&mut self, length: u32) -> Result<Vec<u8>, VolumeError> {
        // Every header value that is read fits into this limit.
        self.value_up_to(length, 1 << 16)
    }

    /// A value of at most `limit` bytes. The limit stops a damaged length from reserving 4 GB.
    pub(super) fn value_up_to(&mut self, length: u32, limit: u32) -> Result<Vec<u8>, VolumeError> {
        if length > limit {
            return Err(self.damaged(&format!("a value of {length} bytes, where {limit} are the most")));
        }
        let mut bytes = Vec::new();
        let read = (&mut self.reader).take(length.into()).read_to_end(&mut bytes);
        read.map_err(|e| io_error(self.name, &e))?;
        if bytes.len() < length as usize {
            return Err(self.damaged("it ends in a value"));
        }
        Ok(bytes)
    }

    pub(super) fn skip(&mut self, length: u32) -> Result<(), VolumeError> {
        self.reader.seek_relative(length.into()).map_err(|e| io_error(self.name, &e))
    }

    /// Skips a sequence of unknown length with everything nested in it.
    pub(super) fn skip_sequence(&mut self) -> Result<(), VolumeError> {
        let mut depth = 1usize;
        while depth > 0 {
            let e = self.element()?;
            match (e.tag, e.length) {
                // Delimiters of a sequence and of an item.
                (0xfffe_e0dd | 0xfffe_e00d, _) => depth -= 1,
                (_, u32::MAX) => depth += 1,
                // An item of known length is skipped with its contents.
                (_, n) => self.skip(n)?,
            }
            // A level takes only a few bytes of the file, so a damaged file could nest very deeply.
            if depth > 64 {
                return Err(self.damaged("sequences nested more than 64 deep"));
            }
        }
        Ok(())
    }

    /// The place in the file.
    pub(super) fn position(&mut self) -> Result<u64, VolumeError> {
        self.reader.stream_position().map_err(|e| io_error(self.name, &e))
    }

    pub(super) fn at_end(&mut self) -> bool {
        self.reader.fill_buf().map_or(true, <[u8]>::is_empty)
    }
}
