//! Zarr arrays and images, packed here byte by byte, and what is wrong with them. `crates/grainpath-py/tests/test_zarr.py`
//! holds the reader against stores that zarr-python writes.

use serde_json::{Value, json};

use super::*;

/// Files of a store: a description, and the voxels of `voxels()` in chunks of two slices and 2 x 2 voxels.
fn store(
    about: &Value,
    chunk: impl Fn(Vec<i16>) -> Vec<u8>,
    key: impl Fn([usize; 3]) -> String,
) -> Vec<(String, Vec<u8>)> {
    let all = voxels();
    let name = if about["zarr_format"] == 2 { "scan/.zarray" } else { "scan/zarr.json" };
    let mut out = vec![(name.to_owned(), about.to_string().into_bytes())];
    for k in 0..2 {
        for i in 0..2 {
            // Chunks at the border are whole; what lies beyond is not read.
            let mut values = Vec::new();
            for z in 2 * k..2 * k + 2 {
                for y in 0..2 {
                    (2 * i..2 * i + 2)
                        .for_each(|x| values.push(if x < 3 { all[(z * 2 + y) * 3 + x] } else { 77 }));
                }
            }
            out.push((format!("scan/{}", key([k, 0, i])), chunk(values)));
        }
    }
    out
}

fn open(all: &[(String, Vec<u8>)]) -> Result<Box<dyn SliceSource>, VolumeError> {
    let all: Vec<(&str, Vec<u8>)> = all.iter().map(|(n, b)| (n.as_str(), b.clone())).collect();
    folder(&all)
}

fn bytes(values: &[i16], big: bool) -> Vec<u8> {
    values.iter().flat_map(|v| if big { v.to_be_bytes() } else { v.to_le_bytes() }).collect()
}

fn version_2() -> Value {
    json!({ "zarr_format": 2, "shape": [4, 2, 3], "chunks": [2, 2, 2], "dtype": "<i2", "compressor": null,
            "fill_value": -5, "order": "C", "filters": null })
}

fn version_3(codecs: Value) -> Value {
    json!({ "zarr_format": 3, "node_type": "array", "shape": [4, 2, 3], "data_type": "int16", "fill_value": -5,
            "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": [2, 2, 2] } },
            "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } }, "codecs": codecs })
}

fn dotted([z, y, x]: [usize; 3]) -> String {
    format!("{z}.{y}.{x}")
}

fn slashed([z, y, x]: [usize; 3]) -> String {
    format!("c/{z}/{y}/{x}")
}

/// The store of version 3 whose shards have two chunks of a slice each.
fn sharded() -> Vec<(String, Vec<u8>)> {
    let about = version_3(json!([{ "name": "sharding_indexed", "configuration": {
        "chunk_shape": [1, 2, 2], "codecs": [{ "name": "bytes", "configuration": { "endian": "big" } }, "gzip"],
        "index_codecs": [{ "name": "bytes", "configuration": { "endian": "little" } }, { "name": "crc32c" }] } }]));
    let shard = |values: Vec<i16>| {
        let chunks: Vec<Vec<u8>> = values.chunks(4).map(|half| gzip(&bytes(half, true))).collect();
        let (first, second) = (chunks[0].len() as u64, chunks[1].len() as u64);
        let index: Vec<u8> = [0, first, first, second].iter().flat_map(|n| n.to_le_bytes()).collect();
        let sum = crate::volume::zarr::checksum(&index).to_le_bytes().to_vec();
        [chunks.concat(), index, sum].concat()
    };
    store(&about, shard, slashed)
}

#[test]
fn both_versions_in_many_ways() {
    let mut source = open(&store(&version_2(), |v| bytes(&v, false), dotted)).expect("version 2");
    assert_eq!((source.info().format, source.info().spacing_mm), ("Zarr 2", [None; 3]));
    check(&mut *source);
    let mut about = version_2();
    (about["dtype"], about["order"]) = (json!(">i2"), json!("F"));
    about["compressor"] = json!({ "id": "zlib", "level": 1 });
    // Columns first: x varies slowest in the stored bytes where the order is F.
    let columns = |v: Vec<i16>| zlib(&bytes(&[0, 4, 2, 6, 1, 5, 3, 7].map(|k| v[k]), true));
    check(&mut *open(&store(&about, columns, dotted)).expect("order F"));
    let plain = json!([{ "name": "bytes", "configuration": { "endian": "little" } }, { "name": "gzip" }]);
    check(&mut *open(&store(&version_3(plain), |v| gzip(&bytes(&v, false)), slashed)).expect("version 3"));
    let mut source = open(&sharded()).expect("shards");
    check(&mut *source);
    let stored: Vec<String> =
        source.info().stored.iter().map(|(what, value)| format!("{what}: {value}")).collect();
    assert_eq!(
        stored,
        ["array: 4 x 2 x 3 i16", "chunks: 1 x 2 x 2, in shards of 2 x 2 x 2", "codec: sharded, gzip"]
    );
}

