//! 3MF: any bytes as an archive, as the model of a good archive, as its resources and as its relationships.
#![no_main]

use std::io::{Cursor, Write};

const RELATIONSHIPS: &[u8] = br#"<Relationships><Relationship Target="/m" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
const MODEL: &[u8] = br#"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"><resources>"#;
const BUILD: &[u8] = br#"</resources><build><item objectid="1"/></build></model>"#;

/// Reads an archive of these two parts, so that every mutation gets past the checksums of the archive.
fn read(relationships: &[u8], model: &[u8]) {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, content) in [("_rels/.rels", relationships), ("m", model)] {
        if zip.start_file(name, options).is_err() || zip.write_all(content).is_err() {
            return;
        }
    }
    if let Ok(archive) = zip.finish() {
        let _ = grainpath_io::parse_mesh(&archive.into_inner(), None);
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = grainpath_io::parse_mesh(&[b"PK\x03\x04", bytes].concat(), None);
    read(RELATIONSHIPS, bytes);
    read(RELATIONSHIPS, &[MODEL, bytes, BUILD].concat());
    read(bytes, &[MODEL, BUILD].concat());
});
