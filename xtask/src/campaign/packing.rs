//! Unpacking and packing of compressed and checksummed seeds, so that mutants reach what lies behind the checksum.
//!
//! A bit flipped in a compressed file nearly always ends at its checksum: the parser of the content never runs. Here the
//! content is unpacked, changed and packed again with sizes and checksums that are right.
//! Sources: gzip RFC 1952, zlib RFC 1950, ZIP APPNOTE 6.3, PNG (ISO/IEC 15948, section 5), NRRD 5, MetaIO, VTK XML.

use std::io::{Cursor, Read, Write};

use flate2::read::{GzDecoder, ZlibDecoder};
use flate2::write::{GzEncoder, ZlibEncoder};
use flate2::{Compression, Crc};

use super::mutate::{Draw, change};

/// How the content of a seed is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// Nothing is compressed.
    Plain,
    /// The whole file is one gzip stream.
    Gzip,
    /// A ZIP archive; one member is changed.
    Zip,
    /// PNG: chunks with checksums, pixels as zlib in IDAT.
    Png,
    /// NRRD: a gzip stream behind the first empty line.
    NrrdGzip,
    /// MetaImage: a zlib stream behind the header, whose size the header states.
    MetaZlib,
    /// VTU: arrays in base64, each a zlib stream behind a header of sizes.
    VtuZlib,
}

/// A mutant whose packing is right, or `None` where the seed cannot be unpacked.
pub fn repacked(bytes: &[u8], packing: Packing, draw: &mut Draw) -> Option<Vec<u8>> {
    match packing {
        Packing::Plain => None,
        Packing::Gzip => {
            let mut content = inflate(GzDecoder::new(bytes))?;
            change(&mut content, 0, draw);
            gzip(&content)
        }
        Packing::Zip => zip(bytes, draw),
        Packing::Png => png(bytes, draw),
        Packing::NrrdGzip => {
            let at = find(bytes, b"\n\n")? + 2;
            let mut content = inflate(GzDecoder::new(&bytes[at..]))?;
            change(&mut content, 0, draw);
            Some([&bytes[..at], &gzip(&content)?].concat())
        }
        Packing::MetaZlib => {
            let at = find(bytes, b"LOCAL\n")? + 6;
            let mut content = inflate(ZlibDecoder::new(&bytes[at..]))?;
            change(&mut content, 0, draw);
            let packed = zlib(&content)?;
            let header = String::from_utf8(bytes[..at].to_vec()).ok()?;
            let lines = header.lines().map(|line| match line.starts_with("CompressedDataSize") {
                true => format!("CompressedDataSize = {}\n", packed.len()),
                false => format!("{line}\n"),
            });
            Some([lines.collect::<String>().into_bytes(), packed].concat())
        }
        Packing::VtuZlib => vtu(bytes, draw),
    }
}

fn inflate(mut reader: impl Read) -> Option<Vec<u8>> {
    let mut content = Vec::new();
    reader.read_to_end(&mut content).ok()?;
    Some(content)
}

fn gzip(content: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(content).ok()?;
    encoder.finish().ok()
}

fn zlib(content: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(content).ok()?;
    encoder.finish().ok()
}

fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).position(|w| w == pattern)
}

/// Writes the archive again with one member changed.
fn zip(bytes: &[u8], draw: &mut Draw) -> Option<Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).ok()?;
    // The last member is the model; the others are small tables, changed now and then.
    let changed = if draw.below(4) == 0 { draw.below(archive.len()) } else { archive.len() - 1 };
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for member in 0..archive.len() {
        let mut file = archive.by_index(member).ok()?;
        let name = file.name().ok()?.into_owned();
        let mut content = inflate(&mut file)?;
        if member == changed {
            change(&mut content, 0, draw);
        }
        out.start_file(name, options).ok()?;
        out.write_all(&content).ok()?;
    }
    Some(out.finish().ok()?.into_inner())
}

