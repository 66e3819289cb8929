//! The metadata of a Zarr array: versions 2 (`.zarray`) and 3 (`zarr.json`).
//!
//! Everything is checked here, before memory is taken or a chunk is opened: axes, sizes of chunks, types, codecs.

use grainpath_core::slices::SampleType;
use serde_json::Value;

use super::codec::{Packing, Pipeline, Shards, ToBytes};
use crate::volume::{MAX_PIXELS, MAX_SLICES, VolumeError, VolumeProblem, error, unsupported};

/// Limit on an unpacked chunk, bytes. Source: derived. It holds 1024^3 voxels of 8 bits, or four slices of the largest
/// size ([`MAX_PIXELS`]) as 32-bit floats.
pub(super) const MAX_CHUNK_BYTES: u64 = 1 << 30;
/// Limit on the chunks within a shard. Source: derived. The shard's index is read at once; with 16 bytes for each chunk
/// it takes at most 16 MiB.
const MAX_IN_SHARD: u64 = 1 << 20;
/// Limit on the number of axes. Source: OME-Zarr has five (t, c, z, y, x); three more are allowed before them for plain
/// arrays.
const MAX_AXES: usize = 8;
/// The format's name in messages.
pub(super) const ZARR: &str = "Zarr";

/// An array: its grid of chunks, and how a chunk is unpacked.
#[derive(Debug, Clone)]
pub(super) struct Array {
    /// 2 or 3.
    pub version: u8,
    /// Voxels along each axis; the last three are z, y, x.
    pub shape: Vec<u64>,
    /// Voxels of one file along each axis. The file holds a chunk, or a shard of several chunks.
    pub chunk: Vec<u64>,
    /// Stands between the numbers in the name of a chunk's file: `.` or `/`.
    pub separator: char,
    /// Whether names of chunks' files begin with `c`.
    pub prefixed: bool,
    pub sample: SampleType,
    /// The bytes of every voxel of a missing chunk, in the byte order of the other voxels.
    pub fill: Vec<u8>,
    /// The codecs of a file.
    pub pipeline: Pipeline,
}

impl Array {
    /// Voxels, along each axis, of the unit that is unpacked at a time: a chunk, whether in a shard or in its own file.
    pub(super) fn unit(&self) -> &[u64] {
        match &self.pipeline.to_bytes {
            ToBytes::Shards(shards) => &shards.chunk,
            ToBytes::Plain { .. } => &self.chunk,
        }
    }

    /// The codecs of a unit.
    pub(super) fn unit_pipeline(&self) -> &Pipeline {
        match &self.pipeline.to_bytes {
            ToBytes::Shards(shards) => &shards.pipeline,
            ToBytes::Plain { .. } => &self.pipeline,
        }
    }

    /// Whether the most significant byte of a voxel comes first.
    pub(super) fn big_endian(&self) -> bool {
        matches!(self.unit_pipeline().to_bytes, ToBytes::Plain { big_endian: true })
    }

    /// The name, within the array, of the file at this place in the grid.
    pub(super) fn key(&self, at: &[u64]) -> String {
        let mut out = String::new();
        if self.prefixed {
            out.push('c');
        }
        for index in at {
            if !out.is_empty() {
                out.push(self.separator);
            }
            out.push_str(&index.to_string());
        }
        out
    }

    /// Names of the packings, for messages.
    pub(super) fn codec(&self) -> String {
        let mut words: Vec<String> = Vec::new();
        if let ToBytes::Shards(_) = self.pipeline.to_bytes {
            words.push("sharded".into());
        }
        words.extend(self.unit_pipeline().packed.iter().map(|p| p.name().to_owned()));
        if words.is_empty() { "none".to_owned() } else { words.join(", ") }
    }
}

fn field(file: &str, field: &'static str, found: &Value, expected: &str) -> VolumeError {
    let mut found = found.to_string();
    // A hostile value may be as long as the file.
    if found.chars().count() > 60 {
        found = found.chars().take(57).chain("...".chars()).collect();
    }
    error(file, VolumeProblem::Field { format: ZARR, field, found, expected: expected.to_owned() })
}

fn sizes(file: &str, name: &'static str, value: &Value) -> Result<Vec<u64>, VolumeError> {
    let list = value.as_array().and_then(|all| all.iter().map(Value::as_u64).collect::<Option<Vec<u64>>>());
    list.ok_or_else(|| field(file, name, value, "a list of whole numbers"))
}

