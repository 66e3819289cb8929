//! Unpacks the frames of Blosc 1, with which most programs pack OME-Zarr 0.4.
//!
//! A frame is a header of 16 bytes, the positions of its blocks, and the blocks. Each block is packed by itself, after its
//! bytes (or bits) of equal weight were grouped. It may be split into one stream for each byte of a voxel.
//! Source: the description of the format in C-Blosc 1 (`README_CHUNK_FORMAT.rst`, `blosc.c`; BSD). Cost: linear. Limits:
//! blosclz, lz4, zlib and zstd are read; snappy and the frames of Blosc 2 are refused.

use flate2::bufread::ZlibDecoder;

use super::packed::{inflated, zstd};

/// Bytes of the header. Source: the description of the format, as above.
const HEADER: usize = 16;
/// A block is split only if its voxels have at most this many bytes. Source: `MAX_SPLITS` of C-Blosc 1.
const MAX_SPLITS: usize = 16;
/// A block is split only if each of its streams has at least this many bytes. Source: `MIN_BUFFERSIZE` of C-Blosc 1.
const MIN_STREAM: usize = 128;
/// Matches of blosclz at a larger distance state it in 16 bits. Source: `MAX_DISTANCE` of C-Blosc 1.
const FAR: usize = 8191;

/// Unpacks the voxels of a frame; more than `limit` bytes are an error.
pub(super) fn unpack(frame: &[u8], limit: usize) -> Result<Vec<u8>, String> {
    let short = || "blosc: cut short".to_owned();
    let number = |at: usize| -> Result<usize, String> {
        let bytes = frame.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok()).ok_or_else(short)?;
        Ok(u32::from_le_bytes(bytes) as usize)
    };
    let (size, block, packed) = (number(4)?, number(8)?, number(12)?);
    let &[version, _, flags, n_bytes, ..] = frame else { return Err(short()) };
    if version > 2 {
        return Err(format!("blosc: version {version} of the format; 1 and 2 are read"));
    }
    if size > limit {
        return Err(format!("blosc: {size} bytes; at most {limit} are needed"));
    }
    let frame = frame.get(..packed).ok_or_else(short)?;
    if size == 0 {
        return Ok(Vec::new());
    }
    if flags & 2 != 0 {
        return frame.get(HEADER..HEADER + size).map(<[u8]>::to_vec).ok_or_else(short);
    }
    if block == 0 || n_bytes == 0 {
        return Err("blosc: blocks or voxels of 0 bytes".to_owned());
    }
    let n_bytes = usize::from(n_bytes);
    let shuffled = if flags & 1 != 0 && n_bytes > 1 {
        Shuffled::Bytes
    } else if flags & 4 != 0 && block >= n_bytes {
        Shuffled::Bits
    } else {
        Shuffled::No
    };
    let mut out = vec![0; size];
    let mut streams = Vec::new();
    for (k, out) in out.chunks_mut(block.min(size)).enumerate() {
        let whole = out.len() == block;
        let split = flags & 16 == 0 && n_bytes <= MAX_SPLITS && block / n_bytes >= MIN_STREAM && whole;
        let n_streams = if split { n_bytes } else { 1 };
        let stream = out.len() / n_streams;
        streams.clear();
        streams.resize(out.len(), 0);
        let mut at = number(HEADER + 4 * k)?;
        // If the bytes of a block cannot be divided among its streams, the block comes out too short and is refused below.
        for stream in streams.chunks_exact_mut(stream.max(1)) {
            let n = number_at(frame, at).ok_or_else(short)?;
            let bytes = frame.get(at + 4..).and_then(|rest| rest.get(..n)).ok_or_else(short)?;
            at += 4 + n;
            let found = if n == stream.len() {
                stream.copy_from_slice(bytes);
                n
            } else {
                unpack_stream(flags >> 5, bytes, stream)?
            };
            if found != stream.len() {
                return Err(format!("blosc: a block of {found} bytes; {} are needed", stream.len()));
            }
        }
        match shuffled {
            Shuffled::No => out.copy_from_slice(&streams),
            Shuffled::Bytes => unshuffle_bytes(&streams, n_bytes, out),
            Shuffled::Bits => unshuffle_bits(&streams, n_bytes, out),
        }
    }
    Ok(out)
}

