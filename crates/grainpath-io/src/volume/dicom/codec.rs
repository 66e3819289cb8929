//! Ways in which the pixels of a frame are packed.

use super::super::{VolumeError, damaged, unsupported};
use super::unpacked::{Fault, Frame};
use super::{grey_jpeg, jpeg_ls, run_length};

/// How the pixels of a file are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Codec {
    /// Runs of bytes (PS3.5, annex G).
    Rle,
    /// ITU-T T.81: by the discrete cosine transform, or lossless.
    Jpeg,
    /// ITU-T T.87, lossless and near-lossless.
    JpegLs,
    /// ISO/IEC 15444-1, reversible and irreversible.
    #[cfg(feature = "jpeg2000")]
    Jpeg2000,
}

impl Codec {
    /// The name that messages use.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Rle => "RLE",
            Self::Jpeg => "JPEG",
            Self::JpegLs => "JPEG-LS",
            #[cfg(feature = "jpeg2000")]
            Self::Jpeg2000 => "JPEG 2000",
        }
    }

    /// Unpacks a frame of `size` pixels, columns first; `n_bytes` is the number of bytes that the header allocates to a
    /// pixel. `part` is the name of these bytes in messages.
    pub(super) fn unpack(
        self,
        file: &str,
        part: &str,
        bytes: &[u8],
        size: [usize; 2],
        n_bytes: usize,
    ) -> Result<Frame, VolumeError> {
        let frame = match self {
            Self::Rle => run_length::unpack(bytes, size[0] * size[1], n_bytes),
            Self::Jpeg => grey_jpeg::unpack(bytes, size),
            Self::JpegLs => jpeg_ls::unpack(bytes, size),
            #[cfg(feature = "jpeg2000")]
            Self::Jpeg2000 => super::jpeg_2000::unpack(bytes, size),
        };
        frame.map_err(|fault| match fault {
            Fault::Damaged(reason) => damaged(file, part, reason),
            Fault::Unsupported(what) => {
                unsupported(file, format!("{part} with {what}"), "save the series uncompressed")
            }
        })
    }
}