#[test]
fn chunks_that_are_missing_have_the_fill_value_and_are_counted() {
    let mut all = store(&version_2(), |v| bytes(&v, false), dotted);
    all.retain(|(name, _)| name != "scan/1.0.1");
    let mut source = open(&all).expect("an array");
    let slices = super::all(&mut *source).expect("slices");
    assert_eq!((slices[2][2], slices[3][5], source.n_absent()), (-5.0, -5.0, 1));
    source.restart().expect("again");
    assert_eq!(source.n_absent(), 0);
    let mut all = sharded();
    all.retain(|(name, _)| !name.starts_with("scan/c/0"));
    let mut source = open(&all).expect("an array");
    let slices = super::all(&mut *source).expect("slices");
    assert_eq!((slices[0][0], source.n_absent()), (-5.0, 4));
}

#[test]
fn images_give_scale_and_units() {
    let image = |unit: &str, scale: Value| {
        json!({ "multiscales": [{
            "axes": [{ "name": "z", "unit": unit }, { "name": "y", "unit": unit }, { "name": "x", "unit": "millimeter" }],
            "datasets": [{ "path": "0", "coordinateTransformations": [{ "type": "scale", "scale": scale }] },
                         { "path": "1", "coordinateTransformations": [{ "type": "scale", "scale": [1, 1, 9] }] }],
            "coordinateTransformations": [{ "type": "scale", "scale": [2, 1, 1] }] }] })
    };
    let with = |attributes: &Value| {
        let array = store(&version_2(), |v| bytes(&v, false), dotted);
        let mut all: Vec<_> = array.iter().map(|(n, b)| (n.replace("scan/", "scan/0/"), b.clone())).collect();
        all.push(("scan/.zattrs".to_owned(), attributes.to_string().into_bytes()));
        all.push(("scan/.zgroup".to_owned(), b"{\"zarr_format\": 2}".to_vec()));
        all
    };
    let mut source = open(&with(&image("micrometer", json!([250, 100, 0.3])))).expect("an image");
    assert_eq!(source.info().spacing_mm, [Some(0.3), Some(0.1), Some(0.5)]);
    assert_eq!(source.info().format, "OME-Zarr 0.4");
    check(&mut *source);
    let unknown = open(&with(&image("parsec", json!([250, 100, 0.3])))).expect("an image");
    assert_eq!(unknown.info().spacing_mm, [Some(0.3), None, None]);
    says(open(&with(&image("meter", json!([1, 1])))), "scan", "3 numbers, one for each axis");
    says(open(&with(&image("meter", json!([1, -1e9, 1])))), "scan", "between 1e-7 and 1e4 mm");
    says(open(&with(&image("micrometer", json!([250, -100, 0.3])))), "scan", "voxels are -0.1 mm apart");
    let mut bare = image("micrometer", json!([250, 100, 0.3]));
    bare["multiscales"][0]["coordinateTransformations"] =
        json!([{ "type": "translation", "translation": [1, 1, 1] }]);
    bare["multiscales"][0]["datasets"][0]["coordinateTransformations"] = json!([]);
    assert_eq!(open(&with(&bare)).expect("an image").info().spacing_mm, [None; 3]);
    let mut about = image("meter", json!([1, 1, 1]));
    about["multiscales"][0]["axes"].as_array_mut().expect("axes").reverse();
    says(open(&with(&about)), "scan", "the last of them z, y and x");
    about["multiscales"][0]["datasets"][0]["path"] = json!("../0");
    says(open(&with(&about)), "scan", "outside the folder");
    about["multiscales"][0]["datasets"][0]["path"] = json!("7");
    says(open(&with(&about)), "scan/7", "no array is there");
    says(open(&with(&json!({}))), "scan", "without the multiscales");
}