#[derive(Debug, Clone, Copy)]
enum Shuffled {
    No,
    Bytes,
    Bits,
}

fn number_at(frame: &[u8], at: usize) -> Option<usize> {
    let bytes = frame.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*bytes) as usize)
}

fn unpack_stream(codec: u8, bytes: &[u8], out: &mut [u8]) -> Result<usize, String> {
    match codec {
        0 => blosclz(bytes, out).ok_or_else(|| "blosc: damaged blosclz".to_owned()),
        1 => lz4_flex::block::decompress_into(bytes, out).map_err(|e| format!("blosc: lz4: {e}")),
        3 => {
            let all =
                inflated(ZlibDecoder::new(bytes), out.len()).map_err(|e| format!("blosc: zlib: {e}"))?;
            out[..all.len()].copy_from_slice(&all);
            Ok(all.len())
        }
        4 => zstd(bytes, out).map_err(|e| format!("blosc: {e}")),
        2 => Err("blosc: packed with snappy; pack with lz4, zstd, zlib or blosclz".to_owned()),
        other => Err(format!("blosc: codec {other} is not known")),
    }
}

/// Undoes the byte shuffle: puts the bytes of each voxel next to each other.
fn unshuffle_bytes(stored: &[u8], n_bytes: usize, out: &mut [u8]) {
    let n = stored.len() / n_bytes;
    for byte in 0..n_bytes {
        let plane = &stored[byte * n..(byte + 1) * n];
        out.iter_mut().skip(byte).step_by(n_bytes).zip(plane).for_each(|(to, from)| *to = *from);
    }
    out[n * n_bytes..].copy_from_slice(&stored[n * n_bytes..]);
}

/// Undoes the bit shuffle: bit `b` of byte `j` of all voxels is row `8 j + b`.
fn unshuffle_bits(stored: &[u8], n_bytes: usize, out: &mut [u8]) {
    let n = stored.len() / n_bytes;
    // C-Blosc does not shuffle the bits of a block if its number of voxels is not a multiple of 8.
    if !n.is_multiple_of(8) || n == 0 {
        out.copy_from_slice(stored);
        return;
    }
    out[..n * n_bytes].fill(0);
    for row in 0..8 * n_bytes {
        let (byte, bit) = (row / 8, row % 8);
        for (k, bits) in stored[row * n / 8..(row + 1) * n / 8].iter().enumerate() {
            for voxel in 0..8 {
                out[(8 * k + voxel) * n_bytes + byte] |= ((bits >> voxel) & 1) << bit;
            }
        }
    }
    out[n * n_bytes..].copy_from_slice(&stored[n * n_bytes..]);
}

/// Unpacks blosclz: literals and matches, told by the first byte of each; `None` where it is damaged.
fn blosclz(bytes: &[u8], out: &mut [u8]) -> Option<usize> {
    let (mut at, mut n) = (1, 0_usize);
    let mut control = usize::from(bytes.first()? & 31);
    loop {
        if control >= 32 {
            let (mut length, mut far) = ((control >> 5) - 1, (control & 31) << 8);
            if length == 6 {
                loop {
                    let more = *bytes.get(at)?;
                    at += 1;
                    length += usize::from(more);
                    if more != 255 {
                        break;
                    }
                }
            }
            let code = *bytes.get(at)?;
            at += 1;
            length += 3;
            if code == 255 && far == 31 << 8 {
                let distance = bytes.get(at..at + 2)?;
                at += 2;
                far = (usize::from(distance[0]) << 8) + usize::from(distance[1]) + FAR;
            } else {
                far += usize::from(code);
            }
            // The distance is counted from the byte before the current one.
            let from = n.checked_sub(far + 1)?;
            if length > out.len() - n {
                return None;
            }
            // A match may overlap the bytes that it writes, so it is copied byte by byte.
            for k in 0..length {
                out[n + k] = out[from + k];
            }
            n += length;
        } else {
            let literals = bytes.get(at..at + control + 1)?;
            out.get_mut(n..n + literals.len())?.copy_from_slice(literals);
            at += literals.len();
            n += literals.len();
        }
        match bytes.get(at) {
            Some(next) => control = usize::from(*next),
            None => return Some(n),
        }
        at += 1;
    }
}
