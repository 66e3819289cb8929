//! Photographs and slices: PNG, JPEG, TIFF and BMP to samples.

mod bmp;
mod jpeg;
mod png;
pub(crate) mod tiff;

pub use grainpath_core::image::{Image, ImageFormat, Samples};

/// Why an image cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum ImageError {
    #[error("the file is empty")]
    Empty,
    #[error("not an image: neither PNG, JPEG, TIFF nor BMP")]
    Unknown,
    #[error("{0} pictures are not read; save a copy as JPEG or PNG ({how})", how = how_to_convert(.0))]
    OtherFormat(&'static str),
    #[error("{width} x {height} pixels; grainpath reads images of at most {limit} pixels")]
    TooLarge { width: u64, height: u64, limit: u64 },
    #[error("{format}: the image ends before its last row", format = .0.name())]
    Truncated(ImageFormat),
    #[error("{format}: {problem}", format = .format.name())]
    Malformed { format: ImageFormat, problem: ImageProblem },
    #[error("{format}: {what} is not read; save it as {instead}", format = .format.name())]
    Unsupported { format: ImageFormat, what: UnreadKind, instead: &'static str },
}

/// What is wrong with an image.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum ImageProblem {
    #[error("no size")]
    NoSize,
    #[error("an image of {width} x {height} pixels")]
    NoPixels { width: u64, height: u64 },
    #[error("a width of {0}")]
    Width(i64),
    #[error("it does not hold the pixels its header promises")]
    Pixels,
    #[error("a header of {0} bytes")]
    Header(usize),
    #[error("{0} bits a pixel")]
    Depth(usize),
    #[error("colour {0} is not in its palette")]
    Colour(usize),
    #[error("its palette is cut short")]
    PaletteEnds,
    #[error("its palette has {0} bytes, and entries take three each")]
    PaletteBytes(usize),
    #[error("its tables are larger than an image needs")]
    Tables,
    #[error("its chunks are larger than an image needs")]
    Chunks,
    /// In the words of the library that decodes the format: `png`, `zune-jpeg` or `tiff`.
    #[error("{0}")]
    Decoder(String),
}

/// A kind of image that its format allows and that is not read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum UnreadKind {
    #[error("one plane a channel")]
    Planes,
    #[error("64-bit integers")]
    Integers64,
    #[error("{0} bits a sample")]
    Bits(usize),
    #[error("a palette of 65536 colours")]
    LargePalette,
    /// The code of the compression in the header of a BMP.
    #[error("compression {0}")]
    Compression(u32),
    /// In the words of the library that decodes the format: `zune-jpeg` or `tiff`.
    #[error("{0}")]
    Decoder(String),
}

/// Largest number of pixels that [`decode`] reads. Source: derived. An image of this size takes 750 MB as RGB; phone
/// cameras give up to 200 million pixels.
pub const MAX_PIXELS: u64 = 250_000_000;

/// Reads an image of any of the formats; the first bytes decide which. A TIFF gives its first page; the
/// orientation that a camera wrote into a JPEG is applied. Memory is bounded by [`MAX_PIXELS`], checked
/// before anything is decoded.
///
/// # Errors
/// [`ImageError`]; an image that is cut short is an error and not read in part.
pub fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    decode_within(bytes, MAX_PIXELS)
}

/// Like [`decode`], with a limit on the pixels that the caller sets.
///
/// # Errors
/// As [`decode`].
pub fn decode_within(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    read(bytes, max_pixels, Colours::All)
}

/// Like [`decode`], for brightness alone. A JPEG stores brightness apart from colour and decodes in half
/// the time.
///
/// # Errors
/// As [`decode`].
pub fn decode_luma(bytes: &[u8]) -> Result<Image, ImageError> {
    read(bytes, MAX_PIXELS, Colours::LumaWhereApart)
}

/// Channels that the caller needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Colours {
    All,
    LumaWhereApart,
}

