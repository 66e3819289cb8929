//! JPEG, baseline and progressive, turned upright as its EXIF data says.

use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::{
    Colours, Image, ImageError, ImageFormat, ImageProblem, Samples, UnreadKind, check_size, malformed,
};

const FORMAT: ImageFormat = ImageFormat::Jpeg;
/// Limit on the scans of a progressive image: each is a pass over all pixels. Source: `jpeg_simple_progression` of
/// libjpeg writes ten for a colour picture; a file with thousands would take hours to decode.
const MAX_SCANS: usize = 128;

pub(super) fn read(bytes: &[u8], max_pixels: u64, colours: Colours) -> Result<Image, ImageError> {
    let options = DecoderOptions::default()
        .set_max_width(65535)
        .set_max_height(65535)
        .set_strict_mode(false)
        .jpeg_set_max_scans(MAX_SCANS)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(error)?;
    let (width, height) = decoder.dimensions().ok_or_else(|| malformed(FORMAT, ImageProblem::NoSize))?;
    check_size(FORMAT, width as u64, height as u64, max_pixels)?;
    if is_cut_short(bytes) {
        return Err(ImageError::Truncated(FORMAT));
    }
    // YCbCr keeps brightness in a channel of its own. RGB and CMYK files do not, so they are decoded
    // whole.
    let grey = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => true,
        Some(ColorSpace::YCbCr) => colours == Colours::LumaWhereApart,
        _ => false,
    };
    if grey {
        decoder.set_options(options.jpeg_set_out_colorspace(ColorSpace::Luma));
    }
    let samples = decoder.decode().map_err(error)?;
    let channels = if grey { 1 } else { 3 };
    if samples.len() != width * height * channels {
        return Err(malformed(FORMAT, ImageProblem::Pixels));
    }
    let turned = decoder.exif().and_then(|exif| orientation(exif)).unwrap_or(1);
    let (width, height, samples) = upright(width, height, channels, samples, turned);
    Ok(Image { format: FORMAT, width, height, channels, samples: Samples::U8(samples) })
}

/// Whether the end marker (EOI) is missing. The decoder fills missing rows with grey, and a grey strip
/// would pass for wood without grain. Bytes after the marker are harmless: some cameras append a preview
/// there.
fn is_cut_short(bytes: &[u8]) -> bool {
    !bytes.windows(2).rev().any(|w| w == [0xff, 0xd9]) || ends_inside_scan(bytes)
}

/// Walks along the markers. True when the data of the last scan end with the file instead of with a
/// marker.
fn ends_inside_scan(bytes: &[u8]) -> bool {
    let mut i = 2;
    loop {
        // Finds the next marker. 0xff00 (a stuffed byte) and the restarts 0xd0 to 0xd7 belong to a scan's
        // data (ITU T.81, B.1.1.5). Most blocks of 64 bytes hold no 0xff, so whole blocks are skipped
        // first.
        loop {
            let rest = bytes.get(i..).unwrap_or_default();
            let plain = 64 * rest.chunks_exact(64).take_while(|some| !some.contains(&0xff)).count();
            i += plain + rest[plain..].iter().take_while(|b| **b != 0xff).count();
            match bytes.get(i..i + 2) {
                None => return true,
                Some(&[0xff, m]) if m != 0 && m != 0xff && !(0xd0..=0xd7).contains(&m) => break,
                Some(_) => i += 1,
            }
        }
        if bytes[i + 1] == 0xd9 {
            return false;
        }
        // A segment's length counts its own two bytes.
        let Some(&[high, low]) = bytes.get(i + 2..i + 4) else { return true };
        i += 2 + usize::from(u16::from_be_bytes([high, low]));
    }
}

fn error(e: DecodeErrors) -> ImageError {
    match e {
        DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_) => ImageError::Truncated(FORMAT),
        DecodeErrors::Unsupported(what) => ImageError::Unsupported {
            format: FORMAT,
            what: UnreadKind::Decoder(format!("{what:?}")),
            instead: "8-bit baseline or progressive JPEG, or PNG",
        },
        other => malformed(FORMAT, ImageProblem::Decoder(other.to_string())),
    }
}

/// The orientation tag of the first directory of EXIF data; `None` when there is none or it is damaged.
fn orientation(segment: &[u8]) -> Option<u16> {
    // An EXIF segment is a TIFF file after a prefix of six bytes (EXIF 2.3, APP1).
    let tiff = segment.strip_prefix(b"Exif\0\0").unwrap_or(segment);
    let mut reader = exif::Reader::new();
    // Damage elsewhere in the segment leaves the tag readable.
    let read = reader.continue_on_error(true).read_raw(tiff.to_vec());
    let fields = read.or_else(|e| e.distill_partial_result(|_| ())).ok()?;
    let turned = fields.get_field(exif::Tag::Orientation, exif::In::PRIMARY)?.value.get_uint(0)?;
    u16::try_from(turned).ok().filter(|o| (1..=8).contains(o))
}

/// Turns the image as EXIF orientation `turned` (1 to 8) says, so that it stands upright.
fn upright(w: usize, h: usize, channels: usize, data: Vec<u8>, turned: u16) -> (usize, usize, Vec<u8>) {
    if turned <= 1 {
        return (w, h, data);
    }
    // Orientations 5 to 8 exchange rows and columns.
    let swapped = turned >= 5;
    let (nw, nh) = if swapped { (h, w) } else { (w, h) };
    let mut out = Vec::with_capacity(data.len());
    for y in 0..nh {
        for x in 0..nw {
            // Place in the stored image of the upright pixel (x, y).
            let (sx, sy) = match turned {
                2 => (w - 1 - x, y),
                3 => (w - 1 - x, h - 1 - y),
                4 => (x, h - 1 - y),
                5 => (y, x),
                6 => (y, h - 1 - x),
                7 => (w - 1 - y, h - 1 - x),
                _ => (w - 1 - y, x),
            };
            let i = channels * (sy * w + sx);
            out.extend_from_slice(&data[i..i + channels]);
        }
    }
    (nw, nh, out)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// EXIF data with nothing but an orientation.
    pub(crate) fn exif(turned: u16) -> Vec<u8> {
        let mut out = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01".to_vec();
        out.extend(turned.to_be_bytes());
        out.extend([0; 6]);
        out
    }

    #[test]
    fn every_orientation_brings_the_corner_where_it_belongs() {
        // 3 x 2, numbered; EXIF says where row 0 and column 0 of the file are in the scene.
        let data = vec![0, 1, 2, 3, 4, 5];
        for (turned, expect) in [
            (1, (3, 2, [0, 1, 2, 3, 4, 5])),
            (2, (3, 2, [2, 1, 0, 5, 4, 3])),
            (3, (3, 2, [5, 4, 3, 2, 1, 0])),
            (4, (3, 2, [3, 4, 5, 0, 1, 2])),
            (5, (2, 3, [0, 3, 1, 4, 2, 5])),
            (6, (2, 3, [3, 0, 4, 1, 5, 2])),
            (7, (2, 3, [5, 2, 4, 1, 3, 0])),
            (8, (2, 3, [2, 5, 1, 4, 0, 3])),
        ] {
            let found = upright(3, 2, 1, data.clone(), turned);
            assert_eq!(found, (expect.0, expect.1, expect.2.to_vec()), "{turned}");
            assert_eq!(orientation(&exif(turned)), Some(turned));
        }
        assert_eq!(orientation(&exif(9)), None);
        assert_eq!(orientation(b"Exif\0\0MM\0*\xff\xff\xff\xff"), None);
    }
}