/// Reads `.zarray` or an array's `zarr.json`.
pub(super) fn array(file: &str, meta: &Value) -> Result<Array, VolumeError> {
    let array = match meta["zarr_format"].as_u64() {
        Some(2) => version_2(file, meta)?,
        Some(3) => version_3(file, meta)?,
        _ => return Err(field(file, "zarr_format", &meta["zarr_format"], "2 or 3")),
    };
    check(file, &array)?;
    Ok(array)
}

fn version_2(file: &str, meta: &Value) -> Result<Array, VolumeError> {
    let dtype = meta["dtype"].as_str().unwrap_or_default();
    let (order, kind) = dtype.split_at_checked(1).unwrap_or_default();
    let sample = match kind {
        "u1" | "b1" => Some(SampleType::U8),
        "i1" => Some(SampleType::I8),
        "u2" => Some(SampleType::U16),
        "i2" => Some(SampleType::I16),
        "u4" => Some(SampleType::U32),
        "i4" => Some(SampleType::I32),
        "f4" => Some(SampleType::F32),
        "f8" => Some(SampleType::F64),
        _ => None,
    };
    let sample = sample.filter(|_| ["<", ">", "|"].contains(&order));
    let sample = sample.ok_or_else(|| wrong_type(file, &meta["dtype"]))?;
    let big_endian = order == ">";
    let shape = sizes(file, "shape", &meta["shape"])?;
    let transposed = match meta["order"].as_str() {
        Some("C") | None => None,
        Some("F") => Some((0..shape.len()).rev().collect()),
        Some(_) => return Err(field(file, "order", &meta["order"], "C or F")),
    };
    if let Some(filter) = meta["filters"].as_array().and_then(|all| all.first()) {
        return Err(unsupported(file, format!("the filter {}", filter["id"]), "store it without filters"));
    }
    let packed = match &meta["compressor"] {
        Value::Null => Vec::new(),
        compressor => vec![packing(file, compressor["id"].as_str().unwrap_or_default(), compressor)?],
    };
    let separator = match meta["dimension_separator"].as_str() {
        Some(".") | None => '.',
        Some("/") => '/',
        Some(_) => return Err(field(file, "dimension_separator", &meta["dimension_separator"], ". or /")),
    };
    Ok(Array {
        version: 2,
        chunk: sizes(file, "chunks", &meta["chunks"])?,
        separator,
        prefixed: false,
        sample,
        fill: fill(file, sample, big_endian, &meta["fill_value"])?,
        pipeline: Pipeline { transposed, to_bytes: ToBytes::Plain { big_endian }, packed },
        shape,
    })
}

fn version_3(file: &str, meta: &Value) -> Result<Array, VolumeError> {
    let sample = match meta["data_type"].as_str() {
        Some("uint8" | "bool") => SampleType::U8,
        Some("int8") => SampleType::I8,
        Some("uint16") => SampleType::U16,
        Some("int16") => SampleType::I16,
        Some("uint32") => SampleType::U32,
        Some("int32") => SampleType::I32,
        Some("float32") => SampleType::F32,
        Some("float64") => SampleType::F64,
        _ => return Err(wrong_type(file, &meta["data_type"])),
    };
    let shape = sizes(file, "shape", &meta["shape"])?;
    let (grid, keys) = (&meta["chunk_grid"], &meta["chunk_key_encoding"]);
    if grid["name"] != "regular" {
        return Err(field(file, "chunk_grid", &grid["name"], "regular"));
    }
    let prefixed = match keys["name"].as_str() {
        Some("default") => true,
        Some("v2") => false,
        _ => return Err(field(file, "chunk_key_encoding", &keys["name"], "default or v2")),
    };
    let separator = match keys["configuration"]["separator"].as_str() {
        Some(".") => '.',
        Some("/") => '/',
        None if prefixed => '/',
        None => '.',
        Some(_) => return Err(field(file, "separator", &keys["configuration"]["separator"], ". or /")),
    };
    if let Some(transformer) = meta["storage_transformers"].as_array().and_then(|all| all.first()) {
        let what = format!("the storage transformer {}", transformer["name"]);
        return Err(unsupported(file, what, "store it without one"));
    }
    let pipeline = pipeline(file, &meta["codecs"], shape.len(), true)?;
    let mut array = Array {
        version: 3,
        chunk: sizes(file, "chunk_shape", &grid["configuration"]["chunk_shape"])?,
        shape,
        separator,
        prefixed,
        sample,
        fill: Vec::new(),
        pipeline,
    };
    array.fill = fill(file, sample, array.big_endian(), &meta["fill_value"])?;
    Ok(array)
}