fn read(bytes: &[u8], max_pixels: u64, colours: Colours) -> Result<Image, ImageError> {
    if bytes.is_empty() {
        return Err(ImageError::Empty);
    }
    let unknown = || sniff_other_image(bytes).map_or(ImageError::Unknown, ImageError::OtherFormat);
    let image = match sniff_image(bytes).ok_or_else(unknown)? {
        ImageFormat::Png => png::read(bytes, max_pixels)?,
        ImageFormat::Jpeg => jpeg::read(bytes, max_pixels, colours)?,
        ImageFormat::Tiff => tiff::read(bytes, max_pixels)?,
        ImageFormat::Bmp => bmp::read(bytes, max_pixels)?,
    };
    debug_assert_eq!(image.samples.count(), image.width * image.height * image.channels);
    Ok(image)
}

/// The format of these bytes, if they can be an image.
pub fn sniff_image(bytes: &[u8]) -> Option<ImageFormat> {
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    if starts(b"\x89PNG\r\n\x1a\n") {
        Some(ImageFormat::Png)
    } else if starts(b"\xff\xd8\xff") {
        Some(ImageFormat::Jpeg)
    } else if [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|m| starts(*m)) {
        Some(ImageFormat::Tiff)
    // The signature `BM` could stand in other files by chance, so the smallest header has to fit as well.
    } else if starts(b"BM") && bytes.len() >= 26 {
        Some(ImageFormat::Bmp)
    } else {
        None
    }
}

/// The name of a known image format that is not read, if these bytes begin like one.
///
/// ```
/// use grainpath_io::image::sniff_other_image;
///
/// assert_eq!(sniff_other_image(b"RIFF\x24\0\0\0WEBPVP8 "), Some("WebP"));
/// assert_eq!(sniff_other_image(b"\xff\xd8\xff\xe0"), None);
/// ```
pub fn sniff_other_image(bytes: &[u8]) -> Option<&'static str> {
    let at = |from: usize, magic: &[u8]| bytes.get(from..).is_some_and(|rest| rest.starts_with(magic));
    // Files of the ISO base media format name their brand behind the word "ftyp" (ISO/IEC 14496-12, 4.3).
    if at(4, b"ftyp") {
        let is = |brands: &[&[u8]]| brands.iter().any(|brand| at(8, brand));
        if is(&[b"avif", b"avis"]) {
            return Some("AVIF");
        }
        return is(&[b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1"]).then_some("HEIC");
    }
    if at(0, b"RIFF") && at(8, b"WEBP") {
        return Some("WebP");
    }
    if at(0, b"GIF87a") || at(0, b"GIF89a") {
        return Some("GIF");
    }
    if at(0, b"\0\0\0\x0cjP  \r\n\x87\n") || at(0, b"\xff\x4f\xff\x51") {
        return Some("JPEG 2000");
    }
    (at(0, b"\0\0\0\x0cJXL \r\n\x87\n") || at(0, b"\xff\x0a")).then_some("JPEG XL")
}

/// A way to convert a picture of a format that is not read.
fn how_to_convert(format: &str) -> &'static str {
    match format {
        // HEIC pictures come from the cameras of phones, WebP pictures from the web.
        "HEIC" => {
            "on an iPhone: Settings > Camera > Formats > Most Compatible; or `heif-convert in.heic out.jpg`"
        }
        "WebP" => "`dwebp in.webp -o out.png`",
        _ => "`magick in out.png`",
    }
}

/// Refuses an image without pixels or with too many.
fn check_size(format: ImageFormat, width: u64, height: u64, limit: u64) -> Result<(), ImageError> {
    if width == 0 || height == 0 {
        return Err(malformed(format, ImageProblem::NoPixels { width, height }));
    }
    match width.checked_mul(height) {
        Some(n) if n <= limit => Ok(()),
        _ => Err(ImageError::TooLarge { width, height, limit }),
    }
}

fn malformed(format: ImageFormat, problem: ImageProblem) -> ImageError {
    ImageError::Malformed { format, problem }
}

#[cfg(test)]
mod tests;
