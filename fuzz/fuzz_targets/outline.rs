//! Drawings as they come; an SVG's path, list of points and transform; a DXF's entities.
#![no_main]

use grainpath_io::{OutlineOptions, parse_outline};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let options = OutlineOptions { unit: None, tolerance_mm: 0.01, even_odd: bytes.len().is_multiple_of(2) };
    let _ = parse_outline(bytes, &options);
    let wrapped = [
        (&b"<svg viewBox='0 0 90 60'><path d='"[..], &b"'/></svg>"[..]),
        (b"<svg><g fill='none' transform='", b"'><circle r='9'/><rect width='3' height='4' rx='1'/></g></svg>"),
        (b"0\nSECTION\n2\nENTITIES\n0\n", b"\n0\nENDSEC\n0\nEOF\n"),
        (b"<svg width='30mm' viewBox='0 0 30 20'>", b"</svg>"),
    ];
    for (head, tail) in wrapped {
        let _ = parse_outline(&[head, bytes, tail].concat(), &options);
    }
});
