//! PLY with a header of its own, and with one given.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_io::parse_mesh(bytes, Some("a.ply"));
    let _ = grainpath_io::parse_mesh(&[b"ply\n", bytes].concat(), Some("a.ply"));
    let header = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
    let _ = grainpath_io::parse_mesh(&[header, bytes].concat(), Some("a.ply"));
});
