//! CT volumes: single files of every format, a series of two, raw data.
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
    let raw = RawHeader { size: [3, 2, 2], sample: SampleType::F32, big_endian: true, offset_bytes: 1 };
    drain(Files::single("a", open), Some(&raw));
});
