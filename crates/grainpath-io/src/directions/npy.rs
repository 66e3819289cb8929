//! Arrays of numpy: `.npy`, and `.npz`, which is a zip archive of them.
//!
//! The format (`numpy.lib.format`): the magic `\x93NUMPY`, a version, the length of a header, and
//! the header, the text of a Python dictionary with the type of an entry (`descr`), the order of
//! the indices and the shape. The readers on crates.io (`npyz`, `ndarray-npy`) parse that one line
//! by a grammar of all Python literals, which brings a parser generator; only the three keys are
//! read here. Read are booleans, integers and floats of 4 and 8 bytes in either byte order, and
//! structured arrays of them. Objects (pickles), complex numbers and strings are refused.
//!
//! Memory: the size that the header states is checked against the bytes present. From an archive, no more than the stated
//! size is inflated.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::model::{DirectionError, DirectionProblem, MAX_CELLS, invalid, within};

/// An array with all numbers in the order of C, the last index fastest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub shape: Vec<usize>,
    /// Each field of a structured array: its name, and a number for every entry. A plain array has one field without a
    /// name.
    pub fields: Vec<(String, Vec<f64>)>,
}

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Limit on the numbers in a file. Source: derived: a cell of a grid has at most the three components of a
/// vector.
const MAX_NUMBERS: usize = 3 * MAX_CELLS;
/// Limit on the header, bytes. Source: derived: a field takes some 30 bytes, so that [`MAX_ARRAYS`] fields
/// fit.
const MAX_HEADER: usize = 1 << 16;
/// Limit on the arrays in an archive. Source: derived: each is a column, and a table has at most 256 columns.
const MAX_ARRAYS: usize = 256;

/// The type of a number in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Number {
    kind: u8,
    size: usize,
    big_endian: bool,
}

impl Number {
    fn parse(descr: &str, place: &str) -> Result<Self, DirectionError> {
        let refused = || invalid(place, DirectionProblem::Type(descr.chars().take(40).collect()));
        let (order, rest) = match descr.as_bytes() {
            [o @ (b'<' | b'>' | b'|' | b'='), rest @ ..] => (*o, rest),
            rest => (b'<', rest),
        };
        let [kind, size @ ..] = rest else { return Err(refused()) };
        let size =
            std::str::from_utf8(size).ok().and_then(|s| s.parse::<usize>().ok()).ok_or_else(refused)?;
        let known = match kind {
            b'f' => [4, 8].contains(&size),
            b'i' | b'u' => [1, 2, 4, 8].contains(&size),
            b'b' => size == 1,
            _ => false,
        };
        if known { Ok(Self { kind: *kind, size, big_endian: order == b'>' }) } else { Err(refused()) }
    }

    /// The number in exactly `size` bytes.
    fn read(self, bytes: &[u8]) -> f64 {
        let mut little = [0u8; 8];
        little[..self.size].copy_from_slice(bytes);
        if self.big_endian {
            little[..self.size].reverse();
        }
        let raw = u64::from_le_bytes(little);
        let unused = 64 - 8 * self.size as u32;
        match (self.kind, self.size) {
            (b'f', 4) => f64::from(f32::from_bits(raw as u32)),
            (b'f', _) => f64::from_bits(raw),
            (b'i', _) => ((raw << unused) as i64 >> unused) as f64,
            _ => raw as f64,
        }
    }
}

/// The contents of a header.
struct Header {
    /// For each field its offset in an entry, its type and its name.
    fields: Vec<(usize, Number, String)>,
    entry_size: usize,
    fortran_order: bool,
    shape: Vec<usize>,
    /// Entries.
    n: usize,
}

impl Header {
    fn parse(text: &str, place: &str) -> Result<Self, DirectionError> {
        let bad = |what: &'static str| invalid(place, DirectionProblem::NotStated(what));
        let value = |key: &str| {
            let at = ['\'', '"'].iter().find_map(|q| text.find(&format!("{q}{key}{q}")))?;
            text[at + key.len() + 2..].trim_start().strip_prefix(':').map(str::trim_start)
        };
        let descr = value("descr").ok_or_else(|| bad("a type"))?;
        let mut fields = Vec::new();
        let mut entry_size = 0;
        if let Some(list) = descr.strip_prefix('[') {
            let list = list.split(']').next().unwrap_or_default();
            for item in list.split('(').skip(1) {
                let words: Vec<&str> = quoted(item).take(2).collect();
                let [name, kind] = words[..] else { return Err(bad("the fields of its type")) };
                if item.matches('(').count() > 0
                    || item.trim_end().trim_end_matches([',', ' ']).matches(',').count() > 1
                {
                    return Err(invalid(place, DirectionProblem::FieldOfArrays(name.to_owned())));
                }
                let number = Number::parse(kind, place)?;
                fields.push((entry_size, number, name.to_owned()));
                entry_size += number.size;
            }
            if fields.len() > MAX_ARRAYS {
                return Err(DirectionError::TooMany {
                    what: "fields",
                    found: fields.len() as u64,
                    limit: MAX_ARRAYS,
                });
            }
        } else {
            let number = Number::parse(quoted(descr).next().ok_or_else(|| bad("a type"))?, place)?;
            entry_size = number.size;
            fields.push((0, number, String::new()));
        }
        if fields.is_empty() {
            return Err(bad("a type"));
        }
        let fortran_order = value("fortran_order").is_some_and(|v| v.starts_with("True"));
        let shape = value("shape").and_then(|v| v.strip_prefix('(')).and_then(|v| v.split(')').next());
        let numbers =
            shape.ok_or_else(|| bad("a shape"))?.split(',').map(str::trim).filter(|w| !w.is_empty());
        let shape: Option<Vec<usize>> = numbers.map(|w| w.parse().ok()).collect();
        let shape = shape.ok_or_else(|| bad("a shape"))?;
        let n = shape.iter().try_fold(1usize, |n, &k| n.checked_mul(k)).unwrap_or(usize::MAX);
        let total = n.saturating_mul(fields.len());
        if total > MAX_NUMBERS {
            return Err(DirectionError::TooMany { what: "numbers", found: total as u64, limit: MAX_NUMBERS });
        }
        Ok(Self { fields, entry_size, fortran_order, shape, n })
    }
}

