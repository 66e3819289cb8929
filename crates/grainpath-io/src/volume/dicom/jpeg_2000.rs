//! JPEG 2000 of one component, reversible and irreversible, up to 16 bits.
//!
//! Method: the crate hayro-jpeg2000 decodes the stream. Before it begins, this module follows all markers from the first to
//! the last. It compares what they state with the header of the file: the size, the depth, the number of pieces that the
//! picture is coded in, and whether every tile is present. So a few bytes cannot ask for more memory than the stated slice
//! needs, and a missing tile cannot be read as air.
//!
//! Source: ISO/IEC 15444-1, annex A (markers), B.6 and B.7 (precincts, code-blocks). DICOM's transfer syntaxes
//! 1.2.840.10008.1.2.4.90 and .91 use this format.
//!
//! Cost: one pass over the markers, then the decoder, which takes about 16 bytes of memory for each pixel. Limits: values
//! are computed in f32, whose 24 bits hold coefficients of 16 bits exactly; deeper pictures are refused. The wrapper of JP2
//! files is skipped, with its palette and colours.

use hayro_jpeg2000::{ComponentData, DecodeSettings, DecoderContext, Image};

use super::unpacked::{Fault, Frame};

/// The first bytes of a stream: the markers SOC and SIZ.
// Source: ISO/IEC 15444-1, A.4.1 and A.5.1; SIZ stands directly behind SOC.
const START: [u8; 4] = [0xff, 0x4f, 0xff, 0x51];
/// Markers, without their 0xff: coding style (COD), that of a component (COC), start of a tile-part (SOT), start of data
/// (SOD), end of the stream (EOC).
// Source: ISO/IEC 15444-1, table A.2.
const CODING: u8 = 0x52;
// Source: ISO/IEC 15444-1, table A.2.
const CODING_OF_COMPONENT: u8 = 0x53;
// Source: ISO/IEC 15444-1, table A.2.
const TILE_PART: u8 = 0x90;
// Source: ISO/IEC 15444-1, table A.2.
const DATA: u8 = 0x93;
// Source: ISO/IEC 15444-1, table A.2.
const END: u8 = 0xd9;
/// Largest number of tiles. Source: ISO/IEC 15444-1, A.4.2: the number of a tile has 16 bits.
const MAX_TILES: u64 = 65535;
/// Largest number of precincts and code-blocks. Source: derived. The largest slice has 2^18 code-blocks of 16 x 16 pixels;
/// encoders write 32 x 32 or 64 x 64. Measured: the decoder takes up to 500 bytes of memory for a piece.
const MAX_PIECES: u64 = 1 << 20;

/// Unpacks a frame.
pub(super) fn unpack(bytes: &[u8], size: [usize; 2]) -> Result<Frame, Fault> {
    // Some writers leave the boxes of a JP2 file around the stream.
    let begin = bytes.windows(4).position(|w| w == START).ok_or("no picture in them")?;
    let bytes = &bytes[begin..];
    let picture = Picture::read(bytes, size)?;
    picture.check(bytes)?;
    // With lenient settings the decoder would fill damaged places with zeros.
    let settings = DecodeSettings { strict: true, ..DecodeSettings::default() };
    let mut context = DecoderContext::default();
    let image = Image::new(bytes, &settings).map_err(|e| e.to_string())?;
    let decoded = image.decode(&mut context).map_err(|e| e.to_string())?;
    let samples = decoded.components().first().map(ComponentData::samples).unwrap_or_default();
    if samples.len() != size[0] * size[1] {
        return Err("fewer pixels than its header states".into());
    }
    let Picture { bits, signed, .. } = picture;
    // The decoder adds half the range to signed values as well.
    let (least, shift) = if signed { (-(1i64 << (bits - 1)), 1i64 << (bits - 1)) } else { (0, 0) };
    let most = least + (1 << bits) - 1;
    let pattern = |v: &f32| ((v + 0.5).floor() as i64 - shift).clamp(least, most) as u32;
    Ok(Frame { patterns: samples.iter().map(pattern).collect(), bits, signed })
}

fn short() -> Fault {
    "they end early".into()
}

fn word(bytes: &[u8], at: usize) -> Result<u64, Fault> {
    let b: [u8; 4] = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).ok_or_else(short)?;
    Ok(u32::from_be_bytes(b).into())
}

/// The two bytes of a marker or a length.
fn pair(bytes: &[u8], at: usize) -> Result<[u8; 2], Fault> {
    bytes.get(at..at + 2).and_then(|b| b.try_into().ok()).ok_or_else(short)
}

/// What the first segment states.
struct Picture {
    bits: u32,
    signed: bool,
    /// Pixels of the largest tile along either side, and the number of tiles.
    tile: [u64; 2],
    n_tiles: u64,
}

