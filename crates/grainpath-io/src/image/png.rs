//! PNG: any depth and colour, interlaced or not.

use png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Transformations};

use super::{Image, ImageError, ImageFormat, ImageProblem, Samples, check_size, malformed};

const FORMAT: ImageFormat = ImageFormat::Png;

pub(super) fn read(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    // The decoder may hold 64 MiB besides the pixels: palettes and ICC profiles inflate too.
    let limits = Limits { bytes: 64 << 20 };
    let mut decoder = Decoder::new_with_limits(std::io::Cursor::new(bytes), limits);
    // EXPAND turns palettes into RGB and 1, 2 and 4 bits into 8, but leaves 16 bits as they are.
    decoder.set_transformations(Transformations::EXPAND);
    // Text chunks inflate without bound and say nothing about the pixels.
    decoder.set_ignore_text_chunk(true);
    let (width, height) = {
        let info = decoder.read_header_info().map_err(error)?;
        (info.width, info.height)
    };
    // The size is checked before `read_info`, which reserves memory for rows.
    check_size(FORMAT, width.into(), height.into(), max_pixels)?;
    let mut reader = decoder.read_info().map_err(error)?;
    // The decoder assumes that the palette holds whole entries (png 0.18.1, found by `cargo xtask campaign`).
    if let Some(palette) = &reader.info().palette
        && (palette.is_empty() || palette.len() % 3 != 0)
    {
        return Err(malformed(FORMAT, ImageProblem::PaletteBytes(palette.len())));
    }
    let size = reader.output_buffer_size().ok_or_else(|| malformed(FORMAT, ImageProblem::NoSize))?;
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(error)?;
    data.truncate(info.buffer_size());
    let channels = match info.color_type {
        ColorType::Grayscale | ColorType::Indexed => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
    };
    let samples = match info.bit_depth {
        BitDepth::Sixteen => {
            // PNG stores 16-bit samples big endian (PNG specification, section 7.1).
            Samples::U16(data.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect())
        }
        _ => Samples::U8(data),
    };
    Ok(Image { format: FORMAT, width: width as usize, height: height as usize, channels, samples })
}

fn error(e: DecodingError) -> ImageError {
    match e {
        DecodingError::IoError(_) => ImageError::Truncated(FORMAT),
        DecodingError::LimitsExceeded => malformed(FORMAT, ImageProblem::Chunks),
        other => malformed(FORMAT, ImageProblem::Decoder(other.to_string())),
    }
}
