//! CT volumes: single files of every format, a series of two, raw data, Zarr arrays.
#![no_main]

use std::io::Cursor;

use grainpath_core::slices::SampleType;
use grainpath_io::volume::{Files, RawHeader, ReadSeek, open_volume};

fn drain(files: Files, raw: Option<&RawHeader>) {
    let Ok(mut source) = open_volume(files, raw) else { return };
    let mut slice = Vec::new();
    for _ in 0..3 {
        if !matches!(source.next_slice(&mut slice), Ok(true)) {
            break;
        }
        assert_eq!(slice.len(), source.info().size[0] * source.info().size[1]);
        assert!(slice.iter().all(|v| v.is_finite()));
    }
    let _ = source.restart();
    let _ = source.skip_slice();
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let owned = bytes.to_vec();
    let open = move |_: &str| -> std::io::Result<Box<dyn ReadSeek>> { Ok(Box::new(Cursor::new(owned.clone()))) };
    drain(Files::single("a", open.clone()), None);
    drain(Files::folder("f", vec!["f/1.dcm".into(), "f/2.dcm".into()], open.clone()), None);
    // A Zarr array of version 2 and one of version 3: a description that is read, and the bytes as every chunk.
    let plain = r#"{"zarr_format":2,"shape":[2,3,5],"chunks":[2,2,5],"dtype":"<u2","compressor":{"id":"blosc"},"fill_value":0,"order":"C"}"#;
    let sharded = r#"{"zarr_format":3,"node_type":"array","shape":[2,3,5],"data_type":"float32","fill_value":"NaN",
        "chunk_grid":{"name":"regular","configuration":{"chunk_shape":[2,4,5]}},"chunk_key_encoding":{"name":"default"},
        "codecs":[{"name":"sharding_indexed","configuration":{"chunk_shape":[1,2,5],"codecs":[{"name":"bytes"},{"name":"zstd"}],
        "index_codecs":[{"name":"bytes"}]}}]}"#;
    for (file, about) in [(".zarray", Some(plain)), ("zarr.json", Some(sharded)), ("zarr.json", None), (".zarray", None)] {
        let chunk = bytes.to_vec();
        let at = move |name: &str| -> std::io::Result<Box<dyn ReadSeek>> {
            match (name.rsplit('/').next(), about) {
                (Some("zarr.json" | ".zarray" | ".zattrs" | ".zgroup"), _) if !name.ends_with(file) => {
                    Err(std::io::ErrorKind::NotFound.into())
                }
                (Some("zarr.json" | ".zarray"), Some(about)) => Ok(Box::new(Cursor::new(about.as_bytes()))),
                _ => Ok(Box::new(Cursor::new(chunk.clone()))),
            }
        };
        drain(Files::folder("f", vec![format!("f/{file}")], at), None);
    }
    let raw = RawHeader { size: [3, 2, 2], sample: SampleType::F32, big_endian: true, offset_bytes: 1 };
    drain(Files::single("a", open), Some(&raw));
});