impl Picture {
    /// Reads the segment SIZ (A.5.1) of a picture that must have `size`, columns first.
    fn read(bytes: &[u8], size: [usize; 2]) -> Result<Self, Fault> {
        // Byte positions of four fields: end of the picture, its beginning, size of the tiles, beginning of the first tile.
        let both = |at: usize| -> Result<[u64; 2], Fault> { Ok([word(bytes, at)?, word(bytes, at + 4)?]) };
        let (ends, begins, tile, first) = (both(8)?, both(16)?, both(24)?, both(32)?);
        let stated: [u64; 2] = std::array::from_fn(|k| ends[k].saturating_sub(begins[k]));
        if stated != size.map(|n| n as u64) {
            let [w, h] = stated;
            let [columns, rows] = size;
            return Err(
                format!("a picture of {w} x {h} pixels, where the file states {columns} x {rows}").into()
            );
        }
        let &[high, low, depth, step_x, step_y] = bytes.get(40..45).ok_or_else(short)? else {
            return Err(short());
        };
        let n_components = u16::from_be_bytes([high, low]);
        if n_components != 1 {
            let what = format!("{n_components} components; slices of grey values have one");
            return Err(Fault::Unsupported(what));
        }
        if [step_x, step_y] != [1, 1] {
            return Err(Fault::Unsupported("pixels with gaps between them".to_owned()));
        }
        let bits = u32::from(depth & 0x7f) + 1;
        if bits > 16 {
            return Err(Fault::Unsupported(format!("{bits} bits; up to 16 are read")));
        }
        if tile.contains(&0) || (0..2).any(|k| first[k] > begins[k]) {
            return Err("tiles that do not cover the picture".into());
        }
        let along = [0, 1].map(|k| (ends[k] - first[k]).div_ceil(tile[k]));
        let n_tiles = along[0].saturating_mul(along[1]);
        if n_tiles > MAX_TILES {
            return Err("more tiles than can be numbered".into());
        }
        let tile = std::array::from_fn(|k| tile[k].min(stated[k]));
        Ok(Self { bits, signed: depth >> 7 == 1, tile, n_tiles })
    }

    /// Follows the markers from the first to the last. Every tile must be there, and no more pieces than [`MAX_PIECES`].
    fn check(&self, bytes: &[u8]) -> Result<(), Fault> {
        let mut at = self.segments(bytes, 2, TILE_PART)?;
        let mut there = vec![false; self.n_tiles as usize];
        loop {
            let [0xff, marker] = pair(bytes, at)? else { return Err("bytes between two tiles".into()) };
            if marker == END {
                break;
            }
            if marker != TILE_PART {
                return Err("something else between two tiles".into());
            }
            // Number of the tile, and bytes of this part from its marker on; 0 means up to the end.
            let number = usize::from(u16::from_be_bytes(pair(bytes, at + 4)?));
            let length = word(bytes, at + 6)? as usize;
            *there.get_mut(number).ok_or("a tile with an impossible number")? = true;
            let data = self.segments(bytes, at, DATA)?;
            let next = if length == 0 {
                let ends = bytes[data..].windows(2).rposition(|w| w == [0xff, END]);
                data + ends.ok_or_else(short)?
            } else {
                at + length
            };
            if next <= data {
                return Err("a tile that ends before it begins".into());
            }
            at = next;
        }
        match there.iter().filter(|t| !**t).count() {
            0 => Ok(()),
            n => Err(format!("{n} of {} tiles are missing", self.n_tiles).into()),
        }
    }

    /// Follows the segments from `at` on and returns the position of the marker `last`.
    fn segments(&self, bytes: &[u8], mut at: usize, last: u8) -> Result<usize, Fault> {
        loop {
            let [0xff, marker] = pair(bytes, at)? else { return Err("bytes between two segments".into()) };
            if marker == last {
                return Ok(at);
            }
            let length = usize::from(u16::from_be_bytes(pair(bytes, at + 2)?));
            let content = bytes.get(at + 4..at + 2 + length).ok_or_else(short)?;
            match (marker, content) {
                // Whether precincts are stated, order, layers and colours, then the parameters (A.6.1).
                (CODING, [style, _, _, _, _, parameters @ ..]) => self.pieces(*style, parameters)?,
                // The component, the style, then the parameters (A.6.2).
                (CODING_OF_COMPONENT, [_, style, parameters @ ..]) => self.pieces(*style, parameters)?,
                (CODING | CODING_OF_COMPONENT, _) => return Err(short()),
                _ => {}
            }
            at += 2 + length;
        }
    }

