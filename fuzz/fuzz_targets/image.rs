//! Images of every format, with and without their first bytes. The cap on pixels keeps the fuzzer's memory small.
#![no_main]

const MAGIC: [&[u8]; 5] = [b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"II*\0", b"MM\0*", b"BM"];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_io::image::decode_within(bytes, 1 << 20);
    for magic in MAGIC {
        let _ = grainpath_io::image::decode_within(&[magic, bytes].concat(), 1 << 20);
    }
});
