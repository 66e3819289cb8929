//! RLE: one segment for each byte of a pixel, packed as `PackBits`.
//!
//! Source: DICOM PS3.5, annex G. Segments follow from the most significant byte of a pixel to the least. The cost is one
//! pass over the pixels; the memory is that of the pixels, even for damaged bytes. Segments that end early, or that reach
//! past the frame, are damaged.

use super::unpacked::{Fault, Frame};

/// Unpacks a frame of pixels of `n_bytes` bytes.
pub(super) fn unpack(bytes: &[u8], n_pixels: usize, n_bytes: usize) -> Result<Frame, Fault> {
    let damaged = || Fault::from("a run reaches past its end");
    let word = |i: usize| -> Option<usize> {
        let b: [u8; 4] = bytes.get(4 * i..4 * i + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(b)).ok()
    };
    // The header is 16 words: the number of segments and their offsets.
    let n_planes = word(0).ok_or_else(damaged)?;
    if n_planes != n_bytes {
        let found =
            format!("{n_planes} segments for pixels of {n_bytes} bytes; each byte of a pixel has one");
        return Err(found.into());
    }
    let mut patterns = vec![0u32; n_pixels];
    for plane in 0..n_planes {
        let begin = word(1 + plane).ok_or_else(damaged)?;
        let end = if plane + 1 < n_planes { word(2 + plane).ok_or_else(damaged)? } else { bytes.len() };
        let mut packed = bytes.get(begin..end).ok_or_else(damaged)?;
        let mut at = 0;
        let mut put = |at: usize, v: u8| patterns[at] = patterns[at] << 8 | u32::from(v);
        while at < n_pixels {
            let (&head, rest) = packed.split_first().ok_or_else(damaged)?;
            let n = usize::from(head);
            // 0 to 127: n + 1 bytes as they are. 129 to 255: the next byte 257 - n times. 128 means
            // nothing (annex G.3.1).
            if n < 128 {
                let values = rest.get(..=n).ok_or_else(damaged)?;
                // A run may go past the last pixel through padding; the rest is dropped.
                values.iter().take(n_pixels - at).enumerate().for_each(|(k, v)| put(at + k, *v));
                (at, packed) = (at + n + 1, &rest[n + 1..]);
            } else if n > 128 {
                let (&v, rest) = rest.split_first().ok_or_else(damaged)?;
                (0..(257 - n).min(n_pixels - at)).for_each(|k| put(at + k, v));
                (at, packed) = (at + 257 - n, rest);
            } else {
                packed = rest;
            }
        }
    }
    Ok(Frame { patterns, bits: 8 * n_bytes as u32, signed: false })
}