    /// Counts the pieces that the picture has with these parameters. They are the levels, the exponents of the code-block
    /// sides, two more numbers, and for each level the exponents of the precinct sides (table A.15).
    fn pieces(&self, style: u8, parameters: &[u8]) -> Result<(), Fault> {
        let &[levels, wide, high, _, _, ref precincts @ ..] = parameters else { return Err(short()) };
        // Source: table A.13: at most 32 levels.
        if levels > 32 {
            return Err("more than 32 levels".into());
        }
        let mut n_pieces = 0u64;
        for level in 0..=levels {
            let stated =
                if style & 1 == 1 { *precincts.get(usize::from(level)).ok_or_else(short)? } else { 0xff };
            let n_of_tile = |exponents: [u32; 2]| -> u64 {
                let along = [0, 1].map(|k| {
                    let pixels = self.tile[k].div_ceil(1 << (levels - level));
                    // The picture's border may lie anywhere in a piece, so one more piece may begin.
                    pixels.div_ceil(1 << exponents[k]) + 1
                });
                along[0].saturating_mul(along[1])
            };
            let precinct = [stated & 15, stated >> 4].map(u32::from);
            // The three bands of a level above the lowest have half of its pixels along a side, and so have their precincts.
            let block = [wide, high].map(|b| u32::from(b & 15) + 2);
            let block = [0, 1].map(|k| block[k].min(precinct[k].saturating_sub(u32::from(level > 0))));
            n_pieces = n_pieces.saturating_add(n_of_tile(precinct)).saturating_add(n_of_tile(block));
        }
        if n_pieces.saturating_mul(self.n_tiles) > MAX_PIECES {
            return Err("more pieces than its pixels need".into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The markers of a stream: a picture of `size` with tiles of `tile` pixels along a side, sides of code-blocks, and
    /// sides of precincts where they are stated; the tiles `there` have no data.
    fn stream(size: u32, tile: u32, block: u8, precincts: Option<u8>, there: &[u16]) -> Vec<u8> {
        let mut out = START.to_vec();
        out.extend([0, 41, 0, 0]);
        out.extend([size, size, 0, 0, tile, tile, 0, 0].iter().flat_map(|v| v.to_be_bytes()));
        out.extend([0, 1, 11, 1, 1]);
        let precincts = precincts.map_or(vec![], |p| vec![p; 6]);
        out.extend([0xff, CODING, 0, 12 + precincts.len() as u8, u8::from(!precincts.is_empty())]);
        out.extend([0, 0, 1, 0, 5, block, block, 0, 1]);
        out.extend(precincts);
        for number in there {
            out.extend([0xff, TILE_PART, 0, 10]);
            out.extend(number.to_be_bytes());
            out.extend([0, 0, 0, 14, 0, 1, 0xff, DATA]);
        }
        out.extend([0xff, END]);
        out
    }

    fn problem(bytes: &[u8], size: usize) -> String {
        let checked = Picture::read(bytes, [size; 2]).and_then(|picture| picture.check(bytes));
        match checked {
            Ok(()) => String::new(),
            Err(Fault::Damaged(reason) | Fault::Unsupported(reason)) => reason,
        }
    }

    #[test]
    fn few_bytes_ask_for_no_more_than_their_slice() {
        assert_eq!(problem(&stream(8192, 8192, 4, None, &[0]), 8192), "");
        assert_eq!(problem(&stream(8192, 1024, 4, None, &Vec::from_iter(0..64)), 8192), "");
        // Code-blocks of 4 x 4 pixels, precincts of 2 x 2 and of 1, as many tiles as pixels.
        for (tile, block, precincts) in
            [(8192, 0, None), (8192, 4, Some(0x11)), (8192, 4, Some(0)), (1, 4, None), (33, 4, None)]
        {
            let problem = problem(&stream(8192, tile, block, precincts, &[0]), 8192);
            assert!(problem.starts_with("more "), "{tile} {block} {precincts:?}: {problem}");
        }
    }

    #[test]
    fn missing_tiles_and_ends_are_told() {
        let whole = stream(64, 32, 4, None, &[0, 1, 2, 3]);
        assert_eq!(problem(&whole, 64), "");
        assert_eq!(problem(&stream(64, 32, 4, None, &[0, 2, 2]), 64), "2 of 4 tiles are missing");
        assert_eq!(problem(&stream(64, 32, 4, None, &[0, 9]), 64), "a tile with an impossible number");
        assert!(problem(&whole, 65).contains("64 x 64 pixels, where the file states 65 x 65"));
        for cut in 1..whole.len() {
            assert_ne!(problem(&whole[..cut], 64), "", "cut after {cut} bytes");
        }
    }
}
