//! The first page of a TIFF.

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError, TiffFormatError};

use super::{Image, ImageError, ImageFormat, ImageProblem, Samples, UnreadKind, check_size, malformed};

const FORMAT: ImageFormat = ImageFormat::Tiff;

pub(crate) fn read(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    let mut decoder = Decoder::new(std::io::Cursor::new(bytes)).map_err(error)?;
    let (width, height) = decoder.dimensions().map_err(error)?;
    check_size(FORMAT, width.into(), height.into(), max_pixels)?;
    let mut limits = Limits::default();
    // A pixel has at most four channels of eight bytes, so the checked size gives the decoder's limit on
    // memory.
    let most = (u64::from(width) * u64::from(height)).saturating_mul(32);
    limits.decoding_buffer_size = usize::try_from(most).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = limits.decoding_buffer_size.max(1 << 20);
    read_page(&mut decoder.with_limits(limits), max_pixels)
}

/// Reads the decoder's current page. The caller has set the limits of the decoder.
pub(crate) fn read_page<R: std::io::Read + std::io::Seek>(
    decoder: &mut Decoder<R>,
    max_pixels: u64,
) -> Result<Image, ImageError> {
    let (width, height) = decoder.dimensions().map_err(error)?;
    check_size(FORMAT, width.into(), height.into(), max_pixels)?;
    let colour = decoder.colortype().map_err(error)?;
    let channels = match colour {
        ColorType::Gray(_) | ColorType::Palette(_) => 1,
        ColorType::GrayA(_) => 2,
        ColorType::RGB(_) | ColorType::YCbCr(_) => 3,
        ColorType::RGBA(_) => 4,
        other => return Err(unsupported(UnreadKind::Decoder(format!("{other:?}")))),
    };
    let planar: Option<u16> = decoder.find_tag_unsigned(Tag::PlanarConfiguration).map_err(error)?;
    // Planes would have to be interleaved; cameras and scanners write chunky pixels (PlanarConfiguration
    // 1).
    if channels > 1 && planar == Some(2) {
        return Err(unsupported(UnreadKind::Planes));
    }
    let palette = match colour {
        ColorType::Palette(_) => decoder.get_tag_u16_vec(Tag::ColorMap).map_err(error)?,
        _ => Vec::new(),
    };
    let (w, h) = (width as usize, height as usize);
    let samples = match decoder.read_image().map_err(error)? {
        // The decoder leaves fewer than 8 bits packed.
        DecodingResult::U8(v) if colour.bit_depth() < 8 => {
            // Palette indices must keep their values; grey values are stretched to 0 to 255.
            let spread = palette.is_empty();
            Samples::U8(unpack(&v, w * channels, h, colour.bit_depth(), spread)?)
        }
        DecodingResult::U8(v) => Samples::U8(v),
        DecodingResult::U16(v) => Samples::U16(v),
        // Floats and signed integers keep their values as f32. Scans use them for densities below zero.
        DecodingResult::F16(v) => Samples::F32(v.into_iter().map(f32::from).collect()),
        DecodingResult::F32(v) => Samples::F32(v),
        DecodingResult::F64(v) => Samples::F32(v.into_iter().map(|s| s as f32).collect()),
        DecodingResult::U32(v) => Samples::F32(v.into_iter().map(|s| s as f32).collect()),
        DecodingResult::I8(v) => Samples::F32(v.into_iter().map(f32::from).collect()),
        DecodingResult::I16(v) => Samples::F32(v.into_iter().map(f32::from).collect()),
        DecodingResult::I32(v) => Samples::F32(v.into_iter().map(|s| s as f32).collect()),
        DecodingResult::U64(_) | DecodingResult::I64(_) => return Err(unsupported(UnreadKind::Integers64)),
    };
    if samples.count() != w * h * channels {
        return Err(malformed(FORMAT, ImageProblem::Pixels));
    }
    if let ColorType::Palette(bits) = colour {
        return coloured(w, h, &samples, &palette, bits);
    }
    Ok(Image { format: FORMAT, width: w, height: h, channels, samples })
}

/// Unpacks samples of fewer than 8 bits; each row is padded to whole bytes.
fn unpack(packed: &[u8], row: usize, rows: usize, bits: u8, spread: bool) -> Result<Vec<u8>, ImageError> {
    let bits = usize::from(bits);
    if ![1, 2, 4].contains(&bits) {
        return Err(unsupported(UnreadKind::Bits(bits)));
    }
    let stride = (row * bits).div_ceil(8);
    if packed.len() != stride * rows {
        return Err(malformed(FORMAT, ImageProblem::Pixels));
    }
    let largest = (1usize << bits) - 1;
    let value = |line: &[u8], x: usize| {
        let v = usize::from(line[x * bits / 8] >> (8 - bits - x * bits % 8)) & largest;
        if spread { (v * 255 / largest) as u8 } else { v as u8 }
    };
    Ok(packed.chunks_exact(stride).flat_map(|line| (0..row).map(move |x| value(line, x))).collect())
}

fn coloured(w: usize, h: usize, samples: &Samples, palette: &[u16], bits: u8) -> Result<Image, ImageError> {
    let n = 1usize << bits.min(16);
    let Samples::U8(indices) = samples else { return Err(unsupported(UnreadKind::LargePalette)) };
    if palette.len() < 3 * n {
        return Err(malformed(FORMAT, ImageProblem::PaletteEnds));
    }
    // ColorMap holds all reds, then all greens, then all blues (TIFF 6.0, section 5).
    let colour = |&i: &u8| [0, n, 2 * n].map(|first| palette[first + usize::from(i).min(n - 1)]);
    let samples = Samples::U16(indices.iter().flat_map(colour).collect());
    Ok(Image { format: FORMAT, width: w, height: h, channels: 3, samples })
}

fn unsupported(what: UnreadKind) -> ImageError {
    ImageError::Unsupported { format: FORMAT, what, instead: "grey or RGB TIFF, or PNG" }
}

fn error(e: TiffError) -> ImageError {
    match e {
        TiffError::IoError(_) => ImageError::Truncated(FORMAT),
        TiffError::FormatError(TiffFormatError::InconsistentSizesEncountered) => {
            ImageError::Truncated(FORMAT)
        }
        TiffError::UnsupportedError(what) => unsupported(UnreadKind::Decoder(what.to_string())),
        TiffError::LimitsExceeded => malformed(FORMAT, ImageProblem::Tables),
        other => malformed(FORMAT, ImageProblem::Decoder(other.to_string())),
    }
}
