//! The elements of a DICOM file, one after another.
//!
//! Source: DICOM PS3.5, 7 (elements, sequences). Every read is bounded by the file: a value is held in memory only up to a
//! limit, whatever length the element states, and elements that are not needed are skipped.

use std::io::{BufRead, Read, Seek};

use super::super::{ReadSeek, VolumeError, damaged, io_error};
use super::FORMAT;

/// An item of a sequence.
// Source: PS3.5, 7.5.1, table 7.5-1.
pub(super) const ITEM: u32 = 0xfffe_e000;
/// The end of an item of unknown length.
// Source: PS3.5, 7.5.1, table 7.5-1.
const END_OF_ITEM: u32 = 0xfffe_e00d;
/// The end of a sequence of unknown length.
// Source: PS3.5, 7.5.1, table 7.5-1.
pub(super) const END_OF_SEQUENCE: u32 = 0xfffe_e0dd;

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
                (END_OF_SEQUENCE | END_OF_ITEM, _) => depth -= 1,
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

    /// Reads a sequence item by item. `item` is given the length of each and reads it to its end.
    pub(super) fn sequence(
        &mut self,
        length: u32,
        mut item: impl FnMut(&mut Self, u32) -> Result<(), VolumeError>,
    ) -> Result<(), VolumeError> {
        let end = self.end_of(length)?;
        while !self.is_at(end)? {
            let e = self.element()?;
            match e.tag {
                ITEM => item(self, e.length)?,
                END_OF_SEQUENCE if end.is_none() => break,
                _ => return Err(self.damaged("something else between the items of a sequence")),
            }
        }
        Ok(())
    }

    /// Reads the elements of an item. `element` returns `false` for those that it leaves unread.
    pub(super) fn item(
        &mut self,
        length: u32,
        mut element: impl FnMut(&mut Self, &Element) -> Result<bool, VolumeError>,
    ) -> Result<(), VolumeError> {
        let end = self.end_of(length)?;
        while !self.is_at(end)? {
            let e = self.element()?;
            if e.tag == END_OF_ITEM && end.is_none() {
                break;
            }
            match (element(self, &e)?, e.length) {
                (true, _) => {}
                (false, u32::MAX) => self.skip_sequence()?,
                (false, n) => self.skip(n)?,
            }
        }
        Ok(())
    }

    /// The end of a value of this length; `None` if a delimiter ends it.
    fn end_of(&mut self, length: u32) -> Result<Option<u64>, VolumeError> {
        let begin = self.position()?;
        Ok((length != u32::MAX).then(|| begin + u64::from(length)))
    }

    fn is_at(&mut self, end: Option<u64>) -> Result<bool, VolumeError> {
        let Some(end) = end else { return Ok(false) };
        let at = self.position()?;
        if at > end { Err(self.damaged("a sequence longer than it states")) } else { Ok(at == end) }
    }

    /// The place in the file.
    pub(super) fn position(&mut self) -> Result<u64, VolumeError> {
        self.reader.stream_position().map_err(|e| io_error(self.name, &e))
    }

    pub(super) fn at_end(&mut self) -> bool {
        self.reader.fill_buf().map_or(true, <[u8]>::is_empty)
    }
}
