//! Unpacks streams whose unpacked size is known; a stream that gives more is an error.

use std::io::Read;

/// Unpacks a stream; more than `limit` unpacked bytes are an error.
pub(super) fn inflated(reader: impl Read, limit: usize) -> Result<Vec<u8>, String> {
    let mut out = Vec::new();
    reader.take(limit as u64 + 1).read_to_end(&mut out).map_err(|e| e.to_string())?;
    if out.len() > limit {
        return Err(format!("more than {limit} bytes of voxels"));
    }
    Ok(out)
}

/// Unpacks all frames into `out` and returns their total length.
pub(super) fn zstd(bytes: &[u8], out: &mut [u8]) -> Result<usize, String> {
    let mut decoder = ruzstd::decoding::FrameDecoder::new();
    // A frame that was packed in one step needs a window of its own size.
    decoder.set_max_window_size((out.len() as u64).max(ruzstd::decoding::DEFAULT_MAX_WINDOW_SIZE));
    let n = decoder.decode_all(bytes, out).map_err(|e| format!("zstd: {e}"))?;
    match (decoder.get_checksum_from_data(), decoder.get_calculated_checksum()) {
        (Some(stated), Some(found)) if stated != found => Err("zstd: the checksum differs".to_owned()),
        _ => Ok(n),
    }
}
