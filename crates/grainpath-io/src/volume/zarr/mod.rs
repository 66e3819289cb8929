//! Scans in Zarr: arrays of version 2 and 3, and the images of OME-Zarr 0.4 and 0.5 with their levels and units.
//!
//! **Method.** The metadata are read and checked first. Slices then come from rows of chunks: the chunks that hold a slice
//! are unpacked and kept for the slices after it, so that each chunk is unpacked once. In a shard, only the index and the
//! needed chunks are read. A row larger than [`ROW_BYTES`] is unpacked in several slabs, its chunks once for each.
//! **Source.** Zarr core specifications 2 and 3; the sharding codec (ZEP 2); OME-NGFF 0.4 and 0.5, multiscales and axes.
//! **Units.** Spacings are the scale of the level times that of the whole image, converted from the units of the axes to mm.
//! A plain array has none.
//! **Cost.** Linear in the voxels. **Memory.** A row of chunks, and one chunk packed and unpacked.
//! **Limits.** Integers of 8 to 32 bits and floats; gzip, zlib, zstd, lz4, blosc (without snappy) and crc32c; of axes before
//! z, y, x only the first entry is read, with a warning. A missing chunk has the fill value, as Zarr defines; missing chunks
//! are counted.
//!
//! **Why the crate `zarrs` is not used.** Measured with 0.23.14: 134 crates to compile, most of them new here, three minutes
//! of building on two cores, and a program of 6.0 MB that does nothing but open an array, where a wheel of 8 MB has to hold
//! everything. Its blosc links the C++ library of the system. And its codecs take as much memory as a chunk of a few bytes
//! states: gzip unpacks to the end, and zstd reserves what the frame states. Untrusted files must not be able to do that
//! here. Everything that unpacks chunks here is in crates of Rust alone.

mod blosc;
mod codec;
mod metadata;
mod packed;

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};
use std::sync::Arc;

use grainpath_core::units::LengthUnit;
use grainpath_core::{Warning, WarningId};
use serde_json::Value;

use self::codec::{Shards, ToBytes, packed_limit};
use self::metadata::{Array, ZARR};
use super::{
    AnySlice, Files, Finite, InOrder, SliceError, SliceSource, VolumeError, VolumeInfo, VolumeProblem,
    damaged, error, io_error, sample, spacing,
};

/// Limit on the size of a metadata file. Source: derived. A group that repeats the descriptions of ten thousand arrays has
/// 10 MB.
const MAX_DESCRIPTION: u64 = 32 << 20;
/// Largest number of bytes that are kept of a row of chunks. Source: derived. 64 planes of 2048 x 2048 voxels of 16 bits
/// fill it.
const ROW_BYTES: u64 = 512 << 20;
/// Limit on the chunks of a row. Source: derived. Chunks of 4 x 4 voxels in the largest slice.
const MAX_IN_ROW: u64 = 1 << 22;
/// Number of folders above an array that are searched for the image it belongs to. Source: `image/scale0/image` of ngff-zarr
/// has two.
const MAX_UP: usize = 3;

/// Units of length of OME-Zarr that [`LengthUnit`] lacks, with their size in mm. Source: OME-NGFF 0.5, axes (UDUNITS-2).
const OTHER_UNITS_MM: [(&str, f64); 3] = [("angstrom", 1e-7), ("nanometer", 1e-6), ("decimeter", 100.0)];

/// The checksum of a shard's index, for the tests of the reader.
#[cfg(test)]
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    codec::crc32c(bytes)
}

/// Opens an array, or the finest level of an image.
pub(super) fn open(files: &Files) -> Result<Box<dyn SliceSource>, VolumeError> {
    let place = files.place().trim_end_matches(['/', '\\']).to_owned();
    if let Some((array, name)) = read_array(files, &place)? {
        let image = image_above(files, &place)?;
        return Source::open(files, place, &name, array, image);
    }
    let Some(attributes) = attributes(files, &place)? else {
        return Err(damaged(&place, "Zarr group", "it has no description; zarr.json or .zattrs is needed"));
    };
    let Some(image) = multiscales(&attributes) else {
        let hint = "a group without the multiscales of OME-Zarr; name an image or an array in it, such as";
        return Err(error(
            &place,
            VolumeProblem::Unsupported { what: "the group".into(), instead: format!("{hint} {place}/0") },
        ));
    };
    let levels = image["datasets"].as_array().map_or(&[][..], Vec::as_slice);
    let Some(level) = levels.first().and_then(|d| d["path"].as_str()) else {
        return Err(error(
            &place,
            VolumeProblem::MissingField { format: ZARR, field: "level in multiscales".into() },
        ));
    };
    let folder = files.sibling(&format!("{place}/zarr.json"), level)?;
    let Some((array, name)) = read_array(files, &folder)? else {
        return Err(damaged(&folder, "level of the image", "no array is there (zarr.json or .zarray)"));
    };
    let image = Some(Image { about: image.clone(), level: 0, place });
    Source::open(files, folder, &name, array, image)
}

