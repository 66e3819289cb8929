//! Unpacks chunks: gzip, zlib, zstd, lz4, blosc, CRC-32C, orders of axes, and the index of a shard.
//!
//! The unpacked size is known beforehand and limits every codec, so a decompression bomb gives an error.

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use super::blosc;
use super::packed::{inflated, zstd};

/// How a chunk is stored: its axes are reordered, its voxels written as bytes, and the bytes packed.
#[derive(Debug, Clone)]
pub(super) struct Pipeline {
    /// For each stored axis, the axis of the array that it holds.
    pub transposed: Option<Vec<usize>>,
    pub to_bytes: ToBytes,
    /// The packings in the order in which the writer applied them.
    pub packed: Vec<Packing>,
}

#[derive(Debug, Clone)]
pub(super) enum ToBytes {
    Plain { big_endian: bool },
    Shards(Box<Shards>),
}

/// Files that hold a grid of chunks and an index of their positions.
#[derive(Debug, Clone)]
pub(super) struct Shards {
    /// Voxels of a chunk along each axis.
    pub chunk: Vec<u64>,
    pub pipeline: Pipeline,
    /// Byte order of the index.
    pub big_endian: bool,
    /// Whether four bytes of CRC-32C follow the index.
    pub checked: bool,
    pub at_end: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Gzip,
    Zlib,
    Zstd,
    Lz4,
    Blosc,
    Crc32c,
}

impl Packing {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Gzip => "gzip",
            Self::Zlib => "zlib",
            Self::Zstd => "zstd",
            Self::Lz4 => "lz4",
            Self::Blosc => "blosc",
            Self::Crc32c => "crc32c",
        }
    }
}

/// Largest size of a packed chunk of `n` bytes, since packing may make it larger. Source: derived. Deflate adds 5 bytes for
/// each 16 KiB, lz4 one for each 255 bytes, zstd 3 for each 128 KiB, blosc 16 bytes and 4 for each block. A quarter of `n`
/// is more than any of these.
pub(super) const fn packed_limit(n: u64) -> u64 {
    n + n / 4 + (1 << 16)
}

/// The voxels of a chunk of `shape` in the order of the array, with `n_bytes` each.
pub(super) fn unpack(
    pipeline: &Pipeline,
    packed: Vec<u8>,
    shape: &[u64],
    n_bytes: usize,
) -> Result<Vec<u8>, String> {
    let expected = shape.iter().product::<u64>() as usize * n_bytes;
    let mut bytes = packed;
    for (k, packing) in pipeline.packed.iter().enumerate().rev() {
        // The output of one codec that another codec packed again may be larger than the voxels.
        let limit = if k == 0 { expected } else { packed_limit(expected as u64) as usize };
        bytes = unpack_one(*packing, &bytes, limit)?;
    }
    if bytes.len() != expected {
        return Err(format!("{} bytes of voxels; {expected} are needed", bytes.len()));
    }
    Ok(match &pipeline.transposed {
        Some(order) => in_order(&bytes, order, shape, n_bytes),
        None => bytes,
    })
}

fn unpack_one(packing: Packing, bytes: &[u8], limit: usize) -> Result<Vec<u8>, String> {
    match packing {
        Packing::Gzip => inflated(MultiGzDecoder::new(bytes), limit),
        Packing::Zlib => inflated(ZlibDecoder::new(bytes), limit),
        Packing::Zstd => {
            let mut out = vec![0; limit];
            let n = zstd(bytes, &mut out)?;
            out.truncate(n);
            Ok(out)
        }
        Packing::Lz4 => {
            // The size is before the block, as numcodecs writes it.
            let (size, block) = bytes.split_first_chunk::<4>().ok_or("lz4: cut short")?;
            let size = u32::from_le_bytes(*size) as usize;
            if size > limit {
                return Err(format!("lz4: {size} bytes; at most {limit} are needed"));
            }
            let mut out = vec![0; size];
            let n = lz4_flex::block::decompress_into(block, &mut out).map_err(|e| format!("lz4: {e}"))?;
            out.truncate(n);
            Ok(out)
        }
        Packing::Blosc => blosc::unpack(bytes, limit),
        Packing::Crc32c => checked(bytes).map(<[u8]>::to_vec),
    }
}

/// Checks the checksum at the end of the bytes and returns the bytes before it.
pub(super) fn checked(bytes: &[u8]) -> Result<&[u8], String> {
    let (data, stated) = bytes.split_last_chunk::<4>().ok_or("crc32c: cut short")?;
    if crc32c(data) == u32::from_le_bytes(*stated) {
        Ok(data)
    } else {
        Err("the checksum (crc32c) differs".to_owned())
    }
}

/// CRC-32C of Castagnoli. Source: RFC 3720, 12.1; the polynomial reversed.
pub(super) fn crc32c(bytes: &[u8]) -> u32 {
    // Source: derived from the polynomial, a row for each byte.
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut k = 0;
        while k < 256 {
            let (mut value, mut bit) = (k as u32, 0);
            while bit < 8 {
                value = if value & 1 == 1 { (value >> 1) ^ 0x82f6_3b78 } else { value >> 1 };
                bit += 1;
            }
            table[k] = value;
            k += 1;
        }
        table
    };
    !bytes.iter().fold(u32::MAX, |crc, &b| (crc >> 8) ^ TABLE[((crc ^ u32::from(b)) & 255) as usize])
}

/// Reorders voxels into the order of the array; their stored axis `j` is axis `order[j]` of the array.
fn in_order(stored: &[u8], order: &[usize], shape: &[u64], n_bytes: usize) -> Vec<u8> {
    let mut strides = vec![n_bytes; shape.len()];
    for axis in (0..shape.len().saturating_sub(1)).rev() {
        strides[axis] = strides[axis + 1] * shape[axis + 1] as usize;
    }
    let sizes: Vec<usize> = order.iter().map(|&axis| shape[axis] as usize).collect();
    let steps: Vec<usize> = order.iter().map(|&axis| strides[axis]).collect();
    let mut out = vec![0; stored.len()];
    let (mut at, mut place) = (vec![0; sizes.len()], 0);
    for voxel in stored.chunks_exact(n_bytes) {
        out[place..place + n_bytes].copy_from_slice(voxel);
        // Counts the position up; the last stored axis runs fastest.
        for j in (0..sizes.len()).rev() {
            at[j] += 1;
            place += steps[j];
            if at[j] < sizes[j] {
                break;
            }
            place -= steps[j] * sizes[j];
            at[j] = 0;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        // Source: RFC 3720, B.4: 32 bytes of zeros, of ones, and rising.
        assert_eq!(crc32c(&[0; 32]), 0x8a91_36aa);
        assert_eq!(crc32c(&[0xff; 32]), 0x62a8_ab43);
        assert_eq!(crc32c(&(0..32).collect::<Vec<u8>>()), 0x46dd_794e);
    }

    #[test]
    fn axes_come_back_in_order() {
        // Two by three by four, of two bytes: stored with x first.
        let shape = [2, 3, 4];
        let value = |z: u16, y: u16, x: u16| (100 * z + 10 * y + x).to_le_bytes();
        let (mut stored, mut plain) = (Vec::new(), Vec::new());
        for x in 0..4 {
            for z in 0..2 {
                (0..3).for_each(|y| stored.extend(value(z, y, x)));
            }
        }
        for z in 0..2 {
            for y in 0..3 {
                (0..4).for_each(|x| plain.extend(value(z, y, x)));
            }
        }
        assert_eq!(in_order(&stored, &[2, 0, 1], &shape, 2), plain);
    }
}