fn wrong_type(file: &str, found: &Value) -> VolumeError {
    field(file, "type", found, "integers of 8 to 32 bits and floats of 32 and 64 bits")
}

/// Reads a list of codecs: at most one reordering of axes, then the conversion to bytes, then the packings. `outer`
/// says whether the conversion may be into shards; chunks within a shard are not sharded again.
fn pipeline(file: &str, codecs: &Value, n_axes: usize, outer: bool) -> Result<Pipeline, VolumeError> {
    let (mut transposed, mut to_bytes, mut packed) = (None, None, Vec::new());
    for codec in codecs.as_array().map_or(&[][..], Vec::as_slice) {
        let (name, with) =
            (codec["name"].as_str().or(codec.as_str()).unwrap_or_default(), &codec["configuration"]);
        match (name, &to_bytes) {
            ("transpose", None) if transposed.is_none() => {
                transposed = Some(order(file, &with["order"], n_axes)?);
            }
            ("bytes", None) => {
                let big_endian = match with["endian"].as_str() {
                    Some("big") => true,
                    Some("little") | None => false,
                    Some(_) => return Err(field(file, "endian", &with["endian"], "little or big")),
                };
                to_bytes = Some(ToBytes::Plain { big_endian });
            }
            ("sharding_indexed", None) if outer && transposed.is_none() => {
                to_bytes = Some(ToBytes::Shards(Box::new(shards(file, with, n_axes)?)));
            }
            (name, Some(ToBytes::Plain { .. })) => packed.push(packing(file, name, with)?),
            _ => {
                return Err(unsupported(
                    file,
                    format!("the codec {name:?} at this place"),
                    "transpose, bytes or sharding_indexed, then gzip, zlib, zstd, lz4, blosc and crc32c are read",
                ));
            }
        }
    }
    let missing = || error(file, VolumeProblem::MissingField { format: ZARR, field: "codec bytes".into() });
    Ok(Pipeline { transposed, to_bytes: to_bytes.ok_or_else(missing)?, packed })
}

fn order(file: &str, value: &Value, n_axes: usize) -> Result<Vec<usize>, VolumeError> {
    let all = sizes(file, "order", value)?;
    let mut sorted = all.clone();
    sorted.sort_unstable();
    if !sorted.into_iter().eq(0..n_axes as u64) {
        return Err(field(file, "order", value, "each axis once"));
    }
    Ok(all.into_iter().map(|axis| axis as usize).collect())
}

fn shards(file: &str, with: &Value, n_axes: usize) -> Result<Shards, VolumeError> {
    let chunk = sizes(file, "chunk_shape", &with["chunk_shape"])?;
    let pipeline = pipeline(file, &with["codecs"], n_axes, false)?;
    let index = self::pipeline(file, &with["index_codecs"], 1, false)?;
    let checked = match index.packed.as_slice() {
        [] => false,
        [Packing::Crc32c] => true,
        _ => return Err(field(file, "index_codecs", &with["index_codecs"], "bytes and crc32c")),
    };
    let at_end = match with["index_location"].as_str() {
        Some("end") | None => true,
        Some("start") => false,
        Some(_) => return Err(field(file, "index_location", &with["index_location"], "start or end")),
    };
    let big_endian = matches!(index.to_bytes, ToBytes::Plain { big_endian: true });
    Ok(Shards { chunk, pipeline, big_endian, checked, at_end })
}

fn packing(file: &str, name: &str, with: &Value) -> Result<Packing, VolumeError> {
    match name.strip_prefix("numcodecs.").unwrap_or(name) {
        "gzip" => Ok(Packing::Gzip),
        "zlib" => Ok(Packing::Zlib),
        "zstd" => Ok(Packing::Zstd),
        "lz4" => Ok(Packing::Lz4),
        "crc32c" => Ok(Packing::Crc32c),
        "blosc" => match with["cname"].as_str() {
            Some("snappy") => {
                Err(unsupported(file, "blosc with snappy", "pack with lz4, zstd, zlib or blosclz"))
            }
            _ => Ok(Packing::Blosc),
        },
        _ => {
            let name = Value::from(name);
            Err(field(file, "codec", &name, "gzip, zlib, zstd, lz4, blosc and crc32c"))
        }
    }
}

