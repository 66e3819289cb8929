//! Writes volumes as a 16-bit multipage TIFF that states its voxel size the way `ImageJ` does.

use std::io::{self, Write};

/// Writes a stack of `size` (columns, rows, slices) with the voxel size `spacing_mm`, one slice after
/// another. Only the slice that `slice` returns is held in memory.
///
/// # Errors
/// Errors of `out`; [`io::ErrorKind::InvalidInput`] for more than 4 GiB or a slice of another size.
pub fn write_tiff_stack(
    size: [usize; 3],
    spacing_mm: [f64; 3],
    mut slice: impl FnMut(usize) -> Vec<u16>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let invalid = |what: &str| io::Error::new(io::ErrorKind::InvalidInput, what.to_owned());
    let [nx, ny, n] = size;
    let mut description =
        format!("ImageJ=1.53\nimages={n}\nslices={n}\nunit=mm\nspacing={}\n", spacing_mm[2]).into_bytes();
    // TIFF 6.0: text ends with a zero byte, and offsets of values are even.
    description.push(0);
    description.resize(description.len().next_multiple_of(2), 0);
    let data = nx * ny * 2;
    // A page holds its pixels, its directory, the description and two resolutions, always of the same
    // size, so every offset follows from the page's number.
    let directory = 2 + 12 * 13 + 4;
    let page = data + directory + description.len() + 16;
    // Offsets of classic TIFF have 32 bits.
    if (page as u64).saturating_mul(n as u64) > u64::from(u32::MAX) - 8 {
        return Err(invalid("a TIFF of more than 4 GiB"));
    }
    let at = |k: usize| (8 + k * page) as u32;
    out.write_all(b"II*\0")?;
    out.write_all(&(at(0) + data as u32).to_le_bytes())?;
    for k in 0..n {
        let values = slice(k);
        if values.len() != nx * ny {
            return Err(invalid("a slice of another size"));
        }
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        out.write_all(&bytes)?;
        let text = at(k) + (data + directory) as u32;
        let resolution = text + description.len() as u32;
        // Tags in ascending order, as TIFF 6.0 demands: width, length, bits, compression, photometric
        // interpretation, description, strip offset, samples, rows of the strip, strip bytes, x and y
        // resolution, unit.
        let entries: [(u16, u16, u32, u32); 13] = [
            (256, 4, 1, nx as u32),
            (257, 4, 1, ny as u32),
            (258, 3, 1, 16),
            (259, 3, 1, 1),
            (262, 3, 1, 1),
            (270, 2, description.len() as u32, text),
            (273, 4, 1, at(k)),
            (277, 3, 1, 1),
            (278, 4, 1, ny as u32),
            (279, 4, 1, data as u32),
            (282, 5, 1, resolution),
            (283, 5, 1, resolution + 8),
            (296, 3, 1, 1),
        ];
        out.write_all(&(entries.len() as u16).to_le_bytes())?;
        for (tag, kind, count, value) in entries {
            out.write_all(&tag.to_le_bytes())?;
            out.write_all(&kind.to_le_bytes())?;
            out.write_all(&count.to_le_bytes())?;
            out.write_all(&value.to_le_bytes())?;
        }
        // 0 ends the list of pages.
        let next = if k + 1 < n { at(k + 1) + data as u32 } else { 0 };
        out.write_all(&next.to_le_bytes())?;
        out.write_all(&description)?;
        for mm in &spacing_mm[..2] {
            // Pixels per mm as the fraction 10^6 / (10^6 mm), which keeps six decimals of the voxel size.
            out.write_all(&1_000_000u32.to_le_bytes())?;
            out.write_all(&((mm * 1e6).round() as u32).to_le_bytes())?;
        }
    }
    Ok(())
}
