//! Fragments of packed pixels, and which of them make a frame.
//!
//! Source: DICOM PS3.5, A.4. A file that packs its pixels has a table of offsets, which may be empty, and then fragments. A
//! single frame takes all fragments. If there are as many fragments as frames, each frame takes one. Otherwise the table
//! says where frames begin, or the first bytes of the fragments do. Only positions and lengths are kept; reading costs one
//! seek for each fragment.

use std::io::Read;

use super::super::files::MAX_FILE;
use super::super::{Files, MAX_SLICES, VolumeError, VolumeProblem, error, io_error};
use super::codec::Codec;
use super::data_elements::{END_OF_SEQUENCE, ITEM, Parser};

/// Limit on the fragments of a file. Source: derived. Four fragments for each frame of the largest file that is read.
const MAX_FRAGMENTS: usize = 4 * MAX_SLICES;

/// Packed pixels of a file.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    pub(super) codec: Codec,
    /// Place in the file and length.
    fragments: Vec<(u64, u32)>,
    /// The first fragment of each frame.
    begins: Vec<usize>,
}

impl Packed {
    /// Reads the positions of the fragments. The parser must stand just behind the head of the pixel element.
    pub(super) fn read(parser: &mut Parser<'_>, codec: Codec, n_frames: usize) -> Result<Self, VolumeError> {
        let table = parser.element()?;
        if table.tag != ITEM {
            return Err(parser.damaged("packed pixels without a table of offsets"));
        }
        let table = parser.value_up_to(table.length, 4 * MAX_SLICES as u32)?;
        let table: Vec<u64> = table.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b).into()).collect();
        let (mut fragments, mut starts) = (Vec::new(), Vec::new());
        let begin = parser.position()?;
        while !parser.at_end() {
            let item = parser.element()?;
            match item.tag {
                END_OF_SEQUENCE => break,
                ITEM if item.length != u32::MAX => {}
                _ => return Err(parser.damaged("something else between the fragments of the pixels")),
            }
            let at = parser.position()?;
            let first = parser.value(item.length.min(2))?;
            // The markers that begin a picture: SOI of JPEG and JPEG-LS, SOC of JPEG 2000.
            if first == [0xff, 0xd8] || first == [0xff, 0x4f] {
                starts.push(fragments.len());
            }
            parser.skip(item.length - first.len() as u32)?;
            fragments.push((at, item.length));
            if fragments.len() > MAX_FRAGMENTS {
                return Err(parser.damaged(&format!("more than {MAX_FRAGMENTS} fragments of pixels")));
            }
        }
        if fragments.is_empty() {
            return Err(parser.damaged("packed pixels without a fragment"));
        }
        // Offsets count from the item of the first fragment; `fragments` holds positions behind its head of eight bytes.
        let place = |offset: &u64| fragments.binary_search_by_key(&(begin + offset + 8), |f| f.0).ok();
        let tabled: Option<Vec<usize>> = table.iter().map(place).collect();
        let tabled = tabled.filter(|t| t.len() == n_frames && t[0] == 0 && t.is_sorted_by(|a, b| a < b));
        let begins = if n_frames == 1 {
            vec![0]
        } else if fragments.len() == n_frames {
            (0..n_frames).collect()
        } else if let Some(tabled) = tabled {
            tabled
        } else if starts.len() == n_frames && starts[0] == 0 {
            starts
        } else {
            let n = fragments.len();
            return Err(
                parser.damaged(&format!("{n} fragments of pixels cannot be told apart as {n_frames} frames"))
            );
        };
        Ok(Self { codec, fragments, begins })
    }

    /// The packed bytes of a frame.
    pub(super) fn frame(&self, files: &Files, name: &str, frame: usize) -> Result<Vec<u8>, VolumeError> {
        let last = self.begins.get(frame + 1).copied().unwrap_or(self.fragments.len());
        let fragments = &self.fragments[self.begins[frame]..last];
        let needed: u64 = fragments.iter().map(|f| u64::from(f.1)).sum();
        if needed > MAX_FILE {
            return Err(error(name, VolumeProblem::FileTooLarge { limit: MAX_FILE }));
        }
        let mut reader = files.open(name)?;
        let mut bytes = Vec::new();
        let mut place = 0;
        for &(at, length) in fragments {
            // A relative seek keeps the buffered bytes, which saves reads when fragments are short.
            reader.seek_relative((at - place) as i64).map_err(|e| io_error(name, &e))?;
            (&mut reader).take(length.into()).read_to_end(&mut bytes).map_err(|e| io_error(name, &e))?;
            place = at + u64::from(length);
        }
        if (bytes.len() as u64) < needed {
            let problem = VolumeProblem::PixelsCutShort { found: bytes.len(), needed: needed as usize };
            return Err(error(name, problem));
        }
        Ok(bytes)
    }

    /// What a message calls the packed pixels of a frame.
    pub(super) fn name_of(&self, frame: usize) -> String {
        let name = self.codec.name();
        if self.begins.len() > 1 {
            format!("{name} pixels of frame {}", frame + 1)
        } else {
            format!("{name} pixels")
        }
    }
}