/// The words between quotation marks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split(['\'', '"']).skip(1).step_by(2)
}

/// Reads an array from a stream; `place` is its name in errors.
fn read_stream(mut stream: impl Read, place: &str) -> Result<Array, DirectionError> {
    let cut = |_| invalid(place, DirectionProblem::HeaderEnds);
    let mut start = [0u8; 8];
    stream.read_exact(&mut start).map_err(cut)?;
    if !start.starts_with(MAGIC) {
        return Err(invalid(place, DirectionProblem::NotNumpy));
    }
    let mut length = [0u8; 4];
    let width = if start[6] >= 2 { 4 } else { 2 };
    stream.read_exact(&mut length[..width]).map_err(cut)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_HEADER {
        return Err(invalid(place, DirectionProblem::Header { found: length, limit: MAX_HEADER }));
    }
    let mut text = vec![0u8; length];
    stream.read_exact(&mut text).map_err(cut)?;
    let header = Header::parse(&String::from_utf8_lossy(&text), place)?;
    // The limit on numbers bounds this: each number has eight bytes at most.
    let wanted = header.n * header.entry_size;
    let mut bytes = Vec::new();
    let found = stream.take(wanted as u64).read_to_end(&mut bytes);
    found.map_err(|e| invalid(place, DirectionProblem::Archive(e.to_string())))?;
    if bytes.len() < wanted {
        let problem = DirectionProblem::Bytes { shape: header.shape, wanted, found: bytes.len() };
        return Err(invalid(place, problem));
    }
    let fields = header.fields.iter().map(|(offset, number, name)| {
        let entry = |e: &[u8]| number.read(&e[*offset..*offset + number.size]);
        let values: Vec<f64> = bytes.chunks_exact(header.entry_size).map(entry).collect();
        (name.clone(), if header.fortran_order { in_c_order(&values, &header.shape) } else { values })
    });
    Ok(Array { fields: fields.collect(), shape: header.shape })
}

/// Reorders numbers from Fortran order (first index fastest) to C order (last index fastest).
fn in_c_order(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    let mut index = vec![0usize; shape.len()];
    for &v in values {
        let at = index.iter().zip(shape).fold(0, |at, (i, n)| at * n + i);
        out[at] = v;
        for (i, n) in index.iter_mut().zip(shape) {
            *i += 1;
            if *i < *n {
                break;
            }
            *i = 0;
        }
    }
    out
}

/// Reads a `.npy` file.
pub(super) fn read_npy(bytes: &[u8], place: &str) -> Result<Array, DirectionError> {
    read_stream(bytes, place)
}

/// Reads all arrays of a `.npz` file, with their names, in the order of the file.
pub(super) fn read_npz(bytes: &[u8], place: &str) -> Result<Vec<(String, Array)>, DirectionError> {
    let mut zip = ZipArchive::new(Cursor::new(bytes))
        .map_err(|e| invalid(place, DirectionProblem::Archive(e.to_string())))?;
    if zip.len() > MAX_ARRAYS {
        return Err(DirectionError::TooMany { what: "arrays", found: zip.len() as u64, limit: MAX_ARRAYS });
    }
    let mut out = Vec::new();
    let mut numbers = 0usize;
    for i in 0..zip.len() {
        let name = zip.name_for_index(i).and_then(Result::ok).map(|n| n.into_owned()).unwrap_or_default();
        let Some(key) = name.strip_suffix(".npy") else { continue };
        let file = zip.by_index(i).map_err(|e| invalid(place, DirectionProblem::Archive(e.to_string())))?;
        let array = read_stream(file, &within(place, format!("array {key}")))?;
        numbers += array.fields.iter().map(|(_, v)| v.len()).sum::<usize>();
        if numbers > MAX_NUMBERS {
            return Err(DirectionError::TooMany {
                what: "numbers",
                found: numbers as u64,
                limit: MAX_NUMBERS,
            });
        }
        out.push((key.to_owned(), array));
    }
    Ok(out)
}
