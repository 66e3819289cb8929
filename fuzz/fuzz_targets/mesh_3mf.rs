//! 3MF: any bytes as an archive, and any bytes as the model inside a good one.
#![no_main]

use std::io::{Cursor, Write};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_io::parse_mesh(&[b"PK\x03\x04", bytes].concat(), None);
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let rels: &[u8] = br#"<Relationships><Relationship Target="/m" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
    for (name, content) in [("_rels/.rels", rels), ("m", bytes)] {
        if zip.start_file(name, options).is_err() || zip.write_all(content).is_err() {
            return;
        }
    }
    if let Ok(archive) = zip.finish() {
        let _ = grainpath_io::parse_mesh(&archive.into_inner(), None);
    }
});
