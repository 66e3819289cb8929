//! Density in four steps of von Mises stress, as Strecs3D gives it to regions of a part.

use std::fmt::Write;
use std::io::Read;

use flate2::read::ZlibDecoder;

/// Densities of the four steps before they are scaled to a mass.
const STEPS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// The uppermost step begins at three quarters of the stress that this share of the nodes does not exceed. Source: that of
/// `by = "stress"`, so that both leave out the same peaks.
const FULL_SHARE: f64 = 0.98;
/// Arrays of a result file that are not a fixture or a load.
const RESULTS: [&str; 6] = ["U", "S", "von_Mises", "principal_max", "principal_mid", "principal_min"];

/// Densities at the nodes of a result file of ours, as CSV.
pub(super) fn csv(vtu: &[u8]) -> Result<String, String> {
    let arrays = arrays(vtu)?;
    let of = |name: &str| arrays.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_slice());
    let points = of("Points").ok_or("no points")?;
    let mises = of("von_Mises").ok_or("no von Mises stress")?;
    let sets: Vec<&[f64]> = arrays
        .iter()
        .filter(|(name, v)| !RESULTS.contains(&name.as_str()) && v.len() == mises.len())
        .map(|(_, v)| v.as_slice())
        .collect();
    let mut free: Vec<f64> =
        (0..mises.len()).filter(|&i| sets.iter().all(|s| s[i] == 0.0)).map(|i| mises[i]).collect();
    free.sort_by(f64::total_cmp);
    let full = free.get((FULL_SHARE * free.len() as f64) as usize).copied().ok_or("no free nodes")?;
    let flat = points.chunks(3).all(|p| p[2] == points[2]);
    let mut text = String::from(if flat { "x,y,density\n" } else { "x,y,z,density\n" });
    for (p, stress) in points.chunks(3).zip(mises) {
        let step = STEPS[((4.0 * stress / full) as usize).min(3)];
        let at = if flat { format!("{},{}", p[0], p[1]) } else { format!("{},{},{}", p[0], p[1], p[2]) };
        writeln!(text, "{at},{step}").map_err(|e| e.to_string())?;
    }
    Ok(text)
}

/// The arrays of doubles of a result file, by name.
fn arrays(vtu: &[u8]) -> Result<Vec<(String, Vec<f64>)>, String> {
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let begin = vtu.windows(mark.len()).position(|w| w == mark).ok_or("no appended data")?;
    let head = String::from_utf8_lossy(&vtu[..begin]).into_owned();
    let data = &vtu[begin + mark.len()..];
    let word = |tag: &str, key: &str| {
        let after = tag.split_once(&format!("{key}=\""))?.1;
        after.split_once('"').map(|(value, _)| value.to_owned())
    };
    let mut found = Vec::new();
    for tag in head.split("<DataArray ").skip(1).filter(|tag| tag.starts_with("type=\"Float64\"")) {
        let (name, offset) = (word(tag, " Name"), word(tag, "offset"));
        let (Some(name), Some(Ok(offset))) = (name, offset.map(|o| o.parse::<usize>())) else {
            return Err("an array without name or offset".into());
        };
        found.push((name, unpacked(data.get(offset..).ok_or("an offset beyond the data")?)?));
    }
    Ok(found)
}

/// The numbers of an array: number of blocks, their size, that of the last, the packed sizes, and the blocks.
fn unpacked(data: &[u8]) -> Result<Vec<f64>, String> {
    let short = || "an array is cut".to_owned();
    let word = |k: usize| -> Result<usize, String> {
        let bytes = data.get(8 * k..8 * k + 8).ok_or_else(short)?;
        Ok(u64::from_le_bytes(bytes.try_into().map_err(|_| short())?) as usize)
    };
    let n = word(0)?;
    let mut at = 8 * (3 + n);
    let mut bytes = Vec::new();
    for k in 0..n {
        let size = word(3 + k)?;
        let block = data.get(at..at + size).ok_or_else(short)?;
        ZlibDecoder::new(block).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
        at += size;
    }
    let numbers = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default()));
    Ok(numbers.collect())
}