/// The image that an array belongs to.
struct Image {
    /// The image's entry in `multiscales`.
    about: Value,
    level: usize,
    /// The image's folder.
    place: String,
}

/// Reads a JSON file; `None` if it does not exist.
fn description(files: &Files, name: &str) -> Result<Option<Value>, VolumeError> {
    let Some(bytes) = files.whole_or_none(name, MAX_DESCRIPTION)? else { return Ok(None) };
    // zarr-python writes NaN without quotes, which is not valid JSON.
    let parsed = serde_json::from_slice(&bytes).or_else(|e| {
        let text = String::from_utf8_lossy(&bytes);
        if text.contains("NaN") { serde_json::from_str(&text.replace(": NaN", ": \"NaN\"")) } else { Err(e) }
    });
    parsed.map(Some).map_err(|e| damaged(name, "description", e))
}

/// The array in a folder and the name of its metadata file; `None` if the folder is not an array.
fn read_array(files: &Files, folder: &str) -> Result<Option<(Array, String)>, VolumeError> {
    for file in ["zarr.json", ".zarray"] {
        let name = format!("{folder}/{file}");
        let Some(about) = description(files, &name)? else { continue };
        if about["node_type"] == "group" {
            return Ok(None);
        }
        return Ok(Some((metadata::array(&name, &about)?, name)));
    }
    Ok(None)
}

/// The attributes of a group; `None` if the folder is not a group.
fn attributes(files: &Files, folder: &str) -> Result<Option<Value>, VolumeError> {
    if let Some(mut about) = description(files, &format!("{folder}/zarr.json"))? {
        return Ok((about["node_type"] == "group").then(|| about["attributes"].take()));
    }
    if let Some(about) = description(files, &format!("{folder}/.zattrs"))? {
        return Ok(Some(about));
    }
    description(files, &format!("{folder}/.zgroup"))
}

/// The first image that attributes describe; version 0.5 keeps them under `ome`.
fn multiscales(attributes: &Value) -> Option<&Value> {
    let within = attributes.get("ome").unwrap_or(attributes);
    within["multiscales"].get(0).filter(|image| image.is_object())
}

/// The image that lists the array in this folder as one of its levels.
fn image_above(files: &Files, folder: &str) -> Result<Option<Image>, VolumeError> {
    let mut place = folder;
    for _ in 0..MAX_UP {
        let Some((above, _)) = place.rsplit_once(['/', '\\']).filter(|(above, _)| !above.is_empty()) else {
            break;
        };
        place = above;
        let path = folder[above.len() + 1..].replace('\\', "/");
        let Some(attributes) = attributes(files, above)? else { continue };
        let Some(about) = multiscales(&attributes) else { continue };
        let levels = about["datasets"].as_array().map_or(&[][..], Vec::as_slice);
        if let Some(level) = levels.iter().position(|d| d["path"].as_str() == Some(&path)) {
            return Ok(Some(Image { about: about.clone(), level, place: above.to_owned() }));
        }
    }
    Ok(None)
}

/// Axes of an image: their names and units.
fn axes(name: &str, about: &Value, n_axes: usize) -> Result<Vec<(String, Option<String>)>, VolumeError> {
    let all = about["axes"].as_array().map_or(&[][..], Vec::as_slice);
    let text = |v: &Value| v.as_str().map(str::to_owned);
    let axes: Vec<(String, Option<String>)> = all
        .iter()
        .map(|axis| (text(&axis["name"]).or_else(|| text(axis)).unwrap_or_default(), text(&axis["unit"])))
        .collect();
    let names: Vec<&str> = axes.iter().map(|(name, _)| name.as_str()).collect();
    if names.len() != n_axes || !names.ends_with(&["z", "y", "x"]) {
        // Names of a hostile file may be long.
        let found: String = names.join(", ").chars().take(60).collect();
        let expected = format!("{n_axes} axes, the last of them z, y and x,");
        return Err(error(name, VolumeProblem::Field { format: ZARR, field: "axes", found, expected }));
    }
    Ok(axes)
}