/// Changes a chunk or the pixels, and writes the checksums of all chunks again.
fn png(bytes: &[u8], draw: &mut Draw) -> Option<Vec<u8>> {
    let mut chunks: Vec<([u8; 4], Vec<u8>)> = Vec::new();
    let mut rest = bytes.get(8..)?;
    while rest.len() >= 12 {
        let length = u32::from_be_bytes(rest[..4].try_into().ok()?) as usize;
        chunks.push((rest[4..8].try_into().ok()?, rest.get(8..8 + length)?.to_vec()));
        rest = rest.get(12 + length..)?;
    }
    let at = draw.below(chunks.len());
    let (kind, data) = chunks.get_mut(at)?;
    if kind == b"IDAT" && draw.below(4) > 0 {
        let mut pixels = inflate(ZlibDecoder::new(&data[..]))?;
        change(&mut pixels, 0, draw);
        *data = zlib(&pixels)?;
    } else {
        change(data, 0, draw);
    }
    let mut out = bytes[..8].to_vec();
    for (kind, data) in chunks {
        let mut crc = Crc::new();
        crc.update(&kind);
        crc.update(&data);
        out.extend((data.len() as u32).to_be_bytes());
        out.extend(kind);
        out.extend(data);
        out.extend(crc.sum().to_be_bytes());
    }
    Some(out)
}

/// Changes one array of a VTU file of one block an array.
fn vtu(bytes: &[u8], draw: &mut Draw) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(bytes).ok()?;
    // Tokens between tags that are long enough for base64 of a header of four words.
    let arrays: Vec<(usize, usize)> = text
        .match_indices('>')
        .filter_map(|(at, _)| {
            let begin = at + 1 + text[at + 1..].find(|c: char| !c.is_whitespace())?;
            let length = text[begin..].find(|c: char| c.is_whitespace() || c == '<')?;
            (length >= 32).then_some((begin, begin + length))
        })
        .collect();
    let &(begin, end) = arrays.get(draw.below(arrays.len()))?;
    // The header is encoded by itself: 16 bytes are 24 characters.
    let header = base64(&text[begin..begin + 24])?;
    let mut content = inflate(ZlibDecoder::new(&base64(&text[begin + 24..end])?[..]))?;
    change(&mut content, 0, draw);
    let packed = zlib(&content)?;
    let sizes = [1, content.len() as u32, content.len() as u32, packed.len() as u32];
    let header: Vec<u8> = match header.len() {
        16 => sizes.iter().flat_map(|w| w.to_le_bytes()).collect(),
        _ => return None,
    };
    Some(
        [
            &text.as_bytes()[..begin],
            to_base64(&header).as_bytes(),
            to_base64(&packed).as_bytes(),
            &text.as_bytes()[end..],
        ]
        .concat(),
    )
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    for group in text.trim_end_matches('=').as_bytes().chunks(4) {
        let mut word = 0_u32;
        for digit in group {
            word = word << 6 | DIGITS.iter().position(|d| d == digit)? as u32;
        }
        word <<= 6 * (4 - group.len());
        bytes.extend(word.to_be_bytes()[1..].iter().take(group.len() - 1));
    }
    Some(bytes)
}

fn to_base64(bytes: &[u8]) -> String {
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let word = group.iter().fold(0_u32, |w, b| w << 8 | u32::from(*b)) << (8 * (3 - group.len()));
        for k in 0..4 {
            let digit = if k <= group.len() { DIGITS[(word >> (18 - 6 * k) & 63) as usize] } else { b'=' };
            text.push(char::from(digit));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seed(name: &str) -> Vec<u8> {
        std::fs::read(crate::root().join("xtask/seeds").join(name)).expect("a seed")
    }

    #[test]
    fn every_packed_seed_unpacks_and_packs_again() {
        for (name, packing) in [
            ("scan.nii.gz", Packing::Gzip),
            ("mesh.3mf", Packing::Zip),
            ("directions.npz", Packing::Zip),
            ("colour.png", Packing::Png),
            ("gzip.nrrd", Packing::NrrdGzip),
            ("zlib.mha", Packing::MetaZlib),
            ("zlib.vtu", Packing::VtuZlib),
        ] {
            let bytes = seed(name);
            let made = (0..20).filter(|k| repacked(&bytes, packing, &mut Draw::new(*k)).is_some()).count();
            assert_eq!(made, 20, "{name}");
        }
    }

    #[test]
    fn base64_comes_back() {
        for text in ["", "f", "fo", "foo", "foob", "fooba", "foobar"] {
            assert_eq!(base64(&to_base64(text.as_bytes())).as_deref(), Some(text.as_bytes()));
        }
        assert_eq!(to_base64(b"fooba"), "Zm9vYmE=");
    }
}
