//! STL, binary and ASCII, with and without its first word.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_io::parse_mesh(bytes, Some("a.stl"));
    let ascii = [b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", bytes].concat();
    let _ = grainpath_io::parse_mesh(&ascii, Some("a.stl"));
});