/// Spacings along x, y and z, mm: the scale of the level times that of the whole image, converted from the units of the
/// axes. Without a scale nothing is known of them, whatever the units are.
fn spacing_mm(
    name: &str,
    axes: &[(String, Option<String>)],
    image: &Image,
) -> Result<[Option<f64>; 3], VolumeError> {
    let mut scale = vec![1.0; axes.len()];
    let mut is_scaled = false;
    for source in [&image.about["datasets"][image.level], &image.about] {
        for step in source["coordinateTransformations"].as_array().map_or(&[][..], Vec::as_slice) {
            if step["type"] != "scale" {
                continue;
            }
            let given: Option<Vec<f64>> =
                step["scale"].as_array().and_then(|all| all.iter().map(Value::as_f64).collect());
            let Some(given) = given.filter(|given| given.len() == axes.len()) else {
                let found: String = step["scale"].to_string().chars().take(60).collect();
                let expected = format!("{} numbers, one for each axis,", axes.len());
                return Err(error(
                    name,
                    VolumeProblem::Field { format: ZARR, field: "scale", found, expected },
                ));
            };
            scale.iter_mut().zip(given).for_each(|(all, one)| *all *= one);
            is_scaled = true;
        }
    }
    if !is_scaled {
        return Ok([None; 3]);
    }
    let mut out = [None; 3];
    for (k, out) in out.iter_mut().enumerate() {
        let axis = axes.len() - 1 - k;
        let unit = axes[axis].1.as_deref();
        let of_scans = |unit| OTHER_UNITS_MM.iter().find(|(name, _)| *name == unit).map(|(_, mm)| *mm);
        let Some(mm) =
            unit.and_then(|unit| LengthUnit::from_name(unit).map(LengthUnit::mm).or_else(|| of_scans(unit)))
        else {
            continue;
        };
        let mm = scale[axis] * mm;
        // An axis of an image has no sense of its own here, so a negative scale cannot be followed; without its sign the
        // part would be mirrored.
        let positive = spacing(mm).filter(|_| mm > 0.0);
        *out = Some(positive.ok_or_else(|| error(name, VolumeProblem::Spacing { mm }))?);
    }
    Ok(out)
}

/// Position (first byte) and length of each chunk in a shard; `None` for a missing chunk.
type Index = Vec<Option<(u64, u64)>>;

struct Source {
    info: VolumeInfo,
    files: Files,
    /// Folder of the array.
    folder: String,
    array: Arc<Array>,
    /// Slices `first..end` as bytes.
    row: Vec<u8>,
    first: usize,
    end: usize,
    /// Indexes of the shards that hold the row.
    indexes: BTreeMap<Vec<u64>, Index>,
    absent: u64,
}

impl Source {
    fn open(
        files: &Files,
        folder: String,
        name: &str,
        array: Array,
        image: Option<Image>,
    ) -> Result<Box<dyn SliceSource>, VolumeError> {
        let n_axes = array.shape.len();
        // The last three axes are z, y and x; the slices of a scan are counted from x.
        let size = [n_axes - 1, n_axes - 2, n_axes - 3].map(|axis| array.shape[axis] as usize);
        let format = match (&image, array.version) {
            (Some(_), 2) => "OME-Zarr 0.4",
            (Some(_), _) => "OME-Zarr 0.5",
            (None, 2) => "Zarr 2",
            (None, _) => "Zarr 3",
        };
        let mut info = VolumeInfo::new(format, size, array.sample);
        let list = |all: &[u64]| all.iter().map(u64::to_string).collect::<Vec<_>>().join(" x ");
        info.stored.push(("array", format!("{} {}", list(&array.shape), array.sample.name())));
        let chunks = list(array.unit());
        info.stored.push((
            "chunks",
            match &array.pipeline.to_bytes {
                ToBytes::Shards(_) => format!("{chunks}, in shards of {}", list(&array.chunk)),
                ToBytes::Plain { .. } => chunks,
            },
        ));
        info.stored.push(("codec", array.codec()));
        let mut names = vec![String::new(); n_axes];
        if let Some(image) = &image {
            let axes = axes(&image.place, &image.about, n_axes)?;
            info.spacing_mm = spacing_mm(&image.place, &axes, image)?;
            let unit = |(_, unit): &(String, Option<String>)| unit.clone().unwrap_or_else(|| "none".into());
            let mut units: Vec<String> = axes[n_axes - 3..].iter().map(unit).collect();
            units.dedup();
            info.stored.push(("unit", units.join(", ").chars().take(60).collect()));
            // A viewer's file may name hundreds of levels, and these lines are printed.
            let levels = image.about["datasets"].as_array().map_or(&[][..], Vec::as_slice);
            let levels: Vec<&str> = levels.iter().filter_map(|d| d["path"].as_str()).collect();
            let shown: String = levels.join(", ").chars().take(200).collect();
            info.stored
                .push(("levels", format!("{} ({shown}); level {} is read", levels.len(), image.level)));
            names = axes.into_iter().map(|(name, _)| name).collect();
        }
        for (axis, name) in names.iter().enumerate().take(n_axes - 3).filter(|(k, _)| array.shape[*k] > 1) {
            let text = format!("axis {axis} {name} has {} entries; the first is read", array.shape[axis]);
            info.warnings.push(Warning::new(WarningId::ScanFirstEntry, text).in_file(folder.as_str()));
        }
        let unit = array.unit();
        // A slice needs all chunks that it crosses at once, so their number bounds the memory of a reader.
        let in_row = [n_axes - 2, n_axes - 1].map(|axis| array.shape[axis].div_ceil(unit[axis]));
        if in_row[0].saturating_mul(in_row[1]) > MAX_IN_ROW {
            return Err(error(
                name,
                VolumeProblem::Field {
                    format: ZARR,
                    field: "chunk shape",
                    found: list(unit),
                    expected: format!("at most {MAX_IN_ROW} chunks to a slice"),
                },
            ));
        }
        Ok(Box::new(Finite::new(InOrder::new(Self {
            info,
            files: files.clone(),
            folder,
            array: Arc::new(array),
            row: Vec::new(),
            first: 0,
            end: 0,
            indexes: BTreeMap::new(),
            absent: 0,
        }))))
    }