/// The bytes of the fill value.
fn fill(file: &str, sample: SampleType, big_endian: bool, value: &Value) -> Result<Vec<u8>, VolumeError> {
    use SampleType::{F32, F64, I8, I16, I32, U8, U16, U32};
    let wrong = || field(file, "fill_value", value, "a number of the array's type");
    let mut bytes = match sample {
        F32 | F64 => {
            let number = match value {
                Value::Null => 0.0,
                Value::String(word) => match (word.as_str(), word.strip_prefix("0x")) {
                    ("NaN", _) => f64::NAN,
                    ("Infinity", _) => f64::INFINITY,
                    ("-Infinity", _) => f64::NEG_INFINITY,
                    (_, Some(hex)) if sample == F32 => {
                        f64::from(f32::from_bits(u32::from_str_radix(hex, 16).map_err(|_| wrong())?))
                    }
                    (_, Some(hex)) => f64::from_bits(u64::from_str_radix(hex, 16).map_err(|_| wrong())?),
                    _ => return Err(wrong()),
                },
                number => number.as_f64().ok_or_else(wrong)?,
            };
            if sample == F32 { (number as f32).to_le_bytes().to_vec() } else { number.to_le_bytes().to_vec() }
        }
        _ => {
            // Version 2 allows 0.0 for integers. Floats hold whole numbers exactly up to 2^53, which is 9.007e15.
            let whole = |v: f64| (v == v.trunc() && v.abs() < 9e15).then_some(v as i64);
            let number = match value {
                Value::Null => 0,
                Value::Bool(set) => i64::from(*set),
                number => number.as_i64().or(number.as_f64().and_then(whole)).ok_or_else(wrong)?,
            };
            let range = match sample {
                U8 => 0..=i64::from(u8::MAX),
                I8 => i64::from(i8::MIN)..=i64::from(i8::MAX),
                U16 => 0..=i64::from(u16::MAX),
                I16 => i64::from(i16::MIN)..=i64::from(i16::MAX),
                U32 => 0..=i64::from(u32::MAX),
                I32 | F32 | F64 => i64::from(i32::MIN)..=i64::from(i32::MAX),
            };
            if !range.contains(&number) {
                return Err(wrong());
            }
            number.to_le_bytes()[..sample.n_bytes()].to_vec()
        }
    };
    if big_endian {
        bytes.reverse();
    }
    Ok(bytes)
}

/// Checks that the number of axes and the sizes are valid and within their limits.
fn check(file: &str, array: &Array) -> Result<(), VolumeError> {
    let n_axes = array.shape.len();
    if !(3..=MAX_AXES).contains(&n_axes) {
        return Err(error(file, VolumeProblem::OtherAxes { format: ZARR, n_axes }));
    }
    let size = [array.shape[n_axes - 1], array.shape[n_axes - 2], array.shape[n_axes - 3]]
        .map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    if array.shape.contains(&0) {
        return Err(error(file, VolumeProblem::Empty { size }));
    }
    if size[0].saturating_mul(size[1]) > MAX_PIXELS || size[2] > MAX_SLICES {
        return Err(error(file, VolumeProblem::TooLarge { size }));
    }
    let wrong = |chunk: &[u64], expected: String| field(file, "chunk shape", &Value::from(chunk), &expected);
    for chunk in [&array.chunk[..], array.unit()] {
        if chunk.len() != n_axes || chunk.contains(&0) {
            return Err(wrong(chunk, format!("{n_axes} numbers above 0")));
        }
    }
    let product = |chunk: &[u64]| chunk.iter().try_fold(1u64, |all, n| all.checked_mul(*n));
    let bytes = product(array.unit()).and_then(|n| n.checked_mul(array.sample.n_bytes() as u64));
    if bytes.is_none_or(|n| n > MAX_CHUNK_BYTES) {
        return Err(wrong(array.unit(), format!("at most {} MiB a chunk", MAX_CHUNK_BYTES >> 20)));
    }
    if let ToBytes::Shards(shards) = &array.pipeline.to_bytes {
        if array.chunk.iter().zip(&shards.chunk).any(|(outer, inner)| outer % inner != 0) {
            return Err(wrong(&shards.chunk, format!("a divisor of the shard {:?}", array.chunk)));
        }
        let within: Vec<u64> = array.chunk.iter().zip(&shards.chunk).map(|(a, b)| a / b).collect();
        if product(&within).is_none_or(|n| n > MAX_IN_SHARD) {
            return Err(wrong(&shards.chunk, format!("at most {MAX_IN_SHARD} chunks a shard")));
        }
    }
    Ok(())
}