#[test]
fn what_is_wrong_is_told() {
    let good = || store(&version_2(), |v| bytes(&v, false), dotted);
    let damaged = |k: usize, bytes: Vec<u8>| {
        let mut all = good();
        all[k].1 = bytes;
        all
    };
    says(open(&damaged(4, vec![0; 15])), "scan/1.0.1", "15 bytes of voxels; 16 are needed");
    says(open(&damaged(4, vec![0; 90_000])), "scan/1.0.1", "more than");
    says(open(&damaged(0, b"{".to_vec())), ".zarray", "damaged description");
    says(open(&damaged(0, vec![b'['; 100_000])), ".zarray", "damaged description");
    for (change, message) in [
        (json!({ "dtype": "<c8" }), "type"),
        (json!({ "dtype": "<u8" }), "type"),
        (json!({ "dtype": 7 }), "type"),
        (json!({ "shape": [4, 2] }), "2 axes"),
        (json!({ "shape": [4, 2, 0] }), "empty"),
        (json!({ "shape": [4, 2, u64::MAX] }), "at most"),
        (json!({ "shape": [4, 2, -3] }), "whole numbers"),
        (json!({ "chunks": [2, 2] }), "3 numbers above 0"),
        (json!({ "chunks": [2, 0, 2] }), "3 numbers above 0"),
        (json!({ "chunks": [u64::MAX, u64::MAX, 2] }), "MiB a chunk"),
        (json!({ "shape": [4, 8192, 8192], "chunks": [1, 1, 1] }), "chunks to a slice"),
        (json!({ "fill_value": "air" }), "fill_value"),
        (json!({ "fill_value": 40000 }), "fill_value"),
        (json!({ "zarr_format": 4 }), "zarr_format"),
        (json!({ "order": "A" }), "order"),
        (json!({ "compressor": { "id": "lzma" } }), "lzma"),
        (json!({ "compressor": { "id": "blosc", "cname": "snappy" } }), "snappy"),
        (json!({ "filters": [{ "id": "delta" }] }), "delta"),
    ] {
        let mut about = version_2();
        change.as_object().expect("changes").iter().for_each(|(k, v)| about[k] = v.clone());
        says(open(&damaged(0, about.to_string().into_bytes())), "scan/.zarray", message);
    }
    let bytes_codec = json!({ "name": "bytes" });
    for (codecs, message) in [
        (json!([]), "no codec bytes"),
        (json!([bytes_codec, bytes_codec]), "codec"),
        (
            json!([{ "name": "transpose", "configuration": { "order": [0, 0, 1] } }, bytes_codec]),
            "each axis once",
        ),
        (
            json!([{ "name": "sharding_indexed", "configuration": { "chunk_shape": [2, 2, 3],
            "codecs": [bytes_codec], "index_codecs": [bytes_codec] } }]),
            "a divisor of the shard",
        ),
        (
            json!([{ "name": "sharding_indexed", "configuration": { "chunk_shape": [2, 2, 2],
            "codecs": [bytes_codec], "index_codecs": [bytes_codec, "gzip"] } }]),
            "index_codecs",
        ),
    ] {
        says(
            open(&[("scan/zarr.json".to_owned(), version_3(codecs).to_string().into_bytes())]),
            "zarr.json",
            message,
        );
    }
    // A bomb: a gigabyte of zeros in place of 16 bytes.
    let mut bomb = version_2();
    bomb["compressor"] = json!({ "id": "gzip" });
    let mut all = good();
    all[0].1 = bomb.to_string().into_bytes();
    all.iter_mut().skip(1).for_each(|(_, chunk)| *chunk = gzip(&vec![0; 1 << 20]));
    says(open(&all), "scan/0.0.0", "more than 16 bytes");
}

#[test]
fn damaged_shards_are_told() {
    let damaged = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut all = sharded();
        change(&mut all[2].1);
        open(&all)
    };
    says(damaged(&|shard| shard.truncate(20)), "scan/c/0/0/1", "its index alone");
    says(damaged(&|shard| *shard.last_mut().expect("bytes") ^= 1), "scan/c/0/0/1", "crc32c");
    says(damaged(&|shard| shard[12] ^= 0x55), "scan/c/0/0/1", "chunk [0, 0, 1]");
    let beyond = |shard: &mut Vec<u8>| {
        let at = shard.len() - 36;
        shard[at..at + 8].copy_from_slice(&(1u64 << 40).to_le_bytes());
        let sum = crate::volume::zarr::checksum(&shard[at..at + 32]).to_le_bytes();
        shard[at + 32..].copy_from_slice(&sum);
    };
    says(damaged(&beyond), "scan/c/0/0/1", "index of the shard");
}