    fn slice_bytes(&self) -> usize {
        self.info.size[0] * self.info.size[1] * self.info.sample.n_bytes()
    }

    /// Unpacks the slices around slice `k`, unless they are already held.
    fn load(&mut self, k: usize) -> Result<(), VolumeError> {
        if (self.first..self.end).contains(&k) {
            return Ok(());
        }
        let n_axes = self.array.shape.len();
        let [columns, rows, slices] = self.info.size;
        let unit: Vec<usize> = self.array.unit().iter().map(|n| *n as usize).collect();
        let [depth, height, width] = [unit[n_axes - 3], unit[n_axes - 2], unit[n_axes - 1]];
        let (slice_bytes, n_bytes) = (self.slice_bytes(), self.info.sample.n_bytes());
        let begin = k / depth * depth;
        let at_once = (ROW_BYTES as usize / slice_bytes).clamp(1, depth);
        self.first = begin + (k - begin) / at_once * at_once;
        self.end = self.first;
        let end = (self.first + at_once).min(begin + depth).min(slices);
        // The old row is freed before the new one is made, to halve the memory. All voxels start with the fill value, which
        // a missing chunk keeps.
        self.row = Vec::new();
        let length = (end - self.first) * slice_bytes;
        self.row = if self.array.fill.iter().all(|b| *b == 0) {
            vec![0; length]
        } else {
            self.array.fill.iter().copied().cycle().take(length).collect()
        };
        let shard = k as u64 / self.array.chunk[n_axes - 3];
        self.indexes.retain(|file, _| file[n_axes - 3] == shard);
        let mut at = vec![0; n_axes];
        at[n_axes - 3] = (k / depth) as u64;
        for (j, top) in (0..rows).step_by(height).enumerate() {
            for (i, left) in (0..columns).step_by(width).enumerate() {
                (at[n_axes - 2], at[n_axes - 1]) = (j as u64, i as u64);
                let Some(voxels) = self.unpack(&at)? else {
                    // If a row is read in several slabs, a missing chunk is counted only in the first slab.
                    self.absent += u64::from(self.first == begin);
                    continue;
                };
                let run = (columns - left).min(width) * n_bytes;
                for z in self.first..end {
                    for y in 0..(rows - top).min(height) {
                        let from = (((z - begin) * height + y) * width) * n_bytes;
                        let to = (z - self.first) * slice_bytes + ((top + y) * columns + left) * n_bytes;
                        self.row[to..to + run].copy_from_slice(&voxels[from..from + run]);
                    }
                }
            }
        }
        self.end = end;
        Ok(())
    }

    /// File of a chunk: its index in the grid of files, and the chunk's number in the shard.
    fn file_of(&self, at: &[u64]) -> (Vec<u64>, usize) {
        let per_file = self.array.chunk.iter().zip(self.array.unit()).map(|(outer, inner)| outer / inner);
        let (mut file, mut within) = (Vec::new(), 0);
        for (index, n) in at.iter().zip(per_file) {
            file.push(index / n);
            within = within * n + index % n;
        }
        (file, within as usize)
    }

