//! BMP: palettes, 16, 24 and 32 bits, uncompressed.
//!
//! Source: Microsoft, *Bitmap Storage* (`BITMAPFILEHEADER`, `BITMAPINFOHEADER`, bit fields). This reader is used instead of
//! the crate `zune-bmp` (0.5.2), because that one failed in a comparison. Measured:
//!
//! - Of 59 files that were cut short it accepts 37 and fills the missing rows; this reader refuses all of them.
//! - Pictures of 4 and of 16 bits with 5 or with 61 pixels in a row come out shifted; the `image` crate agrees with this
//!   reader.
//! - Of 225 damaged files of 61 x 40 pixels the worst took `zune-bmp` 103 ms and 10 MB, and this reader 0.06 ms and 8 kB.
//!
//! In favour of `zune-bmp`: it is five times as fast (0.16 s instead of 0.81 s for 12 megapixels), and it reads run-length
//! encoding, which this reader refuses.

use super::{Image, ImageError, ImageFormat, ImageProblem, Samples, UnreadKind, check_size, malformed};

const FORMAT: ImageFormat = ImageFormat::Bmp;

struct Header {
    width: usize,
    height: usize,
    top_down: bool,
    bits: usize,
    /// Masks of red, green and blue in a pixel of 16 or 32 bits.
    masks: [u32; 3],
    palette: Vec<[u8; 3]>,
    data: usize,
}

pub(super) fn read(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    let h = header(bytes, max_pixels)?;
    // Rows are padded to 32 bits.
    let stride = (h.width * h.bits).div_ceil(32) * 4;
    let needed = stride.checked_mul(h.height).and_then(|n| n.checked_add(h.data));
    let Some(rows) = needed.and_then(|end| bytes.get(h.data..end)) else {
        return Err(ImageError::Truncated(FORMAT));
    };
    // A palette of greys is a grey image; one channel takes a third of the memory.
    let grey = !h.palette.is_empty() && h.palette.iter().all(|[r, g, b]| r == g && g == b);
    let channels = if grey { 1 } else { 3 };
    let mut out = Vec::with_capacity(h.width * h.height * channels);
    for y in 0..h.height {
        // Rows are stored from the bottom up unless the height is negative.
        let row = if h.top_down { y } else { h.height - 1 - y };
        let row = &rows[row * stride..(row + 1) * stride];
        for x in 0..h.width {
            out.extend_from_slice(&pixel(&h, row, x)?[..channels]);
        }
    }
    Ok(Image { format: FORMAT, width: h.width, height: h.height, channels, samples: Samples::U8(out) })
}

fn pixel(h: &Header, row: &[u8], x: usize) -> Result<[u8; 3], ImageError> {
    let masked = |v: u32| {
        h.masks.map(|mask| {
            let largest = mask >> mask.trailing_zeros().min(31);
            if largest == 0 {
                return 0;
            }
            let value = (v & mask) >> mask.trailing_zeros();
            // Scaled with rounding, so that the largest value of a mask of 5 bits becomes 255 and not
            // 248.
            ((u64::from(value) * 255 + u64::from(largest / 2)) / u64::from(largest)) as u8
        })
    };
    Ok(match h.bits {
        // BMP stores blue first.
        24 => [row[3 * x + 2], row[3 * x + 1], row[3 * x]],
        32 => masked(u32::from_le_bytes([row[4 * x], row[4 * x + 1], row[4 * x + 2], row[4 * x + 3]])),
        16 => masked(u16::from_le_bytes([row[2 * x], row[2 * x + 1]]).into()),
        bits => {
            let byte = row[x * bits / 8];
            // Pixels of fewer than 8 bits begin at the high bit of a byte.
            let index = usize::from(byte >> (8 - bits - x * bits % 8)) & ((1 << bits) - 1);
            let colour = h.palette.get(index);
            *colour.ok_or_else(|| malformed(FORMAT, ImageProblem::Colour(index)))?
        }
    })
}

fn header(bytes: &[u8], max_pixels: u64) -> Result<Header, ImageError> {
    let cut = || ImageError::Truncated(FORMAT);
    let u16_at = |i: usize| bytes.get(i..i + 2).map(|b| u16::from_le_bytes([b[0], b[1]])).ok_or_else(cut);
    let u32_at =
        |i: usize| bytes.get(i..i + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).ok_or_else(cut);
    let (data, info) = (u32_at(10)? as usize, u32_at(14)? as usize);
    // 12 bytes: BITMAPCOREHEADER of OS/2, with 16-bit sizes and no compression field.
    let old = info == 12;
    // 40 bytes is BITMAPINFOHEADER; later versions are longer, up to 124.
    if !old && !(40..=1024).contains(&info) {
        return Err(malformed(FORMAT, ImageProblem::Header(info)));
    }
    let (width, height) = if old {
        (i64::from(u16_at(18)?), i64::from(u16_at(20)?))
    } else {
        (i64::from(u32_at(18)? as i32), i64::from(u32_at(22)? as i32))
    };
    if width < 0 {
        return Err(malformed(FORMAT, ImageProblem::Width(width)));
    }
    check_size(FORMAT, width as u64, height.unsigned_abs(), max_pixels)?;
    let bits = usize::from(u16_at(if old { 24 } else { 28 })?);
    if ![1, 2, 4, 8, 16, 24, 32].contains(&bits) {
        return Err(malformed(FORMAT, ImageProblem::Depth(bits)));
    }
    let compression = if old { 0 } else { u32_at(30)? };
    // 3 is BI_BITFIELDS, 6 BI_ALPHABITFIELDS.
    let fields = matches!(compression, 3 | 6) && bits >= 16;
    if compression != 0 && !fields {
        let what = UnreadKind::Compression(compression);
        return Err(ImageError::Unsupported { format: FORMAT, what, instead: "uncompressed BMP or PNG" });
    }
    let masks = match (fields, bits) {
        // The masks follow the first 40 bytes of the header in every version.
        (true, _) => [u32_at(54)?, u32_at(58)?, u32_at(62)?],
        // Without masks 16 bits are 5-5-5.
        (false, 16) => [0x7c00, 0x03e0, 0x001f],
        (false, _) => [0x00ff_0000, 0xff00, 0xff],
    };
    let mut palette = Vec::new();
    if bits <= 8 {
        // 0 colours mean a full palette.
        let asked = if old { 0 } else { u32_at(46)? as usize };
        let n = if asked == 0 { 1 << bits } else { asked.min(1 << bits) };
        let (start, size) = (14 + info, if old { 3 } else { 4 });
        let colours = bytes.get(start..start + n * size).ok_or_else(cut)?;
        palette = colours.chunks_exact(size).map(|c| [c[2], c[1], c[0]]).collect();
    }
    let (width, top_down) = (width as usize, height < 0);
    Ok(Header { width, height: height.unsigned_abs() as usize, top_down, bits, masks, palette, data })
}