    /// The position of a chunk in its shard; `None` if the chunk is missing.
    fn place_in_shard(
        &mut self,
        shards: &Shards,
        file: &[u64],
        within: usize,
    ) -> Result<Option<(u64, u64)>, VolumeError> {
        if let Some(index) = self.indexes.get(file) {
            return Ok(index.get(within).copied().flatten());
        }
        let index = self.read_index(shards, file)?;
        let place = index.get(within).copied().flatten();
        self.indexes.insert(file.to_owned(), index);
        Ok(place)
    }

    /// Reads the index of a shard; the index is empty if the shard is missing.
    fn read_index(&self, shards: &Shards, file: &[u64]) -> Result<Index, VolumeError> {
        let n =
            self.array.chunk.iter().zip(&shards.chunk).map(|(outer, inner)| outer / inner).product::<u64>()
                as usize;
        let name = format!("{}/{}", self.folder, self.array.key(file));
        let Some(mut reader) = self.files.open_or_none(&name)? else { return Ok(Vec::new()) };
        let io = |e: std::io::Error| io_error(&name, &e);
        let length = 16 * n as u64 + if shards.checked { 4 } else { 0 };
        let all = reader.seek(SeekFrom::End(0)).map_err(io)?;
        if all < length {
            return Err(damaged(&name, "shard", format!("{all} bytes; its index alone has {length}")));
        }
        let begin = if shards.at_end { all - length } else { 0 };
        reader.seek(SeekFrom::Start(begin)).map_err(io)?;
        let mut bytes = vec![0; length as usize];
        reader.read_exact(&mut bytes).map_err(io)?;
        let index = if shards.checked {
            codec::checked(&bytes).map_err(|e| damaged(&name, "index of the shard", e))?
        } else {
            &bytes
        };
        let number = |bytes: &[u8]| {
            let bytes: [u8; 8] = bytes.try_into().unwrap_or_default();
            if shards.big_endian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) }
        };
        index
            .chunks_exact(16)
            .map(|pair| match (number(&pair[..8]), number(&pair[8..])) {
                (u64::MAX, u64::MAX) => Ok(None),
                (at, n) if at.checked_add(n).is_some_and(|end| end <= all) => Ok(Some((at, n))),
                (at, n) => {
                    let reason = format!("a chunk of {n} bytes at byte {at} of {all}");
                    Err(damaged(&name, "index of the shard", reason))
                }
            })
            .collect()
    }

    /// The voxels of a chunk; `None` if the chunk is missing.
    fn unpack(&mut self, at: &[u64]) -> Result<Option<Vec<u8>>, VolumeError> {
        let array = Arc::clone(&self.array);
        let (file, within) = self.file_of(at);
        let name = format!("{}/{}", self.folder, array.key(&file));
        let (unit, n_bytes) = (array.unit(), array.sample.n_bytes());
        let limit = packed_limit(unit.iter().product::<u64>() * n_bytes as u64);
        let place = || format!("chunk {at:?}");
        let packed = if let ToBytes::Shards(shards) = &array.pipeline.to_bytes {
            let Some((begin, length)) = self.place_in_shard(shards, &file, within)? else { return Ok(None) };
            if length > limit {
                return Err(damaged(
                    &name,
                    place(),
                    format!("{length} bytes; at most {limit} can be needed"),
                ));
            }
            let mut reader = self.files.open(&name)?;
            let mut bytes = vec![0; length as usize];
            let read = reader.seek(SeekFrom::Start(begin)).and_then(|_| reader.read_exact(&mut bytes));
            read.map_err(|e| io_error(&name, &e))?;
            bytes
        } else {
            let Some(bytes) = self.files.whole_or_none(&name, limit)? else { return Ok(None) };
            bytes
        };
        let voxels = codec::unpack(array.unit_pipeline(), packed, unit, n_bytes);
        voxels.map(Some).map_err(|e| damaged(&name, place(), e))
    }
}

impl AnySlice for Source {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn read_slice(&mut self, k: usize, out: &mut Vec<f32>) -> Result<(), SliceError> {
        self.load(k)?;
        let (n, at) = (self.slice_bytes(), k - self.first);
        sample::decode(self.info.sample, &self.row[at * n..(at + 1) * n], self.array.big_endian(), out);
        Ok(())
    }

    fn n_absent(&self) -> u64 {
        self.absent
    }

    fn forget(&mut self) {
        (self.first, self.end, self.absent) = (0, 0, 0);
    }
}
